//! `fecontact law`: a friction law alone, driven along paths of slip and pressure, through the command.

mod confined;

use std::f64::consts::PI;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::common::{Columns, table};
use fecontact::laws::friction::{FrictionParameters, FrictionState, Sliding};
use serde_json::{Value, json};
use tempfile::TempDir;

/// Contact pressure of the paper's point-mass problems.
const PRESSURE: f64 = 98.1;

/// The paper's data.
fn paper() -> Value {
    json!({"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "alpha_t": 1000, "r": 100, "kappa": 10, "xi": 0.002})
}

/// The paper's data with other values.
fn paper_with(changes: &[(&str, Value)]) -> Value {
    let mut law = paper();
    for (key, value) in changes {
        law[*key] = value.clone();
    }
    law
}

/// A test that is good.
fn good() -> Value {
    json!({
        "friction": paper(),
        "initial": {"pressure": PRESSURE},
        "dt": 0.01,
        "path": [{"duration": 1, "slip": {"rate": 0.1}}]
    })
}

fn law(folder: &Path, test: &Value) -> Output {
    fs::write(folder.join("test.json"), test.to_string()).expect("the temporary folder can be written");
    let output =
        Command::new(env!("CARGO_BIN_EXE_fecontact_tested")).current_dir(folder).args(["law", "test.json"]).output();
    output.expect("the program starts")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// What a test leaves behind.
pub struct Done {
    columns: Columns,
    summary: Value,
    message: String,
}

impl Done {
    fn read(folder: &Path, message: String) -> Self {
        let summary = fs::read_to_string(folder.join("summary.json")).expect("summary.json");
        let summary = serde_json::from_str(&summary).expect("JSON");
        Self { columns: table(folder.join("law.csv")), summary, message }
    }

    pub fn of(test: &Value) -> Self {
        let folder = TempDir::new().expect("a temporary folder");
        let output = law(folder.path(), test);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        Self::read(&folder.path().join("out/test"), stderr(&output))
    }

    pub fn column(&self, name: &str) -> &[f64] {
        &self.columns[name]
    }

    fn last(&self, name: &str) -> f64 {
        *self.column(name).last().expect("at least one row")
    }

    /// Rows whose time is this, to round-off.
    fn row_at(&self, time: f64) -> usize {
        let at = |t: &f64| (t - time).abs() < 1e-9 * (1.0 + time);
        self.column("time").iter().position(at).unwrap_or_else(|| panic!("no row at t = {time}"))
    }
}

#[track_caller]
pub fn close(what: &str, actual: f64, expected: f64, tolerance: f64) {
    assert!((actual - expected).abs() <= tolerance, "{what}: {actual} instead of {expected} ± {tolerance:e}");
}

#[test]
fn rows_have_the_promised_columns_and_the_start() {
    let folder = TempDir::new().unwrap();
    let mut test = good();
    test["initial"]["traction"] = json!(-10.25);
    assert_eq!(law(folder.path(), &test).status.code(), Some(0));
    let results = folder.path().join("out/test");
    let text = fs::read_to_string(results.join("law.csv")).unwrap();
    let header = "time,slip,pressure,traction,R,mu,structure,plastic_slip,dissipation,dtraction_dslip,\
                  dtraction_dpressure,evaluations";
    assert_eq!(text.lines().next(), Some(header));
    assert_eq!(text.lines().count(), 1 + 1 + 100);
    assert!(text.lines().nth(1).unwrap().starts_with("0.0,0.0,98.1,-10.25,0.2612"), "{text:.300}");
    assert!(results.join("report.html").exists());
    // The same again, over the old results.
    assert_eq!(law(folder.path(), &test).status.code(), Some(0));
    assert_eq!(fs::read_to_string(results.join("law.csv")).unwrap(), text);
}

/// −li(y) = E₁(−ln y) from its power series, good for y > 0.02.
fn minus_li(y: f64) -> f64 {
    let w = -y.ln();
    let (mut term, mut sum) = (-1.0, -0.577_215_664_901_532_9 - w.ln());
    for k in 1..100 {
        term *= -w / f64::from(k);
        sum += term / f64::from(k);
    }
    sum
}

/// Closed form of monotone loading at constant μ: u(R) = R μ p/α_t − li(R)/r.
#[test]
fn monotone_loading_follows_its_closed_form_with_any_number_of_steps() {
    let constant = paper_with(&[("mu_s", json!(0.2)), ("kappa", json!(0)), ("xi", json!(0))]);
    for ratio in [0.5, 0.9, 0.99] {
        let slip = ratio * 0.2 * PRESSURE / 1000.0 + minus_li(ratio) / 100.0;
        for steps in [1, 7, 10_000] {
            let done = Done::of(&json!({
                "friction": constant, "initial": {"pressure": PRESSURE}, "dt": 1.0 / f64::from(steps),
                "path": [{"duration": 1, "slip": slip}]
            }));
            assert_eq!(done.column("time").len(), steps as usize + 1);
            close("traction", done.last("traction"), ratio * 0.2 * PRESSURE, 1e-6 * 0.2 * PRESSURE);
            close("R", done.last("R"), ratio, 1e-6);
        }
    }
}

/// Closed form of softening: μ = μ_k + (μ₀ − μ_k) exp(−κ s/μ_k), s the plastic slip.
#[test]
fn softening_is_an_exponential_of_plastic_slip() {
    let done = Done::of(&json!({
        "friction": paper_with(&[("xi", json!(0))]), "initial": {"pressure": PRESSURE}, "dt": 1e-4,
        "path": [{"duration": 1, "slip": 0.2}]
    }));
    for (mu, s) in done.column("mu").iter().zip(done.column("plastic_slip")) {
        close("μ", *mu, 0.2 + 0.2 * (-10.0 * s / 0.2).exp(), SOFTENING);
    }
    close("structure", done.last("structure"), done.last("mu") / 0.2, 1e-12);
}
const SOFTENING: f64 = 2e-4;

/// Closed form of ageing at rest: μ = μ_s − (μ_s − μ₀) exp(−ξ t/μ_s).
#[test]
fn rest_is_an_exponential_of_time() {
    let done = Done::of(&json!({
        "friction": paper_with(&[("structure", json!(1))]),
        "initial": {"pressure": PRESSURE, "traction": 19.62}, "dt": 0.1, "path": [{"duration": 400}]
    }));
    for (mu, t) in done.column("mu").iter().zip(done.column("time")) {
        close("μ", *mu, 0.4 - 0.2 * (-0.002 * t / 0.4).exp(), AGEING);
    }
    assert_eq!(done.last("traction"), 19.62);
    assert_eq!(done.last("dissipation"), 0.0);
}
const AGEING: f64 = 2e-5;

/// The paper's data peak at 25.0175 = 0.25502 p, u = 0.040384, R = 0.8711 (closed form), not at μ_s p: users are told.
#[test]
fn the_attained_peak_is_reported() {
    let done = Done::of(&json!({
        "friction": paper_with(&[("xi", json!(0))]), "initial": {"pressure": PRESSURE}, "dt": 1e-4,
        "path": [{"duration": 1, "slip": 0.2}]
    }));
    let peak = &done.summary["peak"];
    let number = |key: &str| peak[key].as_f64().expect("a number");
    close("peak", number("coefficient"), 25.0175 / PRESSURE, 1e-4);
    close("slip at the peak", number("slip"), 0.040384, 1e-4);
    close("R at the peak", number("coefficient") / number("mu"), 0.8711, 1e-3);
    assert!(done.message.contains("peak |q|/p = 0.255"), "{}", done.message);
    close("dissipation", done.summary["dissipation"].as_f64().unwrap(), done.last("dissipation"), 0.0);
}

/// q and μ by the rate equations of section 2 of the law, classical Runge–Kutta with very small steps.
struct Rates {
    mu_s: f64,
    mu_k: f64,
    alpha_t: f64,
    r: f64,
    kappa: f64,
    xi: f64,
    pressure: f64,
}

impl Rates {
    fn at(&self, [q, mu]: [f64; 2], v: f64) -> [f64; 2] {
        let Self { mu_s, mu_k, alpha_t, r, kappa, xi, pressure: p } = *self;
        let ratio = (q / (mu * p)).min(1.0);
        let (loss, gain) = (mu / mu_k - 1.0, 1.0 - mu / mu_s);
        let stiffness = alpha_t + r * -ratio.ln() * mu * p - kappa * ratio * loss * p;
        let lambda = ((alpha_t * v - xi * ratio * gain * p) / stiffness).max(0.0);
        [alpha_t * (v - lambda), -kappa * loss * lambda + xi * gain]
    }

    fn step(&self, state: [f64; 2], v: f64, dt: f64) -> [f64; 2] {
        let from = |k: [f64; 2], part: f64| [0, 1].map(|i| state[i] + part * dt * k[i]);
        let k1 = self.at(state, v);
        let k2 = self.at(from(k1, 0.5), v);
        let k3 = self.at(from(k2, 0.5), v);
        let k4 = self.at(from(k3, 1.0), v);
        [0, 1].map(|i| state[i] + dt / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
    }
}

/// Peaks after holds of 1 to 2048 against the rate equations; between, ageing at rest has its closed form.
#[test]
fn peaks_after_holds_agree_with_the_rate_equations() {
    let path = crate::common::repository("cases/law/hold_slide_hold.json");
    let mut test: Value = serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
    for slide in test["path"].as_array_mut().unwrap().iter_mut().step_by(2) {
        slide["dt"] = json!(0.0005);
    }
    let done = Done::of(&test);
    let holds = done.summary["holds"].as_array().expect("holds");
    assert_eq!(holds.len(), 12);

    let number = |key: &str| test["friction"][key].as_f64().expect("a number");
    let [mu_s, mu_k, alpha_t, r, kappa, xi] = ["mu_s", "mu_k", "alpha_t", "r", "kappa", "xi"].map(number);
    let rates = Rates { mu_s, mu_k, alpha_t, r, kappa, xi, pressure: 1.0 };
    let (dt, v) = (2e-4, 0.1);
    let mut state = [0.0, mu_k];
    let slide = |state: &mut [f64; 2]| {
        (0..20_000).fold(0.0, |peak: f64, _| {
            *state = rates.step(*state, v, dt);
            peak.max(state[0])
        })
    };
    slide(&mut state);
    for (k, hold) in holds.iter().enumerate() {
        let duration = f64::from(1 << k);
        close("hold", hold["duration"].as_f64().unwrap(), duration, 1e-9 * duration);
        state[1] = mu_s - (mu_s - state[1]) * (-xi * duration / mu_s).exp();
        let peak = hold["peak"]["coefficient"].as_f64().unwrap();
        close(&format!("peak after {duration}"), peak, slide(&mut state), AGEING_PEAK);
    }
}
const AGEING_PEAK: f64 = 1e-3;

#[test]
fn turning_points_of_expressions_are_stepped_onto() {
    let done = Done::of(&json!({
        "friction": paper(), "dt": 0.3,
        "path": [{"duration": 7, "slip": "sin(t)", "pressure": "100 - 50*cos(2*t + 1)"}]
    }));
    for (time, slip) in [(0.5 * PI, 1.0), (1.5 * PI, -1.0)] {
        let found = done.column("time").iter().position(|t| (t - time).abs() < 1e-7).expect("the turn of the slip");
        close("slip", done.column("slip")[found], slip, 1e-15);
    }
    for k in 1..=4 {
        let time = 0.5 * (f64::from(k) * PI - 1.0);
        assert!(done.column("time").iter().any(|t| (t - time).abs() < 1e-7), "pressure turns at {time}");
    }
    for k in 0..=23 {
        done.row_at(0.3 * f64::from(k));
    }
    assert_eq!(done.column("time").len(), 24 + 2 + 4 + 1, "multiples of dt, turning points and the end");
}

/// u = sin t through both reversals, as an expression: whatever `dt` is, friction at each row is that of the law led along
/// the same sine in increments of 1e-5 that meet the turns.
#[test]
fn an_oscillation_by_expression_is_right_at_any_increment() {
    let start = FrictionState { traction: 19.62, pressure: PRESSURE, ..FrictionState::default().with_variables([0.2]) };
    let law = serde_json::from_value::<FrictionParameters>(paper()).unwrap().build(f64::NAN).unwrap();
    let mut fine = vec![(0.0, start)];
    for turn in [0.5 * PI, 1.5 * PI, 5.0] {
        let (begin, mut state) = fine.last().cloned().unwrap();
        let parts = ((turn - begin) / 1e-5).ceil();
        let at = |k: f64| begin + (turn - begin) * k / parts;
        for k in 1..=parts as usize {
            let [t0, t1] = [k - 1, k].map(|k| at(k as f64));
            let sliding = Sliding { slip: t1.sin() - t0.sin(), pressure: PRESSURE, dt: t1 - t0 };
            state = law.respond(&state, sliding).unwrap().state;
            fine.push((t1, state.clone()));
        }
    }
    for dt in [1e-3, 1e-2, 0.1, 0.3] {
        let done = Done::of(&json!({
            "friction": paper_with(&[("structure", json!(1))]), "dt": dt,
            "initial": {"traction": 19.62, "pressure": PRESSURE}, "path": [{"duration": 5, "slip": "sin(t)"}]
        }));
        for (time, traction) in done.column("time").iter().zip(done.column("traction")).skip(1) {
            let after = fine.partition_point(|(t, _)| t < time).min(fine.len() - 1);
            let [(t0, before), (t1, after)] = [fine[after - 1].clone(), fine[after].clone()];
            let share = (time - t0) / (t1 - t0);
            let expected = before.traction + share * (after.traction - before.traction);
            close(&format!("Δt = {dt}: friction at {time}"), *traction, expected, 1e-3 * 0.2 * PRESSURE);
        }
    }
}

/// A turn between two samples of the search, exactly in the middle; a plateau; a kink; touch and parting.
#[test]
fn every_kind_of_event_is_found() {
    let rows = |slip: &str, pressure: &str| {
        let path = json!([{"duration": 1, "slip": slip, "pressure": pressure}]);
        Done::of(&json!({"friction": paper(), "dt": 2, "path": path})).columns["time"].clone()
    };
    let middle = 0.5 / 4096.0 + 0.25;
    for (slip, pressure, expected) in [
        (format!("-(t - {middle:?})^2"), "100", vec![middle]),
        ("0.5*(t - 0.3 - abs(t - 0.3))".into(), "100", vec![0.3]),
        ("0.5*(t - 0.3 + abs(t - 0.3))".into(), "100", vec![0.3]),
        ("abs(t - 0.7)".into(), "100", vec![0.7]),
        ("t".into(), "100*(t - 0.2)*(0.8 - t)", vec![0.2, 0.5, 0.8]),
        ("1 + 0*t".into(), "98.1 + t - t", vec![]),
    ] {
        let expected = [vec![0.0], expected, vec![1.0]].concat();
        let times = rows(&slip, pressure);
        assert_eq!(times.len(), expected.len(), "{slip}, {pressure}: {times:?}");
        times.iter().zip(expected).for_each(|(time, expected)| close(&slip, *time, expected, 1e-7));
    }
}

/// A table says the same as the phases it is made of, and is stepped row by row.
#[test]
fn a_table_is_a_path_of_straight_lines() {
    let rows = [[0.0, 0.0, 50.0], [0.5, 0.02, 80.0], [0.7, 0.02, 80.0], [0.70001, -0.01, 60.0], [2.0, 0.1, 98.1]];
    let table = Done::of(&json!({"friction": paper(), "table": rows}));
    assert_eq!(table.column("time"), rows.map(|row| row[0]));
    assert_eq!(table.column("slip"), rows.map(|row| row[1]));
    assert_eq!(table.column("pressure"), rows.map(|row| row[2]));
    let phase =
        |pair: &[[f64; 3]]| json!({"duration": pair[1][0] - pair[0][0], "slip": pair[1][1], "pressure": pair[1][2]});
    let path: Vec<Value> = rows.windows(2).map(phase).collect();
    let phases = Done::of(&json!({"friction": paper(), "initial": {"pressure": 50}, "dt": 10, "path": path}));
    assert_eq!(phases.column("time").len(), rows.len());
    for (a, b) in table.column("traction").iter().zip(phases.column("traction")) {
        close("traction", *a, *b, 1e-9);
    }
    // With a dt there are steps between the rows too.
    let fine = Done::of(&json!({"friction": paper(), "table": rows, "dt": 0.1}));
    for [time, ..] in rows {
        fine.row_at(time);
    }
    assert_eq!(fine.column("time").len(), 1 + 5 + 2 + 1 + 13);
}

/// A row without pressure is answered at its own time, to the last bit. Just before it the surfaces still slide: q = α_t u meets
/// μ p = μ (1 − t) at t = 0.375, and α_t = 1000, u = t/1000 leave (1 − 0.375 + 0.6 · 0.625)/1000 = 0.001 of plastic slip at t = 1.
#[test]
fn a_row_without_pressure_keeps_its_time() {
    let coulomb = json!({"law": "coulomb", "mu": 0.6, "alpha_t": 1000});
    for dt in [None, Some(0.1)] {
        let mut test = json!({"friction": coulomb, "table": [[0, 0, 1], [1, 0.001, 0], [2, 0.002, 1]]});
        if let Some(dt) = dt {
            test["dt"] = json!(dt);
        }
        let done = Done::of(&test);
        let row = done.column("time").iter().position(|time| *time == 1.0).expect("a row at t = 1");
        assert_eq!([done.column("pressure")[row], done.column("traction")[row]], [0.0, 0.0]);
        close("plastic slip where they part", done.column("plastic_slip")[row], 1e-3, 1e-12);
        close("traction at the end", done.last("traction"), 0.6, 1e-12);
    }
    // 3 · 0.1 is not 0.3 in floating point: a row is not moved to the multiple of dt beside it.
    let rows = [[0.0, 0.0, 1.0], [0.3, 0.001, 0.0], [0.6, 0.002, 1.0]];
    let done = Done::of(&json!({"friction": coulomb, "dt": 0.1, "table": rows}));
    let row = done.column("time").iter().position(|time| *time == 0.3).expect("a row at t = 0.3");
    assert_eq!(done.column("pressure")[row], 0.0);
}

/// All laws are driven; friction that is switched off shows.
#[test]
fn every_law_can_be_driven() {
    let end = |friction: Value| {
        let mut test = good();
        test["friction"] = friction;
        Done::of(&test).last("traction")
    };
    close("Coulomb", end(json!({"law": "coulomb", "mu": 0.3, "alpha_t": 1000})), 0.3 * PRESSURE, 1e-12);
    assert_eq!(end(json!({"law": "frictionless"})), 0.0);
    assert!(end(paper()) > 19.6);
}

#[test]
fn a_pressure_past_the_uniqueness_limit_is_told() {
    let mut test = good();
    assert!(!Done::of(&test).message.contains("warning"));
    test["initial"]["pressure"] = json!(100.5);
    let done = Done::of(&test);
    for text in [&done.message, done.summary["warnings"][0].as_str().unwrap()] {
        assert!(text.contains("the pressure 100.5 at t = 0 exceeds 100,"), "{text}");
    }
    assert_eq!(done.summary["warnings"].as_array().unwrap().len(), 1);
}

/// A step that the law cannot answer stops the test: what was computed is kept and shown, and the reason told.
#[test]
fn a_test_that_stops_keeps_its_rows() {
    let folder = TempDir::new().unwrap();
    let mut test = good();
    test["path"] = json!([{"duration": 1, "slip": {"table": [[0, 0], [0.5, 0.05], [1, 1e307]]}}]);
    let output = law(folder.path(), &test);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(stderr(&output).contains("stopped: the law stopped after time 0.5"), "{}", stderr(&output));
    let done = Done::read(&folder.path().join("out/test"), String::new());
    assert_eq!(done.column("time").len(), 51);
    assert_eq!(done.summary["status"], "stopped");
    assert!(done.summary["reason"].as_str().unwrap().contains("the law stopped after time 0.5"));
    assert!(folder.path().join("out/test/report.html").exists());
}

/// Nine days of sticking and slipping without end in one step, far beyond the limit of uniqueness: an answer to the
/// tolerance is not to be had, and none is given. Shorter steps are answered.
#[test]
fn a_step_that_does_not_converge_stops_the_test() {
    let friction = json!({"law": "super_subloading", "mu_s": 0.054, "mu_k": 0.015, "alpha_t": 8600, "r": 260,
                          "kappa": 30, "xi": 2.6e-4, "tolerance": 1e-3});
    let test = |dt: f64| {
        json!({"friction": friction, "initial": {"pressure": 1800},
               "path": [{"duration": 8e5, "dt": dt, "slip": 0.5}]})
    };
    let folder = TempDir::new().unwrap();
    let output = law(folder.path(), &test(8e5));
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(stderr(&output).contains("the friction law did not converge within 20"), "{}", stderr(&output));
    let done = Done::read(&folder.path().join("out/test"), String::new());
    assert!(done.summary["reason"].as_str().unwrap().contains("did not converge"));
    assert!(Done::of(&test(1e3)).last("dissipation") > 0.0);
}

/// Every committed test runs, and has a title.
#[test]
fn committed_tests_run() {
    let folder = crate::common::repository("cases/law");
    let mut count = 0;
    for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if path.extension() != Some("json".as_ref()) {
            continue;
        }
        let test: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
        assert!(test["title"].as_str().is_some_and(|title| title.len() > 20), "{}", path.display());
        assert!(Done::of(&test).column("time").len() > 100);
        count += 1;
    }
    assert_eq!(count, 7);
}

/// The good test with the value at a pointer set, or taken away.
fn with(pointer: &str, value: Option<Value>) -> Value {
    let mut test = good();
    let (parent, key) = pointer.rsplit_once('/').expect("a pointer begins with a slash");
    match (test.pointer_mut(parent).and_then(Value::as_object_mut).expect("an object"), value) {
        (object, Some(value)) => object.insert(key.into(), value),
        (object, None) => object.remove(key),
    };
    test
}

pub fn refused(test: &Value, fragments: &[&str]) {
    let folder = TempDir::new().unwrap();
    let output = law(folder.path(), test);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{test} {fragments:?}: {message}");
    assert!(message.starts_with("error: test.json: ") && !message.contains("panicked"), "{message}");
    for fragment in fragments {
        assert!(message.contains(fragment), "`{fragment}` is not in: {message}");
    }
    assert!(!folder.path().join("out").exists(), "results were written: {message}");
}

#[test]
fn bad_tests_are_refused() {
    for (pointer, value, fragments) in [
        ("/pth", json!([]), ["pth: ", "did you mean `path`?"]),
        ("/initial/tracton", json!(1), ["initial.tracton: ", "did you mean `traction`?"]),
        ("/friction/mus", json!(1), ["friction.mus: ", "did you mean `mu_s`?"]),
        ("/friction/mu_k", json!(-0.2), ["friction: ", "\"mu_k\" is -0.2"]),
        ("/friction/structure", json!(3), ["friction: ", "\"structure\" is 3"]),
        ("/friction/law", json!("colomb"), ["friction.law: ", "did you mean `coulomb`?"]),
        ("/path", json!([]), ["path: ", "at least one phase"]),
        ("/path", json!([[0, 0, 1]]), ["path[0]: ", "must be an object"]),
        ("/table", json!([[0, 0, 1], [1, 1, 1]]), ["either \"path\"", "or \"table\""]),
        ("/dt", json!(0), ["dt: ", "must be positive"]),
        ("/dt", json!(1e-12), ["dt: ", "1e7 are allowed"]),
        ("/initial/pressure", json!(-1), ["initial.pressure: ", "is -1: must be zero or positive"]),
        (
            "/initial/traction",
            json!(39.3),
            ["initial.traction: ", "39.3, above the initial strength mu p = 0.4 · 98.1 = 39.24"],
        ),
        ("/initial/traction", json!(-39.3), ["initial.traction: ", "is -39.3, above the initial strength"]),
        ("/path", json!([{"duration": 0}]), ["path[0].duration: ", "must be positive"]),
        ("/path", json!([{"duration": 1, "dt": -1}]), ["path[0].dt: ", "must be positive"]),
        ("/path", json!([{"duration": 1, "slip": "x*t"}]), ["path[0].slip: ", "the only variable is the time t"]),
        ("/path", json!([{"duration": 1, "slip": "2*z"}]), ["path[0].slip: ", "`z` is not one of the variables"]),
        (
            "/path",
            json!([{"duration": 1, "slip": "ln(t - 0.5)"}]),
            ["path[0].slip: ", "not a finite number at the time 0:"],
        ),
        ("/path", json!([{"duration": 1, "slip": "sin("}]), ["path[0].slip: ", "cannot be read"]),
        ("/path", json!([{"duration": 1, "slip": {"table": []}}]), ["path[0].slip: ", "the table is empty"]),
        (
            "/path",
            json!([{"duration": 1, "pressure": "50*t"}]),
            ["path[0].pressure: ", "jumps from 98.1 to 0 at t = 0"],
        ),
        (
            "/path",
            json!([{"duration": 1, "slip": 1}, {"duration": 1, "slip": "t"}, {"duration": 1, "slip": "t + 0.5"}]),
            ["path[2].slip: ", "jumps from 2 to 2.5 at t = 2"],
        ),
    ] {
        refused(&with(pointer, Some(value)), &fragments);
    }
    refused(&with("/friction/alpha_t", None), &["friction: ", "`alpha_t` is missing", "no mesh to choose it from"]);
    refused(&with("/friction", None), &["the key `friction` is missing here"]);
    refused(&with("/path", None), &["either \"path\"", "or \"table\""]);
    refused(&with("/initial", None), &["path[0].pressure: ", "is missing: give it here, or as initial.pressure"]);
    let mut rate = with("/initial", None);
    rate["path"][0]["pressure"] = json!({"rate": 1});
    refused(&rate, &["path[0].pressure: ", "a rate needs a value to start from"]);
    let table =
        |rows: Value, pressure: Value| json!({"friction": paper(), "initial": {"pressure": pressure}, "table": rows});
    refused(&table(json!([[0, 0, 1]]), Value::Null), &["table: ", "two rows [time, slip, pressure] or more"]);
    refused(&table(json!([[0, 0, 1], [0, 1, 1]]), Value::Null), &["table: ", "the times must increase: 0 follows 0"]);
    refused(&table(json!([[0, 0, 1], [1, 1]]), Value::Null), &["table[1]: ", "2 entries"]);
    refused(
        &table(json!([[0, 0, 1], [1, 1, 1]]), json!(2)),
        &["initial.pressure: ", "is 2, but the table starts at 1"],
    );
    refused(&json!([1]), &["must be an object"]);
}

#[test]
fn frictionless_surfaces_start_without_traction() {
    let test = json!({"friction": {"law": "frictionless"}, "initial": {"traction": 1, "pressure": 10}, "path": [{"duration": 1}]});
    refused(&test, &["initial.traction: ", "above the initial strength"]);
}

/// A traction at the strength as it is written with seven digits starts, and slides at the strength from there.
#[test]
fn a_rounded_strength_is_no_violation() {
    let folder = TempDir::new().unwrap();
    let (mu, pressure) = (0.3, 7.0);
    let laws = [
        json!({"law": "coulomb", "mu": mu, "alpha_t": 1e3}),
        json!({"law": "super_subloading", "mu_s": mu, "mu_k": mu, "alpha_t": 1e3, "r": 100}),
        json!({"law": "slip_weakening", "mu_s": mu, "mu_d": mu / 2.0, "D_c": 1e6, "alpha_t": 1e3}),
    ];
    for friction in laws {
        let test = json!({
            "friction": friction, "initial": {"traction": mu * pressure * (1.0 + 5e-7)},
            "path": [{"duration": 1, "slip": {"rate": 0.1}, "pressure": pressure}],
        });
        let output = law(folder.path(), &test);
        assert!(output.status.success(), "{friction}: {}", stderr(&output));
    }
}
