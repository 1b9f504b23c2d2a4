//! Slip events, from their onset to their end.
//!
//! An event of a contact begins when one of its points slips faster than the threshold while no other does, and ends when none
//! does. Its points are those reached by a front during the event. Their slip s, traction q and work ∫ |q| ds count
//! from the increment before the event; means are weighted by the tributary lengths of the points.
//!
//! ```text
//! stress drop       q before − q after, positive where slip has unloaded
//! fracture energy   ∫ (q − q_min) ds up to the minimum of q, q_min: work in excess of sliding at that traction
//! released          Δ(external work − strain energy − elastic energy of contacts), of the whole model
//! radiated          released − Δ(dissipation by friction): kinetic energy, and energy absorbed by dampers and absorbing sides
//! seismic share     ∫ s_seismic dl/∫ s dl, with s_seismic the slip in rows whose slip rate is above the seismic one
//! front speed       slope of the distance from where it began over the arrivals, by least squares
//! ```
//!
//! Source of the fracture energy: Palmer & Rice (1973), doi:10.1098/rspa.1973.0040; Tinti et al. (2005),
//! doi:10.1029/2005JB003644, who call it breakdown work.
//!
//! The measures of an event are its row in `events.csv`.
//!
//! The passages of fronts are recorded per point of an interface, with their events.
//!
//! Speeds of elastic waves serve as reference for the speed of fronts.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::contact::{ContactPair, ContactState};
use crate::laws::bulk::Material;
use crate::model::builder::{ModelError, check_positive};
use crate::model::{Model, State};

/// A slip event, complete or in progress.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct SlipEvent {
    /// Number in its contact, from 1
    pub number: usize,
    /// Time up to which it is recorded, and whether that is its end
    pub until: f64,
    pub over: bool,
    /// Energies of the model at the onset, and at `until`
    pub energies: [Energies; 2],
    /// Record of each point
    pub courses: Vec<PointRecord>,
    /// Time when a point first slipped faster than the seismic rate: the row before
    seismic_onset: Option<f64>,
}

/// Energy released by loads and stored energies, and dissipated by friction, since the start of the run [F·L].
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Energies {
    pub given: f64,
    pub friction: f64,
}

impl Energies {
    /// Energies of a state.
    pub fn of(state: &State) -> Self {
        let energy = &state.energy;
        let given = energy.external_work - energy.strain - energy.contact_elastic;
        Self { given, friction: energy.friction_dissipation }
    }
}

/// Record of a point in an event.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct PointRecord {
    /// Plastic slip, traction and work before
    before: Mark,
    /// State at the smallest |q|
    least: Mark,
    /// State at the last row
    last: Mark,
    pub peak_rate: f64,
    /// Plastic slip while it slipped faster than the seismic rate [L]
    seismic_slip: f64,
}

/// Plastic slip [L], q [F/L²] and ∫ |q| ds [F/L] of a point.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Mark {
    pub slip: f64,
    traction: f64,
    work: f64,
}

impl Mark {
    /// Slip, traction and work of a contact point.
    pub fn of(state: &ContactState) -> Self {
        let friction = &state.friction;
        Self { slip: friction.plastic_slip, traction: state.shear(), work: friction.dissipation }
    }
}

impl SlipEvent {
    /// Starts an event at the end of the previous increment, given the marks of the points and the energies of the model there.
    pub fn begin(number: usize, marks: impl Iterator<Item = Mark>, until: f64, energies: Energies) -> Self {
        let course =
            |mark: Mark| PointRecord { before: mark, least: mark, last: mark, peak_rate: 0.0, seismic_slip: 0.0 };
        let courses = marks.map(course).collect();
        Self { number, until, over: false, energies: [energies; 2], courses, seismic_onset: None }
    }

    /// Adds an increment; `over` if no point slips any more. Slip faster than `seismic` is summed separately.
    pub fn go_on(&mut self, state: &State, marks: &[Mark], rates: &[f64], seismic: f64, over: bool) {
        for (course, (&mark, rate)) in self.courses.iter_mut().zip(marks.iter().zip(rates)) {
            if rate.abs() > seismic {
                course.seismic_slip += mark.slip - course.last.slip;
                self.seismic_onset.get_or_insert(self.until);
            }
            if mark.traction.abs() < course.least.traction.abs() && mark.slip != course.before.slip {
                course.least = mark;
            }
            course.last = mark;
            course.peak_rate = course.peak_rate.max(rate.abs());
        }
        (self.until, self.over, self.energies[1]) = (state.time, over, Energies::of(state));
    }
}

