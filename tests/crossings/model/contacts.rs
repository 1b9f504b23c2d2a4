//! Contacts, their friction, and how it varies.

use serde_json::{Map, Value, json};

use super::*;

impl Writer<'_> {
    pub(super) fn contacts(&self) -> Value {
        let (draft, frame) = (self.draft, self.frame);
        let slave = if self.is("master", "itself") { "skin".into() } else { self.group("block_bottom") };
        let master = match draft.of("master") {
            "plane" => json!({"plane": {"point": frame.point([0.25, 0.0]), "normal": frame.direction([0.0, 1.0])}}),
            "circle" => {
                json!({"circle": {"centre": frame.point([1.375, -8.0]), "radius": self.write(Kind::Length, 8.0)}})
            }
            "polyline" => json!({"polyline": {"points": self.way()}}),
            "outline" if self.ways.wide.is_some() => json!({"polyline": {"points": self.way()}}),
            "outline" => json!({"outline": {"group": DIE}}),
            "itself" => json!("skin"),
            _ => json!(self.group("ground_top")),
        };
        let mut contact = json!({"slave": slave, "master": master, "friction": self.friction(draft.of("friction"))});
        if self.has("tool") {
            contact["rigid_body"] = json!(TOOL);
        }
        if self.ways.swapped {
            contact["slave"] = master;
            contact["master"] = json!(slave);
        }
        if draft.of("method") != "chosen" {
            contact["method"] = json!(draft.of("method"));
        }
        if self.has("gauss_points") {
            contact["points"] = json!(draft.of("gauss_points").parse::<usize>().expect("a number"));
        }
        if self.has("smooth") {
            contact["smooth"] = json!(true);
        }
        if self.ways.sliding.unwrap_or(draft.of("sliding")) == "small" {
            contact["sliding"] = json!("small");
        }
        let stiffness = frame.stress / frame.length * self.ways.stiffer;
        match self.ways.normal.unwrap_or(draft.of("normal")) {
            "alpha_n" => contact["normal"] = json!({"alpha_n": self.noisy(4e4, "alpha_n") * stiffness}),
            "augmented" => {
                contact["normal"] = json!({"alpha_n": 2e4 * stiffness, "penetration": self.write(Kind::Length, 1e-9)})
            }
            _ => {}
        }
        match draft.of("fluid") {
            "of_bodies" => contact["fluid_pressure"] = json!("of_bodies"),
            "constant" => contact["fluid_pressure"] = json!(self.write(Kind::Stress, self.ways.load)),
            "in_time" => {
                contact["fluid_pressure"] =
                    json!(frame.expression(Kind::Stress, &format!("0.8*(1+0.2*T/{})", self.duration()), self.ways.load))
            }
            "flows" => {
                contact["fluid_pressure"] = json!({"flow": {
                    "storage": 0.05 * frame.length / frame.stress,
                    "transmissivity": 0.05 * frame.length.powi(3),
                    "viscosity": frame.stress * frame.time,
                    "initial": self.write(Kind::Stress, 0.6 * self.ways.load),
                    "source": frame.expression(Kind::Velocity, "0.01*(1+0.2*X)*max(0,signum(T))", self.ways.load),
                }})
            }
            "by_place" => {
                contact["fluid_pressure"] = json!(frame.expression(Kind::Stress, "0.8*(1+0.2*X)", self.ways.load))
            }
            _ => {}
        }
        if let Some(fluid) = &self.ways.fluid {
            contact["fluid_pressure"] = json!(frame.expression(Kind::Stress, fluid, self.ways.load));
        }
        match draft.of("gap") {
            "drained" => contact["open_pressure"] = json!(self.write(Kind::Stress, 0.3 * self.ways.load)),
            "sealed" => contact["seal"] = json!(2e-4 * frame.unit(Kind::Velocity) / frame.stress),
            _ => {}
        }
        match draft.of("dilatancy") {
            "free" => contact["dilatancy"] = json!({"rate": self.pick("tan psi", &[0.05, 0.15])}),
            "structure" => contact["dilatancy"] = json!({"structure": self.pick("tan psi", &[0.05, 0.2])}),
            "limited" => {
                contact["dilatancy"] =
                    json!({"rate": self.pick("tan psi", &[0.05, 0.15]), "limit": self.write(Kind::Length, 0.004)})
            }
            _ => {}
        }
        if self.has("wear") {
            contact["wear"] = json!(2e-3 / frame.stress);
        }
        if self.has("interface") {
            let named = json!({"cohesion": self.write(Kind::Stress, 0.5), "friction_angle": 20});
            let reduced = json!({"reduction": 0.6, "of": self.names.block});
            contact["interface"] = if self.is("interface", "named") { named } else { reduced };
            contact["bond"] = json!({"opening": self.write(Kind::Length, 0.01), "bonded": true});
            contact.as_object_mut().expect("keys").remove("friction");
        }
        if self.has("bond") {
            let mut bond = json!({"strength": self.write(Kind::Stress, 1.0), "opening": self.write(Kind::Length, 0.01), "bonded": true});
            match draft.of("bond") {
                "softens" => {
                    bond["slip"] = json!(self.write(Kind::Length, 0.05));
                    bond["residual"] = json!(self.write(Kind::Stress, 0.25));
                }
                "pulls" => bond["tension"] = json!(self.write(Kind::Stress, 0.5)),
                "limited" => {
                    bond["limit"] = json!(self.write(Kind::Stress, 2.0));
                    bond["alpha_t"] = json!(1e4 * frame.stress / frame.length);
                }
                _ => {}
            }
            if self.scheme == "quasi_dynamic" {
                bond.as_object_mut().expect("keys").remove("opening");
            }
            contact["bond"] = bond;
        }
        match draft.of("radiation") {
            "given" => {
                contact["radiation_damping"] = json!(300.0 * frame.stress * frame.time / frame.length * self.duration())
            }
            "of_bodies" => contact["radiation_damping"] = json!(true),
            _ => {}
        }
        if self.has("stick") {
            contact["stick"] = json!(self.write(Kind::Length, 1e-9));
        }
        for key in ["shrink_fit", "massless"] {
            if self.has(key) {
                contact[key] = json!(true);
            }
        }
        match draft.of("tractions") {
            "given" => {
                let times = if self.ways.overstressed { 100.0 } else { 1.0 };
                let traction = frame.expression(Kind::Stress, "0.3+0.1*X", times * frame.sign() * self.ways.load);
                contact["initial"] =
                    json!({"pressure": self.write(Kind::Stress, 4.0 * self.ways.load), "traction": traction});
                if self.is("friction", "super_subloading") && !self.has("further_parameters") {
                    contact["initial"]["structure"] = json!(1.1);
                }
            }
            "balanced" => {
                contact["initial"] =
                    json!({"pressure": self.write(Kind::Stress, 4.0 * self.ways.load), "balanced": true})
            }
            "of_bodies" => contact["initial"] = json!({"of_bodies": true}),
            _ => {}
        }
        self.vary(&mut contact);
        if self.ways.told_in_time {
            tell_in_time(&mut contact, self.write(Kind::Time, 1e-9 * self.dt()));
        }
        let mut contacts = Map::new();
        contacts.insert(self.names.contact.into(), contact);
        if self.has("second_contact") {
            let wall =
                dyadic(self.span()[1] + if self.scheme == "static" && !self.has("then") { 0.012 } else { 0.002 });
            let stop = json!({"plane": {"point": frame.point([wall, 0.0]), "normal": frame.direction([-1.0, 0.0])}});
            let mut second = json!({"slave": self.group("block_right"), "master": stop, "method": "node_to_segment", "normal": {"alpha_n": 3e4 * stiffness}, "friction": {"law": "coulomb", "mu": 0.25, "alpha_t": 1e4 * stiffness}});
            if self.is("second_contact", "tool") {
                second["rigid_body"] = json!(STOP);
            }
            contacts.insert(self.names.second.into(), second);
        }
        if self.is("flange", "tied") {
            let tie = json!({"slave": format!("{FLANGE}_right"), "master": self.group("block_left"), "tied": true});
            contacts.insert(self.names.tie.into(), tie);
        }
        contacts.into()
    }

    pub(super) fn friction(&self, law: &str) -> Value {
        let (f, draft) = (self.frame, self.draft);
        let further = self.has("further_parameters");
        let duration = self.duration();
        let mut friction = match law {
            "coulomb" => json!({"mu": self.pick("mu", &[0.2, 0.4, 0.7])}),
            "adhesion" => json!({"strength": self.write(Kind::Stress, 1.5)}),
            "super_subloading" => {
                let mut law = json!({"mu_s": self.pick("mu_s", &[0.4, 0.6]), "mu_k": 0.25, "r": self.pick("r", &[200.0, 1000.0]) / f.length, "kappa": self.pick("kappa", &[20.0, 100.0]) / f.length, "xi": self.pick("xi", &[0.0, 0.5]) / f.time / duration});
                if further {
                    match draft.count("further", 0, 4) {
                        0 => law["elastic_core"] = json!(0.3),
                        1 => law["approach"] = json!("cotangent"),
                        2 => law["integration"] = json!("backward_euler"),
                        3 => {
                            law["a"] = json!(0.02);
                            law["V_0"] = json!(1e-3 * f.unit(Kind::Velocity) / duration);
                        }
                        _ => (law["structure"], law["m"], law["n"]) = (json!(1.2), json!(1.3), json!(1.4)),
                    }
                }
                law
            }
            "slip_weakening" => {
                json!({"mu_s": 0.6, "mu_d": 0.4, "D_c": self.write(Kind::Length, 0.02), "cohesion": self.write(Kind::Stress, if further && !self.has("bond") { 0.5 } else { 0.0 })})
            }
            "rate_and_state" => {
                let mut law = json!({"f_0": 0.5, "V_0": 1e-3 * f.unit(Kind::Velocity) / duration, "a": 0.012, "b": self.pick("b", &[0.008, 0.015]), "D_c": self.write(Kind::Length, 0.004), "evolution": if further { "slip" } else { "ageing" }});
                if further {
                    law["theta"] = json!(self.write(Kind::Time, 10.0 * duration));
                }
                law
            }
            "prescribed" => {
                json!({"slip_rate": self.pick("slip rate", &[0.01, -0.01]) * f.sign() * f.unit(Kind::Velocity) / duration})
            }
            "registered" => {
                json!({"name": "crossings viscous", "parameters": {"viscosity": 20.0 * f.stress * f.time / f.length * duration, "threshold": self.write(Kind::Stress, 0.4)}})
            }
            _ => json!({}),
        };
        friction["law"] = json!(law);
        // Where normal contact is compared with another, alpha_t does not follow alpha_n.
        let picked = self.pick("own alpha_t", &[0.0, 1.0]) == 1.0;
        let own = law == "super_subloading" || self.ways.normal.is_some() || picked;
        if law != "frictionless" && own {
            friction["alpha_t"] = json!(2e4 * f.stress / f.length);
        }
        friction
    }

    /// What of friction varies.
    pub(super) fn vary(&self, contact: &mut Value) {
        let (f, duration) = (self.frame, self.duration());
        let growing = |kind: Kind, value: f64, time: bool| {
            let text =
                if time { format!("{value}*(1+0.05*X+0.1*T/{duration})") } else { format!("{value}*(1+0.05*X)") };
            f.expression(kind, &text, 1.0)
        };
        let parameter = |law: &str, time: bool| -> (&'static str, String) {
            match law {
                "coulomb" => ("mu", growing(Kind::Number, 0.3, time)),
                "adhesion" => ("strength", growing(Kind::Stress, 1.0, time)),
                // A rate, whose mean counts, or a strength, whose last value does.
                "super_subloading" if self.pick("which varies", &[0.0, 1.0]) == 0.0 => {
                    ("kappa", format!("({})/({})", growing(Kind::Number, 30.0, time), f.length))
                }
                "super_subloading" => ("mu_s", growing(Kind::Number, 0.5, time)),
                "slip_weakening" => ("mu_d", growing(Kind::Number, 0.35, time)),
                "rate_and_state" => ("f_0", growing(Kind::Number, 0.45, time)),
                law => panic!("say which parameter of `{law}` varies"),
            }
        };
        match self.draft.of("varying") {
            "by_part" => {
                let other = if self.is("scheme", "quasi_dynamic") { "rate_and_state" } else { "super_subloading" };
                let mut part =
                    json!({"where": f.expression(Kind::Number, "X-1.4", 1.0), "friction": self.friction(other)});
                let (name, text) = parameter(other, false);
                part["along"] = json!({name: text});
                contact["along"] = json!({"law": [part]});
            }
            "random" => {
                let (name, mean) = match self.draft.of("friction") {
                    "coulomb" => ("mu", 0.3),
                    "adhesion" => ("strength", f.stress),
                    "super_subloading" => ("mu_s", 0.5),
                    "slip_weakening" => ("mu_d", 0.35),
                    "rate_and_state" => ("f_0", 0.45),
                    law => panic!("say which parameter of `{law}` varies"),
                };
                let rough = json!({"von_karman": {"hurst": self.pick("hurst", &[0.5, 0.8])}});
                let picked = |name: &str, plain: Value, other: Value| {
                    if self.pick(name, &[0.0, 1.0]) == 1.0 { other } else { plain }
                };
                let field = json!({
                    "seed": self.pick("seed", &[1.0, 2.0, 3.0]) as u64, "mean": mean, "deviation": 0.05 * mean,
                    "correlation": 0.5 * f.length,
                    "marginal": picked("marginal", json!("normal"), json!("lognormal")),
                    "spectrum": picked("spectrum", json!("gaussian"), rough),
                });
                contact["along"] = json!({name: {"random": field}});
            }
            "no" => {}
            value => {
                let (name, text) = parameter(self.draft.of("friction"), value == "in_time");
                contact["along"] = json!({name: text});
            }
        }
    }
}

