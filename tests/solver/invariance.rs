//! What must not change an answer: where a model lies, how it is turned, mirrored, numbered, in which units it is given, which
//! side of a contact is the slave, what else is in the model, on how many threads it runs.
//!
//! Two whole runs: a block pressed on the ground and dragged over it by the time-dependent law, in implicit dynamics; and the
//! same block sheared until slip weakening tears it off, in explicit increments. No reference is needed: each run is compared
//! with itself.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use crate::common::{self, Blocks, Finished, close, finish, neo_hookean, run_through};
use fecontact::contact::force::ContactState;
use fecontact::laws::friction::{Regime, SlipWeakeningParameters, SuperSubloadingParameters};
use fecontact::mesh::InlineMesh;
use fecontact::mesh::section::Section;
use fecontact::model::boundary::Drive;
use fecontact::model::builder::{Builder, Contact, Friction, LoadStep, Support};
use fecontact::model::method::Method;
use fecontact::model::scheme::Scheme;
use fecontact::model::{Model, NewtonSettings};
use serde_json::json;

/// A run, and how its model is given.
#[derive(Clone)]
struct Given {
    explicit: bool,
    /// In the first units; rings have their axis 3 beside the middle of the block
    section: Section,
    method: Method,
    /// Elements along the block and along the ground, and their rows
    divisions: [[usize; 2]; 2],
    /// Whether the ground ends where the block does, and both go on periodically
    layers: bool,
    shift: [f64; 2],
    angle: f64,
    mirrored: bool,
    renumbered: bool,
    swapped: bool,
    /// Young's modulus of a body far away, stretched by 1 %
    bystander: Option<f64>,
    /// What a unit of length, force and time is called now
    units: [f64; 3],
}

/// The models as they are first thought of: coordinates are multiples of 2⁻⁵, and no node of the block on one of the ground.
fn implicit() -> Given {
    Given {
        explicit: false,
        section: Section::PlaneStrain,
        method: Method::GaussToSegment,
        divisions: [[8, 4], [16, 4]],
        layers: false,
        shift: [0.0, 0.0],
        angle: 0.0,
        mirrored: false,
        renumbered: false,
        swapped: false,
        bystander: None,
        units: [1.0, 1.0, 1.0],
    }
}

fn explicit() -> Given {
    Given { explicit: true, ..implicit() }
}

/// The same of plates.
fn plates() -> [Given; 2] {
    [implicit(), explicit()].map(|given| Given { section: Section::PlaneStress { thickness: 0.375 }, ..given })
}

/// The same of rings.
fn rings() -> [Given; 2] {
    [implicit(), explicit()].map(|given| Given { section: Section::Axisymmetric, ..given })
}

/// Both, in every section.
fn all() -> impl Iterator<Item = Given> {
    [implicit(), explicit()].into_iter().chain(plates()).chain(rings())
}

/// Lower left corner, upper right corner.
const BLOCK: [[f64; 2]; 2] = [[-0.5625, 0.0], [0.4375, 0.5]];
const GROUND: [[f64; 2]; 2] = [[-2.0, -1.0], [2.0, 0.0]];
const BYSTANDER: [[f64; 2]; 2] = [[8.0, 0.0], [9.0, 1.0]];

/// Nodes, elements and edges of rectangles.
#[derive(Default)]
struct Mesh {
    nodes: Vec<[f64; 2]>,
    elements: Vec<(String, [usize; 4])>,
    edges: Vec<(String, [usize; 2])>,
}

