//! `probes.csv`: what gauges at points of the bodies read, at the rows of the history.
//!
//! What a gauge at a point of a body reads.

use nalgebra::{Matrix2, Vector2};

use super::csv::{Rows, Sheet, Table};
use super::quantities::{HOOP, PROBE, names};
use super::recovery::Recovery;
use crate::laws::bulk::CauchyStress;
use crate::model::state::State;
use crate::model::{Model, Probe};
use crate::run::error::Error;
use crate::run::observer::Attempt;

/// The columns of every probe of a model.
fn readings(model: &Model) -> impl Iterator<Item = String> {
    names(&PROBE).chain(model.mesh.section.is_axisymmetric().then(|| HOOP.name.into()))
}

/// Observer that writes `probes.csv`.
pub type Probes = Sheet<ProbeRows>;

/// The rows of `probes.csv`.
#[derive(Debug)]
pub struct ProbeRows(Recovery);

impl Rows for ProbeRows {
    const NAME: &'static str = "probes";

    fn new(model: &Model) -> (Self, Vec<String>) {
        let columns = model.probes.iter().flat_map(|probe| readings(model).map(|of| format!("{}.{of}", probe.name)));
        (Self(Recovery::new(model)), std::iter::once("time".into()).chain(columns).collect())
    }

    fn write(&mut self, table: &mut Table, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let Some(state) = attempt.accepted else { return Ok(()) };
        table.number(state.time);
        for probe in &model.probes {
            let Reading { displacement: u, velocity: v, strain, hoop_strain, stress } =
                Reading::by(&self.0, probe, model, state);
            let CauchyStress { xx, yy, zz, xy } = stress;
            let hoop = model.mesh.section.is_axisymmetric().then_some(hoop_strain);
            let all = [u.x, u.y, v.x, v.y].into_iter().chain(strain).chain([xx, yy, zz, xy]).chain(hoop);
            table.numbers(all);
        }
        table.end_row_as(attempt.row)
    }
}

/// Values at a probe.
///
/// ```text
/// u = Σ N_a u_a,  v likewise                    by the shape functions of the element
/// E = ½ (FᵀF − 1)                               Green–Lagrange; of `linear` materials ε = sym grad u
/// ```
/// Strain and Cauchy stress are recovered from the elements around ([`super::recovery`]).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// u [L]
    pub displacement: Vector2<f64>,
    /// v [L/T]
    pub velocity: Vector2<f64>,
    /// E_xx, E_yy, E_xy, referred to the undeformed axes [-]
    pub strain: [f64; 3],
    /// E_zz of rings, along the hoops; 0 of other sections [-]
    pub hoop_strain: f64,
    /// σ [F/L²]
    pub stress: CauchyStress,
}

impl Reading {
    /// Reading of a probe in a state. Stress and strain are NaN where the material law fails, which it does not in an
    /// accepted state.
    pub fn of(probe: &Probe, model: &Model, state: &State) -> Self {
        Self::by(&Recovery::new(model), probe, model, state)
    }

    /// The same with what is known of the mesh.
    fn by(recovery: &Recovery, probe: &Probe, model: &Model, state: &State) -> Self {
        let element = &model.mesh.elements[probe.element];
        let shares = element.kind.values(probe.at);
        let mean = |of: &[Vector2<f64>]| of.iter().zip(&shares).map(|(of, n)| of * *n).sum::<Vector2<f64>>();
        let nodal = |values: &[f64]| mean(&model.mesh.vectors(probe.element, values));
        let material = &*model.bodies[model.body_of_element[probe.element]].material;
        let strain = |f: &Matrix2<f64>| {
            let gradient = f - Matrix2::identity();
            let square = if material.is_linear() { Matrix2::zeros() } else { gradient.transpose() * gradient };
            let strain = 0.5 * (gradient + gradient.transpose() + square);
            [strain.m11, strain.m22, strain.m12]
        };
        let hoop_strain = |h: f64| if material.is_linear() { h - 1.0 } else { 0.5 * (h - 1.0) * (h + 1.0) };
        let of_element = |e: usize| {
            let (solid, u) = (&model.solids[e], model.mesh.vectors(e, &state.displacement));
            let stresses = solid.stresses(material, model.memories.of(e, &state.memory), &u).ok()?;
            let (deformations, hoops) = (solid.deformations(&u), solid.hoops(&u));
            let hoop = |k: usize| hoops.as_ref().map_or(0.0, |hoops| hoop_strain(hoops[k]));
            let at = |(k, (s, f)): (usize, (&CauchyStress, &Matrix2<f64>))| {
                let [xx, yy, xy] = strain(f);
                [s.xx, s.yy, s.zz, s.xy, xx, yy, xy, hoop(k)]
            };
            Some(stresses.iter().zip(&deformations).enumerate().map(at).collect())
        };
        let found = recovery.at(model, of_element, probe.element, mean(&model.mesh.places(probe.element)));
        let [xx, yy, zz, xy, strain @ .., hoop_strain] = found.unwrap_or([f64::NAN; 8]);
        Self {
            displacement: nodal(&state.displacement),
            velocity: nodal(&state.velocity),
            strain,
            hoop_strain,
            stress: CauchyStress { xx, yy, zz, xy },
        }
    }
}
