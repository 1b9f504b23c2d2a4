//! A model from code: the same as that of a case file that says the same, in every part and to the last bit of a run; and
//! told what is wrong with it.

mod laws;

use std::path::{Path, PathBuf};

use crate::common::{
    self, Blocks, expression, finish_at, finished, floor, linear, model, model_at, neo_hookean, saint_venant_kirchhoff,
};
use fecontact::case::law_test;
use fecontact::laws::bulk::{
    BodyLaw, BulkLaw, BulkResponse, Material, MaterialDescription, MaterialFailure, Sections, Straining, Surroundings,
};
use fecontact::laws::friction::{
    Coulomb, CoulombParameters, Description, FrictionLaw, FrictionResponse, FrictionState, Frictionless, LawFailure,
    Sliding, SlipWeakening, SlipWeakeningParameters, SuperSubloadingParameters, register,
};
use fecontact::mesh::{Mesh, Section, gmsh};
use fecontact::model::boundary::{Drive, Profile};
use fecontact::model::builder::{
    Builder, Change, Checked, Components, Contact, DashpotLoad, Friction, IncrementSettings, Load, LoadStep,
    MasterSide, Place, SpringLoad, Support,
};
use fecontact::model::{Damping, InitialStress, Method, Model, NewtonSettings, Scheme, Thermal};
use serde_json::{Value, json};

fn committed(case: &str) -> (PathBuf, Value) {
    let path = crate::common::repository("cases").join(case);
    let text = std::fs::read_to_string(&path).expect("a committed case");
    (path, serde_json::from_str(&text).expect("JSON"))
}

fn on_mesh_of((path, case): &(PathBuf, Value)) -> Builder {
    let mesh = path.parent().expect("a folder").join(case["mesh"].as_str().expect("a mesh file"));
    Model::builder(gmsh::read(&mesh).expect("a mesh")).title(case["title"].as_str().expect("a title"))
}

/// Both models, part by part as they are written out for debugging.
#[track_caller]
fn same(code: &Model, json: &Model) {
    let [code, json] = [code, json].map(|model| format!("{model:#?}"));
    let apart = code.lines().zip(json.lines()).enumerate().find(|(_, (a, b))| a != b);
    assert!(apart.is_none(), "{apart:?}");
    assert_eq!(code.len(), json.len());
}

#[track_caller]
fn built(builder: Builder) -> Model {
    builder.build().unwrap_or_else(|error| panic!("{error}"))
}

fn coulomb_drag() -> Builder {
    let elastic = || saint_venant_kirchhoff(1e9, 0.3, 0.0);
    let friction = CoulombParameters { mu: 0.3, alpha_t: Some(1e11) };
    let contact = Contact::new("base", "block_bottom", "ground_top", friction).alpha_n(1e12);
    let top = || Support::on("block_top");
    on_mesh_of(&committed("coulomb_drag_5k.json"))
        .body("block", elastic())
        .body("ground", elastic())
        .contact(contact.method(Method::GaussToSegment))
        .step(LoadStep::new("press", 5.0).dt(1.0).fix("ground_bottom").support(top().ux(0.0).uy(-1e-3)))
        .step(LoadStep::new("drag", 20.0).support(top().ux(2e-2)))
        .watch("block_top")
        .watch("ground_bottom")
}

/// A static case: inheritance of scheme, increments and supports.
#[test]
fn a_committed_case_from_code_is_the_same_model() {
    let (path, case) = committed("coulomb_drag_5k.json");
    same(&built(coulomb_drag()), &model_at(&case, &path));
}

