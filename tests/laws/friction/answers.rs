//! Answers of the super/subloading law: tangents, random and absurd increments, the uniqueness limit.

use super::*;

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
