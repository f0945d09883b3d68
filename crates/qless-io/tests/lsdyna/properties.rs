//! Laws on random decks.

use std::fmt::Write;

use qless::{Elimination, Options};
use qless_io::deck::{Dof, Model};
use qless_scenes::Rng;

use super::from_text::{analysis, equations, model, parsed_with, prescribed, system};

const COUNT: u64 = 300;

/// Nodes 1 to `count` at random.
fn nodes(count: usize, rng: &mut Rng) -> (String, Vec<[f64; 3]>) {
    let mut coordinate = || (rng.below(20_001) as f64 - 10_000.0) / 1000.0;
    let positions: Vec<[f64; 3]> = (0..count).map(|_| [coordinate(), coordinate(), coordinate()]).collect();
    let line = |(k, [x, y, z]): (usize, &[f64; 3])| format!("{:>8}{x:>16.3}{y:>16.3}{z:>16.3}\n", k + 1);
    (format!("*NODE\n{}", positions.iter().enumerate().map(line).collect::<String>()), positions)
}

/// Displacement and rotation of a point under a rigid motion about the origin.
fn moved([x, y, z]: [f64; 3], [tx, ty, tz]: [f64; 3], w: [f64; 3]) -> [f64; 6] {
    [tx + w[1] * z - w[2] * y, ty + w[2] * x - w[0] * z, tz + w[0] * y - w[1] * x, w[0], w[1], w[2]]
}

/// Largest residual of the equations under a rigid motion. References of bodies move with the body that they stand for.
fn residual(model: &Model, positions: &[[f64; 3]], t: [f64; 3], w: [f64; 3]) -> f64 {
    let deck = model.dofs();
    let at = |dof: &Dof| {
        let position = positions[dof.node as usize - 1];
        moved(position, t, w)[usize::from(dof.component) - 1]
    };
    let row = |i: usize| {
        let equation = model.equation(i).expect("an equation");
        let terms = equation.columns.iter().zip(equation.coefficients).map(|(&j, a)| a * at(&deck[j as usize]));
        terms.clone().sum::<f64>().abs() / terms.map(f64::abs).sum::<f64>().max(1.0)
    };
    (0..model.equations()).map(row).fold(0.0, f64::max)
}

/// The reduced form of rigid bodies and of interpolations moves nodes as a rigid body: u = L u_q for the masters of a rigid motion.
#[test]
fn reduced_nodes_move_as_rigid_bodies() {
    let mut rng = Rng::new(11);
    for seed in 0..COUNT {
        let count = 4 + rng.below(6);
        let (text, mut positions) = nodes(count, &mut rng);
        let mut members = String::new();
        for node in 1..count {
            write!(members, "{node:>10}{}", if node % 8 == 0 { "\n" } else { "" }).expect("a string");
        }
        let body = rng.below(2) == 0;
        let card = if body {
            "*CONSTRAINED_NODAL_RIGID_BODY\n         7         0         9\n".to_owned()
        } else {
            format!(
                "*CONSTRAINED_INTERPOLATION\n{:>10}{count:>10}{:>10}{:>10}{:>10}\n{:>10}{:>10}{:>10.2}\n",
                1,
                123_456,
                0,
                1,
                9,
                123,
                0.5 + rng.below(9) as f64
            )
        };
        let model = model(&format!("*KEYWORD\n{text}*SET_NODE_LIST\n         9\n{members}\n{card}"));
        let mean = |k: usize| positions[..count - 1].iter().map(|x| x[k]).sum::<f64>() / (count - 1) as f64;
        positions.push([mean(0), mean(1), mean(2)]);
        let (t, w) = ([0.3, -1.0, 0.7], [0.2, 0.5, -0.4]);
        assert!(residual(&model, &positions, t, w) < 1e-12, "seed {seed}");
        let system = system(&model);
        let options = Options { growth: 1e6, ..Options::default() };
        let elimination = Elimination::new(&system, &options).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        let exact: Vec<f64> = model
            .dofs()
            .iter()
            .map(|dof| moved(positions[dof.node as usize - 1], t, w)[usize::from(dof.component) - 1])
            .collect();
        let masters: Vec<f64> = elimination.masters().iter().map(|&j| exact[j]).collect();
        let mut u = vec![0.0; exact.len()];
        elimination.expand_into(&masters, &mut u).expect("expanded");
        let size = exact.iter().fold(1.0, |m: f64, x| m.max(x.abs()));
        let worst = u.iter().zip(&exact).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
        assert!(worst < 1e-12 * size * elimination.masters().len() as f64, "seed {seed}: {worst}");
    }
}

