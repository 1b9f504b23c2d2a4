//! The friction laws alone: tangents, closed forms, limits, convergence, and random increments:
//! `INCREMENTS=all cargo test --release --test laws random_increments` takes a million of each integration, the plain test a fifth.

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

#[test]
fn coulomb_loops_dissipate_their_area() {
    let law = Coulomb::new(&CoulombParameters::new(0.2), 1000.0).expect("valid parameters");
    let (limit, amplitude) = (0.2 * PRESSURE, 0.1);
    let turns = [0.0, 1.0, -1.0, 1.0, -1.0, 1.0].map(|turn| [turn * amplitude, PRESSURE]);
    for parts in [1, 2, 3, 7, 1000] {
        // The first stroke, and four times half of the parallelogram.
        let work = limit * (amplitude - limit / 1000.0) + 4.0 * 2.0 * limit * (amplitude - limit / 1000.0);
        let state = strokes(&law, &turns, parts, 1.0);
        assert_close(state.dissipation, work, 1e-12 * work, &format!("{parts} increments a stroke"));
    }
    // The pressure falls with the slip to the right, from p to p/2: the traction is elastic up to u_y, and then on the
    // strength, along which dλ = du + μ |dp|/α_t.
    let turns = [[0.0, PRESSURE], [amplitude, 0.5 * PRESSURE], [0.0, PRESSURE]];
    let fall = 0.2 * 0.5 * PRESSURE / amplitude;
    let at_first = limit / (1000.0 + fall);
    let there = 0.5 * (1000.0 * at_first + 0.5 * limit) * (amplitude - at_first) * (1.0 + fall / 1000.0);
    // Back: −q = α_t s − μ p/2 meets μ p (1 + s/A)/2 at s after the turn.
    let turned = limit / (1000.0 - fall);
    let back = 0.5 * (1000.0 * turned - 0.5 * limit + limit) * (amplitude - turned) * (1.0 - fall / 1000.0);
    for parts in [1, 2, 3, 7, 1000] {
        let state = strokes(&law, &turns, parts, 1.0);
        assert_close(state.dissipation, there + back, 1e-12 * (there + back), &format!("{parts}, pressure varies"));
    }
}

/// Along straight lines of slip and pressure Coulomb friction is integrated exactly: one increment, whatever happens inside,
/// is seven.
#[test]
fn coulomb_increments_add_up() {
    let law = Coulomb::new(&CoulombParameters::new(0.3), 1000.0).expect("valid parameters");
    let mut random = Random(5);
    let mut slid = 0;
    for _ in 0..20_000 {
        let pressure = [random.magnitude(-3.0, 2.0), random.magnitude(-3.0, 2.0)];
        let traction = 0.3 * pressure[0] * random.between(-1.0, 1.0);
        let old = with!(law.initial_state(0.0, 0.0), traction: traction, pressure: pressure[0]);
        let slip = random.sign() * random.magnitude(-6.0, 0.0);
        let one = respond(&law, &old, slip, pressure[1], 1.0).state;
        let many = (1..=7).fold(old, |old, k| {
            let now = pressure[0] + f64::from(k) / 7.0 * (pressure[1] - pressure[0]);
            respond(&law, &old, slip / 7.0, now, 1.0).state
        });
        let scale = traction.abs() + 1000.0 * slip.abs() + pressure[0].max(pressure[1]);
        assert_close(many.traction, one.traction, 1e-13 * scale, "q");
        assert_close(many.dissipation, one.dissipation, 1e-13 * scale * scale / 1000.0, "dissipation");
        slid += usize::from(one.dissipation > 0.0);
    }
    assert!(slid > 5000, "{slid}");
}

