//! Earthquake cycles against the community's: SEAS BP3-QD, thrust under 60°, the boundary-element answer FDRA (C. Cattania, 25 m
//! cells, 2020) at 7.5 km down dip: an event is V > 0.1 m/s there, its slip what slips while V > 1e-6 m/s; a year has 365 days.

use std::sync::Arc;

use crate::common::model_at;

use fecontact::model::scheme::Scheme;
use fecontact::run::Simulation;
use serde_json::{Value, json};

#[path = "../../meshes/dipping_fault.rs"]
#[allow(dead_code, reason = "its command is not called")]
mod dipping_fault;

use dipping_fault::Fault;

const YEAR: f64 = 365.0 * 86400.0;
/// The first four events: years since the one before, slip [m], fastest rate [m/s].
const EVENTS: [[f64; 3]; 4] =
    [[177.221, 1.0584, 0.4432], [100.311, 3.3735, 0.7860], [56.999, 2.3654, 0.6145], [87.013, 2.6090, 0.8041]];
/// The cycle that all comes to (events 14 to 16 and 13).
const CYCLE: [[f64; 3]; 4] =
    [[97.516, 2.9783, 1.0794], [63.355, 2.3342, 0.5844], [87.175, 2.5983, 0.7951], [91.179, 2.7850, 0.6517]];

/// An event at the station.
#[derive(Clone, Copy, Debug, Default)]
struct Event {
    /// [yr]
    time: f64,
    /// since the one before [yr]
    interval: f64,
    /// [m]
    slip: f64,
    /// [m/s]
    rate: f64,
}

/// Run cycles on a fault for some years, results after `every` steps; returns the events, and steps taken.
fn events(fault: Fault, years: f64, every: usize) -> (Vec<Event>, usize) {
    let text = fault.case(years, &format!(", \"every\": {every}"));
    events_of(&serde_json::from_str(&text).expect("a case"), fault)
}

/// Run a case on a fault.
fn events_of(case: &Value, fault: Fault) -> (Vec<Event>, usize) {
    let folder = tempfile::TempDir::new().expect("a folder");
    std::fs::write(folder.path().join("bp3.msh"), fault.mesh()).expect("a mesh");
    let model = Arc::new(model_at(case, &folder.path().join("bp3.json")));
    let pair = &model.contacts[0];
    let down_dip = |k: usize| {
        let [x, y] = [0, 1].map(|i| model.mesh.nodes[pair.points[k].position[0].0][i]);
        x.hypot(y)
    };
    let station = (0..pair.points.len()).min_by(|a, b| {
        let [a, b] = [a, b].map(|k| (down_dip(*k) - 7500.0).abs());
        a.total_cmp(&b)
    });
    let station = station.expect("a point");
    let mut run = Simulation::new(model.clone());
    let mut events: Vec<Event> = Vec::new();
    // Slip at which the station last came to slip faster than 1e-6 m/s, and whether it has been faster than 0.1 since
    let (mut started, mut fast) = (None, false);
    let (mut before, mut time) = (0.0, 0.0);
    while run.next_increment().unwrap_or_else(|error| panic!("{error}")).is_some() {
        let state = &run.state().contacts[0][station];
        let slip = state.friction.plastic_slip.abs();
        // Quasi-dynamic steps know the rate at their end, others its mean.
        let rate = match &model.steps[0].scheme {
            Scheme::QuasiDynamic { .. } => (state.radiation / pair.radiation).abs(),
            _ => (slip - before).abs() / (run.state().time - time),
        };
        if rate > 1e-6 && started.is_none() {
            started = Some(before);
        }
        if rate > 0.1 && !fast {
            fast = true;
            let time = run.state().time / YEAR;
            let interval = time - events.last().map_or(0.0, |event: &Event| event.time);
            events.push(Event { time, interval, ..Event::default() });
        }
        if let Some(last) = events.last_mut().filter(|_| fast) {
            last.rate = last.rate.max(rate);
            last.slip = slip - started.unwrap_or(slip);
        }
        if rate < 1e-6 {
            (started, fast) = (None, false);
        }
        (before, time) = (slip, run.state().time);
    }
    let energy = &run.state().energy;
    assert!(energy.error().abs() < 1e-3 * energy.friction_dissipation, "{energy:?}");
    (events, run.report().increments)
}

