//! `gradients.csv`: derivatives of the quantities of the history by parameters of the case, at its rows.
//!
//! ```text
//! dQ/dθ = Σ w_k Q(θ + k ε)/ε        k = −1, 1, w = −½, ½;  k = 0, ±1, ±2, w = ∓3/2, ±2, ∓½ at the end of the range of θ
//! ```
//!
//! with neighbours of the run that follow it increment by increment ([`crate::time::neighbour`]). Where a contact point has another status
//! in one of them than in the other, the run is at a kink, and the derivative is a mean of those on both sides.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::csv::{self, Rows, Standing, Table};
use super::history::HistoryRows;
use super::quantities::INCREMENT;
use super::warnings::Warn;
use crate::laws::friction::Regime;
use crate::model::Model;
use crate::model::state::State;
use crate::run::control::is_of;
use crate::run::error::Error;
use crate::run::observer::{Attempt, Observer};
use crate::solve::neighbour::Tangent;
use crate::time::neighbour::{Lead, Neighbour, follow};

/// The table.
pub const FILE: &str = "gradients.csv";

/// A parameter by which the history is differentiated.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// its place in the case
    pub place: String,
    /// w_k/ε, and the model with θ + k ε
    pub neighbours: Vec<(f64, Arc<Model>)>,
}

/// The neighbours of a run.
#[derive(Clone, Debug)]
pub struct Neighbours {
    /// the model of the run, to be solved as exactly as those beside it
    pub middle: Arc<Model>,
    /// those of every parameter
    pub parameters: Vec<Parameter>,
}

/// Reliability of a derivative.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Account {
    /// number of contact points, summed over the increments, whose status differed between the neighbours: their derivatives are
    /// one-sided
    pub one_sided: usize,
    /// time from which on there is no derivative, as a neighbour could not follow [T]
    pub lost_at: Option<f64>,
}

/// A neighbour of the run, its weight, and the rows of its history.
struct Side {
    weight: f64,
    neighbour: Neighbour,
    rows: HistoryRows,
}

/// A parameter and its neighbours.
struct Derivative {
    place: String,
    sides: Vec<Side>,
    account: Account,
}

/// Saved memory of a derivative: its place, its account, and state, step and rows of its neighbours.
type Memory = (String, Account, Vec<(State, Option<usize>, Vec<u8>)>);

/// Saved memory of all: extent of the table, state and step of the neighbour with the value of the run, and the derivatives.
type Whole = (Standing, (State, Option<usize>), Vec<Memory>);

/// Observer that writes `gradients.csv`.
pub struct Gradients {
    table: Table,
    tangent: Tangent,
    middle: Neighbour,
    derivatives: Vec<Derivative>,
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
        Neighbours { middle, parameters }: &Neighbours,
        goes_on: bool,
        warn: Warn,
    ) -> Result<Self, Error> {
        let (_, header) = HistoryRows::new(model);
        let quantities = &header[INCREMENT.len()..];
        let of = |parameter: &Parameter| {
            quantities.iter().map(|quantity| format!("d({quantity})/d({})", parameter.place)).collect::<Vec<_>>()
        };
        let columns = parameters.iter().flat_map(of);
        let columns: Vec<String> = ["time", "step"].map(String::from).into_iter().chain(columns).collect();
        let path = folder.join(FILE);
        let table = if goes_on { Table::reopen(&path, columns) } else { Table::create(&path, columns) }?;
        let side = |(weight, model): &(f64, Arc<Model>)| Side {
            weight: *weight,
            neighbour: Neighbour::new(model.clone()),
            rows: HistoryRows::new(model).0,
        };
        let derivative = |parameter: &Parameter| Derivative {
            place: parameter.place.clone(),
            sides: parameter.neighbours.iter().map(side).collect(),
            account: Account::default(),
        };
        Ok(Self {
            table,
            tangent: Tangent::new(model),
            middle: Neighbour::new(middle.clone()),
            derivatives: parameters.iter().map(derivative).collect(),
            quantities: quantities.len(),
            warn,
            warnings: Vec::new(),
            seconds: 0.0,
        })
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

    /// The derivatives of the row at the accepted state; contact points at a kink there are counted.
    fn row(&mut self) -> Vec<f64> {
        let one = |Side { weight, neighbour: Neighbour { model, old, state, .. }, rows }: &mut Side| {
            (*weight, rows.values(model, old, state), statuses(model, state))
        };
        let all: Vec<_> = self.sides.iter_mut().map(one).collect();
        let Some(((_, first, statuses), others)) = all.split_first() else { return Vec::new() };
        let at_kink = |point: &usize| others.iter().any(|(_, _, other)| other[*point] != statuses[*point]);
        self.account.one_sided += (0..statuses.len()).filter(at_kink).count();
        // The weights add up to 0.
        let derivative = |k: usize| others.iter().map(|(weight, row, _)| weight * (row[k] - first[k])).sum();
        (0..first.len()).map(derivative).collect()
    }
}

