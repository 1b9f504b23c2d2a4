//! Meshes of blocks: where nodes lie, what is joined, and what is refused with which words.

use std::f64::consts::{FRAC_PI_2, PI};

use fecontact::mesh::{Block, BlockKind, Blocks, Grading, Group, InlineMesh, Mesh};
use serde_json::{Value, json};

use crate::common::{close, finish, model, refusal};

fn mesh(blocks: &[Block], separated: &[&str]) -> Result<Mesh, String> {
    let separated = separated.iter().map(|name| name.to_string()).collect();
    let mesh = Blocks { separated, ..Blocks::new(blocks) }.mesh().map_err(|error| error.to_string())?;
    mesh.build().map_err(|error| error.to_string())
}

/// Places of the nodes of a group, in the order of its edges.
fn along(mesh: &Mesh, group: &str) -> Vec<[f64; 2]> {
    let Group::Edges(edges) = mesh.group(group).unwrap() else { panic!("{group} has no edges") };
    let mut nodes: Vec<usize> = edges.iter().map(|edge| edge.nodes[0]).collect();
    nodes.push(edges.last().unwrap().nodes[1]);
    nodes.into_iter().map(|node| mesh.nodes[node].into()).collect()
}

fn area(mesh: &Mesh) -> f64 {
    let elements = mesh.elements.iter().map(|element| {
        let jacobian = |at| {
            let gradients = element.kind.derivatives(at);
            let tangent = |axis: usize| {
                gradients
                    .iter()
                    .zip(&element.nodes)
                    .map(|(d, &node)| mesh.nodes[node] * d[axis])
                    .sum::<nalgebra::Vector2<f64>>()
            };
            tangent(0).perp(&tangent(1))
        };
        element.kind.quadrature().iter().map(|point| point.weight * jacobian(point.at)).sum::<f64>()
    });
    elements.sum()
}

/// A quarter of a ring about the origin, from an angle on; rows go outwards.
fn quarter(from: f64, [inner, outer]: [f64; 2], elements: [usize; 2], kind: BlockKind) -> Block {
    let at = |radius: f64, angle: f64| [radius * angle.cos(), radius * angle.sin()];
    let (a, b) = (from, from + FRAC_PI_2);
    Block {
        arcs: [Some([0.0; 2]), None, Some([0.0; 2]), None],
        kind,
        ..Block::new("ring", [at(inner, b), at(inner, a), at(outer, a), at(outer, b)], elements)
    }
}

#[test]
fn even_rectangles_are_those_of_code() {
    let [low, high] = [[-2.0, -1.0], [0.3, 0.7]];
    let ours = mesh(&[Block::rectangle("b", [7, 3], low, high)], &[]).unwrap();
    let theirs = InlineMesh::default().rectangle("b", [7, 3], low, high).build().unwrap();
    assert_eq!(
        (&ours.elements, ours.groups.keys().collect::<Vec<_>>()),
        (&theirs.elements, theirs.groups.keys().collect())
    );
    for (a, b) in ours.nodes.iter().zip(&theirs.nodes) {
        assert!((a - b).norm() < 1e-15);
    }
    // Columns are upright and rows level, to the last bit; whole numbers come out whole.
    let ours = mesh(&[Block::rectangle("b", [480, 3], [-24e3, -1.0], [24e3, 0.0])], &[]).unwrap();
    for (k, node) in ours.nodes.iter().enumerate() {
        assert_eq!(node.x, -24e3 + 100.0 * (k % 481) as f64);
        assert_eq!(node.y, ours.nodes[k - k % 481].y);
    }
}

