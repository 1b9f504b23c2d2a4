//! Derivatives of the history by numbers of water that flows along a contact or through a body: closed forms, and central differences of
//! complete runs.

use std::f64::consts::PI;

use crate::common::{Blocks, close};
use crate::gradients::{compared, refused, run, start, summary, table};
use serde_json::{Value, json};

const FLOW: &str = "contacts.base.fluid_pressure.flow";

/// A block that is pressed on a plane, along which water flows from x = 0 to x = 10.
fn block(n: usize, flow: Value, duration: f64, dt: [f64; 2]) -> Value {
    json!({
        "mesh": Blocks::default().rectangle("block", [n, 2], [0.0, 0.0], [10.0, 2.5]).json(),
        "bodies": {"block": {"material": {"model": "linear", "E": 1e4, "nu": 0.2, "density": 1e-3}}},
        "contacts": {"base": {
            "slave": "block_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}}, "sliding": "small",
            "friction": {"law": "coulomb", "mu": 0.6}, "initial": {"pressure": 100, "balanced": true},
            "fluid_pressure": {"flow": flow},
        }},
        "steps": [{"name": "flow", "duration": duration, "dt": {"initial": dt[0], "max": dt[1]},
                   "supports": [{"on": "block_top", "ux": 0, "uy": 0}]}],
        "output": {"fields": false, "report": false},
    })
}

fn places(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| format!("{FLOW}.{name}")).collect()
}

/// A constant rate q into the end of a long contact: p = q √(4 η t/(π S T)) there, whose relative derivatives by S, T, η and q are −½, −½, ½
/// and 1. With 40 elements p itself errs by 1e-3; that −½ − ½ = −1, that T and η act by their ratio, and that p is proportional to q holds in
/// the steps of the water as well.
#[test]
fn of_a_rate_have_a_closed_form() {
    let (storage, transmissivity, viscosity, rate) = (2e-3, 1e-2, 5.0, 0.02);
    let flow = json!({"storage": storage, "transmissivity": transmissivity, "viscosity": viscosity,
                      "wells": [{"at": [0, 0], "rate": rate}]});
    let mut case = block(40, flow, 2.0, [0.5, 0.5]);
    let places = places(&["storage", "transmissivity", "viscosity", "wells[0].rate"]);
    case["gradients"] = json!(places);
    let run = run(&case, &[]);
    let (history, found) = (table(&run, "history.csv"), table(&run, "gradients.csv"));
    let column = "base.largest_fluid_pressure";
    let last = |table: &std::collections::BTreeMap<String, Vec<f64>>, name: &str| *table[name].last().expect("rows");
    let p = last(&history, column);
    close("p", p / (rate * (4.0 * viscosity * 2.0 / (PI * storage * transmissivity)).sqrt()), 1.0, 2e-3);
    // The flow q erfc(x/√(4 T t/(η S))) half an edge and an edge, of 0.25, from the well.
    let flow = last(&history, "base.largest_flow") / rate;
    assert!((0.9005..0.9502).contains(&flow), "{flow}");
    let values = [storage, transmissivity, viscosity, rate];
    let share = |k: usize| last(&found, &format!("d({column})/d({})", places[k])) * values[k] / p;
    let [by_s, by_t, by_eta, by_q] = [0, 1, 2, 3].map(share);
    println!("{by_s} {by_t} {by_eta} {by_q}");
    for (name, found, expected) in [("S", by_s, -0.5), ("T", by_t, -0.5), ("η", by_eta, 0.5)] {
        close(name, found, expected, 2e-3);
    }
    close("S and T", by_s + by_t, -1.0, 1e-7);
    close("T and η", by_t + by_eta, 0.0, 1e-7);
    close("q", by_q, 1.0, 1e-9);
    assert_eq!(summary(&run)["gradients"][&places[0]]["one_sided"], json!(0));
}

/// A block that is dragged while water comes from a well, another one is held, the walls leak and slip, pressure and dilatancy act on the flow.
fn dragged() -> Value {
    let flow = json!({
        "storage": 2e-3, "transmissivity": 2e-4, "viscosity": 5, "per_slip": 2e-3, "closing": 80, "initial": 5, "source": 1e-5,
        "leak": {"coefficient": 1e-4, "pressure": 4},
        "wells": [{"at": [2.6, 0], "rate": 4e-3}, {"at": [7.5, 0], "pressure": {"table": [[0, 5], [10, 8]]}}],
    });
    // So short that each increment is one step of the water.
    let mut case = block(8, flow, 2.0, [0.004, 0.05]);
    let base = &mut case["contacts"]["base"];
    base["friction"] = json!({"law": "coulomb", "mu": 0.3, "alpha_t": 1e5});
    base["normal"] = json!({"alpha_n": 1e6});
    base["dilatancy"] = json!({"rate": 0.01});
    case["steps"][0]["supports"][0]["ux"] = json!({"rate": 0.05});
    case
}

