//! Reads the cards of rigid and interpolation elements: `RBE1`, `RBE2`, `RBE3`, `RBAR`, `RROD`, `RBAR1`, `RJOINT`, `RTRPLT`, `RTRPLT1`, and
//! OptiStruct's `JOINTG`.
//!
//! Each function reads the fields of one kind of card. It returns the element and its coefficient of thermal expansion. `model` turns the
//! elements into equations.

use super::points::{PointSpan, spans, spans_in};
use crate::deck::Dof;
use crate::deck::kinematics::components::Components;
use crate::deck::kinematics::mean::{MeanElement, WeightedNodes};
use crate::deck::kinematics::rigid::{NodeComponents, RigidElement, RigidRod};
use crate::deck::nastran::syntax::card::{BulkCard, CardRefusal};

const POINT: &str = "a grid point";

/// An element and its coefficient of thermal expansion.
type Expanding = (NastranElement, f64);

/// A rigid or interpolating element.
#[derive(Clone, Debug)]
pub enum NastranElement {
    Star(RigidStar),
    Rigid(RigidElement),
    Rod(RigidRod),
    Mean(MeanElement<PointSpan>),
    /// An `RBE3` of MYSTRAN.
    MystranMean(MeanElement<PointSpan>),
    /// A rigid coupling of points that must coincide.
    Joint(RigidElement),
}

/// An `RBE2`: the `components` of all dependent points follow the centre.
#[derive(Clone, Debug)]
pub struct RigidStar {
    pub centre: u32,
    pub components: Components,
    pub dependent: Vec<PointSpan>,
}

/// Reads `RBE2 id, GN, CM, GM1, GM2, ..., ALPHA`. If the centre GN is also among the dependent points, MYSTRAN ignores it there.
pub fn rbe2(card: &BulkCard, is_mystran: bool) -> Result<Expanding, CardRefusal> {
    let end = (3..card.len()).find(|&i| is_real(card, i)).unwrap_or(card.len());
    let centre = card.id(1, POINT)?;
    let mut dependent = spans(card, 3, end)?;
    dependent.retain(|span| !is_mystran || *span != PointSpan { first: centre, last: centre });
    let star = RigidStar { centre, components: card.some_components(2)?, dependent };
    Ok((NastranElement::Star(star), alpha(card, end)?))
}

/// Reads `RBAR id, GA, GB, CNA, CNB, CMA, CMB, ALPHA`. If CMA and CMB are blank, all components that are not independent are dependent.
pub fn rbar(card: &BulkCard) -> Result<Expanding, CardRefusal> {
    let (a, b) = (card.id(1, POINT)?, card.id(2, POINT)?);
    let [cna, cnb, cma, cmb] = [card.components(3)?, card.components(4)?, card.components(5)?, card.components(6)?];
    let cna = if cna.is_empty() && cnb.is_empty() { Components::ALL } else { cna };
    let [cma, cmb] = if cma.is_empty() && cmb.is_empty() {
        [Components::ALL.without(cna), Components::ALL.without(cnb)]
    } else {
        [cma, cmb]
    };
    let element = rigid([a, b], [cna, cnb], [cma, cmb]);
    Ok((element, alpha(card, 7)?))
}

/// Reads `RBE1 id, GN1, CN1, ..., UM, GM1, CM1, ..., ALPHA`, with three pairs of point and components on a line.
pub fn rbe1(card: &BulkCard) -> Result<Expanding, CardRefusal> {
    let mut fields = filled(card, 1);
    let um = fields.iter().position(|&i| is_word(card, i, b"UM")).unwrap_or(fields.len());
    let dependent = fields.split_off(um);
    let dependent = dependent.get(1..).unwrap_or_default();
    let (dependent, end) = pairs(card, dependent)?;
    let (independent, _) = pairs(card, &fields)?;
    let element = NastranElement::Rigid(RigidElement { independent, dependent });
    Ok((element, end.map_or(Ok(0.0), |i| alpha(card, i))?))
}

