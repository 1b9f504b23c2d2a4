//! A law in its body: under an initial stress, heated, with a fluid in its pores, in a plate.
//!
//! | in addition to the law | equations |
//! |---|---|
//! | initial stress and temperature | `imposed.rs` |
//! | a fluid that cannot drain | `pores.rs` |
//! | a fluid whose pressure is given | `given.rs` |
//! | no out-of-plane stress | `plate.rs` |

mod given;
mod imposed;
mod plate;
mod pores;

use std::ops::Range;
use std::sync::Arc;

use nalgebra::Vector2;

use super::slots::{Names, Slot};
use super::{Answer, BulkLaw, CauchyStress, InadmissibleStress, Material, MaterialDescription, Sections, Straining};
pub use given::GIVEN_PRESSURE;
use given::Given;
use imposed::{Heat, Imposed};
pub use imposed::{INITIAL_STRESS, TEMPERATURE};
use pores::Pores;
pub use pores::{PORE_PRESSURE, PoreFluid};

/// What there is in a body in addition to its law; nothing by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Surroundings {
    /// Whether it begins under an initial stress, which is added to that of a law that does not [hold](MaterialDescription::holds_initial_stress) it
    pub stressed: bool,
    /// α of a body that is heated [1/Θ]
    pub expansion: Option<f64>,
    /// The fluid in its pores
    pub fluid: Option<PoreFluid>,
    /// b of a body in whose pores the pressure of the fluid is given [-]
    pub biot: Option<f64>,
    /// Whether it is a plate
    pub plate: bool,
}

setters! { const surroundings: Surroundings;
    /// Sets whether it begins under an initial stress.
    stressed(stressed: bool) { surroundings.stressed = stressed; }

    /// Sets the expansion α of a body that is heated [1/Θ].
    expansion(expansion: f64) { surroundings.expansion = Some(expansion); }

    /// Sets the fluid in its pores.
    fluid(fluid: PoreFluid) { surroundings.fluid = Some(fluid); }

    /// Sets Biot's coefficient of a body in whose pores the pressure of the fluid is given.
    biot(biot: f64) { surroundings.biot = Some(biot); }

    /// Makes it a plate.
    plate() { surroundings.plate = true; }
}

/// A law under what is imposed on it, with a fluid in its pores, or in a plate.
///
/// ```text
/// P = ϑ² (P_l(F_e) + F_e σ₀) − p_w F⁻ᵀ − b p J F⁻ᵀ,   F = ϑ F_e    of a plate at the F₃₃ where P₃₃ = 0
/// ```
/// The variables of the law stand between that of the fluid and those of the initial stress, the temperature and the given pressure.
/// [`respond`](BulkLaw::respond) finds T − T₀ and p at the end of the increment in the new variables, which the caller writes there, and p_w0 in
/// the old ones. Damping is the law's own, in a plate with the moduli of a plate.
///
/// # Errors
/// [`MaterialFailure::Inverted`](crate::laws::bulk::MaterialFailure::Inverted) when det F or ϑ is not positive, [`MaterialFailure::NotConverged`](crate::laws::bulk::MaterialFailure::NotConverged) when no F₃₃ leaves a plate free of
/// stress, and those of the law at F_e.
#[derive(Clone, Debug)]
pub struct BodyLaw {
    law: Arc<dyn Material>,
    surroundings: Surroundings,
    /// Whether the law is linear: so is the body
    linear: bool,
    names: Vec<&'static str>,
    shown: Vec<&'static str>,
    /// Places of the law's own variables
    own: Range<usize>,
    pores: Option<Pores>,
    initial: Option<Imposed>,
    heat: Option<Heat>,
    given: Option<Given>,
}

impl BodyLaw {
    /// A law in its surroundings; `None` if the law does not serve there (its [sections](MaterialDescription::sections)), of a fluid that
    /// cavitates in a linear body, of one in a plate, and of one whose pressure is given as well.
    pub fn new(law: impl Into<Arc<dyn Material>>, surroundings: Surroundings) -> Option<Self> {
        let law = law.into();
        let own = law.description();
        let Surroundings { stressed, expansion, fluid, biot, plate } = surroundings;
        let (linear, mut names, mut shown) = (own.is_linear, Names::default(), own.shown.to_vec());
        let pores = fluid.map(|fluid| Pores::new(fluid, linear, &mut names));
        shown.extend(fluid.map(|_| pores::SHOWN).or(biot.map(|_| pores::SHOWN)));
        let places = names.all(own.variables);
        let adjacent = stressed && !own.holds_initial_stress;
        let initial = adjacent.then(|| Imposed::new(linear, &mut names));
        let heat = expansion.map(|expansion| Heat::new(expansion, linear, &mut names));
        let given = biot.map(|biot| Given::new(biot, linear, &mut names));
        let any = pores.is_some() || initial.is_some() || heat.is_some() || given.is_some();
        let serves = match (plate, any) {
            (true, _) => own.sections == Sections::All && fluid.is_none(),
            (false, true) => own.sections.any_stretch(),
            (false, false) => true,
        };
        let cavitates = linear && fluid.is_some_and(|fluid| fluid.cavitation.is_some());
        let names = names.names;
        let filled_twice = fluid.is_some() && biot.is_some();
        (serves && !cavitates && !filled_twice).then_some(Self {
            law,
            surroundings,
            linear,
            names,
            shown,
            own: places,
            pores,
            initial,
            heat,
            given,
        })
    }