/// By every number of the flow in static increments, and by those of the interface and the body.
#[test]
fn by_every_number_of_the_flow_are_those_of_complete_runs() {
    let flow = places(&[
        "storage",
        "transmissivity",
        "viscosity",
        "per_slip",
        "closing",
        "initial",
        "source",
        "leak.coefficient",
        "leak.pressure",
        "wells[0].rate",
        "wells[0].at[0]",
        "wells[1].pressure.table[1][1]",
    ]);
    let besides = ["contacts.base.dilatancy.rate", "contacts.base.friction.mu", "bodies.block.material.E"];
    let places: Vec<&str> = flow.iter().map(String::as_str).chain(besides).collect();
    let [main, others] = compared(&dragged(), &places);
    println!("{main:?} {others:?}");
    assert!(main.0 < 1e-7 && others.0 < 5e-6, "{main:?} {others:?}");
}

/// Water parts the surfaces and flows by the cubic law: pressures and openings act on each other.
#[test]
fn of_what_opens_are_those_of_complete_runs() {
    let flow = json!({"storage": 1e-3, "aperture": 2e-3, "viscosity": 1e-7, "initial": 0.5, "wells": [{"at": [4, 0], "rate": 1e-2}]});
    let mut case = block(8, flow, 1.0, [0.01, 0.01]);
    case["bodies"]["block"]["material"]["E"] = json!(1e3);
    let base = &mut case["contacts"]["base"];
    base["friction"] = json!({"law": "frictionless"});
    base["normal"] = json!({"alpha_n": 1e5});
    base["initial"] = json!({"pressure": 0.6, "balanced": true});
    let flow = places(&["storage", "aperture", "viscosity", "wells[0].rate"]);
    let places: Vec<&str> = flow.iter().map(String::as_str).chain(["bodies.block.material.E"]).collect();
    let [main, others] = compared(&case, &places);
    println!("{main:?} {others:?}");
    // The steps of the water are those of the increments, but for a few.
    assert!(main.0 < 1e-5 && others.0 < 5e-5, "{main:?} {others:?}");
    // What a run leaves of the agreement of water and equilibrium, its neighbours leave as well.
    case["newton"] = json!({"tolerance": 1e-7});
    let [main, others] = compared(&case, &places[..1]);
    println!("{main:?} {others:?}");
    assert!(main.0 < 1e-5 && others.0 < 5e-5, "{main:?} {others:?}");
}

