//! `F_f = [rows of A that begin in f; what the children left]`, sorted by first column, and its elimination.

use pulp::Arch;

use super::contribution::{Left, Out, pack, pack_rows, packed_len};
use super::ledger::Ledger;
use super::{Numbers, scaled_norm};
use crate::Error;
use crate::analyse::{Shape, front_bytes, out_bytes, waiting_bytes};
use crate::dense::{Dense, Work};
use crate::pattern::NONE;
use crate::symbolic::Symbolic;

/// What one task needs beside the fronts; reused from front to front.
pub(super) struct Bench<'a> {
    symbolic: &'a Symbolic,
    numbers: &'a Numbers<'a>,
    ledger: &'a Ledger,
    arch: Arch,
    /// Index in the front of each column of the matrix, or [`NONE`].
    place: Vec<u32>,
    columns: Vec<u32>,
    stair: Vec<u32>,
    next: Vec<u32>,
    values: Vec<f64>,
    work: Work,
}

impl<'a> Bench<'a> {
    pub fn new(symbolic: &'a Symbolic, numbers: &'a Numbers<'a>, ledger: &'a Ledger) -> Self {
        let place = vec![NONE; symbolic.cols];
        let (columns, stair, next, values) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let work = Work::default();
        Self { symbolic, numbers, ledger, arch: Arch::new(), place, columns, stair, next, values, work }
    }

    /// Assembles and eliminates front f.
    pub fn front(&mut self, f: usize, children: Vec<Left>) -> Result<(Left, Out), Error> {
        let rows = self.symbolic.front_rows(f).len() + children.iter().map(|left| left.lead.len()).sum::<usize>();
        if rows == 0 {
            return Ok(Default::default());
        }
        let pivots = self.find_columns(f, &children);
        let shape = Shape { rows, cols: self.columns.len(), ..Shape::default() };
        let bytes = front_bytes(&shape, self.numbers.count);
        self.ledger.take(bytes)?;
        self.sort_rows(f, &children);
        self.assemble(f, rows, &children)?;
        self.columns.iter().for_each(|&column| self.place[column as usize] = NONE);
        children.iter().for_each(|left| self.ledger.give(held(left)));
        drop(children);
        let (values, stair, tolerance) = (&mut self.values[..], &self.stair[..], self.numbers.tolerance);
        Dense { values, rows, cols: shape.cols, pivots, stair, tolerance }.eliminate(self.arch, &mut self.work);
        let done = self.read(f, rows, pivots)?;
        self.ledger.give(bytes);
        Ok(done)
    }

    /// The columns that the front has, with their places; how many are pivotal.
    fn find_columns(&mut self, f: usize, children: &[Left]) -> usize {
        let symbolic = self.symbolic;
        let (from, end, outer) = symbolic.front_columns(f);
        let rows = symbolic.front_rows(f);
        let entries = symbolic.pattern.start[rows.start]..symbolic.pattern.start[rows.end];
        symbolic.pattern.index[entries].iter().for_each(|&column| self.place[column as usize] = 0);
        for left in children {
            left.columns.iter().for_each(|&column| self.place[column as usize] = 0);
        }
        self.columns.clear();
        self.columns.extend(from..end);
        self.columns.extend(outer.iter().filter(|&&column| self.place[column as usize] == 0));
        self.columns.iter().zip(0..).for_each(|(&column, k)| self.place[column as usize] = k);
        (end - from) as usize
    }

    /// `stair[k]`: rows that begin at or before column k; `next[k]`: the first of those that begin at it.
    fn sort_rows(&mut self, f: usize, children: &[Left]) {
        let symbolic = self.symbolic;
        let Self { place, stair, next, .. } = self;
        stair.clear();
        stair.resize(self.columns.len(), 0);
        for i in symbolic.front_rows(f) {
            stair[place[symbolic.pattern.index[symbolic.pattern.start[i]] as usize] as usize] += 1;
        }
        for left in children {
            left.lead.iter().for_each(|&at| stair[place[left.columns[at as usize] as usize] as usize] += 1);
        }
        next.clear();
        let mut sum = 0;
        for count in stair {
            next.push(sum);
            sum += *count;
            *count = sum;
        }
    }

