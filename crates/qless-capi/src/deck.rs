//! Decks of CalculiX, Abaqus, Nastran and ANSYS: read, analysed in a load case, cleaned.

use std::ffi::{c_char, c_int};
use std::path::Path;
use std::sync::Arc;

use qless::{Analysis, analyse};
use qless_io::deck::{Deck, LoadCase, Solver, Warning, clean, read_for};
use qless_io::write::{Inputs, OneFile};

use crate::analysis::HeldAnalysis;
use crate::arrays::{IndexBase, set, text, write_text};
use crate::handles::{get, insert, on, qless_analysis, qless_deck, qless_options, remove};
use crate::options;
use crate::status::{CallFailure, INCOMPLETE, OK, guard};

/// A deck, and the index base of its caller.
#[derive(Debug)]
struct HeldDeck {
    deck: Deck,
    base: IndexBase,
}

impl HeldDeck {
    /// `OK`, or `INCOMPLETE` if constraints were left out.
    fn status(&self) -> c_int {
        if self.deck.model().left_out().next().is_some() { INCOMPLETE } else { OK }
    }

    /// The load case with this number. A negative number gives the first load case; it is an error unless all load cases have the same
    /// constraints.
    fn load_case(&self, number: i64) -> Result<&LoadCase, CallFailure> {
        let cases = self.deck.model().cases();
        if number < 0 {
            let same = cases.iter().all(|case| case.constrains_as(&cases[0]));
            let message = "the load cases of the deck constrain differently; give the number of one";
            return if same { Ok(&cases[0]) } else { Err(CallFailure::input(message)) };
        }
        self.nth(cases, number, "load case")
    }

    fn nth<'a, T>(&self, list: &'a [T], number: i64, what: &str) -> Result<&'a T, CallFailure> {
        let found = list.get(self.base.read(number, what)?);
        found.ok_or_else(|| CallFailure::input(format!("{what} {number}: there are {}", list.len())))
    }

    /// Analyses a load case at its end. The prescribed values of one time history alone may conflict, although all values together do not
    /// conflict at the end. Then the result is the analysis of that history, and a remark names it.
    fn analyse(&self, case: &LoadCase, options: &qless::Options) -> Result<HeldAnalysis, CallFailure> {
        let model = self.deck.model();
        let (history, found) = model.at_all_times(case, |history| {
            Ok::<Analysis, CallFailure>(analyse(&model.system_at(case, history)?, options)?)
        })?;
        let mut held = HeldAnalysis::new(found, self.base);
        held.remark = history.map(|history| {
            let name = model.histories().nth(history as usize).flatten();
            let values = name.map_or("without an amplitude".to_owned(), |name| format!("of amplitude {name}"));
            format!("amplitudes differ in time: the verdict is that of the prescribed values {values} alone")
        });
        Ok(held)
    }

    /// The warnings; those about constraints that were left out come first.
    fn warnings(&self) -> Vec<&Warning> {
        let all = self.deck.model().warnings();
        let (mut first, rest): (Vec<_>, Vec<_>) = all.iter().partition(|warning| warning.leaves_out);
        first.extend(rest);
        first
    }
}

/// Reads a deck and the files that it includes.
///
/// # Safety
/// `path` and `solver` are null or zero-terminated texts, and `deck` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_deck_read(
    path: *const c_char,
    solver: *const c_char,
    base: c_int,
    deck: *mut *mut qless_deck,
) -> c_int {
    guard(|| {
        let base = IndexBase::new(base)?;
        // SAFETY: the caller upholds the contract, here and below.
        let path = Path::new(unsafe { text("path", path) }?);
        let solver = if solver.is_null() { None } else { Some(unsafe { text("solver", solver) }?) };
        let solver = solver.map(str::parse::<Solver>).transpose();
        let solver = solver.map_err(|error| CallFailure::input(error.to_string()))?;
        let held = HeldDeck { deck: read_for(path, solver)?, base };
        let status = held.status();
        unsafe { insert("deck", deck, held) }?;
        Ok(status)
    })
}