/// The blocks of a random deck: nodes, sets, bodies, interpolations, equations and supports.
fn blocks(rng: &mut Rng) -> Vec<String> {
    let (text, _) = nodes(12, rng);
    let mut blocks = vec![text];
    for set in 1..=3 {
        let mut block = format!("*SET_NODE_LIST\n{set:>10}\n");
        (0..3).for_each(|k| write!(block, "{:>10}", 1 + 3 * (set - 1) + k).expect("a string"));
        blocks.push(block + "\n");
    }
    for id in 1..=5 {
        let (set, node) = (1 + rng.below(3), 10 + rng.below(3));
        blocks.push(match rng.below(5) {
            0 => format!("*CONSTRAINED_NODAL_RIGID_BODY\n{id:>10}{:>10}{set:>10}\n", 0),
            1 => format!(
                "*CONSTRAINED_INTERPOLATION\n{id:>10}{node:>10}{:>10}{:>10}{:>10}\n{set:>10}{:>10}\n",
                123, 0, 1, 123
            ),
            2 => format!("*BOUNDARY_SPC_SET\n{set:>10}{:>10}{:>10}{:>10}{:>10}\n", 0, 1, 0, 1),
            3 => format!("*CONSTRAINED_NODE_SET\n{set:>10}{:>10}\n", 1 + rng.below(7)),
            _ => format!(
                "*CONSTRAINED_LINEAR_GLOBAL\n{id:>10}\n{node:>10}{:>10}{:>10.2}\n{set:>10}{:>10}{:>10.2}\n",
                1, 2.0, 2, -0.5
            ),
        });
    }
    blocks
}

/// The equations and values of a model, without their order.
fn content(model: &Model) -> (Vec<String>, Vec<String>, usize) {
    let mut rows = equations(model);
    rows.sort();
    (rows, prescribed(model), analysis(model).rank())
}

#[test]
fn order_line_ends_includes_and_field_formats_change_nothing() {
    let mut rng = Rng::new(5);
    for seed in 0..COUNT {
        let blocks = blocks(&mut rng);
        let text = format!("*KEYWORD\n{}*END\n", blocks.concat());
        let expected = content(&model(&text));
        let mut mixed = blocks.clone();
        (0..mixed.len()).for_each(|k| mixed.swap(k, rng.below(blocks.len())));
        let half = mixed.len() / 2;
        let separate = |line: &str| {
            if line.starts_with('*') { line.to_owned() } else { line.split_whitespace().collect::<Vec<_>>().join(",") }
        };
        let wide = |line: &str| {
            if line.starts_with('*') {
                return line.to_owned();
            }
            let fields = line.split_whitespace().map(|field| format!("{field:>20}"));
            fields.collect::<Vec<_>>().concat()
        };
        let lines = |change: &dyn Fn(&str) -> String| text.lines().map(|line| change(line) + "\n").collect::<String>();
        let parameters = text.replace("     -0.50\n", "   &factor\n");
        for (what, text, inner) in [
            ("order", format!("*KEYWORD\n{}", mixed.concat()), String::new()),
            ("CRLF", text.replace('\n', "\r\n"), String::new()),
            ("commas", lines(&separate), String::new()),
            ("long", lines(&wide).replace("*KEYWORD", "*KEYWORD LONG=Y"), String::new()),
            (
                "long cards",
                lines(&|line: &str| if line.starts_with('*') { format!("{line} +") } else { wide(line) }),
                String::new(),
            ),
            ("comments", text.replace("\n*", "\n$ *NODE\n*"), String::new()),
            ("lower case", text.to_lowercase(), String::new()),
            (
                "parameters",
                format!("{}*PARAMETER\nR   factor      -0.5\n", parameters.replace("*END\n", "")),
                String::new(),
            ),
            ("an include", format!("*KEYWORD\n*INCLUDE\npart.k\n{}", mixed[half..].concat()), mixed[..half].concat()),
        ] {
            let deck = parsed_with(&text, &[("part.k", &inner)])
                .unwrap_or_else(|error| panic!("{seed} {what}: {error}\n{text}"));
            assert_eq!(content(deck.model()), expected, "seed {seed}: {what}\n{text}");
        }
    }
}

