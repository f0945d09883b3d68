//! Proves that the text of a cleaned deck constrains as the deck does: in every load case, the equations of both decks span the same space,
//! and those of the cleaned deck are independent. Let `C u = b` be the equations of the deck and `C' u = b'` those of the cleaned one.
//!
//! - `rank [C b; C' b'] = rank [C b]` over all DOFs: every solution of the deck solves the cleaned deck.
//! - `rank C' = rank C` without the prescribed DOFs: the converse holds too.
//!
//! The first reading of the numbers takes coefficients that may be rounding errors as zero. If it gives no proof, the second reading takes
//! all coefficients as given. One reading alone must prove both rank equations, so that no mixture of readings hides a difference.
//! Equations of the cleaned deck are scaled to the size of those of the deck: an equation in other units must not pass for a rounding error
//! of its neighbours.
//!
//! Whether the deck has a solution is tested separately, so that rounding of new coefficients cannot decide it. Loads must stay at their
//! DOFs. Cost: five analyses for each load case if the first reading proves it. If the values of a case have several time histories, each
//! takes one more.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use qless::{Analysis, ConstraintSystem, Kind, Noise, Options, SystemBuilder, analyse};
use rustc_hash::FxHashMap;

use super::{CleanError, Renamed};
use crate::deck::faults::faults_in;
use crate::deck::plan::conflicts;
use crate::deck::solver::{Outcome, Profile};
use crate::deck::{Deck, Dof, LoadCase, Model, Solver, Sources, read_model};

/// Proves that a new text of the main file constrains as the deck does.
///
/// # Errors
/// [`CleanError::Unproven`] if the text constrains differently, [`CleanError::Deck`] if it cannot be read.
pub fn prove(deck: &Deck, text: &[u8], renamed: &Renamed) -> Result<(), CleanError> {
    let old = &deck.model;
    let mut open = |path: &Path| {
        let known = old.files.iter().position(|file| file == path);
        known.map(|file| deck.texts[file].to_vec()).ok_or(std::io::ErrorKind::NotFound.into())
    };
    let mut sources = Sources::new(deck.solver(), &old.files[0], text.to_vec(), &mut open);
    let new = read_model(&mut sources, &old.dofs)?;
    if new.cases.len() > old.cases.len() {
        let what = format!("{} load cases instead of {}", new.cases.len(), old.cases.len());
        return Err(CleanError::Unproven { case: "the deck".into(), what });
    }
    for (k, a) in old.cases.iter().enumerate() {
        if conflicts(old, a, &Options::default())? {
            return Err(CleanError::Conflicting { case: a.name.clone() });
        }
        let unproven = |what: String| CleanError::Unproven { case: a.name.clone(), what };
        let b = partner(old, k, &new).ok_or_else(|| unproven("the cleaned deck has no such load case".into()))?;
        let given = same_values(old, a, &new, b, renamed).map_err(unproven)?;
        same_loads(a, b, renamed).map_err(unproven)?;
        let both = SharedColumns::new((old, a), &new, renamed);
        let proved = same_space(&both, a, (&new, b), &given, &Noise::Relative(ROUNDING));
        let proved = proved.or_else(|what| same_space(&both, a, (&new, b), &given, &Noise::None).map_err(|_| what));
        if let Err(what) = proved.and_then(|()| without_faults(&new, b, deck.solver())) {
            return Err(doubt(old, a)?.unwrap_or_else(|| unproven(what)));
        }
    }
    Ok(())
}

/// The error for a load case whose rank depends on numbers that may be rounding errors: then no cleaned deck is certain to be correct.
/// `None` if the rank does not depend on them.
fn doubt(model: &Model, case: &LoadCase) -> Result<Option<CleanError>, CleanError> {
    let system = model.system(case)?;
    let analyse = |noise| analyse(&system, &Options { noise, ..Options::default() });
    let (given, rounded) = (analyse(Noise::Auto)?, analyse(Noise::Relative(ROUNDING))?);
    let terms = given.other_reading().map_or(rounded.noise(), |other| &other.terms);
    if given.rank() == rounded.rank() && !given.confidence().ambiguous && !rounded.confidence().ambiguous {
        return Ok(None);
    }
    let equations: Vec<usize> = model.in_force(case).collect();
    let named = terms.iter().find_map(|term| Some((*equations.get(term.row)?, term)));
    let place = named.map_or_else(|| case.name.clone(), |(i, _)| model.place(model.nth(i).origin));
    let term = named.map(|(_, term)| (model.dof_name(model.dofs[term.dof]), term.coefficient));
    let ranks = (given.rank(), rounded.rank());
    Ok(Some(CleanError::Doubtful { case: case.name.clone(), place, term, ranks }))
}

