//! Bodies that hang on others: by nodes that they share, periodic sides, plates and hinges. Static steps hold them by what holds
//! the others, and what is still free is told.

use crate::common::{Blocks, close, finish, half_way, linear, model, quadratic, refusal, run_through};
use fecontact::mesh::InlineMesh;
use fecontact::model::Model;
use fecontact::model::builder::{Builder, Load, LoadStep, Place, Plate, Support};
use serde_json::{Value, json};

/// Young's modulus of body k.
fn young(k: usize) -> f64 {
    [100.0, 400.0][k % 2]
}

/// A row of unit squares, each a body that shares a side with the one before, in a mesh of Q4.
fn row(count: usize) -> Value {
    let nodes: Vec<[f64; 2]> = (0..=count).flat_map(|i| [[i as f64, 0.0], [i as f64, 1.0]]).collect();
    let square = |i: usize| vec![2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1];
    let elements: serde_json::Map<String, Value> =
        (0..count).map(|i| (format!("body{i}"), json!([square(i)]))).collect();
    json!({"nodes": nodes, "elements": elements, "edges": {"left": [[1, 0]], "right": [[2 * count, 2 * count + 1]]}})
}

/// The same of two triangles a square.
fn halved(mesh: &Value) -> Value {
    let mut halved = mesh.clone();
    for squares in halved["elements"].as_object_mut().expect("bodies").values_mut() {
        let [a, b, c, d] = serde_json::from_value(squares[0].clone()).expect("a square");
        *squares = json!([[a, b, c], [a, c, d]] as [[usize; 3]; 2]);
    }
    halved
}

/// Bodies of E = 100 and 400 by turns and ν = 0, pulled by a traction of 2.
fn pulled(mesh: Value, supports: Value) -> Value {
    let count = mesh["elements"].as_object().expect("bodies").len();
    let body = |k: usize| json!({"material": {"model": "linear", "E": young(k), "nu": 0, "density": 1}});
    let bodies: serde_json::Map<String, Value> = (0..count).map(|k| (format!("body{k}"), body(k))).collect();
    json!({
        "mesh": mesh, "bodies": bodies,
        "steps": [{"name": "pull", "duration": 1, "dt": {"initial": 1}, "supports": supports,
                   "loads": [{"on": "right", "traction": {"x": 2}}]}]
    })
}

/// Every body is stretched by σ/E: the end moves by Σ σ L/E, 2/100 + 2/400 of two bodies.
#[test]
fn a_body_is_held_by_nodes_that_it_shares() {
    let triangles = |count: usize| halved(&row(count));
    for (what, mesh, count) in [
        ("Q4", row(2), 2),
        ("Q8", quadratic(&row(2), half_way), 2),
        ("T3", triangles(2), 2),
        ("T6", quadratic(&triangles(2), half_way), 2),
        ("many", row(60), 60),
    ] {
        let run = finish(&pulled(mesh, json!([{"on": "left", "ux": 0, "uy": 0}])));
        let end: f64 = (0..count).map(|k| 2.0 / young(k)).sum();
        for node in run.nodes("right") {
            close(what, run.last().displacement[2 * node], end, 1e-9);
            close(what, run.last().displacement[2 * node + 1], 0.0, 1e-9);
        }
    }
}

#[test]
fn bodies_that_share_nodes_are_refused_if_all_are_free() {
    let refused = |supports: Value, words: &str| {
        let message = refusal(&pulled(row(2), supports));
        assert!(message.contains(words), "`{words}` is not in `{message}`");
    };
    refused(json!([]), "`body0` with `body1` can move freely along x: there is no support at all");
    refused(
        json!([{"on": "left", "ux": 0}]),
        "`body0` with `body1` can move freely along y: the supports do not constrain it",
    );
    // One support of each body: the pair is held along x and y, and turns about where the lines of the two meet.
    let one = json!([{"on": {"node": 1}, "ux": 0}, {"on": {"node": 5}, "uy": 0}]);
    refused(one, "`body0` with `body1` can move freely");
    // Two of the one and one of the other are enough: statically determinate.
    model(&pulled(row(2), json!([{"on": {"node": 1}, "ux": 0, "uy": 0}, {"on": {"node": 5}, "uy": 0}])));
}

