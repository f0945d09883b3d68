//! Joints. Body a is blue, body b is orange.

use super::super::canvas::{At, BLUE, ORANGE, Picture, arc};

pub fn all() -> Vec<Picture> {
    let pairs = [fixed(), prismatic(), revolute(), spherical(), universal(), cylindrical(), planar()];
    pairs.into_iter().chain([parallel(), perpendicular(), rotation_motor(), translation_motor()]).collect()
}

/// Adds the names of both bodies.
fn named(picture: Picture, a: At, b: At) -> Picture {
    picture.label(a, "a").label(b, "b")
}

fn fixed() -> Picture {
    let p = Picture::new("fixed", "Two bodies that move as one");
    let p = p.body([105.0, 90.0], [110.0, 50.0], 0.0, BLUE).body([211.0, 74.0], [110.0, 50.0], -17.0, ORANGE);
    let seam = |p: Picture, k: u32| {
        let y = 64.0 + 13.0 * f64::from(k);
        p.line(&[[153.0, y + 5.0], [163.0, y - 5.0]]).line(&[[153.0, y - 5.0], [163.0, y + 5.0]])
    };
    named((0..5).fold(p, seam), [95.0, 90.0], [222.0, 70.0])
}

fn prismatic() -> Picture {
    let p = Picture::new("prismatic", "A body that slides along an axis of another and does not turn on it")
        .body([110.0, 68.0], [130.0, 16.0], 0.0, BLUE)
        .body([110.0, 112.0], [130.0, 16.0], 0.0, BLUE)
        .dashed(&[[20.0, 90.0], [300.0, 90.0]])
        .body([165.0, 90.0], [170.0, 24.0], 0.0, ORANGE)
        .both_ways([200.0, 135.0], [280.0, 135.0]);
    named(p, [110.0, 45.0], [215.0, 64.0])
}

fn revolute() -> Picture {
    let pin = [150.0, 95.0];
    let p = Picture::new("revolute", "A hinge: two bodies turn on one another about an axis")
        .body([85.0, 113.0], [150.0, 26.0], -15.0, BLUE)
        .body([207.0, 65.0], [150.0, 26.0], -28.0, ORANGE)
        .ring(pin, 8.0)
        .node(pin, "currentColor")
        .turn(pin, 50.0, 5.0, -15.0)
        .turn(pin, 50.0, 5.0, 25.0);
    named(p, [70.0, 117.0], [225.0, 55.0]).label([150.0, 128.0], "t").label([222.0, 105.0], "φ")
}

fn spherical() -> Picture {
    let ball = [160.0, 85.0];
    let p = Picture::new("spherical", "A ball joint: a point of two bodies coincides")
        .body([80.0, 85.0], [100.0, 24.0], 0.0, BLUE)
        .bar(&arc(ball, 28.0, 60.0, 300.0), BLUE)
        .body([238.0, 58.0], [124.0, 20.0], -19.0, ORANGE)
        .ring(ball, 20.0)
        .node(ball, ORANGE)
        .turn(ball, 75.0, 0.0, 18.0);
    named(p, [75.0, 85.0], [245.0, 56.0])
}

fn universal() -> Picture {
    let p = Picture::new("universal", "A cross of two axes between two shafts")
        .body([60.0, 90.0], [90.0, 22.0], 0.0, BLUE)
        .bar(&[[105.0, 90.0], [128.0, 50.0], [160.0, 50.0]], BLUE)
        .bar(&[[105.0, 90.0], [128.0, 130.0], [160.0, 130.0]], BLUE)
        .body([258.0, 90.0], [90.0, 22.0], 0.0, ORANGE)
        .bar(&[[213.0, 90.0], [190.0, 78.0], [174.0, 78.0]], ORANGE)
        .bar(&[[213.0, 90.0], [190.0, 102.0], [146.0, 102.0]], ORANGE)
        .line(&[[160.0, 38.0], [160.0, 142.0]])
        .line(&[[174.0, 78.0], [146.0, 102.0]]);
    named(p, [55.0, 90.0], [263.0, 90.0]).label([175.0, 38.0], "s").label([133.0, 110.0], "t")
}

