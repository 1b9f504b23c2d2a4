//! Bars of a model: their nodes, which are added to the mesh first, and their parts.

use std::collections::BTreeSet;

use nalgebra::Vector2;

use super::bar::{BarBond, BarEnd, BarInput};
use super::error::{Checked, ModelError, check_not_negative, check_place, check_positive, check_size, refuse_if};
use super::groups::{group, kind};
use crate::bars::Bar;
use crate::bars::grip::Grip;
use crate::bars::segment::Segment;
use crate::bars::turn::Turn;
use crate::bars::vectors::{Linear, Vectors, Vertex};
use crate::laws::friction::{Bond, BondParameters, BondSurfaces};
use crate::mesh::boxes::{Box2, Tree};
use crate::mesh::outline::chain;
use crate::mesh::{Edge, Group, Mesh};
use crate::model::Model;

/// Number of segments of a beam, by default.
const OF_BEAM: usize = 20;

/// Largest number of segments of a bar.
const MOST: usize = 100_000;

/// Distance of a point from a node, relative to the size of the mesh, below which it is that node.
const SAME: f64 = 1e-9;

/// Share of a node in a point below which it has none.
const NO_SHARE: f64 = 1e-9;

/// Stiffness of a penalty along a bar in (λ + 2G)/(length of a segment).
const PENALTY: f64 = 100.0;

/// A point in an element.
#[derive(Clone)]
struct Host {
    element: usize,
    at: [f64; 2],
    body: String,
}

/// A bar whose nodes are in the mesh.
pub struct Laid {
    vertices: Vec<Vertex>,
    /// Where each vertex lies, for a bar with bond
    hosts: Vec<Host>,
    own: Vec<usize>,
    bodies: BTreeSet<String>,
    /// Directions that the ends keep
    clamps: [Option<Linear>; 2],
}

/// Elements of some bodies, by place.
struct Bodies<'m> {
    mesh: &'m Mesh,
    elements: Vec<(usize, String)>,
    tree: Tree,
}

impl<'m> Bodies<'m> {
    fn of(names: &[String], mesh: &'m Mesh, place: &str) -> Checked<Self> {
        let mut elements = Vec::new();
        for name in names {
            match group(mesh, name, place)? {
                Group::Elements(own) => elements.extend(own.iter().map(|&element| (element, name.clone()))),
                other => {
                    let message = format!("`{name}` is a group of {}, not a body", kind(other));
                    return Err(ModelError::new(place, message));
                }
            }
        }
        let tree = Tree::new(elements.iter().map(|(element, _)| mesh.reach(*element)));
        Ok(Self { mesh, elements, tree })
    }

    fn find(&self, at: Vector2<f64>) -> Option<Host> {
        let near = self.tree.meeting(&Box2 { low: at, high: at });
        near.into_iter().find_map(|k| {
            let (element, body) = &self.elements[k];
            let at = self.mesh.coordinates(*element, at)?;
            Some(Host { element: *element, at, body: body.clone() })
        })
    }

    fn host(&self, at: Vector2<f64>, place: &str) -> Checked<Host> {
        self.find(at).ok_or_else(|| {
            let names: BTreeSet<&str> = self.elements.iter().map(|(_, name)| name.as_str()).collect();
            let names: Vec<String> = names.into_iter().map(|name| format!("`{name}`")).collect();
            let nodes = self.elements.iter().flat_map(|(element, _)| &self.mesh.elements[*element].nodes);
            let far = |node: &&usize| (self.mesh.nodes[**node] - at).norm();
            let nearest = nodes.min_by(|a, b| far(a).total_cmp(&far(b)));
            let nearest = nearest.map_or(String::new(), |&node| {
                let x = self.mesh.nodes[node];
                format!("; its nearest node is at ({}, {})", x.x, x.y)
            });
            let message = format!("the point ({}, {}) lies outside of {}{nearest}", at.x, at.y, names.join(" and "));
            ModelError::new(place, message)
        })
    }

    /// Mean length of an element [L].
    fn size(&self) -> f64 {
        let area = |element: &usize| {
            let corners = self.mesh.elements[*element].kind.corners();
            let x = &self.mesh.places(*element)[..corners];
            0.5 * (0..corners).map(|k| (x[k] - x[0]).perp(&(x[(k + 1) % corners] - x[0]))).sum::<f64>()
        };
        let total: f64 = self.elements.iter().map(|(element, _)| area(element)).sum();
        (total / self.elements.len().max(1) as f64).sqrt()
    }
}

