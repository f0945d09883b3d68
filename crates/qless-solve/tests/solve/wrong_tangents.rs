//! A tangent that is not the slope of the forces is named, instead of the load being called too large; a right one never is.

use std::error::Error;

use qless_constraints::ConstraintSet;
use qless_constraints::types::Equal;
use qless_solve::equilibrium::{
    Assembly, Equilibrium, EquilibriumError, EquilibriumOptions, Model, Start, Target, check_tangent, solve,
};

use crate::linkages::Outcome;

/// A chain of springs `f = k d + 100 k d^3 / l^2` between neighbours and to the ground, with a fault in its tangent.
struct Chain {
    unit: [f64; 2],
    /// Factor of all entries.
    factor: f64,
    /// Factor of the entry (2, 3).
    of_one: f64,
    /// Whether the pattern lacks the entry.
    missing: bool,
}

const NODES: usize = 6;

impl Chain {
    fn right(unit: [f64; 2]) -> Self {
        Self { unit, factor: 1.0, of_one: 1.0, missing: false }
    }
}

impl Model for Chain {
    fn dofs(&self) -> usize {
        NODES
    }
    fn pattern(&self, entry: &mut dyn FnMut(usize, usize)) {
        for i in 0..NODES {
            (i.saturating_sub(1)..NODES.min(i + 2))
                .filter(|&j| !(self.missing && (i, j) == (2, 3)))
                .for_each(|j| entry(i, j));
        }
    }
    fn assemble(&mut self, u: &[f64], out: &mut Assembly) -> Result<(), Box<dyn Error + Send + Sync>> {
        let [length, force] = self.unit;
        let mut spring = |i: usize, other: Option<usize>| {
            let d = (u[i] - other.map_or(0.0, |j| u[j])) / length;
            let (f, k) = (force * (d + 100.0 * d * d * d), force / length * (1.0 + 300.0 * d * d));
            let ends = std::iter::once((i, 1.0)).chain(other.map(|j| (j, -1.0)));
            for (a, sign) in ends.clone() {
                out.force(a, sign * f);
                for (b, other) in ends.clone().filter(|&(b, _)| !(self.missing && (a, b) == (2, 3))) {
                    let own = if (a, b) == (2, 3) { self.of_one } else { 1.0 };
                    out.stiffness(a, b, own * self.factor * sign * other * k);
                }
            }
        };
        spring(0, None);
        (1..NODES).for_each(|i| spring(i, Some(i - 1)));
        Ok(())
    }
    fn coordinate(&self, _: usize) -> f64 {
        self.unit[0]
    }
}

fn pulled(model: &mut Chain) -> Outcome<Result<Equilibrium, EquilibriumError>> {
    let mut builder = ConstraintSet::builder(NODES);
    builder.add("tie", Equal::new([4, 5]))?;
    let set = builder.build()?;
    let loads: Vec<f64> = (0..NODES).map(|j| if j == 5 { 20.0 * model.unit[1] } else { 0.0 }).collect();
    let target = Target { loads: &loads, prescribed: &[] };
    let options = EquilibriumOptions { shortest: 0.1, ..EquilibriumOptions::default() };
    Ok(solve(model, &set, &Start::at_rest(&set), &target, &options))
}

const UNITS: [[f64; 2]; 3] = [[1.0, 1.0], [1e-3, 1e4], [1e5, 1e-7]];

/// Tangents that are 0.6, 3 and -1 times the right one: named by an entry with that ratio, unless Newton's method finds the equilibrium anyway.
#[test]
fn scaled_tangents_are_named() -> Outcome {
    for unit in UNITS {
        let truth = pulled(&mut Chain::right(unit))?.map_err(|error| error.to_string())?;
        let mut named = Vec::new();
        for factor in [0.6, 3.0, -1.0, 0.0] {
            match pulled(&mut Chain { factor, ..Chain::right(unit) })? {
                Ok(found) => {
                    let off = found.u.iter().zip(&truth.u).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                    assert!(off < 1e-8 * unit[0], "{factor}: {off:e}");
                }
                Err(EquilibriumError::Tangent { given, difference, .. }) => {
                    assert!((given / difference - factor).abs() < 1e-3, "{factor}: {given:e}, {difference:e}");
                    named.push(factor);
                }
                Err(other) => panic!("{factor}: {other}"),
            }
        }
        assert!([3.0, -1.0].iter().all(|factor| named.contains(factor)), "{unit:?}: {named:?}");
    }
    Ok(())
}

/// One wrong entry, and one that the pattern lacks: the check names its row and column.
#[test]
fn the_entry_that_is_wrong_is_named() -> Outcome {
    for unit in UNITS {
        let at = |k: usize| -> Vec<f64> { (0..NODES).map(|j| unit[0] * 0.1 * ((j * j + k) % 5) as f64).collect() };
        for k in 0..5 {
            check_tangent(&mut Chain::right(unit), &at(k))?;
            for (of_one, missing) in [(0.5, false), (-1.0, false), (1.5, false), (1.0, true)] {
                let mut model = Chain { of_one, missing, ..Chain::right(unit) };
                let found = check_tangent(&mut model, &at(k)).expect_err("it is wrong");
                let EquilibriumError::Tangent { row: 2, column: 3, given, difference, .. } = found else {
                    panic!("{found}")
                };
                let ratio = if missing { 0.0 } else { of_one };
                assert!((given / difference - ratio).abs() < 1e-3, "{given:e}, {difference:e}");
                assert!(found.to_string().contains("K(2, 3)"), "{found}");
            }
        }
    }
    assert!(matches!(check_tangent(&mut Chain::right(UNITS[0]), &[0.0]), Err(EquilibriumError::Size { .. })));
    Ok(())
}

/// A load that no equilibrium carries, by a model with a kink and a right tangent: the tangent is not blamed.
#[test]
fn a_right_tangent_is_not_blamed() -> Outcome {
    struct Plastic(f64);
    impl Model for Plastic {
        fn dofs(&self) -> usize {
            1
        }
        fn pattern(&self, entry: &mut dyn FnMut(usize, usize)) {
            entry(0, 0);
        }
        fn assemble(&mut self, u: &[f64], out: &mut Assembly) -> Result<(), Box<dyn Error + Send + Sync>> {
            let yields = u[0].abs() >= self.0;
            out.force(0, if yields { self.0 * u[0].signum() } else { u[0] });
            out.stiffness(0, 0, if yields { 0.0 } else { 1.0 });
            Ok(())
        }
    }
    let set = ConstraintSet::builder(1).build()?;
    for limit in [1e-6, 1.0, 1e6] {
        let target = Target { loads: &[1.5 * limit], prescribed: &[] };
        let found = solve(&mut Plastic(limit), &set, &Start::at_rest(&set), &target, &EquilibriumOptions::default());
        assert!(found.is_err() && !matches!(found, Err(EquilibriumError::Tangent { .. })), "{found:?}");
        for u in [0.0, 0.3, 1.0, 1.0 + 1e-9, 2.0] {
            check_tangent(&mut Plastic(limit), &[u * limit])?;
        }
    }
    Ok(())
}
