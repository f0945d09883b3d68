use faer::Mat;
use qless_scenes::families::{Degree, Mortar, Side, mortar_short};
use qless_scenes::oracle::singular_values;
use qless_scenes::{Component, Scene, SceneError};

use crate::support::{assert_satisfied, assert_truth, assert_truth_and_generated};

const DEGREES: [Degree; 2] = [Degree::Linear, Degree::Quadratic];
/// Numbers of master elements for 12 slave elements: ratios from 1/12 to 10.
const MASTERS: [usize; 6] = [1, 4, 11, 12, 36, 120];

/// A tie of a line for every pair of degrees, ratio and kind of mesh.
fn lines() -> Result<Vec<Mortar>, SceneError> {
    let mut lines = Vec::new();
    for (slave, master) in DEGREES.into_iter().flat_map(|slave| DEGREES.map(|master| (slave, master))) {
        for (seed, masters) in (1..).zip(MASTERS) {
            lines.push(Mortar::line(Side::uniform(12, slave)?, Side::uniform(masters, master)?));
            lines.push(Mortar::line(Side::jittered(12, slave, seed)?, Side::jittered(masters, master, seed + 50)?));
        }
        lines.push(Mortar::line(Side::with_short_element(12, slave)?, Side::uniform(7, master)?));
    }
    Ok(lines)
}

/// A tie of a rectangle for every pair of degrees and ratio, with the inverse ratio along y, and 1 or 3 components.
fn faces() -> Result<Vec<Mortar>, SceneError> {
    let mut faces = Vec::new();
    for (slave, master) in DEGREES.into_iter().flat_map(|slave| DEGREES.map(|master| (slave, master))) {
        for (seed, (x, y)) in [(1, 10), (1, 3), (2, 2), (3, 1), (10, 1), (5, 4)].into_iter().enumerate() {
            let sides = |n: [usize; 2], degree: Degree| -> Result<[Side; 2], SceneError> {
                Ok([Side::uniform(n[0], degree)?, Side::jittered(n[1], degree, seed as u64)?])
            };
            let face = Mortar::face(sides([3, 2], slave)?, sides([x, y], master)?);
            faces.push(face.clone());
            faces.push(Mortar { components: 3, skew: seed % 2 == 0, ..face });
        }
    }
    Ok(faces)
}

#[test]
fn every_equation_of_a_tie_is_independent() -> Result<(), SceneError> {
    for line in lines()? {
        assert_truth(&line.scene(1)?, "line");
        for skew in [false, true] {
            assert_truth(&Mortar { components: 2, skew, ..line.clone() }.scene(1)?, "line with two components");
        }
    }
    for face in faces()? {
        assert_truth(&face.scene(1)?, "face");
    }
    let small = Mortar::line(Side::uniform(2, Degree::Quadratic)?, Side::uniform(3, Degree::Linear)?);
    assert_truth_and_generated(&Mortar { components: 3, skew: true, ..small }.scene(1)?, "small line");
    Ok(())
}

/// Displacements that both sides can represent: of degree 1 in x and in y.
fn field(scene: &Scene) -> Vec<f64> {
    let value = |[x, y, _]: [f64; 3], c: Component| match c {
        Component::X => 1.0 + x - 0.5 * y,
        Component::Y => 0.5 - x + 0.25 * y + x * y,
        _ => 1.0,
    };
    scene.dofs.iter().map(|dof| value(scene.nodes[dof.node], dof.component)).collect()
}

/// The patch test: `D 1 = M 1`, and the same for linear fields.
#[test]
fn ties_pass_constant_and_linear_fields() -> Result<(), SceneError> {
    for tie in [lines()?, faces()?].concat() {
        let scene = tie.scene(1)?;
        assert_satisfied(&scene.system, &vec![1.0; scene.system.dofs()]);
        assert_satisfied(&scene.system, &field(&scene));
    }
    Ok(())
}

/// Linear master elements cannot represent quadratic fields; this shows that the test can fail.
#[test]
fn quadratic_sides_pass_parabolas() -> Result<(), SceneError> {
    let parabola = |scene: &Scene| -> Vec<f64> { scene.nodes.iter().map(|[x, ..]| x * x - 0.3 * x).collect() };
    let (slave, master) = (Side::jittered(9, Degree::Quadratic, 1)?, Side::jittered(5, Degree::Quadratic, 2)?);
    let scene = Mortar::line(slave.clone(), master).scene(0)?;
    assert_satisfied(&scene.system, &parabola(&scene));
    let linear = Mortar::line(slave, Side::uniform(5, Degree::Linear)?).scene(0)?;
    let rest = linear.system.matrix().times(&parabola(&linear)).expect("a number for each DOF");
    assert!(rest.iter().any(|r| r.abs() > 1e-4));
    Ok(())
}

