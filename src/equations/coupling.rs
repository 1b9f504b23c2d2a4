//! Coupling of nodes: the pattern of the tangent, and the position of every element's blocks in it.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::contact::conduit::Conduit;
use crate::contact::response::PairResponse;
use crate::contact::seam::Seam;
use crate::contact::surface::Path;
use crate::contact::{ContactPair, Master};
use crate::linear::{BlockPosition, Pattern, SparseMatrix};
use crate::mesh::rigid::RigidBody;
use crate::model::pore_flow::PoreFlow;
use crate::model::{Model, State};

/// Maximum number of segments ahead of a projection for which the pattern has room.
const FARTHEST: usize = 8;

/// Nodes coupled in addition to those of elements and loads. The order of elimination depends on it, and thereby the round-off
/// of solutions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Coupling {
    /// Nodes of each contact point, and of the segments that it may slide to
    groups: Vec<Vec<usize>>,
    /// Segments ahead of each projection to be included when the pattern becomes too small
    ahead: usize,
}

impl Coupling {
    /// Couples all nodes of a group with each other.
    pub fn of(group: Vec<usize>) -> Self {
        Self { groups: vec![group], ahead: 1 }
    }

    /// Whether all its nodes are below this number.
    pub fn fits(&self, nodes: usize) -> bool {
        self.groups.iter().flatten().all(|node| *node < nodes)
    }
}

/// Nodes between which the tangent is not symmetric: see [`Pattern::symmetric_but`].
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Unsymmetric {
    /// Nodes that such contributions couple with each other
    pub nodes: Vec<usize>,
    /// Nodes whose equations are not those of their forces, or no more: these and all they couple with
    pub around: Vec<usize>,
}

/// Nodes that stand for pressures of neighbours along contacts where water flows between wet bodies.
fn channels(model: &Model, flow: &PoreFlow) -> Vec<[usize; 2]> {
    let conduits = model.contacts.iter().filter_map(|pair| pair.conduit.as_ref()).filter(|conduit| conduit.is_wet());
    let of = |conduit: &Conduit| -> Vec<[usize; 2]> {
        conduit.line.pieces().map(|(a, b)| [a, b].map(|k| flow.node(conduit.pressures[k]))).collect()
    };
    conduits.flat_map(of).collect()
}

/// Pattern of a model's tangent, and the position of each element in it.
#[derive(Clone)]
pub(super) struct Layout {
    model: Arc<Model>,
    /// current coupling
    pub coupling: Arc<Coupling>,
    /// what is not symmetric, except contact
    unsymmetric: Unsymmetric,
    /// the pattern
    pub pattern: Arc<Pattern>,
    /// Position of the block of every node pair of every element, in the current pattern
    blocks: Vec<BlockPosition>,
    /// Start of each element's blocks
    starts: Vec<usize>,
    /// The blocks of each element that water flows through: for each of its pressures those of all its nodes in the pressure's column, then those of
    /// its nodes in the mesh in the pressure's row
    water_blocks: Vec<BlockPosition>,
    /// Start of the blocks of each such element, and the end
    water_starts: Vec<usize>,
    /// Nodes of the closed contact points last included, each list preceded by its length
    contacts: Vec<usize>,
    /// Their blocks, point after point
    contact_blocks: Vec<BlockPosition>,
}

impl Layout {
    /// Creates the layout of all elements, loads and pairs of tied nodes.
    pub fn new(model: &Arc<Model>, unsymmetric: Unsymmetric) -> Self {
        let starts = std::iter::once(0).chain(model.mesh.elements.iter().scan(0, |sum, element| {
            *sum += element.nodes.len().pow(2);
            Some(*sum)
        }));
        let mut layout = Self {
            model: model.clone(),
            coupling: Arc::new(Coupling { groups: Vec::new(), ahead: 1 }),
            unsymmetric,
            pattern: Arc::new(Pattern::new(model.mesh.nodes.len(), std::iter::empty())),
            blocks: Vec::new(),
            starts: starts.collect(),
            water_blocks: Vec::new(),
            water_starts: Vec::new(),
            contacts: Vec::new(),
            contact_blocks: Vec::new(),
        };
        layout.set();
        layout
    }

    /// Sets the coupling of nodes; returns whether it changed.
    pub fn couple(&mut self, coupling: &Arc<Coupling>) -> bool {
        let changes = !Arc::ptr_eq(coupling, &self.coupling);
        if changes {
            self.coupling = coupling.clone();
            self.set();
        }
        changes
    }

