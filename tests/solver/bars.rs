//! Trusses and beams: closed forms, tangents, stages, energies, and input that is refused.

use std::f64::consts::PI;
use std::sync::Arc;

use fecontact::bars::BarState;
use fecontact::bars::vectors::Vectors;
use fecontact::equations::term::Term;
use fecontact::equations::{Assembler, Trial};
use nalgebra::DMatrix;
use serde_json::{Value, json};

use crate::common::{Blocks, Finished, close, finish, model};
use crate::terms::{arbitrary_displacement, tangent_error};

/// A mesh of points, and a case with bars on it alone.
fn frame(points: Value, bars: Value, steps: Value) -> Value {
    let nodes: Vec<&Value> = points.as_object().expect("points").values().collect();
    let names = points.as_object().expect("points").keys().enumerate();
    let groups: serde_json::Map<String, Value> = names.map(|(k, name)| (name.clone(), json!([k]))).collect();
    json!({"mesh": {"nodes": nodes, "points": groups}, "bars": bars, "steps": steps})
}

/// Displacement of a group of one node.
fn at(run: &Finished, group: &str) -> [f64; 2] {
    let node = run.nodes(group)[0];
    [run.last().displacement[2 * node], run.last().displacement[2 * node + 1]]
}

fn error_of_energy(run: &Finished) -> f64 {
    let energy = &run.last().energy;
    energy.error().abs() / energy.supplied()
}

/// Elastica: a cantilever of length 1 with EI = 1 under an end load across, by K. Mattiasson (1981), Int. J. Numer. Methods Eng. 17,
/// 145, table 1: displacements across and along. Errors are of second order in the segments.
#[test]
fn a_cantilever_bends_like_the_elastica() {
    for (load, across, along) in [(1.0, 0.301_72, 0.056_43), (5.0, 0.713_79, 0.387_63), (10.0, 0.810_61, 0.555_00)] {
        let error = |segments: usize| {
            let bar = json!({"points": [[3, 4], [3, 5]], "ea": 1e7, "ei": 1, "segments": segments,
                "start": {"on": "wall", "clamped": true}});
            let step = json!([{"name": "load", "duration": 1, "dt": {"initial": 0.1},
                "supports": [{"on": "wall", "ux": 0, "uy": 0}], "loads": [{"on": "beam_end", "force": {"x": load}}]}]);
            let run = finish(&frame(json!({"wall": [3, 4]}), json!({"beam": bar}), step));
            let [w, u] = at(&run, "beam_end");
            [w - across, -u - along]
        };
        let [coarse, fine] = [20, 40].map(error);
        for i in 0..2 {
            assert!(fine[i].abs() < 5e-4, "load {load}: {fine:?}");
            // Second order, as far as the five digits of the table show it.
            assert!(
                coarse[i].abs() < 2e-5 || fine[i].abs() < 0.3 * coarse[i].abs() + 1e-5,
                "load {load}: {coarse:?}, {fine:?}"
            );
        }
    }
}

/// Two bars of a shallow truss are pushed through: 2 N sin φ, N = EA (l − l₀)/l₀ at every height.
#[test]
fn a_shallow_truss_snaps_through() {
    let bars = json!({
        "truss": {"points": [[-1, 0], [0, 0.2], [1, 0]], "ea": 100, "start": {"on": "left"}, "end": {"on": "right"}},
    });
    let hold = |on: &str| json!({"on": on, "ux": 0, "uy": 0});
    let step = json!([{"name": "push", "duration": 1, "dt": {"initial": 0.05},
        "supports": [hold("left"), hold("right"), {"on": "tip", "ux": 0, "uy": -0.5}]}]);
    let mut case = frame(json!({"left": [-1, 0], "right": [1, 0], "tip": [0, 0.2]}), bars, step);
    case["bars"]["half"] =
        json!({"points": [[0, 0.2], [1, 0]], "ea": 100, "start": {"on": "tip"}, "end": {"on": "right"}});
    case["bars"]["truss"] =
        json!({"points": [[-1, 0], [0, 0.2]], "ea": 100, "start": {"on": "left"}, "end": {"on": "tip"}});
    let run = finish(&case);
    let l0 = f64::hypot(1.0, 0.2);
    let mut largest = 0.0_f64;
    for state in &run.states {
        let y = 0.2 - 0.5 * state.time;
        let l = f64::hypot(1.0, y);
        let force = 2.0 * 100.0 * (l - l0) / l0 * y / l;
        close("force of the tip", run.reaction("tip", state)[1], force, 1e-12);
        largest = largest.max(force.abs());
    }
    assert!(largest > 0.29, "it goes over the top: {largest}");
    assert!(error_of_energy(&run) < 0.02);
}

