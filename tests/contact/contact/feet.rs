//! Projections on straight, quadratic, smooth and rigid surfaces, and the search for them.

use super::*;

/// A point slides over the nodes of a wavy surface, 0.02 deep. From one to the next of 500 places its foot, gap and normal
/// move on by no more than curvature explains if the surface is smooth; on its straight edges the normal jumps by up to
/// 0.17, the angle between them.
#[test]
fn nothing_jumps_on_a_smooth_surface() {
    let (edges, x) = wavy();
    let largest_turn = |surface: Surface| {
        let pair = pair(vec![lone_point(6, 1.0)], Master::Mesh(surface), COULOMB);
        let place = |k: usize| {
            let mut x = x.clone();
            let at = 0.5 + 4.0 * k as f64 / 500.0;
            x[6] = Vector2::new(at, -0.02 + 0.03 * (2.0 * at).sin());
            let x = Configuration::undeformed(&x);
            Index::new(&pair.master, &x).project(&pair.points[0], None, &x).expect("a foot")
        };
        let mut largest = 0.0f64;
        for k in 0..500 {
            let (a, b) = (place(k), place(k + 1));
            let along =
                |p: &fecontact::contact::projection::Projection| p.master_point.segment as f64 + p.master_point.xi;
            assert!((along(&b) - along(&a) - 0.008).abs() < 0.012, "the foot jumps from {a:?} to {b:?}");
            assert!((b.gap - a.gap).abs() < 0.003, "the gap jumps from {a:?} to {b:?}");
            largest = largest.max((b.normal - a.normal).norm());
        }
        largest
    };
    let (straight, smooth) = (largest_turn(Surface::new(&edges)), largest_turn(Surface::new(&edges).smoothed(&x)));
    println!("largest turn of the normal: {straight:.4} on straight edges, {smooth:.4} on the smooth curve");
    assert!(smooth < 0.006 && straight > 0.1, "{smooth}, {straight}");
}

/// Feet on a disk and in a hole of radius 2, and the way round through ±π, by polar coordinates.
#[test]
fn feet_on_a_rigid_circle() {
    for (hole, side) in [(false, 1.0), (true, -1.0)] {
        let body = Rigid::from(Shape::Circle(Circle { centre: Vector2::new(1.0, 1.0), radius: 2.0, hole }));
        let at = |angle: f64| Vector2::new(1.0, 1.0) + Vector2::new(angle.cos(), angle.sin()) * 2.1;
        let (point, here) = (&lone_point(0, 1.0), vec![at(3.1)]);
        let moved = at(-3.1) - at(3.1);
        let ways = [[0.0, 0.0], [moved.x, moved.y]];
        let ways = ways.each_ref().map(|u| Configuration::new(&here, u));
        let [from, to] = [&ways[0], &ways[1]].map(|x| body.project(point, x).expect("a foot"));
        assert!((from.gap - 0.1 * side).abs() < 1e-14);
        // From 3.1 to 2π − 3.1 counter-clockwise, which is against s on a disk.
        let way = body.way(point, from.master_point, to.master_point, &ways[1]);
        assert!((way + side * 2.0 * (2.0 * std::f64::consts::PI - 6.2)).abs() < 1e-14, "{way}");
    }
}

/// Feet on a parabola y = x²/4 over [−1, 1]: a point h off along the normal at x = ½ has its foot there, and the way from
/// the vertex is the arc length ∫ √(1 + x²/4) dx = [x √(4 + x²)/4 + asinh(x/2)].
#[test]
fn feet_on_a_quadratic_edge_lie_on_the_parabola() {
    let normal = Vector2::new(-0.25, 1.0).normalize();
    for (h, tolerance) in [(0.1, 1e-14), (-0.1, 1e-14), (0.0, 1e-14)] {
        let point = Vector2::new(0.5, 0.0625) + normal * h;
        let x = vec![
            Vector2::new(-1.0, 0.25),
            Vector2::new(1.0, 0.25),
            Vector2::new(0.0, 0.0),
            point,
            point + Vector2::x(),
        ];
        let master = Master::Mesh(Surface::new(&[vec![1, 0, 2]]));
        let pair = pair(nodal_points(&[vec![3, 4]]), master, COULOMB);
        let at = Configuration::undeformed(&x);
        let found = Index::new(&pair.master, &at).project(&pair.points[0], None, &at).expect("a foot");
        assert!((found.gap - h).abs() < tolerance && (found.master_point.xi - 0.75).abs() < tolerance, "{found:?}");
        let from = Some(MasterPoint { segment: 0, xi: 0.5 });
        let mut met = Kinematics::new(false);
        kinematics(&pair.points[0], &pair.master, &found, from, &at, &mut met);
        let slip = met.slip;
        let arc = 0.5 * (4.0f64 + 0.25).sqrt() / 4.0 + 0.25f64.asinh();
        assert!((slip - arc).abs() < 1e-9, "{slip}, exactly {arc}");
    }
}

