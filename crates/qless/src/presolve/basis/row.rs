//! A view of one row of the basis: `u_s = sum_k value_k u_k + constant`.

/// The terms of a row. If the terms are those of an equation that contains the slave, reading skips the slave and divides the other
/// coefficients by minus the coefficient of the slave.
#[derive(Clone, Copy)]
pub(crate) struct BasisRow<'a> {
    dofs: &'a [u32],
    values: &'a [f64],
    /// Position of the slave among the terms, or the number of terms if the slave is not one of them.
    slave: usize,
    divisor: f64,
    /// The reciprocal of the divisor if it is exact, else NaN. Most divisors are powers of two, and multiplication is faster than division.
    factor: f64,
}

impl<'a> BasisRow<'a> {
    /// A row whose terms do not contain the slave.
    pub fn new(dofs: &'a [u32], values: &'a [f64]) -> Self {
        Self { dofs, values, slave: dofs.len(), divisor: 1.0, factor: 1.0 }
    }

    /// An equation, solved for the DOF at position `slave`.
    #[inline]
    pub fn solved(dofs: &'a [u32], values: &'a [f64], slave: usize) -> Self {
        let divisor = -values[slave];
        let factor = if divisor.to_bits() << 12 == 0 { 1.0 / divisor } else { f64::NAN };
        Self { dofs, values, slave, divisor, factor }
    }

    /// The coefficient of the slave.
    #[inline]
    pub fn pivot(&self) -> f64 {
        -self.divisor
    }

    /// Number of terms.
    #[inline]
    pub fn len(&self) -> usize {
        self.dofs.len() - usize::from(self.slave < self.dofs.len())
    }

    /// DOF and coefficient of term k.
    #[inline]
    fn term(&self, k: usize) -> (u32, f64) {
        // Skips the slave without a branch, which would be unpredictable.
        let at = k + usize::from(k >= self.slave);
        (self.dofs[at], self.value(self.values[at]))
    }

    #[inline]
    fn value(&self, v: f64) -> f64 {
        if self.factor.is_nan() { v / self.divisor } else { v * self.factor }
    }

    /// DOFs and coefficients, in the order of the equation.
    #[inline]
    pub fn entries(self) -> impl ExactSizeIterator<Item = (u32, f64)> + Clone + use<'a> {
        (0..self.len()).map(move |k| self.term(k))
    }

    /// DOFs, in the order of the equation.
    #[inline]
    pub fn dofs(self) -> impl Iterator<Item = u32> + Clone + use<'a> {
        self.entries().map(|(j, _)| j)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_equation_is_solved_for_any_of_its_dofs() {
        let (dofs, values) = ([4, 7, 9], [3.0, -0.5, 7.0]);
        let solved = |slave| BasisRow::solved(&dofs, &values, slave).entries().collect::<Vec<_>>();
        assert_eq!(solved(0), [(7, 0.5 / 3.0), (9, -7.0 / 3.0)]);
        assert_eq!(solved(1), [(4, 6.0), (9, 14.0)]);
        assert_eq!(solved(2), [(4, -3.0 / 7.0), (7, 0.5 / 7.0)]);
        assert_eq!(BasisRow::new(&dofs, &values).entries().map(|(_, v)| v).collect::<Vec<_>>(), values);
    }

    #[test]
    fn coefficients_are_quotients_to_the_last_bit() {
        for pivot in [1.0, -2.0, f64::MIN_POSITIVE, 2f64.powi(1023), 3.0, -1e-300, 5e-324] {
            for v in [1.0, -1e-5, 7e-308, 5e-324, 3.7] {
                let value = BasisRow::solved(&[0, 1], &[pivot, v], 0).term(0).1;
                assert_eq!(value.to_bits(), (v / -pivot).to_bits(), "{v} by {pivot}");
            }
        }
    }
}
