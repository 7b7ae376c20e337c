//! Feeds arbitrary text to the reader of points, and writes what it gives.
#![no_main]

use arabesque_core::{Budget, Exemplar, Placement, Similarity};
use arabesque_fuzz::limits;
use arabesque_io::table::csv::{Points, read_points, recipe_of, write_points};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let _ = recipe_of(text);
    match read_points("fuzz.csv", text, &Budget::new(limits())) {
        Ok(Points::Plane(exemplar)) => written(&exemplar),
        Ok(Points::Space(exemplar)) => written(&exemplar),
        Err(error) => assert!(error.to_string().len() < 2000, "a message without end: {error}"),
    }
});

/// What is written is read again as as many points in as many classes, unless six digits of the extent make them lie in one place or
/// on one line.
fn written<const D: usize>(exemplar: &Exemplar<D>) {
    assert!(exemplar.elements.iter().all(|e| e.centre.is_finite() && e.class < exemplar.classes.len()));
    let placed = |source| Placement { source, transform: Similarity::identity(), control: Vec::new(), frozen: None };
    let placements: Vec<_> = (0..exemplar.elements.len()).map(placed).collect();
    let extent = exemplar.elements.iter().flat_map(|e| e.centre.0).fold(1.0, |most: f64, c| most.max(c.abs()));
    let text = write_points(exemplar, &placements, extent, Some("seed = 1\n"));
    assert_eq!(recipe_of(&text).as_deref(), Some("seed = 1\n"));
    let again = match read_points("again.csv", &text, &Budget::new(limits())) {
        Ok(Points::Plane(exemplar)) => (exemplar.elements.len(), exemplar.classes.len()),
        Ok(Points::Space(exemplar)) => (exemplar.elements.len(), exemplar.classes.len()),
        Err(error) => {
            assert!(error.to_string().contains(" lie "), "{error}: {text}");
            return;
        }
    };
    assert_eq!(again, (exemplar.elements.len(), exemplar.classes.len()), "{text}");
}
