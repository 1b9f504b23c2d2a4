//! The committed cases: forces against other codes, the rate of Newton's method, the same bits on any thread count.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Run a committed case with the binary; returns its output folder.
fn run(case: &str, arguments: &[&str], out: &Path) -> PathBuf {
    let case = crate::common::repository("cases").join(case);
    let mut command = Command::new(env!("CARGO_BIN_EXE_fecontact_tested"));
    let status = command.arg("run").arg(case).arg("--quiet").arg("--out").arg(out).args(arguments).status();
    assert!(status.expect("the program runs").success());
    out.to_owned()
}

/// A CSV file as rows of named columns.
fn table(path: &Path) -> Vec<BTreeMap<String, String>> {
    let text = std::fs::read_to_string(path).expect("a result file");
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned));
    let header: Vec<String> = lines.next().expect("a header").collect();
    lines.map(|row| header.iter().cloned().zip(row).collect()).collect()
}

fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column} = {} is a number", row[column]))
}

fn summary(out: &Path) -> serde_json::Value {
    serde_json::from_str(&std::fs::read_to_string(out.join("summary.json")).expect("a summary")).expect("JSON")
}

/// Largest relative difference to the reference that counts as agreement with the other codes.
const AGREEMENT: f64 = 1e-3;

/// Forces of the Coulomb drag problem against GetFEM 5.4 and CalculiX 2.20 (Gauss-point and face-to-face penalty, within
/// 3e-4 of each other on the same meshes): pressing force after the press, dragging and pressing force at the end.
fn check_coulomb_drag(case: &str, [pressed, dragging, pressing]: [f64; 3], most_solves: u64) {
    let out = tempfile::tempdir().expect("a folder");
    let out = run(case, &[], out.path());
    let (rows, summary) = (table(&out.join("history.csv")), summary(&out));
    assert_eq!(rows.len(), 25);
    let force = |row: usize, column: &str| number(&rows[row], column).abs();
    for (measured, reference, what) in [
        (force(4, "block_top.fy"), pressed, "F_n after the press"),
        (force(24, "block_top.fx"), dragging, "F_t at the end"),
        (force(24, "block_top.fy"), pressing, "F_n at the end"),
    ] {
        let difference = measured / reference - 1.0;
        println!("{case}: {what} {measured:.1}, reference {reference}: {difference:.1e}");
        assert!(difference.abs() < AGREEMENT, "{what}: {measured}, reference {reference}");
    }
    for row in &rows[10..] {
        let mobilized = number(row, "base.tangential_force") / number(row, "base.normal_force");
        assert!((mobilized - 0.3).abs() < 3e-4, "F_t/F_n = {mobilized} while everything slides");
    }
    assert_eq!(summary["cutbacks"], 0);
    let solves = summary["newton_iterations"].as_u64().expect("a count");
    println!("{case}: {solves} linear solves");
    assert!(solves <= most_solves, "{solves} linear solves");
}

#[test]
fn coulomb_drag_5k_has_the_forces_of_other_codes() {
    check_coulomb_drag("coulomb_drag_5k.json", [990_413.0, 288_252.0, 961_231.0], 75);
}

#[test]
fn coulomb_drag_20k_has_the_forces_of_other_codes() {
    check_coulomb_drag("coulomb_drag_20k.json", [987_735.0, 287_585.0, 959_026.0], 75);
}

#[test]
fn two_threads_write_the_same_bits_as_one() {
    let (one, two) = (tempfile::tempdir().expect("a folder"), tempfile::tempdir().expect("a folder"));
    run("coulomb_drag_5k.json", &["--threads", "1"], one.path());
    run("coulomb_drag_5k.json", &["--threads", "2"], two.path());
    for file in ["history.csv", "newton.csv"] {
        let read = |folder: &Path| std::fs::read(folder.join(file)).expect("a result file");
        assert!(read(one.path()) == read(two.path()), "{file} differs");
    }
}

/// The main case: slip starts at an edge and sweeps across; friction rises, peaks, falls toward μ_k; Newton's method
/// converges quadratically.
#[test]
fn block_on_ground_slips_from_the_edge_and_converges_quadratically() {
    let out = tempfile::tempdir().expect("a folder");
    let out = run("block_on_ground.json", &[], out.path());
    let rows = table(&out.join("history.csv"));
    let (mu_s, mu_k) = (0.4, 0.2);

    assert_eq!(summary(&out)["cutbacks"], 0);
    let partial = rows.iter().filter(|row| (0.02..0.98).contains(&number(row, "base.slip_fraction"))).count();
    assert!(partial >= 5, "partial slip in {partial} increments");
    let friction: Vec<f64> =
        rows.iter().map(|row| number(row, "base.tangential_force") / number(row, "base.normal_force")).collect();
    let peak = friction.iter().copied().fold(0.0, f64::max);
    let last = *friction.last().expect("increments");
    assert!(peak < mu_s && peak > 1.3 * last, "peak {peak}, end {last}");
    assert!(last > mu_k && last < 1.15 * mu_k, "end {last}");

    let mut increments: BTreeMap<String, Vec<BTreeMap<String, String>>> = BTreeMap::new();
    for row in table(&out.join("newton.csv")) {
        increments.entry(row["increment"].clone()).or_default().push(row);
    }
    // The last columns count what the aids did: increments start as the last one went on, but for the first of each step.
    let starts = |solves: &Vec<BTreeMap<String, String>>| solves.iter().map(|row| row["aid_start"] == "1").collect();
    let starts: Vec<Vec<bool>> = increments.values().map(starts).collect();
    assert!(starts.iter().all(|solves| !solves[1..].contains(&true)));
    assert!(starts.iter().filter(|solves| solves[0]).count() + 3 >= increments.len());
    let predicted_tractions: f64 = increments.values().flatten().map(|row| number(row, "aid_prediction")).sum();
    assert!(predicted_tractions > 0.0 && increments.values().flatten().all(|row| number(row, "aid_stiffening") == 0.0));
    let (mut checked, mut slow) = (0, 0);
    for (increment, solves) in &increments {
        let [.., before, last] = &solves[..] else { continue };
        let same = ["open", "stick", "slip"].iter().all(|state| before[*state] == last[*state]);
        let (residual, residual_before) = (number(last, "residual"), number(before, "residual"));
        // A correction with the tangent of the iterate before is not Newton's, and converges at another rate.
        let newton = before["factorized"] == "1" && last["factorized"] == "1";
        if newton && solves.len() >= 3 && same && residual > 1e-12 {
            let constant = residual / residual_before.powi(2);
            println!("increment {increment}: {residual_before:.1e} to {residual:.1e}, {constant:.3} times its square");
            checked += 1;
            slow += usize::from(constant > 100.0);
        }
    }
    // A foot may go over a node of the master between the last two iterates, which the counts of states do not show.
    assert!(checked >= 5 && slow <= 1, "the rate was seen in {checked} increments, and was low in {slow}");
}
