//! Faulty input and environments: an error with file and remedy, exit code 1, no incomplete files.

mod cache;
mod surroundings;
mod table;
