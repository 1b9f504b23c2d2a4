//! Spontaneous rupture of a planar fault: arrivals against published ones, and against each other.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use crate::common::{self, Blocks, model, refusal};
use fecontact::model::{Model, State};
use fecontact::output::events::WaveSpeeds;
use fecontact::output::fronts::{Fronts, FrontsInput};
use fecontact::run::error::Error;
use fecontact::run::observer::{Attempt, Observer, Row, Verdict};
use fecontact::run::run;
use serde_json::{Value, json};

/// SCEC TPV205-2D (two patches of other stress) or TPV3-2D as in `cases/rupture/`, in m, s, MPa and kg/1e6, with elements of
/// the size `h` in 48 × 40 km of rock.
fn scec(h: f64, patches: bool, duration: f64, fields: Value) -> Value {
    fault_in([48e3, 20e3], h, patches, duration, fields)
}

/// The same in rock of a length, and of a height on either side. Penalties and damping go with the elements.
fn fault_in([length, height]: [f64; 2], h: f64, patches: bool, duration: f64, fields: Value) -> Value {
    let name = if patches { "tpv205" } else { "tpv3" };
    let mut case = committed(name);
    let divisions = [(length / h) as usize, (height / h) as usize];
    let blocks = Blocks::default()
        .rectangle("lower", divisions, [-0.5 * length, -height], [0.5 * length, 0.0])
        .rectangle("upper", divisions, [-0.5 * length, 0.0], [0.5 * length, height]);
    case["mesh"] = blocks.json();
    let scale = |value: &mut Value, factor: f64| *value = json!(value.as_f64().expect("a number") * factor);
    for body in ["lower", "upper"] {
        scale(&mut case["bodies"][body]["damping"]["stiffness"], h / 100.0);
    }
    scale(&mut case["contacts"]["fault"]["normal"]["alpha_n"], 100.0 / h);
    scale(&mut case["contacts"]["fault"]["friction"]["alpha_t"], 100.0 / h);
    case["steps"][0]["duration"] = json!(duration);
    case["output"] = fields;
    case
}

fn committed(name: &str) -> Value {
    let path = crate::common::repository(format!("cases/rupture/{name}.json"));
    serde_json::from_str(&std::fs::read_to_string(path).expect("a case")).expect("JSON")
}

/// First time at which each point of the fault slips by more than the threshold, and its highest slip rate.
struct Arrivals {
    /// [L/T]
    threshold: f64,
    slips: Vec<f64>,
    time: f64,
    arrivals: Vec<Option<f64>>,
    peaks: Vec<f64>,
    /// whether each point slipped by more than the threshold when last seen
    slipping: Vec<bool>,
    /// when each point stopped
    stopped: Vec<f64>,
    /// points that set out again soon after they had stopped, and points that slipped backwards
    chatter: usize,
    energy_error: f64,
}

/// A point that sets out again within this time chatters; the waves from the ends of the fault that make points slip once
/// more when all have stopped leave them longer [T]
const SOON: f64 = 0.15;

impl Observer for Arrivals {
    fn record(&mut self, _: &Model, attempt: &Attempt) -> Result<(), Error> {
        let Some(state) = attempt.accepted else { return Ok(()) };
        let dt = state.time - self.time;
        for (k, contact) in state.contacts[0].iter().enumerate() {
            let signed = (contact.friction.plastic_slip - self.slips[k]) / dt;
            let rate = signed.abs();
            let sets_out = rate > self.threshold;
            let again = self.arrivals[k].is_some() && sets_out && !self.slipping[k];
            let again = again && state.time - self.stopped[k] < SOON;
            if self.slipping[k] && !sets_out {
                self.stopped[k] = state.time;
            }
            self.chatter += usize::from(again || signed < -self.threshold);
            self.slipping[k] = sets_out;
            self.slips[k] = contact.friction.plastic_slip;
            self.peaks[k] = self.peaks[k].max(rate);
            if self.arrivals[k].is_none() && rate > self.threshold {
                self.arrivals[k] = Some(state.time - 0.5 * dt);
            }
        }
        self.time = state.time;
        let energy = &state.energy;
        self.energy_error = energy.error().abs() / energy.friction_dissipation.max(1e-300);
        Ok(())
    }
}

