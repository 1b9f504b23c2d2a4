//! What an interface costs against its number of points: a linear block pressed and sheared over an equal one, implicit dynamics,
//! condensed on the nodes at the contact and on all equations, in finite sliding (two points an edge) and in small sliding (a
//! point a node). Milliseconds of processor time a linear solve, one thread.
//!
//! ```text
//! cargo run --release -p fecontact-benches --bin interface [-- 100 300]
//! ```
//!
//! The blocks have 15 rows of elements, half as many columns as points in finite sliding, about as many points as columns in
//! small sliding; above a few thousand points a dense matrix of
//! the nodes at the contact costs more than an elimination of all, and both columns are the same.

use std::error::Error;
use std::time::Instant;

use fecontact::laws::bulk::{ElasticConstants, Linear};
use fecontact::laws::friction::SuperSubloadingParameters;
use fecontact::mesh::InlineMesh;
use fecontact::model::boundary::Drive;
use fecontact::model::builder::{Contact, LoadStep, Support};
use fecontact::model::{Method, Model, Scheme};
use fecontact::run::Simulation;

/// Columns of elements in the rows of the table.
const COLUMNS: [usize; 6] = [100, 300, 1000, 2000, 4000, 10000];

/// Rows of elements in each block.
const ROWS: usize = 15;

/// Increments that are timed, after one that is not.
const INCREMENTS: usize = 40;

fn main() -> Result<(), Box<dyn Error>> {
    rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global()?;
    let wanted: Vec<usize> = std::env::args().skip(1).map(|argument| argument.parse()).collect::<Result<_, _>>()?;
    println!(
        "| columns | dofs | finite sliding, condensed | all equations | ratio | small sliding, condensed | all equations | ratio |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for columns in if wanted.is_empty() { COLUMNS.to_vec() } else { wanted } {
        let mut row = format!("| {columns} | {} |", model(columns, false)?.dofs());
        for small in [false, true] {
            let mut cost = [0.0; 2];
            for (cost, condense) in cost.iter_mut().zip([true, false]) {
                let mut model = model(columns, small)?;
                model.aids.condense = condense;
                *cost = milliseconds_a_solve(model)?;
            }
            row += &format!(" {:.2} | {:.2} | {:.2} |", cost[0], cost[1], cost[0] / cost[1]);
        }
        println!("{row}");
    }
    Ok(())
}

fn milliseconds_a_solve(model: Model) -> Result<f64, Box<dyn Error>> {
    let mut run = Simulation::new(model);
    run.next_increment()?;
    let (before, clock) = (run.report().newton_iterations, Instant::now());
    for _ in 0..INCREMENTS {
        run.next_increment()?;
    }
    Ok(1e3 * clock.elapsed().as_secs_f64() / (run.report().newton_iterations - before) as f64)
}

fn model(columns: usize, small: bool) -> Result<Model, Box<dyn Error>> {
    let (length, height) = (columns as f64, ROWS as f64);
    let mesh = InlineMesh::default()
        .rectangle("base", [columns, ROWS], [0.0, -height], [length, 0.0])
        .rectangle("block", [columns, ROWS], [0.0, 0.0], [length, height])
        .build()?;
    let glass = Linear::new(&ElasticConstants { young: 5600.0, poisson: 0.3, density: 1.17e-9 })?;
    let friction = SuperSubloadingParameters {
        alpha_t: Some(3000.0),
        kappa: 18.0,
        xi: 15.0,
        ..SuperSubloadingParameters::new(0.5, 0.1, 3600.0)
    };
    let contact =
        Contact::new("interface", "block_bottom", "base_top", friction).alpha_n(3000.0).initial(5.0, 0.5).balanced();
    let contact = if small { contact.method(Method::NodeToSegment).small_sliding() } else { contact };
    let step = LoadStep::new("push", 1.0)
        .scheme(Scheme::GeneralizedAlpha { rho_infinity: 0.8 })
        .dt(1e-4)
        .fix("base_bottom")
        .support(Support::on("block_top").ux(Drive::Rate(0.05)).uy(0.0));
    Ok(Model::builder(mesh).body("block", glass).body("base", glass).contact(contact).step(step).build()?)
}
