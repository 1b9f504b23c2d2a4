//! The figures of a run.

use super::axis::Axis;
use super::chart::{Curve, Figure, Look, Panel};
use super::convergence::{HARDEST, increments, residuals, solves};
use super::error::PlotError;
use super::read::Columns;
use super::source::{Source, Units, subtitle};
use crate::laws::friction::FrictionParameters;

/// Columns of `history.csv` that are drawn: these, ...
const ENERGIES: [(&str, &str); 8] = [
    ("external_work", "external work"),
    ("kinetic", "kinetic"),
    ("strain", "strain"),
    ("contact_elastic", "contact, elastic"),
    ("friction_dissipation", "friction"),
    ("damping_dissipation", "damping"),
    ("radiated", "radiated"),
    ("energy_error", "error"),
];
/// ... these of every contact, ...
const CONTACT: [&str; 5] = ["normal_force", "tangential_force", "slip_fraction", "mean_slip", "mean_elastic_slip"];
/// ... and these of every watched set.
const WATCHED: [&str; 2] = ["ux", "uy"];
const NEWTON: [&str; 4] = ["increment", "iteration", "time", "residual"];

/// Motion in one direction this much smaller than in the other is round-off.
const NOISE: f64 = 1e-9;

/// Part of its size that a force must reach backwards for its lower bound to be drawn.
const BACKWARDS: f64 = 0.25;

/// One folder.
struct Run<'a> {
    source: &'a Source,
    history: Columns,
    /// only if there is a `newton.csv` with rows
    newton: Option<Columns>,
}

impl<'a> Run<'a> {
    fn read(source: &'a Source) -> Result<Self, PlotError> {
        let wanted = |name: &str| {
            let of = name.rsplit_once('.').map(|(_, column)| column);
            name == "time"
                || ENERGIES.iter().any(|(energy, _)| *energy == name)
                || of.is_some_and(|column| CONTACT.contains(&column) || WATCHED.contains(&column))
        };
        let history = Columns::read(&source.folder.join("history.csv"), wanted)?;
        history.get("time")?;
        let newton = source.folder.join("newton.csv");
        let newton = newton.is_file().then(|| Columns::read(&newton, |name| NEWTON.contains(&name))).transpose()?;
        Ok(Self { source, history: history.with_rows()?, newton: newton.filter(|newton| !newton.is_empty()) })
    }
}

/// What all figures of a run share.
struct Runs<'a> {
    list: Vec<Run<'a>>,
    units: Units,
}

/// A figure: its file, its title, and what makes its panels.
type Recipe<'a> = (&'static str, &'static str, fn(&Runs<'a>) -> Result<Vec<Panel>, PlotError>);

/// Hand on every figure for which there are data, one after the other: the curves of all of them together would fill the
/// memory.
pub fn figures(
    sources: &[Source],
    mut write: impl FnMut(&str, Figure) -> Result<(), PlotError>,
) -> Result<(), PlotError> {
    let list = sources.iter().map(Run::read).collect::<Result<Vec<_>, _>>()?;
    let runs = Runs { list, units: Units::of(sources) };
    let recipes: [Recipe; 7] = [
        ("displacement.svg", "Displacement of watched sets", Runs::displacements),
        ("friction.svg", "Friction over time", Runs::frictions),
        ("friction_path.svg", "Friction over normal force", Runs::friction_paths),
        ("slip.svg", "Plastic and elastic slip", Runs::slips),
        ("slip_fraction.svg", "Share of the contact that slips", Runs::slip_fractions),
        ("energy.svg", "Energies", Runs::energies),
        ("newton.svg", "Convergence of Newton's method", Runs::convergence),
    ];
    for (file, title, panels) in recipes {
        let panels = panels(&runs)?;
        if !panels.is_empty() {
            write(file, Figure { title: title.into(), subtitle: subtitle(sources), columns: 1, panels })?;
        }
    }
    Ok(())
}

