//! Uses of a reduction: expansion `u_s = T u_q + G u_p + g`, transfer of forces `T^T f`, rows and columns of T.

use super::Reduction;
use crate::ArgumentError;
use crate::common::argument::{in_range, numbers, within};

impl Reduction {
    /// Expands masters and prescribed values (in the order of [`Reduction::masters`] and [`Reduction::prescribed`]) to all DOFs.
    ///
    /// ```
    /// use qless::{ArgumentError, Options, SystemBuilder, analyse};
    /// let mut builder = SystemBuilder::new(2);
    /// builder.equation([(0, 1.0), (1, -2.0)], 3.0);
    /// let reduction = analyse(&builder.build()?, &Options::default())?.reduction()?;
    /// let u = reduction.expand(&[0.5], &[])?;
    /// assert!((u[0] - 2.0 * u[1] - 3.0).abs() < 1e-15);
    /// let short = reduction.expand(&[], &[]);
    /// assert_eq!(short, Err(ArgumentError::WrongLength { what: "the list of masters", found: 0, expected: 1 }));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ArgumentError`] for a wrong length, or a number or result that is not finite.
    pub fn expand(&self, masters: &[f64], prescribed: &[f64]) -> Result<Vec<f64>, ArgumentError> {
        numbers("the list of masters", masters, self.masters.len())?;
        numbers("the list of prescribed values", prescribed, self.prescribed.len())?;
        in_range("u", self.combined(masters, prescribed, |i| self.g[i]))
    }

    /// Expands an increment of the masters: slaves get `T du_q`, prescribed DOFs get 0. The difference of two expansions would lose digits
    /// beside a large g.
    pub(crate) fn increment(&self, masters: &[f64]) -> Result<Vec<f64>, ArgumentError> {
        numbers("the list of masters", masters, self.masters.len())?;
        in_range("u", self.combined(masters, &vec![0.0; self.prescribed.len()], |_| 0.0))
    }

    /// The values of all DOFs for these masters and prescribed values; `constant(i)` is added to slave i.
    fn combined(&self, masters: &[f64], prescribed: &[f64], constant: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut u = vec![0.0; self.dofs()];
        self.masters.iter().zip(masters).for_each(|(&j, &v)| u[j] = v);
        self.prescribed.iter().zip(prescribed).for_each(|(&j, &v)| u[j] = v);
        let (t, g) = (self.t.product(masters), self.g_matrix.product(prescribed));
        self.factored.iter().for_each(|block| block.set_slaves(&mut u));
        // T and G have empty rows for slaves of factored blocks, so `t` (T u_q) and `g` (G u_p) are zero there.
        self.slaves.iter().enumerate().for_each(|(i, &j)| u[j] += t[i] + g[i] + constant(i));
        u
    }

    /// `f_q = T^T f_s`: forces on slaves (in the order of [`Reduction::slaves`]) transferred to the masters.
    ///
    /// # Errors
    /// [`ArgumentError`] for a wrong length, or a number or result that is not finite.
    pub fn apply_transposed(&self, slaves: &[f64]) -> Result<Vec<f64>, ArgumentError> {
        numbers("the list of forces", slaves, self.slaves.len())?;
        let mut f = vec![0.0; self.dofs()];
        self.slaves.iter().zip(slaves).for_each(|(&j, &v)| f[j] = v);
        self.factored.iter().for_each(|block| block.pull_back(&mut f));
        let mut sum: Vec<f64> = self.masters.iter().map(|&j| f[j]).collect();
        for (i, &v) in slaves.iter().enumerate() {
            self.t.row(i).for_each(|(q, t)| sum[q] += t * v);
        }
        in_range("T^T f", sum)
    }

    /// Row i of T, ascending: the coefficients of slave i of [`Reduction::slaves`].
    ///
    /// # Errors
    /// [`ArgumentError::OutOfRange`].
    pub fn row(&self, i: usize) -> Result<Vec<(usize, f64)>, ArgumentError> {
        within("slave", i, self.slaves.len())?;
        let slave = self.slaves[i];
        let held = self.factored.iter().find_map(|block| Some((block, block.slaves.iter().position(|&j| j == slave)?)));
        Ok(match held {
            Some((block, k)) => block.row(k).into_iter().map(|(j, v)| (self.place_of_master(j), v)).collect(),
            None => self.t.row(i).collect(),
        })
    }

    /// Column q of T, ascending: the coefficients of master q of [`Reduction::masters`].
    ///
    /// # Errors
    /// [`ArgumentError::OutOfRange`].
    pub fn column(&self, q: usize) -> Result<Vec<(usize, f64)>, ArgumentError> {
        within("master", q, self.masters.len())?;
        let entry = |i: usize| self.t.row(i).find(|&(j, _)| j == q).map(|(_, v)| (i, v));
        let mut column: Vec<(usize, f64)> = (0..self.slaves.len()).filter_map(entry).collect();
        let place = |j: usize| self.slaves.binary_search(&j).unwrap_or_default();
        for block in &self.factored {
            if let Ok(k) = block.masters.binary_search(&self.masters[q]) {
                let own = block.column_of(k).into_iter().zip(&block.slaves).filter(|(v, _)| *v != 0.0);
                column.extend(own.map(|(v, &j)| (place(j), v)));
            }
        }
        column.sort_unstable_by_key(|&(i, _)| i);
        Ok(column)
    }

    fn place_of_master(&self, dof: usize) -> usize {
        self.masters.binary_search(&dof).unwrap_or_default()
    }

    pub(crate) fn dofs(&self) -> usize {
        self.slaves.len() + self.masters.len() + self.prescribed.len()
    }
}
