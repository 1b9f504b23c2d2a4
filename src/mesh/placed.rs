//! Groups by place: sides or nodes of bodies that lie on a line, in a box or on a circle, or that face a direction, also as a part of
//! another group. For meshes without groups of their own, and for sides without their ends.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Edge, Group, Mesh};

/// Distance within which a node lies at a place, relative to the size of the mesh.
const NEAR: f64 = 1e-6;

/// Group of the sides, or nodes, that lie at a place: all conditions given hold for all of their nodes.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct PlacedGroup {
    /// x of the nodes [L]
    pub x: Option<f64>,
    /// y of the nodes [L]
    pub y: Option<f64>,
    /// Box around the nodes: its lower left and its upper right corner [L]
    #[serde(rename = "box")]
    pub within: Option<[[f64; 2]; 2]>,
    /// Circle on which the nodes lie
    pub circle: Option<PlacedCircle>,
    /// Directions between which the outward normal of a side lies, counter-clockwise from the first to the second [degrees from x]:
    /// [45, 135] are sides that face upwards
    pub angle: Option<[f64; 2]>,
    /// A group of the mesh whose nodes are meant, instead of any
    pub of: Option<String>,
    /// Groups of the mesh whose nodes are left out: {"of": "left", "without": ["bottom"], "nodes": true} is a side without its lower end
    pub without: Option<Vec<String>>,
    /// Bodies whose sides or nodes are meant; those of all bodies unless given
    pub bodies: Option<Vec<String>>,
    /// Whether it is a group of nodes, also of those inside bodies, instead of free sides
    #[serde(default)]
    pub nodes: bool,
    /// Distance within which a node lies at the place; a millionth of the size of the mesh unless given [L]
    pub tolerance: Option<f64>,
}

/// A circle.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct PlacedCircle {
    /// Its centre [L]
    pub center: [f64; 2],
    /// Its radius [L]
    pub radius: f64,
}

impl PlacedGroup {
    /// Checks the numbers of a group.
    fn check(&self) -> Result<(), String> {
        let places = [self.x.is_some(), self.y.is_some(), self.within.is_some(), self.circle.is_some()];
        if !places.contains(&true) && self.angle.is_none() && self.of.is_none() {
            return Err("gives no place: give x, y, box, circle, angle or of".into());
        }
        if self.nodes && self.angle.is_some() {
            return Err("has an angle, which nodes do not have: leave out angle, or nodes".into());
        }
        let numbers = [self.x, self.y, self.tolerance].into_iter().flatten();
        let corners = self.within.into_iter().flatten().flatten().chain(self.angle.into_iter().flatten());
        let circle = self.circle.into_iter().flat_map(|circle| [circle.center[0], circle.center[1], circle.radius]);
        if let Some(bad) = numbers.chain(corners).chain(circle).find(|value| !value.is_finite()) {
            return Err(format!("has {bad}: must be finite numbers"));
        }
        if self.within.is_some_and(|[low, high]| low[0] > high[0] || low[1] > high[1]) {
            return Err("has a box whose first corner is not the lower left one: give [[x0, y0], [x1, y1]] with x0 ≤ x1 and y0 ≤ y1".into());
        }
        if self.circle.is_some_and(|circle| circle.radius <= 0.0) {
            return Err("has a circle whose radius is not positive".into());
        }
        if self.tolerance.is_some_and(|tolerance| tolerance < 0.0) {
            return Err("has a negative tolerance".into());
        }
        Ok(())
    }

    /// Whether a node lies at the place, to a distance.
    fn has(&self, at: Vector2<f64>, near: f64) -> bool {
        let is_at = |value: f64, wanted: Option<f64>| wanted.is_none_or(|wanted| (value - wanted).abs() <= near);
        let is_within =
            self.within.is_none_or(|[low, high]| (0..2).all(|i| low[i] - near <= at[i] && at[i] <= high[i] + near));
        let is_on = self
            .circle
            .is_none_or(|PlacedCircle { center, radius }| ((at - Vector2::from(center)).norm() - radius).abs() <= near);
        is_at(at.x, self.x) && is_at(at.y, self.y) && is_within && is_on
    }

    /// Whether a side from `start` to `end`, with its body on the left, faces the asked direction.
    fn faces(&self, start: Vector2<f64>, end: Vector2<f64>) -> bool {
        let along = end - start;
        let direction = (-along.x).atan2(along.y).to_degrees();
        self.angle.is_none_or(|[first, last]| {
            // Round-off must not put a direction at an end of the range outside it.
            let turn = |angle: f64| (angle - first).rem_euclid(360.0);
            let past = turn(direction);
            past <= turn(last) + 1e-6 || past >= 360.0 - 1e-6
        })
    }
}

