//! The program from the user's view: exit codes, messages, both forms of the report, and the files of `reduce`.

#[path = "support/schema.rs"]
mod schema;

mod cli {
    #[cfg(all(feature = "faults", unix))]
    pub mod allocations;
    pub mod bad_input;
    pub mod case;
    pub mod decks;
    pub mod exact;
    pub mod explain;
    pub mod factors;
    pub mod form;
    pub mod formats;
    pub mod harness;
    pub mod incomplete;
    #[cfg(unix)]
    pub mod kills;
    #[cfg(unix)]
    pub mod limits;
    pub mod load_cases;
    pub mod meant;
    pub mod memory;
    #[cfg(unix)]
    pub mod outputs;
    pub mod page;
    pub mod preferences;
    pub mod report;
    pub mod several;
    #[cfg(all(feature = "spqr", target_os = "linux"))]
    pub mod tight;
    pub mod written;
}
