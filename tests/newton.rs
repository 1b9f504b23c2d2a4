//! Newton's method by itself, on equations in one unknown.

use fecontact::linear::{Multifrontal, Pattern, SparseMatrix};
use fecontact::newton::{NewtonFailure, Outcome, Request, Settings, solve};
use fecontact::system::System;

/// Solve r(u) = 0 from a start value; `equation` gives r, r′ and the share of the next correction to take, or fails.
fn root(start: f64, equation: impl Fn(f64) -> Result<[f64; 3], ()>) -> Outcome<()> {
    let pattern = std::sync::Arc::new(Pattern::new(1, std::iter::once(&[0usize][..])));
    let tangent = SparseMatrix::zero(pattern);
    let mut system = System { residual: vec![0.0; 2], tangent, forces: 1.0, imbalance: 1.0 };
    let settings = Settings { tolerance: 1e-12, max_iterations: 30 };
    solve(vec![start, 0.0], settings, &mut Multifrontal::default(), &mut system, |u, request, system| {
        let [r, slope, share] = equation(u[0])?;
        system.residual = vec![r, 0.0];
        system.imbalance = r.abs();
        if request == Request::Tangent {
            system.tangent.clear();
            system.tangent.add_diagonal(0, slope);
            system.tangent.add_diagonal(1, 1.0);
        }
        Ok(share)
    })
}

/// The correction of atan(u) = 0 from u = 1.6 leads to −2.5, which is out of bounds here; half of it leads to the root.
#[test]
fn a_part_of_a_correction_out_of_bounds_is_taken() {
    let bounded = |u: f64| if u.abs() < 2.0 { Ok([u.atan(), 1.0 / (1.0 + u * u), 1.0]) } else { Err(()) };
    let (iterations, result) = root(1.6, bounded);
    assert!(result.expect("a root")[0].abs() < 1e-12 && iterations.len() < 8, "{iterations:?}");
    // Where no part of it leads anywhere, the failure is told.
    let alone = |u: f64| if u == 1.6 { Ok([u.atan(), 1.0 / (1.0 + u * u), 1.0]) } else { Err(()) };
    assert_eq!(root(1.6, alone).1, Err(NewtonFailure::Evaluation(())));
}

/// The corrections of sgn(u) √|u| = 0 lead from u to −u for ever; half of one leads to the root.
#[test]
fn a_share_of_the_correction_breaks_a_cycle() {
    let equation =
        |share: f64| move |u: f64| Ok([u.signum() * u.abs().sqrt(), 0.5 / u.abs().max(1e-300).sqrt(), share]);
    assert!(matches!(root(1.0, equation(1.0)).1, Err(NewtonFailure::TooManyIterations { .. })));
    let (iterations, result) = root(1.0, equation(0.5));
    assert_eq!((iterations.len(), result.expect("a root")[0]), (1, 0.0));
}
