//! Quasi-dynamic steps: linear bodies without inertia, radiation damping, and friction whose slip rate follows from traction
//! and state. Only the interface is integrated, explicitly and with error control (`steps.rs`), by the differential equations
//! of `slip_equations.rs`. The bodies are condensed on it once per load step ([`crate::equations::slip_operator`]) and
//! evaluated at requested results. Slip rates, and with them step lengths, may vary by ten decades or more in one run.
//!
//! If a law has no such rate, the interface is integrated by implicit steps instead (`stiff.rs`): slip is then all relative motion, and
//! the law answers it with its traction.
//!
//! Source: Rice (1993), J. Geophys. Res. 98, 9885; Erickson et al. (2023), Bull. Seismol. Soc. Am. 113, 499 (community
//! benchmarks).

mod conduits;
mod slip_equations;
mod steps;
mod stiff;

use std::sync::Arc;

use self::conduits::Conduits;
use self::slip_equations::{Rates, SlipEquations, with_rates};
use self::steps::{Steps, Tried};
use self::stiff::Stiff;
use super::accept::{accept, take_stock};
use crate::contact::conduit::Conduit;
use crate::contact::force::ContactState;
use crate::contact::pair::{BadPressure, Fluid};
use crate::equations::slip_operator::{NoSlipOperator, Shift, SlipOperator, Slips};
use crate::equations::supports::turn;
use crate::equations::{Evaluation, Trial, TrialFailure};
use crate::linear::system::Request;
use crate::mesh::configuration::Configuration;
use crate::model::{Model, Scheme, State, Step};
use crate::solve::failure::IncrementFailure;

/// Fraction of a step's length within which it ends at the end of the load step.
const NEAR_END: f64 = 1e-9;

/// Data of quasi-dynamic steps in addition to the state; they follow from the model and the load step.
pub struct QuasiDynamic {
    model: Arc<Model>,
    step: Arc<Step>,
    jumps: SlipOperator,
    /// What slip is in them: plastic slip of laws with a rate, or all of it
    slips: Slips,
    /// Rates of tractions and displacements by supports and loads at zero slip
    loading: Shift,
}

/// Outcome of several steps.
pub struct Gone {
    /// number of steps taken
    pub steps: usize,
    /// length of the next one [T]
    pub next: f64,
}

impl QuasiDynamic {
    /// Condenses the bodies for a load step; `state` is any of its states.
    ///
    /// # Errors
    /// Returns [`IncrementFailure`] if a body is constrained by contact only.
    pub fn new(model: &Arc<Model>, step: &Arc<Step>, state: &State) -> Result<Self, IncrementFailure> {
        let duration = step.span.end - step.span.start;
        let [first, last] = [step.span.start, step.span.end].map(|time| Trial::new(state, step, time, duration));
        let all_have_rates = model.contacts.iter().flat_map(|pair| &pair.laws).all(|law| law.law.rates().is_some());
        let slips = if all_have_rates { Slips::Plastic } else { Slips::All };
        let mut jumps = SlipOperator::new(model, first, slips).map_err(|cause| match cause {
            NoSlipOperator::Assembly(failure) => IncrementFailure::Start(failure),
            NoSlipOperator::Linear(failure) => IncrementFailure::Interface(failure),
        })?;
        let nothing = vec![0.0; model.dofs()];
        let mut residual = |trial: Trial| {
            let SlipOperator { bodies, system, .. } = &mut jumps;
            bodies.assemble(trial, &nothing, &[], Request::Residual, system).map_err(IncrementFailure::Start)?;
            Ok::<_, IncrementFailure>(system.residual.clone())
        };
        let (before, mut after) = (residual(first)?, residual(last)?);
        after.iter_mut().zip(before).for_each(|(after, before)| *after = (*after - before) / duration);
        let loading = jumps.shift(&after);
        Ok(Self { model: model.clone(), step: step.clone(), jumps, slips, loading })
    }

