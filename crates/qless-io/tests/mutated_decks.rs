//! Random changes of decks: a cleaned deck is read again, has no faults and constrains as before; or a typed error says why the
//! deck cannot be cleaned. `QLESS_THOROUGH` tries ten thousand decks.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};

use qless::{Options, SystemBuilder, analyse};
use qless_io::deck::clean::{CleanError, faults, plan, write};
use qless_io::deck::{Deck, DeckError, Format, LoadCase, Model, Outcome, parse};
use qless_scenes::Rng;

/// Largest size of a deck that is changed, and most terms of a deck that is cleaned: the test takes seconds.
const BYTES: u64 = 4_000;
const TERMS: usize = 600;

const BODIES: &str = "*NODE,NSET=ALL
1,0.,0.,0.
2,1.,0.,0.
3,0.,1.,.5
4,2.,1.,0.
5,2.,2.,1.
6,3.,2.,1.
*NSET,NSET=A
1,2,3
*NSET,NSET=B
4,5
*TRANSFORM,NSET=B,TYPE=R
.8,.6,0.,-.6,.8,0.
*RIGID BODY,NSET=A,REF NODE=6
*EQUATION
2
4,1,1.,5,1,-1.
3
4,1,2.,5,1,-1.,1,2,.5
2
5,2,1.,4,2,-3.
2
1,1,1.,4,3,1.
*MPC
PLANE,1,2,3,4
*BOUNDARY
1,1,1
4,3,3,.25
*STEP
*STATIC
*CLOAD
5,1,3.
*BOUNDARY
5,1,1,.1
*END STEP
*STEP
*STATIC
*EQUATION,REMOVE
5,2,2
*BOUNDARY,OP=NEW
2,2,2
*END STEP
";

const SUBCASES: &str = "SOL 101
CEND
SPC = 1
SUBCASE 1
  MPC = 10
  LOAD = 4
SUBCASE 2
  MPC = 20
  SPC = 2
BEGIN BULK
GRID,1,,0.,0.,0.
GRID,2,,1.,0.,0.
GRID,3,,1.,1.,0.
GRID,4,,0.,1.,.5
GRID,5,,2.,0.,0.
MPC,1,1,1,1.,2,1,-1.
MPC,1,3,1,1.,2,1,-2.,+A
+A,,1,1,.5
MPC,2,4,2,1.,3,2,-1.
MPC,2,4,2,2.,3,2,-2.
MPC,2,3,2,1.,1,1,1.
MPCADD,10,1,2
MPCADD,20,2
RBE2,7,5,123,4,3
RBAR,8,1,2,123456
RBE3,9,,5,456,1.,123,1,2,+B
+B,3,4
SPC1,1,12,3
SPC,2,4,2,.1
FORCE,4,2,0,1.,1.,0.,0.
ENDDATA
";

const COMMANDS: &str = "/PREP7
N,1,0,0,0
N,2,1,0,0
N,3,0,1,0
N,4,1,1,1
N,9,2,0,0
CE,1,0,1,UX,1,2,UX,-1
CE,2,0,3,UX,1,2,UX,-1 $ CE,2,0,1,UX,.5
CE,3,0,1,UX,2,2,UX,-2
CE,4,.5,4,UY,1,3,UY,-1
CE,NEXT,0,3,UY,1,1,UX,-2
CP,1,UZ,1,2,3
CP,2,UZ,3,4
CERIG,9,4,UXYZ
*DO,I,1,2
CE,10+I,0,I,ROTX,1,9,ROTX,-1
*ENDDO
D,3,UY
D,1,UX,.25
F,2,UX,3
SOLVE
D,4,UZ,0
SOLVE
";

