use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::approach::Progress;
use super::peak::{Evolution, Peak};
use super::root::bracketed_newton;
use super::{Approach, FrictionLaw, FrictionResponse, FrictionState, LawFailure, Sliding};
use crate::parameter::{InvalidParameter, require, require_not_negative, require_positive};

/// Parameters of [`SuperSubloading`] as the case file writes them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SuperSubloadingParameters {
    /// μ_s: static friction coefficient, μ_s ≥ μ_k [-]
    pub mu_s: f64,
    /// μ_k: kinetic friction coefficient, μ_k > 0 [-]
    pub mu_k: f64,
    /// α_t: tangential contact stiffness, α_t > 0; by default chosen from the mesh and the bodies [F/L³]
    #[serde(default)]
    pub alpha_t: Option<f64>,
    /// r: rate at which R approaches 1 with plastic slip, r > 0 [1/L]
    pub r: f64,
    /// κ: loss of structure with plastic slip, κ ≥ 0 [1/L]
    #[serde(default)]
    pub kappa: f64,
    /// ξ: recovery of structure with time, ξ ≥ 0 [1/T]
    #[serde(default)]
    pub xi: f64,
    /// m: exponent of the loss, m > 0 [-]
    #[serde(default = "one")]
    pub m: f64,
    /// n: exponent of the recovery, n > 0 [-]
    #[serde(default = "one")]
    pub n: f64,
    /// 1/R*₀: structure at first touch, from 1 (μ = μ_k) to μ_s/μ_k (μ = μ_s, the default) [-]
    #[serde(default)]
    pub structure: Option<f64>,
    /// U(R): how R approaches 1
    #[serde(default)]
    pub approach: Approach,
    /// R_e: elastic core, no plastic slip for R ≤ R_e, 0 ≤ R_e < 1 [-]
    #[serde(default)]
    pub elastic_core: f64,
}

fn one() -> f64 {
    1.0
}

/// Super/subloading friction: slip weakens the interface, rest heals it.
///
/// ```text
/// q̇ = α_t (v − λ sgn q)                               slip = elastic + plastic     (1)
/// Ṙ = U(R) λ,   R = |q|/(μ p),   U = −r ln R           approach to full sliding     (2)
/// μ̇ = −κ (μ/μ_k − 1)^m λ + ξ (1 − μ/μ_s)^n             weakening, recovery          (3)
/// ```
/// λ ≥ 0 is the rate of plastic slip; R falls freely while λ = 0. With an elastic core R_e, ln R becomes
/// ln (R − R_e)/(1 − R_e); [`Approach`] offers a second U. Units: q, p [F/L²], α_t [F/L³], λ and v [L/T],
/// r and κ [1/L], ξ [1/T], all others [-].
///
/// An increment Δu, p₀ → p, Δt is elastic if the trial traction q_tr = q₀ + α_t Δu stays at or below R_s μ_tr p. Here
/// R_s = max(R₀, R_e), with 0 for R₀ if q changes sign on the way or nothing was pressed, and μ_tr is μ aged without
/// slip. Otherwise the plastic slip Δλ is the *smallest* root of one scalar equation,
/// ```text
/// G(Δλ) = |q_tr| − α_t Δλ − R(Δλ) μ(Δλ) p = 0,   0 < Δλ ≤ |q_tr|/α_t                (4)
/// ```
/// with R from (2) integrated exactly and μ from (3) by backward Euler ([`Approach`] and `peak.rs`). G is positive at
/// the left end and not at the right, so a bracketed Newton method cannot fail. G falls throughout, and the root is
/// the only one, while α_t exceeds R p |dμ/dΔλ|; where this cannot be guaranteed ([`FrictionLaw::uniqueness_limit`]),
/// bounds of the slope of G single out the first root. The tangent is that of (4),
/// ```text
/// D = α_t + p (U μ + R ∂μ/∂Δλ),   ∂q/∂Δu = α_t (1 − α_t/D),   ∂q/∂p = sgn(q_tr) α_t R μ/D.
/// ```
///
/// # Errors
/// [`LawFailure`] when the increment or the answer is not finite, or time goes backwards.
///
/// Source: Yasuike, Toyoda & Noda, eqs 10–20; Toyoda, Yasuike & Noda (2024), Tribology International 191:109080;
/// Ozaki & Hashiguchi (2010), Tribology International 43:2120.
#[derive(Clone, Copy, Debug)]
pub struct SuperSubloading {
    alpha_t: f64,
    r: f64,
    elastic_core: f64,
    /// (1 − R_e)/r: plastic slip per T [L]
    length: f64,
    approach: Approach,
    evolution: Evolution,
    initial_mu: f64,
}

