//! Friction of a contact: a law, or parameters of laws, some of which vary along the slave and in time (patches that weaken and
//! recover, onset of creep).

use std::collections::BTreeMap;
use std::fmt::{Debug, Formatter};
use std::sync::Arc;

use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::de::{MapAccess, Visitor};
use serde::ser::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::additions::Additions;
use super::error::{Checked, ModelError, refuse_if};
use crate::contact::pair::LawsInTime;
use crate::contact::surface::SlavePoint;
use crate::laws::friction::{
    AdhesionParameters, Beyond, ContactLaw, CoulombParameters, FrictionLaw, FrictionParameters, LawFailure,
    PrescribedSlipParameters, RateAndStateParameters, SlipWeakeningParameters, SuperSubloadingParameters, Tie,
    observables,
};
use crate::laws::parameter::{InvalidParameter, UnknownParameter};
use crate::mesh::Mesh;
use crate::mesh::names::not_known;
use crate::mesh::shape::gauss;
use crate::model::boundary::{InvalidField, Profile, check_table};

/// Friction of a contact: a law, or parameters of one, whose α_t has a default.
#[derive(Clone, Deserialize)]
#[serde(from = "FrictionParameters")]
#[must_use]
pub struct Friction {
    /// Parameters as in a case; `None` for a law from code
    parameters: Option<FrictionParameters>,
    /// Name within the contact, for messages
    name: String,
    varying: Vec<Named>,
    law: Arc<LawAt>,
    /// Whether no law was given: the surfaces are tied
    tie: bool,
    /// Regions with other friction, of which the first one that applies is used
    elsewhere: Vec<Region>,
}

/// A profile with its name within the contact, for messages.
#[derive(Clone)]
struct Named {
    name: String,
    profile: Profile,
}

impl Named {
    /// Returns the value at a reference position, which must be finite; `contact` is its place.
    fn value(&self, at: Vector2<f64>, contact: &str) -> Checked<f64> {
        defined(&self.profile, at, &format!("{contact}.{}", self.name))
    }
}

/// Friction where a profile is positive.
#[derive(Clone)]
struct Region {
    positive: Named,
    friction: Friction,
}

impl Friction {
    /// Creates friction that varies along the slave by reference position, and in time: `law` receives the values of the
    /// profiles at a point, and the default α_t. Messages name a profile by its name, such as `along.mu`.
    ///
    /// ```
    /// use fecontact::laws::friction::{Coulomb, CoulombParameters};
    /// use fecontact::model::boundary::{Expression, Profile};
    /// use fecontact::model::builder::Friction;
    ///
    /// let mu = Profile::Expression(Expression::parse("0.3 + 0.1*x")?);
    /// let friction = Friction::varying([("along.mu", mu)], |values, alpha_t| {
    ///     Ok(Box::new(Coulomb::new(&CoulombParameters::new(values[0]), alpha_t)?))
    /// });
    /// # Ok::<(), fecontact::model::boundary::InvalidExpression>(())
    /// ```
    pub fn varying<N: Into<String>>(
        profiles: impl IntoIterator<Item = (N, Profile)>,
        law: impl Fn(&[f64], f64) -> Checked<Box<dyn FrictionLaw>> + Send + Sync + 'static,
    ) -> Self {
        let varying = profiles.into_iter().map(|(name, profile)| Named { name: name.into(), profile }).collect();
        Self {
            parameters: None,
            name: "friction".into(),
            varying,
            law: Arc::new(law),
            tie: false,
            elsewhere: Vec::new(),
        }
    }

    /// Returns the law of tied surfaces.
    pub(super) fn tie() -> Self {
        let law = Self::varying::<String>([], |_, alpha_t| Ok(Box::new(Tie { alpha_t })));
        Self { tie: true, ..law }
    }

    /// Whether it is none but that of surfaces that are tied.
    pub(super) fn is_tie(&self) -> bool {
        self.tie
    }

    /// Parameters of its law; `None` for a law from code.
    pub fn parameters(&self) -> Option<&FrictionParameters> {
        self.parameters.as_ref()
    }