/// Frees a deck; null is allowed. Analyses made from it stay valid.
#[unsafe(no_mangle)]
pub extern "C" fn qless_deck_free(deck: *mut qless_deck) -> c_int {
    guard(|| remove::<_, HeldDeck>(deck))
}

/// Numbers of equations, load cases and warnings, and of warnings about constraints that were left out.
///
/// # Safety
/// Each pointer may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_deck_counts(
    deck: *const qless_deck,
    equations: *mut i64,
    load_cases: *mut i64,
    warnings: *mut i64,
    left_out: *mut i64,
) -> c_int {
    on(deck, |held: Arc<HeldDeck>| {
        let model = held.deck.model();
        let counts = [
            ("equations", equations, model.equations()),
            ("load_cases", load_cases, model.cases().len()),
            ("warnings", warnings, model.warnings().len()),
            ("left_out", left_out, model.left_out().count()),
        ];
        // SAFETY: the caller upholds the contract.
        counts.into_iter().try_for_each(|(what, place, count)| unsafe { set(what, place, count as i64) })
    })
}

/// The name of a load case, such as "step 1" or "subcase 2".
///
/// # Safety
/// `length` may be written, and `text` has room for `room` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_deck_load_case(
    deck: *const qless_deck,
    load_case: i64,
    text: *mut c_char,
    room: i64,
    length: *mut i64,
) -> c_int {
    on(deck, |held: Arc<HeldDeck>| {
        let case = held.nth(held.deck.model().cases(), load_case, "load case")?;
        // SAFETY: the caller upholds the contract.
        unsafe { write_text(&case.name, text, room, length) }
    })
}

/// A warning with its file and line.
///
/// # Safety
/// As [`qless_deck_load_case`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_deck_warning(
    deck: *const qless_deck,
    warning: i64,
    text: *mut c_char,
    room: i64,
    length: *mut i64,
) -> c_int {
    on(deck, |held: Arc<HeldDeck>| {
        let warning = *held.nth(&held.warnings(), warning, "warning")?;
        let words = format!("{}: {}", held.deck.model().place_of(warning), warning.text);
        // SAFETY: the caller upholds the contract.
        unsafe { write_text(&words, text, room, length) }
    })
}

/// Diagnoses the equations of a load case, at its end and for the prescribed values of each time history alone.
///
/// # Safety
/// `analysis` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_deck_analyse(
    deck: *const qless_deck,
    load_case: i64,
    options: *const qless_options,
    analysis: *mut *mut qless_analysis,
) -> c_int {
    guard(|| {
        let held: Arc<HeldDeck> = get(deck)?;
        let found = held.analyse(held.load_case(load_case)?, &options::of(options)?)?;
        // SAFETY: the caller upholds the contract.
        unsafe { found.hold(analysis) }
    })
}

/// Writes the deck with an equivalent, independent set of constraints.
///
/// # Safety
/// `path` is null or a zero-terminated text; `removed` and `written` are null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_deck_clean(
    deck: *const qless_deck,
    options: *const qless_options,
    path: *const c_char,
    removed: *mut i64,
    written: *mut i64,
) -> c_int {
    guard(|| {
        let held: Arc<HeldDeck> = get(deck)?;
        // SAFETY: the caller upholds the contract, here and below.
        let path = Path::new(unsafe { text("path", path) }?);
        // The output may replace the deck itself, but no file that it includes.
        let included = || Inputs::new(held.deck.model().files().iter().skip(1));
        drop(OneFile::at(path, included())?);
        let (plan, text) = clean::clean(&held.deck, &options::of(options)?)?;
        OneFile::at(path, included())?.write(&text)?;
        for (place, count) in [(removed, plan.removed.len()), (written, plan.written.len())] {
            if !place.is_null() {
                unsafe { set("a count", place, count as i64) }?;
            }
        }
        Ok(held.status())
    })
}
