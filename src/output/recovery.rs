//! Stresses and strains at nodes and at probes, recovered from the elements around: right at surfaces, too.
//!
//! Stresses are more accurate at the points of the quadrature one order lower than anywhere else in an element (the centre of Q4, 2 × 2 points
//! of Q8 and Q9, the three points of T6). Around a place X₀ a polynomial is fitted to the values there, body by body:
//!
//! ```text
//! σ*(X) = Σ c_k P_k(X),   P = 1, x, y, x², xy, y²,   Σ_s |X_s − X₀|⁻⁴ (σ*(X_s) − σ_s)² → min,   σ(X₀) = σ*(X₀)       (1)
//! ```
//! X are places of the undeformed body. The patch is the elements around X₀, their neighbours, and of linear elements the neighbours of these as well,
//! so that at a surface there are the three layers that a parabola needs. The weights let the nearest values count most; the neighbours
//! only tell how the field bends.
//!
//! A linear field is met exactly, a smooth one at a surface to the third order in the size of the elements. Where the samples do not tell
//! a term, it is left out, the shorter direction of the patch first: σ(X₀) is a weighted sum of samples, and the magnitudes of these
//! weights may add up to [`AMPLIFIED`] at most. A body of one layer has its values at all quadrature points fitted by a linear field instead: bending
//! is seen.
//!
//! Nodes that bodies share have the mean of the values of the bodies.
//!
//! Source: Zienkiewicz & Zhu (1992), Int. J. Numer. Meth. Engng 33, 1331, doi:10.1002/nme.1620330702, with the weights of Lancaster & Salkauskas
//! (1981), Math. Comp. 37, 141.

use nalgebra::{Rotation2, Vector2};

use crate::laws::bulk::CauchyStress;
use crate::mesh::few::Few;
use crate::model::Model;
use crate::model::state::State;

/// The largest sum of magnitudes of the weights of samples: above it errors of the samples would be amplified.
const AMPLIFIED: f64 = 10.0;

/// Distance from a sample, in parts of the size of the patch, below which weights do not grow any more.
const NEAREST: f64 = 1e-3;

/// Part of a term that must be new beside the terms before it.
const NEW: f64 = 1e-6;

/// Values of an element at its quadrature points: nothing where it has no answer.
pub type Values<const N: usize> = Option<Few<[f64; N], 9>>;

/// The elements around every node.
#[derive(Debug)]
pub struct Recovery {
    /// Start of the elements of each node, and end of the last
    starts: Vec<usize>,
    elements: Vec<usize>,
}

impl Recovery {
    /// Of the mesh of a model.
    pub fn new(model: &Model) -> Self {
        let mut starts = vec![0; model.mesh.nodes.len() + 1];
        let all = || {
            model.mesh.elements.iter().enumerate().flat_map(|(e, element)| element.nodes.iter().map(move |&n| (e, n)))
        };
        all().for_each(|(_, node)| starts[node + 1] += 1);
        (1..starts.len()).for_each(|node| starts[node] += starts[node - 1]);
        let (mut next, mut elements) = (starts.clone(), vec![0; starts[starts.len() - 1]]);
        for (e, node) in all() {
            elements[next[node]] = e;
            next[node] += 1;
        }
        Self { starts, elements }
    }

    fn around(&self, node: usize) -> &[usize] {
        &self.elements[self.starts[node]..self.starts[node + 1]]
    }

    /// Values at all nodes; 0 at nodes without elements.
    pub fn at_nodes<const N: usize>(&self, model: &Model, values: impl Fn(usize) -> Values<N>) -> Vec<[f64; N]> {
        let at_node = |node: usize| {
            let mut bodies: Vec<usize> = self.around(node).iter().map(|&e| model.body_of_element[e]).collect();
            bodies.sort_unstable();
            bodies.dedup();
            let own = bodies.iter().filter_map(|&body| {
                let seeds = self.around(node).iter().copied().filter(|&e| model.body_of_element[e] == body).collect();
                self.fitted(model, &values, seeds, model.mesh.nodes[node])
            });
            let found: Vec<[f64; N]> = own.collect();
            let mut mean = [0.0; N];
            found.iter().for_each(|own| add(&mut mean, 1.0 / found.len() as f64, own));
            mean
        };
        (0..model.mesh.nodes.len()).map(at_node).collect()
    }

