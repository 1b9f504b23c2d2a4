//! From the case as written to the model that is solved, with every check that needs the mesh.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use nalgebra::{Matrix2, Vector2};

use super::error::{CaseError, Complaint};
use super::file::{
    Case, CircleInput, Components, ContactInput, DampingInput, DashpotInput, DriveInput, Formulation, IncrementsInput,
    LoadInput, MasterInput, MeshSource, Method, NodeInput, Place, PlaneInput, PointMassInput, PolylineInput,
    RigidInput, RuptureInput, SpringInput, StepInput, TimeInput,
};
use super::method::{Chosen, choose};
use super::{along, initial, names, periodic, supported};
use crate::contact::mortar::{Mortar, mortar_points};
use crate::contact::pair::{ContactPair, Reverse};
use crate::contact::rigid::{Circle, Plane, Polyline, Rigid};
use crate::contact::surface::{Master, SlavePoint, Surface, gauss_points, in_order, lone_point, nodal_points};
use crate::laws::bulk::Material;
use crate::mesh::configuration::Configuration;
use crate::mesh::shape;
use crate::mesh::ties::Ties;
use crate::mesh::{Edge, Group, Mesh, gmsh};
use crate::model::aids::Aids;
use crate::model::boundary::{
    Absorber, Amplitude, Dashpot, DeadLoad, Drive, Expression, FollowerPressure, Loads, Motion, Prescribed, Span,
    Spring,
};
use crate::model::element::{SolidElement, consistent_mass};
use crate::model::scheme::Scheme;
use crate::model::{Body, Damping, Increments, Model, NewtonSettings, PointMass, Rupture, Step, WatchedSet};

/// Largest number of Newton iterations that makes sense to allow.
const MOST_ITERATIONS: usize = 1000;

/// Longest expression that is read; the parser recurses into its brackets [bytes].
const LONGEST_EXPRESSION: usize = 1000;

/// Shortest increment as a share of the run time at its end: below it, round-off would swallow the increment.
const SHORTEST_INCREMENT: f64 = 16.0 * f64::EPSILON;

/// Stiffnesses outside this range cannot be squared in double precision.
const STIFFNESSES: std::ops::RangeInclusive<f64> = 1e-100..=1e100;

type Checked<T> = Result<T, Complaint>;

/// Read the mesh of a case, check everything, and build the model. `path` is the case file.
///
/// # Errors
/// [`CaseError`] names file, key, value and what to do.
pub fn build(case: &Case, path: &Path) -> Result<Model, CaseError> {
    let mesh = read_mesh(case, path)?;
    build_on(case, mesh).map_err(|complaint| complaint.in_file(path))
}

fn read_mesh(case: &Case, path: &Path) -> Result<Mesh, CaseError> {
    match &case.mesh {
        MeshSource::Inline(mesh) => mesh.build().map_err(|error| Complaint::new("mesh", error).in_file(path)),
        MeshSource::File(file) => {
            let mesh_path = path.parent().unwrap_or(Path::new("")).join(file);
            gmsh::read(&mesh_path).map_err(|error| Complaint::new("mesh", error).in_file(path))
        }
    }
}

fn build_on(case: &Case, mesh: Mesh) -> Checked<Model> {
    names::check(case)?;
    let (bodies, body_of_element) = bodies(case, &mesh)?;
    let solids = solids(case, &mesh, &bodies, &body_of_element)?;
    let mut model = Model {
        title: case.title.clone(),
        initial_velocity: vec![0.0; 2 * mesh.nodes.len()],
        massless: vec![false; mesh.nodes.len()],
        mesh,
        bodies,
        ties: Ties::default(),
        point_masses: Vec::new(),
        body_of_element,
        solids,
        contacts: Vec::new(),
        steps: Vec::new(),
        watch: Vec::new(),
        newton: newton_settings(case)?,
        aids: Aids::default(),
        prestress: Vec::new(),
        interval: case.output.interval,
    };
    model.point_masses = point_masses(case, &model.mesh)?;
    model.ties = periodic::ties(&case.periodic, &model.mesh)?;
    model.contacts = contacts(case, &model)?;
    model.massless = massless(case, &model.mesh)?;
    model.prestress = initial::prestress(case, &model);
    model.steps = steps(case, &model)?;
    model.initial_velocity = initial::velocities(case, &model)?;
    model.watch = case.watch.iter().enumerate().map(|(k, name)| watched(&model, k, name)).collect::<Checked<_>>()?;
    if case.output.every == 0 {
        let message = "is 0: must be at least 1 (to write no fields, give \"fields\": false)";
        return Err(Complaint::new("output.every", message));
    }
    if let Some(interval) = case.output.interval.filter(|interval| !(*interval > 0.0 && interval.is_finite())) {
        let message = format!("is {interval}: must be positive (leave it out for a hundredth of each explicit step)");
        return Err(Complaint::new("output.interval", message));
    }
    if let Some(fronts) = case.output.fronts.filter(|fronts| !(fronts.slip_rate > 0.0 && fronts.slip_rate.is_finite()))
    {
        return Err(Complaint::new("output.fronts.slip_rate", format!("is {}: must be positive", fronts.slip_rate)));
    }
    check_explicit(case, &model)?;
    supported::check(case, &model)?;
    Ok(model)
}

/// Nodes of the slaves whose mass is to be moved away.
fn massless(case: &Case, mesh: &Mesh) -> Checked<Vec<bool>> {
    let mut massless = vec![false; mesh.nodes.len()];
    for (name, input) in case.contacts.iter().filter(|(_, input)| input.massless) {
        if input.area.is_some() {
            let message = "is for a slave group of edges, whose elements have the mass: leave it out";
            return Err(Complaint::new(format!("contacts.{name}.massless"), message));
        }
        let slave = edges(mesh, &input.slave, &format!("contacts.{name}.slave"))?;
        slave.iter().flat_map(|edge| &edge.nodes).for_each(|&node| massless[node] = true);
    }
    Ok(massless)
}

