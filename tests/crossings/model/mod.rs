//! The case of a draft, written in one of many ways that mean the same.

mod bars;
mod bodies;
mod contacts;
mod names;
mod steps;

pub use names::Names;
use std::path::Path;

use fecontact::case::{Halvings, Written, refined};
use serde_json::{Map, Value, json};

use crate::features::{Draft, hash};
use crate::frame::{Frame, Kind};
use crate::mesh::{DIE, Rectangle, Sheet, dyadic, is_quadratic};

/// How a draft is written.
#[derive(Clone, Debug)]
pub struct Ways {
    pub frame: Frame,
    /// every step in two
    pub halves: bool,
    /// something that touches nothing stands aside
    pub bystander: bool,
    /// so many times as far as next to it
    pub far: f64,
    /// the master goes on to both sides, where nothing meets it, so many times as far
    pub wide: Option<f64>,
    /// supports along both axes are told along a third direction as well
    pub told_thrice: bool,
    /// the axis of rings is held by an expression as well
    pub axis_told: bool,
    /// a strut stands aside that is pushed together by so many times what makes it buckle
    pub strut: Option<f64>,
    /// its middle is raised by so much of its length
    pub raised: f64,
    /// tractions given at the start are far above any strength
    pub overstressed: bool,
    /// a fluid between the surfaces, as an expression in the canonical X and T
    pub fluid: Option<String>,
    /// elements and increments are halved so many times
    pub halved: Option<u32>,
    /// and one of its bodies flies off when its springs are taken away
    pub flight: bool,
    /// the block in two bodies that share nodes
    pub block_in_two: bool,
    /// bodies and contacts with other names, so that they come in another order
    pub renamed: bool,
    /// nodes, elements, edges and lists in another order
    pub shuffled: bool,
    /// how motions and loads are driven, if not as drafted
    pub drive: Option<&'static str>,
    /// numbers of friction as expressions of the time that stay the same, but were others at the very start
    pub told_in_time: bool,
    /// numbers changed in the 12th digit
    pub noise: Option<u64>,
    /// tolerance of Newton's method times this
    pub looser: f64,
    /// all loads and motions times this
    pub load: f64,
    /// densities times this
    pub density: f64,
    /// α_n times this
    pub stiffer: f64,
    /// increments shorter by this
    pub finer: f64,
    pub sliding: Option<&'static str>,
    pub normal: Option<&'static str>,
    pub scheme: Option<&'static str>,
    /// slave and master swapped
    pub swapped: bool,
    /// everything begins so many lengths of a stage later, after a step in which nothing happens
    pub later: f64,
}

impl Ways {
    /// As it is drafted.
    pub fn plain(draft: &Draft) -> Self {
        let radius = match draft.of("section") {
            "rings_on_end" => draft.pick("radius", &[0.0, 0.75]),
            "rings_around" => draft.pick("radius", &[1.25, 2.0]),
            _ => 0.0,
        };
        Self {
            frame: Frame::of_section(draft.of("section"), radius),
            halves: false,
            bystander: false,
            far: 1.0,
            wide: None,
            told_thrice: false,
            axis_told: false,
            strut: None,
            raised: 0.0,
            overstressed: false,
            fluid: None,
            halved: None,
            flight: false,
            block_in_two: false,
            renamed: false,
            shuffled: false,
            drive: None,
            told_in_time: false,
            noise: None,
            looser: 1.0,
            load: 1.0,
            density: 1.0,
            stiffer: 1.0,
            finer: 1.0,
            sliding: None,
            normal: None,
            scheme: None,
            swapped: false,
            later: 0.0,
        }
    }

    /// With everything later, by so many lengths of a stage.
    pub fn later(mut self, stages: f64, draft: &Draft) -> Self {
        self.frame.later = self.frame.time * stages * duration(draft);
        self.later = stages;
        self
    }
}

/// What a thing that stands aside is called; it comes first and last of all bodies.
pub const ASIDE: [&str; 2] = ["aaa", "zzz"];

/// The rigid body that moves, if there is one.
const TOOL: &str = "tool";

/// A body that shares the nodes of the block's left side; with other names it comes before the block, not after it.
const FLANGE: &str = "flange";

/// A slender body that stands aside, clamped at both ends and pushed together: its length, and its height as a share of that.
const STRUT: &str = "strut";
const STRUT_LENGTH: f64 = 2.0;
const SLENDERNESS: f64 = 0.025;

