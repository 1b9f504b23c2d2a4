//! Rate-and-state friction along records: the answers are those of its differential equations, however far apart the samples.

use fecontact::laws::friction::sensitivity::{Direction, Variation};
use fecontact::laws::friction::{
    FrictionLaw, FrictionResponse, FrictionState, RateAndState, RateAndStateParameters, Sliding, StateEvolution,
};

/// Velocity steps around 1e-3, a hold, and a slide, in millimetres, seconds and megapascals.
const LABORATORY: RateAndStateParameters =
    RateAndStateParameters::new(0.6, 1e-3, 0.010, 0.015, 0.02).evolution(StateEvolution::Ageing).alpha_t(1000.0);

const EVOLUTIONS: [StateEvolution; 2] = [StateEvolution::Ageing, StateEvolution::Slip];

const SAMPLE: f64 = 0.25;
const SAMPLES: usize = 240;
const START: [f64; 2] = [5.0, 3.0];

fn law(parameters: &RateAndStateParameters) -> Box<dyn FrictionLaw> {
    let law = RateAndState::new(parameters, f64::NAN).expect("valid parameters");
    law.controlled().expect("paths are controlled")
}

/// Slip rate in the k-th sample.
fn rate(k: usize) -> f64 {
    match k {
        0..40 => 1e-3,
        40..80 => 1e-2,
        80..120 => 1e-3,
        120..200 => 0.0,
        _ => 3e-3,
    }
}

/// Pressure at the end of the k-th sample: it rises during the last slide.
fn pressure(k: usize) -> f64 {
    START[0] + 0.01 * (k as f64 - 200.0).max(0.0)
}

fn start(law: &dyn FrictionLaw) -> FrictionState {
    law.initial_state(START[0], START[1])
}

/// The answers at the samples, each reached by so many increments.
fn driven(law: &dyn FrictionLaw, increments: usize) -> Vec<FrictionResponse> {
    let mut state = start(law);
    let sample = |k: usize| {
        let mut last = FrictionResponse::default();
        for i in 1..=increments {
            let share = 1.0 / increments as f64;
            let pressure = pressure(k) + share * i as f64 * (pressure(k + 1) - pressure(k));
            let sliding = Sliding::new(rate(k) * SAMPLE * share, pressure, SAMPLE * share);
            last = law.respond(&state, sliding).expect("an answer");
            state = last.state.clone();
        }
        last
    };
    (0..SAMPLES).map(sample).collect()
}

