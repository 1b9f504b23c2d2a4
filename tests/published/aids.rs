//! What each aid of the iterations saves, over a fixed list of cases; and that no accepted state leans on one.
//!
//! `RAYON_NUM_THREADS=1 cargo test --release --test published -- --ignored --nocapture ablation` prints the table of
//! `docs/aids.md`, `CASES=greco,tube` in the environment the columns of these alone.

use std::collections::BTreeMap;
use std::sync::Arc;

use fecontact::contact::force::ContactState;
use fecontact::equations::{Assembler, Trial};
use fecontact::model::aids::Aids;
use fecontact::model::{Model, State};
use fecontact::run::run;
use fecontact::run::{Attempt, Error, Observer};
use fecontact::solve::contact_iteration::Acted;
use serde_json::{Value, json};

use crate::common::{Blocks, model, model_at, over_a_ridge};

/// A case of the list.
struct Case {
    name: &'static str,
    model: fn() -> Model,
    /// Whether it takes a second or less
    quick: bool,
}

fn committed(name: &str, change: impl Fn(&mut Value)) -> Model {
    let path = crate::common::repository(format!("cases/{name}.json"));
    let mut case: Value = serde_json::from_str(&std::fs::read_to_string(&path).expect("a case")).expect("JSON");
    change(&mut case);
    model_at(&case, &path)
}

fn as_it_is(_: &mut Value) {}

/// Shorten step `k` to a share.
fn shorten(case: &mut Value, k: usize, share: f64) {
    let duration = case["steps"][k]["duration"].as_f64().expect("a duration");
    case["steps"][k]["duration"] = json!(share * duration);
    for support in case["steps"][k]["supports"].as_array_mut().expect("supports") {
        for u in ["ux", "uy"] {
            if let Some(value) = support[u].as_f64() {
                support[u] = json!(share * value);
            }
        }
    }
}

/// A committed case with a hundred times the default α_n, 3·10⁴ (λ + 2G)/h, and an α_t of 500 (λ + 2G)/h.
fn stiff(name: &str, change: impl Fn(&mut Value)) -> Model {
    let alpha_n = committed(name, &change).contacts[0].alpha_n;
    committed(name, |case| {
        change(case);
        let contact = &mut case["contacts"]["base"];
        contact["normal"]["alpha_n"] = json!(100.0 * alpha_n);
        contact["friction"]["alpha_t"] = json!(5.0 / 3.0 * alpha_n);
    })
}

/// Up to where all points slip.
fn without_slide(case: &mut Value) {
    case["steps"].as_array_mut().expect("steps").truncate(2);
}

fn first_tenth(case: &mut Value) {
    shorten(case, 1, 0.1);
}

/// A block dragged over the end of its ground, by nodes.
fn off_an_end([pressed, mu, length]: [f64; 3]) -> Model {
    let body = json!({"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}});
    model(&json!({
        "mesh": Blocks::default()
            .rectangle("ground", [8, 3], [-2.0, -0.8], [2.0, 0.0])
            .rectangle("block", [5, 3], [0.9, 0.0], [0.9 + length, 0.6]).json(),
        "bodies": {"ground": body, "block": body},
        "contacts": {"base": {"slave": "block_bottom", "master": "ground_top", "method": "node_to_segment",
                              "friction": {"law": "coulomb", "mu": 0.3 * mu}}},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.5},
             "supports": [{"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0, "uy": -0.01 * pressed}]},
            {"name": "drag", "duration": 1, "dt": {"initial": 0.04}, "supports": [{"on": "block_top", "ux": 1.3}]},
        ],
    }))
}

fn slotted_ring([slot, mu, thickness]: [f64; 3]) -> Model {
    use std::f64::consts::PI;
    let [across, around] = [4, 48];
    let map = |s: f64, t: f64| {
        let radius = 1.0 + 0.3 * thickness * s.powf(1.0 + 0.3 * t);
        let angle = (2.0 * t - 1.0) * (PI - (0.05 * slot / radius).asin());
        [radius * angle.cos(), radius * angle.sin()]
    };
    let mut mesh = Blocks::default().block("ring", [across, around], map).json();
    let edges = |side: &str| mesh["edges"][format!("ring_{side}")].as_array().expect("edges").clone();
    let lips = [edges("bottom"), edges("top")].concat();
    mesh["edges"]["lips"] = json!(lips);
    let outside = |quarter: usize| quarter * around / 4 * (across + 1) + across;
    mesh["points"] = json!({"south": [outside(1)], "north": [outside(3)]});
    model(&json!({
        "mesh": mesh,
        "bodies": {"ring": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}}},
        "contacts": {"lips": {"slave": "lips", "master": "lips", "friction": {"law": "coulomb", "mu": 0.2 * mu}}},
        "steps": [{"name": "squeeze", "duration": 1, "dt": {"initial": 0.1}, "supports": [
            {"on": "north", "ux": 0, "uy": -0.042}, {"on": "south", "ux": 0, "uy": 0.042}]}],
    }))
}

