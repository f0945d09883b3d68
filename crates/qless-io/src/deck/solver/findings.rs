//! Finds the faults of a load case, and what a solver does about each. An equation that the solver drops has no further faults.

use rustc_hash::FxHashMap;

use super::{Outcome, Profile, ccx};
use crate::deck::faults::{EquationFault, FaultKind, faults_of};
use crate::deck::{Dof, LoadCase, Model, Origin, Solver};

/// A fault, and how the solver reacts to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Finding {
    /// The fault.
    pub fault: EquationFault,
    /// How the solver reacts to the fault.
    pub outcome: Outcome,
}

impl Finding {
    /// Describes the fault and the reaction of the solver in the terms of the deck.
    pub fn describe(&self, model: &Model, solver: Solver) -> String {
        format!("{}: {solver} {}", self.fault.describe(model), self.reaction(model))
    }

    /// Describes the reaction of the solver, as a verb with its object.
    fn reaction(&self, model: &Model) -> String {
        let equation = |i: usize| model.equation(i).map_or_else(String::new, |e| model.place(e.origin));
        match (self.outcome, self.fault.kind) {
            (Outcome::Refused, _) => "stops".into(),
            (Outcome::Accepted, _) => "accepts both".into(),
            (Outcome::Unsound, _) => "may continue, but its results are unreliable".into(),
            (Outcome::IgnoresFirst, FaultKind::SlaveTwice { first }) => {
                format!("drops this equation of {} in every step", equation(first))
            }
            (Outcome::IgnoresSecond, FaultKind::SlavePrescribed { by, .. }) => {
                format!("drops the value of {}", model.place(by))
            }
            (Outcome::IgnoresFirst | Outcome::IgnoresSecond, _) => {
                format!("drops this equation of {} in every step", equation(self.fault.equation))
            }
        }
    }

    /// The equation that the solver drops because of the fault; `None` if it drops none.
    pub fn dropped(&self) -> Option<usize> {
        match (self.outcome, self.fault.kind) {
            (Outcome::IgnoresFirst, FaultKind::SlaveTwice { first }) => Some(first),
            (Outcome::IgnoresFirst, _) | (Outcome::IgnoresSecond, FaultKind::SlaveTwice { .. }) => {
                Some(self.fault.equation)
            }
            _ => None,
        }
    }
}

impl Profile<'_> {
    /// What the solver does about each of these faults.
    pub fn outcomes(&self, faults: Vec<EquationFault>) -> Vec<Finding> {
        let is_circle = |fault: &EquationFault| fault.kind == FaultKind::Circle;
        let circle: Vec<usize> = faults.iter().filter(|fault| is_circle(fault)).map(|fault| fault.equation).collect();
        // The slaves of a circle depend on one another, so the same reaction holds for all of them.
        let round = (!circle.is_empty()).then(|| self.circle(&circle));
        let outcome = |fault: &EquationFault| round.filter(|_| is_circle(fault)).unwrap_or_else(|| self.outcome(fault));
        faults.into_iter().map(|fault| Finding { fault, outcome: outcome(&fault) }).collect()
    }
}

/// A solver's reaction to each fault of the equations in force in a load case, sorted by equation. Equations that the
/// solver drops have no further faults; those dropped in the first load case stay dropped.
///
/// ```
/// use qless_io::deck::{Outcome, Solver, clean, read};
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("bodies.inp");
/// let nodes = "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n3,0.,1.,0.\n4,1.,1.,0.\n*NSET,NSET=A\n1\n";
/// let bodies = "*RIGID BODY,NSET=A,REF NODE=2,ROT NODE=3\n*RIGID BODY,NSET=A,REF NODE=4,ROT NODE=3\n";
/// std::fs::write(&path, format!("{nodes}{bodies}"))?;
/// let deck = read(&path)?;
/// let findings = clean::findings(deck.model(), &deck.model().cases()[0], Solver::Ccx);
/// assert_eq!(findings[0].outcome, Outcome::IgnoresSecond);
/// assert_eq!(
///     findings[0].describe(deck.model(), Solver::Ccx),
///     "1:1 is the slave of line 8 *RIGID BODY, and of line 9 *RIGID BODY: \
///      ccx drops this equation of line 9 *RIGID BODY in every step"
/// );
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn findings(model: &Model, case: &LoadCase, solver: Solver) -> Vec<Finding> {
    let mut search = FaultSearch::new(model, case, solver);
    search.drop_missing();
    search.drop_prescribed();
    search.drop_shared();
    search.add_remaining();
    search.findings.sort_by_key(|finding| finding.fault.equation);
    search.findings
}

