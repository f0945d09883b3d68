//! The way of the data: equations, scaling, presolve, blocks, backend, classification.
//!
//! Each stage is a plain function from one owned value to the next; [`analyse`] reads from top to bottom.

use std::time::Instant;

use super::stages::{Run, Settled};
use super::{Analysis, AnalysisError};
use crate::block::Means;
use crate::generated;
use crate::keep::keep;
use crate::local::{Column, Exponents, Local, Numbering};
use crate::preferences::Wishes;
use crate::scale::{Scaling, Spread, balanced, by_rows};
use crate::sweep::{SEED, sweep};
use crate::{ConstraintSystem, Options, Tolerance};

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
    let run =
        Run { local, columns: &columns, scaling: &rows, wishes: &wishes, means: Means::new(backend.as_ref(), options) };
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
    let mut rhs = system.rhs().to_vec();
    if !kept.overruled.is_empty() {
        // Equations given up for ones that they contradict leave their trace in the constants: once more without it.
        kept.overruled.iter().for_each(|&(i, excess)| rhs[i] -= excess);
        run.local = numbering.view(system, &rhs);
        let agreeing = run.stages(&held, start)?;
        (stages.basis, stages.blocks) = (agreeing.basis, agreeing.blocks);
        stages.swept = sweep(local, &stages.basis, &agreeing.history, &scaling, SEED);
    }
    let still = std::mem::take(&mut stages.swept.still);
    let generated = generated::find(still, local, &stages.basis, &stages.history, &scaling);
    Ok(stages.conclude(numbering, scaling, rhs, options.clone(), generated, confidence, kept.unmet, backend.as_ref()))
}

/// Of two scalings that with the surer rank; the doubt of both remains.
fn surer(a: (Scaling, Settled), b: (Scaling, Settled)) -> (Scaling, Settled) {
    let confidences = (a.1.2, b.1.2);
    let differ = a.1.0.basis.rank() != b.1.0.basis.rank();
    let first = confidences.1.ambiguous && confidences.0.sigma_kept > confidences.1.sigma_kept;
    let (scaling, (stages, held, _)) = if first { a } else { b };
    (scaling, (stages, held, confidences.0.or_less(confidences.1, differ)))
}

fn scale(system: Local, columns: &[Column], exponents: &[Exponents], tolerance: Tolerance) -> (Scaling, Spread) {
    match tolerance {
        Tolerance::Relative(_) => by_rows(system, columns, exponents),
        Tolerance::Paper => (Scaling::none(system.equations()), Spread::Even),
    }
}
