//! The point-mass problems of Yasuike, Toyoda & Noda (`cases/paper/`), against closed forms and an independent integration.
//!
//! References. Case 2 and the slope: closed forms. Onsets without ringing: the quasi-static solution. Events with ringing:
//! Runge–Kutta of fourth order on the rate form of the law (increments of 0.5 ms and 2 ms agree to 0.01 s at the first).

use std::path::PathBuf;
use std::sync::Arc;

use crate::common::{close, model_at};
use fecontact::model::Model;
use fecontact::run::run;
use fecontact::run::{Attempt, Error, Observer, RunReport};
use serde_json::{Value, json};

/// One accepted increment of a block.
#[derive(Clone, Copy)]
struct Row {
    time: f64,
    position: [f64; 2],
    velocity: f64,
    friction: f64,
    energy_error: f64,
    work: f64,
}

#[derive(Default)]
struct Rows(Vec<Row>);

impl Observer for Rows {
    fn record(&mut self, _: &Model, attempt: &Attempt) -> Result<(), Error> {
        self.0.extend(attempt.accepted.map(|state| Row {
            time: state.time,
            position: [state.displacement[0], state.displacement[1]],
            velocity: state.velocity[0],
            friction: state.contacts[0][0].friction.traction,
            energy_error: state.energy.error().abs(),
            work: state.energy.external_work.abs() + state.energy.initial,
        }));
        Ok(())
    }
}

fn paper(name: &str) -> (Value, PathBuf) {
    let path = crate::common::repository("cases/paper").join(name);
    let text = std::fs::read_to_string(&path).unwrap();
    (serde_json::from_str(&text).unwrap(), path)
}

fn finish((case, path): &(Value, PathBuf)) -> (Vec<Row>, RunReport) {
    let mut rows = Rows::default();
    let (report, result) = run(&Arc::new(model_at(case, path)), &mut [&mut rows]);
    result.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    (rows.0, report)
}

/// Times at which the block slips fastest, one for each slip that is faster than 0.05.
fn slips(rows: &[Row]) -> Vec<f64> {
    let mut times: Vec<f64> = Vec::new();
    for three in rows.windows(3) {
        let fastest = three[1].velocity > 0.05 && three[1].velocity >= three[0].velocity.max(three[2].velocity);
        if fastest && times.last().is_none_or(|last| three[1].time > last + 20.0) {
            times.push(three[1].time);
        }
    }
    times
}

fn peak(rows: &[Row]) -> Row {
    *rows.iter().max_by(|a, b| a.friction.total_cmp(&b.friction)).unwrap()
}

/// Where the parabola through three points is highest.
fn summit([(t0, y0), (t1, y1), (t2, y2)]: [(f64, f64); 3]) -> f64 {
    let (before, after) = ((y1 - y0) / (t1 - t0), (y2 - y1) / (t2 - t1));
    0.5 * (t0 + t1) - before * 0.5 * (t2 - t0) / (after - before)
}

/// Largest error of the energy balance over the largest work done.
fn energy_error(rows: &[Row]) -> f64 {
    let most = |of: fn(&Row) -> f64| rows.iter().map(of).fold(0.0, f64::max);
    most(|row| row.energy_error) / most(|row| row.work)
}

/// The energy balance of a run that resolves the ringing.
fn assert_balanced(rows: &[Row]) {
    let error = energy_error(rows);
    assert!(error < 1e-3, "energy error {error:e} of the work");
}

/// Friction grows as F = K (v_ex t − u) until the law's own curve has its peak: F = 25.0175 at u = 0.040384, so that
/// t = (F/K + u)/v_ex = 2542.1. Then one slip, and μ_k p = 19.62 for ever.
#[test]
fn weakening_without_recovery_slips_once() {
    let (rows, report) = finish(&paper("spring_mass_2.json"));
    close("peak", peak(&rows).friction, 25.0175, 5e-3);
    close("time of the peak", peak(&rows).time, 2542.1, 1.0);
    assert_eq!(slips(&rows).len(), 1, "{:?}", slips(&rows));
    close("end", rows.last().unwrap().friction, 19.62, 1e-3);
    assert_eq!(report.cutbacks, 0);
    assert_balanced(&rows);
}

/// Without weakening friction rises to μ_s p = 39.24 and stays; damped steps are enough to see it.
#[test]
fn no_weakening_slides_steadily_at_the_static_coefficient() {
    let (mut case, path) = paper("spring_mass_1.json");
    let (damped, _) = paper("spring_mass_3_damped.json");
    for key in ["scheme", "dt"] {
        case["steps"][0][key] = damped["steps"][0][key].clone();
    }
    let (rows, _) = finish(&(case, path));
    assert!(slips(&rows).is_empty());
    close("peak", peak(&rows).friction, 39.24, 1e-6);
    close("end", rows.last().unwrap().friction, 39.24, 1e-6);
}

