//! Connected parts: two rows belong to the same part if a chain of DOFs that are not prescribed connects them.
//!
//! Results of a part depend on that part alone, to the last bit. Prescribed DOFs do not connect parts.

use qless::Csr;
use qless::common::DisjointSets;

/// Marks a prescribed DOF.
const NONE: u32 = u32::MAX;

/// One part.
#[derive(Default)]
pub struct Part {
    /// Its DOFs, ascending.
    pub free: Vec<usize>,
    /// Its equations, ascending.
    pub rows: Vec<usize>,
}

/// All parts, ordered by their lowest DOFs. An equation that has only prescribed DOFs is a part of its own; such parts come last.
pub struct Parts {
    pub list: Vec<Part>,
    of_dof: Vec<u32>,
    of_row: Vec<u32>,
    place: Vec<u32>,
}

impl Parts {
    /// Finds the parts. Each item of `together` lists DOFs that belong to one part, such as those of a rotation or of an element.
    pub fn new<I>(g: &Csr, prescribed: &[(usize, f64)], together: impl IntoIterator<Item = I>) -> Self
    where
        I: IntoIterator<Item = usize>,
    {
        let n = g.cols();
        let mut is_free = vec![true; n];
        prescribed.iter().for_each(|&(j, _)| is_free[j] = false);
        let mut sets = DisjointSets::new(n);
        let mut join = |dofs: &mut dyn Iterator<Item = usize>| {
            let mut dofs = dofs.filter(|&j| is_free[j]);
            let Some(first) = dofs.next() else { return };
            dofs.for_each(|j| sets.join(first, j));
        };
        (0..g.rows()).for_each(|r| join(&mut g.row(r).map(|(j, _)| j)));
        together.into_iter().for_each(|dofs| join(&mut dofs.into_iter()));
        let mut all = Self { list: Vec::new(), of_dof: vec![NONE; n], of_row: Vec::new(), place: vec![NONE; n] };
        let mut of_root = vec![NONE; n];
        (0..n).filter(|&j| is_free[j]).for_each(|j| all.add_dof(j, &mut of_root[sets.root(j)]));
        (0..g.rows()).for_each(|r| all.add_row(r, g));
        all
    }

    fn add_dof(&mut self, j: usize, part: &mut u32) {
        if *part == NONE {
            *part = self.list.len() as u32;
            self.list.push(Part::default());
        }
        let free = &mut self.list[*part as usize].free;
        (self.of_dof[j], self.place[j]) = (*part, free.len() as u32);
        free.push(j);
    }

    fn add_row(&mut self, r: usize, g: &Csr) {
        let part = g.row(r).find_map(|(j, _)| self.of_dof(j)).unwrap_or(self.list.len());
        if part == self.list.len() {
            self.list.push(Part::default());
        }
        self.list[part].rows.push(r);
        self.of_row.push(part as u32);
    }

    pub fn of_row(&self, r: usize) -> usize {
        self.of_row[r] as usize
    }

    /// The part of DOF j; none for prescribed DOFs.
    pub fn of_dof(&self, j: usize) -> Option<usize> {
        Some(self.of_dof[j]).filter(|&part| part != NONE).map(|part| part as usize)
    }

    /// Index of a DOF within a part; none if it is prescribed or in another part.
    pub fn place(&self, part: usize, j: usize) -> Option<usize> {
        (self.of_dof(j) == Some(part)).then(|| self.place[j] as usize)
    }

    /// Folds the rows of each part into one value.
    pub fn fold<T: Clone>(&self, start: T, mut with: impl FnMut(&mut T, usize)) -> Vec<T> {
        let mut all = vec![start; self.list.len()];
        self.of_row.iter().enumerate().for_each(|(r, &part)| with(&mut all[part as usize], r));
        all
    }
}
