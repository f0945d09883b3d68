//! Columns ascend in a row of G, the DOFs of a constraint need not: where each goes. Most ascend, and cost nothing here.

/// The items of a block whose DOFs do not ascend.
#[derive(Default)]
pub(super) struct Order {
    count: usize,
    /// Which items, ascending.
    items: Vec<u32>,
    /// Where the places of each end.
    end: Vec<u32>,
    /// For each DOF its place among those of its item.
    place: Vec<u32>,
}

impl Order {
    /// Appends the next item of the block.
    pub fn push(&mut self, dofs: &[u32]) {
        if !dofs.is_sorted() {
            let place = |dof| dofs.iter().filter(|&other| other < dof).count() as u32;
            self.place.extend(dofs.iter().map(place));
            self.items.push(self.count as u32);
            self.end.push(self.place.len() as u32);
        }
        self.count += 1;
    }

    /// Sorts the rows of those; the entries of item i start at `start(i)` of `g`.
    pub fn restore(&self, start: impl Fn(usize) -> usize, rows: usize, g: &mut [f64]) {
        let mut unsorted = Vec::new();
        for (k, &i) in self.items.iter().enumerate() {
            let from = if k == 0 { 0 } else { self.end[k - 1] as usize };
            let place = &self.place[from..self.end[k] as usize];
            for row in g[start(i as usize)..][..rows * place.len()].chunks_exact_mut(place.len()) {
                unsorted.clear();
                unsorted.extend_from_slice(row);
                unsorted.iter().zip(place).for_each(|(&v, &p)| row[p as usize] = v);
            }
        }
    }
}
