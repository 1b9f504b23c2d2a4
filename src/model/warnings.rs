//! Warnings about a model before it is solved: initial gaps and overlaps of its contacts, and their accuracy.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use nalgebra::Vector2;

use super::balance;
use super::pore_flow_concerns;
use super::text::{count, number, vector};
use super::unfit;
use crate::contact::master::{Master, Rigid, Shape};
use crate::contact::pair::{BothSurfaces, ContactPair};
use crate::contact::surface::{Segment, SlavePoint, Surface};
use crate::laws::friction::{Bond, ContactLaw, Description};
use crate::mesh::{Element, ElementKind, Mesh};
use crate::model::method::{self, Chosen, Method};
use crate::model::scheme::Scheme;
use crate::model::{Body, Model, Step};

/// Round-off of a gap, relative to the positions of which it is the difference.
const OF_POSITIONS: f64 = 8.0 * f64::EPSILON;

/// Negligible overlap, relative to the slave's edge: its pressure is 10⁻¹¹ (λ + 2G) with the default penalty.
const OF_EDGE: f64 = 1e-12;

impl Model {
    /// Warnings before the run starts.
    pub fn warnings(&self) -> Vec<String> {
        let of_contact = |pair: &ContactPair| {
            // A contact that starts closed has no gaps that it keeps under pressure, and self-contact usually starts open.
            let warnings = match pair.initial.is_some() || pair.is_own() {
                true => Vec::new(),
                false => Gaps::of(self, pair).warnings(),
            };
            let further = closed_across(self, pair)
                .into_iter()
                .chain(faces_away(self, pair))
                .chain(friction_of_total_pressure(self, pair));
            let further = further
                .chain(isolated_pressure(self, pair))
                .chain(facets_of_a_fit(self, pair))
                .chain(truncated(pair))
                .chain(fragile(pair).into_iter().flatten());
            warnings
                .into_iter()
                .chain(further)
                .map(|warning| format!("contact `{}`: {warning}", pair.name))
                .collect::<Vec<_>>()
        };
        let of_model = coarse_positions(&self.mesh).into_iter().chain(lost_velocity(self)).chain(many_increments(self));
        let of_model = of_model.chain(idle_radiation(self)).chain(uncertain_times(self)).chain(balance::concerns(self));
        let of_model = of_model
            .chain(sheared_at_faults(self))
            .chain(unfit::concerns(self))
            .chain(pore_flow_concerns::concerns(self));
        let of_model = of_model.chain(
            self.bodies
                .iter()
                .filter_map(|body| Some(format!("body `{}`: {}", body.name, body.material.description().concern?))),
        );
        let concerns =
            self.about_methods(|chosen, pair| chosen.concern.map(String::from).or_else(|| uneven(self, pair, chosen)));
        of_model.chain(concerns).chain(self.contacts.iter().flat_map(of_contact)).collect()
    }

    /// Whether the surfaces of a contact overlap before anything has moved, and push each other apart at once.
    #[doc(hidden)]
    pub fn overlaps(&self) -> bool {
        let may = |pair: &&ContactPair| pair.initial.is_none() && !pair.is_own() && !pair.tied;
        self.contacts.iter().filter(may).any(|pair| Gaps::of(self, pair).low.0 < 0.0)
    }

    /// Methods chosen by the program, for contacts that do not specify one.
    #[doc(hidden)]
    pub fn choices(&self) -> Vec<String> {
        self.about_methods(|chosen, _| chosen.because.map(|because| format!("{}, {because}", chosen.method.name())))
    }

    fn about_methods(&self, message: impl Fn(&Chosen, &ContactPair) -> Option<String>) -> Vec<String> {
        let contacts = self.contacts.iter().zip(&self.methods);
        contacts
            .filter_map(|(pair, chosen)| Some(format!("contact `{}`: {}", pair.name, message(chosen.as_ref()?, pair)?)))
            .collect()
    }
}