/// A slab, pressed and sheared at once from a gap.
fn slab(gap: f64, dt: f64, m: usize, alpha: f64, mu: f64) -> Model {
    model(&json!({
        "mesh": Blocks::default().rectangle("slab", [2 * m, m], [0.0, gap], [1.0, gap + 0.5]).json(),
        "bodies": {"slab": {"material": {"model": "linear", "E": 1000.0, "nu": 0.3}}},
        "contacts": {"base": {"slave": "slab_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
                              "normal": {"alpha_n": alpha}, "friction": {"law": "coulomb", "mu": mu, "alpha_t": alpha}}},
        "steps": [{"name": "in", "duration": 1, "dt": {"initial": dt, "max": dt},
                   "supports": [{"on": "slab_top", "ux": 0.01, "uy": -0.005 - gap}]}],
    }))
}

/// Slabs of many kinds, pressed and sheared from touch: all their counts together.
fn ridge(slope: f64, mu: f64, length: f64) -> Model {
    let top = |x: f64| slope * x.abs();
    let block = |s: f64| -0.75 + 0.3 * length * s;
    model(&json!({
        "mesh": Blocks::default()
            .block("ground", [20, 3], |s, t| [2.0 * s - 1.0, -0.5 + t * (0.5 + top(2.0 * s - 1.0))])
            .block("block", [5, 3], |s, t| [block(s), top(block(s)) + 0.2 * t]).json(),
        "bodies": {
            "ground": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}},
            "block": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}},
        },
        "contacts": {"base": {"slave": "block_bottom", "master": "ground_top", "friction": {"law": "coulomb", "mu": mu}}},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.25},
             "supports": [{"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0}],
             "loads": [{"on": "block_top", "traction": {"y": -5}}]},
            {"name": "push", "duration": 1, "dt": {"initial": 0.02, "min": 1e-7}, "supports": [{"on": "block_top", "ux": 1.2}]},
        ],
    }))
}

/// A cantilever 10 long and 0.25 high, pushed on the end of one like it.
fn cantilevers([height, length, overlap]: [f64; 3]) -> Model {
    model(&json!({
        "mesh": Blocks::default()
            .rectangle("lower", [80, 2], [0.0, -0.25 * height], [10.0 * length, 0.0])
            .rectangle("upper", [83, 2], [5.0 * overlap, 0.0], [15.0, 0.25]).json(),
        "bodies": {
            "lower": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}},
            "upper": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}},
        },
        "contacts": {"base": {"slave": "upper_bottom", "master": "lower_top", "friction": {"law": "frictionless"}}},
        "steps": [{"name": "push", "duration": 1, "dt": {"initial": 0.05}, "supports": [
            {"on": "lower_left", "ux": 0, "uy": 0}, {"on": "upper_right", "ux": 0, "uy": -1},
        ]}],
    }))
}

/// A softer block pushed by its top over a faceted ridge, with an α_t of 5 (λ + 2G)/h.
fn faceted(height: f64, mu: f64, length: f64) -> Model {
    let mut case = over_a_ridge(height, length, "node_to_segment", json!({"law": "coulomb", "mu": mu}));
    let alpha_n = model(&case).contacts[0].alpha_n;
    case["contacts"]["base"]["friction"]["alpha_t"] = json!(5.0 / 300.0 * alpha_n);
    model(&case)
}

