//! Input of a law test, and its conversion to the test that is run.

use std::collections::BTreeMap;
use std::path::Path;

use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Value;

use super::error::CaseError;
use super::schema::schema_of;
use super::units;
use crate::laws::friction::{
    BondParameters, BondSurfaces, Cohesion, Confinement, ContactLaw, Dilatancy, FrictionLaw, FrictionParameters,
    FrictionState, Offsets, observables,
};
use crate::laws::parameter::InvalidParameter;
use crate::mesh::section::Section;
use crate::model::boundary::{Drive, Span};
use crate::model::builder::{Checked, ModelError, check_line, check_positive, refuse_if};
use crate::run::law::{LawTest, OF_MACHINE, PathDrive, Phase, Slider, Undefined};

/// A test of a friction law alone: the law, and the path of slip and pressure along which it is driven.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LawTestInput {
    /// Title of the test, in one line
    #[serde(default)]
    pub title: String,
    /// Labels of the units used, for the page: `length`, `force`, `time`, `stress`; any consistent set will do. `stress` may be left
    /// out, and is refused where it contradicts
    #[serde(default)]
    pub units: BTreeMap<String, String>,
    /// Friction law, with its alpha_t
    pub friction: FrictionParameters,
    /// Dilatancy: opening by plastic slip, as of a contact
    pub dilatancy: Option<Dilatancy>,
    /// k of Archard's law, as of a contact [L²/F]
    pub wear: Option<f64>,
    /// Bond in parallel with friction, as of a contact, with its `opening`; pressure, traction and dissipation of the results include it. Its stiffness
    /// is alpha_t, without friction half of `normal.alpha_n`
    pub bond: Option<BondParameters>,
    /// How the pressure answers to the opening of the interface by dilatancy and wear; constant normal load by default
    #[serde(default)]
    pub normal: ConfinementInput,
    /// Machine that pulls a mass with the law by its spring: the slip of the path is the way of its load point. Friction alone acts on the
    /// mass, without a `bond`
    pub slider: Option<Slider>,
    /// Parameters of the law, and of a slider `stiffness` and `mass`, by which the traction is differentiated, of a slider the force: a column
    /// `dtraction_d…` or `dforce_d…` each, of the computed values at fixed steps; not with `normal`
    #[serde(default)]
    pub by: Vec<String>,
    /// State at the start
    #[serde(default)]
    pub initial: StartInput,
    /// Longest step [T]; default: a hundredth of each phase, or the rows of the table
    pub dt: Option<f64>,
    /// Phases, one after the other; either this or a table
    pub path: Option<Vec<PhaseInput>>,
    /// Rows [time, slip, pressure] with increasing times, interpolated linearly; either this or a path
    pub table: Option<Vec<[f64; 3]>>,
    /// Opening of the surfaces at the rows of the table, under which a `bond` acts, as in the phases of a path; default: 0 [L]
    pub opening: Option<Vec<f64>>,
}

/// State at the start; the structure variable is given with the law.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StartInput {
    /// q: traction, within ±μ p [F/L²]
    #[serde(default)]
    pub traction: f64,
    /// p: pressure [F/L²]; default: that of the path at its start
    pub pressure: Option<f64>,
}

/// How the pressure answers to the opening of the interface: p = p_a + K_n g with the pressure p_a of the path and the opening
/// g = d − (p − p₀)/α_n since the start, d being that by dilatancy and wear.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ConfinementInput {
    /// K_n: normal stiffness of what surrounds the interface, such as 4 G/D for a shaft of diameter D in soil of the shear
    /// modulus G; 0, constant normal load, by default [F/L³]
    pub stiffness: Option<f64>,
    /// Whether the volume is constant, g = 0, as for K_n → ∞: p = p₀ + α_n d under a constant pressure of the path
    #[serde(default)]
    pub constant_volume: bool,
    /// α_n: normal stiffness of the interface itself; rigid by default, which constant volume does not allow [F/L³]
    pub alpha_n: Option<f64>,
}