    /// The law itself where there is nothing else, which then costs nothing, and otherwise the law with what there is.
    pub fn around(law: impl Into<Arc<dyn Material>>, surroundings: Surroundings) -> Option<Arc<dyn Material>> {
        let body = Self::new(law, surroundings)?;
        let alone = body.names.len() == body.own.len() && !surroundings.plate;
        Some(if alone { body.law } else { Arc::new(body) })
    }

    /// α (T − T₀) of some variables.
    fn thermal_strain(&self, variables: &[f64]) -> f64 {
        self.heat.as_ref().map_or(0.0, |heat| heat.strain(variables))
    }

    /// The straining of the law itself, without a thermal strain.
    fn elastic<'a>(&self, straining: &Straining<'a>, strain: f64) -> Straining<'a> {
        let now = imposed::elastic(straining, strain, self.linear);
        Straining { old: &straining.old[self.own.clone()], ..now }
    }

    /// The answer at any F₃₃.
    fn stretched(&self, straining: &Straining, new: &mut [f64]) -> Answer {
        let fluid = self.pores.as_ref().map(|pores| pores.fluid(straining)).transpose()?;
        let strain = self.thermal_strain(new);
        imposed::positive(strain)?;
        let elastic = self.elastic(straining, strain);
        let mut answer = self.law.in_space(&elastic, &mut new[self.own.clone()])?;
        if let Some(initial) = &self.initial {
            initial.add(&mut answer, &elastic, straining.old, new);
        }
        if let Some(heat) = &self.heat {
            heat.expand(&mut answer, straining, new);
        }
        if let (Some(pores), Some(fluid)) = (&self.pores, &fluid) {
            pores.add(&mut answer, fluid, straining, new);
        }
        if let Some(given) = &self.given {
            given.add(&mut answer, straining, new);
        }
        Ok(answer)
    }
}

impl BulkLaw for BodyLaw {
    fn description(&self) -> MaterialDescription<'_> {
        let own = self.law.description();
        let Surroundings { plate, fluid, .. } = self.surroundings;
        let here = |modulus: f64| if plate { plate::modulus(modulus, own.shear_modulus) } else { modulus };
        MaterialDescription {
            p_wave_modulus: here(own.p_wave_modulus) + fluid.map_or(0.0, |fluid| fluid.modulus),
            viscous_modulus: Some(here(own.viscous_modulus.unwrap_or(own.p_wave_modulus))),
            variables: &self.names,
            evolves: own.evolves || self.heat.is_some() || self.given.is_some(),
            shown: &self.shown,
            sections: if plate { Sections::Plate } else { own.sections },
            ..own
        }
    }

    fn respond(&self, straining: &Straining, new: &mut [f64]) -> Answer {
        match self.surroundings.plate {
            true => self.free(straining, new),
            false => self.stretched(straining, new),
        }
    }

    fn begin(
        &self,
        position: Vector2<f64>,
        stress: &CauchyStress,
        variables: &mut [f64],
    ) -> Result<(), InadmissibleStress> {
        if let Some(initial) = &self.initial {
            initial.begin(stress, variables);
        }
        let stressed = self.surroundings.stressed || self.law.description().holds_initial_stress;
        if let Some(heat) = self.heat.as_ref().filter(|_| stressed) {
            heat.begin(stress, variables);
        }
        self.law.begin(position, stress, &mut variables[self.own.clone()])
    }

    /// h = ϑ h_e
    fn ln_free_stretch(&self, straining: &Straining) -> Answer<f64> {
        let strain = self.thermal_strain(straining.old);
        Ok(self.law.ln_free_stretch(&self.elastic(straining, strain))? + strain.ln_1p())
    }

    fn at_pressure(&self, pressure: f64) -> Option<Arc<dyn Material>> {
        Some(Arc::new(Self { law: self.law.at_pressure(pressure)?, ..self.clone() }))
    }

    fn show(&self, straining: &Straining, values: &mut [f64]) -> Answer<()> {
        let straining = Straining { stretch: self.stretch_across(straining)?, ..*straining };
        let (own, fluid) = values.split_at_mut(self.law.description().shown.len());
        if let Some(pores) = &self.pores {
            fluid.fill(pores.fluid(&straining)?.pressure);
        }
        if let Some(given) = &self.given {
            fluid.fill(given.pressure(straining.old));
        }
        self.law.show(&self.elastic(&straining, self.thermal_strain(straining.old)), own)
    }
}
