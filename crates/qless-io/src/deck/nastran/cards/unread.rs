//! Lists the cards that this reader does not understand, and makes notes about them for the user.
//!
//! [`UnreadCard`] lists known cards that are not supported, most of which constrain. All other names go through [`UnknownNames`]. A name
//! that sounds like a constraint makes the model incomplete. Common cards (elements, materials, loads, ...) are skipped. Any other name is
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

/// Notes for the user about lines of the deck, in the order of the cards.
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

    /// Adds all notes to the warnings and refusals of the model.
    pub fn add_to(self, model: &mut Model) {
        for ((file, line), kind, text) in self.0 {
            match kind {
                NoteKind::Warning => model.warn(file, line, text),
                NoteKind::LeftOut => model.leave_out(file, line, text),
                NoteKind::Refusal => model.refuse(file, line, text),
            }
        }
    }
}

/// A kind of card that this reader does not understand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnreadCard {
    name: &'static str,
    description: &'static str,
}

/// The description of contact cards that impose no equations.
const HARMLESS_CONTACT: &str = "is contact";
const REFERENCE: &str = "names reference components";

/// Descriptions of the cards that this reader does not understand, each with the names of such cards.
const UNREAD: [(&str, &str); 26] = [
    ("is an interpolation element", "RSPLINE RBE3U"),
    ("is a rigid element that searches its grid points", "RBE2GS"),
    ("is a rigid element", "RBE2A RBE2F"),
    ("joins shells to solids", "RSSCON"),
    ("is a multipoint constraint", "MPCAX MPCY"),
    ("gives a multipoint constraint its right-hand side", "MPCD"),
    ("is a single-point constraint", "SPCAX SPC2"),
    ("is a single-point constraint relative to an earlier step", "SPCR"),
    ("is a constraint on geometry", "GMSPC GMBC"),
    ("joins its parts by equations", "CWELD CFAST CSEAM CINTC GMINTC GMINTS"),
    ("glues surfaces together", "BGSET BGADD"),
    ("is contact, which can glue", "BCTABLE BCTABL1"),
    (HARMLESS_CONTACT, "BCTSET BCTADD"),
    ("ties surfaces", "TIE"),
    ("gives a joint a motion", "JOINTM MOTNJG"),
    ("is a section with pretension", "PRETENS"),
    ("joins the sides of a cyclic segment", "CYJOIN"),
    ("is cyclic symmetry", "CYSYM CYAX"),
    (REFERENCE, "SUPORT SUPORT1"),
    ("fixes reference components", "SUPAX"),
    ("makes a superelement", "SESET"),
    ("joins a superelement", "CSUPER CSUPEXT"),
    ("is a set of a superelement", "SEBSET SEBSET1 SECSET SECSET1 SEQSET SEQSET1"),
    ("fixes reference components of a superelement", "SESUP"),
    ("joins superelements", "SEBNDRY SECONCT SEMPLN"),
    ("releases components between superelements", "RELEASE"),
];

fn unread_cards() -> impl Iterator<Item = UnreadCard> {
    let cards = |&(description, names): &(&'static str, &'static str)| {
        names.split(' ').map(move |name| UnreadCard { name, description })
    };
    UNREAD.iter().flat_map(cards)
}

/// The names of all cards of `UNREAD`.
pub fn names() -> impl Iterator<Item = &'static str> {
    unread_cards().map(|card| card.name)
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
    /// The entry of `UNREAD` for a card name in capitals; `None` if there is none.
    pub fn find(name: &str) -> Option<Self> {
        unread_cards().find(|card| card.name == name)
    }

    /// Whether the card constrains. If it does, the model is incomplete without it.
    pub fn constrains(self) -> bool {
        ![HARMLESS_CONTACT, REFERENCE].contains(&self.description)
    }

    /// The warning for a card: what the card is, and which grid points it names.
    pub fn warning(self, card: &BulkCard) -> String {
        let points = self.points(card);
        let on = if points.is_empty() { String::new() } else { format!(" of grid points {}", few(&points)) };
        let end = match self.description {
            REFERENCE => "it gives no equation, but a static solution without inertia relief holds them",
            _ => "it is not understood and left out",
        };
        format!("{} {}{on}; {end}", card.title(), self.description)
    }

    /// The grid points that the card lists.
    fn points(self, card: &BulkCard) -> Vec<String> {
        // Most fields are pairs of point and components. In `RSPLINE`, a single point precedes the pairs.
        let fields: Vec<usize> = match self.name {
            "SUPORT" => (0..card.len()).step_by(2).collect(),
            "SUPORT1" => (1..card.len()).step_by(2).collect(),
            "RSPLINE" => std::iter::once(2).chain((3..card.len()).step_by(2)).collect(),
            _ => Vec::new(),
        };
        fields.into_iter().filter_map(|i| whole(card.field(i))).map(|node| node.to_string()).collect()
    }
}

/// The first entries of a list, and the number of those that are not shown.
fn few(points: &[String]) -> String {
    const SHOWN: usize = 12;
    let rest = points.len().saturating_sub(SHOWN);
    let more = if rest > 0 { format!(" and {rest} more") } else { String::new() };
    format!("{}{more}", points[..points.len().min(SHOWN)].join(", "))
}

/// Names that begin with one of these sound like constraints.
const CONSTRAINS: [&str; 7] = ["RB", "RSP", "RJ", "RX", "RG", "MPC", "SPC"];

/// Names that begin with one of the prefixes in `CONSTRAINS`, although their cards constrain nothing.
const HARMLESS: [&str; 9] =
    ["RGYRO", "RSPINR", "RSPINT", "RSPINT2", "SPCOFF", "SPCOFF1", "RBJSTIF", "RXPORT", "RGLOAD"];

