//! What a run writes over time: the store of its interfaces, rows at intervals, frames at times, gauges, and how bodies and
//! contacts act as a whole; by closed forms, or by what another file of the same run says.

mod probes;
mod sums;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::Arc;

use crate::common::{self, Blocks, close, store, table};
use fecontact::mesh::InlineMesh;
use fecontact::model::Model;
use fecontact::model::builder::{Gauge, LoadStep};
use fecontact::output::bodies::BodyMeans;
use fecontact::output::quantities;
use fecontact::output::store::codec::{
    self, BITS, QUICK, RELATIVE_ERROR, THOROUGH, packed, rounded, shuffled, unpacked,
};
use fecontact::output::store::read;
use nalgebra::{Rotation2, Vector2};
use serde_json::{Value, json};
use tempfile::TempDir;
use vtkio::model::{Attribute, CellType, DataSet, UnstructuredGridPiece};

/// A run whose frames, if it has any, are as computed, and one a row unless the case says which.
fn start(folder: &Path, case: &Value) -> Output {
    let mut case = case.clone();
    if case["output"].is_null() {
        case["output"] = json!({});
    }
    let chosen = ["every", "times"].iter().any(|key| !case["output"][*key].is_null());
    let more = [("exact", json!(true)), ("every", json!(1))].into_iter().take(if chosen { 1 } else { 2 });
    more.for_each(|(key, value)| case["output"][key] = value);
    fs::write(folder.join("case.json"), case.to_string()).expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_fecontact_tested"));
    command.current_dir(folder).args(["run", "case.json", "--quiet", "--threads", "1", "--out", "out"]);
    command.output().expect("the program runs")
}

#[track_caller]
fn run(folder: &Path, case: &Value) {
    let output = start(folder, case);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
}

fn frame(path: &Path) -> UnstructuredGridPiece {
    let DataSet::UnstructuredGrid { pieces, .. } = vtkio::Vtk::import(path).expect("a frame").data else { panic!() };
    pieces.into_iter().next().expect("a piece").into_loaded_piece_data(None).expect("its data")
}

fn values(attributes: &[Attribute], name: &str) -> Vec<f64> {
    let array = attributes.iter().find_map(|attribute| match attribute {
        Attribute::DataArray(array) if array.name == name => Some(array),
        _ => None,
    });
    array.unwrap_or_else(|| panic!("no array `{name}`")).data.cast_into().expect("numbers")
}

/// Times of the frames that a collection lists.
fn times(out: &Path, collection: &str) -> Vec<f64> {
    let text = fs::read_to_string(out.join(collection)).expect("a collection");
    let times = text.split("timestep=\"").skip(1).map(|rest| rest.split('"').next().expect("a time"));
    times.map(|time| time.parse().expect("a number")).collect()
}

/// A block pressed on ground and dragged; the law weakens and heals.
fn dragged(friction: Value, method: &str) -> Value {
    let material = json!({"model": "neo_hookean", "E": 100, "nu": 0.3, "density": 1e-4});
    json!({
        "title": "A block is dragged",
        "units": {"length": "mm", "force": "N", "time": "seconds"},
        "mesh": Blocks::default()
            .rectangle("ground", [10, 3], [0.0, -0.5], [3.0, 0.0])
            .rectangle("block", [5, 3], [0.4, 0.01], [1.4, 0.51]).json(),
        "bodies": {"ground": {"material": material}, "block": {"material": material}},
        "contacts": {"base/1": {"slave": "block_bottom", "master": "ground_top", "method": method, "friction": friction}},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.25, "min": 1e-4}, "supports": [
                {"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0, "uy": -0.02}]},
            {"name": "drag", "duration": 1, "dt": {"initial": 0.05, "min": 1e-5},
                "supports": [{"on": "block_top", "ux": {"rate": 0.1}}]},
        ],
        "watch": ["block_top"],
    })
}

