//! Follower nodes (`model/linkage.rs`): their equations, and those of rigid platens.
//!
//! ```text
//!  A ●━━━━━━○━━━━━━━○━━━━━━━━━● B     A, B: leaders, at the distance L;   ○: followers c, which keep their place between them
//!    ├──────────── e ─────────→
//! ```
//!
//! ```text
//! w (u_c − Σ G_k u_k) = 0                  a follower; its forces are with its leaders
//! r_A + r_B = 0,   (J e)·r_B/L = 0         a rigid platen: forces, and moments about A
//! w (|e|² − L²)/(2 L) = 0                  its length
//! ```
//! In motion r includes the inertia (below), and e in the moments is weighted with α_f, as the forces are.
//!
//! # Rigid plates in motion
//!
//! The velocities and accelerations of the nodes of a rigid platen, and its contribution to the tangent of inertia, are
//!
//! ```text
//! x_c = x_R + (G_c − G_R) e                     R: the center of mass, or the node A if it is supported
//! v_c = v_R + (G_c − G_R) ω J e                 u_R and the angle of e follow the scheme
//! a_c = a_R + (G_c − G_R) (θ̈ J e − ω² e)
//! weighted:   θ̈_m J e_f − (ω²)_f e_f            _m, _f: weighted with α_m and α_f, as masses and forces are
//! ```
//!
//! If the scheme were applied node by node, the force that keeps their distance would oscillate from increment to increment
//! (Cardona & Géradin 1989, Comput. Struct. 33, 801). With R at the center of mass, momentum changes by the external forces
//! only. While |e| differs from L, the excess moves by the scheme, so that a node-by-node tangent lacks terms of order ω Δt
//! only.

use std::borrow::Cow;
use std::collections::BTreeMap;

use nalgebra::{Matrix2, Matrix4, Vector2};

use super::trial::Trial;
use crate::linear::SparseMatrix;
use crate::linear::system::System;
use crate::mesh::configuration::vector;
use crate::model::linkage::Follower;
use crate::model::scheme::TimeIntegration;
use crate::model::{Model, State};

/// e of a rigid platen initially, and its change by the displacements `u`.
fn arms(model: &Model, [a, b]: [usize; 2], u: &[f64]) -> [Vector2<f64>; 2] {
    [model.mesh.nodes[b] - model.mesh.nodes[a], relative([a, b], u)]
}

/// Motion of B relative to A.
pub fn relative([a, b]: [usize; 2], values: &[f64]) -> Vector2<f64> {
    Vector2::new(values[2 * b] - values[2 * a], values[2 * b + 1] - values[2 * a + 1])
}

/// J e: the vector rotated by +90°.
pub fn perpendicular(e: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-e.y, e.x)
}

/// Average of the values before and after, weighted with α_f.
fn blended(scheme: TimeIntegration, [before, after]: [Vector2<f64>; 2]) -> Vector2<f64> {
    before * scheme.coefficients.alpha_f + after * (1.0 - scheme.coefficients.alpha_f)
}

/// Sets the values of B relative to A to `along`, keeping those of R with its G.
pub fn give([a, b]: [usize; 2], reference: Matrix2<f64>, along: Vector2<f64>, values: &mut [f64]) {
    let shift = reference * (relative([a, b], values) - along);
    for i in 0..2 {
        values[2 * a + i] += shift[i];
        values[2 * b + i] = values[2 * a + i] + along[i];
    }
}

/// Direction e and length L of a rigid platen.
fn arm(model: &Model, plate: [usize; 2], u: &[f64]) -> (Vector2<f64>, f64) {
    let [before, way] = arms(model, plate, u);
    (before + way, before.norm())
}

/// (|e|² − L²)/(2 L), accurate for small motions.
fn stretch(model: &Model, plate: [usize; 2], u: &[f64]) -> f64 {
    let [before, way] = arms(model, plate, u);
    way.dot(&(2.0 * before + way)) / (2.0 * before.norm())
}

