//! Labels of units, read: `N/mm`, `kN/m^2`, `kg m-3`, `N·mm/(mm·s)`.
//!
//! ```text
//! label = number · [N]ᵃ [m]ᵇ [s]ᶜ · names that are not known here
//! ```
//! Names of units are those of the SI with their prefixes, and the usual ones beside it (`bar`, `psi`, `in`, `lbf`, `t`, `h`).

use std::collections::BTreeMap;

/// Largest power that is read.
const HIGHEST: i32 = 9;

/// Deviation of two units that count as equal, for a year of 365 days or 365.25 [-].
const EQUAL: f64 = 1e-3;

/// Names that prefixes may precede: value, and powers of N, m and s.
const PREFIXED: [(&str, f64, [i32; 3]); 7] = [
    ("m", 1.0, [0, 1, 0]),
    ("N", 1.0, [1, 0, 0]),
    ("s", 1.0, [0, 0, 1]),
    ("Pa", 1.0, [1, -2, 0]),
    ("J", 1.0, [1, 1, 0]),
    ("W", 1.0, [1, 1, -1]),
    ("g", 1e-3, [1, -1, 2]),
];

const PREFIXES: [(&str, f64); 11] = [
    ("", 1.0),
    ("k", 1e3),
    ("M", 1e6),
    ("G", 1e9),
    ("h", 1e2),
    ("d", 1e-1),
    ("c", 1e-2),
    ("m", 1e-3),
    ("µ", 1e-6),
    ("u", 1e-6),
    ("n", 1e-9),
];

/// Pound-force, and inch.
const LBF: f64 = 4.448_221_615_260_5;
const INCH: f64 = 0.0254;
const HOUR: f64 = 3600.0;
const YEAR: f64 = 365.25 * 24.0 * HOUR;

/// Names without prefixes, in lower case where their case means nothing.
const OTHERS: [(&[&str], f64, [i32; 3]); 23] = [
    (&["metre", "metres", "meter", "meters"], 1.0, [0, 1, 0]),
    (&["millimetre", "millimetres", "millimeter", "millimeters"], 1e-3, [0, 1, 0]),
    (&["kilometre", "kilometres", "kilometer", "kilometers"], 1e3, [0, 1, 0]),
    (&["micron", "microns"], 1e-6, [0, 1, 0]),
    (&["in", "inch", "inches"], INCH, [0, 1, 0]),
    (&["ft", "foot", "feet"], 12.0 * INCH, [0, 1, 0]),
    (&["newton", "newtons"], 1.0, [1, 0, 0]),
    (&["kgf", "kp"], 9.806_65, [1, 0, 0]),
    (&["lbf"], LBF, [1, 0, 0]),
    (&["kip", "kips"], 1e3 * LBF, [1, 0, 0]),
    (&["sec", "second", "seconds"], 1.0, [0, 0, 1]),
    (&["msec", "millisecond", "milliseconds"], 1e-3, [0, 0, 1]),
    (&["min", "minute", "minutes"], 60.0, [0, 0, 1]),
    (&["h", "hr", "hour", "hours"], HOUR, [0, 0, 1]),
    (&["d", "day", "days"], 24.0 * HOUR, [0, 0, 1]),
    (&["a", "yr", "year", "years"], YEAR, [0, 0, 1]),
    (&["bar"], 1e5, [1, -2, 0]),
    (&["psi"], LBF / (INCH * INCH), [1, -2, 0]),
    (&["ksi"], 1e3 * LBF / (INCH * INCH), [1, -2, 0]),
    (&["t", "tonne", "tonnes"], 1e3, [1, -1, 2]),
    (&["slug", "slugs"], LBF / (12.0 * INCH), [1, -1, 2]),
    (&["rad", "radian", "radians"], 1.0, [0, 0, 0]),
    (&["deg", "degree", "degrees", "°"], std::f64::consts::PI / 180.0, [0, 0, 0]),
];

