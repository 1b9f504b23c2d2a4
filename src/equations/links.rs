//! Nodes that follow others ([`crate::model::linkage`]): their equations, and those of rigid plates.
//!
//! ```text
//! w (u_c − Σ G_k u_k) = 0                  a follower; its forces are with its leaders
//! r_A + r_B = 0,   (J e)·r_B/L = 0         a rigid plate: forces, and moments about A
//! w (|e|² − L²)/(2 L) = 0                  its length
//! ```
//! In motion r has the inertia ([`super::turning`]), and e in the moments is weighted with α_f, as the forces are.

use std::borrow::Cow;

use nalgebra::{Matrix2, Matrix4, Vector2};

use super::trial::Trial;
use crate::linear::SparseMatrix;
use crate::linear::system::System;
use crate::model::Model;
use crate::model::scheme::Coefficients;
use crate::model::state::State;

/// e of a rigid plate at the start, and what has come to it at the displacements `u`.
pub(super) fn arms(model: &Model, [a, b]: [usize; 2], u: &[f64]) -> [Vector2<f64>; 2] {
    [model.mesh.nodes[b] - model.mesh.nodes[a], relative([a, b], u)]
}

/// What B has against A.
pub fn relative([a, b]: [usize; 2], values: &[f64]) -> Vector2<f64> {
    Vector2::new(values[2 * b] - values[2 * a], values[2 * b + 1] - values[2 * a + 1])
}

/// J e
pub fn perpendicular(e: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-e.y, e.x)
}

/// Weighted with α_f.
pub(super) fn blended(scheme: Coefficients, [before, after]: [Vector2<f64>; 2]) -> Vector2<f64> {
    before * scheme.alpha_f + after * (1.0 - scheme.alpha_f)
}

/// Make what B has against A `along`, where R with its G stays.
pub fn give([a, b]: [usize; 2], reference: Matrix2<f64>, along: Vector2<f64>, values: &mut [f64]) {
    let shift = reference * (relative([a, b], values) - along);
    for i in 0..2 {
        values[2 * a + i] += shift[i];
        values[2 * b + i] = values[2 * a + i] + along[i];
    }
}

/// e and L.
fn arm(model: &Model, plate: [usize; 2], u: &[f64]) -> (Vector2<f64>, f64) {
    let [before, way] = arms(model, plate, u);
    (before + way, before.norm())
}

/// (|e|² − L²)/(2 L), to the last digit of small motions.
fn stretch(model: &Model, plate: [usize; 2], u: &[f64]) -> f64 {
    let [before, way] = arms(model, plate, u);
    way.dot(&(2.0 * before + way)) / (2.0 * before.norm())
}

/// The force on B, and against it on A, of a moment M on a rigid plate, f = M J e/|e|²; and ∂F/∂u of both, F taking it away.
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

/// How far followers are from where their leaders are, and rigid plates from their length: the most, and the largest motion [L].
pub(super) fn missed(model: &Model, u: &[f64]) -> [f64; 2] {
    let (mut missed, mut place) = (0.0f64, 0.0f64);
    for follower in &model.linkage.followers {
        for (i, dof) in follower.dofs() {
            missed = missed.max((u[dof] - follower.led(i, u)).abs());
            place = place.max(u[dof].abs());
        }
    }
    for plate in &model.linkage.rigid {
        missed = missed.max(stretch(model, *plate, u).abs());
        place = plate.iter().fold(place, |most, node| most.max(u[2 * node].abs()).max(u[2 * node + 1].abs()));
    }
    [missed, place]
}

/// Forces without what keeps the length of rigid plates, which is with A instead of B: it is no force out of balance.
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

/// Before supports replace equations: those of leaders sum up what their followers have.
pub fn gather_rows(model: &Model, matrix: &mut SparseMatrix) {
    for follower in &model.linkage.followers {
        for (i, _) in follower.dofs() {
            for (leader, g) in &follower.leaders {
                for j in (0..2).filter(|&j| g[(i, j)] != 0.0) {
                    matrix.add_row((follower.node, i), (*leader, j), g[(i, j)]);
                }
            }
        }
    }
    for &[a, b] in &model.linkage.rigid {
        (0..2).for_each(|i| matrix.add_row((b, i), (a, i), 1.0));
    }
}

