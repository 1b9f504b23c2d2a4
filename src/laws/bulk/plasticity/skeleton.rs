//! The soil skeleton of [`SysCamClay`](super::SysCamClay): how overconsolidation, structure and anisotropy change as it yields, and the
//! equations of an increment.
//!
//! Equations are written for [`Number`]s: their derivatives are those of Newton's method and of the tangent, also through several parts of
//! an increment.

use nalgebra::{Matrix2, Vector2};

use super::LogarithmicBulk;
use crate::laws::approach::Approach;
use crate::laws::dual::{Dual, Number};

/// Components 11, 22, 33, 12 of a symmetric tensor.
pub(super) type Tensor<T> = [T; 4];

/// A number with its derivatives by the trial strains.
pub(super) type Varied = Dual<4>;

/// Constants of the skeleton, its rates per plastic strain. D = (λ̂ − κ̂)/M.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Skeleton {
    /// λ̂ − κ̂
    pub plastic: f64,
    /// M
    pub critical: f64,
    /// m/D: loss of overconsolidation; none where only the yield surface yields
    pub loosening: Option<f64>,
    /// a/D: loss of structure
    pub decay: f64,
    /// c_s: share of shear in it
    pub by_shear: f64,
    /// b_r/D: rotation
    pub turning: f64,
    /// m_b: limit of rotation
    pub limit: f64,
}

/// A state of the skeleton.
#[derive(Clone, Copy, Debug)]
pub(super) struct State<T> {
    /// ε_e
    pub strain: Tensor<T>,
    /// β
    pub rotation: Tensor<T>,
    /// R
    pub ratio: T,
    /// R*
    pub structure: T,
    /// p_c
    pub p_c: T,
}

/// What an increment starts with.
#[derive(Clone, Copy)]
struct Trial<T> {
    /// ε_v,tr
    compression: T,
    /// s_tr
    deviator: Tensor<T>,
    /// β_n
    rotation: Tensor<T>,
    /// R where it begins to yield
    ratio: T,
    /// R*_n
    structure: T,
    /// p_c,n
    p_c: T,
}

/// What it ends with, at some ε_v and Λ.
struct End<T> {
    /// What is left of (8)
    rest: [T; 2],
    /// ε_v
    compression: T,
    /// s
    deviator: Tensor<T>,
    rotation: Tensor<T>,
    ratio: T,
    structure: T,
    p_c: T,
}

/// Most iterations for the equations of an increment.
const ITERATIONS: usize = 60;

/// Tolerance of (8).
const LEFT: f64 = 1e-14;

/// Tolerance where no numbers are nearer to the root.
const ALMOST: f64 = 1e-11;

/// Least share of κ̂ for ε_v to begin with, where the trial stress is a tension.
const LOWEST: f64 = 0.1;

/// Least ε_v as a share of κ̂, and least Λ, between which and where there is too much of them a bisection begins.
const LEAST_COMPRESSION: f64 = 1e-30;
const LEAST_FLOW: f64 = 1e-40;

/// Least share of a step of Newton's method.
const SHORTEST: f64 = 1e-4;

/// By so much ln R may rise without yielding: round-off.
const ROUND_OFF: f64 = 1e-12;

/// Least R: U is infinite at 0.
const LEAST: f64 = 1e-60;

/// a:b
fn dot<T: Number>(a: &Tensor<T>, b: &Tensor<T>) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] * 2.0
}

/// x a + y b
fn sum<T: Number>([x, y]: [T; 2], [a, b]: [&Tensor<T>; 2]) -> Tensor<T> {
    std::array::from_fn(|k| x * a[k] + y * b[k])
}

/// A tensor without derivatives.
pub(super) fn values<T: Number>(tensor: &Tensor<T>) -> Tensor<f64> {
    tensor.map(T::value)
}

/// dev ε and −tr ε
fn parts<T: Number>(strain: &Tensor<T>) -> (Tensor<T>, T) {
    let third = (strain[0] + strain[1] + strain[2]) / 3.0;
    ([strain[0] - third, strain[1] - third, strain[2] - third, strain[3]], third * -3.0)
}

impl LogarithmicBulk {
    /// p of a compression.
    fn at<T: Number>(&self, compression: T) -> T {
        let [pressure, bulk] = self.pressure(compression.value());
        compression.map(pressure, bulk)
    }

