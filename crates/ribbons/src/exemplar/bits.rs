//! Sets of pixels, a bit each, that are shifted and joined by whole words.

/// A rectangle of bits.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Bits {
    pub(crate) width: usize,
    pub(crate) height: usize,
    words: usize,
    rows: Vec<u64>,
}

impl Bits {
    /// The pixels where `f` holds.
    pub(crate) fn from_fn(width: usize, height: usize, f: impl Fn(usize, usize) -> bool) -> Self {
        let words = width.div_ceil(64);
        let mut rows = vec![0; words * height];
        for y in 0..height {
            for x in (0..width).filter(|&x| f(x, y)) {
                rows[y * words + x / 64] |= 1 << (x % 64);
            }
        }
        Self { width, height, words, rows }
    }

    /// Words of a row.
    pub(crate) fn words(&self) -> usize {
        self.words
    }

    /// Adds to `line` the row `y` moved by `dx` pixels to the left: bit x of the line is then set where the row has x + dx.
    pub(crate) fn add_row(&self, y: i64, dx: i64, line: &mut [u64]) {
        if y < 0 || y >= self.height as i64 {
            return;
        }
        let row = &self.rows[y as usize * self.words..][..self.words];
        let (skip, bit) = (dx.div_euclid(64), dx.rem_euclid(64) as u32);
        let word = |k: i64| usize::try_from(k).ok().and_then(|k| row.get(k)).copied().unwrap_or(0);
        for (k, target) in line.iter_mut().enumerate() {
            let low = word(k as i64 + skip) >> bit;
            let high = if bit == 0 { 0 } else { word(k as i64 + skip + 1) << (64 - bit) };
            *target |= low | high;
        }
    }

    /// The set grown by `radius` pixels in all eight directions.
    pub(crate) fn grown(&self, radius: i64) -> Self {
        let mut rows = vec![0; self.rows.len()];
        for (y, line) in rows.chunks_mut(self.words.max(1)).enumerate() {
            for dy in -radius..=radius {
                for dx in -radius..=radius {
                    self.add_row(y as i64 + dy, dx, line);
                }
            }
        }
        Self { rows, ..*self }
    }
}

/// The set bits of a line, in rising order.
pub(crate) fn ones(line: &[u64]) -> impl Iterator<Item = usize> + '_ {
    line.iter().enumerate().flat_map(|(k, &word)| (0..64).filter(move |b| word >> b & 1 == 1).map(move |b| k * 64 + b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_moves_across_words() {
        let bits = Bits::from_fn(130, 2, |x, y| y == 1 && (x == 3 || x == 64 || x == 129));
        for (dx, expected) in [(0, vec![3, 64, 129]), (2, vec![1, 62, 127]), (-70, vec![73, 134])] {
            let mut line = [0; 3];
            bits.add_row(1, dx, &mut line);
            assert_eq!(ones(&line).collect::<Vec<_>>(), expected, "{dx}");
        }
        let mut line = [0; 3];
        bits.add_row(2, 0, &mut line);
        assert_eq!(ones(&line).count(), 0);
    }

    #[test]
    fn growing_reaches_the_corners() {
        let bits = Bits::from_fn(9, 9, |x, y| (x, y) == (4, 4)).grown(1);
        assert_eq!(bits, Bits::from_fn(9, 9, |x, y| (3..=5).contains(&x) && (3..=5).contains(&y)));
    }
}
