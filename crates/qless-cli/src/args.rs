//! The command line.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use qless::{BackendChoice, Form, Options, Tolerance};
use qless_bench::BenchArgs;
use qless_io::case_files;
use qless_io::deck::Solver;
use qless_io::write::Inputs;

use crate::deck_input::LoadCaseChoice;
use crate::failure::say;
use crate::preferences::{PreferenceLists, WordList, words};
use crate::scenes::SceneArgs;
use crate::{exit_code, memory};

/// Finds redundant and conflicting constraint equations `C u = b` in finite-element models, says why, and reduces them.
#[derive(Parser)]
#[command(name = "qless", version = VERSION, propagate_version = false, after_help = exit_code::HELP)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

/// The answer to `--version`: the release, the compiled backends, and the licence if it differs.
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
    /// Writes a test model of known rank
    Generate(SceneArgs),
    /// Measures what speed costs in accuracy on this machine
    Bench(BenchArgs),
}

impl Command {
    /// The limit on memory in bytes, if there is one.
    pub fn memory(&self) -> Option<usize> {
        let model = match self {
            Self::Check(args) => &args.model,
            Self::Reduce(args) => &args.model,
            Self::Clean(args) => &args.model,
            Self::Generate(_) | Self::Bench(_) => return None,
        };
        model.memory.map(NonZeroUsize::get)
    }
}

#[derive(Args)]
pub struct CheckArgs {
    #[command(flatten)]
    pub model: ModelArgs,
    /// Take the rank in exact arithmetic as well, of the numbers as typed: 0.1 is 1/10, and no tolerance decides. It settles an
    /// ambiguous rank, if no coefficient was rounded before it was typed; verdict and exit code stay those of the analysis
    #[arg(long)]
    pub exact: bool,
    /// Load case of a deck: its name (`step 2`) or the number in it, or `all`, of which the worst is shown [default: all]
    #[arg(long, value_name = "CASE")]
    pub case: Option<String>,
    /// File for the report, whole or not at all [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

const FACTORS: &str = "\
Files of a part in factor form, for k = 1, 2, ...; no file has any scaling in it:
  block<k>_slaves.txt      columns of C that are slaves, the columns of C_S
  block<k>_masters.txt     columns of C that are masters, the columns of C_M
  block<k>_prescribed.txt  columns of C that are prescribed, the columns of C_p
  block<k>_equations.txt   rows of C, in the order of the elimination: the rows of C_S, C_M, C_p and b
  block<k>_L.mtx           lower triangular, with ones on its diagonal
  block<k>_U.mtx           upper triangular
  block<k>_C_M.mtx, block<k>_C_p.mtx, block<k>_b.txt

