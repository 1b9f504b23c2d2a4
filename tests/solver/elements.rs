//! Solid elements: patch test, rigid motion, tangent, rank, mass, and what F-bar is for.

mod locking;
mod memory;

use locking::solve;
use std::collections::HashMap;
use std::f64::consts::PI;

use fecontact::laws::bulk::{
    BulkLaw, BulkResponse, CauchyStress, ElasticConstants, Material, MaterialDescription, MaterialFailure,
    MaterialParameters, MaterialResponse, Sections, Straining, Viscoelastic, ViscoelasticConstants,
};
use fecontact::linear::DenseLu;
use fecontact::mesh::section::Section;
use fecontact::mesh::shape::{ElementKind, edge_values, gauss};
use fecontact::model::element::Formulation::{self, Displacement, FBar, Reduced};
use fecontact::model::element::{ElementError, Memory, SolidElement, consistent_mass, lumped_mass};
use nalgebra::{DMatrix, DVector, Matrix2, Rotation2, Vector2};

const KINDS: [ElementKind; 5] = [ElementKind::T3, ElementKind::T6, ElementKind::Q4, ElementKind::Q8, ElementKind::Q9];

/// Every kind, Q4 with F-bar, and Q8 with reduced integration.
const VARIANTS: [(ElementKind, Formulation); 7] = [
    (ElementKind::T3, Displacement),
    (ElementKind::T6, Displacement),
    (ElementKind::Q4, Displacement),
    (ElementKind::Q4, FBar),
    (ElementKind::Q8, Displacement),
    (ElementKind::Q8, Reduced),
    (ElementKind::Q9, Displacement),
];

const MODELS: [fn(ElasticConstants) -> MaterialParameters; 4] = [
    MaterialParameters::Linear,
    MaterialParameters::SaintVenantKirchhoff,
    MaterialParameters::NeoHookean,
    MaterialParameters::Hencky,
];

const E: f64 = 3.0;

fn neo_hookean(young: f64, poisson: f64) -> Box<dyn Material> {
    MaterialParameters::NeoHookean(ElasticConstants { young, poisson, density: 0.0 }).build().unwrap()
}

fn materials() -> impl Iterator<Item = Box<dyn Material>> {
    MODELS.iter().map(|model| model(ElasticConstants { young: E, poisson: 0.3, density: 0.0 }).build().unwrap())
}

/// Nodes of the elements that fill a cell, one quadrilateral or two triangles, in half sides of it.
pub fn lattices(kind: ElementKind) -> Vec<Vec<[usize; 2]>> {
    let corners: &[&[[usize; 2]]] = match kind.corners() {
        3 => &[&[[0, 0], [2, 0], [2, 2]], &[[0, 0], [2, 2], [0, 2]]],
        _ => &[&[[0, 0], [2, 0], [2, 2], [0, 2]]],
    };
    let lattice = |corners: &&[[usize; 2]]| {
        let middle = |edge| {
            let [a, b] = kind.edge(edge).0.map(|a| corners[a]);
            [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2]
        };
        let middles = (0..kind.corners()).map(middle).filter(|_| kind.nodes() > kind.corners());
        let centre = (kind == ElementKind::Q9).then_some([1, 1]);
        corners.iter().copied().chain(middles).chain(centre).collect()
    };
    corners.iter().map(lattice).collect()
}

/// A structured mesh of the unit square, mapped anywhere.
struct Patch {
    kind: ElementKind,
    formulation: Formulation,
    nodes: Vec<Vector2<f64>>,
    /// (s, t) in the unit square of each node
    square: Vec<Vector2<f64>>,
    elements: Vec<(SolidElement, Vec<usize>)>,
}

impl Patch {
    /// n × n cells, each one quadrilateral or two triangles.
    fn new(kind: ElementKind, formulation: Formulation, n: usize, map: impl Fn(f64, f64) -> Vector2<f64>) -> Self {
        Self::of_cells((kind, formulation), Section::PlaneStrain, [n, n], map)
    }