/// Arrival and highest slip rate at places along the fault; share of energy that the audit misses; how often points
/// chattered.
fn rupture(case: &Value, places: &[f64]) -> (BTreeMap<i64, (f64, f64)>, f64, usize) {
    let model = model(case);
    let n = model.contacts[0].points.len();
    let mut record = Arrivals {
        threshold: 1e-3,
        slips: vec![0.0; n],
        time: 0.0,
        arrivals: vec![None; n],
        peaks: vec![0.0; n],
        slipping: vec![false; n],
        stopped: vec![0.0; n],
        chatter: 0,
        energy_error: 0.0,
    };
    let model = Arc::new(model);
    let (report, result) = run(&model, &mut [&mut record]);
    result.unwrap_or_else(|error| panic!("{error}"));
    println!("{} increments in {:.1} s", report.increments, report.wall_s.total);
    let x = fecontact::mesh::configuration::Configuration::undeformed(&model.mesh.nodes);
    let at = |s: f64| {
        let nearest = |k: &usize| (model.contacts[0].points[*k].at(&x).x - s).abs();
        let k = (0..n).min_by(|a, b| nearest(a).total_cmp(&nearest(b))).expect("points");
        (s as i64, (record.arrivals[k].unwrap_or(f64::INFINITY), record.peaks[k]))
    };
    println!("{} times a point stopped and set out again soon, or slipped backwards", record.chatter);
    (places.iter().map(|&s| at(s)).collect(), record.energy_error, record.chatter)
}

fn compare(case: &Value, expected: &[(f64, f64)], tolerance: f64) {
    let places: Vec<f64> = expected.iter().map(|(s, _)| *s).collect();
    let (found, energy_error, chatter) = rupture(case, &places);
    println!("| place [km] | published [s] | ours [s] | difference | peak slip rate [m/s] |\n|---|---|---|---|---|");
    for (s, published) in expected {
        let (arrival, peak) = found[&(*s as i64)];
        println!(
            "| {} | {published} | {arrival:.3} | {:+.1} % | {peak:.2} |",
            s / 1e3,
            100.0 * (arrival / published - 1.0)
        );
    }
    println!("energy error {energy_error:e} of the dissipation");
    for (s, published) in expected {
        let (arrival, _) = found[&(*s as i64)];
        assert!((arrival - published).abs() <= tolerance * published, "at {s}: {arrival}, published {published}");
    }
    assert!(energy_error < 0.01, "{energy_error}");
    // 960 points and 600 records: elastic bodies without damping have thousands.
    assert!(chatter <= 30, "{chatter}");
}

const TPV205: [(f64, f64); 3] = [(-4500.0, 1.53), (4500.0, 1.53), (7500.0, 2.65)];
/// The fault ends at 15 km: the last point that can break is half an element before.
const TPV3: [(f64, f64); 3] = [(5e3, 1.705), (10e3, 3.397), (14975.0, 5.039)];

fn quiet() -> Value {
    json!({"interval": 0.02, "fields": false})
}

#[test]
#[ignore = "docs/validation/tpv3_tpv205.md: implicit increments"]
fn implicit_and_explicit_increments_agree_on_the_arrival() {
    println!("docs/validation/tpv3_tpv205.md: implicit increments\n");
    // Masses are lumped in one and consistent in the other, which tells in a length of the order of an element: at 400 m
    // the arrivals differ by 8 %, at 125 m by 3 %. Both by nodes: implicit increments would take averages by themselves, which differ by
    // 2.5 % at 62.5 m.
    let mut case = fault_in([14e3, 6e3], 62.5, true, 1.65, json!({"interval": 0.0125, "fields": false}));
    case["contacts"]["fault"]["method"] = json!("node_to_segment");
    let explicit = rupture(&case, &[-4500.0, 4500.0]).0;
    case["steps"][0]["scheme"] = json!({"newmark": {}});
    case["steps"][0]["dt"] = json!({"initial": 0.0125});
    let implicit = rupture(&case, &[-4500.0, 4500.0]).0;
    println!("explicit {explicit:?}, implicit {implicit:?}");
    for (s, (arrival, _)) in &explicit {
        assert!((implicit[s].0 / arrival - 1.0).abs() < 0.02, "at {s}: {arrival}, {:?}", implicit[s]);
    }
}

