//! Rigid masters that move: what they do is what a block does that moves past them at rest; slopes, rollers, energies, input that is
//! refused.

mod free;

use std::sync::Arc;

use fecontact::contact::force::ContactState;
use fecontact::laws::friction::{CoulombParameters, FrictionParameters};
use fecontact::mesh::Section;
use fecontact::model::boundary::Drive;
use fecontact::model::builder::{
    Builder, Change, Contact, IncrementSettings, Load, LoadStep, MasterSide, Place, Support,
};
use fecontact::model::{Method, Model, NewtonSettings, Scheme, State};
use fecontact::output::history::History;
use fecontact::run::run;
use nalgebra::{Rotation2, Vector2};
use serde_json::{Value, json};

use crate::common::{
    Blocks, Finished, Record, close, expression, finish, finish_at, linear, model, neo_hookean, run_through,
};

const MU: f64 = 0.3;

/// A block 2 × 1 with its bottom on y = 0, on a master that is at rest or part of the rigid body `tool`.
fn block(soft: bool, contact: Contact) -> Builder {
    block_beside(&[], soft, contact)
}

/// The same in a mesh with further lines, `die`: each the positions of its nodes, end, end and perhaps middle.
fn block_beside(lines: &[Vec<[f64; 2]>], soft: bool, contact: Contact) -> Builder {
    let mut mesh = Blocks::default().rectangle("block", [6, 3], [-1.0, 0.0], [1.0, 1.0]);
    for line in lines {
        let node = |at: &[f64; 2]| {
            let known = mesh.nodes.iter().position(|node| node == at);
            known.unwrap_or_else(|| {
                mesh.nodes.push(*at);
                mesh.nodes.len() - 1
            })
        };
        let nodes: Vec<usize> = line.iter().map(node).collect();
        mesh.edges.entry("die".into()).or_default().push(nodes);
    }
    let builder = Model::builder(mesh.mesh()).newton(NewtonSettings { tolerance: 1e-12, max_iterations: 40 });
    let builder = match soft {
        true => builder.body("block", neo_hookean(100.0, 0.3, 2.0)),
        false => builder.body("block", linear(100.0, 0.3, 2.0)),
    };
    builder.contact(contact.alpha_n(3e3))
}

fn on(master: MasterSide) -> Contact {
    Contact::new("base", "block_bottom", master, CoulombParameters::new(MU).alpha_t(1.5e3))
}

/// An indenter from below, its top at the origin.
fn disk() -> MasterSide {
    MasterSide::Circle { centre: [0.0, -3.0], radius: 3.0, hole: false }
}

fn plane() -> MasterSide {
    MasterSide::Plane { point: [0.3, 0.0], normal: [0.0, 1.0] }
}

/// States of the contact agree, but for the place of the feet.
fn same(what: &str, a: &[ContactState], b: &[ContactState], tolerance: f64) {
    let largest = a.iter().fold(1.0f64, |most, state| most.max(state.friction.pressure));
    for (a, b) in a.iter().zip(b) {
        let of = |state: &ContactState| {
            let friction = state.friction.clone();
            [friction.pressure, friction.traction, 1e3 * state.gap, 1e3 * friction.plastic_slip]
        };
        for (a, b) in of(a).into_iter().zip(of(b)) {
            close(what, a, b, tolerance * largest);
        }
    }
}

/// Some points press, so that the comparison says something.
fn touches(what: &str, states: &[ContactState]) {
    assert!(states.iter().any(|state| state.friction.pressure > 0.1), "{what}: nothing touches");
}

/// Moment of the reactions of a group about a point.
fn moment(run: &Finished, group: &str, state: &State, about: Vector2<f64>) -> f64 {
    let x = run.model.configuration(&state.displacement);
    let force = |node: usize| Vector2::new(state.reaction[2 * node], state.reaction[2 * node + 1]);
    run.nodes(group).into_iter().map(|node| (x.at(node) - about).perp(&force(node))).sum()
}

/// The moment that supports put on the tool.
fn moment_of_tool(run: &Finished, state: &State) -> f64 {
    let body = &run.model.mesh.rigid_bodies[0];
    body.radius * state.reaction[2 * body.turning]
}

