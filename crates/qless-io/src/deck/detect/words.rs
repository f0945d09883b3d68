//! Words that cards begin with. Each list is only as long as it takes to know a deck by its first cards.

/// Whether a word is in a list of upper-case words.
pub fn is_in(list: &[&str], word: &[u8]) -> bool {
    list.iter().any(|known| word.eq_ignore_ascii_case(known.as_bytes()))
}

/// First words of keywords of Abaqus and CalculiX, after the star.
pub const CALCULIX: [&str; 112] = [
    "ADJUST", "AMPLITUDE", "ASSEMBLY", "BASE", "BEAM", "BOUNDARY", "BUCKLE", "CAPACITY", "CECHARGE", "CECURRENT",
    "CFD", "CFILM", "CFLUX", "CHANGE", "CLEARANCE", "CLOAD", "COHESIVE", "COMPLEX", "CONDUCTIVITY", "CONNECTOR",
    "CONSTRAINT", "CONTACT", "CONTROLS", "CONVERSION", "COUPLED", "COUPLING", "CRADIATE", "CREEP", "CYCLIC", "DAMPING",
    "DASHPOT", "DENSITY", "DEPVAR", "DESIGN", "DFLUX", "DISTRIBUTING", "DISTRIBUTION", "DLOAD", "DSLOAD", "DYNAMIC",
    "EL", "ELASTIC", "ELECTRICAL", "ELECTROMAGNETICS", "ELEMENT", "ELGEN", "ELSET", "EMBEDDED", "END", "EQUATION",
    "EXPANSION", "FASTENER", "FILM", "FLUID", "FREQUENCY", "FRICTION", "GAP", "GASKET", "GREEN", "HCF", "HEADING",
    "HEAT", "HYPERELASTIC", "HYPERFOAM", "IMPERFECTION", "IMPORT", "INCLUDE", "INERTIA", "INITIAL", "INSTANCE",
    "INTEGRATED", "KINEMATIC", "MAGNETIC", "MASS", "MATERIAL", "MEMBRANE", "MODAL", "MODEL", "MPC", "NCOPY", "NFILL",
    "NGEN", "NMAP", "NODAL", "NODE", "NORMAL", "NSET", "ORIENTATION", "OUTPUT", "PARAMETER", "PART", "PHYSICAL",
    "PLASTIC", "PRE", "PREPRINT", "RADIATE", "RELEASE", "RESTART", "RIGID", "ROTARY", "SECTION", "SHELL", "SOLID",
    "SPRING", "STATIC", "STEP", "SUBMODEL", "SURFACE", "SYSTEM", "TEMPERATURE", "TIE", "TRANSFORM",
];

/// Commands of APDL, after the star.
pub const APDL_STARRED: [&str; 40] = [
    "ABBR", "AFUN", "ASK", "CFCLOS", "CFOPEN", "CFWRITE", "CREATE", "CYCLE", "DEL", "DIM", "DO", "DOWHILE", "ELSE",
    "ELSEIF", "END", "ENDDO", "ENDIF", "EXIT", "GET", "GO", "IF", "MFUN", "MOPER", "MSG", "MWRITE", "REPEAT", "RETURN",
    "SET", "SREAD", "STATUS", "TAXIS", "TOPER", "TREAD", "USE", "VFILL", "VGET", "VOPER", "VPUT", "VREAD", "VWRITE",
];

/// Commands of APDL that begin fields.
pub const APDL: [&str; 64] = [
    "ACEL", "ALLSEL", "ANTYPE", "BF", "BFUNIF", "CE", "CEINTF", "CERIG", "CLOCAL", "CMBLOCK", "CMSEL", "CP", "CPINTF",
    "CPNGEN", "CSYS", "D", "DDELE", "DOFSEL", "DSYM", "E", "EBLOCK", "EGEN", "EMODIF", "EN", "ENBLOCK", "ESEL", "ESYS",
    "ET", "ETBLOCK", "EXTOPT", "F", "FDELE", "FILL", "IC", "KEYOPT", "LOCAL", "MAT", "MP", "MPDATA", "MPTEMP", "N",
    "NBLOCK", "NGEN", "NMODIF", "NROTAT", "NSEL", "NUMOFF", "NUMSTR", "R", "RBE3", "REAL", "RLBLOCK", "RMORE",
    "SECBLOCK", "SECDATA", "SECNUM", "SECTYPE", "SF", "SFE", "SHPP", "TB", "TREF", "TUNIF", "TYPE",
];

