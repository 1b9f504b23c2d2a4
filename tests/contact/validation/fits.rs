//! Shrink fits and clearances against the pressure of Lamé.

use super::*;

/// E = 1000, ν = 0.3: E′ and ν′ of plane strain.
const RINGS: [f64; 2] = [1000.0 / (1.0 - 0.09), 0.3 / 0.7];

/// Two whole rings of radii ½, 1 and 1.5, the inner one larger by δ, fitted without friction; soft springs hold them.
fn fitted(mesh: &Value, slave: &str, delta: f64) -> (Finished, f64) {
    let master = if slave == "inner_outside" { "outer_inside" } else { "inner_outside" };
    let soft = json!({"kx": 1e-6, "ky": 1e-6});
    let run = finish(&json!({
        "mesh": mesh,
        "bodies": alike(&["inner", "outer"]),
        "contacts": {"fit": {"slave": slave, "master": master, "shrink_fit": true, "friction": {"law": "frictionless"}}},
        "steps": [{"name": "fit", "duration": 1, "dt": {"initial": 0.5},
                   "loads": [{"on": "inner_inside", "spring": soft}, {"on": "outer_outside", "spring": soft}]}],
    }));
    let ([modulus, nu], [a, b, c]) = (RINGS, [0.25, 1.0, 2.25]);
    (run, delta * modulus / ((c + b) / (c - b) + nu + (b + a) / (b - a) - nu))
}

/// A shrink fit of rings with different numbers of edges, of linear and of quadratic elements, slave and master either way
/// round, closes all round, every pressure within 5 % of Lamé's. What is left is the mean height of the facets, h²/(12 R),
/// which differs between the two polygons by 1.4 % of δ. (At two Gauss points an edge half of the arc is open, and pressures
/// are up to 3.6 times too high.)
#[test]
fn a_shrink_fit_of_meshes_that_do_not_match_closes_all_round() {
    let delta = 0.01;
    let rings = |n: [usize; 2], m: usize| {
        Blocks::default().ring("inner", [n[0], m], [0.5, 1.0 + delta]).ring("outer", [n[1], m], [1.0, 1.5]).json()
    };
    let meshes = [rings([80, 94], 6), rings([94, 80], 6), quadratic(&rings([24, 29], 4), half_way_round)];
    for (mesh, slave) in meshes.iter().flat_map(|mesh| ["inner_outside", "outer_inside"].map(|slave| (mesh, slave))) {
        let (run, expected) = fitted(mesh, slave, delta);
        let [found, _] = tractions(run.last());
        let [least, most] = [found.iter().copied().fold(f64::INFINITY, f64::min), largest(&found)];
        println!("{slave}, {} points: {least:.4} to {most:.4}, Lame {expected:.4}", found.len());
        assert!(least > 0.95 * expected && most < 1.05 * expected);
    }
}

