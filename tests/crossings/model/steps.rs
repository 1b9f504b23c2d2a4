//! Steps: what moves, presses and warms, how it is led there, and by which increments.

use serde_json::{Map, Value, json};

use super::*;

impl Writer<'_> {
    pub(super) fn duration(&self) -> f64 {
        duration(self.draft)
    }

    pub(super) fn dt(&self) -> f64 {
        self.duration() / if moves(self.draft) { 8.0 } else { 4.0 }
    }

    /// A time of the run as written.
    pub(super) fn at(&self, time: f64) -> f64 {
        self.frame.at(time)
    }

    pub(super) fn target(&self, what: What, on: &str, to: [f64; 2]) -> Target {
        let to = [0, 1].map(|k| self.noisy(to[k] * self.ways.load, &format!("{what:?} {k}")));
        Target { what, on: self.group(on), to }
    }

    pub(super) fn stages(&self) -> Vec<Stage> {
        let dynamic = moves(self.draft);
        let press = self.draft.of("press");
        let target = |what, on, to| self.target(what, on, to);
        let on_end = self.is("section", "rings_on_end");
        let held = What::Support([!on_end, false]);
        let (down, drag) = if dynamic { (0.5 * DOWN, 0.3 * DRAG) } else { (DOWN, DRAG) };
        let drag = if self.is("sliding", "small") { 0.5 * drag } else { drag };
        let drag = if self.is("friction", "prescribed") { 0.3 * drag } else { drag };
        let mut first = Vec::new();
        match press {
            "displacement" => {
                let slant = if self.has("approach") { 0.5 * drag } else { 0.0 };
                first.push(target(What::Support([!on_end, true]), "block_top", [slant, -down]));
            }
            "rotation" => first.push(target(What::Rotation, "block_top", [0.004, 0.0])),
            _ => {
                let force = -PRESSURE * self.area();
                if !on_end {
                    first.push(target(held, "block_top", [0.0, 0.0]));
                }
                first.push(match press {
                    "pressure" => target(What::Pressure, "block_top", [PRESSURE, 0.0]),
                    "dead_pressure" => target(What::DeadPressure, "block_top", [PRESSURE, 0.0]),
                    "traction" => target(What::Traction, "block_top", [0.0, -PRESSURE]),
                    "total_force" => target(What::TotalForce, "block_top", [0.0, force]),
                    _ => target(What::Force, "block_corner", [0.0, force]),
                });
            }
        }
        let mut second = Vec::new();
        match press {
            _ if on_end && self.scheme != "quasi_dynamic" => {
                second.push(target(What::DeadPressure, "block_right", [self.pick("radial", &[20.0, -20.0]), 0.0]))
            }
            "rotation" => second.push(target(What::Rotation, "block_top", [-0.002, 0.0])),
            "displacement" => second.push(target(What::Support([!on_end, true]), "block_top", [drag, -1.2 * down])),
            _ => second.push(target(held, "block_top", [drag, 0.0])),
        }
        if self.has("gravity") {
            first.push(target(What::Gravity, "block", [0.0, -300.0]));
            if self.ways.block_in_two {
                first.push(Target { on: "half".into(), ..target(What::Gravity, "block", [0.0, -300.0]) });
            }
            if self.has("bar") {
                first.push(Target { on: bars::BAR.into(), ..target(What::Gravity, "block", [0.0, -300.0]) });
            }
            if comes_or_goes(self.draft) {
                let weight = Target { on: FLANGE.into(), ..target(What::Gravity, "block", [0.0, -300.0]) };
                if self.is("flange", "added") { second.push(weight) } else { first.push(weight) }
            }
        }
        if self.has("heat") {
            second.push(target(What::Temperature, "block", [self.pick("warmer", &[3.0, -2.0]), 0.0]));
            if self.ways.block_in_two {
                let block = second.last().cloned().expect("the block's");
                second.push(Target { on: "half".into(), ..block });
            }
            if !self.is_rigid() {
                first.push(target(What::Temperature, "ground", [2.5, 0.0]));
            }
        }
        if self.is("plate", "rigid") {
            second.push(target(What::Moment, "block_right", [0.3 * self.frame_moment(), 0.0]));
        }
        // Where it is free, springs hold it against a force.
        let tool = |to: [f64; 2], angle: f64, force: f64| {
            let on = |what, to| Target { on: TOOL.into(), ..target(what, "block", to) };
            let free = self.is("tool", "free");
            let mut path = vec![on(What::Support([true, !free]), to)];
            path.extend((!self.turns_freely()).then(|| on(What::Angle, [angle, 0.0])));
            path.extend(free.then(|| on(What::Force, [0.0, force])));
            path.into_iter().filter(|_| self.has("tool"))
        };
        // Euler: it buckles at a strain of 4π²/12 (height/length)².
        let shorter = |times: f64| times * std::f64::consts::PI.powi(2) / 3.0 * SLENDERNESS.powi(2) * STRUT_LENGTH;
        let pushed = self.ways.strut.map(shorter).map(|shorter| {
            let strut = target(What::Support([true, true]), "block_right", [-shorter, 0.0]);
            Target { on: format!("{STRUT}_right"), ..strut }
        });
        first.extend(pushed.clone());
        second.extend(pushed.clone());
        first.extend(tool([0.0, 0.0], 0.0, 0.0));
        second.extend(tool([-0.4 * drag, -0.05 * down], 0.002, 0.5 * PRESSURE * self.area()));
        let mut stages = vec![Stage { name: "press", targets: first }, Stage { name: "drag", targets: second }];
        if self.has("reversal") {
            let back = match press {
                _ if on_end => target(What::DeadPressure, "block_right", [0.0, 0.0]),
                "rotation" => target(What::Rotation, "block_top", [0.003, 0.0]),
                "displacement" => target(What::Support([true, true]), "block_top", [-0.5 * drag, -1.1 * down]),
                _ => target(held, "block_top", [-0.5 * drag, 0.0]),
            };
            // A rate would go on where nothing is said of it.
            let rests = tool([-0.4 * drag, -0.05 * down], 0.002, 0.3 * PRESSURE * self.area());
            stages.push(Stage { name: "back", targets: std::iter::once(back).chain(rests).chain(pushed).collect() });
        }
        stages
    }

    pub(super) fn frame_moment(&self) -> f64 {
        if self.is("section", "plane_stress") { self.thickness() } else { 1.0 }
    }

    pub(super) fn plates(&self) -> Vec<Value> {
        let mut plates = Vec::new();
        if self.is("press", "plate") {
            plates.push(json!(self.group("block_top")));
        }
        match self.draft.of("plate") {
            "rigid" => plates.push(json!({"on": self.group("block_right"), "moves": "rigid"})),
            "alike" => {
                let across = self.frame.direction([1.0, 0.0])[0].abs() < 0.5;
                plates.push(
                    json!({"on": self.group("block_right"), "moves": if across { "uy_alike" } else { "ux_alike" }}),
                );
            }
            _ => {}
        }
        plates
    }

    /// Whether what stands aside flies.
    pub(super) fn flies(&self) -> bool {
        self.ways.flight && is_dynamic(self.scheme) && !self.has("then") && !self.rings()
    }

    pub(super) fn steps(&self) -> Vec<Value> {
        let stages = self.stages();
        let parts: usize = if self.ways.halves { 2 } else { 1 };
        let mut steps = Vec::new();
        if self.ways.later > 0.0 {
            steps.push(self.wait(&stages[0]));
        }
        let mut reached: Vec<Target> = Vec::new();
        let initial = self.pick("reference", &[0.0, 2.0]);
        for (number, stage) in stages.iter().enumerate() {
            let before: Vec<Option<[f64; 2]>> = stage
                .targets
                .iter()
                .map(|target| {
                    reached
                        .iter()
                        .rev()
                        .find(|old| {
                            std::mem::discriminant(&old.what) == std::mem::discriminant(&target.what)
                                && old.on == target.on
                        })
                        .map(|old| old.to)
                })
                .collect();
            for part in 0..parts {
                let mut step = Map::new();
                let name = if parts == 1 { stage.name.to_string() } else { format!("{}_{part}", stage.name) };
                let duration = self.duration() / parts as f64;
                let start = self.duration() * number as f64 + duration * part as f64;
                step.insert("name".into(), json!(name));
                step.insert("duration".into(), json!(self.write(Kind::Time, duration)));
                let (mut supports, mut loads) = (Vec::new(), Vec::new());
                if number == 0 && part == 0 {
                    self.increments(&mut step);
                    if self.ways.later == 0.0 {
                        self.first(&mut supports, &mut loads);
                    }
                }
                if part == 0 {
                    self.of_stage(number, &mut step, &mut loads);
                }
                self.of_bars(number, [part, parts], &mut step);
                if self.stabilized() && number == 0 && part == 0 || self.has("stabilize") {
                    step.insert("stabilize".into(), json!(1e-3));
                }
                if self.has("rupture") {
                    step.insert(
                        "rupture".into(),
                        json!({"slip_rate": self.frame.unit(Kind::Velocity) * 1.5 * DRAG / self.duration()}),
                    );
                }
                for (target, before) in stage.targets.iter().zip(&before) {
                    let start_value = before.unwrap_or(if target.what == What::Temperature {
                        [initial * self.ways.load, 0.0]
                    } else {
                        [0.0; 2]
                    });
                    let share = |k: usize, part: usize| {
                        start_value[k] + (target.to[k] - start_value[k]) * part as f64 / parts as f64
                    };
                    let change = Change {
                        from: [share(0, part), share(1, part)],
                        to: [share(0, part + 1), share(1, part + 1)],
                        start,
                        end: start + duration,
                        // where it goes on from a stage before, and where another follows
                        goes_on: [before.is_some() && number == 1, number == 0],
                    };
                    self.emit(target, &change, &mut step, &mut supports, &mut loads);
                }
                if self.has("until") && number == 0 && part + 1 == parts {
                    let force = 0.4 * PRESSURE * self.area();
                    step.insert("until".into(), json!({"on": self.group("block_top"), "force": self.write(Kind::Force, force * self.ways.load)}));
                }
                if !supports.is_empty() {
                    if self.ways.shuffled {
                        supports.reverse();
                    }
                    if self.ways.told_thrice {
                        tell_thrice(&mut supports);
                    }
                    step.insert("supports".into(), supports.into());
                }
                if !loads.is_empty() {
                    if self.ways.shuffled {
                        loads.reverse();
                    }
                    step.insert("loads".into(), loads.into());
                }
                steps.push(step.into());
            }
            reached.extend(stage.targets.iter().cloned());
        }
        steps
    }

    /// A step in which nothing happens, before the first.
    pub(super) fn wait(&self, first: &Stage) -> Value {
        let mut step = Map::new();
        let duration = self.ways.later * self.duration();
        step.insert("name".into(), json!("wait"));
        step.insert("duration".into(), json!(self.write(Kind::Time, duration)));
        self.increments(&mut step);
        if self.scheme != "explicit" {
            step.insert("dt".into(), json!({"initial": self.write(Kind::Time, duration)}));
        }
        if self.has("stabilize") {
            step.insert("stabilize".into(), json!(1e-3));
        }
        let (mut supports, mut loads) = (Vec::new(), Vec::new());
        self.first(&mut supports, &mut loads);
        let change = Change { from: [0.0; 2], to: [0.0; 2], start: -duration, end: 0.0, goes_on: [false; 2] };
        for target in first.targets.iter().filter(|target| matches!(target.what, What::Support(_) | What::Angle)) {
            self.emit(target, &change, &mut step, &mut supports, &mut loads);
        }
        step.insert("supports".into(), supports.into());
        if !loads.is_empty() {
            step.insert("loads".into(), loads.into());
        }
        step.into()
    }

    /// Whether dashpots hold the block until contact does.
    pub(super) fn stabilized(&self) -> bool {
        !matches!(self.draft.of("press"), "displacement" | "rotation")
            && !is_dynamic(self.scheme)
            && !self.has("spring")
    }

    /// Scheme and increments of the first stage.
    pub(super) fn increments(&self, step: &mut Map<String, Value>) {
        self.of_scheme(self.scheme, step);
        if self.has("error_control") {
            let dt = self.write(Kind::Time, self.dt() / self.ways.finer);
            let error = self.write(Kind::Length, 2e-3 / self.ways.finer);
            let increments = json!({"initial": dt, "min": dt / 256.0, "max": 2.0 * dt, "error": error});
            step.insert("dt".into(), increments);
        }
    }

    /// A scheme and its increments.
    pub(super) fn of_scheme(&self, scheme: &str, step: &mut Map<String, Value>) {
        let written = match scheme {
            "static" | "quasi_dynamic" => json!("static"),
            "hht" => json!({"hht": {"alpha": -0.1}}),
            "explicit" => json!({"explicit": {"safety": 0.9 / self.ways.finer}}),
            other => json!({other: {}}),
        };
        step.insert("scheme".into(), written);
        let dt = self.write(Kind::Time, self.dt() / self.ways.finer);
        // Shorter than stability asks, which looks at one foot of a mortar point and so at the order of its segments.
        let stable = self.write(Kind::Time, 1e-4 / self.ways.finer);
        let increments = match scheme {
            "explicit" => json!({"initial": stable, "max": stable}),
            _ => json!({"initial": dt, "min": dt / 8.0, "max": dt}),
        };
        step.insert("dt".into(), increments);
    }

    /// What does not change.
    pub(super) fn first(&self, supports: &mut Vec<Value>, loads: &mut Vec<Value>) {
        let f = self.frame;
        if !self.is_rigid() {
            let zero = |_: f64| json!(0.0);
            supports.extend(f.supports(&json!(self.group("ground_bottom")), [Some(&zero), Some(&zero)]));
        }
        match self.draft.of("inclined") {
            "normal" => supports.push(json!({"on": self.group("ground_left"), "un": 0.0})),
            "direction" => {
                supports.push(json!({"on": self.group("ground_right"), "along": f.direction([1.0, 0.5]), "u": 0.0}))
            }
            _ => {}
        }
        if self.ways.wide.is_some() && !self.is_rigid() {
            let zero = |_: f64| json!(0.0);
            for side in ["left", "right", "bottom", "top"] {
                let on = json!(format!("{OUTSKIRTS}_{side}"));
                supports.extend(f.supports(&on, [Some(&zero), Some(&zero)]));
            }
        }
        if self.ways.axis_told && !self.is_rigid() {
            supports.push(json!({"on": self.group("ground_left"), "ux": "0.1*x*t"}));
        }
        if self.ways.strut.is_some() {
            let zero = |_: f64| json!(0.0);
            supports.extend(f.supports(&json!(format!("{STRUT}_left")), [Some(&zero), Some(&zero)]));
        }
        if self.is("second_contact", "tool") {
            let zero = |_: f64| json!(0.0);
            supports.extend(f.supports(&json!(STOP), [Some(&zero), Some(&zero)]));
            supports.push(json!({"on": STOP, "angle": 0.0}));
        }
        let per_length = f.unit(Kind::Force) / f.length;
        match self.draft.of("spring") {
            "no" => {}
            value => {
                let on = if self.stabilized_by_spring() { "block_top" } else { "block_right" };
                let k = if on == "block_top" { 20.0 } else { 5.0 };
                let mut spring = json!({"kx": k * per_length, "ky": k * per_length});
                if value == "driven" {
                    // As an expression, for a number would be reached with the end of the step, and the steps may be others. From
                    // rest: what slides before there is a pressure weakens, or does not, by the sign of a gap of round-off.
                    let at = f.vector(Kind::Length, [0.001 * self.ways.load, 0.0]);
                    let span = self.write(Kind::Time, self.duration());
                    let risen = format!("max(0,min(1,(t-({}))/({span})))^2", self.at(0.0));
                    spring["driver"] =
                        json!({"x": format!("({})*{risen}", at[0]), "y": format!("({})*{risen}", at[1])});
                }
                loads.push(json!({"on": self.group(on), "spring": spring}));
            }
        }
        if self.is("tool", "free") {
            let k = 400.0 * per_length;
            loads.push(json!({"on": TOOL, "spring": {"kx": k, "ky": k}}));
        }
        if self.has("dashpot") {
            let c = 0.05 * per_length * f.time * self.duration();
            loads.push(json!({"on": self.group("block_left"), "dashpot": {"cx": c, "cy": c}}));
        }
        if self.has("absorbing") {
            loads.push(json!({"on": self.group("ground_right"), "absorbing": true}));
        }
        if self.ways.bystander {
            let (zero, [first, last]) = (|_: f64| json!(0.0), ASIDE);
            let bottom = |name: &str| json!(format!("{name}_bottom"));
            supports.extend(f.supports(&bottom(first), [Some(&zero), Some(&zero)]));
            // The corner by a place that another node is nearly as near to.
            let (corner, element) = self.aside(0);
            let halfway = if is_quadratic(element) { 0.125 } else { 0.25 };
            let near = json!({"near": f.point([corner[0] + halfway - 1e-5, corner[1]])});
            supports.extend(f.supports(&near, [Some(&zero), Some(&zero)]));
            if self.flies() {
                let k = 2.0 * per_length;
                for side in ["left", "right"] {
                    loads.push(json!({"on": format!("{last}_{side}"), "spring": {"kx": k, "ky": k}}));
                }
            } else {
                supports.extend(f.supports(&bottom(last), [Some(&zero), Some(&zero)]));
            }
        }
    }

    pub(super) fn stabilized_by_spring(&self) -> bool {
        !matches!(self.draft.of("press"), "displacement" | "rotation") && !is_dynamic(self.scheme)
    }

    /// What a step changes at its beginning.
    pub(super) fn of_stage(&self, number: usize, step: &mut Map<String, Value>, loads: &mut Vec<Value>) {
        if let Some(outlet) = self.drainage().filter(|_| number == 0) {
            step.insert("drainage".into(), json!([outlet]));
        }
        if number == 1 {
            if self.is("spring", "ends") {
                let on = if self.stabilized_by_spring() { "block_top" } else { "block_right" };
                loads.push(json!({"on": self.group(on), "spring": null}));
            }
            if self.ways.bystander && self.flies() {
                for side in ["left", "right"] {
                    loads.push(json!({"on": format!("{}_{side}", ASIDE[1]), "spring": null}));
                }
            }
            match self.draft.of("flange") {
                "added" => drop(step.insert("add".into(), json!([FLANGE]))),
                "removed" => drop(step.insert("remove".into(), json!([FLANGE]))),
                _ => {}
            }
            // As an expression it jumps: the body comes warm, or what stays does not follow in the rhythm of the increments.
            if self.is("flange", "added") && self.has("heat") {
                let warmth = self.pick("warmth of flange", &[1.0, 4.0]) * self.ways.load;
                step.insert("temperature".into(), json!({FLANGE: warmth.to_string()}));
            }
            if self.is("velocity", "launch") {
                step.insert("velocity".into(), self.velocities().into());
            }
            if self.is("damping", "of_step") {
                let damping: Map<String, Value> =
                    self.blocks().into_iter().map(|body| (body.into(), self.damping(2.0))).collect();
                step.insert("damping".into(), damping.into());
            }
            if self.has("then") {
                self.of_scheme(self.draft.of("then"), step);
            }
            if self.scheme == "quasi_dynamic" {
                step.insert("scheme".into(), json!({"quasi_dynamic": {"tolerance": 1e-6 / self.ways.finer.powi(3)}}));
                step.insert("dt".into(), json!({"initial": self.write(Kind::Time, 1e-3 * self.duration())}));
            }
        }
    }

    /// How a quantity is led over a step, written along an axis of the frame: `scale` is sign and unit.
    fn drive(&self, [from, to]: [f64; 2], change: &Change, scale: f64, may_rate: bool) -> Value {
        let time = |t: f64| self.at(t);
        let span = self.write(Kind::Time, change.end - change.start);
        let mut drive = self.ways.drive.unwrap_or(self.draft.of("drive"));
        // Rates go on in the steps that follow, and a step that a reaction ends takes numbers alone where a support has them.
        let goes_on = self.is("section", "rings_on_end") || !may_rate;
        if drive == "rate" && goes_on || self.has("until") {
            drive = "number";
        }
        match drive {
            "table" => json!({"table": [[time(change.start), from * scale], [time(change.end), to * scale]]}),
            // It holds in the steps that follow as well.
            "expression" => json!(format!(
                "({})+({})*(min(t,{})-({}))",
                from * scale,
                (to - from) * scale / span,
                time(change.end),
                time(change.start)
            )),
            "rate" => json!({"rate": (to - from) * scale / span}),
            // At rest at both ends, or but where one stage follows another: there it goes on at one velocity.
            "smooth" | "through" => {
                let s = format!("max(0,min(1,(t-({}))/({span})))", time(change.start));
                let goes_on = change.goes_on.map(|goes_on| goes_on && drive == "through");
                let begins = if goes_on[0] { 1.5 * from * scale } else { 0.0 };
                let ends = if goes_on[1] { 1.5 * (to - from) * scale } else { 0.0 };
                let way = (to - from) * scale;
                let slopes = format!("({begins})*{s}*(1-{s})^2-({ends})*{s}^2*(1-{s})");
                json!(format!("({})+({way})*{s}^2*(3-2*{s})+{slopes}", from * scale))
            }
            _ => json!(to * scale),
        }
    }

    fn emit(
        &self,
        target: &Target,
        change: &Change,
        step: &mut Map<String, Value>,
        supports: &mut Vec<Value>,
        loads: &mut Vec<Value>,
    ) {
        let f = self.frame;
        let on = json!(target.on);
        let pair = |k: usize| [change.from[k], change.to[k]];
        let scalar = |kind: Kind, sign: f64| self.drive(pair(0), change, sign * f.unit(kind), false);
        let vector = |kind: Kind, unit: f64| {
            let component = |i: usize| {
                let along = [f.direction([1.0, 0.0])[i], f.direction([0.0, 1.0])[i]];
                let of = |v: [f64; 2]| along[0] * v[0] + along[1] * v[1];
                self.drive([of(change.from), of(change.to)], change, f.unit(kind) * unit, false)
            };
            // Rings have no weight along their radius.
            match target.what == What::Gravity && self.rings() {
                true => json!({"y": component(1)}),
                false => json!({"x": component(0), "y": component(1)}),
            }
        };
        match target.what {
            What::Support(held) => {
                let motion = |k: usize| move |sign: f64| self.drive(pair(k), change, sign * f.length, true);
                let [x, y] = [motion(0), motion(1)];
                supports
                    .extend(f.supports(&on, [held[0].then_some(&x as &dyn Fn(f64) -> Value), held[1].then_some(&y)]));
            }
            What::Rotation => {
                let angle = change.to[0] * f.sign();
                supports.push(json!({"on": on, "rotation": {"about": f.point([0.5, 2.0]), "angle": angle}}));
            }
            What::Angle => supports.push(json!({"on": on, "angle": self.drive(pair(0), change, f.sign(), true)})),
            What::Pressure => loads.push(json!({"on": on, "pressure": scalar(Kind::Stress, 1.0)})),
            What::DeadPressure => loads.push(json!({"on": on, "dead_pressure": scalar(Kind::Stress, 1.0)})),
            What::Traction => loads.push(json!({"on": on, "traction": vector(Kind::Stress, 1.0)})),
            What::TotalForce => loads.push(json!({"on": on, "total_force": vector(Kind::Force, 1.0)})),
            What::Force => loads.push(json!({"on": on, "force": vector(Kind::Force, 1.0)})),
            What::Gravity => {
                // Of quasi-static steps the density is light; what presses is its weight.
                loads.push(json!({"on": on, "gravity": vector(Kind::Velocity, 1.0 / f.time)}));
            }
            What::Moment => loads.push(json!({"on": on, "moment": scalar(Kind::Energy, f.sign())})),
            What::Temperature => {
                let value = match self.draft.of("heat") {
                    "table" => {
                        json!({"table": [[self.at(change.start), change.from[0]], [self.at(change.end), change.to[0]]]})
                    }
                    "by_place" => {
                        let share = format!("(T-({}))/({})", change.start, change.end - change.start);
                        json!(f.expression(
                            Kind::Number,
                            &format!(
                                "({}+({})*({share}))*(1+0.1*X*T/{})",
                                change.from[0],
                                change.to[0] - change.from[0],
                                self.duration()
                            ),
                            1.0
                        ))
                    }
                    _ => json!(change.to[0]),
                };
                let mut all = step.remove("temperature").and_then(|all| all.as_object().cloned()).unwrap_or_default();
                all.insert(target.on.clone(), value);
                step.insert("temperature".into(), all.into());
            }
        }
    }
}

/// A quantity over one step.
struct Change {
    from: [f64; 2],
    to: [f64; 2],
    start: f64,
    end: f64,
    /// whether it moves as the step begins and as it ends, where its drive is "through"
    goes_on: [bool; 2],
}

/// Tells what holds a place along both axes along a third direction as well, which it follows from.
fn tell_thrice(supports: &mut Vec<Value>) {
    let text = |drive: &Value| match drive {
        Value::String(text) => Some(text.clone()),
        Value::Number(number) if number.as_f64() == Some(0.0) => Some("0*t".into()),
        _ => None,
    };
    let third = |support: &Value| {
        let [x, y] = [text(&support["ux"])?, text(&support["uy"])?];
        let is_of_nodes = ![TOOL, STOP].iter().any(|name| support["on"] == *name);
        is_of_nodes.then(|| json!({"on": support["on"], "along": [0.6, 0.8], "u": format!("0.6*({x})+0.8*({y})")}))
    };
    supports.extend(supports.iter().filter_map(third).collect::<Vec<_>>());
}
