//! The terms of the equations: what their tangents depend on, and integrals weighted by the section.

use std::path::Path;
use std::sync::Arc;

use crate::common::{self, Blocks, close};
use fecontact::case;
use fecontact::equations::sums::Dependence;
use fecontact::equations::term::Term;
use fecontact::equations::{Assembler, Trial};
use fecontact::linear::system::Request;
use fecontact::mesh::section::Section;
use fecontact::model::{Model, State};
use serde_json::{Value, json};

/// w = 1 + 0.1 x
const GRADED: Section = Section::Graded { depth: 1.0, slope: [0.1, 0.0] };

/// The model of a case in a section.
fn model_in(section: Section, case: &Value) -> Arc<Model> {
    let case = case::from_text(&case.to_string(), Path::new("test.json")).expect("well formed");
    let case::file::MeshSource::Inline(mesh) = &case.mesh else { panic!("an inline mesh") };
    let mesh = fecontact::mesh::Mesh { section, ..mesh.build().expect("a good mesh") };
    Arc::new(case::build_on(&case, mesh, Path::new("test.json")).expect("a good case"))
}

/// A number between −1 and 1, the same for the same k.
fn arbitrary(k: usize) -> f64 {
    2.0 * ((k as f64 + 1.0) * 0.618_033_988_749_895).fract() - 1.0
}

pub fn arbitrary_displacement(model: &Model, size: f64) -> Vec<f64> {
    (0..model.dofs()).map(|dof| size * arbitrary(dof)).collect()
}

/// Another one, whose sums with the first are arbitrary as well.
pub fn another_displacement(model: &Model, size: f64) -> Vec<f64> {
    (0..model.dofs()).map(|dof| size * arbitrary(dof * dof)).collect()
}

/// A state with velocities and accelerations.
pub fn moving(model: &Model) -> State {
    let mut state = model.initial_state();
    state.velocity = (0..model.dofs()).map(|dof| 0.3 * arbitrary(dof + 7)).collect();
    state.acceleration = (0..model.dofs()).map(|dof| 2.0 * arbitrary(dof + 11)).collect();
    state
}

/// A block on another, with every kind of load and damper.
fn everything(material: &str, scheme: Value, more: Value) -> Value {
    let mesh = Blocks::default().rectangle("lower", [2, 2], [0.0, -1.0], [2.0, 0.0]).rectangle(
        "upper",
        [2, 1],
        [0.5, -0.01],
        [1.5, 0.5],
    );
    let body = json!({
        "material": {"model": material, "E": 100, "nu": 0.3, "density": 2},
        "damping": {"mass": 0.2, "stiffness": 0.01}
    });
    let mut case = json!({
        "mesh": mesh.json(),
        "bodies": {"lower": body, "upper": body},
        "contacts": {"base": {"slave": "upper_bottom", "master": "lower_top", "friction": {"law": "coulomb", "mu": 0.3}}},
        "steps": [{
            "name": "step", "duration": 2, "scheme": scheme, "dt": {"initial": 0.1},
            "supports": [{"on": "lower_bottom", "ux": 0, "uy": 0}],
            "loads": [
                {"on": "upper_top", "pressure": {"rate": 3}},
                {"on": "upper_left", "spring": {"kx": 5}},
                {"on": "upper_right", "dashpot": {"cx": 0.5}},
                {"on": "lower_right", "absorbing": true}
            ]
        }]
    });
    case["steps"][0].as_object_mut().expect("a step").extend(more.as_object().expect("keys").clone());
    case
}

