//! Geometry textures from point-set surfaces [Duranleau 2008].
//!
//! A texture is a patch of surface detail of any topology, as points with normals. More of it is made piece by piece, along rows: what there is
//! already around a place is compared with every place of the texture, by signed distances and their gradients; one of the best is bent so that
//! what corresponds meets, blended with what is there, and replaces it. Pieces are laid in the plane, on a torus for tiles, in the gap of a
//! scan, and in charts of a mesh.
//!
//! | step | module | source |
//! |---|---|---|
//! | understand the texture: plane, box, normals | `texture::understand` | [Duranleau 2008 §3] |
//! | distance and gradient field | `search::field` | [Duranleau 2008 §5.1], projection by [Adamson 2004] |
//! | what repeats, and the patch | `texture::repetition`, `texture::likeness` | |
//! | the two shifts of what repeats strictly | `texture::repeat` | |
//! | places that fit, by cross-correlation | `search::best`, `search::fft` | [Duranleau 2008 §4 step 2, §5.1] |
//! | pairs of points | `patch::pairing` | [Duranleau 2008 §5.2, eqs 1 to 3] |
//! | thin-plate spline, normals, folds | `patch::spline`, `patch::site` | [Duranleau 2008 §5.2] |
//! | how a bend is told to many points | `patch::warp` | |
//! | blending, replacement | `patch::blend`, `patch::mask` | [Duranleau 2008 §5.3, §4 steps 5 and 6] |
//! | what was seen how often | `patch::usage` | |
//! | loose pieces, laid whole | `texture::pieces` | |
//! | the result while it grows | `ground::store` | [Duranleau 2008 §4] |
//! | rows of patches; tiles | `ground::plane` | [Duranleau 2008 fig. 1] |
//! | gaps of scans | `texture::gap`, `ground::hole` | |
//! | meshes: charts by geodesics from sample to sample | `ground::chart`, `ground::on_mesh` | [Schmidt 2006] |
//! | even points along seams | `ground::relax` | [Duranleau 2008 §6] |
//!
//! | symbol | identifier |
//! |---|---|
//! | `T_in`, its box | `Texture`, `Texture::bounds` |
//! | `N_k`, `O_k` | `Site::samples`, `Mask::overlapped` |
//! | `E_k`, `w_E` | cells of the border, [`ReliefParams::border`] |
//! | `D` | `Field`, `Overlap` |
//! | ε | [`ReliefParams::tolerance`] |
//! | `S`, `Q`, Φ | sources and targets of `Pairing`, `Pair` |
//! | ω_p, ω_n, ω_v, ω_l, ω_d | [`ReliefParams::distance`], `normals`, `variation`, `length`, `direction` |
//! | `W`, `J` | `Spline` |
//!
//! Where it departs from the paper:
//!
//! - A texture that leans from the axes of its file is laid flat, and patches come from within the convex hull of its points.
//! - The search is a cross-correlation by Fourier transforms where that takes less work, else a sum in rows; what comes out near the best is
//!   summed again, so that both answer alike. Differences below a floor count as none, so that ε has something to be a share of.
//! - A place that goes on from a neighbour's in the texture is not taken: otherwise the result is the texture itself up to its border, and then a seam.
//! - Overlaps are narrower (a tenth of the patch, not a third) and patches larger: every blended point is a little off, and half of the
//!   surface would be blended. Where a patch has few points and no edges they are up to a fifth, so that crests go on; the border is narrower too.
//! - A height field that is high for a patch is blended along upright rays, in overlaps up to three tenths wide: its parts climb to one another.
//! - The last patches of a tile are the best of more that are tried, since they meet others on both sides.
//! - Of the places within ε the one is taken of which least was seen so far, and least nearby; chance has a say. ε is larger for it, but for what repeats
//!   strictly it is none: an overlap shows too little of how that goes on.
//! - Where two shifts carry a texture into itself, patches are taken only from where it goes on as what is there does, and are laid exactly so between
//!   the cells: bonds keep without drift, gaps are closed in bond, and tiles that nearly suit are stretched a little.
//! - Nothing comes to lie higher or lower than in the texture.
//! - Of the nodes of an overlap at most 160 are compared, by turns as on a chessboard and in every second row and column.
//! - Patches are laid along diagonals of the rows, whose patches do not see one another, so that they are made at once.
//! - A patch is bent beside the overlap alone, and is as in the texture a third of its side on. Where it has many points, the spline is worked
//!   out at the nodes of a grid.
//! - Blending moves points by what leads from the smooth surface of the patch to that of what is there: both leave out the same edges, which
//!   so survive, while points that are moved onto a smooth surface lose them.
//! - The spline is stiff: it passes by its pairs rather than through them, since a point's partner is half a spacing off along the surface whatever
//!   is done. Pairs that lie in one plane leave the third direction open; some are lifted above and below it.
//! - A spline that folds is made again without its worst pairs; a patch that still folds, for which there are few pairs, or beside which
//!   more than a hundredth of the overlap has nothing to go on to, gives way to the next best. The best of those that were tried is laid.
//! - Distances end at a reach, gradients fade towards it.
//! - What is there already, what is replaced and what is free are cells of a grid (`patch::mask`), so that rows, tiles, gaps and charts are one case.
//! - The surface variation of a point of the result is that of the point it stands for.
//! - At the border only what an overlap is wide is cut off: farther in everything was blended.
//! - Relaxation moves points along seams alone: the others lie as in the texture.
//!
//! Not handled: sharp edges stay as sharp as the points show them; rigid elements of a texture are not kept rigid; a patch is never turned
//! or mirrored; what repeats in the texture does not have to repeat in a tile, whose size is the caller's.

mod distance;
mod ground;
mod params;
mod patch;
mod prepared;
mod request;
mod sample;
mod search;
mod texture;

pub use params::{Plane, ReliefParams, Search};
pub use prepared::Prepared;
pub use request::{Ground, ReliefOutcome, ReliefRequest, Statistics};
pub use texture::axes::Axes;
