//! Factor of safety of the end of a run, by reduction of strength.
//!
//! ```text
//! c → c/F,   tan φ → tan φ/F,   σ_y → σ_y/F             bodies: mohr_coulomb, drucker_prager, von_mises
//! μ → μ/F,   c → c/F                                     interfaces: friction without healing and rate, bonds
//! ```
//! From the state at the end of the run, the strengths are those of F from one moment to the next. The stresses that they cannot bear any more are
//! kept as forces, which decrease to zero over a static step ([`crate::model::Step::relaxes`]). F is above the factor of safety where that step
//! has no equilibrium, however short its increments are, or displacements grow to more than ten times the elastic ones.
//!
//! Source: O. C. Zienkiewicz, C. Humpheson & R. W. Lewis (1975), Géotechnique 25, 671.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use serde_json::{Map, Value, json};

use super::job::{Job, Refused};
use super::{CaseError, Opened, Written, build_on, mesh, read};
use crate::model::builder::{Checked, ModelError, refuse_if};
use crate::output::checkpoint;

/// What is reduced; where no names are given, all bodies and contacts that have a strength.
#[derive(Clone, Debug, Default)]
pub struct Reduced {
    /// names of bodies
    pub bodies: Vec<String>,
    /// names of contacts
    pub contacts: Vec<String>,
}

/// Increments of a trial, and its shortest one, as fractions of its step.
const INCREMENTS: [f64; 2] = [0.1, 1e-4];

/// The keys of a law that F divides, by its name; angles among them by their tangents.
const STRENGTHS: [(&str, &[&str]); 7] = [
    ("mohr_coulomb", &["c", "phi"]),
    ("drucker_prager", &["c", "phi"]),
    ("von_mises", &["sigma_y"]),
    ("coulomb", &["mu"]),
    ("adhesion", &["strength"]),
    ("slip_weakening", &["mu_s", "mu_d", "cohesion"]),
    ("super_subloading", &["mu_s", "mu_k"]),
];

/// The keys of a bond that F divides.
const OF_BONDS: [&str; 4] = ["strength", "residual", "tension", "limit"];

/// Keys that make a law harden, heal or depend on the rate, so that it has no strength to divide.
const OTHERS: [&str; 5] = ["H", "Q", "back_stresses", "xi", "viscosity"];

impl Reduced {
    /// Checks that a case has what is to be reduced.
    ///
    /// # Errors
    /// Returns [`CaseError`] with the place of a body or contact without a strength that F could divide, or if there is none at all.
    pub fn check(&self, written: &Written) -> Result<(), CaseError> {
        stands_still(&written.document)
            .and_then(|()| self.of(&written.document, 1.0))
            .map(drop)
            .map_err(|complaint| complaint.in_file(&written.path))
    }

