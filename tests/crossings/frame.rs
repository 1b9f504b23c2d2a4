//! How the same problem is written: where its origin lies, how its axes are turned, in what units.
//!
//! Models are drawn in canonical coordinates: the contact along y = 0, the block above. A section lays these into its own plane, a
//! frame moves, turns and mirrors that, and takes units. Coordinates are multiples of 2⁻¹⁶, so that a translation by 2²⁰ rounds none.

use serde_json::{Value, json};

/// Units and place of a model.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Canonical to written directions, with units of length: x = A X + b
    matrix: [[f64; 2]; 2],
    offset: [f64; 2],
    /// units of length, stress and time
    pub length: f64,
    pub stress: f64,
    pub time: f64,
    /// whether forces count a thickness or a full turn
    pub thick: bool,
    /// whether supports along axes are written as inclined ones
    pub inclined: bool,
    /// when time 0 is, as written
    pub later: f64,
}

/// What a number of a result is, which says how it is written in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    Time,
    Number,
    Length,
    Area,
    Volume,
    Flow,
    Velocity,
    Stress,
    Force,
    Energy,
    Power,
    Momentum,
    AngularMomentum,
    /// of waves: a velocity that others are not measured by
    WaveSpeed,
    Share,
}

impl Frame {
    /// A section laid into its plane: planes as they are, rings moved or turned by a quarter to their radius.
    pub fn of_section(section: &str, radius: f64) -> Self {
        let turned = section == "rings_around";
        let matrix = if turned { [[0.0, -1.0], [1.0, 0.0]] } else { [[1.0, 0.0], [0.0, 1.0]] };
        let offset = if section.starts_with("rings") { [radius, 0.0] } else { [0.0, 0.0] };
        let thick = section != "plane_strain";
        Self { matrix, offset, length: 1.0, stress: 1.0, time: 1.0, thick, inclined: false, later: 0.0 }
    }

    pub fn moved(mut self, by: [f64; 2]) -> Self {
        self.offset = [self.offset[0] + by[0], self.offset[1] + by[1]];
        self
    }

    /// Turned about the origin; by an exact quarter where the angle is a right one.
    pub fn turned(self, degrees: f64) -> Self {
        let (sin, cos) = if degrees == 90.0 { (1.0, 0.0) } else { degrees.to_radians().sin_cos() };
        self.then([[cos, -sin], [sin, cos]])
    }

    /// Mirrored along x (0) or y (1).
    pub fn mirrored(self, axis: usize) -> Self {
        self.then(if axis == 0 { [[-1.0, 0.0], [0.0, 1.0]] } else { [[1.0, 0.0], [0.0, -1.0]] })
    }

    pub fn units(mut self, length: f64, stress: f64, time: f64) -> Self {
        self = self.then([[length, 0.0], [0.0, length]]);
        (self.length, self.stress, self.time) = (self.length * length, self.stress * stress, self.time * time);
        self
    }

    fn then(mut self, m: [[f64; 2]; 2]) -> Self {
        let apply = |v: [f64; 2]| [m[0][0] * v[0] + m[0][1] * v[1], m[1][0] * v[0] + m[1][1] * v[1]];
        let columns = [0, 1].map(|k| apply([self.matrix[0][k], self.matrix[1][k]]));
        self.matrix = [[columns[0][0], columns[1][0]], [columns[0][1], columns[1][1]]];
        self.offset = apply(self.offset);
        self
    }

    /// Whether the sense of turning is another.
    pub fn flips(&self) -> bool {
        let [[a, b], [c, d]] = self.matrix;
        a * d - b * c < 0.0
    }

    pub fn sign(&self) -> f64 {
        if self.flips() { -1.0 } else { 1.0 }
    }

    /// A canonical direction as written.
    pub fn direction(&self, v: [f64; 2]) -> [f64; 2] {
        let m = &self.matrix;
        [m[0][0] * v[0] + m[0][1] * v[1], m[1][0] * v[0] + m[1][1] * v[1]].map(|x| x / self.length)
    }

    /// A written direction in canonical axes.
    pub fn canonical(&self, v: [f64; 2]) -> [f64; 2] {
        let m = &self.matrix;
        [m[0][0] * v[0] + m[1][0] * v[1], m[0][1] * v[0] + m[1][1] * v[1]].map(|x| x / self.length)
    }

    pub fn point(&self, p: [f64; 2]) -> [f64; 2] {
        let d = self.direction(p);
        [0, 1].map(|i| d[i] * self.length + self.offset[i])
    }

