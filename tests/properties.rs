//! Random systems with exactly known properties, in random order and in random units, on every backend.
//!
//! All coefficients are whole numbers, so the oracle gives the exact rank, consistency and fixed DOFs. Changes of order, of row scale
//! and of units (from 1e-6 to 1e6) must not change them. Seeds are fixed; systems that gave wrong results once are kept as tests.

#[macro_use]
mod support;

mod properties {
    /// The same system in another order, with rows scaled, in other units.
    mod change;
    /// Small systems, sparse or full, of any rank.
    mod dense;
    /// The exact properties of a system.
    mod exact;
    /// Models of known rank.
    mod families;
    /// The checks of an answer.
    mod identities;
    /// Systems near dependence.
    mod near;
}

use proptest::prelude::*;
use proptest::test_runner::{Config, FileFailurePersistence, RngSeed, TestRunner};
use qless::ConstraintSystem;
use qless_scenes::{Scene, Truth};

/// Runs a check on `cases` random values, which are the same each time.
fn hold<S: Strategy>(cases: u32, strategy: &S, check: impl Fn(S::Value)) {
    let config = Config {
        cases,
        rng_seed: RngSeed::Fixed(20_251_120),
        source_file: Some(file!()),
        failure_persistence: Some(Box::new(FileFailurePersistence::WithSource("proptest-regressions"))),
        ..Config::default()
    };
    let run = |value| {
        check(value);
        Ok(())
    };
    if let Err(failure) = TestRunner::new(config).run(strategy, run) {
        panic!("{failure}");
    }
}

/// A scene without a truth.
fn scene(system: ConstraintSystem) -> Scene {
    Scene { system, truth: Truth::default(), nodes: Vec::new(), dofs: Vec::new() }
}
