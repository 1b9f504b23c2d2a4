//! Water that flows along a contact: its equations, its nodes, and its steps in time.

mod channel;
mod line;
mod march;

pub use self::channel::{Amounts, Conduit, ConduitState, Gives, InTime, Leak, SourceAt, Transmissivity, Wall, Well};
pub use self::line::{Line, Piece};
pub use self::march::{Reached, TooFast, WallMotion};
