//! Slip fronts of the super/subloading law: where they begin, how fast they run, where they stop, and what force it takes.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::common::{Blocks, Record, close, model, model_at};
use fecontact::contact::force::ContactState;
use fecontact::linear::Multifrontal;
use fecontact::mesh::configuration::Configuration;
use fecontact::model::{Model, State};
use fecontact::run::{Attempt, Error, Observer, Simulation, run};
use fecontact::solve::Workspace;
use fecontact::time::beginning::begin;
use fecontact::time::increment::advance;
use serde_json::{Value, json};

/// c_R/c_s and c_p/c_s for ν = 0.3.
const RAYLEIGH: f64 = 0.9274;
const PRESSURE: f64 = 1.8708;

const MU_S: f64 = 0.5;
const MU_K: f64 = 0.1;
/// r μ_k/κ of all cases here.
const SHARPNESS: f64 = 20.0;

/// The law's own curve R μ over slip at constant pressure, ξ = 0, by small steps of Ṙ = −r ln R, μ̇ = −κ (μ/μ_k − 1):
/// highest value, and steepest fall times μ_k/κ.
fn peak_and_fall() -> (f64, f64) {
    // From the closed form of small R, s ≈ −R/(r ln R), at R = 1e-6 on; slip in units of μ_k/κ.
    let (mut ratio, mut mu) = (1e-6f64, MU_S);
    let step = 1e-6;
    let (mut peak, mut fall) = (0.0f64, 0.0f64);
    for _ in 0..3_000_000 {
        let rates = |ratio: f64, mu: f64| (-SHARPNESS * ratio.ln(), -(mu - MU_K));
        let (a, b) = rates(ratio, mu);
        let (a, b) = rates(ratio + 0.5 * step * a, mu + 0.5 * step * b);
        fall = fall.max(-(a * mu + ratio * b));
        (ratio, mu) = ((ratio + step * a).min(1.0), mu + step * b);
        peak = peak.max(ratio * mu);
    }
    (peak, fall)
}

/// Two blocks with rows that grow by a factor away from the interface y = 0, from x = `left` on.
fn graded([length, height]: [f64; 2], left: f64, [columns, rows]: [usize; 2], growth: f64, names: [&str; 2]) -> Value {
    let depth = move |t: f64| height * (growth.powf(t * rows as f64) - 1.0) / (growth.powi(rows as i32) - 1.0);
    let place = move |s: f64| left + s * length;
    Blocks::default()
        .block(names[0], [columns, rows], |s, t| [place(s), -depth(1.0 - t)])
        .block(names[1], [columns, rows], |s, t| [place(s), depth(t)])
        .json()
}

/// G = ρ = 1 and a nucleation length of 1.158 G/((1 − ν) W) = 1: W, the steepest fall of the traction with slip.
const STEEPEST: f64 = 1.158 / 0.7;
const P: f64 = 0.01;
/// Slip over which a traction that falls from μ_s p to μ_k p all at this rate does so.
const WEAKENING: f64 = (MU_S - MU_K) * P / STEEPEST;

fn super_subloading(alpha: f64) -> Value {
    let (_, fall) = peak_and_fall();
    let kappa = STEEPEST * MU_K / (fall * P);
    json!({"law": "super_subloading", "mu_s": MU_S, "mu_k": MU_K, "alpha_t": alpha, "r": SHARPNESS * kappa / MU_K, "kappa": kappa})
}