fn struck_bar(error: Option<f64>) -> Model {
    let h = 0.01;
    let mut dt = json!({"initial": h});
    if let Some(error) = error {
        dt["error"] = json!(error);
        dt["min"] = json!(1e-6);
    }
    model(&json!({
        "mesh": Blocks::default().rectangle("bar", [100, 1], [0.0, 0.0], [1.0, 0.02]).json(),
        "bodies": {"bar": {"material": {"model": "neo_hookean", "E": 1, "nu": 0, "density": 1}}},
        "contacts": {"wall": {"slave": "bar_left", "master": {"plane": {"point": [0, 0], "normal": [1, 0]}},
                              "massless": true, "normal": {"alpha_n": 10.0 / h}, "friction": {"law": "frictionless"}}},
        "initial_velocity": {"bar": [-1e-3, 0]},
        "steps": [{"name": "hit", "duration": 2.5, "dt": dt, "scheme": {"newmark": {}}, "supports": [{"on": "bar", "uy": 0}]}],
    }))
}

/// A slab thrown obliquely on a rough rigid plane.
fn thrown(alpha: f64) -> Model {
    model(&json!({
        "mesh": Blocks::default().rectangle("slab", [16, 8], [0.0, 0.001], [1.0, 0.501]).json(),
        "bodies": {"slab": {"material": {"model": "neo_hookean", "E": 1, "nu": 0.3, "density": 1}}},
        "contacts": {"floor": {"slave": "slab_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
                              "massless": true, "normal": {"alpha_n": alpha}, "friction": {"law": "coulomb", "mu": 0.3}}},
        "initial_velocity": {"slab": [0.05, -0.05]},
        "steps": [{"name": "hit", "duration": 3, "dt": {"initial": 0.02}, "scheme": {"hht": {"alpha": -0.1}}}],
    }))
}

const fn quick(name: &'static str, model: fn() -> Model) -> Case {
    Case { name, model, quick: true }
}

const fn slow(name: &'static str, model: fn() -> Model) -> Case {
    Case { name, model, quick: false }
}

const CASES: [Case; 27] = [
    slow("coulomb_drag_5k", || committed("coulomb_drag_5k", as_it_is)),
    slow("coulomb_drag_20k", || committed("coulomb_drag_20k", as_it_is)),
    slow("block_on_ground", || committed("block_on_ground", without_slide)),
    quick("hertz_q4", || committed("validation/hertz_q4", as_it_is)),
    slow("hertz_q8_friction", || committed("validation/hertz_q8_friction", as_it_is)),
    slow("mindlin", || committed("validation/mindlin", |case| shorten(case, 1, 0.25))),
    slow("mindlin_healing", || committed("validation/mindlin_healing", |case| shorten(case, 1, 0.25))),
    quick("greco", || committed("validation/greco", as_it_is)),
    quick("wedge", || committed("validation/wedge", as_it_is)),
    slow("ironing_q4", || committed("validation/ironing_q4", first_tenth)),
    slow("ironing_q8", || committed("validation/ironing_q8", first_tenth)),
    quick("self_contact", || slotted_ring(AS_IT_IS)),
    slow("tube", || committed("tube", as_it_is)),
    quick("off_an_end", || off_an_end(AS_IT_IS)),
    quick("impact", || struck_bar(None)),
    quick("impact_error", || struck_bar(Some(1e-6))),
    quick("slope", || committed("paper/slope", |case| case["steps"][0]["duration"] = json!(5))),
    quick("thrown", || thrown(1e5)),
    quick("cantilevers", || cantilevers(AS_IT_IS)),
    quick("ridge", || faceted(0.2, 0.3, 1.0)),
    quick("valley", || ridge(0.1, 0.5, 1.0)),
    quick("slab_touch", || slab(0.0, 0.1, 8, 1e6, 0.5)),
    quick("slab_touch_once", || slab(0.0, 1.0, 4, 1e6, 5.0)),
    quick("slab_gap", || slab(0.001, 1.0, 8, 1e6, 5.0)),
    slow("hertz_q8_friction × 100", || stiff("validation/hertz_q8_friction", as_it_is)),
    slow("ironing_q4 × 100", || stiff("validation/ironing_q4", first_tenth)),
    quick("greco augmented", || {
        committed("validation/greco", |case| {
            case["contacts"]["base"]["normal"] = json!({"alpha_n": 1e5, "penetration": 1e-7});
        })
    }),
];

