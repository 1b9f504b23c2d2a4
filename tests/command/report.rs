//! `report.html`: what is packed into it is what stands in the folder, and faults are told in it. How it looks and works in a
//! browser is tested in `tests/browser`.

use std::fmt::Write;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use tempfile::TempDir;
use vtkio::model::{Attribute, DataSet};

fn fecontact(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fecontact_tested")).args(arguments).output().expect("the program starts")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A block on a ground, pressed and dragged in a few increments.
fn case(output: Value) -> Value {
    json!({
        "title": "Ends </script> in the middle",
        "units": {"length": "mm", "force": "N", "time": "s"},
        "mesh": {
            "nodes": [[0, 0], [2, 0], [2, 1], [0, 1], [0.5, 1], [1.5, 1], [1.5, 2], [0.5, 2]],
            "elements": {"ground": [[0, 1, 2, 3]], "block": [[4, 5, 6, 7]]},
            "edges": {"bottom": [[0, 1]], "ground_top": [[2, 3]], "block_bottom": [[4, 5]], "block_top": [[6, 7]]}
        },
        "bodies": {
            "block": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3, "density": 0}},
            "ground": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3, "density": 0}}
        },
        "contacts": {"base": {"slave": "block_bottom", "master": "ground_top", "friction": {"law": "coulomb", "mu": 0.3}}},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.25, "max": 0.25, "min": 1e-4},
             "supports": [{"on": "bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0, "uy": -0.02}]},
            {"name": "drag", "duration": 1, "supports": [{"on": "block_top", "ux": {"rate": 0.02}}]}
        ],
        "watch": ["block_top"],
        "output": output
    })
}

/// A run of it in a folder of its own, with a frame at every row, and as it was computed, unless the output says otherwise.
fn run(mut output: Value) -> (TempDir, PathBuf) {
    let folder = TempDir::new().unwrap();
    for (key, value) in [("every", json!(1)), ("exact", json!(true))] {
        output.as_object_mut().unwrap().entry(key).or_insert(value);
    }
    let file = folder.path().join("case.json");
    fs::write(&file, case(output).to_string()).unwrap();
    let out = folder.path().join("out");
    let ran = fecontact(&["run", file.to_str().unwrap(), "--out", out.to_str().unwrap(), "--quiet"]);
    assert!(ran.status.success(), "{}", stderr(&ran));
    (folder, out)
}

fn report(folders: &[&Path], out: &Path) -> Output {
    let mut arguments = vec!["report", "--out", out.to_str().unwrap()];
    arguments.extend(folders.iter().map(|folder| folder.to_str().unwrap()));
    fecontact(&arguments)
}

/// A page, taken apart as the browser does it.
struct Page {
    data: Value,
    numbers: String,
}

impl Page {
    fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).unwrap();
        let element = |id: &str| {
            let (_, after) = text.split_once(&format!("id=\"{id}\">")).unwrap();
            after.split_once("</script>").unwrap().0.to_owned()
        };
        Self { data: serde_json::from_str(&element("data")).unwrap(), numbers: element("numbers") }
    }

    fn of(folder: &Path) -> Self {
        let file = folder.parent().unwrap().join("page.html");
        let message = report(&[folder], &file);
        assert!(message.status.success(), "{}", stderr(&message));
        Self::read(&file)
    }

    fn bytes<const N: usize>(&self, chunk: &Value) -> Vec<[u8; N]> {
        let [start, length] = [0, 1].map(|k| chunk[k].as_u64().unwrap() as usize);
        let packed = STANDARD.decode(&self.numbers[start..start + length]).unwrap();
        let mut bytes = Vec::new();
        flate2::read::DeflateDecoder::new(&packed[..]).read_to_end(&mut bytes).unwrap();
        let count = bytes.len() / N;
        (0..count).map(|k| std::array::from_fn(|i| bytes[i * count + k])).collect()
    }

    fn singles(&self, chunk: &Value) -> Vec<f64> {
        self.bytes(chunk).into_iter().map(|bytes| f64::from(f32::from_le_bytes(bytes))).collect()
    }

    /// Numbers in whole steps, of which the differences are packed.
    fn stepped(&self, chunk: &Value) -> Vec<f64> {
        let (step, components) = (chunk[2].as_f64().unwrap(), chunk[3].as_u64().unwrap() as usize);
        let differences: Vec<i32> = self.bytes(chunk).into_iter().map(i32::from_le_bytes).collect();
        let mut last = vec![0; components];
        let mut value = |(k, difference): (usize, &i32)| {
            last[k % components] += difference;
            step * f64::from(last[k % components])
        };
        differences.iter().enumerate().map(&mut value).collect()
    }

    fn doubles(&self, chunk: &Value) -> Vec<f64> {
        self.bytes(chunk).into_iter().map(f64::from_le_bytes).collect()
    }

    fn run(&self) -> &Value {
        &self.data["runs"][0]
    }

    fn notes(&self) -> String {
        self.run()["notes"].as_array().unwrap().iter().filter_map(Value::as_str).collect::<Vec<_>>().join("\n")
    }
}

