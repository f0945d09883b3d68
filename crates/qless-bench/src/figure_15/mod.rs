//! Repeats the paper's Figure 15: Gauss elimination against sparse QR, block by block, on all levels of Table 1.
//!
//! Only factorizations are measured, as in the paper: no presolve, no scaling, no check of the rank, one thread. C is factored together
//! with b (Eq. 21 and 26), and `C^T` without b, as qless does by default to find the dependent equations. All methods run in turns in one
//! process.

mod blocks;
mod crossing;
mod plot;
mod section;
#[cfg(test)]
mod tests;
mod time;

pub use blocks::blocks;
pub use plot::plots;
pub use section::{CSV, csv, markdown, text};
pub use time::{factor, measure};

/// The matrix that is factored.
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

/// The name of the elimination with which the QR backends are compared.
pub const GAUSS: &str = "Gauss";

/// The measurements of one system.
pub struct FigureLevel {
    pub family: &'static str,
    pub size: String,
    pub equations: usize,
    /// The true rank of the system.
    pub rank: usize,
    pub blocks: usize,
    /// Equations and DOFs of the block with most equations.
    pub largest: (usize, usize),
    pub ways: Vec<Way>,
}

/// The measurement of a backend on C or on its transpose, summed over the blocks.
pub struct Way {
    pub backend: &'static str,
    pub side: FigureSide,
    /// Median of the runs in seconds, and the rank found; or the reason for a failure.
    pub result: Result<(f64, usize), String>,
}

/// Numbers of equations and seconds of one backend and side, for every level that was measured.
fn series(levels: &[FigureLevel], family: &str, backend: &str, side: FigureSide) -> Vec<(f64, f64)> {
    let of = levels.iter().filter(|level| level.family == family);
    of.filter_map(|level| Some((level.equations as f64, level.time(backend, side)?))).collect()
}

impl FigureLevel {
    fn way(&self, backend: &str, side: FigureSide) -> Option<&Way> {
        self.ways.iter().find(|way| way.backend == backend && way.side == side)
    }

    fn time(&self, backend: &str, side: FigureSide) -> Option<f64> {
        Some(self.way(backend, side)?.result.as_ref().ok()?.0)
    }
}

/// Backends that were measured, in order.
fn backends(levels: &[FigureLevel]) -> Vec<&'static str> {
    let mut names: Vec<&str> = Vec::new();
    for way in levels.iter().flat_map(|level| &level.ways) {
        if !names.contains(&way.backend) {
            names.push(way.backend);
        }
    }
    names
}

/// Families that were measured, in order.
fn families(levels: &[FigureLevel]) -> Vec<&'static str> {
    let mut names: Vec<&str> = levels.iter().map(|level| level.family).collect();
    names.dedup();
    names
}
