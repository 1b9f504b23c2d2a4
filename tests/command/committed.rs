//! The committed cases warn of nothing, but for those that are there to show it.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

use crate::common::warnings::is_listed;

/// Warnings that belong to a case: the beginning of its name, a part of the warning, and why it stays.
const SHOWN: &[(&str, &str, &str)] = &[
    (
        "paper/spring_mass_4",
        "above which the response is not unique",
        "the data of the paper pass that edge as the pressure grows (cases/paper/README.md)",
    ),
    (
        "paper/spring_mass_4.json",
        "each a row of history.csv",
        "it resolves every swing of the slowest of the paper's cases",
    ),
    (
        "coulomb_drag_",
        "tractions alternate from point to point by",
        "other codes are compared at these points with these penalties (benches/README.md)",
    ),
    (
        "coulomb_drag_",
        "gauss_to_segment on nodes that do not match",
        "other codes are compared at these points with these penalties (benches/README.md)",
    ),
    (
        "anchored_wall.json",
        "contact `inside_3`, t = 251: tractions alternate",
        "of the metre above the bottom of the pit, 5 points, forces alone are looked at",
    ),
    (
        "pile_in_clay.json",
        "contact `base`, t = 2: tractions alternate",
        "of the base of the pile, 5 points with a corner, the force alone is looked at",
    ),
    (
        "validation/ironing_",
        "a master node penetrates the slave by",
        "coarse meshes are compared with finer ones (docs/validation/ironing.md)",
    ),
    (
        "validation/ironing_q8.json",
        "a slave node is inside the master by",
        "an end of the edge behind the die's corner, which has one traction (docs/validation/ironing.md)",
    ),
    (
        "validation/hertz_q8_small_strain.json",
        "whose squares a linear body neglects",
        "what small strains leave out is compared with large ones (docs/validation/cylinder_on_block.md)",
    ),
];

/// Cases that run in about a second.
const QUICK: &[&str] = &[
    "coulomb_drag_5k.json",
    "indenter.json",
    "paper/forced_oscillation.json",
    "paper/slope.json",
    "paper/slope_damped.json",
    "paper/slope_wilson.json",
    "paper/spring_mass_3_damped.json",
    "paper/spring_mass_4_damped.json",
    "paper/spring_mass_5_damped.json",
    "pile_in_clay.json",
    "sawcut.json",
    "validation/greco.json",
    "validation/hertz_q4.json",
    "validation/wedge.json",
];

fn cases() -> PathBuf {
    crate::common::repository("cases")
}

/// All cases whose mesh is there: one is made first (`meshes/coulomb_drag.rs`). The driven laws of `cases/law` are no cases.
fn committed() -> BTreeSet<String> {
    let root = cases();
    let read = |folder: &Path| fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let folders = read(&root).filter(|path| path.is_dir() && !path.ends_with("law")).collect::<Vec<_>>();
    let files = std::iter::once(root.clone()).chain(folders).flat_map(|folder| read(&folder).collect::<Vec<_>>());
    let name = |path: PathBuf| Some(path.strip_prefix(&root).ok()?.to_str()?.replace('\\', "/"));
    let cases = files.filter(|path| path.extension().is_some_and(|kind| kind == "json")).filter_map(name);
    cases.filter(|name| name != "coulomb_drag_80k.json").collect()
}

/// The warnings among the lines of a case that should not be there.
fn unexpected(name: &str, lines: &str, mark: &str) -> Vec<String> {
    let shown = |line: &str| SHOWN.iter().any(|(case, part, _)| name.starts_with(case) && line.contains(part));
    let warnings = lines.lines().filter(|line| line.starts_with(mark));
    for told in warnings.clone() {
        assert!(is_listed(told), "docs/reference/warnings.md has no entry for: {told}");
    }
    warnings.filter(|line| !shown(line)).map(|line| format!("{name}: {line}")).collect()
}

/// Warnings of a run.
fn of_run(name: &str) -> Vec<String> {
    let folder = TempDir::new().expect("a folder");
    let mut command = Command::new(env!("CARGO_BIN_EXE_fecontact_tested"));
    command.current_dir(folder.path()).args(["run", "--quiet", "--out", "out"]).arg(cases().join(name));
    let output = command.output().expect("the program runs");
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{name}: {told}");
    println!("{name}: {}", told.lines().last().unwrap_or_default());
    unexpected(name, &told, "warning: ")
}

/// What is said of a case before it runs.
#[test]
fn the_committed_cases_are_checked_without_warnings() {
    let of_check = |name: &String| {
        let output = Command::new(env!("CARGO_BIN_EXE_fecontact_tested")).arg("check").arg(cases().join(name)).output();
        let output = output.expect("the program runs");
        assert_eq!(output.status.code(), Some(0), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        let told = String::from_utf8_lossy(&output.stdout).into_owned();
        let section = told.split_once("warnings  ").expect("the section of warnings").1;
        let warnings: Vec<&str> = section.lines().take_while(|line| !line.is_empty()).map(str::trim).collect();
        match warnings[..] {
            ["none"] => Vec::new(),
            _ => unexpected(name, &warnings.join("\n"), ""),
        }
    };
    let all = committed();
    assert!(all.len() > 40, "{all:?}");
    assert_eq!(all.iter().flat_map(of_check).collect::<Vec<_>>(), Vec::<String>::new());
}

#[test]
fn quick_committed_cases_run_without_warnings() {
    assert_eq!(QUICK.iter().flat_map(|name| of_run(name)).collect::<Vec<_>>(), Vec::<String>::new());
}

/// All others: a quarter of an hour.
#[test]
#[ignore = "slow: belongs to cases/"]
fn committed_cases_run_without_warnings() {
    let slow = committed().into_iter().filter(|name| !QUICK.contains(&name.as_str()));
    assert_eq!(slow.flat_map(|name| of_run(&name)).collect::<Vec<_>>(), Vec::<String>::new());
}
