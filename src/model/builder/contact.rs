//! Input of a contact, with checks of its rigid master.

use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::conduit_input::Flow;
use super::error::{Checked, ModelError, check_place, check_positive, refuse_if};
use super::fluid::{FluidForms, FluidPressure};
use super::friction::{Along, Friction};
use super::groups;
use super::interface::Interface;
use crate::contact::master::{Circle, Plane, Polyline, Shape};
use crate::contact::pair::ContactPair;
use crate::laws::friction::{BondParameters, Dilatancy, FrictionParameters};
use crate::mesh::Mesh;
use crate::model::boundary::Profile;
use crate::model::measured::Measured;
use crate::model::method::Method;
use crate::model::written::written;

/// A contact pair.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Contact {
    /// Name in messages and results; the key of the contact in a case
    #[serde(skip)]
    pub name: String,
    /// Edge group whose points are kept out of the master, the finer or softer side; or a point group, each point with the
    /// `area`
    pub slave: String,
    /// Tributary area of each point of a point group as slave, including the thickness or the full turn; it is
    /// constant. Edges have lengths of their own [L for thickness 1, or L²]
    pub area: Option<f64>,
    /// Edge group, or a rigid body. The slave's group again: self-contact of the surface; each point then has half its
    /// tributary length, because every contact is evaluated from both sides
    pub master: MasterSide,
    /// Moving rigid body to which a rigid master belongs: one of `rigid_bodies`; default: the master is fixed
    pub rigid_body: Option<String>,
    /// Contact method. By default mortar against a mesh in a run without explicit increments; node_to_segment where a step is quasi_dynamic.
    /// Against rigid masters, and in runs with explicit increments: mortar where an edge of either side is quadratic or a side curved (its direction
    /// turns by more than 1° between two corners of more than 45°);
    /// node_to_segment where straight linear or quadratic edges meet a bent rigid master, or a slave with a corner a rigid plane;
    /// gauss_to_segment against a polyline or outline with a corner of more than 45°, there with points at the slave's own corners and ends;
    /// it also otherwise, with a `smooth` master, and where `points` are given
    pub method: Option<Method>,
    /// Gauss points per slave edge (gauss_to_segment), 2 to 4; default 2, and 4 for quadratic edges against a rigid master with corners
    pub points: Option<usize>,
    /// Whether the master's straight edges are replaced by a smooth curve through their nodes (not with mortar), so
    /// that forces do not jump where a slave slides from one edge to the next. Corners of more than 45° remain
    #[serde(default)]
    pub smooth: bool,
    /// Sliding range: finite, or small compared with the distance between nodes
    #[serde(default)]
    pub sliding: SlidingRange,
    /// Normal contact
    #[serde(default)]
    pub normal: Normal,
    /// Largest elastic slip allowed where surfaces stick [L], for laws that know none, whose alpha_t is a penalty (coulomb,
    /// adhesion, slip_weakening): the traction is adjusted until no elastic slip is larger, as `penetration` does it along the normal;
    /// default: penalty only
    pub stick: Option<f64>,
    /// Gap of the surfaces at the start, the same at every point that faces the master, instead of the gaps of the mesh: positive for a
    /// clearance, negative for an interference. All later gaps are measured relative to it, so that neither facets nor the accuracy of
    /// the mesh change it [L]
    pub clearance: Option<f64>,
    /// Whether the initial overlap of the surfaces, or a negative `clearance`, is applied gradually over the first step (shrink fit)
    /// instead of at once
    #[serde(default)]
    pub shrink_fit: bool,
    /// Implicit dynamics: the mass of the slave's nodes is moved to the other nodes of their elements, so that impact
    /// does not excite spurious oscillation of these nodes and of the contact force
    #[serde(default)]
    pub massless: bool,
    /// Whether the surfaces are tied: they neither part nor slide, whatever pulls at them, however large the motion. Every
    /// slave point keeps the place on the master that it faces in the mesh, across a gap as well (the finer side is the slave); points that face nothing stay free. Pressure and traction count per initial length.
    /// Without `friction`
    #[serde(default)]
    pub tied: bool,
    /// Friction law; only surfaces that are tied have none
    #[serde(default = "Friction::tie", skip_serializing_if = "Friction::is_tie")]
    #[schemars(with = "FrictionParameters")]
    pub friction: Friction,
    /// Strength of the interface as a share of that of the adjacent soil, or by cohesion and angle of friction: Coulomb friction and a
    /// bond, which `check --resolved` shows. In place of `friction`
    pub interface: Option<Interface>,
    /// Bond of the surfaces in parallel with friction: strength without pressure. With `adhesion`, or `cohesion` of slip_weakening, it takes the
    /// `opening` over which that fades, and a `limit`
    pub bond: Option<BondParameters>,
    /// Dilatancy: opening by plastic slip
    pub dilatancy: Option<Dilatancy>,
    /// k of Archard's law: the surfaces wear by dw = k p × plastic slip, in either direction of slip; k is the wear
    /// coefficient divided by the hardness. The wear depth w is `wear` in tables and frames [L²/F]
    pub wear: Option<f64>,
    /// Static steps: radiation damping, a traction η × slip rate that resists slip in addition to friction and
    /// approximates the inertia that is neglected, by shear waves radiated into unbounded bodies. A number is η
    /// [F·T/L³]; true takes the impedances of the bodies, 1/η = 1/Z₁ + 1/Z₂ with Z = ρ c_s of each side: G/(2 c_s) for
    /// equal bodies, Z on a rigid master. Dynamic and explicit steps have inertia, and omit it
    #[serde(default)]
    pub radiation_damping: Radiation,
    /// p_w: pressure of a fluid between the surfaces, zero or positive; expressions may depend on the run time t and on
    /// the reference position x, y of the slave. It acts on both surfaces wherever the slave projects onto the master,
    /// closed or open, in addition to the contact pressure p; friction, `initial.pressure` and all outputs called
    /// pressure use this effective p only. What acts at t = 0 of a contact with `initial` is there before anything moves, in addition
    /// to `initial.pressure`; what the run raises is 0 at t = 0. A pressure that is given does not flow; {"flow": {…}} is that of water which
    /// flows along the contact. "of_bodies" takes it from the pores of the
    /// slave's bodies (`pore_fluid`), whose total stress the contact carries: friction goes by what p_w leaves of it.
    /// {"measured": {"file": …}} takes it from a table of time and place [F/L²]
    #[schemars(with = "Option<FluidForms>")]
    pub fluid_pressure: Option<FluidPressure>,
    /// κ: water flows from one body to the other across the contact, closed or open, by κ times the difference of its pressures, κ ≥ 0; default 1000 times
    /// what passes through an element adjacent to it, so that the pressure has no jump. Of two bodies whose water flows (`permeability`); where water flows along the
    /// contact, from there into each of the bodies whose water flows [L³/(F T)]
    pub seal: Option<f64>,
    /// p̄: surfaces that part drain to a place of this pressure, 0 for air, and are filled from there; unless given, they are filled from the pores. κ of the drain grows with the third
    /// power of the opening. Of bodies whose water flows (`permeability`) [F/L²]
    pub open_pressure: Option<f64>,
    /// Friction parameters that vary along the slave and in time
    #[serde(default)]
    pub along: Along,
    /// Tractions and structure at the start of a contact that starts closed. The gap of every slave point is then
    /// measured, throughout the run, relative to the gap at which this pressure acts in its initial position
    pub initial: Option<InitialTractions>,
}

