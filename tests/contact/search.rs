//! The searches of segments give the same answers: through all of them, in a tree of boxes, in a grid.

use fecontact::contact::master::Master;
use fecontact::contact::projection::Projection;
use fecontact::contact::search::{Index, KeptSearch};
use fecontact::contact::segment_search::SegmentSearch;
use fecontact::contact::segment_tree::SegmentTree;
use fecontact::contact::surface::{MasterPoint, SlavePoint, Surface, gauss_points, lone_point};
use fecontact::mesh::boxes::{Box2, Tree};
use fecontact::mesh::configuration::Configuration;
use nalgebra::Vector2;
use proptest::prelude::*;

use crate::segment_searches::{Exhaustive, SegmentGrid};

/// What an index answers about slave points and about the edges that they lie on.
#[derive(Debug, PartialEq)]
struct Answers {
    projections: Vec<Option<Projection>>,
    around: Vec<Vec<usize>>,
}

/// A master and what is asked of it.
struct Question<'a> {
    master: Master,
    points: Vec<SlavePoint>,
    edges: &'a [Vec<usize>],
    /// Projections at the start of the increment
    from: Vec<Option<MasterPoint>>,
    reach: f64,
}

impl Question<'_> {
    /// Asks in one configuration after the other, with what is kept from the last.
    fn ask<S: SegmentSearch>(&self, configurations: &[Configuration]) -> Vec<Answers> {
        let mut kept = KeptSearch::<S>::default();
        let mut before = &configurations[0];
        let mut all = Vec::new();
        for x in configurations {
            let index = Index::kept(&self.master, [before, x], &mut kept);
            let project = |(point, from): (&SlavePoint, &Option<MasterPoint>)| index.project(point, *from, x);
            let around = |edge: &Vec<usize>| {
                let mut found = Vec::new();
                index.around(edge, self.reach, x, &mut found);
                found
            };
            all.push(Answers {
                projections: self.points.iter().zip(&self.from).map(project).collect(),
                around: self.edges.iter().map(around).collect(),
            });
            before = x;
        }
        all
    }
}

/// Chains of nodes along which a surface runs.
#[derive(Clone, Debug)]
enum Shape {
    /// From left to right
    Line,
    /// A star about the middle
    Ring,
    /// From place to place
    Jumps,
}

/// Places on a raster, so that many are equally far from a point.
fn raster(values: &[f64]) -> Vec<Vector2<f64>> {
    values.chunks_exact(2).map(|pair| Vector2::new((8.0 * pair[0]).round(), (8.0 * pair[1]).round()) / 8.0).collect()
}

fn chain(shape: &Shape, places: &[Vector2<f64>], shift: f64) -> Vec<Vector2<f64>> {
    let n = places.len() as f64;
    let place = |(k, at): (usize, &Vector2<f64>)| match shape {
        Shape::Line => Vector2::new(k as f64 / n + shift, 0.3 * at.y),
        Shape::Ring => {
            let angle = std::f64::consts::TAU * k as f64 / n;
            (0.4 + 0.4 * at.x) * Vector2::new(angle.cos(), angle.sin()) + Vector2::new(0.5 + shift, 0.5)
        }
        Shape::Jumps => at + Vector2::new(shift, 0.0),
    };
    places.iter().enumerate().map(place).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Projections of points with and without edges, with and without one at the start of the increment, and segments around
    /// edges: on one or two chains, open, closed or crossing themselves, straight, quadratic or smooth, apart or in contact
    /// with themselves, moved a little and much, far from the origin too.
    #[test]
    fn searches_agree(
        shape in prop_oneof![Just(Shape::Line), Just(Shape::Ring), Just(Shape::Jumps)],
        values in prop::collection::vec(0.0..1.0_f64, 8..120),
        two in any::<bool>(),
        kind in 0..3usize,
        is_own in any::<bool>(),
        far in prop_oneof![Just(0.0), Just(1e6)],
        moves in prop::collection::vec(-0.5..0.5_f64, 240),
    ) {
        let places = raster(&values);
        let mut nodes: Vec<Vector2<f64>> = Vec::new();
        let mut edges: Vec<Vec<usize>> = Vec::new();
        for shift in if two { vec![0.0, 1.5] } else { vec![0.0] } {
            let first = nodes.len();
            nodes.extend(chain(&shape, &places, shift));
            // The surface runs along s with its body on the right: its edges run against it.
            edges.extend((first + 1..nodes.len()).map(|k| vec![k, k - 1]));
            if matches!(shape, Shape::Ring) {
                edges.push(vec![first, nodes.len() - 1]);
            }
        }
        edges.retain(|edge| nodes[edge[0]] != nodes[edge[1]]);
        prop_assume!(!edges.is_empty());
        if kind == 1 {
            for edge in &mut edges {
                let bow = 0.05 * (nodes[edge[1]] - nodes[edge[0]]);
                nodes.push(0.5 * (nodes[edge[0]] + nodes[edge[1]]) + Vector2::new(bow.y, bow.x));
                edge.push(nodes.len() - 1);
            }
        }
        let surface = Surface::new(&edges);
        let surface = if kind == 2 { surface.smoothed(&nodes) } else { surface };
        let surface = if is_own { surface.against_itself(0.1) } else { surface };
        // Slave edges across the surface, and points at and beyond its corners.
        let slaves: Vec<Vec<usize>> = if is_own {
            edges.clone()
        } else {
            let first = nodes.len();
            nodes.extend(places.iter().map(|at| 3.0 * at - Vector2::new(1.0, 1.0)));
            (first + 1..nodes.len()).map(|k| vec![k - 1, k]).filter(|edge| nodes[edge[0]] != nodes[edge[1]]).collect()
        };
        nodes.iter_mut().for_each(|at| *at += Vector2::new(far, -far));
        let mut points = gauss_points(&slaves, 2);
        points.extend((0..nodes.len()).map(|node| lone_point(node, 0.0)));
        let count = surface.segments.len();
        let from = |k: usize| (!k.is_multiple_of(3)).then(|| MasterPoint { segment: (7 * k) % count, xi: 0.5 });
        let question = Question {
            from: (0..points.len()).map(from).collect(),
            points,
            edges: &slaves,
            master: Master::Mesh(surface),
            reach: 0.2,
        };
        let displacements = [0.0, 1e-4, 1.0].map(|size| -> Vec<f64> {
            moves.iter().cycle().take(2 * nodes.len()).map(|value| size * value).collect()
        });
        let configurations = displacements.each_ref().map(|u| Configuration::new(&nodes, u));
        let expected = question.ask::<Exhaustive>(&configurations);
        prop_assert_eq!(&question.ask::<SegmentTree>(&configurations), &expected);
        prop_assert_eq!(&question.ask::<SegmentGrid>(&configurations), &expected);
    }
}

/// The tree finds the same boxes as a search through all of them, for pseudo-random boxes.
#[test]
fn none_is_missed() {
    let boxes: Vec<Box2> = (0..200u32)
        .map(|k| {
            let at = |m: u32| f64::from(k * m % 211) / 211.0;
            let low = Vector2::new(at(97), at(53));
            Box2 { low, high: low + 0.1 * Vector2::new(at(31), at(17)) }
        })
        .collect();
    let tree = Tree::new(boxes.iter().copied());
    for own in &boxes {
        let all: Vec<usize> = (0..boxes.len()).filter(|k| boxes[*k].meets(own)).collect();
        assert_eq!(tree.meeting(own), all);
    }
    assert!(Tree::new(std::iter::empty()).meeting(&boxes[0]).is_empty());
}
