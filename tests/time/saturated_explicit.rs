//! Bodies full of water that moves with them in explicit increments: closed forms of the equations u–p, implicit increments, and the stability
//! limit. The columns are those of `saturated.rs`.

use std::f64::consts::PI;

use crate::common::{Blocks, Finished, close, distance, finish, goes_on, half_way, on_threads, quadratic, with};
use crate::saturated::{Q, audit, balance, column, found, off, pressure, soil, vibration};
use serde_json::{Value, json};

fn explicit() -> Value {
    json!({"explicit": {}})
}

/// Every quadrilateral of a mesh as two triangles, along one diagonal and the other in turn.
fn triangles(mesh: &Value) -> Value {
    let mut mesh = mesh.clone();
    for elements in mesh["elements"].as_object_mut().expect("bodies").values_mut() {
        let all: Vec<[usize; 4]> = serde_json::from_value(elements.clone()).expect("quadrilaterals");
        let halves = |(k, [a, b, c, d]): (usize, [usize; 4])| match k % 2 {
            0 => [[a, b, c], [a, c, d]],
            _ => [[a, b, d], [b, c, d]],
        };
        *elements = json!(all.into_iter().enumerate().flat_map(halves).collect::<Vec<_>>());
    }
    mesh
}

pub fn meshed(kind: &str, blocks: &Value) -> Value {
    match kind {
        "q4" => blocks.clone(),
        "q8" => quadratic(blocks, half_way),
        "t3" => triangles(blocks),
        _ => quadratic(&triangles(blocks), half_way),
    }
}

/// A pulse on the top runs down with c² = M/ρ where the water is free to leave everywhere, and (M + K_w/n)/ρ where it has no time to: half way down
/// it moves the column by ∫ load(t − ½/c) dt/(ρ c), until it comes back from the base.
#[test]
fn waves_have_the_speed_of_the_mixture() {
    // Trapezoidal rule; there is no load before
    let passed = |time: f64| -> f64 {
        let load = |time: f64| (-((time - 0.4) / 0.12f64).powi(2)).exp();
        let parts = (time.max(0.0) / 1e-3).ceil().max(1.0);
        let at = |k: f64| load(time.max(0.0) * k / parts);
        (0..parts as usize).map(|k| 0.5 * (at(k as f64) + at(k as f64 + 1.0)) * time.max(0.0) / parts).sum()
    };
    for (what, permeability, speed, drainage) in [
        ("trapped", 1e-9, f64::sqrt(1.0 + Q), json!([])),
        ("drained", 1.0, 1.0, json!([{"on": "b0_left", "pressure": 0}, {"on": "b0_right", "pressure": 0}])),
    ] {
        for (kind, elements) in [("q8", 30), ("q4", 80), ("t3", 80), ("t6", 30)] {
            let mut case = column(
                "q4",
                &[elements],
                &soil(permeability),
                json!({
                    "scheme": explicit(), "duration": 1.5 / speed, "dt": {"initial": 1}, "drainage": drainage,
                    "loads": [{"on": "b0_top", "dead_pressure": "exp(-((t-0.4)/0.12)^2)"}],
                }),
            );
            case["mesh"] = meshed(kind, &case["mesh"]);
            let run = finish(&case);
            let nodes = &run.model.mesh.nodes[..run.model.mesh.own_nodes()];
            let middle =
                nodes.iter().position(|x| (x - nalgebra::Vector2::new(0.0, 0.5)).norm() < 1e-9).expect("a node");
            let off = |state: &fecontact::model::state::State| {
                (state.displacement[2 * middle + 1] + passed(state.time - 0.5 / speed) / speed).abs()
            };
            let worst = run.states.iter().map(off).fold(0.0, f64::max) * speed / passed(1.0);
            println!("{what}, {kind}: off by {worst:.1e} of the way, {} increments", run.last().increment);
            assert!(worst < 0.02, "{what}, {kind}: {worst}");
            audit(&run, 1e-9);
        }
    }
}

