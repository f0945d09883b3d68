//! Mismatches m_o of conflicts, and changes x_w of numbers w that cure all of them: `m_o + sum_w a_ow x_w = 0`, with effects a_ow.

use std::collections::BTreeMap;

use super::changes::Number;
use super::new_values::MismatchSum;
use crate::common::DisjointSets;

/// Largest number of numbers whose pairs are tried: 300 numbers have 45,000 pairs.
const MOST_PAIRED: usize = 300;
/// A sum of a mismatch and its changes counts as zero if it cancels to this fraction of its terms; mismatches are accurate to more digits.
const EQUAL: f64 = 1e-6;

/// The effects of one number on mismatches, as (o, effect): mismatch `m_o` grows by `effect` times the change of the number.
pub(super) type Effects = Vec<(usize, f64)>;

/// Mismatches to cure, and the numbers that affect them.
#[derive(Default)]
pub(super) struct Observations {
    pub mismatches: Vec<f64>,
    /// The numbers that may be changed.
    pub effects: BTreeMap<Number, Effects>,
    /// The mismatches, each as a sum over all numbers that affect it.
    pub sums: Vec<MismatchSum>,
}

impl Observations {
    /// Adds a mismatch. Of the numbers in its sum, those for which `may_cure` is true may be changed.
    pub fn add(&mut self, sum: MismatchSum, may_cure: impl Fn(&Number) -> bool) {
        let o = self.mismatches.len();
        self.mismatches.push(sum.at(&[]).0);
        for (&number, &(effect, _)) in sum.terms.iter().filter(|term| may_cure(term.0)) {
            self.effects.entry(number).or_default().push((o, effect));
        }
        self.sums.push(sum);
    }

    /// Groups of mismatches that are connected by common numbers.
    pub fn groups(&self) -> Vec<Vec<usize>> {
        let mut sets = DisjointSets::new(self.mismatches.len());
        for effects in self.effects.values() {
            effects.windows(2).for_each(|pair| sets.join(pair[0].0, pair[1].0));
        }
        let (of, count) = sets.numbered();
        let mut groups = vec![Vec::new(); count];
        of.iter().enumerate().for_each(|(o, &group)| groups[group as usize].push(o));
        groups
    }

    pub fn only(&self, group: &[usize]) -> Self {
        let mut some = Self {
            mismatches: group.iter().map(|&o| self.mismatches[o]).collect(),
            sums: group.iter().map(|&o| self.sums[o].clone()).collect(),
            ..Self::default()
        };
        for (&number, effects) in &self.effects {
            let own = |&(o, effect): &(usize, f64)| group.binary_search(&o).ok().map(|at| (at, effect));
            let effects: Effects = effects.iter().filter_map(own).collect();
            if !effects.is_empty() {
                some.effects.insert(number, effects);
            }
        }
        some
    }

    /// All repairs by one number: its change alone cures all mismatches.
    pub fn singles(&self) -> Vec<Vec<(Number, f64)>> {
        let cures = |(&number, effects): (&Number, &Effects)| {
            let change = -self.mismatches[effects[0].0] / effects[0].1;
            let is_cure = effects.len() == self.mismatches.len()
                && effects.iter().all(|&(o, effect)| is_zero(self.mismatches[o], effect * change));
            is_cure.then(|| vec![(number, change)])
        };
        self.effects.iter().filter_map(cures).collect()
    }

    /// Pairs of numbers that cure all mismatches together.
    pub fn pairs(&self) -> Vec<Vec<(Number, f64)>> {
        let all: Vec<(Number, Vec<f64>)> =
            self.effects.iter().map(|(&number, effects)| (number, self.dense(effects))).collect();
        if all.len() > MOST_PAIRED {
            return Vec::new();
        }
        let mut found = Vec::new();
        for (k, (first, a)) in all.iter().enumerate() {
            for (second, c) in &all[k + 1..] {
                if let Some([x, y]) = self.cure_by_two(a, c) {
                    found.push(vec![(*first, x), (*second, y)]);
                }
            }
        }
        found
    }

    fn dense(&self, effects: &Effects) -> Vec<f64> {
        let mut all = vec![0.0; self.mismatches.len()];
        effects.iter().for_each(|&(o, effect)| all[o] = effect);
        all
    }

