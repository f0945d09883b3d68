//! `analyse`, `Analysis`, `Reduction`, `Refresher`, `ChangingSystem`, `Report`, `exact`.

use std::sync::Arc;
use std::time::Duration;

use qless::change::{ChangeError, RefreshError, Refresher};
use qless::diagnosis::NearDependent;
use qless::exact::{self, Reading, Settings};
use qless::reduction::FactoredBlock;
use qless::{
    Analysis, ArgumentError, ChangingSystem, ConstraintSystem, Csr, Form, NearDependence, Options, Preferences,
    Reduction, Report, SystemBuilder, Tolerance, analyse,
};

use super::{BAD, HUGE, refused, ring, survives};

const FORMS: [Form; 3] = [Form::Explicit, Form::Factored, Form::Auto];

fn analysed(system: &ConstraintSystem) -> Analysis {
    analyse(system, &Options::default()).expect("analysed")
}

/// Equations that are coupled enough to stay factored.
fn coupled() -> ConstraintSystem {
    let mut builder = SystemBuilder::new(12);
    (0..4).for_each(|i| {
        builder.equation((0..9).map(|k| ((2 * i + k) % 11, 1.0 + ((7 * i + 3 * k) % 5) as f64)), i as f64);
    });
    builder.prescribe(10, 0.5);
    builder.build().expect("valid")
}

#[test]
fn options_out_of_range() {
    let system = ring(4);
    let default = Options::default;
    for value in [f64::NAN, 0.0, -1.0, 1.0, f64::INFINITY, f64::NEG_INFINITY] {
        let options = Options { tolerance: Tolerance::Relative(value), ..default() };
        refused("a tolerance", || options.validate());
        refused("a tolerance", || analyse(&system, &options).map(drop));
    }
    for growth in [f64::NAN, 0.0, -4.0, 0.999, f64::INFINITY] {
        refused("growth", || analyse(&system, &Options { growth, ..default() }).map(drop));
    }
    for found in [4, usize::MAX] {
        let lists = [
            Preferences { masters: vec![found], ..Preferences::default() },
            Preferences { slaves: vec![found], ..Preferences::default() },
            Preferences { equations: vec![found], ..Preferences::default() },
        ];
        for preferences in lists {
            refused("a preference", || analyse(&system, &Options { preferences, ..default() }).map(drop));
        }
    }
    let preferences = Preferences { masters: vec![0, 0], slaves: vec![0, 1, 1], ..Preferences::default() };
    refused("a contradiction", || analyse(&system, &Options { preferences, ..default() }).map(drop));
    // The smallest values with a memory limit of zero give an error or a result, not a panic.
    for (growth, memory) in [(1.0, 0), (1e300, 1), (4.0, usize::MAX)] {
        for backend in [qless::BackendChoice::Faer, qless::BackendChoice::Sparse, qless::BackendChoice::Gauss] {
            for system in [ring(4), coupled()] {
                let options = Options { growth, memory, backend, presolve: false, ..default() };
                survives("little memory", || {
                    analyse(&system, &options).map(|analysis| FORMS.map(|form| analysis.reduction_in(form).is_ok()))
                })
                .ok();
            }
        }
    }
}

/// Calls all methods of an analysis and a reduction of nearly empty systems.
#[test]
fn what_is_told_of_little() {
    let mut doubtful = SystemBuilder::new(3);
    doubtful.equation([(0, 1.0), (1, 1e-300)], 0.0);
    doubtful.equation([(0, 1.0)], 1.0);
    doubtful.prescribe(2, f64::MAX);
    for system in [SystemBuilder::new(1).build(), doubtful.build(), Ok(ring(3)), Ok(coupled())] {
        let system = system.expect("valid");
        let analysis = analysed(&system);
        let free = survives("free DOFs", || system.free());
        assert_eq!((free, system.equation_labels().len()), (system.dofs() - system.prescribed().len(), 0));
        survives("told", || {
            (analysis.confidence(), analysis.timings(), analysis.noise().len(), analysis.other_reading().is_some())
        });
        assert!(analysis.dependent().iter().all(|dependent| dependent.row < system.equations()));
        assert!(analysis.unmet_equations().is_empty());
        for form in FORMS {
            let reduction = analysis.reduction_in(form).expect("reduced");
            let size = (reduction.g_matrix().rows(), reduction.g_matrix().cols());
            assert_eq!(size, (reduction.slaves().len(), system.prescribed().len()));
            assert!(reduction.unmet_masters().is_empty() && reduction.unmet_slaves().is_empty());
            assert_eq!(reduction.is_explicit(), reduction.factored().is_empty());
            survives("told", || {
                (reduction.exchanges(), reduction.factored().iter().map(FactoredBlock::predicted).sum::<usize>())
            });
        }
        let exact = exact::rank(&system, Reading::Typed).expect("small");
        assert_eq!(exact.is_solvable(), exact.rank == exact.augmented_rank);
    }
}

