//! The samples as a table: for people and as CSV.

use std::fmt::Write;

use super::measure::{Measured, Sample};
use super::methods::Method;

/// Columns of the CSV file.
pub const COLUMNS: [&str; 13] = [
    "family",
    "size",
    "equations",
    "method",
    "ms",
    "ms_lower_quartile",
    "ms_upper_quartile",
    "rank",
    "rank_true",
    "verdict",
    "ambiguous",
    "residual",
    "growth",
];

/// Whether the rank is right.
pub fn verdict(sample: &Sample, measured: &Measured) -> &'static str {
    match measured.rank.cmp(&sample.rank) {
        std::cmp::Ordering::Equal => "right",
        std::cmp::Ordering::Less => "drops",
        std::cmp::Ordering::Greater => "keeps",
    }
}

/// A block for each system.
pub fn text(samples: &[Sample], methods: &[Method]) -> String {
    let threads = rayon::current_num_threads();
    let mut text = format!("qless {} on {threads} threads\n", env!("CARGO_PKG_VERSION"));
    for block in samples.chunks(methods.len()) {
        let Sample { family, size, equations, rank, .. } = &block[0];
        _ = writeln!(text, "\n{family} {size}: {equations} equations of rank {rank}");
        _ = writeln!(
            text,
            "  {:<20}{:>10}{:>16}  {:<14}{:>10}{:>9}",
            "method", "ms", "quartiles", "rank", "residual", "growth"
        );
        block.iter().for_each(|sample| line(&mut text, sample));
    }
    text
}

fn line(text: &mut String, sample: &Sample) {
    let Some(measured) = &sample.result else {
        _ = writeln!(text, "  {:<20}{:>10}", sample.method, "given up");
        return;
    };
    let off = measured.rank.abs_diff(sample.rank);
    let rank = match (verdict(sample, measured), measured.ambiguous) {
        ("right", false) => "right".to_owned(),
        ("right", true) => "right, unsure".to_owned(),
        (wrong, false) => format!("{wrong} {off}"),
        (wrong, true) => format!("{wrong} {off}, unsure"),
    };
    let (low, high) = measured.quartiles;
    let quartiles = format!("{:.2}-{:.2}", 1e3 * low, 1e3 * high);
    _ = writeln!(
        text,
        "  {:<20}{:>10.2}{quartiles:>16}  {rank:<14}{:>10.1e}{:>9.2}",
        sample.method,
        1e3 * measured.time,
        measured.residual,
        measured.growth
    );
}

/// One line for each sample; what was given up has no numbers.
pub fn csv(samples: &[Sample]) -> String {
    let mut text = COLUMNS.join(",") + "\n";
    for sample in samples {
        let Sample { family, size, equations, method, rank, .. } = sample;
        _ = match &sample.result {
            None => writeln!(text, "{family},{size},{equations},{method},,,,,{rank},given up,,,"),
            Some(m) => writeln!(
                text,
                "{family},{size},{equations},{method},{:.4},{:.4},{:.4},{},{rank},{},{},{:e},{}",
                1e3 * m.time,
                1e3 * m.quartiles.0,
                1e3 * m.quartiles.1,
                m.rank,
                verdict(sample, m),
                m.ambiguous,
                m.residual,
                m.growth
            ),
        };
    }
    text
}
