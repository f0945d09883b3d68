//! Draws decks: a body, and constraint cards that may claim each other's DOFs.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use qless_scenes::Rng;

use crate::body::{FRAMES, GROUND, POINTS, elements, ground_springs, loads};

/// The cards of which a deck is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum DrawnCard {
    Mpc,
    /// An `MPC` of a set that only `MPCADD` selects.
    MpcUnion,
    Rbe2,
    Rbe3,
    /// An `SPC` with the value zero.
    Spc,
    /// An `SPC` with another value.
    Enforced,
    Spc1,
    /// An `SPC1` of a set that only `SPCADD` selects.
    SpcUnion,
    /// An `SPCD` of the load set, with an `SPC1` for its component.
    Spcd,
    /// The component field of a `GRID`.
    Grid,
    /// One of the cards at which MYSTRAN stops: `RBAR`, `RBE1`.
    Stops,
    /// A card that MYSTRAN ignores: `RROD`.
    Ignored,
}

use DrawnCard::{Enforced, Grid, Ignored, Mpc, MpcUnion, Rbe2, Rbe3, Spc, Spc1, SpcUnion, Spcd, Stops};

pub const CARDS: [DrawnCard; 12] =
    [Mpc, MpcUnion, Rbe2, Rbe3, Spc, Enforced, Spc1, SpcUnion, Spcd, Grid, Stops, Ignored];

/// The deck of a seed, with a body of this kind and these two cards; it may draw two more.
pub fn deck(seed: u64, kind: &str, pair: [DrawnCard; 2]) -> String {
    let mut draft = DeckDraft::new(seed);
    pair.into_iter().for_each(|card| draft.draw(card));
    for _ in 0..[0, 0, 1, 2][draft.rng.below(4)] {
        // Cards that make MYSTRAN stop whatever else there is would hide the others.
        let card = CARDS[draft.rng.below(10)];
        draft.draw(card);
    }
    draft.write(kind)
}

/// A deck that is being drawn.
struct DeckDraft {
    rng: Rng,
    cards: Vec<String>,
    /// The sets of `MPC` and of `SPC` cards.
    sets: [BTreeSet<u32>; 2],
    /// The components on `GRID` cards.
    held: BTreeMap<u32, String>,
    /// Components that a card makes dependent or prescribes.
    claims: Vec<(u32, usize)>,
    /// Cards that may be repeated; `#` is the element number.
    repeatable: Vec<(DrawnCard, String)>,
    has_axes: bool,
}

impl DeckDraft {
    fn new(seed: u64) -> Self {
        let mut rng = Rng::new(seed);
        let has_axes = rng.below(3) > 0;
        Self {
            rng,
            cards: Vec::new(),
            sets: [BTreeSet::new(), BTreeSet::new()],
            held: BTreeMap::new(),
            claims: Vec::new(),
            repeatable: Vec::new(),
            has_axes,
        }
    }

    fn draw(&mut self, card: DrawnCard) {
        match card {
            Mpc | MpcUnion | Rbe2 | Rbe3 | Spc | Enforced => self.new_or_again(card),
            Spc1 => self.spc1(1),
            SpcUnion => self.spc1(3),
            Spcd => {
                let (node, component) = self.claim();
                self.sets[1].insert(1);
                self.cards.push(format!("SPC1,1,{component},{node}\n"));
                self.cards.push(format!("SPCD,3,{node},{component},.03\n"));
            }
            Grid => {
                let (node, component) = self.claim();
                let set = self.set_with(component, 2);
                self.held.insert(node, set);
            }
            Stops | Ignored => self.rigid(card),
        }
    }

    fn number(&self) -> usize {
        501 + self.cards.len()
    }

    /// A grid point other than those given, and then one of them too.
    fn point(&mut self, taken: &mut Vec<u32>) -> u32 {
        loop {
            let node = self.rng.below(POINTS.len()) as u32 + 1;
            if !taken.contains(&node) {
                taken.push(node);
                return node;
            }
        }
    }

    /// A component to claim; one in four is claimed already.
    fn claim(&mut self) -> (u32, usize) {
        let is_again = !self.claims.is_empty() && self.rng.below(4) == 0;
        let found = if is_again {
            self.claims[self.rng.below(self.claims.len())]
        } else {
            (self.rng.below(POINTS.len()) as u32 + 1, self.rng.below(6) + 1)
        };
        self.claims.push(found);
        found
    }

    /// A set of components with this one and up to `most` others.
    fn set_with(&mut self, component: usize, most: usize) -> String {
        let mut set = BTreeSet::from([component]);
        (0..self.rng.below(most + 1)).for_each(|_| _ = set.insert(self.rng.below(6) + 1));
        set.iter().map(usize::to_string).collect()
    }

    /// A coefficient of whole eighths.
    fn coefficient(&mut self) -> String {
        format!("{:?}", self.rng.coefficient(30) / 8.0)
    }

    /// A new card; or a repetition, in one of three decks that already have such a card.
    fn new_or_again(&mut self, card: DrawnCard) {
        let known: Vec<usize> = (0..self.repeatable.len()).filter(|&i| self.repeatable[i].0 == card).collect();
        let text = if !known.is_empty() && self.rng.below(3) == 0 {
            self.repeatable[known[self.rng.below(known.len())]].1.clone()
        } else {
            match card {
                Rbe2 => self.rbe2(),
                Rbe3 => self.rbe3(),
                Spc | Enforced => self.spc(card),
                _ => self.mpc(if card == Mpc { 20 } else { 21 }),
            }
        };
        self.cards.push(text.replace('#', &self.number().to_string()));
        self.repeatable.push((card, text));
    }

