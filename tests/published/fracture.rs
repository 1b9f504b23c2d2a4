//! Fronts against fracture mechanics: the speed of a front under a uniform traction, and where it ends under a lower one.
//!
//! A half plane that slides without drop of its traction up to x = 0 is a crack. From x = 0 on the traction before slip exceeds
//! that of sliding by Δτ(x). A front that has run to x = l at the speed v feeds the energy
//!
//! ```text
//! G = g(v) (1 − ν²)/E K²,   K = √(2/π) ∫₀ˡ Δτ/√(l − x) dx,   g(v) = A(v) k(v)²
//! A = v² α_s/((1 − ν) c_s² D),   α² = 1 − v²/c²,   D = 4 α_p α_s − (1 + α_s²)²
//! k = (1 − v/c_R) S(1/v)/√(1 − v/c_s)
//! ln S(ζ) = (1/π) ∫ arctan(4 η² √(η² − a²) √(b² − η²)/(b² − 2η²)²)/(ζ − η) dη from a = 1/c_p to b = 1/c_s
//! ```
//!
//! into its tip whatever it did before, and it consumes Γ, the work that its law takes beyond that of sliding. The tip has no
//! inertia: g(v) (1 − ν²)/E K(l)² = Γ gives v at every l, and ends where this takes v = 0.
//!
//! Source: Freund, Dynamic Fracture Mechanics (1990), sections 5.3, 6.4 and 7.4.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::Arc;

use crate::common::{self, Blocks, close};
use fecontact::laws::friction::{FrictionParameters, Sliding};
use fecontact::model::Model;
use fecontact::output::fronts::{ArrivalInput, Fronts, FrontsInput};
use fecontact::run::run;
use fecontact::run::{Attempt, Error, Observer};
use serde_json::{Value, json};

/// E/ρ, ν: c_s = 1 for ρ = 1
const E: f64 = 2.5;
const NU: f64 = 0.25;
const PRESSURE: f64 = 1e-2;
/// Tractions of sliding, and of the peak
const SLIDING: f64 = 2e-3;
const PEAK: f64 = 3e-3;
/// Traction before slip: the strength is four times as far above it as that of sliding is below.
const TRACTION: f64 = 2.2e-3;

/// Number of the contact that has to break: contacts are in the order of their names.
const BREAKING: usize = 0;

/// c_p, and c_R where c_s = 1
fn speeds() -> (f64, f64) {
    let pressure = ((2.0 - 2.0 * NU) / (1.0 - 2.0 * NU)).sqrt();
    let (mut low, mut high) = (0.5, 0.9999);
    for _ in 0..60 {
        let v: f64 = 0.5 * (low + high);
        let (p, s) = ((1.0 - (v / pressure).powi(2)).sqrt(), (1.0 - v * v).sqrt());
        if 4.0 * p * s > (1.0 + s * s).powi(2) { low = v } else { high = v }
    }
    (pressure, low)
}

/// g(v)
fn energy_factor(v: f64) -> f64 {
    let (pressure, rayleigh) = speeds();
    let (a, b) = (1.0 / pressure, 1.0);
    let n = 400;
    let log_s: f64 = (0..n)
        .map(|i| {
            let angle = PI * (f64::from(i) + 0.5) / f64::from(n);
            let eta = 0.5 * (a + b) - 0.5 * (b - a) * angle.cos();
            let roots = ((eta * eta - a * a) * (b * b - eta * eta)).sqrt();
            let arc = (4.0 * eta * eta * roots / (b * b - 2.0 * eta * eta).powi(2)).atan();
            arc / (1.0 / v - eta) * 0.5 * (b - a) * angle.sin() / f64::from(n)
        })
        .sum();
    let k = (1.0 - v / rayleigh) / (1.0 - v).sqrt() * log_s.exp();
    let (p, s) = ((1.0 - (v / pressure).powi(2)).sqrt(), (1.0 - v * v).sqrt());
    v * v * s / ((1.0 - NU) * (4.0 * p * s - (1.0 + s * s).powi(2))) * k * k
}

