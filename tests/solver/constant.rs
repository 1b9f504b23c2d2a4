//! Elements whose stiffness never changes, which are evaluated from what is stored of them, against every element by itself.

use std::collections::HashMap;
use std::sync::Arc;

use super::elements::lattices;
use crate::common::{Blocks, elastic, linear, neo_hookean};
use fecontact::equations::sums::Dependence;
use fecontact::equations::term::Term;
use fecontact::equations::{Assembler, Trial};
use fecontact::laws::bulk::{
    BulkLaw, BulkResponse, Linear, Material, MaterialDescription, MaterialFailure, Straining, Viscoelastic,
    ViscoelasticConstants,
};
use fecontact::linear::system::Request;
use fecontact::mesh::{ElementKind, InlineMesh, Mesh, Section};
use fecontact::model::boundary::Profile;
use fecontact::model::builder::{Builder, LoadStep};
use fecontact::model::element::Memory;
use fecontact::model::{Damping, InitialStress, Model, Scheme};
use nalgebra::{DMatrix, Matrix2, Vector2, Vector5};

const KINDS: [ElementKind; 5] = [ElementKind::T3, ElementKind::T6, ElementKind::Q4, ElementKind::Q8, ElementKind::Q9];

const NAMES: [&str; 3] = ["left", "middle", "right"];

/// A strip of 6 × 3 cells of side 1/4, each a quadrilateral or two triangles, in three bodies of two columns that share the
/// nodes between them; `map` moves the nodes.
fn strip(kind: ElementKind, section: Section, map: impl Fn([f64; 2]) -> [f64; 2]) -> Mesh {
    let mut mesh = InlineMesh::default();
    let mut numbers = HashMap::new();
    for (i, j) in (0..18).map(|cell| (cell % 6, cell / 6)) {
        for lattice in lattices(kind) {
            let number = |&[a, b]: &[usize; 2]| {
                let at = [2 * i + a, 2 * j + b];
                *numbers.entry(at).or_insert_with(|| {
                    mesh.nodes.push(map(at.map(|k| k as f64 / 8.0)));
                    mesh.nodes.len() - 1
                })
            };
            let element = lattice.iter().map(number).collect();
            mesh.elements.entry(NAMES[i / 2].into()).or_default().push(element);
        }
    }
    Mesh { section, ..mesh.build().expect("a good mesh") }
}

/// Distorted and, for quadratic elements, with curved edges.
fn distorted([x, y]: [f64; 2]) -> [f64; 2] {
    [x + 0.03 * (5.0 * y).sin() + 0.01 * (9.0 * x).cos(), y + 0.02 * (4.0 * x + y).sin()]
}

/// A model of the three bodies in a dynamic step.
fn built(mesh: Mesh, laws: [Box<dyn Material>; 3], retardations: [f64; 3]) -> Arc<Model> {
    of_step(bodies(mesh, laws, retardations))
}

fn bodies(mesh: Mesh, laws: [Box<dyn Material>; 3], retardations: [f64; 3]) -> Builder {
    let mut builder = Model::builder(mesh);
    for ((name, law), retardation) in NAMES.into_iter().zip(laws).zip(retardations) {
        builder = builder.body(name, law).damping(name, Damping { mass: 0.0, retardation });
    }
    builder
}

fn of_step(builder: Builder) -> Arc<Model> {
    let step = LoadStep::new("step", 1.0).dt(0.1).scheme(Scheme::Newmark { beta: 0.25, gamma: 0.5 });
    Arc::new(builder.step(step).build().expect("a good model"))
}

/// A number between −1 and 1, the same for the same k.
fn arbitrary(k: usize) -> f64 {
    2.0 * ((k as f64 + 1.0) * 0.618_033_988_749_895).fract() - 1.0
}

fn arbitrary_motion(model: &Model, size: f64, first: usize) -> Vec<f64> {
    (0..model.dofs()).map(|dof| size * arbitrary(dof + first)).collect()
}