/// Squares [0, 1]² and [2, 3] × [0, 1] of E = 100 and 400; `near` are the sides that face each other.
fn apart(joined: impl Fn(Builder) -> Builder, steps: LoadStep) -> Builder {
    let mesh = Blocks::default().rectangle("body0", [2, 2], [0.0, 0.0], [1.0, 1.0]);
    let mut mesh = mesh.rectangle("body1", [2, 2], [2.0, 0.0], [3.0, 1.0]);
    let near = ["body0_right", "body1_left"].map(|side| mesh.edges[side].clone()).concat();
    mesh.edges.insert("near".into(), near);
    let model =
        Model::builder(mesh.mesh()).body("body0", linear(young(0), 0.0, 1.0)).body("body1", linear(young(1), 0.0, 1.0));
    joined(model).step(steps.dt(1.0).load(Load::traction("body1_right", [2.0, 0.0])))
}

fn refused(builder: Builder, words: &str) {
    let message = builder.build().err().map(|error| error.to_string()).unwrap_or_default();
    assert!(message.contains(words), "`{words}` is not in `{message}`");
}

/// What couples two bodies that are pulled in a row takes the force from one to the other: σ L (1/E₁ + 1/E₂) at the end.
#[test]
fn a_body_is_held_by_periodic_sides_and_plates() {
    let periodic = |model: Builder| model.periodic("body0_right", "body1_left");
    let plate = |moves: Plate| move |model: Builder| model.plate_moving("near", moves);
    let held = || LoadStep::new("pull", 1.0).fix("body0_left");
    let aside = || held().support(Support::on("body1_right").uy(0.0));
    for (what, builder) in [
        ("periodic", apart(periodic, held())),
        ("as one", apart(plate(Plate::AsOne), held())),
        ("rigid", apart(plate(Plate::Rigid), held())),
        ("alike along x", apart(plate(Plate::UxAlike), aside())),
    ] {
        let run = run_through(builder);
        for node in run.nodes("body1_right") {
            close(what, run.last().displacement[2 * node], 2.0 / young(0) + 2.0 / young(1), 1e-10);
        }
    }
    // A plate that is alike along x leaves the body behind it free along y, and one along y leaves it free along x.
    refused(apart(plate(Plate::UxAlike), held()), "`body1` can move freely along y: the supports do not constrain it");
    refused(apart(plate(Plate::UyAlike), held()), "`body1` can move freely along x");
    // Periodic sides stay parallel, but turn with their bodies: about a node, by one angle.
    let pinned = LoadStep::new("pull", 1.0).fix(Place::Near([0.0, 0.0]));
    refused(apart(periodic, pinned), "`body0` with `body1` can move freely");
    refused(apart(|model| model, held()), "`body1` can move freely along x");
}

/// Squares [0, 1]² and [1, 2]² that share a corner only.
fn hinged(step: LoadStep) -> Builder {
    let nodes = [[0, 0], [1, 0], [1, 1], [0, 1], [2, 1], [2, 2], [1, 2]].map(|place| place.map(f64::from)).to_vec();
    let elements = [("body0".into(), vec![vec![0, 1, 2, 3]]), ("body1".into(), vec![vec![2, 4, 5, 6]])].into();
    let edges = [("left".into(), vec![vec![3, 0]])].into();
    let mesh = InlineMesh { nodes, elements, edges, ..InlineMesh::default() };
    let mesh = mesh.build().expect("a mesh");
    let builder = Model::builder(mesh).body("body0", linear(100.0, 0.0, 1.0)).body("body1", linear(400.0, 0.0, 1.0));
    builder.step(step.dt(1.0).fix("left"))
}

/// A corner is a hinge. With a foot under it at the distance 1, the upper square bears F along x at the height 1 by F on its foot.
#[test]
fn a_corner_that_is_shared_is_a_hinge() {
    let step = || LoadStep::new("push", 1.0);
    refused(hinged(step()), "`body1` can move freely");
    refused(hinged(step()), "in rotation: the supports do not constrain it");
    // A support whose line goes through the hinge does not hold.
    refused(hinged(step().support(Support::on(Place::Near([2.0, 1.0])).ux(0.0))), "`body1` can move freely");
    let master_point = Support::on(Place::Near([2.0, 1.0])).uy(0.0);
    let run = run_through(hinged(step().support(master_point).load(Load::force(Place::Near([2.0, 2.0]), [0.3, 0.0]))));
    close("foot", run.last().reaction[2 * 4 + 1], 0.3, 1e-12);
    let [x, y] = run.reaction("left", run.last());
    close("left along x", x, -0.3, 1e-12);
    close("left along y", y, -0.3, 1e-12);
}
