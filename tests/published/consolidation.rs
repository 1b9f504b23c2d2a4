//! Water that flows through ground, against closed forms and independent computations.
//!
//! Cryer's sphere: C. W. Cryer (1963), Q. J. Mech. Appl. Math. 16, 401, by inversion of its Laplace transform. A column at large strains: finite volumes
//! of one dimension. A pile that was driven: M. F. Randolph & C. P. Wroth (1979), Int. J. Numer. Anal. Meth. Geomech. 3, 217. A sheet pile: K'/2K of
//! M. E. Harr, Groundwater and Seepage (1962). A dam: I. A. Charny (1951), (h₁² − h₂²)/2L. A strip load on a half plane: by Fourier and Laplace transforms
//! of the equations of J. McNamee & R. E. Gibson (1960), Q. J. Mech. Appl. Math. 13, 210.

use crate::common::{Blocks, Finished, close, finish, half_way, half_way_round, quadratic};
use fecontact::model::state::State;
use nalgebra::Vector2;
use serde_json::{Value, json};

/// The pressure at the corner nearest to a place.
fn pressure(run: &Finished, state: &State, at: [f64; 2]) -> f64 {
    let flow = run.model.flow.as_ref().expect("water flows");
    let away = |k: &usize| {
        flow.corners[*k].map_or(f64::INFINITY, |node| (run.model.mesh.nodes[node] - Vector2::from(at)).norm())
    };
    let number = (0..flow.count()).min_by(|a, b| away(a).total_cmp(&away(b)));
    flow.pressure(number.expect("a pressure"), Some(&state.displacement))
}

/// A value at a time, linear between states.
fn at(run: &Finished, time: f64, value: impl Fn(&State) -> f64) -> f64 {
    let after = run.states.iter().position(|state| state.time >= time - 1e-12).expect("a state after it");
    let end = &run.states[after];
    let Some(start) = after.checked_sub(1).map(|before| &run.states[before]) else { return value(end) };
    let share = (time - start.time) / (end.time - start.time);
    (1.0 - share) * value(start) + share * value(end)
}

/// Soil of stiffness M = 1 and c = 1.
fn soil(model: &str, nu: f64) -> Value {
    let young = (1.0 + nu) * (1.0 - 2.0 * nu) / (1.0 - nu);
    json!({"material": {"model": model, "E": young, "nu": nu},
           "pore_fluid": {"bulk_modulus": 1e6, "porosity": 0.5, "permeability": 1, "unit_weight": 1}})
}

/// In the middle of a sphere that is loaded and drains all around the pressure rises at first.
#[test]
fn cryers_sphere() {
    for (nu, values, peak) in [
        (0.0, [(0.05, 1.55733), (0.1, 1.47551), (0.2, 0.997153)], 1.5754),
        (1.0 / 3.0, [(0.05, 1.20557), (0.1, 0.985911), (0.2, 0.486976)], 1.2090),
    ] {
        let round = |r: f64, s: f64| [r * (1.0 - 0.5 * s * s).sqrt(), s * (1.0 - 0.5 * r * r).sqrt()];
        let blocks = Blocks::default().block("soil", [10, 10], round);
        let case = json!({
            "section": "axisymmetric", "mesh": quadratic(&blocks.json(), half_way_round), "bodies": {"soil": soil("linear", nu)},
            "steps": [{"name": "load", "duration": 0.2, "dt": {"initial": 5e-4, "max": 0.004, "pore_pressure": 0.003},
                "supports": [{"on": "soil_left", "ux": 0}, {"on": "soil_bottom", "uy": 0}],
                "loads": [{"on": "soil_right", "dead_pressure": "1"}, {"on": "soil_top", "dead_pressure": "1"}],
                "drainage": [{"on": "soil_right", "pressure": 0}, {"on": "soil_top", "pressure": 0}]}],
        });
        let run = finish(&case);
        let middle = |state: &State| pressure(&run, state, [0.0, 0.0]);
        for (time, expected) in values {
            let found = at(&run, time, middle);
            println!("nu {nu:.3}, T {time}: {found:.5} ({expected}), {} increments", run.states.len());
            close("p in the middle", found / expected, 1.0, 1.8e-2);
        }
        let highest = run.states.iter().map(middle).fold(0.0, f64::max);
        println!("nu {nu:.3}: highest {highest:.5} ({peak})");
        close("highest p", highest / peak, 1.0, 1.8e-2);
    }
}

