//! The registry of options: a parameter is declared once, with its name, type, range, default, unit and one sentence.
//!
//! [`params!`](crate::params) declares a struct of parameters and [`choices!`](crate::choices) an enumeration that one of them may hold.
//! Everything else follows from the declaration: setting and reading by name, the check of ranges, the lists of `--help`, the tables of
//! the documentation, the entries of a schema.

mod choices;
mod params;
mod registry;
mod spec;
mod text;
mod value;

pub use choices::{Choice, schema_of};
pub use registry::{Param, Registry};
pub use spec::{Kind, ParamSpec, Preset};
pub use text::{help_list, markdown_table, preset_list};
pub use value::{Bound, ParamValue};

#[doc(hidden)]
pub use {schemars, serde};
