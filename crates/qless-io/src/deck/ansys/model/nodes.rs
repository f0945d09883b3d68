//! Stores nodes and named groups of nodes, from the commands `NBLOCK`, `N` and `CMBLOCK`.

use std::sync::Arc;

use rustc_hash::{FxHashMap, FxHashSet};

use super::positions::NodePositions;
use crate::deck::Problem;
use crate::deck::ansys::syntax::command::AnsysCommand;
use crate::deck::ansys::syntax::field::{FieldFault, expected, real, whole};
use crate::deck::ansys::syntax::format::BlockFormat;
use crate::deck::kinematics::body::{Pose, Poses};
use crate::fault::quote;
use crate::number;

/// The nodes of a deck and their groups.
#[derive(Debug, Default)]
pub struct AnsysNodes {
    /// Node numbers in the order of the deck; a number may be repeated.
    pub numbers: Vec<u32>,
    /// Nodes whose axes differ from the global axes.
    pub rotated: Vec<u32>,
    /// Named groups as ranges of nodes; names are in capitals.
    pub groups: FxHashMap<String, NodeGroup>,
    /// Named groups whose members are not known.
    pub unknown_groups: FxHashSet<String>,
    /// Names of groups of other entities, for example elements.
    pub other_groups: FxHashSet<String>,
    /// Whether commands may generate nodes that this reader does not know.
    pub are_generated: bool,
    /// Whether files that are not read may define nodes, groups and parameters.
    pub are_in_files: bool,
    pub positions: NodePositions,
    block: DataBlock,
}

/// The members of a group as ranges, shared with the commands that name the group: it may change afterwards.
pub type NodeGroup = Arc<Vec<(u32, u32)>>;

/// The block that data lines belong to.
#[derive(Debug, Default)]
enum DataBlock {
    /// A block that this reader does not read, or no block.
    #[default]
    Other,
    /// `NBLOCK`, a block of nodes. The format is `None` until its line is read.
    Nodes(Option<BlockFormat>),
    /// `CMBLOCK` of nodes: the name of the group, the number of members still to read, and the format of the lines.
    Group(String, u32, Option<BlockFormat>),
}

impl AnsysNodes {
    /// Begins the block of `NBLOCK, NUMFIELD, Solkey, NDMAX, NDSEL`, which defines nodes.
    pub fn block(&mut self) {
        self.block = DataBlock::Nodes(None);
    }

    /// Begins the block of `CMBLOCK, Cname, Entity, NUMITEMS`, which names a group.
    pub fn group(&mut self, command: &AnsysCommand) -> Result<(), FieldFault> {
        let name = group_name(command.field(1));
        if !command.field(2).to_ascii_uppercase().starts_with(b"NODE") {
            self.end();
            self.other_groups.insert(name);
            return Ok(());
        }
        let items = number::whole(command.field(3)).and_then(|items| u32::try_from(items).ok());
        let items = items.ok_or_else(|| expected(command, 3, "the number of items"))?;
        self.unknown_groups.remove(&name);
        self.other_groups.remove(&name);
        self.groups.insert(name.clone(), NodeGroup::default());
        self.block = DataBlock::Group(name, items, None);
        Ok(())
    }

    /// Ends the block. A block has no end mark of its own: the next command ends it.
    pub fn end(&mut self) {
        self.block = DataBlock::Other;
    }

    /// Reads a data line. The first line of a block is the format of its other lines.
    pub fn data(&mut self, line: &[u8]) -> Result<(), FieldFault> {
        match std::mem::take(&mut self.block) {
            DataBlock::Other => {}
            DataBlock::Nodes(None) => self.block = DataBlock::Nodes(Some(format(line)?)),
            DataBlock::Nodes(Some(format)) => {
                if self.row(&format, line)? {
                    self.block = DataBlock::Nodes(Some(format));
                }
            }
            DataBlock::Group(name, count, None) => self.block = DataBlock::Group(name, count, Some(format(line)?)),
            DataBlock::Group(name, count, Some(format)) => {
                let count = self.members(&name, count, &format, line)?;
                self.block = DataBlock::Group(name, count, Some(format));
            }
        }
        Ok(())
    }