/// The length over which the traction falls when the last static increment before the loss of stability ends: a long
/// interface under a traction that peaks in the middle, sheared slowly.
fn length_at_loss_of_stability(friction: Value, [peak, curvature]: [f64; 2]) -> f64 {
    let columns = 128;
    let material = json!({"material": {"model": "linear", "E": 2.6, "nu": 0.3}});
    let sides = ["lower_bottom", "lower_left", "lower_right", "upper_top", "upper_left", "upper_right"];
    let supports: Vec<Value> = sides.iter().map(|side| json!({"on": side, "ux": "3e-3*y*t", "uy": 0})).collect();
    let model = model(&json!({
        "mesh": graded([8.0, 5.0], -4.0, [columns, 18], 1.18, ["lower", "upper"]),
        "bodies": {"lower": material, "upper": material},
        "contacts": {"fault": {"slave": "upper_bottom", "master": "lower_top",
            "normal": {"alpha_n": 50.0 * STEEPEST}, "friction": friction,
            "initial": {"pressure": P, "balanced": true,
                        "traction": format!("{P}*({peak} - {curvature}*x^2/(1 + {}*x^2))", curvature / 0.3)}}},
        "steps": [{"name": "shear", "duration": 1, "dt": {"initial": 0.002, "max": 0.002, "min": 4e-5}, "supports": supports}],
    }));
    let mut record = Record::default();
    let model = Arc::new(model);
    let (_, result) = run(&model, &mut [&mut record]);
    // Either there is no equilibrium near the last one, or the increment finds another one far away.
    let states = &record.states;
    let jump = |pair: &[State]| {
        let slips = pair[0].contacts[0].iter().zip(&pair[1].contacts[0]);
        slips.fold(0.0f64, |most, (old, new)| most.max(new.friction.plastic_slip - old.friction.plastic_slip))
            > 0.2 * WEAKENING
    };
    let end = states.windows(2).position(jump);
    assert!(end.is_some() || matches!(result, Err(Error::IncrementTooSmall { .. })), "stability was not lost");
    let last = &states[end.unwrap_or(states.len() - 1)];
    // Increments near the end may be too short to tell what falls.
    let before = states.iter().rev().find(|state| state.time < last.time - 2e-3).expect("an earlier state");
    let falls = last.contacts[0]
        .iter()
        .zip(&before.contacts[0])
        .filter(|(new, old)| new.friction.traction < old.friction.traction);
    falls.map(|(new, _)| new.length).sum()
}

/// Linear weakening loses stability at 1.158 G/((1 − ν) W) whatever the shape of the load (Uenishi & Rice 2003, J.
/// Geophys. Res. 108, 2042); the traction of the super/subloading law falls over that length too, W being the steepest fall
/// of its curve.
#[test]
fn stability_is_lost_at_the_length_of_the_theory() {
    let alpha = 50.0 * STEEPEST;
    let linear = json!({"law": "slip_weakening", "mu_s": MU_S, "mu_d": MU_K, "D_c": WEAKENING, "alpha_t": alpha});
    for (name, friction, shape) in
        [("slip_weakening", linear, [0.498, 0.3]), ("super_subloading", super_subloading(alpha), [0.40, 0.1])]
    {
        let length = length_at_loss_of_stability(friction, shape);
        println!("{name}, {shape:?}: stability is lost at a length of {length:.3}, in theory 1");
        // The last increments before it end a little short of it.
        close(name, length, 0.95, 0.2);
    }
}

/// Speed of the front over c_s, 4 to 9 nucleation lengths from where it begins: by least squares over the middle of the
/// places where it arrives, and whether it gets there.
fn speed_of_front(traction: f64) -> Option<f64> {
    let alpha = 12.0 * STEEPEST;
    let (length, height, h) = (24.0, 7.0, 0.1);
    let material = json!({"material": {"model": "linear", "E": 2.6, "nu": 0.3, "density": 1}});
    let blocks = Blocks::default()
        .rectangle(
            "lower",
            [(length / h) as usize, (height / h) as usize],
            [-0.5 * length, -height],
            [0.5 * length, 0.0],
        )
        .rectangle(
            "upper",
            [(length / h) as usize, (height / h) as usize],
            [-0.5 * length, 0.0],
            [0.5 * length, height],
        );
    let sides = ["lower_bottom", "lower_left", "lower_right", "upper_top", "upper_left", "upper_right"];
    let loads: Vec<Value> = sides.iter().map(|side| json!({"on": side, "absorbing": true})).collect();
    // The blocks' opposite motion brings a traction of ρ c_s v at once.
    let kick = 0.06 * P;
    let model = model(&json!({
        "mesh": blocks.json(),
        "bodies": {"lower": material, "upper": material},
        "initial_velocity": {"upper": [kick, 0], "lower": [-kick, 0]},
        "contacts": {"fault": {"slave": "upper_bottom", "master": "lower_top",
            "normal": {"alpha_n": alpha}, "friction": super_subloading(alpha),
            "initial": {"pressure": P, "balanced": true,
                "traction": {"x": [[-0.75, traction * P], [-0.75, 0.43 * P], [0.75, 0.43 * P], [0.75, traction * P]]}}}},
        "steps": [{"name": "run", "duration": 13, "scheme": {"explicit": {}}, "dt": {"initial": 1}, "loads": loads}],
        "output": {"interval": 0.05},
    }));
    let mut record = Slips::new(&model);
    let model = Arc::new(model);
    let (_, result) = run(&model, &mut [&mut record]);
    result.unwrap_or_else(|error| panic!("{error}"));
    let arrivals = record.arrivals(0..record.times.len(), 0.05 * P);
    let points: Vec<[f64; 2]> = record
        .places
        .iter()
        .zip(arrivals)
        .filter(|(x, _)| (4.0..9.0).contains(*x))
        .filter_map(|(x, t)| Some([*x, t?]))
        .collect();
    (points.len() > 80).then(|| 1.0 / slope(&points))
}

