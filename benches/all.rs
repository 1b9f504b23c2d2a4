//! `cargo bench` in the root runs the benches, which are a package of their own: what they depend on is not compiled beside the program.

use std::process::{Command, ExitCode};

fn main() -> ExitCode {
    // Cargo itself appends `--bench`.
    let filters = std::env::args().skip(1).filter(|argument| argument != "--bench");
    let run =
        Command::new(env!("CARGO")).args(["bench", "--package", "fecontact-benches", "--"]).args(filters).status();
    match run {
        Ok(status) if status.success() => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("cargo does not start: {error}");
            ExitCode::FAILURE
        }
    }
}
