//! Loading plates that turn, and those of which one component is alike.

use std::sync::Arc;

use crate::common::{Blocks, Finished, close, distance, expression, linear, neo_hookean, run_through};
use crate::terms::{arbitrary_displacement, moving, tangent_error};
use fecontact::equations::Trial;
use fecontact::model::boundary::Drive;
use fecontact::model::builder::{Builder, Load, LoadStep, Place, Plate, Support};
use fecontact::model::{Model, NewtonSettings, Scheme, State};

const TRAPEZOIDAL: Scheme = Scheme::Newmark { beta: 0.25, gamma: 0.5 };

/// A block 2 × 1 of E = 100 and ρ = 2; its top has the nodes 15 to 19.
fn block(soft: bool) -> Builder {
    let material = if soft { neo_hookean(100.0, 0.3, 2.0) } else { linear(100.0, 0.3, 2.0) };
    Model::builder(Blocks::default().rectangle("block", [4, 3], [0.0, 0.0], [2.0, 1.0]).mesh())
        .body("block", material)
        .newton(NewtonSettings { tolerance: 1e-12, max_iterations: 40 })
}

/// Moment of the reactions of a group about a point, where its nodes are now.
fn moment(run: &Finished, group: &str, state: &State, about: [f64; 2]) -> f64 {
    let x = run.model.configuration(&state.displacement);
    let of = |node: &usize| {
        let at = x.at(*node);
        (at.x - about[0]) * state.reaction[2 * node + 1] - (at.y - about[1]) * state.reaction[2 * node]
    };
    run.nodes(group).iter().map(of).sum()
}

/// A greased plate under a force: the side keeps level, slides along itself, and is moved as by supports that need that force.
#[test]
fn a_plate_may_be_alike_in_one_component() {
    let force = -4.0;
    for soft in [false, true] {
        let step = || LoadStep::new("load", 1.0).dt(0.5).fix("block_bottom");
        let plate = || block(soft).plate_moving("block_top", Plate::UyAlike);
        let pressed = run_through(plate().step(step().load(Load::total_force("block_top", [0.0, force]))));
        let u = |run: &Finished, dof: usize| run.last().displacement[dof];
        (15..20).for_each(|node| close("level", u(&pressed, 2 * node + 1), u(&pressed, 31), 1e-15));
        assert!(u(&pressed, 38) - u(&pressed, 30) > 1e-3, "it widens");
        close("bottom", pressed.reaction("block_bottom", pressed.last())[1], -force, 1e-10);
        let moved = run_through(block(soft).step(step().support(Support::on("block_top").uy(u(&pressed, 31)))));
        close("the same motion", distance(&moved.last().displacement, &pressed.last().displacement), 0.0, 1e-12);
        close("the same force", moved.reaction("block_top", moved.last())[1], force, 1e-10);
        // A support on one node of it is one of the plate.
        let led = run_through(plate().step(step().support(Support::on(Place::Node(17)).uy(u(&pressed, 31)))));
        close("led", distance(&led.last().displacement, &pressed.last().displacement), 0.0, 1e-12);
    }
}

/// In motion: momentum is F t; and a plate that supports lead moves as if all its nodes were led.
#[test]
fn a_plate_alike_in_one_component_moves_in_implicit_schemes() {
    for scheme in [TRAPEZOIDAL, Scheme::Hht { alpha: -0.1 }, Scheme::Wilson { theta: 1.4 }] {
        let step = || LoadStep::new("move", 0.5).scheme(scheme).dt(0.02);
        let plate = || block(true).plate_moving("block_top", Plate::UyAlike);
        let force = [expression("0"), expression("-0.8")];
        let run = run_through(plate().step(step().load(Load::total_force("block_top", force))));
        for state in &run.states {
            let mass = |e: usize| run.model.element_lumped_mass(e);
            let elements = run.model.mesh.elements.iter().enumerate();
            let momentum: f64 = elements
                .map(|(e, el)| el.nodes.iter().zip(&mass(e)).map(|(n, m)| m * state.velocity[2 * n + 1]).sum::<f64>())
                .sum();
            // Wilson's equilibrium lies beyond the increment.
            let allowed = if scheme.theta() > 1.0 { 1e-3 } else { 1e-10 };
            close(&format!("{scheme:?}: momentum"), momentum, -0.8 * state.time, allowed);
            (15..20).for_each(|n| close("level", state.displacement[2 * n + 1], state.displacement[31], 1e-13));
        }
        let lead = || {
            step()
                .support(Support::on("block_bottom").uy(0.0))
                .support(Support::on("block_top").uy(expression("-0.1*t^2")))
        };
        let (led, plain) = (run_through(plate().step(lead())), run_through(block(true).step(lead())));
        for (a, b) in led.states.iter().zip(&plain.states) {
            close(&format!("{scheme:?}: u"), distance(&a.displacement, &b.displacement), 0.0, 1e-12);
            close(&format!("{scheme:?}: v"), distance(&a.velocity, &b.velocity), 0.0, 1e-10);
            let [a, b] = [led.reaction("block_top", a)[1], plain.reaction("block_top", b)[1]];
            close(&format!("{scheme:?}: R"), a, b, 1e-8);
        }
    }
}

