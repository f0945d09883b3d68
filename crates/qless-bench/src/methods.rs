//! The choices: one thing at a time is different from the default.

use qless::{BackendChoice, Options, Tolerance};
use rayon::{ThreadPool, ThreadPoolBuilder};

/// The library and settings that do the elimination.
pub enum Engine {
    /// qless with these settings, in this pool or the program's.
    Qless(Options, Option<ThreadPool>),
    /// Another library with this absolute tolerance, in a process of its own.
    #[cfg(feature = "peers")]
    Peer(Box<dyn qless::backend::Backend>, f64),
}

/// A choice and its name.
pub struct BenchMethod {
    pub name: &'static str,
    pub engine: Engine,
    /// Whether it is drawn in the plot of times against sizes.
    pub is_drawn: bool,
    /// Whether it runs in a process of its own, where it can be stopped.
    pub is_apart: bool,
    /// Whether it holds all of C, zeros too.
    pub is_dense: bool,
}

/// No bound of the growth, for all that matters.
const UNBOUNDED: f64 = 1e15;

impl BenchMethod {
    /// Whether the limit for other libraries is its own.
    pub fn is_peer(&self) -> bool {
        !matches!(self.engine, Engine::Qless(..))
    }

    fn new(name: &'static str, options: Options) -> Self {
        Self { name, engine: Engine::Qless(options, None), is_drawn: false, is_apart: false, is_dense: false }
    }

    fn drawn(self) -> Self {
        Self { is_drawn: true, ..self }
    }

    /// None if the system gives no threads.
    fn on(name: &'static str, options: Options, threads: usize) -> Option<Self> {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().ok()?;
        Some(Self { engine: Engine::Qless(options, Some(pool)), ..Self::new(name, Options::default()) })
    }
}

/// All that this program was built with; with names, those only.
pub fn all(only: &[String]) -> Vec<BenchMethod> {
    let standard = Options::default();
    let alone = |backend| Options { backend, presolve: false, ..standard.clone() };
    let tolerance = |tolerance| Options { tolerance: Tolerance::Relative(tolerance), ..standard.clone() };
    // Without checks of the rank, the slaves can be so ill-conditioned that the exchanges take minutes.
    let unchecked =
        |name, options| BenchMethod { is_apart: true, ..BenchMethod::new(name, Options { check: false, ..options }) };
    let mut all = vec![BenchMethod::new("default", standard.clone()).drawn()];
    all.extend(BenchMethod::on("default, 1 thread", standard.clone(), 1));
    all.extend(BenchMethod::on("default, 2 threads", standard.clone(), 2));
    all.extend([
        unchecked("rank unchecked", standard.clone()),
        BenchMethod::new("faer alone", alone(BackendChoice::Faer)).drawn(),
        BenchMethod::new("sparse alone", alone(BackendChoice::Sparse)).drawn(),
        unchecked("sparse alone, rank unchecked", alone(BackendChoice::Sparse)),
    ]);
    if cfg!(feature = "spqr") {
        all.push(BenchMethod::new("spqr alone", alone(BackendChoice::Spqr)).drawn());
    }
    if cfg!(feature = "tbb") {
        // The task tree has as many threads as the pool, so none of it is used here.
        all.extend(BenchMethod::on("spqr alone, 1 thread", alone(BackendChoice::Spqr), 1));
    }
    all.extend([
        BenchMethod::new("gauss alone", alone(BackendChoice::Gauss)).drawn(),
        BenchMethod::new("gauss", Options { backend: BackendChoice::Gauss, ..standard.clone() }),
        BenchMethod::new("growth 2", Options { growth: 2.0, ..standard.clone() }),
        BenchMethod::new("growth unbounded", Options { growth: UNBOUNDED, ..standard.clone() }),
        BenchMethod::new("tolerance 1e-4", tolerance(1e-4)),
        BenchMethod::new("tolerance 1e-6", tolerance(1e-6)),
        BenchMethod::new("tolerance 1e-8", tolerance(1e-8)),
        BenchMethod::new("tolerance 1e-12", tolerance(1e-12)),
        BenchMethod::new("tolerance 1e-14", tolerance(1e-14)),
        BenchMethod::new("paper's tolerance", Options { tolerance: Tolerance::Paper, ..standard }),
    ]);
    #[cfg(feature = "peers")]
    all.extend(peers());
    all.retain(|method| only.is_empty() || only.iter().any(|name| name == method.name));
    all
}

/// Other libraries in use today.
#[cfg(feature = "peers")]
fn peers() -> [BenchMethod; 3] {
    use super::peers::{Eigen, Lapack, Rule};
    let peer = |name, backend, tolerance| BenchMethod {
        name,
        engine: Engine::Peer(backend, tolerance),
        is_drawn: true,
        is_apart: true,
        is_dense: false,
    };
    // The tolerance of the paper, section 3.2.
    let paper = 1e-5;
    [
        peer("Eigen SparseQR", Box::new(Eigen(Rule::Own)), 0.0),
        peer("Eigen SparseQR, paper's tolerance", Box::new(Eigen(Rule::Call)), paper),
        BenchMethod { is_dense: true, ..peer("LAPACK dgeqp3", Box::new(Lapack(Rule::Own)), 0.0) },
    ]
}
