//! Water that flows through bodies: against closed forms of consolidation, differences, and its balance.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::common::{Blocks, Finished, close, finish, goes_on, half_way, model, quadratic, refusal};
use crate::terms::{another_displacement, arbitrary_displacement, tangent_error};
use fecontact::equations::Trial;
use fecontact::model::Model;
use fecontact::model::state::{LastIncrement, State};
use serde_json::{Value, json};

/// A mesh of blocks of one kind of elements.
fn mesh(blocks: &Blocks, kind: &str) -> Value {
    let mut mesh = blocks.json();
    if kind.starts_with('t') {
        for list in mesh["elements"].as_object_mut().expect("groups").values_mut() {
            let quads: Vec<[usize; 4]> = serde_json::from_value(list.clone()).expect("quadrilaterals");
            *list = json!(quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect::<Vec<_>>());
        }
    }
    if matches!(kind, "q8" | "t6") { quadratic(&mesh, half_way) } else { mesh }
}

/// Soil of stiffness M = 1 whose water is nearly incompressible and flows with c = 1.
fn soil() -> Value {
    json!({"material": {"model": "linear", "E": 0.9, "nu": 0.2},
           "pore_fluid": {"bulk_modulus": 1e7, "porosity": 0.5, "permeability": 1, "unit_weight": 1}})
}

/// Terzaghi's column of height 1: a load of 1 at once, drained at the top.
fn column(kind: &str, elements: usize, dt: Value) -> Value {
    let blocks = Blocks::default().rectangle("soil", [1, elements], [0.0, 0.0], [1.0 / elements as f64, 1.0]);
    json!({
        "mesh": mesh(&blocks, kind), "bodies": {"soil": soil()},
        "steps": [{"name": "load", "duration": 0.5, "dt": dt, "supports": [
            {"on": "soil_bottom", "ux": 0, "uy": 0}, {"on": "soil_left", "ux": 0}, {"on": "soil_right", "ux": 0}],
            "loads": [{"on": "soil_top", "dead_pressure": "1"}], "drainage": [{"on": "soil_top", "pressure": 0}]}],
    })
}

/// p/p₀ and U of Terzaghi's series at a depth below the drained top.
fn terzaghi(depth: f64, time: f64) -> [f64; 2] {
    let (mut pressure, mut settled) = (0.0, 1.0);
    for k in 0..2000 {
        let m = 0.5 * PI * f64::from(2 * k + 1);
        pressure += 2.0 / m * (m * depth).sin() * (-m * m * time).exp();
        settled -= 2.0 / (m * m) * (-m * m * time).exp();
    }
    [pressure, settled]
}

/// The pressure at the corner nearest to a place.
fn pressure(run: &Finished, state: &State, at: [f64; 2]) -> f64 {
    let flow = run.model.flow.as_ref().expect("water flows");
    let away = |node: usize| (run.model.mesh.nodes[node] - nalgebra::Vector2::from(at)).norm();
    let number = (0..flow.count()).min_by(|&a, &b| away(flow.corners[a]).total_cmp(&away(flow.corners[b])));
    flow.pressure(number.expect("a pressure"), Some(&state.displacement))
}

fn at(run: &Finished, time: f64) -> &State {
    run.states.iter().find(|state| (state.time - time).abs() < 1e-9).expect("a state at that time")
}

/// Terzaghi (1943): degree and pressure at the base, by every element. Increments leave little of the error, which is that of the elements, and falls
/// with the square of their size.
#[test]
fn a_column_consolidates_as_terzaghi_says() {
    close("U(0.05)", terzaghi(1.0, 0.05)[1], 0.25231, 1e-4);
    close("p(0.5)", terzaghi(1.0, 0.5)[0], 0.37078, 1e-4);
    let worst = |kind: &str, elements: usize| {
        let run = finish(&column(kind, elements, json!({"initial": 0.0025})));
        let top = 2 * run.nodes("soil_top")[0] + 1;
        [0.05, 0.1, 0.5].map(|time| {
            let [p, settled] = terzaghi(1.0, time);
            let state = at(&run, time);
            let off = [pressure(&run, state, [0.0, 0.0]) - p, -state.displacement[top] - settled];
            println!(
                "{kind}, {elements} elements, T = {time}: p {p:.5} off by {:.5}, U {settled:.5} off by {:.5}",
                off[0], off[1]
            );
            off[0].abs().max(off[1].abs())
        })
    };
    for (kind, allowed) in [("q8", 5e-3), ("q4", 8e-3), ("t6", 8e-3), ("t3", 1e-2)] {
        let coarse = worst(kind, 8).into_iter().fold(0.0, f64::max);
        assert!(coarse < allowed, "{kind}: {coarse}");
    }
    let fine = worst("q8", 16).into_iter().fold(0.0, f64::max);
    assert!(fine < 1.5e-3, "16 elements: {fine}");
}

