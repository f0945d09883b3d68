//! `RBE1`, `RBE2`, `RBE3`, `RBAR` and `RROD` as they stand on their cards; the others are in `joints`.

use super::spans::{Span, spans, spans_in};
use crate::deck::kinematics::components::Components;
use crate::deck::kinematics::mean::{Group, Mean};
use crate::deck::kinematics::rigid::{Rigid, Side};
use crate::deck::kinematics::rod::Rod;
use crate::deck::nastran::fault::CardFault;
use crate::deck::nastran::syntax::card::{Card, Refused};
use crate::deck::{Dof, Problem};

pub const POINT: &str = "a grid point";

/// An element, and its coefficient of thermal expansion.
pub struct Read<T> {
    pub element: T,
    pub alpha: f64,
}

/// `RBE2`: all components of `dependent` follow one point.
#[derive(Clone, Debug, PartialEq)]
pub struct Star {
    pub centre: u32,
    pub components: Components,
    pub dependent: Vec<Span>,
}

/// `RBE3`: the reference follows the mean of lists of points.
#[derive(Clone, Debug, PartialEq)]
pub struct Averaged {
    reference: u32,
    components: Components,
    groups: Vec<Weighted>,
    dependent: Side,
}

/// Points of one weight.
#[derive(Clone, Debug, PartialEq)]
struct Weighted {
    weight: f64,
    components: Components,
    points: Vec<Span>,
}

impl Averaged {
    /// Leaves translations of the connected points alone.
    pub fn drop_rotations(&mut self) {
        self.groups.iter_mut().for_each(|group| group.components = group.components.and(Components::TRANSLATIONS));
    }

    /// Whether the reference has components that do not depend, and no `UM` list says which do.
    pub fn is_partial(&self) -> bool {
        self.components != Components::ALL && self.dependent.is_empty()
    }

    /// The element that this makes of the points that `expand` finds in the lists.
    pub fn mean(&self, expand: impl Fn(&[Span]) -> Result<Vec<u32>, Problem>) -> Result<Mean, Problem> {
        let group = |group: &Weighted| {
            let nodes = expand(&group.points)?;
            Ok(Group { weight: group.weight, components: group.components, nodes })
        };
        let groups = self.groups.iter().map(group).collect::<Result<_, Problem>>()?;
        let (reference, components, dependent) = (self.reference, self.components, self.dependent.clone());
        Ok(Mean { reference, components, groups, dependent })
    }
}

/// `RBE2 id, GN, CM, GM1, GM2, ..., ALPHA`. MYSTRAN passes over GN among the others.
pub fn rbe2(card: &Card, is_mystran: bool) -> Result<Read<Star>, Refused> {
    let end = (3..card.len()).find(|&i| is_real(card, i)).unwrap_or(card.len());
    let centre = card.id(1, POINT)?;
    let mut dependent = spans(card, 3, end)?;
    dependent.retain(|span| !is_mystran || *span != Span { first: centre, last: centre });
    let star = Star { centre, components: card.some_components(2)?, dependent };
    Ok(Read { element: star, alpha: alpha(card, end)? })
}

/// `RBAR id, GA, GB, CNA, CNB, CMA, CMB, ALPHA`; without CMA and CMB all other components are dependent.
pub fn rbar(card: &Card) -> Result<Read<Rigid>, Refused> {
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
    Ok(Read { element: Rigid { independent: side(cna, cnb), dependent: side(cma, cmb) }, alpha: alpha(card, 7)? })
}

/// `RBE1 id, GN1, CN1, ..., UM, GM1, CM1, ..., ALPHA`; three pairs a line.
pub fn rbe1(card: &Card) -> Result<Read<Rigid>, Refused> {
    let mut fields = filled(card, 1);
    let um = fields.iter().position(|&i| is_word(card, i, b"UM")).unwrap_or(fields.len());
    let dependent = fields.split_off(um);
    let dependent = dependent.get(1..).unwrap_or_default();
    let (dependent, end) = pairs(card, dependent)?;
    let (independent, _) = pairs(card, &fields)?;
    Ok(Read { element: Rigid { independent, dependent }, alpha: end.map_or(Ok(0.0), |i| alpha(card, i))? })
}

