//! Surfaces of points and triangles.
