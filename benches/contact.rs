//! One update of a contact: the index of the master, and every slave point with search, law and forces.

use std::collections::BTreeMap;
use std::sync::Arc;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, criterion_group};
use fecontact::contact::master::Master;
use fecontact::contact::mortar::{Hats, mortar_points};
use fecontact::contact::pair::{ContactIncrement, ContactPair, LawsInTime, Prediction};
use fecontact::contact::response::PairResponse;
use fecontact::contact::search::{Index, KeptSearch};
use fecontact::contact::segment_search::SegmentSearch;
use fecontact::contact::segment_tree::SegmentTree;
use fecontact::contact::surface::{Surface, gauss_points, nodal_points};
use fecontact::laws::friction::{
    Coulomb, CoulombParameters, FrictionParameters, LawFailure, SlipWeakeningParameters, SuperSubloadingParameters,
};
use fecontact::linear::system::Request;
use fecontact::mesh::configuration::Configuration;
use fecontact::model::boundary::Expression;
use nalgebra::Vector2;
use segment_searches::{Exhaustive, SegmentGrid};

#[path = "../tests/contact/segment_searches.rs"]
mod segment_searches;

/// Positions of the nodes, and what lies between them.
type Surfaces = (Vec<Vector2<f64>>, ContactPair);

/// A wavy slave of n/2 edges with two points each, a trifle below a wavy master of n segments.
fn surfaces(n: usize) -> Surfaces {
    let at = |x: f64, below: f64| Vector2::new(x, 0.05 * (20.0 * x).sin() - below);
    let mut nodes: Vec<_> = (0..=n).map(|k| at(k as f64 / n as f64, 0.0)).collect();
    nodes.extend((0..=n / 2).map(|k| at(k as f64 / (n / 2) as f64, 1e-3 / n as f64)));
    // Both have their body on the left: the master's below it, the slave's above.
    let master: Vec<Vec<usize>> = (0..n).rev().map(|k| vec![k + 1, k]).collect();
    let slave: Vec<Vec<usize>> = (0..n / 2).map(|k| vec![n + 1 + k, n + 2 + k]).collect();
    let law = Coulomb::new(&CoulombParameters { mu: 0.3, alpha_t: Some(1e3) }, f64::NAN).expect("valid parameters");
    let pair = ContactPair {
        comes_stressed: false,
        conduit: None,
        bodies: Default::default(),
        name: "wavy".into(),
        points: gauss_points(&slave, 2),
        master: Master::Mesh(Surface::new(&master)),
        alpha_n: 1e4,
        compliance: 0.0,
        laws: vec![Arc::new(law.into())],
        in_time: None,
        initial: None,
        unseen: Vec::new(),
        fades: None,
        modulus: 0.0,
        both: None,
        body: None,
        small: None,
        mortar: None,
        touch: 1e-9,
        penetration: None,
        stick: None,
        tied: false,
        radiation: 0.0,
        fluid: None,
        pores: None,
        seam: None,
        truncated: BTreeMap::new(),
    };
    (nodes, pair)
}

/// A closed ring of n edges, dented until its sides nearly touch, in contact with itself: every point looks past its own
/// neighbours for what faces it.
fn ring(n: usize) -> Surfaces {
    let at = |k: usize| {
        let angle = std::f64::consts::TAU * k as f64 / n as f64;
        Vector2::new(angle.cos(), 1e-3 * angle.sin().signum() + angle.sin() * angle.cos().powi(2))
    };
    let nodes = (0..n).map(at).collect();
    // The body lies outside, its elements as thick as their edges are long.
    let edges: Vec<Vec<usize>> = (0..n).rev().map(|k| vec![(k + 1) % n, k]).collect();
    let (_, other) = surfaces(2);
    let master = Master::Mesh(Surface::new(&edges).against_itself(std::f64::consts::PI / n as f64));
    (nodes, ContactPair { name: "ring".into(), points: gauss_points(&edges, 2), master, ..other })
}

