//! Calls of the library in any order and with any arguments give a finite result or a typed error, and no panic.

use std::sync::Arc;

use arbitrary::{Arbitrary, Unstructured};
use qless::change::{EquationId, Refresher};
use qless::exact::{self, Reading, Settings};
use qless::{
    Analysis, BackendChoice, ChangingSystem, ConstraintSystem, Csr, Effort, Form, Options, Preferences, Reduction,
    Report, SystemBuilder, Tolerance, analyse,
};

/// A list of at most 16 values: a count, then the values.
#[derive(Debug)]
struct List<T>(Vec<T>);

impl<'a, T: Arbitrary<'a>> Arbitrary<'a> for List<T> {
    fn arbitrary(u: &mut Unstructured<'a>) -> arbitrary::Result<Self> {
        let count = u8::arbitrary(u)? % 16;
        (0..count).map(|_| T::arbitrary(u)).collect::<arbitrary::Result<_>>().map(Self)
    }
}

impl<T> std::ops::Deref for List<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.0
    }
}

/// An index, mostly in range.
#[derive(Arbitrary, Clone, Copy, Debug)]
struct Index(u8, u8);

impl Index {
    /// An index for `count` entries.
    fn of(self, count: usize) -> usize {
        match self.1 {
            255 => usize::MAX,
            254 => 1 << 32,
            253 => count,
            _ => usize::from(self.0) % count.max(1),
        }
    }
}

/// A number, mostly small; sometimes NaN, infinite or near the end of the range.
#[derive(Arbitrary, Clone, Copy, Debug)]
struct Number(i8, u8);

impl Number {
    fn get(self) -> f64 {
        let own = f64::from(self.0);
        match self.1 {
            255 => f64::NAN,
            254 => f64::INFINITY,
            253 => f64::MAX,
            252 => f64::MIN_POSITIVE,
            251 => 5e-324,
            240..251 => own * 1e300,
            230..240 => own * 1e-300,
            200..230 => own * 1e-9,
            100..200 => own / 10.0,
            _ => own % 4.0,
        }
    }
}

#[derive(Arbitrary, Debug)]
struct Settled {
    backend: u8,
    tolerance: Option<Index>,
    presolve: bool,
    unchecked: bool,
    growth: Option<Number>,
    memory: Option<u32>,
    masters: List<Index>,
    slaves: List<Index>,
    equations: List<Index>,
}

impl Settled {
    fn options(&self, dofs: usize, equations: usize) -> Options {
        let backends = [BackendChoice::Faer, BackendChoice::Faer, BackendChoice::Sparse, BackendChoice::Gauss];
        let all = |list: &[Index], count: usize| list.iter().take(4).map(|k| k.of(count)).collect::<Vec<usize>>();
        let default = Options::default();
        let masters: Vec<usize> = all(&self.masters, dofs);
        let slaves = all(&self.slaves, dofs).into_iter().filter(|j| self.backend > 250 || !masters.contains(j));
        Options {
            backend: backends[usize::from(self.backend) % 4],
            tolerance: self
                .tolerance
                .map_or(default.tolerance, |k| Tolerance::Relative(10_f64.powi(2 - k.of(20) as i32))),
            noise: match self.backend % 16 {
                15 => qless::Noise::None,
                14 => qless::Noise::Relative(1e-9),
                _ => qless::Noise::Auto,
            },
            presolve: self.presolve,
            effort: match (self.unchecked, self.backend & 64) {
                (true, _) => Effort::Quick,
                (false, 0) => Effort::Checked,
                (false, _) => Effort::Proved,
            },
            numbers: if self.backend & 128 == 0 { Reading::Typed } else { Reading::Stored },
            growth: self.growth.map_or(default.growth, |v| v.get().abs() + 1.0),
            memory: self.memory.map_or(default.memory, |bytes| bytes as usize),
            preferences: Preferences { slaves: slaves.collect(), masters, equations: all(&self.equations, equations) },
        }
    }
}

#[derive(Arbitrary, Debug)]
enum Call {
    CertificateTerm(Index),
    BecauseFixed(Index),
    NearDependence,
    Reduce(u8),
    Expand(List<Number>, List<Number>),
    ExpandFitting(Number),
    Transposed(List<Number>),
    Row(Index),
    Column(Index),
    Residual,
    Refresh(List<Number>, List<Number>),
    RefreshFitting(Number, Number),
    Report(u8),
    Exact(u64, bool, Option<u8>),
    Parts(List<u8>, List<u32>, List<Number>),
    System(u8, List<Index>, List<Index>, List<Number>),
}

#[derive(Arbitrary, Debug)]
enum Change {
    Add(List<(Index, Number)>, Number),
    Remove(u8),
    Rhs(u8, Number),
    Terms(u8, List<(Index, Number)>),
    Prescribe(Index, Number),
    Release(Index),
    Update,
    Ask(u8),
    Expand(u8, Number),
}

