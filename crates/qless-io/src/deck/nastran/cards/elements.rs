//! Cards of rigid and interpolation elements: `RBE1`, `RBE2`, `RBE3`, `RBAR`, `RROD`, `RBAR1`, `RJOINT`, `RTRPLT`, `RTRPLT1`, and
//! OptiStruct's `JOINTG`.
//!
//! Each function reads the fields of one kind of card; `model` turns the elements into equations.

use super::points::{PointSpan, spans, spans_in};
use crate::deck::kinematics::components::Components;
use crate::deck::kinematics::mean::{Group, Mean};
use crate::deck::kinematics::rigid::{Rigid, Side};
use crate::deck::kinematics::rod::Rod;
use crate::deck::nastran::syntax::card::{BulkCard, CardRefusal};
use crate::deck::{CardFault, Dof, Problem};

pub const POINT: &str = "a grid point";

/// An element and its coefficient of thermal expansion.
pub struct ElementCard<T> {
    pub element: T,
    pub alpha: f64,
}

/// A rigid or interpolating element.
#[derive(Clone, Debug)]
pub enum NastranElement {
    Star(RigidStar),
    Rigid(Rigid),
    Rod(Rod),
    Mean(WeightedMean),
    /// A mean over the motions in the given components of the reference only.
    PartialMean(WeightedMean),
    /// A rigid coupling of points that must coincide.
    Joint(Rigid),
}

/// `RBE2`: `components` of all dependent points follow the centre.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidStar {
    pub centre: u32,
    pub components: Components,
    pub dependent: Vec<PointSpan>,
}

/// `RBE3`: the reference follows the weighted mean of groups of points.
#[derive(Clone, Debug, PartialEq)]
pub struct WeightedMean {
    reference: u32,
    components: Components,
    groups: Vec<WeightGroup>,
    dependent: Side,
}

/// Points with a common weight.
#[derive(Clone, Debug, PartialEq)]
struct WeightGroup {
    weight: f64,
    components: Components,
    points: Vec<PointSpan>,
}

impl WeightedMean {
    /// Ignores the rotations of the connected points.
    pub fn drop_rotations(&mut self) {
        self.groups.iter_mut().for_each(|group| group.components = group.components.and(Components::TRANSLATIONS));
    }

    /// Whether only some components of the reference are dependent, and the element has no `UM` list.
    pub fn is_partial(&self) -> bool {
        self.components != Components::ALL && self.dependent.is_empty()
    }

    /// The element, with lists of points resolved by `expand`.
    pub fn mean(&self, expand: impl Fn(&[PointSpan]) -> Result<Vec<u32>, Problem>) -> Result<Mean, Problem> {
        let group = |group: &WeightGroup| {
            let nodes = expand(&group.points)?;
            Ok(Group { weight: group.weight, components: group.components, nodes })
        };
        let groups = self.groups.iter().map(group).collect::<Result<_, Problem>>()?;
        let (reference, components, dependent) = (self.reference, self.components, self.dependent.clone());
        Ok(Mean { reference, components, groups, dependent })
    }
}

/// `RBE2 id, GN, CM, GM1, GM2, ..., ALPHA`. MYSTRAN ignores GN among the dependent points.
pub fn rbe2(card: &BulkCard, is_mystran: bool) -> Result<ElementCard<RigidStar>, CardRefusal> {
    let end = (3..card.len()).find(|&i| is_real(card, i)).unwrap_or(card.len());
    let centre = card.id(1, POINT)?;
    let mut dependent = spans(card, 3, end)?;
    dependent.retain(|span| !is_mystran || *span != PointSpan { first: centre, last: centre });
    let star = RigidStar { centre, components: card.some_components(2)?, dependent };
    Ok(ElementCard { element: star, alpha: alpha(card, end)? })
}

/// `RBAR id, GA, GB, CNA, CNB, CMA, CMB, ALPHA`; without CMA and CMB all other components are dependent.
pub fn rbar(card: &BulkCard) -> Result<ElementCard<Rigid>, CardRefusal> {
    let (a, b) = (card.id(1, POINT)?, card.id(2, POINT)?);
    let [cna, cnb, cma, cmb] = [card.components(3)?, card.components(4)?, card.components(5)?, card.components(6)?];
    let cna = if cna.is_empty() && cnb.is_empty() { Components::ALL } else { cna };
    let [cma, cmb] = if cma.is_empty() && cmb.is_empty() {
        [Components::ALL.without(cna), Components::ALL.without(cnb)]
    } else {
        [cma, cmb]
    };
    let side = |of_a: Components, of_b: Components| {
        [(a, of_a), (b, of_b)].into_iter().filter(|(_, set)| !set.is_empty()).collect::<Side>()
    };
    Ok(ElementCard {
        element: Rigid { independent: side(cna, cnb), dependent: side(cma, cmb) },
        alpha: alpha(card, 7)?,
    })
}

