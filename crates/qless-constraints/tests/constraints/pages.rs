//! Each type has a documentation page with the picture that the example draws, and the stated ranks are right.

use std::collections::BTreeMap;
use std::error::Error;
use std::f64::consts::FRAC_PI_2;
use std::fs::{read_dir, read_to_string};
use std::path::{Path, PathBuf};

use qless::{Options, analyse};
use qless_constraints::types::{
    Body, Cyclic, CyclicHarmonic, Cylindrical, Distance, Driven, Equal, FaceOrderTie, FaceSide, Fixed, FluidNormal,
    HangingNode, Line, LineTie, LinearEquation, MacroStrain, MortarTie, Multipliers, Node, NodeTie, OnLine, OnPlane,
    OnSphere, OrderTie, Parallel, Periodic, Perpendicular, Planar, Plane, Point, Polynomials, Prescribed, Prismatic,
    Revolute, RotationMotor, Shape, Spherical, Surface, TranslationMotor, Turn, Turning, Universal, Volume,
};
use qless_constraints::{ConstraintSet, SetBuilder};

#[path = "../../examples/pictures/canvas.rs"]
mod canvas;
#[path = "../../examples/pictures/drawings/mod.rs"]
mod drawings;

type Outcome = Result<(), Box<dyn Error>>;

const HEADINGS: [&str; 5] = ["# Equations", "# Degrees of freedom", "# Singular configurations", "# Units", "# Source"];
/// Types whose nodes may have any components; other tests check their ranks.
const ELSEWHERE: [&str; 6] =
    ["rigid_body", "small_rigid_body", "average", "beam_to_solid", "shell_to_solid", "fluid_wall"];

fn here(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn sources(folder: &Path) -> Result<Vec<String>, Box<dyn Error>> {
    let mut all = Vec::new();
    for entry in read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() { all.extend(sources(&path)?) } else { all.push(read_to_string(path)?) }
    }
    Ok(all)
}

/// `OnLine` is `on_line`.
fn file_name(of: &str) -> String {
    let lower = |(k, letter): (usize, char)| {
        let before = if k > 0 && letter.is_uppercase() { "_" } else { "" };
        format!("{before}{}", letter.to_lowercase())
    };
    of.char_indices().map(lower).collect()
}

/// The page files, and the sources of the types.
fn types() -> Result<BTreeMap<String, String>, Box<dyn Error>> {
    let mut all = BTreeMap::new();
    for source in sources(&here("src/types"))? {
        for line in source.lines().filter(|line| line.starts_with("impl")) {
            if let Some((_, rest)) = line.split_once(" Constraint for ") {
                let name: String = rest.chars().take_while(|letter| letter.is_alphanumeric()).collect();
                all.insert(file_name(&name), source.clone());
            }
        }
    }
    Ok(all)
}

#[test]
fn every_type_has_a_page_with_all_headings() -> Outcome {
    let types = types()?;
    assert!(types.len() >= 33, "{:?}", types.keys());
    for (name, source) in &types {
        let [picture, page] = [format!("docs/pictures/{name}.svg"), format!("docs/types/{name}.md")];
        assert!(here(&picture).exists() && here(&page).exists(), "there is no {picture}, or no {page}");
        // An empty line ends the picture, or what follows is no heading.
        let lines: Vec<&str> = source.lines().collect();
        let includes = |line: &str, file: &str| line.starts_with("#[doc") && line.contains(file);
        let both = |three: &[&str]| includes(three[0], &picture) && three[1] == "///" && includes(three[2], &page);
        assert!(lines.windows(3).any(both), "{name}: its documentation does not include {picture} and {page}");
        let page = read_to_string(here(&page))?;
        let found: Vec<&str> = page.lines().filter(|line| line.starts_with('#')).collect();
        assert_eq!(found, HEADINGS, "{name}");
        let empty = |pair: &[&str]| pair[0].starts_with('#') && pair[1].starts_with('#');
        let lines: Vec<&str> = page.lines().filter(|line| !line.is_empty()).collect();
        assert!(!lines.windows(2).any(empty), "{name}: nothing stands below a heading");
    }
    Ok(())
}

/// `cargo run -p qless-constraints --example pictures` regenerates them.
#[test]
fn pictures_are_those_that_the_example_draws() -> Outcome {
    let mut drawn: Vec<String> = Vec::new();
    for picture in drawings::all() {
        let file = format!("{}.svg", picture.name);
        assert_eq!(read_to_string(here("docs/pictures").join(&file))?, picture.svg(), "{file}");
        assert!(!picture.svg().contains("\n\n"), "{file}: an empty line ends the picture on a page");
        drawn.push(file);
    }
    let mut there: Vec<String> = Vec::new();
    for file in read_dir(here("docs/pictures"))? {
        there.push(file?.file_name().to_string_lossy().into_owned());
    }
    there.sort();
    drawn.sort();
    assert_eq!(there, drawn);
    Ok(())
}

