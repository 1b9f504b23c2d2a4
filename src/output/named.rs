//! Quantities in words: their names in charts, and what `fecontact schema results` prints of them.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use super::quantities::{ALL, FORMER, Group, Quantity, Unit};

/// Name of a quantity in charts.
pub fn spoken(name: &str) -> String {
    match name {
        "mu" => "μ".into(),
        "theta" => "θ".into(),
        "theta_2" => "θ₂".into(),
        "structure" => "structure 1/R*".into(),
        "pressure" => "pressure p".into(),
        "traction" => "traction q".into(),
        "state" => "state (0 open, 1 stick, 2 slip)".into(),
        "von_mises" => "von Mises stress".into(),
        "log_strain" => "logarithmic strain".into(),
        "stretch_zz" => "stretch across the plane".into(),
        _ => name.replace('_', " "),
    }
}

/// All quantities by their files, as `fecontact schema results` prints them.
pub fn schema() -> Value {
    let shown = |(owner, of): (&str, &Quantity)| {
        let Quantity { name, unit, meaning } = *of;
        let whole = if owner.is_empty() { name.into() } else { format!("{owner}.{name}") };
        let mut entry = json!({
            "name": whole, "unit": unit.made_of(["F", "L", "T"]), "of": unit.name, "spoken": spoken(name), "meaning": meaning,
        });
        if let Some((former, _)) = FORMER.iter().find(|(_, now)| owner == "CONTACT" && *now == name) {
            entry["formerly"] = json!(former);
        }
        entry
    };
    let of_group = |(owner, some): &Group| some.iter().map(|of| shown((owner, of))).collect::<Vec<_>>();
    ALL.iter().map(|(file, groups)| (file.to_string(), groups.iter().flat_map(of_group).collect::<Value>())).collect()
}

/// Labels of the units of the arrays of frames, such as those of `solid`, by the names of the arrays.
pub fn of_frames(series: &str, units: &BTreeMap<String, String>) -> BTreeMap<String, String> {
    let file = format!("{series}.pvd");
    let all = ALL.iter().filter(|(name, _)| *name == file).flat_map(|(_, groups)| *groups).flat_map(|(_, some)| *some);
    all.filter_map(|of| Some((of.name.to_owned(), of.unit.label(units, Unit::made_of)?))).collect()
}

/// Data for a page: labels of units by their names, and label and unit name of every quantity.
pub fn labels(units: &BTreeMap<String, String>) -> Value {
    let (mut of_units, mut quantities) = (Map::new(), Map::new());
    // newton.csv counts slipping points under the name of a length.
    for of in ALL.iter().filter(|(file, _)| *file != "newton.csv").flat_map(|(_, all)| *all).flat_map(|(_, some)| *some)
    {
        let label = of.unit.label(units, Unit::made_of).unwrap_or_default();
        // Of a name that occurs twice the first is meant: later ones are derivatives.
        quantities.entry(of.name).or_insert_with(|| json!([label, spoken(of.name)]));
        of_units.insert(of.unit.name.into(), json!(label));
    }
    json!({ "units": of_units, "quantities": quantities })
}
