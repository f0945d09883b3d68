//! Reductions satisfy the equations, sigma is that of the kept rows, the rank is that of the SVD, and there is no doubt without reason.

use std::sync::OnceLock;

use qless::{BackendChoice, Options};
use rayon::prelude::*;

use super::checks::{Fault, Law, faults, tolerance};
use super::svd_reference::{Case, Truth};
use super::{random, scenes};
use crate::support::settings;

fn of(case: &Case, backend: BackendChoice) -> Vec<Fault> {
    let truth = Truth::new(&case.base, tolerance(&Options::default()));
    settings(backend).iter().flat_map(|options| faults(case, &truth, options)).collect()
}

/// All scenes, or every `step`-th.
fn of_scenes(step: usize, backend: BackendChoice) -> Vec<Fault> {
    let cases: Vec<Case> = scenes::all().into_iter().step_by(step).collect();
    cases.par_iter().flat_map_iter(|case| of(case, backend)).collect()
}

/// A step that is not a multiple of the number of classes.
fn of_random(step: usize, backend: BackendChoice) -> Vec<Fault> {
    let seeds: Vec<u64> = (0..random::COUNT).step_by(step).collect();
    seeds.par_iter().flat_map_iter(|&seed| of(&random::case(seed), backend)).collect()
}

fn hold(law: Law, all: &[Fault]) {
    let faults: Vec<&str> = all.iter().filter(|fault| fault.0 == law).map(|fault| fault.1.as_str()).collect();
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

/// The default backend on all systems, evaluated once.
fn scene(law: Law) {
    static ALL: OnceLock<Vec<Fault>> = OnceLock::new();
    hold(law, ALL.get_or_init(|| of_scenes(1, BackendChoice::Faer)));
}

fn system(law: Law) {
    static ALL: OnceLock<Vec<Fault>> = OnceLock::new();
    hold(law, ALL.get_or_init(|| of_random(1, BackendChoice::Faer)));
}

/// A test of each law.
macro_rules! laws {
    ($module:ident, $check:ident) => {
        mod $module {
            use super::Law;
            #[test]
            fn every_analysis_ends() {
                super::$check(Law::Ends);
            }
            #[test]
            fn a_clear_system_has_a_reduction() {
                super::$check(Law::Gate);
            }
            #[test]
            fn a_reduction_meets_the_equations() {
                super::$check(Law::Residual);
            }
            #[test]
            fn the_rank_is_that_of_the_svd() {
                super::$check(Law::Rank);
            }
            #[test]
            fn no_doubt_where_the_svd_has_none() {
                super::$check(Law::Alarm);
            }
            #[test]
            fn a_conflict_without_doubt_is_one() {
                super::$check(Law::Conflict);
            }
            #[test]
            fn generated_boundary_conditions_follow() {
                super::$check(Law::Generated);
            }
        }
    };
}

laws!(scenes_of_all_families, scene);
laws!(random_systems, system);

/// A tenth of everything on each backend, all laws.
fn a_tenth(backend: BackendChoice) {
    let all = [of_scenes(9, backend), of_random(10, backend)].concat();
    assert!(all.is_empty(), "{} faults:\n{}", all.len(), all.into_iter().map(|f| f.1).collect::<Vec<_>>().join("\n"));
}

on_each_backend!(a_tenth);
