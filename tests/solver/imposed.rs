//! Bodies with an initial stress, and bodies that are heated: whole models against closed forms.

use std::f64::consts::PI;

use crate::common::{self, Blocks, Finished, close, finish, half_way, quadratic, refusal};
use fecontact::contact::force::ContactState;
use fecontact::laws::bulk::CauchyStress;
use fecontact::output::probes::Reading;
use serde_json::{Value, json};

const E: f64 = 200.0;
const NU: f64 = 0.3;
const ALPHA: f64 = 1e-3;
const MODELS: [&str; 5] = ["linear", "saint_venant_kirchhoff", "neo_hookean", "hencky", "viscoelastic"];

fn material(model: &str) -> Value {
    match model {
        "viscoelastic" => json!({"model": model, "E": E, "nu": NU, "E_1": E, "tau": 2, "density": 1}),
        _ => json!({"model": model, "E": E, "nu": NU, "density": 1}),
    }
}

/// A body that is heated from 20 to 70 in a step.
fn heated(section: Value, mesh: Value, model: &str, supports: Value) -> Value {
    json!({
        "section": section, "mesh": mesh,
        "bodies": {"body": {"material": material(model), "thermal": {"expansion": ALPHA, "reference": 20}}},
        "steps": [{"name": "heat", "duration": 1, "dt": {"initial": 0.25}, "temperature": {"body": 70}, "supports": supports}]
    })
}

fn plate(thickness: f64) -> Value {
    json!({"plane_stress": {"thickness": thickness}})
}

/// Stresses at all integration points at the end.
fn stresses(run: &Finished) -> Vec<CauchyStress> {
    let (model, state) = (&run.model, run.last());
    let of = |e: usize| {
        let nodes = model.mesh.elements[e].nodes.iter();
        let u = nodes.map(|&n| nalgebra::Vector2::new(state.displacement[2 * n], state.displacement[2 * n + 1]));
        let material = &*model.bodies[model.body_of_element[e]].material;
        model.solids[e]
            .stresses(material, model.memories.of(e, &state.memory), &u.collect::<Vec<_>>())
            .expect("an answer")
    };
    (0..model.solids.len()).flat_map(of).collect()
}

fn distorted(low: [f64; 2]) -> Value {
    let map = move |s: f64, t: f64| {
        let bump = 0.1 * (PI * s).sin() * (PI * t).sin();
        [low[0] + 2.0 * (s + bump), low[1] + t - bump]
    };
    Blocks::default().block("body", [4, 3], map).json()
}

/// What may expand has no stress to 1e-12 of what it would have if held, and is 1 + α ΔT times as large, on any mesh, by any law,
/// in plates and rings; the energies are round-off.
#[test]
fn free_expansion_is_free_of_stress() {
    let (strain, e_alpha) = (50.0 * ALPHA, E * 50.0 * ALPHA);
    for model in MODELS {
        for (section, low) in [(plate(0.3), [0.0, 0.0]), (json!("axisymmetric"), [1.0, 0.0])] {
            for mesh in [distorted(low), quadratic(&distorted(low), half_way)] {
                let supports = match low[0] {
                    0.0 => json!([{"on": {"near": [0, 0]}, "ux": 0, "uy": 0}, {"on": {"near": [2, 0]}, "uy": 0}]),
                    _ => json!([{"on": {"near": [1, 0]}, "uy": 0}]),
                };
                let mut case = heated(section.clone(), mesh, model, supports);
                case["newton"] = json!({"tolerance": 1e-12});
                let run = finish(&case);
                for stress in stresses(&run) {
                    let largest =
                        [stress.xx, stress.yy, stress.xy, stress.zz].into_iter().fold(0.0f64, |a, b| a.max(b.abs()));
                    assert!(largest < 1e-12 * e_alpha, "{model}: {stress:?}");
                }
                for (node, x) in run.model.mesh.nodes.iter().enumerate() {
                    close("u_x", run.last().displacement[2 * node], strain * x.x, 1e-13);
                    close("u_y", run.last().displacement[2 * node + 1], strain * x.y, 1e-13);
                }
                let energy = run.last().energy;
                let volume: f64 = run.model.solids.iter().map(|solid| solid.volume()).sum();
                assert!(energy.strain < 1e-20 * E * volume && energy.external_work.abs() < 1e-12 * E * volume);
            }
        }
    }
}