    /// p and s of a strain.
    pub(super) fn stress<T: Number>(&self, strain: &Tensor<T>) -> (T, Tensor<T>) {
        let (deviator, compression) = parts(strain);
        (self.at(compression), deviator.map(|part| part * (2.0 * self.shear)))
    }
}

impl<T: Number> Trial<T> {
    /// The same in other numbers.
    fn of<S: Number>(&self, number: impl Fn(T) -> S + Copy) -> Trial<S> {
        Trial {
            compression: number(self.compression),
            deviator: self.deviator.map(number),
            rotation: self.rotation.map(number),
            ratio: number(self.ratio),
            structure: number(self.structure),
            p_c: number(self.p_c),
        }
    }
}

impl Skeleton {
    /// P: size of the surface through a stress, its pressure where q* = 0; infinite where there is no pressure.
    pub fn size<T: Number>(&self, pressure: T, deviator: &Tensor<T>, rotation: &Tensor<T>) -> T {
        if pressure.value() <= 0.0 {
            return T::from(f64::INFINITY);
        }
        let difference = sum([T::from(1.0), pressure * -1.0], [deviator, rotation]);
        pressure + dot(&difference, &difference) * (1.5 / (self.critical * self.critical)) / pressure
    }

    /// The share of a way between two stresses up to which P falls. P is convex along it.
    ///
    /// ```text
    /// P = p + w/p,   w = w₀ + w₁ t + w₂ t²,   p = p₀ + Δp t:     A Δp t² + 2A p₀ t + C = 0 where P does not change
    /// A = Δp² + w₂,   C = Δp (p₀² − w₀) + w₁ p₀ = p₀² dP/dt at the start
    /// ```
    pub fn least(&self, [from, to]: [f64; 2], deviators: [&Tensor<f64>; 2], rotation: &Tensor<f64>) -> f64 {
        let difference = [0, 1].map(|k| sum([1.0, -[from, to][k]], [deviators[k], rotation]));
        let (rise, change) = (to - from, sum([1.0, -1.0], [&difference[1], &difference[0]]));
        let share = 1.5 / (self.critical * self.critical);
        let w = [dot(&difference[0], &difference[0]), 2.0 * dot(&difference[0], &change), dot(&change, &change)]
            .map(|w| share * w);
        let (a, c) = (rise * rise + w[2], rise * (from * from - w[0]) + w[1] * from);
        if from <= 0.0 || c >= 0.0 {
            return 0.0;
        }
        let root = (a * a * from * from - a * rise * c).max(0.0).sqrt();
        (-c / (a * from + root)).min(1.0)
    }

    /// R after a plastic strain ‖Δε_p‖, (4).
    fn ratio<T: Number>(&self, old: T, strain: T) -> T {
        let Some(rate) = self.loosening.filter(|_| old.value() < 1.0) else { return T::from(1.0) };
        let here = Approach::Logarithmic.after(old.value(), rate * strain.value());
        strain.map(here.y, rate * here.rate) + old.map(0.0, here.rate / -old.value().ln())
    }

    /// R* after plastic strains, (5).
    fn structure<T: Number>(&self, old: T, [shear, compression]: [T; 2]) -> T {
        let loss = (shear * self.by_shear + compression * (1.0 - self.by_shear)) * self.decay;
        old / (old + (T::from(1.0) - old) * (loss * -1.0).exp())
    }

    /// The end of an increment at ε_v and Λ.
    fn end<T: Number>(&self, elastic: &LogarithmicBulk, trial: &Trial<T>, [compression, flow]: [T; 2]) -> End<T> {
        let square = self.critical * self.critical;
        let pressure = elastic.at(compression);
        let way = Way {
            ratio: trial.deviator.map(|part| part / pressure),
            softer: flow / pressure * (6.0 * elastic.shear / square) + 1.0,
            turning: flow * (self.turning * 6f64.sqrt() / square),
            limit: self.limit,
            rotation: trial.rotation,
        };
        let size = way.size();
        let difference = way.difference(size);
        let rotation = way.rotation(size, &difference);
        let over = size * size * (1.5 / square);
        let dilation = T::from(1.0) - over - dot(&difference, &rotation) * (3.0 / square);
        let shear = flow * size * (6f64.sqrt() / square);
        let volume = flow * dilation;
        let strain = flow * (dilation * dilation / 3.0 + size * size * (9.0 / (square * square))).sqrt();
        let ratio = self.ratio(trial.ratio, strain);
        let structure = self.structure(trial.structure, [shear, volume]);
        let hardening = volume / self.plastic;
        let rest = [
            (compression + volume - trial.compression) / elastic.kappa,
            (pressure * (over + 1.0) * structure / (ratio * trial.p_c)).ln() - hardening,
        ];
        let deviator = sum([pressure, pressure], [&difference, &rotation]);
        End { rest, compression, deviator, rotation, ratio, structure, p_c: trial.p_c * hardening.exp() }
    }

