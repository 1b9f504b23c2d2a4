//! Small models for tests that drive the whole solver: meshes of blocks, models from code and from JSON, runs that keep
//! every state.
#![allow(dead_code, unused_imports, reason = "each test program uses a part")]

#[cfg(feature = "cli")]
mod cases;
pub mod store;
pub mod warnings;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use fecontact::laws::bulk::{ElasticConstants, Material, MaterialParameters};
use fecontact::mesh::{InlineMesh, Mesh};
use fecontact::model::boundary::{Drive, Expression};
use fecontact::model::builder::{Builder, MasterSide};
use fecontact::model::{Model, State};
use fecontact::run::{Attempt, Error, Observer, RunReport, run};
use nalgebra::{Rotation2, Vector2};
use serde_json::{Value, json};

#[cfg(feature = "cli")]
pub use cases::*;

/// A mesh of blocks of Q4 elements, and of rings. A block named `b` brings the groups `b` (elements), `b_bottom`, `b_right`,
/// `b_top` and `b_left` (edges).
#[derive(Clone, Debug, Default)]
pub struct Blocks(pub InlineMesh);

impl std::ops::Deref for Blocks {
    type Target = InlineMesh;

    fn deref(&self) -> &InlineMesh {
        &self.0
    }
}

impl std::ops::DerefMut for Blocks {
    fn deref_mut(&mut self) -> &mut InlineMesh {
        &mut self.0
    }
}

impl Blocks {
    /// Add a block of n × m elements, `map` from the unit square to the plane.
    pub fn block(self, name: &str, divisions: [usize; 2], map: impl Fn(f64, f64) -> [f64; 2]) -> Self {
        Self(self.0.block(name, divisions, map))
    }

    /// Add a rectangle from `low` to `high`.
    pub fn rectangle(self, name: &str, divisions: [usize; 2], low: [f64; 2], high: [f64; 2]) -> Self {
        Self(self.0.rectangle(name, divisions, low, high))
    }

    /// Add a whole ring of n × m elements with the groups `b`, `b_inside` and `b_outside`.
    pub fn ring(mut self, name: &str, [n, m]: [usize; 2], [inner, outer]: [f64; 2]) -> Self {
        let first = self.nodes.len();
        let node = |i: usize, j: usize| first + j * n + i % n;
        for j in 0..=m {
            let radius = inner + (outer - inner) * j as f64 / m as f64;
            let angle = |i: usize| std::f64::consts::TAU * i as f64 / n as f64;
            self.nodes.extend((0..n).map(|i| [radius * angle(i).cos(), radius * angle(i).sin()]));
        }
        let elements = (0..n * m)
            .map(|e| (e % n, e / n))
            .map(|(i, j)| vec![node(i, j), node(i, j + 1), node(i + 1, j + 1), node(i + 1, j)])
            .collect();
        let inside = (0..n).map(|i| vec![node(i + 1, 0), node(i, 0)]).collect();
        let outside = (0..n).map(|i| vec![node(i, m), node(i + 1, m)]).collect();
        self.elements.insert(name.into(), elements);
        self.edges.insert(format!("{name}_inside"), inside);
        self.edges.insert(format!("{name}_outside"), outside);
        self
    }

    /// All turned about the origin, counter-clockwise.
    pub fn turned(mut self, angle: f64) -> Self {
        for node in &mut self.nodes {
            *node = turned(*node, angle);
        }
        self
    }

    /// The mesh as a case file has it.
    pub fn json(&self) -> Value {
        json!({"nodes": self.nodes, "elements": self.elements, "edges": self.edges})
    }

    /// The mesh.
    pub fn mesh(&self) -> Mesh {
        self.build().expect("a mesh")
    }
}

/// A file of the repository.
pub fn repository(file: impl AsRef<Path>) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join(file)
}

/// Constants of an elastic material.
pub fn elastic(young: f64, poisson: f64, density: f64) -> ElasticConstants {
    ElasticConstants::new(young, poisson).density(density)
}

