//! The conduit along a contact that is built from the input of its water.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector2;

use super::conduit_input::FlowWell;
use super::contact::Contact;
use super::error::{Checked, ModelError, check_finite, refuse_if};
use super::fluid::FluidPressure;
use super::friction::check_in_time;
use super::groups::{edges, node_lists};
use crate::contact::conduit::{Conduit, Gives, Leak, Line, Piece, SourceAt, Transmissivity, Well};
use crate::contact::fluid::Fluid;
use crate::contact::point::{Weights, linear_shares};
use crate::contact::surface::{SlavePoint, in_order};
use crate::mesh::{Group, Mesh};
use crate::model::boundary::Profile;
use crate::model::text::{number, vector};
use crate::model::{Body, Model};

/// Water along the slave of a contact, if it flows there.
pub fn conduit(place: &str, contact: &Contact, points: &[SlavePoint], model: &Model) -> Checked<Option<Conduit>> {
    let Some(FluidPressure::Flow(flow)) = &contact.fluid_pressure else { return Ok(None) };
    let place = &format!("{place}.fluid_pressure.flow");
    let why = "is for a slave of edges, along which water can flow: name such a group";
    refuse_if(matches!(model.mesh.groups.get(&contact.slave), Some(Group::Nodes(_))), place, why)?;
    refuse_if(contact.is_own(), place, "is not for self-contact: name the two parts that touch as slave and master")?;
    let why = "is not for surfaces that wear, which the water's balance does not follow: leave one of them out";
    refuse_if(contact.wear.is_some(), place, why)?;
    flow.check(place)?;
    let line = line(place, contact, model)?;
    let nodes = line.nodes.clone();
    let number_of = |node: usize| nodes.iter().position(|own| *own == model.ties.original(node));
    let shares = points.iter().map(|point| {
        linear_shares(point).into_iter().filter_map(|(node, share)| Some((number_of(node)?, share))).collect()
    });
    let undeformed = model.mesh.undeformed();
    let by_place = |key: &str, profile: &Profile, least: f64| -> Checked<Vec<f64>> {
        let place = format!("{place}.{key}");
        check_in_time(profile, &place)?;
        let message = "is constant in time: the variables are x and y, and not t";
        refuse_if(profile.depends_on_time(), &place, message)?;
        let values: Vec<f64> = nodes.iter().map(|&node| profile.value(model.mesh.nodes[node])).collect();
        let bad = values.iter().zip(&nodes).find(|(value, _)| !(value.is_finite() && **value >= least));
        bad.map_or(Ok(()), |(value, node)| {
            let at = vector(model.mesh.nodes[*node]);
            let needed = if least == 0.0 { "zero or positive" } else { "a finite number" };
            Err(ModelError::new(&place, format!("is {} at {at}: must be {needed}", number(*value))))
        })?;
        Ok(values)
    };
    let at_rest = flow
        .transmissivity
        .as_ref()
        .map_or(Ok(vec![0.0; nodes.len()]), |profile| by_place("transmissivity", profile, 0.0))?;
    let initial = by_place("initial", &flow.initial, 0.0)?;
    let leak = flow.leak.as_ref().map(|leak| {
        let outside = leak.pressure.as_ref();
        let pressure = outside.map_or(Ok(initial.clone()), |profile| by_place("leak.pressure", profile, f64::MIN))?;
        Ok::<_, ModelError>(Leak { coefficient: leak.coefficient, pressure })
    });
    let source = flow.source.clone().map(|profile| {
        check_in_time(&profile, &format!("{place}.source"))?;
        let places = model.mesh.nodes.clone();
        Ok::<SourceAt, ModelError>(Box::new(move |node: usize, time: f64| profile.value_at(places[node], time)))
    });
    let wells = flow.wells.iter().enumerate();
    let wells = wells
        .map(|(k, given)| well(&format!("{place}.wells[{k}]"), given, &line, model))
        .collect::<Checked<Vec<_>>>()?;
    check_distances(place, &wells)?;
    let shares: Vec<Weights> = shares.collect();
    let lengths: Vec<f64> = points.iter().map(|point| point.current_length(&undeformed)).collect();
    let mut holds = vec![0.0; nodes.len()];
    for (shares, length) in shares.iter().zip(&lengths) {
        shares.iter().for_each(|&(node, share)| holds[node] += share * length);
    }
    Ok(Some(Conduit {
        pressures: pressures(place, contact, &line, model)?,
        shares,
        lengths,
        holds,
        storage: flow.storage,
        transmissivity: Transmissivity {
            at_rest,
            per_slip: flow.per_slip,
            aperture: flow.aperture,
            closing: flow.closing,
        },
        viscosity: flow.viscosity,
        initial,
        source: source.transpose()?,
        wells,
        leak: leak.transpose()?,
        error: flow.error,
        line,
    }))
}

/// Numbers of its pressures, beside bodies whose water flows.
fn pressures(place: &str, contact: &Contact, line: &Line, model: &Model) -> Checked<Vec<usize>> {
    let Some(own) = model.flow.as_ref().and_then(|flow| flow.channels.get(&contact.name)) else {
        return Ok(Vec::new());
    };
    let found: Option<Vec<usize>> = line.nodes.iter().map(|node| own.get(node).copied()).collect();
    let message = "is along nodes that are tied to others, and the water of the bodies would not follow: leave it out";
    found.ok_or_else(|| ModelError::new(place, message))
}

