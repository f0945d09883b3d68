//! Conversions to and from the sparse matrices of other crates, each behind a feature of its crate's name.
//!
//! `Csr::try_from(&theirs)` copies and sorts; `Theirs::from(&csr)` copies. Entries, zeros included, are kept.

#[cfg(feature = "nalgebra-sparse")]
mod nalgebra;
#[cfg(feature = "sprs")]
mod sprs;

#[cfg(any(feature = "nalgebra-sparse", feature = "sprs"))]
use crate::{Csr, SystemError};

/// Checks that a number of columns fits the library's 32-bit indices.
#[cfg(any(feature = "nalgebra-sparse", feature = "sprs"))]
fn columns_fit(found: usize) -> Result<(), SystemError> {
    if u32::try_from(found).is_ok() {
        Ok(())
    } else {
        Err(SystemError::TooLarge { what: "the number of columns", found })
    }
}

/// The matrix from rows whose entries may be in any order.
#[cfg(any(feature = "nalgebra-sparse", feature = "sprs"))]
fn from_rows<R>(cols: usize, rows: impl Iterator<Item = R>) -> Result<Csr, SystemError>
where
    R: Iterator<Item = (usize, f64)>,
{
    columns_fit(cols)?;
    let mut matrix = Csr::empty(cols);
    for row in rows {
        let mut entries: Vec<(usize, f64)> = row.collect();
        entries.sort_by_key(|entry| entry.0);
        matrix.append(entries);
    }
    Ok(matrix)
}

#[cfg(all(test, feature = "nalgebra-sparse", feature = "sprs"))]
mod tests {
    use crate::{ConstraintSystem, Csr, Options, analyse};

    fn tie() -> Csr {
        let mut matrix = Csr::empty(3);
        matrix.append([(0, 1.0), (2, -1.0)]);
        matrix.append([]);
        matrix.append([(1, 0.5), (2, 0.25)]);
        matrix
    }

    #[test]
    fn there_and_back_is_the_same() {
        let csr = tie();
        assert_eq!(Csr::try_from(&sprs::CsMat::from(&csr)), Ok(csr.clone()));
        assert_eq!(Csr::try_from(&sprs::CsMat::from(&csr).to_csc()), Ok(csr.clone()));
        assert_eq!(Csr::try_from(&nalgebra_sparse::CsrMatrix::from(&csr)), Ok(csr.clone()));
        assert_eq!(Csr::try_from(&nalgebra_sparse::CscMatrix::from(&nalgebra_sparse::CsrMatrix::from(&csr))), Ok(csr));
    }

    #[test]
    fn a_system_from_their_matrices_is_analysed() {
        let theirs = sprs::CsMat::from(&tie());
        let system =
            ConstraintSystem::from_csr(&Csr::try_from(&theirs).expect("fits"), &[0.0; 3], &[]).expect("a system");
        assert_eq!(analyse(&system, &Options::default()).expect("analysed").rank(), 2);
    }
}
