//! Strength of an interface by that of the soil beside it, R c + p R tan φ, or by its own cohesion and angle.

use std::path::Path;

use fecontact::case;
use fecontact::laws::bulk::{MaterialParameters, MohrCoulombParameters};
use fecontact::laws::friction::Cohesion;
use fecontact::model::Model;
use fecontact::model::builder::{Contact, Interface, LoadStep};
use serde_json::{Value, json};

use crate::common::{self, Blocks, close, with};

fn sand() -> Value {
    json!({"model": "mohr_coulomb", "E": 2000, "nu": 0, "c": 6, "phi": 30, "psi": 0})
}

fn steel() -> Value {
    json!({"model": "linear", "E": 20000, "nu": 0})
}

/// A column pressed by 10 on another one, which yields or not, and slid.
fn columns(upper: &Value, lower: &Value, contact: &Value) -> Value {
    let block = |body: &str, low: f64, sides: [Option<&str>; 4]| json!({"body": body, "corners": [[0, low], [1, low], [1, low + 1.0], [0, low + 1.0]], "elements": [2, 2], "sides": sides});
    let base = with(json!({"slave": "bottom", "master": "top", "sliding": "small"}), contact);
    json!({
        "mesh": {"blocks": [block("wall", 0.0, [Some("bottom"), None, Some("head"), None]), block("soil", -1.0, [Some("foot"), None, Some("top"), None])]},
        "bodies": {"wall": {"material": upper}, "soil": {"material": lower}},
        "contacts": {"c": base},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 1}, "supports": [{"on": "foot", "ux": 0, "uy": 0}, {"on": "wall", "ux": 0}, {"on": "soil", "ux": 0}],
             "loads": [{"on": "head", "dead_pressure": "10"}]},
            {"name": "slide", "duration": 1, "dt": {"initial": 0.1}, "supports": [{"on": "wall", "ux": 0.05}]}
        ]
    })
}

/// c and μ of a contact.
fn strength(model: &Model) -> [f64; 2] {
    let law = &model.contacts[0].laws[0];
    let cohesion = match &law.cohesion {
        Some(Cohesion::Parallel(bond)) => bond.strength(),
        _ => 0.0,
    };
    [cohesion, law.law.description().starting_coefficient.unwrap_or(0.0)]
}

/// A share of c and of tan φ, of either side and of every law that has them.
#[test]
fn an_interface_has_a_share_of_the_strength_of_the_soil() {
    let tangent = 30f64.to_radians().tan();
    let clay = json!({"model": "mohr_coulomb", "E": 2000, "nu": 0.3, "c": 40, "phi": 0, "psi": 0});
    let metal = json!({"model": "von_mises", "E": 2000, "nu": 0.3, "sigma_y": 40.0 * 3f64.sqrt()});
    let cone = json!({"model": "drucker_prager", "E": 2000, "nu": 0.3, "c": 6, "phi": 30, "psi": 30, "matching": "plane_strain"});
    let inner = json!({"model": "drucker_prager", "E": 2000, "nu": 0.3, "c": 6, "phi": 30, "psi": 10, "matching": "compression"});
    for (soil, share, expected) in [
        (sand(), 0.67, [0.67 * 6.0, 0.67 * tangent]),
        (sand(), 1.0, [6.0, tangent]),
        (sand(), 0.0, [0.0, 0.0]),
        (clay, 0.5, [20.0, 0.0]),
        (metal, 0.5, [20.0, 0.0]),
        (cone, 0.5, [3.0, 0.5 * tangent]),
        (inner, 0.5, [3.0, 0.5 * tangent]),
    ] {
        let interface = json!({"interface": {"reduction": share}});
        for case in [columns(&steel(), &soil, &interface), columns(&soil, &steel(), &interface)] {
            let found = strength(&common::model(&case));
            (0..2).for_each(|k| close("c, tan φ", found[k], expected[k], 1e-12));
        }
    }
    // Of two soils the one that is named, or both alike.
    let weak = json!({"model": "mohr_coulomb", "E": 2000, "nu": 0, "c": 1, "phi": 20, "psi": 0});
    let found =
        strength(&common::model(&columns(&weak, &sand(), &json!({"interface": {"reduction": 0.5, "of": "soil"}}))));
    close("c", found[0], 3.0, 1e-12);
    let found = strength(&common::model(&columns(&sand(), &sand(), &json!({"interface": {"reduction": 0.5}}))));
    close("c", found[0], 3.0, 1e-12);
    let named = json!({"interface": {"cohesion": 2, "friction_angle": 25}, "bond": {"opening": 0.01}});
    let found = strength(&common::model(&columns(&steel(), &steel(), &named)));
    close("c", found[0], 2.0, 0.0);
    close("tan φ", found[1], 25f64.to_radians().tan(), 1e-12);
    let found = strength(&common::model(&columns(&steel(), &steel(), &json!({"interface": {"friction_angle": 25}}))));
    assert_eq!(found, [0.0, 25f64.to_radians().tan()]);
}

