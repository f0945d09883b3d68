//! Solves equations for their slaves: `u_s - T u_q - G u_p = g`.
//!
//! Layers (see `layers`) are solved from the last load case back to the first. Slaves of layers that are already solved stay slaves, and
//! only the rows of new slaves are written. A new slave may be a master in rows that are already written, since solvers follow such chains.

use qless::{Analysis, Preferences};
use rustc_hash::FxHashSet;

use super::layers::{KeptEquations, unprescribed, vanishing};
use super::{CleanError, Written};
use crate::deck::Model;

/// The new equations for the connected components that are rewritten.
pub fn written(kept: &KeptEquations, is_rewritten: &dyn Fn(usize) -> bool) -> Result<Vec<Written>, CleanError> {
    let mut slaves: FxHashSet<usize> = FxHashSet::default();
    let mut all = Vec::new();
    for layer in 0..kept.layers.len() {
        let rows: Vec<usize> = (0..kept.layer_of.len()).filter(|&i| kept.holds(i, layer) && is_rewritten(i)).collect();
        if rows.iter().any(|&i| kept.layer_of[i] == Some(layer)) {
            solve(kept, layer, &rows, &mut slaves, &mut all)?;
        }
    }
    Ok(all)
}

fn solve(
    kept: &KeptEquations,
    layer: usize,
    rows: &[usize],
    slaves: &mut FxHashSet<usize>,
    all: &mut Vec<Written>,
) -> Result<(), CleanError> {
    let prescribed = &kept.layers[layer].prescribed;
    let vanishing = vanishing(kept.model, prescribed);
    let new = rows.iter().filter(|&&i| kept.layer_of[i] == Some(layer) && !vanishing.contains(&i));
    let own = new.filter_map(|&i| kept.model.nth(i).columns.first().copied());
    // The deck's own slaves are preferred, except those with too small coefficients and those that must not be slaves.
    let claims = SlaveClaims::collect(kept.model);
    let preferred = own.chain(slaves.iter().map(|&j| j as u32)).filter(|&j| !claims.hold(j as usize));
    let preferred = unprescribed(preferred, prescribed);
    let masters = (0..kept.model.dofs.len()).filter(|&j| claims.hold(j)).collect();
    let preferences = Preferences { slaves: preferred, masters, ..Preferences::default() };
    let analysis = kept.analyse(&kept.layers[layer], rows, preferences)?;
    let before = all.len();
    add_rows(kept, layer, &analysis, slaves, all)?;
    let chosen: FxHashSet<usize> = analysis.reduction()?.slaves().iter().copied().collect();
    if slaves.iter().any(|slave| !chosen.contains(slave)) || all.len() - before + slaves.len() != chosen.len() {
        return Err(CleanError::Apart { case: kept.layers[layer].name.clone() });
    }
    *slaves = chosen;
    Ok(())
}

/// The DOFs that must not be slaves: another card claims them, or their node has local axes and a prescribed DOF.
struct SlaveClaims<'a> {
    model: &'a Model,
    /// The nodes with local axes and a prescribed DOF.
    held: FxHashSet<u32>,
}

impl<'a> SlaveClaims<'a> {
    fn collect(model: &'a Model) -> Self {
        let given = model.cases.iter().filter(|_| !model.nodes_with_axes.is_empty()).flat_map(|case| &case.prescribed);
        let held = given.map(|given| given.dof.node).filter(|node| model.nodes_with_axes.contains(node)).collect();
        Self { model, held }
    }

    /// Whether the DOF of a column must not be a slave.
    fn hold(&self, column: usize) -> bool {
        let dof = self.model.dofs[column];
        self.held.contains(&dof.node) || self.model.is_claimed(dof)
    }
}

/// Adds the row of each slave of this layer, except for the slaves in `before`: their rows were written for the layer solved before.
fn add_rows(
    kept: &KeptEquations,
    layer: usize,
    analysis: &Analysis,
    before: &FxHashSet<usize>,
    all: &mut Vec<Written>,
) -> Result<(), CleanError> {
    let model = kept.model;
    let claims = SlaveClaims::collect(model);
    let reduction = analysis.reduction()?;
    // A right-hand side below this is a rounding error of terms that cancel, so it counts as zero.
    let rounding = 1e-14 * (0..model.equations()).fold(0.0, |size: f64, i| size.max(model.nth(i).rhs.abs()));
    for (row, &slave) in reduction.slaves().iter().enumerate().filter(|(_, slave)| !before.contains(slave)) {
        let masters = reduction.t().row(row).map(|(j, v)| (model.dofs[reduction.masters()[j]], -v));
        let given = reduction.g_matrix().row(row).map(|(j, v)| (model.dofs[reduction.prescribed()[j]], -v));
        let terms = masters.chain(given).filter(|term| term.1 != 0.0).collect();
        let rhs = if reduction.g()[row].abs() <= rounding { 0.0 } else { reduction.g()[row] };
        if claims.hold(slave) {
            let (slave, case) = (model.dof_name(model.dofs[slave]), kept.layers[layer].name.clone());
            return Err(CleanError::Claimed { case, slave });
        }
        all.push(Written { slave: model.dofs[slave], terms, rhs, cases: kept.cases(layer) });
    }
    Ok(())
}