impl PointRecord {
    /// Slip so far
    pub fn slip(&self) -> f64 {
        self.last.slip - self.before.slip
    }

    /// Decrease of the traction in the direction of slip
    pub fn stress_drop(&self) -> f64 {
        (self.before.traction - self.last.traction) * self.slip().signum()
    }

    /// Work in excess of that at the minimum traction
    pub fn fracture_energy(&self) -> f64 {
        let slip = (self.least.slip - self.before.slip).abs();
        (self.least.work - self.before.work - self.least.traction.abs() * slip).max(0.0)
    }
}

/// Measures of an event.
pub(super) struct Measures {
    /// Time and place of the first arrival
    pub onset: f64,
    pub position: f64,
    pub at: [f64; 2],
    /// Tributary length of its points [L]
    pub length: f64,
    pub mean_slip: f64,
    pub largest_slip: f64,
    pub peak_slip_rate: f64,
    pub stress_drop: f64,
    pub fracture_energy: f64,
    pub released: f64,
    pub radiated: f64,
    pub front_speed: f64,
    /// First slip faster than the seismic rate, and the share of slip times length at such rates; NaN if no rate is given
    pub seismic_onset: f64,
    pub seismic_share: f64,
}

impl Measures {
    /// Returns the measures of an event; `None` if no front has reached a point.
    pub fn of(event: &SlipEvent, interface: &ContactPoints, criterion: &FrontsInput) -> Option<Self> {
        let reached: Vec<(&Point, &PointRecord, f64)> = interface
            .points
            .iter()
            .zip(&event.courses)
            .filter_map(|(point, course)| {
                let arrival = point.arrivals.iter().find(|arrival| arrival.event == event.number)?;
                Some((point, course, arrival.time))
            })
            .collect();
        let (first, _, onset) = *reached.iter().min_by(|a, b| a.2.total_cmp(&b.2))?;
        let length: f64 = reached.iter().map(|(point, ..)| point.length).sum();
        let mean = |of: &dyn Fn(&PointRecord) -> f64| {
            reached.iter().map(|(point, course, _)| point.length * of(course)).sum::<f64>() / length
        };
        let largest =
            |of: &dyn Fn(&PointRecord) -> f64| reached.iter().map(|(_, course, _)| of(course)).fold(0.0, f64::max);
        let [start, end] = event.energies;
        let released = end.given - start.given;
        let share = mean(&|course| course.seismic_slip.abs()) / mean(&|course| course.slip().abs());
        Some(Self {
            onset,
            position: first.position,
            at: first.at,
            length,
            mean_slip: mean(&PointRecord::slip),
            largest_slip: largest(&|course| course.slip().abs()),
            peak_slip_rate: largest(&|course| course.peak_rate),
            stress_drop: mean(&PointRecord::stress_drop),
            fracture_energy: mean(&PointRecord::fracture_energy),
            released,
            radiated: released - (end.friction - start.friction),
            front_speed: front_speed(first, onset, &reached),
            seismic_onset: event.seismic_onset.unwrap_or(f64::NAN),
            seismic_share: if criterion.seismic_rate.is_some() { share } else { f64::NAN },
        })
    }
}

/// Slope of the distance from the first point of a line over the time of arrival; NaN if undefined.
fn front_speed(first: &Point, onset: f64, reached: &[(&Point, &PointRecord, f64)]) -> f64 {
    let near = reached.iter().filter(|(point, ..)| point.line == first.line);
    let pairs: Vec<[f64; 2]> =
        near.map(|(point, _, time)| [time - onset, (point.position - first.position).abs()]).collect();
    let count = pairs.len() as f64;
    let mean = [0, 1].map(|i| pairs.iter().map(|pair| pair[i]).sum::<f64>() / count);
    let (both, square) = pairs.iter().fold((0.0, 0.0), |(both, square), [t, d]| {
        (both + (t - mean[0]) * (d - mean[1]), square + (t - mean[0]).powi(2))
    });
    if square > 0.0 { both / square } else { f64::NAN }
}

