//! Seeds tried one after the other on all cores; what breaks is made as small as it goes.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use crate::features::{Draft, Feature, SLOTS, Slot, excluded, features, hash, plain};
use crate::law;
use crate::model::{self, Ways};
use crate::record::{Difference, Ended};
use crate::relations::{Base, Outcome, RELATIONS, Relation};

/// A relation that a model breaks.
struct Finding {
    seed: u64,
    relation: &'static str,
    difference: Difference,
    /// the features with which it still does, and what differs then
    smallest: (Draft, Difference),
}

/// What all seeds came to.
#[derive(Default)]
struct Tally {
    models: usize,
    solved: usize,
    stopped: BTreeMap<String, Vec<u64>>,
    refused: BTreeMap<String, Vec<u64>>,
    /// how often a relation was held to, and round-off alone could have made the difference
    held: BTreeMap<&'static str, [usize; 2]>,
    /// seconds of the plain runs, and of every relation
    seconds: BTreeMap<&'static str, f64>,
    /// solved, closed and slipping models that have both features
    pairs: BTreeMap<(Feature, Feature), usize>,
    findings: Vec<Finding>,
}

fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok().map(|text| text.parse().unwrap_or_else(|_| panic!("{name}={text} is no number")))
}

#[test]
fn features_do_not_disturb_each_other() {
    let count = number("CROSSINGS").unwrap_or(60);
    let tally = hunt(number("FIRST").unwrap_or(0), count);
    tally.print(count > 60);
    assert!(tally.findings.is_empty(), "{} relations are broken", tally.findings.len());
    assert!(tally.solved * 10 >= tally.models * 8, "only {} of {} models are solved", tally.solved, tally.models);
}

