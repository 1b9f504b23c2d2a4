//! Logarithms and exponentials of small numbers, several at once: short series, which compile to vectors where calls of the library's
//! functions do not. They are as exact. Elastic strains and increments of plastic ones are small; what is not is left to the library.

/// Largest number of which ln(1 + x) is a series.
const LOGARITHM: f64 = 0.2;

/// Largest number of which eˣ − 1 is a series.
const EXPONENTIAL: f64 = 0.4;

/// ln(1 + x) of each.
///
/// ```text
/// 2 artanh s = 2 s (1 + s²/3 + s⁴/5 + …),   s = x/(2 + x)                 the first term left out is 3e-17 of the sum
/// ```
#[inline(always)]
pub(super) fn ln_1p(mut x: [f64; 3]) -> [f64; 3] {
    if x.iter().any(|x| x.abs() > LOGARITHM) {
        x.iter_mut().for_each(|x| *x = x.ln_1p());
        return x;
    }
    for x in &mut x {
        let s = *x / (2.0 + *x);
        *x = 2.0 * s + 2.0 * s * polynomial(&ODD, s * s);
    }
    x
}

/// eˣ − 1 of each.
#[inline(always)]
pub(super) fn exp_m1(mut x: [f64; 3]) -> [f64; 3] {
    if x.iter().any(|x| x.abs() > EXPONENTIAL) {
        x.iter_mut().for_each(|x| *x = x.exp_m1());
        return x;
    }
    for x in &mut x {
        *x /= bernoulli(*x);
    }
    x
}

/// x/(eˣ − 1), 1 at 0.
#[inline(always)]
pub(super) fn over_exp_m1(x: f64) -> f64 {
    if x.abs() > EXPONENTIAL { x / x.exp_m1() } else { bernoulli(x) }
}

/// x/(eˣ − 1) of small numbers, by Bernoulli's.
///
/// ```text
/// 1 − x/2 + Σ B_2k x²ᵏ/(2k)!                                              the first term left out is 4e-17 of the sum
/// ```
#[inline(always)]
fn bernoulli(x: f64) -> f64 {
    1.0 - 0.5 * x + polynomial(&BERNOULLI, x * x)
}

/// y (a₁ + a₂ y + a₃ y² + …)
#[inline(always)]
fn polynomial(parts: &[f64], y: f64) -> f64 {
    let mut sum = 0.0;
    for part in parts.iter().rev() {
        sum = (sum + part) * y;
    }
    sum
}

/// 1/(2k + 1)
const ODD: [f64; 7] = [1.0 / 3.0, 1.0 / 5.0, 1.0 / 7.0, 1.0 / 9.0, 1.0 / 11.0, 1.0 / 13.0, 1.0 / 15.0];

/// B_2k/(2k)!
const BERNOULLI: [f64; 6] =
    [1.0 / 12.0, -1.0 / 720.0, 1.0 / 30240.0, -1.0 / 1_209_600.0, 1.0 / 47_900_160.0, -691.0 / 1_307_674_368_000.0];
