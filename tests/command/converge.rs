//! `fecontact converge`: refinement of cases, and what is made of the numbers of their runs.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use fecontact::case::convergence::{Convergence, Measure, WITHIN, judge};
use fecontact::case::{self, Halvings, Written};
use fecontact::mesh::{Group, InlineMesh, Mesh};
use fecontact::model::Model;
use serde_json::{Value, json};
use tempfile::TempDir;

fn fecontact(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fecontact_tested"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("the program runs")
}

/// A thick tube under a pressure inside, of so many bilinear elements, and Lamé's displacement of its bore.
fn tube(elements: u32) -> (Value, f64) {
    let (a, b, p, young, nu): (f64, f64, f64, f64, f64) = (1.0, 2.0, 0.7, 200.0, 0.3);
    let mesh = json!({
        "parameters": {"n": elements},
        "blocks": [{"body": "tube", "corners": [[a, 0], [b, 0], [b, 0.5], [a, 0.5]], "elements": ["n", 1], "grading": [2, 1],
            "sides": ["bottom", null, "top", "bore"]}],
    });
    let case = json!({
        "section": "axisymmetric", "mesh": mesh, "watch": ["bore"],
        "bodies": {"tube": {"material": {"model": "linear", "E": young, "nu": nu}}},
        "steps": [{"name": "load", "duration": 1, "dt": {"initial": 0.5},
            "supports": [{"on": "bottom", "uy": 0}, {"on": "top", "uy": 0}], "loads": [{"on": "bore", "traction": {"x": p}}]}],
    });
    (case, (1.0 + nu) * p * a * a / (young * (b * b - a * a)) * ((1.0 - 2.0 * nu) * a + b * b / a))
}

/// The bar of the finest mesh holds Lamé's displacement, and the order is that of bilinear elements.
#[test]
fn the_bar_of_a_tube_holds_its_closed_form() {
    let folder = TempDir::new().expect("a folder");
    let (case, exact) = tube(4);
    fs::write(folder.path().join("tube.json"), case.to_string()).expect("a case");
    let arguments = ["converge", "tube.json", "--measure", "bore.ux:end", "--measure", "time:mean"];
    let output = fecontact(&arguments, folder.path());
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
    assert!(said.contains("level 2: 64 elements, 8 increments"), "{said}");
    let line = said.lines().find_map(|line| line.strip_prefix("bore.ux:end: ")).expect("the values");
    let values: Vec<f64> = line.split(", ").map(|value| value.parse().expect("a number")).collect();
    let Convergence { order, extrapolated, bar, .. } = judge(&values, WITHIN).expect("three numbers");
    let (order, extrapolated, bar) = (order.expect("an order"), extrapolated.expect("a value"), bar.expect("a bar"));
    let error = (values[2] - exact).abs();
    assert!((1.8..2.2).contains(&order), "{order}");
    assert!(error < bar && bar < 2.0 * error, "{error:e}, {bar:e}");
    assert!((extrapolated - exact).abs() < 0.1 * error, "{extrapolated}, {exact}");
    // The mean of the time from the first row on: (dt + 1)/2. It goes by the increments alone, and the bore by the mesh alone.
    assert!(said.contains("time:mean: 0.75, 0.625, 0.5625\n"), "{said}");
    assert!(said.contains("level 2 longer increments: 64 elements, 4 increments"), "{said}");
    let parts: Vec<&str> = said.lines().filter(|line| line.contains("of the last difference")).map(str::trim).collect();
    let told =
        |mesh, increments| format!("of the last difference {mesh} % by the mesh, {increments} % by the increments");
    assert_eq!(parts, [told(100, 0), told(0, 100)]);
    assert!(folder.path().join("out/tube/level_1/history.csv").exists());
}