/// Dynamics with absorbing sides, initial tractions, error control.
#[test]
fn a_committed_dynamic_case_from_code_is_the_same_model() {
    let given = committed("slip_front.json");
    let acrylic = || linear(5600.0, 0.3, 1.17e-9);
    let friction = SuperSubloadingParameters {
        kappa: 18.0,
        xi: 15.0,
        alpha_t: Some(3000.0),
        ..SuperSubloadingParameters::new(0.5, 0.1, 3600.0)
    };
    let contact = Contact::new("interface", "block_bottom", "base_top", friction).alpha_n(3000.0);
    let increments = IncrementSettings::from(0.01).min(1e-8).max(0.05).error(5e-5);
    let push = LoadStep::new("push", 3.5)
        .scheme(Scheme::GeneralizedAlpha { rho_infinity: 0.8 })
        .dt(increments)
        .fix("base_left")
        .support(Support::on("block_left").ux(Drive::Rate(0.1)).uy(0.0));
    let sides = ["block_top", "block_right", "base_bottom", "base_right"];
    let code = on_mesh_of(&given)
        .body("base", acrylic())
        .body("block", acrylic())
        .contact(contact.initial(5.0, 0.5).balanced())
        .newton(NewtonSettings { tolerance: 1e-6, ..NewtonSettings::default() })
        .step(sides.into_iter().fold(push, |push, side| push.load(Load::absorbing(side))))
        .watch("block_left");
    same(&built(code), &model_at(&given.1, &given.0));
}

/// Explicit increments, friction that varies along a fault by a table; on a mesh that is coarse and quick.
#[test]
fn a_committed_rupture_from_code_is_the_same_model() {
    let (_, mut given) = committed("rupture/tpv205.json");
    let mesh = Blocks::default().rectangle("lower", [72, 24], [-18000.0, -6000.0], [18000.0, 0.0]).rectangle(
        "upper",
        [72, 24],
        [-18000.0, 0.0],
        [18000.0, 6000.0],
    );
    given["mesh"] = mesh.json();
    let rock = || linear(80095.3008, 0.25, 0.00267);
    let pairs = |key: &Value| serde_json::from_value::<Vec<[f64; 2]>>(key["x"].clone()).expect("pairs");
    let fault = &given["contacts"]["fault"];
    let cohesion = Profile::X(pairs(&fault["along"]["cohesion"]));
    let traction = Profile::X(pairs(&fault["initial"]["traction"]));
    let friction = Friction::varying([("along.cohesion", cohesion)], |values, alpha_t| {
        let parameters = SlipWeakeningParameters {
            cohesion: values[0],
            alpha_t: Some(3203.8),
            ..SlipWeakeningParameters::new(0.677, 0.525, 0.4)
        };
        Ok(Box::new(SlipWeakening::new(&parameters, alpha_t)?))
    });
    let contact = Contact::new("fault", "upper_bottom", "lower_top", friction).alpha_n(3203.8).small_sliding();
    let damping = Damping { mass: 0.0, retardation: 0.003 };
    let step = LoadStep::new("rupture", 12.0).scheme(Scheme::Explicit { safety: 0.9 }).dt(1.0);
    let sides = ["lower_left", "lower_right", "lower_bottom", "upper_left", "upper_right", "upper_top"];
    let code = Model::builder(mesh.mesh())
        .title(given["title"].as_str().expect("a title"))
        .body("lower", rock())
        .body("upper", rock())
        .damping("lower", damping)
        .damping("upper", damping)
        .contact(contact.initial(120.0, traction).balanced())
        .step(sides.into_iter().fold(step, |step, side| step.load(Load::absorbing(side))))
        .interval(0.02);
    same(&built(code), &model(&given));
}

