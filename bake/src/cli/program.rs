//! Code shared by both programs: parsing the command line, printing, and exit codes. 0: success. 1: an input or the
//! environment is faulty. 2: the command line is faulty. 101: internal error.
//!
//! Standard output may be closed or full at any time, where `print!` and `eprintln!` panic.

use clap::error::ErrorKind;
use clap::{Command, CommandFactory, Parser};
use clap_complete::Shell;
use equilux_formats::Error;
use std::ffi::OsString;
use std::fmt::{self, Display};
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

/// Runs a program. `work` receives its arguments and returns its exit code.
pub fn run<P: Parser>(work: impl FnOnce(P) -> anyhow::Result<ExitCode>) -> ExitCode {
    report_panics_briefly();
    let arguments = match parse(std::env::args_os().collect()) {
        Ok(arguments) => arguments,
        Err(answer) => return answered(&answer),
    };
    work(arguments).unwrap_or_else(|error| match error.downcast::<Unprinted>() {
        Ok(unprinted) => unprinted.end(),
        Err(error) => {
            tell(format_args!("error: {error:#}"));
            ExitCode::FAILURE
        }
    })
}

/// Writes `text` to standard output.
///
/// # Errors
/// Standard output is closed or full. [`run`] ends the program then.
pub fn print(text: &str) -> Result<(), Unprinted> {
    let mut stdout = io::stdout().lock();
    stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()).map_err(Unprinted)
}

/// Writes a line to standard error, if that is possible.
pub fn tell(message: impl Display) {
    let _ = writeln!(io::stderr(), "{message}");
}

/// The shell completion script for the program `name`.
pub fn completions<P: CommandFactory>(shell: Shell, name: &str) -> String {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut P::command(), name, &mut script);
    String::from_utf8(script).expect("completion scripts are text")
}

/// Standard output could not be written.
#[derive(Debug)]
pub struct Unprinted(io::Error);

impl Display for Unprinted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "standard output cannot be written ({})", self.0)
    }
}

impl std::error::Error for Unprinted {}

impl Unprinted {
    /// If the reader closed the pipe, as `head -1` does, the program ends without an error.
    fn end(&self) -> ExitCode {
        if self.0.kind() == io::ErrorKind::BrokenPipe {
            return ExitCode::SUCCESS;
        }
        let found = format!("cannot be written ({})", self.0);
        let error = Error::new("standard output", found, "space for the text", "send it to another file");
        tell(format_args!("error: {error}"));
        ExitCode::FAILURE
    }
}

/// The arguments, or the help, version or error message of clap.
fn parse<P: Parser>(arguments: Vec<OsString>) -> Result<P, clap::Error> {
    let mut command = P::command();
    if let Some(name) = arguments.get(1).and_then(|first| first.to_str())
        && let Some(meant) = meant(&command, name)
    {
        let message = format!("there is no file or command `{name}`; did you mean `{meant}`?");
        return Err(command.error(ErrorKind::InvalidSubcommand, message));
    }
    P::try_parse_from(arguments)
}

/// The least similarity of a name to a command for a suggestion: one letter of four may differ.
const ALIKE: f64 = 0.7;

/// The subcommand most similar to `name`, if `name` is neither a subcommand nor a file.
fn meant(command: &Command, name: &str) -> Option<String> {
    let names = || command.get_subcommands().map(Command::get_name).chain(["help"]);
    if name.starts_with('-')
        || name.contains(['.', '/'])
        || Path::new(name).exists()
        || names().any(|own| own == name)
    {
        return None;
    }
    let likeness = |own: &str| strsim::normalized_damerau_levenshtein(own, name);
    let best = names().max_by(|a, b| likeness(a).total_cmp(&likeness(b)))?;
    (likeness(best) >= ALIKE).then(|| best.to_owned())
}

/// Prints the message of clap and returns its exit code.
fn answered(answer: &clap::Error) -> ExitCode {
    let printed = answer.print().and_then(|()| io::stdout().flush());
    match printed {
        Err(error) if !answer.use_stderr() => Unprinted(error).end(),
        _ => ExitCode::from(u8::try_from(answer.exit_code()).unwrap_or(2)),
    }
}

/// Panics are internal errors. Reports the first one in two lines; RUST_BACKTRACE=full adds a backtrace.
fn report_panics_briefly() {
    static REPORTED: AtomicBool = AtomicBool::new(false);
    std::panic::set_hook(Box::new(|panic| {
        // Other threads often panic for the same reason.
        if REPORTED.swap(true, Ordering::Relaxed) {
            return;
        }
        let place = panic.location().map_or_else(|| "an unknown place".to_owned(), ToString::to_string);
        let payload = panic.payload();
        let message = payload.downcast_ref::<&str>().copied();
        let message = message.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
        tell(fault(message.unwrap_or("no message"), &place));
        if std::env::var_os("RUST_BACKTRACE").is_some_and(|level| level == "full") {
            tell(std::backtrace::Backtrace::force_capture());
        }
    }));
}

/// Longest message of a panic, in characters.
const LONGEST: usize = 300;

/// The report of a panic with this message at this source location.
fn fault(message: &str, place: &str) -> String {
    let mut line: String = message.lines().next().unwrap_or_default().chars().take(LONGEST).collect();
    if line.len() < message.len() {
        line.push('…');
    }
    format!(
        "error: internal error at {place}: {line}\n\
         This is a fault of the program, not of its input: please report it with the command and the files."
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_report_of_a_fault_is_short_however_long_its_message_is() {
        let long = "left != right\n".repeat(100_000);
        for (message, shown) in
            [("no rows", "no rows\n"), (&long, "left != right…\n"), (&"x".repeat(9999), "xxx…\n")]
        {
            let fault = fault(message, "rows.rs:1:2");
            assert!(fault.contains(shown) && fault.contains("rows.rs:1:2"), "{fault}");
            assert!(fault.lines().count() == 2 && fault.len() < 600, "{fault}");
        }
    }

    #[test]
    fn a_misspelt_command_is_recognised_and_a_scene_is_not() {
        let command =
            Command::new("assemble").subcommands(["plan", "render", "completions"].map(Command::new));
        for (name, expected) in [
            ("pln", Some("plan")),
            ("paln", Some("plan")),
            ("rendr", Some("render")),
            ("completons", Some("completions")),
            ("hlep", Some("help")),
            ("plan", None),
            ("help", None),
            ("house", None),
            ("plan.glb", None),
            ("--pln", None),
            ("", None),
        ] {
            assert_eq!(meant(&command, name).as_deref(), expected, "{name}");
        }
    }
}