/// The search for the faults of a load case.
struct FaultSearch<'a> {
    profile: Profile<'a>,
    /// The DOFs that this load case prescribes, by column, each with its card.
    prescribed: FxHashMap<u32, Origin>,
    /// The DOFs that the first load case prescribes, by column, each with its card.
    at_start: FxHashMap<u32, Origin>,
    findings: Vec<Finding>,
}

impl<'a> FaultSearch<'a> {
    fn new(model: &'a Model, case: &'a LoadCase, solver: Solver) -> Self {
        Self {
            profile: Profile::for_case(solver, model, case),
            prescribed: model.prescribed_in([case]),
            at_start: model.prescribed_in(model.cases.first()),
            findings: Vec::new(),
        }
    }

    /// The equations in force, each with the column of its slave.
    fn slaves(&self) -> Vec<(usize, u32)> {
        let Profile { model, left_out, .. } = &self.profile;
        let kept = (0..model.equations()).filter(|&i| !left_out[i] && model.has_slave(i));
        kept.filter_map(|i| Some((i, *model.nth(i).columns.first()?))).collect()
    }

    fn dof(&self, column: u32) -> Dof {
        self.profile.model.dofs[column as usize]
    }

    /// If the solver drops an equation because of this fault, records the fault, leaves the equation out of the search, and returns it.
    fn drop_for(&mut self, fault: EquationFault) -> Option<usize> {
        let finding = Finding { fault, outcome: self.profile.outcome(&fault) };
        let dropped = finding.dropped()?;
        self.profile.left_out[dropped] = true;
        self.findings.push(finding);
        Some(dropped)
    }

    /// Leaves out the equations that the solver does not make.
    fn drop_missing(&mut self) {
        for (equation, column) in self.slaves() {
            if let Some(why) = self.profile.model.why_missing(equation) {
                self.drop_for(EquationFault { equation, slave: self.dof(column), kind: FaultKind::Missing { why } });
            }
        }
    }

    /// Leaves out the equations that the solver drops because their slave is prescribed in the first load case. A value in a later load
    /// case does not make ccx drop an equation.
    fn drop_prescribed(&mut self) {
        for (equation, column) in self.slaves() {
            if let Some(&by) = self.at_start.get(&column) {
                let kind = FaultKind::SlavePrescribed { by, since: 0 };
                self.drop_for(EquationFault { equation, slave: self.dof(column), kind });
            }
        }
    }

    /// Compares each equation with an earlier one that has the same slave and is not dropped. Leaves out one of the two if the solver drops
    /// it.
    fn drop_shared(&mut self) {
        let mut holders: FxHashMap<u32, usize> = FxHashMap::default();
        for (equation, column) in self.slaves() {
            let Some(&first) = holders.get(&column) else {
                holders.insert(column, equation);
                continue;
            };
            let slave = self.dof(column);
            if self.drop_for(EquationFault { equation, slave, kind: FaultKind::SlaveTwice { first } }) == Some(first) {
                holders.insert(column, equation);
            }
        }
    }

    /// Adds the faults of the remaining equations. In ccx, these include equations whose slave is also a slave that ccx adds for
    /// `*KINEMATIC`.
    fn add_remaining(&mut self) {
        let mut faults = faults_of(self.profile.model, &self.prescribed, &self.profile.left_out);
        if self.profile.solver == Solver::Ccx {
            let rotations: FxHashMap<Dof, usize> = ccx::rotations(self.profile.model).into_iter().collect();
            let taken = |(equation, column): (usize, u32)| {
                let slave = self.dof(column);
                let fault = |&first| EquationFault { equation, slave, kind: FaultKind::SlaveTwice { first } };
                rotations.get(&slave).map(fault)
            };
            faults.extend(self.slaves().into_iter().filter_map(taken));
        }
        self.findings.extend(self.profile.outcomes(faults));
    }
}
