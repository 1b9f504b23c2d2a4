//! Signals.

use super::*;

pub fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args([format!("-{name}"), child.id().to_string()]).status().expect("kill");
    assert!(sent.success());
}

/// A run that hears signals: whoever runs the tests may ignore them, as `nohup` does.
pub fn listening(folder: &Path, out: &str, more: &[&str]) -> Child {
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
