//! Explicit increments by central differences: the stability limit and the increment itself; equations in
//! [`crate::model::scheme`].
//!
//! ```text
//! Δt ≤ 2/ω,   ω² ≤ max over elements of (λ_e + max over its nodes of k/m)                                    (1)
//! λ_e = ‖A⁴‖^¼ ≥ largest eigenvalue of A = M_e^-½ K_e M_e^-½                                                   (2)
//! k: Σ |w_a| Σ |w_b| max(α_n, α_t) ℓ of the contact points at the node, its springs and bars likewise            (3)
//! Δt² ω² + 2 Δt c ≤ 4   or   Δt ≤ 4/(c + √(c² + 4 ω²)),   c: (2) of the viscous K_e                          (4)
//! ```
//! (1) holds because the highest frequency of a sum of stiffnesses is bounded by those of its parts, each with its fraction of
//! the mass (Irons & Treharne), the fractions of elements and contact being in the ratio of their ω². (2) with the Frobenius
//! norm is at most 8^⅛ = 1.3 times the eigenvalue, commonly 1.05. (3) is Gershgorin's theorem; every contact point with a
//! projection on the master counts, open or closed. `stability.rs` says when the bounds are re-evaluated. (4) replaces
//! Δt ≤ 2/ω in a viscous body, whose stress is evaluated with the mean velocity of the previous increment, (u₁ − u₀)/Δt: with a
//! damping ratio ζ = c/(2ω) it is 2/ω (√(1 + ζ²) − ζ). Mass-proportional damping and dashpots act at the end of the increment
//! and do not reduce the limit.
//!
//! Contact is evaluated in each increment as in an implicit one: the friction law takes the slip of the whole increment and
//! returns the traction at its end, an elastic predictor and a plastic corrector. It does not depend on the sign of a velocity,
//! so stick and slip do not chatter; a sticking point oscillates on its contact spring. If that spring is much stiffer than an
//! element, the oscillation is faster than any wave of the mesh and stays local: an impact produces high-frequency oscillation
//! unless the body is viscous.
//!
//! Water that flows through bodies and contacts: `pressures.rs` and `conduits.rs`.
//!
//! Source: Irons & Treharne (1971), Proc. 3rd Conf. Matrix Methods in Struct. Mech., WPAFB; Belytschko, Liu, Moran &
//! Elkhodary (2014), Nonlinear Finite Elements for Continua and Structures, §6.2.

mod conduits;
mod motion;
mod plates;
mod pressures;
mod stability;

use std::sync::Arc;

use nalgebra::Vector2;
use rayon::prelude::*;

use super::accept::take_stock;
use crate::equations::damping;
use crate::equations::{Assembler, Trial, TrialFailure};
use crate::model::boundary::Absorber;
use crate::model::support::Prescribed;
use crate::model::{Model, State, Step};
use crate::solve::failure::IncrementFailure;
use motion::masses;
use plates::Plates;
use pressures::{PressureSolver, moving};
pub use stability::ExplicitMemory;
use stability::Stability;

/// Largest change of an element in one increment, as a fraction of its size: the stiffness of an element that is hit then
/// stops the motion before the element inverts.
const MOST_CHANGE: f64 = 0.1;

/// Factor on the increments after a collapse.
const CUT: f64 = 0.5;

/// Smallest increment, as a fraction of the stable one.
const MOST_CAREFUL: f64 = 0.125;

/// Fraction of a step's end within which an output coincides with it.
const ROUND_OFF: f64 = 1e-9;

/// Data of the explicit increments of one step besides the state. What stays as it is is shared with its clones.
#[derive(Clone)]
pub struct Explicit {
    model: Arc<Model>,
    step: Arc<Step>,
    /// Mass of every node; that of tied copies is both with their nodes and with the copies [M]
    mass: Arc<[f64]>,
    /// Platens with one equal component, and rigid platens
    plates: Plates,
    /// Dashpots, absorbing sides and mass-proportional damping, one entry per node
    dampers: Arc<[Absorber]>,
    /// Their forces [F]
    forces: Vec<Vector2<f64>>,
    stability: Stability,
    /// Fraction of the stable increment that is used; less after a collapse
    care: f64,
    /// Last evaluated stable increment [T]
    stable: f64,
    /// Displacements at the end of the increment that is next; memory alone between two increments
    displacement: Vec<f64>,
    /// Mean velocity of an increment if bodies are viscous; as that [L/T]
    mean_velocity: Vec<f64>,
    /// Motion of each support in the increment, and its velocity before
    places: Vec<([f64; 4], f64)>,
    /// Factors of the balances of water that flows through bodies
    pressures: PressureSolver,
}

