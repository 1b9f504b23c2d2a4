//! A law from elsewhere in results.

use super::*;

/// A slider dragged, halted while its load doubles, and dragged on. The law is not known to the program; its friction follows
/// the pressure with the slip λ since then by q = μ Σ w_i (p₁ + (p₀ − p₁) exp(−λ/L_i)), in closed form, and its variables
/// appear by name.
#[test]
fn a_law_from_elsewhere_runs_and_its_variables_appear_by_name() {
    let law = DelayedPressure { mu: 0.5, alpha_t: 1e4, shares: [0.3, 0.7], lengths: [0.01, 0.05] };
    let (mu, shares, lengths) = (law.mu, law.shares, law.lengths);
    let load = |force: f64| json!([{"on": "block", "force": {"y": force}}]);
    let pull = |ux: f64| json!([{"on": "block", "ux": ux}]);
    let step = |name: &str, ux: f64, force: f64| json!({"name": name, "duration": 1, "dt": {"initial": 0.05}, "supports": pull(ux), "loads": load(force)});
    let mut model = common::model(&json!({
        "mesh": {"nodes": [[0, 0]], "points": {"block": [0]}},
        "contacts": {"base": {
            "slave": "block", "area": 2, "normal": {"alpha_n": 1e4},
            "master": {"plane": {"point": [0, 0], "normal": [0, 1]}}, "friction": {"law": "frictionless"},
        }},
        "newton": {"tolerance": 1e-13},
        "steps": [step("press", 0.0, -20.0), step("drag", 2.0, -20.0), step("squeeze", 2.0, -40.0), step("on", 2.2, -40.0)],
    }));
    model.contacts[0].laws = vec![Arc::new(law.into())];
    let model = Arc::new(model);
    let folder = TempDir::new().unwrap();
    let mut history = History::create(folder.path(), &model).unwrap();
    let mut fields = common::frames(folder.path(), &model, 1);
    let mut record = Record::default();
    fecontact::run::run(&model, &mut [&mut record, &mut history, &mut fields]).1.unwrap();
    drop((history, fields));

    let (frames, mut slipping) = (folder.path().join("contact"), 0);
    let held =
        record.states.iter().find(|state| state.time > 3.0 - 1e-9).expect("a state").contacts[0][0].friction.clone();
    close("no slip, no change", held.traction, mu * 10.0, 1e-9);
    close("pressure", held.pressure, 20.0, 1e-9);
    for (number, state) in record.states.iter().enumerate() {
        let friction = &state.contacts[0][0].friction;
        let piece = frame(&frames.join(format!("{:05}.vtu", number + 1)));
        for (name, value) in ["psi_1", "psi_2"].iter().zip(friction.variables.values()) {
            close(name, values(&piece.data.point, name)[0], value, 0.0);
        }
        if state.time > 3.0 + 1e-9 {
            let slid = friction.plastic_slip - held.plastic_slip;
            let psi = [0, 1].map(|i| shares[i] * (20.0 - 10.0 * (-slid / lengths[i]).exp()));
            close("traction", friction.traction, mu * (psi[0] + psi[1]), 1e-8);
            assert_eq!(friction.regime, Regime::Slip);
            slipping += 1;
        }
    }
    assert!(slipping >= 20 && held.regime == Regime::Stick);
    let last = &record.states.last().expect("a state").contacts[0][0].friction;
    assert!(last.plastic_slip > 2.19 && last.traction > 9.9, "the new pressure has arrived: {last:?}");
    let text = fs::read_to_string(folder.path().join("history.csv")).unwrap();
    let (header, end) = (text.lines().next().unwrap(), text.lines().last().unwrap());
    let column = header.split(',').position(|name| name == "base.mean_psi_2").expect("a column of the variable");
    close("mean", end.split(',').nth(column).unwrap().parse().unwrap(), last.variables[1], 1e-12);
}

/// The law of the test before: tangents by differences, and ∮ q du is what is dissipated but for what the pressure at the end
/// of an increment leaves.
#[test]
fn the_law_from_elsewhere_has_exact_tangents() {
    let law = DelayedPressure { mu: 0.5, alpha_t: 1e3, shares: [0.3, 0.7], lengths: [0.01, 0.05] };
    let old = law.initial_state(10.0, 4.0);
    for (slip, pressure) in [(0.0005, 12.0), (0.01, 12.0), (0.1, 30.0), (-0.05, 5.0)] {
        let at = |slip, pressure| law.respond(&old, Sliding { slip, pressure, dt: 1.0 }).unwrap();
        let answer = at(slip, pressure);
        let by_slip = (at(slip + 1e-7, pressure).state.traction - at(slip - 1e-7, pressure).state.traction) / 2e-7;
        let by_pressure = (at(slip, pressure + 1e-4).state.traction - at(slip, pressure - 1e-4).state.traction) / 2e-4;
        close("slip", answer.dtraction_dslip, by_slip, 1e-4 * law.alpha_t);
        close("pressure", answer.dtraction_dpressure, by_pressure, 1e-6);
        assert!(answer.state.dissipation >= 0.0);
    }
}
