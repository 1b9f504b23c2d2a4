//! Gap, slip and rotation of a contact point, and their exact variations.
//!
//! With d = x_s − x₁, a segment from x₁ to x₂ of length L along s = (x₂ − x₁)/L, and δm = (1 − ξ) δx₁ + ξ δx₂:
//!
//! ```text
//! g  = d·n                δg = n·(δx_s − δm)
//! ξ L = d·s               δ(ξL) = s·(δx_s − δx₁) + (g/L) n·(δx₂ − δx₁)
//! θ: rotation of (s, n)   δθ = n·(δx₂ − δx₁)/L,   δs = n δθ,   δn = −s δθ
//! Δu_t = Σ c_j L_j        δΔu_t = Σ c_j δL_j + L δξ        c_j: signed share of segment j between old and new foot
//! ```
//!
//! A foot bound to a node x_v: g = ±‖x_s − x_v‖, δg = n·(δx_s − δx_v), δθ = −s·(δx_s − δx_v)/g, δξ = 0.

use nalgebra::{DVector, Vector2};

use super::projection::{Bound, Projection, tangent_of};
use super::surface::{Master, MasterPoint, SlavePoint, Surface};
use crate::configuration::Configuration;

/// Kinematics of one contact point and the variations with respect to its nodes' displacements.
#[derive(Clone, Debug, PartialEq)]
pub struct Kinematics {
    /// Nodes that take part: entries of all variations, two dofs a node
    pub nodes: Vec<usize>,
    /// Weights w_a of x_s − x_foot = Σ w_a x_a, by position in `nodes`
    pub relative: Vec<f64>,
    /// n
    pub normal: Vector2<f64>,
    /// s
    pub tangent: Vector2<f64>,
    /// Δu_t since the old foot [L]
    pub slip: f64,
    /// Current length the point stands for [L]
    pub length: f64,
    /// δg
    pub dgap: DVector<f64>,
    /// δΔu_t [-]
    pub dslip: DVector<f64>,
    /// δθ [1/L]
    pub drotation: DVector<f64>,
    /// δ(length) [-]
    pub dlength: DVector<f64>,
    /// δξ [1/L], and the positions in `nodes` of the segment's start and end whose weights it moves
    pub dfoot: Option<(DVector<f64>, [usize; 2])>,
}

/// Kinematics of `slave` projected on `master`, with the slip counted from the committed foot `from`.
pub fn kinematics(
    slave: &SlavePoint,
    master: &Master,
    projection: &Projection,
    from: Option<MasterPoint>,
    x: &Configuration,
) -> Kinematics {
    match master {
        Master::Plane(_) => on_plane(slave, projection, from, x),
        Master::Mesh(surface) => on_surface(slave, surface, projection, from, x),
    }
}

fn on_plane(slave: &SlavePoint, projection: &Projection, from: Option<MasterPoint>, x: &Configuration) -> Kinematics {
    let mut k = Kinematics::of_slave(slave, projection.normal, &[], x);
    let (n, s) = (k.normal, k.tangent);
    k.vary(&slave.position, n, |k| &mut k.dgap);
    if let Some(from) = from {
        k.slip = projection.foot.xi - from.xi;
        k.vary(&slave.position, s, |k| &mut k.dslip);
    }
    k
}

fn on_surface(
    slave: &SlavePoint,
    surface: &Surface,
    projection: &Projection,
    from: Option<MasterPoint>,
    x: &Configuration,
) -> Kinematics {
    let MasterPoint { segment, xi } = projection.foot;
    let path = from.and_then(|from| surface.path(from, projection.foot)).unwrap_or_default();
    let [a, b] = surface.segments[segment];
    let mut masters = vec![a, b];
    masters.extend(path.iter().flat_map(|&(j, _)| surface.segments[j]));
    let mut k = Kinematics::of_slave(slave, projection.normal, &masters, x);
    let (n, s, gap) = (k.normal, k.tangent, projection.gap);

    let foot = [(a, 1.0 - xi), (b, xi)];
    let relative: Vec<(usize, f64)> =
        slave.position.iter().copied().chain(foot.iter().map(|&(node, w)| (node, -w))).collect();
    for &(node, w) in &foot {
        let at = k.local(node);
        k.relative[at] -= w;
    }
    k.vary(&relative, n, |k| &mut k.dgap);

    let along = x.between(a, b);
    let length = along.norm();
    match projection.bound {
        Bound::Node(_) if gap != 0.0 => k.vary(&relative, -s / gap, |k| &mut k.drotation),
        Bound::Node(_) => {}
        _ => {
            let segment_vector = [(a, -1.0), (b, 1.0)];
            k.vary(&segment_vector, n / length, |k| &mut k.drotation);
            let mut dfoot = DVector::zeros(2 * k.nodes.len());
            k.vary_into(&mut dfoot, &slave.position, s / length);
            k.vary_into(&mut dfoot, &[(a, 1.0)], -s / length);
            k.vary_into(&mut dfoot, &segment_vector, (n * (gap / length) - s * xi) / length);
            k.dfoot = Some((dfoot, [k.local(a), k.local(b)]));
        }
    }
    if path.is_empty() {
        return k;
    }
    for (j, share) in path {
        let [a, b] = surface.segments[j];
        let along = x.between(a, b);
        let length = along.norm();
        k.slip += share * length;
        k.vary(&[(a, -1.0), (b, 1.0)], along * (share / length), |k| &mut k.dslip);
    }
    if let Some((dfoot, _)) = &k.dfoot {
        k.dslip += dfoot * length;
    }
    k
}

impl Kinematics {
    /// The slave's part: its nodes, their weights, its length; everything else zero.
    fn of_slave(slave: &SlavePoint, normal: Vector2<f64>, masters: &[usize], x: &Configuration) -> Self {
        let shares = slave.length.iter().flat_map(|share| &share.tangent);
        let mut nodes: Vec<usize> = Vec::new();
        for node in slave.position.iter().chain(shares).map(|&(node, _)| node).chain(masters.iter().copied()) {
            if !nodes.contains(&node) {
                nodes.push(node);
            }
        }
        let zero = DVector::zeros(2 * nodes.len());
        let mut k = Self {
            relative: vec![0.0; nodes.len()],
            nodes,
            normal,
            tangent: tangent_of(normal),
            slip: 0.0,
            length: slave.current_length(x),
            dgap: zero.clone(),
            dslip: zero.clone(),
            drotation: zero.clone(),
            dlength: zero,
            dfoot: None,
        };
        for &(node, w) in &slave.position {
            let at = k.local(node);
            k.relative[at] += w;
        }
        for share in &slave.length {
            let along = x.combine(&share.tangent);
            k.vary(&share.tangent, along * (share.factor / along.norm()), |k| &mut k.dlength);
        }
        k
    }

    fn local(&self, node: usize) -> usize {
        self.nodes.iter().position(|&n| n == node).expect("every node of a contact point is listed when it is built")
    }

    /// Add `direction`·Σ w_a δx_a to a variation.
    fn vary(
        &mut self,
        weights: &[(usize, f64)],
        direction: Vector2<f64>,
        row: impl Fn(&mut Self) -> &mut DVector<f64>,
    ) {
        let mut variation = std::mem::replace(row(self), DVector::zeros(0));
        self.vary_into(&mut variation, weights, direction);
        *row(self) = variation;
    }

    fn vary_into(&self, variation: &mut DVector<f64>, weights: &[(usize, f64)], direction: Vector2<f64>) {
        for &(node, w) in weights {
            let at = 2 * self.local(node);
            variation[at] += w * direction.x;
            variation[at + 1] += w * direction.y;
        }
    }
}