impl Mesh {
    /// Adds groups of sides and nodes by place.
    ///
    /// # Errors
    /// Returns the name of a group and its defect: numbers that say no place, a body that does not exist, a name that the mesh
    /// has already, or a place where nothing is.
    pub fn with_placed(mut self, groups: &BTreeMap<String, PlacedGroup>) -> Result<Self, (String, String)> {
        if groups.is_empty() {
            return Ok(self);
        }
        let sides = self.sides();
        let near = NEAR * self.size_of(0..self.nodes.len());
        let made = groups.iter().map(|(name, group)| {
            let made = self.placed(name, group, &sides, near);
            made.map(|made| (name.clone(), made)).map_err(|defect| (name.clone(), defect))
        });
        let made = made.collect::<Result<Vec<_>, _>>()?;
        self.groups.extend(made);
        Ok(self)
    }

    /// Free sides of the elements, with their elements.
    fn sides(&self) -> Vec<Edge> {
        let mut owner: BTreeMap<[usize; 2], usize> = BTreeMap::new();
        for (number, element) in self.elements.iter().enumerate() {
            for side in 0..element.kind.corners() {
                let [start, end] = element.kind.edge(side).0.map(|local| element.nodes[local]);
                owner.insert([start, end], number);
            }
        }
        let sides = Self::free_sides(&self.elements).into_iter();
        sides.filter_map(|nodes| owner.get(&[nodes[0], nodes[1]]).map(|&element| Edge { element, nodes })).collect()
    }

    fn placed(&self, name: &str, group: &PlacedGroup, sides: &[Edge], near: f64) -> Result<Group, String> {
        group.check()?;
        if self.groups.contains_key(name) {
            return Err("is a group of the mesh already: choose another name".into());
        }
        let elements = self.elements_of(group.bodies.as_deref())?;
        let near = group.tolerance.unwrap_or(near);
        let of = group.of.as_ref().map(|name| self.nodes_named(name)).transpose()?;
        let without =
            group.without.iter().flatten().map(|name| self.nodes_named(name)).collect::<Result<Vec<_>, _>>()?;
        let is_there = |node: &usize| {
            group.has(self.nodes[*node], near)
                && of.as_ref().is_none_or(|nodes| nodes.contains(node))
                && !without.iter().any(|nodes| nodes.contains(node))
        };
        if group.nodes {
            let nodes = elements.iter().flat_map(|&element| &self.elements[element].nodes).copied();
            let nodes: BTreeSet<usize> = nodes.filter(is_there).collect();
            return match nodes.is_empty() {
                true => Err(format!("has no node: {}", self.extents())),
                false => Ok(Group::Nodes(nodes.into_iter().collect())),
            };
        }
        let faces = |edge: &Edge| group.faces(self.nodes[edge.nodes[0]], self.nodes[edge.nodes[1]]);
        let is_member =
            |edge: &&Edge| elements.contains(&edge.element) && edge.nodes.iter().all(is_there) && faces(edge);
        let edges: Vec<Edge> = sides.iter().filter(is_member).cloned().collect();
        match edges.is_empty() {
            true => Err(format!("has no free side of an element: {}", self.extents())),
            false => Ok(Group::Edges(edges)),
        }
    }

    /// Nodes of a group of the mesh.
    fn nodes_named(&self, name: &str) -> Result<BTreeSet<usize>, String> {
        let group = self.groups.get(name).ok_or_else(|| {
            let known: Vec<&str> = self.groups.keys().map(String::as_str).collect();
            format!("names another group: {}", super::names::not_known(name, &known))
        })?;
        Ok(self.nodes_of(group).into_iter().collect())
    }

    /// Elements of some bodies, or of all.
    fn elements_of(&self, bodies: Option<&[String]>) -> Result<BTreeSet<usize>, String> {
        let Some(bodies) = bodies else { return Ok((0..self.elements.len()).collect()) };
        let mut elements = BTreeSet::new();
        for body in bodies {
            match self.groups.get(body) {
                Some(Group::Elements(list)) => elements.extend(list),
                _ => {
                    let is_body = |(name, group): (&String, &Group)| {
                        matches!(group, Group::Elements(_)).then(|| format!("`{name}`"))
                    };
                    let known: Vec<String> = self.groups.iter().filter_map(is_body).collect();
                    return Err(format!(
                        "names the body `{body}`, which the mesh does not have; it has {}",
                        known.join(", ")
                    ));
                }
            }
        }
        Ok(elements)
    }

    /// Where the mesh is, for messages.
    fn extents(&self) -> String {
        let [low, high] = self.bounding_box();
        format!("the mesh goes from ({}, {}) to ({}, {})", low.x, low.y, high.x, high.y)
    }
}
