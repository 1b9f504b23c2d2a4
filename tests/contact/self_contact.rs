//! A surface that touches itself: a slotted ring squeezed until its lips meet, a tube pressed flat.

use std::f64::consts::PI;

use crate::common::{Blocks, Finished, close, distance, finish, finish_at};
use crate::contact::INCREMENT;
use fecontact::contact::master::Master;
use fecontact::contact::pair::{ContactIncrement, Prediction};
use fecontact::contact::response::PairResponse;
use fecontact::contact::search::Index;
use fecontact::contact::surface::{Surface, gauss_points};
use fecontact::laws::friction::Regime;
use fecontact::linear::system::Request;
use fecontact::mesh::configuration::Configuration;
use nalgebra::Vector2;
use serde_json::{Value, json};

const METHODS: [&str; 3] = ["gauss_to_segment", "node_to_segment", "mortar"];

/// A ring of radii 1 and 1.3 with a slot of width 0.1 at its left, whose lips have nodes that do not match. `north` and
/// `south` are nodes outside at the top and the bottom; `lips` and `surface` are its edges along the slot and all round.
fn slotted_ring() -> Value {
    let [across, around] = [4, 48];
    let map = |s: f64, t: f64| {
        let radius = 1.0 + 0.3 * s.powf(1.0 + 0.3 * t);
        let angle = (2.0 * t - 1.0) * (PI - (0.05 / radius).asin());
        [radius * angle.cos(), radius * angle.sin()]
    };
    let mut mesh = Blocks::default().block("ring", [across, around], map).json();
    let joined = |sides: &[&str]| -> Value {
        sides.iter().flat_map(|side| mesh["edges"][format!("ring_{side}")].as_array().expect("edges").clone()).collect()
    };
    let (lips, surface) = (joined(&["bottom", "top"]), joined(&["bottom", "right", "top", "left"]));
    mesh["edges"]["lips"] = lips;
    mesh["edges"]["surface"] = surface;
    let outside = |quarter: usize| quarter * around / 4 * (across + 1) + across;
    mesh["points"] = json!({"south": [outside(1)], "north": [outside(3)]});
    mesh
}

/// The ring squeezed between its outermost nodes at top and bottom until the lips carry a part of the load.
fn squeezed(contacts: Value) -> Finished {
    finish(&json!({
        "mesh": slotted_ring(),
        "bodies": {"ring": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}}},
        "contacts": contacts,
        "newton": {"tolerance": 1e-11},
        "steps": [{"name": "squeeze", "duration": 1, "dt": {"initial": 0.1}, "supports": [
            {"on": "north", "ux": 0, "uy": -0.042}, {"on": "south", "ux": 0, "uy": 0.042}]}],
    }))
}

fn contact(slave: &str, master: &str, method: &str, alpha_n: f64) -> Value {
    json!({"slave": slave, "master": master, "method": method, "normal": {"alpha_n": alpha_n},
           "friction": {"law": "coulomb", "mu": 0.2, "alpha_t": 0.5 * alpha_n}})
}

fn against_itself(group: &str, method: &str) -> Finished {
    squeezed(json!({"lips": contact(group, group, method, 4e4)}))
}

/// One group against itself is two contacts between its halves, each with half the stiffnesses: the displacements agree to
/// Newton's tolerance without friction. With it they agree but for the slip of points that close in an increment, which
/// counts from when they touch: the two contacts judge that by half the pressure each. One pass with all of the stiffness agrees within the error of the discretization. What squeezes the
/// ring from above does so from below.
#[test]
fn lips_that_close_are_two_surfaces_in_contact() {
    for method in METHODS {
        let rough = json!({"law": "coulomb", "mu": 0.2, "alpha_t": 1e4});
        let two = |friction: &Value| {
            let mut contacts = json!({"up": contact("ring_bottom", "ring_top", method, 2e4),
                                      "down": contact("ring_top", "ring_bottom", method, 2e4)});
            contacts["up"]["friction"] = friction.clone();
            contacts["down"]["friction"] = friction.clone();
            squeezed(contacts)
        };
        let frictionless = json!({"law": "frictionless"});
        let mut smooth = json!({"lips": contact("lips", "lips", method, 4e4)});
        smooth["lips"]["friction"] = frictionless.clone();
        let off = distance(&squeezed(smooth).last().displacement, &two(&frictionless).last().displacement);
        close("displacement without friction", off, 0.0, 1e-9);
        let (own, both) = (against_itself("lips", method), two(&rough));
        let one = squeezed(json!({"up": contact("ring_bottom", "ring_top", method, 4e4)}));
        let [force, _] = own.contact_force(own.last());
        let [single, _] = one.contact_force(one.last());
        let off = distance(&own.last().displacement, &both.last().displacement);
        let [north, south] = ["north", "south"].map(|on| own.reaction(on, own.last())[1]);
        println!(
            "{method}: force {force:.5}, one pass {single:.5}; two contacts off by {off:.1e}; squeezed by {north:.5} {south:.5}; iterations {:?}",
            own.iterations
        );
        assert!(force > 0.2 * south && own.report.cutbacks == 0);
        assert!(own.iterations.iter().all(|&n| n <= 12), "{:?}", own.iterations);
        close("displacement", off, 0.0, 1e-3 * 0.042);
        close("one pass", single, force, 0.02 * force);
        close("one pass, squeezed by", one.reaction("south", one.last())[1], south, 4e-3 * south);
        close("balance", north + south, 0.0, 1e-7 * south);
    }
}

