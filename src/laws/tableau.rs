//! The Dormand–Prince pair of orders 5 and 4.
//!
//! ```text
//! k_i = f(t + c_i h, z + h Σ a_ij k_j),   z₁ = z + h Σ b_i k_i,   e = h Σ (b_i − b̂_i) k_i          c_i = Σ a_ij
//! ```
//! The last stage is the first of the next step. Source: Dormand & Prince (1980), J. Comput. Appl. Math. 6, 19.

/// Number of stages.
pub const STAGES: usize = 7;

/// a_ij, one row per stage; the last row is b.
pub const A: [&[f64]; STAGES] = [
    &[],
    &[1.0 / 5.0],
    &[3.0 / 40.0, 9.0 / 40.0],
    &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
    &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
    &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
    &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];

/// Nodes c_i of the stages.
pub const C: [f64; STAGES] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];

/// Weights b_i − b̂_i of the error estimate.
pub const E: [f64; STAGES] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339_200.0, 22.0 / 525.0, -1.0 / 40.0];
