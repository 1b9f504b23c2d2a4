//! Slip weakening.

use super::*;

#[test]
fn slip_weakens_to_the_dynamic_coefficient_at_any_step_size() {
    let law = weakening(WEAKENING);
    for steps in [1, 2, 3, 50, 1000] {
        // α_t (u − D) = p μ(D), with μ = 0.6 − 0.1 D down to 0.5.
        for (total, slipped) in [(0.406, 400.0 / 999.0), (1.5, 1.495)] {
            let mut state = law.initial_state(0.0, 0.0);
            for _ in 0..steps {
                state = respond(&law, &state, total / f64::from(steps), 10.0, 0.1).state;
            }
            let q = if slipped < 1.0 { 10.0 * (0.6 - 0.1 * slipped) } else { 5.0 };
            assert_close(state.plastic_slip, slipped, 1e-12, "slip");
            assert_close(state.traction, q, 1e-11, "traction");
            assert_close(mu_of(&law, &state), 0.1 * q, 1e-12, "mu");
        }
    }
}

#[test]
fn weakening_counts_slip_to_and_fro_and_never_heals() {
    let law = weakening(WEAKENING);
    let mut state = respond(&law, &law.initial_state(0.0, 0.0), 0.406, 10.0, 1.0).state;
    let (q, slip) = (state.traction, state.plastic_slip);
    state = respond(&law, &state, 0.0, 10.0, 1e9).state;
    assert_close(state.traction, q, 1e-12, "rest");
    state = respond(&law, &state, -0.3, 10.0, 1.0).state;
    let back = slip - state.plastic_slip;
    assert_close(mu_of(&law, &state), 0.6 - 0.1 * (slip + back), 1e-12, "mu after reversal");
    assert_close(state.traction, -10.0 * mu_of(&law, &state), 1e-11, "traction after reversal");
    state = respond(&law, &state, 0.0, 0.0, 1.0).state;
    assert_eq!(state.traction, 0.0, "parted");
    assert_close(mu_of(&law, &state), 0.6 - 0.1 * (slip + back), 1e-12, "parted");
}

#[test]
fn weakening_with_cohesion_and_an_initial_excess() {
    let law = weakening(WEAKENING.cohesion(2.0));
    let state = respond(&law, &law.initial_state(0.0, 0.0), 0.01, 10.0, 1.0).state;
    // 10 is above c + μ_s p = 8: Δλ = 2/(α_t − W p).
    assert_close(state.plastic_slip, 2.0 / 999.0, 1e-15, "slip");
    assert_close(state.traction, 8.0 - 2.0 / 999.0, 1e-12, "traction");
    let over = with!(law.initial_state(0.0, 0.0), traction: 8.5, pressure: 10.0);
    assert_close(respond(&law, &over, 0.0, 10.0, 0.0).state.plastic_slip, 0.5 / 999.0, 1e-15, "excess slips off");
    assert_eq!(law.description().starting_limit(10.0), f64::INFINITY);
}

#[test]
fn weakening_that_outruns_the_contact_snaps_to_the_dynamic_coefficient() {
    let law = weakening(WEAKENING.alpha_t(0.9));
    assert_close(law.description().uniqueness_limit().expect("a limit"), 9.0, 1e-12, "limit");
    let state = respond(&law, &law.initial_state(0.0, 0.0), 7.0, 10.0, 1.0).state;
    assert_eq!((mu_of(&law, &state), state.traction), (0.5, 5.0));
    let just_below = respond(&law, &law.initial_state(0.0, 0.0), 5.99 / 0.9, 10.0, 1.0).state;
    assert_eq!((mu_of(&law, &just_below), just_below.plastic_slip), (0.6, 0.0));
}

