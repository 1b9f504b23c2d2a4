//! The super/subloading law under error control: right whatever the increment, with the tangent of what was computed.

use super::random::Random;
use fecontact::laws::friction::sensitivity::{Direction, Variation};
use fecontact::laws::friction::{FrictionLaw, FrictionParameters, FrictionState, Sliding};
use serde_json::{Value, json};

/// μ, the one variable of the super/subloading law.
fn mu_of(state: &FrictionState) -> f64 {
    state.variables[0]
}

const MU_S: f64 = 0.4;
const MU_K: f64 = 0.2;
const ALPHA_T: f64 = 1000.0;
const R: f64 = 100.0;
const PRESSURE: f64 = 98.1;
/// Global error allowed, 1e-6 of μ_s p.
const MICRO: f64 = 1e-6 * MU_S * PRESSURE;

/// The paper's data with other values put in.
fn law(other: Value) -> Box<dyn FrictionLaw> {
    let mut given = json!({"law": "super_subloading", "mu_s": MU_S, "mu_k": MU_K, "alpha_t": ALPHA_T, "r": R});
    given.as_object_mut().unwrap().extend(other.as_object().unwrap().clone());
    serde_json::from_value::<FrictionParameters>(given).unwrap().build(1.0).unwrap()
}

fn pressed(mu: f64, traction: f64) -> FrictionState {
    with!(FrictionState::default().with_variables([mu]), traction: traction, pressure: PRESSURE)
}

/// Follow a polyline of (time, slip, pressure), each stretch in `parts` increments; the states at its corners.
fn follow(law: &dyn FrictionLaw, start: FrictionState, corners: &[[f64; 3]], parts: usize) -> Vec<FrictionState> {
    let mut state = start;
    let mut states = Vec::new();
    for pair in corners.windows(2) {
        let [[t0, u0, p0], [t1, u1, p1]] = [pair[0], pair[1]];
        for k in 1..=parts {
            let share = 1.0 / parts as f64;
            let pressure = p0 + (p1 - p0) * k as f64 * share;
            let sliding = Sliding::new((u1 - u0) * share, pressure, (t1 - t0) * share);
            state = law.respond(&state, sliding).unwrap().state;
        }
        states.push(state.clone());
    }
    states
}

/// −li(R) by Simpson's rule of ∫ dR/(−ln R) from 0, with R = exp(−exp(−y)): no special function needed.
fn minus_li(ratio: f64) -> f64 {
    let (low, high) = (-7.0, -(-ratio.ln()).ln());
    let n = 20_000;
    let h = (high - low) / f64::from(n);
    let f = |y: f64| (-(-y).exp()).exp();
    let sum: f64 = (1..n).map(|k| f(low + h * f64::from(k)) * if k % 2 == 1 { 4.0 } else { 2.0 }).sum();
    h / 3.0 * (f(low) + sum + f(high))
}

/// u(R) = R μ p/α_t − li(R)/r without weakening; with it (ξ = 0, m = 1) μ = μ_k + (μ_s − μ_k) exp(−κ s/μ_k) at the
/// plastic slip s = −li(R)/r.
#[test]
fn closed_forms_hold_for_any_number_of_increments() {
    for kappa in [0.0, 10.0] {
        for ratio in [0.1, 0.5, 0.8711, 0.99, 0.9999] {
            let slip = minus_li(ratio) / R;
            let mu = MU_K + (MU_S - MU_K) * (-kappa * slip / MU_K).exp();
            let traction = ratio * mu * PRESSURE;
            let end = traction / ALPHA_T + slip;
            let law = law(json!({"kappa": kappa}));
            for parts in [1, 2, 3, 10, 100, 1000, 10_000] {
                let path = [[0.0, 0.0, PRESSURE], [1.0, end, PRESSURE]];
                let state = follow(&*law, pressed(MU_S, 0.0), &path, parts)[0].clone();
                let error = (state.traction - traction).abs();
                assert!(error < MICRO, "κ = {kappa}, R = {ratio}, {parts} increments: off by {error:e}");
                let error = (mu_of(&state) - mu).abs() * PRESSURE;
                assert!(error < MICRO, "κ = {kappa}, R = {ratio}, {parts} increments: μ p off by {error:e}");
            }
        }
    }
}

