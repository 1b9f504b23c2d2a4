//! Water that flows through the pores of bodies: its parameters, and where it leaves them.

use std::collections::{BTreeMap, BTreeSet};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::contact::Contact;
use super::error::{Checked, ModelError, check_positive, refuse_if};
use super::fluid::FluidPressure;
use super::friction::check_in_time;
use super::groups::{Place, nodes_at};
use crate::contact::pair::ContactPair;
use crate::laws::bulk::Material;
use crate::mesh::{Edge, Group, Mesh};
use crate::model::boundary::Profile;
use crate::model::element::{Formulation, SolidElement};
use crate::model::imposed::PoreFluid;
use crate::model::pore_flow::{Drain, DrainKind, PRESCRIBED, PoreFlow, WetElement};
use crate::model::scheme::Scheme;
use crate::model::text::{number, vector};
use crate::model::warnings::NO_FRICTION;
use crate::model::{Body, Model};

/// Where water flows out of bodies, or into them: exactly one of `pressure`, `head`, `seepage`, `flux` and `impervious`. Values count from the first
/// increment of the step on, and may jump there. What no entry names is impervious
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Drainage")]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct DrainageInput {
    /// Group of edges or nodes, or a single node, of bodies whose water flows
    pub on: Place,
    /// p_w that is prescribed there, by the reference position x, y or the run time t; 0 where water drains freely [F/L²]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressure: Option<Profile>,
    /// Level of free water that stands there: p_w = γ_w (head − y) of the reference position, of water that `weighs` [L]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub head: Option<Profile>,
    /// true: water leaves where its pressure is above 0, and none enters
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seepage: Option<bool>,
    /// Flow out of the body, per reference area of edges, or per node [L/T], [L³/T]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flux: Option<Profile>,
    /// true: ends what an earlier step has said of this place
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub impervious: Option<bool>,
    /// κ of a filter before a `pressure` or `head`: the flow out is κ times what p_w exceeds it by, κ > 0; unless given so large that p_w is held
    /// [L³/(F T)]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub filter: Option<f64>,
}

impl DrainageInput {
    fn nothing(on: impl Into<Place>) -> Self {
        let on = on.into();
        Self { on, pressure: None, head: None, seepage: None, flux: None, impervious: None, filter: None }
    }

    /// Holds the pressure at a place [F/L²].
    pub fn pressure(on: impl Into<Place>, pressure: impl Into<Profile>) -> Self {
        Self { pressure: Some(pressure.into()), ..Self::nothing(on) }
    }

    /// Lets free water stand at a place up to a level [L].
    pub fn head(on: impl Into<Place>, head: impl Into<Profile>) -> Self {
        Self { head: Some(head.into()), ..Self::nothing(on) }
    }

    /// Lets water seep out at a place.
    pub fn seepage(on: impl Into<Place>) -> Self {
        Self { seepage: Some(true), ..Self::nothing(on) }
    }

    /// Sets the flow out at a place [L/T].
    pub fn flux(on: impl Into<Place>, flux: impl Into<Profile>) -> Self {
        Self { flux: Some(flux.into()), ..Self::nothing(on) }
    }

    /// Puts a filter before it [L³/(F T)].
    pub fn filter(self, conductance: f64) -> Self {
        Self { filter: Some(conductance), ..self }
    }
}

/// The water of the bodies in which it flows, and of the contacts along which it flows beside them.
pub fn flow(
    bodies: &[Body],
    solids: &[SolidElement],
    channels: &BTreeMap<String, Vec<(usize, f64)>>,
    mesh: &mut Mesh,
) -> Checked<Option<PoreFlow>> {
    let Some(flow) = PoreFlow::new(bodies, solids, channels, mesh) else { return Ok(None) };
    for body in bodies {
        let Some(fluid) = body.flowing() else { continue };
        for wet in body.elements.iter().filter_map(|&e| flow.wet(e)) {
            for &k in &wet.pressures {
                let at = mesh.nodes[flow.corners[k]];
                let (own, other) = (fluid.pressure.value(at), flow.initial[k]);
                let jumps = (own - other).abs() > 1e-9 * own.abs().max(other.abs());
                if !jumps {
                    continue;
                }
                let message = format!(
                    "is {} at {}, where an adjacent body starts with {}: the pressure of flowing water is continuous \
                    there",
                    number(own),
                    vector(at),
                    number(other)
                );
                return Err(ModelError::new(format!("bodies.{}.pore_fluid.pressure", body.name), message));
            }
        }
    }
    Ok(Some(flow))
}