/// v/c_R where g(v) is this share.
fn speed_for(share: f64) -> f64 {
    let (_, rayleigh) = speeds();
    let (mut low, mut high) = (1e-4, 0.9999);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if energy_factor(middle * rayleigh) > share { low = middle } else { high = middle }
    }
    low
}

/// Γ: work of a law along its own curve from the traction before slip on, beyond that of sliding [F/L]
fn fracture_energy(law: &Value) -> f64 {
    let law = serde_json::from_value::<FrictionParameters>(law.clone()).expect("a law").build(1.0).expect("in range");
    let mut state = law.initial_state(0.0, 0.0);
    (state.traction, state.pressure) = (TRACTION, PRESSURE);
    let mut work = 0.0;
    for _ in 0..200_000 {
        let old = state;
        state = law.respond(&old, Sliding { slip: 1e-8, pressure: PRESSURE, dt: 1e-6 }).expect("an answer").state;
        work += (0.5 * (old.traction + state.traction) - SLIDING) * (state.plastic_slip - old.plastic_slip);
    }
    work
}

/// A front in two half planes.
struct Problem {
    /// Elements on the way of the front, as long as high there
    h: f64,
    law: Value,
    /// Γ [F/L]
    energy: f64,
    /// Up to here nothing but sliding resists from the start on.
    begin: f64,
    /// Where the elements grow longer
    end: f64,
    /// (x, share): from x on the traction is above that of sliding by a share of what it is before.
    lower: Option<(f64, f64)>,
    duration: f64,
    height: f64,
}

impl Problem {
    fn new(h: f64, law: Value) -> Self {
        let energy = fracture_energy(&law);
        // The length at which the front sets out.
        let unit = critical_length(energy);
        Self {
            h,
            law,
            energy,
            begin: 1.15 * unit,
            end: 3.9 * unit,
            lower: None,
            duration: 5.4 * unit,
            height: 4.0 * unit,
        }
    }

    fn case(&self) -> Value {
        let unit = critical_length(self.energy);
        let (from, left, right) = (-0.5 * unit, -5.0 * unit, self.end + 2.4 * unit);
        let uniform = ((self.end - from) / self.h).round() as usize;
        let (before, behind, layers) =
            (graded(from - left, self.h), graded(right - self.end, self.h), graded(self.height, self.h));
        let x: Vec<f64> = before
            .iter()
            .rev()
            .map(|d| from - d)
            .chain((1..uniform).map(|i| from + (self.end - from) * i as f64 / uniform as f64))
            .chain(behind.iter().map(|d| self.end + d))
            .collect();
        let blocks = [("lower", -1.0), ("upper", 1.0)].into_iter().fold(Blocks::default(), |blocks, (name, side)| {
            let n = [x.len() - 1, layers.len() - 1];
            blocks.block(name, n, |s, t| {
                let (i, j) = ((s * n[0] as f64).round() as usize, (t * n[1] as f64).round() as usize);
                [x[i], if side > 0.0 { layers[j] } else { -layers[n[1] - j] }]
            })
        });
        let elastic = json!({"material": {"model": "linear", "E": E, "nu": NU, "density": 1.0},
            "damping": {"stiffness": 0.02 * self.h / speeds().0}});
        let edge = 1e-6 * unit;
        let mut before = vec![(left, SLIDING), (-edge, SLIDING), (0.0, TRACTION)];
        match self.lower {
            None => before.push((right, TRACTION)),
            Some((x, share)) => {
                let lower = SLIDING + share * (TRACTION - SLIDING);
                before.extend([(x - edge, TRACTION), (x, lower), (right, lower)]);
            }
        }
        let before: Vec<_> = before.iter().map(|(x, q)| [*x, *q]).collect();
        let mut mesh = blocks.json();
        let (sliding, breaking) = self.parts(&mesh);
        mesh["edges"]["sliding"] = sliding;
        mesh["edges"]["breaking"] = breaking;
        let alpha = 4.0 * E / self.h;
        let mut law = self.law.clone();
        law["alpha_t"] = json!(alpha);
        let resting = json!({"law": "slip_weakening", "mu_s": SLIDING / PRESSURE, "mu_d": SLIDING / PRESSURE, "D_c": unit,
            "alpha_t": alpha});
        let contact = |slave: &str, law: Value| {
            json!({"slave": slave, "master": "lower_top", "sliding": "small", "normal": {"alpha_n": alpha}, "friction": law,
                "initial": {"pressure": PRESSURE, "balanced": true, "traction": {"x": before}}})
        };
        let sides = ["lower_left", "lower_right", "lower_bottom", "upper_left", "upper_right", "upper_top"];
        let absorbing = sides.map(|side| json!({"on": side, "absorbing": true}));
        json!({
            "mesh": mesh,
            "bodies": {"lower": elastic, "upper": elastic},
            "contacts": {"sliding": contact("sliding", resting), "breaking": contact("breaking", law)},
            "steps": [{"name": "run", "duration": self.duration, "scheme": {"explicit": {}}, "dt": {"initial": 1},
                "loads": absorbing}],
            "output": {"interval": 0.01 * unit, "fields": false}})
    }

