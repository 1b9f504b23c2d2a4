//! The linear solvers against each other and against known solutions.

use std::sync::Arc;

use crate::common::on_threads;
use crate::grids::{Grids, add, noise};
use fecontact::linear::{
    LinearFailure, LinearSolver, Multifrontal, Pattern, Solution, SparseLu, SparseMatrix, norm, solve, solve_again,
};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn solved(matrix: &SparseMatrix, b: &[f64]) -> Solution {
    solve(&mut Multifrontal::default(), matrix, b).expect("the matrix is regular")
}

/// ‖x − y‖/‖y‖
fn distance(x: &[f64], y: &[f64]) -> f64 {
    norm(&x.iter().zip(y).map(|(x, y)| x - y).collect::<Vec<_>>()) / norm(y)
}

/// The largest error of x for which A x = b is solved with b = A x.
fn error_of_known_solution(matrix: &SparseMatrix) -> (f64, f64) {
    let x = noise(matrix.size());
    let solution = solved(matrix, &matrix.multiply(&x));
    (distance(&solution.x, &x), solution.backward_error)
}

fn agree(matrix: &SparseMatrix, tolerance: f64) {
    let b = noise(matrix.size());
    let reference = solve(&mut SparseLu::default(), matrix, &b).expect("the matrix is regular");
    let solution = solved(matrix, &b);
    assert!(solution.backward_error < 1e-13, "backward error {}", solution.backward_error);
    let d = distance(&solution.x, &reference.x);
    assert!(d < tolerance, "distance to the reference {d}");
}

#[test]
fn single_node() {
    let mut matrix = SparseMatrix::zero(Arc::new(Pattern::new(1, std::iter::empty())));
    add(&mut matrix, 0, 0, [[0.0, 2.0], [4.0, 1.0]]);
    let x = solved(&matrix, &[2.0, 5.0]).x;
    assert_eq!(x, [1.0, 1.0]);
}

#[test]
fn no_nodes() {
    let matrix = SparseMatrix::zero(Arc::new(Pattern::new(0, std::iter::empty())));
    assert!(solved(&matrix, &[]).x.is_empty());
}

#[test]
fn grids_agree_with_sparse_lu_at_any_penalty() {
    for (penalty, tolerance) in [(1.0, 1e-12), (1e3, 1e-10), (1e6, 1e-7), (1e9, 1e-4)] {
        agree(&Grids::new(17, 9, penalty).matrix(1.0), tolerance);
    }
}

#[test]
fn supports_of_any_scale() {
    for support in [1e-20, 1e-9, 1.0, 1e9, 1e20] {
        let (error, backward) = error_of_known_solution(&Grids::new(12, 8, 1e3).matrix(support));
        assert!(error < 1e-10 && backward < 1e-13, "scale {support}: error {error}, backward error {backward}");
    }
}

#[test]
fn units_do_not_matter() {
    let mut matrix = Grids::new(10, 6, 1e3).matrix(1.0);
    let plain = error_of_known_solution(&matrix).0;
    matrix.values.iter_mut().for_each(|v| *v *= 2f64.powi(60));
    assert_eq!(error_of_known_solution(&matrix).0, plain);
}

#[test]
fn numbering_does_not_matter() {
    let mut grids = Grids::new(15, 11, 1e3);
    let n = grids.names.len();
    let b = noise(2 * n);
    let plain = solved(&grids.matrix(1.0), &b).x;
    // 7919 is prime and no divisor of n: a permutation.
    grids.names = (0..n).map(|k| k * 7919 % n).collect();
    let mut shuffled = vec![0.0; 2 * n];
    for k in 0..2 * n {
        shuffled[2 * grids.names[k / 2] + k % 2] = b[k];
    }
    let x = solved(&grids.matrix(1.0), &shuffled).x;
    let back: Vec<f64> = (0..2 * n).map(|k| x[2 * grids.names[k / 2] + k % 2]).collect();
    assert!(distance(&back, &plain) < 1e-9);
}

#[test]
fn separate_bodies() {
    let mut matrix = Grids::new(9, 7, 0.0).floating();
    for dof in 0..matrix.size() {
        matrix.add_diagonal(dof, 0.5);
    }
    agree(&matrix, 1e-12);
}