/// A rigid body that stands in the block's way.
const STOP: &str = "stop";

/// A body beside the ground that carries the surface on.
const OUTSKIRTS: &str = "outskirts";

const DYNAMIC: [&str; 5] = ["newmark", "hht", "generalized_alpha", "wilson", "explicit"];

pub fn is_dynamic(scheme: &str) -> bool {
    DYNAMIC.contains(&scheme)
}

/// Whether a body is not there all the time.
pub fn comes_or_goes(draft: &Draft) -> bool {
    draft.is("flange", "added") || draft.is("flange", "removed")
}

/// Whether one of its steps has inertia.
pub fn moves(draft: &Draft) -> bool {
    is_dynamic(draft.of("scheme")) || is_dynamic(draft.of("then"))
}

/// Whether one of its steps is explicit, or may become so.
pub fn is_explicit(draft: &Draft) -> bool {
    draft.is("scheme", "explicit") || draft.is("then", "explicit") || draft.has("rupture")
}

/// The case.
pub fn case(draft: &Draft, ways: &Ways) -> Value {
    let written = Writer {
        draft,
        ways,
        frame: &ways.frame,
        names: Names::of(ways),
        scheme: ways.scheme.unwrap_or(draft.of("scheme")),
    }
    .case();
    ways.halved.map_or_else(|| written.clone(), |times| halved(&written, times))
}

/// The case as `converge` runs it; what it refuses is a case that is refused.
fn halved(written: &Value, times: u32) -> Value {
    let path = Path::new("case.json");
    let finer = Written::from_text(&written.to_string(), path)
        .and_then(|written| refined(&written, Halvings::of_both(times)))
        .map_err(|error| error.to_string());
    finer.map_or_else(|error| json!({"refused": error}), |finer| finer.document)
}

struct Writer<'a> {
    draft: &'a Draft,
    ways: &'a Ways,
    frame: &'a Frame,
    names: Names,
    scheme: &'static str,
}

/// A quantity that goes from one value to another over a stage; `on` its group.
#[derive(Clone)]
struct Target {
    what: What,
    on: String,
    to: [f64; 2],
}

#[derive(Clone, Copy, PartialEq, Debug)]
enum What {
    /// displacement along the canonical axes that are held
    Support([bool; 2]),
    Rotation,
    /// of the tool
    Angle,
    Pressure,
    DeadPressure,
    Traction,
    TotalForce,
    Force,
    Gravity,
    Moment,
    Temperature,
}

/// One of the steps before they are cut in two.
struct Stage {
    name: &'static str,
    targets: Vec<Target>,
}

const BLOCK_HEIGHT: f64 = 0.75;
const GROUND_DEPTH: f64 = 0.625;
/// How the block is pressed down, dragged, and by what pressure.
const DOWN: f64 = 0.008;
const DRAG: f64 = 0.03;
const PRESSURE: f64 = 6.0;
const GAP: f64 = 0.0015;

