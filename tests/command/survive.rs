//! Runs that survive: taken up again to the same bytes after whatever ended them, and folders in which nothing of a user's is
//! lost.

mod folders;
mod resumed;
mod signals;
mod stores;

use folders::shell;
use resumed::interrupted;
use signals::{listening, signal};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant, SystemTime};

use crate::common::{Blocks, half_way, quadratic, store};
use fecontact::output::checkpoint;
use fecontact::output::files::Lock;
use fecontact::output::store::read;
use serde_json::{Value, json};
use tempfile::TempDir;

const PROGRAM: &str = env!("CARGO_BIN_EXE_fecontact_tested");

/// Wall time between checkpoints so short that there is one at every increment [min].
const ALWAYS: f64 = 1e-9;

/// A block pressed on ground and dragged, with everything a run can write.
pub(super) fn dragged(scheme: Value, increments: usize) -> Value {
    let mesh = Blocks::default().rectangle("ground", [10, 3], [0.0, -0.5], [3.0, 0.0]).rectangle(
        "block",
        [5, 3],
        [0.4, 0.01],
        [1.4, 0.51],
    );
    let material = json!({"model": "neo_hookean", "E": 100, "nu": 0.3, "density": 1e-4});
    json!({
        "title": "A block is dragged",
        "mesh": mesh.json(),
        "bodies": {"ground": {"material": material}, "block": {"material": material}},
        "contacts": {"base": {"slave": "block_bottom", "master": "ground_top", "friction": {
            "law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "alpha_t": 2e3, "r": 100, "kappa": 10, "xi": 0.002}}},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.25, "min": 1e-4}, "supports": [
                {"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0, "uy": -0.02}]},
            {"name": "drag", "duration": 4, "scheme": scheme, "dt": {"initial": 4.0 / increments as f64, "min": 1e-5},
                "supports": [{"on": "block_top", "ux": {"rate": 0.1}}]},
        ],
        "watch": ["block_top"],
        "output": {"checkpoint": ALWAYS, "fronts": {"slip_rate": 1e-2}, "every": 3},
    })
}

fn written(folder: &Path, case: &Value) -> PathBuf {
    let path = folder.join("case.json");
    fs::write(&path, case.to_string()).expect("a file");
    path
}

fn command(folder: &Path, out: &str, more: &[&str]) -> Command {
    let mut command = Command::new(PROGRAM);
    command.current_dir(folder).args(["run", "case.json", "--threads", "1", "--quiet", "--out", out]).args(more);
    command
}

fn run(folder: &Path, out: &str, more: &[&str]) -> Output {
    command(folder, out, more).output().expect("the program runs")
}

#[track_caller]
fn done(output: &Output) {
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
}

/// What was told by a command that ended with this exit code.
#[track_caller]
fn told(output: &Output, code: i32) -> String {
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{told}");
    told
}

/// All results but those that tell of wall time, and the checkpoints themselves.
fn results(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    fn collect(root: &Path, folder: &Path, found: &mut BTreeMap<PathBuf, Vec<u8>>) {
        for path in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
            let name = path.file_name().expect("a name").to_string_lossy().into_owned();
            if path.is_dir() {
                collect(root, &path, found);
            } else if !(["summary.json", "report.html", "run.log"].contains(&&*name) || name.starts_with("checkpoint"))
            {
                found.insert(path.strip_prefix(root).expect("below").to_owned(), fs::read(&path).expect("a file"));
            }
        }
    }
    let mut found = BTreeMap::new();
    collect(folder, folder, &mut found);
    found
}

/// The summary without what the clock says, and without when checkpoints were asked for.
fn summary(folder: &Path) -> Value {
    let text = fs::read_to_string(folder.join("summary.json")).expect("a summary");
    let mut summary: Value = serde_json::from_str(&text).expect("JSON");
    for key in ["wall_s", "peak_memory_mib"] {
        summary.as_object_mut().expect("an object").remove(key);
    }
    if let Some(output) = summary.pointer_mut("/given/output").and_then(Value::as_object_mut) {
        output.remove("checkpoint");
    }
    // A run that wrote one checkpoint only has none before it.
    let files = summary["files"].as_array_mut().expect("a list");
    files.retain(|file| file != "checkpoint_prev.bin");
    summary
}

#[track_caller]
fn same(one: &Path, other: &Path) {
    let (a, b) = (results(one), results(other));
    assert!(a.keys().eq(b.keys()), "{:?} and {:?}", a.keys(), b.keys());
    let differs: Vec<&PathBuf> = a.keys().filter(|file| a[*file] != b[*file]).collect();
    assert!(differs.is_empty(), "these have other bytes: {differs:?}");
    assert_eq!(summary(one), summary(other));
}

/// Rows of a history so far.
fn rows(folder: &Path) -> usize {
    fs::read_to_string(folder.join("history.csv")).map_or(0, |text| text.lines().count())
}

/// Wait until a run has come so far, or has ended.
fn wait_for_rows(child: &mut Child, folder: &Path, count: usize) {
    let start = Instant::now();
    while rows(folder) < count && child.try_wait().expect("a child").is_none() {
        assert!(start.elapsed() < Duration::from_secs(120), "the run does not get on");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// A number from 0 to 1 that looks random.
fn chance(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 53) as f64
}

/// Kill −9 at random moments and go on, until so many kills, and until one has left records of the interfaces (on a machine on
/// which the run is slow to begin the first few may not); what is there at the end has the bytes of a run in one go.
fn killed(case: &Value, kills: usize, seed: &mut u64) {
    let folder = TempDir::new().expect("a folder");
    written(folder.path(), case);
    let clock = Instant::now();
    done(&run(folder.path(), "straight", &[]));
    let whole = clock.elapsed();
    let [straight, out] = ["straight", "killed"].map(|name| folder.path().join(name));
    let (mut killed, mut resumed, mut stored) = (0, 0, 0);
    while killed < kills || (stored == 0 && killed < 20 * kills) {
        let resume = ["checkpoint.bin", "checkpoint_prev.bin"].iter().any(|name| out.join(name).exists());
        let mut child =
            command(folder.path(), "killed", if resume { &["--resume"] } else { &[] }).spawn().expect("it runs");
        resumed += usize::from(resume);
        std::thread::sleep(whole.mul_f64(0.4 * chance(seed)));
        match child.try_wait().expect("a child") {
            Some(status) => {
                assert_eq!(status.code(), Some(0));
                same(&straight, &out);
                fs::remove_dir_all(&out).expect("it can go");
            }
            None => {
                child.kill().expect("it is killed");
                child.wait().expect("it ends");
                killed += 1;
                stored += whole_records(&straight, &out);
            }
        }
    }
    let resume = ["checkpoint.bin", "checkpoint_prev.bin"].iter().any(|name| out.join(name).exists());
    done(&run(folder.path(), "killed", if resume { &["--resume"] } else { &[] }));
    same(&straight, &out);
    assert!(stored > 0, "a killed run leaves records of its interfaces");
    println!("{killed} kills, {resumed} times taken up, {stored} records left in all");
}

/// What a killed run has left of its store opens, by all the ways there are, and is the beginning of that of a whole run; how
/// many records there are.
fn whole_records(straight: &Path, out: &Path) -> usize {
    let [whole, part] = [straight, out].map(|folder| folder.join("interface.zarr"));
    if !part.join(".zmetadata").exists() {
        return 0;
    }
    let text = fs::read_to_string(part.join(".zmetadata")).expect("a file");
    let metadata: Value = serde_json::from_str(&text).expect("the old one or the new one");
    let records = store::consolidated(&part, "time").0[0];
    for key in metadata["metadata"].as_object().expect("an object").keys() {
        let Some(name) = key.strip_suffix("/.zarray") else { continue };
        let [(shape, values), (_, all)] = [&part, &whole].map(|store| store::consolidated(store, name));
        assert!(shape[0] == records || shape.len() == 1, "{name} has {shape:?} where there are {records} records");
        let same = values.iter().zip(&all).all(|(a, b)| a.to_bits() == b.to_bits());
        assert!(values.len() <= all.len() && same, "{name}: {} values are not the beginning", values.len());
    }
    assert_eq!(read::contacts(out, |_| true).expect("it can be read")[0].times.len(), records);
    records
}

/// An explicit run, and one that breaks and heals by turns.
fn explicit() -> Value {
    let mut case = dragged(json!({"explicit": {}}), 4);
    case["steps"][1]["duration"] = json!(0.03);
    case["output"]["interval"] = json!(1e-3);
    case
}

pub fn ruptures() -> Value {
    let mut case = dragged(json!("static"), 4);
    case["contacts"]["base"]["friction"] = json!({"law": "slip_weakening", "mu_s": 0.6, "mu_d": 0.1, "D_c": 1e-4});
    case["steps"][1]["rupture"] = json!({"slip_rate": 0.5});
    case["steps"][1]["dt"] = json!({"initial": 0.02, "min": 1e-3});
    case["steps"][1]["duration"] = json!(0.03);
    case["steps"][1]["supports"][0]["ux"] = json!({"rate": 1.0});
    case
}

fn augmented() -> Value {
    let mut case = dragged(json!({"hht": {"alpha": -0.05}}), 40);
    case["contacts"]["base"]["normal"] = json!({"penetration": 1e-6});
    case
}

/// With derivatives, whose neighbours go on as well, and which frames show.
fn differentiated() -> Value {
    let mut case = dragged(json!("static"), 40);
    case["gradients"] = json!(["contacts.base.friction.mu_k", "steps.drag.supports[0].ux.rate"]);
    case["output"]["displacement_gradients"] = json!(true);
    case
}

fn mortar() -> Value {
    let mut case = dragged(json!({"newmark": {}}), 60);
    case["contacts"]["base"]["method"] = json!("mortar");
    case
}

#[test]
fn runs_killed_at_random_moments_go_on_to_the_same_bytes() {
    let mut seed = 1;
    for case in [dragged(json!("static"), 40), explicit(), ruptures(), differentiated()] {
        killed(&case, 4, &mut seed);
    }
}

/// `cargo test --release --test command -- --ignored a_hundred_kills --nocapture`
#[test]
#[ignore = "minutes"]
fn a_hundred_kills_over_five_cases_leave_no_trace() {
    let mut seed = 2;
    for case in [dragged(json!("static"), 40), explicit(), ruptures(), augmented(), mortar()] {
        killed(&case, 20, &mut seed);
    }
}

/// Once there is a checkpoint before the newest there always is one: whenever the run is killed, two are left.
#[test]
fn there_are_two_checkpoints_at_any_moment() {
    let folder = TempDir::new().expect("a folder");
    written(folder.path(), &dragged(json!("static"), 250));
    let out = folder.path().join("out");
    let mut child = command(folder.path(), "out", &[]).spawn().expect("it runs");
    let two = || ["checkpoint.bin", "checkpoint_prev.bin"].iter().all(|name| out.join(name).exists());
    wait_for_rows(&mut child, &out, 12);
    while child.try_wait().expect("a child").is_none() {
        assert!((0..1000).all(|_| two()), "a checkpoint is gone while the next is put into its place");
    }
}

/// With checkpoints at every increment, without any, and on two threads: the same bytes.
#[test]
fn a_checkpoint_changes_nothing() {
    for mut case in [dragged(json!({"newmark": {}}), 20), ruptures()] {
        let folder = TempDir::new().expect("a folder");
        written(folder.path(), &case);
        done(&run(folder.path(), "with", &[]));
        case["output"]["checkpoint"] = Value::Null;
        written(folder.path(), &case);
        done(&run(folder.path(), "without", &[]));
        let [with, without] = ["with", "without"].map(|name| folder.path().join(name));
        assert!(results(&with) == results(&without));
        assert!(with.join("checkpoint_prev.bin").exists() && !without.join("checkpoint.bin").exists());
        let told = told(&run(folder.path(), "without", &["--resume"]), 2);
        assert!(told.contains("there is no checkpoint, and the run in the folder has completed"), "{told}");
    }
}

/// Columns of a history whose names begin so, but for heat, which is counted from the start of a run as energies are.
fn columns(path: &Path, start: &str) -> Vec<Vec<String>> {
    let text = fs::read_to_string(path).expect("a table");
    let header: Vec<&str> = text.lines().next().expect("a header").split(',').collect();
    let wanted = (0..header.len()).filter(|k| header[*k].starts_with(start) || header[*k] == "time");
    let wanted: Vec<usize> = wanted.filter(|k| !header[*k].ends_with(".frictional_heat")).collect();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        wanted.iter().map(|k| cells[*k].to_string()).collect()
    };
    text.lines().skip(1).map(row).collect()
}

/// A case that begins where another has ended is what that one would have been with more steps; with other friction it is a
/// variant; of another model it is none.
#[test]
fn a_case_begins_where_another_has_ended() {
    let folder = TempDir::new().expect("a folder");
    let mut whole = dragged(json!({"newmark": {}}), 12);
    let first = |whole: &Value| {
        let mut pressed = whole.clone();
        pressed["steps"].as_array_mut().expect("steps").pop();
        pressed
    };
    // The penalty that is left open is another one where a step has inertia.
    written(folder.path(), &first(&whole));
    done(&run(folder.path(), "open", &[]));
    let mut open = whole.clone();
    open["steps"].as_array_mut().expect("steps").remove(0);
    open["begin_with"] = json!("open");
    written(folder.path(), &open);
    let text = told(&run(folder.path(), "refused", &[]), 2);
    assert!(text.contains("contacts.base.normal.alpha_n: is not given") && text.contains("has inertia"), "{text}");

    whole["contacts"]["base"]["normal"] = json!({"alpha_n": 1e4});
    let pressed = first(&whole);
    written(folder.path(), &pressed);
    done(&run(folder.path(), "pressed", &[]));
    written(folder.path(), &whole);
    done(&run(folder.path(), "straight", &[]));

    let mut drags = whole.clone();
    drags["steps"].as_array_mut().expect("steps").remove(0);
    // The method that is left open is another one where a step is explicit, as nodes do not face nodes.
    let mut explicit = drags.clone();
    explicit["begin_with"] = json!("pressed");
    explicit["steps"][0]["scheme"] = json!({"explicit": {"safety": 0.9}});
    written(folder.path(), &explicit);
    let text = told(&run(folder.path(), "refused", &[]), 2);
    assert!(text.contains("contacts.base.method: is not given") && text.contains("explicit"), "{text}");
    for source in ["pressed", "pressed/checkpoint.bin"] {
        drags["begin_with"] = json!(source);
        written(folder.path(), &drags);
        done(&run(folder.path(), "drags", &[]));
        let [straight, drags] = ["straight", "drags"].map(|name| folder.path().join(name).join("history.csv"));
        for start in ["base.", "block_top."] {
            let (all, part) = (columns(&straight, start), columns(&drags, start));
            assert!(part.len() >= 12 && all.ends_with(&part), "{start}: {} and {} rows", all.len(), part.len());
        }
        // The audit begins anew: all that was stored is there at the start, and nothing is lost by the way it is counted.
        let error: Vec<f64> =
            columns(&drags, "energy_error").iter().map(|row| row[1].parse().expect("a number")).collect();
        let work: f64 = columns(&drags, "external_work").last().expect("a row")[1].parse().expect("a number");
        assert!(error.iter().all(|error| error.abs() < 0.05 * work.abs()), "{error:?} of {work}");
    }
    // Killed and taken up again, it has no need of what it began with.
    fs::rename(folder.path().join("pressed"), folder.path().join("moved")).expect("it is moved");
    done(&run(folder.path(), "drags", &["--resume"]));
    fs::rename(folder.path().join("moved"), folder.path().join("pressed")).expect("it is moved");

    let slide = |case: &Value| {
        written(folder.path(), case);
        done(&run(folder.path(), "variant", &[]));
        let rows = columns(&folder.path().join("variant/history.csv"), "base.tangential_force");
        rows.last().expect("a row")[1].parse::<f64>().expect("a number")
    };
    drags["steps"][0]["scheme"] = json!("static");
    let usual = slide(&drags);
    drags["contacts"]["base"]["friction"]["mu_k"] = json!(0.3);
    drags["contacts"]["base"]["friction"]["kappa"] = json!(1000);
    assert!(slide(&drags) > 1.1 * usual, "friction is higher");
    for (pointer, value, expected) in [
        ("/bodies/block/material/E", json!(200), "`bodies.block.material.E` is now 200 and was 100"),
        ("/contacts/base/friction/mu_s", json!(0.35), "a point carries over mu = 0.38"),
        ("/steps/0/dt/initial", json!(-1), "steps[0].dt.initial"),
        ("/begin_with", json!("nowhere"), "begin_with: "),
    ] {
        let mut other = drags.clone();
        *other.pointer_mut(pointer).expect("it is there") = value;
        written(folder.path(), &other);
        let told = told(&run(folder.path(), "none", &[]), 2);
        assert!(told.contains(expected), "{told}");
    }
    // Where a run is not over nothing begins.
    let unfinished = interrupted(&dragged(json!("static"), 2000));
    drags["begin_with"] = json!(unfinished.path().join("out"));
    written(folder.path(), &drags);
    assert!(told(&run(folder.path(), "none", &[]), 2).contains("the run is not complete"));
}

/// Mortar has other tractions on quadratic edges where a step is explicit: with steps of the other kind alone no run goes on, and says why.
#[test]
fn tractions_of_quadratic_edges_go_by_the_schemes_of_a_case() {
    let folder = TempDir::new().expect("a folder");
    let mut whole = dragged(json!("static"), 2);
    whole["mesh"] = quadratic(&whole["mesh"], half_way);
    whole["contacts"]["base"]["normal"] = json!({"alpha_n": 1e4});
    whole["contacts"]["base"]["method"] = json!("mortar");
    let mut drags = whole.clone();
    let steps = whole["steps"].as_array_mut().expect("steps");
    drags["steps"] = json!([steps.pop().expect("a step")]);
    drags["begin_with"] = json!("pressed");
    written(folder.path(), &whole);
    done(&run(folder.path(), "pressed", &[]));
    written(folder.path(), &drags);
    done(&run(folder.path(), "static", &[]));
    drags["steps"][0]["scheme"] = json!({"explicit": {}});
    written(folder.path(), &drags);
    let text = told(&run(folder.path(), "refused", &[]), 2);
    let expected = [
        "contacts.base.method: is mortar",
        "one traction on a quadratic edge of `block_bottom`",
        "Write all steps into one case",
    ];
    assert!(expected.iter().all(|part| text.contains(part)), "{text}");
}

/// A body that a later step adds is absent from the start: a run in which it was there cannot go on as that case.
#[test]
fn later_steps_do_not_change_who_was_there() {
    let block = |body: &str, low: f64, sides: [Option<&str>; 4]| json!({"body": body, "corners": [[0, low], [2, low], [2, low + 1.0], [0, low + 1.0]], "elements": [2, 1], "sides": sides});
    let body = json!({"material": {"model": "linear", "E": 1000, "nu": 0.3, "density": 1}});
    let rest = json!({"name": "rest", "duration": 1, "dt": {"initial": 0.5}, "supports": [{"on": "bottom", "ux": 0, "uy": 0}]});
    let changing = |name: &str, key: &str| json!({"name": name, "duration": 1, key: ["fill"]});
    let case = |steps: Value| {
        json!({
            "mesh": {"joined": [["ground", "fill"]],
                "blocks": [block("ground", -1.0, [Some("bottom"), None, None, None]), block("fill", 0.0, [None; 4])]},
            "bodies": {"ground": body, "fill": body}, "steps": steps,
            "output": {"fields": false, "report": false},
        })
    };
    let folder = TempDir::new().expect("a folder");
    let start = |case: &Value, out: &str, more: &[&str]| {
        written(folder.path(), case);
        run(folder.path(), out, more)
    };
    done(&start(&case(json!([rest])), "there", &[]));
    let there = "`fill` is present from the start of the run so far";
    let added = case(json!([rest, changing("build", "add")]));
    let refusal = told(&start(&added, "there", &["--resume"]), 2);
    assert!(refusal.contains("steps[1].add[0]") && refusal.contains(there), "{refusal}");
    let mut begins = case(json!([changing("build", "add")]));
    begins["begin_with"] = json!("there");
    let refusal = told(&start(&begins, "begun", &[]), 2);
    assert!(refusal.contains("steps[0].add[0]") && refusal.contains(there), "{refusal}");
    assert!(!folder.path().join("begun").exists(), "nothing is written");
    // Removed in between it may come again.
    let both = json!([rest, changing("dig", "remove"), changing("build", "add")]);
    done(&start(&case(both.clone()), "there", &["--resume"]));
    done(&start(&case(both), "whole", &[]));
    let [resumed, whole] =
        ["there", "whole"].map(|out| fs::read(folder.path().join(out).join("history.csv")).expect("a table"));
    assert!(resumed == whole, "in one go or resumed");
}

/// The number of threads is checked wherever it comes from, and threads that cannot be had are told.
#[cfg(unix)]
#[test]
fn threads_that_cannot_be_had_are_told() {
    let folder = TempDir::new().expect("a folder");
    written(folder.path(), &dragged(json!("static"), 4));
    let many = shell(folder.path(), "RAYON_NUM_THREADS=100000 PROGRAM check case.json");
    assert!(told(&many, 2).contains("RAYON_NUM_THREADS 100000: give 1 to 1024"), "{many:?}");
    for text in ["RAYON_NUM_THREADS=two", "RAYON_NUM_THREADS=0", "RAYON_NUM_THREADS="] {
        done(&shell(folder.path(), &format!("{text} PROGRAM check case.json")));
    }
    let cramped = shell(folder.path(), "ulimit -v 400000; RAYON_NUM_THREADS=1024 PROGRAM check case.json");
    assert!(told(&cramped, 2).contains("RAYON_NUM_THREADS 1024: they need "), "{cramped:?}");
    assert!(told(&cramped, 2).contains(" MiB; give fewer"), "{cramped:?}");
    // Those that fit, and as many as fit where nobody asked for more.
    for asked in ["RAYON_NUM_THREADS=3", ""] {
        done(&shell(folder.path(), &format!("ulimit -v 400000; {asked} PROGRAM check case.json")));
    }
    // A user other than root has no more processes than this one.
    done(&shell(folder.path(), "ulimit -u 1; exec PROGRAM check case.json"));
}

/// A panic is told as what it is, with another exit code than anything else.
#[test]
fn a_panic_is_an_internal_error() {
    use fecontact::cli::{Failure, internal_error};
    let caught = internal_error::catch(|| -> () { panic!("index {} is too large", 7) }).unwrap_err();
    assert_eq!(caught, "index 7 is too large");
    let (code, told) = Failure::Internal(caught).code_and_message();
    assert_eq!(code, 70);
    assert!(told.starts_with("internal error: index 7 is too large\nThis is an error of fecontact"), "{told}");
    assert_eq!(internal_error::catch(|| 3), Ok(3));
}

/// Nothing of a bad case is left behind.
#[test]
fn a_refused_command_leaves_no_folder() {
    let folder = TempDir::new().expect("a folder");
    let mut case = dragged(json!("static"), 4);
    case["output"]["checkpoint"] = json!(-1);
    written(folder.path(), &case);
    assert!(told(&run(folder.path(), "out", &[]), 2).contains("output.checkpoint: is -1"));
    assert!(told(&run(folder.path(), "out", &["--resume"]), 2).contains("output.checkpoint: is -1"));
    assert!(!folder.path().join("out").exists());
}

/// Equilibrium is lost on the way: the state before is kept, and going on from it stops again with the same bytes.
#[test]
fn a_run_that_stops_keeps_its_last_state() {
    let mut case = dragged(json!("static"), 20);
    // The block is crushed between its top and the ground.
    case["steps"][1]["supports"][0]["uy"] = json!({"rate": -0.3});
    case["steps"][1]["dt"]["min"] = json!(0.05);
    case["output"]["checkpoint"] = json!(1000);
    let folder = TempDir::new().expect("a folder");
    written(folder.path(), &case);
    let [straight, out] = ["straight", "out"].map(|name| folder.path().join(name));
    // Warnings come before; the last line says why it stopped.
    let last = |more: &[&str], out: &str| {
        let told = told(&run(folder.path(), out, more), 1);
        told.lines().last().unwrap_or_default().to_owned()
    };
    let why = last(&[], "straight");
    assert!(why.starts_with("stopped: step `drag` stopped at time "), "{why}");
    assert!(rows(&straight) > 5, "it stops too early to be of use: {why}");
    told(&run(folder.path(), "out", &[]), 1);
    assert!(out.join("checkpoint.bin").exists());
    assert_eq!(last(&["--resume"], "out"), why);
    same(&straight, &out);
}

/// Explicit increments end at a signal, however far the next output is, and go on to the same bytes.
#[cfg(unix)]
#[test]
fn explicit_increments_pause_for_a_signal_and_for_a_checkpoint() {
    let mut case = explicit();
    // One output at the end of everything.
    let duration = 2.0;
    case["steps"][1]["duration"] = json!(duration);
    case["output"] = json!({"checkpoint": 1000, "interval": duration, "fronts": {"slip_rate": 1e-2}});
    let folder = TempDir::new().expect("a folder");
    written(folder.path(), &case);
    let clock = Instant::now();
    done(&run(folder.path(), "straight", &[]));
    let mut wait = clock.elapsed() / 2;
    let [straight, out] = ["straight", "out"].map(|name| folder.path().join(name));
    // The increments of the press have rows, those of the drag under way have none. A run that was over before, or had not come
    // so far, is tried again.
    let between = (0..40).any(|_| {
        let _ = fs::remove_dir_all(&out);
        let mut child = listening(folder.path(), "out", &[]);
        while !out.join("history.csv").exists() && child.try_wait().expect("a child").is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(wait);
        signal(&child, "TERM");
        let output = child.wait_with_output().expect("it ends");
        let (mut between, mut early) = (false, true);
        match output.status.code() {
            // Before the program listens a signal kills it.
            None => {}
            Some(0) => early = false,
            Some(_) => {
                assert!(told(&output, 1).ends_with("stopped: interrupted\n"), "{output:?}");
                between = rows(&out) == rows(&straight) - 1;
                done(&run(folder.path(), "out", &["--resume"]));
                same(&straight, &out);
            }
        }
        wait = wait.mul_f64(if early { 1.4 } else { 0.7 });
        between
    });
    assert!(between, "no signal came between the outputs");
    // A checkpoint after every increment, between the outputs as well, changes nothing.
    case["output"]["checkpoint"] = json!(ALWAYS);
    case["steps"][1]["duration"] = json!(0.01 * duration);
    case["output"]["interval"] = json!(0.01 * duration);
    written(folder.path(), &case);
    done(&run(folder.path(), "always", &[]));
    case["output"]["checkpoint"] = json!(1000);
    written(folder.path(), &case);
    done(&run(folder.path(), "never", &[]));
    same(&folder.path().join("never"), &folder.path().join("always"));
}

/// What does not fit into memory is told with its size, before it is taken: the address space ends a little above what the
/// model itself needs.
#[cfg(target_os = "linux")]
#[test]
fn factors_that_do_not_fit_are_told_with_their_size() {
    let mesh = Blocks::default().rectangle("plate", [160, 160], [0.0, 0.0], [1.0, 1.0]);
    let case = json!({
        "mesh": mesh.json(),
        "bodies": {"plate": {"material": {"model": "neo_hookean", "E": 100, "nu": 0.3}}},
        "steps": [{"name": "pull", "duration": 1, "dt": {"initial": 1}, "supports": [
            {"on": "plate_bottom", "ux": 0, "uy": 0}, {"on": "plate_top", "uy": 0.01}]}],
        "output": {"fields": false},
    });
    let folder = TempDir::new().expect("a folder");
    written(folder.path(), &case);
    // Smaller and smaller, until the factors are the first that does not fit.
    let refused = [224, 192, 160, 128, 96].map(|mib| {
        let text = format!("ulimit -v {}; PROGRAM run case.json --threads 1 --quiet --out out", 1024 * mib);
        move |folder: &Path| shell(folder, &text)
    });
    let first = refused.into_iter().map(|run| run(folder.path())).find(|output| output.status.code() != Some(0));
    let first = first.expect("some limit is too low");
    let told = told(&first, 1);
    assert!(
        told.contains("the factors of 51842 equations need 0.") && told.contains(" GiB of memory are free"),
        "{told}"
    );
    let summary = summary(&folder.path().join("out"));
    assert_eq!(summary["status"], "stopped");
}
