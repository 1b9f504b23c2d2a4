//! Dilatancy and wear beside every friction law.

use fecontact::laws::friction::{
    Answer, ContactLaw, Description, Dilatancy, FrictionLaw, FrictionParameters, FrictionResponse, FrictionState,
    Offsets, Sliding,
};
use fecontact::laws::parameter::InvalidParameter;

const LAWS: [&str; 5] = [
    r#"{"law": "coulomb", "mu": 0.4}"#,
    r#"{"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.3, "r": 100, "kappa": 10, "xi": 0.02, "structure": 1.2}"#,
    r#"{"law": "slip_weakening", "mu_s": 0.6, "mu_d": 0.3, "D_c": 0.05}"#,
    r#"{"law": "rate_and_state", "f_0": 0.6, "V_0": 0.01, "a": 0.01, "b": 0.015, "D_c": 0.02}"#,
    r#"{"law": "frictionless"}"#,
];

fn law(text: &str) -> Box<dyn FrictionLaw> {
    serde_json::from_str::<FrictionParameters>(text).expect("a law").build(700.0).expect("good parameters")
}

/// The law of a contact whose surfaces dilate and wear.
fn moving(text: &str, dilatancy: Option<Dilatancy>, wear: Option<f64>) -> Result<ContactLaw, InvalidParameter> {
    ContactLaw::with_offsets(law(text), Offsets { dilatancy, wear })
}

fn answer(law: &ContactLaw, old: &FrictionState, slip: f64, pressure: f64) -> FrictionState {
    law.respond(old, Sliding::new(slip, pressure, 0.1)).expect("an answer").state
}

/// q, d and their tangents against central differences, from a state that has dilated and worn: sticking, slipping either way,
/// with the pressure falling and rising. Friction is that of the law alone.
#[test]
fn tangents_of_opening_equal_differences() {
    let dilatancy = Dilatancy::new(0.25).limit(0.03);
    let (mut slips, mut reversals) = (0, 0);
    for text in LAWS {
        let frictionless = text.contains("frictionless");
        for (dilatancy, wear) in [(Some(dilatancy), None), (None, Some(2e-4)), (Some(dilatancy), Some(2e-4))] {
            if frictionless && dilatancy.is_some() {
                assert!(moving(text, dilatancy, wear).is_err(), "dilatancy without friction");
                continue;
            }
            let (alone, moving) = (law(text).into(), moving(text, dilatancy, wear).expect("good parameters"));
            let start = answer(&moving, &moving.law.initial_state(20.0, 0.0), 0.03, 22.0);
            for (slip, pressure) in [(2e-5, 22.0), (2e-2, 25.0), (-6e-2, 18.0), (5e-2, 21.0)] {
                let at = |slip, pressure| answer(&moving, &start, slip, pressure);
                let response = moving.respond(&start, Sliding::new(slip, pressure, 0.1)).expect("an answer");
                assert_eq!(response.state.traction, answer(&alone, &start, slip, pressure).traction);
                let (h, k) = (1e-7, 1e-4);
                let by_slip = (at(slip + h, pressure).opening - at(slip - h, pressure).opening) / (2.0 * h);
                let by_pressure = (at(slip, pressure + k).opening - at(slip, pressure - k).opening) / (2.0 * k);
                let message = format!("{text}, {dilatancy:?}, {wear:?}, slip {slip}");
                assert!(
                    (response.dopening_dslip - by_slip).abs() < 1e-6,
                    "{message}: {} {by_slip}",
                    response.dopening_dslip
                );
                let scale = 1e-3 / 700.0;
                let off = (response.dopening_dpressure - by_pressure).abs();
                assert!(off < 1e-3 * scale + 1e-9, "{message}: {} {by_pressure}", response.dopening_dpressure);
                slips += usize::from(by_slip > 1e-3);
                reversals += usize::from(by_slip < -1e-3);
            }
        }
    }
    assert!(slips > 8 && reversals > 4, "{slips} and {reversals} answers opened");
}

/// An oil film, q = η Δu/Δt: a law that stores nothing, and has no stiffness of its own.
#[derive(Clone, Debug)]
struct Oil;

impl FrictionLaw for Oil {
    fn description(&self) -> Description {
        Description::default()
    }

    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Answer {
        let Sliding { slip, pressure, dt, .. } = sliding.checked()?;
        if pressure <= 0.0 {
            return FrictionResponse::elastic(old.parted(0.0), 0.0).checked(0.0);
        }
        let viscosity = 3.0 * pressure / dt;
        let mut state = old.stuck(viscosity * slip, pressure);
        (state.plastic_slip, state.plastic_increment) = (old.plastic_slip + slip, slip);
        FrictionResponse::new(state, viscosity, 3.0 * slip / dt).checked(0.0)
    }
}