/// Facets that turn by θ = 11° and 9° on an interface of radius 1, the means of both polygons at one place: where a node of the
/// master comes upon the middle of a facet of the slave it lies θ₁²/12 + θ₂²/24 deep in it, 2.7 % of its edge, while the means
/// of the slave's points say less than 0.5 %. That is told; between facets of 3° (0.7 %) nothing is.
#[test]
fn master_nodes_deep_in_the_slave_are_reported() {
    let message = |n: [usize; 2]| -> Vec<String> {
        let delta = 0.01;
        let mesh = Blocks::default().ring("inner", [n[0], 2], [0.5, 1.0 + delta]).ring("outer", [n[1], 2], [1.0, 1.5]);
        // Held on the axes, as the facets alone would let one ring turn in the other: they stand at rest on top of each other, too.
        let on = |place: [f64; 2], along: &str| {
            let is = |node: &[f64; 2]| distance(node, &place) < 1e-12;
            json!({"on": {"node": mesh.nodes.iter().position(is).expect("a node on the axis")}, along: 0})
        };
        let of_ring = |r: f64| [on([r, 0.0], "uy"), on([-r, 0.0], "uy"), on([0.0, r], "ux"), on([0.0, -r], "ux")];
        let supports = [of_ring(0.5), of_ring(1.5)].concat();
        let model = common::model(&json!({
            "mesh": mesh.json(),
            "bodies": alike(&["inner", "outer"]),
            "contacts": {"fit": {"slave": "outer_inside", "master": "inner_outside", "shrink_fit": true,
                                 "normal": {"alpha_n": 1e5}, "friction": {"law": "frictionless"}}},
            "steps": [{"name": "fit", "duration": 1, "dt": {"initial": 0.5},
                       "supports": supports}],
        }));
        let (mut warnings, mut record) = (Warnings::default(), common::Record::default());
        let model = Arc::new(model);
        let (_, result) = fecontact::run::run(&model, &mut [&mut warnings, &mut record]);
        result.expect("a run to its end");
        let state = record.states.last().expect("an increment");
        let x = model.configuration(&state.displacement);
        let points = model.contacts[0].points.iter().zip(&state.contacts[0]);
        let share = |(point, state): (&SlavePoint, &ContactState)| -state.gap / point.edge_length(&x).expect("an edge");
        assert!(points.map(share).fold(0.0, f64::max) < 5e-3);
        // Chords on chords: their pressure alternates as well.
        warnings.list.into_iter().filter(|message| !message.contains("tractions alternate")).collect()
    };
    let coarse = message([32, 40]);
    println!("{coarse:?}");
    assert!(coarse.len() == 1 && coarse[0].contains("a master node penetrates the slave"), "{coarse:?}");
    assert!(!coarse[0].contains("alpha_n"), "a stiffer penalty would not help: {coarse:?}");
    let words: Vec<&str> = coarse[0].split_whitespace().collect();
    let after = |word: &str| words[words.iter().position(|w| *w == word).expect("a word") + 1];
    let depth: f64 = after("by").trim_end_matches(',').parse().expect("a number");
    let turn = |edges: f64| std::f64::consts::TAU / edges;
    let expected = turn(32.0).powi(2) / 12.0 + turn(40.0).powi(2) / 24.0;
    close("depth", depth, expected, 0.15 * expected);
    assert_eq!(message([120, 140]), Vec::<String>::new());
}

/// Rings whose nodes meet, pressed from outside with p = 1 while the inner side is held, slave and master either way round: a
/// frictionless interface carries no moment, and its pressure is Lamé's,
///
/// ```text
/// u = A (r − a²/r),   p(r) = −A (2 (λ + G) + 2 G a²/r²),   p(c) = 1
/// ```
///
/// (At nodes, all slip into the same neighbouring edge: a moment of 7 %, a mean pressure 6 % low.)
#[test]
fn rings_whose_nodes_meet_carry_no_moment_without_friction() {
    let (lambda, shear) = (1000.0 * 0.3 / (1.3 * 0.4), 1000.0 / 2.6);
    let at = |square: f64| 2.0 * (lambda + shear) + 2.0 * shear * 0.25 / square;
    let expected = at(1.0) / at(2.25);
    for n in [32, 48] {
        let mesh = Blocks::default().ring("inner", [n, 6], [0.5, 1.0]).ring("outer", [n, 6], [1.0, 1.5]);
        let tag = |place: [f64; 2]| {
            let is = |node: &[f64; 2]| distance(node, &place) < 1e-12;
            json!({"node": mesh.nodes.iter().position(is).expect("a node on the axis")})
        };
        for [slave, master] in [["inner_outside", "outer_inside"], ["outer_inside", "inner_outside"]] {
            let run = finish(&json!({
                "mesh": mesh.json(),
                "bodies": {"inner": {"material": {"model": "linear", "E": 1000, "nu": 0.3}},
                           "outer": {"material": {"model": "linear", "E": 1000, "nu": 0.3}}},
                "contacts": {"fit": {"slave": slave, "master": master, "friction": {"law": "frictionless"}}},
                "newton": {"tolerance": 1e-12},
                "steps": [{"name": "press", "duration": 1, "dt": {"initial": 1},
                           "supports": [{"on": "inner_inside", "ux": 0, "uy": 0},
                                        {"on": tag([1.5, 0.0]), "uy": 0}, {"on": tag([-1.5, 0.0]), "uy": 0},
                                        {"on": tag([0.0, 1.5]), "ux": 0}, {"on": tag([0.0, -1.5]), "ux": 0}],
                           "loads": [{"on": "outer_outside", "pressure": 1}]}],
            }));
            let state = run.last();
            let arm = |&node: &usize| {
                let x = run.model.mesh.nodes[node];
                x.x * state.reaction[2 * node + 1] - x.y * state.reaction[2 * node]
            };
            let moment = run.nodes("inner_inside").iter().map(arm).sum::<f64>();
            let [found, _] = tractions(state);
            let mean = found.iter().sum::<f64>() / found.len() as f64;
            let scatter = found.iter().fold(0.0f64, |most, p| most.max((p - mean).abs())) / mean;
            println!("{slave}: moment {moment:.1e}, mean pressure {mean:.5} of {expected:.5}, scatter {scatter:.1e}");
            close("moment", moment, 0.0, 1e-9 * std::f64::consts::TAU);
            close("mean pressure", mean, expected, 0.01 * expected);
            assert!(scatter < 0.03);
        }
    }
}

