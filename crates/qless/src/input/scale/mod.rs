//! `C' = D_r C D_c` with powers of two: exact, and it makes every tolerance relative.
//!
//! Rows are always scaled, so that the largest coefficient of a free DOF in each row lies in `[1, 2)`. More is decided for each
//! connected component by itself. Where units mix, that is where more than one column in twenty with two entries or more lies
//! below `2^-10` in all its rows, rows and columns are balanced, the largest number of each being 1 (Ruiz 2001), before the
//! rows get their final scale. Where only some entries are that small, nobody can know whether they are in another unit or stand
//! for zero. Either way, if the rank is in doubt, the analysis is made again the other way, the surer one counts, and the doubt is reported.

mod balance;
mod powers;
mod rows;
mod spread;

use std::collections::HashSet;

use super::numbering::{Column, Exponents, LocalSystem};

pub(crate) use balance::{ROUNDING, equilibrated};
pub(crate) use powers::{exponent, ldexp};
pub(crate) use spread::{Spread, Spreads};

/// Entries below this power of two in their rows are small.
const SMALL: i32 = -10;

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

/// Scales `C` by its free DOFs in each row; a row without any is scaled by its prescribed ones. Says how entries lie where
/// any is small.
pub(crate) fn by_rows(
    system: LocalSystem,
    columns: &[Column],
    exponents: &[Exponents],
    uncertain: &HashSet<(u32, u32)>,
) -> (Scaling, Option<Spreads>) {
    let mut rows = Scaling::none(system.equations());
    let smallest = rows::scale(system, exponents, &mut rows);
    let spreads = (smallest < SMALL).then(|| Spreads::new(system, columns, exponents, &rows, uncertain));
    (rows, spreads.flatten())
}

/// Balances rows and columns of some components, by equation, then scales their rows; the others stay as they are.
pub(crate) fn balanced(system: LocalSystem, exponents: &[Exponents], plain: &Scaling, which: &[bool]) -> Scaling {
    let mut scaling = Scaling::none(system.equations());
    balance::balance(system, &mut scaling);
    let mut keep = vec![true; system.dofs()];
    for i in (0..system.equations()).filter(|&i| which[i]) {
        system.parts(i).0.iter().for_each(|&j| keep[j as usize] = false);
    }
    scaling.col.iter_mut().zip(keep).filter(|(_, keep)| *keep).for_each(|(col, _)| *col = 0);
    rows::scale(system, exponents, &mut scaling);
    scaling.row.iter_mut().zip(&plain.row).zip(which).filter(|(_, which)| !**which).for_each(|((row, &plain), _)| {
        *row = plain;
    });
    scaling
}

/// Balanced rows and columns, if any free entry is small beside any other; else nothing is scaled.
pub(crate) fn where_needed(system: LocalSystem) -> Scaling {
    let mut scaling = Scaling::none(system.equations());
    let spans = (0..system.equations()).filter_map(|i| rows::span(system, &scaling, i));
    let (least, top) = spans.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or((0, 0));
    if least - top >= SMALL {
        return scaling;
    }
    balance::balance(system, &mut scaling);
    for i in 0..system.equations() {
        scaling.row[i] = rows::span(system, &scaling, i).map_or(0, |(_, top)| -top);
    }
    scaling
}

pub(crate) fn free(system: LocalSystem<'_>, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
    system.row(i).filter(move |&(j, _)| system.free()[j])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ConstraintSystem;
    use crate::input::numbering::Numbering;

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
