//! Increments under error control: the estimate, what it makes of the global error, and events of contact.

mod touch;

use std::f64::consts::PI;
use std::sync::Arc;

use crate::common::{self, Blocks, Finished, close, finish, floor, linear, model};
use fecontact::laws::friction::{
    Description, FrictionLaw, FrictionResponse, FrictionState, LawFailure, Regime, Sliding,
};
use fecontact::linear::SparseLu;
use fecontact::model::boundary::Drive;
use fecontact::model::builder::{Contact, IncrementSettings, LoadStep, Support};
use fecontact::model::{Model, State};
use fecontact::output::warnings::Warnings;
use fecontact::run::run;
use fecontact::run::{Attempt, Error, Observer, Simulation};
use fecontact::solve::Workspace;
use fecontact::time::increment::advance;
use fecontact::time::step_size::{EVENT_LOCATION, judge};
use serde_json::{Value, json};

fn trapezoidal() -> Value {
    json!({"newmark": {}})
}

/// The one-element bar of `time_integration.rs`, ω² = 9, on a spring-free support; its free end has the stiffness 3/2 at
/// each of two nodes.
const OMEGA: f64 = 3.0;

fn bar(scheme: &Value, error: f64) -> Value {
    json!({
        "mesh": Blocks::default().rectangle("bar", [1, 1], [0.0, 0.0], [1.0, 1.0]).json(),
        "bodies": {"bar": {"material": {"model": "linear", "E": 3, "nu": 0, "density": 1}}},
        "newton": {"tolerance": 1e-12},
        "steps": [{"name": "swing", "duration": 20, "dt": {"initial": 1e-3, "max": 1, "error": error}, "scheme": scheme,
                   "supports": [{"on": "bar", "uy": 0}, {"on": "bar_left", "ux": 0}]}],
    })
}

/// The state of the bar at u = cos φ, ω t = φ, with the acceleration of the time t + `shift`.
fn swinging(model: &Model, phase: f64, shift: f64) -> State {
    let mut state = model.initial_state();
    for node in [1, 3] {
        state.displacement[2 * node] = phase.cos();
        state.velocity[2 * node] = -OMEGA * phase.sin();
        state.acceleration[2 * node] = -OMEGA * OMEGA * (phase + OMEGA * shift).cos();
        state.force[2 * node] = 1.5 * phase.cos();
    }
    state
}

/// One increment from exact values ends at a distance from cos ω(t + Δt) that the estimate tells, up to a share of the
/// order of ωΔt.
#[test]
fn the_estimate_is_the_local_error() {
    for (scheme, shift) in [
        (trapezoidal(), 0.0),
        (json!({"newmark": {"beta": 0.3}}), 0.0),
        (json!({"newmark": {"beta": 0.1}}), 0.0),
        (json!({"hht": {"alpha": -0.2}}), -0.2),
        (json!({"generalized_alpha": {"rho_infinity": 0.0}}), -1.0),
        (json!({"generalized_alpha": {"rho_infinity": 0.5}}), -1.0 / 3.0),
        (json!({"generalized_alpha": {"rho_infinity": 1.0}}), 0.0),
    ] {
        let model = model(&bar(&scheme, 1.0));
        let model = Arc::new(model);
        let mut work = Workspace::new(&model, Box::<SparseLu>::default());
        for phase in [0.7, 2.0] {
            for dt in [0.02, 0.005] {
                let old = swinging(&model, phase, shift * dt);
                let new = advance(&model, &model.steps[0], &old, dt, &mut work).state.unwrap();
                let estimate = judge(&model, &model.steps[0], [&old, &new], 1, false).error.unwrap().estimate;
                let error = (new.displacement[2] - (phase + OMEGA * dt).cos()).abs();
                close(&format!("{scheme}, phase {phase}: estimate/error"), estimate / error, 1.0, 1.5 * OMEGA * dt);
            }
        }
    }
}

