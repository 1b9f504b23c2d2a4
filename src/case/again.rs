//! Continuation of cases: a run resumed from its checkpoint, and a case that begins with the final state of another. This file
//! defines which differences from the case of the checkpoint are allowed.
//!
//! Two cases are compared key by key.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::slice;
use std::sync::Arc;

use serde_json::{Map, Value};

use super::error::CaseError;
use super::file::Case;
use super::gradients::Differentiated;
use super::read::clipped;
use super::resolved::with_defaults;
use super::{Written, read};
use crate::contact::mortar::Hats;
use crate::contact::{ContactState, SlavePoint};
use crate::mesh::{Group, Mesh};
use crate::model::builder::{Checked, Contact, ModelError, evaluation, hats, regime};
use crate::model::scheme::Regime;
use crate::model::{Method, Model, State};
use crate::output::checkpoint::{self, Checkpoint, MeshPrint};
use crate::output::gradients::Parameter;
use crate::run::{Saved, SavedRun};

/// Keys that never affect how a run continues.
const FREE: [&str; 6] = ["title", "units", "watch", "probes", "sections", "output"];

/// Relative difference below which values are equal.
const SAME: f64 = 1e-9;

/// A case ready to run, with the steps of the case that it begins with, if any, before its own.
pub struct Opened {
    /// the case
    pub case: Case,
    /// case file
    pub path: PathBuf,
    /// the case as JSON
    pub document: Value,
    /// number of steps taken over from the case that it begins with
    pub taken_over: usize,
    /// other input files: mesh, and the checkpoint that it begins with
    pub inputs: Vec<PathBuf>,
    /// mesh in memory, used instead of the one named by the case
    mesh: Option<Mesh>,
    /// neighbours of its run, if its history is differentiated, once the model is built
    pub neighbours: Option<Vec<Parameter>>,
    /// checkpoint at which it starts, if any
    start: Option<Checkpoint>,
    /// whether it resumes the run of that checkpoint
    resumes: bool,
}

impl Opened {
    /// Opens a case to be run from its beginning.
    ///
    /// # Errors
    /// Returns [`CaseError`] if it cannot begin with the case that it names.
    pub fn begin(Written { path, mut document, case }: Written) -> Result<Self, CaseError> {
        let path = path.as_path();
        let Some(source) = case.begin_with.as_ref() else { return Ok(Self::new(path, document, case, None)) };
        let (source, own_steps) = (next_to(path, source), case.steps.len());
        let joined = begun(&mut document, &source).map_err(|complaint| complaint.in_file(path));
        let (file, checkpoint) = joined?;
        let case: Case = read::input(&document).map_err(|complaint| complaint.in_file(path))?;
        let taken_over = case.steps.len() - own_steps;
        let mut opened = Self::new(path, document, case, Some(checkpoint));
        opened.inputs.push(file);
        opened.taken_over = taken_over;
        Ok(opened)
    }

    /// Opens a case whose run resumes from a checkpoint.
    ///
    /// # Errors
    /// Returns [`CaseError`] with the differences if the case has changed since.
    pub fn resume(written: Written, checkpoint: Checkpoint) -> Result<Self, CaseError> {
        let Written { path, mut document, .. } = written;
        let path = path.as_path();
        let complain = |complaint: ModelError| complaint.in_file(path);
        let before = document_of(&checkpoint).map_err(complain)?;
        join(&mut document, &steps(&before)[..checkpoint.taken_over.min(steps(&before).len())]);
        unchanged(&before, &document, checkpoint.begun).map_err(complain)?;
        same_bodies(&before, &document, checkpoint.taken_over).map_err(complain)?;
        let case = read::input(&document).map_err(complain)?;
        let taken_over = checkpoint.taken_over;
        Ok(Self { taken_over, resumes: true, ..Self::new(path, document, case, Some(checkpoint)) })
    }

    /// Opens a case whose run goes on after the steps taken over, from an end for which its caller answers.
    pub(super) fn going_on(path: &Path, document: Value, case: Case, taken_over: usize) -> Self {
        Self { taken_over, ..Self::new(path, document, case, None) }
    }

