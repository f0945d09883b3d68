//! What a DOF is: a displacement, `x = at + u`, or part of a rotation. All constraints must say the same of one DOF.
//!
//! A body is copied into every joint. If one copy had another place, or other rotation DOFs, the joints would be about two bodies that
//! share DOFs, and no later check could tell. So each constraint states what its DOFs are, and a statement that differs is refused.
//! The coordinates also bound how well a DOF is known, for the analysis of rounding errors.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use crate::geometry::node::ROUNDING;
use crate::scalar::Bounded;

/// Fills unused entries of lists of DOFs.
pub const NO_DOF: u32 = u32::MAX;

/// What a constraint states about some DOFs: the coordinates that they displace, or that they are a rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DofStatement {
    /// The DOFs displace a node or body from `at`. If `measured`, the parameters of the equations hold only differences of coordinates;
    /// the rounding errors of the coordinates then count as errors of the DOFs.
    Place { dofs: [u32; 3], at: [f64; 3], measured: bool },
    /// The DOFs of a rotation: those of a rotation vector, followed by [`NO_DOF`], or those of four Euler parameters.
    Rotation([u32; 4]),
}

/// What one DOF is: a displacement, or part of a rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
enum DofUse {
    /// The DOF displaces the coordinate `at` of a node. `node` is the largest magnitude of the node's coordinates.
    Displacement {
        at: f64,
        node: f64,
    },
    Rotation([u32; 4]),
}

impl DofStatement {
    /// Each DOF, its use, and whether the rounding errors of its coordinate count as errors of the DOF (`measured`). A statement about a
    /// rotation always counts as measured.
    fn uses(&self) -> impl Iterator<Item = (u32, DofUse, bool)> {
        let (dofs, at, measured) = match *self {
            Self::Place { dofs: [x, y, z], at, measured } => ([x, y, z, NO_DOF], Some(at), measured),
            Self::Rotation(dofs) => (dofs, None, true),
        };
        let node = at.map_or(0.0, |at| at.iter().fold(0.0, |most: f64, x| most.max(x.abs())));
        let used = move |k: usize| at.map_or(DofUse::Rotation(dofs), |at| DofUse::Displacement { at: at[k], node });
        (0..4).filter(move |&k| dofs[k] != NO_DOF).map(move |k| (dofs[k], used(k), measured))
    }
}

/// The use of a DOF, and the number of statements about it.
#[derive(Clone, Copy)]
struct DofRecord {
    used: DofUse,
    statements: u32,
    /// Number of statements of active constraints by which the rounding errors of the DOF's coordinate count as errors of the DOF.
    measured: u32,
}

/// Two statements about one DOF that differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DofClash {
    /// The statements give the DOF two coordinates, the new one first.
    Places([f64; 2]),
    /// The statements give the rotation of the DOF different lists of DOFs.
    Rotations,
    /// One statement says that the DOF is a displacement, the other that it is part of a rotation.
    Uses,
}

/// What the constraints state about DOFs ([`DofStatement`]): a list for each constraint, and one merged record for each DOF.
#[derive(Default)]
pub struct DofUses {
    statements: Vec<Box<[DofStatement]>>,
    records: BTreeMap<u32, DofRecord>,
}

impl DofUses {
    /// Stores the statements of a constraint that has none yet. If two statements about one DOF differ, returns this DOF, and stores none.
    pub fn enter(&mut self, constraint: u32, list: Vec<DofStatement>) -> Result<(), (u32, DofClash)> {
        let uses = || list.iter().flat_map(DofStatement::uses);
        for (k, (dof, used, measured)) in uses().enumerate() {
            if let Err(clash) = self.count(dof, used, measured) {
                uses().take(k).for_each(|(dof, _, measured)| self.discount(dof, measured));
                return Err((dof, clash));
            }
        }
        if !list.is_empty() {
            let place = constraint as usize;
            self.statements.resize_with(self.statements.len().max(place + 1), Box::default);
            self.statements[place] = list.into();
        }
        Ok(())
    }

    fn count(&mut self, dof: u32, used: DofUse, measured: bool) -> Result<(), DofClash> {
        let record = self.records.entry(dof).or_insert(DofRecord { used, statements: 0, measured: 0 });
        compare(record.used, used)?;
        record.statements += 1;
        record.measured += u32::from(measured);
        Ok(())
    }

    fn discount(&mut self, dof: u32, measured: bool) {
        if let Entry::Occupied(mut record) = self.records.entry(dof) {
            let known = record.get_mut();
            known.statements -= 1;
            known.measured -= u32::from(measured && known.measured > 0);
            if known.statements == 0 {
                record.remove();
            }
        }
    }

