//! Contact: exact tangents, feet at corners and past ends.

use std::collections::BTreeMap;
use std::sync::Arc;

use fecontact::contact::force::{
    Closed, ClosedPoints, ContactState, PointEvaluation, PointIncrement, PointPlace, Tractions, closes, place,
};
use fecontact::contact::kinematics::{Kinematics, kinematics};
use fecontact::contact::master::{Circle, Master, Plane, Polyline, Rigid, Shape};
use fecontact::contact::mortar::{Hats, Mortar, Overlaps, Room, mortar_points};
use fecontact::contact::pair::{ContactIncrement, ContactPair, InitialTraction, Prediction};
use fecontact::contact::projection::{Bound, nearest};
use fecontact::contact::response::PairResponse;
use fecontact::contact::search::Index;
use fecontact::contact::surface::{MasterPoint, Segment, SlavePoint, Surface, gauss_points, lone_point, nodal_points};
use fecontact::laws::friction::{
    Answer, Description, FrictionLaw, FrictionParameters, FrictionResponse, FrictionState, Regime, Sliding,
};
use fecontact::linear::system::{Contribution, Request};
use fecontact::mesh::configuration::Configuration;
use fecontact::mesh::rigid::RigidBody;
use nalgebra::{DMatrix, DVector, Rotation2, Vector2};
use serde_json::json;

use crate::common;

type Positions = Vec<Vector2<f64>>;

/// In one step an increment: under error control the answer jumps, by less than the tolerance, where the number of sub-steps
/// changes, and so does a difference quotient taken there (`the_controlled_answer_jumps_only_where_sub_steps_change`).
const SUPER: &str = r#"{"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "r": 100, "kappa": 10, "xi": 0.02, "structure": 1.8,
        "integration": "backward_euler"}"#;
const COULOMB: &str = r#"{"law": "coulomb", "mu": 0.3}"#;
const FRICTIONLESS: &str = r#"{"law": "frictionless"}"#;
pub const INCREMENT: ContactIncrement =
    ContactIncrement { dt: 0.3, time: 0.0, radiates: true, fading: 0.0, stiffening: 1.0, settles: true, seeps: 0.0 };

/// A wavy master of five segments, nodes 0 to 5 from left to right, and slave nodes 6, 7, 8 below it.
///
/// Bodies are on the left of their edges: a top edge runs right to left, a bottom edge left to right.
fn wavy() -> (Vec<Vec<usize>>, Positions) {
    let master = [(0.0, 0.0), (1.0, 0.06), (2.0, -0.05), (3.0, 0.03), (4.0, 0.0), (5.0, 0.05)];
    let slave = [(1.3, -0.03), (2.1, -0.07), (2.9, -0.02)];
    let x = master.iter().chain(&slave).map(|&(x, y)| Vector2::new(x, y)).collect();
    ((0..5).map(|k| vec![k + 1, k]).collect(), x)
}

/// The points at the given places. They got there from the origin by displacements: a foot on a rigid body is counted from
/// that of the reference position.
fn displaced(x: &Positions) -> Configuration<'static> {
    static ORIGIN: [Vector2<f64>; 16] = [Vector2::new(0.0, 0.0); 16];
    // Left to the end of the program: a configuration only looks at displacements.
    Configuration::new(&ORIGIN[..x.len()], x.iter().flat_map(|x| [x.x, x.y]).collect::<Vec<_>>().leak())
}

/// A pair with α_n = 1000, c = 0.002 and, unless given, α_t = 700.
pub fn pair(points: Vec<SlavePoint>, master: Master, law: &str) -> ContactPair {
    let law =
        serde_json::from_str::<FrictionParameters>(law).expect("a law").build(700.0).expect("parameters in range");
    ContactPair {
        conduit: None,
        comes_stressed: false,
        bodies: Default::default(),
        name: "test".into(),
        tied: false,
        points,
        master,
        mortar: None,
        alpha_n: 1000.0,
        compliance: 2e-3,
        touch: 1e-9,
        penetration: None,
        stick: None,
        radiation: 0.0,
        fluid: None,
        pores: None,
        seam: None,
        laws: vec![Arc::new(law.into())],
        in_time: None,
        truncated: BTreeMap::new(),
        initial: None,
        unseen: Vec::new(),
        fades: None,
        modulus: 0.0,
        both: None,
        body: None,
        small: None,
    }
}

