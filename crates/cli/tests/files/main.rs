//! Files: none is lost, none is misused, whatever the file system has in store.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

#[path = "../common/mod.rs"]
mod common;
mod lost;
mod scenes;
#[cfg(unix)]
mod system;