/// Held bodies: −E α ΔT in a bar of a plate, −E α ΔT/(1 − ν) in a plate held all round, −E α ΔT/(1 − 2ν) in plane strain; a block
/// free in plane widens by (1 + ν) α ΔT and has −E α ΔT across. What the temperature did is what is stored, exactly: 3/2 E/(1 − 2ν)
/// (α ΔT)² per volume where all is held.
#[test]
fn held_bodies_have_their_closed_forms() {
    let mesh = || Blocks::default().rectangle("body", [4, 3], [0.0, 0.0], [2.0, 1.0]).json();
    let all = json!([{"on": "body_left", "ux": 0, "uy": 0}, {"on": "body_right", "ux": 0, "uy": 0},
        {"on": "body_top", "ux": 0, "uy": 0}, {"on": "body_bottom", "ux": 0, "uy": 0}]);
    let bar = json!([{"on": "body_left", "ux": 0}, {"on": "body_right", "ux": 0}, {"on": "body_bottom", "uy": 0}]);
    let free = json!([{"on": "body_left", "ux": 0}, {"on": "body_bottom", "uy": 0}]);
    let (e, strain) = (E * 50.0 * ALPHA, 50.0 * ALPHA);
    for (section, supports, [xx, yy, zz]) in [
        (plate(0.3), &bar, [-e, 0.0, 0.0]),
        (plate(0.3), &all, [-e / (1.0 - NU), -e / (1.0 - NU), 0.0]),
        (json!("plane_strain"), &all, [-e / (1.0 - 2.0 * NU); 3]),
        (json!("plane_strain"), &bar, [-e / (1.0 - NU), 0.0, -e / (1.0 - NU)]),
        (json!("plane_strain"), &free, [0.0, 0.0, -e]),
    ] {
        let run = finish(&heated(section.clone(), mesh(), "linear", supports.clone()));
        for stress in stresses(&run) {
            close("xx", stress.xx, xx, 1e-11 * e);
            close("yy", stress.yy, yy, 1e-11 * e);
            close("zz", stress.zz, zz, 1e-11 * e);
        }
        let (energy, volume) = (run.last().energy, run.model.solids.iter().map(|solid| solid.volume()).sum::<f64>());
        let strain_energy = match [xx, yy, zz] {
            // ½ σ:(ε − α ΔT 1) with the strain that the section leaves
            [x, y, z] => {
                let tr = x + y + z;
                let own = |s: f64| ((1.0 + NU) * s - NU * tr) / E;
                0.5 * (x * own(x) + y * own(y) + z * own(z)) * volume
            }
        };
        close("strain energy", energy.strain, strain_energy, 1e-12 * E * strain * strain);
        close("energy error", energy.error(), 0.0, 1e-12 * E * strain * strain);
        if xx == 0.0 {
            let corner = run.nodes("body_right")[0];
            close("widening", run.last().displacement[2 * corner], (1.0 + NU) * strain * 2.0, 1e-13);
        }
    }
    let squeezed = 1.0 + strain;
    let run = finish(&heated(json!("plane_strain"), mesh(), "hencky", all));
    for stress in stresses(&run) {
        close("Hencky", stress.xx, -E / (1.0 - 2.0 * NU) * squeezed.powi(3) * squeezed.ln(), 1e-12 * E);
    }
}

/// At large strains the audit of a body heated and held closes with the square of the increment.
#[test]
fn the_work_of_a_temperature_is_accounted_for() {
    let mesh = Blocks::default().rectangle("body", [3, 2], [1.0, 0.0], [2.0, 1.0]).json();
    let supports = json!([{"on": "body_left", "ux": 0, "uy": 0}, {"on": "body_right", "ux": {"rate": 0.02}, "uy": 0}]);
    for model in MODELS {
        for section in [json!("plane_strain"), plate(2.0), json!("axisymmetric")] {
            let error = |parts: f64| {
                let mut case = heated(section.clone(), mesh.clone(), model, supports.clone());
                (case["steps"][0]["dt"], case["newton"]) =
                    (json!({"initial": 1.0 / parts}), json!({"tolerance": 1e-11}));
                let energy = finish(&case).last().energy;
                assert!(energy.strain > 1e-3 && energy.external_work > 0.5 * energy.strain, "{model}: {energy:?}");
                energy.error().abs() / energy.strain
            };
            let [coarse, fine] = [8.0, 16.0].map(error);
            assert!(fine < 1e-3 && (fine < 0.27 * coarse || fine < 1e-10), "{model} {section}: {coarse:e} {fine:e}");
        }
    }
}

