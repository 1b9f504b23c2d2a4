//! Explicit increments of a block of fully integrated Q4 elements, neo-Hookean or linear: element updates a second of
//! processor time, whole increments counted (forces, sums, time integration), on one thread and on all. What loops of
//! multiply-adds and of reading and writing long arrays can do on this machine stands beside it, for the shares of its
//! arithmetic and of its memory that an update takes.

use std::sync::Arc;
use std::time::Instant;

use fecontact::case;
use fecontact::equations::Assembler;
use fecontact::time::explicit::Explicit;
use serde_json::{Value, json};

/// Elements a side.
const SIDE: usize = 300;

/// Floating-point operations of one update of a neo-Hookean element, counted in the source: at each of 4 points F (32),
/// invariants and stress with one logarithm (60), nodal forces (32); sums at the nodes (8).
const OPERATIONS: f64 = 4.0 * (32.0 + 60.0 + 32.0) + 8.0;

/// Bytes that it moves to and from memory, counted in the source, a written line being read first: of the element its
/// gradients and volumes (368), nodes (72), forces and energy written (160) and gathered (96); at its node, of which there
/// is one an element, the displaced positions (128), loads and sums (120), rates and the audit (152).
const BYTES: f64 = 1096.0;

/// The same of a linear element: motions against the first node (12), a product with the stiffness (96), energy (16), sums at
/// the nodes (8); twice all but the energy with viscosity.
const LINEAR_OPERATIONS: f64 = 12.0 + 96.0 + 16.0 + 8.0;

/// Bytes that it moves, counted likewise: of the element the places of its nodes and the number of its matrix (12); of its
/// block, with 1.15 nodes an element, nodes, displacements and forces (60), gathered and written at the node (59); there the
/// displaced positions (80), loads (32), rates (88) and the audit (64).
const LINEAR_BYTES: f64 = 395.0;

/// Bytes of a matrix of one's own.
const MATRIX: f64 = 384.0;

/// Bytes that viscosity adds: mean velocities (64), in the block (55), gathered and written (55), added (64), audited (64).
const VISCOUS_BYTES: f64 = 302.0;

const NEO_HOOKEAN: Block = Block {
    name: "neo-Hookean",
    law: "neo_hookean",
    unstructured: false,
    viscous: false,
    operations: OPERATIONS,
    bytes: BYTES,
};

const LINEAR: Block = Block {
    name: "linear, equal elements",
    law: "linear",
    operations: LINEAR_OPERATIONS,
    bytes: LINEAR_BYTES,
    ..NEO_HOOKEAN
};

const BLOCKS: [Block; 4] = [
    NEO_HOOKEAN,
    LINEAR,
    Block { name: "linear, all different", unstructured: true, bytes: LINEAR_BYTES + MATRIX, ..LINEAR },
    Block {
        name: "linear and viscous, equal elements",
        viscous: true,
        operations: 2.0 * LINEAR_OPERATIONS - 16.0,
        bytes: LINEAR_BYTES + VISCOUS_BYTES,
        ..LINEAR
    },
];

/// Processor time of this process where the system tells (other programs take their share of the wall clock), else wall
/// time.
struct Clock {
    wall: Instant,
    processor: Option<f64>,
}

impl Clock {
    fn start() -> Self {
        Self { wall: Instant::now(), processor: processor_seconds() }
    }

    fn seconds(&self) -> f64 {
        let processor = processor_seconds().zip(self.processor).map(|(now, then)| now - then);
        processor.unwrap_or_else(|| self.wall.elapsed().as_secs_f64())
    }
}

/// Seconds that all threads of this process have run, from the Linux scheduler.
fn processor_seconds() -> Option<f64> {
    let threads = std::fs::read_dir("/proc/self/task").ok()?;
    let of = |thread: std::fs::DirEntry| {
        let text = std::fs::read_to_string(thread.path().join("schedstat")).ok()?;
        text.split_whitespace().next()?.parse::<f64>().ok()
    };
    Some(1e-9 * threads.flatten().filter_map(of).sum::<f64>())
}

/// What is measured.
struct Block {
    name: &'static str,
    law: &'static str,
    /// Nodes moved by up to a quarter of an element, and all numbered at random: no two elements are alike, or neighbours
    unstructured: bool,
    viscous: bool,
    operations: f64,
    bytes: f64,
}

/// A permutation of 0 to n − 1 without any order, the same each time.
fn shuffled(n: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by_key(|k| {
        (*k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15).swap_bytes().wrapping_mul(0xd6e8_feb8_6659_fd93)
    });
    order
}

/// A number between −1 and 1, the same for the same k.
fn arbitrary(k: usize) -> f64 {
    2.0 * ((k as f64 + 1.0) * 0.618_033_988_749_895).fract() - 1.0
}