    /// Adds other friction in the region where a profile is positive at the start; the first that applies is used. Messages
    /// name profile and friction by `name`, such as `along.law[0]`.
    pub fn in_region(mut self, name: &str, profile: Profile, friction: impl Into<Self>) -> Self {
        let friction = Self { name: format!("{name}.friction"), ..friction.into() };
        self.elsewhere.push(Region { positive: Named { name: format!("{name}.where"), profile }, friction });
        self
    }

    /// Returns the laws of a contact, with what it adds to them; and for each slave point the number of its law, shared
    /// by points with the same values.
    pub(super) fn laws(
        &self,
        place: &str,
        points: &mut [SlavePoint],
        mesh: &Mesh,
        default: Option<DefaultAlphaT>,
        additions: Additions,
    ) -> Checked<Laws> {
        for Region { positive: Named { name, profile }, .. } in &self.elsewhere {
            check_profile(profile, &format!("{place}.{name}"))?;
        }
        let all = || std::iter::once(self).chain(self.elsewhere.iter().map(|region| &region.friction));
        for Named { name, profile } in all().flat_map(|friction| &friction.varying) {
            check_in_time(profile, &format!("{place}.{name}"))?;
        }
        let (mut laws, mut varying, mut truncated) = (Vec::new(), Vec::new(), BTreeMap::new());
        let mut numbers: BTreeMap<(usize, Vec<u64>), usize> = BTreeMap::new();
        for point in points {
            let at = position(point, mesh);
            let mut chosen = (0, self);
            for (k, Region { positive, friction }) in self.elsewhere.iter().enumerate().rev() {
                if positive.value(at, place)? > 0.0 {
                    chosen = (k + 1, friction);
                }
            }
            let (number, friction) = chosen;
            let values = friction.varying.iter().map(|named| named.value(at, place));
            let drawn = values.collect::<Checked<Vec<_>>>()?;
            let values = friction.in_range(&drawn, default.map(|default| default.of_law), additions);
            for (named, _) in friction.varying.iter().zip(drawn.iter().zip(&values)).filter(|(_, (was, is))| was != is)
            {
                *truncated.entry(named.name.clone()).or_default() += 1;
            }
            // If a parameter varies in place and time, only points at the same place share a law.
            let place_of = [at.x, at.y].into_iter().filter(|_| friction.varies_in_place_and_time());
            let key = (number, values.iter().copied().chain(place_of).map(f64::to_bits).collect());
            if let Some(&law) = numbers.get(&key) {
                point.law = law;
                continue;
            }
            point.law = laws.len();
            numbers.insert(key, laws.len());
            let first = friction.varying.first();
            let first = first.map(|Named { name, .. }| format!("{place}.{name} at ({}, {})", at.x, at.y));
            let default_alpha_t = default.map(|default| default.of(|alpha_t| (friction.law)(&values, alpha_t)));
            let law = friction.law(&values, default_alpha_t, place, first)?;
            let law = additions.of(law).map_err(|InvalidParameter { name, value, allowed }| {
                ModelError::new(format!("{place}.{name}"), format!("is {value}: {allowed}"))
            })?;
            varying.push(friction.in_time(at, &values, default_alpha_t, additions));
            laws.push(Arc::new(law));
        }
        let varies = all().flat_map(|friction| &friction.varying).any(|named| named.profile.depends_on_time());
        let during = move |law: usize, span| varying[law].during(span);
        let in_time = varies.then(|| LawsInTime::new(laws.len(), during));
        Ok(Laws { at_start: laws, in_time, truncated })
    }

