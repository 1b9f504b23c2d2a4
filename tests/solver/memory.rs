//! What elements remember, beside others: two bodies ten apart, which do not know of each other.

use crate::common::{self, Blocks, Finished, close, distance, finish};
use fecontact::laws::bulk::CauchyStress;
use fecontact::output::probes::Reading;
use nalgebra::Vector2;
use serde_json::{Value, json};

/// Stress that stays in the linear body, which is held where it is.
const HELD: [f64; 3] = [-10.3, 4.2, 1.7];

fn remembering(kind: &str) -> Value {
    let [elastic, viscoelastic] = [
        json!({"model": "neo_hookean", "E": 100, "nu": 0.3, "density": 1}),
        json!({"model": "viscoelastic", "E": 100, "nu": 0.3, "E_1": 100, "tau": 2, "density": 1}),
    ];
    let stress = json!({"components": {"xx": 3, "yy": 0, "zz": "1 + y"}});
    match kind {
        "viscoelastic" => json!({"material": viscoelastic}),
        "stressed" => json!({"material": elastic, "initial_stress": stress}),
        "heated" => json!({"material": elastic, "initial_stress": stress, "thermal": {"expansion": 1e-3}}),
        kind => panic!("no body is {kind}"),
    }
}

/// A bar of the group `soft` that remembers and is stretched, and one of the group `hard` under a stress that stays there. The names of
/// the bodies decide their order, and the order of blocks that of the elements.
fn apart(kind: &str, scheme: &Value, [soft, hard]: [&str; 2], hard_first: bool) -> Value {
    let of_soft = |mesh: Blocks| mesh.rectangle(soft, [4, 2], [0.0, 0.0], [2.0, 1.0]);
    let of_hard = |mesh: Blocks| mesh.rectangle(hard, [3, 2], [12.0, 0.0], [14.0, 1.0]);
    let mesh = if hard_first { of_soft(of_hard(Blocks::default())) } else { of_hard(of_soft(Blocks::default())) };
    let [xx, yy, zz] = HELD;
    let mut step = json!({
        "name": "stretch", "duration": 1, "dt": {"initial": 0.25}, "scheme": scheme,
        "supports": [{"on": format!("{soft}_left"), "ux": 0, "uy": 0}, {"on": format!("{soft}_right"), "ux": 0.1},
            {"on": hard, "ux": 0, "uy": 0}]
    });
    if kind == "heated" {
        step["temperature"] = json!({soft: "10*t*x"});
    }
    json!({
        "mesh": mesh.json(),
        "bodies": {
            soft: remembering(kind),
            hard: {"material": {"model": "linear", "E": 500, "nu": 0.2, "density": 1},
                "initial_stress": {"components": {"xx": xx, "yy": yy, "zz": zz}}},
        },
        "probes": {"in_soft": {"at": [0.7, 0.4]}, "in_hard": {"at": [13.1, 0.6]}},
        "newton": {"tolerance": 1e-12},
        "steps": [step],
    })
}

/// The body that remembers, without the other one.
fn alone(kind: &str, scheme: &Value) -> Value {
    let mut case = apart(kind, scheme, ["soft", "hard"], false);
    case["mesh"] = Blocks::default().rectangle("soft", [4, 2], [0.0, 0.0], [2.0, 1.0]).json();
    case["bodies"].as_object_mut().expect("bodies").remove("hard");
    case["probes"].as_object_mut().expect("probes").remove("in_hard");
    case["steps"][0]["supports"].as_array_mut().expect("a list").pop();
    case
}

fn read(run: &Finished, probe: &str) -> CauchyStress {
    let found = run.model.requests.probes.iter().find(|known| known.name == probe).expect("the probe");
    Reading::of(found, &run.model, run.last()).stress
}

fn parts(stress: &CauchyStress) -> [f64; 4] {
    [stress.xx, stress.yy, stress.zz, stress.xy]
}

