//! Random consistent decks: what is written back holds for the same displacements.

use std::fmt::Write;

use proptest::prelude::*;
use qless::{Options, SystemBuilder, analyse};
use qless_io::deck::clean::{self, faults};
use qless_io::deck::{Deck, Dof};

use crate::parse::deck;

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
    analyse(&builder.build().expect("a system"), &Options::default()).expect("analysed").rank()
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
        prop_assert!(faults(after.model()).is_empty());
        prop_assert!(clean::plan(&after, &Options::default()).expect("consistent").is_empty());
        prop_assert_eq!(after.model().equations(), rank(&[&before]));
        prop_assert_eq!(rank(&[&after]), after.model().equations());
        prop_assert_eq!(rank(&[&before, &after]), after.model().equations());
    }
}