    /// Square cells of side 1, from x = 1 on.
    fn rectangle(kind: ElementKind, formulation: Formulation, section: Section, [columns, rows]: [usize; 2]) -> Self {
        let map = |s: f64, t: f64| Vector2::new(1.0 + columns as f64 * s, rows as f64 * t);
        Self::of_cells((kind, formulation), section, [columns, rows], map)
    }

    /// Columns and rows of cells of the unit square, mapped.
    fn of_cells(
        (kind, formulation): (ElementKind, Formulation),
        section: Section,
        [columns, rows]: [usize; 2],
        map: impl Fn(f64, f64) -> Vector2<f64>,
    ) -> Self {
        let mut patch = Self { kind, formulation, nodes: vec![], square: vec![], elements: vec![] };
        let mut numbers = HashMap::new();
        let halves = lattices(kind);
        for (cell, lattice) in (0..columns * rows).flat_map(|cell| halves.iter().map(move |half| (cell, half))) {
            let connectivity: Vec<usize> = lattice
                .iter()
                .map(|[i, j]| {
                    let at = [2 * (cell % columns) + i, 2 * (cell / columns) + j];
                    *numbers.entry(at).or_insert_with(|| {
                        let [s, t] = [at[0] as f64 / (2 * columns) as f64, at[1] as f64 / (2 * rows) as f64];
                        patch.square.push(Vector2::new(s, t));
                        patch.nodes.push(map(s, t));
                        patch.nodes.len() - 1
                    })
                })
                .collect();
            let positions: Vec<_> = connectivity.iter().map(|&a| patch.nodes[a]).collect();
            patch.elements.push((SolidElement::new(kind, formulation, section, &positions).unwrap(), connectivity));
        }
        patch
    }

    /// The unit square with its inside shaken and, for quadratic elements, its edges curved.
    fn distorted(kind: ElementKind, formulation: Formulation) -> Self {
        Self::new(kind, formulation, 2, |s, t| {
            let bubble = (PI * s).sin() * (PI * t).sin();
            Vector2::new(s + 0.11 * bubble + 0.05 * t * (1.0 - t), t - 0.08 * bubble + 0.06 * s * (1.0 - s))
        })
    }

    fn forces_and_tangent(
        &self,
        material: &dyn Material,
        u: &[Vector2<f64>],
    ) -> Result<(DVector<f64>, DMatrix<f64>), MaterialFailure> {
        let dofs = 2 * self.nodes.len();
        let (mut force, mut tangent) = (DVector::zeros(dofs), DMatrix::zeros(dofs, dofs));
        let n = 2 * self.kind.nodes();
        // Not a number at first: an element must write over what it is given.
        let (mut f, mut k) = (vec![f64::NAN; n], vec![f64::NAN; n * n]);
        for (element, connectivity) in &self.elements {
            let u: Vec<_> = connectivity.iter().map(|&a| u[a]).collect();
            element.force_and_tangent(material, &u, &mut f, &mut k)?;
            let dof: Vec<_> = connectivity.iter().flat_map(|a| [2 * a, 2 * a + 1]).collect();
            for (row, &i) in dof.iter().enumerate() {
                force[i] += f[row];
                for (column, &j) in dof.iter().enumerate() {
                    tangent[(i, j)] += k[row + column * n];
                }
            }
        }
        Ok((force, tangent))
    }

    fn is_inside(&self, node: usize) -> bool {
        self.square[node].iter().all(|s| 0.0 < *s && *s < 1.0)
    }
}

fn rotation(angle: f64) -> Matrix2<f64> {
    Rotation2::new(angle).into_inner()
}

/// Nodes of one distorted element, with curved sides if it has middle nodes.
fn distorted_element(kind: ElementKind) -> Vec<Vector2<f64>> {
    let patch = Patch::distorted(kind, Displacement);
    patch.elements[0].1.iter().map(|&a| patch.nodes[a]).collect()
}

/// Displacements with no pattern.
fn wild(nodes: usize, size: f64) -> Vec<Vector2<f64>> {
    (0..nodes).map(|a| size * Vector2::new((3.1 * a as f64 + 0.4).sin(), (5.7 * a as f64 - 1.0).cos())).collect()
}

