//! Compares the version of the loaded library with that of the headers. Bindings of another version read struct fields at wrong offsets.

use core::fmt;

/// A version, `major.minor.patch`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Version {
    /// Increases if the interface changes.
    pub major: i32,
    /// Increases if the layout of structs may change.
    pub minor: i32,
    /// Increases with bug fixes.
    pub patch: i32,
}

/// Version of SuiteSparseQR in the headers. The library has no function that returns its own.
pub const SPQR: Version =
    Version { major: crate::SPQR_MAIN_VERSION, minor: crate::SPQR_SUB_VERSION, patch: crate::SPQR_SUBSUB_VERSION };

/// Version of SuiteSparse in the headers that this crate was built with.
pub const HEADERS: Version = Version {
    major: crate::SUITESPARSE_MAIN_VERSION,
    minor: crate::SUITESPARSE_SUB_VERSION,
    patch: crate::SUITESPARSE_SUBSUB_VERSION,
};

/// The loaded library differs from the headers in `major.minor`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VersionMismatch {
    /// Version of the headers at build time.
    pub headers: Version,
    /// Version of the library at run time.
    pub library: Version,
}

/// Version of the loaded SuiteSparse.
///
/// # Errors
/// [`VersionMismatch`] if `major.minor` differs from [`HEADERS`]; then no other function may be called.
pub fn version() -> Result<Version, VersionMismatch> {
    compatible(HEADERS, loaded())
}

fn loaded() -> Version {
    let mut parts = [0; 3];
    // SAFETY: the function only writes three integers to its argument.
    unsafe { crate::SuiteSparse_version(parts.as_mut_ptr()) };
    Version { major: parts[0], minor: parts[1], patch: parts[2] }
}

fn compatible(headers: Version, library: Version) -> Result<Version, VersionMismatch> {
    let same = (headers.major, headers.minor) == (library.major, library.minor);
    if same { Ok(library) } else { Err(VersionMismatch { headers, library }) }
}

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}.{}", self.major, self.minor, self.patch)
    }
}

impl fmt::Display for VersionMismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { headers, library } = self;
        write!(f, "built for SuiteSparse {headers}, but the library loaded is {library}: rebuild against it")
    }
}

impl core::error::Error for VersionMismatch {}

#[cfg(test)]
mod tests {
    use super::*;

    const BUILT: Version = Version { major: 5, minor: 12, patch: 0 };

    #[test]
    fn a_patch_may_differ() {
        let patched = Version { patch: 3, ..BUILT };
        assert_eq!(compatible(BUILT, patched), Ok(patched));
    }

    #[test]
    fn major_and_minor_must_agree() {
        for library in [Version { minor: 11, ..BUILT }, Version { major: 7, ..BUILT }] {
            let mismatch = compatible(BUILT, library).unwrap_err();
            assert_eq!(mismatch, VersionMismatch { headers: BUILT, library });
            assert!(mismatch.to_string().contains(&library.to_string()));
        }
    }
}
