//! Files: read with a limit and without waiting, written whole or not at all.
//!
//! What is read has to be a regular file, or comes from a descriptor that the caller opened, as standard input does. What is
//! written lies in a file of a random name beside its target until it is complete, and is renamed then.

mod beside;
mod called;
mod copy;
mod identity;
mod part;
mod read;
mod stream;
mod system;
mod target;
mod text;

pub use beside::{Beside, Folder, NothingBeside, name_beside};
pub use called::{HTML, TOML, called, is_packed};
pub(crate) use called::{binary, text_called};
pub use identity::Identity;
pub use part::abandon_writing;
pub use read::read_bytes;
pub use stream::{STANDARD, is_standard_input, is_standard_output, is_stream};
pub use target::{Step, Target};
pub use text::decode_text;
