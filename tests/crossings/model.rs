//! The case of a draft, written in one of many ways that mean the same.

use serde_json::{Map, Value, json};

use crate::features::{Draft, hash};
use crate::frame::{Frame, Kind};
use crate::mesh::{Rectangle, Sheet, dyadic, is_quadratic};

/// How a draft is written.
#[derive(Clone, Debug)]
pub struct Ways {
    pub frame: Frame,
    /// every step in two
    pub halves: bool,
    /// something that touches nothing stands aside
    pub bystander: bool,
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

/// Names of the parts of a case.
pub struct Names {
    pub block: &'static str,
    pub ground: &'static str,
    pub contact: &'static str,
    pub second: &'static str,
}

impl Names {
    pub fn of(ways: &Ways) -> Self {
        match ways.renamed {
            false => Self { block: "block", ground: "ground", contact: "c", second: "d" },
            true => Self { block: "upper", ground: "base", contact: "z", second: "e" },
        }
    }
}

/// What a thing that stands aside is called; it comes first and last of all bodies.
pub const ASIDE: [&str; 2] = ["aaa", "zzz"];

/// The rigid body that moves, if there is one.
const TOOL: &str = "tool";

/// A body that shares the nodes of the block's left side; with other names it comes before the block, not after it.
const FLANGE: &str = "flange";

const DYNAMIC: [&str; 5] = ["newmark", "hht", "generalized_alpha", "wilson", "explicit"];

pub fn is_dynamic(scheme: &str) -> bool {
    DYNAMIC.contains(&scheme)
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
    Writer {
        draft,
        ways,
        frame: &ways.frame,
        names: Names::of(ways),
        scheme: ways.scheme.unwrap_or(draft.of("scheme")),
    }
    .case()
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
        matches!(self.draft.of("master"), "plane" | "circle" | "polyline")
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

    /// x of the block from and to.
    fn span(&self) -> [f64; 2] {
        match (self.is("section", "rings_on_end"), self.is("surfaces", "matching")) {
            (_, true) => [0.75, 1.875],
            (true, false) => [0.0, 1.125],
            (false, false) => [dyadic(0.83), dyadic(1.97)],
        }
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
        if self.has("tool") {
            let mut tool = json!({"reference": self.frame.point([1.25, -0.375])});
            if self.turns_freely() {
                tool["inertia"] = json!(3e-4 * self.mass_unit() * self.frame.length.powi(2));
            }
            case.insert("rigid_bodies".into(), json!({TOOL: tool}));
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

    /// Whether nothing but its inertia says how the tool turns.
    fn turns_freely(&self) -> bool {
        self.is("tool", "free") && is_dynamic(self.scheme) && !self.is("then", "static")
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
            () if starts_apart(self.draft) => GAP,
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
            sheet.weld(first_of_block);
            // No side of either any more.
            sheet.edges.remove(&self.group("block_left"));
            sheet.edges.remove(&format!("{FLANGE}_right"));
        }
        if self.is("master", "itself") {
            let skin = ["ground_top", "block_bottom"].map(|name| sheet.edges[&self.group(name)].clone()).concat();
            sheet.edges.insert("skin".into(), skin);
        }
        if self.ways.block_in_two {
            sheet.split(self.names.block, "half");
        }
        if self.ways.bystander {
            for (k, name) in ASIDE.into_iter().enumerate() {
                let x = 16.0 + 4.0 * k as f64;
                let low = if self.is("section", "rings_around") { [x, 0.0] } else { [x, 0.25] };
                let element = if self.pick(name, &[0.0, 1.0]) == 0.0 { "q4" } else { "t6" };
                let high = [low[0] + 1.0, low[1] + 0.5];
                sheet.rectangle(&Rectangle { name, low, high, columns: 2, rows: 1, element, warp: 0.0 });
            }
        }
        if self.ways.shuffled {
            sheet.shuffle(self.draft.seed);
        }
        sheet.written(self.frame)
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

    // ---- bodies ----

    fn bodies(&self) -> Value {
        let mut bodies = Map::new();
        let block = self.body("block", 800.0);
        if self.ways.block_in_two {
            bodies.insert("half".into(), block.clone());
        }
        bodies.insert(self.names.block.into(), block);
        if self.has("flange") {
            let law = if self.is("block_law", "linear") { "linear" } else { "neo_hookean" };
            let mut material = self.material(law, 300.0, 0.2);
            material["density"] = json!(4.0 * self.density());
            bodies.insert(FLANGE.into(), json!({"material": material}));
        }
        if !self.is_rigid() {
            bodies.insert(self.names.ground.into(), self.body("ground", 1500.0));
        }
        if self.ways.bystander {
            let [first, last] = ASIDE;
            let density = self.density();
            let linear =
                json!({"model": "linear", "E": self.write(Kind::Stress, 500.0), "nu": 0.25, "density": density});
            let mut stressed = json!({"material": linear});
            if self.scheme != "quasi_dynamic" {
                stressed["initial_stress"] = self.stress([-7.0, -3.0, 1.0]);
                let mut law = self.material("viscoelastic", 600.0, 0.3);
                law["density"] = json!(density);
                bodies.insert(last.into(), json!({"material": law}));
            } else {
                bodies.insert(last.into(), json!({"material": linear}));
            }
            bodies.insert(first.into(), stressed);
        }
        bodies.into()
    }

    fn density(&self) -> f64 {
        1e-3 * self.ways.density * self.frame.stress * self.frame.time.powi(2) / self.frame.length.powi(2)
    }

    fn material(&self, law: &str, young: f64, poisson: f64) -> Value {
        let young = self.write(Kind::Stress, self.noisy(young, law));
        if law.ends_with("cam_clay") {
            return self.clay(law, young);
        }
        let mut material = json!({"model": law, "E": young, "nu": poisson, "density": self.density()});
        if law == "viscoelastic" {
            material["E_1"] = json!(0.5 * young);
            material["tau"] = json!(self.write(Kind::Time, 0.7 * self.duration()));
        }
        self.strengths(law, &mut material);
        material
    }

    /// Clay whose stiffness under the least pressure is that of other laws.
    fn clay(&self, law: &str, young: f64) -> Value {
        let stress = |value: f64| json!(self.write(Kind::Stress, value));
        let [kappa, lambda] = [0.005, 0.1];
        let mut material = json!({
            "model": law, "lambda": lambda, "kappa": kappa, "p_min": stress(3.0), "density": self.density(),
        });
        match self.draft.count("slopes", 0, 1) {
            0 => material["M"] = json!(1.2),
            _ => (material["phi"], material["e"]) = (json!(28), json!(0.8)),
        }
        match self.draft.count("shear of clay", 0, 1) {
            0 => material["G"] = json!(0.4 * young),
            _ => material["nu"] = json!(0.25),
        }
        match self.draft.count("consolidation", 0, 1) {
            0 => material["p_c"] = stress(9.0),
            _ => material["OCR"] = json!(2.0),
        }
        if self.draft.count("slow yielding", 0, 1) == 1 {
            material["viscosity"] = json!(self.write(Kind::Time, 0.02 * self.duration()));
        }
        if law == "sys_cam_clay" {
            self.skeleton(&mut material);
        }
        material
    }

    /// What soil with a skeleton has besides: p_c is that of the remoulded soil.
    fn skeleton(&self, material: &mut Value) {
        if self.draft.count("overconsolidation", 0, 1) == 1 {
            material["m"] = json!(3.0);
        }
        if self.draft.count("structure of soil", 0, 1) == 1 {
            (material["structure"], material["a"], material["c_s"]) = (json!(1.5), json!(0.3), json!(0.6));
        }
        if self.draft.count("anisotropy", 0, 1) == 1 {
            (material["b_r"], material["m_b"], material["zeta"]) = (json!(0.3), json!(0.8), json!(0.1));
        }
    }

    /// Strengths above the initial stress, which the contact surpasses here and there.
    fn strengths(&self, law: &str, material: &mut Value) {
        let stress = |value: f64| json!(self.write(Kind::Stress, value));
        let (cone, soil) = (law == "drucker_prager", law == "mohr_coulomb");
        if law == "von_mises" {
            (material["sigma_y"], material["H"]) = (stress(7.0), stress(40.0));
            match self.draft.count("hardening", 0, 2) {
                0 => (material["Q"], material["b"]) = (stress(3.0), json!(50.0)),
                1 => material["back_stresses"] = json!([{"C": stress(60.0), "gamma": 20.0}, {"C": stress(20.0)}]),
                _ => {}
            }
        } else if cone || soil {
            (material["c"], material["phi"], material["psi"]) = (stress(4.0), json!(25), json!(25));
            material["tension"] = stress(5.0);
        } else {
            return;
        }
        if cone {
            material["matching"] = json!(["plane_strain", "compression"][self.draft.count("matching", 0, 1)]);
        }
        if soil {
            material["softening"] = json!({"c": stress(3.5), "phi": 24, "psi": 20, "strain": 0.1});
        }
        if self.draft.count("slow yielding", 0, 1) == 1 {
            material["viscosity"] = json!(self.write(Kind::Time, 0.02 * self.duration()));
        }
    }

    fn body(&self, name: &str, young: f64) -> Value {
        let poisson = self.pick(&format!("{name} nu"), &[0.0, 0.3, 0.3, 0.45]);
        let mut body = json!({"material": self.material(self.draft.of(&format!("{name}_law")), young, poisson)});
        if let element @ ("f_bar" | "reduced") = self.draft.of(&format!("{name}_element")) {
            body["element"] = json!(element);
        }
        match self.draft.of("stress") {
            "components" => body["initial_stress"] = self.stress([-1.0, -4.0, 0.0]),
            "geostatic" => {
                let surface = if name == "block" { BLOCK_HEIGHT } else { 0.0 };
                let weight = self.frame.stress / self.frame.length;
                let surface = self.frame.point([0.0, surface])[1];
                body["initial_stress"] = json!({"geostatic": {"surface": surface, "weight": 2.0 * weight, "K0": 0.6}});
            }
            _ => {}
        }
        if self.has("pores") {
            let stress = |value: f64| json!(self.write(Kind::Stress, value));
            body["pore_fluid"] = json!({"bulk_modulus": stress(900.0), "porosity": 0.4});
            if self.is("pores", "cavitating") {
                (body["pore_fluid"]["pressure"], body["pore_fluid"]["cavitation"]) = (stress(0.5), stress(-1.0));
            }
        }
        if self.has("heat") {
            body["thermal"] = json!({"expansion": 1e-3, "reference": self.pick("reference", &[0.0, 2.0])});
        }
        if self.is("damping", "of_body") {
            body["damping"] = self.damping(1.0);
        }
        body
    }

    fn damping(&self, share: f64) -> Value {
        json!({"mass": 5.0 * share / self.frame.time, "stiffness": 1e-5 * share * self.frame.time})
    }

    fn stress(&self, stress: [f64; 3]) -> Value {
        let [xx, yy, xy] = self.frame.tensor(stress).map(|s| self.write(Kind::Stress, s * self.ways.load));
        let mut components = json!({"xx": xx, "yy": yy, "xy": xy});
        if !self.is("section", "plane_stress") {
            components["zz"] = json!(self.write(Kind::Stress, -2.0 * self.ways.load));
        }
        json!({"components": components})
    }

    fn velocities(&self) -> Map<String, Value> {
        let v = json!(self.frame.vector(Kind::Velocity, [0.02, -0.1]));
        let flange = self.has("flange").then_some(FLANGE);
        let bodies = [Some(self.names.block), self.ways.block_in_two.then_some("half"), flange];
        bodies.into_iter().flatten().map(|body| (body.into(), v.clone())).collect()
    }

    // ---- contacts ----

    fn contacts(&self) -> Value {
        let (draft, frame) = (self.draft, self.frame);
        let slave = if self.is("master", "itself") { "skin".into() } else { self.group("block_bottom") };
        let master = match draft.of("master") {
            "plane" => json!({"plane": {"point": frame.point([0.25, 0.0]), "normal": frame.direction([0.0, 1.0])}}),
            "circle" => {
                json!({"circle": {"centre": frame.point([1.375, -8.0]), "radius": self.write(Kind::Length, 8.0)}})
            }
            "polyline" => {
                // The solid lies on the right of the way.
                let mut ends = [[-0.5, 0.0], [3.0, 0.0]].map(|p| frame.point(p));
                if frame.flips() {
                    ends.reverse();
                }
                json!({"polyline": {"points": ends}})
            }
            "itself" => json!("skin"),
            _ => json!(self.group("ground_top")),
        };
        let mut contact = json!({"slave": slave, "master": master, "friction": self.friction(draft.of("friction"))});
        if self.has("tool") {
            contact["rigid_body"] = json!(TOOL);
        }
        if self.ways.swapped {
            contact["slave"] = master;
            contact["master"] = json!(slave);
        }
        if draft.of("method") != "chosen" {
            contact["method"] = json!(draft.of("method"));
        }
        if self.has("gauss_points") {
            contact["points"] = json!(draft.of("gauss_points").parse::<usize>().expect("a number"));
        }
        if self.has("smooth") {
            contact["smooth"] = json!(true);
        }
        if self.ways.sliding.unwrap_or(draft.of("sliding")) == "small" {
            contact["sliding"] = json!("small");
        }
        let stiffness = frame.stress / frame.length * self.ways.stiffer;
        match self.ways.normal.unwrap_or(draft.of("normal")) {
            "alpha_n" => contact["normal"] = json!({"alpha_n": self.noisy(4e4, "alpha_n") * stiffness}),
            "augmented" => {
                contact["normal"] = json!({"alpha_n": 2e4 * stiffness, "penetration": self.write(Kind::Length, 1e-9)})
            }
            _ => {}
        }
        match draft.of("fluid") {
            "of_bodies" => contact["fluid_pressure"] = json!("of_bodies"),
            "constant" => contact["fluid_pressure"] = json!(self.write(Kind::Stress, self.ways.load)),
            "in_time" => {
                contact["fluid_pressure"] =
                    json!(frame.expression(Kind::Stress, &format!("0.8*(1+0.2*T/{})", self.duration()), self.ways.load))
            }
            _ => {}
        }
        match draft.of("dilatancy") {
            "free" => contact["dilatancy"] = json!({"rate": self.pick("tan psi", &[0.05, 0.15])}),
            "structure" => contact["dilatancy"] = json!({"structure": self.pick("tan psi", &[0.05, 0.2])}),
            "limited" => {
                contact["dilatancy"] =
                    json!({"rate": self.pick("tan psi", &[0.05, 0.15]), "limit": self.write(Kind::Length, 0.004)})
            }
            _ => {}
        }
        if self.has("wear") {
            contact["wear"] = json!(2e-3 / frame.stress);
        }
        match draft.of("radiation") {
            "given" => {
                contact["radiation_damping"] = json!(300.0 * frame.stress * frame.time / frame.length * self.duration())
            }
            "of_bodies" => contact["radiation_damping"] = json!(true),
            _ => {}
        }
        if self.has("stick") {
            contact["stick"] = json!(self.write(Kind::Length, 1e-9));
        }
        for key in ["shrink_fit", "massless"] {
            if self.has(key) {
                contact[key] = json!(true);
            }
        }
        match draft.of("tractions") {
            "given" => {
                contact["initial"] = json!({"pressure": self.write(Kind::Stress, 4.0 * self.ways.load), "traction": frame.expression(Kind::Stress, "0.3+0.1*X", frame.sign() * self.ways.load)});
                if self.is("friction", "super_subloading") && !self.has("further_parameters") {
                    contact["initial"]["structure"] = json!(1.1);
                }
            }
            "balanced" => {
                contact["initial"] =
                    json!({"pressure": self.write(Kind::Stress, 4.0 * self.ways.load), "balanced": true})
            }
            "of_bodies" => contact["initial"] = json!({"of_bodies": true}),
            _ => {}
        }
        self.vary(&mut contact);
        if self.ways.told_in_time {
            tell_in_time(&mut contact, self.write(Kind::Time, 1e-9 * self.dt()));
        }
        let mut contacts = Map::new();
        contacts.insert(self.names.contact.into(), contact);
        if self.has("second_contact") {
            let wall =
                dyadic(self.span()[1] + if self.scheme == "static" && !self.has("then") { 0.012 } else { 0.002 });
            let stop = json!({"plane": {"point": frame.point([wall, 0.0]), "normal": frame.direction([-1.0, 0.0])}});
            contacts.insert(self.names.second.into(), json!({"slave": self.group("block_right"), "master": stop, "method": "node_to_segment", "normal": {"alpha_n": 3e4 * stiffness}, "friction": {"law": "coulomb", "mu": 0.25, "alpha_t": 1e4 * stiffness}}));
        }
        contacts.into()
    }

    fn friction(&self, law: &str) -> Value {
        let (f, draft) = (self.frame, self.draft);
        let further = self.has("further_parameters");
        let duration = self.duration();
        let mut friction = match law {
            "coulomb" => json!({"mu": self.pick("mu", &[0.2, 0.4, 0.7])}),
            "adhesion" => json!({"strength": self.write(Kind::Stress, 1.5)}),
            "super_subloading" => {
                let mut law = json!({"mu_s": self.pick("mu_s", &[0.4, 0.6]), "mu_k": 0.25, "r": self.pick("r", &[200.0, 1000.0]) / f.length, "kappa": self.pick("kappa", &[20.0, 100.0]) / f.length, "xi": self.pick("xi", &[0.0, 0.5]) / f.time / duration});
                if further {
                    match draft.count("further", 0, 3) {
                        0 => law["elastic_core"] = json!(0.3),
                        1 => law["approach"] = json!("cotangent"),
                        2 => law["integration"] = json!("backward_euler"),
                        _ => (law["structure"], law["m"], law["n"]) = (json!(1.2), json!(1.3), json!(1.4)),
                    }
                }
                law
            }
            "slip_weakening" => {
                json!({"mu_s": 0.6, "mu_d": 0.4, "D_c": self.write(Kind::Length, 0.02), "cohesion": self.write(Kind::Stress, if further { 0.5 } else { 0.0 })})
            }
            "rate_and_state" => {
                let mut law = json!({"f_0": 0.5, "V_0": 1e-3 * f.unit(Kind::Velocity) / duration, "a": 0.012, "b": self.pick("b", &[0.008, 0.015]), "D_c": self.write(Kind::Length, 0.004), "evolution": if further { "slip" } else { "ageing" }});
                if further {
                    law["theta"] = json!(self.write(Kind::Time, 10.0 * duration));
                }
                law
            }
            "prescribed" => {
                json!({"slip_rate": self.pick("slip rate", &[0.01, -0.01]) * f.sign() * f.unit(Kind::Velocity) / duration})
            }
            "registered" => {
                json!({"name": "crossings viscous", "parameters": {"viscosity": 20.0 * f.stress * f.time / f.length * duration, "threshold": self.write(Kind::Stress, 0.4)}})
            }
            _ => json!({}),
        };
        friction["law"] = json!(law);
        // Where normal contact is compared with another, alpha_t does not follow alpha_n.
        let picked = self.pick("own alpha_t", &[0.0, 1.0]) == 1.0;
        let own = law == "super_subloading" || self.ways.normal.is_some() || picked;
        if law != "frictionless" && own {
            friction["alpha_t"] = json!(2e4 * f.stress / f.length);
        }
        friction
    }

    /// What of friction varies.
    fn vary(&self, contact: &mut Value) {
        let (f, duration) = (self.frame, self.duration());
        let growing = |kind: Kind, value: f64, time: bool| {
            let text =
                if time { format!("{value}*(1+0.05*X+0.1*T/{duration})") } else { format!("{value}*(1+0.05*X)") };
            f.expression(kind, &text, 1.0)
        };
        let parameter = |law: &str, time: bool| -> (&'static str, String) {
            match law {
                "coulomb" => ("mu", growing(Kind::Number, 0.3, time)),
                "adhesion" => ("strength", growing(Kind::Stress, 1.0, time)),
                // A rate, whose mean counts, or a strength, whose last value does.
                "super_subloading" if self.pick("which varies", &[0.0, 1.0]) == 0.0 => {
                    ("kappa", format!("({})/({})", growing(Kind::Number, 30.0, time), f.length))
                }
                "super_subloading" => ("mu_s", growing(Kind::Number, 0.5, time)),
                "slip_weakening" => ("mu_d", growing(Kind::Number, 0.35, time)),
                "rate_and_state" => ("f_0", growing(Kind::Number, 0.45, time)),
                law => panic!("say which parameter of `{law}` varies"),
            }
        };
        match self.draft.of("varying") {
            "by_part" => {
                let other = if self.is("scheme", "quasi_dynamic") { "rate_and_state" } else { "super_subloading" };
                let mut part =
                    json!({"where": f.expression(Kind::Number, "X-1.4", 1.0), "friction": self.friction(other)});
                let (name, text) = parameter(other, false);
                part["along"] = json!({name: text});
                contact["along"] = json!({"law": [part]});
            }
            "random" => {
                let (name, mean) = match self.draft.of("friction") {
                    "coulomb" => ("mu", 0.3),
                    "adhesion" => ("strength", f.stress),
                    "super_subloading" => ("mu_s", 0.5),
                    "slip_weakening" => ("mu_d", 0.35),
                    "rate_and_state" => ("f_0", 0.45),
                    law => panic!("say which parameter of `{law}` varies"),
                };
                let rough = json!({"von_karman": {"hurst": self.pick("hurst", &[0.5, 0.8])}});
                let picked = |name: &str, plain: Value, other: Value| {
                    if self.pick(name, &[0.0, 1.0]) == 1.0 { other } else { plain }
                };
                let field = json!({
                    "seed": self.pick("seed", &[1.0, 2.0, 3.0]) as u64, "mean": mean, "deviation": 0.05 * mean,
                    "correlation": 0.5 * f.length,
                    "marginal": picked("marginal", json!("normal"), json!("lognormal")),
                    "spectrum": picked("spectrum", json!("gaussian"), rough),
                });
                contact["along"] = json!({name: {"random": field}});
            }
            "no" => {}
            value => {
                let (name, text) = parameter(self.draft.of("friction"), value == "in_time");
                contact["along"] = json!({name: text});
            }
        }
    }

    // ---- steps ----

    fn duration(&self) -> f64 {
        duration(self.draft)
    }

    fn dt(&self) -> f64 {
        self.duration() / if moves(self.draft) { 8.0 } else { 4.0 }
    }

    /// A time of the run as written.
    fn at(&self, time: f64) -> f64 {
        self.frame.at(time)
    }

    fn target(&self, what: What, on: &str, to: [f64; 2]) -> Target {
        let to = [0, 1].map(|k| self.noisy(to[k] * self.ways.load, &format!("{what:?} {k}")));
        Target { what, on: self.group(on), to }
    }

    fn stages(&self) -> Vec<Stage> {
        let dynamic = moves(self.draft);
        let press = self.draft.of("press");
        let target = |what, on, to| self.target(what, on, to);
        let on_end = self.is("section", "rings_on_end");
        let held = What::Support([!on_end, false]);
        let (down, drag) = if dynamic { (0.5 * DOWN, 0.3 * DRAG) } else { (DOWN, DRAG) };
        let drag = if self.is("sliding", "small") { 0.5 * drag } else { drag };
        let drag = if self.is("friction", "prescribed") { 0.3 * drag } else { drag };
        let mut first = Vec::new();
        match press {
            "displacement" => {
                let slant = if self.has("approach") { 0.5 * drag } else { 0.0 };
                first.push(target(What::Support([!on_end, true]), "block_top", [slant, -down]));
            }
            "rotation" => first.push(target(What::Rotation, "block_top", [0.004, 0.0])),
            _ => {
                let force = -PRESSURE * self.area();
                if !on_end {
                    first.push(target(held, "block_top", [0.0, 0.0]));
                }
                first.push(match press {
                    "pressure" => target(What::Pressure, "block_top", [PRESSURE, 0.0]),
                    "dead_pressure" => target(What::DeadPressure, "block_top", [PRESSURE, 0.0]),
                    "traction" => target(What::Traction, "block_top", [0.0, -PRESSURE]),
                    "total_force" => target(What::TotalForce, "block_top", [0.0, force]),
                    _ => target(What::Force, "block_corner", [0.0, force]),
                });
            }
        }
        let mut second = Vec::new();
        match press {
            _ if on_end && self.scheme != "quasi_dynamic" => {
                second.push(target(What::DeadPressure, "block_right", [self.pick("radial", &[20.0, -20.0]), 0.0]))
            }
            "rotation" => second.push(target(What::Rotation, "block_top", [-0.002, 0.0])),
            "displacement" => second.push(target(What::Support([!on_end, true]), "block_top", [drag, -1.2 * down])),
            _ => second.push(target(held, "block_top", [drag, 0.0])),
        }
        if self.has("gravity") {
            first.push(target(What::Gravity, "block", [0.0, -300.0]));
            if self.ways.block_in_two {
                first.push(Target { on: "half".into(), ..target(What::Gravity, "block", [0.0, -300.0]) });
            }
        }
        if self.has("heat") {
            second.push(target(What::Temperature, "block", [self.pick("warmer", &[3.0, -2.0]), 0.0]));
            if self.ways.block_in_two {
                let block = second.last().cloned().expect("the block's");
                second.push(Target { on: "half".into(), ..block });
            }
            if !self.is_rigid() {
                first.push(target(What::Temperature, "ground", [2.5, 0.0]));
            }
        }
        if self.is("plate", "rigid") {
            second.push(target(What::Moment, "block_right", [0.3 * self.frame_moment(), 0.0]));
        }
        // Where it is free, springs hold it against a force.
        let tool = |to: [f64; 2], angle: f64, force: f64| {
            let on = |what, to| Target { on: TOOL.into(), ..target(what, "block", to) };
            let free = self.is("tool", "free");
            let mut path = vec![on(What::Support([true, !free]), to)];
            path.extend((!self.turns_freely()).then(|| on(What::Angle, [angle, 0.0])));
            path.extend(free.then(|| on(What::Force, [0.0, force])));
            path.into_iter().filter(|_| self.has("tool"))
        };
        first.extend(tool([0.0, 0.0], 0.0, 0.0));
        second.extend(tool([-0.4 * drag, -0.05 * down], 0.002, 0.5 * PRESSURE * self.area()));
        let mut stages = vec![Stage { name: "press", targets: first }, Stage { name: "drag", targets: second }];
        if self.has("reversal") {
            let back = match press {
                _ if on_end => target(What::DeadPressure, "block_right", [0.0, 0.0]),
                "rotation" => target(What::Rotation, "block_top", [0.003, 0.0]),
                "displacement" => target(What::Support([true, true]), "block_top", [-0.5 * drag, -1.1 * down]),
                _ => target(held, "block_top", [-0.5 * drag, 0.0]),
            };
            // A rate would go on where nothing is said of it.
            let rests = tool([-0.4 * drag, -0.05 * down], 0.002, 0.3 * PRESSURE * self.area());
            stages.push(Stage { name: "back", targets: std::iter::once(back).chain(rests).collect() });
        }
        stages
    }

    fn frame_moment(&self) -> f64 {
        if self.is("section", "plane_stress") { self.thickness() } else { 1.0 }
    }

    fn plates(&self) -> Vec<Value> {
        let mut plates = Vec::new();
        if self.is("press", "plate") {
            plates.push(json!(self.group("block_top")));
        }
        match self.draft.of("plate") {
            "rigid" => plates.push(json!({"on": self.group("block_right"), "moves": "rigid"})),
            "alike" => {
                let across = self.frame.direction([1.0, 0.0])[0].abs() < 0.5;
                plates.push(
                    json!({"on": self.group("block_right"), "moves": if across { "uy_alike" } else { "ux_alike" }}),
                );
            }
            _ => {}
        }
        plates
    }

    /// Whether what stands aside flies.
    fn flies(&self) -> bool {
        self.ways.flight && is_dynamic(self.scheme) && !self.has("then") && !self.rings()
    }

    fn steps(&self) -> Vec<Value> {
        let stages = self.stages();
        let parts: usize = if self.ways.halves { 2 } else { 1 };
        let mut steps = Vec::new();
        if self.ways.later > 0.0 {
            steps.push(self.wait(&stages[0]));
        }
        let mut reached: Vec<Target> = Vec::new();
        let initial = self.pick("reference", &[0.0, 2.0]);
        for (number, stage) in stages.iter().enumerate() {
            let before: Vec<Option<[f64; 2]>> = stage
                .targets
                .iter()
                .map(|target| {
                    reached
                        .iter()
                        .rev()
                        .find(|old| {
                            std::mem::discriminant(&old.what) == std::mem::discriminant(&target.what)
                                && old.on == target.on
                        })
                        .map(|old| old.to)
                })
                .collect();
            for part in 0..parts {
                let mut step = Map::new();
                let name = if parts == 1 { stage.name.to_string() } else { format!("{}_{part}", stage.name) };
                let duration = self.duration() / parts as f64;
                let start = self.duration() * number as f64 + duration * part as f64;
                step.insert("name".into(), json!(name));
                step.insert("duration".into(), json!(self.write(Kind::Time, duration)));
                let (mut supports, mut loads) = (Vec::new(), Vec::new());
                if number == 0 && part == 0 {
                    self.increments(&mut step);
                    if self.ways.later == 0.0 {
                        self.first(&mut supports, &mut loads);
                    }
                }
                if part == 0 {
                    self.of_stage(number, &mut step, &mut loads);
                }
                if self.stabilized() && number == 0 && part == 0 {
                    step.insert("stabilize".into(), json!(1e-3));
                }
                if self.has("rupture") {
                    step.insert(
                        "rupture".into(),
                        json!({"slip_rate": self.frame.unit(Kind::Velocity) * 1.5 * DRAG / self.duration()}),
                    );
                }
                for (target, before) in stage.targets.iter().zip(&before) {
                    let start_value = before.unwrap_or(if target.what == What::Temperature {
                        [initial * self.ways.load, 0.0]
                    } else {
                        [0.0; 2]
                    });
                    let share = |k: usize, part: usize| {
                        start_value[k] + (target.to[k] - start_value[k]) * part as f64 / parts as f64
                    };
                    let change = Change {
                        from: [share(0, part), share(1, part)],
                        to: [share(0, part + 1), share(1, part + 1)],
                        start,
                        end: start + duration,
                        // where it goes on from a stage before, and where another follows
                        goes_on: [before.is_some() && number == 1, number == 0],
                    };
                    self.emit(target, &change, &mut step, &mut supports, &mut loads);
                }
                if self.has("until") && number == 0 && part + 1 == parts {
                    let force = 0.4 * PRESSURE * self.area();
                    step.insert("until".into(), json!({"on": self.group("block_top"), "force": self.write(Kind::Force, force * self.ways.load)}));
                }
                if !supports.is_empty() {
                    if self.ways.shuffled {
                        supports.reverse();
                    }
                    step.insert("supports".into(), supports.into());
                }
                if !loads.is_empty() {
                    if self.ways.shuffled {
                        loads.reverse();
                    }
                    step.insert("loads".into(), loads.into());
                }
                steps.push(step.into());
            }
            reached.extend(stage.targets.iter().cloned());
        }
        steps
    }

    /// A step in which nothing happens, before the first.
    fn wait(&self, first: &Stage) -> Value {
        let mut step = Map::new();
        let duration = self.ways.later * self.duration();
        step.insert("name".into(), json!("wait"));
        step.insert("duration".into(), json!(self.write(Kind::Time, duration)));
        self.increments(&mut step);
        if self.scheme != "explicit" {
            step.insert("dt".into(), json!({"initial": self.write(Kind::Time, duration)}));
        }
        let (mut supports, mut loads) = (Vec::new(), Vec::new());
        self.first(&mut supports, &mut loads);
        let change = Change { from: [0.0; 2], to: [0.0; 2], start: -duration, end: 0.0, goes_on: [false; 2] };
        for target in first.targets.iter().filter(|target| matches!(target.what, What::Support(_) | What::Angle)) {
            self.emit(target, &change, &mut step, &mut supports, &mut loads);
        }
        step.insert("supports".into(), supports.into());
        if !loads.is_empty() {
            step.insert("loads".into(), loads.into());
        }
        step.into()
    }

    /// Whether dashpots hold the block until contact does.
    fn stabilized(&self) -> bool {
        !matches!(self.draft.of("press"), "displacement" | "rotation")
            && !is_dynamic(self.scheme)
            && !self.has("spring")
    }

    /// Scheme and increments of the first stage.
    fn increments(&self, step: &mut Map<String, Value>) {
        self.of_scheme(self.scheme, step);
        if self.has("error_control") {
            let dt = self.write(Kind::Time, self.dt() / self.ways.finer);
            let error = self.write(Kind::Length, 2e-3 / self.ways.finer);
            let increments = json!({"initial": dt, "min": dt / 256.0, "max": 2.0 * dt, "error": error});
            step.insert("dt".into(), increments);
        }
    }

    /// A scheme and its increments.
    fn of_scheme(&self, scheme: &str, step: &mut Map<String, Value>) {
        let written = match scheme {
            "static" | "quasi_dynamic" => json!("static"),
            "hht" => json!({"hht": {"alpha": -0.1}}),
            "explicit" => json!({"explicit": {"safety": 0.9 / self.ways.finer}}),
            other => json!({other: {}}),
        };
        step.insert("scheme".into(), written);
        let dt = self.write(Kind::Time, self.dt() / self.ways.finer);
        // Shorter than stability asks, which looks at one foot of a mortar point and so at the order of its segments.
        let stable = self.write(Kind::Time, 2.5e-5 / self.ways.finer);
        let increments = match scheme {
            "explicit" => json!({"initial": stable, "max": stable}),
            _ => json!({"initial": dt, "min": dt / 8.0, "max": dt}),
        };
        step.insert("dt".into(), increments);
    }

    /// What does not change.
    fn first(&self, supports: &mut Vec<Value>, loads: &mut Vec<Value>) {
        let f = self.frame;
        if !self.is_rigid() {
            let zero = |_: f64| json!(0.0);
            supports.extend(f.supports(&json!(self.group("ground_bottom")), [Some(&zero), Some(&zero)]));
        }
        match self.draft.of("inclined") {
            "normal" => supports.push(json!({"on": self.group("ground_left"), "un": 0.0})),
            "direction" => {
                supports.push(json!({"on": self.group("ground_right"), "along": f.direction([1.0, 0.5]), "u": 0.0}))
            }
            _ => {}
        }
        let per_length = f.unit(Kind::Force) / f.length;
        match self.draft.of("spring") {
            "no" => {}
            value => {
                let on = if self.stabilized_by_spring() { "block_top" } else { "block_right" };
                let k = if on == "block_top" { 20.0 } else { 5.0 };
                let mut spring = json!({"kx": k * per_length, "ky": k * per_length});
                if value == "driven" {
                    // As an expression, for a number would be reached with the end of the step, and the steps may be others. From
                    // rest: what slides before there is a pressure weakens, or does not, by the sign of a gap of round-off.
                    let at = f.vector(Kind::Length, [0.001 * self.ways.load, 0.0]);
                    let span = self.write(Kind::Time, self.duration());
                    let risen = format!("max(0,min(1,(t-({}))/({span})))^2", self.at(0.0));
                    spring["driver"] =
                        json!({"x": format!("({})*{risen}", at[0]), "y": format!("({})*{risen}", at[1])});
                }
                loads.push(json!({"on": self.group(on), "spring": spring}));
            }
        }
        if self.is("tool", "free") {
            let k = 400.0 * per_length;
            loads.push(json!({"on": TOOL, "spring": {"kx": k, "ky": k}}));
        }
        if self.has("dashpot") {
            let c = 0.05 * per_length * f.time * self.duration();
            loads.push(json!({"on": self.group("block_left"), "dashpot": {"cx": c, "cy": c}}));
        }
        if self.has("absorbing") {
            loads.push(json!({"on": self.group("ground_right"), "absorbing": true}));
        }
        if self.ways.bystander {
            let (zero, [first, last]) = (|_: f64| json!(0.0), ASIDE);
            let bottom = |name: &str| json!(format!("{name}_bottom"));
            supports.extend(f.supports(&bottom(first), [Some(&zero), Some(&zero)]));
            if self.flies() {
                let k = 2.0 * per_length;
                for side in ["left", "right"] {
                    loads.push(json!({"on": format!("{last}_{side}"), "spring": {"kx": k, "ky": k}}));
                }
            } else {
                supports.extend(f.supports(&bottom(last), [Some(&zero), Some(&zero)]));
            }
        }
    }

    fn stabilized_by_spring(&self) -> bool {
        !matches!(self.draft.of("press"), "displacement" | "rotation") && !is_dynamic(self.scheme)
    }

    /// What a step changes at its beginning.
    fn of_stage(&self, number: usize, step: &mut Map<String, Value>, loads: &mut Vec<Value>) {
        if number == 1 {
            if self.is("spring", "ends") {
                let on = if self.stabilized_by_spring() { "block_top" } else { "block_right" };
                loads.push(json!({"on": self.group(on), "spring": null}));
            }
            if self.ways.bystander && self.flies() {
                for side in ["left", "right"] {
                    loads.push(json!({"on": format!("{}_{side}", ASIDE[1]), "spring": null}));
                }
            }
            if self.is("velocity", "launch") {
                step.insert("velocity".into(), self.velocities().into());
            }
            if self.is("damping", "of_step") {
                let bodies = [Some(self.names.block), self.ways.block_in_two.then_some("half")];
                let damping: Map<String, Value> =
                    bodies.into_iter().flatten().map(|body| (body.into(), self.damping(2.0))).collect();
                step.insert("damping".into(), damping.into());
            }
            if self.has("then") {
                self.of_scheme(self.draft.of("then"), step);
            }
            if self.scheme == "quasi_dynamic" {
                step.insert("scheme".into(), json!({"quasi_dynamic": {"tolerance": 1e-6 / self.ways.finer.powi(3)}}));
                step.insert("dt".into(), json!({"initial": self.write(Kind::Time, 1e-3 * self.duration())}));
            }
        }
    }

    /// How a quantity is led over a step, written along an axis of the frame: `scale` is sign and unit.
    fn drive(&self, [from, to]: [f64; 2], change: &Change, scale: f64, may_rate: bool) -> Value {
        let time = |t: f64| self.at(t);
        let span = self.write(Kind::Time, change.end - change.start);
        let mut drive = self.ways.drive.unwrap_or(self.draft.of("drive"));
        // Rates go on in the steps that follow, and a step that a reaction ends takes numbers alone where a support has them.
        let goes_on = self.is("section", "rings_on_end") || !may_rate;
        if drive == "rate" && goes_on || self.has("until") {
            drive = "number";
        }
        match drive {
            "table" => json!({"table": [[time(change.start), from * scale], [time(change.end), to * scale]]}),
            // It holds in the steps that follow as well.
            "expression" => json!(format!(
                "({})+({})*(min(t,{})-({}))",
                from * scale,
                (to - from) * scale / span,
                time(change.end),
                time(change.start)
            )),
            "rate" => json!({"rate": (to - from) * scale / span}),
            // At rest at both ends, or but where one stage follows another: there it goes on at one velocity.
            "smooth" | "through" => {
                let s = format!("max(0,min(1,(t-({}))/({span})))", time(change.start));
                let goes_on = change.goes_on.map(|goes_on| goes_on && drive == "through");
                let begins = if goes_on[0] { 1.5 * from * scale } else { 0.0 };
                let ends = if goes_on[1] { 1.5 * (to - from) * scale } else { 0.0 };
                let way = (to - from) * scale;
                let slopes = format!("({begins})*{s}*(1-{s})^2-({ends})*{s}^2*(1-{s})");
                json!(format!("({})+({way})*{s}^2*(3-2*{s})+{slopes}", from * scale))
            }
            _ => json!(to * scale),
        }
    }

    fn emit(
        &self,
        target: &Target,
        change: &Change,
        step: &mut Map<String, Value>,
        supports: &mut Vec<Value>,
        loads: &mut Vec<Value>,
    ) {
        let f = self.frame;
        let on = json!(target.on);
        let pair = |k: usize| [change.from[k], change.to[k]];
        let scalar = |kind: Kind, sign: f64| self.drive(pair(0), change, sign * f.unit(kind), false);
        let vector = |kind: Kind, unit: f64| {
            let component = |i: usize| {
                let along = [f.direction([1.0, 0.0])[i], f.direction([0.0, 1.0])[i]];
                let of = |v: [f64; 2]| along[0] * v[0] + along[1] * v[1];
                self.drive([of(change.from), of(change.to)], change, f.unit(kind) * unit, false)
            };
            // Rings have no weight along their radius.
            match target.what == What::Gravity && self.rings() {
                true => json!({"y": component(1)}),
                false => json!({"x": component(0), "y": component(1)}),
            }
        };
        match target.what {
            What::Support(held) => {
                let motion = |k: usize| move |sign: f64| self.drive(pair(k), change, sign * f.length, true);
                let [x, y] = [motion(0), motion(1)];
                supports
                    .extend(f.supports(&on, [held[0].then_some(&x as &dyn Fn(f64) -> Value), held[1].then_some(&y)]));
            }
            What::Rotation => {
                let angle = change.to[0] * f.sign();
                supports.push(json!({"on": on, "rotation": {"about": f.point([0.5, 2.0]), "angle": angle}}));
            }
            What::Angle => supports.push(json!({"on": on, "angle": self.drive(pair(0), change, f.sign(), true)})),
            What::Pressure => loads.push(json!({"on": on, "pressure": scalar(Kind::Stress, 1.0)})),
            What::DeadPressure => loads.push(json!({"on": on, "dead_pressure": scalar(Kind::Stress, 1.0)})),
            What::Traction => loads.push(json!({"on": on, "traction": vector(Kind::Stress, 1.0)})),
            What::TotalForce => loads.push(json!({"on": on, "total_force": vector(Kind::Force, 1.0)})),
            What::Force => loads.push(json!({"on": on, "force": vector(Kind::Force, 1.0)})),
            What::Gravity => {
                // Of quasi-static steps the density is light; what presses is its weight.
                loads.push(json!({"on": on, "gravity": vector(Kind::Velocity, 1.0 / f.time)}));
            }
            What::Moment => loads.push(json!({"on": on, "moment": scalar(Kind::Energy, f.sign())})),
            What::Temperature => {
                let value = match self.draft.of("heat") {
                    "table" => {
                        json!({"table": [[self.at(change.start), change.from[0]], [self.at(change.end), change.to[0]]]})
                    }
                    "by_place" => {
                        let share = format!("(T-({}))/({})", change.start, change.end - change.start);
                        json!(f.expression(
                            Kind::Number,
                            &format!(
                                "({}+({})*({share}))*(1+0.1*X*T/{})",
                                change.from[0],
                                change.to[0] - change.from[0],
                                self.duration()
                            ),
                            1.0
                        ))
                    }
                    _ => json!(change.to[0]),
                };
                let mut all = step.remove("temperature").and_then(|all| all.as_object().cloned()).unwrap_or_default();
                all.insert(target.on.clone(), value);
                step.insert("temperature".into(), all.into());
            }
        }
    }
}

/// Writes the numbers of a contact's friction, and of that on a part of it, as expressions of the time that stay the same from the
/// time `early` on. At the start those that say nothing of the first state of a point are a fifth larger: no increment ends there.
fn tell_in_time(contact: &mut Value, early: f64) {
    let told = |of: &mut Value| {
        let friction = of["friction"].clone();
        let of_first_state: &[&str] = match friction["law"].as_str() {
            Some("super_subloading") => &["mu_s", "mu_k"],
            Some("rate_and_state") => &["V_0", "D_c"],
            _ => &[],
        };
        let further = friction["parameters"].as_object().into_iter().flatten();
        for (name, value) in friction.as_object().into_iter().flatten().chain(further) {
            // These do not vary in time.
            let of_start = ["alpha_t", "structure", "theta"].contains(&name.as_str());
            let Some(value) = value.as_f64().filter(|_| !of_start) else { continue };
            let jump = if of_first_state.contains(&name.as_str()) { 0.0 } else { 0.2 };
            let along = &mut of["along"][name];
            if along.is_object() {
                continue;
            }
            let text = along.as_str().map_or(value.to_string(), str::to_owned);
            *along = json!(format!("({text})*(1+{jump}*max(0,1-t/{early}))"));
        }
    };
    told(contact);
    let parts = contact.pointer_mut("/along/law").and_then(Value::as_array_mut);
    parts.into_iter().flatten().for_each(told);
}

/// A quantity over one step.
struct Change {
    from: [f64; 2],
    to: [f64; 2],
    start: f64,
    end: f64,
    /// whether it moves as the step begins and as it ends, where its drive is "through"
    goes_on: [bool; 2],
}

/// Length of a stage.
pub fn duration(draft: &Draft) -> f64 {
    // Of what may go on explicitly, as short as waves take some times across.
    if moves(draft) || draft.has("rupture") { 0.02 } else { 1.0 }
}

/// Whether the surfaces lie apart at the start.
pub fn starts_apart(draft: &Draft) -> bool {
    draft.is("master", "itself")
        || !draft.has("shrink_fit")
            && !draft.has("tractions")
            && !draft.is("friction", "prescribed")
            && draft.pick("apart", &[0.0, 0.0, 1.0]) == 1.0
}
