//! Computes the rows of `[T G g]` by substitution, from the last row of the [`Basis`] to the first.
//!
//! If the equation of a slave contains no other slave, its row is the row of the basis, which is not copied.

use std::borrow::Cow;

use super::retry::CheckRules;
use crate::input::numbering::LocalSystem;
use crate::input::preferences::SlavePreferences;
use crate::input::scale::{Scaling, ldexp};
use crate::presolve::basis::{Basis, BasisRow};

/// A sum below this, relative to its largest term, is rounding.
const NOISE: f64 = 1e-14;

/// The data of an analysis for a reduction.
pub(crate) struct ReductionInput<'a> {
    pub basis: &'a Basis,
    /// Bounds of the rows of T; infinite for rows that need substitution.
    pub bounds: &'a [f64],
    /// For each local DOF, true if it is fixed; empty if none is.
    pub fixed: Vec<bool>,
    pub preferences: SlavePreferences,
    /// The bound of growth `max |T_ij|`.
    pub growth: f64,
    pub scaling: &'a Scaling,
    /// For each equation, true if it is independent.
    pub independent: Vec<bool>,
    /// Bytes that a sparse factorization may allocate.
    pub memory: usize,
}

impl ReductionInput<'_> {
    /// How the reduction is checked.
    pub fn rules(&self) -> CheckRules<'_> {
        CheckRules { independent: &self.independent, scaling: self.scaling, memory: self.memory }
    }
}

/// Expresses each slave by masters and prescribed DOFs in local numbers: `u_s = sum entries + constant`. Row i belongs to row i of the
/// basis.
pub(crate) struct Relation<'a> {
    pub system: LocalSystem<'a>,
    basis: &'a Basis,
    /// Row of each slave; `u32::MAX` for other DOFs.
    pub row_of: Vec<u32>,
    /// Slave of each row.
    pub slave: Vec<u32>,
    /// Index into `own` for each row that differs from the basis; [`OF_BASIS`] for most rows, which do not differ.
    place: Vec<u32>,
    own: Vec<OwnRow>,
    dofs: Vec<u32>,
    values: Vec<f64>,
    pub constant: Vec<f64>,
    /// The units in which growth is measured: these, or those of the user.
    units: Option<&'a Scaling>,
    /// The growth `max |T_ij|` in these units.
    pub growth: f64,
    /// The rows of T with a coefficient above the bound of growth.
    pub steep: Vec<u32>,
}

const OF_BASIS: u32 = u32::MAX;

/// DOFs and their coefficients.
pub(super) type RelationRow = (Vec<u32>, Vec<f64>);

/// The entries of a row that differs from the basis.
enum OwnRow {
    /// A range of [`Relation::dofs`] and [`Relation::values`].
    Stored { start: usize, len: u32 },
    /// A row that an exchange changed, ascending by DOF.
    Changed(Box<RelationRow>),
}

impl Relation<'_> {
    pub fn rows(&self) -> usize {
        self.slave.len()
    }

    /// Returns true if row i is a user's equation solved for a DOF; its terms then ascend by the user's numbers.
    pub fn is_users(&self, i: usize) -> bool {
        i < self.basis.peeled.len() && self.place[i] == OF_BASIS
    }

    /// The terms of row i.
    #[expect(clippy::inline_always, reason = "out of line it was a twenty-fifth of that profile")]
    #[inline(always)]
    pub fn row(&self, i: usize) -> BasisRow<'_> {
        if self.place[i] == OF_BASIS {
            return self.basis.row(self.system, i);
        }
        self.own_row(i)
    }

    fn own_row(&self, i: usize) -> BasisRow<'_> {
        let (dofs, values) = self.own_terms(i);
        BasisRow::new(dofs, values)
    }

    /// The DOFs and coefficients of a row that differs from the basis, ascending by DOF.
    fn own_terms(&self, i: usize) -> (&[u32], &[f64]) {
        match self.own[self.place[i] as usize] {
            OwnRow::Stored { start, len } => {
                let range = start..start + len as usize;
                (&self.dofs[range.clone()], &self.values[range])
            }
            OwnRow::Changed(ref row) => (&row.0, &row.1),
        }
    }

    /// Number of terms of row i.
    #[inline]
    pub fn length(&self, i: usize) -> usize {
        if self.place[i] == OF_BASIS { self.basis.length(self.system, i) } else { self.row(i).len() }
    }

    /// Number of prescribed DOFs in row i.
    #[inline]
    pub fn prescribed_in(&self, i: usize) -> usize {
        let free = self.system.free();
        if self.system.prescribed().is_empty() { 0 } else { self.row(i).dofs().filter(|&j| !free[j as usize]).count() }
    }

    /// The terms of row i, ascending by DOF.
    pub fn sorted(&self, i: usize) -> Cow<'_, RelationRow> {
        if let Some(OwnRow::Changed(row)) = self.own.get(self.place[i] as usize) {
            return Cow::Borrowed(row);
        }
        let mut row: Vec<_> = self.row(i).entries().collect();
        row.sort_unstable_by_key(|&(j, _)| j);
        Cow::Owned(row.into_iter().unzip())
    }

    /// The coefficient of a DOF in row i, if it is stored; it may be zero.
    pub fn coefficient(&self, i: usize, dof: u32) -> Option<f64> {
        if self.place[i] == OF_BASIS {
            return self.row(i).entries().find(|&(j, _)| j == dof).map(|(_, v)| v);
        }
        let (dofs, values) = self.own_terms(i);
        dofs.binary_search(&dof).ok().map(|at| values[at])
    }

    /// The magnitude of the coefficient v of a DOF in row i, in the units in which growth is measured.
    #[inline]
    pub fn size(&self, i: usize, dof: u32, v: f64) -> f64 {
        let exponent = |units: &Scaling| units.col(dof as usize) - units.col(self.slave[i] as usize);
        self.units.map_or(v.abs(), |units| ldexp(v.abs(), exponent(units)))
    }

    /// Largest coefficient of a master in row i: its [`Relation::size`].
    #[inline]
    pub fn largest(&self, i: usize) -> f64 {
        let free = self.system.free();
        let larger = |most: f64, (j, v): (u32, f64)| {
            let size = self.size(i, j, v);
            if size > most && free[j as usize] { size } else { most }
        };
        self.row(i).entries().fold(0.0, larger)
    }

    pub fn change(&mut self, i: usize, row: RelationRow) {
        self.set(i, OwnRow::Changed(Box::new(row)));
    }

    fn set(&mut self, i: usize, own: OwnRow) {
        if self.place[i] == OF_BASIS {
            self.place[i] = self.own.len() as u32;
            self.own.push(own);
        } else {
            self.own[self.place[i] as usize] = own;
        }
    }
}

