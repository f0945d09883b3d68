//! Reads files in chunks, so that several readers can share the work: each reads the lines that start in its range of
//! bytes.
//!
//! [`read_case`](crate::read_case) uses the same parsers, with the same errors. To parse a chunk, a reader needs the
//! number of lines before it ([`FileChunk::count`]), so that errors name the line in the file.
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

pub use crate::case::CaseFiles;
pub use crate::file_chunk::{ChunkedFile, FileChunk, LineCount};
pub use crate::matrix_market::ChunkedMatrix;
pub use crate::vectors::{ChunkedRhs, PrescribedLine, check_labels, find_labels, merge_prescribed, prescribed_lines};
