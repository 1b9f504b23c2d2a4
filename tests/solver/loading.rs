//! Loading as machines do it: supports along inclined directions and normals, steps that end by a reaction, damping by step.

use std::sync::Arc;

use crate::common::{
    self, Blocks, Finished, close, distance, expression, finish, floor, linear, neo_hookean, run_through, turned,
};
use crate::terms::{arbitrary_displacement, moving, tangent_error};
use fecontact::equations::Trial;
use fecontact::laws::bulk::Material;
use fecontact::laws::friction::CoulombParameters;
use fecontact::model::boundary::{BodyTemperature, Drive, Expression};
use fecontact::model::builder::{Builder, Change, Contact, Load, LoadStep, MasterSide, Place, Support};
use fecontact::model::imposed::Thermal;
use fecontact::model::scheme::Scheme;
use fecontact::model::state::State;
use fecontact::model::step::ForceComponent;
use fecontact::model::{Damping, Model, NewtonSettings};
use fecontact::run::run;
use serde_json::json;

const TRAPEZOIDAL: Scheme = Scheme::Newmark { beta: 0.25, gamma: 0.5 };
const SCHEMES: [Scheme; 6] = [
    Scheme::Static,
    TRAPEZOIDAL,
    Scheme::Hht { alpha: -0.1 },
    Scheme::GeneralizedAlpha { rho_infinity: 0.6 },
    Scheme::Wilson { theta: 1.4 },
    Scheme::Explicit { safety: 0.9 },
];
const ANGLE: f64 = std::f64::consts::PI / 6.0;

fn material(soft: bool) -> Box<dyn Material> {
    if soft { neo_hookean(100.0, 0.3, 1.0) } else { linear(100.0, 0.3, 1.0) }
}

/// A block 2 × 1 of E = 100 and ρ = 1, turned about the origin.
fn block(angle: f64, soft: bool) -> Builder {
    let mesh = Blocks::default().rectangle("block", [4, 3], [0.0, 0.0], [2.0, 1.0]).turned(angle).mesh();
    Model::builder(mesh).body("block", material(soft)).newton(NewtonSettings { tolerance: 1e-12, max_iterations: 25 })
}

/// Largest difference of two runs, the first turned by [`ANGLE`], in displacements, velocities, reactions and energies, each
/// as a share of the largest.
#[track_caller]
fn turned_alike(what: &str, straight: &Finished, inclined: &Finished) {
    assert_eq!(straight.states.len(), inclined.states.len(), "{what}: increments");
    type Of = fn(&State) -> &Vec<f64>;
    let all: [(&str, Of); 3] =
        [("u", |state| &state.displacement), ("v", |state| &state.velocity), ("R", |state| &state.reaction)];
    for (name, of) in all {
        let states = || straight.states.iter().zip(&inclined.states);
        let largest = states().flat_map(|(a, _)| of(a)).fold(f64::MIN_POSITIVE, |most: f64, v| most.max(v.abs()));
        for (a, b) in states() {
            let a: Vec<f64> = of(a).chunks_exact(2).flat_map(|v| turned([v[0], v[1]], ANGLE)).collect();
            let apart = distance(&a, of(b)) / largest;
            assert!(apart < 1e-10, "{what}: {name} at {} is off by {apart:.1e}", b.time);
        }
    }
    for (a, b) in straight.states.iter().zip(&inclined.states) {
        let scale = a.energy.supplied().abs().max(1e-3);
        close(&format!("{what}: work"), b.energy.external_work, a.energy.external_work, 1e-9 * scale);
        close(&format!("{what}: error"), b.energy.error(), a.energy.error(), 1e-9 * scale);
    }
}

/// A direction that turns with the model, of another length and sense.
fn along(direction: [f64; 2]) -> [f64; 2] {
    turned(direction, ANGLE).map(|d| 2.5 * d)
}

