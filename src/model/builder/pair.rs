//! Builds the pair of surfaces of a contact.
//!
//! # Radiation damping
//!
//! Radiation damping approximates the effect of inertia on slip in motions without inertia.
//!
//! ```text
//! τ = τ_static − Z₁ v₁ = τ_static − Z₂ v₂,   v₁ + v₂ = v     plane shear waves leave on both sides,    Z = ρ c_s = G/c_s     (1)
//! τ = τ_static − η v,   1/η = 1/Z₁ + 1/Z₂                     v₁ and v₂ eliminated; equal bodies: η = G/(2 c_s)                   (2)
//! ```
//! A side that slips with v₁ radiates a wave that changes the traction by Z₁ v₁; both sides have the same traction, so
//! the slip rate is divided between them as between dashpots in series. For a rigid master η = Z of the slave.
//!
//! Source: Rice (1993), J. Geophys. Res. 98, 9885.
//!
//! # Penalties
//!
//! Default penalties are stiff compared with the adjacent elements, but soft enough for the iterations.
//!
//! ```text
//! α_n = 300 (λ + 2G)/h,   α_t = 15 (λ + 2G)/h           all steps are static, at nodes, by mortar, and on planes     (1)
//! α_n =  10 (λ + 2G)/h,   α_t =  5 (λ + 2G)/h           a step has inertia, or explicit increments; at Gauss points  (2)
//! ```
//! α_t of (1) is for laws to which it is a penalty, 300 (λ + 2G)/h with `stick`; where the elastic slip is a part of the law, α_t is that
//! of (2) in every run. With (1) a block of n layers of elements that sticks gives way by G/(15 n (λ + 2G)) of its own shear, 1 % for two.
//! A stiffer α_t turns the mismatch of two meshes at every closure into shear, and takes more iterations; compared with the bending
//! of a thin belt it may be too stiff for Newton's method. It is not softened for thin bodies: a coat on a block is thin as well, does not
//! bend, and would creep untold.
//!
//! The nodes of an edge do not determine the pressures of two Gauss points on it: the weakest of their combinations meets no stiffness
//! but that of the penalty. With (1) the pressure of sliding blocks scatters by 56 to 86 % of its mean, with (2) by 2 to 4 %.
//!
//! Explicit increments are as long as α_n allows. Implicit ones that do not resolve the oscillation of a surface node on α_n gain
//! energy where surfaces part and meet: with (1) more than all that was supplied, with (2) less than a hundredth of it
//! (`energy_from_nowhere_ends_with_a_remedy_that_helps`).
//!
//! λ + 2G is that of the softer side, compared with which the penalty must not give way, of the bodies that face each other
//! (`facing.rs`); h is the depth of the element behind the slave's edge; (λ + 2G)/h is the mean over the slave's edges on these. Where α_n is given, α_t = α_n/2. Surfaces that are tied
//! take α_n = α_t = 10⁴ (λ + 2G)/h unless increments are explicit: nothing opens or slides there, so that no iteration has to find
//! out. The α_c of a bond is the α_t of its friction where that is a penalty on the whole contact, otherwise that of (1) or (2) of a penalty.
//!
//! Some data of a contact do not follow from its points: nodes without a contact point, and the stiffness of the bodies.

use std::collections::BTreeSet;

use super::additions::Additions;
use super::bond::{bond, fades};
use super::contact::{Contact, MasterSide, Radiation, SlidingRange};
use super::error::{Checked, ModelError, check_positive, check_size, refuse_if};
use super::facing::{Facing, facing};
use super::fluid::FluidPressure;
use super::friction::{DefaultAlphaT, Laws};
use super::groups::{edges, group, node_lists};
use super::load_step::LoadStep;
use super::schedule::regime;
use super::thickness::Outline;
use super::{conduit, contact, fluid, friction, initial, pore_pressure, pores, rigid, seam, unseen};
use crate::contact::master::{Master, Rigid, Shape};
use crate::contact::mortar::{Hats, Mortar, mortar_points};
use crate::contact::pair::ContactPair;
use crate::contact::surface::{
    SlavePoint, Surface, gauss_points, gauss_points_and_corners, in_order, is_corner, lone_point, nodal_points,
    nodal_points_of_rings,
};
use crate::laws::bulk::Material;
use crate::laws::friction::Offsets;
use crate::mesh::{Edge, Group, Mesh, Section};
use crate::model::Model;
use crate::model::method::{Asked, Chosen, Method, Tool, choose, nodes_meet};
use crate::model::scheme::Regime;
use crate::model::text::number;

