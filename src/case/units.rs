//! Labels of units: what follows from length, force and time must be labelled so.
//!
//! ```text
//! unit of a quantity = [F]ᵃ [L]ᵇ [T]ᶜ
//! ```
//! In plane strain the slice has the thickness 1 L: a force may be labelled per length of thickness, [F] = label·L, and so may
//! energies, momenta and masses.

use std::collections::BTreeMap;

use super::measure::{Measure, composed, factors};
use crate::mesh::section::Section;
use crate::model::builder::{Checked, ModelError, check_line};
use crate::model::text::number;
use crate::output::quantities::{DENSITY, FORCE, LABELLED, LENGTH, MASS, NONE, STRESS, TIME, Unit};

/// Labels of units by what they are units of.
pub type Labels = BTreeMap<String, String>;

/// What may be labelled though length, force and time make no unit of it.
const FREE: [&str; 2] = ["temperature", NONE.name];

/// Checks the labels of a case.
///
/// # Errors
/// Returns the label that contradicts those of length, force and time, with what it would be.
pub fn check(labels: &Labels, section: Section) -> Checked<()> {
    labels.iter().try_for_each(|(of, label)| check_line(&format!("units.{of}"), label))?;
    let units = Units::of(labels, section);
    units.check_bases()?;
    LABELLED.into_iter().chain([MASS, DENSITY]).try_for_each(|unit| units.check(unit))
}

/// Labels that nothing checks, or nobody sees.
pub fn concerns(labels: &Labels, section: Section) -> Vec<String> {
    let units = Units::of(labels, section);
    let all = || LABELLED.into_iter().chain([MASS, DENSITY]);
    let unchecked = all().filter_map(|unit| units.concern(unit));
    let unseen =
        labels.keys().filter(|of| !FREE.contains(&of.as_str()) && all().all(|unit| unit.name != **of)).map(|of| {
            let names = LABELLED.map(|unit| unit.name).join(", ");
            format!("units.{of} labels nothing in the results; what is labelled there: {names}")
        });
    unchecked.chain(unseen).collect()
}

/// The labels, with those filled in that follow from labels of length, force and time which are products themselves: a force
/// in N/mm on mm makes stresses in N/mm².
pub fn filled(labels: &Labels, section: Section) -> Labels {
    let units = Units::of(labels, section);
    let is_product = |of: Unit| {
        let factors = labels.get(of.name).and_then(|label| factors(label));
        factors.is_some_and(|factors| factors.len() > 1)
    };
    if ![FORCE, LENGTH, TIME].into_iter().any(is_product) {
        return labels.clone();
    }
    let made = LABELLED.into_iter().filter(|unit| !unit.is_plain());
    let made = made.filter_map(|unit| Some((unit.name.to_owned(), units.composed(unit)?)));
    made.chain(labels.clone()).collect()
}

/// Labels with what they mean.
struct Units<'a> {
    labels: &'a Labels,
    section: Section,
    /// whether the label of forces is one per length of thickness
    is_per_thickness: bool,
    /// units of force, length and time, where they are labelled or follow from stress
    bases: [Option<Measure>; 3],
}

impl<'a> Units<'a> {
    fn of(labels: &'a Labels, section: Section) -> Self {
        let [force, length, time, stress] =
            [FORCE, LENGTH, TIME, STRESS].map(|of| labels.get(of.name).map(|label| Measure::of(label)));
        let is_per_thickness =
            section == Section::PlaneStrain && force.as_ref().is_some_and(|force| force.has([1, -1, 0]));
        let force = match (force, stress, &length) {
            (Some(force), _, Some(length)) if is_per_thickness => Some(force.times(length, 1)),
            (Some(_), _, None) if is_per_thickness => None,
            (None, Some(stress), Some(length)) => Some(stress.times(length, 2)),
            (force, ..) => force,
        };
        Self { labels, section, is_per_thickness, bases: [force, length, time] }
    }

