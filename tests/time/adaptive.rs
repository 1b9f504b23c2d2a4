//! Increments under error control: the estimate, what it makes of the global error, and events of contact.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::common::{self, Blocks, Finished, close, finish, floor, linear, model};
use fecontact::laws::friction::{
    Description, FrictionLaw, FrictionResponse, FrictionState, LawFailure, Regime, Sliding,
};
use fecontact::linear::SparseLu;
use fecontact::model::Model;
use fecontact::model::boundary::Drive;
use fecontact::model::builder::{Contact, IncrementSettings, LoadStep, Support};
use fecontact::model::state::State;
use fecontact::output::warnings::Warnings;
use fecontact::run::Simulation;
use fecontact::run::error::Error;
use fecontact::run::observer::{Attempt, Observer};
use fecontact::run::run;
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
fn an_error_that_cannot_be_met_is_told() {
    let slider = Slider { velocity: 10.0, duration: 6.0, ..Slider::default() };
    let model = model(&slider.case(&trapezoidal(), json!({"initial": 0.1, "min": 0.05, "max": 1, "error": 1e-6})));
    let mut warnings = Warnings::default();
    let model = Arc::new(model);
    let (report, result) = run(&model, &mut [&mut warnings]);
    assert!(result.is_ok() && report.increments <= 120);
    let told: Vec<_> = warnings.list.iter().filter(|warning| warning.contains("error")).collect();
    assert_eq!(told.len(), 1, "{told:?}");
    for part in ["step `go`, t = 0: the increment 5.000e-2 is the shortest", "exceeds 1e-6; lower dt.min"] {
        assert!(told[0].contains(part), "{}", told[0]);
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

/// A slab of 1 × 1/2 with m elements over its height, E = 1000, which comes down through a gap of 0.01 onto a plane and
/// moves along it by as much, then is pressed in by 0.005: it touches at 2/3 of the way.
struct Slab {
    m: usize,
    material: &'static str,
    method: &'static str,
    normal: Value,
    friction: Value,
    /// Height of its bottom at the ends above that in its middle
    bow: f64,
    gap: f64,
    steps: Value,
}

const GAP: f64 = 0.01;

fn coulomb(mu: f64) -> Value {
    json!({"law": "coulomb", "mu": mu, "alpha_t": 1e6})
}

/// One step that goes all the way, in increments of this length.
fn all_the_way(dt: f64) -> Value {
    json!([{"name": "in", "duration": 1, "dt": {"initial": dt}, "supports": [{"on": "slab_top", "ux": GAP, "uy": -1.5 * GAP}]}])
}

impl Default for Slab {
    fn default() -> Self {
        let (normal, friction) = (json!({"alpha_n": 1e6}), coulomb(5.0));
        let (material, method) = ("linear", "gauss_to_segment");
        Self { m: 4, material, method, normal, friction, bow: 0.0, gap: GAP, steps: all_the_way(1.0) }
    }
}

impl Slab {
    fn case(&self) -> Value {
        let Self { m, bow, gap, .. } = *self;
        let place = |s: f64, t: f64| [s, gap + bow * (2.0 * s - 1.0).powi(2) * (1.0 - t) + 0.5 * t];
        let mut blocks = Blocks::default().block("slab", [2 * m, m], place);
        let mut bodies = json!({"slab": {"material": {"model": self.material, "E": 1000, "nu": 0.3}}});
        let mut steps = self.steps.clone();
        let mut master = json!({"plane": {"point": [0, 0], "normal": [0, 1]}});
        if self.method == "mortar" {
            blocks = blocks.rectangle("base", [2 * m + 1, 1], [-0.5, -0.2], [1.5, 0.0]);
            bodies["base"] = json!({"material": {"model": "linear", "E": 1e5, "nu": 0.3}});
            master = json!("base_top");
            let held = json!({"on": "base_bottom", "ux": 0, "uy": 0});
            steps[0]["supports"].as_array_mut().expect("supports").push(held);
        }
        json!({
            "mesh": blocks.json(), "bodies": bodies, "steps": steps,
            "contacts": {"bottom": {"slave": "slab_bottom", "master": master, "method": self.method,
                                    "normal": self.normal, "friction": self.friction}},
        })
    }

    /// The case with all of the way in increments of this length.
    fn with(&self, dt: f64) -> Finished {
        finish(&Self { steps: all_the_way(dt), ..self.copy() }.case())
    }

    fn copy(&self) -> Self {
        let (normal, friction, steps) = (self.normal.clone(), self.friction.clone(), self.steps.clone());
        Self { normal, friction, steps, ..*self }
    }

    /// The force along the plane of the same slab that starts at touch, after a flight in which it is rigid.
    fn starting_at_touch(&self, increments: f64) -> f64 {
        let supports = json!([{"on": "slab_top", "ux": GAP / 3.0, "uy": -0.5 * GAP}]);
        let steps =
            json!([{"name": "press", "duration": 1, "dt": {"initial": 1.0 / increments}, "supports": supports}]);
        shear(&finish(&Self { gap: 0.0, steps, ..self.copy() }.case()))
    }
}

fn shear(run: &Finished) -> f64 {
    run.reaction("slab_top", run.last())[0]
}

/// Solved attempts, accepted or not.
fn solved(run: &Finished) -> usize {
    run.report.increments + run.report.rejected
}

/// A point that sticks is held where it touched, not where it was when the increment began: one increment of the whole way
/// gives the force of a slab that starts at touch, for the price of two more solutions, and so do ten. Counted as if the
/// surfaces had approached at a steady rate, the force would be up to three times as large (1 increment), 20 % (10).
#[test]
fn touch_is_stepped_onto() {
    let slabs = [
        Slab { m: 2, ..Slab::default() },
        Slab { m: 4, ..Slab::default() },
        Slab { m: 8, ..Slab::default() },
        Slab { m: 16, ..Slab::default() },
        Slab { normal: json!({}), ..Slab::default() },
        Slab { normal: json!({"alpha_n": 1e8}), ..Slab::default() },
        Slab { normal: json!({"penetration": 1e-6}), ..Slab::default() },
        Slab { method: "node_to_segment", ..Slab::default() },
        Slab { method: "mortar", ..Slab::default() },
        Slab { method: "mortar", normal: json!({"penetration": 1e-6}), ..Slab::default() },
        Slab { material: "neo_hookean", ..Slab::default() },
        Slab { friction: coulomb(0.2), ..Slab::default() },
        Slab { m: 8, friction: coulomb(0.2), normal: json!({}), ..Slab::default() },
    ];
    for (number, slab) in slabs.iter().enumerate() {
        let expected = slab.starting_at_touch(20.0);
        for (dt, more, error) in [(1.0, 6, 0.05), (0.1, 4, 0.01)] {
            let run = slab.with(dt);
            let (force, extra) = (shear(&run), solved(&run) - f64::round(1.0 / dt) as usize);
            println!("slab {number}, dt {dt}: {force:.5}, from touch {expected:.5}, {extra} more solutions");
            close(&format!("slab {number}, dt {dt}: force"), force, expected, error * expected);
            // An increment that had to be cut is one more.
            assert!(extra <= more + run.report.cutbacks, "slab {number}, dt {dt}: {extra} more solutions");
        }
    }
}

/// The compliance c that helps Newton's method at touch is a number of the mesh, not of the model: what is accepted depends
/// on it by no more than the uncertainty about friction that is allowed. Points of a slab with a bow touch one after the other.
#[test]
fn accepted_friction_does_not_depend_on_the_compliance_after_touch() {
    let bowed = Slab { bow: 0.004, friction: coulomb(0.3), normal: json!({}), ..Slab::default() };
    for (number, slab) in [Slab::default(), bowed].iter().enumerate() {
        for (dt, allowed) in [(1.0, 0.02), (0.1, 0.01)] {
            let converged = shear(&slab.with(0.005));
            for factor in [0.1, 1.0, 4.0] {
                let mut model = model(&Slab { steps: all_the_way(dt), ..slab.copy() }.case());
                model.contacts[0].compliance *= factor;
                let mut record = common::Record::default();
                let model = Arc::new(model);
                run(&model, &mut [&mut record]).1.expect("a completed run");
                let last = record.states.last().expect("an increment");
                let top = model.mesh.nodes_of(model.mesh.group("slab_top").expect("a group"));
                let force: f64 = top.iter().map(|&node| last.reaction[2 * node]).sum();
                println!(
                    "slab {number}, dt {dt}, c × {factor}: {force:.5}, converged {converged:.5}, {} + {}",
                    record.states.len(),
                    record.failed
                );
                close(&format!("slab {number}, dt {dt}, c × {factor}"), force, converged, allowed * converged);
            }
        }
    }
}

/// Where friction does not ask when a point touched, no increment is repeated: sliding along at the limit of friction with
/// points that come in at the front, no friction.
#[test]
fn touch_costs_nothing_where_friction_does_not_ask() {
    let straight = |dt: f64| json!([{"name": "in", "duration": 1, "dt": {"initial": dt}, "supports": [{"on": "slab_top", "ux": 0, "uy": -1.5 * GAP}]}]);
    let frictionless = json!({"law": "frictionless"});
    for dt in [1.0, 0.1] {
        for steps in [all_the_way(dt), straight(dt)] {
            let slab = Slab { bow: 0.004, steps, friction: frictionless.clone(), ..Slab::default() };
            assert_eq!(solved(&finish(&slab.case())), f64::round(1.0 / dt) as usize);
        }
    }
    // Points that stick while the bodies widen ask for touch; that must not end a run.
    for (m, mu) in [(2, 0.3), (4, 0.2), (4, 0.5), (8, 0.3), (8, 0.5)] {
        let run = finish(&Slab { m, steps: straight(1.0), friction: coulomb(mu), ..Slab::default() }.case());
        println!("pressed, m = {m}, μ = {mu}: {} solutions, {} cut", solved(&run), run.report.cutbacks);
        assert!(solved(&run) <= 7);
    }
    // Pressed first, then dragged while it is pressed further in: the contact grows at both ends, and slides.
    let pressed = json!({"name": "in", "duration": 1, "dt": {"initial": 0.1}, "supports": [{"on": "slab_top", "ux": 0, "uy": -1.1 * GAP}]});
    let set_off = json!({"name": "set off", "duration": 1, "dt": {"initial": 0.1}, "supports": [{"on": "slab_top", "ux": 0.01, "uy": -1.1 * GAP}]});
    let dragged = json!({"name": "drag", "duration": 1, "dt": {"initial": 0.1}, "supports": [{"on": "slab_top", "ux": 0.2, "uy": -1.8 * GAP}]});
    let run = finish(
        &Slab { m: 8, bow: 0.01, friction: coulomb(0.3), steps: json!([pressed, set_off, dragged]), ..Slab::default() }
            .case(),
    );
    let dragged: Vec<&State> = run.states.iter().filter(|state| state.time > 2.0 + 1e-9).collect();
    let closed = |state: &State| state.contacts[0].iter().filter(|point| point.friction.pressure > 0.0).count();
    assert!(closed(dragged[9]) > closed(run.at(2.0)) + 2, "points come in");
    assert_eq!(dragged.len(), 10);
}

/// Rate-and-state friction that ages in the flight and slips after touch: in one step the friction of a slab that flies to
/// touch in a step of its own, in a hundred increments from there.
#[test]
fn laws_that_know_time_count_from_touch() {
    let friction = json!({"law": "rate_and_state", "f_0": 0.4, "V_0": 1e-3, "a": 0.01, "b": 0.015, "D_c": 1e-3, "theta": 0.1, "alpha_t": 1e6});
    let slab = Slab { friction, ..Slab::default() };
    let flight = json!({"name": "fly", "duration": 2.0 / 3.0, "dt": {"initial": 0.1}, "supports": [{"on": "slab_top", "ux": GAP / 1.5, "uy": -GAP}]});
    let pressed = json!({"name": "press", "duration": 1.0 / 3.0, "dt": {"initial": 1.0 / 300.0}, "supports": [{"on": "slab_top", "ux": GAP, "uy": -1.5 * GAP}]});
    let exact = shear(&finish(&Slab { steps: json!([flight, pressed]), ..slab.copy() }.case()));
    for (dt, more, error) in [(1.0, 6, 0.05), (0.1, 4, 0.01)] {
        // Increments of given lengths, so that touch alone shortens them.
        let mut steps = all_the_way(dt);
        steps[0]["dt"]["error"] = Value::Null;
        let run = finish(&Slab { steps, ..slab.copy() }.case());
        let extra = solved(&run) - f64::round(1.0 / dt) as usize;
        println!("dt {dt}: {:.5}, from touch {exact:.5}, {extra} more solutions", shear(&run));
        close(&format!("dt {dt}: force"), shear(&run), exact, error * exact);
        assert!(extra <= more);
    }
}

/// The slider of rate-and-state friction on springs, without mass: K (x_d − x) = q S with x = λ + q/α_t, so that q S = k (x_d − λ)
/// with 1/k = 1/K + 1/(α_t S), and the law says λ̇ and θ̇. It is driven for a second and then left alone for four months: slip
/// dies away as 1/t. By the method of Runge and Kutta with steps of a fiftieth of the shortest time of the problem.
#[test]
fn slip_is_followed_from_milliseconds_to_months() {
    let [f_0, v_0, a, b, d_c, pressure] = [0.6, 1e-6, 0.015, 0.01, 1e-4, 100.0f64];
    let (stiffness, end) = (1.0 / (1.0 / 1000.0 + 1.0 / CONTACT), 1e7);
    let driver = |t: f64| 0.2 * t.min(1.0);
    let rates = |t: f64, [slip, theta]: [f64; 2]| {
        let level = stiffness * (driver(t) - slip) / (a * pressure);
        let psi = f_0 + b * (v_0 * theta / d_c).ln();
        let rate = 2.0 * v_0 * level.sinh() * (-psi / a).exp();
        [rate, 1.0 - rate * theta / d_c]
    };
    let (mut t, mut y, mut at_rest) = (0.0f64, [0.0, 1.0], 0.0);
    while t < end {
        let [rate, _] = rates(t, y);
        let shortest = (a * pressure / (stiffness * rate.max(1e-30))).min(d_c / rate.max(1e-30));
        let to = if t < 1.0 { 1.0 } else { end };
        let h =
            (shortest / 50.0).min(0.02 * y[1]).min(if t < 1.0 { 1e-3 } else { 0.05 * (t - 1.0).max(1e-4) }).min(to - t);
        let next = |k: [f64; 2], share: f64| [y[0] + share * h * k[0], y[1] + share * h * k[1]];
        let k1 = rates(t, y);
        let k2 = rates(t + 0.5 * h, next(k1, 0.5));
        let k3 = rates(t + 0.5 * h, next(k2, 0.5));
        let k4 = rates(t + h, next(k3, 1.0));
        y = [0, 1].map(|i| y[i] + h * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]) / 6.0);
        t = if h == to - t { to } else { t + h };
        if t == 1.0 {
            at_rest = y[0];
        }
    }
    let after = y[0] - at_rest;
    println!("slip {at_rest:.6} when it is driven, {after:.6e} after");
    let table = json!({"table": [[0, 0], [1, 0.2], [1e8, 0.2]]});
    let friction = json!({"law": "rate_and_state", "f_0": f_0, "V_0": v_0, "a": a, "b": b, "D_c": d_c, "theta": 1, "alpha_t": CONTACT});
    let errors = [1e-4, 1e-5, 1e-6].map(|error: f64| {
        let mut case = Slider { spring: 1000.0, ..Slider::default() }
            .case(&json!("static"), json!({"initial": 1e-3, "error": error}));
        case["steps"][0]["duration"] = json!(1);
        case["steps"][0]["loads"] = json!([{"on": "body", "spring": {"kx": 250, "driver": {"x": table}}}]);
        for contact in ["base", "top"] {
            case["contacts"][contact]["friction"] = friction.clone();
        }
        let left = json!({"name": "left alone", "duration": end - 1.0, "dt": {"initial": 1e-3, "error": error}});
        case["steps"].as_array_mut().expect("steps").push(left);
        let run = finish(&case);
        let slip = |state: &State| state.contacts[0][0].friction.plastic_slip.abs();
        let crept = slip(run.last()) - slip(run.at(1.0));
        let driven = run.states.iter().filter(|state| state.time <= 1.0 + 1e-9).count();
        let left = run.states.len() - driven;
        println!(
            "error {error:e}: slip {:.6}, {crept:.6e} after, {driven} and {left} increments, {} rejected",
            slip(run.at(1.0)),
            run.report.rejected
        );
        close(&format!("error {error:e}: creep"), crept, after, 0.1 * after);
        // 1/√ε, for ten decades of time.
        assert!((left as f64) < 1.2 / error.sqrt(), "{left} increments");
        (crept - after).abs()
    });
    for pair in errors.windows(2) {
        assert!((1.5..6.0).contains(&(pair[0] / pair[1])), "√10 is due: {errors:?}");
    }
}