/// Whether the pressure of a fluid that flows acts at the start, before anything moves.
pub fn acts_at_start(fluid: Option<&PoreFluid>, nodes: &[usize], mesh: &Mesh) -> bool {
    let flowing = fluid.filter(|fluid| fluid.flows());
    flowing.is_some_and(|fluid| nodes.iter().any(|&node| fluid.pressure.value(mesh.nodes[node]) != 0.0))
}

/// Checks the parameters of a fluid that flows, or of one that cannot.
pub fn check_fluid(law: &dyn Material, fluid: &PoreFluid, element: Formulation, body: &str) -> Checked<()> {
    let place = |key: &str| format!("{body}.pore_fluid.{key}");
    if !fluid.flows() {
        let message = "is for a fluid that flows: give its permeability as well, or leave it out";
        refuse_if(fluid.permeability_y.is_some(), place("permeability_y"), message)?;
        refuse_if(fluid.unit_weight.is_some(), place("unit_weight"), message)?;
        refuse_if(fluid.biot.is_some(), place("biot"), message)?;
        refuse_if(fluid.capillary.is_some(), place("capillary"), message)?;
        refuse_if(fluid.kozeny_carman, place("kozeny_carman"), message)?;
        return refuse_if(fluid.weighs, place("weighs"), message);
    }
    check_positive(
        &place("capillary"),
        fluid.capillary.unwrap_or(1.0),
        " (leave it out for ground that stays saturated)",
    )?;
    let message = "is for water that weighs: give \"weighs\": true, or leave it out";
    refuse_if(fluid.capillary.is_some() && !fluid.weighs, place("capillary"), message)?;
    let hint = " (leave it out for undrained conditions)";
    check_positive(&place("permeability"), fluid.permeability.unwrap_or(1.0), hint)?;
    check_positive(&place("permeability_y"), fluid.permeability_y.unwrap_or(1.0), "")?;
    let message = "is missing: the permeability k is a speed under a gradient of head, and k/unit_weight under one of the pressure (9.81e3 N/m³ of \
                   water)";
    let weight = fluid.unit_weight.ok_or_else(|| ModelError::new(place("unit_weight"), message))?;
    check_positive(&place("unit_weight"), weight, " (9.81e3 N/m³ of water)")?;
    let (biot, porosity) = (fluid.coefficient(), fluid.porosity);
    let message = format!("is {biot}: it must be at least the porosity, {porosity}, and at most 1, that of soil");
    refuse_if(!(biot >= porosity && biot <= 1.0), place("biot"), message)?;
    let message = "is f_bar, which is not for a body whose water flows: leave it out (the pressures of Q4 do not alternate there, and the water keeps \
                   the volume), or take Q8 with \"element\": \"reduced\"";
    refuse_if(element == Formulation::FBar, format!("{body}.element"), message)?;
    let message = "has no shear stiffness, which keeps the pressures of neighbours from alternating: take another law";
    refuse_if(law.description().shear_modulus <= 0.0, format!("{body}.material"), message)
}