/// κ = ξ = 0: between q = 0 and R the slip u = R μ p/α_t − li(R)/r dissipates μ p ∫ R dλ = −μ p li(R²)/r.
#[test]
fn super_subloading_loops_dissipate_their_closed_form() {
    let strength = 0.2 * PRESSURE;
    for integration in [Integration::BackwardEuler, Integration::Controlled] {
        let law = law(&CONSTANT.integration(integration));
        for parts in [1, 2, 3, 7, 100] {
            let (mut points, mut work, mut before, mut at) = (vec![[0.0, PRESSURE]], 0.0, 0.0, 0.0);
            for (k, ratio) in [0.6, 0.9, 0.99, 0.5, 0.999, 0.95].into_iter().enumerate() {
                let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
                at += sign * (strength * (ratio + before) / 1000.0 + minus_li(ratio) / 100.0);
                points.push([at, PRESSURE]);
                work += strength * minus_li(ratio * ratio) / 100.0;
                before = ratio;
            }
            let state = strokes(&law, &points, parts, 1.0);
            assert_close(state.traction, -0.95 * strength, 1e-10 * strength, "q");
            assert_close(state.dissipation, work, 1e-12 * work, &format!("{integration:?}, {parts} parts"));
        }
    }
}

/// With weakening, recovery, exponents and a pressure that varies: one increment a stroke under error control against 4000
/// with a much smaller tolerance, and those against the trapezoidal ∮ q du.
#[test]
fn controlled_increments_dissipate_the_work_of_their_path() {
    let base = PAPER.integration(Integration::Controlled).xi(0.05);
    let variants =
        [base, base.exponents(1.5, 0.7).elastic_core(0.2), base.approach(Approach::Cotangent).structure(1.3)];
    let points = [[0.0, 60.0], [0.12, 80.0], [-0.1, 90.0], [0.15, 50.0], [0.0, 70.0]];
    for parameters in variants {
        let fine_law = law(&parameters.tolerance(1e-10));
        let (mut old, mut work, parts) = (with!(fine_law.initial_state(0.0, 0.0), pressure: 60.0), 0.0, 4000);
        for stroke in points.windows(2) {
            let [[u0, p0], [u1, p1]] = [stroke[0], stroke[1]];
            for k in 1..=parts {
                let slip = (u1 - u0) / f64::from(parts);
                let pressure = p0 + f64::from(k) / f64::from(parts) * (p1 - p0);
                let new = respond(&fine_law, &old, slip, pressure, 2.0 / f64::from(parts)).state;
                assert!(new.dissipation >= old.dissipation);
                work += 0.5 * (old.traction + new.traction) * slip;
                old = new;
            }
        }
        let stored = old.traction.powi(2) / 2000.0;
        assert_close(old.dissipation + stored, work, 1e-5 * work, "the trapezoidal rule");
        for parts in [1, 2, 5] {
            let state = strokes(&law(&parameters), &points, parts, 2.0);
            // The mean of q is right to the tolerance 1e-6 μ_s p, along 0.64 of slip.
            assert_close(state.dissipation, old.dissipation, 4.0 * 1e-6 * 0.4 * 90.0 * 0.64, &format!("{parts} parts"));
        }
    }
}

/// Under a soft contact the traction snaps: what the contact had stored is dissipated, and one increment a stroke books
/// ∮ q du of many.
#[test]
fn a_snap_dissipates_what_it_releases() {
    let parameters = with!(PAPER.alpha_t(200.0).integration(Integration::Controlled).xi(0.0), r: 2000.0);
    let law = law(&parameters);
    let (mut old, mut work, parts) = (with!(law.initial_state(0.0, 0.0), pressure: PRESSURE), 0.0, 20_000);
    let mut snapped = 0.0f64;
    for _ in 0..parts {
        let slip = 0.4 / f64::from(parts);
        let new = respond(&law, &old, slip, PRESSURE, 0.0).state;
        work += 0.5 * (old.traction + new.traction) * slip;
        snapped = snapped.max(old.traction - new.traction);
        old = new;
    }
    assert!(snapped > 2.0, "the traction falls by {snapped} at most");
    let stored = |state: &FrictionState| state.traction.powi(2) / 400.0;
    assert_close(old.dissipation + stored(&old), work, 1e-4 * work, "many");
    let one = strokes(&law, &[[0.0, PRESSURE], [0.4, PRESSURE]], 1, 0.0);
    assert_close(one.dissipation + stored(&one), work, 1e-4 * work, "one");
}

// Tangents