/// The same with contact: the nodes of the side that slides on a turned plane are held along it themselves, so that linear
/// bodies cannot be condensed on them, or others are, so that they can.
#[test]
fn inclined_supports_and_contact_go_together() {
    for (scheme, soft, at_contact) in
        [Scheme::Static, TRAPEZOIDAL].into_iter().flat_map(|s| [(s, false, false), (s, false, true), (s, true, true)])
    {
        let model = |angle: f64| {
            let ground = MasterSide::Plane { point: [0.0, 0.0], normal: turned([0.0, 1.0], angle) };
            let friction = CoulombParameters { mu: 0.3, alpha_t: Some(2e3) };
            block(angle, soft).contact(Contact::new("base", "block_bottom", ground, friction).alpha_n(4e3))
        };
        let step = |name: &str| LoadStep::new(name, 0.5).scheme(scheme).dt(0.05);
        let held = if at_contact { "block_bottom" } else { "block_right" };
        let straight = model(0.0)
            .step(step("press").support(Support::on("block_top").uy(-0.02)).support(Support::on(held).ux(0.0)))
            .step(step("drag").support(Support::on(held).ux(Drive::Rate(0.2))));
        let x = along([1.0, 0.0]);
        let inclined = model(ANGLE)
            .step(step("press").support(Support::on("block_top").un(-0.02)).support(Support::on(held).along(x, 0.0)))
            .step(step("drag").support(Support::on(held).along(x, Drive::Rate(0.2))));
        let (straight, inclined) = (run_through(straight), run_through(inclined));
        let [_, friction] = straight.contact_force(straight.last());
        assert!(friction.abs() > 0.1, "it is dragged");
        turned_alike(&format!("{scheme:?}, soft {soft}, at the contact {at_contact}"), &straight, &inclined);
    }
}

/// A block on an inclined roller under a vertical force F: the roller puts F cos α on it along its normal, and the one node
/// that is held along the slope F sin α.
#[test]
fn an_inclined_roller_takes_what_is_normal_to_it() {
    let force = 3.0;
    for soft in [false, true] {
        let run = run_through(
            block(ANGLE, soft).step(
                LoadStep::new("load", 1.0)
                    .dt(0.5)
                    .support(Support::on("block_bottom").un(0.0))
                    .support(Support::on(Place::Node(15)).along(turned([1.0, 0.0], ANGLE), 0.0))
                    .load(Load::total_force("block_top", [0.0, -force])),
            ),
        );
        let state = run.last();
        let roller = run.reaction("block_bottom", state);
        let expected = turned([0.0, force * ANGLE.cos()], ANGLE);
        let held = turned([force * ANGLE.sin(), 0.0], ANGLE);
        for i in 0..2 {
            close("roller", roller[i], expected[i], 1e-10);
            close("held", state.reaction[30 + i], held[i], 1e-10);
        }
    }
}

/// Two nodes hold the block along the slope, and one is freed: its reaction fades over the static step, and the other takes what it
/// no longer holds, R₁(t) = F sin α − (1 − share) R₂.
#[test]
fn the_reaction_of_a_freed_inclined_support_fades() {
    let (force, slope) = (3.0, turned([1.0, 0.0], ANGLE));
    let other = || Support::on(Place::Node(15));
    let hold = LoadStep::new("hold", 1.0)
        .dt(0.25)
        .support(Support::on("block_bottom").un(0.0))
        .support(Support::on(Place::Node(0)).along(slope, 0.0))
        .support(other().along(slope, 0.0))
        .load(Load::total_force("block_top", [0.0, -force]));
    let run = run_through(
        block(ANGLE, true).step(hold).step(LoadStep::new("free", 1.0).support(other().along(slope, Change::End))),
    );
    let along =
        |node: usize, state: &State| state.reaction[2 * node] * slope[0] + state.reaction[2 * node + 1] * slope[1];
    let second = along(15, run.at(1.0));
    assert!(second > 0.1 * force, "it holds");
    for state in run.states.iter().filter(|state| state.time >= 1.0) {
        let left = (2.0 - state.time) * second;
        close("the other", along(0, state), force * ANGLE.sin() - left, 1e-9);
        close("freed", along(15, state), if state.time > 1.0 { 0.0 } else { second }, 1e-12);
    }
}

