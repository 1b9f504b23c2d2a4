//! The friction laws alone: tangents, closed forms, limits, convergence, and random increments:
//! `INCREMENTS=all cargo test --release --test laws random_increments` takes a million of each integration, the plain test a fifth.

mod answers;
mod dissipation;

use crate::strokes::strokes;
use std::f64::consts::PI;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::random::Random;
use fecontact::laws::friction::{
    Approach, Coulomb, CoulombParameters, FrictionLaw, FrictionParameters, FrictionResponse, FrictionState,
    Frictionless, Integration, LawFailure, STEEPEST, Sliding, SuperSubloading, SuperSubloadingParameters,
};
use rayon::prelude::*;

/// μ, the one variable of the super/subloading law.
fn mu_of(state: &FrictionState) -> f64 {
    state.variables[0]
}

/// Contact pressure of the paper's point-mass problems.
const PRESSURE: f64 = 98.1;

/// The paper's data.
const PAPER: SuperSubloadingParameters = SuperSubloadingParameters::new(0.4, 0.2, 100.0)
    .alpha_t(1000.0)
    .kappa(10.0)
    .xi(0.002)
    .structure(2.0)
    .approach(Approach::Logarithmic)
    .integration(Integration::BackwardEuler);

/// One backward-Euler step an increment.
const BACKWARD_EULER: SuperSubloadingParameters = PAPER.integration(Integration::BackwardEuler);

/// Constant coefficient 0.2: only R evolves.
const CONSTANT: SuperSubloadingParameters = with!(PAPER.kappa(0.0).xi(0.0), mu_s: 0.2, structure: None);

fn law(parameters: &SuperSubloadingParameters) -> SuperSubloading {
    SuperSubloading::new(parameters, f64::NAN).expect("valid parameters")
}

fn respond(law: &dyn FrictionLaw, old: &FrictionState, slip: f64, pressure: f64, dt: f64) -> FrictionResponse {
    law.respond(old, Sliding::new(slip, pressure, dt)).expect("a finite increment is answered")
}

/// The states after each of `steps` equal increments at constant pressure.
fn drive(law: &dyn FrictionLaw, start: FrictionState, slip: f64, duration: f64, steps: usize) -> Vec<FrictionState> {
    let mut state = start;
    let parts = steps as f64;
    (0..steps)
        .map(|_| {
            state = respond(law, &state, slip / parts, PRESSURE, duration / parts).state;
            state.clone()
        })
        .collect()
}

/// The state after `steps` equal increments from first touch.
fn loaded(law: &dyn FrictionLaw, slip: f64, duration: f64, steps: usize) -> FrictionState {
    drive(law, law.initial_state(0.0, 0.0), slip, duration, steps).pop().expect("at least one step")
}

fn assert_close(actual: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((actual - expected).abs() <= tolerance, "{what}: {actual} instead of {expected} ± {tolerance:e}");
}

/// Errors of two resolutions of a first-order method, the second with half the step.
fn assert_first_order(coarse: f64, fine: f64, what: &str) {
    let ratio = coarse / fine;
    assert!((1.7..2.3).contains(&ratio), "{what}: error {coarse:e} became {fine:e}, a factor of {ratio}");
}

/// −li(y) = E₁(−ln y) from its power series, good for y > 0.02.
fn minus_li(y: f64) -> f64 {
    let w = -y.ln();
    let mut sum = -0.577_215_664_901_532_9 - w.ln();
    let mut term = -1.0;
    for k in 1..40 {
        term *= -w / f64::from(k);
        sum += term / f64::from(k);
    }
    sum
}

/// Plastic slip times r/(1 − R_e) since y = 0.
fn distance(approach: Approach, y: f64) -> f64 {
    match approach {
        Approach::Logarithmic => minus_li(y),
        _ => -(0.5 * PI * (1.0 - y)).sin().ln() * 2.0 / PI,
    }
}

// Closed forms

