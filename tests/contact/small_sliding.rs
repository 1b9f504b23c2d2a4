//! Small sliding: what it keeps, against finite sliding as slips go to zero, and the warnings where it is none.

use std::sync::Arc;

use super::contact::pair as pair_under;
use crate::common::{self, Blocks, Finished, close, distance, finish, half_way, quadratic};
use crate::contact::INCREMENT;
use fecontact::contact::force::ContactState;
use fecontact::contact::master::{Circle, Master, Shape};
use fecontact::contact::mortar::{Hats, mortar_points};
use fecontact::contact::pair::{ContactPair, Prediction};
use fecontact::contact::response::PairResponse;
use fecontact::contact::small_sliding::{LITTLE_SLIP, LITTLE_TURN};
use fecontact::contact::surface::{Surface, gauss_points, nodal_points};
use fecontact::laws::friction::Regime;
use fecontact::linear::system::Request;
use fecontact::mesh::configuration::Configuration;
use fecontact::output::warnings::Warnings;
use nalgebra::Vector2;
use serde_json::{Value, json};

const METHODS: [&str; 3] = ["gauss_to_segment", "node_to_segment", "mortar"];
const NEWMARK: &str = "newmark";

fn linear() -> Value {
    json!({"material": {"model": "linear", "E": 1000, "nu": 0.3, "density": 1}})
}

fn coulomb(mu: f64) -> Value {
    json!({"law": "coulomb", "mu": mu})
}

/// Two linear blocks with n elements along an interface from (0, ½ − slope/2) to (1, ½ + slope/2), the lower one held.
fn blocks(n: [usize; 2], slope: f64, contact: &Value, steps: Value) -> Value {
    let interface = move |s: f64| 0.5 + slope * (s - 0.5);
    let mut contact = contact.clone();
    contact["slave"] = json!("upper_bottom");
    contact["master"] = json!("lower_top");
    contact["normal"] = json!({"alpha_n": 1e5});
    json!({
        "mesh": Blocks::default()
            .block("lower", [n[0], 4], |s, t| [s, t * interface(s)])
            .block("upper", [n[1], 4], |s, t| [s, interface(s) + t * (1.0 - interface(s))]).json(),
        "bodies": {"lower": linear(), "upper": linear()},
        "contacts": {"base": contact},
        "newton": {"tolerance": 1e-12},
        "steps": steps,
    })
}

/// One increment under a pressure that falls from left to right, and a shear of a third of it.
fn pressed(load: f64, contact: &Value) -> Finished {
    let uneven = |size: f64| format!("{size}*(1.5-x)");
    finish(&blocks(
        [5, 7],
        0.2,
        contact,
        json!([{"name": "press", "duration": 1, "dt": {"initial": 1},
                "supports": [{"on": "lower_bottom", "ux": 0, "uy": 0}],
                "loads": [{"on": "upper_top", "traction": {"x": uneven(load / 3.0), "y": uneven(-load)}}]}]),
    ))
}

/// What small sliding leaves out is of the second order: under a load of 1, 0.1 and 0.01 % of E on meshes that do not match, closed and
/// held by friction all along, the displacements differ from those of finite sliding by 100 times less from one load to the
/// next. Measured: ratios 100 to 103; differences of 1e-4 of the displacement at the first load.
#[test]
fn finite_sliding_is_met_to_the_second_order() {
    for method in METHODS {
        let of = |sliding: &str, load: f64| {
            let contact = json!({"method": method, "sliding": sliding, "friction": coulomb(10.0)});
            pressed(load, &contact).last().displacement.clone()
        };
        let differences = [10.0, 1.0, 0.1].map(|load| {
            let [small, finite] = ["small", "finite"].map(|sliding| of(sliding, load));
            let size = finite.iter().fold(0.0f64, |size, u| size.max(u.abs()));
            (distance(&small, &finite), distance(&small, &finite) / size)
        });
        println!("{method}: {differences:?}");
        assert!(differences[0].1 > 2e-5, "{method}: nothing to compare");
        for pair in differences.windows(2) {
            let ratio = pair[0].0 / pair[1].0;
            assert!((80.0..130.0).contains(&ratio), "{method}: {ratio}");
        }
    }
}

