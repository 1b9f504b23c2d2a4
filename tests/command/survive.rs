//! Runs that survive: taken up again to the same bytes after whatever ended them, and folders in which nothing of a user's is
//! lost.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant, SystemTime};

use crate::common::{Blocks, store};
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

/// Number of the folder's records as `.zmetadata` and every `.zarray` count them: all alike.
fn counted(store: &Path) -> usize {
    let (shape, time) = store::array(store, "time");
    assert_eq!(store::array(store, "base.slip").0[0], shape[0]);
    assert!(time.iter().all(|time| time.is_finite()), "{time:?}: what is counted is gone");
    shape[0]
}

/// Records that are taken back are no longer counted once they begin to go: whenever the run that goes on is killed, its store
/// opens. A folder stands in the place of a chunk, so that it ends while it takes them back.
#[test]
fn a_store_never_counts_records_that_were_taken_back() {
    let folder = TempDir::new().expect("a folder");
    written(folder.path(), &dragged(json!("static"), 8));
    done(&run(folder.path(), "out", &[]));
    let out = folder.path().join("out");
    let store = out.join("interface.zarr");
    let all = counted(&store);
    // The run goes on from the checkpoint before the last one.
    fs::remove_file(out.join("checkpoint.bin")).expect("it was there");
    let chunk = store.join("base.structure/0.0");
    fs::rename(&chunk, folder.path().join("aside")).expect("it is moved");
    fs::create_dir(&chunk).expect("a folder");
    let told = told(&run(folder.path(), "out", &["--resume"]), 2);
    assert!(told.contains("base.structure/0.0"), "{told}");
    assert!(counted(&store) < all);
    fs::remove_dir(&chunk).expect("it is empty");
    fs::rename(folder.path().join("aside"), &chunk).expect("it is moved");
    done(&run(folder.path(), "out", &["--resume"]));
    assert_eq!(counted(&store), all);
}

/// The store of an earlier run is taken away beginning with what counts its records: whenever that ends, no reader finds records
/// that are gone. A folder stands in the place of a chunk, so that it ends on the way.
#[test]
fn a_store_that_is_taken_away_counts_nothing() {
    let folder = TempDir::new().expect("a folder");
    written(folder.path(), &dragged(json!("static"), 4));
    done(&run(folder.path(), "out", &[]));
    let store = folder.path().join("out/interface.zarr");
    for name in ["time", "base.x", "base.slip", "base.structure"] {
        fs::create_dir(store.join(name).join("9")).expect("a folder");
    }
    assert!(told(&run(folder.path(), "out", &[]), 2).contains("/9: "));
    let descriptions = [".zmetadata", "time/.zarray", "base.slip/.zarray"];
    assert!(descriptions.iter().all(|name| !store.join(name).exists()));
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

fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args([format!("-{name}"), child.id().to_string()]).status().expect("kill");
    assert!(sent.success());
}

/// A run that hears signals: whoever runs the tests may ignore them, as `nohup` does.
fn listening(folder: &Path, out: &str, more: &[&str]) -> Child {
    let given = command(folder, out, more);
    let mut listening = Command::new("env");
    listening.arg("--default-signal").arg(PROGRAM).args(given.get_args()).current_dir(folder);
    listening.stderr(Stdio::piped()).spawn().expect("it runs")
}

/// Signals at random moments of a run, so many, each followed by going on: a run that a signal ends says so, whatever it was
/// doing, and what is there at the end has the bytes of a run in one go.
fn signalled(case: &Value, signals: usize, seed: &mut u64) {
    let folder = TempDir::new().expect("a folder");
    written(folder.path(), case);
    let clock = Instant::now();
    done(&run(folder.path(), "straight", &[]));
    let whole = clock.elapsed();
    let [straight, out] = ["straight", "out"].map(|name| folder.path().join(name));
    let mut sent = 0;
    while sent < signals {
        let resume: &[&str] = if out.join("checkpoint.bin").exists() { &["--resume"] } else { &[] };
        let mut child = listening(folder.path(), "out", resume);
        // Before it holds its folder it has not begun.
        while !out.join("fecontact.lock").exists() && child.try_wait().expect("a child").is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(whole.mul_f64(0.4 * chance(seed)));
        if child.try_wait().expect("a child").is_none() {
            signal(&child, ["INT", "TERM", "HUP"][sent % 3]);
        }
        let output = child.wait_with_output().expect("it ends");
        match output.status.code() {
            Some(0) => {
                same(&straight, &out);
                fs::remove_dir_all(&out).expect("it can go");
            }
            _ => {
                assert!(told(&output, 1).ends_with("stopped: interrupted\n"), "{output:?}");
                assert_eq!(summary(&out)["status"], "interrupted");
                sent += 1;
            }
        }
    }
    done(&run(folder.path(), "out", &["--resume"]));
    same(&straight, &out);
}

