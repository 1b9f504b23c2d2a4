//! Bodies full of water that moves with them: waves, damped vibrations and consolidation, against closed forms of the equations u–p.
//!
//! ```text
//! ρ ü = M u″ − b p′,   b u̇′ + ṗ/Q = κ p″            κ = k/γ_w, a column that is held at z = 0 and drained at z = 1
//! ```

use std::f64::consts::PI;
use std::path::Path;

use crate::common::{Blocks, Finished, close, finish, goes_on, half_way, quadratic, refusal, with};
use fecontact::model::Model;
use fecontact::model::state::State;
use fecontact::run::error::Error;
use fecontact::run::observer::{Attempt, Observer};
use nalgebra::{SMatrix, SVector};
use serde_json::{Value, json};

/// M = 1, ρ = 1, and water with Q = K_w/n = 2.
pub fn soil(permeability: f64) -> Value {
    json!({"material": {"model": "linear", "E": 0.9, "nu": 0.2, "density": 1},
           "pore_fluid": {"bulk_modulus": 1, "porosity": 0.5, "permeability": permeability, "unit_weight": 1}})
}

pub const Q: f64 = 2.0;

/// A column of height 1 in one body or several, on rollers, held at its base. Between bodies it is under an effective pressure
/// of 0.05 from the start.
pub fn column(kind: &str, counts: &[usize], body: &Value, step: Value) -> Value {
    let height = 1.0 / counts.len() as f64;
    let (mut blocks, mut bodies) = (Blocks::default(), json!({}));
    let mut supports = vec![json!({"on": "b0_bottom", "uy": 0})];
    let mut contacts = json!({});
    for (k, &count) in counts.iter().enumerate() {
        let (name, low) = (format!("b{k}"), k as f64 * height);
        blocks = blocks.rectangle(&name, [1, count], [0.0, low], [0.05, low + height]);
        bodies[&name] = body.clone();
        if counts.len() > 1 {
            bodies[&name]["initial_stress"] = json!({"components": {"xx": 0, "yy": -0.05, "zz": 0, "xy": 0}});
        }
        supports.extend(["left", "right"].map(|side| json!({"on": format!("{name}_{side}"), "ux": 0})));
        if k > 0 {
            let (slave, master) = (format!("{name}_bottom"), format!("b{}_top", k - 1));
            let friction = json!({"law": "frictionless"});
            contacts[format!("cut{k}")] = json!({"slave": slave, "master": master, "friction": friction,
                "initial": {"pressure": 0.05}, "normal": {"alpha_n": 1e5}});
        }
    }
    let mesh = if kind == "q8" { quadratic(&blocks.json(), half_way) } else { blocks.json() };
    let mut all = json!({"name": "move", "supports": supports});
    step.as_object().expect("keys").iter().for_each(|(key, value)| all[key] = value.clone());
    json!({"mesh": mesh, "bodies": bodies, "contacts": contacts, "steps": [all]})
}

fn newmark() -> Value {
    json!({"newmark": {}})
}

/// p at the corner nearest to a place.
pub fn pressure(run: &Finished, state: &State, at: [f64; 2]) -> f64 {
    let flow = run.model.flow.as_ref().expect("water flows");
    let away = |k: &usize| (run.model.mesh.nodes[flow.corners[*k]] - nalgebra::Vector2::from(at)).norm();
    let nearest = (0..flow.count()).min_by(|a, b| away(a).total_cmp(&away(b))).expect("a corner");
    flow.pressure(nearest, Some(&state.displacement))
}

pub fn balance(run: &Finished, tolerance: f64) {
    let size = run.states.iter().filter_map(|state| run.model.balance_of_water(state)).map(|[_, size]| size);
    let throughput = size.fold(0.0, f64::max);
    for state in &run.states {
        let [error, _] = run.model.balance_of_water(state).expect("water");
        close("balance of water", error, 0.0, tolerance * throughput);
    }
}

pub fn audit(run: &Finished, tolerance: f64) {
    let work = run.states.iter().fold(0.0f64, |most, state| most.max(state.energy.external_work.abs()));
    run.states.iter().for_each(|state| close("energy", state.energy.error(), 0.0, tolerance * work));
}