/// The pairs of contacts, in a run of this regime that begins without these bodies.
pub fn pairs(
    contacts: &[Contact],
    model: &Model,
    regime: Regime,
    absent: &BTreeSet<usize>,
) -> Checked<Vec<ContactPair>> {
    check_allowed(contacts, &model.mesh)?;
    let outline = contacts.iter().any(|contact| contact.master_group().is_some()).then(|| Outline::new(&model.mesh));
    let pair = |contact| {
        let mut pair = pair(contact, model, regime, outline.as_ref())?;
        begin(&mut pair, contact, model, absent)?;
        Ok(pair)
    };
    let mut pairs = contacts.iter().map(pair).collect::<Checked<Vec<_>>>()?;
    unseen::undetected(contacts, &mut pairs, model);
    Ok(pairs)
}

/// Builds the pair of a contact, except for the data of the bodies.
fn pair(contact: &Contact, model: &Model, regime: Regime, outline: Option<&Outline>) -> Checked<ContactPair> {
    let place = format!("contacts.{}", contact.name);
    let (mut points, mut mortar) = slave_points(&place, contact, &model.mesh, regime)?;
    let master = master(&place, contact, &points, model)?;
    if let (Master::Mesh(surface), Some(outline)) = (&master, outline) {
        outline.limit(&mut points, mortar.as_mut());
        points.iter_mut().flat_map(|point| &mut point.length).for_each(|length| length.factor *= surface.share());
    }
    let Penalty { alpha_n, alpha_t, compliance } = penalty(&place, contact, model, regime)?;
    let offsets = Offsets { dilatancy: contact.dilatancy, wear: contact.wear };
    let additions = Additions { offsets, bond: None };
    let structure = contact.initial.as_ref().and_then(|initial| initial.structure.as_ref());
    contact::check_has_friction(contact, &place)?;
    let friction = friction::friction(&contact.friction, &contact.along, structure, &place)?;
    let mut found = friction.laws(&place, &mut points, &model.mesh, alpha_t, additions)?;
    let bond = bond(&place, contact, &found.at_start, alpha_n, alpha_t, model)?;
    if bond.is_some() {
        found = friction.laws(&place, &mut points, &model.mesh, alpha_t, Additions { bond, ..additions })?;
    }
    let fades = bond.map(|_| fades(&place, contact, alpha_n, model)).transpose()?;
    let Laws { at_start: laws, in_time, truncated } = found;
    for stiffness in laws.iter().map(|law| law.description.stiffness).filter(|stiffness| *stiffness > 0.0) {
        check_size(&format!("{place}.friction"), "alpha_t", stiffness)?;
    }
    let of_bodies = match contact.fluid_pressure {
        Some(FluidPressure::OfBodies) => pore_pressure::fluid_of_bodies(&contact.slave, model, &place)?,
        _ => None,
    };
    let slaves: Vec<usize> = points.iter().flat_map(|point| point.position.iter().map(|(node, _)| *node)).collect();
    let given = fluid::fluid(&place, contact.fluid_pressure.as_ref(), &slaves, &model.mesh)?;
    let conduit = conduit::conduit(&place, contact, &points, model)?;
    let pores = if of_bodies.is_some() { None } else { pores::pores(&place, contact, &points, model)? };
    let seam = seam::seam(&place, contact, conduit.as_ref(), model)?;
    let dry = conduit.as_ref().filter(|conduit| !conduit.is_wet());
    let mut pair = ContactPair {
        name: contact.name.clone(),
        tied: contact.tied,
        body: body(contact, points.first(), model),
        bodies: bodies(contact, model),
        touch: TOUCH * size(&points, model),
        points,
        mortar,
        alpha_n,
        compliance,
        penetration: contact.normal.penetration,
        stick: contact.stick,
        radiation: radiation(&place, contact, model)?,
        fluid: of_bodies.or(given).or_else(|| dry.map(|conduit| conduit::at_start(conduit, model))),
        conduit,
        pores,
        seam,
        laws,
        in_time,
        truncated,
        initial: None,
        comes_stressed: false,
        unseen: Vec::new(),
        modulus: modulus(contact, model),
        both: unseen::both_surfaces(contact, model, outline),
        small: None,
        fades,
        master,
    };
    if contact.tied {
        contact::check_tied(contact, &place)?;
        pair.tie(contact.sliding == SlidingRange::Small, &model.mesh.undeformed());
        contact::check_ties(&pair, &place)?;
        initial::carry(&mut pair, &contact.slave, model);
    } else if contact.sliding == SlidingRange::Small {
        let message = "self-contact comes about by large motion, and small sliding keeps the initial projections: \
                       take finite sliding, or name the two parts that touch as slave and master";
        refuse_if(contact.is_own(), format!("{place}.sliding"), message)?;
        pair.slide_little(&model.mesh.undeformed());
    }
    check_stick(&pair, &place)?;
    Ok(pair)
}

