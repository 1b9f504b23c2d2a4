//! Parameters of friction that vary along a contact at random.

use std::path::Path;

use crate::common::{Blocks, close, finish, model};
use fecontact::case::{self, Written};
use fecontact::contact::surface::SlavePoint;
use fecontact::model::Model;
use fecontact::model::boundary::{Marginal, RandomField, Spectrum};
use nalgebra::Vector2;
use serde_json::{Value, json};

/// Fields of the samples.
const FIELDS: u64 = 1000;

/// So many standard errors a statistic of a sample may be off: one in 16 000 is by chance.
const ERRORS: f64 = 4.0;

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    values.sum::<f64>() / count
}

/// Mean, deviation, and correlation with the first, of values at several places in many fields.
fn statistics(fields: &[Vec<f64>]) -> Vec<[f64; 3]> {
    let at = |k: usize| fields.iter().map(move |values| values[k]);
    let moment = |k: usize, l: usize| {
        let means = [mean(at(k)), mean(at(l))];
        mean(fields.iter().map(|values| (values[k] - means[0]) * (values[l] - means[1])))
    };
    let of = |k: usize| [mean(at(k)), moment(k, k).sqrt(), moment(0, k) / (moment(0, 0) * moment(k, k)).sqrt()];
    (0..fields[0].len()).map(of).collect()
}

/// Mean, deviation and correlation of normal fields are those asked for: exp(−d²/a²); exp(−d/a) of von Kármán with H = ½, and
/// (d/a) K₁(d/a) with H = 1, K₁(1) = 0.6019072302 and K₁(2) = 0.1398658818 (Abramowitz & Stegun, table 9.8).
#[test]
fn fields_have_the_statistics_asked_for() {
    let (m, s, a) = (0.4, 0.05, 3.0);
    let distances = [0.0, 0.5, 1.0, 2.0];
    let bessel = [1.0, f64::NAN, 0.601_907_230_2, 2.0 * 0.139_865_881_8];
    for (spectrum, expected) in [
        (Spectrum::Gaussian, distances.map(|d: f64| (-d * d).exp())),
        (Spectrum::VonKarman { hurst: 0.5 }, distances.map(|d: f64| (-d).exp())),
        (Spectrum::VonKarman { hurst: 1.0 }, bessel),
    ] {
        // Along a line that is inclined, and far from the origin.
        let values = |seed: u64| -> Vec<f64> {
            let field = RandomField::new(seed, m, s, a).spectrum(spectrum);
            distances.map(|d| field.value(Vector2::new(300.0 + 0.6 * a * d, -40.0 + 0.8 * a * d))).to_vec()
        };
        let fields: Vec<Vec<f64>> = (0..FIELDS).map(values).collect();
        let root = (FIELDS as f64).sqrt();
        for ([mean, deviation, correlation], expected) in statistics(&fields).into_iter().zip(expected) {
            close("mean", mean, m, ERRORS * s / root);
            close("deviation", deviation, s, ERRORS * s / (2.0_f64.sqrt() * root));
            if expected.is_finite() {
                close("correlation", correlation, expected, ERRORS * (1.0 - expected * expected) / root + 1e-12);
            }
        }
    }
}

/// Half of the fields are below their median, 2.275 % below two deviations under it, and as many above two.
#[test]
fn fields_are_normal() {
    let share = |below: f64, marginal| {
        let value = |seed| RandomField::new(seed, 1.0, 0.5, 2.0).marginal(marginal).value(Vector2::new(0.3, 0.7));
        (0..FIELDS).filter(|&seed| value(seed) < below).count() as f64 / FIELDS as f64
    };
    let variance: f64 = (1.0 + 0.25_f64).ln();
    for (deviations, expected) in [(-2.0, 0.022_750), (0.0, 0.5), (1.0, 0.841_345), (2.0, 0.977_250)] {
        let allowed = ERRORS * f64::sqrt(expected * (1.0 - expected) / FIELDS as f64);
        close("normal", share(1.0 + 0.5 * deviations, Marginal::Normal), expected, allowed);
        let below = (variance.sqrt() * deviations - 0.5 * variance).exp();
        close("lognormal", share(below, Marginal::Lognormal), expected, allowed);
    }
}