fn healing() -> Value {
    json!({"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "alpha_t": 2e3, "r": 100, "kappa": 10, "xi": 0.002})
}

/// The reactions of single nodes add up to that of their group, and their displacements to its mean.
#[test]
fn single_nodes_are_watched_as_groups_are() {
    let folder = TempDir::new().expect("a folder");
    let places = [0.4, 0.6, 0.8, 1.0, 1.2, 1.4];
    let mut case = dragged(healing(), "node_to_segment");
    case["watch"] = json!(["block_top"]);
    let nodes = places.map(|x| json!({"near": [x, 0.51]}));
    case["watch"].as_array_mut().expect("a list").extend(nodes);
    run(folder.path(), &case);
    let history = table(folder.path().join("out/history.csv"));
    let column = |x: f64, name: &str| &history[&format!("near_{x}_0.51.{name}")];
    assert_eq!(history.keys().filter(|name| name.starts_with("near_")).count(), 4 * places.len());
    for (name, share) in [("ux", 1.0 / 6.0), ("uy", 1.0 / 6.0), ("fx", 1.0), ("fy", 1.0)] {
        for (k, whole) in history[&format!("block_top.{name}")].iter().enumerate() {
            let sum: f64 = places.iter().map(|x| share * column(*x, name)[k]).sum();
            close(name, sum, *whole, 1e-12 * (1.0 + whole.abs()));
        }
    }
    let largest = column(0.4, "fy").iter().fold(0.0, |most: f64, force| most.max(force.abs()));
    assert!(largest > 0.01, "{largest}");
}

/// The store against the frames of the same run, which are in double precision, and against the history.
#[test]
fn the_store_holds_what_the_frames_show() {
    let folder = TempDir::new().expect("a folder");
    run(folder.path(), &dragged(healing(), "gauss_to_segment"));
    let out = folder.path().join("out");
    let store = out.join("interface.zarr");
    // A slash cannot stand in the name of a file.
    let of = |name: &str| format!("base_1.{name}");
    let (_, all) = store::array(&store, "time");
    assert_eq!(all, table(out.join("history.csv"))["time"]);
    let points = store::array(&store, &of("position")).0[0];
    let series = |name: &str| {
        let (shape, values) = store::array(&store, &of(name));
        assert_eq!(shape, [all.len(), points]);
        assert_eq!(store::consolidated(&store, &of(name)).1, values);
        values
    };
    let [slip, total, rate, gap] = ["slip", "total_slip", "slip_rate", "gap"].map(series);
    let [p, q, ratio, mu, structure] = ["pressure", "traction", "R", "mu", "structure"].map(series);
    let (mut before, mut slipped) = (vec![0.0; points], 0.0f64);
    for (k, time) in all.iter().enumerate() {
        let shown = frame(&out.join(format!("contact/{:05}.vtu", k + 1)));
        let shown = |name: &str| values(&shown.data.point, name);
        let row = |values: &[f64]| values[k * points..(k + 1) * points].to_vec();
        let near = |what: &str, stored: &[f64], exact: &[f64]| {
            for (stored, exact) in row(stored).iter().zip(exact) {
                close(what, *stored, *exact, exact.abs() * 2f64.powi(-16) + f64::from(f32::MIN_POSITIVE));
            }
        };
        let exact = shown("slip");
        near("slip", &slip, &exact);
        near("pressure", &p, &shown("pressure"));
        near("traction", &q, &shown("traction"));
        near("R", &ratio, &shown("R"));
        near("mu", &mu, &shown("mu"));
        near("structure", &structure, &shown("structure"));
        near("gap", &gap, &shown("gap"));
        let both: Vec<f64> = exact.iter().zip(shown("elastic_slip")).map(|(slip, elastic)| slip + elastic).collect();
        near("total slip", &total, &both);
        let dt = time - if k == 0 { 0.0 } else { all[k - 1] };
        let rates: Vec<f64> = exact.iter().zip(&before).map(|(new, old)| (new - old) / dt).collect();
        near("slip rate", &rate, &rates);
        before = exact;
        slipped = slipped.max(before.iter().fold(0.0, |most: f64, slip| most.max(slip.abs())));
    }
    assert!(slipped > 0.02 && codec::RELATIVE_ERROR == 2f64.powi(-16), "{slipped}");
    // What a reader is told.
    let is = store::attributes(&store, &of("slip_rate"));
    assert_eq!((&is["units"], &is["relative_error"]), (&json!("mm s-1"), &json!(2f64.powi(-16))));
    assert_eq!(is["_ARRAY_DIMENSIONS"], json!(["time", "base_1.point"]));
    assert_eq!(store::attributes(&store, &of("pressure"))["units"], json!("N mm-2"));
    assert_eq!(store::attributes(&store, "time")["units"], json!("s"), "`seconds` would be read as a duration");
    assert_eq!(store::attributes(&store, "")["Conventions"], json!("CF-1.11"));
    // The reader that figures are drawn by.
    let [contact] = &read::contacts(&out, |name| ["pressure", "slip"].contains(&name)).expect("a store")[..] else {
        panic!()
    };
    assert_eq!((contact.name.as_str(), &contact.times, contact.quantities.len()), ("base/1", &all, 2));
    let last = all.len() - 1;
    let read: Vec<f64> = contact.at("pressure", last).expect("a record").iter().map(|p| f64::from(*p)).collect();
    assert_eq!(read, p[last * points..]);
    let places: Vec<f64> = contact.places.iter().map(|at| at[0]).collect();
    assert_eq!((places, contact.lines.clone()), (store::array(&store, &of("x")).1, vec![0; points]));
}

/// A store of a version that called pressure and traction `p` and `q` is read by the names of now.
#[test]
fn stores_of_earlier_versions_are_read() {
    let folder = TempDir::new().expect("a folder");
    run(folder.path(), &dragged(healing(), "gauss_to_segment"));
    let out = folder.path().join("out");
    let now = read::contacts(&out, |_| true).expect("a store");
    let metadata = out.join("interface.zarr/.zmetadata");
    let mut text = fs::read_to_string(&metadata).expect("its metadata");
    for (former, name) in [("p", "pressure"), ("q", "traction")] {
        let [from, to] = [name, former].map(|name| out.join(format!("interface.zarr/base_1.{name}")));
        fs::rename(from, to).expect("an array");
        text = text.replace(&format!("base_1.{name}/"), &format!("base_1.{former}/"));
    }
    fs::write(metadata, text).expect("the metadata of then");
    assert_eq!(read::contacts(&out, |_| true).expect("a store"), now);
    assert!(["pressure", "traction"].iter().all(|name| now[0].quantities.contains_key(*name)));
}

/// What a run writes has an entry in the table of quantities, under the file that it stands in.
#[test]
fn what_is_written_is_listed() {
    let folder = TempDir::new().expect("a folder");
    let mut case = dragged(healing(), "gauss_to_segment");
    case["output"] = json!({"points": true, "fronts": {"slip_rate": 1e-9}});
    case["probes"] = json!({"gauge": {"at": case["mesh"]["nodes"][0]}});
    run(folder.path(), &case);
    let out = folder.path().join("out");
    let check = |file: &str, found: Vec<String>| {
        let groups = quantities::ALL.iter().find(|(of, _)| *of == file).expect("it is listed").1;
        let known: Vec<&str> = groups.iter().flat_map(|(_, some)| *some).map(|quantity| quantity.name).collect();
        let is =
            |name: &str, known: &str| known.strip_suffix('…').map_or(name == known, |first| name.starts_with(first));
        let own: Vec<&str> = found.iter().filter_map(|name| name.rsplit('.').next()).collect();
        assert!(!own.is_empty() && own.iter().all(|name| known.iter().any(|known| is(name, known))), "{file}: {own:?}");
    };
    for file in ["history.csv", "newton.csv", "probes.csv", "fronts.csv", "events.csv"] {
        let text = fs::read_to_string(out.join(file)).expect("a table");
        check(file, text.lines().next().expect("a header").split(',').map(String::from).collect());
    }
    for kind in ["solid", "contact", "points"] {
        let shown = frame(&out.join(format!("{kind}/00001.vtu"))).data;
        let name = |attribute: &Attribute| match attribute {
            Attribute::DataArray(array) => array.name.clone(),
            Attribute::Field { name, .. } => name.clone(),
        };
        check(&format!("{kind}.pvd"), shown.point.iter().chain(&shown.cell).map(name).collect());
    }
    let arrays = fs::read_dir(out.join("interface.zarr")).expect("a store").map(|entry| entry.expect("an array"));
    let arrays = arrays.filter(|entry| entry.path().is_dir());
    check("interface.zarr", arrays.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect());
}

/// What is closed without friction slips, in the history and in frames, and not by slip of a law: the store calls it motion. Nothing
/// sticks there, at rest as well: the last step holds the block.
#[test]
fn what_is_closed_without_friction_slips() {
    for (friction, rubs) in [(json!({"law": "frictionless"}), false), (json!({"law": "coulomb", "mu": 0.1}), true)] {
        let folder = TempDir::new().expect("a folder");
        let mut case = dragged(friction, "gauss_to_segment");
        case["steps"].as_array_mut().expect("steps").push(json!({"name": "rest", "duration": 1, "dt": {"initial": 1}}));
        run(folder.path(), &case);
        let out = folder.path().join("out");
        let history = table(out.join("history.csv"));
        let (shares, steps) = (&history["base/1.slip_fraction"], &history["base/1.contact_length"]);
        let (last, closed) = (shares.len() - 1, steps.iter().filter(|length| **length > 0.0).count());
        assert!(shares[last - 1] > 0.5, "it slides: {shares:?}");
        assert_eq!(shares.iter().filter(|share| **share == 1.0).count() == closed, !rubs, "{shares:?}");
        assert!(history["base/1.mean_slip"].last().is_some_and(|slip| *slip > 0.08), "it moves all the same");
        let sticks = table(out.join("newton.csv"))["stick"].iter().any(|count| *count > 0.0);
        assert_eq!(sticks, rubs);
        let last = times(&out, "contact.pvd").len() - 1;
        let states = values(&frame(&out.join(format!("contact/{last:05}.vtu"))).data.point, "state");
        assert!(rubs || states.iter().all(|state| [0.0, 2.0].contains(state)) && states.contains(&2.0), "{states:?}");
        let long_name = store::attributes(&out.join("interface.zarr"), "base_1.slip")["long_name"].to_string();
        assert_eq!(long_name.contains("plastic slip"), rubs, "{long_name}");
    }
}

/// A mass drawn by a spring over a plane: it sticks and slips.
fn slider() -> Value {
    json!({
        "mesh": {"nodes": [[0, 0]], "points": {"block": [0]}},
        "point_masses": {"block": {"mass": 1}},
        "contacts": {"base": {
            "slave": "block", "area": 1, "normal": {"alpha_n": 1e4}, "initial": {"pressure": 10, "traction": 0},
            "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "friction": {"law": "super_subloading", "mu_s": 0.6, "mu_k": 0.2, "alpha_t": 1e4, "r": 1e3, "kappa": 30, "xi": 2}
        }},
        "steps": [{"name": "pull", "duration": 10, "scheme": {"newmark": {}}, "dt": {"initial": 0.005}, "loads": [
            {"on": "block", "force": {"y": -10}},
            {"on": "block", "spring": {"kx": 4, "driver": {"x": {"rate": 0.5}}}}
        ]}],
        "output": {"fields": false, "checkpoint": 0}
    })
}

/// Rows of a run with an interval are rows of the run without, to the byte: those that are far enough apart, and those before
/// and after the contact begins or ceases to slip.
#[test]
fn an_interval_thins_rows_but_no_events() {
    let folder = TempDir::new().expect("a folder");
    let mut case = slider();
    run(folder.path(), &case);
    let out = folder.path().join("out");
    let lines = || -> Vec<String> {
        fs::read_to_string(out.join("history.csv")).expect("a table").lines().skip(1).map(String::from).collect()
    };
    let full = lines();
    let whole = table(out.join("history.csv"));
    let regime = |k: usize| (whole["base.contact_length"][k] > 0.0, whole["base.slip_fraction"][k]);
    case["output"]["interval"] = json!(0.25);
    run(folder.path(), &case);
    let thinned = lines();
    let row: Vec<usize> =
        thinned.iter().map(|line| full.iter().position(|other| other == line).expect("a row")).collect();
    let kept: BTreeSet<usize> = row.iter().copied().collect();
    // Events, as the full history tells them.
    let events: Vec<usize> = (1..full.len()).filter(|&k| regime(k) != regime(k - 1)).collect();
    assert!(events.len() >= 6, "it is meant to stick and slip: {events:?}");
    for k in &events {
        assert!(kept.contains(k) && kept.contains(&(k - 1)), "the event at row {k} is thinned away");
    }
    let last = full.len() - 1;
    let time = |k: usize| 0.005 * (k + 1) as f64;
    for pair in row.windows(2) {
        let is_event = events.contains(&pair[1]) || events.contains(&(pair[1] + 1)) || pair[1] == last;
        assert!(is_event || time(pair[1]) - time(pair[0]) > 0.25 - 1e-9, "rows {pair:?}");
        assert!(time(pair[1]) - time(pair[0]) < 0.255 + 1e-9, "rows {pair:?}");
    }
    assert!(kept.contains(&last) && row.len() <= 2 * events.len() + 41, "{} rows of {}", row.len(), full.len());
    // The store has the same rows, and slip rates since the row before.
    let store = out.join("interface.zarr");
    let all = store::array(&store, "time").1;
    assert_eq!(all, table(out.join("history.csv"))["time"]);
    let history = table(out.join("history.csv"));
    let (slip, closed) = (&history["base.mean_slip"], &history["base.contact_length"]);
    let rate = store::array(&store, "base.slip_rate").1;
    let both = |k: &usize| closed[*k] > 0.0 && closed[k - 1] > 0.0;
    assert!((1..all.len()).filter(both).count() > 20, "the history tells the slip of closed points alone");
    for k in (1..all.len()).filter(both) {
        let exact = (slip[k] - slip[k - 1]) / (all[k] - all[k - 1]);
        close("slip rate", rate[k], exact, 2f64.powi(-16) * exact.abs() + 1e-12);
    }
}

/// Two points pressed by forces N and drawn by s: friction turns μ N times the plastic slip s − q/α_t into heat, each contact by itself,
/// and all of it is the friction dissipation of the audit. The power is that of the increment; a thinned table has the same.
/// A column of length L = 2 with ν = 0 on a penalty is two springs in series, E/L and α_n: the penalty has 1/α_n of the compliance, and
/// as much of the energy, (1/α_n)/(1/α_n + L/E).
#[test]
fn the_share_of_energy_in_penalties_is_that_of_springs_in_series() {
    let folder = TempDir::new().unwrap();
    for (alpha_n, share) in [(50.0, 0.5), (4950.0, 1.0 / 100.0)] {
        let case = json!({
            "mesh": Blocks::default().rectangle("column", [1, 4], [0.0, 0.0], [1.0, 2.0]).json(),
            "bodies": {"column": {"material": {"model": "linear", "E": 100, "nu": 0}}},
            "contacts": {"base": {
                "slave": "column_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
                "friction": {"law": "coulomb", "mu": 0.5}, "normal": {"alpha_n": alpha_n}
            }},
            "steps": [{"name": "press", "duration": 1, "supports": [{"on": "column_top", "ux": 0, "uy": -0.01}]}]
        });
        run(folder.path(), &case);
        let summary = fs::read_to_string(folder.path().join("out/summary.json")).unwrap();
        let summary: Value = serde_json::from_str(&summary).unwrap();
        close("share", summary["energy_in_penalties"].as_f64().unwrap(), share, 1e-9);
    }
}

#[test]
fn the_heat_of_each_contact_is_its_friction_times_its_slip() {
    let contact = |slave: &str, area: f64, mu: f64| {
        json!({"slave": slave, "area": area, "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "normal": {"alpha_n": 1e3}, "friction": {"law": "coulomb", "mu": mu, "alpha_t": 1e4}})
    };
    let mut case = json!({
        "mesh": {"nodes": [[0, 0], [5, 0]], "points": {"a": [0], "b": [1]}},
        "point_masses": {"a": {"mass": 1}, "b": {"mass": 1}},
        "contacts": {"left": contact("a", 2.0, 0.3), "right": contact("b", 0.5, 0.2)},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 1}, "supports": [{"on": "a", "ux": 0}, {"on": "b", "ux": 0}],
                "loads": [{"on": "a", "force": {"y": -10}}, {"on": "b", "force": {"y": -20}}]},
            {"name": "draw", "duration": 1, "dt": {"initial": 0.125},
                "supports": [{"on": "a", "ux": {"rate": 0.5}}, {"on": "b", "ux": {"rate": -2}}]}
        ],
        "output": {"fields": false, "checkpoint": 0}
    });
    for interval in [None, Some(0.3)] {
        if let Some(interval) = interval {
            case["output"]["interval"] = json!(interval);
        }
        let folder = TempDir::new().expect("a folder");
        run(folder.path(), &case);
        let history = table(folder.path().join("out/history.csv"));
        let last = |name: &str| *history[name].last().expect("a row");
        for (name, force, area, mu, way) in [("left", 10.0, 2.0, 0.3, 0.5), ("right", 20.0, 0.5, 0.2, 2.0)] {
            let heat = mu * force * (way - mu * force / area / 1e4);
            close(name, last(&format!("{name}.frictional_heat")), heat, 1e-9 * heat);
            close(name, last(&format!("{name}.frictional_power")), mu * force * way, 1e-9 * heat);
        }
        let all = last("left.frictional_heat") + last("right.frictional_heat");
        close("all", all, last("friction_dissipation"), 1e-14 * all);
    }
}

/// Increments end at the times asked for, and go on as long as they were; nothing else has frames.
#[test]
fn fields_are_written_at_the_times_asked_for() {
    let at = [0.1, 0.2501, 0.3, 1.0, 1.37];
    for scheme in [json!("static"), json!({"newmark": {}}), json!({"explicit": {}})] {
        let folder = TempDir::new().expect("a folder");
        let step = |name: &str| {
            json!({"name": name, "duration": 1, "scheme": scheme, "dt": {"initial": 0.1, "min": 1e-4},
            "supports": [{"on": "bar_left", "ux": 0, "uy": 0}, {"on": "bar_right", "ux": {"rate": 1e-3}, "uy": 0}]})
        };
        let mut case = json!({
            "mesh": Blocks::default().rectangle("bar", [2, 1], [0.0, 0.0], [1.0, 0.5]).json(),
            "bodies": {"bar": {"material": {"model": "linear", "E": 1, "nu": 0.3, "density": 1}}},
            "steps": [step("one"), step("two")],
            "output": {"times": at, "interval": 0.1, "checkpoint": 0}
        });
        run(folder.path(), &case);
        let out = folder.path().join("out");
        let expected = [0.0, 0.1, 0.2501, 0.3, 1.0, 1.37, 2.0];
        let frames = times(&out, "solid.pvd");
        assert_eq!(frames.len(), expected.len(), "{scheme}: {frames:?}");
        frames.iter().zip(expected).for_each(|(time, expected)| close("time of a frame", *time, expected, 1e-15));
        // 20 increments of 0.1, and for each time between two of them two halves instead of one, and a rest.
        let rows = table(out.join("history.csv"))["time"].clone();
        assert!((20..=27).contains(&rows.len()), "{scheme}: {rows:?}");
        for (times, words) in [
            (json!([0.3, 0.2]), "output.times[1]: is 0.2, but 0.3 comes before it"),
            (json!([2.5]), "output.times[0]: is 2.5: must be after 0 and not after 2"),
            (json!([0]), "output.times[0]: is 0"),
        ] {
            case["output"]["times"] = times;
            let output = start(folder.path(), &case);
            let told = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(output.status.code() == Some(2) && told.contains(words), "{told}");
        }
    }
}

/// A step in which nothing happens.
fn still() -> LoadStep {
    LoadStep::new("still", 1.0).dt(1.0).fix("body_bottom")
}

/// Stresses at the integration points, at their places: those of the bending that the supports bring in, u_x = −κ x y and
/// u_y = κ x²/2, which Q8 has exactly: σ_xx = (λ + 2G) ε_xx, ε_xx = −κ y.
#[test]
fn integration_points_have_their_stresses() {
    let (young, nu, bend) = (1000.0, 0.25, 1e-3);
    let (lambda, shear) = (young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), 0.5 * young / (1.0 + nu));
    let mesh = common::quadratic(
        &Blocks::default().rectangle("bar", [3, 2], [0.0, -0.5], [3.0, 0.5]).json(),
        common::half_way,
    );
    let supports: Vec<Value> = mesh["nodes"]
        .as_array()
        .expect("nodes")
        .iter()
        .enumerate()
        .map(|(node, at)| {
            let [x, y] = [0, 1].map(|i| at[i].as_f64().expect("a number"));
            json!({"on": {"node": node}, "ux": -bend * x * y, "uy": 0.5 * bend * x * x})
        })
        .collect();
    let folder = TempDir::new().expect("a folder");
    run(
        folder.path(),
        &json!({
            "mesh": mesh, "bodies": {"bar": {"material": {"model": "linear", "E": young, "nu": nu}}},
            "steps": [{"name": "bend", "duration": 1, "dt": {"initial": 1}, "supports": supports}],
            "output": {"points": true, "checkpoint": 0}
        }),
    );
    let out = folder.path().join("out");
    assert_eq!(times(&out, "points.pvd"), [0.0, 1.0]);
    let shown = frame(&out.join("points/00001.vtu"));
    let places: Vec<f64> = shown.points.cast_into().expect("places");
    let (stress, moved) = (values(&shown.data.point, "stress"), values(&shown.data.point, "displacement"));
    assert_eq!((places.len(), stress.len(), shown.cells.types.len()), (3 * 6 * 9, 6 * 6 * 9, 6 * 9));
    assert!(shown.cells.types.iter().all(|kind| *kind == CellType::Vertex));
    let mut heights = BTreeSet::new();
    for (k, at) in places.chunks(3).enumerate() {
        let strain = -bend * at[1];
        close("σ_xx", stress[6 * k], (lambda + 2.0 * shear) * strain, 1e-9);
        close("σ_yy", stress[6 * k + 1], lambda * strain, 1e-9);
        close("σ_xy", stress[6 * k + 3], 0.0, 1e-9);
        close("u_x", moved[3 * k], -bend * at[0] * at[1], 1e-12);
        heights.insert((1e6 * at[1]).round() as i64);
    }
    // Three rows of Gauss points in each of the two rows of elements.
    let h = 0.25 * 0.6f64.sqrt();
    let gauss: BTreeSet<i64> =
        [-0.25 - h, -0.25, -0.25 + h, 0.25 - h, 0.25, 0.25 + h].iter().map(|y| (1e6 * y).round() as i64).collect();
    assert_eq!(heights, gauss);
    assert_eq!(values(&shown.data.cell, "body"), vec![0.0; 54]);
}