  C_S = U^T L^T,  u_s = C_S^-1 (b - C_M u_q - C_p u_p): U^T forward, then L^T backward
  T = -C_S^-1 C_M,  T^T f = -C_M^T C_S^-T f: L forward, then U backward

Their rows of T.mtx and G.mtx are empty; those of g.txt are C_S^-1 b. Their largest entry of T is the largest that a
search found. Files block<k>_* of an earlier run are removed.";

#[derive(Args)]
#[command(after_long_help = FACTORS)]
pub struct ReduceArgs {
    #[command(flatten)]
    pub model: ModelArgs,
    /// Folder for T.mtx, G.mtx, g.txt, slaves.txt, masters.txt and prescribed.txt (columns of G), all counted from 1, and
    /// cols.txt (names of the DOFs) where they have names
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Load case of a deck: its name (`step 2`) or the number in it; needed where load cases constrain differently
    #[arg(long, value_name = "CASE")]
    pub case: Option<String>,
    /// How T is written
    #[arg(long, value_enum, value_name = "FORM", default_value = "explicit")]
    pub form: FormName,
    /// Exchange slaves and masters until no entry of T is larger than this; at least 1
    #[arg(long, value_name = "X", default_value = "4", value_parser = growth)]
    pub growth: f64,
    /// DOFs preferred as slaves, such as 3,7,10-20 (columns counted from 1); of a deck also 5:3 (node:component), line 41, names of
    /// node sets; of a folder also labels of cols.txt, in quotes where they have commas
    #[arg(long, value_name = "LIST", value_parser = words)]
    pub prefer_slaves: Option<WordList>,
    /// DOFs that must not be slaves (loaded, interface), as far as the equations allow it; as --prefer-slaves
    #[arg(long, value_name = "LIST", value_parser = words)]
    pub avoid_slaves: Option<WordList>,
}

#[derive(Args)]
pub struct CleanArgs {
    #[command(flatten)]
    pub model: ModelArgs,
    /// The deck to write, of the same format; it may be the input itself
    #[arg(short, long, value_name = "DECK")]
    pub output: PathBuf,
}

/// The model, and how to look at it.
#[derive(Args)]
#[expect(clippy::struct_excessive_bools, reason = "each is an option that stands alone")]
pub struct ModelArgs {
    /// A deck (CalculiX, Abaqus, Nastran, ANSYS: its first cards say which), a matrix C (.mtx), or a folder with C.mtx and, if there are
    /// any, b.txt, prescribed.txt, rows.txt, cols.txt; gzip and UTF-16 are read, `-` is standard input
    pub input: PathBuf,
    /// Right-hand side b, one number a line [default: b.txt of a folder, else zeros]
    #[arg(long, value_name = "FILE")]
    pub rhs: Option<PathBuf>,
    /// Prescribed DOFs, `column value` a line, columns counted from 1 [default: prescribed.txt of a folder, else none]
    #[arg(long, value_name = "FILE")]
    pub prescribed: Option<PathBuf>,
    /// What factors the equations that presolve leaves
    #[arg(long, value_enum, value_name = "NAME", default_value = "faer")]
    pub backend: BackendName,
    /// How small is zero, relative to each equation's largest coefficient; between 0 and 1 [default: 1e-10]
    #[arg(long, value_name = "X", value_parser = tolerance)]
    pub tolerance: Option<f64>,
    /// The paper's rule instead: absolute 1e-5 without scaling (its answer changes with the units)
    #[arg(long, conflicts_with = "tolerance")]
    pub paper_tolerance: bool,
    /// Most threads to use; more than the machine runs at a time are not started
    #[arg(long, value_name = "N", value_parser = threads)]
    pub threads: Option<NonZeroUsize>,
    /// Most memory of the whole run, such as 512MiB or 2GiB; without a unit MiB [default: what there is, with 16GiB at most for one
    /// factorization and 1536MiB for --exact]
    #[arg(long, value_name = "SIZE", value_parser = memory::parse)]
    pub memory: Option<NonZeroUsize>,
    /// Leave every equation to the backend
    #[arg(long)]
    pub no_presolve: bool,
    /// Leave out the checks of the rank, which can then be wrong without a word
    #[arg(long)]
    pub no_check: bool,
    /// Equations to keep where others can be called dependent instead, such as 3,7,10-20 (rows counted from 1); of a deck also line 41,
    /// 5:3 (those that begin with this DOF), names of node sets; of a folder also labels of rows.txt
    #[arg(long, value_name = "LIST", value_parser = words)]
    pub keep: Option<WordList>,
    /// Solver of a deck whose behaviour counts: ccx, abaqus, nastran, mystran, optistruct or ansys [default: by the deck's format,
    /// ccx, nastran or ansys]
    #[arg(long, value_name = "NAME")]
    pub solver: Option<Solver>,
    /// Exit as the equations deserve that were read, though something that constrains was left out; reduce then writes them
    #[arg(long)]
    pub allow_incomplete: bool,
    /// Form of the report
    #[arg(long, value_enum, default_value = "text")]
    pub format: Format,
    /// Exit with 1 where equations are redundant too; reduce then writes nothing
    #[arg(long, value_enum, value_name = "WHAT")]
    pub deny: Option<Deny>,
    /// No progress display
    #[arg(long, short)]
    pub quiet: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// For people, at most 24 lines
    Text,
    /// Everything, as one JSON object
    Json,
    /// For a browser: one page with tables and pictures that needs no network
    Html,
    /// Nodes of a deck for ParaView: slaves, masters, redundant, conflicting; with -o FILE.vtu
    Vtu,
}

#[derive(Clone, Copy, ValueEnum)]
pub enum FormName {
    /// All of it as numbers
    Explicit,
    /// As sparse factors, for each connected part of the equations that needs elimination and in which no slave is wished for
    Factored,
    /// As factors where it would have more than 4096 numbers and more than 4 times those of the equations and of the factors
    Auto,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Deny {
    /// Equations that are combinations of others
    Redundant,
}

#[derive(Clone, Copy, ValueEnum)]
pub enum BackendName {
    /// Pure Rust, on the kernels of faer: QR with column pivoting, multifrontal sparse QR for large blocks
    Faer,
    /// Pure Rust: multifrontal sparse QR for every block
    Sparse,
    /// SuiteSparseQR, where it is compiled in (see --version)
    Spqr,
    /// Block-wise Gauss elimination, for comparison
    Gauss,
}

impl ModelArgs {
    /// The files named on the command line, which no output may replace.
    pub fn inputs(&self) -> Inputs {
        Inputs::of(case_files(&self.input, self.rhs.as_deref(), self.prescribed.as_deref()))
    }

