//! `qless clean`: the deck with an equivalent, independent set of constraints, whole or not at all.

use std::path::Path;
use std::process::ExitCode;

use qless_io::deck::Format as Language;
use qless_io::deck::clean::{self, CleanError, Plan, Reason};
use qless_io::write::{Inputs, OneFile};

use crate::args::CleanArgs;
use crate::diagnose::diagnose;
use crate::failure::{Failure, say};
use crate::progress::Progress;
use crate::text::Outcome;

/// Writes the deck and prints the report, or, for conflicting equations, prints the report only.
pub fn run(args: &CleanArgs) -> Result<ExitCode, Failure> {
    let (input, output) = (&args.model.input, &args.output);
    check_formats(input, output)?;
    // Known before the work, so said before the work.
    drop(OneFile::at(output, Inputs::default())?);
    let progress = Progress::new(args.model.quiet);
    let diagnosis = diagnose(&args.model, args.model.options(), &progress)?;
    let Some(deck) = &diagnosis.deck else { return Err(no_deck(input)) };
    if diagnosis.is_refused() {
        diagnosis.print(None, &Outcome::Refused, progress)?;
        say(format_args!("error: nothing was written to {}: see the report", output.display()));
        return Ok(ExitCode::from(1));
    }
    progress.stage("cleaning");
    let fail = |error: CleanError| Failure::Input(format!("{}: {error} (nothing was written)", input.display()));
    let plan = clean::plan(&deck.deck, &diagnosis.options).map_err(fail)?;
    let text = clean::write(&deck.deck, &plan).map_err(fail)?;
    progress.stage("writing");
    // It may be the deck itself, but none that it includes.
    let included = Inputs::of(deck.deck.model().files().iter().skip(1));
    OneFile::at(output, included)?.write(&text)?;
    let outcome = Outcome::Cleaned { output, removed: redundant(&plan), written: plan.written.len() };
    diagnosis.print(None, &outcome, progress)?;
    Ok(ExitCode::SUCCESS)
}

/// Equations that are gone for good.
fn redundant(plan: &Plan) -> usize {
    plan.removed.iter().filter(|removed| matches!(removed.reason, Reason::Redundant(_))).count()
}

/// Before the work: the input must be a deck, and the output one of the same format.
fn check_formats(input: &Path, output: &Path) -> Result<(), Failure> {
    let Some(language) = Language::of(input) else { return Err(no_deck(input)) };
    if Language::of(output) != Some(language) {
        let (input, output) = (input.display(), output.display());
        return Err(Failure::Input(format!(
            "{output}: the output must have the format of {input}; give it the same ending"
        )));
    }
    Ok(())
}

fn no_deck(input: &Path) -> Failure {
    let input = input.display();
    Failure::Input(format!(
        "{input}: only decks (.inp, .bdf, .dat, .nas, .cdb) can be cleaned; for a matrix use `qless reduce`"
    ))
}
