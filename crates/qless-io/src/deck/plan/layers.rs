//! Chooses independent equations for load cases that follow each other, as steps do: equations hold from the start and
//! can only be removed.
//!
//! Let `U_k` be the DOFs prescribed in any of the load cases up to k. The load cases are treated from last to first. Load case k adds a
//! layer: those of its equations that, without the columns of `U_k`, are independent of the equations kept so far. These equations hold up
//! to load case k. They are independent in each earlier load case too, because no DOF outside `U_k` is prescribed there. `steps` compares
//! ranks to see whether the kept equations suffice for every load case. Load case k shares the layer of k + 1 if `U_k` is `U_(k+1)` and
//! both remove the same equations. Cost: one analysis for each layer, and a second one if edits of cards drop equations.

use std::collections::BTreeMap;

use qless::{Analysis, Kind, Options, Preferences, analyse};
use rustc_hash::{FxHashMap, FxHashSet};

use super::card_edits::{EditKey, edit_of, kept_by_edits};
use super::{Cases, CleanError, Combination, PlanOptions};
use crate::deck::faults::{EquationFault, FaultKind, faults_of};
use crate::deck::solver::{Outcome, Profile};
use crate::deck::{Deck, Dof, LoadCase, Model, Origin, Prescribed, Solver};

/// The columns that are prescribed, each with the card that prescribes it.
pub type PrescribedColumns = FxHashMap<u32, Origin>;

/// A group of load cases: all up to `last`. `prescribed` holds the DOFs that any of them prescribes. The equations kept in all these load
/// cases are independent even without the columns of these DOFs.
pub struct Layer {
    /// The index of the last load case of the group.
    pub last: usize,
    /// The name of the last load case of the group.
    pub name: String,
    /// The columns that any load case of the group prescribes.
    pub prescribed: PrescribedColumns,
}

/// Which equations are kept, and up to which load case.
pub struct KeptEquations<'a> {
    pub model: &'a Model,
    solver: Solver,
    pub options: &'a Options,
    edits_cards: bool,
    explains: bool,
    /// The layers. The first one ends with the last load case.
    pub layers: Vec<Layer>,
    /// For each equation, the index of its layer: the equation is kept up to the last load case of this layer. `None` if it is dependent.
    pub layer_of: Vec<Option<usize>>,
    /// For each dependent equation, what gives it. Empty if the plan needs no explanations.
    pub because: FxHashMap<usize, Combination>,
    /// For each equation, the last load case in which it is in force in the deck; `None` if it never is.
    pub end: Vec<Option<usize>>,
}

impl<'a> KeptEquations<'a> {
    /// Chooses the equations to keep for load cases that follow each other.
    pub fn choose(
        deck: &'a Deck,
        cases: &[LoadCase],
        PlanOptions { options, edits_cards, explains }: PlanOptions<'a>,
    ) -> Result<Self, CleanError> {
        let model = &deck.model;
        let end = ends(model, cases)?;
        let count = model.equations();
        let (layer_of, because) = (vec![None; count], FxHashMap::default());
        let solver = deck.solver();
        let mut kept =
            Self { model, solver, options, edits_cards, explains, layers: Vec::new(), layer_of, because, end };
        for last in (0..cases.len()).rev() {
            let next = (last + 1 < cases.len()).then(|| &cases[last + 1]);
            let prescribed = model.prescribed_in(&cases[..=last]);
            let is_same = |next: &LoadCase| {
                next.removed == cases[last].removed
                    && kept.layers[kept.layers.len() - 1].prescribed.len() == prescribed.len()
            };
            if !next.is_some_and(is_same) {
                kept.add_layer(Layer { last, name: cases[last].name.clone(), prescribed }, &cases[last])?;
            }
        }
        Ok(kept)
    }

