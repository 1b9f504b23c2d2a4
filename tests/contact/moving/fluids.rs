//! A fluid between surfaces: friction by the effective pressure, its work, and what it opens.

use super::*;

/// p' = N/A − p_w holds with μ p'; where p_w is above N/A the box is lifted until the spring above it takes the rest.
#[test]
fn friction_knows_the_effective_pressure_and_the_fluid_lifts() {
    let stiffness = 50.0;
    let spring = json!([{"on": "block", "spring": {"ky": stiffness}}]);
    let run = sheared(&json!({"fluid_pressure": "30*max(t - 1, 0)"}), drag(0.0125, json!({"loads": spring})));
    let (mut closed, mut open) = (0, 0);
    for state in run.states.iter().filter(|state| state.time > 1.0) {
        let (point, fluid) = (state.contacts[0][0].clone(), 30.0 * (state.time - 1.0));
        assert_eq!(point.fluid, fluid);
        // p A + p_w A = N + K u_y, u_y = −p/α_n while it is closed.
        let pressure = (LOAD - AREA * fluid) / (AREA + stiffness / ALPHA_N);
        if pressure > 0.0 {
            close("p", point.friction.pressure, pressure, 1e-9 * LOAD);
            closed += usize::from(point.friction.regime == Regime::Slip);
            if point.friction.regime == Regime::Slip {
                close("q", point.friction.traction.abs(), MU * pressure, 1e-9 * LOAD);
            }
        } else {
            open += 1;
            assert_eq!(point.regime(), Regime::Open);
            close("lift", state.displacement[1], (AREA * fluid - LOAD) / stiffness, 1e-9);
        }
    }
    assert!(closed > 15 && open > 15, "{closed} closed, {open} open");
    // A fluid is a load: its work is force × way, at both ends of every increment.
    let energy = &run.last().energy;
    close("energy", energy.error(), 0.0, 3e-4 * energy.external_work.abs());
}

/// A mass that weighs less than the fluid presses flies up with (p_w A − N)/m, implicitly and explicitly, and the work of the
/// fluid is its energy.
#[test]
fn a_fluid_throws_a_mass_up() {
    for scheme in [json!({"newmark": {}}), json!({"explicit": {}})] {
        let run = finish(&json!({
            "mesh": {"nodes": [[0, 1e-6]], "points": {"block": [0]}},
            "point_masses": {"block": {"mass": 2}},
            "contacts": {"base": {
                "slave": "block", "area": AREA, "normal": {"alpha_n": ALPHA_N}, "fluid_pressure": 60,
                "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
                "friction": {"law": "coulomb", "mu": MU, "alpha_t": ALPHA_T}
            }},
            "newton": {"tolerance": 1e-13},
            "steps": [{"name": "fly", "duration": 1, "scheme": scheme, "dt": {"initial": 0.01, "max": 0.01},
                       "loads": [{"on": "block", "force": {"y": "-20"}}]}],
        }));
        let state = run.last();
        let acceleration = (60.0 * AREA - LOAD) / 2.0;
        close("velocity", state.velocity[1], acceleration, 1e-9);
        close("height", state.displacement[1], 0.5 * acceleration, 1e-9);
        close("energy", state.energy.error(), 0.0, 1e-9 * state.energy.kinetic);
        assert_eq!(state.contacts[0][0].fluid, 60.0);
    }
}

