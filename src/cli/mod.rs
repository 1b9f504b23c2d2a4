//! The commands behind the command line.

pub mod progress;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::ValueEnum;

use crate::case::{self, CaseError, law_test};
use crate::cli::progress::Progress;
use crate::model::Model;
use crate::model::state::Energy;
use crate::output::fields::Fields;
use crate::output::fronts::Fronts;
use crate::output::history::History;
use crate::output::law::LawTable;
use crate::output::newton_log::NewtonLog;
use crate::output::plot::{self, PlotError};
use crate::output::summary::{self, About, Ending, LawSummary, Summary};
use crate::output::warnings::Warnings;
use crate::output::wave_speeds;
use crate::run;
use crate::run::error::Error;
use crate::run::law_report::{Hold, LawReport, PathPoint};
use crate::run::observer::Observer;

/// More threads than this are a slip of the keyboard.
const MOST_THREADS: usize = 1024;

/// What runs and tests write beside frames and figures; an earlier run's must not be taken for this one's.
const RESULTS: [&str; 8] =
    ["summary.json", "history.csv", "newton.csv", "slip_map.csv", "fronts.csv", "solid.pvd", "contact.pvd", "law.csv"];

/// Why a command did not end well.
#[derive(Debug)]
pub enum Failure {
    /// It stopped while solving; results so far are kept.
    Stopped(String),
    /// The input is bad; nothing was written.
    BadInput(String),
}

impl From<CaseError> for Failure {
    fn from(error: CaseError) -> Self {
        Self::BadInput(error.to_string())
    }
}

impl From<PlotError> for Failure {
    fn from(error: PlotError) -> Self {
        match error {
            PlotError::Output(error) => error.into(),
            PlotError::Unreadable { .. } => Self::BadInput(error.to_string()),
        }
    }
}

/// What a schema describes.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Input {
    /// the case file of `fecontact run`
    Case,
    /// the test of `fecontact law`
    Law,
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Stopped(error.to_string())
    }
}

/// `fecontact run`.
///
/// # Errors
/// [`Failure`].
pub fn run(path: &Path, out: Option<PathBuf>, threads: Option<usize>, quiet: bool) -> Result<(), Failure> {
    use_threads(threads)?;
    let case = case::read(path)?;
    let model = Arc::new(case::build(&case, path)?);
    let folder = out.unwrap_or_else(|| default_folder(path));
    prepare(&folder)?;

    let mut history = History::create(&folder, &model)?;
    let mut newton_log = NewtonLog::create(&folder)?;
    let mut warnings = Warnings::default();
    warnings.list = model.warnings();
    let told = warnings.list.len();
    if !quiet {
        warnings.list.iter().for_each(|warning| eprintln!("warning: {warning}"));
        model.choices().iter().for_each(|choice| eprintln!("{choice}"));
    }
    let mut fields = match case.output.fields {
        true => Some(Fields::create(&folder, model.clone(), &model.initial_state(), case.output.every)?),
        false => None,
    };
    let mut fronts = match case.output.fronts {
        Some(fronts) => Some(Fronts::create(&folder, &model, &model.initial_state(), fronts.slip_rate)?),
        None => None,
    };
    let mut progress = (!quiet).then(Progress::new);
    let mut observers: Vec<&mut dyn Observer> = vec![&mut history, &mut newton_log, &mut warnings];
    observers.extend(fields.as_mut().map(|fields| fields as &mut dyn Observer));
    observers.extend(fronts.as_mut().map(|fronts| fronts as &mut dyn Observer));
    observers.extend(progress.as_mut().map(|progress| progress as &mut dyn Observer));

    let (report, result) = run::run(&model, &mut observers);
    drop(progress);
    let about = About {
        case: path.display().to_string(),
        title: case.title.clone(),
        units: case.units.clone(),
        friction: case.contacts.iter().map(|(name, contact)| (name.clone(), contact.friction)).collect(),
        wave_speeds: wave_speeds::wave_speeds(&model),
        front_slip_rate: case.output.fronts.map(|fronts| fronts.slip_rate),
    };
    let supplied = warnings.audit.supplied;
    let summary = Summary::new(about, &model, report, result.as_ref().err(), warnings.list);
    summary::write(&summary, &folder)?;
    if !quiet {
        summary.warnings[told..].iter().for_each(|warning| eprintln!("warning: {warning}"));
        conclude(&summary, &model, &folder, supplied);
    }
    result?;
    Ok(())
}

/// The last lines of a run on stderr.
fn conclude(summary: &Summary, model: &Model, folder: &Path, supplied: f64) {
    let report = &summary.report;
    eprintln!(
        "{} increments, {} cut-backs, {} rejected, {} linear solves of {} dofs in {:.2} s; results in {}",
        report.increments,
        report.cutbacks,
        report.rejected,
        report.newton_iterations,
        model.dofs(),
        report.wall_s.total,
        folder.display()
    );
    if model.steps.iter().any(|step| step.scheme.is_dynamic() || step.rupture.is_some()) {
        audit(&report.energy, supplied);
    }
}