/// Models that once broke a relation: the seed of their numbers, the relation, and their features (whatever a seed draws by now).
const ONCE_BROKEN: &[(u64, &str, &str)] = &[
    (
        6012,
        "turned by 37",
        "absorbing:yes block_element:f_bar block_law:neo_hookean drive:expression friction:frictionless \
         ground_law:viscoelastic interval:yes method:chosen normal:default press:pressure scheme:explicit \
         sliding:small spring:driven",
    ),
    (
        81,
        "units",
        "block_element:f_bar block_law:hencky dashpot:yes dilatancy:limited drive:expression \
         error_control:yes fluid:constant friction:super_subloading ground_law:hencky interval:yes \
         normal:augmented section:rings_on_end sliding:small varying:by_part",
    ),
    (
        85,
        "units",
        "block_law:neo_hookean damping:of_step dashpot:yes drive:table fluid:in_time ground_law:neo_hookean \
         master:itself method:mortar normal:default plate:alike scheme:explicit section:plane_stress \
         surfaces:matching varying:in_time wear:yes",
    ),
    (
        62,
        "driven",
        "block_element:f_bar block_law:neo_hookean dashpot:yes gravity:yes heat:by_place method:mortar \
         press:dead_pressure scheme:wilson tractions:given varying:in_time",
    ),
    (
        145,
        "driven",
        "absorbing:yes friction:super_subloading further_parameters:yes ground_law:hencky heat:table \
         method:mortar scheme:wilson sliding:small spring:ground",
    ),
    (
        20,
        "flight",
        "block_element:t3 block_law:hencky damping:of_body drive:rate friction:registered ground_element:t6 \
         master:itself reversal:yes scheme:explicit surfaces:matching",
    ),
    (
        20,
        "steps in two",
        "block_element:t3 block_law:hencky damping:of_body drive:rate friction:registered ground_element:t6 \
         master:itself reversal:yes scheme:explicit surfaces:matching",
    ),
    (
        101,
        "steps in two",
        "damping:of_body friction:registered ground_element:q8 heat:number interval:yes \
         method:node_to_segment press:dead_pressure scheme:explicit section:plane_stress surfaces:matching \
         wear:yes",
    ),
    (
        653,
        "steps in two",
        "block_element:q9 block_law:viscoelastic dashpot:yes dilatancy:free friction:rate_and_state \
         gauss_points:4 ground_law:neo_hookean inclined:normal normal:default scheme:hht second_contact:yes \
         section:plane_stress sliding:small tractions:given wear:yes",
    ),
    (
        130,
        "dropped",
        "block_element:t3 dilatancy:limited friction:rate_and_state gauss_points:3 massless:yes master:circle \
         point_mass:yes scheme:wilson stress:geostatic tool:moves",
    ),
    (
        221,
        "dropped",
        "damping:of_body friction:rate_and_state gauss_points:4 ground_element:q8 normal:augmented \
         periodic:yes scheme:newmark section:plane_stress sliding:small spring:driven varying:in_time",
    ),
    (
        1038,
        "dropped",
        "dashpot:yes dilatancy:free drive:table friction:super_subloading ground_element:t6 scheme:wilson \
         section:rings_on_end sliding:small spring:ground surfaces:matching varying:in_time wear:yes",
    ),
    (
        2063,
        "dropped",
        "dilatancy:limited drive:rate fluid:constant ground_element:q9 method:chosen normal:augmented \
         point_mass:yes scheme:generalized_alpha sliding:small stress:geostatic",
    ),
    (
        170,
        "mirrored",
        "damping:of_step friction:super_subloading ground_law:viscoelastic heat:by_place method:mortar \
         normal:default point_mass:yes press:total_force scheme:explicit section:plane_stress \
         stress:components velocity:initial",
    ),
    (
        2,
        "bystander",
        "block_element:q9 dashpot:yes drive:expression friction:super_subloading ground_element:f_bar \
         ground_law:saint_venant_kirchhoff method:mortar radiation:given rupture:yes spring:ends",
    ),
    (
        0,
        "flight",
        "block_element:t3 block_law:neo_hookean drive:rate interval:yes master:plane method:chosen \
         point_mass:yes scheme:explicit section:plane_stress stress:components times:yes tool:moves \
         varying:in_time",
    ),
    (
        3,
        "flight",
        "block_element:f_bar block_law:hencky dilatancy:free drive:expression friction:rate_and_state \
         ground_element:f_bar ground_law:neo_hookean massless:yes method:mortar plate:rigid \
         press:dead_pressure scheme:hht spring:ends surfaces:matching varying:by_place",
    ),
    (
        2899,
        "shuffled",
        "block_element:t6 error_control:yes friction:slip_weakening further_parameters:yes gauss_points:4 \
         ground_element:q8 normal:augmented press:force radiation:of_bodies section:rings_around \
         shrink_fit:yes varying:in_time",
    ),
    (
        1397,
        "energies",
        "block_law:saint_venant_kirchhoff fluid:in_time friction:super_subloading ground_law:viscoelastic \
         master:itself method:mortar press:force rupture:yes section:plane_stress",
    ),
    (
        1818,
        "turned by 37",
        "block_element:t6 dashpot:yes drive:expression friction:rate_and_state gauss_points:4 gravity:yes \
         master:plane press:traction scheme:wilson second_contact:yes spring:driven times:yes",
    ),
    (
        3214,
        "steps in two",
        "block_law:neo_hookean drive:table fluid:constant friction:super_subloading ground_element:q8 \
         ground_law:neo_hookean inclined:normal method:mortar press:pressure shrink_fit:yes spring:ends \
         stress:components",
    ),
    (33, "bystander", "master:plane press:plate tool:free"),
    (236, "wide", "block_law:hencky ground_law:saint_venant_kirchhoff pores:cavitating"),
    (
        1565,
        "later",
        "block_law:mohr_coulomb friction:registered massless:yes master:plane scheme:hht times:yes wear:yes",
    ),
    (
        2124,
        "dilating",
        "dilatancy:limited friction:rate_and_state gauss_points:4 ground_element:q8 normal:augmented plate:rigid \
         press:dead_pressure spring:ground stress:components",
    ),
    (24, "later", "approach:slanted bond:pulls flange:tied massless:yes scheme:wilson second_contact:yes"),
    (48, "tangents", "periodic:yes plate:rigid press:pressure sliding:small smooth:yes"),
];

