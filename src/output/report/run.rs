//! Page data of one results folder.

use serde_json::{Value, json};

use super::newton::{HARDEST, attempts, increments, residuals, solves};
use super::series::{Series, map};
use super::source::{ReportError, Source};
use super::table::{Column, Columns, Pack, read, sheet};
use crate::laws::friction::FrictionParameters;
use crate::output::files;
use crate::output::store::read::{StoredContact, contacts};

/// Upper bound of the rows of a table.
const ROWS: usize = 40_000;

/// Rough size of a packed number [bytes].
const NUMBER: f64 = 3.0;

/// Rows of newton.csv beyond which only its increments are shown.
const ITERATIONS: usize = 20_000;

/// A results folder being added to a page.
pub struct Run<'a> {
    source: &'a Source,
    /// part of the page available to it [bytes]
    room: usize,
    /// omissions and defects
    notes: Vec<String>,
    /// last time of its table
    until: Option<f64>,
}

impl<'a> Run<'a> {
    pub fn new(source: &'a Source, room: usize) -> Self {
        Self { source, room, notes: Vec::new(), until: None }
    }

    /// Number of rows of `numbers` values each that fit into a fraction of the room.
    fn fit(&self, share: f64, numbers: usize) -> usize {
        (share * self.room as f64 / (NUMBER * numbers.max(1) as f64)) as usize
    }

    /// Returns all page data of the run.
    pub fn show(mut self, pack: &mut Pack) -> Value {
        let summary = self.summary();
        let status = summary["status"].as_str().unwrap_or("unknown").to_owned();
        let start = pack.text.len();
        let history = self.over_time("history.csv", pack);
        let law = self.over_time("law.csv", pack);
        let newton = self.newton(status == "completed", pack);
        let fronts = self.small_table("fronts.csv", pack);
        let events = self.small_table("events.csv", pack);
        let interfaces = self.maps(pack);
        let left = self.room.saturating_sub(pack.text.len() - start);
        let [solid, contact, bars] = self.frames(left, pack);
        let about = &self.source.about;
        let bounds = about.friction.iter().map(|(name, law)| (name.clone(), json!(FrictionParameters::bounds(law))));
        json!({
            "name": self.source.name,
            "folder": self.source.folder.display().to_string(),
            "summary": summary,
            "at_work": files::at_work(&self.source.folder),
            "bounds": bounds.collect::<serde_json::Map<String, Value>>(),
            "history": history,
            "law": law,
            "newton": newton,
            "fronts": fronts,
            "events": events,
            "interfaces": interfaces,
            "solid": solid,
            "contact": contact,
            "bars": bars,
            "until": self.until,
            "notes": self.notes,
        })
    }

    fn summary(&mut self) -> Value {
        let read = std::fs::read_to_string(self.source.folder.join("summary.json"));
        let summary = read.ok().and_then(|text| serde_json::from_str(&text).ok());
        summary.filter(Value::is_object).unwrap_or_else(|| {
            self.notes.push("summary.json is missing or cannot be read: the end status of the run is unknown".into());
            json!({})
        })
    }

    /// Table of a time series: the history of a run or of a law test.
    fn over_time(&mut self, file: &str, pack: &mut Pack) -> Value {
        let Some(table) = read(&self.source.folder, file, &mut self.notes) else { return Value::Null };
        if table.get("time").is_err() {
            self.notes.push(format!("{file} has no column `time`; it is not shown"));
            return Value::Null;
        }
        let all = table.rows();
        if all == 0 {
            self.notes.push(format!("{file} has no rows yet"));
            return Value::Null;
        }
        for (name, count) in table.not_numbers() {
            self.notes.push(format!("{file}: {count} values of {name} are not numbers and are left blank"));
        }
        self.until = table.get("time").ok().and_then(|times| times.last().copied());
        let shown = table.spread(self.fit(0.2, table.count()).min(ROWS));
        if shown.len() < all {
            let shown = shown.len();
            self.notes.push(format!("{file}: {shown} of {all} rows are shown, including the extremes of every column"));
        }
        table.sheet(&shown, pack)
    }

