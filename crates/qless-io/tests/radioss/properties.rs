//! Laws on random decks.

use std::fmt::Write;

use qless_io::deck::{Dof, Model};
use qless_scenes::Rng;

use super::from_text::{analysis, columns, equations, left_out, model, parsed_bytes, prescribed, stops};

const COUNT: u64 = 300;

/// Nodes 1 to `count` at random.
fn nodes(count: usize, rng: &mut Rng) -> (String, Vec<[f64; 3]>) {
    let mut coordinate = || (rng.below(20_001) as f64 - 10_000.0) / 1000.0;
    let positions: Vec<[f64; 3]> = (0..count).map(|_| [coordinate(), coordinate(), coordinate()]).collect();
    let line = |(k, [x, y, z]): (usize, &[f64; 3])| format!("{} ={x} ={y} ={z}\n", k + 1);
    (format!("/NODE\n{}", positions.iter().enumerate().map(line).collect::<String>()), positions)
}

/// Displacement and rotation of a point under a rigid motion about the origin.
fn moved([x, y, z]: [f64; 3], [tx, ty, tz]: [f64; 3], w: [f64; 3]) -> [f64; 6] {
    [tx + w[1] * z - w[2] * y, ty + w[2] * x - w[0] * z, tz + w[0] * y - w[1] * x, w[0], w[1], w[2]]
}

/// Largest residual of the equations under a rigid motion.
fn residual(model: &Model, positions: &[[f64; 3]]) -> f64 {
    let at = |dof: &Dof| {
        let position = positions[dof.node as usize - 1];
        moved(position, [0.3, -1.0, 0.7], [0.2, 0.5, -0.4])[usize::from(dof.component) - 1]
    };
    let row = |i: usize| {
        let equation = model.equation(i).expect("an equation");
        let terms = equation.columns.iter().zip(equation.coefficients).map(|(&j, a)| a * at(&model.dofs()[j as usize]));
        terms.clone().sum::<f64>().abs() / terms.map(f64::abs).sum::<f64>().max(1.0)
    };
    (0..model.equations()).map(row).fold(0.0, f64::max)
}

fn group(id: usize, nodes: &[usize]) -> String {
    let words: Vec<String> = nodes.iter().map(usize::to_string).collect();
    format!("/GRNOD/NODE/{id}\n'g\n{}\n", words.chunks(10).map(|line| line.join(" ")).collect::<Vec<_>>().join("\n"))
}

fn link(id: usize, main: usize, is_body: bool) -> String {
    if is_body {
        return format!("/RBODY/{id}\n'b\n{main} 0 0 0 =0. {id} 0 4 0\n=0.\n=0.\n");
    }
    format!("/RBE2/{id}\n'l\n{main} _ 0 {id} 0\n")
}

/// The first node of the set that a node belongs to.
fn root(parent: &[usize], node: usize) -> usize {
    if parent[node] == node { node } else { root(parent, parent[node]) }
}

/// Bodies and links of k nodes each join their nodes. The equations of a connected set of n nodes have the rank 6 (n - 1), however many
/// there are; the rest is redundant.
#[test]
fn chains_of_bodies_and_links_have_the_rank_of_their_components() {
    let mut rng = Rng::new(31);
    for seed in 0..COUNT {
        let count = 4 + rng.below(8);
        let (mut text, positions) = nodes(count, &mut rng);
        let mut parent: Vec<usize> = (0..=count).collect();
        for id in 1..=1 + rng.below(5) {
            let main = 1 + rng.below(count);
            let members: Vec<usize> = (0..=rng.below(3)).map(|_| 1 + rng.below(count)).collect();
            text += &(group(id, &members) + &link(id, main, rng.below(2) == 0));
            for node in members {
                let (a, b) = (root(&parent, node), root(&parent, main));
                parent[a] = b;
            }
        }
        let model = model(&text);
        let components = (1..=count).filter(|&node| parent[node] == node).count();
        assert_eq!(left_out(&model), [""; 0], "seed {seed}");
        if model.equations() > 0 {
            assert_eq!(analysis(&model).rank(), 6 * (count - components), "seed {seed}\n{text}");
        }
        assert!(residual(&model, &positions) < 1e-12, "seed {seed}");
    }
}

