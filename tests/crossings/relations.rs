//! What must hold between two ways of writing the same problem, or between two problems that become the same.

use crate::features::{Draft, hash};
use crate::frame::Kind;
use crate::mesh::is_quadratic;
use crate::model::{self, Ways, is_dynamic, is_explicit, moves};
use crate::record::{Difference, Ended, Entry, Lead, Record, compare, is_aside, run};

/// A relation: its name, and what breaks it, if anything does. Nothing where it does not apply.
pub struct Relation {
    pub name: &'static str,
    /// one of so many models is held to it
    pub rarity: u64,
    pub check: fn(&Base) -> Outcome,
}

/// What came of a relation.
pub enum Outcome {
    /// It says nothing of this model
    Idle,
    Holds,
    Broken(Difference),
}

/// A draft, its plain run, and what perturbations make of it.
pub struct Base<'a> {
    pub draft: &'a Draft,
    pub ways: Ways,
    pub record: Record,
}

impl<'a> Base<'a> {
    pub fn new(draft: &'a Draft) -> Self {
        let ways = Ways::plain(draft);
        let record = run(&model::case(draft, &ways), &ways, Lead::Through);
        Self { draft, ways, record }
    }

    fn run(&self, ways: &Ways) -> Record {
        run(&model::case(self.draft, ways), ways, Lead::Through)
    }

    /// How far the plain run moves when its numbers change in the 12th digit: what round-off can do to this model.
    pub fn sensitivity(&self, skip: &dyn Fn(&str) -> bool) -> f64 {
        let of = |noise| self.moves_by(Ways { noise: Some(noise), ..self.ways.clone() }, skip);
        (1..=NOISES).map(of).fold(0.0, f64::max)
    }

    /// How far the plain run moves when it is run in another way.
    fn moves_by(&self, ways: Ways, skip: &dyn Fn(&str) -> bool) -> f64 {
        let record = self.run(&ways);
        if record.ended == self.record.ended { compare(&self.record, &record, skip).share } else { f64::INFINITY }
    }

    /// The same problem written in another way has the same answer.
    fn same(&self, ways: Ways, tolerance: f64, skip: &dyn Fn(&str) -> bool) -> Outcome {
        if !self.has_ended_well() {
            return Outcome::Idle;
        }
        let record = self.run(&ways);
        self.as_before(&record, tolerance, skip)
    }

    fn as_before(&self, record: &Record, tolerance: f64, skip: &dyn Fn(&str) -> bool) -> Outcome {
        if ended(&record.ended) != ended(&self.record.ended) {
            // What Newton's method does where it does not converge hangs on round-off, and so does whether a shorter increment is found.
            if record.given_up > 0 && self.record.given_up > 0 {
                return Outcome::Idle;
            }
            let place = format!("ended {:?}, and was {:?}", record.ended, self.record.ended);
            return self.judged(Difference { share: f64::INFINITY, place, values: [0.0; 2] }, skip);
        }
        // How long the next increment is hangs on whole numbers: the iterations of the one before, whether one was rejected, the foot
        // that stands for a point. Where round-off changes one of them (some 1 in 1000 models), the increments are others.
        let is_dt = |column: &str| column != "dt";
        if record.increments != self.record.increments || compare(&self.record, record, &is_dt).share > SAME_UNTIL {
            return Outcome::Idle;
        }
        let difference = compare(&self.record, record, skip);
        let tolerance = if moves(self.draft) { tolerance.max(SAME_IN_MOTION) } else { tolerance };
        let tolerance = if is_explicit(self.draft) { tolerance.max(SAME_EXPLICIT) } else { tolerance };
        let augmented = self.draft.is("normal", "augmented") || self.draft.has("stick");
        let tolerance = if augmented { tolerance.max(SAME_AUGMENTED) } else { tolerance };
        // The lengths of increments follow from estimates, and rates are differences over them.
        let tolerance = if self.draft.has("error_control") { tolerance.max(SAME_IN_MOTION) } else { tolerance };
        let tolerance = if self.draft.has("until") { tolerance.max(SAME_UNTIL) } else { tolerance };
        if difference.share <= tolerance { Outcome::Holds } else { self.judged(difference, skip) }
    }

    /// A difference that round-off can make is none, nor is a small one that the tolerance of Newton's method makes.
    fn judged(&self, difference: Difference, skip: &dyn Fn(&str) -> bool) -> Outcome {
        let by_tolerance =
            || LOOSER * self.moves_by(Ways { looser: LOOSER, ..self.ways.clone() }, skip).min(SAME_BY_TOLERANCE);
        if difference.share <= AMPLIFIED * self.sensitivity(skip) || difference.share <= by_tolerance() {
            Outcome::Idle
        } else {
            Outcome::Broken(difference)
        }
    }

    fn has_ended_well(&self) -> bool {
        self.record.ended == Ended::Complete
    }
}

/// How it ended, without numbers.
fn ended(of: &Ended) -> u8 {
    match of {
        Ended::Complete => 0,
        Ended::Stopped(_) => 1,
        Ended::Refused(_) => 2,
    }
}

/// So many runs with numbers that differ in the 12th digit tell what round-off can do.
const NOISES: u64 = 12;

