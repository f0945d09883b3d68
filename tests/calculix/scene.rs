//! Small decks in which cards claim the same DOF: direction 3 of nodes 11, 15, 16, 17 and 18 of a brick.
//! Every claim moves its slave by a different distance, so the result shows which claim is in force.

use std::fmt::Write;
use std::ops::Range;

/// A card that makes component 3 of a node a slave; some do the same with components 1 and 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Equation,
    Tie,
    Kinematic,
    /// With `ORIENTATION`.
    Oriented,
    RigidBody,
    DistributingCoupling,
    Plane,
    Beam,
    Straight,
}

pub const KINDS: [Kind; 9] = [
    Kind::Equation,
    Kind::Tie,
    Kind::Kinematic,
    Kind::Oriented,
    Kind::RigidBody,
    Kind::DistributingCoupling,
    Kind::Plane,
    Kind::Beam,
    Kind::Straight,
];

/// Position of a prescribed value in the deck.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum At {
    /// Before the claims.
    Before,
    /// After the claims.
    After,
    /// In a step, from 1.
    Step(usize),
}

/// The effect of a claim on component 3 of a node.
#[derive(Clone, Copy, Debug)]
pub enum Says {
    Is(f64),
    Follows(u32),
}

/// A claim of a deck: its lines and its effect; a value holds from a step on.
#[derive(Clone, Debug)]
pub struct Claim {
    pub lines: Range<u32>,
    pub node: u32,
    pub says: Says,
    pub from: usize,
    pub is_value: bool,
}

/// Builds a deck.
#[derive(Default)]
pub struct Scene {
    nodes: String,
    elements: String,
    sets: String,
    held: String,
    moved: String,
    cards: Vec<(String, u32, Says)>,
    values: Vec<(At, u32, f64)>,
    /// Other lines: at the end of the model, and of each of the steps.
    pub model: String,
    pub steps: Vec<String>,
    pub is_nonlinear: bool,
    /// Whether each later step starts with `OP=NEW` and the supports of the claims' own nodes.
    pub begins_anew: bool,
    count: u32,
}

const CORNERS: [[f64; 3]; 8] =
    [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.], [0., 0., 1.], [1., 0., 1.], [1., 1., 1.], [0., 1., 1.]];

/// Coordinates of a node of the brick.
fn place(node: u32) -> [f64; 3] {
    let [x, y, z] = CORNERS[node as usize - 11];
    [x + 0.3, y + 0.2, z + 1.0]
}

impl Scene {
    /// With so many steps.
    pub fn new(steps: usize) -> Self {
        Self { steps: vec![String::new(); steps], ..Self::default() }
    }

    fn node(&mut self, number: u32, [x, y, z]: [f64; 3]) {
        writeln!(self.nodes, "{number},{x},{y},{z}").expect("text");
    }

    fn brick(&mut self, first: u32, [x, y, z]: [f64; 3]) {
        let corners: Vec<String> = (0..8).map(|k| (first + k).to_string()).collect();
        writeln!(self.elements, "*ELEMENT, TYPE=C3D8, ELSET=EALL\n{first},{}", corners.join(",")).expect("text");
        for (k, [a, b, c]) in (0..).zip(CORNERS) {
            self.node(first + k, [x + a, y + b, z + c]);
        }
    }

    /// A node that is moved in direction 3 and fixed in the others.
    fn master(&mut self, number: u32, at: [f64; 3], value: f64) {
        self.node(number, at);
        self.drive(number, value);
    }

    fn drive(&mut self, number: u32, value: f64) {
        writeln!(self.held, "{number},1,2").expect("text");
        writeln!(self.moved, "{number},3,3,{value}").expect("text");
    }

