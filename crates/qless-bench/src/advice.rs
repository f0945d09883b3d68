//! What each effort costs, as measured, and five sentences of advice.

use std::fmt::Write;

use super::methods::{BenchMethod, EFFORTS, UNIT};
use super::sample::{Measured, Sample, verdict};

const SENTENCES: &str = "
- Take `checked`, the default, for models that are solved once they are sound: doubt is said, and where presolve settles all it costs less than one factorization.
- Take `quick` where the same model was checked before and only its numbers changed, as in a parameter study: a wrong rank passes without a word.
- Take `proved` where a verdict must not rest on an estimate, as for a report that others sign: what has no proof is called ambiguous.
- Take `exact` where numbers were typed and are meant as typed, as in a benchmark or a dispute over one equation; computed coefficients are independent to the last digit, and it says so.
- If `checked` says ambiguous, `exact` settles it for typed numbers; for computed ones only their author can.
";

/// The section of the page.
pub fn advice(samples: &[Sample], methods: &[BenchMethod]) -> String {
    let mut text = "## Which effort\n\n| method | median time in bare QRs, least to most | systems | wrong without a word | in doubt | worst residual | peak MiB |\n\
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
    let residual = compared.iter().map(|(.., own)| own.residual).fold(0.0, f64::max);
    let peak = compared.iter().filter_map(|(.., own)| own.memory).max();
    let peak = peak.map_or_else(|| "-".to_owned(), |bytes| format!("{:.0}", bytes as f64 / f64::from(1 << 20)));
    _ = writeln!(text, "| {name} | {times} | {} | {silent} | {doubtful} | {residual:.0e} | {peak} |", compared.len());
}

/// The results of a method on the systems on which the unit was measured too, with the ratio of their times.
fn compared<'a>(samples: &'a [Sample], methods: usize, name: &str) -> Vec<(f64, &'a Sample, Measured)> {
    let pairs = samples.chunks(methods).filter_map(|block| {
        let unit = block.iter().find(|sample| sample.method == UNIT)?.measured()?;
        let sample = block.iter().find(|sample| sample.method == name)?;
        let own = sample.measured()?;
        Some((own.time / unit.time, sample, own))
    });
    pairs.collect()
}
