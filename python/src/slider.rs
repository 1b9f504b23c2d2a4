//! Spring-sliders: a mass on a friction law, pulled by the spring of a machine.

use fecontact::laws::friction::sensitivity::{Direction, Variation};
use fecontact::laws::friction::{FrictionLaw, FrictionResponse, FrictionState, LawFailure, SensitiveLaw, Sliding};
use fecontact::run::error::Error;
use numpy::ndarray::Array2;
use numpy::{IntoPyArray, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use rayon::prelude::*;
use serde_json::{Value, json};

use crate::law::{LawPath, Refusal, documents};
use crate::pool::{Pool, Raised};

/// What a ride answers, in this order, before ∂F/∂parameter for those asked for.
const COLUMNS: [&str; 3] = ["force", "slip", "slip_rate"];

/// Ride spring-sliders along a path of the load point: `time` (n), `load_point` and `pressure` (sets or 1, n), a JSON text, k and M
/// a set. Returns arrays (sets, n) by name, also of ∂F/∂parameter for the parameters of `by`.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // those of Python
pub fn ride<'py>(
    py: Python<'py>,
    parameters: Vec<String>,
    machine: PyReadonlyArray2<f64>,
    time: PyReadonlyArray1<f64>,
    load_point: PyReadonlyArray2<f64>,
    pressure: PyReadonlyArray2<f64>,
    start: (f64, f64),
    by: Vec<String>,
    threads: Option<i64>,
) -> PyResult<Vec<(String, Bound<'py, PyArray2<f64>>)>> {
    let parameters = documents(&parameters)?;
    let (machine, time) = (machine.as_array().to_owned(), time.as_array().to_vec());
    let (load_point, pressure) = (load_point.as_array().to_owned(), pressure.as_array().to_owned());
    let course = LawPath { time: &time, slip: &load_point, pressure: &pressure, opening: None };
    let pool = Pool::new(threads)?;
    let one = |(k, parameters): (usize, &Value)| {
        ridden(&course, (k, parameters), [machine[[k, 0]], machine[[k, 1]]], start, (&by, &pool.raised))
    };
    let ridden: Vec<_> = pool.watched(py, || parameters.par_iter().enumerate().map(one).collect())?;
    if let Some(raised) = pool.raised.take() {
        return Err(raised);
    }
    let ridden: Vec<_> = ridden.into_iter().collect::<Result<_, _>>().map_err(|refusal: Refusal| refusal.raised(py))?;
    let names = COLUMNS.map(String::from).into_iter().chain(by.iter().map(|name| format!("dforce_d{name}")));
    let column = |at: usize| Array2::from_shape_fn((ridden.len(), time.len()), |(k, i)| ridden[k][at][i]);
    Ok(names.enumerate().map(|(at, name)| (name, column(at).into_pyarray(py))).collect())
}

/// Columns of one ride.
fn ridden(
    course: &LawPath,
    (k, parameters): (usize, &Value),
    [stiffness, mass]: [f64; 2],
    (initial, tolerance): (f64, f64),
    (by, raised): (&[String], &Raised),
) -> Result<Vec<Vec<f64>>, Refusal> {
    if raised.is_set() {
        return Err(Refusal::Stopped(Error::Interrupted.to_string()));
    }
    let test = course.test(k, parameters, &json!({"initial": {"traction": initial}})).map_err(Refusal::Case)?;
    let course = course.rows(k);
    let slider = Slider { law: &*test.law.law, start: test.start, stiffness, mass, course: &course, tolerance, raised };
    let set = if k > 0 { format!("parameter set {k}: ") } else { String::new() };
    let stopped = |halt: Halt| match halt {
        Halt::Raised => Refusal::Stopped(Error::Interrupted.to_string()),
        Halt::Law(time, cause) => Refusal::Stopped(format!("{set}{}", Error::Law { time, cause })),
        Halt::Long(time) => Refusal::Stopped(format!(
            "{set}the slider takes too many steps at the time {time}: check mass and stiffness, or raise the tolerance"
        )),
    };
    let ride = slider.ride(!by.is_empty()).map_err(stopped)?;
    let mut columns: Vec<Vec<f64>> = (0..3).map(|at| ride.rows.iter().map(|row| row[at]).collect()).collect();
    if let Some(law) = test.law.law.sensitivities().filter(|_| !by.is_empty()) {
        columns.extend(slider.varied(&ride, law, by).map_err(|cause| stopped(Halt::Law(course[0][0], cause)))?);
    }
    Ok(columns)
}