/// `cargo test --release --test command -- --ignored fifty_signals`
#[cfg(unix)]
#[test]
#[ignore = "a minute"]
fn fifty_signals_over_five_cases_leave_no_trace() {
    let mut seed = 7;
    for case in [dragged(json!("static"), 40), explicit(), ruptures(), augmented(), mortar()] {
        signalled(&case, 10, &mut seed);
    }
}

#[cfg(unix)]
#[test]
fn a_signal_ends_a_run_with_its_results_whole() {
    let folder = TempDir::new().expect("a folder");
    written(folder.path(), &dragged(json!("static"), 100));
    done(&run(folder.path(), "straight", &[]));
    for (k, name) in ["INT", "TERM", "HUP"].into_iter().enumerate() {
        let out = folder.path().join(name);
        let mut child = listening(folder.path(), name, &[]);
        wait_for_rows(&mut child, &out, 10 + 20 * k);
        assert_eq!(summary(&out)["status"], "running");
        signal(&child, name);
        let output = child.wait_with_output().expect("it ends");
        assert!(told(&output, 1).ends_with("stopped: interrupted\n"), "{output:?}");
        let summary = summary(&out);
        assert_eq!((&summary["status"], &summary["reason"]), (&json!("interrupted"), &json!("interrupted")));
        assert_eq!(summary["increments"].as_u64(), Some(rows(&out) as u64 - 1));
        assert!(out.join("fronts.csv").exists() && !out.join("fecontact.lock").exists());
        assert!(rows(&out) < rows(&folder.path().join("straight")));
        done(&run(folder.path(), name, &["--resume"]));
        same(&folder.path().join("straight"), &out);
    }
}

/// Who starts a program with `nohup` wants it to outlive his terminal.
#[cfg(unix)]
#[test]
fn a_signal_that_is_ignored_stays_so() {
    let folder = TempDir::new().expect("a folder");
    written(folder.path(), &dragged(json!("static"), 150));
    let text = format!("trap '' HUP; exec {PROGRAM} run case.json --quiet --out out");
    let mut child = Command::new("sh").args(["-c", &text]).current_dir(folder.path()).spawn().expect("it runs");
    wait_for_rows(&mut child, &folder.path().join("out"), 5);
    signal(&child, "HUP");
    assert_eq!(child.wait().expect("it ends").code(), Some(0));
}

fn shell(folder: &Path, text: &str) -> Output {
    let text = text.replace("PROGRAM", PROGRAM);
    Command::new("bash").args(["-c", &text]).current_dir(folder).output().expect("bash")
}

/// Nobody has to listen.
#[cfg(unix)]
#[test]
fn closed_and_full_outputs_end_no_run() {
    let folder = TempDir::new().expect("a folder");
    written(folder.path(), &dragged(json!("static"), 10));
    done(&run(folder.path(), "straight", &[]));
    for (name, redirection) in [("closed", "2>&-"), ("full", "2>/dev/full"), ("head", "2>&1 | head -1 >/dev/null")] {
        let text = format!("set -o pipefail; PROGRAM run case.json --threads 1 --out {name} {redirection}");
        done(&shell(folder.path(), &text));
        same(&folder.path().join("straight"), &folder.path().join(name));
    }
    let unprinted = ["schema", "check case.json", "--help"].map(|what| format!("PROGRAM {what} >/dev/full"));
    for text in unprinted {
        assert!(told(&shell(folder.path(), &text), 1).contains("could not be printed: No space left"), "{text}");
    }
    done(&shell(folder.path(), "set -o pipefail; PROGRAM schema | head -1"));
    assert_eq!(shell(folder.path(), "PROGRAM check nowhere.json 2>/dev/full").status.code(), Some(2));
}

/// Frames that a collection names, each of which must be there and whole.
fn named_frames(out: &Path, collection: &str) -> usize {
    let text = fs::read_to_string(out.join(collection)).expect("a collection");
    assert!(text.ends_with("</VTKFile>\n"), "{text}");
    let named = text.split("file=\"").skip(1).map(|rest| rest.split('"').next().expect("a name"));
    let whole = |name: &str| fs::read_to_string(out.join(name)).expect("a frame").ends_with("</VTKFile>\n");
    named.inspect(|name| assert!(whole(name), "{name}")).count()
}

