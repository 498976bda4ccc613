//! Parts and the whole are one equation: the same light however a scene is divided and solved, the same bytes whoever
//! computes them, and nothing computed twice.

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
