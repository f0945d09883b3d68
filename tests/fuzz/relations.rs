//! A file of named relations.

use qless_io::{ReadError, read_case, write_case};

/// Reads the relations. They must be the same system after writing it as a case and reading that.
pub fn relations(data: &[u8]) {
    let place = tempfile::tempdir().expect("a temporary folder");
    let path = place.path().join("ties.rel");
    std::fs::write(&path, data).expect("written");
    match read_case(&path, None, None) {
        Ok(system) => {
            // A label with a line break is refused with a typed error.
            let copy = place.path().join("copy");
            if write_case(&copy, &system).is_ok() {
                let again = read_case(&copy, None, None).expect("what was written is read");
                assert_eq!((again.matrix(), again.rhs()), (system.matrix(), system.rhs()));
            }
        }
        // Text that is packed or encoded may be damaged.
        Err(ReadError::Io { source, .. }) => assert_ne!(source.kind(), std::io::ErrorKind::NotFound),
        Err(error) => assert!(error.to_string().contains("ties.rel"), "{error}"),
    }
}
