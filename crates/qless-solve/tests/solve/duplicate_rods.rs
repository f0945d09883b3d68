//! Duplicate rods nearly along an axis, defined from either end: their rows of G differ by rounding of the smallest entries.

use qless_constraints::ConstraintSet;
use qless_constraints::types::{Distance, PlanarPoint};
use qless_solve::equilibrium::{Equilibrium, EquilibriumError, EquilibriumOptions, Start, Target, solve};

use crate::equilibria::Weights;
use crate::linkages::Outcome;

/// A number in [-1, 1].
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64 / (1_u64 << 52) as f64) - 1.0
    }
}

/// A chain of rods, nearly along an axis, after a random motion.
struct Chain {
    points: Vec<PlanarPoint>,
    u: Vec<f64>,
}

impl Chain {
    fn new(random: &mut Random, rods: usize, slope: f64, unit: f64) -> Self {
        let mut place = || [0, 1].map(|_| unit * random.next());
        let (mut before, mut now) = (place(), place());
        let mut chain = Self { points: Vec::new(), u: Vec::new() };
        chain.push(before, now);
        for rod in 0..rods {
            let (length, angle) = (unit * (1.0 + 0.3 * random.next()), 3.0 * random.next());
            let small = slope * (0.75 + 0.25 * random.next());
            let (along, across) = (length * (1.0 - small * small).sqrt(), length * small);
            before = [before[0] + length * angle.cos(), before[1] + length * angle.sin()];
            let by = if rod % 2 == 0 { [along, across] } else { [-across, along] };
            now = [now[0] + by[0], now[1] + by[1]];
            chain.push(before, now);
        }
        chain
    }

    fn push(&mut self, before: [f64; 2], now: [f64; 2]) {
        let first = self.u.len();
        self.points.push(PlanarPoint::new([first, first + 1], before));
        self.u.extend([now[0] - before[0], now[1] - before[1]]);
    }

    /// Every rod, and a duplicate from its other end, longer by a fraction of its length.
    fn set(&self, second: Option<f64>) -> Outcome<ConstraintSet> {
        let mut builder = ConstraintSet::builder(self.u.len());
        for (k, ends) in self.points.windows(2).enumerate() {
            builder.add(format!("rod {k}"), Distance::new(ends[0], ends[1]))?;
            if let Some(longer) = second {
                let length = (0..2).map(|i| ends[1].at[i] - ends[0].at[i]).fold(0.0, f64::hypot) * (1.0 + longer);
                let length = (longer != 0.0).then_some(length);
                builder.add(format!("rod {k} again"), Distance { a: ends[1], b: ends[0], length })?;
            }
        }
        Ok(builder.build()?)
    }

    /// Loads that keep the chain in equilibrium where it is, and the multipliers of its rods there.
    fn loads(&self, random: &mut Random, springs: &[f64], unit: f64) -> Outcome<(Vec<f64>, Vec<f64>)> {
        let set = self.set(None)?;
        let mut evaluation = set.allocate();
        set.evaluate(&self.u, &mut evaluation)?;
        let mut loads: Vec<f64> = self.u.iter().zip(springs).map(|(u, k)| k * u).collect();
        let mut forces = Vec::new();
        for row in 0..set.equations() {
            let most = evaluation.g().row(row).fold(0.0, |most: f64, (_, v)| most.max(v.abs()));
            let force = unit / most * (0.6 + 0.3 * random.next());
            evaluation.g().row(row).for_each(|(j, v)| loads[j] += v * force);
            forces.push(force);
        }
        Ok((loads, forces))
    }
}

/// A chain, its springs and loads, and the multipliers of its rods.
struct Case {
    name: String,
    chain: Chain,
    unit: f64,
    springs: Vec<f64>,
    loads: Vec<f64>,
    forces: Vec<f64>,
}

impl Case {
    fn all() -> impl Iterator<Item = Outcome<Self>> {
        let mut random = Random(7);
        (0..660).map(move |case| Self::new(&mut random, case))
    }

    fn new(random: &mut Random, case: usize) -> Outcome<Self> {
        let (slope, unit) = (0.1_f64.powi(4 + case as i32 % 11), [1e-6, 1.0, 1e6][case / 11 % 3]);
        let rods = if case % 60 == 59 { 60 } else { 1 + case % 4 };
        let name = format!("case {case}: {rods} rods, slope {slope:e}, unit {unit:e}");
        let chain = Chain::new(random, rods, slope, unit);
        let springs: Vec<f64> = chain.u.iter().map(|_| 2.0 + random.next()).collect();
        let (loads, forces) = chain.loads(random, &springs, unit)?;
        Ok(Self { name, chain, unit, springs, loads, forces })
    }

    fn solve(&self, set: &ConstraintSet) -> Result<Equilibrium, EquilibriumError> {
        let start = Start { u: self.chain.u.clone(), ..Start::at_rest(set) };
        let target = Target { loads: &self.loads, prescribed: &[] };
        let options = EquilibriumOptions { stability: true, ..EquilibriumOptions::default() };
        solve(&mut Weights { springs: self.springs.clone() }, set, &start, &target, &options)
    }
}

/// Springs keep a chain in equilibrium with known rod forces: duplicates change nothing, in every unit, at every slope.
#[test]
fn rods_said_twice_carry_the_force_of_one() -> Outcome {
    for case in Case::all() {
        let case = case?;
        let (name, unit) = (&case.name, case.unit);
        let set = case.chain.set(Some(0.0))?;
        let found = case.solve(&set).map_err(|error| format!("{name}: {error}"))?;
        assert_eq!(found.redundant.len(), case.forces.len(), "{name}: {:?}", found.redundant);
        let lambda = found.multipliers.in_rows(&set)?;
        for (pair, force) in lambda.chunks(2).zip(&case.forces) {
            let both = pair[0] + pair[1];
            assert!((both - force).abs() < 1e-9 * force.abs(), "{name}: {both:e} for {force:e}");
        }
        let moved = found.u.iter().zip(&case.chain.u).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        assert!(moved < 1e-9 * unit, "{name}: moved by {moved:e}");
    }
    Ok(())
}

/// If the duplicate is longer, both cannot hold: refused, with the labels of rods.
#[test]
fn rods_of_two_lengths_are_refused_by_name() -> Outcome {
    for (case, longer) in Case::all().zip([1e-9, 1e-6, 1e-3].into_iter().cycle()).step_by(7) {
        let case = case?;
        let refused = case.solve(&case.chain.set(Some(longer))?).err().map(|error| error.to_string());
        assert!(refused.as_ref().is_some_and(|error| error.contains("rod ")), "{}: {refused:?}", case.name);
    }
    Ok(())
}