/// Output times that a step ending early may shift.
fn uncertain_times(model: &Model) -> Option<String> {
    let step = model.steps.iter().find(|step| step.until.is_some())?;
    model.requests.times.iter().any(|time| *time > step.span.start).then(|| format!(
        "step `{}` may end early (until), and all that follows then comes earlier: output.times after its start may \
         lie in other steps, or after the end of the run, and are not written then; output.every goes by increments",
        step.name
    ))
}

/// Warns of a slave whose outward normal equals that of its rigid master everywhere: it lies inside, and contact cannot push it
/// out correctly. (Edges of a mesh master that do not face a slave are not in contact with it.)
fn faces_away(model: &Model, pair: &ContactPair) -> Option<String> {
    let Master::Rigid(rigid) = &pair.master else { return None };
    let x = model.mesh.undeformed();
    let outward = |point: &SlavePoint| Some(rigid.project(point, &x)?.normal.dot(&point.outward(&x)?));
    let away = |point: &&SlavePoint| outward(point).is_none_or(|along| along > 0.0);
    let first = pair.points.iter().find(|point| outward(point).is_some())?;
    pair.points.iter().all(|point| away(&point)).then(|| {
        let at = first.at(&x);
        format!(
            "the slave faces away from the rigid master everywhere, as at ({}, {}): turn the normal of the plane, reverse the polyline or the lines of the \
             outline, or see `hole` of the circle",
            number(at.x),
            number(at.y)
        )
    })
}

/// Least opening over which strength fades, over c h/E: below, an element at an end that opens gives way at once [-]
const SNAPS: f64 = 1.5;

/// Least slip over which a bond softens, over (c − c_r) h/E [-]
const SNAPS_BACK: f64 = 4.0;

/// Warns of strength without pressure that falls faster, first over an opening and then by slip, than an element follows.
pub fn fragile(pair: &ContactPair) -> [Option<String>; 2] {
    let flexibility = pair.fades.map_or(0.0, |fades| fades.flexibility);
    let bonds: Vec<&Bond> = pair.laws.iter().filter_map(|law| Some(law.cohesion.as_ref()?.bond())).collect();
    let least = |share: f64, of: fn(&Bond) -> [f64; 2]| {
        let fast = bonds.iter().map(|bond| of(bond)).map(|[length, fall]| (length, share * fall * flexibility));
        fast.filter(|(length, least)| length < least).max_by(|a, b| a.1.total_cmp(&b.1))
    };
    let opening = least(SNAPS, |bond| [bond.opening(), bond.strength()]).map(|(opening, least)| {
        format!(
            "its strength without pressure fades over the opening {}, below 1.5 c h/E = {}: where an end of the contact opens, an element may \
             give way at once, at which static steps stop; give a longer `bond.opening`, or finer edges, or take a step with inertia",
            number(opening),
            number(least)
        )
    });
    let slip = least(SNAPS_BACK, |bond| [bond.slip(), bond.strength() - bond.residual()]).map(|(slip, least)| {
        format!(
            "its bond softens over the slip {}, below 4 (c − c_r) h/E = {}: an element may snap back as it slips, at which static steps stop; \
             give a longer `bond.slip`, or finer edges, or take a step with inertia or `rupture`",
            number(slip),
            number(least)
        )
    });
    [opening, slip]
}

/// Coefficient of friction that stands for none in a law that goes by cohesion alone [-]
pub const NO_FRICTION: f64 = 1e-6;