/// Gap at which surfaces touch, as a fraction of the shortest edge of the slave.
const TOUCH: f64 = 1e-9;

/// Length of the shortest edge of a slave point; for points without edges the length with their area [L].
fn size(points: &[SlavePoint], model: &Model) -> f64 {
    let undeformed = model.mesh.undeformed();
    let of = |point: &SlavePoint| {
        point.edge_length(&undeformed).unwrap_or_else(|| match model.mesh.section {
            Section::Axisymmetric => point.area.sqrt(),
            Section::PlaneStress { thickness } => point.area / thickness,
            _ => point.area,
        })
    };
    points.iter().map(of).fold(f64::INFINITY, f64::min)
}

/// Bodies of the sides of a contact.
fn bodies(contact: &Contact, model: &Model) -> [Vec<usize>; 2] {
    let of = |name: &str| -> BTreeSet<usize> {
        match model.mesh.group(name) {
            Ok(Group::Edges(edges)) => edges.iter().map(|edge| model.body_of_element[edge.element]).collect(),
            Ok(Group::Nodes(nodes)) => {
                let has = |body: usize| nodes.iter().any(|node| model.bodies[body].nodes.binary_search(node).is_ok());
                (0..model.bodies.len()).filter(|body| has(*body)).collect()
            }
            _ => BTreeSet::new(),
        }
    };
    let master = contact.master_group().map(of).unwrap_or_default();
    [of(&contact.slave), master].map(|side| side.into_iter().collect())
}

/// Body of the slave's edge at its first point; a node may belong to two bodies, an edge does not.
fn body(contact: &Contact, first: Option<&SlavePoint>, model: &Model) -> Option<usize> {
    let (node, _) = *first?.position.first()?;
    match model.mesh.group(&contact.slave) {
        Ok(Group::Edges(edges)) => {
            let edge = edges.iter().find(|edge| edge.nodes.contains(&node))?;
            Some(model.body_of_element[edge.element])
        }
        _ => {
            let mut there = (0..model.bodies.len()).filter(|&k| model.bodies[k].nodes.binary_search(&node).is_ok());
            there.next().filter(|_| there.next().is_none())
        }
    }
}

/// Lets a contact begin with its tractions or its overlap, or come later under stress.
fn begin(pair: &mut ContactPair, contact: &Contact, model: &Model, absent: &BTreeSet<usize>) -> Checked<()> {
    let place = format!("contacts.{}", contact.name);
    pair.comes_stressed = pair.bodies.iter().flatten().any(|body| absent.contains(body))
        && contact.initial.as_ref().is_some_and(|initial| initial.of_bodies);
    initial::start(pair, contact, model, &place)?;
    pair.find_corners(&model.mesh.nodes);
    fluid::check_fluid(pair, &place, model, 0.0)
}

/// Round-off of gaps relative to the size of the surfaces; gaps are differences of positions and displacements.
const OF_SIZE: f64 = 8.0 * f64::EPSILON;

/// A penetration, and an elastic slip, must be one that displacements can tell.
fn check_allowed(contacts: &[Contact], mesh: &Mesh) -> Checked<()> {
    for contact in contacts {
        let groups = [Some(contact.slave.as_str()), contact.master_group()].into_iter().flatten();
        let nodes = groups.filter_map(|name| mesh.groups.get(name)).flat_map(|group| mesh.nodes_of(group));
        let least = OF_SIZE * mesh.size_of(nodes);
        let keys = [("normal.penetration", contact.normal.penetration), ("stick", contact.stick)];
        for (key, allowed) in keys.into_iter().filter_map(|(key, allowed)| Some((key, allowed?))) {
            let place = format!("contacts.{}.{key}", contact.name);
            check_positive(&place, allowed, " (leave it out for the plain penalty)")?;
            let message =
                format!("is {allowed:e}: gaps of this contact have round-off of {least:.1e}; allow more than that");
            refuse_if(allowed < least, place, message)?;
        }
    }
    Ok(())
}