/// Columns of a CSV file by the header.
fn table(path: &Path) -> (Vec<String>, Vec<Vec<String>>) {
    let text = fs::read_to_string(path).unwrap();
    let cells = |line: &str| line.split(',').map(String::from).collect::<Vec<_>>();
    let mut lines = text.lines();
    (cells(lines.next().unwrap()), lines.map(cells).collect())
}

/// An array of a VTU file.
fn array(path: &Path, name: &str) -> (usize, Vec<f64>) {
    let DataSet::UnstructuredGrid { pieces, .. } = vtkio::Vtk::import(path).unwrap().data else { panic!("{path:?}") };
    let piece = pieces.into_iter().next().unwrap().into_loaded_piece_data(None).unwrap();
    let of = |attribute| match attribute {
        Attribute::DataArray(array) if array.name == name => Some((array.num_comp(), array.data.cast_into().unwrap())),
        _ => None,
    };
    piece.data.point.into_iter().find_map(of).unwrap()
}

#[test]
fn a_run_ends_with_its_page_unless_the_case_says_no() {
    let (_kept, out) = run(json!({}));
    let page = Page::read(&out.join("report.html"));
    let summary: Value = serde_json::from_str(&fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
    assert_eq!(page.run()["summary"], summary);
    assert!(summary["files"].as_array().unwrap().contains(&"report.html".into()));
    let understood = summary["understood"].as_array().unwrap();
    let contacts = understood.iter().find(|section| section[0] == "contacts").unwrap();
    assert!(contacts[1].to_string().contains("friction coulomb: mu 0.3"), "{contacts}");
    let (_kept, out) = run(json!({"report": false}));
    assert!(!out.join("report.html").exists());
}

#[test]
fn a_page_holds_the_numbers_of_its_folder() {
    let (_kept, out) = run(json!({}));
    let page = Page::of(&out);
    assert_eq!(page.notes(), "");
    let (names, rows) = table(&out.join("history.csv"));
    for (k, name) in names.iter().enumerate() {
        let column = &page.run()["history"]["columns"][k];
        assert_eq!(column["name"], *name);
        let values = match column["type"].as_str().unwrap() {
            "f64" => page.doubles(&column["chunk"]),
            _ => page.singles(&column["chunk"]),
        };
        assert_eq!(values.len(), rows.len());
        for (row, value) in rows.iter().zip(values) {
            match (column["words"].as_array(), name.as_str()) {
                (Some(words), _) => assert_eq!(words[value as usize], row[k]),
                (None, "time") => assert_eq!(value, row[k].parse::<f64>().unwrap()),
                (None, _) => assert_eq!(value, f64::from(row[k].parse::<f32>().unwrap())),
            }
        }
    }
    let frames = page.run()["solid"]["frames"].as_array().unwrap();
    assert_eq!(frames.len(), fs::read_dir(out.join("solid")).unwrap().count());
    let largest = page.run()["solid"]["largest"].as_f64().unwrap();
    for (number, frame) in frames.iter().enumerate() {
        let file = out.join(format!("solid/{number:05}.vtu"));
        let (components, moved) = array(&file, "displacement");
        let shown = page.stepped(&frame["displacement"]);
        for (u, shown) in moved.chunks_exact(components).zip(shown.chunks_exact(2)) {
            // Half a step along each axis, which is 2⁻²⁰ of the largest.
            assert!((u[0] - shown[0]).hypot(u[1] - shown[1]) <= largest * 2f64.powi(-19), "{u:?} as {shown:?}");
        }
        let (components, stresses) = array(&file, "stress");
        assert_eq!(components, 6);
        // The page has those of the plane.
        for i in 0..4 {
            let shown = page.stepped(&frame["fields"]["stress"]["components"][i]["chunk"]);
            let largest = stresses.iter().skip(i).step_by(components).fold(0.0, |largest, s| s.abs().max(largest));
            for (stress, shown) in stresses.iter().skip(i).step_by(components).zip(shown) {
                // Half a step, as the page says.
                assert!((stress - shown).abs() <= 1.0001 * largest / 16384.0, "{stress} as {shown}");
            }
        }
    }
    // A frame at every row, and one at the start: the interface has a record for each of the rows.
    let map = &page.run()["interfaces"][0];
    assert_eq!((&map["contact"], &map["from"]), (&"base".into(), &"interface.zarr".into()));
    assert_eq!(
        page.doubles(&map["times"]),
        frames.iter().skip(1).map(|frame| frame["time"].as_f64().unwrap()).collect::<Vec<_>>()
    );
    let pressure = map["quantities"].as_array().unwrap().iter().find(|one| one["name"] == "pressure").unwrap();
    let last = array(&out.join(format!("contact/{:05}.vtu", frames.len() - 1)), "pressure").1;
    let shown = page.singles(&pressure["chunk"]);
    for (p, shown) in last.iter().zip(&shown[shown.len() - last.len()..]) {
        assert!((p - shown).abs() <= p * (2f64.powi(-12) + 2f64.powi(-23)) && *p > 0.0, "{p} as {shown}");
    }
}

#[test]
fn faults_of_a_folder_are_reported_and_hide_no_more_than_they_must() {
    let (_kept, out) = run(json!({}));
    let frames = fs::read_dir(out.join("solid")).unwrap().count();
    fs::remove_file(out.join("solid/00002.vtu")).unwrap();
    let damaged = fs::read(out.join("solid/00003.vtu")).unwrap();
    fs::write(out.join("solid/00003.vtu"), &damaged[..damaged.len() / 2]).unwrap();
    let history = fs::read_to_string(out.join("history.csv")).unwrap();
    let mut lines: Vec<String> = history.lines().map(Into::into).collect();
    lines[2] = lines[2].replacen(",0.0,", ",NaN,", 1);
    lines.push("9,not a row".into());
    fs::write(out.join("history.csv"), lines.join("\n") + "\n").unwrap();
    fs::write(out.join("newton.csv"), "").unwrap();
    let page = Page::of(&out);
    for message in
        ["solid/00002.vtu is missing", "solid/00003.vtu", "not numbers", "only the rows before it", "newton.csv"]
    {
        assert!(page.notes().contains(message), "{message}: {}", page.notes());
    }
    assert_eq!(page.run()["solid"]["frames"].as_array().unwrap().len(), frames - 2);
    assert_eq!(page.run()["history"]["rows"], history.lines().count() - 1);
    // Of what is left when nearly all is gone there is a page, too.
    fs::remove_file(out.join("summary.json")).unwrap();
    fs::remove_file(out.join("solid.pvd")).unwrap();
    fs::write(out.join("contact.pvd"), "<DataSet timestep=\"x\"").unwrap();
    let header = history.lines().next().unwrap();
    fs::write(out.join("history.csv"), format!("{header}\n")).unwrap();
    let page = Page::of(&out);
    for message in
        ["summary.json is missing", "history.csv has no rows yet", "contact.pvd lists a frame without a time"]
    {
        assert!(page.notes().contains(message), "{message}: {}", page.notes());
    }
}

#[test]
fn of_too_many_rows_the_extremes_are_shown() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("long");
    fs::create_dir(&out).unwrap();
    let mut text = "time,dt,step,iterations,kinetic,base.normal_force\n".to_owned();
    for k in 0..300_000 {
        let spike = if k == 123_456 { 1e6 } else { 0.0 };
        writeln!(text, "{},0.1,go,2,{},{spike}", f64::from(k) / 10.0, f64::from(k % 17)).unwrap();
    }
    fs::write(out.join("history.csv"), text).unwrap();
    let page = Page::of(&out);
    let rows = page.run()["history"]["rows"].as_u64().unwrap();
    assert!((5000..=40_000).contains(&rows), "{rows} rows");
    assert!(page.notes().contains(&format!("{rows} of 300000 rows are shown")), "{}", page.notes());
    let columns = &page.run()["history"]["columns"];
    let times = page.doubles(&columns[0]["chunk"]);
    let forces = page.singles(&columns[5]["chunk"]);
    let spike = forces.iter().position(|force| *force == 1e6).unwrap();
    assert_eq!((times[0], times[spike], times.last()), (0.0, 12345.6, Some(&29999.9)));
}

