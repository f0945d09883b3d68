//! Connected components of the graph of equations and free DOFs: nothing that is said of one depends on another (section 3.1).

use crate::input::numbering::Local;

/// The rows of each component, ascending; components in order of their first row. `dofs` gives the free DOFs of a row,
/// which are below `count`.
pub(crate) fn components<D: Iterator<Item = u32>>(
    rows: &[u32],
    count: usize,
    dofs: impl Fn(u32) -> D,
) -> Vec<Vec<u32>> {
    let labels = Labels::new(rows.len(), count, |k| dofs(rows[k]));
    let mut parts = vec![Vec::new(); labels.count];
    rows.iter().zip(&labels.of_row).for_each(|(&i, &part)| parts[part as usize].push(i));
    parts
}

/// The component of each row, numbered by first row.
pub(crate) struct Labels {
    pub of_row: Vec<u32>,
    pub count: usize,
}

impl Labels {
    /// Of all equations.
    pub fn of(system: Local) -> Self {
        let free = system.free();
        let dofs = |i: usize| system.parts(i).0.iter().copied().filter(|&j| free[j as usize]);
        Self::new(system.equations(), system.dofs(), dofs)
    }

    fn new<D: Iterator<Item = u32>>(rows: usize, count: usize, dofs: impl Fn(usize) -> D) -> Self {
        let mut owner = vec![u32::MAX; count];
        let mut parent: Vec<u32> = (0..rows as u32).collect();
        for k in 0..rows {
            for j in dofs(k) {
                match owner[j as usize] {
                    u32::MAX => owner[j as usize] = k as u32,
                    other => join(&mut parent, other, k as u32),
                }
            }
        }
        let mut number = vec![u32::MAX; rows];
        let mut count = 0;
        let mut of_row = Vec::with_capacity(rows);
        for k in 0..rows as u32 {
            let root = find(&mut parent, k) as usize;
            if number[root] == u32::MAX {
                number[root] = count;
                count += 1;
            }
            of_row.push(number[root]);
        }
        Self { of_row, count: count as usize }
    }

    /// Marks all rows that are connected with some.
    pub fn mark(&self, rows: &[usize], marked: &mut [bool]) {
        let mut of_label = vec![false; self.count];
        rows.iter().for_each(|&i| of_label[self.of_row[i] as usize] = true);
        marked.iter_mut().zip(&self.of_row).for_each(|(marked, &label)| *marked |= of_label[label as usize]);
    }
}

fn find(parent: &mut [u32], mut k: u32) -> u32 {
    while parent[k as usize] != k {
        parent[k as usize] = parent[parent[k as usize] as usize];
        k = parent[k as usize];
    }
    k
}

fn join(parent: &mut [u32], a: u32, b: u32) {
    let (a, b) = (find(parent, a), find(parent, b));
    parent[a.max(b) as usize] = a.min(b);
}
