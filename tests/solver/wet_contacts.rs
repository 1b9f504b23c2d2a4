//! Contacts between bodies whose water flows: it bears a part of the load there, and flows across.

use std::sync::Arc;

use crate::common::{Blocks, Finished, close, finish, half_way, model, quadratic, refusal, with};
use crate::terms::{another_displacement, arbitrary_displacement, tangent_error};
use fecontact::equations::Trial;
use fecontact::model::Model;
use fecontact::model::state::{LastIncrement, State};
use fecontact::run::error::Error;
use fecontact::run::observer::{Attempt, Observer};
use fecontact::run::{Saved, Simulation, run};
use serde_json::{Value, json};

/// Soil of stiffness M = 1 whose water is nearly incompressible and flows with c = 1.
fn soil() -> Value {
    json!({"material": {"model": "linear", "E": 0.9, "nu": 0.2},
           "pore_fluid": {"bulk_modulus": 1e7, "porosity": 0.5, "permeability": 1, "unit_weight": 1}})
}

/// A mesh of quadratic elements, or of linear ones.
fn mesh(blocks: &Blocks, kind: &str) -> Value {
    if kind == "q8" { quadratic(&blocks.json(), half_way) } else { blocks.json() }
}

/// Terzaghi's column of height 1, drained at the top and loaded by 1 at once, in two bodies that meet at half of its height.
fn cut_column(kind: &str, [low, high]: [usize; 2], contact: Value) -> Value {
    let blocks = Blocks::default().rectangle("low", [2, low], [0.0, 0.0], [0.25, 0.5]).rectangle(
        "high",
        [if low == high { 2 } else { 3 }, high],
        [0.0, 0.5],
        [0.25, 1.0],
    );
    let roller = |side: &str| json!({"on": side, "ux": 0});
    json!({
        "mesh": mesh(&blocks, kind), "bodies": {"low": soil(), "high": soil()}, "contacts": {"cut": contact},
        "steps": [{"name": "load", "duration": 0.5, "dt": {"initial": 0.005}, "supports": [
            {"on": "low_bottom", "ux": 0, "uy": 0}, roller("low_left"), roller("low_right"), roller("high_left"), roller("high_right")],
            "loads": [{"on": "high_top", "dead_pressure": "1"}], "drainage": [{"on": "high_top", "pressure": 0}]}],
    })
}

fn smooth() -> Value {
    json!({"slave": "high_bottom", "master": "low_top", "friction": {"law": "frictionless"}, "initial": {"pressure": 0.0}})
}

/// The pressure at the corner of a body nearest to a place.
fn pressure(run: &Finished, state: &State, body: &str, at: [f64; 2]) -> f64 {
    let flow = run.model.flow.as_ref().expect("water flows");
    let away = |node: usize| (run.model.mesh.nodes[node] - nalgebra::Vector2::from(at)).norm();
    let body = run.model.bodies.iter().find(|other| other.name == body).expect("a body");
    let own = body.nodes.iter().filter(|&&node| flow.of_node[node].is_some());
    let node = *own.min_by(|&&a, &&b| away(a).total_cmp(&away(b))).expect("a corner");
    flow.pressure(flow.of_node[node].expect("a pressure"), Some(&state.displacement))
}

fn balance(run: &Finished) {
    let mut throughput = 0.0f64;
    for state in &run.states {
        let [error, size] = run.model.balance_of_water(state).expect("water");
        throughput = throughput.max(size);
        close("balance", error, 0.0, 1e-8 * throughput.max(1e-6));
    }
}

