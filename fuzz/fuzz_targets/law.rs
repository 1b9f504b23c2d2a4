//! A test of a law: read, checked, and driven for a thousand steps.
#![no_main]

use std::path::Path;

use fecontact::case::law_test;
use fecontact::run::error::Error;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let path = Path::new("test.json");
    let Ok(input) = law_test::from_text(text, path) else { return };
    match law_test::build(&input, path) {
        Err(error) => assert!(!error.message.trim().is_empty()),
        Ok(test) => {
            let mut rows = 0;
            let _ = test.run(|_| {
                rows += 1;
                if rows > 1000 { Err(Error::Interrupted) } else { Ok(()) }
            });
        }
    }
});
