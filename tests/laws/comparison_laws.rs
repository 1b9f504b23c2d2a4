//! Slip weakening and rate-and-state friction alone: tangents, closed forms, differential equations.

mod slip_weakening;

use super::random::Random;
use crate::strokes::strokes;
use fecontact::laws::friction::{
    FrictionLaw, FrictionResponse, FrictionState, PointLoad, PrescribedSlip, PrescribedSlipParameters, RateAndState,
    RateAndStateParameters, STEEPEST, Sliding, SlipWeakening, SlipWeakeningParameters, StateEvolution,
};

/// μ, the one variable of slip weakening.
fn mu_of(law: &SlipWeakening, state: &FrictionState) -> f64 {
    law.observe("mu", state).expect("it has one")
}

/// ψ of rate-and-state friction.
fn psi_of(law: &RateAndState, state: &FrictionState) -> f64 {
    law.observe("mu", state).expect("it is shown")
}

/// θ of [`RATE_AND_STATE`] for a ψ.
fn with_psi(psi: f64) -> FrictionState {
    FrictionState::default().with_variables([10.0 * ((psi - 0.6) / 0.015).exp()])
}

const WEAKENING: SlipWeakeningParameters = SlipWeakeningParameters::new(0.6, 0.5, 1.0).alpha_t(1000.0);

/// Laboratory values, in micrometres, seconds and megapascals.
const RATE_AND_STATE: RateAndStateParameters =
    RateAndStateParameters::new(0.6, 1.0, 0.010, 0.015, 10.0).evolution(StateEvolution::Ageing).alpha_t(0.5);

/// [`RATE_AND_STATE`] with a second state over a fifth of the slip, of either sign.
const TWO_STATES: [RateAndStateParameters; 2] = [RATE_AND_STATE.second(0.004, 2.0), RATE_AND_STATE.second(-0.004, 2.0)];

fn weakening(parameters: SlipWeakeningParameters) -> SlipWeakening {
    SlipWeakening::new(&parameters, f64::NAN).expect("valid parameters")
}

fn rate_and_state(parameters: RateAndStateParameters) -> RateAndState {
    RateAndState::new(&parameters, f64::NAN).expect("valid parameters")
}

fn respond(law: &dyn FrictionLaw, old: &FrictionState, slip: f64, pressure: f64, dt: f64) -> FrictionResponse {
    law.respond(old, Sliding::new(slip, pressure, dt)).expect("a finite increment is answered")
}

fn assert_close(actual: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((actual - expected).abs() <= tolerance, "{what}: {actual} instead of {expected} ± {tolerance:e}");
}

/// Compare both tangents with central differences, where the answer is smooth: both one-sided differences agree.
fn check_tangents(law: &dyn FrictionLaw, old: &FrictionState, slip: f64, pressure: f64, dt: f64) -> bool {
    let at = |slip: f64, pressure: f64| respond(law, old, slip, pressure, dt).state.traction;
    let response = respond(law, old, slip, pressure, dt);
    let here = response.state.traction;
    // A tenth of the slip that the contact spring needs for the traction, or as much as there is.
    let h = 1e-5 * (here.abs() / law.description().stiffness + slip.abs());
    let mut smooth = true;
    for (tangent, scale, up, down, h) in [
        (response.dtraction_dslip, law.description().stiffness, at(slip + h, pressure), at(slip - h, pressure), h),
        (
            response.dtraction_dpressure,
            1.0,
            at(slip, pressure * (1.0 + 1e-6)),
            at(slip, pressure * (1.0 - 1e-6)),
            1e-6 * pressure,
        ),
    ] {
        let scale = scale.max(tangent.abs());
        if ((up - here) - (here - down)).abs() > 2e-4 * scale * h {
            smooth = false;
            continue;
        }
        let difference = (up - down) / (2.0 * h);
        assert_close(tangent, difference, 1e-4 * scale, &format!("{old:?} {slip} {pressure} {dt} {law:?}: tangent"));
    }
    smooth
}

// Slip weakening

/// α_t D_c/b: below it no slip, however fast, weakens faster than the contact gives way.
#[test]
fn rate_and_state_has_one_answer_below_a_pressure() {
    let law = rate_and_state(RATE_AND_STATE.alpha_t(5.0));
    let RateAndStateParameters { b, critical_slip, .. } = RATE_AND_STATE;
    assert_close(law.description().uniqueness_limit().expect("a limit"), 5.0 * critical_slip / b, 1e-12, "limit");
}