/// Each term's tangent is computed at another displacement, time and step size, one thing changed after the other. It must
/// keep its bits wherever its term says that it does not depend on what changed, and change where the term says that it does.
#[test]
fn terms_say_what_their_tangents_depend_on() {
    let dynamic = json!({"hht": {"alpha": -0.05}});
    let cases = [
        everything("linear", dynamic.clone(), json!({})),
        everything("neo_hookean", dynamic, json!({})),
        everything("linear", json!("static"), json!({"stabilize": 1e-3})),
    ];
    let mut seen = Vec::new();
    for case in &cases {
        let model = model_in(Section::PlaneStrain, case);
        let (state, step) = (moving(&model), &model.steps[0]);
        let mut assembler = Assembler::new(&model);
        let [u, other] = [0.01, 0.013].map(|size| arbitrary_displacement(&model, size));
        // Pushed together, so that the contact is closed.
        let pressed = |u: &[f64]| -> Vec<f64> {
            let upper = model.bodies.iter().find(|body| body.name == "upper").expect("a body");
            let mut u = u.to_vec();
            upper.nodes.iter().for_each(|&node| u[2 * node + 1] -= 0.03);
            u
        };
        let [u, other] = [u, other].map(|u| pressed(&u));
        let first = Trial::new(&state, step, 0.5, 0.1);
        let changes = [
            (Dependence::Displacement, Trial { ..first }, &other),
            (Dependence::Time, Trial { time: 0.7, ..first }, &u),
            (Dependence::StepSize, Trial { dt: 0.2, ..first }, &u),
        ];
        for term in Term::ALL {
            let says = term.dependence(&model, step);
            let mut tangent = |trial, u: &[f64]| assembler.tangent_of(term, trial, u).expect("a tangent").values;
            // Contact extends the pattern once.
            let (_, _) = (tangent(first, &u), tangent(first, &other));
            let here = tangent(first, &u);
            for (change, trial, u) in &changes {
                let changed = tangent(*trial, u) != here;
                assert!(says >= *change || !changed, "{term:?} says {says:?}, but changes with {change:?}");
            }
            let (_, trial, u) = changes.iter().find(|(change, ..)| *change == says).unwrap_or(&changes[0]);
            assert_eq!(tangent(*trial, u) != here, says != Dependence::Nothing, "{term:?} says {says:?}");
            seen.push((term, says));
        }
    }
    for expected in [
        (Term::Solids, Dependence::Nothing),
        (Term::Solids, Dependence::Displacement),
        (Term::Interfaces, Dependence::Displacement),
        (Term::Loads, Dependence::Time),
        (Term::Dampers, Dependence::StepSize),
        (Term::Stabilization, Dependence::Time),
        (Term::Damping, Dependence::StepSize),
        (Term::Damping, Dependence::Displacement),
        (Term::Inertia, Dependence::StepSize),
    ] {
        assert!(seen.contains(&expected), "{expected:?} was not met");
    }
}

/// The assembled tangent against central differences of the residual, in units of its largest entry.
pub fn tangent_error(model: &Arc<Model>, trial: Trial, u: &[f64], h: f64) -> f64 {
    let mut assembler = Assembler::new(model);
    let mut system = assembler.system();
    let mut responses = Vec::new();
    assembler.interfaces(trial, u, |_, _| Default::default(), Request::Tangent, &mut responses).expect("responses");
    assembler.assemble(trial, u, &responses, Request::Tangent, &mut system).expect("a tangent");
    let mut unit = vec![0.0; u.len()];
    let (mut worst, mut largest) = (0.0f64, 0.0f64);
    for dof in 0..u.len() {
        unit[dof] = 1.0;
        let column = system.tangent.multiply(&unit);
        unit[dof] = 0.0;
        let mut residual = |step: f64| {
            let mut moved = u.to_vec();
            moved[dof] += step;
            let mut there = assembler.system();
            assembler.residual(trial, &moved, &mut there).expect("a residual");
            there.residual
        };
        let [plus, minus] = [h, -h].map(&mut residual);
        for ((plus, minus), entry) in plus.iter().zip(&minus).zip(&column) {
            worst = worst.max(((plus - minus) / (2.0 * h) - entry).abs());
            largest = largest.max(entry.abs());
        }
    }
    worst / largest
}