    /// Defines a node: `N, NODE, X, Y, Z, THXY, THYZ, THZX`, or in an archive `N, R5.3, LOC, NODE, SOLID, PARM, X, Y, Z`.
    pub fn command(&mut self, command: &AnsysCommand) -> Result<(), FieldFault> {
        let archive = command.archive_tag().is_some();
        let text = command.field(if archive { 3 } else { 1 });
        if archive && text.starts_with(b"-") {
            return Ok(());
        }
        if text.is_empty() {
            // If the command gives no number, ANSYS takes the number after its highest one. This reader may not know that number.
            self.are_generated = true;
            return Ok(());
        }
        let node = whole(text).ok_or_else(|| expected(command, if archive { 3 } else { 1 }, "the number of a node"))?;
        self.numbers.push(node);
        if !archive || command.is(2, "LOC") {
            self.positions.command(node, command, if archive { 6 } else { 2 }, archive);
        }
        if !archive || command.is(2, "ANG") {
            let first = if archive { 6 } else { 5 };
            let angles = [0, 1, 2].map(|k| real(command, first + k).unwrap_or(0.0));
            if angles != [0.0; 3] {
                self.rotated.push(node);
            }
            self.positions.set_axes(node, angles);
        }
        Ok(())
    }

    /// Reads a row of `NBLOCK`, which defines one node. Returns false at the -1 that ends the block.
    fn row(&mut self, format: &BlockFormat, line: &[u8]) -> Result<bool, FieldFault> {
        let first = format.integers(line).next().unwrap_or_default();
        if first.starts_with(b"-") {
            return Ok(false);
        }
        let fault = || (Some(1), Problem::Expected { expected: "the number of a node", found: quote(first) });
        let node = whole(first).ok_or_else(fault)?;
        self.numbers.push(node);
        self.positions.row(node, format.floats(line));
        let texts = format.floats(line).enumerate().skip(3).filter(|(_, text)| !text.is_empty());
        let offset = format.integers(line).count() + 1;
        let mut angles = [0.0; 3];
        for (k, text) in texts {
            let angle = match number::real(text) {
                Err(crate::NumberFault::Underflow) => 0.0,
                other => other.map_err(|fault| (Some(offset + k), Problem::Number { found: quote(text), fault }))?,
            };
            angles[(k - 3).min(2)] = angle;
        }
        if angles != [0.0; 3] {
            self.rotated.push(node);
        }
        self.positions.set_axes(node, angles);
        Ok(true)
    }

    /// Reads at most `count` members of a group from a line, and returns how many are still to read. A negative number ends the range that
    /// begins with the number before it.
    fn members(&mut self, name: &str, mut count: u32, format: &BlockFormat, line: &[u8]) -> Result<u32, FieldFault> {
        let group = Arc::make_mut(self.groups.entry(name.to_owned()).or_default());
        for (k, text) in format.integers(line).enumerate().filter(|(_, text)| !text.is_empty()) {
            if count == 0 {
                break;
            }
            count -= 1;
            let fault = || (Some(k + 1), Problem::Expected { expected: "the number of a node", found: quote(text) });
            let digits = text.strip_prefix(b"-").unwrap_or(text);
            let node = whole(digits).ok_or_else(fault)?;
            match group.last_mut() {
                Some((_, last)) if digits.len() < text.len() => *last = node.max(*last),
                _ => group.push((node, node)),
            }
        }
        Ok(count)
    }
}

impl Poses for AnsysNodes {
    fn pose(&self, node: u32) -> Result<Pose, Problem> {
        let problem = || Problem::Undefined { what: "the position of node", name: node.to_string() };
        self.positions.pose(node).ok_or_else(problem)
    }
}

/// A group name in capitals: names are compared without case.
pub fn group_name(text: &[u8]) -> String {
    String::from_utf8_lossy(text).to_ascii_uppercase()
}

fn format(line: &[u8]) -> Result<BlockFormat, FieldFault> {
    const EXPECTED: &str = "the format of the block, such as (3i9,6e21.13e3)";
    let fault = || (None, Problem::Expected { expected: EXPECTED, found: quote(line.trim_ascii()) });
    BlockFormat::parse(line).ok_or_else(fault)
}