/// σ_yy at all quadrature points.
fn vertical_stress(run: &Finished) -> Vec<f64> {
    let (model, u) = (&run.model, &run.last().displacement);
    let of = |e: usize| {
        let nodes = model.mesh.elements[e].nodes.iter();
        let u: Vec<_> = nodes.map(|&node| Vector2::new(u[2 * node], u[2 * node + 1])).collect();
        let body = &model.bodies[model.body_of_element[e]];
        model.solids[e].stresses(&*body.material, &[], &u).expect("no element is inverted")
    };
    (0..model.mesh.elements.len()).flat_map(of).map(|stress| stress.yy).collect()
}

/// The contact patch test: σ_yy = −p to round-off by mortar on meshes that do not match and by all methods on those that do,
/// level and slanted. The slanted blocks settle by the elastic slip of the interface, which changes nothing: what faces what is
/// kept. Measured: 4e-13.
#[test]
fn the_patch_test_is_passed() {
    let error = |n: [usize; 2], slope: f64, method: &str| {
        let contact = json!({"method": method, "sliding": "small", "friction": coulomb(1.0)});
        let steps = json!([{"name": "press", "duration": 1, "dt": {"initial": 1},
                            "supports": [{"on": "lower_bottom", "uy": 0}, {"on": "lower_left", "ux": 0}],
                            "loads": [{"on": "upper_top", "traction": {"y": -1}}]}]);
        let run = finish(&blocks(n, slope, &contact, steps));
        vertical_stress(&run).iter().fold(0.0f64, |most, stress| most.max((stress + 1.0).abs()))
    };
    for slope in [0.0, 0.2] {
        for n in [[5, 7], [7, 5], [3, 8]] {
            close("mortar", error(n, slope, "mortar"), 0.0, 1e-11);
        }
        for method in METHODS {
            close(method, error([6, 6], slope, method), 0.0, 1e-11);
        }
    }
}

/// Linear bodies, closed and held by friction: twice the load has twice the answer, one linear solve an increment finds it, and
/// the energies balance to round-off. By finite sliding none of the three is so.
#[test]
fn all_but_friction_and_opening_is_linear() {
    for method in METHODS {
        let run = |sliding: &str, load: f64| {
            pressed(load, &json!({"method": method, "sliding": sliding, "friction": coulomb(10.0)}))
        };
        let found = ["small", "finite"].map(|sliding| {
            let [once, twice] = [10.0, 20.0].map(|load| run(sliding, load));
            let doubled: Vec<f64> = once.last().displacement.iter().map(|u| 2.0 * u).collect();
            let error =
                distance(&twice.last().displacement, &doubled) / doubled.iter().fold(0.0f64, |m, u| m.max(u.abs()));
            let energy = &once.last().energy;
            (error, once.report.newton_iterations, (energy.error() / energy.external_work).abs())
        });
        println!("{method}: {found:?}");
        let [(error, solves, energy), (finite_error, finite_solves, finite_energy)] = found;
        assert!(error < 1e-10 && solves == 1 && energy < 1e-10, "{method}");
        assert!(finite_error > 2e-5 && finite_solves > 2 && finite_energy > 1e-6, "{method}");
    }
}

/// A wavy master of five segments, nodes 0 to 5, and a slave of two edges, nodes 6 to 8, a little below or above it.
fn wavy(law: &str, method: &str, gap: f64) -> (ContactPair, Vec<Vector2<f64>>) {
    let master = [(0.0, 0.0), (1.0, 0.06), (2.0, -0.05), (3.0, 0.03), (4.0, 0.0), (5.0, 0.05)];
    let slave = [(1.3, 0.01 + gap), (2.1, -0.03 + gap), (2.9, 0.02 + gap)];
    let x: Vec<_> = master.iter().chain(&slave).map(|&(x, y)| Vector2::new(x, y)).collect();
    let edges = [vec![6, 7], vec![7, 8]];
    let (points, mortar) = match method {
        "mortar" => {
            let (points, mortar) = mortar_points(&edges, Hats::OfEdges, &x);
            (points, Some(mortar))
        }
        "node_to_segment" => (nodal_points(&edges), None),
        _ => (gauss_points(&edges, 3), None),
    };
    let master: Vec<Vec<usize>> = (0..5).map(|k| vec![k + 1, k]).collect();
    let mut pair = pair_under(points, Master::Mesh(Surface::new(&master)), law);
    pair.mortar = mortar;
    pair.slide_little(&Configuration::undeformed(&x));
    (pair, x)
}

