//! Loading plates: sides and bodies that move as one under a given force or spring, in statics and in motion, up to the direct shear
//! box under constant load, constant stiffness and constant volume; and bodies that are launched after a step at rest.

use crate::common::{self, Blocks, Finished, close, expression, finish, linear, neo_hookean, run_through, turned};
use fecontact::laws::friction::CoulombParameters;
use fecontact::model::boundary::Drive;
use fecontact::model::builder::{Builder, Change, Contact, Load, LoadStep, MasterSide, Place, Support};
use fecontact::model::{Damping, NewtonSettings};
use fecontact::model::{Model, Scheme, State};
use serde_json::json;

const TRAPEZOIDAL: Scheme = Scheme::Newmark { beta: 0.25, gamma: 0.5 };
const EXPLICIT: Scheme = Scheme::Explicit { safety: 0.9 };
const SCHEMES: [(Scheme, f64); 3] = [(TRAPEZOIDAL, 0.05), (Scheme::Hht { alpha: -0.1 }, 0.05), (EXPLICIT, 1.0)];

/// Σ m v of a body [M L/T].
fn momentum(run: &Finished, body: usize, state: &State) -> [f64; 2] {
    let elements = run.model.bodies[body].elements.iter();
    elements.fold([0.0; 2], |sum, &e| {
        let masses = run.model.element_lumped_mass(e);
        let nodes = run.model.mesh.elements[e].nodes.iter().zip(&masses);
        nodes.fold(sum, |[x, y], (node, mass)| {
            [x + mass * state.velocity[2 * node], y + mass * state.velocity[2 * node + 1]]
        })
    })
}

/// A block of E = 100 with a plate on its top, and its bottom held unless it is to fly.
fn block(density: f64) -> Builder {
    Model::builder(Blocks::default().rectangle("block", [4, 3], [0.0, 0.0], [2.0, 1.0]).mesh())
        .body("block", linear(100.0, 0.3, density))
        .plate("block_top")
        .newton(NewtonSettings { tolerance: 1e-12, max_iterations: 25 })
}

fn top(run: &Finished, state: &State) -> [f64; 2] {
    let nodes = run.nodes("block_top");
    let largest = state.displacement.iter().fold(0.0f64, |most, u| most.max(u.abs()));
    for (&node, i) in nodes.iter().flat_map(|node| [(node, 0), (node, 1)]) {
        let [own, first] = [node, nodes[0]].map(|node| state.displacement[2 * node + i]);
        close("one of the plate", own, first, 1e-14 * largest);
    }
    [0, 1].map(|i| state.displacement[2 * nodes[0] + i])
}

/// The force on a plate is that on the bottom; and supports that move the side as it has moved need just this force.
#[test]
fn the_force_on_a_plate_is_met_exactly() {
    let step = || LoadStep::new("load", 1.0).dt(0.5).fix("block_bottom");
    let force = [0.7, -1.3];
    let pressed = run_through(block(0.0).step(step().load(Load::total_force("block_top", force))));
    let u = top(&pressed, pressed.last());
    let moved = run_through(block(0.0).step(step().support(Support::on("block_top").ux(u[0]).uy(u[1]))));
    for (i, force) in force.into_iter().enumerate() {
        close("bottom", pressed.reaction("block_bottom", pressed.last())[i], -force, 1e-10);
        close("top", moved.reaction("block_top", moved.last())[i], force, 1e-10);
    }
    // A spring k to a driver d at one node pulls the plate, of the stiffness S = F/u, to u = k d/(k + S).
    let (k, d) = (30.0, -0.05);
    let uniaxial = run_through(block(0.0).step(step().load(Load::total_force("block_top", [0.0, force[1]]))));
    let [aside, down] = top(&uniaxial, uniaxial.last());
    close("symmetry", aside, 0.0, 1e-12);
    let spring = Change::To(fecontact::model::builder::SpringLoad { kx: 0.0, ky: k, driver: Some([0.0, d].into()) });
    let pulled = run_through(block(0.0).step(step().load(Load::spring(Place::Near([2.0, 1.0]), spring))));
    let expected = k * d / (k + force[1] / down);
    close("pulled", top(&pulled, pulled.last())[1], expected, 1e-12);
    close("its force", pulled.reaction("block_bottom", pulled.last())[1], k * (expected - d), 1e-10);
}