    fn new(path: &Path, document: Value, case: Case, start: Option<Checkpoint>) -> Self {
        let files = document["mesh"].as_array().map_or(slice::from_ref(&document["mesh"]), Vec::as_slice);
        let inputs = files.iter().filter_map(Value::as_str).map(|mesh| next_to(path, mesh)).collect();
        let (path, mesh, neighbours) = (path.to_owned(), None, None);
        Self { case, path, document, taken_over: 0, inputs, mesh, neighbours, start, resumes: false }
    }

    /// Uses a mesh in memory; the mesh named by the case is then only a label.
    #[must_use]
    pub fn on(self, mesh: Mesh) -> Self {
        Self { mesh: Some(mesh), inputs: self.inputs.into_iter().skip(1).collect(), ..self }
    }

    /// Builds the model, and the saved run to begin from or to resume; `None` to start at the beginning.
    ///
    /// # Errors
    /// Returns [`CaseError`] as [`super::build`], and if the run does not belong to this model.
    pub fn build(&mut self) -> Result<(Arc<Model>, Option<SavedRun>), CaseError> {
        let mesh = match self.mesh.take() {
            Some(mesh) => mesh,
            None => super::mesh(&self.case, &self.path).map_err(|complaint| complaint.in_file(&self.path))?,
        };
        let again = (!self.case.gradients.is_empty()).then(|| mesh.clone());
        let built = super::build_on(&self.case, mesh, &self.path);
        let model = Arc::new(built.map_err(|error| CaseError { place: self.own_place(error.place), ..error })?);
        if let Some(mesh) = again {
            let Self { case, document, path, taken_over, .. } = self;
            let of = Differentiated { case, document, path, model: &model, begins_with: *taken_over > 0 };
            self.neighbours = Some(of.neighbours(&mesh)?);
        }
        let Some(checkpoint) = self.start.take() else { return Ok((model, None)) };
        let before = document_of(&checkpoint).map_err(|complaint| complaint.in_file(&self.path))?;
        let Checkpoint { mesh, run, .. } = checkpoint;
        let complain = |message: String| self.not_of(if self.resumes { "" } else { "begin_with" }, message);
        check_mesh(&mesh, &model).map_err(complain)?;
        same_defaults(&before, &self.case, &model.mesh).map_err(|complaint| complaint.in_file(&self.path))?;
        let saved = SavedRun::from_bytes(run, &model).map_err(|error| complain(error.to_string()))?;
        if self.resumes {
            return Ok((model, Some(saved)));
        }
        self.within_strength(&model, saved.simulation().state()).map_err(|complaint| complaint.in_file(&self.path))?;
        Ok((model, Some(saved.begin())))
    }

    /// Resumes a run saved in this process with this case on its model. `before` is the case of that run, with the steps of the
    /// case that it begins with, and its mesh.
    ///
    /// # Errors
    /// Returns [`CaseError`] as [`Self::resume`] and [`Self::build`].
    pub fn take_up(
        &self,
        run: Saved,
        before: &Value,
        mesh: &MeshPrint,
        model: &Arc<Model>,
    ) -> Result<Saved, CaseError> {
        unchanged(before, &self.document, run.begun())
            .and_then(|()| same_bodies(before, &self.document, self.taken_over))
            .map_err(|complaint| complaint.in_file(&self.path))?;
        same_defaults(before, &self.case, &model.mesh).map_err(|complaint| complaint.in_file(&self.path))?;
        check_mesh(mesh, model)
            .and_then(|()| run.on(model).map_err(|error| error.to_string()))
            .map_err(|message| self.not_of("", message))
    }

    fn not_of(&self, place: &str, message: String) -> CaseError {
        ModelError::new(place, format!("{message}; the run cannot be resumed from its checkpoint")).in_file(&self.path)
    }

