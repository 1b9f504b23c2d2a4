//! Report of `check`: the case as interpreted.

mod contact;
mod steps;

use std::fmt::Write;

use contact::{contacts, parameters, pressed_too_hard};
use nalgebra::Vector2;
use steps::{steps, watched};

use super::file::{Case, MeshSource};
use crate::bars::Bar;
use crate::laws::bulk::MaterialParameters;
use crate::mesh::{ElementKind, Group};
use crate::model::builder::{BodyInput, BulkLaw, Formulation, LoadingPlateInput, Plate, RigidBodyInput};
use crate::model::text::{count, number, vector};
use crate::model::{InitialStress, Model, PointMass, PoreFluid, PorePressure, Thermal};
use crate::output::fields::Selection;
use crate::output::fronts::ArrivalInput;

/// Returns a readable report of a checked case.
pub fn report(case: &Case, model: &Model) -> String {
    let mut warnings = super::warnings(case, model);
    warnings.extend(model.contacts.iter().filter_map(pressed_too_hard));
    let mut text = String::new();
    if !model.title.is_empty() {
        text += &format!("{}\n\n", model.title);
    }
    understood(case, model).into_iter().for_each(|(heading, lines)| section(&mut text, &heading, lines));
    section(&mut text, "warnings", if warnings.is_empty() { vec!["none".into()] } else { warnings });
    text
}

/// Returns the report as headings with their lines, without the warnings.
pub fn understood(case: &Case, model: &Model) -> Vec<(String, Vec<String>)> {
    let sections = [
        ("units", case.units.iter().map(|(of, unit)| format!("{of} in {unit}")).collect()),
        ("section", vec![model.mesh.section.to_string()]),
        ("mesh", mesh(case, model)),
        ("groups", groups(model)),
        ("bodies", bodies(case, model)),
        ("periodic", periodic(case, model)),
        ("plates", plates(case, model)),
        ("points", point_masses(case, model)),
        ("rigid", rigid_bodies(case)),
        ("bars", bars(model)),
        ("contacts", contacts(case, model)),
        ("steps", steps(case, model)),
        ("newton", vec![newton(case)]),
        ("output", output(case, model)),
    ];
    sections.into_iter().filter(|(_, lines)| !lines.is_empty()).map(|(name, lines)| (name.into(), lines)).collect()
}

/// Appends lines behind a heading in the margin; nothing if there are none.
fn section(text: &mut String, heading: &str, lines: Vec<String>) {
    for (k, line) in lines.iter().enumerate() {
        let heading = if k == 0 { heading } else { "" };
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{heading:<10}{line}");
    }
}

/// Rows with their cells padded to the width of the widest in their column.
fn aligned(rows: &[[String; 2]]) -> Vec<String> {
    let width = rows.iter().map(|[name, _]| name.chars().count()).max().unwrap_or(0);
    rows.iter().map(|[name, rest]| format!("{name:<width$}  {rest}")).collect()
}

fn mesh(case: &Case, model: &Model) -> Vec<String> {
    let source = match &case.mesh {
        MeshSource::File(file) => file.clone(),
        MeshSource::Files(files) => files.join(", "),
        MeshSource::Inline(_) => "given in the case file".into(),
        MeshSource::Blocks(blocks) => count(blocks.blocks.len(), "block"),
    };
    let mut kinds: Vec<(ElementKind, usize)> = Vec::new();
    for element in &model.mesh.elements {
        match kinds.iter_mut().find(|(kind, _)| *kind == element.kind) {
            Some((_, count)) => *count += 1,
            None => kinds.push((element.kind, 1)),
        }
    }
    let kinds: Vec<String> = kinds.iter().map(|(kind, count)| format!("{count} {kind:?}")).collect();
    let [low, high] = model.mesh.bounding_box();
    let [x0, x1, y0, y1] = [low.x, high.x, low.y, high.y].map(number);
    vec![
        source,
        format!(
            "{}, {}{}, {}",
            count(model.mesh.nodes.len() - model.mesh.water_nodes, "node"),
            count(model.mesh.elements.len(), "element"),
            if kinds.is_empty() { String::new() } else { format!(" ({})", kinds.join(", ")) },
            count(model.unknowns(), "dof")
        ),
        format!("x from {x0} to {x1}, y from {y0} to {y1}"),
    ]
}