/// Three numbers of a case, unchanged.
const AS_IT_IS: [f64; 3] = [1.0; 3];

/// A case by name, and its model with three of its numbers times what is given.
type Neighbours = (&'static str, fn([f64; 3]) -> Model);

/// Cases in which many states are on edge, with three of their numbers times what is given: slope, slot or gap; μ; an edge of the mesh.
const ON_EDGE: [Neighbours; 6] = [
    ("ridge", |[slope, mu, length]| faceted(0.2 * slope, 0.3 * mu, length)),
    ("valley", |[slope, mu, length]| ridge(0.1 * slope, 0.5 * mu, length)),
    ("self_contact", slotted_ring),
    ("off_an_end", off_an_end),
    ("cantilevers", cantilevers),
    ("slab_gap", |[gap, mu, stiff]| slab(0.001 * gap, 1.0, 8, 1e6 * stiff, 5.0 * mu)),
];

fn case(name: &str) -> &'static Case {
    CASES.iter().find(|case| case.name == name).unwrap_or_else(|| panic!("no case {name}"))
}

/// An aid, and how to switch it off.
type Switch = (&'static str, fn(&mut Aids));

const SWITCHES: [Switch; 14] = [
    ("start", |aids| aids.start = false),
    ("prediction", |aids| aids.prediction = false),
    ("limit", |aids| aids.limit = false),
    ("active_set", |aids| aids.active_set = false),
    ("active_set_at_start", |aids| aids.active_set_at_start = false),
    ("predicted_pressure", |aids| aids.predicted_pressure = false),
    ("touch", |aids| aids.touch = false),
    ("stick", |aids| aids.stick = false),
    ("stick_again", |aids| aids.stick_again = false),
    ("valley", |aids| aids.valley = false),
    ("old_tangents", |aids| aids.old_tangents = false),
    ("downhill", |aids| aids.downhill = false),
    ("stiffening", |aids| aids.stiffening = false),
    ("softening", |aids| aids.softening = false),
];

/// What a run cost.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Cost {
    solves: usize,
    factorizations: usize,
    increments: usize,
    cutbacks: usize,
    stopped: bool,
    /// Sum of the counts of [`Acted`]
    acted: [usize; Acted::COLUMNS.len()],
}

/// Sums what the aids did, and ends the run after as many solves as are enough.
struct Watch {
    acted: [usize; Acted::COLUMNS.len()],
    solves: usize,
    enough: usize,
}

impl Observer for Watch {
    fn record(&mut self, _: &Model, attempt: &Attempt) -> Result<(), Error> {
        for iteration in attempt.iterations {
            self.acted.iter_mut().zip(iteration.acted.counts()).for_each(|(sum, count)| *sum += count);
        }
        self.solves += attempt.iterations.len();
        if self.solves >= self.enough { Err(Error::Ended("enough is known".into())) } else { Ok(()) }
    }
}

fn cost(model: Model) -> Cost {
    cost_until(usize::MAX, model)
}

/// The cost up to as many solves.
fn cost_until(enough: usize, model: Model) -> Cost {
    let mut watch = Watch { acted: Default::default(), solves: 0, enough };
    let (report, result) = run(&Arc::new(model), &mut [&mut watch]);
    Cost {
        solves: watch.solves,
        factorizations: report.factorizations,
        increments: report.increments,
        cutbacks: report.cutbacks,
        stopped: result.is_err_and(|error| !matches!(error, Error::Ended(_))),
        acted: watch.acted,
    }
}

/// A case without one aid.
fn without(off: fn(&mut Aids), case: &Case) -> Model {
    let mut model = (case.model)();
    off(&mut model.aids);
    model
}

impl Cost {
    /// Whether an aid saves a twentieth of the solves (or factorizations, if they are what it saves), a cut-back or the run,
    /// `without` being the cost without it.
    fn is_saved(&self, without: &Self, factorizations: bool) -> bool {
        let of = |cost: &Self| if factorizations { cost.factorizations } else { cost.solves };
        20 * of(without) >= 21 * of(self) || without.cutbacks > self.cutbacks || without.stopped && !self.stopped
    }

