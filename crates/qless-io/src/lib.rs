//! Reads and writes constraint systems `C u = b`. All input is checked. Each file is written completely or not at all. A [`Manifest`] says
//! which files of a folder belong together.
//!
//! A case is a folder, or a single Matrix Market file:
//!
//! | file             | holds                                   | if absent              |
//! | ---------------- | --------------------------------------- | ---------------------- |
//! | `C.mtx`          | C, m x n, as in [`matrix_market`]       | an error               |
//! | `b.txt`          | b, m numbers, one a line                | zeros                  |
//! | `prescribed.txt` | `column value` a line, 1-based          | nothing is prescribed  |
//! | `rows.txt`       | one label a line, for each equation     | `row 5`                |
//! | `cols.txt`       | one label a line, for each DOF          | `DOF 5`                |
//!
//! Rows and columns count from 1 in files and messages, from 0 in the API. Errors name the file, the line if there is
//! one, what was found, and what to do.
//!
//! ```
//! use qless_io::{read_case, write_case};
//! # let place = tempfile::tempdir()?;
//! let folder = place.path().join("tie");
//! let mut builder = qless::SystemBuilder::new(2);
//! builder.labelled_equation("tie 7", [(0, 1.0), (1, -1.0)], 0.5);
//! let system = builder.build()?;
//! write_case(&folder, &system)?;
//! assert_eq!(read_case(&folder, None, None)?, system);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bytes;
mod case;
pub mod chunk;
pub mod deck;
mod error;
mod fault;
mod file_chunk;
mod lines;
mod manifest;
pub mod matrix_market;
mod number;
mod opened;
pub mod relations;
pub mod vectors;
pub mod write;

pub use bytes::without_gz;
pub use case::case_files;
pub use error::{ReadError, WriteError};
pub use fault::{NumberFault, Quantity, TextFault};
pub use manifest::{FileRecord, Manifest, ManifestError};
pub use opened::{FileContent, Opened, read_case};
pub use write::write_case;

/// The example of the README, as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