#[test]
fn changed_decks_are_cleaned_or_refused() {
    let bases = bases();
    let (seed, count) = if std::env::var_os("QLESS_THOROUGH").is_some() { (2, 10_000) } else { (1, 400) };
    let mut rng = Rng::new(seed);
    let mut outcomes: BTreeMap<String, usize> = BTreeMap::new();
    let mut failures = Vec::new();
    for k in 0..count {
        let (format, name, base) = &bases[rng.below(bases.len())];
        let text = changed(base, &mut rng);
        let outcome = std::panic::catch_unwind(|| cleaned(*format, &text));
        match outcome.unwrap_or_else(|_| Err("panics".into())) {
            Ok(outcome) => *outcomes.entry(outcome).or_default() += 1,
            Err(failure) => {
                failures.push(format!("deck {k}, of {name}: {failure}\n{}", String::from_utf8_lossy(&text)));
            }
        }
    }
    println!("{outcomes:?}");
    assert!(outcomes.get("cleaned").is_some_and(|cleaned| *cleaned > count / 20), "{outcomes:?}");
    assert!(failures.is_empty(), "{} failures\n{}", failures.len(), failures.join("\n--------\n"));
}

/// Rigid elements and bodies at random, many of them redundant: what edits of cards leave is checked like every cleaned deck, and cards
/// that lose no equation stay as they are.
#[test]
fn redundant_cards_are_left_out() {
    let count = if std::env::var_os("QLESS_THOROUGH").is_some() { 10_000 } else { 600 };
    let mut rng = Rng::new(3);
    let (mut edited, mut written) = (0, 0);
    for k in 0..count {
        let (format, text) =
            if k % 2 == 0 { (Format::Nastran, elements(&mut rng)) } else { (Format::Calculix, cards(&mut rng)) };
        let outcome = cleaned(format, text.as_bytes()).unwrap_or_else(|failure| panic!("deck {k}: {failure}\n{text}"));
        let deck = read(format, text.clone().into_bytes(), &[]).unwrap_or_else(|error| panic!("{error}\n{text}"));
        let Some(plan) = (outcome == "cleaned").then(|| plan(&deck, &Options::default()).expect("a plan")) else {
            continue;
        };
        written += usize::from(!plan.written.is_empty());
        if plan.written.is_empty() {
            edited += 1;
            let after = String::from_utf8(write(&deck, &plan).expect("written")).expect("text");
            let model = deck.model();
            let lines = plan.removed.iter().map(|removed| model.equation(removed.equation).expect("one").origin);
            let gone: BTreeSet<u32> = lines.flat_map(|origin| origin.line..origin.line + origin.lines).collect();
            let stays = text
                .lines()
                .zip(1..)
                .filter(|(text, line)| !gone.contains(line) && !["*EQUATION", "MPC = 1"].contains(text));
            let mut stays = stays.map(|(text, _)| text);
            let mut next = stays.next();
            after.lines().for_each(|line| next = if next == Some(line) { stays.next() } else { next });
            assert!(next.is_none(), "deck {k}: {next:?} is gone\n{text}\n{after}");
        }
    }
    println!("{edited} edited, {written} written");
    assert!(edited > count / 4 && edited > written, "{edited} edited, {written} written");
}

/// Rigid elements between up to eight grid points.
fn elements(rng: &mut Rng) -> String {
    let points = 4 + rng.below(5);
    let control = ["MPC = 1\nSPC = 1\n", "SUBCASE 1\nMPC = 1\nSUBCASE 2\nSPC = 1\n"][rng.below(4) / 3];
    let mut text = format!("SOL 101\nCEND\n{control}BEGIN BULK\n");
    for point in 1..=points {
        text.extend([format!("GRID,{point},,{}.,{}.,{}.\n", rng.below(4), rng.below(4), rng.below(3))]);
    }
    for id in 11..=12 + rng.below(4) {
        let mut all: Vec<usize> = (1..=points).collect();
        (0..points).for_each(|i| all.swap(i, rng.below(points)));
        let named: Vec<String> = all[1..2 + rng.below(3)].iter().map(usize::to_string).collect();
        let card = match rng.below(8) {
            0 => format!("RBAR,{id},{},{},123456\n", all[0], all[1]),
            1 => format!("MPC,1,{},1,1.,{},1,-1.\n", all[0], all[1]),
            2 => format!("RBE2,{id},{},123,{}\n", all[0], named.join(",")),
            3 => format!("SPC1,1,{},{}\nRBE2,{id},{},123456,{}\n", 1 + rng.below(6), all[3], all[0], named.join(",")),
            _ => format!("RBE2,{id},{},123456,{}\n", all[0], named.join(",")),
        };
        text.extend([card]);
    }
    text + "ENDDATA\n"
}

