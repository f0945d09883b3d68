//! How sure the rank is, and what to do where it is not.

use qless::{Report, Tolerance};

use super::name;
use super::number::rough;
use crate::diagnose::Diagnosis;

/// One line, and where the rank is ambiguous up to two more with advice.
pub fn lines(diagnosis: &Diagnosis, report: &Report) -> Vec<String> {
    let (kept, dropped) = (report.confidence.sigma_kept, report.confidence.sigma_dropped);
    let (rank, kept_text, dropped_text) = (report.rank, rough(kept), rough(dropped));
    if !report.confidence.ambiguous {
        let dropped = if dropped == 0.0 { "exact zeros".into() } else { format!("at most {dropped_text}") };
        return vec![format!("Rank {rank}, sure: what was kept is at least {kept_text}, what was dropped {dropped}.")];
    }
    let mut lines = vec![format!(
        "Rank {rank}, AMBIGUOUS: kept down to {kept_text}, dropped up to {dropped_text}; another tolerance may change it."
    )];
    match diagnosis.options.tolerance {
        Tolerance::Paper => lines.push("  Without --paper-tolerance the answer does not depend on units.".to_owned()),
        Tolerance::Relative(_) => lines.extend(advice(diagnosis, kept, dropped)),
    }
    lines
}

fn advice(diagnosis: &Diagnosis, kept: f64, dropped: f64) -> Vec<String> {
    let looser = (10.0 * kept).max(1e-9);
    let nearly = format!(
        "  Some kept equations nearly repeat others. If only rounding sets them apart: --tolerance {}",
        rough(looser)
    );
    let tighter = dropped / 10.0;
    let largest = diagnosis.analysis.dependent.iter().max_by(|a, b| a.dropped.total_cmp(&b.dropped));
    let remains = largest.map(|equation| {
        let name = name::equation(&diagnosis.system, equation.row);
        format!("  {name} differs from its combination. If that is meant: --tolerance {}", rough(tighter))
    });
    let nearly = (kept < 3e-6).then_some(nearly);
    nearly.into_iter().chain(remains.filter(|_| dropped > 1e-13)).collect()
}