/// A rigid lever on a hinge with a spring k at r from it: M = k |r|² sin θ, to any angle.
#[test]
fn a_rigid_lever_turns_against_a_spring() {
    let (k, square) = (20.0, 5.0);
    let step = LoadStep::new("turn", 1.0)
        .dt(0.125)
        .support(Support::on(Place::Node(0)).ux(0.0).uy(0.0))
        .load(Load::spring(Place::Node(19), [k, k]))
        .load(Load::moment("block", 0.96 * k * square));
    let run = run_through(block(true).plate_moving("block", Plate::Rigid).step(step));
    for state in &run.states {
        let angle = (0.96 * state.time).asin();
        for (node, at) in run.model.mesh.nodes.iter().enumerate() {
            let expected = nalgebra::Rotation2::new(angle) * at - at;
            for i in 0..2 {
                close("turned", state.displacement[2 * node + i], expected[i], 1e-9);
            }
        }
        // The hinge holds against the spring.
        let pull = [38, 39].map(|dof| k * state.displacement[dof]);
        (0..2).for_each(|i| close("hinge", state.reaction[i], pull[i], 1e-9 * k));
    }
    close("strain", run.last().energy.strain, 0.0, 1e-12);
    // The moment's work is that of the mean force over an increment, as of all that turns.
    let stored = k * square * (1.0 - (1.0f64 - 0.96 * 0.96).sqrt());
    close("energy", run.last().energy.error(), 0.0, 0.03 * stored);
}

/// A rigid side of a soft block, hinged at its corner and turned by a moment far from linear: the rotation that a support
/// prescribes needs that moment, and the bottom bears it.
#[test]
fn a_rigid_side_is_turned_by_its_moment() {
    let applied = 20.0;
    let step = || LoadStep::new("turn", 1.0).dt(0.125).fix("block_bottom");
    let hinged = step().support(Support::on(Place::Node(15)).ux(0.0).uy(0.0)).load(Load::moment("block_top", applied));
    let turned = run_through(block(true).plate_moving("block_top", Plate::Rigid).step(hinged));
    let state = turned.last();
    let x = turned.model.configuration(&state.displacement);
    let e = x.at(19) - x.at(15);
    close("rigid", e.norm(), 2.0, 1e-12);
    let angle = e.y.atan2(e.x);
    assert!(angle > 0.05, "it turns by {angle}");
    let rotated = step().support(Support::on("block_top").rotation([0.0, 1.0], angle));
    let rotated = run_through(block(true).step(rotated));
    close("the same shape", distance(&rotated.last().displacement, &state.displacement), 0.0, 1e-9);
    close("the same moment", moment(&rotated, "block_top", rotated.last(), [0.0, 1.0]), applied, 1e-8);
    let hinge = [0, 1].map(|i| state.reaction[30 + i]);
    let bottom = turned.reaction("block_bottom", state);
    (0..2).for_each(|i| close("forces", hinge[i] + bottom[i], 0.0, 1e-9));
    close("moments", moment(&turned, "block_bottom", state, [0.0, 1.0]), -applied, 1e-8);
    // Free of the hinge, the side goes where the same moment leaves no force.
    let free = run_through(
        block(true).plate_moving("block_top", Plate::Rigid).step(step().load(Load::moment("block_top", applied))),
    );
    let bottom = free.reaction("block_bottom", free.last());
    (0..2).for_each(|i| close("no force", bottom[i], 0.0, 1e-9));
    close("free", moment(&free, "block_bottom", free.last(), [0.7, -0.2]), -applied, 1e-8);
}