/// A ring whose inside is pushed out by δ along its normals and whose outside keeps its place: u = A r + B/r (Lamé), the same
/// all round and nothing along the circumference.
#[test]
fn the_normals_of_a_circle_are_radial() {
    let (a, b, delta) = (1.0, 2.0, 0.01);
    let mesh = Blocks::default().ring("ring", [48, 16], [a, b]).mesh();
    let step = LoadStep::new("push", 1.0)
        .dt(1.0)
        .support(Support::on("ring_inside").un(-delta))
        .support(Support::on("ring_outside").un(0.0))
        .support(Support::on(Place::Node(0)).uy(0.0));
    let run = run_through(Model::builder(mesh).body("ring", linear(100.0, 0.3, 0.0)).step(step));
    for (node, at) in run.model.mesh.nodes.iter().enumerate() {
        let u = &run.last().displacement[2 * node..2 * node + 2];
        let (r, n) = (at.norm(), at.normalize());
        let lame = delta * a * (b * b - r * r) / (r * (b * b - a * a));
        close("radial", u[0] * n.x + u[1] * n.y, lame, 5e-3 * delta);
        close("along", u[1] * n.x - u[0] * n.y, 0.0, 1e-10 * delta);
    }
}

/// A plate of which all nodes are one, led along a direction by an expression: every one of them says the same.
#[test]
fn a_plate_is_led_along_a_direction() {
    let direction = [1.0, -2.0];
    let step = LoadStep::new("move", 1.0)
        .dt(0.5)
        .support(Support::on("block_bottom").ux(0.0).uy(0.0))
        .support(Support::on("block_top").along(direction, expression("0.02*t^2")));
    let run = run_through(block(0.0, true).plate("block_top").step(step));
    for state in &run.states {
        let along = (state.displacement[30] - 2.0 * state.displacement[31]) / 5f64.sqrt();
        close("led", along, 0.02 * state.time.powi(2), 1e-15);
        let [x, y] = run.reaction("block_top", state);
        close("across", 2.0 * x + y, 0.0, 1e-9);
    }
}

/// Two directions at a node say where it goes: D u = ū; and a third that says the same may stand beside them.
#[test]
fn a_node_held_along_two_directions_goes_where_both_say() {
    let (d1, d2) = ([2.0, 1.0], [-0.3, 1.0]);
    let corner = || Support::on(Place::Node(0));
    let step = |more: Support| {
        LoadStep::new("move", 1.0)
            .dt(0.5)
            .support(Support::on("block_top").ux(0.0).uy(0.0))
            .support(corner().along(d1, 0.02))
            .support(more)
    };
    let run = run_through(block(0.0, true).step(step(corner().along(d2, -0.01))));
    let u = &run.last().displacement[..2];
    for (d, expected) in [(d1, 0.02), (d2, -0.01)] {
        let length = f64::hypot(d[0], d[1]);
        close("along", (u[0] * d[0] + u[1] * d[1]) / length, expected, 1e-14);
    }
    let straight = run_through(block(0.0, true).step(step(corner().uy(0.005))));
    let u = &straight.last().displacement[..2];
    close("uy", u[1], 0.005, 0.0);
    close("ux", u[0], (0.02 * 5f64.sqrt() - 0.005) / 2.0, 1e-14);
    // The same again along a third direction: u·(1, 1)/√2.
    let third = (u[0] + u[1]) / 2f64.sqrt();
    let again = step(corner().uy(0.005)).support(corner().along([1.0, 1.0], third));
    let again = run_through(block(0.0, true).step(again));
    assert_eq!(again.last().displacement, straight.last().displacement);
    assert_eq!(again.last().reaction, straight.last().reaction);
}

/// A disc whose bottom slides on a frictionless cone: what the cone puts on each node beside the axis is normal to it, and its
/// axial sum over the full turn is the force.
#[test]
fn a_disc_on_a_cone_is_carried_along_its_normal() {
    let slope: f64 = 0.2;
    let cone = [-slope.sin(), slope.cos()];
    let mesh = Blocks::default().block("disc", [4, 3], |s, t| [s, 0.5 * t + slope.tan() * s]);
    for hollow in [false, true] {
        let mut mesh = mesh.clone();
        if hollow {
            mesh.nodes.iter_mut().for_each(|node| node[0] += 0.5);
        }
        let run = finish(&json!({
            "section": "axisymmetric",
            "mesh": mesh.json(),
            "bodies": {"disc": {"material": {"model": "linear", "E": 100, "nu": 0.3}}},
            "steps": [{"name": "press", "duration": 1, "dt": {"initial": 1},
                       "supports": [{"on": "disc_bottom", "along": cone, "u": 0}],
                       "loads": [{"on": "disc_top", "total_force": {"y": -3}}]}]
        }));
        let state = run.last();
        close("axial force", run.reaction("disc_bottom", state)[1], 3.0, 1e-9);
        for node in run.nodes("disc_bottom") {
            let [x, y] = [state.reaction[2 * node], state.reaction[2 * node + 1]];
            if run.model.mesh.nodes[node].x > 0.0 {
                close("normal", x * cone[1] - y * cone[0], 0.0, 1e-12);
            } else {
                assert_eq!(state.displacement[2 * node..2 * node + 2], [0.0, 0.0], "on the axis");
            }
        }
    }
}