/// A phase of the path.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PhaseInput {
    /// Length of the phase [T]
    pub duration: f64,
    /// Total slip [L]: a number (reached at the end), an expression in the time t, {"rate": v} or {"table": [[t, v],
    /// …]}; constant by default
    pub slip: Option<Drive>,
    /// Applied pressure [F/L²], in the same forms; at or below 0 the surfaces are open; constant by default
    pub pressure: Option<Drive>,
    /// Opening of the surfaces under which a `bond` acts [L], in the same forms; where it is positive friction has no pressure. 0 at the
    /// start, then constant by default
    pub opening: Option<Drive>,
    /// Longest step in this phase [T]; default: that of the test
    pub dt: Option<f64>,
}

/// Number of steps of a phase without `dt`.
const STEPS: f64 = 100.0;

/// Number of steps above which a phase is refused as a typing error: each is a row of the table.
const MOST_STEPS: f64 = 1e7;

/// Shortest step relative to the time at the end of its phase, below which round-off would dominate.
const SHORTEST_STEP: f64 = 16.0 * f64::EPSILON;

/// Relative difference below which values are equal.
const SAME: f64 = 1e-9;

/// Fraction by which an initial traction may exceed the strength: numbers are written with a few digits.
const WRITTEN: f64 = 1e-6;

/// Returns the JSON Schema of a law test.
pub fn schema() -> Value {
    schema_of::<LawTestInput>("law")
}

/// Reads a law test.
///
/// # Errors
/// Returns [`CaseError`] if the file cannot be read or is not a test.
pub fn read(path: &Path) -> Result<LawTestInput, CaseError> {
    super::read::read(path)
}

/// Reads a law test from its text; `path` is used in messages.
///
/// # Errors
/// The same as for [`read`].
pub fn from_text(text: &str, path: &Path) -> Result<LawTestInput, CaseError> {
    super::read::read_text(text, path)
}

/// Checks a test and prepares it. `path` is its file.
///
/// # Errors
/// Returns [`CaseError`] with file, key, value and remedy if the test is invalid.
pub fn build(input: &LawTestInput, path: &Path) -> Result<LawTest, CaseError> {
    test(input).and_then(|test| differentiated(input, test)).map_err(|complaint| complaint.in_file(path))
}

fn check_slider(&Slider { stiffness, mass, tolerance, .. }: &Slider, bonded: bool) -> Checked<()> {
    for (key, value) in [("stiffness", stiffness), ("mass", mass), ("tolerance", tolerance)] {
        check_positive(&format!("slider.{key}"), value, "")?;
    }
    refuse_if(bonded, "bond", "is for a given slip, and a slider has friction alone: leave one of them out")
}

/// A test with its derivatives.
fn differentiated(input: &LawTestInput, test: LawTest) -> Checked<LawTest> {
    let known = sensitivities(&test.law, input.slider.is_some());
    for (k, name) in input.by.iter().enumerate() {
        let all = if known.is_empty() { "nothing".into() } else { known.join(", ") };
        let message = format!("there is no derivative of the law by {name}; there are derivatives by {all}");
        refuse_if(!known.contains(&name.as_str()), format!("by[{k}]"), message)?;
        refuse_if(input.by[..k].contains(name), format!("by[{k}]"), format!("is {name} once more: leave it out"))?;
    }
    let message = "the traction is differentiated at given pressures: leave out `normal`";
    refuse_if(!input.by.is_empty() && test.confinement != Confinement::default(), "by", message)?;
    Ok(LawTest { slider: input.slider, by: input.by.clone(), ..test })
}

/// Parameters by which a test can be differentiated.
pub fn sensitivities(law: &ContactLaw, slides: bool) -> Vec<&'static str> {
    let known = law.law.sensitivities().filter(|_| !matches!(law.cohesion, Some(Cohesion::Parallel(_))));
    let of_machine = OF_MACHINE.into_iter().filter(|_| slides);
    known.map_or(Vec::new(), |known| known.parameters().iter().copied().chain(of_machine).collect())
}