/// A strip of two metals bends by κ = 6 (α₂ − α₁) ΔT (1 + m)²/(h (3 (1 + m)² + (1 + m n)(m² + 1/(m n)))), m = t₁/t₂, n = E₁/E₂, which
/// is exact away from the ends. (Timoshenko (1925), J. Opt. Soc. Am. 11, 233)
#[test]
fn a_strip_of_two_metals_bends_as_timoshenko_says() {
    let (length, [t1, t2], [e1, e2], [a1, a2], rise) = (10.0, [0.1, 0.2], [100.0, 250.0], [1e-5, 3e-5], 50.0);
    let (rows, columns, h) = (6, 80, t1 + t2);
    let whole = Blocks::default().rectangle("body", [columns, rows], [0.0, 0.0], [length, h]).json();
    let mut mesh = quadratic(&whole, half_way);
    let elements = mesh["elements"].as_object_mut().expect("bodies").remove("body").expect("the strip");
    let elements = elements.as_array().expect("a list").clone();
    let (lower, upper) = elements.split_at(columns * rows / 3);
    (mesh["elements"]["one"], mesh["elements"]["two"]) = (json!(lower), json!(upper));
    let body = |e: f64, a: f64| json!({"material": {"model": "linear", "E": e, "nu": NU}, "thermal": {"expansion": a}});
    let run = finish(&json!({
        "section": plate(1.0), "mesh": mesh, "bodies": {"one": body(e1, a1), "two": body(e2, a2)},
        "steps": [{"name": "heat", "duration": 1, "dt": {"initial": 1}, "temperature": {"one": rise, "two": rise},
            "supports": [{"on": "body_left", "ux": 0}, {"on": {"near": [0, 0]}, "uy": 0}, {"on": {"near": [0, h]}, "uy": 0}]}]
    }));
    let up = |x: f64| {
        let nodes = &run.model.mesh.nodes;
        let node =
            (0..nodes.len()).find(|&k| (nodes[k].x - x).abs() < 1e-9 && nodes[k].y.abs() < 1e-9).expect("a node");
        run.last().displacement[2 * node + 1]
    };
    let curvature = (up(3.0) - 2.0 * up(5.0) + up(7.0)) / 4.0;
    let (m, n) = (t1 / t2, e1 / e2);
    let ratio = 3.0 * (1.0 + m).powi(2) + (1.0 + m * n) * (m * m + 1.0 / (m * n));
    let exact = -6.0 * (a2 - a1) * rise * (1.0 + m).powi(2) / (h * ratio);
    close("curvature", curvature, exact, 1e-6 * exact.abs());
}

/// A hot ring in a cold one presses with p = α ΔT b/C, C = b/E ((c² + b²)/(c² − b²) + (b² + a²)/(b² − a²)), as two rings of a shrink fit
/// do (Lamé), and lets go when it is cold again.
#[test]
fn a_hot_ring_is_shrunk_into_a_cold_one() {
    let ([a, b, c], rise) = ([1.0, 1.5, 2.0], 0.2);
    for (section, mesh, slave) in [
        (
            json!("axisymmetric"),
            Blocks::default()
                .rectangle("inner", [8, 2], [a, 0.0], [b, 0.2])
                .rectangle("outer", [8, 3], [b, 0.0], [c, 0.2])
                .json(),
            ["inner_right", "outer_left"],
        ),
        (
            plate(0.2),
            Blocks::default().ring("inner", [96, 8], [a, b]).ring("outer", [96, 8], [b, c]).json(),
            ["inner_outside", "outer_inside"],
        ),
    ] {
        let free = json!({"material": {"model": "linear", "E": E, "nu": NU}});
        let hot = json!({"material": {"model": "linear", "E": E, "nu": NU}, "thermal": {"expansion": ALPHA}});
        let held = match section == "axisymmetric" {
            true => json!([{"on": "inner_bottom", "uy": 0}, {"on": "outer_bottom", "uy": 0}]),
            false => {
                json!([{"on": {"near": [a, 0]}, "uy": 0}, {"on": {"near": [-a, 0]}, "uy": 0}, {"on": {"near": [0, a]}, "ux": 0},
                {"on": {"near": [c, 0]}, "uy": 0}, {"on": {"near": [-c, 0]}, "uy": 0}, {"on": {"near": [0, c]}, "ux": 0}])
            }
        };
        let run = finish(&json!({
            "section": section, "mesh": mesh, "bodies": {"inner": hot, "outer": free},
            "contacts": {"fit": {"slave": slave[0], "master": slave[1], "method": "mortar", "friction": {"law": "frictionless"},
                "normal": {"penetration": 1e-9}}},
            "steps": [
                {"name": "heat", "duration": 1, "dt": {"initial": 1}, "temperature": {"inner": rise}, "supports": held},
                {"name": "cool", "duration": 1, "temperature": {"inner": -0.01}}
            ]
        }));
        let square = |x: f64| x * x;
        let ring = |low: f64, high: f64| (square(high) + square(low)) / (square(high) - square(low));
        let exact = ALPHA * rise * E / (ring(b, c) + ring(a, b));
        let points = &run.at(1.0).contacts[0];
        let mean = points.iter().map(|p| p.friction.pressure * p.length).sum::<f64>()
            / points.iter().map(|p| p.length).sum::<f64>();
        close("pressure", mean, exact, 0.01 * exact);
        close("let go", run.contact_force(run.last())[0], 0.0, 1e-12 * exact);
    }
}

