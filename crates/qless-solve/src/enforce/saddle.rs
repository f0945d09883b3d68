//! The saddle equations of one part, and their inverse. The unknowns are u and then lambda:
//!
//! ```text
//! A = [K C^T; C -Z]        K u + C^T lambda = f,  C u - Z lambda = b        Z = 1 / D for penalties, zero for other equations
//! ```
//!
//! The inverse M^-1 satisfies all equations exactly (Z = 0). It eliminates some of them (subscript E) and gives multipliers to the others
//! (subscript M); r are the right-hand sides:
//!
//! ```text
//! elimination    u = L q + u_0, C_E u_0 = r_E             K_q = L^T K L, f_q = L^T (r - K u_0)
//! multipliers    [K_q C_q^T; C_q 0] [q; lambda_M] = [f_q; r_M - C_M u_0]
//! back           C_E^T lambda_E = r - K u - C_M^T lambda_M
//! ```
//!
//! If T of a connected component would fill, nothing is eliminated there: its slaves stay unknowns, and its equations need multipliers. The
//! solution is the same; `L^T K L` of a dense T grows with the square of the number of masters.

use qless::elimination::{CondensedPattern, PrescribedDofs, View};
use qless::{ConstraintSystem, Elimination, Form, Options, SystemBuilder, analyse};

use super::EnforceError;
use super::equations::{BALANCED, Equations, FLOOR, ROUNDING};
use super::matrix::{ScaledFactor, bordered, entries, from_triplets};
use super::part::EnforcedPart;
use super::problem::Method;
use super::scale::{known_units, scales, times_power};
use crate::common::times;

/// The saddle equations, which all methods solve; z is the compliance of each constraint equation.
pub fn saddle_equations(part: &EnforcedPart, z: &[f64]) -> Result<Equations, EnforceError> {
    let known = known_units(entries(&part.k), part.equations(), (part.dofs.len(), part.rows.len()));
    // The residual of a constraint equation without a penalty is compared with its own terms, or with the rounding of the largest terms.
    let of_row = |method: &Method| match method {
        Method::Penalty { .. } => (FLOOR, BALANCED),
        Method::Augmented { .. } => (ROUNDING, part.tolerance),
        Method::Elimination | Method::Multiplier => (ROUNDING, BALANCED),
    };
    let limits = part.dofs.iter().map(|_| (FLOOR, BALANCED)).chain(part.methods.iter().map(of_row)).collect();
    Ok(Equations::connected(bordered(&part.k, part.equations(), z)?, known, limits))
}

/// The compliance `Z_i = 1 / D_i` of each equation with a penalty, where `D_i = factor k_i / |C_i|^2`; zero for other equations.
///
/// `k_i` is the largest diagonal entry of K on the free DOFs of the equation, or the largest entry of the part if these have none, in the
/// caller's units. D has the units of the equation; the factor is dimensionless. If the part has no stiffness at all, Z is zero and the
/// equation is satisfied exactly.
pub fn compliance(part: &EnforcedPart) -> Vec<f64> {
    let n = part.dofs.len();
    let mut diagonal = vec![0.0; n];
    entries(&part.k).filter(|(i, j, _)| i == j).for_each(|(i, _, v)| diagonal[i] = v.abs());
    let of_row = |(i, method): (usize, &Method)| {
        let Method::Penalty { factor } = method else { return 0.0 };
        let row = || part.system.matrix().row(i);
        // Coefficients and stiffness are converted to the caller's units times the smallest scale of the equation's DOFs. This power of two
        // cancels in the quotient; without it, squares could leave the range of doubles.
        let unit = row().map(|(j, _)| part.scale[j]).min().unwrap_or_default();
        let square: f64 = row().map(|(j, v)| times_power(v, unit - part.scale[j]).powi(2)).sum();
        let near = row().map(|(j, _)| times_power(diagonal[j], 2 * (unit - part.scale[j]))).fold(0.0, f64::max);
        let all = entries(&part.k).map(|(i, j, v)| times_power(v.abs(), 2 * unit - part.scale[i] - part.scale[j]));
        let stiffness = if near > 0.0 { near } else { all.fold(0.0, f64::max) };
        if stiffness > 0.0 { square / stiffness / factor } else { 0.0 }
    };
    part.methods.iter().enumerate().map(of_row).collect()
}

/// Factors of the saddle matrix A with Z = 0: eliminated equations are condensed, and those with multipliers are a border.
pub struct SaddleInverse<'a> {
    part: &'a EnforcedPart<'a>,
    eliminated: Vec<usize>,
    elimination: Elimination,
    condensed: CondensedPattern,
    /// Equations with a multiplier in the matrix: those that are not eliminated, and those of components whose T would fill.
    border: Vec<usize>,
    multipliers: usize,
    factor: ScaledFactor,
}

