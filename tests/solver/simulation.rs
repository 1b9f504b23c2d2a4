//! A run as an iterator: increments dropped and made anew, saved and resumed; loads changed on the way.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::common::{self, Blocks, close, finish_at, linear, with};
use fecontact::model::builder::{Builder, LoadStep, Place, Support};
use fecontact::model::{Model, State};
use fecontact::output::fronts::{Fronts, FrontsInput};
use fecontact::output::history::History;
use fecontact::output::newton_log::NewtonLog;
use fecontact::output::warnings::Warnings;
use fecontact::run::{Axis, Observer, Saved, SavedRun, Simulation, watch};
use serde_json::{Value, json};

/// Every increment is tried and dropped, the run stopped, resumed with nothing but the bytes of a checkpoint, and the increment
/// made.
fn redone_and_resumed(model: &Arc<Model>) -> Vec<State> {
    let mut simulation = Simulation::new(model.clone());
    let mut states = Vec::new();
    while let Some(dropped) = simulation.try_increment().expect("the step begins") {
        let bytes = simulation.save().bytes().expect("it can be written");
        let saved = Saved::from_bytes(&bytes, model).expect("it can be read");
        simulation = Simulation::resume(model.clone(), saved);
        let again = simulation.try_increment().expect("it begins").expect("there is one");
        assert_eq!(dropped.is_accepted(), again.is_accepted());
        assert!(dropped.state() == again.state(), "the attempt at {} is another one", simulation.state().time);
        states.extend(again.state().cloned());
        simulation.apply(again).expect("it goes on");
    }
    states
}

#[track_caller]
pub fn check(case: &Value, path: &Path) {
    let run = finish_at(case, path);
    let states = redone_and_resumed(&run.model);
    assert_eq!(states.len(), run.states.len());
    for (k, (redone, straight)) in states.iter().zip(&run.states).enumerate() {
        assert!(redone == straight, "increment {k} has other bits, time {}", straight.time);
    }
}

/// A block pressed and dragged over another one, its contact by a method, with a scheme.
fn dragged(contact: Value, scheme: Value) -> Value {
    let mesh = Blocks::default().rectangle("ground", [12, 3], [0.0, -0.5], [3.0, 0.0]).rectangle(
        "block",
        [5, 3],
        [0.4, 0.01],
        [1.4, 0.51],
    );
    let material = json!({"model": "neo_hookean", "E": 100, "nu": 0.3, "density": 1e-4});
    let base = with(
        json!({
            "slave": "block_bottom", "master": "ground_top",
            "friction": {"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "alpha_t": 2e3, "r": 100, "kappa": 10, "xi": 0.002,
                "m": 1, "n": 1, "structure": 2.0},
        }),
        &contact,
    );
    json!({
        "mesh": mesh.json(),
        "bodies": {"ground": {"material": material}, "block": {"material": material}},
        "contacts": {"base": base},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.5, "min": 1e-4}, "supports": [
                {"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0, "uy": -0.02},
            ]},
            {"name": "drag", "duration": 4, "scheme": scheme, "dt": {"initial": 1.0, "min": 1e-4},
                "supports": [{"on": "block_top", "ux": {"rate": 0.1}}]},
        ],
    })
}

#[test]
fn every_increment_of_static_and_implicit_runs_can_be_redone_and_resumed() {
    let methods = [
        json!({"method": "node_to_segment"}),
        json!({"method": "gauss_to_segment"}),
        json!({"method": "mortar"}),
        json!({"method": "gauss_to_segment", "normal": {"penetration": 1e-6}}),
    ];
    for contact in methods {
        check(&dragged(contact, json!("static")), Path::new("test.json"));
    }
    for scheme in [json!({"hht": {"alpha": -0.1}}), json!({"newmark": {}}), json!({"wilson": {}})] {
        check(&dragged(json!({}), scheme), Path::new("test.json"));
    }
}

