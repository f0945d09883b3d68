//! The way of the data: equations, scaling, presolve, blocks, backend, classification.
//!
//! Each stage is a plain function from one owned value to the next; [`analyse`] reads from top to bottom.

use std::collections::BTreeMap;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::basis::Basis;
use crate::block::{self, Block, Solved};
use crate::certificate::{Because, History};
use crate::classify::{Dependent, Kind, Source, classify};
use crate::confidence::Confidence;
use crate::generated::{self, Explainer, Generated};
use crate::hold::hold_component;
use crate::keep::{add, keep};
use crate::local::{Column, Exponents, Local, Numbering};
use crate::preferences::Wishes;
use crate::presolve::eliminate::{Eliminated, eliminate};
use crate::presolve::gather::gather;
use crate::presolve::peel::{Peeled, peel};
use crate::qr::{Backend, BackendError};
use crate::reduction::{self, Basics, Reduction};
use crate::scale::{Scaling, Spread, balanced, by_rows};
use crate::sensitivity;
use crate::sweep::sweep;
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
    /// Equations of [`crate::Preferences::equations`] that are dependent on other such equations only, ascending.
    pub unmet_equations: Vec<usize>,
    /// How sure the rank is.
    pub confidence: Confidence,
    /// What presolve did.
    pub presolve: PresolveStatistics,
    /// Time spent.
    pub timings: Timings,
    /// Name and version of the backend.
    pub backend: (&'static str, String),
    pub(crate) options: Options,
    pub(crate) basis: Basis,
    pub(crate) blocks: Vec<Block>,
    pub(crate) history: History,
    pub(crate) scaling: Scaling,
    pub(crate) numbering: Numbering,
    /// Local numbers of [`Analysis::generated`].
    pub(crate) fixed: Vec<u32>,
    times: OnceLock<Vec<u32>>,
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
    options.preferences.validate(system)?;
    let backend = options.backend.get(options.memory)?;
    let tolerance = options.tolerance.value();
    let start = Instant::now();
    let (numbering, columns, exponents) = Numbering::new(system);
    let local = numbering.view(system, system.rhs());
    let wishes = Wishes::new(&options.preferences, &numbering, system.dofs());
    let (rows, spread) = scale(local, &columns, &exponents, options.tolerance);
    let run = Run {
        local,
        columns: &columns,
        scaling: &rows,
        wishes: &wishes,
        backend: backend.as_ref(),
        tolerance,
        check: options.check,
    };
    let settle = |scaling: &Scaling| Run { scaling, ..run }.settle(system, options.presolve, start);
    let (scaling, (mut stages, held, confidence)) = if spread == Spread::UnitsMix {
        let scaling = balanced(local, &exponents);
        let settled = settle(&scaling)?;
        (scaling, settled)
    } else {
        let settled = settle(&rows)?;
        if spread == Spread::SomeTiny && settled.2.ambiguous {
            let other = balanced(local, &exponents);
            let compared = settle(&other)?;
            surer((rows.clone(), settled), (other, compared))
        } else {
            (rows.clone(), settled)
        }
    };
    let mut run = Run { scaling: &scaling, ..run };
    let kept = keep(&options.preferences.equations, &mut stages.dependent, &stages.history, &scaling, tolerance);
    if !kept.overruled.is_empty() {
        // Equations given up for ones that they contradict leave their trace in the constants: once more without it.
        let mut rhs = system.rhs().to_vec();
        kept.overruled.iter().for_each(|&(i, excess)| rhs[i] -= excess);
        run.local = numbering.view(system, &rhs);
        let agreeing = run.stages(&held, start)?;
        (stages.basis, stages.blocks) = (agreeing.basis, agreeing.blocks);
        stages.still = sweep(local, &stages.basis, &agreeing.history, &scaling, SEED).still;
    }
    let still = std::mem::take(&mut stages.still);
    let generated = generated::find(still, local, &stages.basis, &stages.history, &scaling);
    Ok(stages.conclude(numbering, scaling, options.clone(), generated, confidence, kept.unmet, backend.as_ref()))
}

/// Stages, rows held back from presolve, and how sure their rank is.
type Settled = (Stages, Vec<bool>, Confidence);