    /// Keeps the equations that a layer needs in addition to those that are already kept.
    fn add_layer(&mut self, layer: Layer, case: &LoadCase) -> Result<(), CleanError> {
        let rows: Vec<usize> = self.model.in_force(case).collect();
        let vanishing = vanishing(self.model, &layer.prescribed);
        let own = |&i: &usize| self.model.nth(i).columns.first().copied().filter(|_| !vanishing.contains(&i));
        let slaves = unprescribed(rows.iter().filter_map(own), &layer.prescribed);
        let is_fixed =
            |i: usize| self.layer_of[i].is_some() || self.model.cards.nth(self.model.nth(i).origin.card).is_fixed;
        let wanted: FxHashSet<usize> = self.options.preferences.equations.iter().copied().collect();
        let stays = |i: usize| is_fixed(i) || wanted.contains(&i);
        let equations = rows.iter().zip(0..).filter(|(i, _)| stays(**i)).map(|(_, row)| row).collect();
        let mut preferences = Preferences { slaves, equations, ..Preferences::default() };
        let mut analysis = self.analyse(&layer, &rows, preferences.clone())?;
        if self.edits_cards && !analysis.dependent().is_empty() {
            let gains = self.gains(&layer, &rows);
            let gain = |i| gains.get(&i).copied().unwrap_or(0);
            let edit = |i| (!stays(i)).then(|| self.edit_of(i));
            let kept = kept_by_edits(self.model, &rows, &analysis, edit, gain);
            if let Some(kept) = kept {
                preferences.equations.extend(kept);
                analysis = self.analyse(&layer, &rows, preferences)?;
            }
        }
        let number = self.layers.len();
        for (&i, kind) in rows.iter().zip(analysis.kinds()) {
            match (kind, self.layer_of[i]) {
                (Kind::Independent, None) => self.layer_of[i] = Some(number),
                (Kind::Independent, Some(_)) => {}
                (_, Some(_)) => return Err(CleanError::Apart { case: case.name.clone() }),
                (_, None) => self.note(i, &rows, &analysis, &layer.prescribed),
            }
        }
        self.layers.push(layer);
        Ok(())
    }

    /// The edit of a card that drops equation `i`.
    pub fn edit_of(&self, i: usize) -> EditKey {
        edit_of(self.model, i, self.edits_cards)
    }

    /// How much it helps to drop an equation: 2 if the equation has a fault other than a circle, 1 if it is part of a circle. A circle
    /// counts less because dropping another of its equations opens it as well.
    fn gains(&self, layer: &Layer, rows: &[usize]) -> FxHashMap<usize, u8> {
        let mut left_out = vec![true; self.model.equations()];
        rows.iter().for_each(|&i| left_out[i] = false);
        let mut gains = FxHashMap::default();
        for fault in faults_of(self.model, &layer.prescribed, &left_out) {
            let (gain, other) = match fault.kind {
                FaultKind::Circle => (1, None),
                FaultKind::SlaveTwice { first } | FaultKind::CoupledTwice { first } => (2, Some(first)),
                _ => (2, None),
            };
            for i in other.into_iter().chain([fault.equation]) {
                let known = gains.entry(i).or_insert(gain);
                *known = gain.max(*known);
            }
        }
        gains
    }

    /// Records the certificate of a dependent equation, unless it has one already. Load cases are treated from last to first, so the
    /// certificate is that of the last load case in which the equation holds.
    fn note(&mut self, i: usize, rows: &[usize], analysis: &Analysis, prescribed: &PrescribedColumns) {
        let Ok(row) = rows.binary_search(&i) else { return };
        let (model, explains) = (self.model, self.explains);
        self.because.entry(i).or_insert_with(|| {
            if !explains {
                return Combination::default();
            }
            let because = analysis.because(row).unwrap_or_default();
            let equations: Vec<_> = because.iter().map(|term| (rows[term.row], term.coefficient)).collect();
            let prescribed = prescribed_difference(model, i, &equations, prescribed);
            Combination { equations, prescribed }
        });
    }

    /// Analyses these equations with the prescribed columns of a layer. Right-hand sides count, but prescribed values are taken as zero.
    pub fn analyse(&self, layer: &Layer, rows: &[usize], preferences: Preferences) -> Result<Analysis, CleanError> {
        let dof = |&column: &u32| self.model.dofs[column as usize];
        let given =
            |(column, &origin): (&u32, &Origin)| Prescribed { dof: dof(column), value: 0.0, history: 0, origin };
        let mut is_in = vec![false; self.model.equations()];
        rows.iter().for_each(|&i| is_in[i] = true);
        let removed = (0..is_in.len()).filter(|&i| !is_in[i]).map(|i| i as u32).collect();
        let case =
            LoadCase { prescribed: layer.prescribed.iter().map(given).collect(), removed, ..LoadCase::default() };
        let options = Options { preferences, ..self.options.clone() };
        Ok(analyse(&self.model.system(&case)?, &options)?)
    }