/// The allowed error per increment ε gives Δt ∝ ε^⅓, and an error of second order after five periods: ∝ ε^⅔. No
/// increment but the last exceeds ε, and the length does not flutter: few attempts are lost.
#[test]
fn a_tolerance_controls_the_global_error() {
    let scheme = json!({"generalized_alpha": {"rho_infinity": 0.8}});
    for scheme in [trapezoidal(), scheme] {
        let results = [1e-3, 1e-5, 1e-7].map(|tolerance| {
            let mut case = bar(&scheme, 1e-3 * tolerance);
            let pulled = json!({"name": "pull", "duration": 1, "dt": {"initial": 1},
                "supports": [{"on": "bar", "uy": 0}, {"on": "bar_left", "ux": 0}],
                "loads": [{"on": "bar_right", "force": {"x": 1.5e-3}}]});
            let mut free = case["steps"][0].clone();
            free["duration"] = json!(5.0 * 2.0 * PI / OMEGA);
            free["loads"] = json!([{"on": "bar_right", "force": {"x": "0"}}]);
            case["steps"] = json!([pulled, free]);
            let run = finish(&case);
            let report = &run.report;
            assert!(report.rejected * 5 < report.increments, "{} of {}", report.rejected, report.increments);
            let of = |state: &State| state.displacement[2] - 1e-3 * (OMEGA * (state.time - 1.0)).cos();
            let error = run.states.iter().map(of).fold(0.0f64, |largest, e| largest.max(e.abs()));
            println!("{scheme}: ε/A {tolerance:e}, {} increments, error/A {:e}", report.increments, 1e3 * error);
            (report.increments as f64, error)
        });
        for pair in results.windows(2) {
            let [(increments, error), (more, less)] = [pair[0], pair[1]];
            // A hundredth of the error allowed: 100^⅓ = 4.6 times the increments, 100^⅔ = 21.5 times more exact.
            assert!((3.5..6.0).contains(&(more / increments)), "{scheme}: {}", more / increments);
            assert!((14.0..32.0).contains(&(error / less)), "{scheme}: {}", error / less);
        }
    }
}

/// A slider of Coulomb friction, μ p S = 2 each, between two rough planes: no more than m ẍ = P − K (x − V t) − q S, with
/// the elastic slip of stiffness α_t S. Its element moves along x as a whole, since both faces are held alike.
#[derive(Clone, Copy)]
struct Slider {
    velocity: f64,
    push: f64,
    spring: f64,
    driver: f64,
    duration: f64,
}

const MASS: f64 = 10.0;
/// α_t S of both faces
const CONTACT: f64 = 1000.0;
/// μ p S of both faces
const STRENGTH: f64 = 20.0;

impl Default for Slider {
    fn default() -> Self {
        Self { velocity: 0.0, push: 0.0, spring: 0.0, driver: 0.0, duration: 1.0 }
    }
}

impl Slider {
    fn case(self, scheme: &Value, dt: Value) -> Value {
        let Self { velocity, push, spring, driver, duration } = self;
        let contact = |slave: &str, y: f64, normal: f64| {
            json!({"slave": slave, "master": {"plane": {"point": [0, y], "normal": [0, normal]}},
                   "method": "node_to_segment", "normal": {"alpha_n": 1e5},
                   "friction": {"law": "coulomb", "mu": 0.2, "alpha_t": CONTACT}})
        };
        // p = α_n × 0.001 = 100 on both faces, each of length 1/2
        json!({
            "mesh": Blocks::default().rectangle("body", [1, 1], [0.0, 0.0], [0.5, 1.0]).json(),
            "bodies": {"body": {"material": {"model": "linear", "E": 1e6, "nu": 0, "density": 2.0 * MASS}}},
            "contacts": {"base": contact("body_bottom", 1e-3, 1.0), "top": contact("body_top", 0.999, -1.0)},
            "initial_velocity": {"body": [velocity, 0]},
            "steps": [{"name": "go", "duration": duration, "dt": dt, "scheme": scheme,
                "supports": [{"on": "body", "uy": 0}],
                "loads": [{"on": "body", "force": {"x": format!("{}", push / 4.0)}},
                          {"on": "body", "spring": {"kx": spring / 4.0, "driver": {"x": format!("{driver} * t")}}}]}],
        })
    }

