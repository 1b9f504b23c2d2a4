//! The stable increment of bodies full of water that press on each other: by the eigenvalues of the whole model; and surfaces that rattle.

use crate::common::warnings::is_listed;
use crate::common::{Blocks, Record, distance, finish, model};
use crate::saturated_explicit::{lifted, meshed};
use fecontact::equations::{Assembler, Trial};
use fecontact::model::Model;
use fecontact::model::state::State;
use fecontact::output::warnings::Warnings;
use fecontact::run::run;
use nalgebra::DMatrix;
use serde_json::{Value, json};
use std::sync::Arc;

/// Random numbers from a seed.
struct Random(u64);

impl Random {
    fn draw(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A number of any order of magnitude between 10^low and 10^high.
    fn decades(&mut self, low: f64, high: f64) -> f64 {
        10f64.powf(self.draw(low, high))
    }

    fn one_of<'a>(&mut self, names: &[&'a str]) -> &'a str {
        names[self.draw(0.0, names.len() as f64) as usize]
    }
}

/// Two random soils, one on the other, closed under a pressure; the load jumps. Water hardly flows, from one to the other or along the contact.
fn pressed(random: &mut Random, is_conduit: bool) -> (String, Value) {
    let kind = random.one_of(&["q4", "t3", "q8", "t6"]);
    let method = random.one_of(&["node_to_segment", "gauss_to_segment", "mortar"]);
    let section = random.one_of(&["plane_strain", "axisymmetric"]);
    let mut blocks = Blocks::default();
    let mut bodies = json!({});
    for (name, side) in [("low", -1.0), ("high", 0.0)] {
        let counts = [random.draw(2.0, 6.0) as usize, random.draw(1.0, 4.0) as usize];
        let (height, bend) = (random.decades(-1.0, 0.0), random.draw(-0.3, 0.3));
        let uneven = |s: f64, t: f64| {
            let bent = t + bend * (4.0 * s).sin() * t * (1.0 - t);
            [1.0 + s, height * (bent + side)]
        };
        blocks = blocks.block(name, counts, uneven);
        let porosity = random.draw(0.2, 0.6);
        bodies[name] = json!({
            "material": {"model": "linear", "E": random.decades(-1.0, 1.0), "nu": random.draw(0.0, 0.45), "density": random.draw(0.5, 2.0)},
            "initial_stress": {"components": {"xx": 0, "yy": -0.02, "zz": 0, "xy": 0}},
            "pore_fluid": {
                "bulk_modulus": random.decades(-1.0, 3.0), "porosity": porosity, "biot": random.draw(porosity, 1.0),
                "permeability": random.decades(-12.0, -11.0), "unit_weight": 1,
            },
        });
    }
    let mut contact = json!({
        "slave": "high_bottom", "master": "low_top", "method": method, "friction": {"law": "coulomb", "mu": 0.5, "alpha_t": random.decades(-1.0, 2.0)},
        "initial": {"pressure": 0.02}, "normal": {"alpha_n": random.decades(-1.0, 2.0)}, "seal": random.decades(-12.0, -11.0),
    });
    if is_conduit {
        contact["fluid_pressure"] = json!({"flow": {
            "storage": random.decades(-2.0, 1.0), "transmissivity": random.decades(-12.0, -11.0), "viscosity": 1, "initial": 0,
        }});
    }
    let case = json!({
        "mesh": meshed(kind, &blocks.json()), "section": section, "bodies": bodies, "contacts": {"cut": contact},
        "steps": [{
            "name": "shake", "duration": 40, "scheme": {"explicit": {"safety": 1.0}}, "dt": {"initial": 1},
            "supports": [{"on": "low_bottom", "ux": 0, "uy": 0}], "drainage": [{"on": "low_right", "pressure": 0}],
            "loads": [{"on": "high_top", "dead_pressure": "0.02+1e-4*(1-exp(-1000*t))"}],
        }],
        "output": {"interval": 4},
    });
    (format!("{kind} {method} {section}"), case)
}