/// What all elements say, one after the other: forces, viscous forces, the sums of their magnitudes, tangent, stored energy.
struct Direct {
    force: Vec<f64>,
    viscous: Vec<f64>,
    magnitudes: [Vec<f64>; 2],
    tangent: DMatrix<f64>,
    energy: f64,
}

fn direct(model: &Model, u: &[f64], v: &[f64]) -> Direct {
    let n = model.dofs();
    let zero = vec![0.0; n];
    let memory = model.initial_state().memory;
    let mut sum = Direct {
        force: zero.clone(),
        viscous: zero.clone(),
        magnitudes: [zero.clone(), zero],
        tangent: DMatrix::zeros(n, n),
        energy: 0.0,
    };
    for (e, element) in model.mesh.elements.iter().enumerate() {
        let body = &model.bodies[model.body_of_element[e]];
        let [local_u, local_v] = [u, v].map(|all| -> Vec<Vector2<f64>> {
            element.nodes.iter().map(|&node| Vector2::new(all[2 * node], all[2 * node + 1])).collect()
        });
        let dofs: Vec<usize> = element.nodes.iter().flat_map(|node| [2 * node, 2 * node + 1]).collect();
        let (mut force, mut tangent) = (vec![0.0; dofs.len()], vec![0.0; dofs.len() * dofs.len()]);
        let solid = &model.solids[e];
        let old = model.memories.of(e, &memory);
        sum.energy += match old {
            [] => solid.force_and_tangent(&*body.material, &local_u, &mut force, &mut tangent).expect("finite"),
            _ => {
                let memory = Memory { dt: 0.1, old, new: &mut old.to_vec() };
                solid.evolve(&*body.material, memory, &local_u, &mut force, Some(&mut tangent)).expect("finite")[0]
            }
        };
        let mut viscous = vec![Vector2::zeros(); element.nodes.len()];
        if body.damping.retardation > 0.0 {
            solid.viscous_forces(&*body.material, body.damping.retardation, [&local_u, &local_v], &mut viscous);
        }
        for (a, &i) in dofs.iter().enumerate() {
            let viscous = viscous[a / 2][a % 2];
            sum.force[i] += force[a];
            sum.viscous[i] += viscous;
            sum.magnitudes[0][i] += force[a].abs();
            sum.magnitudes[1][i] += viscous.abs();
            dofs.iter().enumerate().for_each(|(b, &j)| sum.tangent[(i, j)] += tangent[b * dofs.len() + a]);
        }
    }
    sum
}

/// Assert that two vectors differ by no more than a few roundings of what was summed up.
#[track_caller]
fn agree(what: &str, found: &[f64], expected: &[f64], magnitudes: &[f64]) {
    let largest = magnitudes.iter().fold(0.0f64, |largest, x| largest.max(*x));
    assert!(largest > 0.0, "{what}: nothing to compare");
    for ((found, expected), magnitude) in found.iter().zip(expected).zip(magnitudes) {
        let apart = (found - expected).abs();
        assert!(apart <= 1e-14 * (magnitude + largest), "{what}: {found:e}, by themselves {expected:e}");
    }
}

