//! What is said of a body by its name.

use std::collections::BTreeMap;

use super::Builder;
use super::error::{Checked, ModelError};
use crate::model::imposed::{InitialStress, Thermal};

impl Builder {
    /// Stress of a body before anything has moved; displacements count from there.
    pub fn initial_stress(mut self, body: impl Into<String>, stress: InitialStress) -> Self {
        self.stresses.push((body.into(), stress));
        self
    }

    /// Thermal expansion of a body, whose temperature the steps give ([`super::LoadStep::temperature`]).
    pub fn thermal(mut self, body: impl Into<String>, thermal: Thermal) -> Self {
        self.thermal.push((body.into(), thermal));
        self
    }

    /// Give the bodies what was said about them elsewhere; returns which of them take F-bar.
    pub(super) fn settled(&mut self) -> Checked<Vec<bool>> {
        let names: Vec<String> = self.bodies.iter().map(|body| body.name.clone()).collect();
        let known: BTreeMap<&String, usize> = names.iter().zip(0..).collect();
        let number = |name: &String| {
            known.get(name).copied().ok_or_else(|| {
                let message = format!("there is no body of this name; the bodies are {}", names.join(", "));
                ModelError::new(format!("bodies.{name}"), message)
            })
        };
        for (name, damping) in &self.damping {
            self.bodies[number(name)?].damping = *damping;
        }
        for name in &self.f_bar {
            self.bodies[number(name)?].f_bar = true;
        }
        for (name, stress) in &self.stresses {
            self.bodies[number(name)?].initial_stress = Some(stress.clone());
        }
        for (name, thermal) in &self.thermal {
            self.bodies[number(name)?].thermal = Some(*thermal);
        }
        Ok(self.bodies.iter().map(|body| body.f_bar).collect())
    }
}
