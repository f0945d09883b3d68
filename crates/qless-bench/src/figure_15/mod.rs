//! The paper's Figure 15 with today's means: Gauss elimination against sparse QR, block by block, on all levels of Table 1.
//!
//! Factorizations alone, as in the paper: no presolve, no scaling, no check of the rank, one thread. C is factored with b beside it
//! (Eq. 21 and 26), and `C^T` without, which is how the default finds the dependent equations. Every way takes its turn in one
//! process.

mod blocks;
mod crossing;
mod plot;
mod section;
#[cfg(test)]
mod tests;
mod time;

pub use plot::plots;
pub use section::{CSV, csv, markdown, text};
pub use time::measure;

/// Which matrix is factored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FigureSide {
    C,
    Transposed,
}

impl FigureSide {
    pub const BOTH: [Self; 2] = [Self::C, Self::Transposed];

    pub fn name(self) -> &'static str {
        match self {
            Self::C => "C",
            Self::Transposed => "C^T",
        }
    }
}

/// The elimination that the others are compared with.
pub const GAUSS: &str = "Gauss";

/// One system, and every way through it.
pub struct Level {
    pub family: &'static str,
    pub size: String,
    pub equations: usize,
    /// Known by construction.
    pub rank: usize,
    pub blocks: usize,
    /// Equations and DOFs of the block with most equations.
    pub largest: (usize, usize),
    pub ways: Vec<Way>,
}

/// A backend on C or on its transpose, summed over the blocks.
pub struct Way {
    pub backend: &'static str,
    pub side: FigureSide,
    /// Median of the runs in seconds and the rank found; the error says why there are none.
    pub result: Result<(f64, usize), String>,
}

/// Numbers of equations and seconds of one way, for every level that it did.
fn series(levels: &[Level], family: &str, backend: &str, side: FigureSide) -> Vec<(f64, f64)> {
    let of = levels.iter().filter(|level| level.family == family);
    of.filter_map(|level| Some((level.equations as f64, level.time(backend, side)?))).collect()
}

impl Level {
    fn way(&self, backend: &str, side: FigureSide) -> Option<&Way> {
        self.ways.iter().find(|way| way.backend == backend && way.side == side)
    }

    fn time(&self, backend: &str, side: FigureSide) -> Option<f64> {
        Some(self.way(backend, side)?.result.as_ref().ok()?.0)
    }
}

/// Backends that were measured, in order.
fn backends(levels: &[Level]) -> Vec<&'static str> {
    let mut names: Vec<&str> = Vec::new();
    for way in levels.iter().flat_map(|level| &level.ways) {
        if !names.contains(&way.backend) {
            names.push(way.backend);
        }
    }
    names
}

/// Families that were measured, in order.
fn families(levels: &[Level]) -> Vec<&'static str> {
    let mut names: Vec<&str> = levels.iter().map(|level| level.family).collect();
    names.dedup();
    names
}
