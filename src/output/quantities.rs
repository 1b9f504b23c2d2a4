//! Recorded quantities, with the same name in tables, frames and the store of the interface. This module defines the meaning
//! and unit of each. Columns and arrays follow this order, readers of results identify quantities by it, and `fecontact schema
//! results` prints it.
//!
//! For columns with a dot in their name the table lists the part behind it; `CONTACT`, `SET`, `BODY`, `BAR`, `PROBE` and `SECTION` stand
//! for names of the case.

use super::units::{
    ACCELERATION, ANGLE, ENERGY, FLOW, LINE_FORCE, MOMENTUM, POWER, SPIN, STIFFNESS, VOLUME, WORK_PER_AREA,
};
pub use super::units::{DENSITY, FORCE, LABELLED, LENGTH, MASS, NONE, STRESS, TIME, Unit, VELOCITY};

/// A recorded quantity: a column of a table, or an array.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantity {
    /// name
    pub name: &'static str,
    /// unit
    pub unit: Unit,
    /// meaning
    pub meaning: &'static str,
}

const fn q(name: &'static str, unit: Unit, meaning: &'static str) -> Quantity {
    Quantity { name, unit, meaning }
}

/// Names of quantities, for headers.
pub fn names(quantities: &[Quantity]) -> impl Iterator<Item = String> {
    quantities.iter().map(|quantity| quantity.name.into())
}

/// First columns of `history.csv`.
pub const INCREMENT: [Quantity; 4] = [
    q("time", TIME, "t at the end of the increment"),
    q("dt", TIME, "its length"),
    q("step", NONE, "name of its step"),
    q("iterations", NONE, "its linear solves"),
];

/// Energies of the model.
pub const ENERGIES: [Quantity; 7] = [
    q("kinetic", ENERGY, "½ vᵀ M v"),
    q("strain", ENERGY, "strain energy of the bodies, ∫ W dV"),
    q("contact_elastic", ENERGY, "∫ (α_n g²/2 + q²/(2 α_t)) ds of the closed contact points"),
    q("friction_dissipation", ENERGY, "dissipated by friction so far, ∫∫ q v^p ds dt"),
    q("damping_dissipation", ENERGY, "dissipated by dashpots, absorbing sides and viscosity so far"),
    q("external_work", ENERGY, "work of loads, supports, drivers and changes of temperature so far"),
    q("energy_error", ENERGY, "initial energy + external work − stored − dissipated − radiated: 0 if all is resolved"),
];

/// Column of runs with radiation damping.
pub const RADIATED: Quantity = q("radiated", ENERGY, "radiated by slip so far, ∫∫ η v² ds dt");

/// Column of runs with bodies that yield.
pub const PLASTIC: Quantity =
    q("plastic_dissipation", ENERGY, "dissipated by yielding so far, ∫∫ τ:dε_p dV less what back stresses store");

/// Means and sums of a contact; means are taken over the closed length.
pub const CONTACT: [Quantity; 8] = [
    q("normal_force", FORCE, "N = ∫ p ds"),
    q("tangential_force", FORCE, "Q = ∫ q ds, with radiation damping ∫ (q + η v) ds"),
    q("contact_length", LENGTH, "closed length"),
    q("slip_fraction", NONE, "slipping fraction of the closed length; 1 without friction"),
    q("mean_slip", LENGTH, "mean of the plastic slip"),
    q(
        "max_penetration",
        LENGTH,
        "deepest point of either surface in the other: points of the contact, nodes, corners and disks",
    ),
    q("max_elastic_slip", LENGTH, "largest |q|/α_t"),
    q("mean_elastic_slip", LENGTH, "mean of q/α_t"),
];

/// How tractions of a contact alternate from point to point.
pub const SCATTER: Quantity =
    q("scatter", NONE, "rms by which p, or q, alternates from point to point, over the mean p of the points inside");

