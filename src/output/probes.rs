//! `probes.csv`: readings of gauges at points of the bodies, at the rows of the history.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Matrix2, Vector2};

use super::csv::{Rows, Sheet, Table};
use super::quantities::{HOOP, PROBE, names};
use super::recovery::{ElementValues, Recovery, Stencil};
use crate::laws::bulk::CauchyStress;
use crate::model::{Model, Probe, State};
use crate::run::{Attempt, Error};

/// Columns of all probes of a model.
fn readings(model: &Model) -> impl Iterator<Item = String> {
    names(&PROBE).chain(model.mesh.section.is_axisymmetric().then(|| HOOP.name.into()))
}

/// Names of the columns of a model's probes.
pub fn columns(model: &Model) -> Vec<String> {
    ProbeRows::new(model).1
}

/// Observer that writes `probes.csv`.
pub type Probes = Sheet<ProbeRows>;

/// Rows of `probes.csv`.
#[derive(Clone, Debug)]
pub struct ProbeRows(Vec<Stencil>);

impl Rows for ProbeRows {
    const NAME: &'static str = "probes";

    fn new(model: &Model) -> (Self, Vec<String>) {
        let columns =
            model.requests.probes.iter().flat_map(|probe| readings(model).map(|of| format!("{}.{of}", probe.name)));
        let stencils = stencils(model, &model.requests.probes);
        (Self(stencils), std::iter::once("time".into()).chain(columns).collect())
    }

    fn write(&mut self, table: &mut Table, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let Some(state) = attempt.accepted else { return Ok(()) };
        table.number(state.time);
        table.numbers(self.values(model, state));
        table.end_row_as(attempt.row)
    }
}

impl ProbeRows {
    /// Numbers of a row behind its time.
    pub(super) fn values(&self, model: &Model, state: &State) -> Vec<f64> {
        let known = values(model, state, &self.0);
        let mut row = Vec::new();
        for (probe, stencil) in model.requests.probes.iter().zip(&self.0) {
            let Reading { displacement: u, velocity: v, strain, hoop_strain, stress } =
                Reading::by(stencil, &known, probe, model, state);
            row.extend([u.x, u.y, v.x, v.y].into_iter().chain(strain).chain(stress.components()));
            row.extend(model.mesh.section.is_axisymmetric().then_some(hoop_strain));
        }
        row
    }
}

/// Reading of a probe.
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
    /// E_zz in axisymmetric bodies (hoop strain); 0 in other sections [-]
    pub hoop_strain: f64,
    /// σ [F/L²]
    pub stress: CauchyStress,
}

impl Reading {
    /// Evaluates a probe in a state. Stress and strain are NaN in a body that is absent, and where the material law fails, which
    /// does not occur in an accepted state.
    pub fn of(probe: &Probe, model: &Model, state: &State) -> Self {
        let stencils = stencils(model, std::slice::from_ref(probe));
        Self::by(&stencils[0], &values(model, state, &stencils), probe, model, state)
    }

    /// The same with the values at the quadrature points of the elements around.
    fn by(stencil: &Stencil, values: &Values, probe: &Probe, model: &Model, state: &State) -> Self {
        let shares = model.mesh.elements[probe.element].kind.values(probe.at);
        let nodal = |of: &[f64]| model.mesh.vectors(probe.element, of).iter().zip(&shares).map(|(of, n)| of * *n).sum();
        let mut sums = [0.0; 8];
        stencil.sum(&mut sums, |e| &values[&e]);
        let [xx, yy, zz, xy, strain @ .., hoop_strain] = sums;
        Self {
            displacement: nodal(&state.displacement),
            velocity: nodal(&state.velocity),
            strain,
            hoop_strain,
            stress: CauchyStress { xx, yy, zz, xy },
        }
    }
}

/// Values of elements.
type Values = BTreeMap<usize, ElementValues>;

/// The stencils of some probes.
fn stencils(model: &Model, probes: &[Probe]) -> Vec<Stencil> {
    let recovery = Recovery::new(model);
    let stencil = |probe: &Probe| {
        let shares = model.mesh.elements[probe.element].kind.values(probe.at);
        let place = model.mesh.places(probe.element).iter().zip(&shares).map(|(x, n)| x * *n).sum();
        recovery.at(model, probe.element, place)
    };
    probes.iter().map(stencil).collect()
}

/// Stress, strain and hoop strain of the elements that stencils need.
fn values(model: &Model, state: &State, stencils: &[Stencil]) -> Values {
    let elements: BTreeSet<usize> = stencils.iter().flat_map(Stencil::elements).copied().collect();
    let of_element = |e| (e, ElementValues::new(&model.solids[e], stress_and_strain(model, state, e)));
    elements.into_iter().map(of_element).collect()
}

/// Stress, strain and hoop strain at the quadrature points of an element.
fn stress_and_strain(model: &Model, state: &State, e: usize) -> Vec<f64> {
    let (solid, u) = (&*model.solid(state, e), model.mesh.vectors(e, &state.displacement));
    let material = &*model.body_of(e).material;
    if !state.has(model.body_of_element[e]) {
        return vec![f64::NAN; 8 * solid.quadrature_points()];
    }
    let strain = |f: &Matrix2<f64>| {
        let gradient = f - Matrix2::identity();
        let square = if material.description().is_linear { Matrix2::zeros() } else { gradient.transpose() * gradient };
        let strain = 0.5 * (gradient + gradient.transpose() + square);
        [strain.m11, strain.m22, strain.m12]
    };
    let hoop_strain = |h: f64| if material.description().is_linear { h - 1.0 } else { 0.5 * (h - 1.0) * (h + 1.0) };
    let Ok(stresses) = solid.stresses(material, model.memories.of(e, &state.memory), &u) else {
        return vec![f64::NAN; 8 * solid.quadrature_points()];
    };
    let (deformations, hoops) = (solid.deformations(&u), solid.hoops(&u));
    let hoop = |k: usize| hoops.as_ref().map_or(0.0, |hoops| hoop_strain(hoops[k]));
    let at = |(k, (stress, f)): (usize, (&CauchyStress, &Matrix2<f64>))| {
        stress.components().into_iter().chain(strain(f)).chain([hoop(k)])
    };
    stresses.iter().zip(&deformations).enumerate().flat_map(at).collect()
}
