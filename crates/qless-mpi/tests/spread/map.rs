//! What a map across ranks does is what the serial map does, whoever owns what.

use crate::common::{Partition, share};
use qless::elimination::{PrescribedDofs, Storage};
use qless::{ConstraintSystem, Options};
use qless_mpi::{DistributedElimination, on_threads};
use qless_scenes::{Rng, families, fssi};

/// A chain of springs over all DOFs, with a few across: K as elements of two DOFs.
fn elements(n: usize, rng: &mut Rng) -> Vec<(usize, usize, f64)> {
    let chain = (1..n).map(|j| (j - 1, j));
    let across: Vec<(usize, usize)> = (0..n / 2).map(|_| (rng.below(n), rng.below(n))).collect();
    let all = chain.chain(across).filter(|(a, b)| a != b);
    all.map(|(a, b)| (a, b, 1.0 + rng.real().abs())).collect()
}

fn multiply(elements: &[(usize, usize, f64)], u: &[f64], f: &mut [f64]) {
    for &(a, b, k) in elements {
        f[a] += k * (u[a] - u[b]);
        f[b] += k * (u[b] - u[a]);
    }
}

fn close(a: f64, b: f64, size: f64) -> bool {
    (a - b).abs() <= 1e-12 * size.max(1.0)
}

/// One system on some ranks, against the serial map.
fn compare(name: &str, system: &ConstraintSystem, size: usize, seed: u64) {
    let options = Options::default();
    let Ok(serial) = qless::Elimination::new(system, &options) else {
        let refused = on_threads(size, |ranks| {
            DistributedElimination::new(ranks, &share(system, ranks, Partition::Scattered(seed)), &options).is_err()
        });
        assert!(refused.iter().all(|&refused| refused), "{name}: the serial map is refused");
        return;
    };
    let mut rng = Rng::new(seed);
    let n = system.dofs();
    let all = elements(n, &mut rng);
    let q: Vec<f64> = serial.masters().iter().map(|_| rng.real()).collect();
    let f: Vec<f64> = (0..n).map(|_| rng.real()).collect();
    let mut u = vec![0.0; n];
    serial.expand_into(&q, &mut u).expect("lengths");
    let mut du = vec![0.0; n];
    serial.expand_increment_into(&q, &mut du).expect("lengths");
    let mut f_q = vec![0.0; q.len()];
    serial.restrict_into(&f, &mut f_q).expect("lengths");
    let mut k_du = vec![0.0; n];
    multiply(&all, &du, &mut k_du);
    let mut y = vec![0.0; q.len()];
    serial.restrict_into(&k_du, &mut y).expect("lengths");
    let largest = |v: &[f64]| v.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let sizes = [largest(&u), largest(&f_q), largest(&y)];
    on_threads(size, |ranks| {
        let mut share = share(system, ranks, Partition::Scattered(seed));
        // Each rank has the elements that chance gives it, and so their DOFs.
        let mut rng = Rng::new(seed + 1);
        let own: Vec<_> = all.iter().copied().filter(|_| rng.below(ranks.size()) == ranks.rank()).collect();
        own.iter().for_each(|&(a, b, _)| [a, b].iter().for_each(|&j| share.need(j as u64)));
        let map = DistributedElimination::new(ranks, &share, &options).expect("as the serial map");
        let local = |dof: usize| map.dofs().binary_search(&(dof as u64)).expect("a local DOF");
        let place = |dof: &u64| serial.masters().binary_search(&(*dof as usize)).expect("a master");
        let of_masters: Vec<f64> = map.masters().iter().map(|dof| q[place(dof)]).collect();

        let mut own_u = vec![f64::NAN; map.dofs().len()];
        map.expand_into(ranks, &of_masters, &mut own_u);
        for (&dof, &value) in map.dofs().iter().zip(&own_u) {
            assert!(close(value, u[dof as usize], sizes[0]), "{name}: u of {dof}: {value} {}", u[dof as usize]);
        }
        // Forces are in parts: each rank has those on the DOFs that it owns.
        let range = (n * ranks.rank() / size)..(n * (ranks.rank() + 1) / size);
        let of_dof = |&dof: &u64| if range.contains(&(dof as usize)) { f[dof as usize] } else { 0.0 };
        let forces: Vec<f64> = map.dofs().iter().map(of_dof).collect();
        let mut projected = vec![0.0; map.masters().len()];
        map.restrict_into(ranks, &forces, &mut projected);
        for (dof, &value) in map.masters().iter().zip(&projected) {
            assert!(close(value, f_q[place(dof)], sizes[1]), "{name}: f_q of {dof}");
        }
        // L^T K L by the product, ...
        let mut own_du = vec![0.0; map.dofs().len()];
        map.expand_increment_into(ranks, &of_masters, &mut own_du);
        let in_places: Vec<_> = own.iter().map(|&(a, b, k)| (local(a), local(b), k)).collect();
        let mut own_f = vec![0.0; map.dofs().len()];
        multiply(&in_places, &own_du, &mut own_f);
        map.restrict_into(ranks, &own_f, &mut projected);
        for (dof, &value) in map.masters().iter().zip(&projected) {
            assert!(close(value, y[place(dof)], sizes[2]), "{name}: L^T K L of {dof}");
        }
        // ... and by each rank's condensed matrix.
        let dofs = |e: usize| vec![in_places[e].0, in_places[e].1];
        let transform = map.local();
        let condensed = transform
            .condensed_for_elements(own.len(), dofs, Storage::Full, PrescribedDofs::Eliminated)
            .expect("a pattern");
        let (mut k_q, mut load) = (vec![0.0; condensed.nnz()], vec![0.0; condensed.unknowns()]);
        let element = |e: usize, matrix: &mut [f64], _: &mut [f64]| {
            let k = in_places[e].2;
            matrix.copy_from_slice(&[k, -k, -k, k]);
        };
        condensed.assemble(transform, own.len(), dofs, &mut k_q, &mut load, element).expect("elements");
        let mut local_q = vec![0.0; transform.masters().len()];
        map.gather_into(ranks, &of_masters, &mut local_q, &mut || ());
        let mut product = vec![0.0; local_q.len()];
        for ((row, column), value) in condensed.entries().zip(&k_q) {
            product[row] += value * local_q[column];
        }
        map.sum_into(ranks, &product, &mut projected);
        for (dof, &value) in map.masters().iter().zip(&projected) {
            assert!(close(value, y[place(dof)], sizes[2]), "{name}: K_q of {dof}");
        }
    });
}