    /// Residuals of the hardest increments, solves of all, and rejected attempts.
    fn newton(&mut self, complete: bool, pack: &mut Pack) -> Value {
        let Some(newton) = read(&self.source.folder, "newton.csv", &mut self.notes) else { return Value::Null };
        self.convergence(&newton, complete, pack).unwrap_or_else(|fault| {
            self.notes.push(format!("{fault}; convergence is not shown"));
            Value::Null
        })
    }

    fn convergence(&mut self, newton: &Columns, complete: bool, pack: &mut Pack) -> Result<Value, ReportError> {
        let all = increments(newton)?;
        if all.is_empty() {
            return Ok(Value::Null);
        }
        let (mut iterations, mut of_increment) = (Vec::new(), Vec::new());
        for [iteration, residual] in residuals(newton, &all)?.into_iter().take(self.fit(0.05, 2).min(ITERATIONS)) {
            iterations.push(iteration);
            of_increment.push(residual);
        }
        // Of many increments, the one with the most solves in each group is shown.
        let group = all.len().div_ceil(self.fit(0.05, 3).clamp(1, ROWS));
        let (mut times, mut counts) = (Vec::new(), Vec::new());
        for hardest in all.chunks(group).filter_map(|some| some.iter().max_by_key(|rows| rows.len())) {
            let [time, count] = solves(newton, hardest)?;
            times.push(time);
            counts.push(count);
        }
        let residuals = [Column::numbers("iteration", iterations), Column::numbers("residual", of_increment)];
        let solves = [Column::numbers("time", times), Column::numbers("solves", counts)];
        Ok(json!({
            "increments": all.len(),
            "hardest": all.len().min(HARDEST),
            "residuals": sheet(residuals, pack),
            "solves": sheet(solves, pack),
            "attempts": attempts(newton, complete),
        }))
    }

    /// Table written at the end of a run, complete except for rows that do not fit.
    fn small_table(&mut self, file: &str, pack: &mut Pack) -> Value {
        let Some(table) = read(&self.source.folder, file, &mut self.notes) else { return Value::Null };
        let all = table.rows();
        let most = self.fit(0.1, table.count()).min(ROWS);
        if all > most {
            self.notes.push(format!("{file}: the first {most} of {all} rows are shown"));
        }
        let shown: Vec<usize> = (0..all.min(most)).collect();
        table.sheet(&shown, pack)
    }

    /// Upper bound of the number of values per quantity of each map.
    fn values(&self, maps: &[StoredContact]) -> usize {
        self.fit(0.4, maps.iter().map(|map| map.quantities.len()).sum())
    }

    fn maps(&mut self, pack: &mut Pack) -> Vec<Value> {
        match contacts(&self.source.folder, |_| true) {
            Ok(mut maps) => {
                maps.retain(|map| !map.times.is_empty());
                let most = self.values(&maps);
                maps.iter().enumerate().map(|(k, contact)| map(k, contact, most, pack, &mut self.notes)).collect()
            }
            Err(fault) => {
                self.notes.push(format!("{fault}; the interface is not shown"));
                Vec::new()
            }
        }
    }

    /// Bodies, contacts and bars, frame by frame.
    fn frames(&mut self, room: usize, pack: &mut Pack) -> [Value; 3] {
        let start = pack.text.len();
        let contact = Series::read(&self.source.folder, "contact", room / 2, &mut self.notes);
        let left = |pack: &Pack| room.saturating_sub(pack.text.len() - start);
        // Half of the remaining room suffices for tractions.
        let solid = Series::read(&self.source.folder, "solid", left(pack) * 4 / 5, &mut self.notes);
        let bodies = solid.as_ref().map_or(Value::Null, |solid| solid.show(&solid.times(), pack));
        let times = solid.as_ref().or(contact.as_ref()).map_or_else(Vec::new, Series::times);
        let contact = contact.map_or(Value::Null, |contact| contact.show(&times, pack));
        let bars = Series::read(&self.source.folder, "bars", left(pack), &mut self.notes);
        let bars = bars.map_or(Value::Null, |bars| bars.show(&times, pack));
        [bodies, contact, bars]
    }
}