    /// Edges of the upper half plane that slide from the start on, and those that the front has to break.
    fn parts(&self, mesh: &Value) -> (Value, Value) {
        let edges = mesh["edges"]["upper_bottom"].as_array().expect("edges").clone();
        let middle = |edge: &Value| {
            let x = |k: usize| mesh["nodes"][edge[k].as_u64().expect("a node") as usize][0].as_f64().expect("a place");
            0.5 * (x(0) + x(1))
        };
        let (sliding, breaking): (Vec<_>, Vec<_>) = edges.into_iter().partition(|edge| middle(edge) < self.begin);
        (json!(sliding), json!(breaking))
    }

    /// Places of the points, and when each had slipped by half of what the fracture energy takes.
    fn arrivals(&self) -> Vec<(f64, Option<f64>)> {
        let model = Arc::new(common::model(&self.case()));
        let points = model.contacts[BREAKING].points.len();
        let half = 0.5 * self.energy / (PEAK - SLIDING);
        let mut record = Passages { half, time: 0.0, slips: vec![0.0; points], at: vec![None; points] };
        run(&model, &mut [&mut record]).1.unwrap_or_else(|error| panic!("{error}"));
        let x = model.mesh.undeformed();
        let mut all: Vec<_> =
            model.contacts[BREAKING].points.iter().map(|point| point.at(&x).x).zip(record.at).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all
    }

    /// Speed of the front at x over c_R: of the straight line through the arrivals around.
    fn speed(arrivals: &[(f64, Option<f64>)], at: f64, around: f64) -> f64 {
        let near: Vec<(f64, f64)> = arrivals
            .iter()
            .filter(|(x, _)| (x - at).abs() < around)
            .map(|(x, t)| (*x, t.expect("the front passed")))
            .collect();
        let n = near.len() as f64;
        let (x, t) = near.iter().fold((0.0, 0.0), |sum, (x, t)| (sum.0 + x / n, sum.1 + t / n));
        let (both, square) =
            near.iter().fold((0.0, 0.0), |sum, (a, b)| (sum.0 + (a - x) * (b - t), sum.1 + (b - t).powi(2)));
        both / square / speeds().1
    }
}

/// l at which G of a resting front under the uniform traction is Γ.
fn critical_length(energy: f64) -> f64 {
    PI * E * energy / (8.0 * (1.0 - NU * NU) * (TRACTION - SLIDING).powi(2))
}