/// The load case of the cleaned deck that corresponds to load case `k` of the deck. The cleaned deck merges subcases that now constrain
/// alike; the name of the merged case lists all their numbers.
fn partner<'a>(old: &Model, k: usize, new: &'a Model) -> Option<&'a LoadCase> {
    if old.cases.len() == new.cases.len() {
        return new.cases.get(k);
    }
    let numbers = |case: &LoadCase| -> Vec<u32> {
        case.name.split(|c: char| !c.is_ascii_digit()).filter_map(|word| word.parse().ok()).collect()
    };
    let own = numbers(&old.cases[k]);
    new.cases.iter().find(|case| !own.is_empty() && own.iter().all(|number| numbers(case).contains(number)))
}

/// The first reading takes coefficients below this fraction of the largest one of their equation as zero: numbers in decks have about ten
/// digits.
const ROUNDING: f64 = 1e-10;

/// Checks that the equations of two load cases have the same solutions if their numbers are read with this `noise`. The error names the
/// difference.
fn same_space(
    both: &SharedColumns,
    a: &LoadCase,
    (new, b): (&Model, &LoadCase),
    given: &BTreeSet<Dof>,
    noise: &Noise,
) -> Result<(), String> {
    let old = both.old;
    let analyse = |systems: &[(&Model, &LoadCase)], given: &BTreeSet<Dof>| {
        let system = both.system(systems, given).map_err(|error| error.to_string())?;
        analyse(&system, &Options { noise: noise.clone(), ..Options::default() }).map_err(|error| error.to_string())
    };
    let none = BTreeSet::new();
    let (alone, joined) = (analyse(&[(old, a)], &none)?, analyse(&[(old, a), (new, b)], &none)?);
    let conflicts =
        |analysis: &Analysis| analysis.dependent().iter().filter(|one| one.kind == Kind::Conflicting).count();
    if joined.rank() != alone.rank() || conflicts(&joined) != conflicts(&alone) {
        return Err(format!("it constrains more: rank {} instead of {}", joined.rank(), alone.rank()));
    }
    let (before, after) = (analyse(&[(old, a)], given)?.rank(), analyse(&[(new, b)], given)?.rank());
    if before != after {
        return Err(format!("it constrains less: rank {after} instead of {before}"));
    }
    independent(new, b, after, both)
}

/// Checks that the equations of a cleaned load case are independent.
fn independent(new: &Model, case: &LoadCase, rank: usize, both: &SharedColumns) -> Result<(), String> {
    let count = new.in_force(case).filter(|&i| !both.names_one_dof(new, i)).count();
    if count != rank {
        return Err(format!("{} of {count} equations are still redundant", count - rank));
    }
    Ok(())
}

/// Checks that a cleaned load case has no faults but those that the solver accepts.
fn without_faults(new: &Model, case: &LoadCase, solver: Solver) -> Result<(), String> {
    let found = Profile::for_case(solver, new, case).outcomes(faults_in(new, case));
    let refused = found.iter().find(|finding| finding.outcome != Outcome::Accepted);
    refused.map_or(Ok(()), |finding| Err(finding.fault.describe(new)))
}

/// Checks the prescribed values of the new load case, and returns their DOFs. It may prescribe the values of the old load case, and DOFs
/// that only the new deck has.
fn same_values(
    old: &Model,
    a: &LoadCase,
    new: &Model,
    b: &LoadCase,
    renamed: &Renamed,
) -> Result<BTreeSet<Dof>, String> {
    let (before, after) = (values_by_dof(old, a), values_by_dof(new, b));
    if let Some(dof) = renamed.values().find(|dof| after.contains_key(dof)) {
        return Err(format!("{dof} is still prescribed under its old name"));
    }
    let mut after: BTreeMap<_, _> =
        after.into_iter().map(|(dof, given)| (*renamed.get(&dof).unwrap_or(&dof), given)).collect();
    if let Some((dof, _)) = before.iter().find(|(dof, given)| after.get(dof) != Some(given)) {
        return Err(format!("{dof} is not prescribed as before"));
    }
    // A DOF that was not prescribed before matters only if an equation of the new deck names it.
    after.retain(|dof, _| before.contains_key(dof) || new.column(*dof).is_some());
    if let Some(dof) = after.keys().find(|dof| !before.contains_key(dof) && old.column(**dof).is_some()) {
        return Err(format!("{dof} was not prescribed before"));
    }
    Ok(after.into_keys().collect())
}

