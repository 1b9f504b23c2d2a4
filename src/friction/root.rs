//! Newton's method that cannot leave its bracket.

/// Bisection alone resolves any bracket of doubles in fewer evaluations than this.
const MAX_EVALUATIONS: usize = 200;

/// Finds a root of f in [low, high], where f(low) > 0 ≥ f(high); f returns its value and its derivative.
///
/// A Newton step is taken when it stays inside the bracket and at least halves the step before it, otherwise the
/// bracket is halved. The search ends where |f| ≤ `tolerance` or the argument is resolved. The last call of f is
/// always at the answer, so a caller may keep what f computed there.
pub(super) fn bracketed_newton(
    (mut low, mut high): (f64, f64),
    guess: f64,
    tolerance: f64,
    mut f: impl FnMut(f64) -> (f64, f64),
) {
    let resolution = 8.0 * f64::EPSILON * low.abs().max(high.abs());
    let mut step = high - low;
    let mut x = if low < guess && guess < high { guess } else { low + 0.5 * step };
    for _ in 0..MAX_EVALUATIONS {
        let (value, slope) = f(x);
        if value.abs() <= tolerance {
            return;
        }
        if value > 0.0 {
            low = x;
        } else {
            high = x;
        }
        let newton = x - value / slope;
        let safe = low < newton && newton < high && (newton - x).abs() <= 0.5 * step.abs();
        let next = if safe { newton } else { low + 0.5 * (high - low) };
        step = next - x;
        if step.abs() <= resolution {
            return;
        }
        x = next;
    }
}