#[test]
fn several_runs_are_on_one_page() {
    let ((_one, first), (_two, second)) = (run(json!({})), run(json!({"every": 3})));
    let named = second.with_file_name("other");
    fs::rename(&second, &named).unwrap();
    let file = named.with_file_name("both.html");
    assert!(report(&[&first, &named], &file).status.success());
    let page = Page::read(&file);
    let names: Vec<&Value> = page.data["runs"].as_array().unwrap().iter().map(|run| &run["name"]).collect();
    assert_eq!(names, ["out", "other"]);
}

#[test]
fn what_is_no_page_of_ours_is_left_alone() {
    let (folder, out) = run(json!({"report": false}));
    let mine = out.join("report.html");
    fs::write(&mine, "<html>mine</html>").unwrap();
    let message = fecontact(&["report", out.to_str().unwrap()]);
    assert!(!message.status.success() && stderr(&message).contains("is in the way"), "{}", stderr(&message));
    let file = folder.path().join("case.json");
    fs::write(&file, case(json!({})).to_string()).unwrap();
    let message = fecontact(&["run", file.to_str().unwrap(), "--out", out.to_str().unwrap(), "--quiet"]);
    assert_eq!(message.status.code(), Some(2));
    assert!(stderr(&message).contains("report.html: --out: is in the way"), "{}", stderr(&message));
    assert_eq!(fs::read_to_string(&mine).unwrap(), "<html>mine</html>");
    // A page of ours is replaced by the next run, whoever asked for it.
    fs::remove_file(&mine).unwrap();
    assert!(fecontact(&["report", out.to_str().unwrap()]).status.success());
    let message = fecontact(&["run", file.to_str().unwrap(), "--out", out.to_str().unwrap(), "--quiet"]);
    assert!(message.status.success(), "{}", stderr(&message));
}