/// The first file that cannot grow any more is told; what is there is readable, and the summary too.
#[cfg(unix)]
#[test]
fn a_full_disk_is_told_and_what_was_written_stays_readable() {
    let folder = TempDir::new().expect("a folder");
    let mut case = dragged(json!("static"), 400);
    case["output"]["checkpoint"] = json!(0);
    written(folder.path(), &case);
    // Nothing longer than 100 KiB: the history is the first to come so far.
    let output = shell(folder.path(), "ulimit -f 100; PROGRAM run case.json --quiet --out out");
    let told = told(&output, 1);
    assert!(told.contains("out/history.csv: File too large"), "{told}");
    let out = folder.path().join("out");
    let ending = summary(&out);
    assert_eq!(ending["status"], "stopped");
    assert!(ending["reason"].as_str().is_some_and(|reason| reason.contains("history.csv")), "{ending}");
    for table in ["history.csv", "newton.csv"] {
        let text = fs::read_to_string(out.join(table)).expect("a table");
        let cells = |line: &str| line.split(',').count();
        let width = cells(text.lines().next().expect("a header"));
        assert!(text.ends_with('\n') && text.lines().all(|line| cells(line) == width), "{table}");
    }
    assert!(named_frames(&out, "solid.pvd") > 1 && named_frames(&out, "contact.pvd") > 1);
    assert!(store::consolidated(&out.join("interface.zarr"), "base.slip").0[0] > 100, "the store is readable");
    // A checkpoint that does not fit is a warning, and the run goes on.
    case["output"] = json!({"checkpoint": ALWAYS, "fields": false, "report": false});
    case["steps"][1]["duration"] = json!(0.02);
    case["mesh"] = Blocks::default()
        .rectangle("ground", [60, 10], [0.0, -0.5], [3.0, 0.0])
        .rectangle("block", [5, 3], [0.4, 0.01], [1.4, 0.51])
        .json();
    written(folder.path(), &case);
    let output = shell(folder.path(), "ulimit -f 70; PROGRAM run case.json --out small");
    assert!(self::told(&output, 0).matches("no checkpoint at t = ").count() == 1, "{output:?}");
    let warnings = summary(&folder.path().join("small"))["warnings"].to_string();
    assert!(warnings.contains("checkpoint.bin") && warnings.contains("the run continues"), "{warnings}");
    assert!(!folder.path().join("small/checkpoint.bin.new").exists());
}

/// Files removed under a run end it, and the reason names them.
#[test]
fn a_folder_that_is_taken_away_is_told() {
    let folder = TempDir::new().expect("a folder");
    written(folder.path(), &dragged(json!("static"), 2000));
    for (name, gone) in [("frames", "frames/solid"), ("all", "all")] {
        let out = folder.path().join(name);
        let mut child = command(folder.path(), name, &[]).stderr(Stdio::piped()).spawn().expect("it runs");
        wait_for_rows(&mut child, &out, 20);
        // The run may put a file into a folder that is being emptied.
        while fs::remove_dir_all(folder.path().join(gone)).is_err() {}
        let output = child.wait_with_output().expect("it ends");
        assert!(told(&output, 1).contains(&format!("stopped: {gone}")), "{output:?}");
    }
}

/// Two runs never write into one folder: the second is told of the first.
#[test]
fn a_folder_has_one_run_at_a_time() {
    let folder = TempDir::new().expect("a folder");
    written(folder.path(), &dragged(json!("static"), 5));
    let out = folder.path().join("out");
    fs::create_dir(&out).expect("a folder");
    let lock = Lock::take(&out).expect("it is free");
    let told_of = format!("process {} on ", std::process::id());
    for more in [&[][..], &["--resume"]] {
        let told = told(&run(folder.path(), "out", more), 2);
        assert!(told.contains(&told_of) && told.contains("choose another --out"), "{told}");
    }
    assert_eq!(fs::read_dir(&out).expect("a folder").count(), 1, "only the lock is there");
    drop(lock);
    assert_eq!(fs::read_dir(&out).expect("a folder").count(), 0);
    done(&run(folder.path(), "out", &[]));
    // What a killed run of this computer leaves is no lock; one of another computer may be.
    let holder = |computer: &str| json!({"process": 1, "computer": computer, "since": 0}).to_string();
    let computer = fs::read_to_string("/proc/sys/kernel/hostname").expect("a name");
    fs::write(out.join("fecontact.lock"), holder(computer.trim())).expect("a file");
    done(&run(folder.path(), "out", &[]));
    fs::write(out.join("fecontact.lock"), holder("elsewhere")).expect("a file");
    let told = told(&run(folder.path(), "out", &[]), 2);
    assert!(told.contains("process 1 on elsewhere") && told.contains("remove fecontact.lock"), "{told}");
    // It counts as left behind ten minutes after its last beat, and not before.
    let silent = |seconds| {
        let lock = fs::File::options().write(true).open(out.join("fecontact.lock")).expect("it is there");
        lock.set_modified(SystemTime::now() - Duration::from_secs(seconds)).expect("a time");
    };
    silent(590);
    self::told(&run(folder.path(), "out", &[]), 2);
    silent(610);
    done(&run(folder.path(), "out", &[]));
}

