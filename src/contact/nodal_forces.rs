//! Nodal forces from the tractions of contact points.
//!
//! A closed point, or one under fluid pressure, contributes the nodal forces of its traction, and their derivative.
//!
//! The tractions of a contact give nodal forces and a resultant on the slave.

use std::collections::BTreeSet;

use nalgebra::Vector2;

use super::between::Between;
use super::kinematics::{Kinematics, Lever, kinematics};
use super::mortar::Mortar;
use super::pair::ContactPair;
use super::point::{ContactState, Tractions, Weights};
use super::search::Index;
use crate::laws::friction::{FrictionResponse, FrictionState};
use crate::mesh::configuration::Configuration;

/// Contribution to the equations of a point that is closed or under fluid pressure, with the variation of its tractions; two
/// dofs per node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closed<'a> {
    /// Nodes, in the order of the entries
    pub nodes: &'a [usize],
    /// Internal force [F]
    pub force: &'a [f64],
    /// ∂force/∂u, column by column; this and the next two are empty if only forces are requested [F/L]
    pub tangent: &'a [f64],
    /// δp [F/L³]
    pub dpressure: &'a [f64],
    /// δq [F/L³]
    pub dtraction: &'a [f64],
    /// Fluid part of the force as a load, with the opposite sign of an internal force; empty without a fluid [F]
    pub fluid: &'a [f64],
    /// Water between the surfaces that the balance of each pressure takes up; empty without a seam [L³]
    pub taken: &'a [f64],
    /// Water that drains from between surfaces that are apart [L³]
    pub drained: f64,
    /// p and q
    pub tractions: Tractions,
    /// Whether the point is open, and a fluid or a bond acts
    pub is_open: bool,
    /// Whether a bond acts over its gap
    pub is_bonded: bool,
}

/// Actions at a point in addition to pressure and friction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Additional {
    /// Radiation damping η v and its derivative with respect to slip
    pub radiates: [f64; 2],
    /// p_w
    pub fluid: f64,
    /// Part of the contact pressure that friction does not see
    pub pores: f64,
    /// q_b of a bond
    pub bond: f64,
}

impl Closed<'_> {
    /// p + δp and q + δq for a correction of the nodes' displacements; zero where the pressure would be negative.
    pub fn prediction(&self, correction: impl Fn(usize) -> f64) -> Tractions {
        let dofs = || self.nodes.iter().flat_map(|&node| [2 * node, 2 * node + 1]);
        let along = |rates: &[f64]| dofs().zip(rates).map(|(dof, rate)| rate * correction(dof)).sum::<f64>();
        let pressure = self.tractions.pressure + along(self.dpressure);
        let traction = self.tractions.traction + along(self.dtraction);
        if pressure > 0.0 { Tractions { pressure, traction } } else { Tractions::default() }
    }
}

/// Contributions of the points in sequence, in common lists reused by the next evaluation.
#[derive(Clone, Debug, Default)]
pub struct ClosedPoints {
    points: Vec<Option<Place>>,
    nodes: Vec<usize>,
    force: Vec<f64>,
    tangent: Vec<f64>,
    dpressure: Vec<f64>,
    dtraction: Vec<f64>,
    /// Forces of a fluid, for all points once any point has one
    fluid: Vec<f64>,
    /// Water between the surfaces, for all points once any point has some
    taken: Vec<f64>,
    /// δ(t ℓ) of the current point, its two components
    rows: [Vec<f64>; 2],
    /// δq_b of the current point; empty without a bond
    bond: Vec<f64>,
}

/// Position of a closed point in the lists of nodes, rows and tangents.
#[derive(Clone, Copy, Debug)]
struct Place {
    tractions: Tractions,
    drained: f64,
    is_open: bool,
    is_bonded: bool,
    /// First node, and number of nodes
    nodes: [usize; 2],
    /// Start of its tangent
    tangent: usize,
}

impl ClosedPoints {
    /// Removes all points.
    pub fn clear(&mut self) {
        let Self { points, nodes, force, tangent, dpressure, dtraction, fluid, taken, .. } = self;
        points.clear();
        nodes.clear();
        [force, tangent, dpressure, dtraction, fluid, taken].into_iter().for_each(Vec::clear);
    }