/// The point of an element as a vertex: a node where it is one.
fn vertex(mesh: &Mesh, host: &Host, at: Vector2<f64>, near: f64) -> Vertex {
    let element = &mesh.elements[host.element];
    if let Some(&node) = element.nodes.iter().find(|node| (mesh.nodes[**node] - at).norm() <= near) {
        return Vertex::node(node, mesh.nodes[node]);
    }
    let values = element.kind.values(host.at);
    let all = element.nodes.iter().copied().zip(values).filter(|(_, n)| n.abs() > NO_SHARE);
    let (nodes, shares): (Vec<usize>, Vec<f64>) = all.unzip();
    let total: f64 = shares.iter().sum();
    Vertex { at, nodes, weights: shares.into_iter().map(|n| n / total).collect() }
}

/// Adds the nodes of the bars to a mesh.
pub fn lay(given: &[(String, BarInput)], mesh: &mut Mesh) -> Checked<Vec<Laid>> {
    let mut laid: Vec<Option<Laid>> = given.iter().map(|_| None).collect();
    let number = |name: &String| given.iter().position(|(known, _)| known == name);
    let joins = |bar: &BarInput| -> Vec<usize> {
        [&bar.start, &bar.end].into_iter().flatten().filter_map(|end| number(end.on.as_ref()?)).collect()
    };
    for (name, bar) in given {
        check(name, bar, mesh)?;
    }
    // A bar that is joined to another one comes after it.
    while let Some(k) =
        (0..given.len()).find(|&k| laid[k].is_none() && joins(&given[k].1).iter().all(|&other| laid[other].is_some()))
    {
        let (name, bar) = &given[k];
        let others = |name: &String| number(name).and_then(|other| laid[other].as_ref());
        laid[k] = Some(lay_one(name, bar, others, mesh)?);
    }
    if let Some(k) = laid.iter().position(Option::is_none) {
        let message = "is joined to a bar that is joined to it in turn: give `on` at one of the two ends alone";
        return Err(ModelError::new(format!("bars.{}", given[k].0), message));
    }
    Ok(laid.into_iter().flatten().collect())
}

/// Checks what a bar says of itself.
fn check(name: &str, bar: &BarInput, mesh: &Mesh) -> Checked<()> {
    let place = format!("bars.{name}");
    let at = |key: &str| format!("{place}.{key}");
    let message = "is also the name of a group of the mesh, so supports would be ambiguous: rename it";
    refuse_if(mesh.groups.contains_key(name), &place, message)?;
    let message = "a bar in axisymmetry would be a shell, which is not available: take plane strain, or model it as a \
        body";
    refuse_if(mesh.section.is_axisymmetric(), &place, message)?;
    let message = "give either `points`, two or more, or `on`, a group of lines";
    refuse_if(bar.points.is_empty() == bar.on.is_none(), &place, message)?;
    refuse_if(bar.on.is_none() && bar.points.len() < 2, at("points"), "is one point: give two or more")?;
    check_place(&at("points"), bar.points.iter().flatten().copied())?;
    if let Some(k) = bar.points.windows(2).position(|two| two[0] == two[1]) {
        let message = "is the point before it: leave it out";
        return Err(ModelError::new(format!("{place}.points[{}]", k + 1), message));
    }
    check_positive(&at("ea"), bar.ea, "")?;
    check_size(&place, "ea", bar.ea)?;
    check_not_negative(&at("ei"), bar.ei)?;
    check_not_negative(&at("mass"), bar.mass)?;
    check_not_negative(&at("damping.mass"), bar.damping.mass)?;
    check_not_negative(&at("damping.stiffness"), bar.damping.retardation)?;
    let message = "has no effect on a bar without mass: give `mass`, or damp by stiffness";
    refuse_if(bar.damping.mass > 0.0 && bar.mass == 0.0, at("damping.mass"), message)?;
    check_positive(&at("limit"), bar.limit.unwrap_or(1.0), " (leave it out for none)")?;
    let message = format!("must be 1 to {MOST}");
    refuse_if(!(1..=MOST).contains(&bar.segments.unwrap_or(1)), at("segments"), message)?;
    let message = "shares the nodes of the group, whose sides are its segments: leave `segments` and `embedded` out";
    let shares = bar.on.as_ref().is_some_and(|on| matches!(mesh.groups.get(on), Some(Group::Edges(_))));
    refuse_if(shares && (bar.segments.is_some() || bar.embedded.is_some()), at("on"), message)?;
    for (key, end) in [("start", &bar.start), ("end", &bar.end)] {
        let Some(end) = end else { continue };
        let message = "a truss is hinged at its ends: give `ei`, or leave `clamped` out";
        refuse_if(end.clamped && bar.ei == 0.0, format!("{place}.{key}.clamped"), message)?;
        let message = "the group has nodes of a body, to which the bar is joined already: leave `on` of the end out";
        refuse_if(shares && end.on.is_some(), format!("{place}.{key}.on"), message)?;
        let message = "an embedded bar is joined to its body over its whole length: leave `on` of the end out";
        let moves = bar.embedded.as_ref().is_some_and(|embedded| embedded.bond.is_none());
        refuse_if(moves && end.on.is_some(), format!("{place}.{key}.on"), message)?;
    }
    let is_nowhere = bar.embedded.as_ref().is_some_and(|embedded| embedded.bodies.is_empty());
    refuse_if(is_nowhere, at("embedded.in"), "is empty: name the bodies in which the bar lies")?;
    let legs = bar.points.len().saturating_sub(1);
    let is_chain = bar.ei == 0.0 && bar.embedded.is_none() && bar.segments.is_some_and(|number| number > legs);
    let message = "a truss divided into segments is a chain that folds: leave `segments` out, or give `ei`";
    refuse_if(is_chain && !shares, at("segments"), message)?;
    bar.embedded.as_ref().and_then(|embedded| embedded.bond).map_or(Ok(()), |bond| check_bond(&place, bond))
}

