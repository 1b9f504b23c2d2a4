//! Things a user should know about a result: deep penetration, pressure past the law's uniqueness bound, errors in time
//! larger than allowed, and energy that came from nowhere or is lost.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use super::audit::Audit;
use super::memory;
use crate::contact::force::ContactState;
use crate::contact::pair::ContactPair;
use crate::contact::small_sliding::{Departure, LITTLE_SLIP, LITTLE_TURN, SmallSliding};
use crate::contact::surface::SlavePoint;
use crate::mesh::configuration::Configuration;
use crate::model::Model;
use crate::model::scheme::{Scheme, told};
use crate::model::state::State;
use crate::run::error::Error;
use crate::run::observer::{Attempt, Observer};
use crate::time::touching::DOUBT;

/// Penetration, as a share of the slave's edge, that is worth a warning.
const DEEP: f64 = 0.01;

/// Collects warnings; each kind once a contact or step, where it is met first.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Warnings {
    /// the warnings so far
    pub list: Vec<String>,
    given: BTreeSet<(usize, Kind)>,
    /// Names of the steps whose error in time has been warned about
    inexact: BTreeSet<String>,
    /// Names of the steps in which friction after touch was in doubt
    doubtful: BTreeSet<String>,
    /// Steps whose linear systems have been warned about
    perturbed: BTreeSet<String>,
    /// The balance of energies so far
    pub audit: Audit,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
enum Kind {
    DeepPenetration,
    DeepMasterNode,
    SeveralAnswers,
    SlidFar,
    TurnedFar,
    StretchedFar,
}

impl Observer for Warnings {
    fn name(&self) -> &'static str {
        "warnings"
    }

    fn save(&mut self) -> Result<Vec<u8>, Error> {
        memory::written(self)
    }

    fn restore(&mut self, memory: &[u8]) -> Result<(), Error> {
        *self = memory::read(memory)?;
        Ok(())
    }

    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let Some(state) = attempt.accepted else { return Ok(()) };
        self.error_in_time(attempt);
        self.error_of_touch(attempt);
        self.lost_pivots(attempt);
        self.audit.record(model, attempt.step, attempt.old, state);
        let x = model.configuration(&state.displacement);
        for (number, (pair, states)) in model.contacts.iter().zip(&state.contacts).enumerate() {
            for (point, contact) in pair.points.iter().zip(states).filter(|(_, c)| c.friction.pressure > 0.0) {
                for (kind, message) in concerns(pair, point, contact, &x) {
                    if self.given.insert((number, kind)) {
                        let at = point.at(&x);
                        let place =
                            format!("contact `{}` at ({:.6}, {:.6}), t = {}", pair.name, at.x, at.y, told(state.time));
                        self.list.push(format!("{place}: {message}"));
                    }
                }
            }
            if let Some(small) = &pair.small {
                self.no_small_sliding(number, pair, small, state.time, &x);
            }
            let fading = model.steps[0].span.share(state.time) < 1.0 && pair.points.iter().any(|p| p.overlap > 0.0);
            let explicit = matches!(attempt.step.scheme, Scheme::Explicit { .. });
            if !(fading || explicit || pair.initial.is_some()) {
                self.deep_master_node(number, pair, state, &x);
            }
        }
        Ok(())
    }

    fn finish(&mut self) -> Result<(), Error> {
        self.list.extend(self.audit.concern());
        Ok(())
    }
}

/// What is to be said of a pressure past the bound of uniqueness.
pub fn several_answers(pressure: f64, limit: f64) -> String {
    format!(
        "the pressure {pressure:.6e} passes {limit:.6e}, above which weakening may outrun the contact stiffness and the \
         answer snaps; raise alpha_t"
    )
}

impl Warnings {
    /// Points that have left what small sliding keeps, closed or not: an open one may miss what it would touch.
    fn no_small_sliding(
        &mut self,
        number: usize,
        pair: &ContactPair,
        small: &SmallSliding,
        time: f64,
        x: &Configuration,
    ) {
        for (slave, point) in pair.points.iter().zip(&small.points) {
            let Some(point) = point else { continue };
            for (kind, message) in left(point.departure(slave, &pair.master, x)) {
                if self.given.insert((number, kind)) {
                    let at = slave.at(x);
                    let place = format!("contact `{}` at ({:.6}, {:.6}), t = {}", pair.name, at.x, at.y, told(time));
                    self.list.push(format!("{place}: {message}; take finite sliding"));
                }
            }
        }
    }

    /// The points of the slave do not see a master node between them. (Where gaps are not those of the surfaces there is
    /// nothing to compare with: under initial tractions, and while a shrink fit is brought in. Explicit increments are too
    /// many to look at.)
    fn deep_master_node(&mut self, number: usize, pair: &ContactPair, state: &State, x: &Configuration) {
        if self.given.contains(&(number, Kind::DeepMasterNode)) {
            return;
        }
        let deepest = pair.deepest_master_node(&state.contacts[number], x);
        let Some((at, depth, share)) = deepest.filter(|(.., share)| *share > DEEP) else { return };
        self.given.insert((number, Kind::DeepMasterNode));
        let time = told(state.time);
        self.list.push(format!(
            "contact `{}` at ({:.6}, {:.6}), t = {time}: a node of the master lies {depth:.3e} deep in the slave, {:.1} % of \
             its edge; refine both sides there, make the finer one the slave, or raise alpha_n",
            pair.name,
            at.x,
            at.y,
            100.0 * share
        ));
    }