/// A point of the slave surface: its place, and its history so far.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Point {
    /// Number of its unbroken line
    pub line: usize,
    /// Distance along the line [L]
    pub position: f64,
    pub at: [f64; 2],
    /// Tributary length of the point [L]
    pub length: f64,
    /// Whether it has friction; frictionless points have no fronts
    pub rubs: bool,
    /// State after the last increment
    pub mark: Mark,
    /// Slip rate of that increment [L/T], and the signal that defines an arrival (see [`ArrivalInput`])
    pub rate: f64,
    pub signal: f64,
    pub arrivals: Vec<Arrival>,
}

/// Arrival of a front at a point.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Arrival {
    /// [T]
    pub time: f64,
    /// Number of the event of the contact, from 1; 0 outside of events
    pub event: usize,
    /// Energy supplied by loads and released by stored energies since the start of the run [F·L]
    pub given: f64,
}

/// The points of one contact.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct ContactPoints {
    pub name: String,
    pub speeds: Option<WaveSpeeds>,
    pub points: Vec<Point>,
    /// Events so far; the last one may be in progress
    pub events: Vec<SlipEvent>,
}

/// Definition of fronts.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FrontsInput {
    /// Slip rate that marks the arrival of a front when it is exceeded; a slip event lasts while any point of the contact
    /// slips faster [L/T]
    pub slip_rate: f64,
    /// Slip rate from which slip counts as seismic, above `slip_rate`: `events.csv` then says when an event became
    /// seismic, and which share of its slip was [L/T]
    pub seismic_rate: Option<f64>,
    /// Criterion for arrivals instead of the slip rate
    pub arrival: Option<ArrivalInput>,
}

impl FrontsInput {
    /// Checks the thresholds.
    pub fn check(&self) -> Result<(), ModelError> {
        check_positive("output.fronts.slip_rate", self.slip_rate, "")?;
        match self.seismic_rate {
            Some(seismic) if !(seismic > self.slip_rate && seismic.is_finite()) => Err(ModelError::new(
                "output.fronts.seismic_rate",
                format!("is {seismic}: must be above output.fronts.slip_rate, {}", self.slip_rate),
            )),
            _ => Ok(()),
        }
    }
}

/// Criterion for the arrival of a front at a point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub enum ArrivalInput {
    /// R exceeds this value [-]
    R(f64),
    /// μ falls below this value [-]
    #[serde(rename = "mu")]
    Mu(f64),
}

/// Data of an increment for the detection of fronts.
#[derive(Clone, Copy)]
pub(super) struct Passing<'a> {
    pub criterion: FrontsInput,
    /// Time and energies of the model at the ends of the last two increments
    pub last: [(f64, Energies); 2],
    /// State at the end of this increment
    pub after: &'a State,
}

/// An event of a contact: its arrivals in order of time, each with the rupture length up to then.
#[derive(Clone, Debug, Default)]
pub(super) struct Event {
    pub reached: Vec<(Arrival, f64)>,
}

impl Event {
    /// Rupture length and energy released by an arrival of the event [L, F·L].
    pub fn by(&self, arrival: &Arrival) -> (f64, f64) {
        let until = self.reached.partition_point(|(other, _)| other.time <= arrival.time);
        let first = self.reached.first().map_or(arrival.given, |(first, _)| first.given);
        (self.reached[..until].last().map_or(0.0, |(_, length)| *length), arrival.given - first)
    }
}

