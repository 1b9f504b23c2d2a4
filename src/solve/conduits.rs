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
use crate::contact::conduit::{Amounts, Conduit, ConduitState, Reached, TooFast, Wall, WallMotion};
use crate::contact::{ContactPair, ContactState};
use crate::equations::Trial;
use crate::model::state::{State, Water as BodyWater};
use crate::model::{Model, Step};

/// |p̂ − p| that is left, over the largest pressure: that of equilibrium within these bounds [-]
const TOLERANCES: [f64; 2] = [1e-12, 1e-8];

/// Passes after which round-off is taken to leave ten times as much.
const ROUNDED: usize = 10;

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

/// How the water of a contact has gone through an increment.
#[derive(Clone, Debug, Default)]
pub struct WaterHistory {
    /// p_k of the last pass, under which equilibrium was found, of every node [F/L²]
    pub pressure: Vec<f64>,
    /// Open length [L]
    open: f64,
    /// Ends of its steps [T]
    steps: Vec<f64>,
}

fn disagree(flowing: &[Flowing]) -> IncrementFailure {
    let contact = flowing.first().map(|flowing| flowing.pair.name.clone()).unwrap_or_default();
    let why = format!(
        "its pressure has not converged after {MOST_PASSES} passes of equilibrium and flow: give shorter increments \
         (dt.min), the initial pressure of the ground water (`initial`), or a larger `storage`"
    );
    IncrementFailure::Water { contact, why }
}

/// Largest difference of pressures that agree after so many passes [F/L²].
fn allowed(model: &Model, largest: f64, passes: usize) -> f64 {
    let [least, most] = TOLERANCES;
    let least = least * 10f64.powi((passes / ROUNDED) as i32);
    model.newton.tolerance.max(least).min(most) * largest
}

/// Gives the points of a contact the pressures of its nodes.
fn press(conduit: &Conduit, pressure: &[f64], walls: &[Wall], states: &mut [ContactState]) {
    let points = conduit.points(pressure, walls);
    states.iter_mut().zip(points).for_each(|(state, water)| state.water = Some(water));
}

/// The state at the start of an increment under pressures of the water of every contact.
fn pressed<'a>(model: &Model, old: &State, pressures: impl Iterator<Item = Option<&'a Vec<f64>>>) -> State {
    let mut state = old.clone();
    let contacts = model.contacts.iter().zip(&mut state.contacts).zip(&old.conduits);
    for (((pair, states), water), pressure) in contacts.zip(pressures) {
        if let (Some(conduit), Some(pressure)) = (&pair.conduit, pressure) {
            press(conduit, pressure, &water.walls, states);
        }
    }
    state
}

/// Contacts in which water flows in a step.
fn flowing<'a>(model: &'a Model, step: &Step, old: &'a State) -> Vec<Flowing<'a>> {
    let pairs = model.contacts.iter().enumerate().filter(|(_, pair)| step.joins(pair));
    let dry = |pair: &'a ContactPair| pair.conduit.as_ref().filter(|conduit| !conduit.is_wet());
    let with_water = pairs.filter_map(|(number, pair)| Some((number, pair, dry(pair)?)));
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
        steps: None,
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
    /// Ends of the steps of the run whose neighbour it belongs to [T]
    steps: Option<&'a [f64]>,
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
        let predicted = if self.pressure.is_empty() { &self.old.pressure } else { &self.pressure };
        let motion = WallMotion {
            span: [trial.old.time, trial.time],
            walls: [&self.old.walls, &self.walls],
            rates,
            gives_way: [&self.compliance, predicted],
            steps: self.steps,
        };
        self.conduit.march(&self.old.pressure, &motion).map_err(|TooFast { time, step }| {
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
                "its pressure would be {pressure:e} at node {} of its slave: the surfaces open faster than water flows \
                 in, or a well withdraws more than there is; raise the initial pressure of the ground water \
                 (`initial`), or withdraw less",
                node + 1
            );
            return Err(self.failure(why));
        }
        let mut uncertainty = 0.0;
        if trial.settles && self.is_coupled() && trial.old.last_increment.is_some() {
            let bent = self.march(trial, Some(&old.rates))?;
            let difference =
                bent.pressure.iter().zip(&new.pressure).map(|(bent, p)| (bent - p).abs()).fold(0.0, f64::max);
            let round_off = ROUND_OFF * new.pressure.iter().fold(0.0, |most: f64, p| most.max(p.abs()));
            uncertainty = if difference <= round_off { 0.0 } else { difference / (self.conduit.error * self.scale()) };
        }
        // The water has reckoned with surfaces that follow it from p_k to p̂, which is what the next increment goes on from.
        let mut walls = self.walls.clone();
        let followed = self.compliance.iter().zip(new.pressure.iter().zip(&self.pressure));
        walls.iter_mut().zip(followed).for_each(|(wall, (c, (found, p)))| wall.opening += c * (found - p));
        let state = self.conduit.after(old, trial.dt, new.pressure.clone(), walls, new.amounts);
        Ok(ConduitState { uncertainty, ..state })
    }
}