/// Elements are twice as many, the sizes of neighbours differ by the root, and the nodes of the coarse mesh are nodes of the fine one.
#[test]
fn a_refined_mesh_has_the_nodes_of_the_coarse_one() {
    let build = |written: &Written| -> Model { case::build(&written.case, &written.path).expect("a model") };
    let (case, _) = tube(5);
    let written = Written::from_text(&case.to_string(), Path::new("test.json")).expect("a case");
    let refined = case::refined(&written, Halvings::of_both(2)).expect("a refined case");
    let (coarse, fine) = (build(&written), build(&refined));
    assert_eq!([coarse.mesh.elements.len(), fine.mesh.elements.len()], [5, 5 * 16]);
    for node in &coarse.mesh.nodes {
        let nearest = fine.mesh.nodes.iter().map(|other| (other - node).norm()).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-14, "{node}: {nearest:e}");
    }
    let increments = |model: &Model| model.steps[0].increments;
    let (was, is) = (increments(&coarse), increments(&fine));
    assert_eq!([is.initial, is.min, is.max], [was.initial / 4.0, was.min / 4.0, was.max / 4.0]);
    assert_eq!(was, increments(&build(&case::refined(&written, Halvings::of_both(0)).expect("the case"))));
}

/// A curved and distorted patch of two elements of a kind, with its boundary and a node.
fn patch(kind: &str) -> Mesh {
    let map = |s: f64, t: f64| [s + 0.1 * t * t, t + 0.2 * s - 0.15 * s * s];
    // Two quadrilaterals side by side, and the lower left and upper right half of the first.
    let corners = |k: f64| [[k, 0.0], [k + 1.0, 0.0], [k + 1.0, 1.0], [k, 1.0]];
    let (cells, count): (Vec<Vec<[f64; 2]>>, usize) = match kind {
        "t3" | "t6" => {
            let [a, b, c, d] = corners(0.0);
            (vec![vec![a, b, d], vec![b, c, d]], if kind == "t3" { 3 } else { 6 })
        }
        kind => (vec![corners(0.0).into(), corners(1.0).into()], kind[1..].parse().expect("a number of nodes")),
    };
    let mut nodes: Vec<[f64; 2]> = Vec::new();
    let mut node = |at: [f64; 2]| {
        nodes.iter().position(|known| *known == at).unwrap_or_else(|| {
            nodes.push(at);
            nodes.len() - 1
        })
    };
    let half = |a: [f64; 2], b: [f64; 2]| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
    let elements: Vec<Vec<usize>> = cells
        .iter()
        .map(|cell| {
            let n = cell.len();
            let middles = (0..n).map(|k| half(cell[k], cell[(k + 1) % n]));
            let all = cell.iter().copied().chain(middles).chain([half(cell[0], cell[2])]);
            all.take(count).map(&mut node).collect()
        })
        .collect();
    // The side t = 0 of the first element.
    let side = if count > 4 {
        vec![elements[0][0], elements[0][1], elements[0][cells[0].len()]]
    } else {
        elements[0][..2].to_vec()
    };
    let mut mesh = InlineMesh::default();
    (mesh.nodes, mesh.elements) =
        (nodes.iter().map(|[s, t]| map(*s, *t)).collect(), [("body".into(), elements)].into());
    (mesh.edges, mesh.points) = ([("low".into(), vec![side])].into(), [("corner".into(), vec![0])].into());
    mesh.build().expect("a mesh")
}

fn area(mesh: &Mesh) -> f64 {
    let of = |e: usize| -> f64 {
        let (kind, places) = (mesh.elements[e].kind, mesh.places(e));
        let jacobian = |at: [f64; 2]| {
            let columns = kind.derivatives(at).iter().zip(&places).fold([[0.0; 2]; 2], |mut sum, (d, x)| {
                (0..2).for_each(|i| (0..2).for_each(|j| sum[i][j] += d[i] * x[j]));
                sum
            });
            columns[0][0] * columns[1][1] - columns[0][1] * columns[1][0]
        };
        kind.quadrature().iter().map(|point| point.weight * jacobian(point.at)).sum()
    };
    (0..mesh.elements.len()).map(of).sum()
}

