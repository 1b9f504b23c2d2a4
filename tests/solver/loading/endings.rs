//! Steps that end by a reaction.

use super::*;

/// A linear block of the stiffness k pressed at the rate v: the step ends at t = F/(k v) with F, and the next one, which draws
/// back as fast, begins there and ends at F' = F − k v t'. What was to come to a value stays in between.
#[test]
fn a_step_ends_when_a_reaction_has_its_value() {
    let press = |step: LoadStep| {
        step.support(Support::on("block_bottom").ux(0.0).uy(0.0)).support(Support::on("block_top").ux(0.0).uy(-0.1))
    };
    let whole = run_through(block(0.0, false).step(press(LoadStep::new("press", 1.0).dt(1.0))));
    let full = whole.reaction("block_top", whole.last())[1];
    for (dt, share) in [(1.0, 0.4), (0.03, 0.77)] {
        let value = share * full;
        let run = run_through(
            block(0.0, false)
                .step(press(LoadStep::new("press", 1.0).dt(dt).until("block_top", ForceComponent::Y, value)))
                .step(LoadStep::new("hold", 0.25))
                .step(LoadStep::new("back", 2.0).support(Support::on("block_top").uy(Drive::Rate(0.1))).until(
                    "block_bottom",
                    ForceComponent::Magnitude,
                    0.5 * -value,
                ))
                .step(LoadStep::new("rest", 1.0).support(Support::on("block_top").uy(Drive::Rate(0.0)))),
        );
        let force = |time: f64| run.reaction("block_top", run.at(time))[1];
        close("met", force(share), value, 1e-6 * value.abs());
        close("held", force(share + 0.25), value, 1e-6 * value.abs());
        let half = share + 0.25 + 0.5 * share;
        close("half", force(half), 0.5 * value, 1e-6 * value.abs());
        close("end", run.last().time, half + 1.0, 1e-6);
        close("rests", run.reaction("block_top", run.last())[1], 0.5 * value, 1e-6 * value.abs());
    }
}

/// A block that slides: until friction has 90 % of μ N; and what never comes stops the run and is told.
#[test]
fn a_reaction_that_is_not_reached_stops_the_run() {
    let model = |fx: f64| {
        let friction = CoulombParameters { mu: 0.3, alpha_t: Some(2e3) };
        block(0.0, true)
            .contact(Contact::new("base", "block_bottom", floor(), friction).alpha_n(4e3))
            .step(LoadStep::new("press", 1.0).dt(0.5).support(Support::on("block_top").ux(0.0).uy(-0.02)))
            .step(LoadStep::new("drag", 1.0).dt(0.25).support(Support::on("block_top").ux(Drive::Rate(0.05))).until(
                "block_top",
                ForceComponent::X,
                fx,
            ))
            .step(LoadStep::new("stay", 0.5).support(Support::on("block_top").ux(Drive::Rate(0.0))))
    };
    let never = Arc::new(model(1e3).build().expect("a model"));
    let mut record = common::Record::default();
    let (_, result) = run(&never, &mut [&mut record]);
    let [x, y] = record
        .states
        .last()
        .expect("states")
        .reaction
        .chunks_exact(2)
        .skip(15)
        .fold([0.0; 2], |[x, y], r| [x + r[0], y + r[1]]);
    let message = result.expect_err("it is not reached").to_string();
    let words = format!("step `drag` ended at time 2 before fx of `block_top` reached 1000: it is {x:.6e};");
    assert!(message.starts_with(&words), "`{words}` is not in `{message}`");
    close("slides", x, 0.3 * -y, 1e-2);
    let value = 0.9 * x;
    let run = run_through(model(value));
    let states: Vec<&State> = run.states.iter().filter(|state| state.time > 1.0).collect();
    let met = states.iter().position(|state| (run.reaction("block_top", state)[0] - value).abs() <= 1e-6 * value);
    assert!(states[met.expect("it is met")].time < 1.9, "before its time");
    close("two steps later", run.last().time, states[met.expect("met")].time + 0.5, 1e-12);
}

/// A reaction that jumps past the value ends the step behind the jump, and the user is told.
#[test]
fn a_jump_past_the_value_is_reported() {
    let jump = Drive::Table(vec![[0.0, 0.0], [0.5, -0.01], [0.5 + 1e-11, -0.03], [1.0, -0.03]]);
    let step = LoadStep::new("press", 1.0)
        .dt(0.25)
        .support(Support::on("block_bottom").ux(0.0).uy(0.0))
        .support(Support::on("block_top").ux(0.0).uy(jump))
        .until("block_top", ForceComponent::Y, -3.0);
    let model = Arc::new(block(0.0, false).step(step).build().expect("a model"));
    let mut warnings = fecontact::output::warnings::Warnings::default();
    let (_, result) = run(&model, &mut [&mut warnings]);
    close("ends at the jump", result.expect("it ends").time, 0.5, 1e-8);
    let message = warnings.list.join("\n");
    assert!(message.contains("step `press`, t = 0.5") && message.contains("past -3, where the step ends"), "{message}");
}