/// Water of all contacts in an increment.
#[derive(Default)]
pub struct Water<'a> {
    /// The state at its start, with the pressures of the pass; none where no water flows
    pub old: Option<State>,
    flowing: Vec<Flowing<'a>>,
    history: History,
    /// Number of passes that did not agree
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
            if let Some(old) = &mut self.old {
                press(flowing.conduit, &flowing.pressure, &flowing.walls, &mut old.contacts[flowing.number]);
            }
        }
    }

    /// Evaluates p̂ after an equilibrium; says whether it differs, and then sets the pressures of another pass.
    ///
    /// # Errors
    /// Returns [`IncrementFailure`] if it cannot be evaluated, or differs after many passes.
    pub fn flow(
        &mut self,
        model: &Model,
        trial: Trial,
        contacts: &[Vec<ContactState>],
    ) -> Result<bool, IncrementFailure> {
        let (mut difference, mut largest, mut renewed) = (0.0f64, 0.0f64, false);
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
                difference = difference.max((found - p).abs());
                largest = largest.max(found.abs()).max(p.abs());
            }
        }
        if difference <= allowed(model, largest, self.passes) {
            return Ok(false);
        }
        self.passes += 1;
        if self.passes == MOST_PASSES {
            return Err(disagree(&self.flowing));
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
        arrive(&self.flowing, model, trial)
    }

    /// How the water has gone through the increment.
    pub fn histories(&self, model: &Model) -> Vec<Option<WaterHistory>> {
        let mut histories = vec![None; model.contacts.len()];
        for Flowing { number, pressure, open, found, .. } in &self.flowing {
            let (pressure, steps) = (pressure.clone(), found.steps.clone());
            histories[*number] = Some(WaterHistory { pressure, open: *open, steps });
        }
        histories
    }
}

/// The water at the end of an explicit increment, from the walls of each contact at its end.
///
/// # Errors
/// Returns [`IncrementFailure`] if its pressures are impossible.
pub fn flow(
    model: &Model,
    trial: Trial,
    walls: impl Fn(usize, &Conduit) -> Vec<Wall>,
) -> Result<Arrived, IncrementFailure> {
    let mut flowing = flowing(model, trial.step, trial.old);
    for flowing in &mut flowing {
        flowing.walls = walls(flowing.number, flowing.conduit);
        flowing.found = flowing.march(trial, None)?;
    }
    arrive(&flowing, model, trial)
}

/// The water at the end of the increment.
fn arrive(flowing: &[Flowing], model: &Model, trial: Trial) -> Result<Arrived, IncrementFailure> {
    let mut arrived: Arrived = vec![None; model.contacts.len()];
    for flowing in flowing {
        arrived[flowing.number] = Some(flowing.arrive(trial)?);
    }
    Ok(arrived)
}

/// Water of a run in an increment, by which that of its neighbours flows.
#[derive(Clone, Copy)]
pub struct RunWater<'a> {
    /// How it has gone through the increment
    pub histories: &'a [Option<WaterHistory>],
    /// The states at its start and at its end
    pub states: [&'a State; 2],
}

impl RunWater<'_> {
    /// The state at the start under the pressures of the last pass.
    pub fn pressed(&self, model: &Model) -> State {
        pressed(
            model,
            self.states[0],
            self.histories.iter().map(|history| history.as_ref().map(|history| &history.pressure)),
        )
    }
}

/// Water of a neighbour of a run in an increment: it flows in the steps of the run's, and what that has left of (1) is left here.
#[derive(Default)]
pub struct NeighbourWater {
    /// p_k of every contact
    pressure: Vec<Option<Vec<f64>>>,
    history: History,
    passes: usize,
}

impl NeighbourWater {
    /// Begins as far from the pressures of the run as at the start of the increment.
    pub fn new(run: &RunWater, old: &State) -> Self {
        let ahead = |((history, run), own): ((&Option<WaterHistory>, &ConduitState), &ConduitState)| {
            let before = own.pressure.iter().zip(&run.pressure);
            let ahead = |history: &WaterHistory| {
                history.pressure.iter().zip(before).map(|(p, (own, run))| p + (own - run)).collect()
            };
            history.as_ref().map(ahead)
        };
        let each = run.histories.iter().zip(&run.states[0].conduits).zip(&old.conduits);
        Self { pressure: each.map(ahead).collect(), ..Self::default() }
    }

