//! What an interface did over time and place, as `slip_map.csv` tells it, and its events.

use std::ops::Range;
use std::path::Path;

use super::error::PlotError;
use super::read::Columns;

/// Columns that are read.
const WANTED: [&str; 8] = ["time", "number", "position", "slip", "slip_rate", "mu", "traction", "pressure"];

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
    /// The interfaces of a folder with the numbers of their contacts; none if it has no slip map.
    ///
    /// # Errors
    /// [`PlotError::Unreadable`].
    pub fn read(folder: &Path) -> Result<Vec<(usize, Self)>, PlotError> {
        let path = folder.join("slip_map.csv");
        if !path.is_file() {
            return Ok(Vec::new());
        }
        let columns = Columns::read(&path, |name| WANTED.contains(&name))?;
        let [times, numbers, positions, slips, rates, mu, tractions, pressures] = {
            let mut all = [&[][..]; WANTED.len()];
            for (values, name) in all.iter_mut().zip(WANTED) {
                *values = columns.get(name)?;
            }
            all
        };
        let last = numbers.iter().fold(0.0, |most: f64, number| most.max(*number)) as usize;
        let of = |number: usize| {
            let rows: Vec<usize> = (0..numbers.len()).filter(|&row| numbers[row] as usize == number).collect();
            let points = rows.iter().take_while(|&&row| times[row] == times[rows[0]]).count();
            // The last row may not be finished yet.
            let rows = &rows[..rows.len() - rows.len().checked_rem(points).unwrap_or(0)];
            let pick = |value: &dyn Fn(usize) -> f64| rows.iter().map(|&row| value(row)).collect::<Vec<f64>>();
            let interface = Self {
                times: rows.iter().step_by(points.max(1)).map(|&row| times[row]).collect(),
                positions: rows.iter().take(points).map(|&row| positions[row]).collect(),
                slips: pick(&|row| slips[row]),
                rates: pick(&|row| rates[row].abs()),
                tractions: pick(&|row| tractions[row]),
                strengths: pick(&|row| mu[row] * pressures[row]),
            };
            (number, interface)
        };
        Ok((0..=last).map(of).filter(|(_, interface)| !interface.times.is_empty()).collect())
    }

    /// Sizes of the slip rates of a row: means since the row before [L/T].
    pub fn rates(&self, row: usize) -> &[f64] {
        self.of(&self.rates, row)
    }

    /// Tractions q of a row [F/L²].
    pub fn tractions(&self, row: usize) -> &[f64] {
        self.of(&self.tractions, row)
    }

    /// Peak tractions μ p of a row [F/L²].
    pub fn strengths(&self, row: usize) -> &[f64] {
        self.of(&self.strengths, row)
    }

    fn of<'a>(&self, values: &'a [f64], row: usize) -> &'a [f64] {
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
        let mean = |row: usize| self.of(&self.slips, row).iter().sum::<f64>() / self.positions.len() as f64;
        let before = |row: usize| row.checked_sub(1).map_or(0.0, mean);
        let event = |rows: Range<usize>| Event { slip: (mean(rows.end - 1) - before(rows.start)).abs(), rows };
        runs.into_iter().map(event).collect()
    }

    /// How long so many rows last.
    pub fn length(&self, rows: &Range<usize>) -> f64 {
        self.times[rows.end - 1] - self.start(rows.start)
    }

    /// The largest events, in order of time.
    pub fn largest_events(&self, fast: f64, most: usize) -> Vec<Event> {
        let mut events = self.events(fast);
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
