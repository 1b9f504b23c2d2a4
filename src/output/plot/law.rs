//! The figure of a friction law driven alone.

use super::axis::Axis;
use super::chart::{Curve, Figure, Look, Panel};
use super::error::PlotError;
use super::read::Columns;
use super::source::{Source, Units, subtitle};
use crate::run::law_report::{Hold, PathPoint, Peaks};

const WANTED: [&str; 8] = ["time", "slip", "pressure", "traction", "R", "mu", "structure", "plastic_slip"];

/// Holds that make an ageing curve.
const FEWEST_HOLDS: usize = 3;

/// One folder.
struct Test<'a> {
    name: &'a str,
    columns: Columns,
    holds: Vec<Hold>,
}

/// The figure of `law.svg`.
pub fn figure(sources: &[Source]) -> Result<Figure, PlotError> {
    let tests = sources.iter().map(Test::read).collect::<Result<Vec<_>, _>>()?;
    let units = Units::of(sources);
    let [time, slip] = ["time", "length"].map(|of| units.get(of));
    let time = || Axis::new("time", &time);
    let slip = || Axis::new("slip", &slip);
    let stress = |name: &str| Axis::new(name, units.stress());
    let pressure = || stress("pressure p").including(0.0);
    let panel = |title: &str, x: Axis, y: Axis, curves: Vec<Curve>| Panel { title: title.into(), x, y, curves };
    let of = |x: &str, ys: &[(&str, &str)]| curves(&tests, x, ys);

    let mut panels = vec![
        panel("Traction over slip", slip(), stress("traction q"), of("slip", &[("traction", "q")])?),
        panel("Slip over time", time(), slip(), of("time", &[("slip", "total"), ("plastic_slip", "plastic")])?),
        panel("Friction coefficient over time", time(), Axis::new("coefficient", ""), coefficients(&tests)?),
        panel(
            "State over time",
            time(),
            Axis::new("R, structure", "").including(0.0),
            of("time", &[("R", "R = |q|/(μ p)"), ("structure", "structure 1/R*")])?,
        ),
    ];
    let varies = |test: &Test| test.columns.get("pressure").is_ok_and(|p| p.iter().any(|value| *value != p[0]));
    if tests.iter().any(varies) {
        panels.push(panel("Pressure over time", time(), pressure(), of("time", &[("pressure", "p")])?));
        let curves = of("pressure", &[("traction", "q")])?;
        panels.push(panel("Traction over pressure", pressure(), stress("traction q"), curves));
    }
    if tests.iter().any(|test| test.holds.len() >= FEWEST_HOLDS) {
        let hold = Axis::new("time at rest before", units.get("time")).logarithmic();
        panels.push(panel("Peak after a hold over its length", hold, Axis::new("peak |q|/p", ""), ageing(&tests)));
    }
    let title = "A friction law along a path of slip and pressure".into();
    Ok(Figure { title, subtitle: subtitle(sources), columns: 2, panels })
}

impl<'a> Test<'a> {
    fn read(source: &'a Source) -> Result<Self, PlotError> {
        let columns = Columns::read(&source.folder.join("law.csv"), |name| WANTED.contains(&name))?.with_rows()?;
        let mut peaks = Peaks::default();
        let numbers = ["time", "slip", "pressure", "traction", "mu"].map(|name| columns.get(name));
        let [time, slip, pressure, traction, mu] = numbers;
        let (time, slip, pressure, traction, mu) = (time?, slip?, pressure?, traction?, mu?);
        for k in 0..time.len() {
            peaks.note(PathPoint::new([time[k], slip[k], pressure[k], traction[k], mu[k]]));
        }
        Ok(Self { name: &source.name, columns, holds: peaks.holds })
    }

    /// q/p, without a value where nothing is pressed, and ±μ.
    fn coefficients(&self) -> Result<[Vec<[f64; 2]>; 3], PlotError> {
        let (pressure, mut apparent) = (self.columns.get("pressure")?, self.columns.points("time", "traction")?);
        for (point, p) in apparent.iter_mut().zip(pressure) {
            point[1] = if *p > 0.0 { point[1] / p } else { f64::NAN };
        }
        let above = self.columns.points("time", "mu")?;
        let below = above.iter().map(|[t, mu]| [*t, -mu]).collect();
        Ok([apparent, above, below])
    }
}

/// Curves of every test over one column, each told apart.
fn curves(tests: &[Test], x: &str, ys: &[(&str, &str)]) -> Result<Vec<Curve>, PlotError> {
    let mut curves = Vec::new();
    for test in tests {
        for (y, name) in ys {
            let name = match (tests.len(), ys.len()) {
                (1, _) => (*name).into(),
                (_, 1) => test.name.into(),
                _ => format!("{name}, {}", test.name),
            };
            curves.push(Curve { name, points: test.columns.points(x, y)?, look: Look::Line(curves.len()) });
        }
    }
    Ok(curves)
}

/// q/p of every test between its bounds; the lower one only where friction comes near it.
fn coefficients(tests: &[Test]) -> Result<Vec<Curve>, PlotError> {
    let mut curves = Vec::new();
    for (k, test) in tests.iter().enumerate() {
        let [apparent, above, below] = test.coefficients()?;
        let backwards = apparent.iter().any(|[_, coefficient]| *coefficient < 0.0);
        let of = |what: &str| if tests.len() == 1 { what.into() } else { format!("{what}, {}", test.name) };
        curves.push(Curve { name: of("q/p"), points: apparent, look: Look::Line(k) });
        curves.push(Curve { name: of(if backwards { "±μ" } else { "μ" }), points: above, look: Look::Bound(k) });
        if backwards {
            curves.push(Curve { name: String::new(), points: below, look: Look::Bound(k) });
        }
    }
    Ok(curves)
}

fn ageing(tests: &[Test]) -> Vec<Curve> {
    let curve = |(k, test): (usize, &Test)| Curve {
        name: test.name.into(),
        points: test.holds.iter().map(|hold| [hold.duration, hold.peak.coefficient]).collect(),
        look: Look::Points(k),
    };
    tests.iter().enumerate().map(curve).collect()
}
