//! Water that flows along contacts in quasi-dynamic steps: diffused once a step, to the times of its stages.
//!
//! Within a step the slip, by which a transmissivity may go, goes on at the rate at its start; the surfaces neither open nor dilate.

use super::slip_equations::Rates;
use crate::contact::conduit::{Amounts, Conduit, ConduitState, Wall, WallMotion};
use crate::contact::{ContactPair, ContactState};
use crate::laws::tableau::{C, STAGES};
use crate::model::{Model, State};

/// Water of all contacts along which it flows.
pub struct Conduits<'a> {
    flowing: Vec<Flowing<'a>>,
    /// Number of points of all contacts
    count: usize,
}

/// Water of one contact.
struct Flowing<'a> {
    number: usize,
    conduit: &'a Conduit,
    /// Number of its first point among those of all contacts
    first: usize,
    /// States of its points at t₀
    start: &'a [ContactState],
    state: ConduitState,
    /// Pressures of the nodes and volumes at the stages of a step
    stages: Vec<(Vec<f64>, Amounts)>,
}

impl<'a> Conduits<'a> {
    /// Water at t₀.
    pub fn new(model: &'a Model, state: &'a State) -> Self {
        let mut count = 0;
        let mut flowing = Vec::new();
        for (number, (pair, start)) in model.contacts.iter().zip(&state.contacts).enumerate() {
            if let Some(conduit) = &pair.conduit {
                let state = state.conduits[number].clone();
                flowing.push(Flowing { number, conduit, first: count, start, state, stages: Vec::new() });
            }
            count += pair.points.len();
        }
        Self { flowing, count }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.flowing.is_empty()
    }

    /// Pressures at all points now; 0 where no water flows.
    pub fn now(&self) -> Vec<f64> {
        self.spread(|flowing| &flowing.state.pressure)
    }

    /// Pressures at all points at a stage of the step that was foreseen.
    pub fn at(&self, stage: usize) -> Vec<f64> {
        self.spread(|flowing| &flowing.stages[stage].0)
    }

    fn spread<'b>(&'b self, of: impl Fn(&'b Flowing<'a>) -> &'b Vec<f64>) -> Vec<f64> {
        if self.is_empty() {
            return Vec::new();
        }
        let mut all = vec![0.0; self.count];
        for flowing in &self.flowing {
            let points = flowing.conduit.points(of(flowing), &flowing.state.walls);
            all[flowing.first..].iter_mut().zip(points).for_each(|(p, water)| *p = water.pressure);
        }
        all
    }

    /// Diffuses to the times of the stages of a step of length `h`, with the slips since t₀ and the rates at its start.
    pub fn foresee(&mut self, time: f64, h: f64, slips: &[f64], rates: &[Rates]) {
        for flowing in &mut self.flowing {
            let walls = [0.0, h].map(|way| flowing.walls(slips, rates, way));
            flowing.stages.clear();
            flowing.stages.resize(STAGES, (flowing.state.pressure.clone(), Amounts::default()));
            for stage in 1..STAGES {
                let share = [C[stage - 1], C[stage]];
                if share[0] == share[1] {
                    flowing.stages[stage] = flowing.stages[stage - 1].clone();
                    continue;
                }
                let between = |share: f64| -> Vec<Wall> {
                    let ends = walls[0].iter().zip(&walls[1]);
                    ends.map(|(from, to)| from.combined(1.0 - share, *to, share)).collect()
                };
                let [from, to] = share.map(between);
                let span = share.map(|share| time + share * h);
                let motion = WallMotion { span, walls: [&from, &to], rates: None, gives_way: [&[], &[]], steps: None };
                let (pressure, amounts) = &flowing.stages[stage - 1];
                flowing.stages[stage] = match flowing.conduit.march(pressure, &motion) {
                    Ok(reached) => (reached.pressure, amounts.combined(1.0, reached.amounts, 1.0)),
                    // Without a pressure the stage has no rates, and the step is refused.
                    Err(_) => (vec![f64::NAN; pressure.len()], Amounts::default()),
                };
            }
        }
    }

    /// Takes what was foreseen for the end of the step.
    pub fn accept(&mut self, h: f64, slips: &[f64], rates: &[Rates]) {
        for flowing in &mut self.flowing {
            let Some((pressure, amounts)) = flowing.stages.pop() else { continue };
            let walls = flowing.walls(slips, rates, 0.0);
            flowing.state = flowing.conduit.after(&flowing.state, h, pressure, walls, amounts);
        }
    }

    /// Gives the states of the contacts, and of the run, the water that is there now.
    pub fn receive(&self, contacts: &mut [Vec<ContactState>], water: &mut [ConduitState]) {
        for Flowing { number, conduit, state, .. } in &self.flowing {
            let points = conduit.points(&state.pressure, &state.walls);
            contacts[*number].iter_mut().zip(points).for_each(|(contact, water)| {
                contact.fluid = water.pressure;
                contact.water = Some(water);
            });
            water[*number] = state.clone();
        }
    }

    /// The first contact with a pressure below zero by more than the error of its steps.
    pub fn below_zero(&self, pairs: &'a [ContactPair]) -> Option<(&'a ContactPair, f64)> {
        let least = |flowing: &Flowing| {
            let pair = &pairs[flowing.number];
            flowing.conduit.bad(&flowing.state.pressure, pair.modulus).map(|(_, pressure)| (pair, pressure))
        };
        self.flowing.iter().find_map(least)
    }
}

impl Flowing<'_> {
    /// The surfaces after slips since t₀, which go on at these rates.
    fn walls(&self, slips: &[f64], rates: &[Rates], way: f64) -> Vec<Wall> {
        let own = self.start.iter().zip(slips[self.first..].iter().zip(&rates[self.first..]));
        let states: Vec<Wall> = own
            .map(|(start, (slip, rates))| {
                let slip = start.friction.plastic_slip + slip + way * rates.slip_rate;
                Wall { slip, pressure: rates.pressure.max(0.0), ..Wall::of(start) }
            })
            .collect();
        self.conduit.averaged(states.into_iter())
    }
}
