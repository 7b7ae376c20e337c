//! Colours for what has none of its own.

/// Colours of classes, told apart by people with any colour vision; further classes start again.
pub const PALETTE: [&str; 8] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7f7f7f", "#b8a800"];