/// Warns of friction that goes by the pressure where a body adjacent to it has fluid in its pores: contacts carry total stress.
fn friction_of_total_pressure(model: &Model, pair: &ContactPair) -> Option<String> {
    let goes_by_pressure = |law: &Arc<ContactLaw>| {
        let Description { is_frictionless, least_coefficient, .. } = law.description;
        !is_frictionless && least_coefficient.is_none_or(|least| least > NO_FRICTION)
    };
    if pair.tied || pair.holds_fluid() || !pair.laws.iter().any(goes_by_pressure) {
        return None;
    }
    let adjacent = |nodes: BTreeSet<usize>| {
        let holds_water = |body: &Body| body.pore_fluid.is_some() || body.pore_pressure.is_some();
        let is_adjacent = |body: &&Body| holds_water(body) && body.nodes.iter().any(|node| nodes.contains(node));
        model.bodies.iter().find(is_adjacent).map(|body| &body.name)
    };
    let (body, swap) = match adjacent(pair.slave_nodes().collect()) {
        Some(body) => (body, ""),
        None => (adjacent(pair.nodes().collect())?, "make it the slave and "),
    };
    Some(format!(
        "its friction depends on the total pressure, part of which is carried by the fluid in the pores of body \
         `{body}`: {swap}take that part from the pores of the slave (`\"fluid_pressure\": \"of_bodies\"`), or give it \
         (`fluid_pressure`), or a strength by total stress (friction law `adhesion`)"
    ))
}

/// Fluid pressure that counts as none, over the one at a neighbour [-]
const NO_PRESSURE: f64 = 1e-6;

/// Part of the largest fluid pressure at the start where it ends abruptly, as a source does [-]
const ABRUPT: f64 = 0.5;

/// Warns of a fluid that starts with a pressure at some points and comes to their neighbours only later: it counts as there before the
/// run, in addition to the initial pressure.
fn isolated_pressure(model: &Model, pair: &ContactPair) -> Option<String> {
    pair.initial.as_ref().filter(|_| pair.fluid.is_some())?;
    let (x, end) = (model.mesh.undeformed(), model.steps.last()?.span.end);
    let mut at_node: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (k, point) in pair.points.iter().enumerate() {
        let nodes = point.length.iter().flat_map(|share| &share.tangent).map(|(node, _)| *node);
        nodes.collect::<BTreeSet<_>>().into_iter().for_each(|node| at_node.entry(node).or_default().push(k));
    }
    let pressures =
        |time: f64| pair.points.iter().map(|point| pair.fluid_pressure(point, &x, time)).collect::<Vec<_>>();
    let [first, last] = [0.0, end].map(pressures);
    let highest = first.iter().copied().fold(0.0, f64::max);
    let is_none = |pressure: f64| pressure <= NO_PRESSURE * highest;
    let nearest = |k: usize| {
        let way = |other: usize| (pair.points[other].at(&x) - pair.points[k].at(&x)).norm();
        let nodes = pair.points[k].length.iter().flat_map(|share| &share.tangent);
        let adjacent = nodes.filter_map(|(node, _)| at_node.get(node)).flatten().copied();
        adjacent.filter(|&other| !is_none(first[other])).min_by(|&a, &b| way(a).total_cmp(&way(b)))
    };
    let mut reached = (0..first.len()).filter(|&k| is_none(first[k]) && !is_none(last[k])).filter_map(nearest);
    let edge = reached.find(|&edge| first[edge] > ABRUPT * highest)?;
    Some(format!(
        "its fluid_pressure is {} at {} at t = 0 and none next to it: it acts before anything moves, in addition to the \
         initial pressure. If the run raises it, let it be 0 at t = 0, such as P*erfc((abs(x) + 1e-9)/(2*sqrt(D*t + \
         1e-30)))",
        number(first[edge]),
        vector(pair.points[edge].at(&x))
    ))
}

/// α_n ℓ/G*, ℓ being the slave's edge, up to which Gauss points on the finer side leave an even pressure even within some 6 %: what gives
/// way evens out as much as the bodies do over an edge [-]
const SOFT: f64 = 20.0;

