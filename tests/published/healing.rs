//! Two ruptures of one interface, which heals between them: the problem and the tables of `docs/healing_benchmark.md`.
//!
//! What is compared does not come from elsewhere: meshes with each other, explicit increments with implicit ones, and the
//! interface that heals with one that does not.

use std::sync::Arc;

use crate::common::{self, Blocks};
use fecontact::model::Model;
use fecontact::run::run;
use fecontact::run::{Attempt, Error, Observer};
use serde_json::{Value, json};

/// Slip rate of an arrival [m/s]
const THRESHOLD: f64 = 0.05;
/// Begin and end of the two events [s]
const EVENTS: [[f64; 2]; 2] = [[0.0, 5.0], [10.0, 15.0]];
/// Where they are looked at [m]
const STATIONS: [f64; 5] = [-3500.0, -2000.0, 0.0, 2000.0, 3500.0];
/// Stress drops are means over what is nearer to the middle [m].
const REACH: f64 = 4000.0;

/// What an event did.
#[derive(Clone, Debug)]
struct Event {
    /// At the stations, since the begin of the event [s]
    arrivals: [f64; 5],
    /// At the stations [m]
    slips: [f64; 5],
    /// Mean over the fault [Pa]
    drop: f64,
}

/// Slip and traction of every point over time.
struct Course {
    x: Vec<f64>,
    times: Vec<f64>,
    /// (plastic slip, q) of every point
    states: Vec<Vec<(f64, f64)>>,
}

impl Course {
    fn keep(&mut self, state: &fecontact::model::state::State) {
        let of =
            |point: &fecontact::contact::force::ContactState| (point.friction.plastic_slip, point.friction.traction);
        self.times.push(state.time);
        self.states.push(state.contacts[0].iter().map(of).collect());
    }

    /// The state at the end of a step.
    fn at(&self, time: f64) -> &[(f64, f64)] {
        let at = self.times.iter().position(|t| (t - time).abs() < 1e-6).expect("a step ended then");
        &self.states[at]
    }

    /// When the slip rate, which is that of the middles of the records, first passes the threshold after a time.
    fn arrival(&self, k: usize, [begin, end]: [f64; 2]) -> f64 {
        let mut before = (begin, 0.0);
        for (i, pair) in self.times.windows(2).enumerate().filter(|(_, pair)| pair[0] > begin - 1e-6 && pair[1] < end) {
            let rate = (self.states[i + 1][k].0 - self.states[i][k].0) / (pair[1] - pair[0]);
            let middle = 0.5 * (pair[0] + pair[1]);
            if rate > THRESHOLD {
                let share = (THRESHOLD - before.1) / (rate - before.1);
                return before.0 + share * (middle - before.0) - begin;
            }
            before = (middle, rate);
        }
        f64::INFINITY
    }

    fn event(&self, [begin, end]: [f64; 2]) -> Event {
        let (before, after) = (self.at(begin), self.at(end));
        let nearest = |s: f64| {
            let order = |a: &usize, b: &usize| (self.x[*a] - s).abs().total_cmp(&(self.x[*b] - s).abs());
            (0..self.x.len()).min_by(order).expect("points")
        };
        let within: Vec<usize> = (0..self.x.len()).filter(|k| self.x[*k].abs() < REACH + 1.0).collect();
        let drop = within.iter().map(|k| before[*k].1 - after[*k].1).sum::<f64>() / within.len() as f64;
        let at = STATIONS.map(nearest);
        Event { arrivals: at.map(|k| self.arrival(k, [begin, end])), slips: at.map(|k| after[k].0 - before[k].0), drop }
    }
}

impl Observer for Course {
    fn record(&mut self, _: &Model, attempt: &Attempt) -> Result<(), Error> {
        if let Some(state) = attempt.accepted {
            self.keep(state);
        }
        Ok(())
    }
}

/// The committed case on elements of another size, whose damping goes with them.
fn case(h: f64) -> Value {
    let [length, height] = [14e3, 3e3];
    let path = crate::common::repository("cases/healing/healing.json");
    let mut case: Value = serde_json::from_str(&std::fs::read_to_string(path).expect("a case")).expect("JSON");
    let divisions = [(length / h).round() as usize, (height / h).round() as usize];
    case["mesh"] = Blocks::default()
        .rectangle("lower", divisions, [-0.5 * length, -height], [0.5 * length, 0.0])
        .rectangle("upper", divisions, [-0.5 * length, 0.0], [0.5 * length, height])
        .json();
    for body in ["lower", "upper"] {
        case["bodies"][body]["damping"]["stiffness"] = json!(3e-5 * h);
    }
    case["output"] = json!({"interval": 0.01, "fields": false});
    case
}

/// The same by implicit increments.
fn implicit(mut case: Value, dt: f64) -> Value {
    case["steps"][0]["scheme"] = json!({"generalized_alpha": {"rho_infinity": 0.8}});
    case["steps"][0]["dt"] = json!({"initial": dt});
    case["output"] = json!({"fields": false});
    case
}