fn test(input: &LawTestInput) -> Checked<LawTest> {
    check_line("title", &input.title)?;
    units::check(&input.units, Section::PlaneStrain)?;
    input.slider.as_ref().map_or(Ok(()), |slider| check_slider(slider, input.bond.is_some()))?;
    let law = law(&input.friction)?;
    let confinement = confinement(&input.normal)?;
    let path = match (&input.path, &input.table) {
        (Some(phases), None) => {
            refuse_if(
                input.opening.is_some(),
                "opening",
                "belongs to the rows of a table: give each phase its own \
                `opening`",
            )?;
            phases_of(input, phases)?
        }
        (None, Some(table)) => vec![table_of(input, table)?],
        _ => return Err(ModelError::new("", "must give either \"path\", a list of phases, or \"table\"")),
    };
    // Beside a bond the traction at the start is shared later.
    let traction = if input.bond.is_some() { 0.0 } else { input.initial.traction };
    let start = start(input, law.as_ref(), [path[0].pressure(path[0].start()), traction])?;
    if input.normal.constant_volume {
        check_constant(&path)?;
    }
    let offsets = Offsets { dilatancy: input.dilatancy, wear: input.wear };
    let refused = |InvalidParameter { name, value, allowed }| ModelError::new(name, format!("is {value}: {allowed}"));
    let law = ContactLaw::with_offsets(law, offsets).map_err(refused)?;
    let of_friction = law.description.starting_limit(start.pressure);
    let Some(bond) = &input.bond else {
        let opens = input.path.iter().flatten().position(|phase| phase.opening.is_some());
        let place = opens.map_or("opening".into(), |k| format!("path[{k}].opening"));
        let message = "belongs to a `bond` in addition to friction, and there is none: leave it out";
        refuse_if(opens.is_some() || input.opening.is_some(), place, message)?;
        return Ok(LawTest { start, confinement, ..LawTest::of(law, path) });
    };
    let law = bonded(law, bond, input)?;
    let of_bond = law.share_of_bond(start.pressure, input.initial.traction);
    let message = format!(
        "is {of_bond} for the bond and {} for friction: it exceeds their strength",
        input.initial.traction - of_bond
    );
    refuse_if((input.initial.traction - of_bond).abs() > of_friction * (1.0 + WRITTEN), "initial.traction", message)?;
    let start = law.law.initial_state(start.pressure, input.initial.traction - of_bond);
    Ok(LawTest { start, of_bond, confinement, ..LawTest::of(law, path) })
}

/// A law with a bond in parallel with it.
fn bonded(law: ContactLaw, bond: &BondParameters, input: &LawTestInput) -> Checked<ContactLaw> {
    let message = "is given by the friction law already: leave one of them out";
    refuse_if(law.law.cohesion() > 0.0, "bond.strength", message)?;
    refuse_if(
        bond.strength.is_none(),
        "bond.strength",
        "is missing: the friction law has no strength without pressure",
    )?;
    refuse_if(bond.opening.is_none(), "bond.opening", "is missing: a law alone has no mesh to choose it from")?;
    let alpha_n = input.normal.alpha_n;
    let message = "is missing: half of it is the stiffness of a bond in parallel with a law without alpha_t";
    refuse_if(law.stiffness == 0.0 && alpha_n.is_none(), "normal.alpha_n", message)?;
    let moves = input.dilatancy.is_some()
        || input.wear.is_some()
        || input.normal.stiffness.is_some()
        || input.normal.constant_volume;
    refuse_if(
        moves,
        "bond",
        "follows the opening given by the path, not one caused by dilatancy, wear or a normal stiffness: leave one of \
        them out",
    )?;
    let surfaces = BondSurfaces::new(alpha_n.unwrap_or(f64::INFINITY), f64::NAN, 0.0);
    law.bonded(bond, surfaces)
        .map_err(|InvalidParameter { name, value, allowed }| ModelError::new(name, format!("is {value}: {allowed}")))
}

fn confinement(ConfinementInput { stiffness, constant_volume, alpha_n }: &ConfinementInput) -> Checked<Confinement> {
    let given = |key: &str, value: &Option<f64>| {
        value.map_or(Ok(()), |value| check_positive(&format!("normal.{key}"), value, ""))
    };
    given("stiffness", stiffness)?;
    given("alpha_n", alpha_n)?;
    if *constant_volume {
        refuse_if(
            stiffness.is_some(),
            "normal.stiffness",
            "is infinite where the volume is constant: leave one of them out",
        )?;
        let message = "is missing: between rigid surfaces no slip could dilate at constant volume";
        refuse_if(alpha_n.is_none(), "normal.alpha_n", message)?;
    }
    let stiffness = if *constant_volume { f64::INFINITY } else { stiffness.unwrap_or_default() };
    Ok(Confinement { stiffness, alpha_n: alpha_n.unwrap_or(f64::INFINITY) })
}