/// Wear takes nothing from the tangent of a law without stiffness: ∂q/∂Δu = 3 p/Δt and ∂q/∂p = 3 Δu/Δt stay as they are. Nothing is lost
/// where the surfaces part.
#[test]
fn a_law_without_stiffness_keeps_its_tangent_where_surfaces_wear() {
    let worn = ContactLaw::with_offsets(Box::new(Oil), Offsets { dilatancy: None, wear: Some(1e-3) }).expect("good");
    let response = worn.respond(&worn.law.initial_state(4.0, 0.0), Sliding::new(0.2, 5.0, 0.1)).expect("an answer");
    assert_eq!([response.dtraction_dslip, response.dtraction_dpressure], [3.0 * 5.0 / 0.1, 3.0 * 0.2 / 0.1]);
    // w = k ½(p₀ + p₁) Δu
    assert!((response.state.wear - 1e-3 * 4.5 * 0.2).abs() < 1e-15 && response.dopening_dslip == -1e-3 * 4.5);
    let parted = answer(&worn, &response.state, 0.1, -1.0);
    assert_eq!([parted.traction, parted.dissipation], [0.0, response.state.dissipation]);
}

/// Slip to and fro opens the interface with its whole way, up to the limit; wear takes away k p of it, and the work of lifting
/// and wearing is friction's: ΔW = ∫ q dλ − ∫ p dd. Parting leaves it as it is.
#[test]
fn to_and_fro_dilation_goes_on_and_wear_adds_up() {
    let (rate, limit, wear, pressure) = (0.25, 0.03, 2e-4, 20.0);
    let moving = moving(LAWS[0], Some(Dilatancy::new(rate).limit(limit)), Some(wear)).expect("good");
    let alone: ContactLaw = law(LAWS[0]).into();
    let (mut state, mut plain) = (moving.law.initial_state(pressure, 0.0), alone.law.initial_state(pressure, 0.0));
    let mut way = 0.0;
    for k in 0..40 {
        let slip = if (k / 5) % 2 == 0 { 0.01 } else { -0.01 };
        (state, plain) = (answer(&moving, &state, slip, pressure), answer(&alone, &plain, slip, pressure));
        way += state.plastic_increment.abs();
        let dilation = limit * (1.0 - (-rate * way / limit).exp());
        assert!((state.opening + state.wear - dilation).abs() < 1e-15, "{} {dilation}", state.opening);
        assert!((state.wear - wear * pressure * way).abs() < 1e-15);
        let work = plain.dissipation - pressure * state.opening;
        assert!((state.dissipation - work).abs() < 1e-13, "{} {work}", state.dissipation);
    }
    assert!(way > 0.2 && state.plastic_slip.abs() < 0.1, "{way}, {}", state.plastic_slip);
    let parted = answer(&moving, &state, 0.1, -1.0);
    assert_eq!((parted.opening, parted.wear), (state.opening, state.wear));
}

/// κ, ξ, μ_s, μ_k and r of a law with structure.
const STRUCTURED: [f64; 5] = [10.0, 0.02, 0.5, 0.3, 100.0];

/// d of tan ψ = d (μ/μ_k − 1).
const D: f64 = 0.35;

/// The law with structure, of α_t = 700, and more of its parameters.
fn structured(xi: f64, more: &str) -> String {
    let [kappa, _, mu_s, mu_k, r] = STRUCTURED;
    format!(
        r#"{{"law": "super_subloading", "mu_s": {mu_s}, "mu_k": {mu_k}, "r": {r}, "kappa": {kappa}, "xi": {xi}{more}}}"#
    )
}