/// Everything else that a case can say, three steps of it: each kind of support and load given, changed and ended.
fn everything() -> (Builder, Value) {
    let blocks = || {
        Blocks::default()
            .rectangle("block", [6, 2], [0.0, 0.0], [1.5, 0.5])
            .rectangle("ground", [9, 3], [0.0, -1.0], [1.5, 0.0])
            .rectangle("ring", [3, 2], [4.0, 0.0], [5.0, 0.5])
    };
    let mut mesh = blocks().json();
    mesh["points"] = json!({"corner": [0], "pin": [63]});
    let json = json!({
        "title": "everything", "mesh": mesh,
        "bodies": {
            "block": {"material": {"model": "neo_hookean", "E": 100, "nu": 0.3, "density": 1e-3}, "element": "f_bar",
                      "damping": {"mass": 0.1, "stiffness": 1e-4}},
            "ground": {"material": {"model": "linear", "E": 50, "nu": 0.2, "density": 1e-3}},
            "ring": {"material": {"model": "linear", "E": 70, "nu": 0.1, "density": 1e-3}}
        },
        "point_masses": {"corner": {"mass": 1e-3}, "pin": {"mass": 2e-3, "velocity": [0.0, 0.0]}},
        "periodic": [["block_left", "block_right"], ["ground_left", "ground_right"]],
        "contacts": {
            "base": {"slave": "block_bottom", "master": "ground_top", "shrink_fit": true,
                     "friction": {"law": "coulomb", "mu": 0.4}, "along": {"mu": "0.3 + 0.1*x"}},
            "floor": {"slave": "ring_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}}, "points": 3,
                      "friction": {"law": "frictionless"}},
            "wall": {"slave": "ring_right", "master": {"polyline": {"points": [[5, -1], [5, 1]]}}, "smooth": false,
                     "method": "node_to_segment", "friction": {"law": "frictionless"}},
            "wheel": {"slave": "pin", "area": 0.1, "master": {"circle": {"centre": [4.0, -3.0], "radius": 3.0}},
                      "normal": {"alpha_n": 100.0}, "friction": {"law": "coulomb", "mu": 0.2, "alpha_t": 50.0}}
        },
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.5}, "stabilize": 1e-3,
             "supports": [{"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "ring_top", "rotation": {"about": [4.5, 0.5], "angle": 1e-4}},
                          {"on": {"node": 20}, "ux": "1e-4*t"}],
             "loads": [{"on": "block_top", "pressure": 0.1}, {"on": "block_top", "traction": {"x": 0.01}},
                       {"on": "block", "gravity": {"x": 0, "y": -9.81}}, {"on": "corner", "force": {"y": {"table": [[0, 0], [1, 0.01]]}}},
                       {"on": "ring_left", "spring": {"kx": 3, "driver": {"x": 1e-3}}}, {"on": "ring_left", "dashpot": {"cx": 0.1, "cy": 0.2}},
                       {"on": "ground_top", "absorbing": true}]},
            {"name": "drag", "duration": 0.5, "dt": {"initial": 0.1, "min": 1e-4}, "rupture": {"slip_rate": 10},
             "supports": [{"on": "ring_top", "rotation": null}, {"on": "ring_top", "ux": 0, "uy": -1e-4}],
             "loads": [{"on": "block_top", "pressure": 0.2}, {"on": "block_top", "traction": null}, {"on": "ring_left", "spring": null},
                       {"on": "ground_top", "absorbing": false}, {"on": "ring_left", "dashpot": {"cx": 0.1, "driver": {"x": {"rate": 0.1}}}}]},
            {"name": "swing", "duration": 0.25, "scheme": {"hht": {"alpha": -0.1}},
             "supports": [{"on": {"node": 20}, "ux": null}], "loads": [{"on": "block", "gravity": null}]}
        ],
        "watch": ["block_top", "block_left"], "newton": {"tolerance": 1e-9, "max_iterations": 30},
        "output": {"interval": 0.01}
    });
    let mut mesh = blocks().0;
    mesh.points = [("corner".into(), vec![0]), ("pin".into(), vec![63])].into();
    let base = Friction::varying([("along.mu", Profile::Expression(parsed("0.3 + 0.1*x")))], |values, alpha_t| {
        Ok(Box::new(Coulomb::new(&CoulombParameters::new(values[0]), alpha_t)?))
    });
    let base = Contact { shrink_fit: true, ..Contact::new("base", "block_bottom", "ground_top", base) };
    let on_floor = Contact { points: Some(3), ..Contact::new("floor", "ring_bottom", floor(), Frictionless) };
    let wall = MasterSide::Polyline { points: vec![[5.0, -1.0], [5.0, 1.0]] };
    let wall = Contact::new("wall", "ring_right", wall, Frictionless).method(Method::NodeToSegment);
    let wheel = MasterSide::Circle { centre: [4.0, -3.0], radius: 3.0, hole: false };
    let rubbing = CoulombParameters { mu: 0.2, alpha_t: Some(50.0) };
    let wheel = Contact::new("wheel", "pin", wheel, rubbing).area(0.1).alpha_n(100.0);
    let code = Model::builder(mesh.build().expect("a mesh"))
        .title("everything")
        .body("block", neo_hookean(100.0, 0.3, 1e-3))
        .f_bar("block")
        .damping("block", Damping { mass: 0.1, retardation: 1e-4 })
        .body("ground", linear(50.0, 0.2, 1e-3))
        .body("ring", linear(70.0, 0.1, 1e-3))
        .point_mass("corner", 1e-3)
        .moving_point_mass("pin", 2e-3, [0.0, 0.0])
        .periodic("block_left", "block_right")
        .periodic("ground_left", "ground_right")
        .contact(base)
        .contact(on_floor)
        .contact(wall)
        .contact(wheel)
        .newton(NewtonSettings { tolerance: 1e-9, max_iterations: 30 })
        .interval(0.01)
        .watch("block_top")
        .watch("block_left");
    (three_steps(code), json)
}

