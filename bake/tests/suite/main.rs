//! Tests of the importer with small generated files: conversion of each feature of glTF, notes about ignored features,
//! and refusals; and occlusion by meshes. Coordinates are small dyadic numbers, so equality is exact unless a tolerance
//! is stated with its reason.

mod accessors;
mod damage;
mod gltf;
mod hierarchy;
mod lights_and_extras;
mod materials;
mod meshes;
mod refusals;
mod surfaces;
