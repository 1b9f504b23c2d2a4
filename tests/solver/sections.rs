//! Plates and rings: whole models in plane stress and axisymmetry against closed forms.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::common::{self, Blocks, Finished, close, finish, half_way, half_way_round, quadratic, refusal};
use serde_json::{Value, json};

const E: f64 = 200.0;
const NU: f64 = 0.3;

/// A body of linear elasticity in one static increment.
fn linear_case(section: Value, mesh: Value, supports: Value, loads: Value) -> Value {
    json!({
        "section": section, "mesh": mesh,
        "bodies": {"body": {"material": {"model": "linear", "E": E, "nu": NU, "density": 1}}},
        "steps": [{"name": "load", "duration": 1, "dt": {"initial": 1}, "supports": supports, "loads": loads}]
    })
}

fn plate(thickness: f64) -> Value {
    json!({"plane_stress": {"thickness": thickness}})
}

/// Displacement of the node nearest to a place.
fn at(run: &Finished, [x, y]: [f64; 2]) -> [f64; 2] {
    let place = nalgebra::Vector2::new(x, y);
    let nodes = &run.model.mesh.nodes;
    let nearest = (0..nodes.len()).min_by(|&a, &b| (nodes[a] - place).norm().total_cmp(&(nodes[b] - place).norm()));
    let node = nearest.expect("a node");
    assert!((nodes[node] - place).norm() < 1e-9, "no node at ({x}, {y})");
    [run.last().displacement[2 * node], run.last().displacement[2 * node + 1]]
}

/// A block of a meridian: `s` along the radius, `t` along the angle from the plane z = 0 to the axis, or around a hole.
fn fan(divisions: [usize; 2], radius: impl Fn(f64) -> f64) -> Value {
    let map = |s: f64, t: f64| {
        let angle = FRAC_PI_2 * t;
        // Exactly on the axes.
        let [c, s_] = [if t == 1.0 { 0.0 } else { angle.cos() }, if t == 0.0 { 0.0 } else { angle.sin() }];
        [radius(s) * c, radius(s) * s_]
    };
    quadratic(&Blocks::default().block("body", divisions, map).json(), half_way_round)
}

/// A thick tube held along its axis, under a pressure p inside: u_r = (1 + ν) p a²/(E (b² − a²)) ((1 − 2ν) r + b²/r); and the force
/// that holds it is 2ν p π a². (Lamé)
#[test]
fn a_tube_under_pressure_is_lames() {
    let (a, b, p) = (1.0, 2.0, 0.7);
    let mesh = Blocks::default().rectangle("body", [16, 2], [a, 0.0], [b, 0.5]).json();
    let supports = json!([{"on": "body_bottom", "uy": 0}, {"on": "body_top", "uy": 0}]);
    let loads = json!([{"on": "body_left", "traction": {"x": p}}]);
    let run = finish(&linear_case(json!("axisymmetric"), quadratic(&mesh, half_way), supports, loads));
    for r in [a, 1.5, b] {
        let exact = (1.0 + NU) * p * a * a / (E * (b * b - a * a)) * ((1.0 - 2.0 * NU) * r + b * b / r);
        close(&format!("u_r at {r}"), at(&run, [r, 0.25])[0], exact, 2e-6 * exact);
    }
    let held = run.reaction("body_top", run.last())[1];
    close("force", held, 2.0 * NU * p * PI * a * a, 1e-5);
}

/// A hollow sphere under a pressure inside: u_r = p a³/(E (b³ − a³)) ((1 − 2ν) r + (1 + ν) b³/(2 r²)). Nodes on the axis keep
/// to it without being told. (Lamé)
#[test]
fn a_hollow_sphere_under_pressure_is_lames() {
    let (a, b, p) = (1.0, 2.0, 1e-5);
    let supports = json!([{"on": "body_bottom", "uy": 0}]);
    let loads = json!([{"on": "body_left", "pressure": p}]);
    let run = finish(&linear_case(json!("axisymmetric"), fan([10, 16], |s| a + (b - a) * s), supports, loads));
    let exact = |r: f64| {
        p * a.powi(3) / (E * (b.powi(3) - a.powi(3))) * ((1.0 - 2.0 * NU) * r + (1.0 + NU) * b.powi(3) / (2.0 * r * r))
    };
    for r in [a, 1.5, b] {
        close(&format!("u at {r}"), at(&run, [r, 0.0])[0], exact(r), 2e-5 * exact(r));
        close(&format!("u at {r} on the axis"), at(&run, [0.0, r])[1], exact(r), 2e-5 * exact(r));
        assert_eq!(at(&run, [0.0, r])[0], 0.0);
    }
}