    /// Takes over the coupling and the pattern of a layout of a model with the same elements and nodes; returns whether they changed.
    pub fn take(&mut self, other: &Layout) -> bool {
        let changes = !Arc::ptr_eq(&other.pattern, &self.pattern);
        if changes {
            *self = Self { model: self.model.clone(), ..other.clone() };
        }
        changes
    }

    /// Couples the nodes of all elements, loads, bars and groups, and finds every element's blocks in the new pattern.
    fn set(&mut self) {
        let groups = &self.coupling.clone().groups;
        let model = &*self.model.clone();
        let elements = model.mesh.elements.iter().map(|element| &element.nodes[..]);
        let edges = model.steps.iter().flat_map(|step| step.loads.pressures.iter().flat_map(|load| &load.edges));
        let of_bars: Vec<&[usize]> = model.bars.iter().flat_map(|bar| bar.groups()).collect();
        let others =
            edges.map(|edge| &edge[..]).chain(of_bars.iter().copied()).chain(groups.iter().map(|group| &group[..]));
        let wet = model.flow.iter().flat_map(|flow| &flow.elements).map(|wet| &wet.nodes[..]);
        let joined: Vec<[usize; 2]> = model.flow.iter().flat_map(|flow| channels(model, flow)).collect();
        let all = elements.chain(wet).chain(joined.iter().map(|nodes| &nodes[..])).chain(others);
        let tied = self.tied(all.clone());
        let pattern = Pattern::new(model.mesh.nodes.len(), all.chain(tied.iter().map(|group| &group[..])));
        let unsymmetric = self.all_unsymmetric(&pattern);
        let pressures = model.flow.as_ref().map_or(0..0, PoreFlow::nodes);
        self.pattern = Arc::new(pattern.symmetric_but(unsymmetric).with_pressures(pressures));
        let mut blocks = std::mem::take(&mut self.blocks);
        blocks.clear();
        blocks.reserve_exact(self.starts.last().copied().unwrap_or(0));
        model.mesh.elements.iter().for_each(|element| blocks.extend(self.blocks_between(&element.nodes)));
        self.blocks = blocks;
        self.find_water();
        self.contacts.clear();
        self.contact_blocks.clear();
    }

    /// Flags of all nodes between which the tangent is not symmetric.
    fn all_unsymmetric(&self, pattern: &Pattern) -> Vec<bool> {
        let (model, Unsymmetric { nodes, around }) = (&*self.model, &self.unsymmetric);
        let mut unsymmetric = vec![false; pattern.nodes()];
        nodes.iter().for_each(|&node| unsymmetric[self.original(node)] = true);
        around.iter().flat_map(|&node| pattern.neighbours(node)).for_each(|&node| unsymmetric[node] = true);
        // A copy's equation is that it moves with its original.
        model
            .ties
            .pairs()
            .iter()
            .for_each(|&(copy, original)| (unsymmetric[copy], unsymmetric[original]) = (true, true));
        let mut slides = vec![false; pattern.nodes()];
        let unsymmetric_pairs = model.contacts.iter().filter(|pair| !pair.is_symmetric());
        let of_water = |pair: &ContactPair| pair.seam.iter().flat_map(Seam::all_behind).collect::<Vec<_>>();
        unsymmetric_pairs.flat_map(|pair| pair.nodes().chain(of_water(pair))).for_each(|node| slides[node] = true);
        let groups = self.coupling.groups.iter().flatten();
        groups.filter(|node| slides[**node]).for_each(|&node| unsymmetric[self.original(node)] = true);
        unsymmetric
    }

    /// Take what is not symmetric in a step that has been changed; whether it was not known yet.
    pub fn mark(&mut self, unsymmetric: &Unsymmetric) -> bool {
        let known = self.pattern.unsymmetric();
        let around = unsymmetric.around.iter().flat_map(|&node| self.pattern.neighbours(node));
        let mut all = unsymmetric.nodes.iter().map(|&node| self.original(node)).chain(around.copied());
        let new = all.any(|node| !known[node]);
        if new {
            self.unsymmetric.nodes.extend(&unsymmetric.nodes);
            self.unsymmetric.around.extend(&unsymmetric.around);
            self.set();
        }
        new
    }

