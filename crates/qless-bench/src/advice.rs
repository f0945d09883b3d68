//! The measured cost of each effort, and five sentences of advice.

use std::fmt::Write;

use super::methods::{BenchMethod, EFFORTS, UNIT};
use super::sample::{Measured, Sample, verdict};

const SENTENCES: &str = "
- Take `checked`, the default, for models that are solved after the check: it reports doubt, and costs less than one factorization if presolve handles all equations.
- Take `quick` if the same model was checked before and only its numbers changed, as in a parameter study: a wrong rank causes no warning.
- Take `proved` if a verdict must not depend on an estimate, as for a report that others sign: a verdict without a proof is called ambiguous.
- Take `exact` if numbers were typed and are exact as typed, as in a benchmark or a dispute over one equation. Computed coefficients make equations independent in the last digit, and `exact` reports them as independent.
- If `checked` calls a rank ambiguous, `exact` decides it for typed numbers; for computed numbers only their author can.
";

/// The section of the page with the cost of each effort and the advice.
pub fn advice(samples: &[Sample], methods: &[BenchMethod]) -> String {
    let mut text = "## Which effort\n\n| method | median time in bare QRs, least to most | systems | wrong without a warning | in doubt | worst residual | peak MiB |\n\
                    | --- | --- | --- | --- | --- | --- | --- |\n"
        .to_owned();
    for name in EFFORTS.map(qless::Effort::name) {
        if methods.iter().any(|method| method.name == name) {
            line(&mut text, name, &compared(samples, methods.len(), name));
        }
    }
    text + SENTENCES
}

fn line(text: &mut String, name: &str, compared: &[(f64, &Sample, Measured)]) {
    let mut ratios: Vec<f64> = compared.iter().map(|&(ratio, ..)| ratio).filter(|ratio| ratio.is_finite()).collect();
    ratios.sort_by(f64::total_cmp);
    let times = match ratios.as_slice() {
        [] => "-".to_owned(),
        all => format!("{:.2}, {:.2} to {:.2}", all[all.len() / 2], all[0], all[all.len() - 1]),
    };
    let silent = compared.iter().filter(|(_, sample, own)| verdict(sample, own) != "right" && !own.ambiguous).count();
    let doubtful = compared.iter().filter(|(.., own)| own.ambiguous).count();
    let residual = compared.iter().filter_map(|(.., own)| own.residual).fold(0.0, f64::max);
    let peak = compared.iter().filter_map(|(.., own)| own.memory).max();
    let peak = peak.map_or_else(|| "-".to_owned(), |bytes| format!("{:.0}", bytes as f64 / f64::from(1 << 20)));
    _ = writeln!(text, "| {name} | {times} | {} | {silent} | {doubtful} | {residual:.0e} | {peak} |", compared.len());
}

/// The results of a method on the systems on which the bare factorization was measured too, each with the ratio of the two times.
fn compared<'a>(samples: &'a [Sample], methods: usize, name: &str) -> Vec<(f64, &'a Sample, Measured)> {
    let pairs = samples.chunks(methods).filter_map(|block| {
        let unit = block.iter().find(|sample| sample.method == UNIT)?.measured()?;
        let sample = block.iter().find(|sample| sample.method == name)?;
        let own = sample.measured()?;
        Some((own.time / unit.time, sample, own))
    });
    pairs.collect()
}
