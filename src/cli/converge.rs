//! `fecontact converge`: a case on meshes and with increments that are refined alike, and what a number of it makes of that.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::failure::Failure;
use super::interrupt::Interrupt;
use super::place::default_folder;
use super::say::print;
use super::threads::use_threads;
use crate::case::convergence::{Convergence, FEWEST, Measure, judge};
use crate::case::job::{Callbacks, Job, Outcome};
use crate::case::{Opened, Written, build, refined};
use crate::model::text::number;
use crate::output::summary::Summary;
use crate::run::error::Error;

/// Implements `fecontact converge`: every level is run into a folder of its own.
///
/// # Errors
/// Returns [`Failure`] if the case or a measure is invalid, a run stopped, or a number does not converge.
pub fn converge(path: &Path, measures: &[String], levels: usize, out: Option<PathBuf>) -> Result<(), Failure> {
    use_threads(None)?;
    let refused = |message: String| Failure::BadInput(format!("--measure: {message}"));
    let read = measures.iter().map(|measure| measure.parse::<Measure>().map_err(refused));
    let read = read.collect::<Result<Vec<_>, _>>()?;
    if levels < FEWEST {
        return Err(Failure::BadInput(format!("--levels: is {levels}: an order takes {FEWEST} or more")));
    }
    let place = out.unwrap_or_else(|| default_folder(path));
    let (written, interrupt) = (Written::read(path)?, Interrupt::watch());
    let model = build(&refined(&written, 0)?.case, path)?;
    read.iter().try_for_each(|measure| measure.check(&model)).map_err(refused)?;
    let mut values = vec![Vec::new(); read.len()];
    for level in 0..levels {
        let folder = place.join(format!("level_{level}"));
        let times = u32::try_from(level).unwrap_or(u32::MAX);
        let Summary { elements, report, .. } = run(refined(&written, times)?, &folder, level, interrupt.clone())?;
        print(&format!("level {level}: {elements} elements, {} increments\n", report.increments))?;
        for (measure, values) in read.iter().zip(&mut values) {
            values.push(measure.of(&folder).map_err(refused)?);
        }
    }
    let judged = values.iter().map(|values| judge(values).map_err(Failure::Stopped));
    let judged = judged.collect::<Result<Vec<_>, _>>()?;
    for (measure, judged) in measures.iter().zip(&judged) {
        print(&format!("{measure}: {}\n", told(judged)))?;
    }
    let fails = measures.iter().zip(&judged).find(|(_, judged)| judged.bar.is_none());
    fails.map_or(Ok(()), |(measure, judged)| Err(Failure::Stopped(format!("{measure} {}", judged.verdict))))
}

/// Values of all levels, and the judgement.
fn told(Convergence { values, extrapolated, bar, verdict, .. }: &Convergence) -> String {
    let values: Vec<String> = values.iter().map(f64::to_string).collect();
    let sure = extrapolated.zip(*bar).map_or(String::new(), |(extrapolated, bar)| {
        format!("\n  extrapolated {extrapolated}, error bar of the last {}", number(bar))
    });
    format!("{}\n  {verdict}{sure}", values.join(", "))
}

/// Runs one level; its warnings go to stderr.
fn run(written: Written, folder: &Path, level: usize, interrupt: Interrupt) -> Result<Summary, Failure> {
    let mut job = Job::open(Opened::begin(written)?, folder)?;
    let warn = move |warning: &str| say!("warning: level {level}: {warning}");
    job.model.warnings().iter().for_each(|warning| warn(warning));
    let outcome = job.run(Callbacks {
        warn: Arc::new(warn),
        ends: Arc::new(move || interrupt.came().then_some(Error::Interrupted)),
        progress: None,
    })?;
    let Outcome { summary, ended, written, .. } = outcome;
    ended?;
    written?;
    Ok(summary)
}
