//! `|row_kj - sum_i c_i row_ij| <= 1e-11 / sigma` of the largest part, every DOF in its own unit and every equation in its own size:
//! graded rows and mixed units take nothing from a certificate.

use std::collections::HashMap;

use qless::{Analysis, BackendChoice, ConstraintSystem, Kind, Options};
use qless_scenes::{Rng, Scene};

use super::scenes::definite;
use crate::support::{diagnose, settings};

on_each_backend!(certificates_hold_in_graded_rows_and_mixed_units);

/// Limit relative to the terms, for a smallest singular value of 1.
const PRECISION: f64 = 1e-11;

/// The residual of a certificate, in DOFs of one unit, relative to its largest term.
fn left(system: &ConstraintSystem, units: &[f64], analysis: &Analysis, row: usize) -> f64 {
    let dependent = analysis.dependent().iter().find(|d| d.row == row).expect("listed");
    let mut sums: HashMap<usize, f64> = HashMap::new();
    let mut largest = 0.0_f64;
    let mut add = |row: usize, factor: f64| {
        for (j, v) in system.matrix().row(row) {
            let part = factor * v / units[j];
            *sums.entry(j).or_default() += part;
            largest = largest.max(part.abs());
        }
    };
    add(row, 1.0);
    analysis.because(dependent.row).expect("one of its rows").iter().for_each(|term| add(term.row, -term.coefficient));
    let free = |j: &usize| system.prescribed().binary_search_by_key(j, |p| p.0).is_err();
    sums.iter().filter(|(j, _)| free(j)).fold(0.0, |most: f64, (_, v)| most.max(v.abs())) / largest.max(1e-300)
}

/// The scene itself, with rows scaled by 2^-30 to 2^30, and in addition in units from 1e-6 to 1e6.
fn variants(scene: &Scene, seed: u64) -> Vec<(&'static str, ConstraintSystem, Vec<f64>)> {
    let mut rng = Rng::new(seed);
    let units: Vec<f64> =
        (0..scene.system.dofs()).map(|_| [2f64.powi(-20), 1.0, 2f64.powi(20)][rng.below(3)]).collect();
    let ones = vec![1.0; units.len()];
    let graded = scene.scale_rows(30, seed).expect("in range").0;
    let mixed = graded.scale_dofs(&units).expect("in range");
    vec![
        ("as given", scene.system.clone(), ones.clone()),
        ("graded", graded.system, ones),
        ("mixed", mixed.system, units),
    ]
}

fn certificates_hold_in_graded_rows_and_mixed_units(backend: BackendChoice) {
    let mut checked = 0;
    for (name, scene) in definite() {
        for (change, system, units) in variants(&scene, 11) {
            for options in settings(backend) {
                checked += check(&format!("{name}, {change}"), &system, &units, &options);
            }
        }
    }
    assert!(checked > 1000, "{checked}");
}

/// Checks all certificates; returns their number.
fn check(name: &str, system: &ConstraintSystem, units: &[f64], options: &Options) -> usize {
    let analysis = diagnose(system, options);
    let limit = PRECISION / analysis.confidence().distance;
    for dependent in analysis.dependent() {
        assert_ne!(analysis.kinds()[dependent.row], Kind::Independent);
        let left = left(system, units, &analysis, dependent.row);
        assert!(left <= limit, "{name}, presolve {}: row {} leaves {left:e}", options.presolve, dependent.row);
    }
    analysis.dependent().len()
}