/// Ground that does not move, 4 × 2, with a bar along its middle line.
fn grouted(bar: Value, supports: Value, loads: Value, dt: f64) -> Value {
    let mesh = Blocks::default().rectangle("soil", [8, 2], [0.0, -1.0], [4.0, 1.0]);
    let soil = json!({"material": {"model": "linear", "E": 1e6, "nu": 0.3, "density": 1}});
    let mut held = vec![json!({"on": "soil", "ux": 0, "uy": 0})];
    held.extend(supports.as_array().expect("supports").clone());
    json!({"mesh": mesh.json(), "bodies": {"soil": soil}, "bars": {"bar": bar}, "watch": ["bar_start"],
        "steps": [{"name": "pull", "duration": 1, "dt": {"initial": dt}, "supports": held, "loads": loads}]})
}

const EA: f64 = 1e4;
const K: f64 = 1e3;

fn grouted_bar(segments: usize, bond: Value) -> Value {
    json!({"points": [[0, 0], [4, 0]], "ea": EA, "segments": segments, "embedded": {"in": ["soil"], "bond": bond}})
}

/// Shear lag: u = P/(EA λ) cosh λ(L − x)/sinh λL, λ² = k/EA, with an error of second order in the segments.
#[test]
fn a_grouted_bar_is_pulled_like_shear_lag() {
    let lambda = (K / EA).sqrt();
    let error = |segments: usize| {
        let load = json!([{"on": "bar_start", "force": {"x": -10}}]);
        let run = finish(&grouted(grouted_bar(segments, json!({"stiffness": K})), json!([]), load, 0.5));
        assert!(error_of_energy(&run) < 1e-9);
        let exact = |x: f64| 10.0 / (EA * lambda) * (lambda * (4.0 - x)).cosh() / (lambda * 4.0).sinh();
        [at(&run, "bar_start")[0] / -exact(0.0) - 1.0, at(&run, "bar_end")[0] / -exact(4.0) - 1.0]
    };
    let [coarse, fine] = [10, 20].map(error);
    for (coarse, fine) in coarse.into_iter().zip(fine) {
        assert!(fine.abs() < 5e-4 && (coarse / fine - 4.0).abs() < 0.1, "{coarse:e}, {fine:e}");
    }
}

/// Pulled out it bears c L, and c_r L once it has slipped by D; the energies balance.
#[test]
fn a_grouted_bar_bears_its_strength() {
    let pull = json!([{"on": "bar_start", "ux": -0.05}]);
    let run = |bond: Value, dt: f64| finish(&grouted(grouted_bar(20, bond), pull.clone(), json!([]), dt));
    let plain = run(json!({"stiffness": K, "strength": 2}), 0.05);
    close("c L", -plain.reaction("bar_start", plain.last())[0], 8.0, 1e-9);
    assert!(error_of_energy(&plain) < 0.01, "{}", error_of_energy(&plain));
    let soft = run(json!({"stiffness": K, "strength": 2, "residual": 0.5, "slip": 0.02}), 0.02);
    close("c_r L", -soft.reaction("bar_start", soft.last())[0], 2.0, 1e-9);
    let largest = soft.states.iter().map(|state| -soft.reaction("bar_start", state)[0]).fold(0.0, f64::max);
    assert!(largest > 6.0 && largest < 8.0, "{largest}");
    let slips: Vec<f64> = soft.last().bars[0].grips.iter().map(|grip| -grip.slip).collect();
    assert!(slips.iter().all(|slip| *slip > 0.02), "{slips:?}");
}

/// Beam on elastic ground (Hetényi 1946): w = Pλ/2k, M = P/4λ, λ⁴ = k/4EI, under a force in the middle of a long one.
#[test]
fn a_beam_on_elastic_ground_bends_like_hetenyis() {
    let (ei, k) = (100.0, 50.0);
    let lambda = f64::powf(k / (4.0 * ei), 0.25);
    let mesh = Blocks::default().rectangle("soil", [10, 2], [-10.0, -1.0], [10.0, 1.0]);
    let error = |segments: usize| {
        let bar = json!({"points": [[-10, 0], [10, 0]], "ea": 1e6, "ei": ei, "segments": segments,
            "embedded": {"in": ["soil"], "bond": {"stiffness": 1, "normal": k}}});
        let strut = json!({"points": [[0, 0], [0, 3]], "ea": 1e6, "start": {"on": "beam"}});
        let case = json!({"mesh": mesh.json(), "bars": {"beam": bar, "strut": strut},
            "bodies": {"soil": {"material": {"model": "linear", "E": 1e6, "nu": 0.3}}},
            "steps": [{"name": "load", "duration": 1, "dt": {"initial": 1.0},
                "supports": [{"on": "soil", "ux": 0, "uy": 0}, {"on": "strut_end", "ux": 0}],
                "loads": [{"on": "strut_end", "force": {"y": -1e-4}}]}]});
        let run = finish(&case);
        let summary = run.model.bars[0].summary(&run.last().bars[0]);
        let w = -at(&run, "strut_start")[1] * 1e4;
        [w / (lambda / (2.0 * k)) - 1.0, summary.moment * 1e4 * 4.0 * lambda - 1.0]
    };
    let [coarse, fine] = [40, 80].map(error);
    for i in 0..2 {
        assert!(fine[i].abs() < 6e-3 && fine[i].abs() < 0.3 * coarse[i].abs(), "{coarse:?}, {fine:?}");
    }
}

