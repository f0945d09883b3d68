//! T, G and g at work: what needs no analysis, whoever made them.

use super::roles::{Role, Roles};
use crate::common::argument::numbers;
use crate::common::identity::Identity;
use crate::{ArgumentError, Reduction};

/// `u = L u_q + u_0` of a [`Reduction`]: expand, project, condense. A [`crate::Map`] is one that knows its equations too.
///
/// ```
/// use qless::{Csr, Reduction, Transform};
/// // u0 = 2 u1 + 3, from somewhere else.
/// let t = Csr::from_parts(1, vec![0, 1], vec![0], vec![2.0])?;
/// let g_matrix = Csr::from_parts(0, vec![0, 0], Vec::new(), Vec::new())?;
/// let reduction = Reduction::from_parts([vec![0], vec![1], Vec::new()], t, g_matrix, vec![3.0])?;
/// let transform = Transform::new(reduction, &[])?;
/// let mut u = [0.0; 2];
/// transform.expand_into(&[5.0], &mut u)?;
/// assert_eq!(u, [13.0, 5.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Transform {
    pub(super) identity: Identity,
    pub(super) reduction: Reduction,
    pub(super) roles: Roles,
    /// The values of the prescribed DOFs, as they are now.
    pub(super) given: Vec<f64>,
}

impl std::fmt::Debug for Transform {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.write_as("Transform", f)
    }
}

impl Transform {
    /// With values of the prescribed DOFs, in the order of [`Reduction::prescribed`].
    ///
    /// # Errors
    /// [`ArgumentError`] for a wrong length or a number that is not finite.
    pub fn new(reduction: Reduction, prescribed: &[f64]) -> Result<Self, ArgumentError> {
        numbers("the list of prescribed values", prescribed, reduction.prescribed.len())?;
        Ok(Self::of(reduction, prescribed.to_vec()))
    }

    pub(super) fn of(reduction: Reduction, given: Vec<f64>) -> Self {
        Self { identity: Identity::new(), roles: Roles::new(&reduction, &given), reduction, given }
    }

    /// A new g and new values of the prescribed DOFs; T and G stay.
    ///
    /// # Errors
    /// [`ArgumentError`] for wrong lengths or numbers that are not finite; everything is then as it was.
    pub fn set(&mut self, g: &[f64], prescribed: &[f64]) -> Result<(), ArgumentError> {
        numbers("g", g, self.reduction.g.len())?;
        numbers("the list of prescribed values", prescribed, self.given.len())?;
        self.reduction.g.copy_from_slice(g);
        self.give(prescribed);
        Ok(())
    }

    pub(super) fn give(&mut self, prescribed: &[f64]) {
        self.given.copy_from_slice(prescribed);
        self.roles.refresh(&self.reduction, prescribed);
    }

    pub(super) fn write_as(&self, name: &str, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [slaves, masters, prescribed] = [self.slaves(), self.masters(), self.prescribed()].map(<[usize]>::len);
        write!(f, "{name} {{ slaves: {slaves}, masters: {masters}, prescribed: {prescribed} }}")
    }

    /// T, G and g, for b and u_p as they are now.
    pub fn reduction(&self) -> &Reduction {
        &self.reduction
    }

    /// Number of DOFs n.
    pub fn dofs(&self) -> usize {
        self.roles.of.len()
    }

    /// u_s, ascending.
    pub fn slaves(&self) -> &[usize] {
        self.reduction.slaves()
    }

    /// u_q, ascending.
    pub fn masters(&self) -> &[usize] {
        self.reduction.masters()
    }

    /// u_p, ascending.
    pub fn prescribed(&self) -> &[usize] {
        self.reduction.prescribed()
    }

    /// Values of u_p, as they are now.
    pub fn prescribed_values(&self) -> &[f64] {
        &self.given
    }

    /// Whether a DOF follows others; no DOF from n on does.
    pub fn is_slave(&self, dof: usize) -> bool {
        matches!(self.roles.of.get(dof), Some(Role::Slave(_)))
    }

    /// `u_dof = sum value u_j + g` of a slave: (j, value) for masters and prescribed DOFs, ascending, and g. None for other DOFs, and
    /// for slaves of factored parts ([`Reduction::row`]).
    ///
    /// ```
    /// # use qless::{Map, Options, SystemBuilder};
    /// let mut builder = SystemBuilder::new(3);
    /// builder.equation([(0, 1.0), (1, -0.5), (2, -0.5)], 1.0);
    /// builder.prescribe(2, 4.0);
    /// let map = Map::new(&builder.build()?, &Options::default())?;
    /// let (terms, g) = map.row(0).expect("a slave");
    /// assert_eq!((terms, g), (vec![(1, 0.5), (2, 0.5)], 1.0));
    /// assert_eq!(map.masters_of(0), [1]);
    /// assert!(map.row(1).is_none());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn row(&self, dof: usize) -> Option<(Vec<(usize, f64)>, f64)> {
        let Some(&Role::Slave(i)) = self.roles.of.get(dof) else { return None };
        let (i, reduction) = (i as usize, &self.reduction);
        if self.roles.is_held(i) {
            return None;
        }
        let of_masters = reduction.t.row(i).map(|(q, v)| (reduction.masters[q], v));
        let mut terms: Vec<_> = of_masters.collect();
        terms.extend(reduction.g_matrix.row(i).map(|(p, v)| (reduction.prescribed[p], v)));
        terms.sort_unstable_by_key(|&(j, _)| j);
        Some((terms, reduction.g[i]))
    }

    /// The masters that a slave follows, ascending; none for other DOFs.
    pub fn masters_of(&self, dof: usize) -> Vec<usize> {
        let Some(&Role::Slave(i)) = self.roles.of.get(dof) else { return Vec::new() };
        let row = self.reduction.row(i as usize).unwrap_or_default();
        row.into_iter().map(|(q, _)| self.reduction.masters[q]).collect()
    }
}
