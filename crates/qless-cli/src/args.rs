//! The command line.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use qless::exact::Reading;
use qless::{BackendChoice, Effort, Form, Noise, Options, Tolerance};
use qless_bench::BenchArgs;
use qless_io::case_files;
use qless_io::deck::Solver;
use qless_io::write::Inputs;

use crate::deck_input::LoadCaseChoice;
use crate::failure::say;
use crate::preferences::{PreferenceLists, WordList, words};
use crate::scenes::SceneArgs;
use crate::values::{NamedValue, number, one_of, threads};
use crate::{exit_code, memory};

/// The command line as typed, for the manifest of the output.
pub fn command() -> String {
    let words = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned());
    std::iter::once("qless".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

/// Finds redundant and conflicting constraint equations `C u = b` in finite-element models, says why, and reduces them.
#[derive(Parser)]
#[command(name = "qless", version = VERSION, propagate_version = false, after_help = exit_code::HELP)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

/// The answer to `--version`: the release, the compiled backends, and the licence.
#[cfg(feature = "spqr")]
const VERSION: &str = concat!(
    env!("CARGO_PKG_VERSION"),
    "\nbackends: faer (default), sparse, gauss, spqr\n",
    "licence:  GPL-2.0-or-later, because SuiteSparseQR is compiled in; qless itself is MIT OR Apache-2.0",
);

#[cfg(not(feature = "spqr"))]
const VERSION: &str = concat!(
    env!("CARGO_PKG_VERSION"),
    "\nbackends: faer (default), sparse, gauss; spqr is not compiled in (rebuild with `--features spqr`)\n",
    "licence:  MIT OR Apache-2.0",
);

#[derive(Subcommand)]
pub enum Command {
    /// Says which equations are redundant or conflicting, and why
    Check(CheckArgs),
    /// Writes the reduced form u_s = T u_q + G u_p + g
    Reduce(ReduceArgs),
    /// Writes a deck with an equivalent, independent set of constraints
    Clean(CleanArgs),
    /// Says why an equation is redundant or a DOF fixed or a slave, and what would free it
    Explain(ExplainArgs),
    /// Says whether two sets of equations mean the same, and which equations tell them apart; exit code 1 if they do not
    Diff(DiffArgs),
    /// Writes a test model of known rank
    Generate(SceneArgs),
    /// Measures what certainty costs in time on this machine
    Bench(BenchArgs),
}

impl Command {
    /// The limit on memory in bytes, if there is one.
    pub fn memory(&self) -> Option<usize> {
        let model = match self {
            Self::Check(args) => &args.model,
            Self::Reduce(args) => &args.model,
            Self::Clean(args) => &args.model,
            Self::Explain(args) => &args.model,
            Self::Diff(args) => &args.model,
            Self::Generate(_) | Self::Bench(_) => return None,
        };
        model.memory.map(NonZeroUsize::get)
    }
}

#[derive(Args)]
pub struct CheckArgs {
    #[command(flatten)]
    pub model: ModelArgs,
    #[command(flatten)]
    pub keep: KeepArgs,
    #[command(flatten)]
    pub report: ReportArgs,
    /// More inputs, checked with the same options; the exit code is that of the worst, and json is a list
    pub more: Vec<PathBuf>,
    /// Load case of a deck: its name (`step 2`), the number in the name, or `all`, which reports the worst one [default: all]
    #[arg(long, value_name = "CASE")]
    pub case: Option<String>,
    /// File for the report, written completely or not at all [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

const FACTORS: &str = "\
Files of a part in factor form, for k = 1, 2, ...; none of them is scaled:
  block<k>_slaves.txt      columns of C that are slaves, the columns of C_S
  block<k>_masters.txt     columns of C that are masters, the columns of C_M
  block<k>_prescribed.txt  columns of C that are prescribed, the columns of C_p
  block<k>_equations.txt   rows of C, in the order of the elimination: the rows of C_S, C_M, C_p and b
  block<k>_L.mtx           lower triangular, with ones on its diagonal
  block<k>_U.mtx           upper triangular
  block<k>_C_M.mtx, block<k>_C_p.mtx, block<k>_b.txt

  C_S = U^T L^T,  u_s = C_S^-1 (b - C_M u_q - C_p u_p): U^T forward, then L^T backward
  T = -C_S^-1 C_M,  T^T f = -C_M^T C_S^-T f: L forward, then U backward

The rows of these slaves are empty in T.mtx and G.mtx, and C_S^-1 b in g.txt. The largest entry of T is the largest that
a search found. Files block<k>_* of an earlier run are removed.";

#[derive(Args)]
#[command(after_long_help = FACTORS)]
pub struct ReduceArgs {
    #[command(flatten)]
    pub model: ModelArgs,
    #[command(flatten)]
    pub keep: KeepArgs,
    #[command(flatten)]
    pub report: ReportArgs,
    /// Folder for T.mtx, G.mtx, g.txt, slaves.txt, masters.txt, prescribed.txt (columns of G) and, if the DOFs have names,
    /// cols.txt; indices count from 1
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Load case of a deck: its name (`step 2`) or the number in the name; required if load cases constrain differently
    #[arg(long, value_name = "CASE")]
    pub case: Option<String>,
    /// Form of T
    #[arg(long, value_parser = one_of(&FORMS), value_name = "FORM", default_value = "explicit")]
    pub form: Form,
    /// Exchange slaves and masters until no entry of T exceeds this; at least 1
    #[arg(long, value_name = "X", default_value_t = Options::default().growth, value_parser = growth)]
    pub growth: f64,
    /// DOFs preferred as slaves, such as 3,7,10-20 (columns, from 1). For a deck also 5:3 (node:component), line 41, and names of
    /// node sets; for a folder also labels of cols.txt, in quotes if they contain commas
    #[arg(long, value_name = "LIST", value_parser = words)]
    pub prefer_slaves: Option<WordList>,
    /// DOFs that should not be slaves (loaded, interface), if the equations allow it; written as for --prefer-slaves
    #[arg(long, value_name = "LIST", value_parser = words)]
    pub avoid_slaves: Option<WordList>,
}

#[derive(Args)]
pub struct CleanArgs {
    #[command(flatten)]
    pub model: ModelArgs,
    #[command(flatten)]
    pub keep: KeepArgs,
    #[command(flatten)]
    pub report: ReportArgs,
    /// Deck to write, in the format of the input; it may be the input itself
    #[arg(short, long, value_name = "DECK")]
    pub output: PathBuf,
}

#[derive(Args)]
pub struct ExplainArgs {
    #[command(flatten)]
    pub model: ModelArgs,
    #[command(flatten)]
    pub keep: KeepArgs,
    /// Format of the answer
    #[arg(long, value_enum, default_value = "text")]
    pub format: AnswerFormat,
    /// What to explain: `row 17`, `column 3`, a label; in a deck also `5:3` (node:component), `line 41`, or a card such as
    /// `RBE2 13`
    #[arg(value_name = "WHAT")]
    pub what: String,
    /// Load case of a deck: its name (`step 2`) or the number in the name [default: the worst one]
    #[arg(long, value_name = "CASE")]
    pub case: Option<String>,
}

#[derive(Args)]
pub struct DiffArgs {
    #[command(flatten)]
    pub model: ModelArgs,
    /// Format of the answer
    #[arg(long, value_enum, default_value = "text")]
    pub format: AnswerFormat,
    /// The set to compare with: a deck, a matrix or a folder
    #[arg(value_name = "OTHER")]
    pub other: PathBuf,
    /// Load case of decks: its name (`step 2`) or the number in the name; required if load cases constrain differently
    #[arg(long, value_name = "CASE")]
    pub case: Option<String>,
}

/// The model, and options of its analysis.
#[derive(Args, Clone)]
pub struct ModelArgs {
    /// Deck (CalculiX, Abaqus, Nastran, ANSYS, LS-DYNA or Radioss; its first cards decide), matrix C (.mtx), relations with names (.rel),
    /// or folder with C.mtx and, if needed, b.txt, prescribed.txt, rows.txt, cols.txt. Text may be packed by gzip or be UTF-16; `-` is
    /// standard input
    pub input: PathBuf,
    /// Right-hand side b, one number per line [default: b.txt of a folder, else zeros]
    #[arg(long, value_name = "FILE")]
    pub rhs: Option<PathBuf>,
    /// Prescribed DOFs, `column value` per line, columns from 1 [default: prescribed.txt of a folder, else none]
    #[arg(long, value_name = "FILE")]
    pub prescribed: Option<PathBuf>,
    /// Certainty of the verdict, and thereby its cost
    #[arg(long, value_parser = one_of(&EFFORTS), value_name = "EFFORT", default_value = "checked")]
    pub effort: Effort,
    /// What a number means to the efforts proved and exact
    #[arg(long, value_parser = one_of(&READINGS), value_name = "READING", default_value = "typed")]
    pub numbers: Reading,
    /// Factorization of the equations that remain after presolve
    #[arg(long, value_parser = one_of(&BACKENDS), value_name = "NAME", default_value = "faer", help_heading = FOR_COMPARISON)]
    pub backend: BackendChoice,
    /// Size below which a number counts as zero, relative to the largest coefficient of its equation; between 0 and 1 [default: 1e-10]
    #[arg(long, value_name = "X", value_parser = tolerance)]
    pub tolerance: Option<f64>,
    /// Numbers that may be rounding of others: `auto` reports if they decide, `none` takes all as exact, a size such as 1e-12 takes those
    /// below it as zero, relative to their equation
    #[arg(long, value_name = "NOISE", default_value = "auto", value_parser = noise)]
    pub noise: Noise,
    /// Use the paper's tolerance: absolute 1e-5 without scaling (the answer then depends on the units)
    #[arg(long, conflicts_with = "tolerance", help_heading = FOR_COMPARISON)]
    pub paper_tolerance: bool,
    /// Largest number of threads; never more than the machine runs at a time
    #[arg(long, value_name = "N", value_parser = threads)]
    pub threads: Option<NonZeroUsize>,
    /// Memory limit of the whole run, such as 512MiB or 2GiB; MiB without a unit [default: the machine's memory, but 16GiB for one
    /// factorization and for exact arithmetic]
    #[arg(long, value_name = "SIZE", value_parser = memory::parse)]
    pub memory: Option<NonZeroUsize>,
    /// Skip presolve: the backend factors all equations
    #[arg(long, help_heading = FOR_COMPARISON)]
    pub no_presolve: bool,
    /// Solver that will read the deck: ccx, abaqus, nastran, mystran, optistruct, ansys, lsdyna or radioss [default: ccx, nastran, ansys,
    /// lsdyna or radioss, by the format of the deck]
    #[arg(long, value_name = "NAME")]
    pub solver: Option<Solver>,
    /// No progress display
    #[arg(long, short)]
    pub quiet: bool,
}

/// Equations to keep.
#[derive(Args)]
pub struct KeepArgs {
    /// Equations to keep if others can be called dependent instead, such as 3,7,10-20 (rows, from 1). For a deck also line 41, 5:3
    /// (equations that begin with this DOF), and names of node sets; for a folder also labels of rows.txt
    #[arg(long, value_name = "LIST", value_parser = words)]
    pub keep: Option<WordList>,
}

/// The report, and what its findings do to the exit code.
#[derive(Args, Default)]
pub struct ReportArgs {
    /// Take the exit code from the equations that were read, even if other constraints were left out; reduce then writes its files
    #[arg(long)]
    pub allow_incomplete: bool,
    /// Format of the report
    #[arg(long, value_enum, default_value = "text")]
    pub format: ReportFormat,
    /// Also exit with 1 if one of these is found, such as redundant,ambiguous; reduce and clean then write nothing
    #[arg(long, value_enum, value_name = "LIST", value_delimiter = ',')]
    pub deny: Vec<Deny>,
}

/// Format of an answer of `explain` and `diff`.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum AnswerFormat {
    /// For people
    Text,
    /// Everything, as JSON
    Json,
}

#[derive(Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub enum ReportFormat {
    /// For people, at most 24 lines
    #[default]
    Text,
    /// Everything, as one JSON object
    Json,
    /// For a browser: one page with tables and pictures that needs no network
    Html,
    /// Nodes of a deck for ParaView: slaves, masters, redundant, conflicting; with -o FILE.vtu
    Vtu,
    /// Findings with lines, as code hosts and editors show them (SARIF 2.1.0)
    Sarif,
    /// Findings as tests, as build servers show them (JUnit XML)
    Junit,
}