/// Forces, viscous forces, magnitudes, stored energy and tangent of a model against the sums of its elements by themselves.
fn check(what: &str, model: &Arc<Model>) {
    let mut assembler = Assembler::new(model);
    let (state, step) = (model.initial_state(), &model.steps[0]);
    let trial = Trial::new(&state, step, 0.1, 0.1);
    let [u, v] = [arbitrary_motion(model, 0.01, 0), arbitrary_motion(model, 0.3, 5)];
    let expected = direct(model, &u, &v);
    let [elastic, viscous] = &expected.magnitudes;
    assembler.forces(trial, &u, None).expect("forces");
    agree(what, &assembler.evaluation.force, &expected.force, elastic);
    let energy = assembler.evaluation.strain_energy;
    assert!((energy - expected.energy).abs() < 1e-13 * expected.energy, "{what}: {energy} for {}", expected.energy);
    if model.is_viscous(step) {
        assembler.forces(trial, &u, Some(&v)).expect("forces");
        let damping: Vec<f64> = assembler.evaluation.damping.iter().map(|damping| -damping).collect();
        agree(what, &damping, &expected.viscous, viscous);
        let both = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a + b).collect() };
        let all = both(&expected.force, &expected.viscous);
        agree(what, &assembler.evaluation.force, &all, &both(elastic, viscous));
        // Implicitly the velocity follows from the displacement: v = 2 Δu/Δt by the trapezoidal rule.
        let v: Vec<f64> = u.iter().map(|u| 20.0 * u).collect();
        let expected = direct(model, &u, &v);
        let mut system = assembler.system();
        assembler.assemble(trial, &u, &[], Request::Tangent, &mut system).expect("a tangent");
        let viscous: Vec<f64> = assembler.evaluation.damping.iter().map(|damping| -damping).collect();
        agree(what, &viscous, &expected.viscous, &expected.magnitudes[1]);
        let mass = assembler.mass().clone();
        let inertia = mass.multiply(&u.iter().map(|u| 400.0 * u).collect::<Vec<_>>());
        let sums = expected.magnitudes[0].iter().zip(&expected.magnitudes[1]).zip(&inertia);
        let magnitudes = sums.map(|((elastic, viscous), inertia)| (elastic + viscous + inertia.abs()).powi(2));
        let forces = magnitudes.sum::<f64>().sqrt();
        assert!((system.forces - forces).abs() < 1e-13 * forces, "{what}: magnitudes {} for {forces}", system.forces);
    }
    let tangent = assembler.tangent_of(Term::Solids, trial, &u).expect("a tangent");
    for dof in 0..model.dofs() {
        let mut unit = vec![0.0; model.dofs()];
        unit[dof] = 1.0;
        let column = expected.tangent.column(dof);
        let magnitudes: Vec<f64> = column.iter().map(|entry| entry.abs()).collect();
        agree(what, &tangent.multiply(&unit), column.as_slice(), &magnitudes);
    }
}

/// All kinds of elements, equal ones and all different, in plane strain and with a depth that varies; linear bodies of two
/// stiffnesses beside each other and beside one that is not linear, with and without viscosity.
#[test]
fn stored_elements_answer_as_each_by_itself() {
    let graded = Section::Graded { depth: 0.7, slope: [0.1, -0.3] };
    for kind in KINDS {
        for (map, section) in [
            (distorted as fn([f64; 2]) -> [f64; 2], Section::PlaneStrain),
            (|x| x, Section::PlaneStrain),
            (|x| x, graded),
            (|x| x, Section::PlaneStress { thickness: 0.3 }),
            (distorted, Section::PlaneStress { thickness: 0.3 }),
            (|[x, y]| [x + 0.5, y], Section::Axisymmetric),
            (|[x, y]| distorted([x + 0.5, y]), Section::Axisymmetric),
        ] {
            for retardations in [[0.0; 3], [0.0, 0.02, 0.0], [0.01, 0.02, 0.03]] {
                let laws = || -> [Box<dyn Material>; 3] {
                    [linear(100.0, 0.3, 2.0), linear(300.0, 0.2, 1.0), linear(50.0, 0.4, 3.0)]
                };
                let mut with_another = laws();
                with_another[2] = neo_hookean(50.0, 0.4, 3.0);
                for laws in [laws(), with_another] {
                    let what = format!("{kind:?} in {section:?}, {laws:?}, retardations {retardations:?}");
                    check(&what, &built(strip(kind, section, map), laws, retardations));
                }
            }
        }
    }
}

