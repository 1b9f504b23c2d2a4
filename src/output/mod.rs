//! Output of a run: observers of every attempt, and the files they write.

mod csv;
mod depths;
mod frames;
mod opened;
pub mod results;
mod slid_bars;
mod units;
mod unpressed;

// The writers of these files are internal to the program.
cfg_if::cfg_if! {
    if #[cfg(feature = "internals")] {
        pub mod audit;
        pub mod bodies;
        pub mod checkpoint;
        pub mod coarse;
        pub mod concerns;
        pub mod events;
        pub mod few_edges;
        pub mod fields;
        pub mod files;
        pub mod folder;
        pub mod friction_history;
        pub mod fronts;
        pub mod gradients;
        pub mod history;
        pub mod instability;
        pub mod scattered;
        pub mod store;
        pub mod law;
        pub mod named;
        pub mod newton_log;
        pub mod probes;
        pub mod quantities;
        pub mod recovery;
        pub mod report;
        pub mod sections;
        pub mod summary;
        pub mod vtu;
        pub mod warnings;
    } else {
        pub(crate) mod audit;
        pub(crate) mod bodies;
        pub(crate) mod checkpoint;
        pub(crate) mod coarse;
        pub(crate) mod concerns;
        pub(crate) mod events;
        pub(crate) mod few_edges;
        pub(crate) mod fields;
        pub(crate) mod files;
        pub(crate) mod folder;
        pub(crate) mod friction_history;
        pub(crate) mod fronts;
        pub(crate) mod gradients;
        pub(crate) mod history;
        pub(crate) mod instability;
        pub(crate) mod scattered;
        pub(crate) mod store;
        pub(crate) mod law;
        pub(crate) mod named;
        pub(crate) mod newton_log;
        pub(crate) mod probes;
        pub(crate) mod quantities;
        pub(crate) mod recovery;
        pub(crate) mod report;
        pub(crate) mod sections;
        pub(crate) mod summary;
        pub(crate) mod vtu;
        pub(crate) mod warnings;
    }
}
