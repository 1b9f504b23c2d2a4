//! Probes and gauges.

use super::*;

/// Distorted elements of four kinds on a square, with the names of their boundary nodes.
pub fn distorted() -> Vec<(&'static str, InlineMesh)> {
    let quads = Blocks::default().block("body", [3, 3], |s, t| {
        let bump = 0.3 * s * (1.0 - s) * t * (1.0 - t);
        [2.0 * (s + bump), 2.0 * (t - bump)]
    });
    let mut triangles = quads.0.clone();
    let split = |q: &Vec<usize>| [vec![q[0], q[1], q[2]], vec![q[0], q[2], q[3]]];
    let all: Vec<Vec<usize>> = triangles.elements["body"].iter().flat_map(split).collect();
    triangles.elements.insert("body".into(), all);
    let quadratic = |mesh: &InlineMesh| -> InlineMesh {
        let of = serde_json::to_value(mesh).expect("JSON");
        serde_json::from_value(common::quadratic(&of, common::half_way)).expect("a mesh")
    };
    let (q8, t6) = (quadratic(&quads.0), quadratic(&triangles));
    vec![("Q4", quads.0), ("T3", triangles), ("Q8", q8), ("T6", t6)]
}

/// A displacement linear in x and y, brought in at the boundary: every element kind has it, and its strain and stress, at any
/// point, exactly.
#[test]
fn probes_are_exact_in_a_linear_field() {
    let (young, nu) = (1000.0, 0.3);
    let (lambda, shear) = (young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), 0.5 * young / (1.0 + nu));
    let [exx, exy, eyx, eyy] = [2e-3, -1e-3, 3e-3, 4e-3];
    let field = |[x, y]: [f64; 2]| [exx * x + exy * y, eyx * x + eyy * y];
    for (kind, mesh) in distorted() {
        let boundary: BTreeSet<usize> = mesh.edges.values().flatten().flatten().copied().collect();
        let support = |&node: &usize| {
            let [ux, uy] = field(mesh.nodes[node]);
            json!({"on": {"node": node}, "ux": ux, "uy": uy})
        };
        let folder = TempDir::new().expect("a folder");
        run(
            folder.path(),
            &json!({
                "mesh": mesh,
                "bodies": {"body": {"material": {"model": "linear", "E": young, "nu": nu}}},
                "steps": [{"name": "pull", "duration": 1, "dt": {"initial": 0.5}, "supports": boundary.iter().map(support).collect::<Vec<_>>()}],
                "probes": {"gauge": {"at": [0.7, 1.1]}, "corner": {"at": [2, 2], "body": "body"},
                           "line": {"from": [0, 0], "to": [2, 1], "number": 5}},
                "output": {"fields": false, "checkpoint": 0}
            }),
        );
        let read = table(folder.path().join("out/probes.csv"));
        assert_eq!((read["time"].clone(), read.len()), (vec![0.5, 1.0], 1 + 11 * 7), "{kind}");
        let along = |k: usize| [0.5 * k as f64, 0.25 * k as f64];
        let lines = (0..5).map(|k| (format!("line.{}", k + 1), along(k)));
        for (name, at) in [("gauge".to_string(), [0.7, 1.1]), ("corner".into(), [2.0, 2.0])].into_iter().chain(lines) {
            let [ux, uy] = field(at);
            let stress = |strain: f64| lambda * (exx + eyy) + 2.0 * shear * strain;
            let expected = [
                ("ux", ux, 1e-3),
                ("uy", uy, 1e-3),
                ("vx", 0.0, 1e-3),
                ("vy", 0.0, 1e-3),
                ("strain_xx", exx, 1e-3),
                ("strain_yy", eyy, 1e-3),
                ("strain_xy", 0.5 * (exy + eyx), 1e-3),
                ("stress_xx", stress(exx), 1.0),
                ("stress_yy", stress(eyy), 1.0),
                ("stress_zz", stress(0.0), 1.0),
                ("stress_xy", shear * (exy + eyx), 1.0),
            ];
            for (column, value, size) in expected {
                close(&format!("{kind} {name}.{column}"), read[&format!("{name}.{column}")][1], value, 1e-9 * size);
            }
        }
    }
}

/// A body that is held under its initial stress, beside one that remembers more and comes after it: frames, frames of the integration
/// points and probes all show the stress that it was given.
#[test]
fn every_output_of_bodies_that_remember_shows_their_own() {
    let folder = TempDir::new().expect("a folder");
    let stress = [-10.3, 4.2, 1.7];
    run(
        folder.path(),
        &json!({
            "mesh": Blocks::default().rectangle("aaa", [3, 2], [12.0, 0.0], [14.0, 1.0])
                .rectangle("soft", [4, 2], [0.0, 0.0], [2.0, 1.0]).json(),
            "bodies": {
                "aaa": {"material": {"model": "linear", "E": 500, "nu": 0.2},
                    "initial_stress": {"components": {"xx": stress[0], "yy": stress[1], "zz": stress[2]}}},
                "soft": {"material": {"model": "viscoelastic", "E": 100, "nu": 0.3, "E_1": 100, "tau": 2}},
            },
            "steps": [{"name": "stretch", "duration": 1, "dt": {"initial": 0.25}, "supports": [
                {"on": "soft_left", "ux": 0, "uy": 0}, {"on": "soft_right", "ux": 0.1}, {"on": "aaa", "ux": 0, "uy": 0}]}],
            "probes": {"gauge": {"at": [13.1, 0.6]}},
            "output": {"points": true, "checkpoint": 0}
        }),
    );
    let out = folder.path().join("out");
    let last = |collection: &str| {
        let text = fs::read_to_string(out.join(collection)).expect("a collection");
        let file = text.split("file=\"").last().expect("a frame").split('"').next().expect("its name").to_string();
        frame(&out.join(file))
    };
    let read = table(out.join("probes.csv"));
    for (k, name) in ["xx", "yy", "zz"].into_iter().enumerate() {
        read[&format!("gauge.stress_{name}")].iter().for_each(|value| close(name, *value, stress[k], 1e-11));
    }
    for collection in ["solid.pvd", "points.pvd"] {
        let shown = last(collection);
        let (places, stresses) =
            (shown.points.clone().cast_into::<f64>().expect("places"), values(&shown.data.point, "stress"));
        let mut seen = 0;
        for (place, found) in places.chunks_exact(3).zip(stresses.chunks_exact(6)).filter(|(place, _)| place[0] > 11.0)
        {
            (0..3).for_each(|k| close(&format!("{collection} {place:?}"), found[k], stress[k], 1e-11));
            seen += 1;
        }
        assert!(seen >= 12, "{collection}: {seen}");
    }
}