/// Forces on all nodes, their derivative by the tangents of the points, and the states.
pub fn answer(
    pair: &ContactPair,
    x: &[Vector2<f64>],
    old: &[ContactState],
    [before, u]: [&[f64]; 2],
) -> (Vec<f64>, Vec<Vec<f64>>, Vec<ContactState>) {
    let [before, now] = [before, u].map(|u| Configuration::new(x, u));
    let mut response = PairResponse::default();
    let is_predicted = |_| Prediction::default();
    pair.respond(old, [&before, &now], INCREMENT, is_predicted, Request::Tangent, &mut response).expect("an answer");
    let n = 2 * x.len();
    let (mut forces, mut tangent) = (vec![0.0; n], vec![vec![0.0; n]; n]);
    for (_, added) in response.all_acting() {
        let dofs: Vec<usize> = added.nodes.iter().flat_map(|&node| [2 * node, 2 * node + 1]).collect();
        for (a, &row) in dofs.iter().enumerate() {
            forces[row] += added.force[a];
            for (b, &column) in dofs.iter().enumerate() {
                tangent[row][column] += added.tangent[a + dofs.len() * b];
            }
        }
    }
    (forces, tangent, response.states)
}

/// Some displacement of all nodes.
fn motion(n: usize, size: f64, shift: [f64; 2]) -> Vec<f64> {
    (0..n).map(|k| size * (1.0 + 7.3 * k as f64).sin() + if k >= 12 { shift[k % 2] } else { 0.0 }).collect()
}

const SUPER: &str = r#"{"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "r": 100, "kappa": 10, "xi": 0.02, "structure": 1.8,
        "integration": "backward_euler"}"#;
const COULOMB: &str = r#"{"law": "coulomb", "mu": 0.3}"#;

/// Tangent by central differences, sticking, slipping and after touch within the increment; and the rows of every point are the
/// derivatives of its gap and its slip.
#[test]
fn tangents_and_rows_equal_differences() {
    for method in METHODS {
        for (law, radiation) in [(SUPER, 0.0), (COULOMB, 0.0), (SUPER, 150.0)] {
            for (gap, slip, wanted) in [(0.0, 1e-4, Regime::Stick), (0.0, 0.1, Regime::Slip), (0.12, 0.1, Regime::Slip)]
            {
                let (mut pair, x) = wavy(law, method, gap);
                pair.radiation = radiation;
                let n = 2 * x.len();
                let rest = pair.initial_states(&Configuration::undeformed(&x));
                let before = motion(n, 1e-5, [0.0, if gap > 0.0 { 0.0 } else { -0.06 }]);
                let old = if gap > 0.0 { rest } else { answer(&pair, &x, &rest, [&vec![0.0; n], &before]).2 };
                let u = motion(n, 2e-5, [slip, -0.06 - 1.5 * gap]);
                let (_, tangent, states) = answer(&pair, &x, &old, [&before, &u]);
                let what = format!("{method}, {law}, {wanted:?}");
                assert!(states.iter().any(|state| state.regime() == wanted), "{what}: {states:?}");
                let scale = tangent.iter().flatten().fold(0.0f64, |most, k| most.max(k.abs()));
                let h = 1e-6;
                for column in 0..n {
                    let moved = |by: f64| {
                        let mut u = u.clone();
                        u[column] += by;
                        answer(&pair, &x, &old, [&before, &u])
                    };
                    let [(up, _, above), (down, _, below)] = [moved(h), moved(-h)];
                    for row in 0..n {
                        close(&what, tangent[row][column], (up[row] - down[row]) / (2.0 * h), 1e-6 * scale);
                    }
                    for (k, point) in pair.small.iter().flat_map(|small| &small.points).enumerate() {
                        let point = point.as_ref().expect("a foot");
                        let at = point.nodes.iter().position(|node| *node == column / 2);
                        let entry = |mut row: Vec<f64>| at.map_or(0.0, |at| row.swap_remove(2 * at + column % 2));
                        let rate = |value: fn(&ContactState) -> f64| (value(&above[k]) - value(&below[k])) / (2.0 * h);
                        close(&what, rate(|s| s.gap), entry(point.normal_row().collect()), 1e-8);
                        let sliding = if above[k].slip == 0.0 { 0.0 } else { entry(point.tangent_row().collect()) };
                        close(&what, rate(|s| s.slip), sliding, 1e-8);
                    }
                }
            }
        }
    }
}

