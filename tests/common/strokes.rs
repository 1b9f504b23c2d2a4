//! Slip to and fro, for the tests of all laws.

use fecontact::laws::friction::{FrictionLaw, FrictionState, Sliding};

/// The state after strokes between these points of slip and pressure, each in `parts` equal increments of length `dt`/`parts`.
pub fn strokes(law: &dyn FrictionLaw, points: &[[f64; 2]], parts: usize, dt: f64) -> FrictionState {
    let mut start = law.initial_state(0.0, 0.0);
    start.pressure = points[0][1];
    points.windows(2).fold(start, |old, stroke| {
        let [[u0, p0], [u1, p1]] = [stroke[0], stroke[1]];
        (1..=parts).fold(old, |old, k| {
            let (share, part) = (k as f64 / parts as f64, 1.0 / parts as f64);
            let sliding = Sliding::new((u1 - u0) * part, p0 + share * (p1 - p0), dt * part);
            law.respond(&old, sliding).expect("an answer").state
        })
    })
}