/// Central differences (∂q/∂Δu, ∂q/∂p) about an increment.
fn differences(law: &dyn FrictionLaw, old: &FrictionState, at: Sliding, du: f64, dp: f64) -> (f64, f64) {
    let traction = |slip, pressure| respond(law, old, slip, pressure, at.dt).state.traction;
    (
        (traction(at.slip + du, at.pressure) - traction(at.slip - du, at.pressure)) / (2.0 * du),
        (traction(at.slip, at.pressure + dp) - traction(at.slip, at.pressure - dp)) / (2.0 * dp),
    )
}

#[test]
fn tangents_agree_with_differences() {
    let variants =
        [PAPER, PAPER.exponents(1.5, 0.7).elastic_core(0.2), PAPER.approach(Approach::Cotangent).exponents(0.6, 2.0)];
    for parameters in variants {
        let law = law(&parameters);
        let stick = loaded(&law, 0.01, 1.0, 10);
        let slide = loaded(&law, 0.3, 3.0, 100);
        let full = loaded(&law, 9.0, 90.0, 900);
        let cases = [
            ("first touch", law.initial_state(0.0, 0.0), 0.02, PRESSURE),
            ("stick", stick.clone(), 0.003, PRESSURE),
            ("unloading", stick.clone(), -0.003, PRESSURE),
            ("reversal of stick", stick, -0.03, PRESSURE),
            ("slip", slide.clone(), 0.01, PRESSURE),
            ("full sliding", full.clone(), 0.01, PRESSURE),
            ("large slip", slide.clone(), 10.0, PRESSURE),
            ("reversal of slip", slide.clone(), -0.05, PRESSURE),
            ("large reversal", full, -10.0, PRESSURE),
            ("pressure rise in slip", slide.clone(), 0.03, 1.5 * PRESSURE),
            ("pressure rise", slide.clone(), 0.001, 1.5 * PRESSURE),
            ("pressure fall", slide.clone(), 0.01, 0.6 * PRESSURE),
            ("pressure fall against slip", slide.clone(), -0.002, 0.6 * PRESSURE),
            ("almost open", slide.clone(), 0.01, 1e-3 * PRESSURE),
            ("opening", slide, 0.01, -1.0),
        ];
        for (what, old, slip, pressure) in cases {
            let sliding = Sliding::new(slip, pressure, 0.1);
            let answer = respond(&law, &old, slip, pressure, 0.1);
            let (dslip, dpressure) = differences(&law, &old, sliding, 1e-8, 1e-6 * pressure.abs());
            assert_close(answer.dtraction_dslip, dslip, 1e-5 * 1000.0, &format!("∂q/∂Δu, {what}"));
            assert_close(answer.dtraction_dpressure, dpressure, 1e-6, &format!("∂q/∂p, {what}"));
            let resists = answer.dtraction_dslip != 0.0 || answer.dtraction_dpressure != 0.0;
            assert_eq!(resists, pressure > 0.0, "{what}");
        }
    }
}

// Random increments

fn random_parameters(random: &mut Random, integration: Integration) -> SuperSubloadingParameters {
    let mu_k = random.magnitude(-2.0, 0.0);
    let exponent = |random: &mut Random| if random.chance(0.7) { 1.0 } else { random.between(0.3, 3.0) };
    let or_zero = |random: &mut Random, low, high| if random.chance(0.2) { 0.0 } else { random.magnitude(low, high) };
    with!(
        PAPER,
        mu_s: if random.chance(0.1) { mu_k } else { mu_k * random.between(1.0, 5.0) },
        mu_k: mu_k,
        alpha_t: Some(random.magnitude(1.0, 6.0)),
        r: random.magnitude(0.0, 4.0),
        kappa: or_zero(random, -1.0, 2.0),
        xi: or_zero(random, -4.0, 1.0),
        m: exponent(random),
        n: exponent(random),
        structure: None,
        approach: if random.chance(0.7) { Approach::Logarithmic } else { Approach::Cotangent },
        elastic_core: if random.chance(0.7) { 0.0 } else { random.between(0.0, 0.95) },
        integration: integration,
        tolerance: (integration == Integration::Controlled).then_some(1e-3),
    )
}

