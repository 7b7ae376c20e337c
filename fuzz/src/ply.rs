//! Feeds arbitrary bytes to the reader of PLY, and writes what it gives in every format.
#![no_main]

use arabesque_core::Budget;
use arabesque_fuzz::{geometry, limits};
use arabesque_io::mesh::ply::{read_ply, recipe_of};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let _ = recipe_of(data);
    match read_ply("fuzz.ply", data, &Budget::new(limits())) {
        Ok(found) => geometry::geometry(&found),
        Err(error) => assert!(error.to_string().len() < 2000, "a message without end: {error}"),
    }
});
