//! Motions that something resists.

use nalgebra::DVector;

/// Share of an equation below which it says nothing that others do not.
const NOTHING_NEW: f64 = 1e-5;

/// The motions that equations resist: vectors of unit length, at right angles to each other.
#[derive(Clone)]
pub struct Resisted {
    size: usize,
    basis: Vec<DVector<f64>>,
}

impl Resisted {
    /// Nothing of motions of so many numbers.
    pub fn nothing(size: usize) -> Self {
        Self { size, basis: Vec::new() }
    }

    /// What of a vector is at right angles to all that is resisted.
    fn rest(&self, mut of: DVector<f64>) -> DVector<f64> {
        // Twice, as the first time leaves round-off.
        for known in self.basis.iter().chain(&self.basis) {
            let along = known.dot(&of);
            of.axpy(-along, known, 1.0);
        }
        of
    }

    /// One more equation, a row of terms of a size.
    pub fn add(&mut self, row: DVector<f64>, size: f64) {
        if self.basis.len() == self.size {
            return;
        }
        let rest = self.rest(row);
        let norm = rest.norm();
        if norm > NOTHING_NEW * size {
            self.basis.push(rest / norm);
        }
    }

    /// A motion that nothing resists: as much as can be of one number.
    pub fn free(&self) -> Option<DVector<f64>> {
        if self.basis.len() == self.size {
            return None;
        }
        let rest = |k: usize| {
            let mut unit = DVector::zeros(self.size);
            unit[k] = 1.0;
            self.rest(unit)
        };
        let longer = |a: DVector<f64>, b: DVector<f64>| if b.norm() > a.norm() { b } else { a };
        (0..self.size).map(rest).reduce(longer)
    }
}