fn random_state(random: &mut Random, parameters: &SuperSubloadingParameters) -> FrictionState {
    // A strength between far below and far above what one length 1/r of elastic slip can reach.
    let stiffness = parameters.alpha_t.expect("given");
    let pressure = stiffness / parameters.r * random.magnitude(-3.0, 2.0);
    let mu = random.between(parameters.mu_k, parameters.mu_s);
    let ratio = match random.unit() {
        x if x < 0.1 => 0.0,
        x if x < 0.3 => 1.0,
        x if x < 0.5 => 1.0 - random.magnitude(-16.0, 0.0),
        x if x < 0.6 => random.magnitude(-12.0, 0.0),
        _ => random.unit(),
    };
    with!(FrictionState::default().with_variables([mu]), traction: random.sign() * ratio * mu * pressure, pressure: pressure)
}

fn random_sliding(random: &mut Random, parameters: &SuperSubloadingParameters, old: &FrictionState) -> Sliding {
    let slip = if random.chance(0.05) { 0.0 } else { random.sign() * random.magnitude(-9.0, 3.0) / parameters.r };
    let pressure = match random.unit() {
        x if x < 0.05 => -old.pressure,
        x if x < 0.4 => old.pressure,
        x if x < 0.7 => old.pressure * random.between(0.5, 1.5),
        _ => old.pressure * random.magnitude(-6.0, 6.0),
    };
    Sliding::new(slip, pressure, if random.chance(0.2) { 0.0 } else { random.magnitude(-6.0, 6.0) })
}

/// What must hold for every answer.
fn check_answer(parameters: &SuperSubloadingParameters, old: &FrictionState, answer: &FrictionResponse) {
    let new = &answer.state;
    assert!(new.traction.is_finite() && new.plastic_slip.is_finite());
    assert!(answer.dtraction_dslip.is_finite() && answer.dtraction_dpressure.is_finite());
    assert!(new.ratio(mu_of(new)) <= 1.0 + 1e-12, "R = {}", new.ratio(mu_of(new)));
    assert!(parameters.mu_k <= mu_of(new) && mu_of(new) <= parameters.mu_s, "μ = {}", mu_of(new));
    assert!(new.dissipation >= old.dissipation, "dissipation fell to {}", new.dissipation);
    assert!(new.traction * new.plastic_increment >= 0.0, "plastic slip against friction");
    assert!(answer.dtraction_dslip.abs() <= STEEPEST * parameters.alpha_t.expect("given"));
    assert!(answer.dtraction_dpressure.abs() <= STEEPEST);
}

/// Branch of an increment: open, elastic, or slipping in one direction, from the trial traction alone. Slip that does not
/// load is elastic throughout; one that loads is so only in a single step that outlasts it by recovery.
fn branch(
    law: &SuperSubloading,
    parameters: &SuperSubloadingParameters,
    old: &FrictionState,
    at: Sliding,
) -> Option<f64> {
    let trial = old.traction + law.description().stiffness * at.slip;
    let reversed = trial * old.traction.signum() < 0.0;
    let elastic = match parameters.integration {
        Integration::Controlled => !reversed && trial.abs() * old.pressure <= old.traction.abs() * at.pressure,
        _ => {
            let aged = mu_of(&respond(law, old, 0.0, -1.0, at.dt).state);
            let ratio = if reversed { 0.0 } else { old.ratio(mu_of(old)).min(1.0) };
            trial.abs() <= ratio.max(parameters.elastic_core) * aged * at.pressure
        }
    };
    (at.pressure > 0.0).then_some(if elastic { 0.0 } else { trial.signum() })
}

/// A derivative of q to be compared with central differences.
struct Derivative {
    value: f64,
    /// Size that an error is compared with.
    scale: f64,
    /// Largest change of the argument.
    largest: f64,
    /// Round-off of q.
    noise: f64,
    /// Whether there are no sub-steps.
    one_step: bool,
}

