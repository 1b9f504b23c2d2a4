//! Pressures given in the pores of bodies: against the same pressure on their faces, in every scheme, and as contacts see them.

use std::fs;
use std::path::Path;

use crate::common::{Blocks, Finished, close, distance, finish, finish_at, goes_on, model, quadratic, refusal};
use serde_json::{Value, json};

/// A pier on rollers, half as wide at the top, of which b p is 0.16 E in the end.
fn pier(section: &str, kind: &str, material: &Value, scheme: &Value, wet: bool) -> Value {
    let mesh = Blocks::default().block("pier", [3, 4], |r, s| [0.2 + r * (1.0 - 0.5 * s), 2.0 * s]).json();
    let mesh = match kind {
        "q8" => quadratic(&mesh, crate::common::half_way),
        _ => mesh,
    };
    let mut body = json!({"material": material});
    if kind == "f_bar" {
        body["element"] = json!("f_bar");
    }
    let mut loads = json!([]);
    if wet {
        body["pore_pressure"] = json!({"pressure": "20*t", "biot": 0.8});
    } else {
        let sides = ["pier_left", "pier_right", "pier_top"];
        loads = sides.map(|side| json!({"on": side, "pressure": {"rate": -16.0}})).to_vec().into();
    }
    json!({
        "section": section, "mesh": mesh, "bodies": {"pier": body}, "newton": {"tolerance": 1e-11},
        "steps": [{"name": "fill", "duration": 1, "scheme": scheme, "dt": {"initial": 0.1}, "loads": loads, "supports": [
            {"on": "pier_bottom", "uy": 0}, {"on": {"near": [0.2, 0]}, "ux": 0}]}],
    })
}

fn dense(model: &str) -> Value {
    json!({"model": model, "E": 100, "nu": 0.3, "density": 0.01})
}

/// In equilibrium an even pressure in the pores is the same suction on the faces, however large the strains are: in plane strain and rings,
/// elastic and yielding, on every element, in statics and in motion.
#[test]
fn an_even_pressure_is_suction_on_the_faces() {
    let still = json!("static");
    let yields = json!({"model": "von_mises", "E": 100, "nu": 0.3, "sigma_y": 4});
    let newmark = json!({"newmark": {}});
    for (section, kind, material, scheme) in [
        ("plane_strain", "q4", dense("neo_hookean"), &still),
        ("plane_strain", "q8", dense("hencky"), &still),
        ("plane_strain", "q4", yields.clone(), &still),
        ("axisymmetric", "q4", dense("neo_hookean"), &still),
        ("plane_strain", "q4", dense("neo_hookean"), &newmark),
        ("plane_strain", "f_bar", dense("neo_hookean"), &still),
    ] {
        let [wet, dry] = [true, false].map(|wet| {
            let mut case = pier(section, kind, &material, scheme, wet);
            if material == yields {
                // Held at the bottom it is sheared.
                case["steps"][0]["supports"] = json!([{"on": "pier_bottom", "ux": 0, "uy": 0}]);
            }
            finish(&case)
        });
        let largest = dry.last().displacement.iter().fold(0.0f64, |most, u| most.max(u.abs()));
        let gap = distance(&wet.last().displacement, &dry.last().displacement) / largest;
        println!("{section}, {kind}, {material}: {largest} apart by {gap:e}");
        assert!(largest > 0.05 && gap < 1e-9, "{section}, {kind}, {material}: {gap:e}");
        for run in [&wet, &dry] {
            let energy = &run.last().energy;
            assert!(material != yields || energy.plastic_dissipation > 0.0, "it does not yield");
            close("energy", energy.error(), 0.0, 5e-3 * energy.external_work.abs());
        }
    }
}

/// A linear pier: pressure by place against the body force that it is, −b ∇p, and suction on the faces.
#[test]
fn a_gradient_of_the_pressure_is_a_force() {
    for kind in ["q4", "q8"] {
        let mut wet = pier("plane_strain", kind, &dense("linear"), &json!("static"), true);
        wet["bodies"]["pier"]["pore_pressure"]["pressure"] = json!("0.5*t*(2 - y)");
        let mut dry = pier("plane_strain", kind, &dense("linear"), &json!("static"), false);
        let gone = json!("-0.8*0.5*t*(2 - y)");
        let steps = &mut dry["steps"][0];
        steps["loads"] =
            ["pier_left", "pier_right"].map(|side| json!({"on": side, "dead_pressure": gone})).to_vec().into();
        // −∇(b p) = (0, 0.4 t) a volume, over the density 0.01
        steps["loads"].as_array_mut().expect("a list").push(json!({"on": "pier", "gravity": {"y": "40*t"}}));
        let [wet, dry] = [wet, dry].map(|case| finish(&case));
        let largest = dry.last().displacement.iter().fold(0.0f64, |most, u| most.max(u.abs()));
        let gap = distance(&wet.last().displacement, &dry.last().displacement) / largest;
        assert!(largest > 1e-3 && gap < 1e-9, "{kind}: {gap:e}");
    }
}