/// Slope of y over x by least squares.
fn slope(points: &[[f64; 2]]) -> f64 {
    let n = points.len() as f64;
    let [x, y] = [0, 1].map(|k| points.iter().map(|point| point[k]).sum::<f64>() / n);
    let moment = |k: usize| points.iter().map(|point| (point[0] - x) * (point[k] - [x, y][k])).sum::<f64>();
    moment(1) / moment(0)
}

/// A front stops where the traction it meets is low, keeps below c_R where it is higher, and runs between √2 c_s and c_p
/// where it is near the peak.
#[test]
fn fronts_keep_to_the_limits_of_speed() {
    assert_eq!(speed_of_front(0.12), None);
    let [slow, fast] = [0.17, 0.25].map(|traction| speed_of_front(traction).expect("a front"));
    println!("speeds over c_s: {slow:.3} (c_R {RAYLEIGH}), {fast:.3} (√2 to {PRESSURE})");
    assert!((0.4..RAYLEIGH).contains(&slow), "{slow}");
    assert!((2f64.sqrt()..PRESSURE).contains(&fast), "{fast}");
}

/// What the points of the interface slip, and the force it takes.
struct Slips {
    /// Positions of the points, left to right [L]
    places: Vec<f64>,
    times: Vec<f64>,
    /// Slip rates of all points at every time, means since the time before [L/T]
    rates: Vec<Vec<f64>>,
    /// Tangential over normal force
    friction: Vec<f64>,
    slips: Vec<f64>,
    /// energy_error and external_work at the end [F·L]
    energy: [f64; 2],
}

impl Slips {
    fn new(model: &Model) -> Self {
        let x = Configuration::undeformed(&model.mesh.nodes);
        let places: Vec<f64> = model.contacts[0].points.iter().map(|point| point.at(&x).x).collect();
        Self {
            slips: vec![0.0; places.len()],
            places,
            times: vec![0.0],
            rates: Vec::new(),
            friction: Vec::new(),
            energy: [0.0; 2],
        }
    }

    /// When each point first slips faster than a rate, in some intervals; between their middles.
    fn arrivals(&self, intervals: std::ops::Range<usize>, rate: f64) -> Vec<Option<f64>> {
        let middle = |k: usize| 0.5 * (self.times[k] + self.times[k + 1]);
        let arrival = |point: usize| {
            let after = intervals.clone().find(|&k| self.rates.get(k).is_some_and(|rates| rates[point] > rate))?;
            let Some(before) = after.checked_sub(1) else { return Some(middle(after)) };
            let [low, high] = [before, after].map(|k| self.rates[k][point]);
            Some(middle(before) + (rate - low) / (high - low) * (middle(after) - middle(before)))
        };
        (0..self.places.len()).map(arrival).collect()
    }
}

