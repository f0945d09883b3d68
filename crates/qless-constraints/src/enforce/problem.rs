//! Stiffness, loads and constraints, checked; the methods by name.

use std::borrow::Cow;

use faer::sparse::SparseColMat;
use qless::{ArgumentError, ConstraintSystem, Kind, Options, analyse};

use super::condensation::Condensation;
use super::equations::BALANCED;
use super::inverse::over_unknowns;
use super::matrix::{Matrix, bordered};
use super::{BlockPlan, EnforceError, Method, Stiffness, run};

/// Stiffness, loads and constraints, checked.
///
/// ```
/// use faer::sparse::{SparseColMat, Triplet};
/// use qless::SystemBuilder;
/// use qless_constraints::enforce::Problem;
/// // Two springs of stiffness 2 and 4 to the ground, tied to one another twice, under a load of 3.
/// let k = SparseColMat::try_new_from_triplets(2, 2, &[Triplet::new(0, 0, 2.0), Triplet::new(1, 1, 4.0)])?;
/// let mut builder = SystemBuilder::new(2);
/// builder.equation([(0, 1.0), (1, -1.0)], 0.0);
/// builder.equation([(0, 2.0), (1, -2.0)], 0.0);
/// let system = builder.build()?;
/// let problem = Problem::new(&k, &[3.0, 0.0], &system)?;
/// let solution = problem.transformation()?;
/// assert!((solution.u[0] - 0.5).abs() < 1e-15 && (solution.u[1] - 0.5).abs() < 1e-15);
/// // The tie carries 2 from the loaded spring to the other; one of its two equations does nothing.
/// assert!((solution.forces[0] + 2.0).abs() < 1e-14);
/// assert_eq!((problem.redundant().len(), solution.multipliers[problem.redundant()[0]]), (1, 0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Problem<'a> {
    /// All entries of K.
    pub(super) k: Cow<'a, Matrix>,
    pub(super) symmetric: bool,
    pub(super) f: &'a [f64],
    pub(super) system: &'a ConstraintSystem,
    pub(super) kept: Vec<usize>,
    redundant: Vec<usize>,
    /// Free DOFs that the equations fix.
    fixed: Vec<usize>,
}

impl std::fmt::Debug for Problem<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut text = f.debug_struct("Problem");
        text.field("dofs", &self.f.len()).field("kept", &self.kept.len()).field("redundant", &self.redundant);
        text.finish_non_exhaustive()
    }
}

/// Displacements, multipliers and forces.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// All DOFs.
    pub u: Vec<f64>,
    /// lambda, one per original equation, of `K u + C^T lambda = f`; redundant equations ([`Problem::redundant`]) have zero.
    pub multipliers: Vec<f64>,
    /// `-C^T lambda`: what the constraints exert on each DOF.
    pub forces: Vec<f64>,
    /// `(DOF, K u + C^T lambda - f)` for each prescribed DOF: what holds it.
    pub reactions: Vec<(usize, f64)>,
    /// The share of u, in its largest number per connected part, that may be wrong: what rounding of K and C does to it, and what
    /// penalties leave. Translations and rotations are compared in units of energy. An estimate, within a factor of 100 or so.
    pub accuracy: f64,
    /// The largest imbalance of a row of `K u + C^T lambda = f` and `C u - b`, relative to its terms.
    pub imbalance: f64,
}

impl<'a> Problem<'a> {
    /// Checks sizes and analyses the constraints with default settings. K is `&k`, or a [`Stiffness`] that says what is stored.
    ///
    /// # Errors
    /// [`EnforceError`] for sizes that do not fit, numbers that are not finite, one half of K that is not declared as such
    /// ([`EnforceError::Triangle`]), and equations that conflict, with their labels.
    pub fn new(
        k: impl Into<Stiffness<'a>>,
        f: &'a [f64],
        system: &'a ConstraintSystem,
    ) -> Result<Self, EnforceError> {
        let (stiffness, dofs) = (k.into(), system.dofs());
        let k = stiffness.matrix();
        for (what, found) in [("rows of K", k.nrows()), ("columns of K", k.ncols()), ("loads", f.len())] {
            if found != dofs {
                return Err(EnforceError::Size { what, found, dofs });
            }
        }
        if let Some(&value) = k.val().iter().chain(f).find(|value| !value.is_finite()) {
            return Err(EnforceError::NotFinite { value });
        }
        let (k, symmetric) = stiffness.whole()?;
        let analysis = analyse(system, &Options::default())?;
        let of_kind = |kind| (0..system.equations()).filter(|&row| analysis.kinds()[row] == kind).collect::<Vec<_>>();
        let conflicting = of_kind(Kind::Conflicting);
        if !conflicting.is_empty() {
            let labels = conflicting.iter().map(|&row| system.equation_label(row)).collect();
            return Err(EnforceError::Conflict { rows: conflicting, labels });
        }
        let fixed = analysis.generated().iter().map(|&(dof, _)| dof).collect();
        let (kept, redundant) = (of_kind(Kind::Independent), of_kind(Kind::Redundant));
        Ok(Self { k, symmetric, f, system, kept, redundant, fixed })
    }

