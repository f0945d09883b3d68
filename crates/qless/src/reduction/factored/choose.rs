//! Chooses the slaves of a factored block by sparse LU, and exchanges them until the search finds no entry of T above the bound.
//!
//! Each exchange multiplies `|det C_S|` (C_S: the columns of the slaves) by the entry of T that is above the bound, so the exchanges end.

use super::FactoredBlock;
use super::finishing::candidates;
use crate::Csr;
use crate::factor::backend::BackendError;
use crate::factor::lu::SparseLu;
use crate::factor::solver::SlaveSolver;
use crate::input::numbering::LocalSystem;
use crate::input::scale::ldexp;
use crate::reduction::block::independent_lu;
use crate::reduction::relation::ReductionInput;

/// If the bound of growth is at least this, slaves are first chosen locally ([`candidates`]): that is fastest, but T can be large.
const LOOSE: f64 = 1e3;
/// Largest number of factorizations in a search for slaves; after each one, slaves are exchanged. If all exceed the bound, T is formed
/// explicitly instead.
const ROUNDS: usize = 8;

/// Factors the independent equations of a part. None if no slaves are found that meet the bound: then T must be explicit.
pub(crate) fn factor(
    local: LocalSystem,
    equations: &[usize],
    input: &ReductionInput,
    predicted: usize,
) -> Result<Option<FactoredBlock>, BackendError> {
    let part = ScaledPart::new(local, equations, input);
    let every = vec![true; part.dofs.len()];
    let near = (input.growth >= LOOSE).then(|| candidates(&part.plain(input))).filter(|near| *near != every);
    for may in near.into_iter().chain([every]) {
        if let Some(mut block) = part.within(may, predicted, input)? {
            block.predicted = block.predicted.min(block.sampled());
            return Ok(Some(block));
        }
    }
    Ok(None)
}

/// The scaled equations of a part, with their own DOF numbers in ascending order of the user's numbers.
struct ScaledPart<'a> {
    local: LocalSystem<'a>,
    equations: Vec<usize>,
    /// Local numbers of the free DOFs, which are the columns of `free`.
    dofs: Vec<u32>,
    free: Csr,
    /// Local numbers of the prescribed DOFs, which are the columns of `fixed`.
    prescribed: Vec<u32>,
    fixed: Csr,
    rhs: Vec<f64>,
}

impl<'a> ScaledPart<'a> {
    fn new(local: LocalSystem<'a>, equations: &[usize], input: &ReductionInput) -> Self {
        let user = |j: u32| local.numbering.dofs[j as usize];
        let mut all: Vec<u32> = equations.iter().flat_map(|&i| local.parts(i).0).copied().collect();
        all.sort_unstable_by_key(|&j| user(j));
        all.dedup();
        let (dofs, prescribed): (Vec<u32>, Vec<u32>) = all.into_iter().partition(|&j| local.free()[j as usize]);
        let mut part = Self {
            local,
            equations: equations.to_vec(),
            free: Csr::empty(dofs.len()),
            fixed: Csr::empty(prescribed.len()),
            dofs,
            prescribed,
            rhs: Vec::new(),
        };
        let place =
            |list: &[u32], j: usize| list.binary_search_by_key(&user(j as u32), |&l| user(l)).unwrap_or_default();
        for &i in equations {
            let side = |free: bool| local.row(i).filter(move |&(j, _)| local.free()[j] == free);
            let entry = |(j, v): (usize, f64)| input.scaling.entry(i, j, v);
            part.free.append(side(true).map(|(j, v)| (place(&part.dofs, j), entry((j, v)))));
            part.fixed.append(side(false).map(|(j, v)| (place(&part.prescribed, j), entry((j, v)))));
            part.rhs.push(ldexp(local.rhs()[i], input.scaling.row[i]));
        }
        part
    }

    /// Factors the part with slaves among the DOFs that `may` allows. Slaves are exchanged until the growth is within the bound; None if
    /// that fails.
    fn within(
        &self,
        mut may: Vec<bool>,
        predicted: usize,
        input: &ReductionInput,
    ) -> Result<Option<FactoredBlock>, BackendError> {
        if self.is_scaled(input) {
            self.prefer(&mut may, input)?;
        }
        for _ in 0..ROUNDS {
            // The factor L needs no rows for DOFs that cannot be slaves, so their columns are left out.
            let rows = only(&self.free, &may);
            let order = crate::factor::backend::sparse::order(&rows)?;
            let Some(lu) = independent_lu(&rows, &order, |j| may[j], input.memory)? else { return Ok(None) };
            let mut block = self.block(lu, predicted, input);
            let exchanges = block.search(input.growth);
            if exchanges.is_empty() {
                return Ok(Some(block));
            }
            may.fill(false);
            let place = |j: usize| self.dofs.binary_search_by_key(&j, |&l| self.user(l)).unwrap_or_default();
            block.slaves.iter().for_each(|&j| may[place(j)] = true);
            for (slave, master) in exchanges {
                (may[place(slave)], may[place(master)]) = (false, true);
            }
        }
        Ok(None)
    }