/// What a dropped attempt leaves behind has no say in the next one, not even in the residuals that its iterations are told with.
#[test]
fn a_dropped_attempt_leaves_the_iterations_as_they_are() {
    for (contact, scheme) in [
        (json!({}), json!("static")),
        (json!({"normal": {"penetration": 1e-6}}), json!({"newmark": {}})),
        (json!({"method": "node_to_segment"}), json!({"wilson": {}})),
    ] {
        let mut case = dragged(contact, scheme.clone());
        // Contact on linear bodies is condensed.
        for body in ["ground", "block"] {
            case["bodies"][body]["material"]["model"] = json!("linear");
        }
        let model = Arc::new(common::model(&case));
        let iterations = |drops: bool| {
            let mut simulation = Simulation::new(model.clone());
            let mut all = Vec::new();
            loop {
                if drops {
                    drop(simulation.try_increment().expect("it begins"));
                }
                let Some(candidate) = simulation.try_increment().expect("it begins") else { return all };
                all.extend_from_slice(candidate.iterations());
                simulation.apply(candidate).expect("it goes on");
            }
        };
        let (straight, dropped) = (iterations(false), iterations(true));
        assert!(straight == dropped, "{scheme}");
        assert!(straight.iter().any(|iteration| iteration.acted.condense > 0), "{scheme}");
    }
}

/// From output to output in explicit increments; and where a static step turns to them because a contact slips fast.
#[test]
fn every_stretch_of_explicit_increments_can_be_redone_and_resumed() {
    let mut explicit = dragged(json!({}), json!({"explicit": {}}));
    explicit["steps"][1]["duration"] = json!(0.02);
    explicit["output"] = json!({"interval": 5e-4});
    check(&explicit, Path::new("test.json"));
    let mut breaks =
        dragged(json!({"friction": {"law": "slip_weakening", "mu_s": 0.6, "mu_d": 0.1, "D_c": 1e-4}}), json!("static"));
    breaks["steps"][1]["rupture"] = json!({"slip_rate": 0.5});
    breaks["steps"][1]["dt"] = json!({"initial": 0.02, "min": 1e-3});
    breaks["steps"][1]["duration"] = json!(0.1);
    breaks["steps"][1]["supports"][0]["ux"] = json!({"rate": 1.0});
    let run = finish_at(&breaks, Path::new("test.json"));
    assert!(run.report.ruptures > 0, "it breaks");
    check(&breaks, Path::new("test.json"));
}

/// A caller's loads are no part of the model: a file says so, and a copy in this process has them.
#[test]
fn a_step_that_was_led_is_saved_in_the_process_alone() {
    let mut simulation = Simulation::new(pulled_square().build().expect("a good model"));
    assert!(simulation.save().bytes().is_ok());
    simulation.prescribe("square_top", Axis::Y, 0.01, 10.0).expect("a support");
    let message = simulation.save().bytes().unwrap_err().to_string();
    assert!(message.contains("step `pull` was changed by its caller"), "{message}");
    let model = simulation.model().clone();
    let mut again = Simulation::resume(model, simulation.save());
    while again.next_increment().expect("it is solved").is_some() {}
    close("led", again.displacement("square_top").expect("a group").y, 0.01, 1e-12);
}

/// Bytes of another model, or of none, are refused.
#[test]
fn bytes_of_another_model_are_refused() {
    let pulled = Simulation::new(pulled_square().build().expect("a good model"));
    let bytes = pulled.save().bytes().expect("it can be written");
    let other = Arc::new(common::model(&dragged(json!({}), json!("static"))));
    assert!(Saved::from_bytes(&bytes, &other).is_err());
    for length in 0..bytes.len() {
        assert!(Saved::from_bytes(&bytes[..length], pulled.model()).is_err(), "{length} bytes of {}", bytes.len());
    }
}

/// A square of 4 × 4 elements on rollers, pulled by its top: u_y = F L (1 − ν²)/(E W) in plane strain with free sides.
fn pulled_square() -> Builder {
    let step = LoadStep::new("pull", 10.0).dt(1.0);
    let rollers = Support::on("square_bottom").uy(0.0);
    Model::builder(Blocks::default().rectangle("square", [4, 4], [0.0, 0.0], [1.0, 1.0]).mesh())
        .body("square", linear(E, NU, 0.0))
        .step(
            step.support(rollers)
                .support(Support::on(Place::Node(0)).ux(0.0))
                .support(Support::on("square_top").uy(0.0)),
        )
}

const E: f64 = 250.0;
const NU: f64 = 0.3;

