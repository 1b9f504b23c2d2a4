//! An axis: its range, its ticks and the numbers at them.

/// Name and unit of what an axis shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// what it is
    pub name: String,
    /// its unit, if it is known
    pub unit: String,
    /// linear or logarithmic
    pub scale: Scale,
    /// values to be on it whatever the data
    pub include: Vec<f64>,
    /// whether it counts: no ticks between whole numbers
    pub whole: bool,
}

/// How values are spaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// evenly
    Linear,
    /// by powers of ten; values that are not positive have no place
    Logarithmic,
}

impl Axis {
    /// A linear axis.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into(), scale: Scale::Linear, include: Vec::new(), whole: false }
    }

    /// The same with a logarithmic scale.
    pub fn logarithmic(self) -> Self {
        Self { scale: Scale::Logarithmic, ..self }
    }

    /// The same for whole numbers.
    pub fn whole(self) -> Self {
        Self { whole: true, ..self }
    }

    /// The same with a value on it.
    pub fn including(mut self, value: f64) -> Self {
        self.include.push(value);
        self
    }
}

/// The part of an axis that is drawn, in the coordinates of its scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    low: f64,
    high: f64,
    scale: Scale,
}

/// A tick.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// place, 0 at the lower and 1 at the upper end
    pub share: f64,
    /// its number
    pub label: String,
}

/// Spread of data, relative to their size, that is round-off.
const NOISE: f64 = 1e-9;

/// Sizes with which an axis can still be reckoned; what is larger has no place on it, and what spreads less is one value.
const LARGEST: f64 = 1e300;
const SMALLEST: f64 = 1e-290;

/// Powers of ten that go into the axis' name: outside of these, numbers have too many digits.
const PLAIN: std::ops::RangeInclusive<i32> = -2..=4;

impl Range {
    /// A range that holds all finite values, with `margin` beyond them as a share of their spread.
    pub fn of(axis: &Axis, values: impl Iterator<Item = f64>, margin: f64) -> Self {
        let scale = axis.scale;
        let places = values
            .chain(axis.include.iter().copied())
            .map(|value| scale.place(value))
            .filter(|place| place.abs() <= LARGEST);
        let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        if low > high {
            return Self { low: 0.0, high: 1.0, scale };
        }
        let size = low.abs().max(high.abs());
        if high - low > (NOISE * size).max(SMALLEST) {
            let beyond = margin * (high - low);
            return Self { low: low - beyond, high: high + beyond, scale };
        }
        let around = if size > SMALLEST { 0.1 * size } else { 1.0 };
        Self { low: low - around, high: high + around, scale }
    }

    /// Place of a value, 0 at the lower and 1 at the upper end; not finite for a value without one.
    pub fn share(&self, value: f64) -> f64 {
        (self.scale.place(value) - self.low) / (self.high - self.low)
    }

    /// About as many ticks as wanted, and the axis' name with its unit and the power of ten that the numbers leave out.
    pub fn ticks(&self, axis: &Axis, wanted: f64) -> (Vec<Tick>, String) {
        match self.scale {
            Scale::Linear => self.linear_ticks(axis, wanted),
            Scale::Logarithmic => (self.decades(wanted), named(axis, 0)),
        }
    }

    fn linear_ticks(&self, axis: &Axis, wanted: f64) -> (Vec<Tick>, String) {
        let step = round_step((self.high - self.low) / wanted).max(if axis.whole { 1.0 } else { 0.0 });
        let size = self.low.abs().max(self.high.abs());
        let order = size.log10().floor() as i32;
        let power = if PLAIN.contains(&order) { 0 } else { 3 * order.div_euclid(3) };
        let decimals = (power - (step * (1.0 + NOISE)).log10().floor() as i32).max(0) as usize;
        let number = |value: f64| format!("{:.decimals$}", value / 10f64.powi(power)).replace('-', "−");
        let first = (self.low / step).ceil() as i64;
        let last = (self.high / step).floor() as i64;
        // Adding 0 turns −0 into 0.
        let values = (first..=last).map(|k| k as f64 * step + 0.0);
        let ticks = values.map(|value| Tick { share: self.share(value), label: number(value) }).collect();
        (ticks, named(axis, power))
    }

