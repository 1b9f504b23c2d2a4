//! Motion and momentum of bodies, means of edges, resultants.

use super::probes::distorted;
use super::*;

/// A rectangle a × b that turns by more than half a turn and flies: momentum, angular momentum about its centre, place and
/// rotation in closed form, also 10⁷ of its size away.
#[test]
fn bodies_move_as_a_whole_as_closed_forms_say() {
    let density = 2.5;
    for (kind, mesh) in distorted() {
        for offset in [0.0, 2e7] {
            let moved = InlineMesh {
                nodes: mesh.nodes.iter().map(|[x, y]| [x + offset, y - offset]).collect(),
                ..mesh.clone()
            };
            let model = Model::builder(moved.build().expect("a mesh"))
                .body("body", common::neo_hookean(1e3, 0.3, density))
                .step(still());
            let model = model.build().expect("a model");
            let centre = Vector2::new(1.0 + offset, 1.0 - offset);
            let (angle, shift, v0, omega) = (2.5, Vector2::new(0.3, -4.0), Vector2::new(2.0, 1.0), -0.7);
            let mut state = model.initial_state();
            for (node, place) in model.mesh.nodes.iter().enumerate() {
                let arm = Rotation2::new(angle) * (place - centre);
                let u = arm - (place - centre) + shift;
                let v = v0 + omega * Vector2::new(-arm.y, arm.x);
                state.displacement[2 * node..2 * node + 2].copy_from_slice(u.as_slice());
                state.velocity[2 * node..2 * node + 2].copy_from_slice(v.as_slice());
            }
            let motion = BodyMeans::new(&model, &model.bodies[0]).motion(&model, &state);
            let (mass, inertia) = (4.0 * density, 4.0 * density * 8.0 / 12.0);
            // The places themselves are rounded at a distance.
            let round_off = 1e-12 + 8.0 * f64::EPSILON * offset;
            let near =
                |what: &str, is: f64, expected: f64| close(&format!("{kind} {what}"), is, expected, 20.0 * round_off);
            near("P_x", motion.momentum.x, mass * v0.x);
            near("P_y", motion.momentum.y, mass * v0.y);
            near("L", motion.angular_momentum, inertia * omega);
            near("c_x", motion.centre.x - offset, 1.0 + shift.x);
            near("c_y", motion.centre.y + offset, 1.0 + shift.y);
            near("rotation", motion.rotation, angle);
        }
    }
}

/// A block turned by two and a half turns about a point beside it; and a block that flies.
#[test]
fn the_history_counts_turns_and_momentum() {
    let folder = TempDir::new().expect("a folder");
    let mut case = json!({
        "mesh": Blocks::default().rectangle("block", [2, 2], [1.0, 0.0], [2.0, 1.0]).json(),
        "bodies": {"block": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3, "density": 3}}},
        "steps": [{"name": "turn", "duration": 1, "dt": {"initial": 0.05}, "supports": [
            {"on": "block", "rotation": {"about": [0, 0], "angle": {"rate": 5.0 * std::f64::consts::PI}}}]}],
        "output": {"fields": false, "checkpoint": 0}
    });
    run(folder.path(), &case);
    let history = table(folder.path().join("out/history.csv"));
    for (k, time) in history["time"].iter().enumerate() {
        let angle = 5.0 * std::f64::consts::PI * time;
        close("rotation", history["block.rotation"][k], angle, 1e-9);
        let [x, y] = common::turned([1.5, 0.5], angle);
        close("centre", history["block.centre_x"][k], x, 1e-9);
        close("centre", history["block.centre_y"][k], y, 1e-9);
    }
    case["initial_velocity"] = json!({"block": [2, -1]});
    case["steps"] =
        json!([{"name": "fly", "duration": 1, "scheme": {"explicit": {}}, "dt": {"initial": 0.1}, "supports": []}]);
    run(folder.path(), &case);
    let history = table(folder.path().join("out/history.csv"));
    let last = |name: &str| *history[&format!("block.{name}")].last().expect("a row");
    for (name, expected) in [
        ("momentum_x", 6.0),
        ("momentum_y", -3.0),
        ("angular_momentum", 0.0),
        ("centre_x", 3.5),
        ("centre_y", -0.5),
        ("rotation", 0.0),
    ] {
        close(name, last(name), expected, 1e-10);
    }
}