    /// The canonical place of a written point.
    pub fn place(&self, p: [f64; 2]) -> [f64; 2] {
        self.canonical([p[0] - self.offset[0], p[1] - self.offset[1]]).map(|x| x / self.length)
    }

    /// What a unit of a kind is written as.
    pub fn unit(&self, kind: Kind) -> f64 {
        let Self { length, stress, time, .. } = *self;
        let area = if self.thick { length * length } else { length };
        let force = stress * area;
        match kind {
            Kind::Time => time,
            Kind::Number | Kind::Share => 1.0,
            Kind::Length => length,
            Kind::Area => area,
            Kind::Volume => area * length,
            Kind::Flow => area * length / time,
            Kind::Velocity | Kind::WaveSpeed => length / time,
            Kind::Stress => stress,
            Kind::Force => force,
            Kind::Energy => force * length,
            Kind::Power => force * length / time,
            Kind::Momentum => force * time,
            Kind::AngularMomentum => force * time * length,
        }
    }

    /// A time as written.
    pub fn at(&self, time: f64) -> f64 {
        self.later + self.time * time
    }

    pub fn write(&self, kind: Kind, x: f64) -> f64 {
        x * self.unit(kind)
    }

    pub fn vector(&self, kind: Kind, v: [f64; 2]) -> [f64; 2] {
        self.direction(v).map(|x| self.write(kind, x))
    }

    /// A tensor of the plane (xx, yy, xy) as written.
    pub fn tensor(&self, [xx, yy, xy]: [f64; 3]) -> [f64; 3] {
        let rows = [self.direction([1.0, 0.0]), self.direction([0.0, 1.0])];
        let s = [[xx, xy], [xy, yy]];
        let at = |i: usize, j: usize| {
            (0..2)
                .flat_map(|k| (0..2).map(move |l| (k, l)))
                .map(|(k, l)| rows[k][i] * s[k][l] * rows[l][j])
                .sum::<f64>()
        };
        [at(0, 0), at(1, 1), at(0, 1)]
    }

    /// A written tensor of the plane in canonical axes.
    pub fn canonical_tensor(&self, [xx, yy, xy]: [f64; 3]) -> [f64; 3] {
        let rows = [self.direction([1.0, 0.0]), self.direction([0.0, 1.0])];
        let s = [[xx, xy], [xy, yy]];
        let at = |i: usize, j: usize| {
            (0..2)
                .flat_map(|k| (0..2).map(move |l| (k, l)))
                .map(|(k, l)| rows[i][k] * s[k][l] * rows[j][l])
                .sum::<f64>()
        };
        [at(0, 0), at(1, 1), at(0, 1)]
    }

    /// An expression in the canonical X, Y and T, in units of a kind; expressions of rings and planes alike.
    pub fn expression(&self, kind: Kind, text: &str, sign: f64) -> String {
        let Self { matrix: m, offset: [bx, by], length, time, later, .. } = self;
        let l2 = length * length;
        let along = |k: usize| format!("(({})*(x-({bx}))+({})*(y-({by})))", m[0][k] / l2, m[1][k] / l2);
        let text =
            text.replace('X', &along(0)).replace('Y', &along(1)).replace('T', &format!("((t-({later}))/({time}))"));
        format!("({})*({text})", sign * self.unit(kind))
    }

    /// Supports of a place along canonical axes; each motion is made by `motion` from the sign with which it is written.
    pub fn supports(&self, on: &Value, motions: [Option<&dyn Fn(f64) -> Value>; 2]) -> Vec<Value> {
        let along_axes = self.direction([1.0, 0.0]).iter().all(|x| x.abs() == 1.0 || *x == 0.0) && !self.inclined;
        let mut merged = serde_json::Map::new();
        let mut supports = Vec::new();
        for (k, motion) in motions.iter().enumerate().filter_map(|(k, motion)| Some((k, (*motion)?))) {
            let d = self.direction(if k == 0 { [1.0, 0.0] } else { [0.0, 1.0] });
            if along_axes {
                let axis = if d[0] == 0.0 { 1 } else { 0 };
                merged.insert(["ux", "uy"][axis].into(), motion(d[axis]));
            } else {
                supports.push(json!({"on": on, "along": d, "u": motion(1.0)}));
            }
        }
        if !merged.is_empty() {
            merged.insert("on".into(), on.clone());
            supports.push(merged.into());
        }
        supports
    }
}