    /// Returns the contribution of a point, if it is closed.
    pub fn get(&self, point: usize) -> Option<Closed<'_>> {
        let Place { tractions, drained, is_open, is_bonded, nodes: [first, count], tangent } =
            (*self.points.get(point)?)?;
        let dofs = 2 * first..2 * (first + count);
        let varied =
            |values: &'_ [f64]| -> std::ops::Range<usize> { if values.is_empty() { 0..0 } else { dofs.clone() } };
        let size = if self.tangent.is_empty() { 0 } else { 4 * count * count };
        Some(Closed {
            nodes: &self.nodes[first..first + count],
            force: &self.force[dofs.clone()],
            tangent: &self.tangent[tangent..tangent + size],
            dpressure: &self.dpressure[varied(&self.dpressure)],
            dtraction: &self.dtraction[varied(&self.dtraction)],
            fluid: self.fluid.get(dofs.clone()).unwrap_or_default(),
            taken: self.taken.get(dofs.clone()).unwrap_or_default(),
            drained,
            tractions,
            is_open,
            is_bonded,
        })
    }

    /// Adds an open point, with its fluid pressure; returns the length on which that acts.
    pub(super) fn push_open(&mut self, k: &Kinematics, fluid: f64) -> Option<f64> {
        if fluid == 0.0 && k.water.is_none() {
            self.points.push(None);
            return None;
        }
        if k.varied {
            self.push_dpressure(k, [0.0; 2]);
        }
        self.push(k, &FrictionResponse::default(), Additional { fluid, ..Additional::default() }, None);
        self.leave_open(false);
        Some(k.length)
    }

    /// Marks the last point as an open one, with a bond or under the pressure of a fluid.
    pub(super) fn leave_open(&mut self, is_bonded: bool) {
        if let Some(Some(place)) = self.points.last_mut() {
            (place.is_open, place.is_bonded) = (true, is_bonded);
        }
    }

    /// Sets δq_b = a δg + b δΔu_t of the next point.
    pub(super) fn push_bond(&mut self, k: &Kinematics, [by_gap, by_slip]: [f64; 2]) {
        self.bond.clear();
        self.bond.extend(k.dgap.iter().zip(&k.dslip).map(|(dgap, dslip)| dgap * by_gap + dslip * by_slip));
    }

    /// Adds a closed point: nodal forces of the traction and their derivative, which is exact unless tractions are predicted or
    /// a pressure is carried. The variation of the pressure was added to [`ClosedPoints::dpressure`] before. Actions beside
    /// friction are part of the forces but not of the predicted tractions.
    pub(super) fn push(
        &mut self,
        k: &Kinematics,
        response: &FrictionResponse,
        Additional { radiates, fluid, pores, bond }: Additional,
        predicted_tractions: Option<Tractions>,
    ) {
        let FrictionState { pressure, traction, .. } = response.state;
        let tractions = Tractions { pressure: pressure + pores, traction: traction + bond };
        let whole = |of: Tractions| Tractions { pressure: of.pressure + fluid, traction: of.traction + radiates[0] };
        self.points.push(Some(Place {
            tractions,
            drained: k.water.as_ref().map_or(0.0, Between::drained),
            is_open: false,
            is_bonded: false,
            nodes: [self.nodes.len(), k.nodes.len() + k.behind.len()],
            tangent: self.tangent.len(),
        }));
        self.nodes.extend_from_slice(&k.nodes);
        self.nodes.extend_from_slice(&k.behind);
        let traction = turned(k, whole(tractions));
        self.push_fluid(k, fluid);
        for &w in &k.relative {
            self.force.extend([0, 1].map(|i| -w * traction[i] * k.length));
        }
        if let Some(Lever { at, arm }) = k.lever {
            let first = self.force.len() - 2 * k.nodes.len();
            self.force[first + 2 * at] -= arm.dot(&traction) * k.length;
        }
        self.push_water(k);
        if k.varied {
            self.push_tangent(k, response, radiates[1], whole(predicted_tractions.unwrap_or(tractions)));
        }
    }

    /// Adds the fluid forces on the nodes of the current point; all earlier points have none if it is the first.
    fn push_fluid(&mut self, k: &Kinematics, fluid: f64) {
        if fluid == 0.0 && self.fluid.is_empty() {
            return;
        }
        self.fluid.resize(self.force.len(), 0.0);
        let traction = k.normal * fluid;
        let first = self.fluid.len();
        self.fluid.extend(k.relative.iter().flat_map(|&w| [0, 1].map(|i| w * traction[i] * k.length)));
        if let Some(Lever { at, arm }) = k.lever {
            self.fluid[first + 2 * at] += arm.dot(&traction) * k.length;
        }
    }

    /// Adds the rows of the nodes behind the current point: the balances of their water, nothing otherwise.
    fn push_water(&mut self, k: &Kinematics) {
        match &k.water {
            Some(water) => {
                self.taken.resize(self.force.len(), 0.0);
                self.taken.extend(water.taken());
                self.force.extend(water.forces());
            }
            None => self.force.resize(self.force.len() + 2 * k.behind.len(), 0.0),
        }
        if !self.fluid.is_empty() {
            self.fluid.resize(self.force.len(), 0.0);
        }
    }

    /// Adds δp = a δg + b δΔu_t of the next point.
    pub(super) fn push_dpressure(&mut self, k: &Kinematics, [by_gap, by_slip]: [f64; 2]) {
        let rate =
            |(dgap, dslip): (&f64, &f64)| if by_slip == 0.0 { dgap * by_gap } else { dgap * by_gap + dslip * by_slip };
        self.dpressure.extend(k.dgap.iter().zip(&k.dslip).map(rate));
        self.dpressure.extend(k.dpores.iter().map(|_| 0.0));
    }

    fn push_tangent(
        &mut self,
        k: &Kinematics,
        response: &FrictionResponse,
        damping: f64,
        predicted_tractions: Tractions,
    ) {
        let Self { tangent, dpressure, dtraction, rows, bond, .. } = self;
        let (dofs, all) = (2 * k.nodes.len(), 2 * (k.nodes.len() + k.behind.len()));
        let dpressure = &dpressure[dtraction.len()..];
        let first = dtraction.len();
        let by = |(dslip, dp): (&f64, &f64)| dslip * response.dtraction_dslip + dp * response.dtraction_dpressure;
        dtraction.extend(k.dslip.iter().zip(dpressure).map(by));
        dtraction.extend(k.dpores.iter().map(|dpores| -dpores * response.dtraction_dpressure));
        dtraction[first..].iter_mut().zip(&*bond).for_each(|(dtraction, dbond)| *dtraction += dbond);
        bond.clear();
        let dtraction = &dtraction[first..];
        let force = turned(k, predicted_tractions);
        let along_surface = predicted_tractions.traction + k.lean * predicted_tractions.pressure;
        for (i, row) in rows.iter_mut().enumerate() {
            row.clear();
            row.extend((0..dofs).map(|c| {
                let along_normal = dpressure[c] - k.drotation[c] * along_surface;
                let leaning = k.lean * dpressure[c] + k.dlean[c] * predicted_tractions.pressure;
                let resisting = dtraction[c] + damping * k.dslip[c] + leaning;
                let along_tangent = -(resisting + k.drotation[c] * predicted_tractions.pressure);
                (along_normal * k.normal[i] + along_tangent * k.tangent[i]) * k.length + k.dlength[c] * force[i]
            }));
            row.extend(dtraction[dofs..].iter().map(|dtraction| -dtraction * k.tangent[i] * k.length));
            if let Some(water) = &k.water {
                row[dofs..].iter_mut().zip(water.rates()).for_each(|(row, rate)| *row += rate * k.normal[i] * k.length);
            }
        }
        let first = tangent.len();
        for c in 0..all {
            let rows = [rows[0][c], rows[1][c]];
            k.relative.iter().for_each(|&w| tangent.extend(rows.map(|row| -w * row)));
            tangent.extend(k.dpores.iter().map(|_| 0.0));
        }
        let columns = tangent[first..].chunks_exact_mut(all);
        for (c, column) in columns.enumerate() {
            if let Some(Lever { at, arm }) = k.lever {
                let dlever = |i: usize| k.dlever[i].get(c).copied().unwrap_or_default();
                let turned = (0..2).map(|i| arm[i] * rows[i][c] + dlever(i) * force[i] * k.length);
                column[2 * at] -= turned.sum::<f64>();
            }
            let changing = if c < dofs { &k.changing[..] } else { &[] };
            for (&a, dw) in changing.iter().zip(k.drelative.chunks_exact(dofs)) {
                (0..2).for_each(|i| column[2 * a + i] += -force[i] * k.length * dw[c]);
            }
        }
        k.water.iter().for_each(|water| water.vary(k.length, [&k.dgap, &k.dlength], &mut tangent[first..], all));
    }
}

