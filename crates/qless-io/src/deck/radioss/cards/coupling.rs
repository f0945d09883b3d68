//! Reads the cards that couple nodes: weighted means and linear equations.
//!
//! ```text
//! /RBE3     Node_IDr, Trarot_ref, N_set, I_modif, Iform
//!           WTi (20 columns), Trarot_Mi, skew_IDi, grnod_IDi; N_set lines
//! /MPC      node_ID, Idof, skew_ID, alpha (20 columns); a line for each term of sum alpha u = 0
//! ```

use super::{along, marked, own};
use crate::deck::Problem;
use crate::deck::keyword::group::{Gap, GroupMeaning, is_without_axes};
use crate::deck::keyword::line::{FieldLayout, KeywordLine};
use crate::deck::kinematics::axes::BASIC_AXES;
use crate::deck::kinematics::body::CouplingEquation;
use crate::deck::kinematics::components::Components;
use crate::deck::kinematics::mean::{MeanElement, WeightedNodes};
use crate::deck::radioss::model::mesh::{RadiossMean, RadiossMesh};

/// The equations by which a node moves as the weighted mean of others.
pub fn mean(lines: &[KeywordLine], mesh: &mut RadiossMesh) -> Result<GroupMeaning, Gap> {
    let (line, set) = (&lines[0], marked(&lines[0], 1)?);
    if line.whole(4)? == 3 {
        return Err(Gap::Unread("ties by springs, which are no equations (Iform)".into()));
    }
    let reference = mesh.node_at(line, 0)?;
    let components = own(mesh, reference, if set.is_empty() { Components::ALL } else { set });
    let (count, kind) = (line.id(2)? as usize, line.whole(3)?);
    let given: Vec<&KeywordLine> = lines[1..].iter().filter(|line| !line.is_blank()).take(count).collect();
    if given.len() < count {
        let problem = Problem::TooFew { what: "sets of nodes", promised: count, found: given.len() };
        return Err(line.fault_at(2, problem).into());
    }
    let mut groups = Vec::new();
    for line in given {
        groups.extend(weighted(line, kind, mesh)?);
    }
    // Unless I_modif is 2, the solver divides the weights of each direction by their sum.
    if kind != 2 {
        normalise(&mut groups);
    }
    let nodes = groups.iter().flat_map(|group| &group.nodes).copied().collect();
    let element = MeanElement { reference, components, groups, dependent: Vec::new() };
    let rows = element.equations(mesh).map_err(|problem| line.fault(problem))?;
    mesh.means.push(RadiossMean { reference, nodes, is_strict: line.whole(4)? == 2, place: mesh.card.clone() });
    Ok(GroupMeaning { is_linearised: !rows.is_empty(), rows, ..GroupMeaning::default() })
}

/// The components of nodes that a line lists, one component in each group.
fn weighted(line: &KeywordLine, kind: i64, mesh: &RadiossMesh) -> Result<Vec<WeightedNodes>, Gap> {
    let given = line.laid_out(FieldLayout::Wide).number(0)?.unwrap_or(0.0);
    let weight = if given == 0.0 || kind == 3 { 1.0 } else { given };
    let marked = marked(line, 2)?;
    let set = if marked.is_empty() { Components::TRANSLATIONS } else { marked };
    if line.id(3)? != 0 && !is_without_axes(set) {
        return Err(Gap::Unread("weighs components along local directions".into()));
    }
    let mut groups = Vec::new();
    for node in mesh.group_nodes(line, 4)? {
        let one = |component| WeightedNodes { weight, components: Components::one(component), nodes: vec![node] };
        groups.extend(own(mesh, node, set).iter().map(one));
    }
    Ok(groups)
}

/// Divides the weights of translations and rotations in each direction by the sum of those of translations.
fn normalise(groups: &mut [WeightedNodes]) {
    let direction = |group: &WeightedNodes| group.components.iter().next().map_or(0, |k| usize::from(k - 1));
    let mut sums = [0.0; 3];
    for group in groups.iter().filter(|group| direction(group) < 3) {
        sums[direction(group)] += group.weight;
    }
    for group in groups {
        let sum = sums[direction(group) % 3];
        group.weight /= if sum == 0.0 { 1.0 } else { sum };
    }
}

/// The equation that consists of the listed terms.
pub fn linear(lines: &[KeywordLine], mesh: &mut RadiossMesh) -> Result<GroupMeaning, Gap> {
    let mut terms = Vec::new();
    for line in lines.iter().filter(|line| !line.is_blank()) {
        let component = u8::try_from(line.whole(1)?).ok().filter(|component| (1..=6).contains(component));
        let component = component.ok_or_else(|| line.expected(1, "a degree of freedom from 1 to 6"))?;
        let (node, axes) = (mesh.node_at(line, 0)?, mesh.axes(line, 2)?.unwrap_or(BASIC_AXES));
        let given = line.laid_out(FieldLayout::Wide).number(3)?.unwrap_or(0.0);
        let factor = if given == 0.0 { 1.0 } else { given };
        terms.extend(along(node, component, &axes).into_iter().map(|(dof, x)| (dof, factor * x)));
    }
    let rows = if terms.is_empty() { Vec::new() } else { vec![CouplingEquation { terms }] };
    Ok(GroupMeaning { rows, ..GroupMeaning::default() })
}
