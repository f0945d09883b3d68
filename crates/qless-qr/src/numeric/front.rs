//! `F_f = [rows of A that begin in f; contributions of the children]`, sorted by first column: assembly and elimination.

use pulp::Arch;

use super::contribution::{Contribution, FrontResult, pack, pack_rows, packed_len};
use super::{FactorInput, MemoryLedger};
use crate::Error;
use crate::lists::NONE;
use crate::reflections::Reflections;
use crate::staircase::{DenseFront, Echelon, ReflectionBuffers, scaled_norm};
use crate::symbolic::{
    FrontShape, INDEX, Symbolic, front_bytes, kept_bytes, out_bytes, reflection_bytes, waiting_bytes,
};

/// Buffers of one task, reused from front to front.
pub(super) struct Workspace<'a> {
    symbolic: &'a Symbolic,
    numbers: &'a FactorInput<'a>,
    ledger: &'a MemoryLedger,
    arch: Arch,
    /// Index of each matrix column in the front, or [`NONE`].
    place: Vec<u32>,
    columns: Vec<u32>,
    stair: Vec<u32>,
    next: Vec<u32>,
    /// For each row of the front, the row of A whose number it keeps; used only if Q is kept.
    names: Vec<u32>,
    values: Vec<f64>,
    work: ReflectionBuffers,
    echelon: Echelon,
}

impl<'a> Workspace<'a> {
    pub fn new(symbolic: &'a Symbolic, numbers: &'a FactorInput<'a>, ledger: &'a MemoryLedger) -> Self {
        let place = vec![NONE; symbolic.cols];
        let echelon = Echelon { kept: numbers.keep_q.then(Reflections::default), ..Echelon::default() };
        Self {
            symbolic,
            numbers,
            ledger,
            arch: Arch::new(),
            place,
            columns: Vec::new(),
            stair: Vec::new(),
            next: Vec::new(),
            names: Vec::new(),
            values: Vec::new(),
            work: ReflectionBuffers::default(),
            echelon,
        }
    }

    /// Assembles and eliminates front f.
    pub fn front(&mut self, f: usize, children: Vec<Contribution>) -> Result<(Contribution, FrontResult), Error> {
        let rows = self.symbolic.front_rows(f).len() + children.iter().map(|child| child.lead.len()).sum::<usize>();
        if rows == 0 {
            return Ok(Default::default());
        }
        let pivots = self.find_columns(f, &children);
        let shape = FrontShape { rows, cols: self.columns.len(), ..FrontShape::default() };
        let bytes = front_bytes(&shape, self.numbers.count) + if self.numbers.keep_q { kept_bytes(&shape) } else { 0 };
        self.ledger.take(bytes)?;
        self.reserve_q(&shape)?;
        self.sort_rows(f, &children);
        self.assemble(f, rows, &children)?;
        self.columns.iter().for_each(|&column| self.place[column as usize] = NONE);
        children.iter().for_each(|child| self.ledger.give(held(child)));
        drop(children);
        let front =
            DenseFront { rows, cols: shape.cols, pivots, stair: &self.stair, tolerance: self.numbers.tolerance };
        front.eliminate(self.arch, &mut self.values, &mut self.work, &mut self.echelon);
        let done = self.read(f, rows, pivots)?;
        self.ledger.give(bytes);
        Ok(done)
    }
}

/// The bytes that the memory ledger counts for a child's contribution.
fn held(child: &Contribution) -> usize {
    8 * child.values.len() + 4 * (child.columns.len() + child.lead.len() + child.names.len())
}