/// y = (R − R_e)/(1 − R_e) below which slip is taken as elastic: small enough to mean R = R_e.
const LEAST_Y: f64 = 1e-100;

/// Residual of (4), relative to |q_tr|, at which it is solved.
const TOLERANCE: f64 = 3e-14;

/// Trial tractions above the elastic limit by less than this, relative, are round-off.
const ROUND_OFF: f64 = 4.0 * f64::EPSILON;

/// Least D/α_t: where two roots of (4) merge D is 0, and known only to the square root of the round-off.
const LEAST_SLOPE: f64 = 1e-8;

/// Most pieces of the bracket that are examined for the first root.
const MAX_PIECES: usize = 1000;

/// Pieces of the bracket narrower than this hold roots that cannot be told apart.
const LEAST_PIECE: f64 = 1e-12;

impl SuperSubloading {
    /// The law with its parameters checked; `default_alpha_t` serves where they give no `alpha_t`.
    ///
    /// # Errors
    /// [`InvalidParameter`] when a parameter is out of its range.
    pub fn new(parameters: &SuperSubloadingParameters, default_alpha_t: f64) -> Result<Self, InvalidParameter> {
        let SuperSubloadingParameters { mu_s, mu_k, r, kappa, xi, m, n, approach, elastic_core, .. } = *parameters;
        let alpha_t = parameters.alpha_t.unwrap_or(default_alpha_t);
        require_positive("mu_k", mu_k)?;
        require("mu_s", mu_s, mu_s >= mu_k, format!("it must be finite and not less than \"mu_k\", which is {mu_k}"))?;
        require_positive("alpha_t", alpha_t)?;
        require_positive("r", r)?;
        require_not_negative("kappa", kappa)?;
        require_not_negative("xi", xi)?;
        require_positive("m", m)?;
        require_positive("n", n)?;
        let core_fits = (0.0..1.0).contains(&elastic_core);
        require("elastic_core", elastic_core, core_fits, "it must be zero or positive, and less than 1")?;
        let most = mu_s / mu_k;
        let structure = parameters.structure.unwrap_or(most);
        let structure_fits = (1.0..=most * (1.0 + ROUND_OFF)).contains(&structure);
        require("structure", structure, structure_fits, format!("it must lie between 1 and mu_s/mu_k = {most}"))?;
        Ok(Self {
            alpha_t,
            r,
            elastic_core,
            length: (1.0 - elastic_core) / r,
            approach,
            evolution: Evolution::new(mu_s, mu_k, kappa, xi, m, n),
            initial_mu: (mu_k * structure).min(mu_s),
        })
    }

    /// The point at ζ of the path that starts at T = `origin`.
    fn reach(&self, zeta: f64, here: &Progress, origin: f64) -> Reach {
        Reach {
            coordinate: zeta,
            slip: ((here.distance - origin) * self.length).max(0.0),
            stretch: here.stretch * self.length,
            ratio: self.elastic_core + (1.0 - self.elastic_core) * here.y,
            rate: self.r * here.rate,
        }
    }

    /// An increment with plastic slip, which starts at y: solves (4).
    fn slide(&self, old: &FrictionState, trial: f64, start_y: f64, sliding: Sliding) -> FrictionResponse {
        let Sliding { pressure, dt, .. } = sliding;
        let (path, start) = Path::from(self, start_y);
        let mut increment =
            Increment { law: self, path, trial: trial.abs(), pressure, old_mu: old.mu, dt, evaluations: 0 };
        let Point { reach, peak, slope, .. } = increment.solve(start);
        let strength = reach.ratio * peak.mu;
        let traction = trial.signum() * strength * pressure;
        let softness = self.alpha_t / slope.max(LEAST_SLOPE * self.alpha_t);
        FrictionResponse {
            state: old.slid(trial, traction, pressure, peak.mu, self.alpha_t),
            dtraction_dslip: self.alpha_t * (1.0 - softness),
            dtraction_dpressure: trial.signum() * strength * softness,
            evaluations: increment.evaluations,
        }
    }
}