/// Explicit steps solve no equations, and so cannot raise pressures until penetrations are small, nor find where a node
/// without mass is. Wilson's equilibrium lies beyond the increment, and so do the multipliers found there.
fn check_explicit(case: &Case, model: &Model) -> Checked<()> {
    let explicit = |step: &Step| step.rupture.is_some() || matches!(step.scheme, Scheme::Explicit { .. });
    let augmented = model.contacts.iter().find(|pair| pair.penetration.is_some());
    if let (Some(pair), Some(step)) = (augmented, model.steps.iter().find(|step| step.scheme.theta() > 1.0)) {
        let message = format!(
            "the step `{}` seeks equilibrium beyond its increments (Wilson-θ), where multipliers mean nothing: leave it out, \
             or take another scheme",
            step.name
        );
        return Err(Complaint::new(format!("contacts.{}.normal.penetration", pair.name), message));
    }
    let Some(k) = model.steps.iter().position(explicit) else {
        return Ok(());
    };
    if let Some((name, _)) = case.contacts.iter().find(|(_, input)| input.massless) {
        let message = format!("the explicit step `{}` needs the mass of every node: leave it out", model.steps[k].name);
        return Err(Complaint::new(format!("contacts.{name}.massless"), message));
    }
    match augmented {
        Some(pair) => Err(Complaint::new(
            format!("contacts.{}.normal.penetration", pair.name),
            format!(
                "the explicit step `{}` takes the plain penalty: leave it out, and raise alpha_n",
                model.steps[k].name
            ),
        )),
        None => Ok(()),
    }
}

fn newton_settings(case: &Case) -> Checked<NewtonSettings> {
    let newton = &case.newton;
    if !(newton.tolerance > 0.0 && newton.tolerance < 1.0) {
        let message = format!("is {}: must be between 0 and 1 (1e-8 is the default)", newton.tolerance);
        return Err(Complaint::new("newton.tolerance", message));
    }
    if !(1..=MOST_ITERATIONS).contains(&newton.max_iterations) {
        let message = format!("is {}: must be 1 to {MOST_ITERATIONS}", newton.max_iterations);
        return Err(Complaint::new("newton.max_iterations", message));
    }
    Ok(NewtonSettings { tolerance: newton.tolerance, max_iterations: newton.max_iterations })
}

fn bodies(case: &Case, mesh: &Mesh) -> Checked<(Vec<Body>, Vec<usize>)> {
    let mut bodies = Vec::new();
    let mut body_of_element = vec![usize::MAX; mesh.elements.len()];
    for (name, input) in &case.bodies {
        let place = format!("bodies.{name}");
        let group = mesh.group(name).map_err(|error| Complaint::new(&place, error))?;
        let Group::Elements(elements) = group else {
            return Err(Complaint::new(
                place,
                format!("`{name}` is a group of {}, not of solid elements", kind(group)),
            ));
        };
        let material = input.material.build().map_err(|error| Complaint::new(format!("{place}.material"), error))?;
        check_stiffness(&format!("{place}.material"), "the stiffness lambda + 2 G", material.stiffness())?;
        let damping = damping(&input.damping, &*material, &format!("{place}.damping"))?;
        for &element in elements {
            body_of_element[element] = bodies.len();
        }
        let (elements, nodes) = (elements.clone(), mesh.nodes_of(group));
        bodies.push(Body { name: name.clone(), material, damping, elements, nodes });
    }
    match body_of_element.iter().position(|&body| body == usize::MAX) {
        Some(element) => {
            let name = mesh.body_of(element).unwrap_or("?");
            Err(Complaint::new(
                "bodies",
                format!("`{name}` of the mesh has no material: add \"{name}\": {{\"material\": …}}"),
            ))
        }
        None => Ok((bodies, body_of_element)),
    }
}

fn damping(input: &DampingInput, material: &dyn Material, place: &str) -> Checked<Damping> {
    let DampingInput { mass, stiffness } = *input;
    for (key, value) in [("mass", mass), ("stiffness", stiffness)] {
        if !(value >= 0.0 && value.is_finite()) {
            return Err(Complaint::new(format!("{place}.{key}"), format!("is {value}: must be zero or positive")));
        }
    }
    if mass > 0.0 && material.density() == 0.0 {
        let message = "has no effect on a body without mass: give material.density, or damp by stiffness";
        return Err(Complaint::new(format!("{place}.mass"), message));
    }
    Ok(Damping { mass, stiffness })
}

fn point_masses(case: &Case, mesh: &Mesh) -> Checked<Vec<PointMass>> {
    let point_mass = |(name, input): (&String, &PointMassInput)| {
        let place = format!("point_masses.{name}");
        let group = mesh.group(name).map_err(|error| Complaint::new(&place, error))?;
        if input.mass <= 0.0 {
            let message = format!("is {}: must be positive (leave the group out for none)", input.mass);
            return Err(Complaint::new(format!("{place}.mass"), message));
        }
        check_stiffness(&place, "mass", input.mass)?;
        Ok(PointMass { name: name.clone(), mass: input.mass, nodes: mesh.nodes_of(group) })
    };
    case.point_masses.iter().map(point_mass).collect()
}

fn solids(case: &Case, mesh: &Mesh, bodies: &[Body], body_of_element: &[usize]) -> Checked<Vec<SolidElement>> {
    let mut solids = Vec::with_capacity(mesh.elements.len());
    for (element, &body) in mesh.elements.iter().zip(body_of_element) {
        let name = &bodies[body].name;
        let f_bar = case.bodies[name].element == Formulation::FBar;
        let positions: Vec<Vector2<f64>> = element.nodes.iter().map(|&node| mesh.nodes[node]).collect();
        let complain = |error| Complaint::new(format!("bodies.{name}.element"), error);
        solids.push(SolidElement::new(element.kind, f_bar, &positions).map_err(complain)?);
        consistent_mass(element.kind, &positions, 1.0).map_err(complain)?;
    }
    Ok(solids)
}

fn kind(group: &Group) -> &'static str {
    match group {
        Group::Elements(_) => "solid elements",
        Group::Edges(_) => "edges",
        Group::Nodes(_) => "points",
    }
}

/// The edges of a group, which must be a group of edges.
fn edges<'m>(mesh: &'m Mesh, name: &str, place: &str) -> Checked<&'m [Edge]> {
    match mesh.group(name).map_err(|error| Complaint::new(place, error))? {
        Group::Edges(edges) => Ok(edges),
        group => Err(Complaint::new(place, format!("`{name}` is a group of {}, not of edges", kind(group)))),
    }
}

