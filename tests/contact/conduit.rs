//! Water that flows along a contact, in static and implicit increments, against closed forms.

use std::f64::consts::PI;

use crate::common::{Blocks, Finished, close, finish, goes_on, refusal};
use fecontact::model::state::State;
use serde_json::{Value, json};

const LENGTH: f64 = 10.0;
/// S, T and η: the diffusivity is 1
const STORAGE: f64 = 2e-3;
const TRANSMISSIVITY: f64 = 1e-2;
const VISCOSITY: f64 = 5.0;

fn water(more: Value) -> Value {
    let mut flow = json!({"storage": STORAGE, "transmissivity": TRANSMISSIVITY, "viscosity": VISCOSITY});
    let more = more.as_object().expect("an object").clone();
    flow.as_object_mut().expect("an object").extend(more);
    flow
}

/// A block that is pressed on a plane, under which water flows from x = 0 to x = 10.
fn block(n: usize, flow: Value, duration: f64, dt: f64) -> Value {
    json!({
        "mesh": Blocks::default().rectangle("block", [n, 2], [0.0, 0.0], [LENGTH, 2.5]).json(),
        "bodies": {"block": {"material": {"model": "linear", "E": 1e4, "nu": 0.2, "density": 1e-3}}},
        "contacts": {"base": {
            "slave": "block_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}}, "sliding": "small",
            "friction": {"law": "coulomb", "mu": 0.6}, "initial": {"pressure": 100, "balanced": true},
            "fluid_pressure": {"flow": flow},
        }},
        "steps": [{"name": "flow", "duration": duration, "dt": {"initial": dt, "max": dt},
                   "supports": [{"on": "block_top", "ux": 0, "uy": 0}]}],
    })
}

/// x and p_w of every point at the end.
fn pressures(run: &Finished) -> Vec<[f64; 2]> {
    let x = run.model.mesh.undeformed();
    let points = run.model.contacts[0].points.iter().zip(&run.last().contacts[0]);
    points.map(|(point, state)| [point.at(&x).x, state.fluid]).collect()
}

/// Largest difference from a closed form.
fn off(run: &Finished, exact: impl Fn(f64) -> f64) -> f64 {
    pressures(run).iter().map(|[x, p]| (p - exact(*x)).abs()).fold(0.0, f64::max)
}

/// What has come in is what is there, to round-off, in every state.
fn balances(run: &Finished) {
    for state in &run.states {
        let water = &state.conduits[0];
        let share = water.mass_error.abs() / water.amounts.throughput.max(1e-6);
        assert!(share < 1e-10, "{share:e} of {:e} at {}", water.amounts.throughput, state.time);
    }
}

fn erfc(x: f64) -> f64 {
    // 1 − 2/√π ∫ exp(−s²) ds by Simpson's rule
    let n = 2000;
    let h = x / f64::from(n);
    let f = |k: i32| (-(h * f64::from(k)).powi(2)).exp();
    let sum: f64 = (0..n / 2).map(|k| f(2 * k) + 4.0 * f(2 * k + 1) + f(2 * k + 2)).sum();
    1.0 - 2.0 / PI.sqrt() * h / 3.0 * sum
}

/// p/P of a conduit of the length L whose end is held at P from t = 0 on: 1 − Σ 2 sin(λ x)/(λ L) exp(−λ² D t), λ = (k + ½) π/L.
fn held(x: f64, t: f64) -> f64 {
    let of = |k: i32| {
        let rate = (f64::from(k) + 0.5) * PI / LENGTH;
        2.0 / (rate * LENGTH) * (rate * x).sin() * (-rate * rate * t).exp()
    };
    1.0 - (0..400).map(of).sum::<f64>()
}

/// A pressure that is held diffuses to the impervious end, with an error of second order in the elements, whatever the increments: the first
/// one has the jump in it.
#[test]
fn a_pressure_that_is_held_diffuses_to_an_impervious_end() {
    let run = |n: usize, dt: f64, method: &str| {
        let mut case = block(n, water(json!({"wells": [{"at": [0, 0], "pressure": 3}]})), 4.0, dt);
        case["contacts"]["base"]["method"] = json!(method);
        let run = finish(&case);
        balances(&run);
        // Below zero by a hundredth of the error of a step at most, 1e-4 of P: extrapolation would pull the front below by that error.
        let least =
            run.states.iter().flat_map(|state| &state.conduits[0].pressure).fold(0.0f64, |least, p| least.min(*p));
        assert!(least >= -3e-6, "{least:e}");
        off(&run, |x| 3.0 * held(x, 4.0)) / 3.0
    };
    let errors = [20, 40].map(|n| run(n, 1.0, "node_to_segment"));
    println!("{errors:?}");
    assert!(errors[1] < 6e-4 && errors[0] / errors[1] > 2.8, "{errors:?}");
    close("one increment", run(40, 4.0, "node_to_segment"), errors[1], 2e-4);
    for method in ["gauss_to_segment", "mortar"] {
        assert!(run(40, 4.0, method) < 8e-4, "{method}");
    }
}

