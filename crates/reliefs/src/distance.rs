//! Distances of the cells of a grid from those that are marked, in time linear in the cells [Felzenszwalb 2012].

/// Distance of the middle of each cell from that of the nearest that is marked, in cells; infinite where none is. With `is_marked_beyond` all
/// cells beyond the border count as marked.
pub(crate) fn distances(is_marked: &[bool], (width, height): (usize, usize), is_marked_beyond: bool) -> Vec<f64> {
    let beyond = if is_marked_beyond { 1.0 } else { f64::INFINITY };
    let mut squares: Vec<f64> = vec![0.0; width * height];
    for x in 0..width {
        let mut last = beyond;
        for y in 0..height {
            last = if is_marked[y * width + x] { 0.0 } else { last };
            squares[y * width + x] = last;
            last += 1.0;
        }
        last = beyond;
        for y in (0..height).rev() {
            last = if is_marked[y * width + x] { 0.0 } else { last };
            let d = squares[y * width + x].min(last);
            squares[y * width + x] = d * d;
            last += 1.0;
        }
    }
    let mut lower = Envelope::default();
    for row in squares.chunks_exact_mut(width.max(1)) {
        lower.along(row, is_marked_beyond);
    }
    squares
}

/// The lower envelope of parabolas over one row.
#[derive(Default)]
struct Envelope {
    feet: Vec<(i64, f64)>,
    starts: Vec<f64>,
    answers: Vec<f64>,
}

impl Envelope {
    /// From squared distances along columns to distances.
    fn along(&mut self, row: &mut [f64], is_marked_beyond: bool) {
        let n = row.len() as i64;
        self.feet.clear();
        self.starts.clear();
        // Beyond both ends stands a cell that is marked.
        let ends = if is_marked_beyond { [Some((-1, 0.0)), Some((n, 0.0))] } else { [None; 2] };
        let own = row.iter().enumerate().map(|(i, v)| (i as i64, *v)).filter(|(_, v)| v.is_finite());
        for (q, value) in ends[0].into_iter().chain(own).chain(ends[1]) {
            let mut start = f64::NEG_INFINITY;
            while let (Some(&(p, low)), Some(&from)) = (self.feet.last(), self.starts.last()) {
                let meet = ((value + (q * q) as f64) - (low + (p * p) as f64)) / (2 * (q - p)) as f64;
                if meet > from {
                    start = meet;
                    break;
                }
                self.feet.pop();
                self.starts.pop();
            }
            self.feet.push((q, value));
            self.starts.push(start);
        }
        let mut k = 0;
        self.answers.clear();
        for x in 0..n {
            while k + 1 < self.feet.len() && self.starts[k + 1] < x as f64 {
                k += 1;
            }
            let nearest = self.feet.get(k).map_or(f64::INFINITY, |(p, low)| low + (x - p).pow(2) as f64);
            self.answers.push(nearest.sqrt());
        }
        row.copy_from_slice(&self.answers);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_an_exhaustive_search() {
        let (width, height) = (13, 9);
        let is_marked: Vec<bool> = (0..width * height).map(|k| k * k % 31 == 5).collect();
        for is_marked_beyond in [false, true] {
            let far = distances(&is_marked, (width, height), is_marked_beyond);
            for (k, d) in far.iter().enumerate() {
                let (x, y) = ((k % width) as i64, (k / width) as i64);
                let border = [x + 1, y + 1, width as i64 - x, height as i64 - y].into_iter().min().unwrap() as f64;
                let border = if is_marked_beyond { border } else { f64::INFINITY };
                let marked = (0..width * height).filter(|&m| is_marked[m]);
                let own = marked.map(|m| ((x - (m % width) as i64) as f64).hypot((y - (m / width) as i64) as f64));
                assert!((d - own.fold(border, f64::min)).abs() < 1e-9, "{k}");
            }
        }
    }

    #[test]
    fn without_marks_all_is_infinitely_far() {
        assert!(distances(&[false; 12], (4, 3), false).iter().all(|d| d.is_infinite()));
        assert!(distances(&[false; 12], (4, 3), true).iter().all(|d| *d <= 2.0));
    }
}