/// A disk or a plane pressed into a block and dragged along it is a block pressed on it and dragged the other way: tractions, slip,
/// forces, moments, work and stored energy, at nodes, at Gauss points and by mortar, in finite and in small sliding.
#[test]
fn a_tool_that_moves_is_a_block_that_moves() {
    let path: [fn(f64) -> Drive; 2] = [
        |sign| expression(&format!("{sign}*(0.2*max(0, t - 1))")),
        |sign| Drive::Table(vec![[0.0, 0.0], [1.0, -0.04 * sign], [2.0, -0.05 * sign]]),
    ];
    let methods = [Method::NodeToSegment, Method::GaussToSegment, Method::Mortar];
    let shapes: [fn() -> MasterSide; 2] = [disk, plane];
    for (shape, method, small) in shapes
        .iter()
        .flat_map(|shape| methods.iter().flat_map(move |method| [false, true].map(|small| (shape, *method, small))))
    {
        let what = format!("{:?}, {method:?}, small {small}", shape());
        let contact = || {
            let contact = on(shape()).method(method);
            if small { contact.small_sliding() } else { contact }
        };
        let step = || LoadStep::new("press and drag", 2.0).dt(0.125);
        let [x, y] = path;
        let resting =
            run_through(block(!small, contact()).step(step().support(Support::on("block_top").ux(x(1.0)).uy(y(1.0)))));
        let moving = run_through(
            block(!small, contact().rigid_body("tool"))
                .rigid_body("tool", [0.4, -1.0])
                .step(step().fix("block_top").support(Support::on("tool").ux(x(-1.0)).uy(y(-1.0)).angle(0.0))),
        );
        assert_eq!(resting.states.len(), moving.states.len(), "{what}");
        for (a, b) in resting.states.iter().zip(&moving.states) {
            same(&what, &a.contacts[0], &b.contacts[0], 1e-9);
            let [force, top, tool] =
                [resting.reaction("block_top", a), moving.reaction("block_top", b), moving.reaction("tool", b)];
            for i in 0..2 {
                close(&format!("{what}: held"), top[i], force[i], 1e-9);
                close(&format!("{what}: tool"), tool[i], -force[i], 1e-9);
            }
            let about = moving.model.configuration(&b.displacement).at(moving.nodes("tool")[0]);
            if !small {
                // All that acts on the block balances, and on the tool.
                let sum = moment(&moving, "block_top", b, about) + moment_of_tool(&moving, b);
                close(&format!("{what}: moment"), sum, 0.0, 1e-9);
            }
            let [a, b] = [a, b].map(|state| {
                let energy = state.energy;
                [energy.external_work, energy.strain, energy.contact_elastic, energy.friction_dissipation]
            });
            a.into_iter().zip(b).for_each(|(a, b)| close(&format!("{what}: energy"), a, b, 1e-9));
        }
        touches(&what, &moving.last().contacts[0]);
        let slid = moving.last().contacts[0].iter().any(|state| state.friction.plastic_slip.abs() > 0.01);
        assert!(slid, "{what}: nothing slides");
    }
}

/// A tool that turns about its reference point is a block that turns about it the other way.
#[test]
fn a_tool_that_turns_is_a_block_that_turns() {
    let about = [0.4, -1.0];
    let polyline = || MasterSide::Polyline { points: vec![[-2.0, -0.3], [-0.5, 0.0], [0.7, -0.01], [2.5, -0.2]] };
    let shapes: [(fn() -> MasterSide, Method); 4] = [
        (plane, Method::GaussToSegment),
        (plane, Method::Mortar),
        (polyline, Method::GaussToSegment),
        (polyline, Method::NodeToSegment),
    ];
    for (shape, method) in shapes {
        let contact = || on(shape()).method(method);
        let what = format!("{:?}, {method:?}", shape());
        // Both begin with a press, and turn then, in the same increments: where they end at a closure, the first iterate decides, which
        // is one on the contact nodes alone or on all.
        let dt = |dt: f64| IncrementSettings::from(dt).min(dt);
        let press = || LoadStep::new("press", 1.0).dt(dt(0.25));
        let turn = || LoadStep::new("turn", 1.0).dt(dt(0.03125));
        let down = || Support::on("block_top").ux(0.0).uy(-0.03);
        let resting = run_through(
            block(true, contact())
                .step(press().support(down()))
                .step(turn().support(Support::on("block_top").rotation(about, 0.3))),
        );
        let moving = run_through(
            block(true, contact().rigid_body("tool"))
                .rigid_body("tool", about)
                .step(press().support(down()).support(Support::on("tool").ux(0.0).uy(0.0).angle(0.0)))
                .step(turn().support(Support::on("tool").angle(-0.3))),
        );
        assert_eq!(resting.states.len(), moving.states.len(), "{what}");
        for (a, b) in resting.states.iter().zip(&moving.states) {
            same(&what, &a.contacts[0], &b.contacts[0], 1e-8);
            let force = Vector2::from(resting.reaction("block_top", a));
            let angle = -0.3 * (a.time - 1.0).max(0.0);
            let turned = Rotation2::new(angle) * force;
            close(&format!("{what}: force"), (Vector2::from(moving.reaction("tool", b)) + turned).norm(), 0.0, 1e-8);
            let center = Vector2::from(about);
            close(
                &format!("{what}: moment"),
                moment_of_tool(&moving, b),
                -moment(&resting, "block_top", a, center),
                1e-8,
            );
            let [a, b] = [a, b].map(|state| [state.energy.strain, state.energy.friction_dissipation]);
            a.into_iter().zip(b).for_each(|(a, b)| close(&format!("{what}: energy"), a, b, 1e-8));
        }
        touches(&what, &moving.last().contacts[0]);
    }
}