#[test]
fn what_a_step_cannot_end_by_is_refused() {
    let step = || {
        LoadStep::new("load", 1.0)
            .dt(0.5)
            .support(Support::on("block_bottom").ux(0.0).uy(0.0))
            .support(Support::on("block_top").uy(-0.1))
    };
    let on_top = || step().until("block_top", ForceComponent::Y, -1.0);
    for (step, words) in [
        (step().until("top", ForceComponent::Y, -1.0), "steps[0].until.on: the mesh has no group `top`"),
        (
            step().until("block_top", ForceComponent::X, -1.0),
            "steps[0].until.on: block_top has no support along x in this step",
        ),
        (
            step().until("block_right", ForceComponent::Magnitude, f64::NAN),
            "steps[0].until.force: is NaN: must be zero or positive",
        ),
        (on_top().scheme(Scheme::Explicit { safety: 0.9 }), "steps[0].until: ends static and implicit steps only"),
        (on_top().stabilize(1e-3), "steps[0].until: may end the step early, and what fades over the step"),
        (
            on_top().load(Load::total_force("block_top", [1.0, 0.0])),
            "steps[0].until: may end the step early, before a load, driver or rotation given as a number",
        ),
        (
            step().damping("blok", Damping::default()),
            "steps[0].damping.blok: there is no body `blok`; the bodies are block",
        ),
        (
            step().damping("block", Damping { mass: -1.0, retardation: 0.0 }),
            "steps[0].damping.block.mass: is -1: must be zero or positive",
        ),
    ] {
        let message = message(block(0.0, false).step(step));
        assert!(message.starts_with(words), "`{words}` is not in `{message}`");
    }
}

/// A block of ν = 0 held between its ends presses them with E α ΔT = 10 ΔT on its width of 2, ΔT = 0.4 t of a rate, say:
/// −2 at t = 0.5. The step after it goes on warming, to −6 at t = 1.5; a temperature of the step before stays.
#[test]
fn what_warms_by_the_time_of_the_run_may_end_a_step() {
    let block = || {
        Model::builder(Blocks::default().rectangle("block", [4, 3], [0.0, 0.0], [2.0, 1.0]).mesh())
            .body("block", linear(100.0, 0.0, 1.0))
            .thermal("block", Thermal { expansion: 0.05, reference: 0.0 })
    };
    let held = || LoadStep::new("warm", 1.0).dt(0.3).fix("block_bottom").support(Support::on("block_top").uy(0.0));
    let growing = BodyTemperature::Expression(Expression::parse("0.4 * t").unwrap());
    for warmth in [BodyTemperature::Rate(0.4), growing, BodyTemperature::Table(vec![[0.0, 0.0], [2.0, 0.8]])] {
        let warm = held().temperature("block", warmth).until("block_top", ForceComponent::Y, -2.0);
        let run = run_through(block().step(warm).step(LoadStep::new("on", 1.0)));
        close("met", run.reaction("block_top", run.at(0.5))[1], -2.0, 2e-6);
        close("goes on", run.reaction("block_top", run.last())[1], -6.0, 1e-5);
        close("end", run.last().time, 1.5, 1e-6);
    }
    // After −4 of a temperature, −6 by pressing: k = E A/L = 200.
    let press = Support::on("block_top").uy(Drive::Rate(-0.02));
    let press = LoadStep::new("press", 1.0).support(press).until("block_top", ForceComponent::Y, -6.0);
    let run = run_through(block().step(held().temperature("block", 0.4)).step(press));
    close("pressed", run.reaction("block_top", run.last())[1], -6.0, 6e-6);
    close("so long", run.last().time, 1.5, 1e-6);
    for given in [BodyTemperature::Constant(0.4), BodyTemperature::X(vec![[0.0, 0.2], [2.0, 0.4]])] {
        let warm = held().temperature("block", given).until("block_top", ForceComponent::Y, -2.0);
        let message = message(block().step(warm));
        let words = "steps[0].until: may end the step early, before the temperature of `block`, given as a number or \
                     by place, is fully applied: give it in the step before, or as a rate";
        assert!(message.starts_with(words), "{message}");
    }
}

/// An overlap is brought in over the whole of the first step; a later one may end by a reaction.
#[test]
fn a_shrink_fit_is_not_cut_short() {
    let model = |first: LoadStep| {
        let fit = Contact::new("fit", "block_bottom", floor(), CoulombParameters::new(0.3)).alpha_n(4e3);
        let mesh = Blocks::default().rectangle("block", [4, 3], [0.0, -0.01], [2.0, 1.0]).mesh();
        let draw = Support::on("block_top").uy(Drive::Rate(-0.01));
        Model::builder(mesh)
            .body("block", linear(100.0, 0.0, 1.0))
            .contact(Contact { shrink_fit: true, ..fit })
            .step(first.dt(0.5).support(Support::on("block_top").ux(0.0).uy(0.0)))
            .step(LoadStep::new("press", 1.0).support(draw).until("block_top", ForceComponent::Y, -2.5))
    };
    let fit = || LoadStep::new("fit", 1.0);
    let message = message(model(fit().until("block_top", ForceComponent::Y, -1.0)));
    let words = "steps[0].until: may end the step early, before the overlap of `fit`, brought in over the first step";
    assert!(message.starts_with(words), "{message}");
    let run = run_through(model(fit()));
    close("pressed", run.reaction("block_top", run.last())[1], -2.5, 2.5e-6);
}
