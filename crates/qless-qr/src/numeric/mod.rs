//! Numeric factorization: computes R and `Q^T B` from the values, front by front.

mod contribution;
mod front;
mod result;
mod tasks;

use crate::staircase::scaled_norm;
use crate::{Error, Factor, Options, Symbolic, Tolerance};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

impl Symbolic {
    /// Factors the matrix with this pattern and the given values, and computes `Q^T B` (`rhs` is B, m x k by columns, or empty).
    ///
    /// [`Options`] set the tolerance for dependent columns, the memory limit, and whether Q is kept. The forecast is checked against the
    /// limit before any allocation; memory beyond the forecast is checked before each front. The factorization runs on the calling thread's
    /// rayon pool. The result is the same to the last bit for every number of threads.
    ///
    /// One analysis serves any number of matrices with its pattern:
    ///
    /// ```
    /// use qless_qr::{Options, Symbolic};
    /// let symbolic = Symbolic::analyse(2, 2, &[0, 2, 3], &[0, 1, 1])?;
    /// for scale in [1.0, 2.0] {
    ///     let (values, b) = ([3.0 * scale, 4.0, 5.0], [3.0 * scale, 9.0]);
    ///     let x = symbolic.factor(&values, &b, Options::new())?.basic()?;
    ///     assert!((x[0] - 1.0).abs() < 1e-14 && (x[1] - 1.0).abs() < 1e-14);
    /// }
    /// # Ok::<(), qless_qr::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Length`], [`Error::Tolerance`], [`Error::NotFinite`], [`Error::Overflow`], [`Error::OutOfMemory`] or
    /// [`Error::Ordering`].
    pub fn factor(&self, values: &[f64], rhs: &[f64], options: Options) -> Result<Factor, Error> {
        let values = &*self.gathered(values)?;
        let numbers = checked(self, values, rhs, options)?;
        let (tolerance, limit) = (numbers.tolerance, options.memory);
        let is_live = |entry: usize| values[entry].abs() > tolerance;
        let diagonal = |i: usize| self.entry[self.pattern.start[i]] as usize;
        let result = if (0..self.peeled).map(diagonal).all(is_live) {
            run(self, &numbers, limit)
        } else {
            // The value of a peeled column is so small that the column is dependent. So analyse again, and peel only entries above the
            // tolerance.
            run(&crate::symbolic::analyse(self.rows, &self.columns(), &is_live)?, &numbers, limit)
        };
        result.map(|(factor, _)| factor)
    }
}

/// The input of one factorization.
#[derive(Clone, Copy)]
pub(crate) struct FactorInput<'a> {
    pub values: &'a [f64],
    /// The right-hand sides B, m x k by columns.
    pub rhs: &'a [f64],
    pub count: usize,
    pub tolerance: f64,
    pub keep_q: bool,
}

/// Returns the factor and the largest number of bytes held at once.
fn run(symbolic: &Symbolic, numbers: &FactorInput, limit: usize) -> Result<(Factor, usize), Error> {
    let of_q = if numbers.keep_q { symbolic.memory_of_q() } else { 0 };
    let needed = symbolic.memory(numbers.count).saturating_add(of_q);
    if needed > limit {
        return Err(Error::OutOfMemory { needed, limit });
    }
    let ledger = MemoryLedger::new(limit);
    let slots = tasks::run(symbolic, numbers, &ledger)?;
    let factor = result::collect(symbolic, numbers, slots, &ledger)?;
    Ok((factor, ledger.most()))
}

fn checked<'a>(
    symbolic: &Symbolic,
    values: &'a [f64],
    rhs: &'a [f64],
    options: Options,
) -> Result<FactorInput<'a>, Error> {
    let count = rhs.len().checked_div(symbolic.rows).unwrap_or(0);
    if count * symbolic.rows != rhs.len() {
        return Err(Error::Length { what: "rhs", found: rhs.len(), expected: symbolic.rows });
    }
    for (what, numbers) in [("the matrix", values), ("the right-hand side", rhs)] {
        if !numbers.iter().all(|v| v.is_finite()) {
            return Err(Error::NotFinite(what));
        }
    }
    let tolerance = options.tolerance.distance(symbolic, values)?;
    Ok(FactorInput { values, rhs, count, tolerance, keep_q: options.keep_q })
}

/// Bytes held by all threads of one factorization, counted before they are allocated: `held <= limit`.
pub(super) struct MemoryLedger {
    held: AtomicUsize,
    most: AtomicUsize,
    limit: usize,
}

impl MemoryLedger {
    pub fn new(limit: usize) -> Self {
        Self { held: AtomicUsize::new(0), most: AtomicUsize::new(0), limit }
    }

    pub fn limit(&self) -> usize {
        self.limit
    }