/// Every element of any kind becomes four of its kind that cover it exactly, whose sides are those of their neighbours; named sides are
/// divided, named nodes stay, curved sides too.
#[test]
fn elements_become_four() {
    for (kind, nodes) in [("t3", 9), ("t6", 25), ("q4", 15), ("q8", 37), ("q9", 45)] {
        let coarse = patch(kind);
        let fine = coarse.divided().expect("it can be divided").build().expect("a mesh");
        assert_eq!([fine.elements.len(), fine.nodes.len()], [8, nodes], "{kind}");
        assert!(fine.elements.iter().all(|element| element.kind == coarse.elements[0].kind), "{kind}");
        let (was, is) = (area(&coarse), area(&fine));
        assert!((was - is).abs() < 1e-14, "{kind}: {was} and {is}");
        assert_eq!(fine.groups["corner"], coarse.groups["corner"], "{kind}");
        let Group::Edges(low) = &fine.groups["low"] else { panic!("{kind}: a side") };
        assert_eq!(low.len(), 2, "{kind}");
        // On the curve y = 0.2 s − 0.15 s² at the quarters of quadratic sides, on its chord at the middle of linear ones.
        for node in low.iter().flat_map(|edge| &edge.nodes) {
            let [x, y] = [fine.nodes[*node].x, fine.nodes[*node].y];
            let expected = if ["t3", "q4"].contains(&kind) { 0.05 * x } else { 0.2 * x - 0.15 * x * x };
            assert!((y - expected).abs() < 1e-15, "{kind}: ({x}, {y})");
        }
    }
}

/// The lines of a rigid outline, which are sides of no element, stay as they are.
#[test]
fn outlines_are_not_divided() {
    let mut mesh = InlineMesh::default().rectangle("block", [2, 1], [0.0, 0.0], [2.0, 1.0]);
    mesh.nodes.extend([[3.0, -1.0], [-1.0, -1.0], [1.0, -1.2]]);
    mesh.edges.insert("die".into(), vec![vec![6, 7, 8]]);
    let coarse = mesh.build().expect("a mesh");
    let fine = coarse.divided().expect("it can be divided").build().expect("a mesh");
    let [Group::Lines(was), Group::Lines(is)] = [&coarse, &fine].map(|mesh| &mesh.groups["die"]) else {
        panic!("lines")
    };
    let places =
        |lines: &[Vec<(u64, nalgebra::Vector2<f64>)>]| lines.concat().iter().map(|(_, at)| *at).collect::<Vec<_>>();
    assert_eq!(places(was), places(is));
    assert_eq!((coarse.elements.len(), fine.elements.len()), (2, 8));
}

/// Blocks written node by node are refined to the same numbers as the blocks.
#[test]
fn other_meshes_are_refined_as_blocks_are() {
    let folder = TempDir::new().expect("a folder");
    let (mut case, _) = tube(4);
    case["mesh"]["blocks"][0]["grading"] = json!([1, 1]);
    let mut by_nodes = case.clone();
    let nodes: Vec<[f64; 2]> = (0..10).map(|k| [1.0 + 0.25 * f64::from(k % 5), 0.5 * f64::from(k / 5)]).collect();
    let elements: Vec<[usize; 4]> = (0..4).map(|k| [k, k + 1, k + 6, k + 5]).collect();
    let [low, high] = [0, 5].map(|first| (0..4).map(|k| [first + k, first + k + 1]).collect::<Vec<_>>());
    by_nodes["mesh"] = json!({"nodes": nodes, "elements": {"tube": elements}, "edges": {"bottom": low, "top": high, "bore": [[5, 0]]}});
    let values = |name: &str, case: &Value| -> Vec<f64> {
        fs::write(folder.path().join(name), case.to_string()).expect("a case");
        let output = fecontact(&["converge", name, "--measure", "bore.ux:end"], folder.path());
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
        let line = said.lines().find_map(|line| line.strip_prefix("bore.ux:end: ")).expect("the values");
        line.split(", ").map(|value| value.parse().expect("a number")).collect()
    };
    let [blocks, nodes] = [("blocks.json", &case), ("nodes.json", &by_nodes)].map(|(name, case)| values(name, case));
    assert!(blocks.iter().zip(&nodes).all(|(a, b)| (a - b).abs() < 1e-13 * a.abs()), "{blocks:?} and {nodes:?}");
}