/// Of two scalings that with the surer rank; the doubt of both remains.
fn surer(a: (Scaling, Settled), b: (Scaling, Settled)) -> (Scaling, Settled) {
    let confidences = (a.1.2, b.1.2);
    let differ = a.1.0.basis.rank() != b.1.0.basis.rank();
    let first = confidences.1.ambiguous && confidences.0.sigma_kept > confidences.1.sigma_kept;
    let (scaling, (stages, held, _)) = if first { a } else { b };
    (scaling, (stages, held, confidences.0.or_less(confidences.1, differ)))
}

/// What every run of the stages needs.
#[derive(Clone, Copy)]
struct Run<'a> {
    local: Local<'a>,
    columns: &'a [Column],
    scaling: &'a Scaling,
    wishes: &'a Wishes,
    backend: &'a dyn Backend,
    tolerance: f64,
    check: bool,
}

/// What the stages up to the blocks leave.
struct Stages {
    basis: Basis,
    blocks: Vec<Block>,
    history: History,
    dependent: Vec<Dependent>,
    /// Slaves that may move with no master.
    still: Vec<u32>,
    presolve: PresolveStatistics,
    started: Instant,
    presolved: Instant,
    factored: Instant,
}

impl Run<'_> {
    /// The stages, repeated with rows held back from presolve until what it keeps is sound; with the rows held back.
    fn settle(&self, system: &ConstraintSystem, presolve: bool, started: Instant) -> Result<Settled, AnalysisError> {
        let Self { local, scaling, tolerance, .. } = *self;
        let mut held = vec![!presolve; local.equations()];
        let mut doubt = None;
        loop {
            let mut stages = self.stages(&held, started)?;
            let swept = sweep(local, &stages.basis, &stages.history, scaling, SEED);
            stages.still = swept.still;
            let worst = swept.worst.filter(|_| self.check);
            let near = sensitivity::largest(worst, &stages.basis, &stages.history, scaling, local.dofs());
            doubt = near.map(|n| n.1).into_iter().chain(doubt).reduce(f64::max);
            // What presolve kept is dependent to within the tolerance: the backend decides.
            match near.filter(|&(_, entry)| entry * tolerance > 1.0) {
                Some((slave, _)) if hold_component(local, slave, &mut held) => {}
                _ => {
                    let confidence = Confidence::new(&stages.basis.blocks, doubt, &stages.dependent, system);
                    return Ok((stages, held, confidence));
                }
            }
        }
    }

    fn stages(&self, held: &[bool], started: Instant) -> Result<Stages, AnalysisError> {
        let Self { local, columns, scaling, wishes, backend, tolerance, check } = *self;
        let peeled = peel(local, columns, scaling, wishes, Some(held));
        let gathered = gather(local, &peeled.remaining, scaling).map_err(|row| AnalysisError::Range { row: row.0 })?;
        let eliminated = eliminate(gathered, tolerance, held);
        let presolved = Instant::now();
        let parts = block::split::split(&eliminated.rows, &eliminated.core, local.free());
        let blocks: Vec<Block> = parts.iter().map(|rows| Block::new(&eliminated.rows, rows, local.free())).collect();
        // Blocks are independent: in parallel, in the caller's pool, the result in their order whatever the threads.
        let solve = |block: &Block| block::solve(block, backend, tolerance, check);
        let solved: Result<Vec<Solved>, _> = match blocks.as_slice() {
            few @ ([] | [_]) => few.iter().map(solve).collect(),
            many => many.par_iter().map(solve).collect(),
        };
        let solved = solved?;
        let factored = Instant::now();
        let presolve = statistics(&peeled, &eliminated, &blocks);
        let dependent = classify(&eliminated, &solved, scaling, tolerance);
        let steps = eliminated.steps.iter().map(|step| step.row).collect();
        let (rows, factors) = (eliminated.names, eliminated.factors);
        let history = History { rows, factors, steps, exponents: scaling.row.clone() };
        let mut basis = peeled.basis;
        basis.extend(eliminated.steps, solved, scaling);
        Ok(Stages { basis, blocks, history, dependent, still: Vec::new(), presolve, started, presolved, factored })
    }
}

impl Stages {
    #[expect(clippy::too_many_arguments, reason = "every part of the analysis, once")]
    fn conclude(
        self,
        numbering: Numbering,
        scaling: Scaling,
        options: Options,
        generated: Generated,
        confidence: Confidence,
        unmet_equations: Vec<usize>,
        backend: &dyn Backend,
    ) -> Analysis {
        let mut kinds = vec![Kind::Independent; self.history.exponents.len()];
        self.dependent.iter().for_each(|d| kinds[d.row] = d.kind);
        Analysis {
            kinds,
            confidence,
            dependent: self.dependent,
            generated: generated.values,
            unmet_equations,
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
            numbering,
            fixed: generated.dofs,
            times: OnceLock::new(),
        }
    }
}

