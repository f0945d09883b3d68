use std::array::from_fn;

use qless_constraints::types::Shape;

use super::{Place, affine, corners, inside, off, solids, straight, tie, turned, weights};
use crate::common::{Outcome, random};

/// Distorted, curved and turned elements, in every unit and far from the origin: the weights give the node back, so that linear fields
/// pass, and are the same.
#[test]
fn distorted_elements_pass_linear_fields() -> Outcome {
    for (shape, seed) in solids().flat_map(|shape| (0..40).map(move |k| (shape, 100 * k))) {
        let most = if shape.nodes() > corners(shape) { 0.1 } else { 0.25 };
        let off_straight = |k: usize, d: usize| most * random(seed + 60 + 3 * k + d);
        let moved = |(k, x): (usize, Place)| turned(seed, affine(seed, from_fn(|d| x[d] + off_straight(k, d))));
        let distorted: Vec<Place> = straight(shape).into_iter().enumerate().map(moved).collect();
        let node = inside(seed, &distorted[..corners(shape)]);
        let truth = weights(tie(shape, node, &distorted, 1e-14))?;
        assert!(
            off(&truth, &distorted, node, 1.0) < 1e-14,
            "{shape:?}, {seed}: {}",
            off(&truth, &distorted, node, 1.0)
        );
        for (unit, shift) in [(1e-6, 0.0), (1e6, 0.0), (1.0, 4096.0), (1e-6, 1e-3), (1e6, -1e8)] {
            let place = |x: Place| x.map(|x| unit * x + shift);
            let (nodes, node): (Vec<_>, _) = (distorted.iter().map(|&x| place(x)).collect(), place(node));
            let found = weights(tie(shape, node, &nodes, 0.0))?;
            let rounding = 1e-15 * (1.0 + shift.abs() / unit);
            let back = off(&found, &nodes, node, unit);
            assert!(back < 20.0 * rounding, "{shape:?}, {seed}, unit {unit}, {shift} from the origin: {back}");
            let far = found.iter().zip(&truth).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
            assert!(far < 1000.0 * rounding, "{shape:?}, {seed}, unit {unit}, {shift} from the origin: {far}");
        }
    }
    Ok(())
}

/// Straight elements under any affine map: weights are barycentric coordinates and their products, to rounding.
#[test]
fn affine_elements_have_the_weights_of_the_formula() -> Outcome {
    for seed in (0..50).map(|k| 77 * k) {
        let x: Place = from_fn(|k| 0.3 + 0.5 * random(seed + k));
        let [a, b, c] = x.map(|x| 0.6 * x);
        let place = |x: Place| turned(seed, affine(seed, x));
        let of = |shape: Shape, p: Place| {
            let nodes: Vec<Place> = straight(shape).into_iter().map(place).collect();
            weights(tie(shape, place(p), &nodes, 1e-12))
        };
        let close = |found: &[f64], truth: &[f64]| {
            found.len() == truth.len() && found.iter().zip(truth).all(|(f, t)| (f - t).abs() < 2e-14)
        };
        let l = [1.0 - a - b - c, a, b, c];
        assert!(close(&of(Shape::Tet4, [a, b, c])?, &l));
        let corners = l.map(|l| l * (2.0 * l - 1.0));
        let edges = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]].map(|[i, j]| 4.0 * l[i] * l[j]);
        assert!(close(&of(Shape::Tet10, [a, b, c])?, &[&corners[..], &edges].concat()));
        let wedge = [1.0 - c, c].into_iter().flat_map(|z| [1.0 - a - b, a, b].map(|l| l * z));
        assert!(close(&of(Shape::Wedge6, [a, b, c])?, &wedge.collect::<Vec<_>>()));
        let square = |[x, y]: [f64; 2]| [(1.0 - x) * (1.0 - y), x * (1.0 - y), x * y, (1.0 - x) * y];
        let hex = [1.0 - x[2], x[2]].into_iter().flat_map(|z| square([x[0], x[1]]).map(|n| n * z));
        assert!(close(&of(Shape::Hex8, x)?, &hex.collect::<Vec<_>>()));
        // At height z a pyramid is a square of side 1 - z from the point that lies on the line to its tip.
        let q = 1.0 - x[2];
        let at = [0.3 * x[2] + q * x[0], 0.6 * x[2] + q * x[1], x[2]];
        let pyramid = [square([x[0], x[1]]).map(|n| n * q).to_vec(), vec![x[2]]].concat();
        assert!(close(&of(Shape::Pyramid5, at)?, &pyramid), "{:?}, {pyramid:?}", of(Shape::Pyramid5, at));
    }
    Ok(())
}

/// Quadratic fields pass straight quadratic elements.
#[test]
fn quadratic_elements_pass_quadratic_fields() -> Outcome {
    let quadratic = solids().filter(|&shape| shape.nodes() > corners(shape));
    for (shape, seed) in quadratic.flat_map(|shape| (0..20).map(move |k| (shape, 31 * k))) {
        let nodes: Vec<Place> = straight(shape).into_iter().map(|x| turned(seed, affine(seed, x))).collect();
        let node = inside(seed, &nodes[..corners(shape)]);
        let n = weights(tie(shape, node, &nodes, 1e-12))?;
        let field = |[x, y, z]: Place| 1.0 + x - y + x * x - 0.5 * y * z + 0.7 * z * z - x * y;
        let sum: f64 = n.iter().zip(&nodes).map(|(n, &x)| n * field(x)).sum();
        assert!((sum - field(node)).abs() < 2e-14, "{shape:?}: {sum}, {}", field(node));
    }
    Ok(())
}

/// No weight is smaller than 8 units in the last place of the largest without being zero, and the sum is one to two units for each.
#[test]
fn weights_that_are_rounding_are_zero() -> Outcome {
    let mut zeros = 0;
    for (shape, seed) in solids().flat_map(|s| (0..60).map(move |k| (s, 13 * k))) {
        let nodes: Vec<Place> = straight(shape).into_iter().map(|x| turned(seed, affine(seed, x))).collect();
        // On an edge, a face, at a node, at random places of these.
        let [a, b, c] = [0, 1, 2].map(|k| nodes[k]);
        let [s, t] = [0, 1].map(|k| 0.3 + 0.4 * random(seed + k));
        for node in
            [a, from_fn(|k| a[k] + s * (b[k] - a[k])), from_fn(|k| a[k] + s * (b[k] - a[k]) + s * t * (c[k] - b[k]))]
        {
            let n = weights(tie(shape, node, &nodes, 1e-13))?;
            let largest = n.iter().fold(0.0, |most: f64, n| most.max(n.abs()));
            let unit = 2.0_f64.powi(largest.log2().floor() as i32 - 52);
            assert!(n.iter().all(|&n| n == 0.0 || n.abs() >= 8.0 * unit), "{shape:?}: {n:?}");
            let sum: f64 = n.iter().sum();
            assert!((sum - 1.0).abs() <= 2.0 * f64::EPSILON * n.len() as f64, "{sum}");
            zeros += n.iter().filter(|&&n| n == 0.0).count();
        }
    }
    assert!(zeros > 5000, "{zeros}");
    Ok(())
}
