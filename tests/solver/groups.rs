//! Groups of meshes that lack them: by place in the case, and by the entities of gmsh files without physical groups.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use fecontact::mesh::{Edge, Group, Mesh, PlacedGroup, gmsh};
use serde_json::{Value, json};

use crate::common::{close, finish, model, refusal};

/// A ring sector between the radii 1 and 2, from 0 to 90 degrees, and a square below it, without names of sides.
fn case(groups: Value) -> Value {
    json!({
        "mesh": {"blocks": [
            {"body": "ring", "corners": [[1, 0], [2, 0], [0, 2], [0, 1]], "arcs": [null, [0, 0], null, [0, 0]], "elements": [2, 4]},
            {"body": "square", "corners": [[0, -3], [2, -3], [2, -1], [0, -1]], "elements": [2, 2], "kind": "Q8"},
        ]},
        "groups": groups,
        "bodies": {"ring": {"material": {"model": "linear", "E": 100, "nu": 0.3}}, "square": {"material": {"model": "linear", "E": 100, "nu": 0.3}}},
        "steps": [{"name": "hold", "duration": 1, "dt": {"initial": 1},
                   "supports": [{"on": "ring", "ux": 0, "uy": 0}, {"on": "square", "ux": 0, "uy": 0}]}],
    })
}

fn edges<'a>(mesh: &'a Mesh, name: &str) -> &'a [Edge] {
    match mesh.group(name).expect("a group") {
        Group::Edges(edges) => edges,
        other => panic!("{name} is {other:?}"),
    }
}

#[test]
fn sides_and_nodes_are_found_by_their_place() {
    let model = model(&case(json!({
        "top": {"y": -1},
        "right": {"x": 2, "bodies": ["square"]},
        "outer": {"circle": {"center": [0, 0], "radius": 2}},
        "upward": {"angle": [45, 135], "bodies": ["square"]},
        "downward": {"angle": [-91, -89]},
        "lower": {"box": [[0, -3], [2, -2]], "bodies": ["square"]},
        "axis": {"x": 0, "nodes": true},
        "leftward": {"angle": [179, 181], "bodies": ["ring"]},
    })));
    let mesh = &model.mesh;
    // Lengths of the sides, by the chords of their edges: eight chords of the outer arc would be a quarter of a circle.
    let length = |name: &str| {
        edges(mesh, name).iter().map(|edge| (mesh.nodes[edge.nodes[1]] - mesh.nodes[edge.nodes[0]]).norm()).sum::<f64>()
    };
    for (name, expected, count) in
        [("top", 2.0, 2), ("right", 2.0, 2), ("upward", 2.0, 2), ("lower", 4.0, 4), ("leftward", 1.0, 2)]
    {
        close(name, length(name), expected, 1e-12);
        assert_eq!(edges(mesh, name).len(), count, "{name}");
    }
    // The lower side of the square, and that of the ring on y = 0.
    close("downward", length("downward"), 2.0 + 1.0, 1e-12);
    close("outer", length("outer"), 4.0 * 4.0 * (std::f64::consts::PI / 16.0).sin(), 1e-12);
    // A quadratic edge has its middle node; the body is on the left.
    assert!(edges(mesh, "top").iter().all(|edge| edge.nodes.len() == 3));
    assert!(edges(mesh, "top").iter().all(|edge| mesh.nodes[edge.nodes[1]].x < mesh.nodes[edge.nodes[0]].x));
    let Group::Nodes(axis) = mesh.group("axis").expect("a group") else { panic!("it is nodes") };
    let places: BTreeSet<i64> = axis.iter().map(|&node| (mesh.nodes[node].y * 2.0).round() as i64).collect();
    assert_eq!(places, BTreeSet::from([-6, -5, -4, -3, -2, 2, 3, 4]));
}