/// t = p (n − κ s) − q s.
fn turned(k: &Kinematics, Tractions { pressure: p, traction: q }: Tractions) -> Vector2<f64> {
    k.normal * p - k.tangent * (q + k.lean * p)
}

/// Nodal forces of a traction: w_a (p (n − κ s) − q s) ℓ [F].
pub fn nodal_forces(k: &Kinematics, p: f64, q: f64) -> Vec<(usize, Vector2<f64>)> {
    let force = turned(k, Tractions { pressure: p, traction: q }) * k.length;
    let moment = k.lever.map(|Lever { at, arm }| (k.nodes[at], Vector2::new(arm.dot(&force), 0.0)));
    k.nodes.iter().zip(&k.relative).map(|(&node, &w)| (node, force * w)).chain(moment).collect()
}

/// Force and moment of the master on the slave.
///
/// ```text
/// F = Σ_j t_j ℓ_j,   M = Σ_j (x_j − x₀) × t_j ℓ_j,   t = p (n − κ s) − (q + η v) s
/// ```
/// Radiation damping η v is a traction of the surfaces like friction, 0 if not used. The pressure p_w of a fluid is a load
/// and excluded.
///
/// In axisymmetry F_x is the sum of the radial parts over the full turn, and M refers to the section.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Resultant {
    /// F [F]
    pub force: Vector2<f64>,
    /// M about x₀, counter-clockwise [F·L]
    pub moment: f64,
}

