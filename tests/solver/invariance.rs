//! What must not change an answer: map coordinates and units, here more exactly than between the models of the crossings; and the
//! rate to which rate-and-state friction refers.
//!
//! Two whole runs: a block pressed on the ground and dragged over it by the time-dependent law, in implicit dynamics; and the
//! same block sheared until slip weakening tears it off, in explicit increments. Each run is compared with itself.

use crate::common::{self, Blocks, Finished, close, finish, neo_hookean, run_through};
use fecontact::contact::force::ContactState;
use fecontact::laws::friction::{Regime, SlipWeakeningParameters, SuperSubloadingParameters};
use fecontact::mesh::section::Section;
use fecontact::model::boundary::Drive;
use fecontact::model::builder::{Builder, Contact, Friction, LoadStep, Support};
use fecontact::model::{Method, Model, NewtonSettings, Scheme};
use serde_json::json;

/// A run, and how its model is given.
#[derive(Clone)]
struct Given {
    explicit: bool,
    /// In the first units; rings have their axis 3 beside the middle of the block
    section: Section,
    method: Method,
    shift: [f64; 2],
    /// What a unit of length, force and time is called now
    units: [f64; 3],
}

/// Both runs in every section. Coordinates are multiples of 2⁻⁵, and no node of the block lies on one of the ground.
fn all() -> impl Iterator<Item = Given> {
    [Section::PlaneStrain, Section::PlaneStress { thickness: 0.375 }, Section::Axisymmetric].into_iter().flat_map(
        |section| {
            let given = move |explicit| Given {
                explicit,
                section,
                method: Method::GaussToSegment,
                shift: [0.0; 2],
                units: [1.0; 3],
            };
            [false, true].map(given)
        },
    )
}

impl Given {
    fn mesh(&self) -> Blocks {
        let axis = if self.section.is_axisymmetric() { 3.0 } else { 0.0 };
        let mut mesh = Blocks::default().rectangle("block", [8, 4], [-0.5625, 0.0], [0.4375, 0.5]).rectangle(
            "ground",
            [16, 4],
            [-2.0, -1.0],
            [2.0, 0.0],
        );
        for [x, y] in &mut mesh.nodes {
            (*x, *y) = (self.units[0] * (*x + axis) + self.shift[0], self.units[0] * *y + self.shift[1]);
        }
        mesh
    }

    fn law(&self) -> Friction {
        let [length, _, time] = self.units;
        match self.explicit {
            true => SlipWeakeningParameters::new(0.5, 0.2, 2e-4 * length).into(),
            false => SuperSubloadingParameters {
                kappa: 20.0 / length,
                xi: 0.05 / time,
                structure: Some(1.5),
                ..SuperSubloadingParameters::new(0.4, 0.2, 2000.0 / length)
            }
            .into(),
        }
    }

    /// The top of the block on its way to a place.
    fn top(&self, [x, y]: [f64; 2]) -> Support {
        Support::on("block_top").ux(x * self.units[0]).uy(y * self.units[0])
    }

    fn steps(&self, model: Builder) -> Builder {
        let [length, _, time] = self.units;
        let press = LoadStep::new("press", time).scheme(Scheme::Static).dt(0.5 * time).fix("ground_bottom");
        let model = model.step(press.support(self.top([0.0, -2e-3])));
        if !self.explicit {
            let drag = LoadStep::new("drag", time).scheme(Scheme::Hht { alpha: -0.1 }).dt(0.0625 * time);
            return model.step(drag.support(self.top([4e-3, -2e-3])));
        }
        let shear = LoadStep::new("shear", time).scheme(Scheme::Static).dt(0.25 * time);
        // The top is pulled on ten times slower than shear waves run, and the bottom of the block tears off from one end.
        let tear = LoadStep::new("tear", 0.5 * time).scheme(Scheme::Explicit { safety: 0.9 }).dt(0.5 * time);
        let pulled = Support::on("block_top").ux(Drive::Rate(0.01 * length / time)).uy(Drive::Rate(0.0));
        model.step(shear.support(self.top([8e-4, -2e-3]))).step(tear.support(pulled))
    }

