//! Sound decks get a random fault and are cleaned again: `ccx` accepts the cleaned deck, with the results of the sound one.

use std::fmt::Write as _;

use qless_io::deck::clean::CleanError;

use super::solver::{cleaned, decks, difference, inputs, is_there, parse, solve, stem};

/// Number of mutations to test.
const WANTED: usize = 200;

/// `splitmix64`.
struct Random(u64);

impl Random {
    fn below(&mut self, most: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % most as u64) as usize
    }
}

/// Node, component and coefficient.
type Term = (u32, u8, f64);

/// A deck as lines, with the positions and terms of its equations.
#[derive(Clone)]
struct Sheet {
    lines: Vec<String>,
    equations: Vec<(std::ops::Range<usize>, Vec<Term>)>,
}

impl Sheet {
    fn of(text: &str) -> Self {
        let lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let mut sheet = Self { lines, equations: Vec::new() };
        let (mut at, mut is_in) = (0, false);
        while at < sheet.lines.len() {
            let line = sheet.lines[at].to_ascii_uppercase().replace(' ', "");
            if line.starts_with('*') {
                is_in = if line.starts_with("**") { is_in } else { line == "*EQUATION" };
                at += 1;
            } else if is_in {
                let Some((range, terms)) = sheet.equation(at) else { break };
                at = range.end;
                sheet.equations.push((range, terms));
            } else {
                at += 1;
            }
        }
        sheet
    }

    /// The equation that begins at a line; `None` unless it has plain numbers only.
    fn equation(&self, at: usize) -> Option<(std::ops::Range<usize>, Vec<Term>)> {
        let count: usize = self.lines[at].split(',').next()?.trim().parse().ok()?;
        let (mut terms, mut end) = (Vec::new(), at + 1);
        while terms.len() < count {
            let fields: Vec<&str> = self.lines.get(end)?.split(',').map(str::trim).filter(|f| !f.is_empty()).collect();
            for term in fields.chunks(3) {
                let [node, component, coefficient] = term else { return None };
                terms.push((node.parse().ok()?, component.parse().ok()?, coefficient.parse().ok()?));
            }
            end += 1;
        }
        Some((at..end, terms))
    }

    /// The text with an equation's lines replaced.
    fn with(&self, which: usize, terms: &[Term]) -> Self {
        let mut lines = self.lines.clone();
        lines.splice(self.equations[which].0.clone(), written(terms));
        Self::of(&lines.join("\n"))
    }

    /// The text with one more equation after the last.
    fn and(&self, terms: &[Term]) -> Self {
        let end = self.equations.iter().map(|(range, _)| range.end).max().unwrap_or(0);
        let mut lines = self.lines.clone();
        lines.splice(end..end, written(terms));
        Self::of(&lines.join("\n"))
    }

    fn text(&self) -> String {
        self.lines.join("\n") + "\n"
    }

    /// The last step repeated, with these lines at its start.
    fn second_step(&self, more: &str) -> Option<Self> {
        let is = |line: &String, word: &str| line.to_ascii_uppercase().starts_with(word);
        let start = self.lines.iter().rposition(|line| is(line, "*STEP"))?;
        let end = self.lines.iter().rposition(|line| is(line, "*END STEP"))?;
        let mut lines = self.lines[..=end].to_vec();
        lines.push(self.lines[start].clone());
        lines.extend(more.lines().map(str::to_owned));
        lines.extend_from_slice(&self.lines[start + 1..=end]);
        Some(Self::of(&lines.join("\n")))
    }

    /// A value before the first step.
    fn prescribing(&self, (node, component, _): Term) -> Option<Self> {
        let start = self.lines.iter().position(|line| line.to_ascii_uppercase().starts_with("*STEP"))?;
        let mut lines = self.lines.clone();
        lines.splice(start..start, ["*BOUNDARY".to_owned(), format!("{node},{component},{component}")]);
        Some(Self::of(&lines.join("\n")))
    }
}

fn written(terms: &[Term]) -> Vec<String> {
    let mut lines = vec![terms.len().to_string()];
    for part in terms.chunks(4) {
        let mut line = String::new();
        part.iter().for_each(|(node, component, a)| write!(line, "{node},{component},{a:?},").expect("a string"));
        lines.push(line.trim_end_matches(',').to_owned());
    }
    lines
}