impl Passing<'_> {
    /// The arrival of a front at a point in this increment, by the signal at its end. Slip rates refer to the midpoints of
    /// increments, other signals to their ends.
    fn arrival(&self, point: &Point, signal: f64, event: usize) -> Option<Arrival> {
        let (level, mean) = match self.criterion.arrival {
            None => (self.criterion.slip_rate, true),
            Some(ArrivalInput::R(level)) => (level, false),
            Some(ArrivalInput::Mu(level)) => (-level, false),
        };
        if !(point.rubs && point.signal <= level && signal > level) {
            return None;
        }
        let [(earlier, _), (then, _)] = self.last;
        let (old_dt, dt) = (then - earlier, self.after.time - then);
        let share = if point.signal.is_finite() { (level - point.signal) / (signal - point.signal) } else { 1.0 };
        let time = match mean {
            true => then - 0.5 * old_dt + share * 0.5 * (old_dt + dt),
            false => then + share * dt,
        };
        Some(Arrival { time, event, given: self.given_at(time) })
    }

    /// Energy released up to a time, interpolated linearly within each increment [F·L].
    fn given_at(&self, time: f64) -> f64 {
        let [(t0, e0), (t1, e1)] = self.last;
        let (t2, e2) = (self.after.time, Energies::of(self.after));
        match time < t1 {
            true => e1.given + (e1.given - e0.given) * (time - t1) / (t1 - t0),
            false => e1.given + (e2.given - e1.given) * (time - t1) / (t2 - t1),
        }
    }
}

impl ContactPoints {
    pub fn new(model: &Model, pair: &ContactPair) -> Self {
        let x = model.mesh.undeformed();
        let mut points: Vec<Point> = Vec::with_capacity(pair.points.len());
        for (line, range) in pair.lines().into_iter().enumerate() {
            let mut position = 0.0;
            for k in range.clone() {
                let at = pair.points[k].at(&x);
                if k > range.start {
                    position += (at - pair.points[k - 1].at(&x)).norm();
                }
                let length = pair.points[k].current_length(&x);
                let rubs = !pair.law(&pair.points[k]).description.is_frictionless;
                let (at, arrivals) = (at.into(), Vec::new());
                let (mark, rate, signal) = (Mark::default(), 0.0, f64::NEG_INFINITY);
                points.push(Point { line, position, at, length, rubs, mark, rate, signal, arrivals });
            }
        }
        let speeds = WaveSpeeds::behind(model, pair);
        Self { name: pair.name.clone(), speeds, points, events: Vec::new() }
    }

    /// Updates the contact after an increment.
    pub fn pass(&mut self, pair: &ContactPair, passing: &Passing, states: &[ContactState]) {
        let Passing { criterion, after, last: [_, before] } = *passing;
        let dt = after.time - before.0;
        let marks: Vec<Mark> = states.iter().map(Mark::of).collect();
        let rate = |(point, mark): (&Point, &Mark)| (mark.slip - point.mark.slip) / dt;
        let rates: Vec<f64> = self.points.iter().zip(&marks).map(rate).collect();
        let slipping =
            self.points.iter().zip(&rates).any(|(point, rate)| point.rubs && rate.abs() > criterion.slip_rate);
        let goes_on = self.events.last().is_some_and(|event| !event.over);
        if slipping && !goes_on {
            self.events.push(SlipEvent::begin(
                self.events.len() + 1,
                self.points.iter().map(|point| point.mark),
                before.0,
                before.1,
            ));
        }
        let event = if slipping || goes_on { self.events.len() } else { 0 };
        if let Some(last) = self.events.last_mut().filter(|event| !event.over) {
            let seismic = criterion.seismic_rate.unwrap_or(f64::INFINITY);
            last.go_on(after, &marks, &rates, seismic, !slipping);
        }
        let points = self.points.iter_mut().zip(marks.iter().zip(&rates)).zip(pair.points.iter().zip(states));
        for ((point, (mark, rate)), (slave, state)) in points {
            let observed = |name| pair.observed(slave, name, state, after.time);
            let signal = match criterion.arrival {
                None => rate.abs(),
                Some(ArrivalInput::R(_)) => observed("R"),
                Some(ArrivalInput::Mu(_)) => -observed("mu"),
            };
            point.arrivals.extend(passing.arrival(point, signal, event));
            (point.mark, point.rate, point.signal) = (*mark, *rate, signal);
        }
    }

    /// Number of repeated onsets of slip within an event, per point and time.
    pub fn chatter(&self, time: f64) -> f64 {
        let again = |point: &Point| point.arrivals.windows(2).filter(|pair| pair[0].event == pair[1].event).count();
        let rubbing = self.points.iter().filter(|point| point.rubs).count();
        let restarts: usize = self.points.iter().map(again).sum();
        if restarts == 0 { 0.0 } else { restarts as f64 / (rubbing as f64 * time) }
    }

