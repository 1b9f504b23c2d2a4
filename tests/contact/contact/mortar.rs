//! Mortar contact: exact tangents, normals and means along edges.

use super::*;

/// Mortar on rigid bodies, at rest and moving: the tangent of every closed point equals differences, on straight and on curved edges,
/// from a place in which the slave, and the body, lay elsewhere.
#[test]
fn mortar_tangent_on_rigid_bodies_equals_differences() {
    let rest: Positions = [(0.2, -0.01), (0.6, -0.05), (0.9, -0.03)].map(|(x, y)| Vector2::new(x, y)).to_vec();
    for body in [
        Shape::Plane(Plane { point: Vector2::new(0.0, 0.0), normal: Vector2::new(-0.06, 1.0).normalize() }),
        Shape::Circle(Circle { centre: Vector2::new(0.5, -3.0), radius: 3.0, hole: false }),
        Shape::Circle(Circle { centre: Vector2::new(0.5, 2.0), radius: 1.9, hole: true }),
        Shape::Polyline(Polyline::new([(-1.0, 0.0), (2.0, 0.03)].map(|(x, y)| Vector2::new(x, y)).to_vec())),
    ] {
        let slaves = [vec![vec![0, 1], vec![1, 2]], vec![vec![0, 2, 1]]];
        for (slave, moves) in slaves.iter().flat_map(|slave| [(slave, false), (slave, true)]) {
            let (points, mortar) = mortar_points(slave, Hats::OfEdges, &rest);
            let rigid = if moves { moving(body.clone(), 3) } else { body.clone().into() };
            let x = if moves { seen(&rest, [0.4, -0.3], 0.7) } else { rest.clone() };
            let pair = ContactPair { mortar: Some(mortar), ..pair(points, Master::Rigid(rigid), SUPER) };
            let mut closed = 0;
            for (way, gap) in [(1e-5, -0.02), (0.02, -0.02), (-0.3, -0.02), (0.02, 0.03)] {
                let before: Positions = rest.iter().map(|x| x - Vector2::new(way, 0.0)).collect();
                let before = if moves { seen(&before, [0.3, -0.4], 0.5) } else { before };
                let friction = pair.laws[0].law.initial_state(0.0, 0.0);
                let pressed = FrictionState { traction: 1.0, pressure: 10.0, ..friction.clone() };
                let friction = if gap > 0.0 { friction } else { pressed };
                let master_point = Some(MasterPoint { segment: 0, xi: 0.0 });
                let old = vec![committed(friction, master_point, gap); pair.points.len()];
                let answer = |x: &Positions| {
                    let (before, x) = (displaced(&before), displaced(x));
                    respond(&pair, &old, [&before, &x], INCREMENT)
                };
                for (k, (_, found)) in answer(&x).into_iter().enumerate() {
                    let Some(contribution) = found else { continue };
                    closed += 1;
                    let scale = contribution.tangent.amax();
                    for column in 0..2 * contribution.nodes.len() {
                        let moved = |step: f64| {
                            let mut x = x.clone();
                            x[contribution.nodes[column / 2]][column % 2] += step;
                            answer(&x)[k].1.clone().expect("a tiny motion does not open the point").force
                        };
                        let difference = (moved(1e-6) - moved(-1e-6)) / 2e-6;
                        for (row, difference) in difference.iter().enumerate() {
                            let tangent = contribution.tangent[(row, column)];
                            assert!(
                                (difference - tangent).abs() < 1e-6 * scale,
                                "{body:?}: point {k}, ({row}, {column}): {tangent}, by differences {difference}"
                            );
                        }
                    }
                }
            }
            assert!(closed >= 8, "{closed} points were tested");
        }
    }
}