fn node_lists(edges: &[Edge]) -> Vec<Vec<usize>> {
    edges.iter().map(|edge| edge.nodes.clone()).collect()
}

fn contacts(case: &Case, model: &Model) -> Checked<Vec<ContactPair>> {
    case.contacts.iter().map(|(name, input)| contact(name, input, model)).collect()
}

fn contact(name: &str, input: &ContactInput, model: &Model) -> Checked<ContactPair> {
    let place = format!("contacts.{name}");
    let (mut points, mortar) = slave_points(&place, input, &model.mesh)?;
    let master = master(&place, input, &points, model)?;
    if let Master::Mesh(surface) = &master {
        points.iter_mut().flat_map(|point| &mut point.length).for_each(|length| length.factor *= surface.share());
    }
    let elastic = elastic_stiffness(&place, input, model)?;
    let alpha_n = match (input.normal.alpha_n, elastic) {
        (Some(alpha_n), _) => alpha_n,
        (None, Some(elastic)) => 10.0 * elastic,
        (None, None) => {
            let message =
                format!("is missing: there are no elements behind the points of `{}` to choose it by", input.slave);
            return Err(Complaint::new(format!("{place}.normal.alpha_n"), message));
        }
    };
    if alpha_n <= 0.0 {
        let message = format!("is {alpha_n}: must be positive (leave it out for 10 (λ + 2G)/h)");
        return Err(Complaint::new(format!("{place}.normal.alpha_n"), message));
    }
    if let Some(penetration) = input.normal.penetration.filter(|p| !(*p > 0.0 && p.is_finite())) {
        let message = format!("is {penetration}: must be positive (leave it out for the plain penalty)");
        return Err(Complaint::new(format!("{place}.normal.penetration"), message));
    }
    let friction = format!("{place}.friction");
    if input.area.is_some() && input.gives_alpha_t() == Some(false) {
        return Err(Complaint::new(friction + ".alpha_t", "is missing: a slave group of points has no default for it"));
    }
    check_stiffness(&format!("{place}.normal"), "alpha_n", alpha_n)?;
    let laws = along::laws(&place, input, &mut points, &model.mesh, 0.5 * alpha_n)?;
    for law in laws.iter().filter(|law| law.stiffness() > 0.0) {
        check_stiffness(&friction, "alpha_t", law.stiffness())?;
    }
    let mut pair = ContactPair {
        name: name.into(),
        points,
        master,
        mortar,
        alpha_n,
        compliance: elastic.map_or(0.0, |elastic| 1.0 / elastic),
        penetration: input.normal.penetration,
        laws,
        initial: None,
        reverse: reverse(input, &model.mesh),
    };
    if let Some(initial) = &input.initial {
        initial::close(&mut pair, initial, model, &format!("{place}.initial"))?;
    }
    if input.shrink_fit {
        if input.initial.is_some() {
            let message = "has no meaning together with `initial`, which closes every gap and overlap: leave one out";
            return Err(Complaint::new(format!("{place}.shrink_fit"), message));
        }
        pair.start_fitting(&Configuration::undeformed(&model.mesh.nodes));
    }
    Ok(pair)
}

/// The nodes of a mesh master against the edges of the slave.
fn reverse(input: &ContactInput, mesh: &Mesh) -> Option<Reverse> {
    let MasterInput::Group(master) = &input.master else { return None };
    let [master, slave] = [master, &input.slave].map(|name| match mesh.group(name) {
        Ok(Group::Edges(edges)) => in_order(&node_lists(edges)),
        _ => Vec::new(),
    });
    let seen = !input.is_own() && !slave.is_empty();
    seen.then(|| Reverse { nodes: nodal_points(&master), slave: Master::Mesh(Surface::new(&slave)) })
}

/// Points of the edges, or the points themselves, each with the given area; and the edges if contact is averaged over them.
fn slave_points(place: &str, input: &ContactInput, mesh: &Mesh) -> Checked<(Vec<SlavePoint>, Option<Mortar>)> {
    let name = &input.slave;
    let slave = format!("{place}.slave");
    let area = format!("{place}.area");
    if let Group::Nodes(nodes) = mesh.group(name).map_err(|error| Complaint::new(&slave, error))? {
        let Some(size) = input.area else {
            let message = format!("is missing: `{name}` is a group of points, and each needs the area it stands for");
            return Err(Complaint::new(area, message));
        };
        if size <= 0.0 {
            return Err(Complaint::new(area, format!("is {size}: must be positive")));
        }
        check_stiffness(place, "area", size)?;
        return Ok((nodes.iter().map(|&node| lone_point(node, size)).collect(), None));
    }
    let edges = in_order(&node_lists(edges(mesh, name, &slave)?));
    if input.area.is_some() {
        let message = format!("`{name}` is a group of edges, which have lengths of their own: leave the area out");
        return Err(Complaint::new(area, message));
    }
    let Chosen { method, points, .. } = choose(input, mesh);
    if !(2..=4).contains(&points) {
        return Err(Complaint::new(format!("{place}.points"), format!("is {points}: must be 2, 3 or 4")));
    }
    Ok(match method {
        Method::NodeToSegment => (nodal_points(&edges), None),
        Method::GaussToSegment => (gauss_points(&edges, points), None),
        Method::Mortar => {
            let (points, mortar) = mortar_points(&edges, &mesh.nodes);
            (points, Some(mortar))
        }
    })
}

