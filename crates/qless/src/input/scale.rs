//! `C' = D_r C D_c` with powers of two: exact, and it makes every tolerance relative.
//!
//! Rows are always scaled, so that the largest coefficient of a free DOF in each row lies in `[1, 2)`. More is decided for each
//! connected component by itself. Where units mix, that is where more than one column in twenty with two entries or more lies
//! below `2^-10` in all its rows, rows and columns are balanced, the largest number of each being 1 (Ruiz 2001), before the
//! rows get their final scale. Where only some entries are tiny, below `2^-20`, nobody can know whether they are in another unit or stand
//! for zero. Either way, if the rank is in doubt, the analysis is made again the other way, the surer one counts, and the doubt is reported.

use std::collections::HashSet;

use crate::input::components::Labels;
use crate::input::numbering::{Column, Exponents, Local};

/// Exponents of the scaling: `C'_ij = C_ij 2^(row[i] + col[j])`.
#[derive(Clone, Debug)]
pub(crate) struct Scaling {
    pub row: Vec<i32>,
    /// Empty where no column is scaled.
    pub col: Vec<i32>,
}

impl Scaling {
    /// Every entry as it is.
    pub fn none(rows: usize) -> Self {
        Self { row: vec![0; rows], col: Vec::new() }
    }

    pub fn col(&self, j: usize) -> i32 {
        self.col.get(j).copied().unwrap_or(0)
    }

    /// The scaled coefficient.
    pub fn entry(&self, i: usize, j: usize, value: f64) -> f64 {
        ldexp(value, self.row[i] + self.col(j))
    }
}

/// `x 2^k`, exact unless the result leaves the range of doubles.
pub(crate) fn ldexp(x: f64, k: i32) -> f64 {
    let power = |k: i32| f64::from_bits(((k + 1023) as u64) << 52);
    match k {
        -1022..=1023 => x * power(k),
        1024.. => ldexp(x * power(1023), (k - 1023).min(2000)),
        _ => ldexp(x * power(-1022), (k + 1022).max(-2000)),
    }
}

/// `floor(log2 |x|)` for a finite x that is not zero.
pub(crate) fn exponent(x: f64) -> i32 {
    let biased = ((x.to_bits() >> 52) & 0x7ff) as i32;
    if biased == 0 { exponent(x * 2f64.powi(64)) - 64 } else { biased - 1023 }
}

/// How entries of free DOFs lie in the scaled rows of a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Spread {
    /// They are of one size.
    Even,
    /// Some are so small that they may be in another unit or stand for zero.
    SomeTiny,
    /// Whole columns are small: units mix.
    UnitsMix,
}

/// The components of a system in some of which entries are not of one size.
pub(crate) struct Spreads {
    pub labels: Labels,
    /// By component.
    pub of: Vec<Spread>,
}

/// Scales `C` by its free DOFs in each row; a row without any is scaled by its prescribed ones. Says how entries lie where
/// any is small.
pub(crate) fn by_rows(
    system: Local,
    columns: &[Column],
    exponents: &[Exponents],
    uncertain: &HashSet<(u32, u32)>,
) -> (Scaling, Option<Spreads>) {
    let mut rows = Scaling::none(system.equations());
    let smallest = scale_rows(system, exponents, &mut rows);
    let small = smallest < SMALL;
    let spreads = small.then(|| Spreads::new(system, columns, exponents, &rows, (smallest, uncertain)));
    (rows, spreads.flatten())
}

/// Balances rows and columns of some components, by equation, then scales their rows; the others stay as they are.
pub(crate) fn balanced(system: Local, exponents: &[Exponents], plain: &Scaling, which: &[bool]) -> Scaling {
    let mut scaling = Scaling::none(system.equations());
    balance(system, &mut scaling);
    let mut keep = vec![true; system.dofs()];
    for i in (0..system.equations()).filter(|&i| which[i]) {
        system.parts(i).0.iter().for_each(|&j| keep[j as usize] = false);
    }
    scaling.col.iter_mut().zip(keep).filter(|(_, keep)| *keep).for_each(|(col, _)| *col = 0);
    scale_rows(system, exponents, &mut scaling);
    scaling.row.iter_mut().zip(&plain.row).zip(which).filter(|(_, which)| !**which).for_each(|((row, &plain), _)| {
        *row = plain;
    });
    scaling
}

/// Balanced rows and columns, if any free entry is small beside any other; else nothing is scaled.
pub(crate) fn where_needed(system: Local) -> Scaling {
    let mut scaling = Scaling::none(system.equations());
    let spans = (0..system.equations()).filter_map(|i| span(system, &scaling, i));
    let (least, top) = spans.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or((0, 0));
    if least - top >= SMALL {
        return scaling;
    }
    balance(system, &mut scaling);
    for i in 0..system.equations() {
        scaling.row[i] = span(system, &scaling, i).map_or(0, |(_, top)| -top);
    }
    scaling
}