/// Where increments may not be shortened, what friction after touch may have to do with them is told, once a step; where they
/// may, there is nothing to tell.
#[test]
fn friction_left_in_doubt_by_touch_is_told() {
    let told = |min: f64| -> Vec<String> {
        let mut steps = all_the_way(1.0);
        steps[0]["dt"]["min"] = json!(min);
        let model = model(&Slab { steps, ..Slab::default() }.case());
        let mut warnings = Warnings::default();
        let model = Arc::new(model);
        let (report, result) = run(&model, &mut [&mut warnings]);
        assert!(result.is_ok() && (report.rejected == 0) == (min == 1.0));
        warnings.list.into_iter().filter(|warning| warning.contains("uncertain by")).collect()
    };
    let single = told(1.0);
    let parts = ["step `in`", "contact closed within it: friction force uncertain by", "lower dt.min"];
    assert!(single.len() == 1 && parts.iter().all(|part| single[0].contains(part)), "{single:?}");
    assert_eq!(told(1e-3), Vec::<String>::new());
}

/// A film of oil, q = η v: it resists slip and stores nothing.
#[derive(Clone, Debug)]
struct Oil(f64);

impl FrictionLaw for Oil {
    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Result<FrictionResponse, LawFailure> {
        let Sliding { slip, pressure, dt } = sliding.checked()?;
        if pressure <= 0.0 || dt == 0.0 {
            return FrictionResponse::elastic(old.stuck(0.0, pressure.max(0.0)), 0.0).checked(1.0);
        }
        let dtraction_dslip = self.0 / dt;
        let traction = dtraction_dslip * slip;
        let state = FrictionState {
            plastic_slip: old.plastic_slip + slip,
            plastic_increment: slip,
            dissipation: old.dissipation + traction * slip,
            regime: if slip == 0.0 { Regime::Stick } else { Regime::Slip },
            ..old.stuck(traction, pressure)
        };
        FrictionResponse { state, dtraction_dslip, ..Default::default() }.checked(dtraction_dslip)
    }