/// A body or node at the DOFs `6 i ..`.
fn body(i: usize) -> Body {
    Body::with_vector(node(i).dofs, node(i).at, [6 * i + 3, 6 * i + 4, 6 * i + 5])
}

const PLACES: [[f64; 3]; 5] = [[0.1, 0.2, 0.0], [1.3, 0.4, 0.0], [0.3, 1.7, 0.0], [0.4, 0.6, 1.1], [-1.0, 0.5, 0.0]];

fn node(i: usize) -> Point {
    Point::new([6 * i, 6 * i + 1, 6 * i + 2], PLACES[i])
}

/// A node in D dimensions on the line from 0 to 2.
fn on_axis<const D: usize>(i: usize, x: f64) -> Node<D> {
    Node::new(std::array::from_fn(|k| 6 * i + k), std::array::from_fn(|k| if k == 0 { x } else { 0.0 }))
}

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// Adds an example of a joint, planar if its page has a planar row; returns whether the name is known.
fn add_joint(builder: &mut SetBuilder, name: &str, plane: bool) -> Result<bool, Box<dyn Error>> {
    let (a, b, at, in_it) = (body(0), body(1), [0.7, 0.3, 0.0], [0.6, 0.8, 0.0]);
    let axis = if plane { Z } else { in_it };
    match name {
        "fixed" => _ = builder.add("", Fixed { a, b, at })?,
        "revolute" => _ = builder.add("", Revolute { a, b, at, axis })?,
        "prismatic" => _ = builder.add("", Prismatic { a, b, at, axis: in_it })?,
        "cylindrical" => _ = builder.add("", Cylindrical { a, b, at, axis: in_it })?,
        "planar" => _ = builder.add("", Planar { a, b, at, normal: in_it })?,
        "parallel" => _ = builder.add("", Parallel { a, b, axis: in_it })?,
        "perpendicular" => _ = builder.add("", Perpendicular { a, b, axis_a: X, axis_b: Y })?,
        "spherical" => _ = builder.add("", Spherical { a, b, at })?,
        "universal" => _ = builder.add("", Universal { a, b, at, axis_a: X, axis_b: Z })?,
        "rotation_motor" => _ = builder.add("", RotationMotor::new(a, b, axis, |_| 0.1))?,
        "translation_motor" => _ = builder.add("", TranslationMotor::new(a, b, at, in_it, |_| 0.1))?,
        _ => return Ok(false),
    }
    Ok(true)
}

/// The same for types of nodes in space, and of single DOFs.
fn add_nodes(builder: &mut SetBuilder, name: &str) -> Result<bool, Box<dyn Error>> {
    let (point, through, in_it) = (node(1), [0.0; 3], [0.6, 0.8, 0.0]);
    let image = Point { at: [-0.2, 0.1, 0.0], ..node(1) };
    let turn = Turn::about([0.0; 3], Z, FRAC_PI_2)?;
    let sector = Cyclic { a: node(0), b: image, turn, fields: Turning::Vectors, tolerance: 1e-9 };
    let [imaginary_a, imaginary_b] = [node(2).dofs, node(3).dofs];
    match name {
        "distance" => _ = builder.add("", Distance::new(node(0), node(1)))?,
        "on_sphere" => _ = builder.add("", OnSphere { point, centre: [0.0; 3], radius: None })?,
        "on_line" => _ = builder.add("", OnLine { point, line: Line::Fixed { through, direction: in_it } })?,
        "on_plane" => _ = builder.add("", OnPlane { point, plane: Plane::Fixed { through, normal: in_it } })?,
        "volume" => {
            let nodes = (0..4).map(node).collect();
            builder.add("", Volume { nodes, tetrahedra: vec![[0, 1, 2, 3]] })?;
        }
        "cyclic" => _ = builder.add("", sector)?,
        "cyclic_harmonic" => {
            builder.add("", CyclicHarmonic { real: sector, imaginary_a, imaginary_b, harmonic: 2 })?;
        }
        "fluid_normal" => {
            builder.add("", FluidNormal { structure: node(0).dofs, fluid: node(1).dofs, normal: in_it })?;
        }
        "linear_equation" => _ = builder.add("", LinearEquation { terms: vec![(0, 1.0), (7, 2.0)], rhs: 1.0 })?,
        "prescribed" => _ = builder.add("", Prescribed::fixed([0]))?,
        "driven" => _ = builder.add("", Driven::new([(0, 1.0)], |t| t))?,
        "equal" => _ = builder.add("", Equal::new([0, 7]))?,
        _ => return Ok(false),
    }
    Ok(true)
}