/// A load that swings, under which water flows in and out of a column that it damps: of second order in time.
#[test]
fn a_column_swings_as_the_closed_form_says() {
    let kappa = 0.05;
    let case = |kind: &str, count: usize, dt: f64| {
        let mut case = column(
            "q4",
            &[count],
            &soil(kappa),
            json!({
                "scheme": explicit(), "duration": 4, "dt": {"initial": dt, "max": dt}, "drainage": [{"on": "b0_top", "pressure": 0}],
                "loads": [{"on": "b0_top", "dead_pressure": "0.01*(1-cos(3*t))"}],
            }),
        );
        case["mesh"] = meshed(kind, &case["mesh"]);
        case
    };
    for (kind, count) in [("q4", 40), ("q8", 16), ("t3", 40), ("t6", 16)] {
        let run = finish(&case(kind, count, 1.0));
        let error = off(&run, |time| vibration(kappa, 3.0, time), 1);
        println!("{kind}: {error:.1e}, {} increments", run.last().increment);
        assert!(error < 4e-3, "{kind}: {error}");
        balance(&run, 1e-11);
        audit(&run, 1e-9);
    }
    let [coarse, fine, finest] = [0.02, 0.01, 0.005].map(|dt| finish(&case("q4", 12, dt)));
    let order = (off(&coarse, |time| found(&fine, time, 1), 1) / off(&fine, |time| found(&finest, time, 1), 1)).log2();
    println!("order {order:.2}");
    assert!(order > 1.9, "{order}");
    let small = case("q4", 4, 1.0);
    goes_on(&small, &finish(&small), 7);
}

/// A column without inertia to speak of under a load L = 1 − exp(−a t) consolidates as Terzaghi's (1943) series says, with water that gives way,
/// λ = (m + ½)π, c = κ/(1/M + 1/Q), B = Q/(M + Q):
///
/// ```text
/// p = Σ 2 (−1)^m/λ c_m cos λz,   settlement = L/M − Σ 2/λ² c_m/M,   c_m = B a/(c λ² − a) (exp(−a t) − exp(−c λ² t))
/// ```
#[test]
fn a_slow_load_consolidates() {
    let (trapped, rate) = (20.0, 20.0);
    let mut body = soil(1.0);
    body["material"]["density"] = json!(1e-4);
    body["pore_fluid"]["bulk_modulus"] = json!(0.5 * trapped);
    let (c, share) = (1.0 / (1.0 + 1.0 / trapped), trapped / (1.0 + trapped));
    let terzaghi = |time: f64| {
        (0..400).fold([1.0 - (-rate * time).exp(), 0.0], |[settled, base], m| {
            let (lambda, sign) = ((f64::from(m) + 0.5) * PI, if m % 2 == 0 { 1.0 } else { -1.0 });
            let fades = c * lambda * lambda;
            let part = share * rate / (fades - rate) * ((-rate * time).exp() - (-fades * time).exp());
            [settled - 2.0 / (lambda * lambda) * part, base + 2.0 * sign / lambda * part]
        })
    };
    for (kind, count) in [("q8", 8), ("q4", 16)] {
        let mut case = column(
            "q4",
            &[count],
            &body,
            json!({
                "scheme": explicit(), "duration": 0.5, "dt": {"initial": 1},
                "drainage": [{"on": "b0_top", "pressure": 0}], "loads": [{"on": "b0_top", "dead_pressure": "1-exp(-20*t)"}],
            }),
        );
        case["mesh"] = meshed(kind, &case["mesh"]);
        let run = finish(&case);
        for time in [0.1, 0.5] {
            let [[u, p], [settled, base]] = [found(&run, time, 1), terzaghi(time)];
            println!(
                "{kind}, {} increments, T = {time}: U {:.5} ({settled:.5}), p {p:.5} ({base:.5})",
                run.last().increment,
                -u
            );
            close("U", -u, settled, 2e-3);
            close("p", p, base, 3e-3);
        }
        balance(&run, 1e-10);
    }
}

