//! Stresses and strains at nodes and at probes, recovered from the elements around: right at surfaces, too.
//!
//! Stresses are more accurate at the points of the quadrature one order lower than anywhere else in an element (the centre of Q4, 2 × 2 points
//! of Q8 and Q9, the three points of T6). A single T3 is accurate nowhere: its error is of the first order, but that of its neighbour across an edge has the other sign,
//! and the mean of both is right in the middle of the edge, exactly where the two make a parallelogram. Around a place X₀ a polynomial is fitted
//! to these samples, body by body:
//!
//! ```text
//! ┌───────●───────┐     ●: X₀, here at a surface
//! │   ×   │   ×   │     ×: samples, in layers of elements around X₀
//! ├───────┼───────┤     σ*: the polynomial fitted to them, read at X₀
//! │   ×   │   ×   │
//! ```
//!
//! ```text
//! σ*(X) = Σ c_k P_k(X),   P = 1, x, y, x², xy, y²,   Σ_s w_s² (σ*(X_s) − σ_s)² → min,   σ(X₀) = σ*(X₀)                    (1)
//! w_s = |X_s − X₀|⁻²;   of pairs of T3  w_s = |X_s − X₀|⁻¹ (d²/A + 0.3²)^(−½),   d = X_a + X_b − X_i − X_j                  (2)
//! ```
//! X are places of the undeformed body. The patch is the elements around X₀ and, layer by layer, their neighbours: one layer at most of quadratic
//! elements, two of linear ones, so that at a surface there are the three layers that a parabola needs; inside fewer will do. The weights let the
//! nearest values count most; the others only tell how the field bends. In (2), A is the area of two triangles, i and j are the ends of their common edge,
//! a and b the other corners, so that d = 0 of a parallelogram; two that are far from one still err, and count less.
//!
//! A linear field is met exactly, a smooth one at a surface to the third order in the size of the elements. Where the samples do not tell
//! a term, it is left out, the shorter direction of the patch first: σ(X₀) is a weighted sum of samples, and the magnitudes of these
//! weights may add up to `AMPLIFIED` at most. A patch that extends alike in all directions has no shorter one, and takes or leaves all terms of a
//! degree: which of them round-off would leave depends on how the body lies. A body of one layer has its values at all quadrature points fitted by a linear field instead: bending
//! is seen.
//!
//! Nodes that bodies share have the mean of the values of the bodies.
//!
//! Source: Zienkiewicz & Zhu (1992), Int. J. Numer. Meth. Engng 33, 1331, doi:10.1002/nme.1620330702, with the weights of Lancaster & Salkauskas
//! (1981), Math. Comp. 37, 141.

use nalgebra::{Rotation2, Vector2};

use crate::laws::bulk::CauchyStress;
use crate::mesh::shape::{ElementKind, QuadraturePoint};
use crate::model::element::SolidElement;
use crate::model::{Model, State};

/// The largest sum of magnitudes of the weights of samples: above it errors of the samples would be amplified.
const AMPLIFIED: f64 = 10.0;

/// The same sum from which a patch needs no further layer: less than that of an extrapolation, which has 2 at least.
const INSIDE: f64 = 1.9;

/// Distance from a sample, in parts of the size of the patch, below which weights do not grow any more.
const NEAREST: f64 = 1e-3;

/// How far two T3 are from a parallelogram, √(d²/A), before they count less.
const PAIRS: f64 = 0.3;

/// Part of a term that must be new compared with the terms before it.
const NEW: f64 = 1e-6;

/// The elements around every node.
#[derive(Debug)]
pub struct Recovery {
    /// Start of the elements of each node, and end of the last
    starts: Vec<usize>,
    elements: Vec<usize>,
}

/// A value at a place as a weighted sum of values at points of some elements.
#[derive(Clone, Debug)]
pub struct Stencil {
    elements: Box<[usize]>,
    points: Points,
    /// of these points of each element, one after the other
    weights: Box<[f64]>,
}

/// The points of elements whose values count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Points {
    /// those of the quadrature one order lower
    Reduced,
    /// all quadrature points
    All,
}

/// Values of an element: all components at a point, then at the next, …
#[derive(Clone, Debug)]
pub struct ElementValues {
    /// at the points of the quadrature one order lower
    reduced: Vec<f64>,
    /// at all quadrature points
    all: Vec<f64>,
}

