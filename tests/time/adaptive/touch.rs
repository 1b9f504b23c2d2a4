//! Increments that end at a touch, and friction that counts from it.

use super::*;

/// A slab of 1 × 1/2 with m elements over its height, E = 1000, which comes down through a gap of 0.01 onto a plane and
/// moves along it by as much, then is pressed in by 0.005: it touches at 2/3 of the way.
struct Slab {
    m: usize,
    material: &'static str,
    method: &'static str,
    normal: Value,
    friction: Value,
    /// Height of its bottom at the ends above that in its middle
    bow: f64,
    gap: f64,
    steps: Value,
}

const GAP: f64 = 0.01;

fn coulomb(mu: f64) -> Value {
    json!({"law": "coulomb", "mu": mu, "alpha_t": 1e6})
}

/// One step that goes all the way, in increments of this length.
fn all_the_way(dt: f64) -> Value {
    json!([{"name": "in", "duration": 1, "dt": {"initial": dt}, "supports": [{"on": "slab_top", "ux": GAP, "uy": -1.5 * GAP}]}])
}

impl Default for Slab {
    fn default() -> Self {
        let (normal, friction) = (json!({"alpha_n": 1e6}), coulomb(5.0));
        let (material, method) = ("linear", "gauss_to_segment");
        Self { m: 4, material, method, normal, friction, bow: 0.0, gap: GAP, steps: all_the_way(1.0) }
    }
}

impl Slab {
    fn case(&self) -> Value {
        let Self { m, bow, gap, .. } = *self;
        let place = |s: f64, t: f64| [s, gap + bow * (2.0 * s - 1.0).powi(2) * (1.0 - t) + 0.5 * t];
        let mut blocks = Blocks::default().block("slab", [2 * m, m], place);
        let mut bodies = json!({"slab": {"material": {"model": self.material, "E": 1000, "nu": 0.3}}});
        let mut steps = self.steps.clone();
        let mut master = json!({"plane": {"point": [0, 0], "normal": [0, 1]}});
        if self.method == "mortar" {
            blocks = blocks.rectangle("base", [2 * m + 1, 1], [-0.5, -0.2], [1.5, 0.0]);
            bodies["base"] = json!({"material": {"model": "linear", "E": 1e5, "nu": 0.3}});
            master = json!("base_top");
            let held = json!({"on": "base_bottom", "ux": 0, "uy": 0});
            steps[0]["supports"].as_array_mut().expect("supports").push(held);
        }
        json!({
            "mesh": blocks.json(), "bodies": bodies, "steps": steps,
            "contacts": {"bottom": {"slave": "slab_bottom", "master": master, "method": self.method,
                                    "normal": self.normal, "friction": self.friction}},
        })
    }

    /// The case with all of the way in increments of this length.
    fn with(&self, dt: f64) -> Finished {
        finish(&Self { steps: all_the_way(dt), ..self.copy() }.case())
    }

    fn copy(&self) -> Self {
        let (normal, friction, steps) = (self.normal.clone(), self.friction.clone(), self.steps.clone());
        Self { normal, friction, steps, ..*self }
    }

    /// The force along the plane of the same slab that starts at touch, after a flight in which it is rigid.
    fn starting_at_touch(&self, increments: f64) -> f64 {
        let supports = json!([{"on": "slab_top", "ux": GAP / 3.0, "uy": -0.5 * GAP}]);
        let steps =
            json!([{"name": "press", "duration": 1, "dt": {"initial": 1.0 / increments}, "supports": supports}]);
        shear(&finish(&Self { gap: 0.0, steps, ..self.copy() }.case()))
    }
}

fn shear(run: &Finished) -> f64 {
    run.reaction("slab_top", run.last())[0]
}

/// Solved attempts, accepted or not.
fn solved(run: &Finished) -> usize {
    run.report.increments + run.report.rejected
}

