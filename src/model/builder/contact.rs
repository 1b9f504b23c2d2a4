//! A contact as it is given; its fluid, and its rigid master with its geometry checked.

use nalgebra::Vector2;

use super::error::{Checked, ModelError, check_finite};
use super::friction::{Friction, check_in_time};
use crate::contact::master::{Circle, Plane, Polyline, Rigid};
use crate::contact::pair::{BadPressure, ContactPair, Fluid};
use crate::laws::friction::Dilatancy;
use crate::model::Model;
use crate::model::boundary::Profile;
use crate::model::method::Method;

/// A slave surface, what it may touch, and the friction between them.
pub struct Contact {
    /// Name in messages and results
    pub name: String,
    /// Edge group whose points are kept out of the master, the finer or softer side; or a group of points, each with the `area`
    pub slave: String,
    /// Area that each point of a slave group of points stands for, with the thickness or the full turn [L, the thickness
    /// being 1, or L²]
    pub area: Option<f64>,
    /// What the slave may touch
    pub master: MasterSide,
    /// Where contact is evaluated; chosen by the surfaces unless given (see [`crate::model::method`])
    pub method: Option<Method>,
    /// Gauss points a slave edge, 2 to 4; 2 unless given
    pub points: Option<usize>,
    /// Whether the master's straight edges are taken for a smooth curve
    pub smooth: bool,
    /// Whether every point keeps meeting what it meets at the start (small sliding)
    pub small_sliding: bool,
    /// α_n: pressure per penetration; 10 (λ + 2G)/h unless given [F/L³]
    pub alpha_n: Option<f64>,
    /// Largest penetration left by the augmented Lagrangian; plain penalty unless given [L]
    pub penetration: Option<f64>,
    /// Whether an initial overlap is brought in over the first step
    pub shrink_fit: bool,
    /// Whether the mass of the slave's nodes is moved to the other nodes of their elements
    pub massless: bool,
    /// Friction
    pub friction: Friction,
    /// How far the surfaces move apart with plastic slip
    pub dilatancy: Option<Dilatancy>,
    /// k: depth of wear per pressure and plastic slip (Archard's law) [L²/F]
    pub wear: Option<f64>,
    /// Radiation damping in static steps, if there is any
    pub radiation: Option<Radiation>,
    /// p_w of a fluid that pushes the surfaces apart, if there is one ([`crate::contact::pair`]) [F/L²]
    pub fluid_pressure: Option<Profile>,
    /// Tractions of a contact that starts closed
    pub initial: Option<InitialTractions>,
}

/// What a slave may touch.
#[derive(Clone, Debug, PartialEq)]
pub enum MasterSide {
    /// Edge group; the slave's own is contact of the surface with itself
    Group(String),
    /// Rigid half-space: a point of its surface, and the direction out of it, of any length
    Plane {
        /// point of the surface [L]
        point: [f64; 2],
        /// direction out of the solid
        normal: [f64; 2],
    },
    /// Rigid disk, or the rim of a hole
    Circle {
        /// centre [L]
        centre: [f64; 2],
        /// radius [L]
        radius: f64,
        /// whether the solid is outside
        hole: bool,
    },
    /// Rigid body bounded by straight lines: its corners, the solid on the right of the way; the first again closes it [L]
    Polyline(Vec<[f64; 2]>),
}

impl From<&str> for MasterSide {
    fn from(group: &str) -> Self {
        Self::Group(group.into())
    }
}

/// Radiation damping of a contact in static steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Radiation {
    /// η by the bodies' impedances, dashpots in series
    OfBodies,
    /// η [F T/L³]
    Given(f64),
}

/// Tractions along the slave of a contact that starts closed; its gap is counted from where they act.
#[derive(Clone, Debug)]
pub struct InitialTractions {
    /// p [F/L²]
    pub pressure: Profile,
    /// q [F/L²]
    pub traction: Profile,
    /// Whether an initial stress of the bodies is in equilibrium with them
    pub balanced: bool,
    /// Whether they are those with which the initial stress of the slave's body ends there, instead of p and q
    pub of_bodies: bool,
}

