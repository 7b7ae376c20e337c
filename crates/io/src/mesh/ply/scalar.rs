//! The types of numbers in PLY files.

/// A type of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

/// Every type with its names: those of the first programs, and those with the number of bits.
const NAMES: [(Scalar, [&str; 2]); 10] = [
    (Scalar::I8, ["char", "int8"]),
    (Scalar::U8, ["uchar", "uint8"]),
    (Scalar::I16, ["short", "int16"]),
    (Scalar::U16, ["ushort", "uint16"]),
    (Scalar::I32, ["int", "int32"]),
    (Scalar::U32, ["uint", "uint32"]),
    (Scalar::I64, ["long", "int64"]),
    (Scalar::U64, ["ulong", "uint64"]),
    (Scalar::F32, ["float", "float32"]),
    (Scalar::F64, ["double", "float64"]),
];

impl Scalar {
    /// The type of a name.
    pub(super) fn named(name: &str) -> Option<Self> {
        NAMES.iter().find(|(_, names)| names.contains(&name)).map(|(scalar, _)| *scalar)
    }

    /// Its shortest name.
    pub(super) fn name(self) -> &'static str {
        NAMES.iter().find(|(scalar, _)| *scalar == self).map_or("float", |(_, names)| names[0])
    }

    /// The names that are known, for messages.
    pub(super) fn names() -> impl Iterator<Item = &'static str> {
        NAMES.iter().map(|(_, names)| names[0])
    }

    /// Bytes of one number.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// Whether it holds whole numbers alone.
    pub(super) fn is_whole(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// The largest number of a type of whole numbers without sign: what stands for a full colour.
    pub(super) fn full_colour(self) -> Option<f64> {
        match self {
            Self::U8 => Some(255.0),
            Self::U16 => Some(65535.0),
            _ => None,
        }
    }

    /// Least and largest number.
    pub(super) fn range(self) -> [f64; 2] {
        match self {
            Self::I8 => [f64::from(i8::MIN), f64::from(i8::MAX)],
            Self::U8 => [0.0, f64::from(u8::MAX)],
            Self::I16 => [f64::from(i16::MIN), f64::from(i16::MAX)],
            Self::U16 => [0.0, f64::from(u16::MAX)],
            Self::I32 => [f64::from(i32::MIN), f64::from(i32::MAX)],
            Self::U32 => [0.0, f64::from(u32::MAX)],
            Self::I64 => [i64::MIN as f64, i64::MAX as f64],
            Self::U64 => [0.0, u64::MAX as f64],
            Self::F32 | Self::F64 => [f64::NEG_INFINITY, f64::INFINITY],
        }
    }

    /// The number in the first bytes of `bytes`; `None` when there are too few.
    pub(super) fn decode(self, bytes: &[u8], big_endian: bool) -> Option<f64> {
        let mut word = [0; 8];
        let size = self.size();
        word[..size].copy_from_slice(bytes.get(..size)?);
        if big_endian {
            word[..size].reverse();
        }
        let [a, b, c, d, ..] = word;
        Some(match self {
            Self::I8 => f64::from(i8::from_le_bytes([a])),
            Self::U8 => f64::from(a),
            Self::I16 => f64::from(i16::from_le_bytes([a, b])),
            Self::U16 => f64::from(u16::from_le_bytes([a, b])),
            Self::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Self::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Self::I64 => i64::from_le_bytes(word) as f64,
            Self::U64 => u64::from_le_bytes(word) as f64,
            Self::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Self::F64 => f64::from_le_bytes(word),
        })
    }

    /// The number as a file shows it in text; `None` when it is none, or none of this type.
    pub(super) fn parse(self, word: &str) -> Option<f64> {
        let value: f64 = word.parse().ok()?;
        let [least, most] = self.range();
        let sound = !self.is_whole() || (value.fract() == 0.0 && (least..=most).contains(&value));
        sound.then_some(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_types_go_by_two_names_each() {
        for (scalar, names) in NAMES {
            assert!(names.iter().all(|n| Scalar::named(n) == Some(scalar)) && scalar.name() == names[0]);
        }
        assert_eq!(Scalar::named("half"), None);
    }

    #[test]
    fn numbers_are_read_in_both_orders() {
        for scalar in NAMES.map(|(scalar, _)| scalar) {
            let little: Vec<u8> = match scalar {
                Scalar::F32 => 100_f32.to_le_bytes().to_vec(),
                Scalar::F64 => 100_f64.to_le_bytes().to_vec(),
                _ => 100_u64.to_le_bytes()[..scalar.size()].to_vec(),
            };
            let big: Vec<u8> = little.iter().rev().copied().collect();
            assert_eq!((scalar.decode(&little, false), scalar.decode(&big, true)), (Some(100.0), Some(100.0)));
            assert_eq!(scalar.decode(&little[1..], false), None);
            assert_eq!(scalar.parse("100"), Some(100.0));
        }
        assert_eq!(Scalar::I16.decode(&[0xFF, 0xFE], true), Some(-2.0));
    }

    #[test]
    fn text_holds_numbers_of_its_type() {
        assert_eq!(Scalar::U8.parse("256"), None);
        assert_eq!(Scalar::U8.parse("-1"), None);
        assert_eq!(Scalar::I32.parse("1.5"), None);
        assert_eq!(Scalar::I32.parse("3.0"), Some(3.0));
        assert_eq!(Scalar::F32.parse("1,5"), None);
        assert!(Scalar::F64.parse("nan").is_some_and(f64::is_nan));
    }
}
