//! Nodes and meshes tied to faces and lines.

use super::super::canvas::{At, BLUE, ORANGE, Picture};

pub fn all() -> Vec<Picture> {
    vec![node_tie(), line_tie(), mortar_tie(), hanging_node(), order_tie(), face_order_tie()]
}

/// A quadrilateral, in perspective.
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

fn line_tie() -> Picture {
    let lower = [[45.0, 125.0], [120.0, 105.0], [210.0, 110.0], [280.0, 90.0]];
    let upper = [[60.0, 85.0], [110.0, 70.0], [160.0, 68.0], [215.0, 70.0], [265.0, 55.0]];
    let feet = [[69.0, 118.6], [120.0, 105.0], [158.0, 107.1], [215.0, 108.6], [276.0, 91.1]];
    let p = Picture::new("line_tie", "Each node of a line tied to the nearest segment of another").bar(&lower, BLUE);
    let p = upper.iter().zip(&feet).fold(p.line(&upper), |p, (&a, &b)| p.dashed(&[a, b]));
    nodes(nodes(p, &lower, BLUE), &upper, ORANGE).label([289.0, 36.0], "slave").label([245.0, 130.0], "master")
}

fn mortar_tie() -> Picture {
    let lower: [At; 4] = [[40.0, 120.0], [110.0, 120.0], [205.0, 120.0], [280.0, 120.0]];
    let upper: [At; 3] = [[40.0, 100.0], [165.0, 100.0], [280.0, 100.0]];
    let p = Picture::new("mortar_tie", "Two meshes of a line tied in the mean").bar(&lower, BLUE).bar(&upper, ORANGE);
    let p = p.line(&[upper[0], [165.0, 50.0], upper[2]]).line(&[lower[0], [110.0, 150.0], lower[2]]);
    let p = [110.0, 165.0, 205.0].iter().fold(p, |p, &x| p.dashed(&[[x, 90.0], [x, 130.0]]));
    nodes(nodes(p, &lower, BLUE), &upper, ORANGE).label([165.0, 35.0], "N_i").label([175.0, 153.0], "N_k")
}

fn hanging_node() -> Picture {
    let (hang, ends) = ([160.0, 85.0], [[160.0, 25.0], [160.0, 145.0]]);
    let p = Picture::new("hanging_node", "A node in the middle of the edge of a larger element")
        .area(&[[50.0, 25.0], ends[0], ends[1], [50.0, 145.0]], BLUE)
        .area(&[ends[0], [225.0, 25.0], [225.0, 85.0], hang], ORANGE)
        .area(&[hang, [225.0, 85.0], [225.0, 145.0], ends[1]], ORANGE);
    nodes(p, &ends, BLUE)
        .node(hang, ORANGE)
        .label([140.0, 85.0], "u_h")
        .label([140.0, 40.0], "u_1")
        .label([140.0, 130.0], "u_2")
        .label([265.0, 85.0], "refined")
}

fn order_tie() -> Picture {
    let at = |t: f64| [50.0 + 220.0 * t, 120.0 - 280.0 * t * (1.0 - t)];
    let curve: Vec<At> = (0..=30).map(|k| at(f64::from(k) / 30.0)).collect();
    let p = Picture::new("order_tie", "An edge of degree three that moves as one of degree two").bar(&curve, BLUE);
    let p = p.line(&[[50.0, 140.0], [270.0, 140.0]]);
    let p = [1.0 / 3.0, 2.0 / 3.0].into_iter().fold(p, |p, t| p.node(at(t), ORANGE));
    nodes(p, &[at(0.0), at(0.5), at(1.0)], BLUE)
        .label([160.0, 72.0], "u_k")
        .label([98.0, 42.0], "u_i")
        .label([283.0, 140.0], "s")
}

/// The additional nodes of the finer face lie on the surface of the coarser face.
fn face_order_tie() -> Picture {
    let p = Picture::new("face_order_tie", "A face with nine nodes that moves as one with four").area(&FACE, BLUE);
    let [a, b, c, d] = FACE;
    let middle = |a: At, b: At| [f64::midpoint(a[0], b[0]), f64::midpoint(a[1], b[1])];
    let edges = [middle(a, b), middle(b, c), middle(c, d), middle(d, a)];
    let p = p.dashed(&[edges[0], edges[2]]).dashed(&[edges[1], edges[3]]);
    let p = nodes(nodes(p, &FACE, BLUE), &edges, ORANGE).node(middle(edges[0], edges[2]), ORANGE);
    p.label([40.0, 140.0], "u_k").label([135.0, 156.0], "u_i")
}