    fn model(&self) -> Builder {
        let [length, force, time] = self.units;
        let material = || neo_hookean(100.0 * force / length.powi(2), 0.3, force * time.powi(2) / length.powi(4));
        let section = match self.section {
            Section::PlaneStress { thickness } => Section::PlaneStress { thickness: thickness * length },
            section => section,
        };
        let contact = Contact::new("base", "block_bottom", "ground_top", self.law()).method(self.method);
        let newton = NewtonSettings { tolerance: 1e-12, ..NewtonSettings::default() };
        let model = Model::builder(self.mesh().mesh()).section(section);
        let model = model.body("block", material()).body("ground", material()).contact(contact);
        self.steps(model.newton(newton).interval(0.0625 * time))
    }

    fn run(&self) -> Answer {
        let run = run_through(self.model());
        let [length, force, time] = self.units;
        let stress = force / length.powi(2);
        let unit = if self.section == Section::PlaneStrain { force / length } else { force };
        let states = run.states.iter().map(|state| {
            let friction = || state.contacts[0].iter().map(|point| &point.friction);
            let of_points =
                friction().map(|friction| friction.pressure).chain(friction().map(|friction| friction.traction));
            Instant {
                time: state.time / time,
                force: run.reaction("block_top", state).map(|force| force / unit),
                tractions: of_points.map(|value| value / stress).collect(),
            }
        });
        Answer { states: states.collect(), run }
    }
}

/// What a run found, in the units of the first model.
struct Answer {
    states: Vec<Instant>,
    run: Finished,
}

#[derive(Clone, Debug, PartialEq)]
struct Instant {
    time: f64,
    /// On the top of the block, in plane strain per thickness
    force: [f64; 2],
    /// Pressures and tractions of all contact points along the slave
    tractions: Vec<f64>,
}

impl Answer {
    /// Largest difference of forces, relative to the largest force, and of tractions, relative to the largest pressure.
    #[track_caller]
    fn away_from(&self, other: &Self) -> f64 {
        assert_eq!(self.states.len(), other.states.len(), "increments");
        let kinds: [fn(&Instant) -> Vec<f64>; 2] = [|state| state.tractions.clone(), |state| state.force.into()];
        let away = |kind: fn(&Instant) -> Vec<f64>| {
            let [a, b] = [self, other].map(|answer| answer.states.iter().flat_map(kind).collect::<Vec<_>>());
            common::distance(&a, &b) / a.iter().fold(0.0, |most: f64, v| most.max(v.abs()))
        };
        kinds.map(away).into_iter().fold(0.0, f64::max)
    }

    /// The runs must show what they are meant for: sticking, slipping and opening points, and slip that goes on.
    fn is_worth_comparing(&self) {
        let last = self.run.last();
        let slips = last.contacts[0].iter().map(|point| point.friction.plastic_slip.abs());
        let (least, most) =
            slips.fold((f64::INFINITY, 0.0f64), |(least, most), slip| (least.min(slip), most.max(slip)));
        // Plates and rings slip more alike, but their surfaces do not slide as rigid ones would.
        let alike = match self.run.model.mesh.section {
            Section::PlaneStress { .. } => 0.85,
            Section::Axisymmetric => 0.95,
            _ => 0.8,
        };
        assert!(most > 1e-5 && least < alike * most, "slip is not uniform: {least:e} to {most:e}");
        let [along, normal] = self.states.last().expect("states").force;
        assert!(along.abs() > 0.1 * normal.abs(), "friction holds something: {along:e}, {normal:e}");
    }
}

