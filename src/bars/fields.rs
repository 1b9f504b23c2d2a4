//! What a bar shows: forces along it, slip and bond.

use super::{Bar, BarState};

/// Quantities at the vertices of a bar.
pub const AT_POINTS: [&str; 4] = ["moment", "slip", "bond_shear", "bond_normal"];

/// Quantities of its segments.
pub const OF_SEGMENTS: [&str; 3] = ["axial_force", "shear_force", "yielding"];

/// A bar in one line: forces at its ends, and the largest along it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Summary {
    /// N of the first and of the last segment [F]
    pub ends: [f64; 2],
    /// smallest and largest N [F]
    pub axial: [f64; 2],
    /// largest |M| [F·L]
    pub moment: f64,
    /// largest |Q| [F]
    pub shear: f64,
    /// largest |s| of its bond [L]
    pub slip: f64,
    /// slipping share of its bonded length [-]
    pub slipping: f64,
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |most: f64, value| most.max(value.abs()))
}

impl Bar {
    /// Values of a quantity by its name: one to a vertex, or one to a segment.
    pub fn field(&self, state: &BarState, name: &str) -> Option<Vec<f64>> {
        Some(match name {
            "moment" => self.moments(state),
            "slip" => self.of_grips(|grip| state.grips[grip].slip),
            "bond_shear" => self.of_grips(|grip| state.grips[grip].bond.traction),
            "bond_normal" => self.of_grips(|grip| self.grips[grip].normal * state.grips[grip].across),
            "axial_force" => state.segments.iter().map(|segment| segment.force).collect(),
            "shear_force" => self.shears(state),
            "yielding" => state.segments.iter().map(|segment| f64::from(u8::from(segment.yields))).collect(),
            _ => return None,
        })
    }

    /// M at every vertex [F·L].
    fn moments(&self, state: &BarState) -> Vec<f64> {
        let mut moments = vec![0.0; self.vertices.len()];
        self.turns.iter().zip(&state.turns).for_each(|(turn, state)| moments[turn.vertex] = state.moment);
        moments
    }

    /// Q of every segment, −dM/ds [F].
    fn shears(&self, state: &BarState) -> Vec<f64> {
        let moments = self.moments(state);
        self.segments.iter().enumerate().map(|(k, of)| (moments[k] - moments[k + 1]) / of.length).collect()
    }

    /// Means at every vertex of a quantity of the bonded points, by length; 0 without bond.
    fn of_grips(&self, value: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut sums = vec![[0.0; 2]; self.vertices.len()];
        for (k, grip) in self.grips.iter().enumerate() {
            sums[grip.vertex][0] += grip.length * value(k);
            sums[grip.vertex][1] += grip.length;
        }
        sums.into_iter().map(|[sum, length]| if length > 0.0 { sum / length } else { 0.0 }).collect()
    }

    /// The bar in one line.
    pub fn summary(&self, state: &BarState) -> Summary {
        let forces = || state.segments.iter().map(|segment| segment.force);
        let (mut slipping, mut bonded) = (0.0, 0.0);
        for (grip, state) in self.grips.iter().zip(&state.grips) {
            bonded += grip.length;
            slipping += if state.slips { grip.length } else { 0.0 };
        }
        Summary {
            ends: [forces().next().unwrap_or(0.0), forces().next_back().unwrap_or(0.0)],
            axial: [forces().fold(f64::INFINITY, f64::min), forces().fold(f64::NEG_INFINITY, f64::max)],
            moment: largest(self.moments(state)),
            shear: largest(self.shears(state)),
            slip: largest(state.grips.iter().map(|grip| grip.slip)),
            slipping: if bonded > 0.0 { slipping / bonded } else { 0.0 },
        }
    }
}
