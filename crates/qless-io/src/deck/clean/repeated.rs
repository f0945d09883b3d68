//! Masters that an `*EQUATION` names twice, as ccx 2.20 takes them.
//!
//! It adds such terms up only where the slave is named twice too, or where it inserts another equation into this one. Elsewhere it goes on
//! with a wrong stiffness, without a word. A node with axes of its own stands for three global DOFs in each of its terms, so that
//! two components of it are the same three twice.

use rustc_hash::{FxHashMap, FxHashSet};

use super::fault::Fault;
use super::plan::Given;
use crate::deck::{Dof, Model};

/// The equations in force of which ccx takes terms wrongly.
pub fn faults(model: &Model, prescribed: &Given, kept: impl Iterator<Item = usize> + Clone) -> Vec<Fault> {
    if !model.keeps_repeated_terms {
        return Vec::new();
    }
    let dof = |j: u32| model.dofs[j as usize];
    let slaves = kept.clone().filter_map(|i| model.nth(i).columns.first().map(|&j| (global(model, dof(j)), i)));
    let mut held: FxHashMap<Dof, usize> = slaves.collect();
    // A value along axes of its own is an equation to ccx.
    let given = prescribed.keys().map(|&j| global(model, dof(j))).filter(|dof| dof.component == 0);
    held.extend(given.map(|dof| (dof, usize::MAX)));
    let is_equation = |i: &usize| model.cards.nth(model.nth(*i).origin.card).name == "*EQUATION";
    let fault = |i: usize| {
        let equation = model.nth(i);
        let terms = equation.columns.iter().zip(equation.coefficients).filter(|(_, a)| **a != 0.0);
        let mut terms = terms.map(|(&j, _)| dof(j));
        let slave = terms.next()?;
        let is_prescribed = |dof: &Dof| model.column(*dof).is_some_and(|j| prescribed.contains_key(&j));
        let masters: Vec<Dof> = terms.filter(|dof| !is_prescribed(dof)).collect();
        let own = global(model, slave);
        let is_inserted = |dof: &Dof| held.get(dof).is_some_and(|&by| by != i);
        if masters.iter().map(|dof| global(model, *dof)).any(|dof| dof == own || is_inserted(&dof)) {
            return None;
        }
        let mut seen = FxHashSet::default();
        let master = masters.into_iter().find(|dof| !seen.insert(global(model, *dof)))?;
        Some(Fault::MasterTwice { equation: i, slave, master })
    };
    kept.filter(is_equation).filter_map(fault).collect()
}

/// The DOF, or the three global ones (component 0) of a node with axes of its own.
pub fn global(model: &Model, dof: Dof) -> Dof {
    let is_turned = (1..=3).contains(&dof.component) && model.turned.contains(&dof.node);
    if is_turned { Dof { component: 0, ..dof } } else { dof }
}
