//! Disjoint sets (union-find): connected components from pairs of neighbours.

/// A partition of `0..n` into sets that can be joined; the root of a set is its smallest member.
///
/// Cost of a call: O(log n) amortised, about 4 steps in practice.
///
/// ```
/// let mut sets = qless::common::DisjointSets::new(4);
/// sets.join(3, 1);
/// sets.join(0, 2);
/// assert_eq!((sets.root(3), sets.root(2)), (1, 0));
/// assert_eq!(sets.numbered(), ([0, 1, 0, 1].to_vec(), 2));
/// ```
#[derive(Clone, Debug)]
pub struct DisjointSets(Vec<u32>);

impl DisjointSets {
    /// Each of the numbers `0..n` is its own set; n is below 2^32.
    pub fn new(n: usize) -> Self {
        Self((0..n as u32).collect())
    }

    /// The smallest member of the set of `member`, by path halving.
    #[inline]
    pub fn root(&mut self, member: usize) -> usize {
        let mut k = member as u32;
        while self.0[k as usize] != k {
            let next = self.0[self.0[k as usize] as usize];
            self.0[k as usize] = next;
            k = next;
        }
        k as usize
    }

    /// Joins the sets of a and b.
    #[inline]
    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b) as u32;
    }

    /// The index of each member's set, in the order of the smallest members, and the number of sets.
    pub fn numbered(mut self) -> (Vec<u32>, usize) {
        let mut count = 0;
        for k in 0..self.0.len() {
            // A parent is smaller, so it is numbered already.
            let parent = self.0[k] as usize;
            self.0[k] = if parent == k { count } else { self.0[parent] };
            count += u32::from(parent == k);
        }
        (self.0, count as usize)
    }
}
