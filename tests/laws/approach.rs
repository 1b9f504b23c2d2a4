//! The sliding curve of the super/subloading law, R(λ), and the exponential integral in it: series, inverse and area against each other and
//! against tables.

use fecontact::laws::approach::{Approach, SlidingCurve, e1};

/// Short slips by their series are the differences of long ones, where these have digits left.
#[test]
fn short_slips_are_differences() {
    for approach in [Approach::Logarithmic, Approach::Cotangent] {
        for ratio in [0.05, 0.3, 0.8, 0.999] {
            let curve = SlidingCurve::new(approach, 0.02, 100.0);
            let start = curve.start(ratio);
            let step = 0.9e-3 / (1.0 + (-start.coordinate).exp() + start.bend / start.stretch);
            let found = curve.short_slip(&start, step).expect("short");
            let exact = curve.at(start.coordinate + step, &start).slip - start.slip;
            assert!((found / exact - 1.0).abs() < 1e-10, "{approach:?} {ratio}: {found:e} {exact:e}");
            let third = curve.approach.higher((-start.coordinate).exp())[0] * start.stretch;
            let bends = [1e-4, -1e-4].map(|h| curve.at(start.coordinate + h, &start).bend);
            assert!(((bends[0] - bends[1]) / 2e-4 - third).abs() < 1e-6 * start.stretch, "{approach:?} {ratio}");
            assert_eq!(curve.short_slip(&start, 1.0), None);
        }
    }
}

/// What is found at a distance is at that distance, from anywhere on the curve.
#[test]
fn a_point_after_a_distance_is_at_that_distance() {
    for approach in [Approach::Logarithmic, Approach::Cotangent] {
        for y in [1e-60, 1e-3, 0.2, 0.7, 0.999] {
            for distance in [1e-12, 1e-4, 0.03, 1.0, 20.0] {
                let here = approach.after(y, distance);
                let target = approach.locate(y).1.distance + distance;
                let error = (here.distance - target).abs();
                assert!(error < 1e-14 * target.max(1.0) && here.y >= y, "{approach:?} {y} {distance}: {error}");
            }
        }
    }
}

/// Simpson's rule between points of the curve, in ζ, where the integrand is smooth.
#[test]
fn area_is_the_integral_of_y_over_the_distance() {
    for approach in [Approach::Logarithmic, Approach::Cotangent] {
        for (from, to) in [(-4.0, -3.0), (-3.0, 0.0), (0.0, 5.0), (-2.0, 30.0), (30.0, 60.0)] {
            let area = |zeta: f64| {
                let here = approach.at(zeta);
                approach.area(zeta, here.y, here.distance)
            };
            let steps = 4000;
            let h = (to - from) / f64::from(steps);
            let sum: f64 = (0..=steps)
                .map(|i| {
                    let here = approach.at(from + f64::from(i) * h);
                    let weight = if i == 0 || i == steps { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
                    weight * here.y * here.stretch * h / 3.0
                })
                .sum();
            let error = area(to) - area(from) - sum;
            assert!(error.abs() < 1e-12 * (1.0 + sum), "{approach:?} from {from} to {to}: {error:e} in {sum}");
        }
    }
}

/// Abramowitz & Stegun, tables 5.1 and 5.2, continued to 20 digits with mpmath.
#[test]
fn e1_agrees_with_tables() {
    let table = [
        (1e-12, 27.053_805_451_028_015),
        (0.01, 4.037_929_576_538_114),
        (0.5, 0.559_773_594_776_160_8),
        (1.0, 0.219_383_934_395_520_28),
        (1.5, 0.100_019_582_406_632_65),
        (1.500_01, 0.100_018_094_884_627_7),
        (2.0, 0.048_900_510_708_061_12),
        (5.0, 0.001_148_295_591_275_325_8),
        (20.0, 9.835_525_290_649_882e-11),
        (100.0, 3.683_597_761_682_032e-46),
        (500.0, 1.422_076_782_253_638_4e-220),
    ];
    for (w, expected) in table {
        let w: f64 = w;
        let error: f64 = e1(w, w.ln(), (-w).exp()) / expected - 1.0;
        assert!(error.abs() < 4e-15, "E1({w}): relative error {error:e}");
    }
}