impl Observer for Slips {
    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let Some(state) = attempt.accepted else { return Ok(()) };
        let dt = state.time - self.times[self.times.len() - 1];
        let slips: Vec<f64> = state.contacts[0].iter().map(|contact| contact.friction.plastic_slip).collect();
        self.rates.push(slips.iter().zip(&self.slips).map(|(new, old)| (new - old).abs() / dt).collect());
        let x = model.configuration(&state.displacement);
        let points = model.contacts[0].points.iter().zip(&state.contacts[0]);
        let [n, t] = points.fold([0.0, 0.0], |[n, t], (point, contact)| {
            let length = point.current_length(&x);
            [n + length * contact.friction.pressure, t + length * contact.friction.traction]
        });
        self.friction.push(t.abs() / n);
        (self.slips, self.energy) = (slips, [state.energy.error(), state.energy.external_work]);
        self.times.push(state.time);
        Ok(())
    }
}

/// A front of the slip-front case, with all that follows within 5 ms.
#[derive(Debug)]
struct Event {
    time: f64,
    /// Tangential over normal force before
    friction: f64,
    /// and after
    after: f64,
    /// Share of the interface that slips fast
    reach: f64,
    /// Speed over c_R of the front, place by place over 15 mm, where it runs to the right
    speeds: Vec<(f64, f64)>,
}

/// Slip rate of a front under 5 MPa; rates go with the pressure [mm/s]
const FRONT: f64 = 100.0;
/// c_R of the blocks [mm/s]
const C_R: f64 = 1.2583e6;

fn events(record: &Slips, front: f64) -> Vec<Event> {
    let fast: Vec<usize> =
        (0..record.rates.len()).filter(|&k| record.rates[k].iter().any(|rate| *rate > front)).collect();
    let length = record.places[record.places.len() - 1];
    let of = |run: &[usize]| {
        let (first, last) = (run[0], run[run.len() - 1]);
        // The first front only: what slips again later is not it.
        let until = run.iter().take_while(|&&k| record.times[k] < record.times[first] + 3e-4).count();
        let arrivals = record.arrivals(first..first + until, front);
        let at: Vec<[f64; 2]> = record.places.iter().zip(&arrivals).filter_map(|(x, t)| Some([*x, (*t)?])).collect();
        let speed = |x: f64| {
            let near: Vec<[f64; 2]> = at.iter().copied().filter(|[place, _]| (place - x).abs() < 7.5).collect();
            let speed = 1.0 / slope(&near) / C_R;
            (near.len() > 5 && speed > 0.0).then_some((x, speed))
        };
        let all = record.arrivals(first..last + 1, front);
        let farthest =
            record.places.iter().zip(&all).filter(|(_, t)| t.is_some()).fold(0.0, |far: f64, (x, _)| far.max(*x));
        Event {
            time: record.times[first],
            friction: record.friction[first.saturating_sub(1)],
            after: record.friction[last],
            reach: farthest / length,
            speeds: (2..12).map(|k| 10.0 * f64::from(k)).filter_map(speed).collect(),
        }
    };
    fast.chunk_by(|a, b| record.times[*b] - record.times[*a] < 5e-3).map(of).collect()
}

/// Error allowed to an increment in the committed case [mm]
const ERROR: f64 = 5e-5;

/// The committed case, and where it lies.
fn committed() -> (Value, PathBuf) {
    let path = crate::common::repository("cases/slip_front.json");
    (serde_json::from_str(&std::fs::read_to_string(&path).expect("the case")).expect("JSON"), path)
}

/// The committed case on blocks of another length, under another pressure, in finer elements, for another time, with
/// another error of the increments.
fn slip_front([length, pressure, duration]: [f64; 3], columns: usize, fine: usize, error: f64) -> (Vec<Event>, Slips) {
    let (mut case, path) = committed();
    let rows = if columns as f64 / length > 0.5 { 15 } else { 10 };
    let growth = 1.1f64.powf(1.0 / fine as f64);
    case["mesh"] = graded([length, 40.0], 0.0, [fine * columns, fine * rows], growth, ["base", "block"]);
    let initial = &mut case["contacts"]["interface"]["initial"];
    (initial["pressure"], initial["traction"]) = (json!(pressure), json!(MU_K * pressure));
    case["steps"][0]["duration"] = json!(duration);
    case["steps"][0]["dt"]["error"] = json!(error);
    println!("{length} mm, {columns} × {fine} columns, p = {pressure} MPa, error {error}:");
    fronts(&case, &path, pressure)
}

