//! Palettes of PNG pictures: the decoder takes for granted that they are sound.

use std::io::Cursor;

use png::{ColorType, Decoder, Info};

/// Whether there is a palette where there should be one, and of whole colours.
pub(crate) fn is_sound(info: &Info<'_>) -> bool {
    info.color_type != ColorType::Indexed || info.palette.as_ref().is_some_and(|p| p.len().is_multiple_of(3))
}

/// Whether the picture has a palette that is none.
pub(crate) fn is_broken(bytes: &[u8]) -> bool {
    let mut decoder = Decoder::new(Cursor::new(bytes));
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    decoder.read_info().is_ok_and(|reader| !is_sound(reader.info()))
}