#[test]
fn monotone_loading_follows_the_logarithmic_integral_at_any_step_size() {
    let law = law(&CONSTANT);
    for ratio in [0.05, 0.3, 0.5, 0.9, 0.99, 0.9999] {
        let force = ratio * 0.2 * PRESSURE;
        let slip = force / 1000.0 + minus_li(ratio) / 100.0;
        for steps in [1, 2, 7, 1000] {
            assert_close(loaded(&law, slip, 0.0, steps).traction, force, 1e-9 * 0.2 * PRESSURE, "traction");
        }
    }
}

#[test]
fn monotone_loading_gives_the_tabled_slips() {
    let law = law(&CONSTANT);
    for (force, slip) in [(9.81, 0.013_596_7), (17.658, 0.035_416_0), (19.4238, 0.059_753_4)] {
        assert_close(loaded(&law, slip, 0.0, 3).traction, force, 5.1e-8 * 1000.0, "traction");
    }
}

#[test]
fn both_approaches_integrate_exactly_with_an_elastic_core() {
    for approach in [Approach::Logarithmic, Approach::Cotangent] {
        for elastic_core in [0.0, 0.3, 0.8] {
            let law = law(&CONSTANT.approach(approach).elastic_core(elastic_core));
            for y in [0.05, 0.5, 0.9, 0.999] {
                let ratio = elastic_core + (1.0 - elastic_core) * y;
                let force = ratio * 0.2 * PRESSURE;
                let slip = force / 1000.0 + (1.0 - elastic_core) * distance(approach, y) / 100.0;
                for steps in [1, 10, 300] {
                    let actual = loaded(&law, slip, 0.0, steps).traction;
                    assert_close(actual, force, 1e-9 * 0.2 * PRESSURE, &format!("{approach:?} {elastic_core}"));
                }
            }
        }
    }
}

#[test]
fn softening_converges_to_an_exponential_of_plastic_slip() {
    let law = law(&BACKWARD_EULER.xi(0.0));
    let error = |steps| {
        let state = loaded(&law, 0.1, 0.0, steps);
        (mu_of(&state) - (0.2 + 0.2 * (-10.0 * state.plastic_slip / 0.2).exp())).abs()
    };
    assert_first_order(error(400), error(800), "softening");
    assert!(error(6400) < 1e-4);
}

#[test]
fn the_attained_peak_converges_to_25_0175() {
    let law = law(&BACKWARD_EULER.xi(0.0));
    let peak = |steps| {
        let path = drive(&law, law.initial_state(0.0, 0.0), 0.08, 0.0, steps);
        let (index, state) =
            path.iter().enumerate().max_by(|a, b| a.1.traction.total_cmp(&b.1.traction)).expect("a path");
        (state.traction, state.ratio(mu_of(state)), 0.08 * (index + 1) as f64 / steps as f64)
    };
    let (traction, ratio, slip) = peak(200_000);
    assert_close(traction, 25.0175, 2e-3, "peak");
    assert_close(ratio, 0.8711, 2e-3, "R at the peak");
    assert_close(slip, 0.040_384, 1e-4, "slip at the peak");
    assert_first_order((peak(2000).0 - 25.017_5).abs(), (peak(4000).0 - 25.017_5).abs(), "peak");
}

