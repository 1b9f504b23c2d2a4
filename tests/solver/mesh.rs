//! Meshes: what is read, how it is turned, and what is refused with which words.

use std::fs;
use std::path::{Path, PathBuf};

use fecontact::mesh::{Edge, Element, ElementKind, Group, InlineMesh, Mesh, gmsh};
use nalgebra::{Matrix2, RowVector2, Vector2};
use serde_json::{Value, json};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data").join(name)
}

fn read(name: &str) -> Mesh {
    gmsh::read(&data(name)).unwrap()
}

/// The words of the error that `bytes` give, or of success.
fn verdict(bytes: &[u8]) -> String {
    gmsh::from_bytes(bytes.into()).map_or_else(|error| error.to_string(), |_| "no error".into())
}

fn build(mesh: Value) -> Result<Mesh, String> {
    let mesh: InlineMesh = serde_json::from_value(mesh).map_err(|error| error.to_string())?;
    mesh.build().map_err(|error| error.to_string())
}

fn edges<'a>(mesh: &'a Mesh, name: &str) -> &'a [Edge] {
    match mesh.group(name).unwrap() {
        Group::Edges(edges) => edges,
        other => panic!("{name} is {other:?}"),
    }
}

/// The squares [0, 1]² and [1, 2] × [0, 1] as gmsh writes them: two elements, named groups.
fn two_squares() -> String {
    fs::read_to_string(data("quad4.msh")).unwrap()
}

#[track_caller]
fn assert_says(message: &str, fragments: &[&str]) {
    for fragment in fragments {
        assert!(message.contains(fragment), "`{fragment}` is not in: {message}");
    }
}

#[test]
fn every_kind_of_element_is_read() {
    for (file, kind, elements, nodes) in [
        ("tri3.msh", ElementKind::T3, 4, 6),
        ("tri6.msh", ElementKind::T6, 4, 15),
        ("quad4.msh", ElementKind::Q4, 2, 6),
        ("quad8.msh", ElementKind::Q8, 2, 13),
        ("quad9.msh", ElementKind::Q9, 2, 15),
    ] {
        let mesh = read(file);
        assert_eq!((mesh.elements.len(), mesh.nodes.len()), (elements, nodes), "{file}");
        assert!(mesh.elements.iter().all(|element| element.kind == kind));
        assert_eq!(mesh.groups.keys().collect::<Vec<_>>(), ["body", "bottom", "corner", "physical_7"]);
        assert_eq!(mesh.group("corner").unwrap(), &Group::Nodes(vec![0]));
        assert!((mesh.size_of(0..mesh.nodes.len()) - 5.0f64.sqrt()).abs() < 1e-12);
        assert!((area(&mesh) - 2.0).abs() < 1e-12, "{file}");
        assert_edges_have_the_body_on_their_left(&mesh);
    }
}

fn area(mesh: &Mesh) -> f64 {
    mesh.elements.iter().map(|element| element_area(mesh, element)).sum()
}

fn element_area(mesh: &Mesh, element: &Element) -> f64 {
    let jacobian = |at| {
        let gradients = element.kind.derivatives(at);
        let terms = gradients.iter().zip(&element.nodes).map(|(&d, &node)| mesh.nodes[node] * RowVector2::from(d));
        terms.sum::<Matrix2<f64>>().determinant()
    };
    element.kind.quadrature().iter().map(|point| point.weight * jacobian(point.at)).sum()
}

fn assert_edges_have_the_body_on_their_left(mesh: &Mesh) {
    for edge in edges(mesh, "bottom").iter().chain(edges(mesh, "physical_7")) {
        let element = &mesh.elements[edge.element];
        let [a, b] = [mesh.nodes[edge.nodes[0]], mesh.nodes[edge.nodes[1]]];
        assert!(element.nodes.iter().all(|&node| (b - a).perp(&(mesh.nodes[node] - a)) > -1e-9));
        assert!(edge.nodes.iter().all(|node| element.nodes.contains(node)));
        assert_eq!(edge.nodes.len() == 3, element.nodes.len() > element.kind.corners());
        assert!(edge.nodes.iter().skip(2).all(|&middle| (mesh.nodes[middle] - 0.5 * (a + b)).norm() < 1e-9));
    }
}

#[test]
fn binary_and_ascii_files_give_the_same_mesh() {
    for (ascii, binary) in [("quad4.msh", "quad4_binary.msh"), ("quad9.msh", "quad9_binary.msh")] {
        assert_same(&read(ascii), &read(binary));
    }
}