impl Mesh {
    fn rectangle(&mut self, name: &str, [n, m]: [usize; 2], [low, high]: [[f64; 2]; 2]) {
        let first = self.nodes.len();
        let along = |k: usize, i: usize, n: usize| low[k] + (high[k] - low[k]) * i as f64 / n as f64;
        self.nodes.extend((0..=m).flat_map(|j| (0..=n).map(move |i| [along(0, i, n), along(1, j, m)])));
        let node = |i: usize, j: usize| first + j * (n + 1) + i;
        let cells = (0..m).flat_map(|j| (0..n).map(move |i| (i, j)));
        let corners = |(i, j)| (name.to_string(), [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)]);
        self.elements.extend(cells.map(corners));
        // The body is on the left of every edge.
        self.edges.extend((0..n).map(|i| (format!("{name}_bottom"), [node(i, 0), node(i + 1, 0)])));
        self.edges.extend((0..n).map(|i| (format!("{name}_top"), [node(i + 1, m), node(i, m)])));
        self.edges.extend((0..m).map(|j| (format!("{name}_right"), [node(n, j), node(n, j + 1)])));
        self.edges.extend((0..m).map(|j| (format!("{name}_left"), [node(0, j + 1), node(0, j)])));
    }

    fn mirrored(&mut self) {
        self.nodes.iter_mut().for_each(|node| node[0] = -node[0]);
        self.elements.iter_mut().for_each(|(_, nodes)| nodes.reverse());
        self.edges.iter_mut().for_each(|(_, nodes)| nodes.reverse());
    }

    /// Nodes and elements in another order, far from that of their places.
    fn renumbered(&mut self) {
        let count = self.nodes.len();
        let stride = (count / 3..).find(|stride| gcd(*stride, count) == 1).expect("some number has no common factor");
        let new = |node: usize| node * stride % count;
        let mut nodes = vec![[0.0; 2]; count];
        self.nodes.iter().enumerate().for_each(|(node, at)| nodes[new(node)] = *at);
        self.nodes = nodes;
        self.elements.iter_mut().for_each(|(_, nodes)| *nodes = nodes.map(new));
        self.edges.iter_mut().for_each(|(_, nodes)| *nodes = nodes.map(new));
        let half = self.elements.len() / 2;
        self.elements.rotate_left(half);
        self.elements.reverse();
        self.edges.reverse();
    }

    fn checked(&self) -> fecontact::mesh::Mesh {
        fn grouped<const N: usize>(all: &[(String, [usize; N])]) -> BTreeMap<String, Vec<Vec<usize>>> {
            let mut groups: BTreeMap<String, Vec<Vec<usize>>> = BTreeMap::new();
            all.iter().for_each(|(name, nodes)| groups.entry(name.clone()).or_default().push(nodes.to_vec()));
            groups
        }
        let (elements, edges) = (grouped(&self.elements), grouped(&self.edges));
        InlineMesh { nodes: self.nodes.clone(), elements, edges, ..InlineMesh::default() }.build().expect("a mesh")
    }
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

impl Given {
    /// A vector of the first model, in the axes and units of this one.
    fn vector(&self, [x, y]: [f64; 2], unit: f64) -> [f64; 2] {
        let x = if self.mirrored { -x } else { x };
        let turned = if self.angle == 0.0 { [x, y] } else { common::turned([x, y], self.angle) };
        turned.map(|v| v * unit)
    }

    fn mesh(&self) -> Mesh {
        let mut mesh = Mesh::default();
        mesh.rectangle("block", self.divisions[0], BLOCK);
        let ground = if self.layers { [[BLOCK[0][0], -1.0], [BLOCK[1][0], 0.0]] } else { GROUND };
        mesh.rectangle("ground", self.divisions[1], ground);
        if self.bystander.is_some() {
            mesh.rectangle("bystander", [4, 4], BYSTANDER);
        }
        if self.mirrored {
            mesh.mirrored();
        }
        if self.renumbered {
            mesh.renumbered();
        }
        if self.section.is_axisymmetric() {
            mesh.nodes.iter_mut().for_each(|node| node[0] += 3.0);
        }
        for node in &mut mesh.nodes {
            let [x, y] = if self.angle == 0.0 { *node } else { common::turned(*node, self.angle) };
            *node = [self.units[0] * x + self.shift[0], self.units[0] * y + self.shift[1]];
        }
        mesh
    }

    fn law(&self) -> Friction {
        let [length, _, time] = self.units;
        match self.explicit {
            true => SlipWeakeningParameters::new(0.5, 0.2, 2e-4 * length).into(),
            false => SuperSubloadingParameters {
                kappa: 20.0 / length,
                xi: 0.05 / time,
                structure: Some(1.5),
                ..SuperSubloadingParameters::new(0.4, 0.2, 2000.0 / length)
            }
            .into(),
        }
    }

    fn press(&self) -> LoadStep {
        let [length, _, time] = self.units;
        let press = LoadStep::new("press", time).scheme(Scheme::Static).dt(0.5 * time).fix("ground_bottom");
        let press = press.support(self.top([0.0, -2e-3]));
        match self.bystander {
            None => press,
            Some(_) => {
                let [x, y] = self.vector([0.0, -0.01], length);
                press.fix("bystander_bottom").support(Support::on("bystander_top").ux(x).uy(y))
            }
        }
    }