fn parsed(text: &str) -> fecontact::model::boundary::Expression {
    fecontact::model::boundary::Expression::parse(text).expect("an expression")
}

/// One component of a vector.
fn only(x: Option<Drive>, y: Option<Drive>) -> Components {
    Components { x, y }
}

fn three_steps(model: Builder) -> Builder {
    let along_x = |x: Drive| only(Some(x), None);
    let pulled = SpringLoad { kx: 3.0, ky: 0.0, driver: Some(along_x(1e-3.into())) };
    let moved = DashpotLoad { cx: 0.1, cy: 0.0, driver: Some(along_x(Drive::Rate(0.1))) };
    let push = only(None, Some(Drive::Table(vec![[0.0, 0.0], [1.0, 0.01]])));
    let ring = || Support::on("ring_top");
    let press = LoadStep::new("press", 1.0)
        .dt(0.5)
        .stabilize(1e-3)
        .fix("ground_bottom")
        .support(ring().rotation([4.5, 0.5], 1e-4))
        .support(Support::on(Place::Node(20)).ux(expression("1e-4*t")))
        .load(Load::pressure("block_top", 0.1))
        .load(Load::traction("block_top", Change::To(along_x(0.01.into()))))
        .load(Load::gravity("block", [0.0, -9.81]))
        .load(Load::force("corner", Change::To(push)))
        .load(Load::spring("ring_left", Change::To(pulled)))
        .load(Load::dashpot("ring_left", [0.1, 0.2]))
        .load(Load::absorbing("ground_top"));
    let drag = LoadStep::new("drag", 0.5)
        .dt(IncrementSettings { min: Some(1e-4), ..IncrementSettings::from(0.1) })
        .rupture(10.0)
        .support(Support { rotation: Some(Change::End), ..ring() })
        .support(ring().ux(0.0).uy(-1e-4))
        .load(Load::pressure("block_top", 0.2))
        .load(Load::traction("block_top", Change::End))
        .load(Load::spring("ring_left", Change::End))
        .load(Load { absorbing: Some(Change::End), ..Load::absorbing("ground_top") })
        .load(Load::dashpot("ring_left", Change::To(moved)));
    let swing = LoadStep::new("swing", 0.25)
        .scheme(Scheme::Hht { alpha: -0.1 })
        .support(Support::on(Place::Node(20)).ux(Change::End))
        .load(Load::gravity("block", Change::End));
    model.step(press).step(drag).step(swing)
}