/// Uneven ground under a strip that sinks in, drained beside it.
fn ground(kind: &str, law: &str, section: &str, scheme: &Value, dt: f64) -> Value {
    let uneven = |s: f64, t: f64| {
        [1.0 + 1.5 * s + 0.05 * (4.0 * t).sin() * s * (1.0 - s), t + 0.08 * (5.0 * s).sin() * t * (1.0 - t)]
    };
    let blocks = Blocks::default().block("soil", [4, 3], uneven);
    json!({
        "mesh": meshed(kind, &blocks.json()), "section": section,
        "bodies": {"soil": {
            "material": {"model": law, "E": 0.9, "nu": 0.2, "density": 1e-3},
            "pore_fluid": {"bulk_modulus": 4, "porosity": 0.4, "permeability": 0.3, "permeability_y": 0.2, "unit_weight": 1, "biot": 0.9, "kozeny_carman": law != "linear"},
        }},
        "steps": [{
            "name": "load", "duration": 1, "scheme": scheme, "dt": {"initial": dt, "max": dt},
            "supports": [{"on": "soil_bottom", "ux": 0, "uy": 0}, {"on": "soil_left", "ux": 0}],
            "drainage": [{"on": "soil_right", "pressure": 0}, {"on": "soil_bottom", "flux": "-0.01*t"}],
            "loads": [{"on": "soil_top", "dead_pressure": "0.1*(1-cos(3*t))"}],
        }],
        "output": {"interval": 0.1},
    })
}

/// Pressures, displacements and outflow of explicit increments are those of implicit ones as short.
fn agrees(what: &str, case: impl Fn(&Value, f64) -> Value) {
    let moving = finish(&case(&explicit(), 1.0));
    let dt = 0.1 / (0.1 / moving.last().dt).round();
    let solved = finish(&case(&json!({"hht": {"alpha": -0.1}}), 2.0 * dt));
    let states = [moving.last(), solved.last()];
    let flow = moving.model.flow.as_ref().expect("water flows");
    let split = |state: &fecontact::model::state::State| {
        let pressures = (0..flow.count()).map(|k| flow.pressure(k, Some(&state.displacement)));
        (state.displacement[..flow.dof(0)].to_vec(), pressures.collect::<Vec<_>>())
    };
    let [(u, p), (solved_u, solved_p)] = states.map(split);
    let size = |values: &[f64]| values.iter().fold(0.0f64, |most, value| most.max(value.abs()));
    let errors = [distance(&u, &solved_u) / size(&u), distance(&p, &solved_p) / size(&p)];
    let [out, solved_out] = states.map(|state| state.water.outlets[0].volume);
    println!(
        "{what}: {} increments, u {:.1e}, p {:.1e} of {:.2e}, outflow {out:.5e} for {solved_out:.5e}",
        moving.last().increment,
        errors[0],
        errors[1],
        size(&p)
    );
    assert!(errors[0] < 2e-3 && errors[1] < 5e-3, "{what}: {errors:?}");
    close("outflow", out, solved_out, 2e-3 * out.abs());
    balance(&moving, 1e-10);
    audit(&moving, 1e-5);
}

/// With all elements, in rings, at large strains and with a permeability that follows the void ratio.
#[test]
fn implicit_increments_agree() {
    for (kind, law, section) in [
        ("q4", "linear", "plane_strain"),
        ("t3", "linear", "plane_strain"),
        ("q8", "linear", "axisymmetric"),
        ("t6", "linear", "plane_strain"),
        ("q4", "hencky", "axisymmetric"),
        ("q8", "hencky", "plane_strain"),
        ("t3", "neo_hookean", "plane_strain"),
    ] {
        agrees(&format!("{kind} {law} {section}"), |scheme, dt| ground(kind, law, section, scheme, dt));
    }
}

/// Beside viscosity, dashpots, an absorbing side, rigid plates and plates that stay level, a truss and a beam; the load of each is its own.
#[test]
fn implicit_increments_agree_beside_other_parts() {
    let bar = |more: Value| {
        let ends = json!({"points": [[1.3, 0.3], [2.2, 0.7]], "ea": 0.5, "mass": 1e-4, "start": {"on": "soil"}, "end": {"on": "soil"}});
        json!({"bars": {"tie": with(ends, &more)}})
    };
    for (what, of_case, of_soil, load) in [
        ("viscosity", json!({}), json!({"damping": {"stiffness": 0.02, "mass": 0.5}}), json!(null)),
        ("dashpots", json!({}), json!({}), json!({"on": "soil_top", "dashpot": {"cx": 0.02, "cy": 0.03}})),
        ("absorbing", json!({}), json!({}), json!({"on": "soil_right", "absorbing": true})),
        ("rigid plate", json!({"plates": [{"on": "soil_top", "moves": "rigid"}]}), json!({}), json!(null)),
        ("level plate", json!({"plates": [{"on": "soil_top", "moves": "uy_alike"}]}), json!({}), json!(null)),
        ("truss", bar(json!({"segments": 1})), json!({}), json!(null)),
        ("beam", bar(json!({"segments": 2, "ei": 0.01})), json!({}), json!(null)),
    ] {
        agrees(what, |scheme, dt| {
            let mut case = with(ground("q4", "linear", "plane_strain", scheme, dt), &of_case);
            case["bodies"]["soil"] = with(case["bodies"]["soil"].clone(), &of_soil);
            if !load.is_null() {
                case["steps"][0]["loads"].as_array_mut().expect("loads").push(load.clone());
            }
            case
        });
    }
}