/// Number of degrees of freedom that one thread updates at a time.
const CHUNK: usize = 8192;

impl Explicit {
    /// Starts explicit increments, at the start of a step or within it: lumps the masses and computes the initial
    /// accelerations.
    ///
    /// # Errors
    /// Returns [`IncrementFailure`] if the state cannot be evaluated.
    pub fn begin(
        model: &Arc<Model>,
        step: &Arc<Step>,
        state: &mut State,
        assembler: &mut Assembler,
    ) -> Result<Self, IncrementFailure> {
        Self::with_care(1.0, model, step, state, assembler)
    }

    /// Increments that go on from where these are; the memory goes with them, and these make their own if they go on as well.
    pub fn branch(&mut self) -> Self {
        let [displacement, mean_velocity] = [&mut self.displacement, &mut self.mean_velocity].map(std::mem::take);
        let pressures = std::mem::take(&mut self.pressures);
        Self { displacement, mean_velocity, pressures, ..self.clone() }
    }

    /// Whether increments have reached their lower bound.
    pub fn is_most_careful(&self) -> bool {
        self.care <= MOST_CAREFUL
    }

    /// Shortens the increments, starting from the state before the mesh collapsed or the motion diverged; returns `false` if
    /// they have reached their lower bound.
    ///
    /// # Errors
    /// The same as for [`Explicit::begin`].
    pub fn more_carefully(&mut self, state: &mut State, assembler: &mut Assembler) -> Result<bool, IncrementFailure> {
        if self.is_most_careful() {
            return Ok(false);
        }
        *self = Self::with_care(CUT * self.care, &self.model.clone(), &self.step.clone(), state, assembler)?;
        Ok(true)
    }

    fn with_care(
        care: f64,
        model: &Arc<Model>,
        step: &Arc<Step>,
        state: &mut State,
        assembler: &mut Assembler,
    ) -> Result<Self, IncrementFailure> {
        let mut explicit = Self::of(model, step, Stability::new(model, step, state)?, care);
        explicit.displacement.clone_from(&state.displacement);
        explicit.stable = explicit.stable_increment(state);
        explicit.start(state, assembler)?;
        Ok(explicit)
    }

    /// Creates the data of increments that have not begun yet.
    fn of(model: &Arc<Model>, step: &Arc<Step>, stability: Stability, care: f64) -> Self {
        let mass = masses(model);
        Self {
            model: model.clone(),
            step: step.clone(),
            plates: Plates::new(model, step, &mass),
            mass: mass.into(),
            dampers: damping::by_node(model, step).into(),
            forces: Vec::new(),
            stability,
            care,
            stable: 0.0,
            displacement: Vec::new(),
            mean_velocity: Vec::new(),
            places: Vec::new(),
            pressures: PressureSolver::default(),
        }
    }

    /// Safe fraction of (1), bounded by the limits of the step [T].
    fn stable_increment(&mut self, state: &State) -> f64 {
        let longest = self.stability.longest_increment(&self.step, &self.mass, state);
        self.safe(longest)
    }

    fn safe(&self, longest: f64) -> f64 {
        (self.step.scheme.safety() * self.care * longest).min(self.step.increments.max)
    }

    /// Makes equal increments up to a time, none longer than the stable one. Stored energies of motion and contacts are
    /// evaluated at the end only; work and dissipation are summed in between. A requested `pause` ends the call after an
    /// increment before that time; the continuation is bitwise the same.
    ///
    /// # Errors
    /// Returns [`IncrementFailure`] if an element inverts, a friction law fails, or a load or the motion has no finite value.
    pub fn go_to(
        &mut self,
        time: f64,
        state: &mut State,
        assembler: &mut Assembler,
        pause: &dyn Fn() -> bool,
    ) -> Result<usize, IncrementFailure> {
        let mut increments = 0;
        while state.time < time {
            let end = self.next(time, state)?;
            self.advance(end, state, assembler)?;
            increments += 1;
            if state.time < time && pause() {
                return Ok(increments);
            }
        }
        take_stock(&self.model, self.kinetic_energy(state, state.dt), state);
        match state.energy.kinetic.is_finite() {
            true => Ok(increments),
            false => Err(IncrementFailure::Unbounded),
        }
    }