/// At twice the size of elements, and until the front has passed the first places.
#[test]
fn a_coarse_fault_breaks_in_time() {
    compare(&scec(200.0, true, 2.0, quiet()), &TPV205[..2], 0.06);
}

#[test]
#[ignore = "docs/validation/tpv3_tpv205.md: TPV205"]
fn tpv205_breaks_as_published() {
    println!("docs/validation/tpv3_tpv205.md: TPV205\n");
    compare(&scec(100.0, true, 3.0, quiet()), &TPV205, 0.03);
}

#[test]
#[ignore = "docs/validation/tpv3_tpv205.md: TPV3"]
fn tpv3_breaks_as_published() {
    println!("docs/validation/tpv3_tpv205.md: TPV3\n");
    compare(&scec(100.0, false, 12.0, quiet()), &TPV3, 0.03);
}

#[test]
fn wave_speeds_are_those_of_the_tables() {
    // ν = 0.3: c_R/c_s = 0.9274, c_p/c_s = 1.871
    let material: fecontact::laws::bulk::MaterialParameters =
        serde_json::from_value(json!({"model": "hencky", "E": 2.6, "nu": 0.3, "density": 4.0})).expect("well formed");
    let speeds = WaveSpeeds::of(&*material.build().expect("in range"));
    common::close("c_s", speeds.shear, 0.5, 1e-12);
    common::close("c_R/c_s", speeds.rayleigh / speeds.shear, 0.9274, 1e-4);
    common::close("c_p/c_s", speeds.pressure / speeds.shear, 1.871, 1e-3);
}

/// Rows of a CSV file as texts.
fn rows(path: &Path) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(path).expect("a file");
    text.lines().skip(1).map(|line| line.split(',').map(Into::into).collect()).collect()
}

/// Shows an accepted increment to the observer of fronts.
fn accepted(fronts: &mut Fronts, model: &Model, old: &State, new: &State) {
    let message = Attempt {
        step: &model.steps[0],
        step_number: 0,
        ended: &[],
        passes: &[],
        number: 1,
        old,
        dt: new.time - old.time,
        iterations: &[],
        accepted: Some(new),
        row: Row::Written,
        verdict: Verdict::Accepted,
        cause: None,
        uncertainty: None,
        local_error: None,
    };
    fronts.record(model, &message).expect("a row");
}

/// The middle of a fault slips at 0.6 for 2 s and at 2 for 1 s, rests, and slips at 0.6 for another second: of the first event a share of
/// 2/(1.2 + 2) is faster than 1, from t = 2 on, and the second one is aseismic.
#[test]
fn events_tell_their_seismic_share() {
    let model = model(&scec(2000.0, false, 1.0, quiet()));
    let folder = tempfile::tempdir().expect("a folder");
    let mut old = model.initial_state();
    let criterion = FrontsInput { slip_rate: 0.5, seismic_rate: Some(1.0), arrival: None };
    let mut fronts = Fronts::new(folder.path(), &model, &old, criterion);
    let x = fecontact::mesh::configuration::Configuration::undeformed(&model.mesh.nodes);
    let inside: Vec<bool> = model.contacts[0].points.iter().map(|point| point.at(&x).x.abs() < 5e3).collect();
    for k in 1..=140 {
        let time = 0.05 * f64::from(k);
        let rate = match time - 0.025 {
            t if t < 2.0 => 0.6,
            t if t < 3.0 => 2.0,
            t if t < 5.0 => 0.0,
            t if t < 6.0 => 0.6,
            _ => 0.0,
        };
        let mut new = old.clone();
        new.time = time;
        for (contact, _) in new.contacts[0].iter_mut().zip(&inside).filter(|(_, inside)| **inside) {
            contact.friction.plastic_slip += rate * (new.time - old.time);
        }
        accepted(&mut fronts, &model, &old, &new);
        old = new;
    }
    fronts.finish().expect("written");
    let text = std::fs::read_to_string(folder.path().join("events.csv")).expect("a file");
    let names: Vec<&str> = text.lines().next().expect("names").split(',').collect();
    let events = rows(&folder.path().join("events.csv"));
    let number = |event: usize, name: &str| {
        let column = names.iter().position(|column| *column == name).expect("a column");
        events[event][column].parse::<f64>().expect("a number")
    };
    assert_eq!(events.len(), 2);
    common::close("share", number(0, "seismic_share"), 0.625, 1e-9);
    common::close("onset", number(0, "seismic_onset"), 2.0, 1e-9);
    assert_eq!(number(1, "seismic_share"), 0.0);
    assert!(number(1, "seismic_onset").is_nan());
}

