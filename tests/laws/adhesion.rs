//! Adhesion: one shear strength whatever the pressure, in closed form.

use crate::common::close;
use fecontact::laws::friction::{Adhesion, AdhesionParameters, FrictionLaw, FrictionParameters, Regime, Sliding};

const STRENGTH: f64 = 20.0;
const ALPHA_T: f64 = 1e4;

fn law() -> Adhesion {
    Adhesion::new(&AdhesionParameters::new(STRENGTH), ALPHA_T).expect("allowed")
}

/// Elastic below the strength, at it beyond, at any pressure; dissipation is τ_a times the plastic slip, q²/2α_t is what is stored.
#[test]
fn it_slides_at_its_strength_whatever_the_pressure() {
    let law = law();
    let mut state = law.initial_state(0.0, 0.0);
    let mut work = 0.0;
    for (slip, pressure, traction) in
        [(1e-3, 50.0, 10.0), (3e-3, 5.0, 20.0), (5e-3, 500.0, 20.0), (-1e-3, 1e-3, 10.0), (-6e-3, 80.0, -20.0)]
    {
        let answer = law.respond(&state, Sliding::new(slip, pressure, 0.1)).expect("an answer");
        close("q", answer.state.traction, traction, 1e-12);
        assert_eq!(answer.dtraction_dslip, if traction.abs() < STRENGTH { ALPHA_T } else { 0.0 });
        assert_eq!(answer.dtraction_dpressure, 0.0);
        // ∫ q du of the exact path: elastic, then at the strength
        let elastic = (traction - state.traction) / ALPHA_T;
        work += 0.5 * (state.traction + traction) * elastic + traction * (slip - elastic);
        state = answer.state;
        close("energy", work, state.dissipation + 0.5 * traction * traction / ALPHA_T, 1e-12);
    }
    let open = law.respond(&state, Sliding::new(1.0, -1.0, 0.1)).expect("an answer").state;
    assert_eq!((open.traction, open.regime), (0.0, Regime::Open));
    assert_eq!(law.observe("R", &state), Some(1.0));
    assert_eq!(law.observe("mu", &state), None);
}

/// What is above the strength at the start is released by slip, at the mean of both.
#[test]
fn an_excess_is_released() {
    let law = law();
    let start = law.initial_state(10.0, 30.0);
    let state = law.respond(&start, Sliding::new(0.0, 10.0, 0.0)).expect("an answer").state;
    close("q", state.traction, STRENGTH, 1e-12);
    close("dissipation", state.dissipation, 0.5 * (30.0 + 20.0) * 10.0 / ALPHA_T, 1e-12);
    let state = law.respond(&start, Sliding::new(2e-3, 10.0, 0.1)).expect("an answer").state;
    close("dissipation", state.dissipation, (0.5 * (30.0 + 20.0) * 10.0 + 20.0 * 20.0) / ALPHA_T, 1e-12);
}

/// By its name in a case, and its derivatives by its parameters against differences.
#[test]
fn it_is_known_by_name_and_its_parameters_have_derivatives() {
    let given = r#"{"law": "adhesion", "strength": 20, "alpha_t": 1e4}"#;
    let parameters: FrictionParameters = serde_json::from_str(given).expect("well formed");
    let by_name = parameters.build(1.0).expect("allowed");
    let answer = by_name.respond(&by_name.initial_state(0.0, 0.0), Sliding::new(1.0, 1.0, 0.0)).expect("an answer");
    assert_eq!(answer.state.traction, STRENGTH);
    assert_eq!(law().sensitivities().expect("it has them").parameters(), ["strength", "alpha_t"]);
    for strength in [0.0, -1.0, f64::NAN] {
        let refused = Adhesion::new(&AdhesionParameters::new(strength), ALPHA_T).expect_err("not positive");
        assert_eq!(refused.name, "strength");
    }
}
