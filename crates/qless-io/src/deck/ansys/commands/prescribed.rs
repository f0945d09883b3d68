//! Reads the commands `D`, `DDELE`, `F` and `FDELE`: they prescribe, release, load and unload DOFs.
//!
//! ```text
//! D,     NODE, Lab, VALUE, VALUE2, NEND, NINC, Lab2, ... Lab6
//! DDELE, NODE, Lab, NEND, NINC      without Lab: all labels
//! F,     NODE, Lab, VALUE, VALUE2, NEND, NINC
//! FDELE, NODE, Lab, NEND, NINC
//! ```

use std::sync::Arc;

use crate::deck::ansys::model::events::{ComponentList, EventAction, NodeChoice};
use crate::deck::ansys::model::nodes::{AnsysNodes, group_name};
use crate::deck::ansys::model::selection::{NodeSelection, SelectedNodes};
use crate::deck::ansys::syntax::command::AnsysCommand;
use crate::deck::ansys::syntax::field::{FieldFault, component, expected, range, real, whole};
use crate::deck::ansys::syntax::label;

/// The effect of a command on DOFs, and a remark for the user.
pub struct DofCommand {
    pub action: EventAction,
    pub nodes: NodeChoice,
    pub components: ComponentList,
    pub remark: Option<String>,
}

/// Why a command has no effect.
pub enum Rejection {
    /// A field of the command is wrong.
    Fault(FieldFault),
    /// The text says why this reader cannot follow the command.
    LeftOut(String),
}

impl From<FieldFault> for Rejection {
    fn from(fault: FieldFault) -> Self {
        Self::Fault(fault)
    }
}

/// Reads `D`, which prescribes DOFs, or `DDELE`, which releases them.
pub fn dof_command(
    command: &AnsysCommand,
    nodes: &AnsysNodes,
    selection: &NodeSelection,
) -> Result<DofCommand, Rejection> {
    let releases = command.key == *b"DDEL";
    if label::is_rate(command.field(2)) {
        let verb = if releases { "deletes" } else { "prescribes" };
        return Err(Rejection::LeftOut(format!("{} {verb} a velocity or an acceleration", excerpt(command))));
    }
    let nodes = node_choice(command, if releases { 3 } else { 5 }, nodes, selection)?;
    let labels: &[usize] = if releases { &[2] } else { &[2, 7, 8, 9, 10, 11] };
    let components = components(command, labels, selection)?;
    let (action, remark) = if releases { (EventAction::Release, None) } else { prescribed(command)? };
    Ok(DofCommand { action, nodes, components, remark })
}

/// The value that `D` prescribes. If the value is a table or a complex number, also returns a remark for the user.
fn prescribed(command: &AnsysCommand) -> Result<(EventAction, Option<String>), FieldFault> {
    if let Some(name) = command.field(3).strip_prefix(b"%") {
        let table = String::from_utf8_lossy(name.strip_suffix(b"%").unwrap_or(name)).to_ascii_uppercase();
        let text =
            format!("{} takes its value from the table {table}: it counts as 1 times the table", excerpt(command));
        return Ok((EventAction::Prescribe(1.0, Some(table.into())), Some(text)));
    }
    let action = EventAction::Prescribe(real(command, 3)?, None);
    let is_complex = real(command, 4)? != 0.0;
    Ok((action, is_complex.then(|| format!("the imaginary part of {} is ignored", excerpt(command)))))
}

/// Reads `F`, which loads DOFs, or `FDELE`, which unloads them. Returns `None` for a load that acts on no DOF.
pub fn load(
    command: &AnsysCommand,
    nodes: &AnsysNodes,
    selection: &NodeSelection,
) -> Result<Option<DofCommand>, Rejection> {
    let adds = command.key == *b"F   ";
    let nodes = node_choice(command, if adds { 5 } else { 3 }, nodes, selection)?;
    let component = label::loaded(command.field(2));
    if component.is_none() && (adds || !command.is(2, "ALL")) {
        return Ok(None);
    }
    let action = if adds { EventAction::Load } else { EventAction::Unload };
    let components = [component.unwrap_or(0), 0, 0, 0, 0, 0];
    Ok(Some(DofCommand { action, nodes, components, remark: None }))
}

/// The nodes that the command names. Field 1 holds the first node, field `end` the last one, and the field after `end` the step; or field 1
/// holds `ALL` or the name of a group.
fn node_choice(
    command: &AnsysCommand,
    end: usize,
    nodes: &AnsysNodes,
    selection: &NodeSelection,
) -> Result<NodeChoice, Rejection> {
    let field = command.field(1);
    if let Some(first) = whole(field) {
        let (first, last, step) = range(command, first, end)?;
        return Ok(NodeChoice::Range(first, last, step));
    }
    let group = group_name(field);
    let why = match (group.as_str(), &selection.nodes) {
        ("ALL", SelectedNodes::All) => return Ok(NodeChoice::All),
        ("ALL", SelectedNodes::Ranges(ranges)) => return Ok(NodeChoice::Ranges(ranges.as_slice().into())),
        ("ALL", SelectedNodes::Unknown) => "the selected nodes, and this reader does not know which these are",
        ("P", _) => "nodes that the user picks interactively",
        _ if nodes.unknown_groups.contains(&group) => "a component of nodes that this reader does not know",
        _ if nodes.are_in_files && !nodes.groups.contains_key(&group) => {
            "a component or a parameter that this reader does not know"
        }
        _ => {
            const EXPECTED: &str = "the number of a node, ALL, or a component that CMBLOCK defines";
            let members = nodes.groups.get(&group).ok_or_else(|| expected(command, 1, EXPECTED))?;
            return Ok(NodeChoice::Group(Arc::clone(members)));
        }
    };
    Err(Rejection::LeftOut(format!("{} names {why}", excerpt(command))))
}

/// Components of the labels in the fields `at`. For `ALL` the list holds only zeros, which means all components.
fn components(command: &AnsysCommand, at: &[usize], selection: &NodeSelection) -> Result<ComponentList, Rejection> {
    let mut components = ComponentList::default();
    let releases_all = command.key == *b"DDEL" && command.field(2).is_empty();
    if releases_all || at.iter().any(|&at| command.is(at, "ALL")) {
        let why =
            || format!("{} names the selected labels, and this reader does not know which these are", excerpt(command));
        return if selection.dofs { Ok(components) } else { Err(Rejection::LeftOut(why())) };
    }
    let filled = at.iter().enumerate().filter(|&(k, &at)| k == 0 || !command.field(at).is_empty());
    for (place, (_, &at)) in components.iter_mut().zip(filled) {
        *place = component(command, at)?;
    }
    Ok(components)
}

/// The start of the command, such as `D,5,UX`, for messages.
fn excerpt(command: &AnsysCommand) -> String {
    let text = |at: usize| String::from_utf8_lossy(&command.field(at)[..command.field(at).len().min(32)]).into_owned();
    format!("{},{},{}", command.title(), text(1), text(2))
}
