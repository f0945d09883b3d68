//! Refuses load cases at which MYSTRAN stops, although each of their cards is valid.

use std::collections::BTreeSet;

use crate::deck::kinematics::mystran_mean::OMITTED;
use crate::deck::{LoadCase, Model, Prescribed};

/// Refuses a second value of a DOF if one of the two values is not zero, because MYSTRAN stops there (error 1332), even if both are equal.
/// `all` is sorted by DOF. Values that differ are clashes, which are refused elsewhere.
pub fn refuse_second_values(all: &[Prescribed], model: &mut Model) {
    for pair in all.windows(2) {
        let [first, second] = pair else { continue };
        if first.dof == second.dof && first.value == second.value && second.value.abs() > OMITTED {
            let (place, dof) = (model.place(first.origin), model.dof_name(second.dof));
            let card = model.cards.nth(second.origin.card);
            let text = format!(
                "{} enforces {dof}, which {place} enforces already: MYSTRAN stops, even at equal values; remove one",
                card.name
            );
            model.refuse(card.file, second.origin.line, text);
        }
    }
}

/// Refuses a load case whose equations have no independent DOF, because MYSTRAN stops there (error 2201).
pub fn refuse_without_masters(case: &LoadCase, model: &mut Model) {
    let rows: Vec<usize> = model.in_force(case).collect();
    let slaves: BTreeSet<u32> = rows.iter().filter_map(|&i| model.nth(i).columns.first().copied()).collect();
    let has_master = |&i: &usize| {
        let row = model.nth(i);
        let mut terms = row.columns.iter().zip(row.coefficients);
        terms.any(|(column, value)| value.abs() > OMITTED && !slaves.contains(column))
    };
    let Some(&first) = rows.first() else { return };
    if !rows.iter().any(has_master) {
        let origin = model.nth(first).origin;
        let text = "no equation has an independent DOF, where MYSTRAN stops: prescribe the dependent DOFs instead";
        model.refuse(model.cards.nth(origin.card).file, origin.line, text);
    }
}