#[test]
fn everything_from_code_is_the_same_model() {
    let (code, json) = everything();
    same(&built(code), &model(&json));
}

/// Runs of what must be the same have the same bits: a static one, and one through statics, rupture and dynamics with absorbing
/// sides, gravity, stabilization and periodic sides.
#[test]
fn a_run_from_code_has_the_bits_of_the_case() {
    let (path, case) = committed("coulomb_drag_5k.json");
    let (code, json) = everything();
    let runs = [
        (finished(built(coulomb_drag())), finish_at(&case, &path)),
        (finished(built(code)), finish_at(&json, Path::new("test.json"))),
    ];
    for (code, json) in runs {
        assert!(code.states.len() > 5 && code.last().displacement.iter().any(|u| *u != 0.0));
        assert_eq!(code.states.len(), json.states.len());
        for (a, b) in code.states.iter().zip(&json.states) {
            assert_eq!(a.displacement, b.displacement);
            assert_eq!((a.time, &a.velocity, &a.reaction), (b.time, &b.velocity, &b.reaction));
        }
    }
}

/// A block on a plane, pressed.
fn small() -> Builder {
    Model::builder(Blocks::default().rectangle("block", [2, 1], [0.0, 0.0], [2.0, 1.0]).mesh())
        .body("block", neo_hookean(100.0, 0.3, 0.0))
        .contact(on_floor())
        .step(press())
}

fn on_floor() -> Contact {
    Contact::new("base", "block_bottom", floor(), CoulombParameters::new(0.3))
}

fn press() -> LoadStep {
    LoadStep::new("press", 1.0).support(Support::on("block_top").ux(0.0).uy(-0.01))
}

/// The defaults of the documentation: α_n = 300 (λ + 2G)/h and α_t a twentieth of it, with λ + 2G = E (1 − ν)/((1 + ν)(1 − 2ν)).
#[test]
fn penalties_follow_from_the_softer_side() {
    let model = built(small());
    let modulus = 100.0 * 0.7 / (1.3 * 0.4);
    common::close("alpha_n", model.contacts[0].alpha_n, 300.0 * modulus, 1e-9 * modulus);
    common::close("alpha_t", model.contacts[0].laws[0].description.stiffness, 15.0 * modulus, 1e-9 * modulus);
}