/// The reaction of a plate counts where all of it is, and its displacement with every node of it.
#[test]
fn a_plate_is_watched_as_a_whole() {
    let step =
        LoadStep::new("load", 1.0).dt(1.0).fix("block_bottom").support(Support::on("block_top").ux(0.0).uy(-0.02));
    let run = run_through(block(0.0).step(step).watch("block_top").watch("block_left").watch("block"));
    let state = run.last();
    let [top, left, all] = [0, 1, 2].map(|k| &run.model.requests.watch[k]);
    let reaction = |set: &fecontact::model::WatchedSet| {
        set.constrained[1].iter().map(|node| state.reaction[2 * node + 1]).sum::<f64>()
    };
    let pressed = -run.reaction("block_bottom", state)[1];
    close("plate", reaction(top), pressed, 1e-10);
    close("corner at the bottom", reaction(left), state.reaction[1], 0.0);
    close("all", reaction(all), 0.0, 1e-10);
    assert_eq!([top, left, all].map(|set| set.nodes.len()), [5, 4, 20]);
}

/// Under a constant force from rest, a body of mass M with a plate has the momentum F t whatever it does inside, and one that is a
/// plate as a whole moves by ½ F/M t², in all schemes.
#[test]
fn plates_in_motion_have_their_masses() {
    let force = || Load::total_force("block_top", [expression("0.6"), expression("-0.3")]);
    for (scheme, dt) in SCHEMES {
        let fly = || LoadStep::new("fly", 1.0).scheme(scheme).dt(dt).load(force());
        let run = run_through(block(2.0).step(fly()));
        for state in &run.states {
            top(&run, state);
            let [x, y] = momentum(&run, 0, state);
            close(&format!("{scheme:?}: x"), x, 0.6 * state.time, 1e-9);
            close(&format!("{scheme:?}: y"), y, -0.3 * state.time, 1e-9);
        }
        let energy = &run.last().energy;
        close("energy", energy.error(), 0.0, 0.02 * energy.kinetic);
        let rigid = run_through(block(2.0).plate("block").damping("block", Damping::default()).step(fly()));
        for (dof, u) in rigid.last().displacement.iter().enumerate() {
            close(&format!("{scheme:?}: way"), *u, 0.5 / 4.0 * [0.6, -0.3][dof % 2], 1e-12);
        }
        close("strain", rigid.last().energy.strain, 0.0, 1e-20);
    }
}

const ALPHA: f64 = 1e4;
const MU: f64 = 0.4;
const WEIGHT: f64 = 2.0;

/// A rigid box of the length 1 on a plane that rises by an angle along x; one of linear material is condensed.
fn shear_box(angle: f64, condensed: bool) -> Builder {
    let mesh = Blocks::default().rectangle("box", [4, 2], [0.0, 0.0], [1.0, 0.5]).turned(angle).mesh();
    let ground = MasterSide::Plane { point: [0.0, 0.0], normal: turned([0.0, 1.0], angle) };
    let friction = CoulombParameters { mu: MU, alpha_t: Some(ALPHA) };
    let material = if condensed { linear(100.0, 0.3, 1.0) } else { neo_hookean(100.0, 0.3, 1.0) };
    Model::builder(mesh)
        .body("box", material)
        .plate("box")
        .contact(Contact::new("base", "box_bottom", ground, friction).alpha_n(ALPHA))
        .newton(NewtonSettings { tolerance: 1e-12, max_iterations: 25 })
}

fn drag() -> LoadStep {
    LoadStep::new("drag", 1.0).dt(0.125).support(Support::on("box").ux(0.08))
}

fn press() -> LoadStep {
    let weight = Load::total_force("box_top", [0.0, -WEIGHT]);
    LoadStep::new("press", 1.0).dt(0.5).support(Support::on("box").ux(0.0)).load(weight)
}