/// Checks a bond.
fn check_bond(place: &str, bond: BarBond) -> Checked<()> {
    let at = |key: &str| format!("{place}.embedded.bond.{key}");
    let BarBond { stiffness, strength, residual, slip, mu, normal } = bond;
    check_not_negative(&at("mu"), mu)?;
    for (key, value) in [("stiffness", stiffness), ("strength", strength), ("slip", slip), ("normal", normal)] {
        check_positive(&at(key), value.unwrap_or(1.0), "")?;
    }
    let message = "belongs to a `strength`, which is missing: give it";
    refuse_if(strength.is_none() && residual.is_some(), at("residual"), message)?;
    refuse_if(strength.is_none() && slip.is_some(), at("slip"), message)?;
    let (Some(strength), Some(residual)) = (strength, residual) else { return Ok(()) };
    let message = format!("is {residual}: it must lie between zero and `strength`, which is {strength}");
    refuse_if(!(0.0..=strength).contains(&residual), at("residual"), message)
}

/// Positions of the points along a bar, and how often each leg between them is divided.
fn course(place: &str, bar: &BarInput, mesh: &Mesh, bodies: Option<&Bodies>) -> Checked<Vec<Vector2<f64>>> {
    let corners: Vec<Vector2<f64>> = match &bar.on {
        Some(on) => match mesh.group(on).map_err(|error| ModelError::new(format!("{place}.on"), error))? {
            Group::Lines(lines) => {
                chain(lines).map_err(|defect| ModelError::new(format!("{place}.on"), format!("`{on}`: {defect}")))?
            }
            other => {
                let message = format!("`{on}` is a group of {}, not of lines", kind(other));
                return Err(ModelError::new(format!("{place}.on"), message));
            }
        },
        None => bar.points.iter().map(|point| Vector2::from(*point)).collect(),
    };
    let lengths: Vec<f64> = corners.windows(2).map(|two| (two[1] - two[0]).norm()).collect();
    let total: f64 = lengths.iter().sum();
    let by_size = |length: f64| bodies.map(|bodies| (length / bodies.size()).ceil());
    let number = |length: f64| -> usize {
        let parts = match (bar.segments, by_size(length)) {
            (Some(number), _) => (number as f64 * length / total).round(),
            (None, Some(parts)) => parts,
            (None, None) if bar.ei > 0.0 => (OF_BEAM as f64 * length / total).round(),
            (None, None) => 1.0,
        };
        (parts as usize).clamp(1, MOST)
    };
    let mut points = vec![corners[0]];
    for (ends, length) in corners.windows(2).zip(lengths) {
        let count = number(length);
        let share = |k: usize| k as f64 / count as f64;
        points.extend((1..count).map(|k| ends[0] * (1.0 - share(k)) + ends[1] * share(k)));
        points.push(ends[1]);
    }
    Ok(points)
}

