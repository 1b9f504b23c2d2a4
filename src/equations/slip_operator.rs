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
//!
//! # Fluids
//!
//! The pressure p_w of a fluid acts on both sides in addition to p, and y stands for the effective tractions:
//!
//! ```text
//! K j + ρ̂ = ℓ (y + (p_w, 0))     y = (ℓ + K/α)⁻¹ (K_s s + ρ̂ − ℓ (p_w, 0))                                     (6)
//! ```
//!
//! The ends of a contact that periodic sides join are one node of one jump, with the length of both: a site. Slip and p_w of a site are the
//! means of its points, and its tractions are those of each of them.

use std::collections::BTreeMap;
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

/// A site: contact points with the same matching nodes, a single one but where periodic sides meet.
struct Facing {
    /// Index of the slave node and of the master node
    slave: usize,
    master: Option<usize>,
    /// n and s
    directions: [Vector2<f64>; 2],
    /// 1/α_n and 1/α_t [L³/F]
    compliance: [f64; 2],
    /// ℓ [L]
    length: f64,
}

/// Response of linear bodies to slip on an interface.
pub struct SlipOperator {
    /// The bodies, assembled without contact
    pub bodies: Assembler,
    /// their equations
    pub system: System,
    nodes: ContactNodes,
    sites: Vec<Facing>,
    points: Vec<AtSite>,
    condensed: Condensed,
    /// Index in m of every contact node; `None` for a slave on a rigid master
    moving: Vec<Option<usize>>,
    middles: usize,
    /// S_mm
    middle: DenseLu,
    /// S_mm⁻¹ S_mj and S_jm, column by column
    middle_by_jump: Vec<f64>,
    middle_columns: Vec<f64>,
    /// ℓ + K/α
    series: DenseLu,
    /// y by s, row by row, of all contact points
    by_slip: Vec<f64>,
    /// y by p_w, row by row; empty without a fluid
    by_fluid: Vec<f64>,
}

/// What the slip s of an interface is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slips {
    /// Slip of the slider; the springs α_t are in series with the bodies
    Plastic,
    /// All relative motion; the springs belong to the laws
    All,
}

