//! What a mesh is like, and what is wrong with it for a given use.

use std::fmt;

use arabesque_core::{Bounds, Budget, DisjointSets, Error, Result, Vector, Warning};

use super::{
    crossings::crossings,
    index::{MeshIndex, shown},
    topology::Side,
};

/// Share of the area that holes may have before nothing is inside of a mesh any more.
const MOST_OPEN: f64 = 0.08;

/// How many of something there are, and where the first one is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Found {
    /// How many.
    pub count: usize,
    /// The place of the first.
    pub first: Option<Vector<3>>,
}

impl Found {
    fn add(&mut self, place: Vector<3>) {
        self.count += 1;
        self.first = self.first.or(Some(place));
    }

    /// Whether there are any.
    pub fn any(&self) -> bool {
        self.count > 0
    }
}

impl fmt::Display for Found {
    /// `none`, or `12, the first at (0.5, 0, 1)`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.first {
            None => write!(f, "none"),
            Some(place) if self.count == 1 => write!(f, "1, at {}", shown(place)),
            Some(place) => write!(f, "{}, the first at {}", self.count, shown(place)),
        }
    }
}

/// What a mesh is like. Vertices at equal places count as one.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshReport {
    /// Number of places with vertices that triangles use.
    pub vertices: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Parts that share no vertex.
    pub components: usize,
    /// The smallest box around the triangles.
    pub bounds: Bounds<3>,
    /// Area of all triangles.
    pub area: f64,
    /// What the surface encloses, negative where it is turned inside out; of little meaning unless it is closed.
    pub volume: f64,
    /// Area of the holes that open edges run around, about.
    pub open_area: f64,
    /// Edges with one triangle.
    pub open_edges: Found,
    /// Edges with more than two triangles.
    pub crowded_edges: Found,
    /// Edges whose two triangles face different sides.
    pub turned_edges: Found,
    /// Triangles without area.
    pub flat_triangles: Found,
    /// Triangles that pass through others.
    pub crossings: Found,
    /// Whether all triangles could be compared for crossings; in heaps of triangles not all are.
    pub crossings_counted: bool,
}

impl MeshReport {
    /// Looks a mesh over.
    ///
    /// # Errors
    /// As [`Budget::spend`].
    pub fn new(index: &MeshIndex, budget: &Budget) -> Result<Self> {
        let topology = &index.topology;
        budget.spend(topology.triangles.len() as u64 * 300)?;
        let mut sets = DisjointSets::new(topology.points.len());
        let mut used = vec![false; topology.points.len()];
        let mut report = Self {
            vertices: 0,
            triangles: topology.triangles.len(),
            components: 0,
            bounds: index.bounds(),
            area: 0.0,
            volume: 0.0,
            open_area: 0.0,
            open_edges: Found::default(),
            crowded_edges: Found::default(),
            turned_edges: Found::default(),
            flat_triangles: Found::default(),
            crossings: Found::default(),
            crossings_counted: true,
        };
        let centre = index.bounds().centre();
        for (t, corners) in topology.triangles.iter().enumerate() {
            let [a, b, c] = topology.corners(t as u32);
            let area = topology.double_area(t as u32).norm() * 0.5;
            let longest = (b - a).norm2().max((c - b).norm2()).max((a - c).norm2());
            if area <= 1e-9 * longest || longest <= 0.0 {
                report.flat_triangles.add(a);
            }
            report.area += area;
            report.volume += (a - centre).dot((b - centre).cross(c - centre)) / 6.0;
            corners.iter().for_each(|&v| used[v as usize] = true);
            sets.join(corners[0] as usize, corners[1] as usize);
            sets.join(corners[0] as usize, corners[2] as usize);
        }
        report.vertices = used.iter().filter(|&&u| u).count();
        report.components = (0..used.len()).filter(|&v| used[v] && sets.of(v) == v).count();
        report.count_edges(index);
        let crossed = crossings(index, budget)?;
        report.crossings = Found { count: crossed.count, first: crossed.first };
        report.crossings_counted = crossed.is_whole;
        Ok(report)
    }

