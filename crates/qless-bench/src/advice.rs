//! A table of options for given needs, with the measurements of each option.

use std::fmt::Write;

use super::methods::BenchMethod;
use super::sample::{Measured, Sample};

/// A need, the option for it, the methods with this option, and its risk.
struct Advice {
    need: &'static str,
    option: &'static str,
    methods: &'static [&'static str],
    risk: &'static str,
}

const ADVICE: [Advice; 9] = [
    Advice {
        need: "the usual",
        option: "none: the defaults",
        methods: &["default"],
        risk: "doubtful ranks are reported as such",
    },
    Advice {
        need: "coefficients typed with few digits",
        option: "`--tolerance 1e-6` or `1e-4`",
        methods: &["tolerance 1e-6", "tolerance 1e-4"],
        risk: "real constraints that nearly repeat others are dropped",
    },
    Advice {
        need: "coefficients exact to the last digit",
        option: "`--tolerance 1e-12`",
        methods: &["tolerance 1e-12"],
        risk: "rounding in the input counts as independence",
    },
    Advice {
        need: "T with smaller entries",
        option: "`--growth 2`, down to 1",
        methods: &["growth 2"],
        risk: "none of its own; the nearer to 1, the more exchanges and the fuller T",
    },
    Advice {
        need: "a second opinion",
        option: "`--no-presolve`, with `--backend sparse` or `spqr`",
        methods: &["sparse alone", "spqr alone"],
        risk: "none of its own: ranks are checked in the same way",
    },
    Advice {
        need: "to see what the checks of the rank are worth",
        option: "`--no-check`",
        methods: &["rank unchecked", "sparse alone, rank unchecked"],
        risk: "a wrong or doubtful rank passes without a word",
    },
    Advice {
        need: "the paper's results",
        option: "`--paper-tolerance`",
        methods: &["paper's tolerance"],
        risk: "its answer changes with the units",
    },
    Advice {
        need: "the paper's elimination on what presolve leaves",
        option: "`--backend gauss`",
        methods: &["gauss"],
        risk: "nothing bounds the fill of what presolve leaves but the memory it may have",
    },
    Advice {
        need: "the paper's elimination of the whole",
        option: "`--backend gauss --no-presolve`",
        methods: &["gauss alone"],
        risk: "nothing bounds the fill but the memory it may have",
    },
];

/// The page's section.
pub fn advice(samples: &[Sample], methods: &[BenchMethod]) -> String {
    let mut text =
        "## Which option for which need\n\n| need | option | time over the default's: median, least to most | ranks: \
                    wrong and not doubted, wrong, of | what it risks |\n| --- | --- | --- | --- | --- |\n"
            .to_owned();
    for Advice { need, option, methods: measured, risk } in ADVICE {
        let of = |cell: fn(&[(f64, &Sample, Measured)]) -> String| {
            let names = measured.iter().filter(|name| methods.iter().any(|method| method.name == **name));
            let cells: Vec<String> = names.map(|name| cell(&compared(samples, methods.len(), name))).collect();
            cells.join("; ")
        };
        _ = writeln!(text, "| {need} | {option} | {} | {} | {risk} |", of(times), of(ranks));
    }
    text + "\nIf a need has several methods, each has its numbers, in this order. `alone` means without presolve: the \
            whole system goes to that backend. The other methods change one option of the default.\n"
}

/// The results of a method on the systems that it and the first method finished, with the ratio of their times.
fn compared<'a>(samples: &'a [Sample], methods: usize, name: &str) -> Vec<(f64, &'a Sample, Measured)> {
    let pairs = samples.chunks(methods).filter_map(|block| {
        let sample = block.iter().find(|sample| sample.method == name)?;
        let (first, own) = (block[0].measured()?, sample.measured()?);
        Some((own.time / first.time, sample, own))
    });
    pairs.collect()
}

fn times(compared: &[(f64, &Sample, Measured)]) -> String {
    let mut ratios: Vec<f64> = compared.iter().map(|&(ratio, ..)| ratio).collect();
    ratios.sort_by(f64::total_cmp);
    match ratios.as_slice() {
        [] => "-".to_owned(),
        [least, .., most] => format!("{:.2}, {least:.2} to {most:.2}", ratios[ratios.len() / 2]),
        [only] => format!("{only:.2}"),
    }
}

fn ranks(compared: &[(f64, &Sample, Measured)]) -> String {
    let wrong = || compared.iter().filter(|(_, sample, own)| own.rank != sample.rank);
    let silent = wrong().filter(|(.., own)| !own.ambiguous).count();
    format!("{silent}, {}, {}", wrong().count(), compared.len())
}