/// ∂r/∂u with supports that move along inclined directions, in schemes with blended forces, with dampers and viscous bodies.
#[test]
fn the_tangent_knows_inclined_supports() {
    for scheme in &SCHEMES[..5] {
        for soft in [false, true] {
            let dashpot = Load::dashpot("block_bottom", [0.7, 0.2]);
            let step = LoadStep::new("move", 1.0)
                .scheme(*scheme)
                .dt(0.1)
                .support(Support::on("block_bottom").un(expression("0.01*sin(3*t)")))
                .support(Support::on("block_left").along([1.0, -0.4], 0.02))
                .load(dashpot)
                .load(Load::absorbing("block_right"));
            let model = block(ANGLE, soft).damping("block", Damping { mass: 0.4, retardation: 0.02 }).step(step);
            let model = Arc::new(model.build().expect("a model"));
            let (state, u) = (moving(&model), arbitrary_displacement(&model, 1e-2));
            let error = tangent_error(&model, Trial::new(&state, &model.steps[0], 0.5, 0.1), &u, 1e-6);
            assert!(error < 1e-7, "{scheme:?}, soft {soft}: {error:.1e}");
        }
    }
}

fn told(builder: Builder) -> String {
    builder.build().err().map(|error| error.to_string()).unwrap_or_default()
}

#[test]
fn directions_that_agree_in_time_are_accepted_and_a_contradiction_has_its_instant() {
    let step = || LoadStep::new("load", 1.0).dt(0.5).support(Support::on("block_top").ux(0.0).uy(0.0));
    let corner = || Support::on(Place::Node(0));
    let three = |along: &str, ux: &str, uy: &str| {
        let (along, ux, uy) = (expression(along), expression(ux), expression(uy));
        step().support(corner().along([0.6, 0.8], along).ux(ux).uy(uy))
    };
    let twice = |text: &str| {
        step()
            .support(corner().along([1.0, 1.0], expression("0.1*t")))
            .support(corner().along([1.0, 1.0], expression(text)))
    };
    for agrees in [three("0*t", "0*t", "0*t"), three("0.11*t", "0.05*t", "0.1*t"), twice("t/10")] {
        assert_eq!(told(block(0.0, false).step(agrees)), "");
    }
    let later = told(block(0.0, false).step(three("0.11*t + max(0, t - 0.5)", "0.05*t", "0.1*t")));
    assert!(later.contains("contradictory values: at t = 0.51 two of them move it by 0.0561"), "{later}");
    let later = told(block(0.0, false).step(twice("0.1*t^2")));
    assert!(later.contains("contradicts what this step gives node 0 along the same direction"), "{later}");
}

