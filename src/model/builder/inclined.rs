//! Supports in force at each node: along the coordinates, and along inclined directions.
//!
//! One inclined direction is a support of its own. Two directions at a node hold both of its components:
//!
//! ```text
//! d₁·u = ū₁,  d₂·u = ū₂    ⇒    u = D⁻¹ ū,  D = [d₁ d₂]ᵀ
//! ```
//!
//! Directions that are nearly the same would hold by their difference what nobody meant to hold, and are refused.

use std::collections::BTreeMap;

use nalgebra::{Matrix2, Vector2};

use super::change::Change;
use super::error::{Checked, ModelError};
use crate::model::Model;
use crate::model::boundary::{Drive, Span};
use crate::model::support::{Direction, Inclined, Motion, Prescribed};
use crate::model::told::number;

/// Sine of an angle between two directions that are the same but for round-off.
const PARALLEL: f64 = 1e-9;

/// Least angle between an inclined direction and another at its node [°].
const LEAST_ANGLE: f64 = 15.0;

/// Two sides that meet at less than this angle are one, bent in pieces, as far as their normals are concerned [°].
pub const CORNER: f64 = 45.0;

/// Share of a value by which a third direction at a node may miss what the other two say.
const ROUNDED: f64 = 1e-9;

/// Supports in force.
#[derive(Clone, Default)]
pub struct InForce {
    /// those of dofs
    pub dofs: BTreeMap<usize, Prescribed>,
    /// those along inclined directions, by node
    inclined: BTreeMap<usize, Vec<Held>>,
}

/// A node that is held along an inclined direction.
#[derive(Clone)]
struct Held {
    support: Inclined,
    is_normal: bool,
    /// where the present step gives it, if it does
    given: Option<String>,
}

/// A support along d at a node, as it is given.
pub struct Along<'s> {
    /// the node
    pub node: usize,
    /// d
    pub d: Vector2<f64>,
    /// its displacement, or the end of it
    pub change: &'s Change<Drive>,
    /// whether d is the normal of a side
    pub is_normal: bool,
    /// where it stands
    pub key: String,
}

impl InForce {
    /// Begin a step with what the one before has left.
    pub fn begin(&mut self, span: Span) {
        for support in self.dofs.values_mut() {
            if let Motion::Displacement(_, own) = &mut support.motion {
                *own = span;
            }
        }
        for held in self.inclined.values_mut().flatten() {
            (held.support.span, held.given) = (span, None);
        }
    }

    /// After a step that may have ended before its time, what it moved to a place stays where it came to.
    pub fn stay(&mut self) {
        let stays = |drive: &mut Drive| {
            if let Drive::Constant(_) | Drive::ByPlace(..) = drive {
                *drive = Drive::Rate(0.0);
            }
        };
        for support in self.dofs.values_mut() {
            if let Motion::Displacement(drive, _) = &mut support.motion {
                stays(drive);
            }
        }
        self.inclined.values_mut().flatten().for_each(|held| stays(&mut held.support.drive));
    }

    /// Prescribe a dof, or free it.
    pub fn set(&mut self, dof: usize, motion: Option<&Motion>) {
        match motion {
            Some(motion) => self.dofs.insert(dof, Prescribed { at: dof.into(), motion: motion.clone() }),
            None => self.dofs.remove(&dof),
        };
    }

    /// All supports of a step, `place`, ascending by their dofs.
    pub fn all(&self, place: &str, model: &Model) -> Checked<Vec<Prescribed>> {
        let mut all = self.dofs.clone();
        for (&node, held) in &self.inclined {
            let given: Vec<Prescribed> = [2 * node, 2 * node + 1].iter().filter_map(|dof| all.remove(dof)).collect();
            let tag = model.mesh.node_tags[node];
            let resolved = resolved(node, given, held)
                .map_err(|message| ModelError::new(format!("{place}.supports"), format!("node {tag} {message}")))?;
            all.extend(resolved.into_iter().map(|support| (support.at.dof, support)));
        }
        Ok(all.into_values().collect())
    }
}

/// Directions in which nodes were held and are free from now on.
pub fn freed(before: &[Prescribed], now: &[Prescribed]) -> Vec<Direction> {
    let find = |all: &[Prescribed], dof: usize| {
        all.binary_search_by_key(&dof, |support| support.at.dof).ok().map(|k| all[k].at)
    };
    let mut freed = Vec::new();
    for first in before.iter().map(|support| support.at.dof & !1).collect::<std::collections::BTreeSet<_>>() {
        let [was, is] = [before, now].map(|all| [find(all, first), find(all, first + 1)]);
        let inclined = |held: [Option<Direction>; 2]| held.into_iter().flatten().find(|at| at.inclined.is_some());
        match (inclined(was), inclined(is)) {
            (was, Some(is)) if was == Some(is) => {}
            (_, Some(is)) => freed.extend(is.across()),
            (Some(_), None) => freed.extend((0..2).filter(|&i| is[i].is_none()).map(|i| Direction::from(first + i))),
            (None, None) => freed.extend((0..2).filter(|&i| is[i].is_none()).filter_map(|i| was[i])),
        }
    }
    freed
}