#[test]
fn a_folder_of_something_else_is_refused_by_name() {
    let folder = TempDir::new().unwrap();
    let refused = |path: &Path, why: &str| {
        let message = report(&[path], &folder.path().join("page.html"));
        assert_eq!(message.status.code(), Some(2), "{}", stderr(&message));
        assert!(
            stderr(&message).contains(path.to_str().unwrap()) && stderr(&message).contains(why),
            "{}",
            stderr(&message)
        );
        assert!(!folder.path().join("page.html").exists());
    };
    refused(&folder.path().join("nowhere"), "is not a folder");
    refused(folder.path(), "neither history.csv nor law.csv nor summary.json");
}

/// Millimetres are not drawn over metres.
#[test]
fn folders_of_other_units_are_refused() {
    let ((_one, first), (_two, second)) = (run(json!({"report": false})), run(json!({"report": false})));
    let summary = second.join("summary.json");
    let text = fs::read_to_string(&summary).unwrap().replace("\"mm\"", "\"m\"");
    fs::write(&summary, text).unwrap();
    let page = second.with_file_name("page.html");
    let message = report(&[&first, &second], &page);
    assert_eq!(message.status.code(), Some(2), "{}", stderr(&message));
    let places = [&first, &second].map(|folder| folder.to_str().unwrap());
    for what in ["length is in m, but in mm in", places[0], places[1]] {
        assert!(stderr(&message).contains(what), "{what}: {}", stderr(&message));
    }
    assert!(!page.exists());
}

/// A run that is going on, or was killed: no summary yet, and the last line may be cut anywhere.
#[test]
fn a_line_that_is_being_written_is_left_out() {
    let (_kept, out) = run(json!({"report": false}));
    fs::remove_file(out.join("summary.json")).unwrap();
    let whole = fs::read_to_string(out.join("history.csv")).unwrap();
    let last = whole.trim_end().rfind('\n').unwrap() + 1;
    for cut in [0, 1, 7, 40, whole.len() - last - 1] {
        fs::write(out.join("history.csv"), &whole[..last + cut]).unwrap();
        let page = Page::of(&out);
        assert_eq!(page.run()["history"]["rows"], whole.lines().count() - 2, "{cut}");
        assert!(!page.notes().contains("history.csv"), "{cut}: {}", page.notes());
    }
}