/// Two elastic blocks over a fluid whose pressure grows until it parts them: the audit is closed by the square of the increment,
/// point by point and by mortar, and the resultant on the ground is what presses from above.
#[test]
fn the_work_of_a_fluid_between_bodies_is_accounted_for() {
    for (method, sliding) in
        [("gauss_to_segment", "finite"), ("node_to_segment", "finite"), ("mortar", "finite"), ("mortar", "small")]
    {
        let errors = [40, 80].map(|parts| {
            let mesh = Blocks::default().rectangle("ground", [6, 3], [0.0, -0.5], [2.0, 0.0]).rectangle(
                "block",
                [5, 3],
                [0.0, 0.0],
                [2.0, 0.5],
            );
            let material = json!({"model": "neo_hookean", "E": 100, "nu": 0.3});
            let run = finish(&json!({
                "mesh": mesh.json(),
                "bodies": {"ground": {"material": material}, "block": {"material": material}},
                "contacts": {"base": {"slave": "block_bottom", "master": "ground_top", "method": method, "sliding": sliding,
                    "fluid_pressure": "4*max(t - 1, 0)*(1 + 0.3*x)", "friction": {"law": "coulomb", "mu": 0.3}}},
                "newton": {"tolerance": 1e-11},
                "steps": [
                    {"name": "press", "duration": 1, "dt": {"initial": 0.1}, "supports": [
                        {"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0, "uy": -0.02}]},
                    {"name": "inject", "duration": 1, "dt": {"initial": 1.0 / parts as f64, "max": 1.0 / parts as f64}},
                ],
            }));
            let state = run.last();
            let closed = state.contacts[0].iter().filter(|point| point.regime() != Regime::Open).count();
            assert!(closed < state.contacts[0].len(), "{method}: nothing opens");
            let [bottom, top] = ["ground_bottom", "block_top"].map(|side| run.reaction(side, state)[1]);
            close("resultants", bottom, -top, 1e-8);
            let total: f64 = state.contacts[0].iter().map(|at| at.length * (at.friction.pressure + at.fluid)).sum();
            close("p + p_w against the ground", bottom, total, 2e-2 * total);
            state.energy.error().abs() / state.energy.external_work.abs()
        });
        println!("{method}, {sliding}: energy errors {errors:?}");
        assert!(errors[0] < 1e-3 && errors[1] < 0.4 * errors[0] + 1e-7, "{method}, {sliding}: {errors:?}");
    }
}

/// A fluid is injected into a fault under uniform tractions τ₀, near the strength μ_s p of linear slip weakening. Slip begins where
/// p_w first takes the strength down to τ₀, at μ_s (p − p_w) = τ₀, spreads with the pressure, and runs away at the length
/// 1.158 G/((1 − ν) W) whatever the width of the patch: the limit of a critically loaded fault (D. I. Garagash, L. N.
/// Germanovich, J. Geophys. Res. 117 (2012) B10310, half-length 0.579 a_w; K. Uenishi, J. R. Rice, J. Geophys. Res. 108
/// (2003) 2042). Here that length is 1; the elements have 1/32 of it.
#[test]
fn an_injected_fault_slips_where_its_strength_is_lost_and_runs_away_at_the_length_of_the_theory() {
    const COLUMNS: usize = 256;
    let (steepest, pressure, tau) = (1.158 / 0.7, 0.01, 0.98);
    let depth = |t: f64| 5.0 * (1.18f64.powf(18.0 * t) - 1.0) / (1.18f64.powi(18) - 1.0);
    let mesh = Blocks::default().block("lower", [COLUMNS, 18], |s, t| [8.0 * s - 4.0, -depth(1.0 - t)]).block(
        "upper",
        [COLUMNS, 18],
        |s, t| [8.0 * s - 4.0, depth(t)],
    );
    let material = json!({"material": {"model": "linear", "E": 2.6, "nu": 0.3}});
    let sides = ["lower_bottom", "lower_left", "lower_right", "upper_top", "upper_left", "upper_right"];
    let supports: Vec<Value> = sides.iter().map(|side| json!({"on": side, "ux": 0, "uy": 0})).collect();
    for width in [0.3, 1.0] {
        let run = Simulation::new(model(&json!({
            "mesh": mesh.json(),
            "bodies": {"lower": material, "upper": material},
            "contacts": {"fault": {
                "slave": "upper_bottom", "master": "lower_top", "method": "node_to_segment", "sliding": "small",
                "normal": {"alpha_n": 1000.0 * steepest},
                // μ_s (p − p_w) = τ₀ in the middle at t = 1.
                "fluid_pressure": format!("t*{}*exp(-(x/{width})^2)", (1.0 - tau) * pressure),
                "friction": {"law": "slip_weakening", "mu_s": 0.5, "mu_d": 0.1, "D_c": 0.4 * pressure / steepest,
                             "alpha_t": 50.0 * steepest},
                "initial": {"pressure": pressure, "traction": 0.5 * pressure * tau, "balanced": true}
            }},
            "steps": [{"name": "inject", "duration": 10, "dt": {"initial": 0.02, "max": 0.02, "min": 1e-5},
                       "supports": supports}],
        })));
        let (mut run, mut begins, mut length) = (run, None, 0.0);
        let stopped = loop {
            match run.next_increment() {
                Ok(Some(increment)) => {
                    let slips = increment.state.contacts[0].iter().filter(|at| at.friction.plastic_slip != 0.0);
                    length = slips.count() as f64 * 8.0 / COLUMNS as f64;
                    begins = begins.or((length > 0.0).then_some(increment.state.time));
                }
                Ok(None) => panic!("it never ran away"),
                Err(error) => break error,
            }
        };
        let begins = begins.expect("it slips");
        println!("patch of {width}: slip begins at {begins}, runs away at a length of {length}");
        assert!(matches!(stopped, Error::IncrementTooSmall { .. }), "{stopped}");
        assert!(begins > 1.0 && begins < 1.0201, "{begins}");
        close("nucleation length", length, 1.0, 0.05);
    }
}
