//! The direct effect of the rate in the super/subloading law, q = R μ p (1 + a ln(1 + λ/V₀)).

use super::random::Random;
use fecontact::laws::friction::sensitivity::{Direction, Variation};
use fecontact::laws::friction::{
    Approach, FrictionLaw, FrictionResponse, FrictionState, Integration, Regime, Sliding, SuperSubloading,
    SuperSubloadingParameters,
};

const PRESSURE: f64 = 5.0;
const ALPHA_T: f64 = 1000.0;

/// Static 0.4, kinetic 0.2, with a direct effect of 0.01 from 1e-6 on.
const ROCK: SuperSubloadingParameters =
    SuperSubloadingParameters::new(0.4, 0.2, 100.0).kappa(10.0).xi(0.002).rate_effect(0.01, 1e-6).alpha_t(ALPHA_T);

fn law(parameters: &SuperSubloadingParameters) -> SuperSubloading {
    SuperSubloading::new(parameters, f64::NAN).expect("valid parameters")
}

fn respond(law: &dyn FrictionLaw, old: &FrictionState, sliding: Sliding) -> FrictionResponse {
    law.respond(old, sliding).unwrap_or_else(|failure| panic!("{failure} at {sliding:?} from {old:?}"))
}

/// μ in steady sliding, m = n = 1.
fn steady(rate: f64) -> f64 {
    (10.0 * rate + 0.002) / (10.0 * rate / 0.2 + 0.002 / 0.4)
}

/// The factor of the direct effect.
fn factor(rate: f64) -> f64 {
    1.0 + 0.01 * (1.0 + rate / 1e-6).ln()
}

fn slid(law: &dyn FrictionLaw, mut state: FrictionState, rate: f64, time: f64, increments: usize) -> FrictionState {
    let dt = time / increments as f64;
    for _ in 0..increments {
        state = respond(law, &state, Sliding::new(rate * dt, PRESSURE, dt)).state;
    }
    state
}

/// Steady sliding strengthens with the rate by the direct effect and weakens by the structure: closed form, R = 1.
#[test]
fn steady_sliding_has_the_direct_effect_of_its_rate() {
    for integration in [Integration::Controlled, Integration::BackwardEuler] {
        let law = law(&ROCK.integration(integration));
        let start = law.initial_state(PRESSURE, 0.3 * PRESSURE);
        for (rate, expected) in [(1e-5, 0.390_974), (1e-4, 0.313_845), (1e-3, 0.233_255)] {
            assert!((steady(rate) * factor(rate) - expected).abs() < 1e-6);
            let state = slid(&law, start.clone(), rate, 1.0 / rate, 200);
            let found = state.traction / PRESSURE;
            assert!((found - expected).abs() < 1.5e-6, "{integration:?} at {rate}: {found}");
            assert_eq!(state.regime, Regime::Slip);
            assert!((law.observe("R", &state).unwrap() - 1.0).abs() < 1e-9);
        }
    }
    // Without weakening it only strengthens.
    let law = law(&ROCK.kappa(0.0));
    let steady = |rate: f64| slid(&law, law.initial_state(PRESSURE, 1.9), rate, 1.0 / rate, 100).traction;
    assert!(steady(1e-3) > steady(1e-4) && steady(1e-4) > steady(1e-5));
}

