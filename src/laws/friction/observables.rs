//! Observables of friction in the output, in addition to those of all laws; their names come from the laws.

use thiserror::Error;

use super::{Description, FrictionLaw, FrictionState};

/// Observables with a column in every table, and their value for laws that do not define them: without friction
/// there is no strength to approach, and without structure its degree is 1.
pub const ALWAYS: [(&str, f64); 3] = [("R", 0.0), ("mu", 0.0), ("structure", 1.0)];

/// Parts of an opening in the output.
const OF_OPENING: [&str; 2] = ["dilation", "wear"];

/// What is left of a bond in parallel with a law.
const BOND: &str = "bond";

/// Names of other outputs at contact points, not available to laws.
const TAKEN: [&str; 29] = [
    "time",
    "contact",
    "line",
    "point",
    "position",
    "x",
    "y",
    "displacement",
    "gap",
    "state",
    "slip",
    "total_slip",
    "plastic_slip",
    "plastic_increment",
    "elastic_slip",
    "slip_rate",
    "pressure",
    "p",
    "fluid_pressure",
    "p_w",
    "traction",
    "q",
    "dissipation",
    "dtraction_dslip",
    "dtraction_dpressure",
    "evaluations",
    BOND,
    OF_OPENING[0],
    OF_OPENING[1],
];

/// Maximum length of a name; combined with that of its contact it is a file name.
const LONGEST: usize = 64;

/// Names of a law that outputs cannot use: the reason, and a remedy.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("the names of the law: {0}")]
#[doc(hidden)]
pub struct InvalidNames(String);

/// Checks that the names of a law are valid for columns, arrays and files, and differ from other names. They must differ in
/// more than capitalization, since some systems ignore it in file names.
///
/// # Errors
/// Returns [`InvalidNames`] with the invalid name and a remedy.
#[doc(hidden)]
pub fn check_names(description: &Description) -> Result<(), InvalidNames> {
    let Description { variables, opening, .. } = description;
    if let Some(name) = opening.iter().find(|name| !OF_OPENING.contains(name)) {
        let [dilation, wear] = OF_OPENING;
        return Err(InvalidNames(format!("an opening has no part `{name}`: outputs show `{dilation}` and `{wear}`")));
    }
    check_each(variables)?;
    check_each(description.observables())
}

fn check_each(names: &[&str]) -> Result<(), InvalidNames> {
    let refused = |message: String| Err(InvalidNames(message));
    for (k, name) in names.iter().enumerate() {
        let fits = name.starts_with(char::is_alphabetic) && name.chars().all(|c| c.is_alphanumeric() || c == '_');
        if !fits || name.len() > LONGEST {
            return refused(format!(
                "the name {name:?} of a variable must begin with a letter and contain only letters, digits and _, at \
                 most {LONGEST} bytes: columns and files of the results are named by it"
            ));
        }
        if TAKEN.iter().any(|taken| taken.eq_ignore_ascii_case(name)) {
            return refused(format!(
                "a variable cannot be named `{name}`: the results already use that name; rename it"
            ));
        }
        let always =
            ALWAYS.iter().map(|(always, _)| always).find(|always| *always != name && always.eq_ignore_ascii_case(name));
        if let Some(other) = always.or_else(|| names[..k].iter().find(|other| other.eq_ignore_ascii_case(name))) {
            return refused(format!("the names `{other}` and `{name}` differ at most in capitals: rename one"));
        }
    }
    Ok(())
}

/// Names of the additional observables of some laws, each once, in order of appearance.
#[doc(hidden)]
pub fn further<'a>(laws: impl IntoIterator<Item = &'a Description>) -> Vec<&'static str> {
    let mut names = Vec::new();
    for name in laws
        .into_iter()
        .flat_map(|law| law.observables().iter().chain(law.opening).chain((law.bond > 0.0).then_some(&BOND)))
    {
        if ALWAYS.iter().all(|(always, _)| always != name) && !names.contains(name) {
            names.push(*name);
        }
    }
    names
}

/// Value of an observable, or its default if the law does not define it: NaN for an additional one.
pub fn value(law: &dyn FrictionLaw, name: &str, state: &FrictionState) -> f64 {
    let absent = || ALWAYS.iter().find(|(always, _)| *always == name).map_or(f64::NAN, |(_, absent)| *absent);
    law.observe(name, state).unwrap_or_else(absent)
}
