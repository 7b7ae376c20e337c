//! Pictures that are drawn coarsely, because somebody waits for the end or because the work is used up.

use arabesque_core::Warning;
use arabesque_io::raster::size::Picture;

use super::made::Encoded;

/// Most pixels of drafts, so that they are drawn within a tenth of a second: of the plane, and of what lies in space, whose light is worked
/// out.
pub(crate) const FLAT: usize = 400_000;
pub(crate) const SHADED: usize = 120_000;

/// A picture as a file, with what is to be told where it is smaller than wanted.
pub(crate) fn told(picture: Picture) -> Encoded {
    let Picture { bytes, size, wanted } = picture;
    let warnings = (size != wanted).then(|| {
        let of = |[width, height]: [usize; 2]| format!("{width} x {height}");
        let message = format!("the picture is a draft of {} pixels, where {} were wanted", of(size), of(wanted));
        Warning::new(message, "give it more time or work, or write a format that needs no drawing")
    });
    Encoded { bytes, warnings: warnings.into_iter().collect(), companion: None }
}