    /// The equations that are enforced, ascending.
    pub fn kept(&self) -> &[usize] {
        &self.kept
    }

    /// The equations that follow from others, ascending; they have no multiplier.
    pub fn redundant(&self) -> &[usize] {
        &self.redundant
    }

    /// `(DOF, load)` for loads on free DOFs that the equations fix (generated boundary conditions): they go into the constraints and
    /// move nothing.
    ///
    /// ```
    /// use faer::sparse::{SparseColMat, Triplet};
    /// use qless::SystemBuilder;
    /// use qless_constraints::enforce::Problem;
    /// let k = SparseColMat::try_new_from_triplets(2, 2, &[Triplet::new(0, 0, 1.0), Triplet::new(1, 1, 1.0)])?;
    /// let mut builder = SystemBuilder::new(2);
    /// builder.equation([(0, 1.0), (1, 1.0)], 0.0);
    /// builder.equation([(0, 1.0), (1, -1.0)], 0.0);
    /// let system = builder.build()?;
    /// let problem = Problem::new(&k, &[3.0, 0.0], &system)?;
    /// assert_eq!(problem.loads_without_effect(), [(0, 3.0)]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn loads_without_effect(&self) -> Vec<(usize, f64)> {
        let loaded = self.fixed.iter().map(|&dof| (dof, self.f[dof]));
        loaded.filter(|&(_, load)| load != 0.0).collect()
    }

    /// One method for each equation, in one solve; those of redundant equations do not matter.
    ///
    /// `accuracy` is what may be left of equations with springs: for penalties the share of u by which it may differ from the exact
    /// one, for augmented equations `|C_i u - b_i|` relative to its terms. Elimination and multipliers leave rounding alone.
    ///
    /// ```
    /// use faer::sparse::{SparseColMat, Triplet};
    /// use qless::SystemBuilder;
    /// use qless_constraints::enforce::{Method, Problem};
    /// // Four springs to the ground in a row of ties, one of each kind, under a load of 10: stiffness 1 + 2 + 3 + 4.
    /// let diagonal: Vec<_> = (0..4).map(|j| Triplet::new(j, j, 1.0 + j as f64)).collect();
    /// let k = SparseColMat::try_new_from_triplets(4, 4, &diagonal)?;
    /// let mut builder = SystemBuilder::new(4);
    /// (0..3).for_each(|j| drop(builder.equation([(j, 1.0), (j + 1, -1.0)], 0.0)));
    /// let system = builder.build()?;
    /// let problem = Problem::new(&k, &[10.0, 0.0, 0.0, 0.0], &system)?;
    /// let methods = [Method::Elimination, Method::Multiplier, Method::Augmented { factor: 1e4 }];
    /// let solution = problem.enforce(&methods, 1e-12)?;
    /// assert!(solution.u.iter().all(|u| (u - 1.0).abs() < 1e-12));
    /// assert!((solution.multipliers[0] - 9.0).abs() < 1e-11);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`EnforceError::Unsupported`] with the motion that nothing holds; [`EnforceError::PenaltyTooLarge`] and
    /// [`EnforceError::PenaltyTooSmall`] with the factor that would do; [`EnforceError::NoConvergence`] where the multipliers of augmented
    /// equations do not settle; [`EnforceError::OutOfBalance`] where rounding leaves more than 1e-10 of the terms of a row;
    /// [`EnforceError::Argument`] for a list of the wrong length, [`EnforceError::Factor`], [`EnforceError::Accuracy`].
    pub fn enforce(&self, methods: &[Method], accuracy: f64) -> Result<Solution, EnforceError> {
        let (found, expected) = (methods.len(), self.system.equations());
        if found != expected {
            return Err(ArgumentError::WrongLength { what: "the list of methods", found, expected }.into());
        }
        if !(accuracy > 0.0 && accuracy.is_finite()) {
            return Err(EnforceError::Accuracy(accuracy));
        }
        run::run(self, methods, accuracy)
    }

    fn all(&self, method: Method, accuracy: f64) -> Result<Solution, EnforceError> {
        self.enforce(&vec![method; self.system.equations()], accuracy)
    }

    /// All slaves eliminated: `K* = T^T K T`, `f* = T^T (f - K u_0)` (Eq. 7-9).
    ///
    /// Connected parts of which T would fill ([`qless::Form::Auto`]) get multipliers in the same matrix: the solution is the same.
    ///
    /// # Errors
    /// As [`Problem::enforce`].
    pub fn transformation(&self) -> Result<Solution, EnforceError> {
        self.all(Method::Elimination, BALANCED)
    }

    /// A multiplier for each independent equation (Eq. 10).
    ///
    /// # Errors
    /// As [`Problem::enforce`].
    pub fn lagrange(&self) -> Result<Solution, EnforceError> {
        self.all(Method::Multiplier, BALANCED)
    }

    /// Independent equations as stiff springs; `lambda = D (C u - b)`. What the springs leave falls as 1 / factor; rounding of
    /// `K + C^T D C` grows as the factor, is refined away as long as it can be, and refused beyond.
    ///
    /// # Errors
    /// As [`Problem::enforce`], where u may differ from the exact one by a share of `accuracy`.
    pub fn penalty(&self, factor: f64, accuracy: f64) -> Result<Solution, EnforceError> {
        self.all(Method::Penalty { factor }, accuracy)
    }

    /// Penalty with multipliers that take over step by step: `lambda += D (C u - b)`, until every equation holds to
    /// `tolerance`, relative to its terms, and the forces are in balance.
    ///
    /// # Errors
    /// As [`Problem::enforce`].
    pub fn augmented(&self, factor: f64, tolerance: f64) -> Result<Solution, EnforceError> {
        self.all(Method::Augmented { factor }, tolerance)
    }

    /// Elimination of the blocks that are planned so, as in [`Problem::transformation`], multipliers on the others ([`Problem::plan`]).
    ///
    /// # Errors
    /// [`EnforceError::Plan`] if the plan does not have each independent equation once, and as [`Problem::enforce`].
    pub fn mixed(&self, plan: &[BlockPlan]) -> Result<Solution, EnforceError> {
        let mut planned: Vec<usize> = plan.iter().flat_map(|block| block.rows.iter().copied()).collect();
        planned.sort_unstable();
        if planned != self.kept {
            return Err(EnforceError::Plan { planned: planned.len(), kept: self.kept.len() });
        }
        let mut methods = vec![Method::Multiplier; self.system.equations()];
        let eliminated = plan.iter().filter(|block| block.eliminate).flat_map(|block| &block.rows);
        eliminated.for_each(|&row| methods[row] = Method::Elimination);
        self.enforce(&methods, BALANCED)
    }

    /// Lagrange's matrix `[K C^T; C 0]` on the DOFs that are not prescribed, for the equations `rows` (Eq. 10); not scaled.
    ///
    /// With a redundant equation among them it is singular, whatever K is.
    ///
    /// # Errors
    /// [`EnforceError::Argument`] for a row that is not there, another [`EnforceError`] if the matrix does not fit into memory.
    pub fn lagrange_matrix(&self, rows: &[usize]) -> Result<SparseColMat<usize, f64>, EnforceError> {
        let count = self.system.equations();
        if let Some(&found) = rows.iter().find(|&&row| row >= count) {
            return Err(ArgumentError::OutOfRange { what: "equation", found, count }.into());
        }
        let free = Condensation::new(self.system, &[], &self.k)?;
        bordered(&free.matrix(&self.k)?, &over_unknowns(self, &free, rows)?)
    }
}