/// A side without its ends, and the reaction of a wall without that of the floor at the node that both share: a bar between a wall and a
/// floor that it does not leave, ε = 1 % along x at ν = 0, so that every node of the wall bears E ε h, half of it at the ends.
#[test]
fn a_side_is_a_group_without_its_ends() {
    let mut case = case(json!({
        "inner": {"of": "wall", "without": ["floor", "ceiling"], "nodes": true},
        "lower": {"of": "wall", "without": ["ceiling"]},
        "short": {"of": "wall", "box": [[0, -2], [0, -1]], "nodes": true},
    }));
    case["mesh"]["blocks"][1]["elements"] = json!([2, 4]);
    case["mesh"]["blocks"][1]["kind"] = json!("Q4");
    case["mesh"]["blocks"][1]["sides"] = json!(["floor", "pushed", "ceiling", "wall"]);
    case["bodies"]["square"]["material"]["nu"] = json!(0.0);
    case["watch"] = json!(["wall", "inner", "floor"]);
    case["steps"][0]["supports"] = json!([
        {"on": "ring", "ux": 0, "uy": 0}, {"on": "wall", "ux": 0}, {"on": "floor", "uy": 0}, {"on": "pushed", "ux": -0.02}]);
    let run = finish(&case);
    let mesh = &run.model.mesh;
    let heights = |name: &str| {
        let nodes = mesh.nodes_of(mesh.group(name).expect("a group"));
        nodes.iter().map(|&node| (2.0 * mesh.nodes[node].y).round() as i64).collect::<BTreeSet<_>>()
    };
    assert_eq!(heights("inner"), BTreeSet::from([-5, -4, -3]));
    assert_eq!(heights("short"), BTreeSet::from([-4, -3, -2]));
    // An edge with an end that is left out is none.
    assert_eq!(edges(mesh, "lower").len(), 3);
    for (name, share) in [("wall", 1.0), ("inner", 0.75)] {
        close(name, run.reaction(name, run.last())[0], share * 100.0 * 0.01 * 2.0, 1e-9);
    }
}

#[test]
fn contacts_and_supports_take_them() {
    let mut case = case(json!({"top": {"y": -1}, "base": {"y": -3}}));
    case["steps"][0]["supports"] = json!([{"on": "ring", "ux": 0, "uy": 0}, {"on": "base", "ux": 0, "uy": 0}, {"on": "top", "uy": -0.02, "ux": 0}]);
    case["bodies"]["square"]["material"]["nu"] = json!(0.0);
    case["watch"] = json!(["top"]);
    let run = finish(&case);
    // A bar of unit thickness, pressed by 1 % of its height: E A ε.
    close("force", run.reaction("top", run.last())[1], -100.0 * 2.0 * 0.01, 1e-6);
}

#[test]
fn places_where_nothing_is_are_refused() {
    for (group, fragments) in [
        (json!({"y": 5}), &["groups.top", "has no free side", "from (0, -3) to (2, 2)"][..]),
        (json!({"y": -1.5}), &["has no free side"]),
        (json!({"y": 5, "nodes": true}), &["has no node"]),
        (json!({}), &["gives no place"]),
        (json!({"angle": [0, 90], "nodes": true}), &["has an angle, which nodes do not have"]),
        (json!({"box": [[1, 0], [0, 1]]}), &["first corner is not the lower left"]),
        (json!({"circle": {"center": [0, 0], "radius": 0}}), &["radius is not positive"]),
        (json!({"y": -1, "bodies": ["sqare"]}), &["`sqare`", "it has `ring`, `square`"]),
        (json!({"y": -1, "tolerance": -1}), &["negative tolerance"]),
        (json!({"of": "squaer", "nodes": true}), &["`squaer` is not known here; did you mean `square`?"]),
        (json!({"y": -1, "without": ["squar"]}), &["`squar` is not known here"]),
        (json!({"z": -1}), &["`z`"]),
    ] {
        let message = refusal(&case(json!({"top": group})));
        fragments.iter().for_each(|fragment| assert!(message.contains(fragment), "`{fragment}` is not in: {message}"));
    }
    assert!(refusal(&case(json!({"ring": {"y": -1}}))).contains("is a group of the mesh already"));
    assert!(refusal(&case(json!({"a,b": {"y": -1}}))).contains("would break the rows"));
}

