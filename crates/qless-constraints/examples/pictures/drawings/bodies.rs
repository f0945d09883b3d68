//! Rigid bodies: nodes that follow a body; and a node that follows others.

use super::super::canvas::{At, BLUE, ORANGE, Picture};

pub fn all() -> Vec<Picture> {
    vec![rigid_body(), small_rigid_body(), average()]
}

fn star(picture: Picture, centre: At, ends: &[At]) -> Picture {
    ends.iter().fold(picture, |p, &end| p.bar(&[centre, end], BLUE).node(end, ORANGE)).node(centre, BLUE)
}

fn rigid_body() -> Picture {
    let before = Picture::new("rigid_body", "Nodes that follow a body through a large turn");
    let before = before.dashed(&[[70.0, 120.0], [140.0, 120.0]]).dashed(&[[70.0, 120.0], [105.0, 65.0]]);
    star(before, [200.0, 100.0], &[[200.0, 30.0], [145.0, 65.0]])
        .turn([200.0, 100.0], 45.0, 0.0, -75.0)
        .ring([70.0, 120.0], 3.0)
        .arrow([77.0, 119.0], [190.0, 102.0])
        .dashed(&[[200.0, 100.0], [270.0, 100.0]])
        .label([213.0, 117.0], "x_r")
        .label([218.0, 25.0], "x_i")
        .label([252.0, 68.0], "R")
        .label([62.0, 140.0], "X_r")
        .label([150.0, 135.0], "X_i")
}

fn small_rigid_body() -> Picture {
    let (r, ends) = ([90.0, 105.0], [[230.0, 105.0], [160.0, 45.0]]);
    star(Picture::new("small_rigid_body", "Nodes that follow a reference node by a small turn"), r, &ends)
        .turn(r, 25.0, 100.0, 290.0)
        .arrow(ends[0], [230.0, 62.0])
        .label([48.0, 105.0], "θ")
        .label([112.0, 122.0], "u_r")
        .label([250.0, 75.0], "u_i")
        .label([180.0, 122.0], "X_i − X_r")
}

fn average() -> Picture {
    let leaders = [[60.0, 130.0], [245.0, 140.0], [270.0, 50.0], [95.0, 35.0]];
    let r = [165.0, 88.0];
    let p = Picture::new("average", "A reference node that follows the weighted average of others");
    let p = leaders.iter().fold(p, |p, &end| p.dashed(&[end, r]).node(end, BLUE));
    p.node(r, ORANGE)
        .label([162.0, 110.0], "u_r")
        .label([38.0, 128.0], "w_1")
        .label([270.0, 142.0], "w_2")
        .label([294.0, 47.0], "w_3")
        .label([72.0, 32.0], "w_4")
}
