//! Why a static step may have no equilibrium further on: loads at their limit point; friction, bonds or the resistance of a ridge that fall
//! faster than what drives them gives way.

use nalgebra::Vector2;

use super::failure::IncrementFailure;
use crate::contact::{ContactPair, ContactState, SlavePoint};
use crate::laws::friction::{Cohesion, Regime};
use crate::linear::norm;
use crate::model::text::number;
use crate::model::warnings::fragile;
use crate::model::{Model, State, Step};

/// Growth of the rate of displacement over its mean in the step, from which it has begun to run away.
const RUNS_AWAY: f64 = 2.0;

/// Says why a static step may have no equilibrium further on, before a semicolon; empty unless something has begun to run away.
pub fn limit(model: &Model, step: &Step, state: &State, cause: &IncrementFailure) -> String {
    if !matches!(cause, IncrementFailure::Newton(_) | IncrementFailure::Torn { .. }) || step.scheme.is_dynamic() {
        return String::new();
    }
    let contacts = model.contacts.iter().zip(&state.contacts).filter(|(pair, _)| step.joins(pair));
    let of_contact = |(pair, states): (&ContactPair, &Vec<ContactState>)| {
        let slip = unstable_slip(step, state, pair, states).unwrap_or_default();
        slip + &tears(step, state, pair, states) + &snaps(pair, states)
    };
    limit_point(step, state) + &contacts.map(of_contact).collect::<String>()
}

/// A limit point under forces, with what its loads had reached, if displacements have begun to run away from them.
fn limit_point(step: &Step, state: &State) -> String {
    let loads = growing_loads(step, state.time);
    let Some(last) = state.last_increment.as_ref().filter(|_| !loads.is_empty()) else { return String::new() };
    let so_far = state.displacement.iter().zip(&state.step_start.displacement).map(|(u, before)| (u - before).powi(2));
    let mean = so_far.sum::<f64>().sqrt() / (state.time - step.span.start);
    if norm(&last.displacement) / last.dt < RUNS_AWAY * mean {
        return String::new();
    }
    format!(
        "this may be a limit point, the largest load that the structure carries, since displacements grow ever faster \
         than the loads: {} had been reached; prescribe displacements instead of forces to go on; ",
        loads.join(" and ")
    )
}

/// Lists the loads that vary in a step: their values at a time and their targets; of each kind the one that varies most.
fn growing_loads(step: &Step, time: f64) -> Vec<String> {
    let loads = &step.loads;
    let dead = loads.dead.iter().filter_map(|load| {
        let place = load.weights.first()?.position;
        Some((["load along x", "load along y"][load.component], &load.amplitude, place))
    });
    let pressures = loads.pressures.iter().map(|load| ("pressure", &load.amplitude, Vector2::zeros()));
    let moments = loads.moments.iter().map(|load| ("moment", &load.amplitude, Vector2::zeros()));
    let mut most: Vec<(&str, [f64; 2])> = Vec::new();
    for (kind, amplitude, place) in dead.chain(pressures).chain(moments) {
        let [start, now, end] = [step.span.start, time, step.span.end].map(|time| amplitude.value(place, time));
        if start == end || !(end - start).is_finite() {
            continue;
        }
        match most.iter_mut().find(|(known, _)| *known == kind) {
            None => most.push((kind, [now, end])),
            Some((_, values)) if end.abs() > values[1].abs() => *values = [now, end],
            Some(_) => {}
        }
    }
    most.iter().map(|(kind, [now, end])| format!("{kind} {} of {}", number(*now), number(*end))).collect()
}

/// Share of the closed length that slips from which on a contact slides as a whole.
const SLIDES: f64 = 0.5;

/// Length of a slipping zone from which on linear slip weakening is unstable between half-spaces, over G*/(p |dμ/dδ|). Source: Uenishi &
/// Rice (2003), J. Geophys. Res. 108, 2042.
const NUCLEATION: f64 = 1.158;

