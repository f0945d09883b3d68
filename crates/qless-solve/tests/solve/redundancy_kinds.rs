//! Random nets of rods and arms, solved from far away: the redundancies that Newton's method reports agree with the singular values.

use faer::Mat;
use qless_constraints::types::{Distance, OnSphere, PlanarPoint};
use qless_constraints::{ConstraintSet, Evaluation};
use qless_solve::newton::{self, NewtonOptions};

use crate::linkages::Outcome;
use crate::right_or_refused::Random;

const NETS: usize = 4_000;

/// Rods between points of the plane and arms to fixed points, some of them duplicate, which one configuration satisfies; and a start away
/// from it.
struct Net {
    set: ConstraintSet,
    prescribed: Vec<(usize, f64)>,
    start: Vec<f64>,
}

impl Net {
    fn new(seed: usize) -> Outcome<Self> {
        let mut random = Random::new(seed + 17);
        let (points, unit) = (2 + random.below(5), [1e-6, 1.0, 1e6][random.below(3)]);
        let away = unit * [0.1, 0.5, 2.0][random.below(3)];
        let mut place = || [0, 1].map(|_| unit * random.between(-1.0, 1.0));
        let (places, fixed) = ([(); 6].map(|()| place()), [(); 3].map(|()| place()));
        let point = |k: usize| PlanarPoint::new([2 * k, 2 * k + 1], places[k]);
        let mut builder = ConstraintSet::builder(2 * points);
        for _ in 0..=random.below(2 * points + 2) {
            let (a, b) = (random.below(points), random.below(points + 1));
            if b == points {
                let centre = fixed[random.below(3)];
                builder.add("arm", OnSphere { point: point(a), centre, radius: None })?;
            } else if a != b {
                builder.add("rod", Distance::new(point(a), point(b)))?;
            }
        }
        let prescribed = (0..2 * points).filter(|_| random.below(10) == 0).map(|j| (j, 0.0)).collect();
        let start = (0..2 * points).map(|_| away * random.between(-1.0, 1.0)).collect();
        Ok(Self { set: builder.build()?, prescribed, start })
    }

    /// G of the free DOFs; c is a length.
    fn singular_values(&self, evaluation: &Evaluation) -> Vec<f64> {
        let g = evaluation.g();
        let mut dense = Mat::zeros(g.rows(), g.cols());
        (0..g.rows()).for_each(|i| g.row(i).for_each(|(j, v)| dense[(i, j)] = v));
        self.prescribed.iter().for_each(|&(j, _)| dense.col_mut(j).fill(0.0));
        if g.rows() == 0 { Vec::new() } else { dense.singular_values().unwrap_or_default() }
    }
}

/// If the singular values have a clear gap, they confirm the number of redundant rods. All rods hold, and most starts converge.
#[test]
fn redundant_rods_of_nets_are_those_that_singular_values_show() -> Outcome {
    let (mut clear, mut found) = (0, 0);
    for seed in 0..NETS {
        let net = Net::new(seed)?;
        let Ok(solution) = newton::solve(&net.set, &net.start, &net.prescribed, &NewtonOptions::default()) else {
            continue;
        };
        found += 1;
        let mut evaluation = net.set.allocate();
        net.set.evaluate(&solution.u, &mut evaluation)?;
        let values = net.singular_values(&evaluation);
        if values.iter().all(|value| *value > 1e-5 || *value < 1e-12) {
            clear += 1;
            let rank = values.iter().filter(|value| **value > 1e-5).count();
            let redundant = net.set.equations() - rank;
            assert_eq!(solution.redundant.len(), redundant, "seed {seed}: {:?} of {values:?}", solution.redundant);
        }
    }
    assert!(found > NETS * 9 / 10 && clear > found * 9 / 10, "{clear} clear of {found} found");
    Ok(())
}
