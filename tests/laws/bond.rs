//! A bond beside Coulomb friction at one point, against closed forms, differences and the first law.
//!
//! The point has the gap g and the slip u, p = α_n⟨−g⟩ − T and q = q_f + q_b. Lengths are in mm, stresses in kPa, work in J/m².

use super::random::Random;
use crate::common::close;
use fecontact::laws::friction::{
    Bond, BondParameters, BondState, BondSurfaces, ContactLaw, Coulomb, CoulombParameters, FrictionState, Sliding,
};

/// A point of an interface.
struct Point {
    bond: Bond,
    friction: Option<ContactLaw>,
    alpha_n: f64,
    states: (BondState, FrictionState),
    /// g, u, p, q
    at: [f64; 4],
    work: f64,
    dissipated: f64,
}

/// p, q and their derivatives by g and Δu.
type Answered = ([f64; 2], [[f64; 2]; 2], (BondState, FrictionState), f64);

impl Point {
    fn new(parameters: BondParameters, mu: f64, [alpha_n, alpha_t]: [f64; 2]) -> Self {
        let surfaces = BondSurfaces::new(alpha_n, alpha_t, mu);
        let bond = Bond::new(&parameters, surfaces).expect("allowed");
        let coulomb = |mu: f64| Coulomb::new(&CoulombParameters::new(mu), alpha_t).expect("allowed");
        let beside = |law: Coulomb| ContactLaw::from(law).bonded(&parameters, surfaces).expect("allowed");
        let states = (bond.start(None, 0.0), FrictionState::default());
        let friction = (mu > 0.0).then(|| beside(coulomb(mu)));
        Self { bond, friction, alpha_n, states, at: [0.0; 4], work: 0.0, dissipated: 0.0 }
    }

    /// The same, bonded over a gap.
    fn across(parameters: BondParameters, mu: f64, stiff: [f64; 2], gap: f64) -> Self {
        let mut parameters = parameters;
        parameters.bonded = true;
        let new = Self::new(parameters, mu, stiff);
        Self { states: (new.bond.start(Some(gap), 0.0), new.states.1.clone()), at: [gap, 0.0, 0.0, 0.0], ..new }
    }

    fn answer(&self, gap: f64, slip: f64) -> Answered {
        let own = self.bond.respond(&self.states.0, gap.max(0.0), slip, false);
        let pressure = (-self.alpha_n * gap).max(0.0);
        let stiff = if gap < 0.0 { -self.alpha_n } else { 0.0 };
        let mut limited = false;
        let friction = self.friction.as_ref().map(|law| {
            let sliding = Sliding::new(slip, pressure, 0.1);
            let mut answer = law.respond(&self.states.1, sliding).expect("an answer");
            limited = pressure > 0.0 && law.limit(&self.states.1, &mut answer, own.state.traction);
            answer
        });
        let (q, by_slip, by_pressure) = friction.as_ref().map_or((0.0, 0.0, 0.0), |answer| {
            (answer.state.traction, answer.dtraction_dslip, answer.dtraction_dpressure)
        });
        let after = friction.map_or(FrictionState::default(), |answer| answer.state);
        let dissipated = own.dissipation + after.dissipation - self.states.1.dissipation;
        let of_bond = if limited { [0.0; 2] } else { own.dtraction };
        let tangent =
            [[stiff - own.dtension[0], -own.dtension[1]], [by_pressure * stiff + of_bond[0], by_slip + of_bond[1]]];
        ([pressure - own.state.tension, q + own.state.traction], tangent, (own.state, after), dissipated)
    }

    /// Moves to a gap and a slip in some steps.
    fn go(&mut self, [gap, slip]: [f64; 2], steps: usize) -> [f64; 2] {
        let [from, start, ..] = self.at;
        for k in 1..=steps {
            let share = k as f64 / steps as f64;
            let (g, u) = (from + share * (gap - from), start + share * (slip - start));
            let [old_g, old_u, old_p, old_q] = self.at;
            let ([p, q], _, states, dissipated) = self.answer(g, u - old_u);
            self.work += 0.5 * (q + old_q) * (u - old_u) - 0.5 * (p + old_p) * (g - old_g);
            assert!(dissipated >= 0.0, "nothing is gained: {dissipated}");
            self.dissipated += dissipated;
            (self.states, self.at) = (states, [g, u, p, q]);
        }
        [self.at[2], self.at[3]]
    }

