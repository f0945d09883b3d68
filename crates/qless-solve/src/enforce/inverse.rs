//! `x = M^-1 r` for right-hand sides of all DOFs and all equations: elimination, multipliers and springs in one matrix.
//!
//! ```text
//! springs        K' = K + C_P^T D C_P                     equations with a penalty or augmented
//! elimination    u = L q + u_0, C_E u_0 = r_E             K_q = L^T K' L, f_q = L^T (r + C_P^T D r_P - K' u_0)
//! multipliers    [K_q C_q^T; C_q 0] [q; lambda_M] = [f_q; r_M - C_M u_0]
//! back           lambda_P = D (C_P u - r_P),  C_E^T lambda_E = r - K u - C_M^T lambda_M - C_P^T lambda_P
//! ```
//!
//! This is the inverse of [`super::model`] up to rounding, and up to `1 / D` for augmented equations.

use std::borrow::Cow;

use super::condensation::Condensation;
use super::factor::{Factor, shifted};
use super::matrix::{Matrix, bordered, entries, from_triplets, times};
use super::method::Method;
use super::part::Part;
use super::{EnforceError, scale};

/// The factored matrix of some methods.
pub struct Inverse<'a> {
    part: &'a Part<'a>,
    /// D of each equation; zero without a spring.
    springs: Vec<f64>,
    /// K with its springs.
    sum: Cow<'a, Matrix>,
    eliminated: Vec<usize>,
    /// None where nothing is eliminated.
    elimination: Option<Condensation>,
    /// DOFs that are unknowns.
    unknowns: usize,
    /// Equations with a multiplier in the matrix: those of the caller, and of parts of which T would fill.
    border: Vec<usize>,
    multipliers: usize,
    factor: Factor,
}

impl<'a> Inverse<'a> {
    /// With `shift` on the diagonal of the unknown DOFs in units of [`super::scale`], for a matrix that is singular.
    pub fn new(part: &'a Part<'a>, methods: &[Method], springs: Vec<f64>, shift: f64) -> Result<Self, EnforceError> {
        let of = |method: Method| (0..methods.len()).filter(move |&row| methods[row] == method);
        let eliminated: Vec<usize> = of(Method::Elimination).collect();
        let mut border: Vec<usize> = of(Method::Multiplier).collect();
        let sum = with_springs(part, &springs)?;
        let is_any = !eliminated.is_empty();
        let elimination = is_any.then(|| Condensation::new(&part.system, &eliminated, &sum)).transpose()?;
        let multipliers = border.len();
        border.extend(elimination.iter().flat_map(|elimination| &elimination.left));
        let k_q = match &elimination {
            None => Cow::Borrowed(&*sum),
            Some(elimination) => Cow::Owned(elimination.matrix(&sum)?),
        };
        let c_q = over_unknowns(part, elimination.as_ref(), &border)?;
        let (units, count) = (scale::units(&k_q, &c_q), k_q.nrows());
        let definite = part.symmetric && border.is_empty();
        let matrix = if border.is_empty() { k_q } else { Cow::Owned(bordered(&k_q, &c_q)?) };
        let matrix = if shift > 0.0 { Cow::Owned(shifted(&matrix, &units, count, shift)?) } else { matrix };
        let factor = Factor::new(&matrix, units, definite)?;
        drop(matrix);
        Ok(Self { part, springs, sum, eliminated, elimination, unknowns: count, border, multipliers, factor })
    }

    /// D of each equation.
    pub fn springs(&self) -> &[f64] {
        &self.springs
    }

    /// `M^-1 r`.
    pub fn solve(&mut self, r: &[f64]) -> Result<Vec<f64>, EnforceError> {
        let n = self.part.dofs.len();
        let (forces, gaps) = r.split_at(n);
        let (mut rhs, constant) = self.condensed(forces, gaps)?;
        let moved = |row: usize| constant.as_ref().map_or(0.0, |constant| self.along(row, constant));
        rhs.extend(self.border.iter().map(|&row| gaps[row] - moved(row)));
        let x = self.factor.solve(&rhs)?;
        let (q, of_border) = x.split_at(self.unknowns);
        let u = self.elimination.as_ref().map_or_else(|| Ok(q.to_vec()), |elimination| elimination.expand(q))?;
        let lambda = self.multipliers(forces, gaps, &u, of_border)?;
        Ok([u, lambda].concat())
    }