/// D: the slave columns of a tie with one component.
#[test]
fn the_slave_block_is_symmetric_and_positive_definite() -> Result<(), SceneError> {
    for line in lines()? {
        let system = line.scene(1)?.system;
        let m = system.equations();
        let mut d = Mat::<f64>::zeros(m, m);
        for i in 0..m {
            system.matrix().row(i).filter(|&(j, _)| j < m).for_each(|(j, v)| d[(i, j)] = v);
        }
        let largest = (0..m).fold(0.0, |a: f64, i| a.max(d[(i, i)]));
        assert!((0..m).all(|i| (0..i).all(|j| (d[(i, j)] - d[(j, i)]).abs() <= 1e-16 * largest)));
        let values = d.self_adjoint_eigenvalues(faer::Side::Lower).expect("finite numbers");
        assert!(values[0] > 1e-3 * values[m - 1], "{values:?}");
    }
    Ok(())
}

/// The smallest singular value of rows of equal size does not change from 20 to 320 elements.
#[test]
fn ties_are_as_well_conditioned_at_every_size() -> Result<(), SceneError> {
    let least = |n: usize| -> Result<f64, SceneError> {
        let values = singular_values(&mortar_short(n)?.system).expect("within reach");
        Ok(values[values.len() - 1] / values[0])
    };
    for n in [20, 80, 320] {
        assert!((0.1..0.2).contains(&least(n)?), "{n}: {}", least(n)?);
    }
    Ok(())
}

#[test]
fn a_short_element_behind_the_middle() -> Result<(), SceneError> {
    for n in [1, 2, 3, 10, 400] {
        let scene = mortar_short(n)?;
        assert_eq!((scene.system.equations(), scene.system.dofs()), (n + 2, n + 2 + n / 2 + 2));
        assert_truth(&scene, "short element");
        let x: Vec<f64> = scene.nodes[..n + 2].iter().map(|node| node[0]).collect();
        let short = (x[n / 2 + 1] - x[n / 2]) * n as f64;
        assert!((short - 0.1).abs() < 1e-12 && (n % 2 == 1 || x[n / 2] == 0.5), "{short}");
    }
    Ok(())
}

/// Time and memory are linear in the number of nodes, so 1e5 elements take little time.
#[test]
fn large_ties_are_linear_in_the_nodes() -> Result<(), SceneError> {
    let scene = mortar_short(100_000)?;
    assert!(scene.system.matrix().nnz() < 7 * scene.system.equations());
    assert_satisfied(&scene.system, &field(&scene));
    Ok(())
}

#[test]
fn sums_are_redundant() -> Result<(), SceneError> {
    let line = Mortar::line(Side::jittered(40, Degree::Quadratic, 1)?, Side::uniform(30, Degree::Linear)?);
    let sides = [Side::uniform(6, Degree::Linear)?, Side::uniform(5, Degree::Linear)?];
    let face = Mortar { components: 3, ..Mortar::face(sides.clone(), sides) };
    for tie in [line.clone(), Mortar { components: 2, skew: true, ..line }, face] {
        for seed in 0..3 {
            let scene = Mortar { sums: 15, ..tie.clone() }.scene(seed)?;
            assert_eq!(scene.truth.redundant, Some(15));
            assert_truth(&scene, "sums");
        }
    }
    Ok(())
}

/// If all rows share DOFs the sums are rounded. Singular values show that they are dependent up to rounding.
#[test]
fn sums_of_rows_that_overlap_are_redundant_to_rounding() -> Result<(), SceneError> {
    let line = Mortar::line(Side::uniform(4, Degree::Linear)?, Side::uniform(1, Degree::Quadratic)?);
    let scene = Mortar { sums: 3, ..line }.scene(1)?;
    let values = singular_values(&scene.system).expect("within reach");
    assert!(values[4] > 0.1 * values[0] && values[5] < 1e-15 * values[0], "{values:?}");
    assert_eq!(scene.truth.rank_free, Some(5));
    Ok(())
}

#[test]
fn meshes_that_make_no_tie_are_refused_by_name() -> Result<(), SceneError> {
    let mesh = |ends: &[f64]| Side::new(ends.to_vec(), Degree::Linear).expect_err("refused").to_string();
    for ends in [&[0.5, 1.0][..], &[0.0, 0.5], &[0.0, 0.5, 0.5, 1.0], &[0.0, f64::NAN, 1.0], &[0.0, 1e-12, 1.0]] {
        assert!(mesh(ends).contains("ends must ascend from 0 to 1"), "{ends:?}: {}", mesh(ends));
    }
    assert!(mesh(&[0.0]).contains("ends of elements is 1; it must be from 2"));
    assert!(mortar_short(0).is_err());
    let side = || Side::uniform(2, Degree::Linear);
    let tie = Mortar { components: 4, ..Mortar::line(side()?, side()?) };
    assert!(tie.scene(0).expect_err("refused").to_string().contains("components is 4"));
    Ok(())
}