    fn run(self, scheme: &Value, error: f64) -> Finished {
        finish(&self.case(scheme, json!({"initial": 1e-3, "min": 1e-8, "max": 1, "error": error})))
    }

    /// Phases of the exact motion: each starts where the one before ends in slip onset, arrest or reversal.
    fn phases(self) -> Vec<Phase> {
        let mut phases = Vec::new();
        let mut start = (0.0, 0.0, self.velocity, 0.0);
        let mut slip = 0.0;
        while start.0 < self.duration {
            let phase = Phase::new(self, start, slip);
            let Some(end) = phase.end(self.duration) else {
                phases.push(phase);
                return phases;
            };
            phases.push(phase);
            let [x, v] = phase.at(end);
            let plastic = if slip == 0.0 { start.3 } else { x - slip * STRENGTH / CONTACT };
            // An arrest leaves friction at its strength; onset is where the elastic slip has reached it.
            slip = if slip == 0.0 { (x - plastic).signum() } else { 0.0 };
            start = (end, x, v, plastic);
        }
        phases
    }
}

/// A stretch of exact motion: m ẍ = f₀ + f₁ τ − κ x with κ = K in slip and K + α_t S in stick.
#[derive(Clone, Copy)]
struct Phase {
    start: f64,
    /// ±1 while slipping, 0 in stick
    slip: f64,
    plastic: f64,
    stiffness: f64,
    force: [f64; 2],
    x: f64,
    v: f64,
}

impl Phase {
    fn new(slider: Slider, (start, x, v, plastic): (f64, f64, f64, f64), slip: f64) -> Self {
        let Slider { push, spring, driver, .. } = slider;
        let friction = if slip == 0.0 { CONTACT * plastic } else { -slip * STRENGTH };
        Self {
            start,
            slip,
            plastic,
            stiffness: spring + if slip == 0.0 { CONTACT } else { 0.0 },
            force: [push + spring * driver * start + friction, spring * driver],
            x,
            v,
        }
    }

    /// x and v at a time.
    fn at(&self, time: f64) -> [f64; 2] {
        let tau = time - self.start;
        let [f0, f1] = self.force;
        if self.stiffness == 0.0 {
            let v = self.v + (f0 * tau + 0.5 * f1 * tau * tau) / MASS;
            return [self.x + self.v * tau + (0.5 * f0 * tau * tau + f1 * tau.powi(3) / 6.0) / MASS, v];
        }
        let omega = (self.stiffness / MASS).sqrt();
        let (a, b) = (self.x - f0 / self.stiffness, (self.v - f1 / self.stiffness) / omega);
        let (sin, cos) = (omega * tau).sin_cos();
        [(f0 + f1 * tau) / self.stiffness + a * cos + b * sin, f1 / self.stiffness + omega * (b * cos - a * sin)]
    }

    /// When the phase ends: slip that has come to rest, elastic slip that has reached the strength.
    fn end(&self, last: f64) -> Option<f64> {
        let over = |time: f64| {
            let [x, v] = self.at(time);
            if self.slip == 0.0 { (x - self.plastic).abs() - STRENGTH / CONTACT } else { -self.slip * v }
        };
        // A phase starts on the limit itself, and undamped stick comes back to it again and again.
        let steps = 100_000;
        let time = |n: usize| self.start + (last - self.start) * n as f64 / steps as f64;
        let after = (1..=steps).find(|&n| over(time(n)) > 1e-9)?;
        let (mut low, mut high) = (time(after - 1), time(after));
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if over(middle) > 0.0 { high = middle } else { low = middle }
        }
        Some(high)
    }
}