    /// A matrix that is singular or nearly so may still have given an answer.
    fn lost_pivots(&mut self, attempt: &Attempt) {
        let solves = || attempt.iterations.iter().map(|iteration| iteration.newton);
        let pivots = solves().map(|solve| solve.perturbed_pivots).max().unwrap_or(0);
        let fallback = solves().any(|solve| solve.fallback);
        if (pivots > 0 || fallback) && self.perturbed.insert(attempt.step.name.clone()) {
            let start = format!("step `{}`, t = {}", attempt.step.name, told(attempt.old.time + attempt.dt));
            let found = match (pivots, fallback) {
                (0, _) => "the fronts of the tangent were not exact enough, and a slower solver took over".into(),
                (pivots, false) => format!("{pivots} pivots of the tangent vanished and were replaced"),
                (pivots, true) => format!("{pivots} pivots of the tangent vanished, and a slower solver took over"),
            };
            self.list.push(format!("{start}: {found}; the equations are solved, but something may be barely held"));
        }
    }

    /// The shortest increment is accepted whatever its error.
    fn error_in_time(&mut self, attempt: &Attempt) {
        let Attempt { step, dt, old, .. } = attempt;
        let Some((error, allowed)) = attempt.local_error.zip(step.increments.error) else { return };
        if error > allowed && self.inexact.insert(step.name.clone()) {
            let start =
                format!("step `{}`, t = {}: the increment {dt:.3e} is the shortest allowed", step.name, told(old.time));
            self.list.push(format!("{start}, and its error {error:.3e} exceeds {allowed:.3e}; lower dt.min"));
        }
    }
    /// The shortest increment is accepted whatever it does not know of touch.
    fn error_of_touch(&mut self, attempt: &Attempt) {
        let Attempt { step, dt, old, .. } = attempt;
        let Some(doubt) = attempt.doubt.filter(|doubt| *doubt > DOUBT) else { return };
        if self.doubtful.insert(step.name.clone()) {
            let start =
                format!("step `{}`, t = {}: the increment {dt:.3e} is the shortest allowed", step.name, told(old.time));
            let percent = 100.0 * doubt;
            let found =
                format!("when points touched in it leaves friction of {percent:.1} % of a contact's force in doubt");
            self.list.push(format!("{start}, and {found}; lower dt.min"));
        }
    }
}

/// What is worth a warning at one closed point.
fn concerns(
    pair: &ContactPair,
    point: &SlavePoint,
    contact: &ContactState,
    x: &Configuration,
) -> impl Iterator<Item = (Kind, String)> {
    let (gap, pressure) = (contact.clearance(), contact.friction.pressure);
    let share = point.edge_length(x).map(|edge| -gap / edge);
    let deep = share.filter(|share| *share > DEEP).map(|share| {
        let percent = 100.0 * share;
        format!("the penetration {:.3e} is {percent:.1} % of the slave's edge; raise alpha_n", -gap)
    });
    let limit = pair.law(point).uniqueness_limit().filter(|limit| pressure > *limit);
    let several = limit.map(|limit| several_answers(pressure, limit));
    let deep = deep.map(|message| (Kind::DeepPenetration, message));
    deep.into_iter().chain(several.map(|message| (Kind::SeveralAnswers, message)))
}

/// What is to be said of a point that has left what small sliding keeps.
fn left(departure: Option<Departure>) -> impl Iterator<Item = (Kind, String)> {
    let Some(Departure { slid, share, turned, stretched }) = departure else {
        let message = "the surface has slid past the end of the rigid master, and small sliding holds it there";
        return [Some((Kind::SlidFar, message.into())), None, None].into_iter().flatten();
    };
    let far = (share > LITTLE_SLIP).then(|| {
        let message = format!(
            "the surfaces have slid by {slid:.3e} since the start, {:.1} % of the distance between nodes, and small sliding keeps what faced \
             what: tractions that vary from node to node are off by about as much",
            100.0 * share
        );
        (Kind::SlidFar, message)
    });
    let turned = (turned > LITTLE_TURN).then(|| {
        let message = format!(
            "a surface has turned by {turned:.3} rad since the start, and small sliding keeps its direction: tractions are \
             off by about {:.1} % of the pressure",
            100.0 * turned
        );
        (Kind::TurnedFar, message)
    });
    let stretched = (stretched > LITTLE_TURN).then(|| {
        let message = format!(
            "an edge of the slave has become {:.1} % longer or shorter since the start, and small sliding keeps its length: \
             tractions are off by as much",
            100.0 * stretched
        );
        (Kind::StretchedFar, message)
    });
    [far, turned, stretched].into_iter().flatten()
}
