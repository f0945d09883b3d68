//! `MPCADD` and `SPCADD`: sets as unions of sets.

use std::collections::{BTreeMap, BTreeSet};

use crate::deck::Problem;
use crate::deck::nastran::fault::circle;
use crate::deck::nastran::syntax::card::{Card, Refused};
use crate::deck::nastran::syntax::place::Place;

/// The unions of a deck by number, each with its card.
pub type Unions = BTreeMap<u32, Vec<(Vec<u32>, Place)>>;

/// `MPCADD set, S1, S2, ...`.
pub fn read(card: &Card, unions: &mut Unions) -> Result<(), Refused> {
    const SET: &str = "the number of a set";
    let of = (1..card.len()).filter(|&i| !card.is_blank(i)).map(|i| card.id(i, SET)).collect::<Result<_, _>>()?;
    unions.entry(card.id(0, SET)?).or_default().push((of, Place::of(card)));
    Ok(())
}

/// The sets that `set` comes down to, and those unions it goes through. A union hides a set of its own number. The error
/// has the card of a union that contains itself.
pub fn members(set: u32, unions: &Unions) -> Result<BTreeSet<u32>, (Place, Problem)> {
    let mut found = BTreeSet::new();
    let mut open = BTreeSet::new();
    let mut closed = BTreeSet::new();
    // True on the way up, when all below it is done.
    let mut stack = vec![(set, false)];
    while let Some((set, done)) = stack.pop() {
        if done {
            open.remove(&set);
            closed.insert(set);
            continue;
        }
        let Some(cards) = unions.get(&set) else {
            found.insert(set);
            continue;
        };
        if closed.contains(&set) || !open.insert(set) {
            continue;
        }
        stack.push((set, true));
        for (of, place) in cards {
            if let Some(&inner) = of.iter().find(|inner| open.contains(inner)) {
                return Err((place.clone(), circle("set", inner)));
            }
            stack.extend(of.iter().map(|&inner| (inner, false)));
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deck::CardName;

    fn unions(parts: &[(u32, &[u32])]) -> Unions {
        let place = |set| Place { name: CardName::numbered("SPCADD", set), file: 0, line: 1, lines: 1 };
        parts.iter().map(|&(set, of)| (set, vec![(of.to_vec(), place(set))])).collect()
    }

    #[test]
    fn unions_nest() {
        let unions = unions(&[(10, &[1, 20, 20]), (20, &[2, 30]), (30, &[3, 1])]);
        assert_eq!(members(10, &unions).map(|set| set.into_iter().collect()), Ok(vec![1, 2, 3]));
        assert_eq!(members(7, &unions).map(|set| set.into_iter().collect()), Ok(vec![7]));
    }

    #[test]
    fn a_union_of_itself_is_refused() {
        for (parts, inner) in [(unions(&[(10, &[10])]), 10), (unions(&[(10, &[20]), (20, &[30]), (30, &[20])]), 20)] {
            let (_, problem) = members(10, &parts).expect_err("a circle");
            assert_eq!(problem, circle("set", inner));
        }
    }
}