/// x at a time.
fn exact(phases: &[Phase], time: f64) -> f64 {
    let phase = phases.iter().rev().find(|phase| phase.start <= time).unwrap_or(&phases[0]);
    phase.at(time)[0]
}

/// Greatest distance of a run from the exact motion.
fn deviation(run: &Finished, phases: &[Phase]) -> f64 {
    run.states
        .iter()
        .fold(0.0, |largest: f64, state| largest.max((state.displacement[0] - exact(phases, state.time)).abs()))
}

/// What an allowed error per increment may come to in all: second order means ε^⅔, for lengths and times of about 1.
fn global(error: f64) -> f64 {
    6.0 * error.powf(2.0 / 3.0)
}

/// The textbook: without elasticity t = v₀ m/(μ N), x = v₀² m/(2 μ N); with the elastic slip of the contact the phases
/// before and after full sliding come in. The increments reach 1/4 in the slide, and the arrest is not stepped over.
#[test]
fn a_block_slides_to_rest() {
    let slider = Slider { velocity: 10.0, duration: 6.0, ..Slider::default() };
    let phases = slider.phases();
    assert_eq!(phases.len(), 3, "loading, slip, stick");
    let rest = phases[2].start;
    close("time of rest", rest, 10.0 * MASS / STRENGTH, 0.02);
    close("way", exact(&phases, rest), 100.0 * MASS / (2.0 * STRENGTH), 0.02);
    for error in [1e-4, 1e-5, 1e-6, 1e-7] {
        let run = slider.run(&trapezoidal(), error);
        let furthest = run.states.iter().max_by(|a, b| a.displacement[0].total_cmp(&b.displacement[0])).unwrap();
        // Undamped stick comes back to the furthest point again and again.
        let rests = run.states.iter().find(|state| state.time > 0.0 && state.velocity[0] <= 0.0).unwrap();
        let longest = run.states.iter().fold(0.0, |longest: f64, state| longest.max(state.dt));
        let shortest = run.states.iter().fold(1.0, |shortest: f64, state| shortest.min(state.dt));
        println!(
            "ε {error:e}: {} increments, {} rejected, Δt {shortest:e} to {longest}, way off by {:e}, time by {:e}, \
             motion by {:e}",
            run.report.increments,
            run.report.rejected,
            furthest.displacement[0] - exact(&phases, rest),
            rests.time - rest,
            deviation(&run, &phases),
        );
        assert!(deviation(&run, &phases) < global(error));
        // The trapezoidal rule keeps the energy whatever the increments, so the way is right however late the block is.
        close("way", furthest.displacement[0], exact(&phases, rest), EVENT_LOCATION * error);
        // What friction dissipates is exact, the work in the increment in which slip begins or ends to what the block slips in
        // it, times the strength.
        let start = run.states[0].energy.error();
        let located = STRENGTH * EVENT_LOCATION * error;
        run.states.iter().for_each(|state| close("energy", state.energy.error(), start, located));
        // From rest on the deceleration 2 moves the block by as much as it is located to.
        close("time of rest", rests.time, rest, EVENT_LOCATION.sqrt() * error.sqrt());
        assert!(longest > 0.25 && run.report.increments < 1000 && run.report.rejected < run.report.increments / 2);
    }
}

/// A force turns the block round at once: slip one way, 2 μ N of elastic slip, slip the other way.
#[test]
fn a_block_turns_round() {
    let slider = Slider { velocity: 10.0, push: -30.0, duration: 5.0, ..Slider::default() };
    let phases = slider.phases();
    assert_eq!(phases.iter().map(|phase| phase.slip).collect::<Vec<_>>(), [0.0, 1.0, 0.0, -1.0]);
    for error in [1e-4, 1e-6, 1e-8] {
        let run = slider.run(&trapezoidal(), error);
        println!(
            "ε {error:e}: {} increments, {} rejected, off by {:e}",
            run.report.increments,
            run.report.rejected,
            deviation(&run, &phases)
        );
        assert!(deviation(&run, &phases) < global(error));
        assert!(run.report.rejected < run.report.increments / 2);
    }
}