fn master(place: &str, input: &ContactInput, points: &[SlavePoint], model: &Model) -> Checked<Master> {
    let mesh = &model.mesh;
    match &input.master {
        MasterInput::Group(group) => {
            let master = edges(mesh, group, &format!("{place}.master"))?;
            let mut surface = Surface::new(&node_lists(master));
            if input.is_own() {
                let thinnest = master.iter().map(|edge| depth_behind(edge, model)).fold(f64::INFINITY, f64::min);
                surface = surface.against_itself(0.5 * thinnest);
            } else {
                check_disjoint(place, &input.slave, points, group, master, mesh)?;
            }
            if !input.smooth {
                return Ok(Master::Mesh(surface));
            }
            let refused = |why: &str| Err(Complaint::new(format!("{place}.smooth"), why));
            if input.method == Some(Method::Mortar) {
                return refused("is not for mortar, which averages the gap: leave it out, or take gauss_to_segment");
            }
            if master.iter().any(|edge| edge.nodes.len() > 2) {
                return refused("is for straight edges, and the master has quadratic ones: leave it out");
            }
            Ok(Master::Mesh(surface.smoothed(&mesh.nodes)))
        }
        MasterInput::Rigid(_) if input.smooth => {
            let message = "is for a master of mesh edges, and a rigid body needs none: leave it out";
            Err(Complaint::new(format!("{place}.smooth"), message))
        }
        MasterInput::Rigid(body) => rigid(body, &format!("{place}.master")).map(Master::Rigid),
    }
}

/// A rigid master, with its geometry checked.
fn rigid(input: &RigidInput, place: &str) -> Checked<Rigid> {
    match input {
        RigidInput::Plane(PlaneInput { point, normal }) => {
            let given = Vector2::from(*normal);
            let Some(normal) = given.try_normalize(0.0).filter(|normal| normal.norm() > 0.5) else {
                let message = format!("is [{}, {}]: must have a direction, such as [0, 1]", given.x, given.y);
                return Err(Complaint::new(format!("{place}.plane.normal"), message));
            };
            Ok(Rigid::Plane(Plane { point: Vector2::from(*point), normal }))
        }
        RigidInput::Circle(CircleInput { centre, radius, hole }) => {
            if !(*radius > 0.0 && radius.is_finite()) {
                return Err(Complaint::new(format!("{place}.circle.radius"), format!("is {radius}: must be positive")));
            }
            Ok(Rigid::Circle(Circle { centre: Vector2::from(*centre), radius: *radius, hole: *hole }))
        }
        RigidInput::Polyline(PolylineInput { points }) => {
            let place = format!("{place}.polyline.points");
            if points.len() < 2 {
                return Err(Complaint::new(place, format!("has {} points: must have two or more", points.len())));
            }
            if let Some(k) = points.windows(2).position(|pair| pair[0] == pair[1]) {
                let message = format!("points {} and {} are the same: leave one out", k, k + 1);
                return Err(Complaint::new(place, message));
            }
            Ok(Rigid::Polyline(Polyline::new(points.iter().map(|&point| Vector2::from(point)).collect())))
        }
    }
}

fn check_stiffness(place: &str, name: &str, value: f64) -> Checked<()> {
    if STIFFNESSES.contains(&value) {
        return Ok(());
    }
    let (low, high) = (STIFFNESSES.start(), STIFFNESSES.end());
    let message = format!("{name} is {value:.6e}: it must lie between {low:e} and {high:e}; choose other units");
    Err(Complaint::new(place, message))
}

/// (λ + 2G)/h, the mean over the slave's edges: λ + 2G of the softer of the two sides, which is the one that the penalty
/// must not give way beside, and h, the depth of the element behind the edge. None where the slave has no edges.
fn elastic_stiffness(place: &str, input: &ContactInput, model: &Model) -> Checked<Option<f64>> {
    let name = &input.slave;
    if input.area.is_some() {
        return Ok(None);
    }
    let slave = edges(&model.mesh, name, &format!("{place}.slave"))?;
    let modulus = |edge: &Edge| model.bodies[model.body_of_element[edge.element]].material.stiffness();
    let master = match &input.master {
        MasterInput::Group(group) => edges(&model.mesh, group, &format!("{place}.master"))?,
        MasterInput::Rigid(_) => &[],
    };
    let softest = master.iter().map(modulus).fold(f64::INFINITY, f64::min);
    let stiffness = |edge: &Edge| modulus(edge).min(softest) / depth_behind(edge, model);
    Ok(Some(slave.iter().map(stiffness).sum::<f64>() / slave.len() as f64))
}

/// Depth of the element behind an edge [L].
fn depth_behind(edge: &Edge, model: &Model) -> f64 {
    let [a, b] = [0, 1].map(|end| model.mesh.nodes[edge.nodes[end]]);
    model.solids[edge.element].volume() / (b - a).norm()
}

/// Two groups in contact must be different edges, and a slave point of no edge must not be on the master.
fn check_disjoint(
    place: &str,
    slave: &str,
    points: &[SlavePoint],
    master: &str,
    other: &[Edge],
    mesh: &Mesh,
) -> Checked<()> {
    let nodes: BTreeSet<usize> = points.iter().flat_map(|point| point.position.iter().map(|&(node, _)| node)).collect();
    let own = |node: &usize| nodes.contains(node);
    let lone = points.iter().all(|point| point.length.is_empty());
    let shared = match lone {
        true => other.iter().flat_map(|edge| &edge.nodes).find(|node| own(node)).map(|node| vec![*node]),
        false => other.iter().map(|edge| &edge.nodes[..2]).find(|ends| ends.iter().all(own)).map(<[usize]>::to_vec),
    };
    let Some(shared) = shared else { return Ok(()) };
    let tags: Vec<String> = shared.iter().map(|&node| mesh.node_tags[node].to_string()).collect();
    let what = if lone { "node" } else { "the edge between nodes" };
    let message = format!(
        "{what} {} is both slave (`{slave}`) and master (`{master}`): the two sides of a contact need edges and nodes of \
         their own; for contact of a surface with itself name the same group of edges twice",
        tags.join(" and ")
    );
    Err(Complaint::new(place, message))
}

/// The reactions of copies are with the nodes they move with.
fn watched(model: &Model, k: usize, name: &str) -> Checked<WatchedSet> {
    let group = model.mesh.group(name).map_err(|error| Complaint::new(format!("watch[{k}]"), error))?;
    let nodes: BTreeSet<usize> = model.mesh.nodes_of(group).into_iter().map(|node| model.ties.original(node)).collect();
    Ok(WatchedSet { name: name.into(), nodes: nodes.into_iter().collect() })
}

