//! Where, within an increment, plastic slip sets in.

/// |q| where plastic slip sets in, in an increment along which the elastic traction and the strength both go evenly from
/// their first value to their second, and the traction ends above. One that is above from the start slips from there.
///
/// Both lines are counted along the sign of the trial, so a traction of the other sign unloads elastically, passes zero,
/// and loads elastically up to the strength.
pub(super) fn traction_at_yield(elastic: [f64; 2], strength: [f64; 2]) -> f64 {
    let (below, above) = (strength[0] - elastic[0], elastic[1] - strength[1]);
    if below <= 0.0 || above <= 0.0 {
        return elastic[0].max(0.0);
    }
    strength[0] + below / (below + above) * (strength[1] - strength[0])
}
