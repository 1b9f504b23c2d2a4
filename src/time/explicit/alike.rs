//! Elements that are equal, and have the same bounds of the stable increment.

use std::collections::HashMap;

use crate::model::Model;

/// The first of the elements of a linear body that have the same shape and masses as each one in every bit, and so the same
/// bounds at any displacement; itself if its law is not linear.
pub(super) fn alike(model: &Model) -> Vec<usize> {
    let mut seen = HashMap::new();
    let first = |e: usize| {
        let (body, solid) = (model.body_of_element[e], &model.solids[e]);
        if !model.bodies[body].material.is_linear() || solid.is_f_bar() {
            return e;
        }
        let mass = model.element_lumped_mass(e);
        let (first, like) = seen.entry((body, solid.volume().to_bits())).or_insert_with(|| (e, mass.clone()));
        if *solid == model.solids[*first] && mass == *like { *first } else { e }
    };
    (0..model.solids.len()).map(first).collect()
}