    /// A case with strengths divided by F.
    fn of(&self, document: &Value, factor: f64) -> Checked<Value> {
        // After the first correction alone, overshoot cannot be told from growth.
        let message = "is 1: a trial cannot tell a failure from a start of its iteration; give 2 or more";
        refuse_if(document["newton"]["max_iterations"] == 1, "newton.max_iterations", message)?;
        for (name, body) in document["bodies"].as_object().into_iter().flatten() {
            let message = "a factor of safety is not available with flowing water: leave it out, and give the pressure \
                           of the water (pore_pressure)";
            let flows = !body["pore_fluid"]["permeability"].is_null();
            refuse_if(flows, format!("bodies.{name}.pore_fluid.permeability"), message)?;
        }
        let mut case = document.clone();
        let mut count = 0;
        for (list, names, law_key, tag) in
            [("bodies", &self.bodies, "material", "model"), ("contacts", &self.contacts, "friction", "law")]
        {
            let empty = Map::new();
            let known = document[list].as_object().unwrap_or(&empty);
            if let Some(name) = names.iter().find(|name| !known.contains_key(*name)) {
                let known: Vec<&str> = known.keys().map(String::as_str).collect();
                return Err(ModelError::new(list, crate::mesh::names::not_known(name, &known)));
            }
            let all = self.bodies.is_empty() && self.contacts.is_empty();
            for (name, given) in known.iter().filter(|(name, _)| all || names.contains(name)) {
                let place = format!("{list}.{name}.{law_key}");
                let law = given.get(law_key).and_then(|law| law.get(tag)).and_then(Value::as_str).unwrap_or_default();
                let [has_bond, is_interface] =
                    ["bond", "interface"].map(|key| given.get(key).is_some_and(Value::is_object));
                if given.get("radiation_damping").is_some_and(|eta| eta.is_number() || *eta == json!(true)) {
                    let message = "carries load as long as anything moves, so that nothing fails: leave it out";
                    return Err(ModelError::new(format!("{list}.{name}.radiation_damping"), message));
                }
                let part = &mut case[list][name];
                match STRENGTHS.iter().find(|(known, _)| *known == law) {
                    Some((_, keys)) => {
                        divide(&mut part[law_key], law, keys, factor, &place)?;
                        if given.get("along").is_some_and(Value::is_object) {
                            along(&mut part["along"], keys, factor, &format!("{list}.{name}.along"))?;
                        }
                        count += 1;
                    }
                    None if !(all || has_bond || is_interface) => return Err(ModelError::new(place, no_strength(law))),
                    None if ["rate_and_state", "registered", "prescribed"].contains(&law) => {
                        return Err(ModelError::new(place, no_strength(law)));
                    }
                    None => {}
                }
                if has_bond {
                    let bond = &mut part["bond"];
                    OF_BONDS.iter().for_each(|key| scale(&mut bond[*key], factor));
                    prune(bond);
                    count += 1;
                }
                if is_interface {
                    // A share of the strength of the soil follows the soil where that is reduced.
                    let own = if all || !self.bodies.is_empty() { None } else { Some("reduction") };
                    let strength = &mut part["interface"];
                    ["cohesion"].into_iter().chain(own).for_each(|key| scale(&mut strength[key], factor));
                    if let Some(degrees) = strength["friction_angle"].as_f64() {
                        strength["friction_angle"] = json!(divided_angle(degrees, factor));
                    }
                    prune(strength);
                    count += 1;
                }
                prune(part);
            }
        }
        match count {
            0 => Err(ModelError::new("", "no body and no contact has a strength that a factor could divide")),
            _ => Ok(case),
        }
    }

    /// A run of the case from the end of its run in the folder `end`, with strengths divided by F, into a folder of its own.
    ///
    /// # Errors
    /// Returns [`Refused`] if the run in the folder is not complete, or the case or the folder cannot be used.
    pub fn job(&self, written: &Written, end: &Path, factor: f64, place: &Path) -> Result<Job, Refused> {
        let Written { path, .. } = written;
        let opened = Opened::begin(written.clone())?;
        let taken_over = opened.case.steps.len();
        let complain = |complaint: ModelError| complaint.in_file(path);
        stands_still(&opened.document).map_err(complain)?;
        let mut document = self.of(&opened.document, factor).map_err(complain)?;
        add_step(&mut document, &opened, factor);
        let case: super::file::Case = read::input(&document).map_err(complain)?;
        let mesh = mesh(&case, path).map_err(complain)?;
        let mut model = build_on(&case, mesh, path)?;
        if let Some(step) = model.steps.last_mut() {
            step.relaxes = true;
        }
        let model = Arc::new(model);
        let (checkpoint, _) = checkpoint::newest(end).map_err(|(file, why)| Refused::Checkpoint(file, why))?;
        let saved = crate::run::SavedRun::from_bytes(checkpoint.run, &model)
            .map_err(|error| complain(ModelError::new("", error.to_string())))?;
        Job::claim(Opened::going_on(path, document, case, taken_over), model, Some(saved.begin()), place)
    }
}