/// Nodes along the one chain that the edges of a group form.
fn nodes_along(edges: &[Edge], place: &str) -> Checked<Vec<usize>> {
    let parts: Vec<Vec<usize>> = edges
        .iter()
        .map(|edge| match edge.nodes[..] {
            [start, end, middle] => vec![start, middle, end],
            _ => edge.nodes.clone(),
        })
        .collect();
    let ends: BTreeSet<usize> = parts.iter().filter_map(|part| part.last().copied()).collect();
    let first = parts.iter().find(|part| !ends.contains(&part[0]));
    let refused = || {
        let message = "the edges must form one open line: give each of its pieces a group and a bar of its own";
        ModelError::new(place, message)
    };
    let mut nodes = first.ok_or_else(refused)?.clone();
    while let Some(part) =
        parts.iter().find(|part| nodes.last() == part.first()).filter(|_| nodes.len() <= 3 * parts.len())
    {
        nodes.extend(&part[1..]);
    }
    let count = 1 + parts.iter().map(|part| part.len() - 1).sum::<usize>();
    if nodes.len() == count { Ok(nodes) } else { Err(refused()) }
}

/// Adds the nodes of one bar.
fn lay_one<'l>(
    name: &str,
    bar: &BarInput,
    other: impl Fn(&String) -> Option<&'l Laid>,
    mesh: &mut Mesh,
) -> Checked<Laid> {
    let place = format!("bars.{name}");
    let near = SAME * mesh.size_of(0..mesh.nodes.len());
    let mut laid = Laid {
        vertices: Vec::new(),
        hosts: Vec::new(),
        own: Vec::new(),
        bodies: BTreeSet::new(),
        clamps: [None, None],
    };
    let shared = bar.on.as_ref().and_then(|on| match mesh.groups.get(on) {
        Some(Group::Edges(edges)) => Some(nodes_along(edges, &format!("{place}.on"))),
        _ => None,
    });
    if let Some(nodes) = shared {
        laid.vertices = nodes?.into_iter().map(|node| Vertex::node(node, mesh.nodes[node])).collect();
    } else {
        let embedded = bar.embedded.as_ref();
        let inside = format!("{place}.embedded.in");
        let bodies = embedded.map(|embedded| Bodies::of(&embedded.bodies, mesh, &inside)).transpose()?;
        let points = course(&place, bar, mesh, bodies.as_ref())?;
        let bonds = embedded.is_some_and(|embedded| embedded.bond.is_some());
        let last = points.len() - 1;
        let mut vertices: Vec<Option<Vertex>> = Vec::new();
        for (k, &at) in points.iter().enumerate() {
            let end = [(0, &bar.start), (last, &bar.end)]
                .into_iter()
                .find(|(end, _)| *end == k)
                .and_then(|(_, of)| of.as_ref());
            let mut found = None;
            if let Some(bodies) = &bodies {
                let host = bodies.host(at, &inside)?;
                laid.bodies.insert(host.body.clone());
                found = (!bonds).then(|| vertex(mesh, &host, at, near));
                laid.hosts.push(host);
            }
            let key = if k == 0 { "start" } else { "end" };
            if let Some(joined) = end.and_then(|end| end.on.as_ref()) {
                let place = format!("{place}.{key}.on");
                found = Some(joined_to(joined, at, near, &other, mesh, &place, &mut laid.bodies)?);
            }
            vertices.push(found);
        }
        let free = |vertex: Option<Vertex>, at: Vector2<f64>| {
            vertex.unwrap_or_else(|| {
                let tag = mesh.node_tags.iter().max().map_or(0, |tag| tag.saturating_add(1));
                mesh.nodes.push(at);
                mesh.node_tags.push(tag);
                mesh.bar_nodes += 1;
                laid.own.push(mesh.nodes.len() - 1);
                Vertex::node(mesh.nodes.len() - 1, at)
            })
        };
        laid.vertices = vertices
            .into_iter()
            .zip(points)
            .map({
                let mut free = free;
                move |(vertex, at)| free(vertex, at)
            })
            .collect();
    }
    for (end, which) in [&bar.start, &bar.end].into_iter().zip(0..2) {
        laid.clamps[which] =
            end.as_ref().filter(|end| end.clamped).map(|end| clamp(end, which, &laid, &other, mesh)).transpose()?;
    }
    name_groups(name, &laid, mesh)?;
    Ok(laid)
}