impl Contact {
    /// A contact by penalty, of an edge group with another or with a rigid body.
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
            method: None,
            points: None,
            smooth: false,
            small_sliding: false,
            alpha_n: None,
            penetration: None,
            shrink_fit: false,
            massless: false,
            friction: friction.into(),
            dilatancy: None,
            wear: None,
            radiation: None,
            fluid_pressure: None,
            initial: None,
        }
    }

    /// With this normal penalty α_n [F/L³].
    pub fn alpha_n(self, alpha_n: f64) -> Self {
        Self { alpha_n: Some(alpha_n), ..self }
    }

    /// Evaluated by this method.
    pub fn method(self, method: Method) -> Self {
        Self { method: Some(method), ..self }
    }

    /// With the pressure raised until no closed gap is larger (augmented Lagrangian) [L].
    pub fn penetration(self, largest: f64) -> Self {
        Self { penetration: Some(largest), ..self }
    }

    /// In small sliding: every point keeps its foot, the weights of both sides, its normal and its length
    /// ([`crate::contact::small_sliding`]).
    pub fn small_sliding(self) -> Self {
        Self { small_sliding: true, ..self }
    }

    /// With surfaces that move apart with plastic slip.
    pub fn dilatancy(self, dilatancy: Dilatancy) -> Self {
        Self { dilatancy: Some(dilatancy), ..self }
    }

    /// With surfaces that wear by k p per plastic slip [L²/F].
    pub fn wear(self, k: f64) -> Self {
        Self { wear: Some(k), ..self }
    }

    /// With radiation damping in static steps.
    pub fn radiation(self, radiation: Radiation) -> Self {
        Self { radiation: Some(radiation), ..self }
    }

    /// With a fluid of the pressure p_w, by reference position and time [F/L²].
    pub fn fluid_pressure(self, pressure: impl Into<Profile>) -> Self {
        Self { fluid_pressure: Some(pressure.into()), ..self }
    }

    /// Of a group of points, each of which stands for an area [L].
    pub fn area(self, area: f64) -> Self {
        Self { area: Some(area), ..self }
    }

    /// Closed from the start under a pressure and a traction.
    pub fn initial(self, pressure: impl Into<Profile>, traction: impl Into<Profile>) -> Self {
        let (pressure, traction) = (pressure.into(), traction.into());
        Self { initial: Some(InitialTractions { pressure, traction, balanced: false, of_bodies: false }), ..self }
    }

    /// Closed from the start under the tractions with which the initial stress of the slave's body ends there.
    pub fn initial_of_bodies(self) -> Self {
        let (pressure, traction) = (0.0.into(), 0.0.into());
        Self { initial: Some(InitialTractions { pressure, traction, balanced: false, of_bodies: true }), ..self }
    }

    /// With bodies whose initial stress is in equilibrium with the tractions it starts with.
    pub fn balanced(mut self) -> Self {
        if let Some(initial) = &mut self.initial {
            initial.balanced = true;
        }
        self
    }

    /// Whether the slave is its own master.
    pub(super) fn is_own(&self) -> bool {
        matches!(&self.master, MasterSide::Group(group) if *group == self.slave)
    }
}

/// The fluid of a contact, if it has one.
pub fn fluid(place: &str, contact: &Contact) -> Checked<Option<Fluid>> {
    let Some(pressure) = contact.fluid_pressure.clone() else { return Ok(None) };
    check_in_time(&pressure, &format!("{place}.fluid_pressure"))?;
    Ok(Some(Fluid::new(move |at, time| pressure.value_at(at, time))))
}

/// A fluid pushes, and does not pull; what it does later a run sees.
pub fn check_fluid(pair: &ContactPair, place: &str, model: &Model) -> Checked<()> {
    let Some(BadPressure { at, pressure }) = pair.bad_fluid_pressure(&model.mesh.undeformed(), 0.0) else {
        return Ok(());
    };
    let message = format!(
        "is {pressure} at ({}, {}) and t = 0: must be a finite number, zero or positive, which pushes the surfaces apart",
        at.x, at.y
    );
    Err(ModelError::new(format!("{place}.fluid_pressure"), message))
}

/// The body of a rigid master.
pub fn rigid(side: &MasterSide, place: &str) -> Checked<Rigid> {
    match side {
        MasterSide::Group(group) => Err(ModelError::new(place, format!("`{group}` is a group, not a rigid body"))),
        MasterSide::Plane { point, normal } => plane(*point, *normal, place),
        MasterSide::Circle { centre, radius, hole } => {
            check_finite(&format!("{place}.circle.centre"), *centre)?;
            if !(*radius > 0.0 && radius.is_finite()) {
                let message = format!("is {radius}: must be positive");
                return Err(ModelError::new(format!("{place}.circle.radius"), message));
            }
            Ok(Rigid::Circle(Circle { centre: Vector2::from(*centre), radius: *radius, hole: *hole }))
        }
        MasterSide::Polyline(points) => {
            let place = format!("{place}.polyline.points");
            check_finite(&place, points.iter().flatten().copied())?;
            if points.len() < 2 {
                return Err(ModelError::new(place, format!("has {} points: must have two or more", points.len())));
            }
            if let Some(k) = points.windows(2).position(|pair| pair[0] == pair[1]) {
                let message = format!("points {} and {} are the same: leave one out", k, k + 1);
                return Err(ModelError::new(place, message));
            }
            Ok(Rigid::Polyline(Polyline::new(points.iter().map(|&point| Vector2::from(point)).collect())))
        }
    }
}

fn plane(point: [f64; 2], normal: [f64; 2], place: &str) -> Checked<Rigid> {
    check_finite(&format!("{place}.plane.point"), point)?;
    let given = Vector2::from(normal);
    let Some(normal) = given.try_normalize(0.0).filter(|normal| normal.norm() > 0.5) else {
        let message = format!("is [{}, {}]: must have a direction, such as [0, 1]", given.x, given.y);
        return Err(ModelError::new(format!("{place}.plane.normal"), message));
    };
    Ok(Rigid::Plane(Plane { point: Vector2::from(point), normal }))
}
