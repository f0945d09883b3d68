//! Distributes a system to ranks and collects the results.

use std::collections::BTreeMap;

use qless::{ConstraintSystem, Options};
use qless_mpi::{Analysis, DistributedCertificateTerm, Error, Ranks, Share, Term, analyse, on_threads};
use qless_scenes::Rng;

/// Who holds which equation.
#[derive(Clone, Copy, Debug)]
pub enum Partition {
    /// One after the other, as many for each.
    Blocks,
    /// By chance.
    Scattered(u64),
}

/// The share of a rank.
pub fn share(system: &ConstraintSystem, ranks: &dyn Ranks, partition: Partition) -> Share {
    let (m, n, size, rank) = (system.equations(), system.dofs(), ranks.size(), ranks.rank());
    let cut = |k: usize| (n * k / size) as u64;
    let mut share = Share::new(cut(rank)..cut(rank + 1));
    let mut rng = match partition {
        Partition::Blocks => Rng::new(0),
        Partition::Scattered(seed) => Rng::new(seed),
    };
    let mut mine = Vec::new();
    for i in 0..m {
        let holder = match partition {
            Partition::Blocks => i * size / m,
            Partition::Scattered(_) => rng.below(size),
        };
        if holder == rank {
            mine.push(i);
        }
    }
    if matches!(partition, Partition::Scattered(_)) {
        rng.shuffle(&mut mine);
    }
    for i in mine {
        let terms = system.matrix().row(i).map(|(j, value)| (j as u64, value));
        share.equation(i as u64, terms, system.rhs()[i]);
        share.need((i * 7 % n) as u64);
    }
    for &(dof, value) in system.prescribed() {
        if rng.below(size) == rank || dof % size == rank {
            share.prescribe(dof as u64, value);
        }
    }
    share
}

/// Whether it conflicts; mismatches and what was dropped as bits; certificate.
pub type Verdict = (bool, [u64; 3], Vec<(u64, u64)>);
/// Terms of a row of T and G (DOF, bits, whether it is prescribed), and g.
pub type Line = (Vec<(u64, u64, bool)>, u64);

/// What is known of the whole.
#[derive(Debug, Default, PartialEq)]
pub struct Whole {
    /// By equation.
    pub dependent: BTreeMap<usize, Verdict>,
    /// By slave.
    pub rows: BTreeMap<u64, Line>,
    /// Fixed DOFs.
    pub generated: Vec<(u64, u64)>,
    pub ambiguous: bool,
}

/// Minus zero is zero.
fn bits(x: f64) -> u64 {
    (x + 0.0).to_bits()
}

/// By the serial library.
pub fn serial(system: &ConstraintSystem, options: &Options) -> Result<Whole, String> {
    let analysis = qless::analyse(system, options).map_err(|error| error.to_string())?;
    let reduction = analysis.reduction().map_err(|error| error.to_string())?;
    let mut whole = Whole { ambiguous: analysis.confidence().ambiguous, ..Whole::default() };
    for d in analysis.dependent() {
        let because = analysis.because(d.row).expect("a row");
        let because = because.iter().map(|b| (b.row as u64, bits(b.coefficient))).collect();
        let numbers = [d.mismatch, d.relative_mismatch, d.dropped].map(bits);
        whole.dependent.insert(d.row, (d.kind == qless::Kind::Conflicting, numbers, because));
    }
    for (i, &slave) in reduction.slaves().iter().enumerate() {
        let of_masters = reduction.t().row(i).map(|(q, v)| (reduction.masters()[q] as u64, bits(v), false));
        let of_given = reduction.g_matrix().row(i).map(|(p, v)| (reduction.prescribed()[p] as u64, bits(v), true));
        let mut terms: Vec<_> = of_masters.chain(of_given).collect();
        terms.sort_unstable();
        whole.rows.insert(slave as u64, (terms, bits(reduction.g()[i])));
    }
    whole.generated = analysis.generated().iter().map(|&(j, v)| (j as u64, bits(v))).collect();
    Ok(whole)
}

