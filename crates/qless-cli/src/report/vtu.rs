//! The nodes of a deck's equations for ParaView: an unstructured grid of VTK in XML, with a vertex for each node.
//!
//! Point data: the number of the `node`, and the counts of its `slaves`, `masters` and `prescribed` DOFs and of its `redundant` and
//! `conflicting` equations.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use qless::{Kind, Reduction};
use vtkio::model::{
    Attribute, Attributes, ByteOrder, CellType, Cells, DataArrayBase, DataSet, IOBuffer, UnstructuredGridPiece,
    Version, VertexNumbers, Vtk,
};

use crate::diagnose::Diagnosis;
use crate::failure::CliFailure;

/// Names of the counts at a node.
const COUNTS: [&str; 5] = ["slaves", "masters", "prescribed", "redundant", "conflicting"];

type VtuCounts = [i32; COUNTS.len()];

/// Renders the file with the slaves of `reduction`, or of a new one.
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
    let mut bytes = Vec::new();
    let written = grid(&shown).write_xml(&mut bytes);
    written.map_err(|error| CliFailure::Resource(format!("the VTK file cannot be made: {error}")))?;
    Ok(bytes)
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

fn grid(shown: &[(u32, [f64; 3], VtuCounts)]) -> Vtk {
    let scalars =
        |name: &str, values: Vec<i32>| Attribute::DataArray(DataArrayBase::scalars(name, 1).with_data(values));
    let mut point = vec![scalars("node", shown.iter().map(|(node, ..)| *node as i32).collect())];
    point.extend((0..COUNTS.len()).map(|k| scalars(COUNTS[k], shown.iter().map(|(.., counts)| counts[k]).collect())));
    let count = shown.len() as u64;
    Vtk {
        version: Version::Auto,
        title: String::new(),
        byte_order: ByteOrder::LittleEndian,
        file_path: None,
        data: DataSet::inline(UnstructuredGridPiece {
            points: IOBuffer::F64(shown.iter().flat_map(|(_, position, _)| *position).collect()),
            cells: Cells {
                cell_verts: VertexNumbers::XML { connectivity: (0..count).collect(), offsets: (1..=count).collect() },
                types: vec![CellType::Vertex; shown.len()],
            },
            data: Attributes { point, cell: Vec::new() },
        }),
    }
}