/// Normal contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Normal {
    /// α_n: pressure per penetration [F/L³]; default 300 (λ + 2G)/h, with λ + 2G of the softer body and the depth h of
    /// the slave's elements; 10 (λ + 2G)/h at Gauss points but on planes, and where a step has inertia, is quasi_dynamic without `fluid_pressure` or has `rupture`. A slave group of
    /// points has no elements and needs a number
    pub alpha_n: Option<f64>,
    /// Largest penetration allowed [L]: the pressure is increased until no penetration is larger (augmented Lagrangian
    /// by Uzawa's method), so that the solution does not depend on alpha_n; default: penalty only
    pub penetration: Option<f64>,
}

/// Sliding range of the surfaces of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "Sliding")]
#[non_exhaustive]
pub enum SlidingRange {
    /// Finite sliding and rotation: every point is projected on the current master
    #[default]
    Finite,
    /// Slip small compared with the distance between nodes: every point keeps its initial projection, normal, nodal
    /// weights and tributary length, so that gap and slip are linear in the displacements. With linear bodies, only
    /// friction and opening are nonlinear then. For small rotations only; points without a projection at the start
    /// never come into contact. A run warns where a point slides by more than a tenth of the distance between nodes, or
    /// a surface rotates or stretches by more than 0.02. Not for self-contact
    Small,
}