#[test]
fn nodes_without_neighbours() {
    let mut matrix = SparseMatrix::zero(Arc::new(Pattern::new(5000, std::iter::empty())));
    for dof in 0..matrix.size() {
        matrix.add_diagonal(dof, 4.0);
    }
    assert!(solved(&matrix, &vec![2.0; 10_000]).x.iter().all(|&x| x == 0.5));
}

/// A chain has the deepest tree there is.
#[test]
fn long_chain() {
    let links: Vec<[usize; 2]> = (1..100_000).map(|k| [k - 1, k]).collect();
    let mut matrix = SparseMatrix::zero(Arc::new(Pattern::new(100_000, links.iter().map(|l| &l[..]))));
    for [a, b] in links {
        add(&mut matrix, a, b, [[-1.0, 0.2], [0.1, -1.0]]);
        add(&mut matrix, b, a, [[-1.0, 0.0], [0.3, -1.0]]);
    }
    for dof in 0..matrix.size() {
        matrix.add_diagonal(dof, 2.7);
    }
    let (error, _) = error_of_known_solution(&matrix);
    assert!(error < 1e-13, "{error}");
}

/// All nodes coupled with all: one front.
#[test]
fn full_matrix() {
    let all: Vec<usize> = (0..150).collect();
    let mut matrix = SparseMatrix::zero(Arc::new(Pattern::new(150, std::iter::once(&all[..]))));
    matrix.values = noise(matrix.values.len());
    let (error, backward) = error_of_known_solution(&matrix);
    assert!(error < 1e-10 && backward < 1e-13, "error {error}, backward error {backward}");
}

#[test]
fn nearly_singular() {
    let mut matrix = Grids::new(8, 5, 1e3).floating();
    for dof in 0..matrix.size() {
        matrix.add_diagonal(dof, 1e-9);
    }
    let (error, backward) = error_of_known_solution(&matrix);
    assert!(error < 1e-4 && backward < 1e-13, "error {error}, backward error {backward}");
}

#[test]
fn singular_is_an_error() {
    let floating = Grids::new(8, 5, 1e3).floating();
    let b = noise(floating.size());
    let error = solve(&mut Multifrontal::default(), &floating, &b).err().expect("a body floats");
    assert!(error.to_string().contains("singular"), "{error}");

    let zero = SparseMatrix::zero(floating.pattern.clone());
    assert!(solve(&mut Multifrontal::default(), &zero, &b).is_err());

    let mut broken = Grids::new(8, 5, 1e3).matrix(1.0);
    broken.values[40] = f64::NAN;
    assert!(solve(&mut Multifrontal::default(), &broken, &b).is_err());
}

/// A star of spokes around node 0. One spoke has nothing on its diagonal and no other unknowns in its front.
#[test]
fn vanished_pivots_are_counted_and_mended() {
    let spokes: Vec<[usize; 2]> = (1..40).map(|k| [0, k]).collect();
    let mut matrix = SparseMatrix::zero(Arc::new(Pattern::new(40, spokes.iter().map(|s| &s[..]))));
    for [hub, end] in spokes {
        add(&mut matrix, hub, end, [[1.0, 0.5], [0.0, 2.0]]);
        add(&mut matrix, end, hub, [[3.0, 1.0], [0.0, 1.0]]);
    }
    for dof in (0..matrix.size()).filter(|dof| dof / 2 != 20) {
        matrix.add_diagonal(dof, 9.0);
    }
    let x = noise(matrix.size());
    let solution = solved(&matrix, &matrix.multiply(&x));
    assert_eq!(solution.perturbed_pivots, 2);
    assert!(distance(&solution.x, &x) < 1e-12, "{}", distance(&solution.x, &x));
}

/// The star again, with one spoke whose diagonal is small, or next to nothing: eliminated first, it drowns what it is
/// coupled with. Refinement mends that, and what a replaced pivot does.
#[test]
fn small_pivots_are_mended() {
    let spokes: Vec<[usize; 2]> = (1..40).map(|k| [0, k]).collect();
    let mut replaced = 0;
    for exponent in 6..20 {
        let mut matrix = SparseMatrix::zero(Arc::new(Pattern::new(40, spokes.iter().map(|s| &s[..]))));
        for &[hub, end] in &spokes {
            add(&mut matrix, hub, end, [[1.0, 0.5], [0.0, 2.0]]);
            add(&mut matrix, end, hub, [[3.0, 1.0], [0.0, 1.0]]);
        }
        for dof in 0..matrix.size() {
            matrix.add_diagonal(dof, if dof / 2 == 20 { 10f64.powi(-exponent) } else { 9.0 });
        }
        let x = noise(matrix.size());
        let solution = solved(&matrix, &matrix.multiply(&x));
        let error = distance(&solution.x, &x);
        assert!(solution.backward_error < 1e-12 && error < 1e-11, "1e-{exponent}: {error}");
        replaced += usize::from(solution.perturbed_pivots > 0);
    }
    assert!((1..14).contains(&replaced), "{replaced} of 14 cases lose a pivot");
}