/// Ground and its water at rest stay there through steps of both kinds: gravity on the mixture, which weighs 20, and on the water, 10.
#[test]
fn what_is_at_rest_stays_there() {
    let mut body = soil(0.1);
    body["material"]["density"] = json!(2);
    body["initial_stress"] = json!({"geostatic": {"surface": 1, "weight": 10, "K0": 0.5}});
    body["pore_fluid"] = json!({"bulk_modulus": 100, "porosity": 0.4, "permeability": 0.1, "unit_weight": 10, "weighs": true, "pressure": "10*(1-y)"});
    for kind in ["q4", "q8"] {
        let mut case = column(
            "q4",
            &[6],
            &body,
            json!({
                "scheme": explicit(), "duration": 0.5, "dt": {"initial": 0.05}, "loads": [{"on": "b0", "gravity": {"y": "-10"}}],
                "drainage": [{"on": "b0_top", "head": 1}],
            }),
        );
        case["mesh"] = meshed(kind, &case["mesh"]);
        let step = case["steps"][0].clone();
        for schemes in [
            &[explicit()][..],
            &[json!("static"), explicit(), json!("static")],
            &[explicit(), explicit(), json!({"newmark": {}}), explicit()],
        ] {
            let steps = schemes.iter().enumerate().map(|(k, scheme)| {
                let own = if k == 0 { &step } else { &json!({"duration": 0.5, "dt": {"initial": 0.05}}) };
                with(own.clone(), &json!({"name": format!("step {k}"), "scheme": scheme}))
            });
            case["steps"] = steps.collect();
            let run = finish(&case);
            for state in &run.states {
                let farthest = state.displacement.iter().fold(0.0f64, |most, u| most.max(u.abs()));
                assert!(farthest < 1e-10, "{kind}: it moves by {farthest}");
            }
        }
    }
}

/// The same bits on any number of threads, and of a run that goes on.
#[test]
fn bits_are_the_same() {
    let case = ground("q8", "hencky", "plane_strain", &explicit(), 1.0);
    let [one, four] = [1, 4].map(|threads| on_threads(threads, || finish(&case)));
    assert!(one.last() == four.last(), "threads change bits");
    goes_on(&case, &one, 3);
}

