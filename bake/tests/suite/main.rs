//! The importer's contract, on small files written here: what each feature of glTF becomes, what is left out with a
//! note, and what is refused; and what meshes hide. Coordinates are small dyadic numbers, so equality is exact unless a
//! tolerance says why not.

mod accessors;
mod damage;
mod gltf;
mod hierarchy;
mod lights_and_extras;
mod materials;
mod meshes;
mod refusals;
mod surfaces;