    fn mpc(&mut self, set: u32) -> String {
        self.sets[0].insert(set);
        let mut seen = BTreeSet::from([self.claim()]);
        let first = *seen.first().expect("a component");
        let count = [0, 1, 1, 2, 2, 2, 3, 3][self.rng.below(8)];
        while seen.len() <= count {
            seen.insert((self.rng.below(POINTS.len()) as u32 + 1, self.rng.below(6) + 1));
        }
        seen.remove(&first);
        let mut text = format!("MPC,{set}");
        for (i, (node, component)) in std::iter::once(first).chain(seen).enumerate() {
            let line = if i > 0 && i % 2 == 0 { "\n," } else { "" };
            write!(text, "{line},{node},{component},{}", self.coefficient()).expect("text");
        }
        text + "\n"
    }

    fn rbe2(&mut self) -> String {
        let (node, component) = self.claim();
        let set = self.set_with(component, 5);
        let mut taken = vec![node];
        let centre = self.point(&mut taken);
        let mut nodes = vec![node.to_string()];
        for _ in 0..self.rng.below(3) {
            let other = self.point(&mut taken);
            self.claims.push((other, component));
            nodes.push(other.to_string());
        }
        format!("RBE2,#,{centre},{set},{}\n", nodes.join(","))
    }

    fn rbe3(&mut self) -> String {
        let (node, component) = self.claim();
        let own = component.to_string();
        let refc = ["123456", "123456", "123456", "123", "123", "12", "456", &own][self.rng.below(8)];
        let mut taken = vec![node];
        let nodes: Vec<String> = (0..3 + self.rng.below(4)).map(|_| self.point(&mut taken).to_string()).collect();
        let (first, rest) = nodes.split_at(2);
        let ci = ["123", "123", "123456", "12"][self.rng.below(4)];
        let second = ["", "2.5,123,", "1.,13,"][self.rng.below(3)];
        format!("RBE3,#,,{node},{refc},.5,{ci},{}\n,{second}{}\n", first.join(","), rest.join(","))
    }

    fn spc(&mut self, card: DrawnCard) -> String {
        let set = 1 + self.rng.below(2) as u32;
        self.sets[1].insert(set);
        let mut text = format!("SPC,{set}");
        for _ in 0..=self.rng.below(2) {
            let (node, component) = self.claim();
            let value = if card == Spc { "0." } else { [".01", "-.02", ".05"][self.rng.below(3)] };
            write!(text, ",{node},{},{value}", self.set_with(component, 1)).expect("text");
        }
        text + "\n"
    }

    fn spc1(&mut self, set: u32) {
        self.sets[1].insert(set);
        let (node, component) = self.claim();
        let components = self.set_with(component, 2);
        let last = node + 1 + self.rng.below(2) as u32;
        let nodes = if self.rng.below(3) == 0 && last as usize <= POINTS.len() {
            format!("{node},THRU,{last}")
        } else {
            format!("{node},{}", self.rng.below(POINTS.len()) + 1)
        };
        self.cards.push(format!("SPC1,{set},{components},{nodes}\n"));
    }

    fn rigid(&mut self, card: DrawnCard) {
        let (b, component) = self.claim();
        let a = self.point(&mut vec![b]);
        let number = self.number();
        self.cards.push(match (card, self.rng.below(2)) {
            (Ignored, _) => format!("RROD,{number},{a},{b},,1\n"),
            (_, 0) => format!("RBAR,{number},{a},{b},123456,,,{component}\n"),
            _ => format!("RBE1,{number},{a},123456\n,UM,{b},{component}\n"),
        });
    }

    /// Writes the deck, with its cards in any order.
    fn write(mut self, kind: &str) -> String {
        let mut control = String::new();
        for (name, union, sets) in [("MPC", 29, &self.sets[0]), ("SPC", 19, &self.sets[1])] {
            let listed: Vec<String> = sets.iter().map(u32::to_string).collect();
            let is_union = sets.len() > 1 || sets.iter().any(|&set| set == 21 || set == 3);
            if is_union {
                self.cards.push(format!("{name}ADD,{union},{}\n", listed.join(",")));
            }
            if let Some(only) = listed.first() {
                control +=
                    &format!("{name} = {}\n", if is_union { "#" } else { only }).replace('#', &union.to_string());
            }
        }
        self.rng.shuffle(&mut self.cards);
        let (grids, cards) = (self.grids(), self.cards.concat());
        let fixed = format!("{GROUND}{FRAMES}{}{}{}", elements(kind), ground_springs(), loads());
        let output = "LOAD = 3\nDISP = ALL\nSPCFORCES = ALL\nMPCFORCES = ALL\nBEGIN BULK\n";
        format!("SOL 101\nCEND\n{control}{output}{grids}{fixed}{cards}ENDDATA\n")
    }

    fn grids(&mut self) -> String {
        let mut text = String::new();
        for (node, [x, y, z]) in (1..).zip(POINTS) {
            // Grid points 1, 2 and 4 define system 13.
            let choices = if [1, 2, 4].contains(&node) { ["", "", "11", "12"] } else { ["", "11", "12", "13"] };
            let axes = if self.has_axes { choices[self.rng.below(4)] } else { "" };
            let held = self.held.get(&node).map_or("", String::as_str);
            writeln!(text, "GRID,{node},,{x:?},{y:?},{z:?},{axes},{held}").expect("text");
        }
        text
    }
}
