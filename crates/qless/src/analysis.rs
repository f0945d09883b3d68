//! The way of the data: equations, scaling, presolve, blocks, backend, classification.
//!
//! Each stage is a plain function from one owned value to the next; [`analyse`] reads from top to bottom.

use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::basis::Basis;
use crate::block::{self, Block, Solved};
use crate::certificate::{Because, History};
use crate::classify::{Dependent, Kind, classify};
use crate::confidence::Confidence;
use crate::generated::{self, Explainer};
use crate::hold::hold_component;
use crate::presolve::eliminate::{Eliminated, eliminate};
use crate::presolve::peel::{Peeled, peel};
use crate::presolve::rows::Row;
use crate::qr::{Backend, BackendError};
use crate::reduction::{self, Reduction};
use crate::scale::{Scaling, equilibrate, ldexp};
use crate::sensitivity;
use crate::{ConstraintSystem, OptionError, Options, Tolerance};

/// Why an analysis could not be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AnalysisError {
    /// A setting out of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// The backend failed.
    #[error(transparent)]
    Backend(#[from] BackendError),
    /// Numbers so large or so small that the scaled right-hand side leaves the range of doubles.
    #[error(
        "row {row}: its right-hand side is too large for its coefficients (ratio beyond 1e308); rescale the equation"
    )]
    Range {
        /// The equation, 0-based.
        row: usize,
    },
}

/// How much work presolve saved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct PresolveStatistics {
    /// Equations taken out with a DOF that occurs in no other (column singletons).
    pub rows_removed_by_column_singletons: usize,
    /// Equations taken out by elimination without fill (row singletons, two-term rows, DOFs in two rows).
    pub rows_removed_by_elimination: usize,
    /// Equations found dependent before any factorization (empty rows included).
    pub rows_found_dependent: usize,
    /// Equations left for the backend.
    pub core_rows: usize,
    /// Free DOFs in them.
    pub core_dofs: usize,
    /// Number of blocks.
    pub blocks: usize,
    /// Rows of the largest block.
    pub largest_block: usize,
}

/// Time spent in each stage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Timings {
    /// Scaling and presolve.
    pub presolve: Duration,
    /// The backend, with everything that follows from its factors.
    pub factor: Duration,
    /// Classification and generated boundary conditions.
    pub classify: Duration,
}