/// Distances of element sides that grow by a tenth, from 0 to `length`.
fn graded(length: f64, h: f64) -> Vec<f64> {
    let mut sides = vec![0.0];
    let mut step = h;
    while sides[sides.len() - 1] < length {
        sides.push(sides[sides.len() - 1] + step);
        step *= 1.1;
    }
    let scale = length / sides[sides.len() - 1];
    sides.iter().map(|side| side * scale).collect()
}

/// When each point had slipped by so much.
struct Passages {
    half: f64,
    time: f64,
    slips: Vec<f64>,
    at: Vec<Option<f64>>,
}

impl Observer for Passages {
    fn record(&mut self, _: &Model, attempt: &Attempt) -> Result<(), Error> {
        let Some(state) = attempt.accepted else { return Ok(()) };
        for (k, point) in state.contacts[BREAKING].iter().enumerate() {
            let (before, slip) = (self.slips[k], point.friction.plastic_slip.abs());
            if self.at[k].is_none() && slip >= self.half {
                let share = (self.half - before) / (slip - before);
                self.at[k] = Some(self.time + share * (state.time - self.time));
            }
            self.slips[k] = slip;
        }
        self.time = state.time;
        Ok(())
    }
}

/// Slip weakening with a fracture energy that makes the critical length 1 but for the contact spring.
fn slip_weakening() -> Value {
    let energy = 8.0 * (1.0 - NU * NU) * (TRACTION - SLIDING).powi(2) / (PI * E);
    json!({"law": "slip_weakening", "mu_s": PEAK / PRESSURE, "mu_d": SLIDING / PRESSURE, "alpha_t": 4.0 * E / 0.0125,
        "D_c": 2.0 * energy / (PEAK - SLIDING)})
}

/// The super/subloading law that loses its structure over a like length, without recovery.
fn super_subloading() -> Value {
    let energy = 8.0 * (1.0 - NU * NU) * (TRACTION - SLIDING).powi(2) / (PI * E);
    let kappa = (PEAK - SLIDING) / energy * SLIDING / PRESSURE;
    json!({"law": "super_subloading", "mu_s": PEAK / PRESSURE, "mu_k": SLIDING / PRESSURE, "alpha_t": 4.0 * E / 0.0125,
        "r": 60.0 * kappa * PRESSURE / SLIDING, "kappa": kappa, "xi": 0.0})
}

/// Print speeds over the way, and the largest difference relative to those of the equation of motion.
fn compare(problem: &Problem, ways: impl Iterator<Item = f64>) -> f64 {
    let unit = critical_length(problem.energy);
    let arrivals = problem.arrivals();
    println!("| l/l_c | v/c_R | equation of motion | difference |\n|---|---|---|---|");
    ways.fold(0.0, |worst, l| {
        let (found, expected) = (Problem::speed(&arrivals, l * unit, 0.06 * unit), speed_for(1.0 / l));
        println!("| {l:.2} | {found:.3} | {expected:.3} | {:+.1} % |", 100.0 * (found / expected - 1.0));
        assert!(found.is_finite(), "no front at {l}");
        f64::max(worst, (found / expected - 1.0).abs())
    })
}

/// From half the speed of Rayleigh waves to 0.9 of it, for two laws.
fn fronts_run(h: f64, within: f64) {
    for law in [slip_weakening(), super_subloading()] {
        println!("{}", law["law"]);
        let worst = compare(&Problem::new(h, law), (8..=18).map(|i| 0.2 * f64::from(i)));
        println!("at most {worst:.3}");
        assert!(worst < within, "{worst}");
    }
}

#[test]
fn fronts_run_as_fracture_mechanics_says() {
    fronts_run(0.025, 0.06);
}

/// On elements of half the size.
#[test]
#[ignore = "docs/validation/front_speed.md"]
fn fronts_on_fine_elements_run_as_fracture_mechanics_says() {
    fronts_run(0.0125, 0.03);
}