/// Lines of the mesh that are sides of no element, in any order, are the polyline through their nodes: a tool of them presses and turns
/// to the same bits. Closed ones and quadratic ones are the polyline as well.
#[test]
fn an_outline_in_the_mesh_is_the_polyline_through_its_nodes() {
    let [a, b, c, d] = [[-2.0, -0.3], [-0.5, -0.01], [0.7, -0.02], [2.5, -0.2]];
    let outline = || MasterSide::Outline { group: "die".into() };
    let polyline = |points: &[[f64; 2]]| MasterSide::Polyline { points: points.to_vec() };
    let run = |lines: &[Vec<[f64; 2]>], master: MasterSide| {
        let down = Support::on("block_top").ux(0.0).uy(-0.04);
        let held = Support::on("tool").ux(0.0).uy(0.0).angle(0.0);
        let dt = IncrementSettings::from(0.25);
        run_through(
            block_beside(lines, true, on(master).rigid_body("tool"))
                .rigid_body("tool", [0.4, -1.0])
                .step(LoadStep::new("press", 1.0).dt(dt).support(down).support(held))
                .step(LoadStep::new("turn", 1.0).dt(dt).support(Support::on("tool").angle(-0.2))),
        )
    };
    let [lines, points] = [run(&[vec![b, c], vec![a, b], vec![c, d]], outline()), run(&[], polyline(&[a, b, c, d]))];
    assert_eq!(lines.states.len(), points.states.len());
    for (one, other) in lines.states.iter().zip(&points.states) {
        assert_eq!((&one.displacement, &one.contacts), (&other.displacement, &other.contacts));
    }
    touches("the outline", &lines.last().contacts[0]);

    let master = |lines: &[Vec<[f64; 2]>], master: MasterSide| {
        let model = block_beside(lines, true, on(master)).step(LoadStep::new("rest", 1.0).fix("block_top")).build();
        model.unwrap_or_else(|error| panic!("{error}")).contacts[0].master.clone()
    };
    let deep = [0.0, -3.0];
    let closed = master(&[vec![c, deep], vec![a, c], vec![deep, a]], outline());
    assert_eq!(closed, master(&[], polyline(&[c, deep, a, c])));
    let quadratic = master(&[vec![a, c, b], vec![c, d]], outline());
    assert_eq!(quadratic, master(&[], polyline(&[a, b, c, d])));
}

