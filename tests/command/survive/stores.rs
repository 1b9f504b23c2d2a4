//! Stores and checkpoints of runs that are killed.

use super::*;

/// Number of the folder's records as `.zmetadata` and every `.zarray` count them: all alike.
fn counted(store: &Path) -> usize {
    let (shape, time) = store::array(store, "time");
    assert_eq!(store::array(store, "base.slip").0[0], shape[0]);
    assert!(time.iter().all(|time| time.is_finite()), "{time:?}: what is counted is gone");
    shape[0]
}

/// Records that are taken back are no longer counted once they begin to go: whenever the run that goes on is killed, its store
/// opens. A folder stands in the place of a chunk, so that it ends while it takes them back.
#[test]
fn a_store_never_counts_records_that_were_taken_back() {
    let folder = TempDir::new().expect("a folder");
    written(folder.path(), &dragged(json!("static"), 8));
    done(&run(folder.path(), "out", &[]));
    let out = folder.path().join("out");
    let store = out.join("interface.zarr");
    let all = counted(&store);
    // The run goes on from the checkpoint before the last one.
    fs::remove_file(out.join("checkpoint.bin")).expect("it was there");
    let chunk = store.join("base.structure/0.0");
    fs::rename(&chunk, folder.path().join("aside")).expect("it is moved");
    fs::create_dir(&chunk).expect("a folder");
    let told = told(&run(folder.path(), "out", &["--resume"]), 2);
    assert!(told.contains("base.structure/0.0"), "{told}");
    assert!(counted(&store) < all);
    fs::remove_dir(&chunk).expect("it is empty");
    fs::rename(folder.path().join("aside"), &chunk).expect("it is moved");
    done(&run(folder.path(), "out", &["--resume"]));
    assert_eq!(counted(&store), all);
}

/// The store of an earlier run is taken away beginning with what counts its records: whenever that ends, no reader finds records
/// that are gone. A folder stands in the place of a chunk, so that it ends on the way.
#[test]
fn a_store_that_is_taken_away_counts_nothing() {
    let folder = TempDir::new().expect("a folder");
    written(folder.path(), &dragged(json!("static"), 4));
    done(&run(folder.path(), "out", &[]));
    let store = folder.path().join("out/interface.zarr");
    for name in ["time", "base.x", "base.slip", "base.structure"] {
        fs::create_dir(store.join(name).join("9")).expect("a folder");
    }
    assert!(told(&run(folder.path(), "out", &[]), 2).contains("/9: "));
    let descriptions = [".zmetadata", "time/.zarray", "base.slip/.zarray"];
    assert!(descriptions.iter().all(|name| !store.join(name).exists()));
}