#[test]
fn what_once_broke_holds() {
    law::registered();
    for (seed, name, told) in ONCE_BROKEN {
        let draft = Draft::of_told(*seed, told).unwrap_or_else(|| panic!("no model has {told}"));
        let relation = RELATIONS.iter().find(|relation| relation.name == *name).expect("a relation");
        match (relation.check)(&Base::new(&draft)) {
            Outcome::Broken(difference) => panic!("seed {seed}: {name} is broken: {difference}"),
            Outcome::Holds | Outcome::Idle => {}
        }
    }
}

/// Try seeds, as many at once as there are cores.
fn hunt(first: u64, count: u64) -> Tally {
    law::registered();
    let (next, tally) = (AtomicU64::new(first), Mutex::new(Tally::default()));
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    std::thread::scope(|scope| {
        for _ in 0..cores {
            scope.spawn(|| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= first + count {
                        return;
                    }
                    pool.install(|| try_seed(seed, &tally));
                }
            });
        }
    });
    tally.into_inner().expect("no thread has failed")
}

/// What a seed draws; with the features that `WITH` names, where they go with the others.
fn drawn(seed: u64) -> Option<Draft> {
    let Ok(told) = std::env::var("WITH") else { return Some(Draft::new(seed)) };
    let first: Vec<Feature> = told
        .split_whitespace()
        .map(|word| features().into_iter().find(|(slot, value)| word == format!("{slot}:{value}")))
        .map(|feature| feature.unwrap_or_else(|| panic!("WITH={told} names no features")))
        .collect();
    Draft::drawn(seed, &first)
}

fn try_seed(seed: u64, tally: &Mutex<Tally>) {
    let Some(draft) = drawn(seed) else { return };
    let clock = Instant::now();
    let base = match catch_unwind(|| Base::new(&draft)) {
        Ok(base) => base,
        Err(why) => return panicked(&draft, &*why, tally),
    };
    let mut seconds = vec![("the plain run", clock.elapsed().as_secs_f64())];
    let mut held = Vec::new();
    let mut findings = Vec::new();
    if !matches!(base.record.ended, Ended::Refused(_)) {
        let only = std::env::var("RELATION").ok();
        let own = |relation: &&Relation| match &only {
            Some(only) => only == relation.name,
            None => hash(seed, relation.name).is_multiple_of(relation.rarity),
        };
        for relation in RELATIONS.iter().filter(own) {
            let clock = Instant::now();
            let outcome = checked(relation, &base);
            seconds.push((relation.name, clock.elapsed().as_secs_f64()));
            match outcome {
                Outcome::Idle => held.push((relation.name, 1)),
                Outcome::Holds => held.push((relation.name, 0)),
                Outcome::Broken(difference) => {
                    let smallest = smallest(&draft, difference.clone(), relation);
                    findings.push(Finding { seed, relation: relation.name, difference, smallest });
                }
            }
        }
    }
    let mut tally = tally.lock().expect("no thread has failed");
    tally.models += 1;
    if tally.models.is_multiple_of(500) {
        println!("{} models so far, {} findings", tally.models, tally.findings.len());
    }
    let said = |message: &str| -> String { message.chars().filter(|c| !c.is_ascii_digit()).take(160).collect() };
    match &base.record.ended {
        Ended::Complete => tally.solved += 1,
        Ended::Stopped(why) => tally.stopped.entry(said(why)).or_default().push(seed),
        Ended::Refused(why) => tally.refused.entry(said(why)).or_default().push(seed),
    }
    for (name, k) in held {
        tally.held.entry(name).or_default()[k] += 1;
    }
    if base.record.ended == Ended::Complete && base.record.closed && base.record.slipped {
        let own = draft.features();
        for (k, a) in own.iter().enumerate() {
            for b in &own[..k] {
                *tally.pairs.entry((*b, *a)).or_default() += 1;
            }
        }
    }
    for (name, seconds) in seconds {
        *tally.seconds.entry(name).or_default() += seconds;
    }
    for finding in &findings {
        finding.print();
    }
    tally.findings.extend(findings);
}

/// Whether a relation holds; where the program panics it does not.
fn checked(relation: &Relation, base: &Base) -> Outcome {
    catch_unwind(AssertUnwindSafe(|| (relation.check)(base))).unwrap_or_else(|why| Outcome::Broken(panic_of(&*why)))
}

