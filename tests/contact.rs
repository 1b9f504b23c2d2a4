//! Contact: exact tangents, feet at corners and past ends.

use fecontact::configuration::Configuration;
use fecontact::contact::force::{ContactState, Increment, Presume, Status, respond};
use fecontact::contact::pair::{ContactPair, InitialTraction};
use fecontact::contact::projection::Bound;
use fecontact::contact::search::Index;
use fecontact::contact::surface::{
    Master, MasterPoint, Plane, SlavePoint, Surface, gauss_points, lone_point, nodal_points,
};
use fecontact::friction::{FrictionParameters, FrictionState};
use fecontact::system::Contribution;
use nalgebra::Vector2;

type Positions = Vec<Vector2<f64>>;

const SUPER: &str =
    r#"{"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "r": 100, "kappa": 10, "xi": 0.02, "structure": 1.8}"#;
const COULOMB: &str = r#"{"law": "coulomb", "mu": 0.3}"#;
const FRICTIONLESS: &str = r#"{"law": "frictionless"}"#;

/// A wavy master of five segments, nodes 0 to 5 from left to right, and slave nodes 6, 7, 8 below it.
///
/// Bodies are on the left of their edges: a top edge runs right to left, a bottom edge left to right.
fn wavy() -> (Vec<Vec<usize>>, Positions) {
    let master = [(0.0, 0.0), (1.0, 0.06), (2.0, -0.05), (3.0, 0.03), (4.0, 0.0), (5.0, 0.05)];
    let slave = [(1.3, -0.03), (2.1, -0.07), (2.9, -0.02)];
    let x = master.iter().chain(&slave).map(|&(x, y)| Vector2::new(x, y)).collect();
    ((0..5).map(|k| vec![k + 1, k]).collect(), x)
}

/// A pair with α_n = 1000 and, unless given, α_t = 700.
fn pair(points: Vec<SlavePoint>, master: Master, law: &str) -> ContactPair {
    let law =
        serde_json::from_str::<FrictionParameters>(law).expect("a law").build(700.0).expect("parameters in range");
    ContactPair { name: "test".into(), points, master, alpha_n: 1000.0, law, initial: None }
}

fn evaluate(pair: &ContactPair, k: usize, old: &ContactState, x: &Positions) -> (ContactState, Option<Contribution>) {
    let x = &Configuration::undeformed(x);
    let index = Index::new(&pair.master, x);
    let increment = Increment { dt: 0.3, presume: Presume::Nothing };
    respond(pair, &pair.points[k], index.project(&pair.points[k], None, x), old, increment, x)
        .expect("a finite increment")
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
    let x = &Configuration::undeformed(x);
    let foot = Index::new(&pair.master, x).project(&pair.points[k], None, x).expect("the point faces the master").foot;
    let at = foot.segment as f64 + foot.xi - back;
    let foot = match &pair.master {
        Master::Mesh(_) => MasterPoint { segment: at.floor() as usize, xi: at - at.floor() },
        Master::Plane(_) => MasterPoint { segment: 0, xi: foot.xi - back },
    };
    ContactState { friction, foot: Some(foot), gap }
}

#[test]
fn tangent_equals_differences_in_stick_partial_and_full_slip_and_after_touch() {
    let (edges, x) = wavy();
    let (linear, quadratic) = ([vec![6, 7], vec![7, 8]], [vec![6, 8, 7]]);
    let all = [gauss_points(&linear, 3), nodal_points(&linear), gauss_points(&quadratic, 4), nodal_points(&quadratic)];
    for points in all {
        for law in [SUPER, COULOMB, FRICTIONLESS] {
            let pair = pair(points.clone(), Master::Mesh(Surface::new(&edges)), law);
            let pressed = FrictionState { traction: 2.0, pressure: 20.0, ..pair.law.initial_state() };
            let mut closed = 0;
            for k in 0..pair.points.len() {
                let (state, _) = evaluate(&pair, k, &pulled(&pair, k, &x, 0.0, pressed, -0.02), &x);
                if state.status() == Status::Open {
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
                    let old = pulled(&pair, k, &x, back, pressed, gap);
                    check_tangent(&pair, k, &old, &x, &format!("{law}, {what}"));
                }
            }
            assert!(closed > 1, "{closed} points were tested");
        }
    }
}

#[test]
fn tangent_equals_differences_on_a_plane() {
    let x: Positions = vec![Vector2::new(0.2, -0.01), Vector2::new(0.9, -0.03)];
    let plane = Plane { point: Vector2::new(0.0, 0.0), normal: Vector2::new(-0.06, 1.0).normalize() };
    let pair = pair(gauss_points(&[vec![0, 1]], 2), Master::Plane(plane), SUPER);
    let pressed = FrictionState { traction: 1.0, pressure: 10.0, ..pair.law.initial_state() };
    for k in 0..2 {
        for back in [1e-4, 0.01, -0.2] {
            check_tangent(&pair, k, &pulled(&pair, k, &x, back, pressed, -0.02), &x, "plane");
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
        for master in [Master::Mesh(Surface::new(&edges)), Master::Plane(plane)] {
            let mut pair = pair(points.clone(), master, SUPER);
            let at = Configuration::undeformed(&x);
            pair.start_closed(InitialTraction { pressure: 20.0, traction: 2.0 }, &at).expect("a foot for each");
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
                    let old = pulled(&pair, k, &x, back, state.friction, state.gap);
                    check_tangent(&pair, k, &old, &x, &format!("closed across a gap, {what}"));
                }
            }
        }
    }
}

/// A valley: a point has gone through its bottom, and the closest point is the node there.
#[test]
fn tangent_equals_differences_at_a_concave_corner() {
    let x =
        [(-1.0, 0.5), (0.0, 0.0), (1.0, 0.5), (-0.3, -0.101), (0.3, -0.1)].map(|(x, y)| Vector2::new(x, y)).to_vec();
    let pair = pair(gauss_points(&[vec![3, 4]], 3), Master::Mesh(Surface::new(&[vec![1, 0], vec![2, 1]])), SUPER);
    let at = &Configuration::undeformed(&x);
    let foot = Index::new(&pair.master, at).project(&pair.points[1], None, at).expect("a foot");
    assert!(foot.gap < 0.0 && foot.bound == Bound::Node(1));
    let pressed = FrictionState { traction: 1.0, pressure: 10.0, ..pair.law.initial_state() };
    let old = ContactState { friction: pressed, foot: Some(MasterPoint { segment: 0, xi: 0.9 }), gap: -0.05 };
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
        assert!(contribution.is_none() && state.status() == Status::Open && state.gap > 0.5);
    }
}
