//! The number of threads does not change a bit of the results, with more constraints than fit into one task.

use std::array::from_fn;
use std::sync::{Arc, mpsc};
use std::time::Duration;

use super::every_type::random;
use crate::types::{Body, Distance, LinearEquation, OnSphere, Point, RigidBody};
use crate::{ConstraintSet, Evaluation};

/// Evaluates c, G and H in two passes, and in one.
fn evaluate(set: &ConstraintSet, u: &[f64], w: &[f64], threads: usize) -> Option<[Evaluation; 2]> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().ok()?;
    let [mut apart, mut at_once] = [set.allocate(), set.allocate()];
    pool.install(|| {
        set.evaluate(u, &mut apart).expect("of this set");
        set.effective_hessian(u, w, &mut apart).expect("of this set");
        set.assemble(u, w, &mut at_once).expect("of this set");
    });
    Some([apart, at_once])
}

#[test]
fn results_do_not_depend_on_threads() -> Result<(), Box<dyn std::error::Error>> {
    let nodes = 3000;
    let point = |node: usize| Point::new(from_fn(|k| 6 * node + k), from_fn(|k| node as f64 + random(k as u64)));
    let mut builder = ConstraintSet::builder(6 * nodes);
    for i in 0..4 * nodes {
        let other = (i + 1 + (i * i) % 500) % nodes;
        builder.add("rod", Distance { length: Some(1.0), ..Distance::new(point(i % nodes), point(other)) })?;
        builder.add("equation", LinearEquation { terms: vec![(i % nodes, 1.5), (other, 0.1)], rhs: 1.0 })?;
        // The node's DOFs are before or after those of the body.
        let Point { dofs, at } = point((i + 7) % nodes);
        let body = Body::with_vector(dofs, at, dofs.map(|dof| dof + 3));
        builder.add("link", RigidBody { body, nodes: vec![point((i + [3, 12][i % 2]) % nodes).into()] })?;
        builder.add("ball", OnSphere { point: point(other), centre: [0.5; 3], radius: Some(2.0) })?;
    }
    let set = builder.build().expect("few DOFs");
    let u: Vec<f64> = (0..6 * nodes as u64).map(random).collect();
    let w: Vec<f64> = (0..set.equations() as u64).map(|i| random(i + 5)).collect();
    let [one, at_once] = evaluate(&set, &u, &w, 1).ok_or("no threads")?;
    assert!(one.h.values().iter().any(|&v| v != 0.0) && at_once == one);
    for threads in [2, 3, 8] {
        let more = evaluate(&set, &u, &w, threads).ok_or("no threads")?;
        assert!(more.iter().all(|evaluation| *evaluation == one), "{threads} threads");
    }
    Ok(())
}

/// Several tasks evaluate a new set while its plan is made. Threads that wait for the plan may take up such tasks; none must deadlock.
#[test]
fn tasks_that_come_while_others_plan_wait_for_nobody() {
    let nodes = 20_000;
    let point = |node: usize| Point::new(from_fn(|k| 3 * node + k), from_fn(|k| node as f64 + random(k as u64)));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
    for seed in 0..20 {
        let mut builder = ConstraintSet::builder(3 * nodes);
        let rod = |i: usize| Distance { length: Some(1.0), ..Distance::new(point(i), point((i + 1 + seed) % nodes)) };
        builder.add_all("rod", nodes, rod).expect("valid");
        let set = Arc::new(builder.build().expect("few DOFs"));
        let (done, all) = mpsc::channel();
        for k in 0..8 {
            // The second task starts while the first one makes the plan of the assembly.
            std::thread::sleep(Duration::from_micros(if k == 1 { 200 * seed as u64 } else { 0 }));
            let (set, done) = (Arc::clone(&set), done.clone());
            pool.spawn(move || {
                let mut evaluation = set.allocate();
                let (u, w) = (vec![0.1; set.dofs()], vec![1.0; set.equations()]);
                set.assemble(&u, &w, &mut evaluation).expect("of this set");
                done.send(evaluation).expect("somebody waits");
            });
        }
        let wait = || all.recv_timeout(Duration::from_secs(60)).expect("no task waits for itself");
        let first = wait();
        assert!(first.h.nnz() > 0 && (1..8).all(|_| wait() == first));
    }
}