/// The fronts of a case under a pressure, a row each.
fn fronts(case: &Value, path: &Path, pressure: f64) -> (Vec<Event>, Slips) {
    let model = model_at(case, path);
    let mut record = Slips::new(&model);
    let model = Arc::new(model);
    let (report, result) = run(&model, &mut [&mut record]);
    result.unwrap_or_else(|error| panic!("{error}"));
    let found = events(&record, FRONT * pressure / 5.0);
    let [increments, solves] = [report.increments, report.newton_iterations];
    println!("{increments} increments, {solves} linear solves, {:.0} s", report.wall_s.total);
    println!("| t [s] | F_t/F_n before | after | reach | front speed/c_R at x [mm] |\n|---|---|---|---|---|");
    for event in &found {
        let speeds: Vec<String> = event.speeds.iter().map(|(x, speed)| format!("{x:.0}: {speed:.2}")).collect();
        println!(
            "| {:.4} | {:.3} | {:.3} | {:.0} % | {} |",
            event.time,
            event.friction,
            event.after,
            100.0 * event.reach,
            speeds.join(", ")
        );
    }
    let [error, work] = record.energy;
    println!("energy error {:.1e} of the work\n", error.abs() / work);
    assert!(error.abs() < 0.01 * work, "{error} of {work}");
    (found, record)
}

/// `cases/stick_slip.json` on finer or coarser elements up to a time: when its ruptures set out [s], at which F_t/F_n, and the speeds
/// of their fronts over c_R.
fn ruptures(fine: f64, duration: f64) -> Vec<Event> {
    let path = crate::common::repository("cases/stick_slip.json");
    let mut case: Value = serde_json::from_str(&std::fs::read_to_string(&path).expect("the case")).expect("JSON");
    case["mesh"]["parameters"]["fine"] = json!(fine);
    case["steps"][0]["duration"] = json!(duration);
    let model = model_at(&case, &path);
    let mut record = Slips::new(&model);
    let (report, result) = run(&Arc::new(model), &mut [&mut record]);
    result.unwrap_or_else(|error| panic!("{error}"));
    println!("{} increments, {:.0} s", report.increments, report.wall_s.total);
    events(&record, FRONT)
}

/// The first three ruptures of `cases/stick_slip.json` set out at the same times on meshes of different sizes, within 1 %, and at
/// the same force within 2 %.
fn the_same_ruptures(sizes: &[f64]) {
    let runs: Vec<Vec<Event>> = sizes.iter().map(|&fine| ruptures(fine, 1.35)).collect();
    println!("| element [mm] | first [s] | second [s] | third [s] | F_t/F_n before each |\n|---|---|---|---|---|");
    for (fine, events) in sizes.iter().zip(&runs) {
        let list = |of: fn(&Event) -> String, between: &str| events.iter().map(of).collect::<Vec<_>>().join(between);
        let (times, forces) =
            (list(|event| format!("{:.4}", event.time), " | "), list(|event| format!("{:.3}", event.friction), ", "));
        println!("| {} | {times} | {forces} |", 1.25 / fine);
    }
    for pair in runs.windows(2) {
        assert!(pair.iter().all(|events| events.len() == 3), "not three ruptures");
        for (coarse, fine) in pair[0].iter().zip(&pair[1]) {
            close("onset", coarse.time, fine.time, 0.01 * fine.time);
            close("force", coarse.friction, fine.friction, 0.02 * fine.friction);
            assert!(fine.reach > 0.99 && fine.after < 0.5 * fine.friction, "{fine:?}");
        }
    }
}

/// The first two on elements of 2.5 mm are those of 0.3125 mm, the last row of the table in docs/slip_fronts.md.
#[test]
fn ruptures_from_a_weak_patch_are_those_of_finer_elements() {
    let events = ruptures(0.5, 0.9);
    assert_eq!(events.len(), 2, "{events:?}");
    for (event, [onset, force]) in events.iter().zip([[0.4350, 0.280], [0.8576, 0.265]]) {
        close("onset", event.time, onset, 0.01 * onset);
        close("force", event.friction, force, 0.02 * force);
        assert!(event.reach > 0.99 && event.after < 0.5 * event.friction, "{event:?}");
    }
}

