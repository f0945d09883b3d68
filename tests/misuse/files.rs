//! `qless-io`: paths, names, numbers, decks and plans.

use std::path::Path;

use qless::{Csr, Options};
use qless_io::deck::clean::{self, Cases, Combination, Plan, Reason, Removed, Written};
use qless_io::deck::{self, CardName, Deck, Dof, Format, Load, LoadCase, Origin, Prescribed};
use qless_io::write::{Inputs, OneFile, Output, write_indices, write_matrix, write_numbers};
use qless_io::{case_files, matrix_market, read_case, vectors, write_case};

use super::{refused, ring, survives};

const NOWHERE: &str = "/nowhere/at/all";

#[test]
fn paths_that_are_none() {
    for path in ["", NOWHERE, "/", "\0", "a\nb.mtx", "."] {
        let path = Path::new(path);
        refused("a case", || read_case(path, None, None));
        refused("a case", || read_case(path, Some(path), Some(path)));
        refused("a matrix", || matrix_market::read(path));
        refused("b", || vectors::read_rhs(path, usize::MAX));
        refused("prescribed", || vectors::read_prescribed(path, usize::MAX));
        refused("labels", || vectors::read_labels(path, usize::MAX, "row"));
        refused("a deck", || deck::read(path));
    }
    for path in ["", "/", "..", "\0"] {
        let path = Path::new(path);
        refused("a matrix", || write_matrix(path, &Csr::default()));
        refused("numbers", || write_numbers(path, &[]));
        refused("indices", || write_indices(path, &[]));
        refused("bytes", || OneFile::at(path, Inputs::default())?.write(&[]));
    }
}

#[test]
fn names_and_numbers_that_cannot_be_written() {
    let place = tempfile::tempdir().expect("a folder");
    for name in ["", "..", "a/b", "/etc/x", "\0"] {
        let mut output = Output::new(place.path()).expect("a folder");
        let before = std::fs::read_dir(place.path()).expect("there").count();
        survives("a name", || output.numbers(name, &[1.0]).and_then(|()| output.commit())).ok();
        assert!(std::fs::read_dir(place.path()).expect("there").count() <= before, "{name:?}");
    }
    survives("no matrix", || write_matrix(&place.path().join("none.mtx"), &Csr::default())).expect("written");
    survives("a wide one", || write_matrix(&place.path().join("wide.mtx"), &Csr::empty(usize::MAX))).expect("written");
    survives("an index", || write_indices(&place.path().join("last.txt"), &[usize::MAX])).expect("written");
    survives("numbers", || write_numbers(&place.path().join("nan.txt"), &[f64::NAN, f64::INFINITY])).ok();
    let system = ring(3).with_labels(["a\n", "b\r", "\0"].map(str::to_owned).to_vec(), Vec::new()).expect("three");
    survives("labels", || write_case(&place.path().join("case"), &system)).ok();
}

/// A set of files is not written if one of them would replace an input.
#[test]
fn files_that_would_go_over_an_input() {
    let place = tempfile::tempdir().expect("a folder");
    let input = place.path().join("in.txt");
    std::fs::write(&input, "as it was").expect("written");
    let inputs = || Inputs::new([&input, &input]);
    refused("the input", || inputs().check_output(&input));
    for other in ["", NOWHERE, "/", "\0", "a/../b"] {
        survives("another", || inputs().check_output(Path::new(other))).expect("no input");
        survives("none", || Inputs::new([other]).check_output(&input)).expect("no input");
    }
    let mut output = Output::new(place.path()).expect("a folder").protecting(inputs());
    refused("the input", || output.check("in.txt"));
    refused("a file", || output.file("in.txt", |out| out.write_all(b"lost")));
    refused("absent", || output.absent("in.txt"));
    refused("a fault", || output.file("other.txt", |_| Err(std::io::ErrorKind::Other.into())));
    for name in ["", "..", "a/b", "\0"] {
        survives("a name", || (output.check(name).is_ok(), output.absent(name).is_ok()));
    }
    assert!(!survives("at work", qless_io::write::is_at_work));
    drop(output);
    assert_eq!(std::fs::read_to_string(&input).expect("there"), "as it was");
    assert_eq!(std::fs::read_dir(place.path()).expect("there").count(), 1);
}