/// What a closed point adds.
struct Kept {
    contribution: Contribution,
    points: ClosedPoints,
}

impl Kept {
    /// The first of some points.
    fn first(points: ClosedPoints) -> Option<Self> {
        let contribution = contribution(points.get(0)?);
        Some(Self { contribution, points })
    }

    fn prediction(&self, correction: impl Fn(usize) -> f64) -> Tractions {
        self.points.get(0).expect("a closed point").prediction(correction)
    }
}

fn contribution(Closed { nodes, force, tangent, .. }: Closed) -> Contribution {
    let n = 2 * nodes.len();
    let (force, tangent) = (DVector::from_column_slice(force), DMatrix::from_column_slice(n, n, tangent));
    Contribution { nodes: nodes.to_vec(), force, tangent }
}

/// What all points of a pair answer.
fn respond(
    pair: &ContactPair,
    old: &[ContactState],
    configurations: [&Configuration; 2],
    during: ContactIncrement,
) -> Vec<(ContactState, Option<Contribution>)> {
    let mut response = PairResponse::default();
    pair.respond(old, configurations, during, |_| Prediction::default(), Request::Tangent, &mut response)
        .expect("an answer");
    let closed = |k| response.closed(k).map(contribution);
    response.states.iter().enumerate().map(|(k, state)| (state.clone(), closed(k))).collect()
}

fn evaluate(pair: &ContactPair, k: usize, old: &ContactState, x: &Positions) -> (ContactState, Option<Contribution>) {
    let (state, closed) = predicted_tractions(pair, k, old, x, None);
    (state, closed.map(|closed| closed.contribution))
}

/// The answer of a point whose last linear solve predicted something.
fn predicted_tractions(
    pair: &ContactPair,
    k: usize,
    old: &ContactState,
    x: &Positions,
    predicted_tractions: Option<Tractions>,
) -> (ContactState, Option<Kept>) {
    let kept = predicted_tractions.map_or(0.0, |predicted_tractions| predicted_tractions.pressure);
    let prediction = Prediction { predicted_tractions, kept, ..Prediction::default() };
    let increment = PointIncrement { during: INCREMENT, prediction };
    answer(pair, k, old, x, increment)
}

fn answer(
    pair: &ContactPair,
    k: usize,
    old: &ContactState,
    x: &Positions,
    increment: PointIncrement,
) -> (ContactState, Option<Kept>) {
    let x = &displaced(x);
    // Every point had a foot before.
    let before = x;
    let index = Index::new(&pair.master, x);
    let projection = index.project(&pair.points[k], None, x);
    let mut kinematics = Kinematics::new(true);
    let place = place(pair, &pair.points[k], projection, old, increment, [before, x], &mut kinematics);
    finish(pair, k, old, increment, place, &mut kinematics)
}

/// The answer of a point in its place.
fn finish(
    pair: &ContactPair,
    k: usize,
    old: &ContactState,
    increment: PointIncrement,
    place: PointPlace,
    kinematics: &mut Kinematics,
) -> (ContactState, Option<Kept>) {
    let law = pair.law(&pair.points[k]);
    let loading =
        PointEvaluation::new(pair, &pair.points[k], law, old, increment, place, kinematics).expect("a good law");
    let answer = law.respond(&old.friction, loading.sliding);
    let mut closed = ClosedPoints::default();
    let state = loading.finish(answer, &mut closed).expect("a finite increment");
    (state, Kept::first(closed))
}

/// Forces of one point on the given nodes.
fn forces(pair: &ContactPair, k: usize, old: &ContactState, x: &Positions, nodes: &[usize]) -> Vec<f64> {
    let (_, contribution) = evaluate(pair, k, old, x);
    let moved = contribution.expect("a tiny motion does not open the point");
    let at = |node: &usize| moved.nodes.iter().position(|n| n == node);
    nodes.iter().flat_map(|node| at(node).map_or([0.0; 2], |a| [moved.force[2 * a], moved.force[2 * a + 1]])).collect()
}

