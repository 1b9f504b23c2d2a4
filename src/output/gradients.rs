//! `gradients.csv`: derivatives of the quantities of the history and of the probes by parameters of the case, at their rows.
//!
//! ```text
//! dQ/dθ = Σ w_k (Q(θ + k ε) − Q(θ))/ε        k = −1, 1, w = −½, ½;  k = ±1, ±2, w = ±2, ∓½ at the end of the range of θ
//! ```
//!
//! with neighbours of the run that follow it increment by increment ([`crate::time::neighbour`]). Where a contact point has another status
//! in one of them, the run is at a kink, and the derivative is a mean of those on both sides.
//!
//! Frames show those of the displacements of nodes, on request.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;
use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::csv::{self, Rows, Standing, Table};
use super::history::HistoryRows;
use super::probes::ProbeRows;
use super::quantities::INCREMENT;
use super::store::derivatives::{self, DerivativeStore};
use super::warnings::Warn;
use crate::equations::regimes;
use crate::laws::friction::Regime;
use crate::model::{Model, State};
use crate::run::control::is_of;
use crate::run::{Attempt, Error, Observer};
use crate::solve::neighbour::Tangent;
use crate::time::neighbour::{BaseIncrement, Neighbour, follow};

/// The table.
pub const FILE: &str = "gradients.csv";

/// A parameter by which the history is differentiated.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// its place in the case
    pub place: String,
    /// whether it is one of the bodies
    pub is_of_bodies: bool,
    /// its neighbours
    pub neighbours: Vec<Perturbed>,
}

/// A model with another value of a parameter, θ + k ε.
#[derive(Clone, Debug)]
pub struct Perturbed {
    /// k
    pub offset: f64,
    /// w_k/ε
    pub weight: f64,
    /// the model
    pub model: Arc<Model>,
}

/// Reliability of a derivative.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Account {
    /// number of contact points, summed over the increments, whose status in a neighbour differed from that in the run: their derivatives
    /// are one-sided
    pub one_sided: usize,
    /// time from which on there is no derivative, as a neighbour could not follow [T]
    pub lost_at: Option<f64>,
}

/// Rows of the tables of the run or of a neighbour.
#[derive(Clone)]
struct Quantities {
    history: HistoryRows,
    probes: ProbeRows,
}

/// What is differentiated, at an accepted state.
struct End {
    row: Vec<f64>,
    stored: Vec<f64>,
    statuses: Vec<Regime>,
}

/// A neighbour of the run, and its weight.
struct Side {
    weight: f64,
    neighbour: Neighbour,
    quantities: Quantities,
}

/// A parameter and its neighbours.
struct Derivative {
    place: String,
    sides: Vec<Side>,
    account: Account,
}

/// Saved memory of a derivative: its place, its account, and state, step and rows of its neighbours.
type Memory = (String, Account, Vec<(State, Option<usize>, Vec<u8>)>);

/// Saved memory of all: extent of the table, of the store, displacement and rows of the run, and the derivatives.
type Whole = (Standing, derivatives::Memory, Vec<f64>, Vec<u8>, Vec<Memory>);

/// Place of a value in the case, and the derivatives of the displacements of all nodes by it [L/unit of the value].
pub type MotionBy = (String, Vec<f64>);

/// Derivatives of displacements at the last accepted state, for its frame; empty where none are asked for.
pub type Motions = Rc<RefCell<Vec<MotionBy>>>;

/// What is asked of the derivatives.
#[derive(Clone, Copy, Debug)]
pub struct Asked<'a> {
    /// known labels of units
    pub units: &'a BTreeMap<String, String>,
    /// whether those of the displacements of nodes are stored, and shown in frames
    pub of_displacements: bool,
    /// whether files of an earlier run are continued
    pub goes_on: bool,
}

/// Observer that writes `gradients.csv` and `gradients.zarr`.
pub struct Gradients {
    table: Table,
    tangent: Tangent,
    /// Rows and displacement of the run
    own: Quantities,
    displacement: Vec<f64>,
    derivatives: Vec<Derivative>,
    store: DerivativeStore,
    /// What frames show
    motions: Motions,
    /// Number of quantities
    quantities: usize,
    warn: Warn,
    /// warnings so far
    pub warnings: Vec<String>,
    /// wall time spent [s]
    pub seconds: f64,
}

