//! The vocabulary of arabesque.
//!
//! | word | type |
//! |---|---|
//! | exemplar | [`Exemplar`]: the small example, as [`Element`]s with [`Outline`]s in [`Class`]es, and [`Curve`]s along [`Path`]s |
//! | geometry | [`PointSet`]: points with attributes; [`TriangleMesh`] |
//! | domain | [`Domain`]: box, torus, or any [`Region`] such as a [`Shape`] |
//! | fields | [`Fields`]: orientation, scale and density over the domain |
//! | request | [`Request`]: domain, border, fields, frozen parts, seed |
//! | outcome | [`Outcome`]: [`Placement`]s and [`Drawn`] curves, energy trace, warnings |
//!
//! Methods take an exemplar and a request, tell whoever keeps [`Watch`] how they fare, and return an outcome.
//! Nothing here reads files, prints, or synthesises.

mod budget;
mod curve;
mod error;
mod exemplar;
mod field;
mod geometry;
mod image;
mod index;
mod numerics;
pub mod options;
mod random;
mod region;
mod run;
mod space;
pub mod suggest;
mod text;

pub use budget::{Budget, Cause, Held, Limits, Meter, Stopper};
pub use curve::{
    Cubic, Measured, Path, arc_lengths, carried, cubic_at, cubic_part, net_line_spacing, parallel_line_spacing,
    polyline_length, spans_inside, straight, turned_about,
};
pub use error::{Error, Result};
pub use exemplar::{
    Area, Build, Class, Contents, Curve, Element, Exemplar, PointLattice, Role, Soft, Solid, View, point_lattice,
};
pub use field::{Fields, FlowStroke, Frame, Grid, OrientationField, Rotations, ScalarField};
pub use geometry::{MeshPart, PointSet, Ruling, TriangleMesh, corners, ruling};
pub use image::Image;
pub use index::{Buckets, GridIndex, Lattice, Number, Numbered};
pub use numerics::{
    DisjointSets, Equations, NormalEquations, Precedence, Prediction, Pull, Vote, conjugate_gradients, pairing,
    precedence,
};
pub use random::{Stage, Stream};
pub use region::{
    Domain, FillRule, Fit, Ground, Outline, Region, Ring, Shape, Signature, ring,
    segment::{self, Segment},
};
pub use run::{
    Between, Border, Covered, Drawn, EnergyPoint, Forecast, Instance, Outcome, Patch, Placement, Progress, Request,
    Snapshot, StopReason, Unobserved, Warning, Watch,
};
pub use space::{Bounds, Matrix, Similarity, Spread, Vector, Warp, cell_index, cell_place, warp};
pub use text::{Decimals, rounded};
