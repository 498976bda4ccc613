//! Standard output and standard error may be closed or full: programs end by an exit code, never by a panic.

use equilux_tests::program::program;
use equilux_tests::rooms::square;
use equilux_tests::workshop::Workshop;
use std::fs::{File, OpenOptions};
use std::process::{Command, Stdio};

/// Everything that prints on standard output.
const PRINTING: [(&str, &[&str]); 13] = [
    ("bake", &["--help"]),
    ("bake", &["--version"]),
    ("bake", &["completions", "bash"]),
    ("bake", &["scene.glb", "--element-size", "1"]),
    ("bake", &["scene.glb", "--element-size", "1", "--json"]),
    ("bake", &["scene.glb", "--gc"]),
    ("assemble", &["--help"]),
    ("assemble", &["completions", "zsh"]),
    ("assemble", &["scene.glb", "--element-size", "1", "--pictures", "none"]),
    ("assemble", &["scene.glb", "--element-size", "1", "--pictures", "none", "--json"]),
    ("assemble", &["plan", "scene.glb", "--element-size", "1"]),
    ("assemble", &["render", "scene.glb", "--element-size", "1", "--size", "8x8"]),
    ("assemble", &["classic", "scene.glb", "--element-size", "1"]),
];

fn command(workshop: &Workshop, name: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new(program(name));
    command.args(arguments).current_dir(workshop.path("."));
    command
}

#[test]
fn a_reader_that_goes_away_ends_programs_quietly() {
    let workshop = Workshop::with(&square());
    for (name, arguments) in PRINTING {
        let mut child = command(&workshop, name, arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        drop(child.stdout.take());
        let ended = child.wait_with_output().expect("the program ends");
        let stderr = String::from_utf8_lossy(&ended.stderr);
        assert_eq!((ended.status.code(), &*stderr), (Some(0), ""), "{name} {arguments:?}");
    }
}

#[test]
fn a_closed_output_is_no_fault() {
    let workshop = Workshop::with(&square());
    for (name, arguments) in PRINTING {
        let line = format!("exec '{}' {} >&-", program(name).display(), arguments.join(" "));
        let ended =
            Command::new("sh").args(["-c", &line]).current_dir(workshop.path(".")).output().expect("a shell");
        let stderr = String::from_utf8_lossy(&ended.stderr);
        assert_eq!((ended.status.code(), &*stderr), (Some(0), ""), "{line}");
    }
}

fn full() -> File {
    OpenOptions::new().write(true).open("/dev/full").expect("a device that is always full")
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_output_is_an_error_of_the_environment() {
    let workshop = Workshop::with(&square());
    for (name, arguments) in PRINTING {
        let ended = command(&workshop, name, arguments).stdout(full()).output().expect("the program runs");
        let stderr = String::from_utf8_lossy(&ended.stderr);
        let what = format!("{name} {arguments:?}: {stderr}");
        assert_eq!(ended.status.code(), Some(1), "{what}");
        assert!(stderr.starts_with("error: standard output: cannot be written"), "{what}");
        assert_eq!(stderr.lines().count(), 1, "{what}");
    }
}

/// No message can be printed then; only the exit code remains.
#[cfg(target_os = "linux")]
#[test]
fn messages_that_cannot_be_written_change_no_exit_code() {
    let workshop = Workshop::with(&square());
    for (name, arguments, code) in [
        ("bake", &["nowhere.glb"][..], 1),
        ("bake", &["--no-such-option"], 2),
        ("assemble", &["nowhere.glb"], 1),
        ("assemble", &["plan", "nowhere.glb"], 1),
        ("assemble", &["pln"], 2),
        ("bake", &["scene.glb", "--element-size", "1"], 0),
    ] {
        let ended = command(&workshop, name, arguments).stderr(full()).output().expect("the program runs");
        assert_eq!(ended.status.code(), Some(code), "{name} {arguments:?}");
    }
}
