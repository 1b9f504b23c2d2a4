//! A law that the program does not know, with as many variables as a point has room for.

use fecontact::laws::friction::{
    Description, FrictionLaw, FrictionResponse, FrictionState, LawFailure, Regime, Sliding, register,
};

/// Viscous friction above a threshold that grows with what it has slipped.
///
/// ```text
/// q = η v (1 + 0.1 min(w, 1)),   w = ∫ |v| dt/(1 + ∫ dt)          pressures below the threshold are frictionless
/// ```
#[derive(Clone, Debug)]
struct Viscous {
    viscosity: f64,
    threshold: f64,
}

const VARIABLES: [&str; 20] = [
    "slipped",
    "loads",
    "closed_increments",
    "count_4",
    "count_5",
    "count_6",
    "count_7",
    "count_8",
    "count_9",
    "count_10",
    "count_11",
    "count_12",
    "count_13",
    "count_14",
    "count_15",
    "count_16",
    "count_17",
    "count_18",
    "count_19",
    "last_sign",
];

impl FrictionLaw for Viscous {
    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Result<FrictionResponse, LawFailure> {
        let Sliding { slip, pressure, dt } = sliding.checked()?;
        if pressure <= self.threshold || dt == 0.0 {
            let traction = if pressure > self.threshold { old.traction } else { 0.0 };
            return FrictionResponse::elastic(old.stuck(traction, pressure.max(0.0)), 0.0).checked(1.0);
        }
        // What it remembers makes it more viscous; a variable that is lost is seen in forces.
        let [slipped, loads, closed, last] = [0, 1, 2, VARIABLES.len() - 1].map(|k| old.variables[k]);
        let growth = 1.0 + 0.01 * closed.min(10.0) + 0.02 * last;
        let dtraction_dslip = self.viscosity * growth / dt;
        let traction = dtraction_dslip * slip;
        let counts = (3..VARIABLES.len() - 1).map(|k| old.variables[k] + 1.0);
        let variables = [slipped + slip, loads + 1.0, closed + 1.0].into_iter().chain(counts).chain([1.0]).collect();
        let state = FrictionState {
            plastic_slip: old.plastic_slip + slip,
            plastic_increment: slip,
            dissipation: old.dissipation + traction * slip,
            regime: if slip == 0.0 { Regime::Stick } else { Regime::Slip },
            variables,
            ..old.stuck(traction, pressure)
        };
        FrictionResponse { state, dtraction_dslip, ..Default::default() }.checked(dtraction_dslip)
    }

    fn description(&self) -> Description {
        Description { variables: &VARIABLES, ..Description::default() }
    }
}

/// Let cases use it.
pub fn registered() {
    register("crossings viscous", |parameters, _| {
        Ok(Box::new(Viscous { viscosity: parameters["viscosity"], threshold: parameters["threshold"] }))
    });
}