/// With the ringing damped away the first slip follows the quasi-static onset: t = 3088.7, 4682.5 and 2299.7.
#[test]
fn damped_runs_slip_first_at_the_quasi_static_onset() {
    for (name, onset) in [("3", 3088.7), ("4", 4682.5), ("5", 2299.7)] {
        let (mut case, path) = paper(&format!("spring_mass_{name}_damped.json"));
        case["steps"][0]["duration"] = json!(1.1 * onset);
        let (rows, _) = finish(&(case, path));
        close(&format!("first slip of case {name}"), slips(&rows)[0], onset, 0.01 * onset);
    }
}

/// With the ringing resolved the first slips come at 3083.50, 4626.02 and 2305.15; case 3's second at 5285.3. Ringing is
/// unstable, and a difference in the last digit grows tenfold every 150 to 500 s: it moves the first slip of case 4 by some 5 s.
/// The paper's scheme, at its increment, is beside them.
#[test]
#[ignore = "cases/paper/README.md, What is found: resolved and Runge–Kutta"]
fn resolved_runs_slip_when_an_independent_integration_does() {
    println!("cases/paper/README.md, What is found: resolved and Runge–Kutta\n");
    println!(
        "| case | slip | Runge–Kutta | resolved | Wilson-θ, Δt = 0.05 | energy error over the work: resolved | Wilson-θ |"
    );
    println!("|---|---|---|---|---|---|---|");
    for (name, references, end) in
        [("3", &[3083.50, 5285.3][..], 12000.0), ("4", &[4626.02], 12000.0), ("5", &[2305.15], 8000.0)]
    {
        let [resolved, wilson] = ["", "_wilson"].map(|way| finish(&paper(&format!("spring_mass_{name}{way}.json"))).0);
        let [times, theirs] = [&resolved, &wilson].map(|rows| slips(rows));
        let errors = [&resolved, &wilson].map(|rows| energy_error(rows));
        for (k, reference) in references.iter().enumerate() {
            let (slip, tolerance) = [("first", 2e-3), ("second", 3e-3)][k];
            let [exact, ours] = errors;
            println!(
                "| {name} | {slip} | {reference:.1} | {:.1} | {:.1} | {exact:.0e} | {ours:.0e} |",
                times[k], theirs[k]
            );
            close(&format!("{slip} slip of case {name}"), times[k], *reference, tolerance * reference);
        }
        close("end", resolved.last().unwrap().time, end, 1e-6);
        assert_balanced(&resolved);
    }
}

/// Constant friction μ_k p brakes the block: it stops after v₀/(g (μ_k cos θ − sin θ)) = 20.6155 and 103.0772 of slip,
/// less the elastic slip it starts with in any event.
#[test]
fn a_block_on_a_slope_stops_in_time() {
    let down = f64::atan(0.15);
    let along = |row: &Row| row.position[0] * down.cos() - row.position[1] * down.sin();
    for name in ["slope.json", "slope_damped.json", "slope_wilson.json"] {
        let (rows, _) = finish(&paper(name));
        let stop = rows.windows(2).position(|pair| along(&pair[1]) < along(&pair[0])).unwrap();
        let points = [stop - 1, stop, stop + 1].map(|k| (rows[k].time, along(&rows[k])));
        close("time of the first stop", summit(points), 20.6155, 2e-3);
        close("slip", along(&rows[stop]), 103.0772, 5e-3);
        let settled = 10.0 * 9.81 * down.sin();
        close("friction at the end", rows.last().unwrap().friction, settled, 0.05 * settled);
        if name == "slope.json" {
            assert_balanced(&rows);
        }
    }
}

/// The friction changes sign twice a period; no increment, however long, is solved in more than one attempt.
#[test]
fn forced_oscillation_converges_with_any_increment() {
    for dt in [1e-3, 1e-2, 0.1, 0.3] {
        let (mut case, path) = paper("forced_oscillation.json");
        case["steps"][0]["dt"] = json!({"initial": dt});
        let (rows, report) = finish(&(case, path));
        assert_eq!(report.cutbacks, 0, "Δt = {dt}");
        let reversals = rows.windows(2).filter(|pair| pair[0].friction * pair[1].friction < 0.0).count();
        assert_eq!(reversals, 6, "Δt = {dt}: 20 seconds hold six turning points");
    }
}