/// Lists every group with its extent, which reveals a side given in place of another.
fn groups(model: &Model) -> Vec<String> {
    let row = |(name, group): (&String, &Group)| {
        let size = match group {
            Group::Elements(elements) => count(elements.len(), "element"),
            Group::Edges(edges) => count(edges.len(), "edge"),
            Group::Nodes(nodes) => count(nodes.len(), "point"),
            Group::Lines(lines) => count(lines.len(), "line") + " of an outline",
        };
        let places: Vec<Vector2<f64>> = match group {
            Group::Lines(lines) => lines.iter().flatten().map(|(_, at)| *at).collect(),
            _ => model.mesh.nodes_of(group).into_iter().map(|node| model.mesh.nodes[node]).collect(),
        };
        [name.clone(), format!("{size}, {}", extent(&places))]
    };
    aligned(&model.mesh.groups.iter().map(row).collect::<Vec<_>>())
}

/// Extent of some places, such as "x from 0 to 2, y = 1".
fn extent(places: &[Vector2<f64>]) -> String {
    let along = |name: &str, component: usize| {
        let values = places.iter().map(|at| at[component]);
        let [low, high] = [values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max)];
        if low < high {
            format!("{name} from {} to {}", number(low), number(high))
        } else {
            format!("{name} = {}", number(low))
        }
    };
    format!("{}, {}", along("x", 0), along("y", 1))
}

fn damping([mass, retardation]: [f64; 2]) -> String {
    match mass > 0.0 || retardation > 0.0 {
        true => format!(", damping: mass {}, stiffness {}", number(mass), number(retardation)),
        false => String::new(),
    }
}

fn bodies(case: &Case, model: &Model) -> Vec<String> {
    let row = |(name, input): (&String, &BodyInput)| {
        let element = match input.element {
            Formulation::Displacement => "",
            Formulation::FBar => ", f_bar elements",
            Formulation::Reduced => ", reduced integration",
        };
        let damping = damping([input.damping.mass, input.damping.retardation]);
        let imposed = imposed(input);
        let slopes = slopes(&input.material);
        let flows = flows(name, model);
        [
            name.clone(),
            format!("{}{slopes}{element}{damping}{imposed}{flows}", parameters(&input.material, "model", &[])),
        ]
    };
    let mut lines = aligned(&case.bodies.iter().map(row).collect::<Vec<_>>());
    let velocities = case.initial_velocity.iter();
    lines.extend(velocities.map(|(name, velocity)| format!("{name}: initial velocity {}", vector(*velocity))));
    lines
}

/// 2π f ρ k/γ_w of the fastest motions that water follows without inertia of its own, with the density ρ of the mixture for that of water [-]
const SLOW: f64 = 0.01;

/// How fast the water of a body flows.
fn flows(name: &str, model: &Model) -> String {
    let mut wet = model.flow.iter().flat_map(|flow| &flow.elements);
    let Some(wet) = wet.find(|wet| model.body_of(wet.element).name == name) else { return String::new() };
    let (law, c) = (model.body_of(wet.element).material.description(), wet.diffusivity);
    let mut text = format!(", consolidates by c = k M/unit_weight = {}", number(c));
    if model.steps.iter().any(|step| step.scheme.is_dynamic()) {
        let frequency = SLOW * law.p_wave_modulus / (std::f64::consts::TAU * law.density * c);
        text += &format!(", u-p holds up to a frequency of {}", number(frequency));
    }
    text
}

/// Slopes of cam_clay and sys_cam_clay as the law takes them.
fn slopes(material: &BulkLaw) -> String {
    let slopes = match material {
        BulkLaw::Parameters(MaterialParameters::CamClay(given)) => given.slopes(),
        BulkLaw::Parameters(MaterialParameters::SysCamClay(given)) => given.clay().slopes(),
        _ => return String::new(),
    };
    let [lambda, kappa] = slopes.map(number);
    format!(", slopes of ln J over ln p of the Kirchhoff stress {lambda}, {kappa}")
}