impl FrictionLaw for SuperSubloading {
    fn initial_state(&self) -> FrictionState {
        FrictionState { mu: self.initial_mu, ..FrictionState::default() }
    }

    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Result<FrictionResponse, LawFailure> {
        let Sliding { slip, pressure, dt } = sliding.checked()?;
        let old = FrictionState { mu: self.evolution.clamp(old.mu), ..*old };
        let mu = self.evolution.after(old.mu, 0.0, dt).mu;
        if pressure <= 0.0 {
            let state = old.parted(mu, self.alpha_t);
            return FrictionResponse { state, dtraction_dslip: 0.0, dtraction_dpressure: 0.0, evaluations: 0 }
                .checked();
        }
        let trial = old.traction + self.alpha_t * slip;
        let reversed = trial * old.traction.signum() < 0.0;
        let ratio = if reversed { 0.0 } else { old.ratio().min(1.0) };
        let start_y = ((ratio - self.elastic_core) / (1.0 - self.elastic_core)).max(LEAST_Y);
        let start_ratio = self.elastic_core + (1.0 - self.elastic_core) * start_y;
        if trial.abs() <= start_ratio * mu * pressure * (1.0 + ROUND_OFF) {
            let state = old.stuck(trial, pressure, mu);
            return FrictionResponse { state, dtraction_dslip: self.alpha_t, dtraction_dpressure: 0.0, evaluations: 0 }
                .checked();
        }
        self.slide(&old, trial, start_y, sliding).checked()
    }

    fn stiffness(&self) -> f64 {
        self.alpha_t
    }

    fn structure(&self, mu: f64) -> f64 {
        mu / self.evolution.mu_k
    }

    fn uniqueness_limit(&self) -> Option<f64> {
        let static_mu = self.evolution.clamp(f64::INFINITY);
        let pressure = self.alpha_t / self.evolution.after(static_mu, 0.0, 0.0).steepest();
        pressure.is_finite().then_some(pressure)
    }
}

/// How R follows from plastic slip within one increment.
#[derive(Clone, Copy, Debug)]
enum Path {
    /// R rises towards 1 along the coordinate ζ, from T = `origin`.
    Approaching { origin: f64 },
    /// R = 1; the coordinate is the plastic slip itself.
    FullSliding,
}

/// A point of the path.
#[derive(Clone, Copy, Debug)]
struct Reach {
    /// ζ, or Δλ in full sliding
    coordinate: f64,
    /// Δλ: plastic slip [L]
    slip: f64,
    /// dΔλ/d(coordinate)
    stretch: f64,
    /// R [-]
    ratio: f64,
    /// U = dR/dΔλ [1/L]
    rate: f64,
}

impl Path {
    /// The path from y, and where it starts.
    fn from(law: &SuperSubloading, y: f64) -> (Self, Reach) {
        if y < 1.0 {
            let (zeta, here) = law.approach.locate(y);
            (Self::Approaching { origin: here.distance }, law.reach(zeta, &here, here.distance))
        } else {
            (Self::FullSliding, Self::FullSliding.at(law, 0.0))
        }
    }

    fn at(self, law: &SuperSubloading, coordinate: f64) -> Reach {
        match self {
            Self::Approaching { origin } => law.reach(coordinate, &law.approach.at(coordinate), origin),
            Self::FullSliding => Reach { coordinate, slip: coordinate, stretch: 1.0, ratio: 1.0, rate: 0.0 },
        }
    }

    /// A coordinate of at least this plastic slip.
    fn beyond(self, law: &SuperSubloading, slip: f64) -> f64 {
        match self {
            Self::Approaching { origin } => law.approach.beyond(origin + slip / law.length),
            Self::FullSliding => slip,
        }
    }
}

/// Equation (4) of one increment, along a coordinate of plastic slip.
struct Increment<'a> {
    law: &'a SuperSubloading,
    path: Path,
    /// |q_tr|
    trial: f64,
    pressure: f64,
    old_mu: f64,
    dt: f64,
    /// How often (4) was evaluated
    evaluations: usize,
}