/// A driver pulls the block by a spring: it sticks (and swings on the elastic contact), and slips, slower and faster than
/// the driver in turn. Increments of up to 1 do not miss the onset.
#[test]
fn a_pulled_block_slips_off_in_time() {
    let slider = Slider { spring: 10.0, driver: 0.5, duration: 8.0, ..Slider::default() };
    let phases = slider.phases();
    let onset = phases[1].start;
    close("onset", onset, (STRENGTH / CONTACT + STRENGTH / 10.0) / 0.5, 0.05);
    for error in [1e-5, 1e-7, 1e-9] {
        let run = slider.run(&trapezoidal(), error);
        let slips = run.states.iter().position(|state| state.contacts[0][0].friction.plastic_slip > 0.0).unwrap();
        let first = &run.states[slips];
        println!(
            "ε {error:e}: {} increments, {} rejected, onset {onset} in {} + {:e}, off by {:e}",
            run.report.increments,
            run.report.rejected,
            first.time - first.dt,
            first.dt,
            deviation(&run, &phases)
        );
        assert!(first.contacts[0][0].friction.plastic_slip < EVENT_LOCATION * error);
        assert!(deviation(&run, &phases) < global(error));
    }
}

/// Swings in stick are no events, though their velocity turns round twice a period: the estimate alone sets the length,
/// 12 ε/A = (ωΔt)³ at its greatest.
#[test]
fn ringing_in_stick_has_no_events() {
    let slider = Slider { push: 5.0, duration: 50.0, ..Slider::default() };
    let run = slider.run(&trapezoidal(), 1e-7);
    assert!(run.states.iter().all(|state| state.contacts[0][0].friction.plastic_slip == 0.0));
    let (amplitude, omega) = (5.0 / CONTACT, (CONTACT / MASS).sqrt());
    let at_most = (12e-7 / amplitude).cbrt() / omega;
    let mean = 50.0 / run.report.increments as f64;
    println!("mean Δt {mean}, bound {at_most}, {} rejected of {}", run.report.rejected, run.report.increments);
    assert!(mean > 0.7 * at_most && mean < 1.5 * at_most);
    assert!(run.report.rejected < run.report.increments / 5);
    assert!(run.states.iter().all(|state| state.energy.error().abs() < 1e-8 + run.states[0].energy.error().abs()));
}

/// Wilson's trial at t + θ Δt leaves nothing behind: elastic and plastic slip add up to the displacement of every state,
/// and the supports are where they should be.
#[test]
fn wilson_commits_the_law_at_the_end_of_the_increment() {
    let slider = Slider { velocity: 10.0, push: -30.0, duration: 5.0, ..Slider::default() };
    let run = finish(&slider.case(&json!({"wilson": {}}), json!({"initial": 1e-3})));
    for state in &run.states {
        let friction = state.contacts[0][0].friction.clone();
        close("slip", friction.plastic_slip + friction.traction / CONTACT, state.displacement[0], 1e-12);
    }
    assert!(deviation(&run, &slider.phases()) < 0.01);
}

/// Numbers and lengths of the attempts, and whether they were accepted.
#[derive(Default)]
struct Attempts(Vec<(usize, f64, bool)>);

impl Observer for Attempts {
    fn record(&mut self, _: &Model, attempt: &Attempt) -> Result<(), Error> {
        self.0.push((attempt.number, attempt.dt, attempt.accepted.is_some()));
        Ok(())
    }
}

