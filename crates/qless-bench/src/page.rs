//! The measurements as a page in Markdown: pictures, the share of wrong verdicts, advice, and crossings of Gauss elimination and QR.

use std::fmt::Write;

use super::advice::advice;
use super::figure_15::{self, FigureLevel};
use super::methods::BenchMethod;
use super::panels;
use super::plot::{GROWTH, has_growth};
use super::sample::Sample;
use super::share::{WrongShare, table};
use super::table::exponents;

/// Legend of the tables.
const COLUMNS: &str = "
## The columns of the table that `qless bench` prints

| column | content |
| --- | --- |
| ms, quartiles | median and quartiles of the runs, of the verdict alone; other libraries with T, G and g; for runs below 0.25 s the same method has warmed the caches |
| x | time relative to that of the first line |
| MiB | peak memory beyond that of the system itself, in a process of its own (`--memory`); `-` if it was not measured |
| rank | whether the rank is right, and whether the report states that it is ambiguous (`unsure`) |
| drops, keeps | independent equations that were taken for dependent, and dependent ones that were taken for independent; for other libraries, which do not name them, the difference of the ranks |
| residual | relative residual of T, G and g in the independent equations |
| growth | largest entry of T |
| error | of a solved problem, `max abs(u - u*) / max abs(u*)`: springs of stiffness 1 from each DOF to the ground and to the next, f_j = 1 + j mod 7, solved with T, G, g against Lagrange multipliers refined in twice the precision; `-` if T has more than 200,000 entries, if the defaults find a wrong rank, or if conjugate gradients (for more than 3,000 DOFs) do not converge |

Other libraries, and methods whose ranks are not checked, run in processes of their own, which are stopped at the limit. Other
libraries have no scaling, presolve or checks of the rank: one factorization C P = Q R, then T = -R1^-1 R2 and g = R1^-1 Q^T b. Eigen's own tolerance is 20 (m + n) eps times the largest column; dgeqp3 has none, so max(m, n) eps abs(R_11) is used. MUMPS factors [I C^T; C 0] and detects null pivots (ICNTL(24) = 1, its own tolerance); the rank is the number of equations less that of null pivots. HiGHS runs presolve and simplex on C u = C x for a random x, u free; the rank is the number of equations less that of rows in the basis. Neither computes T.
";

/// The page; `command` is the command that repeats the measurements.
pub fn markdown(
    (samples, shares): (&[Sample], &[WrongShare]),
    methods: &[BenchMethod],
    levels: &[FigureLevel],
    command: &str,
) -> String {
    let mut text = format!(
        "# The trade of time for certainty\n\nMade by `{command}` (qless {}) on {}, {} threads. Times are those of the verdict, \
         as multiples of the bare QR: one sparse QR of C or of its transpose, whichever is faster, without presolve, scaling or \
         checks. Methods run in turns; times are medians.\n\n",
        env!("CARGO_PKG_VERSION"),
        processor(),
        rayon::current_num_threads()
    );
    plots(&mut text, samples, methods);
    if samples.is_empty() {
        return text + &figure_15::markdown(levels);
    }
    text += &advice(samples, methods);
    if !shares.is_empty() {
        text += "\n## Wrong without a warning\n\nSystems of a few dozen equations and known rank, each with its seed: combinations, rings, equations typed with \
                 few digits, rigid links, triples near dependence, rows in other units.\n\n";
        text += &table(shares);
    }
    if !levels.is_empty() {
        text += "\n";
        text += &figure_15::markdown(levels);
    }
    text += COLUMNS;
    text + "\n[trade.csv](trade.csv) has every method on every system, and [figure-15.csv](figure-15.csv) the times of Figure 15.\n"
}

/// The available plots with their main numbers.
fn plots(text: &mut String, samples: &[Sample], methods: &[BenchMethod]) {
    if panels::svg(samples, methods).is_some() {
        _ = writeln!(
            text,
            "![Certainty against time]({})\n\nA panel for each family, on its largest system: a line for each method, the median as a dot and the \
             quartiles as a bar. A dot is empty if a rank is wrong without a warning. The line joins the four efforts.\n",
            panels::FILE
        );
    }
    if has_growth(samples, methods) {
        _ = writeln!(text, "![Time against the number of equations]({GROWTH})\n");
    }
    let exponents = exponents(samples, methods);
    if !exponents.is_empty() {
        _ = writeln!(text, "Time against equations: {exponents}.\n");
    }
}

/// The name of the processor, or else the architecture.
fn processor() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let line = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    line.map_or_else(|| std::env::consts::ARCH.to_owned(), |(_, name)| name.trim().to_owned())
}