/// Force on B, and its opposite on A, of a moment M on a rigid platen, f = M J e/|e|²; and ∂F/∂u of both, where F subtracts it.
pub(super) fn couple(model: &Model, plate: [usize; 2], u: &[f64], moment: f64) -> (Vector2<f64>, Matrix4<f64>) {
    let e = arm(model, plate, u).0;
    let (turned, square) = (perpendicular(e), e.norm_squared());
    let turn = Matrix2::new(0.0, -1.0, 1.0, 0.0);
    let rates = (turn / square - turned * e.transpose() * (2.0 / (square * square))) * moment;
    let mut both = Matrix4::zeros();
    for (i, j, sign) in [(0, 0, -1.0), (0, 2, 1.0), (2, 0, 1.0), (2, 2, -1.0)] {
        both.fixed_view_mut::<2, 2>(i, j).copy_from(&(rates * sign));
    }
    (turned * (moment / square), both)
}

/// Largest error of the constraints: followers relative to their leaders, and lengths of rigid platens [L].
pub(super) fn missed(model: &Model, u: &[f64]) -> f64 {
    let error = |(follower, (i, dof)): (&Follower, (usize, usize))| (u[dof] - follower.value(i, u)).abs();
    let followers = model.linkage.followers.iter().flat_map(|follower| follower.dofs().map(move |dof| (follower, dof)));
    let plates = model.linkage.rigid.iter().map(|plate| stretch(model, *plate, u).abs());
    followers.map(error).chain(plates).fold(0.0, f64::max)
}

/// Forces with the constraint force of rigid platens moved from B to A: it is no residual.
pub fn relieved<'a>(model: &Model, u: &[f64], force: &'a [f64]) -> Cow<'a, [f64]> {
    let mut force = Cow::Borrowed(force);
    for &[a, b] in &model.linkage.rigid {
        let force = force.to_mut();
        let e = arm(model, [a, b], u).0.normalize();
        let along = e.x * force[2 * b] + e.y * force[2 * b + 1];
        for i in 0..2 {
            force[2 * b + i] -= along * e[i];
            force[2 * a + i] += along * e[i];
        }
    }
    force
}

/// Nodes that follow or lead: followers' equations are summed up, and their columns are not.
pub(super) fn unsymmetric(model: &Model) -> Vec<usize> {
    model.linkage.nodes()
}

/// Adds the equations of followers to those of their leaders, before supports replace equations.
pub fn gather_rows(model: &Model, matrix: &mut SparseMatrix) {
    for follower in &model.linkage.followers {
        for (i, _) in follower.dofs() {
            for (leader, g) in &follower.leaders {
                for j in (0..2).filter(|&j| g[(i, j)] != 0.0) {
                    matrix.add_row(2 * follower.node + i, 2 * leader + j, g[(i, j)]);
                }
            }
        }
    }
    for &[a, b] in &model.linkage.rigid {
        (0..2).for_each(|i| matrix.add_row(2 * b + i, 2 * a + i, 1.0));
    }
}

/// The same for the residual: rigid platens balance their forces at A.
pub fn gather_residual(model: &Model, residual: &mut [f64]) {
    for &[a, b] in &model.linkage.rigid {
        (0..2).for_each(|i| residual[2 * a + i] += residual[2 * b + i]);
    }
}

/// Work of the moments on rigid platens, whose equations replace a force on B, minus the work of that.
pub fn missing_work<'a>(
    model: &'a Model,
    u: &'a [f64],
    residual: &'a [f64],
    way: &'a [f64],
) -> impl Iterator<Item = f64> + 'a {
    model.linkage.rigid.iter().map(move |&[a, b]| {
        let (e, length) = arm(model, [a, b], u);
        let turn = e.perp(&relative([a, b], way)) / e.norm_squared();
        residual[2 * b] * (length * turn - way[2 * b]) - residual[2 * b + 1] * way[2 * b + 1]
    })
}

