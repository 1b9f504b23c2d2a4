//! Local tractions by the program's defaults where they are known exactly: patches, blocks that slide, beams, belts.

use std::f64::consts::PI;

use fecontact::contact::force::ContactState;
use fecontact::contact::scatter::PointSequence;
use fecontact::mesh::configuration::Configuration;
use fecontact::model::state::State;
use nalgebra::Vector2;
use serde_json::{Value, json};

use crate::common::{Finished, close, finish, turned, with};

const KINDS: [&str; 3] = ["Q4", "Q8", "T6"];

/// Largest scatter (column `scatter` of the history) of the tractions of the first contact among the points of |x| < `half` at the start and
/// after a time, turned back by an angle.
fn scatter(run: &Finished, half: f64, angle: f64, after: f64) -> f64 {
    let undeformed = Configuration::undeformed(&run.model.mesh.nodes);
    let points = &run.model.contacts[0].points;
    let inner: Vec<usize> = (0..points.len())
        .filter(|&point| turned(points[point].at(&undeformed).into(), -angle)[0].abs() < half)
        .collect();
    let sequence =
        PointSequence::new(&inner.iter().map(|&point| points[point].clone()).collect::<Vec<_>>(), &undeformed);
    let of = |state: &State| -> f64 {
        sequence.scatter(&inner.iter().map(|&point| state.contacts[0][point].clone()).collect::<Vec<_>>())
    };
    run.states.iter().filter(|state| state.time > after).map(of).fold(0.0, f64::max)
}

/// A block pressed on ground of equal edges and drawn along it over one and a half of them, everything turned; each a surface of its own or
/// both one that touches itself.
fn sliding(kind: &str, n: usize, angle: f64, own: bool, contact: &Value) -> Finished {
    let at = |x: f64, y: f64| turned([x, y], angle);
    let block = |body: &str, half: f64, far: f64, [n, rows]: [usize; 2]| {
        let [low, high] = [far.min(0.0), far.max(0.0)];
        let surface = if own { "skin".to_string() } else { format!("{body}_surface") };
        let mut sides = [surface, format!("{body}_far")];
        if far < 0.0 {
            sides.reverse();
        }
        json!({"body": body, "kind": kind, "elements": [n, rows], "sides": [sides[0], null, sides[1], null],
               "corners": [at(-half, low), at(half, low), at(half, high), at(-half, high)]})
    };
    let body = json!({"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}});
    let mut base = json!({"friction": {"law": "coulomb", "mu": 0.3}});
    [base["slave"], base["master"]] = match own {
        true => ["skin", "skin"],
        false => ["upper_surface", "lower_surface"],
    }
    .map(|side| json!(side));
    base.as_object_mut().expect("a contact").extend(contact.as_object().expect("keys").clone());
    let moved = |x: f64, y: f64| {
        let [x, y] = at(x, y);
        json!({"on": "upper_far", "ux": x, "uy": y})
    };
    let edge = 2.0 / n as f64;
    finish(&json!({
        "mesh": {"blocks": [block("lower", 2.0, -1.0, [2 * n, n / 2]), block("upper", 1.0, 1.0, [n, n / 2])]},
        "bodies": {"lower": body, "upper": body}, "contacts": {"base": base},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.5}, "supports": [{"on": "lower_far", "ux": 0, "uy": 0}, moved(0.0, -0.01)]},
            {"name": "draw", "duration": 1, "dt": {"initial": 0.1}, "supports": [moved(1.5 * edge + 0.02, -0.01)]}]
    }))
}