    /// Values at a place of the undeformed body in an element; nothing where no element has an answer.
    pub fn at<const N: usize>(
        &self,
        model: &Model,
        values: impl Fn(usize) -> Values<N>,
        element: usize,
        place: Vector2<f64>,
    ) -> Option<[f64; N]> {
        self.fitted(model, &values, vec![element], place)
    }

    /// The seeds and their neighbours in the same body, ascending.
    fn patch(&self, model: &Model, seeds: Vec<usize>) -> Vec<usize> {
        let is_quadratic = |&e: &usize| {
            let kind = model.mesh.elements[e].kind;
            kind.nodes() > kind.corners()
        };
        let Some(&first) = seeds.first() else { return seeds };
        let layers = if seeds.iter().any(is_quadratic) { 1 } else { 2 };
        let body = model.body_of_element[first];
        let mut patch = seeds;
        for _ in 0..layers {
            let mut nodes: Vec<usize> =
                patch.iter().flat_map(|&e| model.mesh.elements[e].nodes.iter().copied()).collect();
            nodes.sort_unstable();
            nodes.dedup();
            patch = nodes.iter().flat_map(|&node| self.around(node).iter().copied()).collect();
            patch.retain(|&e| model.body_of_element[e] == body);
            patch.sort_unstable();
            patch.dedup();
        }
        patch
    }

    /// (1) at a place.
    fn fitted<const N: usize>(
        &self,
        model: &Model,
        values: &impl Fn(usize) -> Values<N>,
        seeds: Vec<usize>,
        place: Vector2<f64>,
    ) -> Option<[f64; N]> {
        let patch = self.patch(model, seeds);
        let samples = samples(model, values, &patch, Points::Reduced);
        let fit = Fit::new(&samples, place, 5)?;
        if fit.terms >= 2 {
            return Some(fit.sum(&samples));
        }
        let samples = self::samples(model, values, &patch, Points::All);
        Fit::new(&samples, place, 2).map(|fit| fit.sum(&samples))
    }
}

/// Cauchy stress at the nodes.
pub fn nodal_stresses(model: &Model, state: &State) -> Vec<CauchyStress> {
    let stresses_of = |e: usize| {
        let u = model.mesh.vectors(e, &state.displacement);
        let material = &*model.bodies[model.body_of_element[e]].material;
        let found = model.solids[e].stresses(material, model.memories.of(e, &state.memory), &u).ok()?;
        Some(found.iter().map(|s| [s.xx, s.yy, s.zz, s.xy]).collect())
    };
    let all: Vec<Values<4>> = (0..model.mesh.elements.len()).map(stresses_of).collect();
    let at_nodes = Recovery::new(model).at_nodes(model, |e| all[e]);
    at_nodes.into_iter().map(|[xx, yy, zz, xy]| CauchyStress { xx, yy, zz, xy }).collect()
}

/// A place and the values there.
struct Sample<const N: usize> {
    place: Vector2<f64>,
    values: [f64; N],
}

/// The points of an element at which it is sampled.
#[derive(Clone, Copy, PartialEq)]
enum Points {
    /// Those of the quadrature one order lower
    Reduced,
    /// Its quadrature points
    All,
}

/// Samples of the elements of a patch.
fn samples<const N: usize>(
    model: &Model,
    values: impl Fn(usize) -> Values<N>,
    patch: &[usize],
    points: Points,
) -> Vec<Sample<N>> {
    let mut samples = Vec::new();
    for &e in patch {
        let (Some(values), element, solid) = (values(e), &model.mesh.elements[e], &model.solids[e]) else { continue };
        let place = |at: [f64; 2]| {
            let shares = element.kind.values(at);
            element.nodes.iter().zip(shares).map(|(&node, share)| model.mesh.nodes[node] * share).sum()
        };
        match points {
            Points::All => samples.extend(
                solid.quadrature().iter().zip(values).map(|(at, values)| Sample { place: place(at.at), values }),
            ),
            Points::Reduced => samples.extend(
                element
                    .kind
                    .reduced_quadrature()
                    .iter()
                    .zip(solid.reduced(&values))
                    .map(|(at, values)| Sample { place: place(at.at), values }),
            ),
        }
    }
    samples
}