/// Sizes h q^k with h = L (q − 1)/(qⁿ − 1).
#[test]
fn sizes_are_a_geometric_series() {
    let (length, ratio, count) = (3.0, 7.0, 9);
    let block = Block::rectangle("b", [count, 2], [1.0, 0.0], [1.0 + length, 1.0]);
    let bottom = along(
        &mesh(&[Block { grading: [Grading::Ratio(ratio), Grading::Ratio(1.0)], ..block.clone() }], &[]).unwrap(),
        "b_bottom",
    );
    let q = ratio.powf(1.0 / (count - 1) as f64);
    let first = length * (q - 1.0) / (q.powi(count as i32) - 1.0);
    for (k, pair) in bottom.windows(2).enumerate() {
        close("size", pair[1][0] - pair[0][0], first * q.powi(k as i32), 1e-14);
    }
    for count in [6, 7] {
        let block =
            Block { elements: [count, 2], grading: [Grading::Middle(4.0), Grading::Ratio(1.0)], ..block.clone() };
        let bottom = along(&mesh(&[block], &[]).unwrap(), "b_bottom");
        let sizes: Vec<f64> = bottom.windows(2).map(|pair| pair[1][0] - pair[0][0]).collect();
        close("the middle", sizes[count / 2] / sizes[0], 4.0, 1e-13);
        (0..count).for_each(|k| close("both ends", sizes[k], sizes[count - 1 - k], 1e-14));
        let q = sizes[1] / sizes[0];
        (1..(count - 1) / 2).for_each(|k| close("the series", sizes[k + 1] / sizes[k], q, 1e-13));
    }
}

#[test]
fn nodes_of_quadratic_elements_lie_in_the_middle() {
    let block = Block {
        grading: [Grading::Ratio(5.0), Grading::Middle(0.5)],
        kind: BlockKind::Q8,
        ..Block::new("b", [[0.0, 0.0], [3.0, 0.5], [2.5, 2.0], [-0.5, 1.0]], [4, 3])
    };
    let mesh = mesh(&[block], &[]).unwrap();
    assert_eq!((mesh.nodes.len(), mesh.elements.len()), (9 * 4 + 5 * 3, 12));
    for element in &mesh.elements {
        let at = |k: usize| mesh.nodes[element.nodes[k]];
        (0..4).for_each(|k| assert!((at(4 + k) - 0.5 * (at(k) + at((k + 1) % 4))).norm() < 1e-15));
    }
}

/// Two triangles fill each cell, with nodes in the middle of straight edges, whichever way round the corners run; diagonals alternate.
#[test]
fn triangles_fill_blocks() {
    let corners = [[0.0, 0.0], [3.0, 0.5], [2.5, 2.0], [-0.5, 1.0]];
    for corners in [corners, [corners[0], corners[3], corners[2], corners[1]]] {
        let block = Block { kind: BlockKind::T6, ..Block::new("b", corners, [4, 4]) };
        let mesh = mesh(&[block], &[]).unwrap();
        assert_eq!((mesh.nodes.len(), mesh.elements.len()), (9 * 9, 32));
        close("area", area(&mesh), 4.125, 1e-13);
        let inner = |node: usize| mesh.elements.iter().filter(|element| element.nodes[..3].contains(&node)).count();
        // Of alternating diagonals 8 or 4 elements meet inside.
        let meet: Vec<usize> = (0..mesh.nodes.len()).map(inner).filter(|count| *count > 4).collect();
        assert!(!meet.is_empty() && meet.iter().all(|count| *count == 8), "{meet:?}");
        for element in &mesh.elements {
            let at = |k: usize| mesh.nodes[element.nodes[k]];
            (0..3).for_each(|k| assert!((at(3 + k) - 0.5 * (at(k) + at((k + 1) % 3))).norm() < 0.06));
        }
    }
}

/// With straight edges a quarter ring of n sectors has the area n/2 sin(π/2n) (b² − a²).
#[test]
fn arcs_are_circles() {
    let [a, b] = [2.0, 3.0];
    for n in [3, 6] {
        let ring = mesh(&[quarter(0.4, [a, b], [n, 2], BlockKind::Q4)], &[]).unwrap();
        close("sectors", area(&ring), 0.5 * n as f64 * (FRAC_PI_2 / n as f64).sin() * (b * b - a * a), 1e-13);
    }
    // Quadratic edges through points of the circle miss its area by the fourth power of their length.
    let missing = |n: usize| {
        let mut block = quarter(-0.9, [a, b], [n, 2], BlockKind::Q8);
        block.sides[2] = Some("outside".into());
        let ring = mesh(&[block], &[]).unwrap();
        let Group::Edges(edges) = ring.group("outside").unwrap() else { panic!("edges") };
        edges.iter().flat_map(|edge| &edge.nodes).for_each(|&node| close("radius", ring.nodes[node].norm(), b, 1e-14));
        assert!(ring.nodes.iter().all(|node| (a - 1e-14..b + 1e-14).contains(&node.norm())));
        PI / 4.0 * (b * b - a * a) - area(&ring)
    };
    let order = (missing(4) / missing(8)).log2();
    assert!((order - 4.0).abs() < 0.05, "order {order}");
}

