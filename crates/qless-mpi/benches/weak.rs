//! What ranks do and say as their number grows with the model: Table 1's twin, as many equations for each rank, counted.
//!
//! ```text
//! cargo bench -p qless-mpi --bench weak                      100,000 equations a rank, 1 to 64 ranks in this process
//! cargo bench -p qless-mpi --bench weak -- --each 20000      fewer
//! cargo bench -p qless-mpi --bench weak -- --cpu 10000000    processor time of 4 ranks against that of the serial library
//! cargo bench -p qless-mpi --bench weak -- --test            a short form, whose limits must hold
//! ```

use qless::{ConstraintSystem, Options};
use qless_mpi::{Counted, Ranks, Sent, Share, WorkCounts, analyse, on_threads};
use qless_scenes::fssi::{Mesh, tie};

/// What one rank did.
#[derive(Clone, Copy, Default)]
struct Work {
    sent: Sent,
    counts: WorkCounts,
    held: usize,
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let number = |name: &str| {
        let place = arguments.iter().position(|argument| argument == name)?;
        arguments.get(place + 1)?.parse().ok()
    };
    if let Some(equations) = number("--cpu") {
        processor_time(equations);
        return;
    }
    let short = arguments.iter().any(|argument| argument == "--test");
    let each = number("--each").unwrap_or(if short { 2000 } else { 100_000 });
    let sizes: &[usize] = if short { &[1, 4, 16] } else { &[1, 2, 4, 8, 16, 32, 64] };
    for numbering in [Numbering::ByPlace, Numbering::ByChance] {
        weak(each, sizes, numbering);
    }
}

/// How DOFs and equations lie on the ranks.
#[derive(Clone, Copy, Debug)]
enum Numbering {
    /// DOFs in the order in which the equations name them: neighbours lie on one rank.
    ByPlace,
    /// DOFs in random order, equations as they come: hardly anything lies together.
    ByChance,
}

/// Equations, and how many DOFs are numbered before each of them.
struct Twin {
    system: ConstraintSystem,
    before: Option<Vec<usize>>,
}

impl Twin {
    fn new(equations: usize, numbering: Numbering) -> Self {
        let system = tie(&Mesh::with_equations(equations), 1).expect("a mesh").system;
        match numbering {
            Numbering::ByChance => Self { system, before: None },
            Numbering::ByPlace => Self::by_place(&system),
        }
    }

    fn by_place(system: &ConstraintSystem) -> Self {
        let (mut number, mut next) = (vec![usize::MAX; system.dofs()], 0);
        let mut builder = qless::SystemBuilder::new(system.dofs());
        let mut before = Vec::new();
        for i in 0..system.equations() {
            before.push(next);
            let terms: Vec<(usize, f64)> = system.matrix().row(i).collect();
            for &(j, _) in &terms {
                if number[j] == usize::MAX {
                    number[j] = next;
                    next += 1;
                }
            }
            builder.equation(terms.into_iter().map(|(j, v)| (number[j], v)), system.rhs()[i]);
        }
        Self { system: builder.build().expect("valid"), before: Some(before) }
    }

    /// The equations of a rank, and the DOFs that they are the first to name or that chance gives it.
    fn share(&self, ranks: &dyn Ranks) -> Share {
        let Self { system, before } = self;
        let (m, n, size, rank) = (system.equations(), system.dofs(), ranks.size(), ranks.rank());
        let first = |rank: usize| match before {
            Some(before) => before.get(m * rank / size).copied().unwrap_or(n),
            None => n * rank / size,
        };
        let mut share = Share::new(first(rank) as u64..first(rank + 1) as u64);
        for i in m * rank / size..m * (rank + 1) / size {
            share.equation(i as u64, system.matrix().row(i).map(|(j, v)| (j as u64, v)), system.rhs()[i]);
        }
        share
    }
}