/// Elastic slip that is a part of the law cannot be taken away.
fn check_stick(pair: &ContactPair, place: &str) -> Checked<()> {
    let has_penalty = pair.laws.iter().any(|law| law.description.stiffness_is_penalty);
    let message = "is for laws whose alpha_t is a penalty (coulomb, adhesion, slip_weakening), and here elastic slip is part of the law, \
                   or there is no friction: leave it out";
    refuse_if(pair.stick.is_some() && !has_penalty, format!("{place}.stick"), message)
}

/// Method of a contact of edges; `None` for a point group.
pub fn evaluation(contact: &Contact, mesh: &Mesh, regime: Regime) -> Option<Chosen> {
    let groups = [Some(contact.slave.as_str()), contact.master_group()];
    contact.area.is_none().then(|| choose(groups, asked(contact, mesh, regime), mesh))
}

/// What a contact says of its method.
fn asked(contact: &Contact, mesh: &Mesh, regime: Regime) -> Asked {
    let Contact { method, points, smooth, .. } = contact;
    Asked {
        method: *method,
        points: *points,
        smooth: *smooth,
        regime,
        tied: contact.tied,
        small: contact.tied || contact.sliding == SlidingRange::Small,
        tool: tool(contact, mesh),
    }
}

/// Shape of a rigid master; one that is not valid is refused elsewhere.
fn tool(contact: &Contact, mesh: &Mesh) -> Tool {
    match &contact.master {
        MasterSide::Plane { .. } | MasterSide::Group(_) => Tool::Flat,
        MasterSide::Circle { .. } => Tool::Bent,
        MasterSide::Polyline { .. } | MasterSide::Outline { .. } => match contact::shape(&contact.master, mesh, "") {
            Ok(Shape::Polyline(line)) if line.is_sharp() => Tool::Sharp,
            _ => Tool::Bent,
        },
    }
}

/// Whether a contact meets a rigid master with corners, by Gauss points and the slave's corners unless given otherwise.
fn meets_corners(contact: &Contact, mesh: &Mesh) -> bool {
    let free = contact.method.is_none() && contact.points.is_none();
    let slides = !contact.tied && contact.sliding != SlidingRange::Small;
    free && slides && contact.area.is_none() && tool(contact, mesh) == Tool::Sharp
}

/// Nodes of quadratic edges that have a traction. What is tied, keeps nodes that face nodes or waves that a middle node would average
/// has one at each; so has what carries an initial stress of its bodies: constant along edges, a pressure that grows with depth would not
/// be in equilibrium with it at each node; and so have edges against a bent rigid master, which a mean over an edge lets in.
pub fn hats(contact: &Contact, mesh: &Mesh, regime: Regime) -> Hats {
    let asked = asked(contact, mesh, regime);
    let explicit = matches!(regime, Regime::Explicit | Regime::QuasiDynamic);
    let faces = || contact.master_group().is_some_and(|master| nodes_meet(&contact.slave, master, mesh));
    let under_stress = contact.initial.as_ref().is_some_and(|initial| initial.of_bodies || initial.balanced);
    let bent = asked.tool != Tool::Flat;
    let at_nodes = contact.tied || explicit || under_stress || bent || asked.small && faces();
    if at_nodes { Hats::AtNodes } else { Hats::OfEdges }
}

/// Slave nodes whose mass is moved away.
pub fn massless(contacts: &[Contact], mesh: &Mesh) -> Checked<Vec<bool>> {
    let mut massless = vec![false; mesh.nodes.len()];
    for contact in contacts.iter().filter(|contact| contact.massless) {
        let place = format!("contacts.{}", contact.name);
        let message = "is for a slave group of edges, whose elements have the mass: leave it out";
        refuse_if(contact.area.is_some(), format!("{place}.massless"), message)?;
        let slave = edges(mesh, &contact.slave, &format!("{place}.slave"))?;
        slave.iter().flat_map(|edge| &edge.nodes).for_each(|&node| massless[node] = true);
    }
    Ok(massless)
}

