//! Every pair of features that can meet is solved, closed and slipping in many models.

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::features::{Draft, Feature, excluded, features, names};
use crate::law;
use crate::record::Ended;
use crate::relations::Base;

/// So many models have each pair.
const ENOUGH: usize = 20;

/// So many are drawn for a pair before it is given up.
const TRIES: u64 = 200;

/// Features that meet more rarely, each with some others, and why.
const RARELY: &[(&str, &[&str], &str)] = &[
    (
        "scheme:wilson",
        &[
            "stress",
            "tractions",
            "fluid",
            "pores:cavitating",
            "ground_law:cam_clay",
            "block_law:cam_clay",
            "ground_law:sys_cam_clay",
            "block_law:sys_cam_clay",
        ],
        "Wilson-θ overshoots what acts at once, and a run whose motion gains energy ends with an error",
    ),
    ("friction:frictionless", &["tractions"], "a traction above the strength is refused, and there is none"),
    ("scheme:quasi_dynamic", &["press:force"], "a force at one node opens points, which ends such a step"),
    ("tool:free", &["until"], "its reference point is led by loads, before which no step may end early"),
];

/// Whether two features meet rarely for a known reason.
fn is_rare([a, b]: &[Feature; 2]) -> bool {
    RARELY.iter().any(|(one, others, _)| {
        let meets = |a: Feature, b: Feature| names(one, a) && others.iter().any(|other| names(other, b));
        meets(*a, *b) || meets(*b, *a)
    })
}

/// How often each pair was met, and what became of other models that were drawn for it.
#[derive(Default)]
struct Met {
    pairs: BTreeMap<[Feature; 2], usize>,
    drawn: usize,
    failed: BTreeMap<[Feature; 2], BTreeMap<String, usize>>,
}

impl Met {
    fn count(&self, pair: &[Feature; 2]) -> usize {
        self.pairs.get(pair).copied().unwrap_or_default()
    }
}

/// `cargo test --release --test crossings every_pair -- --ignored --nocapture` prints the pairs that are met most rarely.
#[test]
#[ignore = "minutes"]
fn every_pair_of_features_is_solved_closed_and_slipping() {
    law::registered();
    let mut all = features();
    all.sort_unstable();
    let pairs: Vec<[Feature; 2]> =
        all.iter().enumerate().flat_map(|(k, b)| all[..k].iter().map(move |a| [*a, *b])).collect();
    let pairs: Vec<[Feature; 2]> = pairs.into_iter().filter(|[a, b]| excluded(*a, *b).is_none()).collect();
    let (next, met) = (AtomicUsize::new(0), Mutex::new(Met::default()));
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    std::thread::scope(|scope| {
        for _ in 0..cores {
            scope.spawn(|| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
                while let Some(pair) = pairs.get(next.fetch_add(1, Ordering::Relaxed)) {
                    pool.install(|| meet(pair, &met));
                }
            });
        }
    });
    let met = met.into_inner().expect("no thread has failed");
    let mut counts: Vec<(usize, &[Feature; 2])> = pairs.iter().map(|pair| (met.count(pair), pair)).collect();
    counts.sort_unstable();
    println!("{} pairs of features can meet; {} models were drawn", pairs.len(), met.drawn);
    for limit in [20, 50, 100, 200, 500, 1000] {
        println!("    {} in at most {limit} models", counts.iter().filter(|(count, _)| *count <= limit).count());
    }
    let rare: Vec<_> = counts.iter().filter(|(count, _)| *count < ENOUGH).collect();
    let unknown = rare.iter().filter(|(_, pair)| !is_rare(pair)).count();
    for (count, pair) in &rare {
        let [a, b] = pair;
        println!("{count} × {}:{} with {}:{}; {:?}", a.0, a.1, b.0, b.1, met.failed.get(*pair));
    }
    assert!(unknown == 0, "{unknown} pairs are in less than {ENOUGH} models, and nothing says why");
}

/// Draw models that have a pair until it was met often enough.
fn meet(pair: &[Feature; 2], met: &Mutex<Met>) {
    for seed in 0..TRIES {
        if met.lock().expect("no thread has failed").count(pair) >= ENOUGH {
            return;
        }
        let Some(draft) = Draft::drawn(seed, pair) else { continue };
        let record = Base::new(&draft).record;
        let why = match record.ended {
            Ended::Complete if record.closed && record.slipped => None,
            Ended::Complete if record.closed => Some("did not slip".into()),
            Ended::Complete => Some("did not close".into()),
            Ended::Stopped(why) | Ended::Refused(why) => {
                Some(why.chars().filter(|letter| !letter.is_ascii_digit()).take(120).collect::<String>())
            }
        };
        let mut met = met.lock().expect("no thread has failed");
        met.drawn += 1;
        match why {
            Some(why) => *met.failed.entry(*pair).or_default().entry(why).or_default() += 1,
            None => {
                let mut own = draft.features();
                own.sort_unstable();
                for (k, b) in own.iter().enumerate() {
                    own[..k].iter().for_each(|a| *met.pairs.entry([*a, *b]).or_default() += 1);
                }
            }
        }
    }
    let [a, b] = pair;
    println!("given up: {}:{} with {}:{}", a.0, a.1, b.0, b.1);
}