/// By that many ranks.
pub fn spread(
    system: &ConstraintSystem,
    options: &Options,
    size: usize,
    partition: Partition,
) -> Result<Whole, String> {
    let found = on_threads(size, |ranks| {
        let share = share(system, ranks, partition);
        let analysis: Result<Analysis, Error> = analyse(ranks, &share, options);
        (share.numbers().to_vec(), analysis)
    });
    let mut whole = Whole::default();
    let texts: Vec<Option<String>> = found.iter().map(|(_, a)| a.as_ref().err().map(ToString::to_string)).collect();
    assert!(texts.iter().all(|text| *text == texts[0]), "ranks disagree: {texts:?}");
    let confidences: Vec<_> = found.iter().filter_map(|(_, a)| a.as_ref().ok()).map(Analysis::confidence).collect();
    assert!(confidences.iter().all(|c| *c == confidences[0]), "ranks disagree: {confidences:?}");
    let mut needed: BTreeMap<u64, Line> = BTreeMap::new();
    for (numbers, analysis) in found {
        let analysis = analysis.map_err(|error| error.to_string())?;
        whole.ambiguous = analysis.confidence().ambiguous;
        for d in analysis.dependent() {
            assert_eq!(analysis.kinds()[d.equation], d.kind);
            let because = d
                .because
                .iter()
                .map(|&DistributedCertificateTerm { equation, coefficient, .. }| (equation, bits(coefficient)));
            let of = (
                d.kind == qless::Kind::Conflicting,
                [d.mismatch, d.relative_mismatch, d.dropped].map(bits),
                because.collect(),
            );
            whole.dependent.insert(numbers[d.equation] as usize, of);
        }
        let row = |dof: u64| {
            let (terms, g) = analysis.row(dof)?;
            let term = |t: &Term| (t.dof, bits(t.value), t.prescribed);
            Some((terms.iter().map(term).collect::<Vec<_>>(), bits(g)))
        };
        whole.rows.extend(analysis.slaves().iter().map(|&s| (s, row(s).expect("a slave"))));
        needed.extend((0..system.dofs() as u64).filter_map(|dof| Some((dof, row(dof)?))));
        whole.generated.extend(analysis.generated().iter().map(|&(j, v)| (j, bits(v))));
    }
    for (dof, row) in needed {
        assert_eq!(whole.rows.get(&dof), Some(&row), "the row of DOF {dof} as a rank that needs it has it");
    }
    Ok(whole)
}

/// What differs, in words; empty if nothing does.
pub fn difference(ours: &Result<Whole, String>, theirs: &Result<Whole, String>) -> String {
    match (ours, theirs) {
        (Ok(a), Ok(b)) if a == b => String::new(),
        (Ok(a), Ok(b)) => {
            let part = |name: &str, same: bool| if same { String::new() } else { format!("{name} ") };
            let kinds = |w: &Whole| w.dependent.iter().map(|(i, d)| (*i, d.0)).collect::<Vec<_>>();
            let slaves = |w: &Whole| w.rows.keys().copied().collect::<Vec<_>>();
            let first = a.rows.iter().zip(&b.rows).find(|(x, y)| x != y);
            part("verdicts", kinds(a) == kinds(b))
                + &part("certificates", a.dependent == b.dependent)
                + &part("slaves", slaves(a) == slaves(b))
                + &first.map_or(String::new(), |pair| format!("rows: {pair:?} "))
                + &part("generated", a.generated == b.generated)
                + &part("doubt", a.ambiguous == b.ambiguous)
        }
        // Numbers of equations in texts are those of the rank's own system.
        (Err(_), Err(_)) => String::new(),
        (a, b) => format!("{:?} against {:?}", a.as_ref().err(), b.as_ref().err()),
    }
}
