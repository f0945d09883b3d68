//! `K_q = L^T K L` and `f_q = L^T (f - K u_0)`: the pattern is computed once, the values in every step.
//!
//! ```text
//! pattern         numbers of unknowns, lines of K_q, sources of their entries    O(nnz K + contributions of slaves)
//! W = K_S L       the lines of slaves by unknowns                                O(contributions)
//! K_q(q, :) = K(q, :) L + sum over slaves a of L_aq W(a, :)                      O(nnz K + contributions)
//! ```
//!
//! A line of K is copied if its indices ascend, all of its DOFs are unknowns and no slave depends on the DOF of the line. Most lines are
//! copied. Each line of K_q is computed by one thread, in a fixed order, so the result is the same to the last bit for every number of
//! threads. Lines are rows or columns, like those of K.

mod elements;
mod lines;
mod plan;
mod values;

use std::collections::BTreeMap;

use super::view::{Index, Storage, View};
use super::{Elimination, EliminationError};
use crate::common::argument::{long, numbers, within};
use crate::common::identity::Identity;
use crate::{ArgumentError, Csr};
use lines::{Lines, WorkArrays};
use plan::CondensePlan;

/// The treatment of prescribed DOFs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PrescribedDofs {
    /// Prescribed DOFs are eliminated from K_q; their values enter f_q.
    #[default]
    Eliminated,
    /// Prescribed DOFs are unknowns of K_q, for a solver that prescribes them itself.
    Kept,
}

/// The pattern of K_q, and the map from values of K to values of K_q. It belongs to the elimination that made it, and stays valid after
/// [`crate::Elimination::update`].
#[derive(Clone, Debug)]
pub struct CondensedPattern {
    elimination: Identity,
    prescribed: PrescribedDofs,
    storage: Storage,
    by_columns: bool,
    /// The stored half by lines (rows or columns): line q of K_q contains index r if `half` holds `(q, r)`. It is `storage` if lines are
    /// rows, and its transpose if lines are columns.
    half: Storage,
    /// The matrix L of `u = L u_q + u_0`: a row for each eliminated slave, over the unknowns of K_q.
    l: Csr,
    /// For each unknown the slaves whose rows of L contain it, that is, `L^T`.
    slaves_of: Csr,
    /// DOF of each unknown, ascending.
    dofs: Vec<usize>,
    /// For each DOF, the number of its unknown; [`NONE`] for eliminated DOFs.
    number: Vec<u32>,
    /// For each DOF, its row in the matrix `l`; [`NONE`] for DOFs that are not eliminated slaves.
    slave: Vec<u32>,
    lines: Lines,
    plan: CondensePlan,
    work: WorkArrays,
}

/// Marks a missing index.
const NONE: u32 = u32::MAX;

impl Elimination {
    /// The pattern of K_q for matrices K with this pattern. It is compressed like K (rows or columns, the same half if symmetric), with
    /// indices from 0, ascending.
    ///
    /// ```
    /// use qless::{Elimination, Options, SystemBuilder};
    /// use qless::elimination::{PrescribedDofs, Storage, View};
    /// // u2 = (u0 + u1) / 2; K by its lower half.
    /// let mut builder = SystemBuilder::new(3);
    /// builder.equation([(2, 2.0), (0, -1.0), (1, -1.0)], 0.0);
    /// let elimination = Elimination::new(&builder.build()?, &Options::default())?;
    /// let lower = View::rows(&[0, 1, 2, 4], &[0_u32, 1, 0, 2]).storing(Storage::Lower);
    /// let condensed = elimination.condensed(lower, PrescribedDofs::Eliminated)?;
    /// let (mut k_q, mut f_q) = (vec![0.0; condensed.nnz()], vec![0.0; condensed.unknowns()]);
    /// condensed.condense_into(&elimination, &[4.0, 1.0, 3.0, 8.0], &[0.0; 3], &mut k_q, &mut f_q)?;
    /// assert_eq!((condensed.starts(), condensed.index()), ([0, 1, 3].as_slice(), [0, 0, 1].as_slice()));
    /// assert_eq!(k_q.len(), 3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// Slaves of factored parts ([`crate::Form`]) are unknowns too: a solver enforces their equations by multipliers
    /// ([`CondensedPattern::remaining_equations`]).
    ///
    /// # Errors
    /// [`EliminationError::Matrix`] if the arrays are not a valid n x n pattern.
    pub fn condensed<P: Index, I: Index>(
        &self,
        k: View<P, I>,
        prescribed: PrescribedDofs,
    ) -> Result<CondensedPattern, EliminationError> {
        CondensedPattern::new(self, k.checked(self.dofs())?, prescribed)
    }
}