/// A solver whose answers are all zero, so that refinement gets nowhere.
struct Useless;

impl LinearSolver for Useless {
    fn factorize(&mut self, _: &SparseMatrix) -> Result<(), LinearFailure> {
        Ok(())
    }

    fn solve(&mut self, b: &mut [f64]) {
        b.fill(0.0);
    }
}

#[test]
fn another_solver_takes_over_when_refinement_stalls() {
    let matrix = Grids::new(14, 9, 1e3).matrix(1.0);
    let x = noise(matrix.size());
    let solution = solve(&mut Useless, &matrix, &matrix.multiply(&x)).expect("the matrix is regular");
    assert!(solution.fallback && solution.backward_error < 1e-12 && distance(&solution.x, &x) < 1e-9);
    assert!(!solved(&matrix, &matrix.multiply(&x)).fallback);
}

/// Nothing on the diagonal: pivots are found among the couplings, inside the fronts.
#[test]
fn no_diagonal() {
    let grids = Grids::new(30, 20, 1e3);
    let mut matrix = SparseMatrix::zero(grids.matrix(1.0).pattern);
    matrix.values = noise(matrix.values.len());
    for dof in 0..matrix.size() {
        let diagonal = matrix.diagonal()[dof];
        matrix.add_diagonal(dof, -diagonal);
    }
    agree(&matrix, 1e-8);
}

/// Factors of an earlier matrix on the same pattern give an answer to what they were made of, and say how good it is.
#[test]
fn old_factors_are_used_again() {
    let mut solver = Multifrontal::default();
    let matrix = Grids::new(14, 9, 1e3).matrix(1.0);
    let b = noise(matrix.size());
    solve(&mut solver, &matrix, &b).expect("the matrix is regular");
    let again = solve_again(&mut solver, &matrix, &b);
    assert!(again.residual < 1e-9 && again.backward_error < 1e-9, "{} {}", again.residual, again.backward_error);
    let mut changed = matrix.clone();
    changed.values.iter_mut().for_each(|value| *value *= 2.0);
    let wrong = solve_again(&mut solver, &changed, &b);
    assert!((wrong.residual - 1.0).abs() < 1e-6, "A x = 2 b: {}", wrong.residual);
}

#[test]
fn values_change_on_the_same_pattern() {
    let mut solver = Multifrontal::default();
    let mut matrix = Grids::new(14, 9, 1e3).matrix(1.0);
    let x = noise(matrix.size());
    for step in 0..3 {
        let b = matrix.multiply(&x);
        let solution = solve(&mut solver, &matrix, &b).expect("the matrix is regular");
        assert_eq!(solution.x, solved(&matrix, &b).x, "a used solver gives the bits of a new one, step {step}");
        assert!(distance(&solution.x, &x) < 1e-9);
        matrix.add_diagonal(77, 10.0);
    }
}

#[test]
fn pattern_changes() {
    let mut solver = Multifrontal::default();
    for (nx, ny) in [(14, 9), (3, 2), (20, 20), (14, 9)] {
        let matrix = Grids::new(nx, ny, 1e3).matrix(1.0);
        let x = noise(matrix.size());
        let solution = solve(&mut solver, &matrix, &matrix.multiply(&x)).expect("the matrix is regular");
        assert!(distance(&solution.x, &x) < 1e-9);
    }
}

#[test]
fn same_bits_on_any_number_of_threads() {
    let matrix = Grids::new(150, 60, 1e3).matrix(1.0);
    let b = noise(matrix.size());
    let on = |threads: usize| on_threads(threads, || solved(&matrix, &b).x);
    let one = on(1);
    for threads in [2, 3, 2] {
        assert!(on(threads) == one, "{threads} threads differ");
    }
}