/// Commands of APDL that stand alone.
pub const APDL_ALONE: [&str; 4] = ["FINI", "FINISH", "SOLVE", "SAVE"];

/// Lines of Nastran that stand alone.
pub const NASTRAN_ALONE: [&str; 4] = ["CEND", "BEGIN BULK", "ENDDATA", "BEGIN"];

/// Words of Nastran's case control, and its `NASTRAN` statement, that are set to something.
pub const NASTRAN_CONTROL: [&str; 28] = [
    "ACCELERATION", "ANALYSIS", "ASSIGN", "DISP", "DISPLACEMENT", "DLOAD", "ECHO", "ESE", "FORCE", "FREQ", "GPFORCE",
    "INIT", "LABEL", "LOAD", "METHOD", "MPC", "MPCFORCES", "NASTRAN", "OLOAD", "SET", "SPC", "SPCFORCE", "SPCFORCES",
    "STRESS", "SUBCASE", "SUBTITLE", "TEMPERATURE", "TITLE",
];

/// Bulk data cards.
pub const NASTRAN_BULK: [&str; 132] = [
    "ASET", "ASET1", "BAROR", "BEAMOR", "BSET", "BSET1", "CBAR", "CBEAM", "CBEND", "CBUSH", "CBUSH1D", "CDAMP1",
    "CDAMP2", "CELAS1", "CELAS2", "CELAS3", "CELAS4", "CFAST", "CGAP", "CHEXA", "CMASS1", "CMASS2", "CONM1", "CONM2",
    "CONROD", "CORD1C", "CORD1R", "CORD1S", "CORD2C", "CORD2R", "CORD2S", "CORD3G", "CPENTA", "CPYRA", "CPYRAM",
    "CQUAD4", "CQUAD8", "CQUADR", "CROD", "CSET", "CSET1", "CSHEAR", "CTETRA", "CTRIA3", "CTRIA6", "CTRIAR", "CTUBE",
    "CVISC", "CWELD", "DAREA", "DLOAD", "DMIG", "EIGC", "EIGR", "EIGRL", "FORCE", "FORCE1", "FREQ", "FREQ1", "GRAV",
    "GRDSET", "GRID", "JOINTG", "LOAD", "LSEQ", "MAT1", "MAT10", "MAT2", "MAT3", "MAT4", "MAT8", "MAT9", "MATS1",
    "MOMENT", "MOMENT1", "MPC", "MPCADD", "NLPARM", "OMIT", "OMIT1", "PARAM", "PBAR", "PBARL", "PBEAM", "PBEAML",
    "PBUSH", "PCOMP", "PCOMPG", "PDAMP", "PELAS", "PGAP", "PLOAD", "PLOAD2", "PLOAD4", "PLOTEL", "PMASS", "PROD",
    "PSHEAR", "PSHELL", "PSOLID", "PTUBE", "QSET1", "RBAR", "RBAR1", "RBE1", "RBE2", "RBE3", "RFORCE", "RJOINT", "RLOAD1",
    "RLOAD2", "RROD", "RSPLINE", "RSSCON", "RTRPLT", "SESET", "SLOAD", "SPC", "SPC1", "SPCADD", "SPCD", "SPCOFF",
    "SPOINT", "SUPORT", "SUPORT1", "TABLED1", "TEMP", "TEMPD", "TIC", "TLOAD1", "TSTEP", "USET",
];