impl Workspace<'_> {
    /// Finds the columns of the front and their indices in it; returns the number of pivotal ones.
    pub(super) fn find_columns(&mut self, f: usize, children: &[Contribution]) -> usize {
        let symbolic = self.symbolic;
        let (from, end, outer) = symbolic.front_columns(f);
        let rows = symbolic.front_rows(f);
        let entries = symbolic.pattern.start[rows.start]..symbolic.pattern.start[rows.end];
        symbolic.pattern.index[entries].iter().for_each(|&column| self.place[column as usize] = 0);
        for child in children {
            child.columns.iter().for_each(|&column| self.place[column as usize] = 0);
        }
        self.columns.clear();
        self.columns.extend(from..end);
        self.columns.extend(outer.iter().filter(|&&column| self.place[column as usize] == 0));
        self.columns.iter().zip(0..).for_each(|(&column, k)| self.place[column as usize] = k);
        (end - from) as usize
    }

    /// Sets `stair[k]`, the number of rows that begin at or before column k, and `next[k]`, the first row that begins at k.
    pub(super) fn sort_rows(&mut self, f: usize, children: &[Contribution]) {
        let symbolic = self.symbolic;
        let Self { place, stair, next, .. } = self;
        stair.clear();
        stair.resize(self.columns.len(), 0);
        for i in symbolic.front_rows(f) {
            stair[place[symbolic.pattern.index[symbolic.pattern.start[i]] as usize] as usize] += 1;
        }
        for child in children {
            child.lead.iter().for_each(|&at| stair[place[child.columns[at as usize] as usize] as usize] += 1);
        }
        next.clear();
        let mut sum = 0;
        for count in stair {
            next.push(sum);
            sum += *count;
            *count = sum;
        }
    }

    pub(super) fn assemble(&mut self, f: usize, rows: usize, children: &[Contribution]) -> Result<(), Error> {
        let length = rows * (self.columns.len() + self.numbers.count);
        self.values.clear();
        if self.values.capacity() < length {
            self.values = Vec::new();
            self.values = self.ledger.reserve(length)?;
        }
        self.values.resize(length, 0.0);
        if self.numbers.keep_q {
            self.names.clear();
            self.names.resize(rows, 0);
        }
        self.symbolic.front_rows(f).for_each(|i| self.add_row(i, rows));
        children.iter().for_each(|child| self.add_contribution(child, rows));
        Ok(())
    }

    fn add_row(&mut self, i: usize, rows: usize) {
        let symbolic = self.symbolic;
        let (from, to) = (symbolic.pattern.start[i], symbolic.pattern.start[i + 1]);
        let slot = &mut self.next[self.place[symbolic.pattern.index[from] as usize] as usize];
        let row = *slot as usize;
        *slot += 1;
        if let Some(name) = self.names.get_mut(row) {
            *name = symbolic.row_order[i];
        }
        for (&column, &entry) in symbolic.pattern.index[from..to].iter().zip(&symbolic.entry[from..to]) {
            self.values[self.place[column as usize] as usize * rows + row] = self.numbers.values[entry as usize];
        }
        let below = self.columns.len() * rows;
        for c in 0..self.numbers.count {
            let given = self.numbers.rhs[c * symbolic.rows + symbolic.row_order[i] as usize];
            self.values[below + c * rows + row] = given;
        }
    }

    fn add_contribution(&mut self, child: &Contribution, rows: usize) {
        let Self { place, next, values, columns, names, .. } = self;
        let take = |&at: &u32| {
            let slot = &mut next[place[child.columns[at as usize] as usize] as usize];
            *slot += 1;
            *slot - 1
        };
        let target: Vec<u32> = child.lead.iter().map(take).collect();
        target.iter().zip(&child.names).for_each(|(&row, &name)| names[row as usize] = name);
        let (mut height, mut at) = (0, 0);
        let inner = child.columns.iter().map(|&column| place[column as usize] as usize);
        let behind = (columns.len()..).take(self.numbers.count);
        for (c, k) in inner.chain(behind).enumerate() {
            while height < target.len() && (c >= child.columns.len() || child.lead[height] as usize <= c) {
                height += 1;
            }
            let column = &mut values[k * rows..(k + 1) * rows];
            for (&row, &value) in target[..height].iter().zip(&child.values[at..at + height]) {
                column[row as usize] = value;
            }
            at += height;
        }
    }
}