/// What `check` says of a law in closed form is what the law does when it is driven: in slip without time, and in time without slip.
#[test]
fn what_the_parameters_mean_is_what_the_law_does() {
    let sets = [
        PAPER.integration(Integration::Controlled),
        with!(PAPER.kappa(2.0).xi(0.02), r: 400.0, structure: None),
        with!(PAPER.exponents(2.0, 3.0).structure(1.5), r: 1000.0),
        with!(PAPER.exponents(0.5, 0.5).elastic_core(0.3).structure(1.0), r: 300.0),
        with!(PAPER.approach(Approach::Cotangent), r: 80.0),
    ];
    for parameters in sets {
        let of_start = law(&parameters.integration(Integration::Controlled).alpha_t(1e6));
        let of_rest = law(&with!(parameters.integration(Integration::Controlled).alpha_t(1e6), structure: None));
        let onset = of_start.onset().expect("the law says so");
        assert_eq!((onset.rested, onset.residual), (of_rest.onset().expect("the law says so").rested, parameters.mu_k));
        for (law, rise) in [(&of_rest, onset.rested), (&of_start, onset.fresh)] {
            let end = rise.slip.map_or(0.5, |slip| 2.0 * slip);
            let states = drive(law, law.initial_state(0.0, 0.0), end, 0.0, 4000);
            let highest = states.iter().max_by(|a, b| a.traction.total_cmp(&b.traction)).expect("a state");
            assert_close(rise.peak, highest.traction / PRESSURE, 1e-6 * rise.peak, &format!("peak of {parameters:?}"));
            if let Some(slip) = rise.slip {
                assert_close(slip, highest.plastic_slip, 2.0 * end / 4000.0, &format!("slip of {parameters:?}"));
            }
        }
        // Half of the way between μ_s and μ_k, from above and from below.
        let half = 0.5 * (parameters.mu_s + parameters.mu_k);
        let [lost, healed] = [onset.half_lost, onset.half_healed].map(|some| some.expect("it weakens and heals"));
        let states = drive(&of_rest, of_rest.initial_state(0.0, 0.0), 2.0 * lost, 0.0, 4000);
        let crossing = states.iter().find(|state| mu_of(state) <= half).expect("it has weakened");
        assert_close(lost, crossing.plastic_slip, 2.0 * lost / 2000.0, &format!("slip of half of {parameters:?}"));
        let weak = of_rest.initial_state(0.0, 0.0).with_variables([parameters.mu_k]);
        let rested = respond(&of_rest, &weak, 0.0, PRESSURE, healed).state;
        assert_close(mu_of(&rested), half, 1e-12, &format!("rest of half of {parameters:?}"));
    }
    // Friction that only rises, to the kinetic coefficient or to the static one, has no peak.
    let only = |kappa: f64, mu_s: f64| law(&with!(PAPER.kappa(kappa).xi(0.0), mu_s: mu_s, structure: None));
    for (law, limit) in [(only(0.0, 0.4), 0.4), (only(1e5, 0.4), 0.2), (only(10.0, 0.2), 0.2)] {
        let onset = law.onset().expect("the law says so");
        assert_eq!((onset.rested.peak, onset.rested.slip, onset.half_healed), (limit, None, None));
    }
}

/// Rest with n above 1 spreads over decades of time: μ = μ_s (1 − [y₀^(1−n) + (n − 1) ξ t/μ_s]^(−1/(n−1))), y₀ = 1 − μ₀/μ_s, in one increment
/// and in many; while ln(1 + t/t_c) ≪ n − 1 it gains ln 10 (μ_s − μ₀)/(n − 1) a decade, t_c = μ_s y₀^(1−n)/((n − 1) ξ).
#[test]
fn rest_heals_by_decades() {
    for (n, time, exact) in [(2.0, 1e3, 0.342_857_1), (5.0, 1e3, 0.236_700_7), (5.0, 1e6, 0.366_370_9)] {
        let law = law(&with!(PAPER.integration(Integration::Controlled), n: n));
        let weak = law.initial_state(PRESSURE, 0.0).with_variables([0.2]);
        assert_close(mu_of(&respond(&law, &weak, 0.0, PRESSURE, time).state), exact, 1e-7, "one increment");
        assert_close(mu_of(&loaded_from(&law, weak, time, 50)), exact, 1e-7, "fifty");
    }
    let n = 60.0;
    let law = law(&with!(PAPER.integration(Integration::Controlled), n: n));
    let weak = law.initial_state(PRESSURE, 0.0).with_variables([0.2]);
    let begins = 0.4 * 0.5_f64.powf(1.0 - n) / ((n - 1.0) * 0.002);
    let [first, last] = [1e2, 1e5].map(|times| mu_of(&respond(&law, &weak, 0.0, PRESSURE, times * begins).state));
    assert_close((last - first) / 3.0, 10_f64.ln() * 0.2 / (n - 1.0), 0.15 * 10_f64.ln() * 0.2 / (n - 1.0), "a decade");
}