#[test]
fn a_ring_closes() {
    let quarters: Vec<Block> =
        (0..4).map(|k| quarter(FRAC_PI_2 * f64::from(k), [1.0, 2.0], [5, 3], BlockKind::Q4)).collect();
    let ring = mesh(&quarters, &[]).unwrap();
    assert_eq!((ring.nodes.len(), ring.elements.len()), (20 * 4, 60));
}

/// A second block right of the first, whichever of its corners comes first and whichever way round they go.
#[test]
fn blocks_join_whatever_the_order_of_corners() {
    let corners = [[1.0, 0.0], [2.5, 0.2], [2.0, 1.1], [1.0, 1.0]];
    let left = Block::rectangle("b", [4, 3], [0.0, 0.0], [1.0, 1.0]);
    let left = Block { sides: [const { None }; 4], grading: [Grading::Ratio(1.0), Grading::Ratio(2.0)], ..left };
    for turn in 0..4 {
        for mirrored in [false, true] {
            let k = |i: usize| if mirrored { (8 - i + turn) % 4 } else { (i + turn) % 4 };
            let given = [0, 1, 2, 3].map(|i| corners[k(i)]);
            // The shared side, between its corners 0 and 3, goes up where the lower one comes first.
            let shared = (0..4).find(|i| [k(*i), k((i + 1) % 4)].iter().all(|corner| [0, 3].contains(corner))).unwrap();
            let start = if shared < 2 { shared } else { (shared + 1) % 4 };
            let ratio = Grading::Ratio(if k(start) == 0 { 2.0 } else { 0.5 });
            let (mut elements, mut grading) = ([5, 5], [Grading::Ratio(1.0); 2]);
            (elements[shared % 2], grading[shared % 2]) = (3, ratio);
            let right = Block { grading, ..Block::new("b", given, elements) };
            let joined =
                mesh(&[left.clone(), right.clone()], &[]).unwrap_or_else(|error| panic!("{turn} {mirrored}: {error}"));
            assert_eq!((joined.nodes.len(), joined.elements.len()), (5 * 4 + 5 * 4, 12 + 15));
            let polygon: f64 = (0..4)
                .map(|i| 0.5 * (corners[i][0] * corners[(i + 1) % 4][1] - corners[(i + 1) % 4][0] * corners[i][1]))
                .sum();
            close("area", area(&joined), 1.0 + polygon, 1e-14);
            let other = Block { body: "other".into(), ..right };
            assert_eq!(mesh(&[left.clone(), other], &[]).unwrap().nodes.len(), 5 * 4 + 6 * 4);
        }
    }
}

/// Four blocks round a point; a crack comes from the left and ends there.
#[test]
fn a_crack_parts_its_sides_and_not_its_tip() {
    let sides = |below: bool| [(!below).then(|| "upper".to_string()), None, below.then(|| "lower".to_string()), None];
    let square = |x: f64, y: f64| Block::new("b", [[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]], [2, 2]);
    let blocks = [
        Block { sides: sides(true), ..square(0.0, 0.0) },
        Block { sides: sides(false), ..square(0.0, 1.0) },
        square(1.0, 0.0),
        square(1.0, 1.0),
    ];
    let cracked = mesh(&blocks, &["upper", "lower"]).unwrap();
    assert_eq!(cracked.nodes.len(), 25 + 2);
    let [upper, lower] = ["upper", "lower"].map(|name| cracked.nodes_of(cracked.group(name).unwrap()));
    let shared: Vec<_> = upper.iter().filter(|node| lower.contains(node)).map(|&node| cracked.nodes[node]).collect();
    assert_eq!(shared, [nalgebra::Vector2::new(1.0, 1.0)]);
    assert!(mesh(&blocks, &["upper"]).unwrap().nodes.len() == 27);
    let message = mesh(&blocks, &[]).unwrap_err();
    assert!(
        message.contains("`lower` lies inside the body") || message.contains("`upper` lies inside the body"),
        "{message}"
    );
}

