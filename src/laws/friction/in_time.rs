//! Friction of a contact point through a run: one law, or one whose parameters vary in time.

use std::fmt;
use std::ops::Deref;

use super::{FrictionLaw, LawFailure};

/// The law that holds from one time to another; at a time where both are the same.
///
/// # Errors
/// [`LawFailure::Undefined`] or [`LawFailure::Dilates`] where its parameters have no good values then.
pub type LawOf = dyn Fn([f64; 2]) -> Result<Box<dyn FrictionLaw>, LawFailure> + Send + Sync;

/// Friction through a run: parameters that vary in time are resolved into the law that holds in an increment, or at a time, and
/// that law is asked as it is.
pub struct LawInTime {
    start: Box<dyn FrictionLaw>,
    /// None where nothing varies
    varying: Option<Box<LawOf>>,
}

/// A law that holds at a time.
#[derive(Debug)]
pub enum Held<'a> {
    /// The same at all times
    Always(&'a dyn FrictionLaw),
    /// With the parameters of its time
    Then(Box<dyn FrictionLaw>),
}

/// The laws of a contact that hold in an increment.
pub enum Resolved<'a> {
    /// None of them varies
    Always(&'a [LawInTime]),
    /// With the parameters of the increment
    Then(Vec<Held<'a>>),
}

impl Resolved<'_> {
    /// The law of a number.
    pub fn law(&self, number: usize) -> &dyn FrictionLaw {
        match self {
            Self::Always(laws) => laws[number].start(),
            Self::Then(laws) => &*laws[number],
        }
    }
}

impl LawInTime {
    /// A law whose parameters vary in time, and what it is at the start.
    pub fn varying(start: Box<dyn FrictionLaw>, law: Box<LawOf>) -> Self {
        Self { start, varying: Some(law) }
    }

    /// The law at the start of the run, and what it has at all times: its α_t, the names of what it remembers and shows, and whether it
    /// rubs and dilates.
    pub fn start(&self) -> &dyn FrictionLaw {
        &*self.start
    }

    /// Whether its parameters vary in time.
    pub fn varies(&self) -> bool {
        self.varying.is_some()
    }

    /// The law that holds in an increment from one time to another.
    ///
    /// # Errors
    /// [`LawFailure`] where its parameters have no good values then.
    pub fn during(&self, span: [f64; 2]) -> Result<Held<'_>, LawFailure> {
        self.varying.as_ref().map_or(Ok(Held::Always(&*self.start)), |law| law(span).map(Held::Then))
    }

    /// The law at a time.
    ///
    /// # Errors
    /// [`LawFailure`] where its parameters have no good values then.
    pub fn at(&self, time: f64) -> Result<Held<'_>, LawFailure> {
        self.during([time, time])
    }
}

impl<L: FrictionLaw + 'static> From<L> for LawInTime {
    fn from(law: L) -> Self {
        Box::<dyn FrictionLaw>::from(Box::new(law)).into()
    }
}

impl From<Box<dyn FrictionLaw>> for LawInTime {
    fn from(law: Box<dyn FrictionLaw>) -> Self {
        Self { start: law, varying: None }
    }
}

impl fmt::Debug for LawInTime {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        let varying = if self.varying.is_some() { " at the start, varying in time" } else { "" };
        write!(formatter, "{:?}{varying}", self.start)
    }
}

impl<'a> Deref for Held<'a> {
    type Target = dyn FrictionLaw + 'a;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::Always(law) => *law,
            Self::Then(law) => &**law,
        }
    }
}
