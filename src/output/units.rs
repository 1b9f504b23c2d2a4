//! Units of recorded quantities, as powers of force, length and time.

use std::collections::BTreeMap;

/// Unit of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unit {
    /// name under which a case may label it, as for `length`, `force` and `time`
    pub name: &'static str,
    /// powers of force, length and time
    powers: [i8; 3],
}

const fn unit(name: &'static str, powers: [i8; 3]) -> Unit {
    Unit { name, powers }
}

/// Dimensionless number, or a word.
pub const NONE: Unit = unit("none", [0, 0, 0]);
/// L
pub const LENGTH: Unit = unit("length", [0, 1, 0]);
/// F/L²
pub const STRESS: Unit = unit("stress", [1, -2, 0]);
/// L/T
pub const VELOCITY: Unit = unit("velocity", [0, 1, -1]);
/// T
pub const TIME: Unit = unit("time", [0, 0, 1]);
/// F
pub const FORCE: Unit = unit("force", [1, 0, 0]);
/// F T²/L, of inputs
pub const MASS: Unit = unit("mass", [1, -1, 2]);
/// F T²/L⁴, of inputs
pub const DENSITY: Unit = unit("density", [1, -4, 2]);
pub(super) const ANGLE: Unit = unit("angle", [0, 0, 0]);
pub(super) const ACCELERATION: Unit = unit("acceleration", [0, 1, -2]);
pub(super) const ENERGY: Unit = unit("energy", [1, 1, 0]);
pub(super) const POWER: Unit = unit("power", [1, 1, -1]);
pub(super) const WORK_PER_AREA: Unit = unit("work_per_area", [1, -1, 0]);
pub(super) const MOMENTUM: Unit = unit("momentum", [1, 0, 1]);
pub(super) const SPIN: Unit = unit("angular_momentum", [1, 1, 1]);
pub(super) const VOLUME: Unit = unit("volume", [0, 3, 0]);
pub(super) const FLOW: Unit = unit("flow", [0, 3, -1]);
pub(super) const STIFFNESS: Unit = unit("stiffness_per_area", [1, -3, 0]);

/// F/L, of what acts along a line
pub(super) const LINE_FORCE: Unit = WORK_PER_AREA;

/// All units of results.
pub const LABELLED: [Unit; 15] = [
    LENGTH,
    FORCE,
    TIME,
    STRESS,
    VELOCITY,
    ACCELERATION,
    ENERGY,
    POWER,
    WORK_PER_AREA,
    MOMENTUM,
    SPIN,
    VOLUME,
    FLOW,
    STIFFNESS,
    ANGLE,
];

impl Unit {
    /// Powers of force, length and time.
    pub fn powers(self) -> [i32; 3] {
        self.powers.map(i32::from)
    }

    /// Whether it is dimensionless.
    pub fn is_plain(self) -> bool {
        self.powers == [0; 3]
    }

    /// Whether it is that of a sum over the thickness, as forces, energies and masses are.
    pub fn is_sum(self) -> bool {
        [FORCE, ENERGY, POWER, MOMENTUM, SPIN, MASS, VOLUME, FLOW].contains(&self)
    }

    /// Formats the unit from those of force, length and time: `F/L²`; empty for a dimensionless number.
    pub fn made_of(self, [force, length, time]: [&str; 3]) -> String {
        let raised = |power: i8| match power.abs() {
            2 => "²",
            3 => "³",
            _ => "",
        };
        let parts = [force, length, time].into_iter().zip(self.powers);
        let above = parts.clone().filter(|(_, power)| *power > 0).map(|(of, power)| format!("{of}{}", raised(power)));
        let below = parts.filter(|(_, power)| *power < 0).map(|(of, power)| format!("{of}{}", raised(power)));
        let [above, below] = [above.collect::<Vec<_>>(), below.collect()].map(|parts| parts.join("·"));
        match (above.is_empty(), below.is_empty()) {
            (_, true) => above,
            (true, false) => format!("1/{below}"),
            (false, false) => format!("{above}/{below}"),
        }
    }

    /// Formats the unit according to the CF conventions: `N mm-2`.
    pub fn of_store(self, [force, length, time]: [&str; 3]) -> String {
        let parts = [force, length, time].into_iter().zip(self.powers).filter(|(_, power)| *power != 0);
        let mut parts: Vec<(&str, i8)> = parts.collect();
        parts.sort_by_key(|(_, power)| *power < 0);
        let part = |(of, power): (&str, i8)| if power == 1 { of.to_string() } else { format!("{of}{power}") };
        parts.into_iter().map(part).collect::<Vec<_>>().join(" ")
    }

    /// Label in a case: the given one, or one composed by `made` of force, length and time, if those needed are known.
    pub fn label(self, units: &BTreeMap<String, String>, made: fn(Self, [&str; 3]) -> String) -> Option<String> {
        if let Some(label) = units.get(self.name) {
            return Some(label.clone());
        }
        let labels = ["force", "length", "time"].map(|of| units.get(of));
        let known = labels.iter().zip(self.powers).all(|(label, power)| power == 0 || label.is_some());
        (known && self.powers != [0; 3]).then(|| made(self, labels.map(|label| label.map_or("", String::as_str))))
    }
}
