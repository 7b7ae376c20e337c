//! Whether standard output was closed when the program began.
//!
//! Rust opens the null device in its place before `main`, so that no file takes its number; what is written then vanishes without a word.
//! So the question is asked earlier, where the system calls functions before the program begins.

#![allow(
    unsafe_code,
    reason = "the section of functions that are called before the program begins can be named in no other way"
)]

use std::sync::atomic::{AtomicBool, Ordering};

static CLOSED: AtomicBool = AtomicBool::new(false);

/// Whether nothing is behind standard output.
pub(crate) fn is_standard_output_closed() -> bool {
    CLOSED.load(Ordering::Relaxed)
}

#[cfg(unix)]
extern "C" fn look() {
    let closed = rustix::io::fcntl_getfd(rustix::stdio::stdout()).is_err();
    CLOSED.store(closed, Ordering::Relaxed);
}

// SAFETY: the section holds pointers to functions that the loader calls once, on one thread, before `main`; this one makes one system
// call and sets a flag, and needs nothing of the runtime.
#[cfg(unix)]
#[used]
#[cfg_attr(target_vendor = "apple", unsafe(link_section = "__DATA,__mod_init_func"))]
#[cfg_attr(not(target_vendor = "apple"), unsafe(link_section = ".init_array"))]
static LOOK: extern "C" fn() = look;
