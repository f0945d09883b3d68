//! The folder with a larger corpus of systems and decks, for tests.

use std::path::PathBuf;

/// The folder that the environment variable `QLESS_CORPUS` names, with `cases/`, `extremes/` and `decks/`. `None` if the variable is
/// `none`; then a message on standard error says that the larger corpus is skipped.
///
/// ```no_run
/// let Some(corpus) = qless_scenes::corpus::larger() else { return };
/// assert!(corpus.join("cases").is_dir());
/// ```
///
/// # Panics
/// If the variable is not set, so that no test skips the corpus by mistake.
pub fn larger() -> Option<PathBuf> {
    let named = std::env::var_os("QLESS_CORPUS");
    let folder = named.expect(
        "QLESS_CORPUS is not set: it names the folder that holds cases/, extremes/ and decks/; set QLESS_CORPUS=none to skip those tests",
    );
    if folder == "none" {
        eprintln!("SKIPPED: the larger corpus (QLESS_CORPUS=none)");
        return None;
    }
    Some(folder.into())
}