/// The hub of `cases/shrink_fit.json` presses with Lamé's pressure on a shaft whose bore is held, E α ΔT/(k_shaft + k_hub). Turned far
/// enough, friction is that at which weakening and recovery are equal, κ (μ/μ_k − 1) v = ξ (1 − μ/μ_s); the bore has its torque, and
/// heat is torque × angle.
#[test]
fn a_shrunk_hub_holds_its_shaft_by_lames_pressure() {
    let path = crate::common::repository("cases/shrink_fit.json");
    let case: Value = serde_json::from_str(&std::fs::read_to_string(&path).expect("the case")).expect("JSON");
    let run = crate::common::finish_at(&case, &path);
    assert_eq!(run.report.cutbacks, 0);
    let [a, b, c, depth, nu] = [10.0f64, 20.0, 40.0, 20.0, 0.3];
    let s = (a / b).powi(2);
    let hub = (c * c + b * b) / (c * c - b * b) + nu;
    let shaft = (1.0 - nu) * (1.0 - s) / (1.0 + s * (1.0 - nu) / (1.0 + nu));
    let pressure = 2e5 * 1.2e-5 * 150.0 / (shaft + hub);
    let [kappa, xi, mu_s, mu_k, v] = [20.0, 0.01, 0.25, 0.15, b * 0.001];
    let mu = (xi + kappa * v) / (xi / mu_s + kappa * v / mu_k);
    let mean = |time: f64| {
        let points = || run.at(time).contacts[0].iter();
        let length: f64 = points().map(|at| at.length).sum();
        let [p, q] = [|at: &ContactState| at.friction.pressure, |at: &ContactState| at.friction.traction]
            .map(|of| points().map(|at| of(at) * at.length).sum::<f64>() / length);
        [p, q.abs()]
    };
    close("pressure", mean(150.0)[0], pressure, 0.005 * pressure);
    for time in [160.0, run.last().time] {
        close("friction", mean(time)[1], mu * mean(time)[0], 1e-3 * mu * pressure);
        let state = run.at(time);
        let x = run.model.configuration(&state.displacement);
        let bore = run
            .nodes("bore")
            .into_iter()
            .map(|node| x.at(node).x * state.reaction[2 * node + 1] - x.at(node).y * state.reaction[2 * node]);
        let torque = 2.0 * PI * b * b * depth * mu * pressure;
        close("torque", bore.sum::<f64>(), torque, 0.005 * torque);
        let [before, after] = [time - 2.0, time].map(|time| run.at(time).energy.friction_dissipation);
        close("heat", after - before, torque * 0.002, 0.005 * torque * 0.002);
    }
    // Rest brings friction back.
    let peak = |from: f64| {
        run.states
            .iter()
            .filter(|state| state.time > from && state.time < from + 2.0)
            .map(|state| mean(state.time)[1])
            .fold(0.0, f64::max)
    };
    assert!(peak(1160.0) > 1.3 * mu * pressure, "{}", peak(1160.0));
}

