//! Friction that varies along a contact by law, and in time.

use crate::common::{Blocks, Finished, close, finish, floor, linear, model, refusal, run_through};
use fecontact::contact::pair;
use fecontact::laws::friction::{
    Answer, Coulomb, CoulombParameters, Description, FrictionLaw, FrictionState, Sliding, register,
};
use fecontact::model::Model;
use fecontact::model::boundary::{Drive, Expression, Profile};
use fecontact::model::builder::{Contact, Friction, LoadStep, Support};
use serde_json::{Value, json};

/// Points on a plane, one law for those beyond x = 1.5, each pressed with 4 and held by a spring of 10 to a driver.
fn points(along: &Value, friction: &Value, duration: f64, dt: f64) -> Value {
    let loads = json!([
        {"on": "block", "force": {"y": "-4"}},
        {"on": "block", "spring": {"kx": 10, "driver": {"x": {"rate": 1}}}},
    ]);
    json!({
        "mesh": {"nodes": [[0, 0], [1, 0], [2, 0]], "points": {"block": [0, 1, 2]}},
        "point_masses": {"block": {"mass": 1}},
        "contacts": {"base": {
            "slave": "block", "area": 2, "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "normal": {"alpha_n": 1000}, "friction": friction, "along": along, "initial": {"pressure": 2},
        }},
        "newton": {"tolerance": 1e-13},
        "steps": [{"name": "pull", "duration": duration, "scheme": "static", "dt": {"initial": dt}, "loads": loads}],
    })
}

/// α_t A of every point
const CONTACT: f64 = 1e4;

fn coulomb(mu: f64) -> Value {
    json!({"law": "coulomb", "mu": mu, "alpha_t": 0.5 * CONTACT})
}

fn slips(run: &Finished) -> Vec<f64> {
    run.last().contacts[0].iter().map(|state| state.friction.plastic_slip).collect()
}

/// Creep at 0.3 beyond x = 1.5, Coulomb's law before: the spring's force is that of the law on one side, and what the given
/// slip leaves of the driver's way on the other.
#[test]
fn creep_beside_friction() {
    let creep = json!({"law": "prescribed", "slip_rate": 0.3, "alpha_t": 0.5 * CONTACT});
    let along = json!({"mu": "0.1 + 0.1*x", "law": [{"where": "x - 1.5", "friction": creep}]});
    let run = finish(&points(&along, &coulomb(0.5), 2.0, 0.125));
    let last = run.last();
    let force = |node: usize| 10.0 * (2.0 - last.displacement[2 * node]);
    close("μ p at x = 0", force(0), 0.1 * 4.0, 1e-9);
    close("μ p at x = 1", force(1), 0.2 * 4.0, 1e-9);
    close("slip of the creeping point", slips(&run)[2], 0.6, 1e-12);
    // F = k (V t − u), u = 0.6 + F/(α_t A)
    close("its force", force(2), 10.0 * 1.4 / (1.0 + 10.0 / CONTACT), 1e-9);
    close("energy error", last.energy.error(), 0.0, 1e-2 * last.energy.external_work);
}

/// A rate that varies in time enters by its mean: ∫ 0.3 t² dt = 0.8 to the last digits, whatever the increments.
#[test]
fn given_slip_is_the_integral_of_its_rate() {
    let creep = json!({"law": "prescribed", "slip_rate": 1, "alpha_t": 0.5 * CONTACT});
    for dt in [2.0, 0.5, 0.3] {
        let run = finish(&points(&json!({"slip_rate": "0.3*t^2*(1 + x)"}), &creep, 2.0, dt));
        for (slip, expected) in slips(&run).iter().zip([0.8, 1.6, 2.4]) {
            close("slip", *slip, expected, 1e-12);
        }
    }
}

/// A patch that weakens and recovers: the force of a sliding point is μ(t) p at the end of every increment, and what is observed
/// of it belongs to its time.
#[test]
fn strength_follows_the_time() {
    let mu = "0.4 - 0.2*exp(0 - (t - 2)^2)";
    let run = finish(&points(&json!({"mu": mu}), &coulomb(0.5), 4.0, 0.25));
    for state in run.states.iter().filter(|state| state.time >= 1.0) {
        let mu = 0.4 - 0.2 * (-(state.time - 2.0).powi(2)).exp();
        for contact in &state.contacts[0] {
            close("q", contact.friction.traction, mu * 2.0, 1e-10);
        }
        let pair = &run.model.contacts[0];
        let observed = pair::field_values(pair, &state.contacts[0], state.time, state.dt, "R");
        close("R", observed[1], 1.0, 1e-12);
    }
    // From Coulomb's law with a constant coefficient it differs by far.
    assert!(run.at(2.0).contacts[0][0].friction.traction < 0.41);
}