/// At constant volume no pressure can be applied from outside.
fn check_constant(path: &[Phase]) -> Checked<()> {
    let first = path[0].pressure(path[0].start());
    let changed = |phase: &Phase| phase.times().map(|time| [time, phase.pressure(time)]).find(|[_, p]| *p != first);
    let Some([time, pressure]) = path.iter().find_map(changed) else { return Ok(()) };
    let message = format!("is {pressure} at t = {time} and was {first}: at constant volume it cannot be applied");
    Err(ModelError::new("pressure", message))
}

fn law(parameters: &FrictionParameters) -> Checked<Box<dyn FrictionLaw>> {
    if let Some(message) = parameters.unknown() {
        return Err(ModelError::new("friction.name", message));
    }
    // Without a mesh there is no default stiffness: NaN stands for none.
    let law = parameters.build(f64::NAN).map_err(|error| match error.name {
        "alpha_t" if error.value.is_nan() => {
            ModelError::new("friction", "the key `alpha_t` is missing here: a law alone has no mesh to choose it from")
        }
        _ => ModelError::new("friction", error),
    })?;
    observables::check_names(&law.description()).map_err(|error| ModelError::new("friction", error))?;
    Ok(law.controlled().unwrap_or(law))
}

fn start(input: &LawTestInput, law: &dyn FrictionLaw, [pressure, traction]: [f64; 2]) -> Checked<FrictionState> {
    if let Some(negative) = input.initial.pressure.filter(|pressure| *pressure < 0.0) {
        return Err(ModelError::new("initial.pressure", format!("is {negative}: must be zero or positive")));
    }
    let at_rest = law.initial_state(0.0, 0.0);
    let pressure = pressure.max(0.0);
    let strength = law.description().starting_limit(pressure);
    let message = format!(
        "is {traction}, above the initial strength mu p = {} · {pressure} = {strength}: lower it, or raise the \
         pressure or the structure",
        observables::value(law, "mu", &at_rest)
    );
    refuse_if(traction.abs() > strength * (1.0 + WRITTEN), "initial.traction", message)?;
    Ok(law.initial_state(pressure, traction))
}

fn phases_of(input: &LawTestInput, phases: &[PhaseInput]) -> Checked<Vec<Phase>> {
    let mut path: Vec<Phase> = Vec::with_capacity(phases.len());
    for (k, phase) in phases.iter().enumerate() {
        path.push(phase_of(input, &format!("path[{k}]"), phase, path.last())?);
    }
    match path.is_empty() {
        true => Err(ModelError::new("path", "is empty: give at least one phase")),
        false => Ok(path),
    }
}

fn phase_of(input: &LawTestInput, place: &str, phase: &PhaseInput, before: Option<&Phase>) -> Checked<Phase> {
    check_positive(&format!("{place}.duration"), phase.duration, "")?;
    let start = before.map_or(0.0, Phase::end);
    let span = Span { start, end: start + phase.duration };
    let (dt_place, dt) = match phase.dt {
        Some(dt) => (format!("{place}.dt"), dt),
        None => ("dt".into(), input.dt.unwrap_or(phase.duration / STEPS)),
    };
    check_dt(&dt_place, dt, span)?;

    let opened = before.map_or(0.0, |before| before.opening(start));
    let reached = before.map(|before| [before.slip(start), before.pressure(start)]);
    let (slip_place, pressure_place) = (format!("{place}.slip"), format!("{place}.pressure"));
    let slip = drive(&slip_place, phase.slip.as_ref(), reached.map_or(Some(0.0), |[slip, _]| Some(slip)))?;
    if let Some([reached, _]) = reached {
        check_continuous(&slip_place, &slip, reached, span)?;
    }
    let reached = reached.map_or(input.initial.pressure, |[_, pressure]| Some(pressure));
    let pressure = drive(&pressure_place, phase.pressure.as_ref(), reached)?;
    if let Some(reached) = reached {
        check_continuous(&pressure_place, &pressure, reached, span)?;
    }
    let opening_place = format!("{place}.opening");
    let opening = drive(&opening_place, phase.opening.as_ref(), Some(opened))?;
    check_continuous(&opening_place, &opening, opened, span)?;
    Phase::opened(span, [slip, pressure, opening], dt).map_err(|Undefined { quantity, time }| {
        let message = format!("is not a finite number at the time {time}: check the expression");
        ModelError::new(format!("{place}.{quantity}"), message)
    })
}