    /// The top of the block on its way to a place.
    fn top(&self, way: [f64; 2]) -> Support {
        let [x, y] = self.vector(way, self.units[0]);
        Support::on("block_top").ux(x).uy(y)
    }

    fn steps(&self, model: Builder) -> Builder {
        let [length, _, time] = self.units;
        let model = model.step(self.press());
        if !self.explicit {
            let drag = LoadStep::new("drag", time).scheme(Scheme::Hht { alpha: -0.1 }).dt(0.0625 * time);
            return model.step(drag.support(self.top([4e-3, -2e-3])));
        }
        let shear = LoadStep::new("shear", time).scheme(Scheme::Static).dt(0.25 * time);
        // The top is pulled on ten times slower than shear waves run, and the bottom of the block tears off from one end.
        let [vx, vy] = self.vector([0.01, 0.0], length / time);
        let tear = LoadStep::new("tear", 0.5 * time).scheme(Scheme::Explicit { safety: 0.9 }).dt(0.5 * time);
        let pulled = Support::on("block_top").ux(Drive::Rate(vx)).uy(Drive::Rate(vy));
        model.step(shear.support(self.top([8e-4, -2e-3]))).step(tear.support(pulled))
    }

    fn model(&self) -> Builder {
        let [length, force, time] = self.units;
        let material =
            |e: f64| neo_hookean(e * force / length.powi(2), 0.3, e / 100.0 * force * time.powi(2) / length.powi(4));
        let section = match self.section {
            Section::PlaneStress { thickness } => Section::PlaneStress { thickness: thickness * length },
            section => section,
        };
        let mut model = Model::builder(self.mesh().checked()).section(section);
        model = model.body("block", material(100.0));
        if let Some(stiffness) = self.bystander {
            model = model.body("bystander", material(stiffness));
        }
        model = model.body("ground", material(100.0));
        let (slave, master) =
            if self.swapped { ("ground_top", "block_bottom") } else { ("block_bottom", "ground_top") };
        if self.layers {
            model = model.periodic("block_left", "block_right").periodic("ground_left", "ground_right");
        }
        let model = model.contact(Contact::new("base", slave, master, self.law()).method(self.method));
        let newton = NewtonSettings { tolerance: 1e-12, ..NewtonSettings::default() };
        self.steps(model.newton(newton).interval(0.0625 * time))
    }

    fn run(&self) -> Answer {
        let run = run_through(self.model());
        let [length, force, time] = self.units;
        let [normal, along] = [[0.0, 1.0], [1.0, 0.0]].map(|axis| self.vector(axis, 1.0));
        let unit = if self.section == Section::PlaneStrain { force / length } else { force };
        let component = |f: [f64; 2], axis: [f64; 2]| (f[0] * axis[0] + f[1] * axis[1]) / unit;
        let states = run.states.iter().map(|state| {
            let f = run.reaction("block_top", state);
            let friction = state.contacts[0].iter().map(|point| &point.friction);
            let pressures = friction.clone().map(|friction| friction.pressure / (force / length.powi(2))).collect();
            let tractions = friction.map(|friction| friction.traction / (force / length.powi(2))).collect();
            let [mut pressures, mut tractions]: [Vec<f64>; 2] = [pressures, tractions];
            if self.mirrored {
                pressures.reverse();
                tractions.reverse();
                tractions.iter_mut().for_each(|q| *q = -*q);
            }
            Instant {
                time: state.time / time,
                force: [component(f, along), component(f, normal)],
                pressures,
                tractions,
            }
        });
        Answer { states: states.collect(), run }
    }
}

/// What a run found, in the axes and units of the first model.
struct Answer {
    states: Vec<Instant>,
    run: Finished,
}

#[derive(Clone, Debug, PartialEq)]
struct Instant {
    time: f64,
    /// On the top of the block, along the ground and normal to it, in plane strain per thickness
    force: [f64; 2],
    /// Of all contact points along the slave
    pressures: Vec<f64>,
    tractions: Vec<f64>,
}