impl Gradients {
    /// Creates the table in `folder`, or opens that of an earlier run, to be restored.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if it cannot be written.
    pub fn new(
        folder: &Path,
        model: &Arc<Model>,
        parameters: &[Parameter],
        Asked { units, of_displacements, goes_on }: Asked,
        warn: Warn,
    ) -> Result<Self, Error> {
        let (history, columns) = HistoryRows::new(model);
        let (probes, probed) = ProbeRows::new(model);
        let own = Quantities { history, probes };
        let quantities: Vec<String> =
            columns.into_iter().skip(INCREMENT.len()).chain(probed.into_iter().skip(1)).collect();
        let of = |parameter: &Parameter| {
            quantities.iter().map(|quantity| format!("d({quantity})/d({})", parameter.place)).collect::<Vec<_>>()
        };
        let columns = parameters.iter().flat_map(of);
        let columns: Vec<String> = ["time", "step"].map(String::from).into_iter().chain(columns).collect();
        let path = folder.join(FILE);
        let table = if goes_on { Table::reopen(&path, columns) } else { Table::create(&path, columns) }?;
        let derivative = |parameter: &Parameter| {
            let side = |Perturbed { offset, weight, model }: &Perturbed| Side {
                weight: *weight,
                neighbour: Neighbour::new(model.clone(), *offset, !parameter.is_of_bodies),
                quantities: if parameter.is_of_bodies { Quantities::of(model) } else { own.clone() },
            };
            let sides = parameter.neighbours.iter().map(side).collect();
            Derivative { place: parameter.place.clone(), sides, account: Account::default() }
        };
        let by: Vec<&str> = parameters.iter().map(|parameter| &*parameter.place).collect();
        let mut store = DerivativeStore::new(folder, model, &by, of_displacements, units);
        if !goes_on {
            store.create()?;
        }
        let derivatives: Vec<Derivative> = parameters.iter().map(derivative).collect();
        let displacement = model.initial_state().displacement;
        let shown = derivatives.iter().filter(|_| of_displacements).map(|derivative| derivative.motion(&displacement));
        Ok(Self {
            table,
            store,
            motions: Rc::new(RefCell::new(shown.collect())),
            tangent: Tangent::new(model),
            own,
            displacement,
            derivatives,
            quantities: quantities.len(),
            warn,
            warnings: Vec::new(),
            seconds: 0.0,
        })
    }

    /// Returns the derivatives that frames show; they follow the run.
    pub fn motions(&self) -> Motions {
        self.motions.clone()
    }

    /// Shows the derivatives at the accepted state.
    fn show(&self) {
        let mut motions = self.motions.borrow_mut();
        let each = motions.iter_mut().zip(&self.derivatives);
        each.for_each(|(shown, derivative)| *shown = derivative.motion(&self.displacement));
    }

    /// Returns the reliability of every derivative, by the place of its parameter.
    pub fn accounts(&self) -> BTreeMap<String, Account> {
        self.derivatives.iter().map(|derivative| (derivative.place.clone(), derivative.account.clone())).collect()
    }
}

impl Derivative {
    /// Whether its neighbours have followed so far.
    fn lives(&self) -> bool {
        self.account.lost_at.is_none()
    }

    /// The derivatives of the displacements of all nodes at the accepted state, where that of the run is given.
    fn motion(&self, run: &[f64]) -> MotionBy {
        let mut values = vec![if self.lives() { 0.0 } else { f64::NAN }; run.len()];
        for Side { weight, neighbour, .. } in &self.sides {
            add_difference(&mut values, *weight, &neighbour.state.displacement, run);
        }
        (self.place.clone(), values)
    }

    /// The derivatives at the accepted state, of the row and of what is stored; contact points at a kink there are counted.
    fn at_end(&mut self, run: &End, store: &DerivativeStore) -> [Vec<f64>; 2] {
        let mut derivatives = [vec![0.0; run.row.len()], vec![0.0; run.stored.len()]];
        let mut at_kink = vec![false; run.statuses.len()];
        for Side { weight, neighbour: Neighbour { model, old, state, .. }, quantities } in &mut self.sides {
            let End { row, stored, statuses } = quantities.at(model, old, state, store);
            add_difference(&mut derivatives[0], *weight, &row, &run.row);
            add_difference(&mut derivatives[1], *weight, &stored, &run.stored);
            let both = statuses.iter().zip(&run.statuses);
            at_kink.iter_mut().zip(both).for_each(|(at_kink, (status, run))| *at_kink |= status != run);
        }
        self.account.one_sided += at_kink.iter().filter(|at_kink| **at_kink).count();
        derivatives
    }
}

/// sum ← sum + weight (values − run)
fn add_difference(sum: &mut [f64], weight: f64, values: &[f64], run: &[f64]) {
    sum.iter_mut().zip(values.iter().zip(run)).for_each(|(sum, (value, run))| *sum += weight * (value - run));
}