/// Compare the tangent of one point with central differences of its forces, relative to the largest entry.
fn check_tangent(pair: &ContactPair, k: usize, old: &ContactState, x: &Positions, what: &str) {
    let contribution = evaluate(pair, k, old, x).1.unwrap_or_else(|| panic!("{what}: point {k} is open"));
    let nodes = &contribution.nodes;
    let (scale, h) = (contribution.tangent.amax(), 1e-6);
    for column in 0..2 * nodes.len() {
        let moved = |step: f64| {
            let mut x = x.clone();
            x[nodes[column / 2]][column % 2] += step;
            forces(pair, k, old, &x, nodes)
        };
        for (row, (up, down)) in moved(h).iter().zip(moved(-h)).enumerate() {
            let difference = (up - down) / (2.0 * h);
            let tangent = contribution.tangent[(row, column)];
            assert!(
                (difference - tangent).abs() < 1e-6 * scale,
                "{what}: point {k}, ({row}, {column}): {tangent}, by differences {difference} (scale {scale})"
            );
        }
    }
}

/// A committed state whose foot lies `back` before the present one.
fn pulled(pair: &ContactPair, k: usize, x: &Positions, back: f64, friction: FrictionState, gap: f64) -> ContactState {
    let x = &displaced(x);
    let master_point =
        Index::new(&pair.master, x).project(&pair.points[k], None, x).expect("the point faces the master").master_point;
    let at = master_point.segment as f64 + master_point.xi - back;
    let master_point = match &pair.master {
        Master::Mesh(_) => MasterPoint { segment: at.floor() as usize, xi: at - at.floor() },
        Master::Rigid(_) => MasterPoint { xi: master_point.xi - back, ..master_point },
    };
    committed(friction, master_point, gap)
}

/// A committed state that has not slipped.
fn committed(friction: FrictionState, master_point: impl Into<Option<MasterPoint>>, gap: f64) -> ContactState {
    ContactState {
        water: None,
        came: Default::default(),
        bond: None,
        friction,
        master_point: master_point.into(),
        length: 1.0,
        gap,
        slip: 0.0,
        radiation: 0.0,
        radiated: 0.0,
        multiplier: 0.0,
        elastic_slip: 0.0,
        fluid: 0.0,
        pores: 0.0,
    }
}

#[test]
fn tangent_equals_differences_in_stick_partial_and_full_slip_and_after_touch() {
    let (edges, x) = wavy();
    let (linear, quadratic) = ([vec![6, 7], vec![7, 8]], [vec![6, 8, 7]]);
    let all = [gauss_points(&linear, 3), nodal_points(&linear), gauss_points(&quadratic, 4), nodal_points(&quadratic)];
    let surfaces = [Surface::new(&edges), Surface::new(&edges).smoothed(&x)];
    let all = all.iter().flat_map(|points| surfaces.iter().map(move |surface| (points, surface)));
    for (points, surface) in all {
        for (law, radiation) in
            [(SUPER, 0.0), (COULOMB, 0.0), (FRICTIONLESS, 0.0), (COULOMB, 150.0), (FRICTIONLESS, 150.0)]
        {
            let plain = pair(points.clone(), Master::Mesh(surface.clone()), law);
            let pair = ContactPair { radiation, ..plain };
            let pressed = FrictionState { traction: 2.0, pressure: 20.0, ..pair.laws[0].law.initial_state(0.0, 0.0) };
            let mut closed = 0;
            for k in 0..pair.points.len() {
                let (state, _) = evaluate(&pair, k, &pulled(&pair, k, &x, 0.0, pressed.clone(), -0.02), &x);
                if state.regime() == Regime::Open {
                    continue;
                }
                closed += 1;
                for (back, gap, what) in [
                    (1e-4, -0.02, "stick"),
                    (0.01, -0.02, "partial slip"),
                    (0.3, -0.02, "full slip"),
                    (-0.3, -0.02, "backward slip"),
                    (1.4, -0.02, "slip over two segments"),
                    (-1.4, -0.02, "backward slip over two segments"),
                    (0.02, 0.03, "touch within the increment"),
                ] {
                    let friction = if gap > 0.0 { pair.laws[0].law.initial_state(0.0, 0.0) } else { pressed.clone() };
                    let old = pulled(&pair, k, &x, back, friction, gap);
                    check_tangent(&pair, k, &old, &x, &format!("{law}, {what}, radiation {radiation}"));
                }
            }
            assert!(closed > 1, "{closed} points were tested");
        }
    }
}

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

