//! Teeth of a joint that slide over each other, under a constant load. Right values: Patton's law (Patton, 1966, Multiple modes of shear failure in
//! rock, Proc. 1st Congr. ISRM 1, 509–513), T/N = tan(φ ± i) with tan φ = μ and flanks at the angle i, and the dilation tan i per slip.

use fecontact::model::State;
use fecontact::run::Simulation;
use serde_json::{Value, json};

use crate::common::{self, Blocks, Finished, close, finish, half_way, quadratic};

/// μ, and the angle i
const MU: f64 = 0.2;
const FLANK: f64 = std::f64::consts::FRAC_PI_6;

/// A joint with teeth one long and E = 100, on which a block of two teeth, periodic and without a tooth's tip at its ends, is pressed by `pressure` and
/// dragged; one of the two sides is the slave.
fn joint(quadratic_edges: bool, slave: &str, pressure: f64, drag: f64) -> Value {
    let tooth = |x: f64| -0.5 * FLANK.tan() * (2.0 * x.rem_euclid(1.0) - 1.0).abs();
    let [low, up] = if quadratic_edges { [[24, 4], [16, 8]] } else { [[48, 8], [24, 12]] };
    let mesh = Blocks::default()
        .block("low", low, |s, t| [6.0 * s - 1.0, -1.5 * (1.0 - t) + t * tooth(6.0 * s - 1.0)])
        .block("up", up, |s, t| [2.0 * s + 0.25, (1.0 - t) * tooth(2.0 * s + 0.25) + t])
        .json();
    let mesh = if quadratic_edges { quadratic(&mesh, half_way) } else { mesh };
    let [slave, master] = if slave == "up" { ["up_bottom", "low_top"] } else { ["low_top", "up_bottom"] };
    let body = json!({"material": {"model": "neo_hookean", "E": 100, "nu": 0.3, "density": 1e-4}});
    let step = |name: &str, ux: f64, dt: f64| {
        json!({"name": name, "duration": 1, "dt": {"initial": dt},
               "supports": [{"on": "low_bottom", "ux": 0, "uy": 0}, {"on": "up_top", "ux": ux}],
               "loads": [{"on": "up_top", "traction": {"y": -pressure}}]})
    };
    json!({
        "mesh": mesh,
        "periodic": [["up_left", "up_right"]],
        "bodies": {"low": body, "up": body},
        "contacts": {"c": {"slave": slave, "master": master, "friction": {"law": "coulomb", "mu": MU}}},
        "steps": [step("press", 0.0, 0.25), step("drag", drag, 0.02)],
    })
}

/// The state that is nearest to a time: increments that were cut end elsewhere.
fn near(run: &Finished, time: f64) -> &State {
    let distance = |state: &State| (state.time - time).abs();
    run.states.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("an increment")
}

/// T/N between two times, of the means over the increments that end there: bodies oscillate.
fn ratio(run: &Finished, [start, end]: [f64; 2]) -> f64 {
    let between = run.states.iter().filter(|state| (start..=end).contains(&state.time));
    let [x, y] =
        between.map(|state| run.reaction("low_bottom", state)).fold([0.0; 2], |[x, y], own| [x + own[0], y + own[1]]);
    -x / y
}

/// Mean motion of the loaded side.
fn moved(run: &Finished, time: f64) -> [f64; 2] {
    let (nodes, u) = (run.nodes("up_top"), &near(run, time).displacement);
    [0, 1].map(|i| nodes.iter().map(|node| u[2 * node + i]).sum::<f64>() / nodes.len() as f64)
}

/// Linear and quadratic edges, either side as slave.
const SIDES: [(bool, &str); 4] = [(false, "up"), (false, "low"), (true, "up"), (true, "low")];

/// Up their flanks teeth slide under T/N = tan(φ + i), and open the joint by tan i per slip; elastic teeth lean by a tenth of a percent here.
#[test]
fn teeth_slide_up_by_patton() {
    for (quadratic_edges, slave) in SIDES {
        let run = finish(&joint(quadratic_edges, slave, 0.02, 0.3));
        let what = format!("quadratic edges: {quadratic_edges}, slave: {slave}");
        let right = (MU.atan() + FLANK).tan();
        close(&what, ratio(&run, [1.2, 2.0]), right, 3e-3 * right);
        let [start, end] = [1.4, 2.0].map(|time| moved(&run, time));
        close(&what, (end[1] - start[1]) / (end[0] - start[0]), FLANK.tan(), 3e-3);
    }
}

/// Past their tips, in motion, they slide down under T/N = tan(φ − i); no corner goes through the other side, and energy is in balance but for what
/// increments do not resolve as teeth jump.
#[test]
fn teeth_that_pass_their_tips_slide_down_by_patton() {
    for (quadratic_edges, slave) in SIDES {
        let mut case = joint(quadratic_edges, slave, 0.02, 0.9);
        case["steps"][1]["scheme"] = json!({"hht": {"alpha": -0.1}});
        let what = format!("quadratic edges: {quadratic_edges}, slave: {slave}");
        let run = finish(&case);
        let right = (MU.atan() - FLANK).tan();
        close(&what, ratio(&run, [1.7, 2.0]), right, 0.02 * right.abs());
        let error = run.last().energy.error().abs() / run.last().energy.supplied();
        assert!(error < 0.04, "{what}: {error}");
    }
}

/// Without inertia there is no equilibrium where teeth pass their tips: the traction falls from tan(φ + i) to tan(φ − i) without slip. A run that
/// follows them up to there stops, with slip that runs away, and names the step that goes on.
#[test]
fn a_static_joint_stops_at_its_tips_and_says_so() {
    for slave in ["up", "low"] {
        let mut run = Simulation::new(common::model(&joint(false, slave, 1.0, 0.9)));
        let message = loop {
            match run.next_increment() {
                Ok(Some(_)) => {}
                Ok(None) => panic!("{slave}: it has gone on"),
                Err(stopped) => break stopped.to_string(),
            }
        };
        assert!(
            message.contains("may be unstable here: it slides ever faster") && message.contains("hht"),
            "{message}"
        );
        // The tips meet after a way of 0.5, and 0.5/0.9 of the step; teeth that lean let go later.
        assert!((1.5..1.7).contains(&run.state().time), "{message}");
    }
}
