//! Large right-hand sides hide no conflict, and a tolerance that the caller states settles doubts.

use std::sync::Arc;

use qless::change::Refresher;
use qless::common::SplitMix64;
use qless::{Analysis, ConstraintSystem, Doubt, Effort, Kind, Noise, Options, SystemBuilder, Tolerance, analyse};

/// Coefficients of all DOFs, and the right-hand side.
type Row = (Vec<f64>, f64);

fn system(rows: &[Row]) -> ConstraintSystem {
    let mut builder = SystemBuilder::new(rows[0].0.len());
    for (coefficients, b) in rows {
        builder.equation(coefficients.iter().copied().enumerate().filter(|(_, v)| *v != 0.0), *b);
    }
    builder.build().expect("valid")
}

fn analysed(rows: &[Row]) -> Analysis {
    analyse(&system(rows), &Options::default()).expect("small")
}

fn conflicts(analysis: &Analysis) -> usize {
    analysis.kinds().iter().filter(|&&kind| kind == Kind::Conflicting).count()
}

/// All orders of a list.
fn orders<T: Clone>(list: &[T]) -> Vec<Vec<T>> {
    if list.len() < 2 {
        return vec![list.to_vec()];
    }
    let mut all = Vec::new();
    for k in 0..list.len() {
        let mut others = list.to_vec();
        let first = others.remove(k);
        all.extend(orders(&others).into_iter().map(|rest| [vec![first.clone()], rest].concat()));
    }
    all
}

/// The third row is a combination of the first two, and its side is off or not; the fourth row has a side of 1e9 to 1e20 and is in no
/// certificate. Small whole numbers, so that all sums are exact.
#[test]
fn a_side_that_no_certificate_has_hides_no_conflict() {
    let (mut wrong, mut alarms) = (Vec::new(), 0);
    for seed in 0..2_000 {
        let mut random = SplitMix64::new(seed);
        let mut whole = |most: u64| (random.next() % (2 * most + 1)) as f64 - most as f64;
        let (a, c, off) = (whole(3), whole(3), whole(2) / 2.0);
        let (b1, b2) = (whole(9), whole(9));
        let mut row = || (0..4).map(|_| whole(4)).collect::<Vec<f64>>();
        let (first, second, large) = (row(), row(), row());
        let third = first.iter().zip(&second).map(|(x, y)| a * x + c * y).collect();
        let side = a * b1 + c * b2 + off;
        let size = 10_f64.powi(9 + (seed % 12) as i32);
        let mut rows = vec![(first, b1), (second, b2), (third, side), (large, size)];
        let independent = [rows[0].clone(), rows[1].clone(), rows[3].clone()];
        if analysed(&independent).rank() < 3 {
            continue;
        }
        rows.rotate_left(seed as usize % 4);
        let analysis = analysed(&rows);
        let is_sure = !analysis.confidence().ambiguous;
        if is_sure && conflicts(&analysis) != usize::from(off != 0.0) {
            wrong.push((seed, off, size));
        }
        alarms += usize::from(off == 0.0 && !is_sure);
    }
    assert!(wrong.is_empty() && alarms < 20, "{alarms} alarms, {} wrong: {:?}", wrong.len(), wrong.first());
}

/// `u1 = B; u1 + u2 = B; u2 = 1; u2 = 2`: the last two contradict each other, which is said or in doubt whatever B hides.
#[test]
fn two_values_of_one_dof_conflict_in_every_order() {
    for size in [1e12, 1e13, 1e14, 1e15, 1e16, 1e20, 1e30] {
        let rows = [(vec![1.0, 0.0], size), (vec![1.0, 1.0], size), (vec![0.0, 1.0], 1.0), (vec![0.0, 1.0], 2.0)];
        for order in orders(&rows) {
            let analysis = analysed(&order);
            let is_said = conflicts(&analysis) == 1 || analysis.confidence().ambiguous;
            assert!(analysis.rank() == 2 && is_said, "{size:e}: {order:?}");
        }
    }
}

/// One conflict makes the part unsolvable; the second row contradicts the first too, but only in its 13th digit.
#[test]
fn exact_arithmetic_examines_what_is_beside_a_conflict() {
    let row = |b: f64| (vec![1.0, -1.0], b);
    let options = Options { effort: Effort::Exact, ..Options::default() };
    let analysis = analyse(&system(&[row(1.0), row(1.000_000_000_000_9), row(2.0)]), &options).expect("small");
    assert_eq!((conflicts(&analysis), analysis.confidence().doubt), (1, Some(Doubt::Exact)));
    let same = analyse(&system(&[row(1.0), row(1.0), row(2.0)]), &options).expect("small");
    assert_eq!((conflicts(&same), same.confidence().doubt), (1, None));
}

/// Two rows that differ by `e` in one coefficient: one equation for a tolerance above e, two for one below, and in doubt for neither.
#[test]
fn a_stated_tolerance_decides_without_doubt() {
    for digits in 5..11 {
        let e = 10_f64.powi(-digits);
        let rows = [(vec![1.0, 1.0, 0.0], 0.0), (vec![1.0, 1.0 + e, 0.0], 0.0), (vec![0.0, 1.0, 1.0], 1.0)];
        for (tolerance, rank) in [(20.0 * e, 2), (e / 20.0, 3)] {
            let options = Options { tolerance: Tolerance::Relative(tolerance), ..Options::default() };
            let analysis = analyse(&system(&rows), &options).expect("small");
            assert_eq!((analysis.rank(), analysis.confidence().doubt), (rank, None), "{e:e} {tolerance:e}");
        }
    }
}

