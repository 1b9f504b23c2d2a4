//! Newton's method by itself, on equations in one unknown; and what it accepts on whole models.

use crate::common::{self, Blocks, Finished, close, expression, finish, floor, linear, neo_hookean, run_through};
use fecontact::laws::friction::CoulombParameters;
use fecontact::linear::system::Request;
use fecontact::linear::system::System;
use fecontact::linear::{Multifrontal, Pattern, SparseMatrix};
use fecontact::model::builder::{Contact, IncrementSettings, Load, LoadStep, Support};
use fecontact::model::{Method, Model, NewtonSettings};
use fecontact::run::Simulation;
use fecontact::solve::newton::{Equations, Iteration, NewtonFailure, Settings, solve};
use serde_json::{Value, json};

/// Iterations made, and the root or the reason why there is none.
type Iterated = (Vec<Iteration>, Result<Vec<f64>, NewtonFailure<()>>);

/// Solve r(u) = 0 from a start value; `equation` gives r and r′, or fails.
fn root(start: f64, equation: impl Fn(f64) -> Result<[f64; 2], ()>) -> Iterated {
    root_or_shorter(start, false, equation)
}

/// The same, in an increment that is given up where iterations stall if `gives_up`.
fn root_or_shorter(start: f64, gives_up: bool, equation: impl Fn(f64) -> Result<[f64; 2], ()>) -> Iterated {
    let pattern = std::sync::Arc::new(Pattern::new(1, std::iter::once(&[0usize][..])));
    let tangent = SparseMatrix::zero(pattern);
    let mut system = System { residual: vec![0.0; 2], tangent, forces: 1.0, imbalance: 1.0 };
    let settings = Settings { tolerance: 1e-12, max_iterations: 30, old_tangents: true, downhill: true, gives_up };
    let mut iterations = Vec::new();
    let found = solve(
        &mut Unknown(equation),
        vec![start, 0.0],
        settings,
        &mut Multifrontal::default(),
        &mut system,
        &mut iterations,
    );
    (iterations, found)
}

/// An equation in one unknown, given as r and r′.
struct Unknown<F>(F);

impl<F: Fn(f64) -> Result<[f64; 2], ()>> Equations for Unknown<F> {
    type Failure = ();

    fn evaluate(&mut self, u: &[f64], request: Request, system: &mut System) -> Result<(), ()> {
        let [r, slope] = (self.0)(u[0])?;
        system.residual = vec![r, 0.0];
        system.imbalance = r.abs();
        if request == Request::Tangent {
            system.tangent.clear();
            system.tangent.add_diagonal(0, slope);
            system.tangent.add_diagonal(1, 1.0);
        }
        Ok(())
    }

    fn work(&self, _: &[f64], residual: &[f64], way: &[f64]) -> f64 {
        residual[0] * way[0]
    }
}

/// The correction of atan(u) = 0 from u = 1.6 leads to −2.5, which is out of bounds here, and that is told; from u = 1 it
/// leads to the root.
#[test]
fn a_correction_out_of_bounds_is_reported() {
    let bounded = |u: f64| if u.abs() < 2.0 { Ok([u.atan(), 1.0 / (1.0 + u * u)]) } else { Err(()) };
    assert_eq!(root(1.6, bounded).1, Err(NewtonFailure::Evaluation(())));
    let (iterations, result) = root(1.0, bounded);
    assert!(result.expect("a root")[0].abs() < 1e-12 && iterations.len() < 8, "{iterations:?}");
}

/// The corrections of sgn(u) √|u| = 0 lead from u to −u for ever, and from u = 1 those of u/√(1 + u²) = 0 to −u³ = −1. Both
/// are slopes of a potential with one minimum, |u|^(3/2) and √(1 + u²), and gone down in it they lead to the root.
#[test]
fn a_cycle_is_left_by_going_downhill() {
    let kinked = |u: f64| Ok([u.signum() * u.abs().sqrt(), 0.5 / u.abs().max(1e-300).sqrt()]);
    let smooth = |u: f64| Ok([u / u.hypot(1.0), u.hypot(1.0).powi(-3)]);
    for (what, (iterations, result)) in [("kinked", root(1.0, kinked)), ("smooth", root(1.0, smooth))] {
        println!("{what}: {} solves", iterations.len());
        let root = result.unwrap_or_else(|failure| panic!("{what}: {failure:?}"))[0];
        assert!(root.abs() < 1e-12 && iterations.len() <= 8, "{what}: {root} after {} solves", iterations.len());
    }
}