/// A straight column between hinges is stable below π² EI/L² and not above: the least eigenvalue of its tangent changes sign there, to
/// second order in the segments (4 EI/l² sin²(πl/2L) exactly for the chain).
#[test]
fn a_column_buckles_at_eulers_load() {
    let segments = 20;
    let bar = json!({"points": [[0, 0], [0, 2]], "ea": 1e8, "ei": 3, "segments": segments, "start": {"on": "foot"}});
    let step = json!([{"name": "press", "duration": 1, "supports": [{"on": "foot", "ux": 0, "uy": 0}, {"on": "column_end", "ux": 0}]}]);
    let model = Arc::new(model(&frame(json!({"foot": [0, 0]}), json!({"column": bar}), step)));
    let state = model.initial_state();
    let stable = |load: f64| {
        let shorter = -load / 1e8;
        let mut u = vec![0.0; model.dofs()];
        (0..model.mesh.nodes.len()).for_each(|node| u[2 * node + 1] = shorter * model.mesh.nodes[node].y);
        let trial = Trial::new(&state, &model.steps[0], 1.0, 1.0);
        let tangent = Assembler::new(&model).tangent_of(Term::Bars, trial, &u).expect("a tangent");
        let held = [model.mesh.group("foot"), model.mesh.group("column_end")]
            .map(|group| model.mesh.nodes_of(group.expect("a group"))[0]);
        let free: Vec<usize> = (0..model.dofs()).filter(|dof| dof / 2 != held[0] && *dof != 2 * held[1]).collect();
        let unit = |dof: usize| -> Vec<f64> { (0..model.dofs()).map(|k| f64::from(u8::from(k == dof))).collect() };
        let columns: Vec<Vec<f64>> = free.iter().map(|&dof| tangent.multiply(&unit(dof))).collect();
        let matrix = DMatrix::from_fn(free.len(), free.len(), |i, j| columns[j][free[i]]);
        matrix.symmetric_eigenvalues().min() > 0.0
    };
    let l = 2.0 / segments as f64;
    let chain = 4.0 * 3.0 / (l * l) * (PI * l / 4.0).sin().powi(2);
    close("of the chain", chain, PI * PI * 3.0 / 4.0, 0.003 * chain);
    assert!(stable(0.9999 * chain) && !stable(1.0001 * chain));
}

/// A bar of each kind in a body: with bond that slips, moved by the body, yielding, clamped to it and to each other.
fn everything() -> Value {
    let mesh = Blocks::default().rectangle("soil", [4, 3], [0.0, 0.0], [4.0, 3.0]);
    json!({"mesh": mesh.json(),
        "bodies": {"soil": {"material": {"model": "neo_hookean", "E": 100, "nu": 0.3, "density": 2}}},
        "bars": {
            "geogrid": {"points": [[0.2, 0.4], [3.1, 1.3]], "ea": 50, "ei": 3, "segments": 5, "limit": 0.4,
                "embedded": {"in": ["soil"], "bond": {"stiffness": 60, "strength": 0.2, "residual": 0.1, "slip": 0.5, "normal": 80}}},
            "mat": {"points": [[0.3, 2.2], [3.3, 2.2], [3.6, 1.2]], "ea": 70, "ei": 4, "segments": 6, "embedded": {"in": ["soil"]}},
            "post": {"points": [[1.3, 2.7], [1.0, 4.5]], "ea": 40, "ei": 5, "segments": 3, "mass": 0.7,
                "start": {"on": "soil", "clamped": true}, "end": {"clamped": true}},
            "arm": {"points": [[1.0, 4.5], [3.0, 5.0]], "ea": 30, "ei": 2, "segments": 2, "mass": 0.3,
                "start": {"on": "post", "clamped": true}},
            "side": {"on": "soil_left", "ea": 20, "ei": 6},
        },
        "steps": [{"name": "load", "duration": 1, "dt": {"initial": 0.1}, "supports": [{"on": "soil_bottom", "ux": 0, "uy": 0}]}]
    })
}