/// A table by place is reached linearly over the step. One that is even in y bends a free strip without stress, u_x = α T' x y and
/// u_y = ½ α T' (y² − x²); one with a kink in x is the expression that says the same.
#[test]
fn temperatures_may_be_tables_by_place() {
    let mesh = Blocks::default().rectangle("body", [4, 2], [0.0, -0.5], [2.0, 0.5]).json();
    let mesh = quadratic(&mesh, half_way);
    let supports = json!([{"on": {"near": [0, 0]}, "ux": 0, "uy": 0}, {"on": {"near": [0, 0.5]}, "ux": 0}]);
    let run = |temperature: Value| {
        let mut case = heated(plate(0.1), mesh.clone(), "linear", supports.clone());
        case["steps"][0]["temperature"]["body"] = temperature;
        finish(&case)
    };
    let bent = run(json!({"y": [[-1, -30], [0, 20], [3, 170]]}));
    for time in [0.5, 1.0] {
        let rate = 50.0 * ALPHA * time;
        for (node, at) in bent.model.mesh.nodes.iter().enumerate() {
            let u = &bent.at(time).displacement[2 * node..][..2];
            close("u_x", u[0], rate * at.x * at.y, 1e-12);
            close("u_y", u[1], 0.5 * rate * (at.y * at.y - at.x * at.x), 1e-12);
        }
    }
    for stress in stresses(&bent) {
        close("stress", stress.xx.abs().max(stress.yy.abs()).max(stress.xy.abs()), 0.0, 1e-10);
    }
    let [table, message] = [json!({"x": [[0.5, 20], [1, 70]]}), json!("20 + 100*t*max(0, min(0.5, x - 0.5))")].map(run);
    let [table, message] = [table, message].map(|run| run.last().displacement.clone());
    close("the same", common::distance(&table, &message), 0.0, 1e-13);
    assert!(table.iter().any(|u| u.abs() > 0.01), "it widens");
}

/// A bar between a held end and a wall at a gap: it touches when α ΔT L is the gap, and then σ = −E (α ΔT L − g)/(L + E/α_n).
#[test]
fn a_heated_bar_closes_a_gap_and_presses() {
    let (length, gap, alpha_n) = (2.0, 0.04, 1e4);
    let mesh = Blocks::default().rectangle("body", [8, 3], [0.0, 0.0], [length, 0.5]).json();
    let supports = json!([{"on": "body_left", "ux": 0}, {"on": "body_bottom", "uy": 0}]);
    let mut case = heated(plate(0.1), mesh, "linear", supports);
    case["contacts"] = json!({"wall": {"slave": "body_right", "master": {"plane": {"point": [length + gap, 0], "normal": [-1, 0]}},
        "friction": {"law": "frictionless"}, "normal": {"alpha_n": alpha_n}, "sliding": "small"}});
    case["steps"][0]["temperature"]["body"] = json!({"table": [[0, 20], [0.5, 40], [1, 70]]});
    let run = finish(&case);
    close("touch", run.contact_force(run.at(0.5))[0], 0.0, 1e-9);
    let pressure = E * (ALPHA * 50.0 * length - gap) / (length + E / alpha_n);
    for stress in stresses(&run) {
        close("stress", stress.xx, -pressure, 1e-9 * pressure);
    }
}

/// Ground of two bodies that lie on each other along a line of some slope, at rest under its weight.
fn ground(model: &str, section: Value, slope: f64) -> Value {
    let k0 = 0.6;
    let body = json!({"material": material(model),
        "initial_stress": {"geostatic": {"surface": 3, "weight": 9.81, "K0": k0}}});
    let line = move |x: f64| 1.5 + slope * (x - 2.0);
    let lower = move |s: f64, t: f64| [1.0 + 2.0 * s, t * line(1.0 + 2.0 * s)];
    let upper = move |s: f64, t: f64| [1.0 + 2.0 * s, 3.0 - (1.0 - t) * (3.0 - line(1.0 + 2.0 * s))];
    json!({
        "section": section,
        "mesh": Blocks::default().block("lower", [5, 4], lower).block("upper", [3, 4], upper).json(),
        "bodies": {"lower": body, "upper": body},
        "contacts": {"joint": {"slave": "lower_top", "master": "upper_bottom", "method": "mortar",
            "friction": {"law": "coulomb", "mu": 0.6}, "initial": {"of_bodies": true}}},
        "steps": [{"name": "rest", "duration": 1, "dt": {"initial": 0.5},
            "supports": [{"on": "lower_bottom", "uy": 0}, {"on": "lower_left", "ux": 0}, {"on": "lower_right", "ux": 0},
                {"on": "upper_left", "ux": 0}, {"on": "upper_right", "ux": 0}],
            "loads": [{"on": "lower", "gravity": {"y": "-9.81"}}, {"on": "upper", "gravity": {"y": "-9.81"}}]}]
    })
}