/// Mean m and deviation s of a lognormal field, whose logarithm has the variance ln(1 + s²/m²); its own values are exp of the normal
/// field of the same seed.
#[test]
fn lognormal_fields_have_the_moments_asked_for() {
    let (m, s) = (2.0, 1.0);
    let at = Vector2::new(1.5, 0.0);
    let field = |seed| RandomField::new(seed, m, s, 1.0).marginal(Marginal::Lognormal).value(at);
    let fields: Vec<Vec<f64>> = (0..FIELDS).map(|seed| vec![field(seed), field(seed).ln()]).collect();
    let (statistics, root) = (statistics(&fields), (FIELDS as f64).sqrt());
    close("mean", statistics[0][0], m, ERRORS * s / root);
    // The fourth moment of a lognormal variable with w = 1 + s²/m² is s⁴ (w⁴ + 2 w³ + 3 w² − 3).
    let w: f64 = 1.0 + s * s / (m * m);
    let of_variance = (w.powi(4) + 2.0 * w.powi(3) + 3.0 * w * w - 4.0).sqrt() * s * s / root;
    close("variance", statistics[0][1].powi(2), s * s, ERRORS * of_variance);
    let variance = w.ln();
    close("mean of the logarithm", statistics[1][0], m.ln() - 0.5 * variance, ERRORS * variance.sqrt() / root);
    close("its variance", statistics[1][1].powi(2), variance, ERRORS * variance * 2.0_f64.sqrt() / root);
    let normal = RandomField::new(7, 0.0, 1.0, 1.0).value(at);
    close("of the same seed", field(7), m * (variance.sqrt() * normal - 0.5 * variance).exp(), 1e-14);
}

/// Values from another program, in Python, of the equations of the field and of its generator of random bits.
#[test]
fn fields_are_those_of_their_equations() {
    let field = RandomField::new(7, 0.4, 0.05, 3.0);
    let at = Vector2::new(1.25, -2.0);
    close("normal", field.value(at), 0.349_610_349_049_777_2, 1e-14);
    close("lognormal", field.clone().marginal(Marginal::Lognormal).value(at), 0.350_102_612_960_299_15, 1e-14);
    close("rough", field.spectrum(Spectrum::VonKarman { hurst: 0.7 }).value(at), 0.327_055_798_993_997_5, 1e-13);
}

/// The coefficient of friction at the points of a block with so many elements along its bottom, with their x.
fn along(elements: usize, friction: &Value, along: &Value) -> (Model, Vec<[f64; 2]>) {
    let model = model(&block(elements, friction, along));
    let pair = &model.contacts[0];
    let x = model.mesh.undeformed();
    let mu = |point: &SlavePoint| {
        let law = pair.law(point);
        [point.at(&x).x, law.observe("mu", &law.law.initial_state(1.0, 0.0))]
    };
    let mu = pair.points.iter().map(mu).collect();
    (model, mu)
}

fn block(elements: usize, friction: &Value, along: &Value) -> Value {
    json!({
        "mesh": Blocks::default().rectangle("slab", [elements, 2], [0.0, 0.0], [8.0, 1.0]).json(),
        "bodies": {"slab": {"material": {"model": "linear", "E": 260, "nu": 0.3, "density": 1}}},
        "contacts": {"base": {
            "slave": "slab_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}}, "method": "node_to_segment",
            "normal": {"alpha_n": 1e4}, "friction": friction, "along": along, "initial": {"pressure": 1},
        }},
        "steps": [{"name": "drag", "duration": 1, "scheme": "static", "dt": {"initial": 0.25},
            "supports": [{"on": "slab_top", "ux": 0.02, "uy": 0}]}],
    })
}

fn coulomb() -> Value {
    json!({"law": "coulomb", "mu": 0.5})
}