/// The state after a rest in equal increments.
fn loaded_from(law: &SuperSubloading, state: FrictionState, time: f64, count: usize) -> FrictionState {
    (0..count).fold(state, |state, _| respond(law, &state, 0.0, PRESSURE, time / count as f64).state)
}

#[test]
fn ageing_at_rest_converges_to_its_closed_forms() {
    for n in [1.0, 2.0, 0.5] {
        let law = law(&with!(BACKWARD_EULER.xi(0.4).structure(1.0), n: n));
        // The deficit d = 1 − μ/μ_s obeys ḋ = −(ξ/μ_s) d^n, here with ξ/μ_s = 1 and d₀ = 1/2.
        let time = 0.8;
        let deficit = if n == 1.0 {
            0.5 * f64::exp(-time)
        } else {
            (0.5f64.powf(1.0 - n) - (1.0 - n) * time).powf(1.0 / (1.0 - n))
        };
        let error = |steps| (mu_of(&loaded(&law, 0.0, time, steps)) - 0.4 * (1.0 - deficit)).abs();
        assert_first_order(error(200), error(400), &format!("ageing, n = {n}"));
        assert!(error(20_000) < 1e-5);
        let aged = loaded(&law, 0.0, time, 200);
        let (fresh, stronger) = (law.initial_state(0.0, 0.0), respond(&law, &aged, 0.02, PRESSURE, 0.0).state.traction);
        assert!(stronger > 1.1 * respond(&law, &fresh, 0.02, PRESSURE, 0.0).state.traction, "rest strengthens");
    }
}

#[test]
fn recovery_with_a_small_exponent_ends_at_the_static_coefficient() {
    let law = law(&with!(PAPER.xi(0.4).structure(1.0), n: 0.5));
    let rested = loaded(&law, 0.0, 1e6, 10);
    assert_close(mu_of(&rested), 0.4, 1e-9, "μ");
    assert!(respond(&law, &rested, 0.05, PRESSURE, 0.0).state.traction > 0.2 * PRESSURE);
}

#[test]
fn the_integration_converges_to_the_rate_equations_at_first_order() {
    let parameters = BACKWARD_EULER.xi(0.05);
    let (amplitude, end) = (0.1, 4.0);
    let pressure = |t: f64| PRESSURE * (1.0 + 0.2 * (3.0 * t).sin());
    let law = law(&parameters);
    let start = with!(law.initial_state(0.0, 0.0), pressure: PRESSURE);
    let expected = rate_form(&parameters, start.clone(), end, |t| amplitude * t.cos(), &pressure);
    let traction = |steps: usize| {
        let dt = end / steps as f64;
        let advance = |state, i: usize| {
            let (t0, t1) = (i as f64 * dt, (i + 1) as f64 * dt);
            respond(&law, &state, amplitude * (t1.sin() - t0.sin()), pressure(t1), dt).state
        };
        (0..steps).fold(start.clone(), advance).traction
    };
    let error = |steps| (traction(steps) - expected).abs();
    assert_first_order(error(2000), error(4000), "traction");
    assert!(error(32_000) < 2e-3, "{} from {expected}", error(32_000));
}