/// A lock beats as long as it is held. A holder of another computer that was silent for too long and comes back finds another
/// lock in the place of its own, and takes it for its end.
#[test]
fn a_lock_beats_and_is_lost_to_another_when_it_does_not() {
    let folder = TempDir::new().expect("a folder");
    let path = folder.path().join("fecontact.lock");
    let lock = Lock::beating(folder.path(), Duration::from_millis(20)).expect("it is free");
    let old = SystemTime::now() - Duration::from_secs(3600);
    fs::File::options().write(true).open(&path).expect("the lock").set_modified(old).expect("a time");
    let start = Instant::now();
    while path.metadata().and_then(|known| known.modified()).expect("a time") == old {
        assert!(start.elapsed() < Duration::from_secs(60), "it does not beat");
        std::thread::sleep(Duration::from_millis(10));
    }
    drop(lock);
    assert!(!path.exists());

    let holder = json!({"process": 1, "computer": "elsewhere", "since": 0}).to_string();
    fs::write(&path, holder).expect("a file");
    let held = fs::File::options().write(true).open(&path).expect("as its holder has it");
    held.set_modified(old).expect("a time");
    let lock = Lock::take(folder.path()).expect("it was left behind");
    assert!(lock.is_there());
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let number = |file: fs::Metadata| file.ino();
        assert_ne!(number(held.metadata().expect("a file")), number(path.metadata().expect("a file")));
    }
}

/// A job that is queued again always says `--resume`: where nothing is to be resumed yet it begins anew, and says so.
#[test]
fn a_requeued_job_begins_anew_where_there_is_no_checkpoint_yet() {
    let folder = TempDir::new().expect("a folder");
    let mut case = dragged(json!("static"), 40);
    // No checkpoint comes before the end.
    case["output"]["checkpoint"] = json!(1000);
    written(folder.path(), &case);
    done(&run(folder.path(), "straight", &[]));
    let [straight, empty, killed] = ["straight", "empty", "killed"].map(|name| folder.path().join(name));
    let spoken = |out: &str| {
        let mut command = Command::new(PROGRAM);
        command.current_dir(folder.path()).args(["run", "case.json", "--threads", "1", "--resume", "--out", out]);
        told(&command.output().expect("the program runs"), 0)
    };
    // The folder is absent, or empty but for what a run leaves that was killed when it had hardly begun.
    assert!(spoken("absent").starts_with("absent: no checkpoint yet, the run begins anew\n"));
    fs::create_dir(&empty).expect("a folder");
    fs::write(empty.join("fecontact.lock"), "").expect("a file");
    fs::write(empty.join("summary.json.new"), "{").expect("a file");
    done(&run(folder.path(), "empty", &["--resume"]));
    // It holds this case's own run, killed before its first checkpoint. On a busy machine a run may end before it is killed: another is.
    let cut_short = || {
        let mut child = command(folder.path(), "killed", &[]).spawn().expect("it runs");
        wait_for_rows(&mut child, &killed, 3);
        child.kill().expect("it is killed");
        child.wait().expect("it ends");
        let is_cut_short = !killed.join("checkpoint.bin").exists() && summary(&killed)["status"] == "running";
        if !is_cut_short {
            fs::remove_dir_all(&killed).expect("it can go");
        }
        is_cut_short
    };
    assert!((0..100).any(|_| cut_short()), "a hundred runs have ended before they were killed");
    // Another case begins neither in its place nor in that of foreign files.
    let mut other = case.clone();
    other["contacts"]["base"]["friction"]["mu_s"] = json!(0.41);
    written(folder.path(), &other);
    let before = results(&killed);
    let told_of = |out: &str| told(&run(folder.path(), out, &["--resume"]), 2);
    assert!(told_of("killed").contains("the folder holds the run of another case"), "{}", told_of("killed"));
    assert!(results(&killed) == before);
    // What is written may change: here, when checkpoints are.
    case["output"]["checkpoint"] = json!(999);
    written(folder.path(), &case);
    assert!(spoken("killed").starts_with("killed: no checkpoint yet, the run begins anew\n"));
    assert!(results(&straight) == results(&killed));
    for out in [&folder.path().join("absent"), &empty] {
        same(&straight, out);
    }
    fs::create_dir(folder.path().join("foreign")).expect("a folder");
    fs::write(folder.path().join("foreign/notes.txt"), "mine").expect("a file");
    assert!(told_of("foreign").contains("no readable summary.json"), "{}", told_of("foreign"));
    assert_eq!(fs::read_dir(folder.path().join("foreign")).expect("a folder").count(), 1);
    // A damaged checkpoint is one.
    fs::remove_file(empty.join("checkpoint.bin")).expect("it was there");
    fs::write(empty.join("checkpoint_prev.bin"), "damaged").expect("a file");
    assert!(told_of("empty").contains("checkpoint.bin: --resume: there is none"), "{}", told_of("empty"));
}