    /// Extent of each event over time.
    pub fn reached(&self) -> Vec<Event> {
        let mut events = vec![Event::default(); self.events.len()];
        for point in &self.points {
            let mut last = 0;
            for arrival in point.arrivals.iter().filter(|arrival| arrival.event > 0) {
                // A point that stops and restarts within an event counts once in its rupture length.
                let length = if arrival.event == last { 0.0 } else { point.length };
                last = arrival.event;
                events[last - 1].reached.push((*arrival, length));
            }
        }
        for event in &mut events {
            event.reached.sort_by(|(a, _), (b, _)| a.time.total_cmp(&b.time));
            let mut total = 0.0;
            for (_, length) in &mut event.reached {
                total += *length;
                *length = total;
            }
        }
        events
    }

    /// Local speed of the front that passes a point at a time [L/T]; NaN if it passed no neighbour.
    pub fn speed(&self, k: usize, arrival: f64) -> f64 {
        let own = &self.points[k];
        let nearest = |arrivals: &[Arrival], time: f64| {
            arrivals.iter().map(|a| a.time).min_by(|a, b| (a - time).abs().total_cmp(&(b - time).abs()))
        };
        // A neighbour passed only by another front gives no information about this one.
        let passed = |k: usize| {
            let point = self.points.get(k).filter(|point| point.line == own.line)?;
            let there = nearest(&point.arrivals, arrival)?;
            (nearest(&own.arrivals, there) == Some(arrival)).then_some((point.position, there))
        };
        let here = Some((own.position, arrival));
        let (before, after) = (k.checked_sub(1).and_then(passed).or(here), passed(k + 1).or(here));
        match before.zip(after) {
            Some(((s0, t0), (s1, t1))) if s1 > s0 => (s1 - s0) / (t1 - t0).abs(),
            _ => f64::NAN,
        }
    }
}

/// c_R, c_s and c_p of an elastic body [L/T].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WaveSpeeds {
    /// c_R: Rayleigh waves along a free surface
    pub rayleigh: f64,
    /// c_s = √(G/ρ): shear waves
    pub shear: f64,
    /// c_p = √((λ + 2G)/ρ): pressure waves
    pub pressure: f64,
}

impl WaveSpeeds {
    /// Returns the wave speeds of the body of the slave of a contact, if it has one.
    pub fn behind(model: &Model, pair: &ContactPair) -> Option<Self> {
        let body = &model.bodies[pair.body?];
        Some(Self::with(&*body.material, body.wave_modulus()))
    }

    /// Returns the wave speeds of a material; infinite without density.
    ///
    /// ```text
    /// (2 − ξ²)² = 4 √(1 − ξ²) √(1 − ξ² c_s²/c_p²),   ξ = c_R/c_s
    /// ```
    pub fn of(material: &dyn Material) -> Self {
        Self::with(material, material.description().p_wave_modulus)
    }

    /// Those with another λ + 2G.
    fn with(material: &dyn Material, modulus: f64) -> Self {
        let law = material.description();
        let speed = |modulus: f64| (modulus / law.density).sqrt();
        let (shear, pressure) = (speed(law.shear_modulus), speed(modulus));
        let ratio = law.shear_modulus / modulus;
        // Negative below the root, except at the trivial root 0, positive above.
        let excess = |square: f64| (2.0 - square).powi(2) - 4.0 * ((1.0 - square) * (1.0 - square * ratio)).sqrt();
        let (mut low, mut high) = (0.1, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if excess(middle) < 0.0 { low = middle } else { high = middle }
        }
        Self { rayleigh: shear * low.sqrt(), shear, pressure }
    }
}

/// c_R, c_s and c_p of the slave's body of the first contact; 0 if there is none, or it has no density [L/T].
pub fn wave_speeds(model: &Model) -> [f64; 3] {
    let speeds = model.contacts.first().and_then(|pair| WaveSpeeds::behind(model, pair));
    let finite = speeds.filter(|speeds| speeds.pressure.is_finite());
    finite.map_or([0.0; 3], |speeds| [speeds.rayleigh, speeds.shear, speeds.pressure])
}