    /// Changes x and y of two numbers with effects a and c, so that `m + a x + c y = 0` for the mismatches m; None if there are none.
    fn cure_by_two(&self, a: &[f64], c: &[f64]) -> Option<[f64; 2]> {
        let (m, n) = (&self.mismatches, self.mismatches.len());
        if (0..n).any(|o| a[o] == 0.0 && c[o] == 0.0) {
            return None;
        }
        let couples = (0..n).flat_map(|p| (p + 1..n).map(move |q| (p, q)));
        let determinant = |&(p, q): &(usize, usize)| {
            let (one, two) = (a[p] * c[q], a[q] * c[p]);
            (one - two).abs() > EQUAL * (one.abs() + two.abs())
        };
        let (p, q) = couples.into_iter().find(determinant)?;
        let det = a[p] * c[q] - a[q] * c[p];
        let (x, y) = ((m[q] * c[p] - m[p] * c[q]) / det, (m[p] * a[q] - m[q] * a[p]) / det);
        let is_cured =
            |o: usize| (m[o] + a[o] * x + c[o] * y).abs() <= EQUAL * (m[o].abs() + (a[o] * x).abs() + (c[o] * y).abs());
        (0..n).all(is_cured).then_some([x, y])
    }

    /// Changes one number after the other, always the one with the largest [`gain`]. Each change lowers the number of remaining mismatches,
    /// so this ends. No mismatch is left if each one has a number that affects no other mismatch.
    pub fn greedy(&self) -> Vec<(Number, f64)> {
        let mut left = self.mismatches.clone();
        let mut chosen: BTreeMap<Number, f64> = BTreeMap::new();
        while left.iter().any(|&m| m != 0.0) {
            let gains = self.effects.iter();
            let best = gains.filter_map(|(&number, effects)| gain(&left, effects).map(|(gain, x)| (gain, number, x)));
            let Some((_, number, change)) = best.reduce(|a, b| if b.0 > a.0 { b } else { a }) else { break };
            for &(o, effect) in &self.effects[&number] {
                left[o] = if is_zero(left[o], effect * change) { 0.0 } else { left[o] + effect * change };
            }
            *chosen.entry(number).or_default() += change;
        }
        chosen.into_iter().filter(|&(_, change)| change != 0.0).collect()
    }
}

/// The gain of a number, and its change that cures the largest number of mismatches. The gain counts the cured mismatches minus the zero
/// mismatches that the change spoils. None if the gain is not positive.
fn gain(left: &[f64], effects: &Effects) -> Option<(usize, f64)> {
    let spoiled = effects.iter().filter(|&&(o, _)| left[o] == 0.0).count();
    let open: Vec<_> = effects.iter().filter(|&&(o, _)| left[o] != 0.0).collect();
    let cured = |change: f64| open.iter().filter(|&&&(o, effect)| is_zero(left[o], effect * change)).count();
    let changes = open.iter().map(|&&(o, effect)| -left[o] / effect);
    let (count, change) = changes.map(|change| (cured(change), change)).reduce(|a, b| if b.0 > a.0 { b } else { a })?;
    (count > spoiled).then(|| (count - spoiled, change))
}

/// Returns true if a mismatch and a change of it cancel.
fn is_zero(mismatch: f64, change: f64) -> bool {
    (mismatch + change).abs() <= EQUAL * mismatch.abs().max(change.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::random::signed;

    /// Random mismatches, some of them equal; each has a right-hand side of its own, and prescribed values affect several.
    fn observations(seed: u64) -> Observations {
        let draw = |k: u64, most: f64| ((signed(seed, k).abs() - 0.5) * most) as usize;
        let count = 3 + draw(0, 6.0);
        let mismatches = (0..count as u64).map(|o| 1.0 + draw(1 + o, 3.0) as f64).collect();
        let mut effects: BTreeMap<Number, Effects> =
            (0..count).map(|o| (Number::RightHandSide(o), vec![(o, -1.0)])).collect();
        for dof in 0..count {
            let effect = |&o: &usize| (o, [1.0, -1.0, 2.0][draw((100 * dof + o) as u64 + 50, 3.0)]);
            let some = (0..count).filter(|o| draw((1_000 * dof + o) as u64 + 5_000, 2.0) == 0);
            let some: Effects = some.map(|o| effect(&o)).collect();
            if !some.is_empty() {
                effects.insert(Number::Prescribed(dof), some);
            }
        }
        Observations { mismatches, effects, sums: Vec::new() }
    }

    #[test]
    fn greedy_changes_cure_every_mismatch() {
        for seed in 0..5_000 {
            let observed = observations(seed);
            let mut left = observed.mismatches.clone();
            for (number, change) in observed.greedy() {
                observed.effects[&number].iter().for_each(|&(o, effect)| left[o] += effect * change);
            }
            assert!(left.iter().all(|m| m.abs() < 1e-9), "{seed}: {left:?}");
        }
    }
}