#[test]
fn rejected_attempts_are_counted_apart_from_cut_backs() {
    let slider = Slider { velocity: 10.0, duration: 6.0, ..Slider::default() };
    let model = model(&slider.case(&trapezoidal(), json!({"initial": 1e-3, "min": 1e-6, "max": 1, "error": 1e-6})));
    let mut attempts = Attempts::default();
    let model = Arc::new(model);
    let report = run(&model, &mut [&mut attempts]).0;
    assert!(report.rejected > 0 && report.cutbacks == 0);
    assert_eq!(report.rejected, attempts.0.iter().filter(|(_, _, accepted)| !accepted).count());
    let mut expected = 1;
    for (number, _, accepted) in attempts.0 {
        assert_eq!(number, expected);
        expected = if accepted { 1 } else { number + 1 };
    }
}

/// A block pressed to less than nothing: what cannot be solved is cut to a half, in a dynamic step then to a quarter and to eighths, but
/// not below the minimum, until half of it would be less.
#[test]
fn cuts_of_a_dynamic_increment_become_stronger() {
    const MIN: f64 = 1e-3;
    let dynamic = json!({"generalized_alpha": {"rho_infinity": 0.8}});
    for (scheme, shares) in [(json!("static"), [0.5, 0.5, 0.5]), (dynamic, [0.5, 0.25, 0.125])] {
        let model = Arc::new(model(&json!({
            "mesh": Blocks::default().rectangle("block", [2, 2], [0.0, 0.0], [1.0, 1.0]).json(),
            "bodies": {"block": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3, "density": 1e-3}}},
            "steps": [{"name": "crush", "duration": 1, "scheme": scheme, "dt": {"initial": 1, "min": MIN},
                       "supports": [{"on": "block_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0, "uy": -2.2}]}],
        })));
        let mut attempts = Attempts::default();
        assert!(run(&model, &mut [&mut attempts]).1.is_err());
        let mut most = 0;
        for pair in attempts.0.windows(2) {
            let [(number, dt, accepted), (next_number, next, _)] = pair else { unreachable!("windows of two") };
            if !accepted {
                let share = shares[(*number).min(3) - 1];
                assert_eq!((*next_number, *next), (number + 1, (share * dt).max(MIN)), "{scheme}");
                assert!(0.5 * dt >= MIN, "{scheme}: {pair:?}");
                most = most.max(*number);
            }
        }
        let (_, last, accepted) = attempts.0[attempts.0.len() - 1];
        assert!(!accepted && 0.5 * last < MIN && most >= 3, "{scheme}: {last}, {most}");
    }
}

/// The shortest increment is accepted with any error, and the user is told once.
#[test]
fn an_error_that_cannot_be_met_is_reported() {
    let slider = Slider { velocity: 10.0, duration: 6.0, ..Slider::default() };
    let model = model(&slider.case(&trapezoidal(), json!({"initial": 0.1, "min": 0.05, "max": 1, "error": 1e-6})));
    let mut warnings = Warnings::default();
    let model = Arc::new(model);
    let (report, result) = run(&model, &mut [&mut warnings]);
    assert!(result.is_ok() && report.increments <= 120);
    let message: Vec<_> = warnings.list.iter().filter(|warning| warning.contains("error")).collect();
    assert_eq!(message.len(), 1, "{message:?}");
    for part in ["step `go`, t = 0: the increment 5.000e-2 is the shortest", "exceeds 1e-6; lower dt.min"] {
        assert!(message[0].contains(part), "{}", message[0]);
    }
}

/// An error that no increment meets, and increments whose ends are rounded: t + 0.01 − t is now above, now below 0.01. Every
/// attempt is as short as may be, and accepted.
#[test]
fn the_shortest_increment_is_the_shortest_after_rounding_too() {
    let mut case = bar(&trapezoidal(), 1e-12);
    case["steps"][0]["duration"] = json!(1);
    case["steps"][0]["dt"] = json!({"initial": 0.01, "min": 0.01, "max": 0.05, "error": 1e-12});
    case["initial_velocity"] = json!({"bar": [1, 0]});
    let run = finish(&case);
    assert_eq!((run.states.len(), run.report.rejected), (100, 0));
}