    /// Returns the values with those of random fields truncated to the range of the law: where the law does not take them, the
    /// nearest ones that it takes, one after another from the means of all, because the range of one may depend on others.
    fn in_range(&self, drawn: &[f64], alpha_t: Option<f64>, additions: Additions) -> Vec<f64> {
        let fits = |values: &[f64]| {
            let law = (self.law)(values, alpha_t.unwrap_or(1.0));
            law.is_ok_and(|law| additions.of(law).is_ok())
        };
        let mean = |named: &Named| match &named.profile {
            Profile::Random(field) => Some(field.mean),
            _ => None,
        };
        let means: Vec<Option<f64>> = self.varying.iter().map(mean).collect();
        let mut values: Vec<f64> = means.iter().zip(drawn).map(|(mean, drawn)| mean.unwrap_or(*drawn)).collect();
        // What the law does not take at the means is an error, which names the values.
        if means.iter().all(Option::is_none) || fits(drawn) || !fits(&values) {
            return drawn.to_vec();
        }
        for (k, mean) in means.iter().enumerate() {
            let Some(mean) = *mean else { continue };
            values[k] = nearest(mean, drawn[k], |value| {
                let mut tried = values.clone();
                tried[k] = value;
                fits(&tried)
            });
        }
        values
    }

    fn varies_in_place_and_time(&self) -> bool {
        let of_both = |profile: &Profile| match profile {
            Profile::Expression(expression) => expression.depends_on_time() && expression.depends_on_position(),
            Profile::Constant(_) | Profile::X(_) | Profile::Y(_) | Profile::Table(_) | Profile::Random(_) => false,
        };
        self.varying.iter().any(|named| of_both(&named.profile))
    }

    /// Returns the time-dependent law at a place, where its parameters have these values at the start.
    fn in_time(&self, at: Vector2<f64>, values: &[f64], alpha_t: Option<f64>, additions: Additions) -> InTime {
        let there = |(named, value): (&Named, &f64)| match named.profile.depends_on_time() {
            true => named.profile.clone(),
            false => Profile::Constant(*value),
        };
        InTime {
            profiles: self.varying.iter().zip(values).map(there).collect(),
            at,
            law: self.law.clone(),
            alpha_t: alpha_t.unwrap_or(f64::NAN),
            additions,
        }
    }

    fn law(
        &self,
        values: &[f64],
        default_alpha_t: Option<f64>,
        contact: &str,
        place: Option<String>,
    ) -> Checked<Box<dyn FrictionLaw>> {
        // NaN stands for no default: a law that is valid with another number lacks its own.
        let law = (self.law)(values, default_alpha_t.unwrap_or(f64::NAN));
        let lacks = law.is_err() && default_alpha_t.is_none() && (self.law)(values, 1.0).is_ok();
        let own = format!("{contact}.{}", self.name);
        refuse_if(
            lacks,
            format!("{own}.alpha_t"),
            "is missing: a slave group of points has no default for it; half of alpha_n is a good choice",
        )?;
        let place = place.unwrap_or(own);
        let named = |law: Box<dyn FrictionLaw>| {
            observables::check_names(&law.description()).map_err(|error| ModelError::new("", error)).map(|()| law)
        };
        law.and_then(named).map_err(|error| if error.place.is_empty() { ModelError { place, ..error } } else { error })
    }
}

/// α_t of the laws of a contact that give none.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
pub struct DefaultAlphaT {
    /// where it is a penalty [F/L³]
    pub penalty: f64,
    /// where the elastic slip is a part of the law [F/L³]
    pub of_law: f64,
}

impl DefaultAlphaT {
    /// Returns that of a law, from what makes the law with some α_t.
    pub fn of<E>(self, law: impl FnOnce(f64) -> Result<Box<dyn FrictionLaw>, E>) -> f64 {
        match law(self.penalty) {
            Ok(law) if law.description().stiffness_is_penalty => self.penalty,
            _ => self.of_law,
        }
    }
}

/// Laws of a contact.
pub(super) struct Laws {
    /// Those at the start of the run
    pub at_start: Vec<Arc<ContactLaw>>,
    /// Those in time, if any varies
    pub in_time: Option<LawsInTime>,
    /// Number of points at which a random parameter is truncated, by its name within the contact
    pub truncated: BTreeMap<String, usize>,
}

/// Halvings that find the end of a range to round-off.
const HALVINGS: usize = 60;