/// A cut that stays closed changes nothing: pressures are those of one body to 0.05 % of the load.
#[test]
fn a_closed_cut_does_not_disturb_a_column() {
    for (kind, counts) in [("q4", [6, 6]), ("q8", [4, 4]), ("q4", [6, 5])] {
        let mut cut = cut_column(kind, counts, smooth());
        cut["steps"][0]["loads"][0]["dead_pressure"] = json!("0.1");
        let run = finish(&cut);
        let blocks = Blocks::default().rectangle("low", [2, counts[0] + counts[1]], [0.0, 0.0], [0.25, 1.0]);
        let mut whole = cut;
        whole.as_object_mut().expect("a case").remove("contacts");
        whole["mesh"] = mesh(&blocks, kind);
        whole["bodies"].as_object_mut().expect("bodies").remove("high");
        whole["steps"][0]["supports"] =
            json!([{"on": "low_bottom", "ux": 0, "uy": 0}, {"on": "low_left", "ux": 0}, {"on": "low_right", "ux": 0}]);
        whole["steps"][0]["loads"] = json!([{"on": "low_top", "dead_pressure": "0.1"}]);
        whole["steps"][0]["drainage"] = json!([{"on": "low_top", "pressure": 0}]);
        let one = finish(&whole);
        let mut worst = 0.0f64;
        for (cut, one_state) in run.states.iter().zip(&one.states) {
            for (body, y) in [("low", 0.0), ("low", 0.5), ("high", 0.5)] {
                // Of unlike elements the middle of the whole column is no corner.
                if counts[0] == counts[1] || y == 0.0 {
                    worst = worst
                        .max((pressure(&run, cut, body, [0.0, y]) - pressure(&one, one_state, "low", [0.0, y])).abs());
                }
            }
        }
        println!("{kind}, {counts:?}: largest difference of p {worst:.1e}");
        assert!(worst < if counts[0] == counts[1] { 5e-5 } else { 2e-4 }, "{kind}, {counts:?}: {worst}");
        balance(&run);
        // What the surfaces carry is what the water leaves.
        let last = run.last();
        for state in &last.contacts[0] {
            close("p + p_w", state.contact_pressure() + state.fluid, 0.1, 2e-4);
        }
        close("energy", last.energy.error(), 0.0, 1e-6 * last.energy.external_work);
    }
}

/// Steady flow through a seal: q = Δp/(H/k + 1/κ); of κ = 0 none, and the pressures stay those of the sides.
#[test]
fn a_seal_holds_back_water_by_its_number() {
    for conductance in [0.5, 4.0, 0.0] {
        let mut contact = smooth();
        contact["seal"] = json!(conductance);
        let mut case = cut_column("q4", [3, 3], contact);
        case["steps"][0]["duration"] = json!(100);
        case["steps"][0]["dt"] = json!({"initial": 0.5, "max": 20, "pore_pressure": 1e-3});
        case["steps"][0]["loads"] = json!([{"on": "high_top", "dead_pressure": "0.2"}]);
        case["steps"][0]["drainage"] =
            json!([{"on": "high_top", "pressure": 0}, {"on": "low_bottom", "pressure": 0.1}]);
        let run = finish(&case);
        let q = if conductance > 0.0 { 0.1 / (1.0 + 1.0 / conductance) } else { 0.0 };
        close("flow", run.last().water.outlets[0].rate, 0.25 * q, 1e-6);
        close("flow in", run.last().water.outlets[1].rate, -0.25 * q, 1e-6);
        let [below, above] = ["low", "high"].map(|body| pressure(&run, run.last(), body, [0.0, 0.5]));
        close("p below", below, 0.1 - 0.5 * q, 1e-6);
        close("p above", above, 0.5 * q, 1e-6);
        balance(&run);
    }
}

/// Mandel's specimen (a quarter of it, 1 × 1) cut along its middle between the axis and the plate, under a load so small that it keeps its shape.
#[test]
fn a_closed_cut_does_not_disturb_mandels_specimen() {
    for sliding in ["finite", "small"] {
        let mut contact = smooth();
        contact["sliding"] = json!(sliding);
        let blocks = Blocks::default().rectangle("low", [8, 4], [0.0, 0.0], [1.0, 0.5]).rectangle(
            "high",
            [8, 4],
            [0.0, 0.5],
            [1.0, 1.0],
        );
        let case = json!({
            "mesh": mesh(&blocks, "q8"), "bodies": {"low": soil(), "high": soil()}, "plates": [{"on": "high_top", "moves": "uy_alike"}],
            "contacts": {"cut": contact},
            "steps": [{"name": "load", "duration": 0.5, "dt": {"initial": 0.0025}, "supports": [
                {"on": "low_bottom", "uy": 0}, {"on": "low_left", "ux": 0}, {"on": "high_left", "ux": 0}],
                "loads": [{"on": "high_top", "total_force": {"y": "-0.001"}}],
                "drainage": [{"on": "low_right", "pressure": 0}, {"on": "high_right", "pressure": 0}]}],
        });
        let run = finish(&case);
        for (time, expected) in [(0.05, 1.09888), (0.1, 1.09541), (0.5, 0.59279)] {
            let state = run.states.iter().find(|state| (state.time - time).abs() < 1e-9).expect("a state");
            for (body, y) in [("low", 0.0), ("low", 0.5), ("high", 0.5)] {
                let found = pressure(&run, state, body, [0.0, y]) / 0.0005;
                println!("{sliding}, T = {time}, y = {y}: p/p0 {found:.5} ({expected})");
                close("p(0)/p0", found / expected, 1.0, 5e-3);
            }
        }
        balance(&run);
    }
}

