//! The graph of equations and DOFs, and the equations that changed since the last update.

use std::collections::BTreeSet;

use super::{ChangeError, EquationId};
use crate::common::identity::Identity;

const NO_BLOCK: u32 = u32::MAX;

#[derive(Debug)]
struct NetworkEquation {
    /// Nonzero terms, ascending by DOF, each DOF once.
    terms: NetworkTerms,
    rhs: f64,
    /// Index of the block that contains the equation.
    block: u32,
}

#[derive(Debug)]
pub(super) struct Network {
    identity: Identity,
    equations: Vec<Option<NetworkEquation>>,
    count: usize,
    /// For each DOF, the equations that contain it.
    on_dof: Vec<Vec<u32>>,
    prescribed: Vec<Option<f64>>,
    /// Equations that were added or changed since the last update, or whose DOFs were prescribed or released.
    touched: BTreeSet<u32>,
    /// Blocks that contained an equation before it was removed or its terms changed.
    stale: BTreeSet<u32>,
}

/// The equations and blocks that an update has to analyse again.
pub(super) struct Region {
    /// The equations, ascending.
    pub equations: Vec<EquationId>,
    pub blocks: Vec<u32>,
}

/// Terms of an equation, as `(DOF, coefficient)`.
type NetworkTerms = Box<[(u32, f64)]>;

impl Network {
    pub fn new(dofs: usize) -> Result<Self, ChangeError> {
        let too_many = || ChangeError::TooMany { what: "DOFs", found: dofs };
        if dofs >= u32::MAX as usize {
            return Err(too_many());
        }
        let (mut on_dof, mut prescribed) = (Vec::new(), Vec::new());
        on_dof.try_reserve_exact(dofs).map_err(|_| too_many())?;
        prescribed.try_reserve_exact(dofs).map_err(|_| too_many())?;
        on_dof.resize_with(dofs, Vec::new);
        prescribed.resize(dofs, None);
        Ok(Self {
            identity: Identity::new(),
            equations: Vec::new(),
            count: 0,
            on_dof,
            prescribed,
            touched: BTreeSet::new(),
            stale: BTreeSet::new(),
        })
    }

    /// The number of an equation; an error if the equation was removed or belongs to another set.
    pub fn number(&self, id: EquationId) -> Result<u32, ChangeError> {
        self.own(id)?;
        if self.get(id.number).is_some() { Ok(id.number) } else { Err(ChangeError::Gone(id.number)) }
    }

    fn own(&self, id: EquationId) -> Result<(), ChangeError> {
        if id.set == self.identity { Ok(()) } else { Err(ChangeError::Foreign(id.number)) }
    }

    fn id(&self, number: u32) -> EquationId {
        EquationId { set: self.identity, number }
    }

    pub fn add(&mut self, terms: Vec<(usize, f64)>, rhs: f64) -> Result<EquationId, ChangeError> {
        let terms = self.checked(terms)?;
        finite(rhs)?;
        let found = self.equations.len() + 1;
        let id = u32::try_from(found - 1).map_err(|_| ChangeError::TooMany { what: "equations", found })?;
        terms.iter().for_each(|&(j, _)| self.on_dof[j as usize].push(id));
        self.equations.push(Some(NetworkEquation { terms, rhs, block: NO_BLOCK }));
        self.touched.insert(id);
        self.count += 1;
        Ok(self.id(id))
    }

    pub fn remove(&mut self, id: EquationId) -> Result<(), ChangeError> {
        self.own(id)?;
        let equation = self.equations.get_mut(id.number as usize).and_then(Option::take);
        let equation = equation.ok_or(ChangeError::Gone(id.number))?;
        self.leave(id, &equation.terms);
        self.touched.remove(&id.number);
        if equation.block != NO_BLOCK {
            self.stale.insert(equation.block);
        }
        self.count -= 1;
        Ok(())
    }

    pub fn set_rhs(&mut self, id: EquationId, rhs: f64) -> Result<(), ChangeError> {
        finite(rhs)?;
        self.get_mut(id)?.rhs = rhs;
        self.touched.insert(id.number);
        Ok(())
    }

    pub fn set_terms(&mut self, id: EquationId, terms: Vec<(usize, f64)>) -> Result<(), ChangeError> {
        let terms = self.checked(terms)?;
        let equation = self.get_mut(id)?;
        let old = std::mem::replace(&mut equation.terms, terms.clone());
        let block = equation.block;
        self.leave(id, &old);
        terms.iter().for_each(|&(j, _)| self.on_dof[j as usize].push(id.number));
        self.touched.insert(id.number);
        if block != NO_BLOCK {
            self.stale.insert(block);
        }
        Ok(())
    }

    /// Prescribes a DOF, or releases it.
    pub fn prescribe(&mut self, dof: usize, value: Option<f64>) -> Result<(), ChangeError> {
        value.map_or(Ok(()), finite)?;
        let dofs = self.dofs();
        let place = self.prescribed.get_mut(dof).ok_or(ChangeError::DofOutOfRange { dof, dofs })?;
        if *place != value {
            *place = value;
            self.touched.extend(&self.on_dof[dof]);
        }
        Ok(())
    }

