//! Cases, meshes and result folders changed at random, by the thousand, from fixed seeds: whatever comes in, the program ends in
//! time, with an exit code of its own and a reason, and what it accepts leads to finite results.
//!
//! The plain tests take a few; `MUTATIONS=all cargo test --release --test command mutations` takes 10 000 cases, 2000 meshes and
//! 1000 result folders. A failure prints its seed, and leaves the input in a folder that it names.

mod results;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;

const PROGRAM: &str = env!("CARGO_BIN_EXE_fecontact_tested");

/// A run that takes longer is asked to end: far more than any takes, also where the machine has other work.
const LIMIT: Duration = Duration::from_secs(60);

/// What is asked to end does so in this time.
const OBEYS: Duration = Duration::from_secs(10);

fn count(few: usize, all: usize) -> usize {
    if std::env::var("MUTATIONS").is_ok_and(|wanted| wanted == "all") { all } else { few }
}

/// Numbers that look random: SplitMix64. Source: Steele, Lea & Flood (2014), doi:10.1145/2660193.2660195.
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, count: usize) -> usize {
        (self.next() % count.max(1) as u64) as usize
    }

    fn of<'l, T>(&mut self, list: &'l [T]) -> &'l T {
        &list[self.below(list.len())]
    }
}

/// How a command ended.
struct Ended {
    /// none if it had to be killed
    code: Option<i32>,
    message: String,
    /// whether it was asked to end because it took long
    asked: bool,
}

fn run(folder: &Path, arguments: &[&str]) -> Ended {
    let message = folder.join("told.txt");
    let stderr = fs::File::create(&message).expect("a file");
    let mut command = Command::new("env");
    command.args(["--default-signal", PROGRAM]).args(arguments).current_dir(folder).env("RAYON_NUM_THREADS", "1");
    let mut child = command.stdout(Stdio::null()).stderr(stderr).spawn().expect("the program starts");
    let start = Instant::now();
    let mut asked = false;
    let code = loop {
        if let Some(status) = child.try_wait().expect("a child") {
            break status.code();
        }
        if start.elapsed() > LIMIT && !asked {
            asked = true;
            let sent = Command::new("kill").args(["-TERM", &child.id().to_string()]).status().expect("kill");
            assert!(sent.success());
        }
        if start.elapsed() > LIMIT + OBEYS {
            child.kill().expect("it is killed");
            child.wait().expect("it ends");
            break None;
        }
        std::thread::sleep(Duration::from_micros(500));
    };
    Ended { code, message: String::from_utf8_lossy(&fs::read(&message).expect("a file")).into_owned(), asked }
}

/// What is wrong with how a command ended.
fn fault(folder: &Path, Ended { code, message, asked }: &Ended, must_refuse: bool, file: &str) -> Option<String> {
    let out = folder.join("out");
    let reason = |start: &str| -> Option<String> {
        let line = message.lines().find_map(|line| line.strip_prefix(start))?;
        Some(line.trim_end().trim_end_matches(['.', ';', ':', ' ']).into())
    };
    let hollow =
        |reason: &str| reason.is_empty() || reason.contains(": ;") || reason.contains("()") || reason.ends_with(file);
    if message.chars().any(|c| c.is_control() && c != '\n') {
        return Some("control characters are printed".into());
    }
    match code {
        None => Some("it hangs, or was ended by the system".into()),
        Some(2) => match reason("error: ") {
            None => Some("no reason is told".into()),
            Some(reason) if hollow(&reason) || !message.contains(file) => Some(format!("an empty reason: {reason}")),
            Some(_) if message.len() > 4000 => Some("the reason is endless".into()),
            Some(_) if out.exists() => Some("results were written for bad input".into()),
            Some(_) => None,
        },
        Some(1) if *asked && message.contains("interrupted") => None,
        Some(0 | 1) if must_refuse => Some("it was accepted".into()),
        Some(1) => match reason("stopped: ") {
            Some(reason) if !hollow(&reason) => unreadable(&out),
            _ => Some("no reason is told".into()),
        },
        Some(0) => unreadable(&out),
        Some(code) => Some(format!("exit code {code}")),
    }
}