/// A pulse on the top arrives at the base after H/c, twice as high, with c² = M/ρ where the water is free to leave everywhere, and
/// (M + K_w/n)/ρ where it has no time to.
#[test]
fn waves_have_the_speed_of_the_mixture() {
    let load = |time: f64| (-((time - 0.4) / 0.12f64).powi(2)).exp();
    for (what, permeability, speed, drainage) in [
        ("trapped", 1e-9, f64::sqrt(1.0 + Q), json!([])),
        ("drained", 1.0, 1.0, json!([{"on": "b0_left", "pressure": 0}, {"on": "b0_right", "pressure": 0}])),
    ] {
        for (kind, elements) in [("q8", 20), ("q4", 80)] {
            let case = column(
                kind,
                &[elements],
                &soil(permeability),
                json!({
                    "scheme": newmark(), "duration": 0.8 + 1.0 / speed, "dt": {"initial": 0.005}, "drainage": drainage,
                    "loads": [{"on": "b0_top", "dead_pressure": "exp(-((t-0.4)/0.12)^2)"}],
                }),
            );
            let run = finish(&case);
            let off = |state: &State| {
                (run.reaction("b0_bottom", state)[1] / 0.05 - 2.0 * load(state.time - 1.0 / speed)).abs() / 2.0
            };
            let worst = run.states.iter().map(off).fold(0.0, f64::max);
            println!("{what}, {kind}: worst of the reaction {worst:.1e} of its peak");
            assert!(worst < 0.02, "{what}, {kind}: {worst}");
            audit(&run, 1e-7);
        }
    }
}

/// A wave in ground whose water has no time to flow leaves through an absorbing side, by the impedance of both.
#[test]
fn an_absorbing_side_lets_waves_out() {
    let mut case = column(
        "q4",
        &[60],
        &soil(1e-9),
        json!({
            "scheme": newmark(), "duration": 2, "dt": {"initial": 0.005},
            "loads": [{"on": "b0_top", "dead_pressure": "exp(-((t-0.4)/0.12)^2)"}, {"on": "b0_bottom", "absorbing": true}],
        }),
    );
    case["steps"][0]["supports"].as_array_mut().expect("supports").remove(0);
    let run = finish(&case);
    let kinetic = |state: &State| state.energy.kinetic;
    let most = run.states.iter().map(kinetic).fold(0.0, f64::max);
    println!("kinetic energy left: {:.1e} of {most:.1e}", kinetic(run.last()) / most);
    assert!(kinetic(run.last()) < 1e-3 * most);
}

/// `dt.pore_pressure` controls increments in motion, too: a tenth of the error takes shorter ones.
#[test]
fn pressures_control_increments() {
    let increments = |allowed: f64| {
        let step = json!({
            "scheme": newmark(), "duration": 2, "dt": {"initial": 0.01, "max": 0.2, "pore_pressure": allowed},
            "drainage": [{"on": "b0_top", "pressure": 0}],
            "loads": [{"on": "b0_top", "dead_pressure": "0.5*(1-cos(3*t))"}],
        });
        finish(&column("q4", &[10], &soil(0.05), step)).states.len()
    };
    let counts = [1e-2, 1e-3].map(increments);
    println!("{counts:?} increments");
    assert!(counts[1] > 2 * counts[0], "{counts:?}");
}

/// Deflection of the top and pressure at the base under the load (1 − cos ω t)/100 on the top, in the modes u = U sin λz, p = P cos λz, λ = (m + ½)π:
///
/// ```text
/// ρ Ü = −M λ² U + b λ P − 2 (−1)^m load,   Ṗ/Q = −b λ U̇ − κ λ² P
/// ```
pub fn vibration(kappa: f64, omega: f64, time: f64) -> [f64; 2] {
    let (mut top, mut base) = (0.0, 0.0);
    for m in 0..400 {
        let (lambda, sign) = ((f64::from(m) + 0.5) * PI, if m % 2 == 0 { 1.0 } else { -1.0 });
        // U, V, P, 1, cos, sin
        let mut rate = SMatrix::<f64, 6, 6>::zeros();
        rate[(0, 1)] = 1.0;
        (rate[(1, 0)], rate[(1, 2)], rate[(1, 3)], rate[(1, 4)]) = (-lambda * lambda, lambda, -sign, sign);
        (rate[(2, 1)], rate[(2, 2)]) = (-Q * lambda, -Q * kappa * lambda * lambda);
        (rate[(4, 5)], rate[(5, 4)]) = (-omega, omega);
        let start = SVector::<f64, 6>::from_column_slice(&[0.0, 0.0, 0.0, 1.0, 1.0, 0.0]);
        let end = (rate * time).exp() * start;
        // Of what alternates, half of the last part is too much.
        let share = if m == 399 { 0.5 } else { 1.0 };
        (top, base) = (top + sign * end[0], base + share * end[2]);
    }
    [0.02 * top, 0.02 * base]
}

