//! `fecontact plot`: figures of result folders, finished or cut off, one or several.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::common::store;
use tempfile::TempDir;

const RUN_FIGURES: [&str; 7] = [
    "displacement.svg",
    "friction.svg",
    "friction_path.svg",
    "slip.svg",
    "slip_fraction.svg",
    "energy.svg",
    "newton.svg",
];

const HEADER: &str = "time,dt,step,iterations,kinetic,strain,contact_elastic,friction_dissipation,\
    damping_dissipation,external_work,energy_error,base.normal_force,base.tangential_force,base.contact_length,\
    base.slip_fraction,base.mean_slip,base.max_penetration,base.max_elastic_slip,base.mean_elastic_slip,tip.ux,tip.uy,\
    tip.fx,tip.fy";

fn fecontact(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fecontact")).args(arguments).output().expect("the program starts")
}

fn plot(folders: &[&Path], out: &Path) -> Output {
    let mut arguments = vec!["plot", "--out", out.to_str().unwrap()];
    arguments.extend(folders.iter().map(|folder| folder.to_str().unwrap()));
    fecontact(&arguments)
}

/// A history of so many rows, of a force that rings at a rate.
fn history(rows: usize, rate: f64) -> String {
    let mut text = format!("{HEADER}\n");
    for k in 1..=rows {
        let t = 20.0 * k as f64 / rows as f64;
        let force = 15.0 * (1.0 + 0.5 * (rate * t).sin()) * (0.3 * t).sin();
        writeln!(
            text,
            "{t},0.1,pull,2,{},{t},0.5,{t},0,{},1e-9,98.1,{force},1,{},{},0.01,0.02,{},{},1e-18,0,0",
            force * force,
            2.0 * t,
            if force > 14.0 { 1.0 } else { 0.25 },
            0.1 * t,
            1e-3 * force,
            0.2 * t,
        )
        .unwrap();
    }
    text
}

fn newton(rows: usize) -> String {
    let mut text =
        "step,increment,attempt,iteration,time,residual,correction,open,stick,slip,linear_residual\n".to_owned();
    for k in 1..=rows {
        for (iteration, residual) in [0.1, 1e-4, 1e-9].into_iter().enumerate() {
            writeln!(text, "pull,{k},1,{},{},{residual},1e-3,0,1,0,1e-16", iteration + 1, k as f64 * 0.1).unwrap();
        }
    }
    text
}