/// Status of every contact point.
fn statuses(model: &Model, state: &State) -> Vec<Regime> {
    let pairs = model.contacts.iter().zip(&state.contacts);
    pairs
        .flat_map(|(pair, states)| pair.points.iter().zip(states).map(|(point, state)| pair.regime(point, state)))
        .collect()
}

impl Observer for Gradients {
    fn record(&mut self, _model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let Some(new) = attempt.accepted else { return Ok(()) };
        let clock = Instant::now();
        let Self { table, tangent, middle, derivatives, quantities, warn, warnings, .. } = self;
        let Attempt { step, step_number, ended, old, passes, .. } = *attempt;
        let lead = Lead { step, number: step_number, ended, old, new, passes };
        let alive = derivatives.iter_mut().filter(|derivative| derivative.lives());
        let mut sides: Vec<&mut Neighbour> =
            alive.flat_map(|derivative| derivative.sides.iter_mut().map(|side| &mut side.neighbour)).collect();
        let mut followed = follow(&lead, tangent, middle, &mut sides).into_iter();
        table.number(new.time);
        table.text(&step.name);
        for derivative in derivatives.iter_mut() {
            if derivative.lives() {
                let all: Vec<_> = followed.by_ref().take(derivative.sides.len()).collect();
                if let Some(failure) = all.into_iter().find_map(Result::err) {
                    derivative.account.lost_at = Some(new.time);
                    let warning = format!(
                        "gradients.csv: no derivative by {} from t = {} on: a run with a slightly different value cannot make the \
                         same increment ({failure}); the run itself goes on",
                        derivative.place, new.time
                    );
                    warn(&warning);
                    warnings.push(warning);
                }
            }
            match derivative.lives() {
                true => table.numbers(derivative.row()),
                false => table.numbers(vec![f64::NAN; *quantities]),
            }
        }
        let written = table.end_row_as(attempt.row).and_then(|()| table.share());
        self.seconds += clock.elapsed().as_secs_f64();
        written
    }

    fn name(&self) -> &'static str {
        "gradients"
    }

    fn save(&mut self) -> Result<Vec<u8>, Error> {
        let mut memories: Vec<Memory> = Vec::new();
        for Derivative { place, sides, account } in &self.derivatives {
            let side = |Side { neighbour, rows, .. }: &Side| {
                Ok::<_, Error>((neighbour.state.clone(), neighbour.begun, rows.save()?))
            };
            memories.push((place.clone(), account.clone(), sides.iter().map(side).collect::<Result<_, _>>()?));
        }
        csv::remembered(&(self.table.standing()?, (&self.middle.state, self.middle.begun), memories))
    }

    fn check(&self, memory: &[u8]) -> Result<(), Error> {
        let (stood, (middle, _), memories) = csv::recalled::<Whole>(memory)?;
        let of_these = |(derivative, (place, _, sides)): (&Derivative, &Memory)| {
            let fits = |(side, (state, ..)): (&Side, &(State, _, _))| is_of(state, &side.neighbour.model);
            let Derivative { place: own, sides: neighbours, .. } = derivative;
            own == place && neighbours.len() == sides.len() && neighbours.iter().zip(sides).all(fits)
        };
        if !is_of(&middle, &self.middle.model)
            || memories.len() != self.derivatives.len()
            || !self.derivatives.iter().zip(&memories).all(of_these)
        {
            return Err(csv::failed(Path::new(FILE), &"the checkpoint holds derivatives by other parameters"));
        }
        self.table.check(&stood)
    }

    fn restore(&mut self, memory: &[u8]) -> Result<(), Error> {
        let (stood, (middle, begun), memories) = csv::recalled::<Whole>(memory)?;
        self.middle.go_on(middle, begun);
        for (derivative, (_, account, sides)) in self.derivatives.iter_mut().zip(memories) {
            derivative.account = account;
            for (side, (state, begun, row)) in derivative.sides.iter_mut().zip(sides) {
                side.neighbour.go_on(state, begun);
                side.rows.restore(&row)?;
            }
        }
        self.table.cut(stood)
    }

    fn finish(&mut self) -> Result<(), Error> {
        self.table.flush()
    }
}