    /// The state at the start of the increment under the pressures of the pass.
    pub fn pressed(&self, model: &Model, old: &State) -> State {
        pressed(model, old, self.pressure.iter().map(Option::as_ref))
    }

    /// The water at the end of the increment if it agrees with the equilibrium that was found; otherwise the next pressures are set.
    ///
    /// # Errors
    /// Returns [`IncrementFailure`] if it does not come to agree.
    pub fn flow(
        &mut self,
        model: &Model,
        trial: Trial,
        run: &RunWater,
        contacts: &[Vec<ContactState>],
    ) -> Result<Option<Arrived>, IncrementFailure> {
        let mut all = flowing(model, trial.step, trial.old);
        let (mut now, mut next) = (Vec::new(), Vec::new());
        let (mut difference, mut largest) = (0.0f64, 0.0f64);
        for flowing in &mut all {
            let (Some(history), Some(pressure)) = (&run.histories[flowing.number], &self.pressure[flowing.number])
            else {
                continue;
            };
            flowing.pressure.clone_from(pressure);
            (flowing.open, flowing.steps) = (history.open, Some(&history.steps[..]));
            flowing.walls = flowing.conduit.walls(&contacts[flowing.number]);
            flowing.give_way();
            flowing.found = flowing.march(trial, None)?;
            let left = run.states[1].conduits[flowing.number].pressure.iter().zip(&history.pressure);
            for ((p, found), (reached, before)) in pressure.iter().zip(&flowing.found.pressure).zip(left) {
                let wanted = found - (reached - before);
                difference = difference.max((wanted - p).abs());
                largest = largest.max(p.abs());
                now.push(*p);
                next.push(wanted);
            }
        }
        if difference <= allowed(model, largest, self.passes) {
            return arrive(&all, model, trial).map(Some);
        }
        self.passes += 1;
        if self.passes > MOST_PASSES {
            return Err(disagree(&all));
        }
        let next = self.history.next(&now, &next);
        self.pressure.iter_mut().flatten().flatten().zip(next).for_each(|(p, next)| *p = next);
        Ok(None)
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

/// Gives the contacts the pressures of the water that has arrived.
pub fn press_by(model: &Model, arrived: &Arrived, state: &mut State) {
    for ((pair, new), states) in model.contacts.iter().zip(arrived).zip(&mut state.contacts) {
        if let (Some(conduit), Some(new)) = (&pair.conduit, new) {
            press(conduit, &new.pressure, &new.walls, states);
        }
    }
}

/// Gives a state the water that has arrived with it.
pub fn receive(model: &Model, arrived: Arrived, state: &mut State) {
    press_by(model, &arrived, state);
    for (old, new) in state.conduits.iter_mut().zip(arrived) {
        *old = new.unwrap_or_else(|| std::mem::take(old));
    }
}

/// Gives a state, whose last increment is that from `old`, the water of contacts that is solved with that of their bodies.
pub fn receive_with_bodies(model: &Model, step: &Step, dt: f64, old: &BodyWater, state: &mut State) {
    let Some(flow) = &model.flow else { return };
    for (number, pair) in model.contacts.iter().enumerate().filter(|(_, pair)| step.joins(pair)) {
        let Some(conduit) = pair.conduit.as_ref().filter(|conduit| conduit.is_wet()) else { continue };
        let place = flow.channels.keys().position(|name| *name == pair.name).unwrap_or_default();
        let before = &mut state.conduits[number];
        before.pressure = conduit.pressures.iter().map(|&k| flow.pressure(k, Some(&state.displacement))).collect();
        let walls = conduit.walls(&state.contacts[number]);
        before.rates =
            walls.iter().zip(&before.walls).map(|(new, old)| new.combined(1.0 / dt, *old, -1.0 / dt)).collect();
        let volume =
            |water: &BodyWater| water.channels.get(place).map_or([0.0; 2], |channel| channel.map(|flow| flow.volume));
        let [wells, leaked] = [0, 1].map(|k| volume(&state.water)[k] - volume(old)[k]);
        let taken: f64 = conduit.pressures.iter().map(|&k| state.water.change[k]).sum();
        let amounts =
            Amounts { injected: -wells, leaked: -wells - taken, throughput: wells.abs() + leaked.abs() + taken.abs() };
        before.amounts = before.amounts.combined(1.0, amounts, 1.0);
        press(conduit, &before.pressure, &walls, &mut state.contacts[number]);
        before.walls = walls;
    }
}