/// Bodies of large strains pressed together, or apart, in the middle of a run.
fn strained(contact: Value, kind: &str, section: &str, gap: f64) -> (Arc<Model>, State, Vec<f64>) {
    let blocks = Blocks::default().rectangle("low", [3, 2], [1.0, 0.0], [2.0, 0.5]).rectangle(
        "high",
        [2, 2],
        [1.1, 0.5],
        [1.9, 1.0],
    );
    let body = json!({"material": {"model": "hencky", "E": 0.9, "nu": 0.2},
        "pore_fluid": {"bulk_modulus": 20, "porosity": 0.5, "permeability": 0.3, "unit_weight": 1, "pressure": "1 - 0.3*y"}});
    let case = json!({
        "section": section, "mesh": mesh(&blocks, kind), "bodies": {"low": body, "high": body}, "contacts": {"cut": contact},
        "steps": [{"name": "load", "duration": 1, "dt": {"initial": 0.1}, "supports": [{"on": "low_bottom", "ux": 0, "uy": 0}, {"on": "high_top", "ux": 0}],
            "loads": [{"on": "high_top", "dead_pressure": "1"}]}],
    });
    let model: Arc<Model> = model(&case).into();
    let mut state = model.initial_state();
    let old = arbitrary_displacement(&model, 0.01);
    state.displacement.clone_from(&old);
    state.last_increment =
        Some(LastIncrement { dt: 0.3, displacement: arbitrary_displacement(&model, 0.01), ends_in_touch: false });
    state.time = 0.1;
    let mut u: Vec<f64> = old.iter().zip(another_displacement(&model, 0.01)).map(|(a, b)| a + b).collect();
    model.bodies[0].nodes.iter().for_each(|&node| u[2 * node + 1] += gap);
    (model, state, u)
}

/// ∂r/∂u of all displacements and pressures, closed and open, by every method, with friction, and through a seal.
#[test]
fn the_tangent_is_that_of_the_residual() {
    for section in ["plane_strain", "axisymmetric"] {
        for kind in ["q4", "q8"] {
            for (gap, friction) in [
                (-0.05, json!({"law": "frictionless"})),
                (-0.05, json!({"law": "coulomb", "mu": 0.3})),
                (0.08, json!({"law": "frictionless"})),
            ] {
                for more in
                    [json!({}), json!({"seal": 0.4}), json!({"sliding": "small"}), json!({"method": "node_to_segment"})]
                {
                    let contact = with(
                        json!({"slave": "high_bottom", "master": "low_top", "friction": friction, "normal": {"alpha_n": 20}}),
                        &more,
                    );
                    let (model, state, u) = strained(contact, kind, section, gap);
                    let trial = Trial::new(&state, &model.steps[0], 0.3, 0.2);
                    let error = tangent_error(&model, trial, &u, 1e-6);
                    println!("{section}, {kind}, {gap}, {friction}, {more}: {error:.1e}");
                    assert!(error < 1e-8, "{section}, {kind}, {gap}, {friction}, {more}: {error:.1e}");
                }
            }
        }
    }
}

/// The same where surfaces that part drain, in the range of openings over which the drain grows.
#[test]
fn the_tangent_is_that_of_the_residual_of_what_drains() {
    for (kind, more) in [
        ("q4", json!({})),
        ("q8", json!({"seal": 0.4})),
        ("q4", json!({"sliding": "small"})),
        ("q8", json!({"method": "node_to_segment"})),
    ] {
        let contact = json!({"slave": "high_bottom", "master": "low_top", "friction": {"law": "frictionless"}, "normal": {"alpha_n": 20}, "open_pressure": 0.4});
        let (mut model, state, u) = strained(with(contact, &more), kind, "plane_strain", 0.02);
        let pair = &mut Arc::get_mut(&mut model).expect("nobody else has it").contacts[0];
        let open = pair.seam.as_mut().and_then(|seam| seam.open.as_mut()).expect("it drains");
        (open.aperture, open.conductance) = (0.05, 2.0);
        let error = tangent_error(&model, Trial::new(&state, &model.steps[0], 0.3, 0.2), &u, 1e-6);
        println!("{kind}, {more}: {error:.1e}");
        assert!(error < 1e-8, "{kind}, {more}: {error:.1e}");
    }
}