/// A cylinder pressed by σ between smooth planes, of any mesh: u_r = ν σ r/E, u_z = −σ z/E exactly, and the planes bear
/// σ π R². A turn's strain energy is σ²/(2E) π R² h.
#[test]
fn a_smooth_cylinder_is_a_patch_of_rings() {
    let (radius, height, sigma) = (1.5, 1.0, 4.0);
    let bent = |s: f64, t: f64| {
        let bump = 0.15 * (PI * s).sin() * (PI * t).sin();
        [radius * (s + bump * (1.0 - s)), height * (t + 0.7 * bump)]
    };
    let linear = Blocks::default().block("body", [5, 4], bent).json();
    for mesh in [linear.clone(), quadratic(&linear, half_way)] {
        let supports = json!([{"on": "body_bottom", "uy": 0}]);
        let loads = json!([{"on": "body_top", "traction": {"y": -sigma}}]);
        let run = finish(&linear_case(json!("axisymmetric"), mesh, supports, loads));
        let state = run.last();
        for (node, x) in run.model.mesh.nodes.iter().enumerate() {
            close("u_r", state.displacement[2 * node], NU * sigma * x.x / E, 1e-14);
            close("u_z", state.displacement[2 * node + 1], -sigma * x.y / E, 1e-14);
        }
        let area = PI * radius * radius;
        close("force", run.reaction("body_bottom", state)[1], sigma * area, 1e-11);
        close("energy", state.energy.strain, 0.5 * sigma * sigma / E * area * height, 1e-12);
    }
}

/// A block in plane stress is squeezed freely: u_x = ν σ x/E without any hold across, and what bears it is σ t.
#[test]
fn a_plate_bears_by_its_thickness() {
    for thickness in [0.02, 3.0] {
        let mesh = Blocks::default().rectangle("body", [3, 2], [0.0, 0.0], [1.5, 1.0]).json();
        let supports = json!([{"on": "body_bottom", "uy": 0}, {"on": "body_left", "ux": 0}]);
        let loads = json!([{"on": "body_top", "traction": {"y": -4}}]);
        let run = finish(&linear_case(plate(thickness), mesh, supports, loads));
        close("u_x", at(&run, [1.5, 1.0])[0], NU * 4.0 * 1.5 / E, 1e-14);
        close("force", run.reaction("body_bottom", run.last())[1], 4.0 * 1.5 * thickness, 1e-12 * thickness);
    }
}

/// Kirsch: a plate pulled by S has 3 S and −S at the edge of a hole, which opens by 3 S a/E along the pull and closes by S a/E
/// across. The plate ends at 200 a, which is felt as (a/b)² = 3e-5.
#[test]
fn a_hole_in_a_plate_is_kirschs() {
    let (a, b, s) = (1.0, 200.0f64, 0.5);
    let supports = json!([{"on": "body_bottom", "uy": 0}, {"on": "body_top", "ux": 0}]);
    let loads = json!([{"on": "body_right", "traction": {"x": format!("{s} * x / {b}")}}]);
    let mut case = linear_case(plate(0.1), fan([80, 24], |q| a * (b / a).powf(q)), supports, loads);
    case["probes"] = json!({"side": {"at": [0.0, a]}, "front": {"at": [a, 0.0]}});
    let run = finish(&case);
    close("along", at(&run, [a, 0.0])[0], 3.0 * s * a / E, 3e-3 * s / E);
    close("across", at(&run, [0.0, a])[1], -s * a / E, 3e-3 * s / E);
    let read = |k: usize| fecontact::output::probes::Reading::of(&run.model.requests.probes[k], &run.model, run.last());
    let names: Vec<&str> = run.model.requests.probes.iter().map(|probe| probe.name.as_str()).collect();
    let of = |name: &str| read(names.iter().position(|other| *other == name).expect("a probe")).stress;
    close("3 S", of("side").xx, 3.0 * s, 0.02 * s);
    close("-S", of("front").yy, -s, 0.02 * s);
    assert_eq!(of("side").zz, 0.0);
}