fn assert_same(a: &Mesh, b: &Mesh) {
    assert_eq!((&a.elements, &a.groups), (&b.elements, &b.groups));
    assert_eq!(a.nodes.len(), b.nodes.len());
    assert!(a.nodes.iter().zip(&b.nodes).all(|(a, b)| (a - b).norm() < 1e-9));
}

#[test]
fn an_inline_mesh_is_the_same_as_one_from_a_file() {
    let inline = build(json!({
        "nodes": [[0, 0], [2, 0], [2, 1], [0, 1], [1, 0], [1, 1]],
        "elements": {"body": [[0, 4, 5, 3], [4, 1, 2, 5]]},
        "edges": {"bottom": [[0, 4], [1, 4]], "physical_7": [[2, 5], [5, 3]]},
        "points": {"corner": [0]}
    }));
    assert_same(&read("quad4.msh"), &inline.unwrap());
}

#[test]
fn clockwise_elements_are_turned_with_their_mid_side_nodes() {
    let upright = [[0., 0.], [2., 0.], [2., 2.], [0., 2.], [1., 0.], [2., 1.], [1., 2.], [0., 1.], [1., 1.]];
    for (clockwise, turned) in [
        (vec![0, 3, 2], vec![0, 2, 3]),
        (vec![0, 2, 1, 8, 5, 4], vec![0, 1, 2, 4, 5, 8]),
        (vec![0, 3, 2, 1], vec![0, 1, 2, 3]),
        (vec![0, 3, 2, 1, 7, 6, 5, 4], vec![0, 1, 2, 3, 4, 5, 6, 7]),
        (vec![0, 3, 2, 1, 7, 6, 5, 4, 8], vec![0, 1, 2, 3, 4, 5, 6, 7, 8]),
    ] {
        let all: Vec<usize> = (0..9).collect();
        let mesh = build(json!({"nodes": upright, "elements": {"a": [clockwise]}, "points": {"all": all}})).unwrap();
        assert_eq!(mesh.elements[0].nodes, turned);
        assert!(element_area(&mesh, &mesh.elements[0]) > 1.0);
    }
}

#[test]
fn unused_nodes_are_dropped_unless_a_point_group_names_them() {
    let mesh = build(json!({
        "nodes": [[9, 9], [0, 0], [7, 7], [1, 0], [0, 1]],
        "elements": {"a": [[1, 3, 4]]}, "edges": {"low": [[3, 1]]}, "points": {"mass": [2]}
    }))
    .unwrap();
    assert_eq!(mesh.node_tags, [1, 2, 3, 4]);
    assert_eq!(mesh.elements[0].nodes, [0, 2, 3]);
    assert_eq!(edges(&mesh, "low"), [Edge { nodes: vec![0, 2], element: 0 }]);
    assert_eq!(mesh.group("mass").unwrap(), &Group::Nodes(vec![1]));
    assert_eq!(mesh.bounding_box(), [Vector2::new(0.0, 0.0), Vector2::new(7.0, 7.0)]);
}

#[test]
fn a_mesh_may_be_nothing_but_points() {
    let mesh = build(json!({"nodes": [[1, 2], [3, 4]], "points": {"mass": [1, 1]}})).unwrap();
    assert_eq!((mesh.nodes.len(), mesh.elements.len()), (1, 0));
    assert_eq!(mesh.size_of([]), 0.0);

    let point = two_squares()
        .replace(&section_of(&two_squares(), "Elements"), "$Elements\n1 1 1 1\n0 1 15 1\n1 1\n$EndElements\n")
        .replace("1 2 \"bottom\"\n", "")
        .replace("2 1 \"body\"\n", "");
    assert_eq!(verdict(point.as_bytes()), "no error");
}

fn section_of(text: &str, name: &str) -> String {
    let (begin, end) = (format!("${name}\n"), format!("$End{name}\n"));
    text[text.find(&begin).unwrap()..text.find(&end).unwrap() + end.len()].to_string()
}

