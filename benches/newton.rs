//! Newton's method over a whole run of the 5k drag problem; the label has the linear solves and factorizations it takes.

use std::path::Path;
use std::sync::Arc;

use criterion::{Criterion, criterion_group, criterion_main};
use fecontact::case;
use fecontact::run::run;

fn convergence(criterion: &mut Criterion) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../cases/coulomb_drag_5k.json");
    let case = case::read(&path).expect("a committed case");
    let model = case::build(&case, &path).expect("a committed case");
    let model = Arc::new(model);
    let (report, _) = run(&model, &mut []);
    let label = format!(
        "{} increments, {} solves, {} factorizations",
        report.increments, report.newton_iterations, report.factorizations
    );
    let mut group = criterion.benchmark_group("newton");
    group.sample_size(10).bench_function(label, |bench| bench.iter(|| run(&model, &mut []).1.is_ok()));
    group.finish();
}

criterion_group!(benches, convergence);
criterion_main!(benches);