#[test]
fn fronts_tell_when_and_how_fast_a_given_front_ran() {
    let model = model(&scec(2000.0, false, 1.0, quiet()));
    let folder = tempfile::tempdir().expect("a folder");
    let mut old = model.initial_state();
    let mut fronts =
        Fronts::new(folder.path(), &model, &old, FrontsInput { slip_rate: 0.5, seismic_rate: None, arrival: None });
    // From the middle to both ends at 2500 m/s, behind it 1 m/s of slip; after 6.5 s it rests, and at 9 s it starts again.
    let x = fecontact::mesh::configuration::Configuration::undeformed(&model.mesh.nodes);
    let places: Vec<f64> = model.contacts[0].points.iter().map(|point| point.at(&x).x).collect();
    for k in 1..=240 {
        let time = 0.05 * f64::from(k);
        let mut new = old.clone();
        new.time = time;
        for (contact, s) in new.contacts[0].iter_mut().zip(&places) {
            let arrival = s.abs() / 2500.0;
            let second = (time - 9.0).min(6.0);
            contact.friction.plastic_slip = (time.min(6.5) - arrival).max(0.0) + (second - arrival).max(0.0);
        }
        // Loads and stored energies give 3 a second.
        (new.energy.external_work, new.energy.strain) = (5.0 * time, 2.0 * time);
        accepted(&mut fronts, &model, &old, &new);
        old = new;
    }
    fronts.finish().expect("written");
    let speeds = WaveSpeeds::of(&*model.bodies[0].material);
    let number = |row: &[String], k: usize| row[k].parse::<f64>().expect("a number");
    let found = rows(&folder.path().join("fronts.csv"));
    let mut again = 0;
    for row in &found {
        let (s, passage) = (number(row, 3), row[5].as_str());
        let arrival = s.abs() / 2500.0 + if passage == "2" { 9.0 } else { 0.0 };
        again += usize::from(passage == "2");
        common::close("arrival", number(row, 6), arrival, 0.051);
        if (4e3..12e3).contains(&s.abs()) {
            common::close("speed", number(row, 7), 2500.0, 0.12 * 2500.0);
            common::close("ratio", number(row, 8), number(row, 7) / speeds.rayleigh, 1e-9);
            common::close("ratio", number(row, 9), number(row, 7) / 3464.0, 1e-6);
        }
        // All that is nearer to the middle has broken before; each passage is an event of its own.
        assert_eq!(row[11], passage);
        common::close("rupture length", number(row, 12), 2.0 * s.abs(), 2000.0);
        common::close("energy", number(row, 13), 3.0 * (number(row, 6) - if passage == "2" { 9.0 } else { 0.0 }), 0.6);
    }
    assert!(again > 10 && found.len() > 30, "{} rows, {again} of a second front", found.len());
}

