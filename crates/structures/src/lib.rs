//! Repetitive structures as sums of Gaussians [Roveri 2015].