/// Lines that are no outline, and outlines where something else is meant.
#[test]
fn outlines_that_are_refused() {
    let [a, b, c, d] = [[-2.0, -0.3], [-0.5, -0.01], [0.7, -0.02], [2.5, -0.2]];
    let refused = |lines: &[Vec<[f64; 2]>], contact: Contact, support: Option<Support>, told: &str| {
        let step = LoadStep::new("rest", 1.0).fix("block_top");
        let step = support.into_iter().fold(step, |step, support| step.support(support));
        let error = block_beside(lines, true, contact).step(step).build().map(|_| ()).expect_err(told).to_string();
        assert!(error.contains(told), "{error}, expected {told}");
    };
    let of = |group: &str| on(MasterSide::Outline { group: group.into() });
    let place = "contacts.base.master.outline.group: ";
    let at = |why: &str| format!("{place}`die`: {why}");
    refused(
        &[vec![a, b], vec![b, c], vec![b, d]],
        of("die"),
        None,
        &at("two lines begin at node 29 at (-0.5, -0.01): "),
    );
    refused(&[vec![a, b], vec![c, b]], of("die"), None, &at("two lines end at node 29 at (-0.5, -0.01): "));
    refused(
        &[vec![a, b], vec![c, d]],
        of("die"),
        None,
        &at("it is in pieces, one from node 28 on, another with node 30 at (0.7, -0.02): "),
    );
    refused(&[], of("die"), None, &format!("{place}the mesh has no group `die`"));
    refused(
        &[],
        of("block_top"),
        None,
        &format!("{place}the lines of `block_top` are sides of elements, which deform: "),
    );
    refused(&[], of("block"), None, &format!("{place}`block` is a group of solid elements, not of lines"));
    let lines = [vec![a, b], vec![b, c]];
    refused(
        &lines,
        on("die".into()),
        None,
        "contacts.base.master: `die` is a group of lines that are sides of no element; it serves as a rigid master alone: {\"outline\": \
         {\"group\": \"die\"}}",
    );
    refused(
        &lines,
        of("die"),
        Some(Support::on("die").ux(0.0)),
        "`die` is a group of lines that are sides of no element",
    );
    refused(&lines, of("die").smooth(), None, "contacts.base.smooth: ");
}

/// In motion: a block that flies along a plane at a steady speed, pressed on it, and a plane that passes below a block.
#[test]
fn a_tool_that_moves_steadily_is_a_block_that_does() {
    let v = 0.5;
    for scheme in
        [Scheme::Newmark { beta: 0.25, gamma: 0.5 }, Scheme::Hht { alpha: -0.1 }, Scheme::Explicit { safety: 0.8 }]
    {
        let step = || LoadStep::new("move", 0.4).scheme(scheme).dt(0.004);
        let down = || expression("-0.03*(1 - cos(7*t))");
        let drag = |v: f64| Drive::Rate(v);
        // A little apart at first: whether surfaces touch that lie on each other, round-off says.
        let plane = || MasterSide::Plane { point: [0.3, -0.002], normal: [0.0, 1.0] };
        let contact = || on(plane()).method(Method::NodeToSegment);
        let resting = run_through(
            block(true, contact())
                .initial_velocity("block", [v, 0.0])
                .interval(0.02)
                .step(step().support(Support::on("block_top").ux(drag(v)).uy(down()))),
        );
        let tool = || Support::on("tool").ux(drag(-v)).uy(0.0).angle(0.0);
        let moving = run_through(
            block(true, contact().rigid_body("tool"))
                .rigid_body("tool", [0.0, -0.5])
                .interval(0.02)
                .step(step().support(Support::on("block_top").ux(0.0).uy(down())).support(tool())),
        );
        let what = format!("{scheme:?}");
        let [a, b] = [resting.last(), moving.last()];
        touches(&what, &b.contacts[0]);
        same(&what, &a.contacts[0], &b.contacts[0], 1e-7);
        let [force, held] = [resting.reaction("block_top", a), moving.reaction("block_top", b)];
        (0..2).for_each(|i| close(&what, held[i], force[i], 1e-6));
        let state = b.velocity[2 * moving.nodes("tool")[0]];
        close(&format!("{what}: velocity of the tool"), state, -v, 1e-9);
        if matches!(scheme, Scheme::Newmark { .. }) {
            // Momentum is the mean force over an increment times its length: what a frame that moves steadily adds to both cancels.
            close(&format!("{what}: energy"), b.energy.error(), a.energy.error(), 1e-6);
        }
    }
}

/// Without friction on a linear body every force is that of the motion: work of the tool is what is stored, to round-off.
#[test]
fn the_work_of_a_tool_is_stored() {
    let contact = Contact::new("base", "block_bottom", disk(), FrictionParameters::Frictionless {});
    let step =
        LoadStep::new("press", 1.0).dt(0.1).fix("block_top").support(Support::on("tool").ux(0.0).uy(0.04).angle(0.1));
    let run = run_through(
        block(false, contact.small_sliding().rigid_body("tool")).rigid_body("tool", [0.0, -3.0]).step(step),
    );
    let energy = run.last().energy;
    assert!(energy.external_work > 1e-2, "{energy:?}");
    // Where a point closes within an increment the mean of the forces at its ends is not that of its course.
    let closed = |state: &State| state.contacts[0].iter().filter(|state| state.friction.pressure > 0.0).count();
    let steady = run.states.windows(2).filter(|two| closed(&two[0]) == closed(&two[1]));
    let errors: Vec<f64> = steady.map(|two| two[1].energy.error() - two[0].energy.error()).collect();
    assert!(errors.len() > 2, "{} increments without a change of contact", errors.len());
    errors.iter().for_each(|error| close("balance", *error, 0.0, 1e-8 * energy.external_work));
}