/// Right-hand sides that are solved together have the bits of each by itself: in a forest and in heavy fronts, symmetric ones and others,
/// with dofs of their own, on any number of threads.
#[test]
fn several_right_hand_sides_are_solved_as_each() {
    for matrix in [Grids::new(60, 45, 1e3).matrix(1.0), Grids::new(7, 5, 1e3).matrix(1.0)] {
        let mut solver = Multifrontal::default();
        solver.factorize(&matrix).expect("the matrix is regular");
        let sides: Vec<Vec<f64>> = (1..=5).map(|k| noise(matrix.size()).iter().map(|b| b.powi(k)).collect()).collect();
        let mut alone = sides.clone();
        alone.iter_mut().for_each(|b| solver.solve(b));
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let mut together = sides.clone();
            pool.install(|| solver.solve_all(&mut together.iter_mut().map(|b| &mut b[..]).collect::<Vec<_>>()));
            assert_eq!(together, alone);
        }
        solver.solve_all(&mut []);
    }
}

#[test]
fn memory_is_known_before_it_is_taken() {
    let mut solver = Multifrontal::default();
    assert_eq!(solver.memory(), 0);
    let matrix = Grids::new(30, 20, 1.0).matrix(1.0);
    solver.analyse(&matrix.pattern).expect("the pattern is small");
    let before = solver.memory();
    solver.factorize(&matrix).expect("the matrix is regular");
    assert_eq!(solver.memory(), before);
    assert!(before > 8 * matrix.values.len() && before < 64 << 20, "{before}");
}

#[test]
fn solving_without_a_matrix_is_not_a_number() {
    let mut b = [1.0, 2.0];
    Multifrontal::default().solve(&mut b);
    assert!(b.iter().all(|b| b.is_nan()));
}

fn any_graph() -> impl Strategy<Value = (usize, Vec<Vec<usize>>, u64)> {
    (1usize..60).prop_flat_map(|nodes| {
        let group = prop::collection::vec(0..nodes, 1..6);
        (Just(nodes), prop::collection::vec(group, 0..80), any::<u64>())
    })
}

/// So many cases, the same in every run.
fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(cases(256))]
    /// The two solvers agree on any values whatever, if their answers mean anything.
    #[test]
    fn solvers_agree_on_any_pattern(graph in any_graph()) {
        let (nodes, mut groups, seed) = graph;
        groups.iter_mut().for_each(|group| { group.sort_unstable(); group.dedup() });
        let mut matrix = SparseMatrix::zero(Arc::new(Pattern::new(nodes, groups.iter().map(|group| &group[..]))));
        let shift = (seed % 1000) as usize;
        matrix.values = noise(matrix.values.len() + shift).split_off(shift);
        let x = noise(matrix.size());
        let b = matrix.multiply(&x);
        let (one, other) = (solve(&mut Multifrontal::default(), &matrix, &b), solve(&mut SparseLu::default(), &matrix, &b));
        if let (Ok(one), Ok(other)) = (one, other) {
            prop_assert!(one.backward_error <= 1e-12, "backward error {}", one.backward_error);
            // Both are as far from the known solution as the condition of the matrix makes them.
            let (error, reference) = (distance(&one.x, &x), distance(&other.x, &x));
            prop_assert!(error < 1e-10 || error < 1e4 * reference, "error {error}, reference {reference}");
        }
    }

    /// Unsymmetric values of any sign on any symmetric pattern, the diagonal strong enough for a tame solution.
    #[test]
    fn any_pattern(graph in any_graph()) {
        let (nodes, mut groups, seed) = graph;
        groups.iter_mut().for_each(|group| { group.sort_unstable(); group.dedup() });
        let pattern = Arc::new(Pattern::new(nodes, groups.iter().map(|group| &group[..])));
        let mut matrix = SparseMatrix::zero(pattern);
        let shift = (seed % 100) as usize;
        matrix.values = noise(matrix.values.len() + shift).split_off(shift);
        for dof in 0..matrix.size() {
            let coupled = matrix.pattern.neighbours(dof / 2).len();
            matrix.add_diagonal(dof, 1.0 + 2.0 * coupled as f64);
        }
        let (error, backward) = error_of_known_solution(&matrix);
        prop_assert!(error < 1e-12 && backward < 1e-13, "error {}, backward error {}", error, backward);
    }
}