    fn count_edges(&mut self, index: &MeshIndex) {
        let points = &index.topology.points;
        let sides = index.topology.sides();
        let mut open: Vec<&Side> = Vec::new();
        for along in sides.chunk_by(|a, b| a.ends == b.ends) {
            let middle = (points[along[0].ends.0 as usize] + points[along[0].ends.1 as usize]) * 0.5;
            match along {
                [only] => {
                    self.open_edges.add(middle);
                    open.push(only);
                }
                [a, b] if a.is_forward == b.is_forward => self.turned_edges.add(middle),
                [_, _] => {}
                _ => self.crowded_edges.add(middle),
            }
        }
        // Edges of one hole hang together; fanned out from its middle they give its area.
        let mut sets = DisjointSets::new(points.len());
        open.iter().for_each(|side| sets.join(side.ends.0 as usize, side.ends.1 as usize));
        let mut holes: Vec<(usize, Vector<3>, Vector<3>)> = open
            .iter()
            .map(|side| {
                let (a, b) = if side.is_forward { side.ends } else { (side.ends.1, side.ends.0) };
                (sets.of(a as usize), points[a as usize], points[b as usize])
            })
            .collect();
        holes.sort_by_key(|hole| hole.0);
        for hole in holes.chunk_by(|a, b| a.0 == b.0) {
            let sum = hole.iter().fold(Vector::ZERO, |sum, (_, a, b)| sum + (*a - hole[0].1).cross(*b - hole[0].1));
            self.open_area += 0.5 * sum.norm();
        }
    }

    /// Whether every edge has two triangles.
    pub fn is_closed(&self) -> bool {
        !self.open_edges.any() && !self.crowded_edges.any()
    }

    /// Whether a closed mesh is turned inside out.
    pub fn is_inverted(&self) -> bool {
        self.is_closed() && self.volume < 0.0
    }

    /// Whether the mesh can say what is inside of it; if so, what is not as it should be.
    ///
    /// # Errors
    /// [`Error::Input`] where it is open, encloses nothing, or faces both sides; `name` is what the message calls it.
    pub fn volume_of(&self, name: &str) -> Result<Vec<Warning>> {
        let fail = |problem: String, advice: &str| Err(Error::input(name, problem, advice));
        if self.open_area > MOST_OPEN * self.area {
            let problem = format!("an open surface, expected a closed one: open edges: {}", self.open_edges);
            return fail(problem, "close its holes (Blender: Mesh, Clean Up, Fill Holes), or use it with --on");
        }
        if self.turned_edges.any() {
            let problem =
                format!("its triangles face both sides: edges between those that do not agree: {}", self.turned_edges);
            return fail(problem, "let all face outwards (Blender: Mesh, Normals, Recalculate Outside)");
        }
        let size = self.bounds.size();
        if self.volume.abs() <= 1e-9 * size.norm().powi(3) {
            return fail("it encloses nothing".into(), "give it some thickness, or use it with --on");
        }
        let mut warnings = self.flaws(name);
        if self.open_edges.any() {
            warnings.push(Warning::new(
                format!("{name}: open edges: {}; what is inside is told as if the holes were closed", self.open_edges),
                "close its holes if the result is not what you want",
            ));
        }
        if self.is_inverted() {
            warnings.push(Warning::new(
                format!("{name}: its triangles face inwards; it is used as if they faced outwards"),
                "let them face outwards (Blender: Mesh, Normals, Recalculate Outside)",
            ));
        }
        Ok(warnings)
    }

    /// Whether the mesh can carry something on its surface; if so, what is not as it should be.
    ///
    /// # Errors
    /// [`Error::Input`] where it has no area or faces both sides; `name` is what the message calls it.
    pub fn surface_of(&self, name: &str) -> Result<Vec<Warning>> {
        let fail = |problem: String, advice: &str| Err(Error::input(name, problem, advice));
        if self.flat_triangles.count == self.triangles {
            return fail(
                "no triangle has an area, expected a surface".into(),
                "check its scale and that its corners differ",
            );
        }
        if self.turned_edges.any() {
            let problem =
                format!("its triangles face both sides: edges between those that do not agree: {}", self.turned_edges);
            return fail(problem, "let all face one side (Blender: Mesh, Normals, Recalculate Outside)");
        }
        let mut warnings = self.flaws(name);
        if self.is_inverted() {
            warnings.push(Warning::new(
                format!("{name}: its triangles face inwards, so that outwards is inside"),
                "let them face outwards (Blender: Mesh, Normals, Recalculate Outside) if that is not meant",
            ));
        }
        Ok(warnings)
    }

    fn flaws(&self, name: &str) -> Vec<Warning> {
        let told = [
            (
                &self.crowded_edges,
                "edges with more than two triangles",
                "make it manifold if the result is wrong there",
            ),
            (
                &self.crossings,
                "triangles that pass through others",
                "join the parts that overlap if the result is wrong there",
            ),
            (
                &self.flat_triangles,
                "triangles without area",
                "merge vertices that lie together (Blender: Mesh, Clean Up, Degenerate Dissolve)",
            ),
        ];
        let warning =
            |(found, what, advice): &(&Found, &str, &str)| Warning::new(format!("{name}: {what}: {found}"), *advice);
        told.iter().filter(|(found, ..)| found.any()).map(warning).collect()
    }
}
