//! Writes the pictures on the pages of the constraint types: `cargo run -p qless-constraints --example pictures`.
//!
//! A new type needs a drawing in [`drawings`], and a page of the same name in `docs/types`.

mod canvas;
mod drawings;

use std::path::Path;

fn main() -> std::io::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/pictures");
    std::fs::create_dir_all(&folder)?;
    for picture in drawings::all() {
        std::fs::write(folder.join(format!("{}.svg", picture.name)), picture.svg())?;
    }
    Ok(())
}