#[test]
fn what_inclined_supports_cannot_say_is_refused() {
    let step = || LoadStep::new("load", 1.0).dt(0.5).support(Support::on("block_top").ux(0.0).uy(0.0));
    let bottom = || Support::on("block_bottom");
    let corner = || Support::on(Place::Node(0));
    for (model, words) in [
        (step().support(bottom().along([0.0, 0.0], 0.0)), "steps[0].supports[1].along: is [0, 0]: give a direction"),
        (
            step().support(corner().un(0.0)),
            "steps[0].supports[1].un: node 0 has no side and no normal: name a group of edges",
        ),
        (
            step().support(corner().along([1.0, 1.0], 0.1)).support(corner().along([-2.0, -2.0], 0.1)),
            "steps[0].supports[2].u: contradicts what this step gives node 0 along the same direction",
        ),
        (
            step().support(corner().along([1.0, 1.0], 0.1).ux(0.0).uy(0.1)),
            "steps[0].supports: node 0 is constrained along three directions with contradictory values",
        ),
        (
            step().support(corner().along([1.0, 0.1], 0.0).ux(0.0)),
            "steps[0].supports: node 0 is constrained along two directions that differ by 5.71",
        ),
        (
            step().support(corner().rotation([0.0, 0.0], 0.1)).support(corner().along([1.0, 1.0], 0.0)),
            "steps[0].supports: node 0 is prescribed by a rotation and constrained along another direction",
        ),
        (
            step().support(corner().along([1.0, 1.0], Change::End)),
            "steps[0].supports[1].u: null ends what an earlier step gave, but none gave node 0 a support along",
        ),
        (
            step().support(bottom().un(0.0).rotation([0.0, 0.0], 0.1)),
            "steps[0].supports[1]: gives rotation and un: a rotation prescribes both directions",
        ),
        (step().support(bottom().un(expression("log(x-5)"))), "steps[0].supports[1].un: has no finite value at t ="),
    ] {
        let told = told(block(0.0, false).step(model));
        assert!(told.starts_with(words), "`{words}` is not in `{told}`");
    }
}

/// A linear block of the stiffness k pressed at the rate v: the step ends at t = F/(k v) with F, and the next one, which draws
/// back as fast, begins there and ends at F' = F − k v t'. What was to come to a value stays in between.
#[test]
fn a_step_ends_when_a_reaction_has_its_value() {
    let press = |step: LoadStep| {
        step.support(Support::on("block_bottom").ux(0.0).uy(0.0)).support(Support::on("block_top").ux(0.0).uy(-0.1))
    };
    let whole = run_through(block(0.0, false).step(press(LoadStep::new("press", 1.0).dt(1.0))));
    let full = whole.reaction("block_top", whole.last())[1];
    for (dt, share) in [(1.0, 0.4), (0.03, 0.77)] {
        let value = share * full;
        let run = run_through(
            block(0.0, false)
                .step(press(LoadStep::new("press", 1.0).dt(dt).until("block_top", ForceComponent::Y, value)))
                .step(LoadStep::new("hold", 0.25))
                .step(LoadStep::new("back", 2.0).support(Support::on("block_top").uy(Drive::Rate(0.1))).until(
                    "block_bottom",
                    ForceComponent::Magnitude,
                    0.5 * -value,
                ))
                .step(LoadStep::new("rest", 1.0).support(Support::on("block_top").uy(Drive::Rate(0.0)))),
        );
        let force = |time: f64| run.reaction("block_top", run.at(time))[1];
        close("met", force(share), value, 1e-6 * value.abs());
        close("held", force(share + 0.25), value, 1e-6 * value.abs());
        let half = share + 0.25 + 0.5 * share;
        close("half", force(half), 0.5 * value, 1e-6 * value.abs());
        close("end", run.last().time, half + 1.0, 1e-6);
        close("rests", run.reaction("block_top", run.last())[1], 0.5 * value, 1e-6 * value.abs());
    }
}

/// A block that slides: until friction has 90 % of μ N; and what never comes stops the run and is told.
#[test]
fn a_reaction_that_is_not_reached_stops_the_run() {
    let model = |fx: f64| {
        let friction = CoulombParameters { mu: 0.3, alpha_t: Some(2e3) };
        block(0.0, true)
            .contact(Contact::new("base", "block_bottom", floor(), friction).alpha_n(4e3))
            .step(LoadStep::new("press", 1.0).dt(0.5).support(Support::on("block_top").ux(0.0).uy(-0.02)))
            .step(LoadStep::new("drag", 1.0).dt(0.25).support(Support::on("block_top").ux(Drive::Rate(0.05))).until(
                "block_top",
                ForceComponent::X,
                fx,
            ))
            .step(LoadStep::new("stay", 0.5).support(Support::on("block_top").ux(Drive::Rate(0.0))))
    };
    let never = Arc::new(model(1e3).build().expect("a model"));
    let mut record = common::Record::default();
    let (_, result) = run(&never, &mut [&mut record]);
    let [x, y] = record
        .states
        .last()
        .expect("states")
        .reaction
        .chunks_exact(2)
        .skip(15)
        .fold([0.0; 2], |[x, y], r| [x + r[0], y + r[1]]);
    let told = result.expect_err("it is not reached").to_string();
    let words = format!("step `drag` ended at time 2 before fx of `block_top` reached 1000: it is {x:.6e};");
    assert!(told.starts_with(&words), "`{words}` is not in `{told}`");
    close("slides", x, 0.3 * -y, 1e-2);
    let value = 0.9 * x;
    let run = run_through(model(value));
    let states: Vec<&State> = run.states.iter().filter(|state| state.time > 1.0).collect();
    let met = states.iter().position(|state| (run.reaction("block_top", state)[0] - value).abs() <= 1e-6 * value);
    assert!(states[met.expect("it is met")].time < 1.9, "before its time");
    close("two steps later", run.last().time, states[met.expect("met")].time + 0.5, 1e-12);
}