/// Node tags without gaps need not be in order: 1 and 5 change places here, so each must be looked up.
#[test]
fn node_tags_may_come_in_any_order() {
    let swapped = two_squares().replace("0 1 0 1\n1\n", "0 1 0 1\n5\n").replace("1 1 0 1\n5\n", "1 1 0 1\n1\n");
    let swapped = swapped.replace(
        &section_of(&two_squares(), "Elements"),
        "$Elements\n3 4 1 4\n0 1 15 1\n1 5\n1 1 1 1\n2 5 1\n2 1 3 2\n3 5 1 6 4\n4 1 2 3 6\n$EndElements\n",
    );
    let mesh = gmsh::from_bytes(swapped.into()).unwrap();
    assert_eq!(mesh.node_tags, [5, 2, 3, 4, 1, 6]);
    assert_eq!(mesh.nodes_of(mesh.group("bottom").unwrap()), [0, 4]);
    assert!((area(&mesh) - 2.0).abs() < 1e-9);
}

#[test]
fn groups_are_found_by_name_and_the_nearest_is_suggested() {
    let mesh = read("quad4.msh");
    assert_eq!(mesh.nodes_of(mesh.group("bottom").unwrap()), [0, 1, 4]);
    assert_eq!(mesh.nodes_of(mesh.group("body").unwrap()), [0, 1, 2, 3, 4, 5]);
    assert_eq!(mesh.body_of(1), Some("body"));
    assert_eq!(mesh.body_of(2), None);
    let lost = mesh.group("botom").unwrap_err();
    assert_eq!(
        lost.to_string(),
        "the mesh has no group `botom` (did you mean `bottom`?); it has `body`, `bottom`, `corner`, `physical_7`"
    );
    assert_eq!(mesh.group("xyz").unwrap_err().nearest, None);
}

#[test]
fn bad_inline_meshes_are_refused() {
    let square = json!([[0, 0], [1, 0], [1, 1], [0, 1], [2, 0], [2, 1], [0.5, 0]]);
    for (rest, fragments) in [
        (json!({"element": {}}), &["unknown field `element`"][..]),
        (json!({}), &["no triangles or quadrilaterals"]),
        (json!({"elements": {"a": []}}), &["the group `a` is empty"]),
        (json!({"elements": {"a": [[0, 1, 2, 3, 4]]}}), &["element 0 of `a` has 5 nodes", "3 or 6"]),
        (json!({"elements": {"a": [[0, 1, 2], [0, 1, 17]]}}), &["element 1 of `a` uses node 17"]),
        (json!({"elements": {"a": [[0, 1, 2, 2]]}}), &["element 0 of `a` is collapsed", "node 2 twice"]),
        (json!({"elements": {"a": [[0, 1, 4]]}}), &["element 0 of `a` has zero or negative area"]),
        (json!({"elements": {"a": [[0, 2, 1, 3]]}}), &["element 0 of `a` has zero or negative area", "folded"]),
        (
            json!({"elements": {"a": [[0, 1, 2]], "b": [[2, 1, 0]]}}),
            &["element 0 of `a` and element 0 of `b` have the same corners"],
        ),
        (json!({"elements": {"a": [[0, 1, 2]]}, "edges": {"a": [[0, 1]]}}), &["two groups", "named `a`"]),
        (json!({"elements": {"a": [[0, 1, 2]]}, "edges": {"e": [[0]]}}), &["line 0 of `e` has 1 nodes"]),
        (
            json!({"elements": {"a": [[0, 1, 2]]}, "edges": {"e": [[0, 1], [0, 4]]}}),
            &["line 1 of `e` is not an edge of any element, and others of the group are"],
        ),
        (
            json!({"elements": {"a": [[0, 1, 2]]}, "edges": {"e": [[0, 1], [1, 0]]}}),
            &["line 1 of `e` is in the group twice"],
        ),
        (json!({"elements": {"a": [[0, 1, 2]]}, "edges": {"e": [[0, 1, 6]]}}), &["line 0 of `e`", "same order"]),
        (
            json!({"elements": {"a": [[0, 1, 2], [0, 2, 3]]}, "edges": {"e": [[0, 2]]}}),
            &["line 0 of `e` lies inside `a`"],
        ),
        (json!({"elements": {"a": [[0, 1, 2]]}, "points": {"p": [99]}}), &["point 0 of `p` uses node 99"]),
    ] {
        let mut mesh = rest.clone();
        mesh["nodes"] = square.clone();
        assert_says(&build(mesh).unwrap_err(), fragments);
    }
    let far = json!({"nodes": [[0, 0], [1e300, 0], [0, 1e300]], "elements": {"a": [[0, 1, 2]]}});
    assert_says(&build(far).unwrap_err(), &["node 1 has the coordinate 1e300: it must lie between -1e100 and 1e100"]);
}