/// A seepage face lets no water in: a column that is pulled keeps its water, which takes the whole pull, and one that is pressed then consolidates
/// as Terzaghi says, U(0.5) = 0.76395, all that it settles by being what has left.
#[test]
fn a_seepage_face_lets_water_out_alone() {
    for kind in ["q8", "q4"] {
        let mut case = column(kind, 8, json!({"initial": 0.005}));
        case["steps"][0]["drainage"] = json!([{"on": "soil_top", "seepage": true}]);
        case["steps"][0]["loads"] = json!([{"on": "soil_top", "dead_pressure": "-0.5"}]);
        let press = json!({"name": "press", "duration": 0.5, "loads": [{"on": "soil_top", "dead_pressure": "1"}]});
        case["steps"].as_array_mut().expect("steps").push(press);
        let run = finish(&case);
        let [pulled, pressed] = [0.5, 1.0].map(|time| at(&run, time));
        let top = 2 * run.nodes("soil_top")[0] + 1;
        println!("{kind}: pulled {:.1e}, pressed {:.5}", pulled.displacement[top], -pressed.displacement[top]);
        for height in [0.0, 0.5, 1.0] {
            close("p of the pulled column", pressure(&run, pulled, [0.0, height]), -0.5, 1e-6);
        }
        close("outflow of the pulled column", pulled.water.outlets[0].volume, 0.0, 1e-12);
        close("U(0.5)", -pressed.displacement[top], 0.76395, 3e-3);
        let area = 0.125;
        close("outflow", pressed.water.outlets[0].volume / area, -pressed.displacement[top], 1e-6);
    }
}

/// A load that goes at T = 0.05, by a table or in a step of its own: the formula of second order begins anew after it. Of superposed series; a run that
/// does not begin anew is off by 0.65 % of p₀, one that does by 0.08 % (a program of its own, with the same elements and increments).
#[test]
fn a_jump_within_a_step_is_as_one_between_two() {
    let mut by_table = column("q8", 16, json!({"initial": 0.0025}));
    by_table["steps"][0]["duration"] = json!(0.1);
    let mut split = by_table.clone();
    let table = json!([[0, 1], [0.05, 1], [0.050_000_000_1, 0]]);
    by_table["steps"][0]["loads"] = json!([{"on": "soil_top", "dead_pressure": {"table": table}}]);
    split["steps"][0]["duration"] = json!(0.05);
    split["steps"].as_array_mut().expect("steps").push(json!({"name": "unload", "duration": 0.05,
        "loads": [{"on": "soil_top", "dead_pressure": "0"}]}));
    let [by_table, split] = [by_table, split].map(|case| finish(&case));
    let mut worst = 0.0f64;
    for corner in 0..=16 {
        let place = [0.0, f64::from(corner) / 16.0];
        let [found, beside] = [&by_table, &split].map(|run| pressure(run, run.last(), place));
        close("p", found, beside, 1e-6);
        let expected = terzaghi(1.0 - place[1], 0.1)[0] - terzaghi(1.0 - place[1], 0.05)[0];
        worst = worst.max((found - expected).abs());
    }
    println!("after a jump: p off by {worst:.5} of p0");
    assert!(worst < 1e-3, "{worst}");
    assert_eq!(by_table.states.len(), split.states.len() + 1);
}

