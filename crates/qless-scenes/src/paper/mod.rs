//! `C_f u_f = b - C_p u_p` as in the paper's figures: small systems with everything about them known.
//!
//! The paper (Applied Sciences 15, 13059) shows most of them as drawings. Where its text does not give the
//! equations, a scene is built with the outcome that the text reports, and says so.
//!
//! ```
//! let scene = qless_scenes::paper::figure_8()?;
//! assert_eq!((scene.system.equations(), scene.truth.redundant), (16, Some(2)));
//! # Ok::<(), qless_scenes::SceneError>(())
//! ```

mod equations;
mod frame;
mod lines;

pub use equations::{equations_12_to_14, figure_5, figure_6};
pub use frame::{FloorInput, figure_2};
pub use lines::{figure_1, figure_8};
