//! Whether tractions are determined by the bodies: the weakest mode of every discretization of contact.

use std::sync::Arc;

use fecontact::contact::force::ContactState;
use fecontact::contact::pair::{ContactIncrement, ContactPair, Prediction};
use fecontact::contact::response::PairResponse;
use fecontact::equations::term::Term;
use fecontact::equations::{Assembler, Trial};
use fecontact::linear::SparseMatrix;
use fecontact::linear::system::Request;
use fecontact::model::Model;
use nalgebra::{DMatrix, DVector};
use serde_json::{Value, json};

use crate::common::{self, close, with};

const POISSON: f64 = 0.33;

/// The weakest modes of normal and tangential tractions.
#[derive(Clone, Copy, Debug)]
struct Weakest {
    /// Of the bodies alone, in h/M
    bodies: [f64; 2],
    /// With what the penalties give, in h/M
    whole: [f64; 2],
}

/// Number of elements below each other.
const ROWS: usize = 4;

/// Two bodies of so many elements along their interface of length 1, so many times as deep as long, the lower one the master, each clamped at
/// the far side.
fn squares(kind: &str, [slave, master]: [usize; 2], depth: f64, contact: &Value) -> Model {
    let square = |body: &str, side: f64, n: usize| {
        let far = side * depth * ROWS as f64 / n as f64;
        let [low, high] = [far.min(0.0), far.max(0.0)];
        json!({"body": body, "kind": kind, "corners": [[0, low], [1, low], [1, high], [0, high]], "elements": [n, ROWS],
               "sides": [format!("{body}_bottom"), null, format!("{body}_top"), null]})
    };
    let body = json!({"material": {"model": "linear", "E": 1, "nu": POISSON}});
    let base = with(
        json!({"slave": "upper_bottom", "master": "lower_top", "friction": {"law": "coulomb", "mu": 0.3}}),
        contact,
    );
    let mut blocks = vec![square("upper", 1.0, slave)];
    let mut bodies = json!({"upper": body});
    let mut supports = json!([{"on": "upper_top", "ux": 0, "uy": 0}]);
    if base["master"] == "lower_top" {
        blocks.push(square("lower", -1.0, master));
        bodies["lower"] = body;
        supports.as_array_mut().expect("a list").push(json!({"on": "lower_bottom", "ux": 0, "uy": 0}));
    }
    common::model(&json!({
        "mesh": {"blocks": blocks}, "bodies": bodies, "contacts": {"base": base},
        "steps": [{"name": "press", "duration": 1, "supports": supports}]
    }))
}

/// A matrix of columns A e_k for the free dofs.
fn dense(matrix: &SparseMatrix, free: &[usize]) -> DMatrix<f64> {
    let mut unit = vec![0.0; matrix.size()];
    let columns: Vec<DVector<f64>> = free
        .iter()
        .map(|&dof| {
            unit[dof] = 1.0;
            let column = matrix.multiply(&unit);
            unit[dof] = 0.0;
            DVector::from_iterator(free.len(), free.iter().map(|&row| column[row]))
        })
        .collect();
    DMatrix::from_columns(&columns)
}

/// √A_j times δg_j or δΔu_j for every free dof and closed point, as the program has them.
fn rows(pair: &ContactPair, response: &PairResponse, free: &[usize], dofs: usize, normal: bool) -> DMatrix<f64> {
    let mut of_dof = vec![None; dofs];
    free.iter().enumerate().for_each(|(k, &dof)| of_dof[dof] = Some(k));
    let mut rows = DMatrix::zeros(free.len(), pair.points.len());
    for (point, (state, closed)) in response.numbered() {
        let (rates, stiffness) = match normal {
            true => (closed.dpressure, -pair.alpha_n),
            false => (closed.dtraction, pair.law(&pair.points[point]).description.stiffness),
        };
        let own = closed.nodes.iter().flat_map(|&node| [2 * node, 2 * node + 1]);
        for (dof, rate) in own.zip(rates) {
            if let Some(row) = of_dof[dof] {
                rows[(row, point)] += state.length.sqrt() * rate / stiffness;
            }
        }
    }
    rows
}

