//! Decks through C: labels, reasons, repairs and cleaned decks are those of Rust.

mod support;

use std::path::{Path, PathBuf};

use qless::explanation::{Change, Explanation, Member, Number};
use qless::{Analysis, Kind, Options, analyse};
use qless_io::deck::{Deck, clean, read};
use support::{compile, output, valgrind};

/// The decks of the corpus, an ANSYS deck with a constraint that is left out, and one that is malformed, in a folder of their own.
fn decks() -> (tempfile::TempDir, Vec<PathBuf>) {
    let place = tempfile::tempdir().expect("a folder");
    let corpus = Path::new(support::DECK).parent().expect("a folder");
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(corpus).expect("the corpus").flatten() {
        if entry.path().extension().is_some_and(|ending| ending != "csv") {
            let path = place.path().join(entry.file_name());
            std::fs::copy(entry.path(), &path).expect("a copy");
            paths.push(path);
        }
    }
    for (name, text) in [
        ("left_out.bdf", "CEND\nBEGIN BULK\nGRID,1\nGRID,2,,1.\nRBE2,8,1,123456,2\nRSPLINE,9,.1,1,2\nENDDATA\n"),
        ("malformed.inp", "*NODE\n1,0.,0.,0.\n*EQUATION\n2\n1,1,1.,2,x,-1.\n"),
        (
            "steps.inp",
            "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n*EQUATION\n2\n1,1,1.,2,1,-1.\n*STEP\n*STATIC\n*BOUNDARY\n1,1,1,2.\n*END STEP\n\
                       *STEP\n*STATIC\n*BOUNDARY\n2,1,1,3.\n*END STEP\n",
        ),
        (
            "times.inp",
            "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n*EQUATION\n2\n1,1,1.,2,1,-1.\n*AMPLITUDE,NAME=A\n0.,0.,0.5,1.,1.,1.\n*STEP\n*STATIC\n\
                       *BOUNDARY\n1,1,1,2.\n*BOUNDARY,AMPLITUDE=A\n2,1,1,2.\n*END STEP\n",
        ),
    ] {
        let path = place.path().join(name);
        std::fs::write(&path, text).expect("a file");
        paths.push(path);
    }
    (place, paths)
}

#[test]
fn decks_through_c_are_those_of_rust() {
    let (_place, paths) = decks();
    let input = paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join("\n");
    let program = compile("deck", &[]);
    let found = output(&program, &input);
    let expected: Vec<String> = paths.iter().flat_map(|path| of_path(path)).collect();
    for (k, (found, expected)) in found.lines().zip(&expected).enumerate() {
        assert_eq!(found, expected, "line {k}");
    }
    assert_eq!(found.lines().count(), expected.len());
    for wanted in [
        "deck 2 ",
        "malformed.inp:5: *EQUATION",
        "without an amplitude alone",
        "way 2:",
        "way 0:",
        "case step 2",
        "fixed ",
    ] {
        assert!(found.contains(wanted), "{wanted}");
    }
    valgrind(&program, &input);
}

/// The lines that the program prints for a deck. The file that it wrote is the cleaned deck of Rust.
fn of_path(path: &Path) -> Vec<String> {
    let deck = match read(path) {
        Ok(deck) => deck,
        Err(error) => return vec![format!("error -5 {error}")],
    };
    let model = deck.model();
    let left_out = model.left_out().count();
    let status = if left_out > 0 { 2 } else { 0 };
    let mut lines = vec![format!("deck {status} {} {left_out}", model.equations())];
    let (first, rest): (Vec<_>, Vec<_>) = model.warnings().iter().partition(|warning| warning.leaves_out);
    let warnings = first.into_iter().chain(rest);
    lines.extend(warnings.map(|warning| format!("warning {}: {}", model.place_of(warning), warning.text)));
    for case in model.cases() {
        lines.push(format!("case {}", case.name));
        let analysed = |history| analyse(&model.system_at(case, history).expect("a system"), &Options::default());
        let (history, analysis) = model.at_all_times(case, analysed).expect("an analysis");
        let remark = history.map(|history| {
            let name = model.histories().nth(history as usize).flatten();
            let values = name.map_or("without an amplitude".to_owned(), |name| format!("of amplitude {name}"));
            format!("amplitudes differ in time: the verdict is that of the prescribed values {values} alone")
        });
        lines.extend(of_analysis(&analysis, &remark.unwrap_or_default()));
    }
    lines.push(cleaned(&deck, path, status));
    lines
}