/// Points that were asked for on linear edges whose nodes do not face nodes. Shape functions of the master have their kinks at its
/// nodes; where one faces the inside of a slave edge, quadrature over that edge hands on an even pressure unevenly, at every size of
/// the elements. (A slave that divides the edges of its master has no kinks inside its own.) What penalties give way evens that out.
fn uneven(model: &Model, pair: &ContactPair, chosen: &Chosen) -> Option<String> {
    let asked = chosen.because.is_none() && pair.mortar.is_none();
    let implicit = model.steps.iter().all(|step| step.rupture.is_none() && !step.scheme.is_integrated_explicitly());
    let (Master::Mesh(master), Some(BothSurfaces { nodes, slave: facing @ Master::Mesh(slave), .. })) =
        (&pair.master, &pair.both)
    else {
        return None;
    };
    let is_linear = |surface: &Surface| surface.segments.iter().all(Segment::is_straight);
    let x = model.mesh.undeformed();
    let edge = |surface: &Surface| {
        let lengths = surface.segments.iter().map(|&Segment { ends: [a, b], .. }| x.between(a, b).norm());
        lengths.sum::<f64>() / surface.segments.len() as f64
    };
    let gives_way =
        pair.penetration.is_none() && pair.alpha_n * edge(slave) <= SOFT * pair.modulus && edge(slave) <= edge(master);
    if !(asked && implicit && is_linear(master) && is_linear(slave))
        || chosen.method == Method::GaussToSegment && gives_way
    {
        return None;
    }
    let at = method::between_nodes(nodes, facing, &x)?.at(&x);
    Some(format!(
        "{} on nodes that do not match, as at ({}, {}): a uniform pressure comes out non-uniform by 5 % or more, \
         however fine the meshes; take \"method\": \"mortar\"",
        chosen.method.name(),
        number(at.x),
        number(at.y)
    ))
}

/// Random parameters that are out of the range of the law at some points.
fn truncated(pair: &ContactPair) -> impl Iterator<Item = String> {
    let points = pair.points.len();
    pair.truncated.iter().map(move |(name, outside)| {
        format!(
            "`{name}` is random, and outside the range of the friction law at {outside} of {} ({:.2} %): there it is truncated to the \
             range; a smaller deviation, or a lognormal marginal, leaves it less often",
            count(points, "contact point"),
            100.0 * *outside as f64 / points as f64
        )
    })
}

/// Part of the overlap of a shrink fit that straight edges may bring in [-]
const OF_OVERLAP: f64 = 0.02;

/// Straight edges that stand for curves, of other lengths on the two sides of a shrink fit: they change its overlap, and all that follows
/// from it. (By mortar, which averages; equal edges cancel.)
fn facets_of_a_fit(model: &Model, pair: &ContactPair) -> Option<String> {
    let counts = pair.mortar.is_some() && pair.points.iter().all(|point| point.touch == 0.0);
    let Some(BothSurfaces { slave: Master::Mesh(slave), .. }) = pair.both.as_ref().filter(|_| counts) else {
        return None;
    };
    let Master::Mesh(master) = &pair.master else { return None };
    let overlaps: Vec<f64> = pair.points.iter().map(|point| point.overlap).filter(|overlap| *overlap > 0.0).collect();
    let mean = overlaps.iter().sum::<f64>() / overlaps.len().max(1) as f64;
    let x = model.mesh.undeformed();
    let added = slave.by_chords(&x) + master.by_chords(&x);
    let share = added / (mean - added);
    (mean > 0.0 && share.abs() > OF_OVERLAP).then(|| {
        format!(
            "straight edges that approximate curves make the overlap of its shrink fit {:.0} % {} in the mean, and the \
             pressure with it: take quadratic elements, edges of equal length on both sides, or shorter ones",
            100.0 * share.abs(),
            if share > 0.0 { "larger" } else { "smaller" }
        )
    })
}

/// Corners of a bilinear element that are sharper than this are sheared too much next to a fault [rad]
const SHARP: f64 = std::f64::consts::FRAC_PI_4;

