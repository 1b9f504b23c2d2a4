//! The layers of the house: a module imports only from lower ones.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Module → layer. A new module must be listed.
const LAYERS: [(&str, u32); 30] = [
    ("parameter", 0),
    ("configuration", 1),
    ("shape", 1),
    ("time", 1),
    ("friction", 1),
    ("material", 1),
    ("linear", 1),
    ("ties", 1),
    ("system", 2),
    ("boundary", 3),
    ("contact", 3),
    ("element", 3),
    ("newton", 3),
    ("error", 3),
    ("mesh", 4),
    ("state", 4),
    ("law_path", 4),
    ("model", 5),
    ("assembly", 6),
    ("floating", 6),
    ("energy", 6),
    ("explicit", 7),
    ("step", 7),
    ("increments", 8),
    ("output", 8),
    ("run", 9),
    ("law_driver", 9),
    ("case", 10),
    ("command", 10),
    ("main", 11),
];

/// Modules of one layer that may see each other, in this direction only.
const WITHIN_LAYER: [(&str, &str); 3] = [("error", "newton"), ("output", "increments"), ("command", "case")];

fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("src can be read").map(|entry| entry.expect("an entry").path());
    entries.flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] }).collect()
}

/// The module a file belongs to: the first part of its path below src.
fn module(file: &Path, root: &Path) -> String {
    let below = file.strip_prefix(root).expect("below src");
    let first = below.components().next().expect("a name").as_os_str().to_string_lossy().into_owned();
    first.trim_end_matches(".rs").into()
}

/// Names behind `crate::` in a line of code, comments left out.
fn imports(text: &str) -> Vec<String> {
    let code = text.lines().map(|line| line.split("//").next().unwrap_or_default());
    let after = code.flat_map(|line| line.split("crate::").skip(1));
    after.map(|rest| rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()).collect()
}

#[test]
fn modules_import_only_from_lower_layers() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let layers: BTreeMap<&str, u32> = LAYERS.into();
    let mut seen = 0;
    for file in sources(&root) {
        let own = module(&file, &root);
        if own == "lib" {
            continue;
        }
        let layer = layers.get(own.as_str()).unwrap_or_else(|| panic!("{own} is in no layer: list it"));
        let text = std::fs::read_to_string(&file).expect("a source file");
        for import in imports(&text).into_iter().filter(|import| *import != own) {
            let Some(other) = layers.get(import.as_str()) else {
                panic!("{}: {import} is in no layer", file.display())
            };
            let allowed = other < layer || WITHIN_LAYER.contains(&(own.as_str(), import.as_str()));
            assert!(allowed, "{}: {own} (layer {layer}) imports {import} (layer {other})", file.display());
            seen += 1;
        }
    }
    assert!(seen > 50, "only {seen} imports were found: the test does not see them");
}
