//! The stiffness `K = I + L` of springs of stiffness 1 from each DOF to the ground and to the next DOF.

/// The factorization `K = L D L^T` on the free DOFs.
pub struct Chain {
    free: Vec<bool>,
    /// The diagonal D and the subdiagonal of L in `K = L D L^T`; 1 and 0 for prescribed DOFs.
    factor: Vec<(f64, f64)>,
}

impl Chain {
    /// `free[j]` is true if DOF j is free.
    pub fn new(free: Vec<bool>) -> Self {
        let mut factor: Vec<(f64, f64)> = Vec::with_capacity(free.len());
        for (j, &is_free) in free.iter().enumerate() {
            let coupled = is_free && j > 0 && free[j - 1];
            let lower = if coupled { -1.0 / factor[j - 1].0 } else { 0.0 };
            factor.push(if is_free { (diagonal(j, free.len()) + lower, lower) } else { (1.0, 0.0) });
        }
        Self { free, factor }
    }

    /// For each DOF, whether it is free.
    pub fn free(&self) -> &[bool] {
        &self.free
    }

    /// `K^-1 r` on the free DOFs, where K is the stiffness of the chain; 0 on the others.
    pub fn solve(&self, r: &[f64]) -> Vec<f64> {
        let mut x: Vec<f64> = r.iter().zip(&self.free).map(|(&r, &free)| if free { r } else { 0.0 }).collect();
        for j in 1..x.len() {
            x[j] -= self.factor[j].1 * x[j - 1];
        }
        for j in (0..x.len()).rev() {
            let after = if j + 1 < x.len() { self.factor[j + 1].1 * x[j + 1] } else { 0.0 };
            x[j] = x[j] / self.factor[j].0 - after;
        }
        x
    }
}

/// `K u` on all DOFs, where K is the stiffness of the chain.
pub fn times(u: &[f64]) -> Vec<f64> {
    let n = u.len();
    let next = |j: usize| if j + 1 < n { u[j + 1] } else { 0.0 };
    let before = |j: usize| if j > 0 { u[j - 1] } else { 0.0 };
    (0..n).map(|j| diagonal(j, n) * u[j] - before(j) - next(j)).collect()
}

/// The diagonal entry of DOF j: one spring to the ground and one to each neighbour.
fn diagonal(j: usize, n: usize) -> f64 {
    1.0 + f64::from(u8::from(j > 0)) + f64::from(u8::from(j + 1 < n))
}

#[cfg(test)]
mod tests {
    use super::{Chain, times};

    #[test]
    fn what_is_solved_is_what_was_multiplied() {
        for held in [vec![], vec![0], vec![3, 4], vec![9], vec![0, 2, 5, 9]] {
            let free: Vec<bool> = (0..10).map(|j| !held.contains(&j)).collect();
            let chain = Chain::new(free.clone());
            let u: Vec<f64> = (0..10).map(|j| if free[j] { f64::from(j as u8 * 7 % 5) - 1.5 } else { 0.0 }).collect();
            let found = chain.solve(&times(&u));
            assert!(found.iter().zip(&u).all(|(a, b)| (a - b).abs() < 1e-14), "{held:?}: {found:?} for {u:?}");
        }
    }
}