/// A column of height 0.5 under a load on its top, below another body that is apart from it by 0.1.
fn below_a_gap(kind: &str, load: f64, contact: Value) -> Value {
    let blocks = Blocks::default().rectangle("low", [2, 8], [0.0, 0.0], [0.25, 0.5]).rectangle(
        "high",
        [2, 2],
        [0.0, 0.6],
        [0.25, 1.0],
    );
    json!({
        "mesh": mesh(&blocks, kind), "bodies": {"low": soil(), "high": soil()}, "contacts": {"cut": contact},
        "steps": [{"name": "load", "duration": 0.125, "dt": {"initial": 0.000625}, "supports": [
            {"on": "low_bottom", "ux": 0, "uy": 0}, {"on": "low_left", "ux": 0}, {"on": "low_right", "ux": 0}, {"on": "high", "ux": 0, "uy": 0}],
            "loads": [{"on": "low_top", "dead_pressure": format!("{load}")}]}],
    })
}

/// Terzaghi (1943) at T = 0.5: surfaces that are apart drain, to air or to water that presses on them, as a side does where that pressure is prescribed. Their
/// outflow is the settlement, less what comes into the gap.
#[test]
fn surfaces_that_are_apart_are_drained() {
    for (load, outside) in [(0.1, 0.0), (0.1, 0.04), (-0.1, 0.0)] {
        let contact = json!({"slave": "high_bottom", "master": "low_top", "friction": {"law": "frictionless"}, "open_pressure": outside});
        let run = finish(&below_a_gap("q8", load, contact));
        let last = run.last();
        let found = -last.displacement[2 * run.nodes("low_top")[0] + 1] / 0.5;
        let p = pressure(&run, last, "low", [0.0, 0.0]);
        println!("load {load}, {outside}: settles by {found:.5}, p {p:.5}");
        close("settlement", found, 0.76395 * load, 3e-4);
        close("p at the base", p, outside + 0.37078 * load, 5e-4);
        close("outflow", last.water.outlets[0].volume, 0.0, 1e-6);
        balance(&run);
    }
}

/// Water of the pressure 0.03 at the base of a column that bears 0.01 lifts its upper half until what flows out between the halves leaves it the pressure of
/// the load: it flows up by (0.03 − 0.01)/½ per area, half of it through the upper half. In increments of any length it comes to that, and on the way
/// they come to one course: flow between the halves at t = 0.05 by increments of 1/20, 1/80, 1/320 and 1/1280.
#[test]
fn what_drains_regulates_an_opening() {
    let early = [0.05, 0.0125, 0.003125, 0.00078125].map(|dt| {
        let mut case = cut_column("q4", [4, 4], with(smooth(), &json!({"open_pressure": 0, "method": "mortar"})));
        case["steps"][0]["duration"] = json!(1);
        case["steps"][0]["dt"] = json!({"initial": dt});
        case["steps"][0]["loads"] = json!([{"on": "high_top", "dead_pressure": "0.01"}]);
        case["steps"][0]["drainage"] =
            json!([{"on": "high_top", "pressure": 0}, {"on": "low_bottom", "pressure": 0.03}]);
        case["newton"] = json!({"tolerance": 1e-10});
        let run = finish(&case);
        let last = run.last();
        close("p", pressure(&run, last, "low", [0.0, 0.5]), 0.01, 1e-5);
        let [between, above, below] = [0, 1, 2].map(|k| last.water.outlets[k].rate / 0.25);
        println!("{dt}: {between:.6} {above:.6} {below:.6}, {:?} iterations", run.iterations.iter().max());
        let flows = [(between, 0.02), (above, 0.02), (below, -0.04)];
        flows.iter().for_each(|(q, expected)| close("flow", *q, *expected, 2e-5));
        balance(&run);
        run.at(0.05).water.outlets[0].rate / 0.25
    });
    println!("{early:.5?}");
    let off = [0, 1, 2].map(|k| (early[k] / early[3] - 1.0).abs());
    assert!(off[1] < 0.3 * off[0] && off[2] < 0.01, "{early:?}");
}

