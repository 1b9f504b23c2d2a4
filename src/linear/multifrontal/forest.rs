//! Subtrees of fronts that are shared out among threads.

use std::ops::Range;

use super::front::Front;

/// Neighbouring subtrees.
pub struct Forest {
    pub fronts: Range<usize>,
    /// The roots of the subtrees, ascending
    pub roots: Vec<u32>,
    /// The most values that contributions inside hold at a time
    pub room: usize,
}

/// Share of the whole work below which subtrees are lumped together. Fixed, so that the sums do not depend on threads.
const FOREST_SHARE: f64 = 1.0 / 32.0;

/// Whole subtrees, neighbours lumped up to a share of the work, from the first front to the last.
pub fn forests(fronts: &[Front]) -> Vec<Forest> {
    let (first, work) = subtrees(fronts);
    let limit = FOREST_SHARE * fronts.iter().map(Front::work).sum::<f64>();
    let mut forests: Vec<Forest> = Vec::new();
    let mut lumped = 0.0;
    let mut end = fronts.len();
    while end > 0 {
        let root = end - 1;
        if work[root] > limit {
            end = root;
            continue;
        }
        match forests.last_mut() {
            Some(forest) if forest.fronts.start == end && lumped + work[root] <= limit => {
                forest.fronts.start = first[root];
                forest.roots.push(root as u32);
                lumped += work[root];
            }
            _ => {
                forests.push(Forest { fronts: first[root]..end, roots: vec![root as u32], room: 0 });
                lumped = work[root];
            }
        }
        end = first[root];
    }
    forests.reverse();
    for forest in &mut forests {
        forest.roots.reverse();
        forest.room = room(&fronts[forest.fronts.clone()], fronts);
    }
    forests
}

/// The most values that the contributions of consecutive fronts hold at a time.
fn room(forest: &[Front], fronts: &[Front]) -> usize {
    let (mut held, mut peak) = (0, 0);
    for front in forest {
        held += front.below().pow(2);
        peak = peak.max(held);
        held -= front.children.iter().map(|&child| fronts[child as usize].below().pow(2)).sum::<usize>();
    }
    peak
}

/// First front of each subtree and the work of it all.
fn subtrees(fronts: &[Front]) -> (Vec<usize>, Vec<f64>) {
    let mut first: Vec<usize> = Vec::with_capacity(fronts.len());
    let mut work: Vec<f64> = Vec::with_capacity(fronts.len());
    for (f, front) in fronts.iter().enumerate() {
        first.push(front.children.first().map_or(f, |&child| first[child as usize]));
        work.push(front.work() + front.children.iter().map(|&child| work[child as usize]).sum::<f64>());
    }
    (first, work)
}