impl<'a> SaddleInverse<'a> {
    /// Factors the equations of a part, with elimination of some equations and multipliers for the others.
    pub fn new(part: &'a EnforcedPart<'a>, is_eliminated: impl Fn(&Method) -> bool) -> Result<Self, EnforceError> {
        let all = 0..part.rows.len();
        let (eliminated, mut border): (Vec<_>, Vec<_>) = all.partition(|&row| is_eliminated(&part.methods[row]));
        let elimination = elimination_of(&part.system, &eliminated)?;
        let pattern = View::columns(part.k.symbolic().col_ptr(), part.k.symbolic().row_idx());
        let condensed = elimination.condensed(pattern, PrescribedDofs::Eliminated)?;
        let multipliers = border.len();
        border.extend(condensed.remaining_equations(&elimination).into_iter().map(|i| eliminated[i]));
        let mut values = vec![0.0; condensed.nnz()];
        condensed.condense_matrix_into(&elimination, part.k.val(), &mut values)?;
        let n = condensed.unknowns();
        let k_q = from_triplets(n, n, condensed.entries().zip(values).map(|((i, j), v)| (i, j, v)))?;
        let mut c_q = Vec::new();
        for (i, &row) in border.iter().enumerate() {
            let (terms, _) = condensed.equation(&elimination, part.system.matrix().row(row), 0.0)?;
            c_q.extend(terms.into_iter().map(|(j, v)| (i, j, v)));
        }
        let scale = scales(entries(&k_q), c_q.iter().copied(), (n, border.len()));
        let matrix = bordered(&k_q, c_q.into_iter(), &vec![0.0; border.len()])?;
        let factor = ScaledFactor::new(&matrix, scale, part.symmetric && border.is_empty())?;
        Ok(Self { part, eliminated, elimination, condensed, border, multipliers, factor })
    }

    /// Applies the inverse of the saddle matrix: `M^-1 r`.
    pub fn solve(&mut self, r: &[f64]) -> Result<Vec<f64>, EnforceError> {
        let (forces, gaps) = r.split_at(self.part.dofs.len());
        if !self.eliminated.is_empty() {
            let of_eliminated: Vec<f64> = self.eliminated.iter().map(|&row| gaps[row]).collect();
            self.elimination.update(&of_eliminated, &[])?;
        }
        let mut rhs = vec![0.0; self.condensed.unknowns()];
        self.condensed.load_into(&self.elimination, self.part.k.val(), forces, &mut rhs)?;
        // The constant part u_0, for DOFs that are not unknowns of the factored matrix.
        let mut constant = vec![0.0; forces.len()];
        self.elimination.expand_into(&vec![0.0; self.elimination.masters().len()], &mut constant)?;
        self.condensed.dofs().iter().for_each(|&dof| constant[dof] = 0.0);
        let moved = |row: usize| self.part.system.matrix().row(row).map(|(j, v)| v * constant[j]).sum::<f64>();
        rhs.extend(self.border.iter().map(|&row| gaps[row] - moved(row)));
        let mut x = self.factor.solve(&rhs)?;
        let of_border = x.split_off(self.condensed.unknowns());
        let place = |dof: &usize| self.condensed.dofs().binary_search(dof).unwrap_or_default();
        let masters: Vec<f64> = self.elimination.masters().iter().map(|dof| x[place(dof)]).collect();
        let mut u = vec![0.0; forces.len()];
        self.elimination.expand_into(&masters, &mut u)?;
        let lambda = self.multipliers(forces, gaps.len(), &u, &of_border)?;
        Ok([u, lambda].concat())
    }

    fn multipliers(&self, forces: &[f64], rows: usize, u: &[f64], of_border: &[f64]) -> Result<Vec<f64>, EnforceError> {
        let mut lambda = vec![0.0; rows];
        let mut rest: Vec<f64> = forces.iter().zip(times(&self.part.k, u)).map(|(f, stressed)| f - stressed).collect();
        for (&row, &value) in self.border[..self.multipliers].iter().zip(of_border) {
            lambda[row] = value;
            self.part.system.matrix().row(row).for_each(|(j, v)| rest[j] -= v * value);
        }
        if !self.eliminated.is_empty() {
            let carried = self.elimination.multipliers(&rest)?;
            self.eliminated.iter().zip(carried).for_each(|(&row, value)| lambda[row] = value);
        }
        Ok(lambda)
    }
}

/// Eliminates the equations `rows` with zero right-hand sides; components whose T would fill are kept as factors.
pub fn elimination_of(system: &ConstraintSystem, rows: &[usize]) -> Result<Elimination, EnforceError> {
    let mut builder = SystemBuilder::new(system.dofs());
    rows.iter().for_each(|&row| {
        builder.equation(system.matrix().row(row), 0.0);
    });
    system.prescribed().iter().for_each(|&(dof, _)| builder.prescribe(dof, 0.0));
    Ok(Elimination::from_analysis(analyse(&builder.build()?, &Options::default())?, Form::Auto)?)
}
