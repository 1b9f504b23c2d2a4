//! `fecontact run`: a case from its beginning, from the end of another, or from its last checkpoint.

mod keeper;
mod outputs;
mod told;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use self::keeper::Keeper;
use self::outputs::{Outputs, files};
use self::told::Told;
use super::defect;
use super::failure::Failure;
use super::interrupt::Interrupt;
use super::place::{claim, default_folder};
use super::progress::Progress;
use super::threads::use_threads;
use crate::case::Opened;
use crate::model::Model;
use crate::output::checkpoint::{self, Checkpoint};
use crate::output::folder::Folder;
use crate::output::summary::{self, About, Ending, Summary};
use crate::output::wave_speeds;
use crate::run::error::Error;
use crate::run::report::RunReport;
use crate::run::{SavedRun, Simulation, watch_with};

/// How a case is run.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// folder of the results
    pub out: Option<PathBuf>,
    /// threads
    pub threads: Option<usize>,
    /// whether nothing is told
    pub quiet: bool,
    /// whether it goes on from the last checkpoint
    pub resume: bool,
}

/// `fecontact run`.
///
/// # Errors
/// [`Failure`].
pub fn run(path: &Path, options: Options) -> Result<(), Failure> {
    let Options { out, threads, quiet, resume } = options;
    use_threads(threads)?;
    let place = out.unwrap_or_else(|| default_folder(path));
    let (mut opened, damage) = if resume { last(path, &place)? } else { (Opened::open(path)?, None) };
    let (model, saved) = opened.build()?;
    let inputs: Vec<PathBuf> = opened.inputs.iter().cloned().chain([path.to_owned()]).collect();
    let mut folder = claim(&place, &inputs, &files(&opened.case, &model), resume)?;
    let told = Told::start(&model, damage.as_deref(), saved.as_ref().filter(|_| resume), quiet);

    let about = about(&opened, &model);
    let summary = |ending, report, warnings| Summary::new(ending, about.clone(), &model, report, warnings);
    let first = summary(Ending::running(&folder.files), RunReport::default(), model.warnings());
    let mut work = Work { simulation: None, warnings: Vec::new(), supplied: 0.0 };
    let result = defect::catch(|| work.go(&opened, &model, &folder, saved, (&first, resume, quiet)));
    if let (Ok(Err(error)), true, None) = (&result, resume, &work.simulation) {
        return Err(Failure::BadInput(error.to_string()));
    }
    let ending = match &result {
        Ok(result) => Ending::new(result.as_ref().err(), &folder.files),
        Err(defect) => Ending::defect(defect, &folder.files),
    };
    if let Ok(result) = &result {
        folder.make_room_after(result);
    }
    let report = work.simulation.map(|simulation| simulation.report()).unwrap_or_default();
    let last = summary(ending, report, work.warnings);
    let written = summary::write(&last, &folder.path);
    told.end(&last, &model, &folder.path, work.supplied);
    // The first failure is the one to be told.
    result.map_err(Failure::Defect)??;
    Ok(written?)
}

/// A case with the last checkpoint of its folder, and what was wrong with a newer one.
fn last(path: &Path, folder: &Path) -> Result<(Opened, Option<String>), Failure> {
    let newest = checkpoint::newest(folder);
    let (checkpoint, damage) =
        newest.map_err(|(file, why)| Failure::BadInput(format!("{}: --resume: {why}", file.display())))?;
    let Checkpoint { program, .. } = &checkpoint;
    if program != env!("CARGO_PKG_VERSION") {
        say!(
            "warning: the checkpoint is of version {program}: the last digits may differ from those of a run in one go"
        );
    }
    Ok((Opened::resume(path, checkpoint)?, damage))
}

/// What readers of the results need to know of the case.
fn about(opened: &Opened, model: &Model) -> About {
    let case = &opened.case;
    About {
        case: opened.path.display().to_string(),
        title: case.title.clone(),
        units: case.units.clone(),
        friction: case.contacts.iter().map(|(name, contact)| (name.clone(), contact.friction)).collect(),
        wave_speeds: wave_speeds::wave_speeds(model),
        front_slip_rate: case.output.fronts.map(|fronts| fronts.slip_rate),
    }
}

/// What is left of a run however it ends.
struct Work {
    /// `None` until it has begun
    simulation: Option<Simulation>,
    warnings: Vec<String>,
    /// the most energy that there was [F·L]
    supplied: f64,
}

impl Work {
    /// Begin or go on, to the end.
    fn go(
        &mut self,
        opened: &Opened,
        model: &Arc<Model>,
        folder: &Folder,
        saved: Option<SavedRun>,
        (first, resumes, quiet): (&Summary, bool, bool),
    ) -> Result<(), Error> {
        let interrupt = Interrupt::watch();
        let mut keeper = Keeper::new(opened, model, &folder.path);
        // The summary tells whose the files are, and so it comes first; that of a run taken up is true until it goes on.
        if !resumes {
            summary::write(first, &folder.path)?;
        }
        let mut outputs = Outputs::open(&folder.path, model, &opened.case, saved.as_ref())?;
        let mut progress = (!quiet).then(Progress::new);
        let mut observers = outputs.observers(&mut progress);
        let simulation = match saved {
            Some(saved) => saved.resume(model, &mut observers)?,
            None => Simulation::new(model.clone()),
        };
        let simulation = self.simulation.insert(simulation);
        if resumes {
            summary::write(first, &folder.path)?;
        }
        let result = watch_with(simulation, &mut observers, &mut |simulation, observers| {
            keeper.look(simulation, observers, &interrupt, &folder.lock)
        });
        drop(observers);
        self.supplied = outputs.warnings.audit.supplied;
        self.warnings = std::mem::take(&mut outputs.warnings.list);
        self.warnings.extend(keeper.concern);
        result
    }
}