/// Only what an earlier run wrote is replaced.
#[test]
fn a_users_files_stay() {
    let folder = TempDir::new().expect("a folder");
    written(folder.path(), &dragged(json!("static"), 40));
    let out = folder.path().join("out");
    done(&run(folder.path(), "out", &[]));
    let frames = named_frames(&out, "solid.pvd");
    let mine = ["law.csv", "solid/mine.vtu", "friction.svg", "notes.txt"].map(|name| out.join(name));
    mine.iter().for_each(|path| fs::write(path, "mine").expect("a file"));
    written(folder.path(), &dragged(json!("static"), 8));
    done(&run(folder.path(), "out", &[]));
    mine.iter().for_each(|path| assert_eq!(fs::read_to_string(path).expect("it is there"), "mine"));
    assert!(named_frames(&out, "solid.pvd") < frames);
    let left = fs::read_dir(out.join("solid")).expect("frames").count();
    assert_eq!(left, named_frames(&out, "solid.pvd") + 1, "the frames of the longer run are gone");
    // What stands where results go and is none of them ends the command before anything is written.
    for name in ["history.csv", "summary.json", "solid/00007.vtu", "contact"] {
        let out = folder.path().join("strange");
        let _ = fs::remove_dir_all(&out);
        fs::create_dir_all(out.join(name).parent().expect("a folder")).expect("a folder");
        fs::write(out.join(name), "mine").expect("a file");
        let told = told(&run(folder.path(), "strange", &[]), 2);
        assert!(told.contains(name), "{name}: {told}");
        assert_eq!(fs::read_to_string(out.join(name)).expect("it is there"), "mine");
        assert_eq!(results(&out).len() + usize::from(name == "summary.json"), 1);
    }
}

/// What a run reads it does not write over.
#[test]
fn an_output_that_is_an_input_is_refused() {
    let folder = TempDir::new().expect("a folder");
    let case = dragged(json!("static"), 4).to_string();
    for name in ["summary.json", "history.csv"] {
        let path = folder.path().join(name);
        fs::write(&path, &case).expect("a file");
        let output = Command::new(PROGRAM).current_dir(folder.path()).args(["run", name, "--out", "."]).output();
        let told = told(&output.expect("it runs"), 2);
        assert!(told.contains("is an input of this run"), "{told}");
        assert_eq!(fs::read_to_string(&path).expect("it is there"), case);
        fs::remove_file(&path).expect("it goes");
    }
}

