//! Writes mesh and case of earthquake cycles on a dipping fault that meets the surface: SEAS BP3-QD.
//!
//! ```text
//! cargo run --release --example dipping_fault -- DIP SENSE SIZE REACH YEARS FOLDER [q8]
//! ```
//!
//! The fault goes from (0, 0) down under DIP degrees, through the whole domain; `hang` lies at larger x, `foot` at smaller. SENSE is 1
//! for a thrust and -1 for a normal fault, SIZE the spacing of the nodes on it [m], REACH how far the domain goes to both sides and
//! down [m]. FOLDER gets `bp3.msh` and `bp3.json`, which runs YEARS (of 365 days). The elements are bilinear, or with `q8`, and below
//! 45°, quadratic: bilinear ones that a shallow dip shears are too stiff at every size (at 30° the first event comes four years
//! early, after 203 years instead of 206.8).
//!
//! ```text
//! x = s cos δ ± d,   y = −s sin δ            rows of constant s, columns parallel to the fault
//! ```
//! s: SIZE, or nearly so, down to 40 km, where prescribed slip begins, growing from there; d: half of SIZE at the fault, growing by a
//! tenth a layer (quadratic: SIZE, a quarter, and nodes in the middle). All far sides, the bottom too, move rigidly with half of
//! the plate rate, but for the last edge before the fault, whose end slips.
//!
//! Source of the problem: Erickson et al. (2023), Bull. Seismol. Soc. Am. 113, 499 (BP3-QD); units are m, s and Pa.

use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// Growth of the elements away from the fault, and below 24 km: bilinear and quadratic.
const GROWTH: [f64; 2] = [1.1, 1.25];
/// Friction ends here, down dip [m]
const CREEP: f64 = 40e3;
/// a = A_MAX below the second depth, falls to 0.01 at the first [m]
const TRANSITION: [f64; 2] = [15e3, 18e3];
const A_MIN: f64 = 0.010;
const A_MAX: f64 = 0.025;
/// Plate rate [m/s]
const PLATE: f64 = 1e-9;
const DENSITY: f64 = 2670.0;
const SHEAR_SPEED: f64 = 3464.0;
const PRESSURE: f64 = 50e6;
/// b, f₀, V₀, D_c
const LAW: [f64; 4] = [0.015, 0.6, 1e-6, 0.008];
const YEAR: f64 = 365.0 * 86400.0;
/// Dip below which bilinear elements are sheared too much [°]
const SHALLOW: f64 = 45.0;

#[allow(dead_code, reason = "tests call what it calls")]
fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (given, quadratic) = match arguments.split_last() {
        Some((last, given)) if last == "q8" => (given, true),
        _ => (&arguments[..], false),
    };
    let [dip, sense, size, reach, years, folder] = given else {
        return Err("usage: dipping_fault DIP SENSE SIZE REACH YEARS FOLDER [q8]".into());
    };
    let [dip, sense, size, reach, years]: [f64; 5] =
        [dip.parse()?, sense.parse()?, size.parse()?, reach.parse()?, years.parse()?];
    if !(dip > 0.0 && dip <= 90.0 && sense.abs() == 1.0 && size > 0.0 && reach > CREEP) {
        return Err("DIP is 0 to 90, SENSE 1 or -1, SIZE positive, REACH above 40 km".into());
    }
    let fault = Fault { dip: dip.to_radians(), sense, size, reach, quadratic: quadratic || dip < SHALLOW };
    fs::create_dir_all(folder)?;
    fs::write(Path::new(folder).join("bp3.msh"), fault.mesh())?;
    fs::write(Path::new(folder).join("bp3.json"), fault.case(years, ""))?;
    println!("{folder}: {} degrees of freedom", 4 * fault.grid().len());
    Ok(())
}