/// The sums of the terms of one row, by DOF.
#[derive(Default)]
struct RowSum {
    /// Index of each DOF into `parts`, plus 1; 0 if it has none. Empty until the first row is summed, which many systems never need.
    place: Vec<u32>,
    /// For each DOF of the row, the sum of its terms and the magnitude of the largest one.
    parts: Vec<(f64, f64)>,
    dofs: Vec<u32>,
}

impl RowSum {
    fn add(&mut self, j: u32, part: f64) {
        let place = &mut self.place[j as usize];
        if *place == 0 {
            self.dofs.push(j);
            self.parts.push((0.0, 0.0));
            *place = self.parts.len() as u32;
        }
        let (value, size) = &mut self.parts[*place as usize - 1];
        *value += part;
        *size = size.max(part.abs());
    }
}

/// Builds the relation. Rows of fixed slaves keep prescribed DOFs only. Lists the rows with coefficients above `limit` in
/// [`Relation::steep`], measured in `units` or in those of the user.
pub(super) fn assemble<'a>(
    system: LocalSystem<'a>,
    input: &ReductionInput<'a>,
    limit: f64,
    units: Option<&'a Scaling>,
) -> Relation<'a> {
    let ReductionInput { basis, bounds, ref fixed, .. } = *input;
    let rank = basis.rows();
    let mut relation = Relation {
        system,
        basis,
        row_of: vec![u32::MAX; system.dofs()],
        slave: basis.slaves().to_vec(),
        place: vec![OF_BASIS; rank],
        own: Vec::new(),
        dofs: Vec::new(),
        values: Vec::new(),
        constant: basis.constants().to_vec(),
        units,
        growth: 0.0,
        steep: Vec::new(),
    };
    let mut sum = RowSum::default();
    for t in (0..rank).rev() {
        let slave = basis.slave(t);
        let is_fixed = fixed.get(slave as usize).is_some_and(|&fixed| fixed);
        if is_fixed || bounds[t].is_infinite() {
            substitute(&mut relation, &mut sum, t, is_fixed);
        }
        relation.row_of[slave as usize] = t as u32;
        if bounds[t] > relation.growth.min(limit) || units.is_some() {
            let largest = relation.largest(t);
            relation.growth = relation.growth.max(largest);
            if largest > limit {
                relation.steep.push(t as u32);
            }
        }
    }
    relation
}

/// Replaces the slaves among the terms of row t by their own rows.
fn substitute(relation: &mut Relation, sum: &mut RowSum, t: usize, fixed: bool) {
    if sum.place.is_empty() {
        sum.place = vec![0; relation.system.dofs()];
    }
    let mut constant = relation.constant[t];
    let mut size = constant.abs();
    for (j, v) in relation.basis.row(relation.system, t).entries() {
        match relation.row_of[j as usize] {
            u32::MAX => sum.add(j, v),
            row => {
                let part = v * relation.constant[row as usize];
                constant += part;
                size = size.max(part.abs());
                relation.row(row as usize).entries().for_each(|(l, t)| sum.add(l, v * t));
            }
        }
    }
    relation.constant[t] = if constant.abs() > NOISE * size { constant } else { 0.0 };
    let start = relation.dofs.len();
    sum.dofs.sort_unstable();
    for j in sum.dofs.drain(..) {
        let (value, size) = sum.parts[std::mem::take(&mut sum.place[j as usize]) as usize - 1];
        if value.abs() > NOISE * size && !(fixed && relation.system.free()[j as usize]) {
            relation.dofs.push(j);
            relation.values.push(value);
        }
    }
    sum.parts.clear();
    relation.set(t, OwnRow::Stored { start, len: (relation.dofs.len() - start) as u32 });
}