/// Packed and encoded files are read as plain ones.
#[test]
fn compression_and_encoding_change_nothing() {
    let text = format!("*KEYWORD\n{}*END\n", blocks(&mut Rng::new(3)).concat());
    let place = tempfile::tempdir().expect("a temporary folder");
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    std::io::Write::write_all(&mut packed, text.as_bytes()).expect("packed");
    let utf16 = [0xff, 0xfe].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    for (name, bytes) in
        [("a.k.gz", packed.finish().expect("packed")), ("a.key", utf16), ("a.dyn", text.replace('\n', "\r").into())]
    {
        let path = place.path().join(name);
        std::fs::write(&path, bytes).expect("written");
        let deck = qless_io::deck::read(&path).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(content(deck.model()), content(&model(&text)), "{name}");
    }
}

/// Ties on a plane surface reproduce every linear field.
#[test]
fn tied_nodes_follow_linear_fields() {
    let mut rng = Rng::new(23);
    for seed in 0..COUNT {
        let mut text = "*KEYWORD\n*NODE\n".to_owned();
        let mut positions: Vec<[f64; 3]> = (0..16).map(|k| [f64::from(k % 4), f64::from(k / 4), 0.0]).collect();
        // Points inside of the surface, at small distances from it.
        let mut at = |count: usize, scale: f64| rng.below(count) as f64 * scale;
        let points = (0..10).map(|_| [at(301, 0.01), at(301, 0.01), at(11, 0.001)]);
        positions.extend(points.collect::<Vec<_>>());
        for (k, [x, y, z]) in positions.iter().enumerate() {
            writeln!(text, "{},{x},{y},{z}", k + 1).expect("a string");
        }
        text += "*SET_SEGMENT\n1\n";
        for k in (1..=11).filter(|k| k % 4 != 0) {
            writeln!(text, "{k},{},{},{}", k + 1, k + 5, k + 4).expect("a string");
        }
        let nodes: Vec<String> = (17..=26).map(|node| node.to_string()).collect();
        writeln!(text, "*SET_NODE\n2\n{}\n{}", nodes[..8].join(","), nodes[8..].join(",")).expect("a string");
        let model = model(&(text + "*CONTACT_TIED_NODES_TO_SURFACE\n2,1,4,0\n"));
        assert_eq!((model.equations(), analysis(&model).rank()), (30, 30), "seed {seed}");
        for i in 0..30 {
            let equation = model.equation(i).expect("an equation");
            let field = |&j: &u32| {
                let [x, y, _] = positions[model.dofs()[j as usize].node as usize - 1];
                1.0 + 0.5 * x - 2.0 * y
            };
            let sum: f64 = equation.columns.iter().zip(equation.coefficients).map(|(j, a)| a * field(j)).sum();
            assert!(sum.abs() < 1e-12, "seed {seed}, equation {i}: {sum}");
        }
    }
}