#[test]
fn files_that_cannot_be_read_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("nothing.msh");
    assert_says(&gmsh::read(&missing).unwrap_err().to_string(), &["nothing.msh: there is no such mesh file"]);
    assert_says(&gmsh::read(folder.path()).unwrap_err().to_string(), &["not a file but a folder"]);
    let text = folder.path().join("notes.msh");
    fs::write(&text, "to do: mesh").unwrap();
    assert_says(&gmsh::read(&text).unwrap_err().to_string(), &["notes.msh: this is not a gmsh mesh"]);
}

/// Each case replaces one piece of a good file; the piece must be there.
#[test]
fn bad_gmsh_files_are_refused() {
    let nodes_header = "$Nodes\n7 6 1 6\n";
    let elements_header = "$Elements\n4 7 1 7\n";
    for (piece, replacement, fragments) in [
        ("$MeshFormat\n", "solid cube\n", &["this is not a gmsh mesh", "gmsh -2 -format msh41"][..]),
        (
            "4.1 0 8",
            "2.1 0 8",
            &["MSH format 2.1", "only 4.1 and 2.2", "gmsh -2 -format msh41", "Mesh.MshFileVersion = 4.1"],
        ),
        ("4.1 0 8", "2.2 1 8", &["format line", "`2.2 1 8`", "`2.2 0 8` was expected"]),
        ("4.1 0 8", "4.1 0 4", &["format line", "`4.1 0 4`"]),
        ("4.1 0 8", "4.1 1 8", &["format line"]),
        ("4.1 0 8", "", &["format line"]),
        ("$EndMeshFormat\n", "", &["cannot be understood"]),
        ("$Entities\n", "$Things\n", &["no $Entities section"]),
        ("$Nodes\n", "$Knots\n", &["no $Nodes section"]),
        ("$Elements\n", "$Bricks\n", &["no $Elements section"]),
        ("$EndNodes\n", "", &["$Nodes section has no $EndNodes", "cut short"]),
        ("$EndElements\n", "", &["$Elements section has no $EndElements", "cut short"]),
        (nodes_header, "$Nodes\n7 9000000000000000000 1 6\n", &["$Nodes section claims 9000000000000000000 entries"]),
        (nodes_header, "$Nodes\n9000000000000000000 6 1 6\n", &["$Nodes section claims 9000000000000000000 entries"]),
        (nodes_header, "$Nodes\n7 8 1 6\n", &["$Nodes section claims 8 entries but holds 6"]),
        (nodes_header, "$Nodes\n7 6 0 6\n", &["cannot be understood at line", "tag 0 is reserved"]),
        (nodes_header, "$Nodes\n7 6 1 1\n", &["two nodes have the tag 1"]),
        (nodes_header, "$Nodes\n7 0 1 6\n", &["no triangles or quadrilaterals"]),
        (nodes_header, "$Nodes\nseven\n", &["at $Nodes", "does not begin with its counts"]),
        (elements_header, "$Elements\n4 70 1 7\n", &["$Elements section claims 70 entries but holds 7"]),
        (elements_header, "$Elements\n4 9000000000 1 7\n", &["$Elements section claims 9000000000 entries"]),
        ("$Entities\n4", "$Entities\n40000000000", &["$Entities section claims 40000000000 entries"]),
        ("0 2 0 1\n2\n", "0 2 0 1\n1\n", &["two nodes have the tag 1"]),
        (
            "0 1 0 1\n1\n0 0 0\n0 2 0 1\n2\n2 0 0\n",
            "0 1 0 2\n1\n1\n0 0 0\n2 0 0\n0 2 0 0\n",
            &["node tags are repeated, or outside the range"],
        ),
        ("0 2 0 1\n2\n", "0 2 1 1\n2\n", &["parametric", "Mesh.SaveParametric = 0"]),
        ("2 1 0\n", "2 1 0.5\n", &["node 3 has z = 0.5 where node 1 has z = 0", "plane"]),
        ("2 1 0\n", "2 1 zero\n", &["cannot be understood at line"]),
        ("2 1 0\n", "2 1e999 0\n", &["node 3 has the coordinate inf"]),
        ("2 1 3 2\n", "2 1 36 2\n", &["cannot be understood at line", "element definition"]),
        ("2 1 3 2\n", "2 1 999 2\n", &["cannot be understood at line", "unknown element type"]),
        ("2 1 3 2\n", "2 1 4 2\n", &["element 6 is a Tet4 (gmsh type 4)", "Mesh.ElementOrder"]),
        ("2 1 3 2\n", "1 1 3 2\n", &["element 6", "its dimension is 2, that of its entity 1"]),
        ("2 1 3 2\n", "2 5 3 2\n", &["2 elements (the first is 6) belong to no physical surface", "Mesh.SaveAll"]),
        ("1 0 0 0 2 1 0 1 1 4", "1 0 0 0 2 1 0 2 1 9 4", &["element 6", "surfaces `body` and `physical_9`"]),
        ("6 1 5 6 4", "6 1 5 6 40", &["element 6 of `body` uses node 40"]),
        ("6 1 5 6 4", "6 1 5 5 4", &["element 6 of `body` is collapsed"]),
        ("6 1 5 6 4", "6 5 2 3 6", &["element 6 of `body` and element 7 of `body` have the same corners"]),
        ("2 1 5", "2 1 3", &["line 2 of `bottom` is not an edge"]),
        ("2 1 5", "2 6 5", &["line 2 of `bottom` lies inside `body`"]),
        ("1 2 \"bottom\"", "1 2 \"body\"", &["two groups", "`body`"]),
        ("1 2 \"bottom\"", "1 9 \"bottom\"", &["the group `bottom` is empty"]),
        ("1 2 \"bottom\"", "1 2 bottom", &["$PhysicalNames", "`1 2 bottom`"]),
    ] {
        let good = two_squares();
        assert!(good.contains(piece), "{piece}");
        assert_says(&verdict(good.replacen(piece, replacement, 1).as_bytes()), fragments);
    }
}

