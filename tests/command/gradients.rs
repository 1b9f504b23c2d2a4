//! Derivatives of the history by values of the case (gradients.csv): closed forms, and central differences of complete runs with the
//! same increments.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::common::{self, Blocks, Columns, close, store};
use fecontact::output::results::{Grid, frames};
use serde_json::{Value, json};
use tempfile::TempDir;

pub fn start(folder: &Path, case: &Value, more: &[&str]) -> Output {
    fs::write(folder.join("case.json"), case.to_string()).expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_fecontact_tested"));
    command.current_dir(folder).args(["run", "case.json", "--quiet", "--out", "out"]).args(more);
    command.output().expect("the program runs")
}

/// A folder with the results of a case.
#[track_caller]
pub fn run(case: &Value, more: &[&str]) -> TempDir {
    let folder = TempDir::new().expect("a folder");
    let output = start(folder.path(), case, more);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    folder
}

/// What a case is refused with.
#[track_caller]
pub fn refused(case: &Value) -> String {
    let folder = TempDir::new().expect("a folder");
    let output = start(folder.path(), case, &[]);
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(!folder.path().join("out").exists(), "nothing is written");
    String::from_utf8_lossy(&output.stderr).into()
}

/// Columns of a table by name, those of numbers.
pub fn table(folder: &TempDir, file: &str) -> Columns {
    common::table(folder.path().join("out").join(file))
}

pub fn summary(folder: &TempDir) -> Value {
    serde_json::from_str(&fs::read_to_string(folder.path().join("out/summary.json")).expect("a file")).expect("JSON")
}

/// JSON pointer to a place whose lists are named by numbers.
fn pointer(place: &str) -> String {
    format!("/{}", place.replace('[', ".").replace(']', "").replace('.', "/"))
}

/// Columns whose round-off is that of the largest of them: energies, forces, momenta, displacements; otherwise the column alone.
fn kind(column: &str) -> &str {
    match column.rsplit('.').next().unwrap_or(column) {
        _ if !column.contains('.') => "energy",
        "normal_force" | "tangential_force" | "force_x" | "force_y" | "fx" | "fy" | "moment" => "force",
        "momentum_x" | "momentum_y" | "angular_momentum" => "momentum",
        "ux" | "uy" | "mean_ux" | "mean_uy" | "rotation" => "motion",
        "heat" | "heat_rate" | "frictional_heat" | "frictional_power" => "heat",
        _ => column,
    }
}