/// Sets the equations of followers, and of B of rigid platens, whose forces `r_B` were in the residual.
pub(super) fn prescribe(model: &Model, weight: f64, trial: Trial, u: &[f64], tangent: bool, system: &mut System) {
    for follower in &model.linkage.followers {
        for (i, dof) in follower.dofs() {
            system.residual[dof] = weight * (u[dof] - follower.value(i, u));
        }
    }
    for &[a, b] in &model.linkage.rigid {
        let (e, length) = arm(model, [a, b], u);
        let before = arm(model, [a, b], &trial.old.displacement).0;
        let scheme = trial.integration();
        let lever = scheme.map_or(e, |scheme| blended(scheme, [before, e]));
        let force = vector(&system.residual, b);
        system.residual[2 * b] = lever.perp(&force) / length;
        system.residual[2 * b + 1] = weight * stretch(model, [a, b], u);
        if tangent {
            keep_length(model, [a, b], [e, lever], weight, &mut system.tangent);
            let share = scheme.map_or(1.0, |scheme| 1.0 - scheme.coefficients.alpha_f);
            let turned = Vector2::new(force.y, -force.x) * (share / length);
            let matrix = &mut system.tangent;
            for (node, sign) in [(a, -1.0), (b, 1.0)] {
                (0..2).for_each(|j| matrix.add(2 * b, 2 * node + j, sign * turned[j]));
            }
        }
    }
    if tangent {
        follow(model, weight, &mut system.tangent);
    }
}

/// Replaces the equations of B by their moment, and by w e·(x_B − x_A)/L.
fn keep_length(
    model: &Model,
    [a, b]: [usize; 2],
    [e, lever]: [Vector2<f64>; 2],
    weight: f64,
    matrix: &mut SparseMatrix,
) {
    let length = (model.mesh.nodes[b] - model.mesh.nodes[a]).norm();
    let (own, across) = (e * (weight / length), perpendicular(lever) / length);
    matrix.turn_rows(2 * b + 1, own.into(), across.into());
    for (node, sign) in [(a, -1.0), (b, 1.0)] {
        let block = matrix.pattern.coupled(b, node);
        (0..2).for_each(|j| matrix.values[block.value(1, j)] = sign * own[j]);
    }
}

/// Sets the equations of accelerations in a state, with a mass `weight`: e·(a_B − a_A) = −ω² L², and balance of moments.
pub fn begin(model: &Model, weight: f64, state: &State, matrix: &mut SparseMatrix, right: &mut [f64]) {
    for &[a, b] in &model.linkage.rigid {
        let (e, length) = arm(model, [a, b], &state.displacement);
        let spin = e.perp(&relative([a, b], &state.velocity)) / e.norm_squared();
        right[2 * b] = e.perp(&vector(right, b)) / length;
        right[2 * b + 1] = -weight * spin * spin * e.norm_squared() / length;
        keep_length(model, [a, b], [e, e], weight, matrix);
    }
    follow(model, weight, matrix);
}

/// Projects velocities to those of rigid platens, keeping A and the rotation of B about it.
pub fn stiffen_velocities(model: &Model, u: &[f64], velocity: &mut [f64]) {
    for &[a, b] in &model.linkage.rigid {
        let e = arm(model, [a, b], u).0;
        let spin = e.perp(&relative([a, b], velocity)) / e.norm_squared();
        let turned = perpendicular(e) * spin;
        (0..2).for_each(|i| velocity[2 * b + i] = velocity[2 * a + i] + turned[i]);
    }
    model.linkage.spread(velocity);
}

/// Replaces the equations of followers by w (x_c − Σ G_k x_k) = 0.
fn follow(model: &Model, weight: f64, matrix: &mut SparseMatrix) {
    for follower in &model.linkage.followers {
        for (i, dof) in follower.dofs() {
            matrix.replace_row(dof, weight);
            for (leader, g) in &follower.leaders {
                (0..2).for_each(|j| matrix.add(dof, 2 * leader + j, -weight * g[(i, j)]));
            }
        }
    }
}

/// A rigid platen in an increment.
pub(super) struct Turning {
    leaders: [usize; 2],
    /// G_R
    reference: Matrix2<f64>,
    /// e at the start and the end [L]
    e: [Vector2<f64>; 2],
    /// ω at the start and the end [1/T]
    spin: [f64; 2],
    /// θ̈ at the start and the end [1/T²]
    angular: [f64; 2],
    /// Excess length of |e| as a vector, and its ∂/∂e [L]
    excess: (Vector2<f64>, Matrix2<f64>),
}

