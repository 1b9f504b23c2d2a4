//! Friction by effective stress: the elements behind the points of a contact, in whose pores a fluid is.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::Vector2;

use super::contact::Contact;
use super::error::{Checked, ModelError, refuse_if};
use super::fluid::FluidPressure;
use super::friction::position;
use crate::contact::pores::Pores;
use crate::contact::surface::SlavePoint;
use crate::laws::friction::Offsets;
use crate::mesh::{Configuration, Edge, Group};
use crate::model::Model;
use crate::model::element::SolidElement;

/// An element behind a contact point, and the fluid in it.
#[derive(Clone, Debug)]
struct Behind {
    solid: Arc<SolidElement>,
    /// Its nodes
    nodes: Vec<usize>,
    /// Positions of its nodes among those of the point
    places: Vec<usize>,
    /// Share of the point's length that lies on it
    share: f64,
    /// Whether the volume change is tr ε
    is_linear: bool,
    /// K_w/n [F/L²]
    modulus: f64,
    /// p_w0 at the point [F/L²]
    initial: f64,
    /// Pressure of cavitation [F/L²]
    least: f64,
}

impl Behind {
    /// Share of p_w, whose derivatives are added to `by`; NaN where the element is inverted, which its body tells of.
    fn pressure(&self, x: &Configuration, by: Option<&mut [f64]>) -> f64 {
        let u: Vec<Vector2<f64>> = self.nodes.iter().map(|&node| x.displacement(node)).collect();
        let mut rates = vec![0.0; if by.is_some() { 2 * u.len() } else { 0 }];
        let change = self.solid.mean_volume_change(self.is_linear, &u, by.is_some().then_some(&mut rates[..]));
        let Ok(change) = change else { return f64::NAN };
        let pressure = self.initial - self.modulus * change;
        if pressure < self.least {
            return self.share * self.least;
        }
        if let Some(by) = by {
            for (&place, rates) in self.places.iter().zip(rates.chunks_exact(2)) {
                (0..2).for_each(|i| by[2 * place + i] -= self.share * self.modulus * rates[i]);
            }
        }
        self.share * pressure
    }
}

/// Pores behind every point of a contact whose friction goes by them; `None` of any other.
pub fn pores(place: &str, contact: &Contact, points: &[SlavePoint], model: &Model) -> Checked<Option<Vec<Pores>>> {
    let Some(FluidPressure::OfBodies) = contact.fluid_pressure else { return Ok(None) };
    let place = format!("{place}.fluid_pressure");
    let refused = |message: String| Err(ModelError::new(place.clone(), message));
    let opens = Offsets { dilatancy: contact.dilatancy, wear: contact.wear } != Offsets::default();
    let message = "of bodies is for interfaces without dilatancy and wear, because fluid drawn into an opening \
                   interface is not modelled: leave out dilatancy and wear";
    refuse_if(opens, &place, message)?;
    let Some(Group::Edges(edges)) = model.mesh.groups.get(&contact.slave) else {
        return refused("of bodies needs a slave of edges, which have elements behind them: give a number".into());
    };
    let pores = points.iter().map(|point| behind(point, edges, model, &contact.slave).map(gathered));
    pores.collect::<Result<Vec<Pores>, String>>().map(Some).or_else(refused)
}

/// Elements behind a point, by the edges that have a share of its length.
fn behind(point: &SlavePoint, edges: &[Edge], model: &Model, slave: &str) -> Result<Vec<Behind>, String> {
    let x = model.mesh.undeformed();
    let at = position(point, &model.mesh);
    let mut lengths: BTreeMap<usize, f64> = BTreeMap::new();
    for share in &point.length {
        let on = |edge: &&Edge| share.tangent.iter().all(|(node, _)| edge.nodes.contains(node));
        let edge = edges.iter().find(on).ok_or("of bodies finds no element behind a point of the slave")?;
        *lengths.entry(edge.element).or_default() += share.factor * x.combine(&share.tangent).norm();
    }
    let whole: f64 = lengths.values().sum();
    let of = |(element, length): (usize, f64)| {
        let body = model.body_of(element);
        let fluid = body.pore_fluid.as_ref().ok_or_else(|| {
            format!(
                "of bodies needs a `pore_fluid` of body `{}`, which the slave `{slave}` lies on: give it one, or make the other side \
                 the slave",
                body.name
            )
        })?;
        Ok(Behind {
            solid: Arc::new(model.solids[element].clone()),
            nodes: model.mesh.elements[element].nodes.clone(),
            places: Vec::new(),
            share: length / whole,
            is_linear: body.material.description().is_linear,
            modulus: fluid.modulus(),
            initial: fluid.pressure.value(at),
            least: fluid.cavitation.unwrap_or(f64::NEG_INFINITY),
        })
    };
    lengths.into_iter().map(of).collect()
}

/// The pores of all elements behind one point.
fn gathered(mut elements: Vec<Behind>) -> Pores {
    let mut nodes: Vec<usize> = elements.iter().flat_map(|element| element.nodes.iter().copied()).collect();
    nodes.sort_unstable();
    nodes.dedup();
    for element in &mut elements {
        element.places = element.nodes.iter().filter_map(|node| nodes.binary_search(node).ok()).collect();
    }
    Pores::new(nodes, move |x, mut by| elements.iter().map(|element| element.pressure(x, by.as_deref_mut())).sum())
}
