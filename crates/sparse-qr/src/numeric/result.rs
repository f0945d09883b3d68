//! `[R1 R2]` from the fronts' packed rows: independent columns keep their order, the others go behind them.

use super::contribution::Out;
use super::ledger::Ledger;
use super::{Numbers, scaled_norm};
use crate::pattern::NONE;
use crate::symbolic::Symbolic;
use crate::{Error, Factor, Rows};

/// Builds the result; each front is freed once it is read.
pub(super) fn collect(
    symbolic: &Symbolic,
    numbers: &Numbers,
    outs: Vec<Out>,
    ledger: &Ledger,
) -> Result<Factor, Error> {
    let place = places(symbolic, &outs);
    let rank = symbolic.peeled + outs.iter().map(|out| out.lead.len()).sum::<usize>();
    let entries =
        symbolic.pattern.start[symbolic.peeled] + outs.iter().map(|out| nonzeros(out, numbers.count)).sum::<usize>();
    ledger.take(12 * entries + 8 * (rank + 1 + rank * numbers.count))?;
    let rest = rest(symbolic, numbers, &outs);
    let dropped = outs.iter().fold(0.0, |sum: f64, out| sum.hypot(out.dropped));
    let r = Rows { start: ledger.reserve(rank + 1)?, col: ledger.reserve(entries)?, val: ledger.reserve(entries)? };
    let mut builder = Builder { symbolic, numbers, place: &place, rank, r, rhs: vec![0.0; rank * numbers.count] };
    builder.r.start.push(0);
    (0..symbolic.peeled).for_each(|i| builder.peeled(i));
    outs.into_iter().enumerate().for_each(|(f, out)| builder.front(f, &out));
    let Builder { r, rhs, .. } = builder;
    if !r.val.iter().chain(&rhs).chain(&rest).all(|v| v.is_finite()) {
        return Err(Error::Overflow);
    }
    let mut order = vec![0; symbolic.cols];
    place.iter().zip(&symbolic.order).for_each(|(&at, &column)| order[at as usize] = column as usize);
    Ok(Factor { rank, order, r, rhs, rest, dropped })
}

/// Final position of every position of the analysis.
fn places(symbolic: &Symbolic, outs: &[Out]) -> Vec<u32> {
    let mut place = vec![NONE; symbolic.cols];
    let mut next = 0..;
    let mut number = |at: &mut u32| *at = next.next().unwrap_or(NONE);
    place[..symbolic.peeled].iter_mut().for_each(&mut number);
    for (out, &from) in outs.iter().zip(&symbolic.fronts.pivot) {
        out.lead.iter().for_each(|&k| number(&mut place[(from + k) as usize]));
    }
    place.iter_mut().filter(|at| **at == NONE).for_each(number);
    place
}

/// Entries of R that the front holds and that are not zero.
fn nonzeros(out: &Out, count: usize) -> usize {
    let end = out.values.len() - out.lead.len() * count;
    out.values[..end].iter().filter(|&&v| v != 0.0).count()
}

/// Norms of what remains of each right-hand side: of rows without entries and of what fronts had no columns for.
fn rest(symbolic: &Symbolic, numbers: &Numbers, outs: &[Out]) -> Vec<f64> {
    let assembled = symbolic.row.last().map_or(symbolic.peeled, |&end| end as usize);
    let empty = &symbolic.row_order[assembled..];
    let of = |c: usize| {
        let b = &numbers.rhs[c * symbolic.rows..(c + 1) * symbolic.rows];
        let untouched: Vec<f64> = empty.iter().map(|&i| b[i as usize]).collect();
        let parts = outs.iter().filter_map(|out| out.rest.get(c));
        parts.fold(scaled_norm(&untouched), |sum, part| sum.hypot(*part))
    };
    (0..numbers.count).map(of).collect()
}

struct Builder<'a> {
    symbolic: &'a Symbolic,
    numbers: &'a Numbers<'a>,
    place: &'a [u32],
    rank: usize,
    r: Rows,
    rhs: Vec<f64>,
}

impl Builder<'_> {
    fn push(&mut self, position: u32, value: f64) {
        if value != 0.0 {
            self.r.col.push(self.place[position as usize]);
            self.r.val.push(value);
        }
    }

    fn is_live(&self, position: u32) -> bool {
        (self.place[position as usize] as usize) < self.rank
    }

    /// Row i of A is row i of R.
    fn peeled(&mut self, i: usize) {
        let symbolic = self.symbolic;
        for live in [true, false] {
            for at in symbolic.pattern.start[i]..symbolic.pattern.start[i + 1] {
                let position = symbolic.pattern.index[at];
                if self.is_live(position) == live {
                    self.push(position, self.numbers.values[symbolic.entry[at] as usize]);
                }
            }
        }
        for c in 0..self.numbers.count {
            self.rhs[c * self.rank + i] = self.numbers.rhs[c * symbolic.rows + symbolic.row_order[i] as usize];
        }
        self.r.start.push(self.r.col.len());
    }

    fn front(&mut self, f: usize, out: &Out) {
        let (from, end, _) = self.symbolic.front_columns(f);
        let columns: Vec<u32> = (from..end).chain(out.outer.iter().copied()).collect();
        let (heights, offsets) = extents(out, columns.len());
        let row = self.r.start.len() - 1;
        for i in 0..out.lead.len() {
            for live in [true, false] {
                for k in out.lead[i] as usize..columns.len() {
                    if i < heights[k] as usize && self.is_live(columns[k]) == live {
                        self.push(columns[k], out.values[offsets[k] + i]);
                    }
                }
            }
            self.r.start.push(self.r.col.len());
        }
        let rank = out.lead.len();
        let behind = out.values.len() - rank * self.numbers.count;
        for c in 0..self.numbers.count {
            let at = behind + c * rank;
            self.rhs[c * self.rank + row..][..rank].copy_from_slice(&out.values[at..at + rank]);
        }
    }
}

/// For each column of a front how many rows it holds, and where.
fn extents(out: &Out, cols: usize) -> (Vec<u32>, Vec<usize>) {
    let (mut height, mut offset) = (0, 0);
    let mut extents = (Vec::with_capacity(cols), Vec::with_capacity(cols));
    for k in 0..cols {
        while height < out.lead.len() && out.lead[height] as usize <= k {
            height += 1;
        }
        extents.0.push(height as u32);
        extents.1.push(offset);
        offset += height;
    }
    extents
}
