//! Bad input and bad surroundings: a sentence that names the file and what to do, exit code 1, nothing half-written.

mod cache;
mod surroundings;
mod table;
