//! What super/subloading friction and Coulomb friction dissipate.

use super::*;

#[test]
fn coulomb_loops_dissipate_their_area() {
    let law = Coulomb::new(&CoulombParameters::new(0.2), 1000.0).expect("valid parameters");
    let (limit, amplitude) = (0.2 * PRESSURE, 0.1);
    let turns = [0.0, 1.0, -1.0, 1.0, -1.0, 1.0].map(|turn| [turn * amplitude, PRESSURE]);
    for parts in [1, 2, 3, 7, 1000] {
        // The first stroke, and four times half of the parallelogram.
        let work = limit * (amplitude - limit / 1000.0) + 4.0 * 2.0 * limit * (amplitude - limit / 1000.0);
        let state = strokes(&law, &turns, parts, 1.0);
        assert_close(state.dissipation, work, 1e-12 * work, &format!("{parts} increments a stroke"));
    }
    // The pressure falls with the slip to the right, from p to p/2: the traction is elastic up to u_y, and then on the
    // strength, along which dλ = du + μ |dp|/α_t.
    let turns = [[0.0, PRESSURE], [amplitude, 0.5 * PRESSURE], [0.0, PRESSURE]];
    let fall = 0.2 * 0.5 * PRESSURE / amplitude;
    let at_first = limit / (1000.0 + fall);
    let there = 0.5 * (1000.0 * at_first + 0.5 * limit) * (amplitude - at_first) * (1.0 + fall / 1000.0);
    // Back: −q = α_t s − μ p/2 meets μ p (1 + s/A)/2 at s after the turn.
    let turned = limit / (1000.0 - fall);
    let back = 0.5 * (1000.0 * turned - 0.5 * limit + limit) * (amplitude - turned) * (1.0 - fall / 1000.0);
    for parts in [1, 2, 3, 7, 1000] {
        let state = strokes(&law, &turns, parts, 1.0);
        assert_close(state.dissipation, there + back, 1e-12 * (there + back), &format!("{parts}, pressure varies"));
    }
}

/// Along straight lines of slip and pressure Coulomb friction is integrated exactly: one increment, whatever happens inside,
/// is seven.
#[test]
fn coulomb_increments_add_up() {
    let law = Coulomb::new(&CoulombParameters::new(0.3), 1000.0).expect("valid parameters");
    let mut random = Random(5);
    let mut slid = 0;
    for _ in 0..20_000 {
        let pressure = [random.magnitude(-3.0, 2.0), random.magnitude(-3.0, 2.0)];
        let traction = 0.3 * pressure[0] * random.between(-1.0, 1.0);
        let old = with!(law.initial_state(0.0, 0.0), traction: traction, pressure: pressure[0]);
        let slip = random.sign() * random.magnitude(-6.0, 0.0);
        let one = respond(&law, &old, slip, pressure[1], 1.0).state;
        let many = (1..=7).fold(old, |old, k| {
            let now = pressure[0] + f64::from(k) / 7.0 * (pressure[1] - pressure[0]);
            respond(&law, &old, slip / 7.0, now, 1.0).state
        });
        let scale = traction.abs() + 1000.0 * slip.abs() + pressure[0].max(pressure[1]);
        assert_close(many.traction, one.traction, 1e-13 * scale, "q");
        assert_close(many.dissipation, one.dissipation, 1e-13 * scale * scale / 1000.0, "dissipation");
        slid += usize::from(one.dissipation > 0.0);
    }
    assert!(slid > 5000, "{slid}");
}