/// Cook's membrane in plane stress, E = 1, ν = 1/3, unit load: the middle of the right side rises by 23.96 (Bergan & Felippa
/// (1985), Comput. Methods Appl. Mech. Eng. 50, 25, and others since).
#[test]
fn cooks_membrane_in_plane_stress() {
    let mesh = Blocks::default().block("body", [48, 48], |s, t| [48.0 * s, 44.0 * s + t * (44.0 - 28.0 * s)]).json();
    let supports = json!([{"on": "body_left", "ux": 0, "uy": 0}]);
    let loads = json!([{"on": "body_right", "traction": {"y": 1.0 / 16.0}}]);
    let mut case = linear_case(plate(1.0), quadratic(&mesh, half_way), supports, loads);
    case["bodies"]["body"]["material"] = json!({"model": "linear", "E": 1, "nu": 1.0 / 3.0});
    close("rise", at(&finish(&case), [48.0, 52.0])[1], 23.96, 0.01);
}

/// A strip of a plate flies against a wall at v, its sides held: until it leaves at 2L/c it bears ρ c v t on its height, and its
/// momentum turns around. c = √(E/(ρ (1 − ν²))) is the speed of a plate; that of plane strain would be 1.06 times as high.
#[test]
fn waves_in_a_plate_have_the_speed_of_plates_explicitly() {
    let (length, height, thickness, rho, v) = (4.0, 0.1, 0.3, 2.0, 0.01);
    let c = (E / (rho * (1.0 - NU * NU))).sqrt();
    let mesh = Blocks::default().rectangle("body", [160, 1], [0.0, 0.0], [length, height]).json();
    let case = json!({
        "section": plate(thickness), "mesh": mesh,
        "bodies": {"body": {"material": {"model": "linear", "E": E, "nu": NU, "density": rho}}},
        "initial_velocity": {"body": [-v, 0]},
        "steps": [{"name": "fly", "duration": 2.4 * length / c, "scheme": {"explicit": {}},
                   "supports": [{"on": "body_left", "ux": 0}, {"on": "body", "uy": 0}]}],
        "output": {"interval": 0.01 * length / c}
    });
    let run = finish(&case);
    let tip = |state: &fecontact::model::state::State| {
        let node = run.nodes("body_right")[0];
        state.displacement[2 * node]
    };
    let states = &run.states;
    let crossing =
        (1..states.len()).find(|&k| tip(&states[k - 1]) < 0.0 && tip(&states[k]) >= 0.0).expect("it returns");
    let (before, after) = (&states[crossing - 1], &states[crossing]);
    let share = tip(before) / (tip(before) - tip(after));
    close("2 L/c", (before.time + share * (after.time - before.time)) * c / length, 2.0, 0.01);
    let deepest = states.iter().map(&tip).fold(0.0, f64::min);
    close("v L/c", deepest / (v * length / c), -1.0, 0.01);
    let mean: f64 = {
        let during: Vec<f64> = states
            .iter()
            .filter(|state| (0.2..1.8).contains(&(state.time * c / length)))
            .map(|state| run.reaction("body_left", state)[0])
            .collect();
        during.iter().sum::<f64>() / during.len() as f64
    };
    close("rho c v", mean / (rho * c * v * height * thickness), 1.0, 0.02);
}

