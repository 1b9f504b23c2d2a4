//! Bodies that float in a static step.
//!
//! A shared node, a periodic copy, a follower of a plate, a support, a spring and a dashpot are equations between the rigid
//! motions of the parts of a model, a row of numbers each. A motion at right angles to all of them meets no resistance.

use nalgebra::{DVector, Vector2};

use super::super::error::ModelError;
use super::super::load_step::LoadStep;
use super::parts::{Parts, Row};
use super::resisted::Resisted;
use crate::mesh::joined::Joined;
use crate::model::support::Direction;
use crate::model::{Model, Step};

/// Parts of a group whose motions cost nothing; larger groups are left to the solver, which names what is free.
const FEW_PARTS: usize = 32;

/// Motions that are smaller than this share of the largest are not named.
const NAMED: f64 = 0.1;

/// Bodies must be held against x, y and rotation by supports, springs or dashpots in every static step, each by its own or
/// through what couples it with others: contact, shared nodes, periodic sides and plates. Contact holds in every direction, and a
/// single shared node is a hinge. A group that touches a rigid body is left to the solver.
pub fn check_floating(given: &[LoadStep], model: &Model) -> Result<(), ModelError> {
    if model.steps.iter().all(|step| step.scheme.is_dynamic()) {
        return Ok(());
    }
    let parts = Parts::of(model);
    let groups = Groups::of(&parts);
    for (k, step) in model.steps.iter().enumerate().filter(|(_, step)| !step.scheme.is_dynamic()) {
        let Some(free) = groups.free_motion(step) else { continue };
        let held = if given[k].supports.is_empty() && step.supports.is_empty() {
            "there is no support at all"
        } else {
            "the supports do not hold it"
        };
        let message = format!("{free}: {held}; a static step needs supports or springs against every rigid motion");
        return Err(ModelError::new(format!("steps[{k}].supports"), message));
    }
    Ok(())
}

/// Nodes and directions that supports, springs and dashpots hold.
pub fn holding(step: &Step) -> impl Iterator<Item = (usize, Vector2<f64>)> {
    let springs = step.loads.springs.iter().map(|spring| spring.dof);
    let absorbers = step.loads.absorbers.iter().flat_map(|absorber| [2 * absorber.node, 2 * absorber.node + 1]);
    let dofs = springs.chain(step.loads.dashpots.iter().map(|dashpot| dashpot.dof)).chain(absorbers);
    let supports = step.supports.iter().map(|support| support.at);
    supports.chain(dofs.map(Direction::from)).map(|at| (at.node(), at.vector()))
}

/// Groups of parts that are coupled, directly or through others.
struct Groups<'m> {
    parts: &'m Parts<'m>,
    members: Vec<Vec<usize>>,
    /// group of each part and its place there; none of what is left to the solver
    place: Vec<Option<(usize, usize)>>,
    /// motions that couplings resist in each group
    resisted: Vec<Resisted>,
}

impl<'m> Groups<'m> {
    fn of(parts: &'m Parts<'m>) -> Self {
        let couplings = parts.couplings();
        let mut joined = Joined::new(parts.parts.len());
        for row in &couplings {
            row.windows(2).for_each(|two| joined.join(two[0].0, two[1].0));
        }
        let is_checked = |group: &Vec<usize>| {
            let has_bodies = group.iter().any(|&part| !parts.parts[part].bodies.is_empty());
            has_bodies && group.len() <= FEW_PARTS && !group.iter().any(|&part| parts.parts[part].on_rigid)
        };
        let members: Vec<Vec<usize>> = joined.groups().into_iter().filter(is_checked).collect();
        let mut place = vec![None; parts.parts.len()];
        for (g, group) in members.iter().enumerate() {
            group.iter().enumerate().for_each(|(slot, &part)| place[part] = Some((g, slot)));
        }
        let resisted = members.iter().map(|group| Resisted::nothing(3 * group.len())).collect();
        let mut groups = Self { parts, members, place, resisted };
        let mut resisted = std::mem::take(&mut groups.resisted);
        couplings.iter().for_each(|row| groups.add(row, &mut resisted));
        Self { resisted, ..groups }
    }

    /// Let what a row says be resisted.
    fn add(&self, row: &Row, resisted: &mut [Resisted]) {
        let Some((group, _)) = row.first().and_then(|(part, _)| self.place[*part]) else { return };
        let mut sum = DVector::zeros(3 * self.members[group].len());
        for (part, share) in row {
            let Some((_, slot)) = self.place[*part] else { return };
            (0..3).for_each(|i| sum[3 * slot + i] += share[i]);
        }
        // What cancels leaves round-off of the size of its terms.
        let size = row.iter().map(|(_, share)| share.norm_squared()).sum::<f64>().sqrt();
        resisted[group].add(sum, size);
    }

    /// What can move how in a step, in words.
    fn free_motion(&self, step: &Step) -> Option<String> {
        let mut resisted = self.resisted.clone();
        holding(step).for_each(|at| self.add(&self.parts.row(&[at]), &mut resisted));
        let mut motions = resisted.iter().zip(&self.members);
        motions.find_map(|(resisted, group)| Some(self.told(group, &resisted.free()?)))
    }

    fn told(&self, group: &[usize], motion: &DVector<f64>) -> String {
        let moves = |k: usize| motion[k].abs() > NAMED * motion.amax();
        let moving = (0..group.len()).filter(|slot| (0..3).any(|i| moves(3 * slot + i)));
        let names: Vec<String> = moving.flat_map(|slot| self.parts.names(group[slot])).collect();
        let words = ["along x", "along y", "in rotation"];
        let free: Vec<&str> =
            (0..3).filter(|i| (0..group.len()).any(|slot| moves(3 * slot + i))).map(|i| words[i]).collect();
        format!("{} can move freely {}", names.join(" with "), free.join(" with "))
    }
}