    /// Checks that the structure variable left by the other case is valid for the present law.
    fn within_strength(&self, model: &Model, state: &State) -> Checked<()> {
        for (pair, states) in model.contacts.iter().zip(&state.contacts) {
            let Some(input) = self.case.contacts.get(&pair.name) else { continue };
            let Some(friction) = input.friction.parameters().filter(|friction| friction.has_structure()) else {
                continue;
            };
            let [(_, highest), (_, lowest)] = friction.bounds()[..] else { continue };
            let allowed = lowest * (1.0 - SAME)..=highest * (1.0 + SAME);
            let mu = |(point, contact): (&SlavePoint, &ContactState)| pair.observed(point, "mu", contact, state.time);
            let of_law = ["mu_s", "mu_k"].iter().any(|name| input.along.parameters.contains_key(*name));
            let varies = of_law || !input.along.law.is_empty();
            if let Some(mu) = pair.points.iter().zip(states).map(mu).find(|mu| !varies && !allowed.contains(mu)) {
                let place = format!("contacts.{}.friction", pair.name);
                let message = format!(
                    "a point carries over mu = {mu}, outside the range from mu_k = {lowest} to mu_s = {highest}"
                );
                return Err(ModelError::new(place, message));
            }
        }
        Ok(())
    }

    /// Whether it resumes a run.
    pub fn resumes(&self) -> bool {
        self.resumes
    }

    /// Returns a place in the case as written by its user.
    fn own_place(&self, place: String) -> String {
        let own = |place: &str| {
            let (number, rest) = place.strip_prefix("steps[")?.split_once(']')?;
            Some(format!("steps[{}]{rest}", number.parse::<usize>().ok()?.checked_sub(self.taken_over)?))
        };
        own(&place).unwrap_or(place)
    }
}

/// Whether two cases are equal except for keys that never affect how a run continues.
pub(super) fn is_same(one: &Value, other: &Value) -> bool {
    let solved = |case: &Value| {
        let mut case = case.as_object().cloned().unwrap_or_default();
        FREE.iter().for_each(|key| drop(case.remove(*key)));
        case
    };
    solved(one) == solved(other)
}

fn check_mesh(before: &MeshPrint, model: &Model) -> Result<(), String> {
    before.difference(&MeshPrint::of(&model.mesh)).map_or(Ok(()), Err)
}

/// A path relative to the folder of the case file.
fn next_to(path: &Path, file: &str) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).join(file)
}

fn steps(document: &Value) -> &[Value] {
    document["steps"].as_array().map_or(&[], |steps| steps)
}

/// Inserts the steps of another case before a case's own.
fn join(document: &mut Value, before: &[Value]) {
    let Some(document) = document.as_object_mut() else { return };
    document.remove("begin_with");
    if let Some(Value::Array(own)) = document.get_mut("steps") {
        own.splice(0..0, before.iter().cloned());
    }
}

fn document_of(checkpoint: &Checkpoint) -> Checked<Value> {
    serde_json::from_str(&checkpoint.case)
        .map_err(|cause| ModelError::new("", format!("the case of the checkpoint: {cause}")))
}

/// Prepares a case that begins with the end of another; returns the checkpoint and its file.
fn begun(document: &mut Value, source: &Path) -> Checked<(PathBuf, Checkpoint)> {
    let complain = |message: String| ModelError::new("begin_with", message);
    let (file, checkpoint) = if source.is_dir() {
        let newest = checkpoint::newest(source);
        // A damaged checkpoint is refused: the previous one is not at the end of the run.
        let (checkpoint, damage) = newest.map_err(|(file, why)| complain(format!("{}: {why}", file.display())))?;
        if let Some(damage) = damage {
            return Err(complain(damage));
        }
        (source.join(checkpoint::NEWEST), checkpoint)
    } else {
        let read = checkpoint::read(source);
        (source.to_owned(), read.map_err(|why| complain(format!("{}: {why}", source.display())))?)
    };
    if !checkpoint.complete {
        let message =
            format!("{}: the run is not complete: resume it first (fecontact run --resume)", source.display());
        return Err(complain(message));
    }
    let before = document_of(&checkpoint)?;
    let (was, is) = (with_defaults(&before), with_defaults(document));
    let mut differences = Vec::new();
    for (key, was, is) in both(object(&was), object(&is)) {
        if !(FREE.contains(&key) || ["steps", "newton", "begin_with"].contains(&key)) {
            compare(key.into(), was, is, &mut differences);
        }
    }
    differences.retain(|difference| !difference.is_variant());
    refuse(differences, "this case cannot begin with the end of that run")?;
    let taken_over = steps(&before).len();
    join(document, steps(&before));
    same_bodies(&before, document, taken_over)?;
    Ok((file, checkpoint))
}

