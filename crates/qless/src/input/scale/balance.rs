//! The units of rows and DOFs in which coefficients are as equal as they can be.
//!
//! ```text
//! min over p, q   sum over coefficients   phi(log2 |c_ij| + p_i - q_j),   phi'(x) = x for x > 0, x / (1 - x) for x < 0
//! ```
//!
//! `p_i` and `q_j` are the exponents of row i and DOF j. The minimum is unique, apart from a constant for each component, and does not
//! depend on the user's units: `D1 C D2` has the same balanced coefficients. The pull `|phi'|` of a small coefficient is below 1, so a
//! 1e-159 that stands for zero moves no unit far. The minimum is found by reweighted least squares: each step solves `L p = f` with the
//! Laplacian of the graph of rows and DOFs.

use super::laplacian::{Edge, solve};

/// Largest number of reweighting steps. The iteration ends at the first step that changes no coefficient by a factor of two.
const MOST_STEPS: usize = 30;

/// Components of at least this many equations are first balanced by relaxation, which is enough if the user's units are consistent. Least
/// squares take milliseconds for a smaller component, and a quarter of a second for one of 10,000 equations.
const LARGE: usize = 1_000;
/// Largest number of relaxation passes. More are needed only if units differ between distant parts of the graph.
const MOST_PASSES: usize = 10;

/// Sweeps of equilibration. Each of the first sweeps halves the exponents by which norms differ from 1, and the others level the remainder.
const SWEEPS: usize = 30;

/// If the balanced units of all DOFs lie within this power of two, DOFs keep the user's units: a pivot is then above 1e-6 of its row, four
/// digits above the entries that a tolerance of 1e-10 drops.
const NEAR: f64 = 20.0;

/// Exponents of units stay below this, half of the range of exponents; the other half remains for the coefficients.
pub(crate) const RANGE: i32 = 512;

/// Bits of the significand of a double.
const BITS: f64 = 53.0;

/// The coefficients of one component, as base-2 logarithms of their magnitudes.
pub(crate) struct Component {
    /// The equations of the component.
    pub rows: Vec<u32>,
    /// The free DOFs of the component.
    pub dofs: Vec<u32>,
    /// The row (its place in `rows`) and DOF (its place in `dofs`) of each coefficient, and `log2 |c|`.
    entries: Vec<(u32, u32, f64)>,
}

impl Component {
    /// Gathers the terms `(DOF, coefficient)` of some equations; `place` is scratch space for all DOFs, with any content.
    pub fn gather<T: Iterator<Item = (usize, f64)>>(
        rows: Vec<u32>,
        terms: impl Fn(u32) -> T,
        place: &mut [u32],
    ) -> Self {
        let (mut dofs, mut entries): (Vec<u32>, _) = (Vec::new(), Vec::new());
        for (&i, row) in rows.iter().zip(0..) {
            for (j, v) in terms(i) {
                if dofs.get(place[j] as usize) != Some(&(j as u32)) {
                    place[j] = dofs.len() as u32;
                    dofs.push(j as u32);
                }
                entries.push((row, place[j], v.abs().log2()));
            }
        }
        Self { rows, dofs, entries }
    }

    /// For each DOF, the power of two that multiplies its column to reach balanced units, relative to the median DOF, so that most are 0.
    /// None if the powers differ by at most [`NEAR`]: the user's units then stay.
    pub fn units(&self) -> Option<Vec<i32>> {
        self.units_beyond(NEAR)
    }

    /// Where [`Self::units`] keeps the user's units, the balanced ones. They lie within [`NEAR`], except those of DOFs that have only what
    /// rounding left of coefficients; these DOFs keep the user's units.
    pub fn near_units(&self) -> Vec<i32> {
        // The user's units are near, so a few passes of relaxation are usually enough, and much cheaper than least squares.
        let found = self.relaxed().or_else(|| self.balanced(0.0));
        let near = |unit: i32| if f64::from(unit.abs()) <= NEAR { unit } else { 0 };
        found.map_or_else(Vec::new, |(q, _)| relative(&q)).into_iter().map(near).collect()
    }

    /// [`Self::units`] with another bound than [`NEAR`].
    pub fn units_beyond(&self, near: f64) -> Option<Vec<i32>> {
        Some(relative(&self.balanced(near)?.0))
    }

    /// Returns exponents of the DOFs in equilibrated units, in which rows and columns have about the same 2-norm. They are nearer to the
    /// user's units than balanced ones. But one large coefficient alone can give a column its norm, so that its other coefficients stay
    /// small beside those of their rows; `smallness` measures this. If balanced units are in range and have less than half of that
    /// smallness, they are returned instead. None if [`Component::equilibrated`] returns None.
    pub fn near_users(&self, near: i32) -> Option<Vec<i32>> {
        let equilibrated = self.equilibrated(near)?;
        let small = self.smallness(&equilibrated);
        let balanced = if small > 0.0 { self.units_beyond(0.0) } else { None };
        let is_in_range = |units: &[i32]| units.iter().all(|unit| unit.abs() < RANGE);
        let is_better = |units: &Vec<i32>| is_in_range(units) && self.smallness(units) < small / 2.0;
        Some(balanced.filter(is_better).unwrap_or(equilibrated))
    }