    fn print(&self) -> String {
        let Self { solves, factorizations, increments, cutbacks, stopped, .. } = self;
        let cut = if *cutbacks > 0 { format!(", {cutbacks} cut") } else { String::new() };
        format!("{solves} ({factorizations}) / {increments}{cut}{}", if *stopped { ", stopped" } else { "" })
    }
}

/// Evaluates every accepted state afresh.
struct Afresh {
    model: Arc<Model>,
    states: usize,
    /// Largest imbalance of a body or a contact over what is tolerated
    imbalance: f64,
}

impl Observer for Afresh {
    /// From the committed state and the accepted displacement alone, by an assembler that has seen nothing before, nothing
    /// predicted.
    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let Some(new) = attempt.accepted else { return Ok(()) };
        // The multipliers of the last pass, as they are at the stiffness given; 0 for the plain penalty.
        let multiplied =
            |(old, new): (&ContactState, &ContactState)| ContactState { multiplier: new.multiplier, ..old.clone() };
        let contacts = attempt.old.contacts.iter().zip(&new.contacts);
        let contacts = contacts.map(|(old, new)| old.iter().zip(new).map(multiplied).collect()).collect();
        let old = State { contacts, ..attempt.old.clone() };
        let mut assembler = Assembler::new(&self.model);
        let mut system = assembler.system();
        let trial = Trial::new(&old, attempt.step, new.time, new.time - old.time);
        assembler.residual(trial, &new.displacement, &mut system).expect("an accepted state can be evaluated");
        self.states += 1;
        self.imbalance = self.imbalance.max(system.imbalance / model.newton.tolerance);
        if model.contacts.iter().all(|pair| pair.penetration.is_none()) {
            assert_eq!(assembler.evaluation.contacts, new.contacts, "t = {}", new.time);
            assert_eq!(assembler.evaluation.force, new.force, "t = {}", new.time);
        }
        Ok(())
    }
}

/// Every accepted state of a case balances, body by body and contact by contact, whatever aids found it; contact states and
/// forces are the same to the bit.
fn check_afresh(case: &Case) {
    let model = Arc::new((case.model)());
    let mut afresh = Afresh { model: model.clone(), states: 0, imbalance: 0.0 };
    let (report, result) = run(&model, &mut [&mut afresh]);
    let Afresh { states, imbalance, .. } = afresh;
    println!("{}: {states} states, worst imbalance {imbalance:.2} of the tolerance", case.name);
    result.unwrap_or_else(|error| panic!("{}: {error}", case.name));
    assert!(states > 0 && states == report.increments);
    // Under the augmented Lagrangian the same pressure is the sum of two other numbers.
    assert!(imbalance <= 1.0 + 1e-6, "{}: {imbalance}", case.name);
}

#[test]
fn accepted_states_lean_on_no_aid() {
    CASES.iter().filter(|case| case.quick).for_each(check_afresh);
}

#[test]
#[ignore = "slow: minutes"]
fn accepted_states_of_long_cases_lean_on_no_aid() {
    CASES.iter().filter(|case| !case.quick).for_each(check_afresh);
}

/// One case an aid in which it saves solves or a failure; there it acts, and not if it is off.
#[test]
fn every_aid_saves_solves_or_a_failure() {
    let mut all = BTreeMap::new();
    for (aid, name) in [
        ("start", "greco"),
        ("prediction", "ridge"),
        ("limit", "hertz_q4"),
        ("active_set", "ridge"),
        ("active_set_at_start", "ridge"),
        ("predicted_pressure", "ridge"),
        ("touch", "slab_touch_once"),
        ("stick", "slab_gap"),
        ("stick_again", "ridge"),
        ("valley", "off_an_end"),
        ("old_tangents", "valley"),
        ("downhill", "ridge"),
        ("stiffening", "greco augmented"),
        ("softening", "cantilevers"),
    ] {
        let (_, off) = SWITCHES.iter().find(|(name, _)| *name == aid).expect("an aid");
        let with = all.entry(name).or_insert_with(|| cost((case(name).model)()));
        let factorizations = aid == "old_tangents";
        let enough = if factorizations { usize::MAX } else { (21 * with.solves).div_ceil(20) };
        let without = cost_until(enough, without(*off, case(name)));
        println!("{aid}: {name} {} with, {} without", with.print(), without.print());
        assert!(with.is_saved(&without, factorizations), "{aid}: {with:?}, without {without:?}");
        let column = Acted::COLUMNS.iter().position(|column| *column == format!("aid_{aid}"));
        let acted = |cost: &Cost| column.map_or(cost.solves - cost.factorizations, |column| cost.acted[column]);
        assert!(acted(with) > 0 && acted(&without) == 0, "{aid}: {with:?}, without {without:?}");
    }
}