/// The diagnosis of a constraint system.
pub struct Analysis {
    /// What each equation is; length m.
    pub kinds: Vec<Kind>,
    /// Redundant and conflicting equations, ascending by row.
    pub dependent: Vec<Dependent>,
    /// Free DOFs that the equations fix, and their values; ascending.
    pub generated: Vec<(usize, f64)>,
    /// How sure the rank is.
    pub confidence: Confidence,
    /// What presolve did.
    pub presolve: PresolveStatistics,
    /// Time spent.
    pub timings: Timings,
    /// Name and version of the backend.
    pub backend: (&'static str, String),
    options: Options,
    basis: Basis,
    blocks: Vec<Block>,
    history: History,
    scaling: Scaling,
}

/// Diagnoses `C u = b`: rank, dependent equations, generated boundary conditions.
///
/// ```
/// use qless::{Kind, Options, SystemBuilder, analyse};
/// // Three equations that tie three DOFs in a ring: the last follows from the others.
/// let mut builder = SystemBuilder::new(3);
/// builder.equation([(0, 1.0), (1, -1.0)], 0.0);
/// builder.equation([(1, 1.0), (2, -1.0)], 0.0);
/// builder.equation([(0, 1.0), (2, -1.0)], 0.0);
/// let system = builder.build()?;
/// let analysis = analyse(&system, &Options::default())?;
/// assert_eq!((analysis.rank(), analysis.kinds[2]), (2, Kind::Redundant));
/// let because = analysis.because(&analysis.dependent[0]);
/// assert_eq!(because.iter().map(|term| (term.row, term.coefficient)).collect::<Vec<_>>(), [(0, 1.0), (1, 1.0)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`AnalysisError`] where a setting is out of range, a block does not fit into memory, or numbers leave the range of
/// doubles. No input that is a valid [`ConstraintSystem`] makes it panic.
pub fn analyse(system: &ConstraintSystem, options: &Options) -> Result<Analysis, AnalysisError> {
    options.validate()?;
    let backend = options.backend.get()?;
    let tolerance = options.tolerance.value();
    let start = Instant::now();
    let is_free = free(system);
    let scaling = scale(system, &is_free, options.tolerance);
    let mut held = vec![!options.presolve; system.equations()];
    let mut doubt = None;
    loop {
        let stages = Stages::run(system, &is_free, &scaling, &held, backend.as_ref(), tolerance, start)?;
        let near = sensitivity::largest(system, &stages.basis, &stages.history, &scaling, HARMLESS);
        doubt = near.map(|n| n.1).into_iter().chain(doubt).reduce(f64::max);
        // What presolve kept is dependent to within the tolerance: the backend decides.
        match near.filter(|&(_, entry)| entry * tolerance > 1.0) {
            Some((slave, _)) if hold_component(system, slave, &is_free, &mut held) => {}
            _ => return Ok(stages.conclude(system, *options, scaling, backend.as_ref(), doubt)),
        }
    }
}

/// What the stages up to the blocks leave.
struct Stages {
    basis: Basis,
    blocks: Vec<Block>,
    history: History,
    dependent: Vec<Dependent>,
    presolve: PresolveStatistics,
    started: Instant,
    presolved: Instant,
    factored: Instant,
}

impl Stages {
    fn run(
        system: &ConstraintSystem,
        is_free: &[bool],
        scaling: &Scaling,
        held: &[bool],
        backend: &dyn Backend,
        tolerance: f64,
        started: Instant,
    ) -> Result<Self, AnalysisError> {
        let peeled = peel(system, is_free, scaling, held);
        let (names, rows) = gather(system, &peeled, is_free, scaling)?;
        let held: Vec<bool> = names.iter().map(|&i| held[i as usize]).collect();
        let eliminated = eliminate(rows, system.dofs(), &|j| is_free[j as usize], tolerance, &held);
        let presolved = Instant::now();
        let parts = block::split::split(&eliminated.rows, &eliminated.core, is_free);
        let blocks: Vec<Block> = parts.iter().map(|rows| Block::new(&eliminated.rows, rows, is_free)).collect();
        // Blocks are independent: in parallel, in the caller's pool, the result in their order whatever the threads.
        let solved = blocks.par_iter().map(|block| block::solve(block, backend, tolerance));
        let solved = solved.collect::<Result<Vec<Solved>, _>>()?;
        let factored = Instant::now();
        let presolve = statistics(&peeled, &eliminated, &blocks);
        let dependent = classify(&names, &eliminated, &solved, scaling, tolerance);
        let steps = eliminated.steps.iter().map(|step| step.row).collect();
        let history = History { rows: names, factors: eliminated.factors, steps, exponents: scaling.row.clone() };
        let basis = Basis::new(peeled.pivots, eliminated.steps, solved, scaling);
        Ok(Self { basis, blocks, history, dependent, presolve, started, presolved, factored })
    }

