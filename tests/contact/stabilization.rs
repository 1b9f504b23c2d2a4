//! Bodies that nothing holds until contact does: steered into contact by a stabilization that is gone at the end of the step.

use std::sync::Arc;

use crate::common::{self, Blocks, Finished, close, floor, linear, neo_hookean, run_through};
use fecontact::laws::friction::{CoulombParameters, Frictionless};
use fecontact::mesh::InlineMesh;
use fecontact::model::builder::{Builder, Change, Components, Contact, IncrementSettings, Load, LoadStep, MasterSide};
use fecontact::model::{Model, State};
use fecontact::run::run;

const PRESSURE: f64 = 2.0;

/// The names of a body's bottom and top.
fn sides(body: &str) -> [String; 2] {
    ["bottom", "top"].map(|side| format!("{body}_{side}"))
}

/// A column of blocks 1 × 0.5, E = 1000, ν = 0, with gaps between them, over ground that is held; pressure on the last one
/// and nothing else. Each block is turned about its lower left corner.
fn column(blocks: usize, turn: f64, fall: LoadStep) -> Builder {
    let names: Vec<String> = (0..blocks).map(|k| format!("block{k}")).collect();
    let mut mesh = Blocks::default().rectangle("ground", [5, 2], [-0.2, -0.5], [1.2, 0.0]);
    for (k, name) in names.iter().enumerate() {
        let bottom = (k + 1) as f64 * 0.02 + k as f64 * 0.5;
        mesh = mesh.block(name, [3 + k, 2], |s, t| {
            let [x, y] = common::turned([s, 0.5 * t], turn);
            [x, bottom + y]
        });
    }
    let material = || neo_hookean(1000.0, 0.0, 0.0);
    let mut model = Model::builder(mesh.mesh()).body("ground", material());
    let mut below = "ground";
    for (k, name) in names.iter().enumerate() {
        let ([bottom, _], [_, top]) = (sides(name), sides(below));
        let contact = Contact::new(format!("under{k}"), bottom, MasterSide::Group(top), CoulombParameters::new(0.5));
        model = model.body(name, material()).contact(contact);
        below = name;
    }
    model.step(fall.fix("ground_bottom").load(Load::pressure(sides(below)[1].as_str(), PRESSURE)))
}

/// A step that falls in increments of this length.
fn fall(dt: impl Into<IncrementSettings>) -> LoadStep {
    LoadStep::new("fall", 2.0).dt(dt)
}

/// Normal force of every contact.
fn normal_forces(run: &Finished, state: &State) -> Vec<f64> {
    let x = run.model.configuration(&state.displacement);
    let mut forces = vec![0.0; run.model.contacts.len()];
    for ((force, pair), states) in forces.iter_mut().zip(&run.model.contacts).zip(&state.contacts) {
        for (point, contact) in pair.points.iter().zip(states) {
            *force += point.current_length(&x) * contact.friction.pressure;
        }
    }
    forces
}

/// Every contact carries the whole load, to Newton's tolerance and the change of the loaded length; nothing else holds the
/// blocks. Flat or tilted by a degree, one block or three.
#[test]
fn free_blocks_settle_on_each_other() {
    for (blocks, turn) in [(1, 0.0), (3, 0.0), (1, 0.0175)] {
        let run = run_through(column(blocks, turn, fall(0.1).stabilize(1e-3)));
        let last = run.last();
        for force in normal_forces(&run, last) {
            close(&format!("{blocks} blocks turned by {turn}: force"), force, PRESSURE, 1e-3 * PRESSURE);
        }
        let ground = run.reaction("ground_bottom", last);
        close("reaction", ground[1], PRESSURE, 1e-3 * PRESSURE);
        assert!(run.report.stabilization_work > 0.0);
        let shares = &run.stabilization;
        assert!(shares[0] > 1e-3, "the first increment is not stabilized: {shares:?}");
        assert_eq!(shares.last(), Some(&0.0), "the last increment is still stabilized");
    }
}

/// Without the stabilization the matrix is singular, and the message says what to do. On a smooth rigid plane a stabilized
/// block is still free along x when the stabilization has gone: that is told, not taken for an answer.
#[test]
fn what_contact_does_not_hold_is_named() {
    let text = why(column(1, 0.0, fall(0.1)));
    assert!(text.contains("nothing resists the motion of body `block0`") && text.contains("`stabilize`"), "{text}");
    let pressed = Load::traction("block0_top", Change::To(Components { x: None, y: Some((-PRESSURE).into()) }));
    let smooth = Model::builder(Blocks::default().rectangle("block0", [3, 2], [0.0, 0.02], [1.0, 0.52]).mesh())
        .body("block0", neo_hookean(1000.0, 0.0, 0.0))
        .contact(Contact::new("under0", "block0_bottom", floor(), Frictionless))
        .step(fall(0.1).stabilize(1e-3).load(pressed));
    let text = why(smooth);
    assert!(text.contains("nothing resists the motion of body `block0` along x"), "{text}");
}