/// Over the middle 60 % of a block that slides, across the nodes of its ground, the tractions of one point do not alternate with those of the
/// next: by less than 0.1 % of the mean pressure on quadratic elements and 2 % on linear ones, whatever the direction, and also where both
/// are one surface in contact with itself. Measured: 0.003 % (Q8), 0.01 % (T6), 0.4 % (Q4); against itself 0.01, 0.06, 0.3 %. (At the corners
/// of the block the pressure is singular, about which Q4 alternates over five points; all of the surface has 0.2, 0.2, 6.9 %. Two Gauss
/// points an edge with as stiff a penalty have 90 % and more.)
#[test]
fn sliding_pairs_do_not_scatter() {
    for (kind, band) in [("Q4", 0.02), ("Q8", 1e-3), ("T6", 1e-3)] {
        let cases = [(0.0, false), (PI / 6.0, false), (PI / 6.0, true)];
        let found = cases.map(|(angle, own)| scatter(&sliding(kind, 24, angle, own, &json!({})), 0.6, angle, 0.9));
        println!("{kind}: {found:.6?}");
        assert!(found.iter().all(|scatter| *scatter < band), "{kind}: {found:?}");
        close("turned", found[1], found[0], 1e-6);
    }
    let stiff = json!({"method": "gauss_to_segment", "normal": {"alpha_n": 300.0 * 12.0 * 1346.0}});
    assert!(scatter(&sliding("Q8", 24, 0.0, false, &stiff), 0.6, 0.0, 0.9) > 0.1);
}

/// A beam of two layers of 5 n and 7 n elements, joined by a contact along its middle, under a pressure of 1 on both sides and in pure
/// bending with a curvature κ: σ_xx = −E′ κ y.
fn bent(kind: &str, n: usize, contact: &Value) -> Finished {
    let layer = |body: &str, side: f64, elements: [usize; 2]| {
        let [low, high] = [(0.5 * side).min(0.0), (0.5 * side).max(0.0)];
        let (inner, outer) = (format!("{body}_inner"), format!("{body}_outer"));
        let [bottom, top] = if side < 0.0 { [outer, inner] } else { [inner, outer] };
        json!({"body": body, "kind": kind, "elements": elements, "sides": [bottom, "end", top, "middle"],
               "corners": [[0, low], [LONG, low], [LONG, high], [0, high]]})
    };
    let mut blocks = [layer("lower", -1.0, [5 * n, n]), layer("upper", 1.0, [7 * n, n])];
    blocks[0]["points"] = json!({"origin": [0, 0], "tip": [LONG, 0]});
    let body = json!({"material": {"model": "linear", "E": 1000, "nu": 0.3}});
    let base = with(json!({"slave": "upper_inner", "master": "lower_inner"}), contact);
    let steepness = -CURVATURE * 1000.0 / 0.91;
    finish(&json!({
        "mesh": {"blocks": blocks}, "bodies": {"lower": body, "upper": body}, "contacts": {"base": base},
        "steps": [{"name": "bend", "duration": 1, "dt": {"initial": 1},
                   "supports": [{"on": "middle", "ux": 0}, {"on": "origin", "uy": 0}],
                   "loads": [{"on": "upper_outer", "traction": {"y": -1}}, {"on": "lower_outer", "traction": {"y": 1}},
                             {"on": "end", "traction": {"x": format!("{steepness}*y")}}]}]
    }))
}

/// Length of the beam from its middle.
const LONG: f64 = 4.0;

/// κ
const CURVATURE: f64 = 1e-4;

/// The deflection κ l²/2 of pure bending, whose interface bears nothing but the pressure: pressed on each other and held by friction, or tied,
/// the error of Q4 falls with the square of the size, as that of its elements does, and quadratic elements are exact but for what turns
/// of κ l = 4e-4 make of dead loads. So are the local tractions, p = 1 and q = 0: the errors of Q4 halve at least.
#[test]
fn beams_of_two_layers_bend_as_one() {
    for kind in KINDS {
        for contact in [json!({"friction": {"law": "coulomb", "mu": 1}}), json!({"tied": true})] {
            let errors = [1, 2, 4].map(|n| {
                let run = bent(kind, n, &contact);
                let tip = run.nodes("tip")[0];
                let deflection = run.last().displacement[2 * tip + 1] / (0.5 * CURVATURE * LONG * LONG) - 1.0;
                let points = &run.last().contacts[0];
                let square = |at: &ContactState| (at.friction.pressure - 1.0).powi(2) + at.friction.traction.powi(2);
                [deflection.abs(), (points.iter().map(square).sum::<f64>() / points.len() as f64).sqrt()]
            });
            println!("{kind} {contact}: {errors:?}");
            match kind {
                "Q4" => {
                    let falls = |k: usize, share: f64| errors.windows(2).all(|pair| pair[1][k] < share * pair[0][k]);
                    assert!(errors[2][0] < 0.02 && falls(0, 0.3) && falls(1, 0.5), "{contact}: {errors:?}");
                }
                _ => assert!(
                    errors.iter().all(|[tip, tractions]| *tip < 5e-5 && *tractions < 6e-4),
                    "{kind}: {errors:?}"
                ),
            }
        }
    }
}

