//! Which rows of an array belong to which segment, and what has to be replaced when segments change.

use std::collections::HashMap;
use std::ops::Range;

use qless::common::Identity;

/// The stamp of each segment and how many rows it has, in their order.
pub(super) type Layout = Vec<(Identity, usize)>;

/// Ranges of rows of the old layout, and the segments of the new one that take their place.
///
/// Segments that are in both have the same order in both.
pub(super) fn differences(old: &[(Identity, usize)], new: &[(Identity, usize)]) -> Vec<(Range<usize>, Range<usize>)> {
    let places: HashMap<Identity, usize> = new.iter().enumerate().map(|(place, segment)| (segment.0, place)).collect();
    let (mut all, mut row, mut gone, mut next) = (Vec::new(), 0, 0, 0);
    for &(stamp, rows) in old {
        if let Some(&place) = places.get(&stamp) {
            if gone < row || next < place {
                all.push((gone..row, next..place));
            }
            (gone, next) = (row + rows, place + 1);
        }
        row += rows;
    }
    if gone < row || next < new.len() {
        all.push((gone..row, next..new.len()));
    }
    all
}