/// A force on a rigid side acts with its lever: that at one node turns it, and the bottom bears force and moment.
#[test]
fn a_force_on_a_rigid_side_has_its_lever() {
    let step = LoadStep::new("load", 1.0)
        .dt(0.25)
        .fix("block_bottom")
        .load(Load::force(Place::Node(18), [0.3, -1.5]))
        .load(Load::total_force("block_top", [0.5, 0.0]));
    let run = run_through(block(true).plate_moving("block_top", Plate::Rigid).step(step));
    let state = run.last();
    let x = run.model.configuration(&state.displacement);
    let (at, middle) = (x.at(18), x.at(17));
    let bottom = run.reaction("block_bottom", state);
    close("x", bottom[0], -0.8, 1e-9);
    close("y", bottom[1], 1.5, 1e-9);
    let applied = at.x * -1.5 - at.y * 0.3 - middle.y * 0.5;
    close("moment", moment(&run, "block_bottom", state, [0.0, 0.0]), -applied, 1e-8);
    assert!((x.at(19).y - x.at(15).y).abs() > 1e-3, "it turns");
}

#[test]
fn the_tangent_knows_plates_that_turn() {
    for (scheme, moves) in
        [(Scheme::Static, Plate::Rigid), (Scheme::Static, Plate::UxAlike), (TRAPEZOIDAL, Plate::UyAlike)]
    {
        let step = LoadStep::new("load", 1.0).scheme(scheme).dt(0.1).fix("block_bottom");
        let step = match moves {
            Plate::Rigid => step.load(Load::moment("block_top", 3.0)).load(Load::spring(Place::Node(17), [4.0, 5.0])),
            _ => step.load(Load::dashpot(Place::Node(15), [0.4, 0.6])).load(Load::pressure("block_top", 2.0)),
        };
        let model = block(true).plate_moving("block_top", moves).step(step);
        let model = Arc::new(model.build().expect("a model"));
        let (state, u) = (moving(&model), arbitrary_displacement(&model, 1e-2));
        let error = tangent_error(&model, Trial::new(&state, &model.steps[0], 0.5, 0.1), &u, 1e-6);
        assert!(error < 1e-7, "{scheme:?}, {moves:?}: {error:.1e}");
    }
}

/// The reaction of a plate along y is with one of its nodes; those along x stay with the nodes that supports hold.
#[test]
fn reactions_of_a_plate_alike_in_one_component_count_by_component() {
    let step = LoadStep::new("load", 1.0)
        .dt(1.0)
        .fix("block_bottom")
        .support(Support::on("block_left").ux(0.01))
        .support(Support::on("block_top").uy(-0.02));
    let model =
        block(false).plate_moving("block_top", Plate::UyAlike).watch("block_top").watch("block_left").step(step);
    let run = run_through(model);
    let state = run.last();
    let sum = |set: usize, i: usize| -> f64 {
        run.model.requests.watch[set].constrained[i].iter().map(|node| state.reaction[2 * node + i]).sum()
    };
    assert_eq!(run.model.requests.watch[1].constrained.clone().map(|held| held.len()), [4, 3]);
    let plain = run_through(
        block(false).step(
            LoadStep::new("load", 1.0)
                .dt(1.0)
                .fix("block_bottom")
                .support(Support::on("block_left").ux(0.01))
                .support(Support::on("block_top").uy(-0.02)),
        ),
    );
    close("top", sum(0, 1), plain.reaction("block_top", plain.last())[1], 1e-10);
    close("left", sum(1, 0), plain.reaction("block_left", plain.last())[0], 1e-10);
}

#[test]
fn what_these_plates_cannot_do_is_refused() {
    let step = || LoadStep::new("load", 1.0).dt(0.5).fix("block_bottom");
    let rigid = || block(false).plate_moving("block_top", Plate::Rigid);
    let level = || block(false).plate_moving("block_top", Plate::UyAlike);
    for (model, words) in [
        (
            rigid().step(step().support(Support::on("block_top").ux(0.0))),
            "plates[0]: rotates, but supports constrain more than one of its nodes, 15 and 16",
        ),
        (
            rigid().plate_moving("block_left", Plate::UxAlike).step(step()),
            "plates[1]: node 15 is tied to others already",
        ),
        (level().plate("block_right").step(step()), "plates[0]: node 19 is tied to others already"),
        (
            level().step(step().load(Load::moment("block_top", 1.0))),
            "steps[0].loads[0].on: a moment acts on a rigid body or a plate that rotates, and block_top is neither",
        ),
        (
            level().step(step().support(Support::on("block_top").along([1.0, 1.0], 0.0))),
            "steps[0].supports[1]: node 15 belongs to a plate with tied displacements: give ux and uy",
        ),
        (
            level().step(step().support(Support::on("block_top").uy(Drive::Rate(f64::NAN)))),
            "steps[0].supports[1].uy: is NaN: must be a finite number",
        ),
    ] {
        let message = model.build().err().map(|error| error.to_string()).unwrap_or_default();
        assert!(message.starts_with(words), "`{words}` is not in `{message}`");
    }
}