impl Derivative {
    /// Whether central differences of fourth order agree, for some change of the argument large enough to see beyond
    /// round-off and small enough to stay on one branch where D > 0.05 α_t and the tangent hardly turns; `None` if there
    /// is no such change, or the sub-steps are not the same, between which the answer may jump by the tolerance.
    fn agrees(&self, respond: impl Fn(f64) -> Option<(Option<f64>, FrictionResponse)>, alpha_t: f64) -> Option<bool> {
        let (branch, answer) = respond(0.0)?;
        let sharp = |answer: &FrictionResponse| 1.0 - answer.dtraction_dslip / alpha_t >= 20.0;
        if sharp(&answer) || self.largest == 0.0 {
            return None;
        }
        let resolved = |(side, point): &(Option<f64>, FrictionResponse)| {
            let turn = (point.dtraction_dslip - answer.dtraction_dslip).abs() / alpha_t;
            let tilt = (point.dtraction_dpressure - answer.dtraction_dpressure).abs() / mu_of(&answer.state);
            *side == branch && !sharp(point) && turn < 2e-3 && tilt < 2e-3
        };
        let mut agreement = [1e-2, 1e-1, 1e-3, 1.0, 1e-4, 1e-5]
            .into_iter()
            .map(|factor| factor * self.largest)
            .filter(|h| self.noise < 1e-6 * self.scale * h)
            .filter_map(|h| {
                let points = [respond(-2.0 * h)?, respond(-h)?, respond(h)?, respond(2.0 * h)?];
                let [a, b, c, d] = points.clone().map(|(_, answer)| answer.state.traction);
                let difference = (a - 8.0 * b + 8.0 * c - d) / (12.0 * h);
                let agrees = (difference - self.value).abs() < 1e-5 * self.scale;
                let same_steps = points.iter().all(|(_, point)| point.evaluations == answer.evaluations);
                (points.iter().all(resolved) && (agrees || self.one_step || same_steps)).then_some(agrees)
            });
        let first = agreement.next()?;
        Some(first || agreement.any(|agrees| agrees))
    }
}

/// Every `sample`th tangent of 100 000 increments is compared with differences, with `INCREMENTS=all` of a million.
fn answer_random_increments(integration: Integration, sample: usize) {
    let laws: u64 = if std::env::var("INCREMENTS").is_ok_and(|wanted| wanted == "all") { 18_200 } else { 1820 };
    const INCREMENTS: usize = 55;
    let (compared, failed) = (AtomicUsize::new(0), AtomicUsize::new(0));
    (0..laws).into_par_iter().for_each(|seed| {
        let mut random = Random(seed.wrapping_mul(0x1234_5678_9abc_def1));
        let parameters = random_parameters(&mut random, integration);
        let law = law(&parameters);
        let alpha_t = law.description().stiffness;
        let mut state = random_state(&mut random, &parameters);
        for increment in 0..INCREMENTS {
            if random.chance(0.3) || !(1e-8..1e8).contains(&(state.pressure / alpha_t)) {
                state = random_state(&mut random, &parameters);
            }
            let old = state.clone();
            let at = random_sliding(&mut random, &parameters, &old);
            let Sliding { slip, pressure, dt, .. } = at;
            let answer = match law.respond(&old, at) {
                Err(LawFailure::NotConverged { .. }) => {
                    failed.fetch_add(1, Ordering::Relaxed);
                    continue;
                }
                answer => answer.expect("a finite increment is answered"),
            };
            check_answer(&parameters, &old, &answer);

            state = answer.state.clone();
            if !(seed as usize * INCREMENTS + increment).is_multiple_of(sample) {
                continue;
            }
            let (dslip, dpressure) = (answer.dtraction_dslip, answer.dtraction_dpressure);
            let trial = (old.traction + alpha_t * slip).abs();
            let noise =
                5e-14 * (trial / alpha_t + 1.0 / parameters.r) * dslip.abs() + 1e-15 * answer.state.traction.abs();
            let length = (1.0 / parameters.r).min(mu_of(&answer.state) * pressure.abs() / alpha_t);
            let by_slip = Derivative {
                value: dslip,
                scale: dslip.abs().max(alpha_t),
                largest: 1e-3 * length.min(trial / alpha_t),
                noise,
                one_step: integration == Integration::BackwardEuler,
            };
            let by_pressure = Derivative {
                value: dpressure,
                scale: dpressure.abs().max(mu_of(&answer.state)),
                largest: 1e-3 * pressure.abs(),
                noise,
                one_step: integration == Integration::BackwardEuler,
            };
            let answer_at = |slip, pressure| {
                let at = Sliding::new(slip, pressure, dt);
                Some((branch(&law, &parameters, &old, at), law.respond(&old, at).ok()?))
            };
            let by_slip = by_slip.agrees(|h| answer_at(slip + h, pressure), alpha_t);
            let by_pressure = by_pressure.agrees(|h| answer_at(slip, pressure + h), alpha_t);
            if let (Some(by_slip), Some(by_pressure)) = (by_slip, by_pressure) {
                compared.fetch_add(1, Ordering::Relaxed);
                assert!(
                    by_slip && by_pressure,
                    "by slip: {by_slip}, by pressure: {by_pressure}: {parameters:?} {old:?} {at:?} {answer:?}"
                );
            }
        }
    });
    let (compared, failed, total) = (compared.into_inner(), failed.into_inner(), laws as usize * INCREMENTS);
    println!("{total} increments, {failed} too long to converge, tangents of {compared} compared");
    // Long rests under pressures far beyond the limit of uniqueness, in which the contact sticks and slips without end.
    assert!(failed * 400 <= total, "{failed} of {total} increments were not answered");
    assert!(compared * sample * 20 >= total * 17, "tangents of only {compared} of {total} increments were compared");
}