    /// Removes and returns the statements of a constraint. `active` says whether the constraint is active: `DofRecord::measured` counts
    /// only active constraints, so only then is it reduced.
    pub fn take(&mut self, constraint: u32, active: bool) -> Vec<DofStatement> {
        let list = self.statements.get_mut(constraint as usize).map(std::mem::take).unwrap_or_default();
        let uses = list.iter().flat_map(DofStatement::uses);
        uses.for_each(|(dof, _, measured)| self.discount(dof, measured && active));
        list.into_vec()
    }

    /// Adds the `measured` statements of a constraint to the counts in `DofRecord::measured` if it becomes active, or subtracts them if it
    /// becomes inactive.
    pub fn activate(&mut self, constraint: u32, active: bool) {
        let Self { statements, records } = self;
        let list = statements.get(constraint as usize).map_or(&[][..], |list| list);
        for (dof, _, _) in list.iter().flat_map(DofStatement::uses).filter(|(.., measured)| *measured) {
            let by = if active { 1 } else { -1 };
            let record = records.get_mut(&dof).into_iter();
            record.for_each(|record| record.measured = record.measured.saturating_add_signed(by));
        }
    }

    /// The first constraint with a statement about a DOF.
    pub fn constraint_with(&self, dof: u32) -> Option<usize> {
        let names = |list: &[DofStatement]| list.iter().flat_map(DofStatement::uses).any(|(other, ..)| other == dof);
        self.statements.iter().position(|list| names(list))
    }

    /// The DOFs of the rotation of each body: those of a rotation vector, followed by [`NO_DOF`], or of four Euler parameters. Sorted by
    /// first DOF.
    pub fn rotations(&self) -> impl Iterator<Item = [u32; 4]> + '_ {
        self.records.iter().filter_map(|(&dof, record)| match record.used {
            DofUse::Rotation(dofs) if dofs[0] == dof => Some(dofs),
            _ => None,
        })
    }

    /// Whether a constraint states a rotation with this DOF.
    pub fn states_rotation(&self, constraint: u32, dof: u32) -> bool {
        let list = self.statements.get(constraint as usize).map_or(&[][..], |list| list);
        list.iter().any(|statement| matches!(statement, DofStatement::Rotation(dofs) if dofs.contains(&dof)))
    }

    /// Number of statements about a DOF.
    pub fn statements_of(&self, dof: u32) -> u32 {
        self.records.get(&dof).map_or(0, |record| record.statements)
    }

    /// Two sizes of DOF j, from which its rounding error is estimated: `|x|` of the coordinate x that it displaces, and the largest `|x|`
    /// of its node. Both are 1 for a rotation. `None` if no active constraint has a `measured` statement about the DOF.
    pub fn sizes(&self, j: usize) -> Option<[f64; 2]> {
        let record = self.records.get(&u32::try_from(j).ok()?).filter(|record| record.measured > 0)?;
        Some(match record.used {
            DofUse::Displacement { at, node } => [at.abs(), node],
            DofUse::Rotation(_) => [1.0; 2],
        })
    }
}

/// Compares two uses of a DOF. Coordinates may differ by the rounding of the node's largest coordinate.
fn compare(known: DofUse, new: DofUse) -> Result<(), DofClash> {
    match (known, new) {
        (DofUse::Displacement { at: there, node: a }, DofUse::Displacement { at: here, node: b }) => {
            let near = (there - here).abs() <= ROUNDING * a.max(b);
            if near { Ok(()) } else { Err(DofClash::Places([here, there])) }
        }
        (DofUse::Rotation(a), DofUse::Rotation(b)) => (a == b).then_some(()).ok_or(DofClash::Rotations),
        _ => Err(DofClash::Uses),
    }
}

/// DOF values together with their uncertainty.
pub struct UncertainDofs<'a> {
    pub u: &'a [f64],
    pub uses: &'a DofUses,
}

impl UncertainDofs<'_> {
    /// The value of DOF j with its error bound.
    pub fn dof(&self, j: u32) -> Bounded {
        let (u, at) = (self.u[j as usize], self.uses.sizes(j as usize).map_or(0.0, |[at, _]| at));
        Bounded::known_to(u, u.abs() + at)
    }
}

/// The error bound of a computed number; infinite if it is NaN.
///
/// The bound is doubled, because a Jacobian written by hand sums the same terms in another order than [`crate::Nonlinear::value`].
pub fn bound(x: Bounded) -> f64 {
    if x.error.is_nan() { f64::INFINITY } else { 2.0 * x.error }
}