/// Checks that a case has changed only in steps that have not begun, and in its output.
fn unchanged(before: &Value, now: &Value, begun: usize) -> Checked<()> {
    let [before, now] = [before, now].map(with_defaults);
    let mut differences = Vec::new();
    for (key, was, is) in both(object(&before), object(&now)) {
        if !FREE.contains(&key) && key != "steps" {
            compare(key.into(), was, is, &mut differences);
        }
    }
    for k in 0..begun {
        compare(format!("steps[{k}]"), steps(&before).get(k), steps(&now).get(k), &mut differences);
    }
    refuse(differences, "the case has changed since its checkpoint was written")
}

/// Checks that the bodies that are absent from the start are those of the run so far: later steps decide that. Steps are numbered without
/// those taken over.
fn same_bodies(before: &Value, now: &Value, taken_over: usize) -> Checked<()> {
    let [was, is] = [before, now].map(coming);
    let own = |[step, k]: [usize; 2]| format!("steps[{}].add[{k}]", step.saturating_sub(taken_over));
    if let Some((body, place)) = is.iter().find(|(body, _)| !was.contains_key(*body)) {
        let message = format!(
            "`{body}` is present from the start of the run so far, but a body that a step adds before any step removes \
             it counts as absent until then: remove it in a step before this one, or run the case with all its steps \
             from the beginning"
        );
        return Err(ModelError::new(own(*place), message));
    }
    let Some((body, place)) = was.iter().find(|(body, _)| !is.contains_key(*body)) else { return Ok(()) };
    let message = format!(
        "`{body}` is absent at the start of the run so far, whose {} added it; without that step it would be present \
         from the start: keep the step that adds it, or run the case from the beginning",
        own(*place)
    );
    Err(ModelError::new("steps", message))
}

/// Bodies that a step adds before any removes them, with the numbers of the step and of the entry.
fn coming(document: &Value) -> BTreeMap<&str, [usize; 2]> {
    let mut first = BTreeMap::new();
    for (step, given) in steps(document).iter().enumerate() {
        for key in ["add", "remove"] {
            let names = given[key].as_array().map_or(&[][..], Vec::as_slice).iter().filter_map(Value::as_str);
            for (k, name) in names.enumerate() {
                first.entry(name).or_insert((key == "add").then_some([step, k]));
            }
        }
    }
    first.into_iter().filter_map(|(body, place)| Some((body, place?))).collect()
}

/// Checks that the methods and penalties that a case leaves open, and the tractions of quadratic edges, are those of the run so far. They are
/// other ones where a step has inertia or is explicit: the points would be others, and their gaps other pressures.
fn same_defaults(before: &Value, now: &Case, mesh: &Mesh) -> Checked<()> {
    let Ok(before) = read::input::<Case>(before) else { return Ok(()) };
    let regimes = [&before.steps, &now.steps].map(|steps| regime(steps));
    if regimes[0] == regimes[1] {
        return Ok(());
    }
    let explicit = regimes.iter().any(|regime| matches!(regime, Regime::Explicit | Regime::QuasiDynamic));
    for (name, contact) in &now.contacts {
        let [was, is] = regimes.map(|regime| evaluation(contact, mesh, regime).map(|own| (own.method, own.points)));
        let [had, has] = regimes.map(|regime| tractions_on_edges(contact, mesh, regime));
        if was == is && had != has {
            let message = format!(
                "is mortar, which has one traction on a quadratic edge of `{}`, and one at each of its nodes in a case with an explicit or \
                 quasi_dynamic step, or with `rupture`: the run so far knows those of the other kind. Write all steps into one case and run \
                 that from the beginning, or take \"gauss_to_segment\" in both cases",
                contact.slave
            );
            return Err(ModelError::new(format!("contacts.{name}.method"), message));
        }
        let key = if was != is {
            "method"
        } else if contact.area.is_none() && contact.normal.alpha_n.is_none() && (explicit || !contact.tied) {
            "normal.alpha_n"
        } else {
            continue;
        };
        let message = "is not given, and its default depends on whether all steps are static, one has inertia or one \
                       is explicit, in which the runs differ: give it in both cases; `fecontact check --resolved` \
                       prints what it was";
        return Err(ModelError::new(format!("contacts.{name}.{key}"), message));
    }
    Ok(())
}