/// Ageing at rest, n = 1: μ = μ_s − (μ_s − μ₀) exp(−ξ t/μ_s).
#[test]
fn ageing_is_exact_in_any_number_of_increments() {
    let law = law(json!({"kappa": 10, "xi": 0.002}));
    for parts in [1, 10, 10_000] {
        let path = [[0.0, 0.0, PRESSURE], [300.0, 0.0, PRESSURE]];
        let mu = mu_of(&follow(&*law, pressed(MU_K, 0.0), &path, parts)[0]);
        let exact = MU_S - (MU_S - MU_K) * (-0.002 * 300.0 / MU_S).exp();
        assert!((mu - exact).abs() * PRESSURE < MICRO, "{parts} increments: {mu}, expected {exact}");
    }
}

/// u = sin t from sliding, on the polyline through its values every Δt: the answer at the corners is that of the same
/// polyline in increments of 1e-5.
#[test]
fn forced_oscillation_is_right_on_its_polyline_at_any_increment() {
    let law = law(json!({"kappa": 10, "xi": 0.002}));
    for dt in [1e-3, 1e-2, 0.1, 0.3] {
        let corners: Vec<_> =
            (0..=(10.0 / dt) as usize).map(|k| k as f64 * dt).map(|t| [t, t.sin(), PRESSURE]).collect();
        let start = pressed(MU_K, MU_K * PRESSURE);
        let coarse = follow(&*law, start.clone(), &corners, 1);
        let fine = follow(&*law, start, &corners, (dt / 1e-5).round() as usize);
        for (k, (coarse, fine)) in coarse.iter().zip(&fine).enumerate() {
            let error = (coarse.traction - fine.traction).abs();
            assert!(error < 1e-3 * MU_K * PRESSURE, "Δt = {dt}, corner {k}: {} {}", coarse.traction, fine.traction);
            assert!(coarse.dissipation >= 0.0 && fine.dissipation >= 0.0);
        }
    }
}

/// One increment of backward Euler takes at most twelve evaluations of its equation, whatever its length.
#[test]
fn backward_euler_needs_few_evaluations() {
    let law = law(json!({"kappa": 10, "xi": 0.002, "integration": "backward_euler"}));
    for dt in [1e-5, 1e-3, 1e-2, 0.1, 0.3] {
        let mut state = pressed(MU_K, MU_K * PRESSURE);
        let mut most = 0;
        for k in 0..(7.0 / dt) as usize {
            let [a, b] = [k, k + 1].map(|k| (k as f64 * dt).sin());
            let answer = law.respond(&state, Sliding::new(b - a, PRESSURE, dt)).unwrap();
            most = most.max(answer.evaluations);
            state = answer.state;
        }
        assert!((1..=12).contains(&most), "Δt = {dt}: {most} evaluations");
    }
}