/// A rate of volume into the end of a long conduit: p = q η/T √(4 D t) (exp(−ξ²)/√π − ξ erfc ξ), ξ = x/√(4 D t).
#[test]
fn a_rate_that_is_given_diffuses_along_a_long_contact() {
    let (rate, time) = (0.02, 2.0);
    let run = finish(&block(80, water(json!({"wells": [{"at": [0, 0], "rate": rate}]})), time, 0.5));
    let size = (4.0 * time).sqrt();
    let exact = |x: f64| {
        let xi = x / size;
        rate * VISCOSITY / TRANSMISSIVITY * size * ((-xi * xi).exp() / PI.sqrt() - xi * erfc(xi))
    };
    let error = off(&run, exact) / exact(0.0);
    println!("{error:e}");
    assert!(error < 4e-4, "{error}");
    close("injected", run.last().conduits[0].amounts.injected, rate * time, 1e-15);
    balances(&run);
}

/// Schedules: a rate between two nodes by a table, whose corners end increments, then a well that is shut. What is left is even in the end,
/// p = V/(S L), and p stays the same where the walls leak nothing.
#[test]
fn what_a_schedule_has_let_in_spreads_evenly() {
    let wells = json!([
        {"at": [2.6, 0], "rate": {"table": [[0, 0], [1, 0.02], [2, 0]]}},
        {"at": [7, 0], "pressure": 5, "from": 0.5, "until": 0.7},
    ]);
    let run = finish(&block(20, water(json!({"wells": wells})), 200.0, 50.0));
    let water = &run.last().conduits[0];
    let even = water.amounts.injected / (STORAGE * LENGTH);
    assert!(water.amounts.injected > 0.02, "{}", water.amounts.injected);
    assert!(off(&run, |_| even) < 1e-3 * even, "{even}: {:?}", pressures(&run));
    for corner in [0.5, 0.7, 1.0, 2.0] {
        run.at(corner);
    }
    balances(&run);
}

/// A flat gasket (L = 4, H = 1, E = 1000, ν = 0, columns that neither widen nor slide) is clamped with p₀ = 10, and the water at its end goes up to
/// 20 in ten times. Closed, it is tight within the time of the test, by the aperture of its roughness. The water opens it from its end on
/// once it exceeds p₀, and in the end has lifted it by w = (20 − p₀) H/E throughout: w L + S 20 L have come in. Half open, whatever
/// goes wrong with the water that follows shows in what has come in by then.
#[test]
fn water_follows_a_seal_that_opens() {
    let (length, storage, clamped, given) = (4.0, 1e-4, 10.0, 20.0);
    let flow = json!({"storage": storage, "aperture": 2e-5, "viscosity": 1e-9,
                      "wells": [{"at": [0, 0], "pressure": {"table": [[0, 0], [1, 0], [11, given]]}}]});
    let run = finish(&json!({
        "mesh": Blocks::default().rectangle("gasket", [8, 1], [0.0, 0.0], [length, 1.0]).json(),
        "bodies": {"gasket": {"material": {"model": "linear", "E": 1000, "nu": 0}}},
        "contacts": {"seal": {
            "slave": "gasket_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}}, "method": "node_to_segment",
            "sliding": "small", "friction": {"law": "frictionless"}, "fluid_pressure": {"flow": flow},
        }},
        "steps": [
            {"name": "clamp", "duration": 1, "dt": {"initial": 0.5}, "supports": [{"on": "gasket", "ux": 0}, {"on": "gasket_top", "uy": -0.01}]},
            {"name": "pump", "duration": 10, "dt": {"initial": 0.25, "max": 1}},
        ],
    }));
    let water = |state: &State| state.contacts[0].iter().map(|point| point.length * point.fluid).sum::<f64>();
    let tight =
        run.states.iter().rfind(|state| state.time < 6.0).expect("a state under less than the pressure of the seal");
    assert!(tight.time > 4.0 && tight.contacts[0].iter().all(|point| point.is_closed()), "t = {}", tight.time);
    assert!(water(tight) < 0.1 * clamped * length, "{}", water(tight));
    let last = run.last();
    assert!(last.contacts[0].iter().all(|point| !point.is_closed()));
    close("water's force", water(last), given * length, 1e-3 * given * length);
    let come_in = ((given - clamped) / 1000.0 + storage * given) * length;
    close("injected", last.conduits[0].amounts.injected, come_in, 1e-3 * come_in);
    balances(&run);
}

