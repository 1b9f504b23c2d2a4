//! Initial stress, pore fluid, given pore pressures and temperatures of bodies and their elements, and the work of their changes.

use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::boundary::{Amplitude, Moment, Profile};
use super::element::SolidElement;
use super::measured::{GivenPressure, PoreField};
use super::{Body, Model, Step};
use crate::laws::bulk::{CauchyStress, GIVEN_PRESSURE, PORE_PRESSURE, Slot, TEMPERATURE};
use crate::laws::parameter::ratio;

/// Initial stress of a body. Displacements and strains are measured from the initial state; stresses are total. The run
/// reports its imbalance with the loads at the start of the first step; loads that act from the start are expressions,
/// such as "-9.81" for gravity, because a number increases from zero over the step
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum InitialStress {
    /// Ground at rest under its weight along -y: σ_yy = −surcharge − weight (surface − y), and σ_xx = σ_zz = K0 σ_yy; σ_zz = 0 in a plate
    Geostatic {
        /// Level y of the vertical stress `surcharge`, 0 unless given: the top of the body, or above it if the body lies deeper [L]
        surface: f64,
        /// γ: weight per volume, the density times gravity, above 0 [F/L³]
        weight: f64,
        /// K₀: ratio of horizontal to vertical stress, zero or positive; 1 − sin φ for loose soil, ν/(1 − ν) for an elastic
        /// body without lateral strain [-]
        #[serde(rename = "K0")]
        k0: f64,
        /// Pressure on the surface, of a load on the ground or of what lies above it, zero or positive [F/L²]
        #[serde(default)]
        surcharge: f64,
        /// Layers below, from the top down, each with its weight and K₀: the same profile may serve all bodies of the ground
        #[serde(default)]
        below: Vec<Layer>,
    },
    /// Components of the stress, tension positive
    Components {
        /// σ_xx [F/L²]
        xx: Profile,
        /// σ_yy [F/L²]
        yy: Profile,
        /// σ_xy; 0 unless given [F/L²]
        #[serde(default)]
        xy: Profile,
        /// σ_zz: out of plane, the hoop stress in axisymmetry. Required except in plane stress, where it is 0 [F/L²]
        zz: Option<Profile>,
    },
}

/// A layer of the ground.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Layer {
    /// Level y of its top [L]
    pub top: f64,
    /// γ: weight per volume, above 0 [F/L³]
    pub weight: f64,
    /// K₀: ratio of horizontal to vertical stress, zero or positive [-]
    #[serde(rename = "K0")]
    pub k0: f64,
}

impl InitialStress {
    /// Ground of one kind at rest under its weight.
    pub const fn geostatic(surface: f64, weight: f64, k0: f64) -> Self {
        Self::Geostatic { surface, weight, k0, surcharge: 0.0, below: Vec::new() }
    }

    /// σ_xx, σ_yy, σ_xy, σ_zz at a reference position of a body; σ_zz is zero in plane stress [F/L²].
    pub fn at(&self, position: Vector2<f64>, in_plate: bool) -> [f64; 4] {
        match self {
            Self::Geostatic { surface, weight, k0, surcharge, below } => {
                let (mut pressure, mut here) = (*surcharge, Layer { top: *surface, weight: *weight, k0: *k0 });
                for layer in below.iter().take_while(|layer| position.y < layer.top) {
                    pressure += here.weight * (here.top - layer.top);
                    here = *layer;
                }
                let (vertical, k0) = (-pressure - here.weight * (here.top - position.y), here.k0);
                [k0 * vertical, vertical, 0.0, if in_plate { 0.0 } else { k0 * vertical }]
            }
            Self::Components { xx, yy, xy, zz } => {
                let zz = zz.as_ref().map_or(0.0, |zz| zz.value(position));
                [xx.value(position), yy.value(position), xy.value(position), zz]
            }
        }
    }
}