/// What is wrong with a model from code is told with its place and what to do.
#[test]
fn what_is_wrong_is_named() {
    let top = || Support::on("block_top");
    let step = || LoadStep::new("next", 1.0);
    let other = |friction: Friction| small().contact(Contact::new("other", "block_left", floor(), friction));
    let varying = |profile: Profile| {
        other(Friction::varying([("along.mu", profile)], |values, alpha_t| {
            Ok(Box::new(Coulomb::new(&CoulombParameters::new(values[0]), alpha_t)?))
        }))
    };
    let second = |contact: Contact| small().contact(Contact { name: "b".into(), ..contact });
    for (model, words) in [
        (small().body("block", neo_hookean(1.0, 0.3, 0.0)), "bodies.block: is given twice"),
        (
            small().body("blok", neo_hookean(1.0, 0.3, 0.0)),
            "bodies.blok: the mesh has no group `blok` (did you mean `block`?)",
        ),
        (small().f_bar("blok"), "bodies.blok: there is no body `blok`; the bodies are block"),
        (small().contact(on_floor()), "contacts.base: is given twice"),
        (small().contact(Contact { name: "a,b".into(), ..on_floor() }), "contacts: the name \"a,b\" has ',' in it"),
        (second(on_floor().alpha_n(-1.0)), "contacts.b.normal.alpha_n: is -1: must be positive"),
        (second(on_floor().alpha_n(f64::NAN)), "contacts.b.normal.alpha_n: is NaN: must be positive"),
        (second(Contact { smooth: true, ..on_floor() }), "contacts.b.smooth: is for a master of mesh edges"),
        (
            small().contact(Contact::new("b", "block_left", "block_righ", Frictionless)),
            "contacts.b.master: the mesh has no group",
        ),
        (
            small().contact(Contact::new("b", "block_left", floor(), CoulombParameters::new(-0.3))),
            "contacts.b.friction: \"mu\" is -0.3, but it must be positive",
        ),
        (
            small().contact(Contact::new(
                "b",
                "block_left",
                MasterSide::Plane { point: [f64::NAN, 0.0], normal: [0.0, 1.0] },
                Frictionless,
            )),
            "contacts.b.master.plane.point: is NaN",
        ),
        (varying((-1.0).into()), "contacts.other.along.mu at (0, 0.7886751345948129): \"mu\" is -1"),
        (varying(Profile::Expression(parsed("t"))), "contacts.other.along.mu at (0, 0.7886751345948129): \"mu\" is 0"),
        (varying(Profile::Y(vec![])), "contacts.other.along.mu.y: the table is empty"),
        (small().step(step().support(top())), "steps[1].supports[0]: prescribes nothing"),
        (small().step(step().support(top().ux(f64::NAN))), "steps[1].supports[0].ux: is NaN: must be a finite number"),
        (small().step(step().fix("top")), "steps[1].supports[0].on: the mesh has no group `top`"),
        (small().step(step().fix(Place::Node(77))), "steps[1].supports[0].on: the mesh has no node 77"),
        (
            small().step(step().support(Support::on("block_bottom").ux(Change::End))),
            "steps[1].supports[0].ux: null ends what an earlier step gave, but none gave this on block_bottom",
        ),
        (small().step(step().load(Load::gravity("block", [0.0, -1.0]))), "steps[1].loads[0].on: gravity needs a mass"),
        (
            small().step(step().fix(Place::Near([0.1, 7.0]))),
            "steps[1].supports[0].on: no node is near (0.1, 7): the nearest, 3, lies ",
        ),
        (
            small().step(step().fix(Place::Near([0.5, 1.0]))),
            "steps[1].supports[0].on: nodes 3 and 4 are equally near to (0.5, 1): name one as {\"node\": 3}",
        ),
        (
            small().step(step().load(Load::force(Place::Near([f64::NAN, 7.0]), [1.0, 0.0]))),
            "steps[1].loads[0].on: near (NaN, 7) is not a position: give finite numbers",
        ),
        (
            small().step(step().load(Load::total_force(Place::Near([0.0, 0.0]), [1.0, 0.0]))),
            "steps[1].loads[0].on: the node near (0, 0) cannot carry this load",
        ),
        (
            small().step(step().load(Load::total_force("block_top", [expression("t"), expression("x*t")]))),
            "steps[1].loads[0].total_force.y: is the force on the whole group, which does not vary in space",
        ),
        (
            small().step(step().load(Load::dead_pressure("block", 1.0))),
            "steps[1].loads[0].on: `block` is a group of solid elements, not of edges",
        ),
        (
            small().step(step().load(Load::pressure(Place::Node(0), 1.0))),
            "steps[1].loads[0].on: node 0 cannot carry this load",
        ),
        (
            small().step(step().load(Load::spring("block_top", [f64::NAN, 0.0]))),
            "steps[1].loads[0].spring.kx: is NaN: must be zero or positive",
        ),
        (
            small().step(step().load(Load::spring("block_top", Change::End))),
            "steps[1].loads[0]: null ends what an earlier step gave",
        ),
        (
            small().step(step().load(Load::pressure("block_top", Drive::Table(vec![[1.0, 0.0], [0.0, 1.0]])))),
            "steps[1].loads[0].pressure: the times of the table must increase",
        ),
        (small().step(step().dt(-1.0)), "steps[1].dt.initial: is -1: must be positive"),
        (small().step(LoadStep::new("next", f64::NAN)), "steps[1].duration: is NaN: must be positive"),
        (small().step(step().scheme(Scheme::Hht { alpha: 1.0 })), "steps[1].scheme: \"alpha\" is 1"),
        (small().step(step().stabilize(2.0)), "steps[1].stabilize: is 2: must be a fraction of the stiffness"),
        (
            small().step(step().scheme(Scheme::Newmark { beta: 0.25, gamma: 0.5 })),
            "bodies.block.material.density: is 0, but the dynamic step `next`",
        ),
        (
            small().initial_velocity("block", [f64::INFINITY, 0.0]),
            "initial_velocity.block: is inf: must be a finite number",
        ),
        (small().point_mass("block_top", 0.0), "point_masses.block_top.mass: is 0: must be positive"),
        (small().watch("block_top").watch("block_top"), "watch[1]: `block_top` is watched already"),
        (
            small().newton(NewtonSettings { tolerance: 2.0, max_iterations: 9 }),
            "newton.tolerance: is 2: must be above 0 and at most 0.01",
        ),
        (small().interval(0.0), "output.interval: is 0: must be positive"),
    ] {
        let told = model.build().err().map(|error| error.to_string()).unwrap_or_default();
        assert!(told.starts_with(words), "`{words}` is not in `{told}`");
    }
}