fn steps(case: &Case, model: &Model) -> Checked<Vec<Step>> {
    if case.steps.is_empty() {
        return Err(Complaint::new("steps", "is empty: give at least one step"));
    }
    let mut builder = StepBuilder {
        model,
        start: 0.0,
        scheme: Scheme::Static,
        increments: None,
        supports: BTreeMap::new(),
        loads: BTreeMap::new(),
    };
    case.steps.iter().enumerate().map(|(k, step)| builder.next(&format!("steps[{k}]"), step)).collect()
}

/// What one step hands on to the next.
struct StepBuilder<'m> {
    model: &'m Model,
    start: f64,
    scheme: Scheme,
    increments: Option<IncrementsInput>,
    supports: BTreeMap<usize, Prescribed>,
    loads: BTreeMap<(String, LoadKind), LoadInForce>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum LoadKind {
    Pressure,
    Traction,
    Gravity,
    Force,
    Spring,
    Dashpot,
    Absorbing,
}

/// A load with the amplitudes that the next step takes over from.
#[derive(Clone, Default)]
struct LoadInForce {
    dead: Vec<DeadLoad>,
    pressures: Vec<FollowerPressure>,
    springs: Vec<Spring>,
    dashpots: Vec<Dashpot>,
    absorbers: Vec<Absorber>,
}