/// The files `*_22.msh` are the others as gmsh 4.15 writes them in its older format.
#[test]
fn files_of_both_formats_give_the_same_mesh() {
    for (new, old) in [("quad4.msh", "quad4_22.msh"), ("tri6.msh", "tri6_22.msh"), ("quad9.msh", "quad9_22.msh")] {
        let [new, old] = [new, old].map(read);
        assert_eq!((&new.elements, &new.groups, &new.nodes), (&old.elements, &old.groups, &old.nodes));
        assert_eq!((new.node_tags, new.element_tags), (old.node_tags, old.element_tags));
    }
}

/// A physical curve without a surface is the outline of a rigid body; its nodes are none of the mesh.
#[test]
fn a_curve_by_itself_is_an_outline() {
    let mut text = fs::read_to_string(data("quad4_22.msh")).unwrap();
    for (piece, replacement) in [
        ("$PhysicalNames\n3\n", "$PhysicalNames\n4\n1 3 \"die\"\n"),
        ("$Nodes\n6\n", "$Nodes\n9\n7 -1 -1 0\n8 0.5 -0.5 0\n9 3 -1 0\n"),
        ("$Elements\n7\n", "$Elements\n9\n"),
        ("$EndElements", "8 1 2 3 9 8 9\n9 1 2 3 9 7 8\n$EndElements"),
    ] {
        assert_eq!(text.matches(piece).count(), 1, "{piece}");
        text = text.replace(piece, replacement);
    }
    let [mesh, plain] = [gmsh::from_bytes(text.into_bytes()).unwrap(), read("quad4_22.msh")];
    assert_eq!((&mesh.nodes, &mesh.elements), (&plain.nodes, &plain.elements));
    let [left, top, right] =
        [(7, [-1.0, -1.0]), (8, [0.5, -0.5]), (9, [3.0, -1.0])].map(|(tag, at)| (tag, Vector2::from(at)));
    assert_eq!(mesh.group("die").unwrap(), &Group::Lines(vec![vec![top, right], vec![left, top]]));
    assert_eq!(mesh.nodes_of(mesh.group("die").unwrap()), Vec::<usize>::new());
}