/// A relation may miss by so many times what a change in the 12th digit of its numbers does: far from the origin positions are rounded in
/// the tenth.
const AMPLIFIED: f64 = 1000.0;

/// What the tolerance of Newton's method does is seen at one so many times as large.
const LOOSER: f64 = 10.0;

/// At most so much of a difference is put down to it, before the factor.
const SAME_BY_TOLERANCE: f64 = 1e-6;

/// What is the same is the same to this share: a hundred times what Newton's method leaves.
const SAME: f64 = 1e-8;

/// In motion to this one: points that close and open in turn add up round-off from increment to increment.
const SAME_IN_MOTION: f64 = 1e-7;

/// Explicit increments are a hundred times as many, and surfaces that just touch are closed or open in one of them by round-off: what
/// slips meanwhile is remembered.
const SAME_EXPLICIT: f64 = 1e-5;

/// The augmented Lagrangian ends at the penetration that is asked for, 1e-9: α_n times that, 2e4 · 1e-9, of pressures near 6.
const SAME_AUGMENTED: f64 = 4e-6;

/// Newton's method ends when every body balances: two bodies may balance at another iteration than one, which a law that has a kink
/// approaches slowly.
const SAME_BY_BODY: f64 = 1e-6;

/// A step that ends with a reaction ends where that is met to 1e-6: its length is as uncertain, and rates are ten times as much.
const SAME_UNTIL: f64 = 1e-5;

pub const RELATIONS: &[Relation] = &[
    Relation { name: "resumed", rarity: 5, check: resumed },
    Relation { name: "dropped", rarity: 5, check: dropped },
    Relation { name: "threads", rarity: 5, check: threads },
    Relation { name: "begun with", rarity: 5, check: begun_with },
    Relation { name: "bystander", rarity: 3, check: bystander },
    Relation { name: "flight", rarity: 3, check: flight },
    Relation { name: "moved", rarity: 5, check: moved },
    Relation { name: "turned by 37", rarity: 5, check: turned },
    Relation { name: "turned by 90", rarity: 5, check: turned_square },
    Relation { name: "mirrored", rarity: 5, check: mirrored },
    Relation { name: "units", rarity: 5, check: units },
    Relation { name: "inclined", rarity: 4, check: inclined },
    Relation { name: "renamed", rarity: 5, check: renamed },
    Relation { name: "shuffled", rarity: 5, check: shuffled },
    Relation { name: "driven", rarity: 5, check: driven },
    Relation { name: "told in time", rarity: 5, check: told_in_time },
    Relation { name: "steps in two", rarity: 3, check: steps_in_two },
    Relation { name: "later", rarity: 4, check: later },
    Relation { name: "body in two", rarity: 5, check: body_in_two },
    Relation { name: "energies", rarity: 3, check: energies },
    Relation { name: "switched", rarity: 2, check: switched },
    Relation { name: "dilating", rarity: 1, check: dilating },
    Relation { name: "resultants", rarity: 1, check: resultants },
    Relation { name: "small and finite", rarity: 12, check: small_and_finite },
    Relation { name: "slow dynamics", rarity: 12, check: slow_dynamics },
    Relation { name: "stiff and augmented", rarity: 12, check: stiff_and_augmented },
    Relation { name: "sides swapped", rarity: 12, check: sides_swapped },
];

const NOTHING: &dyn Fn(&str) -> bool = &|_| false;

fn to_the_bit(base: &Base, record: &Record) -> Outcome {
    if !base.has_ended_well() {
        return Outcome::Idle;
    }
    let text = |record: &Record| {
        record.tables.iter().map(|table| table.lines().map(str::to_owned).collect::<Vec<_>>()).collect::<Vec<_>>()
    };
    if record.ended != base.record.ended {
        let place = format!("ended {:?}, and was {:?}", record.ended, base.record.ended);
        return Outcome::Broken(Difference { share: f64::INFINITY, place, values: [0.0; 2] });
    }
    let (was, is) = (text(&base.record), text(record));
    if std::env::var_os("SHOW").is_some() {
        for (a, b) in was.iter().zip(&is) {
            for (x, y) in a.iter().zip(b) {
                if x != y {
                    println!("A {x}\nB {y}");
                }
            }
        }
    }
    if was == is {
        return Outcome::Holds;
    }
    let cells = was.iter().zip(&is).flat_map(|(was, is)| {
        let columns = || was[0].split(',');
        let rows = was.iter().zip(is);
        rows.flat_map(move |(was, is)| columns().zip(was.split(',').zip(is.split(','))).map(move |cells| (was, cells)))
    });
    let place = cells.filter(|(_, (_, (was, is)))| was != is).map(|(row, (column, (was, is)))| {
        let start: Vec<&str> = row.split(',').take(4).collect();
        format!("{column} of {}…: {was} and {is}", start.join(","))
    });
    let place = place.into_iter().next().unwrap_or_else(|| "rows".into());
    let difference = compare(&base.record, record, NOTHING);
    Outcome::Broken(Difference { place: format!("{place}; {}", difference.place), ..difference })
}