/// A reaction that jumps past the value ends the step behind the jump, and the user is told.
#[test]
fn a_jump_past_the_value_is_told() {
    let jump = Drive::Table(vec![[0.0, 0.0], [0.5, -0.01], [0.5 + 1e-11, -0.03], [1.0, -0.03]]);
    let step = LoadStep::new("press", 1.0)
        .dt(0.25)
        .support(Support::on("block_bottom").ux(0.0).uy(0.0))
        .support(Support::on("block_top").ux(0.0).uy(jump))
        .until("block_top", ForceComponent::Y, -3.0);
    let model = Arc::new(block(0.0, false).step(step).build().expect("a model"));
    let mut warnings = fecontact::output::warnings::Warnings::default();
    let (_, result) = run(&model, &mut [&mut warnings]);
    close("ends at the jump", result.expect("it ends").time, 0.5, 1e-8);
    let told = warnings.list.join("\n");
    assert!(told.contains("step `press`, t = 0.5") && told.contains("past -3, where the step ends"), "{told}");
}

#[test]
fn what_a_step_cannot_end_by_is_refused() {
    let step = || {
        LoadStep::new("load", 1.0)
            .dt(0.5)
            .support(Support::on("block_bottom").ux(0.0).uy(0.0))
            .support(Support::on("block_top").uy(-0.1))
    };
    let on_top = || step().until("block_top", ForceComponent::Y, -1.0);
    for (step, words) in [
        (step().until("top", ForceComponent::Y, -1.0), "steps[0].until.on: the mesh has no group `top`"),
        (
            step().until("block_top", ForceComponent::X, -1.0),
            "steps[0].until.on: block_top has no support along x in this step",
        ),
        (
            step().until("block_right", ForceComponent::Magnitude, f64::NAN),
            "steps[0].until.force: is NaN: must be zero or positive",
        ),
        (on_top().scheme(Scheme::Explicit { safety: 0.9 }), "steps[0].until: ends static and implicit steps only"),
        (on_top().stabilize(1e-3), "steps[0].until: may end the step early, and what fades over the step"),
        (
            on_top().load(Load::total_force("block_top", [1.0, 0.0])),
            "steps[0].until: may end the step early, before a load, driver or rotation given as a number",
        ),
        (
            step().damping("blok", Damping::default()),
            "steps[0].damping.blok: there is no body `blok`; the bodies are block",
        ),
        (
            step().damping("block", Damping { mass: -1.0, retardation: 0.0 }),
            "steps[0].damping.block.mass: is -1: must be zero or positive",
        ),
    ] {
        let told = told(block(0.0, false).step(step));
        assert!(told.starts_with(words), "`{words}` is not in `{told}`");
    }
}