/// A ring on a rigid disk and one in a rigid hole, larger and smaller by δ, of linear and of quadratic elements: every
/// pressure within 5 % of Lamé's.
#[test]
fn a_ring_on_a_rigid_circle_has_the_pressure_of_lame() {
    let delta = 0.01;
    for hole in [false, true] {
        let ([modulus, nu], radii) = (RINGS, if hole { [0.5, 1.0] } else { [1.0, 1.5] });
        let [a, b] = radii.map(|r| r * r);
        let expected = delta * modulus / ((a + b) / (b - a) + if hole { -nu } else { nu });
        let mesh = |n: usize| Blocks::default().ring("ring", [n, 6], radii).json();
        for mesh in [mesh(80), quadratic(&mesh(24), half_way_round)] {
            let [slave, free] = if hole { ["ring_outside", "ring_inside"] } else { ["ring_inside", "ring_outside"] };
            let radius = if hole { 1.0 - delta } else { 1.0 + delta };
            let run = finish(&json!({
                "mesh": mesh,
                "bodies": alike(&["ring"]),
                "contacts": {"fit": {"slave": slave, "master": {"circle": {"centre": [0, 0], "radius": radius, "hole": hole}},
                                     "normal": {"alpha_n": 10.0 * modulus / (0.5 / 6.0)}, "shrink_fit": true,
                                     "friction": {"law": "frictionless"}}},
                "steps": [{"name": "fit", "duration": 1, "dt": {"initial": 0.5},
                           "loads": [{"on": free, "spring": {"kx": 1e-6, "ky": 1e-6}}]}],
            }));
            let [found, _] = tractions(run.last());
            let [least, most] = [found.iter().copied().fold(f64::INFINITY, f64::min), largest(&found)];
            println!("hole {hole}, {} points: {least:.4} to {most:.4}, Lame {expected:.4}", found.len());
            assert!(least > 0.95 * expected && most < 1.05 * expected);
        }
    }
}

/// A block of 60 pressed and dragged on a rigid disk of radius 10⁴ and 10⁶: the residual falls to 1e-12 of the forces (the gap
/// |x − c| − R by itself would be known to ε R only), and a model whose places are all shifted by 2²³ has the same forces.
#[test]
fn a_large_rigid_circle_far_away_leaves_no_round_off() {
    for radius in [1e4f64, 1048576.0] {
        let forces = [0.0, 8388608.0].map(|shift: f64| {
            let place = |x: f64, y: f64| [x + shift, y + shift];
            let run = finish(&json!({
                "mesh": Blocks::default().block("block", [12, 4], |s, t| place(60.0 * s - 30.0, 20.0 * t)).json(),
                "bodies": alike(&["block"]),
                "contacts": {"base": {"slave": "block_bottom", "friction": {"law": "coulomb", "mu": 0.3},
                                      "master": {"circle": {"centre": place(0.0, -radius), "radius": radius}}}},
                "newton": {"tolerance": 1e-11},
                "steps": [{"name": "press", "duration": 1, "dt": {"initial": 0.25},
                           "supports": [{"on": "block_top", "ux": 0, "uy": -0.5}]},
                          {"name": "drag", "duration": 1, "supports": [{"on": "block_top", "ux": 0.25}]}],
            }));
            assert!(run.report.cutbacks == 0 && run.iterations.iter().all(|&n| n <= 8), "{:?}", run.iterations);
            run.reaction("block_top", run.last())
        });
        println!("radius {radius}: {forces:?}");
        let size = forces[0][1].abs();
        assert!(size > 1.0);
        close("forces", distance(&forces[0], &forces[1]), 0.0, 1e-9 * size);
    }
}

