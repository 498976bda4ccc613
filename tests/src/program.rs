//! The executables of the two programs.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// The file of the program `name`, `bake` or `assemble`.
pub fn program(name: &str) -> PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    let folder = FOLDER.get_or_init(built);
    folder.join(format!("{name}{}", std::env::consts::EXE_SUFFIX))
}

/// The folder of programs beside this test, brought up to date. Cargo tells a test where the programs of its own
/// package are, but not those of a dependency, and with `cargo test -p equilux-tests` it does not even build them. So
/// cargo builds them once, with the profile and target folder of this test. It builds the whole workspace, because
/// another choice of packages may enable other features and rebuild everything; after `cargo test --workspace` they are
/// up to date.
fn built() -> PathBuf {
    let test = std::env::current_exe().expect("a test knows its own file");
    // <target>/<profile>/deps/suite-<hash>
    let profile_folder = test.ancestors().nth(2).expect("a folder for the profile");
    let profile = match profile_folder.file_name().and_then(|name| name.to_str()) {
        None | Some("debug") => "dev",
        Some(profile) => profile,
    };
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| env!("CARGO").into());
    let build = Command::new(cargo)
        .args(["build", "--quiet", "--locked", "--workspace", "--bins", "--profile", profile])
        .arg("--manifest-path")
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("../Cargo.toml"))
        .arg("--target-dir")
        .arg(profile_folder.parent().expect("a target folder"))
        .output()
        .expect("cargo runs");
    assert!(build.status.success(), "no programs to test: {}", String::from_utf8_lossy(&build.stderr));
    profile_folder.into()
}
