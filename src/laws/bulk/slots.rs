//! Places of named variables among those that a law remembers, so that no law counts how many stand before its own.

use std::ops::Range;

use super::MaterialDescription;

/// N variables of a law, one behind the other.
///
/// ```
/// use fecontact::laws::bulk::Slot;
///
/// const STRAIN: Slot<4> = Slot::FIRST;
/// const HARDENING: Slot<1> = Slot::after(STRAIN);
///
/// let mut variables = [0.0; HARDENING.end()];
/// HARDENING.set(&mut variables, 2.0);
/// assert_eq!((HARDENING.value(&variables), STRAIN.of(&variables)), (2.0, &[0.0; 4]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slot<const N: usize> {
    first: usize,
}

impl<const N: usize> Slot<N> {
    /// The first variables of a law.
    pub const FIRST: Self = Self { first: 0 };

    /// The variables behind others.
    pub const fn after<const M: usize>(other: Slot<M>) -> Self {
        Self { first: other.end() }
    }

    /// Returns the number of variables up to its end.
    pub const fn end(self) -> usize {
        self.first + N
    }

    /// Its values.
    #[inline(always)]
    pub fn of(self, variables: &[f64]) -> &[f64; N] {
        variables[self.first..].first_chunk().expect("a law has as many variables as it names")
    }

    /// Its values, to be written.
    #[inline(always)]
    pub fn of_mut(self, variables: &mut [f64]) -> &mut [f64; N] {
        variables[self.first..].first_chunk_mut().expect("a law has as many variables as it names")
    }

    /// What stands behind it.
    #[inline(always)]
    pub fn behind(self, variables: &[f64]) -> &[f64] {
        &variables[self.end()..]
    }

    /// What stands behind it, to be written.
    #[inline(always)]
    pub fn behind_mut(self, variables: &mut [f64]) -> &mut [f64] {
        &mut variables[self.end()..]
    }
}

impl Slot<1> {
    /// Its value.
    #[inline(always)]
    pub fn value(self, variables: &[f64]) -> f64 {
        self.of(variables)[0]
    }

    /// Write its value.
    #[inline(always)]
    pub fn set(self, variables: &mut [f64], value: f64) {
        self.of_mut(variables)[0] = value;
    }
}

/// Names of the variables of a law whose parts are known when it is made.
#[derive(Debug, Default)]
pub(super) struct Names {
    pub names: Vec<&'static str>,
}

impl Names {
    /// Append the names of a slot.
    pub fn slot<const N: usize>(&mut self, names: [&'static str; N]) -> Slot<N> {
        Slot { first: self.all(&names).start }
    }

    /// Append any number of names; returns their places.
    pub fn all(&mut self, names: &[&'static str]) -> Range<usize> {
        let first = self.names.len();
        self.names.extend(names);
        first..self.names.len()
    }
}

impl MaterialDescription<'_> {
    /// The variables of these names, which stand one behind the other, if the law has them.
    pub fn slot<const N: usize>(&self, names: &[&str; N]) -> Option<Slot<N>> {
        let first = self.variables.windows(N).position(|some| some == names)?;
        Some(Slot { first })
    }
}