    /// Adds bytes; an error if the limit is exceeded.
    pub fn take(&self, bytes: usize) -> Result<(), Error> {
        let needed = self.held.fetch_add(bytes, Relaxed).saturating_add(bytes);
        self.most.fetch_max(needed, Relaxed);
        if needed > self.limit { Err(Error::OutOfMemory { needed, limit: self.limit }) } else { Ok(()) }
    }

    /// Peak of the bytes held.
    pub fn most(&self) -> usize {
        self.most.load(Relaxed)
    }

    pub fn give(&self, bytes: usize) {
        self.held.fetch_sub(bytes, Relaxed);
    }

    /// Allocates an empty array of the given capacity; an error if the allocation fails.
    pub fn reserve<T>(&self, length: usize) -> Result<Vec<T>, Error> {
        let mut values = Vec::new();
        let failed = |_| Error::OutOfMemory { needed: length.saturating_mul(size_of::<T>()), limit: self.limit };
        values.try_reserve_exact(length).map_err(failed)?;
        Ok(values)
    }
}

impl Tolerance {
    /// The tolerance as a limit for 2-norms of columns, for a matrix with these values; infinite if it overflows.
    pub(crate) fn distance(self, symbolic: &Symbolic, values: &[f64]) -> Result<f64, Error> {
        let factor = match self {
            Self::Absolute(distance) => return valid_tolerance(distance),
            Self::Scaled(factor) => valid_tolerance(factor)?,
            Self::Relative => 20.0 * (symbolic.rows + symbolic.cols) as f64 * f64::EPSILON,
        };
        Ok(factor * largest_column(symbolic, values))
    }
}

fn valid_tolerance(distance: f64) -> Result<f64, Error> {
    if distance.is_nan() || distance < 0.0 { Err(Error::Tolerance(distance)) } else { Ok(distance) }
}

/// The largest 2-norm `|a_j|` of a column, at most [`f64::MAX`].
fn largest_column(symbolic: &Symbolic, values: &[f64]) -> f64 {
    let mut square = vec![0.0; symbolic.cols];
    for (&column, &entry) in symbolic.pattern.index.iter().zip(&symbolic.entry) {
        square[column as usize] += values[entry as usize] * values[entry as usize];
    }
    let largest = square.iter().copied().fold(0.0, f64::max);
    if largest > 1e-280 && largest < 1e280 {
        return largest.sqrt();
    }
    let mut columns = vec![Vec::new(); symbolic.cols];
    for (&column, &entry) in symbolic.pattern.index.iter().zip(&symbolic.entry) {
        columns[column as usize].push(values[entry as usize]);
    }
    columns.iter().map(|column| scaled_norm(column)).fold(0.0, f64::max).min(f64::MAX)
}

#[cfg(test)]
mod tests {
    use super::{FactorInput, run};
    use crate::Symbolic;

    /// A pseudorandom number below n (xorshift).
    fn below(state: &mut u64, n: u64) -> u64 {
        *state ^= *state << 13;
        *state ^= *state >> 7;
        *state ^= *state << 17;
        (*state >> 33) % n
    }

    fn random(seed: u64) -> (Symbolic, Vec<f64>, usize) {
        let mut state = (seed + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        let (rows, cols) = (below(&mut state, 60) as usize, below(&mut state, 60) as usize);
        let density = 1 + below(&mut state, 30);
        let (mut start, mut index) = (vec![0], Vec::new());
        for _ in 0..cols {
            index.extend((0..rows as u32).filter(|_| below(&mut state, 100) < density));
            start.push(index.len());
        }
        let values = index.iter().map(|_| 0.5 + below(&mut state, 1000) as f64).collect();
        (Symbolic::analyse(rows, cols, &start, &index).expect("a pattern"), values, rows)
    }

    #[test]
    fn bookings_stay_within_the_forecast() {
        for seed in 0..300 {
            let (symbolic, values, rows) = random(seed);
            let rhs = vec![1.0; 2 * rows];
            let count = if rows == 0 { 0 } else { 2 };
            let numbers = |tolerance| FactorInput { values: &values, rhs: &rhs, count, tolerance, keep_q: false };
            let (_, most) = run(&symbolic, &numbers(0.0), usize::MAX).expect("a factorization");
            assert!(most <= symbolic.memory(count), "seed {seed}: {most} of {}", symbolic.memory(count));
            let (_, most) =
                run(&symbolic, &FactorInput { keep_q: true, ..numbers(0.0) }, usize::MAX).expect("a factorization");
            let foreseen = symbolic.memory(count) + symbolic.memory_of_q();
            assert!(most <= foreseen, "seed {seed}: {most} of {foreseen} with Q");
            for tolerance in [100.0, 700.0, 1e4] {
                let (_, most) = run(&symbolic, &numbers(tolerance), usize::MAX).expect("a factorization");
                let worst = symbolic.memory_at_worst(count);
                assert!(most <= worst, "seed {seed}: {most} of {worst}");
            }
        }
    }
}