/// Free in its plane a linear plate and a linear body swell by b p/(3 K).
#[test]
fn plates_swell_alike() {
    let mut case = pier("plane_strain", "q4", &dense("linear"), &json!("static"), true);
    case["section"] = json!({"plane_stress": {"thickness": 0.3}});
    let run = finish(&case);
    let top = run.nodes("pier_top")[0];
    close("swelling", run.last().displacement[2 * top + 1], 2.0 * 16.0 * 0.4 / 100.0, 1e-9);
}

/// Explicit increments move as implicit ones of the same length; a run that was stopped goes on to the same bits; the audit closes.
#[test]
fn water_in_motion() {
    let explicit = pier("plane_strain", "q4", &dense("neo_hookean"), &json!({"explicit": {}}), true);
    let mut implicit = pier("plane_strain", "q4", &dense("neo_hookean"), &json!({"newmark": {}}), true);
    implicit["steps"][0]["dt"] = json!({"initial": 1e-3, "max": 1e-3});
    let [fast, slow] = [explicit, implicit.clone()].map(|case| finish(&case));
    let top = 2 * fast.nodes("pier_top")[0] + 1;
    let [a, b] = [&fast, &slow].map(|run| run.last().displacement[top]);
    close("way of the top", a / b, 1.0, 2e-2);
    for run in [&fast, &slow] {
        let energy = &run.last().energy;
        close("energy", energy.error(), 0.0, 5e-3 * energy.external_work.abs());
    }
    implicit["steps"][0]["dt"] = json!({"initial": 0.05});
    let whole = finish(&implicit);
    goes_on(&implicit, &whole, whole.states.len() / 2);
}

/// A block on ground under its weight in water whose level falls: friction by the pressure of the body below.
fn ground(fluid: &Value) -> Finished {
    finish(&ground_case(fluid))
}

fn ground_case(fluid: &Value) -> Value {
    let mesh = Blocks::default()
        .rectangle("block", [4, 2], [0.5, 0.0], [2.5, 1.0])
        .rectangle("ground", [6, 3], [0.0, -1.5], [3.0, 0.0])
        .json();
    let soil = |biot: f64| json!({"material": {"model": "linear", "E": 1000, "nu": 0.3}, "pore_pressure": {"pressure": "(2 + 0.3*x)*t", "biot": biot}});
    json!({
        "mesh": mesh, "bodies": {"block": soil(1.0), "ground": soil(1.0)},
        "contacts": {"base": {"slave": "block_bottom", "master": "ground_top", "friction": {"law": "coulomb", "mu": 0.4}, "fluid_pressure": fluid}},
        "steps": [{"name": "press", "duration": 1, "dt": {"initial": 0.1}, "supports": [
            {"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": {"rate": 0.002}, "uy": {"rate": -0.01}}]}],
    })
}

/// A contact takes the pressure of the pores behind it, which is the one that may be given instead.
#[test]
fn contacts_see_the_water_of_their_bodies() {
    let [taken, given] = [json!("of_bodies"), json!("(2 + 0.3*x)*t")].map(|fluid| ground(&fluid));
    assert!(taken.last() == given.last(), "the same pressure comes to another state");
    let wet = &taken.last().contacts[0];
    assert!(wet.iter().all(|point| point.fluid > 1.0) && wet.iter().any(|point| point.friction.pressure > 1.0));
    close("energy", taken.last().energy.error(), 0.0, 1e-3 * taken.last().energy.external_work);
}

/// Ground whose pressures are measured at its nodes, in a file, as `fluid` of the contact or of the bodies behind it.
fn measured(folder: &Path, bodies: &Value, fluid: &Value) -> Value {
    let mut case = ground_case(fluid);
    case["bodies"]["block"]["pore_pressure"]["pressure"] = bodies.clone();
    case["bodies"]["ground"]["pore_pressure"]["pressure"] = bodies.clone();
    let built = model(&ground_case(&json!(0)));
    let (tags, nodes) = (&built.mesh.node_tags, &built.mesh.nodes);
    let line =
        |head: String, of: &dyn Fn(usize) -> f64| (0..nodes.len()).fold(head, |line, k| format!("{line}, {}", of(k)));
    let head = (0..nodes.len()).fold(String::from("t"), |line, k| format!("{line}, {}", tags[k]));
    let [none, all] = [0.0, 1.0].map(|t| line(t.to_string(), &|k| t * (2.0 + 0.3 * nodes[k].x)));
    fs::write(folder.join("nodes.csv"), format!("{head}\n{none}\n{all}\n")).expect("a file");
    fs::write(folder.join("places.csv"), "t, 0, 3\n0, 0, 0\n1, 2, 2.9\n").expect("a file");
    case
}

