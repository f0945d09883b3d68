//! Assembles elements directly into the condensed matrix, without K: `K_q += L_e^T K_e L_e`, `f_q += L_e^T (f_e - K_e u_0)`. `K_e` and
//! `f_e` are the matrix and the forces of element e, and `L_e` holds the rows of L of its DOFs.

use std::ops::Range;

use rayon::prelude::*;

use super::values::line_ranges;
use super::{CondensedPattern, NONE, PrescribedDofs};
use crate::ArgumentError;
use crate::common::argument::{long, numbers, within};
use crate::elimination::view::{Storage, View};
use crate::elimination::{Elimination, EliminationError};

/// A range of lines (rows or columns) of K_q, with the entries of f_q that belong to it.
struct LineRange<'a> {
    lines: Range<usize>,
    values: &'a mut [f64],
    load: &'a mut [f64],
}

impl Elimination {
    /// The pattern of K_q by rows for the elements of a model; element e has DOFs `dofs(e)`.
    ///
    /// ```
    /// use qless::{Elimination, Options, SystemBuilder};
    /// use qless::elimination::{PrescribedDofs, Storage};
    /// // A chain of springs whose ends are tied together; K is never assembled.
    /// let mut builder = SystemBuilder::new(4);
    /// builder.equation([(3, 1.0), (0, -1.0)], 0.0);
    /// builder.prescribe(1, 1.0);
    /// let elimination = Elimination::new(&builder.build()?, &Options::default())?;
    /// let dofs = |e: usize| vec![e, e + 1];
    /// let condensed = elimination.condensed_for_elements(3, dofs, Storage::Lower, PrescribedDofs::Eliminated)?;
    /// let (mut k_q, mut f_q) = (vec![0.0; condensed.nnz()], vec![0.0; condensed.unknowns()]);
    /// condensed.assemble(&elimination, 3, dofs, &mut k_q, &mut f_q, |_, matrix, _| {
    ///     matrix.copy_from_slice(&[1.0, -1.0, -1.0, 1.0]);
    /// })?;
    /// assert_eq!((k_q, f_q), (vec![2.0, -1.0, 2.0], vec![1.0, 1.0]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`EliminationError::Argument`] for a DOF that is out of range.
    pub fn condensed_for_elements<D: AsRef<[usize]>>(
        &self,
        elements: usize,
        dofs: impl Fn(usize) -> D,
        storage: Storage,
        prescribed: PrescribedDofs,
    ) -> Result<CondensedPattern, EliminationError> {
        let (starts, index) = pattern(self.dofs(), elements, dofs, storage)?;
        self.condensed(View::rows(&starts, &index).storing(storage), prescribed)
    }
}

/// The pattern of K: pairs of DOFs that share an element.
fn pattern<D: AsRef<[usize]>>(
    n: usize,
    elements: usize,
    dofs: impl Fn(usize) -> D,
    storage: Storage,
) -> Result<(Vec<usize>, Vec<u32>), ArgumentError> {
    let mut first = vec![0_usize; n + 1];
    for e in 0..elements {
        for &j in dofs(e).as_ref() {
            within("DOF", j, n)?;
            first[j + 1] += 1;
        }
    }
    (0..n).for_each(|j| first[j + 1] += first[j]);
    let (mut next, mut of_dof) = (first.clone(), vec![0_u32; first[n]]);
    for e in 0..elements {
        for &j in dofs(e).as_ref() {
            of_dof[next[j]] = e as u32;
            next[j] += 1;
        }
    }
    let (mut starts, mut index, mut seen) = (vec![0], Vec::new(), vec![NONE; n]);
    for i in 0..n {
        let line = index.len();
        for &e in &of_dof[first[i]..first[i + 1]] {
            for &j in dofs(e as usize).as_ref() {
                if storage.holds(i, j) && seen[j] != i as u32 {
                    seen[j] = i as u32;
                    index.push(j as u32);
                }
            }
        }
        index[line..].sort_unstable();
        starts.push(index.len());
    }
    Ok((starts, index))
}

/// One element: its DOFs, its matrix `K_e` and its forces `f_e`.
struct Element<'a> {
    dofs: &'a [usize],
    /// `K_e`, stored by rows.
    matrix: &'a [f64],
    forces: &'a [f64],
}

impl CondensedPattern {
    /// Condenses the matrix `K_e` (by rows) and the forces `f_e` of an element with these DOFs, and adds them to K_q and f_q. If K_q is
    /// symmetric, only its stored half is written.
    ///
    /// # Errors
    /// [`ArgumentError`] for wrong lengths, a DOF that is out of range, numbers that are not finite, an elimination that did not make this
    /// pattern, or an entry that is not in the pattern; K_q and f_q are then invalid.
    pub fn add_element(
        &self,
        elimination: &Elimination,
        dofs: &[usize],
        (matrix, forces): (&[f64], &[f64]),
        k_q: &mut [f64],
        f_q: &mut [f64],
    ) -> Result<(), ArgumentError> {
        self.check(elimination, k_q.len())?;
        long("the list of forces on unknowns", f_q.len(), self.unknowns())?;
        let element = self.checked(Element { dofs, matrix, forces })?;
        self.add(elimination, &element, &mut LineRange { lines: 0..self.unknowns(), values: k_q, load: f_q })
    }

