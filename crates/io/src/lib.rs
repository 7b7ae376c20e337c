//! Files to core types and back: SVG, PNG, CSV, JSON.

pub mod svg;
