//! One rank of an MPI job of tests/world.rs: `mpirun -n 4 rounds whole SEED ROUNDS`.

mod play;

use mpi::topology::Color;
use mpi::traits::Communicator;
use play::play;
use qless_mpi::{Message, Ranks, World};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["whole", seed, rounds] => say(&World::start().expect("the first start"), number(seed), number(rounds)),
        ["pieces", seed, rounds] => {
            say(&World::start().expect("the first start").in_pieces(5), number(seed), number(rounds));
        }
        ["parts", seed, rounds] => parts(number(seed), number(rounds)),
        ["late"] => late(),
        ["fault", fault] => fail(fault),
        _ => panic!("usage: rounds whole|pieces|parts SEED ROUNDS, late, or fault panic|work|thread|abort|exit"),
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

/// Says how many hundredths of a second of the processor the first rank needs to wait a second in each way.
fn late() {
    let world = World::start().expect("the first start");
    let wait = |receive: &dyn Fn()| {
        if world.rank() == 1 {
            std::thread::sleep(std::time::Duration::from_secs(1));
        }
        let before = processor_time();
        receive();
        processor_time() - before
    };
    let message = Message { rank: 0, words: vec![1] };
    let (told, from) = if world.rank() == 0 { (vec![], vec![1]) } else { (vec![message], vec![]) };
    let times = [
        wait(&|| drop(world.exchange(Vec::new()))),
        wait(&|| drop(world.overlap(told.clone(), &from, &mut || ()))),
        wait(&|| world.sum(&mut [1])),
        wait(&|| drop(world.gather(&[1]))),
    ];
    if world.rank() == 0 {
        println!("{}", times.map(|time| time.to_string()).join(" "));
    }
}

/// Of this process, as Linux tells it.
fn processor_time() -> u64 {
    let told = std::fs::read_to_string("/proc/self/stat").expect("Linux");
    let after_name = told.rsplit_once(')').expect("a name in brackets").1;
    after_name.split_whitespace().skip(11).take(2).map(number).sum()
}

/// The last rank fails while the others wait for it.
fn fail(fault: &str) {
    let world = World::start().expect("the first start");
    play(&world, 1, 20);
    if world.rank() + 1 == world.size() {
        match fault {
            "panic" => panic!("fails on purpose"),
            "work" => {
                // Too long to leave before its receiver asks for it: it is under way when the rank fails.
                let long = Message { rank: 0, words: vec![0; 100_000] };
                world.overlap(vec![long], &[], &mut || panic!("fails on purpose"));
            }
            "thread" => std::thread::spawn(|| panic!("fails on purpose")).join().expect("this rank needs it"),
            "abort" => std::process::abort(),
            "exit" => std::process::exit(3),
            _ => panic!("no such fault"),
        }
    }
    world.exchange(Vec::new());
    world.sum(&mut [1]);
}