/// `a e + b f`, in the order of their DOFs.
fn sum(a: f64, e: &[Term], b: f64, f: &[Term]) -> Vec<Term> {
    let mut terms: Vec<Term> = e.iter().map(|&(n, c, x)| (n, c, a * x)).collect();
    for &(n, c, x) in f {
        match terms.iter_mut().find(|term| (term.0, term.1) == (n, c)) {
            Some(term) => term.2 += b * x,
            None => terms.push((n, c, b * x)),
        }
    }
    terms.retain(|term| term.2 != 0.0);
    terms
}

/// The lines that remove an equation in a step.
fn taken_back(equation: &[Term]) -> String {
    let (node, component, _) = equation[0];
    format!("*EQUATION, REMOVE\n{node},{component},{component}")
}

/// A sound deck and its faulty copy; `None` if this fault is impossible for the deck.
fn spoiled(sheet: &Sheet, kind: usize, random: &mut Random) -> Option<(Sheet, Sheet)> {
    let count = sheet.equations.len();
    let (i, k) = (random.below(count), random.below(count));
    let (e, f) = (&sheet.equations[i].1, &sheet.equations[k].1);
    let factor = [2.0, -1.0, 0.5, 3.0][random.below(4)];
    let repeated = sum(factor, e, 0.0, &[]);
    // The deck itself removes the equation by its slave, which therefore must not change.
    let takes_back = sheet.lines.iter().any(|line| line.to_ascii_uppercase().contains("REMOVE"));
    if takes_back && [2, 3, 6].contains(&kind) {
        return None;
    }
    let combined = || (i != k).then(|| sum(factor, e, 1.5, f)).filter(|terms| !terms.is_empty());
    match kind {
        0 => Some((sheet.clone(), sheet.and(&repeated))),
        1 => Some((sheet.clone(), sheet.and(&combined()?))),
        2 => {
            let mut turned = e.clone();
            turned.rotate_left(1 + random.below(e.len().max(2) - 1));
            Some((sheet.clone(), sheet.with(i, &turned)))
        }
        3 => {
            // The slave is prescribed; in the sound deck another DOF becomes the slave.
            let mut turned = e.clone();
            turned.rotate_left(1);
            Some((sheet.with(i, &turned).prescribing(e[0])?, sheet.prescribing(e[0])?))
        }
        4 => Some((sheet.second_step("")?, sheet.and(&repeated).second_step("")?)),
        5 => Some((sheet.second_step(&taken_back(e))?, sheet.and(&repeated).second_step(&taken_back(e))?)),
        _ => {
            // Cleaning must rewrite an equation while the second step removes another.
            let mut turned = f.clone();
            turned.rotate_left(1);
            let good = sheet.with(k, &turned).prescribing(f[0])?.second_step(&taken_back(e))?;
            (i != k).then_some((good, sheet.prescribing(f[0])?.second_step(&taken_back(e))?))
        }
    }
}

/// A block of bricks on supports with a load, and random equations between free DOFs, each with a slave of its own.
fn own(seed: u64) -> String {
    let mut random = Random(seed);
    let (nx, mut text) = (2 + random.below(3) as u32, "*NODE, NSET=NALL\n".to_owned());
    let at = |i: u32, j: u32, k: u32| 1 + i + (nx + 1) * (j + 2 * k);
    for (i, j, k) in (0..2).flat_map(|k| (0..2).flat_map(move |j| (0..=nx).map(move |i| (i, j, k)))) {
        writeln!(text, "{},{i}.,{j}.,{k}.", at(i, j, k)).expect("a string");
    }
    text += "*ELEMENT, TYPE=C3D8, ELSET=EALL\n";
    for i in 0..nx {
        let ring = |k| [at(i, 0, k), at(i + 1, 0, k), at(i + 1, 1, k), at(i, 1, k)].map(|n| n.to_string()).join(",");
        writeln!(text, "{},{},{}", i + 1, ring(0), ring(1)).expect("a string");
    }
    text += "*MATERIAL, NAME=EL\n*ELASTIC\n1000.,0.3\n*SOLID SECTION, ELSET=EALL, MATERIAL=EL\n*BOUNDARY\n";
    (0..2).flat_map(|j| (0..2).map(move |k| (j, k))).for_each(|(j, k)| _ = writeln!(text, "{},1,3", at(0, j, k)));
    let mut free: Vec<(u32, u8)> = (1..=nx)
        .flat_map(|i| (0..4).map(move |jk| at(i, jk % 2, jk / 2)))
        .flat_map(|node| (1..=3).map(move |c| (node, c)))
        .collect();
    text += "*EQUATION\n";
    for _ in 0..3 + random.below(3) {
        let slave = free.swap_remove(random.below(free.len()));
        let mut terms = vec![(slave.0, slave.1, 1.0)];
        for _ in 0..=random.below(3) {
            // Masters are never slaves of others, so they come first.
            let master = free[random.below(free.len() / 2)];
            let a = [-1.0, 0.5, -2.0, 0.25][random.below(4)];
            terms = sum(1.0, &terms, 1.0, &[(master.0, master.1, a)]);
        }
        free.retain(|dof| !terms[1..].iter().any(|term| (term.0, term.1) == *dof));
        text += &(written(&terms).join("\n") + "\n");
    }
    let end = at(nx, 1, 1);
    text + &format!("*STEP\n*STATIC\n*CLOAD\n{end},1,10.\n{end},3,-4.\n*NODE PRINT, NSET=NALL\nU\n*END STEP\n")
}