/// Two meshes of one interface have the same field: the same bits where they have a point in common, and elsewhere what is between
/// the points of the coarse one to the error of linear interpolation, h²/8 |f″|: f″ has the deviation s √C⁗(0) = √12 s/a².
#[test]
fn a_field_does_not_depend_on_the_mesh() {
    let (s, a, coarse, refined) = (0.05, 3.0, 16, 5);
    let random = json!({"mu": {"random": {"seed": 3, "mean": 0.4, "deviation": s, "correlation": a}}});
    let [(_, few), (_, many)] = [coarse, coarse * refined].map(|elements| along(elements, &coulomb(), &random));
    let allowed = ERRORS * 12.0_f64.sqrt() * s / (a * a) * (8.0 / coarse as f64).powi(2) / 8.0;
    assert!(allowed < 0.1 * s);
    for (k, &[x, mu]) in many.iter().enumerate() {
        let (first, share) = (k / refined, (k % refined) as f64 / refined as f64);
        if k % refined == 0 {
            close("place", x, few[first][0], 1e-12);
            // Places differ by round-off.
            close("at a common point", mu, few[first][1], 1e-15);
        } else {
            close("between", mu, few[first][1] * (1.0 - share) + few[first + 1][1] * share, allowed);
        }
    }
}

/// What would leave the range of the law is truncated to it, and told with its share: Coulomb's μ to a hundredth of its mean, because it
/// has to be positive, in Φ(−1) = 15.87 % of the points; μ_s to μ_k in Φ(−2) = 2.28 %, also where both are random.
#[test]
fn fields_are_truncated_to_the_range_of_the_law() {
    let random = |seed: u64, mean: f64, deviation: f64| json!({"random": {"seed": seed, "mean": mean, "deviation": deviation, "correlation": 1e-3}});
    let share = |model: &Model, name: &str| {
        let (pair, said) = (&model.contacts[0], model.warnings());
        let outside = pair.truncated[name];
        let text =
            format!("`{name}` is random, and outside the range of the friction law at {outside} of 801 contact points");
        assert!(said.iter().any(|warning| warning.contains("contact `base`") && warning.contains(&text)), "{said:?}");
        outside as f64 / pair.points.len() as f64
    };
    let allowed = |share: f64| ERRORS * (share * (1.0 - share) / 801.0).sqrt();
    let (model, mu) = along(800, &coulomb(), &json!({"mu": random(5, 0.2, 0.2)}));
    close("share", share(&model, "along.mu"), 0.158_66, allowed(0.158_66));
    assert!(mu.iter().all(|[_, mu]| *mu > 0.0));
    assert_eq!(mu.iter().filter(|[_, mu]| *mu == 2e-3).count(), model.contacts[0].truncated["along.mu"]);

    let law = json!({"law": "super_subloading", "mu_s": 0.5, "mu_k": 0.2, "r": 100, "kappa": 10, "xi": 0.002, "m": 1, "n": 1});
    let (model, _) = along(800, &law, &json!({"mu_s": random(6, 0.3, 0.05)}));
    close("share", share(&model, "along.mu_s"), 0.022_75, allowed(0.022_75));
    let (model, mu) = along(800, &law, &json!({"mu_s": random(6, 0.3, 0.05), "mu_k": random(9, 0.2, 0.05)}));
    // μ_s − μ_k has the mean 0.1 and the deviation √2 × 0.05: Φ(−√2) = 7.86 %. One of the two, or both, move.
    let both = share(&model, "along.mu_s") + share(&model, "along.mu_k");
    assert!(both > 0.078_65 - allowed(0.078_65) && both < 2.0 * (0.078_65 + allowed(0.078_65)), "{both}");
    assert!(mu.iter().all(|[_, mu]| *mu > 0.0));

    // Within the range nothing is said.
    let (model, _) = along(800, &coulomb(), &json!({"mu": random(5, 0.4, 0.01)}));
    assert!(
        model.contacts[0].truncated.is_empty() && model.warnings().iter().all(|warning| !warning.contains("random"))
    );
}

