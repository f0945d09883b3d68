//! Nodes at fixed distances, on lines, planes and spheres; volumes.

use super::super::canvas::{BLUE, ORANGE, Picture, add, arc, polar};

pub fn all() -> Vec<Picture> {
    vec![distance(), on_sphere(), on_line(), on_plane(), volume()]
}

fn distance() -> Picture {
    let (a, b) = ([70.0, 125.0], [250.0, 55.0]);
    Picture::new("distance", "Two nodes joined by a rod of length L")
        .bar(&[a, b], BLUE)
        .node(a, BLUE)
        .node(b, ORANGE)
        .label([52.0, 142.0], "x_a")
        .label([270.0, 40.0], "x_b")
        .label([150.0, 72.0], "L")
}

fn on_sphere() -> Picture {
    let (m, x) = ([160.0, 85.0], add([160.0, 85.0], polar(65.0, -35.0)));
    Picture::new("on_sphere", "A node on a sphere about a fixed centre")
        .line(&arc(m, 65.0, 0.0, 360.0))
        .dashed(&ellipse(m, 65.0, 18.0))
        .bar(&[m, x], BLUE)
        .ring(m, 3.0)
        .node(x, ORANGE)
        .label([145.0, 82.0], "m")
        .label([181.0, 53.0], "R")
        .label([230.0, 38.0], "x")
}

/// A circle in perspective.
fn ellipse(centre: [f64; 2], a: f64, b: f64) -> Vec<[f64; 2]> {
    arc([0.0; 2], 1.0, 0.0, 360.0).into_iter().map(|[x, y]| add(centre, [a * x, b * y])).collect()
}

fn on_line() -> Picture {
    let at = |t: f64| [60.0 + 200.0 * t, 130.0 - 80.0 * t];
    Picture::new("on_line", "A node that slides on the line through two others")
        .dashed(&[at(-0.2), at(1.2)])
        .bar(&[at(0.0), at(1.0)], BLUE)
        .node(at(0.0), BLUE)
        .node(at(1.0), BLUE)
        .node(at(0.55), ORANGE)
        .both_ways(add(at(0.35), [-6.0, -16.0]), add(at(0.75), [-6.0, -16.0]))
        .label(add(at(0.0), [8.0, 20.0]), "a")
        .label(add(at(1.0), [8.0, 20.0]), "b")
        .label(add(at(0.55), [10.0, 22.0]), "p")
}

fn on_plane() -> Picture {
    let (a, b, d) = ([60.0, 135.0], [215.0, 140.0], [105.0, 55.0]);
    let far = [b[0] + d[0] - a[0] + 20.0, b[1] + d[1] - a[1]];
    Picture::new("on_plane", "A node on the plane through three others")
        .area(&[[35.0, 150.0], [235.0, 156.0], far, [85.0, 40.0]], BLUE)
        .dashed(&[a, b, d, a])
        .node(a, BLUE)
        .node(b, BLUE)
        .node(d, BLUE)
        .arrow([180.0, 90.0], [180.0, 25.0])
        .node([180.0, 90.0], ORANGE)
        .label([76.0, 122.0], "a")
        .label([222.0, 124.0], "b")
        .label([121.0, 49.0], "d")
        .label([196.0, 95.0], "p")
        .label([194.0, 27.0], "n")
}

fn volume() -> Picture {
    let [a, b, c, d, e] = [[70.0, 130.0], [190.0, 145.0], [240.0, 85.0], [140.0, 30.0], [120.0, 88.0]];
    Picture::new("volume", "A patch of tetrahedra whose volume stays")
        .area(&[a, b, c, d], BLUE)
        .line(&[d, b])
        .dashed(&[a, e, c])
        .dashed(&[e, d])
        .node(a, BLUE)
        .node(b, BLUE)
        .node(c, BLUE)
        .node(d, BLUE)
        .label([125.0, 110.0], "V")
}
