//! Contacts whose corners press from their touch on (`ridges.rs`).

use nalgebra::Vector2;

use super::master::Master;
use super::pair::ContactPair;
use super::ridges::Corners;

impl ContactPair {
    /// Finds the corners that may enter first, given the positions of the mesh. A gap that is counted from elsewhere, that a bond
    /// or slip holds open, where a fluid presses or that multipliers close is that of the whole surfaces.
    pub fn find_corners(&mut self, positions: &[Vector2<f64>]) {
        let fluid = self.fluid.is_some() || self.pores.is_some() || self.seam.is_some();
        let lifted = self.laws.iter().any(|law| law.cohesion.is_some() || !law.description.opening.is_empty());
        let whole = self.tied || self.small.is_some() || self.penetration.is_some() || fluid || lifted;
        let (Some(mortar), Master::Mesh(surface)) = (&self.mortar, &self.master) else { return };
        if whole || self.is_offset() {
            return;
        }
        let own: Vec<[usize; 2]> = mortar.edges.iter().map(|edge| [edge[0], edge[1]]).collect();
        let other: Vec<[usize; 2]> =
            surface.segments.iter().map(|segment| [segment.ends[1], segment.ends[0]]).collect();
        let corners = Corners::of([own, other], positions);
        if let Some(mortar) = &mut self.mortar {
            mortar.corners = corners;
        }
    }
}
