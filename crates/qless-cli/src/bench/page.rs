//! The measurements as a page in Markdown: advice, plots, and the table of every system.

use std::fmt::Write;

use super::measure::Sample;
use super::methods::Method;
use super::plot::{front, points, series};
use super::table::verdict;

/// What to choose, whatever the machine; the numbers are in the tables below it.
const ADVICE: &str = "\
## Which option for which need

| need | option | what it costs | what it risks |
| --- | --- | --- | --- |
| the usual | none: the defaults | nothing | nothing known: doubtful ranks are reported as ambiguous |
| coefficients typed with few digits | `--tolerance 1e-6` or `1e-4` | nothing | real constraints that nearly repeat others are dropped (rows \"near\" below); the report says that it is unsure |
| coefficients exact to the last digit | `--tolerance 1e-12` | nothing | rounding in the input counts as independence |
| T with the smallest entries | `--growth 1` | exchanges of slaves and masters, a few percent on most models | nothing |
| a second opinion | `--no-presolve`, with `--backend sparse` or `spqr` | factor 10 to 1,000, see \"alone\" below | nothing; ranks are checked the same way |
| the paper's results | `--paper-tolerance` | nothing | its answer changes with the units |
| dense elimination without fill-in control | `--backend gauss` | grows with the cube of what presolve leaves | none for the rank; minutes on large blocks |

`alone` means without presolve: the whole system goes to that backend. The other rows change one option of the default.
";

/// The page; `command` is what makes it again.
pub fn markdown(samples: &[Sample], methods: &[Method], command: &str) -> String {
    let mut text = format!(
        "# The trade of speed for accuracy\n\nMade by `{command}` (qless {}) on {}, {} threads. Times are medians of the \
         whole elimination, from the validated system to T, G, g.\n\n![Error against time](trade.svg)\n\n![Time against the \
         number of equations](growth.svg)\n\n",
        env!("CARGO_PKG_VERSION"),
        processor(),
        rayon::current_num_threads()
    );
    let all = points(samples, methods);
    let best: Vec<&str> = front(&all).iter().map(|point| point.method).collect();
    _ = writeln!(text, "On the Pareto front of the first plot: {}.\n", best.join(", "));
    text += "Exponents of the second: ";
    let exponent = |method: &Method| Some(format!("{} {:.2}", method.name, series(samples, method.name).1?));
    let exponents: Vec<String> = methods.iter().filter(|method| method.is_drawn).filter_map(exponent).collect();
    text += &exponents.join(", ");
    text += ".\n\n";
    text += ADVICE;
    text += "\n## Every system\n";
    for block in samples.chunks(methods.len()) {
        system(&mut text, block);
    }
    text
}

fn system(text: &mut String, block: &[Sample]) {
    let Sample { family, size, equations, rank, .. } = &block[0];
    _ = writeln!(text, "\n### {family} {size}: {equations} equations of rank {rank}\n");
    *text += "| method | ms | quartiles | rank | residual | growth |\n| --- | ---: | ---: | --- | ---: | ---: |\n";
    for sample in block {
        let Some(m) = &sample.result else {
            _ = writeln!(text, "| {} | given up | | | | |", sample.method);
            continue;
        };
        let off = m.rank.abs_diff(sample.rank);
        let wrong = if off > 0 { format!(" {off}") } else { String::new() };
        let unsure = if m.ambiguous { ", unsure" } else { "" };
        _ = writeln!(
            text,
            "| {} | {:.2} | {:.2}-{:.2} | {}{wrong}{unsure} | {:.1e} | {:.2} |",
            sample.method,
            1e3 * m.time,
            1e3 * m.quartiles.0,
            1e3 * m.quartiles.1,
            verdict(sample, m),
            m.residual,
            m.growth
        );
    }
}

/// The processor's name, where the system tells it.
fn processor() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let line = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    line.map_or_else(|| std::env::consts::ARCH.to_owned(), |(_, name)| name.trim().to_owned())
}