impl Runs<'_> {
    fn time(&self) -> Axis {
        Axis::new("time", self.units.get("time")).including(0.0)
    }

    fn length(&self, name: &str) -> Axis {
        Axis::new(name, self.units.get("length"))
    }

    fn force(&self, name: &str) -> Axis {
        Axis::new(name, self.units.get("force"))
    }

    /// Contacts or sets that have a column in any of the runs.
    fn owners(&self, column: &str) -> Vec<String> {
        let mut owners: Vec<String> = Vec::new();
        for owner in self.list.iter().flat_map(|run| run.history.owners(column)) {
            if !owners.contains(&owner) {
                owners.push(owner);
            }
        }
        owners
    }

    /// A curve of each run that has the column, under the name of the run, or of the quantity if there is one run only.
    fn curves(&self, x: &str, y: &str, quantity: &str) -> Result<Vec<Curve>, PlotError> {
        let mut curves = Vec::new();
        for (k, run) in self.list.iter().enumerate().filter(|(_, run)| run.history.has(y)) {
            let points = run.history.points(x, y)?;
            let name = if self.list.len() == 1 { quantity } else { &run.source.name };
            curves.push(Curve { name: name.into(), points, look: Look::Line(k) });
        }
        Ok(curves)
    }

    fn displacements(&self) -> Result<Vec<Panel>, PlotError> {
        let mut panels = Vec::new();
        for set in self.owners("ux") {
            let [ux, uy] = WATCHED.map(|u| self.curves("time", &format!("{set}.{u}"), u));
            let both = [("ux", ux?), ("uy", uy?)];
            let largest = both.iter().map(|(_, curves)| size(curves)).fold(0.0, f64::max);
            for (u, curves) in both {
                if size(&curves) > NOISE * largest {
                    panels.push(Panel { title: set.clone(), x: self.time(), y: self.length(u), curves });
                }
            }
        }
        Ok(panels)
    }

    fn frictions(&self) -> Result<Vec<Panel>, PlotError> {
        let mut panels = Vec::new();
        for contact in self.owners("tangential_force") {
            let mut curves = self.curves("time", &format!("{contact}.tangential_force"), "friction")?;
            let backwards = acts_backwards(&curves);
            let normal = self.curves("time", &format!("{contact}.normal_force"), "")?;
            // Runs that are compared have the same law and nearly the same normal force: the bounds of one will do.
            let normal = normal.first().map_or(&[][..], |curve| &curve.points);
            for (k, (name, mu)) in self.coefficients(&contact).into_iter().enumerate() {
                let bound = |sign: f64| normal.iter().map(|[t, n]| [*t, sign * mu * n]).collect();
                curves.extend(bounds(&format!("{name} × normal force"), backwards, bound, k));
            }
            panels.push(Panel { title: contact, x: self.time(), y: self.force("tangential force"), curves });
        }
        Ok(panels)
    }

    fn friction_paths(&self) -> Result<Vec<Panel>, PlotError> {
        let mut panels = Vec::new();
        for contact in self.owners("tangential_force") {
            let (normal, tangential) = (format!("{contact}.normal_force"), format!("{contact}.tangential_force"));
            let mut curves = self.curves(&normal, &tangential, "friction")?;
            // A little beyond the curves, which would be hidden by the frame where the normal force is constant.
            let most = 1.05 * curves.iter().flat_map(|curve| &curve.points).fold(0.0, |most, [n, _]| n.max(most));
            let backwards = acts_backwards(&curves);
            for (k, (name, mu)) in self.coefficients(&contact).into_iter().enumerate() {
                let bound = |sign: f64| vec![[0.0, 0.0], [most, sign * mu * most]];
                curves.extend(bounds(&format!("{name} × normal force"), backwards, bound, k));
            }
            let x = self.force("normal force").including(0.0);
            panels.push(Panel { title: contact, x, y: self.force("tangential force").including(0.0), curves });
        }
        Ok(panels)
    }

    /// Names and values of the coefficients that bound friction in a contact, as far as they are known.
    fn coefficients(&self, contact: &str) -> Vec<(&'static str, f64)> {
        let law = self.list.iter().find_map(|run| run.source.about.friction.get(contact));
        law.map_or_else(Vec::new, FrictionParameters::bounds)
    }

    fn slips(&self) -> Result<Vec<Panel>, PlotError> {
        let mut panels = Vec::new();
        for contact in self.owners("mean_slip") {
            for (column, name) in [("mean_slip", "plastic slip"), ("mean_elastic_slip", "elastic slip")] {
                let curves = self.curves("time", &format!("{contact}.{column}"), name)?;
                let title = format!("{contact}: mean {name}");
                panels.push(Panel { title, x: self.time(), y: self.length(name), curves });
            }
        }
        Ok(panels)
    }

    fn slip_fractions(&self) -> Result<Vec<Panel>, PlotError> {
        let mut panels = Vec::new();
        for contact in self.owners("slip_fraction") {
            let curves = self.curves("time", &format!("{contact}.slip_fraction"), "")?;
            let y = Axis::new("slipping share of the closed surface", "").including(0.0).including(1.0);
            panels.push(Panel { title: contact, x: self.time(), y, curves });
        }
        Ok(panels)
    }

    /// All energies of one run in a panel, or a panel for each energy with all runs, and the error apart.
    fn energies(&self) -> Result<Vec<Panel>, PlotError> {
        let mut drawn = Vec::new();
        for (column, name) in ENERGIES {
            let curves = self.curves("time", column, name)?;
            if size(&curves) > 0.0 {
                drawn.push((name, curves));
            }
        }
        let panel = |name: &str, curves| Panel {
            title: name.into(),
            x: self.time(),
            y: Axis::new("energy", self.units.energy()),
            curves,
        };
        if self.list.len() > 1 {
            return Ok(drawn.into_iter().map(|(name, curves)| panel(name, curves)).collect());
        }
        let (error, mut all): (Vec<_>, Vec<_>) = drawn.into_iter().partition(|(name, _)| *name == "error");
        for (k, (_, curves)) in all.iter_mut().enumerate() {
            for curve in curves {
                curve.look = Look::Line(k);
            }
        }
        let all: Vec<Curve> = all.into_iter().flat_map(|(_, curves)| curves).collect();
        let together = (!all.is_empty()).then(|| panel("external work, and where it goes", all));
        Ok(together.into_iter().chain(error.into_iter().map(|(name, curves)| panel(name, curves))).collect())
    }

    fn convergence(&self) -> Result<Vec<Panel>, PlotError> {
        let mut panels = Vec::new();
        for (k, run) in self.list.iter().enumerate() {
            let Some(newton) = &run.newton else { continue };
            let increments = increments(newton)?;
            let name = &run.source.name;
            let title = |what: String| if self.list.len() == 1 { what } else { format!("{name}: {what}") };
            let curve = |points, look| vec![Curve { name: name.clone(), points, look }];
            let what = match increments.len() > HARDEST {
                true => format!("residuals of the {HARDEST} increments with the most solves, of {}", increments.len()),
                false => "residuals of every increment".into(),
            };
            panels.push(Panel {
                title: title(what),
                x: Axis::new("iteration", "").whole(),
                y: Axis::new("‖r‖/‖forces at work‖", "").logarithmic(),
                curves: curve(residuals(newton, &increments)?, Look::Pale(k)),
            });
            let solves = increments.iter().map(|rows| solves(newton, rows)).collect::<Result<_, _>>()?;
            panels.push(Panel {
                title: title("linear solves of every increment, failed attempts included".into()),
                x: self.time(),
                y: Axis::new("linear solves", "").whole().including(0.0),
                curves: curve(solves, Look::Pale(k)),
            });
        }
        Ok(panels)
    }
}

/// The largest |y|.
fn size(curves: &[Curve]) -> f64 {
    curves.iter().flat_map(|curve| &curve.points).fold(0.0, |size, [_, y]| y.abs().max(size))
}

/// Whether a force acts backwards by more than a small part of its size, so that its lower bound is worth its room.
fn acts_backwards(curves: &[Curve]) -> bool {
    let lowest = curves.iter().flat_map(|curve| &curve.points).fold(0.0, |lowest, [_, y]| y.min(lowest));
    -lowest > BACKWARDS * size(curves)
}

/// A bound and, if force acts backwards, its mirror image.
fn bounds(name: &str, backwards: bool, bound: impl Fn(f64) -> Vec<[f64; 2]>, k: usize) -> Vec<Curve> {
    let above = Curve {
        name: if backwards { format!("±{name}") } else { name.into() },
        points: bound(1.0),
        look: Look::Bound(k),
    };
    let below = backwards.then(|| Curve { name: String::new(), points: bound(-1.0), look: Look::Bound(k) });
    std::iter::once(above).chain(below).collect()
}
