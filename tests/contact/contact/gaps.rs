//! Tangents where surfaces carry tractions over a gap, by dilatancy, bonds or a closed start.

use super::mortar::check_mortar_tangent;
use super::*;

/// A contact that starts closed across a gap, its slave edges or points of no edge: the traction is that of the pressure
/// it starts with, and its tangent turns about a foot that lies apart.
#[test]
fn tangent_equals_differences_where_contact_starts_closed_across_a_gap() {
    let (edges, mut x) = wavy();
    x[6..].iter_mut().for_each(|slave| slave.y += 0.2);
    let lone = [6, 7, 8].map(|node| lone_point(node, 0.7)).to_vec();
    let plane = Plane { point: Vector2::new(0.0, -0.5), normal: Vector2::new(-0.2, 1.0).normalize() };
    for points in [lone, gauss_points(&[vec![6, 7], vec![7, 8]], 2)] {
        for master in [Master::Mesh(Surface::new(&edges)), Master::Rigid(Shape::Plane(plane).into())] {
            let mut pair = pair(points.clone(), master, SUPER);
            let at = displaced(&x);
            pair.start_closed(vec![InitialTraction { pressure: 20.0, traction: 2.0 }; pair.points.len()], &at)
                .expect("a foot for each");
            for k in 0..pair.points.len() {
                let (state, contribution) = evaluate(&pair, k, &pair.initial_states(&at)[k], &x);
                let FrictionState { pressure, traction, .. } = state.friction;
                assert!((pressure - 20.0).abs() < 1e-12 && (traction - 2.0).abs() < 1e-12, "{state:?}");
                assert!((state.gap + 0.02).abs() < 1e-15, "{state:?}");
                let force = contribution.expect("a closed point").force;
                let size = pair.points[k].current_length(&at) * 20.0f64.hypot(2.0);
                let slave = pair.points[k].position.len();
                let total =
                    force.as_slice()[..2 * slave].chunks(2).map(|f| Vector2::new(f[0], f[1])).sum::<Vector2<f64>>();
                assert!((total.norm() - size).abs() < 1e-12 * size, "{total}");
                for (back, what) in [(1e-4, "stick"), (0.3, "full slip"), (-1.4, "backward slip over two segments")] {
                    let old = pulled(&pair, k, &x, back, state.friction.clone(), state.gap);
                    check_tangent(&pair, k, &old, &x, &format!("closed across a gap, {what}"));
                }
            }
        }
    }
}

/// Friction by which the surfaces ride up, opening with slip and less so under pressure: every part of its tangent is at work.
///
/// ```text
/// q = q₀ + α_t Δu (1 + p/P),   d = d₀ + s Δu²/(1 + p/P)
/// ```
#[derive(Debug)]
struct RidesUp {
    alpha_t: f64,
    rise: f64,
    pressure: f64,
}

impl FrictionLaw for RidesUp {
    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Answer {
        let Sliding { slip, pressure, .. } = sliding.checked()?;
        if pressure <= 0.0 {
            return FrictionResponse::elastic(old.parted(self.alpha_t), 0.0).checked(self.alpha_t);
        }
        let grip = 1.0 + pressure / self.pressure;
        let state = old.stuck(old.traction + self.alpha_t * slip * grip, pressure);
        FrictionResponse {
            state: FrictionState { opening: old.opening + self.rise * slip.powi(2) / grip, ..state },
            dtraction_dslip: self.alpha_t * grip,
            dtraction_dpressure: self.alpha_t * slip / self.pressure,
            dopening_dslip: 2.0 * self.rise * slip / grip,
            dopening_dpressure: -self.rise * slip.powi(2) / grip.powi(2) / self.pressure,
            evaluations: 0,
        }
        .checked(self.alpha_t)
    }

    fn description(&self) -> Description {
        Description { stiffness: self.alpha_t, opening: &["dilation"], ..Description::default() }
    }
}

