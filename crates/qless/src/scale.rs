//! `C' = D_r C D_c` with powers of two: exact, and it makes every tolerance relative.
//!
//! Rows are always scaled, so that the largest coefficient of a free DOF in each row lies in `[1, 2)`. Where units mix,
//! that is where more than one column in twenty with two entries or more lies below `2^-10` in all its rows, rows and columns
//! are balanced by geometric means (Curtis and Reid 1972) before the rows get their final scale. Where only some entries are
//! tiny, below `2^-20`, nobody can know whether they are in another unit or stand for zero: if the rank of scaled rows is in
//! doubt, the analysis is made again with balanced columns, the surer one counts, and the doubt is reported.

use crate::local::{Column, Exponents, Local};

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

/// How entries of free DOFs lie in scaled rows.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Spread {
    /// They are of one size.
    Even,
    /// Some are so small that they may be in another unit or stand for zero.
    SomeTiny,
    /// Whole columns are small: units mix.
    UnitsMix,
}

/// Scales `C` by its free DOFs in each row; a row without any is scaled by its prescribed ones.
pub(crate) fn by_rows(system: Local, columns: &[Column], exponents: &[Exponents]) -> (Scaling, Spread) {
    let mut rows = Scaling::none(system.equations());
    let smallest = scale_rows(system, exponents, &mut rows);
    let spread = match smallest {
        SMALL.. => Spread::Even,
        _ if small_columns(system, columns, exponents, &rows) => Spread::UnitsMix,
        TINY.. => Spread::Even,
        _ => Spread::SomeTiny,
    };
    (rows, spread)
}

/// Balances rows and columns, then scales rows.
pub(crate) fn balanced(system: Local, exponents: &[Exponents]) -> Scaling {
    let mut scaling = Scaling::none(system.equations());
    balance(system, &mut scaling);
    scale_rows(system, exponents, &mut scaling);
    scaling
}

/// Entries below this power of two in their rows are small.
const SMALL: i32 = -10;
/// Entries below this one may be meant as zero.
const TINY: i32 = -20;

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

/// Whether more than one in twenty of the columns with two entries or more are small in all their rows.
fn small_columns(system: Local, columns: &[Column], exponents: &[Exponents], scaling: &Scaling) -> bool {
    let is_shared = |j: usize| system.free()[j] && columns[j].count >= 2;
    let shared = (0..system.dofs()).filter(|&j| is_shared(j)).count();
    let is_small = |i: usize, v: f64| exponent(v) + scaling.row[i] < SMALL;
    // Each such column holds two small entries at least: where there are too few, no column needs a look.
    let with_small = |i: &usize| {
        let least = i32::from(exponents[*i].least);
        least == 0 || least - 1023 + scaling.row[*i] < SMALL
    };
    let count = |i: usize| system.parts(i).1.iter().filter(|&&v| is_small(i, v)).count();
    if 10 * (0..system.equations()).filter(with_small).map(count).sum::<usize>() <= shared {
        return false;
    }
    let mut large = vec![false; system.dofs()];
    for i in 0..system.equations() {
        system.row(i).for_each(|(j, v)| large[j] |= !is_small(i, v));
    }
    20 * (0..system.dofs()).filter(|&j| is_shared(j) && !large[j]).count() > shared
}

/// Alternating geometric means of the free part, ten sweeps.
fn balance(c: Local, scaling: &mut Scaling) {
    let mut row = vec![0.0; c.equations()];
    let mut col = vec![0.0; c.dofs()];
    for _ in 0..10 {
        let mut sum = vec![(0.0, 0.0); c.dofs()];
        for i in 0..c.equations() {
            let free = || c.row(i).filter(|&(j, _)| c.free()[j]);
            let total: f64 = free().map(|(j, v)| v.abs().log2() + col[j]).sum();
            row[i] = -total / (free().count().max(1) as f64);
            free().for_each(|(j, v)| {
                sum[j].0 += v.abs().log2() + row[i];
                sum[j].1 += 1.0;
            });
        }
        for (j, &(total, count)) in sum.iter().enumerate().filter(|(_, s)| s.1 > 0.0) {
            col[j] = -total / count;
        }
    }
    scaling.col = col.iter().map(|&e: &f64| e.round() as i32).collect();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ConstraintSystem;
    use crate::local::Numbering;

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
        assert!(by_rows(local, &columns, &exponents).1 == Spread::UnitsMix);
        let scaling = balanced(local, &exponents);
        for i in 0..30 {
            for (j, v) in local.row(i) {
                let scaled = scaling.entry(i, j, v);
                assert!((0.05..2.0).contains(&scaled), "row {i} DOF {j}: {scaled}");
            }
        }
    }
}
