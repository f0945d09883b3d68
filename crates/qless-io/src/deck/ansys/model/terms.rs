//! Terms of equations, those of all in one row: an equation takes no room of its own unless it goes on after others have begun.

use crate::deck::Dof;
use crate::deck::ansys::syntax::archive::DofCoefficient;
use crate::deck::paged_list::PagedList;

/// The row.
#[derive(Debug, Default)]
pub struct TermStore {
    row: PagedList<DofCoefficient>,
    /// Terms that came when others stood behind the first ones of their equation.
    more: Vec<Vec<DofCoefficient>>,
}

/// Which terms belong to an equation.
#[derive(Debug, Default)]
pub struct OwnedTerms {
    start: u32,
    count: u32,
    /// One more than the index of those that stand apart; 0 if there are none.
    more: u32,
}

impl TermStore {
    /// Number of terms in the row.
    pub fn len(&self) -> usize {
        self.row.len()
    }

    /// Adds a term.
    pub fn push(&mut self, to: &mut OwnedTerms, term: DofCoefficient) {
        let end = self.row.len() as u32;
        if to.count == 0 && to.more == 0 {
            to.start = end;
        }
        if to.more == 0 && to.start + to.count == end {
            self.row.push(term);
            to.count += 1;
            return;
        }
        if to.more == 0 {
            self.more.push(Vec::new());
            to.more = self.more.len() as u32;
        }
        self.more[to.more as usize - 1].push(term);
    }

    /// The same terms once more.
    pub fn copy(&mut self, of: &OwnedTerms) -> OwnedTerms {
        let terms: Vec<DofCoefficient> = self.of(of).collect();
        let mut copy = OwnedTerms::default();
        terms.into_iter().for_each(|term| self.push(&mut copy, term));
        copy
    }

    /// Takes away the terms of a DOF.
    pub fn remove(&mut self, of: &mut OwnedTerms, dof: Dof) {
        let start = of.start as usize;
        let mut kept = start;
        for k in start..start + of.count as usize {
            if self.row[k].0 != dof {
                self.row[kept] = self.row[k];
                kept += 1;
            }
        }
        of.count = (kept - start) as u32;
        if let Some(more) = of.more.checked_sub(1) {
            self.more[more as usize].retain(|(known, _)| *known != dof);
        }
    }

    /// How many terms.
    pub fn count(&self, of: &OwnedTerms) -> usize {
        of.count as usize + of.more.checked_sub(1).map_or(0, |more| self.more[more as usize].len())
    }

    /// The terms in the order in which they came.
    pub fn of<'a>(&'a self, owned: &'a OwnedTerms) -> impl Iterator<Item = DofCoefficient> + Clone + 'a {
        let more = owned.more.checked_sub(1).map_or(&[][..], |more| &self.more[more as usize]);
        let row = (owned.start..owned.start + owned.count).map(|k| self.row[k as usize]);
        row.chain(more.iter().copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn term(node: u32) -> DofCoefficient {
        (Dof { node, component: 1 }, f64::from(node))
    }

    fn nodes(terms: &TermStore, owned: &OwnedTerms) -> Vec<u32> {
        assert_eq!(terms.count(owned), terms.of(owned).count());
        terms.of(owned).map(|(dof, _)| dof.node).collect()
    }

    #[test]
    fn equations_go_on_after_others() {
        let (mut terms, mut a, mut b) = (TermStore::default(), OwnedTerms::default(), OwnedTerms::default());
        for (node, is_first) in [(1, true), (2, true), (3, false), (4, true), (1, true), (5, false)] {
            terms.push(if is_first { &mut a } else { &mut b }, term(node));
        }
        assert_eq!((nodes(&terms, &a), nodes(&terms, &b)), (vec![1, 2, 4, 1], vec![3, 5]));
        terms.remove(&mut a, term(1).0);
        terms.push(&mut a, term(6));
        assert_eq!((nodes(&terms, &a), nodes(&terms, &b)), (vec![2, 4, 6], vec![3, 5]));
        for node in [3, 5] {
            terms.remove(&mut b, term(node).0);
        }
        terms.push(&mut b, term(7));
        assert_eq!((nodes(&terms, &a), nodes(&terms, &b)), (vec![2, 4, 6], vec![7]));
    }
}
