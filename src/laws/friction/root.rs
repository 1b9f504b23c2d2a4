//! Bracketed root finder, and a bracket of the first of several roots.

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
pub(super) fn bracketed_root([mut low, mut high]: [f64; 2], guess: f64, mut f: impl FnMut(f64) -> Argument) {
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

/// A piece of a bracket between two points at which f was evaluated, as [`first_root_bracket`] looks at it.
pub(super) struct Piece {
    /// The arguments at its ends
    pub ends: [f64; 2],
    /// f there
    pub values: [f64; 2],
    /// D₋ ≤ D ≤ D₊: bounds of −df/ds in between, s being any measure that grows with the argument
    pub fall: [f64; 2],
    /// Growth of s from end to end
    pub way: f64,
}

/// Maximum number of pieces examined; many only where two roots are about to merge.
const MOST_PIECES: usize = 1000;

/// A bracket, up to the argument `end`, that contains the smallest root of f, and no other unless they cannot be distinguished,
/// being in a piece narrower than `resolved`; the last point reached if it is not found. f is positive at `left`, and not positive
/// at `end` except for round-off.
///
/// Pieces are examined from the left: a piece contains at most one root if D₋ > 0, none if f stays positive between the lines of
/// slope −D₊ from its left end and −D₋ from its right, and is halved otherwise.
pub(super) fn first_root_bracket<P>(
    mut left: P,
    mut right: P,
    end: f64,
    resolved: f64,
    mut at: impl FnMut(f64) -> P,
    piece: impl Fn(&P, &P) -> Piece,
) -> Result<[f64; 2], P> {
    for _ in 0..MOST_PIECES {
        let Piece { ends: [low, high], values: [before, after], fall: [least, most], way } = piece(&left, &right);
        let width = high - low;
        let narrow = width <= resolved * (1.0 + low.abs());
        if after <= 0.0 && (least > 0.0 || narrow) {
            return Ok([low, high]);
        }
        let crossing_needs = before / most.max(0.0) + after / (-least).max(0.0);
        let rootless = after > 0.0 && (least > 0.0 || crossing_needs > way);
        if rootless || narrow {
            if high >= end {
                return Ok([low, end]);
            }
            left = right;
            right = at((high + 2.0 * width).min(end));
        } else {
            right = at(low + 0.5 * width);
        }
    }
    Err(left)
}