/// The tangent of every part is the derivative of its forces, and symmetric.
#[test]
fn the_tangent_of_bars_is_that_of_their_forces() {
    let model = Arc::new(model(&everything()));
    for size in [1e-5, 0.02, 0.2] {
        let state = model.initial_state();
        let u = arbitrary_displacement(&model, size);
        let trial = Trial::new(&state, &model.steps[0], 0.1, 0.1);
        let mut assembler = Assembler::new(&model);
        let mut system = assembler.system();
        assembler.residual(trial, &u, &mut system).expect("a residual");
        let bars = &assembler.evaluation.bars;
        let any = |of: &dyn Fn(&BarState) -> bool| bars.iter().any(of);
        assert_eq!(any(&|bar| bar.segments.iter().any(|segment| segment.yields)), size > 1e-3);
        assert_eq!(any(&|bar| bar.grips.iter().any(|grip| grip.slips)), size > 1e-3);
        let error = tangent_error(&model, trial, &u, 1e-6);
        assert!(error < 1e-8, "{size}: {error:.1e}");
        let tangent = assembler.tangent_of(Term::Bars, trial, &u).expect("a tangent");
        let [a, b] = [arbitrary_displacement(&model, 1.0), (0..model.dofs()).map(|dof| (dof as f64).sin()).collect()];
        let product = |a: &[f64], b: &[f64]| -> f64 { tangent.multiply(a).iter().zip(b).map(|(x, y)| x * y).sum() };
        close("a·K b", product(&a, &b), product(&b, &a), 1e-9 * product(&a, &a).abs().max(product(&b, &b).abs()));
    }
}

/// A rigid motion, however large and far from the origin, leaves a model with bars without force, but for the ends that are clamped in
/// space; forces and their moments sum up to zero in any deformation.
#[test]
fn bars_are_objective() {
    let mut case = everything();
    case["bars"]["post"]["end"] = Value::Null;
    for origin in [0.0, 1e4] {
        let mut moved = case.clone();
        let shift = |point: &mut Value| {
            (0..2).for_each(|i| point[i] = json!(point[i].as_f64().expect("a number") + origin));
        };
        moved["mesh"]["nodes"].as_array_mut().expect("nodes").iter_mut().for_each(shift);
        for bar in moved["bars"].as_object_mut().expect("bars").values_mut() {
            bar.get_mut("points").and_then(Value::as_array_mut).into_iter().flatten().for_each(shift);
        }
        let model = Arc::new(model(&moved));
        let state = model.initial_state();
        let trial = Trial::new(&state, &model.steps[0], 0.1, 0.1);
        let forces = |u: &[f64]| {
            let mut force = vec![0.0; model.dofs()];
            for (bar, old) in model.bars.iter().zip(&state.bars) {
                let mut part = Vec::new();
                bar.respond(old, u, None, &[], |nodes, answer, vectors: &Vectors| {
                    vectors.forces(answer, &mut part);
                    for (node, own) in nodes.iter().zip(part.chunks_exact(2)) {
                        (0..2).for_each(|i| force[2 * node + i] += own[i]);
                    }
                });
            }
            force
        };
        let turn = nalgebra::Rotation2::new(2.0);
        let turned: Vec<f64> = (0..model.mesh.nodes.len())
            .flat_map(|node| {
                let arm = model.mesh.nodes[node] - nalgebra::Vector2::new(origin, origin);
                let u = turn * arm - arm;
                [u.x + 0.3, u.y - 0.2]
            })
            .collect();
        let largest = |force: &[f64]| force.iter().fold(0.0, |most: f64, f| most.max(f.abs()));
        let rest = largest(&forces(&turned));
        assert!(rest < 1e-11 * (1.0 + 10.0 * origin), "{origin}: {rest:e}");
        let bent = arbitrary_displacement(&model, 0.2);
        let u: Vec<f64> = turned.iter().zip(&bent).map(|(a, b)| a + b).collect();
        let (force, straight) = (forces(&u), forces(&bent));
        assert!(largest(&straight) > 0.1);
        let sum = |of: &dyn Fn(usize) -> f64| (0..model.mesh.nodes.len()).map(of).sum::<f64>();
        close("sum along x", sum(&|node| force[2 * node]), 0.0, 1e-10);
        close("sum along y", sum(&|node| force[2 * node + 1]), 0.0, 1e-10);
        let moment = sum(&|node| {
            let x = model.mesh.nodes[node] + nalgebra::Vector2::new(u[2 * node], u[2 * node + 1]);
            (x.x - origin) * force[2 * node + 1] - (x.y - origin) * force[2 * node]
        });
        close("moment", moment, 0.0, 1e-10 * (1.0 + origin));
        let _ = trial;
    }
}