#[test]
fn random_increments_by_backward_euler_are_answered_with_their_tangent() {
    answer_random_increments(Integration::BackwardEuler, 1);
}

#[test]
fn random_increments_under_control_are_answered_with_their_tangent() {
    answer_random_increments(Integration::Controlled, 50);
}

#[test]
fn absurd_increments_are_answered_or_refused() {
    let law = law(&PAPER);
    let numbers = [0.0, 1e-320, 1e-30, 1.0, 1e30, 1e300, f64::MAX, f64::INFINITY, f64::NAN];
    let states = [law.initial_state(0.0, 0.0), FrictionState::default(), loaded(&law, 0.3, 3.0, 30)];
    let mut answered = 0;
    for slip in numbers {
        for pressure in numbers {
            for dt in numbers {
                for old in &states {
                    if let Ok(answer) = law.respond(old, Sliding::new(slip, pressure, dt)) {
                        check_answer(&PAPER, old, &answer);
                        answered += i32::from(answer.state.traction > 0.0);
                    }
                }
            }
        }
    }
    assert!(answered > 100, "only {answered} were answered with friction");
    let backwards = law.respond(&law.initial_state(0.0, 0.0), Sliding::new(0.0, 1.0, -1.0));
    assert_eq!(backwards, Err(LawFailure::NegativeTime { dt: -1.0 }));
}

// Uniqueness

#[test]
fn the_uniqueness_limit_is_where_the_slope_can_vanish() {
    let limit = |parameters| law(&parameters).description().uniqueness_limit();
    assert_close(limit(PAPER).expect("a limit"), 100.0, 1e-10, "limit");
    let steep = with!(PAPER, mu_s: 0.8, m: 2.0, structure: None);
    assert_close(limit(steep).expect("a limit"), 1000.0 / (10.0 * 9.0), 1e-10, "limit");
    assert_eq!(limit(PAPER.kappa(0.0)), None);
    assert_eq!(limit(CONSTANT), None);
}

#[test]
fn beyond_the_uniqueness_limit_the_first_root_is_taken() {
    let mut random = Random(4);
    let mut several = 0;
    for _ in 0..300 {
        let parameters = with!(
            BACKWARD_EULER,
            alpha_t: Some(random.magnitude(1.0, 3.0)),
            r: random.magnitude(1.5, 3.5),
            kappa: random.magnitude(0.5, 1.5),
            mu_s: random.between(0.3, 1.0),
            structure: None,
            approach: if random.chance(0.5) { Approach::Logarithmic } else { Approach::Cotangent },
        );
        let law = law(&parameters);
        let mu = parameters.mu_s * random.between(0.8, 1.0);
        let traction = random.between(0.1, 0.99) * mu * PRESSURE;
        let old = with!(FrictionState::default().with_variables([mu]), traction: traction, pressure: PRESSURE);
        let slip = (mu * PRESSURE - traction) * random.between(0.0, 1.1) / law.description().stiffness;
        let roots = scan(&parameters, &old, slip, 0.1);
        let found = respond(&law, &old, slip, PRESSURE, 0.1).state.plastic_increment;
        let (low, high) = roots[0];
        assert!((low * (1.0 - 1e-9)..=high * (1.0 + 1e-9)).contains(&found), "{found}, but the roots are {roots:?}");
        several += i32::from(roots.len() > 1);
    }
    println!("several roots in {several} of 300 increments");
    assert!(several >= 20, "several roots in only {several} increments");
}