/// The same with initial stresses that vary from place to place, in two of the bodies: K_e is not found again for them, and
/// what they remember stays.
#[test]
fn stressed_elements_answer_as_each_by_itself() {
    let stress = |at: [f64; 2], section: Section| {
        let table =
            |axis: usize, [start, end]: [f64; 2]| [Profile::X, Profile::Y][axis](vec![[-1.0, start], [3.0, end]]);
        InitialStress::Components {
            xx: table(0, at),
            yy: table(1, [at[1], at[0]]),
            xy: table(0, [0.3, -0.2]),
            zz: Some(table(1, if section.is_plate() { [0.0; 2] } else { [at[0], 0.0] })),
        }
    };
    for kind in KINDS {
        for (map, section) in [
            (distorted as fn([f64; 2]) -> [f64; 2], Section::PlaneStrain),
            (|x| x, Section::PlaneStress { thickness: 0.3 }),
            (|[x, y]| distorted([x + 0.5, y]), Section::Axisymmetric),
        ] {
            for retardations in [[0.0; 3], [0.0, 0.02, 0.0]] {
                let laws = [linear(100.0, 0.3, 2.0), linear(300.0, 0.2, 1.0), linear(50.0, 0.4, 3.0)];
                let builder = bodies(strip(kind, section, map), laws, retardations);
                let builder = builder.initial_stress("left", stress([-3.0, -1.0], section));
                let model = of_step(builder.initial_stress("middle", stress([2.0, 5.0], section)));
                assert_eq!(Term::Solids.dependence(&model, &model.steps[0]), Dependence::Nothing);
                assert!(Assembler::new(&model).stored_matrices() > 0);
                check(&format!("{kind:?} in {section:?}, retardations {retardations:?}"), &model);
            }
        }
    }
}

/// Enough elements for several blocks, numbered without any order: 40 × 40 of which no two are alike.
#[test]
fn blocks_meet_at_their_nodes() {
    let shaken = |s: f64, t: f64| [s + 0.003 * (40.0 * t).sin(), t + 0.004 * (37.0 * s + 11.0 * t).sin()];
    let mut mesh = Blocks::default().block("block", [40, 40], shaken).0;
    let elements = mesh.elements.get_mut("block").expect("the block");
    elements.sort_by_key(|nodes| (arbitrary(nodes[0]) * 1e9) as i64);
    let law = linear(100.0, 0.3, 2.0);
    let step = LoadStep::new("step", 1.0).dt(0.1).scheme(Scheme::Newmark { beta: 0.25, gamma: 0.5 });
    let model = Model::builder(mesh.build().expect("a mesh")).body("block", law);
    let model = model.damping("block", Damping { mass: 0.0, retardation: 0.01 }).step(step).build();
    let model = Arc::new(model.expect("a good model"));
    assert_eq!(Assembler::new(&model).stored_matrices(), 1600);
    let [u, v] = [arbitrary_motion(&model, 0.01, 0), arbitrary_motion(&model, 0.3, 5)];
    let (state, expected) = (model.initial_state(), direct_forces(&model, &u, &v));
    let of = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| {
            let mut assembler = Assembler::new(&model);
            assembler.forces(Trial::new(&state, &model.steps[0], 0.1, 0.1), &u, Some(&v)).expect("forces");
            assembler.evaluation
        })
    };
    let found = of(1);
    agree("forces of many blocks", &found.force, &expected[0], &expected[1]);
    for threads in [2, 5] {
        let again = of(threads);
        assert_eq!((&again.force, &again.damping), (&found.force, &found.damping), "{threads} threads");
        assert_eq!(again.strain_energy, found.strain_energy, "{threads} threads");
    }
}