/// Increments end where a table has a corner, and error control meets a jump without an increment for each part of it.
#[test]
fn increments_end_at_the_corners_of_tables() {
    let mut case = column("q8", 4, json!({"initial": 0.002, "max": 0.05, "pore_pressure": 0.01}));
    let tables = [json!([[0, 1], [0.0313, 2]]), json!([[0, 0], [0.2, 0], [0.200_000_001, -0.1]])];
    case["steps"][0]["loads"] = json!([{"on": "soil_top", "dead_pressure": {"table": tables[0]}}]);
    case["steps"][0]["supports"] = json!([{"on": "soil_bottom", "ux": 0, "uy": {"table": tables[1]}},
        {"on": "soil_left", "ux": 0}, {"on": "soil_right", "ux": 0}]);
    let run = finish(&case);
    for corner in [0.0313, 0.2, 0.200_000_001] {
        assert!(run.states.iter().any(|state| (state.time - corner).abs() < 1e-14), "none ends at {corner}");
    }
    assert!(run.states.len() < 120, "{} increments", run.states.len());
}

/// A pressure that is prescribed by a table at the top, after a load of 1: Duhamel's integral of Terzaghi's series over the rates of the table. Increments
/// end at its times.
#[test]
fn a_table_prescribes_a_pressure_in_time() {
    let mut case = column("q8", 8, json!({"initial": 0.004}));
    case["steps"][0]["duration"] = json!(0.3);
    let rates = [(0.0, 0.105, 0.5 / 0.105), (0.105, 0.2, -0.5 / 0.095)];
    case["steps"][0]["drainage"] = json!([{"on": "soil_top", "pressure": {"table": [[0, 0], [0.105, 0.5], [0.2, 0]]}}]);
    let run = finish(&case);
    for time in [0.105, 0.2, 0.3] {
        let mut expected = terzaghi(0.5, time)[0];
        for (from, to, rate) in rates {
            let end = time.min(to);
            let middle = |k: u32| from + (f64::from(k) + 0.5) / 400.0 * (end - from);
            let risen: f64 = (0..400).map(|k| 1.0 - terzaghi(0.5, time - middle(k))[0]).sum();
            expected += if end > from { rate * (end - from) / 400.0 * risen } else { 0.0 };
        }
        let found = pressure(&run, at(&run, time), [0.0, 0.5]);
        println!("t = {time}: p {found:.5} ({expected:.5})");
        close("p", found, expected, 5e-3);
    }
    case["steps"][0]["drainage"] = json!([{"on": "soil_top", "pressure": {"table": [[0, 0], [0, 1]]}}]);
    let message = refusal(&case);
    assert!(message.contains("steps[0].drainage[0].pressure.table: the times of the table must increase"), "{message}");
}

/// A flux that only the volume of the body limits is reported, and not one beside a side whose pressure is prescribed.
#[test]
fn a_flux_without_a_prescribed_pressure_is_reported() {
    let warned = |drainage: Value| {
        let mut case = column("q4", 2, json!({"initial": 0.1}));
        case["steps"][0]["drainage"] = drainage;
        model(&case).warnings().join("\n").contains("water flows through `soil_top` by a given flux")
    };
    assert!(warned(json!([{"on": "soil_top", "flux": 0.1}])));
    assert!(!warned(json!([{"on": "soil_top", "flux": 0}])));
    assert!(!warned(json!([{"on": "soil_top", "flux": 0.1}, {"on": "soil_bottom", "pressure": 0}])));
}

/// Water of other units than the ground that it fills is reported: kN/m³ beside N/m³, or a density in the place of a weight; not that of half its weight.
#[test]
fn a_unit_weight_of_other_units_is_reported() {
    let warned = |weight: f64, loads: Value| {
        let mut case = column("q4", 2, json!({"initial": 0.1}));
        case["bodies"]["soil"]["material"]["density"] = json!(2000);
        case["bodies"]["soil"]["pore_fluid"]["unit_weight"] = json!(weight);
        case["steps"][0]["loads"] = loads;
        let warnings = model(&case).warnings().join("\n");
        warnings.contains(&format!("`soil` weighs {weight} per volume (unit_weight), and the body 19620"))
    };
    let pulled = json!([{"on": "soil", "gravity": {"y": "-9.81"}}, {"on": "soil_top", "dead_pressure": "3e4"}]);
    assert!(!warned(9810.0, pulled.clone()));
    assert!(warned(9.81, pulled.clone()));
    assert!(warned(1000.0, pulled));
    assert!(!warned(9.81, json!([{"on": "soil_top", "dead_pressure": "3e4"}])));
}

