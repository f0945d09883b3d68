//! Up to [`BATCH_ROWS`] linear equations, `c_i = sum_t a_it u_it - b_i`, grouped by their number of terms.
//!
//! Within a group the inner loop has a length known to the compiler, and no branch. Coefficient lists are stored apart from the DOFs, and
//! a repeated list only once: in ties and periodic cells most of them repeat. DOFs are stored relative to a base of the batch, in 16 bits
//! if their range allows it.

use qless::common::Identity;

use crate::equations::linear::equal_length::{CoefficientCache, EqualLengthRows};
use crate::equations::{ChangeStamp, EquationOwner};

/// Equations per batch: row numbers fit into 16 bits, and the values fit into the first-level cache.
pub const BATCH_ROWS: usize = 4096;
/// Number of DOFs that 16 bits can address.
pub const NEAR_DOFS: usize = 1 << 16;

/// Pairs `(DOF, coefficient)`, DOFs ascending.
pub type LinearTerms = Vec<(u32, f64)>;

/// Up to [`BATCH_ROWS`] consecutive equations.
pub struct LinearBatch {
    /// Renewed after each change of the batch's rows of G.
    pub stamp: ChangeStamp,
    /// DOFs are stored relative to this one, which is not above the smallest.
    pub base: u32,
    pub owners: Vec<EquationOwner>,
    /// Right-hand sides b, separate from the coefficients because they may change.
    pub rhs: Vec<f64>,
    /// Entries in the rows of G.
    pub nnz: usize,
    /// Coefficient lists, one after the other; `unused` counts the coefficients of removed equations.
    numbers: Vec<f64>,
    unused: usize,
    /// Identity of `numbers`, for [`CoefficientCache`].
    lists: Identity,
    lengths: RowsByLength,
}

/// The equations grouped by length, with relative DOFs in 16 or 32 bits.
enum RowsByLength {
    Near(Vec<EqualLengthRows<u16>>),
    Far(Vec<EqualLengthRows<u32>>),
}

/// Evaluates `$work` with the groups, for either width of the DOFs.
macro_rules! with_lengths {
    ($lengths:expr, $all:ident => $work:expr) => {
        match $lengths {
            RowsByLength::Near($all) => $work,
            RowsByLength::Far($all) => $work,
        }
    };
}

impl LinearBatch {
    pub fn empty() -> Self {
        Self {
            stamp: ChangeStamp::default(),
            base: 0,
            owners: Vec::new(),
            rhs: Vec::new(),
            nnz: 0,
            numbers: Vec::new(),
            unused: 0,
            lists: Identity::new(),
            lengths: RowsByLength::Near(Vec::new()),
        }
    }

    pub fn rows(&self) -> usize {
        self.owners.len()
    }

    /// Inserts an equation before row `row`. `recent` finds coefficient lists that are already stored.
    pub fn insert(
        &mut self,
        row: usize,
        owner: EquationOwner,
        terms: &[(u32, f64)],
        rhs: f64,
        recent: &mut CoefficientCache,
    ) {
        self.reach(terms);
        let (appended, base, room) = (row == self.rows(), self.base, self.owners.capacity().saturating_sub(row));
        let list = recent.put(self.lists, &mut self.numbers, terms.iter().map(|&(_, v)| v));
        self.owners.insert(row, owner);
        self.rhs.insert(row, rhs);
        self.nnz += terms.len();
        self.stamp.renew();
        with_lengths!(&mut self.lengths, all => {
            if !appended {
                all.iter_mut().for_each(|length| length.shift(row, 1));
            }
            if all.is_empty() {
                group_of(all, terms.len()).reserve(room);
            }
            group_of(all, terms.len()).insert(row, list, terms.iter().map(|&(j, _)| j - base));
        });
    }

    /// Removes an equation, and returns its owner, terms and right-hand side.
    pub fn remove(&mut self, row: usize) -> (EquationOwner, LinearTerms, f64) {
        let terms = self.terms(row);
        with_lengths!(&mut self.lengths, all => {
            all.iter_mut().for_each(|length| length.remove(row));
            all.retain(|length| !length.row.is_empty());
        });
        self.unused += terms.len();
        self.nnz -= terms.len();
        self.stamp.renew();
        let out = (self.owners.remove(row), terms, self.rhs.remove(row));
        // A shared list counts as unused once per removed equation, so a rewrite may come earlier than necessary.
        if self.unused > self.numbers.len() / 2 + BATCH_ROWS {
            self.rewrite();
        }
        out
    }

    pub fn terms(&self, row: usize) -> LinearTerms {
        let mut terms = Vec::new();
        with_lengths!(&self.lengths, all => {
            for length in all {
                if let Ok(place) = length.row.binary_search(&(row as u16)) {
                    terms.extend(length.terms(place, self.base, &self.numbers));
                }
            }
        });
        terms
    }

    /// Calls `row` with the terms of each equation, in order.
    pub fn for_each_row(&self, mut row: impl FnMut(&mut dyn Iterator<Item = (u32, f64)>)) {
        with_lengths!(&self.lengths, all => {
            let mut places = vec![(0_u16, 0_u16); self.rows()];
            for (which, length) in all.iter().enumerate() {
                let places = &mut places;
                length.row.iter().enumerate().for_each(|(k, &row)| places[usize::from(row)] = (which as u16, k as u16));
            }
            for (which, place) in places {
                row(&mut all[usize::from(which)].terms(usize::from(place), self.base, &self.numbers));
            }
        });
    }

