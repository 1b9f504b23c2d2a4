//! What a run writes for its reader: the columns of `history.csv`, the frames, and lines of progress.

mod registered;

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::Arc;

use crate::common::{self, Blocks, Record, close};
use crate::delayed::DelayedPressure;
use fecontact::laws::friction::{FrictionLaw, Regime, Sliding};
use fecontact::output::history::History;
use fecontact::output::results::Grid;
use serde_json::{Value, json};
use tempfile::TempDir;
use vtkio::model::{Attribute, CellType, DataSet, UnstructuredGridPiece, VertexNumbers};

const ALPHA_T: f64 = 800.0;

/// A mass pressed on a plane and pulled by a spring.
fn slider(duration: f64, dt: f64) -> Value {
    json!({
        "title": "A mass pulled over a plane",
        "units": {"length": "m", "force": "N", "time": "s"},
        "mesh": {"nodes": [[0, 0]], "points": {"block": [0]}},
        "point_masses": {"block": {"mass": 10}},
        "contacts": {"base": {
            "slave": "block", "area": 2, "normal": {"alpha_n": 1000}, "initial": {"pressure": 50, "traction": 1},
            "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "friction": {"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "alpha_t": ALPHA_T, "r": 100, "kappa": 10}
        }},
        "steps": [{"name": "pull", "duration": duration, "scheme": {"newmark": {}}, "dt": {"initial": dt}, "loads": [
            {"on": "block", "force": {"y": "-100"}},
            {"on": "block", "spring": {"kx": 10, "driver": {"x": {"rate": 0.5}}}}
        ]}],
        "watch": ["block"],
        "output": {"fields": false}
    })
}

fn attempt(folder: &Path, case: &Value) -> Output {
    fs::write(folder.join("case.json"), case.to_string()).unwrap();
    Command::new(env!("CARGO_BIN_EXE_fecontact_tested"))
        .current_dir(folder)
        .args(["run", "case.json"])
        .output()
        .unwrap()
}

fn run(folder: &Path, case: &Value) -> Output {
    let output = attempt(folder, case);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    output
}

/// The columns that other programs rely on, in their order; new ones come last in their group.
#[test]
fn history_has_the_promised_columns() {
    let folder = TempDir::new().unwrap();
    run(folder.path(), &slider(10.0, 0.02));
    let text = fs::read_to_string(folder.path().join("out/case/history.csv")).unwrap();
    let header = "time,dt,step,iterations,kinetic,strain,contact_elastic,friction_dissipation,damping_dissipation,\
                  external_work,energy_error,base.normal_force,base.tangential_force,base.contact_length,\
                  base.slip_fraction,base.mean_slip,base.max_penetration,base.max_elastic_slip,base.mean_elastic_slip,\
                  block.ux,block.uy,block.fx,block.fy,base.force_x,base.force_y,base.moment,\
                  base.frictional_heat,base.frictional_power,base.scatter";
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some(header));
    let column = |name: &str| header.split(',').position(|column| column == name).unwrap();
    let mut pulled = false;
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), 29, "{line}");
        let number = |name: &str| cells[column(name)].parse::<f64>().unwrap();
        assert_eq!(cells[2], "pull");
        // One point of area 2: q = force/2, elastic slip q/α_t, plastic slip the rest of the motion.
        let elastic = number("base.tangential_force") / 2.0 / ALPHA_T;
        assert!((number("base.mean_elastic_slip") - elastic).abs() < 1e-15, "{line}");
        let slip = number("block.ux") - (number("base.mean_slip") + elastic - 1.0 / ALPHA_T);
        assert!(slip.abs() < 1e-12, "{slip}");
        assert_eq!(number("base.max_elastic_slip"), number("base.mean_elastic_slip").abs());
        pulled |= number("base.mean_slip") > 0.01;
    }
    assert!(pulled);
}

