//! Exact reduced row echelon forms of fractions.

/// Numerator and positive denominator, without common divisors.
type Fraction = (i128, i128);

fn divisor(a: i128, b: i128) -> i128 {
    if b == 0 { a.abs().max(1) } else { divisor(b, a % b) }
}

fn reduced((a, b): Fraction) -> Fraction {
    let common = divisor(a, b) * b.signum();
    (a / common, b / common)
}

fn product(a: Fraction, b: Fraction) -> Option<Fraction> {
    let (p, q) = (divisor(a.0, b.1), divisor(b.0, a.1));
    Some(reduced(((a.0 / p).checked_mul(b.0 / q)?, (a.1 / q).checked_mul(b.1 / p)?)))
}

fn difference(a: Fraction, b: Fraction) -> Option<Fraction> {
    let common = divisor(a.1, b.1);
    let top = a.0.checked_mul(b.1 / common)?.checked_sub(b.0.checked_mul(a.1 / common)?)?;
    Some(reduced((top, a.1.checked_mul(b.1 / common)?)))
}

/// The pivot columns among the first `columns`, and the form; none if numbers exceed 128 bits.
pub fn echelon(rows: &[Vec<i128>], columns: usize) -> Option<(Vec<usize>, Vec<Vec<Fraction>>)> {
    let mut a: Vec<Vec<Fraction>> = rows.iter().map(|row| row.iter().map(|&v| (v, 1)).collect()).collect();
    let mut pivots = Vec::new();
    for column in 0..columns {
        let rank = pivots.len();
        let Some(row) = (rank..a.len()).find(|&i| a[i][column].0 != 0) else { continue };
        a.swap(rank, row);
        let (top, bottom) = a[rank][column];
        let inverse = reduced((bottom, top));
        a[rank] = a[rank].iter().map(|&v| product(v, inverse)).collect::<Option<_>>()?;
        let pivot = a[rank].clone();
        for (_, other) in a.iter_mut().enumerate().filter(|(i, other)| *i != rank && other[column].0 != 0) {
            let factor = other[column];
            let less = |(&v, &p): (&Fraction, &Fraction)| difference(v, product(factor, p)?);
            *other = other.iter().zip(&pivot).map(less).collect::<Option<_>>()?;
        }
        pivots.push(column);
    }
    Some((pivots, a))
}

/// Numbers exceed 128 bits.
pub struct TooLarge;

/// `A^-1 b` from rows `[A b]`; none if A is singular.
pub fn solution(rows: &[Vec<i128>]) -> Result<Option<Vec<f64>>, TooLarge> {
    let (pivots, form) = echelon(rows, rows.len()).ok_or(TooLarge)?;
    let value = |row: &Vec<Fraction>| row[rows.len()].0 as f64 / row[rows.len()].1 as f64;
    Ok((pivots.len() == rows.len()).then(|| form.iter().map(value).collect()))
}
