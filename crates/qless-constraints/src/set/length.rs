//! Equations of one length: changes of them, and the loop over them.

use super::batch::Length;

/// Terms of an equation for many of which room is made before they come.
const SHORT: usize = 16;

/// A DOF less the base of a batch, in 16 or 32 bits.
pub trait Offset: Copy {
    fn of(offset: u32) -> Self;
    fn value(self) -> u32;
}

impl Offset for u16 {
    fn of(offset: u32) -> Self {
        offset as Self
    }
    fn value(self) -> u32 {
        self.into()
    }
}

impl Offset for u32 {
    fn of(offset: u32) -> Self {
        offset
    }
    fn value(self) -> u32 {
        self
    }
}

impl<I: Offset> Length<I> {
    /// Rows from `row` on follow so much later.
    pub fn shift(&mut self, row: usize, by: u16) {
        self.row.iter_mut().for_each(|r| *r += if usize::from(*r) >= row { by } else { 0 });
    }

    /// Puts in an equation whose row is free.
    pub fn insert(&mut self, row: usize, list: u32, dofs: impl Iterator<Item = u32>) {
        let behind = self.row.last().is_none_or(|&last| usize::from(last) < row);
        let place = if behind { self.row.len() } else { self.row.partition_point(|&r| usize::from(r) < row) };
        self.row.insert(place, row as u16);
        self.list.insert(place, list);
        let first = place * self.terms;
        if first == self.dofs.len() {
            self.dofs.extend(dofs.map(I::of));
        } else {
            self.dofs.splice(first..first, dofs.map(I::of));
        }
    }

    /// Takes an equation out if it is one of these; those after it move up.
    pub fn remove(&mut self, row: usize) {
        if let Ok(place) = self.row.binary_search(&(row as u16)) {
            self.row.remove(place);
            self.list.remove(place);
            self.dofs.drain(place * self.terms..(place + 1) * self.terms);
        }
        self.row.iter_mut().for_each(|r| *r -= u16::from(usize::from(*r) > row));
    }

    /// DOFs and coefficients of one of them.
    pub fn terms<'a>(&'a self, place: usize, base: u32, lists: &'a [f64]) -> impl Iterator<Item = (u32, f64)> + 'a {
        let dofs = &self.dofs[place * self.terms..(place + 1) * self.terms];
        dofs.iter().zip(&lists[self.list[place] as usize..]).map(move |(&j, &v)| (base + j.value(), v))
    }
}

impl<I: Offset> Length<I> {
    /// Writes columns and coefficients of the rows of these, which end where `end` says.
    pub fn write_rows(&self, (base, lists): (u32, &[f64]), end: &[usize], col: &mut [u32], val: &mut [f64]) {
        for (i, (&row, &list)) in self.row.iter().zip(&self.list).enumerate() {
            let last = end[usize::from(row)];
            let dofs = &self.dofs[i * self.terms..(i + 1) * self.terms];
            col[last - self.terms..last].iter_mut().zip(dofs).for_each(|(col, dof)| *col = base + dof.value());
            val[last - self.terms..last].copy_from_slice(&lists[list as usize..][..self.terms]);
        }
    }

    /// Room for rows up to so many, if they are short.
    pub fn reserve(&mut self, rows: usize) {
        if self.terms <= SHORT {
            self.row.reserve_exact(rows);
            self.list.reserve_exact(rows);
            self.dofs.reserve_exact(rows * self.terms);
        }
    }
}

impl<I: Copy> Length<I> {
    #[inline]
    pub fn evaluate(&self, lists: &[f64], u: impl Fn(I) -> f64 + Copy, (rhs, c): (&[f64], &mut [f64])) {
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