/// Slip that may be unstable: of a zone of L > 1.158 G* L/W under friction that weakens by W = Σ (|dμ/dδ| p + (c − c_r)/D) ℓ over the length L
/// of the points that slip, the second where a bond is not used up; or of a contact that slides as a whole and ever faster.
fn unstable_slip(step: &Step, state: &State, pair: &ContactPair, states: &[ContactState]) -> Option<String> {
    let (mut length, mut slipping, mut weakening, mut now, mut so_far) = (0.0, 0.0, 0.0, 0.0, 0.0);
    let mut what = "friction weakens";
    for (slave, point) in pair.points.iter().zip(states).filter(|(_, point)| point.is_closed()) {
        length += point.length;
        if point.regime() != Regime::Slip {
            continue;
        }
        let law = pair.ask_law(slave, [state.time; 2], |law| law.description).ok()?;
        slipping += point.length;
        weakening += law.weakening * point.friction.pressure * point.length;
        let softening = softening(pair, slave, point);
        if softening > 0.0 {
            weakening += softening * point.length;
            what = "friction and bond weaken";
        }
        now += point.friction.plastic_increment.abs() * point.length / state.dt;
        so_far += point.friction.plastic_slip.abs() * point.length / (state.time - step.span.start);
    }
    let nucleates = pair.modulus > 0.0 && weakening > NUCLEATION * pair.modulus;
    let slides = slipping > SLIDES * length && now > RUNS_AWAY * so_far;
    let why = if weakening > 0.0 {
        format!(
            "where it slips, {what} by up to {} per slip (force over length); if the bodies and their loading are softer \
             than that, no static equilibrium follows",
            number(weakening)
        )
    } else {
        "it slides ever faster, and its friction does not weaken; where its resistance falls as it slides, over a ridge or \
         off an end, no static equilibrium follows"
            .into()
    };
    (nucleates || slides).then(|| {
        format!(
            "slip of contact `{}` may be unstable here: {why}: take a dynamic step (\"hht\"), with densities and with a \
             `dt.min` that resolves fast slip; ",
            pair.name
        )
    })
}

/// (c − c_r)/D of a point whose bond slip has not used up; 0 without one [F/L³]
fn softening(pair: &ContactPair, slave: &SlavePoint, point: &ContactState) -> f64 {
    match (&pair.law(slave).cohesion, &point.bond) {
        (Some(Cohesion::Parallel(bond)), Some(state)) if bond.intact(state) > 0.0 => {
            (bond.strength() - bond.residual()) / bond.slip()
        }
        _ => 0.0,
    }
}

/// Share of its strength from which on a bond is about to slip [-]
const NEARLY: f64 = 0.9;

/// A bond that pulls with nearly all of its strength, or is partly torn, under forces that grow: once it tears it bears less.
fn tears(step: &Step, state: &State, pair: &ContactPair, states: &[ContactState]) -> String {
    let pulls = |(slave, point): (&SlavePoint, &ContactState)| match (&pair.law(slave).cohesion, &point.bond) {
        (Some(Cohesion::Parallel(bond)), Some(state)) => {
            let intact = bond.intact(state);
            intact > 0.0 && state.tension > 0.0 && (intact < 1.0 || state.tension > NEARLY * bond.tension())
        }
        _ => false,
    };
    let loads = growing_loads(step, state.time);
    if loads.is_empty() || !pair.points.iter().zip(states).any(pulls) {
        return String::new();
    }
    format!(
        "the bond of contact `{}` has reached its tensile strength under growing loads ({} had been reached): once it \
         tears it carries less, and there may be no static equilibrium under more load: prescribe the displacement of \
         the loaded side instead (`until` ends a step at a force), or take a step with inertia; ",
        pair.name,
        loads.join(" and ")
    )
}

/// Strength without pressure that falls faster than an element follows, where a point has come to it.
fn snaps(pair: &ContactPair, states: &[ContactState]) -> String {
    let opens = |point: &ContactState| point.carries_open() || point.regime() == Regime::Slip;
    let slips = |(slave, point): (&SlavePoint, &ContactState)| match (&pair.law(slave).cohesion, &point.bond) {
        (Some(Cohesion::Parallel(bond)), Some(state)) => {
            bond.intact(state) > 0.0 && state.traction.abs() > NEARLY * bond.strength_left(state)
        }
        _ => false,
    };
    let [opening, slip] = fragile(pair);
    let opening = opening.filter(|_| states.iter().any(opens));
    let slip = slip.filter(|_| pair.points.iter().zip(states).any(slips));
    opening.into_iter().chain(slip).map(|why| format!("contact `{}`: {why}; ", pair.name)).collect()
}
