//! The systems of the paper's figures: small, with all properties known.
//!
//! The paper (Applied Sciences 15, 13059) shows most of them as drawings. If it does not give the equations, the scene has
//! the outcome that the text reports, and its documentation states this.
//!
//! ```
//! let scene = qless_scenes::paper::figure_8()?;
//! assert_eq!((scene.system.equations(), scene.truth.redundant), (16, Some(2)));
//! # Ok::<(), qless_scenes::SceneError>(())
//! ```

mod equations;
mod lines;

pub use equations::{FloorInput, equations_12_to_14, figure_2, figure_5, figure_6};
pub use lines::{figure_1, figure_8};
