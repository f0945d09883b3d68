//! Nodes and meshes tied to faces and lines.

use crate::canvas::{At, BLUE, ORANGE, Picture};

pub fn all() -> Vec<Picture> {
    vec![node_tie(), field_tie(), line_tie(), mortar_tie(), surface_mortar_tie()]
}

/// A face with four corners, seen at an angle.
const FACE: [At; 4] = [[55.0, 130.0], [215.0, 145.0], [265.0, 85.0], [110.0, 72.0]];

fn nodes(picture: Picture, all: &[At], colour: &str) -> Picture {
    all.iter().fold(picture, |p, &at| p.node(at, colour))
}

fn node_tie() -> Picture {
    let p = Picture::new("node_tie", "A node tied to the nearest point of a face").area(&FACE, BLUE);
    nodes(p, &FACE, BLUE)
        .dashed(&[[170.0, 45.0], [165.0, 105.0]])
        .ring([165.0, 105.0], 3.0)
        .node([170.0, 45.0], ORANGE)
        .label([187.0, 40.0], "p")
        .label([181.0, 110.0], "ξ")
        .label([40.0, 140.0], "1")
        .label([228.0, 153.0], "2")
        .label([279.0, 80.0], "3")
        .label([97.0, 62.0], "4")
}

fn field_tie() -> Picture {
    let p = Picture::new("field_tie", "A value at a node tied to those of a face").area(&FACE, BLUE);
    nodes(p, &FACE, BLUE)
        .dashed(&[[170.0, 45.0], [165.0, 105.0]])
        .ring([165.0, 105.0], 3.0)
        .node([170.0, 45.0], ORANGE)
        .label([189.0, 40.0], "T_p")
        .label([38.0, 140.0], "T_1")
        .label([230.0, 154.0], "T_2")
        .label([282.0, 80.0], "T_3")
        .label([95.0, 60.0], "T_4")
}

fn line_tie() -> Picture {
    let lower = [[45.0, 125.0], [120.0, 105.0], [210.0, 110.0], [280.0, 90.0]];
    let upper = [[60.0, 85.0], [110.0, 70.0], [160.0, 68.0], [215.0, 70.0], [265.0, 55.0]];
    let feet = [[69.0, 118.6], [120.0, 105.0], [158.0, 107.1], [215.0, 108.6], [276.0, 91.1]];
    let p = Picture::new("line_tie", "Each node of a line tied to the nearest segment of another").bar(&lower, BLUE);
    let p = upper.iter().zip(&feet).fold(p.line(&upper), |p, (&a, &b)| p.dashed(&[a, b]));
    nodes(nodes(p, &lower, BLUE), &upper, ORANGE).label([285.0, 45.0], "slave").label([245.0, 130.0], "master")
}

fn mortar_tie() -> Picture {
    let lower: [At; 4] = [[40.0, 120.0], [110.0, 120.0], [205.0, 120.0], [280.0, 120.0]];
    let upper: [At; 3] = [[40.0, 100.0], [165.0, 100.0], [280.0, 100.0]];
    let p = Picture::new("mortar_tie", "Two meshes of a line tied in the mean").bar(&lower, BLUE).bar(&upper, ORANGE);
    let p = p.line(&[upper[0], [165.0, 50.0], upper[2]]).line(&[lower[0], [110.0, 155.0], lower[2]]);
    let p = [110.0, 165.0, 205.0].iter().fold(p, |p, &x| p.dashed(&[[x, 90.0], [x, 130.0]]));
    nodes(nodes(p, &lower, BLUE), &upper, ORANGE).label([165.0, 35.0], "N_i").label([132.0, 158.0], "N_k")
}

fn surface_mortar_tie() -> Picture {
    let skew = |x: f64, y: f64| [60.0 + 170.0 * x + 45.0 * y, 145.0 - 110.0 * y];
    let grid = |p: Picture, t: f64| {
        let line = |p: Picture, ends: [At; 2]| p.line(&ends);
        line(line(p, [skew(t, 0.0), skew(t, 1.0)]), [skew(0.0, t), skew(1.0, t)])
    };
    let whole = [skew(0.0, 0.0), skew(1.0, 0.0), skew(1.0, 1.0), skew(0.0, 1.0)];
    let p = Picture::new("surface_mortar_tie", "Two meshes of a surface tied in the mean").area(&whole, BLUE);
    let p = [0.0, 0.5, 1.0].into_iter().fold(p, grid);
    let p = p.bar(&[skew(0.0, 0.0), skew(0.35, 0.4), skew(0.0, 1.0)], ORANGE);
    let p = p.bar(&[skew(1.0, 0.0), skew(0.35, 0.4), skew(1.0, 1.0)], ORANGE);
    let segment = [skew(0.5, 0.308), skew(0.35, 0.4), skew(0.438, 0.5), skew(0.5, 0.5)];
    let p = p.area(&segment, ORANGE);
    nodes(p, &[skew(0.35, 0.4)], ORANGE)
}