/// So it does in explicit increments.
#[test]
fn strength_follows_the_time_of_explicit_increments() {
    let mu = "0.4 - 0.2*exp(0 - (t - 2)^2)";
    let mut case = points(&json!({"mu": mu}), &coulomb(0.5), 4.0, 1e-3);
    case["steps"][0]["scheme"] = json!({"explicit": {}});
    case["steps"][0]["loads"] = json!([{"on": "block", "force": {"y": "-4"}}]);
    case["steps"][0]["supports"] = json!([{"on": "block", "ux": {"rate": 0.1}}]);
    let run = finish(&case);
    for state in run.states.iter().filter(|state| state.time >= 1.0) {
        let mu = 0.4 - 0.2 * (-(state.time - 2.0).powi(2)).exp();
        for contact in &state.contacts[0] {
            close("q", contact.friction.traction, mu * 2.0, 1e-9);
        }
    }
}

/// What is wrong is told with its place.
#[test]
fn bad_choices_are_refused() {
    let refused = |along: Value| refusal(&points(&along, &coulomb(0.5), 1.0, 0.5));
    let creep = json!({"law": "prescribed", "slip_rate": 1});
    for (along, place, what) in [
        (
            json!({"law": [{"where": "x + t", "friction": coulomb(0.1)}]}),
            "along.law[0].where",
            "the time t has no meaning",
        ),
        (
            json!({"law": [{"where": "1/x", "friction": coulomb(0.1)}]}),
            "along.law[0].where",
            "not a finite number at (0, 0)",
        ),
        (json!({"law": [{"where": 1, "friction": coulomb(-1.0)}]}), "along.law[0].friction", "mu"),
        (json!({"law": [{"where": 1, "friction": creep}]}), "along.law[0].friction.alpha_t", "is missing"),
        (
            json!({"law": [{"where": 1, "friction": coulomb(0.1), "along": {"mu": "0 - x"}}]}),
            "along.law[0].along.mu",
            "mu",
        ),
        (json!({"alpha_t": "1 + t"}), "along.alpha_t", "and not t"),
        (json!({"law": [{"on": "x"}]}), "", "where"),
    ] {
        let message = refused(along);
        assert!(message.contains(place) && message.contains(what), "{place}, {what}: {message}");
    }
}

/// Parameters of a law that a program has registered vary like those of the house, in place and time; one that the case does not
/// give is told with those that it does.
#[test]
fn parameters_of_registered_laws_vary() {
    register("along: half", |parameters, alpha_t| {
        Ok(Box::new(Coulomb::new(&CoulombParameters::new(0.5 * parameters["mu"]), alpha_t)?))
    });
    let half = json!({"law": "registered", "name": "along: half", "parameters": {"mu": 0.9}, "alpha_t": 0.5 * CONTACT});
    let [half, own] = [(half.clone(), "0.2 + 0.2*x + 0.1*t"), (coulomb(0.5), "0.1 + 0.1*x + 0.05*t")]
        .map(|(friction, mu)| finish(&points(&json!({"mu": mu}), &friction, 2.0, 0.125)));
    assert!(slips(&own)[0] > 0.5 && half.last() == own.last());
    let case = points(
        &json!({"nu": "0.1*x"}),
        &json!({"law": "registered", "name": "along: half", "parameters": {"mu": 0.9}}),
        1.0,
        0.5,
    );
    let message = refusal(&case);
    assert!(
        ["contacts.base.along.nu", "Known are `mu`, `alpha_t`"].iter().all(|what| message.contains(what)),
        "{message}"
    );
}

/// A parameter that leaves its range in time ends the run, and says when.
#[test]
fn a_parameter_that_leaves_its_range_stops_the_run() {
    let case = points(&json!({"mu": "0.5 - t"}), &coulomb(0.5), 1.0, 0.125);
    let mut run = fecontact::run::Simulation::new(model(&case));
    let mut result = run.next_increment();
    while matches!(result, Ok(Some(_))) {
        result = run.next_increment();
    }
    let message = result.err().expect("it stops").to_string();
    assert!(message.contains("the parameters of the friction law") && message.contains("along"), "{message}");
    assert!((0.4..0.5).contains(&run.state().time), "{}", run.state().time);
}

