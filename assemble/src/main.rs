//! The `assemble` program.

fn main() -> std::process::ExitCode {
    equilux_assemble::cli::main()
}