/// κ = ξ = 0: between q = 0 and R the slip u = R μ p/α_t − li(R)/r dissipates μ p ∫ R dλ = −μ p li(R²)/r.
#[test]
fn super_subloading_loops_dissipate_their_closed_form() {
    let strength = 0.2 * PRESSURE;
    for integration in [Integration::BackwardEuler, Integration::Controlled] {
        let law = law(&CONSTANT.integration(integration));
        for parts in [1, 2, 3, 7, 100] {
            let (mut points, mut work, mut before, mut at) = (vec![[0.0, PRESSURE]], 0.0, 0.0, 0.0);
            for (k, ratio) in [0.6, 0.9, 0.99, 0.5, 0.999, 0.95].into_iter().enumerate() {
                let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
                at += sign * (strength * (ratio + before) / 1000.0 + minus_li(ratio) / 100.0);
                points.push([at, PRESSURE]);
                work += strength * minus_li(ratio * ratio) / 100.0;
                before = ratio;
            }
            let state = strokes(&law, &points, parts, 1.0);
            assert_close(state.traction, -0.95 * strength, 1e-10 * strength, "q");
            assert_close(state.dissipation, work, 1e-12 * work, &format!("{integration:?}, {parts} parts"));
        }
    }
}

/// With weakening, recovery, exponents and a pressure that varies: one increment a stroke under error control against 4000
/// with a much smaller tolerance, and those against the trapezoidal ∮ q du.
#[test]
fn controlled_increments_dissipate_the_work_of_their_path() {
    let base = PAPER.integration(Integration::Controlled).xi(0.05);
    let variants =
        [base, base.exponents(1.5, 0.7).elastic_core(0.2), base.approach(Approach::Cotangent).structure(1.3)];
    let points = [[0.0, 60.0], [0.12, 80.0], [-0.1, 90.0], [0.15, 50.0], [0.0, 70.0]];
    for parameters in variants {
        let fine_law = law(&parameters.tolerance(1e-10));
        let (mut old, mut work, parts) = (with!(fine_law.initial_state(0.0, 0.0), pressure: 60.0), 0.0, 4000);
        for stroke in points.windows(2) {
            let [[u0, p0], [u1, p1]] = [stroke[0], stroke[1]];
            for k in 1..=parts {
                let slip = (u1 - u0) / f64::from(parts);
                let pressure = p0 + f64::from(k) / f64::from(parts) * (p1 - p0);
                let new = respond(&fine_law, &old, slip, pressure, 2.0 / f64::from(parts)).state;
                assert!(new.dissipation >= old.dissipation);
                work += 0.5 * (old.traction + new.traction) * slip;
                old = new;
            }
        }
        let stored = old.traction.powi(2) / 2000.0;
        assert_close(old.dissipation + stored, work, 1e-5 * work, "the trapezoidal rule");
        for parts in [1, 2, 5] {
            let state = strokes(&law(&parameters), &points, parts, 2.0);
            // The mean of q is right to the tolerance 1e-6 μ_s p, along 0.64 of slip.
            assert_close(state.dissipation, old.dissipation, 4.0 * 1e-6 * 0.4 * 90.0 * 0.64, &format!("{parts} parts"));
        }
    }
}

/// Under a soft contact the traction snaps: what the contact had stored is dissipated, and one increment a stroke books
/// ∮ q du of many.
#[test]
fn a_snap_dissipates_what_it_releases() {
    let parameters = with!(PAPER.alpha_t(200.0).integration(Integration::Controlled).xi(0.0), r: 2000.0);
    let law = law(&parameters);
    let (mut old, mut work, parts) = (with!(law.initial_state(0.0, 0.0), pressure: PRESSURE), 0.0, 20_000);
    let mut snapped = 0.0f64;
    for _ in 0..parts {
        let slip = 0.4 / f64::from(parts);
        let new = respond(&law, &old, slip, PRESSURE, 0.0).state;
        work += 0.5 * (old.traction + new.traction) * slip;
        snapped = snapped.max(old.traction - new.traction);
        old = new;
    }
    assert!(snapped > 2.0, "the traction falls by {snapped} at most");
    let stored = |state: &FrictionState| state.traction.powi(2) / 400.0;
    assert_close(old.dissipation + stored(&old), work, 1e-4 * work, "many");
    let one = strokes(&law, &[[0.0, PRESSURE], [0.4, PRESSURE]], 1, 0.0);
    assert_close(one.dissipation + stored(&one), work, 1e-4 * work, "one");
}
