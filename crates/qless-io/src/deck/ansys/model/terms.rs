//! Stores the terms of all equations in one common list. An equation needs a list of its own only for terms that are added after another
//! equation has begun.

use crate::deck::Dof;
use crate::deck::ansys::syntax::archive::DofCoefficient;
use crate::deck::paged_list::PagedList;

/// The terms of all equations.
#[derive(Debug, Default)]
pub struct TermStore {
    list: PagedList<DofCoefficient>,
    /// Lists for the terms that were added to an equation after another equation had begun.
    more: Vec<Vec<DofCoefficient>>,
}

/// The terms of one equation: a range of the common list, and possibly a list of its own.
#[derive(Debug, Default)]
pub struct OwnedTerms {
    start: u32,
    count: u32,
    /// One more than the index of the equation's own list in `TermStore::more`; 0 if it has none.
    more: u32,
}

impl TermStore {
    /// Number of terms in the common list.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Adds a term.
    pub fn push(&mut self, to: &mut OwnedTerms, term: DofCoefficient) {
        let end = self.list.len() as u32;
        if to.count == 0 && to.more == 0 {
            to.start = end;
        }
        if to.more == 0 && to.start + to.count == end {
            self.list.push(term);
            to.count += 1;
            return;
        }
        if to.more == 0 {
            self.more.push(Vec::new());
            to.more = self.more.len() as u32;
        }
        self.more[to.more as usize - 1].push(term);
    }

    /// Copies the terms of an equation, so that a version for earlier load steps remains when they change.
    pub fn copy(&mut self, owned: &OwnedTerms) -> OwnedTerms {
        let terms: Vec<DofCoefficient> = self.iter(owned).collect();
        let mut copy = OwnedTerms::default();
        terms.into_iter().for_each(|term| self.push(&mut copy, term));
        copy
    }

    /// Removes the terms of a DOF.
    pub fn remove(&mut self, owned: &mut OwnedTerms, dof: Dof) {
        let start = owned.start as usize;
        let mut kept = start;
        for k in start..start + owned.count as usize {
            if self.list[k].0 != dof {
                self.list[kept] = self.list[k];
                kept += 1;
            }
        }
        owned.count = (kept - start) as u32;
        if let Some(more) = owned.more.checked_sub(1) {
            self.more[more as usize].retain(|(known, _)| *known != dof);
        }
    }

    /// Number of terms of an equation.
    pub fn count(&self, owned: &OwnedTerms) -> usize {
        owned.count as usize + owned.more.checked_sub(1).map_or(0, |more| self.more[more as usize].len())
    }

    /// The terms of an equation in the order of the deck.
    pub fn iter<'a>(&'a self, owned: &'a OwnedTerms) -> impl Iterator<Item = DofCoefficient> + Clone + 'a {
        let more = owned.more.checked_sub(1).map_or(&[][..], |more| &self.more[more as usize]);
        let first = (owned.start..owned.start + owned.count).map(|k| self.list[k as usize]);
        first.chain(more.iter().copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn term(node: u32) -> DofCoefficient {
        (Dof { node, component: 1 }, f64::from(node))
    }

    fn nodes(terms: &TermStore, owned: &OwnedTerms) -> Vec<u32> {
        assert_eq!(terms.count(owned), terms.iter(owned).count());
        terms.iter(owned).map(|(dof, _)| dof.node).collect()
    }

    #[test]
    fn equations_continue_after_others_have_begun() {
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