impl Writer<'_> {
    fn is(&self, slot: &str, value: &str) -> bool {
        self.draft.is(slot, value)
    }

    fn has(&self, slot: &str) -> bool {
        self.draft.has(slot)
    }

    fn rings(&self) -> bool {
        self.draft.of("section").starts_with("rings")
    }

    fn is_rigid(&self) -> bool {
        matches!(self.draft.of("master"), "plane" | "circle" | "polyline" | "outline")
    }

    /// A number that a run depends on.
    fn noisy(&self, x: f64, name: &str) -> f64 {
        match self.ways.noise {
            None => x,
            Some(noise) => x * (1.0 + 1e-12 * (hash(noise, name) % 2001) as f64 / 1000.0 - 1e-12),
        }
    }

    fn pick(&self, name: &str, among: &[f64]) -> f64 {
        self.draft.pick(name, among)
    }

    fn write(&self, kind: Kind, x: f64) -> f64 {
        self.frame.write(kind, x)
    }

    fn span(&self) -> [f64; 2] {
        span(self.draft)
    }

    /// Area of the surface that is pressed.
    fn area(&self) -> f64 {
        let [low, high] = self.span();
        let radius = self.frame_radius();
        match self.draft.of("section") {
            "plane_stress" => (high - low) * self.thickness(),
            "rings_on_end" => std::f64::consts::PI * ((high + radius).powi(2) - (low + radius).powi(2)),
            "rings_around" => std::f64::consts::TAU * (radius - BLOCK_HEIGHT) * (high - low),
            _ => high - low,
        }
    }

    fn frame_radius(&self) -> f64 {
        match self.draft.of("section") {
            "rings_on_end" => self.pick("radius", &[0.0, 0.75]),
            _ => self.pick("radius", &[1.25, 2.0]),
        }
    }

    fn thickness(&self) -> f64 {
        self.pick("thickness", &[0.3, 1.0, 2.5])
    }

    fn case(&self) -> Value {
        let mut case = Map::new();
        case.insert("mesh".into(), self.mesh());
        case.insert("bodies".into(), self.bodies());
        let rigid_bodies = self.rigid_bodies();
        if !rigid_bodies.is_empty() {
            case.insert("rigid_bodies".into(), rigid_bodies.into());
        }
        if self.has("bar") {
            case.insert("bars".into(), self.bars());
        }
        case.insert("contacts".into(), self.contacts());
        case.insert("steps".into(), self.steps().into());
        let plates = self.plates();
        if !plates.is_empty() {
            case.insert("plates".into(), plates.into());
        }
        match self.draft.of("section") {
            "plane_stress" => drop(case.insert(
                "section".into(),
                json!({"plane_stress": {"thickness": self.write(Kind::Length, self.thickness())}}),
            )),
            "plane_strain" => {}
            _ => drop(case.insert("section".into(), json!("axisymmetric"))),
        }
        if self.has("periodic") {
            case.insert("periodic".into(), json!([[self.group("ground_left"), self.group("ground_right")]]));
        }
        let mut velocities = Map::new();
        if self.is("velocity", "initial") {
            velocities = self.velocities();
        }
        if self.ways.bystander && self.flies() {
            velocities.insert(ASIDE[1].into(), json!(self.frame.vector(Kind::Velocity, [0.7, -0.2])));
        }
        if !velocities.is_empty() {
            case.insert("initial_velocity".into(), velocities.into());
        }
        let mut masses = Map::new();
        if self.has("point_mass") {
            masses.insert(self.group("block_corner"), json!({"mass": 5e-5 * self.mass_unit()}));
        }
        if self.is("tool", "free") {
            masses.insert(TOOL.into(), json!({"mass": 1e-3 * self.mass_unit()}));
        }
        if !masses.is_empty() {
            case.insert("point_masses".into(), masses.into());
        }
        let mut watch = vec![self.group("block_top"), self.group("block_corner")];
        watch.extend((!self.is_rigid()).then(|| self.group("ground_bottom")));
        let mut watch: Vec<Value> = watch.into_iter().map(Value::from).collect();
        if self.has("near") {
            let at = [self.span()[1] + 0.01, BLOCK_HEIGHT + 0.02].map(dyadic);
            watch.push(json!({"near": self.frame.point(at)}));
        }
        case.insert("watch".into(), json!(watch));
        case.insert("probes".into(), self.probes());
        case.insert("newton".into(), json!({"tolerance": 1e-10 * self.ways.looser, "max_iterations": 25}));
        let mut output = json!({"fields": false, "report": false, "checkpoint": null});
        let dt = self.dt();
        if self.has("times") {
            output["times"] = json!([self.at(0.61 * self.duration()), self.at(1.37 * self.duration())]);
        }
        if self.has("interval") {
            output["interval"] = json!(self.write(Kind::Time, 2.0 * dt));
        } else if self.scheme == "explicit" || self.is("then", "explicit") || self.has("rupture") {
            output["interval"] = json!(self.write(Kind::Time, dt));
        }
        case.insert("output".into(), output);
        case.into()
    }

    /// What masses are counted in.
    fn mass_unit(&self) -> f64 {
        let Frame { length, stress, time, .. } = *self.frame;
        self.ways.density * stress * self.frame.unit(Kind::Area) * time.powi(2) / length
    }

    /// Whether no support says how the tool turns: its inertia does, or what touches it, and dashpots.
    fn turns_freely(&self) -> bool {
        let inert = is_dynamic(self.scheme) && !self.is("then", "static");
        self.is("tool", "free") && (inert || self.has("stabilize"))
    }

    fn rigid_bodies(&self) -> Map<String, Value> {
        let mut bodies = Map::new();
        if self.has("tool") {
            let mut tool = json!({"reference": self.frame.point([1.25, -0.375])});
            if self.turns_freely() {
                tool["inertia"] = json!(3e-4 * self.mass_unit() * self.frame.length.powi(2));
            }
            bodies.insert(TOOL.into(), tool);
        }
        if self.is("second_contact", "tool") {
            bodies.insert(STOP.into(), json!({"reference": self.frame.point([2.5, 0.25])}));
        }
        bodies
    }

    /// Ends of a rigid way; the solid lies on its right.
    fn way(&self) -> [[f64; 2]; 2] {
        let [low, high] = match self.ways.wide {
            None => [-0.5, 3.0],
            Some(wide) => [-0.5 * wide, 3.0 * wide],
        };
        let mut ends = [[low, 0.0], [high, 0.0]].map(|p| self.frame.point(p));
        if self.frame.flips() {
            ends.reverse();
        }
        ends
    }

    /// The bodies that are the block.
    fn blocks(&self) -> Vec<&'static str> {
        let half = self.ways.block_in_two.then_some("half");
        std::iter::once(self.names.block).chain(half).collect()
    }

    /// A group of the mesh by its canonical name.
    fn group(&self, name: &str) -> String {
        let (body, rest) = name.split_once('_').unwrap_or((name, ""));
        let own = if body == "block" { self.names.block } else { self.names.ground };
        if rest.is_empty() { own.into() } else { format!("{own}_{rest}") }
    }

    // ---- mesh ----

    fn mesh(&self) -> Value {
        let mut sheet = Sheet::default();
        let quadratic = |slot: &str| is_quadratic(self.draft.of(slot));
        let warp = |name: &str| self.pick(name, &[0.0, 0.03]);
        let block_rows = if quadratic("block_element") { 1 } else { 2 };
        let [low, high] = self.span();
        if !self.is_rigid() {
            let right =
                if self.is("section", "rings_on_end") && !self.is("surfaces", "matching") { 1.625 } else { 3.0 };
            let columns = match (quadratic("ground_element"), self.is("surfaces", "matching")) {
                (false, true) => 8,
                (true, true) => 8,
                (false, false) => self.draft.count("ground columns", 5, 7),
                (true, false) => self.draft.count("ground columns", 3, 4),
            };
            sheet.rectangle(&Rectangle {
                name: self.names.ground,
                low: [0.0, -GROUND_DEPTH],
                high: [right, 0.0],
                columns,
                rows: if quadratic("ground_element") { 1 } else { 2 },
                element: self.draft.of("ground_element"),
                warp: warp("ground warp"),
            });
        }
        let first_of_block = sheet.nodes.len();
        let bottom = match () {
            () if self.has("shrink_fit") => -GAP,
            () if starts_separated(self.draft) => GAP,
            () => 0.0,
        };
        sheet.rectangle(&Rectangle {
            name: self.names.block,
            low: [low, dyadic(bottom)],
            high: [high, BLOCK_HEIGHT],
            columns: if self.is("surfaces", "matching") {
                3
            } else {
                self.draft.count("block columns", 2, if quadratic("block_element") { 2 } else { 4 })
            },
            rows: block_rows,
            element: self.draft.of("block_element"),
            warp: warp("block warp"),
        });
        if self.has("tip") {
            sheet.weld_at([high, 0.0]);
        }
        if self.has("flange") {
            sheet.rectangle(&Rectangle {
                name: FLANGE,
                low: [low - 0.375, dyadic(bottom)],
                high: [low, BLOCK_HEIGHT],
                columns: 1,
                rows: block_rows,
                element: self.draft.of("block_element"),
                warp: 0.0,
            });
            if !self.is("flange", "tied") {
                sheet.weld(first_of_block);
                // No side of either any more.
                sheet.edges.remove(&self.group("block_left"));
                sheet.edges.remove(&format!("{FLANGE}_right"));
            }
        }
        if self.is("master", "itself") {
            let skin = ["ground_top", "block_bottom"].map(|name| sheet.edges[&self.group(name)].clone()).concat();
            sheet.edges.insert("skin".into(), skin);
        }
        if self.ways.block_in_two {
            sheet.split(self.names.block, "half");
        }
        if self.is("master", "outline") {
            sheet.nodes.extend([[-0.5, 0.0], [3.0, 0.0]]);
            let [low, high] = [sheet.nodes.len() - 2, sheet.nodes.len() - 1];
            sheet.edges.insert(DIE.into(), vec![if self.frame.flips() { vec![high, low] } else { vec![low, high] }]);
        }
        if let Some(wide) = self.ways.wide.filter(|_| !self.is_rigid()) {
            self.widen(&mut sheet, wide);
        }
        if self.ways.bystander {
            for (k, name) in ASIDE.into_iter().enumerate() {
                let (low, element) = self.aside(k);
                let high = [low[0] + 1.0, low[1] + 0.5];
                sheet.rectangle(&Rectangle { name, low, high, columns: 2, rows: 1, element, warp: 0.0 });
            }
        }
        if self.ways.strut.is_some() {
            let (low, high) = ([24.0, 0.0], [24.0 + STRUT_LENGTH, SLENDERNESS * STRUT_LENGTH]);
            let (name, element) = (STRUT, ["q8", "q9", "t6"][self.draft.count("strut", 0, 2)]);
            let first = sheet.nodes.len();
            sheet.rectangle(&Rectangle { name, low, high, columns: 16, rows: 1, element, warp: 0.0 });
            for [x, y] in &mut sheet.nodes[first..] {
                *y += self.ways.raised * (0.5 * STRUT_LENGTH - (*x - low[0] - 0.5 * STRUT_LENGTH).abs());
            }
        }
        if self.ways.shuffled {
            sheet.shuffle(self.draft.seed);
        }
        sheet.written(self.frame)
    }

    /// The surface of the ground goes on beyond its end, on a body that is held.
    fn widen(&self, sheet: &mut Sheet, wide: f64) {
        let low =
            sheet.edges[&self.group("ground_right")].iter().flatten().map(|&n| sheet.nodes[n][0]).fold(0.0, f64::max);
        sheet.rectangle(&Rectangle {
            name: OUTSKIRTS,
            low: [low + 0.5, -GROUND_DEPTH],
            high: [3.0 * wide, 0.0],
            columns: 2,
            rows: 1,
            element: self.draft.of("ground_element"),
            warp: 0.0,
        });
        let further = sheet.edges[&format!("{OUTSKIRTS}_top")].clone();
        for surface in [self.group("ground_top"), "skin".into()] {
            if let Some(edges) = sheet.edges.get_mut(&surface) {
                edges.extend(further.iter().cloned());
            }
        }
    }

    /// Lowest corner and elements of what stands aside.
    fn aside(&self, k: usize) -> ([f64; 2], &'static str) {
        let x = (16.0 + 4.0 * k as f64) * self.ways.far;
        let low = if self.is("section", "rings_around") { [x, 0.0] } else { [x, 0.25] };
        (low, if self.pick(ASIDE[k], &[0.0, 1.0]) == 0.0 { "q4" } else { "t6" })
    }

    fn probes(&self) -> Value {
        let at = |p: [f64; 2]| self.frame.point(p.map(dyadic));
        let [low, high] = self.span();
        let mut probes = json!({"in_block": {"at": at([0.3 * low + 0.7 * high, 0.211])}});
        if !self.is_rigid() {
            probes["in_ground"] = json!({"from": at([0.61, -0.177]), "to": at([1.07, -0.311]), "number": 2});
        }
        probes
    }
}

/// x of a corner of the block on its lower side.
pub fn corner(draft: &Draft) -> f64 {
    span(draft)[0]
}

/// x of the block from and to.
fn span(draft: &Draft) -> [f64; 2] {
    match (draft.is("section", "rings_on_end"), draft.is("surfaces", "matching")) {
        (_, true) => [0.75, 1.875],
        (true, false) => [0.0, 1.125],
        (false, false) => [dyadic(0.83), dyadic(1.97)],
    }
}

/// Length of a stage.
pub fn duration(draft: &Draft) -> f64 {
    // Of what may go on explicitly, as short as waves take some times across.
    if moves(draft) || draft.has("rupture") { 0.02 } else { 1.0 }
}

/// Whether the surfaces lie apart at the start.
pub fn starts_separated(draft: &Draft) -> bool {
    draft.is("master", "itself")
        || !draft.has("shrink_fit")
            && !draft.has("tractions")
            && !draft.is("friction", "prescribed")
            && draft.pick("apart", &[0.0, 0.0, 1.0]) == 1.0
}
