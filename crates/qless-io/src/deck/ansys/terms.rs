//! Terms of equations, those of all in one row: an equation takes no room of its own unless it goes on after others have begun.

use crate::deck::Dof;

/// A DOF and its coefficient.
pub type Term = (Dof, f64);

/// The row.
#[derive(Debug, Default)]
pub struct Terms {
    row: Vec<Term>,
}

/// Which terms belong to an equation.
#[derive(Debug, Default)]
pub struct Owned {
    start: u32,
    count: u32,
    /// Those that came when others stood behind the first ones.
    more: Option<Box<Vec<Term>>>,
}

impl Terms {
    /// Number of terms in the row.
    pub fn len(&self) -> usize {
        self.row.len()
    }

    /// Adds a term.
    pub fn push(&mut self, to: &mut Owned, term: Term) {
        let end = self.row.len() as u32;
        if to.count == 0 && to.more.is_none() {
            to.start = end;
        }
        if to.more.is_none() && to.start + to.count == end {
            self.row.push(term);
            to.count += 1;
        } else {
            to.more.get_or_insert_default().push(term);
        }
    }

    /// Takes away the terms of a DOF.
    pub fn remove(&mut self, of: &mut Owned, dof: Dof) {
        let own = &mut self.row[of.start as usize..][..of.count as usize];
        let mut kept = 0;
        for k in 0..own.len() {
            if own[k].0 != dof {
                own[kept] = own[k];
                kept += 1;
            }
        }
        of.count = kept as u32;
        if let Some(more) = &mut of.more {
            more.retain(|(known, _)| *known != dof);
        }
    }

    /// The terms in the order in which they came.
    pub fn of<'a>(&'a self, owned: &'a Owned) -> impl Iterator<Item = Term> + Clone + 'a {
        let more = owned.more.as_deref().map_or(&[][..], Vec::as_slice);
        self.row[owned.start as usize..][..owned.count as usize].iter().chain(more).copied()
    }
}

impl Owned {
    /// How many terms.
    pub fn len(&self) -> usize {
        self.count as usize + self.more.as_ref().map_or(0, |more| more.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn term(node: u32) -> Term {
        (Dof { node, component: 1 }, f64::from(node))
    }

    fn nodes(terms: &Terms, owned: &Owned) -> Vec<u32> {
        assert_eq!(owned.len(), terms.of(owned).count());
        terms.of(owned).map(|(dof, _)| dof.node).collect()
    }

    #[test]
    fn equations_go_on_after_others() {
        let (mut terms, mut a, mut b) = (Terms::default(), Owned::default(), Owned::default());
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
