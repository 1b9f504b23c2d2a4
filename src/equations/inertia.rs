//! Inertia: mass matrix and forces, and the time-discrete equations of the scheme.
//!
//! Velocities and accelerations at a trial displacement follow from the scheme and the supports.

use nalgebra::{DMatrix, Vector2};

use super::coupling::Layout;
use super::links::{self, Turning, blend};
use super::sums::{Dependence, add_blocks};
use super::trial::Trial;
use crate::linear::SparseMatrix;
use crate::model::scheme::TimeIntegration;
use crate::model::support::Prescribed;
use crate::model::{Model, Step};

/// The tangent is M ∂a/∂u, the mass over Δt².
pub(super) fn dependence(step: &Step) -> Dependence {
    if step.scheme.coefficients().is_some() { Dependence::StepSize } else { Dependence::Nothing }
}

/// Returns the mass matrix on the current pattern: consistent in the elements, except those of absent bodies, point
/// masses and those of bars on the diagonal.
pub(super) fn mass(model: &Model, layout: &Layout, [absent, bars_absent]: [&[bool]; 2]) -> SparseMatrix {
    let share = |body: usize| if absent.get(body) == Some(&true) { 0.0 } else { 1.0 };
    let mut mass = elements(model, layout, share);
    for point in &model.point_masses {
        let nodes = point.nodes.iter().map(|&node| layout.original(node));
        let dofs = nodes.flat_map(|node| [2 * node, 2 * node + 1]);
        dofs.for_each(|dof| mass.add_diagonal(dof, point.mass));
    }
    add_bars(&mut mass, model, layout, |k| if bars_absent.get(k) == Some(&true) { 0.0 } else { 1.0 });
    for body in &model.mesh.rigid_bodies {
        mass.add_diagonal(2 * body.turning, body.turning_mass());
    }
    mass
}

/// Adds the masses of bars, each multiplied by a factor.
pub(super) fn add_bars(total: &mut SparseMatrix, model: &Model, layout: &Layout, share: impl Fn(usize) -> f64) {
    for (bar, share) in model.bars.iter().enumerate().map(|(k, bar)| (bar, share(k))) {
        for (node, own) in bar.nodal_masses(&model.massless).filter(|_| share * bar.mass > 0.0) {
            let node = layout.original(node);
            [2 * node, 2 * node + 1].into_iter().for_each(|dof| total.add_diagonal(dof, share * own));
        }
    }
}

/// Masses of the elements, each multiplied by a factor of its body.
pub(super) fn elements(model: &Model, layout: &Layout, share: impl Fn(usize) -> f64) -> SparseMatrix {
    let mut total = layout.matrix();
    for (e, element) in model.mesh.elements.iter().enumerate() {
        let mass = share(model.body_of_element[e]) * model.element_mass(e);
        let both = mass.kronecker(&DMatrix::identity(2, 2));
        add_blocks(&mut total, layout.blocks_of(e), both.as_slice(), element.nodes.len());
    }
    total
}

/// Inertia at a trial displacement.
pub(super) struct Inertia {
    /// v [L/T]
    pub velocity: Vec<f64>,
    /// a [L/T²]
    pub acceleration: Vec<f64>,
    /// M a [F]
    pub force: Vec<f64>,
    /// M times the accelerations weighted by (1) of [`crate::model::scheme`] [F]
    pub weighted: Vec<f64>,
    /// ∂(weighted a)/∂u of each dof: the factor of its column of M [1/T²]
    pub factors: Vec<f64>,
    /// rigid platens, whose tangent has further terms
    turning: Vec<Turning>,
    scheme: TimeIntegration,
}