impl CondensedPattern {
    fn new<P: Index, I: Index>(
        elimination: &Elimination,
        k: View<P, I>,
        prescribed: PrescribedDofs,
    ) -> Result<Self, EliminationError> {
        let kept = prescribed == PrescribedDofs::Kept;
        let mut dofs = elimination.masters().to_vec();
        if kept {
            dofs.extend(elimination.prescribed());
        }
        dofs.extend(elimination.reduction.factored.iter().flat_map(|block| &block.slaves));
        dofs.sort_unstable();
        let mut number = vec![NONE; elimination.dofs()];
        dofs.iter().zip(0..).for_each(|(&j, c)| number[j] = c);
        let mut slave = vec![NONE; elimination.dofs()];
        let eliminated = elimination.slaves().iter().zip(0..).filter(|&(&j, _)| number[j] == NONE);
        eliminated.for_each(|(&j, i)| slave[j] = i);
        let l = rows_over(elimination, &number, dofs.len(), kept);
        let mut condensed = Self {
            elimination: elimination.identity,
            prescribed,
            storage: k.storage,
            by_columns: k.by_columns,
            half: if k.by_columns { k.storage.transposed() } else { k.storage },
            slaves_of: l.transposed(),
            l,
            dofs,
            number,
            slave,
            lines: Lines::default(),
            plan: CondensePlan::default(),
            work: WorkArrays::default(),
        };
        condensed.plan(elimination.slaves(), k)?;
        Ok(condensed)
    }

    /// Number of unknowns of K_q, in the order of [`CondensedPattern::dofs`].
    pub fn unknowns(&self) -> usize {
        self.dofs.len()
    }

    /// DOF of each unknown, ascending: the masters, with the prescribed DOFs if they are kept, and the slaves of factored parts.
    pub fn dofs(&self) -> &[usize] {
        &self.dofs
    }

    /// Number of stored entries of K_q.
    pub fn nnz(&self) -> usize {
        self.lines.index.len()
    }

    /// Start of each line (row or column) of K_q in [`CondensedPattern::index`], and the end of the last one: one number more than
    /// unknowns.
    pub fn starts(&self) -> &[u32] {
        &self.lines.starts
    }

    /// For each stored entry of K_q, its column if lines are rows, else its row; ascending within each line.
    pub fn index(&self) -> &[u32] {
        &self.lines.index
    }

