//! What is left of the user's equations.

use super::FINE;
use super::expanded::{Expanded, each};
use crate::input::components::Labels;
use crate::input::numbering::Local;
use crate::input::scale::{Scaling, ldexp};

impl Expanded {
    /// Relative to the equations' own parts.
    pub fn residuals(&self, local: Local, independent: &[bool]) -> Vec<f64> {
        let sizes = self.sizes.as_ref().unwrap_or(&self.u);
        each(local.equations(), |i| {
            if !independent[i] {
                return 0.0;
            }
            let (sum, size) = self.sums(local, i, 1.0, sizes);
            // Near the end of the range of doubles the same is asked in another unit.
            let (sum, size) = if size.is_finite() { (sum, size) } else { self.sums(local, i, 1e-100, sizes) };
            relative(sum, size)
        })
    }

    /// Those that are not fine relative to the largest parts of their components.
    pub fn relative_to_components(&self, local: Local, scaling: &Scaling, out: &mut [f64]) {
        let labels = Labels::of(local);
        let mut largest = vec![0.0_f64; labels.count];
        for (i, &label) in labels.of_row.iter().enumerate() {
            let free = local.row(i).filter(|&(j, _)| local.free()[j]);
            let sizes = free.map(|(j, _)| ldexp(self.size(j), -scaling.col(j)));
            largest[label as usize] = sizes.fold(largest[label as usize], f64::max);
        }
        for (i, out) in out.iter_mut().enumerate().filter(|(_, out)| **out > FINE) {
            let b = self.rhs(local, i);
            let sum = local.row(i).fold(-b, |sum, (j, v)| sum + v * self.u[j]);
            // Prescribed DOFs are in no unit that others share: they count by what they bring into the equation, as b does.
            let largest = largest[labels.of_row[i] as usize];
            let parts = local.row(i).map(|(j, v)| {
                if local.free()[j] { ldexp(v.abs(), scaling.col(j)) * largest } else { (v * self.u[j]).abs() }
            });
            *out = relative(sum, parts.sum::<f64>() + b.abs());
        }
    }

    /// `C_i u - b_i` and the sum of the sizes of its parts, in a unit; `sizes` are those of the DOFs.
    #[inline]
    fn sums(&self, local: Local, i: usize, unit: f64, sizes: &[f64]) -> (f64, f64) {
        let b = self.rhs(local, i) * unit;
        let (dofs, values) = local.parts(i);
        dofs.iter().zip(values).fold((-b, b.abs()), |(sum, size), (&j, v)| {
            (sum + v * (self.u[j as usize] * unit), size + (v * (sizes[j as usize] * unit)).abs())
        })
    }

    fn rhs(&self, local: Local, i: usize) -> f64 {
        if self.with_rhs { local.rhs()[i] } else { 0.0 }
    }
}

/// A sum that is no number, or parts beyond the range of doubles, must not pass for small.
fn relative(sum: f64, size: f64) -> f64 {
    match sum.abs() / size {
        _ if sum == 0.0 => 0.0,
        residual if residual.is_finite() && size.is_finite() => residual,
        _ => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::relative;

    #[test]
    fn what_cannot_be_compared_is_not_small() {
        assert_eq!((relative(0.0, 0.0), relative(1.0, 4.0)), (0.0, 0.25));
        for (sum, size) in [(1e300, f64::INFINITY), (f64::NAN, 1.0), (f64::INFINITY, f64::INFINITY), (1.0, 0.0)] {
            assert_eq!(relative(sum, size), f64::INFINITY);
        }
    }
}