/// Time function of a quantity in a phase, starting from the value `reached`, if that is known.
fn drive(place: &str, given: Option<&Drive>, reached: Option<f64>) -> Checked<PathDrive> {
    let complain = |message: &str| Err(ModelError::new(place, message));
    let Some(given) = given else {
        return match reached {
            Some(value) => Ok(PathDrive { drive: Drive::Constant(value), start: value }),
            None => complain("is missing: give it here, or as initial.pressure"),
        };
    };
    let drive = given.clone();
    drive.check().map_err(|message| ModelError::new(place, message))?;
    match (&drive, reached) {
        (given, _) if given.depends_on_position() => {
            complain("x and y have no meaning here: the only variable is the time t")
        }
        (Drive::Rate(_), None) => complain("a rate needs a value to start from: give initial.pressure"),
        // Without a previous value, the quantity is constant from the start.
        (Drive::Constant(value), None) => Ok(PathDrive { start: *value, drive }),
        _ => Ok(PathDrive { drive, start: reached.unwrap_or(0.0) }),
    }
}

fn check_continuous(place: &str, drive: &PathDrive, reached: f64, span: Span) -> Checked<()> {
    let first = drive.value(span.start, span);
    // Non-finite values are reported later.
    let message = format!("jumps from {reached} to {first} at t = {}: start from the value reached", span.start);
    refuse_if((first - reached).abs() > SAME * first.abs().max(reached.abs()).max(f64::MIN_POSITIVE), place, message)?;
    Ok(())
}

fn table_of(input: &LawTestInput, table: &[[f64; 3]]) -> Checked<Phase> {
    let [[start, _, pressure], .., [end, _, _]] = table else {
        return Err(ModelError::new("table", "must have two rows [time, slip, pressure] or more"));
    };
    if let Some(pair) = table.windows(2).find(|pair| pair[1][0] <= pair[0][0]) {
        let message = format!("the times must increase: {} follows {}", pair[1][0], pair[0][0]);
        return Err(ModelError::new("table", message));
    }
    let span = Span { start: *start, end: *end };
    if let Some(dt) = input.dt {
        check_dt("dt", dt, span)?;
    }
    let column = |k: usize| Drive::Table(table.iter().map(|row| [row[0], row[k]]).collect());
    let [slip, pressures] = [1, 2].map(|k| PathDrive { drive: column(k), start: 0.0 });
    if let Some(given) = input.initial.pressure.filter(|given| given != pressure) {
        let message = format!("is {given}, but the table starts at {pressure}: leave it out");
        return Err(ModelError::new("initial.pressure", message));
    }
    let openings = input.opening.clone().unwrap_or_else(|| vec![0.0; table.len()]);
    let message = format!("has {} values for the {} rows of the table: give one for each", openings.len(), table.len());
    refuse_if(openings.len() != table.len(), "opening", message)?;
    let openings = table.iter().zip(openings).map(|(row, opening)| [row[0], opening]).collect();
    let opening = PathDrive { drive: Drive::Table(openings), start: 0.0 };
    let dt = input.dt.unwrap_or(f64::INFINITY);
    Phase::opened(span, [slip, pressures, opening], dt).map_err(|Undefined { quantity, time }| {
        ModelError::new("table", format!("the {quantity} is not a finite number at the time {time}"))
    })
}

fn check_dt(place: &str, dt: f64, span: Span) -> Checked<()> {
    check_positive(place, dt, "")?;
    let steps = (span.end - span.start) / dt;
    let message = format!("is {dt:e}: that makes {steps:.1e} steps in a phase, and at most {MOST_STEPS:e} are allowed");
    refuse_if(steps > MOST_STEPS, place, message)?;
    let least = SHORTEST_STEP * span.end.abs().max(span.start.abs());
    let message = format!("is {dt:e}: at the time {:e} steps below {least:.1e} are lost in round-off", span.end);
    refuse_if(dt < least, place, message)?;
    Ok(())
}
