//! The results of one block of a changing system, in the DOF numbers of the whole system.

use super::network::Network;
use super::{ChangeError, EquationId};
use crate::{Form, Kind, Options, Reduction, SystemBuilder, analyse};

/// The results of one block. DOFs are those of the whole system.
#[derive(Clone, Debug)]
pub struct SolvedBlock {
    equations: Vec<EquationId>,
    kinds: Vec<Kind>,
    /// Certificates of the dependent equations, ascending.
    certificates: Vec<(EquationId, Vec<(EquationId, f64)>)>,
    slaves: Vec<usize>,
    masters: Vec<usize>,
    prescribed: Vec<usize>,
    reduction: Reduction,
    ambiguous: bool,
}

impl SolvedBlock {
    /// Analyses and reduces the equations of a block, which must ascend.
    pub(super) fn new(equations: &[EquationId], network: &Network, options: &Options) -> Result<Self, ChangeError> {
        let mut dofs: Vec<u32> = equations.iter().flat_map(|&id| network.terms(id)).map(|&(j, _)| j).collect();
        dofs.sort_unstable();
        dofs.dedup();
        // An equation without terms has no DOF, but a system has at least one.
        let mut builder = SystemBuilder::new(dofs.len().max(1));
        let local = |j: u32| dofs.binary_search(&j).unwrap_or_default();
        for &id in equations {
            builder.equation(network.terms(id).iter().map(|&(j, a)| (local(j), a)), network.rhs(id));
        }
        for (k, &j) in dofs.iter().enumerate() {
            network.value(j).into_iter().for_each(|value| builder.prescribe(k, value));
        }
        let system = builder.build()?;
        let analysis = analyse(&system, options)?;
        let reduction = analysis.reduction_in(Form::Auto)?;
        let certificate = |dependent: &crate::Dependent| {
            let because = analysis.because(dependent.row)?;
            let terms = because.iter().map(|term| (equations[term.row], term.coefficient));
            Ok((equations[dependent.row], terms.collect()))
        };
        let whole = |numbers: &[usize]| numbers.iter().filter_map(|&k| dofs.get(k)).map(|&j| j as usize).collect();
        Ok(Self {
            equations: equations.to_vec(),
            certificates: analysis.dependent.iter().map(certificate).collect::<Result<_, ChangeError>>()?,
            slaves: whole(&reduction.slaves),
            masters: whole(&reduction.masters),
            prescribed: whole(&reduction.prescribed),
            reduction,
            ambiguous: analysis.confidence.ambiguous,
            kinds: analysis.kinds,
        })
    }

    /// The equations of the block, ascending.
    pub fn equations(&self) -> &[EquationId] {
        &self.equations
    }

    /// The slaves u_s of the block, ascending.
    pub fn slaves(&self) -> &[usize] {
        &self.slaves
    }

    /// The masters u_q of the block, ascending.
    pub fn masters(&self) -> &[usize] {
        &self.masters
    }

    /// The prescribed DOFs u_p of the block, ascending.
    pub fn prescribed(&self) -> &[usize] {
        &self.prescribed
    }

    /// `u_s = T u_q + G u_p + g` in [`Form::Auto`]. The reduction numbers the DOFs of the block only. Its slaves, masters and prescribed
    /// DOFs have the same order as in [`SolvedBlock::slaves`], [`SolvedBlock::masters`] and [`SolvedBlock::prescribed`].
    pub fn reduction(&self) -> &Reduction {
        &self.reduction
    }

    /// Returns true if the rank is ambiguous.
    pub fn ambiguous(&self) -> bool {
        self.ambiguous
    }

    /// Rank of the equations of the block in the columns of free DOFs.
    pub fn rank(&self) -> usize {
        self.slaves.len()
    }

    pub(super) fn kind(&self, equation: EquationId) -> Option<Kind> {
        self.equations.binary_search(&equation).ok().map(|k| self.kinds[k])
    }

    pub(super) fn because(&self, equation: EquationId) -> Vec<(EquationId, f64)> {
        let found = self.certificates.binary_search_by_key(&equation, |(id, _)| *id);
        found.map_or_else(|_| Vec::new(), |k| self.certificates[k].1.clone())
    }

    /// Sets the slaves of the block in u: `u_s = T u_q + G u_p + g`.
    pub(super) fn expand(&self, u: &mut [f64]) -> Result<(), ChangeError> {
        // An equation without terms was given one DOF, which is not a DOF of the whole system.
        if self.slaves.is_empty() && self.masters.is_empty() {
            return Ok(());
        }
        let values = |dofs: &[usize]| dofs.iter().map(|&j| u[j]).collect::<Vec<f64>>();
        let own = self.reduction.expand(&values(&self.masters), &values(&self.prescribed))?;
        self.slaves.iter().zip(&self.reduction.slaves).for_each(|(&j, &k)| u[j] = own[k]);
        Ok(())
    }
}
