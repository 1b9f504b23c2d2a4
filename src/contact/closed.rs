//! What a closed point adds to the equations: the forces of its traction on the nodes, and their derivative.

use nalgebra::{DVector, Vector2};

use super::kinematics::Kinematics;
use super::presumption::Tractions;
use super::state::ContactState;
use crate::laws::friction::FrictionResponse;
use crate::linear::system::Contribution;

/// A closed point: what it adds to the equations, and how its tractions vary with its nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Closed {
    /// Forces and tangent
    pub contribution: Contribution,
    /// p and q
    pub tractions: Tractions,
    /// δp [F/L³]
    pub dpressure: DVector<f64>,
    /// δq [F/L³]
    pub dtraction: DVector<f64>,
}

impl Closed {
    /// p + δp and q + δq for a correction of the nodes' displacements; none where the pressure would be negative.
    pub fn promise(&self, correction: impl Fn(usize) -> f64) -> Tractions {
        let dofs = || self.contribution.nodes.iter().flat_map(|&node| [2 * node, 2 * node + 1]);
        let along = |rates: &DVector<f64>| dofs().zip(rates).map(|(dof, rate)| rate * correction(dof)).sum::<f64>();
        let pressure = self.tractions.pressure + along(&self.dpressure);
        let traction = self.tractions.traction + along(&self.dtraction);
        if pressure > 0.0 { Tractions { pressure, traction } } else { Tractions::default() }
    }
}

/// Trial states and contributions of all points of a pair, in their order.
pub type PairResponse = Vec<(ContactState, Option<Closed>)>;

/// What a traction puts on the nodes: w_a (p n − q s) ℓ [F].
pub fn nodal_forces(k: &Kinematics, p: f64, q: f64) -> Vec<(usize, Vector2<f64>)> {
    let force = (k.normal * p - k.tangent * q) * k.length;
    k.nodes.iter().zip(&k.relative).map(|(&node, &w)| (node, force * w)).collect()
}

/// Nodal forces of the traction and their derivative: the exact one unless tractions are promised or a pressure carried.
pub(super) fn closed(
    k: &Kinematics,
    response: &FrictionResponse,
    dpressure: DVector<f64>,
    promised: Option<Tractions>,
) -> Closed {
    let tractions = Tractions::of(&response.state);
    let turned = |Tractions { pressure: p, traction: q }: Tractions| k.normal * p - k.tangent * q;
    let traction = turned(tractions);
    let dtraction = &k.dslip * response.dtraction_dslip + &dpressure * response.dtraction_dpressure;
    let promised = promised.unwrap_or(tractions);
    let turned = turned(promised);
    let along_normal = &dpressure - &k.drotation * promised.traction;
    let along_tangent = -(&dtraction + &k.drotation * promised.pressure);
    // δ(t ℓ), one row a component
    let dforce =
        |i: usize| (&along_normal * k.normal[i] + &along_tangent * k.tangent[i]) * k.length + &k.dlength * turned[i];
    let rows = [dforce(0), dforce(1)];

    let mut result = Contribution::zero(k.nodes.clone());
    let add = |result: &mut Contribution, node: usize, i: usize, row: &DVector<f64>, factor: f64| {
        for (column, value) in row.iter().enumerate() {
            result.tangent[(2 * node + i, column)] += factor * value;
        }
    };
    for (node, &w) in k.relative.iter().enumerate() {
        for (i, row) in rows.iter().enumerate() {
            result.force[2 * node + i] = -w * traction[i] * k.length;
            add(&mut result, node, i, row, -w);
        }
    }
    for (node, dw) in &k.drelative {
        for i in 0..2 {
            add(&mut result, *node, i, dw, -turned[i] * k.length);
        }
    }
    Closed { contribution: result, tractions, dpressure, dtraction }
}
