//! `probes.csv`: readings of gauges at points of the bodies, at the rows of the history.

use nalgebra::{Matrix2, Vector2};

use super::csv::{Rows, Sheet, Table};
use super::quantities::{HOOP, PROBE, names};
use crate::laws::bulk::CauchyStress;
use crate::model::state::State;
use crate::model::{Model, Probe};
use crate::run::error::Error;
use crate::run::observer::Attempt;

/// Columns of all probes of a model.
fn readings(model: &Model) -> impl Iterator<Item = String> {
    names(&PROBE).chain(model.mesh.section.is_axisymmetric().then(|| HOOP.name.into()))
}

/// Observer that writes `probes.csv`.
pub type Probes = Sheet<ProbeRows>;

/// Rows of `probes.csv`.
#[derive(Debug)]
pub struct ProbeRows;

impl Rows for ProbeRows {
    const NAME: &'static str = "probes";

    fn new(model: &Model) -> (Self, Vec<String>) {
        let columns =
            model.requests.probes.iter().flat_map(|probe| readings(model).map(|of| format!("{}.{of}", probe.name)));
        (Self, std::iter::once("time".into()).chain(columns).collect())
    }

    fn write(&mut self, table: &mut Table, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let Some(state) = attempt.accepted else { return Ok(()) };
        table.number(state.time);
        for probe in &model.requests.probes {
            let Reading { displacement: u, velocity: v, strain, hoop_strain, stress } =
                Reading::of(probe, model, state);
            let CauchyStress { xx, yy, zz, xy } = stress;
            let hoop = model.mesh.section.is_axisymmetric().then_some(hoop_strain);
            let all = [u.x, u.y, v.x, v.y].into_iter().chain(strain).chain([xx, yy, zz, xy]).chain(hoop);
            table.numbers(all);
        }
        table.end_row_as(attempt.row)
    }
}

/// Reading of a probe.
///
/// ```text
/// u = Σ N_a u_a,  v likewise                    by the shape functions of the element
/// E = ½ (FᵀF − 1)                               Green–Lagrange; of `linear` materials ε = sym grad u
/// ```
/// Strain and Cauchy stress are evaluated from the (bi)linear functions of the element that fit its integration-point values
/// best.
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
    /// Evaluates a probe in a state. Stress and strain are NaN where the material law fails, which does not occur in an
    /// accepted state.
    pub fn of(probe: &Probe, model: &Model, state: &State) -> Self {
        let (element, solid) = (&model.mesh.elements[probe.element], &model.solids[probe.element]);
        let nodal = |values: &[f64]| model.mesh.vectors(probe.element, values);
        let values = element.kind.values(probe.at);
        let mean = |of: &[Vector2<f64>]| of.iter().zip(&values).map(|(of, n)| of * *n).sum::<Vector2<f64>>();
        let (u, v) = (nodal(&state.displacement), nodal(&state.velocity));
        let material = &*model.bodies[model.body_of_element[probe.element]].material;
        let memory = model.memories.of(probe.element, &state.memory);
        let strain = |f: &Matrix2<f64>| {
            let gradient = f - Matrix2::identity();
            let square = if material.is_linear() { Matrix2::zeros() } else { gradient.transpose() * gradient };
            let strain = 0.5 * (gradient + gradient.transpose() + square);
            [strain.m11, strain.m22, strain.m12]
        };
        let strains: Vec<[f64; 3]> = solid.deformations(&u).iter().map(strain).collect();
        let hoop_strain = |h: &f64| match material.is_linear() {
            true => [h - 1.0],
            false => [0.5 * (h - 1.0) * (h + 1.0)],
        };
        let hoops: Option<Vec<[f64; 1]>> = solid.hoops(&u).map(|hoops| hoops.iter().map(hoop_strain).collect());
        let stress = solid.stresses(material, memory, &u).map(|stresses| {
            let all: Vec<[f64; 4]> = stresses.iter().map(|s| [s.xx, s.yy, s.zz, s.xy]).collect();
            let [xx, yy, zz, xy] = solid.fitted(&all, probe.at);
            CauchyStress { xx, yy, zz, xy }
        });
        let none = CauchyStress { xx: f64::NAN, yy: f64::NAN, zz: f64::NAN, xy: f64::NAN };
        Self {
            displacement: mean(&u),
            velocity: mean(&v),
            strain: solid.fitted(&strains, probe.at),
            hoop_strain: hoops.map_or(0.0, |hoops| solid.fitted(&hoops, probe.at)[0]),
            stress: stress.unwrap_or(none),
        }
    }
}