/// The prediction of a point is its tractions at the end of a correction but for terms of second order: it is off by a quarter
/// when the correction is half as long. It changes the geometric part of the tangent, and no force.
#[test]
fn a_prediction_is_of_second_order_and_changes_no_force() {
    let (edges, x) = wavy();
    let pair = pair(nodal_points(&[vec![6, 7], vec![7, 8]]), Master::Mesh(Surface::new(&edges)), COULOMB);
    let pressed = FrictionState { traction: 2.0, pressure: 20.0, ..pair.laws[0].law.initial_state(0.0, 0.0) };
    let old = pulled(&pair, 1, &x, 0.3, pressed, -0.02);
    let (state, closed) = predicted_tractions(&pair, 1, &old, &x, None);
    let closed = closed.expect("a closed point");
    let error = |size: f64| {
        let correction = |dof: usize| size * [0.3, 1.0, -0.7, 0.4, -0.2, 0.9][dof % 6];
        let moved: Positions =
            (0..x.len()).map(|node| x[node] + Vector2::new(correction(2 * node), correction(2 * node + 1))).collect();
        let now = predicted_tractions(&pair, 1, &old, &moved, None).0.friction;
        let prediction = closed.prediction(correction);
        (prediction.pressure - now.pressure).abs() + (prediction.traction - now.traction).abs()
    };
    let ratio = error(2e-3) / error(1e-3);
    assert!((3.7..4.3).contains(&ratio), "{ratio}");
    let other = Some(Tractions { pressure: 3.0, traction: -1.0 });
    let (same, changed) = predicted_tractions(&pair, 1, &old, &x, other);
    let changed = changed.expect("a closed point");
    assert_eq!((same, &changed.contribution.force), (state, &closed.contribution.force));
    assert_ne!(changed.contribution.tangent, closed.contribution.tangent);
    // Lifted a little, the point opens; with a prediction it is held back by what its spring would pull.
    let mut lifted = x.clone();
    lifted[7].y += 0.06;
    assert!(predicted_tractions(&pair, 1, &old, &lifted, None).1.is_none());
    let (held, _) = predicted_tractions(&pair, 1, &old, &lifted, other);
    assert_eq!(held.friction.pressure, -pair.alpha_n * held.gap);
    assert!(held.gap > 0.0 && held.friction.pressure < 0.0);
}

/// A point above the plane y = 0 by 0.03 at the start of an increment and pressed by p = 10 at its end, having moved by 0.005
/// along it: it sticks with q = α_t 0.005 d/(0.03 + d). With the plain penalty d = c p + p/α_n, where bodies do not settle
/// p/α_n; with the augmented Lagrangian d = c p, whatever α_n.
#[test]
fn slip_counts_from_touch() {
    let plane = Shape::Plane(Plane { point: Vector2::zeros(), normal: Vector2::new(0.0, 1.0) });
    let plain = pair(gauss_points(&[vec![0, 1]], 2), Master::Rigid(plane.into()), COULOMB);
    let check = |pair: &ContactPair, deep: f64, during: ContactIncrement, d: f64| {
        let x = vec![Vector2::new(0.2, -deep), Vector2::new(0.9, -deep)];
        let old = pulled(pair, 0, &x, 0.005, pair.laws[0].law.initial_state(0.0, 0.0), 0.03);
        check_tangent(pair, 0, &old, &x, "after touch");
        let friction =
            answer(pair, 0, &old, &x, PointIncrement { during, prediction: Prediction::default() }).0.friction;
        assert!((friction.pressure - 10.0).abs() < 1e-12);
        let expected = 700.0 * 0.005 * d / (0.03 + d);
        assert!((friction.traction - expected).abs() < 1e-12, "{}, not {expected}", friction.traction);
    };
    check(&plain, 0.01, INCREMENT, 0.02 + 0.01);
    check(&plain, 0.01, ContactIncrement { settles: false, ..INCREMENT }, 0.01);
    let augmented = ContactPair { penetration: Some(1e-6), ..plain };
    check(&augmented, 0.01, INCREMENT, 0.02);
    check(&augmented, 0.0001, ContactIncrement { stiffening: 100.0, ..INCREMENT }, 0.02);
}