/// q at `end` by the classical Runge–Kutta method with very small steps, from the rate form with its loading test.
fn rate_form(
    parameters: &SuperSubloadingParameters,
    start: FrictionState,
    end: f64,
    velocity: impl Fn(f64) -> f64,
    pressure: &impl Fn(f64) -> f64,
) -> f64 {
    let SuperSubloadingParameters { mu_s, mu_k, r, kappa, xi, .. } = *parameters;
    let alpha_t = 1000.0;
    let rate = |t: f64, (q, mu): (f64, f64)| {
        let (v, p, sign) = (velocity(t), pressure(t), q.signum());
        let pressure_rate = (pressure(t + 1e-6) - pressure(t - 1e-6)) / 2e-6;
        let ratio = q.abs() / (mu * p);
        let (loss, gain) = (kappa * (mu / mu_k - 1.0), xi * (1.0 - mu / mu_s));
        let stiffness = alpha_t - r * ratio.ln() * mu * p - ratio * loss * p;
        let driving = alpha_t * sign * v - ratio * gain * p - ratio * mu * pressure_rate;
        let slip = (driving / stiffness).max(0.0);
        (alpha_t * (v - slip * sign), gain - loss * slip)
    };
    let steps = 400_000;
    let h = end / f64::from(steps);
    let mut y = (start.traction, mu_of(&start));
    for i in 0..steps {
        let t = f64::from(i) * h;
        let shift = |k: (f64, f64), s: f64| (y.0 + s * k.0, y.1 + s * k.1);
        let k1 = rate(t, y);
        let k2 = rate(t + 0.5 * h, shift(k1, 0.5 * h));
        let k3 = rate(t + 0.5 * h, shift(k2, 0.5 * h));
        let k4 = rate(t + h, shift(k3, h));
        y.0 += h / 6.0 * (k1.0 + 2.0 * (k2.0 + k3.0) + k4.0);
        y.1 += h / 6.0 * (k1.1 + 2.0 * (k2.1 + k3.1) + k4.1);
    }
    y.0
}

// Limits

#[test]
fn steady_sliding_reaches_its_coefficient_at_every_speed() {
    let law = law(&PAPER);
    for speed in [1e-5, 1e-3, 0.1, 10.0] {
        for direction in [1.0, -1.0] {
            let state = loaded(&law, 20.0 * direction, 20.0 / speed, 400);
            let expected = (10.0 * speed + 0.002) / (10.0 * speed / 0.2 + 0.002 / 0.4);
            assert_close(state.ratio(mu_of(&state)), 1.0, 1e-12, "R");
            assert_close(mu_of(&state), expected, 1e-10, "μ");
            assert_close(state.traction, direction * expected * PRESSURE, 1e-8, "q");
        }
    }
}

#[test]
fn steady_sliding_balances_loss_and_recovery_with_other_exponents() {
    for (m, n) in [(2.0, 0.5), (0.5, 2.0), (1.5, 1.0), (1.0, 3.0)] {
        let law = law(&PAPER.exponents(m, n));
        let speed = 1e-3;
        let state = loaded(&law, 20.0, 20.0 / speed, 4000);
        let loss = 10.0 * (mu_of(&state) / 0.2 - 1.0).powf(m) * speed;
        let gain = 0.002 * (1.0 - mu_of(&state) / 0.4).powf(n);
        assert_close(loss, gain, 1e-9 * gain, "loss = gain");
        assert_close(state.traction, mu_of(&state) * PRESSURE, 1e-9, "q");
    }
}

#[test]
fn a_sharp_law_of_constant_coefficient_is_coulomb_friction() {
    let sharp = law(&with!(CONSTANT.integration(Integration::BackwardEuler), r: 1e9));
    let coulomb = Coulomb::new(&CoulombParameters::new(0.2), 1000.0).expect("valid parameters");
    let mut random = Random(1);
    let (mut a, mut b) = (sharp.initial_state(0.0, 0.0), coulomb.initial_state(0.0, 0.0));
    for _ in 0..10_000 {
        let (slip, pressure) = (0.03 * random.between(-1.0, 1.0), PRESSURE * random.between(-0.1, 1.0));
        a = respond(&sharp, &a, slip, pressure, 0.1).state;
        b = respond(&coulomb, &b, slip, pressure, 0.1).state;
        assert_close(a.traction, b.traction, 1e-5 * 0.2 * PRESSURE, "q");
    }
    assert!(b.dissipation > 1.0);
}