/// A belt over half of a fixed drum of radius 10, drawn by 1 at its left end over the drum, then by its right end until it slips back.
fn belt(kind: &str, quarter: usize) -> Finished {
    let (inner, outer, free) = (10.0, 10.0 + THICKNESS, quarter / 2);
    let block = |corners: [[f64; 2]; 4], n: usize, arc: Option<[f64; 2]>, [right, left]: [Option<&str>; 2]| {
        json!({"body": "belt", "kind": kind, "corners": corners, "elements": [n, 1], "arcs": [arc, null, arc, null],
               "sides": ["inside", right, null, left]})
    };
    let (centre, none) = (Some([0.0, 0.0]), [None, None]);
    let blocks = [
        block([[-inner, -10.0], [-inner, 0.0], [-outer, 0.0], [-outer, -10.0]], free, None, [None, Some("left")]),
        block([[-inner, 0.0], [0.0, inner], [0.0, outer], [-outer, 0.0]], quarter, centre, none),
        block([[0.0, inner], [inner, 0.0], [outer, 0.0], [0.0, outer]], quarter, centre, none),
        block([[inner, 0.0], [inner, -10.0], [outer, -10.0], [outer, 0.0]], free, None, [Some("right"), None]),
    ];
    finish(&json!({
        "mesh": {"blocks": blocks}, "bodies": {"belt": {"material": {"model": "neo_hookean", "E": 1e4, "nu": 0.3}}},
        "contacts": {"drum": {"slave": "inside", "master": {"circle": {"centre": [0, 0], "radius": 10}}, "friction": {"law": "coulomb", "mu": 0.3}}},
        "steps": [
            {"name": "tension", "duration": 1, "supports": [{"on": "right", "ux": 0, "uy": 0}, {"on": "left", "ux": 0}],
             "loads": [{"on": "left", "total_force": {"y": -1}}]},
            {"name": "pull", "duration": 1, "dt": {"initial": 0.1}, "supports": [{"on": "right", "uy": -0.05}]}]
    }))
}

/// Thickness of the belt, t.
const THICKNESS: f64 = 0.5;

/// Euler and Eytelwein: the belt's force T is in its middle, at r = R + t/2, and friction at R, so that about the axis r dT = q R² dθ, with
/// q = μ p and p R = T to 0.2 %:
///
/// ```text
/// T₁/T₂ = exp(μ π R/r),   d ln p/dθ = ± μ R/r
/// ```
/// The ratio is that to 0.1 %; slipping back, which carries parts of the belt that were bent at the start off the drum and straight ones
/// onto it, to 2 %. p R is within 1.5 % of T, and grows as it should to 1 %.
#[test]
fn a_belt_on_a_drum_bears_as_a_capstan() {
    let rate = 0.3 * 10.0 / (10.0 + 0.5 * THICKNESS);
    for kind in ["Q8", "T6"] {
        let run = belt(kind, 24);
        for (time, sign, band) in [(1.0, 1.0, 1e-3), (2.0, -1.0, 0.02)] {
            let state = run.at(time);
            let x = run.model.configuration(&state.displacement);
            let right = run.reaction("right", state)[1].abs();
            close("ratio", right.powf(-sign) / (rate * PI).exp(), 1.0, band);
            let points = run.model.contacts[0].points.iter().zip(&state.contacts[0]);
            let found: Vec<[f64; 3]> = points
                .map(|(point, at)| (point.at(&x), &at.friction))
                .map(|(at, friction)| [at.y.atan2(at.x), friction.pressure, friction.traction])
                .filter(|[angle, ..]| (0.5..2.6).contains(angle))
                .collect();
            for [angle, p, q] in &found {
                close("slips", *q, -sign * 0.3 * p, 1e-9);
                close("p R/T", 10.0 * p / (right * (sign * rate * angle).exp()), 1.0, 0.015);
            }
            // The slope of a line through all ln p.
            let mean = |value: &dyn Fn(&[f64; 3]) -> f64| found.iter().map(value).sum::<f64>() / found.len() as f64;
            let (angle, log) = (mean(&|at| at[0]), mean(&|at| at[1].ln()));
            let slope = mean(&|at| (at[0] - angle) * (at[1].ln() - log)) / mean(&|at| (at[0] - angle).powi(2));
            println!("{kind} {time}: T {right:.5}, {} points, d ln p {slope:.5} of {rate:.5}", found.len());
            close("growth", slope / (sign * rate), 1.0, 0.01);
        }
    }
}