    /// Refuses labels of length, force and time that are units of something else.
    fn check_bases(&self) -> Checked<()> {
        for (of, example) in [(LENGTH, "mm"), (FORCE, "N"), (TIME, "s")] {
            let Some(label) = self.labels.get(of.name) else { continue };
            let measure = Measure::of(label);
            if measure.is_known() && !measure.has(of.powers()) && !(of == FORCE && self.is_per_thickness) {
                let whole = match self.section {
                    Section::PlaneStrain => "",
                    _ if of == FORCE && measure.has([1, -1, 0]) => {
                        " (in this section forces are those of the whole thickness, or of the full turn)"
                    }
                    _ => "",
                };
                let message =
                    format!("is {label:?}, which is not a unit of {}, as {example:?} would be{whole}", of.name);
                return Err(ModelError::new(format!("units.{}", of.name), message));
            }
        }
        Ok(())
    }

    /// What length, force and time make of a unit, if those needed are known.
    fn expected(&self, unit: Unit) -> Option<Measure> {
        let mut bases = self.bases.iter().zip(unit.powers());
        bases.try_fold(Measure::one(), |product, (base, power)| match power {
            0 => Some(product),
            power => Some(product.times(base.as_ref()?, power)),
        })
    }

    /// The same as text.
    fn composed(&self, unit: Unit) -> Option<String> {
        let [force, length, time] = unit.powers();
        // What is summed over the thickness has the label of forces as it is; what is per area has forces of the whole slice.
        let length = if self.is_per_thickness && !unit.is_sum() { length + force } else { length };
        let parts = [(FORCE, force), (LENGTH, length), (TIME, time)];
        let parts: Option<Vec<(&str, i32)>> = parts
            .into_iter()
            .filter(|(_, power)| *power != 0)
            .map(|(of, power)| Some((self.labels.get(of.name)?.as_str(), power)))
            .collect();
        Some(composed(&parts?))
    }

    /// A label, what it means, and what it should mean, unless both agree.
    fn disagreement(&self, unit: Unit) -> Option<(&String, Measure, Measure)> {
        let is_base = [FORCE, LENGTH, TIME].contains(&unit);
        let label = self.labels.get(unit.name).filter(|_| !is_base)?;
        let (is, expected) = (Measure::of(label), self.expected(unit)?);
        let length = self.bases[1].as_ref().filter(|_| self.section == Section::PlaneStrain && unit.is_sum());
        let agrees =
            is.equals(&expected) || length.is_some_and(|length| is.equals(&expected.clone().times(length, -1)));
        (!agrees).then_some((label, is, expected))
    }

    fn check(&self, unit: Unit) -> Checked<()> {
        let Some((label, is, expected)) = self.disagreement(unit) else { return Ok(()) };
        if !is.is_known() || !expected.is_known() {
            return Ok(());
        }
        let place = format!("units.{}", unit.name);
        if unit.is_plain() {
            return Err(ModelError::new(place, format!("is {label:?}, but the results have 1 (angles: rad)")));
        }
        let from = [(LENGTH, "lengths"), (FORCE, "forces"), (TIME, "times"), (STRESS, "stresses")];
        let has_force = self.labels.contains_key(FORCE.name);
        let serves = |of: Unit| match of {
            LENGTH => unit.powers()[1] != 0 || self.is_per_thickness || !has_force,
            FORCE => unit.powers()[0] != 0,
            STRESS => !has_force,
            _ => unit.powers()[2] != 0,
        };
        let from = from.iter().filter(|(of, _)| serves(*of));
        let from = from.filter_map(|(of, name)| Some(format!("{name} in {}", self.labels.get(of.name)?)));
        let from = from.collect::<Vec<_>>().join(", ");
        let composed = self.composed(unit).map(|text| format!("{text:?}"));
        let name = expected.name().map(|name| format!("{name:?}"));
        let would = [composed, name].into_iter().flatten().collect::<Vec<_>>().join(" or ");
        let would = if would.is_empty() { "another".into() } else { would };
        let times = match is.is_like(&expected) {
            true => format!(", and {label:?} is {} times that", number(is.over(&expected))),
            false => String::new(),
        };
        let message = format!("is {label:?}, but {from} make it {would}{times}: write that, or leave it out");
        Err(ModelError::new(place, message))
    }

    fn concern(&self, unit: Unit) -> Option<String> {
        let (label, is, expected) = self.disagreement(unit)?;
        let names: Vec<&String> = is.unknown().chain(expected.unknown()).collect();
        let names = names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
        Some(format!(
            "units.{} is {label:?}, which cannot be checked against length, force and time; not known as names of \
             units, as mm, kN, MPa, kg or h: {names}",
            unit.name
        ))
    }
}