/// Links in frames, weighted means, spotwelds and ties with arms hold under every rigid motion.
#[test]
fn rigid_motions_satisfy_every_card() {
    let mut rng = Rng::new(37);
    for seed in 0..COUNT {
        let (mut text, mut positions) = nodes(9, &mut rng);
        // A plane face, and a node above it.
        text += "30 =0. =0. =0.\n31 =1. =0. =0.\n32 =1.2 =1.1 =0.\n33 =0. =1. =0.\n";
        let [p, q, r] = [0.01, 0.01, 0.002].map(|x| 30.0 * x + rng.below(40) as f64 * x);
        writeln!(text, "34 ={p} ={q} ={r}").expect("a string");
        positions.resize(34, [0.0; 3]);
        positions[29..].copy_from_slice(&[[0.0; 3], [1.0, 0.0, 0.0], [1.2, 1.1, 0.0], [0.0, 1.0, 0.0], [p, q, r]]);
        text += &(group(1, &[2, 3, 4, 5, 6])
            + &group(2, &[34])
            + "/SKEW/MOV/5\n's\n7 8 9\n/SURF/SEG/3\n's\n1 30 31 32 33\n");
        let mask = || ["110/000", "001/010", "101/100", "000/011", "111/000", "_"];
        let (some, others) = (mask()[rng.below(6)], mask()[rng.below(6)]);
        let spotflag = [0, 1, 2, 5][rng.below(4)];
        writeln!(
            text,
            "/RBE2/1\n'l\n1 {some} 5 1 0\n/RBE3/2\n'm\n7 {others} 1 {}\n={} 111/000 0 1",
            rng.below(4),
            1 + rng.below(5)
        )
        .expect("a string");
        writeln!(text, "/INTER/TYPE2/3\n't\n2 3 0 {spotflag}").expect("a string");
        let model = model(&text);
        assert_eq!(left_out(&model), [""; 0], "seed {seed}\n{text}");
        assert!(residual(&model, &positions) < 1e-12, "seed {seed}\n{text}{:?}", equations(&model));
        assert_eq!(analysis(&model).rank(), model.equations(), "seed {seed}\n{text}");
    }
}

/// The blocks of a random deck: nodes, groups, bodies, means, equations, supports and motions.
fn blocks(rng: &mut Rng) -> Vec<String> {
    let mut blocks = vec![nodes(12, rng).0];
    blocks.extend((1..=3).map(|id| group(id, &[3 * id - 2, 3 * id - 1, 3 * id])));
    blocks.push("/SKEW/FIX/5\n's\n=-.6 =.8 =0.\n=0. =0. =1.\n".into());
    for id in 1..=5 {
        let (set, node, skew) = (1 + rng.below(3), 10 + rng.below(3), 5 * rng.below(2));
        blocks.push(match rng.below(6) {
            0 => format!("/RBODY/{id}\n'b\n{node} 0 0 0 =0. {set} 0 3 0\n=0.\n=0.\n"),
            1 => format!("/RBE2/{id}\n'l\n{node} 101/011 {skew} {set} 0\n"),
            2 => format!("/RBE3/{id}\n'm\n{node} 111/000 1\n=2. 111/000 0 {set}\n"),
            3 => format!("/BCS/{id}\n'b\n101/000 {skew} {set}\n"),
            4 => format!("/IMPVEL/{id}\n'v\n4 Y 0 0 {set}\n=0. =-2.\n"),
            _ => format!("/MPC/{id}\n'm\n{node} 1 {skew} =2.\n{set} 2 0 =-.5\n"),
        });
    }
    blocks
}

/// The equations and values of a model, without their order.
fn content(model: &Model) -> (Vec<String>, Vec<String>, usize, usize) {
    let mut rows = equations(model);
    rows.sort();
    (rows, prescribed(model), analysis(model).rank(), left_out(model).len() + stops(model).len())
}

#[test]
fn order_line_ends_includes_and_comments_change_nothing() {
    let mut rng = Rng::new(5);
    for seed in 0..COUNT {
        let blocks = blocks(&mut rng);
        let text = format!("#RADIOSS STARTER\n{}/END\n", blocks.concat());
        let expected = content(&model(&text));
        let mut mixed = blocks.clone();
        (0..mixed.len()).for_each(|k| mixed.swap(k, rng.below(blocks.len())));
        let half = mixed.len() / 2;
        let plain = columns(&text);
        for (what, text, inner) in [
            ("order", columns(&mixed.concat()), String::new()),
            ("CRLF", plain.replace('\n', "\r\n"), String::new()),
            ("comments", plain.replace('\n', "\n#---1----|\n$ /NODE\n"), String::new()),
            ("units and blanks", plain.replace("/5\n", "/         5/3/\n"), String::new()),
            ("lower case", plain.to_lowercase().replace("/skew/fix", "/SKEW/Fix"), String::new()),
            ("an include", format!("#include part.inc\n{}", columns(&mixed[half..].concat())), mixed[..half].concat()),
        ] {
            let deck = parsed_bytes(text.clone().into_bytes(), &[("part.inc", &inner)]);
            let deck = deck.unwrap_or_else(|error| panic!("{seed} {what}: {error}\n{text}"));
            assert_eq!(content(deck.model()), expected, "seed {seed}: {what}\n{text}");
        }
    }
}

/// Packed and encoded files are read as plain ones, and recognised by their first line.
#[test]
fn compression_and_encoding_change_nothing() {
    let text = columns(&format!("#RADIOSS STARTER\n/BEGIN\n'run\n2019 0\n{}/END\n", blocks(&mut Rng::new(3)).concat()));
    let place = tempfile::tempdir().expect("a temporary folder");
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    std::io::Write::write_all(&mut packed, text.as_bytes()).expect("packed");
    let utf16 = [0xff, 0xfe].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    let expected = content(parsed_bytes(text.clone().into_bytes(), &[]).expect("a deck").model());
    for (name, bytes) in [
        ("a_0000.rad.gz", packed.finish().expect("packed")),
        ("a.rad", utf16),
        ("a.txt", text.replace('\n', "\r").into()),
    ] {
        let path = place.path().join(name);
        std::fs::write(&path, bytes).expect("written");
        let deck = qless_io::deck::read(&path).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(content(deck.model()), expected, "{name}");
    }
}
