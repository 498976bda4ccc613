//! The `bake` program.

fn main() -> std::process::ExitCode {
    equilux_bake::cli::main()
}