/// The forces of the two sides are in balance. Where a point has slid by d from its foot and has the gap g, their moment is
/// −(p d + q g) ℓ: what is left out, and what finite sliding leaves as well.
#[test]
fn forces_balance_and_their_moment_is_that_of_the_slip() {
    for method in METHODS {
        let (pair, x) = wavy(COULOMB, method, 0.0);
        let n = 2 * x.len();
        let rest = pair.initial_states(&Configuration::undeformed(&x));
        let u = motion(n, 1e-3, [0.2, -0.06]);
        let (forces, _, states) = answer(&pair, &x, &rest, [&vec![0.0; n], &u]);
        let now = Configuration::new(&x, &u);
        let sum = |of: &dyn Fn(usize) -> f64| (0..x.len()).map(of).sum::<f64>();
        let size = forces.iter().fold(0.0f64, |most, f| most.max(f.abs()));
        close("along x", sum(&|k| forces[2 * k]), 0.0, 1e-14 * size);
        close("along y", sum(&|k| forces[2 * k + 1]), 0.0, 1e-14 * size);
        let moment = sum(&|k| now.at(k).x * forces[2 * k + 1] - now.at(k).y * forces[2 * k]);
        let expected = |(state, point): (&ContactState, &Option<_>)| {
            let point: &fecontact::contact::small_sliding::SmallPoint = point.as_ref().expect("a foot");
            let apart: Vector2<f64> = point.nodes.iter().zip(&point.weights).map(|(&node, &w)| now.at(node) * w).sum();
            let friction = &state.friction;
            -(friction.pressure * apart.dot(&point.tangent) + friction.traction * state.gap) * state.length
        };
        let points = &pair.small.as_ref().expect("small sliding").points;
        let expected: f64 = states.iter().zip(points).map(expected).sum();
        assert!(expected.abs() > 0.1 * size, "{method}: {expected}");
        close(method, moment, expected, 1e-13 * size);
    }
}

/// A common translation by 10⁸ lengths leaves not a bit of gap, slip or force.
#[test]
fn a_translation_leaves_no_round_off() {
    for method in METHODS {
        let (pair, x) = wavy(COULOMB, method, 0.0);
        let n = 2 * x.len();
        let rest = pair.initial_states(&Configuration::undeformed(&x));
        let still = answer(&pair, &x, &rest, [&vec![0.0; n], &vec![0.0; n]]);
        let far: Vec<f64> = (0..n).map(|k| [1.1e8, -3.7e8][k % 2]).collect();
        let moved = answer(&pair, &x, &rest, [&vec![0.0; n], &far]);
        assert_eq!((still.0, still.2), (moved.0, moved.2), "{method}");
    }
}

/// A fault between two periodic blocks, under p from above, whose upper side moves: the answer is that of a column of two springs
/// and the interface, the same at every point and however far it has slid, statically and in dynamics. (By finite sliding
/// points slide off the end.)
#[test]
fn a_periodic_fault_slides_under_uniform_tractions() {
    for scheme in [json!("static"), json!({NEWMARK: {}}), json!({"explicit": {}})] {
        let contact = json!({"sliding": "small", "friction": coulomb(0.4), "normal": {"alpha_n": 1e4},
                             "initial": {"pressure": 1, "balanced": true}});
        let mut case = blocks(
            [6, 6],
            0.0,
            &contact,
            json!([
                {"name": "slide", "duration": 8, "scheme": scheme, "dt": {"initial": 0.02},
                 "supports": [{"on": "lower_bottom", "ux": 0, "uy": 0}, {"on": "upper_top", "ux": {"rate": 0.05}, "uy": 0}]}
            ]),
        );
        case["bodies"]["lower"]["damping"] = json!({"mass": 5});
        case["bodies"]["upper"]["damping"] = json!({"mass": 5});
        case["periodic"] = json!([["lower_left", "lower_right"], ["upper_left", "upper_right"]]);
        let run = finish(&case);
        let first = run.last().contacts[0][0].friction.clone();
        assert!(first.plastic_slip > 0.3, "{scheme}: {first:?}");
        for state in &run.last().contacts[0] {
            close("pressure", state.friction.pressure, 1.0, 1e-9);
            close("traction", state.friction.traction, 0.4, 1e-9);
            close("slip", state.friction.plastic_slip, first.plastic_slip, 1e-9);
        }
        let energy = &run.last().energy;
        close("energy", energy.error() / energy.external_work, 0.0, 2e-3);
    }
}