/// A point that sticks is held where it touched, not where it was when the increment began: one increment of the whole way
/// gives the force of a slab that starts at touch, for the price of two more solutions, and so do ten. Counted as if the
/// surfaces had approached at a steady rate, the force would be up to three times as large (1 increment), 20 % (10).
#[test]
fn touch_is_stepped_onto() {
    let slabs = [
        Slab { m: 2, ..Slab::default() },
        Slab { m: 4, ..Slab::default() },
        Slab { m: 8, ..Slab::default() },
        Slab { m: 16, ..Slab::default() },
        Slab { normal: json!({}), ..Slab::default() },
        Slab { normal: json!({"alpha_n": 1e8}), ..Slab::default() },
        Slab { normal: json!({"penetration": 1e-6}), ..Slab::default() },
        Slab { method: "node_to_segment", ..Slab::default() },
        Slab { method: "mortar", ..Slab::default() },
        Slab { method: "mortar", normal: json!({"penetration": 1e-6}), ..Slab::default() },
        Slab { material: "neo_hookean", ..Slab::default() },
        Slab { friction: coulomb(0.2), ..Slab::default() },
        Slab { m: 8, friction: coulomb(0.2), normal: json!({}), ..Slab::default() },
    ];
    for (number, slab) in slabs.iter().enumerate() {
        let expected = slab.starting_at_touch(20.0);
        for (dt, more, error) in [(1.0, 6, 0.05), (0.1, 4, 0.01)] {
            let run = slab.with(dt);
            let (force, extra) = (shear(&run), solved(&run) - f64::round(1.0 / dt) as usize);
            println!("slab {number}, dt {dt}: {force:.5}, from touch {expected:.5}, {extra} more solutions");
            close(&format!("slab {number}, dt {dt}: force"), force, expected, error * expected);
            // An increment that had to be cut is one more.
            assert!(extra <= more + run.report.cutbacks, "slab {number}, dt {dt}: {extra} more solutions");
        }
    }
}

/// The compliance c that helps Newton's method at touch is a number of the mesh, not of the model: what is accepted depends
/// on it by no more than the uncertainty about friction that is allowed. Points of a slab with a bow touch one after the other.
#[test]
fn accepted_friction_does_not_depend_on_the_compliance_after_touch() {
    let bowed = Slab { bow: 0.004, friction: coulomb(0.3), normal: json!({}), ..Slab::default() };
    for (number, slab) in [Slab::default(), bowed].iter().enumerate() {
        for (dt, allowed) in [(1.0, 0.02), (0.1, 0.01)] {
            let converged = shear(&slab.with(0.005));
            for factor in [0.1, 1.0, 4.0] {
                let mut model = model(&Slab { steps: all_the_way(dt), ..slab.copy() }.case());
                model.contacts[0].compliance *= factor;
                let mut record = common::Record::default();
                let model = Arc::new(model);
                run(&model, &mut [&mut record]).1.expect("a completed run");
                let last = record.states.last().expect("an increment");
                let top = model.mesh.nodes_of(model.mesh.group("slab_top").expect("a group"));
                let force: f64 = top.iter().map(|&node| last.reaction[2 * node]).sum();
                println!(
                    "slab {number}, dt {dt}, c × {factor}: {force:.5}, converged {converged:.5}, {} + {}",
                    record.states.len(),
                    record.failed
                );
                close(&format!("slab {number}, dt {dt}, c × {factor}"), force, converged, allowed * converged);
            }
        }
    }
}

/// Where friction does not ask when a point touched, no increment is repeated: sliding along at the limit of friction with
/// points that come in at the front, no friction.
#[test]
fn touch_costs_nothing_where_friction_does_not_ask() {
    let straight = |dt: f64| json!([{"name": "in", "duration": 1, "dt": {"initial": dt}, "supports": [{"on": "slab_top", "ux": 0, "uy": -1.5 * GAP}]}]);
    let frictionless = json!({"law": "frictionless"});
    for dt in [1.0, 0.1] {
        for steps in [all_the_way(dt), straight(dt)] {
            let slab = Slab { bow: 0.004, steps, friction: frictionless.clone(), ..Slab::default() };
            assert_eq!(solved(&finish(&slab.case())), f64::round(1.0 / dt) as usize);
        }
    }
    // Points that stick while the bodies widen ask for touch; that must not end a run.
    for (m, mu) in [(2, 0.3), (4, 0.2), (4, 0.5), (8, 0.3), (8, 0.5)] {
        let run = finish(&Slab { m, steps: straight(1.0), friction: coulomb(mu), ..Slab::default() }.case());
        println!("pressed, m = {m}, μ = {mu}: {} solutions, {} cut", solved(&run), run.report.cutbacks);
        assert!(solved(&run) <= 7);
    }
    // Pressed first, then dragged while it is pressed further in: the contact grows at both ends, and slides.
    let pressed = json!({"name": "in", "duration": 1, "dt": {"initial": 0.1}, "supports": [{"on": "slab_top", "ux": 0, "uy": -1.1 * GAP}]});
    let set_off = json!({"name": "set off", "duration": 1, "dt": {"initial": 0.1}, "supports": [{"on": "slab_top", "ux": 0.01, "uy": -1.1 * GAP}]});
    let dragged = json!({"name": "drag", "duration": 1, "dt": {"initial": 0.1}, "supports": [{"on": "slab_top", "ux": 0.2, "uy": -1.8 * GAP}]});
    let run = finish(
        &Slab { m: 8, bow: 0.01, friction: coulomb(0.3), steps: json!([pressed, set_off, dragged]), ..Slab::default() }
            .case(),
    );
    let dragged: Vec<&State> = run.states.iter().filter(|state| state.time > 2.0 + 1e-9).collect();
    let closed = |state: &State| state.contacts[0].iter().filter(|point| point.friction.pressure > 0.0).count();
    assert!(closed(dragged[9]) > closed(run.at(2.0)) + 2, "points come in");
    assert_eq!(dragged.len(), 10);
}

