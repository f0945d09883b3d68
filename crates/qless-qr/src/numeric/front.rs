//! `F_f = [rows of A that begin in f; what the children left]`, sorted by first column, and its elimination.

mod assemble;
mod keep;
mod read;

use pulp::Arch;

use super::Numbers;
use super::contribution::{ContributionBlock, Out};
use super::ledger::Ledger;
use crate::Error;
use crate::analyse::{Shape, front_bytes, kept_bytes};
use crate::dense::{Dense, Work};
use crate::pattern::NONE;
use crate::symbolic::Symbolic;

/// What one task needs beside the fronts; reused from front to front.
pub(super) struct Workspace<'a> {
    symbolic: &'a Symbolic,
    numbers: &'a Numbers<'a>,
    ledger: &'a Ledger,
    arch: Arch,
    /// Index in the front of each column of the matrix, or [`NONE`].
    place: Vec<u32>,
    columns: Vec<u32>,
    stair: Vec<u32>,
    next: Vec<u32>,
    /// Row of A that holds each row, if Q is kept.
    names: Vec<u32>,
    values: Vec<f64>,
    work: Work,
}

impl<'a> Workspace<'a> {
    pub fn new(symbolic: &'a Symbolic, numbers: &'a Numbers<'a>, ledger: &'a Ledger) -> Self {
        let place = vec![NONE; symbolic.cols];
        let work = Work::new(numbers.keep_q);
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
            work,
        }
    }

    /// Assembles and eliminates front f.
    pub fn front(&mut self, f: usize, children: Vec<ContributionBlock>) -> Result<(ContributionBlock, Out), Error> {
        let rows = self.symbolic.front_rows(f).len() + children.iter().map(|left| left.lead.len()).sum::<usize>();
        if rows == 0 {
            return Ok(Default::default());
        }
        let pivots = self.find_columns(f, &children);
        let shape = Shape { rows, cols: self.columns.len(), ..Shape::default() };
        let bytes = front_bytes(&shape, self.numbers.count) + if self.numbers.keep_q { kept_bytes(&shape) } else { 0 };
        self.ledger.take(bytes)?;
        self.reserve_q(&shape)?;
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
}

/// The bytes that were booked for it.
fn held(left: &ContributionBlock) -> usize {
    8 * left.values.len() + 4 * (left.columns.len() + left.lead.len() + left.names.len())
}