    /// The number of threads asked for, but not more than run at a time: further ones only take memory.
    pub fn threads(&self) -> Option<NonZeroUsize> {
        let most = std::thread::available_parallelism().unwrap_or(NonZeroUsize::MAX);
        if let Some(asked) = self.threads.filter(|&asked| asked > most) {
            say(format_args!("note: --threads {asked}: this machine runs {most} at a time, so {most} are used"));
        }
        self.threads.map(|asked| asked.min(most))
    }

    /// The library's settings.
    pub fn options(&self) -> Options {
        let backend = match self.backend {
            BackendName::Faer => BackendChoice::Faer,
            BackendName::Sparse => BackendChoice::Sparse,
            BackendName::Spqr => BackendChoice::Spqr,
            BackendName::Gauss => BackendChoice::Gauss,
        };
        let standard = Options::default();
        let relative = self.tolerance.map_or(standard.tolerance, Tolerance::Relative);
        let tolerance = if self.paper_tolerance { Tolerance::Paper } else { relative };
        let (presolve, check) = (!self.no_presolve, !self.no_check);
        Options { backend, tolerance, presolve, check, ..standard }
    }

    /// Equations to keep.
    pub fn preferences(&self) -> PreferenceLists<'_> {
        PreferenceLists { keep: self.keep.as_ref(), ..PreferenceLists::default() }
    }
}

impl ReduceArgs {
    pub fn form(&self) -> Form {
        match self.form {
            FormName::Explicit => Form::Explicit,
            FormName::Factored => Form::Factored,
            FormName::Auto => Form::Auto,
        }
    }

    pub fn options(&self) -> Options {
        Options { growth: self.growth, ..self.model.options() }
    }

    /// Equations to keep, and DOFs as slaves or not.
    pub fn preferences(&self) -> PreferenceLists<'_> {
        let (prefer_slaves, avoid_slaves) = (self.prefer_slaves.as_ref(), self.avoid_slaves.as_ref());
        PreferenceLists { prefer_slaves, avoid_slaves, ..self.model.preferences() }
    }

    /// The load case; where they differ it has to be named.
    pub fn choice(&self) -> LoadCaseChoice {
        LoadCaseChoice::new(self.case.as_deref(), LoadCaseChoice::Any)
    }
}

impl CheckArgs {
    /// The load cases.
    pub fn choice(&self) -> LoadCaseChoice {
        LoadCaseChoice::new(self.case.as_deref(), LoadCaseChoice::All)
    }
}

fn threads(text: &str) -> Result<NonZeroUsize, String> {
    text.parse().map_err(|_| "expected a whole number of at least 1".to_owned())
}

fn tolerance(text: &str) -> Result<f64, String> {
    checked(text, |tolerance| Options { tolerance: Tolerance::Relative(tolerance), ..Options::default() })
}

fn growth(text: &str) -> Result<f64, String> {
    checked(text, |growth| Options { growth, ..Options::default() })
}

/// A number that the library accepts in these options.
fn checked(text: &str, options: impl Fn(f64) -> Options) -> Result<f64, String> {
    let number = text.parse().map_err(|_| "not a number; write it as 0.001 or 1e-3".to_owned())?;
    options(number).validate().map_err(|error| error.to_string())?;
    Ok(number)
}
