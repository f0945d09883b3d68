//! Inserts equations into one another, as ccx does (`cascade.c`).

use rustc_hash::FxHashMap;

use crate::deck::Model;

/// Coefficients below this count as zero in ccx.
const ZERO: f64 = 1e-10;
/// Largest number of insertions. If more are needed, the result counts as unknown.
const MOST_INSERTIONS: usize = 200_000;

/// The terms of an equation, the slave first.
type TermList = Vec<(u32, f64)>;

/// Whether all equations keep their slaves when ccx inserts them into one another. ccx replaces each master that is the slave of another
/// equation, until no such master remains. It stops with an error if the slave of an equation cancels. `None` if this takes too many
/// insertions.
pub fn keeps_slaves(model: &Model, equations: &[usize]) -> Option<bool> {
    let row = |&i: &usize| {
        let equation = model.nth(i);
        collected(equation.columns.iter().copied().zip(equation.coefficients.iter().copied()))
    };
    let mut ordered = equations.to_vec();
    ordered.sort_by_key(|&i| (order(model, i), i));
    let mut rows: Vec<TermList> = ordered.iter().map(row).filter(|row| !row.is_empty()).collect();
    let slaves: FxHashMap<u32, usize> = rows.iter().map(|row| row[0].0).zip(0..).collect();
    for _ in 0..MOST_INSERTIONS / rows.len().max(1) {
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

/// The order in which ccx makes the equations of cards, regardless of their place in the deck.
fn order(model: &Model, equation: usize) -> u8 {
    let name = model.cards.nth(model.nth(equation).origin.card).name;
    if name == "*KINEMATIC" { 0 } else { 1 + u8::from(name == "*TIE") }
}

/// Adds up terms with the same DOF, in the order in which the DOFs occur first. Keeps the first term, and all other terms that are not
/// zero.
fn collected(terms: impl Iterator<Item = (u32, f64)>) -> TermList {
    let mut row = TermList::new();
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

/// Replaces the term at index `at` of `row`, whose DOF is the slave of `equation`. The other terms of `equation`, solved for this DOF, take
/// its place.
fn inserted(row: &TermList, at: usize, equation: &TermList) -> TermList {
    let factor = -row[at].1 / equation[0].1;
    let instead = equation[1..].iter().map(|&(j, a)| (j, factor * a));
    collected(row[..at].iter().copied().chain(instead).chain(row[at + 1..].iter().copied()))
}