fn resumed(base: &Base) -> Outcome {
    to_the_bit(base, &run(&model::case(base.draft, &base.ways), &base.ways, Lead::Resumed))
}

fn dropped(base: &Base) -> Outcome {
    to_the_bit(base, &run(&model::case(base.draft, &base.ways), &base.ways, Lead::Dropped))
}

fn threads(base: &Base) -> Outcome {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("threads");
    to_the_bit(base, &pool.install(|| base.run(&base.ways)))
}

/// The steps after the first as a case that begins with the first.
fn begun_with(base: &Base) -> Outcome {
    // The default penalty, or method, of the first step is another one where a later one has inertia, or is explicit; the command
    // refuses to go on there.
    let by_default = base.draft.is("normal", "default") || base.draft.is("method", "chosen");
    let other = ["then", "rupture"].iter().any(|slot| base.draft.has(slot)) || base.draft.is("scheme", "quasi_dynamic");
    if !base.has_ended_well() || base.draft.has("times") || by_default && other {
        return Outcome::Idle;
    }
    let record = run(&model::case(base.draft, &base.ways), &base.ways, Lead::Begun);
    if is_judged_by_energies(&record.ended) {
        return Outcome::Idle;
    }
    // It counts its own energies; the turns of bodies begin anew as well.
    let counted = |column: &str| {
        let totals = [
            "friction_dissipation",
            "damping_dissipation",
            "plastic_dissipation",
            "external_work",
            "energy_error",
            "radiated",
        ];
        totals.contains(&column) || column.ends_with("frictional_heat")
    };
    base.as_before(&record, SAME, &counted)
}

/// Whether a run ended as one whose motion gained more energy than was supplied in it, and to all of its bodies.
fn is_judged_by_energies(ended: &Ended) -> bool {
    matches!(ended, Ended::Stopped(why) if why.contains("energy balance violated"))
}

/// Something that touches nothing.
fn bystander(base: &Base) -> Outcome {
    // The error of an increment is that of all bodies.
    if base.draft.has("plate") && base.draft.is("press", "plate") || base.draft.has("error_control") {
        return Outcome::Idle;
    }
    let energies = |column: &str| !column.contains('.') && column != "dt" && column != "time" || is_aside(column);
    let record = base.run(&Ways { bystander: true, flight: true, ..base.ways.clone() });
    // When Newton's method gives up hangs on the norm of all forces, and the judgement at the end on the energies of all bodies.
    if record.increments != base.record.increments || is_judged_by_energies(&record.ended) {
        return Outcome::Idle;
    }
    if !base.has_ended_well() { Outcome::Idle } else { base.as_before(&record, SAME, &energies) }
}

/// A free body flies on with the momentum that its springs have left it.
fn flight(base: &Base) -> Outcome {
    let draft = base.draft;
    if !is_dynamic(draft.of("scheme"))
        || draft.has("then")
        || draft.of("section").starts_with("rings")
        || draft.has("rupture")
        || !base.has_ended_well()
    {
        return Outcome::Idle;
    }
    let record = base.run(&Ways { bystander: true, flight: true, ..base.ways.clone() });
    if record.ended != Ended::Complete {
        return Outcome::Idle;
    }
    let name = format!("{}.momentum_x", model::ASIDE[1]);
    let momentum =
        |row: &[Entry]| row.iter().find(|entry| *entry.column == *name).map_or(f64::NAN, |entry| entry.value);
    let free: Vec<f64> = record
        .rows
        .iter()
        .filter(|(time, _)| *time >= model::duration(draft) * (1.0 - 1e-9))
        .map(|(_, row)| momentum(row))
        .collect();
    let most = record.rows.iter().map(|(_, row)| momentum(row).abs()).fold(0.0, f64::max);
    let spread =
        free.iter().copied().fold(f64::NEG_INFINITY, f64::max) - free.iter().copied().fold(f64::INFINITY, f64::min);
    if spread <= SAME * most {
        Outcome::Holds
    } else {
        Outcome::Broken(Difference { share: spread / most, place: name, values: [free[0], free[free.len() - 1]] })
    }
}

/// A random field is one of the place: elsewhere it is another one.
fn has_a_place(draft: &Draft) -> bool {
    draft.is("varying", "random")
}

/// Far from the origin; rings along their axis alone.
fn moved(base: &Base) -> Outcome {
    if has_a_place(base.draft) {
        return Outcome::Idle;
    }
    let far = f64::from(1 << 20);
    let by = if base.draft.of("section").starts_with("rings") { [0.0, far] } else { [far, -0.25 * far] };
    base.same(Ways { frame: base.ways.frame.clone().moved(by), ..base.ways.clone() }, SAME, NOTHING)
}

fn turns(draft: &Draft) -> bool {
    !draft.of("section").starts_with("rings") && !draft.is("stress", "geostatic") && !has_a_place(draft)
}

fn turned(base: &Base) -> Outcome {
    // The error of an increment is that of the component of a displacement, and plates move alike along an axis.
    if !turns(base.draft) || base.draft.is("plate", "alike") || base.draft.has("error_control") {
        return Outcome::Idle;
    }
    let record = base.run(&Ways { frame: base.ways.frame.clone().turned(37.0), ..base.ways.clone() });
    // Bodies on inclined supports are not condensed: on the way to a time of output their increments are not those of the ladder.
    if !base.has_ended_well() || base.draft.has("times") && record.increments != base.record.increments {
        return Outcome::Idle;
    }
    base.as_before(&record, SAME, NOTHING)
}

