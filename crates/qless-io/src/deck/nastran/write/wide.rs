//! Writes an equation as an `MPC` card in large field: numbers have 16 columns, for a sign, a point and up to 14 digits.

use crate::deck::clean::Written;

/// Number of columns of a number.
const NUMBER: usize = 16;

/// The text of `MPC* set, G1, C1, A1, G2, C2, A2, ...`. Each pair of lines holds two terms; the slave comes first.
pub fn mpc(set: u32, written: &Written) -> String {
    let slave = std::iter::once((written.slave, 1.0));
    let fields: Vec<String> = slave
        .chain(written.terms.iter().copied())
        .map(|(dof, value)| format!("{:>16}{:>16}{:>16}", dof.node, dof.component, number(value)))
        .collect();
    let mut text = String::new();
    for (k, pair) in fields.chunks(2).enumerate() {
        let head = if k == 0 { format!("MPC*    {set:>16}") } else { format!("*       {:16}", "") };
        let second = pair.get(1).map_or("", String::as_str);
        text.extend([&head, &pair[0], "\n*       ", second, "\n"]);
    }
    text
}

/// Writes the number in at most 16 columns: exactly if possible, or else the nearest number that fits.
fn number(value: f64) -> String {
    let exact = [nastran(&format!("{value:?}")), nastran(&format!("{value:e}"))];
    if let Some(text) = exact.into_iter().filter(|text| text.len() <= NUMBER).min_by_key(String::len) {
        return text;
    }
    (0..=NUMBER)
        .flat_map(|digits| [format!("{value:.digits$}"), format!("{value:.digits$e}")])
        .map(|text| nastran(&text))
        .filter(|text| text.len() <= NUMBER)
        .min_by(|a, b| error(a, value).total_cmp(&error(b, value)))
        .unwrap_or_else(|| "0.".into())
}

/// Shortens a number to Nastran's form: `-.5` for `-0.5`, `1.-7` for `1e-7`, `12.` for `12`.
fn nastran(text: &str) -> String {
    let (mantissa, exponent) = text.split_once('e').unwrap_or((text, ""));
    let point = if mantissa.contains('.') { "" } else { "." };
    let sign = if exponent.is_empty() || exponent.starts_with('-') { "" } else { "+" };
    let text = format!("{mantissa}{point}{sign}{exponent}");
    match text.strip_prefix("0.").map(|rest| ("", rest)).or(text.strip_prefix("-0.").map(|rest| ("-", rest))) {
        Some((sign, rest)) if rest.starts_with(|c: char| c.is_ascii_digit()) => format!("{sign}.{rest}"),
        _ => text,
    }
}

fn error(text: &str, value: f64) -> f64 {
    crate::deck::nastran::syntax::number::real(text.as_bytes()).map_or(f64::INFINITY, |read| (read - value).abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deck::Dof;

    #[test]
    fn numbers_fit_and_read_back() {
        for (value, text) in [
            (1.0, "1.0"),
            (-0.25, "-.25"),
            (1e-7, "1.-7"),
            (-2.5e30, "-2.5+30"),
            (1.0 / 3.0, ".333333333333333"),
            (-1.0 / 3.0, "-.33333333333333"),
            (0.0, ".0"),
            (f64::MIN_POSITIVE, "2.2250738585-308"),
        ] {
            assert_eq!(number(value), text);
        }
        for value in [-1.234_567_890_123_456_7e-105, -12_345.678_901_234_567, std::f64::consts::PI * 1e-7, 1e22 / 3.0] {
            let read = crate::deck::nastran::syntax::number::real(number(value).as_bytes()).expect("a number");
            assert!(number(value).len() <= NUMBER && ((read - value) / value).abs() < 1e-9, "{}", number(value));
        }
    }

    #[test]
    fn a_card_in_large_field() {
        let dof = |node, component| Dof { node, component };
        let written = Written {
            slave: dof(1, 3),
            terms: vec![(dof(20, 1), -0.5), (dof(7, 0), 2.0)],
            rhs: 0.0,
            cases: crate::deck::clean::Cases::All,
        };
        let lines = [
            "MPC*                   5               1               3             1.0",
            "*                     20               1             -.5",
            "*                                      7               0             2.0",
            "*       ",
        ];
        assert_eq!(mpc(5, &written).lines().collect::<Vec<_>>(), lines);
    }
}
