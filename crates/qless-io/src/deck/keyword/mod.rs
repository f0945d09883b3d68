//! What readers of keyword decks share: LS-DYNA and Radioss. Their cards have lines with fields in columns, name nodes by sets and parts, and
//! hold at all times, so that there is one load case.
//!
//! | file, lowest layer first | holds |
//! | --- | --- |
//! | `line` | the fields of a line |
//! | `group` | what a group of lines means |
//! | `elements` | the elements of each part, and their faces |
//! | `tied` | nodes that follow the nearest point of a face |
//! | `draft` | the model under construction |

pub mod draft;
pub mod elements;
pub mod group;
pub mod line;
pub mod tied;
