//! Numbers in the binary chunk of a GLB file.

use arabesque_core::{Budget, Error, Result};

use super::document::{AccessorRecord, Document};

/// Work of one number.
const PER_NUMBER: u64 = 8;

/// Component types of the format.
const BYTE: u32 = 5120;
const UNSIGNED_BYTE: u32 = 5121;
const SHORT: u32 = 5122;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;

/// What accessors refer to.
#[derive(Clone, Copy)]
pub(super) struct Binary<'a> {
    pub(super) name: &'a str,
    pub(super) document: &'a Document,
    pub(super) bytes: &'a [u8],
    pub(super) budget: &'a Budget,
}

impl Binary<'_> {
    /// The numbers of an accessor, `width` of them for each of its items: 3 for `VEC3`.
    ///
    /// # Errors
    /// [`Error::Input`] when there is no such accessor, when it is of another kind, or when it reaches beyond what it refers to;
    /// [`Error::Unsupported`] for sparse ones; those of the budget.
    pub(super) fn numbers(&self, index: usize, width: usize) -> Result<Vec<f64>> {
        let Some(accessor) = self.document.accessors.get(index) else {
            return self.fail(index, format!("there are {}", self.document.accessors.len()));
        };
        if width_of(&accessor.kind) != Some(width) {
            return self.fail(index, format!("its type is {}, expected {width} numbers", accessor.kind));
        }
        if accessor.sparse.is_some() {
            let what = format!("{}: accessor {index}, which is sparse,", self.name);
            return Err(Error::Unsupported { what, advice: "save the file without sparse accessors".into() });
        }
        let limit = ("nodes", self.budget.limits().nodes.saturating_mul(3));
        self.budget.within(&format!("{}: items of accessor {index}", self.name), accessor.count, limit)?;
        let total = accessor.count.saturating_mul(width);
        self.budget.spend(PER_NUMBER.saturating_mul(total as u64))?;
        let Some(view) = accessor.buffer_view else {
            // By the format what refers to nothing is zero.
            let (mut zeros, _held) = self.budget.list("numbers of the mesh", total)?;
            zeros.resize(total, 0.0);
            return Ok(zeros);
        };
        let (bytes, stride, size) = self.items(index, accessor, view, width)?;
        let (mut numbers, _held) = self.budget.list("numbers of the mesh", total)?;
        for item in 0..accessor.count {
            let item = &bytes[item * stride..];
            numbers.extend((0..width).map(|k| number(&item[k * size..], accessor.component_type, accessor.normalized)));
        }
        Ok(numbers)
    }

    /// Whole numbers of an accessor.
    ///
    /// # Errors
    /// As [`Binary::numbers`], and for what is no index.
    pub(super) fn indices(&self, index: usize) -> Result<Vec<u32>> {
        let numbers = self.numbers(index, 1)?;
        let whole = |v: f64| (v.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&v)).then_some(v as u32);
        let found: Option<Vec<u32>> = numbers.into_iter().map(whole).collect();
        found.map_or_else(|| self.fail(index, "its numbers are no indices".into()), Ok)
    }

    /// The bytes from the first item on, the bytes from one item to the next, and those of one number.
    fn items(
        &self,
        index: usize,
        accessor: &AccessorRecord,
        view: usize,
        width: usize,
    ) -> Result<(&[u8], usize, usize)> {
        let Some(size) = size_of(accessor.component_type) else {
            return self.fail(index, format!("its component type {} is none", accessor.component_type));
        };
        let Some(record) = self.document.buffer_views.get(view) else {
            return self.fail(index, format!("it refers to buffer view {view}, which does not exist"));
        };
        if record.buffer != 0 || self.document.buffers.first().is_some_and(|b| b.uri.is_some()) {
            let what = format!("{}: a buffer outside of the file", self.name);
            return Err(Error::Unsupported { what, advice: "save it as GLB, with everything inside".into() });
        }
        let end = record.byte_offset.checked_add(record.byte_length);
        let Some(bytes) = end.and_then(|end| self.bytes.get(record.byte_offset..end)) else {
            return self
                .fail(index, format!("buffer view {view} reaches beyond the {} bytes there are", self.bytes.len()));
        };
        let item = size * width;
        let stride = record.byte_stride.unwrap_or(item);
        let bytes = bytes.get(accessor.byte_offset..).unwrap_or_default();
        let last = accessor.count.saturating_sub(1).checked_mul(stride).and_then(|last| last.checked_add(item));
        if stride < item || (accessor.count > 0 && last.is_none_or(|needed| needed > bytes.len())) {
            return self.fail(index, format!("{} items reach beyond buffer view {view}", accessor.count));
        }
        Ok((bytes, stride, size))
    }

    fn fail<T>(&self, index: usize, problem: String) -> Result<T> {
        let advice = "write the file again; it is damaged";
        Err(Error::input(format!("{}: accessor {index}", self.name), problem, advice))
    }
}

fn width_of(kind: &str) -> Option<usize> {
    [("SCALAR", 1), ("VEC2", 2), ("VEC3", 3), ("VEC4", 4)].iter().find(|(k, _)| *k == kind).map(|(_, width)| *width)
}

fn size_of(component: u32) -> Option<usize> {
    match component {
        BYTE | UNSIGNED_BYTE => Some(1),
        SHORT | UNSIGNED_SHORT => Some(2),
        UNSIGNED_INT | FLOAT => Some(4),
        _ => None,
    }
}

