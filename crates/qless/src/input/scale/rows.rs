//! Scales each row so that its largest coefficient of a free DOF lies in `[1, 2)`.

use super::Scaling;
use super::powers::exponent;
use crate::input::numbering::{Exponents, LocalSystem};

/// Scales every row; returns the smallest exponent of a free entry relative to the largest exponent of its row.
pub fn scale(system: LocalSystem, exponents: &[Exponents], scaling: &mut Scaling) -> i32 {
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

/// Smallest and largest exponent of a row's free entries. If no entry is free, both are the largest exponent of all entries.
pub fn span(system: LocalSystem, scaling: &Scaling, i: usize) -> Option<(i32, i32)> {
    let exponent = |(j, v): (usize, f64)| (exponent(v) + scaling.col(j), system.free()[j]);
    let limits = |free: bool| {
        let all = system.row(i).map(exponent).filter(|&(_, is_free)| is_free || !free);
        all.map(|(e, _)| (e, e)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    };
    limits(true).or_else(|| limits(false).map(|(_, top)| (top, top)))
}

/// [`span`] from the stored exponents, if no column is scaled, all entries are free and none is subnormal.
fn plain_span(Exponents { least, most }: Exponents) -> Option<(i32, i32)> {
    (least <= most).then(|| (i32::from(least) - 1023, i32::from(most) - 1023))
}
