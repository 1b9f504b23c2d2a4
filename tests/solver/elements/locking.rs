//! Locking, and convergence of all kinds of elements.

use super::*;

/// Newton on the free dofs at a dead load; returns the number of iterations.
pub fn solve(
    patch: &Patch,
    material: &dyn Material,
    load: &DVector<f64>,
    fixed: impl Fn(usize, usize) -> bool,
    u: &mut [Vector2<f64>],
) -> usize {
    let size = patch.nodes.iter().map(|x| x.amax()).fold(0.0, f64::max);
    for iteration in 0..12 {
        let (force, mut tangent) = patch.forces_and_tangent(material, u).unwrap();
        let mut residual = load - &force;
        for dof in (0..residual.len()).filter(|dof| fixed(dof / 2, dof % 2)) {
            residual[dof] = 0.0;
            tangent.row_mut(dof).fill(0.0);
            tangent.column_mut(dof).fill(0.0);
            tangent[(dof, dof)] = 1.0;
        }
        if residual.amax() < 1e-14 * material.description().p_wave_modulus * size {
            return iteration;
        }
        let mut lu = DenseLu::default();
        lu.factorize_columns(residual.len(), tangent.as_slice().to_vec()).unwrap();
        lu.solve_columns(residual.as_mut_slice());
        for (a, u) in u.iter_mut().enumerate() {
            *u += residual.fixed_rows::<2>(2 * a);
        }
    }
    panic!("Newton has not converged for {:?} {:?}", patch.kind, patch.formulation);
}

/// Cook's membrane, clamped on the left, sheared upwards on the right with the total force 100:
/// rise of the upper right corner.
fn cook(kind: ElementKind, formulation: Formulation, n: usize, material: &dyn Material) -> f64 {
    let patch = Patch::new(kind, formulation, n, |s, t| Vector2::new(48.0 * s, 44.0 * s + t * (44.0 - 28.0 * s)));
    let mut load = DVector::<f64>::zeros(2 * patch.nodes.len());
    for (_, connectivity) in &patch.elements {
        for edge in 0..kind.corners() {
            let ([start, end], middle) = kind.edge(edge);
            let nodes: Vec<_> = [start, end].into_iter().chain(middle).map(|a| connectivity[a]).collect();
            if nodes.iter().all(|&a| patch.square[a].x == 1.0) {
                for (xi, weight) in gauss(3) {
                    for (&a, value) in nodes.iter().zip(edge_values(nodes.len(), xi)) {
                        load[2 * a + 1] += 0.5 * weight * value * 100.0 / n as f64;
                    }
                }
            }
        }
    }
    assert!((load.sum() - 100.0).abs() < 1e-12);
    let mut u = vec![Vector2::zeros(); patch.nodes.len()];
    for step in 1..=8 {
        let share = f64::from(step) / 8.0;
        let iterations = solve(&patch, material, &(share * &load), |a, _| patch.square[a].x == 0.0, &mut u);
        assert!(iterations <= 10, "Newton is not quadratic: {iterations} iterations");
    }
    let tip = patch.square.iter().position(|s| *s == Vector2::new(1.0, 1.0)).unwrap();
    u[tip].y
}

/// F-bar with 8, 16 and 24 elements a side rises by 6.68, 6.84, 6.87: to about 6.9. Q9 locks a little, too.
#[test]
fn f_bar_cures_locking_of_cooks_membrane() {
    let material = neo_hookean(240.565, 0.4999);
    let quadratic = cook(ElementKind::Q9, Displacement, 8, &*material);
    let locked = cook(ElementKind::Q4, Displacement, 8, &*material);
    let cured = cook(ElementKind::Q4, FBar, 8, &*material);
    println!("Q9 {quadratic}, Q4 {locked}, F-bar {cured}");
    assert!(locked < 0.4 * quadratic, "Q4 {locked}, Q9 {quadratic}");
    assert!(quadratic < cured && cured < 1.04 * quadratic, "F-bar {cured}, Q9 {quadratic}");
    assert!((cured - 6.9).abs() < 0.04 * 6.9, "F-bar {cured}");
}

#[test]
fn all_kinds_converge_to_the_same_compressible_solution() {
    let material = neo_hookean(240.565, 0.3);
    let converged = cook(ElementKind::Q9, Displacement, 8, &*material);
    for (kind, formulation) in VARIANTS {
        let error = |n| (cook(kind, formulation, n, &*material) - converged).abs() / converged;
        let (coarse, fine) = (error(4), error(8));
        println!("{kind:?} {formulation:?}: {coarse} {fine}");
        assert!(fine < 0.6 * coarse, "{kind:?} {formulation:?}: {coarse} {fine}");
    }
}