/// The residual of the same: rigid plates balance their forces at A.
pub fn gather_residual(model: &Model, residual: &mut [f64]) {
    for &[a, b] in &model.linkage.rigid {
        (0..2).for_each(|i| residual[2 * a + i] += residual[2 * b + i]);
    }
}

/// The equations of followers, and of B of rigid plates, whose forces `r_B` were in the residual.
pub(super) fn prescribe(model: &Model, weight: f64, trial: Trial, u: &[f64], tangent: bool, system: &mut System) {
    for follower in &model.linkage.followers {
        for (i, dof) in follower.dofs() {
            system.residual[dof] = weight * (u[dof] - follower.led(i, u));
        }
    }
    for &[a, b] in &model.linkage.rigid {
        let (e, length) = arm(model, [a, b], u);
        let before = arm(model, [a, b], &trial.old.displacement).0;
        let scheme = trial.step.scheme.coefficients();
        let lever = scheme.map_or(e, |scheme| blended(scheme, [before, e]));
        let force = Vector2::new(system.residual[2 * b], system.residual[2 * b + 1]);
        system.residual[2 * b] = lever.perp(&force) / length;
        system.residual[2 * b + 1] = weight * stretch(model, [a, b], u);
        if tangent {
            keep_length(model, [a, b], [e, lever], weight, &mut system.tangent);
            let share = scheme.map_or(1.0, |scheme| 1.0 - scheme.alpha_f);
            let turned = Vector2::new(force.y, -force.x) * (share / length);
            let matrix = &mut system.tangent;
            for (node, sign) in [(a, -1.0), (b, 1.0)] {
                let block = matrix.pattern.block(b, node).expect("the pattern couples both leaders");
                (0..2).for_each(|j| matrix.values[block.value(0, j)] += sign * turned[j]);
            }
        }
    }
    if tangent {
        follow(model, weight, &mut system.tangent);
    }
}

/// Replace the equations of B by the moment of what they are, and by w e·(x_B − x_A)/L.
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
        let block = matrix.pattern.block(b, node).expect("the pattern couples both leaders");
        (0..2).for_each(|j| matrix.values[block.value(1, j)] = sign * own[j]);
    }
}

/// The equations of accelerations in a state, `weight` being a mass: e·(a_B − a_A) = −ω² L², and moments balance.
pub fn begin(model: &Model, weight: f64, state: &State, matrix: &mut SparseMatrix, right: &mut [f64]) {
    for &[a, b] in &model.linkage.rigid {
        let (e, length) = arm(model, [a, b], &state.displacement);
        let spin = e.perp(&relative([a, b], &state.velocity)) / e.norm_squared();
        right[2 * b] = e.perp(&Vector2::new(right[2 * b], right[2 * b + 1])) / length;
        right[2 * b + 1] = -weight * spin * spin * e.norm_squared() / length;
        keep_length(model, [a, b], [e, e], weight, matrix);
    }
    follow(model, weight, matrix);
}

/// Make velocities those of rigid plates: A and what turns B about it stay.
pub fn stiffen_velocities(model: &Model, u: &[f64], velocity: &mut [f64]) {
    for &[a, b] in &model.linkage.rigid {
        let e = arm(model, [a, b], u).0;
        let spin = e.perp(&relative([a, b], velocity)) / e.norm_squared();
        let turned = perpendicular(e) * spin;
        (0..2).for_each(|i| velocity[2 * b + i] = velocity[2 * a + i] + turned[i]);
    }
    model.linkage.spread(velocity);
}

/// Replace the equations of followers by w (x_c − Σ G_k x_k) = 0.
fn follow(model: &Model, weight: f64, matrix: &mut SparseMatrix) {
    for follower in &model.linkage.followers {
        for (i, dof) in follower.dofs() {
            matrix.replace_row(dof, weight);
            for (leader, g) in &follower.leaders {
                let block = matrix.pattern.block(follower.node, *leader).expect("the pattern couples followers");
                (0..2).for_each(|j| matrix.values[block.value(i, j)] -= weight * g[(i, j)]);
            }
        }
    }
}