/// A rate into the axis of rings (Theis): p = q η/(4π T) E₁(r²/(4 D t)), E₁(¼) = 1.044283, E₁(1) = 0.219384.
#[test]
fn rings_take_a_rate_from_their_axis() {
    let mut case = block(80, water(json!({"wells": [{"at": [0, 0], "rate": 0.1}]})), 1.0, 1.0);
    case["section"] = json!("axisymmetric");
    case["contacts"]["base"]["method"] = json!("node_to_segment");
    case["steps"][0]["supports"] = json!([{"on": "block_top", "ux": 0, "uy": 0}, {"on": "block_left", "ux": 0}]);
    let run = finish(&case);
    for (k, exponential) in [(8, 1.044283), (16, 0.219384)] {
        let p = run.last().contacts[0][k].fluid;
        close("Theis", p / (0.1 * VISCOSITY / (4.0 * PI * TRANSMISSIVITY) * exponential), 1.0, 0.01);
    }
    balances(&run);
}

/// Walls that leak in proportion to the pressure: p = P cosh((L − x)/ℓ)/cosh(L/ℓ) in the end, ℓ² = T/(η c).
#[test]
fn walls_that_leak_take_what_the_well_gives() {
    let leak = TRANSMISSIVITY / VISCOSITY / 4.0;
    let flow = json!({"wells": [{"at": [0, 0], "pressure": 3}], "leak": {"coefficient": leak}});
    let run = finish(&block(80, water(flow), 100.0, 100.0));
    let error = off(&run, |x| 3.0 * ((LENGTH - x) / 2.0).cosh() / (LENGTH / 2.0).cosh()) / 3.0;
    assert!(error < 5e-4, "{error}");
    balances(&run);
}

/// Between periodic sides nothing has an end: p = p₀ + q cos(k (x − x₀)) (1 − exp(−D k² t))/(T/η k²) under a source q cos(k (x − x₀)).
#[test]
fn periodic_sides_are_joined() {
    let k = 2.0 * PI / LENGTH;
    let flow = json!({"initial": 2, "source": format!("1e-3*cos({k}*(x - 1.3))")});
    let mut case = block(40, water(flow), 3.0, 1.0);
    case["periodic"] = json!([["block_left", "block_right"]]);
    case["contacts"]["base"]["method"] = json!("node_to_segment");
    let run = finish(&case);
    let size = 1e-3 * VISCOSITY / (TRANSMISSIVITY * k * k) * (1.0 - (-k * k * 3.0).exp());
    let error = off(&run, |x| 2.0 + size * (k * (x - 1.3)).cos()) / size;
    println!("{size} {error:e}");
    assert!(error < 3e-3, "{error}");
    let ends = [0, 40].map(|k| run.last().contacts[0][k].fluid);
    close("ends", ends[0], ends[1], 1e-14);
    balances(&run);
}

/// Slip that opens the fault: under a block that slides at the rate v, T = k₀ + k₁ v t everywhere, and p is that of a constant diffusivity
/// at the time ∫ T/(S η) dt. Quadratic edges, Gauss points.
#[test]
fn a_transmissivity_follows_slip() {
    let (rate, per_slip) = (0.5, 2e-2);
    let mut flow = water(json!({"per_slip": per_slip, "wells": [{"at": [0, 0], "pressure": 3}]}));
    (flow["storage"], flow["viscosity"]) = (json!(1e-3), json!(1.0));
    flow["transmissivity"] = json!(1e-3);
    let error = |dt: f64| {
        let mut case = block(60, flow.clone(), 1.0, dt);
        case["bodies"]["block"]["material"]["E"] = json!(1e7);
        case["contacts"]["base"]["friction"]["mu"] = json!(1e-3);
        case["steps"][0]["supports"] = json!([{"on": "block_top", "ux": {"rate": rate}, "uy": 0}]);
        let run = finish(&case);
        balances(&run);
        let size = 2.0 * ((1e-3 + 0.5 * per_slip * rate) / 1e-3f64).sqrt();
        // With its image behind the impervious end
        off(&run, |x| 3.0 * (erfc(x / size) + erfc((2.0 * LENGTH - x) / size))) / 3.0
    };
    let errors = [0.5, 0.1].map(error);
    println!("{errors:?}");
    assert!(errors.iter().all(|error| *error < 2e-3), "{errors:?}");
}