/// Why a run stops.
fn why(model: Builder) -> String {
    let model = Arc::new(model.build().expect("a good model"));
    run(&model, &mut []).1.err().map(|error| error.to_string()).expect("a body floats")
}

/// A step that asks for one increment has two: the dashpots fade over the first, and nothing but contact holds the block
/// in the second. A shortest increment longer than half of the step gives way as well.
#[test]
fn a_single_increment_is_stabilized_too() {
    let two = IncrementSettings::from(2.0);
    let cut = IncrementSettings { max: Some(2.0), ..IncrementSettings::from(1.5) };
    for dt in [two, cut, IncrementSettings { min: Some(2.0), ..two }] {
        // A tilted block falls past the ground in its first iterate: it needs increments that may be cut.
        let tilted = dt.min.is_none().then_some((1, 0.0175));
        for (blocks, turn) in [(1, 0.0), (2, 0.0)].into_iter().chain(tilted) {
            let run = run_through(column(blocks, turn, fall(dt).stabilize(1e-3)));
            for force in normal_forces(&run, run.last()) {
                close(&format!("{blocks} blocks turned by {turn}, {dt:?}"), force, PRESSURE, 1e-3 * PRESSURE);
            }
            let shares = &run.stabilization;
            assert!(shares[0] > 0.0 && shares.last() == Some(&0.0), "{dt:?}: {shares:?}");
        }
    }
}

/// `count` blocks of one element in a row on ground of one element that is held. They stick to it, but for two: one has no
/// friction, or is lifted off the ground.
fn row(count: usize, smooth: Option<usize>, lifted: Option<usize>) -> Builder {
    let mut mesh = InlineMesh::default().rectangle("ground", [1, 1], [-1.0, -1.0], [2.0 * count as f64, 0.0]);
    for k in 0..count {
        let (left, bottom) = (2.0 * k as f64, if lifted == Some(k) { 0.1 } else { 0.0 });
        mesh = mesh.rectangle(&format!("b{k}"), [1, 1], [left, bottom], [left + 1.0, bottom + 1.0]);
        let group = if smooth == Some(k) { "smooth" } else { "rough" };
        mesh.edges.entry(group.into()).or_default().push(vec![4 + 4 * k, 5 + 4 * k]);
    }
    let material = || linear(1000.0, 0.3, 0.0);
    let mut model = Model::builder(mesh.build().expect("a mesh")).body("ground", material());
    model = model.contact(Contact::new("rough", "rough", "ground_top", CoulombParameters::new(0.5)));
    if smooth.is_some() {
        model = model.contact(Contact::new("smooth", "smooth", "ground_top", Frictionless));
    }
    let mut press = LoadStep::new("press", 1.0).dt(1.0).fix("ground");
    for k in 0..count {
        model = model.body(format!("b{k}"), material());
        press = press.load(Load::traction(format!("b{k}_top").as_str(), [0.0, -1e-3]));
    }
    model.step(press)
}

/// One body of a thousand that floats is found, beside the group that all others form through the ground, and within it.
/// Singular values of the 3003 motions together would take hours, those of the three of a lone body take nothing.
#[test]
fn one_of_a_thousand_bodies_floats() {
    for (smooth, lifted, expected) in [
        (Some(637), None, "nothing resists the motion of body `b637` along x;"),
        (None, Some(637), "nothing resists the motion of body `b637` "),
    ] {
        let text = why(row(1000, smooth, lifted));
        assert!(text.contains(expected), "{text}");
        assert_eq!(
            text.matches("body `").count(),
            if lifted.is_some() { text.matches("b637").count() } else { 1 },
            "{text}"
        );
    }
}

/// Two materials with nodes in common are one part: it floats as a whole, and is named so.
#[test]
fn bodies_that_share_nodes_float_together() {
    let mesh = InlineMesh {
        nodes: vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 1.0], [1.0, 1.0], [2.0, 1.0]],
        elements: [("left".into(), vec![vec![0, 1, 4, 3]]), ("right".into(), vec![vec![1, 2, 5, 4]])].into(),
        edges: [("bottom".into(), vec![vec![0, 1], vec![1, 2]]), ("top".into(), vec![vec![3, 4], vec![4, 5]])].into(),
        ..InlineMesh::default()
    };
    let material = || linear(1000.0, 0.3, 0.0);
    let model = Model::builder(mesh.build().expect("a mesh"))
        .body("left", material())
        .body("right", material())
        .contact(Contact::new("base", "bottom", floor(), Frictionless))
        .step(LoadStep::new("press", 1.0).load(Load::traction("top", [0.0, -1.0])));
    let text = why(model);
    assert!(text.contains("nothing resists the motion of bodies `left` and `right` along x;"), "{text}");
}