/// The smallest eigenvalues of A^-½ B K⁻¹ Bᵀ A^-½, with B_j = A_j δg_j or A_j δΔu_j as the program itself has them and K the stiffness of the
/// bodies: how far the tractions that deform the bodies least deform them.
fn weakest(model: Model) -> Weakest {
    let model = Arc::new(model);
    let state = model.initial_state();
    let (step, pair) = (&model.steps[0], &model.contacts[0]);
    let mut u = vec![0.0; model.dofs()];
    // All points are closed, and none slips.
    let slave = model.mesh.group("upper").expect("the slave's body");
    model.mesh.nodes_of(slave).into_iter().for_each(|node| u[2 * node + 1] = -1e-9);
    let [before, x] = [&state.displacement, &u].map(|u| model.configuration(u));
    let during = ContactIncrement {
        dt: 1.0,
        time: 1.0,
        radiates: false,
        fading: 0.0,
        stiffening: 1.0,
        settles: true,
        seeps: 0.0,
    };
    let (mut response, nothing) = (PairResponse::default(), |_| Prediction::default());
    pair.respond(&state.contacts[0], [&before, &x], during, nothing, Request::Tangent, &mut response)
        .expect("an answer");
    assert!(response.states.iter().all(ContactState::is_closed));
    let held: Vec<usize> = step.supports.iter().map(|support| support.at.dof).collect();
    let free: Vec<usize> = (0..model.dofs()).filter(|dof| !held.contains(dof)).collect();
    let (trial, rest) = (Trial::new(&state, step, 1.0, 1.0), vec![0.0; model.dofs()]);
    let stiffness = Assembler::new(&model).tangent_of(Term::Solids, trial, &rest).expect("a tangent");
    let stiffness = dense(&stiffness, &free).cholesky().expect("a positive definite matrix");
    let least = |normal: bool| {
        let rows = rows(pair, &response, &free, model.dofs(), normal);
        let compliance = rows.transpose() * stiffness.solve(&rows);
        compliance.symmetric_eigenvalues().min() / pair.compliance
    };
    let bodies = [true, false].map(least);
    let alpha_t = pair.law(&pair.points[0]).description.stiffness;
    let penalties = [pair.alpha_n, alpha_t].map(|alpha| 1.0 / (alpha * pair.compliance));
    Weakest { bodies, whole: [bodies[0] + penalties[0], bodies[1] + penalties[1]] }
}

/// Another code, with operators of its own on the segments of both sides, finds these for 20 slave edges on 24 (Q8) and 40 on 48 (Q4), with
/// elements twice as deep as they are long, in ℓ/M with the length ℓ of the edges: 0.486 and 0.219 with a constant an edge and a hat at the ends of
/// the surface, 0.236 and 0.0835 with hats at nodes. (Hats at corner and middle of quadratic edges have 0.065 and 0.019.)
#[test]
fn weakest_modes_are_those_of_another_code() {
    for (kind, n, expected) in [("Q8", [10, 12], [0.4858, 0.2193]), ("Q4", [20, 24], [0.2363, 0.0835])] {
        let deep = 2.0;
        let found = weakest(squares(kind, n, deep, &json!({}))).bodies.map(|bodies| deep * bodies);
        println!("{kind}: {found:.4?}");
        for (found, expected) in found.iter().zip(expected) {
            close(kind, *found, expected, 0.01 * expected);
        }
    }
}

/// By default nothing is weaker than h/(10 M), h being the depth of the slave's elements, as long as deep here, and M = λ + 2G: an error of a gap
/// of 1e-3 h makes one of the pressure of 1e-2 M at most. The bodies alone are as stiff but in two cases. In shear linear edges that are
/// shorter than their master's have 0.087 h/M (0.16 where they are longer), and the default α_t = 15 M/h gives the rest. Gauss points, on rigid
/// masters with corners or ends, are not determined by the bodies at all, 0, but by penalties of 10 and 5 M/h. (Modes decay within
/// edges: of elements four times as deep as long the depth overstates them, and hats have 0.01, with the penalty 0.08 h/M in shear.)
#[test]
fn nothing_is_weaker_than_a_tenth() {
    let line = json!({"master": {"polyline": {"points": [[-1, 0], [2, 0]]}}});
    let at_nodes = json!({"method": "node_to_segment"});
    let open = json!({});
    for (kind, n, contact, least) in [
        ("Q4", [10, 12], &open, [0.15, 0.15]),
        ("Q4", [17, 10], &open, [0.15, 0.085]),
        ("Q4", [10, 10], &open, [0.15, 0.15]),
        ("Q8", [8, 10], &open, [0.4, 0.19]),
        ("Q8", [11, 7], &open, [0.4, 0.19]),
        ("Q8", [8, 8], &open, [0.4, 0.19]),
        ("T6", [8, 10], &open, [0.4, 0.19]),
        ("T6", [11, 7], &open, [0.4, 0.19]),
        ("T6", [8, 8], &open, [0.4, 0.19]),
        ("Q4", [10, 10], &at_nodes, [2.0, 1.0]),
        ("Q8", [8, 8], &at_nodes, [0.7, 0.25]),
        ("T6", [8, 8], &at_nodes, [0.7, 0.25]),
        ("Q4", [10, 0], &line, [0.0; 2]),
        ("Q8", [8, 0], &line, [0.0; 2]),
        ("T6", [8, 0], &line, [0.0; 2]),
    ] {
        let Weakest { bodies, whole } = weakest(squares(kind, n, 1.0, contact));
        println!("{kind} {n:?} {contact}: bodies {bodies:.4?}, with penalties {whole:.4?}");
        let round_off = 1e-9;
        assert!(
            bodies.iter().zip(least).all(|(bodies, least)| *bodies > least - round_off),
            "{kind} {n:?}: {bodies:?}"
        );
        assert!(whole.iter().all(|whole| *whole > 0.1 - round_off), "{kind} {n:?}: {whole:?}");
        if contact == &line {
            close("at Gauss points", bodies[0].abs().max(bodies[1].abs()), 0.0, round_off);
        }
    }
}