/// The products of matrices with all nodes coupled and not, entry by entry; those of symmetric ones with several vectors at a time
/// are the same but for round-off.
#[test]
fn products_are_those_of_the_entries() {
    let all: Vec<usize> = (0..7).collect();
    let mut dense = SparseMatrix::zero(Arc::new(Pattern::new(7, std::iter::once(&all[..]))));
    dense.values = noise(dense.values.len());
    for matrix in [Grids::new(6, 4, 10.0).matrix(1.0), dense] {
        let size = matrix.size();
        let [x, y] = [noise(size), noise(2 * size).split_off(size)];
        let place =
            |row: usize, column: usize| Some(matrix.pattern.block(row / 2, column / 2)?.value(row % 2, column % 2));
        let entry = |row: usize, column: usize| place(row, column).map_or(0.0, |place| matrix.values[place]);
        let first: f64 = (0..size).map(|column| entry(3, column) * x[column]).sum();
        assert!((matrix.multiply(&x)[3] - first).abs() < 1e-13);
        let mut symmetric = matrix.clone();
        for (row, column) in (0..size * size).map(|k| (k / size, k % size)) {
            let sum = entry(row, column) + entry(column, row);
            place(row, column).into_iter().for_each(|place| symmetric.values[place] = sum);
        }
        for (product, x) in symmetric.multiply_symmetric([&x, &y]).iter().zip([&x, &y]) {
            let off: Vec<f64> = product.iter().zip(symmetric.multiply(x)).map(|(one, other)| one - other).collect();
            assert!(norm(&off) < 1e-14 * norm(product), "{:e}", norm(&off) / norm(product));
        }
    }
}

/// A matrix of which little changes from one factorization to the next: fronts stay, and not a bit of the solution is another.
#[test]
fn fronts_that_stay_give_the_same_bits() {
    let grids = Grids::new(40, 25, 1e3);
    let mut matrix = grids.matrix(1.0);
    let b = noise(matrix.size());
    let mut solver = Multifrontal::default();
    let spots: [&[usize]; 8] = [
        &[],
        &[grids.node(1, 3, 2)],
        &[grids.node(1, 3, 2)],
        &[grids.node(1, 3, 2), grids.node(0, 38, 20)],
        &[],
        &[grids.node(0, 20, 25), grids.node(1, 20, 0), grids.node(1, 21, 0)],
        &[grids.node(0, 21, 25)],
        &[grids.node(1, 3, 2)],
    ];
    for (k, nodes) in spots.into_iter().enumerate() {
        for &node in nodes {
            add(&mut matrix, node, node, [[1.0 + k as f64, 0.25], [0.5, 2.0]]);
        }
        let [mut kept, mut fresh] = [b.clone(), b.clone()];
        solver.factorize(&matrix).expect("regular");
        solver.solve(&mut kept);
        let (eliminated, all) = solver.eliminated();
        // Where something changes for the first time, nothing is at hand of what passes to the fronts above.
        let most = match k {
            2 | 7 => all / 8,
            4 => 0,
            _ => all,
        };
        assert!(eliminated <= most && (nodes.is_empty() || eliminated > 0), "change {k}: {eliminated} of {all} fronts");
        let mut other = Multifrontal::default();
        other.factorize(&matrix).expect("regular");
        other.solve(&mut fresh);
        assert!(kept == fresh, "change {k}: off by {:e}", distance(&kept, &fresh));
    }
}

proptest! {
    #![proptest_config(cases(40))]
    #[test]
    fn whatever_changes_the_bits_are_those_of_a_fresh_factorization(
        changes in proptest::collection::vec(proptest::collection::vec((0usize..104, -4i32..12), 0..5), 1..8)
    ) {
        let mut matrix = Grids::new(12, 3, 10.0).matrix(1.0);
        let b = noise(matrix.size());
        let mut solver = Multifrontal::default();
        for nodes in changes {
            for (node, power) in nodes {
                add(&mut matrix, node, node, [[2f64.powi(power), 0.0], [0.1, 1.0]]);
            }
            let [mut kept, mut fresh] = [b.clone(), b.clone()];
            solver.factorize(&matrix).expect("regular");
            solver.solve(&mut kept);
            let mut other = Multifrontal::default();
            other.factorize(&matrix).expect("regular");
            other.solve(&mut fresh);
            prop_assert!(kept == fresh);
        }
    }
}
