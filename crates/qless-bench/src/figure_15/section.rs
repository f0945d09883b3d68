//! The measurements of Figure 15 as a section of the page, and as CSV.

use std::fmt::Write;

use super::super::given_up::thousands;
use super::crossing::{pairs, papers_pairs, sentence};
use super::plot::FILE;
use super::{FigureLevel, FigureSide, GAUSS, Way, backends, families};

/// Name of the file with every measured number.
pub const CSV: &str = "figure-15.csv";

const INTRODUCTION: &str = "One factorization of every block on one thread, as in the paper: without presolve, scaling or \
checks of the rank. A column is dependent if at most 1e-5 remains of it. C is factored together with b, and `C^T` alone, as the \
defaults do to find the dependent equations. Gauss is the paper's elimination by rows and pivots in both cases, on sparse rows. \
The time to split into blocks is not included. Runs alternate in one process; times are medians. `rank +3` means that a \
factorization takes three dependent equations for independent; the analysis checks and repairs that. Meshes below 50 % are the \
same model.";

/// The section with the crossings; the CSV file has the times.
pub fn markdown(levels: &[FigureLevel]) -> String {
    let mut text = format!(
        "## Figure 15: Gauss against QR\n\n{INTRODUCTION}\n\n![Times of the bare factorizations]({FILE})\n\nWhere they cross:\n\n"
    );
    crossings(&mut text, levels);
    text
}

/// The tables of crossings and of times, without an introduction.
pub fn text(levels: &[FigureLevel]) -> String {
    let mut text = "Where they cross:\n\n".to_owned();
    crossings(&mut text, levels);
    for family in families(levels) {
        _ = writeln!(text, "\n{family}, in ms:\n");
        times(&mut text, levels, family);
    }
    text
}

fn crossings(text: &mut String, levels: &[FigureLevel]) {
    _ = writeln!(text, "| coupling | factored | against | who is faster |\n| --- | --- | --- | --- |");
    for family in families(levels) {
        for side in FigureSide::BOTH {
            for qr in backends(levels).into_iter().filter(|name| *name != GAUSS) {
                let said = sentence(&pairs(levels, family, side, qr)).unwrap_or_else(|| "-".to_owned());
                _ = writeln!(text, "| {family} | {} | {qr} | {said} |", side.name());
            }
        }
    }
    let said = sentence(&papers_pairs()).unwrap_or_default();
    _ = writeln!(text, "| the paper's, its Table 1 | C | its QR | {said} |");
}

fn times(text: &mut String, levels: &[FigureLevel], family: &str) {
    let own: Vec<&FigureLevel> = levels.iter().filter(|level| level.family == family).collect();
    let mut head = "| level | equations | blocks | largest |".to_owned();
    own[0].ways.iter().for_each(|way| _ = write!(head, " {}, {} |", way.backend, way.side.name()));
    _ = writeln!(text, "{head}\n| --- |{}", " ---: |".repeat(3 + own[0].ways.len()));
    for level in own {
        let (rows, dofs) = level.largest;
        let (equations, rows, dofs) = (thousands(level.equations), thousands(rows), thousands(dofs));
        _ = write!(text, "| {} | {equations} | {} | {rows} x {dofs} |", level.size, thousands(level.blocks));
        level.ways.iter().for_each(|way| _ = write!(text, " {} |", cell(way, level.rank)));
        _ = writeln!(text);
    }
}

/// Milliseconds, and for a wrong rank its difference from the true one.
fn cell(way: &Way, rank: usize) -> String {
    match &way.result {
        Err(reason) => format!("given up: {reason}"),
        Ok((time, found)) if *found == rank => ms(*time),
        Ok((time, found)) => format!("{}, rank {:+}", ms(*time), *found as i64 - rank as i64),
    }
}

fn ms(time: f64) -> String {
    let ms = 1e3 * time;
    if ms < 10.0 { format!("{ms:.2}") } else { format!("{ms:.1}") }
}

/// A line for each level, backend and side.
pub fn csv(levels: &[FigureLevel]) -> String {
    let mut text = "family,size,equations,rank_true,blocks,backend,matrix,ms,rank,reason\n".to_owned();
    for level in levels {
        let FigureLevel { family, size, equations, rank, blocks, .. } = level;
        for Way { backend, side, result } in &level.ways {
            let found = match result {
                Ok((time, found)) => format!("{:.4},{found},", 1e3 * time),
                Err(reason) => format!(",,\"{}\"", reason.replace('"', "'")),
            };
            _ = writeln!(text, "{family},{size},{equations},{rank},{blocks},{backend},{},{found}", side.name());
        }
    }
    text
}
