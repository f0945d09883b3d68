//! Cards that this reader does not understand, and the notes for the user about them.
//!
//! [`UnreadCard`] lists known cards that constrain in unsupported ways. All other names go through [`UnknownNames`]: a name that sounds
//! like a constraint leaves the model incomplete, common cards (elements, materials, loads, ...) are skipped, and any other name is
//! reported once.

use std::sync::LazyLock;

use rustc_hash::FxHashSet;

use crate::deck::Model;
use crate::deck::nastran::syntax::card::BulkCard;
use crate::deck::nastran::syntax::lines::FileLine;
use crate::number::whole;

/// The kind of a note.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum NoteKind {
    /// Information for the user.
    Warning,
    /// A constraint was left out.
    LeftOut,
    /// The solver refuses the line.
    Refusal,
}

/// Notes about lines of the deck, in the order of the cards.
#[derive(Debug, Default)]
pub struct CardNotes(Vec<(FileLine, NoteKind, String)>);

impl CardNotes {
    pub fn warn(&mut self, at: FileLine, text: String) {
        self.0.push((at, NoteKind::Warning, text));
    }

    pub fn leave_out(&mut self, at: FileLine, text: String) {
        self.0.push((at, NoteKind::LeftOut, text));
    }

    pub fn refuse(&mut self, at: FileLine, text: String) {
        self.0.push((at, NoteKind::Refusal, text));
    }

    /// Adds all notes to the model.
    pub fn tell(self, model: &mut Model) {
        for ((file, line), kind, text) in self.0 {
            match kind {
                NoteKind::Warning => model.warn(file, line, text),
                NoteKind::LeftOut => model.leave_out(file, line, text),
                NoteKind::Refusal => model.refuse(file, line, text),
            }
        }
    }
}

/// The data fields, from 0, that list the grid points of a card.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ListedPoints {
    /// Every second field from this one; each point is followed by its components.
    Pairs(usize),
    /// A single point, and then pairs.
    Spline,
    /// No fields: the points are not on the card.
    Elsewhere,
}

use ListedPoints::{Elsewhere, Pairs, Spline};

/// A kind of card that this reader does not understand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnreadCard {
    name: &'static str,
    what: &'static str,
    listed: ListedPoints,
    /// Whether the card constrains: then the model is incomplete without it.
    pub constrains: bool,
}

const fn unread(name: &'static str, what: &'static str, listed: ListedPoints) -> UnreadCard {
    UnreadCard { name, what, listed, constrains: true }
}

/// An entry for a card that imposes no equations.
const fn harmless(name: &'static str, what: &'static str) -> UnreadCard {
    UnreadCard { name, what, listed: Elsewhere, constrains: false }
}

const UNREAD: [UnreadCard; 50] = [
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

/// The names of all these cards.
pub fn names() -> impl Iterator<Item = &'static str> {
    UNREAD.iter().map(|entry| entry.name)
}

/// The warning for a `JOINTG` of an unsupported type.
pub fn joint(card: &BulkCard) -> String {
    let kind = String::from_utf8_lossy(card.field(2)).into_owned();
    let points: Vec<String> = [3, 5].into_iter().filter_map(|i| whole(card.field(i))).map(|i| i.to_string()).collect();
    format!(
        "{} is a joint of type {kind} of grid points {}; it is not understood and left out",
        card.title(),
        few(&points)
    )
}

impl UnreadCard {
    /// The entry for a card name in capitals.
    pub fn of(name: &str) -> Option<&'static Self> {
        UNREAD.iter().find(|entry| entry.name == name)
    }

    /// The warning for a card: what the card is, and which grid points it names.
    pub fn warning(&self, card: &BulkCard) -> String {
        let points = self.points(card);
        let on = if points.is_empty() { String::new() } else { format!(" of grid points {}", few(&points)) };
        format!("{} {}{on}; it is not understood and left out", card.title(), self.what)
    }

    fn points(&self, card: &BulkCard) -> Vec<String> {
        let fields: Vec<usize> = match self.listed {
            Pairs(from) => (from..card.len()).step_by(2).collect(),
            Spline => std::iter::once(2).chain((3..card.len()).step_by(2)).collect(),
            Elsewhere => Vec::new(),
        };
        fields.into_iter().filter_map(|i| whole(card.field(i))).map(|node| node.to_string()).collect()
    }
}

