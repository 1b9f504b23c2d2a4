//! How far to go along a correction of Newton's method.

/// |s(α)|/|s(0)| at which a search along a correction ends.
const LEVEL: f64 = 0.1;

/// Most evaluations of a search along a correction.
const LONGEST_SEARCH: usize = 12;

/// How far a correction leads downhill, as a share of it: to where `slope` is near 0, or all of it if that is not beyond. It
/// is not a number where the equations cannot be evaluated. By regula falsi (Illinois), halving where that fails: forces
/// that stick in a narrow range make the slope steep there.
pub fn downhill(start: f64, mut slope: impl FnMut(f64) -> f64) -> f64 {
    let level = |s: f64| s.abs() <= LEVEL * start.abs();
    let end = slope(1.0);
    // A correction that does not start downhill was not made for this.
    if start >= 0.0 || end <= 0.0 || level(end) {
        return 1.0;
    }
    let (mut low, mut high) = ((0.0, start), (1.0, end));
    let (mut share, mut side) = (1.0, 0.0);
    for _ in 0..LONGEST_SEARCH {
        let falsi = low.0 + (high.0 - low.0) * low.1 / (low.1 - high.1);
        share = if falsi > low.0 && falsi < high.0 { falsi } else { 0.5 * (low.0 + high.0) };
        let s = slope(share);
        if level(s) {
            break;
        }
        // The end that stays a second time counts half.
        let stays = if s.signum() == side { 0.5 } else { 1.0 };
        side = s.signum();
        if s < 0.0 {
            (low, high.1) = ((share, s), stays * high.1);
        } else {
            (high, low.1) = ((share, s), stays * low.1);
        }
    }
    share
}