/// Two quadratic elements on each other have six corners and seven other nodes: twice thirteen displacements, and six pressures.
#[test]
fn a_corner_has_one_pressure() {
    let model = model(&column("q8", 2, json!({"initial": 0.1})));
    assert_eq!(model.unknowns(), 2 * 13 + 6);
    assert_eq!(model.mesh.nodes.len() - model.mesh.water_nodes, 13);
}

/// What is stored and what has left add up to nothing, and the audit of energies closes.
#[test]
fn water_and_energy_are_in_balance() {
    let run = finish(&column("q8", 6, json!({"initial": 0.002, "max": 0.05, "pore_pressure": 0.01})));
    let mut longest = 0.0f64;
    for state in &run.states {
        let [taken, _] = run.model.water_of(0, state).expect("water");
        let outlet = &state.water.outlets[0];
        close("balance", taken + outlet.volume, 0.0, 1e-9 * outlet.volume.abs().max(1e-3));
        longest = longest.max(state.dt);
        close("energy", state.energy.error(), 0.0, 1e-6 * state.energy.external_work);
    }
    assert!(longest > 0.01, "increments do not grow: {longest}");
    let last = run.last();
    assert!(last.water.outlets[0].volume > 0.1);
    let [p, _] = terzaghi(1.0, 0.5);
    close("p", pressure(&run, last, [0.0, 0.0]) - p, 0.0, 1e-2);
}

/// A quarter of Mandel's specimen, 1 × 1, between frictionless rigid plates under a force of 1.
fn mandel(kind: &str, elements: usize) -> Value {
    let blocks = Blocks::default().rectangle("soil", [elements; 2], [0.0, 0.0], [1.0, 1.0]);
    json!({
        "mesh": mesh(&blocks, kind), "bodies": {"soil": soil()}, "plates": [{"on": "soil_top", "moves": "uy_alike"}],
        "steps": [{"name": "load", "duration": 0.5, "dt": {"initial": 0.0025}, "supports": [
            {"on": "soil_bottom", "uy": 0}, {"on": "soil_left", "ux": 0}],
            "loads": [{"on": "soil_top", "total_force": {"y": "-1"}}], "drainage": [{"on": "soil_right", "pressure": 0}]}],
    })
}

/// Mandel (1953): the pressure in the middle rises before it falls. Series of the closed form, ν = 0.2, ν_u = 0.5.
#[test]
fn the_pressure_in_mandels_specimen_rises_first() {
    for (elements, allowed) in [(8, 5e-3), (12, 2.5e-3)] {
        let run = finish(&mandel("q8", elements));
        let side = 2 * run.model.mesh.nodes.iter().position(|x| x.x > 0.999 && x.y < 1e-9).expect("a corner");
        for (time, expected, moved) in
            [(0.05, 1.09888, Some(0.538_729)), (0.1, 1.09541, None), (0.5, 0.59279, Some(0.378_096))]
        {
            let found = pressure(&run, at(&run, time), [0.0, 0.0]) / 0.5;
            println!("{elements} elements, T = {time}: p/p0 {found:.5} ({expected})");
            close("p(0)/p0", found / expected, 1.0, allowed);
            // u_x in F/E
            let way = at(&run, time).displacement[side] * 0.9;
            moved.into_iter().for_each(|moved| close("ux", way / moved, 1.0, 2e-3));
        }
    }
}

