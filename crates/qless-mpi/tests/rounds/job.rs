//! One rank of an MPI job of tests/world.rs: `mpirun -n 4 rounds whole SEED ROUNDS`.

mod play;

use mpi::topology::Color;
use mpi::traits::Communicator;
use play::play;
use qless_mpi::{Ranks, World};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["whole", seed, rounds] => say(&World::start().expect("the first start"), number(seed), number(rounds)),
        ["pieces", seed, rounds] => {
            say(&World::start().expect("the first start").in_pieces(5), number(seed), number(rounds));
        }
        ["parts", seed, rounds] => parts(number(seed), number(rounds)),
        ["fault", fault] => fail(fault),
        _ => panic!("usage: rounds whole|pieces|parts SEED ROUNDS, or fault panic|work|thread|abort|exit"),
    }
}

fn number(text: &str) -> u64 {
    text.parse().expect("a number")
}

/// The first rank speaks for all.
fn say(ranks: &dyn Ranks, seed: u64, rounds: u64) {
    let told = play(ranks, seed, rounds);
    if ranks.rank() == 0 {
        println!("{told}");
    }
}

/// A host code has initialised MPI: even and odd ranks play by themselves, with all playing in between on the same processes.
fn parts(seed: u64, rounds: u64) {
    let universe = mpi::initialize().expect("the first start");
    assert_eq!(World::start().err(), Some(qless_mpi::WorldError::Started));
    let all = universe.world();
    let half = all.split_by_color(Color::with_value(all.rank() % 2)).expect("a colour");
    let (all, half) = (World::of(&all).expect("MPI runs"), World::of(&half).expect("MPI runs"));
    for step in 0..4 {
        play(&half, seed + step + half.size() as u64, rounds);
        play(&all, seed + step, rounds);
    }
    say(&half, seed, rounds);
}

/// The last rank fails while the others wait for it.
fn fail(fault: &str) {
    let world = World::start().expect("the first start");
    play(&world, 1, 20);
    if world.rank() + 1 == world.size() {
        match fault {
            "panic" => panic!("fails on purpose"),
            "work" => drop(world.overlap(Vec::new(), &[], &mut || panic!("fails on purpose"))),
            "thread" => std::thread::spawn(|| panic!("fails on purpose")).join().expect("this rank needs it"),
            "abort" => std::process::abort(),
            "exit" => std::process::exit(3),
            _ => panic!("no such fault"),
        }
    }
    world.exchange(Vec::new());
    world.sum(&mut [1]);
}
