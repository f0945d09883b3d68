//! Runs the command on all ranks of an MPI job. If one rank fails, all stop with the same exit code.

use std::process::ExitCode;

use qless_mpi::{Ranks, World};

use super::{Job, all, check};
use crate::args::Command;
use crate::failure::CliFailure;
use crate::set_up;

impl Job {
    /// Runs the command on all ranks; only the first one prints.
    pub fn run(self) -> ExitCode {
        let world = match World::start() {
            Ok(world) if world.size() > 1 => world,
            Ok(_) => return self.fail(&CliFailure::Input(OTHER_MPI.to_owned())),
            Err(error) => return self.fail(&CliFailure::Resource(format!("MPI does not start: {error}"))),
        };
        let code = match self.parse() {
            Ok(cli) => run(&world, &cli.command).unwrap_or_else(|failure| self.fail(&failure)),
            Err(code) => code,
        };
        // A rank that exits with an error ends the job, so wait until the first rank has written everything.
        world.sum(&mut [0]);
        code
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