fn cylindrical() -> Picture {
    let p = Picture::new("cylindrical", "A rod that slides and turns in a sleeve")
        .body([110.0, 68.0], [130.0, 16.0], 0.0, BLUE)
        .body([110.0, 112.0], [130.0, 16.0], 0.0, BLUE)
        .dashed(&[[20.0, 90.0], [300.0, 90.0]])
        .body([165.0, 90.0], [170.0, 24.0], 0.0, ORANGE)
        .both_ways([195.0, 135.0], [275.0, 135.0])
        .turn([272.0, 90.0], 22.0, 250.0, 470.0);
    named(p, [110.0, 45.0], [215.0, 64.0])
}

fn planar() -> Picture {
    let p = Picture::new("planar", "A plate that slides on a plane and turns about its normal")
        .area(&[[30.0, 145.0], [220.0, 145.0], [290.0, 80.0], [100.0, 80.0]], BLUE)
        .area(&[[110.0, 125.0], [180.0, 125.0], [205.0, 100.0], [135.0, 100.0]], ORANGE)
        .arrow([157.0, 112.0], [157.0, 25.0])
        .both_ways([80.0, 135.0], [105.0, 112.0])
        .both_ways([195.0, 135.0], [240.0, 135.0])
        .turn([157.0, 65.0], 22.0, 130.0, 400.0);
    named(p, [265.0, 90.0], [182.0, 113.0]).label([170.0, 24.0], "n")
}

fn parallel() -> Picture {
    let p = Picture::new("parallel", "Two bodies with axes that stay parallel")
        .body([90.0, 110.0], [90.0, 40.0], -10.0, BLUE)
        .body([225.0, 95.0], [90.0, 40.0], 15.0, ORANGE)
        .arrow([90.0, 110.0], [110.0, 25.0])
        .arrow([225.0, 95.0], [245.0, 10.0]);
    named(p, [65.0, 115.0], [250.0, 102.0]).label([127.0, 40.0], "R_a t").label([216.0, 28.0], "R_b t")
}

fn perpendicular() -> Picture {
    let p = Picture::new("perpendicular", "Two bodies with axes that stay perpendicular")
        .body([90.0, 110.0], [90.0, 40.0], -10.0, BLUE)
        .body([210.0, 110.0], [90.0, 40.0], 20.0, ORANGE)
        .arrow([90.0, 110.0], [110.0, 25.0])
        .arrow([210.0, 110.0], [295.0, 130.0]);
    named(p, [65.0, 115.0], [190.0, 103.0]).label([133.0, 40.0], "R_a s").label([285.0, 150.0], "R_b t")
}

fn rotation_motor() -> Picture {
    let centre = [130.0, 95.0];
    let p = Picture::new("rotation_motor", "Body b turned on body a by a function of time")
        .area(&arc(centre, 40.0, 0.0, 360.0), BLUE)
        .body([205.0, 95.0], [150.0, 20.0], 0.0, ORANGE)
        .node(centre, "currentColor")
        .turn(centre, 60.0, -15.0, -80.0);
    named(p, [112.0, 75.0], [230.0, 95.0]).label([200.0, 45.0], "φ(t)").label([122.0, 115.0], "t")
}

fn translation_motor() -> Picture {
    let p = Picture::new("translation_motor", "Body b moved along an axis of body a by a function of time")
        .body([85.0, 85.0], [90.0, 50.0], 0.0, BLUE)
        .bar(&[[130.0, 85.0], [205.0, 85.0]], ORANGE)
        .body([240.0, 85.0], [70.0, 40.0], 0.0, ORANGE)
        .dashed(&[[85.0, 85.0], [85.0, 140.0]])
        .dashed(&[[240.0, 85.0], [240.0, 140.0]])
        .both_ways([85.0, 135.0], [240.0, 135.0]);
    named(p, [70.0, 85.0], [255.0, 85.0]).label([162.0, 121.0], "d(t)").label([167.0, 68.0], "t")
}