fn turned_square(base: &Base) -> Outcome {
    if !turns(base.draft) {
        return Outcome::Idle;
    }
    base.same(Ways { frame: base.ways.frame.clone().turned(90.0), ..base.ways.clone() }, SAME, NOTHING)
}

fn faces_nodes(draft: &Draft) -> bool {
    draft.is("surfaces", "matching") && draft.is("method", "node_to_segment")
}

fn mirrored(base: &Base) -> Outcome {
    let axis = usize::from(base.draft.of("section").starts_with("rings"));
    if base.draft.is("stress", "geostatic") && axis == 1 || has_a_place(base.draft) {
        return Outcome::Idle;
    }
    // A node that faces a node is projected on the edge before it or the one after; in a mirror on the other, which is not quite
    // straight on with it.
    if faces_nodes(base.draft) && is_explicit(base.draft) {
        return Outcome::Idle;
    }
    base.same(Ways { frame: base.ways.frame.clone().mirrored(axis), ..base.ways.clone() }, SAME, NOTHING)
}

/// Units that are powers of two apart: no digit may change, so that chatter has no excuse.
fn units(base: &Base) -> Outcome {
    let [length, stress, time] = [[10, 0, 0], [0, 20, 0], [0, 0, -10], [-7, 20, 5], [-10, -20, 12]]
        [(hash(base.draft.seed, "units") % 5) as usize]
        .map(|power| 2f64.powi(power));
    base.same(Ways { frame: base.ways.frame.clone().units(length, stress, time), ..base.ways.clone() }, SAME, NOTHING)
}

/// Supports along axes written as inclined ones.
fn inclined(base: &Base) -> Outcome {
    if base.draft.is("section", "rings_on_end")
        || base.draft.is("section", "rings_around")
        || base.draft.is("scheme", "quasi_dynamic")
        || base.draft.has("plate")
        || base.draft.is("press", "plate")
    {
        return Outcome::Idle;
    }
    let mut frame = base.ways.frame.clone();
    frame.inclined = true;
    base.same(Ways { frame, ..base.ways.clone() }, SAME, NOTHING)
}

fn renamed(base: &Base) -> Outcome {
    base.same(Ways { renamed: true, ..base.ways.clone() }, SAME, NOTHING)
}

fn shuffled(base: &Base) -> Outcome {
    // A node that faces a node is projected on the edge before it or the one after, whichever comes first.
    if faces_nodes(base.draft) && is_explicit(base.draft) {
        return Outcome::Idle;
    }
    base.same(Ways { shuffled: true, ..base.ways.clone() }, SAME, NOTHING)
}

/// A motion or load written as a number, a rate, a table or an expression.
fn driven(base: &Base) -> Outcome {
    if base.draft.has("until") || base.draft.is("scheme", "quasi_dynamic") || base.draft.is("press", "rotation") {
        return Outcome::Idle;
    }
    let ways = ["number", "rate", "table", "expression"];
    let drawn = ways[(hash(base.draft.seed, "driven") % 4) as usize];
    base.same(Ways { drive: Some(drawn), ..base.ways.clone() }, SAME, NOTHING)
}

/// Friction whose numbers are expressions of the time that stay the same, but were others at the very start.
fn told_in_time(base: &Base) -> Outcome {
    let draft = base.draft;
    if draft.is("friction", "frictionless") || draft.is("friction", "prescribed") || !base.has_ended_well() {
        return Outcome::Idle;
    }
    let record = base.run(&Ways { told_in_time: true, ..base.ways.clone() });
    // How long increments are in which points close hangs on the law, too.
    if record.ended == Ended::Complete && record.given_up != base.record.given_up {
        let same = |noise| base.run(&Ways { noise: Some(noise), ..base.ways.clone() }).given_up == base.record.given_up;
        let place = format!("{} attempts given up, and {} were", record.given_up, base.record.given_up);
        let broken = Outcome::Broken(Difference { share: f64::INFINITY, place, values: [0.0; 2] });
        return if (1..=NOISES).all(same) { broken } else { Outcome::Idle };
    }
    base.as_before(&record, SAME, NOTHING)
}

/// Whether dashpots of the bodies hold the block until contact does; what they hold depends on the bodies and on the step.
fn is_stabilized(base: &Base) -> bool {
    model::case(base.draft, &base.ways).to_string().contains("stabilize")
}

/// Every step in two, where increments are as long as they are said to be.
fn steps_in_two(base: &Base) -> Outcome {
    let draft = base.draft;
    let idle = is_stabilized(base)
        || !base.record.is_even(model::duration(draft))
        || draft.has("until")
        || draft.has("error_control")
        || draft.has("shrink_fit")
        || draft.is("press", "rotation")
        || draft.is("scheme", "quasi_dynamic")
        || draft.has("rupture")
        || draft.has("plate");
    if idle {
        return Outcome::Idle;
    }
    let record = base.run(&Ways { halves: true, ..base.ways.clone() });
    // A step begins with no motion to go on with: Newton's method may fail there where it does not within a step.
    if !base.has_ended_well() || record.ended == Ended::Complete && !record.is_even(model::duration(draft)) {
        return Outcome::Idle;
    }
    base.as_before(&record, SAME, NOTHING)
}

