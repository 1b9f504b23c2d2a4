//! Files, paths and names.

use super::*;

#[test]
fn files_that_are_no_meshes_are_refused() {
    let folder = TempDir::new().unwrap();
    write(folder.path(), "old.msh", "$MeshFormat\n2.1 0 8\n$EndMeshFormat\n");
    write(folder.path(), "cut.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n4 4 1 0\n1 0 0 0 0\n");
    write(folder.path(), "empty.msh", "");
    fs::create_dir(folder.path().join("folder.msh")).unwrap();
    for (mesh, fragments) in [
        ("nowhere.msh", ["nowhere.msh: ", "there is no such mesh file"]),
        ("folder.msh", ["folder.msh: ", "not a file but a folder"]),
        ("old.msh", ["old.msh: ", "MSH format 2.1, and only 4.1 and 2.2 are read"]),
        ("cut.msh", ["cut.msh: ", "the file was cut short"]),
        ("empty.msh", ["empty.msh: ", "not a gmsh mesh"]),
    ] {
        write(folder.path(), "bad.json", with(&[("/mesh", json!(mesh))]).to_string());
        refused(folder.path(), &["run", "bad.json"], &[&["error: bad.json: mesh: "], &fragments[..]].concat());
    }
}

/// Two files are one mesh, unless both have a group, or a node that is named by its tag.
#[test]
fn what_two_mesh_files_share_is_refused() {
    let folder = TempDir::new().unwrap();
    let file = |body: &str, y: f64, top: &str| {
        let [low, high] = [y, y + 1.0];
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"{body}_bottom\"\n1 2 \"{top}\"\n2 3 \"{body}\"\n\
             $EndPhysicalNames\n$Nodes\n4\n1 0 {low} 0\n2 1 {low} 0\n3 1 {high} 0\n4 0 {high} 0\n$EndNodes\n$Elements\n3\n\
             1 1 2 1 1 1 2\n2 1 2 2 1 3 4\n3 3 2 3 1 1 2 3 4\n$EndElements\n"
        )
    };
    write(folder.path(), "ground.msh", file("ground", -1.0, "ground_top"));
    write(folder.path(), "block.msh", file("block", 0.0, "block_top"));
    write(folder.path(), "clash.msh", file("block", 0.0, "ground_top"));
    let both = |edits: &[(&str, Value)]| {
        let mesh = ("/mesh", json!(["ground.msh", "block.msh"]));
        with(&[std::slice::from_ref(&mesh), edits].concat()).to_string()
    };
    write(folder.path(), "good.json", both(&[]));
    let checked = fecontact(folder.path(), &["check", "good.json"]);
    assert_eq!(checked.status.code(), Some(0), "{}", stderr(&checked));
    let message = String::from_utf8_lossy(&checked.stdout).into_owned();
    assert!(message.contains("ground.msh, block.msh") && message.contains("8 nodes, 2 elements"), "{message}");
    let node = json!([{"node": 3}]);
    for (edits, fragments) in [
        (vec![("/mesh/1", json!("clash.msh"))], ["mesh[1]: ", "`ground_top` is in ground.msh and in clash.msh"]),
        (vec![("/mesh/1", json!("ground.msh"))], ["mesh[1]: ", "is in ground.msh and in ground.msh"]),
        (vec![("/mesh/1", json!("nowhere.msh"))], ["mesh: nowhere.msh: ", "no such mesh file"]),
        (
            vec![("/watch", node)],
            ["watch[0]: ", "several of the mesh files have a node 3: name it by {\"near\": [x, y]}"],
        ),
    ] {
        write(folder.path(), "bad.json", both(&edits));
        refused(folder.path(), &["run", "bad.json"], &fragments);
    }
}

#[test]
fn a_hundred_megabytes_of_garbage_are_refused() {
    let folder = TempDir::new().unwrap();
    let mut file = fs::File::create(folder.path().join("garbage")).unwrap();
    let block: Vec<u8> = (0..1u32 << 20).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    (0..100).for_each(|_| file.write_all(&block).unwrap());
    drop(file);
    refused(folder.path(), &["run", "garbage"], &["error: garbage: ", "larger than 16 MiB"]);
    write(folder.path(), "bad.json", with(&[("/mesh", json!("garbage"))]).to_string());
    refused(folder.path(), &["run", "bad.json"], &["garbage", "not a gmsh mesh"]);
}

