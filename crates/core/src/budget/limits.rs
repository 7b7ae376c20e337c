//! The limits themselves, with their names and defaults.

crate::params! {
    /// Upper bounds on what is read and made; reaching one is an error that names it, never a hang or an exhausted memory.
    #[derive(Copy)]
    pub struct Limits {
        /// Bytes of one input file.
        file_bytes "file-bytes": usize = 256 << 20, in 1..=1 << 40, unit "bytes";
        /// XML nodes, or vertices and statements, of one file.
        nodes "nodes": usize = 4_000_000, in 1..=u32::MAX as usize;
        /// Depth of nested groups, arrays and tables in one file.
        depth "depth": usize = 256, in 1..=1000;
        /// Path segments of one file, after references are resolved.
        segments "segments": usize = 5_000_000, in 1..=1 << 32;
        /// Pixels of one picture, read or written.
        pixels "pixels": usize = 100_000_000, in 1..=1 << 40;
        /// Elements of one exemplar.
        elements "elements": usize = 100_000, in 1..=1 << 32;
        /// Elements that one result is expected to have.
        output_elements "output-elements": usize = 2_000_000, in 1..=1 << 32;
        /// Largest absolute coordinate, in user units.
        coordinate "coordinate": f64 = 1e9, in 1.0..=1e12, unit "user units";
        /// Smallest extent that counts as more than a point, in user units.
        extent "extent": f64 = 1e-9, in 1e-12..=1.0, unit "user units";
        /// Corners of one outline, flattened.
        outline_nodes "outline-nodes": usize = 4_000_000, in 4..=1 << 32;
        /// Places at which the edges of outlines cross in one union, intersection or offset.
        crossings "crossings": usize = 1_000_000, in 1..=1 << 32;
        /// Candidates that are weighed for one place.
        candidates "candidates": usize = 2_000_000, in 1..=1 << 32;
        /// Rounds of one step that is repeated until nothing changes.
        iterations "iterations": usize = 10_000, in 1..=1 << 32;
        /// Work of one command, in millions of units; a unit takes one or two nanoseconds on one core.
        work "work": usize = 10_000, in 1..=1 << 40, unit "million units";
        /// Work that each element, or sample of a stroke, of the result adds to it, in millions of units.
        work_per_element "work-per-element": usize = 4, in 0..=1 << 40, unit "million units";
        /// Memory in use at one time.
        memory "memory": usize = 1_200_000_000, in 1 << 20..=1 << 44, unit "bytes";
    }
}

impl Limits {
    /// The end of advice about what is over the limit `name`: `, or raise the limit with --limit name=enough`; nothing where the limit
    /// cannot be raised so far. `enough` is rounded up to a whole number.
    pub fn raising(name: &str, enough: f64) -> String {
        let enough = format!("{:.0}", enough.ceil());
        match Self::default().set(name, &enough) {
            Ok(()) => format!(", or raise the limit with --limit {name}={enough}"),
            Err(_) => String::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_raised_by_name() {
        let mut limits = Limits::default();
        limits.set("file-bytes", "7").unwrap();
        assert_eq!(limits.file_bytes, 7);
        let error = limits.set("pixel", "7").unwrap_err().to_string();
        assert!(error.contains("did you mean pixels?"), "{error}");
        assert!(limits.set("memory", "-1").is_err());
        assert_eq!(Limits::raising("depth", 300.2), ", or raise the limit with --limit depth=301");
        assert_eq!(Limits::raising("depth", 5000.0), "");
        assert_eq!(Limits::raising("work", f64::INFINITY), "");
    }
}
