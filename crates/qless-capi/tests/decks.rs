//! Decks through C: labels, reasons, repairs and cleaned decks are those of Rust.

mod support;

use std::fmt::Write;
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
    let input: String = paths.iter().map(|path| format!("{}\n", path.display())).collect();
    let program = compile("deck", &[]);
    let found = output(&program, &input);
    let expected: String = paths.iter().map(|path| of_path(path)).collect();
    for (k, (found, expected)) in found.lines().zip(expected.lines()).enumerate() {
        assert_eq!(found, expected, "line {k}");
    }
    assert_eq!(found.lines().count(), expected.lines().count());
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

/// What the program prints for a deck. The file that it wrote is the cleaned deck of Rust.
fn of_path(path: &Path) -> String {
    let deck = match read(path) {
        Ok(deck) => deck,
        Err(error) => return format!("error -5 {error}\n"),
    };
    let model = deck.model();
    let left_out = model.left_out().count();
    let status = if left_out > 0 { 2 } else { 0 };
    let mut text = format!("deck {status} {} {left_out}\n", model.equations());
    let (first, rest): (Vec<_>, Vec<_>) = model.warnings().iter().partition(|warning| warning.leaves_out);
    for warning in first.into_iter().chain(rest) {
        writeln!(text, "warning {}: {}", model.place_of(warning), warning.text).expect("memory");
    }
    for case in model.cases() {
        writeln!(text, "case {}", case.name).expect("memory");
        let analysed = |history| analyse(&model.system_at(case, history).expect("a system"), &Options::default());
        let (history, analysis) = model.at_all_times(case, analysed).expect("an analysis");
        let name = history.map(|history| model.histories().nth(history as usize).flatten());
        text += &of_analysis(&analysis, name);
    }
    text + &cleaned(&deck, path, status)
}

fn cleaned(deck: &Deck, path: &Path, status: i32) -> String {
    let written = PathBuf::from(format!("{}.clean", path.display()));
    match clean::clean(deck, &Options::default()) {
        Ok((plan, text)) => {
            assert_eq!(std::fs::read(written).expect("a cleaned deck"), text);
            format!("clean {status} {} {}\n", plan.removed.len(), plan.written.len())
        }
        Err(error) => {
            assert!(!written.exists());
            let number = if matches!(error, clean::CleanError::Conflicting { .. }) { -2 } else { -5 };
            format!("clean {number} {error}\n")
        }
    }
}

fn of_analysis(analysis: &Analysis, history: Option<Option<&str>>) -> String {
    let (system, kinds) = (analysis.system(), analysis.kinds());
    let count = |kind| kinds.iter().filter(|&&k| k == kind).count();
    let mut text = format!("rank {} {} {}\n", analysis.rank(), count(Kind::Redundant), count(Kind::Conflicting));
    for row in 0..kinds.len() {
        text += &format!("equation {}\n", system.equation_label(row));
        text += &reason(0, row, analysis.explain(row).expect("a row"));
    }
    for dof in 0..system.dofs() {
        let place = system.prescribed_place(dof).unwrap_or_default();
        text += &format!("dof {} at {place}\n", system.dof_label(dof));
    }
    for &(dof, value) in analysis.generated() {
        text += &format!("fixed {} {}\n", dof + 1, printed(value));
        text += &reason(1, dof, analysis.explain_fixed(dof).expect("factors"));
    }
    assert_eq!(analysis.confidence().doubt, None, "no deck of the corpus is in doubt");
    let remark = history.map(|name| {
        let values = name.map_or("without an amplitude".to_owned(), |name| format!("of amplitude {name}"));
        format!("amplitudes differ in time: the verdict is that of the prescribed values {values} alone")
    });
    text += &format!("doubt 0 {}\n", remark.unwrap_or_default());
    for repair in analysis.repairs().expect("factors") {
        let rows: Vec<String> = repair.conflicts.iter().map(|row| format!(" {}", row + 1)).collect();
        text += &format!("repair{}\n", rows.concat());
        for way in repair.ways {
            text += &format!("way{}\n", way.iter().map(change).collect::<String>());
        }
    }
    text
}

fn reason(what: usize, index: usize, found: Option<Explanation>) -> String {
    let (members, rhs) = found.map_or((Vec::new(), 0.0), |found| (found.members, found.right_hand_side));
    let member = |member: &Member| match *member {
        Member::Equation { row, coefficient } => format!(" 0:{}:{}", row + 1, printed(coefficient)),
        Member::Prescribed { dof, coefficient, .. } => format!(" 2:{}:{}", dof + 1, printed(coefficient)),
        _ => unreachable!("two kinds of members"),
    };
    format!("reason {what} {} {}{}\n", index + 1, printed(rhs), members.iter().map(member).collect::<String>())
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
