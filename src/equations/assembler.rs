//! Residual and tangent of a model as the sum of its terms.
//!
//! The assembler evaluates the responses of the contacts and stores their states.
//!
//! Parts of the equations can be assembled separately: the masses, and the tangent of one term.

use std::sync::Arc;
use std::time::Instant;

use crate::contact::pair::Prediction;
use crate::contact::response::{LastAnswers, PairResponse};
use crate::equations::convergence::{ConvergenceCriterion, missed};
use crate::equations::coupling::{Coupling, Layout};
use crate::equations::damping::ByMass;
use crate::equations::evaluation::{ContactCounts, Evaluation, Seconds};
use crate::equations::evolving::Evolving;
use crate::equations::inertia::{self, Inertia};
use crate::equations::solids::{LinearizedSolids, SolidForces, Solids};
use crate::equations::sums::{Sums, TrialFailure};
use crate::equations::term::{self, Term};
use crate::equations::trial::Trial;
use crate::equations::wet_elements::Beginning;
use crate::equations::{bars, contacts, damping, links, loads, pore_flow, supports};
use crate::linear::system::{Request, System};
use crate::linear::{SparseMatrix, norm};
use crate::model::{Activated, Model, State, Step};

/// Assembles a model; owns the pattern and reused buffers.
pub struct Assembler {
    pub(super) model: Arc<Model>,
    layout: Layout,
    /// Whether each body is absent; empty if all are there
    absent: Vec<bool>,
    /// Whether each bar is absent; empty if all are there
    bars_absent: Vec<bool>,
    /// Elements that came into a deformed model
    activated: Arc<Activated>,
    solids: Solids,
    linearization: Linearization,
    evolving: Evolving,
    /// What water begins the increment with
    beginning: Beginning,
    mass: Option<SparseMatrix>,
    /// η M of the bodies' damping, and the η of each body
    damping_mass: Option<ByMass>,
    /// w of prescribed dofs [F/L]
    weight: f64,
    /// Sum of the forces' magnitudes at each dof [F]
    pub(super) magnitudes: Vec<f64>,
    pub(super) equilibrium: ConvergenceCriterion,
    /// Responses of contacts without predictions, stored to reuse their memory
    responses: Vec<PairResponse>,
    /// Last answers of the laws of each contact
    pub(super) answered: Vec<LastAnswers>,
    /// Results at the last evaluated displacement
    pub evaluation: Evaluation,
    /// Time spent
    pub seconds: Seconds,
}

/// The displacement at which terms are evaluated, and the velocity where viscous forces of the bodies are evaluated with them.
#[derive(Clone, Copy)]
struct Motion<'a> {
    u: &'a [f64],
    v: Option<&'a [f64]>,
}

/// The forces of the bodies, linearized about a solution.
#[derive(Default)]
enum Linearization {
    #[default]
    None,
    /// To be found from the next tangent
    Wanted,
    Found(LinearizedSolids),
    /// What stands for the bodies in a residual near the solution
    Given(SolidForces),
}

impl Assembler {
    /// Numbers of contact points by status, as last evaluated.
    pub fn contact_counts(&self) -> ContactCounts {
        ContactCounts::of(&self.model.contacts, &self.evaluation.contacts)
    }