/// A spring-slider per area, at rest and in equilibrium at the start.
///
/// ```text
/// M ü = F − q,   F = q₀ + k (w − u)        w: load point, u: slip, q: the law's answer to u, p and t
/// ```
/// Steps are those of Newmark's method with constant average acceleration: samples are halved, and halved again, until
/// (k + ∂q/∂u) h²/12 |Δü|, the error of a step in F and q, is below the tolerance times the largest pressure.
struct Slider<'a> {
    law: &'a dyn FrictionLaw,
    start: FrictionState,
    /// k [F/L³]
    stiffness: f64,
    /// M > 0 [F T²/L³]
    mass: f64,
    /// t [T], w [L] and p [F/L²] of the samples
    course: &'a [[f64; 3]],
    /// Error of a step in F and q, as a share of the largest pressure
    tolerance: f64,
    /// what ends it before its time
    raised: &'a Raised,
}

/// Where the slider is.
#[derive(Clone, Copy)]
struct Motion {
    /// u [L]
    slip: f64,
    /// u̇ [L/T]
    rate: f64,
    /// ü [L/T²]
    acceleration: f64,
    /// Change of ü over the last step, per time, from which the next one starts [L/T³]
    jerk: f64,
}

/// One step that was taken: from where, how, and to where.
struct Step {
    old: FrictionState,
    sliding: Sliding,
    from: Motion,
    to: Motion,
    load_point: f64,
    sampled: bool,
}

/// What a slider has done: F, u and u̇ at the samples.
struct Ride {
    rows: Vec<[f64; 3]>,
    steps: Vec<Step>,
}

/// Why it came to no end.
enum Halt {
    Law(f64, LawFailure),
    Long(f64),
    Raised,
}

/// A sample is 2⁴⁰ of the shortest steps.
const WHOLE: u64 = 1 << 40;
/// More steps than this are a slip of the keyboard.
const MOST_STEPS: usize = 5_000_000;
/// Newton's method: most iterations of a step, and when it is solved, as a share of the tolerance.
const MOST_ITERATIONS: usize = 12;
const SOLVED: f64 = 1e-4;
/// A step is doubled where its error is below this share of what is allowed: errors go with the third power.
const DOUBLED: f64 = 1.0 / 16.0;