fn differs(a: &CauchyStress, b: &CauchyStress) -> f64 {
    [a.xx - b.xx, a.yy - b.yy, a.zz - b.zz, a.xy - b.xy].into_iter().fold(0.0, |max, d| f64::max(max, d.abs()))
}

#[test]
fn homogeneous_deformation_passes_the_patch_test() {
    let deformations = [
        Matrix2::new(1.0 + 1e-6, 2e-6, -1e-6, 1.0 - 3e-6),
        Matrix2::new(1.1, 0.2, -0.05, 0.95),
        rotation(2.0) * Matrix2::new(1.8, 0.5, 0.1, 0.6),
    ];
    for (kind, formulation) in VARIANTS {
        let patch = Patch::distorted(kind, formulation);
        for material in materials() {
            for f in &deformations {
                let u: Vec<_> = patch.nodes.iter().map(|x| (f - Matrix2::identity()) * x).collect();
                let (force, _) = patch.forces_and_tangent(&*material, &u).unwrap();
                let largest = force.amax();
                for node in (0..u.len()).filter(|&a| patch.is_inside(a)) {
                    let residual = force.fixed_rows::<2>(2 * node).amax();
                    // Rounding of F = 1 + H is E × 1e-16, whatever the size of H.
                    assert!(
                        residual < 1e-12 * largest.max(1e-3 * E),
                        "{kind:?} {formulation:?} {material:?}: {residual}"
                    );
                }
                let expected = material.cauchy_stress(&Straining::new(*f, &[])).unwrap();
                for (element, connectivity) in &patch.elements {
                    let u: Vec<_> = connectivity.iter().map(|&a| u[a]).collect();
                    let at_points = element.stresses(&*material, &[], &u).unwrap();
                    assert_eq!(at_points.len(), element.quadrature().len());
                    for stress in &at_points {
                        assert!(
                            differs(stress, &expected) < 1e-13 * E,
                            "{kind:?} {formulation:?} {material:?} {stress:?}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn the_inside_of_a_patch_follows_its_boundary() {
    let f = Matrix2::new(1.2, 0.3, -0.1, 0.8);
    for (kind, formulation) in VARIANTS {
        let patch = Patch::distorted(kind, formulation);
        let exact: Vec<_> = patch.nodes.iter().map(|x| (f - Matrix2::identity()) * x).collect();
        let mut u: Vec<_> =
            (0..exact.len()).map(|a| if patch.is_inside(a) { 0.8 * exact[a] } else { exact[a] }).collect();
        let fixed = |a: usize, _| !patch.is_inside(a);
        solve(&patch, &*neo_hookean(E, 0.3), &DVector::zeros(2 * u.len()), fixed, &mut u);
        let error = u.iter().zip(&exact).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(error < 1e-13, "{kind:?} {formulation:?}: {error}");
    }
}

#[test]
fn rigid_motion_causes_no_force() {
    for (kind, formulation) in VARIANTS {
        let positions = distorted_element(kind);
        let element = SolidElement::new(kind, formulation, Section::PlaneStrain, &positions).unwrap();
        for material in materials().skip(1) {
            for angle in [0.0, 1e-8, 0.3, PI / 2.0, 3.0, -2.2] {
                let u: Vec<_> = positions.iter().map(|x| rotation(angle) * x - x + Vector2::new(5.0, -3.0)).collect();
                let mut force = vec![f64::NAN; 2 * kind.nodes()];
                let energy = element.force(&*material, &u, &mut force).unwrap();
                // u of size 5 rounds F − 1 to about 1e-15.
                assert!(force.iter().all(|f| f.abs() < 1e-13 * E), "{kind:?} {formulation:?} at {angle}: {force:?}");
                assert!(energy.abs() < 1e-26 * E, "{energy}");
            }
        }
    }
}

/// An initial stress that is another one at every point.
fn uneven() -> impl Iterator<Item = CauchyStress> {
    [-0.3, 0.1, 0.2, -0.2].into_iter().map(|p| CauchyStress { xx: p * E, yy: 0.4 * p * E, zz: 0.7 * p * E, xy: 0.0 })
}

#[test]
fn tangent_and_energy_agree_with_the_force_by_differences() {
    for (kind, formulation) in VARIANTS {
        let mut element = SolidElement::new(kind, formulation, Section::PlaneStrain, &distorted_element(kind)).unwrap();
        element.start_under(uneven());
        let (nodes, h) = (kind.nodes(), 1e-6);
        let u = wild(nodes, 0.04);
        for material in materials() {
            let (mut force, mut tangent) = (vec![0.0; 2 * nodes], vec![0.0; 4 * nodes * nodes]);
            let energy = element.force_and_tangent(&*material, &u, &mut force, &mut tangent).unwrap();
            let mut alone = vec![0.0; 2 * nodes];
            let energy_alone = element.force(&*material, &u, &mut alone).unwrap();
            assert!((energy_alone - energy).abs() < 1e-13 * energy, "{energy_alone} {energy}");
            assert!(alone.iter().zip(&force).all(|(a, b)| (a - b).abs() < 1e-14 * E), "{alone:?} {force:?}");

            let forces_at = |column: usize, h: f64| {
                let (mut u, mut force) = (u.clone(), vec![0.0; 2 * nodes]);
                u[column / 2][column % 2] += h;
                (element.force(&*material, &u, &mut force).unwrap(), force)
            };
            for column in 0..2 * nodes {
                let ((energy_hi, hi), (energy_lo, lo)) = (forces_at(column, h), forces_at(column, -h));
                for row in 0..2 * nodes {
                    let (exact, difference) = (tangent[row + column * 2 * nodes], (hi[row] - lo[row]) / (2.0 * h));
                    assert!(
                        (exact - difference).abs() < 1e-8 * E,
                        "{kind:?} {formulation:?} {material:?}: {exact} {difference}"
                    );
                }
                assert!((force[column] - (energy_hi - energy_lo) / (2.0 * h)).abs() < 1e-9 * E);
            }
        }
    }
}

#[test]
fn forces_balance_and_turn_with_the_element() {
    let q = rotation(1.1);
    for (kind, formulation) in VARIANTS {
        let positions = distorted_element(kind);
        let element = SolidElement::new(kind, formulation, Section::PlaneStrain, &positions).unwrap();
        let u = wild(kind.nodes(), 0.04);
        let turned: Vec<_> = u.iter().zip(&positions).map(|(u, x)| q * (x + u) - x).collect();
        for material in materials().skip(1) {
            let (mut here, mut there) = (vec![0.0; 2 * kind.nodes()], vec![0.0; 2 * kind.nodes()]);
            element.force(&*material, &u, &mut here).unwrap();
            element.force(&*material, &turned, &mut there).unwrap();
            let (mut sum, mut moment) = (Vector2::zeros(), 0.0);
            for a in 0..kind.nodes() {
                let (f, g) = (Vector2::new(here[2 * a], here[2 * a + 1]), Vector2::new(there[2 * a], there[2 * a + 1]));
                assert!((q * f - g).norm() < 1e-14 * E, "{kind:?} {formulation:?}");
                sum += f;
                moment += (positions[a] + u[a]).perp(&f);
            }
            assert!(sum.norm() < 1e-14 * E && moment.abs() < 1e-14 * E, "{kind:?} {formulation:?}: {sum} {moment}");
        }
    }
}

/// Σ_a f_a ⊗ x_a = ∫ σ dv over the current element, whatever the stress field; dv = J̄ dV in F-bar.
#[test]
fn stresses_are_those_that_cause_the_forces() {
    for (kind, formulation) in VARIANTS {
        let positions = distorted_element(kind);
        let element = SolidElement::new(kind, formulation, Section::PlaneStrain, &positions).unwrap();
        let u = wild(kind.nodes(), 0.04);
        let x: Vec<_> = positions.iter().zip(&u).map(|(x, u)| x + u).collect();
        for material in materials().skip(1) {
            let mut force = vec![0.0; 2 * kind.nodes()];
            element.force(&*material, &u, &mut force).unwrap();
            let virial: Matrix2<f64> =
                force.chunks(2).zip(&x).map(|(f, x)| Vector2::new(f[0], f[1]) * x.transpose()).sum();
            let stresses = element.stresses(&*material, &[], &u).unwrap();
            let [mut mean, mut whole] = [0.0; 2];
            let mut integral = Matrix2::zeros();
            for (point, stress) in element.quadrature().iter().zip(stresses) {
                let map = |at: &[Vector2<f64>]| -> f64 {
                    let derivatives = kind.derivatives(point.at).into_iter().map(Vector2::from);
                    at.iter().zip(derivatives).map(|(x, d)| x * d.transpose()).sum::<Matrix2<f64>>().determinant()
                };
                let sigma = Matrix2::new(stress.xx, stress.xy, stress.xy, stress.yy);
                let volume = point.weight * map(&positions);
                mean += volume * (map(&x) / map(&positions)).ln();
                whole += volume;
                integral += if formulation == FBar { volume } else { point.weight * map(&x) } * sigma;
            }
            if formulation == FBar {
                integral *= f64::exp(mean / whole);
            }
            assert!((virial - integral).amax() < 1e-14 * E, "{kind:?} {formulation:?}: {virial} {integral}");
        }
    }
}

#[test]
fn only_the_three_rigid_motions_are_free() {
    for (kind, formulation) in VARIANTS {
        let nodes = kind.nodes();
        let element = SolidElement::new(kind, formulation, Section::PlaneStrain, &distorted_element(kind)).unwrap();
        let (mut force, mut tangent) = (vec![0.0; 2 * nodes], vec![0.0; 4 * nodes * nodes]);
        let at_rest = vec![Vector2::zeros(); nodes];
        element.force_and_tangent(&*neo_hookean(E, 0.3), &at_rest, &mut force, &mut tangent).unwrap();
        let singular = DMatrix::from_vec(2 * nodes, 2 * nodes, tangent).singular_values();
        // A reduced element has a motion of its own that costs nothing, until it shares an edge (below).
        let free = if formulation == Reduced { 4 } else { 3 };
        let (largest, rank) = (singular.max(), 2 * nodes - free);
        assert_eq!(
            singular.iter().filter(|s| **s > 1e-3 * largest).count(),
            rank,
            "{kind:?} {formulation:?}: {singular}"
        );
        assert_eq!(
            singular.iter().filter(|s| **s < 1e-13 * largest).count(),
            free,
            "{kind:?} {formulation:?}: {singular}"
        );
    }
}

/// Reduced elements that share edges have no motions besides the rigid ones that cost nothing; rings have one of these.
#[test]
fn patches_of_reduced_elements_have_no_motion_without_forces() {
    for (section, rigid) in [(Section::PlaneStrain, 3), (Section::Axisymmetric, 1)] {
        for [columns, rows] in [[2, 1], [1, 3], [2, 2], [4, 1]] {
            let patch = Patch::rectangle(ElementKind::Q8, Reduced, section, [columns, rows]);
            let at_rest = vec![Vector2::zeros(); patch.nodes.len()];
            let (_, tangent) = patch.forces_and_tangent(&*neo_hookean(E, 0.3), &at_rest).unwrap();
            let singular = tangent.singular_values();
            let free = singular.iter().filter(|s| **s < 1e-12 * singular.max()).count();
            let soft = singular.iter().filter(|s| **s < 1e-6 * singular.max()).count();
            assert_eq!((free, soft), (rigid, rigid), "{columns} x {rows} {section:?}: {singular}");
        }
    }
}

#[test]
fn mass_is_complete_and_carries_rigid_motion() {
    let density = 7.8;
    for kind in KINDS {
        let positions = distorted_element(kind);
        let total = density * SolidElement::new(kind, Displacement, Section::PlaneStrain, &positions).unwrap().volume();
        let consistent = consistent_mass(kind, Section::PlaneStrain, &positions, density).unwrap();
        let lumped = lumped_mass(kind, Section::PlaneStrain, &positions, density).unwrap();
        assert!((consistent.sum() - total).abs() < 1e-14 * total, "{kind:?}");
        assert!((lumped.sum() - total).abs() < 1e-14 * total, "{kind:?}");
        assert!(lumped.min() > 0.0, "{kind:?}: {lumped}");
        assert!((&consistent - consistent.transpose()).amax() < 1e-16 * total);
        assert!(consistent.symmetric_eigenvalues().min() > 0.0, "{kind:?}");
        assert_eq!(lumped_mass(kind, Section::PlaneStrain, &positions, 0.0).unwrap().amax(), 0.0);
    }
}

#[test]
fn rotating_rectangle_has_its_kinetic_energy() {
    // Turning with rate 1 about its corner, a body has T = I/2, I = ρ ∫ (x² + y²) dV = ρ a b (a² + b²)/3.
    let (density, a, b) = (2.0, 3.0, 2.0);
    let exact = density * a * b * (a * a + b * b) / 6.0;
    for kind in KINDS {
        let patch = Patch::new(kind, Displacement, 2, |s, t| Vector2::new(a * s, b * t));
        let mut energy = 0.0;
        for (_, connectivity) in &patch.elements {
            let positions: Vec<_> = connectivity.iter().map(|&a| patch.nodes[a]).collect();
            let mass = consistent_mass(kind, Section::PlaneStrain, &positions, density).unwrap();
            for velocity in [0, 1].map(|i| DVector::from_iterator(kind.nodes(), positions.iter().map(|x| x[i]))) {
                energy += 0.5 * velocity.dot(&(mass.clone() * &velocity));
            }
        }
        assert!((energy - exact).abs() < 1e-14 * exact, "{kind:?}: {energy} for {exact}");
    }
}

#[test]
fn what_cannot_be_is_reported() {
    let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]].map(Vector2::from);
    let mut clockwise = square;
    clockwise.reverse();
    for (positions, jacobian) in [(clockwise, -0.5), ([Vector2::zeros(); 4], 0.0)] {
        let error = SolidElement::new(ElementKind::Q4, Displacement, Section::PlaneStrain, &positions).unwrap_err();
        assert_eq!(error, ElementError::Degenerate { jacobian });
        assert!(consistent_mass(ElementKind::Q4, Section::PlaneStrain, &positions, 1.0).is_err());
    }
    for kind in [ElementKind::T3, ElementKind::T6, ElementKind::Q8, ElementKind::Q9] {
        let error = SolidElement::new(kind, FBar, Section::PlaneStrain, &distorted_element(kind)).unwrap_err();
        assert_eq!(error, ElementError::FBarNeedsQ4 { kind });
    }
    for kind in [ElementKind::T3, ElementKind::T6, ElementKind::Q4, ElementKind::Q9] {
        let error = SolidElement::new(kind, Reduced, Section::PlaneStrain, &distorted_element(kind)).unwrap_err();
        assert_eq!(error, ElementError::ReducedNeedsQ8 { kind });
    }
    let mirrored: Vec<_> = square.iter().map(|x| Vector2::new(-2.5 * x.x, 0.0)).collect();
    for formulation in [Displacement, FBar] {
        let element = SolidElement::new(ElementKind::Q4, formulation, Section::PlaneStrain, &square).unwrap();
        let failure = element.force(&*neo_hookean(E, 0.3), &mirrored, &mut [0.0; 8]).unwrap_err();
        let MaterialFailure::Inverted { jacobian } = failure else { panic!("{failure}") };
        assert!((jacobian + 1.5).abs() < 1e-14, "{jacobian}");
        assert!(element.stresses(&*neo_hookean(E, 0.3), &[], &mirrored).is_err());
    }
}

/// Places of a distorted element of rings, whose left side is at the radius `r`; it may touch the axis.
fn ring_positions(kind: ElementKind, r: f64) -> Vec<Vector2<f64>> {
    let left = distorted_element(kind).iter().map(|x| x.x).fold(f64::INFINITY, f64::min);
    distorted_element(kind).iter().map(|x| x + Vector2::new(r - left, 0.0)).collect()
}

/// Force and tangent of rings by differences of energy and force, of all laws and kinds; elements on the axis, too.
#[test]
fn tangent_and_energy_of_rings_agree_with_the_force_by_differences() {
    for ((kind, formulation), r) in VARIANTS.into_iter().flat_map(|variant| [0.0, 0.7].map(|r| (variant, r))) {
        let mut element =
            SolidElement::new(kind, formulation, Section::Axisymmetric, &ring_positions(kind, r)).unwrap();
        element.start_under(uneven());
        let (nodes, h) = (kind.nodes(), 1e-6);
        let u = wild(nodes, 0.01);
        for material in materials() {
            let (mut force, mut tangent) = (vec![0.0; 2 * nodes], vec![0.0; 4 * nodes * nodes]);
            let energy = element.force_and_tangent(&*material, &u, &mut force, &mut tangent).unwrap();
            let mut alone = vec![Vector2::zeros(); nodes];
            assert_eq!(element.nodal_forces(&*material, &u, &mut alone).unwrap(), energy);
            assert!(alone.iter().flatten().zip(&force).all(|(a, b)| a == b));
            let largest = tangent.iter().fold(0.0f64, |most, entry| most.max(entry.abs()));
            let at = |column: usize, h: f64| {
                let (mut u, mut force) = (u.clone(), vec![0.0; 2 * nodes]);
                u[column / 2][column % 2] += h;
                (element.force(&*material, &u, &mut force).unwrap(), force)
            };
            for column in 0..2 * nodes {
                let ((energy_hi, hi), (energy_lo, lo)) = (at(column, h), at(column, -h));
                for row in 0..2 * nodes {
                    let (exact, difference) = (tangent[row + column * 2 * nodes], (hi[row] - lo[row]) / (2.0 * h));
                    assert!(
                        (exact - difference).abs() < 1e-8 * largest,
                        "{kind:?} {formulation:?} at {r} {material:?}: {exact} {difference}"
                    );
                }
                let work = (energy_hi - energy_lo) / (2.0 * h);
                assert!((force[column] - work).abs() < 1e-9 * largest, "{kind:?} {work} {}", force[column]);
            }
        }
    }
}

/// Viscous forces of rings: their derivatives by differences, and none in a motion along the axis.
#[test]
fn viscous_forces_of_rings_agree_with_differences() {
    for kind in KINDS {
        let element = SolidElement::new(kind, Displacement, Section::Axisymmetric, &ring_positions(kind, 0.2)).unwrap();
        let (nodes, h, tau) = (kind.nodes(), 1e-6, 0.3);
        let (u, v) = (wild(nodes, 0.01), wild(nodes, 0.5));
        let rates: Vec<f64> = (0..2 * nodes).map(|dof| 2.0 + (dof as f64).sin()).collect();
        for material in materials() {
            let mut tangent = vec![0.0; 4 * nodes * nodes];
            element.viscous_tangent(&*material, tau, [&u, &v], &rates, &mut tangent);
            let at = |column: usize, h: f64| {
                let (mut u, mut v, mut forces) = (u.clone(), v.clone(), vec![Vector2::zeros(); nodes]);
                u[column / 2][column % 2] += h;
                v[column / 2][column % 2] += rates[column] * h;
                element.viscous_forces(&*material, tau, [&u, &v], &mut forces);
                forces
            };
            for column in 0..2 * nodes {
                let (hi, lo) = (at(column, h), at(column, -h));
                for row in 0..2 * nodes {
                    let difference = (hi[row / 2][row % 2] - lo[row / 2][row % 2]) / (2.0 * h);
                    let exact = tangent[row + column * 2 * nodes];
                    assert!((exact - difference).abs() < 1e-7 * E, "{kind:?} {material:?}: {exact} {difference}");
                }
            }
            let (up, mut forces) = (vec![Vector2::new(0.0, 3.0); nodes], vec![Vector2::zeros(); nodes]);
            element.viscous_forces(&*material, tau, [&u, &up], &mut forces);
            assert!(forces.iter().all(|force| force.amax() < 1e-13 * E), "{kind:?} {material:?}: {forces:?}");
        }
    }
}

/// u_r = a R, u_z = b Z + c: F = diag(1 + a, 1 + b, 1 + a) everywhere, on the axis too, and so is the stress; forces balance
/// along the axis, and f·X = ∫ P:(F-gradient of X) dV holds.
#[test]
fn a_homogeneous_stretch_of_rings_passes_the_patch_test() {
    let (a, b) = (0.08, -0.05);
    for ((kind, formulation), r) in VARIANTS.into_iter().flat_map(|variant| [0.0, 0.7].map(|r| (variant, r))) {
        let positions = ring_positions(kind, r);
        let element = SolidElement::new(kind, formulation, Section::Axisymmetric, &positions).unwrap();
        let u: Vec<_> = positions.iter().map(|x| Vector2::new(a * x.x, b * x.y + 3.0)).collect();
        for material in materials() {
            let deformation = Matrix2::new(1.0 + a, 0.0, 0.0, 1.0 + b);
            let straining =
                fecontact::laws::bulk::Straining { deformation, stretch: 1.0 + a, dt: 0.0, old: &[], tangent: true };
            let (sigma, piola) =
                (material.cauchy_stress(&straining).unwrap(), material.respond(&straining, &mut []).unwrap());
            for stress in element.stresses(&*material, &[], &u).unwrap() {
                assert!(differs(&stress, &sigma) < 1e-13 * E, "{kind:?} {formulation:?}: {stress:?} for {sigma:?}");
                assert!((stress.xx - stress.zz).abs() < 1e-13 * E);
            }
            let mut force = vec![0.0; 2 * kind.nodes()];
            let energy = element.force(&*material, &u, &mut force).unwrap();
            let volume = element.volume();
            assert!((energy - volume * piola.energy).abs() < 1e-12 * volume * E);
            let sum: f64 = force.iter().skip(1).step_by(2).sum();
            assert!(sum.abs() < 1e-13 * E * volume, "{sum}");
            // Of the virtual motion δu = X, δF = 1.
            let virial: f64 = (0..2 * kind.nodes()).map(|dof| force[dof] * positions[dof / 2][dof % 2]).sum();
            let expected = volume * (piola.stress[0] + piola.stress[3] + piola.stress[4]);
            assert!((virial - expected).abs() < 1e-12 * volume * E, "{kind:?}: {virial} for {expected}");
        }
    }
}

#[test]
fn shape_functions_sum_to_one_and_derivatives_match_differences() {
    for kind in KINDS {
        let (at, h) = ([0.21, 0.34], 1e-6);
        assert!((kind.values(at).iter().sum::<f64>() - 1.0).abs() < 1e-14);
        let d = kind.derivatives(at);
        for axis in 0..2 {
            let (mut hi, mut lo) = (at, at);
            hi[axis] += h;
            lo[axis] -= h;
            for (a, (p, m)) in kind.values(hi).iter().zip(kind.values(lo)).enumerate() {
                assert!(((p - m) / (2.0 * h) - d[a][axis]).abs() < 1e-9, "{kind:?} node {a}");
            }
        }
    }
}

#[test]
fn rules_integrate_monomials_of_their_degree_exactly() {
    let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
    for (kind, rule, degree) in [
        (ElementKind::T6, ElementKind::T6.quadrature(), 2),
        (ElementKind::T6, ElementKind::T6.mass_quadrature(), 4),
        (ElementKind::Q4, ElementKind::Q4.quadrature(), 3),
        (ElementKind::Q9, ElementKind::Q9.quadrature(), 5),
    ] {
        for i in 0..=degree {
            for j in 0..=degree - i {
                let sum: f64 = rule.iter().map(|p| p.weight * p.at[0].powi(i) * p.at[1].powi(j)).sum();
                let exact = if kind.corners() == 3 {
                    factorial(i) * factorial(j) / factorial(i + j + 2)
                } else {
                    let line = |k: i32| {
                        if k % 2 == 0 { 2.0 / f64::from(k + 1) } else { 0.0 }
                    };
                    line(i) * line(j)
                };
                assert!((sum - exact).abs() < 1e-13, "{kind:?} x^{i} y^{j}: {sum} for {exact}");
            }
        }
    }
    for n in 1..=4 {
        for k in 0..2 * n as i32 {
            let sum: f64 = gauss(n).iter().map(|(x, w)| w * x.powi(k)).sum();
            let exact = if k % 2 == 0 { 2.0 / f64::from(k + 1) } else { 0.0 };
            assert!((sum - exact).abs() < 1e-14);
        }
    }
}