/// Slave points of edges, or the points of a point group with the given area; and the edges for mortar averages.
fn slave_points(
    place: &str,
    contact: &Contact,
    mesh: &Mesh,
    regime: Regime,
) -> Checked<(Vec<SlavePoint>, Option<Mortar>)> {
    let name = &contact.slave;
    let slave = format!("{place}.slave");
    if let Group::Nodes(nodes) = group(mesh, name, &slave)? {
        return Ok((lone_points(place, contact, nodes)?, None));
    }
    let edges = in_order(&node_lists(edges(mesh, name, &slave)?));
    let Some(Chosen { method, points, .. }) = evaluation(contact, mesh, regime) else {
        let message = format!("`{name}` is a group of edges, which have lengths of their own: leave the area out");
        return Err(ModelError::new(format!("{place}.area"), message));
    };
    refuse_if(!(2..=4).contains(&points), format!("{place}.points"), format_args!("is {points}: must be 2, 3 or 4"))?;
    Ok(match method {
        Method::NodeToSegment if mesh.section.is_axisymmetric() => (nodal_points_of_rings(&edges), None),
        Method::NodeToSegment => (nodal_points(&edges), None),
        Method::GaussToSegment if meets_corners(contact, mesh) => {
            (gauss_points_and_corners(&edges, |edge, end| is_corner(&edges, &mesh.nodes, edge, end)), None)
        }
        Method::GaussToSegment => (gauss_points(&edges, points), None),
        Method::Mortar => {
            let (points, mortar) = mortar_points(&edges, hats(contact, mesh, regime), &mesh.nodes);
            (points, Some(mortar))
        }
    })
}

fn lone_points(place: &str, contact: &Contact, nodes: &[usize]) -> Checked<Vec<SlavePoint>> {
    let at = format!("{place}.area");
    let Some(area) = contact.area else {
        let message =
            format!("is missing: `{}` is a group of points, and each needs its tributary area", contact.slave);
        return Err(ModelError::new(at, message));
    };
    check_positive(&at, area, "")?;
    check_size(place, "area", area)?;
    Ok(nodes.iter().map(|&node| lone_point(node, area)).collect())
}

fn master(place: &str, contact: &Contact, points: &[SlavePoint], model: &Model) -> Checked<Master> {
    let mesh = &model.mesh;
    let refuse_smooth_if = |fails: bool, why: &str| refuse_if(contact.smooth && fails, format!("{place}.smooth"), why);
    let Some(group) = contact.master_group() else {
        refuse_smooth_if(true, "is for a master of mesh edges, and a rigid body needs none: leave it out")?;
        let shape = contact::shape(&contact.master, mesh, &format!("{place}.master"))?;
        return Ok(Master::Rigid(Rigid { shape, body: rigid::of_contact(contact, mesh, place)? }));
    };
    rigid::of_contact(contact, mesh, place)?;
    let master = edges(mesh, group, &format!("{place}.master"))?;
    let mut surface = Surface::new(&node_lists(master));
    if contact.is_own() {
        let thinnest = master.iter().map(|edge| depth_behind(edge, model)).fold(f64::INFINITY, f64::min);
        surface = surface.against_itself(0.5 * thinnest);
    } else {
        check_disjoint(place, &contact.slave, group, points, master, mesh)?;
    }
    if !contact.smooth {
        return Ok(Master::Mesh(surface));
    }
    let why = "is not for mortar, which averages the gap: leave it out, or take gauss_to_segment";
    refuse_smooth_if(contact.method == Some(Method::Mortar), why)?;
    let why = "is for straight edges, and the master has quadratic ones: leave it out";
    refuse_smooth_if(master.iter().any(|edge| edge.nodes.len() > 2), why)?;
    Ok(Master::Mesh(surface.smoothed(&mesh.nodes)))
}

/// Checks that two groups in contact have no common edges, and that a slave point without edges is not on the master.
fn check_disjoint(
    place: &str,
    slave: &str,
    master: &str,
    points: &[SlavePoint],
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
    Err(ModelError::new(place, message))
}

/// η of a contact, 0 if not used.
pub fn radiation(place: &str, contact: &Contact, model: &Model) -> Checked<f64> {
    let at = format!("{place}.radiation_damping");
    let damping = match contact.radiation_damping {
        Radiation::OfBodies(false) => return Ok(0.0),
        Radiation::Given(damping) => damping,
        Radiation::OfBodies(true) => of_bodies(place, &at, contact, model)?,
    };
    check_positive(&at, damping, " (leave it out for none)")?;
    check_size(place, "radiation_damping", damping)?;
    Ok(damping)
}