/// Horizontal force H and pressing force N, both of the contact and of the support, at all states while it slides.
fn check(run: &Finished, angle: f64, pressing: impl Fn(f64) -> f64) {
    let (sine, cosine) = angle.sin_cos();
    let mut slid = 0;
    for state in run.states.iter().filter(|state| state.time > 1.0) {
        let n = pressing(state.displacement[0]);
        let [normal, tangential] = run.contact_force(state);
        close("N", normal, n, 1e-9 * n);
        let full = MU * n;
        if (tangential - full).abs() > 1e-3 * full {
            continue;
        }
        slid += 1;
        close("T", tangential, full, 1e-9 * n);
        let node = run.nodes("box")[0];
        close("H", state.reaction[2 * node], n * (sine + MU * cosine), 1e-9 * n);
    }
    assert!(slid >= 7, "slid {slid} times");
}

/// A rigid box under constant load, constant stiffness and constant volume on a plane that rises by i, as dilatancy would lift it, so
/// that H/V = tan(φ + i) (Patton 1966). With N = α_n (u sin i − v cos i), v the rise of the box:
///
/// ```text
/// load       N (cos i − μ sin i) = F
/// stiffness  N (cos i − μ sin i) = F + K v   so   N (cos i − μ sin i + K/(α_n cos i)) = F + K u tan i
/// volume     v stays, N grows by α_n sin i u
/// ```
#[test]
fn a_rigid_shear_box_has_its_closed_forms() {
    for (angle, condensed) in [(0.0, false), (0.0, true), (0.1, false), (0.1, true)] {
        let shear_box = |angle| shear_box(angle, condensed);
        let (sine, cosine) = f64::sin_cos(angle);
        let share = cosine - MU * sine;
        let load = run_through(shear_box(angle).step(press()).step(drag()));
        check(&load, angle, |_| WEIGHT / share);
        let ratio = load.last().reaction[2 * load.nodes("box")[0]] / WEIGHT;
        close("Patton", ratio, (MU.atan() + angle).tan(), 1e-9);

        let k = 50.0;
        let spring = || Load::spring(Place::Node(0), [0.0, k]);
        let stiff = run_through(shear_box(angle).step(press().load(spring())).step(drag()));
        check(&stiff, angle, |u| (WEIGHT + k * u * sine / cosine) / (share + k / (ALPHA * cosine)));

        let held = drag().support(Support::on("box").uy(Drive::Rate(0.0)));
        let volume = run_through(shear_box(angle).step(press()).step(held));
        let rise = volume.at(1.0).displacement[1];
        check(&volume, angle, |u| ALPHA * (u * sine - rise * cosine));
    }
}

/// Before it slides, a box under constant load on level ground is held by α_t: H = α_t u up to μ F.
#[test]
fn a_box_sticks_before_it_slides() {
    let drag = LoadStep::new("drag", 1.0).dt(0.125).support(Support::on("box").ux(1.5 * MU * WEIGHT / ALPHA));
    let run = run_through(shear_box(0.0, false).step(press()).step(drag));
    let node = run.nodes("box")[0];
    for state in run.states.iter().filter(|state| state.time > 1.0) {
        let expected = (ALPHA * state.displacement[2 * node]).min(MU * WEIGHT);
        close("H", state.reaction[2 * node], expected, 1e-9 * WEIGHT);
    }
}

/// On rings a plate keeps its radius; its force is that of the full turn.
#[test]
fn a_plate_on_a_ring_keeps_its_radius() {
    let run = finish(&json!({
        "section": "axisymmetric",
        "mesh": Blocks::default().rectangle("ring", [3, 2], [1.0, 0.0], [2.0, 1.0]).json(),
        "bodies": {"ring": {"material": {"model": "linear", "E": 100, "nu": 0.3}}},
        "plates": ["ring_top"],
        "steps": [{"name": "press", "duration": 1, "dt": {"initial": 1}, "supports": [{"on": "ring_bottom", "uy": 0}],
                   "loads": [{"on": "ring_top", "total_force": {"y": -3}}]}]
    }));
    let state = run.last();
    close("force", run.reaction("ring_bottom", state)[1], 3.0, 1e-9);
    run.nodes("ring_top").iter().for_each(|node| assert_eq!(state.displacement[2 * node], 0.0));
    assert!(run.nodes("ring_bottom").iter().any(|node| state.displacement[2 * node] > 2e-4), "the bottom widens");
}