    /// Creates the assembler of a model.
    pub fn new(model: &Arc<Model>) -> Self {
        let activated = Arc::<Activated>::default();
        let solids = Solids::new(model, |_| true, &activated);
        Self {
            model: model.clone(),
            layout: Layout::new(model, term::unsymmetric(model)),
            absent: Vec::new(),
            bars_absent: Vec::new(),
            evolving: Evolving::new(model, solids.constant(), |_| true, &activated),
            beginning: Beginning::new(&activated),
            activated,
            solids,
            linearization: Linearization::None,
            mass: None,
            damping_mass: None,
            weight: supports::weight(model),
            magnitudes: vec![0.0; model.dofs()],
            equilibrium: ConvergenceCriterion::new(model, |_| true, None),
            responses: Vec::new(),
            answered: Vec::new(),
            evaluation: Evaluation::default(),
            seconds: Seconds::default(),
        }
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Turns to the bodies that are there in a step, as they came.
    fn attend(&mut self, step: &Step, old: &State) {
        let activations = &old.step_start.activations;
        if self.absent == step.absent && self.bars_absent == step.bars.absent && self.activated.are_of(activations) {
            return;
        }
        let model = &self.model;
        let activated = model.activated_of(activations);
        let are_there = |e: usize| step.has(model.body_of_element[e]);
        self.solids = Solids::new(model, are_there, &activated);
        self.evolving = Evolving::new(model, self.solids.constant(), are_there, &activated);
        self.equilibrium = ConvergenceCriterion::new(model, |body| step.has(body), Some(step));
        (self.mass, self.damping_mass, self.beginning) = (None, None, Beginning::new(&activated));
        self.evaluation.memory.clear();
        (self.absent, self.activated) = (step.absent.clone(), activated);
        self.bars_absent.clone_from(&step.bars.absent);
    }

    /// The current coupling of nodes.
    pub fn coupling(&self) -> Arc<Coupling> {
        self.layout.coupling.clone()
    }

    /// Restores a coupling of nodes.
    pub fn couple(&mut self, coupling: &Arc<Coupling>) {
        if self.layout.couple(coupling) {
            (self.mass, self.damping_mass) = (None, None);
        }
    }

    /// Couples nodes as another model with the same elements and nodes does.
    pub fn couple_as(&mut self, other: &Assembler) {
        if self.layout.take(&other.layout) {
            (self.mass, self.damping_mass) = (None, None);
        }
    }

    /// Creates a system on the current pattern.
    pub fn system(&self) -> System {
        System {
            residual: vec![0.0; self.model.dofs()],
            tangent: self.layout.matrix(),
            forces: 0.0,
            imbalance: f64::INFINITY,
        }
    }

    /// Computes the residual at the displacement `u`, without predictions, and measures it.
    ///
    /// # Errors
    /// Returns [`TrialFailure`] if an element inverts, a friction law fails, or a load has no finite value.
    pub fn residual(&mut self, trial: Trial, u: &[f64], system: &mut System) -> Result<(), TrialFailure> {
        self.with_responses(trial, u, Request::Residual, |assembler, responses| {
            assembler.assemble(trial, u, responses, Request::Residual, system)
        })?;
        self.measure(trial, u, system);
        Ok(())
    }

    /// Computes the residual near a solution about which the bodies may be linearized; it is measured by [`Assembler::share`].
    ///
    /// # Errors
    /// The same as for [`Assembler::residual`].
    pub fn residual_of_neighbour(
        &mut self,
        trial: Trial,
        u: &[f64],
        solids: Option<SolidForces>,
        system: &mut System,
    ) -> Result<(), TrialFailure> {
        self.linearization = solids.map_or(Linearization::None, Linearization::Given);
        let evaluated = self.with_responses(trial, u, Request::Residual, |assembler, responses| {
            assembler.set_out(trial.step, trial.old, responses, None);
            assembler.add(Term::OF_PLACE_AND_MOTION, trial, Motion { u, v: None }, responses, false, None)?;
            assembler.conclude(trial, u, responses, false, system)
        });
        self.linearization = Linearization::None;
        evaluated
    }

    /// Computes the residual and the tangent without predictions, and on request the linearized forces of the bodies: none where nodes
    /// follow others by their rotation, with which forces turn.
    ///
    /// # Errors
    /// The same as for [`Assembler::residual`].
    pub fn tangent(
        &mut self,
        trial: Trial,
        u: &[f64],
        linearize: bool,
        system: &mut System,
    ) -> Result<Option<LinearizedSolids>, TrialFailure> {
        let wanted = linearize && self.model.linkage.is_empty();
        self.linearization = if wanted { Linearization::Wanted } else { Linearization::None };
        let evaluated = self.with_responses(trial, u, Request::Tangent, |assembler, responses| {
            assembler.assemble(trial, u, responses, Request::Tangent, system)
        });
        let found = match std::mem::take(&mut self.linearization) {
            Linearization::Found(solids) => Some(solids),
            _ => None,
        };
        evaluated.map(|()| found)
    }

    /// Computes the residual, and the tangent on request, at the displacement `u` with the given responses of the contact
    /// points; [`Assembler::measure`] finds how far they are out of balance.
    ///
    /// # Errors
    /// Returns [`TrialFailure`] if an element inverts or a load has no finite value.
    pub fn assemble(
        &mut self,
        trial: Trial,
        u: &[f64],
        responses: &[PairResponse],
        request: Request,
        system: &mut System,
    ) -> Result<(), TrialFailure> {
        let (clock, tangent) = (Instant::now(), request == Request::Tangent);
        self.magnitudes.fill(0.0);
        let matrix = self.set_out(trial.step, trial.old, responses, tangent.then_some(&mut system.tangent));
        self.add(Term::OF_PLACE_AND_MOTION, trial, Motion { u, v: None }, responses, true, matrix)?;
        self.model.ties.gather(2, &mut self.magnitudes);
        self.model.linkage.gather_magnitudes(&mut self.magnitudes);
        self.conclude(trial, u, responses, tangent, system)?;
        self.equilibrium.note_contacts(&self.model, trial.stiffening, responses);
        self.equilibrium.retard(&self.model, trial.step);
        (system.forces, system.imbalance) = (norm(&self.magnitudes), f64::INFINITY);
        self.seconds.assembly += clock.elapsed().as_secs_f64();
        Ok(())
    }

    /// Turns to an increment; returns the matrix for its tangent, if that is wanted, with room for all contact points.
    fn set_out<'s>(
        &mut self,
        step: &Step,
        old: &State,
        responses: &[PairResponse],
        matrix: Option<&'s mut SparseMatrix>,
    ) -> Option<&'s mut SparseMatrix> {
        self.attend(step, old);
        self.evaluation.damping.clear();
        let matrix = matrix?;
        self.cover(step, old, responses);
        if !Arc::ptr_eq(&matrix.pattern, &self.layout.pattern) {
            *matrix = self.layout.matrix();
        }
        Some(matrix)
    }

    /// Makes of the sums of all terms the residual, and the tangent on request.
    fn conclude(
        &mut self,
        trial: Trial,
        u: &[f64],
        responses: &[PairResponse],
        tangent: bool,
        system: &mut System,
    ) -> Result<(), TrialFailure> {
        let model = &*self.model.clone();
        model.ties.gather(2, &mut self.evaluation.damping);
        model.linkage.gather(&mut self.evaluation.damping);
        self.store_states(responses);
        self.balance(trial, u, tangent, system);
        supports::prescribe(model, self.weight, trial, u, tangent, system)
    }

    /// Finds how far the residual just computed at `u` is out of balance, by the forces of the same evaluation.
    pub fn measure(&mut self, trial: Trial, u: &[f64], system: &mut System) {
        let clock = Instant::now();
        system.imbalance = self.imbalance(trial, u, &system.residual);
        self.seconds.assembly += clock.elapsed().as_secs_f64();
    }

    /// Returns the largest ‖r‖/‖f‖ of a part of the model, by the forces last evaluated, at the same displacement.
    pub fn imbalance(&self, trial: Trial, u: &[f64], residual: &[f64]) -> f64 {
        self.equilibrium.imbalance(&self.model, self.inert(trial.step), trial, u, &self.magnitudes, residual)
    }

    /// Returns the forces by which the residual of every part is measured with a tolerance, as last evaluated at the same displacement [F].
    pub fn measures(&self, trial: Trial, u: &[f64], tolerance: f64) -> Vec<f64> {
        self.equilibrium.measures(&self.model, self.inert(trial.step), trial, u, &self.magnitudes, tolerance)
    }

    /// Returns the largest residual of a part relative to its measure.
    pub fn share(&self, step: &Step, residual: &[f64], measures: &[f64]) -> f64 {
        self.equilibrium.largest(&self.model, step, residual, |number, _| measures[number])
    }

    /// Returns the distance from the prescribed motions, relative to the largest of them.
    pub fn missed(&self, trial: Trial, u: &[f64]) -> f64 {
        missed(&self.model, trial, u)
    }

    /// The mass, if the scheme counts inertia.
    pub(super) fn inert(&self, step: &Step) -> Option<&SparseMatrix> {
        self.mass.as_ref().filter(|_| step.scheme.coefficients().is_some())
    }

    /// Computes the forces that depend on the displacement `u` only, and everything else that an accepted state takes from the
    /// evaluation except rates, damping and reactions: the quantities needed by explicit increments, which find the velocities
    /// last. With velocities `v` the forces include the viscous ones of the bodies, which also replace the damping.
    ///
    /// # Errors
    /// The same as for [`Assembler::residual`].
    pub fn forces(&mut self, trial: Trial, u: &[f64], v: Option<&[f64]>) -> Result<(), TrialFailure> {
        self.with_responses(trial, u, Request::Residual, |assembler, responses| {
            let clock = Instant::now();
            assembler.attend(trial.step, trial.old);
            assembler.solids.retard(trial.step);
            // Balances of water are measured by the volumes that cancel in them.
            let scaled = assembler.model.flow.is_some();
            if scaled {
                assembler.magnitudes.fill(0.0);
            }
            assembler.add(Term::OF_PLACE, trial, Motion { u, v }, responses, scaled, None)?;
            if let Some(v) = v {
                assembler.add_viscous([u, v]);
            }
            assembler.store_states(responses);
            assembler.seconds.assembly += clock.elapsed().as_secs_f64();
            Ok(())
        })
    }

    /// Computes the balances of water alone, (4) of `pore_flow.rs`, at the displacement `u`, among the forces of the evaluation; on request
    /// their tangent is returned.
    ///
    /// # Errors
    /// The same as for [`Assembler::residual`].
    pub fn balances(
        &mut self,
        trial: Trial,
        u: &[f64],
        request: Request,
    ) -> Result<Option<SparseMatrix>, TrialFailure> {
        let model = self.model.clone();
        let between = model.contacts.iter().any(|pair| pair.seam.is_some());
        let terms: &[Term] = if between { &[Term::PoreFlow, Term::Interfaces] } else { &[Term::PoreFlow] };
        let add = |assembler: &mut Self, responses: &[PairResponse]| {
            assembler.attend(trial.step, trial.old);
            let mut tangent = (request == Request::Tangent).then(|| {
                assembler.cover(trial.step, trial.old, responses);
                assembler.layout.matrix()
            });
            assembler.evaluation.force.fill(0.0);
            assembler.add(terms, trial, Motion { u, v: None }, responses, false, tangent.as_mut())?;
            Ok(tangent)
        };
        if between { self.with_responses(trial, u, request, add) } else { add(self, &[]) }
    }

    /// Δt/β of the balances of water in an increment [T].
    pub fn span_of_water(trial: Trial) -> f64 {
        pore_flow::span(trial)
    }

    /// Residuals of the balances of water as last evaluated, and the magnitudes of their parts; both are empty where none flows [F].
    pub fn balanced(&self) -> [&[f64]; 2] {
        let first = self.model.flow.as_ref().map_or(self.model.dofs(), |flow| flow.dof(0));
        [&self.evaluation.force[first..], &self.magnitudes[first..]]
    }

    /// Adds the viscous forces of the bodies to the forces, and stores their nodal values as the damping.
    fn add_viscous(&mut self, motion: [&[f64]; 2]) {
        let Evaluation { force, damping, .. } = &mut self.evaluation;
        self.solids.other_viscous(motion, damping);
        self.model.ties.gather(2, damping);
        self.model.linkage.gather(damping);
        for (force, damping) in force.iter_mut().zip(damping) {
            *force += *damping;
            *damping = -*damping;
        }
    }

    /// Sums some terms into the evaluation and, on request, the tangent, and adds the forces' magnitudes. The contribution of a
    /// copy goes to its original node. For velocities, see [`Solids::add`].
    fn add(
        &mut self,
        terms: &[Term],
        trial: Trial,
        Motion { u, v }: Motion,
        responses: &[PairResponse],
        scaled: bool,
        mut tangent: Option<&mut SparseMatrix>,
    ) -> Result<(), TrialFailure> {
        let Self {
            model,
            layout,
            solids,
            linearization,
            evolving,
            beginning,
            damping_mass,
            magnitudes,
            evaluation,
            ..
        } = self;
        let Evaluation {
            force,
            loads,
            damping,
            stabilization,
            memory,
            bars: bar_states,
            water,
            strain_energy,
            dissipated,
            plastic,
            heating,
            ..
        } = evaluation;
        [&mut *force, &mut *loads, &mut *damping].into_iter().for_each(|values| values.resize(u.len(), 0.0));
        let magnitudes = scaled.then_some(&mut magnitudes[..]);
        if let Some(tangent) = &mut tangent {
            match solids.constant_stiffness(layout).filter(|_| terms.contains(&Term::Solids)) {
                Some(constant) => tangent.copy_values(constant),
                None => tangent.clear(),
            }
        }
        let mut sums = Sums { force, magnitudes, tangent, layout };
        for term in terms {
            match term {
                Term::Solids => {
                    let elastic = match linearization {
                        Linearization::Given(solids) => solids.add(&mut sums),
                        _ => solids.add(u, v, &mut sums)?,
                    };
                    if let (Linearization::Wanted, Some(tangent)) = (&linearization, &sums.tangent) {
                        *linearization = Linearization::Found(LinearizedSolids::of(u, sums.force, elastic, tangent));
                    }
                    let evolved = evolving.add(model, trial, u, memory, &mut sums)?;
                    *strain_energy = elastic + evolved.stored;
                    (*dissipated, *plastic, *heating) = (evolved.dissipated, evolved.plastic, evolved.heating);
                }
                Term::PoreFlow => {
                    let pressed = pore_flow::add(model, beginning, trial, u, water, memory, &mut sums)?;
                    *strain_energy += pressed.stored;
                    *heating += pressed.work;
                }
                Term::Interfaces => {
                    contacts::add(responses, &mut sums);
                    contacts::add_water(model, trial, responses, water);
                }
                Term::Bars => {
                    let found = bars::add(model, trial, u, bar_states, &mut sums);
                    *strain_energy += found.stored;
                    *plastic += found.plastic;
                    *heating += found.jacked;
                }
                Term::Loads => {
                    loads::add(model, trial, u, loads, &mut sums)?;
                    contacts::add_fluids(model, responses, loads);
                }
                Term::Dampers => damping::add_dampers(model, trial, u, damping, &mut sums)?,
                Term::Stabilization => *stabilization = damping::add_stabilization(trial, u, damping, &mut sums),
                Term::Damping => {
                    let momentum = damping::momentum(model, trial.step, layout, damping_mass);
                    damping::add_damping(model, solids, momentum, trial, u, damping, &mut sums);
                }
                // Added after all forces are known, with which it is blended.
                Term::Inertia => {}
            }
        }
        model.ties.gather(2, force);
        model.ties.gather(2, loads);
        model.linkage.gather(force);
        model.linkage.gather(loads);
        Ok(())
    }

    /// Combines forces, inertia, velocities, accelerations and reactions to the residual of the scheme.
    fn balance(&mut self, trial: Trial, u: &[f64], tangent: bool, system: &mut System) {
        let Self { model, layout, mass, absent, bars_absent, evaluation, magnitudes, .. } = self;
        let Evaluation { force, reactions, velocity, acceleration, .. } = evaluation;
        let constrained = links::relieved(model, u, force);
        reactions.clear();
        reactions.extend(trial.step.supports.iter().map(|support| support.at.of(&constrained)));
        let found = || inertia::mass(model, layout, [absent, bars_absent]);
        let mass = trial.step.scheme.coefficients().map(|_| &*mass.get_or_insert_with(found));
        let Some((mass, mut inertia)) = mass.and_then(|mass| Some((mass, Inertia::at(model, trial, u, mass)?))) else {
            [velocity, acceleration].into_iter().for_each(|rates| *rates = vec![0.0; u.len()]);
            system.residual.clone_from(force);
            return;
        };
        [&mut inertia.force, &mut inertia.weighted].into_iter().for_each(|forces| model.linkage.gather(forces));
        inertia.balance(&trial.old.force, force, &mut system.residual);
        if tangent {
            inertia.weigh(model, mass, &mut system.tangent);
        }
        magnitudes.iter_mut().zip(&inertia.force).for_each(|(magnitude, inertia)| *magnitude += inertia.abs());
        let constrained = links::relieved(model, u, &inertia.force);
        let supports = reactions.iter_mut().zip(&trial.step.supports);
        supports.for_each(|(reaction, support)| *reaction += support.at.of(&constrained));
        drop(constrained);
        (*velocity, *acceleration) = (inertia.velocity, inertia.acceleration);
    }

    /// Extends the pattern to all contact points.
    fn cover(&mut self, step: &Step, old: &State, responses: &[PairResponse]) {
        let marked = self.layout.mark(&term::unsymmetric_of(&self.model, step));
        if self.layout.cover(responses, old) || marked {
            (self.mass, self.damping_mass) = (None, None);
        }
    }
}

