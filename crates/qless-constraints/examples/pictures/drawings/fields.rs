//! Equations on DOFs: prescribed and equal values, sums, periodic and cyclic symmetry.

use super::super::canvas::{At, BLUE, ORANGE, Picture, add, arc, polar};

pub fn all() -> Vec<Picture> {
    vec![linear(), prescribed(), driven(), equal(), periodic(), cyclic(), cyclic_harmonic(), fluid_normal()]
}

fn linear() -> Picture {
    Picture::new("linear_equation", "A lever: one displacement is a multiple of another")
        .bar(&[[60.0, 95.0], [260.0, 95.0]], BLUE)
        .area(&[[120.0, 97.0], [108.0, 120.0], [132.0, 120.0]], ORANGE)
        .ground([120.0, 120.0], 60.0)
        .arrow([60.0, 95.0], [60.0, 130.0])
        .arrow([260.0, 95.0], [260.0, 25.0])
        .node([60.0, 95.0], BLUE)
        .node([260.0, 95.0], BLUE)
        .label([42.0, 118.0], "u_1")
        .label([280.0, 45.0], "u_2")
        .label([170.0, 45.0], "a_1 u_1 + a_2 u_2 = b")
}

fn prescribed() -> Picture {
    Picture::new("prescribed", "A fixed node, and one with a given displacement")
        .area(&[[90.0, 70.0], [78.0, 95.0], [102.0, 95.0]], BLUE)
        .ground([90.0, 95.0], 60.0)
        .node([90.0, 70.0], BLUE)
        .label([90.0, 45.0], "u = 0")
        .dashed(&[[200.0, 110.0], [200.0, 40.0]])
        .dashed(&[[260.0, 110.0], [260.0, 40.0]])
        .node([200.0, 70.0], ORANGE)
        .arrow([207.0, 70.0], [260.0, 70.0])
        .label([230.0, 50.0], "u = v")
}

fn driven() -> Picture {
    let at = |t: f64| [60.0 + 190.0 * t, 90.0 - 45.0 * (7.0 * t).sin()];
    let curve: Vec<At> = (0..=60).map(|k| at(f64::from(k) / 60.0)).collect();
    Picture::new("driven", "A displacement that follows a function of time")
        .arrow([60.0, 90.0], [285.0, 90.0])
        .arrow([60.0, 150.0], [60.0, 20.0])
        .bar(&curve, BLUE)
        .dashed(&[[at(0.7)[0], 90.0], at(0.7)])
        .node(at(0.7), ORANGE)
        .label([299.0, 90.0], "t")
        .label([88.0, 22.0], "b(t)")
}

fn equal() -> Picture {
    let step = |p: Picture, k: u32| {
        let x = 70.0 + 80.0 * f64::from(k);
        let colour = if k == 0 { BLUE } else { ORANGE };
        p.arrow([x, 105.0], [x, 50.0]).node([x, 105.0], colour).label([x, 130.0], &format!("u_{k}"))
    };
    let lines = Picture::new("equal", "Nodes that move alike").dashed(&[[40.0, 50.0], [260.0, 50.0]]);
    (0..3).fold(lines, step)
}

fn periodic() -> Picture {
    let (a, b) = ([90.0, 95.0], [230.0, 75.0]);
    let side = |x: f64, y: f64| -> Vec<At> {
        (0..=12).map(|k| [x + 6.0 * (f64::from(k) * 0.52).sin(), y + 8.0 * f64::from(k)]).collect()
    };
    Picture::new("periodic", "A node and its image on the opposite face of a cell")
        .dashed(&[[90.0, 38.0], [230.0, 38.0], [230.0, 134.0], [90.0, 134.0], [90.0, 38.0]])
        .bar(&side(90.0, 42.0), BLUE)
        .bar(&side(230.0, 22.0), ORANGE)
        .line(&[[90.0, 42.0], [230.0, 22.0]])
        .line(&[[90.0, 138.0], [230.0, 118.0]])
        .arrow(a, b)
        .node(a, BLUE)
        .node(b, ORANGE)
        .label([70.0, 95.0], "a")
        .label([252.0, 75.0], "b")
        .label([155.0, 68.0], "X_b − X_a")
}

/// A sector of a disk.
fn sector(picture: Picture, centre: At, from: f64, to: f64, colour: &str) -> Picture {
    let mut edge = arc(centre, 120.0, from, to);
    edge.extend(arc(centre, 35.0, to, from));
    picture.area(&edge, colour)
}

fn cyclic() -> Picture {
    let centre = [130.0, 150.0];
    let [a, b] = [-20.0, -65.0].map(|angle| add(centre, polar(80.0, angle)));
    let p = sector(Picture::new("cyclic", "A node and its image one sector further"), centre, -42.0, 3.0, BLUE);
    sector(p, centre, -87.0, -42.0, ORANGE)
        .dashed(&[centre, a])
        .dashed(&[centre, b])
        .turn(centre, 55.0, -20.0, -56.0)
        .node(a, BLUE)
        .node(b, ORANGE)
        .ring(centre, 3.0)
        .label(add(a, [13.0, -5.0]), "a")
        .label(add(b, [10.0, -12.0]), "b")
        .label([194.0, 113.0], "α")
}

fn cyclic_harmonic() -> Picture {
    let (centre, waves) = ([160.0, 85.0], 3.0);
    let wave = |k: i32| {
        let angle = 3.0 * f64::from(k);
        add(centre, polar(55.0 + 12.0 * (waves * angle.to_radians()).cos(), angle))
    };
    let rays = |p: Picture, k: i32| p.dashed(&[centre, add(centre, polar(72.0, 30.0 * f64::from(k) + 15.0))]);
    let p = (0..12).fold(Picture::new("cyclic_harmonic", "Three waves around a disk of twelve sectors"), rays);
    p.line(&arc(centre, 55.0, 0.0, 360.0))
        .bar(&(0..=120).map(wave).collect::<Vec<_>>(), ORANGE)
        .label([265.0, 85.0], "k = 3")
}

fn fluid_normal() -> Picture {
    let ripple = |y: f64| -> Vec<At> {
        (0..=20).map(|k| [185.0 + 4.0 * f64::from(k), y + 4.0 * (f64::from(k) * 0.8).sin()]).collect()
    };
    Picture::new("fluid_normal", "A structure and a fluid with equal normal displacements")
        .area(&[[60.0, 25.0], [160.0, 25.0], [160.0, 145.0], [60.0, 145.0]], BLUE)
        .line(&ripple(35.0))
        .line(&ripple(135.0))
        .node([155.0, 85.0], BLUE)
        .node([165.0, 85.0], ORANGE)
        .arrow([172.0, 85.0], [230.0, 85.0])
        .both_ways([180.0, 60.0], [180.0, 110.0])
        .label([244.0, 85.0], "n")
        .label([110.0, 85.0], "structure")
        .label([225.0, 115.0], "fluid")
}