#[test]
fn what_a_plate_cannot_do_is_refused() {
    let step = || LoadStep::new("load", 1.0).fix("block_bottom");
    let top = || Support::on("block_top");
    for (model, words) in [
        (block(0.0).plate("lid").step(step()), "plates[1]: the mesh has no group `lid`"),
        (
            block(0.0).step(step().support(top().rotation([0.0, 0.0], 0.1))),
            "steps[0].supports[1].rotation: node 15 is one of a plate, which does not rotate: give ux and uy",
        ),
        (
            block(0.0).step(step().support(top().uy(expression("-0.01*x")))),
            "steps[0].supports[1].uy: node 15 is one of a plate, which moves as a whole: give it in t alone",
        ),
        (
            block(1.0).step(step().launch("block", [1.0, 0.0])),
            "steps[0].velocity: is for dynamic and explicit steps: a static one has no velocities",
        ),
        (
            block(1.0).step(step().scheme(TRAPEZOIDAL).launch("blok", [1.0, 0.0])),
            "steps[0].velocity.blok: there is no body or point mass `blok`; there are block",
        ),
        (
            block(1.0).step(step().scheme(TRAPEZOIDAL).launch("block", [f64::NAN, 0.0])),
            "steps[0].velocity.block: is NaN: must be a finite number",
        ),
    ] {
        let message = model.build().err().map(|error| error.to_string()).unwrap_or_default();
        assert!(message.starts_with(words), "`{words}` is not in `{message}`");
    }
}

/// Two columns settle under their weight, then one is thrown, and later the other: momenta are M (v + g t) from each launch on, and
/// the kinetic energy given counts as work, ½ M v².
#[test]
fn bodies_are_launched_after_they_settled() {
    let (g, throws) = (-0.5, [[0.3, 2.0], [-0.2, 1.0]]);
    let mesh = || {
        let one = Blocks::default().rectangle("one", [2, 3], [0.0, 0.0], [1.0, 2.0]);
        one.rectangle("two", [2, 3], [3.0, 0.0], [4.0, 2.0]).mesh()
    };
    for (scheme, dt) in SCHEMES {
        let settle = LoadStep::new("settle", 1.0).dt(1.0).fix("one_bottom").fix("two_bottom");
        let free = |name: &str| Support::on(format!("{name}_bottom").as_str()).ux(Change::End).uy(Change::End);
        let weights = |step: LoadStep| {
            ["one", "two"].into_iter().fold(step, |step, name| step.load(Load::gravity(name, [0.0, g])))
        };
        let first = LoadStep::new("first", 1.0).scheme(scheme).dt(dt).launch("one", throws[0]).support(free("one"));
        let second = LoadStep::new("second", 1.0).launch("two", throws[1]).support(free("two"));
        let model = Model::builder(mesh()).body("one", linear(200.0, 0.2, 3.0)).body("two", linear(200.0, 0.2, 3.0));
        let run = run_through(model.step(weights(settle)).step(first).step(second));
        let mass = 6.0;
        for state in run.states.iter().filter(|state| state.time > 1.0) {
            let since = [state.time - 1.0, state.time - 2.0];
            for body in (0..2).filter(|body| since[*body] > 0.0) {
                let [x, y] = momentum(&run, body, state);
                close(&format!("{scheme:?}: x of {body}"), x, mass * throws[body][0], 1e-8);
                close(&format!("{scheme:?}: y of {body}"), y, mass * (throws[body][1] + g * since[body]), 1e-8);
            }
            let supplied = state.energy.supplied();
            let allowed = if matches!(scheme, Scheme::Hht { .. }) { 0.02 } else { 1e-3 };
            close(&format!("{scheme:?}: energy"), state.energy.error(), 0.0, allowed * supplied);
        }
        common::close("run", run.last().time, 3.0, 1e-12);
    }
}
