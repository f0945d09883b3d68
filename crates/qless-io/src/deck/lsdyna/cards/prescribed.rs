//! Reads the cards that prescribe values.
//!
//! ```text
//! *NODE                               NID, X, Y, Z, TC, RC
//! *BOUNDARY_SPC_NODE, _SET            NID or NSID, CID, DOFX, DOFY, DOFZ, DOFRX, DOFRY, DOFRZ
//! *BOUNDARY_PRESCRIBED_MOTION_NODE,   NID, NSID or PID, DOF, VAD, LCID, SF, VID, DEATH, BIRTH
//!   _SET, _RIGID
//! *BOUNDARY_SPC_..._BIRTH_DEATH        the same, then BIRTH, DEATH
//! ```
//!
//! A curve (LCID) is a time history. The reader does not evaluate the curve: the scale factor SF counts as the value at the end. So motions
//! with the same curve are compared by their factors, and motions with different curves count as independent.

use super::coded;
use crate::deck::keyword::group::{Gap, GroupMeaning, HeldDof, dofs, is_without_axes};
use crate::deck::keyword::line::{FieldLayout, KeywordLine};
use crate::deck::kinematics::components::Components;
use crate::deck::lsdyna::model::bodies::DynaDefinitions;

/// The components of a node that the fields TC and RC of its `*NODE` line hold at zero.
pub fn node(lines: &[KeywordLine], _: &mut DynaDefinitions) -> Result<GroupMeaning, Gap> {
    let line = lines[0].laid_out(FieldLayout::Node);
    if line.field(4).is_empty() && line.field(5).is_empty() {
        return Ok(GroupMeaning::default());
    }
    let held = coded(&line, 4, 1)?.or(coded(&line, 5, 4)?);
    Ok(GroupMeaning::default().with_held(&line, dofs(vec![line.id(0)?], held)))
}

/// Components that a support of a node or of a node set holds at zero.
pub fn support<const IS_SET: bool>(lines: &[KeywordLine], all: &mut DynaDefinitions) -> Result<GroupMeaning, Gap> {
    let nodes = all.mesh.node_list(IS_SET, &lines[0], 0)?;
    if let Some(times) = lines.get(1) {
        refuse_times(times, 0, 1)?;
    }
    Ok(GroupMeaning::default().with_held(&lines[0], dofs(nodes, supported(&lines[0])?)))
}

/// The components that a support holds. If it holds all three translations or all three rotations, local directions mean the same as global
/// ones.
fn supported(line: &KeywordLine) -> Result<Components, Gap> {
    let mut held = Components::default();
    for component in 1..=6 {
        if line.whole(usize::from(component) + 1)? != 0 {
            held = held.with(component);
        }
    }
    if line.id(1)? != 0 && !is_without_axes(held) {
        return Err(Gap::Unread("holds nodes along local directions".into()));
    }
    Ok(held)
}

/// Fails if a value holds only after a birth time or before a death time, because all cards hold at all times here.
fn refuse_times(line: &KeywordLine, birth: usize, death: usize) -> Result<(), Gap> {
    // Defaults of the death time of supports and motions are 1e20 and 1e28; 0 stands for the default.
    let (birth, death) = (line.number(birth)?.unwrap_or(0.0), line.number(death)?.unwrap_or(0.0));
    if birth > 0.0 || death > 0.0 && death < 1e20 {
        let end = if death > 0.0 { format!(" to {death}") } else { String::new() };
        return Err(Gap::Unread(format!("holds only from time {birth}{end}")));
    }
    Ok(())
}

/// Motion of a node or of a node set.
pub fn node_motion<const IS_SET: bool>(lines: &[KeywordLine], all: &mut DynaDefinitions) -> Result<GroupMeaning, Gap> {
    motion(&lines[0], all.mesh.node_list(IS_SET, &lines[0], 0)?)
}

/// The motion that the card prescribes for the centre of mass of a rigid body.
pub fn body_motion(lines: &[KeywordLine], all: &mut DynaDefinitions) -> Result<GroupMeaning, Gap> {
    motion(&lines[0], vec![all.named(&lines[0], 0)?.node])
}

fn motion(line: &KeywordLine, nodes: Vec<u32>) -> Result<GroupMeaning, Gap> {
    let quantity = match line.whole(2)? {
        0 => "velocity",
        1 => "acceleration",
        2 => "displacement",
        other => return Err(Gap::UnreadFromHere(format!("prescribes a motion with VAD = {other}"))),
    };
    let component = match line.whole(1)? {
        direction @ 1..=3 => direction as u8,
        rotation @ 5..=7 => rotation as u8 - 1,
        // The rest of the card cannot be read either: some of these motions have a second line.
        other => return Err(Gap::UnreadFromHere(format!("prescribes a motion with DOF = {other}"))),
    };
    refuse_times(line, 7, 6)?;
    let history = format!("{quantity} curve {}", line.whole(3)?);
    let value = line.number(4)?.unwrap_or(1.0);
    let history = Some(history).filter(|_| value != 0.0);
    let held = dofs(nodes, Components::one(component));
    let held = held.map(|dof| HeldDof { dof, value, history: history.clone(), line: line.number }).collect();
    Ok(GroupMeaning { held, ..GroupMeaning::default() })
}
