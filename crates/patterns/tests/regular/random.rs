//! Lattices at random are found as they are; scatter at random is taken for none.

use arabesque_core::{Bounds, Budget, Exemplar, Vector};
use arabesque_patterns::repeat::{Lattice, find};
use proptest::{prelude::*, test_runner::TestRng};

use crate::drawing::{exemplar, noise, polygon, xy};

fn dots(places: &[Vector<2>], radius: f64, window: Bounds<2>) -> Exemplar<2> {
    let shapes = places.iter().map(|p| (arabesque_core::Outline { rings: vec![polygon(*p, radius, 16, 0.0)] }, 0));
    let shown: Vec<_> = shapes.filter(|(o, _)| o.bounds().intersects(&window)).collect();
    exemplar(&shown, &[], window)
}

/// Whether two lattices have the same cell, and the vectors of one lie on the other within a share of the shorter one.
pub(crate) fn agree(a: &Lattice, b: &Lattice, within: f64) -> bool {
    let shorter = b.vectors[0].norm().min(b.vectors[1].norm());
    let off = |v: &Vector<2>| {
        let c = b.coordinates(*v);
        b.vector(c - c.map(f64::round)).norm()
    };
    (a.cell() / b.cell() - 1.0).abs() < 4.0 * within && a.vectors.iter().all(|v| off(v) < within * shorter)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn lattices_are_found(
        angle in 0.0..std::f64::consts::PI,
        between in 1.05..2.09_f64,
        ratio in 1.0..1.9_f64,
        scale in 0.5..500.0_f64,
        periods in 6.2..11.0_f64,
        jitter in prop_oneof![Just(0.0), Just(0.01), Just(0.05)],
        salt in 0..1_000_000_u64,
    ) {
        let a = xy(angle.cos(), angle.sin()) * scale;
        let b = xy((angle + between).cos(), (angle + between).sin()) * (scale * ratio);
        let wanted = Lattice::new(a, b).unwrap();
        let side = periods * scale * ratio.sqrt();
        let window = Bounds::new(Vector::ZERO, xy(side, 0.83 * side));
        let reach = (2.0 * periods * ratio) as i64;
        let nodes = (-reach..=reach).flat_map(|i| (-reach..=reach).map(move |j| (i, j)));
        let off = |i, j| xy(noise(i, j, salt), noise(i, j, salt + 1)) * (1.22 * jitter * scale);
        let places: Vec<_> =
            nodes.map(|(i, j)| a * i as f64 + b * j as f64 + window.centre() * 0.97 + off(i, j)).collect();
        let exemplar = dots(&places, 0.2 * scale, window);
        let found = find(&exemplar, &Budget::default()).unwrap();
        prop_assert!(found.is_some(), "{} dots, jitter {jitter}: no lattice", exemplar.elements.len());
        let found = found.unwrap();
        let within = 0.003 + 0.5 * jitter;
        prop_assert!(agree(&found.lattice, &wanted, within), "{:?} for {wanted:?}, jitter {jitter}", found.lattice);
    }

    #[test]
    fn scatter_is_no_lattice(count in 5..400_usize, kind in 0..3_u8, salt in 0..1_000_000_u64) {
        let mut rng = TestRng::from_seed(proptest::test_runner::RngAlgorithm::ChaCha, &{
            let mut seed = [7_u8; 32];
            seed[..8].copy_from_slice(&salt.to_le_bytes());
            seed
        });
        let mut unit = || f64::from(rng.next_u32()) / f64::from(u32::MAX);
        let window = Bounds::new(Vector::ZERO, xy(100.0, 80.0));
        let spacing = (8000.0 / count as f64).sqrt();
        let mut places: Vec<Vector<2>> = Vec::new();
        let mut tries = 0;
        while places.len() < count && tries < 40 * count {
            tries += 1;
            let p = match kind {
                // About one of a few centres.
                2 => {
                    let k = (unit() * 7.0) as i64;
                    let centre = xy(50.0 + 40.0 * noise(k, 1, salt), 40.0 + 32.0 * noise(k, 2, salt));
                    centre + xy(unit() + unit() - 1.0, unit() + unit() - 1.0) * 20.0
                }
                _ => xy(unit() * 100.0, unit() * 80.0),
            };
            let apart = if kind == 1 { 0.7 * spacing } else { 0.0 };
            if window.contains(p) && places.iter().all(|q| (*q - p).norm() >= apart) {
                places.push(p);
            }
        }
        let exemplar = dots(&places, 0.15 * spacing, window);
        let found = find(&exemplar, &Budget::default()).unwrap();
        prop_assert!(found.is_none(), "{} places of kind {kind}: {found:?}", places.len());
    }
}
