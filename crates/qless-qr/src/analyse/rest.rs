//! S of `P_r A P_c = [R11 R12; 0 S]`: rows and columns that peeling leaves.

use super::fronts::Fronts;
use super::permuted::Permuted;
use super::{Forecast, counts, patterns, tree};
use crate::matrix::Gather;
use crate::pattern::{Lists, NONE};
use crate::symbolic::Symbolic;

/// S: what peeling leaves.
pub(super) struct Rest {
    /// Rows of S.
    pub rows: usize,
    /// Columns of S with rows renumbered.
    pub columns: Lists,
    /// Column of A of each column of S.
    column: Vec<u32>,
    /// Columns of A without entries outside the peeled rows: dependent by the pattern.
    void: Vec<u32>,
}

impl Rest {
    pub fn new(columns: &Lists, rows: &Lists, peeled: &[(u32, u32)]) -> Self {
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
    pub fn symbolic(&self, columns: &Lists, row_count: usize, peeled: &[(u32, u32)], order: &[u32]) -> Symbolic {
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
        let (forecast, gather) = (Forecast::default(), Gather::default());
        let Permuted { row_order, pattern, entry } = permuted;
        let (rows, cols, peeled) = (row_count, columns.len(), peeled.len());
        let mut symbolic =
            Symbolic { rows, cols, order, peeled, row_order, pattern, entry, fronts, row, outer, forecast, gather };
        symbolic.forecast = Forecast::new(&symbolic);
        symbolic
    }
}
