//! Predicts what each solver does with the faults of a deck.

mod ccx;
mod findings;
mod loss;
mod manuals;
mod outcome;

use std::cell::OnceCell;

use rustc_hash::{FxHashMap, FxHashSet};

use super::faults::{EquationFault, FaultKind, keeps_slaves};
use super::{Dof, LoadCase, Model, Solver};
pub use findings::{Finding, findings};
pub use loss::{Loss, loss};
use manuals::{Eliminations, abaqus_prescribed, abaqus_twice, lsdyna_prescribed, optistruct};
pub(super) use outcome::CardKind;
pub use outcome::Outcome;

impl Solver {
    /// Predicts what the solver does about a fault. For all faults of a load case use [`clean::findings`](super::clean::findings): it also
    /// knows which claims remain after the solver has dropped others.
    ///
    /// ```
    /// use qless_io::deck::{Outcome, Solver, clean, read};
    /// # let place = tempfile::tempdir()?;
    /// let path = place.path().join("tie.inp");
    /// std::fs::write(&path, "*BOUNDARY\n1,1\n*EQUATION\n2\n1,1,1.,2,1,-1.\n")?;
    /// let deck = read(&path)?;
    /// let fault = &clean::faults(deck.model())[0];
    /// assert_eq!(Solver::Ccx.outcome(fault, deck.model()), Outcome::Refused);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn outcome(self, fault: &EquationFault, model: &Model) -> Outcome {
        Profile::new(self, model).outcome(fault)
    }

    /// Predicts what the solver does about two values for one DOF in one step. The first claim is the first value.
    ///
    /// CalculiX and ANSYS take the last value. The other solvers are reported to stop: Nastran and MYSTRAN if the
    /// values differ, Abaqus if both cards are in one step. What LS-DYNA does is not known. Radioss warns
    /// that the conditions may be incompatible, and continues.
    pub fn prescribed_twice(self) -> Outcome {
        match self {
            Self::Ccx | Self::Ansys => Outcome::IgnoresFirst,
            Self::Abaqus | Self::Nastran | Self::Mystran | Self::Optistruct => Outcome::Refused,
            Self::LsDyna | Self::Radioss => Outcome::Unsound,
        }
    }
}

/// A solver and a deck, with properties of the deck that are computed only once.
pub(super) struct Profile<'a> {
    pub solver: Solver,
    pub model: &'a Model,
    /// The load cases whose prescribed DOFs count.
    cases: &'a [LoadCase],
    /// For each equation, whether it is not in force.
    pub left_out: Vec<bool>,
    chain: OnceCell<bool>,
    eliminations: OnceCell<Eliminations>,
}

impl<'a> Profile<'a> {
    /// The profile for all load cases of a deck.
    pub fn new(solver: Solver, model: &'a Model) -> Self {
        Self::without(solver, model, vec![false; model.equations()])
    }

    /// The profile for all load cases of a deck, if the equations marked in `left_out` are not in force.
    pub fn without(solver: Solver, model: &'a Model, left_out: Vec<bool>) -> Self {
        let cases = &model.cases;
        Self { solver, model, cases, left_out, chain: OnceCell::new(), eliminations: OnceCell::new() }
    }

    /// The profile for one load case, without the equations that it removes.
    pub fn for_case(solver: Solver, model: &'a Model, case: &'a LoadCase) -> Self {
        let mut profile = Self { cases: std::slice::from_ref(case), ..Self::new(solver, model) };
        case.removed.iter().for_each(|&i| profile.left_out[i as usize] = true);
        profile
    }

    /// What the solver does about a fault.
    pub fn outcome(&self, fault: &EquationFault) -> Outcome {
        let EquationFault { equation, slave, kind } = *fault;
        match kind {
            FaultKind::SlavePrescribed { since, .. } => self.prescribed(equation, slave, since),
            FaultKind::SlaveTwice { first } => self.twice(first, equation),
            FaultKind::SlaveVanishes => self.vanishes(equation),
            // The answer holds for ANSYS and Nastran: coupled sets occur only in ANSYS decks, and sets of DOFs that exclude each other only
            // in Nastran decks.
            FaultKind::CoupledTwice { .. } | FaultKind::SlaveClaimed { .. } => Outcome::Refused,
            FaultKind::CoupledPrescribed { .. } => self.coupled(equation),
            FaultKind::MasterTwice { .. } => match self.solver {
                Solver::Ccx => Outcome::Unsound,
                _ => Outcome::Accepted,
            },
            FaultKind::Missing { .. } => Outcome::IgnoresFirst,
            FaultKind::Circle => self.circle(&connected(self.model, equation)),
        }
    }