/// `RBE1 id, GN1, CN1, ..., UM, GM1, CM1, ..., ALPHA`; three pairs a line.
pub fn rbe1(card: &BulkCard) -> Result<ElementCard<Rigid>, CardRefusal> {
    let mut fields = filled(card, 1);
    let um = fields.iter().position(|&i| is_word(card, i, b"UM")).unwrap_or(fields.len());
    let dependent = fields.split_off(um);
    let dependent = dependent.get(1..).unwrap_or_default();
    let (dependent, end) = pairs(card, dependent)?;
    let (independent, _) = pairs(card, &fields)?;
    Ok(ElementCard { element: Rigid { independent, dependent }, alpha: end.map_or(Ok(0.0), |i| alpha(card, i))? })
}

/// `RROD id, GA, GB, CMA, CMB, ALPHA`.
pub fn rrod(card: &BulkCard) -> Result<ElementCard<Rod>, CardRefusal> {
    let ends = [card.id(1, POINT)?, card.id(2, POINT)?];
    let (at, node) = if card.is_blank(3) || card.field(3) == b"0" { (4, ends[1]) } else { (3, ends[0]) };
    let set = card.some_components(at)?;
    let expected = || card.expected(at, "one translation, 1, 2 or 3, on one end of the rod");
    let component = set.iter().next().filter(|&c| set.len() == 1 && c <= 3).ok_or_else(expected)?;
    if at == 3 && !card.components(4)?.is_empty() {
        return Err(card.expected(4, "a blank, as the other end has the dependent component"));
    }
    Ok(ElementCard { element: Rod { ends, dependent: Dof { node, component } }, alpha: alpha(card, 5)? })
}

/// `RBE3 id, , REFGRID, REFC, WT1, C1, G1, G2, ..., WT2, C2, ..., UM, GM1, CM1, ..., ALPHA, a`.
pub fn rbe3(card: &BulkCard) -> Result<ElementCard<WeightedMean>, CardRefusal> {
    let (reference, components) = (card.id(2, POINT)?, card.some_components(3)?);
    let fields = filled(card, 4);
    let find = |word: &[u8]| fields.iter().position(|&i| is_word(card, i, word)).unwrap_or(fields.len());
    let (um, thermal) = (find(b"UM"), find(b"ALPHA"));
    let groups = groups(card, &fields[..um.min(thermal)])?;
    let named = if um < thermal { fields.get(um + 1..thermal) } else { fields.get(um + 1..) };
    let (dependent, _) = pairs(card, named.unwrap_or_default())?;
    let alpha = fields.get(thermal + 1).map_or(Ok(0.0), |&i| alpha(card, i))?;
    Ok(ElementCard { element: WeightedMean { reference, components, groups, dependent }, alpha })
}

/// Weight, components and grid points; a real number starts the next group.
fn groups(card: &BulkCard, fields: &[usize]) -> Result<Vec<WeightGroup>, CardRefusal> {
    let mut groups: Vec<WeightGroup> = Vec::new();
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
        groups.push(WeightGroup { weight, components, points: spans_in(card, &points[..end])? });
        rest = &points[end..];
    }
    Ok(groups)
}

/// Pairs of grid point and components, and the field of the real number that ends them, if any.
fn pairs(card: &BulkCard, fields: &[usize]) -> Result<(Side, Option<usize>), CardRefusal> {
    let end = fields.iter().copied().find(|&i| is_real(card, i));
    let mut side = Side::new();
    for pair in fields[..fields.iter().position(|&i| Some(i) == end).unwrap_or(fields.len())].chunks(2) {
        let at = pair.get(1).copied().unwrap_or(pair[0] + 1);
        side.push((card.id(pair[0], POINT)?, card.some_components(at)?));
    }
    Ok((side, end))
}

pub fn filled(card: &BulkCard, from: usize) -> Vec<usize> {
    (from..card.len()).filter(|&i| !card.is_blank(i)).collect()
}

pub fn is_word(card: &BulkCard, i: usize, word: &[u8]) -> bool {
    card.field(i).eq_ignore_ascii_case(word)
}

