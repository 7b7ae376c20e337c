//! White noise: points at random, as many as the exemplar has for the same size, with the attributes of any of its points.

use arabesque_core::{Matrix, Similarity, Stage, Stream, Vector};

use crate::{energy::level::Level, exemplar::bodies::LOOSE, output::state::Output};

const PLACES: Stage = Stage::new(43);

/// Noise around the sites.
pub(crate) fn noise<const D: usize>(level: &Level<'_, D>, mut output: Output<D>, step: f64, seed: u64) -> Output<D> {
    let pattern = level.pattern;
    let loose: Vec<usize> = (0..pattern.points.len()).filter(|&i| pattern.body_of[i] == LOOSE).collect();
    let cell = step.powi(pattern.repeats() as i32) / pattern.measure();
    for (q, site) in level.sites.iter().enumerate() {
        let mut stream = Stream::new(seed, PLACES, q as u64);
        let drawn = |n: usize, stream: &mut Stream| {
            let expected = n as f64 * cell * site.weight;
            expected.floor() as usize + usize::from(stream.unit() < expected.fract())
        };
        let along = |stream: &mut Stream, across: Vector<D>| -> Vector<D> {
            Vector(std::array::from_fn(|k| {
                if pattern.base[k] { stream.range(-0.5 * step, 0.5 * step) } else { across[k] - pattern.axis[k] }
            }))
        };
        for _ in 0..drawn(loose.len(), &mut stream) {
            let j = loose[stream.below(loose.len())];
            let offset = along(&mut stream, pattern.points.positions[j]);
            let weights = pattern.channels.turned(&pattern.weights[j], &site.rotation);
            output.add(level.domain.wrap(site.place + site.shown(offset)), weights);
        }
        for _ in 0..drawn(pattern.bodies.len(), &mut stream) {
            let source = stream.below(pattern.bodies.len());
            let centre = pattern.bodies[source].centre;
            let offset = along(&mut stream, centre);
            let rotation: Matrix<D> = site.rotation;
            let pose = Similarity::about(centre, site.place + site.shown(offset), rotation, site.scale);
            output.add_body(pattern, source, pose);
        }
    }
    output
}