/// Random soils on uneven meshes under a load that jumps: with increments at the limit nothing grows, whatever the water does.
#[test]
fn increments_at_the_limit_are_stable() {
    let mut random = 7u64;
    let mut draw = |low: f64, high: f64| {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (random >> 11) as f64 / (1u64 << 53) as f64
    };
    for trial in 0..24 {
        let kind = ["q4", "t3", "q8", "t6"][trial % 4];
        let law = ["linear", "hencky"][trial / 4 % 2];
        let (shift, bend, stretch) = (draw(-0.1, 0.1), draw(-0.1, 0.1), draw(0.2, 2.0));
        let uneven = |s: f64, t: f64| {
            [1.0 + s + shift * (4.0 * t).sin() * s * (1.0 - s), stretch * (t + bend * (5.0 * s).sin() * t * (1.0 - t))]
        };
        let mesh = meshed(kind, &Blocks::default().block("soil", [4, 3], uneven).json());
        let section = ["plane_strain", "axisymmetric"][trial / 8 % 2];
        let (porosity, permeability) = (draw(0.2, 0.6), 10f64.powf(draw(-8.0, 2.0)));
        let case = json!({
            "mesh": mesh, "section": section,
            "bodies": {"soil": {
                "material": {"model": law, "E": 1, "nu": draw(0.0, 0.45), "density": draw(0.5, 2.0)},
                "pore_fluid": {"bulk_modulus": 10f64.powf(draw(-2.0, 2.0)), "porosity": porosity, "permeability": permeability, "unit_weight": 1, "biot": draw(porosity, 1.0)},
            }},
            "steps": [{
                "name": "shake", "duration": 20, "scheme": {"explicit": {"safety": 1.0}}, "dt": {"initial": 1},
                "supports": [{"on": "soil_bottom", "ux": 0, "uy": 0}], "drainage": [{"on": "soil_right", "pressure": 0}],
                "loads": [{"on": "soil_top", "dead_pressure": "1e-4*ramp(t)"}],
            }],
        });
        let case = serde_json::from_str(&case.to_string().replace("ramp(t)", "(1-exp(-1000*t))")).expect("a case");
        let run = finish(&case);
        let farthest = |state: &fecontact::model::state::State| {
            state.displacement.iter().fold(0.0f64, |most, u| most.max(u.abs()))
        };
        let half = run.states.len() / 2;
        let [first, last] =
            [&run.states[..half], &run.states[half..]].map(|part| part.iter().map(farthest).fold(0.0, f64::max));
        println!(
            "{trial} {kind} {law}: {} increments, {first:.2e}, {last:.2e}, water {:.1e}",
            run.last().increment,
            permeability
        );
        assert!(last < 3.0 * first, "{trial} {kind} {law}: {last} after {first}");
        audit(&run, 1e-5);
    }
}

/// Two wet blocks under a load that swings, one of them with a coarser mesh.
fn two_blocks(kind: &str, more: &Value, scheme: &Value, dt: f64) -> Value {
    let blocks = Blocks::default().rectangle("low", [6, 3], [0.0, -0.5], [1.0, 0.0]);
    let blocks = blocks.rectangle("high", [4, 3], [0.0, 0.0], [1.0, 0.5]);
    let mut body = soil(0.3);
    body["material"]["density"] = json!(1e-2);
    body["initial_stress"] = json!({"components": {"xx": 0, "yy": -0.02, "zz": 0, "xy": 0}});
    let contact = json!({"slave": "high_bottom", "master": "low_top", "friction": {"law": "coulomb", "mu": 0.3}, "initial": {"pressure": 0.02}});
    json!({
        "mesh": meshed(kind, &blocks.json()), "bodies": {"low": body, "high": body}, "contacts": {"cut": with(contact, more)},
        "steps": [{
            "name": "load", "duration": 1, "scheme": scheme, "dt": {"initial": dt, "max": dt},
            "supports": [{"on": "low_bottom", "ux": 0, "uy": 0}],
            "drainage": [{"on": "high_top", "pressure": 0}, {"on": "low_bottom", "pressure": "0.01*(1-cos(3*t))"}],
            "loads": [{"on": "high_top", "dead_pressure": "0.02+0.01*(1-cos(3*t))"}],
        }],
        "output": {"interval": 0.1},
    })
}

/// Water across contacts and along them goes as in implicit increments twice as long, and is all accounted for.
#[test]
fn contacts_agree_with_implicit_increments() {
    let along =
        json!({"fluid_pressure": {"flow": {"storage": 0.3, "transmissivity": 0.2, "viscosity": 1, "initial": 0}}});
    for (what, kind, more) in [
        ("across", "q4", json!({})),
        ("across", "t3", json!({"seal": 0.1})),
        ("across", "q8", json!({"method": "mortar"})),
        ("along", "q4", along),
    ] {
        let moving = finish(&two_blocks(kind, &more, &explicit(), 1.0));
        let dt = 0.1 / (0.1 / moving.last().dt).round();
        let solved = finish(&two_blocks(kind, &more, &json!({"hht": {"alpha": -0.1}}), 2.0 * dt));
        let [pressures, outlets] = apart(&moving, &solved);
        println!("{what} {kind}: {} increments, p {pressures:.1e}, out {outlets:.1e}", moving.last().increment);
        assert!(pressures < 0.02 && outlets < 0.01, "{what} {kind}: {pressures}, {outlets}");
        balance(&moving, 1e-9);
        goes_on(&two_blocks(kind, &more, &explicit(), 1.0), &moving, 4);
    }
}