#[test]
fn blocks_that_cannot_be_joined_are_refused() {
    let square =
        |x: f64, y: f64, elements| Block::new("b", [[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]], elements);
    let one = square(0.0, 0.0, [2, 2]);
    let of = |corners| Block::new("b", corners, [2, 2]);
    let graded = |block: Block| Block { grading: [Grading::Ratio(1.0), Grading::Ratio(3.0)], ..block };
    let arched = Block { arcs: [None, None, None, Some([0.0, 0.5])], ..square(1.0, 0.0, [2, 2]) };
    let named = Block { sides: [None, None, None, Some("joint".into())], ..square(1.0, 0.0, [2, 2]) };
    for (other, fragments) in [
        (square(1.0, 0.0, [2, 3]), &["blocks[1]: its side 3 is side 1 of blocks[0], and has 4 nodes there to 3"][..]),
        (Block { kind: BlockKind::Q8, ..square(1.0, 0.0, [2, 2]) }, &["has 5 nodes there to 3", "kind"]),
        (graded(square(1.0, 0.0, [2, 2])), &["blocks[1]: its side 3 is side 1 of blocks[0]", "the same grading"]),
        (arched, &["blocks[1]: its side 3 is side 1 of blocks[0]", "the same arc"]),
        (named, &["blocks[1].sides[3]: is joined to side 1 of blocks[0]", "`joint` lies inside"]),
        (
            of([[1.0, 0.5], [2.0, 0.5], [2.0, 2.0], [1.0, 2.0]]),
            &["blocks[0]: its corner 2 lies on side 3 of blocks[1]", "whole sides"],
        ),
        (
            of([[1.0, -1.0], [2.0, -1.0], [2.0, 2.0], [1.0, 2.0]]),
            &["blocks[0]: its corner", "lies on side 3 of blocks[1]"],
        ),
        (square(1.0, 1.0, [2, 2]), &["its corner 2 lies on side", "of blocks[1]"]),
        (one.clone(), &["overlap"]),
        (of([[0.0, 0.0], [1.0, 0.0], [1.0, 0.4], [0.0, 0.4]]), &["overlap"]),
        (of([[-1.0, 0.3], [2.0, 0.3], [2.0, 0.8], [-1.0, 0.8]]), &["blocks[0]: overlaps blocks[1]", "move it"]),
        (of([[3.0, 0.0], [4.0, 1.0], [4.0, 0.0], [3.0, 1.0]]), &["blocks[1]: has elements that are folded", "cross"]),
        (of([[3.0, 0.0], [4.0, 0.0], [3.2, 0.2], [3.0, 1.0]]), &["folded", "an interior angle of 180° or more"]),
        (of([[3.0, 0.0], [4.0, 0.0], [4.0, f64::NAN], [3.0, 1.0]]), &["blocks[1]: has the coordinate NaN"]),
        (square(3.0, 0.0, [0, 1]), &["blocks[1].elements: is 0"]),
        (square(3.0, 0.0, [1 << 40, 1 << 40]), &["blocks[1].elements: makes", "take fewer"]),
        (
            Block { arcs: [Some([3.4, 0.0]), None, None, None], ..square(3.0, 0.0, [2, 2]) },
            &["arcs[0]: corner 0 is 0.4 from", "corner 1 0.6"],
        ),
        (
            Block { arcs: [Some([3.5, 0.0]), None, None, None], ..square(3.0, 0.0, [2, 2]) },
            &["arcs[0] spans a half circle"],
        ),
        (
            Block { grading: [Grading::Ratio(-1.0); 2], ..square(3.0, 0.0, [2, 2]) },
            &["grading[0] is -1: must be positive"],
        ),
        (Block { grading: [Grading::Ratio(2.0); 2], ..square(3.0, 0.0, [2, 1]) }, &["grading[1] is 2, and 1 elements"]),
    ] {
        let message = mesh(&[one.clone(), other], &[]).unwrap_err();
        fragments.iter().for_each(|fragment| assert!(message.contains(fragment), "`{fragment}` is not in: {message}"));
    }
    let message = mesh(&[Block::rectangle("b", [1, 1], [0.0; 2], [1.0; 2])], &["b_botom"]).unwrap_err();
    assert!(message.contains("separated[0]: no side is named `b_botom` (did you mean `b_bottom`?)"), "{message}");
}

