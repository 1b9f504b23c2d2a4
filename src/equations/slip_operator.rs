//! Slip operator: tractions on an interface as a function of displacement jumps, everything else being linear and without
//! inertia.
//!
//! For two matching nodes, one on each side, the jump j is the motion of the slave relative to the master; the motion of the
//! master, and that of all other nodes of S, is m. With A condensed on the nodes at contacts ([`super::condensed`]) and ρ the
//! residual forces of the loads,
//!
//! ```text
//! S_mm m + S_mj j + ρ_m = 0                    equal and opposite on both sides: no contact force here                  (1)
//! S_jm m + S_jj j + ρ_j = ℓ y,                 y = (p, −τ) by the point's (n, s), its length ℓ                       (2)
//! K j + ρ̂ = ℓ y,   K = S_jj − S_jm S_mm⁻¹ S_mj                                                                       (3)
//! j = (0, s) − y/α                             s: slip; the contact's springs (α_n, α_t) are in series                 (4)
//! y = (ℓ + K/α)⁻¹ (K_s s + ρ̂)                                                                                        (5)
//! ```
//! All quantities are increments. One product with the matrix of (5) gives the tractions of a slip; on a rigid master j is the
//! motion of the slave itself.

use std::sync::Arc;

use nalgebra::Vector2;
use rayon::prelude::*;

use super::condensed::ContactNodes;
use super::sums::TrialFailure;
use super::trial::Trial;
use super::{Assembler, Coupling};
use crate::contact::pair::ContactPair;
use crate::linear::system::{Request, System};
use crate::linear::{Condensation, Condensed, DenseLu, LinearFailure};
use crate::model::Model;

/// A contact point with matching nodes.
struct Facing {
    /// Index of the slave node and of the master node
    slave: usize,
    master: Option<usize>,
    /// n and s
    directions: [Vector2<f64>; 2],
    /// 1/α_n and 1/α_t [L³/F]
    compliance: [f64; 2],
}

/// Response of linear bodies to slip on an interface.
pub struct SlipOperator {
    /// The bodies, assembled without contact
    pub bodies: Assembler,
    /// their equations
    pub system: System,
    nodes: ContactNodes,
    points: Vec<Facing>,
    condensed: Condensed,
    /// Index in m of every contact node; `None` for a slave on a rigid master
    moving: Vec<Option<usize>>,
    middles: usize,
    /// S_mm
    middle: DenseLu,
    /// S_mm⁻¹ S_mj and S_jm, column by column
    following: Vec<f64>,
    pulling: Vec<f64>,
    /// ℓ + K/α
    series: DenseLu,
    /// y by s, row by row
    by_slip: Vec<f64>,
}

/// Effect of residual forces without slip.
pub struct Shift {
    /// y: all p, then all −τ [F/L²]
    pub tractions: Vec<f64>,
    /// u of all nodes [L]
    pub displacement: Vec<f64>,
}

/// Reason why the slip operator does not exist.
#[derive(Clone, Debug, PartialEq)]
pub enum NoSlipOperator {
    /// The bodies could not be assembled.
    Assembly(TrialFailure),
    /// A matrix is singular.
    Linear(LinearFailure),
}

impl From<TrialFailure> for NoSlipOperator {
    fn from(failure: TrialFailure) -> Self {
        Self::Assembly(failure)
    }
}

impl From<LinearFailure> for NoSlipOperator {
    fn from(failure: LinearFailure) -> Self {
        Self::Linear(failure)
    }
}

impl SlipOperator {
    /// Computes the slip operator of a model with small sliding and matching nodes, under the supports and springs of a trial's
    /// step.
    ///
    /// # Errors
    /// Returns [`NoSlipOperator`] if the bodies cannot be assembled or are not constrained.
    pub fn new(model: &Arc<Model>, trial: Trial) -> Result<Self, NoSlipOperator> {
        let nodes = ContactNodes::of_both_sides(model);
        let mut bodies = Assembler::new(model);
        bodies.couple(&Arc::new(Coupling::of(nodes.nodes.clone())));
        let mut system = bodies.system();
        let mut condensation = Condensation::new(system.tangent.pattern.clone(), &nodes.nodes)?;
        bodies.assemble(trial, &vec![0.0; model.dofs()], &[], Request::Tangent, &mut system)?;
        let held = || LinearFailure::Singular("a body is constrained only by contact, or not at all".into());
        let condensed = condensation.condense(&system.tangent).ok_or_else(held)?;
        let points: Vec<Facing> = model.contacts.iter().flat_map(|pair| facing(model, pair, &nodes)).collect();
        let mut moving: Vec<Option<usize>> = vec![None; nodes.nodes.len()];
        let slaves: Vec<usize> = points.iter().map(|point| point.slave).collect();
        let others: Vec<usize> = (0..moving.len()).filter(|place| !slaves.contains(place)).collect();
        others.iter().enumerate().for_each(|(m, &place)| moving[place] = Some(m));
        points.iter().for_each(|point| moving[point.slave] = point.master.and_then(|master| moving[master]));
        let mut jumps = Self {
            bodies,
            system,
            nodes,
            points,
            condensed,
            moving,
            middles: others.len(),
            middle: DenseLu::default(),
            following: Vec::new(),
            pulling: Vec::new(),
            series: DenseLu::default(),
            by_slip: Vec::new(),
        };
        jumps.condense(&lengths(model))?;
        Ok(jumps)
    }