    /// Brings the initial state of a load step to static equilibrium: unbalanced inertia forces move the bodies at once, and
    /// their work counts as damping.
    pub fn settle(&mut self, state: &mut State) {
        let mut residual = state.force.clone();
        self.step.supports.iter().for_each(|support| support.at.set(0.0, &mut residual));
        let mut equations = residual.clone();
        self.step.supports.iter().for_each(|support| turn(support.at, 0.0, &mut equations));
        let Shift { tractions, displacement } = self.jumps.shift(&equations);
        let work: f64 = residual.iter().zip(&displacement).map(|(force, u)| force * u).sum();
        state.energy.damping_dissipation -= 0.5 * work;
        state.energy.external_work += state.external.iter().zip(&displacement).map(|(force, u)| force * u).sum::<f64>();
        state.force.iter_mut().zip(&residual).for_each(|(force, residual)| *force -= residual);
        let n = self.jumps.count();
        let jumps = self.jumps.jumps(&vec![0.0; n], &tractions);
        for (k, contact) in state.contacts.iter_mut().flatten().enumerate() {
            contact.friction.pressure += tractions[k];
            match self.slips {
                Slips::Plastic => contact.friction.traction -= tractions[n + k],
                // A law answers slip alone: what is not balanced sets the surfaces in motion.
                Slips::All => contact.radiation -= tractions[n + k],
            }
            contact.gap += jumps[k];
        }
        state.displacement.iter_mut().zip(displacement).for_each(|(u, way)| *u += way);
        self.model.ties.spread(2, &mut state.displacement);
    }

    /// Takes several steps, the first of length `dt`, and advances the state with them.
    ///
    /// # Errors
    /// Returns [`IncrementFailure::Slip`] if a point opens, its law has no slip rate, or no step is short enough.
    pub fn go(&mut self, dt: f64, state: &mut State) -> Result<Gone, IncrementFailure> {
        let Scheme::QuasiDynamic { tolerance, every } = self.step.scheme else {
            return Ok(Gone { steps: 0, next: dt });
        };
        let old = state.clone();
        let (model, mut stops) = (self.model.clone(), Stops::after(old.time, &self.model));
        let places = model.mesh.undeformed();
        let interface = self.interface(&old, places);
        let mut steps = match self.slips {
            Slips::Plastic => {
                Stepping::Explicit(Steps::new(interface, Conduits::new(&model, &old), old.time, tolerance))
            }
            Slips::All => Stepping::Implicit(Stiff::new(interface, old.time, tolerance)),
        };
        let (mut gone, mut next, mut last, mut ended) = (0, dt, 0.0, false);
        if let Some(worst) = steps.now().iter().position(|rates| !rates.is_good()) {
            return Err(self.failure(&old, worst, &steps.now()[worst], 0.0));
        }
        while gone < every && !ended {
            let left = self.step.span.end - old.time - steps.since();
            let h = next.clamp(self.step.increments.min, self.step.increments.max);
            ended = h > left * (1.0 - NEAR_END);
            let h = if ended { left } else { h };
            let to_corner = stops.left(steps.since()).filter(|to_corner| h > to_corner * (1.0 - NEAR_END));
            ended &= to_corner.is_none();
            let h = to_corner.unwrap_or(h);
            match steps.attempt(h) {
                Tried::Taken(share) => {
                    (gone, last) = (gone + 1, h);
                    next = if ended || to_corner.is_some() { next } else { share * h };
                }
                Tried::Refused { share, worst, rates } => {
                    ended = false;
                    if h <= self.step.increments.min * (1.0 + NEAR_END) {
                        // After successful steps the next attempt starts from their end.
                        if gone > 0 {
                            break;
                        }
                        return Err(self.failure(&old, worst, &rates, h));
                    }
                    next = share * h;
                }
            }
        }
        let time = if ended { self.step.span.end } else { old.time + steps.since() };
        if let Some((pair, bad)) =
            model.contacts.iter().find_map(|pair| Some((pair, pair.bad_fluid_pressure(&places, time)?)))
        {
            let BadPressure { at, pressure } = bad;
            let (contact, at) = (pair.name.clone(), [at.x, at.y]);
            return Err(IncrementFailure::Start(TrialFailure::FluidPressure { contact, at, pressure, time }));
        }
        let below_zero = steps.conduits().and_then(|conduits| conduits.below_zero(&model.contacts));
        if let Some((pair, pressure)) = below_zero {
            let why = format!(
                "its pressure has fallen to {pressure:e} at t = {time:e}: raise the initial pressure of the ground \
                water (`initial`), or withdraw less from the wells"
            );
            return Err(IncrementFailure::Water { contact: pair.name.clone(), why });
        }
        let (mut contacts, jumps) = self.contacts(&old, &steps, time);
        if let Some(conduits) = steps.conduits() {
            conduits.receive(&mut contacts, &mut state.conduits);
        }
        let since = steps.since();
        self.follow(&old, time, since, contacts, &jumps, state)?;
        state.dt = last;
        Ok(Gone { steps: gone, next })
    }