/// The first few entries of a list, and the number of the others.
fn few(points: &[String]) -> String {
    const SHOWN: usize = 12;
    let rest = points.len().saturating_sub(SHOWN);
    let more = if rest > 0 { format!(" and {rest} more") } else { String::new() };
    format!("{}{more}", points[..points.len().min(SHOWN)].join(", "))
}

/// Prefixes of names that sound like constraints.
const CONSTRAINS: [&str; 7] = ["RB", "RSP", "RJ", "RX", "RG", "MPC", "SPC"];

/// Names with such a prefix whose cards constrain nothing.
const HARMLESS: [&str; 9] =
    ["RGYRO", "RSPINR", "RSPINT", "RSPINT2", "SPCOFF", "SPCOFF1", "RBJSTIF", "RXPORT", "RGLOAD"];

/// Prefixes of common cards: elements, properties, materials, loads, tables, optimization.
const FAMILIES: [&str; 54] = [
    "CAERO", "CBAR", "CBEAM", "CBEND", "CBUSH", "CDAMP", "CELAS", "CFLUID", "CGAP", "CHBDY", "CHEX", "CMASS", "CONM",
    "CONV", "CPENT", "CPYR", "CQUAD", "CROD", "CSHEAR", "CTETRA", "CTRI", "CTUBE", "CVISC", "CRAC", "CHAC", "CSSCH",
    "PLOAD", "PLOT", "PBAR", "PBEAM", "PBUSH", "PCOMP", "PSHELL", "PSOLID", "PELAS", "PDAMP", "PMASS", "PAERO", "MAT",
    "MONPNT", "MONDSP", "NLP", "TABLE", "TABD", "TABR", "TLOAD", "RLOAD", "TEMP", "D", "BC", "AE", "SET", "RAD",
    "SPLINE",
];

/// Names of other common cards.
const USUAL: [&str; 132] = [
    "ACCEL", "ACCEL1", "ACMODL", "ACSRCE", "ADAPT", "ADUMMY", "AXIC", "AXIF", "AXSLOT", "BAROR", "BEAMOR", "BLSEG",
    "BOLT", "BFRIC", "BGPARM", "BSURF", "BSURFS", "BCPROP", "CONROD", "CDUM", "CORD3G", "CORD3R", "CONCT", "CYSUP",
    "CREEP", "CWSEAM", "CONTRLT", "CELAS", "CIFHEX", "CIFPENT", "CIFQDX", "CIFQUAD", "CBELT", "CAABSF", "CNTRLT",
    "EIGB", "EIGC", "EIGP", "EIGR", "EIGRL", "ELIST", "ENDDYNA", "EXTRN", "FEEDGE", "FEFACE", "FLFACT", "FLSYM",
    "FLUTTER", "FORCE1", "FORCE2", "FREEPT", "FREQ", "FREQ1", "FREQ2", "FREQ3", "FREQ4", "FREQ5", "FSLIST", "GENEL",
    "GMCURV", "GMCORD", "GMLOAD", "GMSURF", "GRAV", "GUST", "INCLUDE", "ITER", "LOADCYN", "LOADCYT", "LSEQ", "MFLUID",
    "MKAERO1", "MKAERO2", "MOMENT1", "MOMENT2", "MOMAX", "MDLPRM", "NOLIN1", "NOLIN2", "NOLIN3", "NOLIN4", "NSM",
    "NSM1", "NSMADD", "NSML", "NSML1", "NTHICK", "OMIT", "OUTPUT", "OUTRCV", "PARAM", "PACABS", "PANEL", "PCONEAX",
    "PCONV", "PCONVM", "PFAST", "PGAP", "PHBDY", "PINTC", "PINTS", "PLPLANE", "PLSOLID", "PRAC2D", "PRAC3D", "PRESAX",
    "PRESPT", "PROD", "PSEAM", "PSHEAR", "PSET", "PTUBE", "PVAL", "PVISC", "PWELD", "QBDY1", "QBDY2", "QBDY3", "QHBDY",
    "QVECT", "QVOL", "RANDPS", "RANDT1", "RCROSS", "RFORCE", "RFORCE1", "RINGAX", "RINGFL", "SECTAX", "SLBDY", "SNORM",
    "SWLDPRM",
];