    /// Sum over coefficients: the bits by which a coefficient is below the largest of its row, as far as they exceed [`NEAR`]. No
    /// coefficient counts as more than 53 bits below.
    fn smallness(&self, col: &[i32]) -> f64 {
        let power = |&(_, j, power): &(u32, u32, f64)| power + f64::from(col[j as usize]);
        let of_row = |row: &[(u32, u32, f64)]| {
            let most = row.iter().map(power).fold(f64::NEG_INFINITY, f64::max);
            row.iter().map(|entry| ((most - power(entry)).min(BITS) - NEAR).max(0.0)).sum::<f64>()
        };
        self.entries.chunk_by(|a, b| a.0 == b.0).map(of_row).sum()
    }

    /// Exponents of the DOFs that give all rows and columns about the same 2-norm (Ruiz 2001), relative to the median, so that most are 0.
    /// Small coefficients hardly influence them. None if the exponents of all DOFs with at least two coefficients are within `near` of the
    /// median; for a large component, also if [`Component::is_led`] is true.
    pub fn equilibrated(&self, near: i32) -> Option<Vec<i32>> {
        let (mut row, mut col) = (vec![0.0; self.rows.len()], vec![0.0; self.dofs.len()]);
        let mut count = vec![0; col.len()];
        self.entries.iter().for_each(|&(_, j, _)| count[j as usize] += 1);
        if row.len() >= LARGE && self.is_led(near, &count) {
            return None;
        }
        for left in (0..SWEEPS).rev() {
            let (mut of_row, mut of_col) = (vec![Sum::ZERO; row.len()], vec![Sum::ZERO; col.len()]);
            for &(i, j, power) in &self.entries {
                let (i, j) = (i as usize, j as usize);
                let squared = 2.0 * (power + row[i] + col[j]);
                of_row[i].add(squared);
                of_col[j].add(squared);
            }
            let mut most = 0.0_f64;
            for (exponent, sum) in row.iter_mut().zip(of_row).chain(col.iter_mut().zip(of_col)) {
                let change = sum.power() / 4.0;
                *exponent -= change;
                most = most.max(change.abs());
            }
            // If all norms are between 1 / t and t, they stay so: a squared norm is divided by its own norm and by norms of the other side.
            // So no later sweep changes an exponent by more than this one did, nor the median.
            let reach = 2.0 * most * left as f64;
            let usual = median(&col);
            if col.iter().all(|col| (col - usual).abs() + reach < f64::from(near)) {
                return None;
            }
        }
        let usual = median(&col);
        let units: Vec<i32> = col.iter().map(|col| (col - usual).round() as i32).collect();
        units.iter().zip(count).any(|(unit, count)| count > 1 && unit.abs() > near).then_some(units)
    }

    /// Returns true if each DOF with at least two coefficients has one that is at least `2^-near` of the largest of its equation.
    fn is_led(&self, near: i32, count: &[i32]) -> bool {
        let mut largest = vec![f64::NEG_INFINITY; count.len()];
        for row in self.entries.chunk_by(|a, b| a.0 == b.0) {
            let most = row.iter().fold(f64::NEG_INFINITY, |most, entry| most.max(entry.2));
            row.iter().for_each(|&(_, j, power)| largest[j as usize] = largest[j as usize].max(power - most));
        }
        largest.iter().zip(count).all(|(&largest, &count)| count < 2 || largest >= -f64::from(near))
    }

    /// Calls `job` with the place of each row and the base-2 logarithms of its balanced coefficients.
    pub fn balanced_rows(&self, mut job: impl FnMut(usize, &[f64])) {
        let Some((_, powers)) = self.balanced(-1.0) else { return };
        let mut first = 0;
        for row in self.entries.chunk_by(|a, b| a.0 == b.0) {
            job(row[0].0 as usize, &powers[first..first + row.len()]);
            first += row.len();
        }
    }

    /// Calls `job(i, p_i)` once for each coefficient, for row i of `rows` and the exponent of the factor `2^p_i` that brings this row to
    /// balanced units.
    pub fn row_units(&self, mut job: impl FnMut(usize, f64)) {
        let Some((q, powers)) = self.balanced(-1.0) else { return };
        for (&(i, j, power), balanced) in self.entries.iter().zip(powers) {
            job(i as usize, balanced - power + q[j as usize]);
        }
    }