/// Refuses what would go on changing in the trials, whose time follows that of the case: supports and loads in force at its end, pressures,
/// temperatures and parameters that depend on time.
fn stands_still(case: &Value) -> Checked<()> {
    let steps = case["steps"].as_array().map_or(&[][..], Vec::as_slice);
    let end: f64 = steps.iter().filter_map(|step| step["duration"].as_f64()).sum();
    let mut in_force = BTreeMap::new();
    for (k, step) in steps.iter().enumerate() {
        for list in ["supports", "loads"] {
            for (i, entry) in step[list].as_array().into_iter().flatten().enumerate() {
                for (key, value) in entry.as_object().into_iter().flatten() {
                    let place = format!("steps[{k}].{list}[{i}].{key}");
                    in_force.insert((list, entry["on"].to_string(), key.clone()), (place, value));
                }
            }
        }
        for (body, value) in step["temperature"].as_object().into_iter().flatten() {
            in_force.insert(
                ("temperature", body.clone(), String::new()),
                (format!("steps[{k}].temperature.{body}"), value),
            );
        }
    }
    let parts = [("contacts", "fluid_pressure"), ("contacts", "along"), ("bodies", "pore_pressure")];
    let given = parts.into_iter().flat_map(|(list, key)| {
        let named = case[list].as_object().into_iter().flatten();
        named.map(move |(name, part)| (format!("{list}.{name}.{key}"), &part[key]))
    });
    let changing = in_force.into_values().chain(given).find(|(_, value)| changes_after(value, end));
    changing.map_or(Ok(()), |(place, _)| {
        let message = "would go on changing in the trials, after the end of the case: keep it constant in a last step \
            (a motion by {\"rate\": 0}), or give it without t";
        Err(ModelError::new(place, message))
    })
}

/// Whether a value of a case, or anything in it, depends on time after the end.
fn changes_after(value: &Value, end: f64) -> bool {
    match value {
        Value::String(text) => text.split(|c: char| !(c.is_alphanumeric() || c == '_')).any(|word| word == "t"),
        Value::Object(object) => object.iter().any(|(key, inner)| match key.as_str() {
            "on" => false,
            "rate" => inner.as_f64().is_none_or(|rate| rate != 0.0),
            "measured" | "flow" => true,
            "table" => {
                let last = inner.as_array().and_then(|rows| rows.last()).and_then(|row| row[0].as_f64());
                last.is_none_or(|last| last > end)
            }
            _ => changes_after(inner, end),
        }),
        Value::Array(list) => list.iter().any(|inner| changes_after(inner, end)),
        _ => false,
    }
}

fn no_strength(law: &str) -> String {
    format!(
        "`{law}` has no strength that a factor could divide: name the bodies and contacts that have (--body, --contact)"
    )
}

/// The static step over which the forces decrease that weaker laws cannot bear; as long as the last one.
fn add_step(document: &mut Value, opened: &Opened, factor: f64) {
    let duration = opened.case.steps.last().map_or(1.0, |step| step.duration);
    let [longest, shortest] = INCREMENTS.map(|share| share * duration);
    let step = json!({"name": format!("F = {factor}"), "duration": duration, "scheme": "static",
                      "dt": {"initial": longest, "max": longest, "min": shortest}});
    if let Some(steps) = document["steps"].as_array_mut() {
        steps.push(step);
    }
}

/// Divides the strengths of a law.
fn divide(law: &mut Value, name: &str, keys: &[&str], factor: f64, place: &str) -> Checked<()> {
    let is_given = |key: &&&str| {
        law[**key].as_f64().is_some_and(|value| value != 0.0)
            || law[**key].as_array().is_some_and(|list| !list.is_empty())
    };
    match OTHERS.iter().find(is_given) {
        // Slow flow is at the strength without viscosity.
        Some(&"viscosity") => law["viscosity"] = json!(0.0),
        Some(&key) => {
            let what = if key == "xi" { "heals" } else { "hardens" };
            let message = format!(
                "`{name}` with `{key}` {what}: it has no strength of its own to divide by a factor; leave `{key}` out"
            );
            return Err(ModelError::new(place, message));
        }
        None => {}
    }
    for key in keys {
        match *key {
            "phi" => {
                let phi = law["phi"].as_f64().map_or(0.0, |degrees| divided_angle(degrees, factor));
                law["phi"] = json!(phi);
                if law["psi"].as_f64().is_some_and(|psi| psi > phi) {
                    law["psi"] = json!(phi);
                }
            }
            key => scale(&mut law[key], factor),
        }
    }
    prune(law);
    Ok(())
}

