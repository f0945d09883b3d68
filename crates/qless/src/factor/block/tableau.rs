//! `x_B = Y x_N`, with exchanges of a basic and a nonbasic variable.
//!
//! The tableau has two uses: dependent rows over kept rows (`row_k = sum y_ki row_i`), and slaves over masters (`u_s = T u_q + ...`).
//! Exchanging row i with column j divides by `y_ij` and multiplies the determinant of the basis by `|y_ij|`. If that is at least 1, no
//! accuracy is lost.

/// A dense matrix Y by rows. The last columns may be fixed (prescribed DOFs and the constant) and are then never exchanged.
#[derive(Clone, Debug)]
pub(crate) struct Tableau {
    /// Name of each row's variable.
    pub basic: Vec<u32>,
    /// Names of the columns that may be exchanged.
    pub free: Vec<u32>,
    /// Number of columns, including fixed ones.
    pub width: usize,
    pub data: Vec<f64>,
}

/// In a tableau with more entries, [`Tableau::prefer`] and [`Tableau::limit`] exchange no variables, because that would take too long.
const LARGE: usize = 4_000_000;
/// Largest number of exchanges to reach a bound; if more are needed, it is better to choose a new basis.
const MOST_EXCHANGES: usize = 100;
/// Least `|y_ij|` of an exchange that only makes a preferred variable basic; then the determinant of the basis hardly decreases.
const NEUTRAL: f64 = 0.9;

impl Tableau {
    pub fn row(&self, i: usize) -> &[f64] {
        &self.data[i * self.width..(i + 1) * self.width]
    }

    /// Exchanges variables if that costs no accuracy and `better(column, row)` is true: the column's variable is then preferred as the
    /// basic one. Each exchange improves the order, so this ends; a budget limits it, and a large tableau stays unchanged.
    pub fn prefer(&mut self, better: impl Fn(u32, u32) -> bool) {
        if self.data.len() > LARGE {
            return;
        }
        let mut budget = 4 * self.basic.len() + 16;
        for i in 0..self.basic.len() {
            while let Some(j) = self.best(i, &better).filter(|_| budget > 0) {
                self.exchange(i, j);
                budget -= 1;
            }
        }
    }

    /// Exchanges variables until no entry of a column that may be exchanged is larger than `bound`. Each exchange multiplies the
    /// determinant of the basis by more than `bound`, so this ends. Returns false if entries stay larger: the tableau is too large, or
    /// needs too many exchanges.
    pub fn limit(&mut self, bound: f64) -> bool {
        for _ in 0..MOST_EXCHANGES {
            match self.largest().filter(|&(i, j)| self.row(i)[j].abs() > bound) {
                Some(_) if self.data.len() > LARGE => return false,
                Some((i, j)) => self.exchange(i, j),
                None => return true,
            }
        }
        false
    }

    fn largest(&self) -> Option<(usize, usize)> {
        let places = (0..self.basic.len()).flat_map(|i| (0..self.free.len()).map(move |j| (i, j)));
        let size = |(i, j): (usize, usize)| self.data[i * self.width + j].abs();
        places.reduce(|a, b| if size(b) > size(a) { b } else { a })
    }

    fn best(&self, i: usize, better: &impl Fn(u32, u32) -> bool) -> Option<usize> {
        let row = self.row(i);
        let wanted = (0..self.free.len()).filter(|&j| row[j].abs() >= NEUTRAL && better(self.free[j], self.basic[i]));
        wanted.reduce(|a, b| if better(self.free[b], self.free[a]) { b } else { a })
    }

    /// Exchanges the variables of row i and column j.
    pub fn exchange(&mut self, i: usize, j: usize) {
        let width = self.width;
        let (start, pivot) = (i * width, self.data[i * width + j]);
        let mut own: Vec<f64> = self.data[start..start + width].iter().map(|v| -v / pivot).collect();
        own[j] = 1.0 / pivot;
        for k in (0..self.basic.len()).filter(|&k| k != i) {
            let row = &mut self.data[k * width..(k + 1) * width];
            let factor = std::mem::take(&mut row[j]);
            if factor != 0.0 {
                row.iter_mut().zip(&own).for_each(|(x, v)| *x += factor * v);
            }
        }
        self.data[start..start + width].copy_from_slice(&own);
        std::mem::swap(&mut self.basic[i], &mut self.free[j]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exchange_keeps_the_relation() {
        let mut tableau =
            Tableau { basic: vec![0, 1], free: vec![2, 3], width: 3, data: vec![2.0, -1.0, 5.0, 0.5, 3.0, -2.0] };
        let (x2, x3) = (0.7, -1.3);
        let x = [2.0 * x2 - x3 + 5.0, 0.5 * x2 + 3.0 * x3 - 2.0, x2, x3];
        tableau.exchange(1, 1);
        assert_eq!((tableau.basic.as_slice(), tableau.free.as_slice()), ([0, 3].as_slice(), [2, 1].as_slice()));
        for i in 0..2 {
            let row = tableau.row(i);
            let value = row[0] * x[tableau.free[0] as usize] + row[1] * x[tableau.free[1] as usize] + row[2];
            assert!((value - x[tableau.basic[i] as usize]).abs() < 1e-14);
        }
    }

    #[test]
    fn exchanges_bring_every_entry_below_the_bound() {
        let data = vec![1e3, 2.0, 1.0, -5.0, 0.5, 1.0, 7.0, 1e-9, 1.0];
        let mut tableau = Tableau { basic: vec![0, 1, 2], free: vec![3, 4], width: 3, data };
        assert!(tableau.limit(1.5));
        assert!((0..3).all(|i| tableau.row(i)[..2].iter().all(|v| v.abs() <= 1.5)), "{tableau:?}");
    }

    #[test]
    fn earlier_variables_become_basic_where_it_costs_nothing() {
        let mut tableau = Tableau { basic: vec![5, 1], free: vec![0, 2], width: 2, data: vec![1.0, 1.0, 0.1, 1.0] };
        tableau.prefer(|candidate, holder| candidate < holder);
        assert_eq!(tableau.basic, [0, 1]);
    }
}