    /// What is left of (8) at ε_v and Λ, and its derivatives by them.
    fn rest(&self, elastic: &LogarithmicBulk, trial: &Trial<f64>, x: &Vector2<f64>) -> (Vector2<f64>, Matrix2<f64>) {
        let varied = [0, 1].map(|k| Dual { value: x[k], by: [0, 1].map(|j| unit(j, k)) });
        let [a, b] = self.end(elastic, &trial.of(Dual::<2>::from), varied).rest;
        (Vector2::new(a.value, b.value), Matrix2::new(a.by[0], a.by[1], b.by[0], b.by[1]))
    }

    /// ε_v and Λ of the end by Newton's method, from no flow or from little pressure, and where neither finds them by bisection; or what is
    /// left of (8).
    fn solved(&self, elastic: &LogarithmicBulk, trial: &Trial<f64>) -> Result<Vector2<f64>, f64> {
        let from_no_flow = Vector2::new(trial.compression.max(LOWEST * elastic.kappa), 0.0);
        self.newton(elastic, trial, from_no_flow).or_else(|left| {
            let from_little = self.little_pressure(elastic, trial).and_then(|x| self.newton(elastic, trial, x).ok());
            from_little.or_else(|| self.bisected(elastic, trial)).ok_or(left)
        })
    }

    /// ε_v and Λ of (8) after a tension V = −ε_v,tr, near half of the Λ at which there is no pressure, without rotation.
    ///
    /// ```text
    /// η* = M √(1 + V/Λ),   p = q_tr/η* − 6GΛ/M²,   0 at Λ (Λ + V) = (M q_tr/6G)²
    /// ```
    fn little_pressure(&self, elastic: &LogarithmicBulk, trial: &Trial<f64>) -> Option<Vector2<f64>> {
        let (opened, q) = (-trial.compression, (1.5 * dot(&trial.deviator, &trial.deviator)).sqrt());
        let root = self.critical * q / (6.0 * elastic.shear);
        let flow = 0.5 * root * root / opened.max(root);
        let pressure = q / (self.critical * (1.0 + opened / flow).sqrt())
            - 6.0 * elastic.shear * flow / (self.critical * self.critical);
        (opened > 0.0 && pressure > 0.0).then(|| Vector2::new(elastic.compression(pressure), flow))
    }

    /// ε_v and Λ by Newton's method, damped; or what is left of (8).
    fn newton(&self, elastic: &LogarithmicBulk, trial: &Trial<f64>, start: Vector2<f64>) -> Result<Vector2<f64>, f64> {
        let at = |x: &Vector2<f64>| {
            let (rest, slopes) = self.rest(elastic, trial, x);
            (rest, slopes, if rest.amax().is_nan() { f64::INFINITY } else { rest.amax() })
        };
        let mut x = start;
        let mut here = at(&x);
        for _ in 0..ITERATIONS {
            let (rest, slopes, size) = here;
            let step = slopes.try_inverse().map_or(Vector2::repeat(f64::NAN), |inverse| -inverse * rest);
            // The root that is met first is where f falls with Λ.
            let first = slopes.determinant() < 0.0;
            if size <= LEFT && first {
                return Ok(x);
            }
            let down = |k: usize, least: f64| if step[k] < 0.0 { (least - x[k]) / step[k] } else { 1.0 };
            let mut share = down(0, 0.1 * x[0]).min(down(1, 0.1 * x[1])).min(1.0);
            let next = loop {
                let next = x + share * step;
                let there = at(&next);
                if share > 0.0 && there.2 < size {
                    break Some((next, there));
                }
                share *= 0.5;
                if share.is_nan() || share < SHORTEST {
                    break None;
                }
            };
            match next {
                Some((next, there)) => (x, here) = (next, there),
                None if size <= ALMOST && first => return Ok(x),
                None => return Err(size),
            }
        }
        Err(here.2)
    }