/// A dipping fault and its domain.
#[derive(Clone, Copy, Debug)]
pub struct Fault {
    /// δ [rad]
    pub dip: f64,
    /// 1 for a thrust, −1 for a normal fault
    pub sense: f64,
    /// spacing of the nodes on it [m]
    pub size: f64,
    /// half-width and depth of the domain [m]
    pub reach: f64,
    /// Whether elements are quadratic
    pub quadratic: bool,
}

impl Fault {
    /// Nodes along an edge, but for one.
    fn order(&self) -> usize {
        1 + usize::from(self.quadratic)
    }

    fn growth(&self) -> f64 {
        GROWTH[self.order() - 1]
    }

    /// s of the rows of nodes [m]: even where there is friction.
    pub fn depths(&self) -> Vec<f64> {
        // The last end of an edge with friction and the first without share what slips between them by their shape functions,
        // half each or one sixth and five: friction ends at 40 km only where this border of theirs does. What creeps below it loads
        // all above: a border 100 m deeper led to another cycle of earthquakes.
        let share = if self.quadratic { 1.0 / 6.0 } else { 0.5 };
        let edges = (CREEP / (self.size * self.order() as f64) - share).round();
        let edge = CREEP / (edges + share);
        let mut depths: Vec<f64> = (0..=edges as usize + 1).map(|k| k as f64 * edge).collect();
        let last = (edges + 1.0) * edge;
        depths.extend(graded(last, self.reach / self.dip.sin(), edge, [self.growth(), f64::INFINITY]));
        self.with_middles(depths)
    }

    /// d of the columns of nodes [m].
    pub fn offsets(&self) -> Vec<f64> {
        let edge = self.size * self.order() as f64;
        let mut offsets = vec![0.0];
        offsets.extend(graded(0.0, self.reach, 0.5 * edge / self.growth(), [self.growth(), f64::INFINITY]));
        self.with_middles(offsets)
    }

    fn with_middles(&self, ends: Vec<f64>) -> Vec<f64> {
        if !self.quadratic {
            return ends;
        }
        let middle = |pair: &[f64]| [pair[0], 0.5 * (pair[0] + pair[1])];
        ends.windows(2).flat_map(middle).chain(ends.last().copied()).collect()
    }

    /// Column and row of the nodes of a body: none in the middle of elements.
    fn grid(&self) -> Vec<[usize; 2]> {
        let (rows, columns) = (self.depths().len(), self.offsets().len());
        let all = (0..rows).flat_map(move |j| (0..columns).map(move |i| [i, j]));
        all.filter(|[i, j]| !self.quadratic || i % 2 == 0 || j % 2 == 0).collect()
    }

