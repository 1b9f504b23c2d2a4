//! Bracketed root finder.

/// Number of proposals after which the bracket is only bisected; about fifty bisections resolve any bracket.
const MOST_PROPOSALS: usize = 100;

/// Value of f at a trial argument of [`bracketed_root`].
pub(super) struct Argument {
    /// f at the argument
    pub value: f64,
    /// Change of the argument proposed by Newton's method or a better one
    pub step: f64,
    /// Whether the argument is accepted.
    pub done: bool,
}

/// Finds a root of f in [low, high], where f(low) > 0 ≥ f(high).
///
/// A proposed step is taken if it stays inside the bracket and at most half as long as the previous step; otherwise the bracket
/// is bisected. The search ends when f accepts the argument or it is resolved to round-off. The last call of f is always at the
/// result, so a caller may use quantities computed there.
#[inline]
pub(super) fn bracketed_root((mut low, mut high): (f64, f64), guess: f64, mut f: impl FnMut(f64) -> Argument) {
    let resolution = 8.0 * f64::EPSILON * low.abs().max(high.abs());
    let mut step = high - low;
    let mut x = if low < guess && guess < high { guess } else { low + 0.5 * step };
    for evaluation in 0.. {
        let trial = f(x);
        if trial.done {
            return;
        }
        if trial.value > 0.0 {
            low = x;
        } else {
            high = x;
        }
        let proposed = x + trial.step;
        let safe =
            evaluation < MOST_PROPOSALS && low < proposed && proposed < high && trial.step.abs() <= 0.5 * step.abs();
        let next = if safe { proposed } else { low + 0.5 * (high - low) };
        step = next - x;
        // A bracket of infinite or undefined width cannot be resolved either.
        if step.is_nan() || step.abs() <= resolution || high - low == f64::INFINITY {
            return;
        }
        x = next;
    }
}