/// The vertex of a body or another bar at an end.
fn joined_to<'l>(
    name: &String,
    at: Vector2<f64>,
    near: f64,
    other: impl Fn(&String) -> Option<&'l Laid>,
    mesh: &Mesh,
    place: &str,
    bodies: &mut BTreeSet<String>,
) -> Checked<Vertex> {
    if let Some(bar) = other(name) {
        let far = |vertex: &&Vertex| (vertex.at - at).norm();
        let nearest = bar.vertices.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
        let Some(nearest) = nearest.filter(|vertex| far(vertex) > near) else {
            return nearest.cloned().ok_or_else(|| ModelError::new(place, "has no points"));
        };
        let message = format!(
            "the bar `{name}` has no point at ({}, {}), where this end is; its nearest is at ({}, {}): end there",
            at.x, at.y, nearest.at.x, nearest.at.y
        );
        return Err(ModelError::new(place, message));
    }
    if !mesh.groups.contains_key(name) {
        let message = format!("there is no body and no bar `{name}`: name one, or leave `on` out for a free end");
        return Err(ModelError::new(place, message));
    }
    if let Some(Group::Nodes(nodes)) = mesh.groups.get(name) {
        let node = nodes.iter().copied().find(|node| (mesh.nodes[*node] - at).norm() <= near);
        let message = format!("`{name}` has no point at ({}, {}), where this end is", at.x, at.y);
        return node.map(|node| Vertex::node(node, at)).ok_or_else(|| ModelError::new(place, message));
    }
    let host = Bodies::of(std::slice::from_ref(name), mesh, place)?.host(at, place)?;
    bodies.insert(host.body.clone());
    Ok(vertex(mesh, &host, at, near))
}

/// The direction that a clamped end keeps: a line of the body, a segment of the other bar, or one in space.
fn clamp<'l>(
    end: &BarEnd,
    which: usize,
    laid: &Laid,
    other: impl Fn(&String) -> Option<&'l Laid>,
    mesh: &Mesh,
) -> Checked<Linear> {
    let count = laid.vertices.len();
    let ends = if which == 0 { [0, 1] } else { [count - 2, count - 1] };
    let edge = Linear::between(&laid.vertices[ends[0]], &laid.vertices[ends[1]]);
    let at = laid.vertices[if which == 0 { 0 } else { count - 1 }].at;
    let Some(name) = &end.on else {
        return Ok(Linear::fixed(edge.at));
    };
    if let Some(bar) = other(name) {
        let far = |two: &&[Vertex]| (two[0].at - at).norm().min((two[1].at - at).norm());
        let segment = bar.vertices.windows(2).min_by(|a, b| far(a).total_cmp(&far(b)));
        return Ok(segment.map_or(Linear::fixed(edge.at), |two| Linear::between(&two[0], &two[1])));
    }
    if let Some(Group::Nodes(_)) = mesh.groups.get(name) {
        return Ok(Linear::fixed(edge.at));
    }
    let host = Bodies::of(std::slice::from_ref(name), mesh, "")?.host(at, "")?;
    let slopes = mesh.gradients(host.element, host.at).unwrap_or_default();
    Ok(Linear { at: edge.at, terms: slopes.into_iter().map(|(node, slope)| (node, slope.dot(&edge.at))).collect() })
}

/// Gives the nodes of a bar, and its ends, a group.
fn name_groups(name: &str, laid: &Laid, mesh: &mut Mesh) -> Checked<()> {
    let node = |vertex: &Vertex| (vertex.nodes.len() == 1).then(|| vertex.nodes[0]);
    let mut all: Vec<usize> = laid.vertices.iter().filter_map(node).collect();
    all.sort_unstable();
    let ends = [("start", laid.vertices.first()), ("end", laid.vertices.last())];
    let ends = ends.into_iter().filter_map(|(end, vertex)| Some((format!("{name}_{end}"), vec![node(vertex?)?])));
    let groups: Vec<(String, Vec<usize>)> = ends.chain([(name.to_owned(), all)]).collect();
    for (group, nodes) in groups.into_iter().filter(|(_, nodes)| !nodes.is_empty()) {
        let message = format!("names a group `{group}`, which the mesh has already: rename it");
        refuse_if(mesh.groups.contains_key(&group), format!("bars.{name}"), message)?;
        mesh.groups.insert(group, Group::Nodes(nodes));
    }
    Ok(())
}

/// Builds the bars.
pub fn bars(given: &[(String, BarInput)], laid: Vec<Laid>, model: &Model) -> Checked<Vec<Bar>> {
    given.iter().zip(laid).map(|((name, input), laid)| bar(name, input, laid, model)).collect()
}