/// Forces and viscous forces, and their magnitudes, without the dense tangent.
fn direct_forces(model: &Model, u: &[f64], v: &[f64]) -> [Vec<f64>; 2] {
    let mut sums = [vec![0.0; model.dofs()], vec![0.0; model.dofs()]];
    for (e, element) in model.mesh.elements.iter().enumerate() {
        let body = &model.bodies[model.body_of_element[e]];
        let [u, v] = [u, v].map(|all| -> Vec<Vector2<f64>> {
            element.nodes.iter().map(|&node| Vector2::new(all[2 * node], all[2 * node + 1])).collect()
        });
        let [mut elastic, mut viscous] = [(); 2].map(|()| vec![Vector2::zeros(); u.len()]);
        model.solids[e].nodal_forces(&*body.material, &u, &mut elastic).expect("finite");
        model.solids[e].viscous_forces(&*body.material, body.damping.retardation, [&u, &v], &mut viscous);
        for (a, &node) in element.nodes.iter().enumerate() {
            for i in 0..2 {
                sums[0][2 * node + i] += elastic[a][i] + viscous[a][i];
                sums[1][2 * node + i] += elastic[a][i].abs() + viscous[a][i].abs();
            }
        }
    }
    sums
}

/// A displacement of the whole model by 2²⁷ = 1.3·10⁸ of its lengths, all numbers being such that the sum is exact, leaves
/// every bit of forces and energy as it is.
#[test]
fn a_far_translation_costs_no_digits() {
    for kind in KINDS {
        let law = || linear(100.0, 0.3, 2.0);
        let model = built(strip(kind, Section::PlaneStrain, |x| x), [law(), law(), law()], [0.01; 3]);
        let dyadic = |dof: usize| (arbitrary(dof) * 1024.0).round() / 65536.0;
        let moved = |far: f64| -> Vec<f64> { (0..model.dofs()).map(|dof| far + dyadic(dof)).collect() };
        let of = |far: f64| {
            let (state, mut assembler) = (model.initial_state(), Assembler::new(&model));
            let u = moved(far);
            let there = Trial::new(&state, &model.steps[0], 0.1, 0.1);
            assembler.forces(there, &u, Some(&u)).expect("forces");
            let found = &assembler.evaluation;
            (found.force.clone(), found.damping.clone(), found.strain_energy)
        };
        let (here, far) = (of(0.0), of(2f64.powi(27)));
        assert!(here.2 > 0.0);
        assert_eq!(here, far, "{kind:?}");
        // By themselves elements lose digits, but for T3, whose gradients here are powers of two.
        let alone = [0.0, 2f64.powi(27)].map(|far| direct_forces(&model, &moved(far), &moved(far)));
        assert_eq!(alone[0] == alone[1], kind == ElementKind::T3, "{kind:?}");
    }
}

/// Equal elements share one matrix: of a regular mesh there is one a body and triangle of a cell, in a section whose depth
/// varies along x one more a column, none where the law is not linear, and one an element where all differ.
#[test]
fn equal_elements_share_their_matrix() {
    for kind in KINDS {
        let triangles = if kind.corners() == 3 { 2 } else { 1 };
        let count = |section, map: fn([f64; 2]) -> [f64; 2]| {
            let laws = [linear(100.0, 0.3, 1.0), linear(300.0, 0.3, 1.0), neo_hookean(1.0, 0.3, 1.0)];
            Assembler::new(&built(strip(kind, section, map), laws, [0.0; 3])).stored_matrices()
        };
        assert_eq!(count(Section::PlaneStrain, |x| x), 2 * triangles, "{kind:?}");
        assert_eq!(count(Section::Graded { depth: 1.0, slope: [0.5, 0.0] }, |x| x), 4 * triangles, "{kind:?}");
        assert_eq!(count(Section::PlaneStress { thickness: 2.0 }, |x| x), 2 * triangles, "{kind:?}");
        assert_eq!(count(Section::Axisymmetric, |x| x), 4 * triangles, "{kind:?}");
        assert_eq!(count(Section::PlaneStrain, distorted), 12 * triangles, "{kind:?}");
    }
}

