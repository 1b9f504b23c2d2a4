//! Meshes of two rectangles, or one, in canonical coordinates; numbered and grouped as asked.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use serde_json::{Value, json};

use crate::features::hash;
use crate::frame::Frame;

/// A mesh before it is written.
#[derive(Clone, Debug, Default)]
pub struct Sheet {
    pub nodes: Vec<[f64; 2]>,
    pub elements: BTreeMap<String, Vec<Vec<usize>>>,
    pub edges: BTreeMap<String, Vec<Vec<usize>>>,
    pub points: BTreeMap<String, Vec<usize>>,
}

/// A rectangle of elements of one kind; `warp` moves its inner nodes.
pub struct Rectangle<'a> {
    pub name: &'a str,
    pub low: [f64; 2],
    pub high: [f64; 2],
    pub columns: usize,
    pub rows: usize,
    pub element: &'a str,
    pub warp: f64,
}

/// The curve that is a rigid master.
pub const DIE: &str = "die";

/// The nearest multiple of 2⁻¹⁶.
pub fn dyadic(x: f64) -> f64 {
    (x * 65536.0).round() / 65536.0
}

pub fn is_quadratic(element: &str) -> bool {
    matches!(element, "t6" | "q8" | "reduced" | "q9")
}

impl Sheet {
    /// Add a rectangle with its body, four sides and the corner of `high`.
    pub fn rectangle(&mut self, r: &Rectangle) {
        let (columns, rows) = (2 * r.columns, 2 * r.rows);
        let corner = |i: usize, j: usize| {
            let [u, v] = [i as f64 / columns as f64, j as f64 / rows as f64];
            let inner = r.warp * (PI * u).sin() * (PI * v).sin();
            let straight = |k: usize, share: f64| r.low[k] + (r.high[k] - r.low[k]) * share;
            [straight(0, u) + inner * (5.0 * u).sin(), straight(1, v) + inner * (4.0 * v).cos()].map(dyadic)
        };
        let mean = |of: &[[f64; 2]]| [0, 1].map(|k| of.iter().map(|p| p[k]).sum::<f64>() / of.len() as f64);
        let mut numbers: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        let nodes = &mut self.nodes;
        let mut at = |i: usize, j: usize| {
            *numbers.entry((i, j)).or_insert_with(|| {
                let place = match (i % 2, j % 2) {
                    (0, 0) => corner(i, j),
                    (1, 0) => mean(&[corner(i - 1, j), corner(i + 1, j)]),
                    (0, 1) => mean(&[corner(i, j - 1), corner(i, j + 1)]),
                    // On the diagonal that two triangles share.
                    _ if r.element == "t6" => mean(&[corner(i - 1, j - 1), corner(i + 1, j + 1)]),
                    _ => {
                        mean(&[corner(i - 1, j - 1), corner(i + 1, j - 1), corner(i + 1, j + 1), corner(i - 1, j + 1)])
                    }
                };
                nodes.push(place);
                nodes.len() - 1
            })
        };
        let mut elements = Vec::new();
        for j in (0..rows).step_by(2) {
            for i in (0..columns).step_by(2) {
                let c = [at(i, j), at(i + 2, j), at(i + 2, j + 2), at(i, j + 2)];
                match r.element {
                    "t3" if (i + j) % 4 == 0 => elements.extend([vec![c[0], c[1], c[2]], vec![c[0], c[2], c[3]]]),
                    "t3" => elements.extend([vec![c[0], c[1], c[3]], vec![c[1], c[2], c[3]]]),
                    "q4" | "f_bar" => elements.push(c.to_vec()),
                    _ => {
                        let [b, right, t, l] = [at(i + 1, j), at(i + 2, j + 1), at(i + 1, j + 2), at(i, j + 1)];
                        match r.element {
                            "t6" => {
                                let m = at(i + 1, j + 1);
                                elements.extend([vec![c[0], c[1], c[2], b, right, m], vec![c[0], c[2], c[3], m, t, l]]);
                            }
                            "q8" | "reduced" => elements.push(vec![c[0], c[1], c[2], c[3], b, right, t, l]),
                            _ => elements.push(vec![c[0], c[1], c[2], c[3], b, right, t, l, at(i + 1, j + 1)]),
                        }
                    }
                }
            }
        }
        let quadratic = is_quadratic(r.element);
        let mut side = |line: Vec<(usize, usize)>| -> Vec<Vec<usize>> {
            line.windows(3)
                .step_by(2)
                .map(|w| {
                    let ends = [at(w[0].0, w[0].1), at(w[2].0, w[2].1)];
                    let middle = quadratic.then(|| at(w[1].0, w[1].1));
                    ends.into_iter().chain(middle).collect()
                })
                .collect()
        };
        let sides = [
            ("bottom", side((0..=columns).map(|i| (i, 0)).collect())),
            ("right", side((0..=rows).map(|j| (columns, j)).collect())),
            ("top", side((0..=columns).rev().map(|i| (i, rows)).collect())),
            ("left", side((0..=rows).rev().map(|j| (0, j)).collect())),
        ];
        let corner = at(columns, rows);
        let name = r.name;
        self.edges.extend(sides.map(|(side, edges)| (format!("{name}_{side}"), edges)));
        self.points.insert(format!("{name}_corner"), vec![corner]);
        self.elements.entry(name.into()).or_default().extend(elements);
    }

