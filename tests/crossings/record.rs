//! A run of a case, and what it left, read back into canonical axes and units.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use fecontact::case;
use fecontact::contact::{ContactPair, SlavePoint};
use fecontact::model::{Model, State, Step};
use fecontact::output::events::wave_speeds;
use fecontact::output::history::History;
use fecontact::output::newton_log::NewtonLog;
use fecontact::output::probes::Probes;
use fecontact::output::warnings::Warnings;
use fecontact::run::{Observer, RunBytes, RunReport, SavedRun, Simulation, watch};
use serde_json::Value;

use crate::frame::{Frame, Kind};
use crate::model::{ASIDE, Names, Ways};

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Ended {
    Complete,
    Stopped(String),
    Refused(String),
}

/// One number of a row: what it is, and in which column.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    pub kind: Kind,
    pub column: Arc<str>,
    pub value: f64,
}

/// What a run left.
#[derive(Clone, Debug)]
pub struct Record {
    pub ended: Ended,
    /// the tables as they are written
    pub tables: Vec<String>,
    /// rows in canonical axes and units: time, and all else
    pub rows: Vec<(f64, Vec<Entry>)>,
    /// increments, those between two rows of explicit steps included
    pub increments: usize,
    /// attempts at increments that were given up
    pub given_up: usize,
    /// what it was warned of on the way and at the end
    pub warnings: Vec<String>,
    /// whether points of the first contact closed, and slipped
    pub closed: bool,
    pub slipped: bool,
}

/// How a run is led.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lead {
    /// From its beginning to its end
    Through,
    /// Left in the middle, and taken up from its bytes
    Resumed,
    /// Every candidate dropped once, and tried again
    Dropped,
    /// The first step as a run of its own, with which another begins
    Begun,
    /// All but the last step as a run of its own, which goes on with the last
    Further,
}

/// Run a case in a folder of its own.
pub fn run(document: &Value, ways: &Ways, lead: Lead) -> Record {
    if let Some(folder) = std::env::var_os("DUMP") {
        static COUNT: std::sync::atomic::AtomicUsize = std::sync::atomic::AtomicUsize::new(0);
        let k = COUNT.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        std::fs::write(Path::new(&folder).join(format!("{k}.json")), document.to_string())
            .expect("a folder to dump cases in");
    }
    let refused = |ended| Record {
        ended,
        tables: Vec::new(),
        rows: Vec::new(),
        increments: 0,
        given_up: 0,
        warnings: Vec::new(),
        closed: false,
        slipped: false,
    };
    let model = match built(document) {
        Ok(model) => model,
        Err(message) => return refused(Ended::Refused(message)),
    };
    let folder = tempfile::tempdir().expect("a folder for results");
    let mut outputs = Outputs::create(folder.path(), &model);
    let result = match lead {
        Lead::Through => led(Simulation::new(model.clone()), &mut outputs),
        Lead::Dropped => dropped(Simulation::new(model.clone()), &mut outputs),
        Lead::Resumed => resumed(document, folder.path(), &model, &mut outputs),
        Lead::Further => further(document, folder.path(), &model, &mut outputs),
        Lead::Begun => begun(document, folder.path(), &model, &mut outputs),
    };
    let (simulation, ended) = match result {
        Ok((simulation, result)) => (simulation, result.map_or_else(Ended::Stopped, |()| Ended::Complete)),
        Err(message) => return refused(Ended::Refused(message)),
    };
    let points = simulation.state().contacts.first();
    let tables: Vec<String> = ["history.csv", "probes.csv", "newton.csv"]
        .iter()
        .filter_map(|name| std::fs::read_to_string(folder.path().join(name)).ok())
        .collect();
    let mut rows = rows(&tables, ways);
    let most = |column: &str| {
        rows.iter()
            .flat_map(|(_, row)| row)
            .filter(|entry| &*entry.column == column)
            .map(|entry| entry.value)
            .fold(0.0, f64::max)
    };
    let closed = most("c.contact_length") > 0.0;
    let slipped = points.is_some_and(|points| points.iter().any(|point| point.friction.plastic_slip != 0.0))
        || most("c.slip_fraction") > 0.0;
    if let (Some((_, last)), Ended::Complete) = (rows.last_mut(), &ended) {
        last.extend(point_entries(&simulation, ways));
        // Those behind the first edge of the slave; of a surface that is its own master several bodies are.
        let own = simulation.model().contacts.first().is_some_and(ContactPair::is_own);
        let speeds = wave_speeds(simulation.model()).into_iter().filter(|_| !own);
        last.extend(speeds.enumerate().map(|(k, speed)| Entry {
            kind: Kind::WaveSpeed,
            column: format!("wave speed {k}").into(),
            value: speed / ways.frame.unit(Kind::WaveSpeed),
        }));
    }
    let RunReport { increments, cutbacks, rejected, .. } = simulation.report();
    let [before, given_up] = outputs.before;
    let given_up = given_up + cutbacks + rejected;
    let warnings = model.warnings().into_iter().chain(outputs.warnings.list).collect();
    Record { ended, tables, closed, slipped, rows, increments: before + increments, given_up, warnings }
}