/// In 800 km of rock to both sides and down.
fn thrust(size: f64) -> Fault {
    Fault { dip: 60f64.to_radians(), sense: 1.0, size, reach: 800e3, quadratic: false }
}

fn share(value: f64, expected: f64) -> f64 {
    value / expected - 1.0
}

/// Intervals, slips and rates of some events within a share of the reference's: short intervals, all others, fastest rates.
fn compare(found: &[Event], expected: &[[f64; 3]; 4], [of_short, of_others, of_rates]: [f64; 3]) {
    for (event, [interval, slip, rate]) in found.iter().zip(expected) {
        let allowed = if *interval < 90.0 { of_short } else { of_others };
        assert!(share(event.interval, *interval).abs() < allowed, "interval {interval}: {event:?}");
        assert!(share(event.slip, *slip).abs() < allowed, "slip {slip}: {event:?}");
        assert!(share(event.rate, *rate).abs() < of_rates, "rate {rate}: {event:?}");
    }
}

/// The last cycle of four, from its longest interval on; the one before it is the same.
fn last_cycle(events: &[Event]) -> &[Event] {
    let longest_first = |k: &usize| events[k + 1..k + 4].iter().all(|event| event.interval < events[*k].interval);
    let begin = (4..=events.len() - 4).rev().find(longest_first).expect("a cycle of four");
    for (now, before) in events[begin..begin + 4].iter().zip(&events[begin - 4..]) {
        assert!(share(now.interval, before.interval).abs() < 0.01, "no cycle of four: {events:?}");
    }
    &events[begin..begin + 4]
}

/// Between the last node with friction and the first without slip goes over by the shape functions of the edge: what its first end
/// stands for ends at 40 km, where prescribed slip begins.
#[test]
fn friction_ends_at_40_km() {
    for (quadratic, share) in [(false, 0.5), (true, 1.0 / 6.0)] {
        for size in [50.0, 100.0, 200.0] {
            let fault = Fault { quadratic, ..thrust(size) };
            // The rows of ends of edges: quadratic edges have a node in the middle.
            let ends: Vec<f64> = fault.depths().into_iter().step_by(1 + usize::from(quadratic)).collect();
            let first = ends.iter().position(|s| *s > 40e3).expect("prescribed slip");
            let border = ends[first - 1] + share * (ends[first] - ends[first - 1]);
            assert!((border - 40e3).abs() < 1e-6, "{border}");
            assert!(ends[..=first].windows(2).all(|pair| share_of_size(pair, &fault) < 0.01), "even spacing");
        }
    }
}

/// How far the distance of two rows is from that asked for.
fn share_of_size(pair: &[f64], fault: &Fault) -> f64 {
    share(pair[1] - pair[0], fault.size * (1.0 + f64::from(u8::from(fault.quadratic)))).abs()
}

/// The first event on a fault.
fn first_event(fault: Fault) {
    let (events, _) = events(fault, 180.0, 50);
    println!("{events:.3?}");
    assert_eq!(events.len(), 1, "{events:?}");
    assert!(share(events[0].time, EVENTS[0][0]).abs() < 0.01, "{events:?}");
}

/// On nodes every 200 m.
#[test]
fn the_first_event_of_a_thrust() {
    first_event(thrust(200.0));
}

/// On quadratic elements of that size.
#[test]
#[ignore = "docs/validation/bp3.md: seconds"]
fn the_first_event_on_quadratic_elements() {
    first_event(Fault { quadratic: true, ..thrust(100.0) });
}

/// A fault, the tolerance of the integration, and how far events may be from the reference's (see [`compare`]).
struct Run {
    fault: Fault,
    tolerance: f64,
    allowed: [f64; 3],
}

