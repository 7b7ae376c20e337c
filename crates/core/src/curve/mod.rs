//! Lines: paths of cubic Bézier segments, and paths measured by their length.

mod measured;
mod path;

pub use measured::Measured;
pub use path::{Cubic, Path, cubic_at, cubic_part, straight};