    /// Energy in the springs.
    fn stored(&self, alpha_t: f64) -> f64 {
        let [gap, _, _, q] = self.at;
        let (own, _) = &self.states;
        let normal = if gap < 0.0 { 0.5 * self.alpha_n * gap * gap } else { 0.5 * own.tension * (gap - own.rest) };
        normal + 0.5 * (own.traction.powi(2) + (q - own.traction).powi(2)) / alpha_t
    }
}

const STIFF: [f64; 2] = [1e6, 1e6];

/// What fades over an opening returns, c_r = c: q = c (1 − w/δ) in each leg of slip.
#[test]
fn shear_fades_over_an_opening_and_returns() {
    let mut point = Point::new(BondParameters::new(10.0).opening(10.0), 0.0, STIFF);
    let legs = [(0.0, 10.0), (5.0, 10.0), (5.0, 20.0), (20.0, 20.0), (20.0, 30.0), (0.0, 30.0), (0.0, 40.0)];
    let found = legs.map(|(gap, slip)| point.go([gap, slip], 100)[1]);
    for (found, expected) in found.into_iter().zip([10.0, 5.0, 5.0, 0.0, 0.0, 0.0, 10.0]) {
        close("q", found, expected, 1e-9);
    }
}

/// c − c_r is lost by opening and by slip, κ = w/δ + Λ/D; c_r (1 − w/δ) returns.
#[test]
fn what_is_above_the_residual_does_not_return() {
    let parameters = BondParameters::new(10.0).residual(4.0).slip(20.0).opening(1.0);
    let mut point = Point::new(parameters, 0.0, STIFF);
    let q = point.go([0.0, 0.1], 200)[1];
    close("closed", q, 6.0 * (1.0 - 0.1 / 20.0) + 4.0, 1e-5);
    let mut slip = 0.1;
    for (gap, expected) in [
        (0.5, 6.0 * (1.0 - 0.5 - 1.1 / 20.0) + 2.0),
        (0.0, 6.0 * (1.0 - 0.5 - 2.1 / 20.0) + 4.0),
        (2.0, 0.0),
        (0.0, 4.0),
    ] {
        point.go([gap, slip], 1);
        slip += 1.0;
        let q = point.go([gap, slip], 200)[1];
        close("q", q, expected, 1e-4);
    }
}

/// Pull-off takes t δ/2, shear at zero pressure c D/2; their mixture depends on the path:
///
/// ```text
/// open 5, then slip:   t ∫₀⁵ (1 − w/10) dw + (c − μ t) ∫₀¹⁰ (½ − Λ/20) dΛ = 11.25 + 22.75
/// slip 10, then open:  c ∫₀¹⁰ (1 − Λ/20) dΛ + t ∫₀⁵ (½ − w/10) dw = 75 + 3.75
/// straight, w = 0.4 u: (c − μ t + 0.4 t) ∫ (1 − 0.09 u) du = 10.3/0.18
/// ```
#[test]
fn fracture_takes_the_work_of_its_path() {
    let parameters = BondParameters::new(10.0).slip(20.0).tension(3.0).opening(10.0);
    let run = |mu: f64, path: &[[f64; 2]]| {
        let mut point = Point::new(parameters, mu, STIFF);
        let mut peak = [0.0f64; 2];
        for end in path {
            for k in 1..=20 {
                let from = [point.at[0], point.at[1]];
                let share = 1.0 / f64::from(21 - k);
                let [p, q] = point.go([0, 1].map(|i| from[i] + share * (end[i] - from[i])), 200);
                peak = [peak[0].max(-p), peak[1].max(q)];
            }
        }
        // The means of the tractions over the first step, in which they rise to t within w_e, are too low by half of it.
        close("first law", point.work, point.dissipated + point.stored(STIFF[1]), 0.05);
        (point.work, peak)
    };
    let (work, _) = run(0.3, &[[12.0, 0.0]]);
    close("pull-off", work, 15.0, 6e-3);
    let mut point = Point::new(parameters, 0.3, STIFF);
    close("peak of pull-off", -point.go([3e-6, 0.0], 100)[0], 3.0, 1e-6);
    let (work, peak) = run(0.3, &[[0.0, 30.0]]);
    close("shear", work, 100.0, 0.05);
    assert!(peak[1] <= 10.0, "{peak:?}");
    let mixed = [
        (34.0, vec![[5.0, 0.0], [5.0, 30.0], [12.0, 30.0]]),
        (78.75, vec![[0.0, 10.0], [12.0, 10.0], [12.0, 30.0]]),
        (10.3 / 0.18, vec![[12.0, 30.0]]),
    ];
    for (expected, path) in mixed {
        close("mixed", run(0.3, &path).0, expected, 2e-3 * expected);
    }
}

