//! Bars in the steps of a model: which are there, and which are stressed by a jack.

use super::state::State;
use super::{Model, Step};
use crate::bars::{Bar, BarState};

/// What a step does with bars.
#[derive(Clone, Debug, Default, PartialEq)]
#[doc(hidden)]
pub struct BarsInStep {
    /// whether each bar is absent; empty if all are there
    pub absent: Vec<bool>,
    /// bars that this step adds or removes
    pub changed: Vec<usize>,
    /// forces to which jacks bring bars over the step, by bar [F]
    pub jacks: Vec<(usize, f64)>,
}

impl BarsInStep {
    /// Whether a bar is there.
    pub fn has(&self, bar: usize) -> bool {
        !self.absent.get(bar).copied().unwrap_or(false)
    }

    /// Force of a jack at a time of the step, on the way from the force at an earlier one [F].
    pub fn jack(&self, bar: usize, before: &BarState, share: f64) -> Option<f64> {
        let (_, target) = self.jacks.iter().find(|(jacked, _)| *jacked == bar)?;
        let force = before.segments.first().map_or(0.0, |segment| segment.force);
        Some(force + (target - force) * share)
    }
}

#[doc(hidden)]
impl Model {
    /// States of the bars at the start of a run.
    pub fn first_bars(&self) -> Vec<BarState> {
        let zero = vec![0.0; self.dofs()];
        let is_there = |bar: usize| self.steps.first().is_none_or(|step| step.bars.has(bar));
        let of = |(k, bar): (usize, &Bar)| if is_there(k) { bar.activated(&zero) } else { bar.absent(&zero) };
        self.bars.iter().enumerate().map(of).collect()
    }

    /// Bars that are there in a step, by number.
    pub fn bars_in<'m>(&'m self, step: &'m Step) -> impl Iterator<Item = (usize, &'m Bar)> {
        self.bars.iter().enumerate().filter(|(k, _)| step.bars.has(*k))
    }

    /// Lets bars come, without forces where they are, and go.
    pub fn change_bars(&self, step: &Step, state: &mut State) {
        for &k in &step.bars.changed {
            let (bar, u) = (&self.bars[k], &state.displacement);
            state.bars[k] = if step.bars.has(k) { bar.activated(u) } else { bar.absent(u) };
        }
    }

    /// Name of a node outside all bodies: the bar that it belongs to, or its tag.
    pub fn lone_name(&self, node: usize) -> String {
        match self.bars.iter().find(|bar| bar.own.binary_search(&node).is_ok()) {
            Some(bar) => format!("the bar `{}`", bar.name),
            None => format!("node {}", self.mesh.node_tags[node]),
        }
    }

    /// Nodes that only absent bars have, ascending.
    pub fn idle_bar_nodes(&self, absent: &[bool]) -> Vec<usize> {
        let of = |is_absent: bool| {
            let all = self.bars.iter().enumerate();
            all.filter(move |(k, _)| absent.get(*k).copied().unwrap_or(false) == is_absent).map(|(_, bar)| bar)
        };
        let mut idle: Vec<usize> = of(true).flat_map(|bar| &bar.own).copied().collect();
        let mut used: Vec<usize> = of(false).flat_map(|bar| bar.nodes()).collect();
        used.sort_unstable();
        idle.retain(|node| used.binary_search(node).is_err());
        idle.sort_unstable();
        idle
    }
}