impl Turning {
    /// All platens in the increment to the displacement `u`.
    pub fn all(model: &Model, trial: Trial, u: &[f64], scheme: TimeIntegration) -> Vec<Self> {
        (0..model.linkage.rigid.len()).map(|k| Self::of(model, trial, u, scheme, k)).collect()
    }

    fn of(model: &Model, trial: Trial, u: &[f64], scheme: TimeIntegration, k: usize) -> Self {
        let leaders = model.linkage.rigid[k];
        let e: [Vector2<f64>; 2] = [&trial.old.displacement, u].map(|u| arms(model, leaders, u).iter().sum());
        let (spin, angular) = turning(model, leaders, trial);
        let way = relative(leaders, u) - relative(leaders, &trial.old.displacement);
        let angle = e[0].perp(&way).atan2(e[0].norm_squared() + e[0].dot(&way));
        let end = scheme.rates(angle, spin, angular);
        let [before, way] = arms(model, leaders, u);
        let square = before.norm_squared();
        let stretch = way.dot(&(2.0 * before + way)) / (2.0 * square);
        let excess = (e[1] * stretch, e[1] * e[1].transpose() / square + Matrix2::identity() * stretch);
        let reference = reference(model, trial, k);
        Self { leaders, reference, e, spin: [spin, end.0], angular: [angular, end.1], excess }
    }

    /// Velocities from those of the scheme node by node, with ∂v/∂u = `rate`.
    pub fn velocities(&self, rate: f64, values: &mut [f64]) {
        self.give(perpendicular(self.e[1]) * self.spin[1] + self.excess.0 * rate, values);
    }

    /// Applies the constraint to accelerations, with the centripetal term.
    pub fn accelerations(&self, rate: f64, values: &mut [f64]) {
        let centripetal = self.e[1] * self.spin[1].powi(2);
        self.give(perpendicular(self.e[1]) * self.angular[1] - centripetal + self.excess.0 * rate, values);
    }

    /// Applies the constraint to the weighted accelerations of the scheme.
    pub fn weighted(&self, scheme: TimeIntegration, rate: f64, values: &mut [f64]) {
        let angular = blend(scheme.coefficients.alpha_m, self.angular[0], self.angular[1]);
        let arm = blended(scheme, self.e);
        self.give(perpendicular(arm) * angular - arm * self.square(scheme) + self.excess.0 * rate, values);
    }

    /// Weighted square of the angular velocity, (ω²)_f.
    fn square(&self, scheme: TimeIntegration) -> f64 {
        blend(scheme.coefficients.alpha_f, self.spin[0].powi(2), self.spin[1].powi(2))
    }

    /// Sets the values of B relative to A to `relative`, keeping those of R.
    fn give(&self, relative: Vector2<f64>, values: &mut [f64]) {
        give(self.leaders, self.reference, relative, values);
    }

    /// ∂(weighted acceleration of B relative to A)/∂e minus `rate`, that of the scheme node by node [1/T²].
    fn beyond(&self, scheme: TimeIntegration, rate: f64) -> Matrix2<f64> {
        let [e, turned] = [self.e[1], perpendicular(self.e[1])];
        let angle = turned.transpose() / e.norm_squared();
        let (m, f) = (1.0 - scheme.coefficients.alpha_m, 1.0 - scheme.coefficients.alpha_f);
        let angular = blend(scheme.coefficients.alpha_m, self.angular[0], self.angular[1]);
        let arm = blended(scheme, self.e);
        let spun = perpendicular(arm) * angle * (m * scheme.dacceleration());
        let turn = Matrix2::new(0.0, -angular, angular, 0.0);
        let pulled_back =
            Matrix2::identity() * self.square(scheme) + arm * angle * (2.0 * self.spin[1] * scheme.dvelocity());
        spun + (turn - pulled_back) * f + (self.excess.1 - Matrix2::identity()) * rate
    }