/// A block of ν = 0 held between its ends presses them with E α ΔT = 10 ΔT on its width of 2, ΔT = 0.4 t of a rate, say:
/// −2 at t = 0.5. The step after it goes on warming, to −6 at t = 1.5; a temperature of the step before stays.
#[test]
fn what_warms_by_the_time_of_the_run_may_end_a_step() {
    let block = || {
        Model::builder(Blocks::default().rectangle("block", [4, 3], [0.0, 0.0], [2.0, 1.0]).mesh())
            .body("block", linear(100.0, 0.0, 1.0))
            .thermal("block", Thermal { expansion: 0.05, reference: 0.0 })
    };
    let held = || LoadStep::new("warm", 1.0).dt(0.3).fix("block_bottom").support(Support::on("block_top").uy(0.0));
    let growing = BodyTemperature::Expression(Expression::parse("0.4 * t").unwrap());
    for warmth in [BodyTemperature::Rate(0.4), growing, BodyTemperature::Table(vec![[0.0, 0.0], [2.0, 0.8]])] {
        let warm = held().temperature("block", warmth).until("block_top", ForceComponent::Y, -2.0);
        let run = run_through(block().step(warm).step(LoadStep::new("on", 1.0)));
        close("met", run.reaction("block_top", run.at(0.5))[1], -2.0, 2e-6);
        close("goes on", run.reaction("block_top", run.last())[1], -6.0, 1e-5);
        close("end", run.last().time, 1.5, 1e-6);
    }
    // After −4 of a temperature, −6 by pressing: k = E A/L = 200.
    let press = Support::on("block_top").uy(Drive::Rate(-0.02));
    let press = LoadStep::new("press", 1.0).support(press).until("block_top", ForceComponent::Y, -6.0);
    let run = run_through(block().step(held().temperature("block", 0.4)).step(press));
    close("pressed", run.reaction("block_top", run.last())[1], -6.0, 6e-6);
    close("so long", run.last().time, 1.5, 1e-6);
    for given in [BodyTemperature::Constant(0.4), BodyTemperature::X(vec![[0.0, 0.2], [2.0, 0.4]])] {
        let warm = held().temperature("block", given).until("block_top", ForceComponent::Y, -2.0);
        let told = told(block().step(warm));
        let words = "steps[0].until: may end the step early, before the temperature of `block`, given as a number or \
                     by place, is fully applied: give it in the step before, or as a rate";
        assert!(told.starts_with(words), "{told}");
    }
}

/// An overlap is brought in over the whole of the first step; a later one may end by a reaction.
#[test]
fn a_shrink_fit_is_not_cut_short() {
    let model = |first: LoadStep| {
        let fit = Contact::new("fit", "block_bottom", floor(), CoulombParameters::new(0.3)).alpha_n(4e3);
        let mesh = Blocks::default().rectangle("block", [4, 3], [0.0, -0.01], [2.0, 1.0]).mesh();
        let draw = Support::on("block_top").uy(Drive::Rate(-0.01));
        Model::builder(mesh)
            .body("block", linear(100.0, 0.0, 1.0))
            .contact(Contact { shrink_fit: true, ..fit })
            .step(first.dt(0.5).support(Support::on("block_top").ux(0.0).uy(0.0)))
            .step(LoadStep::new("press", 1.0).support(draw).until("block_top", ForceComponent::Y, -2.5))
    };
    let fit = || LoadStep::new("fit", 1.0);
    let told = told(model(fit().until("block_top", ForceComponent::Y, -1.0)));
    let words = "steps[0].until: may end the step early, before the overlap of `fit`, brought in over the first step";
    assert!(told.starts_with(words), "{told}");
    let run = run_through(model(fit()));
    close("pressed", run.reaction("block_top", run.last())[1], -2.5, 2.5e-6);
}

/// A block that flies and is damped by its mass in the second of three steps: v (1 + ½ η Δt) = v₀ (1 − ½ η Δt) in each of its
/// increments by the trapezoidal rule.
#[test]
fn damping_begins_and_ends_with_a_step() {
    let (eta, dt) = (3.0, 0.05);
    let step = |name: &str| LoadStep::new(name, 0.5).scheme(TRAPEZOIDAL).dt(dt);
    let run = run_through(
        block(0.0, true)
            .initial_velocity("block", [0.4, -0.2])
            .step(step("first"))
            .step(step("second").damping("block", Damping { mass: eta, retardation: 0.0 }))
            .step(step("third").damping("block", Damping::default())),
    );
    let factor = (1.0 - 0.5 * eta * dt) / (1.0 + 0.5 * eta * dt);
    for state in &run.states {
        let increments = ((state.time.min(1.0) - 0.5) / dt).round().max(0.0) as i32;
        for node in 0..run.model.mesh.nodes.len() {
            close("vx", state.velocity[2 * node], 0.4 * factor.powi(increments), 1e-10);
            close("vy", state.velocity[2 * node + 1], -0.2 * factor.powi(increments), 1e-10);
        }
    }
    close("energy", run.last().energy.error(), 0.0, 1e-3 * run.states[0].energy.kinetic);
}

