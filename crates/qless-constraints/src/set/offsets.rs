//! Which segment of a list a row belongs to.

/// The first row of each segment, and one more: the number of rows.
pub(super) struct Offsets(Vec<u32>);

impl Default for Offsets {
    fn default() -> Self {
        Self(vec![0])
    }
}

impl Offsets {
    /// Rows of all segments.
    pub fn rows(&self) -> usize {
        self.0.last().map_or(0, |&rows| rows as usize)
    }

    /// The first row of a segment; behind the last one, the number of rows.
    pub fn first(&self, segment: usize) -> usize {
        self.0[segment] as usize
    }

    /// The segment of a row that is there, and the row in it.
    pub fn find(&self, row: usize) -> (usize, usize) {
        let segment = self.0.partition_point(|&first| first as usize <= row) - 1;
        (segment, row - self.0[segment] as usize)
    }

    /// A segment has so many rows more.
    pub fn grow(&mut self, segment: usize, by: i32) {
        self.0[segment + 1..].iter_mut().for_each(|first| *first = first.wrapping_add_signed(by));
    }

    /// One more segment, of so many rows, behind all.
    pub fn push(&mut self, rows: usize) {
        self.0.push((self.rows() + rows) as u32);
    }

    /// A segment without rows is put in.
    pub fn insert(&mut self, segment: usize) {
        self.0.insert(segment, self.0[segment]);
    }

    /// A segment without rows is taken out.
    pub fn remove(&mut self, segment: usize) {
        self.0.remove(segment);
    }

    /// A segment ends after so many rows, and the next one has the others.
    pub fn split(&mut self, segment: usize, rows: usize) {
        self.0.insert(segment + 1, self.0[segment] + rows as u32);
    }
}