impl Assembler {
    /// Calls a function with the responses of all contact points without predictions.
    ///
    /// # Errors
    /// Returns [`TrialFailure`] if a friction law fails, and the errors of the function.
    pub fn with_responses<T>(
        &mut self,
        trial: Trial,
        u: &[f64],
        request: Request,
        act: impl FnOnce(&mut Self, &[PairResponse]) -> Result<T, TrialFailure>,
    ) -> Result<T, TrialFailure> {
        let mut responses = std::mem::take(&mut self.responses);
        let found = self.interfaces(trial, u, |_, _| Prediction::default(), request, &mut responses);
        let done = found.and_then(|()| act(self, &responses));
        self.responses = responses;
        done
    }

    /// Stores the magnitudes of the contact forces.
    pub fn note_contacts(&mut self, trial: Trial, responses: &[PairResponse]) {
        self.equilibrium.note_contacts(&self.model, trial.stiffening, responses);
        self.store_states(responses);
    }

    /// Stores the trial states of the contact points for the accepted state.
    fn store_states(&mut self, responses: &[PairResponse]) {
        let contacts = &mut self.evaluation.contacts;
        contacts.resize_with(responses.len(), Vec::new);
        contacts.iter_mut().zip(responses).for_each(|(states, pair)| states.clone_from(&pair.states));
    }
}