/// Bilinear elements that are sheared resist the shear of a slipping fault too much, at every size: cycles come too early.
fn sheared_at_faults(model: &Model) -> Option<String> {
    model.steps.iter().find(|step| matches!(step.scheme, Scheme::QuasiDynamic { .. }))?;
    let adjacent: BTreeMap<usize, &ContactPair> =
        model.contacts.iter().flat_map(|pair| pair.nodes().map(move |node| (node, pair))).collect();
    let sharpest = |element: &&Element| {
        let at = |k: usize| model.mesh.nodes[element.nodes[k % 4]];
        let angle = |k: usize| (at(k + 1) - at(k)).angle(&(at(k + 3) - at(k)));
        (0..4).map(angle).fold(f64::INFINITY, f64::min)
    };
    let sharp = model.mesh.elements.iter().filter(|element| element.kind == ElementKind::Q4);
    // A margin for what rounds the angle.
    let mut sharp = sharp.filter(|element| sharpest(element) < SHARP * (1.0 - 1e-6));
    let (element, pair) =
        sharp.find_map(|element| Some((element, element.nodes.iter().find_map(|node| adjacent.get(node))?)))?;
    let degrees = sharpest(&element).to_degrees();
    Some(format!(
        "contact `{}`: bilinear elements next to it have corners of {degrees:.0}°, and are too stiff against its slip \
         at every size: earthquakes come some percent too early; take quadratic elements (Q8)",
        pair.name
    ))
}

/// Warning about initial velocities that a static first step ignores.
fn lost_velocity(model: &Model) -> Option<String> {
    let first = model.steps.first().filter(|step| !step.scheme.is_dynamic())?;
    let moving = model.initial_velocity.iter().any(|v| *v != 0.0);
    moving.then(|| {
        format!(
            "the initial velocities have no effect: the first step, `{}`, is static; give it a dynamic scheme",
            first.name
        )
    })
}

/// Number of increments that causes a warning: each is a row of the history; explicit ones are fast.
const MANY: [f64; 2] = [1e6, 1e7];

/// Lower bound of the number of increments: from the longest one of implicit steps, and from the travel time of a wave along
/// the shortest side for explicit ones.
fn many_increments(model: &Model) -> Option<String> {
    let crossed = |(e, element)| {
        let body = model.body_of(e);
        shortest_side(&model.mesh, element) / (body.wave_modulus() / body.material.description().density).sqrt()
    };
    let crossed = model.mesh.elements.iter().enumerate().map(crossed).fold(f64::INFINITY, f64::min);
    let of_steps = |explicit: bool| -> f64 {
        let steps = model.steps.iter().filter(|step| matches!(step.scheme, Scheme::Explicit { .. }) == explicit);
        let longest = |step: &Step| if explicit { step.increments.max.min(crossed) } else { step.increments.max };
        steps.map(|step| (step.span.end - step.span.start) / longest(step)).sum()
    };
    let (implicit, explicit) = (of_steps(false), of_steps(true));
    let message = |count: f64, why: &str| format!("the run takes at least {count:.1e} increments{why}");
    match (implicit > MANY[0], explicit > MANY[1]) {
        (true, _) => {
            Some(message(implicit, ", each a row of history.csv: lengthen dt (initial, max) unless it is meant"))
        }
        (_, true) => Some(message(
            explicit,
            ": explicit ones are no longer than a wave takes along the shortest side of an element",
        )),
        _ => None,
    }
}

/// Warns of a radiation damping without effect in any step.
fn idle_radiation(model: &Model) -> Option<String> {
    let pair = model.contacts.iter().find(|pair| pair.radiation > 0.0)?;
    model.steps.iter().all(|step| step.scheme.is_dynamic()).then(|| {
        format!(
            "the radiation damping of contact `{}` has no effect: all steps have inertia, which radiates by itself",
            pair.name
        )
    })
}

/// Required accuracy of positions relative to the shortest edge: displacements of interest are thousands of times larger.
const KNOWN: f64 = 1e-8;

/// Shortest side of an element [L].
fn shortest_side(mesh: &Mesh, element: &Element) -> f64 {
    let corners = &element.nodes[..element.kind.corners()];
    let sides = corners.iter().zip(corners.iter().cycle().skip(1));
    sides.map(|(&a, &b)| (mesh.nodes[b] - mesh.nodes[a]).norm()).fold(f64::INFINITY, f64::min)
}