/// Links lead to what is not ours.
#[cfg(unix)]
#[test]
fn nothing_is_written_or_removed_through_a_link() {
    use std::os::unix::fs::symlink;
    let folder = TempDir::new().expect("a folder");
    written(folder.path(), &dragged(json!("static"), 4));
    let treasure = folder.path().join("treasure");
    fs::create_dir(&treasure).expect("a folder");
    for name in ["00000.vtu", "file"] {
        fs::write(treasure.join(name), "mine").expect("a file");
    }
    for (link, target) in
        [("solid", treasure.clone()), ("history.csv", treasure.join("file")), ("checkpoint.bin", treasure.join("none"))]
    {
        for before in [false, true] {
            let out = folder.path().join("out");
            let _ = fs::remove_dir_all(&out);
            if before {
                done(&run(folder.path(), "out", &[]));
                let place = out.join(link);
                if place.is_dir() { fs::remove_dir_all(&place) } else { fs::remove_file(&place) }.expect("it goes");
            }
            fs::create_dir_all(&out).expect("a folder");
            symlink(&target, out.join(link)).expect("a link");
            assert!(told(&run(folder.path(), "out", &[]), 2).contains(link));
            let left = ["00000.vtu", "file"].map(|name| fs::read_to_string(treasure.join(name)).expect("it is there"));
            assert_eq!(left, ["mine", "mine"]);
            assert_eq!(fs::read_dir(&treasure).expect("a folder").count(), 2);
        }
    }
    // The folder that a user names may be a link itself.
    let _ = fs::remove_dir_all(folder.path().join("out"));
    fs::create_dir(folder.path().join("elsewhere")).expect("a folder");
    symlink("elsewhere", folder.path().join("out")).expect("a link");
    done(&run(folder.path(), "out", &[]));
}

/// A run that was interrupted half way: its folder, with the case beside it.
fn interrupted(case: &Value) -> TempDir {
    let folder = TempDir::new().expect("a folder");
    written(folder.path(), case);
    let out = folder.path().join("out");
    for _ in 0..20 {
        let mut child = command(folder.path(), "out", &[]).spawn().expect("it runs");
        wait_for_rows(&mut child, &out, 12);
        child.kill().expect("it is killed");
        // One that was killed while it ended has nothing left to go on with.
        if child.wait().expect("it ends").code().is_none() && summary(&out)["status"] == "running" {
            assert!(out.join("checkpoint_prev.bin").exists());
            return folder;
        }
        fs::remove_dir_all(&out).expect("it was over, and can go");
    }
    panic!("the run is over whenever it is looked at");
}

/// A case may change where its run has not come yet, and in what is written; else it is told where it differs.
#[test]
fn a_run_goes_on_with_its_own_case_alone() {
    let case = dragged(json!("static"), 120);
    let folder = interrupted(&case);
    let changed: [(&str, &str, Value, &str); 5] = [
        ("friction", "/contacts/base/friction/mu_k", json!(0.25), "`contacts.base.friction.mu_k` is 0.25, and was 0.2"),
        ("support", "/steps/1/supports/0/ux/rate", json!(0.2), "`steps[1].supports[0].ux.rate` is 0.2, and was 0.1"),
        ("past", "/steps/0/duration", json!(2), "`steps[0].duration` is 2, and was 1"),
        ("mesh", "/mesh/nodes/3/0", json!(0.8), "`mesh.nodes[3][0]`"),
        ("a step less", "/steps", json!([case["steps"][0]]), "`steps[1]` is not given"),
    ];
    for (name, pointer, value, expected) in changed {
        let mut other = case.clone();
        *other.pointer_mut(pointer).expect("it is there") = value;
        written(folder.path(), &other);
        let told = told(&run(folder.path(), "out", &["--resume"]), 2);
        assert!(told.contains("the case has changed since its checkpoint was written"), "{name}: {told}");
        assert!(told.contains(expected), "{name}: {told}");
    }
    // Another title, another watched set, more frames, and a step that comes after.
    let mut more = case.clone();
    more["title"] = json!("Another title");
    more["watch"] = json!(["block_top", "ground_bottom"]);
    more["output"]["every"] = json!(1);
    let after = json!({"name": "hold", "duration": 1, "dt": {"initial": 0.5}, "supports": [{"on": "block_top", "ux": {"rate": 0}}]});
    more["steps"].as_array_mut().expect("steps").push(after);
    written(folder.path(), &more);
    done(&run(folder.path(), "out", &["--resume"]));
    done(&run(folder.path(), "straight", &[]));
    let [out, straight] = ["out", "straight"].map(|name| {
        let text = fs::read_to_string(folder.path().join(name).join("history.csv")).expect("a table");
        text.lines().map(String::from).collect::<Vec<_>>()
    });
    assert_eq!(out.len(), straight.len());
    assert_eq!(out[0], straight[0]);
    // Columns of the new set: ux, uy, fx, fy, and the means by length of its edges.
    let gaps = |row: &String| row.split(',').filter(|cell| *cell == "NaN").count();
    assert!(out.iter().all(|row| [0, 6].contains(&gaps(row))) && straight.iter().all(|row| gaps(row) == 0));
    let unknown = out.iter().filter(|row| gaps(row) > 0).count();
    assert!(unknown >= 10 && unknown < out.len() - 5, "{unknown}");
    for (out, straight) in out.iter().zip(&straight) {
        assert!(
            out.split(',').zip(straight.split(',')).all(|(out, straight)| out == "NaN" || out == straight),
            "{out}"
        );
    }
    // A column that would be lost is not.
    more["watch"] = json!([]);
    written(folder.path(), &more);
    assert!(
        told(&run(folder.path(), "out", &["--resume"]), 2)
            .contains("has the column `block_top.ux`, which would be lost")
    );
}