fn built(document: &Value) -> Result<Arc<Model>, String> {
    let path = Path::new("case.json");
    let case = case::from_text(&document.to_string(), path).map_err(|error| error.to_string())?;
    case::build(&case, path).map(Arc::new).map_err(|error| error.to_string())
}

/// An increment that a run has solved.
pub struct Solved {
    pub model: Arc<Model>,
    pub step: Step,
    pub old: State,
    pub new: State,
}

/// The increments of a case, up to where its run stops; none where it is refused.
pub fn increments(document: &Value) -> Vec<Solved> {
    let Ok(model) = built(document) else { return Vec::new() };
    let mut simulation = Simulation::new(model.clone());
    let mut all = Vec::new();
    while let Ok(Some(candidate)) = simulation.try_increment() {
        let attempt = simulation.attempt_of(&candidate);
        if let Some(new) = attempt.accepted {
            all.push(Solved {
                model: model.clone(),
                step: attempt.step.clone(),
                old: attempt.old.clone(),
                new: new.clone(),
            });
        }
        if simulation.apply(candidate).is_err() {
            break;
        }
    }
    all
}

/// The observers whose tables are compared.
struct Outputs {
    history: History,
    probes: Probes,
    newton: NewtonLog,
    warnings: Warnings,
    /// increments of a run that this one began with, and attempts given up in it
    before: [usize; 2],
}

impl Outputs {
    fn create(folder: &Path, model: &Model) -> Self {
        Self {
            history: History::create(folder, model).expect("history.csv"),
            probes: Probes::create(folder, model).expect("probes.csv"),
            newton: NewtonLog::create(folder, model).expect("newton.csv"),
            warnings: Warnings::default(),
            before: [0; 2],
        }
    }

    fn reopen(folder: &Path, model: &Model) -> Self {
        Self {
            history: History::reopen(folder, model).expect("history.csv"),
            probes: Probes::reopen(folder, model).expect("probes.csv"),
            newton: NewtonLog::reopen(folder, model).expect("newton.csv"),
            warnings: Warnings::default(),
            before: [0; 2],
        }
    }

    fn all(&mut self) -> [&mut dyn Observer; 4] {
        [&mut self.history, &mut self.probes, &mut self.newton, &mut self.warnings]
    }
}

type Led = (Simulation, Result<(), String>);

fn led(mut simulation: Simulation, outputs: &mut Outputs) -> Result<Led, String> {
    let result = watch(&mut simulation, &mut outputs.all());
    Ok((simulation, result.map_err(|error| error.to_string())))
}

/// Attempts that are made twice, the first time for nothing.
fn dropped(mut simulation: Simulation, outputs: &mut Outputs) -> Result<Led, String> {
    let result = loop {
        let first = simulation.try_increment();
        drop(first);
        match simulation.try_increment() {
            Ok(None) => break Ok(()),
            Err(error) => break Err(error.to_string()),
            Ok(Some(candidate)) => {
                let told = simulation.attempt_of(&candidate);
                outputs
                    .all()
                    .into_iter()
                    .try_for_each(|observer| observer.record(simulation.model(), &told))
                    .expect("tables can be written");
                if let Err(error) = simulation.apply(candidate) {
                    break Err(error.to_string());
                }
            }
        }
    };
    let finished = outputs.all().into_iter().try_for_each(|observer| observer.finish());
    Ok((simulation, result.and(finished.map_err(|error| error.to_string()))))
}