/// Friction goes by what the water leaves: a slab on clay that is loaded at once slides under μ times what has been taken over so far.
#[test]
fn friction_grows_as_water_leaves() {
    let coulomb = json!({"slave": "high_bottom", "master": "low_top", "friction": {"law": "coulomb", "mu": 0.4}, "initial": {"pressure": 0.0}});
    let mut case = cut_column("q4", [6, 6], coulomb);
    let supports = json!([{"on": "low", "ux": 0}, {"on": "low_bottom", "uy": 0}, {"on": "high", "ux": {"rate": 0.01}}]);
    case["steps"][0]["supports"] = supports;
    case["steps"][0]["loads"] = json!([{"on": "high_top", "dead_pressure": "0.1"}]);
    let run = finish(&case);
    for state in run.states.iter().skip(20) {
        for point in &state.contacts[0] {
            close("q", point.friction.traction.abs(), 0.4 * point.friction.pressure, 1e-4);
        }
        // The surfaces slide off each other at the ends, and what still touches bears the load of 0.1 on a length of 0.25, but for its tilt.
        let borne: f64 =
            state.contacts[0].iter().map(|point| point.length * (point.friction.pressure + point.fluid)).sum();
        close("p + p_w", borne, 0.025, 1e-4);
    }
    let [early, late] = [run.states[20].contacts[0][0].fluid, run.last().contacts[0][0].fluid];
    assert!(early > 0.05 && late < 0.035, "{early}, {late}");
}

/// A wet block slides onto another: no water is lost as points come to face it, and as edges slide past nodes.
#[test]
fn no_water_is_lost_in_sliding() {
    let blocks = Blocks::default().rectangle("low", [8, 4], [0.0, 0.0], [1.0, 0.5]).rectangle(
        "high",
        [9, 4],
        [0.7, 0.5],
        [1.7, 1.0],
    );
    let body = json!({"material": {"model": "hencky", "E": 0.9, "nu": 0.2},
        "pore_fluid": {"bulk_modulus": 20, "porosity": 0.5, "permeability": 1, "unit_weight": 1}});
    for (kind, method) in [("q4", "mortar"), ("q8", "mortar"), ("q4", "node_to_segment")] {
        let case = json!({
            "mesh": mesh(&blocks, kind), "bodies": {"low": body, "high": body},
            "contacts": {"cut": {"slave": "high_bottom", "master": "low_top", "friction": {"law": "coulomb", "mu": 0.2}, "method": method}},
            "steps": [{"name": "slide", "duration": 0.25, "dt": {"initial": 0.01},
                "supports": [{"on": "low_bottom", "ux": 0, "uy": 0}, {"on": "high_top", "ux": {"rate": -1}, "uy": {"rate": -0.02}}],
                "drainage": [{"on": "low_right", "pressure": 0}]}],
        });
        let run = finish(&case);
        balance(&run);
        let closed = |state: &State| state.contacts[0].iter().filter(|point| point.is_closed()).count();
        assert!(closed(run.last()) >= closed(&run.states[1]) + 2, "{kind}, {method}: no points have come");
        assert!(run.last().water.outlets[0].volume > 1e-4, "{kind}, {method}: nothing is pressed out");
        let most = run.iterations.iter().max().expect("increments");
        println!("{kind}, {method}: {most} iterations at most");
        assert!(*most < 12, "{kind}, {method}: {most} iterations");
    }
}

/// Residuals of the iterations of every increment, and whether each has the tangent of the one before it.
#[derive(Default)]
struct Residuals(Vec<Vec<(f64, bool)>>);

impl Observer for Residuals {
    fn record(&mut self, _: &Model, attempt: &Attempt) -> Result<(), Error> {
        let each = attempt.iterations.iter().map(|iteration| &iteration.newton);
        self.0.push(each.map(|newton| (newton.residual, newton.factorized)).collect());
        Ok(())
    }
}

