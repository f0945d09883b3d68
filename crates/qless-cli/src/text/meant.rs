//! What may be meant instead of what is typed.

use qless::Report;
use qless::diagnosis::NearDependent;

use super::combination;
use super::name::{self, count};
use crate::diagnose::Diagnosis;

/// Nothing where the rank is sure or has no second reading; else the two ranks, and the equation that agrees best.
pub fn lines(diagnosis: &Diagnosis, report: &Report) -> Vec<String> {
    let Some(meant) = &diagnosis.meant else { return Vec::new() };
    let digits = count(meant.digits() as usize, "digit");
    let mut lines = vec![
        format!("As typed the rank is {}; if equations that agree to {digits} are meant as the same,", report.rank),
        format!("it is {}: {} would then repeat others.", meant.rank, count(meant.equations.len(), "equation")),
    ];
    let best = |a: &&NearDependent, b: &&NearDependent| (a.digits, b.row).cmp(&(b.digits, a.row));
    if let Some(NearDependent { row, digits, because, .. }) = meant.equations.iter().max_by(best) {
        let agree = format!(" to {} of each coefficient", count(*digits as usize, "digit"));
        let mut combination = combination::lines(&diagnosis.system, *row, because);
        combination.truncate(1);
        let head = 2 + name::equation(&diagnosis.system, *row).len();
        let nearly = |line: String| line[..head].to_owned() + &line[head..].replacen(" = ", " ~ ", 1) + &agree;
        lines.extend(combination.into_iter().map(nearly));
    }
    lines
}
