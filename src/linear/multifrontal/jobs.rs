//! What can be done at the same time: forests of light fronts, and chains of heavy ones above them.

use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use rayon::prelude::*;

use super::forest::Forest;
use super::front::Front;
use super::symbolic::Symbolic;

/// A chain of heavy fronts and all that lies below it; `P` is what each forest or heavy front owns of the data.
pub struct Job<'a, P> {
    /// Independent of each other
    below: Vec<Job<'a, P>>,
    forests: Vec<(&'a Forest, P)>,
    /// Each front the only heavy child of the next
    chain: Vec<(u32, P)>,
}

impl<'a, P: Send> Job<'a, P> {
    /// The whole tree. `part` is called with the forests and heavy fronts in the order of elimination.
    pub fn new(symbolic: &'a Symbolic, mut part: impl FnMut(&[Front]) -> P) -> Self {
        let mut jobs: HashMap<u32, Self> = HashMap::new();
        let mut forests = Vec::new();
        let mut next = 0;
        let ends = symbolic.forests.iter().map(Some).chain([None]);
        for forest in ends {
            let end = forest.map_or(symbolic.fronts.len(), |forest| forest.fronts.start);
            for number in next..end {
                let front = &symbolic.fronts[number];
                let mut below: Vec<Self> = front.children.iter().filter_map(|child| jobs.remove(child)).collect();
                let mut job = match below.len() {
                    1 => below.remove(0),
                    _ => Self { below, forests: Vec::new(), chain: Vec::new() },
                };
                job.forests.append(&mut forests);
                job.chain.push((number as u32, part(std::slice::from_ref(front))));
                jobs.insert(number as u32, job);
            }
            if let Some(forest) = forest {
                forests.push((forest, part(&symbolic.fronts[forest.fronts.clone()])));
                next = forest.fronts.end;
            }
        }
        Self { below: jobs.into_values().collect(), forests, chain: Vec::new() }
    }

    /// Children before parents.
    pub fn upwards(self, light: &(impl Fn(&Forest, P) + Sync), heavy: &(impl Fn(u32, P) + Sync)) {
        let Self { below, forests, chain } = self;
        Self::at_once(below, forests, &|job| job.upwards(light, heavy), light);
        chain.into_iter().for_each(|(front, part)| heavy(front, part));
    }

    /// Parents before children.
    pub fn downwards(self, light: &(impl Fn(&Forest, P) + Sync), heavy: &(impl Fn(u32, P) + Sync)) {
        let Self { below, forests, chain } = self;
        chain.into_iter().rev().for_each(|(front, part)| heavy(front, part));
        Self::at_once(below, forests, &|job| job.downwards(light, heavy), light);
    }

    /// All that does not depend on each other. What is alone is done without the wait for another thread to wake up.
    fn at_once(
        below: Vec<Self>,
        forests: Vec<(&'a Forest, P)>,
        go: &(impl Fn(Self) + Sync),
        light: &(impl Fn(&Forest, P) + Sync),
    ) {
        if below.len() + forests.len() <= 1 {
            below.into_iter().for_each(go);
            return forests.into_iter().for_each(|(forest, part)| light(forest, part));
        }
        rayon::join(
            || below.into_par_iter().with_max_len(1).for_each(go),
            || forests.into_par_iter().with_max_len(1).for_each(|(forest, part)| light(forest, part)),
        );
    }
}

/// What fronts have made for each other, by the number of the front below.
#[derive(Default)]
pub struct Waiting(Mutex<HashMap<u32, Vec<f64>>>);

impl Waiting {
    pub fn put(&self, front: u32, values: Vec<f64>) {
        lock(&self.0).insert(front, values);
    }

    pub fn into_inner(self) -> HashMap<u32, Vec<f64>> {
        self.0.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn take(&self, front: u32) -> Vec<f64> {
        lock(&self.0).remove(&front).unwrap_or_default()
    }
}

/// The lock itself: what it guards is whole even if another thread has panicked.
pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
