//! Checks a reduction, and recomputes `[T G g] = C_S^-1 [-C_M -C_p b]` of parts with large residuals from the user's equations, for the
//! slaves that were chosen. C_S, C_M and C_p are the columns of slaves, masters and prescribed DOFs.
//!
//! Presolve and exchanges of slaves can lose digits of T, but the slaves that they chose are still good. With these slaves T is computed
//! again, by sparse LU with a step of refinement.

use std::collections::{BTreeMap, BTreeSet};

use super::residual_check::{self, Residuals};
use super::{Reduction, ReductionError};
use crate::Csr;
use crate::factor::backend::BackendError;
use crate::factor::lu;
use crate::factor::solver::{NOISE, SlaveSolver};
use crate::input::components::Labels;
use crate::input::numbering::LocalSystem;
use crate::input::scale::{Scaling, ldexp};

/// The terms of a reduction that are checked and may be computed again.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum CheckedTerms {
    /// T, G and g.
    All,
    /// Only g: T and G depend on C alone.
    Constants,
}

/// How the reductions of an analysis are checked.
pub(crate) struct CheckRules<'a> {
    pub independent: &'a [bool],
    pub scaling: &'a Scaling,
    pub memory: usize,
}

impl CheckRules<'_> {
    /// The residuals of T and G, and those of g.
    pub fn residuals(&self, local: LocalSystem, reduction: &Reduction, terms: CheckedTerms) -> [Residuals; 2] {
        let Self { independent, scaling, .. } = *self;
        let matrices = || residual_check::residuals_of_matrices(local, reduction, independent, scaling);
        let of_matrices = (terms == CheckedTerms::All).then(matrices).unwrap_or_default();
        [of_matrices, residual_check::residuals_of_g(local, reduction, independent, scaling)]
    }
}

/// Checks the residuals. Parts with large residuals are computed again. Their T and G, and separately their g, are replaced if that reduces
/// the residual: T and G depend on C only, so the residual of g does not decide about them.
pub(crate) fn checked(
    reduction: &mut Reduction,
    local: LocalSystem,
    terms: CheckedTerms,
    rules: &CheckRules,
) -> Result<(), ReductionError> {
    let found = rules.residuals(local, reduction, terms);
    if found.iter().all(|found| found.above.is_empty()) {
        return Ok(());
    }
    let labels = Labels::of(local);
    let before = found.map(|found| worst_by_part(&found, &labels));
    let is_factored = |label: u32| reduction.factored.iter().any(|block| labels.of_row[block.equations[0]] == label);
    let wanted: BTreeSet<u32> = before.iter().flat_map(BTreeMap::keys).copied().filter(|&k| !is_factored(k)).collect();
    let wanted: Vec<u32> = wanted.into_iter().collect();
    let rows = compute(local, reduction, &labels, terms, rules, &wanted);
    let mut tried = reduction.clone();
    replace(&mut tried, &rows, |_| [terms == CheckedTerms::All, true]);
    let after = rules.residuals(local, &tried, terms).map(|found| worst_by_part(&found, &labels));
    drop(tried);
    // A part whose residual did not decrease keeps its rows.
    let part = part_of_slaves(local, reduction, &labels);
    let is_better = |i: usize| [0, 1].map(|k| after[k].get(&part[i]) < before[k].get(&part[i]));
    replace(reduction, &rows, is_better);
    let [matrices, constants] = rules.residuals(local, reduction, terms);
    residual_check::pass(&matrices.worse(constants), reduction)
}

/// For each part with equations in [`Residuals::above`], the largest residual of these equations.
fn worst_by_part(found: &Residuals, labels: &Labels) -> BTreeMap<u32, f64> {
    let mut worst = BTreeMap::new();
    for &(row, residual) in &found.above {
        let most: &mut f64 = worst.entry(labels.of_row[row]).or_default();
        *most = most.max(residual);
    }
    worst
}

