//! Runs the command on all ranks of an MPI job. If one rank fails, all stop with the same exit code.

use std::process::ExitCode;

use clap::Parser;
use qless_mpi::{Ranks, World};

use super::{Job, all, check};
use crate::args::{Cli, Command};
use crate::failure::CliFailure;
use crate::set_up;

impl Job {
    /// Runs the command on all ranks; only the first one prints.
    pub fn run(self) -> ExitCode {
        let world = match World::start() {
            Ok(world) if world.size() > 1 => world,
            Ok(_) => return self.end(&CliFailure::Input(OTHER_MPI.to_owned())),
            Err(error) => return self.end(&CliFailure::Resource(format!("MPI does not start: {error}"))),
        };
        let ended = match Cli::try_parse() {
            Ok(cli) => run(&world, &cli.command).unwrap_or_else(|failure| self.end(&failure)),
            Err(error) => {
                if self.rank == 0 {
                    // A write error could not be reported anywhere.
                    let _ = error.print();
                }
                ExitCode::from(error.exit_code() as u8)
            }
        };
        // A rank that exits with an error ends the job, so wait until the first rank has written everything.
        world.sum(&mut [0]);
        ended
    }

    fn end(self, failure: &CliFailure) -> ExitCode {
        if self.rank == 0 { failure.tell() } else { failure.code() }
    }
}

const OTHER_MPI: &str = "mpirun has started several processes, but this qless sees only itself: it was built with another MPI \
     library; use the mpirun of that library";

fn run(world: &World, command: &Command) -> Result<ExitCode, CliFailure> {
    let Command::Check(args) = command else {
        return Err(CliFailure::Input(
            "mpirun has started several processes, and only `qless check` runs on more than one".into(),
        ));
    };
    all(world, set_up(command))?;
    check::run(world, args)
}
