//! Plates that turn, and those of which one component is alike, in motion: all schemes against the mechanics of rigid bodies.

use std::sync::Arc;

use crate::common::{Blocks, Finished, close, distance, expression, neo_hookean, run_through};
use crate::terms::{arbitrary_displacement, moving, tangent_error};
use fecontact::equations::Trial;
use fecontact::model::builder::{Builder, Load, LoadStep, Place, Plate, Support};
use fecontact::model::{Damping, Model, NewtonSettings, Scheme, State};
use nalgebra::{Rotation2, Vector2};

const TRAPEZOIDAL: Scheme = Scheme::Newmark { beta: 0.25, gamma: 0.5 };
const HHT: Scheme = Scheme::Hht { alpha: -0.1 };
const ALPHA: Scheme = Scheme::GeneralizedAlpha { rho_infinity: 0.6 };
const WILSON: Scheme = Scheme::Wilson { theta: 1.4 };
const EXPLICIT: Scheme = Scheme::Explicit { safety: 0.9 };
const SCHEMES: [Scheme; 5] = [TRAPEZOIDAL, HHT, ALPHA, WILSON, EXPLICIT];

/// A block 2 × 1 of E = 100 and ρ = 2, turned by an angle; its top has the nodes 15 to 19.
fn block(angle: f64) -> Builder {
    let mesh = Blocks::default().rectangle("block", [4, 3], [0.0, 0.0], [2.0, 1.0]).turned(angle).mesh();
    Model::builder(mesh)
        .body("block", neo_hookean(100.0, 0.3, 2.0))
        .newton(NewtonSettings { tolerance: 1e-12, max_iterations: 40 })
}

fn rigid() -> Builder {
    block(0.0).plate_moving("block", Plate::Rigid)
}

/// The block 2 × 1 as a rigid body: m, and J about its middle. Explicit masses lie at the nodes.
fn masses(model: &Model, scheme: Scheme) -> (f64, f64) {
    if !matches!(scheme, Scheme::Explicit { .. }) {
        return (4.0, 4.0 * 5.0 / 12.0);
    }
    let middle = Vector2::new(1.0, 0.5);
    model.mesh.elements.iter().enumerate().fold((0.0, 0.0), |sum, (e, element)| {
        let masses = model.element_lumped_mass(e);
        element
            .nodes
            .iter()
            .zip(&masses)
            .fold(sum, |(m, j), (&node, mass)| (m + mass, j + mass * (model.mesh.nodes[node] - middle).norm_squared()))
    })
}

/// Σ m v of all nodes, in which the center of mass moves.
fn momentum(run: &Finished, state: &State) -> [f64; 2] {
    let mut sum = [0.0; 2];
    for (e, element) in run.model.mesh.elements.iter().enumerate() {
        for (node, mass) in element.nodes.iter().zip(&run.model.element_lumped_mass(e)) {
            (0..2).for_each(|i| sum[i] += mass * state.velocity[2 * node + i]);
        }
    }
    sum
}

/// Places of all nodes of a body turned by θ about a point.
fn check_turned(what: &str, run: &Finished, state: &State, (about, angle): ([f64; 2], f64), allowed: f64) {
    let about = Vector2::from(about);
    for (node, at) in run.model.mesh.nodes.iter().enumerate() {
        let expected = Rotation2::new(angle) * (at - about) - (at - about);
        (0..2).for_each(|i| close(what, state.displacement[2 * node + i], expected[i], allowed));
    }
}

/// A free rigid body under a constant moment: θ = ½ M/J t² about its middle, which stays where it is, in all schemes; and what the
/// moment gives is ½ J ω².
#[test]
fn a_free_rigid_body_turns_by_its_moment_of_inertia() {
    let m = 5.0;
    for scheme in SCHEMES {
        let step = LoadStep::new("turn", 1.0).scheme(scheme).dt(0.02).load(Load::moment("block", expression("5")));
        let run = run_through(rigid().step(step));
        let (_, inertia) = masses(&run.model, scheme);
        for state in &run.states {
            let angle = 0.5 * m / inertia * state.time.powi(2);
            check_turned(&format!("{scheme:?}"), &run, state, ([1.0, 0.5], angle), 1e-10);
            let momentum = momentum(&run, state);
            (0..2).for_each(|i| close("momentum", momentum[i], 0.0, 1e-11));
            close("kinetic", state.energy.kinetic, 0.5 * (m * state.time).powi(2) / inertia, 1e-3 * (m * m / inertia));
            close("energy", state.energy.error(), 0.0, 1e-3 * (m * m / inertia));
        }
        close("strain", run.last().energy.strain, 0.0, 1e-15);
    }
}

