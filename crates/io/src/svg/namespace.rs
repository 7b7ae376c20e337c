//! Names of the XML namespaces that are read and written.

/// Shapes and structure.
pub(crate) const SVG: &str = "http://www.w3.org/2000/svg";
/// References of older files.
pub(crate) const XLINK: &str = "http://www.w3.org/1999/xlink";
/// Layers and labels.
pub(crate) const INKSCAPE: &str = "http://www.inkscape.org/namespaces/inkscape";
/// Namespace of the elements and attributes that only arabesque understands.
pub const NAMESPACE: &str = "urn:arabesque:1";
