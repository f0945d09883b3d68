//! Reads files in chunks, so that several readers can share the work: each takes the lines that start in its range of
//! bytes.
//!
//! The lines are parsed by the same code as in [`read_case`](crate::read_case), with the same errors. Before a chunk
//! is parsed, its reader needs the number of lines in front of it ([`FileChunk::count`]), so that errors name the line
//! in the file.
//!
//! ```
//! use qless_io::chunk::{ChunkedFile, ChunkedMatrix};
//! # let place = tempfile::tempdir()?;
//! let path = place.path().join("C.mtx");
//! std::fs::write(&path, "%%MatrixMarket matrix coordinate real general\n2 2 2\n1 1 5.0\n2 2 x\n")?;
//! let file = ChunkedFile::open(&path)?;
//! let matrix = ChunkedMatrix::open(&file)?;
//! assert_eq!((matrix.rows(), matrix.columns(), matrix.start()), (2, 2, 52));
//!
//! let (first, second) = (file.lines(52..56)?, file.lines(56..file.len())?);
//! let before = matrix.before() + first.count();
//! assert_eq!(matrix.entries(&first, matrix.before())?, [(0, 0, 5.0)]);
//! let error = matrix.entries(&second, before).unwrap_err().to_string();
//! assert!(error.contains("C.mtx:4: the coefficient in row 2, column 2 is `x`: not a number"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod contents;
mod file;

pub use crate::case::CaseFiles;
pub use crate::vectors::PrescribedLine;
pub(crate) use contents::lines_of;
pub use contents::{ChunkedMatrix, ChunkedRhs, check_labels, find_labels, merge_prescribed, prescribed_lines};
pub use file::{ChunkedFile, FileChunk, LineCount};
