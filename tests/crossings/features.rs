//! What a model can have, and what goes together: the one list that a new feature has to be entered in.
//!
//! A model is a value for every slot. The first value of a slot is the plain one, which a minimal case goes back to. Which values
//! a seed gives does not depend on the others but by [`EXCLUDED`] and [`NEEDED`], and numbers depend on the seed and their own
//! name alone: taking one feature away changes nothing else.

mod draft;

pub use draft::{Draft, hash};

use std::collections::{BTreeMap, HashMap};
use std::sync::OnceLock;

/// A choice, with how often each value is drawn; the first is the plain one.
pub type Slot = (&'static str, &'static [(&'static str, u64)]);

const LAWS: &[(&str, u64)] = &[
    ("linear", 3),
    ("neo_hookean", 2),
    ("saint_venant_kirchhoff", 1),
    ("hencky", 1),
    ("viscoelastic", 2),
    ("von_mises", 1),
    ("drucker_prager", 1),
    ("mohr_coulomb", 1),
    ("cam_clay", 1),
    ("sys_cam_clay", 1),
];
const ELEMENTS: &[(&str, u64)] = &[("q4", 4), ("f_bar", 2), ("t3", 1), ("t6", 1), ("q8", 1), ("reduced", 1), ("q9", 1)];
const OPTION: &[(&str, u64)] = &[("no", 5), ("yes", 1)];

/// All features.
pub const SLOTS: &[Slot] = &[
    ("section", &[("plane_strain", 4), ("plane_stress", 2), ("rings_on_end", 1), ("rings_around", 1)]),
    ("ground_element", ELEMENTS),
    ("block_element", ELEMENTS),
    ("ground_law", LAWS),
    ("block_law", LAWS),
    ("surfaces", &[("apart", 2), ("matching", 1)]),
    ("master", &[("deformable", 10), ("plane", 2), ("circle", 2), ("polyline", 2), ("outline", 1), ("itself", 2)]),
    ("tool", &[("no", 1), ("moves", 1), ("free", 1)]),
    ("method", &[("gauss_to_segment", 3), ("node_to_segment", 3), ("mortar", 3), ("chosen", 1)]),
    ("gauss_points", &[("2", 3), ("3", 1), ("4", 1)]),
    ("smooth", OPTION),
    ("sliding", &[("finite", 2), ("small", 1)]),
    ("normal", &[("alpha_n", 2), ("default", 2), ("augmented", 1)]),
    (
        "friction",
        &[
            ("coulomb", 2),
            ("adhesion", 1),
            ("super_subloading", 3),
            ("slip_weakening", 2),
            ("rate_and_state", 2),
            ("prescribed", 1),
            ("frictionless", 1),
            ("registered", 1),
        ],
    ),
    ("further_parameters", OPTION),
    ("varying", &[("no", 4), ("by_place", 1), ("in_time", 2), ("by_part", 1), ("random", 1)]),
    ("dilatancy", &[("no", 6), ("free", 1), ("limited", 1), ("structure", 1)]),
    ("wear", OPTION),
    ("interface", &[("no", 14), ("named", 1), ("reduced", 1)]),
    ("bond", &[("no", 14), ("shear", 1), ("softens", 1), ("pulls", 1), ("limited", 1)]),
    ("fluid", &[("no", 6), ("constant", 1), ("in_time", 1), ("by_place", 1), ("of_bodies", 1), ("flows", 1)]),
    ("radiation", &[("no", 6), ("given", 1), ("of_bodies", 1)]),
    ("shrink_fit", OPTION),
    ("massless", OPTION),
    ("stick", OPTION),
    // a body beside the block: part of it, tied to it, or one that comes or goes in the second stage
    ("flange", &[("no", 12), ("yes", 1), ("tied", 2), ("added", 2), ("removed", 2)]),
    // a bar in the block: it moves with it, has bond, is stressed from point to point, or comes in the second stage
    ("bar", &[("no", 12), ("moves", 1), ("bonded", 2), ("tendon", 1), ("late", 1)]),
    // the surfaces are the sides of a crack that ends where they share a node
    ("tip", &[("no", 12), ("yes", 1)]),
    ("tractions", &[("no", 8), ("given", 1), ("balanced", 1), ("of_bodies", 1)]),
    ("stress", &[("no", 5), ("components", 2), ("geostatic", 1)]),
    ("pores", &[("no", 6), ("full", 1), ("cavitating", 1), ("given", 1), ("flow", 2)]),
    // where water that flows leaves the block, or enters it
    ("drainage", &[("no", 12), ("held", 1), ("filter", 1), ("seepage", 1), ("flux", 1)]),
    // what it does between the surfaces
    ("gap", &[("no", 12), ("drained", 1), ("sealed", 1)]),
    ("heat", &[("no", 6), ("number", 1), ("table", 1), ("by_place", 1)]),
    (
        "scheme",
        &[
            ("static", 6),
            ("newmark", 1),
            ("hht", 1),
            ("generalized_alpha", 1),
            ("wilson", 1),
            ("explicit", 1),
            ("quasi_dynamic", 1),
        ],
    ),
    // of the steps after the first
    ("then", &[("no", 8), ("static", 1), ("newmark", 1), ("generalized_alpha", 1), ("explicit", 2)]),
    ("error_control", OPTION),
    ("rupture", OPTION),
    (
        "press",
        &[
            ("displacement", 4),
            ("pressure", 1),
            ("dead_pressure", 1),
            ("traction", 1),
            ("total_force", 1),
            ("force", 1),
            ("plate", 1),
            ("rotation", 1),
        ],
    ),
    ("approach", &[("no", 3), ("slanted", 1)]),
    ("drive", &[("number", 3), ("table", 1), ("expression", 1), ("rate", 1)]),
    ("plate", &[("no", 8), ("rigid", 1), ("alike", 1)]),
    ("gravity", OPTION),
    ("spring", &[("no", 6), ("ground", 1), ("driven", 1), ("ends", 1)]),
    ("dashpot", OPTION),
    ("absorbing", OPTION),
    ("damping", &[("no", 6), ("of_body", 1), ("of_step", 1)]),
    ("periodic", OPTION),
    ("inclined", &[("no", 6), ("normal", 1), ("direction", 1)]),
    ("velocity", &[("no", 6), ("initial", 1), ("launch", 1)]),
    ("point_mass", OPTION),
    ("second_contact", &[("no", 10), ("yes", 1), ("tool", 1)]),
    ("stabilize", OPTION),
    ("near", OPTION),
    ("reversal", OPTION),
    ("until", OPTION),
    ("times", OPTION),
    ("interval", OPTION),
];

/// Features that cannot meet, each of the first with each of the second, and why. `slot:value`, or a slot for all its values but
/// the plain one.
pub const EXCLUDED: &[(&[&str], &[&str], &str)] = &[
    (&["section:plane_stress"], &["ground_element:f_bar", "block_element:f_bar"], "a plate does not lock"),
    (
        &["section:plane_stress"],
        &[
            "ground_law:drucker_prager",
            "block_law:drucker_prager",
            "ground_law:mohr_coulomb",
            "block_law:mohr_coulomb",
            "ground_law:cam_clay",
            "block_law:cam_clay",
            "ground_law:sys_cam_clay",
            "block_law:sys_cam_clay",
            "pores",
        ],
        "soil is no plate",
    ),
    (
        &["ground_law:cam_clay", "block_law:cam_clay", "ground_law:sys_cam_clay", "block_law:sys_cam_clay"],
        &["stress:no", "stress:geostatic", "scheme:quasi_dynamic"],
        "it lives of pressure, near the surface too",
    ),
    (&["pores:flow"], &["scheme:wilson"], "a scheme that looks beyond an increment"),
    (
        &["pores:flow"],
        &["ground_element:f_bar", "block_element:f_bar", "heat", "periodic", "master:itself"],
        "what water that flows through bodies is not for",
    ),
    (&["gap"], &["fluid:constant", "fluid:in_time", "fluid:by_place"], "water of given pressure between the surfaces"),
    (&["pores:cavitating"], &["ground_law:linear", "block_law:linear"], "that is not linear"),
    (&["ground_law:linear"], &["ground_element:f_bar"], "F-bar is for large strains"),
    (&["block_law:linear"], &["block_element:f_bar"], "F-bar is for large strains"),
    (
        &["section:rings_on_end", "section:rings_around"],
        &["press:rotation", "plate:rigid", "inclined", "periodic", "second_contact", "stress:geostatic"],
        "the axis does not turn, and is not left",
    ),
    (&["section:rings_on_end", "section:rings_around"], &["velocity"], "rings do not fly off along their radius"),
    (
        &["section:rings_on_end", "section:rings_around"],
        &["master:circle", "master:polyline", "master:outline", "master:plane"],
        "rigid bodies are drawn for planes",
    ),
    (&["section:rings_around"], &["press:plate"], "the plate would not change its radius"),
    (&["section:rings_on_end"], &["plate:alike"], "the side would keep its radius"),
    (&["section:rings_around"], &["gravity"], "there is no weight along the radius"),
    (&["tool"], &["master:deformable", "master:itself", "scheme:quasi_dynamic"], "a rigid master moves"),
    (&["master:plane", "master:circle", "master:polyline", "master:outline"], GROUND, "there is no second body"),
    (
        &["master:itself"],
        &["smooth", "tractions", "sliding:small", "shrink_fit", "radiation:of_bodies"],
        "a surface lies free of itself at first",
    ),
    (
        &["method:node_to_segment", "method:mortar", "method:chosen"],
        &["gauss_points"],
        "Gauss points are of one method",
    ),
    (
        &["smooth"],
        &[
            "method:mortar",
            "method:chosen",
            "ground_element:t6",
            "ground_element:q8",
            "ground_element:reduced",
            "ground_element:q9",
        ],
        "a spline runs through straight edges",
    ),
    (
        &["scheme:explicit", "then:explicit", "scheme:wilson", "rupture"],
        &["normal:augmented", "stick"],
        "multipliers need equilibrium at the end of an increment",
    ),
    (
        &["friction:frictionless", "friction:prescribed", "friction:registered"],
        &["varying", "further_parameters"],
        "nothing to vary",
    ),
    (&["friction:frictionless", "friction:prescribed"], &["dilatancy", "wear"], "no slip that friction resists"),
    (&["friction:coulomb", "friction:adhesion"], &["further_parameters"], "they have one parameter"),
    (
        &["stick"],
        &[
            "friction:super_subloading",
            "friction:rate_and_state",
            "friction:prescribed",
            "friction:frictionless",
            "friction:registered",
            "varying:by_part",
        ],
        "elastic slip is part of the law, or there is none",
    ),
    (&["friction:prescribed"], DYNAMIC, "slip is prescribed while nothing rings"),
    (
        &["friction:prescribed"],
        &["rupture", "error_control", "shrink_fit", "reversal", "radiation", "press:rotation", "tractions", "fluid"],
        "slip is prescribed",
    ),
    (
        &["friction:rate_and_state"],
        &["scheme:explicit", "then:explicit", "rupture"],
        "increments are far shorter than its creep",
    ),
    (&["friction:adhesion"], &["dilatancy"], "adhesion is nothing beside a high pressure"),
    (
        &["dilatancy:structure"],
        &["friction:coulomb", "friction:slip_weakening", "friction:rate_and_state", "friction:registered"],
        "only super/subloading friction has structure",
    ),
    (
        &["bond"],
        &["friction:adhesion", "friction:prescribed", "friction:registered"],
        "the cohesion of the law itself, or none",
    ),
    (&["bond"], &["master:itself", "shrink_fit"], "surfaces that lie apart or overlap at first"),
    (&["bond:limited"], &["dilatancy", "wear"], "slip at the limit neither opens nor wears"),
    (&["interface"], &["bond", "varying"], "it has both by itself"),
    (&["interface"], &["master:itself", "shrink_fit"], "surfaces that lie apart or overlap at first"),
    (&["dilatancy"], &["interface:reduced"], "its friction is that of the body"),
    (&["dilatancy", "wear"], &["shrink_fit"], "an overlap that wears away while it is brought in"),
    (
        &["massless"],
        &["scheme:static", "scheme:explicit", "scheme:quasi_dynamic", "then:static", "then:explicit", "rupture"],
        "for implicit dynamics",
    ),
    (&["velocity", "absorbing", "damping"], &["scheme:static", "scheme:quasi_dynamic"], "statics has no motion"),
    (&["radiation"], DYNAMIC, "inertia radiates by itself"),
    (
        &["shrink_fit"],
        &[
            "master:circle",
            "tractions",
            "scheme:newmark",
            "scheme:hht",
            "scheme:generalized_alpha",
            "scheme:wilson",
            "scheme:explicit",
            "scheme:quasi_dynamic",
            "until",
        ],
        "an overlap is brought in by a static step",
    ),
    (
        &["tractions:balanced", "tractions:of_bodies"],
        &["stress:no", "stress:geostatic", "section:rings_on_end", "section:rings_around", "heat"],
        "they belong to a stress that goes through the contact",
    ),
    (&["tractions"], &["master:circle"], "an even pressure on a bent surface"),
    (&["stress:components"], &["tractions:given"], "the stress would count twice"),
    (&["heat", "stress", "pores"], &["scheme:quasi_dynamic"], "tractions serve there"),
    (&["pores"], &["tractions"], "the pressure of the pores would be a part of them"),
    (&["fluid:of_bodies"], &["pores:no"], "there is no pressure to take"),
    (
        &["fluid:flows"],
        &["scheme:wilson", "wear", "master:itself", "flange:added", "flange:removed", "shrink_fit"],
        "what water along a contact is not for",
    ),
    (&["fluid:of_bodies"], &["dilatancy", "wear"], "what an interface takes in as it opens is not followed"),
    (
        &["error_control"],
        &["scheme:wilson", "scheme:explicit", "scheme:quasi_dynamic", "rupture"],
        "they have a rule of their own",
    ),
    (
        &["rupture"],
        &[
            "scheme:explicit",
            "scheme:quasi_dynamic",
            "scheme:wilson",
            "until",
            "friction:registered",
            "heat",
            "interval",
        ],
        "implicit steps switch",
    ),
    (
        &["until"],
        &[
            "press:pressure",
            "press:dead_pressure",
            "press:traction",
            "press:total_force",
            "press:force",
            "press:plate",
            "press:rotation",
            "scheme:explicit",
            "scheme:quasi_dynamic",
            "scheme:wilson",
            "heat",
            "times",
            "tractions",
            "gravity",
            "spring:driven",
        ],
        "a reaction grows with a displacement",
    ),
    (&["press:displacement", "press:rotation"], &["plate:rigid"], "supports hold one node of a plate at most"),
    (&["plate"], &["inclined:direction", "press:plate", "second_contact"], "one plate a side"),
    (&["plate:alike"], &["press:rotation"], "what moves alike does not turn"),
    (&["press:rotation"], &["drive"], "a turn is given by a number"),
    (&["press:rotation", "press:plate", "press:force"], DYNAMIC, "sudden forces at few nodes"),
    (
        &["scheme:quasi_dynamic"],
        &[
            "dilatancy",
            "wear",
            "bond:pulls",
            "bond:limited",
            "interface",
            "press:pressure",
            "press:plate",
            "press:rotation",
            "plate",
            "dashpot",
            "normal:augmented",
            "drive:table",
            "drive:expression",
            "master:itself",
            "method:gauss_to_segment",
            "method:chosen",
            "friction:coulomb",
            "friction:adhesion",
            "friction:super_subloading",
            "friction:slip_weakening",
            "friction:frictionless",
            "friction:registered",
            "ground_element:t6",
            "ground_element:q8",
            "ground_element:reduced",
            "ground_element:q9",
            "block_element:t6",
            "block_element:q8",
            "block_element:reduced",
            "block_element:q9",
            "shrink_fit",
            "second_contact",
            "inclined",
            "until",
        ],
        "quasi-dynamic steps are linear but for the interface",
    ),
    (&["periodic"], &["inclined", "absorbing", "master:itself"], "the sides are one"),
    (&["absorbing"], &["inclined:direction"], "one thing a side"),
    (
        &["then"],
        &["scheme:quasi_dynamic", "scheme:wilson", "error_control", "until", "rupture", "radiation"],
        "one change of schemes at a time",
    ),
    (&["then:static"], &["scheme:static"], "no change"),
    (&["then:newmark"], &["scheme:newmark"], "no change"),
    (&["then:generalized_alpha"], &["scheme:generalized_alpha"], "no change"),
    (&["then:explicit"], &["scheme:explicit"], "no change"),
    (
        &["then:static"],
        &[
            "velocity:launch",
            "damping:of_step",
            "press:pressure",
            "press:dead_pressure",
            "press:traction",
            "press:total_force",
            "plate:rigid",
            "friction:prescribed",
        ],
        "what moves as a static step begins is held by its supports",
    ),
    (
        &["flange"],
        &["section:rings_on_end", "section:rings_around", "tractions", "pores", "dashpot", "scheme:quasi_dynamic"],
        "a body beside the block",
    ),
    (&["flange:yes", "flange:tied"], &["stress", "heat"], "a body beside the block that is as it is"),
    (&["flange:added", "flange:removed"], &["stress:geostatic"], "it has a stress of its own"),
    (
        &["flange:added", "flange:removed"],
        &["scheme:wilson", "scheme:explicit", "then", "rupture", "velocity", "until", "press:plate", "plate"],
        "bodies come and go in implicit steps",
    ),
    (
        &["bar"],
        &["section:rings_on_end", "section:rings_around", "scheme:quasi_dynamic"],
        "a bar in rings would be a shell, and quasi-dynamic steps are linear",
    ),
    (&["bar:tendon"], &["until", "scheme:wilson"], "a jack brings its force by the end of the step, and no further"),
    (&["bar:late"], &["scheme:explicit", "then:explicit", "rupture"], "bars come and go in implicit steps"),
    (
        &["tip"],
        &[
            "shrink_fit",
            "tractions",
            "press:rotation",
            "master:itself",
            "friction:prescribed",
            "scheme:quasi_dynamic",
            "section:rings_on_end",
            "second_contact",
            "heat",
            "stress",
        ],
        "a crack whose sides neither pass each other nor lie in each other",
    ),
    (&["second_contact:tool"], &["until"], "its angle is given by a number"),
    (&["stabilize"], DYNAMIC, "dashpots of static steps"),
    (&["stabilize"], &["scheme:quasi_dynamic", "until", "rupture", "then"], "dashpots of static steps"),
    (
        &["approach"],
        &[
            "press:pressure",
            "press:dead_pressure",
            "press:traction",
            "press:total_force",
            "press:force",
            "press:plate",
            "press:rotation",
            "section:rings_on_end",
            "until",
            "friction:prescribed",
            "scheme:quasi_dynamic",
        ],
        "a displacement that has two components",
    ),
    (&["spring:ends"], &["scheme:quasi_dynamic"], "a spring that ends in a step under way"),
];

const DYNAMIC: &[&str] = &[
    "scheme:newmark",
    "scheme:hht",
    "scheme:generalized_alpha",
    "scheme:wilson",
    "scheme:explicit",
    "then:newmark",
    "then:generalized_alpha",
    "then:explicit",
];
const GROUND: &[&str] = &["surfaces", "ground_element", "ground_law", "smooth", "absorbing", "periodic", "inclined"];

/// What a feature brings with it.
pub const NEEDED: &[(&str, &[(&str, &str)])] = &[
    (
        "scheme:quasi_dynamic",
        &[
            ("sliding", "small"),
            ("surfaces", "matching"),
            ("method", "node_to_segment"),
            ("friction", "rate_and_state"),
            ("radiation", "of_bodies"),
            ("ground_law", "linear"),
            ("block_law", "linear"),
            ("ground_element", "q4"),
            ("block_element", "q4"),
        ],
    ),
    ("tractions:balanced", &[("stress", "components")]),
    ("tractions:of_bodies", &[("stress", "components")]),
    ("fluid:of_bodies", &[("pores", "full")]),
    ("drainage", &[("pores", "flow")]),
    ("gap", &[("pores", "flow")]),
    ("gap:drained", &[("fluid", "no")]),
    ("gap:sealed", &[("master", "deformable")]),
    ("interface", &[("friction", "coulomb")]),
    ("interface:reduced", &[("block_law", "mohr_coulomb")]),
    ("tip", &[("surfaces", "matching"), ("master", "deformable")]),
];

/// A feature: a slot and its value.
pub type Feature = (&'static str, &'static str);

/// Every feature but the plain ones of options.
pub fn features() -> Vec<Feature> {
    SLOTS
        .iter()
        .flat_map(|(slot, values)| values.iter().map(move |(value, _)| (*slot, *value)))
        .filter(|(_, value)| *value != "no")
        .collect()
}

/// Whether `word` of a rule names the feature.
pub fn names(word: &str, (slot, value): Feature) -> bool {
    match word.split_once(':') {
        Some((s, v)) => s == slot && v == value,
        None => word == slot && value != plain(slot),
    }
}

/// The plain value of a slot.
pub fn plain(slot: &str) -> &'static str {
    SLOTS.iter().find(|(name, _)| *name == slot).unwrap_or_else(|| panic!("no slot {slot}")).1[0].0
}

/// Why two features cannot meet, if they cannot.
pub fn excluded(a: Feature, b: Feature) -> Option<&'static str> {
    static WHY: OnceLock<HashMap<(Feature, Feature), &'static str>> = OnceLock::new();
    WHY.get_or_init(all_excluded).get(&(a, b)).copied()
}

/// All pairs that cannot meet: by a rule, or because no value of another slot goes with both.
fn all_excluded() -> HashMap<(Feature, Feature), &'static str> {
    let all: Vec<Feature> =
        SLOTS.iter().flat_map(|(slot, values)| values.iter().map(|(value, _)| (*slot, *value))).collect();
    let slots: Vec<&[Feature]> = all.chunk_by(|a, b| a.0 == b.0).collect();
    // By the numbers of the features: nothing is looked up in what is gone through many times.
    let mut why: Vec<Vec<Option<&str>>> = all.iter().map(|a| all.iter().map(|b| why_not(*a, *b)).collect()).collect();
    loop {
        let none = |a: usize, b: usize| {
            let mut values = why[a].iter().zip(&why[b]).map(|(a, b)| a.is_none() && b.is_none());
            slots.iter().any(|slot| values.by_ref().take(slot.len()).filter(|goes| *goes).count() == 0)
        };
        let pairs = (0..all.len()).flat_map(|a| (0..all.len()).map(move |b| (a, b)));
        let further: Vec<(usize, usize)> = pairs.filter(|&(a, b)| why[a][b].is_none() && none(a, b)).collect();
        if further.is_empty() {
            break;
        }
        further.iter().for_each(|&(a, b)| why[a][b] = Some("what one needs does not go with the other"));
    }
    let told = |(a, row): (usize, Vec<Option<&'static str>>)| {
        let all = &all;
        row.into_iter().enumerate().filter_map(move |(b, why)| Some(((all[a], all[b]), why?)))
    };
    why.into_iter().enumerate().flat_map(told).collect()
}

