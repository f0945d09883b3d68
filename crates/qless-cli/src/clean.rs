//! `qless clean`: writes the deck with an equivalent, independent set of constraints, completely or not at all.

use std::path::Path;
use std::process::ExitCode;

use qless_io::deck::Format;
use qless_io::deck::clean::{self, CleanError};
use qless_io::without_gz;
use qless_io::write::{Inputs, OneFile};

use crate::args::CleanArgs;
use crate::deck_input::LoadCaseChoice;
use crate::diagnose::{Diagnosis, Question, diagnose};
use crate::exit_code;
use crate::failure::{CliFailure, say};
use crate::report::CommandOutcome;
use crate::terminal::Progress;

/// Writes the deck and prints the report; for conflicting equations it only prints the report.
pub fn run(args: &CleanArgs) -> Result<ExitCode, CliFailure> {
    let (input, output) = (&args.model.input, &args.output);
    // Refuses `-o -` before the diagnosis begins, which may take long.
    if output.as_os_str() == "-" {
        return Err(CliFailure::Input("-o -: a deck is not written to standard output; name a file".to_owned()));
    }
    drop(OneFile::at(output, Inputs::default())?);
    let progress = Progress::new(args.model.quiet);
    let question = Question {
        report: &args.report,
        options: args.model.options(),
        preferences: args.keep.preferences(),
        choice: LoadCaseChoice::All,
    };
    let diagnosis = diagnose(&args.model, question, &progress)?;
    let Some(deck) = &diagnosis.deck else { return Err(no_deck(input)) };
    check_format(input, deck.deck.format(), output)?;
    if diagnosis.is_refused() {
        diagnosis.print(None, &CommandOutcome::Refused, progress)?;
        say(format_args!("error: nothing was written to {}: see the report", output.display()));
        return Ok(ExitCode::from(exit_code::REFUSED));
    }
    progress.stage("cleaning");
    let fail = |error: CleanError| CliFailure::Input(format!("{}: {error} (nothing was written)", input.display()));
    let (plan, text) = clean::clean(&deck.deck, &diagnosis.options).map_err(fail)?;
    progress.stage("writing");
    // The output may replace the deck itself, but no file that it includes.
    let included = Inputs::new(deck.deck.model().files().iter().skip(1));
    let is_replaced = output.exists();
    OneFile::at(output, included)?.write(&text)?;
    let restored = if plan.is_empty() { 0 } else { deck.lost() };
    let outcome = CommandOutcome::Cleaned { output, is_replaced, plan: &plan, restored };
    diagnosis.print(None, &outcome, progress)?;
    Ok(ExitCode::from(diagnosis.code()))
}

/// Why a deck that needs cleaning cannot be cleaned. `None` if a plan exists, if nothing needs cleaning, or if the report already refuses
/// the deck. Only makes the plan: writing and proving the cleaned deck would cost more than the report.
pub fn obstacle(diagnosis: &Diagnosis) -> Option<String> {
    let deck = diagnosis.deck.as_ref()?;
    if diagnosis.is_refused() || diagnosis.analysis.dependent().is_empty() && !deck.needs_cleaning() {
        return None;
    }
    clean::check_plan(&deck.deck, &diagnosis.options).err().map(|error| error.to_string())
}

/// Checks that the output has the ending of the input, or another ending of its format. The output is never packed.
fn check_format(input: &Path, language: Format, output: &Path) -> Result<(), CliFailure> {
    let is_same = output.extension().is_some() && output.extension() == input.extension();
    let (input, output) = (input.display(), output);
    if without_gz(output).is_some() {
        let output = output.display();
        return Err(CliFailure::Input(format!("{output}: the output is plain text; leave out the ending .gz")));
    }
    if Format::from_path(output) != Some(language) && !is_same {
        let output = output.display();
        return Err(CliFailure::Input(format!(
            "{output}: the output must have the format of {input}, which is a deck of {language}; give it the same ending"
        )));
    }
    Ok(())
}

fn no_deck(input: &Path) -> CliFailure {
    let input = input.display();
    CliFailure::Input(format!("{input}: only decks can be cleaned; for a matrix or relations use `qless reduce`"))
}
