//! Random consistent decks: what is written back holds for the same displacements.

use std::fmt::Write;

use proptest::prelude::*;
use qless::{Noise, Options, SystemBuilder, analyse};
use qless_io::deck::clean;
use qless_io::deck::{Deck, Dof};

use crate::parse::{deck, in_force, prescribed, refused};

const LABELS: [&str; 3] = ["UX", "ROTZ", "TEMP"];

/// One displacement that all commands agree with: the same for all nodes.
fn value(label: usize) -> f64 {
    [0.5, -2.0, 3.0][label]
}

/// Node, label and coefficient of each term.
type Terms = Vec<(u32, usize, i32)>;

#[derive(Clone, Debug)]
enum Said {
    Equation(Terms),
    Archived(Terms),
    Coupled(usize, Vec<u32>),
    Prescribed(u32, usize),
}

fn said() -> impl Strategy<Value = Said> {
    let terms = || prop::collection::vec((1_u32..6, 0_usize..3, prop_oneof![-3..=-1, 1..=3]), 1..5);
    prop_oneof![
        3 => terms().prop_map(Said::Equation),
        3 => terms().prop_map(Said::Archived),
        2 => (0_usize..3, prop::collection::vec(1_u32..6, 2..4)).prop_map(|(label, nodes)| Said::Coupled(label, nodes)),
        2 => (1_u32..6, 0_usize..3).prop_map(|(node, label)| Said::Prescribed(node, label)),
    ]
}

fn text(said: &[Said]) -> String {
    let mut text = String::from("/PREP7\n");
    for (number, said) in (1..).zip(said) {
        match said {
            Said::Equation(terms) => commands(&mut text, number, terms),
            Said::Archived(terms) => archived(&mut text, number, terms),
            Said::Coupled(label, nodes) => {
                let nodes: Vec<String> = nodes.iter().map(u32::to_string).collect();
                writeln!(text, "CP,{number},{},{}", LABELS[*label], nodes.join(",")).expect("written");
            }
            Said::Prescribed(node, label) => {
                writeln!(text, "D,{node},{},{:?}", LABELS[*label], value(*label)).expect("written");
            }
        }
    }
    text + "FINISH\n"
}

fn constant(terms: &Terms) -> f64 {
    terms.iter().map(|&(_, label, coefficient)| f64::from(coefficient) * value(label)).sum()
}

fn commands(text: &mut String, number: u32, terms: &Terms) {
    for terms_of_line in terms.chunks(3) {
        write!(text, "CE,{number},{:?}", constant(terms)).expect("written");
        for &(node, label, coefficient) in terms_of_line {
            write!(text, ",{node},{},{coefficient}", LABELS[label]).expect("written");
        }
        text.push('\n');
    }
}

fn archived(text: &mut String, number: u32, terms: &Terms) {
    writeln!(text, "CE,R5.0,DEFI,{},{number},{:?}", terms.len(), constant(terms)).expect("written");
    for &(node, label, coefficient) in terms {
        writeln!(text, "CE,R5.0,NODE,{node},{},{coefficient}.0", LABELS[label]).expect("written");
    }
}

/// The rank of the equations of all decks together, with the prescribed DOFs of the first.
fn rank(decks: &[&Deck]) -> usize {
    let mut dofs: Vec<Dof> = decks.iter().flat_map(|deck| deck.model().dofs().iter().copied()).collect();
    dofs.sort_unstable();
    dofs.dedup();
    let column = |dof: &Dof| dofs.binary_search(dof);
    let mut builder = SystemBuilder::new(dofs.len().max(1));
    for model in decks.iter().map(|deck| deck.model()) {
        for equation in (0..model.equations()).map(|i| model.equation(i).expect("an equation")) {
            let terms = equation.columns.iter().map(|&j| column(&model.dofs()[j as usize]).expect("known"));
            builder.equation(terms.zip(equation.coefficients.iter().copied()), 0.0);
        }
    }
    for given in &decks[0].model().cases()[0].prescribed {
        column(&given.dof).into_iter().for_each(|j| builder.prescribe(j, 0.0));
    }
    // Weights of two decks, computed in another order.
    let options = Options { noise: Noise::Relative(1e-10), ..Options::default() };
    analyse(&builder.build().expect("a system"), &options).expect("analysed").rank()
}