fn case(block: &Block) -> Value {
    let count = (SIDE + 1) * (SIDE + 1);
    let number = if block.unstructured { shuffled(count) } else { (0..count).collect() };
    let node = |i: usize, j: usize| number[j * (SIDE + 1) + i];
    let order = if block.unstructured { shuffled(SIDE * SIDE) } else { (0..SIDE * SIDE).collect() };
    let mut nodes = vec![[0.0; 2]; count];
    for (i, j) in (0..count).map(|k| (k % (SIDE + 1), k / (SIDE + 1))) {
        let inside = block.unstructured && (1..SIDE).contains(&i) && (1..SIDE).contains(&j);
        let moved = |d: usize| if inside { 0.25 * arbitrary(2 * (j * SIDE + i) + d) } else { 0.0 };
        nodes[node(i, j)] = [0, 1].map(|d| ([i, j][d] as f64 + moved(d)) / SIDE as f64);
    }
    let elements: Vec<[usize; 4]> = order
        .iter()
        .map(|e| (e % SIDE, e / SIDE))
        .map(|(i, j)| [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)])
        .collect();
    let bottom: Vec<[usize; 2]> = (0..SIDE).map(|i| [node(i, 0), node(i + 1, 0)]).collect();
    let retardation = if block.viscous { 1e-5 } else { 0.0 };
    json!({
        "mesh": {"nodes": nodes, "elements": {"block": elements}, "edges": {"bottom": bottom}},
        "bodies": {"block": {
            "material": {"model": block.law, "E": 100.0, "nu": 0.3, "density": 1.0},
            "damping": {"stiffness": retardation}
        }},
        "initial_velocity": {"block": [0.1, 0.2]},
        "steps": [{
            "name": "fly", "duration": 1.0, "scheme": {"explicit": {}},
            "supports": [{"on": "bottom", "uy": "0.2*t"}],
        }],
    })
}

/// Element updates a second, the best of several stretches.
fn updates(block: &Block, threads: usize) -> f64 {
    let case = serde_json::from_value(case(block)).expect("well formed");
    let model = case::build(&case, std::path::Path::new("bench.json")).expect("a good case");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    pool.install(|| {
        let model = Arc::new(model);
        let step = Arc::new(model.steps[0].clone());
        let mut assembler = Assembler::new(&model);
        let mut state = model.initial_state();
        let mut explicit = Explicit::begin(&model, &step, &mut state, &mut assembler).expect("the step begins");
        let stretch = |k: i32| {
            let clock = Clock::start();
            let count =
                explicit.go_to(2e-3 * f64::from(k), &mut state, &mut assembler, &|| false).expect("a finite motion");
            (count * SIDE * SIDE) as f64 / clock.seconds()
        };
        (1..=8).map(stretch).fold(0.0, f64::max)
    })
}

/// Multiply-adds a second of one thread, counted as two operations each, in eight independent chains of four.
fn arithmetic() -> f64 {
    let mut sums = std::hint::black_box([[1.0f64; 4]; 8]);
    let [factor, term] = std::hint::black_box([0.999_999, 1e-6]);
    let clock = Clock::start();
    let rounds = 4_000_000;
    for _ in 0..rounds {
        for sum in &mut sums {
            sum.iter_mut().for_each(|x| *x = *x * factor + term);
        }
    }
    assert!(std::hint::black_box(sums).iter().flatten().all(|x| x.is_finite()));
    f64::from(rounds) * 64.0 / clock.seconds()
}

/// Bytes a second that one thread moves in a = b + f c over arrays far longer than the caches; the lines of a are read first.
fn memory() -> f64 {
    let n = 1 << 24;
    let [b, c] = std::hint::black_box([vec![1.0f64; n], vec![2.0f64; n]]);
    let mut a = vec![0.0f64; n];
    let clock = Clock::start();
    a.iter_mut().zip(b.iter().zip(&c)).for_each(|(a, (b, c))| *a = b + 0.5 * c);
    let seconds = clock.seconds();
    assert!(std::hint::black_box(a).iter().all(|a| *a == 2.0));
    32.0 * n as f64 / seconds
}

/// `cargo bench -p fecontact-benches --bench explicit -- viscous` measures the blocks alone whose names have that in it.
fn main() {
    let wanted = std::env::args().skip(1).find(|argument| !argument.starts_with('-')).unwrap_or_default();
    let limit = (0..3).map(|_| arithmetic()).fold(0.0, f64::max);
    let bandwidth = (0..5).map(|_| memory()).fold(0.0, f64::max);
    println!("one thread: {:.2} Gflop/s of multiply-adds, {:.2} GB/s of memory", 1e-9 * limit, 1e-9 * bandwidth);
    for block in BLOCKS.iter().filter(|block| block.name.contains(&wanted)) {
        for threads in [1, std::thread::available_parallelism().map_or(1, usize::from)] {
            let rate = updates(block, threads);
            println!(
                "{}, {threads} thread(s): {:.2} million element updates in a second of processor time, {:.0} % of the \
                 multiply-adds, {:.0} % of the memory",
                block.name,
                1e-6 * rate,
                100.0 * rate * block.operations / limit,
                100.0 * rate * block.bytes / bandwidth
            );
        }
    }
}
