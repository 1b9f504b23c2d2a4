//! The command line: prints the error, sets the exit code.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};
use clap_complete::Shell;
use fecontact::cli::{self, Failure, Input, Options, Reduced, Stability, Study, Template, internal_error};

/// 2D finite-element contact with the time-dependent super/subloading-surface friction law.
#[derive(Parser)]
#[command(name = "fecontact", bin_name = "fecontact", version = cli::VERSION)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Write a short case that runs, as a starting point
    #[command(after_help = "Example: fecontact init wall && fecontact run wall.json")]
    Init {
        /// Kind of case
        #[arg(value_enum)]
        kind: Template,
        /// The file to write [default: <kind>.json]
        file: Option<PathBuf>,
    },
    /// Run a case and write its results to a folder
    #[command(after_help = "Example: fecontact run block.json --out out/block")]
    Run {
        /// The case file (JSON)
        case: PathBuf,
        /// Folder of the results [default: out/<case name>]
        #[arg(short, long)]
        out: Option<PathBuf>,
        /// Threads [default: all cores]
        #[arg(short, long)]
        threads: Option<usize>,
        /// Print warnings and the last line only
        #[arg(short, long)]
        quiet: bool,
        /// Resume from the last checkpoint in the folder, with results bitwise identical to those of an uninterrupted run; start
        /// anew if this case's own run has left none yet
        #[arg(short, long)]
        resume: bool,
    },
    /// Check a case and its mesh, and print the case as interpreted; solve nothing
    #[command(after_help = "Example: fecontact check block.json")]
    Check {
        /// The case file (JSON)
        case: PathBuf,
        /// Print the case with every default filled in instead: it gives bitwise identical results; its paths are relative to the case file
        #[arg(short, long)]
        resolved: bool,
    },
    /// Run a case with successively halved elements and increments, and print error bars of its numbers
    #[command(after_help = "Example: fecontact converge block.json --measure base.tangential_force:max")]
    Converge {
        /// The case file (JSON)
        case: PathBuf,
        /// COLUMN:max, COLUMN:min, COLUMN:end or COLUMN:mean (over time) of a column of the history or the probes, or of a ratio COLUMN/COLUMN;
        /// COLUMN:max@STEP in one step; may be repeated
        #[arg(short, long, required = true)]
        measure: Vec<String>,
        /// Number of runs, 3 or more; the first is the case as it is
        #[arg(short, long, default_value_t = 3)]
        levels: usize,
        /// Fraction of a number by which it may change from level to level if no order can be measured; larger changes that do not decrease end
        /// with exit code 1
        #[arg(short, long, default_value_t = cli::WITHIN)]
        within: f64,
        /// Folder of the results, with a folder for each run [default: out/<case name>]
        #[arg(short, long)]
        out: Option<PathBuf>,
        /// Threads [default: all cores]
        #[arg(short, long)]
        threads: Option<usize>,
    },
    /// Find the factor of safety at the end of a case, by dividing the strengths until they fail
    #[command(after_help = "Example: fecontact safety slope.json --body soil")]
    Safety {
        /// The case file (JSON)
        case: PathBuf,
        /// Body whose strength is divided; may be repeated [default: all bodies and contacts with a strength]
        #[arg(short, long = "body")]
        body: Vec<String>,
        /// Contact whose strength is divided; may be repeated
        #[arg(short, long = "contact")]
        contact: Vec<String>,
        /// Largest difference between the factor that stands and the one that fails
        #[arg(short, long, default_value_t = 0.01)]
        within: f64,
        /// Largest factor that is tried
        #[arg(long, default_value_t = 10.0)]
        most: f64,
        /// Folder of the results, with a folder for each factor [default: out/<case name>]
        #[arg(short, long)]
        out: Option<PathBuf>,
        /// Threads [default: all cores]
        #[arg(short, long)]
        threads: Option<usize>,
    },
    /// Drive a friction law on its own along a path of slip, pressure and time
    #[command(after_help = "Example: fecontact law cases/law/steady.json")]
    Law {
        /// The test (JSON)
        test: PathBuf,
        /// Folder of the results [default: out/<test name>]
        #[arg(short, long)]
        out: Option<PathBuf>,
    },
    /// Write results as one HTML page for a browser; several folders are overlaid
    #[command(after_help = "Example: fecontact report out/coarse out/fine --out both.html")]
    Report {
        /// Folders of results, of finished or active runs
        #[arg(required = true)]
        folders: Vec<PathBuf>,
        /// The page [default: report.html in the folder of the results, out/report.html for several]
        #[arg(short, long)]
        out: Option<PathBuf>,
    },
    /// Print the JSON Schema of the case file or of a law test, or the quantities of results
    #[command(after_help = "Example: fecontact schema > case.schema.json")]
    Schema {
        /// Schema to print
        #[arg(value_enum, default_value_t = Input::Case)]
        of: Input,
    },
    /// Print shell completions
    #[command(
        after_help = "Example: fecontact completions bash > ~/.local/share/bash-completion/completions/fecontact"
    )]
    Completions {
        /// The shell
        #[arg(value_enum)]
        shell: Shell,
    },
}

fn main() -> ExitCode {
    internal_error::watch();
    let result = internal_error::catch(run).unwrap_or_else(|error| Err(Failure::Internal(error)));
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
        Command::Init { kind, file } => cli::init(kind, file),
        Command::Run { case, out, threads, quiet, resume } => cli::run(&case, Options { out, threads, quiet, resume }),
        Command::Check { case, resolved } => cli::check(&case, resolved),
        Command::Converge { case, measure: measures, levels, within, out, threads } => {
            cli::converge(&case, Study { measures, levels, within, out, threads })
        }
        Command::Safety { case, body: bodies, contact: contacts, within, most, out, threads } => {
            cli::safety(&case, Stability { reduced: Reduced { bodies, contacts }, within, most, out, threads })
        }
        Command::Law { test, out } => cli::law(&test, out),
        Command::Report { folders, out } => cli::report(&folders, out),
        Command::Schema { of } => cli::schema(of),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Arguments::command(), "fecontact", &mut script);
            cli::print(&String::from_utf8_lossy(&script))
        }
    }
}
