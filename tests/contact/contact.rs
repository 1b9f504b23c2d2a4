//! Contact: exact tangents, feet at corners and past ends.

mod feet;
mod gaps;
mod mortar;
mod rigid;

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
    let active_pressure = predicted_tractions.map_or(0.0, |predicted_tractions| predicted_tractions.pressure);
    let prediction = Prediction { predicted_tractions, active_pressure, ..Prediction::default() };
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
        closures: 0,
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
        let increment = |predicted_pressure| PointIncrement {
            during: INCREMENT,
            prediction: Prediction { predicted_pressure, ..Prediction::default() },
        };
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