// Rate and state

/// The work of slip to and fro, in increments that hold the reversals, against that of many small ones: what is dissipated
/// tends to ∮ q du at the first order of the method, and is right to a hundredth where a stroke has twenty increments.
#[test]
fn rate_and_state_dissipates_the_work_of_slip_to_and_fro() {
    for evolution in [StateEvolution::Ageing, StateEvolution::Slip] {
        let law = rate_and_state(RATE_AND_STATE.evolution(evolution).alpha_t(5.0));
        let loops = |parts: u32| {
            let (mut old, mut work) = (with!(law.initial_state(0.0, 0.0), pressure: 100.0), 0.0);
            for k in 0..8 * parts {
                let slip = if (k / parts).is_multiple_of(2) { 1.0 } else { -1.0 } * 100.0 / f64::from(parts);
                let new = respond(&law, &old, slip, 100.0, slip.abs()).state;
                assert!(new.dissipation >= old.dissipation);
                work += 0.5 * (old.traction + new.traction) * slip;
                old = new;
            }
            [old.dissipation + 0.1 * old.traction.powi(2), work]
        };
        let [fine, work] = loops(20_000);
        println!("{evolution:?} {fine} {work} {:?}", [1, 2, 5, 10, 20, 40, 80].map(|n| loops(n)[0] / work - 1.0));
        assert_close(fine, work, 2e-4 * work, "energy");
        assert_close(loops(20)[0], work, 1e-2 * work, "energy in 20 increments a stroke");
    }
}

#[test]
fn steady_sliding_has_the_coefficient_of_its_rate() {
    for evolution in [StateEvolution::Ageing, StateEvolution::Slip] {
        for rate in [1e-6, 1e-2, 1.0, 50.0, 1e4] {
            let law = rate_and_state(RATE_AND_STATE.evolution(evolution));
            let mut state = law.initial_state(0.0, 0.0);
            for _ in 0..3000 {
                state = respond(&law, &state, 0.5, 100.0, 0.5 / rate).state;
            }
            // a arsinh(V/(2V₀) e^{ψ/a}) = ψ + a ln(V/V₀) to 1e-50, with ψ = f₀ − b ln(V/V₀).
            let steady = 100.0 * (0.6 + (0.010 - 0.015) * f64::ln(rate));
            assert_close(state.traction, steady, 1e-6 * steady, &format!("{evolution:?} at {rate}"));
        }
    }
}

#[test]
fn a_jump_of_the_rate_acts_directly_and_then_by_the_state() {
    // A stiff contact, so that the plastic slip follows the total: the jump is a ln 10, then −b ln 10 decays over D_c.
    for p in [RATE_AND_STATE, TWO_STATES[0], TWO_STATES[1]] {
        let law = rate_and_state(p.alpha_t(1e6).evolution(StateEvolution::Slip));
        let mut state = law.initial_state(0.0, 0.0);
        for _ in 0..10 {
            state = respond(&law, &state, 1.0, 100.0, 1.0).state;
        }
        assert_close(state.traction, 60.0, 1e-5, "steady at V₀");
        let mut slipped = 0.0;
        for _ in 0..3000 {
            state = respond(&law, &state, 0.01, 100.0, 0.001).state;
            slipped += 0.01;
            // Slip law at constant V: the part b ln(V/V₀) of a state decays as exp(−D/D_c), each over its own D_c.
            let decayed = |b: f64, length: f64| b * (1.0 - f64::exp(-slipped / length));
            let second = decayed(p.b_2.unwrap_or(0.0), p.critical_slip_2.unwrap_or(1.0));
            let expected = 60.0 + 100.0 * 10f64.ln() * (0.010 - decayed(0.015, 10.0) - second);
            if slipped > 0.05 {
                assert_close(state.traction, expected, 2e-4, &format!("after {slipped}"));
            }
        }
    }
}

