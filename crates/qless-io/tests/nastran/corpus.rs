//! The Nastran decks below `QLESS_CORPUS` against matrices that others made of them: `rank [A; C] = rank A = rank C`, so the
//! equations span the same space; and the same DOFs are prescribed.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use qless::{ConstraintSystem, Kind, Noise, Options, SystemBuilder, Tolerance, analyse};
use qless_io::deck::clean::{faults, plan, write};
use qless_io::deck::{self, LoadCase, Model};
use qless_io::read_case;
use qless_scenes::corpus::larger;

use super::clean::{assert_same_space, clean};

/// The number or word after `"key": ` in an `expected.json`.
fn known<'a>(expected: &'a str, key: &str) -> Option<&'a str> {
    let rest = expected.split(&format!("\"{key}\": ")).nth(1)?;
    Some(rest.split(['\n', '}']).next()?.trim_end_matches(',').trim_matches('"'))
}

/// The deck that the reference was made of: the file that `source` names.
fn deck_of(case: &Path, expected: &str) -> Option<PathBuf> {
    let source = known(expected, "source")?.split(" @").next()?;
    let path = case.join("deck").join(source.rsplit('/').next()?);
    path.is_file().then_some(path)
}

/// Equations of several systems over one numbering of their DOFs, matched by label; nothing is prescribed.
fn stacked(systems: &[&ConstraintSystem]) -> ConstraintSystem {
    let mut columns = BTreeMap::new();
    for system in systems {
        (0..system.dofs()).for_each(|j| {
            let next = columns.len();
            columns.entry(system.dof_label(j)).or_insert(next);
        });
    }
    let mut builder = SystemBuilder::new(columns.len());
    for system in systems {
        for i in 0..system.equations() {
            let terms: Vec<_> = system.matrix().row(i).map(|(j, v)| (columns[&system.dof_label(j)], v)).collect();
            builder.equation(terms, 0.0);
        }
    }
    builder.build().expect("a system")
}

fn rank(systems: &[&ConstraintSystem]) -> usize {
    // Both have weights of some ten digits, from two programs: small ones agree to fewer.
    let (tolerance, noise) = (Tolerance::Relative(1e-6), Noise::Relative(1e-8));
    let options = Options { presolve: false, tolerance, noise, ..Options::default() };
    analyse(&stacked(systems), &options).expect("an analysis").rank()
}

/// The prescribed DOFs that occur in `system`, by label.
fn prescribed(system: &ConstraintSystem) -> BTreeMap<String, f64> {
    let occurs = |j: usize| (0..system.equations()).any(|i| system.matrix().row(i).any(|(column, _)| column == j));
    let given = system.prescribed().iter().filter(|&&(j, _)| occurs(j));
    given.map(|&(j, value)| (system.dof_label(j), value)).collect()
}

/// What differs between the deck and the reference, if anything.
fn difference(case: &Path, expected: &str, model: &Model, load_case: &LoadCase) -> Result<String, String> {
    let ours = model.system(load_case).map_err(|error| error.to_string())?;
    let theirs = read_case(case, None, None).map_err(|error| error.to_string())?;
    let ranks = [rank(&[&ours, &theirs]), rank(&[&ours]), rank(&[&theirs])];
    let same = |what: &str, found: String, key: &str| match known(expected, key) {
        Some(value) if value != found => Err(format!("{what} {found}, expected {value}")),
        _ => Ok(()),
    };
    if ranks.iter().any(|&rank| rank != ranks[0]) {
        return Err(format!("ranks of both, ours, theirs: {ranks:?}"));
    }
    same("rank", ranks[1].to_string(), "rank")?;
    same("rows", ours.equations().to_string(), "rows")?;
    same("columns", ours.dofs().to_string(), "cols")?;
    same("prescribed DOFs", load_case.prescribed.len().to_string(), "spc_dofs_in_deck")?;
    if prescribed(&ours) != prescribed(&theirs) {
        return Err(format!("prescribed {:?}, expected {:?}", prescribed(&ours), prescribed(&theirs)));
    }
    let analysis = analyse(&ours, &Options::default()).map_err(|error| error.to_string())?;
    same("free rank", analysis.rank().to_string(), "rank_free")?;
    same("conflict", analysis.kinds().contains(&Kind::Conflicting).to_string(), "inconsistent")?;
    let nnz = ours.matrix().nnz();
    Ok(format!(
        "rows {} columns {} ranks {ranks:?} nnz {nnz} of {}",
        ours.equations(),
        ours.dofs(),
        theirs.matrix().nnz()
    ))
}

/// The folders of Nastran cases with their `expected.json` and deck.
fn cases() -> Vec<(PathBuf, String, PathBuf)> {
    let Some(root) = larger() else { return Vec::new() };
    let entries = std::fs::read_dir(root.join("cases")).expect("cases").flatten();
    let is_nastran = |path: &PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("nas_"));
    let mut folders: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(is_nastran).collect();
    folders.sort();
    let with_deck = |case: PathBuf| {
        let expected = std::fs::read_to_string(case.join("expected.json")).expect("expected.json");
        deck_of(&case, &expected).map(|deck| (case, expected, deck))
    };
    folders.into_iter().filter_map(with_deck).collect()
}

fn name(case: &Path) -> String {
    case.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

#[test]
fn decks_span_what_their_references_span() {
    let mut wrong = Vec::new();
    for (case, expected, path) in cases() {
        let start = Instant::now();
        let outcome = deck::read(&path).map_err(|error| error.to_string()).and_then(|deck| {
            let seconds = start.elapsed().as_secs_f64();
            deck.model().warnings().iter().for_each(|warning| println!("    line {}: {}", warning.line, warning.text));
            let text = difference(&case, &expected, deck.model(), &deck.model().cases()[0])?;
            Ok(format!("{text}; read in {seconds:.4} s"))
        });
        println!("{:<28} {}", name(&case), outcome.as_ref().unwrap_or_else(|text| text));
        wrong.extend(outcome.err().map(|text| format!("{}: {text}", name(&case))));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn cleaned_decks_say_the_same_and_need_no_more() {
    for (case, _, path) in cases() {
        let deck = deck::read(&path).unwrap_or_else(|error| panic!("{error}"));
        let plan = plan(&deck, &Options::default()).unwrap_or_else(|error| panic!("{}: {error}", name(&case)));
        println!("{:<28} removed {} written {}", name(&case), plan.removed.len(), plan.written.len());
        let text = write(&deck, &plan).unwrap_or_else(|error| panic!("{}: {error}", name(&case)));
        let mut open = |path: &Path| std::fs::read(path);
        let cleaned = deck::parse(deck.format(), &path, text, &mut open).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(faults(cleaned.model()), [], "{}", name(&case));
        assert_eq!(clean(&cleaned).as_bytes(), cleaned.texts()[0].as_slice(), "{}", name(&case));
        assert_same_space(deck.model(), cleaned.model());
    }
}