/// How two patches lie on each other, from x = 0 on.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Patch {
    Level,
    Inclined,
    /// The master goes on beyond the slave, under the same pressure
    LongMaster,
    LongSlave,
    /// The slave alone on an inclined rigid line
    Rigid,
}

/// Largest errors of stresses and contact pressures between bodies of one material under the pressure 1 on their top and right, on what of
/// them overhangs, and by smooth supports at the bottom and on the left: −1 for σ_xx and σ_yy everywhere, and a pressure of 1.
fn patch(kind: &str, patch: Patch, [lower, upper]: [usize; 2], normal: &Value) -> [f64; 2] {
    let slope = if matches!(patch, Patch::Inclined | Patch::Rigid) { 0.3 } else { 0.0 };
    let y = |x: f64| slope * (x - 0.5);
    let block = |body: &str, corners: [[f64; 2]; 4], n: usize, sides: [Option<&str>; 4]| json!({"body": body, "kind": kind, "corners": corners, "elements": [n, 3], "sides": sides});
    let below = |[from, to]: [f64; 2], n: usize, right: Option<&str>, top: &str, left: Option<&str>| {
        let corners = [[from, -0.5], [to, -0.5], [to, y(to)], [from, y(from)]];
        block("lower", corners, n, [Some("bottom"), right, Some(top), left])
    };
    let above = |[from, to]: [f64; 2], n: usize, bottom: &str, right: Option<&str>, left: Option<&str>| {
        let corners = [[from, y(from)], [to, y(to)], [to, 0.5], [from, 0.5]];
        block("upper", corners, n, [Some(bottom), right, Some("pressed"), left])
    };
    let (pressed, held, whole, more) = (Some("pressed"), Some("left"), [0.0, 1.0], [1.0, 1.5]);
    // Friction holds the upper body where it lies on a lower one.
    let beside = if patch == Patch::Rigid { held } else { pressed };
    let mut blocks = match patch {
        Patch::LongMaster => {
            vec![below(whole, lower, None, "master", held), below(more, 2, pressed, "pressed", None)]
        }
        Patch::Rigid => Vec::new(),
        _ => vec![below(whole, lower, pressed, "master", held)],
    };
    match patch {
        Patch::LongSlave => {
            blocks.extend([above(whole, upper, "slave", None, beside), above(more, 2, "pressed", pressed, None)])
        }
        _ => blocks.push(above(whole, upper, "slave", pressed, beside)),
    }
    let body = json!({"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}});
    let (mut bodies, mut master) = (json!({"lower": body, "upper": body}), json!("master"));
    let mut supports = vec![json!({"on": "left", "ux": 0}), json!({"on": "bottom", "uy": 0})];
    let mut friction = json!({"law": "coulomb", "mu": 1});
    if patch == Patch::Rigid {
        (bodies, master) = (json!({"upper": body}), json!({"polyline": {"points": [[-1, y(-1.0)], [2, y(2.0)]]}}));
        supports.pop();
        friction = json!({"law": "frictionless"});
    }
    let run = finish(&json!({
        "mesh": {"blocks": blocks}, "bodies": bodies,
        "contacts": {"base": {"slave": "slave", "master": master, "friction": friction, "normal": normal}},
        "newton": {"tolerance": 1e-12},
        "steps": [{"name": "press", "duration": 1, "dt": {"initial": 0.5}, "supports": supports, "loads": [{"on": "pressed", "pressure": 1}]}]
    }));
    assert_eq!(run.model.contacts[0].mortar.is_some(), patch != Patch::Rigid);
    let pressures = run.last().contacts[0].iter().map(|at| (at.friction.pressure - 1.0).abs());
    let elements = run.model.mesh.elements.iter().zip(&run.model.solids).zip(&run.model.body_of_element);
    let stresses = elements.flat_map(|((element, solid), &body)| {
        let at = |&node: &usize| Vector2::new(run.last().displacement[2 * node], run.last().displacement[2 * node + 1]);
        let u: Vec<_> = element.nodes.iter().map(at).collect();
        solid.stresses(&*run.model.bodies[body].material, &[], &u).expect("stresses")
    });
    let stresses = stresses.map(|stress| (stress.xx + 1.0).abs().max((stress.yy + 1.0).abs()).max(stress.xy.abs()));
    [stresses.fold(0.0, f64::max), pressures.fold(0.0, f64::max)]
}

/// Patches are even by the default methods, whatever overhangs: pressures to 1e-10; stresses to 1e-10 with a softer penalty, and with the
/// default one, whose round-off ends Newton's method, to 1e-9.
#[test]
fn patches_are_even() {
    let soft = json!({"alpha_n": 1e5});
    let layouts = [Patch::Level, Patch::Inclined, Patch::LongMaster, Patch::LongSlave, Patch::Rigid];
    for (kind, layout) in KINDS.iter().flat_map(|kind| layouts.map(|layout| (kind, layout))) {
        for (n, normal, band) in [([5, 7], &soft, 1e-10), ([7, 5], &soft, 1e-10), ([5, 7], &json!({}), 1e-9)] {
            let [stress, pressure] = patch(kind, layout, n, normal);
            println!("{kind} {layout:?} {n:?}: stresses off by {stress:.1e}, pressures by {pressure:.1e}");
            assert!(stress < band && pressure < band.min(1e-10), "{kind} {layout:?} {n:?}");
        }
    }
}

/// Two quarters of rings of which the inner one is the slave, under the pressure 1 within and without: largest error of the contact pressure.
fn rings(kind: &str, [inner, outer]: [usize; 2]) -> f64 {
    let ring = |body: &str, [from, to]: [f64; 2], n: usize| {
        let sides = match body {
            "inner" => ["pressed", "bottom", "slave", "left"],
            _ => ["master", "bottom", "pressed", "left"],
        };
        json!({"body": body, "kind": kind, "elements": [n, 3], "corners": [[0, from], [from, 0], [to, 0], [0, to]],
               "arcs": [[0, 0], null, [0, 0], null], "sides": sides})
    };
    let body = json!({"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}});
    let run = finish(&json!({
        "mesh": {"blocks": [ring("inner", [0.5, 1.0], inner), ring("outer", [1.0, 1.5], outer)]}, "bodies": {"inner": body, "outer": body},
        "contacts": {"base": {"slave": "slave", "master": "master", "friction": {"law": "frictionless"}}},
        "steps": [{"name": "press", "duration": 1, "dt": {"initial": 1}, "supports": [{"on": "left", "ux": 0}, {"on": "bottom", "uy": 0}],
                   "loads": [{"on": "pressed", "pressure": 1}]}]
    }));
    run.last().contacts[0].iter().fold(0.0f64, |most, at| most.max((at.friction.pressure - 1.0).abs()))
}

/// On curved edges, whose points have one normal each, the pressure is even to the second order in the edges: 1.2, 0.2, 0.05 % of 1 for edges of
/// 18°, 9° and 4.5° on the slave (Q8), and with 7 slave edges on 5 of the master 8, 1.2, 0.2 %.
#[test]
fn curved_patches_are_even_to_the_second_order() {
    for (kind, ratio) in [("Q8", [5, 7]), ("Q8", [7, 5]), ("T6", [5, 7]), ("T6", [7, 5])] {
        let errors = [1, 2, 4].map(|n| rings(kind, ratio.map(|edges| n * edges)));
        println!("{kind} {ratio:?}: {errors:.5?}");
        assert!(errors.windows(2).all(|pair| pair[1] < 0.35 * pair[0]) && errors[2] < 4e-3, "{kind}: {errors:?}");
    }
}
