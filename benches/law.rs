//! One update of the super/subloading law, under error control and in one backward-Euler step: the innermost cost of a
//! contact computation.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use fecontact::laws::friction::{
    Approach, FrictionLaw, FrictionState, Integration, Sliding, SuperSubloading, SuperSubloadingParameters,
};

const PRESSURE: f64 = 98.1;

fn law(m: f64, approach: Approach, integration: Integration) -> SuperSubloading {
    let parameters = SuperSubloadingParameters {
        mu_s: 0.4,
        mu_k: 0.2,
        alpha_t: Some(1000.0),
        r: 100.0,
        kappa: 10.0,
        xi: 0.002,
        m,
        n: 1.0,
        a: 0.0,
        reference_rate: None,
        structure: None,
        approach,
        elastic_core: 0.0,
        integration,
        tolerance: None,
    };
    SuperSubloading::new(&parameters, f64::NAN).expect("valid parameters")
}

/// A point loaded to the ratio R of its strength.
fn pressed(ratio: f64, mu: f64) -> FrictionState {
    FrictionState {
        traction: ratio * mu * PRESSURE,
        pressure: PRESSURE,
        ..FrictionState::default().with_variables([mu])
    }
}

fn update(criterion: &mut Criterion) {
    for (method, integration) in
        [("controlled", Integration::Controlled), ("backward Euler", Integration::BackwardEuler)]
    {
        let mut group = criterion.benchmark_group(method);
        let mut time = |name: &str, law: SuperSubloading, old: FrictionState, slip: f64| {
            let sliding = Sliding { slip, pressure: PRESSURE, dt: 0.01 };
            group.bench_function(name, |b| b.iter(|| law.respond(black_box(&old), black_box(sliding))));
        };
        let common = || law(1.0, Approach::Logarithmic, integration);
        time("elastic", common(), pressed(0.95, 0.3), -0.001);
        time("sliding, R = 0.95", common(), pressed(0.95, 0.22), 0.001);
        time("sliding, R = 0.999", common(), pressed(0.999, 0.21), 0.001);
        time("sliding, R = 1", common(), pressed(1.0, 0.205), 0.001);
        time("large slip from R = 0.9", common(), pressed(0.9, 0.4), 1.0);
        time("from rest", common(), pressed(0.0, 0.4), 0.01);
        time("reversal", common(), pressed(0.99, 0.2), -0.05);
        time("sliding, R = 0.95, cotangent", law(1.0, Approach::Cotangent, integration), pressed(0.95, 0.22), 0.001);
        time("sliding, R = 0.95, m = 1.5", law(1.5, Approach::Logarithmic, integration), pressed(0.95, 0.22), 0.001);
    }
}

criterion_group!(benches, update);
criterion_main!(benches);