/// What acts or moves from the start, or says by itself when something happens.
const SUDDEN: [&str; 13] = [
    "stress",
    "pores",
    "tractions",
    "heat",
    "fluid",
    "velocity",
    "shrink_fit",
    "until",
    "rupture",
    "error_control",
    "press",
    "spring",
    "further_parameters",
];

/// Everything later, after a step in which nothing happens: what varies in time varies as much later.
fn later(base: &Base) -> Outcome {
    let Some(draft) = base.draft.plainer(&SUDDEN) else { return Outcome::Idle };
    // The state of these laws lives from the start of the run: θ ages, and μ begins with the μ_s of then.
    let varies = draft.is("varying", "in_time") && draft.pick("which varies", &[0.0, 1.0]) == 1.0;
    let lives = draft.is("friction", "rate_and_state") || draft.is("friction", "super_subloading") && varies;
    if lives || draft.is("friction", "prescribed") || draft.is("scheme", "quasi_dynamic") {
        return Outcome::Idle;
    }
    let base = Base::new(&draft);
    if !base.has_ended_well() {
        return Outcome::Idle;
    }
    let mut record = base.run(&base.ways.clone().later(LATER, &draft));
    // The step before takes one increment, explicit ones as many as there is room for.
    let explicit = record.increments.saturating_sub(base.record.increments);
    record.increments -= if draft.is("scheme", "explicit") { explicit } else { 1.min(record.increments) };
    if record.given_up > 0 && base.record.given_up == 0 {
        let place = format!("{} attempts given up, and none was", record.given_up);
        return base.judged(Difference { share: f64::INFINITY, place, values: [0.0; 2] }, NOTHING);
    }
    base.as_before(&record, SAME, NOTHING)
}

/// So many lengths of a stage.
const LATER: f64 = 2.0;

/// The block as two bodies that share the nodes between them.
fn body_in_two(base: &Base) -> Outcome {
    if is_stabilized(base) || base.draft.is("tractions", "of_bodies") {
        return Outcome::Idle;
    }
    // Stresses and strains are recovered body by body, each from its own elements.
    let recovered =
        |column: &str| column.starts_with("in_block.") && (column.contains("stress") || column.contains("strain"));
    let of_block = |column: &str| column.starts_with("block.") || column.starts_with("half.") || recovered(column);
    base.same(Ways { block_in_two: true, ..base.ways.clone() }, SAME_BY_BODY, &of_block)
}

/// Energies balance, or the error of their balance falls with the increments at their order. What does not fall is less than what the
/// contacts store: friction acts across the gap of the penalty without a couple, tractions go by the length of now, and points
/// come and go (`src/equations/evaluation.rs`).
fn energies(base: &Base) -> Outcome {
    let draft = base.draft;
    // Implicit schemes damp what increments do not resolve, or create energy where contact chatters; the stress of F-bar has no
    // potential.
    let f_bar = ["ground_element", "block_element"].iter().any(|slot| draft.is(slot, "f_bar"));
    if f_bar || draft.has("then") || moves(draft) && !draft.is("scheme", "explicit") {
        return Outcome::Idle;
    }
    // What is out of balance at the beginning of a static step springs to equilibrium, and nothing says what it does on its way.
    let springs =
        !moves(draft) && (draft.has("stress") || draft.has("pores") || draft.has("tractions") || draft.has("spring"));
    if !base.has_ended_well() || draft.has("error_control") || draft.has("until") || springs {
        return Outcome::Idle;
    }
    // Dilatancy holds the surfaces apart, and friction acts across that gap without a couple; an augmented Lagrangian stores nothing that
    // would bound it.
    if draft.has("dilatancy") && draft.is("normal", "augmented") {
        return Outcome::Idle;
    }
    // A temperature that jumps where a step begins strains a body that yields along a way that no increment resolves.
    if moves(draft) && draft.is("heat", "by_place") {
        return Outcome::Idle;
    }
    // A point that slides off the end of its master takes its force along, at once.
    let lengths: Vec<f64> = base.record.values("c.contact_length").collect();
    if !moves(draft) && lengths.windows(2).any(|pair| pair[1] < 0.95 * pair[0]) {
        return Outcome::Idle;
    }
    // A support that starts at a velocity strikes what it holds, and loses ½ m v² by it.
    let drive = if moves(draft) { Some("smooth") } else { base.ways.drive };
    let audited = |finer| {
        let record = base.run(&Ways { finer, drive, ..base.ways.clone() });
        // A fluid acts on open points too, and where they strike its force and theirs change at once.
        (record.ended == Ended::Complete).then(|| unexplained(&record, moves(draft) && !draft.has("fluid")))
    };
    let Some(coarse) = audited(1.0) else { return Outcome::Idle };
    if coarse.share <= BALANCED {
        return Outcome::Holds;
    }
    let (Some(fine), Some(finest)) = (audited(2.0), audited(4.0)) else { return Outcome::Idle };
    // Multipliers store nothing. In finite sliding the gap that they close in the mean along an edge of the mesh is not closed between:
    // what pressures do there falls with the mesh.
    let by_the_mesh = draft.is("normal", "augmented") && !draft.is("sliding", "small");
    let falls = |finer: &Difference| {
        by_the_mesh && finer.share <= BY_THE_MESH
            || finer.share <= BALANCED
            || finer.share <= 0.6 * fine.share
            || finer.share <= 0.6 * coarse.share
    };
    // A body that only dashpots hold turns far in its first increments: the order of the error shows in much shorter ones.
    if falls(&finest) || audited(64.0).is_some_and(|least| falls(&least)) {
        Outcome::Holds
    } else {
        Outcome::Broken(Difference {
            place: format!("{}; {:.2e} {:.2e} {:.2e}", finest.place, coarse.share, fine.share, finest.share),
            ..finest
        })
    }
}

