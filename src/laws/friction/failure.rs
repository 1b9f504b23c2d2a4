//! Why a law could not answer.

use thiserror::Error;

/// Why a law could not answer; the increment is tried again with a smaller step.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum LawFailure {
    /// The increment itself is not a finite number.
    #[error("friction was asked for a slip {slip}, pressure {pressure} and time {dt} that are not all finite")]
    NotFinite {
        /// slip increment [L]
        slip: f64,
        /// pressure [F/L²]
        pressure: f64,
        /// increment length [T]
        dt: f64,
    },
    /// The increment goes back in time.
    #[error("friction was asked for an increment of negative time {dt}")]
    NegativeTime {
        /// increment length [T]
        dt: f64,
    },
    /// The equation of plastic slip was not solved, or the sub-steps of the increment did not come to agree.
    #[error(
        "friction did not converge within {evaluations} evaluations: {rest:.3e} of the trial traction {trial:.3e} is left"
    )]
    NotConverged {
        /// evaluations of the equation of plastic slip
        evaluations: usize,
        /// what is left out of balance, or the difference between sub-steps [F/L²]
        rest: f64,
        /// |q_tr|: traction without plastic slip [F/L²]
        trial: f64,
    },
    /// The opening of a law that dilates grows faster with the pressure than the contact gives way.
    #[error("the opening {opening:.6e} of the friction law and the pressure {pressure:.6e} did not come to agree")]
    Opening {
        /// d [L]
        opening: f64,
        /// p [F/L²]
        pressure: f64,
    },
    /// Parameters that vary in time have no good value at a time.
    #[error("the parameters of the friction law are not finite, or out of their range, at t = {time}: look at `along`")]
    Undefined {
        /// t [T]
        time: f64,
    },
    /// Parameters that vary in time let the surfaces dilate more than they rub.
    #[error(
        "the opening per slip {rate} (dilatancy.rate) is not below the least friction coefficient {least} that the law can come to \
         at t = {time}, and sliding would yield work: lower dilatancy.rate, or see that `along` stays above it"
    )]
    Dilates {
        /// t [T]
        time: f64,
        /// tan ψ [-]
        rate: f64,
        /// least coefficient of the law then [-]
        least: f64,
    },
    /// The state was not finite, or the increment is so large that it no longer is.
    #[error("the friction state is not finite: the traction is {traction}")]
    Overflow {
        /// q: traction [F/L²]
        traction: f64,
    },
    /// A registered law has failed; whoever registered it knows why.
    #[error("a registered friction law gave no answer")]
    Registered,
}
