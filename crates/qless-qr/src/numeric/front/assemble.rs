//! Rows of A and of the children's contribution blocks to their places, sorted by first column.

use super::super::contribution::ContributionBlock;
use super::Workspace;
use crate::Error;

impl Workspace<'_> {
    /// The columns that the front has, with their places; how many are pivotal.
    pub(super) fn find_columns(&mut self, f: usize, children: &[ContributionBlock]) -> usize {
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
    pub(super) fn sort_rows(&mut self, f: usize, children: &[ContributionBlock]) {
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

    pub(super) fn assemble(&mut self, f: usize, rows: usize, children: &[ContributionBlock]) -> Result<(), Error> {
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
        children.iter().for_each(|left| self.add_left(left, rows));
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

    fn add_left(&mut self, left: &ContributionBlock, rows: usize) {
        let Self { place, next, values, columns, names, .. } = self;
        let take = |&at: &u32| {
            let slot = &mut next[place[left.columns[at as usize] as usize] as usize];
            *slot += 1;
            *slot - 1
        };
        let target: Vec<u32> = left.lead.iter().map(take).collect();
        target.iter().zip(&left.names).for_each(|(&row, &name)| names[row as usize] = name);
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
}