/// At a constant pressure a single step books what Coulomb friction does; where the pressure jumps, sub-steps find where
/// slip sets in.
#[test]
fn a_sharp_law_of_constant_coefficient_dissipates_like_coulomb_friction() {
    let coulomb = Coulomb::new(&CoulombParameters::new(0.2), 1000.0).expect("valid parameters");
    for (integration, jumps) in [(Integration::BackwardEuler, false), (Integration::Controlled, true)] {
        let sharp = law(&with!(CONSTANT.integration(integration), r: 1e9));
        let mut random = Random(1);
        let (mut a, mut b) = (sharp.initial_state(0.0, 0.0), coulomb.initial_state(0.0, 0.0));
        for _ in 0..3000 {
            let slip = 0.1 * random.between(-1.0, 1.0);
            let pressure = PRESSURE * if jumps { random.between(0.1, 1.0) } else { 1.0 };
            a = respond(&sharp, &a, slip, pressure, 0.1).state;
            b = respond(&coulomb, &b, slip, pressure, 0.1).state;
        }
        assert!(b.dissipation > 100.0);
        assert_close(a.dissipation, b.dissipation, 1e-5 * b.dissipation, &format!("{integration:?}"));
    }
}

#[test]
fn coulomb_friction_sticks_then_slides() {
    let law = Coulomb::new(&CoulombParameters::new(0.5).alpha_t(100.0), f64::NAN).expect("valid parameters");
    let stuck = respond(&law, &law.initial_state(0.0, 0.0), 0.1, 40.0, 1.0);
    assert_eq!((stuck.state.traction, stuck.dtraction_dslip, stuck.dtraction_dpressure), (10.0, 100.0, 0.0));
    let slid = respond(&law, &stuck.state, -0.5, 40.0, 1.0);
    assert_eq!((slid.state.traction, slid.dtraction_dslip, slid.dtraction_dpressure), (-20.0, 0.0, -0.5));
    assert_close(slid.state.plastic_slip, -0.2, 1e-15, "plastic slip");
    assert_eq!((law.description().stiffness, law.description().uniqueness_limit()), (100.0, None));
}

#[test]
fn without_friction_slip_is_free() {
    let answer = respond(&Frictionless, &Frictionless.initial_state(0.0, 0.0), 3.0, PRESSURE, 1.0);
    assert_eq!((answer.state.traction, answer.state.plastic_slip, answer.state.dissipation), (0.0, 3.0, 0.0));
    assert_eq!(Frictionless.description().stiffness, 0.0);
}

#[test]
fn inside_the_elastic_core_nothing_slips() {
    let core = law(&CONSTANT.elastic_core(0.5));
    let limit = 0.5 * 0.2 * PRESSURE / 1000.0;
    let state = loaded(&core, limit * (1.0 - 1e-9), 1.0, 10);
    assert!(state.traction > 9.8);
    assert_eq!((state.plastic_slip, state.dissipation), (0.0, 0.0));
    let turned = respond(&core, &state, -1.9 * limit, PRESSURE, 1.0).state;
    assert!(turned.traction < -8.0);
    assert_eq!(turned.plastic_slip, 0.0);
    assert!(respond(&core, &state, 0.1 * limit, PRESSURE, 1.0).state.plastic_slip > 0.0);
    assert!(loaded(&law(&CONSTANT), limit, 1.0, 10).plastic_slip > 0.0, "without a core, everything slips");
}

#[test]
fn friction_against_negative_slip_is_the_mirror_image() {
    let law = law(&PAPER);
    let mut random = Random(2);
    let (mut a, mut b) = (law.initial_state(0.0, 0.0), law.initial_state(0.0, 0.0));
    for _ in 0..10_000 {
        let (slip, pressure) = (0.05 * random.between(-1.0, 1.0), PRESSURE * random.between(-0.05, 1.0));
        let dt = random.unit();
        let (plus, minus) = (respond(&law, &a, slip, pressure, dt), respond(&law, &b, -slip, pressure, dt));
        (a, b) = (plus.state, minus.state);
        assert_eq!((a.traction, a.plastic_slip), (-b.traction, -b.plastic_slip));
        assert_eq!((mu_of(&a), a.dissipation), (mu_of(&b), b.dissipation));
        assert_eq!(plus.dtraction_dslip, minus.dtraction_dslip);
        assert_eq!(plus.dtraction_dpressure, -minus.dtraction_dpressure);
    }
    assert!(a.dissipation > 100.0);
}