    fn interface<'a>(&'a self, state: &'a State, places: Configuration<'a>) -> SlipEquations<'a> {
        let states = self.model.contacts.iter().zip(&state.contacts);
        let points = states.flat_map(|(pair, states)| pair.points.iter().zip(states).map(move |(p, s)| (pair, p, s)));
        SlipEquations {
            points: points.collect(),
            by_slip: self.jumps.by_slip(),
            by_fluid: self.jumps.by_fluid(),
            loading: &self.loading.tractions,
            places,
            water: Vec::new(),
        }
    }

    /// Contact states at the end of the steps, and the traction changes since their start.
    fn contacts(&self, old: &State, steps: &Stepping, time: f64) -> (Vec<Vec<ContactState>>, Vec<f64>) {
        let n = steps.now().len();
        let jumps = self.jumps.jumps(steps.slips(), &steps.tractions());
        let places = self.model.mesh.undeformed();
        let mut numbers = 0..n;
        let mut state = |pair, slave, old: &ContactState| {
            let k = numbers.next().unwrap_or_default();
            let Rates { slip_rate, traction, bond, pressure, radiation, .. } = steps.now()[k];
            let mut new = old.clone();
            match steps {
                Stepping::Explicit(steps) => {
                    new.friction.traction = traction - bond;
                    if let Some(own) = &mut new.bond {
                        own.traction = bond;
                        own.slip += steps.z[k].abs();
                    }
                    new.friction.pressure = pressure;
                    new.friction.plastic_slip += steps.z[k];
                    new.friction.plastic_increment = steps.last[k];
                    new.friction.dissipation += steps.works[k][0];
                    let remembered = with_rates(pair, slave, time, |law| {
                        let x = std::array::from_fn(|i| steps.z[(1 + i) * n + k]);
                        let friction = law.remember(x, new.friction.clone());
                        crate::laws::friction::FrictionState { regime: law.regime(x, slip_rate), ..friction }
                    });
                    new.friction = remembered.unwrap_or(new.friction);
                    new.radiated += steps.works[k][1];
                }
                Stepping::Implicit(steps) => {
                    new.friction = steps.state(k).clone();
                    new.radiated += steps.radiated(k);
                }
            }
            new.gap += jumps[k];
            new.slip = jumps[n + k];
            new.radiation = radiation;
            new.fluid = pair.fluid_pressure(slave, &places, time);
            new
        };
        let pairs = self.model.contacts.iter().zip(&old.contacts);
        let contacts = pairs
            .map(|(pair, old)| pair.points.iter().zip(old).map(|(slave, old)| state(pair, slave, old)).collect())
            .collect();
        (contacts, jumps)
    }

    /// Evaluates the bodies: their displacements, forces and energies.
    fn follow(
        &mut self,
        old: &State,
        time: f64,
        since: f64,
        contacts: Vec<Vec<ContactState>>,
        jumps: &[f64],
        state: &mut State,
    ) -> Result<(), IncrementFailure> {
        let Self { model, step, jumps: bodies, loading, .. } = self;
        let at_rest: Vec<f64> = loading.tractions.iter().map(|rate| rate * since).collect();
        let shifted = bodies.jumps(&vec![0.0; bodies.count()], &at_rest);
        let own: Vec<f64> = jumps.iter().zip(shifted).map(|(jump, shifted)| jump - shifted).collect();
        let way = bodies.displacement(&own);
        let ways = way.iter().zip(&loading.displacement).map(|(own, rate)| own + since * rate);
        let mut u: Vec<f64> = old.displacement.iter().zip(ways).map(|(u, way)| u + way).collect();
        let trial = Trial::new(old, step, time, time - old.time);
        for support in &step.supports {
            support.at.set(trial.prescribed(support, model), &mut u);
        }
        model.ties.spread(2, &mut u);
        let SlipOperator { bodies, system, .. } = bodies;
        bodies.assemble(trial, &u, &[], Request::Residual, system).map_err(IncrementFailure::Start)?;
        let found = &mut bodies.evaluation;
        add_contact_forces(model, &contacts, found);
        found.contacts = contacts;
        accept(model, step, time, &mut u, found, state);
        take_stock(model, 0.0, state);
        state.last_increment = None;
        Ok(())
    }

    /// Reason why a point cannot continue from a state by the shortest step `dt`, or cannot be evaluated there (`dt` = 0).
    fn failure(&self, state: &State, number: usize, rates: &Rates, dt: f64) -> IncrementFailure {
        let mut points = self.model.contacts.iter().flat_map(|pair| pair.points.iter().map(move |slave| (pair, slave)));
        let Some((pair, slave)) = points.nth(number) else { unreachable!("a contact point has failed that is none") };
        let at = slave.at(&self.model.configuration(&state.displacement));
        let why = if rates.pressure <= 0.0 {
            let fluid = if pair.fluid.is_some() { " or lower fluid_pressure" } else { "" };
            format!(
                "the pressure has dropped to {:e}, and quasi_dynamic steps keep every point closed: raise the \
                 compression{fluid}, or take static steps with radiation_damping",
                rates.pressure
            )
        } else if !rates.is_good() {
            let Rates { traction, pressure, .. } = rates;
            format!("the law has no slip rate under the traction {traction:e} and the pressure {pressure:e}")
        } else {
            let Rates { slip_rate, pressure, .. } = rates;
            format!(
                "at the slip rate {slip_rate:e} and the pressure {pressure:e} the error of a step of {dt:.3e} is above \
                 the tolerance, and dt.min = {:e} allows no shorter one: lower dt.min, or allow a larger tolerance",
                self.step.increments.min
            )
        };
        IncrementFailure::Slip { contact: pair.name.clone(), x: at.x, y: at.y, why }
    }
}

