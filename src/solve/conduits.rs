//! Water that flows along contacts: its pressures at the end of an increment, iterated with the equilibrium.
//!
//! ```text
//! equilibrium under p_k → surfaces → p̂(p_k) by (1) of the conduit;     p = p̂(p) within a tolerance                           (1)
//! ```
//! Where the surfaces do nothing to the water, the first pass ends it. Elsewhere the passes are accelerated by those before (2), and the
//! flow is solved with a compliance c_w of open surfaces ((6) of the conduit's march), without which a stiff fluid in a soft body would
//! diverge: that of a crack of the length L that is open, L/G*. What is accepted keeps the water's balance to round-off, and equilibrium
//! with the pressure before, which differs by less than the tolerance.
//!
//! ```text
//! p_(k+1) = p̂_k − ΔP̂ γ,   γ: least squares of r_k − ΔR γ,  r = p̂ − p                                                     (2)
//! ```
//! Source: Anderson (1965), J. ACM 12, 547; for partitioned problems Degroote, Bathe & Vierendeels (2009), Computers & Structures 87, 793;
//! c_w: Kim, Tchelepi & Juanes (2011), Comput. Methods Appl. Mech. Engrg. 200, 1591 (fixed stress).

use nalgebra::{DMatrix, DVector};

use super::failure::IncrementFailure;
use crate::contact::conduit::{Conduit, ConduitState, Course, Reached, TooFast, Wall};
use crate::contact::pair::ContactPair;
use crate::contact::point::ContactState;
use crate::equations::Trial;
use crate::model::state::State;
use crate::model::{Model, Step};

/// |p̂ − p| that is left, over the largest pressure [-]
const TOLERANCE: f64 = 1e-8;

/// Difference of two pressures that is round-off, over the largest [-]
const ROUND_OFF: f64 = 1e-7;

/// Most passes of an increment.
const MOST_PASSES: usize = 60;

/// Passes that are remembered.
const REMEMBERED: usize = 12;

/// Growth of the open length from which on it counts anew.
const LONGER: f64 = 1.5;

/// Water of all contacts at the end of an increment; one entry a contact, none where no water flows.
pub type Arrived = Vec<Option<ConduitState>>;

/// Contacts in which water flows in a step.
fn flowing<'a>(model: &'a Model, step: &Step, old: &'a State) -> Vec<Flowing<'a>> {
    let pairs = model.contacts.iter().enumerate().filter(|(_, pair)| step.joins(pair));
    let with_water = pairs.filter_map(|(number, pair)| Some((number, pair, pair.conduit.as_ref()?)));
    let new = |(number, pair, conduit): (usize, &'a ContactPair, &'a Conduit)| Flowing {
        number,
        pair,
        conduit,
        old: &old.conduits[number],
        open: 0.0,
        compliance: Vec::new(),
        pressure: Vec::new(),
        walls: Vec::new(),
        found: Reached::default(),
    };
    with_water.map(new).collect()
}

/// Water of one contact in an increment.
struct Flowing<'a> {
    /// Number of the contact
    number: usize,
    pair: &'a ContactPair,
    conduit: &'a Conduit,
    old: &'a ConduitState,
    /// Open length [L]
    open: f64,
    /// c_w of every node [L³/F]
    compliance: Vec<f64>,
    /// p_k
    pressure: Vec<f64>,
    /// The surfaces under p_k
    walls: Vec<Wall>,
    /// p̂(p_k)
    found: Reached,
}