impl StepBuilder<'_> {
    fn next(&mut self, place: &str, input: &StepInput) -> Checked<Step> {
        if !(input.duration > 0.0 && input.duration.is_finite()) {
            let message = format!("is {}: must be positive", input.duration);
            return Err(Complaint::new(format!("{place}.duration"), message));
        }
        self.scheme = input.scheme.unwrap_or(self.scheme);
        let scheme = self.scheme;
        scheme.check().map_err(|error| Complaint::new(format!("{place}.scheme"), error))?;
        let span = Span { start: self.start, end: self.start + input.duration };
        self.start = span.end;
        self.increments = input.dt.or(self.increments);
        let increments = increments(&format!("{place}.dt"), self.increments, span, scheme)?;
        let freed = self.supports(place, input, span)?;
        // In motion there is no rest of the reaction: what held is gone.
        let released = if scheme.is_dynamic() { Vec::new() } else { freed };
        for (k, load) in input.loads.iter().enumerate() {
            self.load(&format!("{place}.loads[{k}]"), load, span)?;
        }
        let mut loads = Loads::default();
        for load in self.loads.values() {
            loads.dead.extend(load.dead.iter().cloned());
            loads.pressures.extend(load.pressures.iter().cloned());
            loads.springs.extend(load.springs.iter().cloned());
            loads.dashpots.extend(load.dashpots.iter().cloned());
            loads.absorbers.extend(load.absorbers.iter().cloned());
        }
        let supports = self.supports.values().cloned().collect();
        let stabilization = stabilization(&format!("{place}.stabilize"), input, scheme, self.model)?;
        let increments = if stabilization.is_empty() { increments } else { increments.at_most(0.5 * input.duration) };
        let name = input.name.clone();
        let mut step = Step { name, span, scheme, increments, rupture: None, supports, released, loads, stabilization };
        step.rupture = rupture(&format!("{place}.rupture"), input, &step, self.model)?.map(Box::new);
        Ok(step)
    }

    /// Take over the supports of the step before, replace those named again, and list the dofs that are freed.
    fn supports(&mut self, place: &str, input: &StepInput, span: Span) -> Checked<Vec<usize>> {
        let before = self.supports.clone();
        for support in self.supports.values_mut() {
            if let Motion::Displacement(_, own) = &mut support.motion {
                *own = span;
            }
        }
        for (k, support) in input.supports.iter().enumerate() {
            let place = format!("{place}.supports[{k}]");
            let nodes = nodes_at(&self.model.mesh, &support.on, &format!("{place}.on"))?;
            let nodes: Vec<usize> = nodes.into_iter().map(|node| self.model.ties.original(node)).collect();
            let directions = [("ux", 0, &support.ux), ("uy", 1, &support.uy)];
            if support.rotation.is_none() && directions.iter().all(|(_, _, given)| given.is_none()) {
                return Err(Complaint::new(place, "prescribes nothing: give ux, uy or rotation"));
            }
            for (key, component, given) in directions {
                let Some(given) = given else { continue };
                if matches!(support.rotation, Some(Some(_))) {
                    return Err(Complaint::new(
                        place,
                        format!("gives rotation and {key}: a rotation prescribes both directions"),
                    ));
                }
                let drive = given.as_ref().map(|given| drive(given, &format!("{place}.{key}"))).transpose()?;
                if drive.is_none() && !nodes.iter().any(|node| before.contains_key(&(2 * node + component))) {
                    return Err(frees_nothing(&format!("{place}.{key}"), &support.on));
                }
                for &node in &nodes {
                    let motion = drive.clone().map(|drive| Motion::Displacement(drive, span));
                    self.set(2 * node + component, motion);
                }
            }
            let Some(rotation) = &support.rotation else { continue };
            let motion = match rotation {
                None if !nodes.iter().any(|node| before.contains_key(&(2 * node))) => {
                    return Err(frees_nothing(&format!("{place}.rotation"), &support.on));
                }
                None => None,
                Some(rotation) => {
                    let turning = |support: &Prescribed| match &support.motion {
                        Motion::Rotation { angle, .. } => Some(Box::new(angle.clone())),
                        Motion::Displacement(..) => None,
                    };
                    let before = nodes.first().and_then(|node| before.get(&(2 * node))).and_then(turning);
                    let drive = drive(&rotation.angle, &format!("{place}.rotation.angle"))?;
                    let angle = Amplitude { drive, span, before };
                    Some(Motion::Rotation { about: Vector2::from(rotation.about), angle })
                }
            };
            for &node in &nodes {
                for dof in [2 * node, 2 * node + 1] {
                    self.set(dof, motion.clone());
                }
            }
        }
        Ok(before.into_keys().filter(|dof| !self.supports.contains_key(dof)).collect())
    }

    fn set(&mut self, dof: usize, motion: Option<Motion>) {
        match motion {
            Some(motion) => self.supports.insert(dof, Prescribed { dof, motion }),
            None => self.supports.remove(&dof),
        };
    }

    fn load(&mut self, place: &str, input: &LoadInput, span: Span) -> Checked<()> {
        let ends = [
            (LoadKind::Pressure, input.pressure.as_ref().map(Option::is_none)),
            (LoadKind::Traction, input.traction.as_ref().map(Option::is_none)),
            (LoadKind::Gravity, input.gravity.as_ref().map(Option::is_none)),
            (LoadKind::Force, input.force.as_ref().map(Option::is_none)),
            (LoadKind::Spring, input.spring.as_ref().map(Option::is_none)),
            (LoadKind::Dashpot, input.dashpot.as_ref().map(Option::is_none)),
            (LoadKind::Absorbing, input.absorbing.map(|absorbs| !absorbs)),
        ];
        let mut given = ends.into_iter().filter_map(|(kind, ends)| Some((kind, ends?)));
        let (Some((kind, ends)), None) = (given.next(), given.next()) else {
            let message = "must give exactly one of pressure, traction, gravity, force, spring, dashpot, absorbing";
            return Err(Complaint::new(place, message));
        };
        if ends && !self.loads.contains_key(&(input.on.to_string(), kind)) {
            return Err(frees_nothing(place, &input.on));
        }
        if let Some(pressure) = &input.pressure {
            self.pressure(place, input, pressure.as_ref(), span)?;
        }
        if let Some(traction) = &input.traction {
            let shares = |place: &str| {
                Ok(edge_shares(&self.model.mesh, edges(&self.model.mesh, &group_at(input, place)?, place)?))
            };
            self.dead(
                place,
                input,
                (LoadKind::Traction, "traction"),
                traction.as_ref(),
                shares(&format!("{place}.on"))?,
                span,
            )?;
        }
        if let Some(gravity) = &input.gravity {
            let shares = self.mass_shares(&group_at(input, place)?, &format!("{place}.on"))?;
            self.dead(place, input, (LoadKind::Gravity, "gravity"), gravity.as_ref(), shares, span)?;
        }
        if let Some(force) = &input.force {
            let mesh = &self.model.mesh;
            let nodes = nodes_at(mesh, &input.on, &format!("{place}.on"))?;
            let shares = nodes.into_iter().map(|node| (node, 1.0, mesh.nodes[node])).collect();
            self.dead(place, input, (LoadKind::Force, "force"), force.as_ref(), shares, span)?;
        }
        if let Some(spring) = &input.spring {
            self.spring(place, input, spring.as_ref(), span)?;
        }
        if let Some(dashpot) = &input.dashpot {
            self.dashpot(place, input, dashpot.as_ref(), span)?;
        }
        if let Some(absorbs) = input.absorbing {
            let name = group_at(input, place)?;
            let edges = edges(&self.model.mesh, &name, &format!("{place}.on"))?;
            let absorbers = if absorbs { absorbers(self.model, edges) } else { Vec::new() };
            self.loads.insert((name, LoadKind::Absorbing), LoadInForce { absorbers, ..Default::default() });
        }
        Ok(())
    }

    fn pressure(&mut self, place: &str, input: &LoadInput, given: Option<&DriveInput>, span: Span) -> Checked<()> {
        let name = group_at(input, place)?;
        let edges = node_lists(edges(&self.model.mesh, &name, &format!("{place}.on"))?);
        let key = (name, LoadKind::Pressure);
        let before = self.loads.get(&key).and_then(|load| load.pressures.first()).map(|load| load.amplitude.clone());
        let amplitude = amplitude(given, before, &format!("{place}.pressure"), span)?;
        let pressures = amplitude.map(|amplitude| FollowerPressure { amplitude, edges }).into_iter().collect();
        self.loads.insert(key, LoadInForce { pressures, ..Default::default() });
        Ok(())
    }

    fn dead(
        &mut self,
        place: &str,
        input: &LoadInput,
        (kind, key): (LoadKind, &str),
        given: Option<&Components>,
        shares: Vec<(usize, f64, Vector2<f64>)>,
        span: Span,
    ) -> Checked<()> {
        let entry = (input.on.to_string(), kind);
        let before = self.loads.remove(&entry).unwrap_or_default();
        let mut load = LoadInForce::default();
        for (component, name) in ["x", "y"].into_iter().enumerate() {
            let given = along(given, component);
            let before = before.dead.iter().find(|load| load.component == component).map(|load| load.amplitude.clone());
            let amplitude = amplitude(given, before, &format!("{place}.{key}.{name}"), span)?;
            load.dead.extend(amplitude.map(|amplitude| DeadLoad { component, amplitude, shares: shares.clone() }));
        }
        self.loads.insert(entry, load);
        Ok(())
    }

    fn spring(&mut self, place: &str, input: &LoadInput, given: Option<&SpringInput>, span: Span) -> Checked<()> {
        let nodes = nodes_at(&self.model.mesh, &input.on, &format!("{place}.on"))?;
        let key = (input.on.to_string(), LoadKind::Spring);
        let before = self.loads.remove(&key).unwrap_or_default();
        let Some(given) = given else { return Ok(()) };
        let mut load = LoadInForce::default();
        for (component, (name, stiffness)) in [("kx", given.kx), ("ky", given.ky)].into_iter().enumerate() {
            if !not_zero(&format!("{place}.spring.{name}"), stiffness)? {
                continue;
            }
            let old = before.springs.iter().find(|spring| spring.dof % 2 == component).and_then(|s| s.driver.clone());
            let driver =
                amplitude(along(given.driver.as_ref(), component), old, &format!("{place}.spring.driver"), span)?;
            let at = |&node: &usize| Spring { dof: 2 * node + component, stiffness, driver: driver.clone() };
            load.springs.extend(nodes.iter().map(at));
        }
        self.loads.insert(key, load);
        Ok(())
    }

    fn dashpot(&mut self, place: &str, input: &LoadInput, given: Option<&DashpotInput>, span: Span) -> Checked<()> {
        let nodes = nodes_at(&self.model.mesh, &input.on, &format!("{place}.on"))?;
        let key = (input.on.to_string(), LoadKind::Dashpot);
        let before = self.loads.remove(&key).unwrap_or_default();
        let Some(given) = given else { return Ok(()) };
        let mut load = LoadInForce::default();
        for (component, (name, coefficient)) in [("cx", given.cx), ("cy", given.cy)].into_iter().enumerate() {
            if !not_zero(&format!("{place}.dashpot.{name}"), coefficient)? {
                continue;
            }
            let old = before.dashpots.iter().find(|old| old.dof % 2 == component).and_then(|d| d.driver.clone());
            let driver =
                amplitude(along(given.driver.as_ref(), component), old, &format!("{place}.dashpot.driver"), span)?;
            let at = |&node: &usize| Dashpot { dof: 2 * node + component, coefficient, driver: driver.clone() };
            load.dashpots.extend(nodes.iter().map(at));
        }
        self.loads.insert(key, load);
        Ok(())
    }

    /// Nodal shares of a force per mass on a body, ∫ ρ N_a dV, and on point masses.
    fn mass_shares(&self, name: &str, place: &str) -> Checked<Vec<(usize, f64, Vector2<f64>)>> {
        let model = self.model;
        let body = model.bodies.iter().find(|body| body.name == name);
        let points = model.point_masses.iter().find(|point| point.name == name);
        match (body, points) {
            (Some(body), None) if body.material.density() == 0.0 => {
                let message = format!("gravity needs a mass: give bodies.{name}.material.density");
                return Err(Complaint::new(place, message));
            }
            (None, None) => {
                let bodies = model.bodies.iter().map(|body| body.name.as_str());
                let known: Vec<&str> =
                    bodies.chain(model.point_masses.iter().map(|point| point.name.as_str())).collect();
                let known = if known.is_empty() { "none at all".into() } else { known.join(", ") };
                let message =
                    format!("there is no body or point mass `{name}`, on which gravity acts; there are {known}");
                return Err(Complaint::new(place, message));
            }
            _ => {}
        }
        let mut shares = Vec::new();
        for &e in body.iter().flat_map(|body| &body.elements) {
            let masses = model.element_mass(e);
            // Row sum: ∫ ρ N_a dV.
            let share = |(a, &node): (usize, &usize)| (node, masses.row(a).sum(), model.mesh.nodes[node]);
            shares.extend(model.mesh.elements[e].nodes.iter().enumerate().map(share));
        }
        if let Some(point) = points {
            shares.extend(point.nodes.iter().map(|&node| (node, point.mass, model.mesh.nodes[node])));
        }
        Ok(shares)
    }
}