/// A pressure p′ that closes the fault to half its transmissivity: what a held pressure lets in goes by half the diffusivity,
/// S L P (1 − Σ 2/(λ L)² exp(−λ² D t/2)), λ = (k + ½) π/L.
#[test]
fn a_transmissivity_falls_with_the_pressure_on_it() {
    let held = 1e-3;
    let flow = json!({"closing": 100.0 / 2.0f64.ln(), "wells": [{"at": [0, 0], "pressure": held}]});
    let run = finish(&block(40, water(flow), 4.0, 1.0));
    balances(&run);
    let left = |k: i32| {
        let rate = (f64::from(k) + 0.5) * PI / LENGTH;
        2.0 / (rate * LENGTH).powi(2) * (-rate * rate * 0.5 * 4.0).exp()
    };
    let expected = 1.0 - (0..400).map(left).sum::<f64>();
    close("volume", run.last().conduits[0].amounts.injected / (STORAGE * LENGTH * held) / expected, 1.0, 5e-3);
}

/// Between two pressures that are held water flows at T/η ΔP/L everywhere in the end.
#[test]
fn what_flows_is_told_at_every_point() {
    let flow = json!({"wells": [{"at": [0, 0], "pressure": 3}, {"at": [10, 0], "pressure": 1}]});
    let run = finish(&block(20, water(flow), 400.0, 100.0));
    for state in &run.last().contacts[0] {
        let flow = state.water.as_ref().expect("water").flow;
        close("flow", flow / (TRANSMISSIVITY / VISCOSITY * 2.0 / LENGTH), 1.0, 1e-3);
    }
}

/// A well that takes more than there is stops the run.
#[test]
fn a_well_cannot_take_what_is_not_there() {
    let flow = json!({"initial": 1, "wells": [{"at": [0, 0], "rate": -0.02}]});
    let mut run = fecontact::run::Simulation::new(crate::common::model(&block(20, water(flow), 4.0, 1.0)));
    let stopped = loop {
        match run.next_increment() {
            Ok(Some(_)) => {}
            Ok(None) => panic!("it goes on"),
            Err(error) => break error.to_string(),
        }
    };
    assert!(stopped.contains("a well withdraws more than there is"), "{stopped}");
}

/// A dilatant fault between periodic sides that slips without drainage: p_w = p₀ − δ tan ψ/S, so that slip strengthens it, and it stops where
/// G (u − δ − q/α_t)/H = q = μ (p + δ tan ψ/S). Where the water does not follow it slips by a third more.
#[test]
fn a_dilatant_fault_stops_itself() {
    let (psi, storage, ground, way, alpha_t) = (0.1, 1e-4, 40.0, 0.06, 1e6);
    let case = |fluid: Value| {
        let mut case = block(8, Value::Null, 1.0, 0.1);
        case["periodic"] = json!([["block_left", "block_right"]]);
        let base = &mut case["contacts"]["base"];
        base["fluid_pressure"] = fluid;
        base["friction"]["alpha_t"] = json!(alpha_t);
        (base["dilatancy"], base["method"]) = (json!({"rate": psi}), json!("node_to_segment"));
        // The top rises as it likes.
        case["steps"][0]["supports"] = json!([{"on": "block_top", "ux": way}]);
        case
    };
    let flow = json!({"storage": storage, "transmissivity": 0, "viscosity": 1, "initial": ground});
    let run = finish(&case(json!({"flow": flow})));
    let drained = finish(&case(json!(ground)));
    balances(&run);
    let stiffness = 1e4 / 2.4 / 2.5;
    let slip = |strengthens: f64| {
        let elastic = 1.0 + stiffness / alpha_t;
        (stiffness * way - 0.6 * 100.0 * elastic) / (stiffness + 0.6 * strengthens * elastic)
    };
    for (run, strengthens) in [(&run, psi / storage), (&drained, 0.0)] {
        for state in &run.last().contacts[0] {
            close("slip", state.friction.plastic_slip.abs() / slip(strengthens), 1.0, 1e-6);
            close("p", state.friction.pressure, 100.0 + strengthens * slip(strengthens), 1e-4);
        }
    }
    for state in &run.last().contacts[0] {
        close("p_w", state.fluid, ground - psi * slip(psi / storage) / storage, 1e-4);
    }
}

