//! Repeated solves of one model: `K_q u_q = f_q`, `u = L u_q + u_0`. The analysis, the pattern and the symbolic factors are made once.

use qless::elimination::{CondensedPattern, EliminationError, Index, PrescribedDofs, Storage, View};
use qless::{Csr, Elimination, Reduction};

use super::equations::{BALANCED, Equations, FLOOR};
use super::matrix::{backsolve, from_triplets};
use super::problem::check_redundant;
use super::scale::{parts, scales, times_power};
use super::singularity::{SupportVerdict, check_support, free_motion};
use super::solver::{Solver, SolverError, SolverMatrix};
use super::transform_noise::TransformNoise;
use super::{EnforceError, FreeMotion};

/// An elimination, the pattern of the condensed K, and a solver; it owns all three, so that it can be kept beside the model.
///
/// ```
/// use qless::{Elimination, Options, SystemBuilder};
/// use qless::elimination::View;
/// use qless_solve::enforce::{Llt, Steps};
/// // Two springs of stiffness 2 and 4 to the ground, tied with a gap that grows, under a load of 3.
/// let mut builder = SystemBuilder::new(2);
/// builder.equation([(0, 1.0), (1, -1.0)], 0.0);
/// let elimination = Elimination::new(&builder.build()?, &Options::default())?;
/// let mut steps = Steps::new(elimination, View::columns(&[0, 1, 2], &[0_u32, 1]), Llt::default())?;
/// let mut u = [0.0; 2];
/// for gap in [0.0, 0.75, 1.5] {
///     steps.elimination_mut().update(&[gap], &[])?;
///     steps.solve(&[2.0, 4.0], &[3.0, 0.0], &mut u)?;
///     assert!((u[0] - (0.5 + gap * 2.0 / 3.0)).abs() < 1e-14 && (u[0] - u[1] - gap).abs() < 1e-14);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Steps<S> {
    elimination: Elimination,
    condensed: CondensedPattern,
    /// The elimination with absolute values in place of the entries of T: it condenses `|K|` to the sizes of the terms of K_q.
    sizes: Elimination,
    of_sizes: CondensedPattern,
    solver: S,
    /// Values of the condensed matrix K_q, in the order in which the solver reads them.
    k_q: Vec<f64>,
    /// All entries of K_q, dimensionless.
    equations: Equations,
    /// For each stored value of the matrix in `equations`, the index of the same entry of K_q in `k_q`. The matrix stores both triangles
    /// even if `k_q` stores one, so two values may have the same index.
    places: Vec<u32>,
    /// Exponents of the scales of the unknowns.
    scale: Vec<i32>,
    /// Whether the last [`Steps::solve`] factored K_q and found no mechanism. [`Steps::solve_again`] needs this.
    is_held: bool,
}

impl<S: Solver> Steps<S> {
    /// Prepares solves for matrices with the pattern of K.
    ///
    /// # Errors
    /// [`EnforceError::Elimination`] if the elimination has no equations or the arrays are not a valid pattern, [`EnforceError::Factored`]
    /// if parts of T are kept as factors, [`EnforceError::Triangle`] if the pattern is half of a matrix but not declared so.
    pub fn new<P: Index, I: Index>(elimination: Elimination, k: View<P, I>, solver: S) -> Result<Self, EnforceError> {
        let steps = Self::unsymmetric(elimination, k, solver)?;
        let off = |below: bool| k.entries().any(|(i, j)| i != j && (i > j) == below);
        let (lower, upper) = (off(true), off(false));
        if k.storage() == Storage::Full && lower != upper { Err(EnforceError::Triangle { lower }) } else { Ok(steps) }
    }

    /// As [`Steps::new`], but accepts a triangular K that is meant as an unsymmetric matrix.
    ///
    /// # Errors
    /// As [`Steps::new`], except for triangles.
    pub fn unsymmetric<P: Index, I: Index>(
        elimination: Elimination,
        k: View<P, I>,
        solver: S,
    ) -> Result<Self, EnforceError> {
        if elimination.analysis().is_none() {
            return Err(EliminationError::NoEquations.into());
        }
        if !elimination.reduction().is_explicit() {
            return Err(EnforceError::Factored);
        }
        let condensed = elimination.condensed(k, PrescribedDofs::Eliminated)?;
        let sizes = Elimination::from_reduction(sizes_of(elimination.reduction())?, elimination.prescribed_values())?;
        let of_sizes = sizes.condensed(k, PrescribedDofs::Eliminated)?;
        let (n, is_half) = (condensed.unknowns(), condensed.storage() != Storage::Full);
        // Each value of this matrix is the index of its entry in the condensed pattern, so that values of K_q can be copied into the matrix
        // later.
        let all = condensed.entries().enumerate().flat_map(|(place, (i, j))| {
            [(i, j, place as f64), (j, i, place as f64)].into_iter().take(if is_half && i != j { 2 } else { 1 })
        });
        let a = from_triplets(n, n, all)?;
        let places: Vec<u32> = a.val().iter().map(|place| *place as u32).collect();
        let (k_q, limits) = (vec![0.0; condensed.nnz()], vec![(FLOOR, BALANCED); n]);
        let parts = parts(n, condensed.entries());
        let equations = Equations { sizes: vec![0.0; a.val().len()], a, parts, known: vec![true; n], limits };
        let scale = vec![0; n];
        Ok(Self { elimination, condensed, sizes, of_sizes, solver, k_q, equations, places, scale, is_held: false })
    }