    /// Groups with copies or followers, expressed by their originals and with their leaders, and every copy with its original.
    fn tied<'a>(&self, groups: impl Iterator<Item = &'a [usize]> + Clone) -> Vec<Vec<usize>> {
        let ties = &self.model.ties;
        let linked = self.linked(groups.clone());
        if ties.pairs().is_empty() {
            return linked;
        }
        let originals = |group: &[usize]| -> Vec<usize> { group.iter().map(|&node| ties.original(node)).collect() };
        let moved = groups.map(|group| (group, originals(group))).filter(|(group, originals)| group != originals);
        let mut tied: Vec<Vec<usize>> = moved.map(|(_, originals)| originals).collect();
        tied.extend(ties.pairs().iter().map(|&(copy, original)| vec![copy, original]));
        // Leaders are coupled with the originals of what their followers meet.
        tied.extend(linked.iter().map(|group| originals(group)));
        tied.extend(linked);
        tied
    }

    /// Groups with followers, with their leaders; and the leaders of rigid platens.
    fn linked<'a>(&self, groups: impl Iterator<Item = &'a [usize]>) -> Vec<Vec<usize>> {
        let linkage = &self.model.linkage;
        if linkage.is_empty() && linkage.rigid.is_empty() {
            return Vec::new();
        }
        let mut leaders: Vec<Vec<usize>> = vec![Vec::new(); self.model.mesh.nodes.len()];
        for follower in &linkage.followers {
            leaders[follower.node].extend(follower.leaders.iter().map(|(leader, _)| *leader));
        }
        // The equations of A include the coupling of B.
        linkage.rigid.iter().for_each(|&[a, b]| leaders[b].push(a));
        if self.model.steps.iter().any(|step| step.scheme.coefficients().is_some()) {
            // In motion, the moment about the center of the platen moves A.
            linkage.rigid.iter().for_each(|&[a, b]| leaders[a].push(b));
        }
        let with = |group: &[usize]| -> Vec<usize> {
            let leading = group.iter().flat_map(|node| &leaders[*node]);
            let further = leading.clone().flat_map(|node| &leaders[*node]);
            group.iter().chain(leading).chain(further).copied().collect()
        };
        let longer = groups.map(|group| (group.len(), with(group))).filter(|(own, all)| all.len() > *own);
        let mut linked: Vec<Vec<usize>> = longer.map(|(_, all)| all).collect();
        linked.extend(linkage.followers.iter().map(|follower| with(&[follower.node])));
        linked.extend(linkage.rigid.iter().map(|plate| plate.to_vec()));
        linked
    }

    /// Original of a node.
    pub fn original(&self, node: usize) -> usize {
        self.model.ties.original(node)
    }

    /// Blocks of an element, column by column.
    pub fn blocks_of(&self, element: usize) -> &[BlockPosition] {
        &self.blocks[self.starts[element]..self.starts[element + 1]]
    }

    /// Finds the blocks of the elements that water flows through.
    fn find_water(&mut self) {
        self.water_blocks.clear();
        self.water_starts.clear();
        let model = self.model.clone();
        for wet in model.flow.iter().flat_map(|flow| &flow.elements) {
            self.water_starts.push(self.water_blocks.len());
            for pressure in &wet.nodes[wet.in_mesh..] {
                let (all, in_mesh) = (&wet.nodes, &wet.nodes[..wet.in_mesh]);
                let column = all.iter().map(|row| self.block(*row, *pressure));
                let row = in_mesh.iter().map(|column| self.block(*pressure, *column));
                let found: Vec<BlockPosition> = column.chain(row).collect();
                self.water_blocks.extend(found);
            }
        }
        self.water_starts.push(self.water_blocks.len());
    }

    /// Block of two coupled nodes.
    fn block(&self, row: usize, column: usize) -> BlockPosition {
        self.pattern.coupled(self.original(row), self.original(column))
    }

    /// Blocks of an element that water flows through, by its number among them: for each of its pressures those of all its nodes in the pressure's
    /// column, then those of its nodes in the mesh in the pressure's row.
    pub fn blocks_of_water(&self, number: usize) -> &[BlockPosition] {
        &self.water_blocks[self.water_starts[number]..self.water_starts[number + 1]]
    }

    /// Blocks between some coupled nodes, column by column.
    pub fn blocks_between(&self, nodes: &[usize]) -> Vec<BlockPosition> {
        nodes.iter().flat_map(|&column| nodes.iter().map(move |&row| self.block(row, column))).collect()
    }

    /// Creates a matrix on the current pattern.
    pub fn matrix(&self) -> SparseMatrix {
        SparseMatrix::zero(self.pattern.clone())
    }

    /// Extends the pattern to all contact points; returns whether it changed. A changed pattern includes one segment behind
    /// each projection and several ahead, in the direction of slip. Their number doubles each time the pattern is too small, so
    /// that it rarely changes as points slide.
    pub fn cover(&mut self, responses: &[PairResponse], old: &State) -> bool {
        if self.find_contacts(responses) {
            return false;
        }
        let (mut groups, ahead) = (Vec::new(), self.coupling.ahead);
        for ((pair, responses), old) in self.model.contacts.iter().zip(responses).zip(&old.contacts) {
            for (k, ((slave, state), old)) in pair.points.iter().zip(&responses.states).zip(old).enumerate() {
                let behind = pair.pores.iter().flat_map(|pores| pores[k].nodes.iter().copied());
                if let Some(small) = &pair.small {
                    let of_water = |nodes: &[usize]| -> Vec<usize> {
                        pair.seam.iter().flat_map(|seam| seam.behind(nodes.iter().copied())).collect()
                    };
                    let met = small.points[k].iter().map(|point| &point.nodes);
                    groups.extend(
                        met.map(|nodes| nodes.iter().copied().chain(of_water(nodes)).chain(behind.clone()).collect()),
                    );
                    continue;
                }
                let Some(master_point) = state.master_point.or(old.master_point) else { continue };
                let mut nodes: Vec<usize> = slave.position.iter().map(|&(node, _)| node).collect();
                nodes.extend(responses.acting(k).into_iter().flat_map(|closed| closed.nodes));
                nodes.extend(pair.master.rigid_body().into_iter().flat_map(RigidBody::nodes).chain(behind));
                if let Master::Mesh(surface) = &pair.master {
                    let way = old.master_point.and_then(|from| surface.path(from, master_point)).into_iter();
                    let slip: f64 = way.flat_map(Path::parts).map(|part| part.end - part.start).sum();
                    let [behind, ahead] = if slip < 0.0 { [ahead, 1] } else { [1, ahead] };
                    let back = std::iter::successors(Some(master_point.segment), |&segment| surface.previous(segment));
                    let forth = std::iter::successors(Some(master_point.segment), |&segment| surface.next(segment));
                    let around = back.take(1 + behind).chain(forth.take(1 + ahead));
                    nodes.extend(around.flat_map(|segment| surface.segments[segment].nodes()));
                }
                let of_water: Vec<usize> =
                    pair.seam.iter().flat_map(|seam| seam.behind(nodes.iter().copied())).collect();
                nodes.extend(of_water);
                nodes.sort_unstable();
                nodes.dedup();
                groups.push(nodes);
            }
        }
        self.coupling = Arc::new(Coupling { groups, ahead: FARTHEST.min(2 * ahead) });
        self.set();
        self.find_contacts(responses);
        true
    }

    /// Finds the blocks of all closed points, unless they are unchanged; returns whether the pattern contains them all, and says which are
    /// not symmetric.
    fn find_contacts(&mut self, responses: &[PairResponse]) -> bool {
        let closed = || responses.iter().flat_map(PairResponse::all_acting).map(|(_, closed)| closed.nodes);
        let listed = || closed().flat_map(|nodes| std::iter::once(nodes.len()).chain(nodes.iter().copied()));
        if listed().eq(self.contacts.iter().copied()) {
            return true;
        }
        self.contacts.clear();
        self.contacts.extend(listed());
        let mut blocks = std::mem::take(&mut self.contact_blocks);
        blocks.clear();
        let coupled = closed().all(|nodes| {
            let own = |node: &usize| self.original(*node);
            let pairs = nodes.iter().flat_map(|column| nodes.iter().map(move |row| (row, column)));
            let mut found = pairs.map(|(row, column)| self.pattern.block(own(row), own(column)));
            found.all(|block| block.map(|block| blocks.push(block)).is_some())
        });
        self.contact_blocks = blocks;
        let covered = coupled && self.knows_unsymmetric(responses);
        if !covered {
            self.contacts.clear();
        }
        covered
    }

    /// Whether the pattern says of all that closed points couple with each other that it is not symmetric, where theirs is not: on a
    /// rigid master these are nodes of one element, for which no new place is needed.
    fn knows_unsymmetric(&self, responses: &[PairResponse]) -> bool {
        let unsymmetric = self.pattern.unsymmetric();
        let pairs = self.model.contacts.iter().zip(responses).filter(|(pair, _)| !pair.is_symmetric());
        let mut nodes = pairs.flat_map(|(_, responses)| responses.all_acting()).flat_map(|(_, closed)| closed.nodes);
        nodes.all(|&node| unsymmetric[self.original(node)])
    }

    /// Blocks of the closed contact points last included, point after point, each column by column.
    pub fn blocks_of_contacts(&self) -> &[BlockPosition] {
        &self.contact_blocks
    }
}