/// Deflection of the top and pressure at the base of a run.
pub fn found(run: &Finished, time: f64, bodies: usize) -> [f64; 2] {
    let top = run.nodes(&format!("b{}_top", bodies - 1))[0];
    let state = run.at(time);
    [state.displacement[2 * top + 1], pressure(run, state, [0.0, 0.0])]
}

/// What a run is off by from what is expected at t = 1, 2, 3 and 4, over the largest of each.
pub fn off(run: &Finished, expected: impl Fn(f64) -> [f64; 2], bodies: usize) -> f64 {
    let at = |time: f64| {
        let [[u, p], [expected_u, expected_p]] = [found(run, time, bodies), expected(time)];
        f64::max((u - expected_u).abs() / 0.016, (p - expected_p).abs() / 0.04)
    };
    [1.0, 2.0, 3.0, 4.0].map(at).into_iter().fold(0.0, f64::max)
}

/// A load that swings, under which water flows in and out of a column that it damps: of second order in time, by every scheme, in one body
/// and across a contact that stays closed.
#[test]
fn a_column_swings_as_the_closed_form_says() {
    let kappa = 0.05;
    let case = |kind: &str, counts: &[usize], scheme: &Value, dt: f64| {
        column(
            kind,
            counts,
            &soil(kappa),
            json!({
                "scheme": scheme, "duration": 4, "dt": {"initial": dt},
                "drainage": [{"on": format!("b{}_top", counts.len() - 1), "pressure": 0}],
                "loads": [{"on": format!("b{}_top", counts.len() - 1),
                    "dead_pressure": format!("{}+0.01*(1-cos(3*t))", if counts.len() > 1 { 0.05 } else { 0.0 })}],
            }),
        )
    };
    for scheme in [newmark(), json!({"hht": {"alpha": -0.1}}), json!({"generalized_alpha": {"rho_infinity": 0.8}})] {
        let [coarse, fine, finest] = [0.05, 0.025, 0.0125].map(|dt| finish(&case("q8", &[16], &scheme, dt)));
        let error = off(&fine, |time| vibration(kappa, 3.0, time), 1);
        let order =
            (off(&coarse, |time| found(&fine, time, 1), 1) / off(&fine, |time| found(&finest, time, 1), 1)).log2();
        println!("{scheme}: {error:.1e}, order {order:.2}");
        assert!(error < 2e-3 && order > 1.8, "{scheme}: {error:.1e}, order {order}");
    }
    for (kind, counts) in [("q4", &[40][..]), ("q8", &[8, 8]), ("q4", &[20, 20])] {
        let run = finish(&case(kind, counts, &newmark(), 0.025));
        let error = off(&run, |time| vibration(kappa, 3.0, time), counts.len());
        println!("{kind} {counts:?}: {error:.1e}");
        assert!(error < 4e-3, "{kind} {counts:?}: {error}");
        balance(&run, 1e-9);
        audit(&run, 1e-6);
    }
    goes_on(
        &case("q4", &[4, 4], &json!({"hht": {"alpha": -0.1}}), 0.1),
        &finish(&case("q4", &[4, 4], &json!({"hht": {"alpha": -0.1}}), 0.1)),
        7,
    );
}