/// Names of further common cards, among them those of superelements, heat transfer and optimization.
const MORE: [&str; 66] = [
    "SEBULK", "SEDLINK", "SEDRSP2", "SEELT", "SEEXCLD", "SELABEL", "SELOAD", "SELOC", "SENQSET", "SETREE", "SPOINT",
    "SUPAX", "STOCHAS", "SURFINI", "SUBCOM", "SIMPLE", "STAT", "TF", "TIC", "TICD", "TICS", "TRIM", "TRIM2", "TSTEP",
    "TSTEP1", "TSTEPNL", "TMPSET", "TOPVAR", "UNBALNC", "USET", "USET1", "USETADD", "UXVEC", "VIEW", "VIEW3D",
    "VIEWEX", "VARIAN", "VCCT", "VADAPT", "WAKE", "WETELMG", "WETSURF", "XYPLOT", "NASTRAN", "ECHOON", "ECHOOFF",
    "ENDDATA", "BEGIN", "ID", "SOL", "CEND", "TITLE", "GROUP", "GRAVITY", "HYBDAMP", "INITIAL", "MARPN", "LABEL",
    "PLSURF", "FTGDEF", "FTGPARM", "FTGSEQ", "FTGEVNT", "FTGLOAD", "TOPT", "SWITCH",
];

/// The unknown names met so far.
#[derive(Debug, Default)]
pub struct UnknownNames {
    said: FxHashSet<Vec<u8>>,
    /// The last name met, for speed: cards of one kind are usually consecutive.
    last: Vec<u8>,
}

impl UnknownNames {
    /// Notes a card of this name (in capitals) if the user should know of it.
    pub fn meet(&mut self, name: &[u8], at: FileLine, notes: &mut CardNotes) {
        if self.last == name && !self.said.contains(name) {
            return;
        }
        self.last.clear();
        self.last.extend_from_slice(name);
        if !is_name(name) || is_usual(name) {
            return;
        }
        let text = String::from_utf8_lossy(name);
        if CONSTRAINS.iter().any(|start| name.starts_with(start.as_bytes())) {
            self.said.insert(name.to_vec());
            notes.leave_out(at, format!("{text}: the card is not known, and may constrain; it is left out"));
        } else if self.said.insert(name.to_vec()) {
            notes.warn(at, format!("{text}: the card is not known; it and all others of its name are passed over"));
        }
    }
}

/// Whether a word is a card name: letters and digits, starting with a letter.
fn is_name(name: &[u8]) -> bool {
    name.first().is_some_and(u8::is_ascii_uppercase) && name.iter().all(u8::is_ascii_alphanumeric)
}

fn is_usual(name: &[u8]) -> bool {
    static USUAL_NAMES: LazyLock<FxHashSet<&[u8]>> =
        LazyLock::new(|| USUAL.iter().chain(&MORE).chain(&HARMLESS).map(|name| name.as_bytes()).collect());
    USUAL_NAMES.contains(name) || FAMILIES.iter().any(|start| name.starts_with(start.as_bytes()))
}
