//! What is worth a warning at one point of a contact.

use serde::{Deserialize, Serialize};

use crate::contact::force::ContactState;
use crate::contact::pair::ContactPair;
use crate::contact::small_sliding::{Departure, LITTLE_SLIP, LITTLE_TURN};
use crate::contact::surface::SlavePoint;
use crate::laws::friction::{FrictionLaw, FrictionState, Regime};
use crate::mesh::configuration::Configuration;

/// Penetration, as a share of the slave's edge, that is worth a warning.
pub const DEEP: f64 = 0.01;

/// Process zone of friction that weakens at a steady rate, over G*/(p |dμ/dδ|). Source: Palmer & Rice (1973), Proc. R. Soc. A 332, 527;
/// Day et al. (2005), J. Geophys. Res. 110, B12307.
const PROCESS_ZONE: f64 = 9.0 * std::f64::consts::PI / 32.0;

/// What a contact is warned of, once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Kind {
    /// A point lies deep in the master
    DeepPenetration,
    /// A node of the master lies deep in the slave
    DeepMasterNode,
    /// A node that the contact does not see lies deep in a rigid master
    DeepUnseen,
    /// Edges are longer than the process zone of friction
    Unresolved,
    /// The pressure passes the law's bound of uniqueness
    SeveralAnswers,
    /// Points have slid far in small sliding
    SlidFar,
    /// A surface has turned far in small sliding
    TurnedFar,
    /// Edges have been stretched far in small sliding
    StretchedFar,
    /// Surfaces that dilate more than they rub
    YieldsWork,
}

/// What is to be said of a pressure past the bound of uniqueness.
pub fn several_answers(pressure: f64, limit: f64) -> String {
    format!(
        "the pressure {pressure:.6e} passes {limit:.6e}, above which weakening may outrun the contact stiffness and the \
         answer snaps; raise alpha_t"
    )
}

/// What is worth a warning at one closed point after an increment up to a time.
pub fn concerns(
    (pair, point, time): (&ContactPair, &SlavePoint, f64),
    [old, contact]: [&ContactState; 2],
    x: &Configuration,
) -> impl Iterator<Item = (Kind, String)> {
    let (gap, pressure) = (contact.clearance(), contact.friction.pressure);
    let share = point.edge_length(x).map(|edge| -gap / edge);
    let deep = share.filter(|share| *share > DEEP).map(|share| {
        let percent = 100.0 * share;
        format!("the penetration {:.3e} is {percent:.1} % of the slave's edge; raise alpha_n", -gap)
    });
    let law = pair.law(point).at(time).ok();
    let limit = law.as_ref().and_then(|law| law.uniqueness_limit()).filter(|limit| pressure > *limit);
    let several = limit.map(|limit| several_answers(pressure, limit));
    let deep = deep.map(|message| (Kind::DeepPenetration, message));
    let yields = yields_work([&old.friction, &contact.friction]).map(|message| (Kind::YieldsWork, message));
    let coarse =
        law.and_then(|law| unresolved(pair, (point, &*law), contact, x)).map(|message| (Kind::Unresolved, message));
    deep.into_iter().chain(several.map(|message| (Kind::SeveralAnswers, message))).chain(coarse).chain(yields)
}

/// Share of the work of friction that an increment may give back for round-off.
const GIVEN_BACK: f64 = 1e-9;

/// What is to be said of a point that slides and lifts its load with more work than friction takes: laws whose least coefficient is
/// not known beforehand may come to it.
fn yields_work([old, new]: [&FrictionState; 2]) -> Option<String> {
    let [slip, opened] = [new.plastic_increment.abs(), new.opening - old.opening];
    let (friction, gained) = (new.traction.abs(), old.dissipation - new.dissipation);
    let yields = new.regime == Regime::Slip && opened > 0.0 && gained > GIVEN_BACK * friction * slip;
    yields.then(|| {
        format!(
            "sliding yields work instead of taking it: friction has come down to |q|/p = {:.4}, and the surfaces open by {:.4} per \
             slip (dilatancy.rate); lower that, or raise the friction",
            friction / new.pressure,
            opened / slip
        )
    })
}

/// What is to be said of an edge that is longer than the process zone of a front that runs along it.
fn unresolved(
    pair: &ContactPair,
    (point, law): (&SlavePoint, &dyn FrictionLaw),
    contact: &ContactState,
    x: &Configuration,
) -> Option<String> {
    let weakening = law.weakening() * contact.friction.pressure;
    let edge = point.edge_length(x).filter(|_| contact.regime() == Regime::Slip && pair.modulus > 0.0)?;
    let zone = PROCESS_ZONE * pair.modulus / weakening;
    (edge > zone).then(|| {
        format!(
            "the edge of {edge:.3e} is longer than the process zone of its friction, 0.88 G/((1 − ν) p |dμ/dδ|) = {zone:.3e}: when and \
             how fast slip spreads follows the mesh; take edges of a third of it"
        )
    })
}

/// What is to be said of a point that has left what small sliding keeps.
pub fn left(departure: Option<Departure>) -> impl Iterator<Item = (Kind, String)> {
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