const FORMS: [NamedValue<Form>; 3] = [
    ("explicit", "All of it as numbers", Form::Explicit),
    (
        "factored",
        "As sparse factors, for each connected part of the equations that needs elimination and has no preferred slaves",
        Form::Factored,
    ),
    (
        "auto",
        "As factors where it would have more than 4096 numbers and more than 4 times those of the equations and of the factors",
        Form::Auto,
    ),
];

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
pub enum Deny {
    /// Equations that are combinations of others
    Redundant,
    /// Claims that make the solver stop
    Refused,
    /// Claims that the solver drops, at most with a warning
    Dropped,
    /// Dropped claims that do not follow from what the solver keeps, so that it solves another problem
    Lost,
    /// A rank that may be wrong
    Ambiguous,
    /// Constraints that were left out; instead of exit code 4
    Incomplete,
}

/// Heading of the options that measurements and the paper's results need.
const FOR_COMPARISON: &str = "For comparison with other methods";

const EFFORTS: [NamedValue<Effort>; 4] = [
    ("quick", "Rank by tolerance, not checked: it may be wrong", Effort::Quick),
    ("checked", "The verdict in digits, by estimates; doubt is reported", Effort::Checked),
    ("proved", "Bounds instead of estimates; a verdict without a proof is ambiguous", Effort::Proved),
    (
        "exact",
        "Also the rank in exact arithmetic, where no tolerance decides: a difference is ambiguous",
        Effort::Exact,
    ),
];