    /// The elimination, with the constraints.
    pub fn elimination(&self) -> &Elimination {
        &self.elimination
    }

    /// The elimination, to change right-hand sides and prescribed values.
    pub fn elimination_mut(&mut self) -> &mut Elimination {
        &mut self.elimination
    }

    /// The pattern of K_q.
    pub fn condensed(&self) -> &CondensedPattern {
        &self.condensed
    }

    /// Computes u of all DOFs from the values of K and the forces: condenses, factors, checks the support, and solves.
    ///
    /// Cost: one factorization, three solves and a few passes over K_q.
    ///
    /// # Errors
    /// [`EnforceError::Argument`] for lists of the wrong length or numbers that are not finite, [`EnforceError::Solver`],
    /// [`EnforceError::Unsupported`] with the free motion, and as [`Steps::solve_again`].
    pub fn solve(&mut self, k: &[f64], f: &[f64], u: &mut [f64]) -> Result<(), EnforceError> {
        self.is_held = false;
        self.condensed.condense_matrix_into(&self.elimination, k, &mut self.k_q)?;
        self.check_model(k)?;
        self.is_held = true;
        self.solve_again(k, f, u)
    }

    /// Solves for other forces, right-hand sides or prescribed values with the factors of the last [`Steps::solve`]; K must be the same.
    ///
    /// # Errors
    /// As [`Steps::solve`]; [`EnforceError::OutOfBalance`] if a residual is larger than 1e-10 of its terms after refinement;
    /// [`EnforceError::Doubtful`] if an equation may be redundant or not and u depends on it.
    pub fn solve_again(&mut self, k: &[f64], f: &[f64], u: &mut [f64]) -> Result<(), EnforceError> {
        if !self.is_held {
            return Err(SolverError("there are no factors; call Steps::solve first, which must succeed".into()).into());
        }
        let (mut load, mut sizes) = (vec![0.0; self.condensed.unknowns()], vec![0.0; self.condensed.unknowns()]);
        self.condensed.load_into(&self.elimination, k, f, &mut load)?;
        self.size_of_load(k, f, &mut sizes)?;
        let Self { solver, scale, equations, .. } = self;
        load.iter_mut().chain(&mut sizes).zip(scale.iter().chain(&*scale)).for_each(|(v, e)| *v = times_power(*v, *e));
        let refined = equations.refine(&mut |r| inverse(solver, scale, r), (&load, &sizes))?;
        if refined.share > 1.0 {
            let row = format!("the forces on DOF {}", self.elimination.masters()[refined.row]);
            return Err(EnforceError::OutOfBalance { row, imbalance: refined.imbalance });
        }
        self.elimination.expand_into(&scaled(&refined.x, scale), u)?;
        let analysis = self.elimination.analysis().ok_or(EliminationError::NoEquations)?;
        check_redundant(analysis, self.elimination.kinds(), self.elimination.rhs(), u)
    }

    /// Sizes of the terms of the condensed load: `|L|^T (|f| + |K| |u_0|)`.
    fn size_of_load(&mut self, k: &[f64], f: &[f64], sizes: &mut [f64]) -> Result<(), EnforceError> {
        let mut constant = vec![0.0; self.elimination.dofs()];
        self.elimination.expand_into(&vec![0.0; sizes.len()], &mut constant)?;
        let opposite = |dofs: &[usize]| dofs.iter().map(|&dof| -constant[dof].abs()).collect::<Vec<_>>();
        self.sizes.set(&opposite(self.elimination.slaves()), &opposite(self.elimination.prescribed()))?;
        Ok(self.of_sizes.load_into(&self.sizes, &absolute(k), &absolute(f), sizes)?)
    }