    fn description(&self) -> Description {
        Description::default()
    }
}

/// A periodic slab on oil, its top drawn at v from rest: s = v (t − τ (1 − e^(−t/τ))), τ = η h/G. A law without an elastic part
/// is under error control like any other, and may slip too fast for static increments.
#[test]
fn friction_that_stores_nothing_is_under_error_control() {
    const V: f64 = 1e-3;
    const TAU: f64 = 0.5;
    let slab = |step: LoadStep| {
        let mesh = Blocks::default().rectangle("slab", [4, 4], [0.0, 0.0], [1.0, 1.0]).mesh();
        let drawn = Support::on("slab_top").ux(Drive::Rate(V)).uy(0.0);
        Model::builder(mesh)
            .body("slab", linear(260.0, 0.3, 100.0))
            .periodic("slab_left", "slab_right")
            .contact(Contact::new("base", "slab_bottom", floor(), Oil(100.0 * TAU)).alpha_n(1e4).initial(1.0, 0.0))
            .step(step.support(drawn))
            .build()
            .expect("a good model")
    };
    let error = 1e-6;
    let increments = IncrementSettings::from(2.5).error(error);
    let mut run = Simulation::new(slab(LoadStep::new("draw", 5.0).dt(increments)));
    let mut worst = 0.0f64;
    while let Some(increment) = run.next_increment().expect("it is solved") {
        let t = increment.state.time;
        let exact = V * (t - TAU * (1.0 - (-t / TAU).exp()));
        let slips = run.contact_field("base", "slip").expect("a field");
        worst = slips.iter().fold(worst, |worst, slip| worst.max((slip.abs() - exact).abs()));
    }
    println!("{} increments, off by {worst:e} at most", run.report().increments);
    assert!(worst < 20.0 * error && run.report().rejected > 0, "off by {worst:e}");
    let increments = IncrementSettings::from(0.1).min(0.05);
    let mut run = Simulation::new(slab(LoadStep::new("draw", 0.6).dt(increments).rupture(0.5 * V)));
    while run.next_increment().expect("it is solved").is_some() {}
    assert!(run.report().ruptures > 0, "the slip rate passes v/2 at τ ln 2 = 0.35");
}
