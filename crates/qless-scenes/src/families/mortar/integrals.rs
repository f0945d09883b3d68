//! Integrals `A_ij = int phi_i psi_j dx` over `[0, 1]`, exact except for rounding, in time linear in the number of nodes.
//!
//! Between neighbouring ends of elements of both meshes a product has degree 4 at most; three-point Gauss quadrature has degree 5.

use super::side::Side;

/// Band matrix: row i holds its pairs `(column, integral)`, columns ascending.
pub(super) type Band = Vec<Vec<(usize, f64)>>;

/// Ends of elements that are closer than this coincide: their positions differ by rounding only.
const SAME: f64 = 4.0 * f64::EPSILON;
/// An integral below this fraction of the sum of its absolute parts is zero in real arithmetic, such as that of `(1 - t) t (2 t - 1)`.
const ZERO: f64 = 1e-14;

/// An integral: the sum of its parts over intervals, and the sum of the absolute values of the parts.
struct IntegralsEntry {
    column: usize,
    sum: f64,
    size: f64,
}

/// Integrals of the products of the functions of two meshes. Rows belong to the first mesh, columns to the second.
pub(super) fn products(rows: &Side, columns: &Side) -> Band {
    let nodes = rows.degree as usize * rows.elements() + 1;
    let mut sums: Vec<Vec<IntegralsEntry>> = (0..nodes).map(|_| Vec::new()).collect();
    let (mut row, mut column, mut from) = (0, 0, 0.0);
    while row < rows.elements() && column < columns.elements() {
        let (end, other) = (rows.ends[row + 1], columns.ends[column + 1]);
        let to = end.min(other);
        if to - from > SAME {
            add_piece(&mut sums, (rows, row), (columns, column), [from, to]);
        }
        from = to;
        row += usize::from(end <= to);
        column += usize::from(other <= to);
    }
    let kept = |entry: &IntegralsEntry| (entry.sum.abs() > ZERO * entry.size).then_some((entry.column, entry.sum));
    sums.iter().map(|row| row.iter().filter_map(kept).collect()).collect()
}

/// Adds the products of the functions of two elements on the interval that both cover.
fn add_piece(
    sums: &mut [Vec<IntegralsEntry>],
    (rows, row): (&Side, usize),
    (columns, column): (&Side, usize),
    piece: [f64; 2],
) {
    let length = piece[1] - piece[0];
    // Differences from the element's start are exact, so short elements lose no digits.
    let within = |side: &Side, element: usize, t: f64| {
        ((piece[0] - side.ends[element]) + t * length) / (side.ends[element + 1] - side.ends[element])
    };
    for (t, weight) in gauss() {
        for (i, phi) in rows.functions(row, within(rows, row, t)) {
            for (j, psi) in columns.functions(column, within(columns, column, t)) {
                add(&mut sums[i], j, length * weight * phi * psi);
            }
        }
    }
}

/// Points and weights of Gauss quadrature on `[0, 1]`.
pub(in super::super) fn gauss() -> [(f64, f64); 3] {
    let offset = 0.5 * 0.6_f64.sqrt();
    [(0.5 - offset, 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.5 + offset, 5.0 / 18.0)]
}

/// Adds a part to an entry of a row. Intervals come in order, so the column is among the last three of the row, or new.
fn add(row: &mut Vec<IntegralsEntry>, column: usize, part: f64) {
    match row.iter_mut().rev().take(3).find(|entry| entry.column == column) {
        Some(entry) => (entry.sum, entry.size) = (entry.sum + part, entry.size + part.abs()),
        None => row.push(IntegralsEntry { column, sum: part, size: part.abs() }),
    }
}

#[cfg(test)]
mod tests {
    use super::super::side::Degree;
    use super::*;

    fn assert_near(found: &[(usize, f64)], expected: &[(usize, f64)]) {
        let near = |(a, b): (&(usize, f64), &(usize, f64))| a.0 == b.0 && (a.1 - b.1).abs() < 1e-16;
        assert!(found.len() == expected.len() && found.iter().zip(expected).all(near), "{found:?}, {expected:?}");
    }

    #[test]
    fn known_integrals_of_two_elements() {
        let linear = Side::uniform(2, Degree::Linear).expect("a mesh");
        let quadratic = Side::uniform(2, Degree::Quadratic).expect("a mesh");
        assert_near(&products(&linear, &linear)[1], &[(0, 1.0 / 12.0), (1, 1.0 / 3.0), (2, 1.0 / 12.0)]);
        let ends = [(0, -1.0 / 60.0), (1, 1.0 / 30.0), (2, 2.0 / 15.0), (3, 1.0 / 30.0), (4, -1.0 / 60.0)];
        assert_near(&products(&quadratic, &quadratic)[2], &ends);
        // The integral of the linear function of one end times the quadratic function of the other end is zero.
        assert_near(&products(&linear, &quadratic)[0], &[(0, 1.0 / 12.0), (1, 1.0 / 6.0)]);
    }

    /// Ends at `k / 49` and `k / 98` agree only up to rounding, which must not add intervals or entries.
    #[test]
    fn nested_meshes_share_their_ends() {
        let (coarse, fine) = (Side::uniform(49, Degree::Linear), Side::uniform(98, Degree::Linear));
        let band = products(&coarse.expect("a mesh"), &fine.expect("a mesh"));
        assert!(band[1..49].iter().all(|row| row.len() == 5), "{band:?}");
    }
}