    /// Adds a card that claims component 3 of a node; returns the first number of the claim's own nodes.
    pub fn claim(&mut self, kind: Kind, node: u32) -> u32 {
        let (n, v) = (1000 + 20 * self.count, 0.011 + 0.003 * f64::from(self.count));
        self.count += 1;
        let [x, y, z] = place(node);
        let one = |text: &str| text.replace('#', &n.to_string()).replace('@', &node.to_string());
        let coupling = "*COUPLING, REF NODE=#, SURFACE=S#, CONSTRAINT NAME=C#\n*KINEMATIC\n3,3\n";
        let text = match kind {
            Kind::Equation => one("*EQUATION\n2\n@,3,1.,#,3,-1.\n"),
            Kind::Tie => one("*TIE, NAME=T#, POSITION TOLERANCE=.05, ADJUST=NO\nS#,M#\n"),
            Kind::Kinematic => one(coupling),
            Kind::Oriented => one(&coupling.replace("*COUPLING,", "*COUPLING, ORIENTATION=O#,")),
            Kind::RigidBody => format!("*RIGID BODY, NSET=N{n}, REF NODE={n}, ROT NODE={}\n", n + 1),
            Kind::DistributingCoupling => one("*DISTRIBUTING COUPLING, ELSET=D#\n@,1.\n"),
            Kind::Plane => format!("*MPC\nPLANE,{n},{},{},{node}\n", n + 1, n + 2),
            Kind::Beam => format!("*MPC\nBEAM,{node},{n}\n"),
            Kind::Straight => format!("*MPC\nSTRAIGHT,{n},{},{node}\n", n + 1),
        };
        self.sets += &one("*NSET, NSET=N#\n@\n*SURFACE, NAME=S#, TYPE=NODE\n@\n");
        match kind {
            Kind::Tie => {
                self.brick(n, [x - 0.3, y - 0.2, z - 1.0]);
                (n..n + 4).for_each(|k| writeln!(self.held, "{k},1,3").expect("text"));
                (n + 4..n + 8).for_each(|k| self.drive(k, v));
                self.sets += &one("*SURFACE, NAME=M#\n#,S2\n");
            }
            Kind::Plane => {
                self.master(n, [x - 1.0, y - 1.0, z], v);
                self.master(n + 1, [x + 2.0, y - 1.0, z], v);
                self.master(n + 2, [x, y + 2.0, z], v);
            }
            Kind::Straight => {
                self.master(n, [x - 2.0, y, z], v);
                self.master(n + 1, [x + 2.0, y, z], v);
            }
            Kind::Beam => self.master(n, [x, y, z + 2.0], v),
            _ => self.master(n, [x, y, z], v),
        }
        match kind {
            Kind::Kinematic | Kind::Oriented => writeln!(self.held, "{n},4,6").expect("text"),
            Kind::RigidBody => {
                self.node(n + 1, [x, y, z]);
                writeln!(self.held, "{},1,3", n + 1).expect("text");
            }
            Kind::DistributingCoupling => self.elements += &one("*ELEMENT, TYPE=DCOUP3D, ELSET=D#\n#,#\n"),
            _ => {}
        }
        if kind == Kind::Oriented {
            self.sets += &one("*ORIENTATION, NAME=O#\n1.,0.,0.,0.,1.,0.\n");
        }
        self.cards.push((text, node, Says::Is(v)));
        n
    }

    /// `*EQUATION`: one node follows another.
    pub fn link(&mut self, node: u32, master: u32) {
        self.cards.push((format!("*EQUATION\n2\n{node},3,1.,{master},3,-1.\n"), node, Says::Follows(master)));
    }

    /// Prescribes a node's component 3.
    pub fn value(&mut self, at: At, node: u32, value: f64) {
        self.values.push((at, node, value));
    }

    /// The deck, and its claims in the order of their lines.
    pub fn write(mut self) -> (String, Vec<Claim>) {
        self.brick(11, place(11));
        let mut text = Text::default();
        let first = format!("*NODE, NSET=NALL\n{}{}{}", self.nodes, self.elements, self.sets);
        text.add(&first);
        text.add("*NSET, NSET=FREE\n11,15,16,17,18\n*MATERIAL, NAME=EL\n*ELASTIC\n210000.,0.3\n");
        text.add("*SOLID SECTION, ELSET=EALL, MATERIAL=EL\n");
        let held = format!("12,1,3\n13,1,3\n14,1,3\n{}", self.held);
        text.add(&format!("*BOUNDARY\n{held}"));
        text.values(&self.values, At::Before);
        for (card, node, says) in &self.cards {
            text.claim(card, Claim { lines: 0..0, node: *node, says: *says, from: 0, is_value: false });
        }
        text.values(&self.values, At::After);
        text.add(&self.model);
        for (k, extra) in self.steps.iter().enumerate() {
            text.add(if self.is_nonlinear { "*STEP, NLGEOM\n*STATIC\n" } else { "*STEP\n*STATIC\n" });
            if k == 0 && !self.moved.is_empty() {
                text.add(&format!("*BOUNDARY\n{}", self.moved));
            }
            if k > 0 && self.begins_anew {
                text.add(&format!("*BOUNDARY, OP=NEW\n{held}{}", self.moved));
            }
            text.values(&self.values, At::Step(k + 1));
            text.add(extra);
            text.add("*CLOAD\n15,3,10.\n*NODE PRINT, NSET=FREE\nU\n*END STEP\n");
        }
        (text.text, text.claims)
    }
}

/// Text whose lines are counted.
#[derive(Default)]
struct Text {
    text: String,
    claims: Vec<Claim>,
}

impl Text {
    fn line(&self) -> u32 {
        self.text.matches('\n').count() as u32 + 1
    }

    fn add(&mut self, text: &str) {
        self.text += text;
    }

    fn claim(&mut self, text: &str, mut claim: Claim) {
        let first = self.line();
        self.add(text);
        claim.lines = first..self.line();
        self.claims.push(claim);
    }

    fn values(&mut self, values: &[(At, u32, f64)], here: At) {
        for &(_, node, value) in values.iter().filter(|(at, ..)| *at == here) {
            let from = if let At::Step(k) = here { k - 1 } else { 0 };
            let claim = Claim { lines: 0..0, node, says: Says::Is(value), from, is_value: true };
            self.claim(&format!("*BOUNDARY\n{node},3,3,{value}\n"), claim);
        }
    }
}