/// A point under a weight on top of a roller, held along x, and then a step in which the roller turns.
fn on_roller([weight, area, alpha_n, alpha_t, radius]: [f64; 5], turn: Value) -> Finished {
    finish(&json!({
        "mesh": {"nodes": [[0, 2]], "points": {"p": [0]}},
        "rigid_bodies": {"roller": {"reference": [0, 0]}},
        "contacts": {"c": {"slave": "p", "area": area, "rigid_body": "roller", "normal": {"alpha_n": alpha_n},
            "master": {"circle": {"centre": [0, 0], "radius": radius}},
            "friction": {"law": "coulomb", "mu": MU, "alpha_t": alpha_t}}},
        "newton": {"tolerance": 1e-12},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.5}, "loads": [{"on": "p", "force": {"y": -weight}}],
             "supports": [{"on": "p", "ux": 0}, {"on": "roller", "ux": 0, "uy": 0, "angle": 0}]},
            turn
        ]
    }))
}

/// A point of 0.7 under a weight on top of a roller of radius 2, held along x, that turns by 0.6: it slides by R θ less what it
/// sticks elastically, q = μ N, and the moment is that of the friction at its arm, R − N/(α_n A).
#[test]
fn a_roller_that_turns_slides_below_a_point() {
    let (weight, area, alpha_n, alpha_t, radius) = (3.0, 0.7, 2e3, 1e3, 2.0);
    let run = on_roller(
        [weight, area, alpha_n, alpha_t, radius],
        json!({"name": "turn", "duration": 1, "dt": {"initial": 0.125},
        "supports": [{"on": "roller", "angle": {"rate": 0.6}}]}),
    );
    let (state, point) = (run.last(), run.last().contacts[0][0].clone());
    let (pressure, arm) = (weight / area, radius - weight / area / alpha_n);
    close("p", point.friction.pressure, pressure, 1e-9);
    // Counter-clockwise the top goes to −x: the point goes to +x on it, along s.
    close("q", point.friction.traction, MU * pressure, 1e-9);
    close("slip", point.friction.plastic_slip, radius * 0.6 - MU * pressure / alpha_t, 1e-9);
    let node = run.nodes("p")[0];
    close("pulled", state.reaction[2 * node], MU * weight, 1e-9);
    close("moment", moment_of_tool(&run, state), MU * weight * arm, 1e-9);
    // Work of the roller against friction; the weight sinks by the penetration.
    close(
        "dissipated",
        state.energy.friction_dissipation,
        MU * weight * (radius * 0.6 - MU * pressure / alpha_t),
        1e-9,
    );
}

/// A sphere on a cylinder of rubber: a rigid body of rings moves along y alone, by itself, and its force is that of the full turn.
#[test]
fn a_rigid_body_of_rings_moves_along_the_axis() {
    let sphere = |contact: Contact| {
        let mesh = Blocks::default().rectangle("block", [6, 3], [0.0, 0.0], [2.0, 1.0]).mesh();
        let step = LoadStep::new("press", 1.0).dt(0.25);
        let builder = Model::builder(mesh).section(Section::Axisymmetric).body("block", neo_hookean(100.0, 0.3, 2.0));
        (builder.contact(contact.alpha_n(3e3)).newton(NewtonSettings { tolerance: 1e-12, max_iterations: 40 }), step)
    };
    let (resting, step) = sphere(on(disk()));
    let resting = run_through(resting.step(step.support(Support::on("block_top").ux(0.0).uy(-0.05))));
    let (moving, step) = sphere(on(disk()).rigid_body("tool"));
    let moving = moving.rigid_body("tool", [0.0, -3.0]);
    let tool = |support: Support| step.clone().support(Support::on("block_top").ux(0.0).uy(0.0)).support(support);
    let run = run_through(moving.step(tool(Support::on("tool").uy(0.05))));
    touches("rings", &run.last().contacts[0]);
    same("rings", &resting.last().contacts[0], &run.last().contacts[0], 1e-9);
    let force = resting.reaction("block_top", resting.last())[1];
    close("force", run.reaction("tool", run.last())[1], -force, 1e-9 * force.abs());
    for (support, told) in [
        (Support::on("tool").uy(0.05).ux(0.1), "the rigid body `tool` moves along y alone"),
        (Support::on("tool").uy(0.05).angle(0.1), "axisymmetric bodies cannot rotate in the plane"),
    ] {
        let (builder, _) = sphere(on(disk()).rigid_body("tool"));
        let refused = builder.rigid_body("tool", [0.0, -3.0]).step(tool(support)).build();
        let error = refused.map(|_| ()).expect_err(told).to_string();
        assert!(error.contains(told), "{error}, expected {told}");
    }
}

