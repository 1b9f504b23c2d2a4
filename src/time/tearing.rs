//! Static increments in which a bond that pulls tears over much of its contact at once.
//!
//! What is torn off everywhere is in equilibrium, too, whatever the loads were: Newton's method may come to that from a state in which it
//! holds, with a residual of zero. Such an increment is not accepted. Shorter ones find the way on which it tears bit by bit, or none.

use crate::laws::friction::Cohesion;
use crate::model::{Model, State, Step};
use crate::solve::failure::IncrementFailure;

/// Share of the length of a contact over which its bond may tear within one increment [-]
const AT_ONCE: f64 = 0.25;

/// What is left of a bond that holds, 1 − κ, before it tears [-]
const HOLDS: f64 = 0.5;

/// Number of points from which on they are not the last ones
const SEVERAL: usize = 3;

/// The failure of a static increment in which the bond of a contact has torn over much of its length; none if it has not.
pub fn torn(model: &Model, step: &Step, old: &State, new: &State) -> Option<IncrementFailure> {
    if step.scheme.is_dynamic() {
        return None;
    }
    let contacts = model.contacts.iter().zip(old.contacts.iter().zip(&new.contacts));
    contacts.filter(|(pair, _)| step.joins(pair)).find_map(|(pair, (before, after))| {
        let (mut whole, mut torn, mut count) = (0.0, 0.0, 0);
        for (slave, (before, after)) in pair.points.iter().zip(before.iter().zip(after)) {
            whole += after.length;
            let (Some(Cohesion::Parallel(bond)), Some(was), Some(is)) =
                (&pair.law(slave).cohesion, &before.bond, &after.bond)
            else {
                continue;
            };
            if bond.tension() > 0.0 && bond.intact(was) > HOLDS && bond.intact(is) == 0.0 && is.opened > was.opened {
                torn += after.length;
                count += 1;
            }
        }
        (count >= SEVERAL && torn > AT_ONCE * whole)
            .then(|| IncrementFailure::Torn { contact: pair.name.clone(), percent: 100.0 * torn / whole })
    })
}