/// Where another parameter varies in time, a truncated value stays.
#[test]
fn truncated_values_stay_in_time() {
    let law = json!({"law": "slip_weakening", "mu_s": 0.5, "mu_d": 0.2, "D_c": 1, "alpha_t": 5e3});
    let random = json!({"seed": 6, "mean": 0.3, "deviation": 0.1, "correlation": 0.1});
    let along = json!({"mu_s": {"random": random}, "D_c": "1 + t"});
    let run = finish(&block(16, &law, &along));
    assert!(run.model.contacts[0].truncated["along.mu_s"] > 0);
}

/// The resolved case has the same field, to the bit.
#[test]
fn a_resolved_case_has_the_same_field() {
    let random = json!({"mu": {"random": {"seed": 11, "mean": 0.4, "deviation": 0.1, "correlation": 0.7,
        "marginal": "lognormal", "spectrum": {"von_karman": {"hurst": 0.3}}}}});
    let text = block(40, &coulomb(), &random).to_string();
    let built = |text: &str| {
        let written = Written::from_text(text, Path::new("test.json")).expect("a case");
        let model = case::build(&written.case, Path::new("test.json")).expect("a model");
        let resolved = case::resolved(&written.case, &model);
        let mu =
            |law: &std::sync::Arc<fecontact::laws::friction::ContactLaw>| law.description.starting_limit(1.0).to_bits();
        (model.contacts[0].laws.iter().map(mu).collect::<Vec<_>>(), resolved)
    };
    let (given, resolved) = built(&text);
    assert!(given.len() > 40 && given == built(&resolved).0);
}

/// What is wrong is told with its place.
#[test]
fn bad_fields_are_refused() {
    let good = json!({"seed": 1, "mean": 0.4, "deviation": 0.1, "correlation": 1});
    let said = |key: &str, value: Value| {
        let mut random = good.clone();
        random[key] = value;
        let case = block(4, &coulomb(), &json!({"mu": {"random": random}}));
        match Written::from_text(&case.to_string(), Path::new("test.json")) {
            Ok(written) => case::build(&written.case, Path::new("test.json")).err().map(|error| error.to_string()),
            Err(error) => Some(error.to_string()),
        }
    };
    assert_eq!(said("seed", json!(2)), None);
    for (key, value, place, what) in [
        ("deviation", json!(-0.1), "contacts.base.along.mu.random.deviation", "is -0.1: must be zero or positive"),
        ("correlation", json!(0), "contacts.base.along.mu.random.correlation", "is 0: must be positive"),
        ("seed", json!(1_u64 << 54), "contacts.base.along.mu.random.seed", "at most 2^53"),
        ("seed", json!(-1), "contacts.base.along.mu.random.seed", "-1"),
        ("seed", json!(1.5), "contacts.base.along.mu.random.seed", "1.5"),
        ("marginal", json!("weibull"), "contacts.base.along.mu.random.marginal", "lognormal"),
        ("spectrum", json!({"von_karman": {"hurst": 0}}), "along.mu.random.spectrum.von_karman.hurst", "is 0"),
        ("spectrum", json!({"von_karman": {"hurst": 1.1}}), "along.mu.random.spectrum.von_karman.hurst", "at most 1"),
        ("length", json!(1), "contacts.base.along.mu.random", "correlation"),
        // No field of this mean has any value that the law takes.
        ("mean", json!(-5), "contacts.base.along.mu at", "positive"),
    ] {
        let message = said(key, value).unwrap_or_else(|| panic!("{key} is taken"));
        assert!(message.contains(place) && message.contains(what), "{key}: {message}");
    }
    let mut random = good.clone();
    random["marginal"] = json!("lognormal");
    random["mean"] = json!(0);
    let case = block(4, &coulomb(), &json!({"mu": {"random": random}}));
    let written = Written::from_text(&case.to_string(), Path::new("test.json")).expect("a case");
    let message = case::build(&written.case, Path::new("test.json")).expect_err("it is refused").to_string();
    assert!(message.contains("along.mu.random.mean") && message.contains("lognormal"), "{message}");
}