/// Systems without equations, with empty equations, and with all DOFs prescribed.
#[test]
fn systems_with_nothing_in_them() {
    let mut empty_rows = SystemBuilder::new(2);
    empty_rows.equation([], 0.0);
    empty_rows.equation([], 1.0);
    empty_rows.equation([(0, 1.0), (0, -1.0)], 0.0);
    let mut prescribed = SystemBuilder::new(2);
    prescribed.equation([(0, 1.0), (1, -1.0)], 0.5);
    (0..2).for_each(|j| prescribed.prescribe(j, 1.0));
    for builder in [SystemBuilder::new(1), empty_rows, prescribed] {
        let system = builder.build().expect("a system");
        survives("everything", || {
            let analysis = analysed(&system);
            (0..system.equations()).for_each(|row| _ = analysis.because(row).expect("a row"));
            (0..system.dofs()).for_each(|dof| _ = analysis.because_fixed(dof).expect("small"));
            assert_eq!(analysis.near_dependence(), Ok(None));
            let value = vec![1.0; system.prescribed().len()];
            for form in FORMS {
                let reduction = analysis.reduction_in(form).expect("reduced");
                let u = reduction.expand(&vec![1.0; reduction.masters().len()], &value).expect("of its lengths");
                assert_eq!((u.len(), analysis.residual(&reduction)), (system.dofs(), Ok(0.0)));
            }
            Report::new(&analysis, usize::MAX);
            let mut reduction = analysis.reduction().expect("reduced");
            let refresher = Refresher::new(analysis).expect("small");
            refresher.refresh(system.rhs(), &value, &mut reduction).expect("the same");
            exact::rank(&system, Reading::Typed).expect("small");
        });
    }
}

#[test]
fn numbers_near_the_end_of_their_range() {
    let sizes = [5e-324, f64::MIN_POSITIVE, 1e-200, 1.0, 1e200, f64::MAX];
    for a in sizes {
        for b in sizes {
            let mut builder = SystemBuilder::new(4);
            builder.equation([(0, a), (1, -b), (2, 1.0)], b);
            builder.equation([(1, b), (2, a)], -a);
            builder.equation([(0, -a), (1, a)], a);
            builder.prescribe(3, f64::MAX);
            let system = builder.build().expect("finite");
            survives(&format!("{a:e} and {b:e}"), || {
                let Ok(analysis) = analyse(&system, &Options::default()) else { return };
                for form in FORMS {
                    let Ok(reduction) = analysis.reduction_in(form) else { continue };
                    let numbers = vec![f64::MAX; reduction.masters().len()];
                    reduction.expand(&numbers, &[f64::MAX]).ok();
                    reduction.apply_transposed(&vec![f64::MAX; reduction.slaves().len()]).ok();
                }
            });
        }
    }
}

#[test]
fn rows_and_dofs_that_are_not_there() {
    let analysis = analysed(&ring(4));
    for place in [4, usize::MAX] {
        let error = refused("because", || analysis.because(place));
        assert_eq!(error, ArgumentError::OutOfRange { what: "equation", found: place, count: 4 });
        assert_eq!(survives("because_fixed", || analysis.because_fixed(place)), Ok(Vec::new()));
    }
    assert!(analysis.because(0).expect("a row").is_empty() || analysis.kinds()[0] != qless::Kind::Independent);
}

