//! `slip_map.csv` and `fronts.csv`: slip over time and place, and the fronts that run along an interface.
//!
//! The slip rate is the plastic slip since the row before over the time since. A front arrives where it passes a threshold
//! from below, in time linear between the middles of the two intervals. Its local speed is the distance of the two
//! neighbours along the slave over the difference of their arrivals nearest in time (of one, where it passed no other).
//!
//! An event of a contact begins when a point of it passes the threshold while no other is above, and ends when none is. Its
//! rupture length at an arrival is what the points that it has reached by then stand for, its energy released what
//! loads and stored energies of the whole model gave since its first arrival:
//!
//! ```text
//! Δ(external work − strain energy − elastic energy of contacts) = Δ(kinetic energy + dissipation)
//! ```
//!
//! A contact without friction has a slip map, but no fronts.

use std::path::{Path, PathBuf};

use super::csv::{Opening, Table};
use super::memory;
use super::passages::{Arrival, Interface, Point};
use super::wave_speeds::WaveSpeeds;
use crate::contact::force::ContactState;
use crate::laws::friction::observables;
use crate::model::Model;
use crate::model::state::State;
use crate::run::error::Error;
use crate::run::observer::{Attempt, Observer};

/// Columns of `slip_map.csv`.
const MAP: [&str; 13] = [
    "time",
    "contact",
    "number",
    "position",
    "x",
    "y",
    "slip",
    "slip_rate",
    "R",
    "mu",
    "structure",
    "traction",
    "pressure",
];

/// Columns of `fronts.csv`.
const FRONTS: [&str; 14] = [
    "contact",
    "point",
    "position",
    "x",
    "y",
    "passage",
    "arrival",
    "speed",
    "speed_over_c_R",
    "speed_over_c_s",
    "speed_over_c_p",
    "event",
    "rupture_length",
    "energy_released",
];

/// Writes `slip_map.csv` at every row, and `fronts.csv` at the end.
#[derive(Debug)]
pub struct Fronts {
    map: Table,
    /// Observables that have columns of their own at the end
    observed: Vec<&'static str>,
    path: PathBuf,
    /// Slip rate of a front [L/T]
    threshold: f64,
    interfaces: Vec<Interface>,
    /// Times of the last two rows, and what loads and stored energies had given by then [T, F·L]
    last: [(f64, f64); 2],
}

impl Fronts {
    /// Create `slip_map.csv` in `folder`; `start` is the state before the first increment.
    ///
    /// # Errors
    /// [`Error::Output`] when it cannot be written.
    pub fn create(folder: &Path, model: &Model, start: &State, threshold: f64) -> Result<Self, Error> {
        Self::with(Table::create, folder, model, start, threshold)
    }

    /// The `slip_map.csv` that is there, to be restored.
    ///
    /// # Errors
    /// [`Error::Output`] when it cannot be opened.
    pub fn reopen(folder: &Path, model: &Model, start: &State, threshold: f64) -> Result<Self, Error> {
        Self::with(Table::reopen, folder, model, start, threshold)
    }

    fn with(open: Opening, folder: &Path, model: &Model, start: &State, threshold: f64) -> Result<Self, Error> {
        let observed = observables::further(model.contacts.iter().flat_map(|pair| &pair.laws).map(|law| &**law));
        let header: Vec<String> = MAP.iter().chain(&observed).map(|name| (*name).into()).collect();
        let mut interfaces: Vec<Interface> = model.contacts.iter().map(|pair| Interface::new(model, pair)).collect();
        // What had slipped before is no event of this run.
        let points =
            interfaces.iter_mut().zip(&start.contacts).flat_map(|(of, states)| of.points.iter_mut().zip(states));
        points.for_each(|(point, state)| point.slip = state.friction.plastic_slip);
        Ok(Self {
            map: open(&folder.join("slip_map.csv"), &header)?,
            observed,
            path: folder.join("fronts.csv"),
            threshold,
            interfaces,
            last: [(start.time, given(start)); 2],
        })
    }

