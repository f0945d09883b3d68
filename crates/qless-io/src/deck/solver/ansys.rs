//! ANSYS, from its Modeling and Meshing Guide, "Coupling and Constraint Equations". It has not been run.
//!
//! Of a constraint equation the first DOF goes that is in no other equation, in no coupled set and not prescribed. A coupled DOF must
//! be in one set only, and not prescribed.

use rustc_hash::FxHashMap;

use crate::deck::{LoadCase, Model, Outcome};

use super::kind::Kind;

/// How many equations name a column.
pub struct Uses(FxHashMap<u32, u32>);

impl Uses {
    /// Counts those that are not left out, and what these load cases prescribe.
    pub fn of(model: &Model, cases: &[LoadCase], left_out: &[bool]) -> Self {
        let mut uses = FxHashMap::default();
        for i in (0..model.equations()).filter(|&i| !left_out[i]) {
            let mut columns = model.nth(i).columns.to_vec();
            columns.sort_unstable();
            columns.dedup();
            columns.into_iter().for_each(|j| *uses.entry(j).or_default() += 1);
        }
        // A prescribed DOF is no more an equation's own than a shared one.
        for given in cases.iter().flat_map(|case| &case.prescribed) {
            if let Some(j) = model.column(given.dof) {
                *uses.entry(j).or_default() += 2;
            }
        }
        Self(uses)
    }

    /// Whether an equation has a DOF that is its own.
    fn has_own(&self, model: &Model, equation: usize) -> bool {
        let equation = model.nth(equation);
        let mut terms = equation.columns.iter().zip(equation.coefficients);
        terms.any(|(j, a)| *a != 0.0 && self.0.get(j) == Some(&1))
    }
}

/// What becomes of these equations, which are at fault.
pub fn outcome(model: &Model, uses: &Uses, equations: &[(usize, Kind)]) -> Outcome {
    let finds = |&(i, kind): &(usize, Kind)| kind != Kind::CoupledSet && uses.has_own(model, i);
    if equations.iter().all(finds) { Outcome::Accepted } else { Outcome::Refused }
}
