//! The interface to the user's model: internal forces `f_int(u)` and their tangent `K = d f_int / du`, summed over elements.

use std::error::Error;

use qless::Csr;

/// A finite-element model: forces and stiffness of its elements at u, in its own units.
///
/// ```
/// use qless_solve::equilibrium::{Assembly, Model};
/// /// A spring with `f = k u + a u^3`.
/// struct Spring {
///     k: f64,
///     a: f64,
/// }
/// impl Model for Spring {
///     fn dofs(&self) -> usize {
///         1
///     }
///     fn pattern(&self, entry: &mut dyn FnMut(usize, usize)) {
///         entry(0, 0);
///     }
///     fn assemble(&mut self, u: &[f64], out: &mut Assembly) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
///         out.force(0, self.k * u[0] + self.a * u[0].powi(3));
///         out.stiffness(0, 0, self.k + 3.0 * self.a * u[0] * u[0]);
///         Ok(())
///     }
/// }
/// assert_eq!(Spring { k: 1.0, a: 2.0 }.coordinate(0), 0.0);
/// ```
pub trait Model {
    /// Number of DOFs n, the same as that of the constraint set.
    fn dofs(&self) -> usize;

    /// Calls `entry(i, j)` for every `K_ij` that may be nonzero, in both halves; repetitions are allowed. Called once per solve.
    fn pattern(&self, entry: &mut dyn FnMut(usize, usize));

    /// Adds `f_int(u)` and K of all elements to `out`, which starts at zero.
    ///
    /// Contributions should be added element by element, so that the sizes of terms are known even if their sum cancels. Forces that depend
    /// on u (follower loads, contact) belong here.
    ///
    /// # Errors
    /// Any error of an element at this u, such as an inverted volume. The load step is then shortened.
    fn assemble(&mut self, u: &[f64], out: &mut Assembly) -> Result<(), Box<dyn Error + Send + Sync>>;

    /// Size of the coordinate that DOF `dof` is added to: the largest coordinate of its node, in the unit of the DOF. The effect of the
    /// last place of this number on the forces counts as rounding. Default 0.
    fn coordinate(&self, dof: usize) -> f64 {
        let _ = dof;
        0.0
    }

    /// Called with the equilibrium of each successful load step, including the last one; history variables should be updated here.
    fn accept(&mut self, u: &[f64]) {
        let _ = u;
    }
}

/// A force on a DOF out of range, or an entry of K outside of the pattern.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AssemblyFault {
    Force(usize),
    Stiffness(usize, usize),
}

/// Sums of forces and stiffness, with the sizes of their terms.
#[derive(Clone, Debug)]
pub struct Assembly {
    /// Internal forces `f_int`.
    pub(super) force: Vec<f64>,
    /// For each DOF, the sum of the absolute terms of `f_int`.
    pub(super) terms: Vec<f64>,
    stiffness: Csr,
    wanted: bool,
    pub(super) fault: Option<AssemblyFault>,
}

impl Assembly {
    /// Creates zero sums in the pattern of a model; an entry out of range is recorded as a fault.
    pub(super) fn new(model: &impl Model) -> Self {
        let (n, mut rows, mut fault) = (model.dofs(), vec![Vec::new(); model.dofs()], None);
        model.pattern(&mut |i, j| match rows.get_mut(i) {
            Some(row) if j < n => row.push(j),
            _ => fault = Some(AssemblyFault::Stiffness(i, j)),
        });
        let mut stiffness = Csr::empty(n);
        for mut row in rows {
            row.sort_unstable();
            row.dedup();
            let zeros = row.into_iter().map(|j| (j, 0.0));
            stiffness.push_row(zeros).expect("columns ascend, and are below n");
        }
        Self { force: vec![0.0; n], terms: vec![0.0; n], stiffness, wanted: true, fault }
    }

    /// Resets all sums to zero. Without `stiffness`, stiffness is neither reset nor summed.
    pub(super) fn clear(&mut self, stiffness: bool) {
        self.force.fill(0.0);
        self.terms.fill(0.0);
        self.wanted = stiffness;
        if stiffness {
            self.stiffness.values_mut().fill(0.0);
        }
    }

    /// Adds to the internal force of a DOF.
    pub fn force(&mut self, dof: usize, value: f64) {
        match self.force.get_mut(dof) {
            Some(force) => {
                *force += value;
                self.terms[dof] += value.abs();
            }
            None => self.fault = Some(AssemblyFault::Force(dof)),
        }
    }

    /// Adds to `K_ij = d f_i / du_j`; the entry must be in the pattern.
    pub fn stiffness(&mut self, i: usize, j: usize, value: f64) {
        if !self.wanted {
            return;
        }
        let starts = self.stiffness.starts();
        let row = if i < self.stiffness.rows() { starts[i]..starts[i + 1] } else { 0..0 };
        match self.stiffness.columns()[row.clone()].binary_search_by(|&column| (column as usize).cmp(&j)) {
            Ok(place) => self.stiffness.values_mut()[row.start + place] += value,
            Err(_) => self.fault = Some(AssemblyFault::Stiffness(i, j)),
        }
    }

    /// Whether stiffness is needed in this evaluation; if not, its computation can be skipped.
    pub fn wants_stiffness(&self) -> bool {
        self.wanted
    }

    /// For each DOF, whether the model has stiffness or a force there.
    pub(super) fn known(&self) -> Vec<bool> {
        let mut known: Vec<bool> = self.terms.iter().map(|&size| size != 0.0).collect();
        for i in 0..known.len() {
            self.row(i).for_each(|(j, _)| (known[i], known[j]) = (true, true));
        }
        known
    }

    /// Entries `(j, K_ij)` of a row.
    pub(super) fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.stiffness.row(i)
    }
}