/// Elements of a body that has gone, and their integration points, are hidden as VTK hides cells, from the first frame of that step on; its
/// gauge reads no stress.
#[test]
fn absent_bodies_are_hidden() {
    let blocks = json!({"joined": [["ground", "cut"]], "blocks": [
        {"body": "ground", "corners": [[0, 0], [1, 0], [1, 1], [0, 1]], "elements": [1, 2], "sides": ["bottom", null, null, null]},
        {"body": "cut", "corners": [[0, 1], [1, 1], [1, 2], [0, 2]], "elements": [1, 1]},
    ]});
    let body = json!({"material": {"model": "neo_hookean", "E": 100, "nu": 0.3, "density": 1}});
    let case = json!({
        "mesh": blocks, "bodies": {"ground": body, "cut": body}, "probes": {"gauge": {"at": [0.5, 1.5]}},
        "output": {"points": true, "report": false},
        "steps": [
            {"name": "rest", "duration": 1, "dt": {"initial": 1}, "supports": [{"on": "bottom", "ux": 0, "uy": 0}],
             "loads": [{"on": "ground", "gravity": {"y": -1}}, {"on": "cut", "gravity": {"y": -1}}]},
            {"name": "dig", "duration": 1, "dt": {"initial": 0.5}, "remove": ["cut"]},
        ],
    });
    let folder = TempDir::new().expect("a folder");
    run(folder.path(), &case);
    let out = folder.path().join("out");
    let model = common::model(&case);
    let cut = model.bodies.iter().position(|body| body.name == "cut").expect("a body") as f64;
    assert_eq!(times(&out, "solid.pvd"), [0.0, 1.0, 1.5, 2.0]);
    for (number, gone) in [false, false, true, true].into_iter().enumerate() {
        for series in ["solid", "points"] {
            let shown = frame(&out.join(format!("{series}/{number:05}.vtu"))).data;
            let [bodies, ghosts] = ["body", "vtkGhostType"].map(|name| values(&shown.cell, name));
            for (body, ghost) in bodies.iter().zip(&ghosts) {
                assert_eq!(*ghost, if gone && *body == cut { 32.0 } else { 0.0 }, "{series} {number}");
            }
        }
    }
    let stress = &table(out.join("probes.csv"))["gauge.stress_yy"];
    assert!(stress[0].is_finite() && stress[1..].iter().all(|stress| stress.is_nan()), "{stress:?}");
}

