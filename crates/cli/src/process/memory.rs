//! Memory, counted: whatever input brings about, the program uses no more than its limit.
//!
//! Readers and engines ask their budget before they allocate by a number from outside. This is the net below them: an allocator that
//! counts, and that lets no thread go beyond the limit. A thread that would is held where it is, and the [`crate::process::sentinel`] ends the
//! program with an error, so that an allocation that fails is an error too, not an abort.

#![allow(unsafe_code, reason = "an allocator cannot be written without")]

use std::{
    alloc::{GlobalAlloc, Layout, System},
    cell::Cell,
    sync::atomic::{AtomicBool, AtomicIsize, Ordering},
    time::Duration,
};

/// Bytes that a thread may count by itself before it tells the others.
const SHARE: isize = 1 << 16;

static IN_USE: AtomicIsize = AtomicIsize::new(0);
static PEAK: AtomicIsize = AtomicIsize::new(0);
static LIMIT: AtomicIsize = AtomicIsize::new(isize::MAX);
static EXHAUSTED: AtomicBool = AtomicBool::new(false);

thread_local! {
    /// What this thread has not told yet.
    static OWN: Cell<isize> = const { Cell::new(0) };
    /// Whether this thread may go beyond the limit: it ends the program.
    static EXEMPT: Cell<bool> = const { Cell::new(false) };
}

/// Lets all threads but the one that calls this use no more than `bytes` from now on.
pub(crate) fn limit(bytes: usize) {
    EXEMPT.set(true);
    LIMIT.store(isize::try_from(bytes).unwrap_or(isize::MAX), Ordering::SeqCst);
}

/// Whether a thread has reached the limit, and waits for the end of the program.
pub(crate) fn is_exhausted() -> bool {
    EXHAUSTED.load(Ordering::SeqCst)
}

/// The most that was in use at one time, in bytes, up to what the threads had not told.
pub(crate) fn peak() -> usize {
    PEAK.load(Ordering::Relaxed).max(0).unsigned_abs()
}

/// Counts `more` bytes, fewer than none when they are given back. Does not return when there is no room for them.
fn count(more: isize) {
    let untold = OWN.try_with(|own| {
        let untold = own.get() + more;
        let tell = untold.abs() >= SHARE;
        own.set(if tell { 0 } else { untold });
        if tell { untold } else { 0 }
    });
    // Where a thread is at its end, its cell is gone: it tells at once.
    let untold = untold.unwrap_or(more);
    if untold == 0 {
        return;
    }
    let now = IN_USE.fetch_add(untold, Ordering::Relaxed) + untold;
    if untold > 0 {
        if now > LIMIT.load(Ordering::Relaxed) {
            exhausted();
        }
        PEAK.fetch_max(now, Ordering::Relaxed);
    }
}

/// Holds the thread until the program has ended; the one that ends it goes on.
fn exhausted() {
    if EXEMPT.try_with(Cell::get).unwrap_or(true) {
        return;
    }
    EXHAUSTED.store(true, Ordering::SeqCst);
    loop {
        std::thread::sleep(Duration::from_secs(1));
    }
}

/// The allocator of the system, with a count.
pub(crate) struct Counting;

fn signed(size: usize) -> isize {
    // A layout is never larger than this.
    size.cast_signed()
}

// SAFETY: every call is handed to the system's allocator with the arguments that came; counting touches no allocated memory, allocates
// nothing itself and does not unwind.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(signed(layout.size()));
        // SAFETY: as this function itself.
        let memory = unsafe { System.alloc(layout) };
        told(memory)
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count(signed(layout.size()));
        // SAFETY: as this function itself.
        let memory = unsafe { System.alloc_zeroed(layout) };
        told(memory)
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        count(-signed(layout.size()));
        // SAFETY: as this function itself.
        unsafe { System.dealloc(memory, layout) }
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(signed(size) - signed(layout.size()));
        // SAFETY: as this function itself.
        let memory = unsafe { System.realloc(memory, layout, size) };
        told(memory)
    }
}

/// A failed allocation ends the program as the limit does, once somebody is there to end it.
fn told(memory: *mut u8) -> *mut u8 {
    if memory.is_null() && LIMIT.load(Ordering::Relaxed) < isize::MAX {
        exhausted();
    }
    memory
}
