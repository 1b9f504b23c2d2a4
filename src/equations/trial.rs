//! An increment to be solved.

use nalgebra::Vector2;

use crate::mesh::configuration::vector;
use crate::model::boundary::Moment;
use crate::model::scheme::TimeIntegration;
use crate::model::state::LastIncrement;
use crate::model::support::Prescribed;
use crate::model::{Model, State, Step};

/// One increment to be solved: initial state, end time and step.
#[derive(Clone, Copy, Debug)]
pub struct Trial<'a> {
    /// committed state
    pub old: &'a State,
    /// the step
    pub step: &'a Step,
    /// t at the end of the increment [T]
    pub time: f64,
    /// Δt [T]
    pub dt: f64,
    /// Start and end of the increment, if equilibrium is required beyond its end
    pub beyond: Option<[f64; 2]>,
    /// Factor on α_n: above 1 for contacts in the augmented Lagrangian method, below 1 for all contacts in the iterations for
    /// an initial guess
    pub stiffening: f64,
    /// Whether the bodies deform under the pressures that arise within the increment; false in central differences
    pub settles: bool,
}

impl<'a> Trial<'a> {
    /// Creates the increment from a state to a time.
    pub fn new(old: &'a State, step: &'a Step, time: f64, dt: f64) -> Self {
        Self { old, step, time, dt, beyond: None, stiffening: 1.0, settles: true }
    }

    /// Returns the increment to the time t + θ Δt at which the scheme requires equilibrium.
    pub fn ahead(self) -> Trial<'a> {
        let theta = self.step.scheme.theta();
        if theta == 1.0 {
            return self;
        }
        let beyond = Some([self.old.time, self.time]);
        Self { time: self.old.time + theta * self.dt, dt: theta * self.dt, beyond, ..self }
    }

    /// The moment at which supports and loads are evaluated.
    pub fn moment(&self) -> Moment {
        Moment { time: self.time, beyond: self.beyond }
    }

    /// The scheme over the increment; `None` without inertia.
    pub fn integration(&self) -> Option<TimeIntegration> {
        TimeIntegration::new(self.step.scheme, self.dt)
    }

    /// Whether the state at its start is evaluated, and nothing moves.
    pub fn is_instant(&self) -> bool {
        self.dt == 0.0
    }

    /// ∂v/∂u at the end of the increment, of the mean velocity without inertia [1/T].
    pub fn dvelocity(&self) -> f64 {
        self.integration().map_or(1.0 / self.dt, |scheme| scheme.dvelocity())
    }

    /// Δt v₀ + ½ Δt² a₀ of a dof: its way in the increment if it goes on as it began, with its acceleration or without [L].
    pub fn way(&self, dof: usize, accelerates: bool) -> f64 {
        let acceleration = if accelerates { self.old.acceleration[dof] } else { 0.0 };
        self.dt * (self.old.velocity[dof] + 0.5 * self.dt * acceleration)
    }

    /// The fraction of the motion of the last increment by which this one is expected to go on, in a model whose water flows or not.
    pub fn pace(&self, last: &LastIncrement, flows: bool) -> Option<f64> {
        last.goes_on(self.dt, flows)
    }

    /// v of a dof that moves by Δu in an increment without inertia, and ∂v/∂Δu.
    pub fn mean_velocity(&self, increment: f64) -> (f64, f64) {
        (increment / self.dt, 1.0 / self.dt)
    }

    /// Whether a shorter increment may follow if this one cannot be solved.
    pub fn may_be_shortened(&self) -> bool {
        self.step.shorter(self.dt, 1).is_some()
    }

    /// Coefficient c of a stabilizing dashpot at the end of the increment, from that per Δt at the start of the step.
    pub fn stabilizing(&self, start: f64) -> f64 {
        self.stabilization_left() * start / self.dt
    }

    /// Remaining fraction of the stabilizing dashpots at the end of the increment, 1 to 0; exactly 0 at the end of the
    /// step.
    pub fn stabilization_left(&self) -> f64 {
        1.0 - self.step.span.share(self.time)
    }

    /// ū of a support at the end of the increment; not finite if its expression has no value [L].
    pub fn prescribed(&self, support: &Prescribed, model: &Model) -> f64 {
        if self.beyond.is_some() {
            return self.thirds(support, model)[3];
        }
        let (position, start) = self.place(support, model);
        support.value(position, self.time, self.step.span, start)
    }

    /// ū of a support at the start, thirds and end of the increment [L].
    pub fn thirds(&self, support: &Prescribed, model: &Model) -> [f64; 4] {
        let (position, start) = self.place(support, model);
        support.thirds(position, self.time - self.dt, self.moment(), self.step.span, start)
    }

    /// Reference position of a support, and its displacement at the start of the step.
    fn place(&self, support: &Prescribed, model: &Model) -> (Vector2<f64>, Vector2<f64>) {
        let node = support.at.node();
        let start = &self.old.step_start.displacement[2 * node..][..2];
        (model.mesh.nodes[node], Vector2::new(start[0], start[1]))
    }
}

/// Values at an element's nodes, from those of all dofs.
pub(super) fn nodal(model: &Model, e: usize, all: &[f64]) -> [Vector2<f64>; 9] {
    let mut local = [Vector2::zeros(); 9];
    for (local, &node) in local.iter_mut().zip(&model.mesh.elements[e].nodes) {
        *local = vector(all, node);
    }
    local
}
