//! `CORD1R`, `CORD1C`, `CORD1S`, two frames a card, and `CORD2R`, `CORD2C`, `CORD2S`.

use crate::deck::kinematics::axes::Kind;
use crate::deck::nastran::model::frames::{BASIC, Definition};
use crate::deck::nastran::syntax::card::{Card, Refused};

const ID: &str = "the number of the coordinate system";

/// `CORD1x id, G1, G2, G3`, once or twice.
pub fn through_grids(card: &Card, kind: Kind) -> Result<Vec<(u32, Definition)>, Refused> {
    let mut found = Vec::new();
    for start in [0, 4] {
        if start > 0 && (start..start + 4).all(|i| card.is_blank(i)) {
            continue;
        }
        let mut grids = [0; 3];
        for (i, node) in grids.iter_mut().enumerate() {
            *node = card.id(start + 1 + i, "a grid point")?;
        }
        found.push((card.id(start, ID)?, Definition::Grids { kind, grids }));
    }
    Ok(found)
}

/// `CORD2x id, reference, A1, A2, A3, B1, B2, B3, C1, C2, C3`.
pub fn through_points(card: &Card, kind: Kind) -> Result<(u32, Definition), Refused> {
    let reference = card.optional_whole(1, "a coordinate system")?.unwrap_or(BASIC);
    let mut points = [[0.0; 3]; 3];
    for (i, x) in points.as_flattened_mut().iter_mut().enumerate() {
        *x = card.real(2 + i)?.unwrap_or(0.0);
    }
    Ok((card.id(0, ID)?, Definition::Points { kind, reference, points }))
}