impl Answer {
    /// Largest difference of forces, relative to the largest force, and of tractions, relative to the largest pressure.
    #[track_caller]
    fn away_from(&self, other: &Self) -> f64 {
        assert_eq!(self.states.len(), other.states.len(), "increments");
        let tractions = |answer: &Self| {
            let all = |state: &Instant| [&state.pressures[..], &state.tractions[..]].concat();
            answer.states.iter().flat_map(all).collect::<Vec<_>>()
        };
        apart(&tractions(self), &tractions(other)).max(self.force_away_from(other))
    }

    fn force_away_from(&self, other: &Self) -> f64 {
        let forces = |answer: &Self| answer.states.iter().flat_map(|state| state.force).collect::<Vec<_>>();
        apart(&forces(self), &forces(other))
    }

    /// The runs must show what they are meant for: sticking, slipping and opening points, and slip that goes on.
    fn is_worth_comparing(&self) {
        let last = self.run.last();
        let slips = last.contacts[0].iter().map(|point| point.friction.plastic_slip.abs());
        let (least, most) =
            slips.fold((f64::INFINITY, 0.0f64), |(least, most), slip| (least.min(slip), most.max(slip)));
        // Plates and rings slip more alike, but their surfaces do not slide as rigid ones would.
        let alike = match self.run.model.mesh.section {
            Section::PlaneStress { .. } => 0.85,
            Section::Axisymmetric => 0.95,
            _ => 0.8,
        };
        assert!(most > 1e-5 && least < alike * most, "slip is not uniform: {least:e} to {most:e}");
        let [along, normal] = self.states.last().expect("states").force;
        assert!(along.abs() > 0.1 * normal.abs(), "friction holds something: {along:e}, {normal:e}");
    }
}

/// Largest difference, relative to the largest value.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    common::distance(a, b) / a.iter().fold(0.0, |most: f64, v| most.max(v.abs()))
}

#[track_caller]
fn same(first: &Given, other: &Given, tolerance: f64) {
    let (a, b) = (first.run(), other.run());
    a.is_worth_comparing();
    let apart = a.away_from(&b);
    assert!(apart <= tolerance, "the answers differ by {apart:e}");
}

/// By 2²³, the size of map coordinates in metres. All coordinates are multiples of 2⁻²⁰, so the mesh is exactly the same. A gap
/// taken as a difference of positions x = X + u would lose 2⁻²⁹ of a unit, two thousandths of these displacements.
#[test]
fn moved_far_from_the_origin() {
    let shift = [8_388_608.0, -8_388_608.0];
    for first in [
        implicit(),
        explicit(),
        Given { method: Method::Mortar, ..implicit() },
        Given { method: Method::NodeToSegment, ..implicit() },
    ]
    .into_iter()
    .chain(plates())
    {
        same(&first, &Given { shift, ..first.clone() }, 1e-9);
    }
    // Rings along their axis alone.
    for first in rings().into_iter().chain(rings().map(|given| Given { method: Method::Mortar, ..given })) {
        same(&first, &Given { shift: [0.0, shift[1]], ..first.clone() }, 1e-9);
    }
}

#[test]
fn turned() {
    for first in [implicit(), explicit()].into_iter().chain(plates()) {
        same(&first, &Given { angle: 37.0 / 180.0 * PI, ..first.clone() }, 1e-9);
    }
}

#[test]
fn mirrored() {
    for first in [implicit(), explicit(), Given { method: Method::Mortar, ..implicit() }] {
        same(&first, &Given { mirrored: true, ..first.clone() }, 1e-9);
    }
}

#[test]
fn renumbered() {
    for first in all() {
        same(&first, &Given { renumbered: true, ..first.clone() }, 1e-9);
    }
}

/// The models are in mm and N; the same in m and N, and in km and GN, with the time in years.
#[test]
fn in_other_units() {
    for first in all() {
        same(&first, &Given { units: [1e-3, 1.0, 1.0], ..first.clone() }, 1e-9);
        same(&first, &Given { units: [1e-6, 1e-9, 1.0 / 3.15e7], ..first.clone() }, 1e-9);
    }
}

/// Powers of four scale without round-off, also under a root: nothing in the program has a unit of its own.
#[test]
fn in_units_that_are_powers_of_four_bit_by_bit() {
    for first in all() {
        let other = Given { units: [2f64.powi(-10), 2f64.powi(20), 2f64.powi(-6)], ..first.clone() };
        let same = first.run().states == other.run().states;
        assert!(same, "{:?}, explicit {}: a number has a unit of its own", first.section, first.explicit);
    }
}

