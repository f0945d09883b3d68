//! The way of the data: equations, scaling, presolve, blocks, backend, classification.
//!
//! Each stage is a plain function from one owned value to the next; [`analyse`] reads from top to bottom.

use std::collections::HashSet;
use std::time::Instant;

use super::stages::{Run, Settled};
use super::{Analysis, AnalysisError};
use crate::diagnosis::generated;
use crate::diagnosis::samples::{Inverse, Sample, sweep};
use crate::diagnosis::wanted::keep;
use crate::factor::block::Means;
use crate::input::numbering::{Column, Exponents, Local, Numbering};
use crate::input::preferences::Wishes;
use crate::input::rounding;
use crate::input::scale::{Scaling, Spread, Spreads, balanced, by_rows};
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
/// assert_eq!((analysis.rank(), analysis.kinds()[2]), (2, Kind::Redundant));
/// let because = analysis.because(2)?;
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
    let start = Instant::now();
    let numbered = Numbering::new(system);
    if let Some(row) = numbered.2.iter().position(|of_row| of_row.is_subnormal()) {
        return Err(AnalysisError::Subnormal { row });
    }
    let (numbering, columns, exponents) = numbered;
    let backend = options.backend.get(options.memory)?;
    let tolerance = options.tolerance.value();
    let local = numbering.view(system, system.rhs());
    let is_relative = matches!(options.tolerance, Tolerance::Relative(_));
    let ignored = if is_relative { rounding::find(local, &exponents) } else { Vec::new() };
    let uncertain = rounding::places(&ignored, local);
    let wishes = Wishes::new(&options.preferences, &numbering, system.dofs());
    let (rows, spreads) = scale(local, &columns, &exponents, &uncertain, options.tolerance);
    let run = Run {
        local,
        columns: &columns,
        scaling: &rows,
        wishes: &wishes,
        uncertain: &uncertain,
        means: Means::new(backend.as_ref(), options),
    };
    let settle = |scaling: &Scaling| Run { scaling, ..run }.settle(options.presolve, start);
    let (scaling, settled) = match spreads.filter(|_| options.balance) {
        None => (rows.clone(), settle(&rows)?),
        Some(spreads) => surest(&rows, &spreads, settle, |which| balanced(local, &exponents, &rows, which))?,
    };
    let Settled { mut stages, held, confidence, .. } = settled;
    let mut run = Run { scaling: &scaling, ..run };
    let kept = keep(&options.preferences.equations, &mut stages.dependent, &stages.history, &scaling, tolerance);
    let mut rhs = system.rhs().to_vec();
    if !kept.overruled.is_empty() {
        // Equations given up for ones that they contradict leave their trace in the constants: once more without it.
        kept.overruled.iter().for_each(|&(i, excess)| rhs[i] -= excess);
        run.local = numbering.view(system, &rhs);
        let agreeing = run.stages(&held, start)?;
        (stages.basis, stages.blocks) = (agreeing.basis, agreeing.blocks);
        stages.swept =
            sweep(local, &stages.basis, &agreeing.history, &scaling, &stages.keys, Sample::First, Inverse::Bound);
    }
    let still = std::mem::take(&mut stages.swept.still);
    let generated = generated::find(still, local, &stages.basis, &stages.history, &scaling, &stages.keys);
    let analysis = stages.conclude(
        system.clone(),
        numbering,
        scaling,
        rhs,
        options.clone(),
        generated,
        confidence,
        kept.unmet,
        backend.as_ref(),
    );
    Ok(Analysis { ignored, ..analysis })
}

/// Balances components in which units mix and no others; where the rank is then in doubt, tries the other way, and takes what is surer.
/// The doubt remains.
fn surest(
    rows: &Scaling,
    spreads: &Spreads,
    settle: impl Fn(&Scaling) -> Result<Settled, AnalysisError>,
    balanced: impl Fn(&[bool]) -> Scaling,
) -> Result<(Scaling, Settled), AnalysisError> {
    let mixed = |k: usize| spreads.of[k] == Spread::UnitsMix;
    let scaled = |which: &dyn Fn(usize) -> bool| {
        if (0..spreads.of.len()).any(which) { balanced(&spreads.equations(which)) } else { rows.clone() }
    };
    let first = scaled(&mixed);
    let plain = settle(&first)?;
    let doubted = plain.doubted(&spreads.labels);
    let tried = |k: usize| spreads.of[k] != Spread::Even && doubted[k];
    if !(0..spreads.of.len()).any(tried) {
        return Ok((first, plain));
    }
    let second = scaled(&|k| mixed(k) != tried(k));
    let other = settle(&second)?;
    let (before, after) = (plain.sigmas(&spreads.labels), other.sigmas(&spreads.labels));
    let still = other.doubted(&spreads.labels);
    let dependent = [&plain, &other].map(|settled| settled.stages.dependent_by(&spreads.labels));
    // Rows that are independent in any scaling are, so that fewer dependent ones speak for rows as they are where units mix; small columns that
    // look like zeros do not.
    let is_worse = |k: usize| {
        if mixed(k) { dependent[1][k] >= dependent[0][k] } else { still[k] && before[k] > after[k] }
    };
    let back = |k: usize| tried(k) && is_worse(k);
    let confidence = plain.confidence.or_less(other.confidence);
    let (scaling, settled) = if (0..spreads.of.len()).any(back) {
        let third = scaled(&|k| mixed(k) != (tried(k) && !back(k)));
        let settled = settle(&third)?;
        (third, settled)
    } else {
        (second, other)
    };
    Ok((scaling, Settled { confidence, ..settled }))
}

fn scale(
    system: Local,
    columns: &[Column],
    exponents: &[Exponents],
    uncertain: &HashSet<(u32, u32)>,
    tolerance: Tolerance,
) -> (Scaling, Option<Spreads>) {
    match tolerance {
        Tolerance::Relative(_) => by_rows(system, columns, exponents, uncertain),
        Tolerance::Paper => (Scaling::none(system.equations()), None),
    }
}