/// Of a test of a law.
fn law(folder: &Path, name: &str) -> PathBuf {
    let test = crate::common::repository(format!("cases/law/{name}.json"));
    let out = folder.join(name);
    let message = fecontact(&["law", test.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert!(message.status.success(), "{}", stderr(&message));
    out
}

#[test]
fn a_law_driven_alone_has_its_page() {
    let folder = TempDir::new().unwrap();
    let outs = ["hold_slide_hold", "pressure_steps"].map(|name| law(folder.path(), name));
    let page = Page::read(&outs[0].join("report.html"));
    assert_eq!(page.notes(), "");
    let summary: Value = serde_json::from_str(&fs::read_to_string(outs[0].join("summary.json")).unwrap()).unwrap();
    assert!(summary["files"].as_array().unwrap().contains(&"report.html".into()));
    assert_eq!(page.run()["summary"], summary);
    assert!(summary["holds"].as_array().unwrap().len() > 3);
    let (names, rows) = table(&outs[0].join("law.csv"));
    assert_eq!(page.run()["law"]["rows"], rows.len());
    for (k, column) in page.run()["law"]["columns"].as_array().unwrap().iter().enumerate() {
        assert_eq!(column["name"], names[k]);
        let exact = column["type"] == "f64";
        let shown = if exact { page.doubles(&column["chunk"]) } else { page.singles(&column["chunk"]) };
        for (row, shown) in rows.iter().zip(shown) {
            let value: f64 = row[k].parse().unwrap();
            assert_eq!(shown, if exact { value } else { f64::from(value as f32) }, "{}", names[k]);
        }
    }
    // Written again it is the same, and several are laid over each other, beside a run if need be.
    let written = fs::read(outs[0].join("report.html")).unwrap();
    assert!(fecontact(&["report", outs[0].to_str().unwrap()]).status.success());
    assert_eq!(fs::read(outs[0].join("report.html")).unwrap(), written);
    let (_kept, ran) = run(json!({"report": false}));
    let file = folder.path().join("all.html");
    let message = report(&[&outs[0], &outs[1]], &file);
    assert!(message.status.success(), "{}", stderr(&message));
    assert_eq!(Page::read(&file).data["runs"].as_array().unwrap().len(), 2);
    let message = report(&[&ran, &outs[0]], &file);
    assert!(message.status.success(), "{}", stderr(&message));
    let page = Page::read(&file);
    assert!(page.data["runs"][0]["law"].is_null() && page.data["runs"][1]["history"].is_null());
}

/// Figures that an earlier version has drawn go with the results of the next run; a user's of the same name stay.
#[test]
fn stale_figures_are_removed() {
    let (folder, out) = run(json!({}));
    fs::write(out.join("friction.svg"), "<svg data-drawn-by=\"fecontact\">").unwrap();
    fs::write(out.join("slip.svg"), "<svg>mine</svg>").unwrap();
    let file = folder.path().join("case.json");
    let message = fecontact(&["run", file.to_str().unwrap(), "--out", out.to_str().unwrap(), "--quiet"]);
    assert!(message.status.success(), "{}", stderr(&message));
    assert!(!out.join("friction.svg").exists() && out.join("slip.svg").exists());
}

/// Attempts that were given up are those of which `newton.csv` says so: an accepted one is none, although the run ended after it
/// without a solve, and another attempt at the same increment followed.
#[test]
fn accepted_attempts_are_not_among_those_given_up() {
    let (_kept, out) = run(json!({"report": false}));
    let file = out.join("newton.csv");
    let (header, rows) = table(&file);
    let column = |name: &str| header.iter().position(|column| column == name).unwrap();
    let [increment, attempt, verdict, reason] = ["increment", "attempt", "verdict", "reason"].map(column);
    let mut lost = rows.last().unwrap().clone();
    let accepted = lost.clone();
    let number: u32 = lost[increment].parse().unwrap();
    for (k, value) in
        [(verdict, "unsolved"), (reason, "contact was lost during the iterations: body `block` flies off")]
    {
        lost[k] = value.into();
    }
    lost[increment] = (number + 1).to_string();
    let mut last = accepted;
    last[increment] = (number + 1).to_string();
    last[attempt] = "2".into();
    let lines = [header].into_iter().chain(rows).chain([lost, last]).map(|row| row.join(","));
    fs::write(&file, lines.collect::<Vec<_>>().join("\n") + "\n").unwrap();
    let summary = out.join("summary.json");
    let text = fs::read_to_string(&summary).unwrap().replace("\"completed\"", "\"stopped\"");
    fs::write(&summary, text).unwrap();
    let page = Page::of(&out);
    let attempts = &page.run()["newton"]["attempts"];
    assert_eq!(attempts["total"], 1, "{attempts}");
    let message = attempts["given_up"][0]["why"].as_str().unwrap();
    assert_eq!(message, "contact was lost during the iterations: body `block` flies off");
}
