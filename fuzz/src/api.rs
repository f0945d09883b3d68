//! Calls of the library in any order and with any arguments: a result or a typed error, never a panic; what is returned is finite.

use std::sync::Arc;

use arbitrary::{Arbitrary, Unstructured};
use qless::exact::{self, Reading, Settings};
use qless::{
    Analysis, BackendChoice, ChangingSystem, ConstraintSystem, Csr, EquationId, Form, Options, Preferences, Reduction,
    Refresher, Report, SystemBuilder, Tolerance, analyse,
};

/// A small index, most often; sometimes any.
#[derive(Arbitrary, Clone, Copy, Debug)]
enum Index {
    Small(u8),
    Other(u8),
    Any(usize),
}

impl Index {
    fn get(self) -> usize {
        match self {
            Self::Small(k) | Self::Other(k) => usize::from(k % 24),
            Self::Any(k) => k,
        }
    }
}

/// A small whole number, most often; sometimes any double.
#[derive(Arbitrary, Clone, Copy, Debug)]
enum Number {
    Small(i8),
    Tenths(i8),
    Any(f64),
}

impl Number {
    fn get(self) -> f64 {
        match self {
            Self::Small(k) => f64::from(k % 5),
            Self::Tenths(k) => f64::from(k) / 10.0,
            Self::Any(v) => v,
        }
    }
}

#[derive(Arbitrary, Debug)]
struct Settled {
    backend: u8,
    tolerance: Option<Number>,
    presolve: bool,
    unchecked: bool,
    growth: Option<Number>,
    memory: Option<u32>,
    masters: Vec<Index>,
    slaves: Vec<Index>,
    equations: Vec<Index>,
}

impl Settled {
    fn options(&self) -> Options {
        let backends = [BackendChoice::Auto, BackendChoice::Faer, BackendChoice::Sparse, BackendChoice::Gauss];
        let all = |list: &[Index]| list.iter().map(|k| k.get()).collect();
        let default = Options::default();
        Options {
            backend: backends[usize::from(self.backend) % 4],
            tolerance: self.tolerance.map_or(default.tolerance, |v| Tolerance::Relative(v.get())),
            presolve: self.presolve,
            check: !self.unchecked,
            growth: self.growth.map_or(default.growth, Number::get),
            memory: self.memory.map_or(default.memory, |bytes| bytes as usize),
            preferences: Preferences {
                masters: all(&self.masters),
                slaves: all(&self.slaves),
                equations: all(&self.equations),
            },
        }
    }
}

#[derive(Arbitrary, Debug)]
enum Call {
    Because(Index),
    BecauseFixed(Index),
    Meant,
    Reduce(u8),
    Expand(Vec<Number>, Vec<Number>),
    ExpandFitting(Number),
    Transposed(Vec<Number>),
    Row(Index),
    Column(Index),
    Residual,
    Refresh(Vec<Number>, Vec<Number>),
    RefreshFitting(Number, Number),
    Report(u8),
    Exact(u64, bool, Option<u8>),
    Parts(Vec<u8>, Vec<u32>, Vec<Number>),
    System(u8, Vec<Index>, Vec<Index>, Vec<Number>),
}

#[derive(Arbitrary, Debug)]
enum Change {
    Add(Vec<(Index, Number)>, Number),
    Remove(u8),
    Rhs(u8, Number),
    Terms(u8, Vec<(Index, Number)>),
    Prescribe(Index, Number),
    Release(Index),
    Update,
    Ask(u8),
    Expand(u8, Number),
}

#[derive(Arbitrary, Debug)]
struct Input {
    dofs: u8,
    equations: Vec<(Vec<(Index, Number)>, Number)>,
    prescribed: Vec<(Index, Number)>,
    settled: Settled,
    calls: Vec<Call>,
    changes: Vec<Change>,
}

/// Makes the calls that the bytes stand for.
pub fn api(data: &[u8]) {
    let Ok(input) = Input::arbitrary_take_rest(Unstructured::new(data)) else { return };
    let dofs = usize::from(input.dofs % 24);
    let mut builder = SystemBuilder::new(dofs);
    for (terms, rhs) in &input.equations {
        builder.equation(terms.iter().map(|(j, v)| (j.get(), v.get())), rhs.get());
    }
    input.prescribed.iter().for_each(|(j, v)| builder.prescribe(j.get(), v.get()));
    let options = input.settled.options();
    if let Ok(system) = builder.build()
        && let Ok(analysis) = analyse(&system, &options)
    {
        calls(&system, analysis, &input.calls);
    }
    changes(dofs, options, &input.changes);
}

