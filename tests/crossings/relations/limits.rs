//! Two problems that become the same as something becomes small.

use super::*;

/// A difference that falls at least at its order when something becomes smaller by four.
pub(super) fn falls(
    draft: &Draft,
    pair: &dyn Fn(f64) -> [Ways; 2],
    order: f64,
    skip: &dyn Fn(&str) -> bool,
) -> Outcome {
    let mut shares = Vec::new();
    let mut place = String::new();
    for factor in [1.0, 0.25, 0.0625] {
        let records = pair(factor).map(|ways| run(&model::case(draft, &ways), &ways, Lead::Through));
        if records.iter().any(|record| record.ended != Ended::Complete || record.rows.is_empty()) {
            return Outcome::Idle;
        }
        // In other increments friction has another history.
        if records[0].increments != records[1].increments {
            return Outcome::Idle;
        }
        let difference = compare(&records[0], &records[1], skip);
        shares.push(difference.share);
        place = difference.place;
    }
    let falls = shares[2] <= 1e-7
        || shares[2] <= 2.0 * shares[0] * 0.0625f64.powf(order)
        || shares[2] <= 2.0 * shares[1] * 0.25f64.powf(order);
    if falls {
        Outcome::Holds
    } else {
        Outcome::Broken(Difference {
            share: shares[2],
            place: format!("{place}; {shares:?}"),
            values: [shares[0], shares[1]],
        })
    }
}

/// Linear quantities: forces and stresses.
pub(super) fn not_of_forces(column: &str) -> bool {
    !["normal_force", "tangential_force", "fx", "fx, y"].iter().any(|part| column.ends_with(part))
        || column.starts_with("d.")
}

/// The draft with nothing that keeps another order or does not scale: what is left of it is a static contact of two bodies.
pub(super) fn simple(draft: &Draft) -> Option<Draft> {
    let without = [
        "scheme",
        "then",
        "approach",
        "flange",
        "tip",
        "stabilize",
        "tool",
        "error_control",
        "rupture",
        "until",
        "varying",
        "dilatancy",
        "wear",
        "bond",
        "fluid",
        "radiation",
        "shrink_fit",
        "massless",
        "tractions",
        "stress",
        "pores",
        "drainage",
        "heat",
        "plate",
        "spring",
        "dashpot",
        "velocity",
        "second_contact",
        "gravity",
        "damping",
        "absorbing",
        "point_mass",
        "bar",
        "further_parameters",
        "press",
        "friction",
        "master",
        "smooth",
        "normal",
    ];
    let slots: Vec<&str> =
        without.into_iter().filter(|slot| *slot != "friction" || !draft.is("friction", "frictionless")).collect();
    let plainer = draft.plainer(&slots)?;
    let elastic = ["linear", "neo_hookean", "saint_venant_kirchhoff", "hencky"];
    let remembers = ["ground_law", "block_law"].iter().any(|slot| !elastic.contains(&plainer.of(slot)));
    let apart = model::starts_separated(&plainer) || plainer.of("section").starts_with("rings");
    (!remembers && !apart).then_some(plainer)
}

/// Small sliding is finite sliding of small loads, a fluid between the surfaces being one of them.
pub(super) fn small_and_finite(base: &Base) -> Outcome {
    let with_fluid = |plainer: Draft| plainer.with("fluid", base.draft.of("fluid"));
    let Some(draft) = simple(base.draft).and_then(with_fluid) else { return Outcome::Idle };
    let plain = Ways::plain(&draft);
    let ways = |sliding, load| Ways { sliding: Some(sliding), load, ..plain.clone() };
    falls(&draft, &|load| [ways("small", load), ways("finite", load)], 1.0, &not_of_forces)
}

/// Statics is dynamics without mass.
pub(super) fn slow_dynamics(base: &Base) -> Outcome {
    let Some(draft) = simple(base.draft) else { return Outcome::Idle };
    let plain = Ways::plain(&draft);
    let ways = |scheme, density| Ways { scheme: Some(scheme), density, ..plain.clone() };
    falls(&draft, &|density| [ways("static", density), ways("generalized_alpha", density)], 1.0, &not_of_forces)
}

/// An augmented Lagrangian is a penalty without give, along the normal.
pub(super) fn stiff_and_augmented(base: &Base) -> Outcome {
    let Some(draft) = simple(base.draft) else { return Outcome::Idle };
    // The pressures of an edge's Gauss points part as the penalty rises, by modes that it holds last.
    if draft.is("method", "gauss_to_segment") {
        return Outcome::Idle;
    }
    let plain = Ways::plain(&draft);
    let ways = |normal, stiffer| Ways { normal: Some(normal), stiffer, ..plain.clone() };
    let tangential = |column: &str| not_of_forces(column) || !column.ends_with("normal_force");
    // Points at the edge of the contact come and go with the give.
    falls(&draft, &|give| [ways("alpha_n", 1.0 / give), ways("augmented", 1.0)], 0.5, &tangential)
}

/// Of two sides that are alike, either is the slave.
pub(super) fn sides_swapped(base: &Base) -> Outcome {
    let Some(draft) = simple(base.draft) else { return Outcome::Idle };
    let quadratic = |slot: &str| is_quadratic(draft.of(slot));
    // The nodes at the end of the longer side stand for more than the shorter one covers.
    if draft.is("method", "node_to_segment")
        || !draft.is("surfaces", "matching")
        || quadratic("ground_element") != quadratic("block_element")
    {
        return Outcome::Idle;
    }
    let plain = Ways::plain(&draft);
    let ways = |swapped, load| Ways { swapped, load, ..plain.clone() };
    // How much slip counts where a point closes anew hangs on the depth of the elements behind the slave.
    let record = run(&model::case(&draft, &plain), &plain, Lead::Through);
    let lengths: Vec<f64> = record.values("c.contact_length").filter(|length| *length > 0.0).collect();
    if lengths.windows(2).any(|pair| pair[1] > 1.01 * pair[0]) {
        return Outcome::Idle;
    }
    let on_slave = |column: &str| not_of_forces(column) || column.starts_with("c.tangential");
    falls(&draft, &|load| [ways(false, load), ways(true, load)], 1.0, &on_slave)
}