/// A column without inertia to speak of under a load 1 − exp(−a t) consolidates as Terzaghi's (1943) series says, λ = (m + ½)π:
///
/// ```text
/// p = Σ 2 (−1)^m/λ c cos λz,   settlement = load − Σ 2/λ² c,   c = a/(λ² − a) (exp(−a t) − exp(−λ² t))
/// ```
#[test]
fn a_slow_load_consolidates() {
    let mut body = soil(1.0);
    body["material"]["density"] = json!(1e-6);
    body["pore_fluid"]["bulk_modulus"] = json!(1e6);
    let terzaghi = |time: f64| {
        let load = 1.0 - (-20.0 * time).exp();
        (0..400).fold([load, 0.0], |[settled, base], m| {
            let (lambda, sign) = ((f64::from(m) + 0.5) * PI, if m % 2 == 0 { 1.0 } else { -1.0 });
            let square = lambda * lambda;
            let c = 20.0 / (square - 20.0) * ((-20.0 * time).exp() - (-square * time).exp());
            [settled - 2.0 / square * c, base + 2.0 * sign / lambda * c]
        })
    };
    for scheme in [json!({"hht": {"alpha": -0.3}}), json!({"generalized_alpha": {"rho_infinity": 0}})] {
        let case = column(
            "q8",
            &[8],
            &body,
            json!({
                "scheme": scheme, "duration": 0.5, "dt": {"initial": 0.0025},
                "drainage": [{"on": "b0_top", "pressure": 0}], "loads": [{"on": "b0_top", "dead_pressure": "1-exp(-20*t)"}],
            }),
        );
        let run = finish(&case);
        for time in [0.1, 0.5] {
            let [[u, p], [settled, base]] = [found(&run, time, 1), terzaghi(time)];
            println!("{scheme}, T = {time}: U {:.5} ({settled:.5}), p {p:.5} ({base:.5})", -u);
            close("U", -u, settled, 2e-3);
            close("p", p, base, 3e-3);
        }
        balance(&run, 1e-9);
    }
}

/// What a load does is what the water that seeps dissipates, ∫ −f du = ∫∫ κ p′² dz dt, once all has come to rest; both are external work.
#[test]
fn seepage_dissipates_what_a_load_does() {
    let kappa = 0.3;
    let run = finish(&column(
        "q8",
        &[10],
        &soil(kappa),
        json!({
            "scheme": newmark(), "duration": 14, "dt": {"initial": 0.01}, "drainage": [{"on": "b0_top", "pressure": 0}],
            "loads": [{"on": "b0_top", "dead_pressure": "exp(-((t-0.8)/0.2)^2)"}],
        }),
    ));
    let load = |state: &State| 0.05 * (-((state.time - 0.8) / 0.2f64).powi(2)).exp();
    let top = run.nodes("b0_top")[0];
    let flow = run.model.flow.as_ref().expect("water flows");
    let seeps = |state: &State| -> f64 {
        let volumes = flow.elements.iter().map(|wet| wet.volumes.iter().sum::<f64>());
        let speeds = flow.elements.iter().map(|wet| run.model.seepage(wet, state));
        speeds.zip(volumes).map(|(speed, volume)| speed.norm_squared() / kappa * volume).sum()
    };
    let (mut done, mut dissipated) = (0.0, 0.0);
    for pair in run.states.windows(2) {
        let [old, new] = [&pair[0], &pair[1]];
        done -= 0.5 * (load(old) + load(new)) * (new.displacement[2 * top + 1] - old.displacement[2 * top + 1]);
        dissipated += 0.5 * (seeps(old) + seeps(new)) * new.dt;
    }
    println!("done {done:.6e}, dissipated {dissipated:.6e}, external work {:.1e}", run.last().energy.external_work);
    close("kinetic energy left", run.last().energy.kinetic, 0.0, 1e-5 * done);
    close("dissipated", dissipated, done, 2e-3 * done);
    close("external work", run.last().energy.external_work, 0.0, 1e-3 * done);
    audit(&run, 1e-7);
}

/// A block of this height and length that is pressed on ground of the same kind, and slides on it at first with a velocity.
const SLIDING: [f64; 3] = [0.3, 1.6, 0.3];

fn slides(body: &Value, scheme: &Value, mu: f64) -> Finished {
    let [height, length, start] = SLIDING;
    let blocks = Blocks::default().rectangle("low", [24, 3], [0.0, -0.3], [2.4, 0.0]);
    let blocks = blocks.rectangle("high", [15, 3], [0.2, 0.0], [0.2 + length, height]);
    let friction = json!({"law": "coulomb", "mu": mu});
    finish(&json!({
        "mesh": blocks.json(), "bodies": {"low": body, "high": body},
        "contacts": {"cut": {"slave": "high_bottom", "master": "low_top", "friction": friction, "initial": {"pressure": 0.0}}},
        "steps": [
            {"name": "load", "duration": 0.1, "dt": {"initial": 0.02}, "loads": [{"on": "high_top", "dead_pressure": "1"}],
                "supports": [{"on": "low_bottom", "ux": 0, "uy": 0}, {"on": "high_top", "ux": 0}]},
            {"name": "slide", "duration": 0.4, "dt": {"initial": 0.005}, "scheme": scheme, "velocity": {"high": [start, 0]},
                "loads": [{"on": "high_top", "dead_pressure": "1"}], "supports": [{"on": "high_top", "ux": null}]},
        ],
        "output": {"interval": 0.001},
    }))
}