/// `u1 - u2 = 1; u1 - u2 = 1.000001`: errors of the sides above the difference, as the caller states them, leave no doubt.
#[test]
fn stated_errors_of_sides_decide_without_doubt() {
    let rows = [(vec![1.0, -1.0], 1.0), (vec![1.0, -1.0], 1.000_001)];
    for noise in [Noise::Floors { coefficients: vec![0.0; 2], rhs: vec![1e-5; 2] }, Noise::Relative(1e-5)] {
        let options = Options { noise, ..Options::default() };
        let analysis = analyse(&system(&rows), &options).expect("small");
        assert_eq!((analysis.rank(), conflicts(&analysis), analysis.confidence().doubt), (1, 0, None), "{options:?}");
    }
}

/// `p u = 1; q u = d - 1; (p + q) u = 0; r u = L` with d = 0 or 1, and a component beside it whose solution needs more corrections. Whole
/// numbers, so that d is exact. Beside `L = 1e15` rounded coefficients may hide d, and it counts as rounding.
#[test]
fn a_conflict_without_a_side_of_its_own_does_not_depend_on_other_components() {
    let [mut systems, mut doubts] = [0; 2];
    for seed in 0..2_000 {
        let mut random = SplitMix64::new(seed);
        let mut number = |most: u64| (random.next() % most) as f64;
        let off = (seed % 2) as f64;
        // Solutions of rows of zeros and ones are exact after one correction, or two.
        let most = [1, 4][seed as usize / 2 % 2];
        let mut row = || -> Vec<f64> { (0..4).map(|_| number(1 + 2 * most) - most as f64).collect() };
        let (p, q, r) = (row(), row(), row());
        let sum: Vec<f64> = p.iter().zip(&q).map(|(p, q)| p + q).collect();
        let mut alone =
            vec![(p, 1.0), (q, off - 1.0), (sum, 0.0), (r, 10_f64.powi((seed % 15) as i32) * (1.0 + number(4)))];
        alone.rotate_left(seed as usize % 4);
        if analysed(&alone).rank() < 3 {
            continue;
        }
        let beside: Vec<Row> = (0..3).map(|_| ((0..4).map(|_| number(1 << 50)).collect(), number(1 << 50))).collect();
        let twice = beside[0].0.iter().zip(&beside[1].0).map(|(a, b)| a + b).collect();
        let beside = beside.iter().cloned().chain([(twice, beside[0].1 + beside[1].1)]);
        let first = alone.iter().map(|(row, b)| ([row.as_slice(), &[0.0; 4]].concat(), *b));
        let both: Vec<Row> = first.chain(beside.map(|(row, b)| ([vec![0.0; 4], row].concat(), b))).collect();
        let (alone, both) = (analysed(&alone), analysed(&both));
        assert_eq!(alone.kinds(), &both.kinds()[..4], "{seed}");
        let is_right = conflicts(&alone) == seed as usize % 2;
        let is_doubted = alone.confidence().doubt.is_some();
        assert!(is_right || (is_doubted && off > 0.0), "{seed}: {:?}", alone.kinds());
        (systems, doubts) = (systems + 1, doubts + usize::from(is_doubted));
    }
    println!("{systems} systems, {doubts} in doubt");
    assert!(systems > 1_500 && doubts * 20 < systems, "{systems} systems, {doubts} in doubt");
}

/// `a u + e u_f = b; a u = b'` with a tiny e fixes u_f to `(b - b') / e`, which is exact here. Doubles lose all of its digits if the other
/// DOFs are rounded first.
#[test]
fn a_dof_that_a_tiny_coefficient_fixes_has_its_value() {
    for seed in 0..1_000 {
        let mut random = SplitMix64::new(seed);
        let mut real = || (random.next() >> 11) as f64 / (1_u64 << 53) as f64 + 0.5;
        let row: Vec<f64> = (0..4).map(|_| real()).collect();
        let (b, tiny, value) =
            (real(), 2_f64.powi(-20 - (seed % 60) as i32), (seed % 3) as f64 * 2_f64.powi((seed % 60) as i32 - 20));
        let mut first = [row.clone(), vec![tiny]].concat();
        let mut second = [row, vec![0.0]].concat();
        first.rotate_left(seed as usize % 5);
        second.rotate_left(seed as usize % 5);
        let place = (4 + 5 - seed as usize % 5) % 5;
        let analysis = analysed(&[(first, b + tiny * value), (second, b)]);
        let found = analysis.generated();
        assert!(matches!(found, [(dof, _)] if *dof == place), "{seed}: {found:?}");
        let exact = ((b + tiny * value) - b) / tiny;
        // Sums of two doubles have 32 digits, and the sides are of size 1.
        let limit = (1e-12 * exact.abs()).max(1e-30 / tiny);
        assert!((found[0].1 - exact).abs() <= limit, "{seed}: {found:?}, but {exact:e} is right");
        let mut reduction = analysis.reduction().expect("small");
        let refresher = Refresher::new(Arc::new(analysis)).expect("small");
        let refreshed = refresher.refresh(&[b + tiny * value, b], &[], &mut reduction).expect("valid").generated;
        assert!((refreshed[0].1 - exact).abs() <= limit, "{seed}: {refreshed:?}, but {exact:e} is right");
    }
}
