//! Limits for everything that is read from outside.

/// Upper bounds on input; reaching one is an error that names it, never a hang or an exhausted memory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Bytes of one input file. Default: 256 MiB.
    pub file_bytes: u64,
    /// Elements of one exemplar. Default: 100 000.
    pub elements: usize,
    /// Elements of one result. Default: 2 000 000.
    pub output_elements: usize,
    /// Path segments of one file, after `<use>` is resolved. Default: 5 000 000.
    pub segments: usize,
    /// Depth of nested groups. Default: 256.
    pub depth: usize,
    /// XML nodes of one file. Default: 4 000 000.
    pub nodes: u32,
    /// Pixels of one picture. Default: 100 million.
    pub pixels: u64,
    /// Largest absolute coordinate, in user units. Default: 1e9.
    pub coordinate: f64,
    /// Smallest extent that counts as more than a point, in user units. Default: 1e-9.
    pub extent: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            file_bytes: 256 << 20,
            elements: 100_000,
            output_elements: 2_000_000,
            segments: 5_000_000,
            depth: 256,
            nodes: 4_000_000,
            pixels: 100_000_000,
            coordinate: 1e9,
            extent: 1e-9,
        }
    }
}
