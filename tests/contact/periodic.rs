//! Periodic sides: waves that come back, sliding without end, and sides that do not fit.

use std::f64::consts::PI;

use crate::common::{Blocks, Finished, close, expression, floor, linear, neo_hookean, run_through};
use fecontact::laws::friction::CoulombParameters;
use fecontact::mesh::ties::Ties;
use fecontact::model::boundary::Drive;
use fecontact::model::builder::{Builder, Change, Contact, Load, LoadStep, Place, Support};
use fecontact::model::{Damping, Model, Scheme};

const TRAPEZOIDAL: Scheme = Scheme::Newmark { beta: 0.25, gamma: 0.5 };
const EXPLICIT: Scheme = Scheme::Explicit { safety: 0.9 };

/// A periodic bar of length 1 along a direction, without steps.
fn ring(angle: f64, damping: f64) -> Builder {
    Model::builder(Blocks::default().rectangle("bar", [60, 1], [0.0, 0.0], [1.0, 0.05]).turned(angle).mesh())
        .body("bar", linear(4.0, 0.0, 1.0))
        .damping("bar", Damping { mass: damping, retardation: 0.0 })
        .periodic("bar_left", "bar_right")
}

/// The bar bent into a sine by forces and let go.
fn ringing(angle: f64, scheme: Scheme, dt: f64, damping: f64) -> Finished {
    let along = format!("({}*x+{}*y)", angle.cos(), angle.sin());
    let force = |size: f64| expression(&format!("{size}*sin({}*{along})", 2.0 * PI));
    let bending = [force(1e-4 * angle.cos()), force(1e-4 * angle.sin())];
    let bend = LoadStep::new("bend", 1.0).dt(1.0).fix(Place::Node(0)).load(Load::force("bar", bending));
    let free = Support::on(Place::Node(0)).ux(Change::End).uy(Change::End);
    let nothing = Load::force("bar", [expression("0"), expression("0")]);
    let ringing = LoadStep::new("ring", 2.0).scheme(scheme).dt(dt).support(free).load(nothing);
    run_through(ring(angle, damping).step(bend).step(ringing).interval(0.125))
}

#[test]
fn a_standing_wave_returns_after_the_time_round_the_ring() {
    // c = 2: u = A sin(2πx/L) cos(2πct/L) for ever, with the period L/c = 0.5. Free ends would not let it stand.
    for (scheme, dt) in [
        (EXPLICIT, 1.0),
        (TRAPEZOIDAL, 0.0025),
        (Scheme::Hht { alpha: -0.05 }, 0.0025),
        (Scheme::Wilson { theta: 1.4 }, 0.0025),
    ] {
        for angle in [0.0, 0.6] {
            let run = ringing(angle, scheme, dt, 0.0);
            assert_eq!(run.iterations[0], 1, "the bending is linear");
            let start = &run.states[0];
            let size = start.displacement.iter().fold(0.0f64, |size, u| size.max(u.abs()));
            for (t, expected) in [(0.125, 0.0), (0.25, -1.0), (0.5, 1.0), (1.0, 1.0), (2.0, 1.0)] {
                let state = run.at(1.0 + t);
                for (u, u0) in state.displacement.iter().zip(&start.displacement) {
                    close(&format!("{scheme:?}, {angle}, t = {t}"), *u, expected * u0, 0.02 * size);
                }
                for (left, right) in run.nodes("bar_left").into_iter().zip(run.nodes("bar_right")) {
                    for values in [&state.displacement, &state.velocity, &state.acceleration] {
                        let largest = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
                        (0..2).for_each(|i| {
                            close("partners", values[2 * left + i], values[2 * right + i], 1e-9 * largest);
                        });
                    }
                }
            }
            let energy = &run.last().energy;
            close("energy", energy.error(), 0.0, 0.01 * energy.strain.max(energy.external_work));
        }
    }
}

#[test]
fn damping_by_the_masses_counts_partners_once() {
    for (scheme, dt) in [(EXPLICIT, 1.0), (TRAPEZOIDAL, 0.0025)] {
        let run = ringing(0.0, scheme, dt, 0.5);
        let (start, end) = (&run.states[0].displacement, &run.last().displacement);
        let expected = f64::exp(-0.25 * 2.0);
        for (u, u0) in end.iter().zip(start) {
            close(&format!("{scheme:?}"), *u, expected * u0, 1e-2 * start.iter().fold(0.0f64, |m, u| m.max(u.abs())));
        }
    }
}

