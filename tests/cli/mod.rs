//! What the programs promise on the command line: exit codes, what is printed where, and which files there are.

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