/// As many probes as a line may have, 100 000 in 2500 elements that remember: each is found among the few elements near it, and finds
/// what its element remembers without a walk over the others. What they read is the even strain, and there are as many columns.
#[test]
fn a_line_may_have_a_hundred_thousand_probes() {
    const NUMBER: usize = 100_000;
    let folder = TempDir::new().expect("a folder");
    run(
        folder.path(),
        &json!({
            "mesh": Blocks::default().rectangle("body", [50, 50], [0.0, 0.0], [2.0, 1.0]).json(),
            "bodies": {"body": {"material": {"model": "viscoelastic", "E": 100, "nu": 0.3, "E_1": 100, "tau": 2}}},
            "steps": [{"name": "stretch", "duration": 1, "dt": {"initial": 1}, "supports": [
                {"on": "body_left", "ux": 0}, {"on": "body_right", "ux": 0.02}, {"on": "body_bottom", "uy": 0}]}],
            "probes": {"line": {"from": [0, 0], "to": [2, 1], "number": NUMBER}},
            "output": {"fields": false, "checkpoint": 0, "report": false}
        }),
    );
    let text = fs::read_to_string(folder.path().join("out/probes.csv")).expect("a table");
    let mut lines = text.lines();
    assert_eq!(lines.next().expect("a header").split(',').count(), 1 + 11 * NUMBER);
    let row: Vec<f64> = lines.next().expect("a row").split(',').map(|cell| cell.parse().expect("a number")).collect();
    for (k, probe) in row[1..].chunks_exact(11).enumerate() {
        close("u_x", probe[0], 0.02 * k as f64 / (NUMBER - 1) as f64, 1e-9);
        // Green and Lagrange's strain of an even stretch by 1 %.
        close("E_xx", probe[4], 0.01 + 0.5e-4, 1e-9);
        close("the same stress", probe[7], row[1 + 7], 1e-7);
    }
}

/// Places of probes that cannot be meant.
#[test]
fn bad_places_of_probes_are_named() {
    let mut case = dragged(healing(), "gauss_to_segment");
    // The block touches the ground.
    case["mesh"] = Blocks::default()
        .rectangle("ground", [10, 3], [0.0, -0.5], [3.0, 0.0])
        .rectangle("block", [5, 3], [0.4, 0.0], [1.4, 0.5])
        .json();
    let folder = TempDir::new().expect("a folder");
    for (probe, words) in [
        (json!({"at": [2.0, 0.3]}), "probes.gauge: (2, 0.3) lies in no body; the nearest node is at ("),
        (json!({"at": [1.0, 0.0]}), "probes.gauge: (1, 0) lies in `block` and in `ground`: say which by \"body\""),
        (json!({"at": [1.0, 0.3], "body": "ground"}), "lies outside of `ground`"),
        (
            json!({"at": [1.0, 0.3], "body": "rock"}),
            "probes.gauge.body: there is no body `rock`; the bodies are block, ground",
        ),
        (json!({"from": [0.5, 0.3], "to": [2.0, 0.3], "number": 4}), "(1.5, 0.3) lies in no body"),
        (json!({"from": [0.5, 0.3], "to": [1.0, 0.3], "number": 1}), "probes.gauge.number: is 1: a line has 2 to"),
        (
            json!({"from": [0.5, 0.3], "to": [0.5, 0.3], "number": 3}),
            "probes.gauge.to: is (0.5, 0.3), the start of the line",
        ),
        (json!({"from": [0.5, 0.3], "number": 3}), "give `at` for a point, or `from`, `to` and `number`"),
        (json!({"on": [0.5, 0.3]}), "probes.gauge"),
    ] {
        case["probes"] = json!({"gauge": probe});
        let output = start(folder.path(), &case);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && message.contains(words), "{message}");
    }
    case["probes"] = json!({"gauge": {"at": [1.0, 0.0], "body": "block"}});
    run(folder.path(), &case);
}

/// A line of gauges from code.
#[test]
fn gauges_come_from_code_as_well() {
    let mesh = Blocks::default().rectangle("body", [2, 2], [0.0, 0.0], [1.0, 1.0]).mesh();
    let model = Model::builder(mesh).body("body", common::linear(1.0, 0.3, 1.0)).step(still());
    let model =
        Arc::new(model.probe(Gauge::line("line", [0.0, 0.5], [1.0, 0.5], 3).of("body")).build().expect("a model"));
    let names: Vec<&str> = model.requests.probes.iter().map(|probe| probe.name.as_str()).collect();
    assert_eq!(names, ["line.1", "line.2", "line.3"]);
}
