//! A pool of threads of a given size.

use arabesque_core::{Error, Result};

/// Runs `work` with `threads` threads, or with one for each processor. The result does not depend on the number.
///
/// # Errors
/// [`Error::Parameter`] for no thread or more than 1024, [`Error::Io`] when the system gives none.
pub fn in_pool<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> Result<T> {
    if let Some(n) = threads
        && !(1..=1024).contains(&n)
    {
        return Err(Error::parameter("threads", n, "a number between 1 and 1024"));
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.unwrap_or(0))
        .build()
        .map_err(|e| Error::Io { path: "threads".into(), source: std::io::Error::other(e) })?;
    Ok(pool.install(work))
}