/// Intervals of plastic slip where |q_tr| − α_t Δλ − R μ p falls through 0, on a fine grid; m = n = 1.
fn scan(parameters: &SuperSubloadingParameters, old: &FrictionState, slip: f64, dt: f64) -> Vec<(f64, f64)> {
    let SuperSubloadingParameters { mu_s, mu_k, r, kappa, xi, approach, .. } = *parameters;
    let alpha_t = parameters.alpha_t.expect("given");
    let trial = old.traction + alpha_t * slip;
    let (start, pressure) = (old.ratio(mu_of(old)), old.pressure);
    let residual = |slip: f64, ratio: f64| {
        let mu = (mu_of(old) + kappa * slip + xi * dt) / (1.0 + kappa * slip / mu_k + xi * dt / mu_s);
        trial - alpha_t * slip - ratio * mu * pressure
    };
    // Along R = 1 − (1 − R₀) e^(−z) up to z = 25, then along the slip itself with R = 1.
    let points = 10_000;
    let origin = distance(approach, start);
    let near = (0..=points).map(|i| {
        let ratio = 1.0 - (1.0 - start) * (-25.0 * f64::from(i) / f64::from(points)).exp();
        ((distance(approach, ratio) - origin) / r, ratio)
    });
    let last = near.clone().next_back().expect("points").0;
    let rest = (trial / alpha_t - last).max(0.0);
    let far = (1..=points).map(|i| (last + rest * f64::from(i) / f64::from(points), 1.0));
    let values: Vec<_> = near.chain(far).map(|(slip, ratio)| (slip, residual(slip, ratio))).collect();
    values.windows(2).filter(|pair| pair[0].1 > 0.0 && pair[1].1 <= 0.0).map(|pair| (pair[0].0, pair[1].0)).collect()
}

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

/// The controlled integration answers with a smooth curve from one number of sub-steps to the next, and jumps there, by no
/// more than its tolerance: a difference quotient taken across such a place is off, whatever the tangent. Told by the tangent
/// itself: over a slip of 1e-6 the traction changes by the mean of the tangents at both ends, to 1e-10 μ_s p where the number
/// of evaluations stays.
#[test]
fn the_controlled_answer_jumps_only_where_sub_steps_change() {
    let law = law(&PAPER.integration(Integration::Controlled).xi(0.02).structure(1.8));
    let old = with!(law.initial_state(0.0, 0.0), traction: 2.0, pressure: 20.0);
    let (step, pressure) = (1e-6, 30.0);
    let at = |k: usize| respond(&law, &old, 0.005 + step * k as f64, pressure, 0.3);
    let (mut smooth, mut jump, mut jumps) = (0.0f64, 0.0f64, 0);
    let mut before = at(0);
    for k in 1..=30_000 {
        let now = at(k);
        let expected = 0.5 * step * (before.dtraction_dslip + now.dtraction_dslip);
        let off = (now.state.traction - before.state.traction - expected).abs() / (0.4 * pressure);
        match now.evaluations == before.evaluations {
            true => smooth = smooth.max(off),
            false => {
                jump = jump.max(off);
                jumps += usize::from(off > 1e-10);
            }
        }
        before = now;
    }
    println!("off by {smooth:.1e} on the way, by up to {jump:.1e} at {jumps} places");
    assert!(smooth < 1e-10 && jump < 1e-6 && jumps > 0, "{smooth}, {jump}, {jumps}");
}