/// What is bonded over a gap has no stress there; farther apart it takes t ∫ (1 − w/δ) dw, and it resists no closing.
#[test]
fn a_bond_over_a_gap_begins_without_stress() {
    let mut point = Point::across(BondParameters::new(10.0).tension(3.0).opening(10.0), 0.3, STIFF, 4.0);
    close("at the start", point.go([4.0, 0.0], 1)[0], 0.0, 1e-15);
    close("closing", point.go([2.0, 0.0], 100)[0], 0.0, 1e-15);
    close("at the start again", point.go([4.0, 0.0], 100)[0], 0.0, 1e-15);
    close("peak", -point.go([4.0 + 3e-6, 0.0], 10)[0], 3.0 * 0.6, 1e-5);
    point.go([7.0, 0.0], 1000);
    close("secant", -point.go([5.5, 0.0], 1000)[0], 0.5 * 3.0 * 0.3, 1e-5);
    point.go([12.0, 0.0], 4000);
    close("work", point.work, 3.0 * 0.6 * 6.0 / 2.0, 6e-3);
    close("first law", point.work, point.dissipated, 6e-3);
}

/// One straight line of strength, c + μ p from pressure into tension.
#[test]
fn the_line_of_strength_is_straight_into_tension() {
    let parameters = BondParameters::new(10.0).tension(3.0).opening(10.0);
    let strength = |gap: f64| {
        let mut point = Point::new(parameters, 0.3, STIFF);
        point.go([gap, 0.0], 1);
        point.go([gap, 1.0], 1)
    };
    let [p, q] = strength(2e-6);
    close("T", -p, 2.0, 1e-9);
    close("q", q, 9.4, 1e-9);
    let [p, q] = strength(-50e-6);
    close("p", p, 50.0, 1e-9);
    close("q", q, 25.0, 1e-9);
}

/// The limit cuts friction and bond together, min(c + μ p, τ_max).
#[test]
fn the_limit_is_that_of_the_sum() {
    for (p, expected) in [(0.0, 10.0), (10.0, 15.0), (20.0, 20.0), (30.0, 20.0), (100.0, 20.0)] {
        let mut point = Point::new(BondParameters::new(10.0).limit(20.0).opening(10.0), 0.5, STIFF);
        for slip in [1.0, 2.0, -3.0] {
            let q = point.go([-1e-6 * p, slip], 50)[1];
            close("min(c + mu p, limit)", q, if slip > 0.0 { expected } else { -expected }, 1e-9);
        }
    }
}

/// Constant normal stiffness, p = 50 + u: q = c ⟨1 − u/D⟩ + μ p.
#[test]
fn a_softening_bond_under_constant_normal_stiffness() {
    let mut point = Point::new(BondParameters::new(5.0).slip(10.0).opening(1.0), 0.5, [1e8, 1e8]);
    point.go([-50e-8, 0.0], 1);
    for (slip, expected) in [(5.0, 30.0), (20.0, 35.0)] {
        let q = point.go([-(50.0 + slip) * 1e-8, slip], 400)[1];
        close("q", q, expected, 1e-3);
    }
}

/// Some bond of every kind.
fn some(draw: &mut Random) -> BondParameters {
    let parameters = BondParameters::new(10.0).residual([0.0, 4.0, 10.0][(3.0 * draw.unit()) as usize]).opening(10e-3);
    let parameters = if draw.chance(0.5) { parameters.slip(20e-3) } else { parameters };
    let parameters = if draw.chance(0.5) { parameters.tension(3.0) } else { parameters };
    if draw.chance(0.5) { parameters.limit(draw.between(10.0, 16.0)) } else { parameters }
}

/// The tangent is that of the values, by central differences, but at kinks.
#[test]
fn the_tangent_is_that_of_the_values() {
    let mut draw = Random(1);
    let (mut kinks, stiff) = (0, [1e4, 5e3]);
    for _ in 0..400 {
        let mut point = Point::new(some(&mut draw), 0.3, stiff);
        for _ in 0..5 {
            let [gap, slip] = [draw.between(-4e-3, 11e-3), draw.between(-6e-3, 6e-3)];
            let (_, tangent, states, _) = point.answer(gap, slip);
            let e = 1e-9;
            let along = |[dg, du]: [f64; 2]| {
                let [up, down] = [e, -e].map(|e| point.answer(gap + dg * e, slip + du * e).0);
                [0, 1].map(|i| (up[i] - down[i]) / (2.0 * e))
            };
            let [by_gap, by_slip] = [along([1.0, 0.0]), along([0.0, 1.0])];
            let off = (0..2).flat_map(|i| [by_gap[i] - tangent[i][0], by_slip[i] - tangent[i][1]]);
            kinks += usize::from(off.map(f64::abs).fold(0.0, f64::max) > 1e-4 * stiff[0]);
            point.states = states;
        }
    }
    assert!(kinks <= 1, "{kinks} of 2000 states are off");
}

