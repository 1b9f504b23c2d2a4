//! Strength of an interface as engineers give it, by the adjacent soil or by cohesion and angle: Coulomb friction and a bond.
//!
//! ```text
//! c_i = R c,   tan φ_i = R tan φ              c, φ: of the body adjacent to the interface that yields by them; of von_mises c = σ_y/√3
//! q ≤ c_i + p tan φ_i
//! ```
//! Where φ_i = 0 friction is `frictionless`, and where c_i = 0 there is no bond but the one that is given.

use super::contact::Contact;
use super::error::{Checked, ModelError, refuse_if};
use super::facing::facing;
use super::friction::Friction;
use super::interface::Interface;
use crate::laws::friction::{BondParameters, FrictionParameters};
use crate::model::Model;
use crate::model::text::number;

/// Strength of a body: its name, c and tan φ.
struct Strength<'a> {
    body: &'a str,
    cohesion: f64,
    tangent: f64,
}

impl Strength<'_> {
    fn described(&self) -> String {
        let angle = (self.tangent.atan().to_degrees() * 1e9).round() / 1e9;
        format!("`{}` (c = {}, phi = {})", self.body, number(self.cohesion), number(angle))
    }

    fn values(&self) -> [f64; 2] {
        [self.cohesion, self.tangent]
    }
}

/// The contact with friction and a bond in place of the strength of its interface.
#[doc(hidden)]
pub fn with_friction(contact: &Contact, model: &Model) -> Checked<Contact> {
    let mut contact = contact.clone();
    let Some(interface) = contact.interface.take() else { return Ok(contact) };
    let place = format!("contacts.{}", contact.name);
    let own = format!("{place}.interface");
    let message = "gives friction by itself: leave `friction` out";
    refuse_if(!contact.friction.is_tie(), &own, message)?;
    refuse_if(contact.tied, &own, "is for surfaces that slide, and these are tied: leave it out")?;
    let message = "is for `friction` that is written out: leave `interface` or `along` out";
    refuse_if(!contact.along.is_empty(), format!("{place}.along"), message)?;
    let message = "is that of the interface already: leave it out";
    refuse_if(contact.bond.is_some_and(|bond| bond.strength.is_some()), format!("{place}.bond.strength"), message)?;
    let [cohesion, tangent] = strength(&own, &interface, &contact, model)?;
    contact.friction = Friction::from(FrictionParameters::constant(tangent));
    let message = "is for an interface with cohesion, and this one has none: leave it out, or give a cohesion";
    refuse_if(contact.bond.is_some() && cohesion == 0.0, format!("{place}.bond"), message)?;
    if cohesion > 0.0 {
        contact.bond = Some(BondParameters { strength: Some(cohesion), ..contact.bond.unwrap_or_default() });
    }
    Ok(contact)
}

/// c_i and tan φ_i
fn strength(place: &str, interface: &Interface, contact: &Contact, model: &Model) -> Checked<[f64; 2]> {
    let at = |key: &str| format!("{place}.{key}");
    let Interface { reduction, of, cohesion, friction_angle } = interface;
    let Some(reduction) = *reduction else {
        refuse_if(of.is_some(), at("of"), "is for a `reduction` of the strength of a body: leave it out")?;
        let message =
            "is missing: give the fraction of the soil's strength (0.67 say), or `cohesion` and `friction_angle`";
        refuse_if(cohesion.is_none() && friction_angle.is_none(), at("reduction"), message)?;
        let (cohesion, angle) = (cohesion.unwrap_or(0.0), friction_angle.unwrap_or(0.0));
        let message = format!("is {cohesion}: it must be zero or positive, and finite");
        refuse_if(!(cohesion >= 0.0 && cohesion.is_finite()), at("cohesion"), message)?;
        let message = format!("is {angle}: it must be 0 or more, and less than 90 degrees");
        refuse_if(!(0.0..90.0).contains(&angle), at("friction_angle"), message)?;
        return Ok([cohesion, angle.to_radians().tan()]);
    };
    for (key, is_given) in [("cohesion", cohesion.is_some()), ("friction_angle", friction_angle.is_some())] {
        refuse_if(is_given, at(key), "follows from `reduction`: leave one of them out")?;
    }
    let message = format!("is {reduction}: it must lie between 0 and 1");
    refuse_if(!(0.0..=1.0).contains(&reduction), at("reduction"), message)?;
    let soil = adjacent_strength(place, of.as_deref(), contact, model)?;
    Ok(soil.values().map(|value| reduction * value))
}

/// The body adjacent to a contact whose strength counts.
fn adjacent_strength<'a>(place: &str, of: Option<&str>, contact: &Contact, model: &'a Model) -> Checked<Strength<'a>> {
    let refused = |key: &str, message: String| Err(ModelError::new(format!("{place}.{key}"), message));
    if contact.area.is_some() {
        let message = "needs bodies at slave edges, and the slave is a group of points: give `cohesion` and \
            `friction_angle`";
        return refused("reduction", message.into());
    }
    let sides = facing(&format!("contacts.{}", contact.name), contact, model)?;
    let mut numbers: Vec<usize> =
        sides.slave.iter().chain(&sides.master).map(|edge| model.body_of_element[edge.element]).collect();
    numbers.sort_unstable();
    numbers.dedup();
    let bodies = || numbers.iter().map(|&body| &model.bodies[body]);
    let names = || bodies().map(|body| format!("`{}`", body.name)).collect::<Vec<_>>().join(", ");
    if let Some(name) = of.filter(|name| bodies().all(|body| body.name != **name)) {
        return refused("of", format!("is `{name}`, which is not a body at this contact: there are {}", names()));
    }
    let known = |body: &'a crate::model::Body| {
        let [cohesion, tangent] = body.material.description().strength?;
        Some(Strength { body: &body.name, cohesion, tangent })
    };
    let all: Vec<Strength> =
        bodies().filter(|body| of.is_none_or(|name| body.name == name)).filter_map(known).collect();
    let described = || all.iter().map(Strength::described).collect::<Vec<_>>().join(", ");
    match all.iter().any(|other| other.values() != all[0].values()) {
        true => refused(
            "reduction",
            format!(
                "is a fraction of a strength that differs between the bodies at the contact, {}: name one of them by \
                 \"of\", or give each a contact of its own",
                described()
            ),
        ),
        false => all.into_iter().next().map_or_else(
            || {
                let named = match of {
                    Some(name) => format!("`{name}` does not yield"),
                    None => format!("none of the bodies at the contact ({}) yields", names()),
                };
                let message = format!(
                    "is a fraction, but {named} by cohesion and friction (mohr_coulomb, drucker_prager, von_mises): \
                     give `cohesion` and `friction_angle` of the interface"
                );
                refused("reduction", message)
            },
            Ok,
        ),
    }
}
