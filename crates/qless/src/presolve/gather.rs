//! Gathers the rows that remain after peeling: scaled, with prescribed DOFs moved into b, and with DOFs numbered anew from 0.

use super::rows::{Entry, WorkingRow};
use crate::input::numbering::LocalSystem;
use crate::input::scale::{Scaling, exponent, ldexp};

/// Rows for elimination.
pub(crate) struct Gathered {
    /// For each row, the index of the user's equation.
    pub names: Vec<u32>,
    /// For each DOF number used in `rows`, the local DOF.
    pub dofs: Vec<u32>,
    /// For each DOF number used in `rows`, true if the DOF is free.
    pub free: Vec<bool>,
    /// In `rows`, coefficients of DOF j are multiplied by `2^power[j]`. The column scaling leaves prescribed DOFs in the user's units; this
    /// factor makes their coefficients comparable with the others.
    pub power: Vec<i32>,
    pub rows: Vec<WorkingRow>,
}

/// The user's row whose scaled right-hand side or coefficients leave the range of doubles.
pub(crate) struct OutOfRange(pub usize);

/// Gathers the equations `names`. `noise` has the error of the right-hand side of each of the user's equations, in scaled rows.
pub(crate) fn gather(
    system: LocalSystem,
    names: Vec<u32>,
    scaling: &Scaling,
    noise: Option<&[f64]>,
) -> Result<Gathered, OutOfRange> {
    let (dofs, free, power) = (Vec::new(), Vec::new(), Vec::new());
    let mut out = Gathered { dofs, free, power, rows: Vec::with_capacity(names.len()), names };
    if out.names.is_empty() {
        return Ok(out);
    }
    let mut prescribed = vec![0.0; system.dofs()];
    system.prescribed().iter().for_each(|&(j, v)| prescribed[j] = v);
    let powers = powers(system, &out.names, scaling);
    let mut number = vec![u32::MAX; system.dofs()];
    for &name in &out.names {
        let i = name as usize;
        let mut row = WorkingRow::new(ldexp(system.rhs()[i], scaling.row[i]));
        let mut is_finite = true;
        row.effective_error += noise.map_or(0.0, |noise| noise[i]);
        row.entries.reserve_exact(system.row(i).len());
        for (j, v) in system.row(i) {
            let (entry, free) = (scaling.entry(i, j, v), system.free()[j]);
            if number[j] == u32::MAX {
                number[j] = out.dofs.len() as u32;
                out.dofs.push(j as u32);
                out.free.push(free);
                out.power.push(powers.get(j).copied().unwrap_or(0));
            }
            let value = ldexp(entry, out.power[number[j] as usize]);
            row.insert(Entry::given(number[j], value));
            if !free {
                row.prescribe(entry * prescribed[j]);
            }
            is_finite &= entry.is_finite();
        }
        if !(row.effective.is_finite() && row.effective_size.is_finite() && is_finite) {
            return Err(OutOfRange(i));
        }
        out.rows.push(row);
    }
    Ok(out)
}

/// For each local DOF, the power of two that scales the largest coefficient of a prescribed DOF to about 1; 0 for free DOFs. It does not
/// depend on the order of the equations. Empty if no DOF is prescribed.
fn powers(system: LocalSystem, names: &[u32], scaling: &Scaling) -> Vec<i32> {
    if system.prescribed().is_empty() {
        return Vec::new();
    }
    let mut largest = vec![0.0_f64; system.dofs()];
    for i in names.iter().map(|&name| name as usize) {
        let prescribed = system.row(i).filter(|&(j, _)| !system.free()[j]);
        prescribed.for_each(|(j, v)| largest[j] = largest[j].max(scaling.entry(i, j, v).abs()));
    }
    // If scaling made every coefficient zero or infinite, there is no size to scale.
    largest.iter().map(|&v| if v > 0.0 && v.is_finite() { -exponent(v) } else { 0 }).collect()
}
