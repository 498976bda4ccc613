//! All file access of the importer: resolves references in files, reads and lists files, and refuses files outside the
//! scene's folder.

use equilux_formats::{Error, Problem, Result};
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Whether `path` has the extension of a glTF file.
pub fn is_gltf(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gltf") || e.eq_ignore_ascii_case("glb"))
}

/// The glTF files directly in `folder`, sorted; none if it cannot be read.
pub fn scenes_in(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut scenes: Vec<PathBuf> = entries.filter(|path| is_gltf(path) && path.is_file()).collect();
    scenes.sort();
    scenes
}

/// The scene's folder and the files that were read in it.
pub(super) struct Files {
    /// The folder as given by the caller, for paths in errors and sources.
    folder: PathBuf,
    /// The canonical path of the folder.
    root: PathBuf,
    /// Files that were read, the scene first.
    pub(super) sources: Vec<PathBuf>,
}

impl Files {
    /// The files around `scene`.
    pub(super) fn around(scene: &Path) -> Result<Self> {
        let folder = scene.parent().unwrap_or(Path::new("")).to_path_buf();
        let root = if folder.as_os_str().is_empty() { Path::new(".") } else { &folder }
            .canonicalize()
            .map_err(|error| unreadable(scene, &error))?;
        Ok(Self { folder, root, sources: Vec::new() })
    }

    /// Reads `path`, which is the scene or a result of [`Files::resolve`].
    pub(super) fn read(&mut self, path: &Path) -> Result<Vec<u8>> {
        let metadata = fs::metadata(path).map_err(|error| unreadable(path, &error))?;
        if metadata.is_dir() {
            return Err(not_one_scene(path));
        }
        if !metadata.is_file() {
            return Err(Error::new(path, "not a regular file", "a file that can be read", "name a file"));
        }
        let bytes = fs::read(path).map_err(|error| unreadable(path, &error))?;
        if !self.sources.iter().any(|source| source == path) {
            self.sources.push(path.to_path_buf());
        }
        Ok(bytes)
    }

    /// Like [`Files::read`]; errors name the file `from`, and call the referring object `what`.
    pub(super) fn read_referenced(&mut self, from: &Path, path: &Path, what: &str) -> Result<Vec<u8>> {
        self.read(path).map_err(|error| match error {
            Error::Problem(Problem { found, expected, remedy, .. }) => {
                Error::new(from, format!("{what} in {}, which {found}", path.display()), expected, remedy)
            }
            Error::Stopped => error,
        })
    }

    /// The file that `reference` in the file `from` refers to. One file has one path, however it is referred to. Errors
    /// call the referring object `what`.
    pub(super) fn resolve(&self, from: &Path, reference: &str, what: &str) -> Result<PathBuf> {
        let refused = |why: &str| {
            Error::new(
                from,
                format!("{what} with the reference '{reference}', which {why}"),
                "a relative path to a file in the scene's folder",
                "move that file beside the scene and refer to it by a relative path",
            )
        };
        if reference.is_empty() {
            return Err(refused("is empty"));
        }
        if has_scheme(reference) {
            return Err(refused("is a URL or an absolute path"));
        }
        let beside = from.strip_prefix(&self.folder).unwrap_or(from).parent().unwrap_or(Path::new(""));
        let relative = beside.join(reference);
        match leaves(&relative) {
            Some(Component::ParentDir) => return Err(refused("leaves the scene's folder")),
            Some(_) => return Err(refused("is an absolute path")),
            None => {}
        }
        let target = self.root.join(&relative).canonicalize().map_err(|error| {
            Error::new(
                from,
                format!(
                    "{what} with the reference '{reference}', but {} cannot be read ({error})",
                    relative.display()
                ),
                "an existing file",
                "put the file there or correct the reference",
            )
        })?;
        let inside =
            target.strip_prefix(&self.root).map_err(|_| refused("leaves the scene's folder by a link"))?;
        if target.is_dir() {
            return Err(refused("is a folder"));
        }
        Ok(self.folder.join(inside))
    }
}

/// Whether `reference` starts like a URL, or with a drive letter.
fn has_scheme(reference: &str) -> bool {
    reference.split_once(':').is_some_and(|(scheme, _)| {
        scheme.starts_with(|c: char| c.is_ascii_alphabetic())
            && scheme.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
    })
}

/// The component by which `relative` leaves its folder, judged by the path alone.
fn leaves(relative: &Path) -> Option<Component<'_>> {
    let mut depth = 0_usize;
    for component in relative.components() {
        match component {
            Component::Normal(_) => depth += 1,
            Component::CurDir => {}
            Component::ParentDir if depth > 0 => depth -= 1,
            outside => return Some(outside),
        }
    }
    None
}

/// The error for a folder in place of a scene.
fn not_one_scene(folder: &Path) -> Error {
    let found = match &scenes_in(folder)[..] {
        [] => "a folder without a .gltf or .glb file in it".to_owned(),
        [only] => format!("a folder with {}", file_name(only)),
        [first, second, rest @ ..] => {
            let more = if rest.is_empty() { String::new() } else { format!(" and {} more", rest.len()) };
            format!("a folder with several scenes, {}, {}{more}", file_name(first), file_name(second))
        }
    };
    Error::new(folder, found, "a glTF file, or a folder with one", "name a file")
}

fn unreadable(path: &Path, error: &std::io::Error) -> Error {
    Error::new(
        path,
        format!("cannot be read ({error})"),
        "a readable file",
        "check the path and its permissions",
    )
}

/// The name of the file at `path`, for notes.
pub(super) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
