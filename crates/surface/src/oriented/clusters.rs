//! Points in clusters that are small and flat [Pauly 2002].

use arabesque_core::{Budget, Result, Vector};

use super::variation::covariance;
use crate::cloud::eigen;

/// Splits points, by their numbers, along the direction in which they spread most, until no cluster has more than `most` points, nor more than
/// `least` where it bends more than `flat`. The order of the clusters depends on the points alone.
///
/// # Errors
/// As [`Budget::spend`].
pub fn clusters(
    positions: &[Vector<3>],
    numbers: Vec<u32>,
    (least, most): (usize, usize),
    flat: f64,
    budget: &Budget,
) -> Result<Vec<Vec<u32>>> {
    let (mut found, mut stack, mut meter) = (Vec::new(), vec![numbers], budget.meter());
    while let Some(mut some) = stack.pop() {
        meter.spend(some.len() as u64 * 12)?;
        if some.is_empty() {
            continue;
        }
        let (mean, m) = covariance(some.iter().map(|&i| positions[i as usize]));
        let pairs = eigen(m);
        let sum: f64 = pairs.iter().map(|e| e.0.max(0.0)).sum();
        let bends = sum > 0.0 && pairs[0].0 / sum > flat;
        if some.len() <= least.max(1) || some.len() <= most && !bends {
            some.sort_unstable();
            found.push(some);
            continue;
        }
        let along = |i: u32| (positions[i as usize] - mean).dot(pairs[2].1);
        let (mut low, mut high): (Vec<u32>, Vec<u32>) = some.iter().partition(|&&i| along(i) < 0.0);
        if low.is_empty() || high.is_empty() {
            // All in one place: any halves do.
            high = some.split_off(some.len() / 2);
            low = some;
        }
        stack.extend([high, low]);
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_is_in_one_cluster_and_bends_make_them_smaller() {
        let flat = |k: usize| Vector([(k % 20) as f64, (k / 20) as f64, 0.0]);
        let bent = |k: usize| Vector([(k % 20) as f64, (k / 20) as f64, 4.0 * ((k % 20) as f64 * 1.3).sin()]);
        let of = |at: &dyn Fn(usize) -> Vector<3>| {
            let points: Vec<_> = (0..400).map(at).collect();
            clusters(&points, (0..400).collect(), (10, 60), 0.02, &Budget::default()).unwrap()
        };
        let (flat, bent) = (of(&flat), of(&bent));
        let mut all: Vec<u32> = bent.iter().flatten().copied().collect();
        all.sort_unstable();
        assert_eq!(all, (0..400).collect::<Vec<_>>());
        assert!(flat.iter().all(|c| c.len() <= 60) && bent.len() > flat.len());
        let heap = vec![Vector::ZERO; 100];
        assert!(
            clusters(&heap, (0..100).collect(), (4, 8), 0.02, &Budget::default()).unwrap().iter().all(|c| c.len() <= 8)
        );
    }
}
