//! Laws with memory and laws without a potential in elements.

use super::*;

/// A law without a potential: its stress is turned against the strain, P = C·(F − 1) R with R a quarter turn of the rows.
#[derive(Debug)]
struct Turning;

impl BulkLaw for Turning {
    fn description(&self) -> MaterialDescription<'_> {
        let sections = Sections::PlaneStrain;
        MaterialDescription { is_symmetric: false, sections, ..MaterialDescription::new(0.0, E, E) }
    }

    fn respond(&self, straining: &Straining, _: &mut [f64]) -> Result<BulkResponse, MaterialFailure> {
        let strain = straining.deformation - Matrix2::identity();
        let tangent = nalgebra::Matrix4::from_fn(|i, j| E * if i == j { 1.0 } else { 0.3 * i as f64 - 0.1 * j as f64 });
        let stress = tangent * nalgebra::Vector4::from_column_slice(strain.as_slice());
        let stress = Matrix2::from_column_slice(stress.as_slice());
        Ok(MaterialResponse::new(stress, tangent, 0.0).into())
    }
}

/// Forces of an element of a law that remembers, or has no symmetric tangent, and their differences: every kind, F-bar too.
#[test]
fn the_tangent_of_memory_and_of_laws_without_a_potential_equals_differences() {
    let constants = ViscoelasticConstants { young: E, poisson: 0.3, relaxing: 2.0 * E, tau: 0.7, density: 0.0 };
    let laws: [Box<dyn Material>; 2] = [Box::new(Viscoelastic::new(&constants).unwrap()), Box::new(Turning)];
    for (kind, formulation) in VARIANTS {
        let patch = Patch::distorted(kind, formulation);
        for (material, (element, nodes)) in laws.iter().zip([&patch.elements[0], &patch.elements[0]]) {
            let count = element.quadrature_points() * material.description().variables.len();
            let motion = |share: f64| -> Vec<Vector2<f64>> {
                let bend = |x: Vector2<f64>| Vector2::new(0.2 * x.y * x.y + 0.1 * x.x, -0.15 * x.x * x.y + 0.2 * x.x);
                nodes.iter().map(|&a| share * bend(patch.nodes[a])).collect()
            };
            let mut old = vec![0.0; count];
            let (zero, n) = (vec![0.0; count], 2 * nodes.len());
            let mut force = vec![0.0; n];
            let first = Memory { dt: 0.5, old: &zero, new: &mut old };
            element.evolve(&**material, first, &motion(0.4), &mut force, None).unwrap();
            let answer = |u: &[Vector2<f64>]| {
                let (mut force, mut tangent, mut new) = (vec![0.0; n], vec![0.0; n * n], vec![0.0; count]);
                let memory = Memory { dt: 0.3, old: &old, new: &mut new };
                element.evolve(&**material, memory, u, &mut force, Some(&mut tangent)).unwrap();
                (DVector::from_vec(force), DMatrix::from_vec(n, n, tangent))
            };
            let u = motion(1.0);
            let (_, tangent) = answer(&u);
            let h = 1e-6;
            for column in 0..n {
                let moved = |step: f64| {
                    let mut u = u.clone();
                    u[column / 2][column % 2] += step;
                    answer(&u).0
                };
                let error = ((moved(h) - moved(-h)) / (2.0 * h) - tangent.column(column)).amax();
                assert!(error < 1e-7 * tangent.amax(), "{kind:?} {formulation:?} {material:?}: {error}");
            }
            let unsymmetric = (&tangent - tangent.transpose()).amax() / tangent.amax();
            assert_eq!(
                unsymmetric < 1e-12,
                material.description().is_symmetric,
                "{kind:?} {material:?}: {unsymmetric}"
            );
        }
    }
}

/// A body of a law without memory is answered the same on the way of those with memory.
#[test]
fn both_ways_through_an_element_agree() {
    for (kind, formulation) in VARIANTS {
        let patch = Patch::distorted(kind, formulation);
        let (element, nodes) = &patch.elements[0];
        let n = 2 * nodes.len();
        let u: Vec<_> = nodes.iter().map(|&a| 0.1 * patch.nodes[a].map(|x| x * x)).collect();
        for material in materials() {
            let [mut force, mut other] = [vec![0.0; n], vec![0.0; n]];
            let [mut tangent, mut by_memory] = [vec![0.0; n * n], vec![0.0; n * n]];
            let energy = element.force_and_tangent(&*material, &u, &mut force, &mut tangent).unwrap();
            let memory = Memory { dt: 1.0, old: &[], new: &mut [] };
            let [stored, dissipated] =
                element.evolve(&*material, memory, &u, &mut other, Some(&mut by_memory)).unwrap();
            assert!((stored - energy).abs() < 1e-14 * E && dissipated == 0.0);
            let differ = |a: &[f64], b: &[f64]| a.iter().zip(b).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
            assert!(differ(&force, &other) < 1e-14 * E && differ(&tangent, &by_memory) < 1e-13 * E, "{kind:?}");
        }
    }
}