/// Whether the displacement that all commands agree with fulfils every equation, but for rounding.
fn holds(deck: &Deck) -> bool {
    let model = deck.model();
    let labels = [1, 6, 11];
    let value =
        |j: u32| labels.iter().position(|label| *label == model.dofs()[j as usize].component).map_or(f64::NAN, value);
    (0..model.equations()).map(|i| model.equation(i).expect("an equation")).all(|equation| {
        let terms = || equation.columns.iter().zip(equation.coefficients).map(|(&j, a)| a * value(j));
        let scale: f64 = terms().map(f64::abs).sum();
        (terms().sum::<f64>() - equation.rhs).abs() <= 1e-12 * scale.max(1.0)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, ..ProptestConfig::default() })]

    #[test]
    fn a_cleaned_deck_says_the_same(said in prop::collection::vec(said(), 1..12)) {
        let before = deck(&text(&said));
        let plan = clean::plan(&before, &Options::default()).expect("consistent");
        let result = clean::write(&before, &plan).expect("written");
        let after = deck(std::str::from_utf8(&result).expect("text"));
        prop_assert!(holds(&before) && holds(&after));
        prop_assert!(refused(&after).is_empty());
        // What ANSYS accepts stays as it is.
        let is_sound = refused(&before).is_empty() && before.model().equations() == rank(&[&before]);
        prop_assert_eq!(plan.is_empty(), is_sound);
        prop_assert!(clean::plan(&after, &Options::default()).expect("consistent").is_empty());
        prop_assert_eq!(after.model().equations(), rank(&[&before]));
        prop_assert_eq!(rank(&[&after]), after.model().equations());
        prop_assert_eq!(rank(&[&before, &after]), after.model().equations());
    }
}

