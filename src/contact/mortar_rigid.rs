//! Mortar contact with a rigid body: nothing is cut. g_j and Δu_t,j are the means of what the points of Gauss's rule between
//! two nodes have, each with its own foot, and n_j is the direction of the mean of their normals. One function sums them up:
//! every value comes with its variation.

use nalgebra::Vector2;

use super::kinematics::{Kinematics, Meeting, past_rigid};
use super::mortar::{Mortar, Room};
use super::point::{MasterPoint, SlavePoint};
use super::projection::{Projection, tangent_of};
use super::rigid::Rigid;
use crate::mesh::configuration::Configuration;

/// Sums of ℓ and of ℓ times gap, slip and n.
#[derive(Default)]
struct Sums {
    length: f64,
    gap: f64,
    slip: f64,
    along: Vector2<f64>,
    foot: Option<MasterPoint>,
}

impl Mortar {
    /// Where a point meets a rigid body, and its kinematics; `None` where that faces none of its surroundings. The
    /// configurations are the committed one and that of the trial.
    pub fn meet_rigid(
        &self,
        point: usize,
        body: &Rigid,
        [before, x]: [&Configuration; 2],
        (mean, room): (&mut Kinematics, &mut Room),
    ) -> Option<Meeting> {
        let around = &self.around[point];
        let meet = |slave: &SlavePoint, k: &mut Kinematics| meet(slave, body, [before, x], k);
        let Room { around: k, turns, .. } = room;
        k.varied = mean.varied;
        mean.begin(Vector2::zeros());
        for slave in around {
            if meet(slave, k).is_some() {
                mean.list(k.nodes.iter().copied());
            }
        }
        mean.clear();
        let dofs = mean.dgap.len();
        mean.changing.extend((0..mean.nodes.len()).filter(|_| mean.varied));
        mean.drelative.resize(mean.changing.len() * dofs, 0.0);
        let mut sums = Sums::default();
        turns.iter_mut().for_each(|turn| *turn = zeros(std::mem::take(turn), dofs));
        for slave in around {
            if let Some(projection) = meet(slave, k) {
                sums.foot.get_or_insert(projection.foot);
                sums.add(k, projection.gap, mean, turns);
            }
        }
        let Sums { length, gap, slip, along, foot } = sums;
        let foot = foot?;
        mean.normal = along.normalize();
        mean.tangent = tangent_of(mean.normal);
        (mean.length, mean.slip) = (length, slip / length);
        let Kinematics { relative, dgap, dslip, drotation, dlength, drelative, tangent, .. } = mean;
        let vary = |row: &mut [f64], mean: f64| {
            row.iter_mut().zip(&*dlength).for_each(|(rate, dlength)| *rate = (*rate - dlength * mean) / length);
        };
        vary(dgap, gap / length);
        vary(dslip, slip / length);
        relative.iter_mut().for_each(|w| *w /= length);
        if dofs > 0 {
            drelative.chunks_exact_mut(dofs).zip(&*relative).for_each(|(row, w)| vary(row, *w));
        }
        let rates = drotation.iter_mut().zip(turns[0].iter().zip(&turns[1]));
        rates.for_each(|(turn, (dx, dy))| *turn = -(dx * tangent.x + dy * tangent.y) / along.norm());
        Some(Meeting { gap: gap / length, foot })
    }
}

impl Sums {
    /// Add what a point of Gauss's rule has; its weights and variations to those of the `mean`, those of n to the `turns`.
    fn add(&mut self, k: &Kinematics, gap: f64, mean: &mut Kinematics, turns: &mut [Vec<f64>; 2]) {
        let Kinematics { nodes, relative, dgap, dslip, dlength, drelative, .. } = mean;
        let local = |node: usize| nodes.iter().position(|other| *other == node).unwrap_or_default();
        let add = |sum: &mut [f64], factor: f64, row: &[f64]| {
            for (dof, value) in row.iter().enumerate() {
                sum[2 * local(k.nodes[dof / 2]) + dof % 2] += factor * value;
            }
        };
        self.length += k.length;
        self.gap += k.length * gap;
        self.slip += k.length * k.slip;
        self.along += k.length * k.normal;
        add(dlength, 1.0, &k.dlength);
        for (sum, value, row) in [(&mut *dgap, gap, &k.dgap), (&mut *dslip, k.slip, &k.dslip)] {
            add(sum, value, &k.dlength);
            add(sum, k.length, row);
        }
        for (sum, n, s) in [(0, k.normal.x, k.tangent.x), (1, k.normal.y, k.tangent.y)] {
            add(&mut turns[sum], n, &k.dlength);
            add(&mut turns[sum], -k.length * s, &k.drotation);
        }
        let dofs = dgap.len();
        for (&node, &w) in k.nodes.iter().zip(&k.relative) {
            let at = local(node);
            relative[at] += k.length * w;
            if k.varied {
                add(&mut drelative[dofs * at..dofs * (at + 1)], w, &k.dlength);
            }
        }
    }
}

/// So many zeros in the memory of other values.
fn zeros(mut values: Vec<f64>, count: usize) -> Vec<f64> {
    values.clear();
    values.resize(count, 0.0);
    values
}

/// Where one point of Gauss's rule meets the body.
fn meet(slave: &SlavePoint, body: &Rigid, [before, x]: [&Configuration; 2], k: &mut Kinematics) -> Option<Projection> {
    let projection = body.project(slave, x)?;
    let from = body.project(slave, before).map(|was| was.foot);
    past_rigid(slave, body, &projection, from, x, k);
    if from.is_none() {
        k.count_from(before, x);
    }
    Some(projection)
}
