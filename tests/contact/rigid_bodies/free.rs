//! Rigid bodies that are free under forces.

use super::*;

/// A slope rises below a point under its weight: q = W sin θ/A and p = W cos θ/A, until tan θ = μ, beyond which nothing holds it.
#[test]
fn a_slope_rises_until_what_lies_on_it_slides() {
    let (weight, area) = (3.0, 0.7);
    let case = |end: f64| {
        json!({
            "mesh": {"nodes": [[0.4, 0]], "points": {"p": [0]}},
            "rigid_bodies": {"slope": {"reference": [-1, -0.5]}},
            "contacts": {"c": {"slave": "p", "area": area, "rigid_body": "slope", "normal": {"alpha_n": 1e5},
                "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
                "friction": {"law": "coulomb", "mu": MU, "alpha_t": 1e5}}},
            "newton": {"tolerance": 1e-12},
            "steps": [
                {"name": "press", "duration": 1, "dt": {"initial": 0.5}, "loads": [{"on": "p", "force": {"y": -weight}}],
                 "supports": [{"on": "p", "ux": 0}, {"on": "slope", "ux": 0, "uy": 0, "angle": 0}]},
                {"name": "tilt", "duration": 1, "dt": {"initial": 0.0625, "min": 1e-4},
                 "supports": [{"on": "p", "ux": null}, {"on": "slope", "angle": end}]}
            ]
        })
    };
    let held = finish(&case(0.28));
    for state in held.states.iter().filter(|state| state.time > 1.0) {
        let angle = 0.28 * (state.time - 1.0);
        let friction = state.contacts[0][0].friction.clone();
        close("p", friction.pressure * area, weight * angle.cos(), 1e-9);
        // Downhill is to −x, where −s points.
        close("q", friction.traction * area, -weight * angle.sin(), 1e-9);
    }
    let (critical, steep) = (MU.atan(), 0.4);
    let mut record = Record::default();
    let (_, result) = run(&Arc::new(model(&case(steep))), &mut [&mut record]);
    assert!(result.is_err(), "nothing holds it on a slope of 0.4");
    let last = steep * (record.states.last().expect("states").time - 1.0);
    assert!(last <= critical && critical - last < 2e-4 * steep, "it stayed until {last}, and μ is that of {critical}");
}

/// A disk under a force sinks in as deep as that force presses it that is prescribed: the way there does not matter without friction.
#[test]
fn a_disk_sinks_in_under_its_force() {
    let force = 6.0;
    let contact = || Contact::new("base", "block_bottom", disk(), FrictionParameters::Frictionless {});
    let base = || block(true, contact().rigid_body("tool")).rigid_body("tool", [0.0, -3.0]);
    let press = || {
        let path = Support::on("tool").ux(0.0).uy(0.02).angle(0.0);
        LoadStep::new("press", 1.0).dt(0.25).fix("block_top").support(path)
    };
    let free = Support { uy: Some(Change::End), ..Support::on("tool") };
    let load = LoadStep::new("load", 1.0).dt(0.125).support(free).load(Load::force("tool", [0.0, force]));
    let loaded = run_through(base().step(press()).step(load));
    let (state, tool) = (loaded.last(), loaded.nodes("tool")[0]);
    close("no reaction", loaded.reaction("tool", state)[1], 0.0, 1e-10);
    close("the top bears it", loaded.reaction("block_top", state)[1], -force, 1e-8);
    let deep = state.displacement[2 * tool + 1];
    assert!(deep > 0.02, "{deep}");
    let on = LoadStep::new("press on", 1.0).dt(0.125).support(Support::on("tool").uy(deep));
    let pressed = run_through(base().step(press()).step(on));
    close("the force of that depth", pressed.reaction("tool", pressed.last())[1], force, 1e-8);
}