/// Checks that the same DOFs are loaded as before, each equally often.
fn same_loads(a: &LoadCase, b: &LoadCase, renamed: &Renamed) -> Result<(), String> {
    let sorted = |mut dofs: Vec<Dof>| {
        dofs.sort_unstable();
        dofs
    };
    let before = sorted(a.loads.iter().map(|load| load.dof).collect());
    let after = sorted(b.loads.iter().map(|load| *renamed.get(&load.dof).unwrap_or(&load.dof)).collect());
    if before == after { Ok(()) } else { Err("the loads act on other DOFs".into()) }
}

/// The prescribed values of a load case, each with the name of its time history. The name of the standard history is empty.
fn values_by_dof(model: &Model, case: &LoadCase) -> BTreeMap<Dof, (f64, String)> {
    let names: Vec<Option<&str>> = model.histories().collect();
    let name = |k: u32| names.get(k as usize).copied().flatten().unwrap_or_default().to_owned();
    case.prescribed.iter().map(|one| (one.dof, (one.value, name(one.history)))).collect()
}

/// Columns for the DOFs of two models: a DOF of both models has the same column.
struct SharedColumns<'a> {
    columns: FxHashMap<Dof, usize>,
    renamed: &'a Renamed,
    old: &'a Model,
    /// For each column, the largest absolute coefficient in the old load case that the first reading does not take as zero.
    largest: Vec<f64>,
}

