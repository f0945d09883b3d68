//! Certificates are right in each DOF's own unit, or say that they are not.

use qless::common::SplitMix64;
use qless::{BackendChoice, CertificateTerm, ConstraintSystem, Kind, Options, SystemBuilder, analyse};

/// Between -1.2 and 1.2, not near zero, times `10^-3..6`.
fn offset(random: &mut SplitMix64) -> f64 {
    let size = 0.2 + (random.next() >> 11) as f64 / (1_u64 << 53) as f64;
    let sign = if random.next().is_multiple_of(2) { 1.0 } else { -1.0 };
    sign * size * 10_f64.powi((random.next() % 10) as i32 - 3)
}

/// Rigid links in a plane, `u_(i+1) = u_i - w_i dy, v_(i+1) = v_i + w_i dx, w_(i+1) = w_i`, closed by a link over all of them.
fn rigid_chain(links: usize, random: &mut SplitMix64) -> ConstraintSystem {
    let mut builder = SystemBuilder::new(3 * (links + 1));
    let mut link = |from: usize, to: usize, [dx, dy]: [f64; 2]| {
        let (i, k) = (3 * from, 3 * to);
        builder.equation([(k, 1.0), (i, -1.0), (i + 2, dy)], 0.0);
        builder.equation([(k + 1, 1.0), (i + 1, -1.0), (i + 2, -dx)], 0.0);
        builder.equation([(k + 2, 1.0), (i + 2, -1.0)], 0.0);
    };
    let mut sum = [0.0; 2];
    for i in 0..links {
        let own = std::array::from_fn(|_| offset(random));
        (0..2).for_each(|k| sum[k] += own[k]);
        link(i, i + 1, own);
    }
    link(0, links, sum);
    builder.build().expect("valid")
}

/// `max_j |row_kj - sum c_i row_ij| / (|row_kj| + sum |c_i row_ij|)`.
fn error_of(system: &ConstraintSystem, row: usize, because: &[CertificateTerm]) -> f64 {
    let mut parts = vec![(0.0, 0.0); system.dofs()];
    let own = CertificateTerm { row, coefficient: -1.0 };
    for term in because.iter().chain([&own]) {
        for (j, v) in system.matrix().row(term.row) {
            parts[j].0 -= term.coefficient * v;
            parts[j].1 += (term.coefficient * v).abs();
        }
    }
    parts.iter().map(|&(left, size): &(f64, f64)| if left == 0.0 { 0.0 } else { left.abs() / size }).fold(0.0, f64::max)
}

#[test]
fn closed_chains_of_very_different_links() {
    let mut random = SplitMix64::new(17);
    let (mut all, mut wrong) = (0, Vec::new());
    for (links, count) in [(2, 20), (5, 20), (20, 20), (40, 20), (100, 10)] {
        for _ in 0..count {
            let chain = rigid_chain(links, &mut random);
            for backend in [BackendChoice::Faer, BackendChoice::Sparse, BackendChoice::Gauss] {
                for presolve in [true, false] {
                    let analysis =
                        analyse(&chain, &Options { backend, presolve, ..Options::default() }).expect("valid");
                    for d in analysis.dependent() {
                        let because = analysis.because(d.row).expect("in range");
                        let said = analysis.because_error(d.row).expect("in range");
                        let error = error_of(&chain, d.row, &because);
                        assert!(
                            error <= 1e-9 || said >= error / 2.0,
                            "{links} {backend:?} {presolve}: {error:e}, said {said:e}"
                        );
                        all += 1;
                        if error > 1e-9 {
                            wrong.push((links, backend, presolve, error));
                        }
                    }
                }
            }
        }
    }
    // Without refinement it is every third.
    assert!(wrong.len() <= all / 20, "{} of {all} above 1e-9: {wrong:?}", wrong.len());
}