/// A run that is taken up has the same derivatives, bit by bit; and the run itself is that without derivatives.
#[test]
fn are_the_same_bits_after_a_resume() {
    let mut case = dragged();
    case["steps"][0]["duration"] = json!(0.5);
    let more = json!({"name": "more", "duration": 0.5});
    case["steps"].as_array_mut().expect("steps").push(more);
    let bytes =
        |folder: &tempfile::TempDir, file: &str| std::fs::read(folder.path().join("out").join(file)).expect("a file");
    let plain = run(&case, &[]);
    case["gradients"] = json!(places(&["storage", "wells[0].rate"]));
    let whole = run(&case, &[]);
    assert_eq!(bytes(&plain, "history.csv"), bytes(&whole, "history.csv"));
    let mut first = case.clone();
    first["steps"].as_array_mut().expect("steps").pop();
    let folder = run(&first, &[]);
    let output = start(folder.path(), &case, &["--resume"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(bytes(&whole, "gradients.csv"), bytes(&folder, "gradients.csv"));
}

/// Numbers that decide on increments, or on a node, have none.
#[test]
fn by_times_and_held_places_are_refused() {
    let wells = json!([{"at": [2.6, 0], "rate": {"table": [[0, 0], [0.5, 4e-3]]}, "until": 1}, {"at": [7.5, 0], "pressure": 5, "from": 0.2}]);
    let mut case = dragged();
    case["contacts"]["base"]["fluid_pressure"]["flow"]["wells"] = wells;
    case["contacts"]["base"]["fluid_pressure"]["flow"]["error"] = json!(0.02);
    for (name, why) in [
        ("wells[0].until", "or times of steps"),
        ("wells[0].rate.table[1][0]", "or times of steps"),
        ("wells[1].from", "or times of steps"),
        ("wells[1].at[0]", "acts at the nearest node"),
        ("error", "determines the increments"),
    ] {
        let mut asked = case.clone();
        asked["gradients"] = json!(places(&[name]));
        let told = refused(&asked);
        assert!(told.contains("gradients[0]") && told.contains(name) && told.contains(why), "{name}: {told}");
    }
}

/// Water along a contact that leaks off into the bodies on both sides, which are pressed together and slide, between a well that holds a pressure and one with
/// a rate.
#[test]
fn that_leaks_off_into_bodies_are_those_of_complete_runs() {
    let soil = |permeability: f64| {
        json!({"material": {"model": "hencky", "E": 90, "nu": 0.2}, "pore_fluid": {
            "bulk_modulus": 500, "porosity": 0.4, "permeability": permeability, "unit_weight": 1}})
    };
    let flow = json!({"storage": 0.02, "aperture": 0.1, "viscosity": 1e-3, "leak": {"coefficient": 0.01, "pressure": 0.1},
                      "wells": [{"at": [0, 1], "pressure": 0.1}, {"at": [1, 1], "rate": 1e-2}]});
    let mut case = json!({
        "mesh": Blocks::default().rectangle("low", [5, 3], [0.0, 0.0], [1.2, 1.0]).rectangle("high", [4, 3], [0.0, 1.0], [1.0, 2.0]).json(),
        "bodies": {"low": soil(5.0), "high": soil(10.0)}, "watch": ["high_top"],
        "contacts": {"base": {"slave": "high_bottom", "master": "low_top", "friction": {"law": "coulomb", "mu": 0.3, "alpha_t": 2000},
            "normal": {"alpha_n": 5000}, "fluid_pressure": {"flow": flow}, "dilatancy": {"rate": 0.05}, "initial": {"pressure": 1.0}}},
        "steps": [{"name": "slide", "duration": 0.5, "dt": {"initial": 0.02, "max": 0.05}, "supports": [
            {"on": "low_bottom", "ux": 0, "uy": 0}, {"on": "high_top", "ux": {"rate": 0.02}}],
            "loads": [{"on": "high_top", "dead_pressure": "1"}],
            "drainage": [{"on": "high_top", "pressure": 0}, {"on": "low_bottom", "pressure": 0}]}],
    });
    let besides = [
        "bodies.low.pore_fluid.permeability",
        "bodies.high.material.E",
        "contacts.base.friction.mu",
        "contacts.base.seal",
        "contacts.base.dilatancy.rate",
    ];
    let flow = places(&["storage", "aperture", "viscosity", "leak.coefficient", "wells[0].pressure", "wells[1].rate"]);
    let places: Vec<&str> = flow.iter().map(String::as_str).chain(besides).collect();
    for seal in [1e3, 0.5] {
        case["contacts"]["base"]["seal"] = json!(seal);
        let [main, others] = compared(&case, &places);
        println!("{seal}: {main:?} {others:?}");
        assert!(main.0 < 1e-6 && others.0 < 1e-5, "{seal}: {main:?} {others:?}");
    }
}

/// A column of soil whose water flows out at the top, under a load.
fn column(material: Value, drain: Value) -> Value {
    json!({
        "mesh": Blocks::default().rectangle("soil", [1, 8], [0.0, 0.0], [0.125, 1.0]).json(), "watch": ["soil_top", "soil_bottom"],
        "bodies": {"soil": {"material": material, "pore_fluid": {
            "bulk_modulus": 50, "porosity": 0.4, "permeability": 1, "unit_weight": 1, "biot": 0.9}}},
        "steps": [{"name": "load", "duration": 0.5, "dt": {"initial": 0.01, "max": 0.05}, "supports": [
            {"on": "soil_bottom", "ux": 0, "uy": 0}, {"on": "soil_left", "ux": 0}, {"on": "soil_right", "ux": 0}],
            "loads": [{"on": "soil_top", "dead_pressure": 1}], "drainage": [drain]}],
    })
}

/// Consolidation of small and of large strains, by the numbers of the skeleton, of the water and of where it leaves.
#[test]
fn of_consolidation_are_those_of_complete_runs() {
    let fluid = ["permeability", "porosity", "bulk_modulus", "unit_weight", "biot"];
    let of_fluid: Vec<String> = fluid.iter().map(|name| format!("bodies.soil.pore_fluid.{name}")).collect();
    let of_soil = ["bodies.soil.material.E", "bodies.soil.material.nu", "steps[0].loads[0].dead_pressure"];
    for (model, drain, of_drain) in [
        ("linear", json!({"on": "soil_top", "pressure": 0.3, "filter": 2}), vec!["pressure", "filter"]),
        ("neo_hookean", json!({"on": "soil_top", "flux": 0.1}), vec!["flux"]),
    ] {
        let case = column(json!({"model": model, "E": 0.9, "nu": 0.2}), drain);
        let of_drain: Vec<String> = of_drain.iter().map(|name| format!("steps[0].drainage[0].{name}")).collect();
        let places: Vec<&str> = of_fluid.iter().chain(&of_drain).map(String::as_str).chain(of_soil).collect();
        let [main, others] = compared(&case, &places);
        println!("{model}: {main:?} {others:?}");
        assert!(main.0 < 1e-6 && others.0 < 5e-6, "{model}: {main:?} {others:?}");
    }
}

/// In motion, by each scheme: a column that swings, and wet bodies that slide on each other and pass water through a seal.
#[test]
fn in_motion_are_those_of_complete_runs() {
    let soil = || {
        json!({"material": {"model": "hencky", "E": 90, "nu": 0.2, "density": 1}, "pore_fluid": {
            "bulk_modulus": 500, "porosity": 0.4, "permeability": 0.02, "unit_weight": 1, "biot": 0.9}})
    };
    let slide = json!({
        "mesh": Blocks::default().rectangle("low", [5, 3], [0.0, 0.0], [1.2, 1.0]).rectangle("high", [4, 3], [0.0, 1.0], [1.0, 2.0]).json(),
        "bodies": {"low": soil(), "high": soil()}, "watch": ["high_top"],
        "contacts": {"base": {"slave": "high_bottom", "master": "low_top", "friction": {"law": "coulomb", "mu": 0.3, "alpha_t": 2000},
            "normal": {"alpha_n": 5000}, "seal": 0.01, "initial": {"pressure": 0.0}}},
        "steps": [
            {"name": "load", "duration": 0.1, "dt": {"initial": 0.05}, "supports": [
                {"on": "low_bottom", "ux": 0, "uy": 0}, {"on": "high_top", "ux": 0}], "loads": [{"on": "high_top", "dead_pressure": "1"}]},
            {"name": "slide", "duration": 0.2, "dt": {"initial": 0.02}, "supports": [{"on": "high_top", "ux": {"rate": 0.1}}],
                "drainage": [{"on": "high_top", "pressure": 0.1}, {"on": "low_bottom", "pressure": 0}]}],
    });
    let of_slide = [
        "bodies.low.pore_fluid.permeability",
        "bodies.high.material.density",
        "contacts.base.friction.mu",
        "contacts.base.seal",
    ];
    let material = json!({"model": "neo_hookean", "E": 0.9, "nu": 0.2, "density": 1});
    let swing = column(material, json!({"on": "soil_top", "pressure": 0.3, "filter": 2}));
    let of_swing =
        ["bodies.soil.pore_fluid.permeability", "bodies.soil.pore_fluid.biot", "bodies.soil.material.density"];
    for scheme in
        [json!({"newmark": {}}), json!({"hht": {"alpha": -0.1}}), json!({"generalized_alpha": {"rho_infinity": 0.8}})]
    {
        for (mut case, places) in [(swing.clone(), &of_swing[..]), (slide.clone(), &of_slide[..])] {
            let last = case["steps"].as_array_mut().and_then(|steps| steps.last_mut()).expect("steps");
            last["scheme"] = scheme.clone();
            let [main, others] = compared(&case, places);
            println!("{scheme}: {main:?} {others:?}");
            assert!(main.0 < 1e-6 && others.0 < 5e-5, "{scheme}: {main:?} {others:?}");
        }
    }
}

/// Bodies that come and go with their water, in a deformed model: by the numbers of what is removed, of what stays and of what comes.
#[test]
fn of_stages_are_those_of_complete_runs() {
    let block = |body: &str, [left, right]: [f64; 2], [low, high]: [f64; 2], sides: Value| {
        json!({"body": body, "corners": [[left, low], [right, low], [right, high], [left, high]], "elements": [(4.0 * (right - left)).round(), 4],
               "sides": sides})
    };
    let soil = |pressure: Value| {
        json!({"material": {"model": "hencky", "E": 0.9, "nu": 0.2}, "pore_fluid": {
            "bulk_modulus": 50, "porosity": 0.4, "permeability": 1, "unit_weight": 1, "pressure": pressure}})
    };
    let case = json!({
        "mesh": {"joined": [["dug", "ground", "fill"]], "blocks": [
            block("ground", [0.0, 0.25], [0.0, 1.0], json!(["bottom", null, null, "side"])),
            block("ground", [0.25, 0.5], [0.0, 1.0], json!(["bottom", "side", null, null])),
            block("dug", [0.0, 0.25], [1.0, 1.5], json!([null, null, "crest", "side"])),
            block("fill", [0.25, 0.5], [1.0, 1.5], json!([null, "side", "top", null]))]},
        "bodies": {"ground": soil(json!(0)), "dug": soil(json!(0)), "fill": soil(json!(0))}, "watch": ["top", "crest", "bottom"],
        "steps": [
            {"name": "load", "duration": 0.2, "dt": {"initial": 0.02, "max": 0.05},
             "supports": [{"on": "bottom", "ux": 0, "uy": 0}, {"on": "side", "ux": 0}],
             "loads": [{"on": "crest", "dead_pressure": 0.05}], "drainage": [{"on": "crest", "pressure": 0}]},
            {"name": "dig", "duration": 0.1, "dt": {"initial": 0.02}, "loads": [{"on": "crest", "dead_pressure": null}], "remove": ["dug"]},
            {"name": "fill", "duration": 0.1, "dt": {"initial": 0.02}, "add": ["fill"]},
            {"name": "drain", "duration": 0.5, "dt": {"initial": 0.01, "max": 0.05},
             "loads": [{"on": "top", "dead_pressure": 0.05}], "drainage": [{"on": "top", "pressure": 0}]},
        ],
    });
    let places = [
        "bodies.ground.pore_fluid.permeability",
        "bodies.ground.material.E",
        "bodies.dug.pore_fluid.permeability",
        "bodies.dug.material.E",
        "bodies.fill.pore_fluid.permeability",
        "bodies.fill.pore_fluid.bulk_modulus",
        "bodies.fill.material.E",
        "steps[0].loads[0].dead_pressure",
        "steps[3].loads[0].dead_pressure",
    ];
    let [main, others] = compared(&case, &places);
    println!("{main:?} {others:?}");
    assert!(main.0 < 1e-6 && others.0 < 5e-6, "{main:?} {others:?}");
}

/// Terzaghi's column settles by U(c t/H²)/M, c = M k/γ: of a loaded column with stiff water, k ∂u/∂k = t ∂u/∂t, the difference of the column itself
/// in time; and u is in inverse proportion to E at the same E k.
#[test]
fn of_settlement_by_permeability_are_those_in_time() {
    let mut case = column(json!({"model": "linear", "E": 0.9, "nu": 0.2}), json!({"on": "soil_top", "pressure": 0}));
    case["bodies"]["soil"]["pore_fluid"] =
        json!({"bulk_modulus": 1e6, "porosity": 0.5, "permeability": 1, "unit_weight": 1});
    case["steps"][0]["loads"][0]["dead_pressure"] = json!("1");
    case["steps"][0]["dt"] = json!({"initial": 0.002, "max": 0.002});
    case["gradients"] = json!(["bodies.soil.pore_fluid.permeability", "bodies.soil.material.E"]);
    let run = run(&case, &[]);
    let (history, found) = (table(&run, "history.csv"), table(&run, "gradients.csv"));
    let (times, u) = (&history["time"], &history["soil_top.uy"]);
    let by = |place: &str| &found[&format!("d(soil_top.uy)/d({place})")];
    let [by_k, by_e] = ["bodies.soil.pore_fluid.permeability", "bodies.soil.material.E"].map(by);
    for k in (50..times.len() - 1).step_by(25) {
        let in_time = times[k] * (u[k + 1] - u[k - 1]) / (times[k + 1] - times[k - 1]);
        println!("{} {} {in_time} {}", times[k], by_k[k], by_e[k]);
        close("by k", by_k[k] / in_time, 1.0, 5e-3);
        close("by E", (0.9 * by_e[k] - by_k[k]) / -u[k], 1.0, 1e-4);
    }
}