/// One profile of two layers under a surcharge serves both bodies: they rest under σ_yy = −p₀ − Σ γ h and K₀ of the layer times that.
#[test]
fn layered_ground_under_a_surcharge_stays_at_rest() {
    let mut case = ground("linear", json!("plane_strain"), 0.0);
    let profile = json!({"geostatic": {"surface": 3, "weight": 9.81, "K0": 0.6, "surcharge": 5,
        "below": [{"top": 1.5, "weight": 19.62, "K0": 0.45}, {"top": 0.75, "weight": 19.62, "K0": 0.4}]}});
    for body in ["lower", "upper"] {
        case["bodies"][body]["initial_stress"] = profile.clone();
    }
    case["bodies"]["lower"]["material"]["density"] = json!(2);
    case["steps"][0]["loads"].as_array_mut().expect("loads").push(json!({"on": "upper_top", "dead_pressure": "5"}));
    let run = finish(&case);
    assert_eq!(run.model.warnings(), [""; 0]);
    let most = run.last().displacement.iter().fold(0.0f64, |most, u| most.max(u.abs()));
    assert!(most < 1e-12, "it moves by {most}");
    for point in &run.last().contacts[0] {
        close("p", point.friction.pressure, 5.0 + 9.81 * 1.5, 1e-9);
    }
    let body = |name: &str| run.model.bodies.iter().find(|body| body.name == name).expect("a body");
    for (name, y, yy, k0) in [
        ("upper", 3.0, -5.0, 0.6),
        ("upper", 2.0, -5.0 - 9.81, 0.6),
        ("lower", 1.25, -5.0 - 1.5 * 9.81 - 0.25 * 19.62, 0.45),
        ("lower", 0.5, -5.0 - 1.5 * 9.81 - 19.62, 0.4),
    ] {
        let found = body(name).total_stress(nalgebra::Vector2::new(2.0, y), false).expect("a stress");
        for (what, found, expected) in [("yy", found.yy, yy), ("xx", found.xx, k0 * yy), ("zz", found.zz, k0 * yy)] {
            close(&format!("{what} at y = {y}"), found, expected, 1e-12);
        }
    }
}

/// Ground in equilibrium does not move, in any scheme and section, whatever the law: σ_yy = −γ d, K₀ times that along x and across,
/// and the contact carries what the bodies bring.
#[test]
fn ground_at_rest_stays_at_rest() {
    for (scheme, section, slope) in [
        (json!("static"), json!("plane_strain"), 0.0),
        (json!("static"), json!("axisymmetric"), 0.0),
        (json!("static"), plate(0.5), 0.0),
        (json!("static"), json!("plane_strain"), 0.3),
        (json!({"hht": {"alpha": -0.1}}), json!("plane_strain"), 0.3),
        (json!({"explicit": {}}), json!("plane_strain"), 0.0),
    ] {
        for model in MODELS {
            let mut case = ground(model, section.clone(), slope);
            case["steps"][0]["scheme"] = scheme.clone();
            if section == "axisymmetric" {
                // Rings of even stress along radius and hoop are in balance.
                case["contacts"]["joint"]["friction"] = json!({"law": "frictionless"});
            }
            let run = finish(&case);
            assert_eq!(run.model.warnings(), [""; 0], "{model} {section}");
            let moved = run.last().displacement.iter().fold(0.0f64, |most, u| most.max(u.abs()));
            assert!(moved < 1e-12, "{model} {scheme} {section} {slope}: {moved:e}");
            let in_plate = section != "plane_strain" && section != "axisymmetric";
            for (e, element) in run.model.mesh.elements.iter().enumerate() {
                let (values, u) =
                    (run.model.quadrature_positions(e), vec![nalgebra::Vector2::zeros(); element.nodes.len()]);
                let material = &*run.model.bodies[run.model.body_of_element[e]].material;
                let memory = run.model.memories.of(e, &run.last().memory);
                let found = run.model.solids[e].stresses(material, memory, &u).expect("an answer");
                for (at, stress) in values.zip(found) {
                    let vertical = -9.81 * (3.0 - at.y);
                    close("yy", stress.yy, vertical, 1e-12);
                    close("xx", stress.xx, 0.6 * vertical, 1e-12);
                    close("zz", stress.zz, if in_plate { 0.0 } else { 0.6 * vertical }, 1e-12);
                }
            }
            if slope == 0.0 {
                for point in &run.last().contacts[0] {
                    close("p", point.friction.pressure, 9.81 * 1.5, 1e-9);
                    close("q", point.friction.traction, 0.0, 1e-9);
                }
            }
            close("energy", run.last().energy.error(), 0.0, 1e-9);
        }
    }
}