/// Two wet blocks, the upper one of which is lifted by the water and drains by the gap.
pub fn lifted(scheme: &Value, dt: f64) -> Value {
    let mut case = two_blocks("q4", &json!({"open_pressure": 0}), scheme, dt);
    case["steps"][0]["duration"] = json!(2);
    case["steps"][0]["drainage"][1]["pressure"] = json!("0.08*(1-cos(3*t))");
    case
}

/// Water that lifts the upper block, and leaves by the gap: outflow .0773. Implicit increments come to it as they are made shorter, .0595, .0722, .0743 and
/// .0752 in increments of 1/250, 1/500, 1/1000 and 1/2000.
#[test]
fn what_opens_drains_as_in_short_implicit_increments() {
    let moving = finish(&lifted(&explicit(), 1.0));
    let solved = finish(&lifted(&json!({"hht": {"alpha": -0.1}}), 1e-3));
    let flow = moving.model.flow.as_ref().expect("water flows");
    let gap = flow.outlets.iter().position(|name| name == "cut").expect("an outlet");
    let [out, expected] = [&moving, &solved].map(|run| run.last().water.outlets[gap].volume);
    println!("out {out:.4} {expected:.4}, {} increments", moving.last().increment);
    close("out", out, expected, 0.06 * expected);
    assert!(expected > 0.07, "{expected}");
    balance(&moving, 1e-9);
    goes_on(&lifted(&explicit(), 1.0), &moving, 4);
}

/// Differences of the pressures at the ends of two runs, and of what has left by their outlets, over the largest of each.
fn apart(run: &Finished, other: &Finished) -> [f64; 2] {
    let flow = run.model.flow.as_ref().expect("water flows");
    let pressures = |run: &Finished| -> Vec<f64> {
        (0..flow.count()).map(|k| flow.pressure(k, Some(&run.last().displacement))).collect()
    };
    let outlets =
        |run: &Finished| -> Vec<f64> { run.last().water.outlets.iter().map(|outlet| outlet.volume).collect() };
    let over = |values: &[f64], others: &[f64]| {
        distance(values, others) / values.iter().fold(0.0f64, |most, value| most.max(value.abs()))
    };
    [over(&pressures(run), &pressures(other)), over(&outlets(run), &outlets(other))]
}

/// A column that is compressed as it is told, by J: sealed, its pressure is b Q (1 − J), 1/Q = n/K_w + (b − n)(1 − b)/K; then water flows through it by Darcy's law
/// with the permeability of Kozeny and Carman, k (e/e₀)³ (1 + e₀)/(1 + e), e = (1 + e₀) J − 1, along a way that is shorter by J. A linear body counts as undeformed.
#[test]
fn water_of_a_given_volume_has_its_pressure_and_flow() {
    let (biot, porosity, bulk, jacobian) = (0.8, 0.5, 0.9 / (3.0 * (1.0 - 2.0 * 0.2)), 0.9);
    let pressure_expected = biot * (1.0 - jacobian) / (porosity / 1.0 + (biot - porosity) * (1.0 - biot) / bulk);
    let (start, now) = (1.0f64, 2.0 * jacobian - 1.0);
    let share = (now / start).powi(3) * (1.0 + start) / (1.0 + now) / jacobian;
    for (law, expected) in [("hencky", 0.05 * 10.0 * share), ("linear", 0.05 * 10.0)] {
        for (kind, scheme) in [("q4", explicit()), ("t6", explicit()), ("q4", json!("static"))] {
            let mut body = soil(10.0);
            body["material"]["model"] = json!(law);
            body["pore_fluid"]["biot"] = json!(biot);
            body["pore_fluid"]["kozeny_carman"] = json!(law == "hencky");
            let step = json!({
                "scheme": scheme, "duration": 1, "dt": {"initial": 0.1},
                "supports": [{"on": "b0", "ux": 0, "uy": "-0.1*y*min(t,1)"}],
            });
            let mut case = column("q4", &[4], &body, step);
            case["mesh"] = meshed(kind, &case["mesh"]);
            let drains = json!([{"on": "b0_top", "pressure": 0}, {"on": "b0_bottom", "pressure": 1}]);
            let steps = case["steps"].as_array_mut().expect("steps");
            steps.push(json!({"name": "flow", "duration": 1, "drainage": drains}));
            let run = finish(&case);
            let found = pressure(&run, run.at(1.0), [0.0, 0.0]);
            let flow = run.model.flow.as_ref().expect("water flows");
            let rate = |name: &str| {
                let outlet = flow.outlets.iter().position(|other| other == name).expect("an outlet");
                run.last().water.outlets[outlet].rate
            };
            println!(
                "{law} {kind} {scheme}: p {found:.6} ({pressure_expected:.6}), q {:.6} ({expected:.6})",
                rate("b0_top")
            );
            close("p", found, pressure_expected, 1e-9);
            close("flow out", rate("b0_top"), expected, 1e-5 * expected);
            close("flow in", -rate("b0_bottom"), expected, 1e-5 * expected);
        }
    }
}

