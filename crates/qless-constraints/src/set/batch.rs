//! `c_i = sum_t a_it u_it - b_i` for up to [`ROWS`] equations, those of equal length together.
//!
//! The inner loop then has a length that the compiler knows, and no branch that nobody can predict. The lists `a_i` are kept
//! apart, equal neighbours once: in ties and periodic cells most of them repeat, and what is not read costs nothing. DOFs are counted
//! from the smallest of the batch, in 16 bits where that is enough, as in any model whose numbers follow its shape.

use super::lists::Lists;

/// Equations per task: their places fit into 16 bits, their values into the nearest cache.
pub const ROWS: usize = 4096;
/// The DOFs that 16 bits can name.
const NEAR: usize = 1 << 16;

/// An equation on its way into a batch.
pub type Equation<'a> = (&'a [(u32, f64)], f64);

/// Up to [`ROWS`] equations that follow one another.
pub struct Batch {
    /// The smallest DOF.
    base: u32,
    /// b, apart from the lists: it may change.
    pub rhs: Vec<f64>,
    lengths: Lengths,
}

/// DOFs in 16 or 32 bits.
enum Lengths {
    Near(Vec<Length<u16>>),
    Far(Vec<Length<u32>>),
}

/// The equations of one length.
struct Length<I> {
    terms: usize,
    /// Places in the batch.
    row: Vec<u16>,
    /// Where the list of each starts.
    list: Vec<u32>,
    /// DOFs less the smallest of the batch, one row after the other.
    dofs: Vec<I>,
}

impl Batch {
    /// At most [`ROWS`] equations.
    pub fn new(equations: &[Equation], lists: &mut Lists) -> Self {
        let dofs = || equations.iter().flat_map(|(terms, _)| terms.iter().map(|&(dof, _)| dof));
        let base = dofs().min().unwrap_or(0);
        let span = (dofs().max().unwrap_or(0) - base) as usize;
        let lengths = if span < NEAR {
            Lengths::Near(lengths(equations, lists, |dof| (dof - base) as u16))
        } else {
            Lengths::Far(lengths(equations, lists, |dof| dof - base))
        };
        let rhs = equations.iter().map(|&(_, rhs)| rhs).collect();
        Self { base, rhs, lengths }
    }

    /// A DOF that they hold.
    pub fn first_dof(&self) -> u32 {
        self.base
    }

    /// Writes c of these equations.
    pub fn evaluate(&self, lists: &[f64], u: &[f64], c: &mut [f64]) {
        let u = &u[self.base as usize..];
        match (&self.lengths, u.first_chunk::<NEAR>()) {
            // No place has to be checked.
            (Lengths::Near(all), Some(u)) => each(all, lists, |j| u[usize::from(j)], (&self.rhs, c)),
            (Lengths::Near(all), None) => each(all, lists, |j| u[usize::from(j)], (&self.rhs, c)),
            (Lengths::Far(all), _) => each(all, lists, |j| u[j as usize], (&self.rhs, c)),
        }
    }
}

#[inline]
fn each<I: Copy>(all: &[Length<I>], lists: &[f64], u: impl Fn(I) -> f64 + Copy, (rhs, c): (&[f64], &mut [f64])) {
    all.iter().for_each(|length| length.evaluate(lists, u, (rhs, c)));
}

fn lengths<I>(equations: &[Equation], lists: &mut Lists, dof: impl Fn(u32) -> I) -> Vec<Length<I>> {
    let mut all: Vec<Length<I>> = Vec::new();
    for (row, &(terms, _)) in equations.iter().enumerate() {
        let known = all.iter().position(|length| length.terms == terms.len());
        let place = known.unwrap_or(all.len());
        if known.is_none() {
            all.push(Length { terms: terms.len(), row: Vec::new(), list: Vec::new(), dofs: Vec::new() });
        }
        let length = &mut all[place];
        length.row.push(row as u16);
        length.list.push(lists.put(terms.iter().map(|&(_, v)| v)));
        length.dofs.extend(terms.iter().map(|&(j, _)| dof(j)));
    }
    all
}

impl<I: Copy> Length<I> {
    #[inline]
    fn evaluate(&self, lists: &[f64], u: impl Fn(I) -> f64 + Copy, (rhs, c): (&[f64], &mut [f64])) {
        match self.terms {
            1 => self.fixed::<1>(lists, u, (rhs, c)),
            2 => self.fixed::<2>(lists, u, (rhs, c)),
            3 => self.fixed::<3>(lists, u, (rhs, c)),
            4 => self.fixed::<4>(lists, u, (rhs, c)),
            5 => self.fixed::<5>(lists, u, (rhs, c)),
            6 => self.fixed::<6>(lists, u, (rhs, c)),
            7 => self.fixed::<7>(lists, u, (rhs, c)),
            8 => self.fixed::<8>(lists, u, (rhs, c)),
            9 => self.fixed::<9>(lists, u, (rhs, c)),
            _ => self.any(lists, u, (rhs, c)),
        }
    }

    #[inline]
    fn fixed<const N: usize>(&self, lists: &[f64], u: impl Fn(I) -> f64, (rhs, c): (&[f64], &mut [f64])) {
        let (dofs, _) = self.dofs.as_chunks::<N>();
        for ((&row, &list), dofs) in self.row.iter().zip(&self.list).zip(dofs) {
            let list = &lists[list as usize..][..N];
            let mut sum = 0.0;
            (0..N).for_each(|t| sum += list[t] * u(dofs[t]));
            c[row as usize] = sum - rhs[row as usize];
        }
    }

    fn any(&self, lists: &[f64], u: impl Fn(I) -> f64, (rhs, c): (&[f64], &mut [f64])) {
        for (i, (&row, &list)) in self.row.iter().zip(&self.list).enumerate() {
            let list = &lists[list as usize..][..self.terms];
            let dofs = &self.dofs[i * self.terms..(i + 1) * self.terms];
            let sum: f64 = dofs.iter().zip(list).map(|(&j, v)| v * u(j)).sum();
            c[row as usize] = sum - rhs[row as usize];
        }
    }
}