/// The same for ties of nodes in D dimensions.
fn add_ties<const D: usize>(builder: &mut SetBuilder, name: &str) -> Result<bool, Box<dyn Error>> {
    let (slave, ends) = (on_axis::<D>(0, 0.5), [on_axis::<D>(1, 0.0), on_axis::<D>(2, 2.0)]);
    let parent: Vec<_> = ends.iter().map(|end| end.dofs).collect();
    match name {
        "node_tie" => {
            let face = ends.to_vec();
            builder.add("", NodeTie { node: slave, shape: Shape::Line2, face, tolerance: 1e-9 })?;
        }
        "line_tie" => _ = builder.add("", LineTie { slave: vec![slave], master: ends.to_vec(), tolerance: 1e-9 })?,
        "hanging_node" => {
            builder.add("", HangingNode { node: slave.dofs, shape: Shape::Line2, parent, at: [0.0, 0.0] })?;
        }
        "order_tie" => {
            let coarse = vec![(0.0, parent[0]), (2.0, parent[1])];
            builder.add("", OrderTie { fine: vec![coarse[0], (0.5, slave.dofs), coarse[1]], coarse })?;
        }
        // Two corners are shared, the third is not.
        "face_order_tie" => {
            let own = |i: usize| std::array::from_fn(|k| 6 * i + k);
            let side = |third: usize| {
                let nodes = vec![([0.0, 0.0], own(1)), ([1.0, 0.0], own(2)), ([0.0, 1.0], own(third))];
                FaceSide { polynomials: Polynomials::Triangle(1), nodes }
            };
            builder.add("", FaceOrderTie::<D> { fine: side(0), coarse: side(3) })?;
        }
        "periodic" => {
            let strain = MacroStrain::Given([[0.0; D]; D]);
            builder.add("", Periodic { a: slave, b: ends[1], strain })?;
        }
        // There are two slave nodes; the table counts one.
        "mortar_tie" => {
            let slave = Surface::polyline(vec![on_axis::<D>(3, 0.0), on_axis::<D>(4, 2.0)]);
            let (master, multipliers) = (Surface::polyline(ends.to_vec()), Multipliers::Dual);
            builder.add("", MortarTie { slave, master, multipliers, tolerance: 1e-9 })?;
        }
        _ => return Ok(false),
    }
    Ok(true)
}

fn rank_of(builder: SetBuilder) -> Result<(usize, usize), Box<dyn Error>> {
    let set = builder.build()?;
    let mut evaluation = set.allocate();
    set.evaluate(&vec![0.0; set.dofs()], &mut evaluation)?;
    Ok((set.equations(), analyse(&set.linearised(&evaluation, &[])?, &Options::default())?.rank()))
}

/// Equations and removed DOFs; none for a type without an example here.
fn removed(name: &str, plane: bool) -> Result<Option<(usize, usize)>, Box<dyn Error>> {
    let held = || -> Result<SetBuilder, Box<dyn Error>> {
        let mut builder = ConstraintSet::builder(30);
        let out_of_plane = (0..30).filter(|dof| plane && matches!(dof % 6, 2..5));
        let out_of_plane: Vec<usize> = out_of_plane.collect();
        if plane {
            builder.add("plane", Prescribed::fixed(out_of_plane))?;
        }
        Ok(builder)
    };
    let mut builder = held()?;
    let is_tie = if plane { add_ties::<2>(&mut builder, name)? } else { add_ties::<3>(&mut builder, name)? };
    let known = is_tie || add_joint(&mut builder, name, plane)? || add_nodes(&mut builder, name)?;
    let ((equations, rank), (before, rank_before)) = (rank_of(builder)?, rank_of(held()?)?);
    let nodes = if name == "mortar_tie" { 2 } else { 1 };
    Ok(known.then_some(((equations - before) / nodes, (rank - rank_before) / nodes)))
}

/// `| in space | 6 | 6 |`.
fn stated(page: &str, place: &str) -> Option<(usize, usize)> {
    let line = page.lines().find(|line| line.starts_with(&format!("| {place} |")))?;
    let mut numbers = line.split('|').filter_map(|cell| cell.trim().parse().ok());
    Some((numbers.next()?, numbers.next()?))
}

#[test]
fn ranks_are_those_that_pages_state() -> Outcome {
    for name in types()?.into_keys() {
        let page = read_to_string(here(&format!("docs/types/{name}.md")))?;
        if ELSEWHERE.contains(&name.as_str()) {
            continue;
        }
        let space = removed(&name, false)?.ok_or(format!("{name}: no example of it stands in this file"))?;
        assert_eq!(stated(&page, "in space"), Some(space), "{name} in space");
        // Volume has no meaning in the plane.
        if name != "volume" {
            assert_eq!(stated(&page, "in the plane"), removed(&name, true)?, "{name} in the plane");
        }
    }
    Ok(())
}