/// Where one scheme follows another in motion no energy comes or goes but what the error of an increment explains: the error that the
/// first increment of the new scheme adds falls with its length.
fn switched(base: &Base) -> Outcome {
    // What sets in at once shakes at frequencies that implicit increments do not resolve, but damp; friction acts across the gap of
    // dilatancy without a couple, all the while.
    let Some(draft) = base.draft.plainer(&SUDDEN).and_then(|draft| draft.plainer(&["dilatancy"])) else {
        return Outcome::Idle;
    };
    let f_bar = ["ground_element", "block_element"].iter().any(|slot| draft.is(slot, "f_bar"));
    // Statics stops what moves; rings on end are not held along their radius, where a load sets in.
    let idle = !draft.has("then")
        || draft.is("then", "static")
        || draft.is("scheme", "static")
        || draft.is("section", "rings_on_end")
        || f_bar;
    if idle {
        return Outcome::Idle;
    }
    // Multipliers on a surface that has mass gain energy from impacts, the more the shorter the increments.
    if draft.is("normal", "augmented") && !draft.has("massless") {
        return Outcome::Idle;
    }
    let stage = model::duration(&draft);
    let plain = Ways::plain(&draft);
    let error_of = |row: &[Entry]| row.iter().find(|entry| &*entry.column == "energy_error").map(|entry| entry.value);
    let added = |finer| {
        let ways = Ways { finer, drive: Some("through"), ..plain.clone() };
        let mut case = model::case(&draft, &ways);
        // Rows as close as they come by themselves.
        case["output"]["interval"] = serde_json::Value::Null;
        let record = run(&case, &ways, Lead::Through);
        let errors: Vec<(f64, f64)> =
            record.rows.iter().filter_map(|(time, row)| Some((*time, error_of(row)?))).collect();
        let change = errors.iter().position(|&(time, _)| time > stage * (1.0 + 1e-9))?;
        let &[(then, before), (first, after), (second, further)] = errors.get(change.checked_sub(1)?..change + 2)?
        else {
            return None;
        };
        // Tractions that go by the length of now add to the error all the while, and contact that chatters now and then: what comes at
        // the change is beyond that.
        let steady = after - before - (further - after) * (first - then) / (second - first);
        let others =
            [errors.get(change.saturating_sub(4)..change)?, errors.get(change..(change + 4).min(errors.len()))?];
        let rates = others
            .iter()
            .flat_map(|errors| errors.windows(2))
            .map(|pair| (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0));
        let usual = rates.map(f64::abs).fold(0.0, f64::max) * (first - then);
        let is_usual = (after - before).abs() <= usual;
        (record.ended == Ended::Complete).then(|| (steady, steady.abs() / audit(&record).values[1], is_usual))
    };
    let [Some(coarse), Some(fine), Some(finest)] = [1.0, 2.0, 4.0].map(added) else { return Outcome::Idle };
    let falls = |(_, share, is_usual): (f64, f64, bool)| {
        is_usual || share <= SWITCHED || share <= 0.6 * fine.1 || share <= 0.6 * coarse.1
    };
    // Contact that chatters just then does so for less in much shorter increments.
    if falls(finest) || added(16.0).is_some_and(falls) {
        return Outcome::Holds;
    }
    let shares = [coarse, fine, finest].map(|(_, share, _)| format!("{share:.2e}")).join(" ");
    let place = format!("energy_error that the change of schemes adds; {shares}");
    Outcome::Broken(Difference { share: finest.1, place, values: [coarse.0, finest.0] })
}

/// Energies that a change of schemes may add, as a share of the largest: ten times what balances.
const SWITCHED: f64 = 1e-6;

