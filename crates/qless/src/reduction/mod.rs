//! `u_s = T u_q + G u_p + g` (Eq. 23-26 of the paper): slaves expressed by masters, prescribed DOFs and a constant.

mod apply;
pub(crate) mod block;
mod build;
mod exchange;
mod exchange_goals;
mod factored;
mod order;
mod output;
mod relation;
mod residual_check;
pub(crate) mod retry;
mod rounding;

use crate::common::argument::long;
use crate::common::identity::Identity;
use crate::factor::backend::BackendError;
use crate::{ArgumentError, ConstraintSystem, Csr};

pub use factored::{FactoredBlock, Parts};

/// The form of T: explicit entries or factors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum Form {
    /// All rows are explicit.
    #[default]
    Explicit,
    /// Parts are factored if their rows of T need substitution or a factorization. Parts stay explicit if they contain preferred DOFs, or
    /// if no choice of slaves meets the bound of growth.
    Factored,
    /// As [`Form::Factored`], but only for parts whose rows of T would have more than 4,096 nonzeros, more than 4 times as many as the
    /// equations, and more than 4 times as many as the factors.
    Auto,
}

/// Errors of a reduction; a reduction that does not satisfy the equations is never returned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReductionError {
    /// T, G and g do not satisfy an equation.
    #[error(
        "row {row}: the reduced form has a relative residual of {residual:.1e}, but at most 1e-10 is allowed; the equations are too nearly \
         dependent to be solved for slaves: check their confidence, and rescale them or remove equations that nearly repeat others"
    )]
    Residual {
        /// The equation with the largest residual, 0-based.
        row: usize,
        /// The residual of this equation, relative to its own terms or to the DOFs of its part.
        residual: f64,
    },
    /// An entry of T, G or g exceeds the range of doubles.
    #[error("DOF {dof}: its value or a coefficient exceeds 1e308; rescale the equations")]
    NotFinite {
        /// The slave in whose row the entry is, 0-based.
        dof: usize,
    },
    /// A block could not be factored again.
    #[error(transparent)]
    Backend(BackendError),
}

/// The reduced form of a constraint system.
///
/// `C u = b` holds for every `u_q`, and for every `u_p` with which all dependent equations are consistent.
/// DOFs are 0-based; `masters` are all free DOFs that are not slaves, including those that occur in no equation.
#[derive(Clone, Debug, Default)]
pub struct Reduction {
    /// Identity of the analysis that computed the reduction.
    pub(crate) of: Identity,
    pub(crate) slaves: Vec<usize>,
    pub(crate) masters: Vec<usize>,
    pub(crate) prescribed: Vec<usize>,
    pub(crate) t: Csr,
    pub(crate) g_matrix: Csr,
    pub(crate) g: Vec<f64>,
    pub(crate) unmet_masters: Vec<usize>,
    pub(crate) unmet_slaves: Vec<usize>,
    pub(crate) growth: f64,
    pub(crate) exchanges: usize,
    pub(crate) factored: Vec<FactoredBlock>,
}

impl Reduction {
    /// A reduction that was computed elsewhere. It can be checked ([`crate::Analysis::residual`]) and used like any other, but a
    /// [`crate::change::Refresher`] does not accept it.
    ///
    /// ```
    /// use qless::{Csr, Options, Reduction, SystemBuilder, analyse};
    /// // u0 = 2 u1 + 3, solved by hand.
    /// let mut builder = SystemBuilder::new(2);
    /// builder.equation([(0, 1.0), (1, -2.0)], 3.0);
    /// let t = Csr::from_parts(1, vec![0, 1], vec![0], vec![2.0])?;
    /// let g_matrix = Csr::from_parts(0, vec![0, 0], Vec::new(), Vec::new())?;
    /// let ours = Reduction::from_parts([vec![0], vec![1], Vec::new()], t, g_matrix, vec![3.0])?;
    /// assert_eq!(analyse(&builder.build()?, &Options::default())?.residual(&ours)?, 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ArgumentError`] unless slaves, masters and prescribed DOFs each ascend and together contain each DOF once, T, G and g have a
    /// row for each slave, T has a column for each master, and G has a column for each prescribed DOF.
    pub fn from_parts(dofs: [Vec<usize>; 3], t: Csr, g_matrix: Csr, g: Vec<f64>) -> Result<Self, ArgumentError> {
        let [slaves, masters, prescribed] = dofs;
        once([("slaves", &slaves), ("masters", &masters), ("prescribed DOFs", &prescribed)])?;
        for (of_rows, of_columns, matrix, columns) in [
            ("the list of rows of T", "the list of columns of T", &t, masters.len()),
            ("the list of rows of G", "the list of columns of G", &g_matrix, prescribed.len()),
        ] {
            long(of_rows, matrix.rows(), slaves.len())?;
            long(of_columns, matrix.cols, columns)?;
        }
        long("g", g.len(), slaves.len())?;
        let growth = t.val.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        Ok(Self { slaves, masters, prescribed, t, g_matrix, g, growth, ..Self::default() })
    }