#[test]
fn weakening_tangents_are_exact() {
    let mut random = Random(1);
    let mut smooth = 0;
    for k in 0..3000 {
        let law = weakening(WEAKENING.alpha_t(10f64.powf(random.between(-0.3, 3.0))).cohesion(if k % 2 == 0 {
            0.0
        } else {
            random.between(0.0, 3.0)
        }));
        let pressure = random.between(0.1, 20.0);
        let slipped = random.between(0.0, 1.2);
        let start = law.initial_state(0.0, 0.0).with_variables([slipped]);
        let old = with!(start, traction: random.between(-8.0, 8.0), pressure: pressure);
        let slip = random.between(-20.0, 20.0) / law.description().stiffness;
        smooth += usize::from(check_tangents(&law, &old, slip, random.between(0.1, 20.0), 1.0));
    }
    assert!(smooth > 2800, "{smooth}");
}

#[test]
fn weakening_dissipates_what_the_work_leaves() {
    let law = weakening(WEAKENING);
    let (mut state, mut work) = (law.initial_state(0.0, 0.0), 0.0);
    for k in 0..400 {
        let slip = 0.02 * (0.02 * f64::from(k)).cos();
        let new = respond(&law, &state, slip, 10.0, 1.0).state;
        assert!(new.dissipation >= state.dissipation);
        work += 0.5 * (state.traction + new.traction) * slip;
        state = new;
    }
    let stored = state.traction.powi(2) / 2000.0;
    assert!(state.plastic_slip.abs() > 0.1 && mu_of(&law, &state) == 0.5);
    // The trapezoidal work of an increment in which slip sets in or turns round is not exact.
    assert_close(state.dissipation + stored, work, 2e-3 * work, "energy");
}

/// ∫ (c + μ(D) p) dD at constant pressure: the dissipation of slip to and fro depends on the slip alone, and one increment
/// with a reversal inside books the same as a thousand.
#[test]
fn weakening_dissipates_the_strength_over_the_slip() {
    let law = weakening(WEAKENING.cohesion(1.5));
    let turns = [0.3, -0.2, 0.4, -0.6, 0.5, 0.0];
    let points: Vec<[f64; 2]> = [0.0].iter().chain(&turns).map(|u| [*u, 10.0]).collect();
    for parts in [1, 2, 3, 7, 1000] {
        let state = strokes(&law, &points, parts, 1.0);
        // After the first slip to the strength, α_t Δλ = α_t |Δu| − (the strengths before and after), stroke by stroke.
        let (mut slipped, mut strength, mut at) = (0.0, 0.0, 0.0);
        let mut work = 0.0;
        for turn in turns {
            let elastic = 1000.0 * f64::abs(turn - at) - strength;
            let before = 1.5 + 10.0 * (0.6 - 0.1 * slipped);
            let weak = (elastic - before) / 999.0;
            let slip = if slipped + weak < 1.0 { weak } else { (elastic - 6.5) / 1000.0 };
            let weak = slip.min(1.0 - slipped);
            work += weak * (before - 0.5 * weak) + (slip - weak) * 6.5;
            slipped = (slipped + slip).min(1.0);
            strength = 1.5 + 10.0 * (0.6 - 0.1 * slipped);
            at = turn;
        }
        assert_close(state.dissipation, work, 1e-12 * work, &format!("{parts} parts"));
        assert!(mu_of(&law, &state) == 0.5, "all strokes weaken");
    }
}

/// Along straight lines of slip and pressure the answer is exact, and so is the dissipation: many increments book the same
/// as one, and the trapezoidal rule tends to it.
#[test]
fn weakening_dissipates_the_same_in_one_increment_as_in_many() {
    let law = weakening(with!(WEAKENING.cohesion(0.5), critical_slip: 0.05));
    let cases = [
        [[0.0, 10.0], [0.02, 14.0]],
        [[0.0, 10.0], [0.04, 4.0]],
        [[0.0, 10.0], [0.3, 25.0]],
        [[0.0, 0.0], [0.03, 12.0]],
        [[0.0, 0.0], [0.3, 12.0]],
    ];
    for line in cases {
        let one = strokes(&law, &line, 1, 1.0);
        for parts in [2, 5, 1000] {
            let many = strokes(&law, &line, parts, 1.0);
            assert_close(many.traction, one.traction, 1e-11, "traction");
            let what = format!("{line:?} in {parts}");
            assert_close(many.dissipation, one.dissipation, 1e-12 * one.dissipation, &what);
        }
        let (parts, mut old, mut work) = (200_000, with!(law.initial_state(0.0, 0.0), pressure: line[0][1]), 0.0);
        for k in 1..=parts {
            let share = f64::from(k) / f64::from(parts);
            let slip = line[1][0] / f64::from(parts);
            let new = respond(&law, &old, slip, line[0][1] + share * (line[1][1] - line[0][1]), 1.0).state;
            work += 0.5 * (old.traction + new.traction) * slip;
            old = new;
        }
        let stored = one.traction.powi(2) / 2000.0;
        assert_close(one.dissipation + stored, work, 1e-8 * work, &format!("{line:?}: work"));
    }
}