impl Along<'_> {
    /// Put it into force, or end it. Along a coordinate it is a support of that dof.
    pub fn change(&self, in_force: &mut InForce, span: Span, model: &Model) -> Checked<()> {
        let drive = self.change.given();
        if let Some(i) = (0..2).find(|&i| self.d[1 - i].abs() <= PARALLEL) {
            let motion = drive.map(|drive| {
                let drive = if self.d[i] < 0.0 { drive.reversed() } else { drive.clone() };
                Motion::Displacement(drive, span)
            });
            let dof = 2 * self.node + i;
            if motion.is_none() && !in_force.dofs.contains_key(&dof) {
                return Err(self.nothing_to_free(model));
            }
            in_force.set(dof, motion.as_ref());
            return Ok(());
        }
        let all = in_force.inclined.entry(self.node).or_default();
        let same = all.iter().position(|held| held.support.direction.perp(&self.d).abs() <= PARALLEL);
        let Some(drive) = drive else {
            let Some(same) = same else { return Err(self.nothing_to_free(model)) };
            all.remove(same);
            in_force.inclined.retain(|_, all| !all.is_empty());
            return Ok(());
        };
        let toward = |other: &Vector2<f64>| if other.dot(&self.d) < 0.0 { drive.reversed() } else { drive.clone() };
        let held = |direction, drive| Held {
            support: Inclined { share: 1.0, direction, drive, span },
            is_normal: self.is_normal,
            given: Some(self.key.clone()),
        };
        match same {
            Some(k) => {
                let drive = toward(&all[k].support.direction);
                let other = all[k].given.as_ref().is_some_and(|given| *given != self.key);
                if other && !is_same(&drive, &all[k].support.drive) {
                    let tag = model.mesh.node_tags[self.node];
                    let message = format!(
                        "contradicts what this step gives node {tag} along the same direction: give one of the two"
                    );
                    return Err(ModelError::new(&self.key, message));
                }
                all[k] = held(all[k].support.direction, drive);
            }
            None => all.push(held(self.d, drive.clone())),
        }
        Ok(())
    }

    fn nothing_to_free(&self, model: &Model) -> ModelError {
        let tag = model.mesh.node_tags[self.node];
        ModelError::new(
            &self.key,
            format!(
                "null ends what an earlier step gave, but none gave node {tag} a support along ({}, {}): check place and \
                 direction",
                number(self.d.x),
                number(self.d.y)
            ),
        )
    }
}

fn is_same(a: &Drive, b: &Drive) -> bool {
    match (a, b) {
        (Drive::Constant(a), Drive::Constant(b)) | (Drive::Rate(a), Drive::Rate(b)) => a == b,
        (Drive::Table(a), Drive::Table(b)) => a == b,
        (Drive::ByPlace(a, of_a), Drive::ByPlace(b, of_b)) => a == b && of_a == of_b,
        _ => false,
    }
}

/// The supports of a node that is held along its coordinates as `given` and along some directions; what is wrong otherwise.
fn resolved(node: usize, given: Vec<Prescribed>, held: &[Held]) -> Result<Vec<Prescribed>, String> {
    let mut all: Vec<Inclined> = Vec::new();
    for support in &given {
        let Motion::Displacement(drive, span) = &support.motion else {
            return Err(
                "is turned by a rotation and held along another direction: leave it out of one of the two".into()
            );
        };
        let direction = support.at.vector();
        all.push(Inclined { share: 1.0, direction, drive: drive.clone(), span: *span });
    }
    let straight = all.len();
    all.extend(held.iter().map(|held| held.support.clone()));
    if let [only] = &all[..] {
        let at = Direction::along(node, only.direction);
        return Ok(vec![Prescribed { at, motion: Motion::Inclined(vec![only.clone()]) }]);
    }
    if straight < 2 {
        check_angles(straight, held, &all)?;
    }
    let d = [&all[0], &all[1]].map(|of| of.direction.transpose());
    let inverse = Matrix2::from_rows(&d).try_inverse().ok_or("is held twice along one direction")?;
    for third in &all[2..] {
        check_agrees([&all[0], &all[1], third], inverse)?;
    }
    let component = |i: usize| {
        let part = |k: usize| Inclined { share: inverse[(i, k)], ..all[k].clone() };
        let parts = (0..2).filter(|&k| inverse[(i, k)] != 0.0).map(part).collect();
        Prescribed { at: (2 * node + i).into(), motion: Motion::Inclined(parts) }
    };
    let own = |i: usize| given.iter().find(|support| support.at.dof == 2 * node + i).cloned();
    Ok((0..2).map(|i| own(i).unwrap_or_else(|| component(i))).collect())
}

/// Inclined directions must differ from each other, and from the coordinates that are held, so much that it is meant.
fn check_angles(straight: usize, held: &[Held], all: &[Inclined]) -> Result<(), String> {
    for a in 0..all.len() {
        for b in (a + 1).max(straight)..all.len() {
            let angle = all[a].direction.perp(&all[b].direction).abs().min(1.0).asin().to_degrees();
            let normals = [a, b].iter().all(|k| k.checked_sub(straight).is_some_and(|k| held[k].is_normal));
            let least = if normals { CORNER } else { LEAST_ANGLE };
            if angle < least {
                return Err(format!(
                    "is held along two directions that differ by {} degrees, and cannot move at all: put sides that go on \
                     evenly into one group, leave the node out of one of the two, or give it ux and uy",
                    number(angle)
                ));
            }
        }
    }
    Ok(())
}

/// A third direction may say again what the first two do.
fn check_agrees([first, second, third]: [&Inclined; 3], inverse: Matrix2<f64>) -> Result<(), String> {
    let value = |of: &Inclined| match (&of.drive, &first.drive) {
        (Drive::Constant(value), Drive::Constant(_)) | (Drive::Rate(value), Drive::Rate(_)) => Some(*value),
        _ => None,
    };
    let agrees = [first, second, third].map(value);
    if let [Some(first), Some(second), Some(said)] = agrees {
        let u = inverse * Vector2::new(first, second);
        let size = first.abs().max(second.abs()).max(said.abs());
        if (third.direction.dot(&u) - said).abs() <= ROUNDED * size {
            return Ok(());
        }
    }
    Err("is held along three directions that do not agree: two say where it goes, so leave it out of the third".into())
}