/// Integration of the interface from one state on.
enum Stepping<'a> {
    /// of laws with a slip rate
    Explicit(Steps<'a>),
    /// of laws that answer slip with a traction
    Implicit(Stiff<'a>),
}

impl Stepping<'_> {
    fn now(&self) -> &[Rates] {
        match self {
            Self::Explicit(steps) => steps.now(),
            Self::Implicit(steps) => steps.now(),
        }
    }

    fn since(&self) -> f64 {
        match self {
            Self::Explicit(steps) => steps.since,
            Self::Implicit(steps) => steps.since,
        }
    }

    /// Slips since t₀: plastic ones, or all.
    fn slips(&self) -> &[f64] {
        match self {
            Self::Explicit(steps) => &steps.z[..steps.last.len()],
            Self::Implicit(steps) => steps.slips(),
        }
    }

    fn tractions(&self) -> Vec<f64> {
        match self {
            Self::Explicit(steps) => steps.tractions(),
            Self::Implicit(steps) => steps.tractions(),
        }
    }

    /// Water that flows along the interface.
    fn conduits(&self) -> Option<&Conduits<'_>> {
        match self {
            Self::Explicit(steps) => Some(&steps.conduits),
            Self::Implicit(_) => None,
        }
    }

    fn attempt(&mut self, h: f64) -> Tried {
        match self {
            Self::Explicit(steps) => steps.attempt(h),
            Self::Implicit(steps) => steps.attempt(h),
        }
    }
}

/// Corners of measured fluid pressures, between which the rates are smooth.
struct Stops {
    /// Times since the start, ascending [T]
    left: Vec<f64>,
}

impl Stops {
    fn after(start: f64, model: &Model) -> Self {
        let given = model.contacts.iter().filter_map(|pair| pair.fluid.as_ref()).flat_map(Fluid::corners);
        let wells = model.contacts.iter().filter_map(|pair| pair.conduit.as_ref()).flat_map(Conduit::corners);
        let times = given.chain(wells);
        let mut left: Vec<f64> = times.map(|time| time - start).filter(|left| *left > NEAR_END * start).collect();
        left.sort_by(f64::total_cmp);
        Self { left }
    }

    /// Time to the next one.
    fn left(&mut self, since: f64) -> Option<f64> {
        self.left.iter().map(|corner| corner - since).find(|left| *left > NEAR_END * since)
    }
}

/// Adds the contact forces on the nodes, and those of fluids to the loads.
fn add_contact_forces(model: &Model, contacts: &[Vec<ContactState>], found: &mut Evaluation) {
    for (pair, states) in model.contacts.iter().zip(contacts) {
        for (point, state) in pair.small.iter().flat_map(|small| small.points.iter().flatten()).zip(states) {
            let ContactState { friction, radiation, fluid, length, .. } = state;
            let of_fluid = point.normal * *fluid;
            let traction = point.normal * friction.pressure - point.tangent * (state.shear() + radiation) + of_fluid;
            for (&node, w) in point.nodes.iter().zip(&point.weights) {
                let node = model.ties.original(node);
                (0..2).for_each(|i| found.force[2 * node + i] -= w * traction[i] * length);
                (0..2).for_each(|i| found.loads[2 * node + i] += w * of_fluid[i] * length);
            }
        }
    }
}
