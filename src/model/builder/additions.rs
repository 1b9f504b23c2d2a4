//! What a contact adds to its friction law: dilatancy, wear, and strength without pressure.

use crate::laws::friction::{BondParameters, BondSurfaces, ContactLaw, FrictionLaw, Offsets};
use crate::laws::parameter::InvalidParameter;

/// What a contact adds to its friction law.
#[derive(Clone, Copy, Debug)]
pub struct Additions {
    /// Dilatancy and wear
    pub offsets: Offsets,
    /// Strength without pressure
    pub bond: Option<(BondParameters, BondSurfaces)>,
}

impl Additions {
    /// Completes a law.
    ///
    /// # Errors
    /// Returns [`InvalidParameter`] named by its key within the contact.
    pub fn of(self, law: Box<dyn FrictionLaw>) -> Result<ContactLaw, InvalidParameter> {
        let law = ContactLaw::with_offsets(law, self.offsets)?;
        match &self.bond {
            Some((parameters, surfaces)) => law.bonded(parameters, *surfaces),
            None => Ok(law),
        }
    }
}