/// The bound of the error over sixty decades, and values that must not change.
#[test]
fn rounding_is_relative() {
    let mut most = 0.0f64;
    for k in 0..200_000 {
        let value = 10f64.powf(-30.0 + 3e-4 * f64::from(k)) * if k % 2 == 0 { 1.0 } else { -1.0 };
        most = most.max((f64::from(rounded(value, BITS)) - value).abs() / value.abs());
        assert_eq!(f64::from(rounded(value, BITS)).to_bits() & ((1 << (52 - BITS)) - 1), 0);
    }
    assert!(most <= RELATIVE_ERROR && most > 0.99 * RELATIVE_ERROR, "{most}");
    for same in [0.0, 1.0, -2.0, 1.5, f64::INFINITY] {
        assert_eq!(f64::from(rounded(same, BITS)), same);
    }
    assert!(rounded(f64::NAN, BITS).is_nan());
    // A tie is rounded to the even neighbour.
    let near = |halves: f64| rounded(1.0 + halves * 2f64.powi(-16), BITS);
    assert_eq!((near(1.0), near(3.0)), (1.0, 1.0 + 2f32.powi(-14)));
    assert_eq!(rounded(f32::MAX.into(), 11), f32::MAX, "what would be infinite stays");
}

#[test]
fn what_is_packed_comes_back() {
    let bytes: Vec<u8> = (0..4096u32).flat_map(|k| (k * k).to_le_bytes()).collect();
    for (size, level) in [(4, QUICK), (8, THOROUGH)] {
        assert_eq!(unpacked(&packed(&bytes, size, level), size, bytes.len()).as_ref(), Ok(&bytes));
    }
    assert_eq!(shuffled(&[1, 2, 3, 4, 5, 6], 2), [1, 3, 5, 2, 4, 6]);
    let mut damaged = packed(&bytes, 4, THOROUGH);
    damaged.truncate(damaged.len() / 2);
    assert!(unpacked(&damaged, 4, bytes.len()).is_err() && unpacked(&damaged, 4, 8).is_err());
}