/// A neo-Hookean material.
pub fn neo_hookean(young: f64, poisson: f64, density: f64) -> Box<dyn Material> {
    MaterialParameters::NeoHookean(elastic(young, poisson, density)).build().expect("good constants")
}

/// A material of Saint Venant and Kirchhoff.
pub fn saint_venant_kirchhoff(young: f64, poisson: f64, density: f64) -> Box<dyn Material> {
    MaterialParameters::SaintVenantKirchhoff(elastic(young, poisson, density)).build().expect("good constants")
}

/// A linear material.
pub fn linear(young: f64, poisson: f64, density: f64) -> Box<dyn Material> {
    MaterialParameters::Linear(elastic(young, poisson, density)).build().expect("good constants")
}

/// The half-space below the line y = 0.
pub fn floor() -> MasterSide {
    MasterSide::Plane { point: [0.0, 0.0], normal: [0.0, 1.0] }
}

/// An object with the keys of another as well, which replace its own.
pub fn with(mut object: Value, more: &Value) -> Value {
    object.as_object_mut().expect("an object").extend(more.as_object().expect("keys").clone());
    object
}

/// What is made on so many threads.
pub fn on_threads<T: Send>(threads: usize, make: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of threads").install(make)
}

/// A drive by an expression.
pub fn expression(text: &str) -> Drive {
    Drive::Expression(Expression::parse(text).expect("an expression"))
}

/// Build a model from code and run it to its end.
pub fn run_through(builder: Builder) -> Finished {
    finished(builder.build().unwrap_or_else(|error| panic!("{error}")))
}

/// The same mesh of quadratic elements; `middle` places a node between two corners.
pub fn quadratic(mesh: &Value, middle: impl Fn([f64; 2], [f64; 2]) -> [f64; 2]) -> Value {
    let mut nodes: Vec<[f64; 2]> = serde_json::from_value(mesh["nodes"].clone()).expect("places");
    let mut middles = std::collections::BTreeMap::new();
    let mut refine = |groups: &Value, closed: bool| -> Value {
        let mut groups: std::collections::BTreeMap<String, Vec<Vec<usize>>> =
            serde_json::from_value(groups.clone()).expect("groups");
        for corners in groups.values_mut().flatten() {
            let sides = if closed { corners.len() } else { 1 };
            for k in 0..sides {
                let ends = [corners[k], corners[(k + 1) % (sides.max(2))]];
                let key = [ends[0].min(ends[1]), ends[0].max(ends[1])];
                corners.push(*middles.entry(key).or_insert_with(|| {
                    nodes.push(middle(nodes[key[0]], nodes[key[1]]));
                    nodes.len() - 1
                }));
            }
        }
        json!(groups)
    };
    let (elements, edges) = (refine(&mesh["elements"], true), refine(&mesh["edges"], false));
    json!({"nodes": nodes, "elements": elements, "edges": edges})
}

/// A column of two bodies that share nodes, the first up to 2 and the other from there to 3: Q4 with rollers at `side`, `n` of them to a
/// length of 1, with `bottom`, `top` and a name for the face between.
pub fn column(n: usize, width: f64, bodies: [&str; 2], between: Option<&str>) -> Value {
    let block = |body: &str, low: f64, high: f64, names: [Option<&str>; 4]| {
        let rows = ((high - low) * n as f64).round();
        json!({"body": body, "corners": [[0, low], [width, low], [width, high], [0, high]], "elements": [1, rows], "sides": names})
    };
    json!({"joined": [bodies], "blocks": [
        block(bodies[0], 0.0, 2.0, [Some("bottom"), Some("side"), between, Some("side")]),
        block(bodies[1], 2.0, 3.0, [None, Some("side"), Some("top"), Some("side")]),
    ]})
}

/// Half way between two points.
pub fn half_way(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|i| 0.5 * (a[i] + b[i]))
}

/// Half way between two points on or inside a circle about the origin, on an arc if both have the same radius.
pub fn half_way_round(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    let (a, b) = (Vector2::from(a), Vector2::from(b));
    let (middle, radius) = (0.5 * (a + b), 0.5 * (a.norm() + b.norm()));
    (middle * (radius / middle.norm())).into()
}

