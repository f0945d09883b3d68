//! What goes with C, one item a line: b, prescribed values, labels.
//!
//! Blank lines and `#` or `%` comments are passed over in files of numbers; in a file of labels every
//! line is a label. Columns count from 1 in the files, DOFs from 0 here.

pub(crate) mod labels;
pub(crate) mod prescribed;
pub(crate) mod rhs;

pub use labels::read_labels;
pub use prescribed::read_prescribed;
pub use rhs::read_rhs;