/// Orders, extrapolations and bars of sequences that are known: 1 + 2^(−p k), sequences whose differences alternate, and those that do not converge.
#[test]
fn sequences_are_judged() {
    let of = |values: [f64; 3]| judge(&values, WITHIN).expect("three numbers");
    let power = |p: f64| of([1.0, 0.0, -1.0].map(|k: f64| 1.0 + (p * (k - 2.0)).exp2()));
    for (p, factor) in [(0.6, 3.0), (1.0, 1.25), (1.5, 3.0), (2.0, 1.25), (3.9, 1.25)] {
        let judged = power(p);
        let error = (p * -3.0).exp2();
        assert!((judged.order.expect("an order") - p).abs() < 1e-10);
        assert!((judged.extrapolated.expect("a value") - 1.0).abs() < 1e-12);
        assert!((judged.bar.expect("a bar") - factor * error).abs() < 1e-12, "{p}");
    }
    assert!(power(0.3).bar.is_none() && power(0.3).verdict.contains("does not converge"));
    assert!(
        power(5.0).bar.expect("a bar") > 5.0 * (5.0_f64 * -3.0).exp2() && power(5.0).verdict.contains("is accidental")
    );
    let to_and_fro = of([1.1, 0.95, 1.02]);
    assert_eq!((to_and_fro.order, to_and_fro.extrapolated), (None, Some(1.02)));
    assert!((to_and_fro.bar.expect("a bar") - 0.21).abs() < 1e-12);
    for diverging in [[1.0, 1.1, 1.2], [1.0, 1.1, 1.3], [1.0, 1.1, 0.9], [1.0, 1.0, 1.1]] {
        let judged = of(diverging);
        assert!(judged.bar.is_none() && judged.extrapolated.is_none() && judged.verdict.contains("does not converge"));
    }
    // Changes within a thousandth that do not become smaller are no failure, and no order either.
    for settled in [[0.34599, 0.34598, 0.34601], [-2.0, -2.0, -2.0019]] {
        let judged = of(settled);
        assert!(judged.settled && judged.bar.is_none() && judged.order.is_none());
        assert!(judged.verdict.contains("no order can be measured"), "{}", judged.verdict);
        assert!(!judge(&settled, 1e-5).expect("three numbers").settled);
    }
    assert!(of([0.34599, 0.34598, 0.34601]).verdict.starts_with("changed by less than 0.1 %"));
    assert!(!of([1.0, 1.0, 1.1]).settled && !of([1.0, 0.9999, 0.99995]).settled);
    let same = of([3.0, 3.0 + 1e-12, 3.0]);
    assert!(same.verdict.contains("does not change") && same.bar.expect("a bar") <= 1e-7);
    assert!(judge(&[1.0, 2.0], WITHIN).is_err() && judge(&[1.0, 2.0, f64::NAN], WITHIN).is_err());
}

/// What is taken of a history, of one column over another, and in a step alone; names may have the signs that part these.
#[test]
fn numbers_are_taken_of_columns_ratios_and_steps() {
    let folder = TempDir::new().expect("a folder");
    let history = "time,dt,step,a/b.q,a/b.p,c:max.q\n1,1,in,0,0,5\n2,1,in,3,2,1\n3,1,on@2:1,2,4,0\n5,2,on@2:1,6,4,2\n";
    fs::write(folder.path().join("history.csv"), history).expect("a file");
    let of = |measure: &str| measure.parse::<Measure>().expect("a measure").of(folder.path());
    for (measure, expected) in [
        ("a/b.q:max", 6.0),
        ("a/b.q:max@in", 3.0),
        ("a/b.q:min@on@2:1", 2.0),
        // Where nothing presses there is no ratio: 0/0.
        ("a/b.q/a/b.p:max", 1.5),
        ("a/b.q/a/b.p:max@on@2:1", 1.5),
        ("a/b.q/a/b.p:min", 0.5),
        ("a/b.q/a/b.p:end@in", 1.5),
        ("c:max.q:max", 5.0),
        ("c:max.q/a/b.p:end", 0.5),
        // Linear between rows.
        ("a/b.q:mean@on@2:1", 4.0),
        ("a/b.q:mean", (1.5 + 2.5 + 8.0) / 4.0),
    ] {
        assert_eq!(of(measure), Ok(expected), "{measure}");
    }
    for (measure, told) in [
        ("a/b.q/c:max.q:max", "`a/b.q/c:max.q` is not a number"),
        ("a/b.q/a/b.p:mean", "is not a number"),
        ("a/b.q:max@off", "is not a number in the step `off`"),
        ("a/b.q/step:max", "the column `step` does not hold numbers"),
        ("a/b.r:max", "has no column `a/b.r`"),
    ] {
        let complaint = of(measure).expect_err(measure);
        assert!(complaint.contains(told), "{measure}: {complaint}");
    }
}