    /// ε_v and Λ of the end by bisection, which finds them at any pressure. The first of (8) rises with ε_v: from below zero, unless Λ is too
    /// large. With that ε_v the second falls with Λ, from above zero.
    fn bisected(&self, elastic: &LogarithmicBulk, trial: &Trial<f64>) -> Option<Vector2<f64>> {
        let rest = |compression: f64, flow: f64| self.end(elastic, trial, [compression, flow]).rest;
        let compression = |flow: f64| {
            let is_low = |compression: f64| rest(compression, flow)[0] < 0.0;
            let least = LEAST_COMPRESSION * elastic.kappa;
            is_low(least).then(|| last(least, elastic.kappa, is_low))
        };
        let is_low = |flow: f64| compression(flow).is_some_and(|compression| rest(compression, flow)[1] > 0.0);
        let flow = last(LEAST_FLOW, 10.0 * LEAST_FLOW, is_low);
        let found = [compression(flow)?, flow];
        let [a, b] = rest(found[0], found[1]);
        (a.abs().max(b.abs()) <= ALMOST).then(|| found.into())
    }

    /// The state after trial strains, with its derivatives by them; or what is left of (8).
    fn step(
        &self,
        elastic: &LogarithmicBulk,
        old: &State<Varied>,
        strain: &Tensor<Varied>,
    ) -> Result<State<Varied>, f64> {
        let [before, after] = [&old.strain, strain].map(|strain| elastic.stress(strain));
        let ratio_of =
            |stress: &(Varied, Tensor<Varied>)| self.size(stress.0, &stress.1, &old.rotation) * old.structure / old.p_c;
        let mut start = Varied::from(1.0);
        if self.loosening.is_some() {
            let [from, to] = [&before, &after].map(|stress| (stress.0.value, values(&stress.1)));
            let share = self.least([from.0, to.0], [&from.1, &to.1], &values(&old.rotation));
            // Where P does not change with the share, neither does R with its derivatives.
            let [rest, share] = [1.0 - share, share].map(Varied::from);
            let lowest = (before.0 * rest + after.0 * share, sum([rest, share], [&before.1, &after.1]));
            start = old.ratio.min(if share.value > 0.0 { ratio_of(&lowest) } else { old.ratio });
            start = start.min(1.0.into()).max(LEAST.into());
        }
        let reached = ratio_of(&after);
        if (reached.value / start.value).ln() <= ROUND_OFF {
            return Ok(State { strain: *strain, ratio: reached, ..*old });
        }
        let (_, compression) = parts(strain);
        let (rotation, structure, p_c) = (old.rotation, old.structure, old.p_c);
        let trial = Trial { compression, deviator: after.1, rotation, ratio: start, structure, p_c };
        self.yielded(elastic, &trial)
    }

    /// The state at the end of an increment that yields. Derivatives of ε_v and Λ are those of the root of (8).
    fn yielded(&self, elastic: &LogarithmicBulk, trial: &Trial<Varied>) -> Result<State<Varied>, f64> {
        let plain = trial.of(Varied::value);
        let root = self.solved(elastic, &plain)?;
        let inverse = self.rest(elastic, &plain, &root).1.try_inverse().ok_or(f64::INFINITY)?;
        let [a, b] = self.end(elastic, trial, [root[0], root[1]].map(Varied::from)).rest.map(|rest| rest.by);
        let by: [Vector2<f64>; 4] = std::array::from_fn(|k| -inverse * Vector2::new(a[k], b[k]));
        let end = self.end(elastic, trial, [0, 1].map(|j| Dual { value: root[j], by: by.map(|by| by[j]) }));
        let third = end.compression / -3.0;
        let [xx, yy, zz, xy] = end.deviator.map(|part| part / (2.0 * elastic.shear));
        Ok(State {
            strain: [xx + third, yy + third, zz + third, xy],
            rotation: end.rotation,
            ratio: end.ratio,
            structure: end.structure,
            p_c: end.p_c,
        })
    }