fn weak(each: usize, sizes: &[usize], numbering: Numbering) {
    println!("Table 1's twin, {each} equations a rank, DOFs {numbering:?}");
    println!("                                                   MB sent      MB received");
    println!(
        " ranks equations  redundant   rounds  messages    mean    most    mean    most   peeled  analysed  attempts"
    );
    let mut first = None;
    for &size in sizes {
        let twin = Twin::new(each * size, numbering);
        let work = on_threads(size, |ranks| {
            let ranks = Counted::new(ranks);
            let share = twin.share(&ranks);
            let analysis = analyse(&ranks, &share, &Options::default()).expect("valid");
            (Work { sent: ranks.sent(), counts: analysis.work(), held: share.equations() }, analysis.counts())
        });
        let most = |of: &dyn Fn(&Work) -> u64| work.iter().map(|(work, _)| of(work)).max().unwrap_or(0);
        let mean = |of: &dyn Fn(&Work) -> u64| work.iter().map(|(work, _)| of(work)).sum::<u64>() as f64 / size as f64;
        println!(
            "{size:6} {:9} {:10} {:8} {:9} {:7.3} {:7.3} {:7.3} {:7.3} {:8} {:9} {:9}",
            twin.system.equations(),
            work[0].1.redundant,
            most(&|w| w.sent.rounds),
            most(&|w| w.sent.messages),
            mean(&|w| w.sent.bytes) / 1e6,
            most(&|w| w.sent.bytes) as f64 / 1e6,
            mean(&|w| w.sent.received) / 1e6,
            most(&|w| w.sent.received) as f64 / 1e6,
            most(&|w| w.counts.peeled as u64),
            most(&|w| w.counts.analysed as u64),
            work[0].0.counts.attempts,
        );
        assert!(
            most(&|w| w.counts.analysed as u64) as f64 <= 2.0 * mean(&|w| w.held as u64),
            "the work of a rank grows"
        );
        let sent = mean(&|w| w.sent.bytes);
        if size == 4 {
            first = Some(sent);
        }
        // By place little is sent at all, and with four ranks the cuts fall on the faces of the box.
        if let (Some(first), Numbering::ByChance) = (first, numbering) {
            assert!(sent <= 1.5 * first, "{sent} bytes sent by a rank, {first} with 4 ranks");
        }
    }
}

/// Processor seconds of this process so far.
fn used() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").expect("a system that tells");
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    let ticks = |k: usize| fields[k].parse::<f64>().expect("a number");
    (ticks(11) + ticks(12)) / 100.0
}

/// Most memory in use since this was last asked, in MB.
fn peak() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("a system that tells");
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap_or_default();
    let kib: f64 = line.trim().trim_end_matches(" kB").parse().unwrap_or_default();
    std::fs::write("/proc/self/clear_refs", "5").expect("a system that forgets");
    kib / 1024.0
}

fn processor_time(equations: usize) {
    let twin = Twin::new(equations, Numbering::ByPlace);
    let system = &twin.system;
    println!("{} equations", system.equations());
    let mut ratios = Vec::new();
    for _ in 0..3 {
        peak();
        let before = used();
        let analysis = qless::analyse(system, &Options::default()).expect("valid");
        let reduction = analysis.reduction().expect("sound");
        let serial = used() - before;
        let redundant = analysis.dependent().len() as u64;
        drop((analysis, reduction));
        let of_serial = peak();
        let shares = on_threads(4, |ranks| twin.share(ranks));
        let of_shares = peak();
        let before = used();
        let counts =
            on_threads(4, |ranks| analyse(ranks, &shares[ranks.rank()], &Options::default()).expect("valid").counts());
        let spread = used() - before;
        assert_eq!(counts[0].redundant, redundant);
        println!("serial {serial:.2} s, 4 ranks {spread:.2} s of processor time: {:.2}", spread / serial);
        println!("MB at most: serial {of_serial:.0}, shares {of_shares:.0}, 4 ranks together {:.0}", peak());
        ratios.push(spread / serial);
    }
    ratios.sort_by(f64::total_cmp);
    println!("median {:.2}", ratios[1]);
}
