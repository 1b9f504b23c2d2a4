//! Water of the bodies on both sides of a contact.

use std::collections::BTreeMap;

use super::contact::Contact;
use super::error::{Checked, check_not_negative, refuse_if};
use crate::contact::seam::{PressurePart, Seam};
use crate::mesh::{Edge, Group};
use crate::model::Model;
use crate::model::pore_flow::WetElement;

/// κ between two bodies over what passes through the shortest element adjacent to the contact, of the less permeable body, under the same difference of
/// pressures: the jump is a thousandth of what the pressure falls by in that element at most [-]
const NEARLY_CONTINUOUS: f64 = 1e3;

/// The water on both sides of a contact; `None` where none flows, or where its pressure is given.
pub fn seam(place: &str, contact: &Contact, model: &Model) -> Checked<Option<Seam>> {
    let mut nodes = BTreeMap::new();
    let mut most = [0.0f64; 2];
    let mut sides = 0;
    let groups = [Some(contact.slave.as_str()), contact.master_group()];
    let (Some(flow), None, false) = (&model.flow, &contact.fluid_pressure, contact.is_own()) else {
        return without(place, contact);
    };
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
            let part = |node: usize, share: f64| {
                let number = flow.of_node[node]?;
                let (dof, initial, scale) = (flow.dof(number), flow.initial[number], flow.scales[number]);
                Some(PressurePart { dof, initial, scale, share })
            };
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
    if sides < 2 {
        without(place, contact)?;
    }
    let given = contact.seal.unwrap_or(NEARLY_CONTINUOUS * most[0].min(most[1]));
    check_not_negative(&format!("{place}.seal"), given)?;
    Ok((sides > 0).then_some(Seam { nodes, conductance: if sides == 2 { given } else { 0.0 } }))
}

/// Refuses a seal where nothing can flow across.
fn without(place: &str, contact: &Contact) -> Checked<Option<Seam>> {
    let message = "is for a contact of two bodies whose water flows, without a `fluid_pressure`: leave it out";
    refuse_if(contact.seal.is_some(), format!("{place}.seal"), message)?;
    Ok(None)
}
