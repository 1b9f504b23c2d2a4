//! Sizes of elements along a side.

/// How the sizes of elements vary along a side: as a geometric series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Grading {
    /// size of the last over that of the first
    Ratio(f64),
    /// size in the middle over that at both ends
    Middle(f64),
}

impl Default for Grading {
    fn default() -> Self {
        Self::Ratio(1.0)
    }
}

/// A place between two ends, as a part of a whole: even parts of a length that a number holds exactly are exact.
#[derive(Clone, Copy, Debug)]
pub struct Share {
    part: f64,
    whole: f64,
}

impl Share {
    /// A share of 1.
    pub fn new(part: f64, whole: f64) -> Self {
        Self { part, whole }
    }

    /// The place between a and b.
    pub fn between(self, a: f64, b: f64) -> f64 {
        if self.part == self.whole { b } else { a + (b - a) * self.part / self.whole }
    }
}

/// Places of the nodes of `count` elements, `order` spacings each.
pub fn shares(count: usize, grading: Grading, order: usize) -> Result<Vec<Share>, String> {
    let (ratio, what) = match grading {
        Grading::Ratio(ratio) => (ratio, "the last element over the first"),
        Grading::Middle(ratio) => (ratio, "the elements in the middle over those at both ends"),
    };
    if !(ratio > 0.0 && ratio.is_finite()) {
        return Err(format!("is {ratio}: must be positive, the size of {what}"));
    }
    let last = match grading {
        Grading::Ratio(_) => count - 1,
        Grading::Middle(_) => (count - 1) / 2,
    };
    if last == 0 && ratio != 1.0 {
        return Err(format!("is {ratio}, and {count} elements have one size: take more elements, or 1"));
    }
    let size = |k: usize| {
        let step = match grading {
            Grading::Ratio(_) => k,
            Grading::Middle(_) => k.min(count - 1 - k),
        };
        ratio.powf(step as f64 / last.max(1) as f64)
    };
    let mut ends = vec![0.0];
    (0..count).for_each(|k| ends.push(ends[k] + size(k)));
    let whole = ends[count];
    let part = |i: usize| match i % order {
        0 => ends[i / order],
        _ => 0.5 * (ends[i / order] + ends[i / order + 1]),
    };
    Ok((0..=count * order).map(|i| Share::new(part(i), whole)).collect())
}
