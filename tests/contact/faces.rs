//! What a surface faces: flanks that an edge of the slave sees obliquely, and a corner of a rigid body beside a notch.

use fecontact::contact::depth::Inside;
use fecontact::contact::kinematics::Kinematics;
use fecontact::contact::master::Master;
use fecontact::contact::mortar::{Hats, Overlaps, Room, mortar_points};
use fecontact::contact::search::Index;
use fecontact::contact::surface::Surface;
use fecontact::mesh::configuration::Configuration;
use nalgebra::Vector2;
use serde_json::json;

use crate::common::{self, close};

/// Where the level part of the master ends below a slave edge from 0 to 1, and the gap above it.
const END: f64 = 0.85;
const GAP: f64 = 0.01;

/// An edge from 0 to 1 over a level master that ends in a flank, so steep.
fn over_a_flank(degrees: f64) -> Vec<Vector2<f64>> {
    let angle = degrees.to_radians();
    let down = Vector2::new(angle.cos(), -angle.sin()) * (2.0 * (1.0 - END) / angle.cos());
    let corner = Vector2::new(END, 0.0);
    vec![Vector2::new(0.0, GAP), Vector2::new(1.0, GAP), Vector2::new(-1.0, 0.0), corner, corner + down]
}

/// Mean gap about the right end of the edge, and its variation.
fn mean_gap(nodes: &[Vector2<f64>]) -> (f64, Vec<(usize, f64)>) {
    let surface = Surface::new(&[vec![3, 2], vec![4, 3]]);
    let (points, mortar) = mortar_points(&[vec![0, 1]], Hats::OfEdges, nodes);
    let right = points.iter().position(|point| point.position == [(1, 1.0)]).expect("a point at the right end");
    let x = Configuration::undeformed(nodes);
    let mut overlaps = Overlaps::default();
    mortar.cut(&surface, &Index::new(&Master::Mesh(surface.clone()), &x), [&x, &x], &mut overlaps);
    let (mut k, mut room) = (Kinematics::default(), Room::default());
    k.varied = true;
    let ridges = mortar.ridges(&surface, &overlaps, &x);
    let met = mortar.facing(&surface, &overlaps, &ridges).meet(right, None, &x, &mut k, &mut room).expect("a master");
    let dofs = k.nodes.iter().flat_map(|&node| [2 * node, 2 * node + 1]);
    (met.gap, dofs.zip(k.dgap.iter().copied()).collect())
}

/// A flank that turns away from an edge by more than 60° counts by a share f that falls linearly with the cosine, from 1 at 0.5 to nothing at 0.1
/// (84.3°): with φ = x, and the flank from x = c on,
///
/// ```text
/// g = g₀ + f tan α ∫ x (x − c) dx/(∫ x dx + f ∫ x dx)          the first and the last from c to 1, the one between from 0 to c
/// ```
/// so that no gap jumps where a surface turns, and its variation is that of the whole.
#[test]
fn flanks_count_by_their_slope() {
    for degrees in [50.0, 59.9, 65.0, 75.0, 82.0, 86.0] {
        let angle = f64::to_radians(degrees);
        let share = ((angle.cos() - 0.1) / 0.4).clamp(0.0, 1.0);
        let moment = (1.0 - END.powi(3)) / 3.0 - END * (1.0 - END * END) / 2.0;
        let length = 0.5 * (END * END + share * (1.0 - END * END));
        let (found, _) = mean_gap(&over_a_flank(degrees));
        println!("{degrees}: {found:.6}");
        close("gap", found, GAP + share * angle.tan() * moment / length, 1e-12);
    }
    for degrees in [60.0, 0.1f64.acos().to_degrees()] {
        let [before, after] = [-1e-6, 1e-6].map(|turn| mean_gap(&over_a_flank(degrees + turn)).0);
        close("no jump", after, before, 1e-5 * before);
    }
    let (nodes, step) = (over_a_flank(72.0), 1e-6);
    for (dof, rate) in mean_gap(&nodes).1 {
        let [back, forth] = [-step, step].map(|by| {
            let mut moved = nodes.clone();
            moved[dof / 2][dof % 2] += by;
            mean_gap(&moved).0
        });
        close(&format!("dof {dof}"), rate, (forth - back) / (2.0 * step), 1e-7);
    }
}

/// A corner of a rigid tool in a body whose surface has a notch of 60° there, at (0, −1), is as deep as its distance from the bottom of the notch
/// wherever that is the nearest: to both of its flanks alike, though it is in front of the line of one of them. Beyond a corner of the body,
/// where it is behind the line of one side, it is not inside.
#[test]
fn a_corner_beside_a_notch_is_inside() {
    let half = 1.0 / 3.0f64.sqrt();
    let nodes = json!([[-2, -3], [0, -3], [2, -3], [2, 0], [half, 0], [0, -1], [-half, 0], [-2, 0], [-2, -1], [2, -1]]);
    let deepest = |[x, y]: [f64; 2]| {
        let model = common::model(&json!({
            "mesh": {"nodes": nodes, "elements": {"block": [[0, 1, 5, 8], [8, 5, 6, 7], [1, 2, 9, 5], [5, 9, 3, 4]]},
                     "edges": {"surface": [[9, 3], [3, 4], [4, 5], [5, 6], [6, 7], [7, 8]], "base": [[0, 1], [1, 2]]}},
            "bodies": {"block": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}}},
            "contacts": {"base": {"slave": "surface", "friction": {"law": "frictionless"},
                                  "master": {"polyline": {"points": [[x + 0.01, 5], [x, y], [x - 0.01, 5]]}}}},
            "steps": [{"name": "press", "duration": 1, "supports": [{"on": "base", "ux": 0, "uy": 0}]}]
        }));
        model.contacts[0].deepest(&Configuration::undeformed(&model.mesh.nodes))
    };
    for degrees in [215.0, 225.0, 260.0, 270.0, 280.0, 315.0, 325.0] {
        let angle = f64::to_radians(degrees);
        let found =
            deepest([0.2 * angle.cos(), 0.2 * angle.sin() - 1.0]).unwrap_or_else(|| panic!("{degrees}: nothing"));
        assert_eq!(found.what, Inside::Corner);
        close("depth", found.depth, 0.2, 1e-12);
    }
    for outside in [[-2.1, 0.1], [-2.1, 0.2], [-2.2, 0.1], [2.1, 0.1], [0.0, -0.9], [0.05, -0.8]] {
        assert_eq!(deepest(outside), None, "{outside:?}");
    }
}