impl Assembler {
    /// Number of distinct stiffness matrices of the elements with constant tangent.
    pub fn stored_matrices(&self) -> usize {
        self.solids.matrices()
    }

    /// Returns the mass matrix on the current pattern.
    pub fn mass(&mut self) -> &SparseMatrix {
        let Self { model, layout, mass, absent, bars_absent, .. } = self;
        mass.get_or_insert_with(|| inertia::mass(model, layout, [absent, bars_absent]))
    }

    /// Returns the tangent of one term alone, without supports; see [`Term::dependence`].
    ///
    /// # Errors
    /// The same as for [`Assembler::residual`].
    pub fn tangent_of(&mut self, term: Term, trial: Trial, u: &[f64]) -> Result<SparseMatrix, TrialFailure> {
        self.with_responses(trial, u, Request::Tangent, |assembler, responses| {
            assembler.tangent_with(term, trial, u, responses)
        })
    }

    fn tangent_with(
        &mut self,
        term: Term,
        trial: Trial,
        u: &[f64],
        responses: &[PairResponse],
    ) -> Result<SparseMatrix, TrialFailure> {
        self.attend(trial.step, trial.old);
        self.cover(trial.step, trial.old, responses);
        let mut tangent = self.layout.matrix();
        if term == Term::Inertia {
            let mass = self.mass().clone();
            let inertia = Inertia::at(&self.model, trial, u, &mass);
            inertia.into_iter().for_each(|inertia| inertia.stiffen(&self.model, &mass, &mut tangent));
            return Ok(tangent);
        }
        let before = std::mem::take(&mut self.evaluation);
        let added = self.add(&[term], trial, Motion { u, v: None }, responses, false, Some(&mut tangent));
        self.evaluation = before;
        added.map(|()| tangent)
    }
}
