//! The checks of an answer.

use qless::{Analysis, BackendChoice, ConstraintSystem, Csr, Dependent, Kind, Options, SystemBuilder};
use qless_scenes::{Scene, oracle};

use super::change::{Change, Variant, variants};
use super::exact::Exact;
use crate::support::{certificate_error, check_certificates, check_reduction, diagnose, settings};

/// Checks every variant. `solution` is a solution of the original system, if one is known.
pub fn check(backend: BackendChoice, scene: &Scene, change: &Change, solution: Option<&[f64]>) {
    let exact = Exact::of(&scene.system);
    assert!(scene.truth.rank_free.is_none_or(|rank| rank == exact.rank), "the scene's own rank");
    for variant in variants(scene, change) {
        for options in settings(backend) {
            let analysis = diagnose(&variant.system, &options);
            let found = Exact::found(&analysis, &variant.dofs);
            let what = format!("{}, presolve {}, {:?}", variant.name, options.presolve, analysis.confidence());
            assert_eq!(found, exact, "found and exact, {what}");
            check_identities(&variant, &analysis, &options, &what);
            if let Some(u) = solution {
                check_values(&variant, &analysis, u, &what);
            }
        }
    }
}

fn check_identities(variant: &Variant, analysis: &Analysis, options: &Options, what: &str) {
    let system = &variant.system;
    check_certificates(system, analysis);
    let reduction = analysis.reduction().expect("within the gate");
    let residual = analysis.residual(&reduction).expect("its own DOFs");
    assert!(residual <= 1e-12, "residual {residual:e}, {what}");
    // Without presolve the error of QR is relative to the largest right-hand side of the block, in any unit.
    if variant.exact || options.presolve {
        check_reduction(system, analysis, &reduction, 1e-12);
    }
    if !variant.exact {
        return;
    }
    assert!(reduction.growth() <= options.growth, "growth {}, {what}", reduction.growth());
    analysis.dependent().iter().for_each(|dependent| check_dependent(system, analysis, dependent, what));
    for &(dof, _) in analysis.generated() {
        let because = analysis.because_fixed(dof).expect("factored before");
        let error = certificate_error(system, &[(dof, 1.0)], &because);
        assert!(error <= 1e-9, "DOF {dof} is fixed by {because:?} but for {error:e}, {what}");
    }
}

/// In exact arithmetic: the equations of a certificate are independent and imply the row, all of them are needed, and the row
/// conflicts if and only if it contradicts them.
fn check_dependent(system: &ConstraintSystem, analysis: &Analysis, dependent: &Dependent, what: &str) {
    let support: Vec<usize> =
        analysis.because(dependent.row).expect("one of its rows").iter().map(|term| term.row).collect();
    let size = support.len();
    let what = format!("row {} because of {support:?}, {what}", dependent.row);
    let with_row = [&support[..], &[dependent.row]].concat();
    assert_eq!(free_rank(system, &support), size, "independent: {what}");
    assert_eq!(free_rank(system, &with_row), size, "sufficient: {what}");
    for gone in 0..size {
        let mut others = with_row.clone();
        others.remove(gone);
        assert_eq!(free_rank(system, &others), size, "row {} is needed: {what}", support[gone]);
    }
    let kind = if oracle::consistent(&part(system, &with_row)).expect("within reach") {
        Kind::Redundant
    } else {
        Kind::Conflicting
    };
    assert_eq!(dependent.kind, kind, "mismatch {:e}: {what}", dependent.mismatch);
}

/// Generated boundary conditions have the values of the solution.
fn check_values(variant: &Variant, analysis: &Analysis, solution: &[f64], what: &str) {
    let largest = solution.iter().fold(1.0, |a: f64, v| a.max(v.abs()));
    for &(dof, value) in analysis.generated() {
        let (value, known) = (value * variant.units[dof], solution[variant.dofs[dof]]);
        assert!((value - known).abs() <= 1e-9 * largest, "DOF {dof} is {value}, not {known}, {what}");
    }
}

pub fn is_free(system: &ConstraintSystem, dof: usize) -> bool {
    system.prescribed().binary_search_by_key(&dof, |&(j, _)| j).is_err()
}

/// Exact rank of some equations on the free DOFs.
pub fn free_rank(system: &ConstraintSystem, rows: &[usize]) -> usize {
    let mut free = Csr::empty(system.dofs());
    for &i in rows {
        free.push_row(system.matrix().row(i).filter(|&(j, _)| is_free(system, j))).expect("ascending");
    }
    oracle::exact_rank(&free).expect("within reach")
}

/// Some of the equations, with all boundary conditions.
pub fn part(system: &ConstraintSystem, rows: &[usize]) -> ConstraintSystem {
    let mut builder = SystemBuilder::new(system.dofs());
    for &i in rows {
        builder.equation(system.matrix().row(i), system.rhs()[i]);
    }
    system.prescribed().iter().for_each(|&(j, value)| builder.prescribe(j, value));
    builder.build().expect("as valid as the whole")
}
