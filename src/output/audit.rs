//! Energy balance of a run, and remedies for an energy error.
//!
//! ```text
//! error = initial + external work − (kinetic + strain + contact) − dissipation                  0 if all is resolved
//! ```
//!
//! The error is measured relative to the energy available for storage or dissipation: initial energy and external work, or what an
//! initial stress sets free. A motion that gains more than all of it is an instability of the increments.
//!
//! # Energy in contact penalties
//!
//! An exact contact stores no energy along its normal, and none while it sticks. The energy stored in the penalties, relative
//! to the elastic energy of bodies and contacts when that was largest, measures the error of the penalty method; as p²/2α_n it
//! falls with the penalty. Where bodies start under stress and contacts under tractions, what has changed since counts:
//!
//! ```text
//! strain energy − f(σ₀)·u = ½ ∫ Δσ:ε dV,   (p − p₀)²/2α_n                  f(σ₀): forces of the initial stress
//! ```
//! the energy measured from a stress that stays is first order in u, of any sign, and says nothing of how far bodies give way.
//!
//! # Edges that stand for curves
//!
//! Where a convex side lies in a concave one, straight edges of other lengths leave a mean gap a between them that the curves do not have
//! ([`crate::contact::surface::Surface::by_chords`]). Bodies under the forces f of the contact move to close it:
//!
//! ```text
//! δu/u = |∫ p a dA| / 2W                                                       W: elastic energy when that was largest
//! ```
//!
//! The work of a static increment is that of its mean force. Where surfaces close within it they act in a part of it alone, which the
//! balance does not see: the states at its ends are right all the same. Such errors are counted for themselves, and all others without them.

use nalgebra::Vector2;

use crate::contact::mortar::Mortar;
use crate::contact::pair::{BothSurfaces, ContactPair};
use crate::contact::{ContactState, Master};
use crate::equations::contacts::Springs;
use crate::mesh::configuration::vector;
use crate::model::balance;
use crate::model::coupled::{CoupledPart, CoupledParts};
use crate::model::scheme::{Scheme, time_text};
use crate::model::{Model, State, Step};
use crate::run::error::Error;
use serde::{Deserialize, Serialize};

/// Energy error that causes a warning, as a fraction of the energy supplied.
const WORTH_TELLING: f64 = 0.01;

/// Part of a step's error that arises in one increment where shorter ones may not help [-]
const AT_ONCE: f64 = 0.5;

/// Errors within this multiple of the work of round-off in the forces are ignored.
const ROUND_OFF: f64 = 100.0;

/// Energy balance of the run so far.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Audit {
    /// Largest energy supplied [F·L]
    pub supplied: f64,
    /// Error at the last row [F·L]
    error: f64,
    /// That of static increments in which surfaces closed or parted
    touch: Arisen,
    /// That of all others
    rest: Arisen,
    /// External work, all of it taken as positive [F·L]
    work: f64,
    /// Contribution of every step to the error
    steps: Vec<StepError>,
    /// Error that arose in all increments in which masses have inertia, and its largest gain [F·L]
    moving: f64,
    gained: f64,
    /// Possible work of round-off in the forces [F·L]
    noise: f64,
    /// Largest error of the balance of water, and largest volume that has come or gone [L³]
    water: [f64; 2],
    /// Energy in the contact penalties
    pub give: Give,
    /// Parts of the model, once asked for: they take a look at every element
    #[serde(skip)]
    scales: Option<Vec<Scales>>,
    /// Initial stress of the bodies that are there from the start, once asked for
    #[serde(skip)]
    stresses: Option<Vec<Stress>>,
    /// By how much edges that stand for curves close the gap of each contact, once asked for [L]
    #[serde(skip)]
    chords: Option<Vec<f64>>,
}

/// Energy error that has arisen in some of the increments.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Arisen {
    /// So far [F·L]
    error: f64,
    /// When that was largest [F·L], [T]
    worst: [f64; 2],
    /// The most that arose in one of them [F·L], and its end [T]
    most: [f64; 2],
}

impl Arisen {
    fn add(&mut self, arose: f64, time: f64) {
        self.error += arose;
        let further = |value: f64, [so_far, at]: [f64; 2]| {
            if value.abs() > so_far.abs() || value.is_nan() { [value, time] } else { [so_far, at] }
        };
        self.worst = further(self.error, self.worst);
        self.most = further(arose, self.most);
    }