impl Inertia {
    /// Computes the inertia in a dynamic increment with the mass matrix M; prescribed dofs have the acceleration of their
    /// supports.
    pub fn at(model: &Model, trial: Trial, u: &[f64], mass: &SparseMatrix) -> Option<Self> {
        let Trial { old, step, .. } = trial;
        let scheme = trial.integration()?;
        let (velocity, acceleration) = rates(model, trial, u, scheme);
        let accelerations = old.acceleration.iter().zip(&acceleration);
        let mut weighted: Vec<f64> =
            accelerations.map(|(old, new)| blend(scheme.coefficients.alpha_m, *old, *new)).collect();
        let mut factors = vec![(1.0 - scheme.coefficients.alpha_m) * scheme.dacceleration(); u.len()];
        for support in &step.supports {
            let at = support.at;
            let along = blend(scheme.coefficients.alpha_f, at.of(&old.acceleration), at.of(&acceleration));
            match at.inclined {
                None => (weighted[at.dof], factors[at.dof]) = (along, 0.0),
                Some(_) => {
                    let missed = missed(support, trial.prescribed(support, model), u);
                    let rest =
                        (scheme.coefficients.alpha_f - scheme.coefficients.alpha_m) * scheme.dacceleration() * missed;
                    at.set(along + rest, &mut weighted);
                }
            }
        }
        for (dof, base, of_leaders) in followed(model, trial, u) {
            weighted[dof] = of_leaders(&weighted) + factors[dof] * (u[dof] - base);
        }
        let turning = Turning::all(model, trial, u, scheme);
        let rate = (1.0 - scheme.coefficients.alpha_m) * scheme.dacceleration();
        turning.iter().for_each(|plate| plate.weighted(scheme, rate, &mut weighted));
        links::spread_turning(model, rate, u, &mut weighted);
        let [force, weighted] = mass.multiply_symmetric([&acceleration, &weighted]);
        Some(Self { velocity, acceleration, force, weighted, factors, turning, scheme })
    }

    /// (1) of [`crate::model::scheme`]: the residual of the weighted forces, those at the start of the increment and those at
    /// the trial displacement, and the inertia.
    pub fn balance(&self, old_force: &[f64], force: &[f64], residual: &mut Vec<f64>) {
        residual.clear();
        let blended =
            old_force.iter().zip(force).map(|(&old, &force)| blend(self.scheme.coefficients.alpha_f, old, force));
        residual.extend(blended.zip(&self.weighted).map(|(force, inertia)| force + inertia));
    }

    /// Weights the tangent of the forces alike, and adds that of the inertia.
    pub fn weigh(&self, model: &Model, mass: &SparseMatrix, tangent: &mut SparseMatrix) {
        tangent.values.iter_mut().for_each(|value| *value *= 1.0 - self.scheme.coefficients.alpha_f);
        self.stiffen(model, mass, tangent);
    }

    /// Adds the tangent of the weighted inertia.
    pub fn stiffen(&self, model: &Model, mass: &SparseMatrix, tangent: &mut SparseMatrix) {
        tangent.add_columns(mass, &self.factors);
        self.turning.iter().for_each(|plate| plate.stiffen(model, self.scheme, &self.factors, mass, tangent));
    }
}

/// Kinetic energy ½ vᵀ M v [F·L].
pub fn kinetic_energy(mass: &SparseMatrix, velocity: &[f64]) -> f64 {
    let [momentum] = mass.multiply_symmetric([velocity]);
    0.5 * momentum.iter().zip(velocity).map(|(p, v)| p * v).sum::<f64>()
}

/// Velocity and acceleration at `u`; prescribed dofs have those of their supports.
fn rates(model: &Model, trial: Trial, u: &[f64], scheme: TimeIntegration) -> (Vec<f64>, Vec<f64>) {
    let Trial { old, step, .. } = trial;
    let free = |dof: usize| scheme.rates(u[dof] - old.displacement[dof], old.velocity[dof], old.acceleration[dof]);
    let (mut velocity, mut acceleration): (Vec<f64>, Vec<f64>) = (0..u.len()).map(free).unzip();
    for support in &step.supports {
        let places = trial.thirds(support, model);
        let (v, a) = scheme.supported(places, support.at.of(&old.velocity));
        let missed = missed(support, places[3], u);
        support.at.set(v + scheme.dvelocity() * missed, &mut velocity);
        support.at.set(a + scheme.dacceleration() * missed, &mut acceleration);
    }
    model.ties.spread(2, &mut velocity);
    model.ties.spread(2, &mut acceleration);
    for (dof, base, of_leaders) in followed(model, trial, u) {
        velocity[dof] = of_leaders(&velocity) + scheme.dvelocity() * (u[dof] - base);
        acceleration[dof] = of_leaders(&acceleration) + scheme.dacceleration() * (u[dof] - base);
    }
    for plate in Turning::all(model, trial, u, scheme) {
        plate.velocities(scheme.dvelocity(), &mut velocity);
        plate.accelerations(scheme.dacceleration(), &mut acceleration);
    }
    links::spread_turning(model, scheme.dvelocity(), u, &mut velocity);
    links::spread_turning(model, scheme.dacceleration(), u, &mut acceleration);
    (velocity, acceleration)
}