#[test]
fn maps_on_ranks_do_what_the_serial_map_does() {
    for seed in 0..120 {
        let mut rng = Rng::new(seed);
        let mesh = fssi::Mesh::with_equations(400 + rng.below(800));
        let scene = match seed % 6 {
            0 => families::planted(20 + rng.below(60), 90 + rng.below(80), rng.below(12), seed, seed % 12 == 0),
            1 => families::random_graph(10 + rng.below(60), 20 + rng.below(80), seed),
            2 => families::rve(1 + rng.below(3)),
            3 => fssi::tie(&mesh, seed),
            4 => families::rbe2(3 + rng.below(20), 1 + rng.below(2), seed),
            _ => families::spotted_band(20 + rng.below(200), seed),
        };
        let scene = scene.expect("a scene");
        let free: Vec<usize> =
            (0..scene.system.dofs()).filter(|j| scene.system.prescribed().iter().all(|p| p.0 != *j)).collect();
        let scene = match seed % 3 {
            0 => scene.with_prescribed(&[(free[rng.below(free.len())], 0.5)]).expect("free"),
            _ => scene,
        };
        compare(&format!("seed {seed}"), &scene.system, [1, 2, 3, 4, 7, 8][rng.below(6)], seed);
    }
}

#[test]
fn new_right_hand_sides_leave_t_as_it_is() {
    let scene = fssi::tie(&fssi::Mesh::with_equations(800), 3).expect("a scene");
    let n = scene.system.dofs();
    on_threads(4, |ranks| {
        let mut share = share(&scene.system, ranks, Partition::Scattered(5));
        share.prescribe(3, 0.0);
        let mut map = DistributedElimination::new(ranks, &share, &Options::default()).expect("consistent");
        let before = map.local().reduction().t().clone();
        let dofs = |e: usize| [e, e + 1];
        let count = map.dofs().len() - 1;
        let condensed = map.local().condensed_for_elements(count, dofs, Storage::Full, PrescribedDofs::Eliminated);
        let condensed = condensed.expect("a pattern");
        for i in 0..share.equations() {
            // Twice the same equation has the same right-hand side only if it is zero; shifts of the whole model keep all.
            share.set_rhs(i, 0.0);
        }
        share.set_prescribed(|dof| 0.25 + dof as f64);
        map.update(ranks, &share, &Options::default()).expect("consistent");
        assert_eq!(map.local().reduction().t(), &before);
        let (mut k_q, mut load) = (vec![0.0; condensed.nnz()], vec![0.0; condensed.unknowns()]);
        let spring = |_: usize, matrix: &mut [f64], _: &mut [f64]| matrix.copy_from_slice(&[1.0, -1.0, -1.0, 1.0]);
        let kept = condensed.assemble(map.local(), count, dofs, &mut k_q, &mut load, spring);
        kept.expect("a pattern outlives new right-hand sides");
        // u0 = 0.25 + j where j is prescribed and nothing else: the load is that of the values now.
        assert!(load.iter().any(|&f| f != 0.0) || !map.dofs().contains(&3));
        let mut u = vec![0.0; map.dofs().len()];
        map.expand_into(ranks, &vec![0.0; map.masters().len()], &mut u);
        if let Ok(place) = map.dofs().binary_search(&3) {
            assert_eq!(u[place], 3.25);
        }
        assert!(n > 3);
    });
}