/// Largest differences, first those of forces and displacements, then all others, between the derivatives of a run and central differences of complete runs with the same increments, all
/// with a tolerance of 1e-12 unless the case has another, in each column relative to its largest derivative; with the column.
#[track_caller]
pub fn compared(case: &Value, places: &[&str]) -> [(f64, String); 2] {
    const STEP: f64 = 1e-4;
    let exact = json!({"tolerance": 1e-12, "max_iterations": 40});
    let mut case = case.clone();
    if case["newton"].is_null() {
        case["newton"] = exact.clone();
    }
    let with = |extra: &dyn Fn(&mut Value)| {
        let mut case = case.clone();
        case["output"] = json!({"fields": false, "checkpoint": null, "report": false});
        extra(&mut case);
        run(&case, &[])
    };
    let own = with(&|case| case["gradients"] = json!(places));
    let (found, history) = (table(&own, "gradients.csv"), table(&own, "history.csv"));
    let mut worst = [(0.0, String::new()), (0.0, String::new())];
    for place in places {
        let value = case.pointer(&pointer(place)).and_then(Value::as_f64).expect("a number at the place");
        let ends = [value * (1.0 - STEP), value * (1.0 + STEP)];
        let [low, high] = ends.map(|value| {
            let ended = with(&|case| {
                case["newton"] = exact.clone();
                *case.pointer_mut(&pointer(place)).expect("a place") = json!(value);
            });
            table(&ended, "history.csv")
        });
        assert_eq!(low["time"], history["time"], "the same increments");
        assert_eq!(high["time"], history["time"], "the same increments");
        // Scatter has kinks where the residuals of neighbours change their order; what water has lost is round-off.
        let is_smooth = |name: &str| {
            !["time", "dt", "step", "iterations"].contains(&name)
                && !name.ends_with(".scatter")
                && !name.ends_with("mass_error")
                && name != "water_error"
        };
        for (name, low) in low.iter().filter(|(name, _)| is_smooth(name)) {
            let differences: Vec<f64> =
                low.iter().zip(&high[name]).map(|(low, high)| (high - low) / (ends[1] - ends[0])).collect();
            let scale = differences.iter().fold(0.0f64, |most, value| most.max(value.abs()));
            let alike = history.iter().filter(|(other, _)| kind(other) == kind(name)).flat_map(|(_, column)| column);
            let typical = alike.fold(0.0f64, |most, value| most.max(value.abs())) / value;
            let column = format!("d({name})/d({place})");
            // A body that is not there has no value.
            let both = found[&column].iter().zip(&differences).filter(|(a, b)| !a.is_nan() || !b.is_nan());
            for (found, expected) in both {
                // Below a tenth of Q/θ a derivative is known relative to that.
                let error = (found - expected).abs() / scale.max(0.1 * typical.abs()).max(f64::MIN_POSITIVE);
                let worst = &mut worst[usize::from(!["force", "motion"].contains(&kind(name)))];
                if error.is_nan() || error > worst.0 {
                    *worst = (error, format!("{column}: {found:e} for {expected:e}"));
                }
            }
        }
    }
    worst
}

/// Whether forces and displacements agree to 1e-7, and what is small beside them, to which what drops out of derivatives (1e-10 of the forces) is not, to 5e-6:
/// penetrations, momenta, powers.
fn is_close([main, others]: &[(f64, String); 2]) -> bool {
    main.0 < 1e-7 && others.0 < 5e-6
}

/// A block on ground, dragged until it slides; every increment has the same length.
fn dragged(friction: Value, contact: Value) -> Value {
    let base = common::with(
        json!({"slave": "block_bottom", "master": "ground_top", "normal": {"alpha_n": 4e5}, "friction": friction}),
        &contact,
    );
    json!({
        "mesh": Blocks::default()
            .rectangle("ground", [14, 3], [-2.0, -1.0], [5.0, 0.0])
            .rectangle("block", [9, 3], [0.0, 0.0], [2.0, 1.0]).json(),
        "bodies": {
            "ground": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}},
            "block": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}},
        },
        "contacts": {"base": base},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.25, "min": 0.25, "max": 0.25},
             "supports": [{"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0, "uy": -0.01}]},
            {"name": "drag", "duration": 4, "dt": {"initial": 0.25, "min": 0.25, "max": 0.25},
             "supports": [{"on": "block_top", "ux": {"rate": 0.003}}]},
        ],
        "watch": ["block_top"],
    })
}

fn weakening() -> Value {
    json!({"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "alpha_t": 2e4, "r": 400, "kappa": 20, "xi": 0.002, "m": 1, "n": 1,
           "structure": 1.8})
}

#[test]
fn of_a_dragged_block_by_every_parameter_are_those_of_complete_runs() {
    let friction = "contacts.base.friction";
    let of = |name: &str| format!("{friction}.{name}");
    let laws: Vec<String> = ["mu_s", "mu_k", "r", "kappa", "xi", "alpha_t"].map(of).into();
    let mut places: Vec<&str> = laws.iter().map(String::as_str).collect();
    places.extend(["contacts.base.normal.alpha_n", "bodies.block.material.E", "bodies.ground.material.nu"]);
    places.extend(["steps[0].supports[1].uy", "steps[1].supports[0].ux.rate"]);
    let mut case = dragged(weakening(), json!({"method": "gauss_to_segment"}));
    let worst = compared(&case, &places);
    assert!(is_close(&worst), "{worst:?}");
    // Derivatives are those at the states of the run, which its tolerance leaves uncertain.
    case["newton"] = json!({"tolerance": 1e-8});
    let worst = compared(&case, &places);
    assert!(is_close(&worst), "{worst:?}");
}