/// A real number has a decimal point or an exponent.
pub fn is_real(card: &BulkCard, i: usize) -> bool {
    let word = card.field(i);
    let marks = |(k, byte): (usize, &u8)| b".eEdD".contains(byte) || k > 0 && b"+-".contains(byte);
    word.iter().enumerate().any(marks) && crate::deck::nastran::syntax::number::real(word).is_ok()
}

pub fn alpha(card: &BulkCard, i: usize) -> Result<f64, CardRefusal> {
    Ok(card.real(i)?.unwrap_or(0.0))
}

/// The rigid element of a star, given the resolved list of its points.
pub fn star(star: &RigidStar, nodes: Vec<u32>) -> Result<Rigid, Problem> {
    if nodes.is_empty() {
        return Err(CardFault::NothingConnected.into());
    }
    let dependent = nodes.into_iter().map(|node| (node, star.components)).collect();
    Ok(Rigid { independent: vec![(star.centre, Components::ALL)], dependent })
}

/// `RBAR1 id, GA, GB, CB, ALPHA`: components CB of one end follow the other.
pub fn rbar1(card: &BulkCard) -> Result<ElementCard<Rigid>, CardRefusal> {
    let element = follow(card, [1, 2], all_or(card, 3)?)?;
    Ok(ElementCard { element, alpha: alpha(card, 4)? })
}

/// `RJOINT id, GA, GB, CB`: the same for two points that coincide.
pub fn rjoint(card: &BulkCard) -> Result<Rigid, CardRefusal> {
    follow(card, [1, 2], all_or(card, 3)?)
}

/// `RTRPLT id, GA, GB, GC, CNA, CNB, CNC, , CMA, CMB, CMC, ALPHA`; without CM all other components are dependent.
pub fn rtrplt(card: &BulkCard) -> Result<ElementCard<Rigid>, CardRefusal> {
    let points = [card.id(1, POINT)?, card.id(2, POINT)?, card.id(3, POINT)?];
    let sets = |from: usize| Ok([card.components(from)?, card.components(from + 1)?, card.components(from + 2)?]);
    let (independent, dependent) = (sets(4)?, sets(8)?);
    let is_given = dependent.iter().any(|set| !set.is_empty());
    let dependent = if is_given { dependent } else { independent.map(|set| Components::ALL.without(set)) };
    let side =
        |sets: [Components; 3]| points.into_iter().zip(sets).filter(|(_, set)| !set.is_empty()).collect::<Side>();
    let element = Rigid { independent: side(independent), dependent: side(dependent) };
    Ok(ElementCard { element, alpha: alpha(card, 11)? })
}

/// `RTRPLT1 id, GA, GB, GC, CB, CC, ALPHA`: components of two corners follow the third.
pub fn rtrplt1(card: &BulkCard) -> Result<ElementCard<Rigid>, CardRefusal> {
    let mut element = follow(card, [1, 2], all_or(card, 4)?)?;
    element.dependent.push((card.id(3, POINT)?, all_or(card, 5)?));
    Ok(ElementCard { element, alpha: alpha(card, 6)? })
}

/// An element of a `JOINTG` card, by its type.
#[derive(Clone, Debug, PartialEq)]
pub enum JointElement {
    /// `RBEAM`: the second point follows the first rigidly.
    Beam(Rigid),
    /// `BALL`: the second point may rotate; both points must coincide.
    Ball(Rigid),
    /// A type that this reader does not support.
    Other,
}

/// `JOINTG id, property, type, G1, CID1, G2, CID2`.
pub fn jointg(card: &BulkCard) -> Result<JointElement, CardRefusal> {
    match card.field(2).to_ascii_uppercase().as_slice() {
        b"RBEAM" => follow(card, [3, 5], Components::ALL).map(JointElement::Beam),
        b"BALL" => {
            let translations = (1..=3).map(Components::one).fold(Components::ALL, Components::without);
            follow(card, [3, 5], Components::ALL.without(translations)).map(JointElement::Ball)
        }
        _ => Ok(JointElement::Other),
    }
}

/// The rigid element by which components of the second point follow the first.
fn follow(card: &BulkCard, [first, second]: [usize; 2], set: Components) -> Result<Rigid, CardRefusal> {
    let (first, second) = (card.id(first, POINT)?, card.id(second, POINT)?);
    Ok(Rigid { independent: vec![(first, Components::ALL)], dependent: vec![(second, set)] })
}

/// The components in a field; all six if it is blank.
fn all_or(card: &BulkCard, i: usize) -> Result<Components, CardRefusal> {
    if card.is_blank(i) { Ok(Components::ALL) } else { card.some_components(i) }
}