/// Tables of times and places, or of times and nodes, are the expression that they were made from: in bodies and at contacts.
#[test]
fn tables_of_places_and_of_nodes_are_what_they_were_made_from() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("case.json");
    let plain = ground(&json!("of_bodies"));
    let [by_place, by_node] = ["x", "nodes"].map(|along| {
        let file = if along == "x" { "places.csv" } else { "nodes.csv" };
        json!({"measured": {"file": file, "along": along}})
    });
    for (bodies, fluid) in [
        (&by_place, &json!("of_bodies")),
        (&by_node, &json!("of_bodies")),
        (&by_node, &by_place),
        (&by_place, &by_node),
    ] {
        let run = finish_at(&measured(folder.path(), bodies, fluid), &path);
        let gap = distance(&run.last().displacement, &plain.last().displacement);
        assert!(gap < 1e-12, "{bodies}, {fluid}: {gap:e}");
        for (here, there) in run.last().contacts[0].iter().zip(&plain.last().contacts[0]) {
            close("p_w", here.fluid, there.fluid, 1e-12);
            close("p", here.friction.pressure, there.friction.pressure, 1e-8);
        }
    }
    let case = measured(folder.path(), &by_node, &json!("of_bodies"));
    for (text, why) in
        [("t, 0, 1\n0, 0, 0\n", "has no pressures of node"), ("t, 0\n0, 0, 0\n", "`nodes.csv`: line 2 has 3 numbers")]
    {
        fs::write(folder.path().join("nodes.csv"), text).expect("a file");
        let told = crate::common::built(&case, &path).expect_err("it is refused").to_string();
        assert!(told.contains("bodies.block.pore_pressure.pressure") && told.contains(why), "{told}");
    }
    let case = measured(folder.path(), &by_node, &json!("of_bodies"));
    let text = fs::read_to_string(folder.path().join("nodes.csv")).expect("a file");
    fs::write(folder.path().join("nodes.csv"), text.replace("\n0, 0", "\n0, 1")).expect("a file");
    let told = crate::common::built(&case, &path).expect_err("it is refused").to_string();
    assert!(told.contains("pressures at nodes count from the start"), "{told}");
}

/// What does not go together is refused with its place, and a contact that ignores the water is warned of.
#[test]
fn what_water_cannot_do_is_refused() {
    let told = |change: &dyn Fn(&mut Value)| {
        let mut case = pier("plane_strain", "q4", &dense("neo_hookean"), &json!("static"), true);
        change(&mut case);
        refusal(&case)
    };
    let place = "bodies.pier.pore_pressure";
    for (key, value, why) in [
        ("pore_fluid", json!({"bulk_modulus": 1e3, "porosity": 0.3}), "which has a pressure of its own"),
        ("pore_pressure", json!({"pressure": 1, "biot": 1.5}), ".biot: is 1.5: it must be above 0 and at most 1"),
        ("pore_pressure", json!({"pressure": "1/(t - 1)"}), ".pressure: is inf at ("),
        ("pore_pressure", json!({"pressure": "ln(x - 1)"}), ".pressure: is NaN at ("),
    ] {
        let why_not = told(&|case| case["bodies"]["pier"][key] = value.clone());
        assert!(why_not.contains(place) && why_not.contains(why), "{why_not}");
    }
    let mut case = pier("plane_strain", "q4", &dense("neo_hookean"), &json!("static"), true);
    case["contacts"] = json!({"base": {"slave": "pier_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
        "friction": {"law": "coulomb", "mu": 0.3}}});
    let warnings = model(&case).warnings();
    assert!(warnings.iter().any(|told| told.contains("its friction depends on the total pressure")), "{warnings:?}");
}

/// Ground at rest under its weight in water whose level falls by 5 m: the settlement of the column is ∫ Δσ′/M dy, with Δσ′ = Δp in the water that is left
/// and γ_w times the height above it.
#[test]
fn ground_settles_where_its_water_falls() {
    let mesh = Blocks::default().rectangle("soil", [1, 10], [0.0, 0.0], [1.0, 10.0]).json();
    let run = finish(&json!({
        "mesh": mesh, "bodies": {"soil": {
            "material": {"model": "linear", "E": 10e3, "nu": 0.3, "density": 2.0},
            "initial_stress": {"geostatic": {"surface": 10, "weight": 10, "K0": 0.5}},
            "pore_pressure": {"pressure": "9.81*max(0, 10 - 5*min(t, 1) - y)"}}},
        "steps": [{"name": "lower", "duration": 1, "dt": {"initial": 0.25}, "loads": [{"on": "soil", "gravity": {"y": "-9.905"}}], "supports": [
            {"on": "soil_bottom", "ux": 0, "uy": 0}, {"on": "soil_left", "ux": 0}, {"on": "soil_right", "ux": 0}]}],
    }));
    let modulus = 10e3 * 0.7 / (1.3 * 0.4);
    let top = run.nodes("soil_top")[0];
    close("settlement", run.last().displacement[2 * top + 1], -9.81 * (25.0 + 12.5) / modulus, 1e-9);
    close("energy", run.last().energy.error(), 0.0, 1e-9);
}
