//! The nodes of a deck's equations for ParaView: an unstructured grid of VTK in XML, with a vertex for each node.
//!
//! Point data: the number of the `node`, and the counts of its `slaves`, `masters` and `prescribed` DOFs and of its `redundant` and
//! `conflicting` equations.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Display;

use qless::{Kind, Reduction};

use crate::diagnose::Diagnosis;
use crate::failure::CliFailure;

/// Names of the counts at a node.
const COUNTS: [&str; 5] = ["slaves", "masters", "prescribed", "redundant", "conflicting"];

type VtuCounts = [i32; COUNTS.len()];

/// Renders the file. It shows the slaves of `reduction`, or without one those of a new reduction.
pub fn render(diagnosis: &Diagnosis, reduction: Option<&Reduction>) -> Result<Vec<u8>, CliFailure> {
    let input = diagnosis.args.input.display();
    let Some(deck) = &diagnosis.deck else {
        return Err(CliFailure::Input(format!(
            "{input}: --format vtu shows nodes, which a matrix does not have; name a deck"
        )));
    };
    let positions = deck.deck.positions();
    let counts = counts(diagnosis, reduction, &|j| deck.deck.model().dofs().get(j).map(|dof| dof.node))?;
    let shown: Vec<(u32, [f64; 3], VtuCounts)> =
        counts.into_iter().filter_map(|(node, counts)| Some((node, *positions.get(&node)?, counts))).collect();
    if shown.is_empty() {
        return Err(CliFailure::Input(format!(
            "{input}: the deck has no position for any node of its equations; add the cards of the nodes"
        )));
    }
    Ok(grid(&shown).into_bytes())
}

/// Counts of each node that occurs in an equation.
fn counts(
    diagnosis: &Diagnosis,
    reduction: Option<&Reduction>,
    node_of: &dyn Fn(usize) -> Option<u32>,
) -> Result<BTreeMap<u32, VtuCounts>, CliFailure> {
    let system = &diagnosis.system;
    let input = &diagnosis.args.input;
    let refused = |error| CliFailure::from_reduction(error, input, system);
    let reduction = match reduction {
        Some(reduction) => Cow::Borrowed(reduction),
        None => Cow::Owned(diagnosis.analysis.reduction().map_err(refused)?),
    };
    let mut counts: BTreeMap<u32, VtuCounts> = BTreeMap::new();
    let mut held = vec![false; system.dofs()];
    for (i, kind) in diagnosis.analysis.kinds().iter().enumerate() {
        system.matrix().row(i).for_each(|(j, _)| held[j] = true);
        let nodes: BTreeSet<u32> = system.matrix().row(i).filter_map(|(j, _)| node_of(j)).collect();
        for node in nodes {
            let counts = counts.entry(node).or_default();
            counts[3] += i32::from(*kind == Kind::Redundant);
            counts[4] += i32::from(*kind == Kind::Conflicting);
        }
    }
    for (side, dofs) in [reduction.slaves(), reduction.masters(), reduction.prescribed()].into_iter().enumerate() {
        for node in dofs.iter().filter(|&&j| held[j]).filter_map(|&j| node_of(j)) {
            counts.entry(node).or_default()[side] += 1;
        }
    }
    Ok(counts)
}

/// The file as XML: <https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>
fn grid(shown: &[(u32, [f64; 3], VtuCounts)]) -> String {
    let n = shown.len();
    let counts: String =
        (0..COUNTS.len()).map(|k| array("Int32", COUNTS[k], 1, shown.iter().map(|(.., counts)| counts[k]))).collect();
    let point_data = array("Int32", "node", 1, shown.iter().map(|(node, ..)| *node as i32)) + &counts;
    let points = array("Float64", "points", 3, shown.iter().flat_map(|(_, position, _)| *position));
    let cells = array("Int64", "connectivity", 1, 0..n)
        + &array("Int64", "offsets", 1, 1..=n)
        + &array("UInt8", "types", 1, shown.iter().map(|_| VERTEX));
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n\
         <Piece NumberOfPoints=\"{n}\" NumberOfCells=\"{n}\">\n<PointData>\n{point_data}</PointData>\n<Points>\n{points}</Points>\n\
         <Cells>\n{cells}</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"
    )
}

/// The cell type of VTK for a single node.
const VERTEX: u8 = 1;

fn array(kind: &str, name: &str, components: usize, values: impl Iterator<Item = impl Display>) -> String {
    let values: Vec<String> = values.map(|value| value.to_string()).collect();
    format!(
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"ascii\">{}</DataArray>\n",
        values.join(" ")
    )
}
