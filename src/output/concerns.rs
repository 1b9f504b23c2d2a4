//! What may be wrong at a single point of a contact: a pressure above the uniqueness bound of its law, an edge that does not resolve a slip
//! front, dilatancy that does work, and ways beyond the range of small sliding.

use serde::{Deserialize, Serialize};

use crate::contact::small_sliding::{Departure, LITTLE_SLIP, LITTLE_TURN};
use crate::contact::{ContactPair, ContactState, SlavePoint};
use crate::laws::friction::{Description, FrictionState, Regime};
use crate::mesh::configuration::Configuration;
use crate::model::text::distinct;

/// Process zone of linearly slip-weakening friction, divided by G*/(p |dμ/dδ|). Source: Palmer & Rice (1973), Proc. R. Soc. A
/// 332, 527; Day et al. (2005), J. Geophys. Res. 110, B12307.
const PROCESS_ZONE: f64 = 9.0 * std::f64::consts::PI / 32.0;

/// Kinds of warnings about a contact or a body, each issued once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Kind {
    /// Slave points penetrate the master
    DeepPenetration,
    /// A master node penetrates the slave
    DeepMasterNode,
    /// A slave node is inside a master while means are open
    DeepSlaveNode,
    /// A node outside the slave group penetrates a rigid master
    DeepUnseen,
    /// A rigid master is inside the slave between its points, or a slave node inside a rigid master
    RigidInside,
    /// Edges are longer than the process zone of friction
    Unresolved,
    /// The pressure exceeds the uniqueness bound of the law
    SeveralAnswers,
    /// Points have slid far in small sliding
    SlidFar,
    /// A surface has turned far in small sliding
    TurnedFar,
    /// Edges have been stretched far in small sliding
    StretchedFar,
    /// Dilatancy does more work than friction dissipates
    YieldsWork,
    /// A linear body has turned or stretched far
    FarFromLinear,
    /// Water that flows would cavitate
    Cavitates,
    /// Water opens the surfaces along which it flows
    OpenedByWater,
    /// Surfaces rattle on their penalty
    Rattles,
}

/// Warning about a pressure above the bound of uniqueness.
pub fn several_answers(pressure: f64, limit: f64) -> String {
    let [pressure, limit] = distinct([pressure, limit]);
    format!(
        "the pressure {pressure} exceeds {limit}, above which the response is not unique: the law may weaken faster \
         than the contact stiffness unloads, and the traction jumps; raise alpha_t"
    )
}

/// Warnings about one closed point after an increment up to a time.
pub fn concerns(
    pair: &ContactPair,
    point: &SlavePoint,
    time: f64,
    old: &ContactState,
    contact: &ContactState,
    x: &Configuration,
) -> impl Iterator<Item = (Kind, String)> {
    let pressure = contact.friction.pressure;
    let law = pair.ask_law(point, [time, time], |law| law.description).ok();
    let slid = contact.friction.plastic_increment.abs();
    let limit = law.filter(|law| slid >= law.unique_slip).and_then(|law| law.uniqueness_limit());
    let limit = limit.filter(|limit| pressure > *limit);
    let several = limit.map(|limit| several_answers(pressure, limit));
    let yields = yields_work(&old.friction, &contact.friction).map(|message| (Kind::YieldsWork, message));
    let coarse =
        law.and_then(|law| unresolved(pair, point, &law, contact, x)).map(|message| (Kind::Unresolved, message));
    let several = several.map(|message| (Kind::SeveralAnswers, message));
    several.into_iter().chain(coarse).chain(yields)
}

/// Fraction of the friction work that round-off may return in an increment.
const GIVEN_BACK: f64 = 1e-9;

/// Warning about a point whose dilatancy does more work than friction dissipates; possible with laws whose lowest
/// coefficient is not known beforehand.
fn yields_work(old: &FrictionState, new: &FrictionState) -> Option<String> {
    let [slip, opened] = [new.plastic_increment.abs(), new.opening - old.opening];
    let (friction, gained) = (new.traction.abs(), old.dissipation - new.dissipation);
    let yields = new.regime == Regime::Slip && opened > 0.0 && gained > GIVEN_BACK * friction * slip;
    yields.then(|| {
        format!(
            "sliding produces energy: friction has dropped to |q|/p = {:.4}, and the surfaces open by {:.4} per slip \
             (dilatancy); lower that, or raise the friction",
            friction / new.pressure,
            opened / slip
        )
    })
}

/// Warning about an edge that is longer than the process zone of a front on it.
fn unresolved(
    pair: &ContactPair,
    point: &SlavePoint,
    law: &Description,
    contact: &ContactState,
    x: &Configuration,
) -> Option<String> {
    let weakening = law.weakening * contact.friction.pressure;
    // Where a law knows no stick, what creeps by less than D_c has no front.
    let slips = contact.regime() == Regime::Slip
        && law.critical_slip.is_none_or(|critical| contact.friction.plastic_slip.abs() >= critical);
    let edge = point.edge_length(x).filter(|_| slips && pair.modulus > 0.0)?;
    let zone = PROCESS_ZONE * pair.modulus / weakening;
    (edge > zone).then(|| {
        format!(
            "the edge of {edge:.3e} is longer than the process zone of its friction, 0.88 G/((1 − ν) p |dμ/dδ|) = \
             {zone:.3e}: onset and speed of slip fronts depend on the mesh; take edges of a third of it"
        )
    })
}

/// Warnings about a point that has left the range of small sliding.
pub fn left(departure: Option<Departure>) -> impl Iterator<Item = (Kind, String)> {
    let Some(Departure { slid, share, turned, stretched }) = departure else {
        let message = "the surface has slid past the end of the rigid master, but small sliding keeps it in contact";
        return [Some((Kind::SlidFar, message.into())), None, None].into_iter().flatten();
    };
    let far = (share > LITTLE_SLIP).then(|| {
        let message = format!(
            "the surfaces have slid by {slid:.3e} since the start, {:.1} % of the distance between nodes, but small \
             sliding keeps the initial projections: tractions that vary from node to node are wrong by about as much",
            100.0 * share
        );
        (Kind::SlidFar, message)
    });
    let turned = (turned > LITTLE_TURN).then(|| {
        let message = format!(
            "a surface has rotated by {turned:.3} rad since the start, but small sliding keeps its direction: \
             tractions are wrong by about {:.1} % of the pressure",
            100.0 * turned
        );
        (Kind::TurnedFar, message)
    });
    let stretched = (stretched > LITTLE_TURN).then(|| {
        let message = format!(
            "an edge of the slave has become {:.1} % longer or shorter since the start, but small sliding keeps its \
             length: tractions are wrong by as much",
            100.0 * stretched
        );
        (Kind::StretchedFar, message)
    });
    [far, turned, stretched].into_iter().flatten()
}
