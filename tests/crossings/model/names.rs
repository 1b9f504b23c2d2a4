//! Names of the parts of a case.

use super::Ways;

/// Names of the parts of a case.
pub struct Names {
    pub block: &'static str,
    pub ground: &'static str,
    pub contact: &'static str,
    pub second: &'static str,
    pub tie: &'static str,
}

impl Names {
    pub fn of(ways: &Ways) -> Self {
        match ways.renamed {
            false => Self { block: "block", ground: "ground", contact: "c", second: "d", tie: "tie" },
            true => Self { block: "upper", ground: "base", contact: "z", second: "e", tie: "zz" },
        }
    }
}