/// A body that touches nothing, a million times softer and stiffer, stretched by 1 %.
#[test]
fn beside_a_body_that_touches_nothing() {
    for first in all() {
        for stiffness in [1e-4, 1e8] {
            same(&first, &Given { bystander: Some(stiffness), ..first.clone() }, 1e-9);
        }
    }
}

/// Two periodic layers by mortar, node on node: the interface stays straight, so that both sides have the same normals.
#[test]
fn slave_and_master_swapped_on_matching_layers() {
    for explicit in [false, true] {
        let layers =
            Given { method: Method::Mortar, layers: true, divisions: [[8, 4], [8, 8]], explicit, ..implicit() };
        let [first, other] = [false, true].map(|swapped| Given { swapped, ..layers.clone() }.run());
        let apart = first.force_away_from(&other);
        assert!(apart < 1e-9, "explicit: {explicit}: the forces differ by {apart:e}");
    }
}

/// The dragged block by mortar: normals and averages are the slave's, and differ from the master's as the deformed edges do.
/// Both sides have elements of the same depth, and so the same default penalty. Measured:
/// 1.5e-3, 1.1e-3 and 4e-4 of the largest force.
#[test]
fn slave_and_master_swapped_on_a_dragged_block() {
    let difference = |fine: usize| {
        let divisions = [[8 * fine, 4 * fine], [16 * fine, 8 * fine]];
        let [first, other] =
            [false, true].map(|swapped| Given { method: Method::Mortar, divisions, swapped, ..implicit() }.run());
        first.force_away_from(&other)
    };
    let [coarse, middle, fine] = [1, 2, 4].map(difference);
    let told = format!("the forces differ by {coarse:e}, {middle:e} and {fine:e} from mesh to finer mesh");
    assert!(coarse < 0.01 && middle < 0.9 * coarse && fine < 0.9 * middle, "{told}");
}

/// On any number of threads, bit by bit.
#[test]
fn on_one_thread_or_more() {
    for first in all() {
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of threads");
            pool.install(|| first.run().states)
        };
        assert!(on(1) == on(3));
    }
}

/// Rate-and-state friction that is measured at another rate V₀, f₀ + (a − b) ln(V₀'/V₀) with the same θ, is the same law: so
/// are forces, and what slips. The block sticks at first, and slides as a whole at the end.
#[test]
fn what_slips_does_not_depend_on_the_reference_rate() {
    let slides = |reference: f64| {
        let (a, b) = (0.01, 0.005);
        let f_0 = 0.6 + (a - b) * (reference / 1e-6f64).ln();
        let run = finish(&json!({
            "mesh": Blocks::default().rectangle("slab", [8, 4], [0.0, 0.0], [1.0, 0.5]).json(),
            "bodies": {"slab": {"material": {"model": "linear", "E": 1000, "nu": 0.3}}},
            "contacts": {"base": {
                "slave": "slab_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
                "friction": {"law": "rate_and_state", "f_0": f_0, "V_0": reference, "a": a, "b": b, "D_c": 1e-4,
                             "theta": 100},
                "initial": {"pressure": 1, "balanced": true},
            }},
            "newton": {"tolerance": 1e-11},
            "steps": [{"name": "slide", "duration": 2000, "scheme": "static", "dt": {"initial": 50},
                       "supports": [{"on": "slab_top", "ux": {"rate": 1e-6}, "uy": 0}]}],
        }));
        run.states.into_iter().map(|state| state.contacts[0].clone()).collect::<Vec<_>>()
    };
    let first = slides(1e-6);
    let regimes = |states: &[ContactState]| states.iter().map(ContactState::regime).collect::<Vec<_>>();
    for reference in [1e-9, 1e-3] {
        let other = slides(reference);
        assert_eq!(first.len(), other.len());
        for (states, others) in first.iter().zip(&other) {
            assert_eq!(regimes(states), regimes(others), "V₀ = {reference}");
            for (state, other) in states.iter().zip(others) {
                close("q", other.friction.traction, state.friction.traction, 1e-8);
                close("p", other.friction.pressure, state.friction.pressure, 1e-8);
            }
        }
    }
    assert!(regimes(&first[0]).contains(&Regime::Stick), "{:?}", regimes(&first[0]));
    let last = regimes(&first[first.len() - 1]);
    assert!(!last.contains(&Regime::Stick) && last.contains(&Regime::Slip), "{last:?}");
}
