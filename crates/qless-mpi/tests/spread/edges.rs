//! Systems in which what is solved apart, or what stands beside, could change what the serial library decides.

use crate::common::{Partition, difference, serial, spread};
use qless::{ConstraintSystem, Options, SystemBuilder};
use qless_mpi::{Ranks, Share, analyse, on_threads};

fn same(system: &ConstraintSystem, options: &Options) {
    let found = spread(system, options, 2, Partition::Blocks);
    assert_eq!(difference(&found, &serial(system, options)), "");
}

/// 3,000 DOFs that follow one, and their sum with a DOF of its own: the serial analysis does not rely on a row that moves so much.
#[test]
fn a_row_that_moves_much_is_not_solved_apart() {
    let count = 3000;
    let mut builder = SystemBuilder::new(count + 2);
    for i in 1..=count {
        builder.equation([(i, 1.0), (0, -1.0)], 0.0);
    }
    let sum = (0..count).map(|i| (i + 1, 0.9 - 1e-4 * (i % 7) as f64));
    builder.equation(sum.chain([(count + 1, 1.0)]), 0.0);
    builder.equation([(1, 1.0), (2, -1.0)], 0.0);
    same(&builder.build().expect("valid"), &Options { growth: 1e6, ..Options::default() });
}

/// `2^-30` in the second equation is 2^-50 beside the third, whose numbers are larger. Nobody looks for rounding among the equations of
/// the first rank; those of the second one are no reason to.
#[test]
fn rounding_in_one_component_says_nothing_of_others() {
    let (small, tiny, large) = (2f64.powi(-30), 2f64.powi(-50), 2f64.powi(40));
    let mut builder = SystemBuilder::new(8);
    builder.equation([(0, 1.0), (1, 1.0)], 0.0);
    builder.equation([(0, 1.0), (1, 1.0), (2, small)], 0.0);
    builder.equation([(2, large), (3, large)], 0.0);
    builder.equation([(4, 1.0), (5, tiny)], 0.0);
    builder.equation([(6, 1.0), (5, 1.0)], 0.0);
    same(&builder.build().expect("valid"), &Options::default());
}

#[test]
fn memory_goes_with_the_equations_and_not_with_the_range_owned() {
    let last = (1 << 40) - 1;
    let slaves = on_threads(2, |ranks: &dyn Ranks| {
        let mut share = Share::new(if ranks.rank() == 0 { 0..4 } else { 4..last + 1 });
        if ranks.rank() == 0 {
            share.equation(0, [(1, 1.0), (last, -2.0)], 3.0);
        }
        analyse(ranks, &share, &Options::default()).expect("valid").slaves().to_vec()
    });
    assert_eq!(slaves, [vec![], vec![last]]);
}