/// Dofs that follow supported ones, with the target of their leaders and their dependence on them. A follower of a free dof has
/// the rates of its own displacement, which agree in the solution.
fn followed<'a>(
    model: &'a Model,
    trial: Trial<'a>,
    u: &'a [f64],
) -> impl Iterator<Item = (usize, f64, impl Fn(&[f64]) -> f64 + 'a)> {
    let target = move |dof: usize| trial.step.support_at(dof).map(|support| trial.prescribed(support, model));
    let dofs =
        model.linkage.followers.iter().flat_map(|follower| follower.dofs().map(move |(i, dof)| (follower, i, dof)));
    dofs.filter_map(move |(follower, i, dof)| {
        target(model.linkage.leading(dof))?;
        let base = follower.value_by(i, |dof| target(dof).unwrap_or(u[dof]));
        Some((dof, base, move |values: &[f64]| follower.value(i, values)))
    })
}

/// d·u − ū of an inclined support, which vanishes in the solution. With it the rates of its node vary equally in all
/// directions, so that their tangent needs no rotation. Along a coordinate the rates are those of the support whatever the
/// value of the dof.
pub(super) fn missed(support: &Prescribed, target: f64, u: &[f64]) -> f64 {
    if support.at.inclined.is_some() { support.at.of(u) - target } else { 0.0 }
}

/// v of one dof at the end of the increment, and ∂v/∂u: from [`rates`] or, in statics, the mean of the increment. An
/// increment of zero length leaves v unchanged.
pub(super) fn velocity(model: &Model, trial: Trial, u: &[f64], dof: usize) -> (f64, f64) {
    let Trial { old, step, .. } = trial;
    let dof = model.linkage.leading(2 * model.ties.original(dof / 2) + dof % 2);
    let (increment, before) = (u[dof] - old.displacement[dof], old.velocity[dof]);
    if trial.is_instant() {
        return (before, 0.0);
    }
    let Some(scheme) = trial.integration() else { return trial.mean_velocity(increment) };
    let free = |dof: usize| scheme.rates(u[dof] - old.displacement[dof], old.velocity[dof], old.acceleration[dof]).0;
    match step.support_at(dof) {
        Some(support) if support.at.inclined.is_some() => {
            let places = trial.thirds(support, model);
            let along = scheme.supported(places, support.at.of(&old.velocity)).0
                + scheme.dvelocity() * missed(support, places[3], u);
            let (d, first) = (support.at.vector(), dof & !1);
            let rates = Vector2::new(free(first), free(first + 1));
            ((rates + d * (along - d.dot(&rates)))[dof % 2], scheme.dvelocity())
        }
        Some(support) => (scheme.supported(trial.thirds(support, model), before).0, 0.0),
        None => (free(dof), scheme.dvelocity()),
    }
}

/// v and ∂v/∂u of every dof in a dynamic increment; v only at the start of dynamics, and `None` in statics.
pub(super) fn motion(model: &Model, trial: Trial, u: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
    let Trial { old, step, .. } = trial;
    if trial.is_instant() {
        return Some((old.velocity.clone(), vec![0.0; u.len()]));
    }
    let scheme = trial.integration()?;
    let mut dvelocity = vec![scheme.dvelocity(); u.len()];
    let straight = step.supports.iter().filter(|support| support.at.inclined.is_none());
    straight.for_each(|support| dvelocity[support.at.dof] = 0.0);
    model.ties.spread(2, &mut dvelocity);
    Some((rates(model, trial, u, scheme).0, dvelocity))
}
