//! A gmsh file.
#![no_main]

use fecontact::mesh::gmsh;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    match gmsh::from_bytes(bytes.to_vec()) {
        Ok(mesh) => assert!(mesh.nodes.iter().all(|node| node.x.is_finite() && node.y.is_finite())),
        Err(error) => {
            let told = error.to_string();
            // What a reason quotes may look like one that is empty.
            let quoted = bytes.windows(3).any(|three| three == b": ;");
            assert!(!told.trim().is_empty() && (quoted || !told.contains(": ;")), "{told}");
        }
    }
});
