//! What an interface did over time and place, as `interface.zarr` tells it, and its events.

use std::ops::Range;
use std::path::Path;

use super::error::PlotError;
use crate::output::interface::STORE;
use crate::output::interface::read::{self, StoredContact};

/// Quantities that are read.
const WANTED: [&str; 5] = ["slip", "slip_rate", "mu", "q", "p"];

/// Mean slip of an event worth showing, over the largest slip of a point.
const LITTLE: f64 = 1e-3;

/// Where no slip rate is given that makes a front: this share of the highest.
const FAST: f64 = 0.01;

/// The rows of one contact: a row a time, in each row a value a point.
pub struct Interface {
    /// of the rows, ascending
    pub times: Vec<f64>,
    /// of the points along the slave
    pub positions: Vec<f64>,
    slips: Vec<f64>,
    rates: Vec<f64>,
    tractions: Vec<f64>,
    strengths: Vec<f64>,
}

/// Consecutive rows in which some point slips at the rate of a front.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// the rows
    pub rows: Range<usize>,
    /// what the points slip in it on average [L]
    pub slip: f64,
}

impl Interface {
    /// The interfaces of a folder with the names of their contacts; none where nothing was written yet.
    ///
    /// # Errors
    /// [`PlotError::Unreadable`].
    pub fn read(folder: &Path) -> Result<Vec<(String, Self)>, PlotError> {
        let contacts = read::contacts(folder, |name| WANTED.contains(&name))?;
        contacts
            .into_iter()
            .filter(|contact| !contact.times.is_empty())
            .map(|contact| Self::of_contact(contact, folder))
            .collect()
    }

    fn of_contact(mut contact: StoredContact, folder: &Path) -> Result<(String, Self), PlotError> {
        let mut all = [const { Vec::new() }; WANTED.len()];
        for (values, name) in all.iter_mut().zip(WANTED) {
            let missing = || PlotError::Unreadable {
                path: folder.join(STORE),
                cause: format!("has no `{name}` of {}: was it written by another version?", contact.name),
            };
            let found = contact.quantities.remove(name).ok_or_else(missing)?;
            *values = found.into_iter().map(f64::from).collect();
        }
        let [slips, mut rates, mu, tractions, mut strengths] = all;
        rates.iter_mut().for_each(|rate| *rate = rate.abs());
        strengths.iter_mut().zip(mu).for_each(|(strength, mu)| *strength *= mu);
        let StoredContact { name, times, positions, .. } = contact;
        Ok((name, Self { times, positions, slips, rates, tractions, strengths }))
    }

    /// Sizes of the slip rates of a row: means since the row before [L/T].
    pub fn rates(&self, row: usize) -> &[f64] {
        self.row_of(&self.rates, row)
    }

    /// Tractions q of a row [F/L²].
    pub fn tractions(&self, row: usize) -> &[f64] {
        self.row_of(&self.tractions, row)
    }

    /// Peak tractions μ p of a row [F/L²].
    pub fn strengths(&self, row: usize) -> &[f64] {
        self.row_of(&self.strengths, row)
    }

    fn row_of<'a>(&self, values: &'a [f64], row: usize) -> &'a [f64] {
        let points = self.positions.len();
        &values[row * points..(row + 1) * points]
    }

    /// The highest slip rate of all.
    pub fn highest_rate(&self) -> f64 {
        self.rates.iter().copied().fold(0.0, f64::max)
    }

    /// Start of the interval of a row: the row before. That of the first row is taken as long as that of the second.
    pub fn start(&self, row: usize) -> f64 {
        match (row, self.times.get(1)) {
            (0, Some(second)) => (2.0 * self.times[0] - second).max(0.0),
            (0, None) => 0.0,
            _ => self.times[row - 1],
        }
    }

    /// The slip rate that makes a front, if it is not known from elsewhere.
    pub fn fast(&self, known: Option<f64>) -> f64 {
        known.unwrap_or(FAST * self.highest_rate())
    }

    /// The rows with a slip rate above `fast`. What slips again before it has rested as long as it slipped is one event.
    pub fn events(&self, fast: f64) -> Vec<Event> {
        let mut runs: Vec<Range<usize>> = Vec::new();
        for row in (0..self.times.len()).filter(|&row| self.rates(row).iter().any(|rate| *rate > fast)) {
            let again = runs.last_mut().filter(|run| {
                let (rested, slipped) = (self.start(row) - self.times[run.end - 1], self.length(run));
                run.end == row || rested < slipped
            });
            match again {
                Some(run) => run.end = row + 1,
                None => runs.push(row..row + 1),
            }
        }
        let mean = |row: usize| self.row_of(&self.slips, row).iter().sum::<f64>() / self.positions.len() as f64;
        let before = |row: usize| row.checked_sub(1).map_or(0.0, mean);
        let event = |rows: Range<usize>| Event { slip: (mean(rows.end - 1) - before(rows.start)).abs(), rows };
        runs.into_iter().map(event).collect()
    }

    /// The columns of a map in which the points lie and, of each column, the nearest that has a point: its own where the points are
    /// close, another's where a mesh is coarser than the map.
    pub fn columns(&self, column: impl Fn(f64) -> usize, count: usize) -> (Vec<usize>, Vec<usize>) {
        let own: Vec<usize> = self.positions.iter().map(|s| column(*s)).collect();
        let nearest = |column: usize| own.iter().copied().min_by_key(|other| other.abs_diff(column)).unwrap_or(column);
        let nearest = (0..count).map(nearest).collect();
        (own, nearest)
    }

    /// How long so many rows last.
    pub fn length(&self, rows: &Range<usize>) -> f64 {
        self.times[rows.end - 1] - self.start(rows.start)
    }

    /// The largest events, in order of time; those whose slip is next to nothing are none.
    pub fn largest_events(&self, fast: f64, most: usize) -> Vec<Event> {
        let mut events = self.events(fast);
        let largest = self.slips.iter().fold(0.0, |most: f64, slip| most.max(slip.abs()));
        events.retain(|event| event.slip > LITTLE * largest);
        events.sort_by(|a, b| b.slip.total_cmp(&a.slip));
        events.truncate(most);
        events.sort_by_key(|event| event.rows.start);
        events
    }

    /// Row of an event in which a share of the points that become fast in it have done so.
    pub fn row_reaching(&self, event: &Event, share: f64, fast: f64) -> usize {
        let Range { start, end } = event.rows;
        let first = |point: usize| (start..end).find(|&row| self.rates(row)[point] > fast);
        let mut arrivals: Vec<usize> = (0..self.positions.len()).filter_map(first).collect();
        arrivals.sort_unstable();
        let last = arrivals.len().saturating_sub(1);
        arrivals.get((share * last as f64).round() as usize).copied().unwrap_or(start)
    }
}