/// A bar under uniaxial stress, of two blocks on either side of a dipping line.
fn bar() -> Value {
    let kind = "Q4";
    json!({
        "mesh": {
            "parameters": {"L": 3, "H": 1, "dip": "pi/3", "n": 4, "reach": "H/tan(dip)"},
            "blocks": [
                {"body": "bar", "corners": [[0, 0], ["L/2", 0], ["L/2 + reach", "H"], [0, "H"]], "elements": ["2*n", "n"],
                 "grading": [1, {"middle": 3}], "kind": kind, "sides": ["bottom", null, null, "left"]},
                {"body": "bar", "corners": [["L", 0], ["L", "H"], ["L/2 + reach", "H"], ["L/2", 0]], "elements": ["n", "n"],
                 "grading": [{"middle": 3}, "1/2"], "kind": kind, "sides": ["right", null, null, "bottom"]}
            ]
        },
        "bodies": {"bar": {"material": {"model": "linear", "E": 100, "nu": 0.25}}},
        "steps": [{"name": "pull", "duration": 1, "dt": {"initial": 1}, "supports": [
            {"on": "left", "ux": 0}, {"on": "bottom", "uy": 0}, {"on": "right", "ux": 0.003}
        ]}]
    })
}

/// Linear displacements are exact whatever the mesh (patch test): ε = 0.001, σ = E/(1 − ν²) ε in plane strain.
#[test]
fn joined_blocks_carry_constant_stress() {
    for kinds in [["Q4"; 2], ["Q8"; 2], ["T6"; 2], ["Q8", "T6"]] {
        let mut case = bar();
        (0..2).for_each(|b| case["mesh"]["blocks"][b]["kind"] = json!(kinds[b]));
        let run = finish(&case);
        let [force, _] = run.reaction("right", run.last());
        close("force", force, 100.0 / (1.0 - 0.0625) * 1e-3, 1e-12);
        for (node, x) in run.model.mesh.nodes.iter().enumerate() {
            close("ux", run.last().displacement[2 * node], 1e-3 * x.x, 1e-14);
            close("uy", run.last().displacement[2 * node + 1], -1e-3 / 3.0 * x.y, 1e-14);
        }
    }
}

/// Two materials in series, ν = 0: F = u/(L₁/E₁ + L₂/E₂) for each unit of height, and the joint moves by F L₁/E₁. Without `joined`
/// nothing holds the parts together.
#[test]
fn bonded_materials_stretch_in_series() {
    let [e1, e2, u] = [100.0, 25.0, 0.003];
    for kind in ["Q4", "Q8"] {
        let mut case = bar();
        (0..2).for_each(|b| case["mesh"]["blocks"][b]["kind"] = json!(kind));
        case["mesh"]["parameters"]["dip"] = json!("pi/2");
        case["mesh"]["blocks"][1]["body"] = json!("tip");
        case["mesh"]["blocks"][0]["points"] = json!({"joint": ["L/2", "H"], "corners": [0, 0]});
        case["mesh"]["blocks"][1]["points"] = json!({"corners": ["L", 0]});
        let material = |young: f64| json!({"material": {"model": "linear", "E": young, "nu": 0}});
        case["bodies"] = json!({"bar": material(e1), "tip": material(e2)});
        case["watch"] = json!(["joint", {"near": [3, 1]}, {"node": 0}, "corners"]);
        let apart = finish(&case);
        close("apart", apart.reaction("right", apart.last())[0], 0.0, 1e-12);
        case["mesh"]["joined"] = json!([["bar", "tip"]]);
        let run = finish(&case);
        let nodes = if kind == "Q4" { 13 * 5 } else { 25 * 5 + 13 * 4 };
        assert_eq!(run.model.mesh.nodes.len(), nodes);
        let stress = u / (1.5 / e1 + 1.5 / e2);
        close("force", run.reaction("right", run.last())[0], stress, 1e-12);
        let sets = &run.model.requests.watch;
        assert_eq!(
            sets.iter().map(|set| set.name.as_str()).collect::<Vec<_>>(),
            ["joint", "near_3_1", "node_0", "corners"]
        );
        assert_eq!(sets.iter().map(|set| set.nodes.len()).collect::<Vec<_>>(), [1, 1, 1, 2]);
        let at = |set: usize| run.model.mesh.nodes[sets[set].nodes[0]];
        assert_eq!([at(0), at(1), at(2)].map(|x| [x.x, x.y]), [[1.5, 1.0], [3.0, 1.0], [0.0, 0.0]]);
        close("the joint", run.last().displacement[2 * sets[0].nodes[0]], stress * 1.5 / e1, 1e-14);
        // The reaction of a corner: σ over half an edge, or a sixth of a quadratic one; the edges are 1/8, 3/8, 3/8 and 1/8 high.
        let share = 0.125 * if kind == "Q4" { 0.5 } else { 1.0 / 6.0 };
        let held = &sets[2].constrained[0];
        close("a corner", held.iter().map(|&node| run.last().reaction[2 * node]).sum(), -stress * share, 1e-12);
    }
}