    /// Where half of it or more arose in one increment, and by its length did not need to: what else may be the cause.
    fn at_once(&self) -> String {
        let [most, at] = self.most;
        if most / self.error < AT_ONCE {
            return String::new();
        }
        format!(
            ", unless the {:.0} % that arose in the increment to t = {} remain: where a load or support jumps, let it \
             grow over several increments; where bodies snap through or break away, a step with inertia keeps the \
             energy that a static one drops",
            100.0 * most / self.error,
            time_text(at)
        )
    }
}

/// Forces of the initial stress of a body on its nodes [F].
#[derive(Clone, Debug)]
struct Stress {
    body: usize,
    forces: Vec<(usize, Vector2<f64>)>,
}

/// What the round-off of the forces on a part of a model goes by; the parts do not act on each other.
#[derive(Clone, Debug)]
struct Scales {
    part: CoupledPart,
    /// Largest stiffness of an element [F/L]
    stiffness: f64,
    /// Numbers of its contacts
    contacts: Vec<usize>,
}

impl Scales {
    /// Those of all parts of a model.
    fn of(model: &Model) -> Vec<Self> {
        let CoupledParts { parts, of_node } = CoupledParts::of(model);
        let scales = |part| Self { part, stiffness: 0.0, contacts: Vec::new() };
        let mut all: Vec<Self> = parts.into_iter().map(scales).collect();
        for (e, element) in model.mesh.elements.iter().enumerate() {
            let own = &mut all[of_node[element.nodes[0]]];
            own.stiffness = own.stiffness.max(model.element_stiffness(e));
        }
        for (k, pair) in model.contacts.iter().enumerate() {
            pair.slave_nodes().take(1).for_each(|node| all[of_node[node]].contacts.push(k));
        }
        all
    }
}

/// Energy error of a step.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct StepError {
    step: String,
    /// Error that arose in its increments, but by touch
    own: Arisen,
    remedy: String,
}

/// Remedy for the energy of static steps.
const STATIC: &str = "take shorter increments (dt.initial, dt.max)";

/// The same where the master has corners: forces act along the normal of the slave, but next to a corner of its own.
const STATIC_CORNERS: &str = "where a corner of the master is dragged, less is lost or gained with slave and master exchanged; else take shorter \
                              increments (dt.initial, dt.max)";

/// Remedy for the energy that a scheme damps.
const DAMPS: &str =
    "the scheme damps frequencies that the increments do not resolve: take shorter increments (dt.error)";

/// The same where energy is gained.
const GAINS: &str = "the increments are too long for the motion, or for surfaces that close or part within them: take shorter increments (dt.error)";

/// Remedy for the energy of a static first step in which surfaces begin to push each other apart.
const OVERLAP: &str = "surfaces that overlap at the start set energy free: bring the overlap in over the step (shrink_fit), or move \
                       them apart; if it is not theirs, take shorter increments (dt.initial, dt.max)";

/// Fraction of the elastic energy of bodies and contacts that was stored in contact penalties when that energy was largest.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Give {
    /// Elastic energy [F·L]
    elastic: f64,
    /// Its time [T]
    time: f64,
    /// Share in the penalties, contact by contact
    penalties: Vec<Penalties>,
}

/// Energy in the penalties of a contact.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Penalties {
    contact: String,
    /// Along the normal, and the tangent [F·L]
    energy: [f64; 2],
    /// α_n and the least α_t [F/L³]
    stiffness: [f64; 2],
    /// Whether bodies are behind its points, that would give way instead
    on_bodies: bool,
    /// Whether the bodies are under stress at the start, and its surfaces are not
    starts_free: bool,
    /// Whether a largest penetration may be asked for
    by_steps: bool,
    /// Whether its slave has mass in implicit steps, which a stiffer penalty would make ring
    rings: bool,
    /// By how much edges that stand for curves close its gap, in the mean [L]
    chords: f64,
    /// Work of its pressure on that way [F·L]
    by_chords: f64,
}

/// Energy error by touch that causes a warning, as a fraction of the work of the run.
const BY_TOUCH: f64 = 0.05;

/// Change of the tractions that a contact starts under which is none, squared [-]
const REST: f64 = 1e-6;

/// Share of the elastic energy in penalties that is worth a warning [-]
const GIVES_WAY: f64 = 0.01;

/// Error of displacements by edges that stand for curves that causes a warning [-]
const BY_CHORDS: f64 = 0.02;

