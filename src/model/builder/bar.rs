//! Input of bars: trusses, beams, anchors and geogrids.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::model::Damping;

/// A bar along straight lines: a truss, or a beam where `ei` is given. In plane strain all values are per unit of thickness, otherwise
/// they are those of the whole bar. A bar has a group of its nodes under its name, for supports, loads and `watch`, and its ends are
/// the groups `NAME_start` and `NAME_end`
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Bar")]
#[non_exhaustive]
pub struct BarInput {
    /// Points [x, y] of its axis, joined by straight lines. Either these or `on`
    #[serde(default)]
    pub points: Vec<[f64; 2]>,
    /// Group of edges of a body whose nodes it shares, or of lines of the mesh that are sides of no element
    pub on: Option<String>,
    /// Number of segments that it is divided into; default: with `embedded` about one to an element of the body, 20 for a beam, and one
    /// from point to point for a truss
    pub segments: Option<usize>,
    /// EA: axial stiffness, above 0 [F]
    pub ea: f64,
    /// EI: bending stiffness; default: 0, a truss [F L²]
    #[serde(default)]
    pub ei: f64,
    /// N_p: force at which it yields in tension and compression, at constant force; default: none [F]
    pub limit: Option<f64>,
    /// Mass per length; needed in dynamic steps, and for the weight of the bar by a load `gravity` on its name [M/L]
    #[serde(default)]
    pub mass: f64,
    /// Damping in dynamic steps, as that of bodies: of EA and EI by `stiffness`, in implicit steps, and not of its bond
    #[serde(default)]
    pub damping: Damping,
    /// How it begins; default: free
    pub start: Option<BarEnd>,
    /// How it ends; default: free
    pub end: Option<BarEnd>,
    /// Body that it lies in, with bond along its whole length; default: none, it is joined to others by its ends and shared nodes alone
    pub embedded: Option<Embedding>,
}

/// An end of a bar.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "BarEnd")]
#[non_exhaustive]
pub struct BarEnd {
    /// Body in which the end lies, another bar with a point there, or a group of points of the mesh: it is joined to that point
    pub on: Option<String>,
    /// Whether a beam keeps its angle there: to the body or bar that it is joined to, otherwise in space. Default: a hinge
    #[serde(default)]
    pub clamped: bool,
}

/// Bond of a bar with the bodies in which it lies.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Embedding")]
#[non_exhaustive]
pub struct Embedding {
    /// Bodies in which it lies from end to end
    #[serde(rename = "in")]
    pub bodies: Vec<String>,
    /// Bond along it; default: it moves with the bodies, without slip
    pub bond: Option<BarBond>,
}

/// Bond along a bar: shear per length of the bar against slip, as in a bond of a contact. Across, the bar is tied by a penalty.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "BarBond")]
#[non_exhaustive]
pub struct BarBond {
    /// k: shear per length and slip before any slips for good; default: 100 (λ + 2G)/(length of a segment) of the body times its
    /// thickness, a penalty [F/L²]
    pub stiffness: Option<f64>,
    /// c: shear strength per length; default: 0 with `mu`, otherwise none: it never slips for good [F/L]
    pub strength: Option<f64>,
    /// c_r: what is left of it after the slip `slip`, 0 ≤ c_r ≤ c; default: c, and 0 where `slip` is given [F/L]
    pub residual: Option<f64>,
    /// D: slip over which the strength falls from c to c_r; default: it does not fall [L]
    pub slip: Option<f64>,
    /// μ: what the strength grows by per pressure of the body across the bar (times the thickness of the body), that at the start of an
    /// increment; twice a coefficient of friction where both faces rub. Default: 0 [-]
    #[serde(default)]
    pub mu: f64,
    /// k_n: force across the bar per length and distance; default: 100 (λ + 2G)/(length of a segment) of the body times its thickness
    /// [F/L²]
    pub normal: Option<f64>,
}

setters! { bar: BarInput;
    /// Sets the number of segments.
    segments(number: usize) { bar.segments = Some(number); }

    /// Sets EI, which makes it a beam [F L²].
    ei(ei: f64) { bar.ei = ei; }

    /// Sets N_p [F].
    limit(limit: f64) { bar.limit = Some(limit); }

    /// Sets the mass per length [M/L].
    mass(mass: f64) { bar.mass = mass; }

    /// Sets the damping in dynamic steps.
    damping(damping: Damping) { bar.damping = damping; }

    /// Joins its start to a body or bar.
    start_on(on: impl Into<String>) { bar.start.get_or_insert_default().on = Some(on.into()); }

    /// Joins its end to a body or bar.
    end_on(on: impl Into<String>) { bar.end.get_or_insert_default().on = Some(on.into()); }

    /// Clamps its start.
    clamp_start() { bar.start.get_or_insert_default().clamped = true; }

    /// Clamps its end.
    clamp_end() { bar.end.get_or_insert_default().clamped = true; }

    /// Lets it lie in a body, with which it moves.
    embedded(body: impl Into<String>) { bar.embedded.get_or_insert_default().bodies.push(body.into()); }

    /// Lets it lie in a body, with bond along it.
    bonded(body: impl Into<String>, bond: BarBond) {
        let embedding = bar.embedded.get_or_insert_default();
        embedding.bodies.push(body.into());
        embedding.bond = Some(bond);
    }
}

impl BarInput {
    /// Creates a truss from point to point [L], with EA [F].
    pub fn along(points: impl Into<Vec<[f64; 2]>>, ea: f64) -> Self {
        Self { points: points.into(), ea, ..Self::default() }
    }

    /// Whether it is a beam along points outside of bodies, divided by itself.
    #[doc(hidden)]
    pub fn is_free_beam(&self) -> bool {
        self.ei > 0.0 && self.embedded.is_none() && self.on.is_none()
    }

    /// Creates a truss on the nodes of a group of edges, with EA [F].
    pub fn on(group: impl Into<String>, ea: f64) -> Self {
        Self { on: Some(group.into()), ea, ..Self::default() }
    }
}

setters! { bond: BarBond;
    /// Sets k [F/L²].
    stiffness(stiffness: f64) { bond.stiffness = Some(stiffness); }

    /// Sets c [F/L].
    strength(strength: f64) { bond.strength = Some(strength); }

    /// Sets c_r [F/L].
    residual(residual: f64) { bond.residual = Some(residual); }

    /// Sets D [L].
    slip(slip: f64) { bond.slip = Some(slip); }

    /// Sets μ [-].
    mu(mu: f64) { bond.mu = mu; }

    /// Sets k_n [F/L²].
    normal(normal: f64) { bond.normal = Some(normal); }
}