/// Friction jumps with the rate on a stiff contact, and decays at κ V/μ_k + ξ/μ_s: closed form at R = 1.
#[test]
fn a_velocity_step_jumps_and_decays() {
    let law = law(&ROCK.alpha_t(1e7));
    let before = slid(&law, law.initial_state(PRESSURE, 0.39 * PRESSURE), 1e-5, 1e5, 100);
    assert!((before.traction / PRESSURE - 0.390_974).abs() < 1.5e-6);
    // Elastic slip of the contact takes some 1e-10 of the 1e-4 per second.
    let at_once = slid(&law, before.clone(), 1e-4, 2e-4, 10).traction / PRESSURE;
    assert!((at_once - 0.399_440).abs() < 2e-6, "{at_once}");
    for increments in [1, 7, 100] {
        let later = slid(&law, before.clone(), 1e-4, 100.0, increments).traction / PRESSURE;
        assert!((later - 0.345_334).abs() < 1.5e-6, "{increments}: {later}");
    }
    let left = (10.0 * 1e-4 / 0.2 + 0.002 / 0.4) * 100.0;
    let mu = steady(1e-4) + (steady(1e-5) - steady(1e-4)) * f64::exp(-left);
    assert!((left - 1.0).abs() < 1e-12 && (mu * factor(1e-4) - 0.345_334).abs() < 1e-6);
}