/// A wet block on wet ground that is sheared slowly until friction, which weakens by slip, lets it go.
fn let_go(permeability: f64, drains: Value, step: Value) -> Value {
    let mut case = two_blocks(
        "q4",
        &json!({"friction": {"law": "slip_weakening", "mu_s": 0.6, "mu_d": 0.2, "D_c": 2e-3}}),
        &json!("static"),
        0.05,
    );
    for body in ["low", "high"] {
        case["bodies"][body]["pore_fluid"]["permeability"] = json!(permeability);
    }
    case["steps"] = json!([with(
        json!({
            "name": "shear", "duration": 2.6, "dt": {"initial": 0.05, "min": 1e-3, "max": 0.05}, "drainage": drains,
            "supports": [{"on": "low_bottom", "ux": 0, "uy": 0}, {"on": "high_top", "ux": {"rate": 0.03}}],
            "loads": [{"on": "high_top", "dead_pressure": "0.02+0.002*t"}],
        }),
        &step,
    )]);
    case
}

/// Where a wet contact slips fast, the step goes on by explicit increments and returns from them with its water: what drains everywhere slips as dry
/// bodies do, and what drains slowly as by implicit increments that follow the motion.
#[test]
fn a_wet_contact_ruptures() {
    let rupture = json!({"rupture": {"slip_rate": 0.2}});
    let everywhere =
        ["low_left", "low_right", "low_bottom", "low_top", "high_left", "high_right", "high_bottom", "high_top"]
            .map(|side| json!({"on": side, "pressure": 0}));
    let slip = |run: &Finished| {
        let states = &run.last().contacts[0];
        states.iter().map(|state| state.friction.plastic_slip).sum::<f64>() / states.len() as f64
    };
    let free = finish(&let_go(1e3, json!(everywhere), rupture.clone()));
    let mut dry = let_go(1.0, json!([]), rupture.clone());
    for body in ["low", "high"] {
        dry["bodies"][body].as_object_mut().expect("a body").remove("pore_fluid");
    }
    let dry = finish(&dry);
    println!("slip {:.5e}, dry {:.5e}, {} ruptures", slip(&free), slip(&dry), free.report.ruptures);
    assert!(free.report.ruptures > 0 && dry.report.ruptures > 0);
    close("slip", slip(&free), slip(&dry), 1e-3 * slip(&dry).abs());

    let drains = json!([{"on": "high_top", "pressure": 0}]);
    let slow = finish(&let_go(0.02, drains.clone(), rupture.clone()));
    let followed = finish(&let_go(
        0.02,
        drains.clone(),
        json!({"scheme": {"hht": {"alpha": -0.3}}, "dt": {"initial": 2e-3, "max": 2e-3}}),
    ));
    let [_, outlets] = apart(&slow, &followed);
    println!(
        "slip {:.5e}, followed {:.5e}, out {outlets:.1e}, {} ruptures",
        slip(&slow),
        slip(&followed),
        slow.report.ruptures
    );
    assert!(slow.report.ruptures > 0);
    // Waves go on in the implicit step, which the static one stops.
    close("slip", slip(&slow), slip(&followed), 0.08 * slip(&followed).abs());
    assert!(outlets < 0.03, "{outlets}");
    balance(&slow, 1e-9);
    goes_on(&let_go(0.02, drains, rupture), &slow, 20);
}