/// The foot on a spline or a parabola is found in a few steps wherever the point lies: before, beside and behind the curve
/// and past its ends, where the search stops at once; but for points near the centre of curvature of a parabola.
#[test]
fn a_foot_on_a_curve_takes_few_steps() {
    let (edges, x) = wavy();
    let mut bent = x.clone();
    bent.remove(4);
    let curves = [
        (Surface::new(&edges).smoothed(&x), x.clone(), 10, 6),
        (Surface::new(&[vec![2, 0, 1], vec![4, 2, 3]]), bent, 6, 8),
    ];
    let point = lone_point(0, 1.0);
    for (surface, nodes, rows, allowed) in curves {
        let mut most = 0;
        for (i, j) in (-40..=40).flat_map(|i| (-rows..=rows).map(move |j| (i, j))) {
            for segment in &surface.segments {
                let at = Vector2::new(2.5 + 0.1 * f64::from(i), 0.03 * f64::from(j));
                // The point takes the place of a node that the surface does not have.
                let mut x = vec![at];
                x.extend(&nodes);
                let moved = |node: usize| node + 1;
                let segment = Segment {
                    ends: segment.ends.map(moved),
                    middle: segment.middle.map(moved),
                    beyond: segment.beyond.map(|node| node.map(moved)),
                };
                let found = nearest(&point, &segment, &Configuration::undeformed(&x));
                if (0.0..=1.0).contains(&found.xi) {
                    let cosine = found.offset.dot(&found.slope.normalize());
                    assert!(cosine.abs() < 1e-14, "{at:?}: {found:?}");
                }
                most = most.max(found.steps);
            }
        }
        println!("at most {most} steps");
        assert!(most <= allowed, "{most} steps");
    }
}

/// A roof: behind its ridge, where a point lies behind both sides, it belongs to the side it comes from, up to where its foot
/// reaches the ridge; elsewhere to the nearest.
#[test]
fn behind_a_ridge_a_point_belongs_to_the_side_it_comes_from() {
    let (slope, depth) = (0.5f64, 0.1);
    let (angle, reach) = (slope.atan(), depth * slope);
    // Top edges run right to left: segment 0 is the left side, which comes first along s.
    let master = Master::Mesh(Surface::new(&[vec![1, 0], vec![2, 1]]));
    let side = |along: f64, from: Option<usize>| {
        // From the ridge by `along` to the right, `depth` below it.
        let at = Vector2::new(along, -depth);
        let x = vec![Vector2::new(-1.0, -slope), Vector2::zeros(), Vector2::new(1.0, -slope), at];
        let x = Configuration::undeformed(&x);
        let from = from.map(|segment| MasterPoint { segment, xi: 0.5 });
        let found = Index::new(&master, &x).project(&lone_point(3, 1.0), from, &x).expect("a foot");
        let right = if found.master_point.segment == 1 { along } else { -along };
        assert!((found.gap - (right * angle.sin() - depth * angle.cos())).abs() < 1e-14, "{found:?}");
        found.master_point.segment
    };
    for along in [0.5, 0.9, 0.99].map(|share| share * reach) {
        assert_eq!([Some(0), None, Some(1)].map(|from| side(along, from)), [0, 1, 1], "{along}");
        assert_eq!([Some(0), None, Some(1)].map(|from| side(-along, from)), [0, 0, 1], "{along}");
    }
    for along in [1.01, 3.0].map(|share| share * reach) {
        assert_eq!([Some(0), None, Some(1)].map(|from| side(along, from)), [1; 3], "{along}");
        assert_eq!([Some(0), None, Some(1)].map(|from| side(-along, from)), [0; 3], "{along}");
    }
}