/// Some attempts; false where the run has ended.
fn attempts(simulation: &mut Simulation, outputs: &mut Outputs, number: usize) -> bool {
    for _ in 0..number {
        let Ok(Some(candidate)) = simulation.try_increment() else { return false };
        let told = simulation.attempt_of(&candidate);
        outputs
            .all()
            .into_iter()
            .try_for_each(|observer| observer.record(simulation.model(), &told))
            .expect("tables can be written");
        if simulation.apply(candidate).is_err() {
            return false;
        }
    }
    true
}

/// Left after some attempts, gone on with a little, and taken up where it was left.
fn resumed(document: &Value, folder: &Path, model: &Arc<Model>, outputs: &mut Outputs) -> Result<Led, String> {
    let mut simulation = Simulation::new(model.clone());
    attempts(&mut simulation, outputs, 5);
    let saved =
        SavedRun::new(&simulation, &mut outputs.all()).and_then(SavedRun::bytes).map_err(|error| error.to_string())?;
    let text = serde_json::to_vec(&saved).expect("bytes");
    attempts(&mut simulation, outputs, 2);
    // The energies of a run that breaks off are nobody's concern.
    outputs.all().into_iter().for_each(|observer| drop(observer.finish()));
    drop(simulation);
    let model = built(document)?;
    let saved: RunBytes = serde_json::from_slice(&text).expect("bytes");
    *outputs = Outputs::reopen(folder, &model);
    let saved = SavedRun::from_bytes(saved, &model).map_err(|error| error.to_string())?;
    let simulation = saved.resume(&model, &mut outputs.all()).map_err(|error| error.to_string())?;
    led(simulation, outputs)
}

/// All but the last step, finished, saved and taken up with one step more.
fn further(document: &Value, folder: &Path, model: &Arc<Model>, outputs: &mut Outputs) -> Result<Led, String> {
    let mut shorter = document.clone();
    shorter["steps"].as_array_mut().expect("steps").pop();
    let first = built(&shorter)?;
    *outputs = Outputs::create(folder, &first);
    // As `led`, but saved before the observers finish.
    let mut simulation = Simulation::new(first);
    while attempts(&mut simulation, outputs, 1) {}
    let saved =
        SavedRun::new(&simulation, &mut outputs.all()).and_then(SavedRun::bytes).map_err(|error| error.to_string())?;
    outputs.all().into_iter().for_each(|observer| drop(observer.finish()));
    drop(simulation);
    *outputs = Outputs::reopen(folder, model);
    let saved = SavedRun::from_bytes(saved, model).map_err(|error| error.to_string())?;
    let simulation = saved.resume(model, &mut outputs.all()).map_err(|error| error.to_string())?;
    led(simulation, outputs)
}

/// The first step as a run of its own, then the others from where it has ended.
fn begun(document: &Value, folder: &Path, model: &Arc<Model>, outputs: &mut Outputs) -> Result<Led, String> {
    let mut alone = document.clone();
    alone["steps"].as_array_mut().expect("steps").truncate(1);
    let first = built(&alone)?;
    let (first, ended) = led(Simulation::new(first), outputs)?;
    if ended.is_err() {
        return Ok((first, ended));
    }
    let saved = SavedRun::new(&first, &mut []).and_then(SavedRun::bytes).map_err(|error| error.to_string())?;
    let saved = SavedRun::from_bytes(saved, model).map_err(|error| error.to_string())?.begin();
    let RunReport { increments, cutbacks, rejected, .. } = first.report();
    *outputs = Outputs { before: [increments, cutbacks + rejected], ..Outputs::create(folder, model) };
    let simulation = saved.resume(model, &mut []).map_err(|error| error.to_string())?;
    led(simulation, outputs)
}

/// How the numbers of a column are written, by the last part of its name.
enum Form {
    /// As they are
    Scalar(Kind),
    /// With the sign of the tangent
    Signed(Kind),
    /// With the other one that follows it
    Vector(Kind),
    /// A place
    Place,
    /// Components xx, yy and xy of a tensor, found by their names
    Tensor(Kind),
    /// Not compared
    Skip,
}