/// Where points close one after the other, as in front of a rigid ring that rolls up a bore, increments end just beyond each closure: there
/// are few more than closures, and few attempts are rejected. As long as they are after a rejection, or twice that, they take 389 solves.
#[test]
fn increments_follow_the_closures_of_a_ring_that_rolls() {
    let (radius, ring, thickness) = (156.0, 111.5, 4.0);
    let place = |radius: f64, degrees: f64| [radius * degrees.to_radians().cos(), radius * degrees.to_radians().sin()];
    let [from, to] = [250.0, 330.0];
    let corners =
        [place(radius, from), place(radius, to), place(radius + thickness, to), place(radius + thickness, from)];
    let centre = [0.0, ring - radius];
    let still = json!({"on": "seat", "ux": 0, "uy": 0});
    let run = finish(&json!({
        "mesh": {"blocks": [{"body": "outer", "kind": "Q4", "elements": [160, 4], "corners": corners,
                             "arcs": [[0, 0], null, [0, 0], null], "sides": ["bore", null, "seat", null]}]},
        "bodies": {"outer": {"material": {"model": "neo_hookean", "E": 5000, "nu": 0.3}}},
        "rigid_bodies": {"ring": {"reference": centre}},
        "contacts": {"c": {"slave": "bore", "master": {"circle": {"centre": centre, "radius": ring}}, "rigid_body": "ring",
                           "friction": {"law": "coulomb", "mu": 1.0}}},
        "steps": [
            {"name": "touch", "duration": 1, "supports": [still, {"on": "ring", "ux": 0, "uy": -0.05, "angle": 0}]},
            {"name": "weight", "duration": 1, "supports": [{"on": "ring", "uy": null}], "loads": [{"on": "ring", "force": {"y": -500}}]},
            {"name": "roll", "duration": 0.2, "dt": {"initial": 0.02}, "supports": [{"on": "ring", "ux": null, "angle": -0.12}]},
        ],
    }));
    println!(
        "{} increments, {} rejected, {} solves",
        run.report.increments, run.report.rejected, run.report.newton_iterations
    );
    assert!(run.report.newton_iterations <= 290 && run.report.rejected <= 15);
}

/// Rate-and-state friction that ages in the flight and slips after touch: in one step the friction of a slab that flies to
/// touch in a step of its own, in a hundred increments from there.
#[test]
fn laws_that_know_time_count_from_touch() {
    let friction = json!({"law": "rate_and_state", "f_0": 0.4, "V_0": 1e-3, "a": 0.01, "b": 0.015, "D_c": 1e-3, "theta": 0.1, "alpha_t": 1e6});
    let slab = Slab { friction, ..Slab::default() };
    let flight = json!({"name": "fly", "duration": 2.0 / 3.0, "dt": {"initial": 0.1}, "supports": [{"on": "slab_top", "ux": GAP / 1.5, "uy": -GAP}]});
    let pressed = json!({"name": "press", "duration": 1.0 / 3.0, "dt": {"initial": 1.0 / 300.0}, "supports": [{"on": "slab_top", "ux": GAP, "uy": -1.5 * GAP}]});
    let exact = shear(&finish(&Slab { steps: json!([flight, pressed]), ..slab.copy() }.case()));
    for (dt, more, error) in [(1.0, 6, 0.05), (0.1, 4, 0.01)] {
        // Increments of given lengths, so that touch alone shortens them.
        let mut steps = all_the_way(dt);
        steps[0]["dt"]["error"] = Value::Null;
        let run = finish(&Slab { steps, ..slab.copy() }.case());
        let extra = solved(&run) - f64::round(1.0 / dt) as usize;
        println!("dt {dt}: {:.5}, from touch {exact:.5}, {extra} more solutions", shear(&run));
        close(&format!("dt {dt}: force"), shear(&run), exact, error * exact);
        assert!(extra <= more);
    }
}