fn cleaned(deck: &Deck, path: &Path, status: i32) -> String {
    let written = PathBuf::from(format!("{}.clean", path.display()));
    match clean::clean(deck, &Options::default()) {
        Ok((plan, text)) => {
            assert_eq!(std::fs::read(written).expect("a cleaned deck"), text);
            format!("clean {status} {} {}", plan.removed.len(), plan.written.len())
        }
        Err(error) => {
            assert!(!written.exists());
            let number = if matches!(error, clean::CleanError::Conflicting { .. }) { -2 } else { -5 };
            format!("clean {number} {error}")
        }
    }
}

fn of_analysis(analysis: &Analysis, remark: &str) -> Vec<String> {
    let (system, kinds) = (analysis.system(), analysis.kinds());
    let count = |kind| kinds.iter().filter(|&&k| k == kind).count();
    let mut lines = vec![format!("rank {} {} {}", analysis.rank(), count(Kind::Redundant), count(Kind::Conflicting))];
    for row in 0..kinds.len() {
        lines.push(format!("equation {}", system.equation_label(row)));
        lines.push(reason(0, row, analysis.explain(row).expect("a row")));
    }
    for dof in 0..system.dofs() {
        let place = system.prescribed_place(dof).unwrap_or_default();
        lines.push(format!("dof {} at {place}", system.dof_label(dof)));
    }
    for &(dof, value) in analysis.generated() {
        lines.push(format!("fixed {} {}", dof + 1, printed(value)));
        lines.push(reason(1, dof, analysis.explain_fixed(dof).expect("factors")));
    }
    assert_eq!(analysis.confidence().doubt, None, "no deck of the corpus is in doubt");
    lines.push(format!("doubt 0 {remark}"));
    for repair in analysis.repairs().expect("factors") {
        let rows: Vec<String> = repair.conflicts.iter().map(|row| format!(" {}", row + 1)).collect();
        lines.push(format!("repair{}", rows.concat()));
        lines.extend(repair.ways.iter().map(|way| format!("way{}", way.iter().map(change).collect::<String>())));
    }
    lines
}

fn reason(what: usize, index: usize, found: Option<Explanation>) -> String {
    let Explanation { members, right_hand_side: rhs, is_irreducible, .. } =
        found.unwrap_or_else(|| Explanation::new(Vec::new(), 0.0, 0.0));
    let member = |member: &Member| match *member {
        Member::Equation { row, coefficient } => format!(" 0:{}:{}", row + 1, printed(coefficient)),
        Member::Prescribed { dof, coefficient, .. } => format!(" 2:{}:{}", dof + 1, printed(coefficient)),
        _ => unreachable!("two kinds of members"),
    };
    let members: String = members.iter().map(member).collect();
    format!("reason {what} {} {} {}{members}", index + 1, printed(rhs), u8::from(is_irreducible))
}

fn change(&Change { number, from, to, .. }: &Change) -> String {
    let (what, index) = match number {
        Number::RightHandSide(row) => (0, row + 1),
        Number::Prescribed(dof) => (2, dof + 1),
        _ => unreachable!("two kinds of numbers"),
    };
    format!(" {what}:{index}:{}:{}", printed(from), printed(to))
}

fn printed(value: f64) -> String {
    format!("{:016x}", value.to_bits())
}