/// A second state without effect changes no bit of increments and slip rates; along records it is integrated as accurately as the first,
/// by sub-steps that may be shorter.
#[test]
fn a_second_state_without_effect_changes_nothing() {
    let mut random = Random(8);
    for evolution in [StateEvolution::Ageing, StateEvolution::Slip] {
        let laws = [RATE_AND_STATE, RATE_AND_STATE.second(0.0, 2.0)].map(|p| rate_and_state(p.evolution(evolution)));
        let controlled = [0, 1].map(|k| laws[k].controlled().expect("it is controlled"));
        let mut states = laws.each_ref().map(|law| law.initial_state(100.0, 50.0));
        for k in 0..300 {
            let slip = random.between(-2.0, 8.0);
            let sliding = Sliding::new(slip, random.between(50.0, 120.0), 10f64.powf(random.between(-3.0, 2.0)));
            let [one, two] = [0, 1].map(|of| laws[of].respond(&states[of], sliding).expect("an answer"));
            let along = [0, 1].map(|of| controlled[of].respond(&states[of], sliding).expect("an answer").state);
            assert_close(along[0].traction, along[1].traction, 2e-6 * 0.6 * 120.0, "along a record");
            let second = two.state.variables[1];
            assert!(second > 0.0, "{second}");
            assert_eq!((one.dtraction_dslip, one.evaluations), (two.dtraction_dslip, two.evaluations), "{k}");
            let point = PointLoad { traction: one.state.traction, pressure: one.state.pressure, damping: 0.1 };
            let [rate, other] = [(0, &one), (1, &two)].map(|(of, answer)| {
                let rates = laws[of].rates().expect("it has rates");
                let x = rates.evolving(&answer.state);
                let rate = rates.slip_rate(x, point);
                (rate, rates.evolution(x, rate)[0], rates.regime(x, rate))
            });
            assert_eq!(rate, other);
            states = [one.state, two.state];
            let theta = states[1].variables[0];
            assert_eq!(states[0], states[1].clone().with_variables([theta]));
        }
    }
}

#[test]
fn two_states_slide_steadily_by_the_sum_of_their_effects() {
    for p in TWO_STATES {
        for evolution in [StateEvolution::Ageing, StateEvolution::Slip] {
            for rate in [1e-6, 1.0, 1e4] {
                let law = rate_and_state(p.evolution(evolution));
                let mut state = law.initial_state(0.0, 0.0);
                for _ in 0..3000 {
                    state = respond(&law, &state, 0.5, 100.0, 0.5 / rate).state;
                }
                let steady = 100.0 * (0.6 + (0.010 - 0.015 - p.b_2.expect("given")) * f64::ln(rate));
                assert_close(state.traction, steady, 1e-6 * steady, &format!("{evolution:?} at {rate}"));
                let [theta, second] = [0, 1].map(|k| state.variables[k]);
                assert_close(theta * rate / 10.0, 1.0, 1e-6, "θ");
                assert_close(second * rate / 2.0, 1.0, 1e-6, "θ₂");
            }
        }
    }
}

#[test]
fn rest_heals_with_the_logarithm_of_time_in_the_ageing_law_only() {
    for (evolution, healed) in
        [(StateEvolution::Ageing, 0.015 * (1e4 / 10.0 + 1.0f64).ln()), (StateEvolution::Slip, 0.0)]
    {
        let law = rate_and_state(RATE_AND_STATE.evolution(evolution));
        let at_rest = respond(&law, &law.initial_state(0.0, 0.0), 0.0, 100.0, 1e4).state;
        assert_close(psi_of(&law, &at_rest), 0.6 + healed, 1e-12, "pressed");
        assert_close(
            psi_of(&law, &respond(&law, &law.initial_state(0.0, 0.0), 0.0, 0.0, 1e4).state),
            0.6 + healed,
            1e-12,
            "parted",
        );
        let quick = with!(law.initial_state(0.0, 0.0), traction: 30.0, pressure: 100.0);
        let now = respond(&law, &quick, 0.1, 100.0, 0.0).state;
        assert_eq!((now.traction, psi_of(&law, &now), now.plastic_slip), (30.05, 0.6, 0.0), "no time, no slip");
    }
}

/// ψ of the law's equations.
fn psi(p: &RateAndStateParameters, [theta, second]: [f64; 2]) -> f64 {
    let (b_2, length) = (p.b_2.unwrap_or(0.0), p.critical_slip_2.unwrap_or(1.0));
    let first = p.b * (p.reference_rate * theta / p.critical_slip).ln();
    p.f_0 + first + b_2 * (p.reference_rate * second / length).ln()
}