    /// Restricts `may` to slaves chosen in the user's units, because T is bounded in these.
    fn prefer(&self, may: &mut [bool], input: &ReductionInput) -> Result<(), BackendError> {
        let rows = only(&self.plain(input), may);
        let order = crate::factor::backend::sparse::order(&rows)?;
        if let Some(lu) = independent_lu(&rows, &order, |j| may[j], input.memory)? {
            may.fill(false);
            lu.slaves.iter().for_each(|&j| may[j as usize] = true);
        }
        Ok(())
    }

    /// Returns true if any column of the part is scaled.
    fn is_scaled(&self, input: &ReductionInput) -> bool {
        self.dofs.iter().any(|&j| input.scaling.col(j as usize) != 0)
    }

    /// The equations with unscaled columns; each row is scaled again.
    fn plain(&self, input: &ReductionInput) -> Csr {
        let mut plain = self.free.clone();
        if !self.is_scaled(input) {
            return plain;
        }
        for i in 0..plain.rows() {
            let range = plain.start[i]..plain.start[i + 1];
            let exponent = |k: usize| -input.scaling.col(self.dofs[plain.col[k] as usize] as usize);
            let values: Vec<f64> = range.clone().map(|k| ldexp(plain.val[k], exponent(k))).collect();
            let largest = values.iter().fold(f64::MIN_POSITIVE, |most: f64, v| most.max(v.abs()));
            range.zip(values).for_each(|(k, v)| plain.val[k] = ldexp(v, -crate::input::scale::exponent(largest)));
        }
        plain
    }

    fn user(&self, local: u32) -> usize {
        self.local.numbering.dofs[local as usize] as usize
    }

    fn block(&self, lu: SparseLu, predicted: usize, input: &ReductionInput) -> FactoredBlock {
        let mut number = vec![u32::MAX; self.dofs.len()];
        lu.slaves.iter().for_each(|&j| number[j as usize] = 0);
        let masters: Vec<usize> = (0..self.dofs.len()).filter(|&j| number[j] != 0).collect();
        masters.iter().zip(1..).for_each(|(&j, k)| number[j] = k);
        let mut of_masters = Csr::empty(masters.len());
        for i in 0..self.free.rows() {
            let entries = self.free.row(i).filter(|&(j, _)| number[j] != 0);
            of_masters.append(entries.map(|(j, v)| (number[j] as usize - 1, v)));
        }
        let local = [
            lu.slaves.iter().map(|&j| self.dofs[j as usize]).collect::<Vec<u32>>(),
            masters.iter().map(|&j| self.dofs[j]).collect(),
            self.prescribed.clone(),
        ];
        let scaled = !input.scaling.col.is_empty();
        let exponents = |dofs: &[u32]| -> Vec<i32> {
            if scaled { dofs.iter().map(|&j| input.scaling.col(j as usize)).collect() } else { Vec::new() }
        };
        let users = |dofs: &[u32]| dofs.iter().map(|&j| self.user(j)).collect::<Vec<usize>>();
        FactoredBlock {
            equations: self.equations.clone(),
            slaves: users(&local[0]),
            masters: users(&local[1]),
            prescribed: users(&local[2]),
            predicted,
            growth: 0.0,
            solver: SlaveSolver::new(&self.free, lu),
            of_masters,
            of_prescribed: self.fixed.clone(),
            rhs: self.rhs.clone(),
            exponents: [exponents(&local[0]), exponents(&local[1]), exponents(&local[2])],
            rows: self.equations.iter().map(|&i| input.scaling.row[i]).collect(),
        }
    }
}

/// The columns of the equations that `may` allows.
fn only(equations: &Csr, may: &[bool]) -> Csr {
    let mut rows = Csr::empty(equations.cols);
    (0..equations.rows()).for_each(|i| rows.append(equations.row(i).filter(|&(j, _)| may[j])));
    rows
}