    /// Number of contact points.
    pub fn count(&self) -> usize {
        self.points.len()
    }

    /// y by s, one row per component: all p, then all −τ.
    pub fn by_slip(&self) -> &[f64] {
        &self.by_slip
    }

    /// Condenses the bodies on the contact points, equations (3) and (5).
    fn condense(&mut self, lengths: &[f64]) -> Result<(), LinearFailure> {
        let (n, m) = (2 * self.points.len(), 2 * self.middles);
        let jumping: Vec<Vec<f64>> = (0..n).into_par_iter().map(|j| self.gather(&self.column_of_jump(j))).collect();
        let middle: Vec<Vec<f64>> = (0..m).into_par_iter().map(|c| self.gather(&self.column_of_middle(c))).collect();
        self.middle.factorize_columns(m, middle.iter().flat_map(|column| &column[..m]).copied().collect())?;
        self.pulling = middle.iter().flat_map(|column| &column[m..]).copied().collect();
        drop(middle);
        self.following = jumping.iter().flat_map(|column| &column[..m]).copied().collect();
        self.middle.solve_columns(&mut self.following);
        let (following, pulling) = (&self.following, &self.pulling);
        let condense = |(j, mut column): (usize, Vec<f64>)| {
            let mut own = column.split_off(m);
            let follows = following.get(j * m..(j + 1) * m).unwrap_or_default();
            for (x, pull) in follows.iter().zip(pulling.chunks_exact(n.max(1))) {
                own.iter_mut().zip(pull).for_each(|(k, pull)| *k -= x * pull);
            }
            own
        };
        let stiffness: Vec<Vec<f64>> = jumping.into_par_iter().enumerate().map(condense).collect();
        let mut series: Vec<f64> = Vec::with_capacity(n * n);
        for (j, column) in stiffness.iter().enumerate() {
            let compliance = self.compliance(j);
            series.extend(column.iter().map(|k| k * compliance));
            series[j * n + j] += lengths[j % (n / 2)];
        }
        self.series.factorize_columns(n, series)?;
        let mut columns: Vec<f64> = stiffness[n / 2..].concat();
        self.series.solve_columns(&mut columns);
        self.by_slip = (0..n).flat_map(|row| columns[row..].iter().step_by(n)).copied().collect();
        Ok(())
    }

    /// 1/α of a component of the jumps: all normal ones, then all tangential ones.
    fn compliance(&self, j: usize) -> f64 {
        self.points[j % self.points.len()].compliance[j / self.points.len()]
    }

    /// Forces on all contact nodes by a unit jump.
    fn column_of_jump(&self, j: usize) -> Vec<f64> {
        let Facing { slave, directions, .. } = &self.points[j % self.points.len()];
        let direction = directions[j / self.points.len()];
        let [x, y] = [0, 1].map(|i| self.column(2 * slave + i));
        x.iter().zip(y).map(|(x, y)| x * direction.x + y * direction.y).collect()
    }

    /// Forces on all contact nodes by a unit m.
    fn column_of_middle(&self, c: usize) -> Vec<f64> {
        let mut sum = vec![0.0; 2 * self.nodes.nodes.len()];
        for place in (0..self.moving.len()).filter(|&place| self.moving[place] == Some(c / 2)) {
            sum.iter_mut().zip(self.column(2 * place + c % 2)).for_each(|(sum, s)| *sum += s);
        }
        sum
    }

    fn column(&self, dof: usize) -> &[f64] {
        let size = 2 * self.nodes.nodes.len();
        &self.condensed.stiffness[dof * size..(dof + 1) * size]
    }

