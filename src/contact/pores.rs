//! Fluid in the pores of the slave's bodies: contacts carry total stress, and friction goes by the effective one.
//!
//! ```text
//! p_total = ⟨p̄ − α_n g⟩,   t = p_total n − q s                          closure and forces, as without a fluid
//! p = max(p_total − p_w, ε p_total)                                     effective pressure, by which friction goes; ε = 1e-9
//! p_w = Σ_e v_e p_w,e,   p_w,e = p_w0 − K_w/n ⟨ln J⟩_e                   p_w of the elements behind the point, at least that of cavitation
//! δp_total = −α_n δg,   δq = ∂q/∂Δu_t δΔu_t + ∂q/∂p (δp_total − δp_w)    δp_w by all nodes of these elements
//! ```
//! ⟨·⟩_e is the mean over an element, p_w0 that of the point, and v_e the share of the point's length that lies on the element. p_w may be
//! negative: suction presses the grains on each other. Where p_w exceeds p_total nothing of it is left to friction, and the surfaces still
//! bear p_total.
//!
//! Friction by the principle of effective stress: K. Terzaghi, Theoretical Soil Mechanics, 1943, §6.

use super::kinematics::Kinematics;
use crate::mesh::configuration::Configuration;

/// p_w of a contact point in a configuration; on request its derivatives by the displacements of its nodes, two a node [F/L²], [F/L³].
pub type PorePressureAt = dyn Fn(&Configuration, Option<&mut [f64]>) -> f64 + Send + Sync;

/// Pores behind a contact point.
pub struct Pores {
    /// Nodes of the elements behind it, each once
    pub nodes: Vec<usize>,
    pressure: Box<PorePressureAt>,
}

/// Least share of the contact pressure that friction sees: it has no response without pressure.
const LEAST: f64 = 1e-9;

/// p of a contact pressure p_total above p_w, and ∂p/∂p_total.
pub fn effective(total: f64, pore_pressure: f64) -> [f64; 2] {
    let (pressure, least) = (total - pore_pressure, LEAST * total);
    if total <= 0.0 {
        [total, 1.0]
    } else if pressure > least {
        [pressure, 1.0]
    } else {
        [least, LEAST]
    }
}

impl Pores {
    /// Creates the pores of elements with these nodes.
    pub fn new(
        nodes: Vec<usize>,
        pressure: impl Fn(&Configuration, Option<&mut [f64]>) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Self { nodes, pressure: Box::new(pressure) }
    }

    /// p_w [F/L²]
    pub fn pressure(&self, x: &Configuration) -> f64 {
        (self.pressure)(x, None)
    }

    /// p_w at a closed point, with its variation in the kinematics of the point where variations are asked for.
    pub(super) fn vary(&self, x: &Configuration, k: &mut Kinematics) -> f64 {
        if !k.varied {
            return self.pressure(x);
        }
        k.behind.extend_from_slice(&self.nodes);
        k.dpores.resize(2 * self.nodes.len(), 0.0);
        (self.pressure)(x, Some(&mut k.dpores))
    }
}

impl std::fmt::Debug for Pores {
    fn fmt(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(formatter, "pores of elements with the nodes {:?}", self.nodes)
    }
}