impl Flowing<'_> {
    /// Sets the first pressures: the surfaces go on as before.
    fn foresee(&mut self, trial: Trial) -> Result<(), IncrementFailure> {
        let goes_on = trial.old.last_increment.is_some();
        let way = if goes_on { trial.dt } else { 0.0 };
        let walls = self.old.walls.iter().zip(&self.old.rates);
        self.walls = walls.map(|(wall, rate)| wall.combined(1.0, *rate, way)).collect();
        self.walls.iter_mut().for_each(|wall| wall.opening = wall.opening.max(0.0));
        self.open = self.open_length(&self.old.walls);
        self.give_way();
        let foreseen = self.march(trial, None)?;
        self.pressure = foreseen.pressure;
        Ok(())
    }

    /// Sets c_w for the open length.
    fn give_way(&mut self) {
        let modulus = self.pair.modulus;
        let compliance = if modulus > 0.0 { self.open / modulus } else { 0.0 };
        self.compliance = if compliance > 0.0 { vec![compliance; self.old.pressure.len()] } else { Vec::new() };
    }

    /// Length that is open and presses on nothing [L].
    fn open_length(&self, walls: &[Wall]) -> f64 {
        let open = walls.iter().zip(self.conduit.line.lengths());
        open.filter(|(wall, _)| wall.opening > 0.0 && wall.pressure == 0.0).map(|(_, length)| length).sum()
    }

    /// Pressures from the surfaces at the end, with the rates that these began with on request.
    fn march(&self, trial: Trial, rates: Option<&[Wall]>) -> Result<Reached, IncrementFailure> {
        let presumed = if self.pressure.is_empty() { &self.old.pressure } else { &self.pressure };
        let course = Course {
            span: [trial.old.time, trial.time],
            walls: [&self.old.walls, &self.walls],
            rates,
            gives_way: [&self.compliance, presumed],
        };
        self.conduit.march(&self.old.pressure, &course).map_err(|TooFast { time, step }| {
            let why = format!("its pressure has no value from t = {time:e} on, whatever the step (last {step:e})");
            self.failure(why)
        })
    }

    fn failure(&self, why: String) -> IncrementFailure {
        IncrementFailure::Water { contact: self.pair.name.clone(), why }
    }

    /// Largest change of the pressure since the start of the run, up to now [F/L²].
    fn scale(&self) -> f64 {
        let change = |pressure: &[f64]| {
            let initial = pressure.iter().zip(&self.conduit.initial);
            initial.map(|(p, initial)| (p - initial).abs()).fold(0.0, f64::max)
        };
        change(&self.found.pressure).max(change(&self.old.pressure))
    }

    /// Whether the surfaces do anything to the water.
    fn is_coupled(&self) -> bool {
        let opens = self.walls.iter().zip(&self.old.walls).any(|(new, old)| new.opening != old.opening);
        opens || self.conduit.transmissivity.varies()
    }

    /// The state at the end of the increment.
    fn arrive(&self, trial: Trial) -> Result<ConduitState, IncrementFailure> {
        let (old, new) = (self.old, &self.found);
        if let Some((node, pressure)) = self.conduit.bad(&new.pressure, self.pair.modulus) {
            let why = format!(
                "its pressure would be {pressure:e} at node {} of its slave: the surfaces open faster than water flows in, or a well takes \
                 more than there is; raise `initial`, the ground water that is there, or lower what a well takes",
                node + 1
            );
            return Err(self.failure(why));
        }
        let mut doubt = 0.0;
        if self.is_coupled() && trial.old.last_increment.is_some() {
            let bent = self.march(trial, Some(&old.rates))?;
            let apart = bent.pressure.iter().zip(&new.pressure).map(|(bent, p)| (bent - p).abs()).fold(0.0, f64::max);
            let round_off = ROUND_OFF * new.pressure.iter().fold(0.0, |most: f64, p| most.max(p.abs()));
            doubt = if apart <= round_off { 0.0 } else { apart / (self.conduit.error * self.scale()) };
        }
        let rate = 1.0 / trial.dt;
        // The water has reckoned with surfaces that follow it from p_k to p̂, which is what the next increment goes on from.
        let mut walls = self.walls.clone();
        let followed = self.compliance.iter().zip(new.pressure.iter().zip(&self.pressure));
        walls.iter_mut().zip(followed).for_each(|(wall, (c, (found, p)))| wall.opening += c * (found - p));
        let rates = walls.iter().zip(&old.walls).map(|(new, old)| new.combined(rate, *old, -rate)).collect();
        let volume = self.conduit.gained([&old.pressure, &new.pressure], [&old.walls, &walls]);
        Ok(ConduitState {
            pressure: new.pressure.clone(),
            walls,
            rates,
            amounts: old.amounts.combined(1.0, new.amounts, 1.0),
            mass_error: old.mass_error + volume - new.amounts.injected + new.amounts.leaked,
            doubt,
        })
    }
}

/// Water of all contacts in an increment.
#[derive(Default)]
pub struct Water<'a> {
    /// The state at its start, with the pressures of the pass; none where no water flows
    pub old: Option<State>,
    flowing: Vec<Flowing<'a>>,
    history: History,
    passes: usize,
}

impl<'a> Water<'a> {
    /// Finds the water that flows in an increment, with the pressures of the first pass.
    ///
    /// # Errors
    /// Returns [`IncrementFailure`] if there are none.
    pub fn of(model: &'a Model, trial: Trial<'a>) -> Result<Self, IncrementFailure> {
        let mut flowing = flowing(model, trial.step, trial.old);
        flowing.iter_mut().try_for_each(|flowing| flowing.foresee(trial))?;
        let old = if flowing.is_empty() { None } else { Some(trial.old.clone()) };
        let mut water = Self { old, flowing, history: History::default(), passes: 0 };
        water.press();
        Ok(water)
    }