/// Place of a contact point among the sites.
struct AtSite {
    /// its number
    site: usize,
    /// Its part of the length of the site [-]
    share: f64,
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

conversions! {
    TrialFailure => NoSlipOperator: |failure| Self::Assembly(failure);
    LinearFailure => NoSlipOperator: |failure| Self::Linear(failure);
}

impl SlipOperator {
    /// Computes the slip operator of a model with small sliding and matching nodes, under the supports and springs of a trial's
    /// step.
    ///
    /// # Errors
    /// Returns [`NoSlipOperator`] if the bodies cannot be assembled or are not constrained.
    pub fn new(model: &Arc<Model>, trial: Trial, slips: Slips) -> Result<Self, NoSlipOperator> {
        let nodes = ContactNodes::of_both_sides(model);
        let mut bodies = Assembler::new(model);
        bodies.couple(&Arc::new(Coupling::of(nodes.nodes.clone())));
        let mut system = bodies.system();
        let mut condensation = Condensation::new(system.tangent.pattern.clone(), &nodes.nodes)?;
        bodies.assemble(trial, &vec![0.0; model.dofs()], &[], Request::Tangent, &mut system)?;
        let unconstrained = || LinearFailure::Singular("a body is constrained only by contact, or not at all".into());
        let condensed = condensation.condense(&system.tangent).ok_or_else(unconstrained)?;
        let (sites, points) = gathered(model.contacts.iter().flat_map(|pair| facing(model, pair, &nodes, slips)));
        let mut moving: Vec<Option<usize>> = vec![None; nodes.nodes.len()];
        let slaves: Vec<usize> = sites.iter().map(|site| site.slave).collect();
        let others: Vec<usize> = (0..moving.len()).filter(|place| !slaves.contains(place)).collect();
        others.iter().enumerate().for_each(|(m, &place)| moving[place] = Some(m));
        sites.iter().for_each(|site| moving[site.slave] = site.master.and_then(|master| moving[master]));
        let mut jumps = Self {
            bodies,
            system,
            nodes,
            sites,
            points,
            condensed,
            moving,
            middles: others.len(),
            middle: DenseLu::default(),
            middle_by_jump: Vec::new(),
            middle_columns: Vec::new(),
            series: DenseLu::default(),
            by_slip: Vec::new(),
            by_fluid: Vec::new(),
        };
        jumps.condense()?;
        if model.contacts.iter().any(|pair| pair.fluid.is_some()) {
            jumps.by_fluid = jumps.under_fluid();
        }
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

    /// y by p_w, one row per component: all p, then all −τ; empty without a fluid.
    pub fn by_fluid(&self) -> &[f64] {
        &self.by_fluid
    }

    /// Condenses the bodies on the sites, equations (3) and (5).
    fn condense(&mut self) -> Result<(), LinearFailure> {
        let (n, m) = (2 * self.sites.len(), 2 * self.middles);
        let jumping: Vec<Vec<f64>> = (0..n).into_par_iter().map(|j| self.gather(&self.column_of_jump(j))).collect();
        let middle: Vec<Vec<f64>> = (0..m).into_par_iter().map(|c| self.gather(&self.column_of_middle(c))).collect();
        self.middle.factorize_columns(m, middle.iter().flat_map(|column| &column[..m]).copied().collect())?;
        self.middle_columns = middle.iter().flat_map(|column| &column[m..]).copied().collect();
        drop(middle);
        self.middle_by_jump = jumping.iter().flat_map(|column| &column[..m]).copied().collect();
        self.middle.solve_columns(&mut self.middle_by_jump);
        let (middle_by_jump, middle_columns) = (&self.middle_by_jump, &self.middle_columns);
        let condense = |(j, mut column): (usize, Vec<f64>)| {
            let mut own = column.split_off(m);
            let follows = middle_by_jump.get(j * m..(j + 1) * m).unwrap_or_default();
            for (x, column) in follows.iter().zip(middle_columns.chunks_exact(n.max(1))) {
                own.iter_mut().zip(column).for_each(|(k, middle)| *k -= x * middle);
            }
            own
        };
        let stiffness: Vec<Vec<f64>> = jumping.into_par_iter().enumerate().map(condense).collect();
        let mut series: Vec<f64> = Vec::with_capacity(n * n);
        for (j, column) in stiffness.iter().enumerate() {
            let compliance = self.compliance(j);
            series.extend(column.iter().map(|k| k * compliance));
            series[j * n + j] += self.sites[j % (n / 2)].length;
        }
        self.series.factorize_columns(n, series)?;
        let mut columns: Vec<f64> = stiffness[n / 2..].concat();
        self.series.solve_columns(&mut columns);
        self.by_slip = self.of_points(&columns);
        Ok(())
    }

    /// y of all points by their p_w, equation (6).
    fn under_fluid(&self) -> Vec<f64> {
        let sites = self.sites.len();
        let mut columns = vec![0.0; 2 * sites * sites];
        self.sites.iter().enumerate().for_each(|(k, site)| columns[2 * sites * k + k] = -site.length);
        self.series.solve_columns(&mut columns);
        self.of_points(&columns)
    }

    /// A matrix of the points, row by row, from the one of the sites with two rows per site, column by column.
    fn of_points(&self, columns: &[f64]) -> Vec<f64> {
        let rows = 2 * self.sites.len();
        let row = |row: usize| self.points.iter().map(move |of| of.share * columns[rows * of.site + row]);
        self.components().flat_map(row).collect()
    }

    /// Component of a site for every component of a point: all normal ones, then all tangential ones.
    fn components(&self) -> impl Iterator<Item = usize> + '_ {
        let sites = self.sites.len();
        [0, sites].into_iter().flat_map(move |first| self.points.iter().map(move |point| first + point.site))
    }

    /// 1/α of a component of the jumps of sites: all normal ones, then all tangential ones.
    fn compliance(&self, j: usize) -> f64 {
        self.sites[j % self.sites.len()].compliance[j / self.sites.len()]
    }

    /// Forces on all contact nodes by a unit jump.
    fn column_of_jump(&self, j: usize) -> Vec<f64> {
        let Facing { slave, directions, .. } = &self.sites[j % self.sites.len()];
        let direction = directions[j / self.sites.len()];
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
            sums.extend(self.sites.iter().map(along));
        }
        sums
    }

    /// Effect of residual forces without slip; `residual` is A u − b of all equations.
    pub fn shift(&mut self, residual: &[f64]) -> Shift {
        let forwarded = self.condensed.forward(residual);
        let mut middles = self.gather(&forwarded.right);
        let mut tractions = middles.split_off(2 * self.middles);
        self.middle.solve_columns(&mut middles);
        for (w, column) in middles.iter().zip(self.middle_columns.chunks_exact(tractions.len().max(1))) {
            tractions.iter_mut().zip(column).for_each(|(rho, middle)| *rho -= w * middle);
        }
        self.series.solve_columns(&mut tractions);
        let jumps: Vec<f64> = tractions.iter().enumerate().map(|(j, y)| -y * self.compliance(j)).collect();
        middles.iter_mut().for_each(|w| *w = -*w);
        self.follow(&jumps, &mut middles);
        let displacement = self.recover(&forwarded, &jumps, &middles);
        let tractions = self.components().map(|component| tractions[component]).collect();
        Shift { tractions, displacement }
    }