/// A testing machine: the caller leads the top so that its force becomes the one wanted, from what it measures.
#[test]
fn a_caller_controls_the_force_by_leading_a_support() {
    let (force, compliance) = (2.0, (1.0 - NU * NU) / E);
    let mut machine = Simulation::new(pulled_square().build().expect("a good model"));
    machine.prescribe("square_top", Axis::Y, 0.001, 1.0).expect("a support");
    while let Some(increment) = machine.next_increment().expect("it is solved") {
        let now = increment.state.time;
        let [measured, place] =
            [machine.reaction("square_top"), machine.displacement("square_top")].map(|v| v.unwrap().y);
        // Only half as stiff as it is: the error halves with every increment.
        machine
            .prescribe("square_top", Axis::Y, place + 0.5 * compliance * (force - measured), now + 1.0)
            .expect("a support");
    }
    let first = force - 0.001 / compliance;
    let left = force - machine.reaction("square_top").expect("a group").y;
    close("what is left of the error", left, first * 0.5f64.powi(9), 1e-6 * first);
    close("displacement", machine.displacement("square_top").unwrap().y, (force - left) * compliance, 1e-9);
}

#[test]
fn an_increment_is_rejected_by_its_caller_and_a_run_stopped() {
    let mut simulation = Simulation::new(pulled_square().build().expect("a good model"));
    simulation.prescribe("square_top", Axis::Y, 0.01, 10.0).expect("a support");
    let candidate = simulation.try_increment().expect("it begins").expect("an increment");
    assert!(
        candidate.is_accepted() && candidate.state().is_some_and(|state| state.displacement.iter().any(|u| *u != 0.0))
    );
    drop(candidate);
    assert_eq!((simulation.state().time, simulation.report().increments), (0.0, 0));
    // Led elsewhere, the same increment ends elsewhere.
    simulation.prescribe("square_top", Axis::Y, 0.002, 1.0).expect("a support");
    let taken = simulation.by_ref().take(3).map(|increment| increment.expect("it is solved").state.time);
    assert_eq!(taken.collect::<Vec<_>>(), [1.0, 2.0, 3.0]);
    close("held", simulation.displacement("square_top").unwrap().y, 0.002, 1e-12);
    simulation.stop();
    assert!(simulation.next().is_none() && simulation.is_complete());
    // What is saved of it has not been stopped.
    let saved = simulation.save();
    assert!(!saved.is_complete() && saved.begun() == 1);
    let again = Simulation::resume(simulation.model().clone(), saved);
    let times = again.map(|increment| increment.expect("it is solved").state.time);
    assert_eq!(times.collect::<Vec<_>>(), [4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0]);
}

/// What its caller has changed of a step holds to its end: after the last one nothing is changed that a file could not hold.
#[test]
fn a_run_that_was_led_to_its_end_is_saved_in_a_file() {
    let mut simulation = Simulation::new(pulled_square().build().expect("a good model"));
    simulation.prescribe("square_top", Axis::Y, 0.01, 10.0).expect("a support");
    assert_eq!(simulation.save().begun(), 1, "a step that is led has begun");
    while simulation.next_increment().expect("it is solved").is_some() {}
    let bytes = simulation.save().bytes().expect("it can be written");
    assert!(Saved::from_bytes(&bytes, simulation.model()).expect("it can be read").is_complete());
}

/// A run goes on with another model: in its own step as it was led, in those to come as the other one has them.
#[test]
fn a_run_goes_on_with_steps_that_have_changed_since() {
    let longer = |y: f64| pulled_square().step(LoadStep::new("further", 1.0).support(Support::on("square_top").uy(y)));
    let [first, second] = [0.02, 0.03].map(|y| Arc::new(longer(y).build().expect("a good model")));
    let mut simulation = Simulation::new(first);
    simulation.prescribe("square_top", Axis::Y, 0.01, 10.0).expect("a support");
    simulation.next_increment().expect("it is solved");
    let saved = simulation.save().on(&second).expect("a run of this model");
    let mut again = Simulation::resume(second, saved);
    let top = |run: &Simulation| run.displacement("square_top").expect("a group").y;
    for _ in 0..9 {
        again.next_increment().expect("it is solved");
    }
    close("led", top(&again), 0.01, 1e-12);
    while again.next_increment().expect("it is solved").is_some() {}
    close("the other model's", top(&again), 0.03, 1e-12);
    let other = Arc::new(common::model(&dragged(json!({}), json!("static"))));
    assert!(simulation.save().on(&other).is_err());
}