/// Error of the balance of water that causes a warning, as a fraction of what has come and gone [-]
const WATER: f64 = 1e-5;

/// Least volume that counts as having come and gone, as a fraction of the bodies: none passes through sealed ones [-]
const SEALED: f64 = 1e-4;

/// Share of the energy that the advised penalties leave in the contacts [-]
const ADVISED: f64 = 0.004;

impl Audit {
    /// Records a row, given the state before it; returns the largest change of a component of a displacement [L].
    pub fn record(&mut self, model: &Model, step: &Step, old: &State, new: &State) -> f64 {
        let error = new.energy.error();
        self.supplied = self.supplied.max(new.energy.supplied());
        if self.steps.last().is_none_or(|last| last.step != step.name) {
            // Whatever the increments, surfaces that overlap at the start set free what nobody has supplied.
            let overlap = self.steps.is_empty() && old.time == 0.0 && !step.scheme.is_dynamic() && model.overlaps();
            let remedy = if overlap { OVERLAP } else { remedy(model, step) };
            let name = step.name.clone();
            self.steps.push(StepError { step: name, own: Arisen::default(), remedy: remedy.into() });
        }
        let arose = error - self.error;
        if step.scheme.is_dynamic() {
            self.moving += arose;
            self.gained = self.gained.max(-self.moving);
        }
        let overlaps = self.steps.last().is_some_and(|step| step.remedy == OVERLAP);
        if matches!(step.scheme, Scheme::Static) && !overlaps && touches(old, new) {
            self.touch.add(arose, new.time);
        } else {
            self.rest.add(arose, new.time);
            self.steps.iter_mut().next_back().into_iter().for_each(|last| last.own.add(arose, new.time));
        }
        self.work += (new.energy.external_work - old.energy.external_work).abs();
        self.error = error;
        if let Some([error, throughput]) = model.balance_of_water(new) {
            let bodies = model.flow.as_ref().map_or(0.0, |flow| flow.volume);
            self.water = [self.water[0].max(error.abs()), self.water[1].max(throughput).max(SEALED * bodies)];
        }
        let stresses = self.stresses.get_or_insert_with(|| stresses(model));
        let chords = self.chords.get_or_insert_with(|| model.contacts.iter().map(|pair| chords(model, pair)).collect());
        self.give.record(model, new, stresses, chords);
        let mut farthest = 0.0f64;
        for scales in self.scales.get_or_insert_with(|| Scales::of(model)) {
            let (mut reach, mut way) = (0.0f64, 0.0f64);
            for nodes in &scales.part.nodes {
                let dofs = 2 * nodes.start..2 * nodes.end;
                let own = largest([&old.displacement[dofs.clone()], &new.displacement[dofs]]);
                (reach, way) = (reach.max(own[0]), way.max(own[1]));
            }
            self.noise += round_off(model, scales, new, reach) * way;
            farthest = farthest.max(way);
        }
        farthest
    }

    /// Warnings at the end of a run: that the energies do not balance, or contacts give way.
    pub fn concerns(&self) -> Vec<String> {
        let unbalanced = self.unbalanced().filter(|_| !self.is_unstable());
        unbalanced.into_iter().chain(self.by_touch()).chain(self.water_lost()).chain(self.give.concerns()).collect()
    }

    /// Water that has come from nowhere, or gone there.
    fn water_lost(&self) -> Option<String> {
        let [error, throughput] = self.water;
        (error > WATER * throughput).then(|| {
            format!(
                "the balance of water in the bodies is off by {error:.3e}, {:.1e} of what has come and gone: take a smaller newton.tolerance",
                error / throughput
            )
        })
    }

    /// Checks at the end of a run that no motion gained more energy than was supplied.
    ///
    /// # Errors
    /// Returns [`Error::Unstable`] with the energies, the step and a remedy.
    pub fn check(&self) -> Result<(), Error> {
        self.unbalanced().filter(|_| self.is_unstable()).map_or(Ok(()), |unbalanced| Err(Error::Unstable(unbalanced)))
    }

    fn is_unstable(&self) -> bool {
        self.gained > self.supplied
    }

    /// Largest error that is not reported [F·L]
    fn allowed(&self) -> f64 {
        (WORTH_TELLING * self.supplied).max(ROUND_OFF * self.noise)
    }