/// Sound decks with equations in plain numbers that `ccx` runs within a second: those of the corpus, and our own.
fn sound() -> Vec<(String, Sheet)> {
    let slow =
        ["couette2", "couette5", "dyncubeexp", "impdyn", "rotor3", "chain_16000", "chainrev_16000", "dense_row_3000"];
    let folders = ["plain-equation", "calculix-behaviour"].into_iter().filter_map(decks);
    let files = folders.flat_map(|folder| inputs(&folder)).filter(|path| !slow.contains(&stem(path)));
    let read = |path: std::path::PathBuf| Some((stem(&path).to_owned(), std::fs::read_to_string(&path).ok()?));
    let ours = (0..40).map(|seed| (format!("own {seed}"), own(seed)));
    let all = files.filter_map(read).chain(ours).map(|(name, text)| (name, Sheet::of(&text)));
    all.filter(|(_, sheet)| !sheet.equations.is_empty()).collect()
}

/// Allowed difference of results: nonlinear steps end with a nonzero residual.
fn tolerance(text: &str) -> f64 {
    let text = text.to_ascii_uppercase();
    let is_iterated = ["NLGEOM", "CONTACT", "DYNAMIC", "PLASTIC"].iter().any(|word| text.contains(word));
    if is_iterated { 1e-3 } else { 1e-6 }
}

#[test]
fn spoiled_decks_give_the_results_of_sound_ones() {
    if !is_there() {
        return;
    }
    let (decks, mut random) = (sound(), Random(1));
    let mut of_kind = [0; 7];
    let (mut done, mut stopped, mut used, mut refused) = (0, 0, std::collections::BTreeSet::new(), Vec::new());
    for turn in 0.. {
        assert!(turn < 20 * WANTED, "only {done} mutations were possible");
        let (name, sheet) = &decks[turn % decks.len()];
        let kind = random.below(7);
        let Some((good, bad)) = spoiled(sheet, kind, &mut random) else { continue };
        let Some(expected) = solve(good.text().as_bytes()).filter(|printed| printed.len() > 20) else { continue };
        let what = format!("{name}, mutation {kind}, turn {turn}:\n{}", bad.text());
        match cleaned(&parse(bad.text().as_bytes())) {
            Ok(text) => {
                let found =
                    solve(&text).unwrap_or_else(|| panic!("ccx refuses {what}\n{}", String::from_utf8_lossy(&text)));
                let apart = difference(&expected, &found);
                assert!(apart < tolerance(&bad.text()), "{apart:e} {what}\n{}", String::from_utf8_lossy(&text));
            }
            Err(CleanError::Deck(error)) => panic!("{error} {what}"),
            Err(error) => {
                refused.push(format!("{name}, mutation {kind}: {error}"));
                continue;
            }
        }
        used.insert(name.clone());
        of_kind[kind] += 1;
        // One in four faulty decks is run too.
        stopped += usize::from(done % 4 == 0 && solve(bad.text().as_bytes()).is_none());
        done += 1;
        if done == WANTED {
            break;
        }
    }
    println!("{done} mutations of {} decks, {} refused:\n{}", used.len(), refused.len(), refused.join("\n"));
    assert!(of_kind.iter().all(|&count| count >= WANTED / 20), "some mutations were hardly possible: {of_kind:?}");
    assert!(stopped > WANTED / 8, "ccx took most of the spoiled decks: {stopped} of {} stopped it", WANTED / 4);
    assert!(used.len() >= 40 && refused.len() * 20 < WANTED, "{} decks, refused: {refused:#?}", used.len());
}