/// A tube of radii 1 and 2 shrinks on by δ = 1e-3 under one of radii 2 and 3 (a quarter of both, E = 1000, ν = 0.3, plane
/// strain). Lamé: p = E′ δ/(b [(c² + b²)/(c² − b²) + (b² + a²)/(b² − a²)]), E′ = E/(1 − ν²), at the end of the step and half of
/// it at half time. The surfaces are polygons of 5.6°, one inside the other by δ. Measured: within 0.3 %.
#[test]
fn a_shrink_fit_has_the_pressure_of_lame() {
    let (radii, delta) = ([1.0f64, 2.0, 3.0], 1e-3);
    let ring = |inner: f64, outer: f64| {
        move |s: f64, t: f64| {
            let (radius, angle) = (inner + s * (outer - inner), t * FRAC_PI_2);
            [radius * angle.cos(), radius * angle.sin()]
        }
    };
    let run = finish(&json!({
        "mesh": Blocks::default()
            .block("inner", [8, 16], ring(radii[0], radii[1] + delta))
            .block("outer", [8, 16], ring(radii[1], radii[2])).json(),
        "bodies": {
            "inner": {"material": {"model": "linear", "E": 1000, "nu": 0.3}},
            "outer": {"material": {"model": "linear", "E": 1000, "nu": 0.3}},
        },
        "contacts": {"fit": {"slave": "outer_left", "master": "inner_right", "shrink_fit": true,
                             "friction": {"law": "frictionless"}}},
        "steps": [{"name": "shrink", "duration": 1, "dt": {"initial": 0.25},
                   "supports": [{"on": "inner_bottom", "uy": 0}, {"on": "inner_top", "ux": 0},
                                {"on": "outer_bottom", "uy": 0}, {"on": "outer_top", "ux": 0}]}],
    }));
    let [a, b, c] = radii.map(|r| r * r);
    let modulus = 1000.0 / (1.0 - 0.3 * 0.3);
    let pressure = modulus * delta / (radii[1] * ((c + b) / (c - b) + (b + a) / (b - a)));
    for (time, share) in [(0.5, 0.5), (1.0, 1.0)] {
        let [found, _] = tractions(run.at(time));
        let mean = found.iter().sum::<f64>() / found.len() as f64;
        println!("t = {time}: mean pressure {mean:.6}, Lame {:.6}", share * pressure);
        close("mean pressure", mean, share * pressure, 0.01 * share * pressure);
    }
    // Bringing in the overlap takes ½ p δ a length, all of which is stored.
    let (energy, expected) = (&run.last().energy, 0.5 * pressure * delta * radii[1] * FRAC_PI_2);
    close("work", energy.external_work, expected, 0.02 * expected);
    close("audit", energy.error(), 0.0, 1e-3 * expected);
}