    /// What the solver does about equations whose slaves depend on one another in a circle.
    pub fn circle(&self, equations: &[usize]) -> Outcome {
        match self.solver {
            Solver::Ansys => self.ansys(equations),
            Solver::LsDyna | Solver::Radioss => Outcome::Unsound,
            Solver::Ccx if keeps_slaves(self.model, equations) == Some(true) => Outcome::Unsound,
            _ => Outcome::Refused,
        }
    }

    /// The kind of the card from which an equation comes.
    pub fn kind(&self, equation: usize) -> CardKind {
        CardKind::from_name(&self.model.cards.nth(self.model.nth(equation).origin.card).name)
    }

    fn prescribed(&self, equation: usize, slave: Dof, since: usize) -> Outcome {
        let kind = self.kind(equation);
        match self.solver {
            Solver::Ccx => {
                let chain = || *self.chain.get_or_init(|| ccx::nonlinear_chain(self.model, &self.left_out));
                let is_compared = since > 0 && ccx::compares_again(self.model, equation, slave, since, chain);
                ccx::prescribed(kind, since > 0, is_compared)
            }
            Solver::Abaqus => abaqus_prescribed(kind),
            Solver::Nastran | Solver::Mystran => Outcome::Refused,
            Solver::Optistruct => optistruct(&[kind], self.model),
            Solver::Ansys if kind == CardKind::CoupledSet => self.coupled(equation),
            Solver::Ansys => self.ansys(&[equation]),
            Solver::LsDyna => lsdyna_prescribed(kind),
            Solver::Radioss => Outcome::Unsound,
        }
    }

    fn twice(&self, first: usize, second: usize) -> Outcome {
        let kinds = [self.kind(first), self.kind(second)];
        match self.solver {
            Solver::Ccx => ccx::twice(kinds[0], kinds[1]),
            Solver::Abaqus => abaqus_twice(kinds[0], kinds[1]),
            Solver::Nastran | Solver::Mystran => Outcome::Refused,
            Solver::Optistruct => optistruct(&kinds, self.model),
            Solver::Ansys => self.ansys(&[first, second]),
            Solver::LsDyna | Solver::Radioss => Outcome::Unsound,
        }
    }

    /// What the solver does about a slave with a small or zero coefficient. ccx checks only a sum of repeated terms for zero, and divides
    /// by any other coefficient. ANSYS may eliminate another DOF. What LS-DYNA does is not known. The other solvers refuse zero, and divide
    /// by a small coefficient.
    fn vanishes(&self, equation: usize) -> Outcome {
        let row = self.model.nth(equation);
        let terms = row.columns.iter().zip(row.coefficients);
        let of_slave = terms.filter(|(j, _)| Some(*j) == row.columns.first());
        let (count, own) = of_slave.fold((0, 0.0), |(count, sum), (_, a)| (count + 1, sum + a));
        match self.solver {
            Solver::Ansys => self.ansys(&[equation]),
            Solver::Ccx if count < 2 => Outcome::Unsound,
            Solver::LsDyna | Solver::Radioss => Outcome::Unsound,
            _ if own == 0.0 => Outcome::Refused,
            _ => Outcome::Unsound,
        }
    }

    fn eliminations(&self) -> &Eliminations {
        self.eliminations.get_or_init(|| Eliminations::find(self.model, self.cases, &self.left_out))
    }

    /// What ANSYS does about a fault of these equations. Coupled sets are joined before equations eliminate DOFs, so only the others must
    /// find one; two coupled sets must not share a DOF.
    fn ansys(&self, equations: &[usize]) -> Outcome {
        let others: Vec<usize> = equations.iter().copied().filter(|&i| self.kind(i) != CardKind::CoupledSet).collect();
        if others.is_empty() { Outcome::Refused } else { self.eliminations().outcome(&others) }
    }

    /// What the solver does about the coupled set of an equation if a DOF of the set is prescribed.
    fn coupled(&self, equation: usize) -> Outcome {
        self.eliminations().of_set(self.model.nth(equation).origin.card)
    }
}

/// An equation, together with all equations on whose slaves it depends, directly or indirectly.
fn connected(model: &Model, equation: usize) -> Vec<usize> {
    let slave = |i: usize| model.nth(i).columns.first().copied();
    let mut slaves: FxHashMap<u32, usize> = FxHashMap::default();
    for i in (0..model.equations()).rev() {
        slaves.extend(slave(i).map(|j| (j, i)));
    }
    let mut found = vec![equation];
    let mut known: FxHashSet<usize> = found.iter().copied().collect();
    let mut next = 0;
    while next < found.len() {
        let masters = model.nth(found[next]).columns.iter().filter_map(|j| slaves.get(j).copied());
        found.extend(masters.filter(|&i| known.insert(i)));
        next += 1;
    }
    found.sort_unstable();
    found
}
