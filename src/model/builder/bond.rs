//! Strength without pressure: bonds of contacts, and the opening over which strength fades.
//!
//! ```text
//! δ = 4 c h/E                        E: the lower modulus of both sides; h: longest edge of the slave in the mesh as read
//! ```
//! At an end of a contact an element that loses the shear c opens by c h/E, more or less, which takes further shear from it: below about
//! 1.3 c h/E a leading edge snaps. A fading strength that is longer than that has an equilibrium at every opening.

use super::contact::Contact;
use super::error::{Checked, refuse_if};
use super::facing::facing;
use super::friction::DefaultAlphaT;
use crate::contact::pair::Fades;
use crate::laws::friction::{BondParameters, BondSurfaces, ContactLaw};
use crate::mesh::Edge;
use crate::model::Model;
use crate::model::boundary::Profile;

/// δ over c h/E unless given [-]
#[doc(hidden)]
pub const FADES: f64 = 4.0;

/// α_n h/E that stands for the unknown one of points without edges [-]
const OF_POINTS: f64 = 10.0;

/// Strength without pressure of a contact whose laws would be these without it; none where they have no cohesion, and no bond is given.
pub fn bond(
    place: &str,
    contact: &Contact,
    laws: &[std::sync::Arc<ContactLaw>],
    alpha_n: f64,
    alpha_t: Option<DefaultAlphaT>,
    model: &Model,
) -> Checked<Option<(BondParameters, BondSurfaces)>> {
    let own = laws.iter().map(|law| law.law.cohesion()).fold(0.0, f64::max);
    let grows = own == 0.0 && cohesion_grows(contact);
    if contact.bond.is_none() && own == 0.0 && !grows {
        return Ok(None);
    }
    let given = contact.bond.unwrap_or_default();
    let at = |key: &str| format!("{place}.bond.{key}");
    let BondParameters { strength, residual, slip, tension, opening, limit, bonded, alpha_t: stiffness } = given;
    let has_own = own > 0.0 || grows;
    let message = "is given by the friction law already (adhesion, or cohesion of slip_weakening): leave one of them \
                   out; a bond that softens or pulls goes with frictionless, coulomb or slip_weakening without \
                   cohesion";
    let further = [
        ("residual", residual.is_some()),
        ("slip", slip.is_some()),
        ("bonded", bonded),
        ("alpha_t", stiffness.is_some()),
    ];
    for (key, is_given) in [("strength", strength.is_some()), ("tension", tension != 0.0)].into_iter().chain(further) {
        refuse_if(has_own && is_given, at(key), message)?;
    }
    let message = "is missing: the friction law has no strength without pressure";
    refuse_if(!has_own && strength.is_none(), at("strength"), message)?;
    let moves = contact.dilatancy.is_some() || contact.wear.is_some();
    let message =
        "is not for surfaces that dilate or wear, whose slip at the limit does neither: leave one of them out";
    refuse_if(limit.is_some() && moves, at("limit"), message)?;
    let message = format!("is {}: it must be positive and finite", strength.unwrap_or(own));
    let fits = |strength: f64| strength > 0.0 && strength.is_finite();
    refuse_if(strength.is_some_and(|strength| !fits(strength)), at("strength"), message)?;
    let holds = laws.iter().all(|law| law.description.stiffness_is_penalty);
    let alpha_c = alpha_t.filter(|_| !holds).map_or(f64::NAN, |default| default.penalty);
    let surfaces = BondSurfaces { alpha_n, alpha_c, mu: 0.0, opening: f64::NAN };
    if opening.is_some() {
        return Ok(Some((given, surfaces)));
    }
    let message =
        "is missing: the cohesion is zero at the start, and the opening over which it fades has no default then";
    refuse_if(grows, at("opening"), message)?;
    let chosen = FADES * strength.unwrap_or(own) * flexibility(place, contact, alpha_n, model)?;
    Ok(Some((BondParameters { opening: Some(chosen), ..given }, surfaces)))
}

/// Whether the cohesion of the friction law varies in time.
fn cohesion_grows(contact: &Contact) -> bool {
    let grows = |along: &std::collections::BTreeMap<String, Profile>| {
        along.iter().any(|(name, profile)| name == "cohesion" && profile.depends_on_time())
    };
    grows(&contact.along.parameters) || contact.along.law.iter().any(|choice| grows(&choice.along))
}

/// What the opening of a contact with strength without pressure is measured by.
pub fn fades(place: &str, contact: &Contact, alpha_n: f64, model: &Model) -> Checked<Fades> {
    let is_chosen = contact.bond.is_none_or(|bond| bond.opening.is_none());
    Ok(Fades { flexibility: flexibility(place, contact, alpha_n, model)?, is_chosen })
}

/// h/E: longest edge of the slave over the lower modulus of both sides; of points without edges what a default penalty has it for [L³/F].
fn flexibility(place: &str, contact: &Contact, alpha_n: f64, model: &Model) -> Checked<f64> {
    if contact.area.is_some() {
        return Ok(OF_POINTS / alpha_n);
    }
    let sides = facing(place, contact, model)?;
    let modulus = |edge: &Edge| {
        let description = model.body_of(edge.element).material.description();
        let [shear, constrained] = [description.shear_modulus, description.p_wave_modulus];
        shear * (3.0 * constrained - 4.0 * shear) / (constrained - shear)
    };
    let softest = sides.master.iter().map(|edge| modulus(edge)).fold(f64::INFINITY, f64::min);
    let length = |edge: &Edge| (model.mesh.nodes[edge.nodes[1]] - model.mesh.nodes[edge.nodes[0]]).norm();
    let of = |edge: &&Edge| length(edge) / modulus(edge).min(softest);
    Ok(sides.slave.iter().map(of).fold(0.0, f64::max))
}