/// What the reader of results needs to know of the case stands in the summary.
#[test]
fn the_summary_tells_title_units_and_laws() {
    let folder = TempDir::new().unwrap();
    let case = slider(0.1, 0.02);
    run(folder.path(), &case);
    let summary = fs::read_to_string(folder.path().join("out/case/summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    for key in ["status", "reason", "version", "case", "dofs", "increments", "wall_s", "warnings"] {
        assert!(summary.get(key).is_some(), "{key} is missing");
    }
    assert_eq!(summary["title"], case["title"]);
    assert_eq!(summary["units"], case["units"]);
    let law = &summary["friction"]["base"];
    assert_eq!((&law["law"], law["mu_s"].as_f64()), (&json!("super_subloading"), Some(0.4)));
}

/// By Coulomb's law the mass sticks until its spring, k in series with the contact's α_t A, has brought μ N: T = (k v t + k q₀/α_t)/(1 + k/(α_t A))
/// = 30 at t = 6.035, with steps of 0.02. When the driver goes back by d, k d/(1 + k/(α_t A)) are taken off.
#[test]
fn the_last_lines_tell_how_friction_went() {
    let folder = TempDir::new().unwrap();
    let mut case = slider(10.0, 0.02);
    case["contacts"]["base"]["friction"] = json!({"law": "coulomb", "mu": 0.3, "alpha_t": ALPHA_T});
    let step = &mut case["steps"][0];
    step["scheme"] = json!("static");
    step["loads"][0]["force"]["y"] = json!("-100");
    step["loads"][1]["spring"]["driver"]["x"] = json!({"table": [[0, 0], [8, 4], [10, 3.6]]});
    let told = String::from_utf8(run(folder.path(), &case).stderr).unwrap();
    let summary = fs::read_to_string(folder.path().join("out/case/summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    let course = &summary["friction_course"]["base"];
    let number = |pointer: &str| course.pointer(pointer).and_then(Value::as_f64).unwrap().abs();
    let taken_off = 10.0 * 0.4 / (1.0 + 10.0 / (2.0 * ALPHA_T));
    for (pointer, expected) in [
        ("/first_slip", 6.04),
        ("/full_slip", 6.04),
        ("/largest/time", 6.04),
        ("/largest/tangential_force", 30.0),
        ("/largest/ratio", 0.3),
        ("/last/time", 10.0),
        ("/last/tangential_force", 30.0 - taken_off),
        ("/last/ratio", 0.3 - taken_off / 100.0),
    ] {
        close(pointer, number(pointer), expected, 1e-9);
    }
    let line = told.lines().find(|line| line.starts_with("contact `base`")).expect("a line");
    assert!(line.contains("full sliding from t = 6.04; peak tangential force "), "{line}");
    assert!(line.contains("30 (0.3000 of the normal force) at t = 6.04, ") && line.ends_with(" at the end"), "{line}");
    // What sticks to the end.
    case["steps"][0]["duration"] = json!(6.0);
    case["steps"][0]["loads"][1]["spring"]["driver"]["x"] = json!({"rate": 0.5});
    let told = String::from_utf8(run(folder.path(), &case).stderr).unwrap();
    assert!(told.contains("contact `base`: sticks; peak tangential force "), "{told}");
}

/// A run of thousands of quick increments does not drown its reader: it has ten lines; the history has them all.
#[test]
fn progress_does_not_drown_its_reader() {
    let folder = TempDir::new().unwrap();
    let output = run(folder.path(), &slider(60.0, 0.02));
    let lines = String::from_utf8_lossy(&output.stderr).lines().filter(|line| line.contains(" %  pull")).count();
    assert_eq!(lines, 10);
    let rows = fs::read_to_string(folder.path().join("out/case/history.csv")).unwrap().lines().count();
    assert_eq!(rows, 3000 + 1);
}

/// A frame as another reader of VTU files finds it.
fn frame(path: &Path) -> UnstructuredGridPiece {
    let DataSet::UnstructuredGrid { pieces, .. } = vtkio::Vtk::import(path).unwrap().data else { panic!("{path:?}") };
    pieces.into_iter().next().unwrap().into_loaded_piece_data(None).unwrap()
}

fn values(attributes: &[Attribute], name: &str) -> Vec<f64> {
    let array = attributes.iter().find_map(|attribute| match attribute {
        Attribute::DataArray(array) if array.name == name => Some(array),
        _ => None,
    });
    array.unwrap_or_else(|| panic!("no array `{name}`")).data.cast_into().unwrap()
}

/// A block pressed between walls: ε_yy = −δ/h, σ_yy = (λ + 2G) ε_yy, σ_xx = σ_zz = λ ε_yy, in closed form.
#[test]
fn frames_hold_the_uniform_stress_of_a_pressed_block() {
    let folder = TempDir::new().unwrap();
    let (young, nu, strain) = (1000.0, 0.25, -0.01);
    let (lambda, shear) = (young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), 0.5 * young / (1.0 + nu));
    let walls = json!([
        {"on": "block_bottom", "uy": 0}, {"on": "block_left", "ux": 0}, {"on": "block_right", "ux": 0},
        {"on": "block_top", "uy": 2.0 * strain}
    ]);
    let case = json!({
        "mesh": Blocks::default().rectangle("block", [3, 2], [0.0, 0.0], [3.0, 2.0]).json(),
        "bodies": {"block": {"material": {"model": "linear", "E": young, "nu": nu}}},
        "steps": [{"name": "press", "duration": 1, "scheme": "static", "dt": {"initial": 0.5}, "supports": walls}],
        "output": {"exact": true}
    });
    run(folder.path(), &case);
    let out = folder.path().join("out/case");
    let collection = fs::read_to_string(out.join("solid.pvd")).unwrap();
    assert_eq!(collection.matches("<DataSet ").count(), 3, "{collection}");
    assert!(!out.join("contact.pvd").exists(), "there is no contact");
    for (number, share) in [(0, 0.0), (1, 0.5), (2, 1.0)] {
        let piece = frame(&out.join(format!("solid/{number:05}.vtu")));
        let places: Vec<f64> = piece.points.cast_into().unwrap();
        assert_eq!(places.len(), 3 * 12);
        assert_eq!(piece.cells.types, [CellType::Quad; 6]);
        assert_eq!(values(&piece.data.cell, "body"), [0.0; 6]);
        let displacement = values(&piece.data.point, "displacement");
        for (x, u) in places.chunks_exact(3).zip(displacement.chunks_exact(3)) {
            close("u_x", u[0], 0.0, 1e-14);
            close("u_y", u[1], share * strain * x[1], 1e-14);
        }
        let (across, along) = (share * lambda * strain, share * (lambda + 2.0 * shear) * strain);
        // VTK's six components of a symmetric tensor.
        for stress in values(&piece.data.point, "stress").chunks_exact(6) {
            for (value, expected) in stress.iter().zip([across, along, across, 0.0, 0.0, 0.0]) {
                close("stress", *value, expected, 1e-10);
            }
        }
        let pressure = -(along + 2.0 * across) / 3.0;
        values(&piece.data.point, "mean_pressure").iter().for_each(|&p| close("pressure", p, pressure, 1e-10));
        let von_mises = (along - across).abs();
        values(&piece.data.point, "von_mises").iter().for_each(|&s| close("von Mises", s, von_mises, 1e-10));
        let reaction = values(&piece.data.point, "reaction");
        let on_top = reaction.chunks_exact(3).zip(places.chunks_exact(3)).filter(|(_, x)| x[1] == 2.0);
        close("force on top", on_top.map(|(force, _)| force[1]).sum(), 3.0 * along, 1e-10);
    }
}

/// Frames of bodies and interfaces are read back as vtkio finds them, and cut or changed ones are refused.
#[test]
fn frames_are_read_back_as_another_reader_finds_them() {
    let folder = TempDir::new().unwrap();
    for exact in [false, true] {
        let case = json!({
            "mesh": Blocks::default().rectangle("block", [3, 2], [0.0, 0.0], [3.0, 2.0]).json(),
            "units": {"force": "N", "length": "mm", "time": "s"},
            "bodies": {"block": {"material": {"model": "linear", "E": 1000, "nu": 0.25}}},
            "contacts": {"base": {
                "slave": "block_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
                "friction": {"law": "coulomb", "mu": 0.3}
            }},
            "steps": [{"name": "press", "duration": 1, "scheme": "static", "dt": {"initial": 1}, "supports": [
                {"on": "block_top", "ux": 0.001, "uy": -0.01}
            ]}],
            "output": {"exact": exact}
        });
        run(folder.path(), &case);
        for file in ["solid/00001.vtu", "contact/00001.vtu"] {
            let path = folder.path().join("out/case").join(file);
            let (own, other) = (Grid::read(&path).unwrap(), frame(&path));
            let places: Vec<f64> = other.points.cast_into().unwrap();
            assert_eq!(
                own.points.as_flattened(),
                places.chunks_exact(3).flat_map(|x| [x[0], x[1]]).collect::<Vec<_>>()
            );
            let VertexNumbers::XML { connectivity, offsets } = other.cells.cell_verts else { panic!("no cells") };
            let whole = |numbers: &[u32]| numbers.iter().map(|&number| u64::from(number)).collect::<Vec<_>>();
            assert_eq!((whole(&own.connectivity), whole(&own.ends)), (connectivity, offsets));
            assert_eq!(own.kinds, other.cells.types.iter().map(|kind| *kind as u8).collect::<Vec<_>>());
            for (arrays, attributes) in [(&own.at_points, &other.data.point), (&own.at_cells, &other.data.cell)] {
                assert_eq!(arrays.len(), attributes.len());
                for array in arrays {
                    // Of a tensor the four components of the plane are read back; the others are zero.
                    let all = values(attributes, &array.name);
                    let components = if array.components == 4 { 6 } else { array.components };
                    let own: Vec<f64> =
                        all.chunks(components).flat_map(|some| &some[..array.components]).copied().collect();
                    assert_eq!(array.values, own, "{}", array.name);
                    assert!(components == array.components || all.chunks(6).all(|tensor| tensor[4..] == [0.0, 0.0]));
                }
            }
            let text = fs::read_to_string(&path).unwrap();
            let cut = path.with_extension("cut");
            let end = text.rfind("</DataArray>").unwrap();
            let wrong = format!("{}A{}", &text[..end], &text[end..]);
            // Tensors, units and owners by the names that VTK knows.
            if file.starts_with("solid") {
                for part in ["ComponentName3=\"XY\" ComponentName4=\"YZ\"", "Name=\"body block\"", "<FieldData>"] {
                    assert!(text.contains(part), "{part}");
                }
                let stress = &text[text.find("Name=\"stress\"").unwrap()..];
                let key = "<InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">N/mm²</InformationKey>";
                assert!(stress[..stress.find("</DataArray>").unwrap()].ends_with(key));
            }
            for damaged in [&text[..text.len() / 3], &text[..text.len() / 2], &wrong, ""] {
                fs::write(&cut, damaged).unwrap();
                Grid::read(&cut).unwrap_err();
            }
        }
    }
}

#[test]
fn a_dynamic_run_ends_with_its_energy_audit() {
    let folder = TempDir::new().unwrap();
    let output = run(folder.path(), &slider(10.0, 0.02));
    let last_lines = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(last_lines.contains("energy: ") && last_lines.contains(" %) unaccounted for"), "{last_lines}");
    let text = fs::read_to_string(folder.path().join("out/case/summary.json")).unwrap();
    let energy = &serde_json::from_str::<Value>(&text).unwrap()["energy"];
    let of = |name: &str| energy[name].as_f64().unwrap();
    let history = fs::read_to_string(folder.path().join("out/case/history.csv")).unwrap();
    let last: Vec<&str> = history.lines().last().unwrap().split(',').collect();
    for (column, name) in ["kinetic", "strain", "contact_elastic", "friction_dissipation"].into_iter().enumerate() {
        assert_eq!(last[4 + column].parse::<f64>().unwrap(), of(name), "{name}");
    }
    let error: f64 = last[10].parse().unwrap();
    assert!(of("external_work") > 1.0 && error.abs() < 0.01 * of("external_work"), "{error} of {energy}");
}

/// A clay that nothing holds flies apart by the energy of its initial stress: increments that resolve how it loses its pressure end well,
/// others with more energy than there was.
#[test]
fn what_an_initial_stress_sets_free_is_supplied() {
    let thrown = |dt: f64| {
        let folder = TempDir::new().unwrap();
        let mut case = json!({
            "mesh": Blocks::default().rectangle("clay", [1, 1], [0.0, 0.0], [1.0, 1.0]).json(),
            "bodies": {"clay": {"material": {"model": "cam_clay", "lambda": 0.1, "kappa": 0.005, "e": 0.8, "phi": 28, "nu": 0.25, "OCR": 2,
                                             "p_min": 3, "density": 1e-3},
                                "initial_stress": {"components": {"xx": -1, "yy": -4, "zz": -2, "xy": 0}}}},
            "steps": [{"name": "go", "duration": 0.01, "dt": {"initial": dt}, "scheme": {"newmark": {}},
                       "supports": [{"on": "clay_bottom", "ux": 0, "uy": 0}]}]
        });
        case["output"]["fields"] = json!(false);
        let output = attempt(folder.path(), &case);
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, said) = thrown(2e-5);
    assert!(code == Some(0) && !said.contains("energy balance"), "{said}");
    let (code, said) = thrown(2e-3);
    assert!(
        code == Some(1) && said.contains("supplied (initial energy + external work, or freed by initial stress)"),
        "{said}"
    );
}

/// Multipliers, and stiff penalties, on a surface that has mass gain energy: more than all that was supplied, so that the run ends
/// with exit code 1 and a remedy that helps. The default penalty does not, in increments from a twentieth of the step down to what
/// resolves all; what it gives way by is told with a stiffer one that does not either.
#[test]
fn energy_from_nowhere_ends_with_a_remedy_that_helps() {
    let pressed = |normal: Value, massless: bool, dt: f64| {
        let folder = TempDir::new().unwrap();
        let mut case = json!({
            "mesh": Blocks::default().rectangle("block", [3, 2], [0.0, 0.0015], [1.0, 0.75]).json(),
            "bodies": {"block": {"material": {"model": "linear", "E": 800, "nu": 0.3, "density": 1e-3}}},
            "contacts": {"c": {"slave": "block_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
                               "massless": massless, "normal": normal,
                               "friction": {"law": "frictionless"}}},
            "steps": [{"name": "press", "duration": 0.02, "dt": {"initial": dt}, "scheme": {"newmark": {}},
                       "supports": [{"on": "block_top", "ux": 0, "uy": "-0.004*(t/0.02)^2*(3 - 2*t/0.02)"}]}]
        });
        case["output"]["fields"] = json!(false);
        let output = attempt(folder.path(), &case);
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let multipliers = json!({"alpha_n": 2e4, "penetration": 1e-9});
    let stiff = json!({"alpha_n": 1.3e6});
    for (normal, why) in [
        (&multipliers, "multipliers on surfaces that have mass gain energy"),
        (&stiff, "impact excites oscillations that the increments do not resolve: make the contact `massless`"),
    ] {
        let (code, struck) = pressed(normal.clone(), false, 4e-5);
        assert_eq!(code, Some(1), "{struck}");
        assert!(struck.contains("the results are not usable") && struck.contains(why), "{struck}");
        let (code, massless) = pressed(normal.clone(), true, 4e-5);
        assert_eq!(code, Some(0), "{massless}");
        assert!(!massless.contains("energy balance violated"), "{massless}");
    }
    for dt in [1e-3, 2.5e-4, 6e-5, 1e-5, 2e-6] {
        let (code, softer) = pressed(json!({}), false, dt);
        assert_eq!(code, Some(0), "{softer}");
        assert!(!softer.contains("energy balance violated"), "{softer}");
        assert!(
            softer.contains("\"massless\": true, as a stiff penalty oscillates on mass, and \"alpha_n\""),
            "{softer}"
        );
    }
}

/// Frames of an explicit step come with every n-th row of the history, not with every n-th of its many increments, and with
/// the last.
#[test]
fn frames_of_explicit_steps_come_with_every_nth_row() {
    for (every, interval, expected) in [
        (1, 0.25, vec![0.0, 0.25, 0.5, 0.75, 1.0]),
        (4, 0.05, vec![0.0, 0.2, 0.4, 0.6, 0.8, 1.0]),
        (7, 0.04, vec![0.0, 0.28, 0.56, 0.84, 1.0]),
    ] {
        let folder = TempDir::new().unwrap();
        let case = json!({
            "mesh": Blocks::default().rectangle("bar", [10, 2], [0.0, 0.0], [1.0, 0.1]).json(),
            "bodies": {"bar": {"material": {"model": "linear", "E": 1000, "nu": 0, "density": 1}}},
            "initial_velocity": {"bar": [0, 1e-3]},
            "steps": [{"name": "free", "duration": 1, "scheme": {"explicit": {}}, "supports": [{"on": "bar_left", "ux": 0}]}],
            "output": {"every": every, "interval": interval}
        });
        run(folder.path(), &case);
        let collection = fs::read_to_string(folder.path().join("out/case/solid.pvd")).unwrap();
        let times = collection.split("timestep=\"").skip(1).map(|rest| rest.split('"').next().unwrap());
        let times: Vec<f64> = times.map(|time| time.parse().unwrap()).collect();
        assert_eq!(times.len(), expected.len(), "every {every}: {times:?}");
        times.iter().zip(&expected).for_each(|(time, expected)| close("time of a frame", *time, *expected, 1e-9));
    }
}

/// Unless a case says otherwise there are some thirty frames, equally many in every step: the first row at or after each fifteenth
/// of it. Their values are those of the exact ones in single precision, the places those in double precision.
#[test]
fn some_thirty_frames_come_by_themselves_in_single_precision() {
    let step = |name: &str, duration: f64, dt: f64| {
        json!({"name": name, "duration": duration, "dt": {"initial": dt, "max": dt}, "supports": [
            {"on": "bar_left", "ux": 0, "uy": 0}, {"on": "bar_right", "ux": {"rate": 1e-3}, "uy": 0}]})
    };
    let case = |output: Value| {
        json!({
            "mesh": Blocks::default().rectangle("bar", [3, 1], [0.0, 0.0], [1.0, 0.1]).json(),
            "bodies": {"bar": {"material": {"model": "linear", "E": 1000, "nu": 0.3}}},
            "steps": [step("one", 1.0, 0.01), step("two", 8.0, 0.25)],
            "output": output
        })
    };
    let folder = TempDir::new().unwrap();
    run(folder.path(), &case(json!({})));
    let out = folder.path().join("out/case");
    let collection = fs::read_to_string(out.join("solid.pvd")).unwrap();
    let times = collection.split("timestep=\"").skip(1).map(|rest| rest.split('"').next().unwrap());
    let times: Vec<f64> = times.map(|time| time.parse().unwrap()).collect();
    // Increments of a hundredth, and of a thirty-second, of the steps.
    let part = |k: u32, rows: f64| (f64::from(k) / 15.0 * rows - 1e-9).ceil() / rows;
    let expected = (1..=15).map(|k| part(k, 100.0)).chain((1..=15).map(|k| 1.0 + 8.0 * part(k, 32.0)));
    assert_eq!(times.len(), 31, "{times:?}");
    times[1..].iter().zip(expected).for_each(|(time, expected)| close("time of a frame", *time, expected, 1e-9));

    let file = "solid/00021.vtu";
    let single = frame(&out.join(file));
    fs::remove_dir_all(&out).unwrap();
    run(folder.path(), &case(json!({"exact": true})));
    let exact = frame(&out.join(file));
    let places = |piece: &UnstructuredGridPiece| piece.points.clone().cast_into::<f64>().unwrap();
    assert_eq!(places(&single), places(&exact));
    for name in ["displacement", "stress", "von_mises", "reaction"] {
        let [single, exact] = [&single, &exact].map(|piece| values(&piece.data.point, name));
        assert!(exact.iter().any(|value| f64::from(*value as f32) != *value), "{name} has digits to lose");
        assert_eq!(single, exact.iter().map(|value| f64::from(*value as f32)).collect::<Vec<_>>(), "{name}");
    }
}

/// What slides without friction has no fronts.
#[test]
fn frictionless_contacts_have_no_fronts() {
    for (friction, fronts) in [(json!({"law": "frictionless"}), false), (json!({"law": "coulomb", "mu": 0.1}), true)] {
        let folder = TempDir::new().unwrap();
        let case = json!({
            "mesh": Blocks::default().rectangle("slab", [4, 2], [0.0, 0.0], [1.0, 0.5]).json(),
            "bodies": {"slab": {"material": {"model": "linear", "E": 1000, "nu": 0.3}}},
            "contacts": {"guide": {
                "slave": "slab_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
                "friction": friction, "initial": {"pressure": 1}
            }},
            "steps": [{"name": "slide", "duration": 1, "dt": {"initial": 0.1},
                       "supports": [{"on": "slab_top", "ux": {"rate": 0.1}, "uy": 0}]}],
            "output": {"fields": false, "fronts": {"slip_rate": 0.01}}
        });
        run(folder.path(), &case);
        let rows =
            |name: &str| fs::read_to_string(folder.path().join("out/case").join(name)).unwrap().lines().count() - 1;
        assert_eq!(rows("fronts.csv") > 0, fronts, "{friction}");
    }
}

/// Attempts of a run by what `newton.csv` says became of them, with its summary.
fn verdicts(case: &Value) -> (std::collections::BTreeMap<String, usize>, Value) {
    let folder = TempDir::new().unwrap();
    run(folder.path(), case);
    let text = fs::read_to_string(folder.path().join("out/case/newton.csv")).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap();
    let column = |name: &str| header.iter().position(|column| *column == name).unwrap();
    let [increment, attempt, verdict, reason] = ["increment", "attempt", "verdict", "reason"].map(column);
    let rows: Vec<[String; 3]> = lines
        .map(|row| {
            // Commas in reasons would be further cells.
            assert_eq!(row.len(), header.len(), "{row:?}");
            assert_eq!(row[verdict] == "accepted", row[reason].is_empty(), "{row:?}");
            [row[increment], row[attempt], row[verdict]].map(Into::into)
        })
        .collect();
    let mut counts = std::collections::BTreeMap::new();
    for attempt in rows.chunk_by(|a, b| a == b) {
        *counts.entry(attempt[0][2].clone()).or_insert(0) += 1;
    }
    (counts, serde_json::from_slice(&fs::read(folder.path().join("out/case/summary.json")).unwrap()).unwrap())
}

/// A square pressed flat: the second increment starts from a guess in which it is inside out, before anything is solved. It has a row
/// of its own, is told of, and counted.
#[test]
fn what_fails_before_a_solve_is_told_as_well() {
    let case = json!({
        "mesh": {"nodes": [[0, 0], [1, 0], [1, 1], [0, 1]], "elements": {"sled": [[0, 1, 2, 3]]},
            "edges": {"bottom": [[0, 1]], "top": [[2, 3]]}},
        "bodies": {"sled": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}}},
        "contacts": {"base": {"slave": "bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "normal": {"alpha_n": 13462}, "friction": {"law": "coulomb", "mu": 0.4}}},
        "steps": [{"name": "press", "duration": 1, "dt": {"initial": 1, "min": 0.01},
            "supports": [{"on": "top", "ux": 0, "uy": -1.5}]}],
        "output": {"fields": false}
    });
    let folder = TempDir::new().unwrap();
    let output = run(folder.path(), &case);
    let out = folder.path().join("out/case");
    let text = fs::read_to_string(out.join("newton.csv")).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    let column = |name: &str| rows[0].iter().position(|column| *column == name).unwrap();
    let [iteration, verdict, reason] = ["iteration", "verdict", "reason"].map(column);
    let unsolved: Vec<&Vec<&str>> = rows.iter().filter(|row| row[iteration] == "0").collect();
    let [row] = unsolved[..] else { panic!("one attempt had no solve: {text}") };
    assert!(row[verdict] == "unsolved" && row[reason].starts_with("element 0 of body `sled` is inverted (det F = -"));
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(told.contains("\nrejected attempts: 2 × element inverted (see column `reason` of newton.csv)\n"), "{told}");
    assert!(rows.iter().any(|row| row[reason].contains("is inverted (det F = -4.821e-1) at (0.5; 0.5)")), "{text}");
    let summary: Value = serde_json::from_slice(&fs::read(out.join("summary.json")).unwrap()).unwrap();
    assert_eq!((&summary["given_up"], &summary["cutbacks"]), (&json!({"element inverted": 2}), &json!(2)));
    // Rows with a solve are as many as solves; and no file is listed that is not there.
    let solves = rows[1..].iter().filter(|row| row[iteration] != "0").count();
    assert_eq!(summary["newton_iterations"], solves);
    let files: Vec<&str> = summary["files"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    assert!(files.contains(&"checkpoint.bin") && files.iter().all(|file| out.join(file).exists()), "{files:?}");
}

/// Every attempt says whether it was accepted or why not, and as many of each kind as the summary counts.
#[test]
fn every_attempt_says_what_became_of_it() {
    let mut inaccurate = slider(10.0, 1e-3);
    inaccurate["steps"][0]["dt"] = json!({"initial": 1e-3, "min": 1e-7, "max": 1, "error": 1e-6});
    let mut laborious = slider(10.0, 0.5);
    laborious["newton"] = json!({"max_iterations": 4});
    laborious["steps"][0]["dt"] = json!({"initial": 2, "min": 1e-4});
    let block = Blocks::default().rectangle("ground", [6, 2], [0.0, -0.5], [3.0, 0.0]).rectangle(
        "block",
        [3, 2],
        [0.4, 0.01],
        [1.4, 0.51],
    );
    let material = json!({"model": "linear", "E": 100, "nu": 0.3});
    let touching = json!({
        "mesh": block.json(),
        "bodies": {"ground": {"material": material}, "block": {"material": material}},
        "contacts": {"base": {"slave": "block_bottom", "master": "ground_top",
            "friction": {"law": "coulomb", "mu": 0.3, "alpha_t": 2e3}}},
        "steps": [{"name": "land", "duration": 1, "dt": {"initial": 0.1, "max": 0.1, "min": 1e-4}, "supports": [
            {"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": "0.02*t", "uy": "-0.03*t"}]}],
        "output": {"fields": false}
    });
    let mut rupturing = crate::survive::ruptures();
    rupturing["output"] = json!({"fields": false, "report": false, "interval": 1e-2});
    for (case, kind) in [(inaccurate, "error"), (laborious, "unsolved"), (touching, "touch"), (rupturing, "rupture")] {
        let (counts, summary) = verdicts(&case);
        let count = |name: &str| counts.get(name).copied().unwrap_or(0) as u64;
        assert!(count(kind) > 0, "{kind}: {counts:?}");
        assert_eq!(count("error") + count("touch") + count("rupture"), summary["rejected"], "{kind}: {counts:?}");
        assert_eq!(count("unsolved"), summary["cutbacks"], "{kind}: {counts:?}");
        let given_up = summary["given_up"].as_object().unwrap();
        let by_kind = |kind: &str| given_up.get(kind).and_then(Value::as_u64).unwrap_or(0);
        assert_eq!(
            [by_kind("time error"), by_kind("contact closure"), by_kind("rupture")],
            [count("error"), count("touch"), count("rupture")],
            "{kind}: {given_up:?}"
        );
        let all: u64 = given_up.values().filter_map(Value::as_u64).sum();
        assert_eq!(
            all,
            counts.iter().filter(|(verdict, _)| *verdict != "accepted").map(|(_, n)| *n as u64).sum::<u64>()
        );
        assert!(count("accepted") > 0 && counts.len() <= 5);
    }
}