/// A fluid in the pores of a body. Without a permeability it has no time to flow, and elements are nearly incompressible from the start: take
/// f_bar, reduced Q8 or T6. With one it flows, in static steps, whose time is that of consolidation, and in those of newmark, hht and
/// generalized_alpha, where the density is that of both. The material, and the initial stress, are those of the effective stress; stresses and
/// what contacts feel are total
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct PoreFluid {
    /// K_w: bulk modulus of the fluid, 2.2 GPa of water, K_w > 0; K_w/n of 100 times the stiffness of the material is enough [F/L²]
    pub bulk_modulus: f64,
    /// n: volume of the pores per volume, 0 < n < 1 [-]
    pub porosity: f64,
    /// p_w at the start, by place; 0 for pressures that count from the start [F/L²]
    #[serde(default)]
    pub pressure: Profile,
    /// Pressure below which the fluid cavitates and p_w does not fall; −100 kPa of water below the atmosphere; a fluid
    /// that flows is not limited, and a warning is reported. No limit unless given [F/L²]
    pub cavitation: Option<f64>,
    /// k: speed at which the fluid seeps under a gradient of head of 1, k > 0; given, the fluid flows [L/T]
    pub permeability: Option<f64>,
    /// k along y; as `permeability` unless given [L/T]
    pub permeability_y: Option<f64>,
    /// γ_w: weight of the fluid per volume, by which k is divided; required with a permeability [F/L³]
    pub unit_weight: Option<f64>,
    /// b of a fluid that flows: Biot's coefficient, porosity ≤ b ≤ 1, 1 − K/K_s with the bulk moduli of the body and of its grains; 1 of soil
    /// unless given [-]
    pub biot: Option<f64>,
    /// Whether its weight, along −y, drives a fluid that flows: p_w is then the whole pressure, and rests where it is hydrostatic. Otherwise p_w is
    /// the pressure in excess of that
    #[serde(default)]
    pub weighs: bool,
    /// Height that the fluid rises to in the pores, h > 0, of one that weighs: where p_w is below 0 the permeability falls by exp(p_w/(γ_w h)), to a
    /// ten-thousandth at least, as above a free surface. Unless given the ground stays saturated, and as permeable, under any suction [L]
    pub capillary: Option<f64>,
    /// Whether the permeability follows the void ratio e by Kozeny and Carman, k ~ e³/(1 + e), from that of the undeformed body at the porosity
    #[serde(default)]
    pub kozeny_carman: bool,
}

impl PoreFluid {
    /// Creates a fluid without initial pressure and without cavitation.
    pub fn new(bulk_modulus: f64, porosity: f64) -> Self {
        Self { bulk_modulus, porosity, ..Self::default() }
    }

    /// Whether it flows.
    pub fn flows(&self) -> bool {
        self.permeability.is_some()
    }

    /// b [-]
    pub fn coefficient(&self) -> f64 {
        self.biot.unwrap_or(1.0)
    }

    /// K_w/n [F/L²]
    pub fn modulus(&self) -> f64 {
        self.bulk_modulus / self.porosity
    }
}

setters! { pore: PoreFluid;
    /// Lets it flow, with the permeability and its unit weight [L/T], [F/L³].
    flowing(permeability: f64, unit_weight: f64) { pore.permeability = Some(permeability); pore.unit_weight = Some(unit_weight); }

    /// Sets another permeability along y [L/T].
    permeability_y(permeability: f64) { pore.permeability_y = Some(permeability); }

    /// Sets Biot's coefficient of one that flows [-].
    biot(biot: f64) { pore.biot = Some(biot); }

    /// Lets its weight drive it.
    weighing() { pore.weighs = true; }

    /// Sets the height that it rises to in the pores [L].
    capillary(height: f64) { pore.capillary = Some(height); }

    /// Lets the permeability follow the void ratio.
    kozeny_carman() { pore.kozeny_carman = true; }

    /// Sets the pressure at the start [F/L²].
    pressure(pressure: impl Into<Profile>) { pore.pressure = pressure.into(); }

    /// Sets the pressure at which it cavitates [F/L²].
    cavitation(cavitation: f64) { pore.cavitation = Some(cavitation); }
}

/// Pressure of the fluid in the pores of a body, given by place and time: drained ground whose water changes, or a reservoir. The material, and the
/// initial stress, are those of the effective stress; stresses, and what is in equilibrium, are total: less biot times the pressure
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct PorePressure {
    /// p of the reference position x, y and, in expressions, of the run time t; what it is at t = 0 acts before anything moves. 0 at t = 0 for
    /// pressures that count from the start, which may be negative [F/L²]
    #[schemars(with = "GivenPressure")]
    pub pressure: PoreField,
    /// b: Biot's coefficient, 0 < b ≤ 1, 1 − K/K_s with the bulk moduli of the body and of its grains; 1 of soil [-]
    #[serde(default = "ratio::<1, 1>")]
    pub biot: f64,
}

impl PorePressure {
    /// Creates the pressure of a body whose grains are rigid.
    pub fn new(pressure: impl Into<PoreField>) -> Self {
        Self { pressure: pressure.into(), biot: 1.0 }
    }
}

setters! { pore: PorePressure;
    /// Sets Biot's coefficient.
    biot(biot: f64) { pore.biot = biot; }
}