/// The part of each slave.
fn part_of_slaves(local: LocalSystem, reduction: &Reduction, labels: &Labels) -> Vec<u32> {
    let mut part = vec![0; reduction.dofs()];
    for (i, &label) in labels.of_row.iter().enumerate() {
        let free = local.row(i).filter(|&(j, _)| local.free()[j]);
        free.for_each(|(j, _)| part[local.numbering.dofs[j] as usize] = label);
    }
    reduction.slaves.iter().map(|&j| part[j]).collect()
}

/// The place of a DOF in the reduction.
#[derive(Clone, Copy)]
enum DofPlace {
    /// Index among the slaves.
    Slave(u32),
    /// Index among the masters.
    Master(u32),
    /// Index among the prescribed DOFs.
    Prescribed(u32),
}

/// Computes the rows of T, G and g of the parts with the labels `wanted` (ascending). A row is None if it was not computed.
fn compute(
    local: LocalSystem,
    reduction: &Reduction,
    labels: &Labels,
    terms: CheckedTerms,
    &CheckRules { independent, scaling, memory }: &CheckRules,
    wanted: &[u32],
) -> Vec<Option<RecomputedRow>> {
    let mut equations = vec![Vec::new(); wanted.len()];
    for i in (0..local.equations()).filter(|&i| independent[i]) {
        if let Ok(place) = wanted.binary_search(&labels.of_row[i]) {
            equations[place].push(i);
        }
    }
    let roles = roles(local, reduction);
    let mut rows = vec![None; reduction.slaves.len()];
    for equations in equations {
        let part = PartToSolve::new(local, &equations, &roles, scaling);
        let Ok(order) = crate::factor::backend::sparse::order(&part.slaves) else { continue };
        let Ok(lu) = lu::factor(&part.slaves, &order, |_| true, memory) else { continue };
        let solver = SlaveSolver::new(&part.slaves, lu);
        let right = if terms == CheckedTerms::All { &part.right } else { &Csr::empty(part.right.cols) };
        let (columns, g) = (solver.solve(right), solver.solve_dense(&part.rhs));
        part.write(&mut rows, &solver, &columns.transposed(), &g);
    }
    rows
}

/// A row of T, a row of G, and an entry of g.
type RecomputedRow = (Vec<(usize, f64)>, Vec<(usize, f64)>, f64);

fn roles(local: LocalSystem, reduction: &Reduction) -> Vec<DofPlace> {
    let dofs = &local.numbering.dofs;
    let role = |&j: &u32| {
        let find = |list: &[usize]| list.binary_search(&(j as usize)).ok().map(|place| place as u32);
        let free =
            || find(&reduction.slaves).map(DofPlace::Slave).or_else(|| find(&reduction.masters).map(DofPlace::Master));
        free().unwrap_or_else(|| DofPlace::Prescribed(find(&reduction.prescribed).unwrap_or_default()))
    };
    dofs.iter().map(role).collect()
}

/// The scaled equations of a part, with their own DOF numbers.
struct PartToSolve {
    /// C_S, the columns of the slaves, by rows; slaves are in the order of `places`.
    slaves: Csr,
    /// `-[C_M C_p]` by columns: masters and prescribed DOFs in the order of `others`.
    right: Csr,
    rhs: Vec<f64>,
    /// Index of each slave in the reduction, and the exponent of its scaling.
    places: Vec<(u32, i32)>,
    /// For each column of `right`, the place of its master or prescribed DOF, and the exponent of its scaling.
    others: Vec<(DofPlace, i32)>,
}