/// Dilatancy does not keep surfaces apart: what closes without it closes with it.
fn dilating(base: &Base) -> Outcome {
    let Some(plainer) = base.draft.with("dilatancy", "no").filter(|_| base.draft.has("dilatancy")) else {
        return Outcome::Idle;
    };
    // A law that jumps at a threshold of the pressure may leave no equilibrium at it, nor may the traction η v of radiation, which does
    // not vanish with the pressure: closed, it slows the slip below what lifts the surfaces into contact, and open, it does not.
    if moves(base.draft) || base.draft.is("friction", "registered") || base.draft.has("radiation") {
        return Outcome::Idle;
    }
    let Ended::Stopped(why) = &base.record.ended else { return Outcome::Holds };
    // A body whose material fails on the way is no contact that does not close, nor is one that is augmented too slowly.
    if why.contains(": element ") || why.contains("augmentations") {
        return Outcome::Idle;
    }
    let without = Base::new(&plainer);
    if !base.record.closed && without.record.closed && without.has_ended_well() {
        let place = format!("ended {why}, and closes without dilatancy");
        Outcome::Broken(Difference { share: f64::INFINITY, place, values: [0.0; 2] })
    } else {
        Outcome::Idle
    }
}

/// Share of the largest energy that gaps within an edge account for on meshes of a few elements.
const BY_THE_MESH: f64 = 1e-2;

/// Energies that balance to this share of the largest are exact.
const BALANCED: f64 = 1e-7;

/// The largest error of the energies as a share of the largest of them.
fn audit(record: &Record) -> Difference {
    largest_error(record, |_, _, _| true)
}

/// That of the errors that are larger than what the contacts store: in the first row of motion until then, for what is wrong at the start
/// is not theirs.
fn unexplained(record: &Record, in_motion: bool) -> Difference {
    let most = record.values("contact_elastic").fold(0.0, f64::max);
    largest_error(record, |error, stored, first| error.abs() > if in_motion && first { stored } else { most })
}

/// The largest error of the energies that counts, by what the contacts have stored until then and whether its row is the first.
fn largest_error(record: &Record, counts: impl Fn(f64, f64, bool) -> bool) -> Difference {
    let entries = || record.rows.iter().flat_map(|(time, row)| row.iter().map(move |entry| (time, entry)));
    let is_energy =
        |entry: &Entry| entry.kind == Kind::Energy && &*entry.column != "energy_error" && !entry.column.contains('.');
    let most = entries().filter(|(_, entry)| is_energy(entry)).map(|(_, entry)| entry.value.abs()).fold(0.0, f64::max);
    let of = |row: &[Entry], name: &str| row.iter().find(|entry| &*entry.column == name).map(|entry| entry.value);
    let mut stored = 0.0f64;
    let errors = record.rows.iter().enumerate().filter_map(|(k, (time, row))| {
        stored = stored.max(of(row, "contact_elastic")?);
        let error = of(row, "energy_error")?;
        counts(error, stored, k == 0).then_some((time, error))
    });
    let error = errors.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    let Some((time, error)) = error.filter(|_| most > 0.0) else { return Difference::default() };
    Difference { share: error.abs() / most, place: format!("energy_error at t = {time}"), values: [error, most] }
}

/// What the contact says it puts on its slave is p and q summed up along it.
fn resultants(base: &Base) -> Outcome {
    let draft = base.draft;
    // Along a straight surface that does not turn.
    if !base.has_ended_well()
        || draft.of("section").starts_with("rings")
        || draft.is("master", "itself")
        || draft.is("master", "circle")
    {
        return Outcome::Idle;
    }
    let mut worst = Difference::default();
    for (time, row) in &base.record.rows {
        let of = |name: &str| row.iter().find(|entry| &*entry.column == name).map_or(f64::NAN, |entry| entry.value);
        let [normal, tangential, x, y] =
            ["normal_force", "tangential_force", "force_x", "force_y"].map(|name| of(&format!("c.{name}")).abs());
        let whole = normal.hypot(tangential);
        // A block that is not held may turn, where one hits the ground again and again that is bent by half a right angle, and a block
        // sinks into clay askew.
        let straight = draft.is("press", "displacement")
            && !moves(draft)
            && !draft.is("ground_law", "cam_clay")
            && !draft.is("ground_law", "sys_cam_clay");
        let compared = match straight {
            true => vec![("along", [tangential, x]), ("across", [normal, y])],
            false => vec![("as a whole", [whole, x.hypot(y)])],
        };
        for (name, [told, put]) in compared {
            let share = (told - put).abs() / whole.max(1e-9);
            if share > worst.share && whole > 1e-6 {
                worst = Difference { share, place: format!("c.force, {name}, at t = {time}"), values: [told, put] };
            }
        }
    }
    // Points of a bent surface have directions of their own.
    let bent = if moves(draft) { 0.25 } else { 0.1 };
    if worst.share <= bent { Outcome::Holds } else { Outcome::Broken(worst) }
}

/// A difference that falls at least at its order when something becomes smaller by four.
fn falls(draft: &Draft, pair: &dyn Fn(f64) -> [Ways; 2], order: f64, skip: &dyn Fn(&str) -> bool) -> Outcome {
    let mut shares = Vec::new();
    let mut place = String::new();
    for factor in [1.0, 0.25, 0.0625] {
        let records = pair(factor).map(|ways| run(&model::case(draft, &ways), &ways, Lead::Through));
        if records.iter().any(|record| record.ended != Ended::Complete || record.rows.is_empty()) {
            return Outcome::Idle;
        }
        // In other increments friction has another history.
        if records[0].increments != records[1].increments {
            return Outcome::Idle;
        }
        let difference = compare(&records[0], &records[1], skip);
        shares.push(difference.share);
        place = difference.place;
    }
    let falls = shares[2] <= 1e-7
        || shares[2] <= 2.0 * shares[0] * 0.0625f64.powf(order)
        || shares[2] <= 2.0 * shares[1] * 0.25f64.powf(order);
    if falls {
        Outcome::Holds
    } else {
        Outcome::Broken(Difference {
            share: shares[2],
            place: format!("{place}; {shares:?}"),
            values: [shares[0], shares[1]],
        })
    }
}

