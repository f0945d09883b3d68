//! Builds `[R1 R2]` from the packed rows of the fronts: independent columns keep their order, dependent ones follow.

use super::MemoryLedger;
use super::contribution::FrontResult;
use super::{FactorInput, scaled_norm};
use crate::Symbolic;
use crate::lists::NONE;
use crate::reflections::Q;
use crate::symbolic::INDEX;
use crate::{Error, Factor, SparseRows};

/// Builds the factor; frees each front once it is read.
pub(super) fn collect(
    symbolic: &Symbolic,
    numbers: &FactorInput,
    mut outs: Vec<FrontResult>,
    ledger: &MemoryLedger,
) -> Result<Factor, Error> {
    let place = places(symbolic, &outs);
    let rank = symbolic.peeled + outs.iter().map(|out| out.rank).sum::<usize>();
    // The count includes zeros, although they are not stored. The memory reserved for them is never touched, so it costs nothing.
    let packed: usize =
        outs.iter().map(|out| out.values.len() - out.rank * numbers.count - out.rest(numbers.count).len()).sum();
    let entries = symbolic.pattern.start[symbolic.peeled] + packed;
    ledger.take(12 * entries + 8 * (rank + 1 + rank * numbers.count))?;
    let rest = rest(symbolic, numbers, &outs);
    let q = if numbers.keep_q { Some(q(symbolic, &mut outs, ledger)?) } else { None };
    let dropped = outs.iter().fold(0.0, |sum: f64, out| sum.hypot(out.dropped));
    let r =
        SparseRows { start: ledger.reserve(rank + 1)?, col: ledger.reserve(entries)?, val: ledger.reserve(entries)? };
    let mut builder = FactorBuilder {
        symbolic,
        numbers,
        place: &place,
        rank,
        r,
        dependent: Vec::new(),
        columns: Vec::new(),
        rhs: vec![0.0; rank * numbers.count],
    };
    builder.r.start.push(0);
    (0..symbolic.peeled).for_each(|i| builder.peeled(i));
    outs.into_iter().enumerate().for_each(|(f, out)| builder.front(f, &out));
    let FactorBuilder { r, rhs, .. } = builder;
    if !r.val.iter().chain(&rhs).chain(&rest).all(|v| v.is_finite()) {
        return Err(Error::Overflow);
    }
    let mut order = vec![0; symbolic.cols];
    place.iter().zip(&symbolic.order).for_each(|(&at, &column)| order[at as usize] = column as usize);
    let (rows, tolerance) = (symbolic.rows, numbers.tolerance);
    Ok(Factor { rows, order, r, rhs, rest, dropped, tolerance, q })
}

/// Q, with the rows of `Q^T A` in this order: rows of R, rows for which no column was left, rows without entries.
fn q(symbolic: &Symbolic, outs: &mut [FrontResult], ledger: &MemoryLedger) -> Result<Q, Error> {
    ledger.take(INDEX * symbolic.rows)?;
    let mut row = ledger.reserve(symbolic.rows)?;
    let assembled = symbolic.row.last().map_or(symbolic.peeled, |&end| end as usize);
    row.extend_from_slice(&symbolic.row_order[..symbolic.peeled]);
    let kept = || outs.iter().filter_map(|out| Some((out, &out.reflections.as_ref()?.rows[..])));
    kept().for_each(|(out, rows)| row.extend_from_slice(&rows[..out.rank]));
    kept().for_each(|(out, rows)| row.extend_from_slice(&rows[out.done..]));
    row.extend_from_slice(&symbolic.row_order[assembled..]);
    let fronts = outs.iter_mut().filter_map(|out| out.reflections.take()).filter(|front| !front.tau.is_empty());
    Ok(Q { row, fronts: fronts.map(|front| *front).collect() })
}

/// For each column position of the analysis, its position in R: independent columns first.
fn places(symbolic: &Symbolic, outs: &[FrontResult]) -> Vec<u32> {
    let mut place = vec![NONE; symbolic.cols];
    let mut next = 0..;
    let mut number = |at: &mut u32| *at = next.next().unwrap_or(NONE);
    place[..symbolic.peeled].iter_mut().for_each(&mut number);
    for (out, &from) in outs.iter().zip(&symbolic.fronts.pivot) {
        (0..out.rank).for_each(|i| number(&mut place[(from + out.lead(i)) as usize]));
    }
    place.iter_mut().filter(|at| **at == NONE).for_each(number);
    place
}