/// Where the parameters are those of another law that holds at all times, the run has the same bits: also where points touch
/// on the way, which the law of the increment has to judge, and not that of t = 0.
#[test]
fn touch_is_judged_by_the_law_of_its_time() {
    // It comes down on the plane at t = 0.67.
    let landing = |mu: Value| {
        let mut case = points(&json!({"mu": mu}), &coulomb(0.5), 1.0, 0.1);
        let contact = case["contacts"]["base"].as_object_mut().expect("a contact");
        contact.remove("initial");
        case["mesh"]["nodes"] = json!([[0, 0.067], [1, 0.067], [2, 0.067]]);
        case["steps"][0]["loads"] = json!([{"on": "block", "spring": {"kx": 100, "ky": 100,
            "driver": {"x": {"rate": 0.5}, "y": {"rate": -0.1}}}}]);
        finish(&case)
    };
    let [always, then] = [json!(0.3), json!("0.3 + 100*max(0.25 - t, 0)")].map(landing);
    assert!(always.last().contacts[0][0].friction.plastic_slip > 0.05, "it touches and slides");
    assert_eq!([always.report.rejected, always.report.increments], [then.report.rejected, then.report.increments]);
    assert!(always.last() == then.last(), "the same law, other bits");
}

/// A law that keeps four numbers of its own: Coulomb's, which counts its answers in each of them, and says that it dilates.
#[derive(Clone, Copy, Debug)]
struct Counting(Coulomb);

impl FrictionLaw for Counting {
    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Answer {
        let mut answer = self.0.respond(old, sliding)?;
        answer.state.variables = old.variables.values().map(|count| count + 1.0).collect();
        Ok(answer)
    }

    fn description(&self) -> Description {
        let variables = &["first", "second", "third", "fourth"];
        Description { variables, observables: None, opening: &["dilation"], ..self.0.description() }
    }
}

fn expression(text: &str) -> Expression {
    Expression::parse(text).expect("an expression")
}

/// A law whose parameters vary in time is asked as it is: all four of its variables are its own, and it names all it has. What is
/// observed has the parameters of its time.
#[test]
fn a_law_that_varies_in_time_keeps_all_that_it_says() {
    let dragged = |mu: &str| {
        let friction = Friction::varying([("along.mu", Profile::Expression(expression(mu)))], |values, alpha_t| {
            Ok(Box::new(Counting(Coulomb::new(&CoulombParameters::new(values[0]), alpha_t)?)))
        });
        let drawn = Support::on("slab_top").ux(Drive::Rate(0.01)).uy(0.0);
        run_through(
            Model::builder(Blocks::default().rectangle("slab", [3, 2], [0.0, 0.0], [1.0, 1.0]).mesh())
                .body("slab", linear(260.0, 0.3, 100.0))
                .contact(Contact::new("base", "slab_bottom", floor(), friction).alpha_n(1e4).initial(1.0, 0.0))
                .step(LoadStep::new("draw", 1.0).dt(0.25).support(drawn)),
        )
    };
    for mu in ["0.3", "0.3 + 0.1*t"] {
        let run = dragged(mu);
        for point in &run.last().contacts[0] {
            assert!(point.friction.variables.values().all(|count| count == 4.0), "{mu}");
        }
        let names = pair::field_names(&run.model.contacts);
        assert!(["first", "fourth", "dilation"].iter().all(|name| names.contains(name)), "{mu}: {names:?}");
    }
}

/// Friction that comes down to the dilatancy in time ends the run where it does, with both numbers, t = (0.5 − 0.35)/0.3.
#[test]
fn friction_that_falls_below_the_dilatancy_stops_the_run() {
    let mut case = points(&json!({"mu": "0.5 - 0.3*t"}), &coulomb(0.5), 1.0, 0.1);
    case["contacts"]["base"]["dilatancy"] = json!({"rate": 0.35});
    let mut run = fecontact::run::Simulation::new(model(&case));
    let message = loop {
        match run.next_increment() {
            Ok(Some(_)) => {}
            Ok(None) => panic!("it goes on where sliding produces energy"),
            Err(error) => break error.to_string(),
        }
    };
    assert!(["dilatancy.rate", "0.35", "along"].iter().all(|what| message.contains(what)), "{message}");
    assert!((0.48..=0.5).contains(&run.state().time), "{}", run.state().time);
}
