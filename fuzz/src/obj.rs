//! Feeds arbitrary text to the readers of curves in space.
#![no_main]

use arabesque_core::Budget;
use arabesque_fuzz::limits;
use arabesque_io::mesh::obj::{junctions, read_curves, read_lines, recipe_of};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let _ = recipe_of(text);
    match read_curves("fuzz.obj", text, &Budget::new(limits())) {
        Ok(net) => {
            let exemplar = &net.exemplar;
            assert!(exemplar.curves.iter().all(|c| c.style < exemplar.styles.len() && !c.path.is_empty()));
            assert!(exemplar.curves.iter().flat_map(|c| c.path.cubics.iter().flatten()).all(|p| p.is_finite()));
            let _ = junctions(exemplar);
        }
        Err(error) => assert!(error.to_string().len() < 2000, "a message without end: {error}"),
    }
    if let Ok(lines) = read_lines("fuzz.obj", text, &Budget::new(limits())) {
        assert!(lines.iter().flat_map(|(_, path)| path.cubics.iter().flatten()).all(|p| p.is_finite()));
    }
});