#[test]
#[ignore = "docs/slip_fronts.md, four meshes"]
fn ruptures_from_a_weak_patch_converge() {
    the_same_ruptures(&[0.5, 1.0, 2.0, 4.0]);
}

/// With elements of twice the size, until the first fronts have run: they begin at the pushed end, stop on their way, and
/// the force that starts them is far below μ_s F_n.
#[test]
fn precursors_stop_on_their_way() {
    let (events, record) = slip_front([120.0, 5.0, 0.75], 48, 1, ERROR);
    let (peak, _) = peak_and_fall();
    assert!(!events.is_empty(), "nothing ran");
    for event in &events {
        assert!(
            (0.1..0.7).contains(&event.reach) && event.after < event.friction && event.friction < 0.7 * peak,
            "{event:?}"
        );
        // Where a front begins, elements slip nearly together; most of its way it is slower than waves of pressure.
        let mut speeds: Vec<f64> = event.speeds.iter().map(|(_, speed)| *speed).collect();
        speeds.sort_by(f64::total_cmp);
        assert!(speeds.get(speeds.len() / 2).is_none_or(|median| *median < PRESSURE / RAYLEIGH), "{event:?}");
    }
    // After them the interface sticks: it has healed.
    assert!(record.rates.last().is_some_and(|rates| rates.iter().all(|rate| *rate < 1.0)));
}

#[test]
#[ignore = "docs/slip_fronts.md, crossing and stopping"]
fn some_fronts_cross_and_others_stop() {
    println!("docs/slip_fronts.md, crossing and stopping\n");
    let (case, path) = committed();
    let (events, _) = fronts(&case, &path, 5.0);
    let (peak, _) = peak_and_fall();
    let crossing = events.iter().filter(|event| event.reach > 0.95).count();
    assert!(crossing >= 2 && events.len() >= crossing + 3, "{crossing} of {} cross", events.len());
    assert!(events.iter().all(|event| event.friction < 0.75 * peak && event.after > MU_K));
}

/// When a front sets out hangs on little things: at the pushed end slip is all but unstable most of the time. How far those
/// get that pass all before them does not: it follows from the force at which they set out, for all meshes and increments
/// alike.
#[test]
#[ignore = "docs/slip_fronts.md, mesh and increments"]
fn how_far_a_front_gets_is_neither_of_the_mesh_nor_of_the_increments() {
    println!("docs/slip_fronts.md, mesh and increments\n");
    let mut all: Vec<[f64; 2]> = Vec::new();
    let mut table = String::new();
    for (fine, error) in [(1, ERROR), (1, 0.2 * ERROR), (2, ERROR)] {
        let (events, _) = slip_front([120.0, 5.0, 0.75], 96, fine, error);
        assert!(!events.is_empty());
        for Event { time, friction, after, reach, speeds, .. } in &events {
            let speed = |x: f64| {
                let there = speeds.iter().find(|(place, _)| (place - x).abs() < 0.5);
                there.map_or("–".into(), |(_, speed)| format!("{speed:.2}"))
            };
            table += &format!(
                "| {} | {error} | {time:.3} | {friction:.3} | {after:.3} | {:.0} | {} |\n",
                1.25 / fine as f64,
                120.0 * reach,
                [30.0, 40.0, 50.0].map(speed).join(", ")
            );
        }
        let mut farthest = 0.0;
        for event in events.iter().take_while(|event| event.reach < 0.95) {
            if event.reach > farthest {
                all.push([event.friction, 120.0 * event.reach]);
                farthest = event.reach;
            }
        }
    }
    assert!(all.len() > 3, "{all:?}");
    let b = slope(&all);
    let mean = |k: usize| all.iter().map(|point| point[k]).sum::<f64>() / all.len() as f64;
    for [friction, reach] in &all {
        let line = mean(1) + b * (friction - mean(0));
        println!("set out at F_t/F_n = {friction:.4}: {reach:.1} mm, on the line of all {line:.1} mm");
        close("reach", *reach, line, 5.0);
    }
    println!(
        "\n| element [mm] | error [mm] | t [s] | F_t/F_n before | after | reach [mm] | speed/c_R at 30, 40, 50 mm |"
    );
    println!("|---|---|---|---|---|---|---|\n{table}");
}