// Paths

#[test]
fn forced_oscillation_reverses_twice_a_period_at_every_step_size() {
    let law = law(&PAPER.structure(1.0));
    for dt in [1e-4, 1e-3, 1e-2, 0.05, 0.1, 0.3] {
        let mut state = with!(FrictionState::default().with_variables([0.2]), traction: 19.62, pressure: PRESSURE);
        let periods = 5;
        let steps = (f64::from(periods) * 2.0 * PI / dt) as u32;
        let mut reversals = 0;
        for i in 0..steps {
            let slip = (f64::from(i + 1) * dt).sin() - (f64::from(i) * dt).sin();
            let new = respond(&law, &state, slip, PRESSURE, dt).state;
            assert!(new.dissipation >= state.dissipation);
            assert!(new.traction.abs() <= 0.4 * PRESSURE);
            reversals += i32::from(new.traction * state.traction < 0.0);
            state = new;
        }
        assert_eq!(reversals, 2 * periods, "Δt = {dt}");
        assert!(state.dissipation > 19.0 * 4.0 * 4.5, "Δt = {dt}: {}", state.dissipation);
    }
}

#[test]
fn opening_releases_the_traction_and_touching_starts_anew() {
    let law = law(&PAPER);
    let slid = loaded(&law, 0.3, 3.0, 30);
    let open = respond(&law, &slid, 0.1, -5.0, 2.0);
    assert_eq!((open.state.traction, open.state.pressure, open.state.plastic_increment), (0.0, 0.0, 0.0));
    assert_eq!((open.dtraction_dslip, open.dtraction_dpressure), (0.0, 0.0));
    assert_eq!(open.state.plastic_slip, slid.plastic_slip);
    let stored = slid.traction.powi(2) / 2000.0;
    assert_close(open.state.dissipation - slid.dissipation, stored, 1e-12, "released energy");
    assert!(stored > 0.1 && mu_of(&open.state) > mu_of(&slid), "μ ages while open");
    let again = respond(&law, &open.state, 0.01, PRESSURE, 0.1).state;
    let fresh = law.initial_state(0.0, 0.0).with_variables([mu_of(&open.state)]);
    assert_eq!(again.traction, respond(&law, &fresh, 0.01, PRESSURE, 0.1).state.traction);
    assert!(again.traction > 5.0);
}

#[test]
fn unloading_is_elastic() {
    let law = law(&PAPER);
    let slid = loaded(&law, 0.3, 3.0, 30);
    let back = respond(&law, &slid, -0.01, PRESSURE, 0.1);
    assert_close(back.state.traction, slid.traction - 10.0, 1e-12, "q");
    assert_eq!((back.state.plastic_increment, back.dtraction_dslip), (0.0, 1000.0));
    assert!(back.state.ratio(mu_of(&back.state)) < 0.6);
}

// Work: ∮ q du = dissipation, in increments with a reversal inside as well

// Tangents

// Parameters