/// Where the energy of a dynamic run came from and went; `supplied` is the most that there was.
fn audit(energy: &Energy, supplied: f64) {
    let share = if supplied > 0.0 { 100.0 * energy.error() / supplied } else { 0.0 };
    eprintln!("energy: {:.6e} at the start, {:.6e} from outside", energy.initial, energy.external_work);
    eprintln!(
        "        {:.6e} kinetic, {:.6e} strain, {:.6e} in contacts",
        energy.kinetic, energy.strain, energy.contact_elastic
    );
    eprintln!(
        "        {:.6e} taken by friction, {:.6e} by damping, {:.1e} ({share:.4} %) unaccounted for",
        energy.friction_dissipation,
        energy.damping_dissipation,
        energy.error()
    );
}

/// `fecontact check`.
///
/// # Errors
/// [`Failure::BadInput`].
pub fn check(path: &Path) -> Result<(), Failure> {
    let case = case::read(path)?;
    let model = case::build(&case, path)?;
    print(&case::report(&case, &model));
    Ok(())
}

/// `fecontact law`.
///
/// # Errors
/// [`Failure`].
pub fn law(path: &Path, out: Option<PathBuf>) -> Result<(), Failure> {
    let input = law_test::read(path)?;
    let test = law_test::build(&input, path)?;
    let folder = out.unwrap_or_else(|| default_folder(path));
    prepare(&folder)?;

    let mut table = LawTable::create(&folder, &*test.law)?;
    let (report, result) = test.run(|row| table.write(row));
    table.finish()?;
    let about = About {
        case: path.display().to_string(),
        title: input.title,
        units: input.units,
        friction: [("law".into(), input.friction)].into(),
        wave_speeds: [0.0; 3],
        front_slip_rate: None,
    };
    let summary = LawSummary { ending: Ending::new(result.as_ref().err()), about, report };
    summary::write(&summary, &folder)?;
    plot::draw(std::slice::from_ref(&folder), &folder)?;
    conclude_law(&summary.report, &folder);
    result?;
    Ok(())
}

/// The last lines of a test on stderr.
fn conclude_law(report: &LawReport, folder: &Path) {
    let LawReport { steps, most_evaluations, peaks, dissipation, warnings } = report;
    eprintln!("{steps} steps, at most {most_evaluations} evaluations of the law's equation in one");
    if let Some(PathPoint { time, slip, coefficient, mu }) = peaks.peak {
        eprintln!("peak |q|/p = {coefficient:.6} at t = {time:.6}, slip = {slip:.6}, where mu was {mu:.6}");
    }
    for Hold { duration, peak } in &peaks.holds {
        eprintln!("after a hold of {duration:.6}: peak |q|/p = {:.6} at t = {:.6}", peak.coefficient, peak.time);
    }
    eprintln!("dissipation {dissipation:.6}");
    for warning in warnings {
        eprintln!("warning: {warning}");
    }
    eprintln!("results in {}", folder.display());
}

/// `fecontact plot`.
///
/// # Errors
/// [`Failure`].
pub fn plot(folders: &[PathBuf], out: Option<PathBuf>) -> Result<(), Failure> {
    let folder = out.unwrap_or_else(|| match folders {
        [folder] => folder.clone(),
        _ => Path::new("out").join("overlay"),
    });
    let figures = plot::draw(folders, &folder)?;
    figures.iter().for_each(|figure| print(&format!("{}\n", figure.display())));
    Ok(())
}

/// `fecontact schema`.
///
/// # Errors
/// None: the schema is always there.
pub fn schema(of: Input) -> Result<(), Failure> {
    let schema = match of {
        Input::Case => case::schema(),
        Input::Law => law_test::schema(),
    };
    print(&format!("{schema:#}\n"));
    Ok(())
}

/// `out/<name of the file>` in the current folder.
fn default_folder(path: &Path) -> PathBuf {
    Path::new("out").join(path.file_stem().unwrap_or("case".as_ref()))
}

fn print(text: &str) {
    let _ = std::io::stdout().write_all(text.as_bytes());
}

fn use_threads(threads: Option<usize>) -> Result<(), Failure> {
    let Some(threads) = threads else { return Ok(()) };
    if !(1..=MOST_THREADS).contains(&threads) {
        let message = format!("--threads {threads}: give 1 to {MOST_THREADS}, or leave it out for all cores");
        return Err(Failure::BadInput(message));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).use_current_thread().build_global();
    pool.map_err(|error| Failure::BadInput(format!("--threads {threads}: {error}")))
}

/// Make the output folder, and remove the results of an earlier run.
fn prepare(folder: &Path) -> Result<(), Failure> {
    let bad = |what: &Path, cause: std::io::Error| {
        let message = format!("{}: --out: results cannot be written here: {cause}", what.display());
        Failure::BadInput(message)
    };
    std::fs::create_dir_all(folder).map_err(|cause| bad(folder, cause))?;
    let mut old: Vec<PathBuf> =
        RESULTS.iter().chain(&plot::FIGURES).map(|name| folder.join(name)).filter(|path| path.exists()).collect();
    for frames in ["solid", "contact"] {
        let Ok(entries) = std::fs::read_dir(folder.join(frames)) else { continue };
        let paths = entries.flatten().map(|entry| entry.path());
        old.extend(paths.filter(|path| path.extension() == Some("vtu".as_ref())));
    }
    old.iter().try_for_each(|path| std::fs::remove_file(path).map_err(|cause| bad(path, cause)))
}