    /// `(row, column)` of each stored entry, in the order of the values, for codes that use triplets.
    ///
    /// ```
    /// use qless::{Elimination, Options, SystemBuilder};
    /// use qless::elimination::{PrescribedDofs, View};
    /// let mut builder = SystemBuilder::new(3);
    /// builder.equation([(1, 1.0), (2, -1.0)], 0.0);
    /// let elimination = Elimination::new(&builder.build()?, &Options::default())?;
    /// let columns = View::columns(&[0, 2, 3, 4], &[0_u32, 2, 1, 2]);
    /// let condensed = elimination.condensed(columns, PrescribedDofs::Eliminated)?;
    /// let entries: Vec<_> = condensed.entries().collect();
    /// assert_eq!((entries, condensed.unknowns()), (vec![(0, 0), (1, 0), (1, 1)], 2));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn entries(&self) -> impl ExactSizeIterator<Item = (usize, usize)> + '_ {
        let mut line = 0;
        self.lines.index.iter().enumerate().map(move |(k, &other)| {
            while self.lines.starts[line + 1] as usize <= k {
                line += 1;
            }
            if self.by_columns { (other as usize, line) } else { (line, other as usize) }
        })
    }

    /// The half of K_q that is stored: the same half as of K.
    pub fn storage(&self) -> Storage {
        self.storage
    }

    /// The equations of factored parts, which the unknowns must satisfy: a solver enforces them by multipliers.
    pub fn remaining_equations(&self, elimination: &Elimination) -> Vec<usize> {
        let blocks = elimination.reduction.factored.iter();
        let mut equations: Vec<usize> = blocks.flat_map(|block| block.equations.clone()).collect();
        equations.sort_unstable();
        equations
    }

    /// Expresses an equation `sum_j c_j u_j = b` by the unknowns: (unknown, coefficient), ascending, and the new right-hand side.
    ///
    /// ```
    /// use qless::{Elimination, Options, SystemBuilder};
    /// use qless::elimination::{PrescribedDofs, View};
    /// let mut builder = SystemBuilder::new(3);
    /// builder.equation([(0, 1.0), (1, -2.0)], 1.0);
    /// builder.prescribe(2, 4.0);
    /// let elimination = Elimination::new(&builder.build()?, &Options::default())?;
    /// let condensed = elimination.condensed(View::rows(&[0, 1, 2, 3], &[0_u32, 1, 2]), PrescribedDofs::Eliminated)?;
    /// // u0 + u1 + u2 = 6, where u1 = (u0 - 1) / 2 and u2 = 4: 1.5 u0 = 2.5.
    /// let (terms, b) = condensed.equation(&elimination, [(0, 1.0), (1, 1.0), (2, 1.0)], 6.0)?;
    /// assert_eq!((terms, b), (vec![(0, 1.5)], 2.5));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ArgumentError`] for a DOF that is out of range, a number that is not finite, or an elimination that did not make this pattern.
    pub fn equation(
        &self,
        elimination: &Elimination,
        terms: impl IntoIterator<Item = (usize, f64)>,
        mut rhs: f64,
    ) -> Result<(Vec<(usize, f64)>, f64), ArgumentError> {
        self.check(elimination, self.nnz())?;
        numbers("b", &[rhs], 1)?;
        let mut sums = BTreeMap::new();
        for (place, (j, c)) in terms.into_iter().enumerate() {
            within("DOF", j, self.number.len())?;
            if !c.is_finite() {
                return Err(ArgumentError::NotFinite { what: "the list of terms", place, value: c });
            }
            rhs -= c * self.shift(elimination, j);
            self.row_of_l(j).for_each(|(r, v)| *sums.entry(r as usize).or_insert(0.0) += c * v);
        }
        Ok((sums.into_iter().collect(), rhs))
    }

    /// Returns true if K_q is compressed by columns, as K is.
    pub fn is_by_columns(&self) -> bool {
        self.by_columns
    }

    /// The row of a DOF in the matrix L of `u = L u_q + u_0`: a single 1 for an unknown, the row of `l` for an eliminated slave, empty for
    /// an eliminated prescribed DOF.
    #[inline]
    fn row_of_l(&self, dof: usize) -> impl Iterator<Item = (u32, f64)> + '_ {
        let (unknowns, values): (&[u32], &[f64]) = match (&self.number[dof], self.slave[dof]) {
            (&NONE, NONE) => (&[], &[]),
            (&NONE, slave) => {
                let range = self.l.start[slave as usize]..self.l.start[slave as usize + 1];
                (&self.l.col[range.clone()], &self.l.val[range])
            }
            (number, _) => (std::slice::from_ref(number), &[1.0]),
        };
        unknowns.iter().copied().zip(values.iter().copied())
    }

    /// `u_0` of an eliminated DOF; zero for an unknown.
    fn shift(&self, elimination: &Elimination, dof: usize) -> f64 {
        if self.number[dof] != NONE {
            return 0.0;
        }
        match (elimination.roles.of[dof], self.prescribed) {
            (super::Role::Slave(i), PrescribedDofs::Eliminated) => elimination.roles.constants[i as usize],
            (super::Role::Slave(i), PrescribedDofs::Kept) => elimination.reduction.g[i as usize],
            (super::Role::Prescribed(p), PrescribedDofs::Eliminated) => elimination.prescribed_values[p as usize],
            _ => 0.0,
        }
    }

    /// Checks that this elimination made the pattern, and that the values of K_q have the right length.
    fn check(&self, elimination: &Elimination, values: usize) -> Result<(), ArgumentError> {
        if elimination.identity != self.elimination {
            return Err(ArgumentError::Foreign { what: "the pattern" });
        }
        long("the list of values of K_q", values, self.nnz())
    }
}

/// The rows of T over the unknowns of K_q, together with those of G if prescribed DOFs are unknowns too.
fn rows_over(elimination: &Elimination, number: &[u32], unknowns: usize, kept: bool) -> Csr {
    let reduction = &elimination.reduction;
    let mut rows = Csr::empty(unknowns);
    for i in 0..reduction.slaves.len() {
        let of_masters = reduction.t.row(i).map(|(q, v)| (number[reduction.masters[q]] as usize, v));
        if kept {
            let of_prescribed = reduction.g_matrix.row(i).map(|(p, v)| (number[reduction.prescribed[p]] as usize, v));
            let mut all: Vec<_> = of_masters.chain(of_prescribed).collect();
            all.sort_unstable_by_key(|&(c, _)| c);
            rows.append(all);
        } else {
            rows.append(of_masters);
        }
    }
    rows
}