/// Mean displacement of a watched set, and its reactions.
pub const WATCHED: [Quantity; 4] = [
    q("ux", LENGTH, "mean displacement of the nodes along x"),
    q("uy", LENGTH, "along y"),
    q("fx", FORCE, "sum of the reactions along x"),
    q("fy", FORCE, "along y"),
];

/// Rotation of a rigid body, and the moment of its supports.
pub const RIGID: [Quantity; 2] = [
    q("angle", ANGLE, "rotation about the reference point, counter-clockwise [rad]"),
    q("moment", ENERGY, "reaction moment about the reference point where it is now, counter-clockwise"),
];

/// Forces of a bar, and its bond.
pub const BAR: [Quantity; 8] = [
    q("axial_start", FORCE, "N of its first segment, positive in tension"),
    q("axial_end", FORCE, "N of its last segment"),
    q("axial_min", FORCE, "smallest N along it"),
    q("axial_max", FORCE, "largest N along it"),
    q("moment_max", ENERGY, "largest |M| along it"),
    q("shear_max", FORCE, "largest |Q| along it"),
    q("bond_slip_max", LENGTH, "largest slip of its bond"),
    q("slipping", NONE, "fraction of its bonded length that slipped irreversibly in the increment"),
];

/// Quantities of bars in frames: at their points, then of their segments.
pub const BAR_FRAMES: [Quantity; 8] = [
    q("moment", ENERGY, "M, positive where the bar bends to its left"),
    q("slip", LENGTH, "motion of the bar along itself relative to the body that it lies in"),
    q("bond_shear", LINE_FORCE, "shear of the bond per length of the bar, on the body"),
    q("bond_normal", LINE_FORCE, "force across the bar per length, on the body, positive to its left"),
    q("axial_force", FORCE, "N of a segment, positive in tension"),
    q("shear_force", FORCE, "Q of a segment, −dM/ds"),
    q("yielding", NONE, "1 where N is at the limit, 0 elsewhere"),
    q("bar", NONE, "number of the bar of a segment"),
];

/// Resultant of a contact on its slave.
pub const RESULTANT: [Quantity; 3] = [
    q("force_x", FORCE, "forces of pressure, friction and radiation damping on the slave, without a fluid"),
    q("force_y", FORCE, "along y"),
    q("moment", ENERGY, "its moment about the middle of the undeformed slave (the mean of its points by length)"),
];

/// Momentum, centre of mass and rotation of a body.
pub const BODY: [Quantity; 6] = [
    q("momentum_x", MOMENTUM, "∫ ρ v_x dV"),
    q("momentum_y", MOMENTUM, "∫ ρ v_y dV"),
    q("angular_momentum", SPIN, "about the centre of mass"),
    q("centre_x", LENGTH, "centre of mass"),
    q("centre_y", LENGTH, "along y"),
    q("rotation", ANGLE, "mean rotation: that of the nearest rigid motion, full turns counted [rad]"),
];

/// Length-weighted means of a watched edge set.
pub const EDGES: [Quantity; 2] = [
    q("edge_ux", LENGTH, "length-weighted mean displacement of a set of edges along x, ∫ u_x ds/∫ ds"),
    q("edge_uy", LENGTH, "along y"),
];

/// Water of a body in which it flows.
pub const WATER: [Quantity; 3] = [
    q("excess_pore_pressure", STRESS, "mean p_w less that at the start, of a body whose water flows"),
    q("consolidation", NONE, "1 less this over its largest value so far, of either sign; 0 before there is any"),
    q("water", VOLUME, "volume of water that the body has taken up since the start"),
];

/// Flow through a place of `drainage`.
pub const OUTLET: [Quantity; 2] = [
    q("discharge", FLOW, "flow of water out of the bodies through the place at the end of the increment"),
    q("outflow", VOLUME, "volume that has left through it since the start"),
];

/// Seepage in frames.
pub const WATER_FLUX: Quantity =
    q("water_flux", VELOCITY, "seepage of water that flows, the mean of the elements around a node");

/// Balance of all water that flows.
pub const WATER_ERROR: Quantity = q(
    "water_error",
    VOLUME,
    "water that all bodies have taken up and that has left through all places: 0 but for round-off",
);

