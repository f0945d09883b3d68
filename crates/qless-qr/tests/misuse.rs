//! Any input gives an answer or an error: invalid arrays, numbers near the limits of doubles, memory limits.

mod common;

use common::{Matrix, Random};
use qless_qr::{Error, Matrix as View, Options, Tolerance, least_squares, minimum_norm, solve};

const EXTREME: [f64; 10] = [0.0, 1.0, -1.0, 3.0, f64::MAX, -1e300, 5e-324, 1e-300, f64::NAN, f64::INFINITY];

fn number(random: &mut Random, kinds: usize) -> f64 {
    EXTREME[random.below(kinds)]
}

fn options(random: &mut Random) -> Options {
    let tolerance = [
        Tolerance::Relative,
        Tolerance::Scaled(0.5),
        Tolerance::Scaled(f64::MAX),
        Tolerance::Scaled(-1.0),
        Tolerance::Absolute(0.0),
        Tolerance::Absolute(f64::INFINITY),
        Tolerance::Absolute(f64::NAN),
    ][random.below(7)];
    let memory = [usize::MAX, usize::MAX, 1 << 16, 0][random.below(4)];
    Options::new().tolerance(tolerance).memory(memory).keep_q(random.below(2) == 0).refinements(random.below(3))
}

/// Calls all functions, with right-hand sides that may have wrong lengths.
fn use_it(a: &View<i32, i32>, random: &mut Random) -> usize {
    let kinds = [8, 10][random.below(2)];
    let length = [a.rows(), 2 * a.rows(), a.cols(), 1, 0][random.below(5)];
    let b: Vec<f64> = (0..length).map(|_| number(random, kinds)).collect();
    let mut answers = 0;
    for way in [least_squares, minimum_norm, solve] {
        if let Ok(solution) = way(a, &b, options(random)) {
            assert!(solution.x.iter().all(|x| x.is_finite()), "an answer that is none");
            answers += 1;
        }
    }
    let symbolic = a.analyse().expect("few entries");
    let Ok(factor) = symbolic.factor(a.values(), &b, options(random)) else { return answers };
    let mut vectors = b.clone();
    let (applied, back) = (factor.apply_q(&mut vectors), factor.apply_q_transposed(&mut vectors));
    assert_eq!(applied, back);
    assert!(factor.condition() >= 0.0 && factor.smallest_singular_value() >= 0.0);
    let solved = [factor.basic(), factor.solve(&b), factor.solve_transposed(&b), factor.solve_seminormal(a, &b, 1)];
    if let Ok(complete) = factor.complete(1 << 20) {
        let short = [complete.minimum_norm(), complete.solve(&b), complete.solve_transposed(&b)];
        answers += short.into_iter().flatten().filter(|x| x.iter().all(|x| x.is_finite())).count();
    }
    std::hint::black_box((symbolic.flops(), factor.rest().len(), factor.dropped()));
    let turned = a.transposed();
    assert_eq!((turned.rows(), turned.cols(), turned.transposed().rows()), (a.cols(), a.rows(), a.rows()));
    assert_eq!(turned.analyse().expect("few entries").order().len(), a.rows());
    let mut x = vec![1.0; a.cols()];
    if factor.refine(a, &b, &mut x, 2).is_err() {
        assert!(x.iter().all(|&x| x == 1.0), "changed in spite of an error");
    }
    assert_eq!(factor.into_parts().order.len(), a.cols());
    answers + solved.into_iter().flatten().count()
}

#[test]
fn nothing_makes_it_panic() {
    let (mut matrices, mut answers) = (0, 0);
    for seed in 0..6000 {
        let mut random = Random::new(seed + 31);
        let (rows, cols, kinds) = (random.below(5), random.below(5), [8, 8, 10][random.below(3)]);
        let mut start = vec![0_i32];
        (0..cols).for_each(|j| start.push(start[j] + random.below(4) as i32));
        let entries = usize::try_from(start[cols]).expect("ascending");
        let mut index: Vec<i32> = (0..entries).map(|_| random.below(rows) as i32).collect();
        let values: Vec<f64> = (0..entries).map(|_| number(&mut random, kinds)).collect();
        match random.below(12) {
            0 => start[random.below(cols + 1)] = random.below(9) as i32 - 2,
            1 if entries > 0 => index[random.below(entries)] = [-1, 5, i32::MAX][random.below(3)],
            2 => start.push(0),
            _ => {}
        }
        for view in
            [View::by_columns(rows, cols, &start, &index, &values), View::by_rows(cols, rows, &start, &index, &values)]
                .into_iter()
                .flatten()
        {
            matrices += 1;
            answers += use_it(&view, &mut random);
        }
    }
    assert!(matrices > 4000 && answers > 4000, "{matrices} matrices, {answers} answers");
}

#[test]
fn q_counts_within_the_limit() {
    for seed in 0..50 {
        let mut random = Random::new(seed);
        let a = Matrix::random(&mut random, 60, 40, 150);
        let symbolic = a.analyse();
        let needed = symbolic.memory(0) + symbolic.memory_of_q();
        let with = |memory| symbolic.factor(&a.values, &[], Options::new().keep_q(true).memory(memory));
        assert_eq!(with(needed - 1).err(), Some(Error::OutOfMemory { needed, limit: needed - 1 }));
        assert!(with(needed).is_ok(), "seed {seed}");
    }
}