/// Initial stress, pore fluid or pressure, and thermal expansion.
fn imposed(input: &BodyInput) -> String {
    let stress = match &input.initial_stress {
        Some(InitialStress::Geostatic { surface, weight, k0, surcharge, below }) => {
            let layer = |top: f64, weight: f64, k0: f64| {
                format!("weight {} below y = {}, K0 {}", number(weight), number(top), number(k0))
            };
            let on_top = if *surcharge > 0.0 { format!("surcharge {}, ", number(*surcharge)) } else { String::new() };
            let further: String =
                below.iter().map(|next| format!("; {}", layer(next.top, next.weight, next.k0))).collect();
            format!(", geostatic stress: {on_top}{}{further}", layer(*surface, *weight, *k0))
        }
        Some(InitialStress::Components { .. }) => ", initial stress by components".into(),
        None => String::new(),
    };
    let thermal = input.thermal.map_or_else(String::new, |Thermal { expansion, reference }| {
        format!(", thermal expansion {}, reference temperature {}", number(expansion), number(reference))
    });
    let fluid = input.pore_fluid.as_ref().map_or_else(String::new, |fluid| {
        let PoreFluid { bulk_modulus, porosity, cavitation, .. } = fluid;
        let least = cavitation.map_or_else(String::new, |least| format!(", cavitation at {}", number(least)));
        if let (Some(along_x), Some(weight)) = (fluid.permeability, fluid.unit_weight) {
            let along_y = fluid.permeability_y.map_or_else(String::new, |along_y| format!(" along x, {} along y", number(along_y)));
            return format!(
                ", water flows: permeability {}{along_y}, unit weight {}{}, bulk modulus {}, porosity {}, Biot's coefficient {}",
                number(along_x),
                number(weight),
                if fluid.weighs { " that drives it" } else { "" },
                number(*bulk_modulus),
                number(*porosity),
                number(fluid.coefficient())
            );
        }
        format!(
            ", undrained: bulk modulus {}, porosity {}, K_w/n {}{least}",
            number(*bulk_modulus),
            number(*porosity),
            number(fluid.modulus())
        )
    });
    let given = input.pore_pressure.as_ref().map_or_else(String::new, |PorePressure { biot, .. }| {
        format!(", pore pressure given, Biot's coefficient {}", number(*biot))
    });
    stress + &fluid + &given + &thermal
}

fn periodic(case: &Case, model: &Model) -> Vec<String> {
    let mut lines: Vec<String> = case.periodic.iter().map(|[a, b]| format!("{a} and {b}")).collect();
    if !lines.is_empty() {
        lines.push(format!("{} tied", count(model.ties.pairs().len(), "node")));
    }
    lines
}

fn plates(case: &Case, model: &Model) -> Vec<String> {
    let line = |(name, moves): (&str, Plate)| {
        let nodes = model.mesh.group(name).map_or(0, |group| model.mesh.nodes_of(group).len());
        let moves = match moves {
            Plate::AsOne => "that translate together",
            Plate::UxAlike => "with equal ux",
            Plate::UyAlike => "with equal uy",
            Plate::Rigid => "of a rigid platen that can rotate",
        };
        format!("{name}: {} {moves}", count(nodes, "node"))
    };
    case.plates.iter().map(LoadingPlateInput::parts).map(line).collect()
}

fn rigid_bodies(case: &Case) -> Vec<String> {
    let row = |(name, RigidBodyInput { reference, inertia }): (&String, &RigidBodyInput)| {
        let inertia = inertia.map_or(String::new(), |inertia| format!(", moment of inertia {}", number(inertia)));
        format!("{name}: reference point {}{inertia}", vector(*reference))
    };
    case.rigid_bodies.iter().map(row).collect()
}