/// Of the random masters that tell which DOFs are fixed.
const SEED: u64 = 0x9e37_79b9;

fn scale(system: Local, columns: &[Column], exponents: &[Exponents], tolerance: Tolerance) -> (Scaling, Spread) {
    match tolerance {
        Tolerance::Relative(_) => by_rows(system, columns, exponents),
        Tolerance::Paper => (Scaling::none(system.equations()), Spread::Even),
    }
}

fn statistics(peeled: &Peeled, eliminated: &Eliminated, blocks: &[Block]) -> PresolveStatistics {
    PresolveStatistics {
        rows_removed_by_column_singletons: peeled.basis.peeled.len(),
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
        dependent.source.explain(&self.history)
    }

    /// Why a DOF of [`Analysis::generated`] is fixed: `e_s = sum c_i row_i` over the free DOFs; empty for any other DOF.
    ///
    /// # Errors
    /// [`BackendError`] if the block of the DOF cannot be factored again.
    pub fn because_fixed(&self, system: &ConstraintSystem, dof: usize) -> Result<Vec<Because>, BackendError> {
        let Ok(place) = self.generated.binary_search_by_key(&dof, |&(j, _)| j) else { return Ok(Vec::new()) };
        let backend: Box<dyn Backend> = self.options.backend.get(self.options.memory)?;
        let explainer = Explainer {
            system: self.numbering.view(system, system.rhs()),
            basis: &self.basis,
            blocks: &self.blocks,
            history: &self.history,
            scaling: &self.scaling,
            backend: backend.as_ref(),
            time: self.times.get_or_init(|| generated::times(&self.basis, self.numbering.dofs.len())),
        };
        explainer.because(self.fixed[place]).map(|terms| self.over_kept(terms))
    }

    /// Replaces equations that were given up for others by their certificates.
    fn over_kept(&self, terms: Vec<Because>) -> Vec<Because> {
        let given =
            |row: usize| match &self.dependent[self.dependent.binary_search_by_key(&row, |d| d.row).ok()?].source {
                Source::Given(because) => Some(because),
                Source::Traced(..) => None,
            };
        if !terms.iter().any(|term| given(term.row).is_some()) {
            return terms;
        }
        let mut sum = BTreeMap::new();
        for Because { row, coefficient } in terms {
            match given(row) {
                Some(parts) => parts.iter().for_each(|part| add(&mut sum, part.row, coefficient * part.coefficient)),
                None => add(&mut sum, row, coefficient),
            }
        }
        sum.into_iter().map(|(row, coefficient)| Because { row, coefficient }).collect()
    }

    /// `u_s = T u_q + G u_p + g`.
    ///
    /// Conflicting equations are left out, as redundant ones are: the caller decides whether that is wanted.
    pub fn reduction(&self, system: &ConstraintSystem) -> Reduction {
        let mut fixed = vec![false; if self.fixed.is_empty() { 0 } else { self.numbering.dofs.len() }];
        self.fixed.iter().for_each(|&j| fixed[j as usize] = true);
        let basics = Basics {
            basis: &self.basis,
            fixed,
            wishes: Wishes::new(&self.options.preferences, &self.numbering, system.dofs()),
            growth: self.options.growth,
        };
        let local = self.numbering.view(system, system.rhs());
        reduction::build(system, local, &basics).compare(&self.options.preferences)
    }

    /// How well a reduction meets the independent equations: for random u_q and u_p
    /// `max_i |C_i u - b_i| / (|C_i D| 1 max_j(s_j / d_j) + |b_i|)`, where s_j is the sum of the sizes of the parts that make
    /// u_j and D the scaling of columns (1 unless units mix).
    ///
    /// About 1e-16 times the condition of the kept equations, `1 / confidence.sigma_kept`. One pass over C and T.
    pub fn residual(&self, system: &ConstraintSystem, reduction: &Reduction) -> f64 {
        let independent: Vec<bool> = self.kinds.iter().map(|&kind| kind == Kind::Independent).collect();
        let local = self.numbering.view(system, system.rhs());
        reduction::residual::residual(local, reduction, &independent, &self.scaling)
    }
}