/// Index, search and whole update of surfaces of several sizes.
fn measure(criterion: &mut Criterion, name: &str, sizes: [usize; 3], surfaces: fn(usize) -> Surfaces) {
    let mut group = criterion.benchmark_group(name);
    group.sample_size(10);
    for n in sizes {
        let (nodes, pair) = surfaces(n);
        let x = Configuration::undeformed(&nodes);
        searched::<SegmentTree>(&mut group, "tree", n, &pair, &x);
        if n <= 30_000 {
            searched::<SegmentGrid>(&mut group, "grid", n, &pair, &x);
        }
        if n <= 1_000 {
            searched::<Exhaustive>(&mut group, "all segments", n, &pair, &x);
        }
        let old = pair.initial_states(&x);
        let increment = ContactIncrement {
            dt: 1.0,
            time: 0.0,
            radiates: true,
            fading: 0.0,
            stiffening: 1.0,
            settles: true,
            seeps: 0.0,
        };
        group.bench_function(BenchmarkId::new("update", n), |bench| {
            let mut response = PairResponse::default();
            let mut respond =
                || pair.respond(&old, [&x, &x], increment, |_| Prediction::default(), Request::Tangent, &mut response);
            bench.iter(|| respond().is_ok());
        });
    }
    group.finish();
}

/// The index of one search, and all points projected by it.
fn searched<S: SegmentSearch>(
    group: &mut BenchmarkGroup<WallTime>,
    method: &str,
    n: usize,
    pair: &ContactPair,
    x: &Configuration,
) {
    group.bench_function(BenchmarkId::new(format!("index by {method}"), n), |bench| {
        bench.iter(|| matches!(Index::kept(&pair.master, [x, x], &mut KeptSearch::<S>::default()), Index::Mesh(..)));
    });
    let mut kept = KeptSearch::<S>::default();
    let index = Index::kept(&pair.master, [x, x], &mut kept);
    group.bench_function(BenchmarkId::new(format!("search by {method}"), n), |bench| {
        bench.iter(|| pair.points.iter().filter(|slave| index.project(slave, None, x).is_some()).count());
    });
}

fn two_surfaces(criterion: &mut Criterion) {
    measure(criterion, "contact", [1_000, 30_000, 1_000_000], surfaces);
}

fn self_contact(criterion: &mut Criterion) {
    measure(criterion, "self_contact", [1_000, 10_000, 100_000], ring);
}

criterion_group!(benches, two_surfaces, self_contact);

fn main() {
    points();
    if std::env::var_os("POINTS").is_none() {
        benches();
    }
}

/// A flat slave of n edges on an equal master, its nodes moved against each other by shares of an edge and pressed in.
fn flat(n: usize, law: &FrictionParameters, method: &str) -> (Vec<Vector2<f64>>, ContactPair) {
    let at = |k: usize| Vector2::new(k as f64, 0.0);
    let nodes: Vec<_> = (0..=n).chain(0..=n).map(at).collect();
    let master: Vec<Vec<usize>> = (0..n).rev().map(|k| vec![k + 1, k]).collect();
    let slave: Vec<Vec<usize>> = (0..n).map(|k| vec![n + 1 + k, n + 2 + k]).collect();
    let (_, other) = surfaces(2);
    let (points, mortar) = match method {
        "nodes" | "small" => (nodal_points(&slave), None),
        "gauss" => (gauss_points(&slave, 2), None),
        _ => {
            let (p, m) = mortar_points(&slave, Hats::OfEdges, &nodes);
            (p, Some(m))
        }
    };
    let laws = vec![Arc::new(law.build(1e3).expect("valid parameters").into())];
    let mut pair =
        ContactPair { name: "flat".into(), points, mortar, master: Master::Mesh(Surface::new(&master)), laws, ..other };
    if method == "small" {
        pair.slide_little(&Configuration::undeformed(&nodes));
    }
    (nodes, pair)
}

