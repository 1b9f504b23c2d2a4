//! A draft: the features that a seed gives, and its numbers.

use super::*;

/// A model to be made: a value for every slot, and the seed of its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Draft {
    pub seed: u64,
    chosen: BTreeMap<&'static str, &'static str>,
}

impl Draft {
    /// What a seed says; of every other a pair that is rare otherwise.
    pub fn new(seed: u64) -> Self {
        let rare = if hash(seed, "rare").is_multiple_of(2) { rare() } else { &[] };
        let pair = rare.get((hash(seed, "pair") % rare.len().max(1) as u64) as usize);
        let with_pair = pair.and_then(|pair| Self::drawn(seed, pair));
        with_pair.or_else(|| Self::drawn(seed, &[])).unwrap_or_else(|| panic!("seed {seed} has no model"))
    }

    /// A draft that has some features; nothing where others, drawn on the way, leave no value of a slot.
    pub fn drawn(seed: u64, first: &[Feature]) -> Option<Self> {
        let mut draft = Self { seed, chosen: BTreeMap::new() };
        if !first.iter().all(|feature| draft.take(*feature)) {
            return None;
        }
        let mut order: Vec<usize> = (0..SLOTS.len()).collect();
        for k in (1..order.len()).rev() {
            order.swap(k, (hash(seed, &format!("order {k}")) % (k as u64 + 1)) as usize);
        }
        // The scheme asks most of the others; an option gives way to all.
        order.sort_by_key(|&k| (SLOTS[k].0 != "scheme", SLOTS[k].1[0].0 == "no"));
        for (slot, values) in order.into_iter().map(|k| SLOTS[k]) {
            if draft.chosen.contains_key(slot) {
                continue;
            }
            let all: u64 = values.iter().map(|(_, weight)| weight).sum();
            let mut left = hash(seed, slot) % all;
            let drawn = values.iter().find(|(_, weight)| {
                let found = left < *weight;
                left = left.saturating_sub(*weight);
                found
            });
            let drawn = drawn.map_or(values[0].0, |(value, _)| value);
            // Where the plain value does not go with what has been chosen either: the first that does.
            let mut rest = values.iter().map(|(value, _)| *value);
            if !draft.take((slot, drawn)) && !rest.any(|value| draft.take((slot, value))) {
                return None;
            }
        }
        Some(draft)
    }

    /// Take a feature and what it needs, if they go with what has been chosen.
    fn take(&mut self, feature: Feature) -> bool {
        let mut new = vec![feature];
        for (_, needs) in NEEDED.iter().filter(|(needing, _)| names(needing, feature)) {
            new.extend(needs.iter().copied());
        }
        let fits = |(slot, value): &Feature| self.chosen.get(slot).is_none_or(|chosen| chosen == value);
        let meets = |one: &Feature| {
            self.chosen.iter().chain(new.iter().map(|(s, v)| (s, v))).all(|(s, v)| excluded(*one, (*s, *v)).is_none())
        };
        let possible = new.iter().all(|one| fits(one) && meets(one));
        if possible {
            self.chosen.extend(new);
        }
        possible
    }

    /// The value of a slot.
    pub fn of(&self, slot: &str) -> &'static str {
        self.chosen.get(slot).unwrap_or_else(|| panic!("no slot {slot}"))
    }

    /// Whether a slot has a value.
    pub fn is(&self, slot: &str, value: &str) -> bool {
        debug_assert!(
            SLOTS.iter().any(|(name, values)| *name == slot && values.iter().any(|(v, _)| *v == value)),
            "{slot}:{value}"
        );
        self.of(slot) == value
    }

    /// Whether an option is taken.
    pub fn has(&self, slot: &str) -> bool {
        self.of(slot) != plain(slot)
    }

    /// All its features, without those that options lack.
    pub fn features(&self) -> Vec<Feature> {
        self.chosen.iter().map(|(slot, value)| (*slot, *value)).filter(|(_, value)| *value != "no").collect()
    }

    /// The same with another value of a slot; nothing if it does not go with the others.
    pub fn with(&self, slot: &'static str, value: &'static str) -> Option<Self> {
        let mut chosen = self.chosen.clone();
        chosen.insert(slot, value);
        Self { seed: self.seed, chosen }.allowed()
    }

    /// The same with the plain values of some slots; nothing if they do not go with the others.
    pub fn plainer(&self, slots: &[&'static str]) -> Option<Self> {
        let mut chosen = self.chosen.clone();
        chosen.extend(slots.iter().map(|slot| (*slot, plain(slot))));
        Self { seed: self.seed, chosen }.allowed()
    }

    /// A draft by what [`Self::told`] says of it; features that are not named are the plain ones.
    pub fn of_told(seed: u64, told: &str) -> Option<Self> {
        let mut chosen: BTreeMap<_, _> = SLOTS.iter().map(|(slot, _)| (*slot, plain(slot))).collect();
        for feature in told.split_whitespace() {
            let all = SLOTS.iter().flat_map(|(slot, values)| values.iter().map(move |(value, _)| (*slot, *value)));
            let (slot, value) = all.into_iter().find(|(slot, value)| feature == format!("{slot}:{value}"))?;
            chosen.insert(slot, value);
        }
        Self { seed, chosen }.allowed()
    }

    /// Itself, if its features go with each other.
    fn allowed(self) -> Option<Self> {
        let all: Vec<Feature> = self.chosen.iter().map(|(slot, value)| (*slot, *value)).collect();
        let allowed = all.iter().enumerate().all(|(k, a)| all[..k].iter().all(|b| excluded(*a, *b).is_none()));
        allowed.then_some(self)
    }

    /// The features that differ from the plain ones.
    pub fn told(&self) -> String {
        let told = self.chosen.iter().filter(|(slot, value)| **value != plain(slot));
        told.map(|(slot, value)| format!("{slot}:{value}")).collect::<Vec<_>>().join(" ")
    }

    /// One of some numbers, by name.
    pub fn pick(&self, name: &str, among: &[f64]) -> f64 {
        among[(hash(self.seed, name) % among.len() as u64) as usize]
    }

    /// A whole number from `low` to `high`, by name.
    pub fn count(&self, name: &str, low: usize, high: usize) -> usize {
        low + (hash(self.seed, name) % (high - low + 1) as u64) as usize
    }
}

/// An even distribution over all 64-bit numbers (splitmix64 over the bytes of the name).
pub fn hash(seed: u64, name: &str) -> u64 {
    let mix = |x: u64| {
        let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    };
    let next = |state: u64, byte: u8| mix(state.wrapping_add(0x9e37_79b9_7f4a_7c15) ^ u64::from(byte));
    name.bytes().fold(mix(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(1)), next)
}