/// A half of Sneddon's crack: a half-plane on a rigid plane, which water parts over |x| < a.
fn crack(flow: &Value, duration: f64, dt: f64) -> Value {
    let far = 15.0;
    let (n, m) = (16, 14);
    let ratio = 20.0;
    let mut blocks = Vec::new();
    for (low, high, count, grading, side) in
        [(-far, -1.0, m, 1.0 / ratio, "rest"), (-1.0, 1.0, n, 1.0, "crack"), (1.0, far, m, ratio, "rest")]
    {
        blocks.push(json!({
            "body": "half", "kind": "Q8", "corners": [[low, 0], [high, 0], [high, far], [low, far]],
            "elements": [count, m], "grading": [grading, ratio], "sides": [side, null, "far", null],
        }));
    }
    json!({
        "mesh": {"blocks": blocks},
        "bodies": {"half": {"material": {"model": "linear", "E": 1000, "nu": 0.25}}},
        "contacts": {"crack": {
            "slave": "crack", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}}, "sliding": "small",
            "friction": {"law": "frictionless"}, "fluid_pressure": flow,
        }},
        "steps": [{"name": "fill", "duration": duration, "dt": {"initial": dt, "max": dt},
                   "supports": [{"on": "rest", "uy": 0}, {"on": "far", "ux": 0, "uy": 0}]}],
    })
}

fn opened(run: &Finished) -> f64 {
    run.last().conduits[0].walls.iter().fold(0.0, |most: f64, wall| most.max(wall.opening))
}

/// A pressurised crack: p = q t/(C + 2 a S), with the volume C per pressure of the same mesh under a given pressure, whatever the
/// compressibility of the water: from as soft as the crack to ten thousand times as stiff. C is that of Sneddon, π a²/E′ of a half, but
/// for what the ends of the mesh change.
#[test]
fn a_pressurised_crack_takes_what_is_pumped_into_it() {
    let modulus = 1000.0 / (1.0 - 0.0625);
    let given = finish(&crack(&json!(0.3), 1.0, 1.0));
    let states = &given.last().contacts[0];
    let compliance = states.iter().map(|state| state.length * state.gap).sum::<f64>() / 0.3;
    println!("C {compliance} for {}", PI / modulus);
    close("Sneddon", compliance / (PI / modulus), 1.0, 0.045);
    for storage in [1e-3, 1e-5, 1e-7] {
        let flow = json!({"flow": {"storage": storage, "transmissivity": 1, "viscosity": 1e-3, "wells": [{"at": [0, 0], "rate": 1e-3}]}});
        let run = finish(&crack(&flow, 1.0, 0.25));
        balances(&run);
        let expected = 1e-3 / (compliance + 2.0 * storage);
        println!(
            "S {storage:e}: {} iterations, p {}",
            run.iterations.iter().sum::<usize>(),
            run.last().contacts[0][8].fluid
        );
        assert!(off(&run, |_| expected) < 1e-3 * expected, "{expected}: {:?}", pressures(&run));
        close("opening", opened(&run) / (2.0 * expected / modulus), 1.0, 0.045);
    }
}

