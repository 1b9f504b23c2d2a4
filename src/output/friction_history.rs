//! Summary of the friction history of a contact: its forces, and the onset of slip.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::model::text::number;

/// Relative round-off allowed in comparing fractions.
const ROUND_OFF: f64 = 1e-9;

/// The forces of a contact at one time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrictionForce {
    /// time [T]
    pub time: f64,
    /// ∫ q ds of all points, as in `history.csv` [F]
    pub tangential_force: f64,
    /// its magnitude over ∫ p ds [-]
    pub ratio: f64,
}

/// Summary of the friction history of a contact over the accepted increments.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FrictionHistory {
    /// time at which a point first slipped [T]
    pub first_slip: Option<f64>,
    /// time at which all closed points first slipped simultaneously [T]
    pub full_slip: Option<f64>,
    /// force with the largest tangential magnitude
    pub largest: Option<FrictionForce>,
    /// force at the end
    pub last: Option<FrictionForce>,
}

impl FrictionHistory {
    /// Records the forces [F] and the slipping fraction of the closed length [-].
    pub fn note(&mut self, time: f64, normal: f64, tangential: f64, slipping: f64) {
        let ratio = if normal > 0.0 { tangential.abs() / normal } else { 0.0 };
        let force = FrictionForce { time, tangential_force: tangential, ratio };
        self.last = Some(force);
        // A constant force keeps its first time.
        let more = |largest: FrictionForce| tangential.abs() > (1.0 + ROUND_OFF) * largest.tangential_force.abs();
        if self.largest.is_none_or(more) {
            self.largest = Some(force);
        }
        if slipping > 0.0 {
            self.first_slip.get_or_insert(time);
        }
        if slipping > 1.0 - ROUND_OFF {
            self.full_slip.get_or_insert(time);
        }
    }

    /// Whether any friction occurred.
    pub fn is_friction(&self) -> bool {
        self.largest.is_some_and(|largest| largest.tangential_force != 0.0)
    }
}

impl fmt::Display for FrictionHistory {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match (self.first_slip, self.full_slip) {
            (None, _) => write!(f, "sticks")?,
            (Some(first), None) => write!(f, "partial slip from t = {}", number(first))?,
            (Some(first), Some(all)) if first == all => write!(f, "full sliding from t = {}", number(first))?,
            (Some(first), Some(all)) => {
                write!(f, "partial slip from t = {}, full sliding from t = {}", number(first), number(all))?
            }
        }
        if let [Some(largest), Some(last)] = [self.largest, self.last] {
            let line = |force: FrictionForce| {
                format!("{} ({:.4} of the normal force)", number(force.tangential_force), force.ratio)
            };
            write!(
                f,
                "; peak tangential force {} at t = {}, {} at the end",
                line(largest),
                number(largest.time),
                line(last)
            )?;
        }
        Ok(())
    }
}