/// The same with a law of its own at every point, whose α_t varies in place and time: by 0, so that all else stays as it is.
fn in_place_and_time(mut pair: ContactPair, law: &FrictionParameters, nodes: &[Vector2<f64>]) -> ContactPair {
    let expression = Expression::parse("1000 + 0*sin(x + 0.1*t)").expect("an expression");
    let x = Configuration::undeformed(nodes);
    let places: Vec<_> = pair.points.iter().map(|point| point.at(&x)).collect();
    pair.points.iter_mut().enumerate().for_each(|(k, point)| point.law = k);
    pair.laws = vec![pair.laws[0].clone(); places.len()];
    let law = law.clone();
    pair.in_time = Some(LawsInTime::new(places.len(), move |k, [_, time]| {
        let law = law.clone().with("alpha_t", expression.value(places[k], time)).ok();
        let law = law.and_then(|law| law.build(f64::NAN).ok()).ok_or(LawFailure::Undefined { time })?;
        Ok(law.into())
    }));
    pair
}

fn points() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    let n = 1_000;
    let only = std::env::var("POINTS").unwrap_or_default();
    let laws = [
        ("coulomb", FrictionParameters::from(CoulombParameters { mu: 0.3, alpha_t: None })),
        ("slip weakening", SlipWeakeningParameters::new(0.6, 0.3, 0.5).into()),
        (
            "super/subloading",
            SuperSubloadingParameters { kappa: 1.0, xi: 1e-3, ..SuperSubloadingParameters::new(0.5, 0.3, 50.0) }.into(),
        ),
    ];
    println!("µs a point: {:27} residual tangent, each evaluated once an increment", "");
    for method in ["nodes", "gauss", "mortar", "small"].into_iter().filter(|method| method.contains(&only)) {
        for (name, law) in &laws {
            for (motion, rate) in [("sticks", 0.0), ("slips", 3e-3)] {
                let (nodes, pair) = flat(n, law, method);
                let varying = in_place_and_time(flat(n, law, method).1, law, &nodes);
                let micros = [&pair, &varying].map(|pair| {
                    [Request::Residual, Request::Tangent].map(|request| update(&pool, &nodes, pair, rate, request))
                });
                let [[residual, tangent], [in_time, tangent_in_time]] = micros;
                println!(
                    "{method:8} {name:18} {motion:8} {residual:6.3} {tangent:6.3}, in time {in_time:6.3} {tangent_in_time:6.3}"
                );
            }
        }
    }
}

/// Microseconds of an update a point, the shortest of several increments in which the slave moves by `rate`, some of it more
/// than the rest, pressed in by a trifle that comes and goes.
fn update(pool: &rayon::ThreadPool, nodes: &[Vector2<f64>], pair: &ContactPair, rate: f64, request: Request) -> f64 {
    let wave = |k: usize| (k as f64).sin();
    let u = |t: f64| -> Vec<f64> {
        let slave = |k| [t * rate * (1.0 + 1e-3 * wave(k)), -1e-3 - 1e-6 * (t + k as f64).sin()];
        let master = |k| [0.0, 1e-6 * (0.3 * t + k as f64).sin()];
        (0..nodes.len()).flat_map(|k| if k >= nodes.len() / 2 { slave(k) } else { master(k) }).collect()
    };
    let (mut old, mut before) = (pair.initial_states(&Configuration::undeformed(nodes)), vec![0.0; 2 * nodes.len()]);
    let (mut shortest, mut response) = (f64::INFINITY, PairResponse::default());
    for k in 1..=60 {
        let (now, time) = (u(f64::from(k)), f64::from(k));
        let during =
            ContactIncrement { dt: 1.0, time, radiates: true, fading: 0.0, stiffening: 1.0, settles: true, seeps: 0.0 };
        let clock = std::time::Instant::now();
        let [was, is] = [&before, &now].map(|u| Configuration::new(nodes, u));
        pool.install(|| pair.respond(&old, [&was, &is], during, |_| Prediction::default(), request, &mut response))
            .expect("an answer");
        if k > 4 {
            shortest = shortest.min(clock.elapsed().as_secs_f64());
        }
        old.clone_from(&response.states);
        before = now;
    }
    1e6 * shortest / old.len() as f64
}
