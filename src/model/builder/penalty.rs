//! Default penalties: stiff beside the elements that they hold, soft enough to be solved with.
//!
//! ```text
//! α_n = 10 (λ + 2G)/h,   α_t = α_n/2                                                             (1)
//! ```
//! λ + 2G is that of the softer side, which is the one that the penalty must not give way beside, h the depth of the element
//! behind the slave's edge; (λ + 2G)/h is the mean over the slave's edges.

use super::contact::{Contact, MasterSide};
use super::error::{Checked, ModelError};
use super::groups::edges;
use super::limits::check_size;
use crate::mesh::Edge;
use crate::model::Model;

/// α_n over (λ + 2G)/h [-]
const NORMAL: f64 = 10.0;

/// α_t over α_n [-]
const TANGENTIAL: f64 = 0.5;

/// Stiffnesses of a contact.
pub struct Penalty {
    /// α_n [F/L³]
    pub alpha_n: f64,
    /// α_t of a law that has none of its own; none for a slave group of points [F/L³]
    pub alpha_t: Option<f64>,
    /// h/(λ + 2G): how far a pressure pushes the bodies in; 0 where no elements are behind the slave [L³/F]
    pub compliance: f64,
}

/// The penalties of a contact, those given checked.
pub fn penalty(place: &str, contact: &Contact, model: &Model) -> Checked<Penalty> {
    let elastic = elastic_stiffness(place, contact, model)?;
    let at = format!("{place}.normal.alpha_n");
    let alpha_n = match (contact.alpha_n, elastic) {
        (Some(alpha_n), _) => alpha_n,
        (None, Some(elastic)) => NORMAL * elastic,
        (None, None) => {
            let message =
                format!("is missing: there are no elements behind the points of `{}` to choose it by", contact.slave);
            return Err(ModelError::new(at, message));
        }
    };
    if alpha_n <= 0.0 {
        let message = format!("is {alpha_n}: must be positive (leave it out for 10 (λ + 2G)/h)");
        return Err(ModelError::new(at, message));
    }
    check_size(&format!("{place}.normal"), "alpha_n", alpha_n)?;
    let alpha_t = contact.area.is_none().then_some(TANGENTIAL * alpha_n);
    Ok(Penalty { alpha_n, alpha_t, compliance: elastic.map_or(0.0, |elastic| 1.0 / elastic) })
}

/// (λ + 2G)/h of (1); none where the slave has no edges [F/L³].
fn elastic_stiffness(place: &str, contact: &Contact, model: &Model) -> Checked<Option<f64>> {
    if contact.area.is_some() {
        return Ok(None);
    }
    let slave = edges(&model.mesh, &contact.slave, &format!("{place}.slave"))?;
    let modulus = |edge: &Edge| model.bodies[model.body_of_element[edge.element]].material.p_wave_modulus();
    let master = match &contact.master {
        MasterSide::Group(group) => edges(&model.mesh, group, &format!("{place}.master"))?,
        _ => &[],
    };
    let softest = master.iter().map(modulus).fold(f64::INFINITY, f64::min);
    let stiffness = |edge: &Edge| modulus(edge).min(softest) / depth_behind(edge, model);
    Ok(Some(slave.iter().map(stiffness).sum::<f64>() / slave.len() as f64))
}

/// Depth of the element behind an edge [L].
pub fn depth_behind(edge: &Edge, model: &Model) -> f64 {
    let [a, b] = [0, 1].map(|end| model.mesh.nodes[edge.nodes[end]]);
    model.solids[edge.element].area() / (b - a).norm()
}
