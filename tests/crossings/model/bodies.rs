//! Bodies: materials, initial stress, what flows and warms in them.

use serde_json::{Map, Value, json};

use super::*;

impl Writer<'_> {
    pub(super) fn bodies(&self) -> Value {
        let mut bodies = Map::new();
        let block = self.body("block", 800.0);
        if self.ways.block_in_two {
            bodies.insert("half".into(), block.clone());
        }
        bodies.insert(self.names.block.into(), block);
        if self.has("flange") {
            let law = if self.is("block_law", "linear") { "linear" } else { "neo_hookean" };
            let mut material = self.material(law, 300.0, 0.2);
            material["density"] = json!(4.0 * self.density());
            let mut flange = json!({"material": material});
            if self.has("stress") {
                flange["initial_stress"] = self.stress([-1.0, -4.0, 0.0]);
            }
            if self.has("heat") && comes_or_goes(self.draft) {
                flange["thermal"] =
                    json!({"expansion": 1e-3, "reference": self.pick("reference of flange", &[0.0, 2.0])});
            }
            bodies.insert(FLANGE.into(), flange);
        }
        if !self.is_rigid() {
            bodies.insert(self.names.ground.into(), self.body("ground", 1500.0));
        }
        if self.ways.wide.is_some() && !self.is_rigid() {
            let mut outskirts = json!({"material": self.material("linear", 1500.0, 0.3)});
            if self.is("pores", "flow") {
                outskirts["pore_fluid"] = self.fluid();
            }
            bodies.insert(OUTSKIRTS.into(), outskirts);
        }
        if self.ways.strut.is_some() {
            bodies.insert(STRUT.into(), json!({"material": self.material("neo_hookean", 500.0, 0.3)}));
        }
        if self.ways.bystander {
            let [first, last] = ASIDE;
            let density = self.density();
            let linear =
                json!({"model": "linear", "E": self.write(Kind::Stress, 500.0), "nu": 0.25, "density": density});
            let mut stressed = json!({"material": linear});
            if self.scheme != "quasi_dynamic" {
                stressed["initial_stress"] = self.stress([-7.0, -3.0, 1.0]);
                let mut law = self.material("viscoelastic", 600.0, 0.3);
                law["density"] = json!(density);
                bodies.insert(last.into(), json!({"material": law}));
            } else {
                bodies.insert(last.into(), json!({"material": linear}));
            }
            bodies.insert(first.into(), stressed);
        }
        bodies.into()
    }

    pub(super) fn density(&self) -> f64 {
        // Heavier where increments are as short as waves take through an element.
        let heavier = if is_explicit(self.draft) { 16.0 } else { 1.0 };
        1e-3 * heavier * self.ways.density * self.frame.stress * self.frame.time.powi(2) / self.frame.length.powi(2)
    }

    pub(super) fn material(&self, law: &str, young: f64, poisson: f64) -> Value {
        let young = self.write(Kind::Stress, self.noisy(young, law));
        if law.ends_with("cam_clay") {
            return self.clay(law, young);
        }
        let mut material = json!({"model": law, "E": young, "nu": poisson, "density": self.density()});
        if law == "viscoelastic" {
            material["E_1"] = json!(0.5 * young);
            material["tau"] = json!(self.write(Kind::Time, 0.7 * self.duration()));
        }
        self.strengths(law, &mut material);
        material
    }

    /// Clay whose stiffness under the least pressure is that of other laws.
    pub(super) fn clay(&self, law: &str, young: f64) -> Value {
        let stress = |value: f64| json!(self.write(Kind::Stress, value));
        let [kappa, lambda] = [0.005, 0.1];
        let mut material = json!({
            "model": law, "lambda": lambda, "kappa": kappa, "p_min": stress(3.0), "density": self.density(),
        });
        match self.draft.count("slopes", 0, 1) {
            0 => material["M"] = json!(1.2),
            _ => (material["phi"], material["e"]) = (json!(28), json!(0.8)),
        }
        match self.draft.count("shear of clay", 0, 1) {
            0 => material["G"] = json!(0.4 * young),
            _ => material["nu"] = json!(0.25),
        }
        match self.draft.count("consolidation", 0, 1) {
            0 => material["p_c"] = stress(9.0),
            _ => material["OCR"] = json!(2.0),
        }
        if self.draft.count("slow yielding", 0, 1) == 1 {
            material["viscosity"] = json!(self.write(Kind::Time, 0.02 * self.duration()));
        }
        if law == "sys_cam_clay" {
            self.skeleton(&mut material);
        }
        material
    }

    /// What soil with a skeleton has besides: p_c is that of the remoulded soil.
    pub(super) fn skeleton(&self, material: &mut Value) {
        if self.draft.count("overconsolidation", 0, 1) == 1 {
            material["m"] = json!(3.0);
        }
        if self.draft.count("structure of soil", 0, 1) == 1 {
            (material["structure"], material["a"], material["c_s"]) = (json!(1.5), json!(0.3), json!(0.6));
        }
        if self.draft.count("anisotropy", 0, 1) == 1 {
            (material["b_r"], material["m_b"], material["zeta"]) = (json!(0.3), json!(0.8), json!(0.1));
        }
    }

    /// Strengths above the initial stress, which the contact surpasses here and there.
    pub(super) fn strengths(&self, law: &str, material: &mut Value) {
        let stress = |value: f64| json!(self.write(Kind::Stress, value));
        let (cone, soil) = (law == "drucker_prager", law == "mohr_coulomb");
        if law == "von_mises" {
            (material["sigma_y"], material["H"]) = (stress(7.0), stress(40.0));
            match self.draft.count("hardening", 0, 2) {
                0 => (material["Q"], material["b"]) = (stress(3.0), json!(50.0)),
                1 => material["back_stresses"] = json!([{"C": stress(60.0), "gamma": 20.0}, {"C": stress(20.0)}]),
                _ => {}
            }
        } else if cone || soil {
            (material["c"], material["phi"], material["psi"]) = (stress(4.0), json!(25), json!(25));
            material["tension"] = stress(5.0);
        } else {
            return;
        }
        if cone {
            material["matching"] = json!(["plane_strain", "compression"][self.draft.count("matching", 0, 1)]);
        }
        if soil {
            material["softening"] = json!({"c": stress(3.5), "phi": 24, "psi": 20, "strain": 0.1});
        }
        if self.draft.count("slow yielding", 0, 1) == 1 {
            material["viscosity"] = json!(self.write(Kind::Time, 0.02 * self.duration()));
        }
    }

    pub(super) fn body(&self, name: &str, young: f64) -> Value {
        let poisson = self.pick(&format!("{name} nu"), &[0.0, 0.3, 0.3, 0.45]);
        let mut body = json!({"material": self.material(self.draft.of(&format!("{name}_law")), young, poisson)});
        if let element @ ("f_bar" | "reduced") = self.draft.of(&format!("{name}_element")) {
            body["element"] = json!(element);
        }
        match self.draft.of("stress") {
            "components" => body["initial_stress"] = self.stress([-1.0, -4.0, 0.0]),
            "geostatic" => {
                let surface = if name == "block" { BLOCK_HEIGHT } else { 0.0 };
                let weight = self.frame.stress / self.frame.length;
                let surface = self.frame.point([0.0, surface])[1];
                let layer =
                    json!([{"top": surface - self.write(Kind::Length, 0.3), "weight": 1.5 * weight, "K0": 0.5}]);
                let (surcharge, weight) = (self.write(Kind::Stress, 0.2), 2.0 * weight);
                body["initial_stress"] = json!({"geostatic": {"surface": surface, "weight": weight, "K0": 0.6, "surcharge": surcharge, "below": layer}});
            }
            _ => {}
        }
        if self.is("pores", "given") {
            let pressure = format!("0.5*(1+0.2*X)*T/{}", self.duration());
            let pressure = self.frame.expression(Kind::Stress, &pressure, self.ways.load);
            body["pore_pressure"] = json!({"pressure": pressure, "biot": 0.8});
        } else if self.has("pores") {
            body["pore_fluid"] = self.fluid();
        }
        if self.has("heat") {
            body["thermal"] = json!({"expansion": 1e-3, "reference": self.pick("reference", &[0.0, 2.0])});
        }
        if self.is("damping", "of_body") {
            body["damping"] = self.damping(1.0);
        }
        body
    }

    /// Water that is trapped in pores, or flows: through an element in some increments.
    pub(super) fn fluid(&self) -> Value {
        let stress = |value: f64| json!(self.write(Kind::Stress, value));
        let mut fluid = json!({"bulk_modulus": stress(900.0), "porosity": 0.4});
        if self.is("pores", "cavitating") {
            (fluid["pressure"], fluid["cavitation"]) = (stress(0.5), stress(-1.0));
        }
        if self.is("pores", "flow") {
            fluid["permeability"] = json!(self.write(Kind::Velocity, self.noisy(3e-4, "permeability")));
            fluid["unit_weight"] = json!(3.0 * self.frame.stress / self.frame.length);
            fluid["pressure"] = stress(self.pick("water at the start", &[0.0, 0.5]) * self.ways.load);
            (fluid["biot"], fluid["kozeny_carman"]) =
                (json!(self.pick("biot", &[0.7, 1.0])), json!(self.pick("follows the void ratio", &[0.0, 1.0]) == 1.0));
        }
        fluid
    }

    /// Where water leaves the block, or enters it.
    pub(super) fn drainage(&self) -> Option<Value> {
        let on = self.group("block_right");
        let pressure = || self.frame.expression(Kind::Stress, "0.4*(1-0.5*T)", self.ways.load);
        let conductance = 2e-4 * self.frame.unit(Kind::Velocity) / self.frame.stress;
        Some(match self.draft.of("drainage") {
            "held" => json!({"on": on, "pressure": pressure()}),
            "filter" => json!({"on": on, "pressure": pressure(), "filter": conductance}),
            "seepage" => json!({"on": on, "seepage": true}),
            "flux" => json!({"on": on, "flux": self.frame.expression(Kind::Velocity, "1e-4*(1+Y)", self.ways.load)}),
            _ => return None,
        })
    }

    pub(super) fn damping(&self, share: f64) -> Value {
        json!({"mass": 5.0 * share / self.frame.time, "stiffness": 1e-5 * share * self.frame.time})
    }

    pub(super) fn stress(&self, stress: [f64; 3]) -> Value {
        let [xx, yy, xy] = self.frame.tensor(stress).map(|s| self.write(Kind::Stress, s * self.ways.load));
        let mut components = json!({"xx": xx, "yy": yy, "xy": xy});
        if !self.is("section", "plane_stress") {
            components["zz"] = json!(self.write(Kind::Stress, -2.0 * self.ways.load));
        }
        json!({"components": components})
    }

    pub(super) fn velocities(&self) -> Map<String, Value> {
        let v = json!(self.frame.vector(Kind::Velocity, [0.02, -0.1]));
        let flange = self.has("flange").then_some(FLANGE);
        self.blocks().into_iter().chain(flange).map(|body| (body.into(), v.clone())).collect()
    }
}