impl Body {
    /// Total stress at the start at a reference position, effective stress less p_w; `None` if there is none.
    pub fn total_stress(&self, position: Vector2<f64>, in_plate: bool) -> Option<CauchyStress> {
        let effective = self.initial_stress.as_ref().map(|stress| stress.at(position, in_plate));
        // A table of nodes is zero at the start.
        let by_place = self.pore_pressure.as_ref().filter(|given| given.pressure.nodal().is_none());
        let given = by_place.map(|given| given.biot * given.pressure.value_at(position, 0.0));
        let of = |fluid: &PoreFluid| fluid.coefficient() * fluid.pressure.value(position);
        let fluid = self.pore_fluid.as_ref().map(of).or(given);
        if effective.is_none() && fluid.is_none() {
            return None;
        }
        let ([xx, yy, xy, zz], p_w) = (effective.unwrap_or_default(), fluid.unwrap_or_default());
        Some(CauchyStress { xx: xx - p_w, yy: yy - p_w, zz: zz - p_w, xy })
    }
}

/// Thermal expansion of a body, whose `temperature` is given by the steps. With F = (1 + α (T − T₀)) F_e the material is
/// evaluated at F_e; a `linear` one at the strain minus α (T − T₀).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Thermal {
    /// α: strain per temperature, relative to the undeformed body [1/Θ]
    pub expansion: f64,
    /// T₀: temperature of the undeformed body, in effect until a step specifies another [Θ]
    #[serde(default)]
    pub reference: f64,
}

impl Thermal {
    /// Creates the expansion of a body that is undeformed at temperature 0.
    pub fn new(expansion: f64) -> Self {
        Self { expansion, reference: 0.0 }
    }
}

setters! { thermal: Thermal;
    /// Sets the temperature of the undeformed body [Θ].
    reference(reference: f64) { thermal.reference = reference; }
}

/// Temperature of a body over a step.
#[derive(Clone, Debug)]
pub struct Temperature {
    /// number of the body
    pub body: usize,
    /// T [Θ]
    pub amplitude: Amplitude,
}

#[doc(hidden)]
impl Model {
    /// Initial internal variables of the materials, with or without an initial stress.
    pub fn initial_memory(&self) -> Vec<f64> {
        let mut memory = vec![0.0; self.memories.total()];
        for (e, own) in self.memories.each_mut(&mut memory).enumerate() {
            let body = self.body_of(e);
            let stress_at = |at| body.initial_stress.as_ref().map(|stress| stress.at(at, self.mesh.section.is_plate()));
            let law = body.material.description();
            let (count, pores) = (law.variables.len().max(1), law.slot(&[PORE_PRESSURE]));
            for (point, at) in own.chunks_exact_mut(count).zip(self.quadrature_positions(e)) {
                let [xx, yy, xy, zz] = stress_at(at).unwrap_or_default();
                // Whether it can begin there was asked when the model was built.
                let _ = body.material.begin(at, &CauchyStress { xx, yy, zz, xy }, point);
                if let (Some(fluid), Some(pores)) = (&body.pore_fluid, pores) {
                    pores.set(point, fluid.pressure.value(at));
                }
            }
            self.write_pressures(0.0.into(), e, own);
            self.write_flow(None, e, own);
        }
        memory
    }

    /// Writes T − T₀ to the variables of an element's material at a moment of a step. A body without a prescribed temperature
    /// is unchanged.
    pub fn write_temperatures(&self, step: &Step, at: Moment, element: usize, old: &[f64], new: &mut [f64]) {
        let (body, Some((count, heat))) = (self.body_of_element[element], self.heat(element)) else { return };
        let reference = self.bodies[body].thermal.map_or(0.0, |thermal| thermal.reference);
        let given = step.temperatures.iter().find(|temperature| temperature.body == body);
        let points = new.chunks_exact_mut(count).zip(old.chunks_exact(count));
        match given {
            Some(Temperature { amplitude, .. }) => {
                for ((new, _), place) in points.zip(self.quadrature_positions(element)) {
                    heat.of_mut(new)[0] = amplitude.value(place, at) - reference;
                }
            }
            None => points.for_each(|(new, old)| heat.of_mut(new)[0] = heat.of(old)[0]),
        }
    }

    /// Writes the given pressures in the pores of an element to the variables of its material at a moment.
    pub fn write_pressures(&self, at: Moment, element: usize, new: &mut [f64]) {
        let Some((count, slot, given)) = self.water(element) else { return };
        let points = new.chunks_exact_mut(count);
        let Some(table) = given.pressure.nodal() else {
            let value = |(new, place): (&mut [f64], Vector2<f64>)| {
                slot.of_mut(new)[0] = linear(at, |time| given.pressure.value_at(place, time));
            };
            return points.zip(self.quadrature_positions(element)).for_each(value);
        };
        let element = (&self.mesh.elements[element], self.solids[element].quadrature());
        for (new, point) in points.zip(element.1) {
            let shares = element.0.kind.values(point.at);
            let value =
                |time| element.0.nodes.iter().zip(&shares).map(|(&node, n)| n * table.at_node(node, time)).sum();
            slot.of_mut(new)[0] = linear(at, value);
        }
    }