/// A node of two bodies has the shares of both: `stabilize` × (λ + 2G) × duration over the nodes of each, λ + 2G = E for ν = 0.
#[test]
fn stabilization_of_a_shared_node_is_that_of_both_bodies() {
    let mut case = bar();
    case["mesh"]["parameters"]["dip"] = json!("pi/2");
    case["mesh"]["blocks"][1]["body"] = json!("tip");
    case["mesh"]["blocks"][0]["points"] = json!({"joint": ["L/2", "H"]});
    case["mesh"]["joined"] = json!([["bar", "tip"]]);
    let material = |young: f64| json!({"material": {"model": "linear", "E": young, "nu": 0}});
    case["bodies"] = json!({"bar": material(100.0), "tip": material(25.0)});
    case["steps"][0]["stabilize"] = json!(1e-3);
    let model = model(&case);
    let joint = model.mesh.nodes_of(model.mesh.group("joint").unwrap())[0];
    close("c", model.steps[0].stabilization[2 * joint], 1e-3 * (100.0 / 45.0 + 25.0 / 25.0), 1e-15);
    close("c", model.steps[0].stabilization[0], 1e-3 * 100.0 / 45.0, 1e-15);
}

#[test]
fn points_and_joined_bodies_are_checked() {
    for (pointer, value, fragments) in [
        ("/mesh/joined", json!([["bar"]]), &["mesh.joined[0]: must name two bodies or more"][..]),
        ("/mesh/joined", json!([["bar", "bat"]]), &["mesh.joined[0][1]: no block is of the body `bat`", "mean `bar`?"]),
        ("/mesh/joined", json!([["bar", "bar"]]), &["mesh.joined[0]: no block of `bar` shares a whole side"]),
        ("/mesh/blocks/0/points", json!({"p": ["L/4", "H/2", 0]}), &["mesh.blocks[0].points.p: has 3 entries"]),
        ("/mesh/blocks/0/points", json!({"p": ["L/32", 0]}), &["are equally near to (0.09375, 0)"]),
        (
            "/mesh/blocks/0/points",
            json!({"p": ["2*L", 0]}),
            &["mesh.blocks[0].points.p: no node of this block is near (6, 0)"],
        ),
        ("/mesh/blocks/0/points", json!({"p": ["K", 0]}), &["mesh.blocks[0].points.p[0]: ", "`K`"]),
        ("/mesh/blocks/0/points", json!({"left": [0, 0]}), &["two groups of the mesh are named `left`"]),
        ("/mesh/points", json!({"p": [0]}), &["has both `blocks` and `points`"]),
    ] {
        let message = refused(pointer, value);
        fragments.iter().for_each(|fragment| assert!(message.contains(fragment), "`{fragment}` is not in: {message}"));
    }
    let square = |body: &str, x: f64| Block::new(body, [[x, 0.0], [x + 1.0, 0.0], [x + 1.0, 1.0], [x, 1.0]], [2, 2]);
    let joined = |blocks: &[Block]| {
        let mesh = Blocks::new(blocks).joined(["a", "b"]).mesh().map_err(|error| error.to_string());
        mesh.map(|mesh| mesh.nodes.len())
    };
    assert_eq!(joined(&[square("a", 0.0), square("b", 1.0)]), Ok(15));
    // The side between them is that of one body if the other goes: tests of stages.
    assert_eq!(joined(&[square("a", 0.0), square("b", 1.0).side(3, "joint")]), Ok(15));
    let message = joined(&[square("a", 0.0), square("b", 3.0)]).unwrap_err();
    assert!(message.contains("joined[0]: no block of `a` shares a whole side with one of the others"), "{message}");
    let message = joined(&[square("a", 0.0), square("b", 0.5)]).unwrap_err();
    assert!(message.contains("blocks["), "{message}");
}

