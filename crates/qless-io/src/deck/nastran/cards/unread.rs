//! Cards that constrain in ways this reader does not follow; a warning says what stays free.

use crate::deck::nastran::syntax::card::Card;
use crate::number::whole;

/// Where the grid points stand that a card constrains, as data fields from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Listed {
    /// Every second field from this one, each before its components.
    Pairs(usize),
    /// A first point, and then pairs.
    Spline,
    /// Not on the card.
    Elsewhere,
}

use Listed::{Elsewhere, Pairs, Spline};

/// A card that is not understood.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unread {
    name: &'static str,
    what: &'static str,
    listed: Listed,
    /// Whether it constrains, so that without it the model is incomplete.
    pub constrains: bool,
}

const fn unread(name: &'static str, what: &'static str, listed: Listed) -> Unread {
    Unread { name, what, listed, constrains: true }
}

/// A card that only limits how things move, or says something of such a card.
const fn harmless(name: &'static str, what: &'static str) -> Unread {
    Unread { name, what, listed: Elsewhere, constrains: false }
}

const UNREAD: [Unread; 50] = [
    unread("RSPLINE", "is an interpolation element", Spline),
    unread("RBE2GS", "is a rigid element that searches its grid points", Elsewhere),
    unread("RBE2A", "is a rigid element", Elsewhere),
    unread("RBE2F", "is a rigid element", Elsewhere),
    unread("RBE3U", "is an interpolation element", Elsewhere),
    unread("RSSCON", "joins shells to solids", Elsewhere),
    unread("MPCAX", "is a multipoint constraint", Elsewhere),
    unread("MPCY", "is a multipoint constraint", Elsewhere),
    unread("MPCD", "gives a multipoint constraint its right-hand side", Elsewhere),
    unread("SPCAX", "is a single-point constraint", Elsewhere),
    unread("SPC2", "is a single-point constraint", Elsewhere),
    unread("SPCR", "is a single-point constraint relative to an earlier step", Elsewhere),
    unread("GMSPC", "is a constraint on geometry", Elsewhere),
    unread("GMBC", "is a constraint on geometry", Elsewhere),
    unread("CWELD", "joins its parts by equations", Elsewhere),
    unread("CFAST", "joins its parts by equations", Elsewhere),
    unread("CSEAM", "joins its parts by equations", Elsewhere),
    unread("BGSET", "glues surfaces together", Elsewhere),
    unread("BGADD", "glues surfaces together", Elsewhere),
    unread("BCTABLE", "is contact, which can glue", Elsewhere),
    unread("BCTABL1", "is contact, which can glue", Elsewhere),
    harmless("BCTSET", "is contact"),
    harmless("BCTADD", "is contact"),
    unread("TIE", "ties surfaces", Elsewhere),
    unread("JOINTM", "gives a joint a motion", Elsewhere),
    unread("MOTNJG", "gives a joint a motion", Elsewhere),
    unread("PRETENS", "is a section with pretension", Elsewhere),
    unread("CINTC", "joins its parts by equations", Elsewhere),
    unread("GMINTC", "joins its parts by equations", Elsewhere),
    unread("GMINTS", "joins its parts by equations", Elsewhere),
    unread("CYJOIN", "joins the sides of a cyclic segment", Elsewhere),
    unread("CYSYM", "is cyclic symmetry", Elsewhere),
    unread("CYAX", "is cyclic symmetry", Elsewhere),
    unread("SUPORT", "fixes reference components where there is no inertia relief", Pairs(0)),
    unread("SUPORT1", "fixes reference components where there is no inertia relief", Pairs(1)),
    unread("SUPAX", "fixes reference components", Elsewhere),
    unread("SESET", "makes a superelement", Elsewhere),
    unread("CSUPER", "joins a superelement", Elsewhere),
    unread("CSUPEXT", "joins a superelement", Elsewhere),
    unread("SEBSET", "is a set of a superelement", Elsewhere),
    unread("SEBSET1", "is a set of a superelement", Elsewhere),
    unread("SECSET", "is a set of a superelement", Elsewhere),
    unread("SECSET1", "is a set of a superelement", Elsewhere),
    unread("SEQSET", "is a set of a superelement", Elsewhere),
    unread("SEQSET1", "is a set of a superelement", Elsewhere),
    unread("SESUP", "fixes reference components of a superelement", Elsewhere),
    unread("SEBNDRY", "joins superelements", Elsewhere),
    unread("SECONCT", "joins superelements", Elsewhere),
    unread("SEMPLN", "joins superelements", Elsewhere),
    unread("RELEASE", "releases components between superelements", Elsewhere),
];

/// The names of such cards.
pub fn names() -> impl Iterator<Item = &'static str> {
    UNREAD.iter().map(|entry| entry.name)
}

/// What is said of a `JOINTG` whose type is not understood.
pub fn joint(card: &Card) -> String {
    let kind = String::from_utf8_lossy(card.field(2)).into_owned();
    let points: Vec<String> = [3, 5].into_iter().filter_map(|i| whole(card.field(i))).map(|i| i.to_string()).collect();
    format!(
        "{} is a joint of type {kind} of grid points {}; it is not understood and left out",
        card.title(),
        few(&points)
    )
}

impl Unread {
    /// The entry of a card's name in capitals.
    pub fn of(name: &str) -> Option<&'static Self> {
        UNREAD.iter().find(|entry| entry.name == name)
    }

    /// One sentence: what the card is and which grid points it names.
    pub fn warning(&self, card: &Card) -> String {
        let points = self.points(card);
        let on = if points.is_empty() { String::new() } else { format!(" of grid points {}", few(&points)) };
        format!("{} {}{on}; it is not understood and left out", card.title(), self.what)
    }

    fn points(&self, card: &Card) -> Vec<String> {
        let fields: Vec<usize> = match self.listed {
            Pairs(from) => (from..card.len()).step_by(2).collect(),
            Spline => std::iter::once(2).chain((3..card.len()).step_by(2)).collect(),
            Elsewhere => Vec::new(),
        };
        fields.into_iter().filter_map(|i| whole(card.field(i))).map(|node| node.to_string()).collect()
    }
}

/// The first few of a list.
fn few(points: &[String]) -> String {
    const SHOWN: usize = 12;
    let rest = points.len().saturating_sub(SHOWN);
    let more = if rest > 0 { format!(" and {rest} more") } else { String::new() };
    format!("{}{more}", points[..points.len().min(SHOWN)].join(", "))
}