/// Writes the numbers of a contact's friction, and of that on a part of it, as expressions of the time that stay the same from the
/// time `early` on. At the start those that say nothing of the first state of a point are a fifth larger: no increment ends there.
pub(super) fn tell_in_time(contact: &mut Value, early: f64) {
    // The strengths at the start share the initial traction.
    let is_shared = contact.get("bond").is_some() && contact.get("initial").is_some();
    let told = |of: &mut Value| {
        let friction = of["friction"].clone();
        let of_first_state: &[&str] = match friction["law"].as_str() {
            Some("super_subloading") => &["mu_s", "mu_k"],
            Some("rate_and_state") => &["V_0", "D_c"],
            _ => &[],
        };
        let further = friction["parameters"].as_object().into_iter().flatten();
        for (name, value) in friction.as_object().into_iter().flatten().chain(further) {
            // These do not vary in time.
            let of_start = ["alpha_t", "structure", "theta"].contains(&name.as_str());
            let Some(value) = value.as_f64().filter(|_| !of_start) else { continue };
            // What may grow from nothing wants an opening of its own.
            if name == "cohesion" && value == 0.0 {
                continue;
            }
            let jump = if is_shared || of_first_state.contains(&name.as_str()) { 0.0 } else { 0.2 };
            let along = &mut of["along"][name];
            if along.is_object() {
                continue;
            }
            let text = along.as_str().map_or(value.to_string(), str::to_owned);
            *along = json!(format!("({text})*(1+{jump}*max(0,1-t/{early}))"));
        }
    };
    told(contact);
    let parts = contact.pointer_mut("/along/law").and_then(Value::as_array_mut);
    parts.into_iter().flatten().for_each(told);
}