/// Column of contacts with a fluid pressure.
pub const FLUID_FORCE: Quantity = q("fluid_force", FORCE, "∫ p_w ds, of contacts in a fluid");

/// Columns of contacts along which water flows.
pub const CONDUIT: [Quantity; 6] = [
    q("injected", VOLUME, "water that wells and sources have let in so far, of contacts along which it flows"),
    q("leaked", VOLUME, "water that has leaked through their walls"),
    q("mass_error", VOLUME, "what the water in them has changed by, less what has come in: 0 but for round-off"),
    q("largest_fluid_pressure", STRESS, "largest p_w"),
    q("largest_flow", FLOW, "largest flow along it, in either direction"),
    q("largest_aperture", LENGTH, "largest opening and dilatancy that hold water, with the hydraulic aperture"),
];

/// Heat of a contact.
pub const HEAT: [Quantity; 2] = [
    q("frictional_heat", ENERGY, "∫∫ q v^p ds dt so far, less work of dilatancy, plus that of wear"),
    q("frictional_power", POWER, "its mean rate over the last increment"),
];

/// Columns of every probe.
pub const PROBE: [Quantity; 11] = [
    q("ux", LENGTH, "displacement along x"),
    q("uy", LENGTH, "along y"),
    q("vx", VELOCITY, "velocity along x"),
    q("vy", VELOCITY, "along y"),
    q("strain_xx", NONE, "Green–Lagrange strain; of `linear` materials sym grad u"),
    q("strain_yy", NONE, "the same, yy"),
    q("strain_xy", NONE, "the same, xy"),
    q("stress_xx", STRESS, "Cauchy stress"),
    q("stress_yy", STRESS, "the same, yy"),
    q("stress_zz", STRESS, "the same, zz"),
    q("stress_xy", STRESS, "the same, xy"),
];

/// Column of every probe in axisymmetric bodies, after its other columns.
pub const HOOP: Quantity = q("strain_zz", NONE, "hoop strain, of axisymmetric bodies");

/// Columns of every station of the sections of a body.
pub const SECTION: [Quantity; 5] = [
    q("x", LENGTH, "x of the station, undeformed"),
    q("y", LENGTH, "y of the station, undeformed"),
    q(
        "axial_force",
        FORCE,
        "N, positive in tension, along the axis by then; per unit of thickness in plane strain, of a full turn in axisymmetry",
    ),
    q("shear_force", FORCE, "Q = dM/ds along the axis"),
    q(
        "moment",
        ENERGY,
        "bending moment M about the station, positive where the right of the way along the axis is pulled",
    ),
];

/// Positions of the points of a contact in the undeformed configuration.
pub const PLACE: [Quantity; 4] = [
    q("position", LENGTH, "arc length along the undeformed slave, from the start of its connected line"),
    q("x", LENGTH, "x of the points, undeformed"),
    q("y", LENGTH, "y of the points, undeformed"),
    q("line", NONE, "number of the connected line of the slave"),
];

const GAP: Quantity = q("gap", LENGTH, "g: gap of the surfaces, positive when open");
const PRESSURE: Quantity =
    q("pressure", STRESS, "p: contact pressure, positive in compression; negative where a bond pulls");
const TRACTION: Quantity = q("traction", STRESS, "q: traction of friction and a bond, resisting positive slip");
const SLIP: Quantity = q("slip", LENGTH, "plastic slip so far, positive along the tangent of the master");
const ELASTIC_SLIP: Quantity = q("elastic_slip", LENGTH, "q/α_t");
const TOTAL_SLIP: Quantity = q("total_slip", LENGTH, "plastic and elastic slip, slip + q/α_t");
const SLIP_RATE: Quantity =
    q("slip_rate", VELOCITY, "plastic slip since the increment or row before over the time since");
const RATIO: Quantity =
    q("R", NONE, "|q|/(μ p): traction of friction over its peak; of a bond without friction |q|/s; else 0");
