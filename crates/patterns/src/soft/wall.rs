//! What elements keep within: the border of a domain, and the ground.

use arabesque_core::{Border, Domain, Request, Vector};

/// The place nearest to `p`, as well as one step can tell, where a ball lies within the border and above the ground.
pub(super) fn within<const D: usize>(request: &Request<D>, p: Vector<D>, radius: f64) -> Vector<D> {
    let mut p = p;
    if request.border == Border::Inside {
        p = inside(&request.domain, p, radius);
    }
    if let Some(ground) = &request.ground
        && ground.height(p) < radius
    {
        p = ground.at_height(p, radius);
    }
    p
}

/// By how much of its radius a ball lies beyond the border or below the ground.
pub(super) fn beyond<const D: usize>(request: &Request<D>, p: Vector<D>, radius: f64) -> f64 {
    let mut room = f64::INFINITY;
    if request.border == Border::Inside {
        room = request.domain.signed_distance(p);
    }
    if let Some(ground) = &request.ground {
        room = room.min(ground.height(p));
    }
    (1.0 - room / radius.max(f64::MIN_POSITIVE)).max(0.0)
}

/// The middle of each stretch between two samples of a smooth line, in the order of the stretches [Catmull 1974].
pub(super) fn middles<const D: usize>(samples: &[Vector<D>]) -> impl Iterator<Item = Vector<D>> {
    (1..samples.len()).map(|k| {
        let (b, c) = (samples[k - 1], samples[k]);
        let a = if k > 1 { samples[k - 2] } else { b * 2.0 - c };
        let d = samples.get(k + 1).copied().unwrap_or(c * 2.0 - b);
        ((b + c) * 9.0 - a - d) * (1.0 / 16.0)
    })
}

/// Whether balls around samples lie within the border and above the ground, and those around the middles between them where these are a line.
pub(super) fn holds<const D: usize>(
    request: &Request<D>,
    (samples, is_line): (&[Vector<D>], bool),
    radius: impl Fn(usize) -> f64,
) -> bool {
    let holds = |(k, p): (usize, Vector<D>)| beyond(request, p, radius(k)) <= 0.0;
    samples.iter().copied().enumerate().all(holds) && (!is_line || middles(samples).enumerate().all(holds))
}

/// Whether anything keeps elements within.
pub(super) fn is_there<const D: usize>(request: &Request<D>) -> bool {
    request.border == Border::Inside || request.ground.is_some()
}

fn inside<const D: usize>(domain: &Domain<D>, p: Vector<D>, radius: f64) -> Vector<D> {
    if let Domain::Box(bounds) = domain {
        let least = bounds.size().0.into_iter().fold(radius, |least, side| least.min(0.5 * side));
        return bounds.grown(-least).clamp(p);
    }
    let depth = domain.signed_distance(p);
    if depth >= radius {
        return p;
    }
    if depth < 0.0 {
        // Beyond the border the way back leads over the foot and on.
        let foot = domain.nearest_inside(p);
        return foot + (foot - p).unit_or_zero() * radius;
    }
    p + deeper(domain, p, radius) * (radius - depth)
}

/// The way in which it gets deeper, of length 1; zero where there is none.
fn deeper<const D: usize>(domain: &Domain<D>, p: Vector<D>, step: f64) -> Vector<D> {
    let mut way = Vector::ZERO;
    for k in 0..D {
        let at = |sign: f64| {
            let mut q = p;
            q[k] += sign * 0.5 * step;
            domain.signed_distance(q)
        };
        way[k] = at(1.0) - at(-1.0);
    }
    way.unit_or_zero()
}
