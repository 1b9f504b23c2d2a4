//! Bars in the block: one that moves with it or comes later, one with bond, one that is stressed from point to point.

use serde_json::{Map, Value, json};

use super::*;

/// The bar.
pub const BAR: &str = "rib";

impl Writer<'_> {
    pub(super) fn bars(&self) -> Value {
        let [low, high] = self.span();
        let at = |x: f64, y: f64| self.frame.point([low + x * (high - low), y].map(dyadic));
        let force = |x: f64| json!(self.write(Kind::Force, x * self.frame_moment()));
        let per_length = |x: f64| json!(self.write(Kind::Force, x * self.frame_moment()) / self.frame.length);
        let per_area = |x: f64| json!(self.write(Kind::Force, x * self.frame_moment()) / self.frame.length.powi(2));
        let bending = |x: f64| json!(self.write(Kind::Force, x * self.frame_moment()) * self.frame.length.powi(2));
        let mut bar = json!({"points": [at(0.12, 0.51), at(0.88, 0.33)], "ea": force(90.0)});
        if moves(self.draft) || is_dynamic(self.scheme) || self.has("gravity") {
            bar["mass"] = json!(1e-3 * self.mass_unit() / self.frame.length);
        }
        if self.is("damping", "of_body") {
            bar["damping"] = self.damping(1.0);
            // Explicit increments know that by mass alone.
            if is_explicit(self.draft) {
                bar["damping"]["stiffness"] = json!(0);
            }
        }
        let own = self.blocks();
        match self.draft.of("bar") {
            "bonded" => {
                let mut bond = json!({"stiffness": per_area(900.0), "strength": per_length(1.5), "residual": per_length(0.8),
                    "slip": self.write(Kind::Length, 0.02), "normal": per_area(2000.0)});
                if !self.has("pores") {
                    bond["mu"] = json!(0.3);
                }
                (bar["embedded"], bar["ei"], bar["segments"]) =
                    (json!({"in": own, "bond": bond}), bending(0.4), json!(5));
            }
            "tendon" => {
                (bar["start"], bar["end"]) =
                    (json!({"on": own[0], "clamped": true}), json!({"on": own[own.len() - 1]}));
                (bar["ei"], bar["segments"], bar["limit"]) = (bending(0.2), json!(3), force(6.0));
            }
            _ => bar["embedded"] = json!({"in": own}),
        }
        json!({BAR: bar})
    }

    /// What a part of a stage does with bars.
    pub(super) fn of_bars(&self, number: usize, [part, parts]: [usize; 2], step: &mut Map<String, Value>) {
        if self.is("bar", "tendon") && number == 0 {
            let share = (part + 1) as f64 / parts as f64;
            let force = 0.6 * self.frame_moment() * self.ways.load * share;
            step.insert("prestress".into(), json!({BAR: self.write(Kind::Force, force)}));
        }
        if self.is("bar", "late") && number == 1 && part == 0 {
            let added = step.entry("add").or_insert_with(|| json!([]));
            added.as_array_mut().expect("names").push(json!(BAR));
        }
    }
}
