//! Reads the cards that prescribe values.
//!
//! ```text
//! /BCS                 Trarot, skew_ID, grnod_ID
//! /NBCS                Trarot, skew_ID, node_ID; a line for each node
//! /IMPDISP, /IMPVEL,   fct_ID, Dir, skew_ID, sens_ID, grnod_ID, frame_ID, Icoor
//!   /IMPACC            Ascale_x, Fscale_y, Tstart, Tstop (20 columns each)
//! ```
//!
//! A function is a time history. The reader does not evaluate it: the scale factor Fscale_y counts as the value at the end. So motions with
//! the same function are compared by their factors, and motions with different functions count as independent.

use super::{along, led, marked};
use crate::deck::Dof;
use crate::deck::keyword::group::{Gap, GroupMeaning, HeldDof, dofs, is_without_axes};
use crate::deck::keyword::line::{FieldLayout, KeywordLine};
use crate::deck::kinematics::axes::BASIC_AXES;
use crate::deck::kinematics::vector::Vector;
use crate::deck::radioss::model::mesh::RadiossMesh;

/// Components that are held at zero at the nodes of a group.
pub fn group(lines: &[KeywordLine], mesh: &mut RadiossMesh) -> Result<GroupMeaning, Gap> {
    let (line, nodes) = (&lines[0], mesh.group_nodes(&lines[0], 2)?);
    let skew = line.id(1)?;
    let other = nodes.iter().find(|node| *mesh.held_in.entry(**node).or_insert(skew) != skew);
    // Message 148 of the starter.
    let why = |node: &u32| format!("holds node {node}, which another /BCS holds in another skew frame");
    mesh.stops.extend(other.map(|node| (mesh.card.clone(), why(node))));
    held(line, nodes, mesh, GroupMeaning::default())
}

/// Components that are held at zero at single nodes.
pub fn nodes(lines: &[KeywordLine], mesh: &mut RadiossMesh) -> Result<GroupMeaning, Gap> {
    let mut filled = lines.iter().filter(|line| !line.is_blank());
    filled.try_fold(GroupMeaning::default(), |made, line| held(line, vec![mesh.node_at(line, 2)?], mesh, made))
}

/// Adds the components that a line holds at zero. Along an axis e that is oblique, this is the equation `e . u = 0`.
fn held(line: &KeywordLine, nodes: Vec<u32>, mesh: &RadiossMesh, mut made: GroupMeaning) -> Result<GroupMeaning, Gap> {
    let set = marked(line, 0)?;
    let Some(axes) = mesh.axes(line, 1)?.filter(|_| !is_without_axes(set)) else {
        return Ok(made.with_held(line, dofs(nodes, set)));
    };
    for (node, component) in nodes.into_iter().flat_map(|node| set.iter().map(move |component| (node, component))) {
        match along(node, component, &axes).as_slice() {
            [(dof, _)] => made = made.with_held(line, [*dof]),
            terms => made.rows.push(led(&made.rows, terms.to_vec(), terms.len())),
        }
    }
    Ok(made)
}

/// Motions `displacement`, `velocity` and `acceleration`.
pub fn displacement(lines: &[KeywordLine], mesh: &mut RadiossMesh) -> Result<GroupMeaning, Gap> {
    motion("displacement", lines, mesh)
}

/// See [`displacement`].
pub fn velocity(lines: &[KeywordLine], mesh: &mut RadiossMesh) -> Result<GroupMeaning, Gap> {
    motion("velocity", lines, mesh)
}

/// See [`displacement`].
pub fn acceleration(lines: &[KeywordLine], mesh: &mut RadiossMesh) -> Result<GroupMeaning, Gap> {
    motion("acceleration", lines, mesh)
}

/// The DOFs whose quantity follows a function.
fn motion(quantity: &str, lines: &[KeywordLine], mesh: &RadiossMesh) -> Result<GroupMeaning, Gap> {
    let line = &lines[0];
    if line.whole(3)? != 0 {
        return Err(Gap::Unread("holds only while its sensor is active".into()));
    }
    if line.whole(5)? != 0 || line.whole(6)? != 0 {
        return Err(Gap::Unread("prescribes a motion in a moving frame, or in cylindrical coordinates".into()));
    }
    let (history, scale) = function(quantity, line, lines.get(1))?;
    let component = direction(line)?;
    let axes = mesh.axes(line, 2)?.unwrap_or(BASIC_AXES);
    let mut held = Vec::new();
    // Without a group, the card moves nothing.
    let nodes = if line.whole(4)? == 0 { Vec::new() } else { mesh.group_nodes(line, 4)? };
    for node in nodes {
        let (dof, sign) = aligned(node, component, &axes)?;
        held.push(HeldDof { dof, value: sign * scale, history: Some(history.clone()), line: line.number });
    }
    Ok(GroupMeaning { held, ..GroupMeaning::default() })
}

/// The name of the time history, and the factor of its values.
fn function(quantity: &str, line: &KeywordLine, second: Option<&KeywordLine>) -> Result<(String, f64), Gap> {
    let number = |field| second.map_or(Ok(None), |line| line.laid_out(FieldLayout::Wide).number(field));
    let given = |field| Ok::<f64, Gap>(number(field)?.unwrap_or(0.0));
    let (start, end) = (given(4)?, given(6)?);
    // 0 stands for the default of the end, which is never.
    if start > 0.0 || end > 0.0 && end < 1e20 {
        let end = if end > 0.0 { format!(" to {end}") } else { String::new() };
        return Err(Gap::Unread(format!("holds only from time {start}{end}")));
    }
    // A scale of 0 counts as 1.
    let [time, scale] = [given(0)?, given(2)?].map(|x| if x == 0.0 { 1.0 } else { x });
    let times = if time == 1.0 { String::new() } else { format!(" (times {time})") };
    Ok((format!("{quantity} function {}{times}", line.whole(0)?), scale))
}

/// The component that a direction such as `X` or `YY` names.
fn direction(line: &KeywordLine) -> Result<u8, Gap> {
    match line.field(1) {
        b"X" | b"x" => Ok(1),
        b"Y" | b"y" => Ok(2),
        b"Z" | b"z" => Ok(3),
        b"XX" | b"xx" => Ok(4),
        b"YY" | b"yy" => Ok(5),
        b"ZZ" | b"zz" => Ok(6),
        _ => Err(line.expected(1, "a direction X, Y, Z, XX, YY or ZZ").into()),
    }
}

/// The global DOF of a component along its axis, and the sign of the axis.
fn aligned(node: u32, component: u8, axes: &[Vector; 3]) -> Result<(Dof, f64), Gap> {
    match along(node, component, axes).as_slice() {
        [(dof, x)] => Ok((*dof, x.signum())),
        _ => Err(Gap::Unread("prescribes a motion along an oblique direction".into())),
    }
}