/// A name in a label, with its power.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    name: String,
    power: i32,
}

/// Reads the factors of a label; `None` if it is not written in one of the usual ways. Behind a `/`, several are read in
/// brackets only, since `N/mm·s` is read in two ways.
pub fn factors(label: &str) -> Option<Vec<Factor>> {
    let label = label.trim().replace("**", "^");
    let mut parts = label.split('/');
    let mut factors = product(parts.next()?)?;
    for part in parts {
        let part = part.trim();
        let bracketed = part.strip_prefix('(').and_then(|part| part.strip_suffix(')'));
        let below = product(bracketed.unwrap_or(part))?;
        if bracketed.is_none() && below.len() > 1 {
            return None;
        }
        factors.extend(below.into_iter().map(|Factor { name, power }| Factor { name, power: -power }));
    }
    Some(factors)
}

fn product(text: &str) -> Option<Vec<Factor>> {
    let between = |c: char| c.is_whitespace() || "·⋅*×".contains(c);
    let words: Vec<&str> = text.split(between).filter(|word| !word.is_empty()).collect();
    let factors: Option<Vec<Factor>> = words.into_iter().map(factor).collect();
    factors.filter(|factors| !factors.is_empty())
}

/// Reads a name with its power: `mm`, `mm2`, `mm^2`, `mm-2`, `mm²`.
fn factor(word: &str) -> Option<Factor> {
    let superscript = |c: char| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().position(|digit| digit == c).map(|digit| digit.to_string());
    let plain: String =
        word.chars().map(|c| if c == '⁻' { "-".into() } else { superscript(c).unwrap_or(c.to_string()) }).collect();
    let is_number = word.starts_with(|c: char| c.is_ascii_digit());
    let is_raised = plain != word;
    let (name, power) = match plain.split_once('^') {
        Some((name, power)) => (name.to_owned(), power.to_owned()),
        None if is_number && is_raised => {
            let end = word.find(|c| c == '⁻' || superscript(c).is_some())?;
            (word[..end].to_owned(), plain.get(end..)?.to_owned())
        }
        None if is_number => (plain, String::new()),
        None => {
            let end = plain.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches(['-', '+']).len();
            (plain[..end].to_owned(), plain[end..].to_owned())
        }
    };
    let power = if power.is_empty() { 1 } else { power.parse().ok().filter(|power: &i32| power.abs() <= HIGHEST)? };
    let is_name = !name.is_empty() && !name.contains(['(', ')', '^', ',', ';']);
    is_name.then_some(Factor { name, power })
}

/// Writes a product of labels, each with its power: `N/mm²`. What stands above the line and below is not cancelled, so that an
/// energy per length stays N·mm/mm.
pub fn composed(parts: &[(&str, i32)]) -> String {
    let mut sides: [Vec<Factor>; 2] = Default::default();
    for (label, power) in parts.iter().filter(|(_, power)| *power != 0) {
        let whole = || vec![Factor { name: (*label).to_owned(), power: 1 }];
        for Factor { name, power: own } in factors(label).unwrap_or_else(whole) {
            let power = own * power;
            let side = &mut sides[usize::from(power < 0)];
            match side.iter_mut().find(|factor| factor.name == name) {
                Some(factor) => factor.power += power.abs(),
                None => side.push(Factor { name, power: power.abs() }),
            }
        }
    }
    let raised = |Factor { name, power }: &Factor| match power {
        1 => name.clone(),
        2 => format!("{name}²"),
        3 => format!("{name}³"),
        4 => format!("{name}⁴"),
        power => format!("{name}^{power}"),
    };
    let [above, below] = sides.map(|side| side.iter().map(raised).collect::<Vec<_>>());
    let divisor = if below.len() > 1 { format!("({})", below.join("·")) } else { below.concat() };
    match (above.is_empty(), below.is_empty()) {
        (_, true) => above.join("·"),
        (true, false) => format!("1/{divisor}"),
        (false, false) => format!("{}/{divisor}", above.join("·")),
    }
}