/// Whether a coefficient of a spring or dashpot is above zero; below it must not be.
fn not_zero(place: &str, value: f64) -> Checked<bool> {
    match value {
        value if value < 0.0 => Err(Complaint::new(place, format!("is {value}: must be zero or positive"))),
        value => Ok(value > 0.0),
    }
}

fn along(of: Option<&Components>, component: usize) -> Option<&DriveInput> {
    of.and_then(|of| if component == 0 { of.x.as_ref() } else { of.y.as_ref() })
}

fn frees_nothing(place: &str, on: &Place) -> Complaint {
    Complaint::new(place, format!("null ends what an earlier step gave, but none gave this on {on}: check the name"))
}

fn group_at(input: &LoadInput, place: &str) -> Checked<String> {
    match &input.on {
        Place::Group(name) => Ok(name.clone()),
        Place::Node(NodeInput { node }) => {
            Err(Complaint::new(format!("{place}.on"), format!("node {node} cannot carry this load: name a group")))
        }
    }
}

fn nodes_at(mesh: &Mesh, on: &Place, place: &str) -> Checked<Vec<usize>> {
    match on {
        Place::Group(name) => Ok(mesh.nodes_of(mesh.group(name).map_err(|error| Complaint::new(place, error))?)),
        Place::Node(NodeInput { node }) => match mesh.node_tags.iter().position(|tag| tag == node) {
            Some(node) => Ok(vec![node]),
            None => Err(Complaint::new(place, format!("the mesh has no node {node}"))),
        },
    }
}

/// Consistent nodal shares of a traction: ∫ N_a |X'| dξ at the Gauss points.
fn edge_shares(mesh: &Mesh, edges: &[Edge]) -> Vec<(usize, f64, Vector2<f64>)> {
    let mut shares = Vec::new();
    for Edge { nodes, .. } in edges {
        for (xi, weight) in shape::gauss(nodes.len()) {
            let values = shape::edge_values(nodes.len(), xi);
            let slopes = shape::edge_derivatives(nodes.len(), xi);
            let sum = |weights: &[f64]| {
                nodes.iter().zip(weights).map(|(&node, w)| mesh.nodes[node] * *w).sum::<Vector2<f64>>()
            };
            let (position, stretch) = (sum(&values), sum(&slopes).norm());
            shares.extend(nodes.iter().zip(&values).map(|(&node, n)| (node, weight * n * stretch, position)));
        }
    }
    shares
}

/// What the nodes of an absorbing side have of it.
fn absorbers(model: &Model, edges: &[Edge]) -> Vec<Absorber> {
    let mut total: BTreeMap<usize, Matrix2<f64>> = BTreeMap::new();
    for Edge { nodes, element } in edges {
        let material = &*model.bodies[model.body_of_element[*element]].material;
        let density = material.density();
        let impedance = |modulus: f64| (modulus * density).sqrt();
        for (xi, weight) in shape::gauss(nodes.len()) {
            let values = shape::edge_values(nodes.len(), xi);
            let slopes = shape::edge_derivatives(nodes.len(), xi);
            let along: Vector2<f64> = nodes.iter().zip(&slopes).map(|(&node, w)| model.mesh.nodes[node] * *w).sum();
            let s = along.normalize();
            let n = Vector2::new(s.y, -s.x);
            let resistance = n * n.transpose() * impedance(material.stiffness())
                + s * s.transpose() * impedance(material.shear_modulus());
            for (&node, value) in nodes.iter().zip(values) {
                *total.entry(node).or_default() += resistance * (weight * value * along.norm());
            }
        }
    }
    total.into_iter().map(|(node, coefficients)| Absorber { node, coefficients }).collect()
}

