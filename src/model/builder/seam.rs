//! Water of the bodies on both sides of a contact.

use std::collections::BTreeMap;

use nalgebra::DMatrix;

use super::contact::Contact;
use super::error::{Checked, check_finite, check_not_negative, refuse_if};
use super::fluid::FluidPressure;
use crate::contact::conduit::Conduit;
use crate::contact::seam::{Drained, PressurePart, Seam};
use crate::mesh::{Edge, Group};
use crate::model::Model;
use crate::model::pore_flow::WetElement;

/// κ between two bodies over what passes through the shortest element adjacent to the contact, of the less permeable body, under the same difference of
/// pressures, and of the more permeable one into what is between them: the jump is a thousandth of what the pressure falls by in that element at most [-]
const NEARLY_CONTINUOUS: f64 = 1e3;

/// Opening from which on surfaces that part drain as well as that, over the size of the smallest element beside them [-]
const OPEN: f64 = 1e-4;

/// The water on both sides of a contact, and along it; `None` where none flows in the bodies, or where its pressure is given.
pub fn seam(place: &str, contact: &Contact, conduit: Option<&Conduit>, model: &Model) -> Checked<Option<Seam>> {
    let mut nodes = BTreeMap::new();
    let mut most = [0.0f64; 2];
    let mut trapped = [0.0f64; 2];
    let (mut sides, mut size) = (0, f64::INFINITY);
    let groups = [Some(contact.slave.as_str()), contact.master_group()];
    let (Some(flow), None | Some(FluidPressure::Flow(_)), false) =
        (&model.flow, &contact.fluid_pressure, contact.is_own())
    else {
        check_open(place, contact, false)?;
        return without(place, contact);
    };
    let part = |number: usize, share: f64| PressurePart {
        dof: flow.dof(number),
        initial: flow.initial[number],
        scale: flow.scales[number],
        share,
    };
    let channel: BTreeMap<usize, PressurePart> = (conduit.into_iter())
        .flat_map(|conduit| conduit.line.nodes.iter().zip(&conduit.pressures))
        .map(|(&node, &number)| (node, part(number, 1.0)))
        .collect();
    for (side, group) in groups.into_iter().enumerate() {
        let Some(Group::Edges(edges)) = group.and_then(|name| model.mesh.groups.get(name)) else { continue };
        let wet: Vec<(&Edge, &WetElement)> =
            edges.iter().filter_map(|edge| Some((edge, flow.wet(edge.element)?))).collect();
        let message = format!(
            "water flows in some of the bodies behind `{}` and not in others: divide the side, body by body",
            group.unwrap_or_default()
        );
        refuse_if(!wet.is_empty() && wet.len() < edges.len(), place, message)?;
        sides += usize::from(!wet.is_empty());
        for (edge, wet) in wet {
            let mobility = wet.mobility[0].max(wet.mobility[1]);
            most[side] = most[side].max(mobility / wet.size);
            size = size.min(wet.size);
            trapped[side] = trapped[side].max(rises(edge, wet, model));
            let part = |node: usize, share: f64| Some(part(flow.of_node[node]?, share));
            let [start, end] = [edge.nodes[0], edge.nodes[1]];
            for &node in &edge.nodes {
                let parts = if node == start || node == end {
                    part(node, 1.0).into_iter().collect()
                } else {
                    [part(start, 0.5), part(end, 0.5)].into_iter().flatten().collect::<Vec<_>>()
                };
                nodes.insert(node, (side, parts));
            }
        }
    }
    let passes = sides == 2 || sides == 1 && !channel.is_empty();
    if !passes {
        without(place, contact)?;
    }
    let most_by_element = most[0].max(most[1]);
    // From body to body the less permeable one governs; into what is between them each drains by itself.
    let governs = if channel.is_empty() { most[0].min(most[1]) } else { most_by_element };
    let given = contact.seal.unwrap_or(NEARLY_CONTINUOUS * governs);
    check_not_negative(&format!("{place}.seal"), given)?;
    let conductance = if passes { given } else { 0.0 };
    check_open(place, contact, sides > 0 && channel.is_empty())?;
    let message = format!("drains under the name of a group that drains as well: give `{}` another name", contact.name);
    let same = flow.outlets.iter().filter(|name| **name == contact.name).count() > 1;
    refuse_if(contact.open_pressure.is_some() && same, format!("{place}.open_pressure"), message)?;
    let open = contact.open_pressure.map(|pressure| Drained {
        pressure,
        conductance: NEARLY_CONTINUOUS * most_by_element,
        aperture: OPEN * size,
        outlet: flow.outlets.iter().position(|name| *name == contact.name).unwrap_or_default(),
    });
    // p_w is the mean of both sides, and each takes up half of the volume.
    let trapped = if sides == 2 { 0.25 * (trapped[0] + trapped[1]) } else { trapped[0].max(trapped[1]) };
    Ok((sides > 0).then_some(Seam { nodes, channel, conductance, open, most_by_element, trapped }))
}

/// Half the area of an edge over what the pores at one of its ends take up at least per pressure, by a diagonal below S + P of its element [F/L³].
fn rises(edge: &Edge, wet: &WetElement, model: &Model) -> f64 {
    let ends = [0, 1].map(|k| model.mesh.nodes[edge.nodes[k]]);
    let area = 0.5 * (ends[1] - ends[0]).norm() * model.mesh.section.weight(0.5 * (ends[0] + ends[1]));
    let lumped: Vec<f64> = wet.volumes.iter().map(|volume| wet.capacity * volume).collect();
    let corners = lumped.len();
    let scaled = DMatrix::from_fn(corners, corners, |a, b| wet.takes[a][b] / (lumped[a] * lumped[b]).sqrt());
    let least = scaled.symmetric_eigenvalues().min();
    let at_ends = model.mesh.elements[wet.element].nodes[..corners].iter().zip(&lumped);
    let at_ends = at_ends.filter(|(node, _)| edge.nodes[..2].contains(node));
    at_ends.map(|(_, lumped)| area / (least * lumped)).fold(0.0, f64::max)
}

/// Refuses a pressure of what opens where that does not drain.
fn check_open(place: &str, contact: &Contact, drains: bool) -> Checked<()> {
    let place = format!("{place}.open_pressure");
    let message = "is for a contact of bodies whose water flows, without a `fluid_pressure`: leave it out";
    refuse_if(contact.open_pressure.is_some() && !drains, &place, message)?;
    check_finite(&place, contact.open_pressure)
}

/// Refuses a seal where nothing can flow across.
fn without(place: &str, contact: &Contact) -> Checked<Option<Seam>> {
    let message =
        "is for a contact of two bodies whose water flows, without a `fluid_pressure` but `flow`: leave it out";
    refuse_if(contact.seal.is_some(), format!("{place}.seal"), message)?;
    Ok(None)
}