/// What a case has together with water that flows, and cannot be computed with it yet.
pub fn check(contacts: &[Contact], model: &Model) -> Checked<()> {
    let Some(flow) = &model.flow else {
        let message =
            "is for water that flows, and there is none: give pore_fluid.permeability of a body, or leave it out";
        let mut steps = model.steps.iter().enumerate();
        let given = steps.find(|(_, step)| step.increments.pore_pressure.is_some());
        return given.map_or(Ok(()), |(k, _)| Err(ModelError::new(format!("steps[{k}].dt.pore_pressure"), message)));
    };
    let name = |body: usize| &model.bodies[body].name;
    let first = name(flow.bodies[0]);
    for (k, step) in model.steps.iter().enumerate() {
        let place = format!("steps[{k}]");
        let message = format!(
            "is not for water that flows, as in `{first}`: take static steps, or newmark, hht, generalized_alpha or explicit, or leave out \
             pore_fluid.permeability"
        );
        let is_quasi_static_or_dynamic = step.scheme == Scheme::Static || step.scheme.coefficients().is_some();
        let serves = step.scheme.is_explicit() || is_quasi_static_or_dynamic && step.scheme.theta() == 1.0;
        refuse_if(!serves, format!("{place}.scheme"), message)?;
    }
    let tied = |node: usize| flow.of_node.get(node).copied().flatten().is_some();
    let is_periodic = |pair: &&(usize, usize)| tied(pair.0) && tied(pair.1);
    let of_plates = |node: usize| model.plates.iter().any(|plate| plate.binary_search(&node).is_ok());
    let mut pairs = model.ties.pairs().iter().filter(is_periodic);
    let message =
        format!("join sides of `{first}`, whose water flows, and its pressure would not follow: leave them out");
    refuse_if(pairs.any(|pair| !of_plates(pair.0)), "periodic", message)?;
    for (pair, contact) in model.contacts.iter().zip(contacts) {
        check_contact(pair, contact, model)?;
    }
    let message = format!(
        "is heated, and its water flows: thermal expansion of flowing water is not modelled; leave out one of them \
        (`{first}`)"
    );
    let heated = flow.bodies.iter().find(|&&body| model.bodies[body].thermal.is_some());
    heated.map_or(Ok(()), |&body| Err(ModelError::new(format!("bodies.{}.thermal", name(body)), message)))
}

/// Friction goes by the effective pressure: of flowing water a contact of a body with itself knows only what it is told.
fn check_contact(pair: &ContactPair, contact: &Contact, model: &Model) -> Checked<()> {
    let nodes: Vec<usize> = pair.nodes().collect();
    let flows =
        |body: &&Body| body.flowing().is_some() && nodes.iter().any(|node| body.nodes.binary_search(node).is_ok());
    let Some(body) = model.bodies.iter().find(flows) else { return Ok(()) };
    let place = format!("contacts.{}", pair.name);
    let message = format!(
        "of bodies is not for body `{}`, whose water flows: leave it out, and the contact has the pressure of that water",
        body.name
    );
    let of_bodies = matches!(contact.fluid_pressure, Some(FluidPressure::OfBodies));
    refuse_if(of_bodies, format!("{place}.fluid_pressure"), message)?;
    let by_pressure = pair.laws.iter().any(|law| {
        let law = &law.description;
        !law.is_frictionless && law.least_coefficient.is_none_or(|least| least > NO_FRICTION)
    });
    let message = format!(
        "depends on the total pressure, part of which is carried by the water that flows in body `{}`: give the \
         pressure of the water at the contact (`fluid_pressure`, by place and time), or a strength by total stress \
         (friction law `adhesion`), or none (`frictionless`)",
        body.name
    );
    refuse_if(by_pressure && !pair.tied && !pair.holds_fluid(), format!("{place}.friction"), message)
}

/// Outlets in force, by place.
#[derive(Clone, Debug, Default)]
pub struct DrainsInForce {
    all: BTreeMap<String, (DrainageInput, String)>,
}