impl Slider<'_> {
    /// The ride, with its steps if they are to be kept.
    fn ride(&self, keep: bool) -> Result<Ride, Halt> {
        let scale = self.course.iter().map(|[_, _, pressure]| pressure.abs()).fold(0.0, f64::max);
        let mut motion = Motion { slip: 0.0, rate: 0.0, acceleration: 0.0, jerk: 0.0 };
        let mut state = self.start.clone();
        let mut ride = Ride { rows: vec![self.row(self.course[0][1], &motion)], steps: Vec::new() };
        let (mut longest, mut taken) = (f64::INFINITY, 0);
        for pair in self.course.windows(2) {
            let [[from, w0, p0], [to, w1, p1]] = [pair[0], pair[1]];
            let (mut at, mut step) = (0, WHOLE);
            while (to - from) * share(step) > longest && step > 1 {
                step /= 2;
            }
            while at < WHOLE {
                if self.raised.is_set() {
                    return Err(Halt::Raised);
                }
                let dt = (to - from) * share(step);
                let x = share(at + step);
                let (load_point, pressure) = (w0 + x * (w1 - w0), p0 + x * (p1 - p0));
                let next = self.step((&state, &motion), (load_point, pressure, dt), scale);
                let error = next.as_ref().map_or(f64::INFINITY, |(answer, end)| {
                    let stiffness = self.stiffness + answer.dtraction_dslip.max(0.0);
                    stiffness * dt * dt / 12.0 * (end.acceleration - motion.acceleration).abs()
                });
                let allowed = self.tolerance * scale;
                if error > allowed || error.is_nan() {
                    if step == 1 || taken >= MOST_STEPS {
                        let time = from + (to - from) * share(at);
                        return Err(next.err().flatten().map_or(Halt::Long(time), |cause| Halt::Law(time, cause)));
                    }
                    step /= 2;
                    continue;
                }
                let Ok((answer, end)) = next else { return Err(Halt::Long(from)) };
                let sliding = Sliding { slip: end.slip - motion.slip, pressure, dt };
                at += step;
                taken += 1;
                if keep {
                    ride.steps.push(Step {
                        old: state,
                        sliding,
                        from: motion,
                        to: end,
                        load_point,
                        sampled: at == WHOLE,
                    });
                }
                (state, motion) = (answer.state, end);
                let doubles = error < DOUBLED * allowed;
                longest = if doubles { 2.0 * dt } else { dt };
                if doubles && at % (2 * step) == 0 && 2 * step <= WHOLE {
                    step *= 2;
                }
            }
            ride.rows.push(self.row(w1, &motion));
        }
        Ok(ride)
    }

    fn row(&self, load_point: f64, motion: &Motion) -> [f64; 3] {
        let force = self.start.traction + self.stiffness * (load_point - self.course[0][1] - motion.slip);
        [force, motion.slip, motion.rate]
    }

    /// The answer of the law and the motion at the end of a step; no failure of the law where it is not solved.
    fn step(
        &self,
        (state, from): (&FrictionState, &Motion),
        (load_point, pressure, dt): (f64, f64, f64),
        scale: f64,
    ) -> Result<(FrictionResponse, Motion), Option<LawFailure>> {
        let per = 4.0 * self.mass / (dt * dt);
        let driven = self.start.traction + self.stiffness * (load_point - self.course[0][1] - from.slip);
        let solved = SOLVED * self.tolerance * scale;
        let mut slip = dt * (from.rate + dt * (0.5 * from.acceleration + 0.25 * dt * from.jerk));
        for _ in 0..MOST_ITERATIONS {
            let answer = self.law.respond(state, Sliding { slip, pressure, dt }).map_err(Some)?;
            let inertia = per * (slip - dt * from.rate) - self.mass * from.acceleration;
            let residual = driven - self.stiffness * slip - answer.state.traction - inertia;
            let round_off = 4.0 * f64::EPSILON * (per * slip.abs() + inertia.abs());
            if residual.abs() <= solved + round_off {
                let rate = 2.0 * slip / dt - from.rate;
                let acceleration = inertia / self.mass;
                let jerk = (acceleration - from.acceleration) / dt;
                return Ok((answer, Motion { slip: from.slip + slip, rate, acceleration, jerk }));
            }
            slip += residual / (per + self.stiffness + answer.dtraction_dslip);
        }
        Err(None)
    }

    /// ∂F/∂parameter at the samples, a row a parameter of the law, k or M; its steps stay as they are.
    fn varied(&self, ride: &Ride, law: &dyn SensitiveLaw, by: &[String]) -> Result<Vec<Vec<f64>>, LawFailure> {
        by.par_iter().map(|name| self.varied_by(ride, law, name)).collect()
    }

    fn varied_by(&self, ride: &Ride, law: &dyn SensitiveLaw, name: &str) -> Result<Vec<f64>, LawFailure> {
        let (dstiffness, dmass) = (f64::from(u8::from(name == "stiffness")), f64::from(u8::from(name == "mass")));
        let parameter = law.parameters().iter().copied().find(|known| *known == name);
        let mut state = parameter.map_or(Variation::default(), |name| law.start(name));
        let (mut du, mut dv, mut da) = (0.0, 0.0, 0.0);
        let mut rows = vec![0.0];
        for Step { old, sliding, from, to, load_point, sampled } in
            ride.steps.iter().take_while(|_| !self.raised.is_set())
        {
            let (slip, dt) = (sliding.slip, sliding.dt);
            let along = Direction { state, parameter, ..Direction::default() };
            let [given, by_slip] = law.vary(old, *sliding, [along, Direction { slip: 1.0, ..Direction::default() }])?;
            let per = 4.0 * self.mass / (dt * dt);
            let stretch = load_point - self.course[0][1] - to.slip;
            let inertia = 4.0 / (dt * dt) * (slip - dt * from.rate) - from.acceleration;
            let driven = dstiffness * stretch - self.stiffness * du - given.traction - dmass * inertia
                + per * dt * dv
                + self.mass * da;
            let dslip = driven / (per + self.stiffness + by_slip.traction);
            da = 4.0 / (dt * dt) * (dslip - dt * dv) - da;
            dv = 2.0 * dslip / dt - dv;
            du += dslip;
            state = given;
            state.traction += by_slip.traction * dslip;
            state.variables.values_mut().zip(by_slip.variables.values()).for_each(|(to, by)| *to += by * dslip);
            if *sampled {
                rows.push(dstiffness * stretch - self.stiffness * du);
            }
        }
        Ok(rows)
    }
}

fn share(of: u64) -> f64 {
    of as f64 / WHOLE as f64
}