/// A parameter that has to be positive is truncated at this fraction of its mean.
const LEAST: f64 = 0.01;

/// The value nearest to `value` that fits, on the way to it from `mean`, which fits.
fn nearest(mean: f64, value: f64, fits: impl Fn(f64) -> bool) -> f64 {
    if fits(value) {
        return value;
    }
    let (mut end, mut beyond) = (mean, value);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (end + beyond);
        *(if fits(middle) { &mut end } else { &mut beyond }) = middle;
    }
    match end.abs() < LEAST * mean.abs() {
        true if fits(0.0) => 0.0,
        true => LEAST * mean,
        false => end,
    }
}

impl From<FrictionParameters> for Friction {
    fn from(parameters: FrictionParameters) -> Self {
        let law = parameters.clone();
        Self { parameters: Some(parameters), ..Self::varying::<String>([], move |_, alpha_t| Ok(law.build(alpha_t)?)) }
    }
}

conversions! {
    AdhesionParameters => Friction: |law| FrictionParameters::from(law).into();
    CoulombParameters => Friction: |law| FrictionParameters::from(law).into();
    SuperSubloadingParameters => Friction: |law| FrictionParameters::from(law).into();
    SlipWeakeningParameters => Friction: |law| FrictionParameters::from(law).into();
    RateAndStateParameters => Friction: |law| FrictionParameters::from(law).into();
    PrescribedSlipParameters => Friction: |law| FrictionParameters::from(law).into();
}

impl<L: FrictionLaw + Clone + 'static> From<L> for Friction {
    fn from(law: L) -> Self {
        Self::varying::<String>([], move |_, _| Ok(Box::new(law.clone())))
    }
}

impl Debug for Friction {
    fn fmt(&self, f: &mut Formatter) -> std::fmt::Result {
        f.debug_struct("Friction").field("parameters", &self.parameters).finish_non_exhaustive()
    }
}

/// Parameters of the initial state of a point, and the stiffness of its stored energy.
const OF_THE_START: [&str; 4] = ["alpha_t", "structure", "theta", "theta_2"];

/// Reference position of a slave point.
pub fn position(point: &SlavePoint, mesh: &Mesh) -> Vector2<f64> {
    point.position.iter().map(|&(node, w)| mesh.nodes[node] * w).sum()
}

/// Returns the value of a profile, which must be finite.
pub fn defined(profile: &Profile, at: Vector2<f64>, place: &str) -> Checked<f64> {
    let value = profile.value(at);
    match value.is_finite() {
        true => Ok(value),
        false => Err(ModelError::new(place, format!("is not a finite number at ({}, {})", at.x, at.y))),
    }
}

/// Checks that a profile does not depend on time, and that the coordinates of a table ascend.
pub fn check_profile(profile: &Profile, place: &str) -> Checked<()> {
    refuse_if(profile.depends_on_time(), place, "the time t has no meaning here: the variables are x and y")?;
    check_in_time(profile, place)
}

/// Checks that the coordinates of a table ascend, that the numbers of a random field are in range, and that a parameter of the
/// initial state does not depend on time.
pub fn check_in_time(profile: &Profile, place: &str) -> Checked<()> {
    let parameter = place.rsplit('.').next().unwrap_or_default();
    let message = format!("{parameter} is constant in time at each point: the variables are x and y, and not t");
    refuse_if(profile.depends_on_time() && OF_THE_START.contains(&parameter), place, message)?;
    let (name, table) = match profile {
        Profile::Constant(_) | Profile::Expression(_) => return Ok(()),
        Profile::Random(field) => {
            let named = |error: InvalidField| ModelError::new(format!("{place}.random.{}", error.key), error);
            return field.check().map_err(named);
        }
        Profile::X(table) => ("x", table),
        Profile::Y(table) => ("y", table),
        Profile::Table(table) => {
            return check_table(table, "time").map_err(|error| ModelError::new(format!("{place}.table"), error));
        }
    };
    check_table(table, name).map_err(|error| ModelError::new(format!("{place}.{name}"), error))
}