/// p and q are continuous in the gap at closure, at w_e, at the largest opening so far and at δ.
#[test]
fn tractions_are_continuous_in_the_gap() {
    let mut draw = Random(2);
    for _ in 0..200 {
        let mut point = Point::new(some(&mut draw), 0.3, [1e4, 5e3]);
        point.go([draw.between(-2e-3, 9e-3), draw.between(0.0, 5e-3)], 3);
        let slip = draw.between(-6e-3, 6e-3);
        for gap in [0.0, 3e-4, point.states.0.opened, 10e-3] {
            let [below, above] = [-1e-12, 1e-12].map(|e| point.answer(gap + e, slip).0);
            (0..2).for_each(|i| assert!((below[i] - above[i]).abs() < 1e-6, "{below:?} {above:?} at {gap}"));
        }
    }
}

/// No path gains energy: its work is never below what is stored, and what is dissipated is the difference.
#[test]
fn no_path_gains_energy() {
    let mut draw = Random(3);
    for _ in 0..100 {
        let stiff = [1e4, 5e3];
        let parameters = some(&mut draw);
        let mut point = match draw.chance(0.3) {
            true => Point::across(parameters, 0.3, stiff, draw.between(0.0, 9e-3)),
            false => Point::new(parameters, 0.3, stiff),
        };
        let mut corners: Vec<[f64; 2]> =
            (0..6).map(|_| [draw.between(-4e-3, 12e-3), draw.between(-10e-3, 10e-3)]).collect();
        corners.push(corners[0]);
        for corner in corners {
            let start = [point.at[0], point.at[1]];
            for k in 1..=10 {
                let share = f64::from(k) / 10.0;
                point.go([0, 1].map(|i| start[i] + share * (corner[i] - start[i])), 40);
                let over = point.work - point.stored(stiff[1]);
                assert!(over > -1e-6, "gains {over}");
                assert!((over - point.dissipated).abs() < 2e-3, "{over} is not {}", point.dissipated);
            }
        }
    }
}

/// An initial traction is shared in proportion to the strengths; what exceeds c is friction's, whatever is known of its strength.
#[test]
fn an_initial_traction_is_shared() {
    let bond = Bond::new(&BondParameters::new(4.0).opening(1.0), BondSurfaces::new(1e4, 1e4, 0.5)).expect("allowed");
    for (traction, of_friction, expected) in
        [(5.0, 6.0, 2.0), (-5.0, 6.0, -2.0), (3.0, 0.0, 3.0), (30.0, 0.0, 4.0), (-30.0, 0.0, -4.0), (30.0, 25.0, 4.0)]
    {
        close("share", bond.share(traction, of_friction), expected, 1e-12);
    }
}

/// What cannot be is refused with what it means.
#[test]
fn numbers_out_of_range_are_refused() {
    let surfaces = BondSurfaces::new(1e4, 1e4, 0.5);
    for (parameters, key, word) in [
        (BondParameters::new(0.0).opening(1.0), "bond.strength", "positive"),
        (BondParameters::new(1.0).residual(2.0).opening(1.0), "bond.residual", "between"),
        (BondParameters::new(1.0).tension(3.0).opening(1.0), "bond.tension", "c/mu = 2"),
        (BondParameters::new(1.0).slip(0.0).opening(1.0), "bond.slip", "positive"),
        (BondParameters::new(1.0).slip(5e-5).opening(1.0), "bond.slip", "alpha_t"),
        (BondParameters::new(1.0).tension(1.0).opening(1.5e-4), "bond.opening", "twice"),
        (BondParameters::new(1.0).opening(0.0), "bond.opening", "positive"),
        (BondParameters::new(1.0).opening(1.0).limit(0.5), "bond.limit", "strength"),
    ] {
        let refused = Bond::new(&parameters, surfaces).expect_err(key);
        assert!(refused.name == key && refused.allowed.contains(word), "{refused}");
    }
}
