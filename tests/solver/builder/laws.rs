//! Laws and materials of one's own.

use super::*;

/// Twice as stiff as what it wraps: a law of a user.
#[derive(Debug)]
struct Doubled(Box<dyn Material>);

impl BulkLaw for Doubled {
    fn description(&self) -> MaterialDescription<'_> {
        let own = self.0.description();
        MaterialDescription::new(0.0, 2.0 * own.p_wave_modulus, 2.0 * own.shear_modulus)
    }

    fn respond(&self, straining: &Straining, new: &mut [f64]) -> Result<BulkResponse, MaterialFailure> {
        let mut response = self.0.respond(straining, new)?;
        response.stress *= 2.0;
        response.tangent *= 2.0;
        response.energy *= 2.0;
        Ok(response)
    }
}

/// Laws of the user's own serve like those of the house: twice the stiffness by a material that doubles another, and by
/// another modulus; the default penalties follow.
#[test]
fn materials_of_ones_own_serve() {
    let block = || Model::builder(Blocks::default().rectangle("block", [2, 1], [0.0, 0.0], [2.0, 1.0]).mesh());
    let own = block().body("block", Doubled(neo_hookean(100.0, 0.3, 0.0))).contact(on_floor()).step(press());
    let other = block().body("block", neo_hookean(200.0, 0.3, 0.0)).contact(on_floor()).step(press());
    let [own, other] = [own, other].map(|model| finished(built(model)));
    assert_eq!(own.model.contacts[0].alpha_n, other.model.contacts[0].alpha_n);
    let largest = other.reaction("block_top", other.last())[1].abs();
    assert!(largest > 1.0);
    let apart = common::distance(&own.last().reaction, &other.last().reaction);
    assert!(apart < 1e-12 * largest, "{apart:e} of {largest}");
}

/// A law of one section, which is there what it wraps: a law of a user.
#[derive(Debug)]
struct Of(Sections, Box<dyn Material>);

impl BulkLaw for Of {
    fn description(&self) -> MaterialDescription<'_> {
        MaterialDescription { sections: self.0, ..self.1.description() }
    }

    fn respond(&self, straining: &Straining, new: &mut [f64]) -> Result<BulkResponse, MaterialFailure> {
        self.1.respond(straining, new)
    }
}

/// A law that is asked for more than the sections it serves is refused with the place and the reason; one that finds the thickness of
/// a plate itself is in a plate what the house makes of the law for all sections.
#[test]
fn laws_serve_in_their_sections_alone() {
    let law = || neo_hookean(100.0, 0.3, 0.0);
    let plate = Section::PlaneStress { thickness: 0.5 };
    let block = |section: Section, law: Box<dyn Material>| {
        let mesh = Blocks::default().rectangle("block", [2, 1], [1.0, 0.0], [3.0, 1.0]).mesh();
        Model::builder(Mesh { section, ..mesh }).body("block", law).step(press().fix("block_bottom"))
    };
    let [heated, stressed] = [true, false].map(|heated| {
        move |builder: Builder| match heated {
            true => builder.thermal("block", Thermal::new(1e-3)),
            false => builder.initial_stress("block", InitialStress::geostatic(1.0, 1.0, 1.0)),
        }
    });
    for (section, of, [place, why]) in [
        (Section::Axisymmetric, Sections::PlaneStrain, ["bodies.block.material", "hoop stretch"]),
        (Section::Axisymmetric, Sections::Plate, ["bodies.block.material", "hoop stretch"]),
        (Section::PlaneStrain, Sections::Plate, ["bodies.block.material", "is a law of plates"]),
        (plate, Sections::PlaneStrain, ["bodies.block.material", "does not support plane stress"]),
        (plate, Sections::AnyStretch, ["bodies.block.material", "does not support plane stress"]),
    ] {
        let message = block(section, Of(of, law()).into()).build().expect_err("another section").to_string();
        assert!(message.contains(place) && message.contains(why), "{of:?}: {message}");
    }
    let alone = || block(Section::PlaneStrain, Of(Sections::PlaneStrain, law()).into());
    assert!(alone().build().is_ok());
    for (more, place) in [(heated(alone()), "bodies.block.thermal"), (stressed(alone()), "bodies.block.initial_stress")]
    {
        let message = more.build().expect_err("no stretch").to_string();
        assert!(message.contains(place) && message.contains("out-of-plane stretch"), "{message}");
    }
    let own =
        BodyLaw::new(law(), Surroundings { plate: true, ..Surroundings::default() }).expect("it serves in plates");
    let [own, other] = [Of(Sections::Plate, own.into()).into(), law()].map(|law| finished(built(block(plate, law))));
    assert_eq!(own.last().displacement, other.last().displacement);
}