/// |u| + 1 has no root, and from u = 1 the corrections lead to −1 and back for ever, as do those of a step-wise equation over three values.
/// Both are given up once a circle was gone round twice, long before the 30 iterations.
#[test]
fn a_circle_without_a_root_is_given_up() {
    let two = |u: f64| Ok([u.abs() + 1.0, u.signum()]);
    let three = |u: f64| Ok([[1.0, -1.0], [1.0, -1.0], [2.0, 1.0]][u.round() as usize]);
    for (around, (iterations, result)) in [(2, root(1.0, two)), (3, root(0.0, three))] {
        let Err(NewtonFailure::Circles { period, .. }) = result else { panic!("{around}: {result:?}") };
        assert_eq!(period, around);
        assert!(iterations.len() <= 2 + 2 * around, "{around}: {} solves", iterations.len());
    }
}

/// A residual that goes to and fro between two values little above the tolerance, as round-off does, is no circle.
#[test]
fn round_off_is_no_circle() {
    let noise = |u: f64| Ok([3e-12, u.signum()]);
    let (iterations, result) = root(1e-12, noise);
    assert!(matches!(result, Err(NewtonFailure::TooManyIterations { .. })), "{result:?} after {}", iterations.len());
}

/// The corrections of u⁵ = 0 leave four fifths of u, those of sgn(u) |u|^(0.502) = 0 lead to −0.992 u: slow, but no circle.
#[test]
fn slow_convergence_is_no_circle() {
    let one_sided = |u: f64| Ok([u.powi(5), 5.0 * u.powi(4)]);
    let to_and_fro = |u: f64| Ok([u.signum() * u.abs().powf(0.502), 0.502 * u.abs().powf(-0.498)]);
    assert!(root(1.0, one_sided).1.is_ok());
    assert!(matches!(root(1.0, to_and_fro).1, Err(NewtonFailure::TooManyIterations { .. })));
}

/// u² + 1 has no root, and its corrections lead from cot φ to cot 2φ: to and fro without a circle, and never below 1. They are given up
/// where a shorter increment may follow, after eight of them, and otherwise after all 30. Those of u⁵ = 0 leave a third of it, and seven steps
/// of one lead to where an equation falls from −1.06 to its root: neither is given up.
#[test]
fn corrections_that_halve_nothing_are_given_up_where_a_shorter_increment_may_follow() {
    let without = |u: f64| Ok([u * u + 1.0, 2.0 * u]);
    let start = 1.0 / 0.7f64.tan();
    let (iterations, result) = root_or_shorter(start, true, without);
    assert!(matches!(result, Err(NewtonFailure::Stalled { .. })), "{result:?}");
    assert!((8..=11).contains(&iterations.len()), "{} solves", iterations.len());
    let (iterations, result) = root_or_shorter(start, false, without);
    assert!(matches!(result, Err(NewtonFailure::TooManyIterations { .. })) && iterations.len() == 30, "{result:?}");
    let slow = |u: f64| Ok([u.powi(5), 5.0 * u.powi(4)]);
    assert!(root_or_shorter(1.0, true, slow).1.is_ok());
    let steps = |u: f64| Ok(if u < 7.0 { [-1.0 - 0.01 * u, 1.0 + 0.01 * u] } else { [u - 7.0, 1.0] });
    let (iterations, result) = root_or_shorter(0.0, true, steps);
    assert!(result.is_ok() && iterations.len() == 7, "{result:?} after {}", iterations.len());
}

/// From u = 1.1 the corrections of u/√(1 + u²) = 0 lead to −1.3, 2.4 and −13, farther than the equation can be evaluated
/// here: the search ends within.
#[test]
fn a_search_stays_where_the_equations_can_be_evaluated() {
    let bounded = |u: f64| if u.abs() < 5.0 { Ok([u / u.hypot(1.0), u.hypot(1.0).powi(-3)]) } else { Err(()) };
    let (iterations, result) = root(1.1, bounded);
    let root = result.expect("a root")[0];
    assert!(root.abs() < 1e-12 && iterations.len() <= 8, "{root} after {} solves", iterations.len());
}