/// (q, μ, R, W + q²/(2 α_t)) after a duration of one slip rate and rate of pressure, by the method of Runge and Kutta, of the
/// equations as they are written.
fn integrated(p: &SuperSubloadingParameters, start: [f64; 4], [rate, lift]: [f64; 2], time: f64) -> [f64; 4] {
    let steps = (1e4 * time) as usize;
    let (v0, h) = (p.reference_rate.unwrap(), time / steps as f64);
    let rates = |x: f64, [q, mu, ratio, _]: [f64; 4]| {
        let pressure = PRESSURE + lift * x;
        let lambda = v0 * (((q / (ratio * mu * pressure) - 1.0) / p.a).max(0.0)).exp_m1();
        let excess = (mu / p.mu_k - 1.0).max(0.0).powf(p.m);
        let dmu = -p.kappa * excess * lambda + p.xi * (1.0 - mu / p.mu_s).max(0.0).powf(p.n);
        let dratio = if ratio < 1.0 { -p.r * ratio.ln() * lambda } else { 0.0 };
        [ALPHA_T * (rate - lambda), dmu, dratio, q * rate]
    };
    let mut y = start;
    let step = |y: [f64; 4], k: [f64; 4], s: f64| [0, 1, 2, 3].map(|i| y[i] + s * k[i]);
    for i in 0..steps {
        let x = i as f64 * h;
        let k1 = rates(x, y);
        let k2 = rates(x + 0.5 * h, step(y, k1, 0.5 * h));
        let k3 = rates(x + 0.5 * h, step(y, k2, 0.5 * h));
        let k4 = rates(x + h, step(y, k3, h));
        y = [0, 1, 2, 3].map(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        // Where the traction falls to R μ p, R goes down with it.
        y[2] = y[2].min(y[0] / (y[1] * (PRESSURE + lift * (x + h)))).min(1.0);
    }
    y
}

/// Slides, a velocity step, a hold and a part of unloading, each in few and many increments.
#[test]
fn increments_are_answered_by_the_differential_equations() {
    for parameters in [ROCK, ROCK.exponents(1.5, 0.8).rate_effect(0.03, 1e-5)] {
        let law = law(&parameters);
        let stretches =
            [([1e-3, 0.0], 4.0), ([1e-3, 0.05], 20.0), ([1e-2, 0.0], 5.0), ([0.0, 0.0], 30.0), ([-1e-4, 0.02], 5.0)];
        // Each stretch begins at the pressure of 5 again, at the same R and μ: a jump of all.
        let mut y = [0.3, 0.4, 0.3 / (0.4 * PRESSURE), 0.3 * 0.3 / (2.0 * ALPHA_T)];
        let mut pressure = PRESSURE;
        let exact = stretches.map(|([rate, lift], time)| {
            let lost = y[3] - y[0] * y[0] / (2.0 * ALPHA_T);
            y[0] *= PRESSURE / pressure;
            y[3] = lost + y[0] * y[0] / (2.0 * ALPHA_T);
            pressure = PRESSURE + lift * time;
            y = integrated(&parameters, y, [rate, lift], time);
            y
        });
        for parts in [1, 4, 30] {
            let mut state = law.initial_state(PRESSURE, 0.3);
            for (([rate, lift], time), exact) in stretches.into_iter().zip(&exact) {
                state.traction *= PRESSURE / state.pressure;
                state.pressure = PRESSURE;
                for k in 1..=parts {
                    let dt = time / parts as f64;
                    let pressure = PRESSURE + lift * dt * k as f64;
                    state = respond(&law, &state, Sliding::new(rate * dt, pressure, dt)).state;
                }
                let work = state.dissipation + state.traction * state.traction / (2.0 * ALPHA_T);
                let found = [state.traction, state.variables[0], state.variables[1], work];
                for (i, limit) in [2e-6, 4e-7, 1e-6, 2e-6 * 0.1].into_iter().enumerate() {
                    let error = (found[i] - exact[i]).abs();
                    assert!(error < limit, "{i} in {parts} parts of {rate}, {lift}: {} {}", found[i], exact[i]);
                }
            }
        }
    }
}

/// Vanishing a, or a V₀ never reached, is the law without; a = 0 is that law in every bit, whatever V₀.
#[test]
fn without_an_effect_it_is_the_law_without() {
    let plain = law(&ROCK.rate_effect(0.0, 1e-6));
    let bare = law(&SuperSubloadingParameters::new(0.4, 0.2, 100.0).kappa(10.0).xi(0.002).alpha_t(ALPHA_T));
    let small = law(&ROCK.rate_effect(1e-9, 1e-3));
    let never = law(&ROCK.rate_effect(0.01, 1e9));
    let mut random = Random(11);
    let mut states = [&plain, &bare, &small, &never].map(|law| law.initial_state(PRESSURE, 0.0));
    for k in 0..80 {
        let slip = 0.01 * (random.unit() - if k % 20 < 14 { 0.2 } else { 0.8 });
        let sliding = Sliding::new(slip, PRESSURE * random.between(0.8, 1.2), random.between(0.1, 3.0));
        let answers = [&plain, &bare, &small, &never].map(|law| law as &dyn FrictionLaw);
        let found: Vec<FrictionResponse> =
            answers.iter().zip(&states).map(|(law, state)| respond(*law, state, sliding)).collect();
        assert_eq!(found[0], found[1]);
        for other in [2, 3] {
            let apart = (found[other].state.traction - found[1].state.traction).abs();
            assert!(apart < 1e-5, "{other} at {k}: {apart:e}");
        }
        states = [0, 1, 2, 3].map(|i| found[i].state.clone());
    }
}

/// What a record asks of the law: it relaxes in a hold, peaks when slip goes on, the more the longer the hold.
#[test]
fn holds_relax_and_heal() {
    let law = law(&ROCK);
    let sliding = slid(&law, law.initial_state(PRESSURE, 1.0), 1e-3, 1000.0, 100);
    let peak = |hold: f64| {
        let mut state = slid(&law, sliding.clone(), 0.0, hold, 20);
        assert!(state.traction < sliding.traction, "the traction relaxes in the hold");
        let mut most = 0.0f64;
        for _ in 0..200 {
            state = respond(&law, &state, Sliding::new(1e-3, PRESSURE, 1.0)).state;
            most = most.max(state.traction / PRESSURE);
        }
        most
    };
    let peaks = [10.0, 100.0, 1000.0].map(peak);
    assert!(peaks[0] < peaks[1] && peaks[1] < peaks[2], "{peaks:?}");
}

/// Against negative slip all is mirrored, and reversals, openings and times of no length are answered.
#[test]
fn all_kinds_of_increments_are_answered_with_their_tangent() {
    let variants = [
        ROCK,
        ROCK.exponents(1.4, 0.7).elastic_core(0.2),
        ROCK.approach(Approach::Cotangent).rate_effect(0.1, 1e-3),
        ROCK.integration(Integration::BackwardEuler),
        ROCK.alpha_t(20.0),
    ];
    let (mut random, mut checked) = (Random(5), 0);
    for parameters in variants {
        let law = law(&fine(parameters));
        let mut state = law.initial_state(PRESSURE, 0.0);
        for k in 0..60 {
            let slip = 0.02 * (random.unit() - if k % 20 < 14 { 0.2 } else { 0.9 });
            let dt = if k % 11 == 5 { 0.0 } else { random.magnitude(-3.0, 3.0) };
            let pressure = if k == 33 { -1.0 } else { PRESSURE * random.between(0.5, 1.5) };
            let at = |slip: f64, pressure: f64| respond(&law, &state, Sliding::new(slip, pressure, dt));
            let answer = at(slip, pressure);
            let mirror = with!(state.clone(), traction: -state.traction, plastic_slip: -state.plastic_slip);
            let mirrored = respond(&law, &mirror, Sliding::new(-slip, pressure, dt));
            assert_eq!(mirrored.state.traction, -answer.state.traction);
            let (du, dp) = (1e-9, 1e-6 * PRESSURE);
            let [left, right] = [at(slip - du, pressure), at(slip + du, pressure)];
            let [low, high] = [at(slip, pressure - dp), at(slip, pressure + dp)];
            // Where the number of sub-steps changes in between, the answers differ by their errors.
            let same =
                [&left, &right, &low, &high].iter().all(|other| other.evaluations.abs_diff(answer.evaluations) < 3);
            if same && pressure > 0.0 {
                checked += 1;
                let by_slip = (right.state.traction - left.state.traction) / (2.0 * du);
                let by_pressure = (high.state.traction - low.state.traction) / (2.0 * dp);
                let what = format!("{parameters:?} at {k}: {slip} {pressure} {dt}");
                let stiffness = parameters.alpha_t.unwrap();
                assert!(
                    (answer.dtraction_dslip - by_slip).abs() < 2e-3 * stiffness,
                    "{what}: {} {by_slip}",
                    answer.dtraction_dslip
                );
                assert!(
                    (answer.dtraction_dpressure - by_pressure).abs() < 2e-3,
                    "{what}: {} {by_pressure}",
                    answer.dtraction_dpressure
                );
            }
            let new = &answer.state;
            assert!(new.dissipation >= state.dissipation - 1e-12 && new.traction * new.plastic_increment >= 0.0);
            assert!((0.0..=1.0).contains(&law.observe("R", new).unwrap()));
            state = answer.state;
        }
    }
    assert!(checked > 150, "{checked}");
}

/// With the tolerance at which differences can tell a tangent, where there is one.
fn fine(parameters: SuperSubloadingParameters) -> SuperSubloadingParameters {
    match parameters.integration {
        Integration::Controlled => parameters.tolerance(1e-7),
        _ => parameters,
    }
}

/// Against central differences of whole paths, by every parameter.
#[test]
fn sensitivities_are_those_of_differences() {
    let base = ROCK.tolerance(1e-8).structure(1.8).rate_effect(0.02, 1e-4).elastic_core(0.1);
    let with = |name: &str, by: f64| {
        let parameters = fecontact::laws::friction::FrictionParameters::from(base);
        let mut given = serde_json::to_value(&parameters).unwrap();
        given[name] = serde_json::json!(given[name].as_f64().unwrap() * (1.0 + by));
        serde_json::from_value::<fecontact::laws::friction::FrictionParameters>(given).unwrap().build(1.0).unwrap()
    };
    let mut random = Random(3);
    let mut increments: Vec<Sliding> = (0..30)
        .map(|k| {
            let slip = if k == 14 { 0.0 } else { 0.01 * (random.unit() - if k % 15 < 11 { 0.1 } else { 0.9 }) };
            Sliding::new(slip, random.between(0.97, 1.03) * PRESSURE, random.between(0.1, 2.0))
        })
        .collect();
    increments[20].pressure = -1.0;
    let tractions = |law: &dyn FrictionLaw| -> Vec<f64> {
        let mut state = law.initial_state(PRESSURE, 0.5);
        increments
            .iter()
            .map(|sliding| {
                state = respond(law, &state, *sliding).state;
                state.traction
            })
            .collect()
    };
    let law = with("a", 0.0);
    let sensitive = law.sensitivities().unwrap();
    assert_eq!(sensitive.parameters().len(), 12);
    for name in sensitive.parameters() {
        let (mut old, mut state) = (law.initial_state(PRESSURE, 0.5), sensitive.start(name));
        let mut exact = Vec::new();
        for sliding in &increments {
            let along = with!(Direction::default(), state: state.clone(), parameter: Some(*name));
            let other = with!(Direction::default(), state: Variation::default(), slip: 1.0);
            let [by, tangent] = sensitive.vary(&old, *sliding, [along, other]).unwrap();
            let answer = respond(&*law, &old, *sliding);
            assert!((tangent.traction - answer.dtraction_dslip).abs() < 1e-6 * ALPHA_T);
            (state, old) = (by, answer.state);
            exact.push(state.traction);
        }
        let h = 1e-3;
        let (above, below) = (tractions(&*with(name, h)), tractions(&*with(name, -h)));
        let value = serde_json::to_value(base).unwrap()[*name].as_f64().unwrap();
        let largest = exact.iter().map(|by| by.abs()).fold(0.0, f64::max);
        assert!(largest > 0.0, "{name}");
        for (i, by) in exact.iter().enumerate() {
            let error = by - (above[i] - below[i]) / (2.0 * h * value);
            assert!(error.abs() <= 3e-3 * largest, "by {name} at {i}: {error:e} of {largest:e}");
        }
    }
    let without = SuperSubloading::new(&ROCK.rate_effect(0.0, 1e-6), 1.0).unwrap();
    assert_eq!(without.sensitivities().unwrap().parameters().len(), 10);
}

/// ∫ (1/R* − 1) dλ, by which surfaces dilate with their structure: of one increment as of many, with its derivatives.
#[test]
fn slip_is_weighed_by_the_structure() {
    let law = law(&ROCK);
    let start = law.initial_state(PRESSURE, 0.5);
    let at = |slip: f64, pressure: f64| {
        law.structured_slip(&start, Sliding::new(slip, pressure, 10.0)).expect("structure").expect("an answer")
    };
    let [found, by_slip, by_pressure] = at(0.02, 5.5);
    let (mut state, mut sum) = (start.clone(), 0.0);
    for k in 1..=1000 {
        let share = f64::from(k) / 1000.0;
        let next = respond(&law, &state, Sliding::new(2e-5, PRESSURE + 0.5 * share, 0.01)).state;
        let mean = 0.5 * (state.variables[0] + next.variables[0]);
        sum += next.plastic_increment * (mean / 0.2 - 1.0);
        state = next;
    }
    assert!((found - sum).abs() < 2e-8, "{found} {sum}");
    let difference = |above: [f64; 3], below: [f64; 3], step: f64| (above[0] - below[0]) / (2.0 * step);
    assert!((by_slip - difference(at(0.02 + 1e-7, 5.5), at(0.02 - 1e-7, 5.5), 1e-7)).abs() < 1e-6);
    assert!((by_pressure - difference(at(0.02, 5.5 + 1e-5), at(0.02, 5.5 - 1e-5), 1e-5)).abs() < 1e-8);
}

#[test]
fn bad_parameters_are_refused() {
    let refused = |parameters: SuperSubloadingParameters| {
        SuperSubloading::new(&parameters, 1.0).expect_err("refused").to_string()
    };
    assert_eq!(refused(ROCK.rate_effect(-0.01, 1e-6)), "\"a\" is -0.01, but it must be zero or positive, and finite");
    assert_eq!(refused(ROCK.rate_effect(0.01, 0.0)), "\"V_0\" is 0, but it must be positive and finite");
    let missing = with!(ROCK, reference_rate: None);
    assert_eq!(
        refused(missing),
        "\"a\" is 0.01, but \"V_0\", the slip rate above which it grows, is missing: give it as well"
    );
}
