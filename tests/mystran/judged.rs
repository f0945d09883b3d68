//! Compares what qless says of a deck with what MYSTRAN does.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use qless::{Elimination, Options};
use qless_io::deck::clean::clean;
use qless_io::deck::{Deck, Dof, Solver, parse};
use serde_json::Value;

use crate::solver::SolverRun;

/// How the run of a deck ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum DeckEnd {
    /// qless left out a card, an `RBE3` of some rotations, and says so.
    LeftOut,
    Refused,
    Completed,
}

/// What happened to a deck.
#[derive(Debug)]
pub struct DeckOutcome {
    pub end: DeckEnd,
    /// Its equations are redundant or conflict.
    pub is_dependent: bool,
    /// The number of equations that hold in the results.
    pub held: usize,
    /// The number of values other than zero that hold in the results.
    pub enforced: usize,
    /// `clean` changed it, and MYSTRAN completed the new deck.
    pub is_cleaned: bool,
}

pub fn parsed(text: &[u8]) -> Deck {
    let mut none = |_: &Path| Err(std::io::ErrorKind::NotFound.into());
    parse(Solver::Mystran, Path::new("deck.bdf"), text.to_vec(), &mut none).expect("a deck")
}

/// Checks all claims about a deck; `what` is its name in messages.
pub fn judge(program: &Path, text: &str, what: &str) -> DeckOutcome {
    let (said, run) = (checked(text), SolverRun::of(program, text.as_bytes()));
    let refusals = said["deck"]["solver_refuses"].as_array().expect("a list");
    for nothing in ["implied", "lost", "freed", "unsound", "accepted"] {
        assert_eq!(said["solver"][nothing].as_array().map(Vec::len), Some(0), "{what}: {nothing}\n{text}");
    }
    let deck = parsed(text.as_bytes());
    if deck.model().left_out().count() > 0 {
        assert!(!run.completes || refusals.is_empty(), "{what}: {refusals:?}\n{text}");
        return DeckOutcome { end: DeckEnd::LeftOut, is_dependent: false, held: 0, enforced: 0, is_cleaned: false };
    }
    assert_eq!(run.completes, refusals.is_empty(), "{what}: {:?}, but {refusals:?}\n{text}", run.errors());
    let is_dependent = said["status"] != "independent";
    let (mut end, mut held, mut enforced) = (DeckEnd::Refused, 0, 0);
    if run.completes {
        assert!(!is_dependent, "{what}: MYSTRAN completes no deck whose equations are dependent\n{text}");
        end = DeckEnd::Completed;
        (held, enforced) = holds(&deck, &run, &format!("{what}\n{text}"));
    }
    DeckOutcome { end, is_dependent, held, enforced, is_cleaned: is_mended(program, &deck, text, what) }
}

/// The report of `qless check`.
fn checked(text: &str) -> Value {
    let place = tempfile::tempdir().expect("a folder");
    std::fs::write(place.path().join("deck.bdf"), text).expect("written");
    let mut qless = Command::new(env!("CARGO_BIN_EXE_qless"));
    qless.args(["check", "-q", "--format", "json", "--solver", "mystran", "deck.bdf"]).current_dir(place.path());
    let run = qless.output().expect("qless runs");
    let report = serde_json::from_slice(&run.stdout);
    report.unwrap_or_else(|e| panic!("{e}: {}\n{text}", String::from_utf8_lossy(&run.stderr)))
}

/// Whether `clean` changes the deck. MYSTRAN then completes the new deck, and its results satisfy the equations of the old one.
fn is_mended(program: &Path, deck: &Deck, text: &str, what: &str) -> bool {
    let Ok((_, new)) = clean(deck, &Options::default()) else { return false };
    if new == text.as_bytes() {
        return false;
    }
    let new = String::from_utf8(new).expect("text");
    let (said, run) = (checked(&new), SolverRun::of(program, new.as_bytes()));
    let refusals = said["deck"]["solver_refuses"].as_array().expect("a list");
    assert_eq!(run.completes, refusals.is_empty(), "{what}, cleaned: {:?}, but {refusals:?}\n{new}", run.errors());
    let stops_anyway = !deck.model().refusals().is_empty();
    assert!(run.completes || stops_anyway, "{what}: clean leaves a deck at which MYSTRAN stops: {refusals:?}\n{new}");
    if run.completes {
        holds(deck, &run, &format!("{what}, cleaned\n{new}"));
    }
    run.completes
}

/// Results have seven digits.
const PRINTED: f64 = 3e-6;

/// Checks that the results satisfy all equations and values, and that the constraints enforce nothing else. Returns the numbers of equations
/// and of values other than zero.
fn holds(deck: &Deck, run: &SolverRun, what: &str) -> (usize, usize) {
    let (model, u) = (deck.model(), run.displacements());
    let case = &model.cases()[0];
    let mut held = 0;
    for i in model.in_force(case) {
        let equation = model.equation(i).expect("an equation");
        let dofs = equation.columns.iter().map(|&j| model.dofs()[j as usize]);
        let terms: Vec<f64> = dofs.zip(equation.coefficients).map(|(dof, a)| a * u[&dof]).collect();
        let (sum, size) = (terms.iter().sum::<f64>(), terms.iter().map(|x| x.abs()).sum::<f64>());
        let label = model.label(i).unwrap_or_default();
        assert!((sum - equation.rhs).abs() <= PRINTED * size + 1e-9, "{what}: {label} leaves {sum} of {size}");
        held += 1;
    }
    for given in &case.prescribed {
        let error = (u[&given.dof] - given.value).abs();
        assert!(error <= PRINTED * given.value.abs(), "{what}: {} is {}", given.dof, u[&given.dof]);
    }
    enforces_nothing_else(deck, run, what);
    (held, case.prescribed.iter().filter(|given| given.value != 0.0).count())
}

/// Checks that the forces of the constraints do no work on any motion that the equations and the prescribed values allow.
fn enforces_nothing_else(deck: &Deck, run: &SolverRun, what: &str) {
    let (model, forces) = (deck.model(), run.reactions());
    let case = &model.cases()[0];
    let largest = forces.values().fold(0.0_f64, |most, force| most.max(force.abs()));
    let is_known = |dof: &Dof| model.column(*dof).is_some() || case.prescribed.iter().any(|given| given.dof == *dof);
    for (dof, force) in forces.iter().filter(|(dof, _)| !is_known(dof)) {
        assert!(force.abs() <= PRINTED * largest, "{what}: MYSTRAN acts on {dof} with {force}");
    }
    for (dof, work) in works(deck, &forces) {
        assert!(work.abs() <= 30.0 * PRINTED * largest, "{what}: MYSTRAN enforces more at {dof}: {work} of {largest}");
    }
}

/// The work of forces on the motion of each master.
fn works(deck: &Deck, forces: &BTreeMap<Dof, f64>) -> Vec<(Dof, f64)> {
    let model = deck.model();
    let system = model.system(&model.cases()[0]).expect("a system");
    let elimination = Elimination::new(&system, &Options::default()).expect("an elimination");
    let of = |dof: &Dof| forces.get(dof).copied().unwrap_or(0.0);
    let mut all: Vec<f64> = model.dofs().iter().map(of).collect();
    all.resize(elimination.dofs(), 0.0);
    let mut work = vec![0.0; elimination.masters().len()];
    elimination.restrict_into(&all, &mut work).expect("restricted");
    let dofs = elimination.masters().iter().filter_map(|&j| model.dofs().get(j).copied());
    dofs.zip(work).collect()
}
