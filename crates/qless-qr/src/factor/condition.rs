//! `|R1|_1 |R1^{-1}|_1` and the smallest singular value of R1, estimated by a few substitutions.
//!
//! The 1-norm of the inverse by Hager's ascent over the corners of the unit ball with Higham's last guess (Hager 1984;
//! Higham 1988, Algorithm 4.1): a lower bound, seldom below a third. The singular value by inverse iteration on
//! `R1^T R1`: an upper bound. Cost: about four substitutions each pair of steps.

use super::Factor;
use crate::dense::scaled_norm;

/// Steps that Hager's ascent takes at most; it seldom takes more than three.
const STEPS: usize = 5;
/// Steps of the inverse iteration at most.
const TURNS: usize = 30;

impl Factor {
    /// An estimate of the condition number of R1 in the 1-norm, from below; 1 if the rank is 0, infinite if `R1^{-1}`
    /// is beyond all numbers. With full column rank, R1 has the singular values of A.
    ///
    /// ```
    /// use qless_qr::{Options, Symbolic};
    /// let symbolic = Symbolic::analyse(2, 2, &[0, 1, 2], &[0, 1])?;
    /// let factor = symbolic.factor(&[1.0, 1e-6], &[], Options::new())?;
    /// assert!((factor.condition() / 1e6 - 1.0).abs() < 1e-9);
    /// assert!((factor.smallest_singular_value() / 1e-6 - 1.0).abs() < 1e-9);
    /// # Ok::<(), qless_qr::Error>(())
    /// ```
    pub fn condition(&self) -> f64 {
        if self.rank() == 0 { 1.0 } else { finite(self.norm_one() * self.inverse_norm_one()) }
    }

    /// An estimate of the smallest singular value of R1, from above; infinite if the rank is 0.
    pub fn smallest_singular_value(&self) -> f64 {
        let r = self.rank();
        let mut x: Vec<f64> = (0..r).map(|i| 1.0 + i as f64 / r as f64).collect();
        let mut smallest = f64::INFINITY;
        for _ in 0..TURNS {
            let size = scaled_norm(&x);
            if size == 0.0 || !size.is_finite() {
                return if r == 0 { f64::INFINITY } else { 0.0 };
            }
            x.iter_mut().for_each(|v| *v /= size);
            self.forward(&mut x);
            let found = 1.0 / scaled_norm(&x);
            self.back(&mut x);
            let settled = found > 0.999 * smallest;
            smallest = smallest.min(found);
            if settled {
                break;
            }
        }
        smallest
    }

    /// `|R1^{-1}|_1` from below.
    fn inverse_norm_one(&self) -> f64 {
        let r = self.rank();
        let mut x = vec![1.0 / r as f64; r];
        let mut best = 0.0;
        for _ in 0..STEPS {
            let mut y = x.clone();
            self.back(&mut y);
            let found = sum(&y);
            if found <= best {
                break;
            }
            best = found;
            y.iter_mut().for_each(|v| *v = v.signum());
            self.forward(&mut y);
            let slope = y.iter().zip(&x).map(|(y, x)| y * x).sum::<f64>();
            let steepest = (0..r).max_by(|&i, &j| y[i].abs().total_cmp(&y[j].abs())).unwrap_or(0);
            if y[steepest].abs() <= slope {
                break;
            }
            x.fill(0.0);
            x[steepest] = 1.0;
        }
        let last = (r - 1).max(1) as f64;
        let mut guess: Vec<f64> =
            (0..r).map(|i| if i % 2 == 0 { 1.0 + i as f64 / last } else { -1.0 - i as f64 / last }).collect();
        self.back(&mut guess);
        finite(best.max(2.0 * sum(&guess) / (3.0 * r as f64)))
    }
}

fn sum(x: &[f64]) -> f64 {
    finite(x.iter().map(|v| v.abs()).sum())
}

/// What is beyond all numbers is infinite.
fn finite(x: f64) -> f64 {
    if x.is_nan() { f64::INFINITY } else { x }
}
