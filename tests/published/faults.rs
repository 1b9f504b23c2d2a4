//! Faults that dip and faults that branch: two of the problems of the SCEC community, on two sizes of elements.
//!
//! Source of the set-ups: PyLith's inputs of TPV10-2D and TPV14-2D (geodynamics/pylith_benchmarks, dynamic/scecdynrup). Their
//! series are not public in a form that could be kept here: what is asserted is that the arrivals do not depend on the
//! elements, and what breaks.

use std::sync::Arc;

use crate::common::{self, Blocks};
use fecontact::model::Model;
use fecontact::run::run;
use fecontact::run::{Attempt, Error, Observer};
use nalgebra::Vector2;
use serde_json::{Value, json};

/// Slip rate of an arrival [m/s]
const THRESHOLD: f64 = 1e-3;

/// When the points of every contact first slip faster than the threshold.
struct Arrivals {
    time: f64,
    /// Plastic slip and its rate
    slips: Vec<Vec<(f64, f64)>>,
    at: Vec<Vec<f64>>,
}

impl Observer for Arrivals {
    fn record(&mut self, _: &Model, attempt: &Attempt) -> Result<(), Error> {
        let Some(state) = attempt.accepted else { return Ok(()) };
        let dt = state.time - self.time;
        for (c, points) in state.contacts.iter().enumerate() {
            for (k, point) in points.iter().enumerate() {
                let (slip, before) = self.slips[c][k];
                let rate = (point.friction.plastic_slip - slip).abs() / dt;
                if self.at[c][k].is_infinite() && rate > THRESHOLD {
                    // Rates are those of the middles of the records.
                    let share = (THRESHOLD - before) / (rate - before);
                    self.at[c][k] = self.time - 0.5 * dt + share * dt;
                }
                self.slips[c][k] = (point.friction.plastic_slip, rate);
            }
        }
        self.time = state.time;
        Ok(())
    }
}

