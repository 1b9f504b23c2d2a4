//! Combination of meshes that share no nodes.

use super::{Edge, Group, Mesh, MeshError};

impl Mesh {
    /// Combines meshes into one. They share no nodes; each keeps its own tags, so that a tag may occur several times. The
    /// section is that of the first.
    ///
    /// ```
    /// use fecontact::mesh::{InlineMesh, Mesh};
    ///
    /// let below = InlineMesh::default().rectangle("ground", [4, 2], [0.0, -1.0], [2.0, 0.0]).build()?;
    /// let above = InlineMesh::default().rectangle("block", [3, 3], [0.5, 0.0], [1.5, 1.0]).build()?;
    /// let mesh = Mesh::join([below, above])?;
    /// assert_eq!((mesh.nodes.len(), mesh.elements.len()), (15 + 16, 8 + 9));
    /// # Ok::<(), fecontact::mesh::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// Returns [`MeshError::InTwoMeshes`] if two meshes have a group of the same name, [`MeshError::NoElements`] if there are
    /// no meshes.
    pub fn join(meshes: impl IntoIterator<Item = Self>) -> Result<Self, MeshError> {
        let mut meshes = meshes.into_iter();
        let mut all = meshes.next().ok_or(MeshError::NoElements)?;
        let mut from: Vec<(String, usize)> = all.groups.keys().map(|name| (name.clone(), 0)).collect();
        for (k, mesh) in meshes.enumerate() {
            if let Some((group, first)) = from.iter().find(|(name, _)| mesh.groups.contains_key(name)) {
                return Err(MeshError::InTwoMeshes { group: group.clone(), meshes: [*first, k + 1] });
            }
            from.extend(mesh.groups.keys().map(|name| (name.clone(), k + 1)));
            all.add(mesh);
        }
        Ok(all)
    }

    fn add(&mut self, mut other: Self) {
        let (nodes, elements) = (self.nodes.len(), self.elements.len());
        let moved = |numbers: &mut Vec<usize>, by: usize| numbers.iter_mut().for_each(|number| *number += by);
        other.elements.iter_mut().for_each(|element| moved(&mut element.nodes, nodes));
        for group in other.groups.values_mut() {
            match group {
                Group::Elements(list) => moved(list, elements),
                Group::Edges(edges) => edges.iter_mut().for_each(|Edge { nodes: ends, element }| {
                    moved(ends, nodes);
                    *element += elements;
                }),
                Group::Nodes(list) => moved(list, nodes),
                Group::Lines(_) => {}
            }
        }
        for side in other.between.values_mut().flatten() {
            moved(&mut side.other.nodes, nodes);
            side.other.element += elements;
        }
        self.between.append(&mut other.between);
        self.nodes.append(&mut other.nodes);
        self.node_tags.append(&mut other.node_tags);
        self.elements.append(&mut other.elements);
        self.element_tags.append(&mut other.element_tags);
        self.groups.append(&mut other.groups);
    }
}