fn summary(title: &str, length: &str) -> String {
    format!(
        r#"{{"status": "completed", "title": "{title}", "units": {{"length": "{length}", "force": "N", "time": "s"}},
            "friction": {{"base": {{"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "r": 100}}}}, "dofs": 2}}"#
    )
}

/// A finished run.
fn results(folder: &Path, name: &str, rate: f64) -> std::path::PathBuf {
    let folder = folder.join(name);
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("history.csv"), history(400, rate)).unwrap();
    fs::write(folder.join("newton.csv"), newton(200)).unwrap();
    fs::write(folder.join("summary.json"), summary("Stick & slip < 1", "mm")).unwrap();
    folder
}

fn figure(folder: &Path, name: &str) -> String {
    let text = fs::read_to_string(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    check_xml(&text, name);
    text
}

/// Every tag that is opened is closed, in order, and nothing is unescaped or not a number.
fn check_xml(text: &str, name: &str) {
    let mut open = Vec::new();
    for part in text.split('<').skip(1) {
        let (tag, after) = part.split_once('>').unwrap_or_else(|| panic!("{name}: <{part}"));
        if let Some(closed) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(closed), "{name}");
        } else if !tag.ends_with('/') {
            open.push(tag.split(' ').next().unwrap());
        }
        assert!(
            !after.contains('>') && !after.replace("&amp;", "").replace("&lt;", "").replace("&gt;", "").contains('&')
        );
    }
    assert!(open.is_empty(), "{name}: {open:?}");
    assert!(!text.contains("NaN") && !text.contains("inf"), "{name}");
}

#[test]
fn a_run_has_its_figures_with_names_units_and_bounds() {
    let folder = TempDir::new().unwrap();
    let run = results(folder.path(), "run", 3.0);
    let output = fecontact(&["plot", run.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(told.lines().count(), RUN_FIGURES.len(), "{told}");
    for name in RUN_FIGURES {
        let figure = figure(&run, name);
        assert!(told.contains(name) && figure.contains("Stick &amp; slip &lt; 1"), "{name}");
    }
    let friction = figure(&run, "friction.svg");
    for text in [">tangential force [N]<", ">time [s]<", ">base<", "μ_s × normal force<", "μ_k × normal force<"] {
        assert!(friction.contains(text), "{text} is not in friction.svg");
    }
    assert!(figure(&run, "displacement.svg").contains(">ux [mm]<"));
    assert!(!figure(&run, "displacement.svg").contains(">uy"), "round-off is not drawn");
    assert!(figure(&run, "slip.svg").contains("mean elastic slip"));
    assert!(figure(&run, "energy.svg").contains(">energy [N·mm]<"));
    assert!(figure(&run, "newton.svg").contains("100 increments with the most solves, of 200"));
    assert!(figure(&run, "newton.svg").contains(">10⁻⁸<"));
}

/// Several runs lie over each other under their names, in lines that differ by dashes and marks, not by colour alone.
#[test]
fn several_runs_are_overlaid() {
    let folder = TempDir::new().unwrap();
    let runs = [results(folder.path(), "resolved", 3.0), results(folder.path(), "damped", 0.0)];
    let out = folder.path().join("both");
    let output = plot(&[&runs[0], &runs[1]], &out);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    for name in RUN_FIGURES {
        let figure = figure(&out, name);
        assert!(figure.contains("resolved") && figure.contains("damped"), "{name}");
    }
    let friction = figure(&out, "friction.svg");
    let curves: Vec<&str> = friction.lines().filter(|line| line.contains("stroke-width=\"1.5\"")).collect();
    assert_eq!(curves.len(), 4, "two curves and their samples in the legend");
    assert_eq!(curves.iter().filter(|curve| curve.contains("stroke-dasharray")).count(), 2, "one is dashed");
    assert!(friction.contains("<circle") && friction.contains("<polygon"), "marks of two kinds");
    // Without --out they go to a folder of their own, so that no run gets figures that are not its own.
    let paths = runs.each_ref().map(|run| run.to_str().unwrap());
    let here = Command::new(env!("CARGO_BIN_EXE_fecontact"))
        .current_dir(folder.path())
        .args(["plot", paths[0], paths[1]])
        .output()
        .unwrap();
    assert_eq!(here.status.code(), Some(0));
    assert!(folder.path().join("out/overlay/friction.svg").exists() && !runs[0].join("friction.svg").exists());
}

/// A run that is going on, or was killed: no summary yet, and the last line may be cut anywhere.
#[test]
fn a_line_that_is_being_written_is_left_out() {
    let folder = TempDir::new().unwrap();
    let run = folder.path().join("run");
    fs::create_dir(&run).unwrap();
    let whole = history(50, 3.0);
    let last = whole.trim_end().rfind('\n').unwrap() + 1;
    fs::write(run.join("history.csv"), &whole[..last]).unwrap();
    assert_eq!(plot(&[&run], &run).status.code(), Some(0));
    let before = figure(&run, "friction.svg");
    assert!(before.contains(">tangential force<"), "units are not known");
    for cut in [1, 7, 40, whole.len() - last - 1] {
        fs::write(run.join("history.csv"), &whole[..last + cut]).unwrap();
        fs::write(run.join("newton.csv"), &newton(3)[..150 + cut]).unwrap();
        assert_eq!(plot(&[&run], &run).status.code(), Some(0), "{cut}");
        assert_eq!(figure(&run, "friction.svg"), before, "{cut}");
    }
}

/// A long history of wild ringing makes small files.
#[test]
fn figures_of_long_histories_are_small() {
    let folder = TempDir::new().unwrap();
    let run = results(folder.path(), "run", 3.0);
    fs::write(run.join("history.csv"), history(200_000, 5000.0)).unwrap();
    assert_eq!(plot(&[&run, &run], folder.path()).status.code(), Some(0));
    for name in RUN_FIGURES {
        let size = figure(folder.path(), name).len();
        assert!(size < 1_000_000, "{name} has {size} bytes");
    }
}

#[test]
fn a_law_has_its_figure() {
    let folder = TempDir::new().unwrap();
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/law");
    let folders = ["hold_slide_hold", "pressure_steps"].map(|name| {
        let out = folder.path().join(name);
        let test = cases.join(format!("{name}.json"));
        let output = fecontact(&["law", test.to_str().unwrap(), "--out", out.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        out
    });
    let ageing = figure(&folders[0], "law.svg");
    for text in ["traction q [MPa]", "slip [mm]", "Peak after a hold over its length", "structure 1/R*", ">10²<"] {
        assert!(ageing.contains(text), "{text}");
    }
    assert!(!ageing.contains("Pressure over time"));
    assert!(figure(&folders[1], "law.svg").contains("Pressure over time"));
    // Drawn again, it is the same.
    fs::remove_file(folders[0].join("law.svg")).unwrap();
    assert_eq!(plot(&[&folders[0]], &folders[0]).status.code(), Some(0));
    assert_eq!(figure(&folders[0], "law.svg"), ageing);
    let both = folder.path().join("both");
    assert_eq!(plot(&[&folders[0], &folders[1]], &both).status.code(), Some(0));
    assert!(figure(&both, "law.svg").contains("q/p, pressure_steps"));
}

fn refused(folders: &[&Path], fragments: &[&str]) {
    let out = TempDir::new().unwrap();
    let output = plot(folders, out.path());
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{fragments:?}: {message}");
    assert!(message.starts_with("error: ") && !message.contains("panicked"), "{message}");
    for fragment in fragments {
        assert!(message.contains(fragment), "`{fragment}` is not in: {message}");
    }
    assert_eq!(fs::read_dir(out.path()).unwrap().count(), 0, "figures were written: {message}");
}

#[test]
fn folders_without_results_are_refused() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name);
    refused(&[&at("nowhere")], &["nowhere", "is not a folder"]);
    refused(&[folder.path()], &["has neither history.csv nor law.csv"]);

    let run = results(folder.path(), "run", 3.0);
    let broken = |history: &str| {
        let folder = results(folder.path(), "broken", 3.0);
        fs::write(folder.join("history.csv"), history).unwrap();
        folder
    };
    refused(&[&broken("")], &["history.csv", "nothing was written yet"]);
    refused(&[&broken(&format!("{HEADER}\n"))], &["history.csv", "has no rows yet"]);
    refused(&[&broken(&format!("{HEADER}\n1,2\n"))], &["line 2 ends before step"]);
    let bad = history(3, 1.0).replace("98.1", "98,1");
    refused(
        &[&run, &broken(&bad.replace("98,1", "much"))],
        &["broken", "line 2: base.normal_force is no number: much"],
    );
    refused(&[&broken("a,b\n1,2\n")], &["history.csv", "has no column `time`"]);

    let metres = results(folder.path(), "metres", 3.0);
    fs::write(metres.join("summary.json"), summary("x", "m")).unwrap();
    refused(&[&run, &metres], &["metres", "length is in m, but in mm in", "run"]);
    fs::write(metres.join("summary.json"), "{").unwrap();
    refused(&[&metres], &["summary.json"]);

    let law = at("law");
    fs::create_dir(&law).unwrap();
    fs::write(law.join("law.csv"), "time\n1\n").unwrap();
    refused(&[&law], &["law.csv", "has no column `slip`"]);
    refused(&[&run, &law], &["cannot be drawn over each other"]);
    assert_eq!(fecontact(&["plot"]).status.code(), Some(2));
}

/// Times, and quantities record by record.
type Map = (Vec<f64>, BTreeMap<&'static str, Vec<f64>>);

/// 41 points on 40 mm; from each start a pulse of 5 mm/s, 1 ms long, runs to the right at 1000 mm/s up to an end. Records are
/// 1 ms apart while something slips, and 1 s apart before and after if there is `rest`.
fn slip_map(pulses: &[(f64, f64)], rest: bool) -> Map {
    let mut times = if rest { vec![1.0, 2.0] } else { Vec::new() };
    for (start, _) in pulses {
        times.extend((0..=60).map(|k| start + 1e-3 * f64::from(k)));
        times.extend(rest.then_some(start + 1.0));
    }
    let mut quantities: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    let mut slips = [0.0; 41];
    for (k, time) in times.iter().enumerate() {
        for (point, slip) in slips.iter_mut().enumerate() {
            let s = point as f64;
            let arrives = |(start, end): &(f64, f64)| s <= *end && (time - start - 1e-3 * (s + 1.0)).abs() < 1e-6;
            let rate = if pulses.iter().any(arrives) { 5.0 } else { 0.0 };
            *slip += rate * if k == 0 { 0.0 } else { time - times[k - 1] };
            let traction = if *slip > 0.0 { 1.0 } else { 2.0 };
            for (name, value) in [("slip", *slip), ("slip_rate", rate), ("mu", 0.4), ("q", traction), ("p", 10.0)] {
                quantities.entry(name).or_default().push(value);
            }
        }
    }
    (times, quantities)
}

fn write_map(folder: &Path, (times, quantities): &Map) {
    let positions: Vec<f64> = (0..41).map(f64::from).collect();
    store::write(&folder.join("interface.zarr"), "base", times, &positions, quantities);
}

fn front_results(folder: &Path, name: &str, pulses: &[(f64, f64)]) -> std::path::PathBuf {
    let folder = results(folder, name, 3.0);
    let about = summary("Fronts", "mm")
        .replace("\"dofs\"", "\"wave_speeds\": [930, 1000, 1870], \"front_slip_rate\": 1, \"dofs\"");
    fs::write(folder.join("summary.json"), about).unwrap();
    write_map(&folder, &slip_map(pulses, true));
    folder
}

/// Left edges and tops of the cells of the darkest colour.
fn darkest(figure: &str) -> Vec<[f64; 2]> {
    let cell = |cell: &str| {
        let (x, y) = cell.split_once('h').expect("a width").0.split_once(',').expect("a place");
        [x.parse().unwrap(), y.parse().unwrap()]
    };
    let paths = figure.lines().filter(|line| line.starts_with("<path fill=\"#280048\""));
    paths.flat_map(|path| path.split('M').skip(1).map(cell)).collect()
}

/// Two fronts, of which one stops half way: the map of the run shows both, and each has a map of its own in which it
/// runs along the slope of its speed.
#[test]
fn fronts_are_drawn_over_space_and_time() {
    let folder = TempDir::new().unwrap();
    let run = front_results(folder.path(), "run", &[(3.0, 20.0), (10.0, 40.0)]);
    assert_eq!(plot(&[&run], &run).status.code(), Some(0));
    let whole = figure(&run, "slip_rate.svg");
    for text in [">Slip rate of base<", ">position along the slave [mm]<", ">time [s]<", ">[mm/s]<", ">5<", ">Fronts<"]
    {
        assert!(whole.contains(text), "{text}");
    }
    assert!(!whole.contains("c_R"), "waves have no slope where a second is 40 px");
    // The map is 720 px wide and has 41 columns; the first front reaches half of it.
    let cells = darkest(&whole);
    let tops: std::collections::BTreeSet<u64> = cells.iter().map(|[_, y]| y.to_bits()).collect();
    assert!((2..=3).contains(&tops.len()), "two thin lines, of which one may lie in two rows: {cells:?}");

    let events = figure(&run, "events.svg");
    for text in [
        ">1: t = 3.000000 s, mean slip 0.0026 mm<",
        ">2: t = 10.000000 s, mean slip 0.005 mm<",
        ">c_R<",
        ">c_s<",
        ">c_p<",
    ] {
        assert!(events.contains(text), "{text}");
    }
    // The second map stands right of the first. Columns are 330/41 px wide; 41 ms are 1/1.7 of its height of 250 px.
    let second: Vec<[f64; 2]> = darkest(&events).into_iter().filter(|[x, _]| *x > 420.0).collect();
    let left = second.iter().fold(f64::INFINITY, |least, [x, _]| x.min(least));
    let bottom = second.iter().fold(0.0, |most: f64, [_, y]| y.max(most));
    assert!(second.len() >= 41, "{}", second.len());
    for [x, y] in &second {
        let (s, t) = ((x - left) / 330.0 * 41.0, (bottom - y) / 250.0 * 1.7 * 41.0);
        assert!((s - t).abs() < 2.5, "at the place {s} after {t} ms");
    }

    let snapshots = figure(&run, "traction.svg");
    for text in [
        "before the largest event: t = 10.000000 s",
        "a third of its length slips",
        "two thirds",
        "end of the run",
        ">peak μ p<",
        "traction [N/mm²]",
    ] {
        assert!(snapshots.contains(text), "{text}");
    }
    assert!([&whole, &events, &snapshots].iter().all(|figure| figure.len() < 300_000));

    // One front that takes the whole run is in the map of the run, with its slopes, and nowhere else.
    let single = front_results(folder.path(), "single", &[]);
    write_map(&single, &slip_map(&[(0.0, 40.0)], false));
    assert_eq!(plot(&[&single], &single).status.code(), Some(0));
    assert!(figure(&single, "slip_rate.svg").contains(">c_p<") && !single.join("events.svg").exists());

    // Nothing slips; and damage, which is named.
    let rest = front_results(folder.path(), "rest", &[]);
    assert_eq!(plot(&[&rest], &rest).status.code(), Some(0));
    figure(&rest, "slip_rate.svg");
    figure(&rest, "traction.svg");
    assert!(!rest.join("events.svg").exists());
    let chunk = run.join("interface.zarr/base.q/0.0");
    let bytes = fs::read(&chunk).unwrap();
    fs::write(&chunk, &bytes[..bytes.len() - 300]).unwrap();
    refused(&[&run], &["interface.zarr/base.q/0.0: is damaged"]);
    fs::remove_file(&chunk).unwrap();
    refused(&[&run], &["interface.zarr/base.q/0.0: cannot be read"]);
    fs::write(run.join("interface.zarr/.zmetadata"), "{").unwrap();
    refused(&[&run], &["interface.zarr/.zmetadata: EOF"]);
    fs::write(run.join("interface.zarr/.zmetadata"), "{\"metadata\": {}}").unwrap();
    refused(&[&run], &["does not name its `contacts`"]);
}