/// η by (2), averaged over the edges of each side on the bodies that face each other.
fn of_bodies(place: &str, at: &str, contact: &Contact, model: &Model) -> Checked<f64> {
    let message = "has no default for a slave group of points, behind which there is no body: give a number";
    refuse_if(contact.area.is_some(), at, message)?;
    let impedance = |edge: &Edge| {
        let body = model.body_of(edge.element);
        let (density, modulus) = (body.material.description().density, body.material.description().shear_modulus);
        if density > 0.0 {
            return Ok((density * modulus).sqrt());
        }
        let message =
            format!("needs the density of body `{}`, which is {density}: give it, or a number here", body.name);
        Err(ModelError::new(at, message))
    };
    let mean = |edges: &[&Edge]| -> Checked<f64> {
        let all = edges.iter().map(|edge| impedance(edge)).collect::<Checked<Vec<f64>>>()?;
        Ok(all.iter().sum::<f64>() / all.len() as f64)
    };
    let Facing { slave, master } = facing(place, contact, model)?;
    let of_slave = mean(&slave)?;
    if master.is_empty() {
        return Ok(of_slave);
    }
    let of_master = mean(&master)?;
    Ok(of_slave * of_master / (of_slave + of_master))
}

/// α_n over (λ + 2G)/h where all steps are static, by (1), and α_t where `stick` takes elastic slip away: the stiffer, the fewer passes [-]
const STATIC: f64 = 300.0;

/// α_t over (λ + 2G)/h there, where it is a penalty [-]
const HOLDING: f64 = 15.0;

/// α_n at Gauss points but on planes, and where a step has inertia, or explicit increments, by (2) [-]
const SOFTER: f64 = 10.0;

/// The same of surfaces that are tied, without explicit increments [-]
const TIED: f64 = 1e4;

/// α_t over (λ + 2G)/h otherwise, by (2) [-]
const TANGENTIAL: f64 = 5.0;

/// Stiffnesses of a contact.
pub struct Penalty {
    /// α_n [F/L³]
    pub alpha_n: f64,
    /// Default α_t; `None` for a point group as slave
    pub alpha_t: Option<DefaultAlphaT>,
    /// h/(λ + 2G): compliance of the bodies under a contact pressure; 0 without elements at the slave [L³/F]
    pub compliance: f64,
}

/// α_n over (λ + 2G)/h unless given; in quasi-dynamic steps a fluid is to change the pressure, not the gap, and stiffness costs nothing [-]
#[doc(hidden)]
pub fn default_over(contact: &Contact, method: Option<Method>, regime: Regime) -> f64 {
    match regime {
        Regime::Static | Regime::Dynamic if contact.tied => TIED,
        Regime::Static if bears_stiffness(contact, method) => STATIC,
        Regime::QuasiDynamic if contact.fluid_pressure.is_some() => STATIC,
        _ => SOFTER,
    }
}

/// Returns α_t over (λ + 2G)/h of a law that gives none, where α_n is not given either [-]
#[doc(hidden)]
pub fn tangential_over(penalty: bool, contact: &Contact, method: Option<Method>, regime: Regime) -> f64 {
    let holds = penalty && regime == Regime::Static && bears_stiffness(contact, method);
    match holds {
        true if contact.stick.is_some() => STATIC,
        true => HOLDING,
        false => TANGENTIAL,
    }
}

/// Whether pressures stay smooth however stiff the penalty is: at Gauss points on a plane, to which the gaps of an edge are those of its
/// nodes, and on no other master.
fn bears_stiffness(contact: &Contact, method: Option<Method>) -> bool {
    method != Some(Method::GaussToSegment) || matches!(contact.master, MasterSide::Plane { .. })
}