/// Linear quantities: forces and stresses.
fn not_of_forces(column: &str) -> bool {
    !["normal_force", "tangential_force", "fx", "fx, y"].iter().any(|part| column.ends_with(part))
        || column.starts_with("d.")
}

/// The draft with nothing that keeps another order or does not scale: what is left of it is a static contact of two bodies.
fn simple(draft: &Draft) -> Option<Draft> {
    let without = [
        "scheme",
        "then",
        "approach",
        "flange",
        "tool",
        "error_control",
        "rupture",
        "until",
        "varying",
        "dilatancy",
        "wear",
        "fluid",
        "radiation",
        "shrink_fit",
        "massless",
        "tractions",
        "stress",
        "pores",
        "heat",
        "plate",
        "spring",
        "dashpot",
        "velocity",
        "second_contact",
        "gravity",
        "damping",
        "absorbing",
        "point_mass",
        "further_parameters",
        "press",
        "friction",
        "master",
        "smooth",
        "normal",
    ];
    let slots: Vec<&str> =
        without.into_iter().filter(|slot| *slot != "friction" || !draft.is("friction", "frictionless")).collect();
    let plainer = draft.plainer(&slots)?;
    let elastic = ["linear", "neo_hookean", "saint_venant_kirchhoff", "hencky"];
    let remembers = ["ground_law", "block_law"].iter().any(|slot| !elastic.contains(&plainer.of(slot)));
    let apart = model::starts_apart(&plainer) || plainer.of("section").starts_with("rings");
    (!remembers && !apart).then_some(plainer)
}

/// Small sliding is finite sliding of small loads, a fluid between the surfaces being one of them.
fn small_and_finite(base: &Base) -> Outcome {
    let with_fluid = |plainer: Draft| plainer.with("fluid", base.draft.of("fluid"));
    let Some(draft) = simple(base.draft).and_then(with_fluid) else { return Outcome::Idle };
    let plain = Ways::plain(&draft);
    let ways = |sliding, load| Ways { sliding: Some(sliding), load, ..plain.clone() };
    falls(&draft, &|load| [ways("small", load), ways("finite", load)], 1.0, &not_of_forces)
}

/// Statics is dynamics without mass.
fn slow_dynamics(base: &Base) -> Outcome {
    let Some(draft) = simple(base.draft) else { return Outcome::Idle };
    let plain = Ways::plain(&draft);
    let ways = |scheme, density| Ways { scheme: Some(scheme), density, ..plain.clone() };
    falls(&draft, &|density| [ways("static", density), ways("generalized_alpha", density)], 1.0, &not_of_forces)
}

/// An augmented Lagrangian is a penalty without give, along the normal.
fn stiff_and_augmented(base: &Base) -> Outcome {
    let Some(draft) = simple(base.draft) else { return Outcome::Idle };
    // The pressures of an edge's Gauss points part as the penalty rises, by modes that it holds last.
    if draft.is("method", "gauss_to_segment") {
        return Outcome::Idle;
    }
    let plain = Ways::plain(&draft);
    let ways = |normal, stiffer| Ways { normal: Some(normal), stiffer, ..plain.clone() };
    let tangential = |column: &str| not_of_forces(column) || !column.ends_with("normal_force");
    // Points at the edge of the contact come and go with the give.
    falls(&draft, &|give| [ways("alpha_n", 1.0 / give), ways("augmented", 1.0)], 0.5, &tangential)
}

/// Of two sides that are alike, either is the slave.
fn sides_swapped(base: &Base) -> Outcome {
    let Some(draft) = simple(base.draft) else { return Outcome::Idle };
    let quadratic = |slot: &str| is_quadratic(draft.of(slot));
    // The nodes at the end of the longer side stand for more than the shorter one covers.
    if draft.is("method", "node_to_segment")
        || !draft.is("surfaces", "matching")
        || quadratic("ground_element") != quadratic("block_element")
    {
        return Outcome::Idle;
    }
    let plain = Ways::plain(&draft);
    let ways = |swapped, load| Ways { swapped, load, ..plain.clone() };
    // How much slip counts where a point closes anew hangs on the depth of the elements behind the slave.
    let record = run(&model::case(&draft, &plain), &plain, Lead::Through);
    let lengths: Vec<f64> = record.values("c.contact_length").filter(|length| *length > 0.0).collect();
    if lengths.windows(2).any(|pair| pair[1] > 1.01 * pair[0]) {
        return Outcome::Idle;
    }
    let on_slave = |column: &str| not_of_forces(column) || column.starts_with("c.tangential");
    falls(&draft, &|load| [ways(false, load), ways(true, load)], 1.0, &on_slave)
}