const MU: Quantity = q("mu", NONE, "μ: peak friction coefficient available now; 0 without friction");
const STRUCTURE: Quantity = q("structure", NONE, "1/R*: degree of structure; 1 where a law has none");
const STATE: Quantity =
    q("state", NONE, "0 open, 1 sticking, 2 slipping, as the law says (or closed without friction)");
const DISSIPATION: Quantity = q("dissipation", WORK_PER_AREA, "work of friction so far, per area");

/// Quantities at the points of every contact in frames; rates are means since the previous increment.
pub const IN_FRAMES: [Quantity; 11] =
    [GAP, PRESSURE, TRACTION, SLIP, ELASTIC_SLIP, SLIP_RATE, RATIO, MU, STRUCTURE, STATE, DISSIPATION];

/// Quantities at the points of every contact in the store; rates are means since the previous row.
pub const IN_STORE: [Quantity; 9] = [SLIP, TOTAL_SLIP, SLIP_RATE, PRESSURE, TRACTION, GAP, RATIO, MU, STRUCTURE];

/// Quantities at the points of some contacts, in both; names of other internal variables and observables come from their law.
pub const OF_SOME: [Quantity; 8] = [
    q("theta", TIME, "θ: state of rate-and-state friction"),
    q("theta_2", TIME, "θ₂: its second state, where the law has one"),
    q("dilation", LENGTH, "opening by dilatancy"),
    q("wear", LENGTH, "depth of wear"),
    q("fluid_pressure", STRESS, "p_w: pressure of the fluid, in addition to the contact pressure"),
    q(
        "bond",
        NONE,
        "1 − κ: what is left of a bond's strength above its residual, and of its tension; 1 before any damage",
    ),
    q("water_flow", FLOW, "water that flows along the slave, in the order of its points"),
    q("aperture", LENGTH, "opening and dilatancy that hold water, with the hydraulic aperture of the cubic law"),
];

/// Names of quantities of the store in earlier versions, with their present names.
pub const FORMER: [(&str, &str); 3] = [("p", "pressure"), ("q", "traction"), ("p_w", "fluid_pressure")];

/// Returns a quantity of the store; `None` for one defined by a law.
pub fn in_store(name: &str) -> Option<Quantity> {
    IN_STORE.into_iter().chain(OF_SOME).find(|quantity| quantity.name == name)
}

/// Columns of `fronts.csv`: one row per passage of a front at a contact point.
pub const FRONTS: [Quantity; 14] = [
    q("contact", NONE, "the contact"),
    q("point", NONE, "number of the point, from 0, as in `interface.zarr`"),
    q("position", LENGTH, "arc length along the undeformed slave, from the start of its connected line"),
    q("x", LENGTH, "x of the point, undeformed"),
    q("y", LENGTH, "y of the point, undeformed"),
    q("passage", NONE, "number of this arrival at this point, from 1, over all events of the run"),
    q("arrival", TIME, "time of arrival of the front"),
    q("speed", VELOCITY, "distance of the two neighbours over the difference of their arrivals (below)"),
    q("speed_over_c_R", NONE, "speed over that of Rayleigh waves in the body behind the slave; 0 without a density"),
    q("speed_over_c_s", NONE, "speed over that of shear waves"),
    q("speed_over_c_p", NONE, "speed over that of pressure waves"),
    q("event", NONE, "number of the event in `events.csv`; 0 outside of events, as may be with `arrival`"),
    q("rupture_length", LENGTH, "tributary length of the points ruptured up to this arrival, each counted once"),
    q("energy_released", ENERGY, "energy released since the first arrival: Δ(external work − stored energies)"),
];