/// d and its tangents against central differences, where tan ψ follows the structure: from touch, in short and long increments, on
/// reversal, in healing, by both integrations, with exponents, a limit and wear.
#[test]
fn tangents_of_opening_by_structure_equal_differences() {
    let with_limit = Dilatancy::of_structure(D).limit(0.01);
    let mut opened = 0;
    for more in ["", r#", "m": 1.4, "n": 0.8"#, r#", "integration": "backward_euler""#, r#", "elastic_core": 0.3"#] {
        for (dilatancy, wear) in [(Dilatancy::of_structure(D), None), (with_limit, Some(2e-4))] {
            let moving = moving(&structured(0.2, more), Some(dilatancy), wear).expect("good parameters");
            let touch = moving.law.initial_state(20.0, 0.0);
            for start in [touch.clone(), answer(&moving, &touch, 0.03, 22.0)] {
                for (slip, pressure) in [(2e-3, 22.0), (2e-2, 25.0), (-6e-2, 18.0), (0.4, 21.0)] {
                    let at = |slip, pressure| answer(&moving, &start, slip, pressure).opening;
                    let response = moving.respond(&start, Sliding::new(slip, pressure, 0.1)).expect("an answer");
                    let (h, k) = (1e-6, 1e-3);
                    let by_slip = (at(slip + h, pressure) - at(slip - h, pressure)) / (2.0 * h);
                    let by_pressure = (at(slip, pressure + k) - at(slip, pressure - k)) / (2.0 * k);
                    let message = format!("{more}, {dilatancy:?}, slip {slip} from {}", start.plastic_slip);
                    let off = (response.dopening_dslip - by_slip).abs();
                    assert!(off < 3e-4 * by_slip.abs() + 1e-5, "{message}: {} {by_slip}", response.dopening_dslip);
                    let off = (response.dopening_dpressure - by_pressure).abs();
                    assert!(
                        off < 1e-3 * by_pressure.abs() + 1e-9,
                        "{message}: {} {by_pressure}",
                        response.dopening_dpressure
                    );
                    opened += usize::from(by_slip.abs() > 1e-3);
                }
            }
        }
    }
    assert!(opened > 40, "{opened} answers opened");
}

/// Without healing ∫ (μ/μ_k − 1) dλ has a closed form, μ − μ_k falling by exp(−κ λ/μ_k): d = d (μ_s/μ_k − 1) (1 − exp(−κ λ/μ_k)) μ_k/κ,
/// in one increment or in many. At the residual the volume stays, and what is dissipated is ∫ q dλ − p d.
#[test]
fn structure_dilates_to_its_closed_form() {
    let [kappa, _, mu_s, mu_k, _] = STRUCTURED;
    let (text, pressure) = (structured(0.0, ""), 20.0);
    let moving = moving(&text, Some(Dilatancy::of_structure(D)), None).expect("good parameters");
    let alone: ContactLaw = law(&text).into();
    for increments in [1, 7, 300] {
        let (mut state, mut plain) = (moving.law.initial_state(pressure, 0.0), alone.law.initial_state(pressure, 0.0));
        for _ in 0..increments {
            let slip = 0.15 / f64::from(increments);
            (state, plain) = (answer(&moving, &state, slip, pressure), answer(&alone, &plain, slip, pressure));
        }
        let lost = -(-kappa * state.plastic_slip / mu_k).exp_m1();
        let opening = D * (mu_s / mu_k - 1.0) * mu_k / kappa * lost;
        assert!((state.opening - opening).abs() < 1e-9 * opening, "{increments}: {} {opening}", state.opening);
        let work = plain.dissipation - pressure * state.opening;
        assert!((state.dissipation - work).abs() < 1e-12 * work && lost > 0.95);
        let residual = answer(&moving, &state, 0.5, pressure);
        let rest = answer(&moving, &residual, 0.5, pressure);
        assert!(rest.opening - residual.opening < 1e-8 * opening, "volume at the residual");
    }
}

/// q, μ and d of the rate equations by classical Runge–Kutta steps, for a slip rate v: loading where λ > 0 (fact sheet of the law), the
/// traction not turning round. Returns d after each leg [slip rate, duration].
fn by_rates(d: f64, pressure: f64, start: f64, legs: &[[f64; 2]]) -> Vec<f64> {
    let [kappa, xi, mu_s, mu_k, r] = STRUCTURED;
    let alpha_t = 700.0;
    let rates = |[q, mu, _]: [f64; 3], v: f64| -> [f64; 3] {
        let ratio: f64 = q / (mu * pressure);
        let (recovery, weakening) = (xi * (1.0 - mu / mu_s), kappa * (mu / mu_k - 1.0));
        let stiffness = alpha_t - r * ratio.ln() * mu * pressure - ratio * weakening * pressure;
        let slip = ((alpha_t * v - ratio * recovery * pressure) / stiffness).max(0.0);
        [alpha_t * (v - slip), recovery - weakening * slip, d * (mu / mu_k - 1.0) * slip]
    };
    let mut state = [start, mu_s, 0.0];
    let ends = legs.iter().map(|&[v, duration]| {
        const STEPS: u32 = 200_000;
        let dt = duration / f64::from(STEPS);
        for _ in 0..STEPS {
            let moved = |by: [f64; 3], share: f64| [0, 1, 2].map(|i| state[i] + share * dt * by[i]);
            let a = rates(state, v);
            let b = rates(moved(a, 0.5), v);
            let c = rates(moved(b, 0.5), v);
            let e = rates(moved(c, 1.0), v);
            state = [0, 1, 2].map(|i| state[i] + dt / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + e[i]));
        }
        state[2]
    });
    ends.collect()
}

