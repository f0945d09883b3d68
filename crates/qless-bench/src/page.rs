//! The measurements as a short page in Markdown: plots, advice, and where Gauss elimination and QR cross.

use std::fmt::Write;

use super::advice::advice;
use super::figure_15::{self, Level};
use super::methods::BenchMethod;
use super::plot::{GROWTH, TRADE, front, has_growth, points};
use super::sample::Sample;
use super::table::exponents;

/// Legend of the tables.
const COLUMNS: &str = "
## The columns of the table that `qless bench` prints

| column | what |
| --- | --- |
| ms, quartiles | median and quartiles of the runs; those below 0.25 s with caches that the same method has warmed |
| x | time over that of the first line |
| MiB | most memory beyond that of the system itself, in a process of its own (`--memory`); `-` where it was not measured |
| rank | against the truth, and whether the report says that it is unsure |
| drops, keeps | equations taken for dependent that are not, and for independent that are not; of other libraries, which do not name them, the difference of the ranks |
| residual | of T, G and g in the independent equations, relative |
| growth | largest entry of T |
| error | of a solved problem, `max abs(u - u*) / max abs(u*)`: springs of stiffness 1 from each DOF to the ground and to the next, f_j = 1 + j mod 7, solved with T, G, g against Lagrange multipliers refined in twice the precision; `-` where T has more than 200,000 entries, the rank that the defaults find is wrong, or conjugate gradients, which solve systems of more than 3,000 DOFs, do not end |

Other libraries, and methods whose ranks are not checked, run in processes of their own, which are stopped at the limit. The former
have no scaling, presolve or checks of the rank: one factorization C P = Q R, then T = -R1^-1 R2 and g = R1^-1 Q^T b. Eigen's own tolerance is 20 (m + n) eps times the largest column, the paper's is
absolute 1e-5; dgeqp3 has none, max(m, n) eps abs(R_11) is taken.
";

/// The page; `command` is what makes it again.
pub fn markdown(samples: &[Sample], methods: &[BenchMethod], levels: &[Level], command: &str) -> String {
    let mut text = format!(
        "# The trade of speed for accuracy\n\nMade by `{command}` (qless {}) on {}, {} threads. Times are medians of the \
         whole elimination, from the validated system to T, G, g.\n\n",
        env!("CARGO_PKG_VERSION"),
        processor(),
        rayon::current_num_threads()
    );
    plots(&mut text, samples, methods);
    if samples.is_empty() {
        return text + &figure_15::markdown(levels);
    }
    text += &advice(samples, methods);
    if !levels.is_empty() {
        text += "\n";
        text += &figure_15::markdown(levels);
    }
    text += COLUMNS;
    text + "\n[trade.csv](trade.csv) has every method on every system, and [figure-15.csv](figure-15.csv) the times of Figure 15.\n"
}

/// The plots that there are, and what is to be read off them.
fn plots(text: &mut String, samples: &[Sample], methods: &[BenchMethod]) {
    let all = points(samples, methods);
    if !all.is_empty() {
        let best: Vec<&str> = front(&all).iter().map(|point| point.method).collect();
        _ = writeln!(
            text,
            "![Error against time]({TRADE})\n\nOn its Pareto front, of the methods that did every system: {}.\n",
            best.join("; ")
        );
    }
    if has_growth(samples, methods) {
        _ = writeln!(text, "![Time against the number of equations]({GROWTH})\n");
    }
    let exponents = exponents(samples, methods);
    if !exponents.is_empty() {
        _ = writeln!(text, "Its exponents: {exponents}.\n");
    }
}

/// The processor's name, where the system tells it.
fn processor() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let line = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    line.map_or_else(|| std::env::consts::ARCH.to_owned(), |(_, name)| name.trim().to_owned())
}