/// Number of quadrature points for the mean of a rate over an increment: exact for polynomials of fifth order.
const MEAN: usize = 3;

/// Law of a point, from its varying parameters and the default α_t.
type LawAt = dyn Fn(&[f64], f64) -> Checked<Box<dyn FrictionLaw>> + Send + Sync;

/// Law of a point with time-dependent parameters.
struct InTime {
    profiles: Vec<Profile>,
    at: Vector2<f64>,
    law: Arc<LawAt>,
    /// Default α_t [F/L³]
    alpha_t: f64,
    /// What its contact adds
    additions: Additions,
}

impl InTime {
    /// Returns the law with its parameters at a time, or with their mean over a time span.
    fn during(&self, [from, to]: [f64; 2]) -> Result<ContactLaw, LawFailure> {
        if to <= from {
            return self.of(&[(to, 1.0)], to);
        }
        let times = gauss(MEAN).into_iter().map(|(xi, w)| (from + 0.5 * (1.0 + xi) * (to - from), 0.5 * w));
        self.of(&times.collect::<Vec<_>>(), to)
    }

    /// Returns the law with the weighted mean of the parameters at some times, up to `time`.
    fn of(&self, times: &[(f64, f64)], time: f64) -> Result<ContactLaw, LawFailure> {
        let mean = |profile: &Profile| times.iter().map(|&(time, w)| w * profile.value_at(self.at, time)).sum();
        let values: Vec<f64> = self.profiles.iter().map(mean).collect();
        let law = if values.iter().all(|value: &f64| value.is_finite()) {
            (self.law)(&values, self.alpha_t).ok()
        } else {
            None
        };
        let law = law.ok_or(LawFailure::Undefined { time })?;
        if let Some(Beyond { key, rate, least }) = self.additions.offsets.beyond(&law.description()) {
            return Err(LawFailure::Dilates { time, key, rate, least });
        }
        self.additions.of(law).map_err(|_| LawFailure::Undefined { time })
    }
}

/// Friction parameters that vary along the slave and in time: expressions may depend on x, y and the run time t.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
#[non_exhaustive]
pub struct Along {
    /// Other laws than `friction` on parts of the slave; where several apply, the first one is used
    #[schemars(default)]
    pub law: Vec<LawChoice>,
    /// Parameters of `friction`, by name: they replace the numbers given there. A rate is averaged over an increment,
    /// any other parameter takes its value at the end. Those of the start (structure, theta) and alpha_t do not vary in time
    #[serde(flatten)]
    pub parameters: BTreeMap<String, Profile>,
}

impl Along {
    /// Whether nothing varies.
    pub fn is_empty(&self) -> bool {
        self.law.is_empty() && self.parameters.is_empty()
    }
}

setters! { along: Along;
    /// Adds a parameter that varies.
    parameter(name: impl Into<String>, profile: impl Into<Profile>) {
        along.parameters.insert(name.into(), profile.into());
    }

    /// Adds another law on a part of the slave.
    law(law: LawChoice) { along.law.push(law); }
}

/// A law on a part of the slave.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct LawChoice {
    /// The law applies where this expression is positive
    #[serde(rename = "where")]
    pub place: Profile,
    /// Friction law
    pub friction: FrictionParameters,
    /// Parameters that vary along the slave and in time, by name
    #[serde(default)]
    pub along: BTreeMap<String, Profile>,
}

impl LawChoice {
    /// Creates the choice of a law where a profile is positive.
    pub fn new(place: impl Into<Profile>, friction: impl Into<FrictionParameters>) -> Self {
        Self { place: place.into(), friction: friction.into(), along: BTreeMap::new() }
    }
}

setters! { choice: LawChoice;
    /// Adds a parameter that varies.
    parameter(name: impl Into<String>, profile: impl Into<Profile>) {
        choice.along.insert(name.into(), profile.into());
    }
}

impl<'de> Deserialize<'de> for Along {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Entries)
    }
}