/// Columns of `events.csv`: one row per event of a contact.
pub const EVENTS: [Quantity; 20] = [
    q("contact", NONE, "the contact"),
    q("event", NONE, "number in its contact, from 1"),
    q("onset", TIME, "time of the first arrival"),
    q("position", LENGTH, "place of the first arrival along the slave"),
    q("x", LENGTH, "its x, undeformed"),
    q("y", LENGTH, "its y, undeformed"),
    q("duration", TIME, "from the onset to the row in which no point slips faster any more"),
    q("over", NONE, "1; 0 where the run has ended before the event"),
    q("length", LENGTH, "summed tributary length of its points"),
    q("mean_slip", LENGTH, "mean plastic slip, with its sign"),
    q("largest_slip", LENGTH, "largest plastic slip"),
    q("peak_slip_rate", VELOCITY, "largest mean slip rate of a point between two rows"),
    q("stress_drop", STRESS, "mean stress drop, q before − q after, positive where slip has unloaded"),
    q("fracture_energy", WORK_PER_AREA, "mean of ∫ (q − q_min) dδ over the slip δ up to where q is least"),
    q("energy_released", ENERGY, "energy released by the whole model from the row before the event to its end"),
    q("energy_radiated", ENERGY, "released energy less the dissipation by friction"),
    q("front_speed", VELOCITY, "slope of distance over arrivals by least squares, both directions together"),
    q("front_speed_over_c_R", NONE, "over the Rayleigh wave speed of the body behind the slave"),
    q(
        "seismic_onset",
        TIME,
        "the row before a point first slips faster than `seismic_rate`; NaN where none does, or none is given",
    ),
    q(
        "seismic_share",
        NONE,
        "fraction of slip times length that is faster than `seismic_rate`: 0 in an aseismic event; NaN without one",
    ),
];

/// Columns of `law.csv` common to all laws.
pub const LAW: [Quantity; 12] = [
    q("time", TIME, "t"),
    q("slip", LENGTH, "slip along the path, elastic and plastic"),
    q("pressure", STRESS, "p"),
    q("traction", STRESS, "q"),
    q("R", NONE, "|q|/(μ p)"),
    q("mu", NONE, "μ"),
    q("structure", NONE, "1/R*"),
    q("plastic_slip", LENGTH, "plastic slip so far"),
    q("dissipation", WORK_PER_AREA, "work of friction so far, per area"),
    q("dtraction_dslip", STIFFNESS, "∂q/∂Δu_t, consistent with the step"),
    q("dtraction_dpressure", NONE, "∂q/∂p, consistent with the step"),
    q("evaluations", NONE, "how often the law was evaluated within the step"),
];

/// Column of `law.csv` for an interface that opens, behind those of its dilation and wear.
pub const OPENED: Quantity =
    q("gap", LENGTH, "opening of the interface since the start: dilation − wear − (p − p₀)/α_n");

/// Columns of `law.csv` for a bond in parallel with friction, at the end; pressure, traction and dissipation include it.
pub const BONDED: [Quantity; 2] = [
    q("opening", LENGTH, "w: opening of the path"),
    q(
        "bond",
        NONE,
        "1 − κ: what is left of a bond's strength above its residual, and of its tension; 1 before any damage",
    ),
];

/// Columns of `law.csv` for the machine of a slider, behind those of its law; `slip` is that of the mass.
pub const MACHINE: [Quantity; 3] = [
    q("load_point", LENGTH, "w: way of the load point, as on the path"),
    q("force", STRESS, "F: force of the spring, per area"),
    q("slip_rate", VELOCITY, "u̇ of the mass"),
];

/// Columns of `newton.csv`; those of the convergence aids stand before `verdict` and `reason`.
pub const NEWTON: [Quantity; 15] = [
    q("step", NONE, "name of the step"),
    q("increment", NONE, "number of the increment, from 1"),
    q("attempt", NONE, "number of the attempt at it, from 1"),
    q("iteration", NONE, "number of the linear solve; 0 in the row of an attempt rejected before its first"),
    q("time", TIME, "t at the end of the increment"),
    q("residual", NONE, "out-of-balance forces, relative"),
    q(
        "correction",
        LENGTH,
        "largest change of a displacement; of a rigid body's rotation times the distance of its farthest point",
    ),
    q("open", NONE, "open contact points"),
    q("stick", NONE, "sticking ones"),
    q("slip", NONE, "slipping ones"),
    q("linear_residual", NONE, "relative residual of the linear solve"),
    q("factorized", NONE, "1 where the matrix was factorized anew"),
    q("stabilization", NONE, "fraction of the stabilizing forces"),
    q(
        "flips",
        NONE,
        "points that went back to the status (open, stick, slip) of two iterates before, from another between",
    ),
    q("pass", NONE, "number of the augmentation (augmented Lagrangian)"),
];