    /// Writes the columns, the coefficients and the ends of the batch's rows of G; the first row starts at `first`.
    pub fn write_rows(&self, first: usize, end: &mut [usize], col: &mut [u32], val: &mut [f64]) {
        with_lengths!(&self.lengths, all => {
            for length in all {
                length.row.iter().for_each(|&row| end[usize::from(row)] = length.terms);
            }
            let mut last = 0;
            for end in &mut *end {
                last += *end;
                *end = last;
            }
            for length in all {
                length.write_rows((self.base, &self.numbers), end, col, val);
            }
        });
        end.iter_mut().for_each(|end| *end += first);
    }

    /// Moves the equations from `row` on to a new batch.
    pub fn split_off(&mut self, row: usize) -> Self {
        let mut all = self.equations();
        let last = all.split_off(row);
        *self = Self::from_equations(&all, range(&all));
        Self::from_equations(&last, range(&last))
    }

    fn equations(&self) -> Vec<(EquationOwner, LinearTerms, f64)> {
        let (mut all, mut k) = (Vec::with_capacity(self.rows()), 0);
        self.for_each_row(|terms| {
            all.push((self.owners[k], terms.collect(), self.rhs[k]));
            k += 1;
        });
        all
    }

    /// Builds a batch that also has room for DOFs between `least` and `most`.
    fn from_equations(all: &[(EquationOwner, LinearTerms, f64)], (least, most): (u32, u32)) -> Self {
        let (mut batch, mut recent, own) = (Self::empty(), CoefficientCache::default(), range(all));
        batch.set_range(least.min(own.0), most.max(own.1));
        all.iter().for_each(|(owner, terms, rhs)| batch.insert(batch.rows(), *owner, terms, *rhs, &mut recent));
        batch
    }

    fn rewrite(&mut self) {
        let all = self.equations();
        *self = Self::from_equations(&all, range(&all));
    }

    /// Rebuilds the batch with another base, or with 32 bits, if the DOFs of `terms` do not fit.
    fn reach(&mut self, terms: &[(u32, f64)]) {
        let (Some(&(least, _)), Some(&(most, _))) = (terms.first(), terms.last()) else { return };
        let far = matches!(self.lengths, RowsByLength::Far(_));
        if far || least >= self.base && ((most - self.base) as usize) < NEAR_DOFS {
            return;
        }
        if self.rows() == 0 {
            return self.set_range(least, most);
        }
        *self = Self::from_equations(&self.equations(), (least, most));
    }

    /// Chooses the base so that there is room below and above the range.
    fn set_range(&mut self, least: u32, most: u32) {
        let span = most.saturating_sub(least);
        if least > most {
            // No DOFs.
        } else if (span as usize) < NEAR_DOFS {
            self.base = least.saturating_sub((NEAR_DOFS as u32 - 1 - span) / 2);
        } else {
            (self.base, self.lengths) = (0, RowsByLength::Far(Vec::new()));
        }
    }

    /// Writes c of these equations.
    pub fn evaluate(&self, u: &[f64], c: &mut [f64]) {
        let (u, numbers) = (&u[self.base as usize..], self.numbers.as_slice());
        match (&self.lengths, u.first_chunk::<NEAR_DOFS>()) {
            // With a slice of known length, the compiler removes the bounds checks.
            (RowsByLength::Near(all), Some(u)) => each(all, numbers, |j| u[usize::from(j)], (&self.rhs, c)),
            (RowsByLength::Near(all), None) => each(all, numbers, |j| u[usize::from(j)], (&self.rhs, c)),
            (RowsByLength::Far(all), _) => each(all, numbers, |j| u[j as usize], (&self.rhs, c)),
        }
    }
}

#[inline]
fn each<I: Copy>(
    all: &[EqualLengthRows<I>],
    lists: &[f64],
    u: impl Fn(I) -> f64 + Copy,
    (rhs, c): (&[f64], &mut [f64]),
) {
    all.iter().for_each(|length| length.evaluate(lists, u, (rhs, c)));
}

/// The smallest and the largest DOF; `(u32::MAX, 0)` if there are no terms.
fn range(all: &[(EquationOwner, LinearTerms, f64)]) -> (u32, u32) {
    let dofs = all.iter().flat_map(|(_, terms, _)| terms).map(|&(j, _)| j);
    dofs.fold((u32::MAX, 0), |(least, most), j| (least.min(j), most.max(j)))
}

/// The group of equations with this many terms; it is added if it is missing.
fn group_of<I>(all: &mut Vec<EqualLengthRows<I>>, terms: usize) -> &mut EqualLengthRows<I> {
    let known = all.iter().position(|length| length.terms == terms);
    let place = known.unwrap_or(all.len());
    if known.is_none() {
        all.push(EqualLengthRows { terms, row: Vec::new(), list: Vec::new(), dofs: Vec::new() });
    }
    &mut all[place]
}