#[test]
fn bad_parameters_are_refused_by_name_and_value() {
    type Change = fn(&mut SuperSubloadingParameters);
    let table: [(Change, &str); 17] = [
        (|p| p.mu_k = 0.0, "\"mu_k\" is 0, but it must be positive and finite"),
        (|p| p.mu_k = f64::NAN, "\"mu_k\" is NaN, but it must be positive and finite"),
        (|p| p.mu_s = 0.1, "\"mu_s\" is 0.1, but it must be finite and not less than \"mu_k\", which is 0.2"),
        (|p| p.mu_s = f64::INFINITY, "\"mu_s\" is inf, but it must be finite and not less than \"mu_k\", which is 0.2"),
        (|p| p.alpha_t = Some(-1.0), "\"alpha_t\" is -1, but it must be positive and finite"),
        (|p| p.r = 0.0, "\"r\" is 0, but it must be positive and finite"),
        (|p| p.kappa = -10.0, "\"kappa\" is -10, but it must be zero or positive, and finite"),
        (|p| p.xi = -0.002, "\"xi\" is -0.002, but it must be zero or positive, and finite"),
        (|p| p.m = 0.0, "\"m\" is 0, but it must be positive and finite"),
        (|p| p.n = -1.0, "\"n\" is -1, but it must be positive and finite"),
        (|p| p.elastic_core = 1.0, "\"elastic_core\" is 1, but it must be zero or positive, and less than 1"),
        (|p| p.elastic_core = -0.1, "\"elastic_core\" is -0.1, but it must be zero or positive, and less than 1"),
        (|p| p.structure = Some(2.5), "\"structure\" is 2.5, but it must lie between 1 and mu_s/mu_k = 2"),
        (|p| p.structure = Some(0.5), "\"structure\" is 0.5, but it must lie between 1 and mu_s/mu_k = 2"),
        (|p| p.structure = Some(f64::NAN), "\"structure\" is NaN, but it must lie between 1 and mu_s/mu_k = 2"),
        (|p| p.tolerance = Some(0.0), "\"tolerance\" is 0, but it must lie between 1e-12 and 0.1"),
        (|p| p.tolerance = Some(f64::NAN), "\"tolerance\" is NaN, but it must lie between 1e-12 and 0.1"),
    ];
    for (change, message) in table {
        let mut parameters = PAPER;
        change(&mut parameters);
        let refusal = SuperSubloading::new(&parameters, 1.0).expect_err(message);
        assert_eq!(refusal.to_string(), message);
    }
    let coulomb = |mu, alpha_t| Coulomb::new(&CoulombParameters::new(mu).alpha_t(alpha_t), 1.0);
    assert_eq!(coulomb(0.0, 1.0).expect_err("mu").name, "mu");
    assert_eq!(coulomb(0.1, 0.0).expect_err("alpha_t").name, "alpha_t");
}

#[test]
fn the_case_file_names_a_law_and_its_parameters() {
    let read = |text: &str| serde_json::from_str::<FrictionParameters>(text);
    let short = read(r#"{"law": "super_subloading", "mu_s": 0.3, "mu_k": 0.1, "r": 100}"#).expect("defaults");
    let law = short.build(500.0).expect("valid parameters");
    assert_eq!((law.description().stiffness, mu_of(&law.initial_state(0.0, 0.0))), (500.0, 0.3));
    let full = read(
        r#"{"law": "super_subloading", "mu_s": 0.3, "mu_k": 0.1, "alpha_t": 1e5, "r": 100, "kappa": 10, "xi": 0.002,
            "m": 1, "n": 1, "structure": 3.0, "approach": "cotangent", "elastic_core": 0.1}"#,
    );
    assert_eq!(
        full.expect("all given").build(500.0).expect("valid parameters").initial_state(0.0, 0.0).variables[0],
        0.3
    );
    let coulomb = read(r#"{"law": "coulomb", "mu": 0.3}"#).expect("defaults").build(500.0).expect("valid parameters");
    assert!(respond(&*coulomb, &coulomb.initial_state(0.0, 0.0), 1.0, 1.0, 1.0).state.traction > 0.29);
    assert_eq!(
        read(r#"{"law": "frictionless"}"#).expect("no parameters").build(1.0).expect("valid").description().stiffness,
        0.0
    );
    let unknown = read(r#"{"law": "coulomb", "mu": 0.3, "mu_s": 0.4}"#).expect_err("unknown key").to_string();
    assert!(unknown.contains("mu_s"), "{unknown}");
}