/// Slip, a hold, and slip again: the interface dilates to its peak, keeps its volume, and dilates once more by what has healed, as the
/// rate equations have it. Short increments and long ones agree.
#[test]
fn structure_that_has_healed_dilates_again() {
    let (pressure, traction) = (20.0, 4.0);
    let legs = [[0.5, 0.6], [0.0, 30.0], [0.5, 0.6]];
    let expected = by_rates(D, pressure, traction, &legs);
    for (increments, tolerance) in [(400, 2e-5), (20, 2e-4)] {
        let moving = moving(&structured(STRUCTURED[1], ""), Some(Dilatancy::of_structure(D)), None).expect("good");
        let mut state = moving.law.initial_state(pressure, traction);
        let mut found = Vec::new();
        for [rate, duration] in legs {
            let dt = duration / f64::from(increments);
            for _ in 0..increments {
                state = moving.respond(&state, Sliding::new(rate * dt, pressure, dt)).expect("an answer").state;
            }
            found.push(state.opening);
        }
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < tolerance * expected, "{increments}: {found} {expected}");
        }
        assert!(found[2] > 1.5 * found[1] && found[1] - found[0] < 1e-3 * found[0], "{found:?}");
    }
}

/// What dilates with structure needs a law that has some, and friction at the full structure above tan ψ: d (μ_s/μ_k − 1) < μ_s.
#[test]
fn dilatancy_by_structure_stays_below_the_peak() {
    let [_, _, mu_s, mu_k, _] = STRUCTURED;
    let (text, most) = (structured(0.02, ""), mu_s * mu_k / (mu_s - mu_k));
    assert!(moving(&text, Some(Dilatancy::of_structure(0.999 * most)), None).is_ok());
    let refused = |text: &str, dilatancy| {
        let error = moving(text, Some(dilatancy), None).expect_err("refused");
        format!("{}: {}", error.name, error.allowed)
    };
    let message = refused(&text, Dilatancy::of_structure(1.001 * most));
    assert!(message.starts_with("dilatancy.structure") && message.contains("below 0.5"), "{message}");
    for other in [0, 2, 3] {
        let message = refused(LAWS[other], Dilatancy::of_structure(0.1));
        assert!(message.contains("dilatancy.structure") && message.contains("has no structure"), "{message}");
    }
    let both = with!(Dilatancy::of_structure(0.1), rate: Some(0.1));
    assert!(refused(&text, both).contains("`rate` is given as well"));
    assert!(refused(&text, with!(both, rate: None, structure: None)).contains("must be given, or `structure`"));
    assert!(refused(&text, Dilatancy::of_structure(-0.1)).contains("positive"));
}

/// Sliding must take work however far friction has come down: tan ψ is held against the least coefficient that a law can come to,
/// μ_k, μ_d or μ, and both are told.
#[test]
fn dilatancy_stays_below_the_least_friction() {
    for (text, least) in [(LAWS[0], 0.4), (LAWS[1], 0.3), (LAWS[2], 0.3)] {
        let offset = |rate: f64| moving(text, Some(Dilatancy::new(rate)), None);
        assert!(offset(0.99 * least).is_ok(), "{text}");
        for rate in [least, 1.1 * least] {
            let error = offset(rate).expect_err("sliding would produce energy");
            assert_eq!((error.name, error.value), ("dilatancy.rate", rate));
            assert!(error.allowed.contains(&least.to_string()), "{text}: {error}");
        }
    }
    // Steady friction of rate and state falls with the logarithm of the rate, without end: a run watches it.
    assert!(moving(LAWS[3], Some(Dilatancy::new(0.55)), None).is_ok());
}

/// What has no meaning is refused by name.
#[test]
fn bad_parameters_are_named() {
    for (rate, limit, wear, name) in [
        (0.0, None, None, "dilatancy.rate"),
        (0.4, None, None, "dilatancy.rate"),
        (0.1, Some(-1.0), None, "dilatancy.limit"),
        (0.1, Some(f64::NAN), None, "dilatancy.limit"),
        (0.1, None, Some(-1.0), "wear"),
    ] {
        let error = moving(LAWS[0], Some(with!(Dilatancy::new(rate), limit: limit)), wear).expect_err("bad");
        assert_eq!(error.name, name);
    }
}