/// Last columns of `newton.csv`.
pub const VERDICT: [Quantity; 3] = [
    q("verdict", NONE, "outcome of the attempt (below)"),
    q("reason", NONE, "why it was rejected; empty where accepted, commas as semicolons"),
    q("negative_pivots", NONE, "negative eigenvalues of the matrix, where all of it is symmetric; else empty"),
];

/// Arrays of the frames of bodies.
const SOLID: [Quantity; 16] = [
    q("displacement", LENGTH, "u of the nodes"),
    q("velocity", VELOCITY, "v"),
    q("acceleration", ACCELERATION, "a"),
    q("reaction", FORCE, "forces of the supports on the nodes"),
    q("contact_force", FORCE, "forces of the contacts on the nodes"),
    q(
        "stress",
        STRESS,
        "Cauchy stress xx, yy, zz, xy (and yz, xz, which are zero), recovered from the elements around a node (below)",
    ),
    q("von_mises", STRESS, "von Mises stress, q = √(3/2) ‖dev σ‖"),
    q("mean_pressure", STRESS, "mean pressure of a body, −tr σ/3, positive in compression"),
    q("body", NONE, "number of the body of an element"),
    q("material", NONE, "number of its material"),
    q("log_strain", NONE, "logarithmic strain ln V: xx, yy, zz, xy; of `linear` materials sym grad u"),
    q(
        "principal_stress",
        STRESS,
        "principal Cauchy stresses, the largest first; with `derived`, on the page and in Python",
    ),
    q("principal_strain", NONE, "principal logarithmic strains, the largest first; as above"),
    q("stretch_zz", NONE, "stretch across the plane, exp(ln V_zz): thickness of a plate, hoops of rings; as above"),
    q(
        "vtkGhostType",
        NONE,
        "32 for elements of bodies that are absent, which are not drawn; in runs whose bodies come and go",
    ),
    q(
        "d(displacement)/d(…)",
        NONE,
        "derivative of the displacement by a value of the case, in units of both; with `displacement_gradients`",
    ),
];

/// Quantities of bodies that yield, or whose pores hold a fluid, in frames.
pub const OF_YIELDING: [Quantity; 10] = [
    q(
        "equivalent_plastic_strain",
        NONE,
        "ε̄_p = ∫ √(2/3 dε_p:dε_p) of the deviator, of bodies that yield; NaN elsewhere",
    ),
    q("plastic_volume_strain", NONE, "∫ tr dε_p, positive where a body dilates"),
    q("yield_indicator", STRESS, "f: 0 where it yields, less where it does not"),
    q(
        "effective_pressure",
        STRESS,
        "p = −tr τ/3 of the Kirchhoff stress of cam_clay and sys_cam_clay, without a pore fluid; NaN elsewhere",
    ),
    q("deviator_stress", STRESS, "q = √(3/2) ‖dev τ‖ of these"),
    q("p_c", STRESS, "pressure of isotropic compression at which they yield, sys_cam_clay once remoulded"),
    q(
        "R",
        NONE,
        "R of sys_cam_clay: size of the subloading surface over that of the superloading surface, 1/R is the overconsolidation",
    ),
    q("R_star", NONE, "R* of sys_cam_clay: p_c over that of the superloading surface, 1/R* is the structure"),
    q("zeta", NONE, "ζ = √(3/2) ‖β‖ of sys_cam_clay: rotation of its yield surface"),
    q("pore_pressure", STRESS, "p_w of bodies with a pore_fluid or a pore_pressure"),
];