/// What holds in each load case: the equations and the prescribed values.
fn cases(deck: &Deck) -> Vec<(Vec<String>, Vec<String>)> {
    (0..deck.model().cases().len()).map(|case| (in_force(deck, case), prescribed(deck, case))).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    /// The models of a deck are those of its parts. If any part is solved, those that are deleted unsolved do not count.
    #[test]
    fn clear_separates_models(parts in prop::collection::vec((prop::collection::vec(said(), 1..8), any::<bool>()), 1..5)) {
        let texts: Vec<String> = parts
            .iter()
            .map(|(said, is_solved)| text(said) + if *is_solved { "/SOLU\nSOLVE\nCEDELE,1\nD,1,UX,9\nSOLVE\nFINISH\n" } else { "" })
            .collect();
        let is_any_solved = parts.iter().any(|(_, is_solved)| *is_solved);
        let counts = |k: usize| parts[k].1 || k + 1 == parts.len() || !is_any_solved;
        let alone: Vec<_> = (0..parts.len()).filter(|&k| counts(k)).flat_map(|k| cases(&deck(&texts[k]))).collect();
        prop_assert_eq!(cases(&deck(&texts.join("/CLEAR,NOSTART\n"))), alone);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    /// After `RESUME`, the deck continues as if it had never left the place of `SAVE`.
    #[test]
    fn resume_returns_to_save(parts in prop::array::uniform3(prop::collection::vec(said(), 1..6)), is_solved in any::<bool>()) {
        let [first, second, third] = parts.map(|said| text(&said));
        let second = second + if is_solved { "/SOLU\nSOLVE\n" } else { "" };
        let mut alone = cases(&deck(&format!("{first}{second}")));
        alone.extend(cases(&deck(&format!("{first}{third}"))));
        prop_assert_eq!(cases(&deck(&format!("{first}SAVE\n{second}RESUME\n{third}"))), alone);
    }
}

/// Where node k is; nodes 1 to 5.
const PLACES: [[i32; 3]; 5] = [[0, 0, 0], [2, 0, 0], [0, 3, 1], [-1, 2, 4], [1, 1, -2]];
const SPATIAL: [&str; 6] = ["UX", "UY", "UZ", "ROTX", "ROTY", "ROTZ"];

/// Commands that one rigid motion fulfils, whatever they are about.
#[derive(Clone, Debug)]
enum Moved {
    /// `CERIG` of two nodes, with labels.
    Rigid(u32, u32, &'static str),
    /// `RBE3` of a node and the others, with labels and weights.
    Mean(u32, &'static str, Vec<u32>),
    /// A node's component that is prescribed to what the motion gives.
    Prescribed(u32, usize),
    /// Two rotations that are the same.
    Coupled(u32, u32, usize),
    /// The rotations of nodes from the first to the last, in a loop, equal to that of node 1.
    Loop(u32, u32, usize),
    /// The difference of two nodes in one component, with a parameter as its coefficient.
    Difference(u32, u32, usize, u32),
}

fn moved() -> impl Strategy<Value = Moved> {
    let node = || 1_u32..6;
    let labels = prop::sample::select(vec!["ALL", "UXYZ", "RXYZ", "UX", "UY,ROTZ", "ROTX", ""]);
    let means = prop::sample::select(vec!["ALL", "UXYZ", "RXYZ", "UZ", "ROTY"]);
    prop_oneof![
        4 => (node(), node(), labels).prop_map(|(master, slave, labels)| Moved::Rigid(master, slave, labels)),
        2 => (node(), means, prop::collection::vec(1_u32..4, 4)).prop_map(|(node, dof, weights)| Moved::Mean(node, dof, weights)),
        3 => (node(), 0_usize..6).prop_map(|(node, label)| Moved::Prescribed(node, label)),
        1 => (node(), node(), 3_usize..6).prop_map(|(a, b, label)| Moved::Coupled(a, b, label)),
        1 => (2_u32..4, 3_u32..6, 3_usize..6).prop_map(|(first, last, label)| Moved::Loop(first, last, label)),
        1 => (node(), node(), 0_usize..6, 1_u32..4).prop_map(|(a, b, label, w)| Moved::Difference(a, b, label, w)),
    ]
}

/// The displacement of a node under `t + w x r`.
fn motion(node: u32, label: usize) -> f64 {
    let (t, w) = ([0.5, -2.0, 3.0], [0.25, 1.0, -0.5]);
    let r = PLACES[node as usize - 1].map(f64::from);
    match label {
        0..3 => t[label] + w[(label + 1) % 3] * r[(label + 2) % 3] - w[(label + 2) % 3] * r[(label + 1) % 3],
        _ => w[label - 3],
    }
}

fn moved_text(commands: &[Moved]) -> String {
    let mut text = String::from("/PREP7\n");
    for (node, [x, y, z]) in (1..).zip(PLACES) {
        writeln!(text, "N,{node},{x},{y},{z}").expect("written");
    }
    for command in commands {
        match command {
            Moved::Rigid(master, slave, labels) if master != slave => writeln!(text, "CERIG,{master},{slave},{labels}"),
            Moved::Rigid(master, ..) => writeln!(text, "CERIG,{master},ALL,UXYZ"),
            Moved::Mean(node, dof, weights) => {
                let others: Vec<String> = (1..6).filter(|other| other != node).map(|other| other.to_string()).collect();
                let weights: Vec<String> = weights.iter().map(u32::to_string).collect();
                let (others, weights) = (others.join(","), weights.join(","));
                writeln!(text, "*DIM,S,,4\n*DIM,W,,4\nS(1)={others}\nW(1)={weights}\nRBE3,{node},{dof},S(1),W(1)")
            }
            Moved::Prescribed(node, label) => {
                writeln!(text, "D,{node},{},{:?}", SPATIAL[*label], motion(*node, *label))
            }
            Moved::Coupled(a, b, label) => writeln!(text, "CP,NEXT,{},{a},{b}", SPATIAL[*label]),
            Moved::Loop(first, last, label) => {
                let label = SPATIAL[*label];
                writeln!(text, "*DO,I,{first},{last}\nCE,NEXT,0,I,{label},1,1,{label},-1\n*ENDDO")
            }
            Moved::Difference(a, b, label, w) => {
                let gap = motion(*a, *label) - motion(*b, *label);
                let label = SPATIAL[*label];
                writeln!(text, "K={w}\nCE,NEXT,{gap:?}*K,{a},{label},K,{b},{label},-K")
            }
        }
        .expect("written");
    }
    text + "FINISH\n"
}

/// Whether the rigid motion fulfils every equation, but for rounding.
fn moves_rigidly(deck: &Deck) -> bool {
    let model = deck.model();
    (0..model.equations()).map(|i| model.equation(i).expect("an equation")).all(|equation| {
        let value = |j: u32| motion(model.dofs()[j as usize].node, usize::from(model.dofs()[j as usize].component) - 1);
        let terms = || equation.columns.iter().zip(equation.coefficients).map(|(&j, a)| a * value(j));
        let scale: f64 = terms().map(f64::abs).sum();
        (terms().sum::<f64>() - equation.rhs).abs() <= 1e-9 * scale.max(1.0)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn cleaned_regions_move_as_before(commands in prop::collection::vec(moved(), 1..8)) {
        let before = deck(&moved_text(&commands));
        prop_assert_eq!(before.model().left_out().count(), 0);
        prop_assert!(moves_rigidly(&before));
        let plan = clean::plan(&before, &Options::default()).expect("consistent");
        let result = clean::write(&before, &plan).expect("written");
        let after = deck(std::str::from_utf8(&result).expect("text"));
        prop_assert!(moves_rigidly(&after));
        prop_assert!(refused(&after).is_empty());
        prop_assert!(clean::plan(&after, &Options::default()).expect("consistent").is_empty());
        prop_assert_eq!(rank(&[&before]), after.model().equations());
        prop_assert_eq!(rank(&[&before, &after]), after.model().equations());
    }
}