/// A body that is strained much in the middle of a run: a state with an increment before it.
fn strained(case: &Value, size: f64) -> (Arc<Model>, State, Vec<f64>) {
    let model: Arc<Model> = model(case).into();
    let mut state = model.initial_state();
    let old = arbitrary_displacement(&model, 2.0 * size);
    state.displacement.clone_from(&old);
    state.last_increment =
        Some(LastIncrement { dt: 0.3, displacement: arbitrary_displacement(&model, size), ends_in_touch: false });
    state.water.change = (0..model.saddle()).map(|k| 1e-3 * (k as f64).sin()).collect();
    state.time = 0.1;
    let u = old.iter().zip(another_displacement(&model, 3.0 * size)).map(|(a, b)| a + b).collect();
    (model, state, u)
}

/// ∂r/∂u of all displacements and pressures, with and without large strains, yielding, a weight of the water, outlets of every kind, and in rings.
#[test]
fn the_tangent_is_that_of_the_residual() {
    let laws = [
        json!({"model": "linear", "E": 0.9, "nu": 0.2}),
        json!({"model": "hencky", "E": 0.9, "nu": 0.2}),
        json!({"model": "von_mises", "E": 0.9, "nu": 0.2, "sigma_y": 0.02, "H": 0.1}),
    ];
    for section in ["plane_strain", "axisymmetric"] {
        for kind in ["q8", "q4", "t6", "t3", "reduced"] {
            for law in &laws {
                // Once more elements than two threads evaluate at a time
                let many = (section, kind, &law["model"]) == ("plane_strain", "q8", &json!("hencky"));
                let elements = if many { [3, 30] } else { [2, 2] };
                let blocks =
                    Blocks::default().block("soil", elements, |r, s| [1.0 + r + 0.1 * s, 0.9 * s + 0.05 * r * s]);
                let mut body = soil();
                body["material"] = law.clone();
                body["pore_fluid"] = json!({"bulk_modulus": 20, "porosity": 0.5, "permeability": 0.3, "permeability_y": 0.1, "unit_weight": 1,
                    "biot": 0.8, "weighs": true, "pressure": "1 - y"});
                if kind == "reduced" {
                    body["element"] = json!("reduced");
                }
                let case = json!({
                    "section": section, "mesh": mesh(&blocks, if kind == "reduced" { "q8" } else { kind }), "bodies": {"soil": body},
                    "steps": [{"name": "load", "duration": 1, "dt": {"initial": 0.1}, "supports": [{"on": "soil_bottom", "ux": 0, "uy": 0}],
                        "drainage": [{"on": "soil_top", "head": 1, "filter": 0.7}, {"on": "soil_right", "flux": 0.1}, {"on": "soil_left", "seepage": true}]}],
                });
                let (model, state, u) = strained(&case, if law["sigma_y"].is_null() && !many { 0.01 } else { 0.001 });
                let trial = Trial::new(&state, &model.steps[0], 0.3, 0.2);
                let error = tangent_error(&model, trial, &u, 1e-6);
                assert!(error < 1e-8, "{section}, {kind}, {law}: {error:.1e}");
            }
        }
    }
}

/// A run that was stopped goes on to the same bits.
#[test]
fn a_stopped_run_goes_on_to_the_same_bits() {
    let mut case = column("q4", 6, json!({"initial": 0.01, "max": 0.1, "pore_pressure": 0.02}));
    case["bodies"]["soil"]["material"] = json!({"model": "hencky", "E": 0.9, "nu": 0.2});
    let whole = finish(&case);
    goes_on(&case, &whole, whole.states.len() / 2);
}