/// Blocks of foam pressed on a ground of foam and dragged over it by Coulomb's law. `scale` multiplies what is prescribed; a
/// body of steel beside it of this modulus, if there is one, is pressed by 1 %.
fn foam(steel: Option<f64>, tolerance: f64, scale: f64) -> Finished {
    let beside = |mesh: Blocks| mesh.rectangle("steel", [10, 10], [10.0, 0.0], [11.0, 1.0]);
    let mesh = steel.map_or(Blocks::default(), |_| beside(Blocks::default()));
    let mesh =
        mesh.rectangle("ground", [24, 4], [0.0, -0.6], [4.0, 0.0]).rectangle("foam", [9, 4], [1.0, 0.0], [2.0, 0.6]);
    let foam = || neo_hookean(0.05, 0.3, 0.0);
    let top = |y: f64| Support::on("foam_top").ux(0.0).uy(y);
    let mut press = LoadStep::new("press", 1.0).dt(0.5).fix("ground_bottom").support(top(-1e-2 * scale));
    let mut model = Model::builder(mesh.mesh()).body("ground", foam()).body("foam", foam());
    if let Some(young) = steel {
        model = model.body("steel", neo_hookean(young, 0.3, 0.0));
        press = press.fix("steel_bottom").support(Support::on("steel_top").ux(0.0).uy(-0.01));
    }
    let settings = IncrementSettings { max: Some(0.1), ..IncrementSettings::from(0.1) };
    let drag = LoadStep::new("drag", 1.0).dt(settings).support(Support::on("foam_top").ux(2e-2 * scale));
    let contact = Contact::new("base", "foam_bottom", "ground_top", CoulombParameters::new(0.3));
    let contact = contact.method(Method::GaussToSegment).alpha_n(4.487);
    run_through(model.contact(contact).newton(solved_to(tolerance)).step(press).step(drag))
}

fn solved_to(tolerance: f64) -> NewtonSettings {
    NewtonSettings { tolerance, ..NewtonSettings::default() }
}

/// Forces on the top of the foam after every increment, over `scale`.
fn forces(run: &Finished, scale: f64) -> Vec<[f64; 2]> {
    run.states.iter().map(|state| run.reaction("foam_top", state).map(|f| f / scale)).collect()
}

/// Largest difference, relative to the largest force.
fn difference(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    assert_eq!(a.len(), b.len());
    common::distance(a.as_flattened(), b.as_flattened()) / a.as_flattened().iter().fold(0.0, |m: f64, f| m.max(f.abs()))
}

/// Steel strained by 1 % beside the foam touches nothing. Its forces, 10⁴ to 10⁹ times larger, are no measure of the foam's.
/// The reference is the foam alone, solved to round-off.
#[test]
fn a_body_that_touches_nothing_hides_no_imbalance() {
    let alone = forces(&foam(None, 1e-13, 1.0), 1.0);
    for steel in [50.0, 2e5, 2e7] {
        close(&format!("E = {steel}"), difference(&alone, &forces(&foam(Some(steel), 1e-8, 1.0), 1.0)), 0.0, 1e-7);
    }
}

/// Foam on rubber on a steel plate.
fn stack(tolerance: f64, steps: Value) -> Value {
    let material = |e: f64| json!({"material": {"model": "neo_hookean", "E": e, "nu": 0.3}});
    let contact = |slave: &str, master: &str| json!({"slave": slave, "master": master, "friction": {"law": "coulomb", "mu": 0.3}});
    let mesh = Blocks::default()
        .rectangle("steel", [12, 3], [0.0, -0.5], [4.0, 0.0])
        .rectangle("rubber", [11, 3], [0.5, 0.0], [3.0, 0.5])
        .rectangle("foam", [9, 3], [1.0, 0.5], [2.0, 1.0]);
    json!({
        "mesh": mesh.json(),
        "bodies": {"steel": material(2e5), "rubber": material(1.0), "foam": material(0.05)},
        "contacts": {"lower": contact("rubber_bottom", "steel_top"), "upper": contact("foam_bottom", "rubber_top")},
        "newton": {"tolerance": tolerance},
        "steps": steps,
    })
}

