//! `row_k ~ sum_i c_i row_i`: independent as typed, but by so little that they may be meant as the same.
//!
//! The rank of an analysis is that of the numbers as they stand. Equations that somebody typed a second time with six digits, or
//! cosines of four, are independent by what was rounded; as meant, fewer are. A part of the system is read a second time if
//! its equations fall into two sorts: most far from dependence and some near it, with a clear gap between them.

mod combination;
mod own;
mod part;

use crate::diagnosis::certificate::CertificateTerm;
use crate::factor::backend::BackendError;
use crate::factor::backend::choice::DenseOrSparse;
use crate::input::components::components;
use crate::{Analysis, Kind};
use own::without_own;
use part::Part;

/// The second reading of a system: as it is probably meant.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct NearDependence {
    /// Rank if the equations below are meant as combinations of others; [`Analysis::rank`] is the rank as typed.
    pub rank: usize,
    /// The equations that are then redundant or conflicting, ascending by row; at least one.
    pub equations: Vec<NearDependent>,
}

/// An equation that is nearly a combination of others, none of which is in [`NearDependence::equations`].
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct NearDependent {
    /// The equation, 0-based.
    pub row: usize,
    /// Decimals at which it and the combination part: `floor(-log10 max_j |c_kj - sum_i y_i c_ij| / p_j)`, where `p_j` is the largest
    /// part of the difference, or the largest of all DOFs where only one equation holds DOF j.
    pub digits: u32,
    /// About the smallest change of one coefficient, relative to the largest of the equation (by a power of two), that makes it a
    /// combination: `|d|^2 / max |d_j|` for the difference d.
    pub distance: f64,
    /// The combination, ascending by row.
    pub because: Vec<CertificateTerm>,
}

/// Numbers up to which a part is dense: without pivoting near dependence is easily missed.
const SMALL: usize = 1 << 20;

impl NearDependence {
    /// Decimals to which all of the equations agree with others.
    pub fn digits(&self) -> u32 {
        self.equations.iter().map(|equation| equation.digits).min().unwrap_or(0)
    }
}

impl Analysis {
    /// Equations that are independent as typed but may be meant as combinations of others; None where no such reading stands
    /// out, as in a long chain, whose singular values fall without a gap.
    ///
    /// Part by connected part; at most three factorizations each, however many such equations
    /// it holds. Of equations that nearly say the same the earlier ones are kept.
    ///
    /// ```
    /// use qless::{Options, SystemBuilder, analyse};
    /// // The last is the first with six digits.
    /// let mut builder = SystemBuilder::new(3);
    /// builder.equation([(0, 0.123_456_789), (1, -0.987_654_321)], 0.0);
    /// builder.equation([(1, 1.0), (2, 2.0)], 0.0);
    /// builder.equation([(0, 0.123_457), (1, -0.987_654)], 0.0);
    /// let system = builder.build()?;
    /// let analysis = analyse(&system, &Options::default())?;
    /// let meant = analysis.meant()?.expect("a second reading");
    /// assert_eq!((analysis.rank(), meant.rank), (3, 2));
    /// let last = &meant.equations[0];
    /// assert_eq!((last.row, last.digits, last.because[0].row), (2, 5, 0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`BackendError`] where a part is too large for the memory allowed.
    pub fn meant(&self) -> Result<Option<NearDependence>, BackendError> {
        let local = self.numbering.view(&self.system, self.system.rhs());
        let rows = (0..self.kinds.len() as u32).filter(|&i| self.kinds[i as usize] == Kind::Independent).collect();
        let rows = without_own(local, rows, &self.scaling);
        let free = |i: u32| local.parts(i as usize).0.iter().copied().filter(|&j| local.free()[j as usize]);
        let backend = DenseOrSparse { memory: self.options.memory, small: SMALL };
        let mut number = vec![u32::MAX; local.dofs()];
        let mut equations = Vec::new();
        for rows in components(&rows, local.dofs(), free) {
            if rows.len() > 1 {
                let part = Part::new(local, rows, &self.scaling, &mut number);
                equations.extend(part.near(&backend)?);
            }
        }
        equations.sort_unstable_by_key(|equation: &NearDependent| equation.row);
        let rank = self.rank() - equations.len();
        Ok((!equations.is_empty()).then_some(NearDependence { rank, equations }))
    }
}