/// A vector turned counter-clockwise.
pub fn turned(v: [f64; 2], angle: f64) -> [f64; 2] {
    (Rotation2::new(angle) * Vector2::from(v)).into()
}

/// Keeps every accepted state; counts the attempts that were not accepted.
#[derive(Default)]
pub struct Record {
    pub states: Vec<State>,
    /// Newton iterations of each
    pub iterations: Vec<usize>,
    /// Share of the forces that stabilize in each
    pub stabilization: Vec<f64>,
    pub failed: usize,
}

impl Observer for Record {
    fn record(&mut self, _: &Model, attempt: &Attempt) -> Result<(), Error> {
        match attempt.accepted {
            Some(state) => {
                self.states.push(state.clone());
                self.iterations.push(attempt.iterations.len());
                self.stabilization.push(attempt.iterations.last().map_or(0.0, |last| last.stabilization));
            }
            None => self.failed += 1,
        }
        Ok(())
    }
}

/// What a run left behind.
pub struct Finished {
    pub model: Arc<Model>,
    pub states: Vec<State>,
    /// Newton iterations of each increment
    pub iterations: Vec<usize>,
    /// Share of the forces that stabilize in each increment
    pub stabilization: Vec<f64>,
    pub report: RunReport,
}

impl Finished {
    pub fn last(&self) -> &State {
        self.states.last().expect("at least one increment")
    }

    /// The state at a time that an increment ended on.
    pub fn at(&self, time: f64) -> &State {
        let at = |state: &&State| (state.time - time).abs() < 1e-9 * (1.0 + time);
        self.states.iter().find(at).unwrap_or_else(|| panic!("no increment ended at {time}"))
    }

    /// Nodes of a group.
    pub fn nodes(&self, group: &str) -> Vec<usize> {
        self.model.mesh.nodes_of(self.model.mesh.group(group).expect("a group of the test's mesh"))
    }

    /// Sum of the reactions on a group.
    pub fn reaction(&self, group: &str, state: &State) -> [f64; 2] {
        [0, 1].map(|i| self.nodes(group).iter().map(|&node| state.reaction[2 * node + i]).sum())
    }

    /// Normal and tangential force of the first contact, ∫ p ds and ∫ q ds.
    pub fn contact_force(&self, state: &State) -> [f64; 2] {
        state.contacts[0].iter().fold([0.0, 0.0], |[n, t], contact| {
            [n + contact.length * contact.friction.pressure, t + contact.length * contact.friction.traction]
        })
    }
}

/// Run a model to its end.
pub fn finished(model: Model) -> Finished {
    let mut record = Record::default();
    let model = Arc::new(model);
    let (report, result) = run(&model, &mut [&mut record]);
    result.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(record.failed, report.cutbacks + report.rejected);
    assert_eq!(report.given_up.values().sum::<usize>(), record.failed, "{:?}", report.given_up);
    let Record { states, iterations, stabilization, .. } = record;
    Finished { model, states, iterations, stabilization, report }
}

/// Largest |a − b|.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).fold(0.0, |largest, (a, b)| largest.max((a - b).abs()))
}

/// Assert |a − b| ≤ tolerance, and say what was compared.
#[track_caller]
pub fn close(what: &str, a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance, "{what}: {a:e}, expected {b:e} ± {tolerance:e} (off by {:e})", a - b);
}

/// Columns of a table by name; NaN is what is no number.
pub type Columns = BTreeMap<String, Vec<f64>>;

/// Reads the columns of a table, each of a name of its own.
pub fn table(path: impl AsRef<Path>) -> Columns {
    let text = std::fs::read_to_string(path).expect("a table");
    let names = text.lines().next().expect("a header").split(',').enumerate();
    let cell = |line: &str, k: usize| line.split(',').nth(k).and_then(|cell| cell.parse().ok()).unwrap_or(f64::NAN);
    let columns: Columns = names
        .clone()
        .map(|(k, name)| (name.to_owned(), text.lines().skip(1).map(|line| cell(line, k)).collect()))
        .collect();
    assert_eq!(columns.len(), names.count(), "two columns have one name");
    columns
}