/// A bond that slips, softens, opens and pulls, by each of its numbers.
#[test]
fn of_a_bond_are_those_of_complete_runs() {
    let bond = json!({"strength": 2, "residual": 1, "slip": 0.05, "tension": 1, "opening": 0.03, "limit": 4});
    let contact = json!({"method": "gauss_to_segment", "bond": bond});
    let mut case = dragged(json!({"law": "coulomb", "mu": 0.3, "alpha_t": 4e4}), contact);
    case["steps"].as_array_mut().expect("steps").push(json!({
        "name": "lift", "duration": 3, "supports": [{"on": "block_top", "ux": 0.012, "uy": {"rate": 0.01}}]}));
    let of = |name: &str| format!("contacts.base.bond.{name}");
    let places = ["strength", "residual", "slip", "tension", "opening", "limit"].map(of);
    let places: Vec<&str> = places.iter().map(String::as_str).chain(["bodies.block.material.E"]).collect();
    // Where points open, forces are small beside those of their stiff springs.
    let [main, others] = compared(&case, &places);
    assert!(main.0 < 1e-6 && others.0 < 5e-5, "{main:?} {others:?}");
}

/// Elastic ground beside a hot and stressed wall, pressed by a block; a fill comes, goes and comes again.
fn staged(scheme: &Value, model: &str) -> Value {
    let block = |body: &str, low: [f64; 2], high: [f64; 2], sides: [Option<&str>; 4]| json!({"body": body, "corners": [low, [high[0], low[1]], high, [low[0], high[1]]], "elements": [3, 2], "sides": sides});
    let material = json!({"model": model, "E": 1000, "nu": 0.3, "density": 100});
    let step = |name: &str, more: Value| {
        common::with(
            json!({"name": name, "duration": 0.2, "scheme": scheme, "dt": {"initial": 0.05, "min": 0.05, "max": 0.05}}),
            &more,
        )
    };
    let weight = json!([{"on": "fill", "gravity": {"y": -0.05}}]);
    json!({
        "mesh": {"joined": [["ground", "fill", "wall"]], "blocks": [
            block("ground", [0.0, -1.0], [2.0, 0.0], [Some("bottom"), None, Some("ground_top"), None]),
            block("ground", [2.0, -1.0], [4.0, 0.0], [Some("bottom"), None, None, None]),
            block("fill", [2.0, 0.0], [4.0, 1.0], [None; 4]),
            block("wall", [4.0, -1.0], [5.0, 0.0], [None, Some("wall_side"), None, None]),
            block("block", [0.5, 0.0], [1.5, 1.0], [Some("block_bottom"), None, Some("block_top"), None]),
        ]},
        "bodies": {
            "ground": {"material": material},
            "fill": {"material": material},
            "wall": {"material": material, "thermal": {"expansion": 0.001}, "initial_stress": {"components": {"xx": 1.0, "yy": -2.0, "zz": 0.0}}},
            "block": {"material": material},
        },
        "contacts": {"base": {"slave": "block_bottom", "master": "ground_top", "normal": {"alpha_n": 4e3},
            "friction": {"law": "coulomb", "mu": 0.3, "alpha_t": 2e3}}},
        "steps": [
            step("press", json!({"loads": [{"on": "wall_side", "traction": {"y": -3}}, {"on": "ground", "gravity": {"y": -0.02}}],
                "supports": [{"on": "bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0, "uy": -0.03}]})),
            step("fill", json!({"add": ["fill"], "loads": weight, "temperature": {"wall": 2}})),
            step("drag", json!({"supports": [{"on": "block_top", "ux": 0.03}]})),
            step("dig", json!({"remove": ["fill"]})),
            step("again", json!({"add": ["fill"], "remove": ["wall"],
                "loads": [weight[0], {"on": "wall_side", "traction": null}],
                "supports": [{"on": "block_top", "uy": -0.02}]})),
        ],
        "watch": ["bottom", "wall_side", {"near": [4, 1]}],
    })
}

/// Bodies that come are without stress where their nodes are then, at another place in each neighbour.
#[test]
fn of_bodies_that_come_and_go_are_those_of_complete_runs_in_every_scheme() {
    let dynamic = [
        json!({"newmark": {}}),
        json!({"hht": {"alpha": -0.1}}),
        json!({"generalized_alpha": {}}),
        json!({"wilson": {}}),
    ];
    let places = [
        "steps[0].supports[1].uy",
        "steps[0].loads[0].traction.y",
        "steps[0].loads[1].gravity.y",
        "steps[1].temperature.wall",
        "steps[2].supports[0].ux",
        "contacts.base.normal.alpha_n",
        "contacts.base.friction.mu",
        "bodies.block.material.E",
        "bodies.wall.thermal.expansion",
        "bodies.wall.initial_stress.components.xx",
    ];
    // What differs between the schemes in motion shows in some places as in all.
    let some: Vec<&str> = places.iter().copied().step_by(3).collect();
    for scheme in dynamic.iter().chain([&json!("static")]) {
        let is_static = scheme == "static";
        let model = if is_static { "neo_hookean" } else { "linear" };
        let of_all = is_static || scheme.get("newmark").is_some();
        let worst = compared(&staged(scheme, model), if of_all { &places } else { &some });
        assert!(is_close(&worst), "{scheme}, {model}: {worst:?}");
    }
}

/// Soil that yields under a rough, stiff block, which slips on it; initial tractions and a pressure by a table.
#[test]
fn of_yielding_soil_are_those_of_complete_runs() {
    let mut case = dragged(
        json!({"law": "slip_weakening", "mu_s": 0.4, "mu_d": 0.3, "D_c": 0.01, "alpha_t": 4e3}),
        json!({"method": "mortar"}),
    );
    case["bodies"]["ground"] = json!({"element": "f_bar",
        "material": {"model": "mohr_coulomb", "E": 1000, "nu": 0.3, "c": 1.0, "phi": 25, "psi": 5}});
    case["steps"][0]["supports"][1] = json!({"on": "block_top", "ux": 0});
    case["steps"][0]["loads"] = json!([{"on": "block_top", "pressure": 3}]);
    let places = [
        "bodies.ground.material.c",
        "bodies.ground.material.phi",
        "contacts.base.friction.mu_s",
        "steps[0].loads[0].pressure",
    ];
    let worst = compared(&case, &places);
    // The force on the ground is that of the pressure: round-off of the soil is all there is of its derivative.
    assert!(worst.iter().all(|(error, _)| *error < 5e-6), "{worst:?}");
}

/// A bar of a linear material under a given strain: F = E A u/L, W = ½ E A u²/L in plane stress. A block that slides by Coulomb's law:
/// Q = μ P.
#[test]
fn have_closed_forms() {
    let bar = json!({
        "mesh": Blocks::default().rectangle("bar", [4, 1], [0.0, 0.0], [2.0, 0.5]).json(),
        "section": {"plane_stress": {"thickness": 0.1}},
        "bodies": {"bar": {"material": {"model": "linear", "E": 200, "nu": 0.3}}},
        "steps": [{"name": "pull", "duration": 1, "dt": {"initial": 0.5}, "supports": [
            {"on": "bar_left", "ux": 0}, {"on": "bar_bottom", "uy": 0}, {"on": "bar_right", "ux": 0.01}]}],
        "watch": ["bar_right"],
        "probes": {"gauge": {"at": [0.5, 0.2]}},
        "gradients": ["bodies.bar.material.E", "bodies.bar.material.nu", "steps.pull.supports[2].ux", "section.plane_stress.thickness"],
    });
    let found = table(&run(&bar, &[]), "gradients.csv");
    let (e, area, length) = (200.0, 0.5 * 0.1, 2.0);
    for (k, u) in [(0, 0.005), (1, 0.01)] {
        let force = e * area * u / length;
        let check = |column: &str, exact: f64, scale: f64| {
            let all = found.get(column).unwrap_or_else(|| panic!("no {column} in {:?}", found.keys()));
            close(column, all[k], exact, 1e-8 * scale);
        };
        check("d(bar_right.fx)/d(bodies.bar.material.E)", force / e, force / e);
        check("d(strain)/d(bodies.bar.material.E)", 0.5 * force * u / e, force * u / e);
        check("d(bar_right.fx)/d(bodies.bar.material.nu)", 0.0, force / 0.3);
        check("d(bar_right.fx)/d(steps.pull.supports[2].ux)", force / 0.01, force / 0.01);
        check("d(bar_right.fx)/d(section.plane_stress.thickness)", force / 0.1, force / 0.1);
        check("d(bar_right.ux)/d(steps.pull.supports[2].ux)", u / 0.01, 1.0);
        check("d(gauge.ux)/d(steps.pull.supports[2].ux)", 0.25 * u / 0.01, 1.0);
        check("d(gauge.strain_xx)/d(steps.pull.supports[2].ux)", u / length / 0.01, 1.0);
        check("d(gauge.stress_xx)/d(bodies.bar.material.E)", u / length, 1.0);
        check("d(gauge.strain_yy)/d(bodies.bar.material.nu)", -u / length, 1.0);
    }

    let mut sliding = dragged(json!({"law": "coulomb", "mu": 0.3}), json!({}));
    sliding["gradients"] = json!(["contacts.base.friction.mu", "steps.drag.supports[0].ux.rate"]);
    let folder = run(&sliding, &[]);
    let (history, found) = (table(&folder, "history.csv"), table(&folder, "gradients.csv"));
    let last = |table: &Columns, column: &str| *table[column].last().expect("a row");
    let [force, by_mu] = ["base.normal_force", "d(base.tangential_force)/d(contacts.base.friction.mu)"];
    // Q = μ P: dQ/dμ = P + μ dP/dμ.
    let p_by_mu = last(&found, "d(base.normal_force)/d(contacts.base.friction.mu)");
    let exact = last(&history, force) + 0.3 * p_by_mu;
    close("dQ/dμ", last(&found, by_mu), exact, 1e-7 * exact);
    // What does not act yet changes nothing, to the last bit.
    let idle = &found["d(base.tangential_force)/d(steps.drag.supports[0].ux.rate)"];
    assert!(idle[..4].iter().all(|value| *value == 0.0) && idle[4] != 0.0, "{idle:?}");
}

/// A run taken up again has the same derivatives, bit by bit, and so has one on several threads; and the run itself is the one without derivatives.
#[test]
fn are_the_same_bits_after_a_resume_and_on_any_number_of_threads() {
    let mut case = dragged(weakening(), json!({"method": "gauss_to_segment"}));
    case["steps"][1]["duration"] = json!(2.0);
    let plain = run(&case, &["--threads", "1"]);
    case["gradients"] =
        json!(["contacts.base.friction.mu_k", "contacts.base.normal.alpha_n", "bodies.block.material.E"]);
    let whole = run(&case, &["--threads", "1"]);
    let bytes = |folder: &TempDir, file: &str| fs::read(folder.path().join("out").join(file)).expect("a file");
    assert_eq!(bytes(&plain, "history.csv"), bytes(&whole, "history.csv"));
    let threads = run(&case, &["--threads", "2"]);
    assert_eq!(bytes(&whole, "gradients.csv"), bytes(&threads, "gradients.csv"));

    let mut first = case.clone();
    first["steps"].as_array_mut().expect("steps").pop();
    let folder = run(&first, &["--threads", "1"]);
    let output = start(folder.path(), &case, &["--resume"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(bytes(&whole, "gradients.csv"), bytes(&folder, "gradients.csv"));
    assert_eq!(summary(&whole)["gradients"], summary(&folder)["gradients"]);

    case["gradients"] = json!(["contacts.base.friction.mu_s"]);
    let output = start(folder.path(), &case, &["--resume"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        String::from_utf8_lossy(&output.stderr).contains("gradients"),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

/// Frames show the derivatives of the displacements of all nodes: those of the store, but for its rounding, and to the last bit those of
/// watched nodes in the table. They are 0 at first. So are the frames of a run that is taken up with frames it did not have before: its first
/// one shows the derivatives with which it goes on.
#[test]
fn of_displacements_are_in_frames() {
    let mut case = dragged(weakening(), json!({"method": "gauss_to_segment"}));
    case["steps"][1]["duration"] = json!(1.0);
    let places = ["contacts.base.friction.mu_k", "contacts.base.friction.r", "bodies.block.material.E"];
    case["gradients"] = json!(places);
    case["watch"] = json!([{"near": [2, 1]}, {"near": [0, 1]}]);
    case["output"] = json!({"every": 1, "exact": true, "displacement_gradients": true});
    let folder = run(&case, &[]);
    let out = folder.path().join("out");
    let (shape, stored) = store::array(&out.join("gradients.zarr"), "displacement");
    let (history, rows) = (table(&folder, "history.csv"), table(&folder, "gradients.csv"));
    let listed = frames(&out, "solid").expect("frames").expect("a list");
    assert_eq!((listed.len(), shape[0], shape[1]), (9, 8, 3));
    let motion = |file: &str, place: &str| {
        let grid = Grid::read(&out.join(file)).expect("a grid");
        let name = format!("d(displacement)/d({place})");
        let array = grid.at_points.iter().find(|array| array.name == name).unwrap_or_else(|| panic!("no {name}"));
        assert_eq!(array.components, 3);
        (grid.points.clone(), array.values.clone())
    };
    for (k, place) in places.iter().enumerate() {
        let (points, first) = motion(&listed[0].file, place);
        assert!(first.iter().all(|value| *value == 0.0));
        let at = |x: f64, y: f64| points.iter().enumerate().filter(move |(_, p)| **p == [x, y]).map(|(node, _)| node);
        let mut largest = 0.0_f64;
        for (row, frame) in listed[1..].iter().enumerate() {
            assert_eq!(frame.time, history["time"][row]);
            let (_, shown) = motion(&frame.file, place);
            let [nodes, width] = [points.len(), 2 * points.len()];
            let stored = &stored[(3 * row + k) * width..][..width];
            for (node, component) in (0..nodes).flat_map(|node| [(node, 0), (node, 1)]) {
                let (value, expected) = (shown[3 * node + component], stored[2 * node + component]);
                close(place, value, expected, 1.6e-5 * value.abs());
                largest = largest.max(value.abs());
            }
            for (name, node) in [("near_2_1", at(2.0, 1.0).next()), ("near_0_1", at(0.0, 1.0).next())] {
                let node = node.expect("a node");
                for (component, column) in ["ux", "uy"].iter().enumerate() {
                    let exact = rows[&format!("d({name}.{column})/d({place})")][row];
                    assert_eq!(shown[3 * node + component], exact, "{name}.{column} by {place}");
                }
            }
        }
        assert!(largest > 0.0, "{place}");
    }

    // Without frames up to the end of the first step, and with them from there on.
    let mut first = case.clone();
    first["steps"].as_array_mut().expect("steps").pop();
    first["output"]["fields"] = json!(false);
    let other = run(&first, &[]);
    let output = start(other.path(), &case, &["--resume"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let late = frames(&other.path().join("out"), "solid").expect("frames").expect("a list");
    assert_eq!(late.len(), 5);
    for (frame, same) in late.iter().zip(&listed[4..]) {
        let bytes = |folder: &TempDir, file: &str| fs::read(folder.path().join("out").join(file)).expect("a frame");
        assert_eq!(frame.time, same.time);
        assert!(bytes(&other, &frame.file) == bytes(&folder, &same.file), "t = {}", frame.time);
    }
}

/// In frames as in closed form, u_x = u x/L, u_y = −ν u y/L in plane stress, for a body whose name has the signs of XML: another reader finds it.
#[test]
fn of_displacements_in_frames_have_closed_forms() {
    let place = "bodies.a<b>&c.material.nu";
    let case = json!({
        "mesh": Blocks::default().rectangle("a<b>&c", [4, 2], [0.0, 0.0], [2.0, 0.5]).json(),
        "section": {"plane_stress": {"thickness": 0.1}},
        "bodies": {"a<b>&c": {"material": {"model": "linear", "E": 200, "nu": 0.3}}},
        "steps": [{"name": "pull", "duration": 1, "dt": {"initial": 1}, "supports": [
            {"on": "a<b>&c_left", "ux": 0}, {"on": "a<b>&c_bottom", "uy": 0}, {"on": "a<b>&c_right", "ux": 0.01}]}],
        "gradients": [place, "steps.pull.supports[2].ux"],
        "output": {"displacement_gradients": true},
    });
    let folder = run(&case, &[]);
    let out = folder.path().join("out");
    let grid = Grid::read(&out.join("solid/00001.vtu")).expect("a grid");
    let vtkio::model::DataSet::UnstructuredGrid { pieces, .. } =
        vtkio::Vtk::import(out.join("solid/00001.vtu")).expect("a frame").data
    else {
        panic!("an unstructured grid")
    };
    let other = pieces[0].load_piece_data(None).expect("its data").data.point;
    let (length, u, nu) = (2.0, 0.01, 0.3);
    for (by, exact) in [
        (place, Box::new(|[_, y]: [f64; 2]| [0.0, -u * y / length]) as Box<dyn Fn([f64; 2]) -> [f64; 2]>),
        ("steps.pull.supports[2].ux", Box::new(|[x, y]| [x / length, -nu * y / length])),
    ] {
        let name = format!("d(displacement)/d({by})");
        let array = grid.at_points.iter().find(|array| array.name == name).expect("an array");
        for (at, found) in grid.points.iter().zip(array.values.chunks_exact(3)) {
            let expected = exact(*at);
            close(by, found[0], expected[0], 1e-6 * u);
            close(by, found[1], expected[1], 1e-6 * u);
        }
        let read = other.iter().find_map(|attribute| match attribute {
            vtkio::model::Attribute::DataArray(of) if of.name == name => of.data.clone().cast_into::<f64>(),
            _ => None,
        });
        assert_eq!(read.as_ref(), Some(&array.values), "{name}");
    }
}

/// A value at the end of its range is varied inwards: `structure` lets `mu_s` grow only, and `mu_k` fall only. The law is the same on both
/// sides where `structure` is at its bound by as little as nothing acts.
#[test]
fn at_the_end_of_a_range_are_those_on_its_inside() {
    let mut case = dragged(weakening(), json!({"method": "gauss_to_segment"}));
    let (own, near) = (2.0, 2.0 - 1e-6);
    case["gradients"] = json!(["contacts.base.friction.mu_s", "contacts.base.friction.mu_k"]);
    case["contacts"]["base"]["friction"]["structure"] = json!(own);
    let at_bound = table(&run(&case, &[]), "gradients.csv");
    // Inside by 1e-6 of μ, with differences as small, all is nearly the same: both are compared by the differences of complete runs.
    case["contacts"]["base"]["friction"]["structure"] = json!(near);
    case["gradients"] = json!([]);
    case["newton"] = json!({"tolerance": 1e-12, "max_iterations": 40});
    for (place, value, inwards) in [("mu_s", 0.4, 1.0), ("mu_k", 0.2, -1.0)] {
        let at = |share: f64| {
            let mut case = case.clone();
            case["contacts"]["base"]["friction"][place] = json!(value * (1.0 + share));
            table(&run(&case, &[]), "history.csv")["base.tangential_force"].clone()
        };
        let [first, second, third] = [0.0, 1e-3, 2e-3].map(|share| at(inwards * share));
        let step = inwards * 1e-3 * value;
        let column = &at_bound[&format!("d(base.tangential_force)/d(contacts.base.friction.{place})")];
        let expected = first.iter().zip(&second).zip(&third).map(|((a, b), c)| (-1.5 * a + 2.0 * b - 0.5 * c) / step);
        let expected: Vec<f64> = expected.collect();
        let largest = expected.iter().fold(0.0f64, |most, value| most.max(value.abs()));
        column.iter().zip(&expected).for_each(|(found, expected)| close(place, *found, *expected, 1e-4 * largest));
    }
}

/// A block that comes down by its gap, just so: it touches where it moves by a little more, and is apart where it moves by a little less.
#[test]
fn at_kinks_are_counted() {
    let mut case = dragged(json!({"law": "coulomb", "mu": 0.3}), json!({"method": "node_to_segment"}));
    case["mesh"] = Blocks::default()
        .rectangle("ground", [14, 3], [-2.0, -1.0], [5.0, 0.0])
        .rectangle("block", [9, 3], [0.0, 0.01], [2.0, 1.01])
        .json();
    case["steps"].as_array_mut().expect("steps").pop();
    case["gradients"] = json!(["contacts.base.friction.mu", "steps.press.supports[1].uy"]);
    let told = &summary(&run(&case, &[]))["gradients"];
    let nodes = told["steps.press.supports[1].uy"]["one_sided"].as_u64().expect("a number");
    assert!((1..=10).contains(&nodes), "{told}");
    assert_eq!(told["contacts.base.friction.mu"], json!({"one_sided": 0, "lost_at": null}));
}

#[test]
fn that_no_run_has_are_refused_with_the_reason() {
    let plain = dragged(weakening(), json!({"method": "gauss_to_segment"}));
    let asked = |places: Value| {
        let mut case = plain.clone();
        case["gradients"] = places;
        refused(&case)
    };
    let told = asked(json!(["contacts.base.friction.mu_x"]));
    assert!(told.contains("gradients[0]") && told.contains("did you mean `mu_"), "{told}");
    for (place, why) in [
        ("newton.tolerance", "is not a parameter of the run"),
        ("mesh.nodes", "is not a parameter of the run"),
        ("steps.drag.duration", "determines the increments"),
        ("steps.drag.dt.initial", "determines the increments"),
        ("contacts.base.friction.law", "the text \"super_subloading\""),
        ("contacts.base.friction", "an object"),
        ("steps.press.supports[0].ux", "is 0"),
        ("bodies.stone.material.E", "there is no `stone`"),
        ("contacts.base.points", "cannot be"),
    ] {
        let told = asked(json!([place]));
        assert!(told.contains("gradients[0]") && told.contains(place) && told.contains(why), "{place}: {told}");
    }
    let twice = asked(json!(["bodies.block.material.E", "bodies.block.material.E"]));
    assert!(twice.contains("gradients[1]") && twice.contains("given twice"), "{twice}");
    let mut explicit = plain.clone();
    for body in ["block", "ground"] {
        explicit["bodies"][body]["material"]["density"] = json!(1e-4);
    }
    explicit["steps"][1]["scheme"] = json!({"explicit": {}});
    explicit["steps"][1].as_object_mut().expect("keys").remove("dt");
    explicit["gradients"] = json!(["bodies.block.material.E"]);
    let told = refused(&explicit);
    assert!(told.contains("step `drag` is explicit"), "{told}");
}