    /// The state after trial strains, the way to them being divided into equal parts; or what is left of (8).
    pub fn followed(
        &self,
        elastic: &LogarithmicBulk,
        old: &State<f64>,
        trial: &Tensor<f64>,
        parts: u32,
    ) -> Result<State<Varied>, f64> {
        let share = 1.0 / f64::from(parts);
        let part: Tensor<Varied> = std::array::from_fn(|k| Dual {
            value: share * (trial[k] - old.strain[k]),
            by: std::array::from_fn(|j| share * unit(j, k)),
        });
        let mut state = old.of(Varied::from);
        for _ in 0..parts {
            let strain = std::array::from_fn(|k| state.strain[k] + part[k]);
            state = self.step(elastic, &state, &strain)?;
        }
        Ok(state)
    }
}

/// The last number that is low, from a positive one that is, by bisection of orders of magnitude and then of the number itself; the first
/// guess of one that is not is multiplied by ten as long as it is low.
fn last(mut low: f64, mut high: f64, is_low: impl Fn(f64) -> bool) -> f64 {
    while high.is_finite() && is_low(high) {
        (low, high) = (high, 10.0 * high);
    }
    loop {
        let middle = if low < 0.5 * high { (low * high).sqrt() } else { 0.5 * (low + high) };
        if !(middle > low && middle < high) {
            return low;
        }
        if is_low(middle) { low = middle } else { high = middle }
    }
}

/// δ_jk
fn unit(j: usize, k: usize) -> f64 {
    if j == k { 1.0 } else { 0.0 }
}

impl State<f64> {
    /// The same in other numbers.
    fn of<S: Number>(&self, number: impl Fn(f64) -> S + Copy) -> State<S> {
        State {
            strain: self.strain.map(number),
            rotation: self.rotation.map(number),
            ratio: number(self.ratio),
            structure: number(self.structure),
            p_c: number(self.p_c),
        }
    }
}

/// From the trial stress to η̂ and β of the end, which are combinations of s_tr and β_n, (9).
struct Way<T> {
    /// s_tr/p
    ratio: Tensor<T>,
    /// 1 + c
    softer: T,
    /// x/‖η̂‖²
    turning: T,
    /// m_b
    limit: f64,
    /// β_n
    rotation: Tensor<T>,
}

impl<T: Number> Way<T> {
    /// η̂ with some ‖η̂‖ on the right of (9).
    fn difference(&self, size: T) -> Tensor<T> {
        let (turned, limit) = (self.turning * size * size + 1.0, self.turning * size * self.limit);
        let whole = self.softer * turned + limit;
        sum([turned / whole, T::from(-1.0) / whole], [&self.ratio, &self.rotation])
    }

    /// β after (6).
    fn rotation(&self, size: T, difference: &Tensor<T>) -> Tensor<T> {
        let turned = self.turning * size * size + 1.0;
        sum([T::from(1.0) / turned, self.turning * size * self.limit / turned], [&self.rotation, difference])
    }

    /// ‖η̂‖ with some ‖η̂‖ on the right of (9).
    fn length(&self, size: T) -> T {
        let difference = self.difference(size);
        dot(&difference, &difference).sqrt()
    }

    /// The same in other numbers.
    fn of<S: Number>(&self, number: impl Fn(T) -> S + Copy) -> Way<S> {
        let Self { ratio, softer, turning, limit, rotation } = *self;
        Way {
            ratio: ratio.map(number),
            softer: number(softer),
            turning: number(turning),
            limit,
            rotation: rotation.map(number),
        }
    }

    /// ‖η̂‖ of (9), by Newton's method within a bracket.
    fn size(&self) -> T {
        if self.turning.value() == 0.0 {
            return self.length(T::from(0.0));
        }
        let plain = self.of(|number| Dual::<1>::from(number.value()));
        let at = |size: f64| {
            let length = plain.length(Dual { value: size, by: [1.0] });
            [size - length.value, 1.0 - length.by[0]]
        };
        let [low, most] = [&plain.ratio, &plain.rotation].map(|tensor| dot(tensor, tensor).value.sqrt());
        let [mut low, mut high] = [0.0, low + most];
        let mut root = plain.length(0.0.into()).value;
        for _ in 0..ITERATIONS {
            let [rest, slope] = at(root);
            if rest > 0.0 {
                high = root
            } else {
                low = root
            }
            let next = root - rest / slope;
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            if next == root || rest.abs() <= f64::EPSILON * root {
                break;
            }
            root = next;
        }
        self.length(T::from(root)).map(root, 1.0 / at(root)[1])
    }
}