fn refused(pointer: &str, value: Value) -> String {
    let mut case = bar();
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    match case.pointer_mut(parent).unwrap() {
        Value::Array(list) => list[key.parse::<usize>().unwrap()] = value,
        object => object[key] = value,
    }
    refusal(&case)
}

#[test]
fn one_number_moves_a_mesh() {
    let places = |dip: Value| {
        let mut case = bar();
        case["mesh"]["parameters"]["dip"] = dip;
        model(&case).mesh.nodes
    };
    let (one, other) = (places(json!(FRAC_PI_2)), places(json!("pi/4")));
    assert_eq!(one.len(), other.len());
    let corner = |nodes: &[nalgebra::Vector2<f64>], x: f64| {
        nodes.iter().any(|node| (node - nalgebra::Vector2::new(x, 1.0)).norm() < 1e-12)
    };
    assert!(corner(&one, 1.5) && !corner(&one, 2.5) && corner(&other, 2.5));
}

#[test]
fn parameters_are_checked() {
    for (pointer, value, fragments) in [
        (
            "/mesh/parameters/L",
            json!("2*M"),
            &["test.json: mesh.parameters.L: ", "`M` is not one of the variables H, dip, n"][..],
        ),
        ("/mesh/parameters/L", json!("reach*2 + L"), &["mesh.parameters.L: ", "`L` is not one of the variables"]),
        ("/mesh/parameters/reach", json!("1/(H - 1)"), &["mesh.parameters.reach: ", "is inf: must be finite"]),
        ("/mesh/parameters/pi", json!(3), &["mesh.parameters.pi: is a constant"]),
        ("/mesh/parameters/max", json!(3), &["mesh.parameters.max: is a function"]),
        ("/mesh/parameters/a-b", json!(3), &["mesh.parameters.a-b: is not a name"]),
        ("/mesh/parameters/h", json!(3), &["mesh.parameters.h: is not used in any expression of the mesh"]),
        ("/mesh/parameters/h", json!(true), &["mesh.parameters.h: must be a number, or an expression"]),
        ("/mesh/parameters/n", json!(2.5), &["mesh.blocks[0].elements[1]: is 2.5: must be a whole number"]),
        ("/mesh/parameters/n", json!(0), &["mesh.blocks[0].elements[0]: is 0: must be a whole number"]),
        ("/mesh/blocks/0/corners/1", json!(["L/", 0]), &["mesh.blocks[0].corners[1][0]: ", "is missing here"]),
        ("/mesh/blocks/0/corners", json!([[0, 0]]), &["mesh.blocks[0].corners: has 1 entries, but must have 4"]),
        (
            "/mesh/blocks/0/grading/0",
            json!([1]),
            &["mesh.blocks[0].grading[0]: ", "must be the ratio of the last size"],
        ),
        ("/mesh/blocks/0/kind", json!("Q9"), &["mesh.blocks[0].kind: ", "`Q9`", "`Q8`"]),
        ("/mesh/blocks/0/arc", json!(1), &["mesh.blocks[0].arc: ", "did you mean `arcs`?"]),
        ("/mesh/nodes", json!([[0, 0]]), &["mesh", "has both `blocks` and `nodes`"]),
        ("/mesh/blocks", json!(null), &["mesh", "has `parameters` without `blocks`"]),
    ] {
        let message = refused(pointer, value);
        fragments.iter().for_each(|fragment| assert!(message.contains(fragment), "`{fragment}` is not in: {message}"));
    }
}

