//! What both programs have in common: reading the command line, printing, and ending with an exit code. 0: done.
//! 1: something is wrong with an input or the environment. 2: the command line is wrong. 101: the program is.
//!
//! Standard output may be closed or full at any time, which `print!` and `eprintln!` answer with a panic.

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

/// Runs a program: `work` gets its arguments and says how it ended.
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

/// The script that completes the options of the program `name` in a shell.
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
    /// A reader that has seen enough, such as `head -1`, ends the program quietly: its work is done.
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

/// The arguments, or what clap answers to them: help, a version, or what is wrong.
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

/// How alike a name and a command must be for one to be meant by the other: a letter of four may differ.
const ALIKE: f64 = 0.7;

/// The subcommand that `name` seems to mean if it is neither one itself nor a file.
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

/// Prints what clap answers.
fn answered(answer: &clap::Error) -> ExitCode {
    let printed = answer.print().and_then(|()| io::stdout().flush());
    match printed {
        Err(error) if !answer.use_stderr() => Unprinted(error).end(),
        _ => ExitCode::from(u8::try_from(answer.exit_code()).unwrap_or(2)),
    }
}

/// Panics are faults of the program. A few lines say so, once; RUST_BACKTRACE=full adds where.
fn report_panics_briefly() {
    static REPORTED: AtomicBool = AtomicBool::new(false);
    std::panic::set_hook(Box::new(|panic| {
        // Other threads stumble over the same fault.
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

/// No message of a panic is longer, in characters.
const LONGEST: usize = 300;

/// What is said about a panic with this message at this place.
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