    /// f_q, and u_0 where there is one.
    fn condensed(&mut self, forces: &[f64], gaps: &[f64]) -> Result<(Vec<f64>, Option<Vec<f64>>), EnforceError> {
        let load = self.loaded(forces, gaps);
        let Some(elimination) = &mut self.elimination else { return Ok((load, None)) };
        let of_eliminated: Vec<f64> = self.eliminated.iter().map(|&row| gaps[row]).collect();
        elimination.set(&of_eliminated)?;
        Ok((elimination.load(&self.sum, &load)?, Some(elimination.constant()?)))
    }

    /// `r + C_P^T D r_P`.
    fn loaded(&self, forces: &[f64], gaps: &[f64]) -> Vec<f64> {
        let mut load = forces.to_vec();
        for (row, d) in self.sprung() {
            self.part.system.matrix().row(row).for_each(|(j, v)| load[j] += v * d * gaps[row]);
        }
        load
    }

    fn multipliers(
        &self,
        forces: &[f64],
        gaps: &[f64],
        u: &[f64],
        of_border: &[f64],
    ) -> Result<Vec<f64>, EnforceError> {
        let mut lambda = vec![0.0; gaps.len()];
        self.border[..self.multipliers].iter().zip(of_border).for_each(|(&row, &value)| lambda[row] = value);
        self.sprung().for_each(|(row, d)| lambda[row] = d * (self.along(row, u) - gaps[row]));
        let Some(elimination) = &self.elimination else { return Ok(lambda) };
        let stressed = times(&self.part.k, u);
        let mut rest: Vec<f64> = forces.iter().zip(stressed).map(|(force, stressed)| force - stressed).collect();
        for row in (0..gaps.len()).filter(|&row| lambda[row] != 0.0) {
            self.part.system.matrix().row(row).for_each(|(j, v)| rest[j] -= v * lambda[row]);
        }
        let carried = elimination.map.multipliers(&rest)?;
        self.eliminated.iter().zip(carried).for_each(|(&row, value)| lambda[row] = value);
        Ok(lambda)
    }

    fn sprung(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.springs.iter().copied().enumerate().filter(|&(_, d)| d > 0.0)
    }

    /// `C_i u`.
    fn along(&self, row: usize, u: &[f64]) -> f64 {
        self.part.system.matrix().row(row).map(|(j, v)| v * u[j]).sum()
    }
}

/// `K + C_P^T D C_P`.
fn with_springs<'a>(part: &'a Part<'a>, springs: &[f64]) -> Result<Cow<'a, Matrix>, EnforceError> {
    if springs.iter().all(|d| *d == 0.0) {
        return Ok(Cow::Borrowed(&part.k));
    }
    let n = part.dofs.len();
    let of_row = |(row, &d): (usize, &f64)| {
        let row = part.system.matrix().row(row);
        row.clone().flat_map(move |(i, a)| row.clone().map(move |(j, b)| (i, j, d * a * b)))
    };
    let springs = springs.iter().enumerate().filter(|(_, d)| **d > 0.0).flat_map(of_row);
    from_triplets(n, n, entries(&part.k).chain(springs)).map(Cow::Owned)
}

/// Some rows of C over the unknowns.
fn over_unknowns(part: &Part, some: Option<&Condensation>, rows: &[usize]) -> Result<Matrix, EnforceError> {
    let mut triplets = Vec::new();
    for (i, &row) in rows.iter().enumerate() {
        let row = part.system.matrix().row(row);
        match some {
            None => triplets.extend(row.map(|(j, v)| (i, j, v))),
            Some(some) => {
                let (terms, _) = some.condensed.equation(&some.map, row, 0.0)?;
                triplets.extend(terms.into_iter().map(|(j, v)| (i, j, v)));
            }
        }
    }
    let unknowns = some.map_or(part.dofs.len(), |some| some.condensed.unknowns());
    from_triplets(rows.len(), unknowns, triplets)
}
