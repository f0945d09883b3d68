//! Lists cards that constrain but are not read.

/// Why a card with this keyword is left out although it constrains, as a clause. `None` if it is no constraint.
pub fn reason(keyword: &str) -> Option<&'static str> {
    let starts = |start: &str| keyword.strip_prefix(start).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'));
    STARTS.iter().find(|(start, _)| starts(start)).map(|(_, why)| *why).filter(|why| !why.is_empty())
}

const UNKNOWN: &str = "constrains, but is not understood";
const MOVES: &str = "moves nodes, and is not understood";
const CHANGES: &str = "changes the mesh or what is rigid, and is not understood";

/// How keywords start, and why their cards are left out; the first match counts. An empty reason means that the card is no constraint.
/// `/ALE/BCS` holds the grid of a fluid, whose motion is another unknown than that of the material.
const STARTS: [(&str, &str); 30] = [
    ("BCS/WALL", ""),
    ("BCS/NRF", ""),
    ("BCS", UNKNOWN),
    ("SPHBCS", UNKNOWN),
    ("IMPDISP", UNKNOWN),
    ("IMPVEL", UNKNOWN),
    ("IMPACC", UNKNOWN),
    ("RBODY", UNKNOWN),
    ("RLINK", UNKNOWN),
    ("GJOINT", UNKNOWN),
    ("CYL_JOINT", UNKNOWN),
    ("RIVET", UNKNOWN),
    ("FXBODY", UNKNOWN),
    ("INTER/TYPE1", UNKNOWN),
    ("INTER/TYPE2", UNKNOWN),
    ("INTER/TYPE9", UNKNOWN),
    ("INTER/TYPE12", UNKNOWN),
    ("INTER/TYPE16", UNKNOWN),
    ("INTER/TYPE17", UNKNOWN),
    ("INTER/LAGMUL", UNKNOWN),
    ("RWALL/LAGMUL", UNKNOWN),
    ("MAT/RIGID", CHANGES),
    ("MAT/LAW13", CHANGES),
    ("MERGE/RBODY", CHANGES),
    ("MERGE/NODE", CHANGES),
    ("CNODE", CHANGES),
    ("ADMESH", CHANGES),
    ("INCLUDE_LS-DYNA", CHANGES),
    ("TRANSFORM", MOVES),
    ("PERTURB/NODE", MOVES),
];