/// What a run says of small sliding.
fn message(case: &Value) -> Vec<String> {
    let (mut warnings, model) = (Warnings::default(), Arc::new(common::model(case)));
    fecontact::run::run(&model, &mut [&mut warnings]).1.unwrap_or_else(|error| panic!("{error}"));
    warnings.list.into_iter().filter(|warning| warning.contains("small sliding")).collect()
}

fn dragged(by: f64, lifted: f64) -> Value {
    let contact = json!({"sliding": "small", "friction": {"law": "frictionless"}});
    let steps = json!([{"name": "drag", "duration": 1, "dt": {"initial": 0.5},
        "supports": [{"on": "lower_bottom", "ux": 0, "uy": 0}, {"on": "upper", "ux": by, "uy": lifted}]}]);
    blocks([5, 7], 0.0, &contact, steps)
}

/// A run warns where a point, closed or open, slides by more than the stated share of the shorter edge, or a surface
/// turns by more than the stated angle; and not before.
#[test]
fn what_is_no_small_sliding_is_reported() {
    let edge = 1.0 / 7.0;
    for lifted in [0.0, 0.01] {
        assert_eq!(message(&dragged(0.95 * LITTLE_SLIP * edge, lifted)), Vec::<String>::new());
        for way in [1.05, -1.05] {
            let far = message(&dragged(way * LITTLE_SLIP * edge, lifted));
            assert!(far.len() == 1 && far[0].contains("10.5 % of the distance between nodes, but small"), "{far:?}");
        }
    }
    for (share, count) in [(0.95, 0), (1.05, 1)] {
        let mut case = dragged(share * LITTLE_SLIP * 0.5 * edge, 0.0);
        case["mesh"] = quadratic(&case["mesh"], half_way);
        assert_eq!(message(&case).len(), count, "quadratic edges");
    }
    for (share, count) in [(0.95, 0), (1.05, 1)] {
        let angle = share * LITTLE_TURN;
        let mut case = dragged(0.0, 0.0);
        let turn = json!({"about": [0.5, 0.5], "angle": angle});
        case["steps"][0]["supports"] = json!([{"on": "lower", "rotation": turn}, {"on": "upper", "rotation": turn}]);
        let turned = message(&case);
        assert_eq!(turned.len(), count, "{turned:?}");
        assert!(turned.iter().all(|message| message.contains("rotated by 0.021 rad")), "{turned:?}");
    }
    for (share, count) in [(0.95, 0), (1.05, 1), (-1.05, 1)] {
        let mut case = dragged(0.0, 0.0);
        let wider = format!("{}*x", share * LITTLE_TURN);
        case["steps"][0]["supports"] =
            json!([{"on": "lower", "ux": wider, "uy": 0}, {"on": "upper", "ux": wider, "uy": 0}]);
        let stretched = message(&case);
        assert_eq!(stretched.len(), count, "{stretched:?}");
        assert!(stretched.iter().all(|message| message.contains("2.1 % longer or shorter")), "{stretched:?}");
    }
    let finite = |mut case: Value| {
        case["contacts"]["base"]["sliding"] = json!("finite");
        message(&case)
    };
    assert_eq!(finite(dragged(0.5, 0.0)), Vec::<String>::new());
}

/// On a rigid plane small sliding is finite sliding, however far, but for the stretch of the slave; on a circle the normal turns,
/// and past the end of a polyline nothing is.
#[test]
fn rigid_bodies_are_left_where_their_normal_turns() {
    let mesh = Blocks::default().rectangle("block", [4, 2], [-0.2, 0.0], [0.2, 0.3]);
    let case = |master: Value, by: f64| {
        json!({"mesh": mesh.json(), "bodies": {"block": linear()},
            "contacts": {"base": {"slave": "block_bottom", "master": master, "sliding": "small", "friction": coulomb(0.3)}},
            "steps": [{"name": "slide", "duration": 1, "dt": {"initial": 0.5}, "supports": [{"on": "block", "ux": by, "uy": -1e-5}]}]})
    };
    let plane = json!({"plane": {"point": [0, 0], "normal": [0, 1]}});
    assert_eq!(message(&case(plane, 7.0)), Vec::<String>::new());
    let circle = |by: f64| message(&case(json!({"circle": {"centre": [0, -5], "radius": 5}}), by));
    assert_eq!(circle(0.95 * LITTLE_TURN * 5.0), Vec::<String>::new());
    assert!(circle(1.1 * LITTLE_TURN * 5.0).iter().any(|message| message.contains("rotated by")));
    let line = |by: f64| message(&case(json!({"polyline": {"points": [[-1, 0], [1, 0]]}}), by));
    assert_eq!(line(0.5), Vec::<String>::new());
    assert!(line(1.5).iter().any(|message| message.contains("past the end")), "{:?}", line(1.5));
}