/// Round-off of the direction of a side at an end of the range must not leave it out.
#[test]
fn a_side_at_an_end_of_the_range_of_angles_belongs_to_it() {
    let group: PlacedGroup = serde_json::from_value(json!({"angle": [90, 90], "bodies": ["square"]})).expect("a group");
    let mesh = model(&case(json!({}))).mesh.clone();
    let placed = mesh.with_placed(&[("top".to_owned(), group)].into()).expect("a mesh");
    assert_eq!(edges(&placed, "top").len(), 2);
}

fn data(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data").join(name);
    fs::read_to_string(path).expect("a file")
}

/// The same file with and without physical groups: the entities are its groups then.
#[test]
fn files_without_physical_groups_offer_their_entities() {
    let names = |text: &str| {
        let (head, rest) = text.split_once("$PhysicalNames").expect("names");
        format!("{head}{}", rest.split_once("$EndPhysicalNames\n").expect("their end").1)
    };
    let old = names(&data("quad4_22.msh"));
    let old = ["1 15 2 8", "2 1 2 2", "3 1 2 2", "4 1 2 7", "5 1 2 7", "6 3 2 1", "7 3 2 1"].iter().fold(
        old,
        |text, line| {
            assert!(text.contains(line), "{line}");
            text.replacen(line, &format!("{}0", &line[..line.len() - 1]), 1)
        },
    );
    let new = names(&data("quad4.msh"));
    let tags = [
        ("1 0 0 0 1 8 \n", "1 0 0 0 0 \n"),
        ("2 0 0 1 -2 2 1 -2", "2 0 0 0 2 1 -2"),
        ("0 1 7 2 3", "0 0 2 3"),
        ("2 1 0 1 1 4 1", "2 1 0 0 4 1"),
    ];
    let new = tags.iter().fold(new, |text, (with, without)| {
        assert!(text.contains(with), "{with}");
        text.replacen(with, without, 1)
    });
    let grouped = gmsh::from_bytes(data("quad4.msh").into()).expect("a mesh");
    for text in [old, new] {
        let mesh = gmsh::from_bytes(text.clone().into()).unwrap_or_else(|error| panic!("{error}: {text}"));
        assert_eq!(mesh.groups.keys().collect::<Vec<_>>(), ["curve_1", "curve_3", "point_1", "surface_1"]);
        assert_eq!(mesh.elements, grouped.elements);
        for (entity, group) in
            [("curve_1", "bottom"), ("curve_3", "physical_7"), ("point_1", "corner"), ("surface_1", "body")]
        {
            assert_eq!(mesh.group(entity).expect("a group"), grouped.group(group).expect("a group"), "{entity}");
        }
    }
}

/// Of two surfaces that share nodes the curve between them can be no group; the centre of an arc is a node of no element.
#[test]
fn entities_that_cannot_be_groups_are_left_out() {
    let text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n7\n1 0 0 0\n2 1 0 0\n3 2 0 0\n4 0 1 0\n5 1 1 0\n6 2 1 0\n7 9 9 0\n$EndNodes\n\
                $Elements\n6\n1 3 2 0 1 1 2 5 4\n2 3 2 0 2 2 3 6 5\n3 1 2 0 10 2 5\n4 1 2 0 11 1 2\n5 15 2 0 20 7\n6 15 2 0 21 1\n$EndElements\n";
    let mesh = gmsh::from_bytes(text.into()).expect("a mesh");
    assert_eq!(mesh.groups.keys().collect::<Vec<_>>(), ["curve_11", "point_21", "surface_1", "surface_2"]);
}
