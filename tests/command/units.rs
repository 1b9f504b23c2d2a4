//! Labels of units: what contradicts length, force and time is refused, what nothing checks is told, what follows is composed. The
//! units are those of the SI: 1 MPa = 1 N/mm² = 1000 kN/m², 1 mJ = 1 N·mm, 1 t/mm³ = 1 N·s²/mm⁴ = 10¹² kg/m³; 1 lbf/in² = 1 psi.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::{Value, json};
use tempfile::TempDir;

use crate::input::good;

fn with(units: &Value, section: &Value) -> Value {
    let mut case = good();
    case["units"] = units.clone();
    case["section"] = section.clone();
    case
}

fn told(command: &str, folder: &Path, case: &Value) -> (Option<i32>, String) {
    let file = folder.join("case.json");
    fs::write(&file, case.to_string()).unwrap();
    let mut program = Command::new(env!("CARGO_BIN_EXE_fecontact_tested"));
    let Output { status, stdout, stderr } = program.current_dir(folder).arg(command).arg(&file).output().unwrap();
    (status.code(), String::from_utf8_lossy(&stdout).into_owned() + &String::from_utf8_lossy(&stderr))
}

fn checked(units: &Value, section: &Value) -> (Option<i32>, String) {
    let folder = TempDir::new().unwrap();
    told("check", folder.path(), &with(units, section))
}

#[test]
fn labels_that_agree_are_silent() {
    let all = [
        json!({}),
        json!({"length": "m", "force": "kN", "stress": "kPa"}),
        json!({"length": "m", "force": "kN", "stress": "kN/m^2", "energy": "kJ", "temperature": "K"}),
        json!({"length": "m", "force": "MN", "stress": "MN m-2", "time": "years", "velocity": "m/a"}),
        json!({"length": "mm", "force": "N", "stress": "MPa", "energy": "mJ", "time": "s", "density": "t/mm3", "mass": "t"}),
        json!({"length": "mm", "force": "N", "time": "ms", "density": "g/mm³", "power": "W", "acceleration": "mm/ms²"}),
        json!({"length": "in", "force": "lbf", "stress": "psi"}),
        json!({"length": "mm", "force": "10^3 N", "stress": "GPa"}),
        // Per length of thickness, one of them or all.
        json!({"length": "mm", "force": "N/mm", "stress": "MPa"}),
        json!({"length": "mm", "force": "kN/m", "stress": "MPa", "work_per_area": "kJ/m²"}),
        json!({"length": "mm", "force": "N", "energy": "mJ/mm"}),
        // Names of a scaled problem.
        json!({"length": "L", "force": "F", "stress": "F/L²"}),
        json!({"length": "R", "force": "P"}),
        // Of what is not labelled nothing is known.
        json!({"length": "mm", "stress": "MPa", "energy": "mJ"}),
        json!({"stress": "MPa"}),
    ];
    for units in all {
        let (code, told) = checked(&units, &json!("plane_strain"));
        assert!(code == Some(0) && !told.contains("units."), "{units}: {told}");
    }
}

#[test]
fn a_label_that_contradicts_is_refused_with_what_it_would_be() {
    let plane = json!("plane_strain");
    let plate = json!({"plane_stress": {"thickness": 2}});
    let all = [
        (
            json!({"length": "m", "force": "kN", "stress": "MPa"}),
            &plane,
            vec!["units.stress", "\"kN/m²\" or \"kPa\"", "is 1000 times"],
        ),
        (
            json!({"length": "mm", "force": "N", "energy": "J"}),
            &plane,
            vec!["units.energy", "\"N·mm\" or \"mJ\"", "is 1000 times"],
        ),
        (json!({"length": "mm", "force": "N", "stress": "N"}), &plane, vec!["units.stress", "\"N/mm²\" or \"MPa\""]),
        (
            json!({"length": "mm", "force": "N", "time": "s", "density": "kg/m3"}),
            &plane,
            vec!["units.density", "\"N·s²/mm⁴\" or \"t/mm³\"", "is 1e-12 times"],
        ),
        (
            json!({"length": "m", "time": "s", "velocity": "mm/s"}),
            &plane,
            vec!["units.velocity", "\"m/s\"", "is 0.001 times"],
        ),
        (
            json!({"length": "mm", "stress": "MPa", "energy": "J"}),
            &plane,
            vec!["units.energy", "stresses in MPa", "\"mJ\""],
        ),
        (
            json!({"length": "m", "force": "kN/m", "stress": "MPa"}),
            &plane,
            vec!["units.stress", "\"kN/m²\" or \"kPa\""],
        ),
        (json!({"length": "mm", "force": "N/mm", "stress": "MPa"}), &plate, vec!["units.force", "whole thickness"]),
        (json!({"length": "mm", "force": "N", "energy": "mJ/mm"}), &plate, vec!["units.energy", "\"N·mm\""]),
        (json!({"force": "kg"}), &plane, vec!["units.force", "\"kg\"", "not a unit of force"]),
        (json!({"angle": "deg"}), &plane, vec!["units.angle", "rad"]),
    ];
    for (units, section, fragments) in all {
        let (code, told) = checked(&units, section);
        assert_eq!(code, Some(2), "{units}: {told}");
        fragments.into_iter().for_each(|words| assert!(told.contains(words), "{units}: `{words}` is not in: {told}"));
    }
}

#[test]
fn a_label_that_nothing_checks_is_told() {
    let plane = json!("plane_strain");
    let all = [
        (json!({"length": "m", "force": "kN", "stress": "Mpa"}), "units.stress is \"Mpa\", which cannot be checked"),
        (json!({"length": "R", "force": "F", "stress": "E"}), "units.stress is \"E\", which cannot be checked"),
        (
            json!({"length": "m", "force": "((((N", "stress": "MPa"}),
            "not known as names of units, as mm, kN, MPa, kg or h: `((((N`",
        ),
        (json!({"length": "mm", "sress": "MPa"}), "units.sress labels nothing in the results"),
    ];
    for (units, words) in all {
        let (code, told) = checked(&units, &plane);
        assert!(code == Some(0) && told.contains(words), "{units}: `{words}` is not in: {told}");
    }
}

/// A force per length of thickness, N/mm, is that of a slice of 1 mm: stresses are (N/mm)/mm.
#[test]
fn what_follows_from_a_force_per_length_is_composed() {
    let folder = TempDir::new().unwrap();
    let units = json!({"length": "mm", "force": "N/mm", "time": "s"});
    let (code, told) = told("run", folder.path(), &with(&units, &json!("plane_strain")));
    assert_eq!(code, Some(0), "{told}");
    let summary = fs::read_to_string(folder.path().join("out/case/summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    let composed = [("force", "N/mm"), ("stress", "N/mm²"), ("energy", "N·mm/mm"), ("work_per_area", "N/mm")];
    for (of, label) in composed {
        assert_eq!(summary["units"][of], json!(label), "{of}");
    }
    let array = fs::read_to_string(folder.path().join("out/case/interface.zarr/base.pressure/.zattrs")).unwrap();
    assert_eq!(serde_json::from_str::<Value>(&array).unwrap()["units"], json!("N/mm²"));
}