/// The same tubes with δ as a number: on meshes that touch, that leave a gap of 0.004, and whose chords do not match, so that their own
/// overlap would be 31 % off (`edges_that_change_a_fit_are_told`). Measured: within 0.04, 0.03, 0.13 and (Gauss points) 0.04 %.
#[test]
fn an_interference_given_as_a_number_does_not_depend_on_the_mesh() {
    let delta = 1e-3;
    let modulus = 1000.0 / (1.0 - 0.3 * 0.3);
    let pressure = modulus * delta / (2.0 * ((9.0 + 4.0) / (9.0 - 4.0) + (4.0 + 1.0) / (4.0 - 1.0)));
    let ring = |body: &str, n: usize, [a, b]: [f64; 2]| {
        let sides = ["bottom", "outside", "top", "inside"].map(|side| format!("{body}_{side}"));
        json!({"body": body, "corners": [[a, 0], [b, 0], [0, b], [0, a]], "arcs": [null, [0, 0], null, [0, 0]], "elements": [8, n], "sides": sides})
    };
    for (elements, rim, method) in [
        ([16, 16], 2.0, "mortar"),
        ([16, 16], 1.996, "mortar"),
        ([24, 20], 2.0, "mortar"),
        ([24, 20], 2.0, "gauss_to_segment"),
    ] {
        let body = json!({"material": {"model": "linear", "E": 1000, "nu": 0.3}});
        let case = json!({
            "mesh": {"blocks": [ring("inner", elements[0], [1.0, rim]), ring("outer", elements[1], [2.0, 3.0])]},
            "bodies": {"inner": body, "outer": body},
            "contacts": {"fit": {"slave": "outer_inside", "master": "inner_outside", "method": method, "clearance": -delta, "shrink_fit": true,
                                 "friction": {"law": "frictionless"}}},
            "steps": [{"name": "fit", "duration": 1, "dt": {"initial": 0.25}, "supports": [
                {"on": "inner_bottom", "uy": 0}, {"on": "inner_top", "ux": 0}, {"on": "outer_bottom", "uy": 0}, {"on": "outer_top", "ux": 0}]}]
        });
        let message = model(&case).warnings();
        assert!(message.is_empty() || method == "gauss_to_segment", "{message:?}");
        let run = finish(&case);
        for (time, share) in [(0.5, 0.5), (1.0, 1.0)] {
            let [found, _] = tractions(run.at(time));
            let mean = found.iter().sum::<f64>() / found.len() as f64;
            println!(
                "{elements:?}, rim {rim}, {method}, t = {time}: {:+.3} %",
                100.0 * (mean / (share * pressure) - 1.0)
            );
            close("mean pressure", mean, share * pressure, 0.01 * share * pressure);
        }
        close("audit", run.last().energy.error(), 0.0, 2e-3 * run.last().energy.external_work);
    }
}

/// Bars of length 1 and E = 1000 whose ends touch in the mesh, or overlap by 0.01 there, with a clearance of 0.002: pushed together by
/// 0.006, each is shortened by 0.002, and by the rest of a contact of 1e6.
#[test]
fn a_clearance_is_closed_before_anything_is_pressed() {
    for drawn in [0.0, -0.01] {
        for sliding in ["finite", "small"] {
            let mut case = json!({
                "mesh": Blocks::default().rectangle("lower", [3, 2], [0.0, -1.0], [1.0, 0.0]).rectangle("upper", [2, 2], [0.0, drawn], [1.0, 1.0 + drawn]).json(),
                "bodies": {"lower": {"material": {"model": "linear", "E": 1000, "nu": 0}}, "upper": {"material": {"model": "linear", "E": 1000, "nu": 0}}},
                "contacts": {"ends": {"slave": "upper_bottom", "master": "lower_top", "clearance": 0.002, "sliding": sliding, "normal": {"alpha_n": 1e6},
                                      "friction": {"law": "frictionless"}}},
                "steps": [{"name": "close", "duration": 1, "dt": {"initial": 0.25},
                           "supports": [{"on": "lower_bottom", "ux": 0, "uy": 0}, {"on": "upper_top", "ux": 0, "uy": -0.006}]}]
            });
            let run = finish(&case);
            let pressure = 0.004 / (2.0 / 1000.0 + 1e-6);
            let [found, _] = tractions(run.last());
            found.iter().for_each(|found| close("pressure", *found, pressure, 1e-6 * pressure));
            let [early, _] = tractions(run.at(0.25));
            assert!(early.iter().all(|pressure| *pressure == 0.0), "{early:?}");
            case["contacts"]["ends"]["clearance"] = json!(-0.2);
            let message = model(&case).warnings();
            assert!(
                message.iter().any(|message| message.contains("`clearance` changes the gap of the mesh by")),
                "{message:?}"
            );
        }
    }
}