/// A unit: its number of N, m and s to their powers, and the powers of names that are not known.
#[derive(Clone, Debug, PartialEq)]
pub struct Measure {
    /// number of N, m, s
    value: f64,
    /// powers of N, m and s
    powers: [i32; 3],
    /// powers of other names
    unknown: BTreeMap<String, i32>,
}

impl Measure {
    /// The dimensionless 1.
    pub fn one() -> Self {
        Self { value: 1.0, powers: [0; 3], unknown: BTreeMap::new() }
    }

    /// Reads a label; one that is not written in a usual way is an unknown name as a whole.
    pub fn of(label: &str) -> Self {
        let whole = || vec![Factor { name: label.trim().to_owned(), power: 1 }];
        let factors = factors(label).unwrap_or_else(whole);
        factors.iter().fold(Self::one(), |product, Factor { name, power }| product.times(&named(name), *power))
    }

    /// Returns the product with another unit to a power.
    pub fn times(mut self, other: &Self, power: i32) -> Self {
        self.value *= other.value.powi(power);
        self.powers = std::array::from_fn(|i| self.powers[i] + power * other.powers[i]);
        for (name, own) in &other.unknown {
            *self.unknown.entry(name.clone()).or_default() += own * power;
        }
        self.unknown.retain(|_, power| *power != 0);
        self
    }

    /// Whether all names are known.
    pub fn is_known(&self) -> bool {
        self.unknown.is_empty()
    }

    /// Its names that are not known.
    pub fn unknown(&self) -> impl Iterator<Item = &String> {
        self.unknown.keys()
    }

    /// Whether two units are of the same kind.
    pub fn is_like(&self, other: &Self) -> bool {
        (self.powers, &self.unknown) == (other.powers, &other.unknown)
    }

    /// Whether its powers of force, length and time are these.
    pub fn has(&self, powers: [i32; 3]) -> bool {
        self.powers == powers && self.is_known()
    }

    /// How many of another unit of the same kind it is [-].
    pub fn over(&self, other: &Self) -> f64 {
        self.value / other.value
    }

    /// Whether two units are the same.
    pub fn equals(&self, other: &Self) -> bool {
        self.is_like(other) && (self.over(other) - 1.0).abs() <= EQUAL
    }

    /// The usual name of this unit, if there is one: kPa, mJ, t/mm³.
    pub fn name(&self) -> Option<String> {
        let prefixed =
            ["Pa", "J", "W"].into_iter().flat_map(|name| ["", "k", "M", "G", "m"].map(|by| format!("{by}{name}")));
        let of_mass = ["kg", "t", "kg/m³", "t/m³", "t/mm³"].map(String::from);
        prefixed.chain(of_mass).find(|name| Self::of(name).equals(self))
    }
}

/// Returns the unit of a name, or number.
fn named(name: &str) -> Measure {
    let number = name.parse().ok().filter(|number: &f64| *number > 0.0 && number.is_finite());
    if let Some(value) = number {
        return Measure { value, ..Measure::one() };
    }
    let name = name.replace('μ', "µ");
    let lower = name.to_lowercase();
    // Long names may begin with a capital; short ones are what they are: mN and MN.
    let is_other = |other: &&str| name == **other || (other.len() > 3 && lower == **other);
    if let Some((_, value, powers)) = OTHERS.iter().find(|(names, ..)| names.iter().any(is_other)) {
        return Measure { value: *value, powers: *powers, ..Measure::one() };
    }
    let prefixed = PREFIXED.iter().find_map(|(unit, value, powers)| {
        let before = name.strip_suffix(unit)?;
        let (_, by) = PREFIXES.iter().find(|(prefix, _)| *prefix == before)?;
        Some(Measure { value: by * value, powers: *powers, ..Measure::one() })
    });
    prefixed.unwrap_or_else(|| Measure { unknown: [(name, 1)].into(), ..Measure::one() })
}