const READINGS: [NamedValue<Reading>; 2] = [
    ("typed", "The shortest decimal of each number: 0.1 is 1/10", Reading::Typed),
    ("stored", "The double itself, a whole number times a power of two", Reading::Stored),
];

const BACKENDS: [NamedValue<BackendChoice>; 4] = [
    (
        "faer",
        "Pure Rust, on the kernels of faer: QR with column pivoting, multifrontal sparse QR for large blocks",
        BackendChoice::Faer,
    ),
    ("sparse", "Pure Rust: multifrontal sparse QR for every block", BackendChoice::Sparse),
    ("spqr", "SuiteSparseQR, if it is compiled in (see --version)", BackendChoice::Spqr),
    ("gauss", "Block-wise Gauss elimination, for comparison", BackendChoice::Gauss),
];

impl ModelArgs {
    /// The files named on the command line, which no output may replace.
    pub fn inputs(&self) -> Inputs {
        Inputs::new(case_files(&self.input, self.rhs.as_deref(), self.prescribed.as_deref()))
    }

    /// The number of threads asked for, but at most as many as run at a time: more would only take memory.
    pub fn threads(&self) -> Option<NonZeroUsize> {
        let most = std::thread::available_parallelism().unwrap_or(NonZeroUsize::MAX);
        if let Some(asked) = self.threads.filter(|&asked| asked > most) {
            say(format_args!("note: --threads {asked}: this machine runs {most} at a time, so {most} are used"));
        }
        self.threads.map(|asked| asked.min(most))
    }