    /// The mesh, in gmsh's format: `foot` and `hang`, their sides `NAME_fault` and `NAME_far`.
    pub fn mesh(&self) -> String {
        let (depths, offsets, grid, order) = (self.depths(), self.offsets(), self.grid(), self.order());
        let (rows, columns) = (depths.len(), offsets.len());
        let mut numbers = vec![0; rows * columns];
        grid.iter().enumerate().for_each(|(k, [i, j])| numbers[j * columns + i] = k + 1);
        let node = |body: usize, i: usize, j: usize| body * grid.len() + numbers[j * columns + i];
        let names = ["foot_fault", "foot_far", "hang_fault", "hang_far", "foot", "hang"];
        let mut out = String::from("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n6\n");
        for (k, name) in names.iter().enumerate() {
            let _ = writeln!(out, "{} {} \"{name}\"", if k < 4 { 1 } else { 2 }, k + 1);
        }
        out += "$EndPhysicalNames\n$Entities\n0 4 2 0\n";
        (1..=6).for_each(|tag| _ = writeln!(out, "{tag} 0 0 0 0 0 0 1 {tag} 0"));
        let _ = writeln!(out, "$EndEntities\n$Nodes\n2 {0} 1 {0}", 2 * grid.len());
        for body in 0..2 {
            let _ = writeln!(out, "2 {} 0 {}", 5 + body, grid.len());
            grid.iter().for_each(|&[i, j]| _ = writeln!(out, "{}", node(body, i, j)));
            for &[i, j] in &grid {
                let (s, d) = (depths[j], if body == 0 { -offsets[i] } else { offsets[i] });
                let _ = writeln!(out, "{} {} 0", s * self.dip.cos() + d, -s * self.dip.sin());
            }
        }
        // Ends, and the middle of what is quadratic.
        let edge = |body: usize, a: [usize; 2], b: [usize; 2]| {
            let middle = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
            let all = [a, b, middle];
            all[..1 + order].iter().map(|[i, j]| node(body, *i, *j).to_string()).collect::<Vec<_>>().join(" ")
        };
        let down = |body: usize, i: usize| {
            (0..rows - 1).step_by(order).map(move |j| edge(body, [i, j], [i, j + order])).collect::<Vec<_>>()
        };
        let far = |body: usize| {
            // The last edge before the fault is free.
            let bottom = (order..columns - 1).step_by(order);
            let bottom = bottom.map(move |i| edge(body, [i, rows - 1], [i + order, rows - 1]));
            down(body, columns - 1).into_iter().chain(bottom).collect::<Vec<_>>()
        };
        let lines: Vec<Vec<String>> = [0, 1].into_iter().flat_map(|body| [down(body, 0), far(body)]).collect();
        let cells = (rows - 1) / order * ((columns - 1) / order);
        let count = lines.iter().map(Vec::len).sum::<usize>() + 2 * cells;
        let _ = writeln!(out, "$EndNodes\n$Elements\n6 {count} 1 {count}");
        let mut tag = 0;
        for (k, edges) in lines.iter().enumerate() {
            let _ = writeln!(out, "1 {} {} {}", k + 1, if self.quadratic { 8 } else { 1 }, edges.len());
            for nodes in edges {
                tag += 1;
                let _ = writeln!(out, "{tag} {nodes}");
            }
        }
        for body in 0..2 {
            let _ = writeln!(out, "2 {} {} {cells}", 5 + body, if self.quadratic { 16 } else { 3 });
            let corners =
                (0..rows - 1).step_by(order).flat_map(|j| (0..columns - 1).step_by(order).map(move |i| [i, j]));
            for [i, j] in corners {
                tag += 1;
                let (left, right) = if body == 0 { (i + order, i) } else { (i, i + order) };
                let (below, mid) = (j + order, [i + 1, j + 1]);
                let all = [
                    [left, below],
                    [right, below],
                    [right, j],
                    [left, j],
                    [mid[0], below],
                    [right, mid[1]],
                    [mid[0], j],
                    [left, mid[1]],
                ];
                let nodes = all[..4 * order].iter().map(|[i, j]| node(body, *i, *j).to_string());
                let _ = writeln!(out, "{tag} {}", nodes.collect::<Vec<_>>().join(" "));
            }
        }
        out + "$EndElements\n"
    }