    fn unbalanced(&self) -> Option<String> {
        let [worst, time] = self.rest.worst;
        if worst.abs() <= self.allowed() {
            return None;
        }
        let step = self.steps.iter().max_by(|a, b| a.own.error.abs().total_cmp(&b.own.error.abs()))?;
        let (name, remedy) = (&step.step, step.remedy());
        let fate = if worst < 0.0 { "gain" } else { "loss" };
        let share = if self.supplied > 0.0 {
            let percent = 100.0 * worst.abs() / self.supplied;
            format!(
                "{percent:.3} % of the {:.3e} supplied (initial energy + external work, or freed by initial stress)",
                self.supplied
            )
        } else {
            "with nothing supplied (initial energy + external work, or freed by initial stress)".into()
        };
        Some(format!(
            "energy balance violated by t = {}: spurious {fate} of {:.3e}, {share}, mostly in step `{name}`: {remedy}",
            time_text(time),
            worst.abs()
        ))
    }
}

impl StepError {
    /// What ends the error: shorter increments do not where it arises at once, whatever their length, and nothing is damped where energy is gained.
    fn remedy(&self) -> String {
        match &*self.remedy {
            STATIC => format!("{STATIC}{}", self.own.at_once()),
            DAMPS if self.own.error < 0.0 => GAINS.into(),
            remedy => remedy.into(),
        }
    }
}

impl Audit {
    /// Warning about the error that came by touch.
    fn by_touch(&self) -> Option<String> {
        let ([touch, time], work) = (self.touch.worst, self.work.max(self.supplied));
        (work > 0.0 && touch.abs() > self.allowed().max(BY_TOUCH * work)).then(|| {
            format!(
                "surfaces close or part within increments, whose work is uncertain by {:.3e} by t = {}, {:.1} % of the \
                 work of the run: displacements and forces at the ends of increments are not affected, but energies \
                 are; where these matter, take shorter increments as they close (dt.initial, dt.max){}",
                touch.abs(),
                time_text(time),
                100.0 * touch.abs() / work,
                self.touch.at_once()
            )
        })
    }
}

/// Whether points of contacts close or part from one state to the next.
fn touches(old: &State, new: &State) -> bool {
    let mut points = old.contacts.iter().flatten().zip(new.contacts.iter().flatten());
    points.any(|(old, new)| old.is_closed() != new.is_closed())
}

/// Initial stress of the bodies that are there from the start.
fn stresses(model: &Model) -> Vec<Stress> {
    let from_start =
        |body: &usize| model.bodies[*body].is_stressed() && model.steps.first().is_some_and(|step| step.has(*body));
    let bodies = (0..model.bodies.len()).filter(from_start);
    bodies.map(|body| Stress { body, forces: balance::of_stress(model, body) }).collect()
}

/// By how much straight edges that stand for a convex and a concave side close the gap between them by mortar, in the mean [L]. A contact that
/// starts closed counts gaps from where its surfaces are, and of a shrink fit this is reported before the run.
fn chords(model: &Model, pair: &ContactPair) -> f64 {
    let counts = pair.mortar.is_some() && !pair.tied && !pair.is_own() && pair.initial.is_none();
    match (&pair.master, &pair.both) {
        (Master::Mesh(master), Some(BothSurfaces { slave: Master::Mesh(slave), .. }))
            if counts && !pair.is_offset() =>
        {
            let [slave, master] = [slave, master].map(|surface| surface.by_chords(&model.mesh.undeformed()));
            if slave * master < 0.0 { slave + master } else { 0.0 }
        }
        _ => 0.0,
    }
}

/// Elastic energy of bodies and contacts, of what has changed since the start [F·L]. Tractions whose change the bodies bear deform
/// at least the elements behind them, (p − p₀)²/2 h/(λ + 2G): where less is stored, the start was out of balance at the surfaces
/// alone, as edges are that stand for a curve, and the penalties only take that up.
fn changed(model: &Model, state: &State, stresses: &[Stress]) -> f64 {
    let there = stresses.iter().filter(|stress| state.has(stress.body)).flat_map(|stress| &stress.forces);
    let first_order: f64 = there.map(|(node, force)| force.dot(&vector(&state.displacement, *node))).sum();
    let mut elastic = state.energy.strain - first_order + state.energy.contact_elastic;
    let mut behind = 0.0;
    let closed = |pair: &ContactPair| pair.initial.is_some() || pair.comes_stressed;
    for (pair, states) in model.contacts.iter().zip(&state.contacts).filter(|(pair, _)| closed(pair)) {
        let Springs { stored, changed, numerical } = Springs::of(pair, states);
        elastic += changed.max(REST * stored) - stored;
        behind += numerical[0] * pair.alpha_n * pair.compliance;
    }
    elastic.max(behind)
}

