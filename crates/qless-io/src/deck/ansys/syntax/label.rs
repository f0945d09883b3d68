//! Labels of degrees of freedom, and the component numbers that they stand for.

/// The labels of components 1, 2, 3 and so on. Components 1 to 6 are displacements and rotations, as in every format.
const LABELS: [&str; 38] = [
    "UX", "UY", "UZ", "ROTX", "ROTY", "ROTZ", "WARP", "PRES", "VOLT", "MAG", "TEMP", "TBOT", "TTOP", "CONC", "AX",
    "AY", "AZ", "EMF", "CURR", "HDSP", "VX", "VY", "VZ", "ENKE", "ENDS", "SE", "SO", "SW", "SRA", "SRT", "GFV1",
    "GFV2", "GFV3", "GLAM", "SP01", "SP02", "SP03", "SP04",
];

/// The labels of loads. Each comes with the component on which the load acts.
const LOADS: [(&str, u8); 15] = [
    ("FX", 1),
    ("FY", 2),
    ("FZ", 3),
    ("MX", 4),
    ("MY", 5),
    ("MZ", 6),
    ("FLOW", 8),
    ("AMPS", 9),
    ("CHRG", 9),
    ("FLUX", 10),
    ("HEAT", 11),
    ("RATE", 14),
    ("CSGX", 15),
    ("CSGY", 16),
    ("CSGZ", 17),
];

/// The labels of velocities and accelerations, which `D` can prescribe as well.
const RATES: [&str; 12] =
    ["VELX", "VELY", "VELZ", "OMGX", "OMGY", "OMGZ", "ACCX", "ACCY", "ACCZ", "DMGX", "DMGY", "DMGZ"];

/// The component of `TEn` is n plus this number. `TEn` is the temperature of layer n of a shell, with n from 2 to 99.
const LAYER: u8 = 100;

/// The component that a label stands for.
pub fn component(label: &[u8]) -> Option<u8> {
    let known = LABELS.iter().position(|known| label.eq_ignore_ascii_case(known.as_bytes()));
    known.map(|k| k as u8 + 1).or_else(|| layer(label))
}

/// The component that a load acts on.
pub fn loaded(label: &[u8]) -> Option<u8> {
    LOADS.iter().find(|(known, _)| label.eq_ignore_ascii_case(known.as_bytes())).map(|(_, component)| *component)
}

/// Whether the label stands for a velocity or an acceleration.
pub fn is_rate(label: &[u8]) -> bool {
    RATES.iter().any(|rate| label.eq_ignore_ascii_case(rate.as_bytes()))
}

/// The label of a component.
pub fn name(component: u8) -> String {
    match usize::from(component).checked_sub(1).and_then(|k| LABELS.get(k)) {
        Some(label) => (*label).to_owned(),
        None => format!("TE{}", component.saturating_sub(LAYER)),
    }
}

fn layer(label: &[u8]) -> Option<u8> {
    let digits = label.strip_prefix(b"TE").or_else(|| label.strip_prefix(b"te"))?;
    let layer = std::str::from_utf8(digits).ok()?.parse::<u8>().ok()?;
    ((2..100).contains(&layer) && digits[0] != b'0' && digits[0] != b'+').then_some(LAYER + layer)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_label_has_a_component_of_its_own() {
        for (label, number) in LABELS.into_iter().zip(1..) {
            assert_eq!(component(label.to_ascii_lowercase().as_bytes()), Some(number));
            assert_eq!(name(number), label);
        }
        for (label, number) in [("TE2", 102), ("te31", 131)] {
            assert_eq!(component(label.as_bytes()), Some(number));
            assert_eq!(name(number), label.to_ascii_uppercase());
        }
        for label in ["", "U", "TE1", "TE", "TE02", "TE+2", "TE100", "ALL", "FX"] {
            assert_eq!(component(label.as_bytes()), None, "{label}");
        }
        assert_eq!(loaded(b"mz"), Some(6));
        assert!(is_rate(b"Velx") && !is_rate(b"UX"));
    }
}