/// What is wrong with results, if there are any.
fn unreadable(out: &Path) -> Option<String> {
    for name in ["history.csv", "law.csv"] {
        let Ok(text) = fs::read_to_string(out.join(name)) else { continue };
        let mut lines = text.lines();
        let header: Vec<&str> = lines.next().map_or(Vec::new(), |header| header.split(',').collect());
        let columns = header.len();
        for line in lines {
            let cells: Vec<&str> = line.split(',').collect();
            // A step may have any name.
            let finite =
                |(cell, name): (&&str, &&str)| *name == "step" || cell.parse::<f64>().map_or(true, f64::is_finite);
            if cells.len() != columns || !cells.iter().zip(&header).all(finite) {
                return Some(format!("{name}: {line}"));
            }
        }
    }
    let summary = fs::read_to_string(out.join("summary.json")).ok()?;
    serde_json::from_str::<Value>(&summary).err().map(|error| format!("summary.json: {error}"))
}

/// Say what went wrong, and keep what it went wrong with.
#[track_caller]
fn report(folder: TempDir, faults: usize, what: &str) {
    if faults > 0 {
        panic!("{faults} of the inputs in {}: {what}", folder.keep().display());
    }
}

// --------------------------------------------------------------------------------------------------------------- cases

/// The mesh of the good case, with a corner.
fn blocks() -> Value {
    let mut mesh = crate::input::good()["mesh"].clone();
    mesh["points"] = json!({"corner": [13]});
    mesh
}

