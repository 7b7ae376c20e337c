//! Surfaces of points and triangles.
//!
//! | question | answer |
//! |---|---|
//! | where is the nearest point of a mesh, how far is it, is a place inside | [`MeshIndex`] with [`Closest`] |
//! | what is wrong with a mesh | [`MeshReport`] |
//! | which way does a pattern run along it | [`DirectionField`] of [`Directions`], [`curvatures`] |
//! | where do the nodes of a lattice lie that is laid on it | [`SurfaceLattice`] |
//! | points spread on it, in a shell around it, inside of it | [`scatter`], [`shell_grid`], [`inside_grid`] |
//! | by which rotations does a mesh come to lie on itself | [`Symmetry`] |
//! | does a mesh have a centre line, which balls stand for it, where is it once samples of it have moved | [`Tube`], [`balls`], [`Skin`] |
//! | where is the nearest point of a surface that points alone stand for, where does a ray meet it, how does it bend | [`OrientedPoints`] |
//! | the surface through points, or around balls | [`reconstruct`] with [`SurfaceParams`] |
//!
//! # Meshes
//! Triangles stand in a balanced tree of boxes; the nearest one is found from the near side first, ties go to the smaller number. Vertices at equal places are one.
//! Inside and outside are told by the generalised winding number [Jacobson 2013] with dipoles for what is far [Barill 2018], so that small holes and a mesh that is turned inside out do no
//! harm; above and below an open sheet by pseudonormals [Baerentzen 2005]. Directions come from principal curvatures [Rusinkiewicz 2004], one direction in space, or strokes, and are made smooth as complex numbers in
//! tangent planes [Knoppel 2013]. Points are spread by throwing candidates [Corsini 2012].
//!
//! # From points to a mesh
//! 1. *Neighbours*: the ten nearest of each point, its spacing, and its normal where it has none: the plane of the neighbours, turned to one side along a spanning tree [Hoppe 1992].
//! 2. *Sheets*: points are linked as one surface links them, so that strands that touch become surfaces of their own; points that other parts of the same sheet
//!    surround are left out.
//! 3. *Field*: robust implicit moving least squares [Oztireli 2009] or metaballs [Blinn 1982] at the nodes of a grid of which only blocks near points are there.
//! 4. *March*: marching cubes [Lorensen 1987] with faces decided by the asymptotic decider [Nielson 1991]; the whole is manifold by construction, no triangle is without area, and vertices are shared.
//! 5. *Border*: where the surface ends, it is cut near the outermost points, along a level of the distance to the middle of the points around [Adamson 2004]; a closed mesh may trim it further: closed surfaces get a lid there.
//!
//! Every step gives the same bytes for any number of threads.
//!
//! # Limits
//! * What no point tells is not made up: walls of steps and holes that are wider than about three spacings stay open. An open surface that a mesh trims has an open edge there, a closed one a lid, with a rim as sharp as a cell.
//! * Solids that pass through one another by less than about a spacing, in one group, look like thin plates where they do; groups keep them apart.
//! * Interior ambiguities of a cube are not decided as the trilinear function would: two parts of a surface in one cube are never joined by a tunnel.
//! * The cells are equal everywhere; detail that is finer than they are is lost, and a cell's worth of noise is kept.

mod cloud;
mod dipoles;
mod directions;
mod flexible;
mod implicit;
mod isosurface;
mod lattice;
mod mesh;
mod oriented;
mod params;
mod reconstruct;
mod spread;
mod symmetry;
#[cfg(test)]
mod tests;
mod tree;

pub use directions::{Bend, Curvature, DirectionField, Directions, SurfaceFrame, curvatures};
pub use flexible::{Skin, Tube, balls};
pub use lattice::{Axes, LatticePlace, RowSite, SurfaceLattice};
pub use mesh::{Closest, Found, MeshIndex, MeshReport};
pub use oriented::{
    EstimatedNormals, Foot, OrientedPoints, clusters, estimated_normals, spacing_of, thinnest_direction,
};
pub use params::{Method, Normals, Parts, SurfaceParams};
pub use reconstruct::{Reconstruction, reconstruct};
pub use spread::{inside_grid, scatter, shell_grid};
pub use symmetry::Symmetry;