/// Largest coordinate of some nodes [L].
fn farthest(mesh: &Mesh, nodes: impl IntoIterator<Item = usize>) -> f64 {
    nodes.into_iter().fold(0.0, |most: f64, node| most.max(mesh.nodes[node].amax()))
}

/// Warns if the round-off ε |X| of positions is large relative to an element, which affects its shape, gaps and overlaps.
fn coarse_positions(mesh: &Mesh) -> Option<String> {
    let sizes = |element: &Element| (farthest(mesh, element.nodes.iter().copied()), shortest_side(mesh, element));
    let coarsest = mesh.elements.iter().map(sizes).max_by(|a, b| (a.0 / a.1).total_cmp(&(b.0 / b.1)));
    let (farthest, shortest) = coarsest?;
    let known = f64::EPSILON * farthest;
    (known > KNOWN * shortest).then(|| {
        format!(
            "nodes lie up to {} from the origin, and down to {} from each other: the round-off of their positions, and \
             of initial gaps and overlaps, is {known:.0e}; move the model to the origin before its mesh is written",
            number(farthest),
            number(shortest)
        )
    })
}

/// Gap or overlap that a contact closes at its start, over the slave's edge there, above which a warning is given: surfaces that carry a pressure
/// touch, but for the facets of both.
const CLOSED_ACROSS: f64 = 0.1;

/// A contact that starts closed across a gap or an overlap that no pressure acts across, or with a clearance that is far from that of the mesh.
fn closed_across(model: &Model, pair: &ContactPair) -> Option<String> {
    let x = model.mesh.undeformed();
    let moved = pair.points.iter().enumerate().filter(|_| !pair.tied).filter_map(|(k, point)| {
        let pressure = pair.initial.as_ref().map_or(0.0, |initial| initial[k].pressure);
        let give = if pair.penetration.is_some() { 0.0 } else { pressure / pair.alpha_n };
        Some((point, point.touch - give, (point.touch - give).abs() / point.edge_length(&x)?))
    });
    let (point, gap, share) = moved.max_by(|a, b| a.2.total_cmp(&b.2)).filter(|moved| moved.2 > CLOSED_ACROSS)?;
    if pair.initial.is_none() {
        return Some(format!(
            "`clearance` changes the gap of the mesh by {} at {}, {} of the edge there: name as slave only the part \
             that lies that close, or draw the surfaces closer to it",
            number(gap.abs()),
            vector(point.at(&x)),
            number(share)
        ));
    }
    let what = if gap > 0.0 { "a gap" } else { "an overlap" };
    Some(format!(
        "`initial` closes {what} of {} at {}, {} of the edge there: name as slave only what touches, move the surfaces together, or give no pressure \
         there, under which gaps stay open",
        number(gap.abs()),
        vector(point.at(&x)),
        number(share)
    ))
}

/// Describes the gaps of a contact that does not start closed, in words.
pub fn gaps(model: &Model, pair: &ContactPair, shrink_fit: bool) -> String {
    let gaps = Gaps::of(model, pair);
    let fit = gaps.fit.map(|(overlap, at)| {
        let place = format!("at ({}, {})", number(at.x), number(at.y));
        format!(
            "; shrink fit: the surfaces overlap by up to {}, {place}, brought in over the first step",
            number(overlap)
        )
    });
    let fit = match (fit, shrink_fit) {
        (None, true) => "; shrink fit: the surfaces overlap nowhere".into(),
        (fit, _) => fit.unwrap_or_default(),
    };
    gaps.message() + &fit
}

/// Initial gaps of a contact; round-off of the positions counts as zero.
struct Gaps {
    /// Whether points without a projection never come into contact (small sliding)
    small: bool,
    /// Whether the master is bounded by lines, which have a direction
    lines: bool,
    points: usize,
    facing: usize,
    /// Smallest gap, its position [L], and the length of the slave's edge there, 0 without one [L]
    low: (f64, Vector2<f64>, f64),
    high: f64,
    /// Largest overlap of a shrink fit, and its position [L]
    fit: Option<(f64, Vector2<f64>)>,
}