    /// End of the next increment towards a time, and the displacements there. Where an element or a contact has changed, the
    /// stable increment is re-evaluated.
    fn next(&mut self, time: f64, state: &State) -> Result<f64, IncrementFailure> {
        let end = part(state.time, time, self.stable);
        let way = self.predict(end, state)?;
        self.stability.moved(way);
        let changed = self.stability.changed(&self.displacement);
        self.stability.look(&changed, state)?;
        match self.stability.contacts_changed(state) {
            true => self.stable = self.stable_increment(state),
            false if changed.is_empty() => return Ok(end),
            // Increases are picked up at the next full evaluation.
            false => self.stable = self.safe(self.stability.longest_of(changed.iter().copied())).min(self.stable),
        }
        let end = part(state.time, time, self.stable);
        self.predict(end, state)?;
        let excess = self.stability.largest_change(&changed, &self.displacement) / (MOST_CHANGE * self.care);
        if excess <= 1.0 || !excess.is_finite() {
            return Ok(end);
        }
        let end = part(state.time, time, (end - state.time) / excess);
        self.predict(end, state)?;
        Ok(end)
    }

    /// Evaluates (7) and the motion of supports; returns an upper bound of the relative displacement of any two nodes [L].
    fn predict(&mut self, time: f64, state: &State) -> Result<f64, IncrementFailure> {
        let (model, step, dt) = (&*self.model.clone(), &*self.step.clone(), time - state.time);
        let old = (&state.displacement, &state.velocity, &state.acceleration);
        self.displacement.resize(state.displacement.len(), 0.0);
        let (places, pressures) = self.displacement.split_at_mut(2 * moving(model));
        let rates = old.0[places.len()..].iter().zip(&old.1[places.len()..]);
        pressures.iter_mut().zip(rates).for_each(|(p, (before, rate))| *p = before + dt * rate);
        let ways = places.par_chunks_mut(CHUNK).enumerate().map(|(chunk, u)| {
            let (u0, v, a) = (&old.0[CHUNK * chunk..], &old.1[CHUNK * chunk..], &old.2[CHUNK * chunk..]);
            let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
            let rates = v.chunks_exact(2).zip(a.chunks_exact(2));
            for ((u, u0), (v, a)) in u.chunks_exact_mut(2).zip(u0.chunks_exact(2)).zip(rates) {
                for i in 0..2 {
                    let way = dt * (v[i] + 0.5 * dt * a[i]);
                    u[i] = u0[i] + way;
                    low[i] = if way < low[i] { way } else { low[i] };
                    high[i] = if way > high[i] { way } else { high[i] };
                }
            }
            (low, high)
        });
        let none = || ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let (mut low, mut high) = ways.reduce(none, |(low, high), (of, to)| {
            ([0, 1].map(|i| f64::min(low[i], of[i])), [0, 1].map(|i| f64::max(high[i], to[i])))
        });
        let trial = Trial::new(state, step, time, dt);
        self.places.clear();
        let places = |support: &Prescribed| (trial.thirds(support, model), support.at.of(&state.velocity));
        self.places.extend(step.supports.iter().map(places));
        for (support, (places, _)) in step.supports.iter().zip(&self.places) {
            if !places.iter().all(|place| place.is_finite()) {
                let node = model.mesh.node_tags[support.at.node()];
                return Err(IncrementFailure::Start(TrialFailure::Undefined { node, time }));
            }
            support.at.set(places[3], &mut self.displacement);
            let first = support.at.dof & !1;
            for i in (0..2).filter(|i| support.at.inclined.is_some() || first + i == support.at.dof) {
                let way = self.displacement[first + i] - state.displacement[first + i];
                (low[i], high[i]) = (low[i].min(way), high[i].max(way));
            }
        }
        model.ties.spread(2, &mut self.displacement);
        self.plates.turn(model, dt, state, &mut self.displacement);
        Ok((high[0] - low[0]).hypot(high[1] - low[1]))
    }
}

/// End of the first of equal increments from one time to another, none longer than `longest`.
fn part(start: f64, end: f64, longest: f64) -> f64 {
    let left = end - start;
    let count = (left / longest - ROUND_OFF).ceil().max(1.0);
    if count == 1.0 { end } else { start + left / count }
}