impl ElementValues {
    /// Creates the values of an element from those at its quadrature points.
    pub fn new(solid: &SolidElement, all: Vec<f64>) -> Self {
        let shares = solid.reduced();
        let components = all.len() / shares.ncols();
        let mut reduced = vec![0.0; shares.nrows() * components];
        for (sums, row) in reduced.chunks_exact_mut(components.max(1)).zip(shares.row_iter()) {
            let points = all.chunks_exact(components.max(1));
            row.iter().zip(points).for_each(|(share, point)| combine(sums, *share, point));
        }
        Self { reduced, all }
    }
}

impl Stencil {
    /// The elements.
    pub fn elements(&self) -> &[usize] {
        &self.elements
    }

    /// Adds the sums, component by component, of the values of the elements.
    pub fn sum<'v>(&self, sums: &mut [f64], values: impl Fn(usize) -> &'v ElementValues) {
        let mut weights = self.weights.iter();
        for &e in &*self.elements {
            let ElementValues { reduced, all } = values(e);
            let own = if self.points == Points::Reduced { reduced } else { all };
            let points = own.chunks_exact(sums.len());
            for (point, weight) in points.zip(&mut weights) {
                combine(sums, *weight, point);
            }
        }
    }
}

impl Recovery {
    /// Creates the recovery for the mesh of a model.
    pub fn new(model: &Model) -> Self {
        let mut starts = vec![0; model.mesh.nodes.len() + 1];
        let elements = || model.mesh.elements.iter().enumerate();
        let all = || elements().flat_map(|(e, element)| element.nodes.iter().map(move |&node| (e, node)));
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

    /// The stencils at a node, one for each body there, with its number.
    pub fn at_node(&self, model: &Model, node: usize) -> Vec<(usize, Stencil)> {
        let mut bodies: Vec<usize> = self.around(node).iter().map(|&e| model.body_of_element[e]).collect();
        bodies.sort_unstable();
        bodies.dedup();
        let of_body = |body: usize| {
            let seeds = self.around(node).iter().copied().filter(|&e| model.body_of_element[e] == body).collect();
            (body, self.stencil(model, seeds, model.mesh.nodes[node]))
        };
        bodies.into_iter().map(of_body).collect()
    }

    /// The stencil at a place of the undeformed body in an element.
    pub fn at(&self, model: &Model, element: usize, place: Vector2<f64>) -> Stencil {
        self.stencil(model, vec![element], place)
    }

    /// (1) at a place of a body, from some of its elements on.
    fn stencil(&self, model: &Model, seeds: Vec<usize>, place: Vector2<f64>) -> Stencil {
        let Patch { elements, samples, fit } = self.patch(model, seeds, place);
        if fit.terms < 2 {
            // Samples in a row.
            let all = points(model, &elements, |e| model.solids[e].quadrature());
            let weights = Fit::new(&all, place, 2).weights.into();
            return Stencil { elements: elements.into(), points: Points::All, weights };
        }
        let mut starts = vec![0];
        starts.extend(elements.iter().scan(0, |end, &e| {
            *end += model.solids[e].reduced().nrows();
            Some(*end)
        }));
        let mut weights = vec![0.0; starts[elements.len()]];
        for (sample, weight) in samples.iter().zip(&fit.weights) {
            for &(k, point) in &sample.of {
                weights[starts[k] + point] += weight / sample.of.len() as f64;
            }
        }
        Stencil { elements: elements.into(), points: Points::Reduced, weights: weights.into() }
    }

    /// The seeds with as many layers of neighbours in the same body as a fit needs, and the fit.
    fn patch(&self, model: &Model, seeds: Vec<usize>, place: Vector2<f64>) -> Patch {
        let is_quadratic = |&e: &usize| {
            let kind = model.mesh.elements[e].kind;
            kind.nodes() > kind.corners()
        };
        let layers = if seeds.iter().any(is_quadratic) { 1 } else { 2 };
        let mut found = Patch::new(model, seeds, place);
        for _ in 0..layers {
            if found.fit.terms == 5 && found.fit.amplified <= INSIDE {
                break;
            }
            found = Patch::new(model, self.with_neighbours(model, &found.elements), place);
        }
        found
    }

    /// Elements and their neighbours in the same body, ascending.
    fn with_neighbours(&self, model: &Model, elements: &[usize]) -> Vec<usize> {
        let of = |&e: &usize| model.mesh.elements[e].nodes.iter().copied();
        let mut nodes: Vec<usize> = elements.iter().flat_map(of).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let mut all: Vec<usize> = nodes.iter().flat_map(|&node| self.around(node).iter().copied()).collect();
        let body = elements.first().map(|&e| model.body_of_element[e]);
        all.retain(|&e| Some(model.body_of_element[e]) == body);
        all.sort_unstable();
        all.dedup();
        all
    }
}

/// Fields of the bodies at all nodes.
#[derive(Debug)]
pub struct NodalFields {
    /// Cauchy stress [F/L²], and logarithmic strain xx, yy, zz, xy [-]; 0 at nodes without elements
    pub tensors: Vec<(CauchyStress, [f64; 4])>,
    /// what laws show, by its names: NaN where no law shows it
    pub shown: Vec<(&'static str, Vec<f64>)>,
}

/// The stencils of all nodes. They depend on the undeformed mesh alone: one set serves all frames of a run.
#[derive(Debug)]
pub struct NodalRecovery {
    /// those of each node, one for each body there, with its number
    of_node: Vec<Box<[(usize, Stencil)]>>,
    /// whether any of them takes all quadrature points of an element
    takes_all: Vec<bool>,
}

impl NodalRecovery {
    /// Creates the stencils for the mesh of a model.
    pub fn new(model: &Model) -> Self {
        let recovery = Recovery::new(model);
        let of_node: Vec<Box<[_]>> =
            (0..model.mesh.nodes.len()).map(|node| recovery.at_node(model, node).into()).collect();
        let mut takes_all = vec![false; model.mesh.elements.len()];
        let stencils = of_node.iter().flatten().map(|(_, stencil)| stencil);
        let of_all = stencils.filter(|stencil| stencil.points == Points::All);
        of_all.flat_map(Stencil::elements).for_each(|&e| takes_all[e] = true);
        Self { of_node, takes_all }
    }

