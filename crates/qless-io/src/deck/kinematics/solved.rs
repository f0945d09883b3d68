//! `U x = R` turned into `x = U^-1 R`: rows solved for chosen components; they span what they spanned before.

use std::collections::BTreeMap;

use super::body::clean;
use super::dense::Factor;
use super::row::Row;
use crate::deck::{CardFault, Dof, Problem};

/// The rows solved for `dependent`, one each. `size` turns a rotation into a length.
pub fn solved_for(rows: &[Row], dependent: &[Dof], size: f64) -> Result<Vec<Row>, Problem> {
    let m = rows.len();
    if dependent.len() != m {
        return Err(CardFault::UmCount { found: dependent.len(), expected: m }.into());
    }
    let columns = columns(rows, size);
    let mut matrix = vec![0.0; m * m];
    for (j, dof) in dependent.iter().enumerate() {
        let column = columns.get(dof).ok_or(CardFault::UmSingular)?;
        (0..m).for_each(|i| matrix[m * i + j] = column[i]);
    }
    let factor = Factor::new(m, matrix);
    if !factor.is_regular() {
        return Err(CardFault::UmSingular.into());
    }
    let others = columns.iter().filter(|(dof, _)| !dependent.contains(dof));
    let solved: Vec<(Dof, Vec<f64>)> =
        others.map(|(&dof, column)| (dof, factor.solve(column).unwrap_or_default())).collect();
    Ok((0..m).map(|i| row(i, dependent[i], &solved, size)).collect())
}

/// The coefficients of each component in every row, all as lengths.
fn columns(rows: &[Row], size: f64) -> BTreeMap<Dof, Vec<f64>> {
    let mut columns = BTreeMap::new();
    for (i, row) in rows.iter().enumerate() {
        for &(dof, value) in &row.terms {
            let column = columns.entry(dof).or_insert_with(|| vec![0.0; rows.len()]);
            column[i] += value * unit(row.terms[0].0, size) / unit(dof, size);
        }
    }
    columns
}

fn row(i: usize, dependent: Dof, solved: &[(Dof, Vec<f64>)], size: f64) -> Row {
    let largest = solved.iter().fold(1.0, |m: f64, (_, column)| m.max(column[i].abs()));
    let back = |dof| unit(dof, size) / unit(dependent, size);
    Row::new(dependent, solved.iter().map(|(dof, column)| (*dof, -clean(column[i], largest) * back(*dof))))
}

fn unit(dof: Dof, size: f64) -> f64 {
    if dof.component > 3 { size } else { 1.0 }
}