/// Names that begin with one of these belong to common cards: elements, properties, materials, loads, tables, optimization.
const FAMILIES: [&str; 54] = [
    "CAERO", "CBAR", "CBEAM", "CBEND", "CBUSH", "CDAMP", "CELAS", "CFLUID", "CGAP", "CHBDY", "CHEX", "CMASS", "CONM",
    "CONV", "CPENT", "CPYR", "CQUAD", "CROD", "CSHEAR", "CTETRA", "CTRI", "CTUBE", "CVISC", "CRAC", "CHAC", "CSSCH",
    "PLOAD", "PLOT", "PBAR", "PBEAM", "PBUSH", "PCOMP", "PSHELL", "PSOLID", "PELAS", "PDAMP", "PMASS", "PAERO", "MAT",
    "MONPNT", "MONDSP", "NLP", "TABLE", "TABD", "TABR", "TLOAD", "RLOAD", "TEMP", "D", "BC", "AE", "SET", "RAD",
    "SPLINE",
];

/// Names of other common cards.
const USUAL: &str = "\
    ACCEL ACCEL1 ACMODL ACSRCE ADAPT ADUMMY AXIC AXIF AXSLOT BAROR BEAMOR BLSEG BOLT BFRIC BGPARM BSURF BSURFS BCPROP \
    CONROD CDUM CORD3G CORD3R CONCT CYSUP CREEP CWSEAM CONTRLT CELAS CIFHEX CIFPENT CIFQDX CIFQUAD CBELT CAABSF CNTRLT \
    EIGB EIGC EIGP EIGR EIGRL ELIST ENDDYNA EXTRN FEEDGE FEFACE FLFACT FLSYM FLUTTER FORCE1 FORCE2 FREEPT FREQ FREQ1 FREQ2 \
    FREQ3 FREQ4 FREQ5 FSLIST GENEL GMCURV GMCORD GMLOAD GMSURF GRAV GUST INCLUDE ITER LOADCYN LOADCYT LSEQ MFLUID MKAERO1 \
    MKAERO2 MOMENT1 MOMENT2 MOMAX MDLPRM NOLIN1 NOLIN2 NOLIN3 NOLIN4 NSM NSM1 NSMADD NSML NSML1 NTHICK OMIT OUTPUT OUTRCV \
    PACABS PANEL PCONEAX PCONV PCONVM PFAST PGAP PHBDY PINTC PINTS PLPLANE PLSOLID PRAC2D PRAC3D PRESAX PRESPT PROD \
    PSEAM PSHEAR PSET PTUBE PVAL PVISC PWELD QBDY1 QBDY2 QBDY3 QHBDY QVECT QVOL RANDPS RANDT1 RCROSS RFORCE RFORCE1 RINGAX \
    RINGFL SECTAX SLBDY SNORM SWLDPRM SEBULK SEDLINK SEDRSP2 SEELT SEEXCLD SELABEL SELOAD SELOC SENQSET SETREE SPOINT \
    SUPAX STOCHAS SURFINI SUBCOM SIMPLE STAT TF TIC TICD TICS TRIM TRIM2 TSTEP TSTEP1 TSTEPNL TMPSET TOPVAR UNBALNC USET \
    USET1 USETADD UXVEC VIEW VIEW3D VIEWEX VARIAN VCCT VADAPT WAKE WETELMG WETSURF XYPLOT NASTRAN ECHOON ECHOOFF ENDDATA \
    BEGIN ID SOL CEND TITLE GROUP GRAVITY HYBDAMP INITIAL MARPN LABEL PLSURF FTGDEF FTGPARM FTGSEQ FTGEVNT FTGLOAD TOPT \
    SWITCH";

/// The unknown card names that occurred so far.
#[derive(Debug, Default)]
pub struct UnknownNames {
    reported: FxHashSet<Vec<u8>>,
    /// The last unknown name that occurred. Cards of one kind are usually consecutive, so comparing with it saves time.
    last: Vec<u8>,
}

impl UnknownNames {
    /// Notes that a card with this name (in capitals) occurred, if the user should know of it.
    pub fn meet(&mut self, name: &[u8], at: FileLine, notes: &mut CardNotes) {
        if self.last == name && !self.reported.contains(name) {
            return;
        }
        self.last.clear();
        self.last.extend_from_slice(name);
        if !is_name(name) || is_usual(name) {
            return;
        }
        let text = String::from_utf8_lossy(name);
        if CONSTRAINS.iter().any(|start| name.starts_with(start.as_bytes())) {
            self.reported.insert(name.to_vec());
            notes.leave_out(at, format!("{text}: the card is not known, and may constrain; it is left out"));
        } else if self.reported.insert(name.to_vec()) {
            notes.warn(at, format!("{text}: the card is not known; all cards of this name are ignored"));
        }
    }
}

/// Whether a word can be the name of a card: letters and digits, starting with a letter.
fn is_name(name: &[u8]) -> bool {
    name.first().is_some_and(u8::is_ascii_uppercase) && name.iter().all(u8::is_ascii_alphanumeric)
}

fn is_usual(name: &[u8]) -> bool {
    static USUAL_NAMES: LazyLock<FxHashSet<&[u8]>> =
        LazyLock::new(|| USUAL.split(' ').chain(HARMLESS).map(str::as_bytes).collect());
    USUAL_NAMES.contains(name) || FAMILIES.iter().any(|start| name.starts_with(start.as_bytes()))
}