/// The master side: a group of the mesh, or a rigid master given by a formula or an outline, fixed unless `rigid_body` names a
/// moving body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(remote = "Self", rename_all = "snake_case", deny_unknown_fields)]
#[schemars(rename = "Master")]
#[non_exhaustive]
pub enum MasterSide {
    /// A rigid half-space
    Plane {
        /// A point of its surface [L]
        point: [f64; 2],
        /// Outward normal of the solid, of any length
        normal: [f64; 2],
    },
    /// A rigid disk, or the rim of a hole
    Circle {
        /// Centre [L]
        centre: [f64; 2],
        /// Radius [L]
        radius: f64,
        /// Whether the solid is outside the circle
        #[serde(default)]
        hole: bool,
    },
    /// A rigid body bounded by straight lines
    Polyline {
        /// Corners, with the solid on the right in their order; repeating the first corner at the end closes the line [L]
        points: Vec<[f64; 2]>,
    },
    /// A rigid body bounded by lines of the mesh that are sides of no element, such as a physical curve without a surface
    Outline {
        /// Name of their group. The lines form one chain, with the solid on the right in their direction; they are replaced by
        /// straight ones through their nodes
        group: String,
    },
    /// Edge group of the mesh; the slave's own group means self-contact
    #[serde(skip)]
    #[schemars(!skip, untagged)]
    Group(String),
}

written!(
    MasterSide,
    "the name of an edge group, or a rigid body such as {\"plane\": {\"point\": [x, y], \"normal\": [x, y]}}",
    text: Group
);

impl From<&str> for MasterSide {
    fn from(group: &str) -> Self {
        Self::Group(group.into())
    }
}

/// Radiation damping of a contact in static steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "must be true, false or a number")]
#[non_exhaustive]
pub enum Radiation {
    /// true: computed from the impedances of the bodies, as dashpots in series; false: none
    OfBodies(bool),
    /// η [F·T/L³]
    Given(f64),
}

impl Default for Radiation {
    fn default() -> Self {
        Self::OfBodies(false)
    }
}

/// Initial state of a contact that starts closed.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Initial")]
#[non_exhaustive]
pub struct InitialTractions {
    /// p: contact pressure, zero or positive [F/L²]. Where it is 0, and no traction acts, the deepest overlap and 10⁻⁶ of the slave's edge
    /// are taken out of all gaps, and what is left of them stays open
    pub pressure: Option<Profile>,
    /// q: traction that resists the slip of the slave along +s, the master's normal turned by −90° [F/L²]
    pub traction: Option<Profile>,
    /// 1/R*: structure of the super/subloading law, from 1 to μ_s/μ_k; default: that of the law [-]
    pub structure: Option<Profile>,
    /// Whether an initial stress of the bodies is in equilibrium with these tractions. Displacements and stresses of
    /// the run are then changes from the initial stress
    #[serde(default)]
    pub balanced: bool,
    /// Instead of pressure and traction: those of the `initial_stress` of the slave's body at the contact, p = −n·σn
    /// (minus an initial fluid pressure) and q = s·σn, with the normal n and the tangent s of the master. Of a contact that comes in
    /// a later step: those of the stress in force by then, in the body that was there before, with surfaces that fit
    #[serde(default)]
    pub of_bodies: bool,
}

impl Contact {
    /// Creates a penalty contact of an edge group with another or with a rigid body.
    pub fn new(
        name: impl Into<String>,
        slave: impl Into<String>,
        master: impl Into<MasterSide>,
        friction: impl Into<Friction>,
    ) -> Self {
        Self {
            name: name.into(),
            slave: slave.into(),
            area: None,
            master: master.into(),
            rigid_body: None,
            method: None,
            points: None,
            smooth: false,
            sliding: SlidingRange::Finite,
            normal: Normal::default(),
            stick: None,
            clearance: None,
            shrink_fit: false,
            massless: false,
            tied: false,
            friction: friction.into(),
            interface: None,
            bond: None,
            dilatancy: None,
            wear: None,
            radiation_damping: Radiation::default(),
            fluid_pressure: None,
            seal: None,
            open_pressure: None,
            along: Along::default(),
            initial: None,
        }
    }

    /// Creates a contact whose strength is a share of that of the adjacent soil, or given by cohesion and angle.
    pub fn with_interface(
        name: impl Into<String>,
        slave: impl Into<String>,
        master: impl Into<MasterSide>,
        interface: Interface,
    ) -> Self {
        Self { interface: Some(interface), ..Self::new(name, slave, master, Friction::tie()) }
    }

    /// Creates a contact of tied surfaces.
    pub fn tied(name: impl Into<String>, slave: impl Into<String>, master: impl Into<MasterSide>) -> Self {
        Self { tied: true, ..Self::new(name, slave, master, Friction::tie()) }
    }