/// A thin ring under a sudden pressure breathes: u = p R²/(E d) (1 − cos ωt), ω = √(E/ρ)/R, for ν = 0 and thickness d; by implicit
/// and by explicit increments, of the linear law (whose stiffness is stored) and of a neo-Hookean one.
#[test]
fn a_ring_breathes() {
    let (radius, d, rho, p) = (2.0, 0.02, 3.0f64, 1e-6);
    let omega = (E / rho).sqrt() / radius;
    let mesh = Blocks::default().rectangle("body", [1, 2], [radius - 0.5 * d, 0.0], [radius + 0.5 * d, 0.05]).json();
    for model in ["linear", "neo_hookean"] {
        for scheme in [json!({"explicit": {}}), json!({"newmark": {}})] {
            let period = 2.0 * PI / omega;
            let case = json!({
                "section": "axisymmetric", "mesh": mesh,
                "bodies": {"body": {"material": {"model": model, "E": E, "nu": 0.0, "density": rho}}},
                "steps": [{"name": "breathe", "duration": 1.25 * period, "scheme": scheme, "dt": {"initial": 0.005 * period},
                           "supports": [{"on": "body_bottom", "uy": 0}],
                           "loads": [{"on": "body_left", "pressure": {"table": [[0, p], [1e3, p]]}}]}],
                "output": {"interval": 0.05 * period}
            });
            let run = finish(&case);
            let amplitude = p * (radius - 0.5 * d) * radius / (E * d);
            for state in &run.states {
                let node = run.nodes("body_left")[0];
                let exact = amplitude * (1.0 - (omega * state.time).cos());
                close(
                    &format!("{model} {scheme} at {}", state.time),
                    state.displacement[2 * node],
                    exact,
                    0.02 * amplitude,
                );
            }
            let energies = run.last().energy;
            close("energy", energies.error(), 0.0, 1e-3 * energies.external_work.abs());
        }
    }
}

/// Mass, weight and loads of a cylinder [0, 2] × [0, 1]: ρ π 4, and of its top side alone π 4; a side that absorbs has ρ c 2π r h.
#[test]
fn masses_and_loads_of_rings_are_those_of_the_full_turn() {
    use fecontact::equations::{Assembler, Trial};
    let mesh = Blocks::default().rectangle("body", [5, 3], [0.0, 0.0], [2.0, 1.0]);
    let case = json!({
        "section": "axisymmetric", "mesh": mesh.json(),
        "bodies": {"body": {"material": {"model": "linear", "E": E, "nu": NU, "density": 3}}},
        "steps": [{"name": "step", "duration": 1, "scheme": {"newmark": {}}, "dt": {"initial": 0.1}, "loads": [
            {"on": "body", "gravity": {"y": -2}}, {"on": "body_top", "traction": {"x": 4}},
            {"on": "body_bottom", "pressure": 5}, {"on": "body_right", "absorbing": true}
        ]}]
    });
    let model = std::sync::Arc::new(common::model(&case));
    let mass: f64 = (0..model.mesh.elements.len()).map(|e| model.element_lumped_mass(e).sum()).sum();
    close("mass", mass, 3.0 * PI * 4.0, 1e-12);
    let (state, mut assembler) = (model.initial_state(), Assembler::new(&model));
    let mut system = assembler.system();
    let u = vec![0.0; model.dofs()];
    assembler.residual(Trial::new(&state, &model.steps[0], 1.0, 0.1), &u, &mut system).expect("a residual");
    let sum = |i: usize| assembler.evaluation.loads.iter().skip(i).step_by(2).sum::<f64>();
    close("weight and pressure", sum(1), -2.0 * 3.0 * PI * 4.0 + 5.0 * PI * 4.0, 1e-11);
    close("traction", sum(0), 4.0 * PI * 4.0, 1e-11);
    let c = (3.0 * E * (1.0 - NU) / ((1.0 + NU) * (1.0 - 2.0 * NU))).sqrt();
    let absorbed: f64 = model.steps[0].loads.absorbers.iter().map(|absorber| absorber.coefficients[(0, 0)]).sum();
    close("absorbing side", absorbed, c * 2.0 * PI * 2.0, 1e-11 * absorbed);
}

