//! Names that stand for what the caller has opened already: standard input and output, and other descriptors.

/// The name that stands for standard input and standard output.
pub const STANDARD: &str = "-";

/// Folders whose entries are the descriptors of this very process.
const DESCRIPTORS: [&str; 2] = ["/dev/fd/", "/proc/self/fd/"];

/// Whether `path` is standard input: `-`, or a name that the system has for it.
pub fn is_standard_input(path: &str) -> bool {
    path == STANDARD || path == "/dev/stdin" || descriptor(path) == Some(0)
}

/// Whether `path` is standard output: `-`, or a name that the system has for it.
pub fn is_standard_output(path: &str) -> bool {
    path == STANDARD || path == "/dev/stdout" || descriptor(path) == Some(1)
}

/// Whether `path` is something that the caller opened: standard input, or what `<(command)` of a shell stands for. It can be
/// read only once.
pub fn is_stream(path: &str) -> bool {
    is_standard_input(path) || descriptor(path).is_some()
}

/// The number of a descriptor by its path.
fn descriptor(path: &str) -> Option<u32> {
    if !cfg!(unix) {
        return None;
    }
    let digits = DESCRIPTORS.iter().find_map(|folder| path.strip_prefix(folder))?;
    digits.bytes().all(|b| b.is_ascii_digit()).then(|| digits.parse().ok())?
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn descriptors_are_known_by_their_paths() {
        assert!(["-", "/dev/stdin", "/dev/fd/0", "/proc/self/fd/0"].into_iter().all(is_standard_input));
        assert!(["-", "/dev/stdout", "/dev/fd/1"].into_iter().all(is_standard_output));
        assert!(is_stream("/dev/fd/63") && !is_standard_input("/dev/fd/63"));
        for path in ["/dev/fd/", "/dev/fd/x", "/dev/fd/3/a", "/dev/stdinx", "dev/fd/3", "a.svg", ""] {
            assert!(!is_stream(path), "{path}");
        }
    }
}