    /// Fields at the nodes, of the bodies that are there; zero at nodes that only absent ones have. An element that the material law cannot answer counts as 0: it never occurs in an accepted state.
    pub fn fields(&self, model: &Model, state: &State) -> NodalFields {
        let of_elements = |values: fn(&Model, &State, usize) -> Vec<f64>| -> Vec<ElementValues> {
            let of_element = |(e, &takes_all): (usize, &bool)| {
                let found = ElementValues::new(&model.solids[e], values(model, state, e));
                if takes_all { found } else { ElementValues { all: Vec::new(), ..found } }
            };
            self.takes_all.iter().enumerate().map(of_element).collect()
        };
        let (tensors, shown) = (of_elements(stress_and_strain), of_elements(shown));
        let (names, nodes) = (shown_names(model), self.of_node.len());
        let mut fields = NodalFields {
            tensors: Vec::with_capacity(nodes),
            shown: names.iter().map(|name| (*name, Vec::with_capacity(nodes))).collect(),
        };
        for stencils in &self.of_node {
            let stencils = || stencils.iter().filter(|(body, _)| state.has(*body));
            let mut sums = [0.0; 8];
            stencils().for_each(|(_, stencil)| stencil.sum(&mut sums, |e| &tensors[e]));
            let [xx, yy, zz, xy, strain @ ..] = sums.map(|sum| sum / stencils().count().max(1) as f64);
            fields.tensors.push((CauchyStress { xx, yy, zz, xy }, strain));
            if names.is_empty() {
                continue;
            }
            let of_bodies: Vec<(&[&str], Vec<f64>)> = stencils()
                .map(|(body, stencil)| {
                    let names = model.bodies[*body].material.description().shown;
                    let mut sums = vec![0.0; names.len()];
                    if !names.is_empty() {
                        stencil.sum(&mut sums, |e| &shown[e]);
                    }
                    (names, sums)
                })
                .collect();
            for (name, values) in &mut fields.shown {
                let own = |(names, sums): &(&[&str], Vec<f64>)| Some(sums[names.iter().position(|own| own == name)?]);
                let found: Vec<f64> = of_bodies.iter().filter_map(own).collect();
                let mean = found.iter().sum::<f64>() / found.len() as f64;
                values.push(if found.is_empty() { f64::NAN } else { mean });
            }
        }
        fields
    }
}

/// Names of what the laws of the bodies show.
pub fn shown_names(model: &Model) -> Vec<&'static str> {
    let mut names: Vec<&str> = Vec::new();
    for name in model.bodies.iter().flat_map(|body| body.material.description().shown) {
        if !names.contains(name) {
            names.push(name);
        }
    }
    names
}

/// Stress and logarithmic strain at the quadrature points of an element, as [`ElementValues`] take them.
fn stress_and_strain(model: &Model, state: &State, e: usize) -> Vec<f64> {
    let (u, solid) = (model.mesh.vectors(e, &state.displacement), &*model.solid(state, e));
    let (material, memory) = (&*model.body_of(e).material, model.memories.of(e, &state.memory));
    let both = solid.stresses(material, memory, &u).and_then(|stresses| {
        let strains = solid.log_strains(material, memory, &u)?;
        Ok(stresses
            .iter()
            .zip(&strains)
            .flat_map(|(stress, strain)| stress.components().into_iter().chain(*strain))
            .collect())
    });
    both.unwrap_or_else(|_| vec![0.0; 8 * solid.quadrature_points()])
}

/// Returns what the law of an element shows at its quadrature points, as [`ElementValues`] take it.
fn shown(model: &Model, state: &State, e: usize) -> Vec<f64> {
    let (u, solid) = (model.mesh.vectors(e, &state.displacement), &*model.solid(state, e));
    let material = &*model.body_of(e).material;
    let found = solid.shown(material, model.memories.of(e, &state.memory), &u);
    found.unwrap_or_else(|_| vec![0.0; material.description().shown.len() * solid.quadrature_points()])
}

/// Where a value is known, and how: the mean of the values at some points.
struct Sample {
    place: Vector2<f64>,
    /// positions of elements in their patch, and which of their points
    of: Vec<(usize, usize)>,
    /// exponent of the distance, and the other factor, in the weight (2)
    weight: (i32, f64),
}

/// Samples at points of the elements of a patch.
fn points(model: &Model, elements: &[usize], points: impl Fn(usize) -> Vec<QuadraturePoint>) -> Vec<Sample> {
    let of_element = |(k, &e): (usize, &usize)| {
        let element = &model.mesh.elements[e];
        let sample = move |(point, at): (usize, QuadraturePoint)| {
            let shares = element.kind.values(at.at);
            let place = element.nodes.iter().zip(shares).map(|(&node, share)| model.mesh.nodes[node] * share).sum();
            Sample { place, of: vec![(k, point)], weight: (-2, 1.0) }
        };
        points(e).into_iter().enumerate().map(sample)
    };
    elements.iter().enumerate().flat_map(of_element).collect()
}

/// Samples in the middles of edges that two T3 of a patch share.
fn pairs(model: &Model, elements: &[usize]) -> Vec<Sample> {
    let mut sides: Vec<([usize; 2], usize, usize)> = Vec::with_capacity(3 * elements.len());
    for (k, &e) in elements.iter().enumerate() {
        if let [a, b, c] = model.mesh.elements[e].nodes[..] {
            sides.extend([(a, b, c), (b, c, a), (c, a, b)].map(|(i, j, other)| ([i.min(j), i.max(j)], k, other)));
        }
    }
    sides.sort_unstable();
    let at = |node: usize| model.mesh.nodes[node];
    let pair = |two: &[([usize; 2], usize, usize)]| {
        let [([i, j], k, a), (other, l, b)] = *two else { return None };
        let [along, across] = [at(j) - at(i), at(b) - at(a)];
        let (twice_the_middle, area) = (at(i) + at(j), 0.5 * along.perp(&across).abs());
        let off = (at(a) + at(b) - twice_the_middle).norm_squared() / area;
        let sample = Sample {
            place: 0.5 * twice_the_middle,
            of: vec![(k, 0), (l, 0)],
            weight: (-1, 1.0 / (off + PAIRS * PAIRS).sqrt()),
        };
        (other == [i, j]).then_some(sample)
    };
    sides.windows(2).filter_map(pair).collect()
}

/// Elements around a place, ascending, and the fit to their samples.
struct Patch {
    elements: Vec<usize>,
    samples: Vec<Sample>,
    fit: Fit,
}

impl Patch {
    fn new(model: &Model, elements: Vec<usize>, place: Vector2<f64>) -> Self {
        let is_t3 = |&e: &usize| model.mesh.elements[e].kind == ElementKind::T3;
        let mut samples = if elements.iter().all(is_t3) { pairs(model, &elements) } else { Vec::new() };
        if samples.is_empty() {
            samples = points(model, &elements, |e| model.mesh.elements[e].kind.reduced_quadrature());
        }
        let fit = Fit::new(&samples, place, 5);
        Self { elements, samples, fit }
    }
}

/// A value as a weighted sum of samples.
struct Fit {
    weights: Vec<f64>,
    /// number of terms besides the constant: 2 are a linear field
    terms: usize,
    /// sum of the magnitudes of the weights
    amplified: f64,
}

impl Fit {
    /// The fit at a place with the constant and so many terms at most.
    ///
    /// The weighted constant is made orthogonal to the other weighted terms, one after the other; the value at the place is then
    /// the projection of the samples on what is left of it.
    fn new(samples: &[Sample], place: Vector2<f64>, most: usize) -> Self {
        let arms: Vec<Vector2<f64>> = samples.iter().map(|sample| sample.place - place).collect();
        let size = arms.iter().map(|arm| arm.norm()).fold(0.0, f64::max);
        if size == 0.0 {
            return Self { weights: vec![1.0 / arms.len() as f64; arms.len()], terms: 0, amplified: 1.0 };
        }
        let (turned, is_long) = long_axis(&arms);
        let turned = turned.inverse();
        let own: Vec<Vector2<f64>> = arms.iter().map(|arm| turned * arm / size).collect();
        let near =
            |(x, sample): (&Vector2<f64>, &Sample)| x.norm().max(NEAREST).powi(sample.weight.0) * sample.weight.1;
        let near: Vec<f64> = own.iter().zip(samples).map(near).collect();
        let terms: [fn(&Vector2<f64>) -> f64; 5] = [|x| x.x, |x| x.y, |x| x.x * x.x, |x| x.x * x.y, |x| x.y * x.y];
        let mut rest = near.clone();
        let mut fit = Self { weights: projection(&near, &rest), terms: 0, amplified: 1.0 };
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
            if new.is_nan() || new <= NEW * NEW * whole {
                break;
            }
            column.iter_mut().for_each(|value| *value /= new.sqrt());
            let share = -dot(&column, &rest);
            combine(&mut rest, share, &column);
            directions.push(column);
            // Degrees end with the second and the fifth term.
            if !is_long && ![1, 4].contains(&k) {
                continue;
            }
            let weights = projection(&near, &rest);
            let amplified: f64 = weights.iter().map(|weight| weight.abs()).sum();
            if amplified.is_nan() || amplified > AMPLIFIED {
                break;
            }
            fit = Self { weights, terms: k + 1, amplified };
        }
        fit
    }
}

