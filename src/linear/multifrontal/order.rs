//! Fill-reducing order of the nodes.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use super::super::{LinearFailure, Pattern};

/// Approximate minimum degree on the node graph: which node to eliminate as the k-th.
///
/// Source: Amestoy, Davis & Duff (1996), doi:10.1137/S0895479894278952.
pub fn order(pattern: &Pattern) -> Result<Vec<usize>, LinearFailure> {
    let (starts, rows) = pattern.columns();
    let n = pattern.nodes();
    let graph = SymbolicSparseColMatRef::new_checked(n, n, starts, None, rows);
    let (mut order, mut inverse) = (vec![0; n], vec![0; n]);
    let mut buffer = MemBuffer::new(amd::order_scratch::<usize>(n, rows.len()));
    amd::order(&mut order, &mut inverse, graph, amd::Control::default(), MemStack::new(&mut buffer))
        .map_err(|cause| LinearFailure::Singular(format!("no order of elimination: {cause:?}")))?;
    Ok(order)
}