/// Contacts along which water flows beside bodies in which it flows, with the nodes of their slaves and their pressures at the start.
pub fn channels(contacts: &[Contact], bodies: &[Body], mesh: &Mesh) -> BTreeMap<String, Vec<(usize, f64)>> {
    let flowing = bodies.iter().filter(|body| body.flowing().is_some());
    let wet: BTreeSet<usize> = flowing.flat_map(|body| body.elements.iter().copied()).collect();
    let sides = |group: Option<&str>| match group.and_then(|name| mesh.groups.get(name)) {
        Some(Group::Edges(edges)) => &edges[..],
        _ => &[],
    };
    let of = |contact: &Contact| {
        let Some(FluidPressure::Flow(flow)) = &contact.fluid_pressure else { return None };
        let slave = sides(Some(&contact.slave));
        let touches_wet = slave.iter().chain(sides(contact.master_group())).any(|edge| wet.contains(&edge.element));
        let nodes: BTreeSet<usize> = slave.iter().flat_map(|edge| edge.nodes.iter().copied()).collect();
        let at = |node: usize| (node, flow.initial.value(mesh.nodes[node]));
        touches_wet.then(|| (contact.name.clone(), nodes.into_iter().map(at).collect()))
    };
    contacts.iter().filter_map(of).collect()
}

/// Nodes along the slave.
fn line(place: &str, contact: &Contact, model: &Model) -> Checked<Line> {
    let name = &contact.slave;
    let edges = in_order(&node_lists(edges(&model.mesh, name, place)?));
    let parts = edges.iter().flat_map(|edge| match edge[..] {
        [a, b, middle] => vec![[a, middle], [middle, b]],
        _ => vec![[edge[0], edge[1]]],
    });
    let undeformed = model.mesh.undeformed();
    let piece = |[a, b]: [usize; 2]| Piece {
        nodes: [a, b].map(|node| model.ties.original(node)),
        length: (model.mesh.nodes[b] - model.mesh.nodes[a]).norm(),
        widths: [a, b].map(|node| undeformed.weight(&[(node, 1.0)])),
    };
    let pieces: Vec<Piece> = parts.map(piece).collect();
    let message = format!("needs a slave whose edges follow each other, and those of `{name}` do not: divide it");
    Line::new(&pieces).ok_or_else(|| ModelError::new(place, message))
}

/// Farthest that a well may be from the slave, over the length of an edge [-]
const NEARLY: f64 = 1e-3;

/// Share of a rate that is round-off of its place [-]
const ROUND_OFF: f64 = 1e-12;

/// A well at its nodes.
fn well(place: &str, given: &FlowWell, line: &Line, model: &Model) -> Checked<Well> {
    let at = Vector2::from(given.at);
    check_finite(&format!("{place}.at"), given.at)?;
    let nodes = &line.nodes;
    let places = || nodes.iter().enumerate().map(|(k, &node)| (k, model.mesh.nodes[node]));
    let (nearest, _) = places()
        .map(|(k, own)| (k, (own - at).norm()))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .ok_or_else(|| ModelError::new(place, "has no place: the slave has no nodes"))?;
    let on_piece = line.pieces().find_map(|(a, b)| {
        let [from, to] = [a, b].map(|k| model.mesh.nodes[nodes[k]]);
        let (way, length) = (to - from, (to - from).norm());
        let share = ((at - from).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
        ((from + way * share - at).norm() <= NEARLY * length).then_some((a, b, share))
    });
    let here = on_piece.ok_or_else(|| {
        let near = vector(model.mesh.nodes[nodes[nearest]]);
        let message = format!("is {}, which is not on the slave: the nearest of its nodes is {near}", vector(at));
        ModelError::new(format!("{place}.at"), message)
    })?;
    let span = [given.from.unwrap_or(f64::NEG_INFINITY), given.until.unwrap_or(f64::INFINITY)];
    refuse_if(
        span.iter().any(|time| time.is_nan()) || span[1] <= span[0],
        format!("{place}.until"),
        "is not after `from`",
    )?;
    let (at, gives, schedule) = match (&given.pressure, &given.rate) {
        (Some(pressure), None) => {
            pressure.check(&format!("{place}.pressure"))?;
            let least = pressure.values().fold(0.0, f64::min);
            let message = format!("is {}: must be zero or positive", number(least));
            refuse_if(least < 0.0, format!("{place}.pressure"), message)?;
            (vec![(nearest, 1.0)], Gives::Pressure(pressure.in_time()), pressure)
        }
        (None, Some(rate)) => {
            rate.check(&format!("{place}.rate"))?;
            let (a, b, share) = here;
            let shared = [(a, 1.0 - share), (b, share)].into_iter().filter(|(_, share)| *share > ROUND_OFF);
            (shared.collect(), Gives::Rate(rate.in_time()), rate)
        }
        _ => return Err(ModelError::new(place, "needs either a `pressure` or a `rate`")),
    };
    Ok(Well { at, gives, span, corners: schedule.corners() })
}

/// No two pressures are prescribed at a node at the same time.
fn check_distances(place: &str, wells: &[Well]) -> Checked<()> {
    let prescribed = |well: &&Well| matches!(well.gives, Gives::Pressure(_));
    for (k, one) in wells.iter().enumerate().filter(|(_, well)| prescribed(well)) {
        let clashes = |other: &&Well| {
            let together = one.span[0].max(other.span[0]) < one.span[1].min(other.span[1]);
            other.at[0].0 == one.at[0].0 && together
        };
        let message =
            "holds a pressure at the same node as another one before it, at the same time: take one well with a table";
        refuse_if(
            wells[..k].iter().filter(prescribed).any(|other| clashes(&other)),
            format!("{place}.wells[{k}]"),
            message,
        )?;
    }
    Ok(())
}

/// The fluid of a contact along which water flows, at the start.
pub fn at_start(conduit: &Conduit, model: &Model) -> Fluid {
    let ties = model.ties.clone();
    conduit.at_start(move |node| ties.original(node))
}