/// (q, ln θ, W + q²/(2 α_t), ln θ₂) at the samples by the method of Runge and Kutta, of the equations as they are written.
fn integrated(p: &RateAndStateParameters) -> Vec<[f64; 4]> {
    const STEPS: usize = 2500;
    let alpha_t = p.alpha_t.expect("given");
    let h = SAMPLE / STEPS as f64;
    let (b_2, length) = (p.b_2.unwrap_or(0.0), p.critical_slip_2.unwrap_or(1.0));
    let rates = |v: f64, pressure: f64, [q, log, _, second]: [f64; 4]| {
        let effect = |b: f64, length: f64, log: f64| b * (p.reference_rate / length).ln() + b * log;
        let psi = p.f_0 + effect(p.b, p.critical_slip, log) + effect(b_2, length, second);
        let slip_rate = 2.0 * p.reference_rate * (q / (p.a * pressure)).sinh() * (-psi / p.a).exp();
        let dlog = |log: f64, length: f64| {
            let y = slip_rate * log.exp() / length;
            match p.evolution {
                StateEvolution::Ageing => (1.0 - y) * (-log).exp(),
                _ => -y * y.ln() * (-log).exp(),
            }
        };
        [alpha_t * (v - slip_rate), dlog(log, p.critical_slip), q * v, dlog(second, length)]
    };
    let [log, second] = [p.critical_slip, length].map(|length| (length / p.reference_rate).ln());
    let mut y = [START[1], log, START[1] * START[1] / (2.0 * alpha_t), second];
    let step = |y: [f64; 4], k: [f64; 4], s: f64| [0, 1, 2, 3].map(|i| y[i] + s * k[i]);
    let sample = |k: usize| {
        let v = rate(k);
        for i in 0..STEPS {
            let at = |x: f64| pressure(k) + (i as f64 + x) / STEPS as f64 * (pressure(k + 1) - pressure(k));
            let k1 = rates(v, at(0.0), y);
            let k2 = rates(v, at(0.5), step(y, k1, 0.5 * h));
            let k3 = rates(v, at(0.5), step(y, k2, 0.5 * h));
            let k4 = rates(v, at(1.0), step(y, k3, h));
            y = [0, 1, 2, 3].map(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        }
        y
    };
    (0..SAMPLES).map(sample).collect()
}

/// Largest differences of traction, ln θ, work and, of a law with a second state, ln θ₂.
fn differences(answers: &[FrictionResponse], exact: &[[f64; 4]]) -> [f64; 4] {
    let mut most = [0.0f64; 4];
    for (FrictionResponse { state, .. }, exact) in answers.iter().zip(exact) {
        let work = state.dissipation + state.traction * state.traction / (2.0 * 1000.0);
        let second = if state.variables[1] > 0.0 { state.variables[1].ln() } else { exact[3] };
        let found = [state.traction, state.variables[0].ln(), work, second];
        (0..4).for_each(|i| most[i] = most[i].max((found[i] - exact[i]).abs()));
    }
    most
}

#[test]
fn coarse_records_are_answered_by_the_differential_equations() {
    let laws =
        [LABORATORY, with!(LABORATORY, b: -0.01), LABORATORY.second(-0.006, 0.2), LABORATORY.second(0.004, 0.005)];
    for parameters in EVOLUTIONS.map(|evolution| laws.map(|law| law.evolution(evolution))).into_iter().flatten() {
        let evolution = parameters.evolution;
        let exact = integrated(&parameters);
        for increments in [1, 3, 20] {
            let [traction, state, work, second] = differences(&driven(&*law(&parameters), increments), &exact);
            println!("{evolution:?} {increments}: {traction:e} {state:e} {work:e}");
            // 1e-6 f₀ p in q, 1e-6 f₀ in (a + b) ln θ; the work is that of 0.2 mm.
            assert!(traction < 3e-6, "{evolution:?}, {increments}: {traction:e}");
            assert!(state < 2.4e-5, "{evolution:?}, {increments}: {state:e}");
            // 1e-6 f₀ in b₂ ln θ₂, of at least 0.004
            assert!(second < 1.5e-4, "{evolution:?}, {increments}: {second:e}");
            assert!(work < 1e-6, "{evolution:?}, {increments}: {work:e}");
        }
        let single = RateAndState::new(&parameters, f64::NAN).expect("valid parameters");
        let [traction, ..] = differences(&driven(&single, 1), &exact);
        println!("{evolution:?} of first order: {traction:e}");
        assert!(traction > 0.01, "single increments of first order are far off: {traction:e}");
    }
}

#[test]
fn sensitivities_along_records_are_those_of_the_answers() {
    const CHANGES: [(f64, f64); 4] = [(1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)];
    for evolution in EVOLUTIONS {
        let parameters = LABORATORY.evolution(evolution).theta(17.0).second(-0.006, 0.2).theta_2(150.0);
        let law = law(&parameters);
        let sensitive = law.sensitivities().expect("differentiated");
        for name in sensitive.parameters() {
            let mut by = sensitive.start(name);
            let mut found = Vec::new();
            let mut old = start(&*law);
            for (k, answer) in driven(&*law, 1).iter().enumerate() {
                let sliding = Sliding::new(rate(k) * SAMPLE, pressure(k + 1), SAMPLE);
                let along = with!(Direction::default(), state: by, slip: 0.0, parameter: Some(*name));
                [by, _] = sensitive.vary(&old, sliding, [along, Direction::default()]).expect("an answer");
                (old, found) = (answer.state.clone(), [found, vec![by.clone()]].concat());
            }
            let shifted = |share: f64| driven(&*self::law(&with(&parameters, name, share)), 1);
            let h = 1e-3;
            let of = value(&parameters, name);
            let mut differences = vec![0.0; SAMPLES];
            for (at, weight) in CHANGES {
                for (sum, answer) in differences.iter_mut().zip(shifted(at * h)) {
                    *sum += weight * answer.state.traction / (12.0 * h * of);
                }
            }
            let scale = found.iter().map(|by: &Variation| by.traction.abs()).fold(0.0, f64::max);
            let worst =
                found.iter().zip(&differences).map(|(by, exact)| (by.traction - exact).abs()).fold(0.0, f64::max);
            println!("{evolution:?} {name}: {worst:e} of {scale:e}");
            // The quotients jump by some 1e-7/h where sub-steps change.
            assert!(worst <= 5e-4 * scale, "{evolution:?}, {name}: {worst:e} of {scale:e}");
        }
    }
}

fn value(p: &RateAndStateParameters, name: &str) -> f64 {
    match name {
        "f_0" => p.f_0,
        "V_0" => p.reference_rate,
        "a" => p.a,
        "b" => p.b,
        "D_c" => p.critical_slip,
        "alpha_t" => p.alpha_t.expect("given"),
        "b_2" => p.b_2.expect("given"),
        "D_c2" => p.critical_slip_2.expect("given"),
        "theta_2" => p.theta_2.expect("given"),
        _ => p.theta.expect("given"),
    }
}

/// The parameters with one of them changed by a share of it.
fn with(p: &RateAndStateParameters, name: &str, share: f64) -> RateAndStateParameters {
    let changed = value(p, name) * (1.0 + share);
    match name {
        "f_0" => with!(*p, f_0: changed),
        "V_0" => with!(*p, reference_rate: changed),
        "a" => with!(*p, a: changed),
        "b" => with!(*p, b: changed),
        "D_c" => with!(*p, critical_slip: changed),
        "alpha_t" => p.alpha_t(changed),
        "b_2" => with!(*p, b_2: Some(changed)),
        "D_c2" => with!(*p, critical_slip_2: Some(changed)),
        "theta_2" => p.theta_2(changed),
        _ => p.theta(changed),
    }
}

/// At a constant slip rate, the contact spring being at rest, θ = D_c/v + (θ₀ − D_c/v) e^(−v t/D_c) of the ageing law; a contact as
/// stiff as this one is at rest at once, and the increments are 5 D_c long.
#[test]
fn theta_at_a_constant_rate_has_its_closed_form() {
    let theta: f64 = 100.0;
    let law = law(&LABORATORY.theta(theta).alpha_t(1e9));
    let mut state = start(&*law);
    for k in 1..=4 {
        let sliding = Sliding::new(0.1, 5.0, 10.0);
        state = law.respond(&state, sliding).expect("an answer").state;
        let exact = 2.0 + (theta - 2.0) * (-5.0 * f64::from(k)).exp();
        assert!((state.variables[0] / exact - 1.0).abs() < 1e-6, "{k}: {} for {exact}", state.variables[0]);
        let steady = 5.0 * (0.6 + 0.015 * (exact / 20.0).ln() + 0.01 * 10f64.ln());
        assert!((state.traction - steady).abs() < 1e-5, "{k}: {} for {steady}", state.traction);
    }
}

/// A stroke that turns within one increment creeps on before it sticks: few increments answer as many do.
#[test]
fn reversals_creep_on_however_long_the_increment() {
    for evolution in EVOLUTIONS {
        for alpha_t in [5.0, 50.0, 1000.0] {
            let law = law(&LABORATORY.evolution(evolution).alpha_t(alpha_t));
            let stroke = |increments: usize| {
                let share = 1.0 / increments as f64;
                let lead = |state: FrictionState, slip: f64| {
                    let sliding = Sliding::new(slip * share, 5.0, 5.0 * share);
                    (0..increments).fold(state, |state, _| law.respond(&state, sliding).expect("an answer").state)
                };
                lead(lead(start(&*law), 1.0), -5.0 / alpha_t)
            };
            let (one, many) = (stroke(1), stroke(1000));
            let difference = (one.traction - many.traction).abs();
            assert!(difference < 3e-6, "{evolution:?}, {alpha_t}: {} for {}", one.traction, many.traction);
        }
    }
}

/// The tangent is that of what is computed: central differences, small against the changes of sub-steps.
#[test]
fn tangents_of_long_increments_are_right() {
    for evolution in EVOLUTIONS {
        let law = law(&LABORATORY.evolution(evolution));
        for (slip, pressure) in [(2e-3, 5.0), (1e-2, 6.0), (0.0, 5.5), (-1e-2, 4.0), (0.1, 5.0)] {
            let respond = |slip: f64, pressure: f64| {
                law.respond(&start(&*law), Sliding::new(slip, pressure, 1.0)).expect("an answer")
            };
            let answer = respond(slip, pressure);
            let quotient = |[ds, dp]: [f64; 2]| {
                let [more, less] = [1.0, -1.0].map(|k| respond(slip + k * ds, pressure + k * dp).state.traction);
                0.5 * (more - less) / (ds + dp)
            };
            let (by_slip, by_pressure) = (quotient([1e-8, 0.0]), quotient([0.0, 1e-6]));
            let (found, along) = (answer.dtraction_dslip, answer.dtraction_dpressure);
            assert!(
                (found - by_slip).abs() < 1e-3 * (by_slip.abs() + 1.0),
                "{slip}, {pressure}: {found} for {by_slip}"
            );
            assert!((along - by_pressure).abs() < 1e-4, "{slip}, {pressure}: {along} for {by_pressure}");
        }
    }
}
