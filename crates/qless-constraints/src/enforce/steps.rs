//! The same model, step after step: `K_q u_q = f_q`, `u = L u_q + u_0`, with the analysis, the pattern and the solver's analysis made once.

use qless::{ArgumentError, Condensed, Given, Index, Map, Storage, View};

use super::EnforceError;
use super::solver::{Columns, Solver};

/// A map, the pattern of K condensed by it, and a solver; owned, to be kept beside the model.
///
/// ```
/// use qless::{Map, Options, SystemBuilder, View};
/// use qless_constraints::enforce::{Llt, Steps};
/// // Two springs of stiffness 2 and 4 to the ground, tied with a gap that grows, under a load of 3.
/// let mut builder = SystemBuilder::new(2);
/// builder.equation([(0, 1.0), (1, -1.0)], 0.0);
/// let map = Map::new(&builder.build()?, &Options::default())?;
/// let mut steps = Steps::new(map, View::columns(&[0, 1, 2], &[0_u32, 1]), Llt::default())?;
/// let mut u = [0.0; 2];
/// for gap in [0.0, 0.75, 1.5] {
///     steps.map_mut().refresh(&[gap], &[])?;
///     steps.solve(&[2.0, 4.0], &[3.0, 0.0], &mut u)?;
///     assert!((u[0] - (0.5 + gap * 2.0 / 3.0)).abs() < 1e-14 && (u[0] - u[1] - gap).abs() < 1e-14);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Steps<S> {
    map: Map,
    condensed: Condensed,
    solver: S,
    /// Of rows of a matrix that need not be symmetric: the columns of K_q.
    turned: Option<Turned>,
    /// What is stored of the columns.
    storage: Storage,
    k_q: Vec<f64>,
    x: Vec<f64>,
}

/// Columns made of rows.
#[derive(Debug)]
struct Turned {
    starts: Vec<u32>,
    rows: Vec<u32>,
    /// For each entry its place by rows.
    places: Vec<u32>,
    values: Vec<f64>,
}

impl<S: Solver> Steps<S> {
    /// For matrices of the pattern of K.
    ///
    /// # Errors
    /// [`EnforceError::Map`] if the arrays are no pattern, [`EnforceError::Factored`] if parts of T stay factors.
    pub fn new<P: Index, I: Index>(map: Map, k: View<P, I>, solver: S) -> Result<Self, EnforceError> {
        if !map.reduction().is_explicit() {
            return Err(EnforceError::Factored);
        }
        let condensed = map.condensed(k, Given::Eliminated)?;
        // Rows of a half are columns of the other one.
        let storage = match (condensed.is_by_columns(), condensed.storage()) {
            (false, Storage::Lower) => Storage::Upper,
            (false, Storage::Upper) => Storage::Lower,
            (_, storage) => storage,
        };
        let is_turned = !condensed.is_by_columns() && storage == Storage::Full;
        let turned = is_turned.then(|| Turned::new(&condensed));
        let (k_q, x) = (vec![0.0; condensed.nnz()], vec![0.0; condensed.unknowns()]);
        Ok(Self { map, condensed, solver, turned, storage, k_q, x })
    }

    /// The constraints.
    pub fn map(&self) -> &Map {
        &self.map
    }

    /// The constraints, to be refreshed.
    pub fn map_mut(&mut self) -> &mut Map {
        &mut self.map
    }

    /// The pattern of K_q.
    pub fn condensed(&self) -> &Condensed {
        &self.condensed
    }

    /// u of all DOFs for values of K and forces: condensed, factored and solved.
    ///
    /// # Errors
    /// [`EnforceError::Argument`] for lists that do not fit or numbers that are not finite, [`EnforceError::Solver`].
    pub fn solve(&mut self, k: &[f64], f: &[f64], u: &mut [f64]) -> Result<(), EnforceError> {
        self.condensed.condense_matrix_into(&self.map, k, &mut self.k_q)?;
        let storage = self.storage;
        let columns = match &mut self.turned {
            None => {
                Columns { starts: self.condensed.starts(), rows: self.condensed.index(), values: &self.k_q, storage }
            }
            Some(turned) => turned.columns(&self.k_q),
        };
        self.solver.factor(columns)?;
        self.solve_again(k, f, u)
    }

    /// The same for other forces, or after a refresh, with the factors of the last [`Steps::solve`]; K must be the same.
    ///
    /// # Errors
    /// As [`Steps::solve`].
    pub fn solve_again(&mut self, k: &[f64], f: &[f64], u: &mut [f64]) -> Result<(), EnforceError> {
        self.condensed.load_into(&self.map, k, f, &mut self.x)?;
        self.solver.solve(&mut self.x)?;
        self.map.expand_into(&self.x, u).map_err(|error| match error {
            // What a singular matrix gives.
            ArgumentError::NotFinite { .. } => EnforceError::Singular { what: "the reduced stiffness" },
            other => other.into(),
        })
    }
}

impl Turned {
    fn new(condensed: &Condensed) -> Self {
        let (n, by_row) = (condensed.unknowns(), condensed.starts());
        let mut starts = vec![0_u32; n + 1];
        condensed.index().iter().for_each(|&j| starts[j as usize + 1] += 1);
        (0..n).for_each(|j| starts[j + 1] += starts[j]);
        let mut next = starts.clone();
        let (mut rows, mut places) = (vec![0; condensed.nnz()], vec![0; condensed.nnz()]);
        for i in 0..n {
            for place in by_row[i]..by_row[i + 1] {
                let slot = &mut next[condensed.index()[place as usize] as usize];
                rows[*slot as usize] = i as u32;
                places[*slot as usize] = place;
                *slot += 1;
            }
        }
        Self { starts, rows, places, values: vec![0.0; condensed.nnz()] }
    }

    fn columns(&mut self, k_q: &[f64]) -> Columns<'_> {
        self.values.iter_mut().zip(&self.places).for_each(|(value, &place)| *value = k_q[place as usize]);
        Columns { starts: &self.starts, rows: &self.rows, values: &self.values, storage: Storage::Full }
    }
}
