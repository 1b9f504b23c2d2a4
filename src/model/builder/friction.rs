//! Friction of a contact before the contact is known: the same everywhere, or varying along the slave.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::error::{Checked, ModelError};
use crate::contact::surface::SlavePoint;
use crate::laws::friction::{
    CoulombParameters, FrictionLaw, FrictionParameters, RateAndStateParameters, SlipWeakeningParameters,
    SuperSubloadingParameters,
};
use crate::mesh::Mesh;
use crate::model::boundary::Profile;

/// The law of a point: from what varies along the slave there, and the α_t that serves where none is given.
type LawAt = dyn Fn(&[f64], f64) -> Checked<Box<dyn FrictionLaw>>;

/// Friction of a contact. A law is friction, and so are parameters of one, whose α_t is α_n/2 unless they give it.
pub struct Friction {
    varying: Vec<(String, Profile)>,
    law: Box<LawAt>,
}

impl Friction {
    /// Friction that varies along the slave by reference position: `law` gets the values of the profiles at a point, and the
    /// α_t of a law that has none of its own. Messages name a profile by what stands before it, such as `along.mu`.
    ///
    /// ```
    /// use fecontact::laws::friction::{Coulomb, CoulombParameters};
    /// use fecontact::model::boundary::{Expression, Profile};
    /// use fecontact::model::builder::Friction;
    ///
    /// let mu = Profile::Expression(Expression::parse("0.3 + 0.1*x")?);
    /// let friction = Friction::varying([("along.mu", mu)], |values, alpha_t| {
    ///     Ok(Box::new(Coulomb::new(&CoulombParameters::new(values[0]), alpha_t)?))
    /// });
    /// # Ok::<(), String>(())
    /// ```
    pub fn varying<N: Into<String>>(
        profiles: impl IntoIterator<Item = (N, Profile)>,
        law: impl Fn(&[f64], f64) -> Checked<Box<dyn FrictionLaw>> + 'static,
    ) -> Self {
        let varying = profiles.into_iter().map(|(name, profile)| (name.into(), profile)).collect();
        Self { varying, law: Box::new(law) }
    }

    /// The laws of a contact, and to every slave point the number of its own: one for all that have the same values.
    pub(super) fn laws(
        &self,
        place: &str,
        points: &mut [SlavePoint],
        mesh: &Mesh,
        default_alpha_t: Option<f64>,
    ) -> Checked<Vec<Box<dyn FrictionLaw>>> {
        if self.varying.is_empty() {
            return Ok(vec![self.law(&[], default_alpha_t, place, format!("{place}.friction"))?]);
        }
        let places: Vec<String> = self.varying.iter().map(|(name, _)| format!("{place}.{name}")).collect();
        for ((_, profile), place) in self.varying.iter().zip(&places) {
            check_profile(profile, place)?;
        }
        let mut laws = Vec::new();
        let mut numbers: BTreeMap<Vec<u64>, usize> = BTreeMap::new();
        for point in points {
            let at = position(point, mesh);
            let profiles = self.varying.iter().zip(&places);
            let values =
                profiles.map(|((_, profile), place)| defined(profile, at, place)).collect::<Checked<Vec<_>>>()?;
            let key: Vec<u64> = values.iter().map(|value| value.to_bits()).collect();
            if let Some(&law) = numbers.get(&key) {
                point.law = law;
                continue;
            }
            point.law = laws.len();
            numbers.insert(key, laws.len());
            laws.push(self.law(&values, default_alpha_t, place, format!("{} at ({}, {})", places[0], at.x, at.y))?);
        }
        Ok(laws)
    }

    fn law(
        &self,
        values: &[f64],
        default_alpha_t: Option<f64>,
        contact: &str,
        place: String,
    ) -> Checked<Box<dyn FrictionLaw>> {
        // NaN stands for none: a law that is good with another number lacks its own.
        let law = (self.law)(values, default_alpha_t.unwrap_or(f64::NAN));
        let lacks = law.is_err() && default_alpha_t.is_none() && (self.law)(values, 1.0).is_ok();
        if lacks {
            let message = "is missing: a slave group of points has no default for it";
            return Err(ModelError::new(format!("{contact}.friction.alpha_t"), message));
        }
        law.map_err(|error| if error.place.is_empty() { ModelError { place, ..error } } else { error })
    }
}

impl From<FrictionParameters> for Friction {
    fn from(parameters: FrictionParameters) -> Self {
        Self::varying::<String>([], move |_, alpha_t| Ok(parameters.build(alpha_t)?))
    }
}

/// What FrictionParameters are made from is friction too.
macro_rules! friction_from {
    ($($parameters:ty),*) => {$(
        impl From<$parameters> for Friction {
            fn from(parameters: $parameters) -> Self {
                FrictionParameters::from(parameters).into()
            }
        }
    )*};
}

friction_from!(CoulombParameters, SuperSubloadingParameters, SlipWeakeningParameters, RateAndStateParameters);

impl<L: FrictionLaw + Clone + 'static> From<L> for Friction {
    fn from(law: L) -> Self {
        Self::varying::<String>([], move |_, _| Ok(Box::new(law.clone())))
    }
}

/// Reference position of a slave point.
pub fn position(point: &SlavePoint, mesh: &Mesh) -> Vector2<f64> {
    point.position.iter().map(|&(node, w)| mesh.nodes[node] * w).sum()
}

/// The value of a profile, which must be a finite number.
pub fn defined(profile: &Profile, at: Vector2<f64>, place: &str) -> Checked<f64> {
    let value = profile.value(at);
    match value.is_finite() {
        true => Ok(value),
        false => Err(ModelError::new(place, format!("is not a finite number at ({}, {})", at.x, at.y))),
    }
}

/// A profile must not depend on time, and the coordinates of a table must ascend.
pub fn check_profile(profile: &Profile, place: &str) -> Checked<()> {
    match profile {
        Profile::Constant(_) => Ok(()),
        Profile::Expression(expression) if expression.depends_on_time() => {
            Err(ModelError::new(place, "the time t has no meaning here: the variables are x and y"))
        }
        Profile::Expression(_) => Ok(()),
        Profile::Table(component, table) => {
            let name = ["x", "y"][*component];
            if table.is_empty() {
                let message = format!("the table is empty: give pairs [{name}, value]");
                return Err(ModelError::new(format!("{place}.{name}"), message));
            }
            let Some(pair) = table.windows(2).find(|pair| pair[1][0] < pair[0][0]) else { return Ok(()) };
            let message = format!("the coordinates of the table must ascend: {} follows {}", pair[1][0], pair[0][0]);
            Err(ModelError::new(format!("{place}.{name}"), message))
        }
    }
}
