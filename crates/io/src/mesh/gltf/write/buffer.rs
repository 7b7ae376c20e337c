//! The binary chunk of a GLB file, with the tables that tell what lies where.

use serde_json::{Value, json};

/// Component types and targets of the format.
pub(in super::super) const FLOAT: u32 = 5126;
pub(in super::super) const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// The binary chunk while it grows.
#[derive(Default)]
pub(in super::super) struct Buffer {
    pub(in super::super) bytes: Vec<u8>,
    pub(in super::super) views: Vec<Value>,
    pub(in super::super) accessors: Vec<Value>,
}

impl Buffer {
    pub(in super::super) fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        let mut view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(view);
        self.views.len() - 1
    }

    pub(in super::super) fn vectors<const N: usize>(&mut self, values: &[[f32; N]], bounded: bool) -> usize {
        let bytes: Vec<u8> = values.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes, Some(ARRAY_BUFFER));
        let kind = format!("VEC{N}");
        let mut accessor = json!({ "bufferView": view, "componentType": FLOAT, "count": values.len(), "type": kind });
        if bounded {
            let extreme = |start: f32, pick: fn(f32, f32) -> f32| -> Vec<f32> {
                (0..N).map(|k| values.iter().map(|v| v[k]).fold(start, pick)).collect()
            };
            accessor["min"] = extreme(f32::INFINITY, f32::min).into();
            accessor["max"] = extreme(f32::NEG_INFINITY, f32::max).into();
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Vectors for each instance of a node, which are no attributes of vertices.
    pub(super) fn instances<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = values.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes, None);
        let kind = format!("VEC{N}");
        self.accessors.push(json!({ "bufferView": view, "componentType": FLOAT, "count": values.len(), "type": kind }));
        self.accessors.len() - 1
    }

    pub(in super::super) fn scalars(&mut self, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes, Some(ARRAY_BUFFER));
        let accessor = json!({ "bufferView": view, "componentType": FLOAT, "count": values.len(), "type": "SCALAR" });
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    pub(in super::super) fn indices(&mut self, triangles: &[[u32; 3]]) -> usize {
        let bytes: Vec<u8> = triangles.iter().flatten().flat_map(|i| i.to_le_bytes()).collect();
        let view = self.view(&bytes, Some(ELEMENT_ARRAY_BUFFER));
        let count = 3 * triangles.len();
        let accessor = json!({ "bufferView": view, "componentType": UNSIGNED_INT, "count": count, "type": "SCALAR" });
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}