impl<'a> SharedColumns<'a> {
    fn new((old, case): (&'a Model, &LoadCase), new: &Model, renamed: &'a Renamed) -> Self {
        let mut columns = FxHashMap::default();
        let named = new.dofs.iter().map(|dof| renamed.get(dof).unwrap_or(dof));
        for &dof in old.dofs.iter().chain(named) {
            let next = columns.len();
            columns.entry(dof).or_insert(next);
        }
        let mut both = Self { largest: vec![0.0; columns.len()], columns, renamed, old };
        for i in old.in_force(case) {
            let terms = both.terms(old, i);
            let least = ROUNDING * terms.iter().fold(0.0, |most: f64, (_, a)| most.max(a.abs()));
            for (j, a) in terms.into_iter().filter(|(_, a)| a.abs() > least) {
                both.largest[j] = both.largest[j].max(a.abs());
            }
        }
        both
    }

    /// The terms of an equation, with columns of the joint system.
    fn terms(&self, model: &Model, i: usize) -> Vec<(usize, f64)> {
        let equation = model.nth(i);
        let terms = equation.columns.iter().zip(equation.coefficients);
        terms.filter_map(|(&j, &a)| Some((self.column(model.dofs[j as usize])?, a))).collect()
    }

    /// The power of two by which an equation is multiplied. It makes the coefficients of a new equation as large as those of the old deck
    /// in the same columns, and none larger. Otherwise one of two equations would count as a rounding error of the other.
    fn scale(&self, model: &Model, terms: &[(usize, f64)]) -> f64 {
        let ratios =
            terms.iter().filter(|(j, a)| *a != 0.0 && self.largest[*j] > 0.0).map(|(j, a)| self.largest[*j] / a.abs());
        let least = ratios.fold(f64::INFINITY, f64::min);
        let is_new = !std::ptr::eq(model, self.old);
        if is_new && least.is_normal() { least.log2().floor().clamp(-1000.0, 1000.0).exp2() } else { 1.0 }
    }

    fn column(&self, dof: Dof) -> Option<usize> {
        self.columns.get(self.renamed.get(&dof).unwrap_or(&dof)).copied()
    }

    /// Whether an equation only says `u_a = u_b`, where a and b are two names of the same DOF of the original deck.
    fn names_one_dof(&self, new: &Model, i: usize) -> bool {
        let equation = new.nth(i);
        let names: Vec<Dof> = equation.columns.iter().map(|&j| new.dofs[j as usize]).collect();
        let [a, b] = names[..] else { return false };
        a != b && self.column(a) == self.column(b) && equation.coefficients[0] == -equation.coefficients[1]
    }

    /// One system with the equations in force in all these load cases. The DOFs in `given` are prescribed as zero.
    fn system(
        &self,
        parts: &[(&Model, &LoadCase)],
        given: &BTreeSet<Dof>,
    ) -> Result<ConstraintSystem, qless::SystemError> {
        let mut builder = SystemBuilder::new(self.columns.len().max(1));
        for &(model, case) in parts {
            for i in model.in_force(case) {
                let terms = self.terms(model, i);
                let scale = self.scale(model, &terms);
                builder.equation(terms.into_iter().map(|(j, a)| (j, a * scale)), model.nth(i).rhs * scale);
            }
        }
        given.iter().filter_map(|&dof| self.column(dof)).for_each(|column| builder.prescribe(column, 0.0));
        builder.build()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deck::{Format, parse};

    /// Tries to prove that the equations `new` constrain as the equations `old`.
    fn proof(old: &str, new: &str) -> Result<(), CleanError> {
        let mut none = |_: &Path| Err(std::io::ErrorKind::NotFound.into());
        let text = |equations: &str| format!("*EQUATION\n{equations}*BOUNDARY\n9,1\n").into_bytes();
        let deck = parse(Format::Calculix, Path::new("deck.inp"), text(old), &mut none).expect("a deck");
        prove(&deck, &text(new), &Renamed::default())
    }

    #[test]
    fn other_solution_spaces_are_rejected() {
        let tie = "2\n1,1,1.,2,1,-1.\n";
        for (old, new) in [
            (tie, "2\n1,1,1.,2,1,-1.\n2\n3,1,1.,2,1,-1.\n"),
            (tie, "2\n1,1,1.,2,1,-1.00000001\n"),
            (tie, "2\n1,1,1.,3,1,-1.\n"),
            (tie, "2\n1,1,1.,9,1,-1.\n"),
            ("2\n1,1,1.,2,1,-1.\n2\n3,1,1.,2,1,-1.\n", tie),
            // The second equation must not pass for a rounding error of the large coefficients.
            ("2\n1,1,1e12,2,1,-1e12\n", "2\n1,1,1e12,2,1,-1e12\n2\n2,1,1.,1,1,1.\n"),
            ("2\n1,1,1e12,2,1,-1e12\n", "2\n1,1,1e12,2,1,-1e12\n1\n2,1,1.\n"),
            // Nor may a coefficient that counts as zero set the size of an equation.
            ("3\n1,1,1.,2,1,-1.,3,1,1e-11\n2\n2,1,1.,1,1,-1.\n", "2\n1,1,1.,3,1,-1.\n"),
            // If the numbers are read as given, tiny coefficients count.
            ("2\n1,1,1e-30,2,1,-1.\n2\n3,1,1e-30,2,1,-1.\n", "2\n2,1,1.,1,1,-1e-30\n2\n1,1,1.,3,1,-2.\n"),
        ] {
            let error = proof(old, new).expect_err(new);
            assert!(matches!(error, CleanError::Unproven { .. } | CleanError::Doubtful { .. }), "{error}");
        }
    }

    #[test]
    fn rounding_and_scale_are_no_differences() {
        for (old, new) in [
            ("2\n1,1,3.,2,1,-1.\n", "2\n1,1,1.,2,1,-.333333333333333\n"),
            ("2\n1,1,1e12,2,1,-1e12\n", "2\n1,1,1.,2,1,-1.\n"),
            ("2\n1,1,1e-12,2,1,-1e-12\n", "2\n1,1,1.,2,1,-1.\n"),
            ("2\n1,1,1.,2,1,-1.\n", "3\n1,1,1.,2,1,-1.,3,1,1e-17\n"),
            ("2\n1,1,1e-30,2,1,-1.\n2\n3,1,1e-30,2,1,-1.\n", "2\n2,1,1.,1,1,-1e-30\n2\n1,1,1.,3,1,-1.\n"),
        ] {
            proof(old, new).unwrap_or_else(|error| panic!("{old}{new}{error}"));
        }
    }
}
