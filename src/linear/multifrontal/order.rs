//! Fill-reducing order of the nodes.

use super::super::{LinearFailure, Pattern};

/// Approximate minimum degree on the node graph: which node to eliminate as the k-th.
///
/// Source: Amestoy, Davis & Duff (1996), doi:10.1137/S0895479894278952.
#[cfg(not(feature = "metis"))]
pub fn order(pattern: &Pattern) -> Result<Vec<usize>, LinearFailure> {
    use faer::dyn_stack::{MemBuffer, MemStack};
    use faer::sparse::SymbolicSparseColMatRef;
    use faer::sparse::linalg::amd;

    let (starts, rows) = pattern.columns();
    let n = pattern.nodes();
    let graph = SymbolicSparseColMatRef::new_checked(n, n, starts, None, rows);
    let (mut order, mut inverse) = (vec![0; n], vec![0; n]);
    let mut buffer = MemBuffer::new(amd::order_scratch::<usize>(n, rows.len()));
    amd::order(&mut order, &mut inverse, graph, amd::Control::default(), MemStack::new(&mut buffer))
        .map_err(|cause| LinearFailure::Singular(format!("no order of elimination: {cause:?}")))?;
    Ok(order)
}

/// Multilevel nested dissection of the node graph: which node to eliminate as the k-th.
///
/// Source: Karypis & Kumar (1998), doi:10.1137/S1064827595287997.
#[cfg(feature = "metis")]
pub fn order(pattern: &Pattern) -> Result<Vec<usize>, LinearFailure> {
    use std::fmt::Debug;

    use feral_metis::{CscPattern, metis_order};

    let (starts, rows) = pattern.columns();
    let narrow = |list: &[usize]| list.iter().map(|&k| i32::try_from(k)).collect::<Result<Vec<_>, _>>();
    let none = |cause: &dyn Debug| LinearFailure::Singular(format!("no order of elimination: {cause:?}"));
    let starts = narrow(starts).map_err(|cause| none(&cause))?;
    let rows = narrow(rows).map_err(|cause| none(&cause))?;
    let graph = CscPattern::new(pattern.nodes(), &starts, &rows).ok_or_else(|| none(&"malformed graph"))?;
    let order = metis_order(&graph).map_err(|cause| none(&cause))?;
    Ok(order.into_iter().map(|node| node as usize).collect())
}