/// Cases and tests of laws that together use most of what there is.
fn seeds() -> Vec<(&'static str, Value)> {
    let elastic = |model: &str| json!({"model": model, "E": 1000, "nu": 0.3, "density": 1e-3});
    let held = json!({"on": "ground_bottom", "ux": 0, "uy": 0});
    vec![
        (
            "run",
            json!({
                "title": "pressed and dragged", "units": {"length": "mm"}, "mesh": blocks(),
                "bodies": {"ground": {"material": elastic("neo_hookean")}, "block": {"material": elastic("hencky")}},
                "contacts": {"base": {"slave": "block_bottom", "master": "ground_top", "normal": {"alpha_n": 1e5}, "friction":
                    {"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "alpha_t": 1e5, "r": 100, "kappa": 10, "xi": 0.1}}},
                "steps": [
                    {"name": "press", "duration": 1, "dt": {"initial": 0.5, "min": 0.01, "max": 0.5},
                        "supports": [held, {"on": "block_top", "ux": 0, "uy": -0.001}]},
                    {"name": "drag", "duration": 1, "supports": [{"on": "block_top", "ux": "0.001*(t-1)^2"}],
                        "loads": [{"on": "block_top", "pressure": {"table": [[0, 0], [2, 1]]}}]}],
                "watch": ["block_top"], "newton": {"tolerance": 1e-9, "max_iterations": 20},
                "output": {"every": 1, "fields": false, "fronts": {"slip_rate": 1e-4}},
            }),
        ),
        (
            "run",
            json!({
                "mesh": blocks(),
                "bodies": {"ground": {"material": elastic("linear"), "damping": {"mass": 0.1, "stiffness": 1e-4}},
                    "block": {"material": elastic("linear"), "element": "f_bar"}},
                "initial_velocity": {"block": [0.1, -0.1]},
                "contacts": {"base": {"slave": "block_bottom", "master": "ground_top", "method": "mortar",
                    "normal": {"alpha_n": 1e4, "penetration": 1e-5}, "friction": {"law": "coulomb", "mu": 0.3},
                    "along": {"mu": {"x": [[0, 0.2], [4, 0.4]]}}}},
                "steps": [{"name": "fall", "duration": 0.01, "scheme": {"hht": {"alpha": -0.05}}, "dt": {"initial": 0.005, "min": 1e-4},
                    "supports": [held, {"on": "block_top", "rotation": {"about": [2, 1], "angle": 0.001}}],
                    "loads": [{"on": "block", "gravity": {"y": -10}}, {"on": "ground_top", "traction": {"x": {"rate": 1}}},
                        {"on": {"node": 13}, "spring": {"kx": 1, "ky": 1, "driver": {"x": "0.01*sin(t)"}}}]}],
                "output": {"fields": false, "checkpoint": null},
            }),
        ),
        (
            "run",
            json!({
                "mesh": blocks(),
                "bodies": {"ground": {"material": elastic("saint_venant_kirchhoff")}, "block": {"material": elastic("neo_hookean")}},
                "contacts": {"base": {"slave": "block_bottom", "master": {"polyline": {"points": [[4, 0], [0, 0]]}},
                    "method": "node_to_segment", "friction":
                    {"law": "slip_weakening", "mu_s": 0.5, "mu_d": 0.3, "D_c": 0.01, "cohesion": 0.1}}},
                "steps": [{"name": "shake", "duration": 0.002, "scheme": {"explicit": {"safety": 0.8}}, "dt": {"initial": 0.001},
                    "supports": [held, {"on": "block_top", "uy": {"rate": -0.1}}],
                    "loads": [{"on": "ground_top", "absorbing": true}, {"on": "corner", "force": {"x": 1}}]}],
                "output": {"interval": 0.0005, "fields": false},
            }),
        ),
        (
            "run",
            json!({
                "mesh": {"nodes": [[0, 0]], "points": {"mass": [0]}}, "point_masses": {"mass": {"mass": 10, "velocity": [0.01, 0]}},
                "contacts": {"base": {"slave": "mass", "area": 1, "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
                    "normal": {"alpha_n": 1000}, "initial": {"pressure": 98.1, "traction": 1e-6}, "friction":
                    {"law": "rate_and_state", "f_0": 0.6, "V_0": 1e-3, "a": 0.01, "b": 0.015, "D_c": 1e-3, "theta": 1, "alpha_t": 1e4}}},
                "steps": [{"name": "pull", "duration": 0.2, "scheme": {"newmark": {}}, "dt": {"initial": 0.02, "max": 0.05, "min": 1e-5, "error": 1e-4},
                    "loads": [{"on": "mass", "force": {"y": "-98.1"}}, {"on": "mass", "dashpot": {"cx": 1, "cy": 0}},
                        {"on": "mass", "spring": {"kx": 10, "ky": 0, "driver": {"x": {"rate": 0.01}}}}]}],
                "output": {"fields": false},
            }),
        ),
        (
            "law",
            json!({
                "title": "to and fro", "initial": {"traction": 0, "pressure": 98}, "dt": 0.05, "friction":
                    {"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "alpha_t": 1e3, "r": 100, "kappa": 10, "structure": 2},
                "path": [{"duration": 1, "slip": "0.01*sin(2*pi*t)", "pressure": 98}, {"duration": 1, "slip": {"rate": 0.1}, "dt": 0.02}],
            }),
        ),
    ]
}

/// JSON pointers of all values below the root.
fn places(value: &Value, at: &str, found: &mut Vec<String>) {
    let mut inside = |key: String, value: &Value| {
        found.push(format!("{at}/{key}"));
        places(value, &format!("{at}/{key}"), found);
    };
    match value {
        Value::Object(object) => object.iter().for_each(|(key, value)| inside(key.clone(), value)),
        Value::Array(list) => list.iter().enumerate().take(6).for_each(|(k, value)| inside(k.to_string(), value)),
        _ => {}
    }
}

const NUMBERS: [f64; 24] = [
    0.0,
    -0.0,
    -1.0,
    1.0,
    2.0,
    0.5,
    1e300,
    -1e300,
    1e-300,
    5e-324,
    1e19,
    1.8446744073709552e19,
    4294967296.0,
    1e12,
    1e-12,
    1e6,
    1e-6,
    1e9,
    1e-9,
    3.0,
    10.0,
    0.4999999,
    1.5,
    f64::MAX,
];

const TEXTS: [&str; 34] = [
    "",
    " ",
    "NaN",
    "inf",
    "x",
    "t",
    "nonsense",
    "\0",
    "é\u{202e}😩",
    "../../etc/passwd",
    "x/0",
    "1/t",
    "ln(-1)",
    "sqrt(t-1)",
    "t^t^t",
    "1e308*10*t",
    "exp(1e3*t)",
    "tan(pi*t/2)",
    "x*1e300*1e300",
    "-",
    "0*y",
    "(((",
    "1e",
    "t,t",
    "0/0",
    "atan2(t,",
    "floor(9*t)",
    "a+b",
    "\n",
    "static",
    "null",
    "%s%n",
    "A\"B",
    "\u{1b}[2J\u{7}",
];

fn others() -> Vec<Value> {
    vec![
        json!(null),
        json!(true),
        json!([]),
        json!({}),
        json!([[]]),
        json!([null]),
        json!({"": null}),
        json!({"rate": 1e300}),
        json!({"table": []}),
        json!({"table": [[0, 0]]}),
        json!({"table": [[0, 0], [0, 1]]}),
        json!({"table": [[0, 0], [1e-300, 1]]}),
        json!({"table": [[0, 1e300], [1, -1e300]]}),
        json!({"x": [[0, 0]]}),
        json!([0, 0]),
        json!([1, 2, 3]),
    ]
}

/// A changed document as text, what was done, and whether it must be refused.
fn changed(chance: &mut Chance, document: &Value) -> (String, String, bool) {
    let mut all = Vec::new();
    places(document, "", &mut all);
    let mut changed = document.clone();
    let mut message = Vec::new();
    let mut must_refuse = false;
    for _ in 0..*chance.of(&[1, 1, 1, 2, 3]) {
        let pointer = chance.of(&all).clone();
        let (parent, key) = pointer.rsplit_once('/').expect("a pointer begins with a slash");
        let Some(old) = changed.pointer(&pointer).cloned() else { continue };
        let Some(holder) = changed.pointer_mut(parent) else { continue };
        let mut set = |value: Value| match holder {
            Value::Object(object) => drop(object.insert(key.into(), value)),
            Value::Array(list) => list[key.parse::<usize>().expect("an index")] = value,
            _ => {}
        };
        let what = chance.below(14);
        match what {
            0..=3 => set(match old.as_f64() {
                Some(number) if chance.below(2) == 0 => {
                    json!(number * chance.of(&[-1.0, 0.0, 1e3, 1e-3, 1e6, 1e-6, 1e100, 10.0, 0.1]))
                }
                _ => json!(chance.of(&NUMBERS)),
            }),
            4 | 5 => set(json!(chance.of(&TEXTS))),
            6 | 7 => set(chance.of(&others()).clone()),
            8 => {
                if let Value::Object(object) = holder {
                    object.remove(key);
                }
            }
            // A list is no object, and nothing is known by this name.
            9 => {
                if let Value::Object(object) = &old {
                    set(object.values().cloned().collect());
                    must_refuse = message.is_empty();
                }
            }
            10 => {
                if let Value::Object(object) = holder {
                    object.insert("stray".into(), json!(1));
                    must_refuse = message.is_empty();
                }
            }
            11 => {
                let other = chance.of(&all).clone();
                if let Some(value) = document.pointer(&other) {
                    set(value.clone());
                }
            }
            12 => {
                if let Value::Array(list) = holder {
                    let copies = *chance.of(&[1, 2, 50]);
                    list.extend(std::iter::repeat_n(old, copies));
                }
            }
            _ => set((0..*chance.of(&[1, 5, 150]))
                .fold(old, |value, k| if k % 2 == 0 { json!([value]) } else { json!({"a": value}) })),
        }
        message.push(format!("{what} at {pointer}"));
    }
    let mut text = changed.to_string();
    if message.len() > 1 {
        must_refuse = false;
    }
    if chance.below(12) == 0 {
        must_refuse = false;
        let mut at = chance.below(text.len());
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        let inserted = *chance.of(&[
            "",
            "NaN",
            "1e999",
            "//c\n",
            "'",
            ",",
            "{",
            "[[[[[[",
            "\0",
            "\u{feff}",
            "-",
            "111111111111111111111111",
        ]);
        text = match chance.below(3) {
            0 => text[..at].into(),
            1 => format!("{text}{text}"),
            _ => format!("{}{inserted}{}", &text[..at], &text[at..]),
        };
        message.push(format!("text at {at}"));
    }
    (text, message.join(", "), must_refuse)
}

#[test]
fn mutated_cases_end_with_a_reason() {
    let seeds = seeds();
    let folder = TempDir::new().expect("a folder");
    let original = |number: usize| {
        let (command, document) = &seeds[number];
        fs::write(folder.path().join("good.json"), document.to_string()).expect("a file");
        let ended = run(folder.path(), &[command, "good.json", "--out", "out"]);
        assert_eq!(ended.code, Some(0), "seed {number} itself: {}", ended.message);
        fs::remove_dir_all(folder.path().join("out")).expect("a folder");
    };
    (0..seeds.len()).for_each(original);
    let (mut faults, mut first, mut codes) = (0, String::new(), [0; 3]);
    for seed in 0..count(250, 10_000) as u64 {
        let mut chance = Chance(seed);
        let (command, document) = &seeds[chance.below(seeds.len())];
        let (text, how, must_refuse) = changed(&mut chance, document);
        fs::write(folder.path().join("bad.json"), &text).expect("a file");
        let ended = run(folder.path(), &[command, "bad.json", "--out", "out"]);
        if let Some(code @ 0..=2) = ended.code {
            codes[code as usize] += 1;
        }
        if let Some(fault) = fault(folder.path(), &ended, must_refuse, "bad.json") {
            faults += 1;
            let line = format!("seed {seed} ({how}): {fault}: {}", ended.message.chars().take(600).collect::<String>());
            println!("{line}");
            first = if first.is_empty() { line } else { first };
            fs::write(folder.path().join(format!("seed_{seed}.json")), text).expect("a file");
        }
        let _ = fs::remove_dir_all(folder.path().join("out"));
    }
    println!("exit codes 0, 1, 2: {codes:?}");
    report(folder, faults, &first);
}

// -------------------------------------------------------------------------------------------------------------- meshes

/// A case on a mesh file of one body that is held at its bottom.
fn on_mesh() -> Value {
    json!({
        "mesh": "bad.msh", "bodies": {"body": {"material": {"model": "linear", "E": 1000, "nu": 0.3}}},
        "steps": [{"name": "pull", "duration": 1, "dt": {"initial": 1}, "supports": [{"on": "bottom", "ux": 0, "uy": 0}],
            "loads": [{"on": "bottom", "pressure": 1}]}],
        "output": {"fields": false, "checkpoint": null},
    })
}

fn tokens(bytes: &[u8]) -> Vec<(usize, usize)> {
    let is = |b: u8| b.is_ascii_digit() || matches!(b, b'.' | b'-' | b'e');
    let mut found = Vec::new();
    let mut start = None;
    for (k, &b) in bytes.iter().enumerate() {
        match (start, is(b)) {
            (None, true) => start = Some(k),
            (Some(from), false) => {
                found.push((from, k));
                start = None;
            }
            _ => {}
        }
    }
    found
}

fn changed_mesh(chance: &mut Chance, mesh: &[u8]) -> Vec<u8> {
    let mut bytes = mesh.to_vec();
    for _ in 0..*chance.of(&[1, 1, 2, 5]) {
        let at = chance.below(bytes.len());
        match chance.below(8) {
            0 => bytes[at] ^= 1 << chance.below(8),
            1 => drop(bytes.drain(at..(at + chance.of(&[1, 2, 8, 100])).min(bytes.len()))),
            2 => {
                let inserted: [&[u8]; 9] =
                    [b"0", b"-1", b" ", b"\n", b"1e999", b"nan", b"18446744073709551616", b"$", &[0; 8]];
                bytes.splice(at..at, chance.of(&inserted).iter().copied());
            }
            3 => bytes.truncate(at),
            7 => {
                let mut lines: Vec<Vec<u8>> = bytes.split(|&b| b == b'\n').map(<[u8]>::to_vec).collect();
                let (a, b) = (chance.below(lines.len()), chance.below(lines.len()));
                lines.swap(a, b);
                bytes = lines.join(&b'\n');
            }
            _ => {
                let numbers: [&[u8]; 14] = [
                    b"0",
                    b"-1",
                    b"1",
                    b"2",
                    b"3",
                    b"1000000000000",
                    b"18446744073709551615",
                    b"2147483648",
                    b"-2147483648",
                    b"1e308",
                    b"nan",
                    b"1e-300",
                    b"",
                    b"1e-12",
                ];
                let all = tokens(&bytes);
                if !all.is_empty() {
                    let (from, to) = *chance.of(&all);
                    bytes.splice(from..to, chance.of(&numbers).iter().copied());
                }
            }
        }
        if bytes.is_empty() {
            return b"x".to_vec();
        }
    }
    bytes
}

#[test]
fn mutated_meshes_end_with_a_reason() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
    let names = ["quad4.msh", "quad4_binary.msh", "tri6.msh", "quad9_binary.msh", "quad8.msh"];
    let meshes = names.map(|name| fs::read(data.join(name)).expect("a mesh"));
    let folder = TempDir::new().expect("a folder");
    fs::write(folder.path().join("case.json"), on_mesh().to_string()).expect("a file");
    let (mut faults, mut first) = (0, String::new());
    for seed in 0..count(150, 2000) as u64 {
        let mut chance = Chance(seed);
        let mesh = chance.of(&meshes);
        let bytes = changed_mesh(&mut chance, mesh);
        fs::write(folder.path().join("bad.msh"), &bytes).expect("a file");
        let ended = run(folder.path(), &["run", "case.json", "--out", "out"]);
        if let Some(fault) = fault(folder.path(), &ended, false, "case.json") {
            faults += 1;
            let line = format!("seed {seed}: {fault}: {}", ended.message.chars().take(600).collect::<String>());
            println!("{line}");
            first = if first.is_empty() { line } else { first };
            fs::write(folder.path().join(format!("seed_{seed}.msh")), bytes).expect("a file");
        }
        let _ = fs::remove_dir_all(folder.path().join("out"));
    }
    report(folder, faults, &first);
}

// ------------------------------------------------------------------------------------------------------------- results