/// All of the ring's surface against itself is its lips against each other: nothing on the way round meets its neighbours,
/// the other side of the ring or the other side of the wall. (Mortar averages over the edges next to the slot as well, of
/// which slivers lie in the other lip.)
#[test]
fn a_whole_surface_touches_itself_at_the_lips_only() {
    for method in METHODS {
        let [lips, all] = ["lips", "surface"].map(|group| against_itself(group, method));
        let x = all.model.configuration(&all.last().displacement);
        for (point, state) in all.model.contacts[0].points.iter().zip(&all.last().contacts[0]) {
            let at = point.at(&x);
            assert!(
                state.regime() == Regime::Open || (at.x < -0.9 && at.y.abs() < 0.2),
                "{method}: closed at {}, {}: {state:?}",
                at.x,
                at.y
            );
        }
        let [expected, found] = [&lips, &all].map(|run| run.reaction("south", run.last())[1]);
        println!("{method}: squeezed by {expected:.6} against the lips, {found:.6} against the whole surface");
        close(method, found, expected, 1e-3 * expected);
    }
}

/// The tangent of all points of the ring's surface together, against central differences of their forces.
#[test]
fn tangent_of_self_contact_equals_differences() {
    for method in METHODS {
        let closed = compare_tangent(&against_itself("surface", method), method);
        assert!(closed >= 4, "{closed} closed points");
    }
}

/// Compares the tangent of all points of the first contact together, along one direction in the last increment, with central differences of
/// their forces; returns the number of points that act.
pub fn compare_tangent(run: &Finished, what: &str) -> usize {
    let pair = &run.model.contacts[0];
    let [old, new] = [&run.states[run.states.len() - 2], run.last()];
    let before = run.model.configuration(&old.displacement);
    let respond = |u: &[f64]| {
        let during = ContactIncrement { dt: 0.1, ..INCREMENT };
        let is_predicted = |_| Prediction::default();
        let (x, mut response) = (run.model.configuration(u), PairResponse::default());
        pair.respond(&old.contacts[0], [&before, &x], during, is_predicted, Request::Tangent, &mut response)
            .expect("an answer");
        response
    };
    let forces = |u: &[f64]| {
        let mut sum = vec![0.0; u.len()];
        for (_, closed) in respond(u).all_acting() {
            for (a, &node) in closed.nodes.iter().enumerate() {
                (0..2).for_each(|i| sum[2 * node + i] += closed.force[2 * a + i]);
            }
        }
        sum
    };
    let u = &new.displacement;
    let direction: Vec<f64> = (0..u.len()).map(|dof| [0.3, 1.0, -0.7, 0.4, -0.2, 0.9, 0.5][dof % 7]).collect();
    let mut along = vec![0.0; u.len()];
    let mut closed_points = 0;
    for (_, closed) in respond(u).all_acting() {
        let dofs: Vec<usize> = closed.nodes.iter().flat_map(|&node| [2 * node, 2 * node + 1]).collect();
        for (row, &dof) in dofs.iter().enumerate() {
            along[dof] += dofs
                .iter()
                .enumerate()
                .map(|(k, &other)| closed.tangent[row + k * dofs.len()] * direction[other])
                .sum::<f64>();
        }
        closed_points += 1;
    }
    let h = 1e-7;
    let moved = |h: f64| forces(&u.iter().zip(&direction).map(|(u, d)| u + h * d).collect::<Vec<_>>());
    let differences: Vec<f64> = moved(h).iter().zip(moved(-h)).map(|(up, down)| (up - down) / (2.0 * h)).collect();
    let scale = along.iter().fold(0.0f64, |most, value| most.max(value.abs()));
    let off = distance(&along, &differences);
    println!("{what}: {closed_points} closed points, off by {:.1e}", off / scale);
    close("tangent", off, 0.0, 1e-6 * scale);
    closed_points
}

