//! What a run writes for its reader: the columns of `history.csv`, the frames, and lines of progress.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::common::{Blocks, close};
use serde_json::{Value, json};
use tempfile::TempDir;
use vtkio::model::{Attribute, CellType, DataSet, UnstructuredGridPiece};

const ALPHA_T: f64 = 800.0;

/// A mass pressed on a plane and pulled by a spring.
fn slider(duration: f64, dt: f64) -> Value {
    json!({
        "title": "A mass pulled over a plane",
        "units": {"length": "m", "force": "N", "time": "s"},
        "mesh": {"nodes": [[0, 0]], "points": {"block": [0]}},
        "point_masses": {"block": {"mass": 10}},
        "contacts": {"base": {
            "slave": "block", "area": 2, "normal": {"alpha_n": 1000}, "initial": {"pressure": 50, "traction": 1},
            "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "friction": {"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "alpha_t": ALPHA_T, "r": 100, "kappa": 10}
        }},
        "steps": [{"name": "pull", "duration": duration, "scheme": {"newmark": {}}, "dt": {"initial": dt}, "loads": [
            {"on": "block", "force": {"y": "-100"}},
            {"on": "block", "spring": {"kx": 10, "driver": {"x": {"rate": 0.5}}}}
        ]}],
        "watch": ["block"],
        "output": {"fields": false}
    })
}

fn run(folder: &Path, case: &Value) -> Output {
    fs::write(folder.join("case.json"), case.to_string()).unwrap();
    let output =
        Command::new(env!("CARGO_BIN_EXE_fecontact")).current_dir(folder).args(["run", "case.json"]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    output
}

/// The columns that other programs rely on, in their order; new ones come last in their group.
#[test]
fn history_has_the_promised_columns() {
    let folder = TempDir::new().unwrap();
    run(folder.path(), &slider(10.0, 0.02));
    let text = fs::read_to_string(folder.path().join("out/case/history.csv")).unwrap();
    let header = "time,dt,step,iterations,kinetic,strain,contact_elastic,friction_dissipation,damping_dissipation,\
                  external_work,energy_error,base.normal_force,base.tangential_force,base.contact_length,\
                  base.slip_fraction,base.mean_slip,base.max_penetration,base.max_elastic_slip,base.mean_elastic_slip,\
                  block.ux,block.uy,block.fx,block.fy";
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some(header));
    let column = |name: &str| header.split(',').position(|column| column == name).unwrap();
    let mut pulled = false;
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), 23, "{line}");
        let number = |name: &str| cells[column(name)].parse::<f64>().unwrap();
        assert_eq!(cells[2], "pull");
        // One point of area 2: q = force/2, elastic slip q/α_t, plastic slip the rest of the motion.
        let elastic = number("base.tangential_force") / 2.0 / ALPHA_T;
        assert!((number("base.mean_elastic_slip") - elastic).abs() < 1e-15, "{line}");
        let slip = number("block.ux") - (number("base.mean_slip") + elastic - 1.0 / ALPHA_T);
        assert!(slip.abs() < 1e-12, "{slip}");
        assert_eq!(number("base.max_elastic_slip"), number("base.mean_elastic_slip").abs());
        pulled |= number("base.mean_slip") > 0.01;
    }
    assert!(pulled);
}