/// q, μ and ∫ |q| dλ by Runge–Kutta of fourth order on the rate form: λ = ⟨α_t s v − ξ R (1 − μ/μ_s)^n p − R μ ṗ⟩/den,
/// s = sgn q, den = α_t + p (r (−ln R) μ − κ R (μ/μ_k − 1)^m).
fn rate_form(
    [kappa, xi, m, n]: [f64; 4],
    start: FrictionState,
    from: [f64; 3],
    to: [f64; 3],
    steps: usize,
) -> [f64; 3] {
    let time = to[0] - from[0];
    let (v, dp) = ((to[1] - from[1]) / time, (to[2] - from[2]) / time);
    let rate = |t: f64, [q, mu, _]: [f64; 3]| {
        let p = from[2] + dp * t;
        let s = if q == 0.0 { v.signum() } else { q.signum() };
        let ratio = (q.abs() / (mu * p)).clamp(1e-300, 1.0);
        let loss = kappa * (mu / MU_K - 1.0).max(0.0).powf(m);
        let gain = xi * (1.0 - mu / MU_S).max(0.0).powf(n);
        let den = ALPHA_T + p * (-R * ratio.ln() * mu - ratio * loss);
        let slip = ((ALPHA_T * s * v - gain * ratio * p - ratio * mu * dp) / den).max(0.0);
        [ALPHA_T * (v - slip * s), gain - loss * slip, q.abs() * slip]
    };
    let h = time / steps as f64;
    let mut y = [start.traction, mu_of(&start), 0.0];
    for k in 0..steps {
        let t = k as f64 * h;
        let shifted = |slope: [f64; 3], share: f64| [0, 1, 2].map(|i| y[i] + share * h * slope[i]);
        let k1 = rate(t, y);
        let k2 = rate(t + 0.5 * h, shifted(k1, 0.5));
        let k3 = rate(t + 0.5 * h, shifted(k2, 0.5));
        let k4 = rate(t + h, shifted(k3, 1.0));
        y = [0, 1, 2].map(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    }
    y
}

/// Weakening and ageing together, pressure that rises and falls, loading that turns into unloading within an increment,
/// exponents other than 1: one increment each, against the rate equations in two hundred thousand steps.
#[test]
fn one_increment_is_right_to_the_tolerance() {
    for (numbers, start, to) in [
        ([10.0, 0.002, 1.0, 1.0], pressed(0.3, 5.0), [10.0, 0.05, PRESSURE]),
        ([10.0, 0.02, 1.0, 1.0], pressed(0.25, 15.0), [100.0, 0.2, 150.0]),
        ([10.0, 0.02, 1.0, 1.0], pressed(0.25, 15.0), [10.0, 0.02, 60.0]),
        ([5.0, 0.01, 1.5, 2.0], pressed(0.35, 20.0), [20.0, 0.1, 90.0]),
        ([5.0, 0.01, 0.7, 0.8], pressed(0.3, -10.0), [20.0, 0.1, 98.1]),
        ([10.0, 0.05, 1.0, 1.0], pressed(0.22, 21.0), [50.0, 0.003, 98.1]),
        ([0.0, 0.0, 1.0, 1.0], pressed(0.3, 20.0), [1.0, 0.01, 160.0]),
    ] {
        let [kappa, xi, m, n] = numbers;
        let law = law(json!({"kappa": kappa, "xi": xi, "m": m, "n": n}));
        let sliding = Sliding::new(to[1], to[2], to[0]);
        let state = law.respond(&start, sliding).unwrap().state;
        let [q, mu, work] = rate_form(numbers, start, [0.0, 0.0, PRESSURE], to, 200_000);
        let allowed = 5.0 * 1e-6 * MU_S * to[2].max(PRESSURE);
        assert!((state.traction - q).abs() < allowed, "{numbers:?}: q = {}, expected {q}", state.traction);
        assert!((mu_of(&state) - mu).abs() * PRESSURE < allowed, "{numbers:?}: μ = {}, expected {mu}", mu_of(&state));
        assert!((state.dissipation - work).abs() < 1e-4 * work.max(1e-3), "{numbers:?}: {} {work}", state.dissipation);
    }
}

/// Short increments are answered by one step alone where a bound of its error allows: against the rate equations, q and μ p
/// to a hundredth of the tolerance and the mean of q to the tolerance, over states, slips, times and pressures of all sizes.
#[test]
fn steps_taken_alone_are_right_to_their_bounds() {
    let mut random = Random(7);
    let mut alone = 0;
    let mut worst = [0.0f64; 3];
    for _ in 0..20_000 {
        let kappa = if random.chance(0.1) { 0.0 } else { random.magnitude(-2.0, 0.9) };
        let xi = if random.chance(0.1) { 0.0 } else { random.magnitude(-4.0, 2.0) };
        let mu = random.between(MU_K, MU_S);
        let start = pressed(mu, random.between(0.02, 1.0).powf(0.3) * mu * PRESSURE);
        let slip = random.magnitude(-8.0, -2.0);
        let pressure = PRESSURE * (1.0 + if random.chance(0.5) { 0.0 } else { random.between(-1e-3, 1e-3) });
        let sliding = Sliding::new(slip, pressure, random.magnitude(-7.0, -1.0));
        let law = law(json!({"kappa": kappa, "xi": xi}));
        let answer = law.respond(&start, sliding).unwrap();
        if !(1..=2).contains(&answer.evaluations) {
            continue; // a whole and two halves take three at least
        }
        alone += 1;
        let numbers = [kappa, xi, 1.0, 1.0];
        let [q, mu, work] = rate_form(numbers, start, [0.0, 0.0, PRESSURE], [sliding.dt, slip, pressure], 400);
        let state = answer.state;
        let noise = 1e-12 * PRESSURE;
        let errors = [
            ((state.traction - q).abs() - noise) / (1e-8 * MU_S * PRESSURE),
            ((mu_of(&state) - mu).abs() * PRESSURE - noise) / (1e-8 * MU_S * PRESSURE),
            ((state.dissipation - work).abs() - noise * slip)
                / (1e-6 * MU_S * PRESSURE * (slip + state.plastic_increment)),
        ];
        worst = [0, 1, 2].map(|i| worst[i].max(errors[i]));
    }
    println!("{alone} steps alone, errors up to {worst:.2?} of their bounds");
    assert!(alone > 5000, "{alone}");
    assert!(worst.iter().all(|error| *error < 1.05), "{worst:?}");
}

/// Increments under changing pressure in which slip is steady, begins, ends or rests, of which many are answered by a whole and
/// two halves: q, μ p and the work of q against the rate equations, to twice the tolerance; near full sliding under a pressure
/// that hardly changes, and anywhere while contact closes or opens. There, in one of a thousand, the work of whole and halves may
/// agree by chance.
#[test]
fn increments_of_all_kinds_are_right_to_the_tolerance() {
    let mut random = Random(11);
    let mut worst = [[0.0f64; 3]; 2];
    let (mut compared, mut by_chance) = ([0; 2], 0);
    for i in 0..20_000 {
        let kind = i % 2;
        let (kappa, xi) = (random.magnitude(-1.0, 0.9), random.magnitude(-3.0, 0.5));
        let mu = random.between(MU_K, MU_S);
        let [ratio, old_pressure, pressure] = match kind {
            0 => [random.between(0.9, 1.0), PRESSURE, PRESSURE * random.between(0.95, 1.05)],
            _ => [random.unit(), PRESSURE * random.magnitude(-2.0, 0.0), PRESSURE * random.magnitude(-2.0, 0.0)],
        };
        let start = with!(pressed(mu, ratio * mu * old_pressure), pressure: old_pressure);
        let slip = random.magnitude(-4.0, -2.0);
        let sliding = Sliding::new(slip, pressure, random.magnitude(-3.0, 0.0));
        let state = law(json!({"kappa": kappa, "xi": xi})).respond(&start, sliding).unwrap().state;
        let to = [sliding.dt, slip, pressure];
        let exact = |steps| rate_form([kappa, xi, 1.0, 1.0], start.clone(), [0.0, 0.0, old_pressure], to, steps);
        let tolerance = 1e-6 * MU_S * pressure.max(old_pressure);
        let allowed = [tolerance, tolerance, tolerance * (slip + state.plastic_increment)];
        // The rate equations in twice as many steps, until it changes little; a jump is never resolved.
        let mut rough = exact(125);
        let resolved = [250, 500, 1000, 2000].into_iter().map(exact).find(|fine| {
            let [q, _, work] = [0, 1, 2].map(|i| (fine[i] - rough[i]).abs());
            rough = *fine;
            q <= 0.05 * allowed[0] && work <= 0.05 * allowed[2]
        });
        let Some([q, mu, work]) = resolved else { continue };
        compared[kind] += 1;
        // An error of q also changes what is stored in the contact spring: the work of q is that and the dissipation.
        let stored = (state.traction * state.traction - q * q) / (2.0 * ALPHA_T);
        let errors = [state.traction - q, (mu_of(&state) - mu) * pressure, state.dissipation - work + stored];
        let errors = [0, 1, 2].map(|i| errors[i].abs() / allowed[i]);
        if kind == 1 && (2.0..100.0).contains(&errors[2]) {
            by_chance += 1;
            continue;
        }
        worst[kind] = [0, 1, 2].map(|i| worst[kind][i].max(errors[i]));
    }
    println!("{compared:?} increments, errors up to {worst:.2?} of the tolerance, {by_chance} by chance");
    assert!(compared[0] > 9_900 && compared[1] > 9_000, "{compared:?}");
    assert!(worst.iter().flatten().all(|error| *error < 2.0), "{worst:?}");
    assert!(by_chance <= 10, "{by_chance}");
}

/// The first contact, within the elastic core: nothing is plastic.
#[test]
fn a_first_contact_in_the_elastic_core_is_elastic() {
    let law = law(json!({"kappa": 10, "xi": 0.002, "elastic_core": 0.3}));
    let slip = 0.2 * MU_S * PRESSURE / ALPHA_T;
    let answer = law.respond(&with!(pressed(MU_S, 0.0), pressure: 0.0), Sliding::new(slip, PRESSURE, 1.0)).unwrap();
    assert!((answer.state.traction - ALPHA_T * slip).abs() < 1e-12 * PRESSURE, "{}", answer.state.traction);
    assert_eq!(answer.state.plastic_increment, 0.0);
}

/// Tangents of whole increments, sub-steps and all, against differences.
#[test]
fn tangents_belong_to_the_answers() {
    for integration in ["controlled", "backward_euler"] {
        let law = law(json!({"kappa": 10, "xi": 0.02, "integration": integration}));
        for (start, [slip, pressure, dt]) in [
            (pressed(0.3, 5.0), [0.05, 98.1, 10.0]),
            (pressed(0.3, 5.0), [-0.05, 98.1, 10.0]),
            (pressed(0.25, 15.0), [0.2, 150.0, 100.0]),
            (pressed(0.25, 15.0), [0.02, 60.0, 10.0]),
            (pressed(0.25, 15.0), [-0.001, 98.1, 1.0]),
            (pressed(0.4, 0.0), [0.01, 98.1, 1.0]),
        ] {
            let at = |slip: f64, pressure: f64| law.respond(&start, Sliding::new(slip, pressure, dt)).unwrap();
            let answer = at(slip, pressure);
            let (du, dp) = (1e-7 * slip.abs(), 1e-6 * pressure);
            let by_slip =
                (at(slip + du, pressure).state.traction - at(slip - du, pressure).state.traction) / (2.0 * du);
            let by_pressure =
                (at(slip, pressure + dp).state.traction - at(slip, pressure - dp).state.traction) / (2.0 * dp);
            let what = format!("{integration} from {} over {slip}", start.traction);
            assert!(
                (answer.dtraction_dslip - by_slip).abs() < 1e-4 * ALPHA_T,
                "{what}: {} {by_slip}",
                answer.dtraction_dslip
            );
            assert!(
                (answer.dtraction_dpressure - by_pressure).abs() < 1e-4,
                "{what}: {} {by_pressure}",
                answer.dtraction_dpressure
            );
        }
    }
}

fn any(given: &Value) -> Box<dyn FrictionLaw> {
    serde_json::from_value::<FrictionParameters>(given.clone()).unwrap().build(1.0).unwrap()
}

/// Slips, pressures and times with holds, reversals, and a parting after which the surfaces are pressed before they slip.
fn increments() -> Vec<Sliding> {
    let mut random = Random(7);
    let mut next = || random.unit();
    (0..60)
        .map(|k| {
            let slip = if k % 7 == 0 || k == 34 { 0.0 } else { 0.02 * (next() - if k % 20 < 14 { 0.2 } else { 0.9 }) };
            Sliding::new(slip, if k == 33 { -1.0 } else { 0.7 + 0.6 * next() }, 0.1 + next())
        })
        .collect()
}

/// Tractions along a path whose slips are `stretch` times as long.
fn tractions(given: &Value, stretch: f64) -> Vec<f64> {
    let law = any(given);
    let mut state = law.initial_state(0.0, 0.0);
    let lead = |sliding: &Sliding| {
        state = law.respond(&state, with!(*sliding, slip: stretch * sliding.slip)).unwrap().state;
        state.traction
    };
    increments().iter().map(lead).collect()
}

/// Against central differences of whole paths: by every parameter, and by the slip, beside it.
#[test]
fn sensitivities_are_those_of_differences() {
    let base = json!({"law": "super_subloading", "mu_s": 0.6, "mu_k": 0.4, "alpha_t": 40.0, "r": 20.0, "kappa": 3.0, "xi": 0.05,
        "tolerance": 1e-11});
    let mut curved = base.clone();
    let further = json!({"m": 1.3, "n": 0.8, "elastic_core": 0.2, "structure": 1.3, "approach": "cotangent"});
    curved.as_object_mut().unwrap().extend(further.as_object().unwrap().clone());
    let rate = json!({"law": "rate_and_state", "a": 0.02, "b": 0.025, "f_0": 0.6, "V_0": 0.1, "D_c": 0.3, "alpha_t": 40.0, "theta": 2.0});
    let slip_law = json!({"law": "rate_and_state", "a": 0.02, "b": 0.025, "f_0": 0.6, "V_0": 0.1, "D_c": 0.3, "alpha_t": 40.0,
        "evolution": "slip"});
    let weakening =
        json!({"law": "slip_weakening", "mu_s": 0.6, "mu_d": 0.4, "D_c": 0.5, "cohesion": 0.1, "alpha_t": 4.0});
    for given in [base, curved, rate, slip_law, weakening, json!({"law": "coulomb", "mu": 0.5, "alpha_t": 4.0})] {
        let law = any(&given);
        let sensitive = law.sensitivities().unwrap();
        for name in sensitive.parameters().iter().filter(|name| given[**name].is_f64()) {
            let (mut old, mut states) = (law.initial_state(0.0, 0.0), [sensitive.start(name), Variation::default()]);
            let mut exact = Vec::new();
            for sliding in increments() {
                let by_parameter =
                    with!(Direction::default(), state: states[0].clone(), slip: 0.0, parameter: Some(*name));
                let by_slip = with!(Direction::default(), state: states[1].clone(), slip: sliding.slip);
                states = sensitive.vary(&old, sliding, [by_parameter, by_slip]).unwrap();
                old = law.respond(&old, sliding).unwrap().state;
                exact.push(states.clone().map(|state| state.traction));
            }
            let moved = |by: f64| {
                let mut other = given.clone();
                other[*name] = json!(given[*name].as_f64().unwrap() + by);
                tractions(&other, 1.0)
            };
            let h = 1e-5 * given[*name].as_f64().unwrap();
            let apart =
                [(moved(h), moved(-h), h), (tractions(&given, 1.0 + 1e-5), tractions(&given, 1.0 - 1e-5), 1e-5)];
            for (k, (above, below, step)) in apart.iter().enumerate() {
                let largest = exact.iter().map(|row| row[k].abs()).fold(0.0, f64::max);
                for (i, row) in exact.iter().enumerate() {
                    let error = row[k] - (above[i] - below[i]) / (2.0 * step);
                    assert!(error.abs() <= 1e-6 * largest, "{given} by {name}, {k}, at {i}: {error:e} of {largest:e}");
                }
            }
        }
    }
}

/// Without an elastic core U is infinite where a point closes first. Against central differences.
#[test]
fn sensitivities_begin_with_the_first_contact() {
    for approach in ["logarithmic", "cotangent"] {
        let given = json!({"law": "super_subloading", "mu_s": 0.6, "mu_k": 0.4, "alpha_t": 40.0, "r": 20.0, "kappa": 3.0,
            "xi": 0.05, "approach": approach});
        let (law, sliding) = (any(&given), Sliding::new(0.02, 1.0, 0.1));
        for name in ["mu_s", "mu_k", "alpha_t", "r", "kappa", "xi"] {
            let sensitive = law.sensitivities().unwrap();
            let by = with!(Direction::default(), state: sensitive.start(name), parameter: Some(name));
            let [found, _] = sensitive.vary(&law.initial_state(0.0, 0.0), sliding, [by.clone(), by]).unwrap();
            let of = given[name].as_f64().unwrap();
            let moved = |to: f64| {
                let mut other = given.clone();
                other[name] = json!(to);
                let law = any(&other);
                law.respond(&law.initial_state(0.0, 0.0), sliding).unwrap().state.traction
            };
            let difference = (moved(of * (1.0 + 1e-4)) - moved(of * (1.0 - 1e-4))) / (2e-4 * of);
            let error = found.traction - difference;
            assert!(
                error.abs() <= 1e-6 * (1.0 + difference.abs()),
                "{approach} by {name}: {error:e} of {difference:e}"
            );
        }
    }
}

/// The tangent of an answer is its derivative along the slip and the pressure, which `vary` finds with the law's parameters held.
#[test]
fn derivatives_by_slip_and_pressure_are_the_tangent() {
    let laws = [
        json!({"law": "super_subloading", "mu_s": 0.6, "mu_k": 0.4, "alpha_t": 40.0, "r": 20.0, "kappa": 3.0, "xi": 0.05, "m": 1.3}),
        json!({"law": "rate_and_state", "a": 0.02, "b": 0.025, "f_0": 0.6, "V_0": 0.1, "D_c": 0.3, "alpha_t": 40.0}),
        json!({"law": "slip_weakening", "mu_s": 0.6, "mu_d": 0.4, "D_c": 0.5, "cohesion": 0.1, "alpha_t": 4.0}),
        json!({"law": "coulomb", "mu": 0.5, "alpha_t": 4.0}),
        json!({"law": "adhesion", "strength": 0.3, "alpha_t": 4.0}),
    ];
    for given in laws {
        let law = any(&given);
        let sensitive = law.sensitivities().unwrap();
        let mut old = law.initial_state(0.0, 0.0);
        for (i, sliding) in increments().into_iter().enumerate() {
            let along = [with!(Direction::default(), slip: 1.0), with!(Direction::default(), pressure: 2.0)];
            let [by_slip, by_pressure] = sensitive.vary(&old, sliding, along).unwrap();
            let answer = law.respond(&old, sliding).unwrap();
            let [slip, pressure] =
                [by_slip.traction - answer.dtraction_dslip, by_pressure.traction - 2.0 * answer.dtraction_dpressure];
            assert!(slip.abs() < 1e-6 * law.description().stiffness, "{given} at {i}: {slip:e} in the tangent by slip");
            assert!(pressure.abs() < 1e-6, "{given} at {i}: {pressure:e} in the tangent by pressure");
            old = answer.state;
        }
    }
}