#[test]
fn a_periodic_block_slides_for_ever_under_uniform_tractions() {
    // In dynamics the block goes on swinging a little from its start.
    for (scheme, allowed) in [(Scheme::Static, 1e-9), (TRAPEZOIDAL, 1e-3)] {
        let friction = CoulombParameters { mu: 0.4, alpha_t: Some(1e5) };
        let press = LoadStep::new("press", 1.0).dt(0.25).support(Support::on("block_top").ux(0.0).uy(-0.002));
        let drag = LoadStep::new("drag", 50.0).dt(2.5).scheme(scheme);
        let model = Model::builder(Blocks::default().rectangle("block", [4, 2], [0.0, 0.0], [1.0, 0.5]).mesh())
            .body("block", neo_hookean(100.0, 0.3, 1e-6))
            .periodic("block_left", "block_right")
            .contact(Contact::new("base", "block_bottom", floor(), friction).alpha_n(1e5))
            .step(press)
            .step(drag.support(Support::on("block_top").ux(Drive::Rate(2.0))))
            .watch("block_top");
        let run = run_through(model);
        let state = run.last();
        close("way", state.contacts[0][0].friction.plastic_slip, 100.0, 0.1);
        // Uniaxial strain: p = −P₂₂ of the law at F = diag(1, 1 − e), the spring of the contact in line with it.
        let first = state.contacts[0][0].friction.clone();
        assert!(first.pressure > 0.4, "{first:?}");
        for contact in &state.contacts[0] {
            close("pressure", contact.friction.pressure, first.pressure, allowed);
            close("traction", contact.friction.traction, 0.4 * first.pressure, allowed);
        }
        let [fx, fy] = run.reaction("block_top", state);
        close("drag", fx, 0.4 * first.pressure, 10.0 * allowed);
        close("press", fy, -first.pressure, 10.0 * allowed);
    }
}

#[test]
fn corners_of_a_model_periodic_both_ways_move_as_one() {
    // 2 3
    // 0 1
    let ties = Ties::new(6, &[[0, 1], [2, 3], [0, 2], [1, 3]]);
    assert_eq!([0, 1, 2, 3, 4].map(|node| ties.original(node)), [0, 0, 0, 0, 4]);
    let mut values = vec![1.0, 2.0, 4.0, 8.0, 16.0, 32.0];
    ties.gather(1, &mut values);
    assert_eq!(values, [15.0, 0.0, 0.0, 0.0, 16.0, 32.0]);
    ties.spread(1, &mut values);
    assert_eq!(values, [15.0, 15.0, 15.0, 15.0, 16.0, 32.0]);
    // A body that can do nothing but fly: no waves, no rotation, two motions left.
    let run = run_through(
        Model::builder(Blocks::default().rectangle("cell", [3, 2], [0.0, 0.0], [1.0, 1.0]).mesh())
            .body("cell", linear(1.0, 0.3, 1.0))
            .periodic("cell_left", "cell_right")
            .periodic("cell_bottom", "cell_top")
            .initial_velocity("cell", [0.1, 0.2])
            .step(LoadStep::new("fly", 1.0).scheme(EXPLICIT)),
    );
    run.last().displacement.chunks(2).for_each(|u| close("flight", u[0] + u[1], 0.3, 1e-12));
    close("kinetic energy", run.last().energy.kinetic, 0.5 * 0.05, 1e-12);
}

#[test]
fn sides_that_do_not_lie_alike_are_refused() {
    let bar = |blocks: &Blocks| Model::builder(blocks.mesh()).body("bar", linear(1.0, 0.0, 1.0));
    let refused = |model: Builder, words: &str| {
        let error = model.build().expect_err("refused").to_string();
        assert!(error.contains(words), "{error}");
    };
    let fly = || LoadStep::new("fly", 1.0).scheme(TRAPEZOIDAL);
    let good = Blocks::default().rectangle("bar", [4, 2], [0.0, 0.0], [1.0, 0.5]);
    refused(bar(&good).periodic("bar_left", "bar_rigth").step(fly()), "periodic[0]");
    refused(bar(&good).periodic("bar_left", "bar_top").step(fly()), "`bar_left` has 3 nodes and `bar_top` has 5");
    refused(bar(&good).periodic("bar_left", "bar_left").step(fly()), "is on both sides");
    let unsymmetric = Blocks::default().block("bar", [4, 2], |s, t| [s, 0.5 * (t + 0.2 * s * t * (1.0 - t))]);
    refused(bar(&unsymmetric).periodic("bar_left", "bar_right").step(fly()), "has no partner on `bar_right`");
    // A static step needs supports against translation, but none against rotation.
    let held = || LoadStep::new("hold", 1.0).fix(Place::Node(0));
    let free = bar(&good).periodic("bar_left", "bar_right").step(LoadStep::new("hold", 1.0));
    refused(free, "`bar` can move freely along");
    refused(bar(&good).step(held()), "in rotation");
    run_through(ring(0.0, 0.0).step(held()));
}