/// Bounds of increments are refused as those of a step are, and those that were there stay.
#[test]
fn bounds_of_increments_are_checked() {
    let mut simulation = Simulation::new(pulled_square().build().expect("a good model"));
    for (max, min, words) in [
        (Some(1e-300), None, "increments.max: is 1e-300: at the time 1e1 increments below"),
        (None, Some(1e-300), "increments.min: is 1e-300: at the time 1e1 increments below"),
        (Some(1e-10), None, "increments: increments of at most 1e-10 make 1.0e11 of them"),
        (Some(0.1), Some(0.2), "increments: min = 0.2 is above max = 0.1"),
        (Some(f64::NAN), None, "increments.max: is NaN: must be positive"),
        (None, Some(0.0), "increments.min: is 0: must be positive"),
    ] {
        let message = simulation.bound_increments(max, min).expect_err("bad bounds").to_string();
        assert!(message.starts_with(words), "{message}");
    }
    assert!(simulation.save().bytes().is_ok(), "nothing was changed");
    // A min above the new max comes down to it.
    simulation.bound_increments(Some(1e-4), None).expect("good bounds");
    assert_eq!(simulation.step().increments.min, 1e-4);
    let increment = simulation.next_increment().expect("it is solved").expect("an increment");
    close("its length", increment.state.dt, 1e-4, 1e-15);
}

#[test]
fn names_that_a_run_does_not_know_are_reported() {
    let mut simulation = Simulation::new(pulled_square().build().expect("a good model"));
    let message = [
        simulation.reaction("square_tip").unwrap_err().to_string(),
        simulation.contact_field("base", "pressure").unwrap_err().to_string(),
        simulation.prescribe("square_left", Axis::X, 0.0, 1.0).unwrap_err().to_string(),
    ];
    assert!(message[0].contains("square_tip") && message[0].contains("square_top"), "{message:?}");
    assert!(message[1].contains("no contact `base`"), "{message:?}");
    assert!(message[2].contains("`square_left` has no support along x in step `pull`"), "{message:?}");
}

/// Contact fields by name are those of the state.
#[test]
fn contact_fields_are_there_by_name() {
    let case = dragged(json!({}), json!("static"));
    let mut simulation = Simulation::new(common::model(&case));
    while simulation.next_increment().expect("it is solved").is_some() {}
    let field = |name: &str| simulation.contact_field("base", name).expect("a field");
    let points = &simulation.state().contacts[0];
    assert_eq!(field("pressure"), points.iter().map(|point| point.friction.pressure).collect::<Vec<_>>());
    let mu = field("mu");
    assert!(field("state").contains(&2.0) && mu.iter().all(|mu| (0.2..=0.4).contains(mu)), "{mu:?}");
    let message = simulation.contact_field("base", "theta").unwrap_err().to_string();
    assert!(message.contains("no field `theta`") && message.contains("structure"), "{message}");
}

/// All files of a run, but the times it took.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        match entry.is_dir() {
            true => found.extend(files(&entry)),
            false => drop(found.insert(entry.clone(), std::fs::read(&entry).expect("a file"))),
        }
    }
    found
}