/// The penalties of a contact, those given checked, in a run of this regime.
pub fn penalty(place: &str, contact: &Contact, model: &Model, regime: Regime) -> Checked<Penalty> {
    let elastic = elastic_stiffness(place, contact, model)?;
    let method = evaluation(contact, &model.mesh, regime).map(|chosen| chosen.method);
    let at = format!("{place}.normal.alpha_n");
    let alpha_n = match (contact.normal.alpha_n, elastic) {
        (Some(alpha_n), _) => alpha_n,
        (None, Some(elastic)) => elastic * default_over(contact, method, regime),
        (None, None) => {
            return Err(ModelError::new(at, needs_stiffness(contact, model, regime)));
        }
    };
    check_positive(&at, alpha_n, " (leave it out for the default)")?;
    check_size(&format!("{place}.normal"), "alpha_n", alpha_n)?;
    let both = |alpha_t: f64| DefaultAlphaT { penalty: alpha_t, of_law: alpha_t };
    let alpha_t = match (contact.tied, contact.normal.alpha_n, elastic) {
        (true, ..) => both(alpha_n),
        (false, None, Some(elastic)) => {
            let [penalty, of_law] =
                [true, false].map(|penalty| elastic * tangential_over(penalty, contact, method, regime));
            DefaultAlphaT { penalty, of_law }
        }
        (false, ..) => both(0.5 * alpha_n),
    };
    let alpha_t = contact.area.is_none().then_some(alpha_t);
    Ok(Penalty { alpha_n, alpha_t, compliance: elastic.map_or(0.0, |elastic| 1.0 / elastic) })
}

/// α_t of the laws of a contact that give none, in a run of these steps; none for a slave group of points.
#[doc(hidden)]
pub fn default_alpha_t(contact: &Contact, model: &Model, steps: &[LoadStep]) -> Option<DefaultAlphaT> {
    penalty("", contact, model, regime(steps)).ok()?.alpha_t
}

/// (λ + 2G)/h of (1); `None` if the slave has no edges [F/L³].
fn elastic_stiffness(place: &str, contact: &Contact, model: &Model) -> Checked<Option<f64>> {
    if contact.area.is_some() {
        return Ok(None);
    }
    let Facing { slave, master } = facing(place, contact, model)?;
    let modulus = |edge: &Edge| model.body_of(edge.element).material.description().p_wave_modulus;
    let softest = master.into_iter().map(modulus).fold(f64::INFINITY, f64::min);
    let stiffness = |edge: &Edge| modulus(edge).min(softest) / depth_behind(edge, model);
    Ok(Some(slave.iter().map(|edge| stiffness(edge)).sum::<f64>() / slave.len() as f64))
}

/// What to give as α_n of a slave group of points: the default of sides with elements of that size, if there are any at the points.
fn needs_stiffness(contact: &Contact, model: &Model, regime: Regime) -> String {
    let nodes = model.mesh.group(&contact.slave).map(|group| model.mesh.nodes_of(group)).unwrap_or_default();
    let is_adjacent = |k: &usize| model.mesh.elements[*k].nodes.iter().any(|node| nodes.binary_search(node).is_ok());
    let stiffness = |k: usize| model.body_of(k).material.description().p_wave_modulus / model.solids[k].area().sqrt();
    let softest = (0..model.solids.len()).filter(is_adjacent).map(stiffness).fold(f64::INFINITY, f64::min);
    let advice = match softest.is_finite() {
        true => format!(
            "give {}, the default of element sides there",
            number(default_over(contact, None, regime) * softest)
        ),
        false => "give 100 times the stiffness of what holds the points, over their area".into(),
    };
    format!("is missing: points have no sides to choose it by, and get a spring of alpha_n × area each; {advice}")
}

/// Depth of the element at an edge [L].
pub fn depth_behind(edge: &Edge, model: &Model) -> f64 {
    let [a, b] = [0, 1].map(|end| model.mesh.nodes[edge.nodes[end]]);
    model.solids[edge.element].area() / (b - a).norm()
}

/// G*: stiffness against slip that varies along the interface, 0 for points without bodies [F/L²]
///
/// ```text
/// 1/G* = ½ (1/G₁* + 1/G₂*),   Gᵢ* = Gᵢ/(1 − νᵢ),   a rigid master has 1/G₂* = 0
/// ```
pub fn modulus(contact: &Contact, model: &Model) -> f64 {
    let compliance = |edge: &Edge| 1.0 / plane(&*model.body_of(edge.element).material);
    let Ok(Facing { slave, master }) = facing("", contact, model) else { return 0.0 };
    let [slave, master] = [slave, master].map(|side| side.into_iter().map(compliance).fold(0.0, f64::max));
    2.0 / (slave + master)
}

/// G/(1 − ν) = 2 G (M − G)/M,   M = λ + 2 G
fn plane(material: &dyn Material) -> f64 {
    let (shear, constrained) = (material.description().shear_modulus, material.description().p_wave_modulus);
    2.0 * shear * (constrained - shear) / constrained
}
