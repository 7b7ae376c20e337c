//! Parameters, with defaults that work.

use arabesque_core::{choices, params};

choices! {
    /// How the best places of a patch are found. Both find the same.
    pub enum Search {
        /// Whichever takes less work.
        Auto = "auto",
        /// By cross-correlation with fast Fourier transforms.
        Fft = "fft",
        /// By going through all places.
        Exhaustive = "exhaustive",
    }
}

choices! {
    /// The axis across the plane along which the texture goes on.
    pub enum Plane {
        /// The axis along which the points spread least.
        Auto = "auto",
        /// Across x.
        X = "x",
        /// Across y.
        Y = "y",
        /// Across z.
        Z = "z",
    }
}

params! {
    /// How a relief is continued.
    pub struct ReliefParams {
        /// Side of a patch.
        patch "patch": Option<f64> = None, in 1e-9..=1e9, auto "by what repeats in the texture", unit "units of the texture";
        /// Width of the overlap of neighbouring patches, as a share of the patch.
        overlap "overlap": Option<f64> = None, in 0.05..=0.5, auto "a tenth, and up to a fifth where a patch has few points and no edges";
        /// Width of the border that is pasted beyond a patch, as a share of the patch.
        border "border": Option<f64> = None, in 0.0..=0.5, auto "0.15, and up to a quarter where a patch has few points";
        /// Of patches that are worse than the best by at most this share of its difference the one of which least was seen so far is taken; by less where the texture repeats strictly.
        tolerance "tolerance": f64 = 0.25, in 0.0..=10.0;
        /// How far a patch is kept from the one that goes on from its neighbours in the texture, as a share of the patch; 0 allows copies.
        apart "apart": f64 = 0.25, in 0.0..=1.0;
        /// Side of the cells of the distance field.
        cell "cell": Option<f64> = None, in 1e-9..=1e9, auto "a little more than the spacing of the points", unit "units of the texture";
        /// How the best places of a patch are found.
        search "search": Search = Search::Auto;
        /// Axis across the plane in which the texture goes on.
        plane "plane": Plane = Plane::Auto;
        /// Pairs of points that bend a patch onto what is there, about.
        pairs "pairs": usize = 70, in 4..=2000;
        /// Weight of the distance between the points of a pair, in units of the reach.
        distance "distance": f64 = 1.0, in 0.0..=1000.0;
        /// Weight of the angle between their normals.
        normals "normals": f64 = 2.0, in 0.0..=1000.0;
        /// Weight of how much more the surface bends at one than at the other.
        variation "variation": f64 = 15.0, in 0.0..=1000.0;
        /// Weight of how much longer a pair is than those around it.
        length "length": f64 = 7.0, in 0.0..=1000.0;
        /// Weight of the angle between a pair and those around it.
        direction "direction": f64 = 6.0, in 0.0..=1000.0;
        /// Rounds in which pairs are made to agree with those around them.
        rounds "rounds": usize = 4, in 0..=100;
        /// Distance between the points of a pair at most, as a share of the patch.
        reach "reach": f64 = 0.12, in 0.001..=0.5;
        /// How stiff a patch is: 0 bends it exactly onto its pairs.
        stiffness "stiffness": f64 = 20.0, in 0.0..=1000.0;
        /// Patches that are tried where pairs cannot be made well, before one is laid without being bent.
        tries "tries": usize = 6, in 1..=1000;
        /// Rounds in which points along the seams are spread evenly.
        relax "relax": usize = 1, in 0..=100;
    }
}
