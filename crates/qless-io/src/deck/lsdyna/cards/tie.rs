//! Reads `*CONTACT_TIED_NODES_TO_SURFACE` and `*CONTACT_TIED_SURFACE_TO_SURFACE`. The translations u_s of each slave node follow the
//! nearest point of a master segment, `u_s = sum N_i u_i`: N_i are the shape functions of the segment at this point, and u_i the
//! translations of its nodes. The solver moves the slave node to this point.
//!
//! ```text
//! line 1   SSID, MSID, SSTYP, MSTYP, SBOXID, MBOXID     types: 0 segment set, 2 part set, 3 part, 4 node set
//! line 2   friction
//! line 3   SFS, SFM, SST, MST
//! ```

use crate::deck::keyword::elements::{KeywordElement, distinct, outside};
use crate::deck::keyword::group::{Gap, GroupMeaning};
use crate::deck::keyword::line::KeywordLine;
use crate::deck::keyword::tied::{TiedSurface, follow};
use crate::deck::kinematics::body::Poses;
use crate::deck::kinematics::project::MasterFace;
use crate::deck::lsdyna::model::bodies::DynaDefinitions;
use crate::deck::lsdyna::model::mesh::{DynaMesh, SetKind};

/// A node is tied if its distance from the segment is at most `max(OF_DIAGONAL * d, OF_THICKNESS * t)`. Here d is the shorter diagonal of
/// the segment, and t the sum of the thicknesses SST and MST (Keyword Manual, remarks on tied contact).
const OF_DIAGONAL: f64 = 0.05;
const OF_THICKNESS: f64 = 0.6;

/// The equations that tie the slave nodes of a contact to its master segments.
pub fn tie(lines: &[KeywordLine], all: &mut DynaDefinitions) -> Result<GroupMeaning, Gap> {
    let (line, mesh) = (&lines[0], &all.mesh);
    if line.id(4)? != 0 || line.id(5)? != 0 {
        return Err(Gap::Unread("ties only what is in a box (SBOXID, MBOXID)".into()));
    }
    let thickness = match lines.get(2) {
        Some(line) => line.number(2)?.unwrap_or(0.0).abs() + line.number(3)?.unwrap_or(0.0).abs(),
        None => 0.0,
    };
    let reach = |face: &MasterFace| (OF_DIAGONAL * face.least_diagonal()).max(OF_THICKNESS * thickness);
    let surface = TiedSurface::new(line, 1, masters(line, mesh)?, mesh, reach)?;
    let (mut made, mut apart) = (GroupMeaning::default(), Vec::new());
    for node in slaves(line, mesh)? {
        let at = mesh.pose(node).map_err(|problem| line.fault_at(0, problem))?.position;
        match surface.nearest(at).map(|near| (&surface.faces[near.face].nodes, near.weights)) {
            Some((nodes, _)) if nodes.contains(&node) => {}
            Some((nodes, weights)) => made.rows.extend(follow(node, 1..=3, nodes, &weights)),
            None => apart.push(node),
        }
    }
    let Some(first) = apart.first() else { return Ok(made) };
    if thickness == 0.0 && mesh.elements.has_shells() {
        let why = format!("needs the thickness of shells to tie nodes such as {first} (write SST and MST)");
        return Ok(GroupMeaning { left_out: Some(why), ..made });
    }
    made.warning =
        Some(format!("leaves {} nodes free that are too far from the surface, such as {first}", apart.len()));
    Ok(made)
}

fn slaves(line: &KeywordLine, mesh: &DynaMesh) -> Result<Vec<u32>, Gap> {
    let mut nodes = match line.whole(2)? {
        0 => mesh.members(SetKind::Segment, line, 0)?.to_vec(),
        4 => mesh.members(SetKind::Node, line, 0)?.to_vec(),
        kind => elements(line, 0, kind, mesh)?.into_iter().flat_map(|element| &element.nodes).copied().collect(),
    };
    nodes.sort_unstable();
    nodes.dedup();
    Ok(nodes)
}

fn masters(line: &KeywordLine, mesh: &DynaMesh) -> Result<Vec<Vec<u32>>, Gap> {
    Ok(match line.whole(3)? {
        0 => mesh.members(SetKind::Segment, line, 1)?.chunks(4).map(distinct).collect(),
        kind => outside(&elements(line, 1, kind, mesh)?),
    })
}

/// Elements of a part or of a part set.
fn elements<'a>(
    line: &KeywordLine,
    field: usize,
    kind: i64,
    mesh: &'a DynaMesh,
) -> Result<Vec<&'a KeywordElement>, Gap> {
    match kind {
        2 => mesh.elements.of(mesh.members(SetKind::Part, line, field)?),
        3 => mesh.elements.of(&[line.id(field)?]),
        other => Err(Gap::Unread(format!("names a surface by type {other}"))),
    }
}