/// Residual norm of each right-hand side: of the rows without entries and the rows for which no column was left.
fn rest(symbolic: &Symbolic, numbers: &FactorInput, outs: &[FrontResult]) -> Vec<f64> {
    let assembled = symbolic.row.last().map_or(symbolic.peeled, |&end| end as usize);
    let empty = &symbolic.row_order[assembled..];
    let norm = |c: usize| {
        let b = &numbers.rhs[c * symbolic.rows..(c + 1) * symbolic.rows];
        let untouched: Vec<f64> = empty.iter().map(|&i| b[i as usize]).collect();
        let norms = outs.iter().filter_map(|out| out.rest(numbers.count).get(c));
        norms.fold(scaled_norm(&untouched), |sum, norm| sum.hypot(*norm))
    };
    (0..numbers.count).map(norm).collect()
}

struct FactorBuilder<'a> {
    symbolic: &'a Symbolic,
    numbers: &'a FactorInput<'a>,
    place: &'a [u32],
    rank: usize,
    r: SparseRows,
    dependent: Vec<(u32, f64)>,
    columns: Vec<u32>,
    rhs: Vec<f64>,
}

impl FactorBuilder<'_> {
    /// Adds an entry to the current row. Entries of dependent columns are collected until the end of the row.
    fn push(&mut self, column: u32, value: f64) {
        if value == 0.0 {
        } else if (column as usize) < self.rank {
            self.r.col.push(column);
            self.r.val.push(value);
        } else {
            self.dependent.push((column, value));
        }
    }

    fn close(&mut self) {
        self.r.col.extend(self.dependent.iter().map(|entry| entry.0));
        self.r.val.extend(self.dependent.drain(..).map(|entry| entry.1));
        self.r.start.push(self.r.col.len());
    }

    /// Adds row i of R, which peeling took unchanged from A.
    fn peeled(&mut self, i: usize) {
        let symbolic = self.symbolic;
        let range = symbolic.pattern.start[i]..symbolic.pattern.start[i + 1];
        let positions = symbolic.pattern.index[range.clone()].iter();
        for (&position, &entry) in positions.zip(&symbolic.entry[range]) {
            self.push(self.place[position as usize], self.numbers.values[entry as usize]);
        }
        self.close();
        for c in 0..self.numbers.count {
            self.rhs[c * self.rank + i] = self.numbers.rhs[c * symbolic.rows + symbolic.row_order[i] as usize];
        }
    }

    fn front(&mut self, f: usize, out: &FrontResult) {
        let (from, end, all) = self.symbolic.front_columns(f);
        let Self { place, columns, .. } = self;
        columns.clear();
        columns.extend_from_slice(&place[from as usize..end as usize]);
        columns.extend(out.outer(all).iter().map(|&at| place[at as usize]));
        let columns = std::mem::take(columns);
        let mut values = &out.values[..];
        for i in 0..out.rank {
            let columns = &columns[out.lead(i) as usize..];
            let (row, behind) = values.split_at(columns.len());
            let row_number = self.r.start.len() - 1;
            self.row(columns, row);
            let (rhs, others) = behind.split_at(self.numbers.count);
            rhs.iter().enumerate().for_each(|(c, b)| self.rhs[c * self.rank + row_number] = *b);
            values = others;
        }
        self.columns = columns;
    }

    fn row(&mut self, columns: &[u32], values: &[f64]) {
        let is_plain = |(&column, &value): (&u32, &f64)| value != 0.0 && (column as usize) < self.rank;
        if columns.iter().zip(values).all(is_plain) {
            self.r.col.extend_from_slice(columns);
            self.r.val.extend_from_slice(values);
        } else {
            columns.iter().zip(values).for_each(|(&column, &value)| self.push(column, value));
        }
        self.close();
    }
}