/// Friction without any, which gives names to what it remembers and shows: a law of a user.
#[derive(Clone, Debug)]
struct Named {
    variables: &'static [&'static str],
    offsets: &'static [&'static str],
}

impl FrictionLaw for Named {
    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Result<FrictionResponse, LawFailure> {
        FrictionResponse::elastic(old.stuck(0.0, sliding.pressure.max(0.0)), 0.0).checked(1.0)
    }

    fn description(&self) -> Description {
        Description { variables: self.variables, opening: self.offsets, ..Description::default() }
    }
}

/// Names of a law become those of columns, arrays and files: they must be fit for that, and their own. So it is with laws that are
/// handed to the builder, and with those that are registered, in a case and alone.
#[test]
fn names_that_a_law_gives_are_checked() {
    let named = |variables: &'static [&'static str]| Named { variables, offsets: &["dilation"] };
    let message = |law: Named| {
        let model = small().contact(Contact::new("other", "block_left", floor(), law)).build();
        model.map_or_else(|error| error.to_string(), |_| String::new())
    };
    assert_eq!(message(named(&["mu", "T", "ψ_1", "weakening_slip"])), "");
    let many: Vec<&'static str> = (0..40).map(|k| &*format!("v_{k}").leak()).collect();
    assert_eq!(message(named(many.leak())), "");
    for (law, words) in [
        (named(&["q"]), "a variable cannot be named `q`: the results already use that name"),
        (named(&["dilation"]), "a variable cannot be named `dilation`"),
        (named(&["slip_Rate"]), "a variable cannot be named `slip_Rate`"),
        (
            named(&["../a"]),
            "the name \"../a\" of a variable must begin with a letter and contain only letters, digits and _",
        ),
        (named(&[""]), "the name \"\" of a variable must begin"),
        (named(&["a\u{1b}[31m"]), "the name \"a\\u{1b}[31m\" of a variable must begin"),
        (named(&["a", "b", "a"]), "`a` and `a` differ at most in capitals"),
        (named(&["MU"]), "`mu` and `MU` differ at most in capitals"),
        (
            Named { variables: &[], offsets: &["rise"] },
            "an opening has no part `rise`: outputs show `dilation` and `wear`",
        ),
    ] {
        let message = message(law);
        assert!(
            message.starts_with("contacts.other.friction: the names of the law: ") && message.contains(words),
            "{message}"
        );
    }
    // Parameters that vary in time take the place of none.
    let fades = Profile::Expression(parsed("1 - t"));
    let four = move |_: &[f64], _: f64| -> Checked<Box<dyn FrictionLaw>> { Ok(Box::new(named(&["a", "b", "c", "d"]))) };
    let varying = Friction::varying([("along.mu", fades)], four);
    assert!(small().contact(Contact::new("other", "block_left", floor(), varying)).build().is_ok());
    register("of the tests", move |_, _| Ok(Box::new(named(&["p"]))));
    let friction = json!({"law": "registered", "name": "of the tests", "alpha_t": 1});
    let alone = json!({"friction": friction, "table": [[0, 0, 1], [1, 1, 1]]}).to_string();
    let alone =
        law_test::from_text(&alone, Path::new("test")).and_then(|input| law_test::build(&input, Path::new("test")));
    let alone = alone.map_or_else(|error| error.to_string(), |_| String::new());
    assert!(alone.contains("test: friction: the names of the law: a variable cannot be named `p`"), "{alone}");
}
