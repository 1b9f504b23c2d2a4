//! Factorization and solution of two grids in contact: multifrontal against supernodal LU.

#[path = "../tests/common/grids.rs"]
mod grids;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use fecontact::linear::{LinearSolver, Multifrontal, SparseLu};
use grids::{Grids, noise};

fn factorization(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("factorization");
    group.sample_size(20);
    for (nx, ny) in [(50, 24), (100, 49)] {
        let matrix = Grids::new(nx, ny, 1e3).matrix(1.0);
        let solvers: [(&str, Box<dyn LinearSolver>); 2] =
            [("multifrontal", Box::<Multifrontal>::default()), ("supernodal", Box::<SparseLu>::default())];
        for (name, mut solver) in solvers {
            let case = |what| BenchmarkId::new(format!("{name} {what}"), matrix.size());
            group.bench_function(case("factorize"), |bencher| {
                bencher.iter(|| solver.factorize(&matrix).expect("the matrix is regular"));
            });
            let b = noise(matrix.size());
            group.bench_function(case("solve"), |bencher| {
                bencher.iter_batched_ref(|| b.clone(), |x| solver.solve(x), criterion::BatchSize::LargeInput);
            });
        }
    }
    group.finish();
}

criterion_group!(benches, factorization);
criterion_main!(benches);