/// A probe is where it is on every mesh: the bar of the finest holds Lamé's displacement between the nodes,
/// u = (1 + ν) p a²/(E (b² − a²)) ((1 − 2ν) r + b²/r). The node nearest to such a place is another on every mesh, which is refused; a place of
/// a node of the case is one of all. Any number of threads says the same.
#[test]
fn a_probe_stays_where_it_is() {
    let folder = TempDir::new().expect("a folder");
    let (a, b, p, young, nu): (f64, f64, f64, f64, f64) = (1.0, 2.0, 0.7, 200.0, 0.3);
    let r: f64 = 1.37;
    let exact = (1.0 + nu) * p * a * a / (young * (b * b - a * a)) * ((1.0 - 2.0 * nu) * r + b * b / r);
    let (mut case, _) = tube(4);
    case["probes"] = json!({"wall": {"at": [r, 0.2]}});
    case["watch"] = json!([{"near": [2, 0.5]}]);
    let write = |name: &str, case: &Value| fs::write(folder.path().join(name), case.to_string()).expect("a case");
    write("tube.json", &case);
    let study = ["converge", "tube.json", "--measure", "wall.ux:end", "--measure", "near_2_0.5.ux:end@load"];
    let said = ["1", "3"].map(|threads| {
        let output = fecontact(&[&study[..], &["--threads", threads]].concat(), folder.path());
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
        fs::remove_dir_all(folder.path().join("out")).expect("results");
        said
    });
    assert_eq!(said[0], said[1]);
    let line = said[0].lines().find_map(|line| line.strip_prefix("wall.ux:end: ")).expect("the values");
    let values: Vec<f64> = line.split(", ").map(|value| value.parse().expect("a number")).collect();
    let bar = judge(&values, WITHIN).expect("three numbers").bar.expect("a bar");
    assert!((values[2] - exact).abs() < bar && bar < 1e-3 * exact, "{values:?} ± {bar:e}, {exact}");
    let refused = |case: &Value, place: &str| {
        write("off.json", case);
        let output = fecontact(&["converge", "off.json", "--measure", "wall.ux:end"], folder.path());
        let said = String::from_utf8_lossy(&output.stderr);
        let told = format!("off.json: {place}: is nearest to the node at (");
        assert!(output.status.code() == Some(2) && said.contains(&told) && said.contains("with a probe"), "{said}");
    };
    let mut off = case.clone();
    off["watch"] = json!(["bore", {"near": [1.27, 0.5]}]);
    refused(&off, "watch[1]");
    case["steps"][0]["supports"][0]["on"] = json!({"near": [1.27, 0]});
    refused(&case, "steps[0].supports[0].on");
}

/// A number that a run does not have is told with the run and its table.
#[test]
fn a_number_that_a_run_does_not_have_is_told() {
    let folder = TempDir::new().expect("a folder");
    fs::write(folder.path().join("tube.json"), tube(2).0.to_string()).expect("a case");
    // Nothing moves fast in statics: 0/0.
    let output = fecontact(&["converge", "tube.json", "--measure", "kinetic/kinetic:end"], folder.path());
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(
        said.contains("stopped: level 0: ") && said.contains("history.csv: `kinetic/kinetic` is not a number"),
        "{said}"
    );
    let output = fecontact(&["converge", "tube.json", "--measure", "bore.ux:end", "--threads", "0"], folder.path());
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stderr));
}