    fn conclude(
        self,
        system: &ConstraintSystem,
        options: Options,
        scaling: Scaling,
        backend: &dyn Backend,
        near: Option<f64>,
    ) -> Analysis {
        let generated = generated::find(system, &self.basis, &scaling);
        let confidence = Confidence::new(&self.basis.blocks, near, &self.dependent, system);
        let mut kinds = vec![Kind::Independent; system.equations()];
        self.dependent.iter().for_each(|d| kinds[d.row] = d.kind);
        Analysis {
            kinds,
            confidence,
            dependent: self.dependent,
            generated,
            presolve: self.presolve,
            timings: Timings {
                presolve: self.presolved - self.started,
                factor: self.factored - self.presolved,
                classify: self.factored.elapsed(),
            },
            backend: (backend.name(), backend.version()),
            options,
            basis: self.basis,
            blocks: self.blocks,
            history: self.history,
            scaling,
        }
    }
}

/// Entries of the inverse of the kept equations up to this give no reason for doubt.
const HARMLESS: f64 = 3e5;

fn free(system: &ConstraintSystem) -> Vec<bool> {
    let mut is_free = vec![true; system.dofs()];
    system.prescribed().iter().for_each(|&(j, _)| is_free[j] = false);
    is_free
}

fn scale(system: &ConstraintSystem, is_free: &[bool], tolerance: Tolerance) -> Scaling {
    match tolerance {
        Tolerance::Relative(_) => equilibrate(system, is_free),
        Tolerance::Paper => Scaling { row: vec![0; system.equations()], col: Vec::new() },
    }
}

/// The rows that are left after peeling, scaled, and their numbers in the user's system.
fn gather(
    system: &ConstraintSystem,
    peeled: &Peeled,
    is_free: &[bool],
    scaling: &Scaling,
) -> Result<(Vec<u32>, Vec<Row>), AnalysisError> {
    let mut value = vec![0.0; system.dofs()];
    system.prescribed().iter().for_each(|&(j, v)| value[j] = v);
    let names: Vec<u32> = (0..system.equations() as u32).filter(|&i| peeled.remaining[i as usize]).collect();
    let mut rows = Vec::with_capacity(names.len());
    for &name in &names {
        let i = name as usize;
        let mut row = Row::new(ldexp(system.rhs()[i], scaling.row[i]));
        for (j, v) in system.matrix().row(i) {
            let entry = scaling.entry(i, j, v);
            row.push(j as u32, entry);
            if is_free[j] {
                row.size = row.size.max(entry.abs());
            } else {
                let part = entry * value[j];
                row.effective -= part;
                row.effective_size = row.effective_size.max(part.abs());
                row.effective_error += f64::EPSILON * part.abs();
            }
        }
        if !(row.effective.is_finite() && row.effective_size.is_finite() && row.size.is_finite()) {
            return Err(AnalysisError::Range { row: i });
        }
        rows.push(row);
    }
    Ok((names, rows))
}

fn statistics(peeled: &Peeled, eliminated: &Eliminated, blocks: &[Block]) -> PresolveStatistics {
    PresolveStatistics {
        rows_removed_by_column_singletons: peeled.pivots.len(),
        rows_removed_by_elimination: eliminated.steps.len(),
        rows_found_dependent: eliminated.dead.len(),
        core_rows: eliminated.core.len(),
        core_dofs: blocks.iter().map(|block| block.dofs.len()).sum(),
        blocks: blocks.len(),
        largest_block: blocks.iter().map(|block| block.rows.len()).max().unwrap_or(0),
    }
}

impl Analysis {
    /// Rank of the free part of C, which is the number of slaves.
    pub fn rank(&self) -> usize {
        self.basis.rank()
    }

    /// Why an equation is dependent: `row_k = sum c_i row_i` over its free DOFs, ascending by row.
    pub fn because(&self, dependent: &Dependent) -> Vec<Because> {
        self.history.certificate(dependent.source.0, &dependent.source.1)
    }

    /// Why a DOF of [`Analysis::generated`] is fixed: `e_s = sum c_i row_i` over the free DOFs.
    ///
    /// # Errors
    /// [`BackendError`] if the block of the DOF cannot be factored again.
    pub fn because_fixed(&self, system: &ConstraintSystem, dof: usize) -> Result<Vec<Because>, BackendError> {
        let backend: Box<dyn Backend> = self.options.backend.get()?;
        Explainer::new(system, &self.basis, &self.blocks, &self.history, &self.scaling, backend.as_ref()).because(dof)
    }

    /// `u_s = T u_q + G u_p + g`.
    ///
    /// Conflicting equations are left out, as redundant ones are: the caller decides whether that is wanted.
    pub fn reduction(&self, system: &ConstraintSystem) -> Reduction {
        let independent: Vec<bool> = self.kinds.iter().map(|&kind| kind == Kind::Independent).collect();
        let fixed: Vec<usize> = self.generated.iter().map(|&(dof, _)| dof).collect();
        reduction::build(system, &self.basis, &independent, &fixed, self.options.growth, &self.scaling)
    }
}