/// Friction of a point that has just closed far too deep answers under the pressure carried, and goes on from there in a
/// straight line: a correction that leaves this pressure finds the answer of the law, in stick and in slip, from a gap and from
/// touch.
#[test]
fn a_carried_pressure_is_where_the_answer_is_exact() {
    let plane = Shape::Plane(Plane { point: Vector2::zeros(), normal: Vector2::new(0.0, 1.0) });
    let pair = pair(gauss_points(&[vec![0, 1]], 2), Master::Rigid(plane.into()), COULOMB);
    let at = |y: f64| vec![Vector2::new(0.2, y), Vector2::new(0.9, y)];
    for (back, gap) in [(0.002, 0.03), (0.2, 0.03), (0.002, 0.0), (0.2, 0.0)] {
        let old = pulled(&pair, 0, &at(-0.04), back, pair.laws[0].law.initial_state(0.0, 0.0), gap);
        let increment =
            |carried| PointIncrement { during: INCREMENT, prediction: Prediction { carried, ..Prediction::default() } };
        let (deep, closed) = answer(&pair, 0, &old, &at(-0.04), increment(Some(5.0)));
        assert!((deep.friction.pressure - 40.0).abs() < 1e-12);
        let prediction = closed.expect("a closed point").prediction(|dof| if dof % 2 == 1 { 0.035 } else { 0.0 });
        let there = answer(&pair, 0, &old, &at(-0.005), increment(None)).0.friction;
        let off = (prediction.pressure - there.pressure).abs().max((prediction.traction - there.traction).abs());
        assert!(off < 1e-12 && there.traction > 0.0, "{prediction:?}, {there:?}");
    }
}

/// A rigid master that moves with a body of two nodes behind those of the slave.
fn moving(shape: Shape, slaves: usize) -> Rigid {
    let body = RigidBody { name: "tool".into(), reference: slaves, turning: slaves + 1, radius: TURNING, inertia: 0.0 };
    Rigid { shape, body: Some(body) }
}

/// r of [`moving`].
const TURNING: f64 = 1.7;

/// Places that a rigid body sees where it has moved and turned, and those of its nodes. (Its reference point is the origin.)
fn seen(x: &Positions, shift: [f64; 2], angle: f64) -> Positions {
    let shift = Vector2::from(shift);
    let placed = x.iter().map(|x| shift + Rotation2::new(angle) * x);
    placed.chain([shift, Vector2::new(TURNING * angle, 0.0)]).collect()
}

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

#[test]
fn tangent_equals_differences_on_quadratic_edges() {
    let (_, mut x) = wavy();
    // Two parabolas: nodes 0, 1, 2 and 2, 3, 5, whose middle is not in the middle.
    x.remove(4);
    let edges = [vec![2, 0, 1], vec![4, 2, 3]];
    let slave = [vec![5, 7, 6]];
    for points in [gauss_points(&slave, 4), nodal_points(&slave)] {
        for law in [SUPER, COULOMB] {
            let pair = pair(points.clone(), Master::Mesh(Surface::new(&edges)), law);
            let pressed = FrictionState { traction: 2.0, pressure: 20.0, ..pair.laws[0].law.initial_state(0.0, 0.0) };
            let mut closed = 0;
            for k in 0..pair.points.len() {
                let open = evaluate(&pair, k, &pulled(&pair, k, &x, 0.0, pressed.clone(), -0.02), &x).0.regime()
                    == Regime::Open;
                for back in [1e-4, 0.01, 0.2, -0.3] {
                    if !open {
                        check_tangent(&pair, k, &pulled(&pair, k, &x, back, pressed.clone(), -0.02), &x, law);
                        closed += 1;
                    }
                }
            }
            assert!(closed > 4, "{closed} points were tested");
        }
    }
}

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