/// What is out of balance is told by the body's name, with how much it is and what to do; a static step takes it up, and the audit
/// closes.
#[test]
fn ground_out_of_balance_is_reported() {
    let message = |change: &dyn Fn(&mut Value)| {
        let mut case = ground("linear", json!("plane_strain"), 0.0);
        change(&mut case);
        common::model(&case).warnings()
    };
    let ramped = message(&|case| {
        case["steps"][0]["loads"] =
            json!([{"on": "lower", "gravity": {"y": -9.81}}, {"on": "upper", "gravity": {"y": -9.81}}])
    });
    assert_eq!(ramped.len(), 2);
    assert!(
        ramped[0].contains("body `lower` is not in equilibrium") && ramped[0].contains("loads grow from zero"),
        "{ramped:?}"
    );
    // Each body weighs 2 × 1.5 × 9.81 = 29.43; without gravity the upper one is pushed up by that, and so is the lower one but for
    // the nodes on its support.
    assert!(ramped[1].contains("resultant (0, 29.43)"), "{ramped:?}");
    let heavier = message(&|case| case["bodies"]["upper"]["material"]["density"] = json!(1.001));
    assert_eq!(heavier.len(), 1);
    assert!(heavier[0].contains("body `upper`") && heavier[0].contains("(0, -0.02943)"), "{heavier:?}");
    assert!(heavier[0].contains("check initial_stress"), "{heavier:?}");
    let open = message(&|case| drop(case["contacts"]["joint"].as_object_mut().expect("it is").remove("initial")));
    assert_eq!(open.len(), 2, "{open:?}");
    let free = message(&|case| case["steps"][0]["supports"].as_array_mut().expect("a list").truncate(3));
    assert!(free.len() == 1 && free[0].contains("body `upper`"), "{free:?}");
    let mut case = ground("neo_hookean", json!("plane_strain"), 0.0);
    case["bodies"]["upper"]["material"]["density"] = json!(1.05);
    let energy = finish(&case).last().energy;
    assert!(energy.error().abs() < 1e-3 * energy.external_work.abs(), "{energy:?}");
}

/// A band under an initial tension σ along x, sheared evenly by γ across it: the neo-Hookean law bears (G + σ) γ per area, the stiffness of
/// a string beside its own; one of small strains knows G γ alone.
#[test]
fn an_initial_tension_stiffens_a_band() {
    let (sigma, gamma, shear) = (50.0, 0.01, E / (2.0 * (1.0 + NU)));
    for (model, stiffness) in [("neo_hookean", shear + sigma), ("linear", shear)] {
        let mesh = Blocks::default().rectangle("body", [4, 2], [0.0, 0.0], [1.0, 0.5]).json();
        let even = json!(format!("{gamma} * x * t"));
        let run = finish(&json!({
            "mesh": mesh,
            "bodies": {"body": {"material": material(model),
                "initial_stress": {"components": {"xx": sigma, "yy": "0*x", "zz": {"y": [[0, 0], [1, 0]]}}}}},
            "newton": {"tolerance": 1e-12},
            "steps": [{"name": "shear", "duration": 1, "dt": {"initial": 1}, "supports": [
                {"on": "body_left", "ux": 0, "uy": 0}, {"on": "body_right", "ux": 0, "uy": even},
                {"on": "body_bottom", "ux": 0, "uy": even}, {"on": "body_top", "ux": 0, "uy": even}]}]
        }));
        assert_eq!(run.model.warnings(), [""; 0]);
        close(model, run.reaction("body_right", run.last())[1], stiffness * gamma * 0.5, 1e-12 * sigma);
    }
}