impl PartToSolve {
    fn new(local: LocalSystem, equations: &[usize], roles: &[DofPlace], scaling: &Scaling) -> Self {
        let mut dofs: Vec<u32> = equations.iter().flat_map(|&i| local.parts(i).0).copied().collect();
        dofs.sort_unstable();
        dofs.dedup();
        let mut number = vec![0; roles.len()];
        let (mut places, mut others) = (Vec::new(), Vec::new());
        for &j in &dofs {
            let (role, exponent) = (roles[j as usize], scaling.col(j as usize));
            if let DofPlace::Slave(place) = role {
                number[j as usize] = places.len();
                places.push((place, exponent));
            } else {
                number[j as usize] = others.len();
                others.push((role, exponent));
            }
        }
        let (mut slaves, mut rest) = (Csr::empty(places.len()), Csr::empty(others.len()));
        let is_slave = |j: usize| matches!(roles[j], DofPlace::Slave(_));
        for &i in equations {
            let scaled = |(j, v): (usize, f64)| (number[j], scaling.entry(i, j, v));
            slaves.append(local.row(i).filter(|&(j, _)| is_slave(j)).map(scaled));
            rest.append(local.row(i).filter(|&(j, _)| !is_slave(j)).map(scaled).map(|(j, v)| (j, -v)));
        }
        let rhs = equations.iter().map(|&i| ldexp(local.rhs()[i], scaling.row[i])).collect();
        // Numbers of DOFs do not ascend within rows; transposing twice sorts them.
        Self { slaves: slaves.transposed().transposed(), right: rest.transposed(), rhs, places, others }
    }

    /// Writes the rows of the reduction; row k of `solved` belongs to the k-th slave of the solver.
    fn write(&self, rows: &mut [Option<RecomputedRow>], solver: &SlaveSolver, solved: &Csr, g: &[f64]) {
        for (k, &slave) in solver.slaves().iter().enumerate() {
            let (place, exponent) = self.places[slave as usize];
            let (mut t, mut g_matrix) = (Vec::new(), Vec::new());
            let is_prescribed = |c: usize| matches!(self.others[c].0, DofPlace::Prescribed(_));
            let mut largest = [0.0_f64; 2];
            let entries = solved.row(k).map(|(c, v)| (usize::from(is_prescribed(c)), v.abs()));
            entries.for_each(|(side, v)| largest[side] = largest[side].max(v));
            let is_large = |&(c, v): &(usize, f64)| v.abs() > NOISE * largest[usize::from(is_prescribed(c))];
            for (c, v) in solved.row(k).filter(is_large) {
                let (role, own) = self.others[c];
                let value = ldexp(v, exponent - own);
                match role {
                    DofPlace::Prescribed(column) => g_matrix.push((column as usize, value)),
                    DofPlace::Master(column) | DofPlace::Slave(column) => t.push((column as usize, value)),
                }
            }
            t.sort_unstable_by_key(|&(j, _)| j);
            g_matrix.sort_unstable_by_key(|&(j, _)| j);
            rows[place as usize] = Some((t, g_matrix, ldexp(g[k], exponent)));
        }
    }
}

/// Replaces rows that were computed. For each slave, `is_wanted` says whether to replace its rows of T and G, and whether to replace its
/// entry of g.
fn replace(reduction: &mut Reduction, rows: &[Option<RecomputedRow>], is_wanted: impl Fn(usize) -> [bool; 2]) {
    let mut is_new = false;
    let (mut t, mut g_matrix) = (Csr::empty(reduction.t.cols), Csr::empty(reduction.g_matrix.cols));
    for (i, row) in rows.iter().enumerate() {
        let [matrices, constant] = is_wanted(i);
        match row {
            Some((of_t, of_g, _)) if matrices => {
                t.append(of_t.iter().copied());
                g_matrix.append(of_g.iter().copied());
                is_new = true;
            }
            _ => {
                t.append(reduction.t.row(i));
                g_matrix.append(reduction.g_matrix.row(i));
            }
        }
        row.iter().filter(|_| constant).for_each(|&(_, _, g)| reduction.g[i] = g);
    }
    (reduction.t, reduction.g_matrix) = (t, g_matrix);
    if is_new {
        let growth = largest_entry(&reduction.t);
        reduction.growth = reduction.factored.iter().map(|block| block.growth).fold(growth, f64::max);
    }
}

/// The growth `max |T_ij|`.
pub(super) fn largest_entry(t: &Csr) -> f64 {
    t.val.iter().fold(0.0, |most, v| most.max(v.abs()))
}

impl From<BackendError> for ReductionError {
    fn from(error: BackendError) -> Self {
        Self::Backend(error)
    }
}
