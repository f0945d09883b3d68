//! Connected parts: equations that share free DOFs, directly or through others.

use crate::Csr;

/// For each equation the number of its part; parts are counted in the order of their first equations.
///
/// Every equation without a free DOF is a part of its own. In O(coefficients), but for a factor that is 4 in practice.
pub(super) fn parts(matrix: &Csr, free: &[bool]) -> Vec<u32> {
    const NONE: u32 = u32::MAX;
    let mut first_with = vec![NONE; matrix.cols];
    let mut above: Vec<u32> = (0..matrix.rows() as u32).collect();
    for i in 0..matrix.rows() {
        for (j, _) in matrix.row(i).filter(|&(j, _)| free[j]) {
            match first_with[j] {
                NONE => first_with[j] = i as u32,
                other => join(&mut above, i as u32, other),
            }
        }
    }
    number(&mut above);
    above
}

/// The first equation of the part, with the way there shortened by half.
fn top(above: &mut [u32], mut row: u32) -> u32 {
    while above[row as usize] != row {
        let next = above[above[row as usize] as usize];
        above[row as usize] = next;
        row = next;
    }
    row
}

fn join(above: &mut [u32], a: u32, b: u32) {
    let (a, b) = (top(above, a), top(above, b));
    above[a.max(b) as usize] = a.min(b);
}

/// Replaces what leads to the first equation of each part by the part's number.
fn number(above: &mut [u32]) {
    let mut count = 0;
    for row in 0..above.len() {
        let first = above[row] as usize;
        // What leads upwards leads to a smaller row, which has its number already.
        above[row] = if first == row { count } else { above[first] };
        count += u32::from(first == row);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_joined_by_free_dofs_only() {
        let mut matrix = Csr::empty(8);
        let rows: [&[usize]; 6] = [&[0, 1], &[4, 5], &[3], &[1, 3, 6], &[3, 7], &[5, 6]];
        rows.iter().for_each(|row| matrix.append(row.iter().map(|&j| (j, 1.0))));
        let mut free = [true; 8];
        free[3] = false;
        assert_eq!(parts(&matrix, &free), [0, 0, 1, 0, 2, 0]);
        free[6] = false;
        assert_eq!(parts(&matrix, &free), [0, 1, 2, 0, 3, 1]);
    }
}