/// Each case replaces one piece of a good file of format 2.2.
#[test]
fn bad_files_of_the_older_format_are_refused() {
    let good = fs::read_to_string(data("quad4_22.msh")).unwrap();
    for (piece, replacement, fragments) in [
        ("$Nodes\n6\n", "$Knots\n6\n", &["no $Nodes section"][..]),
        ("$Elements\n7\n", "$Bricks\n7\n", &["no $Elements section"]),
        ("$EndElements\n", "", &["$Elements section has no $EndElements", "cut short"]),
        ("$Nodes\n6\n", "$Nodes\n7\n", &["$Nodes section claims 7 entries but holds 6"]),
        ("$Nodes\n6\n", "$Nodes\n9000000000000000000\n", &["claims 9000000000000000000 entries but holds 6"]),
        ("$Elements\n7\n", "$Elements\nseven\n", &["at $Elements", "does not begin with the number"]),
        ("$Nodes\n", "$ParametricNodes\n$EndParametricNodes\n$Nodes\n", &["parametric", "Mesh.SaveParametric = 0"]),
        ("3 2 1 0\n", "3 2 1 0.5\n", &["node 3 has z = 0.5 where node 1 has z = 0", "plane"]),
        ("3 2 1 0\n", "3 2 1 zero\n", &["cannot be understood at line 14: a node is: tag x y z"]),
        ("3 2 1 0\n", "3 2 1\n", &["cannot be understood at line 14"]),
        ("3 2 1 0\n", "3 2 1e999 0\n", &["node 3 has the coordinate inf"]),
        ("3 2 1 0\n", "2 2 1 0\n", &["two nodes have the tag 2"]),
        ("6 3 2 1 1 1 5 6 4", "6 4 2 1 1 1 5 6 4", &["element 6 is a kind that is not read (gmsh type 4)"]),
        ("6 3 2 1 1 1 5 6 4", "6 3 2 1 1 1 5 6", &["line 26: an element has another number of nodes than its type"]),
        ("6 3 2 1 1 1 5 6 4", "6 3 20 1 1 1 5 6 4", &["line 26: an element is: tag type"]),
        ("6 3 2 1 1 1 5 6 4", "6 3 2 0 1 1 5 6 4", &["1 elements (the first is 6) belong to no physical surface"]),
        ("6 3 2 1 1 1 5 6 4", "6 3 0 1 5 6 4", &["1 elements (the first is 6) belong to no physical surface"]),
        ("6 3 2 1 1 1 5 6 4", "6 3 2 1 1 1 5 6 40", &["element 6 of `body` uses node 40"]),
        (
            "6 3 2 1 1 1 5 6 4",
            "6 3 2 9 1 5 2 3 6",
            &["element 7 of `body` and element 6 of `physical_9` have the same corners"],
        ),
        ("1 2 \"bottom\"", "1 2 \"body\"", &["two groups", "`body`"]),
        ("1 2 \"bottom\"", "1 9 \"bottom\"", &["the group `bottom` is empty"]),
        ("1 2 \"bottom\"", "1 2 bottom", &["$PhysicalNames", "`1 2 bottom`"]),
    ] {
        assert!(good.contains(piece), "{piece}");
        assert_says(&verdict(good.replacen(piece, replacement, 1).as_bytes()), fragments);
    }
    // A negative tag, and none of a line; line ends of Windows.
    let reversed = good.replacen("2 1 2 2 1 5 1", "2 1 2 -2 1 5 1", 1).replace('\n', "\r\n");
    assert_same(&gmsh::from_bytes(reversed.into()).unwrap(), &read("quad4.msh"));
    let lost = gmsh::from_bytes(good.replacen("4 1 2 7 3 3 6", "4 1 2 0 3 3 6", 1).into()).unwrap();
    assert_eq!(edges(&lost, "physical_7").len(), 1);
}

/// Joined in the order of their names, two meshes are the same as written as one.
#[test]
fn joined_meshes_lie_side_by_side() {
    let block = InlineMesh::default().rectangle("block", [3, 2], [0.5, 0.0], [1.5, 1.0]);
    let ground = InlineMesh::default().rectangle("ground", [4, 2], [0.0, -1.0], [2.0, 0.0]);
    let whole = block.clone().rectangle("ground", [4, 2], [0.0, -1.0], [2.0, 0.0]).build().unwrap();
    let joined = Mesh::join([block.build().unwrap(), ground.build().unwrap()]).unwrap();
    assert_eq!((&whole.nodes, &whole.elements, &whole.groups), (&joined.nodes, &joined.elements, &joined.groups));
    assert_eq!(joined.node_tags[12..14], [0, 1]);
    let twice = Mesh::join([joined, ground.build().unwrap()]).map(|_| ()).unwrap_err().to_string();
    assert_says(&twice, &["the group `ground` is in mesh 1 and in mesh 2", "its own name"]);
}

