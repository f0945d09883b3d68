//! Rows of `[T G g]` by substitution, in the order in which [`Basis::visit`] gives the slaves.

use crate::ConstraintSystem;
use crate::basis::Basis;

/// Entries below this, relative to the largest part that went into them, are rounding.
const NOISE: f64 = 1e-14;

/// `u_s = sum entries + constant` by rows over masters and prescribed DOFs, named by DOF.
pub(crate) struct Relation {
    /// Row of each slave; `u32::MAX` for other DOFs.
    pub row_of: Vec<u32>,
    /// Slave of each row.
    pub slave: Vec<u32>,
    pub is_prescribed: Vec<bool>,
    start: Vec<usize>,
    entries: Vec<(u32, f64)>,
    /// Rows that were changed since, ascending by DOF.
    pub changed: std::collections::HashMap<u32, Vec<(u32, f64)>>,
    pub constant: Vec<f64>,
}

impl Relation {
    pub fn row(&self, i: usize) -> &[(u32, f64)] {
        match self.changed.get(&(i as u32)) {
            Some(row) => row,
            None => &self.entries[self.start[i]..self.start[i + 1]],
        }
    }

    pub fn rows(&self) -> usize {
        self.slave.len()
    }
}

/// A dense row being summed.
struct Sum {
    value: Vec<f64>,
    size: Vec<f64>,
    touched: Vec<u32>,
}

impl Sum {
    fn add(&mut self, j: u32, part: f64) {
        let k = j as usize;
        if self.size[k] == 0.0 {
            self.touched.push(j);
            self.size[k] = f64::MIN_POSITIVE;
        }
        self.value[k] += part;
        self.size[k] = self.size[k].max(part.abs());
    }

    /// Moves the sum into `entries`, ascending, without what is rounding.
    fn take(&mut self, entries: &mut Vec<(u32, f64)>) {
        self.touched.sort_unstable();
        for j in self.touched.drain(..) {
            let (value, size) = (&mut self.value[j as usize], &mut self.size[j as usize]);
            if value.abs() > NOISE * *size {
                entries.push((j, *value));
            }
            (*value, *size) = (0.0, 0.0);
        }
    }
}

pub(crate) fn assemble(system: &ConstraintSystem, basis: &Basis, fixed: &[usize]) -> Relation {
    let n = system.dofs();
    let mut is_fixed = vec![false; n];
    fixed.iter().for_each(|&j| is_fixed[j] = true);
    let mut relation = Relation {
        row_of: vec![u32::MAX; n],
        slave: Vec::with_capacity(basis.rank()),
        is_prescribed: vec![false; n],
        start: vec![0],
        entries: Vec::new(),
        changed: std::collections::HashMap::new(),
        constant: Vec::with_capacity(basis.rank()),
    };
    system.prescribed().iter().for_each(|&(j, _)| relation.is_prescribed[j] = true);
    let mut sum = Sum { value: vec![0.0; n], size: vec![0.0; n], touched: Vec::new() };
    basis.visit(system, |slave, terms, constant| {
        let (mut constant, mut size) = (constant, constant.abs());
        for &(j, v) in terms {
            match relation.row_of[j as usize] {
                u32::MAX => sum.add(j, v),
                row => {
                    let row = row as usize;
                    let part = v * relation.constant[row];
                    constant += part;
                    size = size.max(part.abs());
                    relation.entries[relation.start[row]..relation.start[row + 1]]
                        .iter()
                        .for_each(|&(l, t)| sum.add(l, v * t));
                }
            }
        }
        relation.row_of[slave as usize] = relation.slave.len() as u32;
        relation.slave.push(slave);
        relation.constant.push(if constant.abs() > NOISE * size { constant } else { 0.0 });
        let first = relation.entries.len();
        sum.take(&mut relation.entries);
        if is_fixed[slave as usize] {
            let mut k = first;
            while k < relation.entries.len() {
                if relation.is_prescribed[relation.entries[k].0 as usize] {
                    k += 1;
                } else {
                    relation.entries.remove(k);
                }
            }
        }
        relation.start.push(relation.entries.len());
    });
    relation
}