/// Reads `RROD id, GA, GB, CMA, CMB, ALPHA`.
pub fn rrod(card: &BulkCard) -> Result<Expanding, CardRefusal> {
    let ends = [card.id(1, POINT)?, card.id(2, POINT)?];
    let (at, node) = if card.is_blank(3) || card.field(3) == b"0" { (4, ends[1]) } else { (3, ends[0]) };
    let set = card.some_components(at)?;
    let expected = || card.expected(at, "one translation, 1, 2 or 3, on one end of the rod");
    let component = set.iter().next().filter(|&c| set.len() == 1 && c <= 3).ok_or_else(expected)?;
    if at == 3 && !card.components(4)?.is_empty() {
        return Err(card.expected(4, "a blank, as the other end has the dependent component"));
    }
    let rod = RigidRod { ends, dependent: Dof { node, component } };
    Ok((NastranElement::Rod(rod), alpha(card, 5)?))
}

/// Reads `RBE3 id, , REFGRID, REFC, WT1, C1, G1, G2, ..., WT2, C2, ..., UM, GM1, CM1, ..., ALPHA, a`.
///
/// MYSTRAN uses only translations of the connected points. Without a `UM` list, its equations are those of `kinematics/mystran_mean`.
pub fn rbe3(card: &BulkCard, is_mystran: bool) -> Result<Expanding, CardRefusal> {
    let (reference, components) = (card.id(2, POINT)?, card.some_components(3)?);
    let fields = filled(card, 4);
    let find = |word: &[u8]| fields.iter().position(|&i| is_word(card, i, word)).unwrap_or(fields.len());
    let (um, thermal) = (find(b"UM"), find(b"ALPHA"));
    let mut groups = groups(card, &fields[..um.min(thermal)])?;
    let named = if um < thermal { fields.get(um + 1..thermal) } else { fields.get(um + 1..) };
    let (dependent, _) = pairs(card, named.unwrap_or_default())?;
    let alpha = fields.get(thermal + 1).map_or(Ok(0.0), |&i| alpha(card, i))?;
    if is_mystran {
        groups.iter_mut().for_each(|group| group.components = group.components.and(Components::TRANSLATIONS));
    }
    let is_own = is_mystran && dependent.is_empty();
    let element = MeanElement { reference, components, groups, dependent };
    Ok((if is_own { NastranElement::MystranMean(element) } else { NastranElement::Mean(element) }, alpha))
}

/// Reads the groups of `RBE3`: weight, components and grid points. A real number is the weight of the next group.
fn groups(card: &BulkCard, fields: &[usize]) -> Result<Vec<WeightedNodes<PointSpan>>, CardRefusal> {
    let mut groups: Vec<WeightedNodes<PointSpan>> = Vec::new();
    let mut rest = fields;
    while let [i, after @ ..] = rest {
        if !is_real(card, *i) {
            card.id(*i, "a grid point, or a weight with a decimal point")?;
            return Err(card.expected(*i, "a weight with a decimal point"));
        }
        let weight = card.real(*i)?.unwrap_or(0.0);
        let components = card.some_components(after.first().copied().unwrap_or(i + 1))?;
        let points = after.get(1..).unwrap_or_default();
        let end = points.iter().position(|&i| is_real(card, i)).unwrap_or(points.len());
        groups.push(WeightedNodes { weight, components, nodes: spans_in(card, &points[..end])? });
        rest = &points[end..];
    }
    Ok(groups)
}

/// Reads pairs of grid point and components up to the first real number. Also returns the index of that number's field, if there is one.
fn pairs(card: &BulkCard, fields: &[usize]) -> Result<(NodeComponents, Option<usize>), CardRefusal> {
    let end = fields.iter().copied().find(|&i| is_real(card, i));
    let mut found = NodeComponents::new();
    for pair in fields[..fields.iter().position(|&i| Some(i) == end).unwrap_or(fields.len())].chunks(2) {
        let at = pair.get(1).copied().unwrap_or(pair[0] + 1);
        found.push((card.id(pair[0], POINT)?, card.some_components(at)?));
    }
    Ok((found, end))
}

/// Indices of the fields from `from` on that are not blank.
pub fn filled(card: &BulkCard, from: usize) -> Vec<usize> {
    (from..card.len()).filter(|&i| !card.is_blank(i)).collect()
}

pub fn is_word(card: &BulkCard, i: usize, word: &[u8]) -> bool {
    card.field(i).eq_ignore_ascii_case(word)
}

