//! An expression in x, y and t.
#![no_main]

use fecontact::model::boundary::Expression;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| match Expression::parse(text) {
    Ok(expression) => {
        let at = |x: f64, t: f64| expression.value([x, 2.0].into(), t);
        assert!(expression.depends_on_time() || at(1.0, 0.0).to_bits() == at(1.0, 3.0).to_bits());
        assert!(expression.depends_on_position() || at(1.0, 0.5).to_bits() == at(-1.0, 0.5).to_bits());
    }
    Err(told) => assert!(!told.to_string().trim().is_empty()),
});