/// Foam on rubber on a steel plate that is stretched by 1 %: in one stack as well every body and every contact is in
/// equilibrium by itself. The reference is the same solved to round-off.
#[test]
fn a_stiff_body_in_a_stack_hides_no_imbalance() {
    let stack = |tolerance: f64| {
        let mesh = Blocks::default()
            .rectangle("steel", [12, 3], [0.0, -0.5], [4.0, 0.0])
            .rectangle("rubber", [11, 3], [0.5, 0.0], [3.0, 0.5])
            .rectangle("foam", [9, 3], [1.0, 0.5], [2.0, 1.0]);
        let press = LoadStep::new("press", 1.0).dt(0.25).fix("steel_bottom");
        let stretched = |text: &str| Support::on("steel_bottom").ux(expression(text));
        let stretch = LoadStep::new("stretch", 1.0).dt(0.1).support(stretched("0.01*(x-1.5)*(t-1)"));
        let drag = LoadStep::new("drag", 1.0).dt(0.1).support(stretched("0.01*(x-1.5)"));
        let model = Model::builder(mesh.mesh())
            .body("steel", neo_hookean(2e5, 0.3, 0.0))
            .body("rubber", neo_hookean(1.0, 0.3, 0.0))
            .body("foam", neo_hookean(0.05, 0.3, 0.0))
            .contact(Contact::new("lower", "rubber_bottom", "steel_top", CoulombParameters::new(0.3)))
            .contact(Contact::new("upper", "foam_bottom", "rubber_top", CoulombParameters::new(0.3)))
            .newton(solved_to(tolerance))
            .step(press.support(Support::on("foam_top").ux(0.0).uy(-5e-2)))
            .step(stretch)
            .step(drag.support(Support::on("foam_top").ux(2e-2)));
        run_through(model)
    };
    let [loose, tight] = [1e-8, 1e-13].map(|tolerance| forces(&stack(tolerance), 1.0));
    close("forces on the foam", difference(&tight, &loose), 0.0, 1e-7);
}

/// A slab of 2m × m elements that rests on the ground without pressure, a plane or a block, pressed and sheared at once.
fn sheared(m: usize, mu: f64, [ux, uy]: [f64; 2], elastic_ground: bool) -> Finished {
    let elastic = json!({"material": {"model": "linear", "E": 1000, "nu": 0.3}});
    let mut blocks = Blocks::default().rectangle("slab", [2 * m, m], [0.0, 0.0], [1.0, 0.5]);
    let mut bodies = json!({"slab": elastic});
    let mut supports = json!([{"on": "slab_top", "ux": ux, "uy": uy}]);
    let mut master = json!({"plane": {"point": [0, 0], "normal": [0, 1]}});
    if elastic_ground {
        blocks = blocks.rectangle("ground", [4 * m + 1, m], [-0.5, -0.5], [1.5, 0.0]);
        bodies["ground"] = elastic;
        supports.as_array_mut().expect("a list").push(json!({"on": "ground_bottom", "ux": 0, "uy": 0}));
        master = json!("ground_top");
    }
    finish(&json!({
        "mesh": blocks.json(), "bodies": bodies,
        "contacts": {"base": {"slave": "slab_bottom", "master": master, "method": "gauss_to_segment",
                              "normal": {"alpha_n": 1e6}, "friction": {"law": "coulomb", "mu": mu, "alpha_t": 1e6}}},
        "steps": [{"name": "shear", "duration": 1, "dt": {"initial": 1}, "supports": supports}],
    }))
}

/// Slabs whose points slip one way and the other past a narrow range of sticking, in cycles of four to six exact tangents,
/// the same however short the increment. The forces on the top are those of an independent program for this problem alone
/// (elements of small strain, points with q = ±μ p or α_t s over current lengths, dense Newton's method with a
/// backtracking line search, α_n = α_t raised from 100 to 10⁶ in 16 steps).
#[test]
fn slabs_sheared_from_no_pressure_have_the_forces_of_an_independent_program() {
    for (m, mu, motion, forces) in [
        (2, 0.2, [0.00333, -0.005], [1.7587815218865, -12.0090564284998]),
        (2, 0.2, [0.001665, -0.0025], [0.8793886355331, -6.0045060480408]),
        (4, 0.3, [0.0, -0.005], [0.0, -12.2231698282913]),
    ] {
        let run = sheared(m, mu, motion, false);
        let found = run.reaction("slab_top", run.last());
        println!("m = {m}: {found:?} after {:?} solves", run.iterations);
        assert_eq!((run.report.increments, run.report.cutbacks), (1, 0));
        (0..2).for_each(|i| close(&format!("m = {m}, force {i}"), found[i], forces[i], 1e-8 * forces[1].abs()));
    }
}

