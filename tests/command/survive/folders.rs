//! Folders that are full, taken away, locked or those of others.

use super::*;

pub fn shell(folder: &Path, text: &str) -> Output {
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
