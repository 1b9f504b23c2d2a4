//! Loading as machines do it: supports along inclined directions and normals, steps that end by a reaction, damping by step.

mod endings;

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
use fecontact::model::{Damping, ForceComponent, Model, NewtonSettings, Scheme, State, Thermal};
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

fn message(builder: Builder) -> String {
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
        assert_eq!(message(block(0.0, false).step(agrees)), "");
    }
    let later = message(block(0.0, false).step(three("0.11*t + max(0, t - 0.5)", "0.05*t", "0.1*t")));
    assert!(later.contains("contradictory values: at t = 0.51 two of them move it by 0.0561"), "{later}");
    let later = message(block(0.0, false).step(twice("0.1*t^2")));
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
        let message = message(block(0.0, false).step(model));
        assert!(message.starts_with(words), "`{words}` is not in `{message}`");
    }
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