/// Displacements scale with the pressure, and so does the allowed error. Single runs tell of the two lower pressures that their forces are above
/// that of the highest: they scatter by a tenth, and are no farther apart.
#[test]
#[ignore = "docs/slip_fronts.md, the force"]
fn the_force_falls_with_length_and_pressure() {
    println!("docs/slip_fronts.md, the force\n");
    let mut table = Vec::new();
    for (length, columns, pressure, duration) in [
        (60.0, 48, 5.0, 0.6),
        (120.0, 96, 5.0, 1.2),
        (180.0, 144, 5.0, 2.4),
        (120.0, 48, 2.5, 1.3),
        (120.0, 48, 1.25, 1.0),
    ] {
        let (events, record) = slip_front([length, pressure, duration], columns, 1, ERROR * pressure / 5.0);
        let crossing = events.iter().find(|event| event.reach > 0.95);
        let highest = record.friction.iter().copied().fold(0.0, f64::max);
        table.push((length, pressure, crossing.map_or(highest, |event| event.friction)));
    }
    println!("| length [mm] | pressure [MPa] | F_t/F_n when the front that crosses sets out |\n|---|---|---|");
    table.iter().for_each(|(length, pressure, friction)| println!("| {length} | {pressure} | {friction:.3} |"));
    let of = |k: usize| table[k].2;
    assert!(of(0) > of(1) && of(1) > of(2), "falls with the length");
    assert!(of(4).min(of(3)) > of(1), "falls with the pressure");
    assert!(table.iter().all(|(_, _, friction)| *friction > MU_K && *friction < MU_S));
}

/// The committed case with its increments taken from a list: condensed on the contact and on all equations the same history, to
/// 1e-6 of the largest values. From 0.3 s on friction is unstable, and multiplies what round-off and tolerances leave: there no
/// two ways to solve the same equations agree by more than a few digits.
#[test]
fn increments_of_one_list_give_one_history_condensed_or_not() {
    let path = crate::common::repository("cases/slip_front.json");
    let mut case: Value = serde_json::from_str(&std::fs::read_to_string(&path).expect("a case")).expect("JSON");
    case["steps"][0]["duration"] = json!(0.2);
    case["newton"]["tolerance"] = json!(2e-9);
    let model = |condense: bool| {
        let mut model = model_at(&case, &path);
        model.aids.condense = condense;
        Arc::new(model)
    };
    let states = |model: Arc<Model>, list: &[f64]| -> Vec<State> {
        let mut work = Workspace::new(&model, Box::<Multifrontal>::default());
        let (step, mut states) = (&model.steps[0], Vec::new());
        let mut state = begin(&model, step, &model.initial_state(), &mut work).expect("it begins");
        for &dt in list {
            state = advance(&model, step, &state, dt, &mut work).state.expect("it is solved");
            states.push(state.clone());
        }
        states
    };
    let list: Vec<f64> =
        Simulation::new(model(true)).map(|increment| increment.expect("it is solved").state.dt).collect();
    let [condensed, all] = [true, false].map(|condense| states(model(condense), &list));
    assert!(list.len() > 30, "{} increments", list.len());
    // Mean pressure, traction and slip, and energies.
    let history = |state: &State| -> [f64; 6] {
        let mean = |of: fn(&ContactState) -> f64| -> f64 {
            state.contacts.iter().flatten().map(|point| of(point) * point.length).sum()
        };
        let means: [fn(&ContactState) -> f64; 3] =
            [|point| point.friction.pressure, |point| point.friction.traction, |point| point.friction.plastic_slip];
        let [pressure, traction, slip] = means.map(mean);
        [pressure, traction, slip, state.energy.strain, state.energy.friction_dissipation, state.energy.kinetic]
    };
    let [condensed, all] = [condensed, all].map(|states| states.iter().map(history).collect::<Vec<_>>());
    for column in 0..6 {
        let largest = all.iter().fold(0.0f64, |m, row| m.max(row[column].abs()));
        for (k, (a, b)) in all.iter().zip(&condensed).enumerate() {
            let off = (a[column] - b[column]).abs();
            assert!(off < 1e-6 * largest, "column {column} is off by {off:e} of {largest:e} after increment {k}");
        }
    }
}