    /// The group of a master of mesh edges.
    pub(super) fn master_group(&self) -> Option<&str> {
        match &self.master {
            MasterSide::Group(group) => Some(group),
            _ => None,
        }
    }

    /// Whether the slave is its own master (self-contact).
    pub(super) fn is_own(&self) -> bool {
        self.master_group() == Some(&self.slave)
    }
}

setters! { contact: Contact;
    /// Sets the normal penalty α_n [F/L³].
    alpha_n(alpha_n: f64) { contact.normal.alpha_n = Some(alpha_n); }

    /// Makes a rigid master move with a rigid body of the model.
    rigid_body(name: impl Into<String>) { contact.rigid_body = Some(name.into()); }

    /// Sets the contact method.
    method(method: Method) { contact.method = Some(method); }

    /// Sets the number of Gauss points per edge.
    points(points: usize) { contact.points = Some(points); }

    /// Smooths the edges of the master to a curve.
    smooth() { contact.smooth = true; }

    /// Sets the gap at the start, instead of that of the mesh; negative for an interference [L].
    clearance(gap: f64) { contact.clearance = Some(gap); }

    /// Makes it a shrink fit: an initial overlap is applied gradually over the first step.
    shrink_fit() { contact.shrink_fit = true; }

    /// Moves the mass of the slave's nodes away from them, for impact without spurious oscillation.
    massless() { contact.massless = true; }

    /// Sets friction parameters that vary along the slave and in time.
    along(along: Along) { contact.along = along; }

    /// Sets the largest penetration allowed (augmented Lagrangian method) [L].
    penetration(largest: f64) { contact.normal.penetration = Some(largest); }

    /// Sets the largest elastic slip of what sticks (augmented Lagrangian method) [L].
    stick(largest: f64) { contact.stick = Some(largest); }

    /// Selects small sliding: every point keeps its projection, the weights of both sides, its normal and its length
    /// ([`crate::contact::small_sliding`]).
    small_sliding() { contact.sliding = SlidingRange::Small; }

    /// Bonds the surfaces, in parallel with friction; or sets the opening over which the cohesion of friction fades.
    bond(bond: BondParameters) { contact.bond = Some(bond); }

    /// Sets dilatancy: opening by plastic slip.
    dilatancy(dilatancy: Dilatancy) { contact.dilatancy = Some(dilatancy); }

    /// Sets wear by k p per plastic slip [L²/F].
    wear(k: f64) { contact.wear = Some(k); }

    /// Sets the radiation damping in static steps.
    radiation(radiation: Radiation) { contact.radiation_damping = radiation; }

    /// Sets the pressure p_w of a fluid, by reference position and time [F/L²].
    fluid_pressure(pressure: impl Into<Profile>) {
        contact.fluid_pressure = Some(FluidPressure::Given(pressure.into()));
    }

    /// Sets κ of a seal between two bodies whose water flows [L³/(F T)].
    seal(conductance: f64) { contact.seal = Some(conductance); }

    /// Drains surfaces that part to a place of this pressure [F/L²].
    open_pressure(pressure: f64) { contact.open_pressure = Some(pressure); }

    /// Sets the pressure p_w of a fluid from a table of time and place.
    measured_pressure(measured: Measured) { contact.fluid_pressure = Some(FluidPressure::Measured(measured)); }

    /// Lets water flow along the contact.
    water(flow: Flow) { contact.fluid_pressure = Some(FluidPressure::Flow(Box::new(flow))); }

    /// Makes friction go by the effective stress, with the pressure of the fluid in the pores of the slave's bodies.
    fluid_pressure_of_bodies() { contact.fluid_pressure = Some(FluidPressure::OfBodies); }

    /// Sets the tributary area of each point of a point group [L].
    area(area: f64) { contact.area = Some(area); }

    /// Starts the contact closed under a pressure and a traction.
    initial(pressure: impl Into<Profile>, traction: impl Into<Profile>) {
        let (pressure, traction) = (Some(pressure.into()), Some(traction.into()));
        contact.initial = Some(InitialTractions { pressure, traction, ..InitialTractions::default() });
    }

    /// Starts the contact closed under the tractions of the initial stress of the slave's body.
    initial_of_bodies() {
        contact.initial = Some(InitialTractions { of_bodies: true, ..InitialTractions::default() });
    }

    /// Sets the initial structure 1/R*, by reference position.
    structure(structure: impl Into<Profile>) {
        contact.initial.get_or_insert_default().structure = Some(structure.into());
    }

    /// Declares the initial stress of the bodies to be in equilibrium with the initial tractions.
    balanced() {
        if let Some(initial) = &mut contact.initial {
            initial.balanced = true;
        }
    }
}