/// A place where arrivals are asked for: name of the contact, place.
type Place = (&'static str, [f64; 2]);

/// Arrivals at the places, infinite where the fault holds; linear between the two points nearest.
fn arrivals(case: &Value, places: &[Place]) -> Vec<f64> {
    let model = Arc::new(common::model(case));
    let fresh = |value| model.contacts.iter().map(|pair| vec![value; pair.points.len()]).collect();
    let mut record = Arrivals { time: 0.0, slips: vec![], at: fresh(f64::INFINITY) };
    record.slips = model.contacts.iter().map(|pair| vec![(0.0, 0.0); pair.points.len()]).collect();
    let (report, result) = run(&model, &mut [&mut record]);
    result.unwrap_or_else(|error| panic!("{error}"));
    println!("{} increments in {:.1} s", report.increments, report.wall_s.total);
    let x = model.mesh.undeformed();
    let at = |(name, place): &Place| {
        let c = model.contacts.iter().position(|pair| pair.name == *name).expect("a contact");
        let mut near: Vec<(f64, f64)> = model.contacts[c]
            .points
            .iter()
            .zip(&record.at[c])
            .map(|(point, time)| ((point.at(&x) - Vector2::from(*place)).norm(), *time))
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        let [(d0, t0), (d1, t1)] = [near[0], near[1]];
        (t0 * d1 + t1 * d0) / (d0 + d1)
    };
    places.iter().map(at).collect()
}

/// Rock whose viscosity is `damping` × h/c_p, and the stiffness of a contact in it.
fn rock(density: f64, shear_speed: f64, h: f64, damping: f64) -> (Value, f64) {
    let shear = density * shear_speed * shear_speed;
    let body = json!({"material": {"model": "linear", "E": 2.5 * shear, "nu": 0.25, "density": density},
        "damping": {"stiffness": damping * h / (3f64.sqrt() * shear_speed)}});
    (body, 10.0 * shear / h)
}

/// What is chosen for the elements: viscosity of the rock over h/c_p, and points of an edge where it slips.
#[derive(Clone, Copy)]
struct Choice {
    damping: f64,
    points: usize,
}

/// For a dipping fault, whose process zone is but 280 m long below its patch: four points an edge, and a viscosity that delays
/// the front by less than the elements do.
const FINE: Choice = Choice { damping: 0.06, points: 4 };

fn explicit(duration: f64, absorbing: &[&str]) -> Value {
    let loads: Vec<Value> = absorbing.iter().map(|side| json!({"on": side, "absorbing": true})).collect();
    json!([{"name": "rupture", "duration": duration, "scheme": {"explicit": {}}, "dt": {"initial": 1}, "loads": loads}])
}

/// SCEC TPV10-2D: a normal fault that dips by 60° through a half plane, its tractions growing with depth, in m, s, MPa; rock
/// of a width on either side, and down the dip.
fn dipping(h: f64, duration: f64, [width, down]: [f64; 2], Choice { damping, points }: Choice) -> Value {
    let dip = 60f64.to_radians();
    let height = down * dip.sin();
    let rows = (down / h).round() as usize;
    let columns = (width / h).round() as usize;
    let fault = move |t: f64| (height * (1.0 - t) / dip.tan(), -height * (1.0 - t));
    let mesh = Blocks::default()
        .block("foot", [columns, rows], |s, t| [fault(t).0 - width * (1.0 - s), fault(t).1])
        .block("hanging", [columns, rows], |s, t| [fault(t).0 + width * s, fault(t).1]);
    let (body, alpha) = rock(0.0027, 3300.0, h, damping);
    // y of a distance down the dip, and tractions by it
    let y = |s: f64| -s * dip.sin();
    let pressure = |s: f64| 7.378e-3 * s;
    let traction = |s: f64| 0.55 * pressure(s);
    let patch = |s: f64| 0.2 + 0.7657 * pressure(s);
    let end = down;
    let tractions = [
        (end, traction(end)),
        (13_500.0, traction(13_500.0)),
        (13_500.0, patch(13_500.0)),
        (10_500.0, patch(10_500.0)),
        (10_500.0, traction(10_500.0)),
        (0.0, 0.0),
    ];
    json!({
        "mesh": mesh.json(),
        "bodies": {"foot": body, "hanging": body},
        "contacts": {"fault": {"slave": "hanging_left", "master": "foot_right", "sliding": "small",
            "method": "gauss_to_segment", "points": points, "normal": {"alpha_n": alpha},
            "friction": {"law": "slip_weakening", "mu_s": 0.76, "mu_d": 0.448, "D_c": 0.5, "alpha_t": alpha},
            "along": {"cohesion": {"y": [[y(end), 1e4], [y(15e3), 1e4], [y(15e3), 0.2], [0.0, 0.2]]}},
            "initial": {"pressure": {"y": [[y(end), pressure(end)], [0.0, 0.0]]}, "balanced": true,
                "traction": {"y": tractions.map(|(s, q)| [y(s), q])}}}},
        "steps": explicit(duration, &["foot_left", "foot_bottom", "hanging_right", "hanging_bottom"]),
        "output": {"interval": f64::max(2e-5 * h, 0.002), "fields": false}})
}

/// SCEC TPV14-2D: a fault along y and a branch that leaves it at y = 2 km under 30°. Right of it the rock is two bodies: the
/// wedge between fault and branch, of triangles, and what is below the branch.
fn branched(h: f64, duration: f64, right_lateral: bool) -> Value {
    let [width, low, high] = [20e3, -20e3, 20e3];
    let [junction, turn] = [2e3, 30f64.to_radians()];
    let [below, above] = [junction - low, high - junction].map(|length| (length / h).round() as usize);
    let columns = (width / h).round() as usize;
    let along = |d: f64| [d * turn.sin(), junction + d * turn.cos()];
    // The left side of the lower body: the fault, then the branch.
    let side = |t: f64| {
        let k = t * (below + above) as f64;
        let d = (k - below as f64) * h;
        if d > 0.0 { along(d) } else { [0.0, junction + d] }
    };
    let mut mesh = Blocks::default()
        .block("left", [columns, below + above], |s, t| [-width * (1.0 - s), low + (high - low) * t])
        .block("right", [columns, below + above], |s, t| [side(t)[0] + width * s, side(t)[1]]);
    let right_left = mesh.edges.remove("right_left").expect("its edges");
    let (fault, branch) = right_left.split_at(below);
    mesh.edges.insert("right_fault".into(), fault.to_vec());
    mesh.edges.insert("right_branch".into(), branch.to_vec());
    wedge(&mut mesh, above, h, along, junction);
    let (body, alpha) = rock(0.00267, 3464.0, h, 0.18);
    let contact = |slave: &str, master: &str, locked: Vec<[f64; 2]>, traction: Value| {
        json!({"slave": slave, "master": master, "sliding": "small", "normal": {"alpha_n": alpha},
            "friction": {"law": "slip_weakening", "mu_s": 0.677, "mu_d": 0.525, "D_c": 0.4, "alpha_t": alpha},
            "along": {"cohesion": {"y": locked}},
            "initial": {"pressure": 120.0, "balanced": true, "traction": traction}})
    };
    let sign = if right_lateral { 1.0 } else { -1.0 };
    let ends = vec![[low, 1e4], [-14e3, 1e4], [-14e3, 0.0], [14e3, 0.0], [14e3, 1e4], [high, 1e4]];
    let tip = along(12e3)[1];
    let main = json!({"y": [[low, 70.0 * sign], [-7.5e3, 70.0 * sign], [-7.5e3, 81.6 * sign], [-4.5e3, 81.6 * sign],
        [-4.5e3, 70.0 * sign], [high, 70.0 * sign]]});
    let branching = json!(if right_lateral { 70.0 } else { -78.0 });
    json!({
        "mesh": mesh.json(),
        "bodies": {"left": body, "right": body, "wedge": body},
        "contacts": {
            "lower": contact("right_fault", "left_right", ends.clone(), main.clone()),
            "upper": contact("wedge_fault", "left_right", ends, main),
            "branch": contact("wedge_branch", "right_branch", vec![[low, 0.0], [tip, 0.0], [tip, 1e4], [high, 1e4]], branching)},
        "steps": explicit(duration, &["left_left", "left_bottom", "left_top", "right_right", "right_bottom", "right_top",
            "wedge_top"]),
        "output": {"interval": f64::max(5e-5 * h, 0.005), "fields": false}})
}

/// Add the wedge: n rows of triangles, all alike.
fn wedge(mesh: &mut Blocks, n: usize, h: f64, along: impl Fn(f64) -> [f64; 2], junction: f64) {
    let first = mesh.nodes.len();
    let node = |row: usize, k: usize| first + row * (row + 1) / 2 + k;
    for row in 0..=n {
        let d = row as f64 * h;
        let [x, y] = along(d);
        mesh.nodes.extend((0..=row).map(|k| {
            let share = if row == 0 { 0.0 } else { k as f64 / row as f64 };
            [share * x, junction + d + share * (y - junction - d)]
        }));
    }
    let mut triangles = Vec::new();
    for row in 0..n {
        for k in 0..=row {
            triangles.push(vec![node(row, k), node(row + 1, k + 1), node(row + 1, k)]);
            if k < row {
                triangles.push(vec![node(row, k), node(row, k + 1), node(row + 1, k + 1)]);
            }
        }
    }
    mesh.elements.insert("wedge".into(), triangles);
    let side = |end: &dyn Fn(usize) -> usize| (0..n).map(|row| vec![end(row), end(row + 1)]).collect::<Vec<_>>();
    mesh.edges.insert("wedge_fault".into(), side(&|row| node(row, 0)));
    mesh.edges.insert("wedge_branch".into(), side(&|row| node(row, row)));
    mesh.edges.insert("wedge_top".into(), (0..n).map(|k| vec![node(n, k), node(n, k + 1)]).collect());
}

/// Arrivals on two sizes of elements, as a table.
fn compare(name: &str, places: &[Place], case: impl Fn(f64) -> Value, sizes: [f64; 2], tolerance: f64) -> Vec<f64> {
    println!("{name}\n");
    let [coarse, fine] = sizes.map(|h| arrivals(&case(h), places));
    println!("| place [km] | {} m | {} m | difference |\n|---|---|---|---|", sizes[0], sizes[1]);
    for (((contact, [x, y]), a), b) in places.iter().zip(&coarse).zip(&fine) {
        let row = if a.is_finite() && b.is_finite() {
            format!("{a:.3} s | {b:.3} s | {:+.1} %", 100.0 * (a / b - 1.0))
        } else {
            [a, b].map(|at| if at.is_finite() { format!("{at:.3} s") } else { "holds".into() }).join(" | ") + " |"
        };
        println!("| {contact}, {:.2}, {:.2} | {row} |", x / 1e3, y / 1e3);
    }
    for (a, b) in coarse.iter().zip(&fine) {
        assert!(a == b || (a / b - 1.0).abs() < tolerance, "{a} {b}");
    }
    fine
}

/// A distance down the dip [m].
fn down_dip(s: f64) -> Place {
    ("fault", [0.5 * s, -s * 60f64.to_radians().sin()])
}

/// The stations of the benchmark that are neither in the patch nor at the surface, one nearer above the patch and one below.
fn stations() -> Vec<Place> {
    [1.5e3, 3e3, 4.5e3, 7.5e3, 9e3, 14.5e3].map(down_dip).to_vec()
}

fn around_the_junction() -> Vec<Place> {
    let [sine, cosine] = [30f64.to_radians().sin(), 30f64.to_radians().cos()];
    let mut places = vec![("lower", [0.0, -2e3]), ("lower", [0.0, 1e3]), ("upper", [0.0, 4e3]), ("upper", [0.0, 8e3])];
    places.extend([2e3, 5e3, 9e3].map(|d| ("branch", [d * sine, 2e3 + d * cosine])));
    places
}

/// Both sides of the junction break, the branch first.
fn both_break(arrivals: &[f64]) {
    let [upper, branch] = [arrivals[2], arrivals[4]];
    assert!(arrivals.iter().all(|at| at.is_finite()) && branch < upper, "{arrivals:?}");
}

#[test]
fn coarse_faults_break_as_finer_ones() {
    compare("TPV10", &stations(), |h| dipping(h, 3.0, [18e3, 27e3], FINE), [300.0, 200.0], 0.04);
    both_break(&compare("TPV14", &around_the_junction(), |h| branched(h, 6.0, true), [400.0, 250.0], 0.03));
}

#[test]
#[ignore = "docs/validation/tpv10_tpv14.md: TPV10"]
fn tpv10_does_not_depend_on_the_elements() {
    compare(
        "docs/validation/tpv10_tpv14.md: TPV10",
        &stations(),
        |h| dipping(h, 5.0, [24e3, 42e3], FINE),
        [100.0, 50.0],
        0.01,
    );
}

/// What the difference between elements of 100 m and 50 m comes from, in as much rock as the first 1.4 s can tell from a half
/// plane: the viscosity, which goes with the elements, delays the front above the patch; below it elements of which a few
/// span the process zone let the front run ahead.
#[test]
#[ignore = "docs/validation/tpv10_tpv14.md: what the differences come from"]
fn what_arrivals_hang_on() {
    let (mut differences, mut rows) = (Vec::new(), Vec::new());
    for (damping, points) in [(0.18, 2), (0.06, 2), (0.0, 2), (0.18, 4), (0.06, 4)] {
        let places = [7.5e3, 14.5e3].map(down_dip);
        let [coarse, fine] =
            [100.0, 50.0].map(|h| arrivals(&dipping(h, 1.4, [5e3, 19e3], Choice { damping, points }), &places));
        let difference = [0, 1].map(|k| 100.0 * (coarse[k] / fine[k] - 1.0));
        let columns = [0, 1].map(|k| format!("{:.3} s | {:.3} s | {:+.2} %", coarse[k], fine[k], difference[k]));
        rows.push(format!("| {damping} | {points} | {} |", columns.join(" | ")));
        differences.push(difference);
    }
    let head = "| viscosity, h/c_p | points per edge | 7.5 km, 100 m | 50 m | difference | 14.5 km, 100 m | 50 m | \
                difference |";
    println!("{head}\n|---|---|---|---|---|---|---|---|\n{}", rows.join("\n"));
    let [viscous, less, none, .., chosen] = differences[..] else { unreachable!("five rows") };
    assert!(viscous[0] > 1.0 && less[0] < 0.5 * viscous[0] && none[0].abs() < 0.3, "{differences:?}");
    assert!(chosen[1].abs() < 0.85 * less[1].abs() && chosen.iter().all(|d| d.abs() < 1.0), "{differences:?}");
}

#[test]
#[ignore = "docs/validation/tpv10_tpv14.md: TPV14"]
fn tpv14_does_not_depend_on_the_elements() {
    let name = "docs/validation/tpv10_tpv14.md: TPV14";
    both_break(&compare(name, &around_the_junction(), |h| branched(h, 6.0, true), [100.0, 50.0], 0.01));
}

#[test]
#[ignore = "docs/validation/tpv10_tpv14.md: TPV15"]
fn tpv15_does_not_depend_on_the_elements() {
    let name = "docs/validation/tpv10_tpv14.md: TPV15";
    compare(name, &around_the_junction(), |h| branched(h, 6.0, false), [100.0, 50.0], 0.01);
}