/// Saved with its observers in the middle of a step, run to the end, resumed and run to the end again: tables, frames, fronts
/// and warnings are the same files to the last byte.
#[test]
fn observers_go_back_with_the_run() {
    let mut case = dragged(json!({}), json!({"newmark": {}}));
    case["steps"][1]["supports"][0]["ux"] = json!({"rate": 0.3});
    let model = Arc::new(common::model(&case));
    let folder = tempfile::tempdir().expect("a folder");
    let start = model.initial_state();
    let mut history = History::create(folder.path(), &model).expect("a table");
    let mut log = NewtonLog::create(folder.path(), &model).expect("a table");
    let mut fields = common::frames(folder.path(), &model, 2);
    let mut fronts =
        Fronts::new(folder.path(), &model, &start, FrontsInput { slip_rate: 1e-3, seismic_rate: None, arrival: None });
    let mut warnings = Warnings::default();
    let mut simulation = Simulation::new(model.clone());
    let mut observers: [&mut dyn Observer; 5] = [&mut history, &mut log, &mut fields, &mut fronts, &mut warnings];
    for _ in 0..4 {
        let candidate = simulation.try_increment().expect("it begins").expect("an increment");
        let message = simulation.attempt_of(&candidate);
        observers.iter_mut().for_each(|observer| observer.record(&model, &message).expect("it writes"));
        simulation.apply(candidate).expect("it goes on");
    }
    let saved = SavedRun::new(&simulation, &mut observers).expect("it is saved");
    let step = |simulation: &mut Simulation, observers: &mut [&mut dyn Observer]| {
        while let Some(candidate) = simulation.try_increment().expect("it begins") {
            let message = simulation.attempt_of(&candidate);
            observers.iter_mut().for_each(|observer| observer.record(&model, &message).expect("it writes"));
            simulation.apply(candidate).expect("it goes on");
        }
    };
    step(&mut simulation, &mut observers);
    // What is told so far reaches the disk with the memories.
    drop(SavedRun::new(&simulation, &mut observers).expect("it is saved"));
    let tables = |folder: &Path| ["history.csv", "newton.csv"].map(|file| std::fs::read(folder.join(file)).unwrap());
    let first = tables(folder.path());
    let mut again = saved.resume(&model, &mut observers).expect("it goes back");
    assert!(
        tables(folder.path()).iter().zip(&first).all(|(cut, whole)| cut.len() < whole.len() && whole.starts_with(cut))
    );
    watch(&mut again, &mut observers).expect("it ends");
    assert!(tables(folder.path()) == first);
    // The same as a run that never stopped.
    let straight = tempfile::tempdir().expect("a folder");
    let mut others: [Box<dyn Observer>; 5] = [
        Box::new(History::create(straight.path(), &model).expect("a table")),
        Box::new(NewtonLog::create(straight.path(), &model).expect("a table")),
        Box::new(common::frames(straight.path(), &model, 2)),
        Box::new(Fronts::new(
            straight.path(),
            &model,
            &start,
            FrontsInput { slip_rate: 1e-3, seismic_rate: None, arrival: None },
        )),
        Box::new(Warnings::default()),
    ];
    let mut others: Vec<&mut dyn Observer> =
        others.iter_mut().map(|observer| &mut **observer as &mut dyn Observer).collect();
    watch(&mut Simulation::new(model.clone()), &mut others).expect("it ends");
    let [one, other] = [folder.path(), straight.path()].map(files);
    assert!(one.len() > 8 && one.values().eq(other.values()), "{:?} and {:?}", one.keys(), other.keys());
}

/// A mass on a spring k = 10 under a force that its caller leads: u = f/k at every increment, by the closed form.
#[test]
fn loads_are_led_between_increments() {
    let document = json!({
        "mesh": {"nodes": [[0, 0]], "points": {"ball": [0]}},
        "point_masses": {"ball": {"mass": 1}},
        "steps": [{"name": "hang", "duration": 10, "dt": {"initial": 1}, "loads": [
            {"on": "ball", "spring": {"kx": 10, "ky": 10}}, {"on": "ball", "force": {"y": -2}},
        ]}],
    });
    let path = Path::new("case");
    let case = fecontact::case::from_text(&document.to_string(), path).expect("a case");
    let mut run = Simulation::new(fecontact::case::build(&case, path).expect("a model"));
    let mut loading = None;
    let mut lead = |run: &mut Simulation, load: Value, by: f64| {
        fecontact::case::loading::load(&case, path, run, &mut loading, &load, by).map_err(|error| error.to_string())
    };
    let next = |run: &mut Simulation| {
        run.next_increment().expect("it goes on").expect("there is one");
        run.displacement("ball").expect("a group").y
    };
    close("u", next(&mut run), -0.02, 1e-12);
    // From -0.2 at t = 1 to 3 at t = 5: at t = 2 it is 0.6.
    lead(&mut run, json!({"on": "ball", "force": {"y": 3}}), 5.0).expect("a load");
    close("u", next(&mut run), 0.06, 1e-12);
    // At once, and for good.
    let now = run.state().time;
    lead(&mut run, json!({"on": "ball", "force": {"y": 1}}), now).expect("a load");
    close("u", next(&mut run), 0.1, 1e-12);
    let past = lead(&mut run, json!({"on": "ball", "force": {"y": 1}}), 0.5).expect_err("that was before");
    assert_eq!(past, "case: by: is 0.5: must not be before the current time, 3");
    let unknown = lead(&mut run, json!({"on": "bal", "force": {"y": 1}}), 4.0).expect_err("there is no such group");
    assert!(unknown.starts_with("case: load.on: the mesh has no group `bal`"), "{unknown}");
    close("u", next(&mut run), 0.1, 1e-12);
}