/// A point that nothing faced when the increment began has slipped past the material that it meets: q = α_t s·Σ w_a Δx_a while
/// it sticks, and the tangent is that of differences. At nodes, at Gauss points, on a rigid plane, and by mortar, where the
/// slave must come from beyond the master's end.
#[test]
fn points_that_nothing_faced_slip_past_what_they_meet() {
    let (straight, x) = wavy();
    let slave = [vec![6, 7], vec![7, 8]];
    let surface = Master::Mesh(Surface::new(&straight));
    let plane = Shape::Plane(Plane { point: Vector2::new(0.0, 0.05), normal: Vector2::new(-0.02, 1.0).normalize() });
    let plane = Master::Rigid(plane.into());
    let rough = r#"{"law": "coulomb", "mu": 1e6}"#;
    let by_mortar = |law: &str| {
        let (points, mortar) = mortar_points(&slave, Hats::OfEdges, &x);
        ContactPair { mortar: Some(mortar), ..pair(points, surface.clone(), law) }
    };
    for (number, (pair, way)) in [
        (pair(nodal_points(&slave), surface.clone(), COULOMB), 1e-5),
        (pair(nodal_points(&slave), surface.clone(), COULOMB), 0.05),
        (pair(gauss_points(&slave, 2), surface.clone(), SUPER), 0.001),
        (pair(gauss_points(&slave, 2), plane, COULOMB), 1e-5),
        (by_mortar(COULOMB), 20.0),
        (by_mortar(rough), 20.0),
    ]
    .into_iter()
    .enumerate()
    {
        let motion = Vector2::new(-way, 0.2 * way);
        let here = vec![0.0; 2 * x.len()];
        let mut aside = here.clone();
        aside[12..].chunks_mut(2).for_each(|u| u.copy_from_slice(&[-motion.x, -motion.y]));
        let before = Configuration::new(&x, &aside);
        let friction = pair.laws[0].law.initial_state(0.0, 0.0);
        let old = committed(friction, None, 0.0);
        let old = vec![old; pair.points.len()];
        let answer = |u: &[f64]| {
            let x = Configuration::new(&x, u);
            respond(&pair, &old, [&before, &x], INCREMENT)
        };
        let mut closed = 0;
        for (k, (state, found)) in answer(&here).into_iter().enumerate() {
            let Some(contribution) = found else { continue };
            closed += 1;
            if number == 3 {
                let slip = motion.dot(&Vector2::new(1.0, 0.02).normalize());
                assert!((state.friction.traction.abs() - 700.0 * slip.abs()).abs() < 1e-12);
            }
            let scale = contribution.tangent.amax();
            for column in 0..2 * contribution.nodes.len() {
                let moved = |step: f64| {
                    let mut u = here.clone();
                    u[2 * contribution.nodes[column / 2] + column % 2] += step;
                    answer(&u)[k].1.clone().expect("a tiny motion does not open the point").force
                };
                let difference = (moved(1e-6) - moved(-1e-6)) / 2e-6;
                for (row, difference) in difference.iter().enumerate() {
                    let tangent = contribution.tangent[(row, column)];
                    assert!(
                        (difference - tangent).abs() < 1e-6 * scale,
                        "{number}: point {k}, ({row}, {column}): {tangent}, by differences {difference} (scale {scale})"
                    );
                }
            }
        }
        assert!(closed > 0, "pair {number} is open");
    }
}

/// The tree finds what going through all segments finds, the first along the surface of those that are equally near, from
/// wherever the search starts.
#[test]
fn a_search_from_any_segment_finds_the_first_of_the_nearest() {
    let (master, slave, x) = strips(37, false);
    let surface = Surface::new(&master);
    let straight = Master::Mesh(surface.clone());
    for (lift, turn) in [(0.0, 0.0), (0.03, 0.2), (-0.2, -0.5)] {
        let u: Vec<f64> = (0..x.len())
            .flat_map(|node| {
                let slave = node >= x.len() / 2;
                let bend = if slave { lift } else { turn * (x[node].x - 1.5).powi(2) };
                [if slave { 0.013 * turn } else { 0.0 }, bend]
            })
            .collect();
        let at = Configuration::new(&x, &u);
        let index = Index::new(&straight, &at);
        for point in gauss_points(&slave, 3).iter().chain(&nodal_points(&slave)) {
            let distance = |k: usize| {
                let [a, b] = surface.segments[k].ends;
                let (along, offset) = (at.between(a, b), point.offset(a, &at));
                (offset - along * (offset.dot(&along) / along.norm_squared()).clamp(0.0, 1.0)).norm_squared()
            };
            let first = (0..37).min_by(|&j, &k| distance(j).total_cmp(&distance(k))).expect("segments");
            let expected = index.project(point, None, &at);
            for segment in 0..37 {
                // Before the ridge rule, which minds the old foot behind the surface, the search is the same from anywhere.
                let found = index.project(point, Some(MasterPoint { segment, xi: 0.5 }), &at);
                if expected.is_some_and(|met| met.gap >= 0.0) {
                    assert_eq!(found, expected, "from segment {segment}");
                }
            }
            if let Some(met) = expected {
                assert_eq!(met.master_point.segment, first);
            }
        }
    }
}
