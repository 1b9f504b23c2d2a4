//! Tables of results as `report` reads them: the first byte says which table is replaced by the rest.
#![no_main]

use std::fs;
use std::path::PathBuf;
use std::sync::LazyLock;

use fecontact::output::report;
use libfuzzer_sys::fuzz_target;

const SOUND: [(&str, &[u8]); 5] = [
    ("history.csv", include_bytes!("../seeds/tables/history.csv")),
    ("newton.csv", include_bytes!("../seeds/tables/newton.csv")),
    ("law.csv", include_bytes!("../seeds/tables/law.csv")),
    ("fronts.csv", include_bytes!("../seeds/tables/fronts.csv")),
    ("summary.json", include_bytes!("../seeds/tables/summary.json")),
];

static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = std::env::temp_dir().join(format!("fecontact_fuzz_{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder");
    folder
});

fuzz_target!(|bytes: &[u8]| {
    let Some((which, table)) = bytes.split_first() else { return };
    for (k, (name, sound)) in SOUND.into_iter().enumerate() {
        let content = if usize::from(*which) % SOUND.len() == k { table } else { sound };
        fs::write(FOLDER.join(name), content).expect("a file");
    }
    if let Err(error) = report::page(std::slice::from_ref(&*FOLDER)) {
        assert!(!error.to_string().trim().is_empty());
    }
});
