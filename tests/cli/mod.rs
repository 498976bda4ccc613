//! The command-line interface: exit codes, output streams, and files.

mod explain;
#[cfg(unix)]
mod interrupt;
mod json;
mod outputs;
mod plan;
mod render;
#[cfg(unix)]
mod streams;
mod usage;
#[cfg(unix)]
mod watch;