/// The weights of samples, from their nearness and what is left of the weighted constant.
fn projection(near: &[f64], rest: &[f64]) -> Vec<f64> {
    let square = dot(rest, rest);
    near.iter().zip(rest).map(|(near, rest)| near * rest / square).collect()
}

/// Difference of the two extents of a patch, as a share of their sum, below which round-off would choose between them.
const ALIKE: f64 = 1e-6;

/// The rotation from the x axis to the direction in which places extend farthest, and whether there is one.
fn long_axis(arms: &[Vector2<f64>]) -> (Rotation2<f64>, bool) {
    let mean = arms.iter().sum::<Vector2<f64>>() / arms.len() as f64;
    let [mut xx, mut yy, mut xy] = [0.0; 3];
    for arm in arms {
        let from_mean = arm - mean;
        xx += from_mean.x * from_mean.x;
        yy += from_mean.y * from_mean.y;
        xy += from_mean.x * from_mean.y;
    }
    let is_long = f64::hypot(xx - yy, 2.0 * xy) > ALIKE * (xx + yy);
    (Rotation2::new(0.5 * f64::atan2(2.0 * xy, xx - yy)), is_long)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn combine(sums: &mut [f64], share: f64, of: &[f64]) {
    sums.iter_mut().zip(of).for_each(|(sum, of)| *sum += share * of);
}
