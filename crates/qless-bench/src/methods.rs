//! The measured methods: the bare factorization, which is the unit of time, the four efforts, and other libraries.

use qless::{BackendChoice, Effort, Options};

/// The library and settings that do the work.
pub enum Engine {
    /// One sparse QR of `C^T` or of C, whichever is faster, without presolve, scaling or checks. Its time is the unit for the times of all
    /// methods.
    BareQr,
    /// qless with these settings.
    Qless(Options),
    /// Another library with this absolute tolerance, in a process of its own.
    #[cfg(feature = "peers")]
    Peer(Box<dyn qless::backend::Backend>, f64),
    /// Another solver, as a program.
    #[cfg(feature = "peers")]
    Solver(super::peers::Solver),
}

/// A method and its name.
pub struct BenchMethod {
    pub name: &'static str,
    pub engine: Engine,
    /// True if the method runs in a process of its own, where it can be stopped.
    pub is_apart: bool,
    /// True if the method stores all of C, including zeros.
    pub is_dense: bool,
}

/// The name of the method whose time is the unit.
pub const UNIT: &str = "bare QR";

/// The efforts, the least certain one first.
pub const EFFORTS: [Effort; 4] = [Effort::Quick, Effort::Checked, Effort::Proved, Effort::Exact];

impl BenchMethod {
    /// Returns true for another library, which has a time limit of its own.
    pub fn is_peer(&self) -> bool {
        !matches!(self.engine, Engine::Qless(..) | Engine::BareQr)
    }

    /// Returns true for a solver, which is a program of its own.
    pub fn is_solver(&self) -> bool {
        #[cfg(feature = "peers")]
        return matches!(self.engine, Engine::Solver(_));
        #[cfg(not(feature = "peers"))]
        false
    }

    fn new(name: &'static str, options: Options) -> Self {
        Self { name, engine: Engine::Qless(options), is_apart: false, is_dense: false }
    }
}

/// All methods that this program was built with; if names are given, only these.
pub fn all(only: &[String]) -> Vec<BenchMethod> {
    let standard = Options::default();
    let alone = |backend| Options { backend, presolve: false, ..standard.clone() };
    let mut all = vec![BenchMethod { name: UNIT, engine: Engine::BareQr, is_apart: false, is_dense: false }];
    all.extend(EFFORTS.map(|effort| BenchMethod {
        // Without checks of the rank, the slaves can be so ill-conditioned that their exchange for masters takes minutes.
        is_apart: effort == Effort::Quick,
        ..BenchMethod::new(effort.name(), Options { effort, ..standard.clone() })
    }));
    all.push(BenchMethod::new("gauss alone", alone(BackendChoice::Gauss)));
    if cfg!(feature = "spqr") {
        all.push(BenchMethod::new("spqr alone", alone(BackendChoice::Spqr)));
    }
    let is_wanted = |name: &str| only.is_empty() || only.iter().any(|wanted| wanted == name);
    #[cfg(feature = "peers")]
    all.extend(peers(is_wanted));
    all.retain(|method| is_wanted(method.name));
    all
}

/// Other libraries that are in common use, and those of the solvers that are wanted and installed. Only for wanted ones a program is
/// started to see whether they are.
#[cfg(feature = "peers")]
fn peers(is_wanted: impl Fn(&str) -> bool) -> impl Iterator<Item = BenchMethod> {
    use super::peers::{Eigen, Lapack, Rule, Solver};
    let peer = |name, engine| BenchMethod { name, engine, is_apart: true, is_dense: false };
    let lapack = peer("LAPACK dgeqp3", Engine::Peer(Box::new(Lapack(Rule::Own)), 0.0));
    [peer("Eigen SparseQR", Engine::Peer(Box::new(Eigen(Rule::Own)), 0.0)), BenchMethod { is_dense: true, ..lapack }]
        .into_iter()
        .chain(
            Solver::ALL
                .into_iter()
                .filter(move |solver| is_wanted(solver.name()) && solver.is_installed())
                .map(move |solver| peer(solver.name(), Engine::Solver(solver))),
        )
}