/// Kirchhoff's laws with 1e-6 and 1e6 ohm: `-2.2 i_8 = 0` is a combination with coefficients of 2.2 to 2.2e-24, all of which are needed. Each
/// correction finds only the next smaller ones, and the error stays 1 until all are found.
#[test]
fn coefficients_of_all_sizes_are_found() {
    let rows: [&[(usize, f64)]; 10] = [
        &[(2, -1.0), (6, -1e-6)],
        &[(0, -1.0), (3, -1e6)],
        &[(0, 1.0), (7, -1e-6)],
        &[(2, 1.0), (5, -1e6)],
        &[(4, 1.0), (8, -1.0)],
        &[(3, 1.0), (8, 1.0)],
        &[(5, 1.0), (6, -1.0)],
        &[(0, -1.0), (1, 1.0)],
        &[(8, -2.2)],
        &[(4, -1.0), (5, -1.0), (7, -1.0)],
    ];
    let mut builder = SystemBuilder::new(9);
    rows.into_iter().for_each(|row| _ = builder.equation(row.iter().copied(), 0.0));
    let system = builder.build().expect("valid");
    let analysis = analyse(&system, &Options::default()).expect("an analysis");
    let row = analysis.dependent()[0].row;
    let because = analysis.because(row).expect("in range");
    assert!(error_of(&system, row, &because) < 1e-10, "{because:?}");
    assert_eq!(analysis.because_error(row), Ok(0.0));
}

/// `u1 + u3 / 2 = 1e-3`, `u2 + u3 / 2 = 1e12`, in one block without presolve.
#[test]
fn small_constants_stay_beside_large_ones() {
    let mut builder = SystemBuilder::new(3);
    builder.equation([(0, 1.0), (2, 0.5)], 1e-3);
    builder.equation([(1, 1.0), (2, 0.5)], 1e12);
    let system = builder.build().expect("valid");
    for backend in [BackendChoice::Faer, BackendChoice::Sparse, BackendChoice::Gauss] {
        let options = Options { backend, presolve: false, ..Options::default() };
        let reduction = analyse(&system, &options).expect("valid").reduction().expect("independent");
        assert_eq!(reduction.masters(), [2]);
        let u = reduction.expand(&[0.0], &[]).expect("one master");
        assert!((u[0] - 1e-3).abs() <= 1e-12, "{backend:?}: {u:?}");
    }
}

/// `count` equations with whole coefficients, and as many sums of two of them, of which every 500th has a side that is off by one.
fn sums(count: usize) -> ConstraintSystem {
    let mut random = SplitMix64::new(3);
    let mut builder = SystemBuilder::new(count + 8);
    let rows: Vec<[(usize, f64); 3]> = (0..count)
        .map(|i| [0, 1, 7].map(|ahead| (i + ahead, (1 + random.next() % 4) as f64)))
        .inspect(|row| _ = builder.equation(*row, 1.0))
        .collect();
    for k in 0..count {
        let both = rows[k].iter().chain(&rows[(k + 5) % count]);
        builder.equation(both.copied(), if k % 500 == 0 { 3.0 } else { 2.0 });
    }
    builder.build().expect("valid")
}

/// A block with so many certificates that each is computed when it is read: more than four million coefficients.
#[test]
fn certificates_that_are_computed_when_they_are_read() {
    let count = 2_100;
    let system = sums(count);
    for backend in [BackendChoice::Faer, BackendChoice::Sparse] {
        let options = Options { backend, presolve: false, ..Options::default() };
        let analysis = analyse(&system, &options).expect("valid");
        assert_eq!(analysis.rank(), count, "{backend:?}: {:?}", analysis.confidence());
        assert!(analysis.kinds().iter().filter(|&&kind| kind == Kind::Conflicting).count() >= 5);
        for d in analysis.dependent().iter().step_by(20) {
            let because = analysis.because(d.row).expect("in range");
            let (error, said) = (error_of(&system, d.row, &because), analysis.because_error(d.row).expect("in range"));
            assert!(error <= 1e-9 || said >= error / 2.0, "{backend:?}, row {}: {error:e}, said {said:e}", d.row);
            let side: f64 = because.iter().map(|term| term.coefficient * system.rhs()[term.row]).sum();
            let is_missed = (side - system.rhs()[d.row]).abs() > 1e-6;
            assert_eq!(analysis.kinds()[d.row] == Kind::Conflicting, is_missed, "{backend:?}, row {}", d.row);
        }
    }
}