/// What the reader of results needs to know of the case stands in the summary.
#[test]
fn the_summary_tells_title_units_and_laws() {
    let folder = TempDir::new().unwrap();
    let case = slider(0.1, 0.02);
    run(folder.path(), &case);
    let summary = fs::read_to_string(folder.path().join("out/case/summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    for key in ["status", "reason", "version", "case", "dofs", "increments", "wall_s", "warnings"] {
        assert!(summary.get(key).is_some(), "{key} is missing");
    }
    assert_eq!(summary["title"], case["title"]);
    assert_eq!(summary["units"], case["units"]);
    let law = &summary["friction"]["base"];
    assert_eq!((&law["law"], law["mu_s"].as_f64()), (&json!("super_subloading"), Some(0.4)));
}

/// A run of thousands of quick increments does not drown its reader: a hundred lines, then two a second; the history has
/// them all.
#[test]
fn progress_does_not_drown_its_reader() {
    let folder = TempDir::new().unwrap();
    let output = run(folder.path(), &slider(60.0, 0.02));
    let lines = String::from_utf8_lossy(&output.stderr).lines().filter(|line| line.starts_with("pull")).count();
    assert!((100..1000).contains(&lines), "{lines} lines");
    assert!(String::from_utf8_lossy(&output.stderr).contains("not every increment has a line"));
    let rows = fs::read_to_string(folder.path().join("out/case/history.csv")).unwrap().lines().count();
    assert_eq!(rows, 3000 + 1);
}

/// A frame as another reader of VTU files finds it.
fn frame(path: &Path) -> UnstructuredGridPiece {
    let DataSet::UnstructuredGrid { pieces, .. } = vtkio::Vtk::import(path).unwrap().data else { panic!("{path:?}") };
    pieces.into_iter().next().unwrap().into_loaded_piece_data(None).unwrap()
}

fn values(attributes: &[Attribute], name: &str) -> Vec<f64> {
    let array = attributes.iter().find_map(|attribute| match attribute {
        Attribute::DataArray(array) if array.name == name => Some(array),
        _ => None,
    });
    array.unwrap_or_else(|| panic!("no array `{name}`")).data.cast_into().unwrap()
}

/// A block pressed between walls: ε_yy = −δ/h, σ_yy = (λ + 2G) ε_yy, σ_xx = σ_zz = λ ε_yy, in closed form.
#[test]
fn frames_hold_the_uniform_stress_of_a_pressed_block() {
    let folder = TempDir::new().unwrap();
    let (young, nu, strain) = (1000.0, 0.25, -0.01);
    let (lambda, shear) = (young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), 0.5 * young / (1.0 + nu));
    let walls = json!([
        {"on": "block_bottom", "uy": 0}, {"on": "block_left", "ux": 0}, {"on": "block_right", "ux": 0},
        {"on": "block_top", "uy": 2.0 * strain}
    ]);
    let case = json!({
        "mesh": Blocks::default().rectangle("block", [3, 2], [0.0, 0.0], [3.0, 2.0]).json(),
        "bodies": {"block": {"material": {"model": "linear", "E": young, "nu": nu}}},
        "steps": [{"name": "press", "duration": 1, "scheme": "static", "dt": {"initial": 0.5}, "supports": walls}]
    });
    run(folder.path(), &case);
    let out = folder.path().join("out/case");
    let collection = fs::read_to_string(out.join("solid.pvd")).unwrap();
    assert_eq!(collection.matches("<DataSet ").count(), 3, "{collection}");
    assert!(!out.join("contact.pvd").exists(), "there is no contact");
    for (number, share) in [(0, 0.0), (1, 0.5), (2, 1.0)] {
        let piece = frame(&out.join(format!("solid/{number:05}.vtu")));
        let places: Vec<f64> = piece.points.cast_into().unwrap();
        assert_eq!(places.len(), 3 * 12);
        assert_eq!(piece.cells.types, [CellType::Quad; 6]);
        assert_eq!(values(&piece.data.cell, "body"), [0.0; 6]);
        let displacement = values(&piece.data.point, "displacement");
        for (x, u) in places.chunks_exact(3).zip(displacement.chunks_exact(3)) {
            close("u_x", u[0], 0.0, 1e-14);
            close("u_y", u[1], share * strain * x[1], 1e-14);
        }
        let (across, along) = (share * lambda * strain, share * (lambda + 2.0 * shear) * strain);
        for stress in values(&piece.data.point, "stress").chunks_exact(4) {
            for (value, expected) in stress.iter().zip([across, along, across, 0.0]) {
                close("stress", *value, expected, 1e-10);
            }
        }
        let pressure = -(along + 2.0 * across) / 3.0;
        values(&piece.data.point, "pressure").iter().for_each(|&p| close("pressure", p, pressure, 1e-10));
        let von_mises = (along - across).abs();
        values(&piece.data.point, "von_mises").iter().for_each(|&s| close("von Mises", s, von_mises, 1e-10));
        let reaction = values(&piece.data.point, "reaction");
        let on_top = reaction.chunks_exact(3).zip(places.chunks_exact(3)).filter(|(_, x)| x[1] == 2.0);
        close("force on top", on_top.map(|(force, _)| force[1]).sum(), 3.0 * along, 1e-10);
    }
}