    /// Gives the contacts the pressures of the pass.
    fn press(&mut self) {
        for flowing in &self.flowing {
            let points = flowing.conduit.points(&flowing.pressure, &flowing.walls);
            let states = self.old.iter_mut().flat_map(|old| &mut old.contacts[flowing.number]);
            states.zip(points).for_each(|(state, water)| state.water = Some(water));
        }
    }

    /// Evaluates p̂ after an equilibrium; says whether it differs, and then sets the pressures of another pass.
    ///
    /// # Errors
    /// Returns [`IncrementFailure`] if it cannot be evaluated, or differs after many passes.
    pub fn flow(&mut self, trial: Trial, contacts: &[Vec<ContactState>]) -> Result<bool, IncrementFailure> {
        let (mut apart, mut largest, mut renewed) = (0.0f64, 0.0f64, false);
        for flowing in &mut self.flowing {
            flowing.walls = flowing.conduit.walls(&contacts[flowing.number]);
            let open = flowing.open_length(&flowing.walls);
            if open > LONGER * flowing.open {
                flowing.open = open;
                flowing.give_way();
                renewed = true;
            }
            flowing.found = flowing.march(trial, None)?;
            for (found, p) in flowing.found.pressure.iter().zip(&flowing.pressure) {
                apart = apart.max((found - p).abs());
                largest = largest.max(found.abs()).max(p.abs());
            }
        }
        if apart <= TOLERANCE * largest {
            return Ok(false);
        }
        self.passes += 1;
        if let (MOST_PASSES, Some(flowing)) = (self.passes, self.flowing.first()) {
            return Err(flowing.failure(format!(
                "{MOST_PASSES} passes of equilibrium and flow do not agree on its pressure: give shorter increments (dt.min), the ground \
                 water that is there (`initial`), or a larger `storage`"
            )));
        }
        if renewed {
            self.history = History::default();
        }
        let now: Vec<f64> = self.flowing.iter().flat_map(|flowing| flowing.pressure.iter().copied()).collect();
        let found: Vec<f64> = self.flowing.iter().flat_map(|flowing| flowing.found.pressure.iter().copied()).collect();
        let mut next = self.history.next(&now, &found).into_iter();
        for flowing in &mut self.flowing {
            let count = flowing.pressure.len();
            flowing.pressure = next.by_ref().take(count).collect();
        }
        self.press();
        Ok(true)
    }

    /// The water at the end of the increment.
    ///
    /// # Errors
    /// Returns [`IncrementFailure`] if its pressures are impossible.
    pub fn arrive(&self, model: &Model, trial: Trial) -> Result<Arrived, IncrementFailure> {
        let mut arrived: Arrived = vec![None; model.contacts.len()];
        for flowing in &self.flowing {
            arrived[flowing.number] = Some(flowing.arrive(trial)?);
        }
        Ok(arrived)
    }
}

/// p and r of the last passes, (2).
#[derive(Default)]
struct History {
    found: Vec<DVector<f64>>,
    residuals: Vec<DVector<f64>>,
}

/// Singular values that count, over the largest [-]
const COUNTS: f64 = 1e-9;

impl History {
    /// The next pressures.
    fn next(&mut self, now: &[f64], found: &[f64]) -> Vec<f64> {
        let found = DVector::from_column_slice(found);
        let residual = &found - DVector::from_column_slice(now);
        self.found.push(found);
        self.residuals.push(residual);
        if self.found.len() > REMEMBERED {
            self.found.remove(0);
            self.residuals.remove(0);
        }
        let last = self.found.len() - 1;
        if last == 0 {
            return self.found[0].iter().copied().collect();
        }
        let changes =
            |of: &[DVector<f64>]| DMatrix::from_columns(&(0..last).map(|k| &of[last] - &of[k]).collect::<Vec<_>>());
        let [found, residuals] = [changes(&self.found), changes(&self.residuals)];
        let svd = residuals.svd(true, true);
        let most = svd.singular_values.max();
        let weights = svd.solve(&self.residuals[last], COUNTS * most);
        let next = weights.map_or_else(|_| self.found[last].clone(), |weights| &self.found[last] - found * weights);
        next.iter().copied().collect()
    }
}

/// Gives a state the water that has arrived with it.
pub fn receive(model: &Model, arrived: Arrived, state: &mut State) {
    for (number, new) in arrived.into_iter().enumerate() {
        let (Some(new), Some(conduit)) = (new, &model.contacts[number].conduit) else { continue };
        let points = conduit.points(&new.pressure, &new.walls);
        state.contacts[number].iter_mut().zip(points).for_each(|(state, water)| state.water = Some(water));
        state.conduits[number] = new;
    }
}
