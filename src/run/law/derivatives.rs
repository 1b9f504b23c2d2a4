//! Derivatives of the traction along a path, or of a slider's force, by parameters of its law and machine.

use rayon::prelude::*;

use super::report::LawRow;
use super::slider::{Moved, Slider, Step};
use crate::laws::friction::sensitivity::{Direction, Variation};
use crate::laws::friction::{LawFailure, SensitiveLaw};
use crate::run::error::Error;

/// Steps whose derivatives are found together, the parameters side by side.
const TOGETHER: usize = 1 << 14;

/// Names of the derivatives of a machine, besides those of its law.
pub const OF_MACHINE: [&str; 2] = ["stiffness", "mass"];

/// Derivatives along a path: those of the computed values, at the same steps.
pub(super) struct Derivatives<'a> {
    law: &'a dyn SensitiveLaw,
    slider: Option<Slider>,
    derivatives: Vec<Derivative>,
    steps: Vec<Step>,
}

/// Derivatives by one parameter.
struct Derivative {
    parameter: Option<&'static str>,
    state: Variation,
    /// of k and M
    machine: [f64; 2],
    /// of u, u̇ and ü
    motion: [f64; 3],
    /// of the traction or the force at the rows
    rows: Vec<f64>,
}

impl Derivative {
    fn new(law: &dyn SensitiveLaw, name: &str) -> Self {
        let parameter = law.parameters().iter().copied().find(|known| *known == name);
        let state = parameter.map_or(Variation::default(), |name| law.start(name));
        let machine = OF_MACHINE.map(|of| f64::from(u8::from(of == name)));
        Self { parameter, state, machine, motion: [0.0; 3], rows: Vec::new() }
    }

    /// Takes a derivative at a row: none by a parameter that neither the law nor the machine has.
    fn record(&mut self, derivative: f64) {
        let known = self.parameter.is_some() || self.machine != [0.0; 2];
        self.rows.push(if known { derivative } else { f64::NAN });
    }

    fn direction(&self) -> Direction {
        Direction { state: self.state.clone(), parameter: self.parameter, ..Direction::default() }
    }
}

impl<'a> Derivatives<'a> {
    pub fn new(law: &'a dyn SensitiveLaw, slider: Option<Slider>, by: &[String]) -> Self {
        Self { law, slider, derivatives: by.iter().map(|name| Derivative::new(law, name)).collect(), steps: Vec::new() }
    }

    /// Takes the next step; some are rows.
    pub fn take(&mut self, step: Step) -> Result<Vec<LawRow>, Error> {
        self.steps.push(step);
        if self.steps.len() < TOGETHER { Ok(Vec::new()) } else { self.rows() }
    }

    /// Rows of the steps since the last ones.
    pub fn rows(&mut self) -> Result<Vec<LawRow>, Error> {
        let (law, steps) = (self.law, std::mem::take(&mut self.steps));
        let vary = |derivatives: &mut [Derivative]| {
            steps.iter().try_for_each(|step| {
                let varied = match self.slider {
                    Some(slider) => of_force(law, slider, step, &mut derivatives[0]),
                    None => of_traction(law, step, derivatives),
                };
                varied.map_err(|cause| Error::Law { time: step.time, cause })
            })
        };
        // A law is varied along two directions at once, of which a slider's slip takes one.
        let together = if self.slider.is_some() { 1 } else { 2 };
        self.derivatives.par_chunks_mut(together).try_for_each(vary)?;
        let columns: Vec<Vec<f64>> =
            self.derivatives.iter_mut().map(|derivative| std::mem::take(&mut derivative.rows)).collect();
        let rows = steps.into_iter().filter_map(|step| step.row).enumerate();
        Ok(rows.map(|(k, row)| LawRow { derivatives: columns.iter().map(|of| of[k]).collect(), ..*row }).collect())
    }
}

/// ∂q/∂parameter at the end of a step with a given slip.
fn of_traction(law: &dyn SensitiveLaw, step: &Step, derivatives: &mut [Derivative]) -> Result<(), LawFailure> {
    let direction = |k: usize| derivatives.get(k).map_or(Direction::default(), Derivative::direction);
    let varied = law.vary(&step.old, step.sliding, [direction(0), direction(1)])?;
    for (derivative, state) in derivatives.iter_mut().zip(varied) {
        if step.row.is_some() {
            derivative.record(state.traction);
        }
        derivative.state = state;
    }
    Ok(())
}

/// ∂F/∂parameter of a slider at the end of a step, of the same length.
fn of_force(
    law: &dyn SensitiveLaw,
    slider: Slider,
    step: &Step,
    derivative: &mut Derivative,
) -> Result<(), LawFailure> {
    let Some(Moved { from, to, pulled }) = &step.moved else {
        derivative.record(0.0);
        return Ok(());
    };
    let (slip, dt) = (step.sliding.slip, step.sliding.dt);
    let by_slip = Direction { slip: 1.0, ..Direction::default() };
    let [given, by_slip] = law.vary(&step.old, step.sliding, [derivative.direction(), by_slip])?;
    let ([dstiffness, dmass], [du, dv, da]) = (derivative.machine, derivative.motion);
    let (per, stretch) = (4.0 / (dt * dt), pulled - to.slip);
    let inertia = per * (slip - dt * from.rate) - from.acceleration;
    let driven = dstiffness * stretch - slider.stiffness * du - given.traction - dmass * inertia
        + slider.mass * (per * dt * dv + da);
    let dslip = driven / (slider.mass * per + slider.stiffness + by_slip.traction);
    derivative.motion = [du + dslip, 2.0 * dslip / dt - dv, per * (dslip - dt * dv) - da];
    derivative.state = given;
    derivative.state.traction += by_slip.traction * dslip;
    let variables = derivative.state.variables.values_mut().zip(by_slip.variables.values());
    variables.for_each(|(to, by)| *to += by * dslip);
    if step.row.is_some() {
        derivative.record(dstiffness * stretch - slider.stiffness * derivative.motion[0]);
    }
    Ok(())
}