/// A run that has come to its end goes on with a step that was put behind.
#[test]
fn a_finished_run_goes_on_with_another_step() {
    let folder = TempDir::new().expect("a folder");
    let whole = dragged(json!("static"), 6);
    let mut first = whole.clone();
    first["steps"].as_array_mut().expect("steps").pop();
    written(folder.path(), &first);
    done(&run(folder.path(), "out", &[]));
    // Nothing is left to be done, and so nothing changes.
    let before = results(&folder.path().join("out"));
    done(&run(folder.path(), "out", &["--resume"]));
    assert!(before == results(&folder.path().join("out")));
    written(folder.path(), &whole);
    done(&run(folder.path(), "out", &["--resume"]));
    done(&run(folder.path(), "straight", &[]));
    same(&folder.path().join("straight"), &folder.path().join("out"));
}

/// A damaged checkpoint is told, and the one before it taken; two damaged ones end the command, and a later format too.
#[test]
fn a_damaged_checkpoint_is_told() {
    let folder = interrupted(&dragged(json!("static"), 120));
    let out = folder.path().join("out");
    let newest = out.join("checkpoint.bin");
    let bytes = fs::read(&newest).expect("a checkpoint");
    // A run that was killed between its two checkpoints has left one file with two names.
    let put = |path: &Path, bytes: &[u8]| {
        fs::remove_file(path).expect("it was there");
        fs::write(path, bytes).expect("a file");
    };
    let mut flipped = bytes.clone();
    flipped[bytes.len() / 2] ^= 0x10;
    for damaged in
        [&flipped[..], &bytes[..bytes.len() - 7], &bytes[..10], b"", b"not a checkpoint at all, but a text of a user"]
    {
        put(&newest, damaged);
        put(&out.join("checkpoint_prev.bin"), damaged);
        let told = told(&run(folder.path(), "out", &["--resume"]), 2);
        assert!(told.contains("checkpoint.bin: --resume: it is damaged: "), "{told}");
    }
    let mut later = bytes.clone();
    later[21] += 1;
    put(&newest, &later);
    put(&out.join("checkpoint_prev.bin"), &bytes);
    assert!(
        told(&run(folder.path(), "out", &["--resume"]), 2).contains(&format!("it has the format {}", bytes[21] + 1))
    );
    put(&newest, &flipped);
    done(&run(folder.path(), "out", &["--resume"]));
    let warnings = summary(&out)["warnings"].to_string();
    assert!(warnings.contains("its checksum is wrong; the previous checkpoint was used"), "{warnings}");
    done(&run(folder.path(), "straight", &[]));
    assert!(results(&folder.path().join("straight")) == results(&out));
}

/// What fuzzing of checkpoints begins with would else be refused at its head.
#[test]
fn the_seed_of_a_checkpoint_has_the_format_of_now() {
    let seed = crate::common::repository("fuzz/seeds/checkpoint/0");
    assert!(checkpoint::read(&seed).is_ok_and(|checkpoint| checkpoint.complete));
}

/// Results that were changed behind the program's back cannot be gone on with.
#[test]
fn results_that_are_missing_are_told() {
    for (name, reason) in [("newton.csv", "No such file"), ("solid/00001.vtu", "is missing")] {
        let folder = interrupted(&dragged(json!("static"), 2000));
        fs::remove_file(folder.path().join("out").join(name)).expect("it was there");
        let told = told(&run(folder.path(), "out", &["--resume"]), 2);
        assert!(told.contains(name) && told.contains(reason), "{told}");
    }
}

