//! Free DOFs that the equations fix: `u3 = 0.5`.

use qless::Report;

use super::COLUMNS;
use super::fit::flow;
use super::name;
use super::number::number;

/// A heading and one line, or nothing.
pub fn section(report: &Report) -> Vec<String> {
    let all = &report.generated_boundary_conditions;
    if all.is_empty() {
        return Vec::new();
    }
    let comma = |k: usize| if k + 1 < all.len() { "," } else { "" };
    let shown = all.iter().take(COLUMNS).enumerate();
    let pieces: Vec<String> = shown
        .map(|(k, fixed)| format!(" {} = {}{}", name::label(&fixed.label), number(fixed.value), comma(k)))
        .collect();
    let tail = format!(" ... ({} in all)", all.len());
    let flowed = flow(" ", "", &pieces, (1, COLUMNS), tail.len());
    let tail = if flowed.used < all.len() { tail } else { String::new() };
    let what = if all.len() == 1 { "a free DOF" } else { "free DOFs" };
    let mut lines = vec![format!("Generated boundary conditions: the equations leave {what} one value only.")];
    lines.extend(flowed.finish(&tail));
    lines
}