impl Give {
    fn record(&mut self, model: &Model, state: &State, stresses: &[Stress], chords: &[f64]) {
        let elastic = changed(model, state, stresses);
        if elastic <= self.elastic {
            return;
        }
        let explicit = |step: &Step| matches!(step.scheme, Scheme::Explicit { .. } | Scheme::QuasiDynamic { .. });
        let solved = !model.steps.iter().any(|step| step.rupture.is_some() || explicit(step));
        let has_mass = |pair: &ContactPair| {
            pair.points.iter().any(|point| point.position.iter().any(|&(node, _)| !model.massless[node]))
        };
        let moves = solved && model.steps.iter().any(|step| step.scheme.is_dynamic());
        let force =
            |states: &[ContactState]| states.iter().map(|state| state.friction.pressure * state.length).sum::<f64>();
        let of = |((pair, states), &chords): ((&ContactPair, &Vec<ContactState>), &f64)| Penalties {
            chords,
            by_chords: chords * force(states),
            contact: pair.name.clone(),
            energy: Springs::of(pair, states).numerical,
            stiffness: [
                pair.alpha_n,
                pair.laws.iter().map(|law| law.description.stiffness).fold(f64::INFINITY, f64::min),
            ],
            on_bodies: pair.compliance > 0.0,
            starts_free: pair.initial.is_none()
                && !pair.comes_stressed
                && pair.bodies.iter().flatten().any(|&body| model.bodies[body].is_stressed()),
            by_steps: solved,
            rings: moves && !pair.tied && has_mass(pair),
        };
        self.penalties = model.contacts.iter().zip(&state.contacts).zip(chords).map(of).collect();
        (self.elastic, self.time) = (elastic, state.time);
    }

    /// Fraction stored in penalties, if any energy was stored [-]
    pub fn share(&self) -> Option<f64> {
        let penalties: f64 = self.penalties.iter().flat_map(|of| of.energy).sum();
        (self.elastic > 0.0).then(|| penalties / self.elastic)
    }

    /// Warnings about contacts that give way, with what to give for less, and about edges that do not follow their curves.
    fn concerns(&self) -> Vec<String> {
        let bodies = self.penalties.iter().filter(|of| of.on_bodies);
        let give_way = bodies.flat_map(|of| [0, 1].into_iter().filter_map(|way| self.concern(of, way)));
        give_way.chain(self.penalties.iter().filter_map(|of| self.concern_of_chords(of))).collect()
    }

    fn concern_of_chords(&self, Penalties { contact, chords, by_chords, .. }: &Penalties) -> Option<String> {
        let share = by_chords.abs() / (2.0 * self.elastic);
        let what = if *chords < 0.0 { "leave a gap" } else { "make an overlap" };
        (share > BY_CHORDS).then(|| {
            format!(
                "contact `{contact}`: straight edges that approximate curves {what} of {:.3e} in the mean, so that \
                 displacements, or forces where these are prescribed, are off by some {:.0} %; take quadratic \
                 elements, edges of equal length on both sides, or shorter ones",
                chords.abs(),
                100.0 * share
            )
        })
    }

    fn concern(
        &self,
        Penalties { contact, energy, stiffness, starts_free, by_steps, rings, .. }: &Penalties,
        way: usize,
    ) -> Option<String> {
        let share = energy[way] / self.elastic;
        let advised = rounded_up(stiffness[way] * share / ADVISED);
        let massless = if *rings { "\"massless\": true, as a stiff penalty oscillates on mass, and " } else { "" };
        let key = [format!("{massless}\"alpha_n\": {advised}"), format!("\"alpha_t\": {advised}")];
        // Multipliers on surfaces that have mass gain energy.
        let or = [("penetration", *by_steps && !rings), ("stick", *by_steps)]
            .map(|(key, helps)| if helps { format!(", or `{key}`") } else { String::new() });
        let start =
            if *starts_free { "start it under the stress of the bodies (`initial`, `of_bodies`), or " } else { "" };
        let what = ["lets the surfaces penetrate", "lets surfaces slip that should stick"];
        (share > GIVES_WAY).then(|| {
            format!(
                "contact `{contact}`: at t = {} {:.1} % of the elastic energy is in its penalty, which {}: displacements \
                 and forces are off by about as much; {start}give it {}{}",
                time_text(self.time),
                100.0 * share,
                what[way],
                key[way],
                or[way]
            )
        })
    }
}

