//! Rigid masters that move.

use super::*;

/// Plane, disk, hole, and a polyline with a ridge that the first point has gone through and a line for the second; each at rest,
/// and moved and turned with all of its own motion in the tangent.
#[test]
fn tangent_equals_differences_on_rigid_bodies() {
    let rest: Positions = vec![Vector2::new(0.2, -0.01), Vector2::new(0.9, -0.03)];
    let at = |points: &[(f64, f64)]| points.iter().map(|&(x, y)| Vector2::new(x, y)).collect::<Vec<_>>();
    for body in [
        Shape::Plane(Plane { point: Vector2::new(0.0, 0.0), normal: Vector2::new(-0.06, 1.0).normalize() }),
        Shape::Circle(Circle { centre: Vector2::new(0.5, -3.0), radius: 3.0, hole: false }),
        Shape::Circle(Circle { centre: Vector2::new(0.5, 2.0), radius: 1.9, hole: true }),
        Shape::Polyline(Polyline::new(at(&[(-1.0, 0.5), (0.35, 0.01), (2.0, 0.6)]))),
        Shape::Polyline(Polyline::new(at(&[(-1.0, 0.0), (2.0, 0.03)]))),
    ] {
        for (rigid, x) in [(body.clone().into(), rest.clone()), (moving(body, 2), seen(&rest, [0.4, -0.3], 0.7))] {
            let pair = pair(gauss_points(&[vec![0, 1]], 2), Master::Rigid(rigid), SUPER);
            let pressed = FrictionState { traction: 1.0, pressure: 10.0, ..pair.laws[0].law.initial_state(0.0, 0.0) };
            for k in 0..2 {
                for (back, gap) in [(1e-4, -0.02), (0.01, -0.02), (-0.2, -0.02), (0.02, 0.03)] {
                    let old = pulled(&pair, k, &x, back, pressed.clone(), gap);
                    check_tangent(&pair, k, &old, &x, &format!("{:?}", pair.master));
                }
            }
        }
    }
}

/// What a rigid body that moves and turns sees is what one at rest sees: pressures and tractions are the same, forces turn with it,
/// and it gets their opposite, with their moment about its reference point where that is now. At points that had a foot and at
/// points that had none, which slip past what they meet: where an increment turns the body by 0.5, too.
#[test]
fn a_rigid_body_that_moves_answers_as_one_at_rest() {
    let rest: Positions = vec![Vector2::new(0.2, -0.01), Vector2::new(0.9, -0.03)];
    let before: Positions = rest.iter().map(|x| x - Vector2::new(0.004, 0.001)).collect();
    let shape = Shape::Circle(Circle { centre: Vector2::new(0.5, -3.0), radius: 3.0, hole: false });
    let slave = [vec![0, 1]];
    let (points, mortar) = mortar_points(&slave, Hats::OfEdges, &rest);
    for (points, mortar) in [(gauss_points(&slave, 2), None), (points, Some(mortar))] {
        for faced in [true, false] {
            let answer = |rigid: Rigid, before: &Positions, x: &Positions| {
                let pair =
                    ContactPair { mortar: mortar.clone(), ..pair(points.clone(), Master::Rigid(rigid), COULOMB) };
                let (before, x) = (displaced(before), displaced(x));
                let mut old = pair.initial_states(&before);
                old.iter_mut().for_each(|state| state.master_point = state.master_point.filter(|_| faced));
                respond(&pair, &old, [&before, &x], INCREMENT)
            };
            let still = answer(shape.clone().into(), &before, &rest);
            let (shift, angle) = (Vector2::new(-0.2, 0.6), -0.3);
            let x = seen(&rest, shift.into(), angle);
            let moved = answer(moving(shape.clone(), 2), &seen(&before, [0.4, -0.3], 0.2), &x);
            let mut sums = [Vector2::zeros(), Vector2::zeros()];
            let mut moments = [0.0; 2];
            for ((a, still), (b, moved)) in still.iter().zip(&moved) {
                for (a, b) in [(a.friction.pressure, b.friction.pressure), (a.friction.traction, b.friction.traction)] {
                    assert!((a - b).abs() < 1e-11 && a != 0.0, "{a}, at rest {b}");
                }
                let (still, moved) = (still.as_ref().expect("closed"), moved.as_ref().expect("closed"));
                let at = |of: &Contribution, k: usize| Vector2::new(of.force[2 * k], of.force[2 * k + 1]);
                for (k, &node) in moved.nodes.iter().enumerate() {
                    if node < 2 {
                        let turned = Rotation2::new(angle) * at(still, k);
                        assert!((turned - at(moved, k)).norm() < 1e-11, "{turned}, {}", at(moved, k));
                        sums[0] += at(moved, k);
                        moments[0] += (x[node] - shift).perp(&at(moved, k));
                    } else if node == 2 {
                        sums[1] += at(moved, k);
                    } else {
                        moments[1] += TURNING * at(moved, k).x;
                        assert_eq!(at(moved, k).y, 0.0);
                    }
                }
            }
            assert!((sums[0] + sums[1]).norm() < 1e-11 * sums[0].norm(), "{sums:?}");
            assert!((moments[0] + moments[1]).abs() < 1e-11 * sums[0].norm(), "{moments:?}");
        }
    }
}
