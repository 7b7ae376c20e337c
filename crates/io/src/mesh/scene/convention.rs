//! Which way is up and how long a unit is, from one program to another.

use arabesque_core::{Bounds, Matrix, Similarity, Vector};

use super::model::{Scene, SceneNode};

/// The axis that points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Up {
    /// As in glTF, and in what is written here.
    #[default]
    Y,
    /// As in Blender and in drawings of buildings.
    Z,
}

/// What coordinates mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Convention {
    /// The axis that points up.
    pub up: Up,
    /// Metres in one unit: 0.001 for millimetres. Above 0.
    pub metres_per_unit: f64,
}

impl Default for Convention {
    /// Y up, metres.
    fn default() -> Self {
        Self { up: Up::Y, metres_per_unit: 1.0 }
    }
}

impl Convention {
    /// What takes coordinates of this convention to those of another one. Right hands stay right hands: what is up stays up, and x stays
    /// x.
    pub fn to(&self, other: &Self) -> Similarity<3> {
        let rotation = match (self.up, other.up) {
            (Up::Z, Up::Y) => Matrix([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
            (Up::Y, Up::Z) => Matrix([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]),
            _ => Matrix::identity(),
        };
        Similarity { rotation, scale: self.metres_per_unit / other.metres_per_unit, translation: Vector::ZERO }
    }
}

impl Scene {
    /// The same scene in another convention: its nodes and points are turned and scaled, its meshes stay as they are.
    #[must_use]
    pub fn converted(mut self, from: &Convention, to: &Convention) -> Self {
        let change = from.to(to);
        if change == Similarity::identity() {
            return self;
        }
        for SceneNode { transform, .. } in &mut self.nodes {
            *transform = change.after(transform);
        }
        self.points.positions.iter_mut().for_each(|p| *p = change.apply(*p));
        self.points.normals.iter_mut().flatten().for_each(|n| *n = change.rotation.apply(*n));
        self.points.radii.iter_mut().flatten().for_each(|r| *r *= change.scale);
        self.frame = self.frame.map(|frame| Bounds::around([frame.min, frame.max].map(|corner| change.apply(corner))));
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_up_stays_up_and_comes_back() {
        let millimetres = Convention { up: Up::Z, metres_per_unit: 0.001 };
        let scene = Scene {
            nodes: vec![SceneNode::new("a", 0, Similarity::shift(Vector([1000.0, 2000.0, 3000.0])))],
            frame: Some(Bounds::new(Vector::ZERO, Vector([1000.0, 2000.0, 3000.0]))),
            ..Scene::default()
        };
        let metres = scene.clone().converted(&millimetres, &Convention::default());
        assert!((metres.nodes[0].transform.translation - Vector([1.0, 3.0, -2.0])).norm() < 1e-12);
        assert!((metres.nodes[0].transform.scale - 0.001).abs() < 1e-15);
        let frame = metres.frame.unwrap();
        assert!((frame.min - Vector([0.0, 0.0, -2.0])).norm() + (frame.max - Vector([1.0, 3.0, 0.0])).norm() < 1e-12);
        let back = metres.converted(&Convention::default(), &millimetres);
        assert!((back.nodes[0].transform.translation - scene.nodes[0].transform.translation).norm() < 1e-9);
        assert_eq!(scene.clone().converted(&millimetres, &millimetres), scene);
    }
}