/// Ground under its weight, with water up to its surface, stays at rest; water above it is a head, and a load.
#[test]
fn ground_below_water_rests() {
    for kind in ["q8", "q4", "t6", "t3"] {
        let blocks = Blocks::default().rectangle("soil", [3, 3], [0.0, -3.0], [3.0, 0.0]);
        let mut body = json!({"material": {"model": "linear", "E": 1000, "nu": 0.3, "density": 2}});
        body["pore_fluid"] = json!({"bulk_modulus": 1e5, "porosity": 0.4, "permeability": 0.01, "unit_weight": 10, "weighs": true, "pressure": "10*(0.5 - y)"});
        body["initial_stress"] = json!({"geostatic": {"surface": 0, "weight": 10, "K0": 0.5}});
        let case = json!({
            "mesh": mesh(&blocks, kind), "bodies": {"soil": body},
            "steps": [{"name": "rest", "duration": 1, "dt": {"initial": 0.2}, "supports": [
                {"on": "soil_bottom", "ux": 0, "uy": 0}, {"on": "soil_left", "ux": 0}, {"on": "soil_right", "ux": 0}],
                "loads": [{"on": "soil", "gravity": {"y": "-10"}}, {"on": "soil_top", "pressure": "5"}],
                "drainage": [{"on": "soil_top", "head": 0.5}]}],
        });
        let run = finish(&case);
        let moved = run.last().displacement.iter().fold(0.0f64, |most, u| most.max(u.abs()));
        assert!(moved < 1e-9, "{kind}: {moved:e}");
        assert!(run.last().water.outlets[0].rate.abs() < 1e-9);
    }
}

/// Steady flow down a column is k times the gradient of the head, whichever way it is given.
#[test]
fn steady_flow_is_darcys() {
    let mut case = column("q8", 4, json!({"initial": 1.0}));
    case["bodies"]["soil"]["pore_fluid"]["weighs"] = json!(true);
    case["bodies"]["soil"]["pore_fluid"]["permeability_y"] = json!(0.2);
    case["steps"][0]["duration"] = json!(200);
    case["steps"][0]["dt"] = json!({"initial": 1, "max": 20, "pore_pressure": 0.05});
    case["steps"][0]["loads"] = json!([]);
    case["steps"][0]["drainage"] = json!([{"on": "soil_top", "head": 3}, {"on": "soil_bottom", "head": 1}]);
    let run = finish(&case);
    // 0.2 × 2/1 over the width 1/4
    close("inflow", run.last().water.outlets[0].rate, -0.1, 1e-5);
    close("outflow", run.last().water.outlets[1].rate, 0.1, 1e-5);
    case["steps"][0]["drainage"] =
        json!([{"on": "soil_top", "flux": -0.4}, {"on": "soil_bottom", "pressure": 1, "filter": 2.0}]);
    let run = finish(&case);
    // p − 1 = q/κ
    close("behind the filter", pressure(&run, run.last(), [0.0, 0.0]), 1.2, 1e-5);
    close("outflow", run.last().water.outlets[1].rate, 0.1, 1e-5);
}

/// What is not for water that flows is refused, with its place and a remedy.
#[test]
fn what_cannot_flow_is_refused() {
    let good = column("q4", 2, json!({"initial": 0.1}));
    let fluid = "/bodies/soil/pore_fluid";
    for (place, value, expected) in [
        ("/bodies/soil/pore_fluid/permeability", json!(0), "bodies.soil.pore_fluid.permeability"),
        ("/bodies/soil/pore_fluid/unit_weight", json!(-1), "bodies.soil.pore_fluid.unit_weight"),
        (
            fluid,
            json!({"bulk_modulus": 1, "porosity": 0.5, "permeability": 1}),
            "bodies.soil.pore_fluid.unit_weight: is missing",
        ),
        (fluid, json!({"bulk_modulus": 1, "porosity": 0.5, "unit_weight": 1}), "give its permeability as well"),
        (fluid, json!({"bulk_modulus": 1, "porosity": 0.5, "weighs": true}), "bodies.soil.pore_fluid.weighs"),
        (
            fluid,
            json!({"bulk_modulus": 1, "porosity": 0.5, "permeability": 1, "unit_weight": 1, "biot": 0.4}),
            "at least the porosity",
        ),
        (fluid, json!({"bulk_modulus": 1, "porosity": 0.5}), "steps[0].drainage[0]: is for bodies whose water flows"),
        ("/bodies/soil/element", json!("f_bar"), "bodies.soil.element: is f_bar"),
        ("/section", json!({"plane_stress": {"thickness": 1}}), "plane stress"),
        ("/periodic", json!([["soil_left", "soil_right"]]), "periodic: join sides of `soil`"),
        ("/steps/0/drainage/0", json!({"on": "soil_top"}), "needs exactly one of"),
        ("/steps/0/drainage/0", json!({"on": "soil_top", "head": 1}), "is for water that weighs"),
        ("/steps/0/drainage/0", json!({"on": "soil", "pressure": 1}), "is a body"),
        ("/steps/0/drainage/0", json!({"on": "soil_top", "seepage": true, "filter": 1}), "steps[0].drainage[0].filter"),
        ("/steps/0/drainage/0", json!({"on": "soil_top", "pressure": 0, "filter": 0}), "steps[0].drainage[0].filter"),
        ("/steps/0/drainage/0", json!({"on": "soil_top", "impervious": true}), "no earlier step drains"),
        ("/steps/0/dt/pore_pressure", json!(-1), "steps[0].dt.pore_pressure"),
        ("/bodies/soil/thermal", json!({"expansion": 1e-3}), "bodies.soil.thermal: is heated"),
        (
            fluid,
            json!({"bulk_modulus": 1, "porosity": 0.5, "permeability": 1, "unit_weight": 1, "capillary": 0.1}),
            "is for water that weighs",
        ),
    ] {
        let mut case = good.clone();
        let (parent, key) = place.rsplit_once('/').expect("a place");
        let target = case.pointer_mut(parent).expect("a parent");
        if let Some(list) = target.as_array_mut() {
            list[0] = value.clone();
        } else {
            target[key] = value.clone();
        }
        if key == "scheme" {
            case["bodies"]["soil"]["material"]["density"] = json!(1);
        }
        let message = refusal(&case);
        assert!(message.contains(expected), "{place} = {value}: {message}");
    }
}

