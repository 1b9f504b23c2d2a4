//! Gap, slip and rotation of a contact point, and their exact variations.
//!
//! On a segment x(ξ), straight or curved, with x′ = dx/dξ = J s, x″ = d²x/dξ², and δm = Σ N_a(ξ) δx_a:
//!
//! ```text
//! g = (x_s − x)·n         δg = n·(δx_s − δm)
//! (x_s − x)·x′ = 0        δξ (J² − g n·x″) = J s·(δx_s − δm) + g n·δx′
//! θ: rotation of (s, n)   δθ = n·(δx′ + x″ δξ)/J,   δs = n δθ,   δn = −s δθ
//! Δu_t = ∫ J dξ           δΔu_t = ∫ s·δx′ dξ + J δξ        along the surface from the old foot to the new one
//! ```
//!
//! A point that nothing faced when the increment began has no old foot; it has slipped past what it faces now, Σ w_a x_a
//! being x_s − x:
//!
//! ```text
//! Δu_t = s·Σ w_a Δx_a     δΔu_t = s·Σ (w_a δx_a + δw_a Δx_a) + n·Σ w_a Δx_a δθ        Δx_a: motion in the increment
//! ```
//!
//! A foot bound to a node x_v: g = ±‖x_s − x_v‖, δg = n·(δx_s − δx_v), δθ = −s·(δx_s − δx_v)/g, δξ = 0.

use nalgebra::{DVector, Vector2};

use super::master::Master;
use super::projection::{Bound, FACING, Projection, normal_of, tangent_of};
use super::rigid::Rigid;
use super::surface::{MasterPoint, Path, SlavePoint, Surface};
use crate::mesh::configuration::Configuration;
use crate::mesh::shape;

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
    /// δw_a of the weights that change, with their positions in `nodes` [1/L]
    pub drelative: Vec<(usize, DVector<f64>)>,
}

/// Where a slave point meets the master: its kinematics, its gap and its foot.
#[derive(Clone, Debug, PartialEq)]
pub struct Meeting {
    /// Kinematics, with slip counted from the committed state
    pub kinematics: Kinematics,
    /// g [L]
    pub gap: f64,
    /// The foot
    pub foot: MasterPoint,
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
        Master::Rigid(body) => past_rigid(slave, body, projection, from, x),
        Master::Mesh(surface) => on_surface(slave, surface, projection, from, x),
    }
}

/// Kinematics of `slave` projected on a rigid body, with the slip counted from the committed foot `from`.
pub fn past_rigid(
    slave: &SlavePoint,
    body: &Rigid,
    projection: &Projection,
    from: Option<MasterPoint>,
    x: &Configuration,
) -> Kinematics {
    let mut k = Kinematics::of_slave(slave, projection.normal, &[], x);
    let (n, s) = (k.normal, k.tangent);
    let Bound::Rigid { advance, turn } = projection.bound else { return k };
    k.vary(&slave.position, n, |k| &mut k.dgap);
    k.vary(&slave.position, s * turn, |k| &mut k.drotation);
    if let Some(from) = from {
        k.slip = body.way(slave, from, projection.foot, x);
        k.vary(&slave.position, s * advance, |k| &mut k.dslip);
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
    let curve = &surface.segments[segment];
    let path =
        from.and_then(|from| surface.path(from, projection.foot)).filter(|path| slides(surface, path, projection, x));
    let path = path.unwrap_or_default();
    let mut masters: Vec<usize> = curve.nodes().collect();
    masters.extend(path.iter().flat_map(|&(j, ..)| surface.segments[j].nodes()));
    let mut k = Kinematics::of_slave(slave, projection.normal, &masters, x);
    let (n, s, gap) = (k.normal, k.tangent, projection.gap);

    let foot = curve.position(xi);
    let relative: Vec<(usize, f64)> =
        slave.position.iter().copied().chain(foot.iter().map(|&(node, w)| (node, -w))).collect();
    for &(node, w) in &foot {
        let at = k.local(node);
        k.relative[at] -= w;
    }
    k.vary(&relative, n, |k| &mut k.dgap);

    let slope = curve.slope(xi);
    let length = x.combine(&slope).norm();
    let mut dfoot = DVector::zeros(2 * k.nodes.len());
    match projection.bound {
        Bound::Node(_) if gap != 0.0 => k.vary(&relative, -s / gap, |k| &mut k.drotation),
        Bound::Node(_) | Bound::Rigid { .. } => {}
        Bound::Segment => {
            let bend = x.combine(&curve.bend(xi)).dot(&n);
            let stiffness = length * length - gap * bend;
            k.vary_into(&mut dfoot, &relative, s * (length / stiffness));
            k.vary_into(&mut dfoot, &slope, n * (gap / stiffness));
            k.vary(&slope, n / length, |k| &mut k.drotation);
            k.drotation += &dfoot * (bend / length);
            k.drelative = slope.iter().map(|&(node, rate)| (k.local(node), &dfoot * -rate)).collect();
        }
    }
    if path.is_empty() {
        return k;
    }
    k.slide(surface, &path, x);
    k.dslip += dfoot * length;
    k
}

/// Whether a foot has slid along a path. On a surface that touches itself it may also have jumped from one part of it to
/// another, over segments that look away.
fn slides(surface: &Surface, path: &Path, projection: &Projection, x: &Configuration) -> bool {
    let looks = |segment: usize| {
        let [a, b] = surface.segments[segment].ends;
        normal_of(x.between(a, b).normalize()).dot(&projection.normal) > -FACING
    };
    surface.own_depth.is_none() || path.iter().all(|&(segment, ..)| looks(segment))
}

impl Kinematics {
    /// ∫ J dξ along a path, and ∫ s·δx′ dξ.
    fn slide(&mut self, surface: &Surface, path: &Path, x: &Configuration) {
        for &(j, start, end) in path {
            let segment = &surface.segments[j];
            let points = if segment.is_straight() { 1 } else { 4 };
            for (at, weight) in shape::gauss(points) {
                let slope = segment.slope(start + 0.5 * (1.0 + at) * (end - start));
                let along = x.combine(&slope);
                let share = 0.5 * weight * (end - start);
                self.slip += share * along.norm();
                self.vary(&slope, along.normalize() * share, |k| &mut k.dslip);
            }
        }
    }

    /// Count the slip of a point that nothing faced in the configuration `before`.
    pub fn count_from(&mut self, before: &Configuration, x: &Configuration) {
        let motions: Vec<Vector2<f64>> = self.nodes.iter().map(|&node| x.since(before, node)).collect();
        let motion: Vector2<f64> = self.relative.iter().zip(&motions).map(|(&w, motion)| w * motion).sum();
        let (n, s) = (self.normal, self.tangent);
        self.slip = s.dot(&motion);
        self.dslip = &self.drotation * n.dot(&motion);
        for (a, &w) in self.relative.iter().enumerate() {
            self.dslip[2 * a] += w * s.x;
            self.dslip[2 * a + 1] += w * s.y;
        }
        for (a, dw) in &self.drelative {
            self.dslip += dw * s.dot(&motions[*a]);
        }
    }

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
            drelative: Vec::new(),
        };
        for &(node, w) in &slave.position {
            let at = k.local(node);
            k.relative[at] += w;
        }
        for share in &slave.length {
            let along = x.combine(&share.tangent);
            let depth = x.weight(&share.at);
            k.vary(&share.tangent, along * (depth * share.factor / along.norm()), |k| &mut k.dlength);
            if let Some(slope) = x.weight_slope(&share.at) {
                k.vary(&share.at, slope * (share.factor * along.norm()), |k| &mut k.dlength);
            }
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
