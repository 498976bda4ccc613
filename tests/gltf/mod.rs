//! Legal glTF files: every form of one scene is the same scene.

mod damaged;
mod forms;
mod images;
mod legal;
mod references;