/// Rigid bodies, ties and equations of up to eight nodes, some of them twice.
fn cards(rng: &mut Rng) -> String {
    let mut text = "*NODE,NSET=ALL\n".to_owned();
    for node in 1..=8 {
        text.extend([format!("{node},{}.,{}.,{}.\n", node % 2, node / 2 % 2, node / 4 % 2)]);
    }
    for node in 9..=16 {
        text.extend([format!("{node},{}.,{}.,{}.\n", node % 2, node / 2 % 2, 1 + node / 4 % 2)]);
    }
    text += "21,9.,0.,0.\n22,9.,1.,0.\n23,9.,2.,0.\n";
    text += "*ELEMENT,TYPE=C3D8,ELSET=E1\n1,8,1,3,2,4,5,7,6\n*ELEMENT,TYPE=C3D8,ELSET=E2\n2,16,9,11,10,12,13,15,14\n";
    text += "*SURFACE,NAME=TOP\nE1,S2\n*SURFACE,NAME=FOOT\nE2,S1\n*NSET,NSET=A\n4,5\n*NSET,NSET=B\n5,6,7\n*NSET,NSET=C\n12,13,14,15\n";
    let cards = [
        "*TIE,NAME=T1\nFOOT,TOP\n",
        "*TIE,NAME=T2\nTOP,FOOT\n",
        "*RIGID BODY,NSET=A,REF NODE=21,ROT NODE=22\n",
        "*RIGID BODY,NSET=B,REF NODE=21,ROT NODE=22\n",
        "*RIGID BODY,NSET=C,REF NODE=21,ROT NODE=22\n",
        "*EQUATION\n2\n4,1,1.,16,1,-1.\n",
        "*EQUATION\n2\n16,1,2.,4,1,-2.\n2\n9,2,1.,5,2,-1.\n",
        "*EQUATION\n2\n9,1,1.,5,1,-1.\n2\n9,2,1.,5,2,-1.\n2\n9,3,1.,5,3,-1.\n",
        "*EQUATION\n2\n5,1,1.,9,1,-1.\n2\n5,2,1.,9,2,-1.\n2\n5,3,1.,9,3,-1.\n2\n10,1,1.,6,1,-1.\n2\n10,2,1.,6,2,-1.\n2\n10,3,1.,6,3,-1.\n",
        "*EQUATION\n2\n16,1,1.,4,1,-1.\n2\n16,2,1.,4,2,-1.\n2\n16,3,1.,4,3,-1.\n",
    ];
    (0..2 + rng.below(4)).for_each(|_| text += cards[rng.below(cards.len())]);
    text + "*STEP\n*STATIC\n*END STEP\n"
}