    fn assemble(&mut self, f: usize, rows: usize, children: &[Left]) -> Result<(), Error> {
        let length = rows * (self.columns.len() + self.numbers.count);
        self.values.clear();
        if self.values.capacity() < length {
            self.values = Vec::new();
            self.values = self.ledger.reserve(length)?;
        }
        self.values.resize(length, 0.0);
        self.symbolic.front_rows(f).for_each(|i| self.add_row(i, rows));
        children.iter().for_each(|left| self.add_left(left, rows));
        Ok(())
    }

    fn add_row(&mut self, i: usize, rows: usize) {
        let symbolic = self.symbolic;
        let (from, to) = (symbolic.pattern.start[i], symbolic.pattern.start[i + 1]);
        let slot = &mut self.next[self.place[symbolic.pattern.index[from] as usize] as usize];
        let row = *slot as usize;
        *slot += 1;
        for (&column, &entry) in symbolic.pattern.index[from..to].iter().zip(&symbolic.entry[from..to]) {
            self.values[self.place[column as usize] as usize * rows + row] = self.numbers.values[entry as usize];
        }
        let below = self.columns.len() * rows;
        for c in 0..self.numbers.count {
            let given = self.numbers.rhs[c * symbolic.rows + symbolic.row_order[i] as usize];
            self.values[below + c * rows + row] = given;
        }
    }

    fn add_left(&mut self, left: &Left, rows: usize) {
        let Self { place, next, values, columns, .. } = self;
        let take = |&at: &u32| {
            let slot = &mut next[place[left.columns[at as usize] as usize] as usize];
            *slot += 1;
            *slot - 1
        };
        let target: Vec<u32> = left.lead.iter().map(take).collect();
        let (mut height, mut at) = (0, 0);
        let inner = left.columns.iter().map(|&column| place[column as usize] as usize);
        let behind = (columns.len()..).take(self.numbers.count);
        for (c, k) in inner.chain(behind).enumerate() {
            while height < target.len() && (c >= left.columns.len() || left.lead[height] as usize <= c) {
                height += 1;
            }
            let column = &mut values[k * rows..(k + 1) * rows];
            for (&row, &value) in target[..height].iter().zip(&left.values[at..at + height]) {
                column[row as usize] = value;
            }
            at += height;
        }
    }

    /// Splits the eliminated front into rows of R, rows for the parent and rows that are done.
    fn read(&mut self, f: usize, rows: usize, pivots: usize) -> Result<(Left, Out), Error> {
        let (cols, count) = (self.columns.len(), self.numbers.count);
        let lead = &self.work.lead[..];
        let rank = lead.partition_point(|&k| (k as usize) < pivots);
        let (own, others) = lead.split_at(rank);
        let shape = shape(cols, own, others);
        self.ledger.take(out_bytes(&shape, count) + waiting_bytes(&shape, count))?;
        let mut out = Out::new(own, &self.columns[pivots..], self.symbolic.outer.list(f), self.work.dropped);
        out.has_rest = count > 0 && lead.len() < rows;
        let room = packed_len(cols, own, count) + if out.has_rest { count } else { 0 };
        out.values = self.ledger.reserve(room)?;
        pack_rows(&self.values, rows, own, &mut out.values);
        if out.has_rest {
            let columns = self.values[cols * rows..].chunks_exact(rows);
            out.values.extend(columns.map(|b| scaled_norm(&b[lead.len()..])));
        }
        Ok((self.left(rows, rank)?, out))
    }

    fn left(&self, rows: usize, rank: usize) -> Result<Left, Error> {
        let lead = &self.work.lead[rank..];
        let Some(&first) = lead.first() else { return Ok(Left::default()) };
        let (cols, count) = (self.columns.len(), self.numbers.count);
        let mut values = self.ledger.reserve(packed_len(cols, lead, count))?;
        pack(&self.values, rows, cols, rank, lead, &mut values);
        let columns = self.columns[first as usize..].to_vec();
        Ok(Left { columns, lead: lead.iter().map(|k| k - first).collect(), values })
    }
}

fn shape(cols: usize, own: &[u32], others: &[u32]) -> Shape {
    let entries = |lead: &[u32]| packed_len(cols, lead, 0);
    let left_cols = others.first().map_or(0, |&k| cols - k as usize);
    let (rank, left_rows) = (own.len(), others.len());
    Shape { rows: 0, cols, rank, entries: entries(own), left_rows, left_cols, left_entries: entries(others) }
}

/// The bytes that were booked for it.
fn held(left: &Left) -> usize {
    8 * left.values.len() + 4 * (left.columns.len() + left.lead.len())
}