/// Two bodies that share nodes, one after the other along a floor: the waves are those of the body whose edge is the slave's, whatever
/// the names.
#[test]
fn wave_speeds_are_those_of_the_slaves_own_body() {
    for [left, right] in [["a", "b"], ["b", "a"]] {
        let body = |young: f64| json!({"material": {"model": "linear", "E": young, "nu": 0.25, "density": 1}});
        for (slave, young) in [([0, 1], 10.0), ([1, 2], 1000.0)] {
            let model = model(&json!({
                "mesh": {
                    "nodes": [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]],
                    "elements": {left: [[0, 1, 4, 3]], right: [[1, 2, 5, 4]]}, "edges": {"slave": [slave], "top": [[4, 3], [5, 4]]},
                },
                "bodies": {left: body(10.0), right: body(1000.0)},
                "contacts": {"base": {"slave": "slave", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
                    "friction": {"law": "coulomb", "mu": 0.5}}},
                "steps": [{"name": "rest", "duration": 1, "dt": {"initial": 1}, "supports": [{"on": "top", "ux": 0, "uy": 0}]}],
            }));
            // c_s = √(G/ρ) with G = E/2.5.
            let shear = fecontact::output::events::wave_speeds(&model)[1];
            common::close("c_s", shear, (young / 2.5f64).sqrt(), 1e-12 * shear);
        }
    }
}

/// Surfaces touch within 1e-9 of the slave's shortest edge, whatever the rings or the plate weigh an edge with.
#[test]
fn surfaces_touch_within_a_share_of_an_edge() {
    for section in [json!("plane_strain"), json!("axisymmetric"), json!({"plane_stress": {"thickness": 40}})] {
        for method in ["node_to_segment", "gauss_to_segment", "mortar"] {
            let mesh = Blocks::default().rectangle("block", [4, 1], [1000.0, 0.1], [1002.0, 1.0]);
            let case = json!({
                "mesh": mesh.rectangle("ground", [3, 1], [1000.0, -1.0], [1003.0, 0.0]).json(),
                "section": section,
                "bodies": {"block": {"material": {"model": "linear", "E": 1, "nu": 0}},
                           "ground": {"material": {"model": "linear", "E": 1, "nu": 0}}},
                "contacts": {"base": {"slave": "block_bottom", "master": "ground_top", "method": method,
                                      "friction": {"law": "coulomb", "mu": 0.3}}},
                "steps": [{"name": "press", "duration": 1, "dt": {"initial": 1},
                           "supports": [{"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0, "uy": -0.1}]}],
            });
            common::close(&format!("{section} {method}"), model(&case).contacts[0].touch, 0.5e-9, 1e-18);
        }
    }
}
