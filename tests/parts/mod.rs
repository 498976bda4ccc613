//! Parts and the whole are one equation: the light does not depend on division and solver, bytes do not depend on
//! threads, and nothing is computed twice.

mod bytes;
mod compressed;
mod counted;
mod edits;
mod inside;
mod instances;
mod left_out;
mod modular;
mod overrides;
mod reuse;
mod scaled;
mod split;
