//! How ccx inserts equations into each other: wherever a master of one is the slave of another, again and again, until there are none.
//! It stops where that takes the slave of an equation away.

use rustc_hash::FxHashMap;

use crate::deck::Model;

/// Below this ccx takes a coefficient for zero.
const ZERO: f64 = 1e-10;
/// So many insertions at most: where more are needed, nothing is known.
const MOST: usize = 200_000;

/// One equation: its terms, the slave first.
type Row = Vec<(u32, f64)>;

/// Whether equations stay equations of their slaves when inserted into each other; `None` where that takes too long to find out.
pub fn keeps_slaves(model: &Model, equations: &[usize]) -> Option<bool> {
    let row = |&i: &usize| {
        let equation = model.nth(i);
        collected(equation.columns.iter().copied().zip(equation.coefficients.iter().copied()))
    };
    let mut rows: Vec<Row> = equations.iter().map(row).filter(|row| !row.is_empty()).collect();
    let slaves: FxHashMap<u32, usize> = rows.iter().map(|row| row[0].0).zip(0..).collect();
    for _ in 0..MOST / rows.len().max(1) {
        let mut is_done = true;
        for i in 0..rows.len() {
            let master = |&(j, _): &(u32, f64)| slaves.get(&j).copied().filter(|&k| k != i);
            let Some((at, k)) = rows[i].iter().enumerate().skip(1).find_map(|(at, term)| Some((at, master(term)?)))
            else {
                continue;
            };
            rows[i] = inserted(&rows[i], at, &rows[k]);
            is_done = false;
            if rows[i][0].1.abs() < ZERO {
                return Some(false);
            }
        }
        if is_done {
            return Some(true);
        }
    }
    None
}

/// Terms of one DOF in one, in the order met; the first stays, of the others those that are not zero.
fn collected(terms: impl Iterator<Item = (u32, f64)>) -> Row {
    let mut row = Row::new();
    let mut at: FxHashMap<u32, usize> = FxHashMap::default();
    for (j, a) in terms {
        let k = *at.entry(j).or_insert(row.len());
        if k == row.len() {
            row.push((j, a));
        } else {
            row[k].1 += a;
        }
    }
    let mut is_first = true;
    row.retain(|(_, a)| std::mem::take(&mut is_first) || a.abs() >= ZERO);
    row
}

/// A row with the equation of its master at a place inserted there.
fn inserted(row: &Row, at: usize, equation: &Row) -> Row {
    let factor = -row[at].1 / equation[0].1;
    let instead = equation[1..].iter().map(|&(j, a)| (j, factor * a));
    collected(row[..at].iter().copied().chain(instead).chain(row[at + 1..].iter().copied()))
}