    /// Whether an equation is kept in all load cases of a layer.
    pub fn holds(&self, i: usize, layer: usize) -> bool {
        self.layer_of[i].is_some_and(|own| own <= layer)
    }

    /// The set of load cases that belong to a layer.
    pub fn cases(&self, layer: usize) -> Cases {
        if layer == 0 { Cases::All } else { Cases::UpTo(self.layers[layer].last) }
    }

    /// The faults of the equations in each layer that the solver does not accept; `is_in(i, k)` says whether equation i belongs to layer k.
    pub fn faults(&self, is_in: impl Fn(usize, usize) -> bool) -> Vec<EquationFault> {
        let count = self.model.equations();
        let in_layer = |(k, layer): (usize, &Layer)| {
            let left_out: Vec<bool> = (0..count).map(|i| !is_in(i, k)).collect();
            let faults = faults_of(self.model, &layer.prescribed, &left_out);
            let profile = Profile::without(self.solver, self.model, left_out);
            let findings = profile.outcomes(faults).into_iter();
            findings
                .filter(|finding| finding.outcome != Outcome::Accepted)
                .map(|finding| finding.fault)
                .collect::<Vec<_>>()
        };
        self.layers.iter().enumerate().flat_map(in_layer).collect()
    }
}

/// The prescribed DOFs in which equation `i` differs from the sum of these equations, each with its card.
fn prescribed_difference(
    model: &Model,
    i: usize,
    equations: &[(usize, f64)],
    prescribed: &PrescribedColumns,
) -> Vec<(Dof, Origin)> {
    let mut sums: BTreeMap<u32, (f64, f64)> = BTreeMap::new();
    for (k, factor) in equations.iter().copied().chain([(i, -1.0)]) {
        let row = model.nth(k);
        for (&j, a) in row.columns.iter().zip(row.coefficients).filter(|(j, _)| prescribed.contains_key(j)) {
            let (sum, size) = sums.entry(j).or_default();
            (*sum, *size) = (*sum + factor * a, *size + (factor * a).abs());
        }
    }
    // A comment gives coefficients in twelve digits: what is left of them in the last one is rounding.
    let differs = |&(_, (sum, size)): &(u32, (f64, f64))| sum.abs() > 1e-11 * size;
    sums.into_iter().filter(differs).map(|(j, _)| (model.dofs[j as usize], prescribed[&j])).collect()
}

/// For each equation, the last load case in which it is in force. It is an error if the equation is not in force in all earlier ones.
fn ends(model: &Model, cases: &[LoadCase]) -> Result<Vec<Option<usize>>, CleanError> {
    let mut end = vec![cases.len().checked_sub(1); model.equations()];
    for (k, case) in cases.iter().enumerate().rev() {
        for &i in &case.removed {
            if end[i as usize] != Some(k) {
                return Err(CleanError::Apart { case: case.name.clone() });
            }
            end[i as usize] = k.checked_sub(1);
        }
    }
    Ok(end)
}

/// The equations whose slave has a coefficient that is too small to divide by.
pub fn vanishing(model: &Model, prescribed: &PrescribedColumns) -> FxHashSet<usize> {
    let faults = faults_of(model, prescribed, &vec![false; model.equations()]);
    faults.iter().filter(|fault| fault.kind == FaultKind::SlaveVanishes).map(|fault| fault.equation).collect()
}

/// The columns that are not prescribed, ascending, each once.
pub fn unprescribed(columns: impl Iterator<Item = u32>, prescribed: &PrescribedColumns) -> Vec<usize> {
    let mut columns: Vec<usize> = columns.filter(|j| !prescribed.contains_key(j)).map(|j| j as usize).collect();
    columns.sort_unstable();
    columns.dedup();
    columns
}