    /// Adds to the tangent the part of the platen's weighted accelerations beyond `factors`, those of the scheme node by node.
    pub fn stiffen(
        &self,
        model: &Model,
        scheme: TimeIntegration,
        factors: &[f64],
        mass: &SparseMatrix,
        tangent: &mut SparseMatrix,
    ) {
        let [a, b] = self.leaders;
        let rate = factors[2 * b];
        let beyond = self.beyond(scheme, rate);
        let mut rows: BTreeMap<usize, (Matrix2<f64>, f64)> = BTreeMap::new();
        for (node, share) in self.nodes(model) {
            for &row in mass.pattern.neighbours(node) {
                let mass = mass.values[mass.pattern.coupled(row, node).value(0, 0)];
                if mass == 0.0 {
                    continue;
                }
                let (arms, total) = rows.entry(row).or_default();
                *arms += (share - self.reference) * mass;
                *total += if node == a { 0.0 } else { mass };
            }
        }
        for (row, (arms, total)) in rows {
            let along = arms * beyond;
            for (node, sign) in [(a, -1.0), (b, 1.0)] {
                for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    tangent.add(2 * row + i, 2 * node + j, sign * along[(i, j)]);
                    // If a support prescribes A independent of u, the other nodes do not move with it.
                    if node == a && i == j && factors[2 * a + j] == 0.0 {
                        tangent.add(2 * row + i, 2 * node + j, -rate * total);
                    }
                }
            }
        }
    }

    /// Nodes and their G.
    fn nodes<'a>(&'a self, model: &'a Model) -> impl Iterator<Item = (usize, Matrix2<f64>)> + 'a {
        let [a, b] = self.leaders;
        let own = model.linkage.turning().filter(move |follower| follower.leaders[0].0 == a);
        let followers = own.map(|follower| (follower.node, follower.leaders[1].1));
        followers.chain([(a, Matrix2::zeros()), (b, Matrix2::identity())])
    }
}

/// Gives the other nodes of rigid platens the values of A and B; ∂/∂u of the scheme node by node is `rate`.
pub(super) fn spread_turning(model: &Model, rate: f64, u: &[f64], values: &mut [f64]) {
    for follower in model.linkage.turning() {
        for (i, dof) in follower.dofs() {
            values[dof] = follower.value(i, values) + rate * (u[dof] - follower.value(i, u));
        }
    }
}

/// ω and θ̈ of a platen at the start of an increment.
fn turning(model: &Model, leaders: [usize; 2], Trial { old, .. }: Trial) -> (f64, f64) {
    let e: Vector2<f64> = arms(model, leaders, &old.displacement).iter().sum();
    let of = |values: &[f64]| e.perp(&relative(leaders, values)) / e.norm_squared();
    (of(&old.velocity), of(&old.acceleration))
}

/// G_R of a platen.
fn reference(model: &Model, trial: Trial, k: usize) -> Matrix2<f64> {
    let constrained = trial.step.supports.iter().any(|support| support.at.node() == model.linkage.rigid[k][0]);
    if constrained { Matrix2::zeros() } else { model.linkage.centers[k] }
}

/// Displacements of rigid platens at the end of an increment whose accelerations vary linearly up to those found at θ Δt, where
/// the displacement is `ahead`; R and all other nodes are at `u` already.
pub fn turning_at_end(model: &Model, end: Trial, [ahead, found]: [&[f64]; 2], scheme: TimeIntegration, u: &mut [f64]) {
    for (k, &leaders) in model.linkage.rigid.iter().enumerate() {
        let (spin, angular) = turning(model, leaders, end);
        let e: Vector2<f64> = arms(model, leaders, ahead).iter().sum();
        let there = e.perp(&relative(leaders, found)) / e.norm_squared();
        let angle = scheme.increment(spin, angular, angular + (there - angular) / end.step.scheme.theta());
        let [before, way] = arms(model, leaders, &end.old.displacement);
        let turn = nalgebra::Rotation2::new(angle);
        give(leaders, reference(model, end, k), turn * (before + way) - before, u);
    }
    model.linkage.spread(u);
}

/// Weighted mean: `weight` times the old value plus the rest of the new one.
pub(super) fn blend(weight: f64, old: f64, new: f64) -> f64 {
    weight * old + (1.0 - weight) * new
}
