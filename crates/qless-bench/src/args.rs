//! The command line of `qless bench`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;

/// Options of `qless bench`.
#[derive(Args, Debug)]
#[expect(clippy::struct_excessive_bools, reason = "each is an option that stands alone")]
pub struct BenchArgs {
    /// Folder for the page trade.md with its plots trade.svg, growth.svg and figure-15.svg, and for trade.csv and figure-15.csv
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Only the smallest systems; takes seconds
    #[arg(long)]
    pub short: bool,
    /// Runs of each method on each system
    #[arg(long, value_name = "N", default_value = "7", value_parser = runs)]
    pub runs: NonZeroUsize,
    /// Only the paper's Figure 15: bare factorizations by Gauss elimination and by QR; without this option it follows tie and mortar
    #[arg(long, conflicts_with_all = ["method", "memory"])]
    pub figure_15: bool,
    /// Seconds after which a method is stopped; if a smaller system predicts more, the method runs in a process of its own
    #[arg(long, value_name = "SECONDS", default_value = "10", value_parser = seconds)]
    pub limit: f64,
    /// The same for other libraries, which do not run if a smaller system predicts more [default: that of --limit]
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub peer_limit: Option<f64>,
    /// Only these families, such as tie; may be repeated
    #[arg(long, value_name = "NAME")]
    pub family: Vec<String>,
    /// Only these methods; times are relative to those of the first one; may be repeated
    #[arg(long, value_name = "NAME")]
    pub method: Vec<String>,
    /// Measures memory too: every method once more in a process of its own (Linux)
    #[arg(long)]
    pub memory: bool,
    /// Measures one method on the system of this size; `qless bench` runs itself with this option in child processes
    #[arg(long, hide = true, value_name = "SIZE")]
    pub child: Option<String>,
    /// With --child: measures time and quality too, not only memory
    #[arg(long, hide = true, requires = "child")]
    pub apart: bool,
    /// No progress display
    #[arg(long, short)]
    pub quiet: bool,
}

fn seconds(text: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| "not a number; write it as 0.5 or 10".to_owned())?;
    if number > 0.0 && number.is_finite() { Ok(number) } else { Err("it must be more than 0".to_owned()) }
}

fn runs(text: &str) -> Result<NonZeroUsize, String> {
    text.parse().map_err(|_| "expected a whole number of at least 1".to_owned())
}