/// The event of a front: Γ of its law and the drop of traction where it has passed, its energies those of the audit, and its
/// speed that of its arrivals.
#[test]
fn the_table_of_events_tells_what_a_front_did() {
    let mut problem = Problem::new(0.025, slip_weakening());
    problem.duration = 4.0;
    let model = Arc::new(common::model(&problem.case()));
    let folder = tempfile::tempdir().expect("a folder");
    let half = 0.5 * problem.energy / (PEAK - SLIDING);
    let start = model.initial_state();
    let mut fronts = Fronts::new(
        folder.path(),
        &model,
        &start,
        FrontsInput { slip_rate: 0.01 * half, seismic_rate: None, arrival: Some(ArrivalInput::R(0.999_999)) },
    );
    let points = model.contacts[BREAKING].points.len();
    let mut passages = Passages { half, time: 0.0, slips: vec![0.0; points], at: vec![None; points] };
    let mut energies = Energies::default();
    run(&model, &mut [&mut fronts, &mut passages, &mut energies]).1.unwrap_or_else(|error| panic!("{error}"));

    let text = std::fs::read_to_string(folder.path().join("events.csv")).expect("a table");
    let mut lines = text.lines().map(|line| line.split(','));
    let header: Vec<&str> = lines.next().expect("a header").collect();
    let rows: Vec<BTreeMap<&str, &str>> = lines.map(|line| header.iter().copied().zip(line).collect()).collect();
    let row = rows.iter().find(|row| row["contact"] == "breaking").expect("an event");
    let number = |column: &str| row[column].parse::<f64>().expect("a number");
    let reached: Vec<f64> = passages.slips.iter().copied().filter(|slip| *slip > 0.0).collect();
    println!("{row:#?}");
    close("fracture energy", number("fracture_energy"), problem.energy, 0.05 * problem.energy);
    close("stress drop", number("stress_drop"), TRACTION - SLIDING, 0.1 * (TRACTION - SLIDING));
    close(
        "largest slip",
        number("largest_slip"),
        reached.iter().copied().fold(0.0, f64::max),
        1e-12 * number("largest_slip"),
    );
    close("length", number("length"), problem.h * reached.len() as f64 / 2.0, 3.0 * problem.h);
    // All that was radiated is still there as motion, or has gone into dampers and absorbing sides, or into the audit's error.
    close("radiated", number("energy_radiated"), energies.motion, 1e-3 * number("energy_released"));
    assert!(number("over") == 0.0 && number("energy_radiated") > 0.0);
    let middle = 0.5 * (number("position") + number("length"));
    assert!(middle > 0.0 && (0.3..1.0).contains(&number("front_speed_over_c_R")), "{row:?}");
}

/// Kinetic energy and what was damped since the first record.
#[derive(Default)]
struct Energies {
    motion: f64,
}

impl Observer for Energies {
    fn record(&mut self, _: &Model, attempt: &Attempt) -> Result<(), Error> {
        if let Some(state) = attempt.accepted {
            self.motion = state.energy.kinetic + state.energy.damping_dissipation;
        }
        Ok(())
    }
}

/// Into a traction whose drop is 0.3 of that before: √l − 0.7 √(l − 1.8) = 1 where the front ends.
#[test]
fn fronts_end_where_fracture_mechanics_says() {
    for law in [slip_weakening(), super_subloading()] {
        let mut problem = Problem::new(0.025, law);
        let unit = critical_length(problem.energy);
        (problem.lower, problem.duration) = (Some((1.8 * unit, 0.3)), 8.0 * unit);
        let (mut low, mut high) = (1.8, 4.0);
        for _ in 0..60 {
            let l: f64 = 0.5 * (low + high);
            if l.sqrt() - 0.7 * (l - 1.8).sqrt() > 1.0 { low = l } else { high = l }
        }
        let reached = problem.arrivals().iter().rev().find(|(_, at)| at.is_some()).expect("a front").0 / unit;
        println!("{reached:.3} l_c of {low:.3}");
        assert!((reached / low - 1.0).abs() < 0.05, "{reached} of {low}");
    }
}
