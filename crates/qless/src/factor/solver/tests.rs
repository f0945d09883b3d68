use super::*;
use crate::common::random::randoms;
use crate::factor::lu;

/// 60 equations of a band with loops, and 20 sparse right-hand sides.
fn drawn(seed: u64) -> (SlaveSolver, Csr) {
    let mut random = randoms(seed);
    let mut next = move || random.next().expect("endless") - 1.0;
    let mut equations = Csr::empty(75);
    for i in 0..60_usize {
        let dofs = (i..i + 15).filter(|&j| j == i || next() > 0.25).collect::<Vec<_>>();
        equations.append(dofs.into_iter().map(|j| (j, if j == i { 3.0 } else { next() })).collect::<Vec<_>>());
    }
    let mut right = Csr::empty(60);
    for _ in 0..20 {
        let sides = (0..60).filter(|_| next() > 0.4).collect::<Vec<_>>();
        right.append(sides.into_iter().map(|i| (i, next())).collect::<Vec<_>>());
    }
    let lu = lu::factor(&equations, &(0..60).collect::<Vec<_>>(), |_| true, usize::MAX).expect("independent");
    (SlaveSolver::new(&equations, lu), right)
}

/// Solutions of one right-hand side after the other are those of dense right-hand sides, and in other units they have the same digits.
#[test]
fn sparse_solutions_are_those_of_dense_sides_in_any_unit() {
    for seed in 0..20 {
        let (solver, right) = drawn(seed);
        let solved = solver.solve(&right);
        for k in 0..right.rows() {
            let mut dense = vec![0.0; 60];
            right.row(k).for_each(|(i, v)| dense[i] = v);
            let truth = solver.solve_dense(&dense);
            let mut off = truth.clone();
            solved.row(k).for_each(|(j, v)| off[j] -= v);
            let size = |x: &[f64]| x.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            assert!(size(&off) <= 1e-14 * size(&truth), "seed {seed}, side {k}: off by {:e}", size(&off));
        }
        for unit in [2_f64.powi(-200), 2_f64.powi(200)] {
            let scaled = Csr { val: right.val.iter().map(|v| unit * v).collect(), ..right.clone() };
            let other = solver.solve(&scaled);
            assert_eq!((&other.start, &other.col), (&solved.start, &solved.col), "seed {seed}, unit {unit:e}");
            assert!(other.val.iter().zip(&solved.val).all(|(a, b)| *a == unit * b), "seed {seed}, unit {unit:e}");
        }
    }
}
