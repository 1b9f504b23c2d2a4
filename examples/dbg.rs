#![allow(missing_docs)]
use fecontact::*;
use std::path::Path;
fn main() {
    let path = Path::new("cases/block_on_ground.json");
    let mut case = case::read(path).unwrap();
    let max: f64 = std::env::args().nth(1).unwrap().parse().unwrap();
    case.steps[1].dt.as_mut().unwrap().max = Some(max);
    let model = case::build(&case, path).unwrap();
    let mut work = step::Workspace::new(&model, Box::<linear::SparseLu>::default());
    let mut state = model.initial_state();
    for st in &model.steps {
        state = step::begin(&model, st, &state, &mut work).unwrap();
        let mut dt = st.increments.initial;
        while state.time < st.span.end {
            let (it, r) = step::advance(&model, st, &state, dt, &mut work);
            match r {
                Ok(s) => { state = s; if it.len() <= 4 { dt = (dt * 1.5).min(st.increments.max) } }
                Err(e) => { println!("t {} dt {dt}: {e}", state.time); if state.time > 4.0 { analyse(st, &state, dt, &mut work); return; } else {dt *= 0.5} }
            }
        }
    }
}
fn analyse(st: &model::Step, s1: &state::State, dt: f64, work: &mut step::Workspace) {
    let mut prev: Option<Vec<contact::force::ContactState>> = None;
    let trial = assembly::Trial { old: s1, step: st, time: s1.time + dt, dt };
    let mut system = work.assembler.system();
    let l = s1.last_increment.as_ref().unwrap();
    let mut u: Vec<f64> = s1.displacement.iter().zip(&l.displacement).map(|(a, b)| a + b * dt / l.dt).collect();
    let mut solver = linear::SparseLu::default();
    work.assembler.start_increment();
    for it in 0..20 {
        if work.assembler.evaluate(trial, &u, newton::Request::Residual, &mut system).is_err() { return }
        let now = work.assembler.evaluation.contacts[0].clone();
        println!("it {it} res {:.3e}", linear::norm(&system.residual));
        if it < 4 || it > 15 {
            if let Some(prev) = &prev {
                for k in 0..now.len() {
                    let (a, b, o) = (&prev[k].friction, &now[k].friction, &s1.contacts[0][k].friction);
                    if (a.traction - b.traction).abs() > 1e-1 * (b.traction.abs() + 0.01 * b.pressure) || (a.pressure - b.pressure).abs() > 1e-1 * b.pressure {
                        println!("  {k}: old q {:.2e} p {:.2e} R {:.3}; q {:.2e} -> {:.2e} p {:.2e} -> {:.2e} R {:.4} -> {:.4} dl {:.2e} -> {:.2e} foot {:?}->{:?}->{:?}", o.traction, o.pressure, o.ratio(), a.traction, b.traction, a.pressure, b.pressure, a.ratio(), b.ratio(), a.plastic_increment, b.plastic_increment, s1.contacts[0][k].foot.map(|f| (f.segment, f.xi)), prev[k].foot.map(|f| (f.segment, f.xi)), now[k].foot.map(|f| (f.segment, f.xi)));
                    }
                }
            }
        }
        prev = Some(now);
        work.assembler.evaluate(trial, &u, newton::Request::Tangent, &mut system).unwrap();
        let right: Vec<f64> = system.residual.iter().map(|r| -r).collect();
        let sol = linear::solve(&mut solver, &system.tangent, &right).unwrap();
        for (u, d) in u.iter_mut().zip(&sol.x) { *u += d; }
    }
}