#[test]
fn what_varies_along_a_fault_is_checked() {
    let refused = |pointer: &str, key: &str, value: Value, words: &str| {
        let mut bad = scec(4000.0, true, 1.0, quiet());
        bad.pointer_mut(pointer).expect("an object")[key] = value;
        let error = refusal(&bad);
        assert!(error.contains(words), "{error}");
    };
    let fault = "/contacts/fault";
    let table = |rows: Value| json!({"x": rows});
    refused(&format!("{fault}/along"), "mu_s", table(json!([])), "contacts.fault.along.mu_s.x: the table is empty");
    refused(&format!("{fault}/along"), "mu_s", table(json!([[1, 0.7], [0, 0.7]])), "must increase: 0 follows 1");
    refused(&format!("{fault}/initial"), "traction", json!("70 + t"), "the time t has no meaning");
    refused(&format!("{fault}/along"), "mu_s", json!("sqrt(x)"), "is not a finite number at");
    refused(&format!("{fault}/along"), "mu_s", json!("0.6 + x/100000"), "not less than \"mu_d\"");
    refused(&format!("{fault}/along"), "mu", json!(0.6), "did you mean `mu_");
    refused(&format!("{fault}/initial"), "pressure", json!("x"), "must be zero or positive");
    refused(&format!("{fault}/initial"), "structure", json!(1.0), "has no structure");
    refused("/output", "fronts", json!({"slip_rate": 0.0}), "output.fronts.slip_rate");
    refused(
        "/output",
        "fronts",
        json!({"slip_rate": 0.1, "seismic_rate": 0.1}),
        "must be above output.fronts.slip_rate",
    );
}

#[test]
fn a_balanced_fault_below_its_strength_stays_at_rest() {
    let mut case = scec(2000.0, true, 0.5, quiet());
    case["contacts"]["fault"]["friction"]["mu_s"] = json!(0.69);
    case["contacts"]["fault"]["along"] = json!({});
    let model = Arc::new(model(&case));
    let (_, result) = run(&model, &mut []);
    let state = result.expect("it runs");
    let fastest = state.velocity.iter().fold(0.0f64, |most, v| most.max(v.abs()));
    assert!(fastest < 1e-12, "{fastest}");
    assert!(model.prestress.iter().any(|force| *force != 0.0));
}

/// From the command line: the files of a case that asks for fronts, and their figures.
#[test]
fn a_case_that_asks_for_fronts_has_its_files_and_figures() {
    let folder = tempfile::tempdir().expect("a folder");
    let case = scec(2000.0, true, 0.4, json!({"interval": 0.02, "fields": false, "fronts": {"slip_rate": 0.001}}));
    let (path, out) = (folder.path().join("fault.json"), folder.path().join("out"));
    std::fs::write(&path, case.to_string()).expect("written");
    let fecontact = |arguments: &[&str]| {
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_fecontact_tested"))
            .args(arguments)
            .output()
            .expect("it starts");
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    };
    let [path, out_name] = [&path, &out].map(|path| path.to_str().expect("unicode"));
    fecontact(&["run", path, "--out", out_name, "--quiet"]);
    let [fronts, history] = ["fronts.csv", "history.csv"].map(|name| rows(&out.join(name)));
    // 24 edges of 2 km with two points each, at every row of the history.
    let stored = fecontact::output::store::read::contacts(&out, |name| name == "slip").expect("a store");
    assert_eq!((history.len(), stored[0].times.len(), stored[0].quantities["slip"].len()), (20, 20, 20 * 48));
    // Positions run from one end of the slave to the other.
    assert!(stored[0].positions.windows(2).all(|pair| pair[0] < pair[1]) && stored[0].positions[0] == 0.0);
    // The overstressed middle is the first to slip.
    let first =
        fronts.iter().min_by(|a, b| a[6].parse::<f64>().unwrap().total_cmp(&b[6].parse().unwrap())).expect("a front");
    assert!(first[0] == "fault" && first[3].parse::<f64>().unwrap().abs() < 2000.0, "{first:?}");
    let summary: Value = serde_json::from_str(&std::fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
    assert_eq!(summary["front_slip_rate"], 0.001);
    common::close("c_s", summary["wave_speeds"][1].as_f64().unwrap(), 3464.0, 0.01);
}