/// Equation (4) at one point of the path.
#[derive(Clone, Copy, Debug)]
struct Point {
    reach: Reach,
    /// μ and ∂μ/∂Δλ
    peak: Peak,
    /// G [F/L²]
    residual: f64,
    /// D = −dG/dΔλ [F/L³]
    slope: f64,
}

impl Increment<'_> {
    /// The smallest root of (4), on the path from `start`.
    fn solve(&mut self, start: Reach) -> Point {
        let start = self.point(start);
        let unique = self.pressure * start.peak.steepest() < self.law.alpha_t;
        let end = self.path.beyond(self.law, self.trial / self.law.alpha_t);
        let bracket = if unique { (start.reach.coordinate, end) } else { self.first_root_bracket(start, end) };
        let mut point = start;
        let (guess, tolerance) = (self.guess(&start), TOLERANCE * self.trial);
        bracketed_newton(bracket, guess, tolerance, |coordinate| {
            point = self.at(coordinate);
            (point.residual, -point.slope * point.reach.stretch)
        });
        point
    }

    fn at(&mut self, coordinate: f64) -> Point {
        self.point(self.path.at(self.law, coordinate))
    }

    fn point(&mut self, reach: Reach) -> Point {
        self.evaluations += 1;
        let Reach { slip, ratio, rate, .. } = reach;
        let peak = self.law.evolution.after(self.old_mu, slip, self.dt);
        let alpha_t = self.law.alpha_t;
        Point {
            reach,
            peak,
            residual: self.trial - alpha_t * slip - ratio * peak.mu * self.pressure,
            slope: alpha_t + self.pressure * (rate * peak.mu + ratio * peak.slope()),
        }
    }

    /// A first coordinate: a Newton step from the start or, near R = R_e where U is infinite, the elastic answer if
    /// there is one, else the least plastic slip possible.
    fn guess(&self, start: &Point) -> f64 {
        let law = self.law;
        let strength = start.peak.mu * self.pressure;
        let y = |ratio: f64| (ratio - law.elastic_core) / (1.0 - law.elastic_core);
        if y(start.reach.ratio) > 0.05 {
            start.reach.coordinate + start.residual / (start.slope * start.reach.stretch)
        } else if self.trial < 0.9 * strength {
            law.approach.locate(y(self.trial / strength)).0
        } else {
            self.path.beyond(law, (self.trial - strength).max(0.0) / law.alpha_t)
        }
    }

    /// A bracket that holds the smallest root of (4), and no other unless they cannot be told apart.
    ///
    /// Pieces of the bracket are examined from the left with bounds D₋ ≤ D ≤ D₊ of the slope on each: it holds one
    /// root or none if D₋ > 0, none if G stays positive between the lines of slope −D₊ from its left end and −D₋ from
    /// its right, and is halved otherwise.
    fn first_root_bracket(&mut self, start: Point, end: f64) -> (f64, f64) {
        let mut left = start;
        let mut right = self.at(end);
        for _ in 0..MAX_PIECES {
            let (low, high) = (left.reach.coordinate, right.reach.coordinate);
            let (least, most) = self.slope_bounds(&left, &right);
            let narrow = high - low <= LEAST_PIECE * (1.0 + low.abs());
            if right.residual <= 0.0 && (least > 0.0 || narrow) {
                return (low, high);
            }
            let crossing_needs = left.residual / most.max(0.0) + right.residual / (-least).max(0.0);
            let rootless = right.residual > 0.0 && (least > 0.0 || crossing_needs > right.reach.slip - left.reach.slip);
            if rootless || narrow {
                left = right;
                right = self.at(end.min(high + 2.0 * (high - low)));
            } else {
                right = self.at(low + 0.5 * (high - low));
            }
        }
        (left.reach.coordinate, end)
    }

    /// Least and greatest D between two points, from the monotony of U, R, μ and |∂μ/∂Δλ|.
    fn slope_bounds(&self, left: &Point, right: &Point) -> (f64, f64) {
        let (flattest, steepest) = left.peak.steepness_until(&right.peak);
        let least = right.reach.rate * right.peak.mu - right.reach.ratio * steepest;
        let most = left.reach.rate * left.peak.mu - left.reach.ratio * flattest;
        (self.law.alpha_t + self.pressure * least, self.law.alpha_t + self.pressure * most)
    }
}
