//! Lists cards that constrain but are not read.

/// Why a card with this keyword is left out although it constrains, as a clause. `None` if it is no constraint.
pub fn reason(keyword: &str) -> Option<&'static str> {
    let has = |word: &str| keyword.contains(word);
    if keyword.starts_with("CONTACT_") && ["TIED", "TIEBREAK", "SPOTWELD"].into_iter().any(has) {
        let is_penalty = has("TIEBREAK") || has("OFFSET") && !has("CONSTRAINED_OFFSET");
        return Some(if is_penalty { "ties by springs, which are no equations" } else { UNKNOWN });
    }
    STARTS.iter().find(|(start, _)| keyword.starts_with(start)).map(|(_, why)| *why).filter(|why| !why.is_empty())
}

const UNKNOWN: &str = "constrains, but is not understood";
const MOVES: &str = "moves nodes, and is not understood";
const CHANGES: &str = "changes which parts are rigid, and is not understood";
const ELSEWHERE: &str = "includes a file in a way that is not understood";

/// How keywords start, and why their cards are left out; the first match counts. An empty reason means that the card is no constraint.
const STARTS: [(&str, &str); 13] = [
    ("CONSTRAINED_JOINT_STIFFNESS", ""),
    ("CONSTRAINED_RIGID_BODY_STOPPERS", ""),
    ("CONSTRAINED_", UNKNOWN),
    ("BOUNDARY_SPC", UNKNOWN),
    ("BOUNDARY_PRESCRIBED_", UNKNOWN),
    ("BOUNDARY_CYCLIC", UNKNOWN),
    ("BOUNDARY_SLIDING_PLANE", UNKNOWN),
    ("DEFORMABLE_TO_RIGID", CHANGES),
    ("RIGID_DEFORMABLE", CHANGES),
    ("PART_MODES", UNKNOWN),
    ("MAT_RIGID_DISCRETE", UNKNOWN),
    ("NODE_", MOVES),
    ("INCLUDE_", ELSEWHERE),
];
