//! Scatter of tractions from point to point along a slave surface, which the mesh has made and not the problem.
//!
//! ```text
//! r_i = p_i − (line through the neighbours of i)                     inner points: i and three points on either side are in contact
//! scatter of p = 1/p̄ · √(Σ m_i²/n),   m_i = min(|r_i|, |r_i+1|) where r_i r_i+1 < 0, otherwise 0
//! ```
//! over the n inner points, with their mean pressure p̄; that of q by p̄ as well, m_i being the least of three residuals that alternate: where slip
//! reverses, q has a step, of which two do. Towards the end of a contact the elastic pressure is
//! steep, at the corner of a block singular, which no mesh resolves over its last points. What alternates most opens every other point: these
//! are in contact with p = 0. A smooth pressure has residuals of one sign, or small
//! ones where its curvature changes; a kink or the edge of a contact has a single large one. What alternates counts twice its amplitude.

use super::force::ContactState;
use super::point::SlavePoint;
use super::surface::CORNER;
use crate::mesh::configuration::Configuration;

/// Number of points on either side of an inner one.
const ADJACENT: usize = 3;

/// The points of a slave surface in their order along it.
#[derive(Clone, Debug)]
pub struct PointSequence {
    /// Distance of each point to the next one; `None` at ends and corners of the surface [L]
    next: Vec<Option<f64>>,
}

impl PointSequence {
    /// The sequence of points that are listed in the order of their surface, in a configuration.
    pub fn new(points: &[SlavePoint], x: &Configuration) -> Self {
        let nodes = |point: &SlavePoint| -> Vec<usize> {
            point.length.iter().flat_map(|share| &share.tangent).map(|&(node, _)| node).collect()
        };
        let goes_on = |pair: &[SlavePoint]| {
            let own = nodes(&pair[0]);
            let joined = nodes(&pair[1]).iter().any(|node| own.contains(node));
            joined && matches!([pair[0].outward(x), pair[1].outward(x)], [Some(a), Some(b)] if a.dot(&b) > CORNER)
        };
        let distance = |pair: &[SlavePoint]| (pair[1].at(x) - pair[0].at(x)).norm();
        let next = points.windows(2).map(|pair| Some(distance(pair)).filter(|&way| goes_on(pair) && way > 0.0));
        Self { next: next.chain([None]).collect() }
    }

    /// Distance of a point to the next one; `None` at an end or a corner of the surface [L]
    pub fn after(&self, point: usize) -> Option<f64> {
        *self.next.get(point)?
    }

    /// The larger of the scatters of p and q [-]
    pub fn scatter(&self, states: &[ContactState]) -> f64 {
        self.alternation(states, ADJACENT, 2).unwrap_or(0.0)
    }

    /// The same over all points between two in contact, of a contact so short that no two neighbours are inner points; `None` on others [-].
    /// The second value has one more residual that alternates in each row: beside a kink two do, of a zigzag all.
    pub fn short_scatter(&self, states: &[ContactState]) -> Option<[f64; 2]> {
        let is_long = self.alternation(states, ADJACENT, 2).is_some();
        let short = |in_a_row: usize| self.alternation(states, 1, in_a_row).filter(|_| !is_long);
        Some([short(2)?, short(3)?])
    }

    /// The larger scatter over the points with so many in contact on either side, with so many residuals of p in a row, and one more of q;
    /// `None` if no two of them are neighbours.
    fn alternation(&self, states: &[ContactState], neighbours: usize, in_a_row: usize) -> Option<f64> {
        let is_closed = |k: usize| states.get(k).is_some_and(ContactState::is_closed);
        let goes_on = |k: usize| self.after(k - 1).is_some() && self.after(k).is_some();
        let is_gap = |k: usize| k > 0 && goes_on(k) && !is_closed(k) && is_closed(k - 1) && is_closed(k + 1);
        let is_skipped = |k: usize| is_gap(k) && (is_gap(k + 2) || k > 2 && is_gap(k - 2));
        let inner = |k: usize| -> Option<[f64; 2]> {
            let first = k.checked_sub(neighbours)?;
            let goes_on = self.next.get(first..k + neighbours)?.iter().all(Option::is_some);
            let in_contact = (first..=k + neighbours).all(|k| is_closed(k) || is_skipped(k));
            Some([self.next[k - 1]?, self.next[k]?]).filter(|_| goes_on && in_contact)
        };
        let ways: Vec<Option<[f64; 2]>> = (0..states.len()).map(inner).collect();
        if !ways.windows(2).any(|pair| pair.iter().all(Option::is_some)) {
            return None;
        }
        let pressures = states.iter().zip(&ways).filter(|(_, ways)| ways.is_some()).map(|(s, _)| s.friction.pressure);
        let (count, sum) = pressures.fold((0.0, 0.0), |(count, sum), pressure| (count + 1.0, sum + pressure));
        let alternates = |traction: &dyn Fn(&ContactState) -> f64, in_a_row: usize| {
            let residual = |k: usize| {
                let [before, after] = ways[k]?;
                let [left, own, right] = [k - 1, k, k + 1].map(|k| traction(&states[k]));
                Some(own - (left * after + right * before) / (before + after))
            };
            let residuals: Vec<Option<f64>> = (0..states.len()).map(residual).collect();
            let least = residuals.windows(in_a_row).filter_map(|row| {
                let least =
                    row.iter().try_fold(f64::INFINITY, |least, residual| Some(least.min((*residual)?.abs())))?;
                let alternate = row.windows(2).all(|pair| matches!(pair, [Some(a), Some(b)] if a * b < 0.0));
                alternate.then_some(least.powi(2))
            });
            least.sum::<f64>()
        };
        let p = alternates(&|state| state.friction.pressure, in_a_row);
        let q = alternates(&ContactState::shear, in_a_row + 1);
        Some(if sum > 0.0 { (p.max(q) / count).sqrt() / (sum / count) } else { 0.0 })
    }
}
