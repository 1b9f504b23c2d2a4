//! Folders of results that are damaged at random.

use super::*;

fn damaged(chance: &mut Chance, bytes: &[u8]) -> Vec<u8> {
    let lines = || -> Vec<&[u8]> { bytes.split(|&b| b == b'\n').collect() };
    let at = chance.below(bytes.len());
    match chance.below(7) {
        0 => bytes[..at].to_vec(),
        1 => {
            let mut bytes = bytes.to_vec();
            if let Some(byte) = bytes.get_mut(at) {
                *byte = chance.below(256) as u8;
            }
            bytes
        }
        2 => {
            let numbers: [&[u8]; 11] =
                [b"NaN", b"inf", b"-inf", b"1e308", b"-1e308", b"", b"x", b"1e-320", b"1e999", b"<&>\"", b"\xff"];
            let mut cells: Vec<&[u8]> = bytes.split(|&b| b == b',').collect();
            let place = chance.below(cells.len());
            cells[place] = *chance.of::<&[u8]>(&numbers);
            cells.join(&b',')
        }
        3 => {
            let mut lines = lines();
            for k in (1..lines.len()).rev() {
                lines.swap(k, chance.below(k + 1));
            }
            lines.join(&b'\n')
        }
        4 => [lines()[0], b"\n"].concat(),
        5 => {
            let lines = lines();
            let row = lines.get(1).copied().unwrap_or_default();
            [&[lines[0]][..], &vec![row; *chance.of(&[1, 2, 1000])], &[b"" as &[u8]]].concat().join(&b'\n')
        }
        _ => {
            let numbers: [&[u8]; 5] = [b"NaN", b"inf", b"1e308", b"-1e308", b"0"];
            let row = |(k, line): (usize, &&[u8])| -> Vec<u8> {
                let cells = line.split(|&b| b == b',');
                let cells: Vec<&[u8]> =
                    cells.map(|cell| if k > 0 && chance.below(3) == 0 { *chance.of(&numbers) } else { cell }).collect();
                cells.join(&b',')
            };
            lines().iter().enumerate().map(row).collect::<Vec<_>>().join(&b'\n')
        }
    }
}

/// All files below a folder by their paths there, sorted.
fn files(root: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let (mut found, mut folders) = (Vec::new(), vec![root.to_owned()]);
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
            match path.is_dir() {
                true => folders.push(path),
                false => {
                    found.push((path.strip_prefix(root).expect("below").to_owned(), fs::read(&path).expect("a file")))
                }
            }
        }
    }
    found.sort();
    found
}

/// Write a folder of results anew, one file of it damaged or missing; which.
fn with_damage(chance: &mut Chance, results: &Path, source: &[(PathBuf, Vec<u8>)]) -> PathBuf {
    let (victim, missing) = (chance.below(source.len()), chance.below(10) == 0);
    for (k, (name, bytes)) in source.iter().enumerate().filter(|(k, _)| *k != victim || !missing) {
        let path = results.join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        let bytes = if k == victim { damaged(chance, bytes) } else { bytes.clone() };
        fs::write(path, bytes).expect("a file");
    }
    source[victim].0.clone()
}

/// What is wrong with a figure or a page that was written.
fn broken(results: &Path) -> Option<String> {
    let ends = |path: &PathBuf, end: &str| path.extension().is_some_and(|extension| extension == end);
    let figures = fs::read_dir(results).expect("a folder").map(|entry| entry.expect("an entry").path());
    let broken = figures.filter(|path| ends(path, "svg") || ends(path, "html")).find(|path| {
        let text = fs::read_to_string(path).unwrap_or_default();
        match ends(path, "svg") {
            true => text.contains("NaN") || text.contains("\"inf") || !text.trim_end().ends_with("</svg>"),
            false => !text.trim_end().ends_with("</html>"),
        }
    });
    broken.map(|path| format!("{} is broken", path.display()))
}

/// Folders of a run and of a law's test, tables, summary, frames, store and checkpoint: one file damaged or gone.
#[test]
fn damaged_results_are_drawn_or_refused() {
    let folder = TempDir::new().expect("a folder");
    let sources = [0, 4].map(|number| {
        let (command, mut case) = seeds()[number].clone();
        if command == "run" {
            case["output"]["fields"] = json!(true);
        }
        fs::write(folder.path().join(format!("case_{number}.json")), case.to_string()).expect("a file");
        let out = format!("whole_{number}");
        let ended = run(folder.path(), &[command, &format!("case_{number}.json"), "--out", &out]);
        assert_eq!(ended.code, Some(0), "{}", ended.message);
        let drawn = |path: &Path| path.extension().is_some_and(|end| end == "html");
        files(&folder.path().join(&out)).into_iter().filter(|(path, _)| !drawn(path)).collect::<Vec<_>>()
    });
    let kinds = ["history.csv", "solid/00001.vtu", "interface.zarr/.zmetadata", "checkpoint.bin"];
    assert!(kinds.iter().all(|kind| sources[0].iter().any(|(name, _)| name == Path::new(kind))));
    let (mut faults, mut first) = (0, String::new());
    for seed in 0..count(50, 1000) as u64 {
        let mut chance = Chance(seed);
        let results = folder.path().join("bad");
        let kind = chance.below(2);
        let victim = with_damage(&mut chance, &results, &sources[kind]);
        let mut commands = vec![vec!["report", "bad"]];
        if kind == 0 {
            commands.push(vec!["run", "case_0.json", "--out", "bad", "--resume", "--quiet"]);
        }
        let faulty = commands.iter().find_map(|command| {
            let ended = run(folder.path(), command);
            // What goes on from a checkpoint ends with what it would have had, or is refused.
            let other = ended.code == Some(0)
                && command[0] == "run"
                && ["history.csv", "newton.csv"].into_iter().any(|table| {
                    let is = fs::read(results.join(table)).unwrap_or_default();
                    !sources[0].contains(&(table.into(), is))
                });
            let other = other.then(|| "it ends with another table".to_owned());
            let fault = fault(folder.path(), &ended, false, "bad").or_else(|| broken(&results)).or(other)?;
            Some(format!("{command:?}: {fault}: {}", ended.message.chars().take(400).collect::<String>()))
        });
        if let Some(fault) = faulty {
            faults += 1;
            let line = format!("seed {seed} ({}): {fault}", victim.display());
            println!("{line}");
            first = if first.is_empty() { line } else { first };
            fs::rename(&results, folder.path().join(format!("seed_{seed}"))).expect("a folder");
        } else {
            fs::remove_dir_all(&results).expect("a folder");
        }
    }
    report(folder, faults, &first);
}