    /// Writes the pressures of water that flows through an element to the variables of its material, at a displacement or at the start.
    pub fn write_flow(&self, u: Option<&[f64]>, element: usize, new: &mut [f64]) {
        let Some((flow, wet)) = self.flow.as_ref().and_then(|flow| Some((flow, flow.wet(element)?))) else { return };
        wet.write(flow, u, new);
    }

    /// Work of a change of the pressure in the pores of an element, as it came, in an increment, −½ (o₀ + o₁) Δp with o, what its pores have opened
    /// by: the change of the stored energy at constant displacement [F·L].
    pub fn filling(&self, solid: &SolidElement, element: usize, [old, new]: [&[f64]; 2]) -> f64 {
        let law = self.body_of(element).material.description();
        let (count, Some(slot)) = (law.variables.len(), law.slot(&GIVEN_PRESSURE)) else { return 0.0 };
        let points = old.chunks_exact(count).zip(new.chunks_exact(count)).zip(solid.point_volumes());
        let of = |((old, new), volume): ((&[f64], &[f64]), &f64)| {
            let ([before, opened], [after, opens]) = (*slot.of(old), *slot.of(new));
            filling(*volume, [before, after], [opened, opens])
        };
        points.map(of).sum()
    }

    /// Number of variables of an element's material at a point, those of the given pressure, and this; `None` without one.
    fn water(&self, element: usize) -> Option<(usize, Slot<2>, &PorePressure)> {
        let body = self.body_of(element);
        let given = body.pore_pressure.as_ref()?;
        let law = body.material.description();
        law.slot(&GIVEN_PRESSURE).map(|slot| (law.variables.len(), slot, given))
    }

    /// T − T₀ at the points of an element, from the internal variables of all elements; empty without thermal expansion.
    pub fn temperatures<'a>(&self, element: usize, memory: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let of = |(count, heat): (usize, Slot<2>)| {
            self.memories.of(element, memory).chunks_exact(count).map(move |point: &[f64]| heat.of(point)[0])
        };
        self.heat(element).map(of).into_iter().flatten()
    }

    /// Work of a temperature change on an element, as it came, in an increment, −½ (τ₀ + τ₁) α ΔT with the expansion stress τ: the change of
    /// the stored energy at constant displacement [F·L].
    pub fn heating(&self, solid: &SolidElement, element: usize, [old, new]: [&[f64]; 2]) -> f64 {
        let (Some((count, heat)), Some(thermal)) = (self.heat(element), self.body_of(element).thermal) else {
            return 0.0;
        };
        let of = |(volume, (old, new)): (&f64, (&[f64], &[f64]))| {
            let ([before, resisted], [after, resists]) = (heat.of(old), heat.of(new));
            -0.5 * (resisted + resists) * thermal.expansion * (after - before) * volume
        };
        let points = old.chunks_exact(count).zip(new.chunks_exact(count));
        solid.point_volumes().iter().zip(points).map(of).sum()
    }

    /// Number of variables of an element's material at a point, and those of its temperature; `None` without thermal expansion.
    fn heat(&self, element: usize) -> Option<(usize, Slot<2>)> {
        let body = self.body_of(element);
        body.thermal?;
        let law = body.material.description();
        law.slot(&TEMPERATURE).map(|slot| (law.variables.len(), slot))
    }

    /// Reference positions of an element's quadrature points.
    pub fn quadrature_positions(&self, element: usize) -> impl Iterator<Item = Vector2<f64>> {
        let (element, points) = (&self.mesh.elements[element], self.solids[element].quadrature());
        points.into_iter().map(move |point| {
            element.nodes.iter().zip(element.kind.values(point.at)).map(|(&node, n)| self.mesh.nodes[node] * n).sum()
        })
    }
}

/// A value at a moment; beyond an increment it goes on linearly.
fn linear(Moment { time, beyond }: Moment, value: impl Fn(f64) -> f64) -> f64 {
    let Some([from, to]) = beyond else { return value(time) };
    let [first, last] = [value(from), value(to)];
    first + (time - from) / (to - from) * (last - first)
}

/// Work of a change of the pressure in pores at a point of a volume, as in [`Model::filling`]: p, and what the pores have opened by, before and after.
#[doc(hidden)]
pub fn filling(volume: f64, [before, after]: [f64; 2], [opened, opens]: [f64; 2]) -> f64 {
    -0.5 * (opened + opens) * (after - before) * volume
}
