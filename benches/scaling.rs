//! The drag problem from 5 000 to a million degrees of freedom: the table in `README.md`, a row a size and thread count.
//!
//! ```text
//! cargo run --release -p fecontact-benches --bin scaling [-- 5k 20k 80k 300k 1M]
//! ```
//!
//! Each run has a process of its own, so that its peak memory and processor time are its own.

#[allow(dead_code, reason = "it is a program as well")]
#[path = "../meshes/coulomb_drag.rs"]
mod coulomb_drag;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::time::Instant;

use fecontact::case;
use fecontact::model::Model;
use fecontact::run::observer::{Attempt, Observer};
use fecontact::run::run;

/// Name of a size, and the N and B of its mesh.
const SIZES: [(&str, i64, i64); 5] =
    [("5k", 22, 28), ("20k", 45, 58), ("80k", 91, 118), ("300k", 176, 228), ("1M", 321, 416)];

const HEAD: &str = "| dofs | threads | solves (factorizations) | processor s | wall s | start | assembly | contact | linear | MiB | F_n pressed | F_t, drag 12 | F_t end | F_n end |";

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [one, case, threads] = &arguments[..]
        && one == "one"
    {
        return row(Path::new(case), threads.parse()?);
    }
    if let Some(unknown) = arguments.iter().find(|wanted| SIZES.iter().all(|(name, ..)| name != wanted)) {
        return Err(format!("no size is called {unknown}: 5k, 20k, 80k, 300k or 1M").into());
    }
    println!("{HEAD}\n|{}", "---|".repeat(HEAD.matches('|').count() - 1));
    for (name, n, b) in SIZES {
        if !arguments.is_empty() && !arguments.iter().any(|wanted| wanted == name) {
            continue;
        }
        let case = prepare(name, n, b)?;
        for threads in ["1", "2"] {
            Command::new(std::env::current_exe()?)
                .args(["one".as_ref(), case.as_os_str(), threads.as_ref()])
                .status()?;
        }
    }
    Ok(())
}

/// Mesh and case of a size, in a folder for temporary files.
fn prepare(name: &str, n: i64, b: i64) -> Result<PathBuf, Box<dyn Error>> {
    let folder = std::env::temp_dir().join("fecontact_scaling");
    fs::create_dir_all(&folder)?;
    let mesh = folder.join(format!("{name}.msh"));
    if !mesh.exists() {
        coulomb_drag::write(n, b, &mesh)?;
    }
    let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("../cases/coulomb_drag_5k.json");
    let mut case: serde_json::Value = serde_json::from_str(&fs::read_to_string(model)?)?;
    case["mesh"] = mesh.display().to_string().into();
    case["output"] = serde_json::json!({"fields": false});
    let path = folder.join(format!("{name}.json"));
    fs::write(&path, case.to_string())?;
    Ok(path)
}

/// Normal and tangential force on the first contact after each increment.
#[derive(Default)]
struct Forces(Vec<[f64; 2]>);

impl Observer for Forces {
    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), fecontact::run::error::Error> {
        let Some(state) = attempt.accepted else { return Ok(()) };
        let x = model.configuration(&state.displacement);
        let points = model.contacts[0].points.iter().zip(&state.contacts[0]);
        self.0.push(points.fold([0.0; 2], |[normal, tangential], (point, contact)| {
            let length = point.current_length(&x);
            [normal + length * contact.friction.pressure, tangential + length * contact.friction.traction]
        }));
        Ok(())
    }
}

/// Run one case and print its row.
fn row(path: &Path, threads: usize) -> Result<(), Box<dyn Error>> {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    let clock = Instant::now();
    let case = case::read(path)?;
    let model = case::build(&case, path)?;
    let start = clock.elapsed().as_secs_f64();
    let mut forces = Forces::default();
    let model = Arc::new(model);
    let (report, result) = run(&model, &mut [&mut forces]);
    result?;
    let Forces(forces) = forces;
    let seconds = report.wall_s;
    println!(
        "| {} | {threads} | {} ({}) | {:.2} | {:.2} | {start:.2} | {:.2} | {:.2} | {:.2} | {:.0} | {:.0} | {:.0} | {:.0} | {:.0} |",
        model.dofs(),
        report.newton_iterations,
        report.factorizations,
        processor_seconds()?,
        start + seconds.total,
        seconds.assembly,
        seconds.contact,
        seconds.linear,
        peak_memory_mib()?,
        forces[4][0],
        forces[16][1],
        forces[24][1],
        forces[24][0],
    );
    Ok(())
}

/// User and system time of this process, in the ticks of 1/100 s that Linux counts in.
fn processor_seconds() -> Result<f64, Box<dyn Error>> {
    let status = fs::read_to_string("/proc/self/stat")?;
    let after_name = status.rsplit(')').next().unwrap_or_default();
    let ticks = after_name.split_whitespace().skip(11).take(2).map(str::parse::<f64>);
    Ok(ticks.sum::<Result<f64, _>>()? / 100.0)
}

fn peak_memory_mib() -> Result<f64, Box<dyn Error>> {
    let status = fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap_or_default();
    Ok(line.trim().trim_end_matches("kB").trim().parse::<f64>()? / 1024.0)
}