/// Returns the shape of a rigid master.
pub fn shape(side: &MasterSide, mesh: &Mesh, place: &str) -> Checked<Shape> {
    match side {
        MasterSide::Group(group) => Err(ModelError::new(place, format!("`{group}` is a group, not a rigid body"))),
        MasterSide::Plane { point, normal } => plane(*point, *normal, place),
        MasterSide::Circle { centre, radius, hole } => {
            check_place(&format!("{place}.circle.centre"), *centre)?;
            check_positive(&format!("{place}.circle.radius"), *radius, "")?;
            check_place(&format!("{place}.circle.radius"), [*radius])?;
            Ok(Shape::Circle(Circle { centre: Vector2::from(*centre), radius: *radius, hole: *hole }))
        }
        MasterSide::Polyline { points } => {
            let corners = points.iter().map(|&point| Vector2::from(point)).collect();
            polyline(corners, &format!("{place}.polyline.points"))
        }
        MasterSide::Outline { group } => {
            let place = format!("{place}.outline.group");
            polyline(groups::outline(mesh, group, &place)?, &place)
        }
    }
}

fn polyline(corners: Vec<Vector2<f64>>, place: &str) -> Checked<Shape> {
    check_place(place, corners.iter().flatten().copied())?;
    refuse_if(corners.len() < 2, place, format_args!("has {} points: must have two or more", corners.len()))?;
    if let Some(k) = corners.windows(2).position(|pair| (pair[1] - pair[0]).norm() == 0.0) {
        return Err(ModelError::new(place, format!("points {} and {} are the same: leave one out", k, k + 1)));
    }
    Ok(Shape::Polyline(Polyline::new(corners)))
}

fn plane(point: [f64; 2], normal: [f64; 2], place: &str) -> Checked<Shape> {
    check_place(&format!("{place}.plane.point"), point)?;
    let given = Vector2::from(normal);
    let Some(normal) = given.try_normalize(0.0).filter(|normal| normal.norm() > 0.5) else {
        let message = format!("is [{}, {}]: must have a direction, such as [0, 1]", given.x, given.y);
        return Err(ModelError::new(format!("{place}.plane.normal"), message));
    };
    Ok(Shape::Plane(Plane { point: Vector2::from(point), normal }))
}

/// A tie holds by itself, whatever the pressure: it takes no friction, and any other contact needs one.
pub fn check_has_friction(contact: &Contact, place: &str) -> Checked<()> {
    let message = match (contact.tied, contact.friction.is_tie()) {
        (true, false) => "is for surfaces that slide, and these are tied: leave it out",
        (false, true) => {
            "is missing: give the law, such as {\"law\": \"coulomb\", \"mu\": 0.3}, an `interface`, or \"tied\": true"
        }
        _ => return Ok(()),
    };
    Err(ModelError::new(format!("{place}.friction"), message))
}

/// Some point must face the master.
pub fn check_ties(pair: &ContactPair, place: &str) -> Checked<()> {
    let faces = pair.small.iter().flat_map(|small| &small.points).any(Option::is_some);
    let message = "ties nothing: no point of the slave has a projection on the master; check the groups named and their positions";
    refuse_if(!faces, format!("{place}.tied"), message)
}

/// Surfaces of two bodies can be tied, and what moves or presses them otherwise is refused.
pub fn check_tied(contact: &Contact, place: &str) -> Checked<()> {
    let fails = contact.master_group().is_none() || contact.is_own();
    let message = "is not another group of edges, to which a surface could be tied: constrain it by supports instead";
    refuse_if(fails, format!("{place}.master"), message)?;
    let adjacent = [
        ("area", contact.area.is_some()),
        ("smooth", contact.smooth),
        ("normal.penetration", contact.normal.penetration.is_some()),
        ("stick", contact.stick.is_some()),
        ("clearance", contact.clearance.is_some()),
        ("shrink_fit", contact.shrink_fit),
        ("massless", contact.massless),
        ("bond", contact.bond.is_some()),
        ("dilatancy", contact.dilatancy.is_some()),
        ("wear", contact.wear.is_some()),
        ("radiation_damping", contact.radiation_damping != Radiation::OfBodies(false)),
        ("fluid_pressure", contact.fluid_pressure.is_some()),
        ("open_pressure", contact.open_pressure.is_some()),
        ("along", !contact.along.is_empty()),
        ("initial", contact.initial.is_some()),
    ];
    let message = "has no meaning for surfaces that are tied: leave it out";
    adjacent.into_iter().try_for_each(|(key, given)| refuse_if(given, format!("{place}.{key}"), message))
}