/// Means by length of an edge whose nodes lie close together at one end: of u_x = x/10 it is that of the middle.
#[test]
fn edge_means_go_by_length() {
    for quadratic in [false, true] {
        let mesh = Blocks::default().block("bar", [6, 1], |s, t| [2.0 * s * s, 0.3 * t]).json();
        let mesh = if quadratic { common::quadratic(&mesh, common::half_way) } else { mesh };
        let stretch: Vec<Value> = mesh["nodes"]
            .as_array()
            .expect("nodes")
            .iter()
            .enumerate()
            .map(|(node, at)| json!({"on": {"node": node}, "ux": 0.1 * at[0].as_f64().expect("a number"), "uy": 0}))
            .collect();
        let folder = TempDir::new().expect("a folder");
        run(
            folder.path(),
            &json!({
                "mesh": mesh, "bodies": {"bar": {"material": {"model": "linear", "E": 1000, "nu": 0.3}}},
                "steps": [{"name": "pull", "duration": 1, "dt": {"initial": 1}, "supports": stretch}],
                "watch": ["bar_top", "bar"], "output": {"fields": false, "checkpoint": 0}
            }),
        );
        let history = table(folder.path().join("out/history.csv"));
        close("mean by length", history["bar_top.edge_ux"][0], 0.1, 1e-14);
        assert!(history["bar_top.ux"][0] < 0.095, "nodes lie closer together on the left");
        assert!(!history.contains_key("bar.edge_ux"), "a body has no length");
    }
}

/// In equilibrium the contact carries what the support brings: force, moment about the stated point, and nodal forces, by every
/// method; by a rigid master and in small sliding as well.
#[test]
fn the_resultant_of_a_contact_balances_the_support() {
    let methods = ["gauss_to_segment", "node_to_segment", "mortar"];
    let mut cases: Vec<(String, Value)> =
        methods.iter().map(|method| ((*method).into(), dragged(healing(), method))).collect();
    for method in methods {
        let mut rigid = dragged(healing(), method);
        rigid["contacts"]["base/1"]["master"] = json!({"plane": {"point": [0, 0], "normal": [0, 1]}});
        cases.push((format!("rigid {method}"), rigid));
        let mut small = dragged(healing(), method);
        small["contacts"]["base/1"]["sliding"] = json!("small");
        cases.push((format!("small {method}"), small));
    }
    for (name, mut case) in cases {
        case["newton"] = json!({"tolerance": 1e-12});
        case["output"] = json!({"checkpoint": 0, "every": 1000});
        case["watch"] = json!(["block_top"]);
        let folder = TempDir::new().expect("a folder");
        run(folder.path(), &case);
        let out = folder.path().join("out");
        let history = table(out.join("history.csv"));
        let last = |column: &str| *history[column].last().expect("a row");
        let [fx, fy] = [last("block_top.fx"), last("block_top.fy")];
        let size = fy.abs();
        assert!(size > 0.1 && fx.abs() > 0.02, "{name}: it is pressed and dragged");
        close(&format!("{name} force"), last("base/1.force_x"), -fx, 1e-8 * size);
        close(&format!("{name} force"), last("base/1.force_y"), -fy, 1e-8 * size);
        let shown = frame(&out.join(format!("solid/{:05}.vtu", times(&out, "solid.pvd").len() - 1)));
        let list = |name: &str| -> Vec<Vector2<f64>> {
            values(&shown.data.point, name).chunks(3).map(|v| Vector2::new(v[0], v[1])).collect()
        };
        let [moved, reaction, contact] = ["displacement", "reaction", "contact_force"].map(list);
        let model = common::model(&case);
        let on = |group: &str| model.mesh.nodes_of(model.mesh.group(group).expect("a group"));
        let block: BTreeSet<usize> = on("block").into_iter().collect();
        // Moments about the middle of the undeformed slave surface.
        let about = Vector2::new(0.9, 0.01);
        let arm = |node: usize| model.mesh.nodes[node] + moved[node] - about;
        let moment: f64 = on("block_top").iter().map(|&node| arm(node).perp(&reaction[node])).sum();
        assert!(moment.abs() > 1e-3 * size, "{name}: {moment}");
        // What small sliding keeps is the moment of forces at undeformed places: they have turned and slid by so much.
        let slack = if name.starts_with("small") { 0.1 * size } else { 1e-7 * size };
        close(&format!("{name} moment"), last("base/1.moment"), -moment, slack);
        let sum = |nodes: &BTreeSet<usize>| -> Vector2<f64> { nodes.iter().map(|&node| contact[node]).sum() };
        assert!((sum(&block) + Vector2::new(fx, fy)).norm() < 1e-8 * size, "{name}");
        if !name.starts_with("rigid") {
            let ground: BTreeSet<usize> = on("ground").into_iter().collect();
            assert!((sum(&block) + sum(&ground)).norm() < 1e-12 * size, "{name}: forces come in pairs");
        }
        assert!(contact.iter().enumerate().all(|(node, force)| force.norm() == 0.0
            || on("block_bottom").contains(&node)
            || on("ground_top").contains(&node)));
    }
}
