//! The program as its users meet it: exit codes, messages, both forms of the report, and the files of `reduce`.

mod cli {
    pub mod bad_input;
    pub mod case;
    pub mod decks;
    pub mod exact;
    pub mod factors;
    pub mod form;
    pub mod harness;
    pub mod meant;
    pub mod memory;
    pub mod report;
    pub mod written;
}