    /// Computes `K_q` and `f_q` from all elements. Element e has DOFs `dofs(e)`, and `element(e, matrix, forces)` writes its matrix and
    /// forces to arrays of zeros. Each thread computes a range of rows of K_q, or of columns if K is stored by columns, from the elements
    /// that contribute to it. An element that contributes to several ranges is computed once by each of their threads. Elements are added
    /// in their order, so the result is the same to the last bit for every number of threads.
    ///
    /// # Errors
    /// As [`CondensedPattern::add_element`].
    pub fn assemble<D: AsRef<[usize]>>(
        &self,
        elimination: &Elimination,
        elements: usize,
        dofs: impl Fn(usize) -> D + Sync,
        k_q: &mut [f64],
        f_q: &mut [f64],
        element: impl Fn(usize, &mut [f64], &mut [f64]) + Sync,
    ) -> Result<(), ArgumentError> {
        self.check(elimination, k_q.len())?;
        long("the list of forces on unknowns", f_q.len(), self.unknowns())?;
        k_q.fill(0.0);
        f_q.fill(0.0);
        let mut ranges = Vec::new();
        let mut load = f_q;
        for (lines, values) in line_ranges(&self.lines.starts, k_q, rayon::current_num_threads()) {
            let (own, rest) = load.split_at_mut(lines.len());
            load = rest;
            ranges.push(LineRange { lines, values, load: own });
        }
        let all = |mut range: LineRange| {
            let (mut matrix, mut forces) = (Vec::new(), Vec::new());
            (0..elements).try_for_each(|e| {
                let dofs = dofs(e);
                let dofs = dofs.as_ref();
                dofs.iter().try_for_each(|&j| within("DOF", j, self.number.len()))?;
                if !dofs.iter().any(|&j| self.touches(j, &range.lines)) {
                    return Ok(());
                }
                matrix.clear();
                matrix.resize(dofs.len() * dofs.len(), 0.0);
                forces.clear();
                forces.resize(dofs.len(), 0.0);
                element(e, &mut matrix, &mut forces);
                self.add(elimination, &self.checked(Element { dofs, matrix: &matrix, forces: &forces })?, &mut range)
            })
        };
        ranges.into_par_iter().map(all).reduce(|| Ok(()), Result::and)
    }

    fn checked<'a>(&self, element: Element<'a>) -> Result<Element<'a>, ArgumentError> {
        let count = element.dofs.len();
        element.dofs.iter().try_for_each(|&j| within("DOF", j, self.number.len()))?;
        numbers("the list of forces of an element", element.forces, count)?;
        numbers("the matrix of an element", element.matrix, count * count)?;
        Ok(element)
    }

    /// Returns true if DOF j contributes to one of these lines of K_q.
    fn touches(&self, j: usize, lines: &Range<usize>) -> bool {
        self.row_of_l(j).any(|(r, _)| lines.contains(&(r as usize)))
    }

    fn add(&self, elimination: &Elimination, element: &Element, range: &mut LineRange) -> Result<(), ArgumentError> {
        let Element { dofs, matrix, forces } = *element;
        for (a, &i) in dofs.iter().enumerate() {
            let row = &matrix[a * dofs.len()..(a + 1) * dofs.len()];
            let moved: f64 = dofs.iter().zip(row).map(|(&j, v)| v * self.shift(elimination, j)).sum();
            for (q, weight) in self.row_of_l(i).map(|(q, weight)| (q as usize, weight)) {
                if range.lines.contains(&q) {
                    let load = &mut range.load[q - range.lines.start];
                    *load += weight * (forces[a] - moved);
                    if !load.is_finite() {
                        return Err(ArgumentError::Overflow { what: "f_q", place: q });
                    }
                    self.add_row(q, weight, dofs, row, range)?;
                }
            }
        }
        Ok(())
    }

    /// `K_q(q, :) += weight row L`, where `row` is a row of the matrix of an element.
    fn add_row(
        &self,
        q: usize,
        weight: f64,
        dofs: &[usize],
        row: &[f64],
        range: &mut LineRange,
    ) -> Result<(), ArgumentError> {
        let (line, base) = (self.lines.range(q), self.lines.starts[range.lines.start] as usize);
        let index = &self.lines.index[line.clone()];
        let values = &mut range.values[line.start - base..line.end - base];
        // The DOFs of a node are adjacent, so the place after the previous entry is usually right and saves a search.
        let mut next = 0;
        for (&j, &v) in dofs.iter().zip(row) {
            for (r, l) in self.row_of_l(j).filter(|&(r, _)| self.is_stored(q, r)) {
                let place = match index.get(next) {
                    Some(&found) if found == r => next,
                    _ => index.binary_search(&r).map_err(|_| ArgumentError::NotInPattern { dof: j })?,
                };
                values[place] += weight * v * l;
                if !values[place].is_finite() {
                    return Err(ArgumentError::Overflow { what: "K_q", place: line.start + place });
                }
                next = place + 1;
            }
        }
        Ok(())
    }
}