impl Quantities {
    fn of(model: &Model) -> Self {
        Self { history: HistoryRows::new(model).0, probes: ProbeRows::new(model).0 }
    }

    fn at(&mut self, model: &Model, old: &State, state: &State, store: &DerivativeStore) -> End {
        let mut row = self.history.values(model, old, state);
        row.extend(self.probes.values(model, state));
        End { row, stored: store.values(model, state), statuses: regimes(&model.contacts, &state.contacts) }
    }
}

impl Observer for Gradients {
    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let Some(new) = attempt.accepted else { return Ok(()) };
        let clock = Instant::now();
        let Self { table, store, tangent, own, displacement, derivatives, quantities, warn, warnings, .. } = self;
        let Attempt { step, step_number, ended, old, passes, .. } = *attempt;
        let base = BaseIncrement { step, number: step_number, ended, old, new, passes };
        let alive = derivatives.iter_mut().filter(|derivative| derivative.lives());
        let groups = alive.map(|derivative| derivative.sides.iter_mut().map(|side| &mut side.neighbour).collect());
        let mut followed = follow(&base, tangent, groups.collect()).into_iter();
        let run = own.at(model, old, new, store);
        displacement.clone_from(&new.displacement);
        table.number(new.time);
        table.text(&step.name);
        let mut by_each = Vec::new();
        for derivative in derivatives.iter_mut() {
            if derivative.lives()
                && let Some(Err(failure)) = followed.next()
            {
                derivative.account.lost_at = Some(new.time);
                let warning = format!(
                    "gradients.csv: no derivative by {} from t = {} on: a run with a slightly different value cannot make the \
                     same increment ({failure}); the run itself goes on",
                    derivative.place, new.time
                );
                warn(&warning);
                warnings.push(warning);
            }
            let [row, stored] = match derivative.lives() {
                true => derivative.at_end(&run, store),
                false => [*quantities, store.width()].map(|count| vec![f64::NAN; count]),
            };
            table.numbers(row);
            by_each.push(stored);
        }
        let written = table.end_row_as(attempt.row).and_then(|()| table.share());
        let written = written.and_then(|()| store.add(new.time, &by_each, attempt.row));
        self.show();
        self.seconds += clock.elapsed().as_secs_f64();
        written
    }

    fn name(&self) -> &'static str {
        "gradients"
    }

    fn save(&mut self) -> Result<Vec<u8>, Error> {
        let mut memories: Vec<Memory> = Vec::new();
        for Derivative { place, sides, account } in &self.derivatives {
            let side = |Side { neighbour, quantities, .. }: &Side| {
                Ok::<_, Error>((neighbour.state.clone(), neighbour.begun, quantities.history.save()?))
            };
            memories.push((place.clone(), account.clone(), sides.iter().map(side).collect::<Result<_, _>>()?));
        }
        let (table, store) = (self.table.standing()?, self.store.save()?);
        let whole: Whole = (table, store, self.displacement.clone(), self.own.history.save()?, memories);
        csv::remembered(&whole)
    }

    fn check(&self, memory: &[u8]) -> Result<(), Error> {
        let (stood, stored, displacement, _, memories) = csv::recalled::<Whole>(memory)?;
        let of_these = |(derivative, (place, _, sides)): (&Derivative, &Memory)| {
            let fits = |(side, (state, ..)): (&Side, &(State, _, _))| is_of(state, &side.neighbour.model);
            let Derivative { place: own, sides: neighbours, .. } = derivative;
            own == place && neighbours.len() == sides.len() && neighbours.iter().zip(sides).all(fits)
        };
        let fits = displacement.len() == self.displacement.len() && memories.len() == self.derivatives.len();
        if !fits || !self.derivatives.iter().zip(&memories).all(of_these) {
            return Err(csv::failed(Path::new(FILE), &"the checkpoint holds derivatives by other parameters"));
        }
        self.store.check(&stored)?;
        self.table.check(&stood)
    }

    fn restore(&mut self, memory: &[u8]) -> Result<(), Error> {
        let (stood, stored, displacement, row, memories) = csv::recalled::<Whole>(memory)?;
        self.displacement = displacement;
        self.own.history.restore(&row)?;
        for (derivative, (_, account, sides)) in self.derivatives.iter_mut().zip(memories) {
            derivative.account = account;
            for (side, (state, begun, row)) in derivative.sides.iter_mut().zip(sides) {
                side.neighbour.go_on(state, begun);
                side.quantities.history.restore(&row)?;
            }
        }
        self.show();
        self.store.restore(stored)?;
        self.table.cut(stood)
    }

    fn finish(&mut self) -> Result<(), Error> {
        self.store.finish()?;
        self.table.flush()
    }
}
