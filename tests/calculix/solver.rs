//! Runs the real solver, and finds the decks of the corpus.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use qless::{Options, analyse};
use qless_io::deck::clean::{self, CleanError};
use qless_io::deck::{self, Deck};

use crate::known::larger;

/// The folder of decks in the corpus, if there is one.
pub fn decks(part: &str) -> Option<PathBuf> {
    Some(larger()?.join("decks").join(part))
}

/// The `.inp` files of a folder, by name.
pub fn inputs(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut files: Vec<_> = entries.map(|entry| entry.expect("readable").path()).collect();
    files.retain(|path| path.extension().is_some_and(|ending| ending == "inp"));
    files.sort();
    files
}

pub fn stem(path: &Path) -> &str {
    path.file_stem().and_then(|stem| stem.to_str()).expect("a name")
}

/// Whether `ccx` is installed; with the corpus it must be.
pub fn is_there() -> bool {
    let there = Command::new("ccx").arg("-v").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok();
    assert!(there || larger().is_none(), "install calculix-ccx");
    if !there {
        eprintln!("SKIPPED: ccx is not installed: nothing to run");
    }
    there
}

/// Every word that `ccx` prints to its .dat file; `None` if it stops with an error.
pub fn solve(text: &[u8]) -> Option<Vec<String>> {
    run(text).ok()
}

/// Exit code of `ccx` if its equilibrium equations are singular.
pub const SINGULAR: i32 = 255;

/// Every word that `ccx` prints to its .dat file, or its exit code.
pub fn run(text: &[u8]) -> Result<Vec<String>, i32> {
    let place = tempfile::tempdir().expect("a folder");
    std::fs::write(place.path().join("deck.inp"), text).expect("written");
    let mut ccx = Command::new("ccx");
    ccx.args(["-i", "deck"]).current_dir(place.path()).stdout(Stdio::null()).stderr(Stdio::null());
    let status = ccx.env("OMP_NUM_THREADS", "1").status().expect("ccx runs");
    let printed = std::fs::read_to_string(place.path().join("deck.dat")).unwrap_or_default();
    match status.code() {
        Some(0) => Ok(printed.split_whitespace().map(str::to_owned).collect()),
        code => Err(code.unwrap_or(-1)),
    }
}

/// The largest difference of two printouts in units of the largest displacement of a component in a table row; the words that are no numbers
/// must be the same.
pub fn difference(a: &[String], b: &[String]) -> f64 {
    assert_eq!(a.len(), b.len(), "as much is printed");
    let number = |word: &String| word.contains('.').then(|| word.parse::<f64>().ok()).flatten();
    let largest = a.iter().filter_map(number).fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let one = |(a, b): (&String, &String)| match (number(a), number(b)) {
        (Some(x), Some(y)) => (x - y).abs(),
        _ if a == b => 0.0,
        _ => panic!("{a} for {b}"),
    };
    a.iter().zip(b).map(one).fold(0.0, f64::max) / largest.max(f64::MIN_POSITIVE)
}

/// Reads a deck from text.
pub fn parse(text: &[u8]) -> Deck {
    let mut none = |_: &Path| Err(std::io::ErrorKind::NotFound.into());
    deck::parse(deck::Format::Calculix, Path::new("deck.inp"), text.to_vec(), &mut none).expect("a deck")
}

/// The cleaned deck. Checks that it has no faults and that a second cleaning changes nothing.
pub fn cleaned(deck: &Deck) -> Result<Vec<u8>, CleanError> {
    let plan = clean::plan(deck, &Options::default())?;
    let text = clean::write(deck, &plan)?;
    let again = parse(&text);
    assert_eq!(clean::faults(again.model()), []);
    for case in again.model().cases() {
        let system = again.model().system(case).expect("a system");
        let analysis = analyse(&system, &Options::default()).expect("analysed");
        assert_eq!(analysis.rank(), system.equations(), "independent");
    }
    let plan = clean::plan(&again, &Options::default())?;
    assert!(plan.is_empty(), "a second time changes nothing: {plan:?}");
    Ok(text)
}