fn panic_of(why: &(dyn std::any::Any + Send)) -> Difference {
    let message = why.downcast_ref::<String>().cloned().or_else(|| why.downcast_ref::<&str>().map(|s| (*s).into()));
    let place = format!("it panicked: {}", message.unwrap_or_default());
    Difference { share: f64::INFINITY, place, values: [0.0; 2] }
}

/// A model whose plain run panics.
fn panicked(draft: &Draft, why: &(dyn std::any::Any + Send), tally: &Mutex<Tally>) {
    let panics = |draft: &Draft| catch_unwind(|| Base::new(draft)).is_err();
    let mut smallest = draft.clone();
    loop {
        let Some(less) = less_than(&smallest).find(panics) else { break };
        smallest = less;
    }
    let difference = panic_of(why);
    let finding = Finding { seed: draft.seed, relation: "runs", smallest: (smallest, difference.clone()), difference };
    finding.print();
    let mut tally = tally.lock().expect("no thread has failed");
    tally.models += 1;
    tally.findings.push(finding);
}

/// The draft with one feature less, each in turn.
fn less_than(draft: &Draft) -> impl Iterator<Item = Draft> + use<> {
    let draft = draft.clone();
    let less = move |(slot, _): &Slot| if draft.has(slot) { draft.with(slot, plain(slot)) } else { None };
    SLOTS.iter().filter_map(less)
}

/// Take features away one by one while the relation is still broken.
fn smallest(draft: &Draft, difference: Difference, relation: &Relation) -> (Draft, Difference) {
    let broken = |draft: Draft| {
        let base = catch_unwind(|| Base::new(&draft)).ok()?;
        match checked(relation, &base) {
            Outcome::Broken(difference) if !matches!(base.record.ended, Ended::Refused(_)) => Some((draft, difference)),
            _ => None,
        }
    };
    let mut smallest = (draft.clone(), difference);
    loop {
        let less = less_than(&smallest.0).find_map(broken);
        match less {
            Some(less) => smallest = less,
            None => return smallest,
        }
    }
}

impl Finding {
    fn print(&self) {
        let Self { seed, relation, difference, smallest: (smallest, least) } = self;
        println!("seed {seed}: {relation} is broken: {difference}");
        println!("    with {}: {least}", smallest.told());
        if std::env::var_os("CASES").is_some() {
            println!("{}", model::case(smallest, &Ways::plain(smallest)));
        }
    }
}

impl Tally {
    fn print(&self, pairs: bool) {
        println!("{} models: {} solved", self.models, self.solved);
        for (what, all) in [("stopped", &self.stopped), ("refused", &self.refused)] {
            let total: usize = all.values().map(Vec::len).sum();
            println!("{total} {what}");
            for (why, seeds) in all {
                println!("    {} × {why} (seeds {:?})", seeds.len(), &seeds[..seeds.len().min(4)]);
            }
        }
        for (name, [holds, idle]) in &self.held {
            println!("{name}: held {holds} times, had nothing to say {idle} times");
        }
        for (name, seconds) in &self.seconds {
            println!("{:.3} s a seed for {name}", seconds / self.models as f64);
        }
        if pairs {
            self.print_pairs();
        }
    }

    /// How often each allowed pair of features was solved, closed and slipping.
    fn print_pairs(&self) {
        let all = features();
        let mut rare = Vec::new();
        for (k, a) in all.iter().enumerate() {
            for b in all[..k].iter().filter(|b| b.0 != a.0 && excluded(*a, **b).is_none()) {
                let key = if b < a { (*b, *a) } else { (*a, *b) };
                rare.push((self.pairs.get(&key).copied().unwrap_or(0), key));
            }
        }
        rare.sort();
        println!("{} pairs of features can meet", rare.len());
        for limit in [0, 5, 20, 100, 1000] {
            println!("    {} in at most {limit} models", rare.iter().filter(|(count, _)| *count <= limit).count());
        }
        for (count, (a, b)) in rare.iter().filter(|(count, _)| *count < 20) {
            println!("{count} × {}:{} with {}:{}", a.0, a.1, b.0, b.1);
        }
    }
}