/// On a rigid circle, points are held on the tangents at their feet: the answer of a pair, against the plane through the foot.
#[test]
fn a_circle_is_its_tangent() {
    let x = vec![Vector2::new(-0.3, 1.96), Vector2::new(0.4, 1.95)];
    let circle = Shape::Circle(Circle { centre: Vector2::zeros(), radius: 2.0, hole: false });
    let circle = Master::Rigid(circle.into());
    let mut pair = pair_under(nodal_points(&[vec![0, 1]]), circle, COULOMB);
    let undeformed = Configuration::undeformed(&x);
    pair.slide_little(&undeformed);
    let u = [0.3, -0.1, 0.2, -0.15];
    let rest = pair.initial_states(&undeformed);
    let (_, _, states) = answer(&pair, &x, &rest, [&[0.0; 4], &u]);
    for (k, state) in states.iter().enumerate() {
        let normal = x[k].normalize();
        let moved = Vector2::new(u[2 * k], u[2 * k + 1]);
        close("gap", state.gap, x[k].norm() - 2.0 + normal.dot(&moved), 1e-15);
        close("slip", state.slip, Vector2::new(normal.y, -normal.x).dot(&moved), 1e-15);
    }
}

/// How far off small sliding is at a tenth of an edge: a block on the ground, its bottom flat or round, pressed by 2 % and
/// slid. Root mean square of the pressures' difference over that of the pressures, and the differences of force and displacement:
///
/// | bottom, method | slip/edge | pressures | force | displacements |
/// |---|---|---|---|---|
/// | flat, mortar | 0.10 | 4.1 % | 0.4 % | 0.6 % |
/// | flat, at nodes | 0.10 | 4.0 % | 1.0 % | 0.8 % |
/// | round, mortar | 0.12 | 14 % | 0.3 % | 0.6 % |
/// | round, at nodes | 0.13 | 2.3 % | 0.0 % | 0.6 % |
#[test]
fn a_tenth_of_an_edge_is_little() {
    let n = 8;
    for (round, method) in [(0.0, "mortar"), (0.0, "node_to_segment"), (0.3, "mortar"), (0.3, "node_to_segment")] {
        let mesh = Blocks::default().rectangle("ground", [4 * n, n], [-2.0, -1.0], [2.0, 0.0]);
        let mesh = mesh.block("block", [n + 1, n], |s, t| {
            let low = 0.5 * round * (s - 0.5).powi(2);
            [s - 0.5, low + t * (0.5 - low)]
        });
        let run = |sliding: &str| {
            finish(&json!({
                "mesh": mesh.json(),
                "bodies": {"ground": linear(), "block": linear()},
                "contacts": {"base": {"slave": "block_bottom", "master": "ground_top", "method": method,
                                      "sliding": sliding, "friction": coulomb(0.3)}},
                "steps": [
                    {"name": "press", "duration": 1, "dt": {"initial": 0.25},
                     "supports": [{"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0, "uy": -0.02}]},
                    {"name": "slide", "duration": 1, "dt": {"initial": 0.125},
                     "supports": [{"on": "block_top", "ux": 0.2 / n as f64}]}
                ]
            }))
        };
        let [finite, small] = ["finite", "small"].map(run);
        let off = |a: &[f64], b: &[f64]| {
            let square = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>();
            (square(&mut a.iter().zip(b).map(|(a, b)| a - b)) / square(&mut b.iter().copied())).sqrt()
        };
        let pressures =
            |run: &Finished| -> Vec<f64> { run.last().contacts[0].iter().map(|c| c.friction.pressure).collect() };
        let slip = finite.last().contacts[0].iter().map(|c| c.friction.plastic_slip).fold(0.0, f64::max) * n as f64;
        let [force, exact] = [&small, &finite].map(|run| run.contact_force(run.last())[0]);
        let found = [
            off(&pressures(&small), &pressures(&finite)),
            (force / exact - 1.0).abs(),
            off(&small.last().displacement, &finite.last().displacement),
        ];
        println!("{round} {method}: slip/edge {slip:.3}, {found:.4?}");
        assert!((0.09..0.14).contains(&slip), "{slip}");
        assert!(found[0] < 0.15 && found[1] < 0.011 && found[2] < 0.009, "{found:?}");
    }
}
