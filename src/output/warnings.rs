//! Things a user should know about a result: deep penetration, and pressure past the law's uniqueness bound.

use super::{Attempt, Observer};
use crate::error::Error;
use crate::model::Model;

/// Penetration, as a share of the length a contact point stands for, that is worth a warning.
const DEEP: f64 = 0.01;

/// Collects warnings; each kind once a contact, where it is met first.
#[derive(Clone, Debug, Default)]
pub struct Warnings {
    /// the warnings so far
    pub list: Vec<String>,
    deep: Vec<usize>,
    ambiguous: Vec<usize>,
}

impl Observer for Warnings {
    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let Some(state) = attempt.accepted else { return Ok(()) };
        let x = model.positions(&state.displacement);
        for (number, (pair, states)) in model.contacts.iter().zip(&state.contacts).enumerate() {
            let place = |k: usize| {
                let at = pair.points[k].at(&x);
                format!("contact `{}` at ({:.6}, {:.6}), t = {}", pair.name, at.x, at.y, state.time)
            };
            if !self.deep.contains(&number) {
                let depth = |k: &usize| -states[*k].gap / pair.points[*k].current_length(&x);
                if let Some(k) = (0..states.len()).find(|k| states[*k].friction.pressure > 0.0 && depth(k) > DEEP) {
                    self.deep.push(number);
                    let share = 100.0 * depth(&k);
                    self.list.push(format!(
                        "{}: the penetration {:.3e} is {share:.1} % of the length of the contact point; raise alpha_n",
                        place(k),
                        -states[k].gap,
                    ));
                }
            }
            let Some(limit) = pair.law.uniqueness_limit() else { continue };
            if !self.ambiguous.contains(&number) {
                if let Some(k) = (0..states.len()).find(|k| states[*k].friction.pressure > limit) {
                    self.ambiguous.push(number);
                    self.list.push(format!(
                        "{}: the pressure {:.6e} passes {limit:.6e}, above which weakening may outrun the contact \
                         stiffness and the answer snaps; raise alpha_t",
                        place(k),
                        states[k].friction.pressure,
                    ));
                }
            }
        }
        Ok(())
    }
}