/// A roller of radius 2 below a point that presses on it and is held along x: under a moment M it turns until friction bears that,
/// q A arm = M at the slip R θ = q/α_t.
#[test]
fn a_roller_turns_under_a_moment() {
    let (weight, area, alpha_n, alpha_t, radius, moment) = (3.0, 0.7, 2e3, 1e3, 2.0, 1.2);
    let run = on_roller(
        [weight, area, alpha_n, alpha_t, radius],
        json!({"name": "turn", "duration": 1, "dt": {"initial": 0.25},
        "supports": [{"on": "roller", "angle": null}], "loads": [{"on": "roller", "moment": moment}]}),
    );
    let (state, arm) = (run.last(), radius - weight / area / alpha_n);
    let q = moment / (area * arm);
    close("q", state.contacts[0][0].friction.traction, q, 1e-9);
    let x = run.model.configuration(&state.displacement);
    close("angle", run.model.mesh.rigid_bodies[0].angle(&x), q / alpha_t / radius, 1e-10);
    close("no reaction", moment_of_tool(&run, state), 0.0, 1e-10);
}

/// A disk flies, turns not, and meets a point aside of its path; both go on freely. Momentum and angular momentum stay, and
/// what friction takes is all that is lost; in implicit and explicit steps alike.
#[test]
fn a_disk_and_a_point_keep_their_momentum() {
    let (masses, inertia, area) = ([0.5, 2.0], 3.0, 0.1);
    let velocities = [Vector2::new(0.5, -0.4), Vector2::new(0.3, 0.6)];
    for scheme in [json!({"newmark": {}}), json!({"explicit": {}})] {
        let case = json!({
            "mesh": {"nodes": [[0.4, 1.25]], "points": {"p": [0]}},
            "rigid_bodies": {"disk": {"reference": [0, 0], "inertia": inertia}},
            "point_masses": {"p": {"mass": masses[0], "velocity": [velocities[0].x, velocities[0].y]},
                "disk": {"mass": masses[1], "velocity": [velocities[1].x, velocities[1].y]}},
            "contacts": {"c": {"slave": "p", "area": area, "rigid_body": "disk", "normal": {"alpha_n": 2e3},
                "master": {"circle": {"centre": [0, 0], "radius": 1.2}},
                "friction": {"law": "coulomb", "mu": MU, "alpha_t": 1e3}}},
            "steps": [{"name": "fly", "duration": 0.5, "scheme": scheme, "dt": {"initial": 5e-4}}],
            "output": {"interval": 0.01}
        });
        let run = finish(&case);
        let (p, disk) = (run.nodes("p")[0], run.nodes("disk")[0]);
        let body = run.model.mesh.rigid_bodies[0].clone();
        let momenta = |state: &State| {
            let x = run.model.configuration(&state.displacement);
            let of = |node: usize, mass: f64| {
                let v = Vector2::new(state.velocity[2 * node], state.velocity[2 * node + 1]) * mass;
                (v, x.at(node).perp(&v))
            };
            let ([a, b], spin) =
                ([of(p, masses[0]), of(disk, masses[1])], state.velocity[2 * body.turning] / body.radius);
            (a.0 + b.0, a.1 + b.1 + inertia * spin, spin)
        };
        let (first, last) = (velocities[0] * masses[0] + velocities[1] * masses[1], run.last());
        let (momentum, angular, spin) = momenta(last);
        assert!(spin.abs() > 1e-2, "{scheme}: friction turns the disk, {spin}");
        close(&format!("{scheme}: momentum"), (momentum - first).norm(), 0.0, 1e-8);
        let start = Vector2::new(0.4, 1.25).perp(&(velocities[0] * masses[0]));
        close(&format!("{scheme}: angular momentum"), angular, start, 1e-8);
        assert!(last.contacts[0][0].friction.pressure == 0.0, "{scheme}: they part");
        let energy = last.energy;
        assert!(energy.friction_dissipation > 1e-3, "{scheme}: {energy:?}");
        close(&format!("{scheme}: energy"), energy.error(), 0.0, 5e-3 * energy.initial);
    }
}

