//! The samples as a table: for people and as CSV.

use std::fmt::Write;

use super::methods::BenchMethod;
use super::sample::{Measured, Sample, Series, verdict};
use super::systems::TIE;

/// Columns of the CSV file.
pub const COLUMNS: &str = "family,size,equations,method,ms,ms_lower_quartile,ms_upper_quartile,times_first,peak_bytes,rank,\
     rank_true,verdict,false_drops,false_keeps,ambiguous,residual,growth,error,reason";

/// Columns of the table for people, which [`cells`] fills; `x` is the time over that of the first method.
pub const HEAD: [&str; 11] =
    ["method", "ms", "quartiles", "x", "MiB", "rank", "drops", "keeps", "residual", "growth", "error"];

/// Widths of the columns of the table in a terminal.
const WIDTH: [usize; HEAD.len()] = [34, 11, 20, 10, 9, 15, 6, 6, 10, 10, 10];

/// The table as text, with a block of lines for each system.
pub fn text(samples: &[Sample], methods: &[BenchMethod]) -> String {
    let threads = rayon::current_num_threads();
    let mut text = format!("qless {} on {threads} threads\n", env!("CARGO_PKG_VERSION"));
    for block in samples.chunks(methods.len()) {
        let Sample { family, size, equations, rank, .. } = &block[0];
        _ = writeln!(text, "\n{family} {size}: {equations} equations of rank {rank}");
        line(&mut text, &HEAD.map(str::to_owned));
        block.iter().for_each(|sample| line(&mut text, &cells(sample, &block[0])));
    }
    let exponents = exponents(samples, methods);
    if !exponents.is_empty() {
        _ = writeln!(text, "\n{TIE}: time against equations: {exponents}");
    }
    text
}

fn line(text: &mut String, cells: &[String; HEAD.len()]) {
    let mut out = String::new();
    for ((cell, width), head) in cells.iter().zip(WIDTH).zip(HEAD) {
        _ = if matches!(head, "method" | "rank") {
            write!(out, "  {cell:<width$}")
        } else {
            write!(out, "{cell:>width$}")
        };
    }
    _ = writeln!(text, "{}", out.trim_end());
}

/// The cells of a sample in the table for people; times are relative to `first`.
pub fn cells(sample: &Sample, first: &Sample) -> [String; HEAD.len()] {
    let m = match &sample.result {
        Ok(measured) => measured,
        Err(reason) => {
            let mut cells = [const { String::new() }; HEAD.len()];
            (cells[0], cells[1]) = (sample.method.to_owned(), format!("given up: {reason}"));
            return cells;
        }
    };
    let or_none = |number: Option<String>| number.unwrap_or_else(|| "-".to_owned());
    let unsure = if m.ambiguous { ", unsure" } else { "" };
    [
        sample.method.to_owned(),
        format!("{:.2}", 1e3 * m.time),
        format!("{:.2}-{:.2}", 1e3 * m.quartiles.0, 1e3 * m.quartiles.1),
        or_none(times(m, first).map(|times| if times < 100.0 { format!("{times:.2}") } else { format!("{times:.0}") })),
        or_none(m.memory.map(|bytes| format!("{:.1}", bytes as f64 / f64::from(1 << 20)))),
        format!("{}{unsure}", verdict(sample, m)),
        m.false_drops.to_string(),
        m.false_keeps.to_string(),
        or_none(m.residual.map(|residual| format!("{residual:.1e}"))),
        or_none(m.growth.map(|growth| if growth < 1e4 { format!("{growth:.2}") } else { format!("{growth:.1e}") })),
        or_none(m.error.map(|error| format!("{error:.1e}"))),
    ]
}

/// The measured time relative to that of the first method of the table.
fn times(measured: &Measured, first: &Sample) -> Option<f64> {
    Some(measured.time / first.measured()?.time)
}

/// `method: exponent` for all methods on the paper's tie; empty without times.
pub fn exponents(samples: &[Sample], methods: &[BenchMethod]) -> String {
    let exponent = |method: &BenchMethod| {
        let series = Series::new(samples, method.name);
        (!series.points.is_empty()).then(|| format!("{}: {}", method.name, series.words()))
    };
    methods.iter().filter_map(exponent).collect::<Vec<_>>().join("; ")
}

/// One line for each sample; methods that were given up have no numbers.
pub fn csv(samples: &[Sample], methods: &[BenchMethod]) -> String {
    let mut text = format!("{COLUMNS}\n");
    for block in samples.chunks(methods.len()) {
        block.iter().for_each(|sample| csv_line(&mut text, sample, &block[0]));
    }
    text
}

fn csv_line(text: &mut String, sample: &Sample, first: &Sample) {
    let Sample { size, equations, rank, .. } = sample;
    // CSV requires quotes around a name with a comma.
    let [family, method] = [sample.family, sample.method]
        .map(|name| if name.contains(',') { format!("\"{name}\"") } else { name.to_owned() });
    let m = match &sample.result {
        Ok(measured) => measured,
        Err(reason) => {
            let reason = reason.replace('"', "'");
            _ = writeln!(text, "{family},{size},{equations},{method},,,,,,,{rank},given up,,,,,,,\"{reason}\"");
            return;
        }
    };
    let or_empty = |number: Option<String>| number.unwrap_or_default();
    let numbers = [
        format!("{:.4}", 1e3 * m.time),
        format!("{:.4}", 1e3 * m.quartiles.0),
        format!("{:.4}", 1e3 * m.quartiles.1),
        or_empty(times(m, first).map(|times| format!("{times:.3}"))),
        or_empty(m.memory.map(|bytes| bytes.to_string())),
        m.rank.to_string(),
        rank.to_string(),
        verdict(sample, m).to_owned(),
        m.false_drops.to_string(),
        m.false_keeps.to_string(),
        m.ambiguous.to_string(),
        or_empty(m.residual.map(|residual| format!("{residual:e}"))),
        or_empty(m.growth.map(|growth| growth.to_string())),
        or_empty(m.error.map(|error| format!("{error:e}"))),
        String::new(),
    ];
    _ = writeln!(text, "{family},{size},{equations},{method},{}", numbers.join(","));
}