impl DrainsInForce {
    /// Goes on to the next step; returns its outlets, numbered by their place among `names`.
    pub fn step(
        &mut self,
        given: &[DrainageInput],
        place: &str,
        names: &[String],
        absent: &[bool],
        model: &Model,
    ) -> Checked<Vec<Drain>> {
        for (k, entry) in given.iter().enumerate() {
            let place = format!("{place}.drainage[{k}]");
            check_entry(entry, &place)?;
            let on = entry.on.in_words(&model.mesh);
            let message = format!("`{on}` is named twice in this step: name it once");
            let twice = given[..k].iter().any(|other| other.on.in_words(&model.mesh) == on);
            refuse_if(twice, format!("{place}.on"), message)?;
            if entry.impervious == Some(true) {
                let message = format!("no earlier step drains `{on}`: leave it out");
                refuse_if(self.all.remove(&on).is_none(), format!("{place}.impervious"), message)?;
            } else {
                self.all.insert(on, (entry.clone(), place));
            }
        }
        let away = |wet: &WetElement| absent.get(model.body_of_element[wet.element]).copied().unwrap_or(false);
        let mut drains = Vec::new();
        for (name, (entry, origin)) in &self.all {
            let outlet = names.iter().position(|other| other == name).unwrap_or_default();
            let drain = drain(entry, outlet, origin, away, model)?;
            let message = "is on bodies that are not there in this step: leave it out, or give it when they are";
            let is_new = origin.starts_with(&format!("{place}.drainage"));
            refuse_if(drain.corners.is_empty() && is_new, format!("{origin}.on"), format!("`{name}` {message}"))?;
            drains.push(drain);
        }
        drains.retain(|drain| !drain.corners.is_empty());
        Ok(drains)
    }
}

