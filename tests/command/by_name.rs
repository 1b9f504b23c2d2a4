//! What a case may say for readers and editors, laws by name, and words of other programs.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::{Value, json};
use tempfile::TempDir;

use crate::input::good;

fn resolved(case: &Value) -> Result<Value, String> {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("case.json");
    fs::write(&path, case.to_string()).unwrap();
    printed(&path)
}

fn printed(path: &Path) -> Result<Value, String> {
    let output =
        Command::new(env!("CARGO_BIN_EXE_fecontact_tested")).arg("check").arg(path).arg("--resolved").output().unwrap();
    match output.status.code() {
        Some(0) => Ok(serde_json::from_slice(&output.stdout).unwrap()),
        code => {
            assert_eq!(code, Some(2));
            Err(String::from_utf8(output.stderr).unwrap())
        }
    }
}

/// The case with its laws by name, notes in all objects that have known keys, and a schema.
fn named() -> Value {
    let mut case = good();
    let friction = case["contacts"]["base"]["friction"].take();
    let material = case["bodies"]["ground"]["material"].take();
    case["materials"] = json!({"rubber": material});
    case["frictions"] = json!({"rough": friction, "smooth": {"law": "frictionless", "note": "not used"}});
    case["materials"]["rubber"]["note"] = json!("after the data sheet");
    for body in ["ground", "block"] {
        case["bodies"][body]["material"] = json!("rubber");
    }
    case["contacts"]["base"]["friction"] = json!("rough");
    for place in
        ["", "/contacts/base", "/contacts/base/normal", "/steps/0", "/steps/0/dt", "/steps/0/supports/1", "/mesh"]
    {
        case.pointer_mut(place).unwrap()["note"] = json!("a remark");
    }
    case["$schema"] = json!("case.schema.json");
    case
}

/// By name and in place, with notes and without, it is the same case.
#[test]
fn laws_by_name_are_those_in_place() {
    let plain = resolved(&good()).unwrap();
    assert_eq!(resolved(&named()).unwrap(), plain);
    assert_eq!(plain["bodies"]["block"]["material"]["E"], json!(1000.0));
    let mut along = named();
    along["contacts"]["base"]["along"] = json!({"law": [{"where": "x - 1", "friction": "smooth"}]});
    assert_eq!(
        resolved(&along).unwrap()["contacts"]["base"]["along"]["law"][0]["friction"],
        json!({"law": "frictionless"})
    );
}

/// Each mistake in such a law has its place, used or not.
#[test]
fn mistakes_in_named_laws_have_their_place() {
    let refused = |pointer: &str, value: Value| {
        let mut case = named();
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        case.pointer_mut(parent).unwrap()[key] = value;
        resolved(&case).unwrap_err()
    };
    for (pointer, value, text) in [
        ("/materials/rubber/E", json!("stiff"), "materials.rubber.E: is \"stiff\", but must be a number"),
        ("/frictions/smooth/mu", json!(0.3), "frictions.smooth.mu: `mu` is not known here"),
        ("/frictions/smooth", json!("rough"), "frictions.smooth: is \"rough\", but must be an object {…}"),
        ("/frictions", json!([]), "frictions: must be an object {…}: laws by names of your choice"),
        (
            "/contacts/base/friction",
            json!("rogh"),
            "contacts.base.friction: `rogh` is not known here; did you mean `rough`? Known are `rough`, `smooth` in \"frictions\"",
        ),
        (
            "/bodies/block/material",
            json!("steel"),
            "bodies.block.material: `steel` is not known here. Known are `rubber` in \"materials\"",
        ),
        ("/note", json!(3), "note: `note` is not known here"),
    ] {
        let message = refused(pointer, value);
        assert!(message.contains(text), "{text}: {message}");
    }
    let mut case = good();
    case["bodies"]["block"]["material"] = json!("rubber");
    let message = resolved(&case).unwrap_err();
    assert!(
        message.contains("bodies.block.material: names the law `rubber`, but the case gives no \"materials\""),
        "{message}"
    );
}

/// Words of other programs are met with the key that they are here, in this object or elsewhere.
#[test]
fn words_of_other_programs_are_translated() {
    for (pointer, text) in [
        ("/bodies/block/material/youngs_modulus", "`youngs_modulus` is not known here: here that is `E`. Known are"),
        ("/bodies/block/material/Poisson's ratio", "here that is `nu`"),
        (
            "/contacts/base/friction/friction_coefficient",
            "that is `mu` of a contact's `friction`, with \"law\": \"coulomb\"",
        ),
        ("/contacts/base/friction_coefficient", "that is `mu` of a contact's `friction`, with \"law\": \"coulomb\""),
        ("/contacts/base/secondary", "here that is `slave`"),
        ("/contacts/base/cohesion", "of an interface it is the `strength` of its contact's `bond`"),
        ("/boundary", "that is `supports` of a step"),
        ("/mesh/apart", "here that is `separated`"),
        ("/steps/0/boundary_conditions", "here that is `supports`"),
    ] {
        let mut case = good();
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        case.pointer_mut(parent).unwrap()[key] = json!(1);
        let message = resolved(&case).unwrap_err();
        assert!(message.contains(text), "{text}: {message}");
    }
}
