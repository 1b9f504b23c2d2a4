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
                let told = format!("{text}, {dilatancy:?}, {wear:?}, slip {slip}");
                assert!(
                    (response.dopening_dslip - by_slip).abs() < 1e-6,
                    "{told}: {} {by_slip}",
                    response.dopening_dslip
                );
                let scale = 1e-3 / 700.0;
                let off = (response.dopening_dpressure - by_pressure).abs();
                assert!(off < 1e-3 * scale + 1e-9, "{told}: {} {by_pressure}", response.dopening_dpressure);
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