/// What is prescribed of water holds at the end of every increment: the pressure of an outlet and that of a well along a contact, which change with time. No
/// force is left where pressures are unknowns, as the balances are met.
#[test]
fn what_is_prescribed_is_that_of_the_end_of_an_increment() {
    let top = |time: f64| 0.01 * (3.0 * time).sin();
    let well = |time: f64| 0.01 * (1.0 - (2.0 * time).cos());
    let along = json!({"fluid_pressure": {"flow": {"storage": 0.3, "transmissivity": 0.2, "viscosity": 1, "initial": 0,
        "wells": [{"at": [0, 0], "pressure": "0.01*(1-cos(2*t))"}]}}});
    let mut case = two_blocks("q4", &along, &explicit(), 1.0);
    case["steps"][0]["drainage"] = json!([{"on": "high_top", "pressure": "0.01*sin(3*t)"}]);
    let run = finish(&case);
    let flow = run.model.flow.as_ref().expect("water flows");
    let line = &run.model.contacts[0].conduit.as_ref().expect("a conduit").line;
    let end = line.nodes.iter().position(|&node| run.model.mesh.nodes[node].x.abs() < 1e-9).expect("an end");
    for state in run.states.iter().filter(|state| state.time > 0.0) {
        close("outlet", pressure(&run, state, [0.5, 0.5]), top(state.time), 1e-7);
        close("well", state.conduits[0].pressure[end], well(state.time), 1e-7);
        assert!(state.force[flow.dof(0)..].iter().all(|force| *force == 0.0), "a force at a pressure");
    }
    // An increment earlier the values are others.
    let dt = run.last().dt;
    assert!(0.01 * 3.0 * dt > 1e-5, "{dt}");
}

/// An outlet that lets water out alone opens and closes as a column swings: all of its water is accounted for, in every increment.
#[test]
fn seepage_that_switches_is_balanced() {
    let mut body = soil(0.05);
    body["material"]["model"] = json!("hencky");
    let mut case = column(
        "q4",
        &[12],
        &body,
        json!({
            "scheme": explicit(), "duration": 4, "dt": {"initial": 1}, "drainage": [{"on": "b0_top", "seepage": true}],
            "loads": [{"on": "b0_top", "dead_pressure": "0.02*sin(3*t)"}],
        }),
    );
    case["output"] = json!({"interval": 0.05});
    let run = finish(&case);
    let rates: Vec<f64> = run.states.iter().map(|state| state.water.outlets[0].rate).collect();
    let switches = rates.windows(2).filter(|pair| (pair[0] == 0.0) != (pair[1] == 0.0)).count();
    assert!(switches >= 3 && rates.iter().all(|rate| *rate >= 0.0), "{switches} switches");
    balance(&run, 1e-11);
}

/// Water of ground that is held, whose pressure is even and leaves through a filter, p' = −κ p/(S H): the first increment of a static step after explicit ones is
/// one of backward Euler, p/(1 + κ Δt/(S H)), as what explicit increments remember ends with their step.
#[test]
fn a_static_step_begins_anew_after_an_explicit_one() {
    let mut body = soil(1e6);
    body["pore_fluid"]["pressure"] = json!(1);
    let mut case = column(
        "q4",
        &[2],
        &body,
        json!({"scheme": explicit(), "duration": 0.2, "dt": {"initial": 0.01}, "drainage": [{"on": "b0_top", "pressure": 0, "filter": 0.7}]}),
    );
    case["steps"][0]["supports"] = json!([{"on": "b0", "ux": 0, "uy": 0}]);
    let steps = case["steps"].as_array_mut().expect("steps");
    steps.push(json!({"name": "rest", "scheme": "static", "duration": 0.1, "dt": {"initial": 0.1}}));
    let run = finish(&case);
    let [before, after] = [run.at(0.2), run.last()].map(|state| pressure(&run, state, [0.0, 0.0]));
    let faded = (-0.7f64 * 0.2 / 0.5).exp();
    println!("{before:.6} ({faded:.6}), then {:.7} of it", after / before);
    close("explicit", before, faded, 1e-3);
    close("static", after / before, 1.0 / (1.0 + 0.7 * 0.1 / 0.5), 1e-5);
}
