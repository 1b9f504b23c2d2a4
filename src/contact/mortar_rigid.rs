//! Mortar contact with a rigid body: nothing is cut. g_j and Δu_t,j are the means of what the points of Gauss's rule between
//! two nodes have, each with its own foot, and n_j is the direction of the mean of their normals. One function sums them up:
//! every value comes with its variation.

use nalgebra::{DVector, Vector2};

use super::kinematics::{Kinematics, Meeting, past_rigid};
use super::mortar::Mortar;
use super::point::SlavePoint;
use super::projection::{Projection, tangent_of};
use super::rigid::Rigid;
use crate::mesh::configuration::Configuration;

impl Mortar {
    /// Where a point meets a rigid body; `None` where that faces none of its surroundings. `before` is the committed
    /// configuration.
    pub fn on_rigid(&self, point: usize, body: &Rigid, before: &Configuration, x: &Configuration) -> Option<Meeting> {
        let around = self.around[point].iter();
        let met: Vec<_> = around.filter_map(|slave| meet(slave, body, before, x)).collect();
        let foot = met.first()?.0.foot;
        let nodes = nodes_of(&met);
        let zero = DVector::zeros(2 * nodes.len());
        // Sums of ℓ times gap, slip, n and weights, and their variations.
        let (mut length, mut gap, mut slip, mut along) = (0.0, 0.0, 0.0, Vector2::zeros());
        let [mut dlength, mut dgap, mut dslip, mut dx, mut dy] = [(); 5].map(|()| zero.clone());
        let mut weights = vec![0.0; nodes.len()];
        let mut dweights = vec![zero.clone(); nodes.len()];
        for (projection, k) in &met {
            let local: Vec<usize> =
                k.nodes.iter().filter_map(|node| nodes.iter().position(|other| other == node)).collect();
            let add = |sum: &mut DVector<f64>, factor: f64, row: &DVector<f64>| {
                for (dof, value) in row.iter().enumerate() {
                    sum[2 * local[dof / 2] + dof % 2] += factor * value;
                }
            };
            length += k.length;
            gap += k.length * projection.gap;
            slip += k.length * k.slip;
            along += k.length * k.normal;
            add(&mut dlength, 1.0, &k.dlength);
            for (sum, value, row) in [(&mut dgap, projection.gap, &k.dgap), (&mut dslip, k.slip, &k.dslip)] {
                add(sum, value, &k.dlength);
                add(sum, k.length, row);
            }
            for (sum, n, s) in [(&mut dx, k.normal.x, k.tangent.x), (&mut dy, k.normal.y, k.tangent.y)] {
                add(sum, n, &k.dlength);
                add(sum, -k.length * s, &k.drotation);
            }
            for (&at, &w) in local.iter().zip(&k.relative) {
                weights[at] += k.length * w;
                add(&mut dweights[at], w, &k.dlength);
            }
        }
        let normal = along.normalize();
        let tangent = tangent_of(normal);
        let mean = |value: f64, row: DVector<f64>| (value / length, (row - &dlength * (value / length)) / length);
        let ((gap, dgap), (slip, dslip)) = (mean(gap, dgap), mean(slip, dslip));
        let (relative, drelative): (Vec<f64>, Vec<_>) =
            weights.into_iter().zip(dweights).map(|(w, dw)| mean(w, dw)).unzip();
        let drotation = -(dx * tangent.x + dy * tangent.y) / along.norm();
        let drelative = drelative.into_iter().enumerate().collect();
        let kinematics =
            Kinematics { nodes, relative, normal, tangent, slip, length, dgap, dslip, drotation, dlength, drelative };
        Some(Meeting { kinematics, gap, foot })
    }
}

/// The nodes of all points that meet the body, each once.
fn nodes_of(met: &[(Projection, Kinematics)]) -> Vec<usize> {
    let mut nodes: Vec<usize> = Vec::new();
    for node in met.iter().flat_map(|(_, k)| &k.nodes) {
        if !nodes.contains(node) {
            nodes.push(*node);
        }
    }
    nodes
}

/// Where one point of Gauss's rule meets the body.
fn meet(
    slave: &SlavePoint,
    body: &Rigid,
    before: &Configuration,
    x: &Configuration,
) -> Option<(Projection, Kinematics)> {
    let projection = body.project(slave, x)?;
    let from = body.project(slave, before).map(|was| was.foot);
    let mut kinematics = past_rigid(slave, body, &projection, from, x);
    if from.is_none() {
        kinematics.count_from(before, x);
    }
    Some((projection, kinematics))
}