/// Stresses at the integration points of a group.
fn stresses(run: &Finished, group: &str) -> Vec<CauchyStress> {
    let (model, state) = (&run.model, run.last());
    let body = model.bodies.iter().find(|body| body.name == group).expect("the body");
    let of = |&e: &usize| {
        let nodes = model.mesh.elements[e].nodes.iter();
        let u: Vec<_> =
            nodes.map(|&n| Vector2::new(state.displacement[2 * n], state.displacement[2 * n + 1])).collect();
        model.solids[e].stresses(&*body.material, model.memories.of(e, &state.memory), &u).expect("an answer")
    };
    body.elements.iter().flat_map(of).collect()
}

/// Force, stress and motion of the body that remembers are those it has alone, and the other one keeps its stress, whichever of them
/// comes first.
#[test]
fn bodies_that_do_not_touch_remember_each_for_itself() {
    for scheme in [json!("static"), json!({"newmark": {}}), json!({"explicit": {}})] {
        for kind in ["viscoelastic", "stressed", "heated"] {
            let alone = finish(&alone(kind, &scheme));
            let force = alone.reaction("soft_right", alone.last())[0];
            assert!(force.abs() > 1.0, "{force}");
            for (names, hard_first) in [(["soft", "zzz"], false), (["soft", "aaa"], true), (["soft", "aaa"], false)] {
                let run = finish(&apart(kind, &scheme, names, hard_first));
                // Explicit increments have another length beside the stiffer body.
                let tolerance = if scheme.get("explicit").is_some() { 5e-3 } else { 1e-10 };
                close(kind, run.reaction("soft_right", run.last())[0], force, tolerance * force.abs());
                let [there, here] = [&run, &alone].map(|run| parts(&read(run, "in_soft")));
                close(kind, distance(&there, &here), 0.0, 10.0 * tolerance);
                for (beside, lone) in stresses(&run, "soft").iter().zip(&stresses(&alone, "soft")) {
                    close(kind, distance(&parts(beside), &parts(lone)), 0.0, 40.0 * tolerance);
                }
                let [xx, yy, zz] = HELD;
                for stress in stresses(&run, names[1]).iter().chain([&read(&run, "in_hard")]) {
                    close(kind, distance(&parts(stress), &[xx, yy, zz, 0.0]), 0.0, 1e-12);
                }
            }
        }
    }
}

/// In a bar under one stress everywhere a probe reads the force on its end over the height there, whatever the bar remembers.
#[test]
fn a_probe_reads_the_stress_of_a_body_that_remembers() {
    let yielding = json!({"model": "von_mises", "E": 100, "nu": 0.3, "sigma_y": 2, "H": 10});
    for material in [remembering("viscoelastic")["material"].clone(), yielding] {
        let mut case = alone("viscoelastic", &json!("static"));
        case["bodies"]["soft"]["material"] = material;
        case["steps"][0]["supports"] = json!([{"on": "soft_left", "ux": 0}, {"on": "soft_bottom", "uy": 0},
            {"on": "soft_right", "ux": 0.1}]);
        let run = finish(&case);
        let sunk = run.last().displacement.iter().skip(1).step_by(2).copied().fold(0.0, f64::min);
        let height = 1.0 + sunk;
        let force = run.reaction("soft_right", run.last())[0];
        assert!(force > 1.0 && height < 0.99, "{force} over {height}");
        close("stress", read(&run, "in_soft").xx * height, force, 1e-9 * force);
    }
}

/// Every element has as much room as its points and variables need, behind that of the one before, and all together are the state's.
#[test]
fn every_element_has_a_place_of_its_own() {
    let model = common::model(&apart("heated", &json!("static"), ["soft", "aaa"], true));
    let memory: Vec<f64> = (0..model.initial_state().memory.len()).map(|k| k as f64).collect();
    let mut next = 0.0;
    for (e, &body) in model.body_of_element.iter().enumerate() {
        let own = model.memories.of(e, &memory);
        assert_eq!(
            own.len(),
            model.solids[e].quadrature_points() * model.bodies[body].material.description().variables.len()
        );
        assert!(own.iter().enumerate().all(|(k, value)| *value == next + k as f64));
        next += own.len() as f64;
    }
    assert_eq!(next, memory.len() as f64);
    let mut copy = memory.clone();
    for (e, own) in model.memories.each_mut(&mut copy).enumerate() {
        assert_eq!(own, model.memories.of(e, &memory));
    }
}
