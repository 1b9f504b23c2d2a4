//! Text, keys and types: what is no case.

use super::*;

/// Whatever a value is chosen from: no variant lets a key pass that it does not know, nor does an object inside it.
#[test]
fn every_variant_refuses_unknown_keys() {
    let friction = "/contacts/base/friction";
    let material = "/bodies/block/material";
    let master = "/contacts/base/master";
    let (mesh, ux, scheme) = ("/mesh", "/steps/0/supports/1/ux", "/steps/0/scheme");
    let elastic = |model: &str| json!({"model": model, "E": 1000, "nu": 0.3});
    let drag = json!({"rate": 1});
    for (pointer, value) in [
        (friction, json!({"law": "frictionless"})),
        (friction, json!({"law": "coulomb", "mu": 0.3})),
        (friction, json!({"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "r": 100})),
        (friction, json!({"law": "slip_weakening", "mu_s": 0.4, "mu_d": 0.2, "D_c": 1})),
        (friction, json!({"law": "rate_and_state", "f_0": 0.6, "V_0": 1, "a": 0.01, "b": 0.02, "D_c": 1})),
        (material, elastic("linear")),
        (material, elastic("saint_venant_kirchhoff")),
        (material, elastic("neo_hookean")),
        (material, elastic("hencky")),
        (master, json!({"plane": {"point": [0, 0], "normal": [0, 1]}})),
        (master, json!({"circle": {"centre": [0, -5], "radius": 5}})),
        (master, json!({"polyline": {"points": [[0, 0], [4, 0]]}})),
        (mesh, good()["mesh"].clone()),
        (ux, json!({"rate": 1})),
        (ux, json!({"table": [[0, 0], [1, 1]]})),
        (scheme, json!({"newmark": {"beta": 0.3}})),
        (scheme, json!({"hht": {"alpha": -0.05}})),
        (scheme, json!({"generalized_alpha": {"rho_infinity": 0.8}})),
        (scheme, json!({"explicit": {"safety": 0.9}})),
        (scheme, json!({"wilson": {"theta": 1.4}})),
        ("/steps/0/dt", json!({"initial": 0.5, "min": 0.01, "max": 0.5})),
        ("/steps/0/supports/1/on", json!({"node": 1})),
        ("/steps/0/supports/1", json!({"on": "block_top", "rotation": {"about": [0, 0], "angle": drag}})),
        ("/steps/0/loads", json!([{"on": "block_top", "pressure": drag}])),
        ("/steps/0/loads", json!([{"on": "block_top", "dead_pressure": drag}])),
        ("/steps/0/loads", json!([{"on": "block_top", "total_force": {"x": drag}}])),
        ("/steps/0/loads", json!([{"on": "block_top", "traction": {"x": drag}}])),
        ("/steps/0/loads", json!([{"on": "block", "gravity": {"x": 1}}])),
        ("/steps/0/loads", json!([{"on": "block_top", "force": {"x": 1}}])),
        ("/steps/0/loads", json!([{"on": "block_top", "spring": {"kx": 1, "driver": {"x": drag}}}])),
        ("/steps/0/loads", json!([{"on": "block_top", "dashpot": {"cx": 1, "driver": {"x": drag}}}])),
        ("/newton", json!({"tolerance": 1e-8})),
        ("/output", json!({"every": 1, "fronts": {"slip_rate": 1}})),
    ] {
        let case = with(&[(pointer, value.clone())]);
        let mut places = Vec::new();
        objects(&value, pointer, &mut places);
        for place in places {
            let bad = edited(case.clone(), &[(&format!("{place}/stray"), json!(1))]);
            let folder = TempDir::new().unwrap();
            write(folder.path(), "bad.json", bad.to_string());
            let message = stderr(&fecontact(folder.path(), &["check", "bad.json"]));
            // What is chosen by its only key has two now.
            let said =
                message.contains("stray") || message.contains("2 entries") || message.contains("exactly one key");
            assert!(said, "{place}: {message}");
            refused(folder.path(), &["check", "bad.json"], &["bad.json: "]);
        }
    }
    let frictionless = json!({"law": "frictionless", "mu": 0.3});
    refused_edits(
        &[(friction, frictionless)],
        &["contacts.base.friction.mu: ", "`mu` is not known here", "leave it out"],
    );
}

#[test]
fn unknown_keys_are_named_with_the_nearest() {
    for (pointer, place, nearest) in [
        ("/contact", "contact: ", "contacts"),
        ("/bodies/block/materail", "bodies.block.materail: ", "material"),
        ("/bodies/block/material/NU", "bodies.block.material.NU: ", "nu"),
        ("/contacts/base/slaves", "contacts.base.slaves: ", "slave"),
        ("/contacts/base/normal/alpha", "contacts.base.normal.alpha: ", "alpha_n"),
        ("/contacts/base/friction/mus", "contacts.base.friction.mus: ", "mu_s"),
        ("/steps/0/schema", "steps[0].schema: ", "scheme"),
        ("/steps/0/dt/minimum", "steps[0].dt.minimum: ", "min"),
        ("/steps/0/supports/1/uxx", "steps[0].supports[1].uxx: ", "ux"),
        ("/mesh/node", "mesh.node: ", "nodes"),
        ("/newton", "newton.", "tolerance"),
        ("/output", "output.", "every"),
    ] {
        let value = match pointer {
            "/newton" => json!({"tolerence": 1e-6}),
            "/output" => json!({"evry": 2}),
            _ => json!(1),
        };
        refused_edits(&[(pointer, value)], &[place, "is not known here", &format!("did you mean `{nearest}`?")]);
    }
    let support = |ux: Value| ("/steps/0/supports/1/ux", ux);
    refused_edits(&[support(json!({"rat": 1}))], &["steps[0].supports[1].ux", "`rat`", "did you mean `rate`?"]);
    refused_edits(&[support(json!({"rate": 1, "table": []}))], &["steps[0].supports[1].ux", "2 entries"]);
    refused_edits(&[("/steps/0/supports/1/on", json!({"nod": 1}))], &["supports[1].on.nod", "did you mean `node`?"]);
    let master = json!({"plane": {"point": [0, 0], "norm": [0, 1]}});
    refused_edits(&[("/contacts/base/master", master)], &["contacts.base.master.plane.norm", "`normal`"]);
}

#[test]
fn wrong_types_are_named() {
    for (pointer, value, fragments) in [
        ("/title", json!(3), ["title: ", "is 3, but must be text in quotes"]),
        ("/bodies/block/material/E", json!("soft"), ["bodies.block.material.E: ", "\"soft\", but must be a number"]),
        ("/bodies/block/material/nu", json!([0.3]), ["bodies.block.material.nu: ", "a list […], but must be a number"]),
        ("/contacts/base/friction/mu_s", json!(null), ["contacts.base.friction.mu_s: ", "null, but must be a number"]),
        ("/contacts/base/points", json!(2.5), ["contacts.base.points: ", "2.5, but must be a whole number"]),
        ("/contacts/base/points", json!(-2), ["contacts.base.points: ", "-2, but must be a whole number"]),
        ("/contacts/base/friction/approach", json!("linear"), ["contacts.base.friction.approach: ", "`logarithmic`"]),
        ("/contacts/base/friction/law", json!("colomb"), ["contacts.base.friction.law: ", "did you mean `coulomb`?"]),
        ("/contacts/base/method", json!("gauss"), ["contacts.base.method: ", "did you mean `gauss_to_segment`?"]),
        ("/contacts/base/master", json!(7), ["contacts.base.master: ", "is 7, but must be the name of an edge group"]),
        ("/bodies/block/material/model", json!("neohooke"), ["bodies.block.material.model: ", "`neo_hookean`"]),
        ("/steps/0/dt", json!([0.1]), ["steps[0].dt: ", "is a list […], but must be an object {…}"]),
        ("/steps", json!({}), ["steps: ", "an object {…}, but must be a list"]),
        ("/steps/0/duration", json!("1 s"), ["steps[0].duration: ", "\"1 s\", but must be a number"]),
        ("/steps/0/supports/0/uy", json!({}), ["steps[0].supports[0].uy: ", "an object {…} with exactly one key"]),
        (
            "/steps/0/scheme",
            json!("newmark"),
            ["steps[0].scheme.newmark: ", "is a name alone, but must be an object {…}"],
        ),
        ("/steps/0/supports/0/uy", json!(true), ["steps[0].supports[0].uy: ", "true, but must be a number, an expr"]),
        ("/steps/0/supports/0/uy", json!({"rate": "x"}), ["steps[0].supports[0].uy", "\"x\", but must be a number"]),
        ("/initial_velocity", json!({"block": [1, 2, 3]}), ["initial_velocity.block: ", "has 3 entries"]),
        ("/mesh", json!([3]), ["mesh[0]: ", "is 3, but must be text in quotes"]),
        ("/mesh", json!([]), ["mesh: ", "is an empty list: give the paths of mesh files"]),
        ("/mesh", json!(3), ["mesh: ", "must be the path of a mesh file, a list of such paths"]),
        ("/mesh/nodes/3", json!([1]), ["mesh.nodes[3]", "has 1 entries, but must have 2 numbers"]),
        ("/output", json!({"fields": 0}), ["output.fields: ", "0, but must be true or false"]),
    ] {
        refused_edits(&[(pointer, value)], &fragments);
    }
    for (pointer, place, key) in [
        ("/mesh", "bad.json: ", "mesh"),
        ("/bodies/block/material/E", "bodies.block.material: ", "E"),
        ("/bodies/block/material/model", "bodies.block.material: ", "model"),
        ("/steps/0/name", "steps[0]: ", "name"),
        ("/contacts/base/slave", "contacts.base: ", "slave"),
    ] {
        refused_case(without(pointer).to_string(), &[place, &format!("the key `{key}` is missing here")]);
    }
}

#[test]
fn text_that_is_no_case_is_refused() {
    refused_case("", &["is empty"]);
    refused_case(" \n", &["is empty"]);
    refused_case([0xff, 0xfe, 0x00], &["is not a text file"]);
    refused_case("mesh: a.msh", &["there is no JSON value at line 1, column 1"]);
    refused_case("[1, 2]", &["is a list […], but must be an object {…}"]);
    refused_case("3", &["is 3, but must be an object {…}"]);
    let text = good().to_string();
    for length in [1, 20, text.len() / 2, text.len() - 1] {
        refused_case(&text[..length], &["ends too early, at line 1"]);
    }
    refused_case(format!("{text} {text}"), &["has text after the end"]);
    refused_case(text.replacen("\"duration\":1", "\"duration\":NaN", 1), &["steps[0].duration: ", "no NaN"]);
    refused_case(text.replacen("\"duration\":1", "\"duration\":1e999", 1), &["steps[0].duration: ", "too large"]);
    refused_case("[".repeat(100_000), &["this is not JSON: recursion limit exceeded"]);
    refused_case(format!("{{\"{}\": 1}}", "x".repeat(1 << 20)), &["is not known here"]);
}

#[test]
fn a_key_that_stands_twice_is_refused() {
    let body = r#"{"material":{"model":"linear","E":1,"nu":0.3}}"#;
    let text = format!(r#"{{"mesh":"a.msh","bodies":{{"block":{body},"block":{body}}},"steps":[]}}"#);
    refused_case(text, &["bodies: ", "the key `block` appears here twice"]);
    refused_case(r#"{"contacts":{"base":{},"base":{}}}"#, &["contacts: ", "the key `base` appears here twice"]);
    refused_case(r#"{"title":"a","title":"b"}"#, &["the key `title` appears here twice"]);
}

/// serde's types would take the values of a list for the keys of an object in their order.
#[test]
fn lists_are_no_objects() {
    for (pointer, value) in [
        ("/contacts/base/normal", json!([4e5, null])),
        ("/steps/0/dt", json!([0.2, null, 0.2, null])),
        ("/bodies/block", json!([{"model": "linear", "E": 1000, "nu": 0.3}])),
        ("/bodies/block/material", json!(["neo_hookean", 1000, 0.3, 0])),
        ("/contacts/base/friction", json!(["coulomb", 0.3, 1e5])),
        ("/output", json!([3])),
        ("/newton", json!([1e-4, 3])),
        ("/steps/0/supports/0", json!(["ground_bottom", 0, 0])),
        ("/steps/0", json!(["press", 1])),
        ("/steps/0/loads", json!([["block", null, null, null, {"y": -1}]])),
        ("/steps/0/scheme", json!({"newmark": [0.25, 0.5]})),
        ("/contacts/base/master", json!({"plane": [[0, 0], [0, 1]]})),
        ("/mesh", json!([[[0, 0]]])),
        ("/steps/0/supports/1/ux", json!({"rate": [1]})),
    ] {
        let place = pointer[1..].replace('/', ".");
        let place = place.replace(".0", "[0]").replace(".1", "[1]");
        refused_edits(&[(pointer, value)], &[&place, "is a list […], but must be "]);
    }
    refused_case("[1, 2]", &["is a list […], but must be an object {…}"]);
}

/// "Did you mean" only where it may be true.
#[test]
fn what_is_like_nothing_known_is_not_likened() {
    for key in ["zz", "b0", "xyz", "comment"] {
        let folder = TempDir::new().unwrap();
        write(folder.path(), "bad.json", with(&[(&format!("/{key}"), json!(1))]).to_string());
        let said = stderr(&fecontact(folder.path(), &["check", "bad.json"]));
        assert!(said.contains(&format!("`{key}` is not known here. Known are `title`")), "{said}");
        assert!(!said.contains("did you mean"), "{said}");
    }
    let folder = TempDir::new().unwrap();
    write(folder.path(), "bad.json", with(&[("/watch", json!(["roof"]))]).to_string());
    let said = stderr(&fecontact(folder.path(), &["check", "bad.json"]));
    assert!(said.contains("the mesh has no group `roof`; it has `block`"), "{said}");
}