/// What is refused, and what is said of it.
#[test]
fn rigid_bodies_that_are_refused() {
    let tool = || block(true, on(plane()).rigid_body("tool")).rigid_body("tool", [0.0, -1.0]);
    let step = || LoadStep::new("press", 1.0).dt(0.5).fix("block_top");
    let path = || Support::on("tool").ux(0.0).uy(0.03).angle(0.0);
    let refused = |builder: Builder, told: &str| {
        let error = builder.build().map(|_| ()).expect_err(told).to_string();
        assert!(error.contains(told), "{error}, expected {told}");
    };
    refused(tool().step(step().support(path().rotation([0.0, 0.0], 0.1))), "rotation");
    refused(tool().step(step().support(path())).rigid_body("tool", [0.0, 0.0]), "rigid_bodies.tool: is given twice");
    refused(
        tool().step(step().support(path())).rigid_body("block", [0.0, 0.0]),
        "rigid_bodies.block: is also the name of a group",
    );
    refused(tool().rigid_body("b", [f64::NAN, 0.0]).step(step()), "rigid_bodies.b.reference");
    let other = block(true, on(plane()).rigid_body("punch")).rigid_body("tool", [0.0, -1.0]);
    refused(other.step(step()), "contacts.base.rigid_body: there is no rigid body `punch`; there are tool");
    let none = block(true, on(plane()).rigid_body("punch"));
    refused(none.step(step()), "there is no rigid body `punch`: give it");
    refused(
        block(true, on(plane())).step(step().support(Support::on("block_top").angle(0.1))),
        "steps[0].supports[1].angle: there is no rigid body `block_top`",
    );
    // The nodes that carry its motion have no names of their own.
    refused(
        tool().step(step().support(path()).support(Support::on(Place::Node(29)).ux(0.1))),
        "the mesh has no node 29",
    );
    refused(
        tool().step(step().support(path()).support(Support::on(Place::Node(0)).angle(0.1))),
        "is for a rigid body, and node 0 is a node",
    );
    let soft = Contact::new("base", "block_bottom", "block_top", CoulombParameters::new(MU)).rigid_body("tool");
    refused(block(true, soft).rigid_body("tool", [0.0, 0.0]).step(step().support(path())), "is for a rigid master");
}

/// The dashpots that steer a rigid body into contact go by what it may touch, 1e-3 (λ + 2G) × duration = 2e-3 E for ν = 0, and not by a softer
/// body that stands aside.
#[test]
fn a_soft_bystander_does_not_steer_a_rigid_body() {
    let body = |young: f64| json!({"material": {"model": "linear", "E": young, "nu": 0}});
    let model = model(&json!({
        "mesh": Blocks::default().rectangle("block", [2, 1], [-1.0, 0.0], [1.0, 1.0]).rectangle("aside", [1, 1], [5.0, 0.0], [6.0, 1.0]).json(),
        "bodies": {"block": body(100.0), "aside": body(1.0)},
        "rigid_bodies": {"tool": {"reference": [0, -1]}},
        "contacts": {"base": {"slave": "block_bottom", "master": {"plane": {"point": [0, -0.1], "normal": [0, 1]}}, "rigid_body": "tool",
                              "friction": {"law": "coulomb", "mu": MU}}},
        "steps": [{"name": "press", "duration": 2, "dt": {"initial": 0.1}, "stabilize": 1e-3,
                   "supports": [{"on": "block_top", "ux": 0, "uy": 0}, {"on": "aside", "ux": 0, "uy": 0}, {"on": "tool", "ux": 0, "angle": 0}],
                   "loads": [{"on": "tool", "force": {"y": 1}}]}],
    }));
    let [node, _] = model.mesh.rigid_bodies[0].nodes();
    close("c₀", model.steps[0].stabilization[2 * node + 1], 0.2, 1e-12);
}
