//! Simple meshes from code: blocks of Q4 elements, side by side or one on the other.

use super::inline::InlineMesh;

impl InlineMesh {
    /// Add a rectangle of n × m elements, from its lower left to its upper right corner [L]. One named `b` brings the group
    /// `b` of its elements and the groups `b_bottom`, `b_right`, `b_top` and `b_left` of its edges. It shares no nodes with
    /// other rectangles; one of a name that is there already joins its groups.
    ///
    /// ```
    /// use fecontact::mesh::InlineMesh;
    ///
    /// let mesh = InlineMesh::default().rectangle("block", [4, 2], [0.0, 0.0], [2.0, 1.0]).build()?;
    /// assert_eq!((mesh.nodes.len(), mesh.elements.len()), (15, 8));
    /// # Ok::<(), fecontact::mesh::MeshError>(())
    /// ```
    pub fn rectangle(self, name: &str, divisions: [usize; 2], low: [f64; 2], high: [f64; 2]) -> Self {
        self.block(name, divisions, |s, t| [low[0] + s * (high[0] - low[0]), low[1] + t * (high[1] - low[1])])
    }

    /// Add a block like [`InlineMesh::rectangle`], placed by a map from the unit square to the plane, which must not mirror
    /// it.
    pub fn block(mut self, name: &str, [n, m]: [usize; 2], map: impl Fn(f64, f64) -> [f64; 2]) -> Self {
        let first = self.nodes.len();
        let node = |i: usize, j: usize| first + j * (n + 1) + i;
        for j in 0..=m {
            self.nodes.extend((0..=n).map(|i| map(i as f64 / n as f64, j as f64 / m as f64)));
        }
        let element = |e: usize| {
            let (i, j) = (e % n, e / n);
            vec![node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)]
        };
        let row = |j: usize| (0..n).map(|i| vec![node(i, j), node(i + 1, j)]).collect::<Vec<_>>();
        let column = |i: usize| (0..m).map(|j| vec![node(i, j), node(i, j + 1)]).collect::<Vec<_>>();
        self.elements.entry(name.into()).or_default().extend((0..n * m).map(element));
        for (side, edges) in [("bottom", row(0)), ("right", column(n)), ("top", row(m)), ("left", column(0))] {
            self.edges.entry(format!("{name}_{side}")).or_default().extend(edges);
        }
        self
    }
}
