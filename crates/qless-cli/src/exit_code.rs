//! All exit codes of the program.
//!
//! Two more are set elsewhere: a signal ends the program with 128 plus its number, and clap exits with 2 for bad usage.

/// Conflicting equations, or something that `--deny` names.
pub const REFUSED: u8 = 1;
/// Bad usage or bad input, which the user can correct.
pub const INPUT: u8 = 2;
/// Out of memory, or an output that cannot be written.
pub const RESOURCE: u8 = 3;
/// The input has constraints that were not read.
pub const INCOMPLETE: u8 = 4;

/// The list of exit codes at the end of the help text.
pub const HELP: &str = "\
Exit codes:
  0  no conflict: independent, or redundant but consistent; the solver may still refuse the deck (--deny refused,lost)
  1  conflicting equations, or something that --deny names, even if constraints were left out
  2  bad usage, bad input, or input in an unknown format
  3  out of memory, or the output cannot be written
  4  incomplete: constraints of the deck were left out, so that equations may be missing (with --allow-incomplete: 0)";

/// The exit code of a finished diagnosis: a conflict counts even if something was left out.
pub fn for_diagnosis(is_refused: bool, is_incomplete: bool) -> u8 {
    match (is_refused, is_incomplete) {
        (true, _) => REFUSED,
        (false, true) => INCOMPLETE,
        (false, false) => 0,
    }
}

/// The exit code of several inputs: the worst one.
pub fn worst(codes: impl IntoIterator<Item = u8>) -> u8 {
    const ASCENDING: [u8; 5] = [0, INCOMPLETE, REFUSED, INPUT, RESOURCE];
    codes.into_iter().max_by_key(|code| ASCENDING.iter().position(|known| known == code)).unwrap_or_default()
}
