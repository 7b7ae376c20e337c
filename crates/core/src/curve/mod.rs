//! Lines: paths of cubic Bézier segments, paths measured by their length, polylines, and how densely lines lie.

mod frames;
mod measured;
mod path;
mod polyline;
mod spacing;
mod spans;

pub use frames::{carried, turned_about};
pub use measured::Measured;
pub use path::{Cubic, Path, cubic_at, cubic_part, straight};
pub use polyline::{arc_lengths, polyline_length};
pub use spacing::{net_line_spacing, parallel_line_spacing};
pub use spans::spans_inside;