/// Mortar: the tangent of every closed point on straight and curved, smooth and cornered edges, sticking and slipping, from
/// a committed configuration in which the slave lay elsewhere.
#[test]
fn mortar_tangent_equals_differences() {
    let (straight, x) = wavy();
    let quadratic = [vec![2, 0, 1], vec![5, 2, 3]];
    for (master, slave) in [
        (&straight[..], vec![vec![6, 7], vec![7, 8]]),
        (&straight[..], vec![vec![6, 8, 7]]),
        (&quadratic[..], vec![vec![6, 7], vec![7, 8]]),
        (&quadratic[..], vec![vec![6, 8, 7]]),
    ] {
        let surface = Surface::new(master);
        let (points, mortar) = mortar_points(&slave, Hats::OfEdges, &x);
        for law in [SUPER, COULOMB] {
            let pair = pair(points.clone(), Master::Mesh(surface.clone()), law);
            let mut closed = 0;
            for (way, gap) in [(1e-5, -0.02), (0.02, -0.02), (-0.3, -0.02), (0.02, 0.03)] {
                let mut before = x.clone();
                before[6..].iter_mut().for_each(|x| x.x -= way);
                for k in 0..points.len() {
                    closed += usize::from(check_mortar_tangent(&pair, &mortar, &surface, k, &before, gap, &x));
                }
            }
            assert!(closed >= 8, "{closed} points were tested");
        }
    }
}

/// The direction of a slave node is the mean of its edges' under its multiplier, ∫ φ_j dx: on two parabolas of unequal length,
/// by sums of little chords.
#[test]
fn mortar_normal_is_the_mean_under_the_multiplier() {
    let on_circle = |angle: f64| Vector2::new(angle.sin(), 1.0 - angle.cos());
    let nodes = [-0.6, -0.3, 0.0, 0.15, 0.3].map(on_circle);
    let x: Positions = [Vector2::new(-3.0, 0.01), Vector2::new(3.0, 0.01)].into_iter().chain(nodes).collect();
    let (master, slave) = (Surface::new(&[vec![1, 0]]), [vec![2, 4, 3], vec![4, 6, 5]]);
    let place = |edge: &[usize], xi: f64| {
        let [start, end, middle] = [0.5 * xi * (xi - 1.0), 0.5 * xi * (xi + 1.0), 1.0 - xi * xi];
        start * x[edge[0]] + end * x[edge[1]] + middle * x[edge[2]]
    };
    let mean = |edge: &[usize], phi: fn(f64) -> f64| -> Vector2<f64> {
        let chord = |k: i32| place(edge, f64::from(k + 1) * 1e-3) - place(edge, f64::from(k) * 1e-3);
        (-1000..1000).map(|k| phi((f64::from(k) + 0.5) * 1e-3) * chord(k)).sum()
    };
    let (start, middle, end) = (|xi: f64| (-xi).max(0.0), |xi: f64| 1.0 - xi.abs(), |xi: f64| xi.max(0.0));
    let [first, second] = &slave;
    let at_nodes = vec![
        mean(first, start),
        mean(first, middle),
        mean(first, end) + mean(second, start),
        mean(second, middle),
        mean(second, end),
    ];
    // The corner in the middle has no traction of its own, the ends have.
    let of_edges = vec![
        mean(first, start),
        mean(first, |xi| 1.0 - (-xi).max(0.0)),
        mean(second, |xi| 1.0 - xi.max(0.0)),
        mean(second, end),
    ];
    let configuration = Configuration::undeformed(&x);
    for (hats, expected) in [(Hats::AtNodes, at_nodes), (Hats::OfEdges, of_edges)] {
        let (points, mortar) = mortar_points(&slave, hats, &x);
        assert_eq!(points.len(), expected.len());
        let pair = pair(points, Master::Mesh(master.clone()), FRICTIONLESS);
        let overlaps = overlaps(&pair, &mortar, &master, &configuration);
        let ridges = mortar.ridges(&master, &overlaps, &configuration);
        for (k, expected) in expected.into_iter().enumerate() {
            let mut met = Kinematics::new(false);
            mortar
                .facing(&master, &overlaps, &ridges)
                .meet(k, None, &configuration, &mut met, &mut Room::default())
                .expect("the master faces the point");
            let away = (met.tangent - expected.normalize()).norm();
            assert!(away < 1e-6, "{hats:?}, point {k}: {:?}, not {:?}", met.tangent, expected.normalize());
        }
    }
}

