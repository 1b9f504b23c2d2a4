//! The command line: prints the error, sets the exit code.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use fecontact::cli::{self, Failure, Input, Options, Study, defect};

/// 2D finite-element contact with the time-dependent super/subloading-surface friction law.
#[derive(Parser)]
#[command(name = "fecontact", bin_name = "fecontact", version = cli::VERSION)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Run a case; results go to a folder
    Run {
        /// The case file (JSON)
        case: PathBuf,
        /// Folder of the results [default: out/<case name>]
        #[arg(long)]
        out: Option<PathBuf>,
        /// Threads [default: all cores]
        #[arg(long)]
        threads: Option<usize>,
        /// Print warnings and the last line only
        #[arg(long)]
        quiet: bool,
        /// Resume from the last checkpoint in the folder, to results bitwise identical to those of an uninterrupted run; begin
        /// anew where this case's own run has left none yet
        #[arg(long)]
        resume: bool,
    },
    /// Check a case and its mesh, and print the case as interpreted; solve nothing
    Check {
        /// The case file (JSON)
        case: PathBuf,
        /// Print the case with every default filled in instead: it gives bitwise identical results; its paths are relative to the case file
        #[arg(long)]
        resolved: bool,
    },
    /// Run a case with elements and increments that are halved again and again, and tell how sure a number of it is
    Converge {
        /// The case file (JSON)
        case: PathBuf,
        /// Column of the history or the probes, or one over another (COLUMN/COLUMN), and what is taken of it: COLUMN:max, COLUMN:min, COLUMN:end or
        /// COLUMN:mean (over time), in a step alone COLUMN:max@STEP; may be given several times
        #[arg(long, required = true)]
        measure: Vec<String>,
        /// Number of runs, 3 or more; the first is the case as it is
        #[arg(long, default_value_t = 3)]
        levels: usize,
        /// Folder of the results, with a folder for each run [default: out/<case name>]
        #[arg(long)]
        out: Option<PathBuf>,
        /// Threads [default: all cores]
        #[arg(long)]
        threads: Option<usize>,
    },
    /// Drive a friction law on its own along a path of slip, pressure and time
    Law {
        /// The test (JSON)
        test: PathBuf,
        /// Folder of the results [default: out/<test name>]
        #[arg(long)]
        out: Option<PathBuf>,
    },
    // The command only names its replacement.
    #[command(hide = true, disable_help_flag = true)]
    Plot {
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        anything: Vec<OsString>,
    },
    /// Write one HTML page of results for a browser; several folders are overlaid
    Report {
        /// Folders of results, of finished or active runs
        #[arg(required = true)]
        folders: Vec<PathBuf>,
        /// The page [default: report.html in the folder of the results, out/report.html for several]
        #[arg(long)]
        out: Option<PathBuf>,
    },
    /// Print the JSON Schema of the case file or of a law test, or the quantities of results
    Schema {
        /// Schema to print
        #[arg(value_enum, default_value_t = Input::Case)]
        of: Input,
    },
}

fn main() -> ExitCode {
    defect::watch();
    let result = defect::catch(run).unwrap_or_else(|defect| Err(Failure::Defect(defect)));
    let Err(failure) = result else { return ExitCode::SUCCESS };
    let (code, message) = failure.code_and_message();
    cli::say(format_args!("{message}"));
    ExitCode::from(code)
}

fn run() -> Result<(), Failure> {
    let command = match Arguments::try_parse() {
        Ok(arguments) => arguments.command,
        Err(error) if error.use_stderr() => error.exit(),
        Err(help) => return cli::print(&help.render().to_string()),
    };
    match command {
        Command::Run { case, out, threads, quiet, resume } => cli::run(&case, Options { out, threads, quiet, resume }),
        Command::Check { case, resolved } => cli::check(&case, resolved),
        Command::Converge { case, measure: measures, levels, out, threads } => {
            cli::converge(&case, Study { measures, levels, out, threads })
        }
        Command::Law { test, out } => cli::law(&test, out),
        Command::Plot { .. } => Err(cli::plot()),
        Command::Report { folders, out } => cli::report(&folders, out),
        Command::Schema { of } => cli::schema(of),
    }
}
