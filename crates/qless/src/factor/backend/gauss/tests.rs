use super::*;
use crate::factor::backend::check;

const GAUSS: Gauss = Gauss { memory: usize::MAX };

#[test]
fn identities_hold_on_the_test_families() {
    check::families(&GAUSS);
}

#[test]
fn the_largest_entry_of_each_row_is_the_pivot() {
    let columns = check::from_dense(&[vec![1.0, -1.0, 2.0], vec![1.0, 2.0, -1.0], vec![2.0, 1.0, 1.0]]);
    let factor = GAUSS.factor(&columns, &[1.0, 0.0, 1.0], 1e-5).expect("small");
    // (12) gives up u3, its largest; (13) + (12) / 2 = 1.5 u1 + 1.5 u2 = 0.5 gives up u1; (14) vanishes.
    assert_eq!((factor.rank, factor.order.as_slice()), (2, [2, 0, 1].as_slice()));
    assert_eq!(factor.r.row(1).collect::<Vec<_>>(), [(1, 1.5), (2, 1.5)]);
    assert_eq!((factor.rhs.as_slice(), factor.rest[0]), ([1.0, 0.5].as_slice(), 0.0));
}

#[test]
fn a_conflict_stays_on_the_right_hand_side() {
    let columns = check::from_dense(&[vec![1.0, -1.0, 2.0], vec![1.0, 2.0, -1.0], vec![2.0, 1.0, 1.0]]);
    assert_eq!(GAUSS.factor(&columns, &[1.0, 0.0, 0.0], 1e-5).expect("small").rest, [1.0]);
}