#[test]
fn paths_and_arguments_are_checked() {
    let folder = TempDir::new().unwrap();
    write(folder.path(), "good.json", good().to_string());
    write(folder.path(), "file", "");
    refused(folder.path(), &["run", "nowhere.json"], &["nowhere.json: ", "there is no such file"]);
    refused(folder.path(), &["run", "."], &["error: .: ", "is a folder"]);
    refused(folder.path(), &["run", "good.json", "--out", "file/results"], &["file/results: --out: results cannot"]);
    refused(folder.path(), &["run", "good.json", "--out", "file"], &["file: --out: results cannot be written here"]);
    refused(folder.path(), &["run", "good.json", "--out", ""], &["--out"]);
    refused(folder.path(), &["run", "good.json", "--threads", "0"], &["--threads 0: give 1 to"]);
    refused(folder.path(), &["run", "good.json", "--threads", "1000000"], &["--threads 1000000: give 1 to"]);
    refused(folder.path(), &["run", "good.json", "--threads", "-1"], &["-1"]);
    refused(folder.path(), &["run", "good.json", "--threads", "many"], &["many"]);
    refused(folder.path(), &["walk"], &["walk"]);
}

/// Text that steers a terminal is spelled out, on stdout and on stderr.
#[test]
fn control_characters_are_never_printed() {
    let steering = "\u{1b}[2J\u{1b}]0;x\u{7}\u{202e}";
    let plain = |text: &str| {
        let raw = text.chars().find(|c| (c.is_control() && *c != '\n') || *c == '\u{202e}');
        assert_eq!(raw, None, "{text:?}");
        assert!(text.contains("\\u{1b}[2J") || text.contains("\\u{202e}"), "{text:?}");
    };
    let [printed, _] = outcome("check", &[("/title", json!("\u{202e}turned"))]);
    plain(&printed);
    let folder = TempDir::new().unwrap();
    for edit in [
        (format!("/{steering}"), json!(1)),
        ("/title".into(), json!(steering)),
        ("/units".into(), json!({"length": steering})),
        (format!("/bodies/{steering}"), good()["bodies"]["block"].clone()),
        ("/mesh".into(), json!(format!("{steering}.msh"))),
        ("/watch".into(), json!([steering])),
        ("/steps/0/duration".into(), json!(steering)),
        ("/steps/0/supports/0/on".into(), json!(steering)),
        ("/steps/0/supports/1/uy".into(), json!(format!("t + {steering}"))),
    ] {
        write(folder.path(), "bad.json", with(&[(&edit.0, edit.1)]).to_string());
        let output = fecontact(folder.path(), &["check", "bad.json"]);
        assert_eq!(output.status.code(), Some(2));
        plain(&stderr(&output));
    }
    // A file name with a line break makes no line of its own.
    write(folder.path(), "bad.json", with(&[("/mesh", json!("a\nerror: b.msh"))]).to_string());
    assert_eq!(stderr(&fecontact(folder.path(), &["check", "bad.json"])).lines().count(), 1);
}