/// What is checked in the first section would be read from the second: without nodes, where the parser's count underflows.
#[test]
fn a_section_stands_once() {
    for name in ["Entities", "Nodes", "Elements"] {
        let good = two_squares();
        let hollow = format!("$Other\n${name}\n1 0 1 1\n$End{name}\n$EndOther\n");
        let twice = good.replacen(&format!("${name}\n"), &format!("{hollow}${name}\n"), 1);
        assert_says(&verdict(twice.as_bytes()), &[&format!("${name}"), "more than once"]);
    }
}

#[test]
fn bodies_that_share_nodes_cannot_be_in_contact() {
    let mut text = two_squares();
    for (piece, replacement) in [
        ("4 4 1 0\n", "4 4 2 0\n"),
        ("1 0 0 0 2 1 0 1 1 4", "9 0 0 0 2 1 0 1 9 0\n1 0 0 0 2 1 0 1 1 4"),
        ("$Elements\n4 7 1 7", "$Elements\n5 7 1 7"),
        ("2 1 3 2\n6 1 5 6 4 \n", "2 9 3 1\n6 1 5 6 4\n2 1 3 1\n"),
        ("2 1 5", "2 6 5"),
    ] {
        assert!(text.contains(piece), "{piece}");
        text = text.replacen(piece, replacement, 1);
    }
    // It may be the side of one of them if a step removes the other, which the mesh does not know.
    let mesh = gmsh::from_bytes(text.as_bytes().into()).unwrap();
    let body = || crate::common::neo_hookean(1.0, 0.3, 0.0);
    let step = fecontact::model::builder::LoadStep::new("rest", 1.0);
    let model = fecontact::model::Model::builder(mesh).body("body", body()).body("physical_9", body()).step(step);
    let said = model.build().unwrap_err().to_string();
    let fragments = ["line 2 of `bottom` lies between `body` and `physical_9`", "contact needs separate nodes"];
    assert_says(&said, &fragments);
}

#[test]
fn counts_in_a_binary_file_are_checked() {
    let mut bytes = fs::read(data("quad4_binary.msh")).unwrap();
    let nodes = bytes.windows(7).position(|word| word == b"$Nodes\n").unwrap() + 7;
    bytes[nodes + 8..nodes + 16].copy_from_slice(&(9e18 as u64).to_le_bytes());
    assert_says(&verdict(&bytes), &["$Nodes section claims 9000000000000000000 entries, more than a file of"]);
}

#[test]
fn garbage_is_refused() {
    let mut seed = 1u64;
    let noise: Vec<u8> = std::iter::repeat_with(|| {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 56) as u8
    })
    .take(100_000_000)
    .collect();
    assert_says(&verdict(&noise), &["this is not a gmsh mesh"]);
    let disguised = [b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n", &noise[..]].concat();
    assert_says(&verdict(&disguised), &["no $Entities section"]);
}

/// Every truncation, and every byte replaced by others, gives a mesh or an error, never a panic.
#[test]
fn damaged_files_never_panic() {
    for name in ["quad4.msh", "quad4_22.msh", "quad4_binary.msh", "quad9_binary.msh"] {
        let good = fs::read(data(name)).unwrap();
        for at in 0..good.len() {
            assert!(gmsh::from_bytes(good[..at].into()).is_err() || at + 1 == good.len(), "{name} cut at {at}");
            for byte in *b"\0\x01\x02\x08\x10\x7f\x80\xff\n $-09" {
                let mut bad = good.clone();
                bad[at] = byte;
                let _ = gmsh::from_bytes(bad);
            }
        }
    }
}

#[test]
fn the_meshes_of_the_examples_are_sound() {
    for (file, dofs, groups) in [
        ("coulomb_drag_5k.msh", 4_964, 6),
        ("coulomb_drag_20k.msh", 20_192, 6),
        ("block_on_ground.msh", 20_228, 10),
        ("cook.msh", 578, 3),
    ] {
        let mesh = gmsh::read(&crate::common::repository("meshes").join(file)).unwrap();
        assert_eq!((2 * mesh.nodes.len(), mesh.groups.len()), (dofs, groups), "{file}");
        assert!(mesh.elements.iter().all(|element| element.kind == ElementKind::Q4));
        if let (Ok(top), Ok(bottom)) = (mesh.group("ground_top"), mesh.group("block_bottom")) {
            let interface = [mesh.nodes_of(top), mesh.nodes_of(bottom)].concat();
            assert!(interface.iter().all(|&node| mesh.nodes[node].y == 0.0), "{file}");
        }
    }
}