impl Gaps {
    fn of(model: &Model, pair: &ContactPair) -> Self {
        let x = model.mesh.undeformed();
        let reach = match &pair.master {
            Master::Rigid(Rigid { shape: Shape::Circle(circle), .. }) => circle.radius + circle.centre.norm(),
            _ => 0.0,
        };
        let size = farthest(&model.mesh, pair.nodes()).max(reach);
        let rounded = |point: &SlavePoint, length: f64| {
            let noise = (OF_POSITIONS * size).max(OF_EDGE * point.edge_length(&x).unwrap_or(0.0));
            if length.abs() <= noise { 0.0 } else { length }
        };
        let states = pair.initial_states(&x);
        let mut gaps = Self {
            small: pair.small.is_some(),
            lines: matches!(&pair.master, Master::Rigid(Rigid { shape: Shape::Polyline(_), .. })),
            points: states.len(),
            facing: 0,
            low: (f64::INFINITY, Vector2::zeros(), 0.0),
            high: f64::NEG_INFINITY,
            fit: None,
        };
        for (point, state) in pair.points.iter().zip(&states).filter(|(_, state)| state.master_point.is_some()) {
            let (gap, overlap) = (rounded(point, state.gap), rounded(point, point.overlap));
            gaps.facing += 1;
            gaps.high = gaps.high.max(gap);
            if gap < gaps.low.0 {
                gaps.low = (gap, point.at(&x), point.edge_length(&x).unwrap_or(0.0));
            }
            if overlap > gaps.fit.map_or(0.0, |(largest, _)| largest) {
                gaps.fit = Some((overlap, point.at(&x)));
            }
        }
        gaps
    }

    /// Points that face nothing, if there are any.
    fn without(&self) -> String {
        if self.facing < self.points {
            format!(", {} without a projection", self.without_projection())
        } else {
            String::new()
        }
    }

    fn without_projection(&self) -> String {
        count(self.points - self.facing, "contact point")
    }

    fn warnings(&self) -> Vec<String> {
        let Self { points, facing, low: (low, at, edge), .. } = *self;
        if facing == 0 {
            let none = "no point of the slave has a projection on the master; check the groups named and their \
                        positions";
            let side = if self.lines { ", and that the solid is on the right of the lines" } else { "" };
            return vec![format!("{none}{side}")];
        }
        let mut warnings = Vec::new();
        // In finite sliding they come into contact where they slide on the master, and do no harm elsewhere.
        if facing < points && self.small {
            let never = "without a projection on the master, and never come into contact in small sliding: if they may, take finite \
                         sliding, else leave them out of the slave";
            warnings.push(format!("{} of the slave {never}", self.without_projection()));
        }
        if low < 0.0 {
            // What is deep in an edge is no inaccuracy of the mesh.
            let remedies = match -low <= CLOSED_ACROSS * edge {
                true => {
                    "move them apart, bring the overlap in over the first step (shrink_fit), or, if they should only touch, take it \
                     out of the gaps (\"initial\": {\"pressure\": 0})"
                }
                false => {
                    "move them apart, or, if they are to be fitted, bring the overlap in over the first step (shrink_fit)"
                }
            };
            warnings.push(format!(
                "surfaces overlap by up to {} at the start, at ({}, {}), and are in contact from the first increment on; {remedies}",
                number(-low),
                number(at.x),
                number(at.y)
            ));
        }
        warnings
    }

    fn message(&self) -> String {
        let Self { facing, low: (low, ..), high, .. } = *self;
        match facing {
            0 => format!("initial gap: {}, none with a projection on the master", self.without_projection()),
            _ if low == high => format!("initial gap {} everywhere{}", number(low), self.without()),
            _ => format!("initial gap from {} to {}{}", number(low), number(high), self.without()),
        }
    }
}