/// ∫ (1 + x + x²) dx from −1 to 2, of three quadratic edges with tractions of their own at both ends: the points' means by their
/// lengths. A linear profile has these means at the points themselves.
#[test]
fn profiles_enter_by_their_means_along_quadratic_edges() {
    let place = |x: f64| Vector2::new(x, 0.0);
    let x: Positions = [-1.0, -0.5, 0.0, 0.4, 0.8, 1.4, 2.0].map(place).to_vec();
    let slave = [vec![2, 0, 1], vec![4, 2, 3], vec![6, 4, 5]];
    let (points, _) = mortar_points(&slave, Hats::OfEdges, &x);
    assert_eq!(points.len(), 5, "one an edge, and both ends");
    let undeformed = Configuration::undeformed(&x);
    let resultant = |profile: &dyn Fn(f64) -> f64| -> f64 {
        let of = |point: &SlavePoint| point.mean(|at| profile(at.x), &undeformed) * point.current_length(&undeformed);
        points.iter().map(of).sum()
    };
    common::close("resultant", resultant(&|x| 1.0 + x + x * x), 3.0 + 1.5 + 3.0, 1e-12);
    for point in &points {
        common::close("its place", point.mean(|at| at.x, &undeformed), point.at(&undeformed).x, 1e-12);
    }

    // As the pressure of a model: ∫ (1 + x²) dx from 0 to 3.
    let model = common::model(&json!({
        "mesh": {"blocks": [{"body": "block", "kind": "Q8", "corners": [[0, 0], [3, 0], [3, 1], [0, 1]], "elements": [3, 1],
                             "sides": ["bottom", null, "top", null]}]},
        "bodies": {"block": {"material": {"model": "linear", "E": 100, "nu": 0.3}}},
        "contacts": {"base": {"slave": "bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}}, "method": "mortar",
                              "friction": {"law": "frictionless"}, "initial": {"pressure": "1 + x^2"}}},
        "steps": [{"name": "rest", "duration": 1, "supports": [{"on": "top", "ux": 0, "uy": 0}]}],
    }));
    let (undeformed, state) = (model.mesh.undeformed(), model.initial_state());
    let points = model.contacts[0].points.iter().zip(&state.contacts[0]);
    let force: f64 = points.map(|(point, state)| state.friction.pressure * point.current_length(&undeformed)).sum();
    common::close("force", force, 12.0, 1e-12);
}

/// A quadratic edge whose middle node is off its middle is a parabola that turns back beyond an end, and passes no master node farther
/// away: such nodes cut it nowhere, so that its gaps are those against the two segments of a roof that are below it. (By Newton's
/// iterations without a solution they cut it anywhere, at some places of the middle node and not at others.)
#[test]
fn nodes_beyond_a_quadratic_edge_do_not_cut_it() {
    let roof = |k: i32| Vector2::new(0.75 * f64::from(k), -0.225 * f64::from(k.abs()));
    let slave = [vec![0, 1, 2]];
    let segments: Vec<Vec<usize>> = (0..16).map(|k| vec![k + 4, k + 3]).collect();
    for shift in 0..100 {
        let edge = [Vector2::new(-0.5, 0.0), Vector2::new(0.5, 0.0), Vector2::new(4e-4 * f64::from(shift), 0.02)];
        let x: Positions = edge.into_iter().chain((-8..=8).map(roof)).collect();
        let configuration = Configuration::undeformed(&x);
        let gaps = |segments: &[Vec<usize>]| -> Vec<f64> {
            let (surface, (points, mortar)) = (Surface::new(segments), mortar_points(&slave, Hats::OfEdges, &x));
            let pair = pair(points, Master::Mesh(surface.clone()), FRICTIONLESS);
            let overlaps = overlaps(&pair, &mortar, &surface, &configuration);
            let ridges = mortar.ridges(&surface, &overlaps, &configuration);
            let facing = mortar.facing(&surface, &overlaps, &ridges);
            let meet = |k| facing.meet(k, None, &configuration, &mut Kinematics::new(false), &mut Room::default());
            (0..3).map(|k| meet(k).expect("the roof faces the point").gap).collect()
        };
        let (all, below) = (gaps(&segments), gaps(&segments[7..9]));
        assert!(common::distance(&all, &below) < 1e-12, "{shift}: {all:?}, not {below:?}");
    }
}

