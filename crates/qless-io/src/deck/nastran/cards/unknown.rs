//! Cards of which not even the name is read: those whose names sound as if they constrain are left out, the usual ones of elements,
//! materials, loads and so on are passed over, and the rest is named once each.

use std::sync::LazyLock;

use rustc_hash::FxHashSet;

use super::notes::Notes;
use crate::deck::nastran::syntax::content::At;

/// How the names of cards that constrain begin.
const CONSTRAINS: [&str; 7] = ["RB", "RSP", "RJ", "RX", "RG", "MPC", "SPC"];

/// Names that begin so, of cards that constrain nothing.
const HARMLESS: [&str; 9] =
    ["RGYRO", "RSPINR", "RSPINT", "RSPINT2", "SPCOFF", "SPCOFF1", "RBJSTIF", "RXPORT", "RGLOAD"];

/// How the names of usual cards begin, as of families of elements, properties, materials, loads, tables and optimization.
const FAMILIES: [&str; 54] = [
    "CAERO", "CBAR", "CBEAM", "CBEND", "CBUSH", "CDAMP", "CELAS", "CFLUID", "CGAP", "CHBDY", "CHEX", "CMASS", "CONM",
    "CONV", "CPENT", "CPYR", "CQUAD", "CROD", "CSHEAR", "CTETRA", "CTRI", "CTUBE", "CVISC", "CRAC", "CHAC", "CSSCH",
    "PLOAD", "PLOT", "PBAR", "PBEAM", "PBUSH", "PCOMP", "PSHELL", "PSOLID", "PELAS", "PDAMP", "PMASS", "PAERO", "MAT",
    "MONPNT", "MONDSP", "NLP", "TABLE", "TABD", "TABR", "TLOAD", "RLOAD", "TEMP", "D", "BC", "AE", "SET", "RAD",
    "SPLINE",
];

/// Other usual cards.
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

/// Other usual cards, from T on, and those that superelements, heat and optimization have.
const MORE: [&str; 66] = [
    "SEBULK", "SEDLINK", "SEDRSP2", "SEELT", "SEEXCLD", "SELABEL", "SELOAD", "SELOC", "SENQSET", "SETREE", "SPOINT",
    "SUPAX", "STOCHAS", "SURFINI", "SUBCOM", "SIMPLE", "STAT", "TF", "TIC", "TICD", "TICS", "TRIM", "TRIM2", "TSTEP",
    "TSTEP1", "TSTEPNL", "TMPSET", "TOPVAR", "UNBALNC", "USET", "USET1", "USETADD", "UXVEC", "VIEW", "VIEW3D",
    "VIEWEX", "VARIAN", "VCCT", "VADAPT", "WAKE", "WETELMG", "WETSURF", "XYPLOT", "NASTRAN", "ECHOON", "ECHOOFF",
    "ENDDATA", "BEGIN", "ID", "SOL", "CEND", "TITLE", "GROUP", "GRAVITY", "HYBDAMP", "INITIAL", "MARPN", "LABEL",
    "PLSURF", "FTGDEF", "FTGPARM", "FTGSEQ", "FTGEVNT", "FTGLOAD", "TOPT", "SWITCH",
];

/// The names met that are not known.
#[derive(Debug, Default)]
pub struct Unknown {
    said: FxHashSet<Vec<u8>>,
    /// The last name met: cards of a kind mostly stand together.
    last: Vec<u8>,
}

impl Unknown {
    /// Notes a card of this name in capitals, if something is to be said of it.
    pub fn meet(&mut self, name: &[u8], at: At, notes: &mut Notes) {
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

/// Letters and digits, a letter first.
fn is_name(name: &[u8]) -> bool {
    name.first().is_some_and(u8::is_ascii_uppercase) && name.iter().all(u8::is_ascii_alphanumeric)
}

fn is_usual(name: &[u8]) -> bool {
    static USUAL_NAMES: LazyLock<FxHashSet<&[u8]>> =
        LazyLock::new(|| USUAL.iter().chain(&MORE).chain(&HARMLESS).map(|name| name.as_bytes()).collect());
    USUAL_NAMES.contains(name) || FAMILIES.iter().any(|start| name.starts_with(start.as_bytes()))
}