    /// The exponent q of each DOF, and log2 of each balanced coefficient; None if the largest and the smallest q differ by at most `near`.
    fn balanced(&self, near: f64) -> Option<(Vec<f64>, Vec<f64>)> {
        let m = self.rows.len();
        if m >= LARGE
            && let Some((q, powers)) = self.relaxed()
        {
            return (range(&q) > near).then_some((q, powers));
        }
        let mut powers: Vec<f64> = self.entries.iter().map(|&(_, _, power)| power).collect();
        let mut q = vec![0.0; self.dofs.len()];
        let mut edges: Vec<Edge> =
            self.entries.iter().map(|&(i, j, _)| Edge { ends: [i, m as u32 + j], weight: 1.0 }).collect();
        for _ in 0..MOST_STEPS {
            let p = solve(&edges, &self.pull(&powers, &edges));
            let mut most = 0.0_f64;
            for ((power, edge), &(i, j, _)) in powers.iter_mut().zip(&mut edges).zip(&self.entries) {
                let change = p[i as usize] - p[m + j as usize];
                *power += change;
                most = most.max(change.abs());
                edge.weight = weight(*power);
            }
            q.iter_mut().zip(&p[m..]).for_each(|(q, p)| *q += p);
            if range(&q) <= near {
                return None;
            }
            if most < 1.0 {
                break;
            }
        }
        Some((q, powers))
    }

    /// Balances by relaxation, over one row or DOF after the other, starting from the user's units. Returns q and the coefficients as in
    /// [`Component::balanced`] once no row and no DOF moves by a power of two; None if this takes more than [`MOST_PASSES`].
    fn relaxed(&self) -> Option<(Vec<f64>, Vec<f64>)> {
        let (mut p, mut q) = (vec![0.0; self.rows.len()], vec![0.0; self.dofs.len()]);
        for pass in 0..MOST_PASSES {
            let mut of_dof = vec![Mean::default(); q.len()];
            let mut most = 0.0_f64;
            for row in self.entries.chunk_by(|a, b| a.0 == b.0) {
                let p = &mut p[row[0].0 as usize];
                let power = |&(_, j, power): &(u32, u32, f64)| power - q[j as usize];
                let start = if pass == 0 { -row.iter().map(power).fold(f64::NEG_INFINITY, f64::max) } else { *p };
                let mut mean = Mean::default();
                row.iter().for_each(|entry| mean.add(power(entry) + start));
                *p = start - mean.value();
                row.iter().for_each(|entry| of_dof[entry.1 as usize].add(power(entry) + *p));
                most = most.max(mean.value().abs());
            }
            for (q, mean) in q.iter_mut().zip(&of_dof) {
                *q += mean.value();
                most = most.max(mean.value().abs());
            }
            if most < 1.0 {
                let balanced = |&(i, j, power): &(u32, u32, f64)| power + p[i as usize] - q[j as usize];
                return Some((q.clone(), self.entries.iter().map(balanced).collect()));
            }
        }
        None
    }

    /// `f = -sum_e w_e x_e (delta_i - delta_j)` over the coefficients e = (i, j), with weights `w_e`, powers `x_e` and unit vectors
    /// `delta`.
    fn pull(&self, powers: &[f64], edges: &[Edge]) -> Vec<f64> {
        let mut f = vec![0.0; self.rows.len() + self.dofs.len()];
        for (power, &Edge { ends: [a, b], weight }) in powers.iter().zip(edges) {
            f[a as usize] -= weight * power;
            f[b as usize] += weight * power;
        }
        f
    }
}

/// The weight `phi'(x) / x` of a coefficient `2^x` in least squares; phi is the penalty for its distance from 1.
fn weight(power: f64) -> f64 {
    if power > 0.0 { 1.0 } else { 1.0 / (1.0 - power) }
}

/// A weighted mean of powers.
#[derive(Clone, Copy, Default)]
struct Mean {
    sum: f64,
    weight: f64,
}

impl Mean {
    fn add(&mut self, power: f64) {
        let weight = weight(power);
        self.sum += weight * power;
        self.weight += weight;
    }

    fn value(self) -> f64 {
        if self.weight > 0.0 { self.sum / self.weight } else { 0.0 }
    }
}

/// The sum of numbers `2^power`, which is itself given as a power of two.
#[derive(Clone, Copy)]
struct Sum {
    /// The largest power that was added.
    most: f64,
    /// The sum divided by `2^most`.
    sum: f64,
}

impl Sum {
    const ZERO: Self = Self { most: f64::NEG_INFINITY, sum: 0.0 };

    fn add(&mut self, power: f64) {
        if power <= self.most {
            self.sum += (power - self.most).exp2();
        } else {
            self.sum = self.sum * (self.most - power).exp2() + 1.0;
            self.most = power;
        }
    }

    /// The power of the sum; 0 if nothing was added.
    fn power(self) -> f64 {
        if self.sum > 0.0 { self.most + self.sum.log2() } else { 0.0 }
    }
}

/// For each DOF, the power of two that multiplies its column, relative to the median.
fn relative(q: &[f64]) -> Vec<i32> {
    let usual = median(q);
    q.iter().map(|q| (usual - q).round() as i32).collect()
}

fn range(q: &[f64]) -> f64 {
    let (least, most) = q.iter().fold((f64::MAX, f64::MIN), |(least, most), &q| (least.min(q), most.max(q)));
    most - least
}

fn median(x: &[f64]) -> f64 {
    let mut sorted = x.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.get(x.len() / 2).copied().unwrap_or_default()
}