fn form(column: &str, header: &[&str]) -> Form {
    let last = column.rsplit('.').next().unwrap_or(column);
    let in_probe = header
        .iter()
        .any(|other| *other == format!("{}.strain_xx", column.rsplit_once('.').map_or("", |(name, _)| name)));
    match last {
        "dt" => Form::Scalar(Kind::Time),
        // Rows are compared with those of the same time.
        "time" | "step" | "iterations" => Form::Skip,
        "kinetic"
        | "strain"
        | "contact_elastic"
        | "friction_dissipation"
        | "damping_dissipation"
        | "plastic_dissipation"
        | "external_work"
        | "energy_error"
        | "radiated"
        | "frictional_heat" => Form::Scalar(Kind::Energy),
        "injected" | "leaked" | "water" | "outflow" => Form::Scalar(Kind::Volume),
        "discharge" => Form::Scalar(Kind::Flow),
        "mass_error" | "water_error" => Form::Skip,
        "largest_fluid_pressure" | "excess_pore_pressure" => Form::Scalar(Kind::Stress),
        "largest_flow" => Form::Scalar(Kind::Flow),
        "largest_aperture" => Form::Scalar(Kind::Length),
        "normal_force" | "fluid_force" => Form::Scalar(Kind::Force),
        "tangential_force" => Form::Signed(Kind::Force),
        "slip_fraction" | "contact_length" => Form::Scalar(Kind::Share),
        "mean_slip" | "mean_elastic_slip" => Form::Signed(Kind::Length),
        "max_penetration" | "max_elastic_slip" | "mean_dilation" | "mean_wear" => Form::Scalar(Kind::Length),
        "mean_bond" => Form::Scalar(Kind::Share),
        "mean_theta" => Form::Scalar(Kind::Time),
        "mean_slipped" => Form::Signed(Kind::Length),
        "ux" | "edge_ux" => Form::Vector(Kind::Length),
        "vx" => Form::Vector(Kind::Velocity),
        "fx" | "force_x" => Form::Vector(Kind::Force),
        "momentum_x" => Form::Vector(Kind::Momentum),
        "centre_x" => Form::Place,
        "uy" | "edge_uy" | "vy" | "fy" | "force_y" | "momentum_y" | "centre_y" => Form::Skip,
        "moment" => Form::Signed(Kind::Energy),
        "angular_momentum" => Form::Signed(Kind::AngularMomentum),
        "rotation" | "angle" => Form::Signed(Kind::Number),
        "axial_start" | "axial_end" | "axial_min" | "axial_max" | "shear_max" => Form::Scalar(Kind::Force),
        "moment_max" => Form::Scalar(Kind::Energy),
        "bond_slip_max" => Form::Scalar(Kind::Length),
        "slipping" => Form::Scalar(Kind::Share),
        "frictional_power" => Form::Scalar(Kind::Power),
        "strain_xx" => Form::Tensor(Kind::Number),
        "stress_xx" => Form::Tensor(Kind::Stress),
        "strain_zz" => Form::Scalar(Kind::Number),
        "stress_zz" => Form::Scalar(Kind::Stress),
        "strain_yy" | "strain_xy" | "stress_yy" | "stress_xy" if in_probe => Form::Skip,
        _ => Form::Scalar(Kind::Number),
    }
}

/// The rows of history and probes, joined by their times, in canonical axes and units.
fn rows(tables: &[String], ways: &Ways) -> Vec<(f64, Vec<Entry>)> {
    let mut rows: Vec<(f64, Vec<Entry>)> = Vec::new();
    for (k, table) in tables.iter().take(2).enumerate() {
        let mut lines = table.lines();
        let header: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
        let columns: Vec<(Form, Arc<str>)> =
            header.iter().map(|column| (form(column, &header), own_name(column, ways).into())).collect();
        for (number, line) in lines.enumerate() {
            let values: Vec<f64> = line.split(',').map(|text| text.parse().unwrap_or(f64::NAN)).collect();
            let entries = entries(&header, &columns, &values, &ways.frame);
            if k == 0 {
                rows.push(((values[0] - ways.frame.later) / ways.frame.time, entries));
            } else if let Some((_, row)) = rows.get_mut(number) {
                row.extend(entries);
            }
        }
    }
    // What was before everything began.
    rows.retain(|(time, _)| *time > 1e-12 || ways.later == 0.0);
    rows
}