/// Largest ω of a state with its closed contacts were all water trapped, from the tangent of the whole model and lumped masses:
/// ω² M = K + Bᵀ (S + P)⁻¹ B [1/T].
fn highest_frequency(model: &Arc<Model>, state: &State) -> f64 {
    let (step, flow) = (&model.steps[0], model.flow.as_ref().expect("water flows"));
    let mut assembler = Assembler::new(model);
    let mut system = assembler.system();
    // So short that nothing flows.
    let trial = Trial { settles: false, ..Trial::new(state, step, state.time, 1e-9) };
    assembler.tangent(trial, &state.displacement, false, &mut system).expect("a tangent");
    let mut mass = vec![0.0; model.dofs()];
    for (e, element) in model.mesh.elements.iter().enumerate() {
        for (node, share) in element.nodes.iter().zip(model.element_lumped_mass(e).iter()) {
            (0..2).for_each(|i| mass[2 * node + i] += share);
        }
    }
    let held: Vec<usize> = step.supports.iter().map(|support| support.at.dof).collect();
    let free: Vec<usize> = (0..flow.dof(0)).filter(|dof| !held.contains(dof)).collect();
    let all: Vec<usize> = free.iter().copied().chain(flow.dof(0)..model.dofs()).collect();
    let mut whole = DMatrix::zeros(all.len(), all.len());
    for (k, &dof) in all.iter().enumerate() {
        let mut unit = vec![0.0; model.dofs()];
        unit[dof] = 1.0;
        let column = system.tangent.multiply(&unit);
        all.iter().enumerate().for_each(|(row, other)| whole[(row, k)] = column[*other]);
    }
    let n = free.len();
    let parts = |rows: [usize; 2], columns: [usize; 2]| {
        whole.view((rows[0], columns[0]), (rows[1] - rows[0], columns[1] - columns[0])).into_owned()
    };
    let ([moves, seeps], water) = ([[0, n], [n, all.len()]], parts([n, all.len()], [n, all.len()]));
    let trapped = parts(moves, seeps) * water.lu().solve(&parts(seeps, moves)).expect("it is regular");
    let stiffness = parts(moves, moves) - trapped;
    let scaled = DMatrix::from_fn(n, n, |i, j| {
        0.5 * (stiffness[(i, j)] + stiffness[(j, i)]) / (mass[free[i]] * mass[free[j]]).sqrt()
    });
    scaled.symmetric_eigenvalues().max().sqrt()
}

/// Increments are within 2/ω of the whole model, whatever the bodies, the penalties and the water between them are.
#[test]
fn increments_are_below_the_limit_of_the_whole_model() {
    let mut random = Random(3);
    let mut shares = Vec::new();
    for trial in 0..60 {
        let (what, mut case) = pressed(&mut random, trial % 5 == 4);
        case["steps"][0]["duration"] = json!(0.4);
        case["output"]["interval"] = json!(0.4);
        let run = finish(&case);
        let share = 0.5 * run.last().dt * highest_frequency(&run.model, run.last());
        println!("{trial} {what}: {} increments, {share:.3} of the limit", run.last().increment);
        assert!(share <= 1.0 + 1e-9, "{trial} {what}: {share}");
        shares.push(share);
    }
    let most = shares.iter().copied().fold(0.0, f64::max);
    println!("at most {most:.3} of the limit, {:.3} in the mean", shares.iter().sum::<f64>() / shares.len() as f64);
}

/// Largest force of the contact between the rows of a run, and the warnings that it gives of what rattles.
fn forces(case: &Value) -> (Vec<f64>, Vec<String>) {
    let (mut record, mut warnings) = (Record::default(), Warnings::default());
    run(&model(case).into(), &mut [&mut record, &mut warnings]).1.expect("it runs");
    let force = |state: &State| state.contacts[0].iter().map(|point| point.length * point.friction.pressure).sum();
    (
        record.states.iter().map(force).collect(),
        warnings.list.into_iter().filter(|text| text.contains("rattle")).collect(),
    )
}

/// A block that is lifted and rattles on its penalty: a load that differs by 1e-9 changes forces at single moments by a tenth of the largest one or more. The run says
/// so, and that viscosity or a softer penalty calms it, with which they change by 1e-7 or less, and nothing is said.
#[test]
fn what_rattles_is_told() {
    let (thick, fast) = (1.0 / 6.0, 10.0);
    for (what, calm, viscosity) in
        [("as it is", None, 0.0), ("viscous", None, 0.18 * thick / fast), ("soft", Some(10), 0.0)]
    {
        let case = |load: f64| {
            let mut case = lifted(&json!({"explicit": {}}), 1.0);
            case["steps"][0]["loads"][0]["dead_pressure"] = json!(format!("{load:?}+0.01*(1-cos(3*t))"));
            for body in ["low", "high"] {
                case["bodies"][body]["damping"] = json!({"stiffness": viscosity});
            }
            if let Some(alpha) = calm {
                case["contacts"]["cut"]["normal"] = json!({"alpha_n": alpha});
            }
            case
        };
        let [(forces, warnings), (others, _)] = [0.02, 0.02 * (1.0 + 1e-9)].map(|load| forces(&case(load)));
        let largest = forces.iter().copied().fold(0.0, f64::max);
        let apart = distance(&forces, &others) / largest;
        println!("{what}: {apart:.1e} of the largest force; {warnings:?}");
        if what == "as it is" {
            let expected = ["contact `cut` at", "its surfaces rattle on the penalty", "`damping`", "alpha_n"];
            assert!(warnings.len() == 1 && expected.iter().all(|part| warnings[0].contains(part)), "{warnings:?}");
            assert!(apart > 0.1 && is_listed(&warnings[0]), "{apart}");
        } else {
            assert!(warnings.is_empty() && apart < 1e-6, "{what}: {apart}, {warnings:?}");
        }
    }
}
