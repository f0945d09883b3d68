//! `(n, t_1, t_2)`: the axes in which the equations of a node are written, so that each holds x, y and z.

type FrameVector = [f64; 3];

/// The unit normal, and two tangents that lie along no axis of space.
pub(super) fn frame(normal: FrameVector) -> [FrameVector; 3] {
    let n = unit(normal);
    // Across the axis that is farthest from the normal.
    let least = (1..3).fold(0, |least, k| if n[k].abs() < n[least].abs() { k } else { least });
    let first = unit(cross(n, std::array::from_fn(|k| if k == least { 1.0 } else { 0.0 })));
    let second = cross(n, first);
    let turned = |a: f64, b: f64| std::array::from_fn(|k| a * first[k] + b * second[k]);
    [n, turned(0.6, 0.8), turned(-0.8, 0.6)]
}

pub(super) fn cross(a: FrameVector, b: FrameVector) -> FrameVector {
    std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

pub(super) fn length(a: FrameVector) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn unit(a: FrameVector) -> FrameVector {
    let length = length(a);
    a.map(|x| x / length)
}