/// `RROD id, GA, GB, CMA, CMB, ALPHA`.
pub fn rrod(card: &Card) -> Result<Read<Rod>, Refused> {
    let ends = [card.id(1, POINT)?, card.id(2, POINT)?];
    let (at, node) = if card.is_blank(3) || card.field(3) == b"0" { (4, ends[1]) } else { (3, ends[0]) };
    let set = card.some_components(at)?;
    let expected = || card.expected(at, "one translation, 1, 2 or 3, on one end of the rod");
    let component = set.iter().next().filter(|&c| set.len() == 1 && c <= 3).ok_or_else(expected)?;
    if at == 3 && !card.components(4)?.is_empty() {
        return Err(card.expected(4, "a blank, as the other end has the dependent component"));
    }
    Ok(Read { element: Rod { ends, dependent: Dof { node, component } }, alpha: alpha(card, 5)? })
}

/// `RBE3 id, , REFGRID, REFC, WT1, C1, G1, G2, ..., WT2, C2, ..., UM, GM1, CM1, ..., ALPHA, a`.
pub fn rbe3(card: &Card) -> Result<Read<Averaged>, Refused> {
    let (reference, components) = (card.id(2, POINT)?, card.some_components(3)?);
    let fields = filled(card, 4);
    let find = |word: &[u8]| fields.iter().position(|&i| is_word(card, i, word)).unwrap_or(fields.len());
    let (um, thermal) = (find(b"UM"), find(b"ALPHA"));
    let groups = groups(card, &fields[..um.min(thermal)])?;
    let named = if um < thermal { fields.get(um + 1..thermal) } else { fields.get(um + 1..) };
    let (dependent, _) = pairs(card, named.unwrap_or_default())?;
    let alpha = fields.get(thermal + 1).map_or(Ok(0.0), |&i| alpha(card, i))?;
    Ok(Read { element: Averaged { reference, components, groups, dependent }, alpha })
}

/// Weight, components and grid points; a real number starts the next group.
fn groups(card: &Card, fields: &[usize]) -> Result<Vec<Weighted>, Refused> {
    let mut groups: Vec<Weighted> = Vec::new();
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
        groups.push(Weighted { weight, components, points: spans_in(card, &points[..end])? });
        rest = &points[end..];
    }
    Ok(groups)
}

/// Grid points with their components, and the field of a real number that ends them.
fn pairs(card: &Card, fields: &[usize]) -> Result<(Side, Option<usize>), Refused> {
    let end = fields.iter().copied().find(|&i| is_real(card, i));
    let mut side = Side::new();
    for pair in fields[..fields.iter().position(|&i| Some(i) == end).unwrap_or(fields.len())].chunks(2) {
        let at = pair.get(1).copied().unwrap_or(pair[0] + 1);
        side.push((card.id(pair[0], POINT)?, card.some_components(at)?));
    }
    Ok((side, end))
}

pub fn filled(card: &Card, from: usize) -> Vec<usize> {
    (from..card.len()).filter(|&i| !card.is_blank(i)).collect()
}

pub fn is_word(card: &Card, i: usize, word: &[u8]) -> bool {
    card.field(i).eq_ignore_ascii_case(word)
}

/// A real number has a decimal point or an exponent.
pub fn is_real(card: &Card, i: usize) -> bool {
    let word = card.field(i);
    let marks = |(k, byte): (usize, &u8)| b".eEdD".contains(byte) || k > 0 && b"+-".contains(byte);
    word.iter().enumerate().any(marks) && crate::deck::nastran::syntax::number::real(word).is_ok()
}

pub fn alpha(card: &Card, i: usize) -> Result<f64, Refused> {
    Ok(card.real(i)?.unwrap_or(0.0))
}

/// The element that a star makes of the points of its list.
pub fn star(star: &Star, nodes: Vec<u32>) -> Result<Rigid, Problem> {
    if nodes.is_empty() {
        return Err(CardFault::NothingConnected.into());
    }
    let dependent = nodes.into_iter().map(|node| (node, star.components)).collect();
    Ok(Rigid { independent: vec![(star.centre, Components::ALL)], dependent })
}