/// Slid as a whole under p = 10: q = c_i + p tan φ_i; the resolved case has friction and bond, and runs to the same bits.
#[test]
fn an_interface_is_friction_and_a_bond() {
    let case = columns(&steel(), &sand(), &json!({"interface": {"reduction": 0.6}, "bond": {"opening": 0.01}}));
    let run = common::finish(&case);
    for point in &run.last().contacts[0] {
        close("c_i + p tan φ_i", point.shear(), 0.6 * (6.0 + 10.0 * 30f64.to_radians().tan()), 1e-6);
    }
    let path = Path::new("test.json");
    let given = case::from_text(&case.to_string(), path).expect("a case");
    let model = case::build(&given, path).expect("a model");
    let resolved: Value = serde_json::from_str(&case::resolved(&given, &model)).expect("JSON");
    let contact = &resolved["contacts"]["c"];
    assert!(contact["interface"].is_null(), "{contact}");
    close("c_i", contact["bond"]["strength"].as_f64().expect("c"), 3.6, 1e-12);
    close("tan φ_i", contact["friction"]["mu"].as_f64().expect("mu"), 0.6 * 30f64.to_radians().tan(), 1e-12);
    assert!(contact["friction"]["alpha_t"].is_number(), "{contact}");
    let again = common::finish(&resolved);
    assert!(again.last() == run.last());
}

/// From Rust: the same numbers by a constructor.
#[test]
fn an_interface_from_rust() {
    let mesh = || {
        Blocks::default().rectangle("wall", [1, 1], [0.0, 0.0], [1.0, 1.0]).rectangle(
            "soil",
            [1, 1],
            [0.0, -1.0],
            [1.0, 0.0],
        )
    };
    let built = |interface: Interface| {
        let sand = MaterialParameters::MohrCoulomb(MohrCoulombParameters::new(2000.0, 0.3, [6.0, 30.0, 0.0]));
        Model::builder(mesh().mesh())
            .body("wall", common::linear(2000.0, 0.3, 0.0))
            .body("soil", sand.build().expect("good constants"))
            .contact(Contact::with_interface("c", "wall_bottom", "soil_top", interface))
            .step(LoadStep::new("press", 1.0).fix("soil_bottom").fix("wall_top"))
            .build()
            .expect("a model")
    };
    let tangent = 30f64.to_radians().tan();
    for (interface, expected) in [
        (Interface::reduced(0.5), [3.0, 0.5 * tangent]),
        (Interface::reduced(0.5).of("soil"), [3.0, 0.5 * tangent]),
        (Interface::new(2.0, 30.0), [2.0, tangent]),
    ] {
        let found = strength(&built(interface));
        (0..2).for_each(|k| close("c, tan φ", found[k], expected[k], 1e-12));
    }
}

/// What cannot be is refused with its place and what to do.
#[test]
fn interfaces_that_cannot_be_are_refused() {
    let weak = json!({"model": "mohr_coulomb", "E": 2000, "nu": 0, "c": 1, "phi": 20, "psi": 0});
    let clay =
        json!({"model": "cam_clay", "G": 2000, "lambda": 0.1, "kappa": 0.01, "M": 1, "e": 1, "p_c": 100, "p_min": 1});
    let coulomb = json!({"law": "coulomb", "mu": 0.3});
    for (upper, lower, contact, place, words) in [
        (
            steel(),
            steel(),
            json!({"interface": {"reduction": 0.5}}),
            "interface.reduction",
            "is a fraction, but none of the bodies at the contact (`soil`, `wall`)",
        ),
        (
            steel(),
            clay,
            json!({"interface": {"reduction": 0.5}}),
            "interface.reduction",
            "`cohesion` and `friction_angle`",
        ),
        (
            weak.clone(),
            sand(),
            json!({"interface": {"reduction": 0.5}}),
            "interface.reduction",
            "`soil` (c = 6, phi = 30), `wall` (c = 1, phi = 20): name one of them by \"of\"",
        ),
        (
            weak.clone(),
            sand(),
            json!({"interface": {"reduction": 0.5, "of": "sand"}}),
            "interface.of",
            "there are `soil`, `wall`",
        ),
        (
            steel(),
            sand(),
            json!({"interface": {"reduction": 0.5, "of": "wall"}}),
            "interface.reduction",
            "is a fraction, but `wall` does not yield",
        ),
        (steel(), sand(), json!({"interface": {"reduction": 1.5}}), "interface.reduction", "between 0 and 1"),
        (steel(), sand(), json!({"interface": {"reduction": 0.5, "cohesion": 1}}), "interface.cohesion", "leave one"),
        (steel(), sand(), json!({"interface": {}}), "interface.reduction", "is missing"),
        (steel(), sand(), json!({"interface": {"cohesion": 1, "of": "soil"}}), "interface.of", "leave it out"),
        (steel(), sand(), json!({"interface": {"cohesion": -1}}), "interface.cohesion", "positive"),
        (steel(), sand(), json!({"interface": {"friction_angle": 90}}), "interface.friction_angle", "less than 90"),
        (
            steel(),
            sand(),
            json!({"interface": {"reduction": 0.5}, "friction": coulomb}),
            "interface",
            "leave `friction` out",
        ),
        (steel(), sand(), json!({"interface": {"reduction": 0.5}, "tied": true}), "interface", "tied"),
        (steel(), sand(), json!({"interface": {"reduction": 0.5}, "along": {"mu": 0.2}}), "along", "written out"),
        (
            steel(),
            sand(),
            json!({"interface": {"reduction": 0.5}, "bond": {"strength": 1}}),
            "bond.strength",
            "already",
        ),
        (
            steel(),
            sand(),
            json!({"interface": {"friction_angle": 20}, "bond": {"opening": 1}}),
            "bond",
            "this one has none",
        ),
        (steel(), sand(), json!({}), "friction", "an `interface`"),
    ] {
        let mut case = columns(&upper, &lower, &contact);
        if lower["model"] == "cam_clay" {
            case["bodies"]["soil"]["initial_stress"] =
                json!({"components": {"xx": -50, "yy": -50, "zz": -50, "xy": 0}});
        }
        let refusal = common::refusal(&case);
        assert!(refusal.contains(&format!("contacts.c.{place}: ")) && refusal.contains(words), "{contact}: {refusal}");
    }
}