/// The control of pressures without water that flows is refused.
#[test]
fn control_of_pressures_needs_water_that_flows() {
    let second = json!({"name": "more", "duration": 1, "dt": {"initial": 0.1, "pore_pressure": 0.1}});
    let mut dry = column("q4", 2, json!({"initial": 0.1}));
    dry["bodies"]["soil"].as_object_mut().expect("a body").remove("pore_fluid");
    dry["steps"][0].as_object_mut().expect("a step").remove("drainage");
    let first = dry["steps"][0].clone();
    dry["steps"] = json!([first, second]);
    let message = refusal(&dry);
    assert!(message.contains("steps[1].dt.pore_pressure: is for water that flows"), "{message}");
}

/// Contacts beside flowing water take its pressure from there.
#[test]
fn a_contact_beside_flowing_water_has_its_pressure() {
    let blocks = Blocks::default().rectangle("soil", [4, 4], [0.0, 0.0], [1.0, 1.0]).rectangle(
        "plate",
        [4, 1],
        [0.0, 1.0],
        [1.0, 1.2],
    );
    let case = |contact: Value| {
        json!({
            "mesh": mesh(&blocks, "q4"), "bodies": {"soil": soil(), "plate": {"material": {"model": "linear", "E": 100, "nu": 0}}},
            "contacts": {"top": contact},
            "steps": [{"name": "load", "duration": 0.5, "dt": {"initial": 0.01}, "supports": [
                {"on": "soil_bottom", "ux": 0, "uy": 0}, {"on": "soil_left", "ux": 0}, {"on": "soil_right", "ux": 0}, {"on": "plate_top", "ux": 0}],
                "loads": [{"on": "plate_top", "dead_pressure": "1"}], "drainage": [{"on": "soil_bottom", "pressure": 0}]}],
        })
    };
    let coulomb = json!({"slave": "plate_bottom", "master": "soil_top", "friction": {"law": "coulomb", "mu": 0.3}});
    let mut of_bodies = coulomb.clone();
    of_bodies["fluid_pressure"] = json!("of_bodies");
    let message = refusal(&case(of_bodies));
    assert!(message.contains("contacts.top.fluid_pressure"), "{message}");
    let mut smooth = coulomb;
    smooth["friction"] = json!({"law": "frictionless"});
    let run = finish(&case(smooth));
    // Drained below, under an even load: Terzaghi's column upside down, 4 elements high.
    for time in [0.1, 0.5] {
        let p = terzaghi(1.0, time)[0];
        close("p below the plate", pressure(&run, at(&run, time), [0.0, 1.0]), p, 2.5e-2);
    }
}