/// `cases/sawcut.json` at two angles θ of the cut. Its two blocks slide on each other under uniform stress,
/// q = Δσ sin θ cos θ, p = σ₃ + Δσ cos² θ, so Δσ = μ σ₃/(sin θ cos θ − μ cos² θ), at the slip rate V/sin θ. After 30 s the law has come to its
/// steady μ = (κ V + ξ)/b but for exp(−30 b), b = κ V/μ_k + ξ/μ_s. That the pressures follow the sides as the sample becomes shorter makes
/// 0.05 % of Δσ.
#[test]
fn a_sample_with_a_saw_cut_slides_by_its_angle() {
    let path = crate::common::repository("cases/sawcut.json");
    let mut case: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    for angle in [45.0f64, 55.0] {
        case["mesh"]["parameters"]["angle"] = json!(angle);
        let run = finish(&case);
        let (sin, cos) = angle.to_radians().sin_cos();
        let friction = &case["contacts"]["cut"]["friction"];
        let [mu_s, mu_k, kappa, xi] = ["mu_s", "mu_k", "kappa", "xi"].map(|name| friction[name].as_f64().unwrap());
        let lost = kappa * 0.005 / sin;
        let b = lost / mu_k + xi / mu_s;
        let mu = (lost + xi) / b;
        let [normal, tangential] = run.contact_force(run.last());
        close("μ", tangential.abs() / normal, mu, (mu_s - mu) * (-30.0 * b).exp());
        let stress = mu * 10.0 / (sin * cos - mu * cos * cos);
        close("Δσ", -run.reaction("top", run.last())[1] / 40.0, stress, 3e-3 * stress);
    }
}

/// Elements that lock where a body yields are told with those that do not, and an element with reduced integration that nothing holds
/// is told; fit ones are not.
#[test]
fn elements_that_do_not_fit_their_body_are_warned_of() {
    let warned = |kind: &str, element: &str, law: &str, elements: [usize; 2], section: Value| {
        let block = json!({"body": "b", "corners": [[1, 0], [3, 0], [3, 1], [1, 1]], "elements": elements, "kind": kind,
                           "sides": ["bottom", null, null, null]});
        let material = match law {
            "von_mises" => json!({"model": law, "E": 100, "nu": 0.3, "sigma_y": 1}),
            "mohr_coulomb" => json!({"model": law, "E": 100, "nu": 0.3, "c": 1, "phi": 30, "psi": 30}),
            _ => json!({"model": law, "E": 100, "nu": 0.3}),
        };
        let mut case = json!({
            "mesh": {"blocks": [block]}, "bodies": {"b": {"material": material, "element": element}},
            "steps": [{"name": "hold", "duration": 1, "dt": {"initial": 1}, "supports": [{"on": "b", "ux": 0, "uy": 0}]}]
        });
        if !section.is_null() {
            case["section"] = section;
        }
        model(&case).warnings()
    };
    let lock =
        |warnings: Vec<String>| warnings.into_iter().filter(|warning| warning.contains("body `b`")).collect::<Vec<_>>();
    let plain = |kind, element, law| lock(warned(kind, element, law, [2, 2], Value::Null));
    for (kind, element) in [("Q4", "f_bar"), ("Q8", "reduced"), ("T6", "displacement")] {
        assert_eq!(plain(kind, element, "von_mises"), [""; 0], "{kind} {element}");
    }
    assert_eq!(plain("Q4", "displacement", "hencky"), [""; 0]);
    assert_eq!(plain("Q8", "reduced", "mohr_coulomb"), [""; 0]);
    for kind in ["Q4", "Q8"] {
        let text = plain(kind, "displacement", "von_mises");
        let expected = format!("its elements ({kind}) lock where it yields");
        assert!(text.len() == 1 && text[0].contains(&expected) && text[0].contains("\"f_bar\""), "{text:?}");
        let text = plain(kind, "displacement", "mohr_coulomb");
        assert!(text.len() == 1 && text[0].contains("dilates") && !text[0].contains("f_bar"), "{text:?}");
    }
    let text = plain("Q4", "f_bar", "mohr_coulomb");
    assert!(text.len() == 1 && text[0].contains("f_bar cures in part only"), "{text:?}");
    let plate = json!({"plane_stress": {"thickness": 1}});
    assert_eq!(lock(warned("Q4", "displacement", "von_mises", [2, 2], plate)), [""; 0]);
    let text = lock(warned("Q8", "reduced", "hencky", [1, 1], Value::Null));
    assert!(text.len() == 1 && text[0].contains("can bend into an hourglass"), "{text:?}");
}
