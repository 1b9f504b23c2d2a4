//! Rigid plates in motion: velocities and accelerations of their nodes, and what they add to the tangent of inertia.
//!
//! ```text
//! x_c = x_R + (G_c − G_R) e                     R: the center of mass, or the node A if a support holds it
//! v_c = v_R + (G_c − G_R) ω J e                 u_R and the angle of e follow the scheme
//! a_c = a_R + (G_c − G_R) (θ̈ J e − ω² e)
//! weighted:   θ̈_m J e_f − (ω²)_f e_f            _m, _f: weighted with α_m and α_f, as masses and forces are
//! ```
//!
//! Were the scheme that of the nodes one by one, the pull that keeps their distance would ring from increment to increment
//! (Cardona & Géradin 1989, Comput. Struct. 33, 801). With R where the masses balance, momentum is that of the forces. While |e|
//! is not L yet, what is missing moves by the scheme, so that a tangent that takes the nodes one by one lacks terms of ω Δt alone.

use std::collections::BTreeMap;

use nalgebra::{Matrix2, Vector2};

use super::links::{arms, blended, give, perpendicular, relative};
use super::trial::Trial;
use crate::linear::SparseMatrix;
use crate::model::Model;
use crate::model::scheme::Coefficients;

/// One rigid plate in an increment.
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
    /// What |e| is too long, as a vector, and ∂/∂e of it [L]
    excess: (Vector2<f64>, Matrix2<f64>),
}

impl Turning {
    /// All plates in the increment to the displacement `u`.
    pub fn all(model: &Model, trial: Trial, u: &[f64], scheme: Coefficients) -> Vec<Self> {
        (0..model.linkage.rigid.len()).map(|k| Self::of(model, trial, u, scheme, k)).collect()
    }

    fn of(model: &Model, trial: Trial, u: &[f64], scheme: Coefficients, k: usize) -> Self {
        let leaders = model.linkage.rigid[k];
        let e: [Vector2<f64>; 2] = [&trial.old.displacement, u].map(|u| arms(model, leaders, u).iter().sum());
        let (spin, angular) = turning(model, leaders, trial);
        let way = relative(leaders, u) - relative(leaders, &trial.old.displacement);
        let angle = e[0].perp(&way).atan2(e[0].norm_squared() + e[0].dot(&way));
        let end = scheme.rates(angle, (spin, angular), trial.dt);
        let [before, way] = arms(model, leaders, u);
        let square = before.norm_squared();
        let stretch = way.dot(&(2.0 * before + way)) / (2.0 * square);
        let excess = (e[1] * stretch, e[1] * e[1].transpose() / square + Matrix2::identity() * stretch);
        let reference = reference(model, trial, k);
        Self { leaders, reference, e, spin: [spin, end.0], angular: [angular, end.1], excess }
    }

    /// Velocities from those of the scheme node by node, of which ∂v/∂u is `rate`.
    pub fn velocities(&self, rate: f64, values: &mut [f64]) {
        self.give(perpendicular(self.e[1]) * self.spin[1] + self.excess.0 * rate, values);
    }

    /// The same of accelerations.
    pub fn accelerations(&self, rate: f64, values: &mut [f64]) {
        let centripetal = self.e[1] * self.spin[1].powi(2);
        self.give(perpendicular(self.e[1]) * self.angular[1] - centripetal + self.excess.0 * rate, values);
    }

    /// The same of weighted accelerations.
    pub fn weighted(&self, scheme: Coefficients, rate: f64, values: &mut [f64]) {
        let angular = blend(scheme.alpha_m, self.angular[0], self.angular[1]);
        let arm = blended(scheme, self.e);
        self.give(perpendicular(arm) * angular - arm * self.square(scheme) + self.excess.0 * rate, values);
    }

    /// (ω²)_f
    fn square(&self, scheme: Coefficients) -> f64 {
        blend(scheme.alpha_f, self.spin[0].powi(2), self.spin[1].powi(2))
    }

    /// Make what B has against A `relative`, and leave R what it has.
    fn give(&self, relative: Vector2<f64>, values: &mut [f64]) {
        give(self.leaders, self.reference, relative, values);
    }

    /// ∂(weighted acceleration of B against A)/∂e less `rate`, that of the scheme node by node [1/T²].
    fn beyond(&self, scheme: Coefficients, rate: f64, dt: f64) -> Matrix2<f64> {
        let [e, turned] = [self.e[1], perpendicular(self.e[1])];
        let angle = turned.transpose() / e.norm_squared();
        let (m, f) = (1.0 - scheme.alpha_m, 1.0 - scheme.alpha_f);
        let angular = blend(scheme.alpha_m, self.angular[0], self.angular[1]);
        let arm = blended(scheme, self.e);
        let spun = perpendicular(arm) * angle * (m * scheme.dacceleration(dt));
        let turn = Matrix2::new(0.0, -angular, angular, 0.0);
        let pulled =
            Matrix2::identity() * self.square(scheme) + arm * angle * (2.0 * self.spin[1] * scheme.dvelocity(dt));
        spun + (turn - pulled) * f + (self.excess.1 - Matrix2::identity()) * rate
    }