/// The drive of this step on top of what was in force before; nothing if there is neither.
fn amplitude(
    given: Option<&DriveInput>,
    before: Option<Amplitude>,
    place: &str,
    span: Span,
) -> Checked<Option<Amplitude>> {
    let drive = match (given, &before) {
        (Some(given), _) => drive(given, place)?,
        // Freed: ramped to zero over the step.
        (None, Some(_)) => Drive::Constant(0.0),
        (None, None) => return Ok(None),
    };
    Ok(Some(Amplitude { drive, span, before: before.map(Box::new) }))
}

pub(super) fn drive(input: &DriveInput, place: &str) -> Checked<Drive> {
    Ok(match input {
        DriveInput::Constant(value) => Drive::Constant(*value),
        DriveInput::InTime(TimeInput::Rate(rate)) => Drive::Rate(*rate),
        DriveInput::Expression(text) => Drive::Expression(expression(text, place)?),
        DriveInput::InTime(TimeInput::Table(table)) => {
            if table.is_empty() {
                return Err(Complaint::new(place, "the table is empty: give pairs [time, value]"));
            }
            if let Some(pair) = table.windows(2).find(|pair| pair[1][0] <= pair[0][0]) {
                let message = format!("the times of the table must ascend: {} follows {}", pair[1][0], pair[0][0]);
                return Err(Complaint::new(place, message));
            }
            Drive::Table(table.clone())
        }
    })
}

pub(super) fn expression(text: &str, place: &str) -> Checked<Expression> {
    if text.len() > LONGEST_EXPRESSION {
        let message = format!("the expression is longer than {LONGEST_EXPRESSION} characters: use a table");
        return Err(Complaint::new(place, message));
    }
    let complain = |error| Complaint::new(place, format!("\"{text}\" cannot be read: {error}"));
    Expression::parse(text).map_err(complain)
}

/// c₀ of every dof: the nodes of a body share `stabilize` × (λ + 2G) × duration.
fn stabilization(place: &str, input: &StepInput, scheme: Scheme, model: &Model) -> Checked<Vec<f64>> {
    let Some(share) = input.stabilize else { return Ok(Vec::new()) };
    if !(share > 0.0 && share <= 1.0) {
        let message =
            format!("is {share}: must be a share of the stiffness, above 0 and at most 1 (1e-3 is a good start)");
        return Err(Complaint::new(place, message));
    }
    if scheme != Scheme::Static {
        return Err(Complaint::new(place, "is for static steps: in a dynamic one inertia holds the bodies"));
    }
    let mut coefficients = vec![0.0; model.dofs()];
    for body in &model.bodies {
        let coefficient = share * body.material.stiffness() * input.duration / body.nodes.len() as f64;
        let dofs = body.nodes.iter().flat_map(|&node| [2 * node, 2 * node + 1]);
        dofs.for_each(|dof| coefficients[dof] = coefficient);
    }
    Ok(coefficients)
}

fn rupture(place: &str, input: &StepInput, step: &Step, model: &Model) -> Checked<Option<Rupture>> {
    let Some(RuptureInput { slip_rate, safety }) = input.rupture else { return Ok(None) };
    if !(slip_rate > 0.0 && slip_rate.is_finite()) {
        return Err(Complaint::new(format!("{place}.slip_rate"), format!("is {slip_rate}: must be positive")));
    }
    if matches!(step.scheme, Scheme::Explicit { .. }) {
        return Err(Complaint::new(place, "is for static and implicit steps: this one is explicit throughout"));
    }
    if model.contacts.is_empty() {
        return Err(Complaint::new(place, "needs a contact that may slip: leave it out"));
    }
    let scheme = Scheme::Explicit { safety };
    scheme.check().map_err(|error| Complaint::new(place, error))?;
    let slowest = |body: &Body| (body.material.shear_modulus() / body.material.density()).sqrt();
    let slowest = model.bodies.iter().map(slowest).fold(f64::INFINITY, f64::min);
    let calm = (model.mesh.diagonal() / slowest).max(step.increments.min);
    let increments = Increments { error: None, ..step.increments };
    let explicit = Step { scheme, increments, stabilization: Vec::new(), ..step.clone() };
    Ok(Some(Rupture { slip_rate, calm, explicit }))
}

fn increments(place: &str, input: Option<IncrementsInput>, span: Span, scheme: Scheme) -> Checked<Increments> {
    let duration = span.end - span.start;
    let input = input.unwrap_or(IncrementsInput { initial: 0.1 * duration, min: None, max: None, error: None });
    let least = SHORTEST_INCREMENT * span.end;
    let (default_min, default_max) = match input.error {
        None => (1e-3 * input.initial, input.initial),
        Some(_) => ((1e-6 * input.initial).max(least), input.initial.max(0.1 * duration)),
    };
    let (min, max) = (input.min.unwrap_or(default_min), input.max.unwrap_or(default_max));
    let positive = [("initial", Some(input.initial)), ("min", Some(min)), ("max", Some(max)), ("error", input.error)];
    for (name, value) in positive.into_iter().filter_map(|(name, value)| Some((name, value?))) {
        if !(value > 0.0 && value.is_finite()) {
            return Err(Complaint::new(format!("{place}.{name}"), format!("is {value}: must be positive")));
        }
    }
    if min > max {
        let message = format!("min = {min} is above max = {max}: increments must have room between them");
        return Err(Complaint::new(place, message));
    }
    if input.initial > max || input.initial < min {
        let message = format!("initial = {} must lie between min = {min} and max = {max}", input.initial);
        return Err(Complaint::new(place, message));
    }
    if min < least {
        let end = span.end;
        let message = format!("is {min:e}: at the time {end:e} increments below {least:.1e} are lost in round-off");
        return Err(Complaint::new(format!("{place}.min"), message));
    }
    if input.error.is_some() && scheme != Scheme::Static && scheme.error_constant().is_none() {
        let message = match scheme {
            Scheme::Explicit { .. } => "explicit takes increments as long as they are stable: leave error out",
            Scheme::Wilson { .. } => "wilson has no estimate of its error: take newmark, hht or generalized_alpha",
            _ => "newmark with beta near 1/6 has no estimate of its error: take another beta",
        };
        return Err(Complaint::new(format!("{place}.error"), message));
    }
    Ok(Increments { initial: input.initial, min, max, error: input.error })
}