fn bar(name: &str, input: &BarInput, laid: Laid, model: &Model) -> Checked<Bar> {
    let edges: Vec<Linear> = laid.vertices.windows(2).map(|two| Linear::between(&two[0], &two[1])).collect();
    let segment = |edge: &Linear| Segment { vectors: Vectors::one(edge), length: edge.at.norm() };
    let segments: Vec<Segment> = edges.iter().map(segment).collect();
    let last = laid.vertices.len() - 1;
    let mut turns = Vec::new();
    if input.ei > 0.0 {
        let half = |k: usize| 0.5 * segments[k].length;
        let turn =
            |vertex: usize, both: [&Linear; 2], length: f64| Turn { vectors: Vectors::new(both), vertex, length };
        let [start, end] = &laid.clamps;
        turns.extend(start.as_ref().map(|clamp| turn(0, [clamp, &edges[0]], half(0))));
        let inner = |k: usize| turn(k, [&edges[k - 1], &edges[k]], half(k - 1) + half(k));
        turns.extend((1..last).map(inner));
        turns.extend(end.as_ref().map(|clamp| turn(last, [&edges[last - 1], clamp], half(last - 1))));
    }
    let mut grips = Vec::new();
    if let Some(bond) = input.embedded.as_ref().and_then(|embedded| embedded.bond) {
        for (k, edge) in edges.iter().enumerate() {
            for vertex in [k, k + 1] {
                grips.push(grip(name, bond, vertex, edge, &laid, model)?);
            }
        }
    }
    let inner = laid.vertices[1..last].iter().flat_map(|vertex| &vertex.nodes);
    let is_free_between = inner.into_iter().any(|node| laid.own.binary_search(node).is_ok());
    Ok(Bar {
        name: name.into(),
        ea: input.ea,
        ei: input.ei,
        limit: input.limit.unwrap_or(f64::INFINITY),
        mass: input.mass,
        drag: input.damping.mass,
        retardation: input.damping.retardation,
        vertices: laid.vertices,
        segments,
        turns,
        grips,
        bodies: laid.bodies.into_iter().collect(),
        own: laid.own,
        is_free_between,
    })
}

/// The bond at an end of a segment.
fn grip(name: &str, given: BarBond, k: usize, edge: &Linear, laid: &Laid, model: &Model) -> Checked<Grip> {
    let (host, bar) = (&laid.hosts[k], &laid.vertices[k]);
    let size = edge.at.norm();
    let depth = model.mesh.section.weight(bar.at);
    // Along one line all are the same to the bit, as the resolved case tells them.
    let straight = laid.vertices[laid.vertices.len() - 1].at - laid.vertices[0].at;
    let even = straight.norm() / (laid.vertices.len() - 1) as f64;
    let spacing = if (even - size).abs() <= SAME * size { even } else { size };
    let penalty = PENALTY * model.body_of(host.element).material.description().p_wave_modulus * depth / spacing;
    let stiffness = given.stiffness.unwrap_or(penalty);
    let place = format!("bars.{name}.embedded.bond");
    let message =
        "depends on the total pressure in the body, which includes that of its pore_fluid: give `strength` instead";
    refuse_if(given.mu > 0.0 && model.body_of(host.element).pore_fluid.is_some(), format!("{place}.mu"), message)?;
    let otherwise = if given.mu > 0.0 { f64::MIN_POSITIVE } else { f64::MAX };
    let mut parameters = BondParameters::new(given.strength.unwrap_or(otherwise));
    (parameters.residual, parameters.slip) = (given.residual, given.slip);
    if let (Some(strength), Some(slip)) = (given.strength, given.slip) {
        let least = (strength - given.residual.unwrap_or(0.0)) / stiffness;
        let message = format!(
            "is {slip}: the strength would fall faster than the stiffness {stiffness:e} unloads; make it longer than {least:e}, or \
             raise `stiffness`"
        );
        refuse_if(slip <= least, format!("{place}.slip"), message)?;
    }
    let bond = Bond::new(&parameters, BondSurfaces::new(stiffness, stiffness, 0.0));
    let bond = bond.map_err(|error| ModelError::new(&place, error))?;
    let body = vertex(&model.mesh, host, bar.at, 0.0);
    let vectors = Vectors::new([&Linear::bonded(&body, bar), edge]);
    let normal = given.normal.unwrap_or(penalty);
    Ok(Grip { vectors, vertex: k, element: host.element, length: 0.5 * size, bond, mu: given.mu * depth, normal })
}
