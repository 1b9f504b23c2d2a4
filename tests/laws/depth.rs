//! How many functions of the library lie between an increment and a law: what one reads to follow a slip or a stretch from the increment to
//! the answer. They are those of a library that is not optimized, in which none is inlined (`.ci/run` has the command):
//!
//! ```text
//! cargo test --release --no-default-features --config profile.release.package.fecontact.opt-level=0 --test laws depth -- --ignored
//! ```

use std::backtrace::Backtrace;
use std::sync::Mutex;

use crate::common::{finished, on_threads};
use fecontact::laws::bulk::{
    BulkLaw, BulkResponse, CauchyStress, ElasticConstants, InadmissibleStress, Linear, MaterialDescription,
    MaterialFailure, NeoHookean, Straining, Viscoelastic, ViscoelasticConstants,
};
use fecontact::laws::friction::{Answer, Coulomb, CoulombParameters, Description, FrictionLaw, FrictionState, Sliding};
use fecontact::mesh::{InlineMesh, Section};
use fecontact::model::boundary::Drive;
use fecontact::model::builder::{Builder, Contact, LoadStep, Support};
use fecontact::model::{Method, Model, Scheme};
use nalgebra::Vector2;

/// The most functions that lie between.
const MOST: usize = 12;

/// The longest chains of functions from a law of friction, and from one of a body.
static LONGEST: Mutex<[Vec<String>; 2]> = Mutex::new([Vec::new(), Vec::new()]);

/// Notes the functions of the library from its caller up to the increment.
fn note(kind: usize) {
    let all = Backtrace::force_capture().to_string();
    let names = all.lines().filter_map(|line| line.trim().split_once(": ")).map(|(_, name)| name.to_string());
    let own = names.filter(|name| name.starts_with("fecontact::") || name.starts_with("<fecontact::"));
    let mut chain: Vec<String> = own.collect();
    // Laws are also asked before the first increment.
    let Some(end) = chain.iter().position(|name| name.ends_with("time::increment::advance")) else { return };
    chain.truncate(end);
    let longest = &mut LONGEST.lock().expect("no thread panics")[kind];
    if chain.len() > longest.len() {
        *longest = chain;
    }
}

/// A law that notes by which functions it is asked.
#[derive(Clone, Debug)]
struct Noted<L>(L);

impl FrictionLaw for Noted<Coulomb> {
    fn description(&self) -> Description {
        self.0.description()
    }

    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Answer {
        note(0);
        self.0.respond(old, sliding)
    }
}

impl<L: BulkLaw> BulkLaw for Noted<L> {
    fn description(&self) -> MaterialDescription<'_> {
        self.0.description()
    }

    fn respond(&self, straining: &Straining, new: &mut [f64]) -> Result<BulkResponse, MaterialFailure> {
        note(1);
        self.0.respond(straining, new)
    }

    fn begin(&self, at: Vector2<f64>, stress: &CauchyStress, variables: &mut [f64]) -> Result<(), InadmissibleStress> {
        self.0.begin(at, stress, variables)
    }
}

/// A block pressed on the ground and dragged.
fn model(law: impl BulkLaw + 'static, step: LoadStep, contact: fn(Contact) -> Contact) -> Builder {
    let mesh = InlineMesh::default()
        .rectangle("ground", [4, 2], [0.0, -1.0], [4.0, 0.0])
        .rectangle("block", [3, 3], [1.0, 0.0], [3.0, 1.0])
        .build()
        .expect("a mesh");
    let step = step
        .dt(0.5)
        .fix("ground_bottom")
        .support(Support::on("block_top").ux(Drive::Rate(0.05)).uy(Drive::Rate(-0.01)));
    let friction = Noted(Coulomb::new(&CoulombParameters::new(0.3), 1e4).expect("a law"));
    let ground = Linear::new(&with!(ElasticConstants::new(1000.0, 0.3), density: 1.0)).expect("a law");
    let base = Contact::new("base", "block_bottom", "ground_top", friction).alpha_n(1e4);
    Model::builder(mesh).body("block", law).body("ground", ground).contact(contact(base)).step(step)
}

/// The lengths of the chains from both kinds of laws in a run.
fn depth(what: &str, model: Builder) -> [usize; 2] {
    // On one thread everything has one stack.
    on_threads(1, || finished(model.build().expect("a model")));
    let chains = std::mem::take(&mut *LONGEST.lock().expect("no thread panics"));
    chains.map(|chain| {
        println!("{what}: {}", chain.len());
        chain.iter().for_each(|name| println!("    {name}"));
        assert!(chain.len() <= MOST, "{what}: {} functions between an increment and a law: {chain:#?}", chain.len());
        chain.len()
    })
}

#[test]
#[ignore = "of a library that is not optimized"]
fn few_functions_lie_between_an_increment_and_a_law() {
    let constants = with!(ElasticConstants::new(1000.0, 0.3), density: 1.0);
    let elastic = || Noted(NeoHookean::new(&constants).expect("a law"));
    // It is asked once, for the stiffness that all increments have.
    let linear = || Linear::new(&constants).expect("a law");
    let viscous = with!(ViscoelasticConstants::new(1000.0, 0.3, 100.0, 1.0), density: 1.0);
    let viscous = || Noted(Viscoelastic::new(&viscous).expect("a law"));
    let still = || LoadStep::new("drag", 1.0);
    let moving = || still().scheme(Scheme::GeneralizedAlpha { rho_infinity: 0.8 });
    let small = |contact: Contact| contact.method(Method::NodeToSegment).small_sliding();
    let found = [
        depth("averages over edges", model(elastic(), still(), |contact| contact)),
        depth("projections", model(elastic(), still(), |contact| contact.method(Method::NodeToSegment))),
        depth("multipliers", model(elastic(), still(), |contact| contact.penetration(1e-3))),
        depth("a body that remembers", model(viscous(), still(), |contact| contact)),
        depth("rings that remember", model(viscous(), still(), |contact| contact).section(Section::Axisymmetric)),
        depth("F-bar elements that remember", model(viscous(), still(), |contact| contact).f_bar("block")),
        depth(
            "F-bar rings that remember",
            model(viscous(), still(), |contact| contact).section(Section::Axisymmetric).f_bar("block"),
        ),
        depth("F-bar elements", model(elastic(), still(), |contact| contact).f_bar("block")),
        depth("linear bodies, condensed on the contact", model(linear(), moving(), small)),
    ];
    assert!(found.iter().all(|[friction, _]| *friction > 0), "{found:?}");
    assert!(found[..8].iter().all(|[_, bulk]| *bulk > 0), "{found:?}");
}