/// What cannot be refined or measured is refused with a reason.
#[test]
fn bad_studies_are_refused() {
    let folder = TempDir::new().expect("a folder");
    let write = |name: &str, case: &Value| fs::write(folder.path().join(name), case.to_string()).expect("a case");
    let (good, _) = tube(2);
    let mut held = good.clone();
    held["mesh"] = json!({"nodes": [[1, 0], [2, 0], [2, 1], [1, 1]], "elements": {"tube": [[0, 1, 2, 3]]},
        "edges": {"top": [[2, 3]], "bore": [[3, 0]]}, "points": {"bottom": [0, 1]}});
    write("good.json", &good);
    write("held.json", &held);
    // What another mesh makes another problem.
    let with = |name: &str, pointer: &str, value: Value| {
        let mut changed = good.clone();
        *changed.pointer_mut(pointer).expect("a place") = value;
        write(name, &changed);
    };
    let load = |kind: &str, of: Value| json!([{"on": "bore", kind: of}]);
    with("force.json", "/steps/0/loads", load("force", json!({"x": 1})));
    with("spring.json", "/steps/0/loads", load("spring", json!({"kx": 1})));
    with("tag.json", "/steps/0/supports/1/on", json!({"node": 1}));
    let mut mass = good.clone();
    mass["point_masses"] = json!({"bore": {"mass": 1}});
    write("mass.json", &mass);
    for (arguments, code, told) in [
        (
            ["held.json", "--measure", "bore.ux:end", "--levels", "3"],
            2,
            "mesh: the group `bottom` holds the nodes 0 and 1, the ends of a side",
        ),
        (
            ["force.json", "--measure", "bore.ux:end", "--levels", "3"],
            2,
            "steps[0].loads[0].force: acts at every node of `bore`, and a refined mesh",
        ),
        (
            ["spring.json", "--measure", "bore.ux:end", "--levels", "3"],
            2,
            "steps[0].loads[0].spring: acts at every node of `bore`",
        ),
        (
            ["tag.json", "--measure", "bore.ux:end", "--levels", "3"],
            2,
            "steps[0].supports[1].on: is a node by its tag, and a refined mesh",
        ),
        (
            ["mass.json", "--measure", "bore.ux:end", "--levels", "3"],
            2,
            "point_masses.bore: is at every node of the group",
        ),
        (["good.json", "--measure", "bore.ux", "--levels", "3"], 2, "`bore.ux` is not a measure: give COLUMN:max"),
        (["good.json", "--measure", "bore.ux:last", "--levels", "3"], 2, "`last` is not max, min, end or mean"),
        (["good.json", "--measure", "bor.ux:end", "--levels", "3"], 2, "the history has no column `bor.ux`; there are"),
        (["good.json", "--measure", "step:end", "--levels", "3"], 2, "does not hold numbers"),
        (["good.json", "--measure", "bore.ux/bore.fz:end", "--levels", "3"], 2, "has no column `bore.ux/bore.fz`"),
        (["good.json", "--measure", "bore.ux/step:end", "--levels", "3"], 2, "does not hold numbers"),
        (
            ["good.json", "--measure", "bore.ux:end@lead", "--levels", "3"],
            2,
            "the case has no step `lead`; there are load",
        ),
        (
            ["good.json", "--measure", "bore.ux:end", "--levels", "2"],
            2,
            "--levels: is 2: an order of convergence needs 3",
        ),
    ] {
        let output = fecontact(&[&["converge"], &arguments[..]].concat(), folder.path());
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(code) && said.contains(told), "{arguments:?}: {said}");
        assert!(!folder.path().join("out").exists(), "{arguments:?}");
    }
    // A force at a place stays one force.
    with("near.json", "/steps/0/loads", json!([{"on": {"near": [1, 0]}, "force": {"x": 1}}]));
    let output = fecontact(&["converge", "near.json", "--measure", "bore.ux:end"], folder.path());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Every level warns as a run of its own: a block that strikes the floor within a single increment loses energy, less in shorter
/// ones until it is not told.
#[test]
fn levels_warn_as_runs_do() {
    let folder = TempDir::new().expect("a folder");
    let case = json!({
        "mesh": {"blocks": [{"body": "b", "corners": [[0, 0.003], [1, 0.003], [1, 1], [0, 1]], "elements": [1, 1],
            "sides": ["bottom", null, "top", null]}]},
        "bodies": {"b": {"material": {"model": "linear", "E": 100, "nu": 0.3}}},
        "contacts": {"c": {"slave": "bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "friction": {"law": "coulomb", "mu": 0.3, "alpha_t": 4e4}}},
        "steps": [{"name": "press", "duration": 1, "dt": {"initial": 1}, "supports": [{"on": "top", "ux": 0, "uy": -0.01}]}],
    });
    fs::write(folder.path().join("block.json"), case.to_string()).expect("a case");
    let output = fecontact(&["converge", "block.json", "--measure", "c.force_y:end"], folder.path());
    let told = String::from_utf8_lossy(&output.stderr);
    let shares = (0..2).map(|level| {
        let head = format!("warning: level {level}: surfaces close or part within increments");
        let line = told.lines().find(|line| line.starts_with(&head)).unwrap_or_else(|| panic!("{head}\n{told}"));
        let share = line.split(", ").find_map(|part| part.split(" % of").next()?.parse::<f64>().ok());
        share.expect("a share")
    });
    assert!(shares.is_sorted_by(|a, b| a > b), "{told}");
    assert!(!told.contains("level 2: surfaces close"), "{told}");
}