#[test]
fn expand_and_its_transposed_take_their_lengths_only() {
    for system in [ring(5), coupled()] {
        for form in FORMS {
            let reduction = analysed(&system).reduction_in(form).expect("reduced");
            let (q, p, s) = (reduction.masters().len(), reduction.prescribed().len(), reduction.slaves().len());
            for count in [0, q - 1, q + 1, system.dofs() + 7] {
                let masters = vec![1.0; if count == q { q + 2 } else { count }];
                refused("masters", || reduction.expand(&masters, &vec![0.0; p]));
                refused("forces", || reduction.apply_transposed(&vec![1.0; s + count + 1]));
            }
            refused("prescribed", || reduction.expand(&vec![1.0; q], &vec![0.0; p + 1]));
            for bad in BAD {
                refused("a master", || reduction.expand(&[vec![bad], vec![0.0; q - 1]].concat(), &vec![0.0; p]));
                refused("a force", || reduction.apply_transposed(&[vec![bad], vec![0.0; s - 1]].concat()));
            }
            for place in HUGE {
                refused("a slave", || reduction.row(place));
                refused("a master", || reduction.column(place));
            }
            refused("one slave too far", || reduction.row(s));
            refused("one master too far", || reduction.column(q));
        }
    }
    // An overflow is an error.
    let mut builder = SystemBuilder::new(3);
    builder.equation([(0, 1.0), (1, -2.0), (2, -2.0)], 0.0);
    let options = Options { growth: 1e9, ..Options::default() };
    let reduction =
        analyse(&builder.build().expect("valid"), &options).expect("analysed").reduction().expect("reduced");
    let beyond =
        refused("beyond", || reduction.expand(&[f64::MAX; 2], &[]).and(reduction.expand(&[-f64::MAX, f64::MAX], &[])));
    assert!(matches!(beyond, ArgumentError::Overflow { what: "u", .. }));
}

#[test]
fn parts_that_are_no_reduction() {
    let matrix = |rows: usize, cols| Csr::from_parts(cols, vec![0; rows + 1], Vec::new(), Vec::new()).expect("zeros");
    let parts = |dofs: [&[usize]; 3], t: (usize, usize), g: (usize, usize), constants: usize| {
        let dofs = dofs.map(<[usize]>::to_vec);
        refused("parts", || Reduction::from_parts(dofs, matrix(t.0, t.1), matrix(g.0, g.1), vec![0.0; constants]))
    };
    parts([&[0], &[0], &[]], (1, 1), (1, 0), 1);
    parts([&[0], &[2], &[]], (1, 1), (1, 0), 1);
    parts([&[1, 0], &[2], &[]], (2, 1), (2, 0), 2);
    parts([&[0], &[1, 1], &[]], (1, 2), (1, 0), 1);
    parts([&[0], &[usize::MAX], &[]], (1, 1), (1, 0), 1);
    parts([&[0], &[1], &[]], (2, 1), (1, 0), 1);
    parts([&[0], &[1], &[]], (1, 2), (1, 0), 1);
    parts([&[0], &[1], &[]], (1, 1), (0, 0), 1);
    parts([&[0], &[1], &[2]], (1, 1), (1, 0), 1);
    parts([&[0], &[1], &[]], (1, 1), (1, 0), 2);
}

#[test]
fn a_reduction_of_other_dofs_has_no_residual() {
    let (small, large) = (analysed(&ring(4)), analysed(&ring(5)));
    let foreign = large.reduction().expect("reduced");
    refused("more DOFs", || small.residual(&foreign));
    refused("none", || small.residual(&Reduction::default()));
    let mut held = SystemBuilder::new(5);
    held.equation([(0, 1.0), (1, -1.0)], 0.0);
    held.prescribe(4, 0.0);
    let held = analysed(&held.build().expect("valid"));
    assert!(matches!(refused("prescribed", || held.residual(&foreign)), ArgumentError::Foreign { .. }));
    // A reduction of another system with the same DOFs is accepted and checked: that of two equations does not satisfy five.
    let mut two = SystemBuilder::new(5);
    two.equation([(0, 1.0), (1, 1.0)], 0.0);
    let residual = large.residual(&analysed(&two.build().expect("valid")).reduction().expect("reduced"));
    assert!(residual.expect("the same DOFs") > 0.1);
}

#[test]
fn a_refresher_takes_its_own_only() {
    let system = coupled();
    let (analysis, twin) = (Arc::new(analysed(&system)), analysed(&system));
    let refresher = Refresher::new(Arc::clone(&analysis)).expect("small");
    for form in FORMS {
        let mut own = analysis.reduction_in(form).expect("reduced").clone();
        let before = own.g().to_vec();
        let mut foreign = twin.reduction_in(form).expect("reduced");
        let (b, u) = (system.rhs().to_vec(), vec![0.5; system.prescribed().len()]);
        let error = refused("of a twin", || refresher.refresh(&b, &u, &mut foreign));
        assert!(matches!(error, RefreshError::Argument(ArgumentError::Foreign { .. })));
        refused("of nobody", || refresher.refresh(&b, &u, &mut Reduction::default()));
        for b in [vec![], vec![0.0; 3], vec![0.0; 5], vec![f64::NAN; 4], vec![f64::INFINITY; 4]] {
            refused("b", || refresher.refresh(&b, &u, &mut own));
        }
        for u in [vec![], vec![0.0; 2], vec![f64::NAN]] {
            refused("u_p", || refresher.refresh(&b, &u, &mut own));
        }
        survives("huge", || refresher.refresh(&[f64::MAX; 4], &[f64::MAX], &mut own)).ok();
        survives("the same list twice", || refresher.refresh(&b, &b[..1], &mut own)).expect("finite");
        refresher.refresh(&b, &u, &mut own).expect("as analysed");
        own.g().iter().zip(&before).for_each(|(a, b)| assert!((a - b).abs() < 1e-14, "{a}, {b}"));
    }
}

