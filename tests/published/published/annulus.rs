//! An annulus of slip that grows, and heals in a hold.

use super::*;

/// Partial slip with the super/subloading law (`mindlin_healing.json`: μ_s = 0.3, μ_k = 0.2, ξ = 0.03, n = 1). The annulus of
/// slip (R ≥ 0.9) grows inwards with every increment, from both ends of the contact; what sticks is narrower than Cattaneo and
/// Mindlin's c for μ_s, because the annulus weakens, and wider than theirs for μ_k, which it does not reach. In the hold that
/// follows nothing slips, and μ heals at every point by the law's own closed form from where the shift left it,
///
/// ```text
/// μ(t) = μ_s − (μ_s − μ(t₀)) exp(−ξ (t − t₀)/μ_s)
/// ```
///
/// Measured: c falls from 0.721 to 0.435 mm (at the end 0.453 for μ_s and 0.177 for μ_k), μ at the edge to 0.251 and back to
/// 0.282.
#[test]
fn a_slip_annulus_weakens_as_it_grows_and_heals_in_a_hold() {
    let (run, _) = solve("mindlin_healing", as_it_is);
    let (mu_s, mu_k, xi) = (0.3, 0.2, 0.03);
    let closed = |state: &State| -> Vec<(f64, FrictionState)> {
        let x = run.model.configuration(&state.displacement);
        let points = run.model.contacts[0].points.iter().zip(&state.contacts[0]);
        let mut found: Vec<_> = points
            .filter(|(_, contact)| contact.regime() != Regime::Open)
            .map(|(point, contact)| (point.at(&x).x, contact.friction.clone()))
            .collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found
    };
    let pressed = closed(run.at(1.1));
    let element = (pressed[pressed.len() - 1].0 - pressed[0].0) / (pressed.len() - 1) as f64;
    let force = |state: &State| run.reaction("cylinder_top", state).map(f64::abs);
    let modulus = 210_000.0 / (2.0 * (1.0 - 0.3 * 0.3));
    let a = (4.0 * force(run.at(1.1))[1] * 50.0 / (std::f64::consts::PI * modulus)).sqrt();
    let mut before = pressed.len();
    let shifted: Vec<&State> =
        run.states.iter().filter(|state| state.time > 1.1 + 1e-9 && state.time < 2.1 + 1e-9).collect();
    for state in &shifted {
        let found = closed(state);
        let stuck: Vec<usize> = (0..found.len()).filter(|&k| found[k].1.ratio(mu_of(&found[k].1)) < 0.9).collect();
        let (first, last) = (stuck[0], stuck[stuck.len() - 1]);
        assert_eq!(stuck.len(), last - first + 1, "slip within what sticks at t = {}", state.time);
        assert!(stuck.len() <= before, "what sticks grows at t = {}", state.time);
        before = stuck.len();
        let half = 0.5 * (found[last].0 - found[first].0 + element);
        let [least, most] = [mu_k, mu_s].map(|mu| stick_half_width(a, mu, force(state)));
        println!("t = {:.1}: c = {half:.4}, between {least:.4} and {most:.4}", state.time);
        assert!(least < half && half < most + element, "c = {half}, not between {least} and {most}");
    }
    let (start, end) = (closed(shifted[shifted.len() - 1]), closed(run.last()));
    assert!(before < pressed.len() * 6 / 10, "{before} of {} points stick", pressed.len());
    let weakest = |points: &[(f64, FrictionState)]| points.iter().fold(1.0f64, |least, (_, f)| least.min(mu_of(f)));
    println!("μ at the edge {:.4}, after the hold {:.4}", weakest(&start), weakest(&end));
    assert!(weakest(&start) < mu_s - 0.4 * (mu_s - mu_k));
    assert_eq!(start.len(), end.len());
    let healing = (-xi * 10.0 / mu_s).exp();
    for ((_, start), (at, end)) in start.iter().zip(&end) {
        let expected = mu_s - (mu_s - mu_of(start)) * healing;
        assert!((mu_of(end) - expected).abs() < 1e-9, "μ({at}) = {}, not {expected}", mu_of(end));
        assert_eq!(end.plastic_slip, start.plastic_slip);
        assert!(
            (end.traction - start.traction).abs() < 1e-6 * 857.0,
            "traction {} to {}",
            start.traction,
            end.traction
        );
    }
    assert!(run.iterations.iter().all(|&n| n <= MOST_ITERATIONS), "{:?}", run.iterations);
}