    /// Forces on m and on the jumps from those on the contact nodes.
    fn gather(&self, forces: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; 2 * self.middles];
        for (place, m) in self.moving.iter().enumerate() {
            if let Some(m) = m {
                (0..2).for_each(|i| sums[2 * m + i] += forces[2 * place + i]);
            }
        }
        for i in 0..2 {
            let along = |point: &Facing| {
                let [x, y] = [0, 1].map(|i| forces[2 * point.slave + i]);
                x * point.directions[i].x + y * point.directions[i].y
            };
            sums.extend(self.points.iter().map(along));
        }
        sums
    }

    /// Effect of residual forces without slip; `residual` is A u − b of all equations.
    pub fn shift(&mut self, residual: &[f64]) -> Shift {
        let forwarded = self.condensed.forward(residual);
        let mut middles = self.gather(&forwarded.right);
        let mut tractions = middles.split_off(2 * self.middles);
        self.middle.solve_columns(&mut middles);
        for (w, pull) in middles.iter().zip(self.pulling.chunks_exact(tractions.len().max(1))) {
            tractions.iter_mut().zip(pull).for_each(|(rho, pull)| *rho -= w * pull);
        }
        self.series.solve_columns(&mut tractions);
        let jumps: Vec<f64> = tractions.iter().enumerate().map(|(j, y)| -y * self.compliance(j)).collect();
        middles.iter_mut().for_each(|w| *w = -*w);
        self.follow(&jumps, &mut middles);
        let displacement = self.recover(&forwarded, &jumps, &middles);
        Shift { tractions, displacement }
    }

    /// The jumps of (4) from slip and tractions.
    pub fn jumps(&self, slip: &[f64], tractions: &[f64]) -> Vec<f64> {
        let n = slip.len();
        let jump = |(j, y): (usize, &f64)| if j < n { 0.0 } else { slip[j - n] } - y * self.compliance(j);
        tractions.iter().enumerate().map(jump).collect()
    }

    /// u of all nodes for given jumps, without other forces.
    pub fn displacement(&self, jumps: &[f64]) -> Vec<f64> {
        let mut middles = vec![0.0; 2 * self.middles];
        self.follow(jumps, &mut middles);
        let nothing = self.condensed.forward(&vec![0.0; 2 * self.bodies.model().mesh.nodes.len()]);
        self.recover(&nothing, jumps, &middles)
    }

    /// m −= S_mm⁻¹ S_mj j.
    fn follow(&self, jumps: &[f64], middles: &mut [f64]) {
        for (j, column) in jumps.iter().zip(self.following.chunks_exact(middles.len().max(1))) {
            middles.iter_mut().zip(column).for_each(|(m, x)| *m -= j * x);
        }
    }

    /// Back substitution of A u = −r: u of all nodes from the jumps and m.
    fn recover(&self, forwarded: &crate::linear::Forwarded, jumps: &[f64], middles: &[f64]) -> Vec<f64> {
        let n = self.points.len();
        let mut kept = vec![0.0; 2 * self.nodes.nodes.len()];
        for (place, m) in self.moving.iter().enumerate() {
            if let Some(m) = m {
                (0..2).for_each(|i| kept[2 * place + i] = -middles[2 * m + i]);
            }
        }
        for (k, point) in self.points.iter().enumerate() {
            let jump = point.directions[0] * jumps[k] + point.directions[1] * jumps[n + k];
            (0..2).for_each(|i| kept[2 * point.slave + i] -= jump[i]);
        }
        let mut u = self.condensed.backward(forwarded, &kept);
        u.iter_mut().for_each(|u| *u = -*u);
        u
    }
}

/// Points of a pair with matching nodes, as checked when the model is built.
fn facing(model: &Model, pair: &ContactPair, nodes: &ContactNodes) -> Vec<Facing> {
    let inverse = |alpha: f64| if alpha > 0.0 { 1.0 / alpha } else { 0.0 };
    let place = |node: usize| nodes.place(model.ties.original(node)).expect("nodes at contacts are kept");
    let points = pair.points.iter().zip(pair.small.iter().flat_map(|small| small.points.iter().flatten()));
    let of = |(slave, point): (_, &crate::contact::small_sliding::SmallPoint)| {
        let (own, master) = point.facing().expect("nodes face nodes");
        Facing {
            slave: place(own),
            master: master.map(place),
            directions: [point.normal, point.tangent],
            compliance: [inverse(pair.alpha_n), inverse(pair.law(slave).description.stiffness)],
        }
    };
    points.map(of).collect()
}

/// ℓ of all points.
fn lengths(model: &Model) -> Vec<f64> {
    let small = model.contacts.iter().filter_map(|pair| pair.small.as_ref());
    small.flat_map(|small| small.points.iter().flatten()).map(|point| point.length).collect()
}
