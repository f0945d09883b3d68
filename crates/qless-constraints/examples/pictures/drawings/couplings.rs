//! Beams and shells joined to solids; fluids at walls.

use super::super::canvas::{At, BLUE, ORANGE, Picture};

pub fn all() -> Vec<Picture> {
    vec![beam_to_solid(), shell_to_solid(), fluid_wall()]
}

/// Adds a block of solid elements, whose right side is at `x`.
fn block(picture: Picture, x: f64, rows: u32) -> Picture {
    let (left, height) = (x - 90.0, 110.0 / f64::from(rows));
    let grid = (0..rows).fold(picture, |p, k| {
        let (top, bottom) = (30.0 + height * f64::from(k), 30.0 + height * f64::from(k + 1));
        p.area(&[[left, top], [x, top], [x, bottom], [left, bottom]], BLUE)
    });
    grid.line(&[[x - 45.0, 30.0], [x - 45.0, 140.0]])
}

/// Nodes of the right side.
fn side(x: f64, rows: u32) -> Vec<At> {
    (0..=rows).map(|k| [x, 30.0 + 110.0 * f64::from(k) / f64::from(rows)]).collect()
}

fn beam_to_solid() -> Picture {
    let p = block(Picture::new("beam_to_solid", "The end of a beam joined to a face of a solid"), 140.0, 4);
    let p = p.bar(&[[140.0, 85.0], [290.0, 85.0]], ORANGE).dashed(&[[150.0, 20.0], [150.0, 150.0]]);
    let p = side(140.0, 4).into_iter().fold(p, |p, at| p.node(at, BLUE));
    p.node([160.0, 85.0], ORANGE)
        .node([290.0, 85.0], ORANGE)
        .turn([160.0, 85.0], 24.0, 50.0, -40.0)
        .label([175.0, 118.0], "u_r , θ")
        .label([122.0, 44.0], "u_i")
}

fn shell_to_solid() -> Picture {
    let p = block(Picture::new("shell_to_solid", "The edge of a shell joined to the side of a solid"), 140.0, 2);
    let p = p.area(&[[142.0, 88.0], [230.0, 88.0], [290.0, 45.0], [202.0, 45.0]], ORANGE);
    let p = p.bar(&[[150.0, 30.0], [150.0, 140.0]], "currentColor");
    let p = side(140.0, 2).into_iter().fold(p, |p, at| p.node(at, BLUE));
    p.node([160.0, 88.0], ORANGE)
        .label([182.0, 110.0], "u_s , θ")
        .label([122.0, 44.0], "u_i")
        .label([165.0, 138.0], "d")
}

fn fluid_wall() -> Picture {
    let p = block(Picture::new("fluid_wall", "Nodes of a fluid at a wall whose mesh does not match"), 140.0, 2);
    let p = side(140.0, 2).into_iter().fold(p, |p, at| p.node(at, BLUE));
    let fluid: Vec<At> = side(152.0, 3);
    let p = p.line(&fluid);
    let p = fluid.iter().fold(p, |p, &[x, y]| p.arrow([x + 5.0, y], [x + 40.0, y]).node([x, y], ORANGE));
    p.label([212.0, 103.0], "u_n").label([245.0, 50.0], "fluid").label([72.0, 58.0], "wall")
}