/// A column of Hencky's law under loads up to 0.3 M: settlement over the final one.
#[test]
fn a_column_at_large_strains() {
    for (load, expected, base, last) in [
        (0.02, 0.780_073, 0.353_437, 0.019_420_5),
        (0.1, 0.838_014, 0.284_401, 0.087_234_7),
        (0.2, 0.895_923, 0.202_732, 0.155_42),
        (0.3, 0.9382, f64::NAN, 0.210_816),
    ] {
        let blocks = Blocks::default().rectangle("soil", [1, 16], [0.0, 0.0], [0.0625, 1.0]);
        let case = json!({
            "mesh": quadratic(&blocks.json(), half_way), "bodies": {"soil": soil("hencky", 0.2)},
            "steps": [{"name": "load", "duration": 0.5, "dt": {"initial": 0.0005, "max": 0.01, "pore_pressure": 0.002 * load}, "supports": [
                {"on": "soil_bottom", "ux": 0, "uy": 0}, {"on": "soil_left", "ux": 0}, {"on": "soil_right", "ux": 0}],
                "loads": [{"on": "soil_top", "dead_pressure": format!("{load}")}], "drainage": [{"on": "soil_top", "pressure": 0}]}],
        });
        let run = finish(&case);
        let top = 2 * run.nodes("soil_top")[0] + 1;
        let degree = -run.last().displacement[top] / last;
        let p = pressure(&run, run.last(), [0.0, 0.0]) / load;
        println!("q/M {load}: U {degree:.5} ({expected}), p {p:.5} ({base}), {} increments", run.states.len());
        close("degree", degree / expected, 1.0, 5e-3);
        assert!(base.is_nan() || (p / base - 1.0).abs() < 2e-2, "p {p}, {base}");
    }
}

/// Around a pile that was driven the pressure falls by radial consolidation, in ground that begins in balance.
#[test]
fn ground_around_a_driven_pile() {
    let (far, plastic) = (400.0, 10.0);
    let ratio = 1.12f64;
    let radius = move |i: f64| match i {
        i if i <= 32.0 => 1.0 + (plastic - 1.0) * i / 32.0,
        i => plastic + (far - plastic) * (ratio.powf(i - 32.0) - 1.0) / (ratio.powi(48) - 1.0),
    };
    let blocks = Blocks::default().block("soil", [80, 1], |r, s| [radius(80.0 * r), s]);
    let excess = format!("max(0, 2*ln({plastic}/x))");
    let mut body = soil("linear", 0.3);
    body["pore_fluid"]["pressure"] = json!(excess);
    body["initial_stress"] = json!({"components": {"xx": excess, "yy": excess, "zz": excess}});
    let case = json!({
        "section": "axisymmetric", "mesh": quadratic(&blocks.json(), half_way), "bodies": {"soil": body},
        "steps": [{"name": "wait", "duration": 30, "dt": {"initial": 0.01, "max": 1, "pore_pressure": 0.003},
            "supports": [{"on": "soil", "uy": 0}, {"on": "soil_left", "ux": 0}, {"on": "soil_right", "ux": 0}],
            "drainage": [{"on": "soil_right", "pressure": 0}]}],
    });
    let run = finish(&case);
    for (time, expected) in [(1.0, 3.00198), (10.0, 1.33721), (30.0, 0.62383)] {
        let found = at(&run, time, |state| pressure(&run, state, [1.0, 0.0]));
        println!("T {time}: {found:.5} ({expected}), {} increments", run.states.len());
        close("p at the pile", found / expected, 1.0, 1e-2);
    }
}

/// Ground of one material between y = −1 and 0, on nodes of equal parts from x = 0 to 1 and of growing ones to 6.
fn layer(elements: usize) -> Value {
    let x = move |r: f64| {
        if r <= 0.5 { 2.0 * r } else { 1.0 + 5.0 * ((2.0 * r - 1.0) * 1.8f64).exp_m1() / 1.8f64.exp_m1() }
    };
    let blocks = Blocks::default().block("soil", [2 * elements, elements], |r, s| [x(r), s - 1.0]);
    let mut mesh = blocks.json();
    // The side at x = 0 above and below the tip.
    let left: Vec<Vec<usize>> = serde_json::from_value(mesh["edges"]["soil_left"].clone()).expect("edges");
    let nodes: Vec<[f64; 2]> = serde_json::from_value(mesh["nodes"].clone()).expect("nodes");
    let below: Vec<&Vec<usize>> =
        left.iter().filter(|edge| edge.iter().all(|&node| nodes[node][1] < -0.5 + 1e-9)).collect();
    mesh["edges"]["below"] = json!(below);
    quadratic(&mesh, half_way)
}

/// Under a sheet pile half as deep as the layer flows k h/2: half of it by symmetry, with half the head below the tip.
#[test]
fn seepage_under_a_sheet_pile() {
    let mut body = soil("linear", 0.2);
    body["pore_fluid"]["weighs"] = json!(true);
    body["pore_fluid"]["pressure"] = json!("-y");
    let found = [8, 16].map(|elements| {
        let run = finish(&json!({
            "mesh": layer(elements), "bodies": {"soil": body},
            "steps": [{"name": "seep", "duration": 2000, "dt": {"initial": 1, "max": 500, "pore_pressure": 0.1},
                "supports": [{"on": "soil_bottom", "ux": 0, "uy": 0}, {"on": "soil_left", "ux": 0}, {"on": "soil_right", "ux": 0}],
                "drainage": [{"on": "soil_top", "head": 0}, {"on": "below", "head": 0.5}]}],
        }));
        let [out, into] = [0, 1].map(|k| run.last().water.outlets[k].rate);
        println!("{elements} elements: q/kh {out:.5} (0.5), {} increments", run.states.len());
        close("what comes out", out / -into, 1.0, 1e-4);
        out
    });
    // The flow is singular at the tip: the error halves with the elements.
    close("flow", found[1], 0.5, 0.02);
    assert!((found[1] - 0.5).abs() < 0.6 * (found[0] - 0.5).abs());
}