/// What is gone on with is what was written: a byte changed since in a table or in a complete chunk of the store, a column that
/// the case no longer asks for or a frame that is gone ends the command before anything is written or taken back, and put back
/// it goes on to the bytes of a run in one go.
#[test]
fn results_that_were_altered_are_not_gone_on_with() {
    let folder = TempDir::new().expect("a folder");
    let mut case = explicit();
    // So many points that the store has a complete chunk well before the end, and time between frames and checkpoints.
    case["mesh"] = Blocks::default()
        .rectangle("ground", [10, 2], [0.0, -0.5], [3.0, 0.0])
        .rectangle("block", [50, 1], [0.4, 0.01], [1.4, 0.51])
        .json();
    case["output"] = json!({"checkpoint": 1e-3, "interval": 1e-4, "every": 100});
    case["steps"][1]["duration"] = json!(0.05);
    case["probes"] = json!({"gauge": {"at": [0.9, 0.3]}});
    written(folder.path(), &case);
    done(&run(folder.path(), "straight", &[]));
    let out = folder.path().join("out");
    let mut child = command(folder.path(), "out", &[]).spawn().expect("it runs");
    wait_for_rows(&mut child, &out, 400);
    child.kill().expect("it is killed");
    child.wait().expect("it ends");
    let all = || {
        let mut all = results(&out);
        // The lock of the run that was killed goes.
        all.remove(Path::new("fecontact.lock"));
        let further = ["summary.json", "checkpoint.bin", "checkpoint_prev.bin"].map(PathBuf::from);
        all.extend(further.map(|name| (name.clone(), fs::read(out.join(&name)).expect("a file"))));
        all
    };
    let before = all();
    assert_eq!(summary(&out)["status"], "running", "it is killed on its way");
    let refused = |name: &str, reason: &str| {
        let changed = all();
        let told = told(&run(folder.path(), "out", &["--resume"]), 2);
        assert!(told.contains(&format!("out/{name}: ")) && told.contains(reason), "{name}: {told}");
        assert!(all() == changed, "{name}: something else was changed");
    };
    let change = "was changed since the checkpoint was written";
    for (name, told_of) in [
        ("history.csv", "history.csv"),
        ("newton.csv", "newton.csv"),
        ("probes.csv", "probes.csv"),
        ("interface.zarr/base.slip/0.0", "interface.zarr/base.slip"),
    ] {
        let whole = &before[Path::new(name)];
        let mut altered = whole.clone();
        // A digit of the second row; anything in a chunk.
        let row = whole.iter().position(|byte| *byte == b'\n').filter(|_| name.ends_with("csv")).unwrap_or(100);
        let digit = row + whole[row..].iter().position(u8::is_ascii_digit).expect("a digit");
        altered[digit] ^= 1;
        fs::write(out.join(name), altered).expect("a file");
        refused(told_of, change);
        fs::write(out.join(name), &whole[..whole.len() / 4]).expect("a file");
        refused(told_of, change);
        fs::write(out.join(name), whole).expect("a file");
    }
    let frame = "solid/00001.vtu";
    fs::remove_file(out.join(frame)).expect("it was there");
    refused(frame, "and is missing");
    fs::write(out.join(frame), &before[Path::new(frame)]).expect("a file");
    let mut other = case.clone();
    other["probes"] = json!({"other": {"at": [0.9, 0.3]}});
    written(folder.path(), &other);
    refused("probes.csv", "has the column `gauge.ux`, which would be lost");
    written(folder.path(), &case);
    done(&run(folder.path(), "out", &["--resume"]));
    same(&folder.path().join("straight"), &out);
}

/// A table that is asked for anew is not begun where another cannot be gone on with: it would be in the way afterwards.
#[test]
fn nothing_is_begun_beside_altered_results() {
    let folder = TempDir::new().expect("a folder");
    let mut case = dragged(json!("static"), 6);
    written(folder.path(), &case);
    done(&run(folder.path(), "out", &[]));
    let history = folder.path().join("out/history.csv");
    let whole = fs::read_to_string(&history).expect("a table");
    fs::write(&history, whole.replacen("press", "Press", 1)).expect("a file");
    case["probes"] = json!({"gauge": {"at": [0.9, 0.3]}});
    written(folder.path(), &case);
    told(&run(folder.path(), "out", &["--resume"]), 2);
    assert!(!folder.path().join("out/probes.csv").exists());
    fs::write(&history, whole).expect("a file");
    done(&run(folder.path(), "out", &["--resume"]));
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
    assert!(text.contains("contacts.base.normal.alpha_n: is left open") && text.contains("has inertia"), "{text}");

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
    assert!(text.contains("contacts.base.method: is left open") && text.contains("explicit"), "{text}");
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
        ("/bodies/block/material/E", json!(200), "`bodies.block.material.E` is 200, and was 100"),
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
    let there = "`fill` is there from the start of the run so far";
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