/// P = P₀ + C:(F − 1), linear; its viscous stress is that of another stiffness.
#[derive(Debug)]
struct Own {
    law: Linear,
    initial: f64,
}

impl BulkLaw for Own {
    fn description(&self) -> MaterialDescription<'_> {
        let own = self.law.description();
        MaterialDescription { viscous_modulus: Some(2.0 * own.p_wave_modulus), ..own }
    }

    fn respond(&self, straining: &Straining, new: &mut [f64]) -> Result<BulkResponse, MaterialFailure> {
        let mut response = self.law.respond(straining, new)?;
        let initial = Matrix2::new(self.initial, 0.0, 0.0, -self.initial);
        response.energy += initial.dot(&(straining.deformation - Matrix2::identity()));
        response.stress += Vector5::new(initial.m11, 0.0, 0.0, initial.m22, 0.0);
        Ok(response)
    }
}

/// Linear laws of one's own that do not answer by K_e (u_e − u_1) alone: one that stresses the undeformed body, and one whose
/// viscous stress is not its stiffness at the rate of strain.
#[test]
fn linear_laws_with_more_than_a_stiffness_answer_as_each_by_itself() {
    let law = |initial: f64| -> Box<dyn Material> {
        Own { law: Linear::new(&elastic(100.0, 0.3, 2.0)).expect("good constants"), initial }.into()
    };
    for kind in KINDS {
        for (initial, retardations) in [(3.0, [0.0; 3]), (0.0, [0.02; 3]), (3.0, [0.02, 0.0, 0.01])] {
            let what = format!("{kind:?}, initial stress {initial}, retardations {retardations:?}");
            let laws = [law(initial), linear(100.0, 0.3, 2.0), law(0.0)];
            check(&what, &built(strip(kind, Section::PlaneStrain, distorted), laws, retardations));
        }
    }
}

/// A body that remembers and is viscous besides: the same displacement gives the same residual, as often as it is asked for.
#[test]
fn viscous_forces_do_not_stay_for_the_next_evaluation() {
    let constants = ViscoelasticConstants { young: 100.0, poisson: 0.3, relaxing: 50.0, tau: 0.7, density: 1.0 };
    let remembering = || Viscoelastic::new(&constants).expect("good constants").into();
    let laws = [remembering(), linear(100.0, 0.3, 1.0), remembering()];
    let model = built(strip(ElementKind::Q4, Section::PlaneStrain, distorted), laws, [0.02; 3]);
    let (state, mut assembler) = (model.initial_state(), Assembler::new(&model));
    let trial = Trial::new(&state, &model.steps[0], 0.1, 0.1);
    let u = arbitrary_motion(&model, 0.01, 0);
    let mut residual = || {
        let mut system = assembler.system();
        assembler.residual(trial, &u, &mut system).expect("a residual");
        system.residual
    };
    let [first, second] = [residual(), residual()];
    assert_eq!(first, second);
}

/// Where a displacement is not a number, the failure names the element, as other laws do.
#[test]
fn strains_that_are_no_numbers_name_their_element() {
    let law = || linear(100.0, 0.3, 2.0);
    let model = built(strip(ElementKind::Q4, Section::PlaneStrain, distorted), [law(), law(), law()], [0.0; 3]);
    let (state, mut assembler) = (model.initial_state(), Assembler::new(&model));
    let node = model.mesh.elements[5].nodes[2];
    let mut u = vec![0.0; model.dofs()];
    u[2 * node] = f64::NAN;
    let first = model.mesh.elements.iter().position(|element| element.nodes.contains(&node)).expect("an element");
    let failure = assembler.forces(Trial::new(&state, &model.steps[0], 0.1, 0.1), &u, None).expect_err("no number");
    let element = model.mesh.element_tags[first];
    let fecontact::equations::sums::TrialFailure::Inverted { element: message, .. } = failure else {
        panic!("{failure:?}")
    };
    assert_eq!(message, element);
}