/// Rates of (q, θ, θ₂) of the law's equations at the slip rate v of the whole.
fn rates(p: &RateAndStateParameters, pressure: f64, v: f64, [q, theta, second]: [f64; 3]) -> [f64; 3] {
    let psi = psi(p, [theta, second]);
    let slip_rate = 2.0 * p.reference_rate * (q / (p.a * pressure)).sinh() * (-psi / p.a).exp();
    let evolution = |theta: f64, length: f64| {
        let y = slip_rate.abs() * theta / length;
        match p.evolution {
            StateEvolution::Ageing => 1.0 - y,
            _ => -y * y.ln(),
        }
    };
    let second = evolution(second, p.critical_slip_2.unwrap_or(1.0));
    [p.alpha_t.expect("given") * (v - slip_rate), evolution(theta, p.critical_slip), second]
}

#[test]
fn increments_converge_to_the_differential_equations() {
    let laws = [RATE_AND_STATE, with!(RATE_AND_STATE, b: -0.015), TWO_STATES[0], TWO_STATES[1]];
    let all = [StateEvolution::Ageing, StateEvolution::Slip].map(|evolution| laws.map(|p| p.evolution(evolution)));
    for p in all.into_iter().flatten() {
        let law = rate_and_state(p);
        // Slip at V₀, then ten times as fast, then back at a third: 60 s by the method of Runge and Kutta.
        let rate = |t: f64| {
            if t < 20.0 {
                1.0
            } else if t < 30.0 {
                10.0
            } else {
                -3.0
            }
        };
        let mut y = [59.0, 10.0, p.critical_slip_2.unwrap_or(1.0)];
        let h = 1e-4;
        for k in 0..600_000u32 {
            let v = rate((f64::from(k) + 0.5) * h);
            let f = |y: [f64; 3]| rates(&p, 100.0, v, y);
            let step = |y: [f64; 3], k: [f64; 3], s: f64| [0, 1, 2].map(|i| y[i] + s * k[i]);
            let k1 = f(y);
            let k2 = f(step(y, k1, 0.5 * h));
            let k3 = f(step(y, k2, 0.5 * h));
            let k4 = f(step(y, k3, h));
            for i in 0..3 {
                y[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
            }
        }
        let error = |steps: u32| {
            let dt = 60.0 / f64::from(steps);
            let mut state = with!(law.initial_state(0.0, 0.0), traction: 59.0, pressure: 100.0);
            for k in 0..steps {
                state = respond(&law, &state, rate((f64::from(k) + 0.5) * dt) * dt, 100.0, dt).state;
            }
            (state.traction - y[0]).abs() + 100.0 * (psi_of(&law, &state) - psi(&p, [y[1], y[2]])).abs()
        };
        let (coarse, fine) = (error(6000), error(12000));
        assert!(fine < 0.02, "{p:?}: {fine}");
        assert!((1.8..2.2).contains(&(coarse / fine)), "{p:?}: {coarse:e} became {fine:e}");
    }
}

#[test]
fn rate_and_state_tangents_are_exact() {
    let mut random = Random(2);
    let mut smooth = 0;
    for k in 0..4000 {
        let evolution = if k % 2 == 0 { StateEvolution::Ageing } else { StateEvolution::Slip };
        // The weakening b p/D_c is 0.15 at the usual pressure: some contacts are softer than that.
        let alpha_t = Some(10f64.powf(random.between(-1.0, 2.0)));
        let b = [0.015, -0.015][k / 2 % 2];
        let p = [RATE_AND_STATE, TWO_STATES[0], TWO_STATES[1]][k % 3];
        let law = rate_and_state(with!(p.evolution(evolution), alpha_t: alpha_t, b: b));
        let pressure = random.between(1.0, 150.0);
        let psi = random.between(0.5, 0.7);
        let variables = [with_psi(psi).variables[0], p.critical_slip_2.unwrap_or(0.0) * random.between(0.1, 10.0)];
        let old = FrictionState::default().with_variables(variables).loaded(pressure, random.between(-80.0, 80.0));
        let slip = random.between(-40.0, 40.0) / law.description().stiffness;
        let dt = 10f64.powf(random.between(-6.0, 3.0));
        smooth += usize::from(check_tangents(&law, &old, slip, random.between(1.0, 150.0), dt));
    }
    assert!(smooth > 3700, "{smooth}");
}

#[test]
fn answers_meet_their_equations_and_are_the_first_root() {
    let mut random = Random(3);
    let mut most = 0;
    for k in 0..20000 {
        let evolution = if k % 2 == 0 { StateEvolution::Ageing } else { StateEvolution::Slip };
        let alpha_t = 10f64.powf(random.between(-2.0, 3.0));
        let p = [RATE_AND_STATE, RATE_AND_STATE, TWO_STATES[0], TWO_STATES[1]][k / 4 % 4];
        let p = with!(p.evolution(evolution).alpha_t(alpha_t), b: [0.015, -0.015][k / 2 % 2]);
        let law = rate_and_state(p);
        let psi0 = random.between(0.3, 0.8);
        let (b_2, length) = (p.b_2.unwrap_or(0.0), p.critical_slip_2.unwrap_or(2.0));
        let second = length * 10f64.powf(random.between(-4.0, 4.0));
        let variables = [with_psi(psi0).variables[0], if p.b_2.is_some() { second } else { 0.0 }];
        let old = FrictionState::default().with_variables(variables).loaded(100.0, 0.0);
        let dt = 10f64.powf(random.between(-8.0, 6.0));
        let trial = 10f64.powf(random.between(-3.0, 2.5));
        let response = respond(&law, &old, trial / alpha_t, 100.0, dt);
        most = most.max(response.evaluations);
        let FrictionState { traction, plastic_slip, .. } = response.state;
        let mu = psi_of(&law, &response.state);
        assert!((0.0..=trial * (1.0 + 1e-12)).contains(&traction), "{traction} of {trial}");
        assert_close(traction, trial - alpha_t * plastic_slip, 1e-9 * trial, "slip");
        // Evaluated afresh, in logarithms: θ₁ of (4) or (5), q of (2).
        let excess = |slip: f64| {
            let v = slip / dt;
            let after = |log0: f64, length: f64| {
                let x = slip / length;
                match evolution {
                    StateEvolution::Ageing => (log0.exp() * (-x).exp() + dt / length * (1.0 - (-x).exp()) / x).ln(),
                    _ => log0 * (-x).exp() - v.ln() * (1.0 - (-x).exp()),
                }
            };
            let psi = 0.6 + p.b * after((psi0 - 0.6) / 0.015, 10.0) + b_2 * after((second / length).ln(), length);
            let w = (0.5 * v).ln() + psi / 0.01;
            let arsinh = if w > 30.0 { w + 2f64.ln() } else { w.exp().asinh() };
            (trial - alpha_t * slip - 0.01 * 100.0 * arsinh, psi)
        };
        if plastic_slip > 1e-9 * trial / alpha_t && plastic_slip > 1e-6 {
            let (rest, psi) = excess(plastic_slip);
            assert_close(
                rest,
                0.0,
                1e-6 * trial,
                &format!("{evolution:?}, {trial}, {alpha_t}, {dt}, {psi0}: residual"),
            );
            assert_close(mu, psi, 1e-7, "state");
            for part in 1..60 {
                let earlier = plastic_slip * (1.0 - f64::from(part) / 60.0);
                if earlier > 1e-7 {
                    assert!(excess(earlier).0 > -1e-6 * trial, "a root before the answer: {earlier} of {plastic_slip}");
                }
            }
        }
    }
    assert!(most < 100, "{most} evaluations");
}

#[test]
fn parameters_out_of_range_are_named() {
    for (parameters, name) in [
        (with!(RATE_AND_STATE, f_0: 0.0), "f_0"),
        (with!(RATE_AND_STATE, reference_rate: 0.0), "V_0"),
        (with!(RATE_AND_STATE, a: 0.0), "a"),
        (with!(RATE_AND_STATE, b: f64::INFINITY), "b"),
        (with!(RATE_AND_STATE, critical_slip: f64::NAN), "D_c"),
        (RATE_AND_STATE.theta(0.0), "theta"),
        (RATE_AND_STATE.second(f64::NAN, 1.0), "b_2"),
        (RATE_AND_STATE.second(0.01, 0.0), "D_c2"),
        (with!(RATE_AND_STATE, b_2: Some(0.01)), "D_c2"),
        (with!(RATE_AND_STATE, critical_slip_2: Some(0.01)), "D_c2"),
        (RATE_AND_STATE.theta_2(1.0), "theta_2"),
        (RATE_AND_STATE.second(0.01, 1.0).theta_2(-1.0), "theta_2"),
        (RATE_AND_STATE.alpha_t(-1.0), "alpha_t"),
    ] {
        assert_eq!(RateAndState::new(&parameters, 1.0).expect_err("refused").name, name);
    }
    for (parameters, name) in [
        (with!(WEAKENING, mu_d: 0.0), "mu_d"),
        (with!(WEAKENING, mu_s: 0.4), "mu_s"),
        (with!(WEAKENING, critical_slip: 0.0), "D_c"),
        (WEAKENING.cohesion(-1.0), "cohesion"),
        (WEAKENING.alpha_t(0.0), "alpha_t"),
    ] {
        assert_eq!(SlipWeakening::new(&parameters, 1.0).expect_err("refused").name, name);
    }
}

#[test]
fn no_increment_panics_or_is_not_a_number() {
    let mut random = Random(4);
    let magnitude = |random: &mut Random, low, high| 10f64.powf(random.between(low, high));
    for k in 0..100_000 {
        let law: Box<dyn FrictionLaw> = match k % 3 {
            0 => Box::new(weakening(with!(
                WEAKENING,
                critical_slip: magnitude(&mut random, -9.0, 3.0),
                alpha_t: Some(magnitude(&mut random, -3.0, 12.0)),
            ))),
            _ => Box::new(rate_and_state(with!(
                RATE_AND_STATE,
                a: magnitude(&mut random, -6.0, 0.0),
                b: [0.0, 1.0, -1.0, 1.0, 1.0, 1.0, -1.0][k % 7] * magnitude(&mut random, -6.0, 0.0),
                b_2: [None, Some([0.0, 1.0, -1.0][k / 2 % 3] * magnitude(&mut random, -6.0, 0.0))][k / 7 % 2],
                critical_slip_2: [None, Some(magnitude(&mut random, -9.0, 3.0))][k / 7 % 2],
                critical_slip: magnitude(&mut random, -9.0, 3.0),
                reference_rate: magnitude(&mut random, -9.0, 3.0),
                evolution: if k % 3 == 1 { StateEvolution::Ageing } else { StateEvolution::Slip },
                alpha_t: Some(magnitude(&mut random, -3.0, 12.0)),
            ))),
        };
        let mut state = law.initial_state(0.0, 0.0);
        for _ in 0..4 {
            let sign = if random.unit() < 0.5 { -1.0 } else { 1.0 };
            let slip = sign * magnitude(&mut random, -12.0, 3.0);
            let pressure = if random.unit() < 0.1 { 0.0 } else { magnitude(&mut random, -6.0, 9.0) };
            let dt = if random.unit() < 0.1 { 0.0 } else { magnitude(&mut random, -12.0, 12.0) };
            let answer = respond(&*law, &state, slip, pressure, dt);
            let new = answer.state;
            assert!(new.dissipation >= state.dissipation && new.traction * slip.signum() * 0.0 == 0.0);
            assert!(answer.dtraction_dslip.abs() <= STEEPEST * law.description().stiffness);
            assert!(answer.dtraction_dpressure.abs() <= STEEPEST);
            assert!(answer.evaluations < 200, "{} evaluations", answer.evaluations);
            state = new;
        }
    }
}

/// The slip rate that follows from traction and state is the V of |q| = a p arsinh(V/(2 V₀) exp(ψ/a)), τ = q + η V, over forty
/// decades and for both signs; its state evolves as θ̇ = 1 − V θ/D_c, or as −(V θ/D_c) ln(V θ/D_c).
#[test]
fn the_slip_rate_follows_from_traction_and_state() {
    let mut random = Random(5);
    for k in 0..4000 {
        let evolution = [StateEvolution::Ageing, StateEvolution::Slip][k % 2];
        let b = [0.015, -0.015][k / 4 % 2];
        let p = [RATE_AND_STATE, TWO_STATES[0], TWO_STATES[1]][k % 3];
        let parameters = with!(p.evolution(evolution), a: 0.003 + 0.03 * random.unit(), b: b);
        let law = rate_and_state(parameters);
        let rates = law.rates().expect("it has rates");
        let RateAndStateParameters { f_0, reference_rate, a, b, b_2, critical_slip, critical_slip_2, .. } = parameters;
        let rate = 10f64.powf(-30.0 + 40.0 * random.unit()) * [1.0, -1.0][k / 2 % 2];
        let x = -10.0 + 50.0 * random.unit();
        let (pressure, damping) = (0.1 + 100.0 * random.unit(), 10f64.powf(-6.0 + 8.0 * random.unit()));
        let x = [x, if b_2.is_some() { 20.0 * random.unit() } else { 0.0 }];
        let psi = f_0 + b * x[0] + b_2.unwrap_or(0.0) * x[1];
        let log = (rate.abs() / (2.0 * reference_rate)).ln() + psi / a;
        let arsinh = if log > 20.0 { log + std::f64::consts::LN_2 } else { log.exp().asinh() };
        let traction = rate.signum() * a * pressure * arsinh + damping * rate;
        let found = rates.slip_rate(x, PointLoad { traction, pressure, damping });
        // Round-off of τ is that of its larger part, and friction makes an error of arsinh times its size of it.
        let allowed = 1e-13 * (1.0 + arsinh + psi.abs() / a) * (1.0 + damping * rate.abs() / (a * pressure));
        assert_close(found / rate, 1.0, allowed.min(1e-6), &format!("V = {rate:e}, x = {x:?}, a = {a}"));
        let state = rates.remember(x, FrictionState::default());
        let lengths = std::iter::once(critical_slip).chain(critical_slip_2);
        for (i, critical_slip) in lengths.enumerate() {
            let theta = critical_slip / reference_rate * x[i].exp();
            let slid = rate.abs() * theta / critical_slip;
            let expected = match evolution {
                StateEvolution::Ageing => (1.0 - slid) / theta,
                _ => -slid * slid.ln() / theta,
            };
            let size = (1.0 + slid * (1.0 + slid.ln().abs())) / theta;
            assert_close(rates.evolution(x, rate)[i] / size, expected / size, 1e-12, "evolution");
            assert_close(state.variables[i] / theta, 1.0, 1e-12, "θ");
            assert_close(rates.evolving(&state)[i], x[i], 1e-12 * x[i].abs(), "x");
        }
    }
}

/// Prescribed slip: q follows the elastic slip, with that tangent, and its work is that of the mean traction.
#[test]
fn prescribed_slip_is_slip_at_its_rate() {
    let parameters = PrescribedSlipParameters::new(-0.3).alpha_t(50.0);
    let law = PrescribedSlip::new(&parameters, f64::NAN).expect("valid parameters");
    let old = with!(FrictionState::default(), traction: 2.0, pressure: 1.0, plastic_slip: 0.5);
    let answer = respond(&law, &old, 0.1, 4.0, 0.5);
    // 2 + 50 (0.1 + 0.15), and −0.15 (2 + 14.5)/2
    assert_close(answer.state.traction, 14.5, 1e-13, "q");
    assert_close(answer.state.plastic_slip, 0.35, 1e-15, "slip");
    assert_close(answer.state.dissipation, -0.15 * 8.25, 1e-14, "work");
    let [up, down] = [0.1 + 1e-5, 0.1 - 1e-5].map(|slip| respond(&law, &old, slip, 4.0, 0.5).state.traction);
    assert_close(answer.dtraction_dslip, (up - down) / 2e-5, 1e-8, "∂q/∂Δu_t");
    assert_eq!(answer.dtraction_dpressure, 0.0);
    assert_eq!(respond(&law, &old, 0.1, 0.0, 0.5).state.traction, 0.0, "once parted");
}

/// Numbers from below the smallest to beyond the largest, and none at all: an answer is finite, and every search ends.
#[test]
fn absurd_increments_of_rate_and_state_are_answered_or_refused() {
    let numbers = [0.0, 1e-320, 1e-30, 1.0, 1e30, 1e300, f64::MAX, f64::INFINITY, f64::NAN];
    for evolution in [StateEvolution::Ageing, StateEvolution::Slip] {
        let law = rate_and_state(RATE_AND_STATE.evolution(evolution).alpha_t(1e4));
        let mut answered = 0;
        for k in 0..numbers.len().pow(3) {
            let [slip, pressure, dt] = [k % 9, k / 9 % 9, k / 81].map(|k| numbers[k]);
            if let Ok(answer) = law.respond(&law.initial_state(0.0, 0.0), Sliding::new(slip, pressure, dt)) {
                assert!(answer.state.traction.is_finite() && answer.dtraction_dslip.is_finite());
                answered += 1;
            }
        }
        assert!(answered > 50, "{answered}");
    }
}