/// The number that `bytes`, of which there are enough, begin with.
fn number(bytes: &[u8], component: u32, normalized: bool) -> f64 {
    let word = |n: usize| {
        let mut word = [0; 4];
        word[..n].copy_from_slice(&bytes[..n]);
        u32::from_le_bytes(word)
    };
    let (value, most) = match component {
        BYTE => (f64::from(word(1) as u8 as i8), f64::from(i8::MAX)),
        UNSIGNED_BYTE => (f64::from(word(1)), f64::from(u8::MAX)),
        SHORT => (f64::from(word(2) as u16 as i16), f64::from(i16::MAX)),
        UNSIGNED_SHORT => (f64::from(word(2)), f64::from(u16::MAX)),
        UNSIGNED_INT => (f64::from(word(4)), f64::from(u32::MAX)),
        _ => return f64::from(f32::from_bits(word(4))),
    };
    if normalized { (value / most).max(-1.0) } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(accessor: &str, width: usize) -> Result<Vec<f64>> {
        let text = format!(
            "{{\"accessors\": [{accessor}], \"buffers\": [{{}}], \"bufferViews\": [{{\"buffer\": 0, \"byteLength\": 8}}, \
             {{\"buffer\": 0, \"byteOffset\": 1, \"byteLength\": 6, \"byteStride\": 3}}, {{\"buffer\": 0, \"byteLength\": 9}}, \
             {{\"buffer\": 1, \"byteLength\": 1}}]}}"
        );
        let document: Document = serde_json::from_str(&text).unwrap();
        let bytes = [0, 0, 128, 63, 255, 2, 127, 129];
        Binary { name: "a.glb", document: &document, bytes: &bytes, budget: &Budget::default() }.numbers(0, width)
    }

    #[test]
    fn numbers_of_every_type_are_read() {
        for (accessor, width, expected) in [
            ("{\"bufferView\": 0, \"componentType\": 5126, \"count\": 1, \"type\": \"SCALAR\"}", 1, vec![1.0]),
            (
                "{\"bufferView\": 0, \"componentType\": 5121, \"count\": 1, \"type\": \"VEC2\", \"byteOffset\": 4}",
                2,
                vec![255.0, 2.0],
            ),
            (
                "{\"bufferView\": 0, \"componentType\": 5120, \"count\": 2, \"type\": \"SCALAR\", \"byteOffset\": 6, \"normalized\": true}",
                1,
                vec![1.0, -1.0],
            ),
            (
                "{\"bufferView\": 0, \"componentType\": 5123, \"count\": 1, \"type\": \"SCALAR\", \"byteOffset\": 4}",
                1,
                vec![767.0],
            ),
            (
                "{\"bufferView\": 1, \"componentType\": 5121, \"count\": 2, \"type\": \"SCALAR\", \"byteOffset\": 2}",
                1,
                vec![63.0, 127.0],
            ),
            ("{\"componentType\": 5126, \"count\": 2, \"type\": \"SCALAR\"}", 1, vec![0.0, 0.0]),
        ] {
            assert_eq!(numbers(accessor, width).unwrap(), expected, "{accessor}");
        }
    }

    #[test]
    fn what_reaches_beyond_is_told() {
        for (accessor, width, expected) in [
            (
                "{\"bufferView\": 0, \"componentType\": 5126, \"count\": 3, \"type\": \"SCALAR\"}",
                1,
                "3 items reach beyond",
            ),
            (
                "{\"bufferView\": 0, \"componentType\": 5126, \"count\": 18446744073709551615, \"type\": \"SCALAR\"}",
                1,
                "over the limit",
            ),
            (
                "{\"bufferView\": 0, \"componentType\": 5126, \"count\": 1, \"type\": \"SCALAR\", \"byteOffset\": 18446744073709551615}",
                1,
                "reach beyond",
            ),
            ("{\"bufferView\": 1, \"componentType\": 5126, \"count\": 1, \"type\": \"SCALAR\"}", 1, "reach beyond"),
            (
                "{\"bufferView\": 2, \"componentType\": 5121, \"count\": 1, \"type\": \"SCALAR\"}",
                1,
                "buffer view 2 reaches beyond the 8 bytes",
            ),
            (
                "{\"bufferView\": 9, \"componentType\": 5121, \"count\": 1, \"type\": \"SCALAR\"}",
                1,
                "buffer view 9, which does not exist",
            ),
            ("{\"bufferView\": 0, \"componentType\": 9, \"count\": 1, \"type\": \"SCALAR\"}", 1, "component type 9"),
            (
                "{\"bufferView\": 0, \"componentType\": 5126, \"count\": 1, \"type\": \"MAT4\"}",
                3,
                "its type is MAT4, expected 3",
            ),
            (
                "{\"bufferView\": 0, \"componentType\": 5126, \"count\": 1, \"type\": \"SCALAR\", \"sparse\": {}}",
                1,
                "sparse",
            ),
            ("{\"bufferView\": 3, \"componentType\": 5121, \"count\": 1, \"type\": \"SCALAR\"}", 1, "a buffer outside"),
            ("", 1, "accessor 0: there are 0"),
        ] {
            let message = numbers(accessor, width).unwrap_err().to_string();
            assert!(message.contains(expected), "{accessor}: {message}");
        }
    }
}