/// Arrays of the frames of integration points; internal variables of materials follow, by their names.
const INTEGRATION_POINTS: [Quantity; 10] = [
    SOLID[0],
    q("stress", STRESS, "Cauchy stress xx, yy, zz, xy"),
    SOLID[6],
    SOLID[7],
    q("body", NONE, "number of the body"),
    SOLID[10],
    SOLID[11],
    SOLID[12],
    SOLID[13],
    SOLID[14],
];

/// Quantities and their owner, the part of the name before the dot.
pub type Group = (&'static str, &'static [Quantity]);

/// All quantities by their files, in the order of their columns.
pub const ALL: [(&str, &[Group]); 14] = [
    (
        "history.csv",
        &[
            ("", &INCREMENT),
            ("", &ENERGIES),
            ("CONTACT", &CONTACT),
            ("SET", &WATCHED),
            ("", &[RADIATED]),
            ("CONTACT", &[q("mean_…", NONE, "means of internal variables, `dilation` and `wear`, by their names")]),
            ("CONTACT", &RESULTANT),
            ("BODY", &BODY),
            ("SET", &EDGES),
            ("CONTACT", &[FLUID_FORCE]),
            ("CONTACT", &HEAT),
            ("CONTACT", &[SCATTER]),
            ("RIGID", &RIGID),
            ("", &[PLASTIC]),
            ("BAR", &BAR),
            ("CONTACT", &CONDUIT),
            ("BODY", &WATER),
            ("OUTLET", &OUTLET),
            ("", &[WATER_ERROR]),
        ],
    ),
    ("interface.zarr", &[("", &[INCREMENT[0]]), ("CONTACT", &PLACE), ("CONTACT", &IN_STORE), ("CONTACT", &OF_SOME)]),
    ("solid.pvd", &[("", &SOLID), ("", &OF_YIELDING), ("", &[WATER_FLUX])]),
    (
        "contact.pvd",
        &[
            ("", &[SOLID[0]]),
            ("", &IN_FRAMES),
            ("", &OF_SOME),
            ("", &[q("contact", NONE, "number of the contact of a line")]),
        ],
    ),
    ("bars.pvd", &[("", &[SOLID[0]]), ("", &BAR_FRAMES)]),
    ("points.pvd", &[("", &INTEGRATION_POINTS), ("", &OF_YIELDING)]),
    ("probes.csv", &[("", &[INCREMENT[0]]), ("PROBE", &PROBE), ("PROBE", &[HOOP])]),
    ("sections.csv", &[("", &[INCREMENT[0]]), ("SECTION", &SECTION)]),
    (
        "gradients.zarr",
        &[
            ("", &[INCREMENT[0]]),
            ("CONTACT", &PLACE),
            ("CONTACT", &[q("slip, pressure, traction", NONE, "their derivatives, by place of the case and point")]),
            (
                "",
                &[q(
                    "displacement",
                    NONE,
                    "derivatives of displacements, by place of the case, node and component; on request",
                )],
            ),
        ],
    ),
    (
        "gradients.csv",
        &[
            ("", &[INCREMENT[0], INCREMENT[2]]),
            (
                "",
                &[q(
                    "d(…)/d(…)",
                    NONE,
                    "derivative of a quantity of history.csv by a value of the case, in units of both",
                )],
            ),
        ],
    ),
    ("fronts.csv", &[("", &FRONTS)]),
    ("events.csv", &[("", &EVENTS)]),
    (
        "newton.csv",
        &[("", &NEWTON), ("", &[q("aid_…", NONE, "points on which each convergence aid acted")]), ("", &VERDICT)],
    ),
    (
        "law.csv",
        &[
            ("", &LAW),
            ("", &[OF_SOME[0], OF_SOME[1], OF_SOME[2], OPENED, BONDED[0], BONDED[1]]),
            ("", &MACHINE),
            ("", &[q("dtraction_d…", NONE, "derivative of the traction by a parameter, in units of both")]),
            ("", &[q("dforce_d…", NONE, "derivative of a slider's force by a parameter")]),
        ],
    ),
];
