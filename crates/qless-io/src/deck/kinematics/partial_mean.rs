//! A mean over some motions of the reference: `u_r = S^-1 sum w_k a_k^T u_k` with `S = sum w_k a_k^T a_k`, where a_k holds the columns of the
//! reference's own components alone. Without rotations among them it is the weighted mean, without lever arms. MYSTRAN's `RBE3` is this.

use super::body::{MotionRow, clean};
use super::dense::Factor;
use super::mean::Mean;
use super::row::{Poses, Row};
use crate::deck::{CardFault, Dof, Problem};

/// One equation for each component of the reference.
pub fn partial_rows(element: &Mean, poses: &impl Poses) -> Result<Vec<Row>, Problem> {
    let reference = poses.pose(element.reference)?;
    let own: Vec<u8> = element.components.iter().collect();
    let mut connected: Vec<(Dof, f64, Vec<f64>)> = Vec::new();
    for (dof, weight) in element.weights()? {
        let row: MotionRow = poses.pose(dof.node)?.seen_from(&reference).row(dof.component, [0.0; 3]);
        connected.push((dof, weight, own.iter().map(|&component| row[component as usize - 1]).collect()));
    }
    let (factor, scale) = normal(&connected, own.len());
    let row = |(i, &component): (usize, &u8)| {
        let mut unit = vec![0.0; own.len()];
        unit[i] = scale[i];
        let undetermined = || CardFault::MeanUndetermined { node: element.reference, component };
        let motion = Some(&factor).filter(|factor| factor.is_regular()).and_then(|factor| factor.solve(&unit));
        let motion = motion.ok_or_else(undetermined)?;
        let largest = motion.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let motion: Vec<f64> = motion.iter().zip(&scale).map(|(x, d)| clean(*x, largest) * d).collect();
        let share = |row: &[f64]| row.iter().zip(&motion).map(|(a, x)| a * x).sum::<f64>();
        let terms = connected.iter().map(|(dof, weight, row)| (*dof, weight * share(row)));
        Ok(Row::new(Dof { node: element.reference, component }, terms))
    };
    own.iter().enumerate().map(row).collect()
}

/// `D S D` with ones on its diagonal, factored, and D.
fn normal(connected: &[(Dof, f64, Vec<f64>)], n: usize) -> (Factor, Vec<f64>) {
    let mut s = vec![0.0; n * n];
    for (_, weight, row) in connected {
        (0..n * n).for_each(|k| s[k] += weight * row[k / n] * row[k % n]);
    }
    let scale: Vec<f64> = (0..n).map(|i| s[(n + 1) * i]).map(|x| if x > 0.0 { 1.0 / x.sqrt() } else { 1.0 }).collect();
    let scaled = (0..n * n).map(|k| s[k] * scale[k / n] * scale[k % n]).collect();
    (Factor::new(n, scaled), scale)
}