    /// Factors K_q, and fails if the model is not supported, whether or not its factorization succeeded.
    fn check_model(&mut self, k: &[f64]) -> Result<(), EnforceError> {
        let factored = self.factor();
        self.measure(k)?;
        let Self { solver, scale, equations, .. } = self;
        let checked = factored.and_then(|()| check_support(equations, &mut |r| inverse(solver, scale, r)));
        let (motion, resistance) = match checked {
            Ok(SupportVerdict::Supported(_)) => return Ok(()),
            Ok(SupportVerdict::Mechanism(motion, resistance)) => (motion, resistance),
            Err(error) => free_motion(equations, scale.len()).ok_or(error)?,
        };
        let (mut u, mut units) = (vec![0.0; self.elimination.dofs()], vec![0.0; self.elimination.dofs()]);
        self.elimination.expand_increment_into(&scaled(&motion, scale), &mut u)?;
        self.sizes.expand_increment_into(&scaled(&vec![1.0; scale.len()], scale), &mut units)?;
        let sizes: Vec<f64> = u.iter().zip(units).map(|(u, unit)| if *u == 0.0 { 0.0 } else { u / unit }).collect();
        Err(EnforceError::Unsupported(FreeMotion::new(&u, &sizes, resistance)))
    }

    /// Factors K_q in the storage that the solver reads, by columns.
    fn factor(&mut self) -> Result<(), EnforceError> {
        let condensed = &self.condensed;
        let (starts, rows) = (condensed.starts(), condensed.index());
        if condensed.unknowns() == 0 {
            return Ok(());
        }
        // The lower half by rows is the upper half by columns.
        let storage = match (condensed.is_by_columns(), condensed.storage()) {
            (true, storage) => storage,
            (false, Storage::Lower) => Storage::Upper,
            (false, Storage::Upper) => Storage::Lower,
            (false, Storage::Full) => return self.factor_columns(),
        };
        Ok(self.solver.factor(SolverMatrix { starts, rows, values: &self.k_q, storage })?)
    }

    /// Factors the columns of K_q if it is stored by rows.
    fn factor_columns(&mut self) -> Result<(), EnforceError> {
        let pattern = self.equations.a.symbolic();
        let narrow = |index: &[usize]| index.iter().map(|&i| i as u32).collect::<Vec<_>>();
        let (starts, rows) = (narrow(pattern.col_ptr()), narrow(pattern.row_idx()));
        let values: Vec<f64> = self.places.iter().map(|&place| self.k_q[place as usize]).collect();
        let all = SolverMatrix { starts: &starts, rows: &rows, values: &values, storage: Storage::Full };
        Ok(self.solver.factor(all)?)
    }

    /// Scales K_q and the sizes of its terms.
    fn measure(&mut self, k: &[f64]) -> Result<(), EnforceError> {
        let mut sizes = vec![0.0; self.condensed.nnz()];
        self.of_sizes.condense_matrix_into(&self.sizes, &absolute(k), &mut sizes)?;
        let Self { equations, places, k_q, scale, .. } = self;
        let (pattern, values) = equations.a.parts_mut();
        let columns = || (0..pattern.ncols()).flat_map(|j| pattern.row_idx_of_col(j).map(move |i| (i, j)));
        let all = columns().zip(&*places).map(|((i, j), &place)| (i, j, sizes[place as usize]));
        *scale = scales(all, std::iter::empty(), (pattern.ncols(), 0));
        for (e, (i, j)) in columns().enumerate() {
            let (place, power) = (places[e] as usize, scale[i] + scale[j]);
            (values[e], equations.sizes[e]) = (times_power(k_q[place], power), times_power(sizes[place], power));
        }
        Ok(())
    }
}

/// The reduction with the sizes of the entries of T in their place: absolute values, or more for entries that are rounding. G and g are
/// zero.
fn sizes_of(reduction: &Reduction) -> Result<Reduction, EnforceError> {
    let (t, noise) = (reduction.t(), TransformNoise::new(reduction.t()));
    let sizes = (0..t.rows())
        .flat_map(|i| t.row(i).map(move |(q, v)| (i, q, v)))
        .map(|(i, q, v)| noise.size((i, q, t.rows()), v));
    let sizes = Csr::from_parts(t.cols(), t.starts().to_vec(), t.columns().to_vec(), sizes.collect())?;
    let dofs = [reduction.slaves(), reduction.masters(), reduction.prescribed()].map(<[usize]>::to_vec);
    let none = Csr::zero(t.rows(), dofs[2].len())?;
    Ok(Reduction::from_parts(dofs, sizes, none, vec![0.0; t.rows()])?)
}

fn absolute(x: &[f64]) -> Vec<f64> {
    x.iter().map(|x| x.abs()).collect()
}

fn scaled(x: &[f64], scale: &[i32]) -> Vec<f64> {
    x.iter().zip(scale).map(|(x, e)| times_power(*x, *e)).collect()
}

/// The inverse of the scaled matrix S K_q S applied to r: `S^-1 K_q^-1 S^-1 r`, where S holds the scales with the given exponents.
fn inverse(solver: &mut impl Solver, scale: &[i32], r: &[f64]) -> Result<Vec<f64>, EnforceError> {
    let opposite: Vec<i32> = scale.iter().map(|e| -e).collect();
    backsolve(solver, &opposite, r)
}