fn bars(model: &Model) -> Vec<String> {
    let row = |bar: &Bar| {
        let kind = if bar.ei > 0.0 { format!("beam, EI {}", number(bar.ei)) } else { "truss".into() };
        let limit = if bar.limit.is_finite() { format!(", yields at {}", number(bar.limit)) } else { String::new() };
        let bonds = bar.grips.first().map_or(String::new(), |grip| {
            let strength = grip.bond.strength();
            let strength = if strength < f64::MAX { format!(", strength {}", number(strength)) } else { String::new() };
            format!("; bond stiffness {}{strength}, normal {}", number(grip.bond.stiffness()), number(grip.normal))
        });
        let (length, parts) = (number(bar.length()), count(bar.segments.len(), "segment"));
        let mass = if bar.mass > 0.0 { format!(", mass {} per length", number(bar.mass)) } else { String::new() };
        let damping = damping([bar.drag, bar.retardation]);
        let ea = number(bar.ea);
        [bar.name.clone(), format!("{kind}, EA {ea}{limit}{mass}{damping}; length {length}, {parts}{bonds}")]
    };
    aligned(&model.bars.iter().map(row).collect::<Vec<_>>())
}

fn point_masses(case: &Case, model: &Model) -> Vec<String> {
    let row = |point: &PointMass| {
        let velocity = case.point_masses[&point.name].velocity;
        let start = velocity.map(|velocity| format!(", initial velocity {}", vector(velocity)));
        let mass = format!("mass {} at {}", number(point.mass), count(point.nodes.len(), "node"));
        [point.name.clone(), mass + &start.unwrap_or_default()]
    };
    aligned(&model.point_masses.iter().map(row).collect::<Vec<_>>())
}

/// Ordinal number: 2nd, 3rd, 11th.
fn ordinal(number: usize) -> String {
    let ending = match (number % 10, number % 100) {
        (_, 11..=13) => "th",
        (1, _) => "st",
        (2, _) => "nd",
        (3, _) => "rd",
        _ => "th",
    };
    format!("{number}{ending}")
}

fn newton(case: &Case) -> String {
    let newton = case.newton;
    format!("tolerance {}, at most {}", number(newton.tolerance), count(newton.max_iterations, "iteration"))
}

fn output(case: &Case, model: &Model) -> Vec<String> {
    let frames = match case.output.frames(case.steps.len()).of {
        Selection::Named => "at the requested times, and at the end of each step".into(),
        Selection::Parts(1) => "at the end of each step".into(),
        Selection::Parts(parts) => format!("{parts} times in each step"),
        Selection::Rows(1) => "with every row of the history".into(),
        Selection::Rows(every) => {
            format!("with every {} row of the history, and at the end of each step", ordinal(every))
        }
    };
    let bits = if case.output.exact { 64 } else { 32 };
    let fields = match case.output.fields {
        true => format!("fields {frames}, in {bits} bits"),
        false => "no fields".into(),
    };
    let names = match case.watch.iter().map(|place| watched(place, model)).collect::<Vec<_>>() {
        none if none.is_empty() => "none".into(),
        some => some.join(", "),
    };
    let mut lines = vec![format!("watched groups: {names}"), fields];
    if let Some(interval) = case.output.interval {
        let step = number(interval);
        lines.push(format!("rows at least {step} apart, and at events; explicit steps write at multiples of {step}"));
    }
    if !case.output.times.is_empty() {
        lines.push(format!(
            "fields at {}",
            case.output.times.iter().map(|time| number(*time)).collect::<Vec<_>>().join(", ")
        ));
    }
    if !model.requests.probes.is_empty() {
        lines.push(format!("{} in probes.csv", count(model.requests.probes.len(), "probe")));
    }
    for axis in &model.requests.sections {
        lines.push(format!("{} of `{}` in sections.csv", count(axis.stations.len(), "section"), axis.name));
    }
    if let Some(fronts) = case.output.fronts {
        let rate = number(fronts.slip_rate);
        lines.push(match fronts.arrival {
            None => format!("fronts where the slip rate passes {rate}"),
            Some(ArrivalInput::R(value)) => {
                format!("fronts where R passes {}, events where the slip rate passes {rate}", number(value))
            }
            Some(ArrivalInput::Mu(value)) => {
                format!("fronts where mu passes {}, events where the slip rate passes {rate}", number(value))
            }
        });
    }
    lines
}