    fn row(&mut self, model: &Model, state: &State) -> Result<(), Error> {
        let [(earlier, given_earlier), (before, given_before)] = self.last;
        let (old_dt, dt) = (before - earlier, state.time - before);
        let now = given(state);
        let given_at = |time: f64| match time < before {
            true => given_before + (given_before - given_earlier) * (time - before) / old_dt,
            false => given_before + (now - given_before) * (time - before) / dt,
        };
        let all = self.interfaces.iter_mut().zip(&model.contacts).zip(&state.contacts).enumerate();
        for (number, ((interface, pair), states)) in all {
            let slip_rate = |(point, state): (&Point, &ContactState)| (state.friction.plastic_slip - point.slip) / dt;
            let mut rubbing = interface.points.iter().zip(states).filter(|(point, _)| point.rubs);
            let slipping = rubbing.any(|both| slip_rate(both).abs() > self.threshold);
            interface.events += usize::from(slipping && !interface.slipping);
            interface.slipping = slipping;
            for ((point, slave), contact) in interface.points.iter_mut().zip(&pair.points).zip(states) {
                let friction = &contact.friction;
                let rate = (friction.plastic_slip - point.slip) / dt;
                if point.rubs && point.rate.abs() <= self.threshold && rate.abs() > self.threshold {
                    let share = (self.threshold - point.rate.abs()) / (rate.abs() - point.rate.abs());
                    let time = before - 0.5 * old_dt + share * 0.5 * (old_dt + dt);
                    point.arrivals.push(Arrival { time, event: interface.events, given: given_at(time) });
                }
                (point.slip, point.rate) = (friction.plastic_slip, rate);
                self.map.number(state.time);
                self.map.text(&interface.name);
                self.map.count(number);
                let observed = |name: &str| observables::value(pair.law(slave), name, friction);
                let [x, y] = point.at;
                [point.position, x, y, point.slip, rate].into_iter().for_each(|number| self.map.number(number));
                observables::ALWAYS.iter().for_each(|(name, _)| self.map.number(observed(name)));
                [friction.traction, friction.pressure].into_iter().for_each(|number| self.map.number(number));
                self.observed.iter().for_each(|name| self.map.number(observed(name)));
                self.map.end_row()?;
            }
        }
        self.last = [(before, given_before), (state.time, now)];
        self.map.share()
    }

    fn fronts(&self) -> Result<(), Error> {
        let mut table = Table::create(&self.path, &FRONTS.map(String::from))?;
        for interface in &self.interfaces {
            let events = interface.events();
            for (k, point) in interface.points.iter().enumerate() {
                for (passage, arrival) in point.arrivals.iter().enumerate() {
                    let speed = interface.speed(k, arrival.time);
                    table.text(&interface.name);
                    table.count(k);
                    [point.position, point.at[0], point.at[1]].into_iter().for_each(|number| table.number(number));
                    table.count(passage + 1);
                    let over =
                        |of: fn(&WaveSpeeds) -> f64| interface.speeds.as_ref().map_or(f64::NAN, |s| speed / of(s));
                    for number in [arrival.time, speed, over(|s| s.rayleigh), over(|s| s.shear), over(|s| s.pressure)] {
                        table.number(number);
                    }
                    table.count(arrival.event);
                    let (length, released) = events[arrival.event - 1].by(arrival);
                    table.number(length);
                    table.number(released);
                    table.end_row()?;
                }
            }
        }
        table.flush()
    }
}

/// What loads and stored energies have given since the start of the run [F·L].
fn given(state: &State) -> f64 {
    let energy = &state.energy;
    energy.external_work - energy.strain - energy.contact_elastic
}

impl Observer for Fronts {
    fn name(&self) -> &'static str {
        "fronts"
    }

    fn save(&mut self) -> Result<Vec<u8>, Error> {
        memory::written(&(self.map.length()?, &self.interfaces, self.last))
    }

    fn restore(&mut self, memory: &[u8]) -> Result<(), Error> {
        let length;
        (length, self.interfaces, self.last) = memory::read(memory)?;
        self.map.cut(length)
    }

    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        attempt.accepted.map_or(Ok(()), |state| self.row(model, state))
    }

    fn finish(&mut self) -> Result<(), Error> {
        self.map.flush()?;
        self.fronts()
    }
}