/// Nodes of the slave's quadratic edges that have a traction by mortar; `None` by other methods, and where no edge is quadratic.
fn tractions_on_edges(contact: &Contact, mesh: &Mesh, regime: Regime) -> Option<Hats> {
    let is_mortar = evaluation(contact, mesh, regime).is_some_and(|chosen| chosen.method == Method::Mortar);
    let Some(Group::Edges(edges)) = mesh.groups.get(&contact.slave).filter(|_| is_mortar) else { return None };
    edges.iter().any(|edge| edge.nodes.len() == 3).then(|| hats(contact, mesh, regime))
}

/// Friction parameters that affect only the start of a run, or stored states.
const STARTING: [&str; 5] = ["alpha_t", "law", "structure", "theta", "theta_2"];

/// Maximum number of differences listed in one message.
const MOST_LISTED: usize = 5;

/// A place where two cases differ.
pub struct Difference {
    place: String,
    was: Option<Value>,
    is: Option<Value>,
}

impl Difference {
    /// Whether it is a variation of the same model: other parameters of friction or damping.
    pub fn is_variant(&self) -> bool {
        let parts: Vec<&str> = self.place.split('.').collect();
        match parts[..] {
            ["contacts", _, "friction", parameter, ..] => !STARTING.contains(&parameter),
            ["bodies", _, "damping", ..] => true,
            _ => false,
        }
    }
}

/// Returns an error with the differences, if there are any.
pub fn refuse(differences: Vec<Difference>, what: &str) -> Checked<()> {
    if differences.is_empty() {
        return Ok(());
    }
    let value = |value: &Option<Value>| match value {
        None | Some(Value::Null) => "not given".into(),
        Some(Value::Number(number)) => number.as_f64().unwrap_or(f64::NAN).to_string(),
        Some(value) => clipped(&value.to_string()),
    };
    let first = differences.iter().take(MOST_LISTED);
    let first: Vec<String> = first
        .map(|Difference { place, was, is }| {
            format!("`{}` is now {} and was {}", clipped(place), value(is), value(was))
        })
        .collect();
    let more = if differences.len() > MOST_LISTED {
        format!(", and {} more", differences.len() - MOST_LISTED)
    } else {
        String::new()
    };
    Err(ModelError::new("", format!("{what}: {}{more}", first.join("; "))))
}

/// The keys of a value; none unless it is an object.
pub fn object(value: &Value) -> &Map<String, Value> {
    static NONE: std::sync::LazyLock<Map<String, Value>> = std::sync::LazyLock::new(Map::new);
    value.as_object().unwrap_or(&NONE)
}

/// Keys of two objects, with their values in both.
pub fn both<'a>(
    was: &'a Map<String, Value>,
    is: &'a Map<String, Value>,
) -> impl Iterator<Item = (&'a str, Option<&'a Value>, Option<&'a Value>)> {
    let new = is.keys().filter(|key| !was.contains_key(*key));
    was.keys().chain(new).map(|key| (key.as_str(), was.get(key), is.get(key)))
}

/// Records the differences between the values at a place of two cases.
pub fn compare(place: String, was: Option<&Value>, is: Option<&Value>, differences: &mut Vec<Difference>) {
    match (was, is) {
        // Meshes are compared by content, whatever their paths.
        (Some(Value::String(_) | Value::Array(_)), Some(Value::String(_) | Value::Array(_))) if place == "mesh" => {}
        (Some(Value::Object(was)), Some(Value::Object(is))) => {
            both(was, is).for_each(|(key, was, is)| compare(format!("{place}.{key}"), was, is, differences));
        }
        (Some(Value::Array(was)), Some(Value::Array(is))) => {
            let places = 0..was.len().max(is.len());
            places.for_each(|k| compare(format!("{place}[{k}]"), was.get(k), is.get(k), differences));
        }
        (Some(Value::Number(was)), Some(Value::Number(is))) if was.as_f64() == is.as_f64() => {}
        (was, is) if was == is => {}
        (was, is) => differences.push(Difference { place, was: was.cloned(), is: is.cloned() }),
    }
}