#[derive(Arbitrary, Debug)]
struct Input {
    dofs: u8,
    equations: List<(List<(Index, Number)>, Number)>,
    prescribed: List<(Index, Number)>,
    settled: Settled,
    calls: List<Call>,
    changes: List<Change>,
}

/// Makes the calls that the bytes encode.
pub fn api(data: &[u8]) {
    let Ok(input) = Input::arbitrary_take_rest(Unstructured::new(data)) else { return };
    let dofs = if input.dofs == u8::MAX { 0 } else { 1 + usize::from(input.dofs % 24) };
    let mut builder = SystemBuilder::new(dofs);
    for (terms, rhs) in input.equations.iter() {
        builder.equation(terms.iter().map(|(j, v)| (j.of(dofs), v.get())), rhs.get());
    }
    // Mostly one value for each.
    let mut held = std::collections::BTreeSet::new();
    let given = input.prescribed.iter().filter(|(j, v)| held.insert(j.of(dofs)) || v.1 > 250);
    given.for_each(|(j, v)| builder.prescribe(j.of(dofs), v.get()));
    let options = input.settled.options(dofs, input.equations.len());
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
            Call::CertificateTerm(row) => {
                let row = row.of(system.equations());
                assert_eq!(analysis.because(row).is_ok(), row < system.equations());
            }
            Call::BecauseFixed(dof) => _ = analysis.because_fixed(dof.of(system.dofs())),
            Call::NearDependence => {
                if let Ok(Some(meant)) = analysis.near_dependence() {
                    Report::new(&analysis, 0).with_near_dependence(&analysis, &meant, 5).expect("of this system");
                }
            }
            Call::Reduce(form) => {
                let form = [Form::Explicit, Form::Factored, Form::Auto][usize::from(form % 3)];
                reductions.extend(analysis.reduction_in(form));
            }
            Call::Expand(q, p) => _ = last.map(|last| finite(last.expand(&numbers(q), &numbers(p)))),
            Call::ExpandFitting(v) => {
                let values = |list: &[usize]| vec![v.get(); list.len()];
                if let Some(last) = last {
                    finite(last.expand(&values(last.masters()), &values(last.prescribed())));
                }
            }
            Call::Transposed(f) => _ = last.map(|last| finite(last.apply_transposed(&numbers(f)))),
            Call::Row(i) => _ = last.map(|last| place(i.of(last.slaves().len()), last.slaves().len(), |i| last.row(i))),
            Call::Column(q) => {
                if let Some(last) = last {
                    place(q.of(last.masters().len()), last.masters().len(), |q| last.column(q));
                }
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
                exact::rank(system, Settings { seed: *seed, fill, ..standard }).ok();
            }
            Call::Parts(start, col, val) => {
                let start = start.iter().map(|&k| usize::from(k)).collect();
                if let Ok(matrix) = Csr::from_parts(24, start, col.to_vec(), numbers(val)) {
                    assert_eq!(
                        matrix.transpose().and_then(|by_column| by_column.transpose()).map(|m| m.nnz()),
                        Ok(matrix.nnz())
                    );
                    ConstraintSystem::from_csr(&matrix, &vec![0.0; matrix.rows()], &[]).ok();
                }
            }
            Call::System(rows, start, row, values) => {
                let all = |list: &[Index]| list.iter().map(|k| k.of(24)).collect::<Vec<_>>();
                let b = vec![0.0; usize::from(*rows)];
                ConstraintSystem::from_csc(usize::from(*rows), &all(start), &all(row), &numbers(values), &b, &[]).ok();
            }
        }
    }
}

/// A row or a column in range, or an error.
fn place<T, E>(k: usize, count: usize, of: impl FnOnce(usize) -> Result<T, E>) {
    assert_eq!(of(k).is_ok(), k < count);
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
    let terms = |list: &[(Index, Number)]| list.iter().map(|(j, v)| (j.of(dofs), v.get())).collect::<Vec<_>>();
    for change in changes {
        let pick = |k: &u8| known[usize::from(*k) % known.len()];
        match change {
            Change::Add(list, rhs) => known.extend(set.add(terms(list), rhs.get())),
            Change::Remove(k) => assert!(set.remove(pick(k)).is_err() || pick(k) != foreign),
            Change::Rhs(k, rhs) => assert!(set.set_rhs(pick(k), rhs.get()).is_err() || pick(k) != foreign),
            Change::Terms(k, list) => assert!(set.set_terms(pick(k), terms(list)).is_err() || pick(k) != foreign),
            Change::Prescribe(dof, value) => _ = set.prescribe(dof.of(dofs), value.get()),
            Change::Release(dof) => _ = set.release(dof.of(dofs)),
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
