//! Feeds arbitrary text to every way of reading SVG, and checks what comes out: never a panic or a hang, and markup that is well formed,
//! finite, and refers only to definitions that are there.
#![no_main]

use arabesque_fuzz::read;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    if let Ok(text) = std::str::from_utf8(data) {
        read::drawing(text, data.len());
    }
});