    fn decades(&self, wanted: f64) -> Vec<Tick> {
        let (first, last) = (self.low.ceil() as i32, self.high.floor() as i32);
        if last <= first {
            return self.within_a_decade();
        }
        let every = 1 + (last - first) / (2 * wanted as i32);
        let powers = (first..=last).filter(|power| power % every == 0);
        powers.map(|power| Tick { share: self.share(10f64.powi(power)), label: power_of_ten(power) }).collect()
    }

    /// 1, 2 and 5 times the powers of ten, for a range with fewer than two of these.
    fn within_a_decade(&self) -> Vec<Tick> {
        let powers = self.low.floor() as i32..=self.high.ceil() as i32;
        let values = powers.flat_map(|power| [1.0, 2.0, 5.0].map(|digit| (digit, power)));
        let ticks = values.map(|(digit, power)| Tick {
            share: self.share(digit * 10f64.powi(power)),
            label: if (-3..4).contains(&power) {
                format!("{:.*}", (-power).max(0) as usize, digit * 10f64.powi(power))
            } else {
                format!("{digit}·{}", power_of_ten(power))
            },
        });
        ticks.filter(|tick| (0.0..=1.0).contains(&tick.share)).collect()
    }
}

impl Scale {
    fn place(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Logarithmic => value.log10(),
        }
    }
}

/// 1, 2 or 5 times a power of ten, next above.
fn round_step(least: f64) -> f64 {
    let power = 10f64.powi(least.log10().floor() as i32);
    [1.0, 2.0, 5.0, 10.0].map(|digit| digit * power).into_iter().find(|step| *step >= least).unwrap_or(10.0 * power)
}

fn named(axis: &Axis, power: i32) -> String {
    let factor = if power == 0 { String::new() } else { power_of_ten(power) };
    let unit = [factor.as_str(), axis.unit.as_str()].join(" ");
    match unit.trim() {
        "" => axis.name.clone(),
        unit => format!("{} [{unit}]", axis.name),
    }
}

fn power_of_ten(power: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raised = |c: char| c.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize]);
    format!("10{}", power.to_string().chars().map(raised).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::{Axis, Range};

    fn labels(axis: &Axis, values: &[f64]) -> (Vec<String>, String) {
        let (ticks, name) = Range::of(axis, values.iter().copied(), 0.0).ticks(axis, 5.0);
        (ticks.into_iter().map(|tick| tick.label).collect(), name)
    }

    #[test]
    fn numbers_are_round_and_short() {
        let slip = Axis::new("slip", "mm");
        for (values, expected, name) in [
            ([0.0, 1.0], &["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"][..], "slip [mm]"),
            ([0.0, 12_000.0], &["0", "5000", "10000"], "slip [mm]"),
            ([-0.3, 0.1 + 0.2], &["−0.2", "0.0", "0.2"], "slip [mm]"),
            ([0.0, 3.1e-5], &["0", "10", "20", "30"], "slip [10⁻⁶ mm]"),
            ([0.0, 2e6], &["0.0", "0.5", "1.0", "1.5", "2.0"], "slip [10⁶ mm]"),
            ([98.1, 98.1], &["90", "95", "100", "105"], "slip [mm]"),
            ([0.0, 0.0], &["−1.0", "−0.5", "0.0", "0.5", "1.0"], "slip [mm]"),
        ] {
            assert_eq!(
                labels(&slip, &values),
                (expected.iter().map(|s| (*s).into()).collect(), name.into()),
                "{values:?}"
            );
        }
        assert_eq!(labels(&Axis::new("R", ""), &[0.0, 1e-3]).1, "R [10⁻³]");
        assert_eq!(labels(&Axis::new("count", "").whole(), &[1.0, 2.0]).0, ["1", "2"]);
    }

    #[test]
    fn powers_of_ten_are_labelled_as_such() {
        let axis = Axis::new("residual", "").logarithmic();
        assert_eq!(labels(&axis, &[0.0, 1e-2, 1.0, f64::NAN]).0, ["10⁻²", "10⁻¹", "10⁰"]);
        assert_eq!(labels(&axis, &[1e-16, 1.0]).0.len(), 9);
        assert_eq!(labels(&axis, &[0.15, 0.6]).0, ["0.2", "0.5"]);
        assert_eq!(labels(&axis, &[20.0, 300.0]).0, ["20", "50", "100", "200"]);
    }
}