/// Whether field `i` holds a real number, that is, a number with a decimal point or an exponent.
pub fn is_real(card: &BulkCard, i: usize) -> bool {
    let word = card.field(i);
    let marks = |(k, byte): (usize, &u8)| b".eEdD".contains(byte) || k > 0 && b"+-".contains(byte);
    word.iter().enumerate().any(marks) && crate::deck::nastran::syntax::number::real(word).is_ok()
}

fn alpha(card: &BulkCard, i: usize) -> Result<f64, CardRefusal> {
    Ok(card.real(i)?.unwrap_or(0.0))
}

/// Reads `RBAR1 id, GA, GB, CB, ALPHA`: the components CB of GB follow GA.
pub fn rbar1(card: &BulkCard) -> Result<Expanding, CardRefusal> {
    let element = follow(card, [1, 2], all_or(card, 3)?)?;
    Ok((NastranElement::Rigid(element), alpha(card, 4)?))
}

/// Reads `RJOINT id, GA, GB, CB`: the components CB of GB follow GA. The two points must coincide.
pub fn rjoint(card: &BulkCard) -> Result<Expanding, CardRefusal> {
    follow(card, [1, 2], all_or(card, 3)?).map(|element| (NastranElement::Joint(element), 0.0))
}

/// Reads `RTRPLT id, GA, GB, GC, CNA, CNB, CNC, , CMA, CMB, CMC, ALPHA`. If CMA, CMB and CMC are blank, all components that are not
/// independent are dependent.
pub fn rtrplt(card: &BulkCard) -> Result<Expanding, CardRefusal> {
    let points = [card.id(1, POINT)?, card.id(2, POINT)?, card.id(3, POINT)?];
    let sets = |from: usize| Ok([card.components(from)?, card.components(from + 1)?, card.components(from + 2)?]);
    let (independent, dependent) = (sets(4)?, sets(8)?);
    let is_given = dependent.iter().any(|set| !set.is_empty());
    let dependent = if is_given { dependent } else { independent.map(|set| Components::ALL.without(set)) };
    Ok((rigid(points, independent, dependent), alpha(card, 11)?))
}

/// A rigid element with these independent and dependent components at each of the points.
fn rigid<const N: usize>(points: [u32; N], independent: [Components; N], dependent: [Components; N]) -> NastranElement {
    let filled = |sets: [Components; N]| points.into_iter().zip(sets).filter(|(_, set)| !set.is_empty()).collect();
    NastranElement::Rigid(RigidElement { independent: filled(independent), dependent: filled(dependent) })
}

/// Reads `RTRPLT1 id, GA, GB, GC, CB, CC, ALPHA`: the components CB of GB and CC of GC follow GA.
pub fn rtrplt1(card: &BulkCard) -> Result<Expanding, CardRefusal> {
    let mut element = follow(card, [1, 2], all_or(card, 4)?)?;
    element.dependent.push((card.id(3, POINT)?, all_or(card, 5)?));
    Ok((NastranElement::Rigid(element), alpha(card, 6)?))
}

/// Reads `JOINTG id, property, type, G1, CID1, G2, CID2`. Returns `None` for a type that this reader does not support.
///
/// The type `RBEAM` couples the second point rigidly to the first. The type `BALL` couples only translations, and the points must coincide.
pub fn jointg(card: &BulkCard) -> Result<Option<Expanding>, CardRefusal> {
    Ok(match card.field(2).to_ascii_uppercase().as_slice() {
        b"RBEAM" => Some((NastranElement::Rigid(follow(card, [3, 5], Components::ALL)?), 0.0)),
        b"BALL" => Some((NastranElement::Joint(follow(card, [3, 5], Components::TRANSLATIONS)?), 0.0)),
        _ => None,
    })
}

/// The rigid element by which the components `set` of the second point follow the first point.
fn follow(card: &BulkCard, [first, second]: [usize; 2], set: Components) -> Result<RigidElement, CardRefusal> {
    Ok(RigidElement::about(card.id(first, POINT)?, [card.id(second, POINT)?], set))
}

/// The components in a field; all six if it is blank.
fn all_or(card: &BulkCard, i: usize) -> Result<Components, CardRefusal> {
    if card.is_blank(i) { Ok(Components::ALL) } else { card.some_components(i) }
}