/// Two blocks pressed together, in one contact method, the upper one turned a little so that no foot is at a node.
fn pressed(method: Value, slave: &str, master: Value) -> Value {
    let mesh = Blocks::default()
        .rectangle("lower", [3, 1], [0.0, -0.5], [2.0, 0.0])
        .block("upper", [2, 1], |s, t| common::turned([0.43 + 1.1 * s, -0.012 + 0.5 * t], 0.004));
    let body = json!({"material": {"model": "neo_hookean", "E": 100, "nu": 0.3, "density": 2}});
    json!({
        "mesh": mesh.json(),
        "bodies": {"lower": body, "upper": body},
        "contacts": {"base": {
            "slave": slave, "master": master, "method": method,
            "normal": {"alpha_n": 500}, "friction": {"law": "coulomb", "mu": 0.3, "alpha_t": 400}
        }},
        "steps": [{
            "name": "step", "duration": 1, "scheme": {"newmark": {}}, "dt": {"initial": 0.1},
            "supports": [{"on": "lower_bottom", "ux": 0, "uy": 0}],
            "loads": [{"on": "upper_top", "pressure": 3}, {"on": "upper_right", "absorbing": true}]
        }]
    })
}

/// ∂r/∂u of whole models, sections with a depth that varies included: solids, masses, pressures that follow the surface,
/// absorbing sides, and contact by every method, sticking and slipping.
#[test]
fn the_tangent_is_that_of_the_residual_in_any_section() {
    let plane = json!({"plane": {"point": [0.0, 0.0], "normal": [0.0, 1.0]}});
    let methods = [
        (json!("node_to_segment"), json!("lower_top")),
        (json!("gauss_to_segment"), json!("lower_top")),
        (json!("mortar"), json!("lower_top")),
        (json!("gauss_to_segment"), plane.clone()),
        (json!("mortar"), plane),
    ];
    for (method, master) in methods {
        for section in [
            Section::PlaneStrain,
            GRADED,
            Section::Graded { depth: 0.7, slope: [0.1, -0.3] },
            Section::PlaneStress { thickness: 0.3 },
            Section::Axisymmetric,
        ] {
            let model = model_in(section, &pressed(method.clone(), "upper_bottom", master.clone()));
            for slide in [1e-4, 3e-2] {
                let (state, step) = (moving(&model), &model.steps[0]);
                let mut u = arbitrary_displacement(&model, 1e-3);
                let upper = model.bodies.iter().find(|body| body.name == "upper").expect("a body");
                for &node in &upper.nodes {
                    u[2 * node] += slide;
                    u[2 * node + 1] -= 0.01;
                }
                let error = tangent_error(&model, Trial::new(&state, step, 0.5, 0.1), &u, 1e-6);
                let closed = {
                    let mut assembler = Assembler::new(&model);
                    let mut system = assembler.system();
                    assembler.residual(Trial::new(&state, step, 0.5, 0.1), &u, &mut system).expect("a residual");
                    assembler.evaluation.contacts.iter().flatten().filter(|c| c.friction.pressure > 0.0).count()
                };
                assert!(closed > 0, "{method} on {master}: nothing touches");
                assert!(error < 1e-6, "{method} on {master} in {section:?}, slide {slide}: {error:.1e}");
            }
        }
    }
}