/// Under the augmented Lagrangian a contact that starts closed has its pressure as multiplier, and no penetration that passes
/// would take away.
#[test]
fn initial_pressure_is_the_first_multiplier_of_the_augmented_lagrangian() {
    let (edges, x) = wavy();
    let master = Master::Mesh(Surface::new(&edges));
    let mut pair =
        ContactPair { penetration: Some(1e-6), ..pair(gauss_points(&[vec![6, 7], vec![7, 8]], 2), master, COULOMB) };
    let at = Configuration::undeformed(&x);
    pair.start_closed(vec![InitialTraction { pressure: 20.0, traction: 2.0 }; pair.points.len()], &at).expect("feet");
    let old = pair.initial_states(&at);
    for stiffening in [1.0, 100.0] {
        let during = ContactIncrement { stiffening, ..INCREMENT };
        let states: Vec<ContactState> =
            respond(&pair, &old, [&at, &at], during).into_iter().map(|(state, _)| state).collect();
        for state in &states {
            let FrictionState { pressure, traction, .. } = state.friction;
            assert!((pressure - 20.0).abs() < 1e-12 && (traction - 2.0).abs() < 1e-12, "{state:?}");
            assert!(state.gap.abs() < 1e-15 && (state.multiplier - 20.0).abs() < 1e-12, "{state:?}");
        }
        assert!(pair.excess(&states)[0] < 1e-6);
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
        for (k, expected) in expected.into_iter().enumerate() {
            let mut met = Kinematics::new(false);
            mortar
                .facing(&master, &overlaps)
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
            let facing = mortar.facing(&surface, &overlaps);
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
fn check_mortar_tangent(
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
    mortar.facing(surface, &was).weigh(k, &before, &mut room, &mut weights);
    let weights = Some(weights).filter(|weights| !weights.is_empty());
    let open = pair.laws[0].law.initial_state(0.0, 0.0);
    let friction = if gap > 0.0 { open } else { FrictionState { traction: 2.0, pressure: 20.0, ..open } };
    let old = committed(friction, MasterPoint { segment: 0, xi: 0.0 }, gap);
    let increment = PointIncrement { during: INCREMENT, prediction: Prediction::default() };
    let evaluate = |x: &Positions| {
        let x = Configuration::undeformed(x);
        let is = overlaps(pair, mortar, surface, &x);
        let mut kinematics = Kinematics::new(true);
        let facing = mortar.facing(surface, &is);
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

/// A valley: a point has gone through its bottom, and the closest point is the node there.
#[test]
fn tangent_equals_differences_at_a_concave_corner() {
    let x =
        [(-1.0, 0.5), (0.0, 0.0), (1.0, 0.5), (-0.3, -0.101), (0.3, -0.1)].map(|(x, y)| Vector2::new(x, y)).to_vec();
    let pair = pair(gauss_points(&[vec![3, 4]], 3), Master::Mesh(Surface::new(&[vec![1, 0], vec![2, 1]])), SUPER);
    let at = &Configuration::undeformed(&x);
    let master_point = Index::new(&pair.master, at).project(&pair.points[1], None, at).expect("a foot");
    assert!(master_point.gap < 0.0 && master_point.bound == Bound::Node(1));
    let pressed = FrictionState { traction: 1.0, pressure: 10.0, ..pair.laws[0].law.initial_state(0.0, 0.0) };
    let old = committed(pressed, Some(MasterPoint { segment: 0, xi: 0.9 }), -0.05);
    check_tangent(&pair, 1, &old, &x, "concave corner");
}

#[test]
fn open_points_add_nothing() {
    let (edges, mut x) = wavy();
    for slave in &mut x[6..] {
        slave.y += 1.0;
    }
    let pair = pair(gauss_points(&[vec![6, 7], vec![7, 8]], 2), Master::Mesh(Surface::new(&edges)), SUPER);
    let states = pair.initial_states(&Configuration::undeformed(&x));
    for (k, old) in states.iter().enumerate() {
        let (state, contribution) = evaluate(&pair, k, old, &x);
        assert!(contribution.is_none() && state.regime() == Regime::Open && state.gap > 0.5);
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

/// A master of n segments and a slave of as many edges below it, that match: many points lie over nodes, where two segments are
/// equally near. Straight, or with middle nodes.
fn strips(n: usize, quadratic: bool) -> (Vec<Vec<usize>>, Vec<Vec<usize>>, Positions) {
    let place =
        |k: usize, y: f64| Vector2::new(0.1 * k as f64, y + if quadratic { 0.01 * (k % 2) as f64 } else { 0.0 });
    let step = if quadratic { 2 } else { 1 };
    let nodes = step * n + 1;
    let x = (0..nodes).map(|k| place(k, 0.0)).chain((0..nodes).map(|k| place(k, -1e-4))).collect();
    let edge = |first: usize, last: usize| match quadratic {
        true => vec![first, last, (first + last) / 2],
        false => vec![first, last],
    };
    let master = (0..n).map(|k| edge(step * (k + 1), step * k)).collect();
    let slave = (0..n).map(|k| edge(nodes + step * k, nodes + step * (k + 1))).collect();
    (master, slave, x)
}

/// A response handed from evaluation to evaluation, with the tree of the master as it was built some motions ago, is that of a
/// response made anew, and what a residual is answered is what a tangent is: every state and every force in every bit. The
/// slave slides by trifles, by parts of an edge and over several edges, and the master stretches, shrinks and waves under it.
#[test]
fn what_is_kept_and_what_is_left_out_changes_no_bit() {
    let plane = Shape::Plane(Plane { point: Vector2::new(0.0, 0.02), normal: Vector2::new(0.0, 1.0) });
    for quadratic in [false, true] {
        let (master, slave, x) = strips(30, quadratic);
        let surface = || Master::Mesh(Surface::new(&master));
        let smooth = Master::Mesh(Surface::new(&master).smoothed(&x));
        let mortar = |master: Master| {
            let (points, mortar) = mortar_points(&slave, Hats::OfEdges, &x);
            ContactPair { mortar: Some(mortar), ..pair(points, master, COULOMB) }
        };
        let pairs = [
            pair(nodal_points(&slave), surface(), SUPER),
            pair(gauss_points(&slave, 3), surface(), COULOMB),
            pair(gauss_points(&slave, 2), if quadratic { surface() } else { smooth }, SUPER),
            pair(gauss_points(&slave, 2), Master::Rigid(plane.clone().into()), COULOMB),
            mortar(surface()),
            mortar(Master::Rigid(plane.clone().into())),
        ];
        for (number, pair) in pairs.iter().enumerate() {
            let (mut kept, mut closed, mut went_over) = (PairResponse::default(), 0, 0);
            let mut before = vec![0.0; 2 * x.len()];
            let mut old = pair.initial_states(&Configuration::new(&x, &before));
            for k in 0..40 {
                // From trifles to three edges an increment, and back.
                let way = 0.3 * 10f64.powi(-(k % 7));
                let mut now = before.clone();
                for (node, u) in now.chunks_mut(2).enumerate() {
                    let wave = (1.7 * f64::from(k) + 0.9 * node as f64).sin();
                    let side = if k < 20 { 1.0 } else { -1.0 };
                    if node < x.len() / 2 {
                        u[0] += 0.4 * side * way * (x[node].x - 1.5);
                        u[1] += 0.01 * way * wave;
                    } else {
                        u[0] -= side * way * (1.0 + 0.01 * wave);
                        u[1] -= 1e-6 * wave;
                    }
                }
                let [was, is] = [&before, &now].map(|u| Configuration::new(&x, u));
                let answer = |request: Request, response: &mut PairResponse| {
                    let nothing = |_| Prediction::default();
                    pair.respond(&old, [&was, &is], INCREMENT, nothing, request, response).expect("an answer");
                };
                let [mut fresh, mut whole] = [(); 2].map(|()| PairResponse::default());
                answer(Request::Residual, &mut fresh);
                answer(Request::Tangent, &mut whole);
                // Ends with a residual or a tangent in the kept lists, as iterations do.
                answer(if k % 2 == 0 { Request::Tangent } else { Request::Residual }, &mut kept);
                answer(Request::Residual, &mut kept);
                let what = format!("pair {number}, quadratic: {quadratic}, increment {k}");
                assert_eq!(fresh.states, kept.states, "{what}");
                assert_eq!(fresh.states, whole.states, "{what}");
                for (point, (first, last)) in old.iter().zip(&fresh.states).enumerate() {
                    let [a, b, c] = [&fresh, &kept, &whole].map(|response| response.closed(point));
                    assert_eq!(a, b, "{what}, point {point}");
                    let forces =
                        |closed: Option<Closed>| closed.map(|c| (c.nodes.to_vec(), c.force.to_vec(), c.tractions));
                    assert_eq!(forces(a), forces(c), "{what}, point {point}");
                    closed += usize::from(a.is_some());
                    let segment = |state: &ContactState| state.master_point.map(|master_point| master_point.segment);
                    went_over += usize::from(segment(first) != segment(last));
                }
                old.clone_from(&fresh.states);
                before = now;
            }
            assert!(closed > 500, "pair {number}: {closed} closed points were compared");
            assert!(went_over > 100 || matches!(pair.master, Master::Rigid(_)), "pair {number}: {went_over}");
        }
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