/// Σ m v or Σ m u of the block.
fn moment(run: &Finished, values: &[f64]) -> [f64; 2] {
    let high = run.model.bodies.iter().find(|body| body.name == "high").expect("a body");
    let mut sums = [0.0; 2];
    for &e in &high.elements {
        for (node, mass) in run.model.mesh.elements[e].nodes.iter().zip(run.model.element_lumped_mass(e).iter()) {
            (0..2).for_each(|i| sums[i] += mass * values[2 * node + i]);
        }
    }
    sums
}

/// A wet block slides on wet ground until friction has stopped it: m dv/dt = −μ (q L + m d²y/dt² − ∫ p_w ds), by the pressure p_w of the pores at its base. A dry
/// one stops after a fraction of the way.
#[test]
fn a_wet_block_slides_by_the_effective_pressure() {
    let ([height, length, start], mu) = (SLIDING, 0.3);
    let wet = json!({"material": {"model": "linear", "E": 90, "nu": 0.2, "density": 1},
        "pore_fluid": {"bulk_modulus": 100, "porosity": 0.5, "permeability": 1e-4, "unit_weight": 1}});
    let (implicit, mass) = (json!({"hht": {"alpha": -0.1}}), length * height);
    for scheme in [&implicit, &json!({"explicit": {}})] {
        let run = slides(&wet, scheme, mu);
        // Trapezoidal rule along the base.
        let (base, flow) = (run.nodes("high_bottom"), run.model.flow.as_ref().expect("water flows"));
        let carried = |state: &State| -> f64 {
            let at = |node: usize| flow.pressure(flow.of_node[node].expect("a corner"), Some(&state.displacement));
            let all: f64 = base.iter().map(|&node| at(node)).sum();
            let is_end =
                |node: &&usize| [0.2, 0.2 + length].iter().any(|x| (run.model.mesh.nodes[**node].x - x).abs() < 1e-9);
            length / 15.0 * (all - 0.5 * base.iter().filter(is_end).map(|&node| at(node)).sum::<f64>())
        };
        let (mut expected, mut shares) = (start * mass, Vec::new());
        for pair in run.states.windows(2).filter(|pair| pair[0].time > 0.1 - 1e-9) {
            let [old, new] = [0, 1].map(|k| moment(&run, &pair[k].velocity));
            let dt = pair[1].time - pair[0].time;
            // What rises presses more.
            let normal = (length - 0.5 * (carried(&pair[0]) + carried(&pair[1]))) * dt + new[1] - old[1];
            expected -= mu * normal;
            shares.push(normal / (length * dt));
            close("momentum", new[0], expected, 0.01 * start * mass);
        }
        let share = shares.iter().sum::<f64>() / shares.len() as f64;
        let left = moment(&run, &run.last().velocity)[0] / (start * mass);
        println!("{scheme}: {share:.3} of the load rubs; {left:.3} of the velocity is left");
        assert!(share < 0.7 && left > 0.1, "{share}, {left}");
        balance(&run, 1e-8);
    }
    let mut dry = wet.clone();
    dry.as_object_mut().expect("a body").remove("pore_fluid");
    let dry = slides(&dry, &implicit, mu);
    // v²/(2 a),  a = μ q L/m
    let way = moment(&dry, &dry.at(0.4).displacement)[0] / mass;
    println!("way of a dry block {way:.4e}");
    close("way of a dry block", way, 0.5 * start * start * mass / (mu * length), 0.03 * way);
}