/// What a section has no meaning for is refused, with its place and what to do.
#[test]
fn what_a_section_cannot_be_is_refused() {
    let mesh = Blocks::default().rectangle("body", [2, 2], [0.0, 0.0], [1.0, 1.0]).json();
    let beside = Blocks::default().rectangle("body", [2, 2], [-0.5, 0.0], [1.0, 1.0]).json();
    let base = |section: Value, mesh: &Value| {
        linear_case(section, mesh.clone(), json!([{"on": "body_bottom", "uy": 0}]), json!([]))
    };
    let with = |pointer: &str, value: Value| {
        let mut case = base(json!("axisymmetric"), &mesh);
        *case.pointer_mut(pointer).expect("a place") = value;
        case
    };
    let mut spun = base(json!("axisymmetric"), &mesh);
    spun["initial_velocity"] = json!({"body": [1, 0]});
    let mut f_bar = base(plate(1.0), &mesh);
    f_bar["bodies"]["body"]["element"] = json!("f_bar");
    let mut periodic = base(json!("axisymmetric"), &mesh);
    periodic["periodic"] = json!([["body_left", "body_right"]]);
    for (case, expected) in [
        (base(plate(0.0), &mesh), "section.plane_stress.thickness: is 0: must be positive"),
        (base(plate(-1.0), &mesh), "must be positive"),
        (base(json!("axisymmetric"), &beside), "lies at x = -0.5: x is the radius"),
        (with("/steps/0/loads", json!([{"on": "body", "gravity": {"x": 1}}])), "gravity has no such direction"),
        (
            with("/steps/0/supports", json!([{"on": "body_left", "ux": 0.1}])),
            "lies on the axis or on a plate, and keeps its radius",
        ),
        (
            with("/steps/0/supports", json!([{"on": "body_right", "rotation": {"about": [0, 0], "angle": 1}}])),
            "axisymmetric bodies cannot rotate in the plane",
        ),
        (with("/steps/0/supports", json!([])), "can move freely along y"),
        (spun, "along which they cannot move as a whole"),
        (f_bar, "f_bar is not needed in plane stress"),
        (periodic, "periodic along y only"),
    ] {
        let error = refusal(&case);
        assert!(error.contains(expected), "{error}\nlacks {expected}");
    }
    for wrong in [json!("plain_strain"), json!({"plane_stress": {}}), json!({"plane_stress": {"depth": 1}})] {
        refusal(&base(wrong, &mesh));
    }
}

/// Default penalties are stresses over lengths, 300 (λ + 2G)/h, with λ + 2G = E/(1 − ν²) in a plate: thickness and radius are no part
/// of them. Absorbing sides and fronts take the same speeds.
#[test]
fn penalties_and_speeds_know_the_section() {
    let mesh = Blocks::default().rectangle("body", [4, 2], [1.0, 0.0], [3.0, 1.0]).json();
    let bulk = E * (1.0 - NU) / ((1.0 + NU) * (1.0 - 2.0 * NU));
    for (section, modulus) in [(plate(0.01), E / (1.0 - NU * NU)), (json!("axisymmetric"), bulk)] {
        let mut case = linear_case(section, mesh.clone(), json!([{"on": "body_right", "ux": 0}]), json!([]));
        case["contacts"] = json!({"base": {
            "slave": "body_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "friction": {"law": "frictionless"}
        }});
        let model = common::model(&case);
        close("alpha_n", model.contacts[0].alpha_n, 300.0 * modulus / 0.5, 1e-8);
        let [rayleigh, shear, pressure] = fecontact::output::events::wave_speeds(&model);
        close("c_p", pressure, modulus.sqrt(), 1e-12);
        close("c_s", shear, (E / (2.0 * (1.0 + NU))).sqrt(), 1e-12);
        // Rayleigh's equation.
        let (x, k) = ((rayleigh / shear).powi(2), (shear / pressure).powi(2));
        close("c_R", (2.0 - x).powi(2), 4.0 * ((1.0 - x) * (1.0 - k * x)).sqrt(), 1e-9);
    }
}
