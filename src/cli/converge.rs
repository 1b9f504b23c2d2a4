//! `fecontact converge`: a case on meshes and with increments that are refined alike, and what a number of it makes of that.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::failure::Failure;
use super::interrupt::Interrupt;
use super::place::default_folder;
use super::say::print;
use super::threads::use_threads;
use crate::case::convergence::{Convergence, FEWEST, Measure, fraction_of_increments, judge};
use crate::case::job::{Callbacks, Job, Outcome};
use crate::case::{Halvings, Opened, Written, build, refined, warnings};
use crate::model::text::number;
use crate::output::summary::Summary;
use crate::run::error::Error;

/// Options of `fecontact converge`.
#[derive(Clone, Debug)]
pub struct Study {
    /// numbers that are judged
    pub measures: Vec<String>,
    /// number of runs
    pub levels: usize,
    /// fraction of a number within which changes need no order
    pub within: f64,
    /// folder of the results
    pub out: Option<PathBuf>,
    /// number of threads
    pub threads: Option<usize>,
}

/// Implements `fecontact converge`: every level is run into a folder of its own.
///
/// # Errors
/// Returns [`Failure`] if the case or a measure is invalid, a run stopped, or a number does not converge.
pub fn converge(path: &Path, study: Study) -> Result<(), Failure> {
    let Study { measures, levels, within, out, threads } = study;
    use_threads(threads)?;
    let refused = |message: String| Failure::BadInput(format!("--measure: {message}"));
    let read = measures.iter().map(|measure| measure.parse::<Measure>().map_err(refused));
    let read = read.collect::<Result<Vec<_>, _>>()?;
    if levels < FEWEST {
        return Err(Failure::BadInput(format!(
            "--levels: is {levels}: an order of convergence needs {FEWEST} or more"
        )));
    }
    if !(0.0..1.0).contains(&within) {
        return Err(Failure::BadInput(format!(
            "--within: is {within}: must be a fraction of the number, from 0 to less than 1"
        )));
    }
    let place = out.unwrap_or_else(|| default_folder(path));
    let (written, interrupt) = (Written::read(path)?, Interrupt::watch());
    let model = build(&refined(&written, Halvings::of_both(0))?.case, path)?;
    read.iter().try_for_each(|measure| measure.check(&model)).map_err(refused)?;
    let measured = |name: &str, refined: Written| -> Result<Vec<f64>, Failure> {
        let (folder, name) = (place.join(name), name.replace('_', " "));
        let there = |failure| match failure {
            Failure::Stopped(why) => Failure::Stopped(format!("{name}: {why}")),
            failure => failure,
        };
        let Summary { elements, report, .. } = run(refined, &folder, name.clone(), interrupt.clone()).map_err(there)?;
        print(&format!("{name}: {elements} elements, {} increments\n", report.increments))?;
        read.iter().map(|measure| measure.of(&folder).map_err(|why| there(Failure::Stopped(why)))).collect()
    };
    let mut values = vec![Vec::new(); read.len()];
    let last = u32::try_from(levels - 1).unwrap_or(u32::MAX);
    let finest = refined(&written, Halvings::of_both(last))?;
    let longer = refined(&written, Halvings { mesh: last, increments: last - 1 })?;
    for level in 0..=last {
        let found = measured(&format!("level_{level}"), refined(&written, Halvings::of_both(level))?)?;
        values.iter_mut().zip(found).for_each(|(values, found)| values.push(found));
    }
    // Explicit increments follow from the mesh: there are no others on it.
    let has_longer = finest.document != longer.document;
    let longer = if has_longer { measured(&format!("level_{last}_longer_increments"), longer)? } else { Vec::new() };
    let fractions = values.iter().zip(&longer).map(|(values, longer)| fraction_of_increments(values, *longer));
    let fractions: Vec<Option<f64>> = fractions.chain(std::iter::repeat(None)).take(read.len()).collect();
    let judged = values.iter().map(|values| judge(values, within).map_err(Failure::Stopped));
    let judged = judged.collect::<Result<Vec<_>, _>>()?;
    for ((measure, judged), fraction) in measures.iter().zip(&judged).zip(fractions) {
        print(&format!("{measure}: {}\n", verdict_text(judged, fraction)))?;
    }
    let fails = measures.iter().zip(&judged).find(|(_, judged)| judged.bar.is_none() && !judged.settled);
    fails.map_or(Ok(()), |(measure, judged)| Err(Failure::Stopped(format!("{measure} {}", judged.verdict))))
}

/// Values of all levels, the judgement, and the fraction of the last difference that is due to the increments.
fn verdict_text(Convergence { values, extrapolated, bar, verdict, .. }: &Convergence, fraction: Option<f64>) -> String {
    let values: Vec<String> = values.iter().map(f64::to_string).collect();
    let sure = extrapolated.zip(*bar).map_or(String::new(), |(extrapolated, bar)| {
        format!("\n  extrapolated {extrapolated}, error bar of the last {}", number(bar))
    });
    let parts = fraction.map_or(String::new(), |fraction| {
        let [mesh, increments] = [1.0 - fraction, fraction].map(|part| (100.0 * part).round());
        format!("\n  of the last difference {mesh} % by the mesh, {increments} % by the increments")
    });
    format!("{}\n  {verdict}{sure}{parts}", values.join(", "))
}

/// Runs one level; its warnings go to stderr.
fn run(written: Written, folder: &Path, name: String, interrupt: Interrupt) -> Result<Summary, Failure> {
    let mut job = Job::open(Opened::begin(written)?, folder)?;
    let warn = move |warning: &str| say!("warning: {name}: {warning}");
    warnings(&job.opened.case, &job.model).iter().for_each(|warning| warn(warning));
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
