//! Numbers for people: six digits at most, `1e-7` rather than `0.0000001`.

/// As short as it can be while it has the first six digits.
pub fn number(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return if x == 0.0 { "0".to_owned() } else { x.to_string() };
    }
    let scientific = format!("{x:.5e}");
    let Some((mantissa, exponent)) = scientific.split_once('e') else { return scientific };
    match exponent.parse::<i32>() {
        Ok(exponent) if (-4..6).contains(&exponent) => trim(&format!("{x:.*}", (5 - exponent) as usize)).to_owned(),
        _ => format!("{}e{exponent}", trim(mantissa)),
    }
}

/// Two digits, for sizes that matter by their magnitude only.
pub fn rough(x: f64) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    let rounded: f64 = format!("{x:.1e}").parse().unwrap_or(x);
    number(rounded)
}

fn trim(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_digits_at_most() {
        let cases = [
            (1.0, "1"),
            (-2.5, "-2.5"),
            (1.0 / 3.0, "0.333333"),
            (0.999_999_999, "1"),
            (123_456.0, "123456"),
            (1_234_567.0, "1.23457e6"),
            (1e-7, "1e-7"),
            (-0.0, "0"),
            (f64::INFINITY, "inf"),
        ];
        for (x, text) in cases {
            assert_eq!(number(x), text);
        }
        assert_eq!((rough(0.123_456), rough(3.27e-17)), ("0.12".into(), "3.3e-17".into()));
    }
}
