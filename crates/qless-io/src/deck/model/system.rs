//! Makes `C u = b` of a load case: for its end, and for each time history of its prescribed values.
//!
//! Values with different time histories have no fixed ratio. So the equations are consistent at all times only if they are consistent for
//! the values of each history alone, with all other values zero. The converse also holds, because a sum of consistent right-hand sides is
//! consistent. One test at the end does not suffice: values may cancel at one time and conflict at all others.

use std::borrow::Borrow;

use qless::{Analysis, ConstraintSystem, Kind, SystemBuilder, SystemError};

use super::{Dof, LoadCase, Model, Prescribed};

impl Model {
    /// The system `C u = b` of a load case, labelled as in the deck. Its rows are the equations in force, then one row for each value that
    /// contradicts another one. Its columns are all DOFs of the model's equations and of these values. Prescribed values are those at the
    /// end of the load case.
    ///
    /// # Errors
    /// [`SystemError`] if coefficients of one DOF in one equation overflow when summed.
    pub fn system(&self, case: &LoadCase) -> Result<ConstraintSystem, SystemError> {
        self.system_with(case, true, |given| given.value)
    }

    /// The time histories of the nonzero prescribed values of a load case, as indices into [`Model::histories`], ascending. If there are
    /// several, the equations are consistent at all times only if [`Model::system`] and [`Model::system_of_history`] of each history are
    /// consistent.
    pub fn histories_of(&self, case: &LoadCase) -> Vec<u32> {
        let moved = case.prescribed.iter().chain(&case.clashes).filter(|given| given.value != 0.0);
        let mut histories: Vec<u32> = moved.map(|given| given.history).collect();
        histories.sort_unstable();
        histories.dedup();
        histories
    }

    /// Like [`Model::system`], but with the values of one time history alone: all other values are zero. Right-hand sides of equations are
    /// kept only for the first history of the load case, and are zero for the others.
    ///
    /// # Errors
    /// As [`Model::system`].
    pub fn system_of_history(&self, case: &LoadCase, history: u32) -> Result<ConstraintSystem, SystemError> {
        let has_rhs = self.histories_of(case).first().is_none_or(|&first| first == history);
        self.system_with(case, has_rhs, |given| if given.history == history { given.value } else { 0.0 })
    }

    /// Returns [`Model::system_of_history`] for a time history, and [`Model::system`] for `None`.
    ///
    /// # Errors
    /// As [`Model::system`].
    pub fn system_at(&self, case: &LoadCase, history: Option<u32>) -> Result<ConstraintSystem, SystemError> {
        history.map_or_else(|| self.system(case), |history| self.system_of_history(case, history))
    }

    /// Analyses a load case at its end. If equations are redundant there and prescribed values have several time histories, also analyses
    /// the values of each history alone. If the values of some history conflict, although all values at the end do not, returns the first
    /// such history and its analysis. Otherwise returns `None` and the analysis at the end. `analyse` receives the history for
    /// [`Model::system_at`].
    ///
    /// # Errors
    /// Those of `analyse`.
    pub fn at_all_times<T: Borrow<Analysis>, E>(
        &self,
        case: &LoadCase,
        mut analyse: impl FnMut(Option<u32>) -> Result<T, E>,
    ) -> Result<(Option<u32>, T), E> {
        let conflicts = |analysis: &Analysis| analysis.dependent().iter().any(|found| found.kind == Kind::Conflicting);
        let at_end = analyse(None)?;
        let (histories, found) = (self.histories_of(case), at_end.borrow());
        // If all equations are independent, they are consistent with every right-hand side, so this test is not needed.
        if histories.len() > 1 && !found.dependent().is_empty() && !conflicts(found) {
            for history in histories {
                let alone = analyse(Some(history))?;
                if conflicts(alone.borrow()) {
                    return Ok((Some(history), alone));
                }
            }
        }
        Ok((None, at_end))
    }