/// 1500 years on nodes every 100 and 50 m, in other rock, with another tolerance and on quadratic elements: the first four events,
/// and the cycle of four in its order.
#[test]
#[ignore = "docs/validation/bp3.md; half an hour"]
fn cycles_of_a_thrust() {
    println!("docs/validation/bp3.md\n");
    let (coarse, fine) = ([0.03, 0.04, 0.15], [0.03, 0.03, 0.1]);
    let at_50 = thrust(50.0);
    let runs = [
        Run { fault: thrust(100.0), tolerance: 1e-5, allowed: coarse },
        Run { fault: thrust(100.0), tolerance: 1e-6, allowed: coarse },
        Run { fault: at_50, tolerance: 1e-5, allowed: fine },
        Run { fault: Fault { reach: 400e3, ..at_50 }, tolerance: 1e-5, allowed: fine },
        Run { fault: Fault { quadratic: true, ..at_50 }, tolerance: 1e-5, allowed: fine },
    ];
    let row = |what: &str, first: f64, cycle: &[[f64; 3]], steps: &str| {
        let list = |i: usize, digits: usize| {
            cycle.iter().map(|event| format!("{:.digits$}", event[i])).collect::<Vec<_>>().join(", ")
        };
        println!("| {what} | {first:.2} | {} | {} | {} | {steps} |", list(0, 2), list(1, 3), list(2, 3));
    };
    println!(
        "| nodes, rock, tolerance | first [yr] | cycle [yr] | slip [m] | fastest [m/s] | steps |\n|---|---|---|---|---|---|"
    );
    row("FDRA, 25 m", EVENTS[0][0], &CYCLE, "");
    for Run { fault, tolerance, allowed } in runs {
        let mut case: Value = serde_json::from_str(&fault.case(1500.0, ", \"every\": 10")).expect("a case");
        case["steps"][0]["scheme"]["quasi_dynamic"]["tolerance"] = json!(tolerance);
        let (events, steps) = events_of(&case, fault);
        let cycle = last_cycle(&events);
        let numbers: Vec<[f64; 3]> = cycle.iter().map(|event| [event.interval, event.slip, event.rate]).collect();
        let kind = if fault.quadratic { " (quadratic)" } else { "" };
        let what = format!("{} m{kind}, {} km, {tolerance:e}", fault.size, fault.reach / 1e3);
        row(&what, events[0].time, &numbers, &steps.to_string());
        assert!(share(events[0].time, EVENTS[0][0]).abs() < 0.01, "first event {:?}", events[0]);
        compare(cycle, &CYCLE, allowed);
        if fault.size < 100.0 {
            compare(&events[..4], &EVENTS, allowed);
        }
    }
}

/// The first event by static increments with radiation damping, and with inertia while it lasts: explicit increments. Both in
/// 200 km of rock on nodes every 200 m, as the quasi-dynamic run beside them.
#[test]
#[ignore = "docs/validation/bp3.md: minutes"]
fn the_first_event_with_inertia() {
    let fault = Fault { reach: 200e3, ..thrust(200.0) };
    let quasi_dynamic = events(fault, 185.0, 10).0[0];
    let mut case: Value = serde_json::from_str(&fault.case(185.0, "")).expect("JSON");
    case["steps"][0]["scheme"] = json!("static");
    case["steps"][0]["dt"] = json!({"initial": 1e5, "min": 1e-3, "max": 2.0 * YEAR, "error": 1e-4});
    case["steps"][0]["rupture"] = json!({"slip_rate": 0.01});
    let (dynamic, increments) = events_of(&case, fault);
    println!("quasi-dynamic {quasi_dynamic:.3?}\nwith inertia {:.3?}, {increments} increments", dynamic[0]);
    // Static increments are of the first order, and decades of them come 4.4 % early.
    assert!(share(dynamic[0].time, quasi_dynamic.time).abs() < 0.05);
    assert!(dynamic[0].slip > 2.0 * quasi_dynamic.slip && dynamic[0].rate > quasi_dynamic.rate);
}
