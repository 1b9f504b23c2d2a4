//! Output of a run: observers of every attempt, and the files they write.

mod coarse;
pub(crate) mod concerns;
mod csv;
mod depths;
mod few_edges;
pub(crate) mod folder;
mod frames;
pub(crate) mod friction_history;
mod instability;
pub(crate) mod law;
mod opened;
mod rattling;
pub mod results;
mod scattered;
mod slid_bars;
pub(crate) mod summary;
mod units;
mod unpressed;
mod vtu;
mod worst;

// The writers of these files are internal to the program.
cfg_if::cfg_if! {
    if #[cfg(feature = "internals")] {
        pub mod audit;
        pub mod bodies;
        pub mod checkpoint;
        pub mod events;
        pub mod fields;
        pub mod files;
        pub mod fronts;
        pub mod gradients;
        pub mod history;
        pub mod store;
        pub mod named;
        pub mod newton_log;
        pub mod probes;
        pub mod quantities;
        pub mod recovery;
        pub mod report;
        pub mod sections;
        pub mod warnings;
    } else {
        pub(crate) mod audit;
        pub(crate) mod bodies;
        pub(crate) mod checkpoint;
        pub(crate) mod events;
        pub(crate) mod fields;
        pub(crate) mod files;
        pub(crate) mod fronts;
        pub(crate) mod gradients;
        pub(crate) mod history;
        pub(crate) mod store;
        pub(crate) mod named;
        pub(crate) mod newton_log;
        pub(crate) mod probes;
        pub(crate) mod quantities;
        pub(crate) mod recovery;
        pub(crate) mod report;
        pub(crate) mod sections;
        pub(crate) mod warnings;
    }
}