/// A traction above the strength by a rounding, or by much, is no other path: the dissipation is that of slip off at once, and then of
/// the rest in a thousand increments.
#[test]
fn weakening_dissipates_the_same_from_above_the_strength() {
    let law = weakening(with!(WEAKENING.cohesion(0.5), critical_slip: 0.05));
    let at = |above: f64| with!(law.initial_state(0.0, 0.0), traction: 6.5 + above, pressure: 10.0);
    for [slip, pressure] in [[0.02, 14.0], [0.04, 4.0], [0.3, 25.0], [0.3, 9.0]] {
        let smooth = respond(&law, &at(-1e-9), slip, pressure, 1.0).state.dissipation;
        for rounding in [-1e-15, 0.0, 1e-15, 1e-12] {
            let one = respond(&law, &at(rounding), slip, pressure, 1.0).state.dissipation;
            assert_close(one, smooth, 1e-7 * smooth, &format!("{slip} {pressure} {rounding:e}"));
        }
        for above in [0.5, 3.0] {
            let one = respond(&law, &at(above), slip, pressure, 1.0).state;
            let mut many = respond(&law, &at(above), 0.0, 10.0, 0.0).state;
            for k in 1..=1000 {
                let pressure = 10.0 + f64::from(k) / 1000.0 * (pressure - 10.0);
                many = respond(&law, &many, slip / 1000.0, pressure, 1e-3).state;
            }
            let what = format!("{slip} {pressure} from {above} above");
            assert_close(one.traction, many.traction, 1e-11, &what);
            assert_close(one.dissipation, many.dissipation, 1e-11 * many.dissipation, &what);
        }
    }
}

/// Parameters may change between increments: μ = max(μ_s − W D, μ_d) with those of now, and D of all slip.
#[test]
fn weakening_counts_its_slip_whatever_the_parameters_are() {
    let first = weakening(with!(WEAKENING, mu_s: 0.8, mu_d: 0.2));
    let slid = respond(&first, &first.initial_state(0.0, 0.0), 0.258, 10.0, 1.0).state;
    // 1000 (0.258 − D) = 10 (0.8 − 0.6 D)
    assert_close(slid.plastic_slip, 250.0 / 994.0, 1e-14, "D");
    for (mu_s, mu_d, critical_slip) in [(0.6, 0.2, 1.0), (0.9, 0.1, 0.5), (0.4, 0.39, 0.1)] {
        let then = weakening(with!(WEAKENING, mu_s: mu_s, mu_d: mu_d, critical_slip: critical_slip));
        let mu = f64::max(mu_s - (mu_s - mu_d) / critical_slip * 250.0 / 994.0, mu_d);
        assert_close(mu_of(&then, &slid), mu, 1e-14, "mu");
    }
}

/// A snap releases what the contact had stored: nothing is lost from the account.
#[test]
fn a_snap_dissipates_what_it_releases() {
    let law = weakening(WEAKENING.alpha_t(0.9));
    // Elastic up to 6, down to 5 at once, and on at 5.
    let work = 0.5 * 6.0 * 6.0 / 0.9 + 5.0 * (7.0 - 6.0 / 0.9);
    for parts in [1, 2, 1000] {
        let state = strokes(&law, &[[0.0, 10.0], [7.0, 10.0]], parts, 1.0);
        assert_close(state.dissipation + 0.5 * 25.0 / 0.9, work, 1e-12 * work, "work");
    }
}
