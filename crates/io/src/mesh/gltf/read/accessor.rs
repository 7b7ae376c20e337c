//! Numbers in the buffers of a glTF file.

use arabesque_core::{Budget, Error, Result};

use super::{
    buffers::Bytes,
    document::{AccessorRecord, Document, SparseRecord},
};

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
    pub(super) buffers: &'a [Bytes<'a>],
    pub(super) budget: &'a Budget,
}

impl Binary<'_> {
    /// The numbers of an accessor, `width` of them for each of its items: 3 for `VEC3`.
    ///
    /// # Errors
    /// [`Error::Input`] when there is no such accessor, when it is of another kind, or when it reaches beyond what it refers to; those of
    /// the budget.
    pub(super) fn numbers(&self, index: usize, width: usize) -> Result<Vec<f64>> {
        let Some(accessor) = self.document.accessors.get(index) else {
            return self.fail(index, format!("there are {}", self.document.accessors.len()));
        };
        if width_of(&accessor.kind) != Some(width) {
            return self.fail(index, format!("its type is {}, expected {width} numbers", accessor.kind));
        }
        let limit = ("nodes", self.budget.limits().nodes.saturating_mul(3));
        self.budget.within(&format!("{}: items of accessor {index}", self.name), accessor.count, limit)?;
        let total = accessor.count.saturating_mul(width);
        self.budget.spend(PER_NUMBER.saturating_mul(total as u64))?;
        let (mut numbers, _held) = self.budget.list("numbers of the mesh", total)?;
        match accessor.buffer_view {
            Some(view) => {
                let span = Span { view, offset: accessor.byte_offset, component: accessor.component_type, width };
                let (bytes, stride, size) = self.items(index, span, accessor.count)?;
                for item in 0..accessor.count {
                    let item = &bytes[item * stride..];
                    let read = |k: usize| number(&item[k * size..], accessor.component_type, accessor.normalized);
                    numbers.extend((0..width).map(read));
                }
            }
            // By the format what refers to nothing is zero.
            None => numbers.resize(total, 0.0),
        }
        if let Some(sparse) = &accessor.sparse {
            self.replace(index, (accessor, sparse), width, &mut numbers)?;
        }
        Ok(numbers)
    }

    /// Puts the numbers of a sparse accessor in their places.
    fn replace(
        &self,
        index: usize,
        (accessor, sparse): (&AccessorRecord, &SparseRecord),
        width: usize,
        numbers: &mut [f64],
    ) -> Result<()> {
        if sparse.count > accessor.count {
            return self.fail(index, format!("{} of its {} items replaced", sparse.count, accessor.count));
        }
        self.budget.spend(PER_NUMBER.saturating_mul((sparse.count.saturating_mul(width + 1)) as u64))?;
        let (places, values) = (&sparse.indices, &sparse.values);
        let component = places.component_type.unwrap_or(UNSIGNED_INT);
        let span = Span { view: places.buffer_view, offset: places.byte_offset, component, width: 1 };
        let (at, at_stride, _) = self.items(index, span, sparse.count)?;
        let span =
            Span { view: values.buffer_view, offset: values.byte_offset, component: accessor.component_type, width };
        let (bytes, stride, size) = self.items(index, span, sparse.count)?;
        for k in 0..sparse.count {
            let place = number(&at[k * at_stride..], component, false);
            if !(place.fract() == 0.0 && (0.0..accessor.count as f64).contains(&place)) {
                return self.fail(index, format!("it replaces item {place} of {}", accessor.count));
            }
            for n in 0..width {
                let value = number(&bytes[k * stride + n * size..], accessor.component_type, accessor.normalized);
                numbers[place as usize * width + n] = value;
            }
        }
        Ok(())
    }

    /// How many numbers each item of an accessor has; `None` where there is no such accessor.
    pub(super) fn width(&self, index: usize) -> Option<usize> {
        width_of(&self.document.accessors.get(index)?.kind)
    }

    /// The bytes of a buffer view.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub(super) fn view(&self, view: usize) -> std::result::Result<&[u8], String> {
        let Some(record) = self.document.buffer_views.get(view) else {
            return Err(format!("it refers to buffer view {view}, which does not exist"));
        };
        let Some(buffer) = self.buffers.get(record.buffer) else {
            return Err(format!("buffer view {view} refers to buffer {}, which does not exist", record.buffer));
        };
        let end = record.byte_offset.checked_add(record.byte_length);
        let bytes = end.and_then(|end| buffer.get(record.byte_offset..end));
        bytes.ok_or_else(|| format!("buffer view {view} reaches beyond the {} bytes there are", buffer.len()))
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
    fn items(&self, index: usize, span: Span, count: usize) -> Result<(&[u8], usize, usize)> {
        let Some(size) = size_of(span.component) else {
            return self.fail(index, format!("its component type {} is none", span.component));
        };
        let bytes = self.view(span.view).or_else(|problem| self.fail(index, problem))?;
        let item = size * span.width;
        let stride = self.document.buffer_views.get(span.view).and_then(|v| v.byte_stride).unwrap_or(item);
        let bytes = bytes.get(span.offset..).unwrap_or_default();
        let last = count.saturating_sub(1).checked_mul(stride).and_then(|last| last.checked_add(item));
        if stride < item || (count > 0 && last.is_none_or(|needed| needed > bytes.len())) {
            return self.fail(index, format!("{count} items reach beyond buffer view {}", span.view));
        }
        Ok((bytes, stride, size))
    }

    fn fail<T>(&self, index: usize, problem: String) -> Result<T> {
        let advice = "write the file again; it is damaged";
        Err(Error::input(format!("{}: accessor {index}", self.name), problem, advice))
    }
}

/// Where numbers lie.
struct Span {
    view: usize,
    /// Bytes of the view before them.
    offset: usize,
    component: u32,
    /// Numbers of one item.
    width: usize,
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
        let buffers = [Bytes::Chunk(&bytes)];
        Binary { name: "a.glb", document: &document, buffers: &buffers, budget: &Budget::default() }.numbers(0, width)
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
            (
                "{\"componentType\": 5121, \"count\": 3, \"type\": \"SCALAR\", \"sparse\": {\"count\": 1, \"indices\": \
                 {\"bufferView\": 0, \"componentType\": 5121, \"byteOffset\": 5}, \"values\": {\"bufferView\": 0, \"byteOffset\": 6}}}",
                1,
                vec![0.0, 0.0, 127.0],
            ),
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
                "{\"componentType\": 5121, \"count\": 1, \"type\": \"SCALAR\", \"sparse\": {\"count\": 1, \"indices\": \
                 {\"bufferView\": 0, \"componentType\": 5121, \"byteOffset\": 4}, \"values\": {\"bufferView\": 0}}}",
                1,
                "it replaces item 255 of 1",
            ),
            (
                "{\"componentType\": 5121, \"count\": 1, \"type\": \"SCALAR\", \"sparse\": {\"count\": 2, \"indices\": \
                 {\"bufferView\": 0}, \"values\": {\"bufferView\": 0}}}",
                1,
                "2 of its 1 items replaced",
            ),
            (
                "{\"bufferView\": 3, \"componentType\": 5121, \"count\": 1, \"type\": \"SCALAR\"}",
                1,
                "refers to buffer 1",
            ),
            ("", 1, "accessor 0: there are 0"),
        ] {
            let message = numbers(accessor, width).unwrap_err().to_string();
            assert!(message.contains(expected), "{accessor}: {message}");
        }
    }
}