/// The same with a fluid between the surfaces, closed and sticking, sliding, and lifted off, and with surfaces that dilate and
/// wear; in small sliding too. Where nothing is closed the fluid alone acts.
#[test]
fn the_tangent_of_a_contact_that_moves_or_holds_water_is_that_of_the_residual() {
    let plane = json!({"plane": {"point": [0.0, 0.0], "normal": [0.0, 1.0]}});
    let fluid = json!({"fluid_pressure": "(1 + 0.4*x)*(1 + t)"});
    let offset = json!({"dilatancy": {"rate": 0.2, "limit": 0.01}, "wear": 0.02});
    let mut all = offset.clone();
    all["fluid_pressure"] = fluid["fluid_pressure"].clone();
    all["friction"] =
        json!({"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.3, "r": 100, "kappa": 10, "xi": 0.02, "alpha_t": 400});
    let structured = json!({"dilatancy": {"structure": 0.5}, "friction": all["friction"]});
    let kinds = [
        ("node_to_segment", "finite"),
        ("gauss_to_segment", "finite"),
        ("mortar", "finite"),
        ("mortar", "small"),
        ("node_to_segment", "small"),
    ];
    let kinds = kinds.iter().flat_map(|kind| [json!("lower_top"), plane.clone()].map(|master| (kind, master)));
    // Each kind meets both sections, each addition too.
    for (k, ((method, sliding), master)) in kinds.enumerate() {
        for (i, more) in [&fluid, &offset, &all, &structured].into_iter().enumerate() {
            let mut case = pressed(json!(method), "upper_bottom", master.clone());
            let contact = case["contacts"]["base"].as_object_mut().expect("a contact");
            contact.insert("sliding".into(), json!(sliding));
            contact.extend(more.as_object().expect("keys").clone());
            let section = [Section::PlaneStrain, Section::Axisymmetric][(k / 2 + k + i) % 2];
            let model = model_in(section, &case);
            for [slide, lift] in [[1e-4, -0.01], [3e-2, -0.01], [1e-2, 0.04]] {
                let message = format!("{method}, {sliding} on {master} in {section:?}, {more}, moved {slide}, {lift}");
                moved_tangent(&model, [slide, lift], !more["fluid_pressure"].is_null(), &message);
            }
        }
    }
}

/// Friction that goes by the pressure in the pores of the slave's body has a tangent by all nodes of the elements behind the surface, by
/// every method, in small sliding, in rings, on a rigid plane and beside suction, sticking and slipping.
#[test]
fn the_tangent_of_friction_by_effective_stress_is_that_of_the_residual() {
    let plane = json!({"plane": {"point": [0.0, 0.0], "normal": [0.0, 1.0]}});
    for method in ["node_to_segment", "gauss_to_segment", "mortar"] {
        for (master, sliding) in
            [(json!("lower_top"), "finite"), (plane.clone(), "finite"), (json!("lower_top"), "small")]
        {
            for (element, material, pressure) in
                [("f_bar", "neo_hookean", 1), ("displacement", "hencky", -1), ("displacement", "linear", 1)]
            {
                let mut case = pressed(json!(method), "upper_bottom", master.clone());
                let fluid = json!({"bulk_modulus": 80, "porosity": 0.4, "pressure": pressure});
                case["bodies"]["upper"] = json!({"material": {"model": material, "E": 100, "nu": 0.3, "density": 2},
                    "element": element, "pore_fluid": fluid});
                case["contacts"]["base"]["fluid_pressure"] = json!("of_bodies");
                case["contacts"]["base"]["sliding"] = json!(sliding);
                for section in [Section::PlaneStrain, Section::Axisymmetric] {
                    let model = model_in(section, &case);
                    for slide in [1e-4, 3e-2] {
                        let message = format!(
                            "{method}, {sliding} on {master} in {section:?}, {element} {material}, slid {slide}"
                        );
                        moved_tangent(&model, [slide, -0.01], false, &message);
                    }
                }
            }
        }
    }
}

/// Check the tangent where the upper block is moved; it is closed unless it is lifted.
fn moved_tangent(model: &Arc<Model>, [slide, lift]: [f64; 2], is_wet: bool, message: &str) {
    let (state, step) = (moving(model), &model.steps[0]);
    let mut u = arbitrary_displacement(model, 1e-3);
    let upper = model.bodies.iter().find(|body| body.name == "upper").expect("a body");
    for &node in &upper.nodes {
        u[2 * node] += slide;
        u[2 * node + 1] += lift;
    }
    let trial = Trial::new(&state, step, 0.5, 0.1);
    let error = tangent_error(model, trial, &u, 1e-6);
    let mut assembler = Assembler::new(model);
    let mut system = assembler.system();
    assembler.residual(trial, &u, &mut system).expect("a residual");
    let points = || assembler.evaluation.contacts.iter().flatten();
    let closed = points().filter(|point| point.friction.pressure > 0.0).count();
    let wet = points().filter(|point| point.fluid > 0.0).count();
    assert_eq!(closed == 0, lift > 0.0, "{message}: {closed} are closed");
    assert_eq!(wet > 0, is_wet, "{message}: {wet} are in the fluid");
    assert!(error < 1e-6, "{message}: {error:.1e}");
}

fn sum(forces: &[f64], component: usize) -> f64 {
    forces.iter().skip(component).step_by(2).sum()
}

/// Forces of a block [0, 2] × [0, 1] in w = 1 + 0.1 x against closed forms: mass ρ ∫ w dA = 2.2 ρ and its first moment, a
/// traction's ∫ w dx = 2.2, a pressure's on the moved top, p ∫ w dx = p (2 (1 + 0.1 ū) + 0.2) with the shift ū, an absorbing
/// side's ρ c ∫ w dy = 1.2 ρ c at x = 2, and of a uniform stress P: work P:F ∫ w dA and Σ f_a over the right side, whose
/// resultant is not ∫ w P n ds alone, since w' P acts in the volume: Σ_a f_ai X_aj = P_ij ∫ w dA.
#[test]
fn loads_masses_and_stress_are_weighted_by_the_section() {
    let block = |loads: Value, material: Value| {
        json!({
            "mesh": Blocks::default().rectangle("block", [5, 3], [0.0, 0.0], [2.0, 1.0]).json(),
            "bodies": {"block": {"material": material}},
            "steps": [{"name": "step", "duration": 1, "scheme": {"newmark": {}}, "dt": {"initial": 0.1}, "loads": loads}]
        })
    };
    let linear = json!({"model": "linear", "E": 100, "nu": 0.3, "density": 3});
    let loads_of = |loads: Value, shift: f64| {
        let model = model_in(GRADED, &block(loads, linear.clone()));
        let (state, mut assembler) = (model.initial_state(), Assembler::new(&model));
        let mut system = assembler.system();
        let u: Vec<f64> = (0..model.dofs()).map(|dof| if dof % 2 == 0 { shift } else { 0.0 }).collect();
        let trial = Trial::new(&state, &model.steps[0], 1.0, 0.1);
        assembler.residual(trial, &u, &mut system).expect("a residual");
        (std::mem::take(&mut assembler.evaluation), model)
    };
    let (found, model) = loads_of(json!([{"on": "block_top", "traction": {"x": 4, "y": -5}}]), 0.3);
    close("traction x", sum(&found.loads, 0), 4.0 * 2.2, 1e-13);
    close("traction y", sum(&found.loads, 1), -5.0 * 2.2, 1e-13);
    let lumped: f64 = (0..model.mesh.elements.len()).map(|e| model.element_lumped_mass(e).sum()).sum();
    close("mass", lumped, 3.0 * 2.2, 1e-13);
    let (found, model) = loads_of(json!([{"on": "block", "gravity": {"y": -2}}]), 0.3);
    close("weight", sum(&found.loads, 1), -2.0 * 3.0 * 2.2, 1e-13);
    let moment: f64 =
        (0..model.mesh.nodes.len()).map(|node| model.mesh.nodes[node].x * found.loads[2 * node + 1]).sum();
    close("its moment", moment, -2.0 * 3.0 * (2.0 + 0.1 * 8.0 / 3.0), 1e-13);
    let (found, _) = loads_of(json!([{"on": "block_top", "pressure": 7}]), 0.3);
    close("pressure", sum(&found.loads, 1), -7.0 * (2.0 * 1.03 + 0.2), 1e-13);
    let (_, model) = loads_of(json!([{"on": "block_right", "absorbing": true}]), 0.0);
    let c = (3.0f64 * 100.0 * 0.7 / (1.3 * 0.4)).sqrt();
    let total: f64 = model.steps[0].loads.absorbers.iter().map(|absorber| absorber.coefficients[(0, 0)]).sum();
    close("absorbing side", total, 1.2 * c, 1e-13);
    for law in ["linear", "neo_hookean", "hencky"] {
        let model = model_in(GRADED, &block(json!([]), json!({"model": law, "E": 100, "nu": 0.3, "density": 3})));
        let gradient = [[0.01, 0.02], [-0.015, 0.005]];
        let of = |dof: usize| {
            let x = model.mesh.nodes[dof / 2];
            gradient[dof % 2][0] * x.x + gradient[dof % 2][1] * x.y
        };
        let u: Vec<f64> = (0..model.dofs()).map(of).collect();
        let deformation = nalgebra::Matrix2::new(1.01, 0.02, -0.015, 1.005);
        let stress = model.bodies[0].material.at_once(&deformation).expect("a stress");
        let (state, mut assembler) = (model.initial_state(), Assembler::new(&model));
        let trial = Trial::new(&state, &model.steps[0], 1.0, 0.1);
        assembler.forces(trial, &u, None).expect("forces");
        let found = &assembler.evaluation;
        close("energy", found.strain_energy, 2.2 * stress.energy, 1e-12);
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let nodes = 0..model.mesh.nodes.len();
            let virial: f64 = nodes.map(|node| found.force[2 * node + i] * model.mesh.nodes[node][j]).sum();
            close("virial", virial, 2.2 * stress.stress[(i, j)], 1e-11);
        }
    }
}

/// A uniform pressure p = α_n d of a block pushed flat into a plane by d: the force is p ∫ w dx over the moved bottom, by
/// every method, and what the penalty stores ½ p d ∫ w dx.
#[test]
fn contact_forces_are_weighted_by_the_section() {
    let (depth, shift, alpha_n) = (0.01, 0.2, 500.0);
    for method in ["node_to_segment", "gauss_to_segment", "mortar"] {
        for master in [json!({"plane": {"point": [0.0, 0.0], "normal": [0.0, 1.0]}}), json!("ground_top")] {
            let mesh = Blocks::default().rectangle("block", [4, 2], [0.0, 0.0], [2.0, 1.0]).rectangle(
                "ground",
                [3, 1],
                [-1.0, -1.0],
                [3.0, 0.0],
            );
            let body = json!({"material": {"model": "linear", "E": 100, "nu": 0.3, "density": 1}});
            let case = json!({
                "mesh": mesh.json(), "bodies": {"block": body, "ground": body},
                "contacts": {"base": {
                    "slave": "block_bottom", "master": master, "method": method,
                    "normal": {"alpha_n": alpha_n}, "friction": {"law": "frictionless"}
                }},
                "steps": [{"name": "step", "duration": 1, "scheme": {"newmark": {}}, "dt": {"initial": 1}}]
            });
            let model = model_in(GRADED, &case);
            let mut u = vec![0.0; model.dofs()];
            for &node in &model.bodies[0].nodes {
                (u[2 * node], u[2 * node + 1]) = (shift, -depth);
            }
            let (state, mut assembler) = (model.initial_state(), Assembler::new(&model));
            assembler.forces(Trial::new(&state, &model.steps[0], 1.0, 1.0), &u, None).expect("forces");
            let found = &assembler.evaluation;
            let force: f64 = model.bodies[0].nodes.iter().map(|&node| found.force[2 * node + 1]).sum();
            // The end-point rule is exact for w, which is linear.
            let area = 2.0 * (1.0 + 0.1 * shift) + 0.2;
            close(&format!("{method} on {master}: force"), force, -alpha_n * depth * area, 1e-12);
            let stored = fecontact::equations::contacts::stored(&model, &found.contacts);
            close(&format!("{method} on {master}: energy"), stored, 0.5 * alpha_n * depth * depth * area, 1e-12);
        }
    }
}
