//! `D`, `DDELE`, `F` and `FDELE`: which DOFs of which nodes, and what value.
//!
//! ```text
//! D,     NODE, Lab, VALUE, VALUE2, NEND, NINC, Lab2, ... Lab6
//! DDELE, NODE, Lab, NEND, NINC
//! F,     NODE, Lab, VALUE, VALUE2, NEND, NINC
//! FDELE, NODE, Lab, NEND, NINC
//! ```

use crate::deck::ansys::model::events::{ComponentList, EventAction, NodeChoice};
use crate::deck::ansys::model::nodes::{AnsysNodes, name};
use crate::deck::ansys::model::selection::{NodeSelection, SelectedNodes};
use crate::deck::ansys::syntax::command::AnsysCommand;
use crate::deck::ansys::syntax::field::{FieldFault, component, expected, range, real, whole};
use crate::deck::ansys::syntax::label;

/// What such a command does, or why it is left out.
pub enum DofCommand {
    /// To these nodes and components.
    Does(EventAction, NodeChoice, ComponentList),
    /// The same, with something to be said about it.
    Roughly(EventAction, NodeChoice, ComponentList, String),
    /// Nothing that this reader can follow.
    LeftOut(String),
}

/// `D`.
pub fn prescribe(
    command: &AnsysCommand,
    nodes: &AnsysNodes,
    selection: &NodeSelection,
) -> Result<DofCommand, FieldFault> {
    if label::is_rate(command.field(2)) {
        return Ok(DofCommand::LeftOut(format!("{} prescribes a velocity or an acceleration", said(command))));
    }
    let which = match which(command, 5, nodes, selection)? {
        Ok(which) => which,
        Err(why) => return Ok(DofCommand::LeftOut(why)),
    };
    let components = match components(command, &[2, 7, 8, 9, 10, 11], selection)? {
        Ok(components) => components,
        Err(why) => return Ok(DofCommand::LeftOut(why)),
    };
    if let Some(table) = table(command.field(3)) {
        let text = format!("{} takes its value from the table {table}: it counts as 1 times that", said(command));
        return Ok(DofCommand::Roughly(EventAction::Prescribe(1.0, Some(table.into())), which, components, text));
    }
    let action = EventAction::Prescribe(real(command, 3)?, None);
    if real(command, 4)? != 0.0 {
        let text = format!("the imaginary part of {} is not looked at", said(command));
        return Ok(DofCommand::Roughly(action, which, components, text));
    }
    Ok(DofCommand::Does(action, which, components))
}

/// `DDELE`.
pub fn release(
    command: &AnsysCommand,
    nodes: &AnsysNodes,
    selection: &NodeSelection,
) -> Result<DofCommand, FieldFault> {
    if label::is_rate(command.field(2)) {
        return Ok(DofCommand::LeftOut(format!("{} deletes a velocity or an acceleration", said(command))));
    }
    let which = match which(command, 3, nodes, selection)? {
        Ok(which) => which,
        Err(why) => return Ok(DofCommand::LeftOut(why)),
    };
    Ok(match components(command, &[2], selection)? {
        Ok(components) => DofCommand::Does(EventAction::Release, which, components),
        Err(why) => DofCommand::LeftOut(why),
    })
}

/// `F` and `FDELE`; other loads than those on a DOF do not matter here.
pub fn load(
    command: &AnsysCommand,
    nodes: &AnsysNodes,
    selection: &NodeSelection,
    adds: bool,
) -> Result<Option<DofCommand>, FieldFault> {
    let Ok(which) = which(command, if adds { 5 } else { 3 }, nodes, selection)? else { return Ok(None) };
    let all = !adds && command.is(2, "ALL");
    let component = label::loaded(command.field(2));
    if component.is_none() && !all {
        return Ok(None);
    }
    let action = if adds { EventAction::Load } else { EventAction::Unload };
    Ok(Some(DofCommand::Does(action, which, [component.unwrap_or(0), 0, 0, 0, 0, 0])))
}

/// The nodes of field 1, to field `end` in steps of the next one; or why they are not known.
fn which(
    command: &AnsysCommand,
    end: usize,
    nodes: &AnsysNodes,
    selection: &NodeSelection,
) -> Result<Result<NodeChoice, String>, FieldFault> {
    let field = command.field(1);
    if let Some(first) = whole(field) {
        return range(command, first, end).map(|(first, last, step)| Ok(NodeChoice::Range(first, last, step)));
    }
    let group = name(field);
    Ok(match group.as_str() {
        "ALL" if selection.nodes == SelectedNodes::All => Ok(NodeChoice::All),
        "ALL" => match &selection.nodes {
            SelectedNodes::Ranges(ranges) => Ok(NodeChoice::Ranges(ranges.as_slice().into())),
            _ => Err(format!("{} names the selected nodes, and this selection is not followed", said(command))),
        },
        "P" => Err(format!("{} names nodes that are picked by hand", said(command))),
        _ if nodes.unknown_groups.contains(&group) => {
            Err(format!("{} names a component of selected nodes, and selections are not followed", said(command)))
        }
        _ if nodes.groups.contains_key(&group) => Ok(NodeChoice::Group(group.into())),
        _ => return Err(expected(command, 1, "the number of a node, ALL, or a component that CMBLOCK defines")),
    })
}

/// The components of the labels in these fields, none for `ALL`; or why they are not known.
fn components(
    command: &AnsysCommand,
    at: &[usize],
    selection: &NodeSelection,
) -> Result<Result<ComponentList, String>, FieldFault> {
    if at.iter().any(|&at| command.is(at, "ALL")) {
        let why = || format!("{} names the selected labels, and selections are not followed", said(command));
        return Ok(if selection.dofs { Ok(ComponentList::default()) } else { Err(why()) });
    }
    let mut components = ComponentList::default();
    let given = at.iter().enumerate().filter(|&(k, &at)| k == 0 || !command.field(at).is_empty());
    for (place, (_, &at)) in components.iter_mut().zip(given) {
        *place = component(command, at)?;
    }
    Ok(Ok(components))
}

/// The name of a table between percent signs.
fn table(text: &[u8]) -> Option<String> {
    let name = text.strip_prefix(b"%")?;
    Some(String::from_utf8_lossy(name.strip_suffix(b"%").unwrap_or(name)).to_ascii_uppercase())
}

/// `D,5,UX`: the command as warnings name it.
fn said(command: &AnsysCommand) -> String {
    let text = |at: usize| String::from_utf8_lossy(&command.field(at)[..command.field(at).len().min(32)]).into_owned();
    format!("{},{},{}", command.title(), text(1), text(2))
}
