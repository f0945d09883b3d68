//! Who did the work, and how long it took.

use qless::Report;

use super::name::count;

/// `Presolve settled 12 of 16 equations; faer factored 4, in 1 block.`
pub fn presolve(report: &Report) -> String {
    let (rows, name) = (report.input.rows, report.backend.name);
    let Some(presolve) = report.presolve else { return of_ranks(report) };
    let blocks = match presolve.blocks {
        1 => "1 block".to_owned(),
        n => format!("{n} blocks of at most {}", presolve.largest_block),
    };
    match presolve.core_rows {
        0 => format!("Presolve settled all equations; nothing was left for {name} to factor."),
        core if core == rows => format!("{name} factored all equations, in {blocks}."),
        core => {
            format!("Presolve settled {} of {rows} equations; {name} factored {core}, in {blocks}.", rows - core)
        }
    }
}

/// Across ranks nobody counts what presolve settles.
fn of_ranks(report: &Report) -> String {
    let ranks = count(report.ranks.unwrap_or(1), "rank");
    format!("Analysed by {ranks}, each with presolve and {}.", report.backend.name)
}

/// `Backend: SuiteSparseQR 2.1.0, SuiteSparse 5.12.0, task tree on oneTBB 2021.8.`, where the name does not say it all.
pub fn backend(report: &Report) -> Option<String> {
    let has_core = report.presolve.is_some_and(|presolve| presolve.core_rows > 0);
    let says_more = has_core && report.backend.version.contains(',');
    says_more.then(|| format!("Backend: {}.", report.backend.version))
}

/// `Time: 0.53 s (reading 0.21, analysis 0.30).`
pub fn time(report: &Report) -> String {
    let ms = report.timings_ms;
    let of_stages = ms.presolve + ms.factor + ms.classify;
    let analysis = if report.ranks.is_some() { ms.total - ms.read } else { of_stages };
    let reduction =
        report.reduction.as_ref().map_or_else(String::new, |_| format!(", reduction {:.2}", ms.reduce / 1e3));
    let (total, read, analysis) = (ms.total / 1e3, ms.read / 1e3, analysis / 1e3);
    let threads = count(report.backend.threads, "thread");
    let who = report.ranks.map_or_else(|| threads.clone(), |ranks| format!("{} of {threads}", count(ranks, "rank")));
    format!("Time: {total:.2} s (reading {read:.2}, analysis {analysis:.2}{reduction}) on {who}.")
}