fn events(case: &Value) -> [Event; 2] {
    let model = Arc::new(common::model(case));
    let x = model.mesh.undeformed();
    let places = model.contacts[0].points.iter().map(|point| point.at(&x).x).collect();
    let mut course = Course { x: places, times: Vec::new(), states: Vec::new() };
    course.keep(&model.initial_state());
    let (report, result) = run(&model, &mut [&mut course]);
    result.unwrap_or_else(|error| panic!("{error}"));
    println!("{} increments in {:.1} s", report.increments, report.wall_s.total);
    EVENTS.map(|event| course.event(event))
}

/// Print answers side by side.
fn table(names: &[String], answers: &[[Event; 2]]) {
    println!("| | {} |\n|---|{}", names.join(" | "), "---|".repeat(names.len()));
    let row = |name: &str, value: &dyn Fn(&[Event; 2]) -> f64, digits: usize| {
        let values: Vec<String> = answers.iter().map(|answer| format!("{:.digits$}", value(answer))).collect();
        println!("| {name} | {} |", values.join(" | "));
    };
    for (k, name) in ["first", "second"].iter().enumerate() {
        for (i, x) in STATIONS.iter().enumerate() {
            row(&format!("{name}, arrival at {:.1} km [s]", x / 1e3), &|answer| answer[k].arrivals[i], 3);
        }
        for (i, x) in STATIONS.iter().enumerate() {
            row(&format!("{name}, slip at {:.1} km [m]", x / 1e3), &|answer| answer[k].slips[i], 4);
        }
        row(&format!("{name}, mean stress drop [MPa]"), &|answer| answer[k].drop / 1e6, 4);
    }
}

/// The largest relative difference of what is compared.
fn difference(a: &[Event; 2], b: &[Event; 2]) -> f64 {
    let of = |event: &Event| [&event.arrivals[..], &event.slips[..], &[event.drop]].concat();
    let pairs = a.iter().zip(b).flat_map(|(a, b)| of(a).into_iter().zip(of(b)));
    pairs.map(|(a, b)| if a == b { 0.0 } else { (a / b - 1.0).abs() }).fold(0.0, f64::max)
}

/// Without recovery by rest.
fn unhealing(mut case: Value) -> Value {
    case["contacts"]["fault"]["friction"]["xi"] = json!(0);
    case
}

/// The largest difference of two answers, printed.
fn agree(name: &str, pair: [&[Event; 2]; 2], allowed: f64) {
    let found = difference(pair[0], pair[1]);
    println!("{name} differ by {:.2} % at most", 100.0 * found);
    assert!(found < allowed, "{name}: {found}");
}

/// Arrivals of the second rupture on 25 m: docs/healing_benchmark.md [s]
const SECOND: [f64; 5] = [1.509, 1.148, 0.676, 0.193, 0.624];

/// On 200 m, which are within 9 % of 25 m (and on 50 m agree with implicit increments within 1 %: `the_answers_converge`).
/// Without healing the interface never comes to rest, the reload drags it on before the second patch is loaded, and there is no
/// second drop of stress to speak of.
#[test]
fn a_healed_interface_breaks_again() {
    let answers = [case(200.0), unhealing(case(200.0))].map(|case| events(&case));
    table(&["healing", "xi = 0"].map(String::from), &answers);
    let [healing, unhealed] = &answers;
    let off = healing[1].arrivals.iter().zip(SECOND).map(|(at, fine)| (at / fine - 1.0).abs()).fold(0.0, f64::max);
    assert!(off < 0.09, "the second rupture arrives {off} off");
    let healed = healing[1].drop;
    assert!(unhealed[1].drop < 0.2 * healed, "{} of {healed}", unhealed[1].drop);
    assert!(unhealed[1].arrivals.iter().all(|at| *at < 0.05), "{unhealed:?}");
}

/// docs/healing_benchmark.md, *Answers*
#[test]
#[ignore = "docs/healing_benchmark.md: Answers; some minutes"]
fn the_answers_converge() {
    println!("docs/healing_benchmark.md: Answers\n");
    let sizes = [100.0, 50.0, 100.0 / 3.0, 25.0];
    let explicit = sizes.map(|h| events(&case(h)));
    let implicit = events(&implicit(case(50.0), 0.005));
    let unhealed = events(&unhealing(case(50.0)));
    let names = ["100 m", "50 m", "33.3 m", "25 m", "50 m, implicit", "50 m, xi = 0"];
    let others = [implicit.clone(), unhealed];
    table(&names.map(String::from), &[&explicit[..], &others[..]].concat());
    agree("100 m and 25 m", [&explicit[0], &explicit[3]], 0.03);
    agree("50 m and 25 m", [&explicit[1], &explicit[3]], 0.01);
    agree("33.3 m and 25 m", [&explicit[2], &explicit[3]], 0.005);
    agree("explicit and implicit", [&explicit[1], &implicit], 0.01);
}