/// By 2²³, the size of map coordinates in metres, rings along their axis alone. All coordinates are multiples of 2⁻²⁰, so the mesh is
/// exactly the same. A gap taken as a difference of positions x = X + u would lose 2⁻²⁹ of a unit, two thousandths of these
/// displacements.
#[test]
fn moved_far_from_the_origin() {
    let far = 8_388_608.0;
    for given in all() {
        let by_method = |method| Given { method, ..given.clone() };
        let methods: &[Method] = match (given.section, given.explicit) {
            (Section::PlaneStrain, false) => &[Method::GaussToSegment, Method::Mortar, Method::NodeToSegment],
            (Section::Axisymmetric, _) => &[Method::GaussToSegment, Method::Mortar],
            _ => &[Method::GaussToSegment],
        };
        for first in methods.iter().map(|method| by_method(*method)) {
            let shift = if given.section.is_axisymmetric() { [0.0, -far] } else { [far, -far] };
            let (a, b) = (first.run(), Given { shift, ..first }.run());
            a.is_worth_comparing();
            let away = a.away_from(&b);
            assert!(away <= 1e-9, "the answers differ by {away:e}");
        }
    }
}

/// Powers of four scale without round-off, also under a root: nothing in the program has a unit of its own.
#[test]
fn in_units_that_are_powers_of_four_bit_by_bit() {
    for first in all() {
        let other = Given { units: [2f64.powi(-10), 2f64.powi(20), 2f64.powi(-6)], ..first.clone() };
        let same = first.run().states == other.run().states;
        assert!(same, "{:?}, explicit {}: a number has a unit of its own", first.section, first.explicit);
    }
}

/// Rate-and-state friction that is measured at another rate V₀, f₀ + (a − b) ln(V₀'/V₀) with the same θ, is the same law: so
/// are forces, and what slips. The block sticks at first, and slides as a whole at the end.
#[test]
fn what_slips_does_not_depend_on_the_reference_rate() {
    let slides = |reference: f64| {
        let (a, b) = (0.01, 0.005);
        let f_0 = 0.6 + (a - b) * (reference / 1e-6f64).ln();
        let run = finish(&json!({
            "mesh": Blocks::default().rectangle("slab", [8, 4], [0.0, 0.0], [1.0, 0.5]).json(),
            "bodies": {"slab": {"material": {"model": "linear", "E": 1000, "nu": 0.3}}},
            "contacts": {"base": {
                "slave": "slab_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
                "friction": {"law": "rate_and_state", "f_0": f_0, "V_0": reference, "a": a, "b": b, "D_c": 1e-4,
                             "theta": 100},
                "initial": {"pressure": 1, "balanced": true},
            }},
            "newton": {"tolerance": 1e-11},
            "steps": [{"name": "slide", "duration": 2000, "scheme": "static", "dt": {"initial": 50},
                       "supports": [{"on": "slab_top", "ux": {"rate": 1e-6}, "uy": 0}]}],
        }));
        run.states.into_iter().map(|state| state.contacts[0].clone()).collect::<Vec<_>>()
    };
    let first = slides(1e-6);
    let regimes = |states: &[ContactState]| states.iter().map(ContactState::regime).collect::<Vec<_>>();
    for reference in [1e-9, 1e-3] {
        let other = slides(reference);
        assert_eq!(first.len(), other.len());
        for (states, others) in first.iter().zip(&other) {
            assert_eq!(regimes(states), regimes(others), "V₀ = {reference}");
            for (state, other) in states.iter().zip(others) {
                close("q", other.friction.traction, state.friction.traction, 1e-8);
                close("p", other.friction.pressure, state.friction.pressure, 1e-8);
            }
        }
    }
    assert!(regimes(&first[0]).contains(&Regime::Stick), "{:?}", regimes(&first[0]));
    let last = regimes(&first[first.len() - 1]);
    assert!(!last.contains(&Regime::Stick) && last.contains(&Regime::Slip), "{last:?}");
}