/// Two slender cantilevers that press on each other: with default penalties 2758 solves and 186 rejected attempts before points that a start
/// value lifts a little stayed closed, and softer penalties were tried first.
#[test]
fn slender_bodies_press_on_each_other() {
    let cost = cost(cantilevers(AS_IT_IS));
    assert!(!cost.stopped && cost.cutbacks <= 10 && cost.solves <= 400, "{cost:?}");
}

/// The table of `docs/aids.md`: rows in which an aid changes the cost by a twentieth or more, or what fails.
#[test]
#[ignore = "slow: minutes; prints the table of docs/aids.md"]
fn ablation() {
    let wanted = std::env::var("CASES").unwrap_or_default();
    let wanted: Vec<&str> = wanted.split(',').filter(|name| !name.is_empty()).collect();
    let cases: Vec<&Case> = CASES.iter().filter(|case| wanted.is_empty() || wanted.contains(&case.name)).collect();
    let all: Vec<Cost> = cases.iter().map(|case| cost((case.model)())).collect();
    println!("| without | case | with it | without it |\n|---|---|---|---|");
    for (aid, off) in SWITCHES {
        for (case, with) in cases.iter().zip(&all) {
            let without = cost(without(off, case));
            let factorizations = aid == "old_tangents";
            if with.is_saved(&without, factorizations) {
                println!("| {aid} | {} | {} | {} |", case.name, with.print(), without.print());
            } else if without.is_saved(with, factorizations) {
                println!("| {aid} | {} (worse with it) | {} | {} |", case.name, with.print(), without.print());
            }
        }
    }
}

/// The table of neighbours of `docs/aids.md`: twenty of each case that is on edge (`NEIGHBOURS` in the environment: as many), whose numbers
/// differ by up to 2 %. Runs that end, and the solves without an aid over those with it where both end, their geometric mean.
#[test]
#[ignore = "slow: minutes; prints the table of neighbours of docs/aids.md"]
fn neighbours() {
    let of = |name: &str| std::env::var(name).unwrap_or_default();
    let (aids, cases, count) = (of("AIDS"), of("CASES"), of("NEIGHBOURS").parse().unwrap_or(20));
    let is_wanted = |list: &str, name: &str| list.is_empty() || list.split(',').any(|of| of == name);
    let share = |k: usize, base: f64| 1.0 + 0.02 * (2.0 * (base * (k + 1) as f64).fract() - 1.0);
    // Multiples of these irrational numbers fill a cube evenly.
    let changes: Vec<[f64; 3]> =
        (0..count).map(|k| [0.8191725, 0.6710436, 0.5497005].map(|base| share(k, base))).collect();
    println!("| without | case | ended with it | without it | solves, ratio |\n|---|---|---|---|---|");
    for (name, model) in ON_EDGE.into_iter().filter(|(name, _)| is_wanted(&cases, name)) {
        let with: Vec<Cost> = changes.iter().map(|change| cost(model(*change))).collect();
        for (aid, off) in SWITCHES.iter().filter(|(aid, _)| is_wanted(&aids, aid)) {
            let without = |(change, with): (&[f64; 3], &Cost)| {
                let mut model = model(*change);
                off(&mut model.aids);
                cost_until(20 * with.solves, model)
            };
            let without: Vec<Cost> = changes.iter().zip(&with).map(without).collect();
            let ended = |all: &[Cost]| all.iter().filter(|cost| !cost.stopped).count();
            let both = with.iter().zip(&without).filter(|(with, without)| !with.stopped && !without.stopped);
            let ratios: Vec<f64> =
                both.map(|(with, without)| (without.solves as f64 / with.solves as f64).ln()).collect();
            let mean = (ratios.iter().sum::<f64>() / ratios.len() as f64).exp();
            println!("| {aid} | {name} | {} | {} | {mean:.2} |", ended(&with), ended(&without));
        }
    }
}