/// Divides the strengths that vary along an interface, and those of laws on parts of it.
fn along(along: &mut Value, keys: &[&str], factor: f64, place: &str) -> Checked<()> {
    for key in keys {
        match &mut along[*key] {
            Value::Null => {}
            Value::Number(number) => along[*key] = json!(number.as_f64().unwrap_or_default() / factor),
            Value::String(text) => along[*key] = json!(format!("({text})/{factor}")),
            _ => {
                let message =
                    "is a table or a field, which is not divided by a factor: give it as an expression of x and y";
                return Err(ModelError::new(format!("{place}.{key}"), message));
            }
        }
    }
    if along["law"].as_array().is_some_and(|laws| !laws.is_empty()) {
        return Err(ModelError::new(
            format!("{place}.law"),
            "parts of an interface have laws of their own, whose strengths are not divided: give them contacts of their own",
        ));
    }
    prune(along);
    Ok(())
}

/// The angle whose tangent is that of another over F [degrees].
fn divided_angle(degrees: f64, factor: f64) -> f64 {
    (degrees.to_radians().tan() / factor).atan().to_degrees()
}

fn scale(value: &mut Value, factor: f64) {
    if let Some(number) = value.as_f64() {
        *value = json!(number / factor);
    }
}

/// Takes out the nulls that looking up a key has put into an object.
fn prune(value: &mut Value) {
    if let Value::Object(object) = value {
        object.retain(|_, value| !value.is_null());
    }
}

/// What a trial has found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    /// F
    pub factor: f64,
    /// whether the strengths divided by F bear the loads
    pub stands: bool,
    /// fraction of the step at which the run ended
    pub reached: f64,
    /// largest displacement in it [L]
    pub displacement: f64,
    /// the same over that of the first increment carried on to there: how much more than elastic
    pub growth: f64,
}

/// Factors between which the one of failure lies, by doubling and halving the change of F.
#[derive(Clone, Debug)]
pub struct Search {
    /// Largest F that stands
    pub stands: f64,
    /// Least F that fails, if one is known
    pub fails: Option<f64>,
    change: f64,
    most: f64,
}

impl Search {
    /// Begins at the case as it is, F = 1.
    pub fn new(most: f64) -> Self {
        Self { stands: 1.0, fails: None, change: 0.1, most }
    }

    /// The next F to try; `None` once both factors are `within` a difference, or the largest F stands.
    pub fn next(&self, within: f64) -> Option<f64> {
        match self.fails {
            Some(fails) if fails - self.stands <= within * (1.0 + f64::EPSILON) => None,
            Some(fails) => Some(rounded(0.5 * (self.stands + fails))),
            None if self.stands >= self.most => None,
            None => Some(rounded(self.stands + self.change).min(self.most)),
        }
    }

    /// Takes the outcome of a trial.
    pub fn note(&mut self, trial: &Trial) {
        if trial.stands {
            self.stands = trial.factor;
            self.change *= 2.0;
        } else {
            self.fails = Some(trial.factor);
        }
    }
}

/// F with few digits, for names of folders and steps.
fn rounded(factor: f64) -> f64 {
    (factor * 1e4).round() / 1e4
}

/// All trials by their factors, as a table.
pub fn table(trials: &[Trial]) -> String {
    let sorted: BTreeMap<u64, &Trial> = trials.iter().map(|trial| (trial.factor.to_bits(), trial)).collect();
    let row = |trial: &&Trial| {
        let Trial { factor, stands, reached, displacement, growth } = trial;
        format!("{factor},{},{reached},{displacement},{growth}\n", u8::from(*stands))
    };
    std::iter::once("factor,stands,reached,displacement,growth\n".into()).chain(sorted.values().map(row)).collect()
}