/// The slider of rate-and-state friction on springs, without mass: K (x_d − x) = q S with x = λ + q/α_t, so that q S = k (x_d − λ)
/// with 1/k = 1/K + 1/(α_t S), and the law says λ̇ and θ̇. It is driven for a second and then left alone for four months: slip
/// dies away as 1/t. By the method of Runge and Kutta with steps of a fiftieth of the shortest time of the problem.
#[test]
fn slip_is_followed_from_milliseconds_to_months() {
    let [f_0, v_0, a, b, d_c, pressure] = [0.6, 1e-6, 0.015, 0.01, 1e-4, 100.0f64];
    let (stiffness, end) = (1.0 / (1.0 / 1000.0 + 1.0 / CONTACT), 1e7);
    let driver = |t: f64| 0.2 * t.min(1.0);
    let rates = |t: f64, [slip, theta]: [f64; 2]| {
        let level = stiffness * (driver(t) - slip) / (a * pressure);
        let psi = f_0 + b * (v_0 * theta / d_c).ln();
        let rate = 2.0 * v_0 * level.sinh() * (-psi / a).exp();
        [rate, 1.0 - rate * theta / d_c]
    };
    let (mut t, mut y, mut at_rest) = (0.0f64, [0.0, 1.0], 0.0);
    while t < end {
        let [rate, _] = rates(t, y);
        let shortest = (a * pressure / (stiffness * rate.max(1e-30))).min(d_c / rate.max(1e-30));
        let to = if t < 1.0 { 1.0 } else { end };
        let h =
            (shortest / 50.0).min(0.02 * y[1]).min(if t < 1.0 { 1e-3 } else { 0.05 * (t - 1.0).max(1e-4) }).min(to - t);
        let next = |k: [f64; 2], share: f64| [y[0] + share * h * k[0], y[1] + share * h * k[1]];
        let k1 = rates(t, y);
        let k2 = rates(t + 0.5 * h, next(k1, 0.5));
        let k3 = rates(t + 0.5 * h, next(k2, 0.5));
        let k4 = rates(t + h, next(k3, 1.0));
        y = [0, 1].map(|i| y[i] + h * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]) / 6.0);
        t = if h == to - t { to } else { t + h };
        if t == 1.0 {
            at_rest = y[0];
        }
    }
    let after = y[0] - at_rest;
    println!("slip {at_rest:.6} when it is driven, {after:.6e} after");
    let table = json!({"table": [[0, 0], [1, 0.2], [1e8, 0.2]]});
    let friction = json!({"law": "rate_and_state", "f_0": f_0, "V_0": v_0, "a": a, "b": b, "D_c": d_c, "theta": 1, "alpha_t": CONTACT});
    let errors = [1e-4, 1e-5, 1e-6].map(|error: f64| {
        let mut case = Slider { spring: 1000.0, ..Slider::default() }
            .case(&json!("static"), json!({"initial": 1e-3, "error": error}));
        case["steps"][0]["duration"] = json!(1);
        case["steps"][0]["loads"] = json!([{"on": "body", "spring": {"kx": 250, "driver": {"x": table}}}]);
        for contact in ["base", "top"] {
            case["contacts"][contact]["friction"] = friction.clone();
        }
        let left = json!({"name": "left alone", "duration": end - 1.0, "dt": {"initial": 1e-3, "error": error}});
        case["steps"].as_array_mut().expect("steps").push(left);
        let run = finish(&case);
        let slip = |state: &State| state.contacts[0][0].friction.plastic_slip.abs();
        let crept = slip(run.last()) - slip(run.at(1.0));
        let driven = run.states.iter().filter(|state| state.time <= 1.0 + 1e-9).count();
        let left = run.states.len() - driven;
        println!(
            "error {error:e}: slip {:.6}, {crept:.6e} after, {driven} and {left} increments, {} rejected",
            slip(run.at(1.0)),
            run.report.rejected
        );
        close(&format!("error {error:e}: creep"), crept, after, 0.1 * after);
        // 1/√ε, for ten decades of time.
        assert!((left as f64) < 1.2 / error.sqrt(), "{left} increments");
        (crept - after).abs()
    });
    for pair in errors.windows(2) {
        assert!((1.5..6.0).contains(&(pair[0] / pair[1])), "√10 is due: {errors:?}");
    }
}

