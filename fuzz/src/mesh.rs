//! Feeds arbitrary bytes to the readers of meshes and points other than PLY and GLB: the first byte chooses one, or leaves it to the
//! content.
#![no_main]

use arabesque_core::Budget;
use arabesque_fuzz::{geometry, limits};
use arabesque_io::{
    geometry::{read_geometry, recipe_of},
    mesh::{obj, stl},
    table::{points, xyz},
};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let Some((which, data)) = data.split_first() else { return };
    let _ = recipe_of(data);
    let budget = Budget::new(limits());
    let text = || std::str::from_utf8(data);
    let found = match which % 5 {
        0 => stl::read_stl("fuzz.stl", data, &budget),
        1 => read_geometry("fuzz", data, &budget),
        kind => {
            let Ok(text) = text() else { return };
            match kind {
                2 => obj::read_mesh("fuzz.obj", text, &budget),
                3 => points::read_table("fuzz.csv", text, &budget),
                _ => xyz::read_xyz("fuzz.xyz", text, &budget),
            }
        }
    };
    match found {
        Ok(found) => geometry::geometry(&found),
        Err(error) => assert!(error.to_string().len() < 2000, "a message without end: {error}"),
    }
});
