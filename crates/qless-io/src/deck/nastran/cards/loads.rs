//! `LOAD`, which combines load sets, and the components that `FORCE`, `MOMENT` and `SLOAD` load.

use std::collections::BTreeMap;

use crate::deck::kinematics::components::Components;
use crate::deck::nastran::syntax::card::{Card, Refused};
use crate::deck::nastran::syntax::place::Place;

/// Load sets with their factors, by the number of the combination.
pub type Combinations = BTreeMap<u32, Vec<(u32, f64)>>;

/// Components of a point that carry a load.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    pub set: u32,
    pub node: u32,
    pub components: Components,
    pub place: Place,
}

/// `LOAD set, S, S1, L1, S2, L2, ...`.
pub fn combination(card: &Card, combinations: &mut Combinations) -> Result<(), Refused> {
    let whole = card.real(1)?.unwrap_or(1.0);
    let parts = combinations.entry(card.id(0, "the number of the combination")?).or_default();
    for i in (2..card.len()).step_by(2) {
        if !card.is_blank(i) || !card.is_blank(i + 1) {
            parts.push((card.id(i + 1, "the number of a load set")?, whole * card.real(i)?.unwrap_or(1.0)));
        }
    }
    Ok(())
}

/// The sets that `set` comes down to, itself with factor 1 among them.
pub fn parts(set: u32, combinations: &Combinations) -> BTreeMap<u32, f64> {
    let mut parts = BTreeMap::from([(set, 1.0)]);
    for &(part, factor) in combinations.get(&set).into_iter().flatten() {
        *parts.entry(part).or_insert(0.0) += factor;
    }
    parts
}

/// `FORCE set, G, CID, F, N1, N2, N3` and `MOMENT`. Along axes other than the basic ones any component may be loaded.
pub fn vector(card: &Card, first: u8) -> Result<Loaded, Refused> {
    let basic = card.optional_whole(2, "a coordinate system")?.unwrap_or(0) == 0;
    let mut digits = Vec::new();
    for (k, component) in (first..first + 3).enumerate() {
        if card.real(4 + k)?.unwrap_or(0.0) != 0.0 || !basic {
            digits.push(b'0' + component);
        }
    }
    loaded(card, 1, Components::parse(&digits).unwrap_or_default())
}

/// `SLOAD set, S1, F1, S2, F2, S3, F3`.
pub fn scalars(card: &Card) -> Result<Vec<Loaded>, Refused> {
    let at = [1, 3, 5].into_iter().filter(|&i| !card.is_blank(i));
    at.map(|i| loaded(card, i, Components::default())).collect()
}

fn loaded(card: &Card, at: usize, components: Components) -> Result<Loaded, Refused> {
    let set = card.id(0, "the number of a load set")?;
    Ok(Loaded { set, node: card.id(at, "a grid or scalar point")?, components, place: Place::of(card) })
}