fn entries(header: &[&str], columns: &[(Form, Arc<str>)], values: &[f64], frame: &Frame) -> Vec<Entry> {
    let mut entries = Vec::with_capacity(columns.len());
    for (k, ((form, column), &value)) in columns.iter().zip(values).enumerate() {
        let unit = |kind| value / frame.unit(kind);
        let mut push = |kind, column: &str, value| entries.push(Entry { kind, column: column.into(), value });
        match form {
            Form::Scalar(kind) => push(*kind, column, unit(*kind)),
            Form::Signed(kind) => push(*kind, column, frame.sign() * unit(*kind)),
            Form::Vector(kind) => {
                let [x, y] = frame.canonical([value, values[k + 1]]).map(|x| x / frame.unit(*kind));
                push(*kind, column, x);
                push(*kind, &format!("{column}, y"), y);
            }
            Form::Place => {
                let [x, y] = frame.place([value, values[k + 1]]);
                push(Kind::Length, column, x);
                push(Kind::Length, &format!("{column}, y"), y);
            }
            Form::Tensor(kind) => {
                let name = header[k].strip_suffix("xx").unwrap_or_default();
                let of = |part: &str| {
                    header.iter().position(|other| *other == format!("{name}{part}")).map_or(f64::NAN, |at| values[at])
                };
                let tensor = frame.canonical_tensor([value, of("yy"), of("xy")]);
                for (part, value) in ["", ", yy", ", xy"].into_iter().zip(tensor) {
                    push(*kind, &format!("{column}{part}"), value / frame.unit(*kind));
                }
            }
            Form::Skip => {}
        }
    }
    entries
}

/// The column with the canonical names of bodies and contacts.
fn own_name(column: &str, ways: &Ways) -> String {
    // A node by its place, whose coordinates are others in another frame.
    if let Some((_, quantity)) = column.rsplit_once('.').filter(|_| column.starts_with("near_")) {
        return format!("near.{quantity}");
    }
    let Names { block, ground, contact, second, tie } = Names::of(ways);
    for (now, own) in [(block, "block"), (ground, "ground")] {
        let rest = column.strip_prefix(now).filter(|rest| rest.starts_with(['_', '.']));
        if let Some(rest) = rest {
            return format!("{own}{rest}");
        }
    }
    for (now, own) in [(contact, "c"), (second, "d"), (tie, "tie")] {
        if let Some(rest) = column.strip_prefix(now).filter(|rest| rest.starts_with('.')) {
            return format!("{own}{rest}");
        }
    }
    column.into()
}

/// Whether a column belongs to what stands aside.
pub fn is_aside(column: &str) -> bool {
    ASIDE.iter().any(|name| column.starts_with(name))
}

/// The fields of the contacts, point by point in the order of their canonical places.
fn point_entries(simulation: &Simulation, ways: &Ways) -> Vec<Entry> {
    let frame = &ways.frame;
    let kinds = |field: &str| match field {
        "gap" | "dilation" | "wear" => (Kind::Length, 1.0),
        "slip" | "elastic_slip" => (Kind::Length, frame.sign()),
        "slip_rate" => (Kind::Velocity, frame.sign()),
        "pressure" | "fluid_pressure" => (Kind::Stress, 1.0),
        "traction" => (Kind::Stress, frame.sign()),
        "theta" => (Kind::Time, 1.0),
        _ => (Kind::Number, 1.0),
    };
    let fields = [
        "gap",
        "pressure",
        "traction",
        "slip",
        "elastic_slip",
        "slip_rate",
        "fluid_pressure",
        "R",
        "mu",
        "structure",
        "theta",
        "dilation",
        "wear",
        "bond",
    ];
    let mut entries = Vec::new();
    for pair in &simulation.model().contacts {
        let undeformed = simulation.model().mesh.undeformed();
        // Where sides meet at a corner each has a point of its own there: what lies before them tells which is which.
        let place = |point: &SlavePoint| {
            let at = point.at(&undeformed);
            let before = at + point.outward(&undeformed).unwrap_or_default() * frame.length;
            let [at, before] = [at, before].map(|at| frame.place([at.x, at.y]).map(|x| (1e6 * x).round()));
            [(1e-6 * at[1]).round(), at[0], at[1], before[0], before[1]]
        };
        let mut order: Vec<(usize, [f64; 5])> = pair.points.iter().map(place).enumerate().collect();
        order.sort_by(|(_, a), (_, b)| a.partial_cmp(b).expect("numbers"));
        for field in fields {
            let Ok(values) = simulation.contact_field(&pair.name, field) else { continue };
            let (kind, sign) = kinds(field);
            for (rank, (point, _)) in order.iter().enumerate() {
                let value = sign * values[*point] / frame.unit(kind);
                entries.push(Entry {
                    kind,
                    column: own_name(&format!("{}.{field} of point {rank}", pair.name), ways).into(),
                    value,
                });
            }
        }
    }
    entries
}

