//! Reads the cards of rigid bodies.
//!
//! ```text
//! *CONSTRAINED_NODAL_RIGID_BODY    PID, CID, NSID, PNODE, IPRT, DRFLAG, RRFLAG
//!   with _SPC                      CMO, CON1, CON2
//!   with _INERTIA                  XC, YC, ZC, TM, IRCS, NODEID; 2 or 3 more lines; one body a card
//! *CONSTRAINED_EXTRA_NODES_NODE    PID, NID, IFLAG
//! *CONSTRAINED_EXTRA_NODES_SET     PID, NSID, IFLAG
//! *CONSTRAINED_RIGID_BODIES        PIDL, PIDC, IFLAG
//! *MAT_RIGID                       MID; CMO, CON1, CON2
//! ```

use super::coded;
use crate::deck::keyword::group::{Gap, GroupMeaning};
use crate::deck::keyword::line::{KeywordFault, KeywordLine};
use crate::deck::kinematics::components::Components;
use crate::deck::kinematics::rigid::RigidElement;
use crate::deck::lsdyna::model::bodies::DynaDefinitions;
use crate::deck::lsdyna::model::mesh::SetKind;
use crate::deck::{Model, Problem};

/// The field that names the node set of a nodal rigid body: NSID, or PID if NSID is 0.
fn set_field(line: &KeywordLine) -> Result<usize, KeywordFault> {
    Ok(if line.id(2)? == 0 { 0 } else { 2 })
}

/// Adds a nodal rigid body to the definitions. `inertia` is the line that gives its centre of mass.
pub fn define(
    line: &KeywordLine,
    inertia: Option<&KeywordLine>,
    all: &mut DynaDefinitions,
    model: &mut Model,
) -> Result<(), KeywordFault> {
    let nodes = all.mesh.members(SetKind::Node, line, set_field(line)?).unwrap_or_default().to_vec();
    let centre = inertia.map(|line| all.mesh.centre(line)).transpose()?;
    all.add_body(line.id(0)?, &nodes, centre, model).map_err(|problem| line.fault(problem))
}

/// The equations of the nodes of a nodal rigid body.
pub fn nodal(lines: &[KeywordLine], all: &mut DynaDefinitions) -> Result<GroupMeaning, Gap> {
    let line = &lines[0];
    let mut nodes = all.mesh.node_list(true, line, set_field(line)?)?;
    if line.whole(5)? != 0 || line.whole(6)? != 0 {
        return Err(Gap::Unread("releases components (DRFLAG, RRFLAG)".into()));
    }
    // The solver moves the node PNODE to the centre of mass, so this node belongs to the body.
    let centre = line.whole(3)?.unsigned_abs() as u32;
    if centre != 0 && !nodes.contains(&centre) {
        nodes.push(centre);
    }
    GroupMeaning::of_body(line, all.follow(all.named(line, 0)?, nodes))
}

/// Reads a [`nodal`] rigid body with the option `_SPC`: its second line holds components of the centre of mass at zero.
pub fn nodal_held(lines: &[KeywordLine], all: &mut DynaDefinitions) -> Result<GroupMeaning, Gap> {
    let made = nodal(lines, all)?;
    let Some(line) = lines.get(1) else { return Ok(made) };
    match held_at_centre(line) {
        Ok(held) => Ok(made.with_held(line, all.named(&lines[0], 0)?.dofs(held))),
        Err(Gap::Unread(why)) => Ok(GroupMeaning { left_out: Some(why), ..made }),
        Err(gap) => Err(gap),
    }
}

/// The components of a centre of mass that a line `CMO, CON1, CON2` holds at zero.
fn held_at_centre(line: &KeywordLine) -> Result<Components, Gap> {
    match line.number(0)?.unwrap_or(0.0) {
        0.0 => Ok(Components::default()),
        1.0 => Ok(coded(line, 1, 1)?.or(coded(line, 2, 4)?)),
        other => Err(Gap::Unread(format!("holds the body with CMO = {other}"))),
    }
}

/// Equations of a node, or of a set of nodes, that is added to a body.
pub fn extra<const IS_SET: bool>(lines: &[KeywordLine], all: &mut DynaDefinitions) -> Result<GroupMeaning, Gap> {
    let line = &lines[0];
    let (body, nodes) = (all.named(line, 0)?, all.mesh.node_list(IS_SET, line, 1)?);
    if line.whole(2)? != 1 {
        all.move_centre(line.id(0)?);
    }
    GroupMeaning::of_body(line, all.follow(body, nodes))
}

/// The equations that merge a second rigid body into the first.
pub fn merged(lines: &[KeywordLine], all: &mut DynaDefinitions) -> Result<GroupMeaning, Gap> {
    let line = &lines[0];
    let (lead, constrained) = (all.named(line, 0)?, all.named(line, 1)?);
    if lead.node == constrained.node {
        let problem = Problem::Circular { what: "rigid body", name: line.id(0)?.to_string() };
        return Err(line.fault_at(1, problem).into());
    }
    if line.whole(2)? != 1 {
        all.move_centre(line.id(0)?);
    }
    all.merged.insert(constrained.node, lead.node);
    let element = RigidElement::about(lead.node, [constrained.node], Components::ALL);
    GroupMeaning::of_body(line, element.equations(&all.mesh))
}

/// The equations of the nodes of a part, if the material of the part is rigid.
pub fn part(lines: &[KeywordLine], all: &mut DynaDefinitions) -> Result<GroupMeaning, Gap> {
    let part = lines[0].id(0)?;
    let is_rigid = all.mesh.parts.get(&part).is_some_and(|part| all.mesh.rigid.contains(&part.material));
    let Some(body) = all.body(part).filter(|_| is_rigid) else { return Ok(GroupMeaning::default()) };
    GroupMeaning::of_body(&lines[0], all.follow(body, all.mesh.elements.nodes_of(&[part])?))
}

/// The components that a rigid material holds at zero at the centres of mass of its parts.
pub fn material(lines: &[KeywordLine], all: &mut DynaDefinitions) -> Result<GroupMeaning, Gap> {
    let [first, second, ..] = lines else { return Ok(GroupMeaning::default()) };
    let (material, held) = (first.id(0)?, held_at_centre(second)?);
    let own = all.mesh.parts.iter().filter(|(_, part)| part.material == material);
    let mut parts: Vec<u32> = own.map(|(&id, _)| id).collect();
    parts.sort_unstable();
    let bodies = parts.into_iter().filter_map(|part| all.body(part));
    Ok(GroupMeaning { number: Some(material), ..GroupMeaning::default() }
        .with_held(second, bodies.flat_map(|body| body.dofs(held))))
}