/// Names become columns and files, titles and units stand in figures: what could not be written, or not be read again, is refused
/// before anything is.
#[test]
fn names_that_no_file_can_have_are_refused() {
    let long = "n".repeat(200);
    let wide = "接".repeat(40);
    let renamed = |pointer: &str, from: &str, to: &str| {
        let mut case = good();
        let object = case.pointer_mut(pointer).and_then(Value::as_object_mut).expect("an object");
        let value = object.remove(from).expect("it is there");
        object.insert(to.into(), value);
        case
    };
    let body = |name: &str| {
        let text = renamed("/bodies", "block", name).to_string();
        let mut case: Value = serde_json::from_str(&text).expect("JSON");
        let elements = case["mesh"]["elements"].as_object_mut().expect("elements");
        let own = elements.remove("block").expect("a body");
        elements.insert(name.into(), own);
        case
    };
    let with_probe = |name: &str| with(&[("/probes", json!({name: {"at": [0.5, 0.5]}}))]);
    let refused: [(Value, &[&str]); 12] = [
        (
            renamed("/contacts", "base", &long),
            &["contacts: the name \"nnnnnnnnnnnnnnnnnnnn\"… is 200 bytes long", "take at most 100"],
        ),
        (renamed("/contacts", "base", &wide), &["contacts: the name", "is 120 bytes long"]),
        (renamed("/contacts", "base", "a\u{1}b"), &["contacts: the name", "'\\u{1}'"]),
        (renamed("/contacts", "base", "a\u{ffff}"), &["contacts: the name", "'\\u{ffff}'"]),
        (body(&long), &["bodies: the name", "is 200 bytes long"]),
        (body("a,b"), &["bodies: the name \"a,b\" has ',' in it"]),
        (body("a\"b"), &["bodies: the name", "has '\"' in it"]),
        (with(&[("/steps/0/name", json!(long))]), &["steps[0].name: the name", "is 200 bytes long"]),
        (with_probe(&long), &["probes.", "is 200 bytes long"]),
        (with_probe("a\nb"), &["probes.", "'\\n'"]),
        (with(&[("/title", json!("a\u{1}b"))]), &["title: \"a\\u{1}b\" has '\\u{1}' in it"]),
        (with(&[("/units", json!({"length": "m\u{0}"}))]), &["units.length: ", "has '\\0' in it"]),
    ];
    for (case, expected) in refused {
        let folder = TempDir::new().unwrap();
        write(folder.path(), "bad.json", case.to_string());
        for command in [&["check", "bad.json"][..], &["run", "bad.json", "--out", "out"]] {
            let output = fecontact(folder.path(), command);
            let message = stderr(&output);
            assert_eq!(output.status.code(), Some(2), "{message}");
            assert!(expected.iter().all(|part| message.contains(part)), "{expected:?}: {message}");
        }
        assert!(!folder.path().join("out").exists());
    }
}

/// Names that look like paths, or differ by case alone, stay in the folder, each with arrays of its own; so does the longest.
#[test]
fn names_of_contacts_never_leave_the_folder() {
    let longest = "n".repeat(100);
    let names = ["a/b", "A/B", "..", "../../up", ".hidden", "a b", "é", longest.as_str(), "con", "a\\b", "<&>'"];
    let mut case = good();
    let base = case["contacts"]["base"].clone();
    case["contacts"] =
        names.iter().map(|name| ((*name).to_string(), base.clone())).collect::<serde_json::Map<_, _>>().into();
    case["title"] = json!("<&> \u{202e}");
    let folder = TempDir::new().unwrap();
    write(folder.path(), "case.json", case.to_string());
    let output = fecontact(folder.path(), &["run", "case.json", "--quiet", "--out", "out"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let beside: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(beside.len(), 2, "{beside:?}");
    let arrays: Vec<String> = fs::read_dir(folder.path().join("out/interface.zarr"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap().to_lowercase())
        .filter(|name| name.ends_with(".slip"))
        .collect();
    let different: std::collections::BTreeSet<&String> = arrays.iter().collect();
    assert_eq!((arrays.len(), different.len()), (names.len(), names.len()), "{arrays:?}");
}

/// Meshes that have areas everywhere, and still cannot be computed with, are named by element or line.
#[test]
fn degenerate_meshes_are_named() {
    let node = |k: usize, at: [f64; 2]| {
        let mut nodes = good()["mesh"]["nodes"].clone();
        nodes[k] = json!(at);
        [("/mesh/nodes", nodes)]
    };
    refused_edits(
        &node(8, [1.5, 0.0]),
        &[
            "mesh: element 1 of `block` is degenerate: its side from node 7 to node 8 is 0.000e0 long",
            "merge the two nodes",
        ],
    );
    refused_edits(
        &node(8, [1.5 + 1e-9, 0.0]),
        &["element 1 of `block` is degenerate: its side from node 7 to node 8 is 1.000e-9"],
    );
    outcome("check", &node(8, [1.5 + 1e-6, 0.0]));
    let moved: Vec<Value> = good()["mesh"]["nodes"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|node| json!([node[0].as_f64().expect("x") + 2f64.powi(44), node[1]]))
        .collect();
    refused_edits(
        &[("/mesh/nodes", moved.into())],
        &["element 0 of `block` lies so far from the origin that the positions of its nodes are known to 3.9e-3 only"],
    );
}
