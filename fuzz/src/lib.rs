//! What the targets share: limits that keep a run short, drawings made of bytes, and what must be true of everything that comes out.

pub mod check;
pub mod drawn;
pub mod geometry;
pub mod read;

use arabesque_core::Limits;

/// Limits that a hostile input reaches within a fraction of a second, instrumented as everything is.
pub fn limits() -> Limits {
    Limits {
        nodes: 3000,
        segments: 3000,
        depth: 64,
        elements: 300,
        output_elements: 300,
        pixels: 100_000,
        outline_nodes: 20_000,
        crossings: 10_000,
        candidates: 20_000,
        work: 60,
        work_per_element: 1,
        memory: 256 << 20,
        ..Limits::default()
    }
}