    /// Add to the tangent what the weighted accelerations of the plate have beyond `factors`, those of the nodes one by one.
    pub fn stiffen(
        &self,
        model: &Model,
        (scheme, dt): (Coefficients, f64),
        factors: &[f64],
        mass: &SparseMatrix,
        tangent: &mut SparseMatrix,
    ) {
        let [a, b] = self.leaders;
        let rate = factors[2 * b];
        let beyond = self.beyond(scheme, rate, dt);
        let mut rows: BTreeMap<usize, (Matrix2<f64>, f64)> = BTreeMap::new();
        for (node, share) in self.nodes(model) {
            for &row in mass.pattern.neighbours(node) {
                let Some(block) = mass.pattern.block(row, node) else { continue };
                let (arms, total) = rows.entry(row).or_default();
                let mass = mass.values[block.value(0, 0)];
                *arms += (share - self.reference) * mass;
                *total += if node == a { 0.0 } else { mass };
            }
        }
        for (row, (arms, total)) in rows {
            let along = arms * beyond;
            for (node, sign) in [(a, -1.0), (b, 1.0)] {
                let Some(block) = tangent.pattern.block(row, node) else { continue };
                for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    tangent.values[block.value(i, j)] += sign * along[(i, j)];
                    // A support says how A moves, whatever u is there: the others do not move with it.
                    if node == a && i == j && factors[2 * a + j] == 0.0 {
                        tangent.values[block.value(i, j)] -= rate * total;
                    }
                }
            }
        }
    }

    /// Its nodes and their G.
    fn nodes<'a>(&'a self, model: &'a Model) -> impl Iterator<Item = (usize, Matrix2<f64>)> + 'a {
        let [a, b] = self.leaders;
        let own = model.linkage.turning().filter(move |follower| follower.leaders[0].0 == a);
        let followers = own.map(|follower| (follower.node, follower.leaders[1].1));
        followers.chain([(a, Matrix2::zeros()), (b, Matrix2::identity())])
    }
}

/// Give the other nodes of rigid plates what A and B have; ∂/∂u of the scheme node by node is `rate`.
pub(super) fn spread(model: &Model, rate: f64, u: &[f64], values: &mut [f64]) {
    for follower in model.linkage.turning() {
        for (i, dof) in follower.dofs() {
            values[dof] = follower.led(i, values) + rate * (u[dof] - follower.led(i, u));
        }
    }
}

/// ω and θ̈ of a plate at the start of an increment.
fn turning(model: &Model, leaders: [usize; 2], Trial { old, .. }: Trial) -> (f64, f64) {
    let e: Vector2<f64> = arms(model, leaders, &old.displacement).iter().sum();
    let of = |values: &[f64]| e.perp(&relative(leaders, values)) / e.norm_squared();
    (of(&old.velocity), of(&old.acceleration))
}

/// G_R of a plate.
fn reference(model: &Model, trial: Trial, k: usize) -> Matrix2<f64> {
    let held = trial.step.supports.iter().any(|support| support.at.node() == model.linkage.rigid[k][0]);
    if held { Matrix2::zeros() } else { model.linkage.centers[k] }
}

/// Displacements of rigid plates at the end of an increment whose accelerations go evenly to those found at θ Δt, where the
/// displacement is `ahead`; R and all others are at `u` already.
pub fn reach_end(model: &Model, end: Trial, [ahead, found]: [&[f64]; 2], scheme: Coefficients, u: &mut [f64]) {
    for (k, &leaders) in model.linkage.rigid.iter().enumerate() {
        let (spin, angular) = turning(model, leaders, end);
        let e: Vector2<f64> = arms(model, leaders, ahead).iter().sum();
        let there = e.perp(&relative(leaders, found)) / e.norm_squared();
        let angle = scheme.increment((spin, angular), angular + (there - angular) / end.step.scheme.theta(), end.dt);
        let [before, way] = arms(model, leaders, &end.old.displacement);
        let turn = nalgebra::Rotation2::new(angle);
        give(leaders, reference(model, end, k), turn * (before + way) - before, u);
    }
    model.linkage.spread(u);
}

fn blend(weight: f64, old: f64, new: f64) -> f64 {
    weight * old + (1.0 - weight) * new
}
