//! Reads the commands that generate coupled sets: `CPNGEN` adds a range of nodes to a set, `CPLGEN` copies a set for other labels, and
//! `CPSGEN` copies sets for other nodes.
//!
//! ```text
//! CPNGEN, NSET, Lab, NODE1, NODE2, NINC
//! CPLGEN, NSETF, Lab1, ... Lab5
//! CPSGEN, ITIME, INC, NSET1, NSET2, NINC
//! ```
//!
//! The numbers of new sets follow the highest number so far.

use super::coupled::{CoupledSet, CoupledSets};
use super::numbering::numbered;
use crate::deck::Problem;
use crate::deck::ansys::syntax::command::AnsysCommand;
use crate::deck::ansys::syntax::field::{FieldFault, component, expected, range, signed_node, whole};
use crate::number;

/// Limit on the nodes of the sets that a command generates. It bounds the memory.
const NODES: usize = 5_000_000;

impl CoupledSets {
    /// Executes `CPNGEN`. Returns the number of the set, or `None` if the command is left out.
    pub fn add_range(&mut self, command: &AnsysCommand) -> Result<Option<u32>, FieldFault> {
        let number = numbered(command, 1, self.highest())?;
        if self.is_left_out(number) || command.field(3).first().is_some_and(u8::is_ascii_alphabetic) {
            self.leave_out(command);
            self.doubt = Some(format!(
                "CPNGEN adds nodes that this reader does not know to CP {number}: the whole set is left out"
            ));
            return Ok(None);
        }
        let (node, is_removed) = signed_node(command, 3)?;
        let (first, last, step) = range(command, node, 4)?;
        check_count(((last - first) / step) as usize + 1)?;
        let set = self.open(command, number, 2)?;
        for node in (first..=last).step_by(step as usize) {
            if is_removed {
                set.exclude(node);
            } else {
                set.include(node);
            }
        }
        if is_removed {
            set.drop_excluded();
        }
        Ok(Some(number))
    }

    /// Executes `CPLGEN` or `CPSGEN`.
    pub fn copy(&mut self, command: &AnsysCommand) -> Result<(), FieldFault> {
        let copies = if command.key == *b"CPLG" { self.for_labels(command)? } else { self.for_nodes(command)? };
        let Some(copies) = copies else {
            self.doubt = Some(format!(
                "{} copies coupled sets in a way that this reader does not follow: left out",
                command.title()
            ));
            return Ok(());
        };
        let advice = "number the coupled sets from 1";
        let limit = Problem::Limit { what: "the number of coupled sets", limit: u32::MAX as usize, advice };
        for set in copies {
            let number = self.highest().checked_add(1).ok_or((None, limit.clone()))?;
            self.sets.insert(number, set);
        }
        Ok(())
    }

    /// The copies of one set for up to five labels; `None` if the set is not known.
    fn for_labels(&mut self, command: &AnsysCommand) -> Result<Option<Vec<CoupledSet>>, FieldFault> {
        let number = whole(command.field(1)).ok_or_else(|| expected(command, 1, "the number of a coupled set"))?;
        let (now, line) = (self.now, command.line);
        let Some(set) = self.sets.get_mut(number) else { return Ok(None) };
        let labels = (2..=6).filter(|&at| !command.field(at).is_empty());
        let copy =
            |at: usize| Ok(set.copied(0, line, now).expect("the same nodes").with_component(component(command, at)?));
        labels.map(copy).collect::<Result<_, _>>().map(Some)
    }

    /// The copies of some sets, the numbers of whose nodes are higher by `INC` each time; `None` if the sets or `INC` are not known.
    fn for_nodes(&mut self, command: &AnsysCommand) -> Result<Option<Vec<CoupledSet>>, FieldFault> {
        let (Some(times), Some(increment), Some(first)) =
            (whole(command.field(1)), signed(command.field(2)), whole(command.field(3)))
        else {
            return Ok(None);
        };
        let (first, last, step) = range(command, first, 4)?;
        let mut sources: Vec<u32> = self.sets.within(first..=last);
        sources.retain(|number| (number - first).is_multiple_of(step));
        sources.sort_unstable();
        if sources.is_empty() || self.leaves_out_any(first..=last) {
            return Ok(None);
        }
        let mut copies = Vec::new();
        let mut count = 0;
        for k in 1_u32..times {
            for &number in &sources {
                let Some(set) = self.sets.get_mut(number) else { continue };
                count += set.size().max(1);
                check_count(count)?;
                let Some(copy) = set.copied(increment.saturating_mul(i64::from(k)), command.line, self.now) else {
                    return Err(expected(command, 2, "an increment that gives node numbers from 1"));
                };
                copies.push(copy);
            }
        }
        if sources.len() > 1 && times > 2 {
            self.assume_order(copies.len() as u32);
        }
        Ok(Some(copies))
    }
}

fn signed(text: &[u8]) -> Option<i64> {
    let digits = text.strip_prefix(b"-").unwrap_or(text);
    let size = i64::try_from(number::whole(digits)?).ok()?;
    Some(if digits.len() < text.len() { -size } else { size })
}

fn check_count(count: usize) -> Result<(), FieldFault> {
    let advice = "generate fewer nodes at a time";
    let limit = Problem::Limit { what: "the number of nodes", limit: NODES, advice };
    if count <= NODES { Ok(()) } else { Err((None, limit)) }
}