impl Workspace<'_> {
    /// Splits the eliminated front into rows of R, the contribution to the parent, and finished rows without a column.
    pub(super) fn read(&mut self, f: usize, rows: usize, pivots: usize) -> Result<(Contribution, FrontResult), Error> {
        let (cols, count) = (self.columns.len(), self.numbers.count);
        let lead = &self.echelon.lead[..];
        let rank = lead.partition_point(|&k| (k as usize) < pivots);
        let (own, others) = lead.split_at(rank);
        let shape = shape(cols, own, others);
        let names = if self.numbers.keep_q { INDEX * shape.passed_rows } else { 0 };
        self.ledger.take(out_bytes(&shape, count) + waiting_bytes(&shape, count) + names)?;
        let mut out = FrontResult::new(own, &self.columns[pivots..], self.symbolic.outer.list(f), self.echelon.dropped);
        out.has_rest = count > 0 && lead.len() < rows;
        let room = packed_len(cols, own, count) + if out.has_rest { count } else { 0 };
        out.values = self.ledger.reserve(room)?;
        pack_rows(&self.values, rows, own, &mut out.values);
        if out.has_rest {
            let columns = self.values[cols * rows..].chunks_exact(rows);
            out.values.extend(columns.map(|b| scaled_norm(&b[lead.len()..])));
        }
        out.done = lead.len();
        out.reflections = self.reflections()?;
        Ok((self.contribution(rows, rank)?, out))
    }

    fn contribution(&self, rows: usize, rank: usize) -> Result<Contribution, Error> {
        let lead = &self.echelon.lead[rank..];
        let Some(&first) = lead.first() else { return Ok(Contribution::default()) };
        let (cols, count) = (self.columns.len(), self.numbers.count);
        let mut values = self.ledger.reserve(packed_len(cols, lead, count))?;
        pack(&self.values, rows, cols, rank, lead, &mut values);
        let columns = self.columns[first as usize..].to_vec();
        let names = if self.numbers.keep_q { self.names[rank..rank + lead.len()].to_vec() } else { Vec::new() };
        Ok(Contribution { columns, lead: lead.iter().map(|k| k - first).collect(), names, values })
    }
}

fn shape(cols: usize, own: &[u32], others: &[u32]) -> FrontShape {
    let entries = |lead: &[u32]| packed_len(cols, lead, 0);
    let passed_cols = others.first().map_or(0, |&k| cols - k as usize);
    let (rank, passed_rows) = (own.len(), others.len());
    let (entries, passed_entries) = (entries(own), entries(others));
    FrontShape { cols, rank, entries, passed_rows, passed_cols, passed_entries, ..FrontShape::default() }
}

impl Workspace<'_> {
    /// Reserves memory for all reflections that the front can have.
    pub(super) fn reserve_q(&mut self, shape: &FrontShape) -> Result<(), Error> {
        let Some(kept) = &mut self.echelon.kept else { return Ok(()) };
        let most = shape.rows * shape.rows.min(shape.cols);
        if kept.v.capacity() < most {
            kept.v = Vec::new();
            kept.v = self.ledger.reserve(most)?;
        }
        Ok(())
    }

    /// The reflections of the front in memory of their exact size; `None` if Q is not kept.
    pub(super) fn reflections(&self) -> Result<Option<Box<Reflections>>, Error> {
        let Some(kept) = &self.echelon.kept else { return Ok(None) };
        self.ledger.take(reflection_bytes(self.names.len(), kept.tau.len(), kept.v.len()))?;
        let mut v = self.ledger.reserve(kept.v.len())?;
        v.extend_from_slice(&kept.v);
        let (first, end, tau) = (kept.first.clone(), kept.end.clone(), kept.tau.clone());
        Ok(Some(Box::new(Reflections { rows: self.names.clone(), first, end, tau, v })))
    }
}