#[test]
fn what_would_be_read_of_paths_that_are_none() {
    for path in ["", NOWHERE, "/", "\0"] {
        let path = Path::new(path);
        let files = survives("files", || case_files(path, Some(path), Some(path)));
        assert!(files.len() >= 3);
        assert!(!refused("a case", || read_case(path, Some(path), Some(path))).is_resource(), "{path:?}");
    }
}

#[test]
fn sizes_that_a_file_does_not_have() {
    let place = tempfile::tempdir().expect("a folder");
    let path = place.path().join("list.txt");
    std::fs::write(&path, "1 2\n").expect("written");
    for count in [0, 2, usize::MAX] {
        survives("b", || vectors::read_rhs(&path, count)).ok();
        survives("prescribed", || vectors::read_prescribed(&path, count)).ok();
        survives("labels", || vectors::read_labels(&path, count, "row")).ok();
    }
}

fn tied(format: Format, text: &str) -> Deck {
    let mut none = |_: &Path| Err(std::io::ErrorKind::NotFound.into());
    deck::parse(format, Path::new("deck"), text.as_bytes().to_vec(), &mut none).expect("a deck")
}

fn decks() -> [Deck; 3] {
    [
        tied(
            Format::Calculix,
            "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n*EQUATION\n2\n1,1,1.,2,1,-1.\n*EQUATION\n2\n1,1,1.,2,1,-1.\n",
        ),
        tied(Format::Nastran, "BEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nMPC,1,1,1,1.,2,1,-1.\nENDDATA\n"),
        tied(Format::Ansys, "CE,1,0,1,UX,1,2,UX,-1\nCE,2,0,1,UX,1,2,UX,-1\n"),
    ]
}

#[test]
fn what_no_deck_holds() {
    for deck in decks() {
        let model = deck.model();
        let (place, dof) =
            (Origin { card: u32::MAX, line: u32::MAX, lines: u32::MAX }, Dof { node: u32::MAX, component: 255 });
        survives("places", || {
            for i in [model.equations(), usize::MAX] {
                assert!(model.equation(i).is_none() && model.label(i).is_none());
            }
            assert!(model.cards().get(u32::MAX).is_none() && model.column(dof).is_none());
            assert!(model.place(place).contains("line"));
        });
        let foreign = LoadCase {
            name: String::new(),
            prescribed: vec![Prescribed { dof, value: f64::NAN, history: 0, origin: place }],
            clashes: vec![Prescribed { dof, value: 1.0, history: 0, origin: place }],
            loads: vec![Load { dof, origin: place }],
            removed: vec![u32::MAX, 0],
        };
        refused("a value that is none", || model.system(&foreign));
        assert!(survives("cases", || model.cases().iter().all(|case| !case.constrains_as(&foreign))));
        assert!(!foreign.constrains_as(&foreign), "a value that is none is not itself");
        survives("told", || (deck.positions().len(), model.warnings().len()));
        assert_eq!(deck.texts().len(), model.files().len());
        survives("a case", || model.in_force(&foreign).count());
        let written = vec![Written { slave: dof, terms: vec![(dof, f64::NAN)], rhs: f64::INFINITY, cases: Cases::All }];
        for equations in [vec![usize::MAX], vec![0, 0], vec![1, 0], vec![model.equations()]] {
            let removed = |&equation: &usize| Removed { equation, reason: Reason::Connected };
            let plan =
                Plan { removed: equations.iter().map(removed).collect(), written: written.clone(), ..Plan::default() };
            refused("a plan", || clean::write(&deck, &plan));
        }
        let foreign = Combination { equations: vec![(usize::MAX, 1.0)], ..Combination::default() };
        let because = Removed { equation: 0, reason: Reason::Redundant(foreign) };
        refused("a certificate", || clean::write(&deck, &Plan { removed: vec![because], ..Plan::default() }));
        let one = Removed { equation: 0, reason: Reason::Connected };
        survives("what no deck says", || clean::write(&deck, &Plan { removed: vec![one], written, ..Plan::default() }))
            .ok();
        survives("nothing", || clean::write(&deck, &Plan::default())).expect("as it was");
        refused("options", || clean::plan(&deck, &Options { growth: f64::NAN, ..Options::default() }));
        for other in decks() {
            clean::faults(other.model()).iter().for_each(|fault| _ = survives("a fault", || fault.describe(model)));
        }
    }
    survives("a name", || CardName::numbered("", u32::MAX).to_string());
}