    /// The case, with further keys of its scheme, such as `"every": 1`.
    pub fn case(&self, years: f64, scheme: &str) -> String {
        let Self { dip, sense, size, .. } = *self;
        let [b, f_0, v_0, d_c] = LAW;
        let modulus = DENSITY * SHEAR_SPEED * SHEAR_SPEED;
        let alpha = 1000.0 * modulus / size;
        let damping = 0.5 * modulus / SHEAR_SPEED;
        let traction =
            PRESSURE * A_MAX * (PLATE / (2.0 * v_0) * ((f_0 + b * (v_0 / PLATE).ln()) / A_MAX).exp()).asinh()
                + damping * PLATE;
        let theta = |a: f64| {
            let sliding = ((traction - damping * PLATE) / (a * PRESSURE)).sinh();
            d_c / v_0 * (a / b * (2.0 * v_0 / PLATE * sliding).ln() - f_0 / b).exp()
        };
        let a = |s: f64| {
            let share = (s - TRANSITION[0]) / (TRANSITION[1] - TRANSITION[0]);
            A_MIN + (A_MAX - A_MIN) * share.clamp(0.0, 1.0)
        };
        // At the nodes, from below; nothing varies beyond those around the transition.
        let mut rows: Vec<f64> = self.depths();
        rows.retain(|s| (TRANSITION[0] - size..=TRANSITION[1] + size).contains(s));
        rows.reverse();
        let table = |value: &dyn Fn(f64) -> f64| {
            let pairs: Vec<String> = rows.iter().map(|s| format!("[{:e}, {:e}]", -s * dip.sin(), value(*s))).collect();
            pairs.join(", ")
        };
        // The hanging wall of a thrust goes up dip, against s.
        let rate = -sense * PLATE;
        let half = [0.5 * rate * dip.cos(), -0.5 * rate * dip.sin()];
        let body = format!(
            "{{\"material\": {{\"model\": \"linear\", \"E\": {:e}, \"nu\": 0.25, \"density\": {DENSITY}}}}}",
            2.5 * modulus
        );
        let supports = |sign: f64| {
            format!("\"ux\": {{\"rate\": {:e}}}, \"uy\": {{\"rate\": {:e}}}", sign * half[0], sign * half[1])
        };
        format!(
            r#"{{
  "title": "SEAS BP3-QD: earthquake cycles on a fault under {:.0} degrees",
  "units": {{"length": "m", "time": "s", "force": "N"}},
  "mesh": "bp3.msh",
  "bodies": {{"foot": {body}, "hang": {body}}},
  "contacts": {{
    "fault": {{
      "slave": "hang_fault", "master": "foot_fault", "method": "node_to_segment", "sliding": "small",
      "normal": {{"alpha_n": {alpha:e}}}, "radiation_damping": true,
      "friction": {{"law": "rate_and_state", "f_0": {f_0}, "V_0": {v_0}, "a": {A_MIN}, "b": {b}, "D_c": {d_c}, "alpha_t": {alpha:e}}},
      "along": {{
        "a": {{"y": [{}]}},
        "theta": {{"y": [{}]}},
        "law": [{{"where": "-y - {:e}", "friction": {{"law": "prescribed", "slip_rate": {rate:e}, "alpha_t": {alpha:e}}}}}]
      }},
      "initial": {{"pressure": {PRESSURE:e}, "traction": {:e}, "balanced": true}}
    }}
  }},
  "steps": [{{
    "name": "cycles", "duration": {:e}, "scheme": {{"quasi_dynamic": {{"tolerance": 1e-5{scheme}}}}}, "dt": {{"initial": 1}},
    "supports": [{{"on": "foot_far", {}}}, {{"on": "hang_far", {}}}]
  }}],
  "probes": {{"foot_16": {{"at": [-16e3, 0]}}, "trace": {{"at": [1, 0], "body": "hang"}}, "hang_16": {{"at": [16e3, 0]}}}},
  "output": {{"fields": false}}
}}
"#,
            dip.to_degrees(),
            table(&a),
            table(&|s| theta(a(s))),
            CREEP * dip.sin(),
            -sense * traction,
            years * YEAR,
            supports(-1.0),
            supports(1.0),
        )
    }
}

/// Nodes from one place to another, the first excluded: spacings that grow from `first` by a factor and stay below `most`.
fn graded(from: f64, to: f64, first: f64, [growth, most]: [f64; 2]) -> Vec<f64> {
    let mut nodes = Vec::new();
    let (mut at, mut spacing) = (0.0, first);
    while at < to - from {
        spacing = (growth * spacing).min(most);
        at += spacing;
        nodes.push(at);
    }
    // Stretched, so that the last falls on the end.
    let share = (to - from) / at;
    nodes.into_iter().map(|node| from + share * node).collect()
}