/// Reads entry by entry, so that an error is reported with its place.
struct Entries;

impl<'de> Visitor<'de> for Entries {
    type Value = Along;

    fn expecting(&self, formatter: &mut Formatter) -> std::fmt::Result {
        formatter.write_str("parameters of the friction law by name")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Along, A::Error> {
        let mut along = Along::default();
        while let Some(name) = entries.next_key::<String>()? {
            match name.as_str() {
                "law" => along.law = entries.next_value()?,
                _ => drop(along.parameters.insert(name, entries.next_value()?)),
            }
        }
        Ok(along)
    }
}

/// Friction is written as the parameters of its law; a law from code cannot be written.
impl Serialize for Friction {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let lacks = || S::Error::custom("a friction law from code cannot be written as a case: give it by parameters");
        self.parameters().ok_or_else(lacks)?.serialize(serializer)
    }
}

/// Returns the laws with their varying parameters replaced, including an initial structure.
pub fn friction(given: &Friction, along: &Along, structure: Option<&Profile>, place: &str) -> Checked<Friction> {
    let Some(parameters) = given.parameters() else {
        let message = "is a law from code, of which no parameter is known by name: let it vary by Friction::varying";
        let fails = !along.is_empty() || structure.is_some();
        return refuse_if(fails, format!("{place}.friction"), message).map(|()| given.clone());
    };
    let mut varying = profiles(&along.parameters, "along");
    if let Some(structure) = structure {
        let place = format!("{place}.initial.structure");
        refuse_if(!parameters.has_structure(), &place, "this friction law has no structure: leave it out")?;
        let message = "is given by `along` already: leave one of them out";
        refuse_if(along.parameters.contains_key("structure"), place, message)?;
        let named = Named { name: "initial.structure".into(), profile: structure.clone() };
        varying.push(Varying { parameter: "structure".into(), named });
    }
    let mut friction = with_varying(parameters.clone(), varying, place, "friction")?;
    for (k, LawChoice { place: positive, friction: law, along }) in along.law.iter().enumerate() {
        let name = format!("along.law[{k}]");
        let varying = profiles(along, &format!("{name}.along"));
        let other = with_varying(law.clone(), varying, place, &format!("{name}.friction"))?;
        friction = friction.in_region(&name, positive.clone(), other);
    }
    Ok(friction)
}

/// A parameter that varies.
struct Varying {
    parameter: String,
    named: Named,
}

fn profiles(along: &BTreeMap<String, Profile>, within: &str) -> Vec<Varying> {
    let varying = |(parameter, profile): (&String, &Profile)| {
        let named = Named { name: format!("{within}.{parameter}"), profile: profile.clone() };
        Varying { parameter: parameter.clone(), named }
    };
    along.iter().map(varying).collect()
}

/// Returns a law with varying parameters; its place in the contact is `own`.
fn with_varying(parameters: FrictionParameters, varying: Vec<Varying>, place: &str, own: &str) -> Checked<Friction> {
    if let Some(message) = parameters.unknown() {
        return Err(ModelError::new(format!("{place}.{own}.name"), message));
    }
    if varying.is_empty() {
        return Ok(parameters.into());
    }
    // The replaced numbers must be valid as well; any α_t serves for the check.
    parameters.build(1.0).map_err(|error| ModelError::new(format!("{place}.{own}"), error))?;
    let profiles: Vec<(String, Profile)> =
        varying.iter().map(|Varying { named, .. }| (named.name.clone(), named.profile.clone())).collect();
    let place = place.to_owned();
    Ok(Friction::varying(profiles, move |values, alpha_t| {
        let mut parameters = parameters.clone();
        for (Varying { parameter, named }, &value) in varying.iter().zip(values) {
            parameters = parameters.with(parameter, value).map_err(|UnknownParameter { name, known }| {
                let known: Vec<&str> = known.iter().map(String::as_str).collect();
                ModelError::new(format!("{place}.{}", named.name), not_known(&name, &known))
            })?;
        }
        Ok(parameters.build(alpha_t)?)
    }))
}