    /// Make nodes at one place one, of those from a number on.
    pub fn weld(&mut self, first: usize) {
        let mut kept = self.nodes[..first].to_vec();
        let mut number: Vec<usize> = (0..first).collect();
        for place in &self.nodes[first..] {
            let at = kept[first..].iter().position(|other| other == place).map(|at| first + at);
            number.push(at.unwrap_or(kept.len()));
            kept.extend(at.is_none().then_some(*place));
        }
        self.renumber(kept, &number);
    }

    /// Make all nodes at a place one.
    pub fn weld_at(&mut self, place: [f64; 2]) {
        let Some(first) = self.nodes.iter().position(|at| *at == place) else { return };
        let mut number: Vec<usize> = Vec::new();
        let mut kept = Vec::new();
        for (k, at) in self.nodes.iter().enumerate() {
            let again = k > first && *at == place;
            number.push(if again { number[first] } else { kept.len() });
            kept.extend((!again).then_some(*at));
        }
        self.renumber(kept, &number);
    }

    /// Other nodes, by the numbers that the old ones have now.
    fn renumber(&mut self, nodes: Vec<[f64; 2]>, number: &[usize]) {
        self.nodes = nodes;
        let groups = self.elements.values_mut().chain(self.edges.values_mut());
        groups.flatten().flatten().for_each(|node| *node = number[*node]);
        self.points.values_mut().flatten().for_each(|node| *node = number[*node]);
    }

    /// Give the right half of a body's elements another name; the nodes between are shared.
    pub fn split(&mut self, body: &str, other: &str) {
        let elements = self.elements.remove(body).unwrap_or_default();
        let centre =
            |element: &Vec<usize>| element.iter().map(|&n| self.nodes[n][0]).sum::<f64>() / element.len() as f64;
        let all: Vec<f64> = elements.iter().map(centre).collect();
        let middle = 0.5
            * (all.iter().copied().fold(f64::INFINITY, f64::min)
                + all.iter().copied().fold(f64::NEG_INFINITY, f64::max));
        let (left, right) = elements.into_iter().zip(all).partition::<Vec<_>, _>(|(_, at)| *at < middle);
        let names = |half: Vec<(Vec<usize>, f64)>| half.into_iter().map(|(element, _)| element).collect::<Vec<_>>();
        self.elements.insert(body.into(), names(left));
        self.elements.insert(other.into(), names(right));
    }

    /// Number nodes, elements and edges in another order, and begin elements at another corner.
    pub fn shuffle(&mut self, seed: u64) {
        let mut draws = 0;
        let mut below = |n: usize| {
            draws += 1;
            (hash(seed, &format!("shuffle {draws}")) % n as u64) as usize
        };
        let mut order: Vec<usize> = (0..self.nodes.len()).collect();
        for k in (1..order.len()).rev() {
            order.swap(k, below(k + 1));
        }
        let mut number = vec![0; order.len()];
        order.iter().enumerate().for_each(|(new, &old)| number[old] = new);
        let nodes = order.iter().map(|&old| self.nodes[old]).collect();
        self.renumber(nodes, &number);
        for elements in self.elements.values_mut() {
            for element in elements.iter_mut() {
                let corners = if matches!(element.len(), 3 | 6) { 3 } else { 4 };
                let turn = below(corners);
                element[..corners].rotate_left(turn);
                if element.len() >= 2 * corners {
                    element[corners..2 * corners].rotate_left(turn);
                }
            }
            for k in (1..elements.len()).rev() {
                elements.swap(k, below(k + 1));
            }
        }
        for (name, edges) in &mut self.edges {
            // The sense of an outline says where the solid is.
            let may_turn = name != DIE;
            edges.iter_mut().filter(|_| below(2) == 0 && may_turn).for_each(|edge| edge.swap(0, 1));
            for k in (1..edges.len()).rev() {
                edges.swap(k, below(k + 1));
            }
        }
    }

    /// As it stands in a case.
    pub fn written(&self, frame: &Frame) -> Value {
        let nodes: Vec<[f64; 2]> = self.nodes.iter().map(|p| frame.point(*p)).collect();
        let mut elements = self.elements.clone();
        if frame.flips() {
            elements.values_mut().flatten().for_each(|element| mirrored(element));
        }
        json!({"nodes": nodes, "elements": elements, "edges": self.edges, "points": self.points})
    }
}

/// Counter-clockwise again, from the same first corner.
fn mirrored(element: &mut [usize]) {
    let corners = if matches!(element.len(), 3 | 6) { 3 } else { 4 };
    element[1..corners].reverse();
    if element.len() >= 2 * corners {
        element[corners..2 * corners].reverse();
    }
}