/// Mortar: the tangent where a master segment at 68° to the slave edge counts in part.
#[test]
fn oblique_mortar_tangent_equals_differences() {
    let at = [[0.0, 0.0], [0.4, 1.0], [1.4, 1.0], [0.1, 0.55], [0.7, 0.6], [1.3, 0.65]];
    let x: Positions = at.map(|[x, y]| Vector2::new(x, y)).into();
    let surface = Surface::new(&[vec![1, 0], vec![2, 1]]);
    let (points, mortar) = mortar_points(&[vec![3, 4], vec![4, 5]], Hats::OfEdges, &x);
    let pair = pair(points, Master::Mesh(surface.clone()), COULOMB);
    let mut before = x.clone();
    before[3..].iter_mut().for_each(|x| x.x -= 0.01);
    let closed = (0..3).filter(|&k| check_mortar_tangent(&pair, &mortar, &surface, k, &before, -0.02, &x));
    assert_eq!(closed.count(), 3);
}

/// The slave edges cut in the configuration `x`.
fn overlaps(pair: &ContactPair, mortar: &Mortar, surface: &Surface, x: &Configuration) -> Overlaps {
    let mut found = Overlaps::default();
    mortar.cut(surface, &Index::new(&pair.master, x), [x, x], &mut found);
    found
}

/// Compare the tangent of one mortar point with central differences; whether it was closed.
pub fn check_mortar_tangent(
    pair: &ContactPair,
    mortar: &Mortar,
    surface: &Surface,
    k: usize,
    before: &Positions,
    gap: f64,
    x: &Positions,
) -> bool {
    let before = Configuration::undeformed(before);
    let was = overlaps(pair, mortar, surface, &before);
    let (mut room, mut weights) = (Room::default(), Vec::new());
    let ridges = mortar.ridges(surface, &was, &before);
    mortar.facing(surface, &was, &ridges).weigh(k, &before, &mut room, &mut weights);
    let weights = Some(weights).filter(|weights| !weights.is_empty());
    let open = pair.laws[0].law.initial_state(0.0, 0.0);
    let friction = if gap > 0.0 { open } else { FrictionState { traction: 2.0, pressure: 20.0, ..open } };
    let old = committed(friction, MasterPoint { segment: 0, xi: 0.0 }, gap);
    let increment = PointIncrement { during: INCREMENT, prediction: Prediction::default() };
    let evaluate = |x: &Positions| {
        let x = Configuration::undeformed(x);
        let is = overlaps(pair, mortar, surface, &x);
        let mut kinematics = Kinematics::new(true);
        let facing = mortar.facing(surface, &is, &ridges);
        let met = facing.meet(k, weights.as_ref(), &x, &mut kinematics, &mut Room::default());
        let met = met.expect("the master faces the point");
        closes(pair, &pair.points[k], met.gap, &old, increment).then(|| {
            let place = PointPlace {
                gap: met.gap,
                master_point: Some(met.master_point),
                closes: true,
                ..PointPlace::default()
            };
            finish(pair, k, &old, increment, place, &mut kinematics).1.expect("a closed point").contribution
        })
    };
    let Some(contribution) = evaluate(x) else { return false };
    let (scale, h) = (contribution.tangent.amax(), 1e-6);
    for column in 0..2 * contribution.nodes.len() {
        let moved = |step: f64| {
            let mut x = x.clone();
            x[contribution.nodes[column / 2]][column % 2] += step;
            let moved = evaluate(&x).expect("a tiny motion does not open the point");
            assert_eq!(moved.nodes, contribution.nodes);
            moved.force
        };
        let differences = (moved(h) - moved(-h)) / (2.0 * h);
        for (row, difference) in differences.iter().enumerate() {
            let tangent = contribution.tangent[(row, column)];
            assert!(
                (difference - tangent).abs() < 1e-6 * scale,
                "point {k}, ({row}, {column}): {tangent}, by differences {difference} (scale {scale})"
            );
        }
    }
    true
}