/// What is imposed is refused where it has no meaning.
#[test]
fn what_cannot_be_imposed_is_refused() {
    let base = || {
        let mut case = ground("linear", json!("plane_strain"), 0.0);
        case["bodies"]["upper"]["thermal"] = json!({"expansion": 1e-3});
        case
    };
    let with = |pointer: &str, key: &str, value: Value| {
        let mut case = base();
        case.pointer_mut(pointer).expect("a place")[key] = value;
        case
    };
    let stress = |value: Value| with("/bodies/upper", "initial_stress", value);
    let components = |value: Value| stress(json!({"components": value}));
    let mut plate_across = components(json!({"xx": 1, "yy": 1, "zz": 1}));
    plate_across["section"] = plate(1.0);
    let mut too_much = components(json!({"xx": -80, "yy": 0, "zz": 0}));
    too_much["bodies"]["upper"]["material"] = material("hencky");
    let mut quasi = base();
    quasi["steps"][0]["scheme"] = json!({"quasi_dynamic": {}});
    for (case, expected) in [
        (
            stress(json!({"geostatic": {"surface": 2, "weight": 1, "K0": 1}})),
            "surface: is 2, and the body reaches up to y = 3",
        ),
        (stress(json!({"geostatic": {"surface": 3, "weight": 0, "K0": 1}})), "weight: is 0: must be positive"),
        (stress(json!({"geostatic": {"surface": 3, "weight": 1, "K0": -1}})), "K0: is -1: must be zero or positive"),
        (
            stress(json!({"geostatic": {"surface": 3, "weight": 1, "K0": 1, "surcharge": -1}})),
            "surcharge: is -1: must be zero or positive",
        ),
        (
            stress(
                json!({"geostatic": {"surface": 3, "weight": 1, "K0": 1, "below": [{"top": 3.5, "weight": 1, "K0": 1}]}}),
            ),
            "below[0].top: is 3.5: layers follow each other downwards",
        ),
        (
            stress(
                json!({"geostatic": {"surface": 3, "weight": 1, "K0": 1, "below": [{"top": 1, "weight": 0, "K0": 1}]}}),
            ),
            "below[0].weight: is 0: must be positive",
        ),
        (components(json!({"xx": 1, "yy": 1})), "components.zz: is missing"),
        (components(json!({"xx": "1/(x-1)", "yy": 1, "zz": 0})), "components.xx: is not a finite number at (1, "),
        (components(json!({"xx": "t", "yy": 1, "zz": 0})), "the time t has no meaning here"),
        (plate_across, "components.zz: is 1: plane stress has no out-of-plane stress"),
        (
            with("/bodies/lower", "initial_stress", json!({"components": {"xx": 1, "yy": 1, "zz": 0}})),
            "the stress is tensile there",
        ),
        (with("/bodies/lower", "initial_stress", Value::Null), "on one body, and that with an initial_stress"),
        (with("/contacts/joint/initial", "pressure", json!(1)), "has no meaning together with of_bodies"),
        (with("/contacts/joint/initial", "balanced", json!(true)), "balanced would count it again"),
        (with("/contacts/joint", "initial", json!({"traction": 1})), "initial.pressure: is missing"),
        (with("/steps/0", "temperature", json!({"lower": 1})), "give bodies.lower.thermal"),
        (with("/steps/0", "temperature", json!({"middle": 1})), "there is no body `middle`"),
        (with("/steps/0", "temperature", json!({"upper": -1e3})), "at which the body has no volume left"),
        (with("/steps/0", "temperature", json!({"upper": "1/(t - 0.5)"})), "check temperature and expansion"),
        (
            with("/steps/0", "temperature", json!({"upper": {"y": [[1, 20], [0, 30]]}})),
            "steps[0].temperature.upper: the coordinates of the table must increase: 0 follows 1",
        ),
        (too_much, "too much for a body at rest; check the units"),
        (quasi, "initial_stress: is not for quasi_dynamic steps"),
    ] {
        let error = refusal(&case);
        assert!(error.contains(expected), "{error}\nlacks {expected}");
    }
}

/// A plate that is heated in explicit increments, evenly over many of its swings, ends as it does in statics but for what still swings.
#[test]
fn explicit_increments_heat_as_static_ones_do() {
    let mesh = Blocks::default().rectangle("body", [4, 3], [0.0, 0.0], [2.0, 1.0]).json();
    let supports = json!([{"on": "body_left", "ux": 0}, {"on": "body_right", "ux": 0}, {"on": "body_bottom", "uy": 0}]);
    for model in ["linear", "neo_hookean"] {
        let mut case = heated(json!("plane_strain"), mesh.clone(), model, supports.clone());
        case["bodies"]["body"]["damping"] = json!({"mass": 2.0});
        case["probes"] = json!({"middle": {"at": [1.0, 0.5]}});
        let mut fast = case.clone();
        (case["steps"][0]["duration"], case["steps"][0]["dt"]) = (json!(20), json!({"initial": 1}));
        (fast["steps"][0]["duration"], fast["steps"][0]["scheme"]) = (json!(20), json!({"explicit": {}}));
        fast["steps"][0]["temperature"]["body"] = json!({"table": [[0, 20], [10, 70]]});
        let [slow, fast] = [case, fast].map(|case| finish(&case));
        let of = |run: &Finished| Reading::of(&run.model.requests.probes[0], &run.model, run.last()).stress;
        close("stress", of(&fast).xx, of(&slow).xx, 1e-6 * E);
        close("across", of(&fast).zz, of(&slow).zz, 1e-6 * E);
        let energy = fast.last().energy;
        close("energy", energy.error(), 0.0, 1e-4 * energy.strain);
    }
}
