//! glTF files as the specification allows them: one scene in every legal form is one scene.

mod damaged;
mod forms;
mod images;
mod legal;
mod references;