/// θ and ω of a body that swings on a hinge at its corner under g: J_A θ̈ = −m g (c_x cos θ − c_y sin θ), by Runge and Kutta.
fn pendulum((m, j): (f64, f64), g: f64, time: f64) -> [f64; 2] {
    let (cx, cy) = (1.0, 0.5);
    let about = j + m * (cx * cx + cy * cy);
    let rate = |[angle, spin]: [f64; 2]| [spin, -m * g * (cx * angle.cos() - cy * angle.sin()) / about];
    let count = 4000;
    let dt = time / f64::from(count);
    (0..count).fold([0.0; 2], |y, _| {
        let to = |k: [f64; 2], share: f64| [y[0] + share * dt * k[0], y[1] + share * dt * k[1]];
        let k1 = rate(y);
        let k2 = rate(to(k1, 0.5));
        let k3 = rate(to(k2, 0.5));
        let k4 = rate(to(k3, 1.0));
        [0, 1].map(|i| y[i] + dt / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
    })
}

/// A rigid body falls about a hinge far from linear: every scheme is of second order, and the hinge holds m (a_C − g).
#[test]
fn a_rigid_body_swings_as_a_pendulum() {
    let g = 6.0;
    for scheme in SCHEMES {
        let error = |dt: f64| {
            let step = LoadStep::new("swing", 1.5)
                .scheme(scheme)
                .dt(dt)
                .support(Support::on(Place::Node(0)).ux(0.0).uy(0.0))
                .load(Load::gravity("block", [expression("0"), expression("-6")]));
            let run = run_through(rigid().step(step));
            let state = run.last();
            let body = masses(&run.model, scheme);
            let [angle, spin] = pendulum(body, g, 1.5);
            let e = Vector2::new(2.0 + state.displacement[38], 1.0 + state.displacement[39]);
            close("rigid", e.norm(), 5f64.sqrt(), 1e-11);
            check_turned(
                "as one",
                &run,
                state,
                ([0.0; 2], Vector2::new(2.0, 1.0).perp(&e).atan2(Vector2::new(2.0, 1.0).dot(&e))),
                1e-10,
            );
            let c = Rotation2::new(angle) * Vector2::new(1.0, 0.5);
            let (m, j) = body;
            let angular = -m * g * c.x / (j + 1.25 * m);
            let pull = [-angular * c.y - spin * spin * c.x, angular * c.x - spin * spin * c.y + g].map(|a| m * a);
            let hinge = (0..2).map(|i| (state.reaction[i] - pull[i]).abs() / (m * g)).fold(0.0, f64::max);
            close("energy", state.energy.error(), 0.0, 10.0 * dt * dt * m * g);
            let off = (Rotation2::new(angle) * Vector2::new(2.0, 1.0) - e).norm();
            [off, hinge]
        };
        // Explicit increments are equal parts of the time between outputs.
        let longest = if scheme == EXPLICIT { 0.0075 } else { 0.01 };
        let [coarse, fine] = [longest, 0.5 * longest].map(error);
        for (what, coarse, fine) in [("angle", coarse[0], fine[0]), ("hinge", coarse[1], fine[1])] {
            assert!(coarse < 2e-2, "{scheme:?}: {what} is off by {coarse:.1e}");
            // HHT and its kin have the accelerations, and so the hinge's force, of another time.
            let (order, least) = ((coarse / fine).log2(), if what == "hinge" { 0.8 } else { 1.8 });
            assert!(order > least, "{scheme:?}: {what} {coarse:.2e} to {fine:.2e}");
        }
    }
}

/// On a hinge against a dashpot c at r, a moment M turns a body with ω = M/(c r²) (1 − exp(−c r² t/J)).
#[test]
fn a_dashpot_slows_what_turns() {
    let (c, square, m) = (0.8, 5.0, 6.0);
    for scheme in SCHEMES {
        let error = |dt: f64| {
            let step = LoadStep::new("turn", 2.0)
                .scheme(scheme)
                .dt(dt)
                .support(Support::on(Place::Node(0)).ux(0.0).uy(0.0))
                .load(Load::dashpot(Place::Node(19), [c, c]))
                .load(Load::moment("block", expression("6")));
            let run = run_through(rigid().step(step));
            let (mass, j) = masses(&run.model, scheme);
            let about = j + 1.25 * mass;
            let state = run.last();
            let speed = state.velocity[38].hypot(state.velocity[39]);
            let spin = m / (c * square) * (1.0 - (-c * square * 2.0 / about).exp());
            let stored = 0.5 * about * spin * spin;
            close(&format!("{scheme:?}: kinetic"), state.energy.kinetic, stored, 0.01 * stored);
            close(&format!("{scheme:?}: energy"), state.energy.error(), 0.0, 0.01 * stored);
            (speed / square.sqrt() / spin - 1.0).abs()
        };
        // Explicit increments are short already.
        let longest = if scheme == EXPLICIT { 0.01 } else { 0.04 };
        let [coarse, fine] = [longest, 0.5 * longest].map(error);
        assert!(coarse < 2e-3 && coarse > 3.0 * fine, "{scheme:?}: {coarse:.1e}, {fine:.1e}");
    }
}

/// A soft block with a rigid side under a force and a moment: Σ m v = F t to the last digit, moments make a moment of momentum, and
/// the energy audit is closed.
#[test]
fn a_rigid_side_keeps_momentum() {
    for scheme in SCHEMES {
        let step = LoadStep::new("fly", 1.0)
            .scheme(scheme)
            .dt(0.005)
            .load(Load::total_force("block_top", [expression("0.6"), expression("-0.3")]))
            .load(Load::moment("block_top", expression("3")));
        let run = run_through(block(0.0).plate_moving("block_top", Plate::Rigid).step(step));
        let what = format!("{scheme:?}");
        // Wilson's equilibrium lies beyond the increment.
        let allowed = if scheme == WILSON { 1e-3 } else { 1e-9 };
        for state in &run.states {
            let momentum = momentum(&run, state);
            close(&what, momentum[0], 0.6 * state.time, allowed);
            close(&what, momentum[1], -0.3 * state.time, allowed);
            let x = run.model.configuration(&state.displacement);
            close("rigid", (x.at(19) - x.at(15)).norm(), 2.0, 1e-11);
            close("rigid", ((x.at(16) + x.at(18)) / 2.0 - x.at(17)).norm(), 0.0, 1e-11);
        }
        let energy = &run.last().energy;
        assert!(energy.strain > 0.01, "{what}: {}", energy.strain);
        close(&what, energy.error(), 0.0, 2e-3 * energy.kinetic);
    }
}

/// A block on its held bottom, its rigid top struck by a moment and a force.
fn struck(scheme: Scheme, dt: f64) -> Finished {
    let step = LoadStep::new("strike", 1.0)
        .scheme(scheme)
        .dt(dt)
        .fix("block_bottom")
        .load(Load::total_force("block_top", ["1", "-2"].map(expression)))
        .load(Load::moment("block_top", expression("3")));
    let damping = Damping { mass: 0.3, retardation: 0.01 };
    run_through(block(0.0).damping("block", damping).plate_moving("block_top", Plate::Rigid).step(step))
}

/// Explicit and implicit increments agree up to where masses lie.
#[test]
fn a_rigid_side_moves_alike_in_all_schemes() {
    let explicit = struck(EXPLICIT, 0.01);
    let size = explicit.last().displacement.iter().fold(0.0f64, |most, u| most.max(u.abs()));
    assert!(size > 0.02, "{size}");
    for scheme in [TRAPEZOIDAL, HHT] {
        let run = struck(scheme, 0.005);
        close(
            &format!("{scheme:?}"),
            distance(&run.last().displacement, &explicit.last().displacement),
            0.0,
            0.05 * size,
        );
        if scheme == TRAPEZOIDAL {
            close("energy", run.last().energy.error(), 0.0, 2e-3 * run.last().energy.supplied());
        }
    }
    close("energy, explicitly", explicit.last().energy.error(), 0.0, 2e-3 * explicit.last().energy.supplied());
}

/// Explicitly, a plate alike in one component that supports lead moves as if all its nodes were led, with the same force; a free one
/// has the momentum of its force.
#[test]
fn a_plate_alike_in_one_component_moves_explicitly() {
    let damping = Damping { mass: 0.3, retardation: 0.01 };
    let plain = || block(0.0).damping("block", damping);
    let plate = || plain().plate_moving("block_top", Plate::UyAlike);
    let step = || LoadStep::new("move", 0.5).scheme(EXPLICIT).dt(0.01);
    let lead = || {
        step()
            .support(Support::on("block_bottom").uy(0.0))
            .support(Support::on("block_top").uy(expression("-0.1*t^2")))
            .load(Load::dashpot(Place::Node(17), [0.4, 0.0]))
    };
    let (led, plain) = (run_through(plate().step(lead())), run_through(plain().step(lead())));
    let (a, b) = (led.last(), plain.last());
    close("u", distance(&a.displacement, &b.displacement), 0.0, 1e-12);
    close("v", distance(&a.velocity, &b.velocity), 0.0, 1e-11);
    close("R", led.reaction("block_top", a)[1], plain.reaction("block_top", b)[1], 1e-9);
    close("energy", a.energy.damping_dissipation, b.energy.damping_dissipation, 1e-12);
    let force = Load::total_force("block_top", [expression("0"), expression("-0.8")]);
    let free = block(0.0).plate_moving("block_top", Plate::UyAlike).step(step().load(force));
    let free = run_through(free);
    let state = free.last();
    close("momentum", momentum(&free, state)[1], -0.8 * state.time, 1e-10);
    (15..20).for_each(|n| close("level", state.displacement[2 * n + 1], state.displacement[31], 1e-15));
    assert!((state.displacement[38] - state.displacement[30]).abs() > 1e-5, "it widens");
    close("energy", state.energy.error(), 0.0, 1e-3 * state.energy.supplied());
}

/// A plate on a spring k with the mass of all its nodes, that of a rigid block: ω² = k/m in one component.
#[test]
fn a_plate_swings_with_all_of_its_mass() {
    let k = 40.0;
    for (scheme, dt) in [(TRAPEZOIDAL, 0.002), (EXPLICIT, 0.002)] {
        let start = LoadStep::new("swing", 1.0)
            .scheme(scheme)
            .dt(dt)
            .load(Load::spring(Place::Node(17), [0.0, k]))
            .load(Load::total_force("block_top", [expression("0"), expression("-1")]));
        // The round-off of the inertia, ε m u/(β Δt²) = 2e-11 for u = 0.05, is more than 1e-12 of the load.
        let newton = NewtonSettings { tolerance: 1e-10, ..NewtonSettings::default() };
        let run = run_through(block(0.0).newton(newton).plate_moving("block", Plate::UyAlike).step(start));
        let omega = (k / 4.0f64).sqrt();
        let state = run.last();
        let expected = -1.0 / k * (1.0 - (omega * state.time).cos());
        close(&format!("{scheme:?}"), state.displacement[1], expected, 1e-5 / k);
    }
}

#[test]
fn the_tangent_knows_what_turns_in_motion() {
    for scheme in [TRAPEZOIDAL, HHT, ALPHA] {
        for held in [false, true] {
            let step = LoadStep::new("load", 1.0).scheme(scheme).dt(0.1).fix("block_bottom");
            let step = step.load(Load::moment("block_top", 3.0)).load(Load::spring(Place::Node(17), [4.0, 5.0]));
            let hinge = Support::on(Place::Node(15)).ux(0.0);
            let step = if held { step.support(hinge) } else { step };
            let model =
                Arc::new(block(0.0).plate_moving("block_top", Plate::Rigid).step(step).build().expect("a model"));
            let (state, u) = (moving(&model), arbitrary_displacement(&model, 1e-2));
            let error = tangent_error(&model, Trial::new(&state, &model.steps[0], 0.5, 0.1), &u, 1e-6);
            assert!(error < 1e-7, "{scheme:?}, held: {held}: {error:.1e}");
        }
    }
}

/// Launched after a step at rest, a rigid plate has the velocity of its body, and a hinge lets only what turns pass.
#[test]
fn rigid_plates_are_launched() {
    for scheme in [TRAPEZOIDAL, EXPLICIT] {
        let rest = LoadStep::new("rest", 1.0).fix("block_bottom");
        let free = Support::on("block_bottom").ux(fecontact::model::builder::Change::End);
        let free = free.uy(fecontact::model::builder::Change::End);
        let fly = LoadStep::new("fly", 0.5).scheme(scheme).dt(0.01).launch("block", [0.3, -0.2]).support(free);
        let run = run_through(block(0.0).plate_moving("block_top", Plate::Rigid).step(rest).step(fly));
        let state = run.last();
        for (dof, u) in state.displacement.iter().enumerate() {
            close(&format!("{scheme:?}"), *u, 0.5 * [0.3, -0.2][dof % 2], 1e-10);
        }
    }
}
