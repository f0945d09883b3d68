//! Reads the cards that couple nodes: weighted means, linear equations and equal translations.
//!
//! ```text
//! *CONSTRAINED_INTERPOLATION      ICID, DNID, DDOF, CIDD, ITYP
//!                                 INID, IDOF, TWGHTX, TWGHTY, TWGHTZ, RWGHTX, RWGHTY, RWGHTZ; a line for each node or set
//! *CONSTRAINED_LINEAR_GLOBAL      LCID
//!                                 NID, DOF, COEF; a line for each term of sum C_k u_k = 0
//! *CONSTRAINED_NODE_SET           NSID, DOF, TF
//! ```

use super::coded;
use crate::deck::Dof;
use crate::deck::keyword::group::{Gap, GroupMeaning, dofs, is_without_axes};
use crate::deck::keyword::line::{KeywordFault, KeywordLine};
use crate::deck::kinematics::body::CouplingEquation;
use crate::deck::kinematics::components::Components;
use crate::deck::kinematics::mean::{MeanElement, WeightedNodes};
use crate::deck::lsdyna::model::bodies::DynaDefinitions;
use crate::deck::lsdyna::model::mesh::DynaMesh;

/// The equations by which a dependent node moves as the weighted mean of the independent nodes.
pub fn interpolation(lines: &[KeywordLine], all: &mut DynaDefinitions) -> Result<GroupMeaning, Gap> {
    let (first, mesh) = (&lines[0], &all.mesh);
    let (is_set, reference) = (first.whole(4)? == 1, first.id(1)?);
    let mut groups = Vec::new();
    for line in lines[1..].iter().filter(|line| !line.is_blank()) {
        let weights = weights(line)?;
        for node in mesh.node_list(is_set, line, 0)? {
            let group = |component| WeightedNodes {
                weight: weights[usize::from(component) - 1],
                components: Components::one(component),
                nodes: vec![node],
            };
            groups.extend(components(line, 1, node, mesh)?.iter().map(group));
        }
    }
    let components = components(first, 2, reference, mesh)?;
    if first.id(3)? != 0 && !is_without_axes(components) {
        return Err(Gap::Unread("moves its dependent node along local directions (CIDD)".into()));
    }
    let element = MeanElement { reference, components, groups, dependent: Vec::new() };
    GroupMeaning::of_body(first, element.equations(mesh))
}

/// The components that a field lists, such as 1356, without those that the node does not have. A blank field lists all.
fn components(line: &KeywordLine, field: usize, node: u32, mesh: &DynaMesh) -> Result<Components, KeywordFault> {
    let code = line.whole(field)?;
    let given = if code == 0 { Some(Components::ALL) } else { Components::parse(code.to_string().as_bytes()) };
    let all = given.ok_or_else(|| line.expected(field, "digits from 1 to 6"))?;
    Ok(if mesh.elements.rotates(node) { all } else { all.and(Components::TRANSLATIONS) })
}

/// The weights of components 1 to 6. The default is 1 for the first weight, and the first weight for the others.
fn weights(line: &KeywordLine) -> Result<[f64; 6], KeywordFault> {
    let mut weights = [1.0; 6];
    for k in 0..6 {
        let default = if k == 0 { 1.0 } else { weights[0] };
        weights[k] = line.number(2 + k)?.filter(|weight| *weight != 0.0).unwrap_or(default);
    }
    Ok(weights)
}

/// The equation that consists of the listed terms. The solver eliminates its first DOF.
pub fn linear(lines: &[KeywordLine], all: &mut DynaDefinitions) -> Result<GroupMeaning, Gap> {
    let mut terms = Vec::new();
    for line in lines[1..].iter().filter(|line| !line.is_blank()) {
        let component = u8::try_from(line.whole(1)?).ok().filter(|component| (1..=7).contains(component));
        let component = component.ok_or_else(|| line.expected(1, "a degree of freedom from 1 to 7"))?;
        let node = all.mesh.node_list(false, line, 0)?[0];
        terms.push((Dof { node, component }, line.number(2)?.unwrap_or(0.0)));
    }
    let rows = if terms.is_empty() { Vec::new() } else { vec![CouplingEquation { terms }] };
    GroupMeaning::of_rows(&lines[0], Ok(rows))
}

/// The equations by which the nodes of a set have the same translations in some directions. The other nodes follow the first.
pub fn equal(lines: &[KeywordLine], all: &mut DynaDefinitions) -> Result<GroupMeaning, Gap> {
    let (nodes, directions) = (all.mesh.node_list(true, &lines[0], 0)?, coded(&lines[0], 1, 1)?);
    let follows = |dof: Dof| CouplingEquation::new(dof, [(Dof { node: nodes[0], ..dof }, 1.0)]);
    let others = nodes.iter().skip(1).copied().collect();
    GroupMeaning::of_rows(&lines[0], Ok(dofs(others, directions).map(follows).collect()))
}
