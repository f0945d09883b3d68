//! `qless bench`: what speed costs in accuracy on this machine, for every choice that a user has.
//!
//! Every method runs on every system, in alternation and in one process; times are medians. Truth is known by construction. A method
//! that was slow on a smaller system of the same family is not tried on a larger one.

mod measure;
mod methods;
mod page;
#[cfg(feature = "peers")]
mod peers;
mod plot;
mod systems;
mod table;

use std::process::ExitCode;

use qless_io::write::Output;

use crate::args::BenchArgs;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::stdout;
use measure::measure;

/// Measures, prints the table and, where a folder is given, writes it with its plots.
pub fn run(args: &BenchArgs) -> Result<ExitCode, Failure> {
    if let Some(folder) = &args.output {
        drop(Output::new(folder)?);
    }
    let progress = Progress::new(args.quiet);
    let methods = methods::all();
    let mut samples = Vec::new();
    for family in systems::families(args.short) {
        progress.stage(family.name);
        samples.extend(measure(&family, &methods, args).map_err(Failure::Input)?);
    }
    drop(progress);
    let text = table::text(&samples, &methods);
    stdout::write(|out| out.write_all(text.as_bytes()))?;
    if let Some(folder) = &args.output {
        let plots = plot::all(&samples, &methods).map_err(Failure::Resource)?;
        let mut output = Output::new(folder)?;
        output.file("trade.csv", |out| out.write_all(table::csv(&samples).as_bytes()))?;
        let page = page::markdown(&samples, &methods, &command(args));
        output.file("trade.md", |out| out.write_all(page.as_bytes()))?;
        for (name, svg) in plots {
            output.file(name, |out| out.write_all(svg.as_bytes()))?;
        }
        output.commit()?;
    }
    Ok(ExitCode::SUCCESS)
}

/// The command that measures the same again.
fn command(args: &BenchArgs) -> String {
    let short = if args.short { " --short" } else { "" };
    format!("qless bench{short} --runs {} --limit {} -o docs", args.runs, args.limit)
}

#[cfg(test)]
mod tests {
    use super::measure::{Measured, Sample};
    use super::{methods, page, plot, table};

    /// One system, on which every method but the last took as many milliseconds as its number.
    fn samples(methods: &[methods::Method]) -> Vec<Sample> {
        let result = |k: usize| {
            let time = 1e-3 * (k + 1) as f64;
            let rank = if k == 1 { 6 } else { 7 };
            (k + 1 < methods.len()).then_some(Measured {
                time,
                quartiles: (time, time),
                rank,
                ambiguous: false,
                residual: 1e-16,
                growth: 1.0,
            })
        };
        let sample = |(k, method): (usize, &methods::Method)| Sample {
            family: super::systems::TIE,
            size: "50 %".into(),
            equations: 9,
            method: method.name,
            rank: 7,
            result: result(k),
        };
        methods.iter().enumerate().map(sample).collect()
    }

    #[test]
    fn table_page_and_plots_show_the_same_data() {
        let methods = methods::all();
        let samples = samples(&methods);
        let csv = table::csv(&samples);
        let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
        assert_eq!(lines[0], table::COLUMNS);
        assert!(lines.iter().all(|line| line.len() == table::COLUMNS.len()));
        assert_eq!(lines.len(), methods.len() + 1);
        let page = page::markdown(&samples, &methods, "qless bench");
        let plots = plot::all(&samples, &methods).expect("drawn");
        for (k, method) in methods.iter().enumerate() {
            assert_eq!((lines[k + 1][3], lines[k + 1][8]), (method.name, "7"));
            assert!(page.contains(&format!("| {} | ", method.name)));
            let is_measured = k + 1 < methods.len();
            assert_eq!(
                lines[k + 1][9],
                if !is_measured {
                    "given up"
                } else if k == 1 {
                    "drops"
                } else {
                    "right"
                }
            );
            let name = format!("\n{}\n", method.name.replace('\'', "&apos;"));
            assert_eq!(plots[0].1.contains(&name), is_measured, "{name} in trade.svg");
            assert_eq!(plots[1].1.contains(&name), method.is_drawn, "{name} in growth.svg");
        }
        let points = plot::points(&samples, &methods);
        assert_eq!((points[1].time, points[1].error), (2.0, 1.0), "a wrong rank is an error of 1");
        assert!((points[2].time - 3.0).abs() < 1e-12);
    }
}