/// Newton's method converges with its square beside water, closed and sliding, and where surfaces part and drain: the best order of three residuals that
/// fall, in each increment that has so many above round-off.
#[test]
fn newtons_method_converges_with_its_square() {
    let mut sliding = cut_column(
        "q4",
        [4, 3],
        json!({"slave": "high_bottom", "master": "low_top", "friction": {"law": "coulomb", "mu": 0.4, "alpha_t": 1000},
        "normal": {"alpha_n": 1000}, "initial": {"pressure": 0.1}}),
    );
    sliding["steps"][0]["supports"] =
        json!([{"on": "low", "ux": 0}, {"on": "low_bottom", "uy": 0}, {"on": "high_top", "ux": {"rate": 0.1}}]);
    sliding["steps"][0]["loads"] = json!([{"on": "high_top", "dead_pressure": "0.2"}]);
    let mut lifted = cut_column("q4", [4, 4], with(smooth(), &json!({"open_pressure": 0})));
    lifted["steps"][0]["loads"] = json!([{"on": "high_top", "dead_pressure": "0.1"}]);
    lifted["steps"][0]["drainage"] = json!([{"on": "high_top", "pressure": 0}, {"on": "low_bottom", "pressure": 0.3}]);
    for (what, mut case) in [("sliding", sliding), ("lifted", lifted)] {
        for body in ["low", "high"] {
            case["bodies"][body]["material"] = json!({"model": "hencky", "E": 0.9, "nu": 0.2});
        }
        case["steps"][0]["dt"] = json!({"initial": 0.05});
        case["newton"] = json!({"tolerance": 1e-13, "max_iterations": 40});
        let mut model = model(&case);
        model.aids.old_tangents = false;
        let mut residuals = Residuals::default();
        run(&Arc::new(model), &mut [&mut residuals]).1.expect("it runs");
        let mut orders = Vec::new();
        for increment in &residuals.0 {
            let falls = |three: &&[(f64, bool)]| {
                three.iter().all(|one| one.1) && (3e-7..0.1 * three[0].0).contains(&three[1].0)
            };
            let order = |three: &[(f64, bool)]| (three[2].0 / three[1].0).ln() / (three[1].0 / three[0].0).ln();
            orders.extend(increment.windows(3).filter(falls).map(order).reduce(f64::max));
        }
        println!("{what}: {orders:.2?}");
        let slow = orders.iter().filter(|order| **order < 1.7).count();
        assert!(orders.len() >= 3 && slow <= 1, "{what}: {orders:.2?}");
    }
}

/// A run that was stopped goes on to the same bits.
#[test]
fn a_stopped_run_goes_on_to_the_same_bits() {
    let mut case = cut_column("q4", [4, 3], smooth());
    for body in ["low", "high"] {
        case["bodies"][body]["material"] = json!({"model": "hencky", "E": 0.9, "nu": 0.2});
    }
    case["steps"][0]["dt"] = json!({"initial": 0.05});
    case["steps"][0]["loads"] = json!([{"on": "high_top", "dead_pressure": "0.2"}]);
    let whole = finish(&case);
    let shared: Arc<Model> = model(&case).into();
    let mut run = Simulation::new(shared.clone());
    (0..4).for_each(|_| drop(run.next_increment().expect("it runs")));
    let bytes = run.save().bytes().expect("it can be written");
    let mut run = Simulation::resume(shared.clone(), Saved::from_bytes(&bytes, &shared).expect("it can be read"));
    while run.next_increment().expect("it runs").is_some() {}
    assert!(run.state() == whole.last(), "a resumed run has other bits");
}

/// Ground under hydrostatic water that is cut upright to its surface: by mortar the cut begins under the effective stress at each depth, which is none
/// at the surface, and nothing moves.
#[test]
fn a_cut_through_ground_below_water_rests() {
    let blocks = Blocks::default().rectangle("near", [2, 4], [-2.0, -3.0], [0.0, 0.0]).rectangle(
        "far",
        [2, 3],
        [0.0, -3.0],
        [2.0, 0.0],
    );
    let mut body = json!({"material": {"model": "linear", "E": 1000, "nu": 0.3, "density": 2}});
    body["pore_fluid"] = json!({"bulk_modulus": 1e5, "porosity": 0.4, "permeability": 0.01, "unit_weight": 10, "weighs": true, "pressure": "-10*y"});
    body["initial_stress"] = json!({"geostatic": {"surface": 0, "weight": 10, "K0": 0.5}});
    for kind in ["q4", "q8"] {
        let case = json!({
            "mesh": mesh(&blocks, kind), "bodies": {"near": body, "far": body},
            "contacts": {"cut": {"slave": "near_right", "master": "far_left", "method": "mortar", "friction": {"law": "coulomb", "mu": 0.3}, "initial": {"of_bodies": true}}},
            "steps": [{"name": "rest", "duration": 1, "dt": {"initial": 0.2}, "supports": [
                {"on": "near_bottom", "ux": 0, "uy": 0}, {"on": "near_left", "ux": 0}, {"on": "far_bottom", "ux": 0, "uy": 0}, {"on": "far_right", "ux": 0}],
                "loads": [{"on": "near", "gravity": {"y": "-10"}}, {"on": "far", "gravity": {"y": "-10"}}],
                "drainage": [{"on": "near_top", "head": 0}, {"on": "far_top", "head": 0}]}],
        });
        let run = finish(&case);
        let (pair, x) = (&run.model.contacts[0], run.model.mesh.undeformed());
        for (point, state) in pair.points.iter().zip(&run.states[0].contacts[0]) {
            close("p'", state.contact_pressure(), -5.0 * point.at(&x).y, 1e-6);
            close("p_w", state.fluid, -10.0 * point.at(&x).y, 1e-6);
        }
        let moved = run.last().displacement.iter().fold(0.0f64, |most, u| most.max(u.abs()));
        println!("{kind}: {moved:.1e}");
        assert!(moved < 1e-9, "{kind}: {moved:e}");
    }
}