/// Ground and its water at rest stay there: gravity on the mixture, which weighs 20, and on the water, 10.
#[test]
fn what_is_at_rest_stays_there() {
    let mut body = soil(0.1);
    body["material"]["density"] = json!(2);
    body["initial_stress"] = json!({"geostatic": {"surface": 1, "weight": 10, "K0": 0.5}});
    body["pore_fluid"] = json!({"bulk_modulus": 100, "porosity": 0.4, "permeability": 0.1, "unit_weight": 10, "weighs": true, "pressure": "10*(1-y)"});
    let mut case = column(
        "q8",
        &[6],
        &body,
        json!({
            "scheme": newmark(), "duration": 0.2, "dt": {"initial": 0.02}, "loads": [{"on": "b0", "gravity": {"y": "-10"}}],
            "drainage": [{"on": "b0_top", "head": 1}],
        }),
    );
    let step = case["steps"][0].clone();
    for schemes in [&[newmark()][..], &[json!("static"), newmark(), json!({"generalized_alpha": {}})]] {
        let steps = schemes.iter().enumerate().map(|(k, scheme)| {
            let own = if k == 0 { &step } else { &json!({"duration": 0.2, "dt": {"initial": 0.02}}) };
            with(own.clone(), &json!({"name": format!("step {k}"), "scheme": scheme}))
        });
        case["steps"] = steps.collect();
        let run = finish(&case);
        for state in &run.states {
            let fastest = state.displacement.iter().fold(0.0f64, |most, u| most.max(u.abs()));
            assert!(fastest < 1e-10, "it moves by {fastest}");
        }
        // Increments of a motion are as short as it asks for.
        let warnings = run.model.warnings();
        let expected = usize::from(schemes[0] == "static");
        let told = warnings.iter().filter(|warning| warning.contains("through half an element beside an outlet"));
        assert!(warnings.len() == expected && told.count() == expected, "{warnings:?}");
    }
}

/// Corrections of Newton's method of every increment.
#[derive(Default)]
struct Corrections(Vec<Vec<f64>>);

impl Observer for Corrections {
    fn record(&mut self, _: &Model, attempt: &Attempt) -> Result<(), Error> {
        self.0.push(attempt.iterations.iter().map(|iteration| iteration.newton.correction).collect());
        Ok(())
    }
}

/// Newton's method converges with its square in bodies of large strains that rub on each other, static and in motion: c₁ ≤ 40 c₀² of the last
/// two corrections above round-off.
#[test]
fn corrections_fall_with_their_square() {
    for scheme in [json!("static"), newmark(), json!({"hht": {"alpha": -0.1}})] {
        let mut body = soil(0.05);
        body["material"] = json!({"model": "hencky", "E": 0.9, "nu": 0.2, "density": 1});
        let mut case = column(
            "q8",
            &[3, 3],
            &body,
            json!({
                "scheme": scheme, "duration": 0.6, "dt": {"initial": 0.1}, "drainage": [{"on": "b1_top", "pressure": 0}],
                "loads": [{"on": "b1_top", "dead_pressure": "0.05+t"}],
            }),
        );
        case["newton"] = json!({"tolerance": 1e-12});
        let mut corrections = Corrections::default();
        let mut model = crate::common::model(&case);
        model.aids.old_tangents = false;
        fecontact::run::run(&model.into(), &mut [&mut corrections]).1.expect("it runs");
        for increment in &corrections.0 {
            println!("{scheme}: {increment:?}");
            // Below, round-off decides.
            let last = increment.windows(2).rfind(|pair| pair[1] > 1e-11).expect("two corrections");
            assert!(last[1] < 40.0 * last[0] * last[0], "{scheme}: {increment:?}");
        }
    }
}

/// `check` says how fast motions may be: 2π f ρ k/γ_w = 0.01.
#[test]
fn check_prints_the_highest_frequency() {
    for (scheme, expected) in [(json!("static"), None), (newmark(), Some(0.01 / (2.0 * PI * 0.05)))] {
        let case = column("q4", &[2], &soil(0.05), json!({"scheme": scheme, "duration": 1, "dt": {"initial": 0.1}}));
        let read = fecontact::case::from_text(&case.to_string(), Path::new("test.json")).expect("a case");
        let text = fecontact::case::report(&read, &crate::common::model(&case));
        let told = text.split("u-p holds up to a frequency of ").nth(1).and_then(|rest| rest.split_whitespace().next());
        let told: Option<f64> = told.map(|word| word.parse().expect("a number"));
        assert_eq!(told.is_some(), expected.is_some(), "{text}");
        if let (Some(told), Some(expected)) = (told, expected) {
            close("f", told, expected, 1e-3 * expected);
        }
    }
}

/// Schemes that look beyond an increment, or take slips as their unknowns, are refused.
#[test]
fn other_schemes_are_refused() {
    for scheme in [json!({"wilson": {}}), json!({"quasi_dynamic": {}})] {
        let case = column("q4", &[2], &soil(1.0), json!({"scheme": scheme, "duration": 1, "dt": {"initial": 0.1}}));
        let message = refusal(&case);
        assert!(message.contains("steps[0].scheme: is not for water that flows"), "{message}");
    }
}