    fn system_with(
        &self,
        case: &LoadCase,
        has_rhs: bool,
        value: impl Fn(&Prescribed) -> f64,
    ) -> Result<ConstraintSystem, SystemError> {
        let extra = self.clashing_alone(case);
        let column = |dof: Dof| match self.column(dof) {
            Some(j) => Some(j as usize),
            None => extra.binary_search(&dof).ok().map(|k| self.dofs.len() + k),
        };
        // A system needs at least one DOF, so a deck without constraints gets a free DOF.
        let dofs = self.dofs.len() + extra.len();
        let mut builder = SystemBuilder::new(dofs.max(1));
        for i in self.in_force(case) {
            let equation = self.nth(i);
            let terms = equation.columns.iter().zip(equation.coefficients).filter(|(_, a)| **a != 0.0);
            let rhs = if has_rhs { equation.rhs } else { 0.0 };
            builder.labelled_equation(self.label_of(i), terms.map(|(&j, &a)| (j as usize, a)), rhs);
        }
        for clash in &case.clashes {
            let label = format!("{} {}", self.place(clash.origin), self.dof_name(clash.dof));
            builder.labelled_equation(label, [(column(clash.dof).unwrap_or_default(), 1.0)], value(clash));
        }
        for given in &case.prescribed {
            if let Some(j) = column(given.dof) {
                builder.prescribe_at(self.place(given.origin), j, value(given));
            }
        }
        if dofs > 0 {
            builder.dof_labels(self.dofs.iter().chain(&extra).map(|&dof| self.dof_name(dof)).collect());
        }
        builder.build()
    }

    /// The DOFs that have contradicting values but occur in no equation.
    fn clashing_alone(&self, case: &LoadCase) -> Vec<Dof> {
        let clashing = case.clashes.iter().map(|clash| clash.dof);
        let mut alone: Vec<Dof> = clashing.filter(|&dof| self.column(dof).is_none()).collect();
        alone.sort_unstable();
        alone.dedup();
        alone
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use qless::{Options, analyse};

    use super::*;
    use crate::deck::Origin;

    /// A model of `u1 = u2` in which both DOFs have prescribed values. Each pair holds a value and its time history.
    fn two_ends(values: [(f64, u32); 2]) -> (Model, LoadCase) {
        let mut model = Model::new(vec![PathBuf::from("ends.inp")]);
        let card = model.card("*EQUATION", 0, 1);
        let origin = Origin { card, line: 1, lines: 1 };
        let dof = |node| Dof { node, component: 1 };
        model.push([(dof(1), 1.0), (dof(2), -1.0)], 0.0, origin);
        let given = |(node, (value, history))| Prescribed { dof: dof(node), value, history, origin };
        let prescribed = [1, 2].into_iter().zip(values).map(given).collect();
        (model, LoadCase { name: "step 1".into(), prescribed, ..LoadCase::default() })
    }

    fn kind(system: &ConstraintSystem) -> Kind {
        analyse(system, &Options::default()).expect("an analysis").kinds()[0]
    }

    #[test]
    fn values_that_agree_at_the_end_conflict_on_the_way_there() {
        let (model, case) = two_ends([(1.0, 0), (1.0, 1)]);
        assert_eq!(kind(&model.system(&case).expect("a system")), Kind::Redundant);
        assert_eq!(model.histories_of(&case), [0, 1]);
        for history in [0, 1] {
            assert_eq!(kind(&model.system_of_history(&case, history).expect("a system")), Kind::Conflicting);
        }
        let analysed = |history| analyse(&model.system_at(&case, history).expect("a system"), &Options::default());
        let (history, found) = model.at_all_times(&case, analysed).expect("an analysis");
        assert_eq!((history, found.kinds()[0]), (Some(0), Kind::Conflicting));
    }

    #[test]
    fn a_single_history_gives_the_same_system() {
        for values in [[(1.0, 1), (1.0, 1)], [(2.0, 0), (2.0, 0)], [(1.0, 0), (0.0, 1)]] {
            let (model, case) = two_ends(values);
            let [history] = model.histories_of(&case)[..] else { panic!("one history") };
            let whole = model.system(&case).expect("a system");
            assert_eq!(model.system_of_history(&case, history).expect("a system"), whole);
            let analysed = |history| analyse(&model.system_at(&case, history).expect("a system"), &Options::default());
            assert_eq!(model.at_all_times(&case, analysed).expect("an analysis").0, None);
        }
        let (model, case) = two_ends([(0.0, 0), (0.0, 1)]);
        assert!(model.histories_of(&case).is_empty());
    }
}