    fn leave(&mut self, id: EquationId, terms: &[(u32, f64)]) {
        for &(j, _) in terms {
            self.on_dof[j as usize].retain(|&other| other != id.number);
        }
    }

    fn checked(&self, mut terms: Vec<(usize, f64)>) -> Result<NetworkTerms, ChangeError> {
        for &(dof, a) in &terms {
            finite(a)?;
            if dof >= self.dofs() {
                return Err(ChangeError::DofOutOfRange { dof, dofs: self.dofs() });
            }
        }
        terms.sort_by_key(|&(dof, _)| dof);
        terms.dedup_by(|next, kept| {
            let same = next.0 == kept.0;
            kept.1 += if same { next.1 } else { 0.0 };
            same
        });
        terms.iter().try_for_each(|&(_, a)| finite(a))?;
        Ok(terms.into_iter().filter(|(_, a)| *a != 0.0).map(|(dof, a)| (dof as u32, a)).collect())
    }

    fn get_mut(&mut self, id: EquationId) -> Result<&mut NetworkEquation, ChangeError> {
        self.own(id)?;
        self.equations.get_mut(id.number as usize).and_then(Option::as_mut).ok_or(ChangeError::Gone(id.number))
    }

    fn get(&self, id: u32) -> Option<&NetworkEquation> {
        self.equations.get(id as usize).and_then(Option::as_ref)
    }

    pub fn terms(&self, id: EquationId) -> &[(u32, f64)] {
        self.get(id.number).map_or(&[], |equation| &equation.terms)
    }

    pub fn rhs(&self, id: EquationId) -> f64 {
        self.get(id.number).map_or(0.0, |equation| equation.rhs)
    }

    /// The value of a prescribed DOF.
    pub fn value(&self, dof: u32) -> Option<f64> {
        self.prescribed[dof as usize]
    }

    /// All prescribed DOFs with their values.
    pub fn prescribed_dofs(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.prescribed.iter().enumerate().filter_map(|(dof, value)| value.map(|value| (dof, value)))
    }

    pub fn dofs(&self) -> usize {
        self.on_dof.len()
    }

    pub fn equations(&self) -> usize {
        self.count
    }

    pub fn place_of(&self, id: EquationId) -> Option<u32> {
        self.own(id).ok()?;
        self.get(id.number).map(|equation| equation.block).filter(|&block| block != NO_BLOCK)
    }

    /// Sets the block index of some equations.
    pub fn place(&mut self, equations: &[EquationId], place: u32) {
        for &id in equations {
            if let Some(equation) = self.equations[id.number as usize].as_mut() {
                equation.block = place;
            }
        }
    }

    /// Forgets the changes after an update.
    pub fn clear_changes(&mut self) {
        self.touched.clear();
        self.stale.clear();
    }

    /// What an update has to analyse again: the changed equations, all equations of the blocks that contain or contained them, and all
    /// equations that are connected with these now.
    pub fn region<'a>(&self, members: &dyn Fn(u32) -> Option<&'a [EquationId]>) -> Region {
        let mut blocks = self.stale.clone();
        let mut equations = self.touched.clone();
        let mut waiting: Vec<u32> = equations.iter().copied().collect();
        let take = |block: u32, equations: &mut BTreeSet<u32>, waiting: &mut Vec<u32>| {
            for id in members(block).unwrap_or_default() {
                if self.get(id.number).is_some() && equations.insert(id.number) {
                    waiting.push(id.number);
                }
            }
        };
        self.stale.iter().for_each(|&block| take(block, &mut equations, &mut waiting));
        while let Some(id) = waiting.pop() {
            let Some(equation) = self.get(id) else { continue };
            if equation.block != NO_BLOCK && blocks.insert(equation.block) {
                take(equation.block, &mut equations, &mut waiting);
            }
            for &(j, _) in equation.terms.iter().filter(|(j, _)| self.value(*j).is_none()) {
                for &other in &self.on_dof[j as usize] {
                    if equations.insert(other) {
                        waiting.push(other);
                    }
                }
            }
        }
        let equations = equations.into_iter().map(|number| self.id(number)).collect();
        Region { equations, blocks: blocks.into_iter().collect() }
    }

    /// Splits equations into parts that are connected by free DOFs. The equations of a part ascend, and so do the first equations of the
    /// parts.
    pub fn parts(&self, equations: &[EquationId]) -> Vec<Vec<EquationId>> {
        let mut remaining: std::collections::HashSet<u32> = equations.iter().map(|id| id.number).collect();
        let mut parts = Vec::new();
        for &EquationId { number: first, .. } in equations {
            if !remaining.remove(&first) {
                continue;
            }
            let (mut part, mut waiting) = (Vec::new(), vec![first]);
            while let Some(id) = waiting.pop() {
                part.push(self.id(id));
                for &(j, _) in self.terms(self.id(id)).iter().filter(|(j, _)| self.value(*j).is_none()) {
                    waiting.extend(self.on_dof[j as usize].iter().filter(|other| remaining.remove(other)));
                }
            }
            part.sort_unstable();
            parts.push(part);
        }
        parts
    }
}

fn finite(value: f64) -> Result<(), ChangeError> {
    if value.is_finite() { Ok(()) } else { Err(ChangeError::NotFinite(value)) }
}