#[test]
fn a_dynamic_run_ends_with_its_energy_audit() {
    let folder = TempDir::new().unwrap();
    let output = run(folder.path(), &slider(10.0, 0.02));
    let last_lines = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(last_lines.contains("energy: ") && last_lines.contains(" %) unaccounted for"), "{last_lines}");
    let text = fs::read_to_string(folder.path().join("out/case/summary.json")).unwrap();
    let energy = &serde_json::from_str::<Value>(&text).unwrap()["energy"];
    let of = |name: &str| energy[name].as_f64().unwrap();
    let history = fs::read_to_string(folder.path().join("out/case/history.csv")).unwrap();
    let last: Vec<&str> = history.lines().last().unwrap().split(',').collect();
    for (column, name) in ["kinetic", "strain", "contact_elastic", "friction_dissipation"].into_iter().enumerate() {
        assert_eq!(last[4 + column].parse::<f64>().unwrap(), of(name), "{name}");
    }
    let error: f64 = last[10].parse().unwrap();
    assert!(of("external_work") > 1.0 && error.abs() < 0.01 * of("external_work"), "{error} of {energy}");
}

/// Frames of an explicit step come with every n-th row of the history, not with every n-th of its many increments, and with
/// the last.
#[test]
fn frames_of_explicit_steps_come_with_every_nth_row() {
    for (every, interval, expected) in [
        (1, 0.25, vec![0.0, 0.25, 0.5, 0.75, 1.0]),
        (4, 0.05, vec![0.0, 0.2, 0.4, 0.6, 0.8, 1.0]),
        (7, 0.04, vec![0.0, 0.28, 0.56, 0.84, 1.0]),
    ] {
        let folder = TempDir::new().unwrap();
        let case = json!({
            "mesh": Blocks::default().rectangle("bar", [10, 2], [0.0, 0.0], [1.0, 0.1]).json(),
            "bodies": {"bar": {"material": {"model": "linear", "E": 1000, "nu": 0, "density": 1}}},
            "initial_velocity": {"bar": [0, 1e-3]},
            "steps": [{"name": "free", "duration": 1, "scheme": {"explicit": {}}, "supports": [{"on": "bar_left", "ux": 0}]}],
            "output": {"every": every, "interval": interval}
        });
        run(folder.path(), &case);
        let collection = fs::read_to_string(folder.path().join("out/case/solid.pvd")).unwrap();
        let times = collection.split("timestep=\"").skip(1).map(|rest| rest.split('"').next().unwrap());
        let times: Vec<f64> = times.map(|time| time.parse().unwrap()).collect();
        assert_eq!(times.len(), expected.len(), "every {every}: {times:?}");
        times.iter().zip(&expected).for_each(|(time, expected)| close("time of a frame", *time, *expected, 1e-9));
    }
}

/// What slides without friction has a map of its slip, and no fronts.
#[test]
fn frictionless_contacts_have_no_fronts() {
    for (friction, fronts) in [(json!({"law": "frictionless"}), false), (json!({"law": "coulomb", "mu": 0.1}), true)] {
        let folder = TempDir::new().unwrap();
        let case = json!({
            "mesh": Blocks::default().rectangle("slab", [4, 2], [0.0, 0.0], [1.0, 0.5]).json(),
            "bodies": {"slab": {"material": {"model": "linear", "E": 1000, "nu": 0.3}}},
            "contacts": {"guide": {
                "slave": "slab_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
                "friction": friction, "initial": {"pressure": 1}
            }},
            "steps": [{"name": "slide", "duration": 1, "dt": {"initial": 0.1},
                       "supports": [{"on": "slab_top", "ux": {"rate": 0.1}, "uy": 0}]}],
            "output": {"fields": false, "fronts": {"slip_rate": 0.01}}
        });
        run(folder.path(), &case);
        let rows =
            |name: &str| fs::read_to_string(folder.path().join("out/case").join(name)).unwrap().lines().count() - 1;
        assert_eq!(rows("slip_map.csv"), 10 * 8);
        assert_eq!(rows("fronts.csv") > 0, fronts, "{friction}");
    }
}