/// Entries below this power of two in their rows are small.
const SMALL: i32 = -10;
/// Entries below this one may be meant as zero.
const TINY: i32 = -20;

/// Where the largest of each row and column is 1, no unit explains an entry below this power of two: it is rounding.
pub(crate) const ROUNDING: i32 = -46;

/// Scales every row; returns the exponent of the smallest free entry relative to its row.
fn scale_rows(system: Local, exponents: &[Exponents], scaling: &mut Scaling) -> i32 {
    let plain = scaling.col.is_empty();
    let all_free = system.prescribed().is_empty();
    let mut smallest = 0;
    for (i, of_row) in exponents.iter().enumerate() {
        let plain =
            plain && of_row.least > 0 && (all_free || system.parts(i).0.iter().all(|&j| system.free()[j as usize]));
        let span = if plain { plain_span(*of_row) } else { span(system, scaling, i) };
        let (least, top) = span.unwrap_or((0, 0));
        scaling.row[i] = -top;
        smallest = smallest.min(least - top);
    }
    smallest
}

/// Smallest and largest exponent of a row's free entries, or of all if none is free.
fn span(system: Local, scaling: &Scaling, i: usize) -> Option<(i32, i32)> {
    let exponent = |(j, v): (usize, f64)| (exponent(v) + scaling.col(j), system.free()[j]);
    let limits = |free: bool| {
        let all = system.row(i).map(exponent).filter(|&(_, is_free)| is_free || !free);
        all.map(|(e, _)| (e, e)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    };
    limits(true).or_else(|| limits(false).map(|(_, top)| (top, top)))
}

/// The same for free entries without scaled columns, none of them subnormal.
fn plain_span(Exponents { least, most }: Exponents) -> Option<(i32, i32)> {
    (least <= most).then(|| (i32::from(least) - 1023, i32::from(most) - 1023))
}

/// How many entries of each column are small in their rows.
fn small_entries(system: Local, exponents: &[Exponents], scaling: &Scaling) -> Vec<u32> {
    let mut small = vec![0; system.dofs()];
    for (i, of_row) in exponents.iter().enumerate() {
        let least = i32::from(of_row.least);
        if least == 0 || least - 1023 + scaling.row[i] < SMALL {
            let entries = free(system, i).filter(|&(_, v)| exponent(v) + scaling.row[i] < SMALL);
            entries.for_each(|(j, _)| small[j] += 1);
        }
    }
    small
}

impl Spreads {
    /// None where all entries are of one size everywhere; only where they are not does anybody need to know the components.
    fn new(
        system: Local,
        columns: &[Column],
        exponents: &[Exponents],
        scaling: &Scaling,
        (smallest, uncertain): (i32, &HashSet<(u32, u32)>),
    ) -> Option<Self> {
        let small = small_entries(system, exponents, scaling);
        let is_small = |j: usize| columns[j].count >= 2 && small[j] == columns[j].count;
        if smallest >= TINY && !(0..system.dofs()).any(is_small) {
            return None;
        }
        let labels = Labels::of(system);
        let mut tallies = vec![Tally::default(); labels.count];
        let mut label = vec![0; system.dofs()];
        for (i, &component) in labels.of_row.iter().enumerate() {
            let tally = &mut tallies[component as usize];
            for (j, v) in free(system, i) {
                label[j] = component;
                if !uncertain.contains(&(i as u32, j as u32)) {
                    tally.smallest = tally.smallest.min(exponent(v) + scaling.row[i]);
                }
            }
        }
        for j in (0..system.dofs()).filter(|&j| system.free()[j] && columns[j].count >= 2) {
            let tally = &mut tallies[label[j] as usize];
            tally.shared += 1;
            tally.small += usize::from(is_small(j));
        }
        let of: Vec<Spread> = tallies.iter().map(Tally::spread).collect();
        of.iter().any(|&spread| spread != Spread::Even).then_some(Self { labels, of })
    }

    /// The equations of the components for which a condition holds.
    pub fn equations(&self, holds: impl Fn(usize) -> bool) -> Vec<bool> {
        let of: Vec<bool> = (0..self.of.len()).map(holds).collect();
        self.labels.of_row.iter().map(|&label| of[label as usize]).collect()
    }
}

/// What is counted of a component.
#[derive(Clone, Default)]
struct Tally {
    /// Smallest exponent of a free entry relative to its row.
    smallest: i32,
    /// Columns with two entries or more, ...
    shared: usize,
    /// ... and those of them that are small in all their rows.
    small: usize,
}

impl Tally {
    fn spread(&self) -> Spread {
        match self.smallest {
            _ if 20 * self.small > self.shared => Spread::UnitsMix,
            TINY.. => Spread::Even,
            _ => Spread::SomeTiny,
        }
    }
}

/// Alternating geometric means of the free part, ten sweeps, then a largest number of 1: the former find the units, the latter
/// what numbers of many sizes in one row made of them.
///
/// A mean over an entry of 1e-159, which is what is left of a zero, would move its row and column by hundreds of powers: entries that no unit
/// explains have no part in it.
fn balance(c: Local, scaling: &mut Scaling) {
    let (mut row, mut col) = (vec![0.0; c.equations()], vec![0.0; c.dofs()]);
    let (of_row, of_col) = equilibrated(c, row.clone(), col.clone());
    let counting = |i: usize| {
        let (of_row, of_col) = (&of_row, &of_col);
        let powers = free(c, i).map(|(j, v)| (j, v.abs().log2()));
        powers.filter(move |&(j, power)| power + of_row[i] + of_col[j] > f64::from(ROUNDING))
    };
    for _ in 0..10 {
        let mut sum = vec![(0.0, 0.0); c.dofs()];
        for i in 0..c.equations() {
            let total: f64 = counting(i).map(|(j, power)| power + col[j]).sum();
            row[i] = -total / (counting(i).count().max(1) as f64);
            counting(i).for_each(|(j, power)| {
                sum[j].0 += power + row[i];
                sum[j].1 += 1.0;
            });
        }
        for (j, &(total, count)) in sum.iter().enumerate().filter(|(_, s)| s.1 > 0.0) {
            col[j] = -total / count;
        }
    }
    scaling.col = equilibrated(c, row, col).1.iter().map(|e| e.round() as i32).collect();
}

/// Sweeps of equilibration; each halves what is missing, in powers of two.
const SWEEPS: usize = 12;

/// Exponents for rows and columns with which the largest free number of each is 1 (Ruiz 2001), from those given.
pub(crate) fn equilibrated(system: Local, mut row: Vec<f64>, mut col: Vec<f64>) -> (Vec<f64>, Vec<f64>) {
    for _ in 0..SWEEPS {
        let mut of_row = vec![f64::NEG_INFINITY; row.len()];
        let mut of_col = vec![f64::NEG_INFINITY; col.len()];
        for i in 0..row.len() {
            for (j, v) in free(system, i) {
                let power = v.abs().log2() + row[i] + col[j];
                (of_row[i], of_col[j]) = (of_row[i].max(power), of_col[j].max(power));
            }
        }
        let halve = |scale: &mut Vec<f64>, most: &[f64]| {
            scale
                .iter_mut()
                .zip(most)
                .filter(|(_, most)| most.is_finite())
                .for_each(|(scale, most)| *scale -= most / 2.0);
        };
        halve(&mut row, &of_row);
        halve(&mut col, &of_col);
    }
    (row, col)
}

pub(crate) fn free(system: Local<'_>, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
    system.row(i).filter(move |&(j, _)| system.free()[j])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ConstraintSystem;
    use crate::input::numbering::Numbering;

    #[test]
    fn powers_of_two_are_exact_over_the_whole_range() {
        assert_eq!(ldexp(3.0, 4), 48.0);
        assert_eq!(ldexp(f64::MIN_POSITIVE, 2000), f64::MIN_POSITIVE * 2f64.powi(1000) * 2f64.powi(1000));
        assert_eq!(ldexp(1.5, -1060), 1.5 * 2f64.powi(-1000) * 2f64.powi(-60));
        assert_eq!((exponent(1.0), exponent(-7.9), exponent(0.25), exponent(5e-324)), (0, 2, -2, -1074));
    }

    #[test]
    fn columns_in_other_units_come_back_to_one_size() {
        let mut triplets = Vec::new();
        for i in 0..30_usize {
            for k in 0..4 {
                let j = (i * 7 + k * 5) % 40;
                let unit = [1e-6, 1.0, 1e6][j % 3];
                triplets.push((i, j, unit * (1.0 + k as f64)));
            }
        }
        let system = ConstraintSystem::from_triplets(30, 40, &triplets, &[0.0; 30], &[]).expect("valid");
        let (numbering, columns, exponents) = Numbering::new(&system);
        let local = numbering.view(&system, system.rhs());
        let (rows, spreads) = by_rows(local, &columns, &exponents, &HashSet::new());
        assert!(spreads.is_some_and(|spreads| spreads.of.iter().all(|&spread| spread == Spread::UnitsMix)));
        let scaling = balanced(local, &exponents, &rows, &[true; 30]);
        for i in 0..30 {
            for (j, v) in local.row(i) {
                let scaled = scaling.entry(i, j, v);
                assert!((0.05..2.0).contains(&scaled), "row {i} DOF {j}: {scaled}");
            }
        }
    }
}