/// Names of all outlets of some steps.
pub fn outlets<'a>(given: impl Iterator<Item = &'a DrainageInput>, mesh: &Mesh) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for entry in given {
        let name = entry.on.in_words(mesh);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

fn check_entry(entry: &DrainageInput, place: &str) -> Checked<()> {
    let DrainageInput { pressure, head, seepage, flux, impervious, filter, .. } = entry;
    let given = [pressure.is_some(), head.is_some(), seepage.is_some(), flux.is_some(), impervious.is_some()];
    let message = "needs exactly one of pressure, head, seepage, flux and impervious";
    refuse_if(given.iter().filter(|is| **is).count() != 1, place, message)?;
    for (key, value) in [("seepage", seepage), ("impervious", impervious)] {
        let message = "is false: leave the entry out, or end it by \"impervious\": true";
        refuse_if(*value == Some(false), format!("{place}.{key}"), message)?;
    }
    for (key, value) in [("pressure", pressure), ("head", head), ("flux", flux)] {
        value.as_ref().map_or(Ok(()), |value| check_in_time(value, &format!("{place}.{key}")))?;
    }
    let message = "is for a pressure or a head: leave it out";
    refuse_if(filter.is_some() && pressure.is_none() && head.is_none(), format!("{place}.filter"), message)?;
    check_positive(&format!("{place}.filter"), filter.unwrap_or(1.0), "")
}

/// An outlet, with the pressures of its corners on bodies that are there.
fn drain(
    entry: &DrainageInput,
    outlet: usize,
    place: &str,
    away: impl Fn(&WetElement) -> bool,
    model: &Model,
) -> Checked<Drain> {
    let on = format!("{place}.on");
    let Some(flow) = &model.flow else {
        let message = "is for bodies whose water flows, and there are none: give pore_fluid.permeability of a body";
        return Err(ModelError::new(place, message));
    };
    let mut areas: BTreeMap<usize, f64> = BTreeMap::new();
    let mut conductance = 0.0f64;
    let dry = format!("`{}` is on no body whose water flows: give pore_fluid.permeability of the body there", entry.on);
    let group = match &entry.on {
        Place::Group(name) => model.mesh.groups.get(name),
        _ => None,
    };
    if let Some(Group::Edges(edges)) = group {
        for edge in edges {
            let wet = flow.wet(edge.element).ok_or_else(|| ModelError::new(&on, &dry))?;
            if away(wet) {
                continue;
            }
            conductance = conductance.max(wet.mobility[0].max(wet.mobility[1]) / wet.size);
            for (k, area) in shares(edge, flow, &model.mesh) {
                *areas.entry(k).or_default() += area;
            }
        }
    } else {
        let message = "is a body: name its sides, or nodes";
        refuse_if(matches!(group, Some(Group::Elements(_))), &on, format!("`{}` {message}", entry.on))?;
        let message = "needs edges: name a group of edges";
        refuse_if(entry.filter.is_some(), format!("{place}.filter"), message)?;
        let nodes = nodes_at(&model.mesh, &entry.on, &on)?;
        // A node in the middle of an edge has no pressure of its own.
        let pressures: BTreeSet<usize> =
            nodes.iter().filter_map(|&node| flow.of_node.get(node).copied().flatten()).collect();
        refuse_if(pressures.is_empty(), &on, &dry)?;
        let there = flow.elements.iter().filter(|wet| !away(wet)).flat_map(|wet| &wet.pressures);
        areas.extend(there.filter(|k| pressures.contains(k)).map(|&k| (k, 1.0)));
        let own = |wet: &&WetElement| wet.pressures.iter().any(|k| areas.contains_key(k));
        let flows = flow
            .elements
            .iter()
            .filter(own)
            .map(|wet| wet.mobility[0].max(wet.mobility[1]) * wet.volumes.iter().sum::<f64>() / wet.size.powi(2));
        conductance = flows.fold(0.0, f64::max);
    }
    let weight = |k: usize| {
        let mut adjacent = flow.elements.iter().filter(|wet| wet.pressures.contains(&k));
        adjacent.find(|wet| wet.weight > 0.0).map(|wet| wet.weight)
    };
    let first = areas.keys().next().copied().unwrap_or_default();
    let message = "is for water that weighs: give \"weighs\": true in pore_fluid, or the `pressure`";
    refuse_if(entry.head.is_some() && !areas.is_empty() && weight(first).is_none(), format!("{place}.head"), message)?;
    let kind = match entry {
        DrainageInput { flux: Some(_), .. } => DrainKind::Flux,
        DrainageInput { seepage: Some(_), .. } => DrainKind::Seeps(PRESCRIBED * conductance),
        _ => DrainKind::Conducts(entry.filter.unwrap_or(PRESCRIBED * conductance)),
    };
    let value = entry.pressure.clone().or(entry.head.clone()).or(entry.flux.clone()).unwrap_or_default();
    let at = |k: usize| model.mesh.nodes[flow.corners[k]];
    let corners: Vec<_> = areas.into_iter().map(|(k, area)| (k, at(k), area)).collect();
    for &(_, at, _) in &corners {
        let found = value.value(at);
        let message = format!("is {} at {} at the start: must be a finite number", number(found), vector(at));
        refuse_if(!found.is_finite(), place, message)?;
    }
    let head = entry.head.as_ref().and_then(|_| weight(first));
    Ok(Drain { outlet, corners, kind, value, head })
}

/// Area of an edge at the pressures of its ends, ∫ N ds, N being linear between them.
fn shares(edge: &Edge, flow: &PoreFlow, mesh: &Mesh) -> Vec<(usize, f64)> {
    let count = edge.nodes.len();
    let mut areas = [0.0; 2];
    for (xi, weight) in crate::mesh::shape::gauss(3) {
        let x = mesh.undeformed();
        let slope: Vec<(usize, f64)> =
            edge.nodes.iter().copied().zip(crate::mesh::shape::edge_derivatives(count, xi)).collect();
        let at: Vec<(usize, f64)> =
            edge.nodes.iter().copied().zip(crate::mesh::shape::edge_values(count, xi)).collect();
        let area = weight * x.combine(&slope).norm() * x.weight(&at);
        areas[0] += 0.5 * (1.0 - xi) * area;
        areas[1] += 0.5 * (1.0 + xi) * area;
    }
    let pressure = |node: usize| flow.of_node.get(node).copied().flatten();
    edge.nodes.iter().take(2).zip(areas).filter_map(|(&node, area)| Some((pressure(node)?, area))).collect()
}