/// Whatever the mesh, the friction and the direction, such a slab is solved in one increment.
#[test]
fn slabs_sheared_from_no_pressure_are_solved_at_once() {
    let mut most = 0;
    for (m, elastic_ground) in [1, 2, 3, 4].into_iter().flat_map(|m| [(m, false), (m, true)]) {
        for (mu, ux) in
            [0.1, 0.2, 0.3, 0.6, 1.0].into_iter().flat_map(|mu| [0.0, 0.001, 0.00333, 0.01].map(|ux| (mu, ux)))
        {
            let run = sheared(m, mu, [ux, -0.005], elastic_ground);
            let what = format!("m = {m}, mu = {mu}, ux = {ux}, elastic ground: {elastic_ground}");
            assert_eq!((run.report.increments, run.report.cutbacks), (1, 0), "{what}");
            most = run.iterations.iter().copied().fold(most, usize::max);
        }
    }
    println!("at most {most} solves");
    assert!(most <= 20, "{most} solves");
}

/// Foam on rubber on a steel plate that is stretched while they are pressed on it: every increment is solved without a cut.
#[test]
fn a_stack_is_pressed_on_a_plate_that_stretches() {
    let run = finish(&stack(
        1e-8,
        json!([
            {"name": "press", "duration": 1, "dt": {"initial": 0.25},
             "supports": [{"on": "steel_bottom", "ux": "0.01*(x-1.5)*t", "uy": 0}, {"on": "foam_top", "ux": 0, "uy": -5e-2}]},
        ]),
    ));
    println!("{:?} solves", run.iterations);
    assert_eq!((run.report.increments, run.report.cutbacks), (4, 0));
}

/// Supports that move by 10⁻⁷ to 10⁻¹² of an element: the forces are those of a motion a thousand times larger, over
/// a thousand, as far as gaps of that size are known: to ε h in h times the motion.
#[test]
fn no_motion_is_too_small_to_be_solved_for() {
    let reference = forces(&foam(None, 1e-8, 1e-4), 1e-4);
    for (scale, allowed) in [(1e-6, 2e-4), (1e-8, 1e-4), (1e-10, 1e-2)] {
        let run = foam(None, 1e-8, scale);
        close(&format!("{scale:e}"), difference(&reference, &forces(&run, scale)), 0.0, allowed);
        let top = run.nodes("foam_top")[0];
        close("prescribed", run.last().displacement[2 * top], 2e-2 * scale, 1e-12 * scale);
    }
    // Far below what gaps are known to, supports are still met, and no increment is accepted without a solve.
    let run = foam(None, 1e-8, 1e-14);
    let top = run.nodes("foam_top")[0];
    close("prescribed", run.last().displacement[2 * top], 2e-16, 1e-28);
    assert!(run.iterations.iter().all(|iterations| *iterations > 0));
}

/// A block on a rigid plane pressed by 150 MPa from its left and 50 MPa from above (after the GRECO block of
/// `cases/validation`), 2³⁸ from the origin: all nodes are multiples of 2.5, and so exact. The pressures must not be taken for
/// round-off of the positions.
#[test]
fn loads_far_from_the_origin_are_solved_for() {
    let tractions = |shift: f64| {
        let mesh = Blocks::default().rectangle("block", [16, 16], [shift, 0.0], [shift + 40.0, 40.0]);
        let load = LoadStep::new("load", 1.0).dt(0.1).support(Support::on("block_right").ux(0.0));
        let contact =
            Contact::new("base", "block_bottom", floor(), CoulombParameters::new(1.0)).method(Method::NodeToSegment);
        let run = run_through(
            Model::builder(mesh.mesh())
                .body("block", linear(130000.0, 0.2, 0.0))
                .contact(contact)
                .step(load.load(Load::pressure("block_left", 150.0)).load(Load::pressure("block_top", 50.0))),
        );
        let friction = run.last().contacts[0].iter().map(|point| [point.friction.pressure, point.friction.traction]);
        friction.collect::<Vec<_>>()
    };
    let near = tractions(0.0);
    let pressure = near.iter().map(|[p, _]| 2.5 * p).sum::<f64>();
    assert!((pressure / 2000.0 - 1.0).abs() < 0.1, "the bottom carries most of 40 × 50: {pressure}");
    close("tractions", difference(&near, &tractions(2f64.powi(38))), 0.0, 1e-9);
}