/// The cubic law in a crack under its own stress: twice the rate into the same crack opens it more where the well is; the balance closes,
/// increments differ little, and the run is the same when it goes on from a file.
#[test]
fn a_crack_by_the_cubic_law_resumes_to_the_bit() {
    let flow = json!({"flow": {"storage": 1e-4, "aperture": 1e-3, "viscosity": 1e-6, "initial": 0.5,
                               "wells": [{"at": [0, 0], "rate": 4e-3}]}});
    let mut case = crack(&flow, 1.0, 0.1);
    case["contacts"]["crack"]["initial"] = json!({"pressure": 0.5, "balanced": true});
    let whole = finish(&case);
    balances(&whole);
    goes_on(&case, &whole, 4);
    case["steps"][0]["dt"] = json!({"initial": 0.025, "max": 0.025});
    let fine = finish(&case);
    let apart = |a: &State, b: &State| {
        let (a, b) = (&a.conduits[0].pressure, &b.conduits[0].pressure);
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    println!("{}", apart(fine.last(), whole.last()));
    assert!(apart(fine.last(), whole.last()) < 0.05, "{}", apart(fine.last(), whole.last()));
}

/// Water that parts surfaces by a transmissivity that is given is told of; by the cubic law it is meant.
#[test]
fn water_that_opens_by_the_transmissivity_of_closed_surfaces_is_told() {
    for (key, value, told) in [("transmissivity", 1e-2, true), ("aperture", 1e-2, false)] {
        let mut flow =
            json!({"storage": 1e-4, "viscosity": 1e-3, "initial": 0.5, "wells": [{"at": [0, 0], "rate": 4e-3}]});
        flow[key] = json!(value);
        let mut case = crack(&json!({"flow": flow}), 0.4, 0.1);
        case["contacts"]["crack"]["initial"] = json!({"pressure": 0.5, "balanced": true});
        let warned = crate::warned::warnings(&case);
        let says = warned.iter().any(|warning| warning.contains("and goes on flowing by the transmissivity of closed"));
        assert_eq!(says, told, "{warned:?}");
    }
}

/// Implicit dynamics whose motion is slow has the pressures of statics.
#[test]
fn slow_motion_has_the_water_of_statics() {
    let flow = water(json!({"wells": [{"at": [0, 0], "pressure": "3*min(t, 1)"}], "closing": 40}));
    let mut case = block(20, flow, 2.0, 0.1);
    case["contacts"]["base"]["normal"] = json!({"alpha_n": 1e5});
    let still = finish(&case);
    case["steps"][0]["scheme"] = json!({"newmark": {"beta": 0.3025, "gamma": 0.6}});
    let moving = finish(&case);
    balances(&moving);
    let apart = pressures(&moving).iter().zip(pressures(&still)).map(|(a, b)| (a[1] - b[1]).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-3, "{apart}");
}

#[test]
fn what_water_cannot_do_is_refused_with_its_place() {
    let refused = |edit: &dyn Fn(&mut Value), told: &[&str]| {
        let mut case = block(8, water(json!({"wells": [{"at": [0, 0], "pressure": 3}]})), 1.0, 0.5);
        edit(&mut case);
        let why = refusal(&case);
        for told in told {
            assert!(why.contains(told), "{why}");
        }
    };
    let flow = |key: &'static str, value: Value| {
        move |case: &mut Value| {
            case["contacts"]["base"]["fluid_pressure"]["flow"][key] = value.clone();
        }
    };
    let place = "contacts.base.fluid_pressure.flow";
    refused(&flow("storage", json!(0)), &[&format!("{place}.storage: is 0: must be positive")]);
    refused(
        &flow("transmissivity", json!(-1)),
        &[&format!("{place}.transmissivity: is -1 at (0, 0): must be zero or positive")],
    );
    refused(
        &flow("transmissivity", Value::Null),
        &["transmissivity: is missing: give it, or the hydraulic `aperture`"],
    );
    refused(&flow("aperture", json!(1e-3)), &["transmissivity: is given beside `aperture`"]);
    refused(
        &flow("initial", json!("x - 1")),
        &[&format!("{place}.initial: is -1 at (0, 0): must be zero or positive")],
    );
    refused(
        &flow("wells", json!([{"at": [3, 1], "rate": 1}])),
        &["wells[0].at: is (3, 1), which is not on the slave", "(2.5, 0)"],
    );
    refused(&flow("wells", json!([{"at": [3, 0]}])), &["wells[0]: needs either a `pressure` or a `rate`"]);
    refused(&flow("wells", json!([{"at": [3, 0], "rate": "x"}])), &["wells[0].rate: depends on x or y"]);
    refused(
        &flow("wells", json!([{"at": [3, 0], "rate": {"table": [[1, 0], [0, 1]]}}])),
        &["wells[0].rate: the times of the table must increase"],
    );
    refused(
        &flow("wells", json!([{"at": [3, 0], "pressure": -1}])),
        &["wells[0].pressure: is -1: must be zero or positive"],
    );
    let two = json!([{"at": [0, 0], "pressure": 1}, {"at": [0.1, 0], "pressure": 2}]);
    refused(&flow("wells", two), &["wells[1]: holds a pressure at the same node"]);
    refused(&|case| case["contacts"]["base"]["wear"] = json!(1e-3), &["is not for surfaces that wear"]);
    refused(
        &|case| case["steps"][0]["scheme"] = json!({"wilson": {"theta": 1.4}}),
        &["contacts.base.fluid_pressure.flow: is not for the step `flow`"],
    );
}