/// Rounded up to one digit.
fn rounded_up(value: f64) -> String {
    let unit = 10f64.powf(value.log10().floor());
    format!("{:.0e}", (value / unit).ceil() * unit)
}

/// The largest |u₁| and |u₁ − u₀|, what is no number left out. Some at a time: each maximum alone waits for the one before.
fn largest([old, new]: [&[f64]; 2]) -> [f64; 2] {
    const TOGETHER: usize = 8;
    let most = |most: f64, value: f64| if value > most { value } else { most };
    let (mut reach, mut way) = ([0.0; TOGETHER], [0.0; TOGETHER]);
    let ((olds, old_rest), (news, new_rest)) = (old.as_chunks::<TOGETHER>(), new.as_chunks::<TOGETHER>());
    for (old, new) in olds.iter().zip(news) {
        for k in 0..TOGETHER {
            reach[k] = most(reach[k], new[k].abs());
            way[k] = most(way[k], (new[k] - old[k]).abs());
        }
    }
    for (old, new) in old_rest.iter().zip(new_rest) {
        (reach[0], way[0]) = (most(reach[0], new.abs()), most(way[0], (new - old).abs()));
    }
    [reach, way].map(|all| all.into_iter().fold(0.0, f64::max))
}

/// Round-off of the forces on a part whose displacements reach so far [F].
fn round_off(model: &Model, Scales { part, stiffness, contacts }: &Scales, state: &State, reach: f64) -> f64 {
    let of = |&k: &usize| state.contacts[k].iter().map(move |contact| model.contacts[k].alpha_n * contact.length);
    let count: usize = part.nodes.iter().map(ExactSizeIterator::len).sum();
    let stiffest = contacts.iter().flat_map(of).fold(*stiffness, f64::max);
    f64::EPSILON * stiffest * part.size.max(reach) * (count as f64).sqrt()
}

/// Whether a master has corners that may press between the means of a slave's edges.
fn has_corners(model: &Model) -> bool {
    model.contacts.iter().filter_map(|pair| pair.mortar.as_ref()).any(Mortar::has_corners_of_master)
}

/// Remedy for an energy error in a step.
fn remedy(model: &Model, step: &Step) -> &'static str {
    let keeps_all = match step.scheme {
        Scheme::Static if has_corners(model) => return STATIC_CORNERS,
        Scheme::Static => return STATIC,
        Scheme::QuasiDynamic { .. } => return "take fewer steps per row of results (quasi_dynamic.every)",
        Scheme::Explicit { .. } => return "lower the safety of the explicit scheme",
        Scheme::Wilson { .. } => {
            return "wilson overshoots sudden changes that the increments do not resolve, and damps the rest of such motions: take \
                    another scheme (generalized_alpha), or shorter increments (dt.max)";
        }
        Scheme::Newmark { gamma, .. } => gamma == 0.5,
        Scheme::Hht { alpha } => alpha == 0.0,
        Scheme::GeneralizedAlpha { rho_infinity } => rho_infinity == 1.0,
    };
    let explicit = |step: &Step| step.rupture.is_some() || matches!(step.scheme, Scheme::Explicit { .. });
    let may_be_massless = model.contacts.iter().any(|pair| pair.compliance > 0.0 && !pair.tied);
    let solids = model.mesh.nodes.len() - model.mesh.water_nodes;
    let rings = may_be_massless && !model.massless[..solids].contains(&true) && !model.steps.iter().any(explicit);
    if rings && model.contacts.iter().any(|pair| pair.penetration.is_some()) {
        return "multipliers on surfaces that have mass gain energy from impacts, the more the shorter the increments: make \
                the contact `massless`, or leave `penetration` out";
    }
    match (keeps_all, rings) {
        (true, true) => {
            "impact excites oscillations that the increments do not resolve: make the contact `massless`, and take shorter increments \
             (dt.error), or against a gain a scheme that damps (hht)"
        }
        (true, false) => {
            "take shorter increments (dt.error), or against a gain a scheme that damps frequencies that they do not resolve (hht)"
        }
        (false, true) => {
            "frequencies that the increments do not resolve are damped, or excited by impact: make the contact `massless`, \
             and take shorter increments (dt.error)"
        }
        (false, false) => DAMPS,
    }
}