/// Hill's tube of a perfectly plastic material, b = 2 a, bears (2/√3) ln 2 = 0.80038 σ_y. Under a pressure that grows beyond it the run
/// stops there and says that this may be a limit point, with the pressure that it had reached; one that has not yielded says no such thing.
#[test]
fn a_run_that_meets_a_limit_point_under_forces_says_so() {
    let stopped = |pressure: f64, min: f64, newton: Value| {
        let block = json!({"body": "tube", "corners": [[1, 0], [2, 0], [2, 0.1], [1, 0.1]], "elements": [10, 1],
                           "sides": ["bottom", null, "top", "bore"], "kind": "Q8"});
        let mut run = Simulation::new(common::model(&json!({
            "section": "axisymmetric", "mesh": {"blocks": [block]}, "newton": newton,
            "bodies": {"tube": {"material": {"model": "von_mises", "E": 1e4, "nu": 0.3, "sigma_y": 1}, "element": "reduced"}},
            "steps": [{"name": "press", "duration": 1, "dt": {"initial": 0.1, "min": min, "max": 0.1},
                       "supports": [{"on": "bottom", "uy": 0}, {"on": "top", "uy": 0}],
                       "loads": [{"on": "bore", "pressure": pressure}]}]
        })));
        loop {
            match run.next_increment() {
                Ok(Some(_)) => {}
                Ok(None) => return String::new(),
                Err(stopped) => return stopped.to_string(),
            }
        }
    };
    assert_eq!(stopped(0.79, 1e-4, json!({})), "");
    let message = stopped(2.0, 1e-4, json!({}));
    let (_, reached) = message
        .split_once("this may be a limit point")
        .and_then(|(_, rest)| rest.split_once("pressure "))
        .expect(&message);
    let reached: f64 = reached.split(' ').next().expect("a number").parse().expect("a number");
    assert!((0.79..0.8008).contains(&reached), "{message}");
    let message = stopped(0.4, 0.1, json!({"max_iterations": 1, "tolerance": 1e-15}));
    assert!(message.contains("no equilibrium within 1 iteration") && !message.contains("limit point"), "{message}");
}

/// Slip weakening on a rigid plane is unstable once it weakens, over the length that slips, by more than 1.158 G/(1 − ν) per slip (Uenishi &
/// Rice 2003): a run that stops there says so, with the weakening. A thousandth of it lets the block slide to the end, and a run that stops
/// for another reason says no such thing.
#[test]
fn a_run_that_meets_unstable_slip_says_so() {
    let stopped = |critical_slip: f64, newton: Value| {
        let block = json!({"body": "block", "corners": [[0, 0], [4, 0], [4, 2], [0, 2]], "elements": [8, 4],
                           "sides": ["foot", null, "top", null]});
        let mut run = Simulation::new(common::model(&json!({
            "mesh": {"blocks": [block]}, "newton": newton,
            "bodies": {"block": {"material": {"model": "linear", "E": 1000, "nu": 0.3}}},
            "contacts": {"base": {"slave": "foot", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
                                  "friction": {"law": "slip_weakening", "mu_s": 0.6, "mu_d": 0.3, "D_c": critical_slip}}},
            "steps": [{"name": "press", "duration": 1, "dt": {"initial": 1}, "supports": [{"on": "top", "ux": 0, "uy": -0.02}]},
                      {"name": "drag", "duration": 1, "dt": {"initial": 0.05}, "supports": [{"on": "top", "ux": 0.05}]}]
        })));
        loop {
            match run.next_increment() {
                Ok(Some(_)) => {}
                Ok(None) => return String::new(),
                Err(stopped) => return stopped.to_string(),
            }
        }
    };
    assert_eq!(stopped(2.0, json!({})), "");
    let message = stopped(0.002, json!({}));
    let (_, weakening) = message.split_once("friction weakens by up to ").expect(&message);
    let weakening: f64 = weakening.split(' ').next().expect("a number").parse().expect("a number");
    let modulus = 1000.0 / 2.6 / 0.7;
    assert!(message.contains("may be unstable here") && weakening > 1.158 * modulus, "{message}");
    let message = stopped(2.0, json!({"max_iterations": 1, "tolerance": 1e-15}));
    assert!(message.contains("no equilibrium within 1 iteration") && !message.contains("unstable"), "{message}");
}