impl Record {
    /// Values of a column, row by row.
    pub fn values(&self, column: &str) -> impl Iterator<Item = f64> {
        let of = move |(_, row): &(f64, Vec<Entry>)| {
            row.iter().find(|entry| &*entry.column == column).map(|entry| entry.value)
        };
        self.rows.iter().filter_map(of)
    }

    /// Whether all increments of a stage are as long as its first, as they are where nothing made one shorter.
    pub fn is_even(&self, stage: f64) -> bool {
        let mut bounds: BTreeMap<u64, [f64; 2]> = BTreeMap::new();
        for (time, row) in &self.rows {
            for dt in row.iter().filter(|entry| &*entry.column == "dt").map(|entry| entry.value) {
                let [least, most] = bounds.entry((time / stage - 1e-6).max(0.0) as u64).or_insert([dt, dt]);
                (*least, *most) = (least.min(dt), most.max(dt));
            }
        }
        bounds.values().all(|[least, most]| most - least <= 1e-9 * most)
    }
}

/// The largest difference of two records, as a share of the largest number of its kind; where, and the two numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Difference {
    pub share: f64,
    pub place: String,
    pub values: [f64; 2],
}

impl Difference {
    /// Of two runs that end in different ways.
    pub fn of_end(now: &Ended, before: &Ended) -> Self {
        Self { share: f64::INFINITY, place: format!("ended {now:?}, and was {before:?}"), values: [0.0; 2] }
    }
}

impl std::fmt::Display for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let Self { share, place, values: [a, b] } = self;
        write!(f, "{place}: {a:.12e} and {b:.12e}, {share:.2e} of the largest")
    }
}

/// Compare what two records say at the same times of the columns that both have. `skip` leaves columns out.
pub fn compare(a: &Record, b: &Record, skip: &dyn Fn(&str) -> bool) -> Difference {
    let mut scales: BTreeMap<Kind, f64> = BTreeMap::new();
    for entry in a
        .rows
        .iter()
        .chain(&b.rows)
        .flat_map(|(_, row)| row)
        .filter(|entry| entry.value.is_finite() && !skip(&entry.column))
    {
        let scale = scales.entry(entry.kind).or_insert(0.0);
        *scale = scale.max(entry.value.abs());
    }
    scales.insert(Kind::Number, 1.0);
    let last = a.rows.last().map_or(1.0, |(time, _)| *time);
    let mut worst = Difference::default();
    let mut common = 0;
    for (time, row) in &a.rows {
        let Some((_, other)) = b.rows.iter().find(|(t, _)| (t - time).abs() <= 1e-7 * last) else { continue };
        common += 1;
        let other: BTreeMap<&str, f64> = other.iter().map(|entry| (&*entry.column, entry.value)).collect();
        // Whether a point touches or slips at all may hang on a last digit; its slip and its tractions do not.
        for entry in row.iter().filter(|entry| entry.kind != Kind::Share && !skip(&entry.column)) {
            let Some(&value) = other.get(&*entry.column) else { continue };
            if entry.value.is_nan() && value.is_nan() {
                continue;
            }
            let scale = scales.get(&entry.kind).copied().filter(|scale| *scale > 0.0).unwrap_or(1.0);
            let share = (entry.value - value).abs() / scale;
            let share = if share.is_nan() { f64::INFINITY } else { share };
            if share > worst.share {
                worst = Difference {
                    share,
                    place: format!("{} at t = {time:.5}", entry.column),
                    values: [entry.value, value],
                };
            }
        }
    }
    if common == 0 || a.rows.len().abs_diff(b.rows.len()) > 0 && common < 2 {
        return Difference {
            share: f64::INFINITY,
            place: format!("{} rows and {}, none at the same time", a.rows.len(), b.rows.len()),
            values: [0.0; 2],
        };
    }
    worst
}