/// Decks of every format: the ones above, those of this repository and those that `QLESS_CORPUS` names.
fn bases() -> Vec<(Format, String, Vec<u8>)> {
    let own = [
        (Format::Calculix, "BODIES", BODIES),
        (Format::Nastran, "SUBCASES", SUBCASES),
        (Format::Ansys, "COMMANDS", COMMANDS),
    ];
    let mut all: Vec<(Format, String, Vec<u8>)> =
        own.iter().map(|(format, name, text)| (*format, (*name).to_owned(), text.as_bytes().to_vec())).collect();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut folders = vec![root.join("tests/corpus/decks"), root.join("fuzz/seeds")];
    if !root.join("fuzz").exists() {
        eprintln!("SKIPPED: the packaged archive has no folders fuzz/ and tests/corpus/; the repository has");
    }
    let named = std::env::var_os("QLESS_CORPUS").filter(|folder| folder != "none").map(PathBuf::from);
    folders.extend(named.map(|folder| folder.join("decks")));
    for path in folders.iter().flat_map(|folder| files(folder)) {
        let Some(format) = format(&path) else { continue };
        if path.metadata().is_ok_and(|of| of.len() <= BYTES) {
            let text = std::fs::read(&path).expect("a file that can be read");
            all.push((format, path.display().to_string(), text));
        }
    }
    all
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    entries.sort();
    entries.into_iter().flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

fn format(path: &Path) -> Option<Format> {
    let by_ending = match path.extension().and_then(|ending| ending.to_str()) {
        Some("inp") => Some(Format::Calculix),
        Some("bdf") => Some(Format::Nastran),
        Some("cdb") => Some(Format::Ansys),
        _ => None,
    };
    by_ending.or_else(|| match path.parent()?.file_name()?.to_str()? {
        "calculix" => Some(Format::Calculix),
        "nastran" => Some(Format::Nastran),
        "ansys" => Some(Format::Ansys),
        _ => None,
    })
}

/// The text after one to three random changes.
fn changed(base: &[u8], rng: &mut Rng) -> Vec<u8> {
    let mut lines: Vec<Vec<u8>> = base.split(|&byte| byte == b'\n').map(<[u8]>::to_vec).collect();
    for _ in 0..=rng.below(3) {
        let (a, b) = (rng.below(lines.len()), rng.below(lines.len()));
        match rng.below(8) {
            0 if lines.len() > 1 => drop(lines.remove(a)),
            1 => lines.insert(b, lines[a].clone()),
            2 => lines.swap(a, b),
            3 => lines[a] = renamed(&lines[a], rng),
            4 => lines.iter_mut().filter(|line| !line.ends_with(b"\r")).for_each(|line| line.push(b'\r')),
            _ => lines[a] = with_other_number(&lines[a], rng),
        }
    }
    lines.join(&b'\n')
}

/// The line with one of its numbers replaced.
fn with_other_number(line: &[u8], rng: &mut Rng) -> Vec<u8> {
    const NUMBERS: [&str; 16] =
        ["1", "2", "3", "4", "5", "123", "0", "1.", "-1.", "0.", ".5", "3.", "1e-3", "1e-9", "1e-12", ".3333333"];
    let fields: Vec<&[u8]> = line.split(|&byte| byte == b',').collect();
    let is_number = |field: &[u8]| field.trim_ascii().first().is_some_and(|byte| b"+-.0123456789".contains(byte));
    let at: Vec<usize> = (0..fields.len()).filter(|&k| is_number(fields[k])).collect();
    let Some(&chosen) = at.get(rng.below(at.len().max(1))) else { return line.to_vec() };
    let number = NUMBERS[rng.below(NUMBERS.len())];
    let fields: Vec<&[u8]> =
        (0..fields.len()).map(|k| if k == chosen { number.as_bytes() } else { fields[k] }).collect();
    fields.join(&b',')
}

/// The line with the last letter of a name, or a letter of a word, replaced.
fn renamed(line: &[u8], rng: &mut Rng) -> Vec<u8> {
    let at: Vec<usize> = (0..line.len()).filter(|&k| line[k].is_ascii_alphabetic()).collect();
    let Some(&chosen) = at.get(rng.below(at.len().max(1))) else { return line.to_vec() };
    let mut line = line.to_vec();
    line[chosen] = b"ABXYZR"[rng.below(6)];
    line
}

/// The files that decks include, by the line `=== NAME` that starts each.
fn split(data: &[u8]) -> (Vec<u8>, Vec<(PathBuf, Vec<u8>)>) {
    let (mut main, mut others) = (Vec::new(), Vec::<(PathBuf, Vec<u8>)>::new());
    for line in data.split_inclusive(|&byte| byte == b'\n') {
        match line.strip_prefix(b"=== ") {
            Some(name) => others.push((String::from_utf8_lossy(name.trim_ascii()).as_ref().into(), Vec::new())),
            None => others.last_mut().map_or(&mut main, |(_, text)| text).extend_from_slice(line),
        }
    }
    (main, others)
}

fn read(format: Format, main: Vec<u8>, others: &[(PathBuf, Vec<u8>)]) -> Result<Deck, DeckError> {
    let mut open = |path: &Path| {
        let file = others.iter().find(|(known, _)| known == path);
        file.map(|(_, text)| text.clone()).ok_or_else(|| Error::from(ErrorKind::NotFound))
    };
    parse(format, Path::new("deck"), main, &mut open)
}

/// Cleans a deck, and checks the result. Returns the outcome in a word, or what is wrong.
fn cleaned(format: Format, data: &[u8]) -> Result<String, String> {
    let (main, others) = split(data);
    let Ok(deck) = read(format, main, &others) else { return Ok("not read".into()) };
    if deck.model().terms() > TERMS {
        return Ok("large".into());
    }
    let refused = |error: CleanError| match error {
        CleanError::Unproven { .. } => Err(error.to_string()),
        _ => Ok(format!("{error:?}").split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default().to_owned()),
    };
    let first = match plan(&deck, &Options::default()) {
        Ok(first) => first,
        Err(error) => return refused(error),
    };
    let text = match write(&deck, &first) {
        Ok(text) => text,
        Err(error) => return refused(error),
    };
    if first.is_empty() {
        return if text == **deck.texts()[0] { Ok("unchanged".into()) } else { Err("an empty plan changes".into()) };
    }
    let again = read(format, text, &others).map_err(|error| format!("what was written is not read: {error}"))?;
    let (model, solver) = (again.model(), again.solver());
    let refused = faults(model).into_iter().filter(|fault| solver.outcome(fault, model) != Outcome::Accepted);
    let left: Vec<String> = refused.map(|fault| fault.describe(model)).collect();
    if !left.is_empty() {
        return Err(format!("faults are left: {left:?}"));
    }
    match plan(&again, &Options::default()) {
        Ok(second) if !second.is_empty() => return Err(format!("cleaned again, it changes: {second:?}")),
        _ => {}
    }
    constrains_as(deck.model(), again.model()).map(|()| "cleaned".into())
}

/// Compares the solution spaces of load cases without the prescribed values: the ranks of both systems and of both together are
/// equal. New nodes stand for DOFs under other names, so that decks with them cannot be compared here.
fn constrains_as(old: &Model, new: &Model) -> Result<(), String> {
    let known: BTreeSet<_> = old.dofs().iter().collect();
    if new.dofs().iter().any(|dof| !known.contains(dof)) || old.cases().len() != new.cases().len() {
        return Ok(());
    }
    for (a, b) in old.cases().iter().zip(new.cases()) {
        let given = a.prescribed.iter().filter_map(|given| old.column(given.dof)).map(|j| j as usize);
        let given: Vec<usize> = given.collect();
        let (before, after) = (rank(old, &[(old, a)], &given), rank(old, &[(new, b)], &given));
        let (alone, joined) = (rank(old, &[(old, a)], &[]), rank(old, &[(old, a), (new, b)], &[]));
        let [Some(before), Some(after), Some(alone), Some(joined)] = [before, after, alone, joined] else { continue };
        if before != after || alone != joined {
            return Err(format!("{}: free ranks {before} and {after}, ranks {alone} and {joined}", a.name));
        }
    }
    Ok(())
}

/// The rank of the equations in force, one below the other; `None` if it is in doubt.
fn rank(names: &Model, parts: &[(&Model, &LoadCase)], given: &[usize]) -> Option<usize> {
    let mut builder = SystemBuilder::new(names.dofs().len().max(1));
    for &(model, case) in parts {
        for equation in model.in_force(case).filter_map(|i| model.equation(i)) {
            let largest = equation.coefficients.iter().fold(0.0_f64, |largest, a| largest.max(a.abs()));
            let term = |(&j, &a): (&u32, &f64)| Some((names.column(model.dofs()[j as usize])? as usize, a / largest));
            builder.equation(equation.columns.iter().zip(equation.coefficients).filter_map(term), 0.0);
        }
    }
    given.iter().for_each(|&j| builder.prescribe(j, 0.0));
    let analysis = analyse(&builder.build().ok()?, &Options::default()).ok()?;
    (!analysis.confidence().ambiguous).then(|| analysis.rank())
}