/// Water flows through a tie; one side alone bears its water, and lets none pass; what makes no sense is refused.
#[test]
fn sides_of_every_kind() {
    let run = finish(&cut_column("q4", [6, 6], json!({"slave": "high_bottom", "master": "low_top", "tied": true})));
    for state in run.states.iter().filter(|state| state.time > 0.04) {
        let [below, above] = ["low", "high"].map(|body| pressure(&run, state, body, [0.0, 0.5]));
        close("no jump at a tie", below, above, 1e-3);
    }
    balance(&run);
    let mut dry = cut_column("q4", [4, 4], smooth());
    dry["bodies"]["low"].as_object_mut().expect("a body").remove("pore_fluid");
    let run = finish(&dry);
    let last = run.last();
    close("p of the wet side", last.contacts[0][0].fluid, pressure(&run, last, "high", [0.0, 0.5]), 1e-12);
    close("p + p_w", last.contacts[0][1].contact_pressure() + last.contacts[0][1].fluid, 1.0, 2e-3);
    dry["contacts"]["cut"]["seal"] = json!(1);
    let message = refusal(&dry);
    assert!(message.contains("contacts.cut.seal: is for a contact of two bodies whose water flows"), "{message}");
    let mut wrong = cut_column("q4", [2, 2], smooth());
    wrong["contacts"]["cut"]["seal"] = json!(-1);
    let message = refusal(&wrong);
    assert!(message.contains("contacts.cut.seal: is -1"), "{message}");
    wrong["contacts"]["cut"] = smooth();
    wrong["contacts"]["cut"]["open_pressure"] = json!(0);
    wrong["contacts"]["cut"]["fluid_pressure"] = json!(1);
    let message = refusal(&wrong);
    assert!(message.contains("contacts.cut.open_pressure: is for a contact of bodies whose water flows"), "{message}");
    let mut same = cut_column("q4", [2, 2], smooth());
    let mut cut = smooth();
    cut["open_pressure"] = json!(0);
    same["contacts"] = json!({"low_bottom": cut});
    same["steps"][0]["drainage"] = json!([{"on": "low_bottom", "pressure": 0}]);
    let message = refusal(&same);
    assert!(message.contains("contacts.low_bottom.open_pressure: drains under the name of a group"), "{message}");
}

/// By default the seal lets through a thousand times what the shortest element beside the contact does: pressures are nearly continuous there,
/// and all the more beside the longer ones.
#[test]
fn the_default_seal_goes_by_the_shortest_element() {
    let mut case = cut_column("q4", [2, 2], smooth());
    let side = |s: f64| if s < 0.6 { s / 3.0 } else { 0.2 + (s - 0.6) / 8.0 };
    case["mesh"] = Blocks::default()
        .block("low", [3, 2], |s, t| [side(s), 0.5 * t])
        .block("high", [3, 2], |s, t| [side(s), 0.5 + 0.5 * t])
        .json();
    let sizes: Vec<f64> = model(&case).flow.as_ref().expect("water").elements.iter().map(|wet| wet.size).collect();
    let [least, most] = [f64::min, f64::max].map(|of| sizes.iter().copied().reduce(of).expect("elements"));
    assert!(most > 1.5 * least, "{sizes:?}");
    let seam = model(&case).contacts[0].seam.as_ref().expect("it is sealed").conductance;
    close("κ", seam, 1e3 / least, 1e-9 * seam);
}