/// A closed point: the position of its traction on the slave, and its kinematics.
struct Acting {
    point: usize,
    place: Weights,
    kinematics: Kinematics,
}

impl ContactPair {
    /// x₀: the center of the slave surface in the configuration `x`; pass the undeformed one for moments about a fixed
    /// point.
    pub fn middle(&self, x: &Configuration) -> Vector2<f64> {
        let Some(first) = self.points.first().map(|point| point.at(x)) else { return Vector2::zeros() };
        let shares = self.points.iter().map(|point| (point.current_length(x), point.at(x) - first));
        let (length, sum) =
            shares.fold((0.0, Vector2::zeros()), |(all, sum), (length, at)| (all + length, sum + at * length));
        first + sum / length
    }

    /// Nodal forces of accepted tractions on both sides, in their configuration `x` [F].
    pub fn forces_on_nodes(&self, states: &[ContactState], x: &Configuration) -> Vec<(usize, Vector2<f64>)> {
        let acting = self.acting(states, x);
        let forces = acting.iter().flat_map(|acting| {
            let [pressure, traction] = states[acting.point].tractions();
            nodal_forces(&acting.kinematics, pressure, traction)
        });
        forces.collect()
    }

    /// Resultant force on the slave, with its moment about a point.
    pub fn resultant(&self, states: &[ContactState], x: &Configuration, about: Vector2<f64>) -> Resultant {
        let mut sum = Resultant::default();
        for Acting { point, place, kinematics: k } in self.acting(states, x) {
            let [pressure, traction] = states[point].tractions();
            let force = turned(&k, Tractions { pressure, traction }) * k.length;
            let [reference, displacement] = x.split(&place, about);
            sum.force += force;
            sum.moment += (reference + displacement).perp(&force);
        }
        sum
    }

    /// Closed points with their kinematics and tractions.
    fn acting(&self, states: &[ContactState], x: &Configuration) -> Vec<Acting> {
        let closed: Vec<usize> = (0..states.len()).filter(|&k| states[k].acts()).collect();
        if closed.is_empty() {
            return Vec::new();
        }
        if self.small.is_some() || self.mortar.is_some() {
            let mut met = self.meetings(x, false);
            let acting = |point: usize| {
                let (_, mut kinematics) = met[point].take()?;
                // Beside a corner that was a ridge in the increment, and is none where the next one begins, or the other way round, A has
                // another extent by now.
                if self.mortar.as_ref().is_some_and(Mortar::has_corners) {
                    kinematics.length = states[point].length;
                }
                Some((point, kinematics))
            };
            let found: Vec<(usize, Kinematics)> = closed.into_iter().filter_map(acting).collect();
            let place = |(point, kinematics): (usize, Kinematics)| {
                let place = if self.mortar.is_some() {
                    self.mean_place(&kinematics)
                } else {
                    self.points[point].position.clone()
                };
                Acting { point, place, kinematics }
            };
            return found.into_iter().map(place).collect();
        }
        let index = Index::new(&self.master, x);
        let acting = |point: usize| {
            let slave = &self.points[point];
            let projection = index.project(slave, states[point].master_point, x)?;
            let mut k = Kinematics::new(false);
            kinematics(slave, &self.master, &projection, None, x, &mut k);
            Some(Acting { point, place: slave.position.clone(), kinematics: k })
        };
        closed.into_iter().filter_map(acting).collect()
    }

    /// Mean position on the slave of a mortar point: the slave's part of its weights.
    fn mean_place(&self, k: &Kinematics) -> Weights {
        let slaves = self.points.iter().flat_map(|point| &point.length).flat_map(|share| &share.at);
        let slaves: BTreeSet<usize> = slaves.map(|(node, _)| *node).collect();
        let meets_itself = self.is_own();
        let own = |(&node, &w): (&usize, &f64)| {
            let is_slave = if meets_itself { w > 0.0 } else { slaves.contains(&node) };
            is_slave.then_some((node, w))
        };
        k.nodes.iter().zip(&k.relative).filter_map(own).collect()
    }
}
