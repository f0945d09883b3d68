//! Reads load cards: `LOAD` combines load sets; `FORCE`, `MOMENT` and `SLOAD` load components of points.
//!
//! Only the loaded components are kept, not the values of the loads.

use std::collections::BTreeMap;

use crate::deck::kinematics::components::Components;
use crate::deck::nastran::syntax::card::{BulkCard, CardLocation, CardRefusal};

/// For each number of a `LOAD` card, the load sets that it combines, with their factors.
pub type LoadCombinations = BTreeMap<u32, Vec<(u32, f64)>>;

/// Components of a point that a card loads.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedComponents {
    pub set: u32,
    pub node: u32,
    pub components: Components,
    pub place: CardLocation,
}

/// Reads `LOAD set, S, S1, L1, S2, L2, ...`: the set combines load sets L1, L2, ... with the factors S S1, S S2, ...
pub fn combination(card: &BulkCard, combinations: &mut LoadCombinations) -> Result<(), CardRefusal> {
    let overall = card.real(1)?.unwrap_or(1.0);
    let parts = combinations.entry(card.id(0, "the number of the combination")?).or_default();
    for i in (2..card.len()).step_by(2) {
        if !card.is_blank(i) || !card.is_blank(i + 1) {
            parts.push((card.id(i + 1, "the number of a load set")?, overall * card.real(i)?.unwrap_or(1.0)));
        }
    }
    Ok(())
}

/// The load sets that `set` combines, with their factors; also `set` itself, with the factor 1.
pub fn parts(set: u32, combinations: &LoadCombinations) -> BTreeMap<u32, f64> {
    let mut parts = BTreeMap::from([(set, 1.0)]);
    for &(part, factor) in combinations.get(&set).into_iter().flatten() {
        *parts.entry(part).or_insert(0.0) += factor;
    }
    parts
}

/// Reads `FORCE set, G, CID, F, N1, N2, N3`, or `MOMENT` with the same fields. If CID is not the basic system, all three components count
/// as loaded.
pub fn vector(card: &BulkCard, first: u8) -> Result<LoadedComponents, CardRefusal> {
    let basic = card.optional_whole(2, "a coordinate system")?.unwrap_or(0) == 0;
    let mut digits = Vec::new();
    for (k, component) in (first..first + 3).enumerate() {
        if card.real(4 + k)?.unwrap_or(0.0) != 0.0 || !basic {
            digits.push(b'0' + component);
        }
    }
    loaded(card, 1, Components::parse(&digits).unwrap_or_default())
}

/// Reads `SLOAD set, S1, F1, S2, F2, S3, F3`, which loads scalar points.
pub fn scalars(card: &BulkCard) -> Result<Vec<LoadedComponents>, CardRefusal> {
    let at = [1, 3, 5].into_iter().filter(|&i| !card.is_blank(i));
    at.map(|i| loaded(card, i, Components::default())).collect()
}

fn loaded(card: &BulkCard, at: usize, components: Components) -> Result<LoadedComponents, CardRefusal> {
    let set = card.id(0, "the number of a load set")?;
    Ok(LoadedComponents {
        set,
        node: card.id(at, "a grid or scalar point")?,
        components,
        place: CardLocation::new(card),
    })
}
