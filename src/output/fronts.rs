//! `fronts.csv`: passages of slip fronts along interfaces. `events.csv`: the slip events (`events.rs`).
//!
//! ```text
//! t │         •                    •: arrivals at the points of a contact, each with the speed of its neighbours
//!   │ •     •                      the steeper, the slower
//!   │   • •
//!   └────────────── way along the slave
//! ```
//!
//! The slip rate is the plastic slip of an increment divided by its length. A front arrives where the rate exceeds a threshold,
//! interpolated linearly in time between the midpoints of two increments. Its local speed is the distance of the two
//! neighbours along the slave divided by the difference of their arrivals nearest in time (of one neighbour, if it did not pass
//! the other).
//!
//! An event of a contact begins when one of its points exceeds the threshold while no other does, and ends when none does.
//! Its rupture length at an arrival is the tributary length of the points reached by then; its energy released is the energy
//! supplied by loads and stored energies of the whole model since its first arrival:
//!
//! ```text
//! Δ(external work − strain energy − elastic energy of contacts) = Δ(kinetic energy + dissipation)
//! ```
//!
//! Arrivals may instead be defined by threshold values of R or μ at the points; an event is still one of slip, and an
//! arrival outside of events has the event number 0. A frictionless contact has no fronts.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::csv;
use super::csv::Table;
pub use super::events::{ArrivalInput, FrontsInput};
use super::events::{ContactPoints, Energies, Mark, Measures, Passing, WaveSpeeds};
use super::quantities::{EVENTS, FRONTS, names};
use crate::model::{Model, State};
use crate::run::{Attempt, Error, Observer};

/// Observer that writes `fronts.csv` and `events.csv` at the end of the run.
#[derive(Debug)]
pub struct Fronts {
    folder: PathBuf,
    criterion: FrontsInput,
    interfaces: Vec<ContactPoints>,
    /// Start time of the run
    start: f64,
    /// Time and energies of the model at the ends of the last two increments
    last: [(f64, Energies); 2],
}

impl Fronts {
    /// Creates the observer; `start` is the state before the first increment.
    pub fn new(folder: &Path, model: &Model, start: &State, criterion: FrontsInput) -> Self {
        let mut interfaces: Vec<ContactPoints> =
            model.contacts.iter().map(|pair| ContactPoints::new(model, pair)).collect();
        // Earlier slip belongs to no event of this run.
        let points =
            interfaces.iter_mut().zip(&start.contacts).flat_map(|(of, states)| of.points.iter_mut().zip(states));
        points.for_each(|(point, state)| point.mark = Mark::of(state));
        let last = [(start.time, Energies::of(start)); 2];
        Self { folder: folder.into(), criterion, interfaces, start: start.time, last }
    }

    fn increment(&mut self, model: &Model, after: &State) {
        let Self { criterion, last, .. } = *self;
        let passing = Passing { criterion, last, after };
        for ((interface, pair), states) in self.interfaces.iter_mut().zip(&model.contacts).zip(&after.contacts) {
            interface.pass(pair, &passing, states);
        }
        self.last = [last[1], (after.time, Energies::of(after))];
    }

    /// Number of repeated onsets of slip within an event, per point and time, by contact [1/T].
    pub fn chatter(&self) -> BTreeMap<String, f64> {
        let time = self.last[1].0 - self.start;
        self.interfaces.iter().map(|interface| (interface.name.clone(), interface.chatter(time))).collect()
    }

    fn fronts(&self) -> Result<(), Error> {
        let mut table = Table::create(&self.folder.join("fronts.csv"), names(&FRONTS).collect())?;
        for interface in &self.interfaces {
            let events = interface.reached();
            for (k, point) in interface.points.iter().enumerate() {
                for (passage, arrival) in point.arrivals.iter().enumerate() {
                    let speed = interface.speed(k, arrival.time);
                    table.text(&interface.name);
                    table.count(k);
                    table.numbers([point.position, point.at[0], point.at[1]]);
                    table.count(passage + 1);
                    let over =
                        |of: fn(&WaveSpeeds) -> f64| interface.speeds.as_ref().map_or(f64::NAN, |s| speed / of(s));
                    for number in [arrival.time, speed, over(|s| s.rayleigh), over(|s| s.shear), over(|s| s.pressure)] {
                        table.number(number);
                    }
                    table.count(arrival.event);
                    let event = arrival.event.checked_sub(1).and_then(|event| events.get(event));
                    let (length, released) = event.map_or((f64::NAN, f64::NAN), |event| event.by(arrival));
                    table.number(length);
                    table.number(released);
                    table.end_row()?;
                }
            }
        }
        table.flush()
    }

    fn events(&self) -> Result<(), Error> {
        let mut table = Table::create(&self.folder.join("events.csv"), names(&EVENTS).collect())?;
        for interface in &self.interfaces {
            let rayleigh = interface.speeds.as_ref().map_or(f64::NAN, |speeds| speeds.rayleigh);
            for (event, m) in interface
                .events
                .iter()
                .filter_map(|event| Some((event, Measures::of(event, interface, &self.criterion)?)))
            {
                table.text(&interface.name);
                table.count(event.number);
                let when = [m.onset, m.position, m.at[0], m.at[1], event.until - m.onset];
                table.numbers(when);
                table.count(usize::from(event.over));
                let slip = [m.length, m.mean_slip, m.largest_slip, m.peak_slip_rate];
                let energies = [m.stress_drop, m.fracture_energy, m.released, m.radiated];
                let rest = [m.front_speed, m.front_speed / rayleigh, m.seismic_onset, m.seismic_share];
                table.numbers(slip.into_iter().chain(energies).chain(rest));
                table.end_row()?;
            }
        }
        table.flush()
    }
}

impl Observer for Fronts {
    fn name(&self) -> &'static str {
        "fronts"
    }

    fn save(&mut self) -> Result<Vec<u8>, Error> {
        csv::remembered(&(&self.interfaces, self.start, self.last))
    }

    fn restore(&mut self, memory: &[u8]) -> Result<(), Error> {
        (self.interfaces, self.start, self.last) =
            csv::recalled::<(Vec<ContactPoints>, f64, [(f64, Energies); 2])>(memory)?;
        Ok(())
    }

    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        attempt.accepted.into_iter().for_each(|state| self.increment(model, state));
        Ok(())
    }

    fn finish(&mut self) -> Result<(), Error> {
        self.fronts()?;
        self.events()
    }
}