    /// The slaves u_s, ascending.
    pub fn slaves(&self) -> &[usize] {
        &self.slaves
    }

    /// The masters u_q, ascending.
    pub fn masters(&self) -> &[usize] {
        &self.masters
    }

    /// The prescribed DOFs u_p, ascending.
    pub fn prescribed(&self) -> &[usize] {
        &self.prescribed
    }

    /// T, slaves x masters; rows of slaves of factored blocks are empty.
    pub fn t(&self) -> &Csr {
        &self.t
    }

    /// G, slaves x prescribed DOFs; rows of slaves of factored blocks are empty.
    pub fn g_matrix(&self) -> &Csr {
        &self.g_matrix
    }

    /// g, one number per slave.
    pub fn g(&self) -> &[f64] {
        &self.g
    }

    /// DOFs of [`crate::Preferences::masters`] that are slaves because no choice of slaves avoids it, ascending.
    pub fn unmet_masters(&self) -> &[usize] {
        &self.unmet_masters
    }

    /// DOFs of [`crate::Preferences::slaves`] that are not slaves, ascending. They are prescribed or in no equation, or they could only
    /// replace other preferred slaves or exceed the bound of growth.
    pub fn unmet_slaves(&self) -> &[usize] {
        &self.unmet_slaves
    }

    /// The largest entry `max |T_ij|`; for factored parts the largest entry that the search found.
    pub fn growth(&self) -> f64 {
        self.growth
    }

    /// Number of exchanges of a slave and a master, to meet preferences and to keep the growth within the bound.
    pub fn exchanges(&self) -> usize {
        self.exchanges
    }

    /// The factored parts: [`crate::Form`].
    pub fn factored(&self) -> &[FactoredBlock] {
        &self.factored
    }

    /// Whether all rows of T are explicit.
    pub fn is_explicit(&self) -> bool {
        self.factored.is_empty()
    }

    /// Checks that the reduction has the DOFs and the prescribed DOFs of a system.
    pub(crate) fn fits(&self, system: &ConstraintSystem) -> Result<(), ArgumentError> {
        long("the reduction's list of DOFs", self.dofs(), system.dofs())?;
        let same = self.prescribed.iter().eq(system.prescribed().iter().map(|(j, _)| j));
        if same { Ok(()) } else { Err(ArgumentError::Foreign { what: "the reduction" }) }
    }
}

/// Checks that the lists ascend and together contain each of `0..n` once.
fn once(lists: [(&'static str, &[usize]); 3]) -> Result<(), ArgumentError> {
    let count: usize = lists.iter().map(|(_, list)| list.len()).sum();
    let mut seen = vec![false; count];
    for (what, list) in lists {
        for (place, &value) in list.iter().enumerate() {
            if value >= count {
                return Err(ArgumentError::OutOfRange { what, found: value, count });
            }
            let ascends = place == 0 || list[place - 1] < value;
            if !ascends || std::mem::replace(&mut seen[value], true) {
                return Err(ArgumentError::NotAscending { what, place, value });
            }
        }
    }
    Ok(())
}
