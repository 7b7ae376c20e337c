//! Numbers of cells, or of nodes, in a box of them: the first coordinate runs fastest.

/// The place of cell `index` along each coordinate, in a box of `counts` cells.
pub fn cell_place<const D: usize>(index: usize, counts: &[usize; D]) -> [usize; D] {
    let mut rest = index;
    std::array::from_fn(|k| {
        let place = rest % counts[k];
        rest /= counts[k];
        place
    })
}

/// The number of the cell at a place that lies in a box of `counts` cells.
pub fn cell_index<const D: usize>(place: [usize; D], counts: &[usize; D]) -> usize {
    (0..D).rev().fold(0, |index, k| index * counts[k] + place[k])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_has_one_number() {
        let counts = [3, 1, 4];
        let places: Vec<_> = (0..12).map(|index| cell_place(index, &counts)).collect();
        assert_eq!(places[..4], [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 0, 1]]);
        assert!(places.iter().enumerate().all(|(index, &place)| cell_index(place, &counts) == index));
    }
}