/// A value as a weighted sum of samples.
struct Fit {
    weights: Vec<f64>,
    /// number of terms besides the constant: 2 are a linear field
    terms: usize,
}

impl Fit {
    /// The fit at a place with the constant and so many terms at most; nothing without samples.
    ///
    /// The weighted constant is made orthogonal to the other weighted terms, one after the other; the value at the place is then
    /// the projection of the samples on what is left of it.
    fn new<const N: usize>(samples: &[Sample<N>], place: Vector2<f64>, most: usize) -> Option<Self> {
        let arms: Vec<Vector2<f64>> = samples.iter().map(|sample| sample.place - place).collect();
        let turned = long_axis(&arms)?.inverse();
        let size = arms.iter().map(|arm| arm.norm()).fold(0.0, f64::max);
        if size == 0.0 {
            return Some(Self { weights: vec![1.0 / arms.len() as f64; arms.len()], terms: 0 });
        }
        let own: Vec<Vector2<f64>> = arms.iter().map(|arm| turned * arm / size).collect();
        let near: Vec<f64> = own.iter().map(|x| 1.0 / x.norm_squared().max(NEAREST * NEAREST)).collect();
        let terms: [fn(&Vector2<f64>) -> f64; 5] = [|x| x.x, |x| x.y, |x| x.x * x.x, |x| x.x * x.y, |x| x.y * x.y];
        let mut rest = near.clone();
        let mut fit = Self { weights: projection(&near, &rest), terms: 0 };
        let mut directions: Vec<Vec<f64>> = Vec::new();
        for (k, term) in terms.iter().take(most).enumerate() {
            let mut column: Vec<f64> = own.iter().zip(&near).map(|(x, near)| near * term(x)).collect();
            let whole = dot(&column, &column);
            // Twice: round-off of the first time is made orthogonal, too.
            for direction in directions.iter().chain(&directions) {
                let share = -dot(direction, &column);
                combine(&mut column, share, direction);
            }
            let new = dot(&column, &column);
            if !(new > NEW * NEW * whole) {
                break;
            }
            column.iter_mut().for_each(|value| *value /= new.sqrt());
            let share = -dot(&column, &rest);
            combine(&mut rest, share, &column);
            directions.push(column);
            let weights = projection(&near, &rest);
            if !(weights.iter().map(|weight| weight.abs()).sum::<f64>() <= AMPLIFIED) {
                break;
            }
            fit = Self { weights, terms: k + 1 };
        }
        Some(fit)
    }

    fn sum<const N: usize>(&self, samples: &[Sample<N>]) -> [f64; N] {
        let mut sum = [0.0; N];
        self.weights.iter().zip(samples).for_each(|(weight, sample)| add(&mut sum, *weight, &sample.values));
        sum
    }
}

/// The weights of samples, from their nearness and what is left of the weighted constant.
fn projection(near: &[f64], rest: &[f64]) -> Vec<f64> {
    let square = dot(rest, rest);
    near.iter().zip(rest).map(|(near, rest)| near * rest / square).collect()
}

/// The rotation from the x axis to the direction in which places extend farthest; nothing if there are none.
fn long_axis(arms: &[Vector2<f64>]) -> Option<Rotation2<f64>> {
    let mean = arms.iter().sum::<Vector2<f64>>() / arms.len() as f64;
    let [mut xx, mut yy, mut xy] = [0.0; 3];
    for arm in arms {
        let from_mean = arm - mean;
        xx += from_mean.x * from_mean.x;
        yy += from_mean.y * from_mean.y;
        xy += from_mean.x * from_mean.y;
    }
    (!arms.is_empty()).then(|| Rotation2::new(0.5 * f64::atan2(2.0 * xy, xx - yy)))
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn combine(sum: &mut [f64], share: f64, of: &[f64]) {
    sum.iter_mut().zip(of).for_each(|(sum, of)| *sum += share * of);
}

fn add<const N: usize>(sum: &mut [f64; N], share: f64, of: &[f64; N]) {
    combine(sum, share, of);
}