/// What the rules say of two features.
fn why_not(a: Feature, b: Feature) -> Option<&'static str> {
    let rule = |(first, second, why): &(&[&str], &[&str], &'static str)| {
        let has = |words: &[&str], feature| words.iter().any(|word| names(word, feature));
        (has(first, a) && has(second, b) || has(first, b) && has(second, a)).then_some(*why)
    };
    let needed = |(needing, needs): &(&str, &[(&str, &str)])| {
        let other = |one, other: Feature| {
            names(needing, one) && needs.iter().any(|(slot, value)| *slot == other.0 && *value != other.1)
        };
        (other(a, b) || other(b, a)).then_some("another value is needed")
    };
    let alternative = (a.0 == b.0 && a.1 != b.1).then_some("one or the other");
    alternative.or_else(|| EXCLUDED.iter().find_map(rule)).or_else(|| NEEDED.iter().find_map(needed))
}

/// Pairs that plain draws bring together too rarely, each as often as it lacks.
fn rare() -> &'static [[Feature; 2]] {
    const DRAWS: u64 = 4000;
    // Of 20 000, 60: as many as it takes for 20 that are solved, closed and slipping.
    const ENOUGH: usize = 12;
    static RARE: OnceLock<Vec<[Feature; 2]>> = OnceLock::new();
    RARE.get_or_init(|| {
        let mut met: HashMap<[Feature; 2], usize> = HashMap::new();
        for draft in (0..DRAWS).filter_map(|seed| Draft::drawn(seed, &[])) {
            let own = draft.features();
            let pairs = own.iter().enumerate().flat_map(|(k, b)| own[..k].iter().map(move |a| [*a, *b]));
            pairs.for_each(|pair| *met.entry(pair).or_default() += 1);
        }
        let mut all = features();
        all.sort_unstable();
        let pairs = all.iter().enumerate().flat_map(|(k, b)| all[..k].iter().map(move |a| [*a, *b]));
        let lacks = |pair: &[Feature; 2]| ENOUGH.saturating_sub(met.get(pair).copied().unwrap_or_default());
        let can_meet = pairs.filter(|[a, b]| excluded(*a, *b).is_none());
        can_meet.flat_map(|pair| std::iter::repeat_n(pair, lacks(&pair))).collect()
    })
}
