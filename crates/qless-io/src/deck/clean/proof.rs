//! A cleaned deck says what the deck says: read again, in every load case its equations span the same space, with none too many.
//!
//! With `C u = b` of the deck, `C' u = b'` of the new one and the same prescribed values, `rank C = rank C' = rank [C; C']`, and
//! `[C b; C' b']` has no conflict. New DOFs, which carry right-hand sides, are prescribed. Cost: three analyses a case, and one for each of several courses in time.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use qless::{ConstraintSystem, Kind, Options, SystemBuilder, analyse};
use rustc_hash::FxHashMap;

use super::{CleanError, Renamed, faults_in};
use crate::deck::{Deck, Dof, LoadCase, Model, parse};

/// # Errors
/// [`CleanError::Unproven`] where the text says something else, [`CleanError::Deck`] where it cannot be read.
pub fn prove(deck: &Deck, text: &[u8], renamed: &Renamed) -> Result<(), CleanError> {
    let old = &deck.model;
    let mut open = |path: &Path| {
        let known = old.files.iter().position(|file| file == path);
        known.map(|file| deck.texts[file].to_vec()).ok_or(std::io::ErrorKind::NotFound.into())
    };
    let new = parse(deck.solver(), &old.files[0], text.to_vec(), &mut open)?.model;
    if new.cases.len() != old.cases.len() {
        let what = format!("{} load cases instead of {}", new.cases.len(), old.cases.len());
        return Err(CleanError::Unproven { case: "the deck".into(), what });
    }
    for (k, (a, b)) in old.cases.iter().zip(&new.cases).enumerate() {
        let is_same = k > 0 && a.constrains_as(&old.cases[k - 1]) && b.constrains_as(&new.cases[k - 1]);
        if !is_same {
            same(old, a, &new, b, renamed).map_err(|what| CleanError::Unproven { case: a.name.clone(), what })?;
        }
    }
    Ok(())
}

/// Whether two load cases constrain the same; else what differs.
fn same(old: &Model, a: &LoadCase, new: &Model, b: &LoadCase, renamed: &Renamed) -> Result<(), String> {
    let given = same_values(old, a, new, b, renamed)?;
    let both = Both::of(old, new, &given, renamed);
    let rank_of = |systems: &[(&Model, &LoadCase)], course: Option<&str>| {
        let system = both.system(systems, course).map_err(|error| error.to_string())?;
        let analysis = analyse(&system, &Options::default()).map_err(|error| error.to_string())?;
        let conflict = analysis.dependent().iter().find(|dependent| dependent.kind == Kind::Conflicting);
        conflict.map_or(Ok(analysis.rank()), |found| Err(format!("row {} of both conflicts", found.row + 1)))
    };
    let (old_rank, new_rank, rank) =
        (rank_of(&[(old, a)], None)?, rank_of(&[(new, b)], None)?, rank_of(&[(old, a), (new, b)], None)?);
    let names: BTreeSet<&str> = given.values().map(|given| given.course.as_str()).collect();
    for course in names.iter().filter(|_| names.len() > 1) {
        rank_of(&[(old, a), (new, b)], Some(course))?;
    }
    if old_rank != rank || new_rank != rank {
        return Err(format!("ranks {old_rank}, {new_rank} and, together, {rank}"));
    }
    independent(new, b, new_rank)
}

/// Whether a cleaned load case is clean.
fn independent(new: &Model, case: &LoadCase, rank: usize) -> Result<(), String> {
    let count = new.in_force(case).count();
    if count != rank {
        return Err(format!("{} of {count} equations still redundant", count - rank));
    }
    faults_in(new, case).first().map_or(Ok(()), |fault| Err(fault.describe(new)))
}

/// The prescribed values of the new load case: those of the old one, and others of DOFs that only it has.
fn same_values(
    old: &Model,
    a: &LoadCase,
    new: &Model,
    b: &LoadCase,
    renamed: &Renamed,
) -> Result<BTreeMap<Dof, Given>, String> {
    let (before, after) = (given_in(old, a), given_in(new, b));
    if let Some(dof) = renamed.values().find(|dof| after.contains_key(dof)) {
        return Err(format!("{dof} is still prescribed under its old name"));
    }
    let mut after: BTreeMap<_, _> =
        after.into_iter().map(|(dof, given)| (*renamed.get(&dof).unwrap_or(&dof), given)).collect();
    if let Some((dof, _)) = before.iter().find(|(dof, given)| after.get(dof) != Some(given)) {
        return Err(format!("{dof} is not prescribed as before"));
    }
    // What only the new deck has carries something for its equations.
    after.retain(|dof, _| before.contains_key(dof) || new.column(*dof).is_some());
    if let Some(dof) = after.keys().find(|dof| !before.contains_key(dof) && old.column(**dof).is_some()) {
        return Err(format!("{dof} was not prescribed before"));
    }
    Ok(after)
}

/// A prescribed value and the name of its course, which is empty for the standard one.
#[derive(PartialEq)]
struct Given {
    value: f64,
    course: String,
}

fn given_in(model: &Model, case: &LoadCase) -> BTreeMap<Dof, Given> {
    let names: Vec<Option<&str>> = model.courses().collect();
    let course = |k: u32| names.get(k as usize).copied().flatten().unwrap_or_default().to_owned();
    case.prescribed.iter().map(|one| (one.dof, Given { value: one.value, course: course(one.course) })).collect()
}

/// Columns for the DOFs of two models.
struct Both<'a> {
    columns: FxHashMap<Dof, usize>,
    given: &'a BTreeMap<Dof, Given>,
    renamed: &'a Renamed,
}

impl<'a> Both<'a> {
    fn of(old: &Model, new: &Model, given: &'a BTreeMap<Dof, Given>, renamed: &'a Renamed) -> Self {
        let mut columns = FxHashMap::default();
        let named = new.dofs.iter().map(|dof| renamed.get(dof).unwrap_or(dof));
        for &dof in old.dofs.iter().chain(named) {
            let next = columns.len();
            columns.entry(dof).or_insert(next);
        }
        Self { columns, given, renamed }
    }

    fn column(&self, dof: Dof) -> Option<usize> {
        self.columns.get(self.renamed.get(&dof).unwrap_or(&dof)).copied()
    }

    /// The equations in force in some load cases, one below the other, with all values or those of one course.
    fn system(
        &self,
        parts: &[(&Model, &LoadCase)],
        course: Option<&str>,
    ) -> Result<ConstraintSystem, qless::SystemError> {
        let mut builder = SystemBuilder::new(self.columns.len().max(1));
        for &(model, case) in parts {
            for i in model.in_force(case) {
                let equation = model.nth(i);
                let terms = equation.columns.iter().zip(equation.coefficients);
                let term = |(&j, &a): (&u32, &f64)| Some((self.column(model.dofs[j as usize])?, a));
                builder.equation(terms.filter_map(term), equation.rhs);
            }
        }
        for (dof, given) in self.given {
            let value = if course.is_none_or(|course| course == given.course) { given.value } else { 0.0 };
            if let Some(column) = self.column(*dof) {
                builder.prescribe(column, value);
            }
        }
        builder.build()
    }
}