    /// The settings of the library, from these arguments.
    pub fn options(&self) -> Options {
        let standard = Options::default();
        let relative = self.tolerance.map_or(standard.tolerance, Tolerance::Relative);
        let tolerance = if self.paper_tolerance { Tolerance::Paper } else { relative };
        let (presolve, effort, numbers) = (!self.no_presolve, self.effort, self.numbers);
        let noise = self.noise.clone();
        Options { backend: self.backend, tolerance, noise, presolve, effort, numbers, ..standard }
    }
}

impl KeepArgs {
    pub fn preferences(&self) -> PreferenceLists<'_> {
        PreferenceLists { keep: self.keep.as_ref(), ..PreferenceLists::default() }
    }
}

impl ReduceArgs {
    pub fn options(&self) -> Options {
        Options { growth: self.growth, ..self.model.options() }
    }

    /// Equations to keep, and DOFs that should or should not be slaves.
    pub fn preferences(&self) -> PreferenceLists<'_> {
        let (prefer_slaves, avoid_slaves) = (self.prefer_slaves.as_ref(), self.avoid_slaves.as_ref());
        PreferenceLists { prefer_slaves, avoid_slaves, ..self.keep.preferences() }
    }

    /// The load case; the user has to name it if load cases constrain differently.
    pub fn choice(&self) -> LoadCaseChoice {
        LoadCaseChoice::new(self.case.as_deref(), LoadCaseChoice::Any)
    }
}

impl ExplainArgs {
    /// All load cases, of which the worst one is explained, or the one that the user names.
    pub fn choice(&self) -> LoadCaseChoice {
        LoadCaseChoice::new(self.case.as_deref(), LoadCaseChoice::All)
    }
}

impl CheckArgs {
    /// The load cases to check: all, or the one that the user names.
    pub fn choice(&self) -> LoadCaseChoice {
        LoadCaseChoice::new(self.case.as_deref(), LoadCaseChoice::All)
    }
}

/// Parses `auto`, `none`, or a relative size.
fn noise(text: &str) -> Result<Noise, String> {
    match text {
        "auto" => Ok(Noise::Auto),
        "none" => Ok(Noise::None),
        _ => match text.parse() {
            Ok(size) if size > 0.0 && size < 1.0 => Ok(Noise::Relative(size)),
            _ => Err("expected auto, none, or a size between 0 and 1, such as 1e-12".to_owned()),
        },
    }
}

fn tolerance(text: &str) -> Result<f64, String> {
    checked(text, |tolerance| Options { tolerance: Tolerance::Relative(tolerance), ..Options::default() })
}

fn growth(text: &str) -> Result<f64, String> {
    checked(text, |growth| Options { growth, ..Options::default() })
}

/// Parses a number. `options` puts it into options that the library then validates.
fn checked(text: &str, options: impl Fn(f64) -> Options) -> Result<f64, String> {
    let number = number(text)?;
    options(number).validate().map_err(|error| error.to_string())?;
    Ok(number)
}
