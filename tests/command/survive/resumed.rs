//! Runs that go on, from what is there, damaged or altered.

use super::*;

/// A run that was interrupted half way: its folder, with the case beside it.
pub fn interrupted(case: &Value) -> TempDir {
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
        (
            "friction",
            "/contacts/base/friction/mu_k",
            json!(0.25),
            "`contacts.base.friction.mu_k` is now 0.25 and was 0.2",
        ),
        ("support", "/steps/1/supports/0/ux/rate", json!(0.2), "`steps[1].supports[0].ux.rate` is now 0.2 and was 0.1"),
        ("past", "/steps/0/duration", json!(2), "`steps[0].duration` is now 2 and was 1"),
        ("mesh", "/mesh/nodes/3/0", json!(0.8), "`mesh.nodes[3][0]`"),
        ("a step less", "/steps", json!([case["steps"][0]]), "`steps[1]` is now not given"),
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