    /// The jumps of (4) from slip and tractions, all of points.
    pub fn jumps(&self, slip: &[f64], tractions: &[f64]) -> Vec<f64> {
        let n = slip.len();
        let jump = |(j, (y, component)): (usize, (&f64, usize))| {
            let slipped = if j < n { 0.0 } else { slip[j - n] };
            slipped - y * self.compliance(component)
        };
        tractions.iter().zip(self.components()).enumerate().map(jump).collect()
    }

    /// u of all nodes for given jumps of the points, without other forces.
    pub fn displacement(&self, of_points: &[f64]) -> Vec<f64> {
        let mut jumps = vec![0.0; 2 * self.sites.len()];
        let shares = self.points.iter().chain(&self.points).map(|point| point.share);
        for ((jump, share), component) in of_points.iter().zip(shares).zip(self.components()) {
            jumps[component] += share * jump;
        }
        let jumps = &jumps[..];
        let mut middles = vec![0.0; 2 * self.middles];
        self.follow(jumps, &mut middles);
        let nothing = self.condensed.forward(&vec![0.0; 2 * self.bodies.model().mesh.nodes.len()]);
        self.recover(&nothing, jumps, &middles)
    }

    /// m −= S_mm⁻¹ S_mj j.
    fn follow(&self, jumps: &[f64], middles: &mut [f64]) {
        for (j, column) in jumps.iter().zip(self.middle_by_jump.chunks_exact(middles.len().max(1))) {
            middles.iter_mut().zip(column).for_each(|(m, x)| *m -= j * x);
        }
    }

    /// Back substitution of A u = −r: u of all nodes from the jumps and m.
    fn recover(&self, forwarded: &crate::linear::Forwarded, jumps: &[f64], middles: &[f64]) -> Vec<f64> {
        let n = self.sites.len();
        let mut retained = vec![0.0; 2 * self.nodes.nodes.len()];
        for (place, m) in self.moving.iter().enumerate() {
            if let Some(m) = m {
                (0..2).for_each(|i| retained[2 * place + i] = -middles[2 * m + i]);
            }
        }
        for (k, site) in self.sites.iter().enumerate() {
            let jump = site.directions[0] * jumps[k] + site.directions[1] * jumps[n + k];
            (0..2).for_each(|i| retained[2 * site.slave + i] -= jump[i]);
        }
        let mut u = self.condensed.backward(forwarded, &retained);
        u.iter_mut().for_each(|u| *u = -*u);
        u
    }
}

/// Points of a pair with matching nodes, as checked when the model is built.
fn facing(model: &Model, pair: &ContactPair, nodes: &ContactNodes, slips: Slips) -> Vec<Facing> {
    let inverse = |alpha: f64| if alpha > 0.0 { 1.0 / alpha } else { 0.0 };
    let place = |node: usize| nodes.place(model.ties.original(node)).expect("nodes at contacts are retained");
    let points = pair.points.iter().zip(pair.small.iter().flat_map(|small| small.points.iter().flatten()));
    let of = |(slave, point): (_, &crate::contact::small_sliding::SmallPoint)| {
        let (own, master) = point.facing(|node| model.ties.original(node)).expect("nodes face nodes");
        Facing {
            slave: place(own),
            master: master.map(place),
            directions: [point.normal, point.tangent],
            compliance: [
                inverse(pair.alpha_n),
                match slips {
                    Slips::Plastic => inverse(pair.law(slave).description.stiffness),
                    Slips::All => 0.0,
                },
            ],
            length: point.length,
        }
    };
    points.map(of).collect()
}

/// Sites of all points, and the places of these.
fn gathered(all: impl Iterator<Item = Facing>) -> (Vec<Facing>, Vec<AtSite>) {
    let (mut sites, mut points): (Vec<Facing>, Vec<AtSite>) = (Vec::new(), Vec::new());
    let mut of_slave: BTreeMap<usize, usize> = BTreeMap::new();
    for point in all {
        let site = *of_slave.entry(point.slave).or_insert(sites.len());
        points.push(AtSite { site, share: point.length });
        match sites.get_mut(site) {
            Some(site) => site.length += point.length,
            None => sites.push(point),
        }
    }
    points.iter_mut().for_each(|point| point.share /= sites[point.site].length);
    (sites, points)
}