/// Damping given to the body or to its only step is the same to the bits, and so is none of either.
#[test]
fn damping_of_a_step_is_that_of_the_body() {
    let damping = Damping { mass: 0.3, retardation: 2e-3 };
    for (scheme, soft) in SCHEMES[1..].iter().flat_map(|scheme| [(*scheme, false), (*scheme, true)]) {
        let step = || {
            LoadStep::new("pull", 0.3)
                .scheme(scheme)
                .dt(0.02)
                .support(Support::on("block_bottom").ux(0.0).uy(0.0))
                .load(Load::traction("block_right", [expression("2"), expression("0")]))
        };
        let states = |builder: Builder| run_through(builder).states;
        let of_body = states(block(0.0, soft).damping("block", damping).step(step()));
        let of_step = states(block(0.0, soft).step(step().damping("block", damping)));
        let ended =
            states(block(0.0, soft).damping("block", damping).step(step().damping("block", Damping::default())));
        let none = states(block(0.0, soft).step(step()));
        assert!(of_body == of_step, "{scheme:?}, soft {soft}: damped");
        assert!(ended == none, "{scheme:?}, soft {soft}: not damped");
        assert!(of_body.last().map(|s| &s.velocity) != none.last().map(|s| &s.velocity), "damping shows");
    }
}

/// A cylinder is pressed between platens that are given by normal displacements: uniform stress E ε, on quadratic sides too, whose
/// corners on the axis have no area (∫ N r dr = 0).
#[test]
fn normals_of_rings_are_right_on_the_axis() {
    for kind in ["Q4", "Q8", "T6"] {
        let run = finish(&json!({
            "section": "axisymmetric",
            "mesh": {"blocks": [{"body": "rod", "corners": [[0, 0], [1, 0], [1, 1], [0, 1]], "elements": [3, 3], "kind": kind,
                                 "sides": ["bottom", null, "top", null]}]},
            "bodies": {"rod": {"material": {"model": "linear", "E": 1000, "nu": 0.3}}},
            "steps": [{"name": "press", "duration": 1, "dt": {"initial": 1},
                       "supports": [{"on": "bottom", "un": 0}, {"on": "top", "un": -0.01}]}]
        }));
        for node in run.nodes("top") {
            close(&format!("{kind}: u_y"), run.last().displacement[2 * node + 1], -0.01, 1e-12);
        }
        let force = 1000.0 * 0.01 * std::f64::consts::PI;
        close(&format!("{kind}: force"), run.reaction("top", run.last())[1], -force, 1e-9 * force);
    }
}

/// A pressure that varies along an edge pulls on its nodes as the same dead pressure does, whatever the mesh: p = x on one edge of length 2
/// makes the moment ∫ x² dx = 8/3 about its end.
#[test]
fn a_pressure_varies_along_an_edge() {
    let moment = |kind: &str, load: &str| {
        let run = finish(&json!({
            "mesh": {"blocks": [{"body": "block", "corners": [[0, 0], [2, 0], [2, 1], [0, 1]], "elements": [1, 1], "kind": kind,
                                 "sides": ["bottom", null, "top", null]}]},
            "bodies": {"block": {"material": {"model": "linear", "E": 1e9, "nu": 0}}},
            "steps": [{"name": "press", "duration": 1, "dt": {"initial": 1},
                       "supports": [{"on": "bottom", "ux": 0, "uy": 0}], "loads": [{"on": "top", load: "x"}]}]
        }));
        run.nodes("bottom").into_iter().map(|a| run.model.mesh.nodes[a].x * run.last().reaction[2 * a + 1]).sum::<f64>()
    };
    for kind in ["Q4", "Q8", "T6"] {
        for load in ["pressure", "dead_pressure"] {
            close(&format!("{kind}, {load}"), moment(kind, load), 8.0 / 3.0, 1e-6);
        }
    }
}
