//! Pattern of A -> order, fronts, forecast.

mod counts;
mod forecast;
mod fronts;
mod order;
mod patterns;
mod singles;
mod tree;

pub(crate) use forecast::{Forecast, Shape, front_bytes, out_bytes, waiting_bytes};
pub(crate) use fronts::Fronts;

use crate::Error;
use crate::pattern::{Lists, NONE};
use crate::symbolic::Symbolic;

/// AMD comes first if `S^T S` has at most so many times the entries of S; it is the faster of the two then.
const PRODUCT: usize = 24;
/// The other order is tried too where the first promises so many operations for each entry of S.
const WORTH: f64 = 2e4;

/// The analysis; only entries of A that `may` accepts are peeled.
pub(crate) fn analyse(row_count: usize, columns: &Lists, may: &dyn Fn(usize) -> bool) -> Result<Symbolic, Error> {
    let rows = columns.transposed(row_count);
    let peeled = singles::peel(columns, &rows, may);
    let rest = Rest::new(columns, &rows, &peeled);
    let with = |order: Vec<u32>| rest.symbolic(columns, row_count, &peeled, &order);
    let by_rows = rest.columns.transposed(rest.rows);
    let Some(order) = order::amd(&rest.columns, &by_rows, PRODUCT * rest.columns.index.len())? else {
        return order::colamd(rest.rows, &rest.columns).map(with);
    };
    let first = with(order);
    if first.flops() <= WORTH * rest.columns.index.len() as f64 {
        return Ok(first);
    }
    let second = with(order::colamd(rest.rows, &rest.columns)?);
    Ok(if second.flops() < first.flops() { second } else { first })
}

/// S: what peeling leaves.
struct Rest {
    /// Rows of S.
    rows: usize,
    /// Columns of S with rows renumbered.
    columns: Lists,
    /// Column of A of each column of S.
    column: Vec<u32>,
    /// Columns of A without entries outside the peeled rows: dependent by the pattern.
    void: Vec<u32>,
}

impl Rest {
    fn new(columns: &Lists, rows: &Lists, peeled: &[(u32, u32)]) -> Self {
        let mut number = vec![0; rows.len()];
        let mut kept = vec![true; columns.len()];
        for &(column, row) in peeled {
            kept[column as usize] = false;
            number[row as usize] = NONE;
        }
        let mut count = 0;
        for at in number.iter_mut().filter(|at| **at != NONE) {
            *at = count;
            count += 1;
        }
        let (mut left, mut column, mut void) = (Lists::new(), Vec::new(), Vec::new());
        for j in (0..columns.len()).filter(|&j| kept[j]) {
            let before = left.index.len();
            left.index.extend(columns.list(j).iter().map(|&i| number[i as usize]).filter(|&i| i != NONE));
            if left.index.len() == before {
                void.push(j as u32);
            } else {
                column.push(j as u32);
                left.close();
            }
        }
        Self { rows: count as usize, columns: left, column, void }
    }

    /// The analysis with the columns of S in the given order, up to a postorder of their tree.
    fn symbolic(&self, columns: &Lists, row_count: usize, peeled: &[(u32, u32)], order: &[u32]) -> Symbolic {
        let parent = tree::parents(&self.columns, self.rows, order);
        let post = tree::postorder(&parent);
        let parent = tree::renumbered(&parent, &post);
        let head = peeled.iter().map(|&(column, _)| column);
        let tail = post.iter().map(|&k| self.column[order[k as usize] as usize]);
        let order: Vec<u32> = head.chain(tail).chain(self.void.iter().copied()).collect();
        let permuted = Permuted::new(columns, row_count, peeled, &order);
        let count = counts::of_rows(&parent, &permuted.rest(peeled.len()));
        let fronts = Fronts::new(&parent, &count, peeled.len());
        let row = permuted.front_rows(&fronts, peeled.len());
        let outer = patterns::outer(&fronts, &permuted.pattern, &row, columns.len());
        let forecast = Forecast::default();
        let Permuted { row_order, pattern, entry } = permuted;
        let (rows, cols, peeled) = (row_count, columns.len(), peeled.len());
        let mut symbolic =
            Symbolic { rows, cols, order, peeled, row_order, pattern, entry, fronts, row, outer, forecast };
        symbolic.forecast = Forecast::new(&symbolic);
        symbolic
    }
}

/// A by rows in their new order.
struct Permuted {
    row_order: Vec<u32>,
    pattern: Lists,
    entry: Vec<u32>,
}

impl Permuted {
    fn new(columns: &Lists, row_count: usize, peeled: &[(u32, u32)], order: &[u32]) -> Self {
        let row_order = row_order(columns, row_count, peeled, order);
        let mut start = vec![0; row_count + 1];
        let mut place = vec![0; row_count];
        row_order.iter().enumerate().for_each(|(at, &i)| place[i as usize] = at);
        columns.index.iter().for_each(|&i| start[place[i as usize] + 1] += 1);
        (0..row_count).for_each(|i| start[i + 1] += start[i]);
        let (mut next, mut index) = (start.clone(), vec![0; columns.index.len()]);
        let mut entry = vec![0; columns.index.len()];
        for (position, &column) in order.iter().enumerate() {
            let column = column as usize;
            for at in columns.start[column]..columns.start[column + 1] {
                let slot = &mut next[place[columns.index[at] as usize]];
                (index[*slot], entry[*slot]) = (position as u32, at as u32);
                *slot += 1;
            }
        }
        Self { row_order, pattern: Lists { start, index }, entry }
    }

    /// Rows of S with columns counted from the first that was not peeled.
    fn rest(&self, peeled: usize) -> Lists {
        let from = self.pattern.start[peeled];
        let start: Vec<usize> = self.pattern.start[peeled..].iter().map(|at| at - from).collect();
        Lists { start, index: self.pattern.index[from..].iter().map(|&j| j - peeled as u32).collect() }
    }

    fn front_rows(&self, fronts: &Fronts, peeled: usize) -> Vec<u32> {
        let mut at = peeled;
        let mut row = Vec::with_capacity(fronts.len() + 1);
        row.push(at as u32);
        for f in 0..fronts.len() {
            let end = fronts.pivot[f + 1];
            while at < self.pattern.len() && self.pattern.list(at).first().is_some_and(|&j| j < end) {
                at += 1;
            }
            row.push(at as u32);
        }
        row
    }
}

/// Peeled rows, then the others by their first column, empty ones last.
fn row_order(columns: &Lists, row_count: usize, peeled: &[(u32, u32)], order: &[u32]) -> Vec<u32> {
    let mut seen = vec![false; row_count];
    let mut row_order: Vec<u32> = peeled.iter().map(|&(_, row)| row).collect();
    row_order.reserve_exact(row_count - peeled.len());
    row_order.iter().for_each(|&row| seen[row as usize] = true);
    for &column in &order[peeled.len()..] {
        for &row in columns.list(column as usize) {
            if !std::mem::replace(&mut seen[row as usize], true) {
                row_order.push(row);
            }
        }
    }
    row_order.extend((0..row_count as u32).filter(|&row| !seen[row as usize]));
    row_order
}
