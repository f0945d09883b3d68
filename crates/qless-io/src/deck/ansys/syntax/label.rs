//! Names of degrees of freedom as components of a node.

/// Components with a number of their own; 1 to 6 are displacements and rotations as in every format.
const LABELS: [(&str, u8); 38] = [
    ("UX", 1),
    ("UY", 2),
    ("UZ", 3),
    ("ROTX", 4),
    ("ROTY", 5),
    ("ROTZ", 6),
    ("WARP", 7),
    ("PRES", 8),
    ("VOLT", 9),
    ("MAG", 10),
    ("TEMP", 11),
    ("TBOT", 12),
    ("TTOP", 13),
    ("CONC", 14),
    ("AX", 15),
    ("AY", 16),
    ("AZ", 17),
    ("EMF", 18),
    ("CURR", 19),
    ("HDSP", 20),
    ("VX", 21),
    ("VY", 22),
    ("VZ", 23),
    ("ENKE", 24),
    ("ENDS", 25),
    ("SE", 26),
    ("SO", 27),
    ("SW", 28),
    ("SRA", 29),
    ("SRT", 30),
    ("GFV1", 31),
    ("GFV2", 32),
    ("GFV3", 33),
    ("GLAM", 34),
    ("SP01", 35),
    ("SP02", 36),
    ("SP03", 37),
    ("SP04", 38),
];

/// Loads and the component of the DOF that they act on.
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

/// What `D` prescribes that is no value of a DOF: its derivatives in time.
const RATES: [&str; 12] =
    ["VELX", "VELY", "VELZ", "OMGX", "OMGY", "OMGZ", "ACCX", "ACCY", "ACCZ", "DMGX", "DMGY", "DMGZ"];

/// Temperatures of the layers of a shell, `TE2` to `TE99`, are numbered from here.
const LAYER: u8 = 100;

/// The component that a label stands for.
pub fn component(label: &[u8]) -> Option<u8> {
    find(&LABELS, label).or_else(|| layer(label))
}

/// The component that a load acts on.
pub fn loaded(label: &[u8]) -> Option<u8> {
    find(&LOADS, label)
}

/// Whether the label stands for a velocity or an acceleration.
pub fn is_rate(label: &[u8]) -> bool {
    RATES.iter().any(|rate| label.eq_ignore_ascii_case(rate.as_bytes()))
}

/// The label of a component, as equations are written with.
pub fn name(component: u8) -> String {
    match LABELS.iter().find(|(_, known)| *known == component) {
        Some((label, _)) => (*label).to_owned(),
        None => format!("TE{}", component.saturating_sub(LAYER)),
    }
}

fn find(table: &[(&str, u8)], label: &[u8]) -> Option<u8> {
    table.iter().find(|(known, _)| label.eq_ignore_ascii_case(known.as_bytes())).map(|(_, component)| *component)
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
        for (label, number) in LABELS {
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