/// Through a dam with vertical sides and a seepage face flows (h₁² − h₂²)/2L, up to what the capillary fringe carries.
#[test]
fn a_dam_with_a_free_surface() {
    let blocks = Blocks::default().rectangle("soil", [20, 20], [0.0, 0.0], [1.0, 1.0]);
    let mut mesh = blocks.json();
    let right: Vec<Vec<usize>> = serde_json::from_value(mesh["edges"]["soil_right"].clone()).expect("edges");
    let nodes: Vec<[f64; 2]> = serde_json::from_value(mesh["nodes"].clone()).expect("nodes");
    let (low, high): (Vec<_>, Vec<_>) =
        right.iter().partition(|edge| edge.iter().all(|&node| nodes[node][1] < 0.25 + 1e-9));
    mesh["edges"]["tailwater"] = json!(low);
    mesh["edges"]["face"] = json!(high);
    let mut body = soil("linear", 0.2);
    let fluid = &mut body["pore_fluid"];
    (fluid["weighs"], fluid["capillary"], fluid["pressure"]) = (json!(true), json!(0.02), json!("max(0.6 - y, 0)"));
    let run = finish(&json!({
        "mesh": mesh, "bodies": {"soil": body},
        "steps": [{"name": "seep", "duration": 2000, "dt": {"initial": 0.02, "min": 1e-4, "max": 500, "pore_pressure": 0.05},
            "supports": [{"on": "soil_bottom", "ux": 0, "uy": 0}],
            "drainage": [{"on": "soil_left", "head": 1}, {"on": "tailwater", "head": 0.25}, {"on": "face", "seepage": true}]}],
    }));
    let rates: Vec<f64> = run.last().water.outlets.iter().map(|outlet| outlet.rate).collect();
    println!("q/k {rates:?} (0.46875), {} increments", run.states.len());
    close("through the dam", -rates[0] / 0.468_75, 1.0, 3e-2);
    assert!(rates[2] > 0.05, "nothing seeps out of the face");
}

/// A strip load on half of a half plane: the pressure below its middle, and how far that settles in time.
#[test]
#[ignore = "takes a minute"]
fn a_strip_load() {
    let nu = 0.3;
    let young = (1.0 + nu) * (1.0 - 2.0 * nu) / (1.0 - nu);
    let shear = young / (2.0 * (1.0 + nu));
    // Bounds nearer than this are felt by the settlement: those at 30 take 1 % of it.
    let far = 120.0;
    let graded = |i: f64, fine: f64, size: f64, (count, ratio): (f64, f64)| match i {
        i if i <= fine => size * i / fine,
        i => size + (far - size) * (f64::powf(ratio, i - fine) - 1.0) / (f64::powf(ratio, count) - 1.0),
    };
    let blocks = Blocks::default().block("soil", [24, 26], |r, s| {
        [graded(24.0 * r, 8.0, 1.0, (16.0, 1.41)), -graded(26.0 * (1.0 - s), 12.0, 2.0, (14.0, 1.47))]
    });
    let mut mesh = blocks.json();
    let top: Vec<Vec<usize>> = serde_json::from_value(mesh["edges"]["soil_top"].clone()).expect("edges");
    let nodes: Vec<[f64; 2]> = serde_json::from_value(mesh["nodes"].clone()).expect("nodes");
    let loaded: Vec<&Vec<usize>> =
        top.iter().filter(|edge| edge.iter().all(|&node| nodes[node][0] < 1.0 + 1e-9)).collect();
    mesh["edges"]["strip"] = json!(loaded);
    let run = finish(&json!({
        "mesh": quadratic(&mesh, half_way), "bodies": {"soil": soil("linear", nu)},
        "steps": [{"name": "load", "duration": 1, "dt": {"initial": 5e-4, "max": 0.02, "pore_pressure": 0.0005},
            "supports": [{"on": "soil_bottom", "ux": 0, "uy": 0}, {"on": "soil_left", "ux": 0}, {"on": "soil_right", "ux": 0}],
            "loads": [{"on": "strip", "dead_pressure": "1"}], "drainage": [{"on": "soil_top", "pressure": 0}]}],
    }));
    for (time, expected) in [(0.1, 0.529_113), (1.0, 0.170_122)] {
        let found = at(&run, time, |state| pressure(&run, state, [0.0, -1.0]));
        println!("T {time}: {found:.5} ({expected}), {} increments", run.states.len());
        close("p", found / expected, 1.0, 1.5e-2);
    }
    let middle = 2 * run.model.mesh.nodes.iter().position(|x| x.norm() < 1e-9).expect("a node") + 1;
    let [early, late] = [0.1, 1.0].map(|time| at(&run, time, |state| -state.displacement[middle]));
    println!("settlement between: {:.5} (0.24276)", 2.0 * shear * (late - early));
    close("settlement between", 2.0 * shear * (late - early) / 0.242_755, 1.0, 1.5e-2);
}
