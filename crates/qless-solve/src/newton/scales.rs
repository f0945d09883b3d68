//! Units S of the DOFs and weights D of the equations, which make them comparable, in any unit of length and angle.
//!
//! - `s_j` is the reach of a DOF: how far it moves until a nonlinear c changes by the size of its terms, `1 / max_r (|G_rj| / size_r)`.
//!   Terms of linear rows vanish with u, so that only the ratios of their entries count: a DOF without nonlinear rows gets its reach from
//!   other DOFs of its linear rows, or 1.
//! - With suitable weights E of the columns, the geometric mean of `D_r |G_rj| E_j` over each row and column is one (Curtis and Reid 1972).
//!   Other units change `D_r c_r` by one common factor only. Sizes of terms would not serve: those of `u_0 + |u|^2 / 2` vanish with u, and
//!   so does c.
//!
//! For the reach, an entry of a nonlinear row counts as the size of its terms, known from its rounding, even if they cancel. In each row,
//! the entries of translations of nodes count as the largest of them, and so do those of rotations: otherwise a rod along an axis would
//! give the DOFs across it a longer reach. Prescribed DOFs do not move and have no reach. Units are powers of two, which cause no rounding.

use qless_constraints::{ConstraintSet, Evaluation, Rounding};

use super::parts::Parts;
use crate::common::ENTRY_ROUNDING;

/// Largest number of passes that spread reaches along linear rows, and of passes that balance the weights. A DOF that is more rows away
/// from a DOF with a reach keeps the unit 1. Results stay correct, but numbers are less comparable.
const SWEEPS: usize = 20;

/// Scales at one configuration.
pub struct Scales {
    /// Units S of the DOFs.
    pub units: Vec<f64>,
    /// Weights D of the equations; 0 for an equation whose entries on free DOFs are rounding.
    pub weights: Vec<f64>,
}

/// Sizes of the entries of the constraint Jacobian G.
struct Sizes<'a> {
    evaluation: &'a Evaluation,
    rounding: &'a Rounding,
    parts: &'a Parts,
    /// The kind of each DOF: 0 for unknown meaning, 1 for translations of nodes, 2 for rotations.
    kinds: Vec<usize>,
}

impl Scales {
    pub fn new(set: &ConstraintSet, evaluation: &Evaluation, rounding: &Rounding, parts: &Parts) -> Self {
        let mut kinds: Vec<usize> = (0..set.dofs()).map(|j| usize::from(set.moves_node(j))).collect();
        set.rotations().flatten().for_each(|j| kinds[j] = 2);
        let sizes = Sizes { evaluation, rounding, parts, kinds };
        let mut reaches = sizes.reaches(set);
        sizes.spread(set.linear_rows(), &mut reaches);
        let power = |reach: f64| if reach > 0.0 { reach.log2().round().exp2() } else { 1.0 };
        let range = f64::MIN_POSITIVE..f64::MIN_POSITIVE.recip();
        let usable = |unit: f64| if range.contains(&unit) { unit } else { 1.0 };
        let units: Vec<f64> = reaches.into_iter().map(|reach| usable(power(reach))).collect();
        let weights = sizes.weights();
        Self { units, weights }
    }
}

impl Sizes<'_> {
    /// The entries of row r of G on free DOFs, as `(j, size of G_rj)`.
    fn row(&self, r: usize) -> impl Iterator<Item = (usize, f64)> {
        let own = move || {
            let entries = self.evaluation.g().row(r).zip(self.rounding.of_row(r));
            let free = entries.filter(|((j, _), _)| self.parts.of_dof(*j).is_some());
            free.map(|((j, v), bound)| (j, v.abs().max(bound / ENTRY_ROUNDING)))
        };
        let mut most = [0.0_f64; 3];
        own().for_each(|(j, size)| most[self.kinds[j]] = most[self.kinds[j]].max(size));
        own().map(move |(j, size)| (j, if self.kinds[j] == 0 { size } else { most[self.kinds[j]] }))
    }

    fn weights(&self) -> Vec<f64> {
        let g = self.evaluation.g();
        let real = |r: usize| {
            let entries =
                g.row(r).zip(self.rounding.of_row(r)).filter(|((_, v), bound)| v.is_finite() && v.abs() > **bound);
            let free = entries.filter(|((j, _), _)| self.parts.of_dof(*j).is_some());
            free.map(move |((j, v), _)| (r, j, v.abs().log2()))
        };
        let entries: Vec<(usize, usize, f64)> = (0..g.rows()).flat_map(real).collect();
        let (mut rows, mut columns) = (vec![(0.0, 0.0); g.rows()], vec![(0.0, 0.0); g.cols()]);
        for _ in 0..SWEEPS {
            average(&mut rows, entries.iter().map(|&(r, j, v)| (r, v + columns[j].0)));
            average(&mut columns, entries.iter().map(|&(r, j, v)| (j, v + rows[r].0)));
        }
        rows.iter().map(|&(log, count): &(f64, f64)| if count > 0.0 { log.exp2() } else { 0.0 }).collect()
    }

    fn reaches(&self, set: &ConstraintSet) -> Vec<f64> {
        let mut steepness = vec![0.0_f64; set.dofs()];
        for r in (0..set.equations()).filter(|r| !set.linear_rows().contains(r)) {
            let weight = inverse(self.rounding.c()[r] / f64::EPSILON);
            self.row(r).for_each(|(j, size)| steepness[j] = steepness[j].max(size * weight));
        }
        steepness.into_iter().map(inverse).collect()
    }

    /// Gives a reach to DOFs without one: in each linear row, `|G_rj|` times the reach becomes the largest such product of the row.
    fn spread(&self, rows: std::ops::Range<usize>, reaches: &mut [f64]) {
        for _ in 0..SWEEPS {
            let mut found = false;
            for r in rows.clone() {
                let entries =
                    || self.evaluation.g().row(r).filter(|&(j, v)| v != 0.0 && self.parts.of_dof(j).is_some());
                let most = entries().map(|(j, v)| v.abs() * reaches[j]).fold(0.0, f64::max);
                for (j, v) in entries().filter(|_| most > 0.0) {
                    if reaches[j] == 0.0 {
                        (reaches[j], found) = (most / v.abs(), true);
                    }
                }
            }
            if !found {
                break;
            }
        }
    }
}

/// For each index, the negative mean of the numbers with this index, and how many there are.
fn average(places: &mut [(f64, f64)], numbers: impl Iterator<Item = (usize, f64)>) {
    places.fill((0.0, 0.0));
    numbers.for_each(|(i, v)| places[i] = (places[i].0 - v, places[i].1 + 1.0));
    places.iter_mut().for_each(|(sum, count)| *sum /= count.max(1.0));
}

/// `1 / x`, or 0 if that is not finite.
fn inverse(x: f64) -> f64 {
    let inverse = 1.0 / x;
    if inverse.is_finite() { inverse } else { 0.0 }
}