/// As a solver keeps them.
struct Model {
    refresher: Refresher,
    reduction: Reduction,
}

#[test]
fn analyses_and_refreshers_can_be_kept_and_sent() {
    fn kept<T: Send + Sync + 'static>() {}
    kept::<Analysis>();
    kept::<Refresher>();
    kept::<Reduction>();
    kept::<ConstraintSystem>();
    let analysis = analysed(&ring(4));
    let reduction = analysis.reduction().expect("reduced");
    let mut model = Model { refresher: Refresher::new(analysis).expect("small"), reduction };
    let found = std::thread::spawn(move || {
        let rank = model.refresher.analysis().rank();
        (rank, model.refresher.refresh(&[0.0; 4], &[], &mut model.reduction).expect("consistent").kinds.len())
    });
    assert_eq!(found.join().expect("no panic"), (3, 4));
}

#[test]
fn equations_of_another_changing_set() {
    for dofs in HUGE {
        refused("DOFs", || ChangingSystem::new(dofs, Options::default()));
    }
    survives("no DOFs", || ChangingSystem::new(0, Options::default()).expect("none").update()).expect("nothing to do");
    let new = || ChangingSystem::new(3, Options::default()).expect("few DOFs");
    let (mut one, mut other) = (new(), new());
    let own = one.add([(0, 1.0), (1, -1.0)], 0.0).expect("valid");
    let foreign = other.add([(0, 1.0), (1, -1.0)], 0.0).expect("valid");
    one.update().expect("valid");
    assert_eq!(refused("remove", || one.remove(foreign)), ChangeError::Foreign(0));
    refused("set_rhs", || one.set_rhs(foreign, 1.0));
    refused("set_terms", || one.set_terms(foreign, [(0, 1.0)]));
    refused("because", || one.because(foreign));
    assert!(one.kind(foreign).is_none() && one.block_of(foreign).is_none() && one.kind(own).is_some());
    for bad in BAD {
        refused("a coefficient", || one.add([(0, bad)], 0.0));
        refused("b", || one.add([(0, 1.0)], bad));
        refused("another b", || one.set_rhs(own, bad));
        refused("other terms", || one.set_terms(own, [(0, bad)]));
        refused("a value", || one.prescribe(0, bad));
        refused("u", || one.expand(&mut [bad; 3]));
    }
    refused("a sum", || one.add([(0, f64::MAX), (0, f64::MAX)], 0.0));
    for dof in [3, usize::MAX] {
        refused("a DOF", || one.add([(dof, 1.0)], 0.0));
        refused("prescribe", || one.prescribe(dof, 0.0));
        refused("release", || one.release(dof));
    }
    refused("short", || one.expand(&mut [0.0; 2]));
    refused("long", || one.expand(&mut [0.0; 4]));
    one.remove(own).expect("there");
    assert_eq!(refused("twice", || one.remove(own)), ChangeError::Gone(0));
    let mut bad = ChangingSystem::new(2, Options { growth: f64::NAN, ..Options::default() }).expect("few DOFs");
    bad.add([(0, 1.0)], 0.0).expect("valid");
    refused("options", || bad.update());
}

#[test]
fn findings_of_another_system_are_not_reported() {
    let (analysis, system) = (analysed(&ring(4)), ring(6));
    let report = || Report::new(&analysis, 0);
    let near = NearDependent { row: usize::MAX, digits: 0, distance: f64::NAN, because: Vec::new() };
    refused("meant", || {
        report().with_near_dependence(&analysis, &NearDependence { rank: 1, equations: vec![near] }, usize::MAX)
    });
    survives("nothing", || report().with_reduction(&Reduction::default(), f64::NAN));
    survives("a form of nothing", || report().with_form(Form::Factored));
    survives("times without end", || report().with_timings(Duration::MAX, Duration::ZERO, Duration::MAX));
    for fill in [0, usize::MAX] {
        survives("fill", || exact::rank(&system, Settings { fill, seed: u64::MAX, ..Reading::Typed.into() })).ok();
    }
}