fn calls(system: &ConstraintSystem, analysis: Analysis, calls: &[Call]) {
    let analysis = Arc::new(analysis);
    let twin = analyse(system, &Options::default()).ok().and_then(|analysis| analysis.reduction().ok());
    let mut reductions: Vec<Reduction> = twin.into_iter().collect();
    let mut refresher = None;
    for call in calls {
        let last = reductions.last();
        match call {
            Call::Because(row) => assert_eq!(analysis.because(row.get()).is_ok(), row.get() < system.equations()),
            Call::BecauseFixed(dof) => _ = analysis.because_fixed(dof.get()),
            Call::Meant => {
                if let Ok(Some(meant)) = analysis.meant() {
                    Report::new(&analysis, 0).with_meant(&analysis, &meant, 5).expect("of this system");
                }
            }
            Call::Reduce(form) => {
                let form = [Form::Explicit, Form::Factored, Form::Auto][usize::from(form % 3)];
                reductions.extend(analysis.reduction_in(form));
            }
            Call::Expand(q, p) => _ = last.map(|last| finite(last.expand(&numbers(q), &numbers(p)))),
            Call::ExpandFitting(v) => {
                let values = |list: &[usize]| vec![v.get(); list.len()];
                last.map(|last| finite(last.expand(&values(last.masters()), &values(last.prescribed()))));
            }
            Call::Transposed(f) => _ = last.map(|last| finite(last.apply_transposed(&numbers(f)))),
            Call::Row(i) => _ = last.map(|last| assert_eq!(last.row(i.get()).is_ok(), i.get() < last.slaves().len())),
            Call::Column(q) => {
                last.map(|last| assert_eq!(last.column(q.get()).is_ok(), q.get() < last.masters().len()));
            }
            Call::Residual => _ = last.map(|last| analysis.residual(last).expect("the same DOFs")),
            Call::Refresh(b, u) => refresh(&analysis, &mut refresher, &mut reductions, &numbers(b), &numbers(u)),
            Call::RefreshFitting(b, u) => {
                let (b, u) = (vec![b.get(); system.equations()], vec![u.get(); system.prescribed().len()]);
                refresh(&analysis, &mut refresher, &mut reductions, &b, &u);
            }
            Call::Report(terms) => _ = Report::new(&analysis, usize::from(*terms)),
            Call::Exact(seed, typed, fill) => {
                let reading = if *typed { Reading::Typed } else { Reading::Stored };
                let standard = Settings::from(reading);
                let fill = fill.map_or(standard.fill, usize::from);
                if let Ok(found) = exact::rank(system, Settings { seed: *seed, fill, ..standard }) {
                    Report::new(&analysis, 0).with_exact(&analysis, &found).expect("of this system");
                }
            }
            Call::Parts(start, col, val) => {
                let start = start.iter().map(|&k| usize::from(k)).collect();
                if let Ok(matrix) = Csr::from_parts(24, start, col.clone(), numbers(val)) {
                    assert_eq!(matrix.transpose().and_then(|by_column| by_column.transpose()).map(|m| m.nnz()), Ok(matrix.nnz()));
                    ConstraintSystem::from_csr(&matrix, &vec![0.0; matrix.rows()], &[]).ok();
                }
            }
            Call::System(rows, start, row, values) => {
                let all = |list: &[Index]| list.iter().map(|k| k.get()).collect::<Vec<_>>();
                let b = vec![0.0; usize::from(*rows)];
                ConstraintSystem::from_csc(usize::from(*rows), &all(start), &all(row), &numbers(values), &b, &[]).ok();
            }
        }
    }
}

fn numbers(list: &[Number]) -> Vec<f64> {
    list.iter().map(|v| v.get()).collect()
}

fn finite(found: Result<Vec<f64>, qless::ArgumentError>) {
    found.into_iter().flatten().for_each(|v| assert!(v.is_finite()));
}

/// The first reduction is of another analysis.
fn refresh(
    analysis: &Arc<Analysis>,
    refresher: &mut Option<Refresher>,
    reductions: &mut [Reduction],
    b: &[f64],
    u: &[f64],
) {
    if refresher.is_none() {
        *refresher = Refresher::new(Arc::clone(analysis)).ok();
    }
    let (Some(refresher), Some(first)) = (refresher, reductions.first().cloned()) else { return };
    if let Some(last) = reductions.last_mut()
        && refresher.refresh(b, u, last).is_ok()
    {
        assert!(last.g().iter().all(|v| v.is_finite()));
    }
    let foreign = refresher.refresh(b, u, &mut first.clone());
    assert!(foreign.is_err() || reductions.len() < 2 || first.slaves() == reductions[1].slaves());
}

fn changes(dofs: usize, options: Options, changes: &[Change]) {
    let mut set = ChangingSystem::new(dofs, options.clone()).expect("few DOFs");
    let mut other = ChangingSystem::new(dofs, options).expect("few DOFs");
    let mut known: Vec<EquationId> = other.add([], 0.0).into_iter().collect();
    let foreign = known[0];
    let terms = |list: &[(Index, Number)]| list.iter().map(|(j, v)| (j.get(), v.get())).collect::<Vec<_>>();
    for change in changes {
        let pick = |k: &u8| known[usize::from(*k) % known.len()];
        match change {
            Change::Add(list, rhs) => known.extend(set.add(terms(list), rhs.get())),
            Change::Remove(k) => assert!(set.remove(pick(k)).is_err() || pick(k) != foreign),
            Change::Rhs(k, rhs) => assert!(set.set_rhs(pick(k), rhs.get()).is_err() || pick(k) != foreign),
            Change::Terms(k, list) => assert!(set.set_terms(pick(k), terms(list)).is_err() || pick(k) != foreign),
            Change::Prescribe(dof, value) => _ = set.prescribe(dof.get(), value.get()),
            Change::Release(dof) => _ = set.release(dof.get()),
            Change::Update => _ = set.update(),
            Change::Ask(k) => {
                assert!(set.because(pick(k)).is_err() || pick(k) != foreign);
                set.kind(pick(k));
                set.block_of(pick(k)).map(|block| block.reduction().growth());
            }
            Change::Expand(count, v) => {
                let mut u = vec![v.get(); usize::from(count % 32)];
                assert!(set.expand(&mut u).is_err() || u.len() == dofs);
            }
        }
    }
}