/// A law that opens the interface raises the pressure by α_n times the opening, under the pressure that it then has; the tangent
/// of force and moment follows, point by point, after touch, and by mortar.
#[test]
fn a_law_that_dilates_presses_and_its_tangent_equals_differences() {
    let rides_up = || vec![Arc::new(RidesUp { alpha_t: 700.0, rise: 0.4, pressure: 30.0 }.into())];
    let (edges, x) = wavy();
    let points = gauss_points(&[vec![6, 7], vec![7, 8]], 3);
    let points = ContactPair { laws: rides_up(), ..pair(points, Master::Mesh(Surface::new(&edges)), COULOMB) };
    let pressed = FrictionState { opening: 0.004, ..points.laws[0].law.initial_state(0.0, 0.0).loaded(20.0, 2.0) };
    let mut closed = 0;
    for k in 0..points.points.len() {
        for (back, gap) in [(0.01, -0.02), (0.2, -0.02), (-0.2, -0.02), (0.2, 0.03)] {
            let friction =
                if gap > 0.0 { FrictionState { opening: 0.004, ..Default::default() } } else { pressed.clone() };
            let old = pulled(&points, k, &x, back, friction, gap);
            let (state, contribution) = evaluate(&points, k, &old, &x);
            if contribution.is_none() {
                continue;
            }
            closed += 1;
            let FrictionState { pressure, opening, .. } = state.friction;
            assert!((pressure - 1000.0 * (opening - state.gap)).abs() < 1e-11 * pressure, "{pressure}, {opening}");
            assert!(gap > 0.0 || opening > 0.004, "{opening}");
            check_tangent(&points, k, &old, &x, &format!("slip {back} from {gap}"));
        }
    }
    assert!(closed > 8, "{closed} answers were tested");

    let (points, mortar) = mortar_points(&[vec![6, 7], vec![7, 8]], Hats::OfEdges, &x);
    let surface = Surface::new(&edges);
    let averaged = ContactPair { laws: rides_up(), ..pair(points, Master::Mesh(surface.clone()), COULOMB) };
    let before: Positions =
        x.iter().enumerate().map(|(k, x)| Vector2::new(if k < 6 { x.x } else { x.x - 0.1 }, x.y)).collect();
    let tested = (0..averaged.points.len())
        .filter(|&k| check_mortar_tangent(&averaged, &mortar, &surface, k, &before, -0.02, &x))
        .count();
    assert!(tested > 0, "no node was closed");
}

/// Points that are open and carry shear and tension, and bonds at closed ones, whatever slip counts: the tangent is that of differences.
#[test]
fn tangent_equals_differences_over_a_gap() {
    use fecontact::laws::friction::{BondParameters, BondState, BondSurfaces, ContactLaw};
    let (edges, mut x) = wavy();
    let bonded = |law: &str, bond: BondParameters| -> ContactLaw {
        let law = serde_json::from_str::<FrictionParameters>(law).expect("a law").build(700.0).expect("in range");
        ContactLaw::from(law).bonded(&bond, BondSurfaces::new(1000.0, 700.0, 0.0)).expect("in range")
    };
    let own = BondParameters::default().opening(0.3);
    let beside = BondParameters::new(20.0).residual(12.0).opening(0.3);
    let laws = [
        (r#"{"law": "adhesion", "strength": 15}"#, own, "own"),
        (r#"{"law": "slip_weakening", "mu_s": 0.4, "mu_d": 0.2, "D_c": 0.1, "cohesion": 15}"#, own, "own, weakening"),
        (FRICTIONLESS, beside, "alone"),
        (COULOMB, beside.slip(0.5).tension(8.0), "beside"),
        (COULOMB, beside.slip(0.5).tension(8.0).limit(21.0), "limited"),
        (SUPER, beside.slip(0.5), "beside super/subloading"),
    ];
    let (mut open, mut closed) = (0, 0);
    for lifted in [0.0, 0.12] {
        x[6..].iter_mut().for_each(|slave| slave.y += lifted);
        for (law, bond, what) in laws {
            let points = gauss_points(&[vec![6, 7], vec![7, 8]], 3);
            let plain = pair(points, Master::Mesh(Surface::new(&edges)), COULOMB);
            let pair = ContactPair { laws: vec![Arc::new(bonded(law, bond))], radiation: 150.0, ..plain };
            for k in 0..pair.points.len() {
                for (back, gap) in [(1e-4, -0.02), (0.01, -0.02), (0.3, -0.02), (-0.3, 0.02), (0.02, 0.1), (0.3, 0.6)] {
                    let start = pair.laws[0].law.initial_state(0.0, 0.0);
                    let friction = match gap < 0.0 {
                        true => FrictionState { traction: 2.0, pressure: 20.0, ..start },
                        false if bond == own && gap < 0.3 => FrictionState { traction: 2.0, ..start },
                        false => start,
                    };
                    let old = pulled(&pair, k, &x, back, friction, gap);
                    let memory = BondState {
                        traction: if gap < 0.3 { 3.0 } else { 0.0 },
                        opened: f64::max(0.05, gap).min(0.2),
                        opening: gap.max(0.0),
                        slip: 0.02,
                        ..BondState::default()
                    };
                    let old = ContactState { bond: (bond != own).then_some(memory), ..old };
                    let (state, contribution) = evaluate(&pair, k, &old, &x);
                    if contribution.is_none() {
                        continue;
                    }
                    *(if state.is_closed() { &mut closed } else { &mut open }) += 1;
                    check_tangent(&pair, k, &old, &x, &format!("{what}, slip {back} from {gap}, lifted {lifted}"));
                }
            }
        }
    }
    assert!(open > 50 && closed > 50, "{open} open and {closed} closed points were tested");
}