/// `cases/tube.json`: a tube on a plate, pressed against a bar until its inside touches itself. The plate carries what the
/// bar presses with; the upper wall is held off the lower one, on both sides of the middle alike; hardly an increment is hard.
#[test]
fn a_tube_pressed_flat_touches_itself() {
    let path = crate::common::repository("cases/tube.json");
    let case = serde_json::from_str(&std::fs::read_to_string(&path).expect("a case")).expect("JSON");
    let run = finish_at(&case, &path);
    let x = run.model.configuration(&run.last().displacement);
    let pair = |name: &str| {
        let number = run.model.contacts.iter().position(|pair| pair.name == name).expect("a contact of the case");
        run.model.contacts[number].points.iter().zip(&run.last().contacts[number])
    };
    let (mut force, mut moment, mut deepest) = (0.0, 0.0, 0.0f64);
    for (point, state) in pair("inside").filter(|(_, state)| state.friction.pressure > 0.0) {
        let share = point.current_length(&x) * state.friction.pressure;
        force += share;
        moment += share * point.at(&x).x;
        deepest = deepest.max(-state.gap / point.edge_length(&x).expect("an edge"));
    }
    // Both walls bear the same pressure at the middle. With the stiffer penalty that is chosen by default every other point of the upper one opens.
    let [low, up] = [true, false].map(|low| {
        let of_wall = pair("inside").filter(|(point, _)| (point.at(&run.model.mesh.undeformed()).y < 10.0) == low);
        of_wall.map(|(_, state)| state.friction.pressure).fold(0.0, f64::max)
    });
    close("pressure on the upper wall", up, low, 0.05 * low);
    let [_, plate] = run.reaction("plate_bottom", run.last());
    println!("plate {plate:.6}, inside {force:.6} at x = {:.1e}, {deepest:.1e} of an edge deep", moment / force);
    assert!(force > 0.5 * plate && deepest < 0.03);
    close("symmetry", moment / force, 0.0, 0.02);
    assert!(run.report.cutbacks <= 3, "{} cut", run.report.cutbacks);
    assert!(run.iterations.iter().all(|&n| n <= 20), "{:?}", run.iterations);
    // Between the bar and the inside, and between the inside and the plate, the walls are cut free: each carries it all.
    let number = run.model.contacts.iter().position(|pair| pair.name == "bar").expect("a contact of the case");
    let [old, new] = [&run.states[run.states.len() - 2], run.last()];
    let [before, x] = [old, new].map(|state| run.model.configuration(&state.displacement));
    let during = ContactIncrement { dt: new.dt, ..INCREMENT };
    let nothing = |_| Prediction::default();
    let (states, mut answer) = (&old.contacts[number], PairResponse::default());
    run.model.contacts[number]
        .respond(states, [&before, &x], during, nothing, Request::Residual, &mut answer)
        .expect("an answer");
    let bar: f64 = answer.all_acting().map(|(_, closed)| closed.force.iter().skip(1).step_by(2).sum::<f64>()).sum();
    close("the bar presses", bar, plate, 1e-6 * plate);
}

/// A strip folded to a spiral of two turns, each point of which lies before the next turn: the foot that the tree finds is the
/// nearest of all segments that the point may meet, found here by going through all.
#[test]
fn the_search_finds_what_going_through_all_segments_finds() {
    let n = 400;
    let spiral = |k: usize, outer: bool| {
        let angle = 4.0 * PI * k as f64 / n as f64;
        let radius = 1.0 + 0.1 * angle + if outer { 0.2 } else { 0.0 };
        Vector2::new(radius * angle.cos(), radius * angle.sin())
    };
    // Round the strip with the body on the left: outside there, inside back.
    let mut x: Vec<Vector2<f64>> = (0..=n).map(|k| spiral(k, true)).collect();
    x.extend((0..=n).rev().map(|k| spiral(k, false)));
    let edges: Vec<Vec<usize>> = (0..x.len()).map(|k| vec![k, (k + 1) % x.len()]).collect();
    let depth = 0.02;
    let master = Master::Mesh(Surface::new(&edges).against_itself(depth));
    let Master::Mesh(surface) = &master else { unreachable!() };
    let at = Configuration::undeformed(&x);
    let index = Index::new(&master, &at);
    let mut met = 0;
    for slave in gauss_points(&edges, 2) {
        let (point, outward) = (slave.at(&at), slave.outward(&at).expect("a point of an edge"));
        let own: Vec<usize> = slave.position.iter().map(|&(node, _)| node).collect();
        let distance = |k: usize| {
            let [a, b] = surface.segments[k].ends.map(|node| x[node]);
            let xi = ((point - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
            (point - a - (b - a) * xi).norm()
        };
        let may = |k: &usize| {
            let [a, b] = surface.segments[*k].ends;
            let along = (x[b] - x[a]).normalize();
            let normal = Vector2::new(-along.y, along.x);
            normal.dot(&outward) < -0.1
                && normal.dot(&(point - x[a])) > -depth
                && !own.contains(&a)
                && !own.contains(&b)
        };
        let nearest = (0..edges.len()).filter(may).min_by(|&j, &k| distance(j).total_cmp(&distance(k)));
        let found = index.project(&slave, None, &at);
        met += usize::from(found.is_some());
        match (nearest, found) {
            (Some(k), Some(found)) => close("distance", found.gap.abs(), distance(k), 1e-12),
            (None, found) => assert!(found.is_none()),
            // Past the end of what is seen, through the strip.
            (Some(k), None) => assert!(distance(k) > 0.2, "{point}: segment {k} at {} was not found", distance(k)),
        }
    }
    println!("{met} points meet something");
    assert!(met > n);
}