/// What turns by itself in a static step must be held by something, and in motion needs inertia.
#[test]
fn free_rigid_bodies_need_something_that_holds_them() {
    let tool = || block(true, on(plane()).rigid_body("tool")).rigid_body("tool", [0.0, -1.0]);
    let step = || LoadStep::new("press", 1.0).dt(0.5).fix("block_top");
    let newmark = || step().scheme(Scheme::Newmark { beta: 0.25, gamma: 0.5 });
    let refused = |builder: Builder, message: &str| {
        let error = builder.build().map(|_| ()).expect_err(message).to_string();
        assert!(error.contains(message), "{error}, expected {message}");
    };
    refused(
        tool().rigid_body("idle", [0.0, 0.0]).step(step().support(Support::on("idle").ux(0.0).angle(0.0))),
        "nothing touches the rigid body `idle`, and its uy is free",
    );
    refused(
        tool().step(newmark().support(Support::on("tool").ux(0.0).uy(0.0))),
        "rigid_bodies.tool.inertia: is missing",
    );
    refused(tool().step(newmark().support(Support::on("tool").ux(0.0).angle(0.0))), "point_masses.tool: is missing");
    // A plane without a block on it: what it lacks is told when it is solved.
    let lifted = MasterSide::Plane { point: [0.0, -0.5], normal: [0.0, 1.0] };
    let model = block(true, on(lifted).rigid_body("tool"))
        .rigid_body("tool", [0.0, -1.0])
        .step(step().support(Support::on("tool").ux(0.0).angle(0.0)))
        .build()
        .expect("a model");
    let (_, result) = run(&Arc::new(model), &mut []);
    let message = result.expect_err("a free body").to_string();
    assert!(message.contains("rigid body `tool` along y"), "{message}");
}

/// The disk of `cases/indenter.json`: pressed in, its forces are those of the base; dragged, it slides everywhere, Q = μ N; rolling, hardly.
#[test]
fn an_indenter_is_pressed_in_dragged_and_rolls() {
    let path = crate::common::repository("cases/indenter.json");
    let case: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(&path).expect("the case")).expect("a case");
    let run = finish_at(&case, &path);
    for state in &run.states {
        let [disk, base] = ["disk", "base"].map(|name| run.reaction(name, state));
        (0..2).for_each(|i| close("in balance", disk[i], -base[i], 1e-5));
    }
    // An increment that is cut ends before a whole time, and so may those after it.
    let away = |state: &State, time: f64| (state.time - time).abs();
    let ratio = |time: f64| {
        let nearest = run.states.iter().min_by(|a, b| away(a, time).total_cmp(&away(b, time))).expect("a state");
        let [normal, tangential] = run.contact_force(nearest);
        assert!(normal > 1.0, "N = {normal} at {time}");
        tangential / normal
    };
    close("dragged", ratio(3.0).abs(), MU, 1e-3);
    // Material that has not slid since comes into contact as far as the disk has rolled on.
    assert!(ratio(5.0).abs() < 0.8 * MU && ratio(5.0).abs() < ratio(4.0).abs(), "rolling: {}", ratio(5.0));
    let energy = run.last().energy;
    close("energy", energy.error(), 0.0, 0.02 * energy.supplied());
}

/// History has the motion of a rigid body, and the force and moment that move it, whether it is watched or not.
#[test]
fn history_tells_of_rigid_bodies() {
    let contact = on(plane()).rigid_body("tool");
    let step =
        LoadStep::new("press", 1.0).dt(0.5).fix("block_top").support(Support::on("tool").ux(0.01).uy(0.03).angle(0.02));
    let model = Arc::new(block(true, contact).rigid_body("tool", [0.0, -1.0]).step(step).build().expect("a model"));
    let folder = tempfile::tempdir().expect("a folder");
    let mut history = History::create(folder.path(), &model).expect("a history");
    let (_, result) = run(&model, &mut [&mut history]);
    result.expect("a run");
    let text = std::fs::read_to_string(folder.path().join("history.csv")).expect("a table");
    let header: Vec<&str> = text.lines().next().expect("a header").split(',').collect();
    let last: Vec<&str> = text.lines().last().expect("a row").split(',').collect();
    let value = |name: &str| -> f64 {
        let at = header.iter().position(|column| *column == name).unwrap_or_else(|| panic!("no {name} in {header:?}"));
        last[at].parse().expect("a number")
    };
    close("ux", value("tool.ux"), 0.01, 1e-12);
    close("angle", value("tool.angle"), 0.02, 1e-12);
    close("fy", value("tool.fy"), value("base.force_y"), 1e-8);
    close("fx", value("tool.fx"), value("base.force_x"), 1e-8);
    // The moment on the block is about (0, 0), that on the tool about (0.01, −0.97).
    let [fx, fy] = ["base.force_x", "base.force_y"].map(value);
    let shifted =
        value("base.moment") + (Vector2::new(0.0, 0.0) - Vector2::new(0.01, -0.97)).perp(&Vector2::new(fx, fy));
    close("moment", value("tool.moment"), shifted, 1e-8);
}
