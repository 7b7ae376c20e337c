//! Feeds pictures to everything that reads them: as fields, as what is to be avoided, as exemplars. Checksums are mended first, since
//! nearly every change would end at them.
#![no_main]

use arabesque_core::{Bounds, Budget, Vector};
use arabesque_fuzz::limits;
use arabesque_io::{
    mesh::gltf,
    raster::{field::Picture, heights::read_heights, image::read_image, mask::MaskRaster, png, rows::picture_size},
};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let _ = gltf::recipe_of(data);
    let mut bytes = data.to_vec();
    mend_checksums(&mut bytes);
    let _ = png::recipe_of(&bytes);
    let budget = Budget::new(limits());
    let size = picture_size("fuzz.png", &bytes);
    if let Ok((image, _)) = read_image("fuzz.png", &bytes, &budget) {
        assert_eq!(image.pixels.len(), image.width * image.height);
        assert!(size.is_ok_and(|size| size == [image.width, image.height]));
    }
    if let Ok(heights) = read_heights("fuzz.png", &bytes, &budget) {
        assert_eq!(heights.values.len(), heights.width * heights.height);
        assert!(heights.values.iter().all(|v| (0.0..=1.0).contains(v)));
    }
    let bounds = Bounds::new(Vector::ZERO, Vector([30.0, 20.0]));
    let picture = Picture::new("fuzz.png", &bytes, &budget);
    if let Ok(field) = picture.scalar_field(bounds, [0.5, 2.0]) {
        let value = field.at(Vector([7.0, 19.0]));
        assert!((0.499..=2.001).contains(&value), "{value} lies outside of the range");
    }
    if let Ok(field) = picture.orientation_field(bounds) {
        assert!(field.at(Vector([7.0, 19.0])).0.iter().flatten().all(|v| v.is_finite()));
    }
    if let Ok(mut mask) = MaskRaster::empty(bounds, 30, 20, &budget) {
        let _ = mask.add_picture("fuzz.png", &bytes, &budget);
        assert_eq!(mask.cells.len(), 600);
    }
});

/// Gives every chunk the checksum of its content.
fn mend_checksums(bytes: &mut [u8]) {
    let mut at = 8;
    while let Some(length) = bytes.get(at..at + 4).map(|b| u32::from_be_bytes([b[0], b[1], b[2], b[3]]) as usize) {
        let end = (at + 8).saturating_add(length);
        let Some(sum) = bytes.get(at + 4..end).map(crc32fast::hash) else { return };
        let Some(place) = bytes.get_mut(end..end + 4) else { return };
        place.copy_from_slice(&sum.to_be_bytes());
        at = end + 4;
    }
}
