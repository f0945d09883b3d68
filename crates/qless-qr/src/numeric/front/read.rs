//! Rows of R, rows for the parent, rows that are done.

use super::super::contribution::{ContributionBlock, Out, pack, pack_rows, packed_len};
use super::super::scaled_norm;
use super::Workspace;
use crate::Error;
use crate::analyse::{INDEX, Shape, out_bytes, waiting_bytes};

impl Workspace<'_> {
    /// Splits the eliminated front into rows of R, rows for the parent and rows that are done.
    pub(super) fn read(&mut self, f: usize, rows: usize, pivots: usize) -> Result<(ContributionBlock, Out), Error> {
        let (cols, count) = (self.columns.len(), self.numbers.count);
        let lead = &self.work.lead[..];
        let rank = lead.partition_point(|&k| (k as usize) < pivots);
        let (own, others) = lead.split_at(rank);
        let shape = shape(cols, own, others);
        let names = if self.numbers.keep_q { INDEX * shape.left_rows } else { 0 };
        self.ledger.take(out_bytes(&shape, count) + waiting_bytes(&shape, count) + names)?;
        let mut out = Out::new(own, &self.columns[pivots..], self.symbolic.outer.list(f), self.work.dropped);
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
        Ok((self.left(rows, rank)?, out))
    }

    fn left(&self, rows: usize, rank: usize) -> Result<ContributionBlock, Error> {
        let lead = &self.work.lead[rank..];
        let Some(&first) = lead.first() else { return Ok(ContributionBlock::default()) };
        let (cols, count) = (self.columns.len(), self.numbers.count);
        let mut values = self.ledger.reserve(packed_len(cols, lead, count))?;
        pack(&self.values, rows, cols, rank, lead, &mut values);
        let columns = self.columns[first as usize..].to_vec();
        let names = if self.numbers.keep_q { self.names[rank..rank + lead.len()].to_vec() } else { Vec::new() };
        Ok(ContributionBlock { columns, lead: lead.iter().map(|k| k - first).collect(), names, values })
    }
}

fn shape(cols: usize, own: &[u32], others: &[u32]) -> Shape {
    let entries = |lead: &[u32]| packed_len(cols, lead, 0);
    let left_cols = others.first().map_or(0, |&k| cols - k as usize);
    let (rank, left_rows) = (own.len(), others.len());
    let (entries, left_entries) = (entries(own), entries(others));
    Shape { cols, rank, entries, left_rows, left_cols, left_entries, ..Shape::default() }
}