/// Where increments may not be shortened, what friction after touch may have to do with them is told, once a step; where they
/// may, there is nothing to tell.
#[test]
fn friction_left_in_doubt_by_touch_is_reported() {
    let message = |min: f64| -> Vec<String> {
        let mut steps = all_the_way(1.0);
        steps[0]["dt"]["min"] = json!(min);
        let model = model(&Slab { steps, ..Slab::default() }.case());
        let mut warnings = Warnings::default();
        let model = Arc::new(model);
        let (report, result) = run(&model, &mut [&mut warnings]);
        assert!(result.is_ok() && (report.rejected == 0) == (min == 1.0));
        warnings.list.into_iter().filter(|warning| warning.contains("friction force uncertain by")).collect()
    };
    let single = message(1.0);
    let parts = ["step `in`", "contact closed within it: friction force uncertain by", "lower dt.min"];
    assert!(single.len() == 1 && parts.iter().all(|part| single[0].contains(part)), "{single:?}");
    assert_eq!(message(1e-3), Vec::<String>::new());
}

/// A film of oil, q = η v: it resists slip and stores nothing.
#[derive(Clone, Debug)]
struct Oil(f64);

impl FrictionLaw for Oil {
    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Result<FrictionResponse, LawFailure> {
        let Sliding { slip, pressure, dt } = sliding.checked()?;
        if pressure <= 0.0 || dt == 0.0 {
            return FrictionResponse::elastic(old.stuck(0.0, pressure.max(0.0)), 0.0).checked(1.0);
        }
        let dtraction_dslip = self.0 / dt;
        let traction = dtraction_dslip * slip;
        let state = FrictionState {
            plastic_slip: old.plastic_slip + slip,
            plastic_increment: slip,
            dissipation: old.dissipation + traction * slip,
            regime: if slip == 0.0 { Regime::Stick } else { Regime::Slip },
            ..old.stuck(traction, pressure)
        };
        FrictionResponse { state, dtraction_dslip, ..Default::default() }.checked(dtraction_dslip)
    }

    fn description(&self) -> Description {
        Description::default()
    }
}

/// A periodic slab on oil, its top drawn at v from rest: s = v (t − τ (1 − e^(−t/τ))), τ = η h/G. A law without an elastic part
/// is under error control like any other, and may slip too fast for static increments.
#[test]
fn friction_that_stores_nothing_is_under_error_control() {
    const V: f64 = 1e-3;
    const TAU: f64 = 0.5;
    let slab = |step: LoadStep| {
        let mesh = Blocks::default().rectangle("slab", [4, 4], [0.0, 0.0], [1.0, 1.0]).mesh();
        let drawn = Support::on("slab_top").ux(Drive::Rate(V)).uy(0.0);
        Model::builder(mesh)
            .body("slab", linear(260.0, 0.3, 100.0))
            .periodic("slab_left", "slab_right")
            .contact(Contact::new("base", "slab_bottom", floor(), Oil(100.0 * TAU)).alpha_n(1e4).initial(1.0, 0.0))
            .step(step.support(drawn))
            .build()
            .expect("a good model")
    };
    let error = 1e-6;
    let increments = IncrementSettings::from(2.5).error(error);
    let mut run = Simulation::new(slab(LoadStep::new("draw", 5.0).dt(increments)));
    let mut worst = 0.0f64;
    while let Some(increment) = run.next_increment().expect("it is solved") {
        let t = increment.state.time;
        let exact = V * (t - TAU * (1.0 - (-t / TAU).exp()));
        let slips = run.contact_field("base", "slip").expect("a field");
        worst = slips.iter().fold(worst, |worst, slip| worst.max((slip.abs() - exact).abs()));
    }
    println!("{} increments, off by {worst:e} at most", run.report().increments);
    assert!(worst < 20.0 * error && run.report().rejected > 0, "off by {worst:e}");
    let increments = IncrementSettings::from(0.1).min(0.05);
    let mut run = Simulation::new(slab(LoadStep::new("draw", 0.6).dt(increments).rupture(0.5 * V)));
    while run.next_increment().expect("it is solved").is_some() {}
    assert!(run.report().ruptures > 0, "the slip rate passes v/2 at τ ln 2 = 0.35");
}
